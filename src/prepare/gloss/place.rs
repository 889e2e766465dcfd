//! The normal and the albedo with which the study tier comes nearest to all photographs of a place.
//!
//! What is sought: the slopes of the normal, and the logarithm of the albedo without what the
//! surface itself adds, so that it never is below none, where nothing would change with it.

#![allow(
    clippy::needless_range_loop,
    reason = "several arrays run along one index, as their formulas do"
)]

use glam::DVec3;

use super::samples::Place;
use crate::prepare::{linear::solve_positive, model::Spot};

/// Noise of a photograph: of white, and of the value.
const NOISE: [f64; 2] = [0.0015, 0.01];
/// How many times the noise is an outlier.
pub(super) const OUTLIER: f64 = 3.0;
/// How well stereo knows a slope where it did not know the gloss.
const SLOPE_OFF: f64 = 0.3;
/// Shares of stereo's slope that each place's fit starts from, the first time: a narrow gleam has
/// turned it towards a lamp.
const STARTS: [f64; 3] = [1.0, 0.5, 0.0];
/// What slopes and the logarithm of an albedo move by for their derivatives.
const STEP: f64 = 1e-4;
/// Light from below the surface that is as good as none.
const BLACK: f64 = 1e-4;
/// The least of it that a fit starts from.
const DARK: f64 = 3e-3;

/// Of a surface that faces along `n`.
pub(super) fn slopes(n: DVec3) -> [f64; 2] {
    let up = n.z.max(0.1);
    [n.x / up, n.y / up]
}

fn noise(shown: f64) -> f64 {
    NOISE[0] + NOISE[1] * shown.max(0.0)
}

/// Cauchy's, of what is left over.
pub(super) fn weight(off: f64, shown: f64) -> f64 {
    let u = off / (OUTLIER * noise(shown));
    1.0 / (1.0 + u * u)
}

pub(super) fn left_over(
    spot: &mut Spot<'_>,
    place: &Place,
    lamps: &[(DVec3, f64)],
    found: &[f64; 5],
) -> Vec<DVec3> {
    let [p, q, r, g, b] = *found;
    let normal = DVec3::new(p, q, 1.0).normalize();
    spot.set_albedo(below([r, g, b]) + spot.floor());
    let each = lamps.iter().zip(&place.shown);
    each.map(|((l, gain), shown)| spot.shown(normal, *l) * *gain - *shown)
        .collect()
}

/// What is left over of a place, outliers by their weight, and of what is known of its normal.
fn sum(off: &[DVec3], place: &Place, found: &[f64; 5]) -> f64 {
    let s = OUTLIER * OUTLIER;
    let each = off.iter().zip(&place.shown).flat_map(|(off, shown)| {
        (0..3).map(|c| {
            let u = off[c] / noise(shown[c]);
            s * (u * u / s).ln_1p()
        })
    });
    let known = slopes(place.normal);
    let moved = (0..2).map(|i| ((found[i] - known[i]) / SLOPE_OFF).powi(2));
    each.sum::<f64>() + moved.sum::<f64>()
}

/// What a place's fit starts from, by what stereo found.
pub(super) fn start(spot: &Spot<'_>, place: &Place) -> [f64; 5] {
    let [p, q] = slopes(place.normal);
    let below = place.albedo - spot.floor();
    let [r, g, b] = below.to_array().map(|v| v.max(DARK).ln());
    [p, q, r, g, b]
}

/// The albedo that a fit found.
pub(super) fn albedo(spot: &Spot<'_>, [_, _, r, g, b]: &[f64; 5]) -> DVec3 {
    below([*r, *g, *b]) + spot.floor()
}

fn below(logarithms: [f64; 3]) -> DVec3 {
    let least = DVec3::splat(BLACK.ln());
    DVec3::from(logarithms).clamp(least, DVec3::ZERO).exp()
}

/// As [`settle`], from several slopes: a narrow gleam has turned stereo's towards a lamp.
pub(super) fn settle_anew(
    spot: &mut Spot<'_>,
    place: &Place,
    lamps: &[(DVec3, f64)],
    found: &mut [f64; 5],
    steps: usize,
) -> f64 {
    let mut best: Option<(f64, [f64; 5])> = None;
    for share in STARTS {
        let mut start = *found;
        start[..2].iter_mut().for_each(|slope| *slope *= share);
        let left = settle(spot, place, lamps, &mut start, steps);
        if best.is_none_or(|(least, _)| left < least) {
            best = Some((left, start));
        }
    }
    let (left, start) = best.unwrap_or((0.0, *found));
    *found = start;
    left
}

/// Brings a place's normal and albedo nearest to its photographs (Levenberg & Marquardt), and
/// gives what is left over.
pub(super) fn settle(
    spot: &mut Spot<'_>,
    place: &Place,
    lamps: &[(DVec3, f64)],
    found: &mut [f64; 5],
    steps: usize,
) -> f64 {
    let mut off = left_over(spot, place, lamps, found);
    let mut least = sum(&off, place, found);
    let known = slopes(place.normal);
    let mut damping = 1e-3;
    for _ in 0..steps {
        let moved = |spot: &mut Spot<'_>, which: std::ops::Range<usize>| {
            let mut moved = *found;
            moved[which].iter_mut().for_each(|v| *v += STEP);
            left_over(spot, place, lamps, &moved)
        };
        // A channel's albedo changes its own light alone, or nearly so.
        let by = [moved(spot, 0..1), moved(spot, 1..2), moved(spot, 2..5)];
        let mut a = vec![vec![0.0; 5]; 5];
        let mut right = vec![0.0; 5];
        for i in 0..2 {
            a[i][i] += 1.0 / (SLOPE_OFF * SLOPE_OFF);
            right[i] += (known[i] - found[i]) / (SLOPE_OFF * SLOPE_OFF);
        }
        for (k, shown) in place.shown.iter().enumerate() {
            for c in 0..3 {
                let w = weight(off[k][c], shown[c]) / noise(shown[c]).powi(2);
                let mut row = [0.0; 5];
                row[0] = (by[0][k][c] - off[k][c]) / STEP;
                row[1] = (by[1][k][c] - off[k][c]) / STEP;
                row[2 + c] = (by[2][k][c] - off[k][c]) / STEP;
                for i in 0..5 {
                    right[i] -= w * row[i] * off[k][c];
                    for j in 0..5 {
                        a[i][j] += w * row[i] * row[j];
                    }
                }
            }
        }
        let mut taken = false;
        while damping < 1e4 {
            let mut damped = a.clone();
            for (i, row) in damped.iter_mut().enumerate() {
                row[i] *= 1.0 + damping;
                row[i] += 1e-9;
            }
            let step = solve_positive(&damped, std::slice::from_ref(&right));
            let Some(step) = step.and_then(|steps| steps.into_iter().next()) else {
                break;
            };
            let next: [f64; 5] = std::array::from_fn(|i| found[i] + step[i]);
            let left = left_over(spot, place, lamps, &next);
            let less = sum(&left, place, &next);
            if less < least {
                (*found, off, least) = (next, left, less);
                damping = (damping * 0.1).max(1e-6);
                taken = true;
                break;
            }
            damping *= 10.0;
        }
        if !taken {
            break;
        }
    }
    least
}
