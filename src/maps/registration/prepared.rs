//! Two pictures made ready to be correlated: at one scale, freed of shading, with what tells
//! nothing masked.

use glam::DVec2;
use rayon::prelude::*;

use super::{
    correlate::{Correlator, Field, Sign},
    propose::{Grey, LEAST_SIDE, LEAST_Z, Mismatch, Which},
};

/// Longest side worked at, in pixels: at 0.125 mm a pixel on a leaf of 225 mm, strokes of a pen
/// are still wider than a pixel.
const LONGEST_SIDE: f64 = 1800.0;

/// Largest patch with its reach on both sides, in pixels: this bounds the time.
const LONGEST_WINDOW: f64 = 1000.0;

/// 600 pixels at 400 dpi: residue is so faint that it takes this much of a page to see it.
const VERSO_PATCH_MM: f64 = 38.1;

/// Wider than a stroke of the pen, narrower than shading and stains.
const HIGH_PASS_MM: f64 = 2.0;

/// Blur of the edge of ink, which is masked with it.
const INK_EDGE_MM: f64 = 0.25;

/// The share of a picture that is sure to be ink, where it is darkest.
const DARKEST: f64 = 0.005;

/// What is fainter than this share of the ink's darkness may be residue.
const RESIDUE: f32 = 0.25;

/// Two sheets cut to one size agree in their edges, whatever is drawn on them: the outermost
/// share of the shorter side is left out in two states.
const MARGIN: f64 = 0.02;

/// What two pictures are of: states or bands of one side, or the two sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    States,
    Verso,
}

/// Both pictures at one scale, ready to be correlated.
pub(super) struct Prepared {
    first: Field,
    second: Field,
    pub mm_per_px: f64,
    side: usize,
    reach: usize,
    high_pass: usize,
}

impl Prepared {
    pub fn new(first: &Grey, second: &Grey, reach_mm: f64, kind: Kind) -> Result<Self, Mismatch> {
        for (which, grey) in [(Which::First, first), (Which::Second, second)] {
            let count = grey.width.checked_mul(grey.height);
            if grey.values.is_empty() || count != Some(grey.values.len()) {
                return Err(Mismatch::NoPicture(which));
            }
            if !(grey.mm_per_px.is_normal() && grey.mm_per_px > 0.0) {
                return Err(Mismatch::NoScale(which));
            }
        }
        if !(reach_mm.is_finite() && reach_mm > 0.0) {
            return Err(Mismatch::NoReach);
        }
        let size_mm =
            |grey: &Grey| DVec2::new(grey.width as f64, grey.height as f64) * grey.mm_per_px;
        let smaller = size_mm(first).min_element();
        let patch_mm = match kind {
            Kind::States => smaller / 8.0,
            Kind::Verso => VERSO_PATCH_MM.min(smaller / 3.0),
        };
        let mm_per_px = [
            second.mm_per_px,
            size_mm(first).max_element() / LONGEST_SIDE,
            size_mm(second).max_element() / LONGEST_SIDE,
            (patch_mm + 2.0 * reach_mm) / LONGEST_WINDOW,
        ]
        .into_iter()
        .fold(first.mm_per_px, f64::max);
        let resampled = |which, grey: &Grey| {
            let length = |count: usize| (count as f64 * grey.mm_per_px / mm_per_px + 1e-6) as usize;
            let (width, height) = (length(grey.width), length(grey.height));
            if width.min(height) < LEAST_SIDE {
                return Err(Mismatch::TooSmall(which));
            }
            Ok(Picture::new(
                grey,
                mm_per_px / grey.mm_per_px,
                width,
                height,
            ))
        };
        let one = resampled(Which::First, first)?;
        let mut two = resampled(Which::Second, second)?;
        if kind == Kind::Verso {
            two.mirror();
        }
        let px = |mm: f64| (mm / mm_per_px).round() as usize;
        let high_pass = px(HIGH_PASS_MM).clamp(3, LEAST_SIDE / 8);
        let edge = px(INK_EDGE_MM).max(1);
        let fields = match kind {
            Kind::States => [one.detail(high_pass), two.detail(high_pass)],
            Kind::Verso => [one.residue(high_pass, edge), two.ink(high_pass)],
        };
        let [first, second] = fields;
        Ok(Self {
            first: first.ok_or(Mismatch::Flat(Which::First))?,
            second: second.ok_or(Mismatch::Flat(Which::Second))?,
            mm_per_px,
            side: px(patch_mm).max(LEAST_SIDE / 2),
            // A surface of fewer shifts has no statistics.
            reach: px(reach_mm).max(2 * high_pass),
            high_pass,
        })
    }

    pub fn diagonal_mm(&self) -> f64 {
        (self.first.width as f64).hypot(self.first.height as f64) * self.mm_per_px
    }

