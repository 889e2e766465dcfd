//! How far one picture is shifted and turned against another from the same place under other
//! light.
//!
//! Light from another side turns shading round: what stays is where something changes at all. So
//! the sizes of gradients are correlated, not values, by patches; where enough of these agree on
//! one shift and turn, it is the camera's. Relief of paper alone, without a drawing, correlates
//! weakly under other lamps, and then nothing is said.

use glam::{DAffine2, DVec2};
use rayon::prelude::*;

use super::{
    correlate::{Correlator, Field, Sign},
    propose::{Proposed, agreement},
};

/// Pixels along the longer side of a picture that is made ready, at most: what is larger is
/// reduced before.
pub const LONGEST_PX: usize = 1600;
/// The smallest side of a picture, in pixels.
pub const LEAST_SIDE: usize = 96;
/// The side of a patch in pixels.
const PATCH: usize = 80;
/// How far patches are looked for around where the whole picture is.
const REACH: usize = 16;
/// Patches along each side, at most.
const PATCHES: usize = 6;
/// How far around a peak the surface still belongs to it.
const APART: usize = 4;
/// A patch counts whose peak stands out so much, in standard deviations.
const LEAST_Z: f64 = 5.0;
/// The whole picture's peak: one patch decides.
const LEAST_Z_WHOLE: f64 = 8.0;
/// How far patches may be from the shift and turn that they agree on, in pixels.
const AGREE_PX: f64 = 0.75;
/// The fewest patches that must agree.
const LEAST_AGREEING: usize = 5;
/// And of all that were found, their share.
const AGREEING: f64 = 0.5;
/// How many pixels of the picture make one of the small picture, in which all of it is shifted.
const SMALL: usize = 5;
/// How many times the gradient in the middle of all, and at least how much of white, counts by
/// half: what is much steeper counts hardly more.
const HALF: [f32; 2] = [3.0, 0.5 / 255.0];

/// A picture made ready for comparison.
pub struct Detail {
    field: Field,
    small: Field,
}

/// How a picture lies against another.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// From places in the first picture to the same places in the second, in pixels.
    pub second_from_first: DAffine2,
    /// How uncertain the shift is: the standard error of its mean, in pixels.
    pub error_px: f64,
    /// How many patches agree.
    pub patches: usize,
}

impl Motion {
    /// How far each corner and the middle of a picture of this size moves, and of these the
    /// farthest.
    pub fn farthest(&self, [width, height]: [usize; 2]) -> DVec2 {
        let [w, h] = [width as f64, height as f64];
        [[0.5, 0.5], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
            .map(|[u, v]| {
                let at = DVec2::new(u * w, v * h);
                self.second_from_first.transform_point2(at) - at
            })
            .into_iter()
            .fold(DVec2::ZERO, |far, by| {
                if by.length() > far.length() { by } else { far }
            })
    }
}

impl Detail {
    /// Of grey values in 0…1, encoded for the eye, in rows. `None` where the picture is smaller
    /// than [`LEAST_SIDE`] or shows nothing.
    pub fn new(values: &[f32], [width, height]: [usize; 2]) -> Option<Self> {
        if width.min(height) < LEAST_SIDE || values.len() != width * height {
            return None;
        }
        let steepness = steepness(values, width);
        let [w, h] = [width / SMALL, height / SMALL];
        let small: Vec<f32> = (0..w * h)
            .map(|i| {
                let corner = i / w * SMALL * width + i % w * SMALL;
                let rows = (0..SMALL).map(|y| corner + y * width);
                rows.flat_map(|from| &steepness[from..from + SMALL]).sum()
            })
            .collect();
        Some(Self {
            field: field(steepness, width)?,
            small: field(small, w)?,
        })
    }

