//! How far photographs blur what is drawn, and colours with that taken out for the most part.
//!
//! A pixel shows the mean over its area, and lens and sensor blur that over its neighbours: half of
//! what is told of a place at the edge of a stroke is theirs. By how much is seen at edges between
//! two even stretches. Along a line across such an edge, where nothing is blurred, one value at most
//! lies between both sides. The differences from value to value then have the variance p(1 − p), p
//! being what their mean place has beyond a whole number, and blur adds its own variance, whatever p
//! is. The least fifth of all edges says how much: the others are soft by themselves, or the line
//! crosses them aslant. A sheet of nothing but soft strokes looks blurred, and is sharpened by as much.

use rayon::prelude::*;

use crate::prepare::codes::{LinearCodes, SrgbCodes};

/// Values along a line that an edge is looked for in: on each side of its middle half of them, the
/// outermost two of which lie on its sides.
const LINE: usize = 8;
/// The share of all edges, from the least blurred, whose variance is taken. With fewer noise would decide.
const SHARPEST: f64 = 0.2;
/// The fewest edges that say something.
const FEWEST: usize = 200;
/// The most that is taken out, as a variance in square pixels: beyond, little is left to be told.
pub const MOST: f64 = 0.35;
/// Less is not told from none: noise moves what is found by as much.
const LEAST: f64 = 0.05;
/// How much lighter one side is than the other, in shares of the lighter.
const CONTRAST: f32 = 0.15;
/// How far apart two values of one side may be, in shares of the contrast.
const EVEN: f32 = 0.08;
/// How much may change along an edge where it is crossed, likewise.
const ALONG: f32 = 0.25;
/// The most pixels that edges are looked for at: of more, every so manieth row.
const LOOKED_AT: usize = 1 << 22;

/// The variance in square pixels, along each axis, by which photographs blur what is drawn, and
/// [`MOST`] where it is more; 0 where it is hardly any, or too few edges tell. `albedo` is
/// sRGB-encoded, in rows of `width`.
pub fn blur(albedo: &[[u16; 3]], width: usize) -> f64 {
    let height = albedo.len().checked_div(width).unwrap_or(0);
    if width < LINE || height < LINE {
        return 0.0;
    }
    let linear = LinearCodes::new();
    let every = albedo.len().div_ceil(LOOKED_AT);
    let rows = (1..height - 1).into_par_iter().step_by(every);
    let of_row = |y: usize| -> Vec<f64> {
        let light = |x: usize, y: usize| {
            let [r, g, b] = albedo[y * width + x].map(|code| linear.of(code));
            0.25 * r + 0.5 * g + 0.25 * b
        };
        // The last one before the middle.
        const BEFORE: usize = LINE / 2 - 1;
        let within = |at: usize, count: usize| (BEFORE..count - LINE / 2).contains(&at);
        let mut found = Vec::new();
        for x in 1..width - 1 {
            if within(x, width) {
                let line = std::array::from_fn(|i| light(x + i - BEFORE, y));
                found.extend(variance(line, light(x, y + 1) - light(x, y - 1)));
            }
            if within(y, height) {
                let line = std::array::from_fn(|i| light(x, y + i - BEFORE));
                found.extend(variance(line, light(x + 1, y) - light(x - 1, y)));
            }
        }
        found
    };
    let mut found: Vec<f64> = rows.flat_map_iter(of_row).collect();
    if found.len() < FEWEST {
        return 0.0;
    }
    let at = (SHARPEST * found.len() as f64) as usize;
    let least = *found.select_nth_unstable_by(at, f64::total_cmp).1;
    if least < LEAST { 0.0 } else { least.min(MOST) }
}

/// The variance that blur gives to the differences along a line, where it crosses an edge in its
/// middle; `along` is what changes along the edge.
fn variance(line: [f32; LINE], along: f32) -> Option<f64> {
    let [a, b, .., c, d] = line;
    let (first, last) = (0.5 * (a + b), 0.5 * (c + d));
    let contrast = last - first;
    let size = contrast.abs();
    let stands_out = size > CONTRAST * first.max(last);
    if !stands_out || (b - a).abs().max((d - c).abs()) > EVEN * size || along.abs() > ALONG * size {
        return None;
    }
    let share = line.map(|v| f64::from((v - first) / contrast));
    // It rises beyond the half there, and nowhere else.
    let middle = LINE / 2;
    if share[middle - 1] >= 0.5 || share[middle] < 0.5 {
        return None;
    }
    // What sides are uneven by does not count: that far out it would weigh most.
    let steps: [f64; LINE - 3] = std::array::from_fn(|i| share[i + 2] - share[i + 1]);
    if steps.iter().any(|step| *step < -f64::from(EVEN)) {
        return None;
    }
    let sum: f64 = steps.iter().sum();
    let moment = |power: i32, from: f64| -> f64 {
        let each = steps.iter().enumerate();
        let each = each.map(|(i, step)| step * (i as f64 - from).powi(power));
        each.sum::<f64>() / sum
    };
    let mean = moment(1, 0.0);
    let p = mean - mean.floor();
    Some(moment(2, mean) - p * (1.0 - p))
}