    /// Places, shifts in pixels and z of the patches found, and how many were looked for.
    pub fn peaks(&self, kind: Kind) -> (Vec<(DVec2, DVec2, f64)>, usize) {
        // Patches overlap by half, but no more of them than bear on the result.
        let corners = |length: usize| -> Vec<usize> {
            let room = length - self.side;
            let count = (2 * room / self.side).clamp(1, 9);
            (0..=count).map(|i| room * i / count).collect()
        };
        let places: Vec<[usize; 2]> = corners(self.first.height)
            .into_iter()
            .flat_map(|y| corners(self.first.width).into_iter().map(move |x| [x, y]))
            .filter(|&corner| self.contrast(corner))
            .collect();
        let correlator = Correlator::new(self.side, self.reach, self.high_pass);
        let sign = match kind {
            Kind::States => Sign::Either,
            Kind::Verso => Sign::Same,
        };
        let found = places
            .par_iter()
            .filter_map(|&corner| {
                let peak = correlator.best(&self.first, &self.second, corner, sign)?;
                let [at, shift] = [peak.at, peak.shift].map(DVec2::from);
                (peak.z.abs() >= LEAST_Z).then_some((at, shift, peak.z))
            })
            .collect();
        (found, places.len())
    }

    /// Whether a patch shows anything: a tenth of the variance of the whole picture, which is 1.
    fn contrast(&self, [left, top]: [usize; 2]) -> bool {
        let rows = (top..top + self.side).map(|y| y * self.first.width + left);
        let energy: f32 = rows
            .flat_map(|start| start..start + self.side)
            .map(|i| self.first.trust[i] * self.first.values[i].powi(2))
            .sum();
        energy > 0.1 * (self.side * self.side) as f32
    }
}

/// A picture at the scale worked at, with no value that is not finite.
struct Picture {
    width: usize,
    height: usize,
    values: Vec<f32>,
    known: Vec<f32>,
}

impl Picture {
    /// Each pixel the mean of the `ratio`² pixels that it covers.
    fn new(grey: &Grey, ratio: f64, width: usize, height: usize) -> Self {
        let known: Vec<f32> = grey
            .values
            .iter()
            .map(|v| f32::from(u8::from(v.is_finite())))
            .collect();
        let finite: Vec<f32> = grey
            .values
            .iter()
            .map(|v| {
                if v.is_finite() {
                    v.clamp(0.0, 1.0)
                } else {
                    0.0
                }
            })
            .collect();
        let shrunk = |values: &[f32]| {
            let rows = shrink_rows(values, grey.width, ratio, width);
            let columns = shrink_rows(&transpose(&rows, width), grey.height, ratio, height);
            transpose(&columns, height)
        };
        let (sums, known) = (shrunk(&finite), shrunk(&known));
        let values = divide(&sums, &known);
        let known = known
            .iter()
            .map(|&v| f32::from(u8::from(v > 0.5)))
            .collect();
        Self {
            width,
            height,
            values,
            known,
        }
    }

    fn mirror(&mut self) {
        for plane in [&mut self.values, &mut self.known] {
            plane.par_chunks_mut(self.width).for_each(<[f32]>::reverse);
        }
    }

    /// Every pixel less the mean of the trusted ones about it.
    fn high_pass(&self, trust: &[f32], radius: usize) -> Vec<f32> {
        let weighted: Vec<f32> = self.values.iter().zip(trust).map(|(v, t)| v * t).collect();
        let blurred = |values: &[f32]| {
            let rows = blur_rows(values, self.width, radius);
            let columns = blur_rows(&transpose(&rows, self.width), self.height, radius);
            transpose(&columns, self.height)
        };
        let smooth = divide(&blurred(&weighted), &blurred(trust));
        self.values
            .iter()
            .zip(smooth)
            .zip(trust)
            .map(|((v, s), t)| (v - s) * t)
            .collect()
    }

    fn field(self, mut values: Vec<f32>, trust: Vec<f32>) -> Option<Field> {
        let deviation = root_mean_square(&values, &trust);
        // A thousandth of the range is less than the steps of 8 bits.
        if deviation.is_nan() || deviation <= 1e-3 {
            return None;
        }
        for v in &mut values {
            *v /= deviation;
        }
        Some(Field {
            width: self.width,
            height: self.height,
            values,
            trust,
        })
    }

    /// What two states of a side have in common.
    fn detail(self, radius: usize) -> Option<Field> {
        let high = self.high_pass(&self.known, radius);
        let margin = (self.width.min(self.height) as f64 * MARGIN).ceil() as usize;
        let within = |i: usize, length: usize| (margin..length - margin).contains(&i);
        let trust: Vec<f32> = (0..high.len())
            .map(|i| (i % self.width, i / self.width, self.known[i]))
            .map(|(x, y, known)| {
                let inside = within(x, self.width) && within(y, self.height);
                if inside { known } else { 0.0 }
            })
            .collect();
        // A blot would outweigh all of the drawing.
        let limit = 3.0 * root_mean_square(&high, &trust);
        let values = high
            .iter()
            .zip(&trust)
            .map(|(v, t)| v.min(limit).max(-limit) * t)
            .collect();
        self.field(values, trust)
    }

