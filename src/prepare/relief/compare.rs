//! Surfaces of one sheet in comparison, and planes taken out of them.

#![allow(
    clippy::needless_range_loop,
    reason = "several arrays run along one index, as their formulas do"
)]

use rayon::prelude::*;

use super::real::Real;
use crate::prepare::linear::solve_positive;

/// Mean and standard deviation of a difference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    pub mean: f64,
    pub sigma: f64,
    /// How many places it is of.
    pub count: usize,
}

/// How two surfaces differ, in their unit, once shift and tilt of the whole are taken out.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    pub whole: Spread,
    /// For each size of patches in mm, the patches in rows from the top left; those that the sheet
    /// does not fill are left out.
    pub patches: Vec<(f64, Vec<Spread>)>,
}

impl Comparison {
    /// A table of a report, in µm, of the surface `other`.
    pub(in crate::prepare) fn table(&self, other: &str) -> String {
        let Spread { sigma, count, .. } = self.whole;
        let mut out = format!(
            "<h3>In comparison with {other}</h3><p>Shift and tilt of the whole taken out.</p><table>\
             <tr><th>Where<th>Mean<th>σ<tr><td>all of it, {count} places<td>0.0 µm<td>{sigma:.1} µm"
        );
        for (mm, patches) in &self.patches {
            for (i, Spread { mean, sigma, .. }) in patches.iter().enumerate() {
                out += &format!(
                    "<tr><td>patch {} of {mm:.0} mm<td>{mean:.1} µm<td>{sigma:.1} µm",
                    i + 1
                );
            }
            if patches.is_empty() {
                out += &format!("<tr><td>patches of {mm:.0} mm<td colspan=2>larger than the sheet");
            }
        }
        out + "</table>"
    }
}

/// The sizes of patches that the article compares over, in mm.
pub const PATCHES_MM: [f64; 2] = [100.0, 50.0];

/// Compares heights `a` with `b`, pictures of one size; NaN is a hole in either. `None` where less
/// than three places are in both.
pub fn compare(
    a: &[f64],
    b: &[f64],
    width: usize,
    mm_per_px: f64,
    patches_mm: &[f64],
) -> Option<Comparison> {
    let difference = a.iter().zip(b).map(|(a, b)| a - b).collect();
    of_difference(difference, width, mm_per_px, patches_mm)
}

/// As [`compare`], of heights less those that they are compared with.
pub(super) fn of_difference(
    mut difference: Vec<f64>,
    width: usize,
    mm_per_px: f64,
    patches_mm: &[f64],
) -> Option<Comparison> {
    remove_plane(&mut difference, width)?;
    let whole = spread(difference.iter().copied())?;
    let height = difference.len() / width;
    let of_size = |mm: f64| {
        let side = ((mm / mm_per_px).round() as usize).max(1);
        let mut patches = Vec::new();
        for top in (0..height).step_by(side).filter(|top| top + side <= height) {
            for left in (0..width).step_by(side).filter(|left| left + side <= width) {
                let rows = top..top + side;
                let values = rows
                    .flat_map(|y| &difference[y * width + left..y * width + left + side])
                    .copied();
                patches.extend(spread(values));
            }
        }
        (mm, patches)
    };
    Some(Comparison {
        whole,
        patches: patches_mm.iter().map(|mm| of_size(*mm)).collect(),
    })
}

fn spread(values: impl Iterator<Item = f64>) -> Option<Spread> {
    // Welford's sums do not cancel.
    let (mut count, mut mean, mut squares) = (0usize, 0.0, 0.0);
    for value in values.filter(|value| value.is_finite()) {
        count += 1;
        let off = value - mean;
        mean += off / count as f64;
        squares += off * (value - mean);
    }
    (count > 0).then(|| Spread {
        mean,
        sigma: (squares / count as f64).sqrt(),
        count,
    })
}

