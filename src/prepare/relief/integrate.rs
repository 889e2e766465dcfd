//! Normals → heights.
//!
//! Slopes p = ∂h/∂x and q = ∂h/∂row are those in the middle of pixels. With the perimeter free, h
//! is a sum of cosines, which nothing flows over the perimeter of, beside the plane of the mean
//! slopes; its slopes are sums of sines, term by term, so that their least squares are a product of
//! transforms: exact, without iterations, and as sharp as the normals (Frankot & Chellappa, *IEEE
//! Transactions on Pattern Analysis and Machine Intelligence* 10 (1988) 439, with cosines for
//! exponentials).
//!
//! The other ways ask slopes of the differences of neighbouring heights, each of the mean of both
//! ends' slopes, which leaves less of the smallest relief: with the perimeter anchored at 0, by a
//! sine transform (Simchony, Chellappa & Shao, *ibid.* 12 (1990) 435), and the robust way.
//!
//! Creases break the assumption that errors are small everywhere. The robust way weighs each
//! difference by how far it is from its slope (Cauchy's weights, found in turn), and solves the
//! weighted equations by conjugate gradients, preconditioned by the exact solver.

#![allow(
    clippy::needless_range_loop,
    reason = "several arrays run along one index, as their formulas do"
)]

use rayon::prelude::*;

use super::{
    real::Real,
    transform::{Kind, Line, transform},
};

/// What is asked of the perimeter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Perimeter {
    /// Nothing: heights are known up to one constant, and their mean is 0.
    #[default]
    Free,
    /// It lies at height 0.
    Anchored,
}

/// Rounds of reweighting.
const ROUNDS: usize = 8;
/// Steps of conjugate gradients in each.
const STEPS: usize = 30;
/// The share of the first residual at which a round is done.
const DONE: f64 = 1e-6;
/// Slopes beyond this are a normal at the horizon, 86° to the table.
const STEEPEST: f32 = 15.0;

/// Slopes of a picture, in heights per pixel: to the right, and down the rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Slopes {
    pub width: usize,
    pub right: Vec<f32>,
    pub down: Vec<f32>,
}

impl Slopes {
    /// Of unit normals, x right and y up.
    pub fn of_normals(normals: &[[f32; 3]], width: usize) -> Self {
        let slope = |along: f32, over_z: f32| (along * over_z).clamp(-STEEPEST, STEEPEST);
        let [mut right, mut down] = [0, 1].map(|_| vec![0.0; normals.len()]);
        normals
            .par_chunks(width.max(1))
            .zip(right.par_chunks_mut(width.max(1)))
            .zip(down.par_chunks_mut(width.max(1)))
            .for_each(|((normals, right), down)| {
                for ((n, right), down) in normals.iter().zip(right).zip(down) {
                    let over_z = n[2].max(1e-6).recip();
                    *right = -slope(n[0], over_z);
                    *down = slope(n[1], over_z);
                }
            });
        Self { width, right, down }
    }

    fn height(&self) -> usize {
        self.right.len().checked_div(self.width).unwrap_or(0)
    }

    /// What the difference from a pixel to the next should be.
    fn to_right(&self, i: usize) -> f64 {
        f64::from(self.right[i] + self.right[i + 1]) / 2.0
    }

    fn to_below(&self, i: usize) -> f64 {
        f64::from(self.down[i] + self.down[i + self.width]) / 2.0
    }
}

/// Weights of the differences to the right and down; those that leave the picture mean nothing.
struct Weights {
    right: Vec<f32>,
    down: Vec<f32>,
}

/// Heights of a surface with these slopes, in pixels, positive towards the camera.
pub fn integrate(slopes: &Slopes, perimeter: Perimeter) -> Vec<f64> {
    let (width, height) = (slopes.width, slopes.height());
    match perimeter {
        _ if width == 0 || height == 0 => Vec::new(),
        Perimeter::Free => integrate_free(slopes.clone()),
        Perimeter::Anchored if width < 3 || height < 3 => vec![0.0; width * height],
        Perimeter::Anchored => {
            let right = divergence(slopes, None);
            let inner = width - 2;
            let mut core: Vec<f64> = (1..height - 1)
                .flat_map(|y| &right[y * width + 1..(y + 1) * width - 1])
                .copied()
                .collect();
            Poisson::new(inner, height - 2, Kind::Sine).solve(&mut core);
            let mut h = vec![0.0; width * height];
            for (y, row) in core.chunks_exact(inner).enumerate() {
                let start = (y + 1) * width + 1;
                h[start..start + inner].copy_from_slice(row);
            }
            h
        }
    }
}