    fn size(&self) -> [usize; 2] {
        [self.field.width, self.field.height]
    }
}

/// How the second picture lies against the first, both of one size. `None` where too little of
/// them says the same.
pub fn motion(first: &Detail, second: &Detail) -> Option<Motion> {
    if first.size() != second.size() {
        return None;
    }
    let whole = shift_of_all(&first.small, &second.small);
    let whole = whole.map(|by| by.map(|v| v * SMALL as i64));
    let starts = [whole.filter(|by| *by != [0, 0]), Some([0, 0])];
    let motions = starts
        .into_iter()
        .flatten()
        .filter_map(|start| near(&first.field, &second.field, start));
    motions.max_by_key(|motion| motion.patches)
}

/// The shift of all of a small picture, in whole pixels.
fn shift_of_all(first: &Field, second: &Field) -> Option<[i64; 2]> {
    let shorter = first.width.min(first.height);
    let side = shorter / 2;
    let reach = shorter / 4;
    let correlator = Correlator::new(side, reach, 2);
    let corner = [(first.width - side) / 2, (first.height - side) / 2];
    let peak = correlator.best(first, second, corner, Sign::Same)?;
    (peak.z >= LEAST_Z_WHOLE).then(|| peak.shift.map(|v| v.round() as i64))
}

/// How it lies near a shift in whole pixels.
fn near(first: &Field, second: &Field, start: [i64; 2]) -> Option<Motion> {
    let shifted = moved_back(second, start);
    let side = PATCH.min(first.width.min(first.height) / 2);
    let correlator = Correlator::new(side, REACH, APART);
    let corners = |length: usize| {
        let room = length - side;
        let count = (2 * room / side).clamp(1, PATCHES - 1);
        (0..=count).map(move |i| room * i / count)
    };
    let places: Vec<[usize; 2]> = corners(first.height)
        .flat_map(|y| corners(first.width).map(move |x| [x, y]))
        .collect();
    let found: Vec<Proposed> = places
        .par_iter()
        .filter_map(|corner| {
            let peak = correlator.best(first, &shifted, *corner, Sign::Same)?;
            let at = DVec2::from(peak.at);
            let start = DVec2::new(start[0] as f64, start[1] as f64);
            (peak.z >= LEAST_Z).then(|| Proposed {
                mm: at,
                px: at + DVec2::from(peak.shift) + start,
                z: peak.z,
            })
        })
        .collect();
    let (agreeing, fit) = agreement(&found, 1.0, AGREE_PX);
    let fit = fit?;
    let needed = LEAST_AGREEING.max((AGREEING * found.len() as f64).ceil() as usize);
    if agreeing.len() < needed {
        return None;
    }
    let squares: f64 = fit.residuals_mm.iter().map(|r| r * r).sum();
    let count = agreeing.len() as f64;
    Some(Motion {
        second_from_first: fit.px_from_mm,
        error_px: (squares / count).sqrt() / count.sqrt(),
        patches: agreeing.len(),
    })
}

/// A field whose every place is taken from where it was shifted to.
fn moved_back(field: &Field, [dx, dy]: [i64; 2]) -> Field {
    let (width, height) = (field.width, field.height);
    let from = |i: usize| {
        let x = (i % width) as i64 + dx;
        let y = (i / width) as i64 + dy;
        let inside = (0..width as i64).contains(&x) && (0..height as i64).contains(&y);
        inside.then(|| y as usize * width + x as usize)
    };
    let taken = |values: &[f32]| -> Vec<f32> {
        (0..values.len())
            .map(|i| from(i).map_or(0.0, |i| values[i]))
            .collect()
    };
    Field {
        width,
        height,
        values: taken(&field.values),
        trust: taken(&field.trust),
    }
}

/// Sizes of gradients (Scharr's 3 × 3), those much above the middle alike.
fn steepness(values: &[f32], width: usize) -> Vec<f32> {
    let height = values.len() / width;
    let mut sizes = vec![0.0f32; values.len()];
    for y in 1..height - 1 {
        for x in 1..width - 1 {
            let at = |dx: isize, dy: isize| {
                values[(y * width + x).wrapping_add_signed(dy * width as isize + dx)]
            };
            let corners = [at(1, 1) - at(-1, -1), at(1, -1) - at(-1, 1)];
            let gx = 3.0 * (corners[0] + corners[1]) + 10.0 * (at(1, 0) - at(-1, 0));
            let gy = 3.0 * (corners[0] - corners[1]) + 10.0 * (at(0, 1) - at(0, -1));
            let size = gx.hypot(gy) / 32.0;
            sizes[y * width + x] = if size.is_finite() { size } else { 0.0 };
        }
    }
    let mut sorted = sizes.clone();
    let middle = sorted.len() / 2;
    let median = *sorted.select_nth_unstable_by(middle, f32::total_cmp).1;
    let half = (HALF[0] * median).max(HALF[1]);
    sizes.iter_mut().for_each(|size| *size /= *size + half);
    sizes
}

/// Values around their mean, with a mean square of 1.
fn field(mut values: Vec<f32>, width: usize) -> Option<Field> {
    let count = values.len() as f64;
    let mean = values.iter().map(|v| f64::from(*v)).sum::<f64>() / count;
    let squares: f64 = values.iter().map(|v| (f64::from(*v) - mean).powi(2)).sum();
    let deviation = (squares / count).sqrt();
    if deviation.is_nan() || deviation <= 1e-6 {
        return None;
    }
    for value in &mut values {
        *value = ((f64::from(*value) - mean) / deviation) as f32;
    }
    Some(Field {
        width,
        height: values.len() / width,
        trust: vec![1.0; values.len()],
        values,
    })
}