/// Takes the plane nearest to the heights out of them, and gives it: its height in the middle of
/// the picture and its slopes per pixel to the right and down. Holes (NaN) stay. `None` where
/// fewer than three places, or places on one line, are known.
pub fn remove_plane<T: Real>(heights: &mut [T], width: usize) -> Option<[f64; 3]> {
    let height = heights.len().checked_div(width)?;
    let (middle_x, middle_y) = ((width as f64 - 1.0) / 2.0, (height as f64 - 1.0) / 2.0);
    // Of each row: how many are known, Σx, Σx², Σh and Σxh, in lanes.
    let sums = |row: &[T]| {
        let mut sums = [[0.0; LANES]; 5];
        for (i, heights) in row.chunks(LANES).enumerate() {
            let first = (i * LANES) as f64 - middle_x;
            for (lane, h) in heights.iter().enumerate() {
                let (x, h) = (first + lane as f64, h.wide());
                let (known, h) = if h.is_finite() { (1.0, h) } else { (0.0, 0.0) };
                let terms = [known, known * x, known * x * x, h, x * h];
                for (sum, term) in sums.iter_mut().zip(terms) {
                    sum[lane] += term;
                }
            }
        }
        sums.map(|lanes| lanes.iter().sum::<f64>())
    };
    let rows: Vec<[f64; 5]> = heights.par_chunks(width).map(sums).collect();
    let mut a = vec![vec![0.0; 3]; 3];
    let mut b = vec![0.0; 3];
    for (y, [count, x, x_2, h, x_h]) in rows.into_iter().enumerate() {
        let y = y as f64 - middle_y;
        let terms = [
            [count, x, count * y],
            [x, x_2, x * y],
            [count * y, x * y, count * y * y],
        ];
        for (a, terms) in a.iter_mut().zip(terms) {
            for (a, term) in a.iter_mut().zip(terms) {
                *a += term;
            }
        }
        for (b, term) in b.iter_mut().zip([h, x_h, h * y]) {
            *b += term;
        }
    }
    let plane: [f64; 3] = solve_positive(&a, &[b])?.pop()?.try_into().ok()?;
    let [middle, right, down] = plane;
    let rows = heights.par_chunks_mut(width).enumerate();
    rows.for_each(|(y, row)| {
        let level = middle + down * (y as f64 - middle_y);
        for (x, value) in row.iter_mut().enumerate() {
            *value = T::of(value.wide() - (level + right * (x as f64 - middle_x)));
        }
    });
    Some(plane)
}

/// Heights that are looked at together.
const LANES: usize = 8;
/// Least and most of no heights.
const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

fn both(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// Of the finite heights, in lanes, which do not wait for each other.
fn least_and_most<T: Real>(heights: &[T]) -> [f64; 2] {
    let one = |h: &T| match h.wide() {
        h if h.is_finite() => [h, h],
        _ => NOTHING,
    };
    let (whole, rest) = heights.as_chunks::<LANES>();
    let mut lanes = [NOTHING; LANES];
    for heights in whole {
        for (lane, h) in lanes.iter_mut().zip(heights) {
            *lane = both(*lane, one(h));
        }
    }
    let rest = rest.iter().map(one);
    lanes.into_iter().chain(rest).fold(NOTHING, both)
}

/// The range of heights between these shares of all places (such as 0.001 and 0.999, so that
/// single pixels do not decide). `None` where there is none.
pub fn range<T: Real>(heights: &[T], [low, high]: [f64; 2]) -> Option<[f64; 2]> {
    if low <= 0.0 && high >= 1.0 {
        let [least, most] = heights
            .par_chunks(LANES << 10)
            .map(least_and_most)
            .reduce(|| NOTHING, both);
        return (least <= most).then_some([least, most]);
    }
    let known = heights.iter().map(|h| h.wide());
    let mut sorted: Vec<f64> = known.filter(|h| h.is_finite()).collect();
    let last = sorted.len().checked_sub(1)?;
    let mut at = |share: f64| {
        let i = ((share.clamp(0.0, 1.0) * last as f64).round() as usize).min(last);
        *sorted.select_nth_unstable_by(i, f64::total_cmp).1
    };
    Some([at(low), at(high)])
}