/// Colours from which a blur of this variance along each axis is taken out: of K, which blurs, by the
/// first terms of K⁻¹ = 1 + (1 − K) + (1 − K)² + …, which give two thirds of the finest detail
/// back that [`MOST`] takes away, and nearly all of what is lost otherwise.
pub fn sharpened(albedo: &[[u16; 3]], width: usize, variance: f64) -> Vec<[u16; 3]> {
    /// Rows that are worked on together, with those around them.
    const TOGETHER: usize = 32;
    let mut sharp = vec![[0; 3]; albedo.len()];
    let height = albedo.len().checked_div(width).unwrap_or(0);
    if height == 0 {
        return sharp;
    }
    let (linear, codes) = (LinearCodes::new(), SrgbCodes::new());
    let weights = inverse(variance);
    // Beyond the edge it goes on as at it.
    let around = |i: usize, count: usize| -> [usize; TAPS] {
        std::array::from_fn(|k| (i + k).saturating_sub(TAPS / 2).min(count - 1))
    };
    let weighed = |values: [f32; TAPS]| -> f32 {
        values
            .iter()
            .zip(weights)
            .map(|(v, weight)| v * weight)
            .sum()
    };
    let along_row = |y: usize| -> Vec<[f32; 3]> {
        let row = &albedo[y * width..(y + 1) * width];
        let light: Vec<[f32; 3]> = row.iter().map(|rgb| rgb.map(|v| linear.of(v))).collect();
        let place = |x| {
            let columns = around(x, width);
            std::array::from_fn(|c| weighed(columns.map(|x| light[x][c])))
        };
        (0..width).map(place).collect()
    };
    let bands = sharp.par_chunks_mut(TOGETHER * width).enumerate();
    bands.for_each(|(band, out)| {
        let top = band * TOGETHER;
        let first = around(top, height)[0];
        let last = around(top + out.len() / width - 1, height)[TAPS - 1];
        let rows: Vec<Vec<[f32; 3]>> = (first..=last).map(along_row).collect();
        for (i, out) in out.chunks_exact_mut(width).enumerate() {
            let above_below = around(top + i, height).map(|y| &rows[y - first]);
            for (x, out) in out.iter_mut().enumerate() {
                *out = std::array::from_fn(|c| codes.of(weighed(above_below.map(|row| row[x][c]))));
            }
        }
    });
    sharp
}

/// Values that weigh in along an axis.
const TAPS: usize = 5;