    /// The dark ink of a side, without the faint residue of the other side's.
    fn ink(self, radius: usize) -> Option<Field> {
        let high = self.high_pass(&self.known, radius);
        let limit = ink_threshold(&high);
        // Every mark of ink says as much as another, and an edge of the sheet no more.
        let deep = quantile(high.clone(), DARKEST) + limit;
        let values = high
            .iter()
            .map(|&v| (v + limit).min(0.0).max(deep))
            .collect();
        let trust = self.known.clone();
        self.field(values, trust)
    }

    /// What is left of a side where its own ink, and every edge, is masked.
    fn residue(self, radius: usize, edge: usize) -> Option<Field> {
        let high = self.high_pass(&self.known, radius);
        let limit = ink_threshold(&high);
        let marked: Vec<f32> = high
            .iter()
            .zip(&self.known)
            .map(|(v, &known)| f32::from(u8::from(v.abs() > limit || known == 0.0)))
            .collect();
        let spread = |values: &[f32]| {
            let rows = blur_rows(values, self.width, edge);
            transpose(
                &blur_rows(&transpose(&rows, self.width), self.height, edge),
                self.height,
            )
        };
        let trust: Vec<f32> = spread(&marked)
            .iter()
            .map(|&v| f32::from(u8::from(v < 1e-4)))
            .collect();
        let values = self.high_pass(&trust, radius);
        self.field(values, trust)
    }
}

/// A share of how much darker than its surroundings the ink is: residue is fainter.
fn ink_threshold(high: &[f32]) -> f32 {
    -RESIDUE * quantile(high.to_vec(), DARKEST)
}

/// Over the trusted values; not a number where there are none.
fn root_mean_square(values: &[f32], trust: &[f32]) -> f32 {
    let weighted = |(&v, &t): (&f32, &f32)| f64::from(v * v) * f64::from(t);
    let sum: f64 = values.iter().zip(trust).map(weighted).sum();
    let count: f64 = trust.iter().map(|&t| f64::from(t)).sum();
    (sum / count).sqrt() as f32
}

/// The value below which a share of the values lies; 0 of none.
fn quantile(mut values: Vec<f32>, share: f64) -> f32 {
    if values.is_empty() {
        return 0.0;
    }
    let at = ((values.len() - 1) as f64 * share) as usize;
    *values.select_nth_unstable_by(at, f32::total_cmp).1
}

/// Sums by their counts, 0 where nothing was counted.
fn divide(sums: &[f32], counts: &[f32]) -> Vec<f32> {
    sums.iter()
        .zip(counts)
        .map(|(s, &c)| if c > 1e-6 { s / c } else { 0.0 })
        .collect()
}

fn transpose(values: &[f32], width: usize) -> Vec<f32> {
    let height = values.len() / width;
    let mut columns = vec![0.0; values.len()];
    columns
        .par_chunks_mut(height)
        .enumerate()
        .for_each(|(x, column)| {
            for (y, v) in column.iter_mut().enumerate() {
                *v = values[y * width + x];
            }
        });
    columns
}

/// Mean of each row over ±`radius`, shrunk at the ends.
fn blur_rows(values: &[f32], width: usize, radius: usize) -> Vec<f32> {
    let mut blurred = vec![0.0; values.len()];
    blurred
        .par_chunks_mut(width)
        .zip(values.par_chunks(width))
        .for_each(|(to, from)| {
            let sums = running_sums(from);
            for (x, v) in to.iter_mut().enumerate() {
                let [start, end] = [x.saturating_sub(radius), (x + radius + 1).min(width)];
                *v = ((sums[end] - sums[start]) / (end - start) as f64) as f32;
            }
        });
    blurred
}

/// Each row at `to_width` pixels, each the mean of the `ratio` pixels that it covers.
fn shrink_rows(values: &[f32], width: usize, ratio: f64, to_width: usize) -> Vec<f32> {
    let mut shrunk = vec![0.0; values.len() / width * to_width];
    shrunk
        .par_chunks_mut(to_width)
        .zip(values.par_chunks(width))
        .for_each(|(to, from)| {
            let sums = running_sums(from);
            let sum_to = |x: f64| {
                let x = x.min(width as f64);
                let whole = (x as usize).min(width - 1);
                sums[whole] + f64::from(from[whole]) * (x - whole as f64)
            };
            for (x, v) in to.iter_mut().enumerate() {
                let [start, end] = [x as f64 * ratio, (x + 1) as f64 * ratio];
                *v = ((sum_to(end) - sum_to(start)) / ratio) as f32;
            }
        });
    shrunk
}

fn running_sums(row: &[f32]) -> Vec<f64> {
    let mut sum = 0.0;
    std::iter::once(0.0)
        .chain(row.iter().map(|&v| {
            sum += f64::from(v);
            sum
        }))
        .collect()
}
