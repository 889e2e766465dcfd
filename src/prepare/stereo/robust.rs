//! Which photographs are believed at a place: shadows and highlights are told from the rest by
//! what they leave over of the least squares.
//!
//! With five lamps or more, a photograph that lies off what the others agree on loses its weight
//! (first by absolute residuals, which find the majority, then by Tukey's biweight, which forgets
//! the rest). With four there is one equation too many, and the residual alone cannot say which is
//! wrong; but a cast shadow is dark and a highlight bright, and lies near the mirror's angle.
//!
//! The article's way is kept beside it: the brightest and the darkest are left out (Apollonio,
//! Foschi, Gaiani & Garagnani 2021), unless the place is matte already, which is the same test of
//! the residual that calls this module at all.

#![allow(
    clippy::needless_range_loop,
    reason = "several arrays run along one index, as their formulas do"
)]

use glam::DVec3;

use super::block::{LANES, Lamps, Lane, Lane3, solve_weighted};
use crate::prepare::capture::Robustness;

/// Rounds of absolute residuals.
const ABSOLUTE: usize = 6;
/// Rounds of the biweight.
const BIWEIGHT: usize = 4;
/// Tukey's constant: 95 % as good as plain least squares on normal noise.
const TUKEY: f32 = 4.685;
/// Keeps normal equations regular where hardly any photograph is believed.
const LEAST_WEIGHT: f32 = 1e-4;
/// What a lamp shows of a place in its cast shadow, over what it would show without it, at most:
/// light from the rest of the room and from the sheet itself.
const SHADOWED: f32 = 0.5;
/// n·l over gain below which a lamp grazes the place and says nothing.
const GRAZING: f32 = 0.02;

/// The volume that three unit vectors span, at least: flatter, they say nothing of a fourth.
const FLATTEST: f64 = 1e-9;

/// Weights of each photograph in a block: `v` is what a diffuser would show, `g` the plain
/// solution, `noise` the usual residual over the mean value.
pub fn weights(
    robustness: Robustness,
    lamps: &Lamps,
    v: &[Lane],
    g: &Lane3,
    noise: f32,
) -> Vec<Lane> {
    match (robustness, lamps.count()) {
        (Robustness::None, _) | (_, 0..=3) => vec![[1.0; LANES]; lamps.count()],
        (Robustness::Drop, 4) => one_of_four(lamps, v, true),
        (Robustness::Robust, 4) => one_of_four(lamps, v, false),
        (Robustness::Drop, _) => without_extremes(lamps, v),
        (Robustness::Robust, _) => reweighted(lamps, v, g, noise),
    }
}

/// Leaves the brightest and the darkest out, each for what its lamp gives.
fn without_extremes(lamps: &Lamps, v: &[Lane]) -> Vec<Lane> {
    let mut w = vec![[1.0; LANES]; v.len()];
    for lane in 0..LANES {
        let shown = |i: usize| v[i][lane] / lamps.gain[i][lane];
        let order = |a: &usize, b: &usize| shown(*a).total_cmp(&shown(*b));
        let extremes = [(0..v.len()).min_by(order), (0..v.len()).max_by(order)];
        for i in extremes.into_iter().flatten() {
            w[i][lane] = LEAST_WEIGHT;
        }
    }
    w
}

fn reweighted(lamps: &Lamps, v: &[Lane], g: &Lane3, noise: f32) -> Vec<Lane> {
    let count = v.len();
    let mut w = vec![[1.0; LANES]; count];
    let mut g = *g;
    let mut mean = [0.0; LANES];
    for values in v {
        for lane in 0..LANES {
            mean[lane] += values[lane].abs() / count as f32;
        }
    }
    for round in 0..ABSOLUTE + BIWEIGHT {
        for i in 0..count {
            let [lx, ly, lz] = &lamps.l[i];
            let gain = &lamps.gain[i];
            for lane in 0..LANES {
                let facing = lx[lane] * g[0][lane] + ly[lane] * g[1][lane] + lz[lane] * g[2][lane];
                let shown = (gain[lane] * facing).max(0.0);
                let off = (v[i][lane] - shown).abs();
                let scale = (noise * mean[lane]).max(1e-6);
                let weight = if round < ABSOLUTE {
                    scale / off.max(scale)
                } else {
                    let u = off / (TUKEY * scale);
                    let kept = (1.0 - u * u).max(0.0);
                    kept * kept
                };
                // One that does not light the place agrees with everything.
                let length =
                    g[0][lane] * g[0][lane] + g[1][lane] * g[1][lane] + g[2][lane] * g[2][lane];
                let lit = facing > GRAZING * length.sqrt();
                w[i][lane] = if lit {
                    weight.max(LEAST_WEIGHT)
                } else {
                    LEAST_WEIGHT
                };
            }
        }
        g = solve_weighted(lamps, v, Some(&w));
    }
    w
}