/// 3 − 3 K + K² of K = (v/2, 1 − v, v/2).
fn inverse(variance: f64) -> [f32; TAPS] {
    let beside = variance / 2.0;
    let at = 1.0 - variance;
    let square = [
        beside * beside,
        2.0 * beside * at,
        at * at + 2.0 * beside * beside,
    ];
    let [far, near, middle] = [
        square[0],
        square[1] - 3.0 * beside,
        square[2] - 3.0 * at + 3.0,
    ];
    [far, near, middle, near, far].map(|weight| weight as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::srgb_encode;

    const SIZE: usize = 240;
    /// Places within a pixel, along each axis.
    const WITHIN: usize = 8;

    /// Strokes and patches with hard edges, each pixel the mean over its area; and noise.
    fn drawn(noise: f64) -> Vec<f64> {
        let ink = |x: f64, y: f64| {
            let stroke = |at: f64, half: f64| (at.rem_euclid(23.3) - 11.0).abs() < half;
            let lies = stroke(x + 0.13 * y, 4.5) || stroke(y - 0.21 * x, 3.5);
            if lies { 0.12 } else { 0.7 }
        };
        let pixel = |i: usize| {
            let (x, y) = ((i % SIZE) as f64, (i / SIZE) as f64);
            let place = |k: usize| (k as f64 + 0.5) / WITHIN as f64;
            let all =
                (0..WITHIN * WITHIN).map(|k| ink(x + place(k % WITHIN), y + place(k / WITHIN)));
            let mean = all.sum::<f64>() / (WITHIN * WITHIN) as f64;
            let mixed = (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let random = ((mixed ^ mixed >> 29) >> 40) as f64 / f64::from(1 << 24) - 0.5;
            mean * (1.0 + noise * random)
        };
        (0..SIZE * SIZE).map(pixel).collect()
    }

    fn blurred(values: &[f64], variance: f64) -> Vec<f64> {
        let at = |x: usize, y: usize| values[y.min(SIZE - 1) * SIZE + x.min(SIZE - 1)];
        let weights = [variance / 2.0, 1.0 - variance, variance / 2.0];
        (0..SIZE * SIZE)
            .map(|i| {
                let (x, y) = (i % SIZE, i / SIZE);
                let each = (0..9).map(|k| {
                    let place = |i: usize, k: usize| (i + k).saturating_sub(1);
                    weights[k % 3] * weights[k / 3] * at(place(x, k % 3), place(y, k / 3))
                });
                each.sum()
            })
            .collect()
    }

    fn encoded(values: &[f64]) -> Vec<[u16; 3]> {
        let code = |v: &f64| [(srgb_encode(*v) * 65535.0).round() as u16; 3];
        values.iter().map(code).collect()
    }

    /// How far from what was drawn, root of the mean square in linear light.
    fn off(found: &[[u16; 3]], drawn: &[f64]) -> f64 {
        let linear = LinearCodes::new();
        let pairs = found.iter().zip(drawn);
        let sum: f64 = pairs
            .map(|(found, drawn)| (f64::from(linear.of(found[1])) - drawn).powi(2))
            .sum();
        (sum / drawn.len() as f64).sqrt()
    }

    #[test]
    fn what_blurs_edges_is_found_and_taken_out() {
        for noise in [0.0, 0.02, 0.04] {
            let sharp = drawn(noise);
            for variance in [0.0, 0.15, 0.25, 0.33] {
                let shown = encoded(&blurred(&sharp, variance));
                let found = blur(&shown, SIZE);
                eprintln!("{noise} {variance}: {found:.3}");
                assert!(
                    (found - variance).abs() < 0.06,
                    "{noise} {variance}: {found}"
                );
                if variance > 0.1 {
                    let again = sharpened(&shown, SIZE, found);
                    let [before, after] = [&shown, &again].map(|of| off(of, &sharp));
                    assert!(after < 0.4 * before, "{variance}: {before} {after}");
                }
            }
        }
    }

    #[test]
    fn ruled_edges_are_sharp_wherever_they_lie_in_a_pixel() {
        // Rectangles whose edges lie on the pixels', or share all of theirs alike.
        for share in [0.0, 0.2, 0.5, 0.9] {
            let ruled = |at: usize| match at % 24 {
                8 => share,
                9..20 => 1.0,
                20 => 1.0 - share,
                _ => 0.0,
            };
            let lies = |i: usize| ruled(i % SIZE) * ruled(i / SIZE);
            let sharp: Vec<f64> = (0..SIZE * SIZE).map(|i| 0.7 - 0.58 * lies(i)).collect();
            assert_eq!(blur(&encoded(&sharp), SIZE), 0.0, "{share}");
            let found = blur(&encoded(&blurred(&sharp, 0.25)), SIZE);
            assert!((found - 0.25).abs() < 0.02, "{share}: {found}");
        }
    }

    #[test]
    fn without_edges_nothing_is_found() {
        let even = vec![[40_000; 3]; SIZE * SIZE];
        assert_eq!(blur(&even, SIZE), 0.0);
        assert_eq!(blur(&even[..5 * SIZE], SIZE), 0.0);
        assert_eq!(blur(&[], 0), 0.0);
        // Light that changes slowly has no edges.
        let slow: Vec<f64> = (0..SIZE * SIZE)
            .map(|i| 0.4 + 0.3 * ((i % SIZE) as f64 / 15.0).sin())
            .collect();
        assert_eq!(blur(&encoded(&slow), SIZE), 0.0);
        assert_eq!(sharpened(&[], 0, 0.3), Vec::<[u16; 3]>::new());
        // An even sheet stays as it is, at its corners too.
        let same = sharpened(&even, SIZE, 0.3);
        assert!(same.iter().flatten().all(|v| v.abs_diff(40_000) <= 1));
    }
}
