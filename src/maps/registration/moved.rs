//! How far one picture is shifted and turned against another from the same place under other
//! light.
//!
//! Light from another side turns shading round: what stays is where something changes at all. So
//! the sizes of gradients are correlated, not values, in a few large patches that must agree. It
//! was tried on photographs of a plaster cat and a relief under lamps down to 1°: pairs of lamps
//! next to each other agree to 0.3 pixels, and lamps far apart often say nothing.

use glam::{DAffine2, DVec2};

use super::{
    ControlPoint,
    correlate::{Correlator, Field, Sign},
    similarity,
};

/// Pixels along the longer side of a picture that is made ready, at most: what is larger is
/// reduced before.
pub const LONGEST_PX: usize = 1280;
/// The smallest side of a picture, in pixels.
pub const LEAST_SIDE: usize = 40;
/// The side of a patch, as a share of the picture's shorter side.
const PATCH: f64 = 0.55;
/// How far patches are looked for around where the whole picture is, at most.
const REACH: usize = 16;
/// How far around a peak the surface still belongs to it.
const APART: usize = 3;
/// The whole picture's peak in the small picture, in standard deviations.
const LEAST_Z: f64 = 5.0;
/// How far patches may be from the shift, or shift and turn, that they agree on, in pixels.
const AGREE_PX: f64 = 0.75;
/// The share of all patches that must agree.
const AGREEING: f64 = 0.6;
/// How much less of the squares a turn and scale must leave than a shift alone to be believed.
const TURNED: f64 = 0.2;
/// How many pixels of the picture make one of the small picture, in which all of it is shifted.
const SMALL: usize = 5;
/// How many times the gradient in the middle of all, and at least how much of white, counts by
/// half: what is much steeper counts hardly more.
const HALF: [f32; 2] = [3.0, 0.5 / 255.0];

/// A picture made ready for comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Detail {
    size: [usize; 2],
    /// How steep it is, from nothing to 255.
    steepness: Vec<u8>,
}

impl Detail {
    /// Of grey values around 0…1, encoded for the eye, in rows. `None` where the picture is smaller
    /// than [`LEAST_SIDE`].
    pub fn new(values: &[f32], size: [usize; 2]) -> Option<Self> {
        let [width, height] = size;
        if width.min(height) < LEAST_SIDE || values.len() != width * height {
            return None;
        }
        let steepness = steepness(values, width);
        Some(Self {
            size,
            steepness: steepness
                .iter()
                .map(|v| (v * 255.0).round() as u8)
                .collect(),
        })
    }

    fn field(&self) -> Option<Field> {
        let values = self.steepness.iter().map(|v| f32::from(*v));
        field(values.collect(), self.size[0])
    }

    fn small(&self) -> Option<Field> {
        let [width, height] = self.size;
        let [w, h] = [width / SMALL, height / SMALL];
        let sum = |i: usize| {
            let corner = i / w * SMALL * width + i % w * SMALL;
            let rows = (0..SMALL).map(|y| corner + y * width);
            let values = rows.flat_map(|from| &self.steepness[from..from + SMALL]);
            values.map(|v| f32::from(*v)).sum()
        };
        field((0..w * h).map(sum).collect(), w)
    }
}

/// From places in the first picture to the same places in the second, in pixels; both have one
/// size. `None` where too little of them says the same.
pub fn motion(first: &Detail, second: &Detail) -> Option<DAffine2> {
    if first.size != second.size {
        return None;
    }
    let whole = shift_of_all(&first.small()?, &second.small()?);
    let whole = whole.map(|by| by.map(|v| v * SMALL as i64));
    // Of equal ones the last is taken, which did not move.
    let starts = [whole.filter(|by| *by != [0, 0]), Some([0, 0])];
    let (first, second) = (first.field()?, second.field()?);
    let motions = starts
        .into_iter()
        .flatten()
        .filter_map(|start| near(&first, &second, start));
    motions
        .max_by_key(|(_, patches)| *patches)
        .map(|(by, _)| by)
}