/// As [`integrate`] with a free perimeter, of slopes that are of no use afterwards: of a large sheet
/// they take as much memory as its heights. They are the least squares, term by term.
pub fn integrate_free(slopes: Slopes) -> Vec<f64> {
    let width = slopes.width;
    let [tilt_x, tilt_y] = [&slopes.right, &slopes.down].map(|v| mean(v, width));
    let mut h: Vec<f64> = integrate_level(slopes, 1.0);
    let height = h.len().checked_div(width).unwrap_or(0);
    let (middle_x, middle_y) = ((width as f64 - 1.0) / 2.0, (height as f64 - 1.0) / 2.0);
    let rows = h.par_chunks_mut(width.max(1)).enumerate();
    rows.for_each(|(y, row)| {
        for (x, value) in row.iter_mut().enumerate() {
            *value += tilt_x * (x as f64 - middle_x) + tilt_y * (y as f64 - middle_y);
        }
    });
    h
}

fn mean(values: &[f32], width: usize) -> f64 {
    const LANES: usize = 8;
    // In rows, so that the sum does not depend on how many processors there are, and in lanes, which
    // do not wait for each other.
    let sum = |row: &[f32]| -> f64 {
        let (whole, rest) = row.as_chunks::<LANES>();
        let mut sums = [0.0; LANES];
        for values in whole {
            for (sum, v) in sums.iter_mut().zip(values) {
                *sum += f64::from(*v);
            }
        }
        let rest = rest.iter().map(|v| f64::from(*v));
        sums.into_iter().chain(rest).sum()
    };
    let rows = values.par_chunks(width.max(1));
    let sums: Vec<f64> = rows.map(sum).collect();
    sums.iter().sum::<f64>() / values.len().max(1) as f64
}

/// As [`integrate_free`] without the plane of the mean slopes, times `unit`.
pub fn integrate_level<T: Real>(slopes: Slopes, unit: f64) -> Vec<T> {
    let (width, height) = (slopes.width, slopes.height());
    if width == 0 || height == 0 {
        return Vec::new();
    }
    let Slopes { right, down, .. } = slopes;
    let lines = |kind| [Line::<T>::new(kind, width), Line::new(kind, height)];
    let (cosine, slope) = (lines(Kind::Cosine), lines(Kind::Slope));
    let without_mean = |v: Vec<f32>| -> Vec<T> {
        let mean = T::of(mean(&v, width));
        let mut v = T::of_all(v);
        v.par_chunks_mut(width)
            .for_each(|row| row.iter_mut().for_each(|v| *v = *v - mean));
        v
    };
    let mut h = without_mean(right);
    transform(&mut h, width, [&slope[0], &cosine[1]], false);
    let mut down = without_mean(down);
    transform(&mut down, width, [&cosine[0], &slope[1]], false);
    let narrow = |v: Vec<f64>| -> Vec<T> { v.into_iter().map(T::of).collect() };
    let [across, along] = cosine.each_ref().map(|line| narrow(line.frequencies()));
    let minus = T::of(-unit);
    h.par_chunks_mut(width)
        .zip(down.par_chunks(width))
        .zip(&along)
        .for_each(|((row, down), b)| {
            for ((p, q), a) in row.iter_mut().zip(down).zip(&across) {
                *p = (*a * *p + *b * *q) * minus / (*a * *a + *b * *b);
            }
        });
    // What is constant is 0.
    h[0] = T::default();
    drop(down);
    transform(&mut h, width, cosine.each_ref(), true);
    h
}

/// As [`integrate`] with a free perimeter, but robust: slopes that contradict the others, at
/// creases and edges, lose their weight. `scale` is the error of a slope that is still usual, such
/// as 0.02.
pub fn integrate_robust(slopes: &Slopes, scale: f64) -> Vec<f64> {
    let mut h = integrate(slopes, Perimeter::Free);
    let (width, height) = (slopes.width, slopes.height());
    if width < 2 || height < 2 {
        return h;
    }
    let poisson = Poisson::new(width, height, Kind::Cosine);
    // From wide to narrow: what is wrong by much is found first.
    for round in 0..ROUNDS {
        let wide = scale * 2.0_f64.powi(3 - round.min(3) as i32);
        let weights = cauchy(slopes, &h, wide);
        let right = divergence(slopes, Some(&weights));
        conjugate_gradients(&mut h, &right, &weights, width, &poisson);
    }
    h
}

fn cauchy(slopes: &Slopes, h: &[f64], scale: f64) -> Weights {
    let (width, height) = (slopes.width, slopes.height());
    let weight = |off: f64| (1.0 / (1.0 + (off / scale).powi(2))).max(1e-4) as f32;
    let right = (0..h.len())
        .into_par_iter()
        .map(|i| match i % width + 1 < width {
            true => weight(h[i + 1] - h[i] - slopes.to_right(i)),
            false => 0.0,
        });
    let down = (0..h.len())
        .into_par_iter()
        .map(|i| match i / width + 1 < height {
            true => weight(h[i + width] - h[i] - slopes.to_below(i)),
            false => 0.0,
        });
    Weights {
        right: right.collect(),
        down: down.collect(),
    }
}