/// Leaves out of four photographs the one that is most probably a shadow or a highlight;
/// `extremes`: only the brightest or the darkest.
fn one_of_four(lamps: &Lamps, v: &[Lane], extremes: bool) -> Vec<Lane> {
    let mut w = vec![[1.0; LANES]; 4];
    for lane in 0..LANES {
        let a: [DVec3; 4] = std::array::from_fn(|i| {
            let gain = f64::from(lamps.gain[i][lane]);
            let [x, y, z] = [0, 1, 2].map(|c| f64::from(lamps.l[i][c][lane]));
            DVec3::new(x, y, z) * gain
        });
        let v: [f64; 4] = std::array::from_fn(|i| f64::from(v[i][lane]));
        if let Some(out) = doubtful(a, v, extremes) {
            w[out][lane] = LEAST_WEIGHT;
        }
    }
    w
}

fn doubtful(a: [DVec3; 4], v: [f64; 4], extremes: bool) -> Option<usize> {
    // Σ u_i a_i = 0: by Cramer's rule.
    let volume = |i: usize, j: usize, k: usize| a[i].dot(a[j].cross(a[k]));
    let u = [
        volume(1, 2, 3),
        -volume(0, 2, 3),
        volume(0, 1, 3),
        -volume(0, 1, 2),
    ];
    // Of the others' volume: how bright lamps are says nothing of how they stand.
    let lengths = a.map(DVec3::length);
    let product: f64 = lengths.iter().product();
    let flat = |i: usize| u[i].abs() * lengths[i] <= FLATTEST * product;
    let residual: f64 = u.iter().zip(v).map(|(u, v)| u * v).sum();
    let brightness = |i: usize| v[i] / lengths[i];
    let order = |a: &usize, b: &usize| brightness(*a).total_cmp(&brightness(*b));
    let darkest = (0..4).min_by(order)?;
    let brightest = (0..4).max_by(order)?;
    // How far each would be off what the other three say, over what they say.
    let mut shadow: Option<(usize, f64)> = None;
    let mut light: Option<(usize, f64)> = None;
    for i in 0..4 {
        if flat(i) || (extremes && i != darkest && i != brightest) {
            continue;
        }
        let excess = residual / u[i];
        let expected = v[i] - excess;
        if excess < 0.0 && expected > 0.0 {
            let ratio = v[i] / expected;
            if shadow.is_none_or(|(_, least)| ratio < least) {
                shadow = Some((i, ratio));
            }
        } else if excess > 0.0 {
            // Without a normal yet, the place is taken to face up: the higher lamp mirrors more,
            // and of equals the one that shows more.
            let mirrored = brightness(i);
            if light.is_none_or(|(_, most)| mirrored > most) {
                light = Some((i, mirrored));
            }
        }
    }
    match (shadow, light) {
        (Some((i, ratio)), _) if ratio < f64::from(SHADOWED) => Some(i),
        (_, Some((i, _))) => Some(i),
        (Some((i, _)), None) => Some(i),
        (None, None) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prepare::lights::direction;

    #[test]
    fn which_of_four_is_doubted_is_one_for_all_gains() {
        let towards: [DVec3; 4] =
            std::array::from_fn(|i| direction(90.0 * i as f64, 40.0 + 5.0 * i as f64));
        let normal = DVec3::new(0.05, -0.1, 1.0).normalize();
        for gain in [1e-5, 1.0, 1e5] {
            let lamps = towards.map(|l| l * gain);
            let mut shown = lamps.map(|a| a.dot(normal));
            shown[2] *= 0.3;
            assert_eq!(doubtful(lamps, shown, false), Some(2), "{gain}");
            shown[2] *= 5.0;
            assert_eq!(doubtful(lamps, shown, false), Some(2), "{gain}");
        }
    }

    #[test]
    fn three_in_one_plane_say_nothing_of_the_fourth() {
        let mut lamps = [0.0, 90.0, 180.0, 270.0].map(|azimuth| direction(azimuth, 40.0));
        // With the sheet's middle: the first is alone.
        lamps[3] = (lamps[1] + lamps[2]).normalize();
        for gain in [1e-5, 1.0, 1e5] {
            let lamps = lamps.map(|l| l * gain);
            let mut shown = lamps.map(|a| a.z);
            shown[0] *= 3.0;
            assert_ne!(doubtful(lamps, shown, false), Some(0), "{gain}");
        }
    }
}