/// The shift of all of a small picture, in whole pixels.
fn shift_of_all(first: &Field, second: &Field) -> Option<[i64; 2]> {
    let shorter = first.width.min(first.height);
    let (side, reach) = (shorter / 2, shorter / 4);
    if reach < 3 {
        return None;
    }
    let corner = [(first.width - side) / 2, (first.height - side) / 2];
    let correlator = Correlator::new(side, reach, 2);
    let peak = correlator.best(first, second, corner, Sign::Same)?;
    (peak.z >= LEAST_Z).then(|| peak.shift.map(|v| v.round() as i64))
}

/// How it lies near a shift in whole pixels, and how many patches say so.
fn near(first: &Field, second: &Field, start: [i64; 2]) -> Option<(DAffine2, usize)> {
    let shifted = moved_back(second, start);
    let shorter = first.width.min(first.height);
    let side = (PATCH * shorter as f64) as usize;
    let correlator = Correlator::new(side, REACH.min(shorter / 5), APART);
    // Three along the longer side and two along the other overlap a little.
    let corners = |length: usize, count: usize| {
        let room = length - side;
        (0..count).map(move |i| room * i / (count - 1))
    };
    let (across, down) = match first.width >= first.height {
        true => (3, 2),
        false => (2, 3),
    };
    let places =
        corners(first.height, down).flat_map(|y| corners(first.width, across).map(move |x| [x, y]));
    let start = DVec2::new(start[0] as f64, start[1] as f64);
    let found: Vec<ControlPoint> = places
        .filter_map(|corner| {
            let peak = correlator.best(first, &shifted, corner, Sign::Same)?;
            let at = DVec2::from(peak.at);
            Some((at + DVec2::from(peak.shift) + start, at))
        })
        .collect();
    let needed = (AGREEING * (across * down) as f64).ceil() as usize;
    agreed(&found, needed)
}

/// What most patches agree on: places in the second picture and in the first.
fn agreed(found: &[ControlPoint], needed: usize) -> Option<(DAffine2, usize)> {
    let shifts: Vec<DAffine2> = found
        .iter()
        .map(|(to, from)| DAffine2::from_translation(*to - *from))
        .collect();
    let pairs = (0..found.len()).flat_map(|a| (0..a).map(move |b| [found[a], found[b]]));
    let turns = pairs.filter_map(|pair| similarity(&pair).ok().map(|fit| fit.px_from_mm));
    let near = |by: &DAffine2| -> Vec<ControlPoint> {
        let off = |(to, from): &ControlPoint| by.transform_point2(*from).distance(*to);
        let near = found.iter().filter(|point| off(point) <= AGREE_PX);
        near.copied().collect()
    };
    let squares = |by: &DAffine2, of: &[ControlPoint]| -> f64 {
        of.iter()
            .map(|(to, from)| by.transform_point2(*from).distance_squared(*to))
            .sum()
    };
    let shift = |of: &[ControlPoint]| {
        let sum: DVec2 = of.iter().map(|(to, from)| *to - *from).sum();
        DAffine2::from_translation(sum / of.len().max(1) as f64)
    };
    let most = |candidates: &mut dyn Iterator<Item = DAffine2>| {
        candidates
            .map(|by| near(&by))
            .max_by_key(Vec::len)
            .unwrap_or_default()
    };
    let shifted = most(&mut shifts.iter().copied());
    let turned = most(&mut turns.into_iter());
    let by_shift = shift(&shifted);
    let by_turn = similarity(&turned).ok().map(|fit| fit.px_from_mm);
    // Three patches can be turned onto anything that two of them say.
    let more = turned.len() > shifted.len().max(3);
    let better = |by: &DAffine2| {
        turned.len() >= shifted.len().max(4)
            && squares(by, &turned) < TURNED * squares(&shift(&turned), &turned)
            // Below that it is noise.
            && squares(&shift(&turned), &turned) > AGREE_PX.powi(2)
    };
    match by_turn {
        Some(by) if turned.len() >= needed && (more || better(&by)) => Some((by, turned.len())),
        _ => (shifted.len() >= needed).then_some((by_shift, shifted.len())),
    }
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