/// −Σ over a pixel's neighbours of weight times slope towards it: the right side of the normal
/// equations, for −∇²h.
fn divergence(slopes: &Slopes, weights: Option<&Weights>) -> Vec<f64> {
    let (width, height) = (slopes.width, slopes.height());
    let to_right = |i: usize| slopes.to_right(i) * weights.map_or(1.0, |w| f64::from(w.right[i]));
    let to_below = |i: usize| slopes.to_below(i) * weights.map_or(1.0, |w| f64::from(w.down[i]));
    let at = |i: usize| {
        let (x, y) = (i % width, i / width);
        let mut sum = 0.0;
        if x + 1 < width {
            sum -= to_right(i);
        }
        if x > 0 {
            sum += to_right(i - 1);
        }
        if y + 1 < height {
            sum -= to_below(i);
        }
        if y > 0 {
            sum += to_below(i - width);
        }
        sum
    };
    (0..width * height).into_par_iter().map(at).collect()
}

/// −∇·(w∇h).
fn weighted_laplacian(h: &[f64], weights: &Weights, width: usize) -> Vec<f64> {
    let height = h.len() / width;
    let at = |i: usize| {
        let (x, y) = (i % width, i / width);
        let flow = |weight: f32, other: usize| f64::from(weight) * (h[i] - h[other]);
        let mut sum = 0.0;
        if x + 1 < width {
            sum += flow(weights.right[i], i + 1);
        }
        if x > 0 {
            sum += flow(weights.right[i - 1], i - 1);
        }
        if y + 1 < height {
            sum += flow(weights.down[i], i + width);
        }
        if y > 0 {
            sum += flow(weights.down[i - width], i - width);
        }
        sum
    };
    (0..h.len()).into_par_iter().map(at).collect()
}

fn conjugate_gradients(
    h: &mut [f64],
    right: &[f64],
    weights: &Weights,
    width: usize,
    poisson: &Poisson,
) {
    let dot = |a: &[f64], b: &[f64]| -> f64 {
        // In rows, so that the sum does not depend on how many processors there are.
        let rows = a.par_chunks(width).zip(b.par_chunks(width));
        let sums: Vec<f64> = rows
            .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a * b).sum())
            .collect();
        sums.iter().sum()
    };
    let applied = weighted_laplacian(h, weights, width);
    let mut residual: Vec<f64> = right.iter().zip(applied).map(|(b, a)| b - a).collect();
    let mut better = residual.clone();
    poisson.solve(&mut better);
    let mut direction = better.clone();
    let mut along = dot(&residual, &better);
    let first = along;
    for _ in 0..STEPS {
        // NaN ends it too.
        let left = along > first * DONE * DONE && along > 0.0;
        if !left {
            break;
        }
        let applied = weighted_laplacian(&direction, weights, width);
        let curvature = dot(&direction, &applied);
        if curvature.is_nan() || curvature <= 0.0 {
            break;
        }
        let step = along / curvature;
        for i in 0..h.len() {
            h[i] += step * direction[i];
            residual[i] -= step * applied[i];
        }
        better.copy_from_slice(&residual);
        poisson.solve(&mut better);
        let next = dot(&residual, &better);
        let share = next / along;
        for (direction, better) in direction.iter_mut().zip(&better) {
            *direction = better + share * *direction;
        }
        along = next;
    }
}

/// Solves −∇²h = f.
struct Poisson {
    width: usize,
    lines: [Line<f64>; 2],
    eigenvalues: [Vec<f64>; 2],
}

impl Poisson {
    fn new(width: usize, height: usize, kind: Kind) -> Self {
        let lines = [Line::new(kind, width), Line::new(kind, height)];
        let eigenvalues = lines.each_ref().map(Line::eigenvalues);
        Self {
            width,
            lines,
            eigenvalues,
        }
    }

    /// In place; what is constant is left out where nothing holds it.
    fn solve(&self, f: &mut [f64]) {
        let lines = self.lines.each_ref();
        transform(f, self.width, lines, false);
        let [across, down] = &self.eigenvalues;
        f.par_chunks_mut(self.width)
            .zip(down)
            .for_each(|(row, down)| {
                for (value, across) in row.iter_mut().zip(across) {
                    let eigenvalue = across + down;
                    *value = if eigenvalue > 0.0 {
                        *value / eigenvalue
                    } else {
                        0.0
                    };
                }
            });
        transform(f, self.width, lines, true);
    }
}
