//! Normals of the sheet's shape, and of its grain and strokes.
//!
//! With n the normals found, b the same smoothed, and f = (0, 0, 1) those of a flat sheet:
//! b is the shape at large (macro), and m = n − (b − f) the rest (meso), as Apollonio, Foschi,
//! Gaiani & Garagnani 2021 split them, but in floats.

#![allow(
    clippy::needless_range_loop,
    reason = "several arrays run along one index, as their formulas do"
)]

use rayon::prelude::*;

use super::transform::along_columns;
use crate::prepare::capture::Filter;

/// Boxes that make a Gaussian: four of them are within 0.3 % of it.
const BOXES: usize = 4;
/// How far normals may differ, in radians, to belong to one side of a crease.
const CREASE: f32 = 0.15;
/// What the bilateral filter looks at, in standard deviations.
const REACH: f32 = 2.0;
/// The standard deviations of both filters in pixels of the smaller picture that they work on, at
/// least: between its pixels, what a Gaussian leaves is linear to 0.2 %.
const COARSE: [f64; 2] = [8.0, 4.0];

/// Normals split by scale.
#[derive(Clone, Debug, PartialEq)]
pub struct Split {
    /// Of the shape at large.
    pub large: Coarse,
    /// Unit normals of what is smaller, upright where there is nothing.
    pub small: Vec<[f32; 3]>,
}

/// Vectors that change slowly, for squares of pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Coarse {
    pub vectors: Vec<[f32; 3]>,
    /// How many vectors are in a row.
    pub width: usize,
    /// Pixels along a side of a square; those at the right and lower edge may be cut.
    pub step: usize,
}

impl Coarse {
    /// Means over squares of `step` pixels.
    fn new(vectors: &[[f32; 3]], width: usize, step: usize) -> Self {
        let height = vectors.len() / width;
        let (w, h) = (width.div_ceil(step), height.div_ceil(step));
        let mean = |i: usize| {
            let (left, top) = (i % w * step, i / w * step);
            let rows = top..(top + step).min(height);
            let columns = left..(left + step).min(width);
            let mut sum = [0.0f32; 3];
            for y in rows.clone() {
                for v in &vectors[y * width + columns.start..y * width + columns.end] {
                    for (sum, v) in sum.iter_mut().zip(v) {
                        *sum += v;
                    }
                }
            }
            let count = (rows.len() * columns.len()) as f32;
            sum.map(|sum| sum / count)
        };
        Self {
            vectors: (0..w * h).into_par_iter().map(mean).collect(),
            width: w,
            step,
        }
    }

    /// Where each of a row of `width` pixels lies between the squares' middles.
    fn across(&self, width: usize) -> Vec<Between> {
        let place = |x| Between::new(x, self.step, self.width);
        (0..width).map(place).collect()
    }

    /// Calls `each` with the vectors of a row of pixels, bilinear between the squares' middles.
    fn row(&self, y: usize, across: &[Between], mut each: impl FnMut(usize, [f32; 3])) {
        let between = Between::new(y, self.step, self.vectors.len() / self.width);
        let [above, below] = [between.first, between.second]
            .map(|row| &self.vectors[row * self.width..(row + 1) * self.width]);
        let rows = above.iter().zip(below);
        let line: Vec<[f32; 3]> = rows.map(|(a, b)| mixed(a, b, between.share)).collect();
        for (x, place) in across.iter().enumerate() {
            each(
                x,
                mixed(&line[place.first], &line[place.second], place.share),
            );
        }
    }

    /// A vector for each pixel of a picture of this size.
    pub fn sampled(&self, [width, height]: [usize; 2]) -> Vec<[f32; 3]> {
        let mut all = vec![[0.0; 3]; width * height];
        if !all.is_empty() && !self.vectors.is_empty() {
            let across = self.across(width);
            all.par_chunks_mut(width)
                .enumerate()
                .for_each(|(y, row)| self.row(y, &across, |x, v| row[x] = v));
        }
        all
    }
}

/// The squares on both sides of a pixel, and the second one's share.
struct Between {
    first: usize,
    second: usize,
    share: f32,
}

impl Between {
    /// Of the pixel `at` between squares of `step` pixels.
    fn new(at: usize, step: usize, squares: usize) -> Self {
        let place = (at as f32 + 0.5) / step as f32 - 0.5;
        let place = place.clamp(0.0, (squares - 1) as f32);
        let first = (place as usize).min(squares.saturating_sub(2));
        Self {
            first,
            second: (first + 1).min(squares - 1),
            share: place - first as f32,
        }
    }
}

fn mixed(a: &[f32; 3], b: &[f32; 3], share: f32) -> [f32; 3] {
    [0, 1, 2].map(|c| a[c] + (b[c] - a[c]) * share)
}

/// Splits unit normals at a standard deviation of `sigma_px` pixels (> 0).
pub fn split(mut normals: Vec<[f32; 3]>, width: usize, sigma_px: f64, filter: Filter) -> Split {
    if width == 0 || normals.is_empty() {
        let large = Coarse {
            vectors: Vec::new(),
            width: 0,
            step: 1,
        };
        return Split {
            large,
            small: normals,
        };
    }
    let coarse = COARSE[usize::from(filter == Filter::Bilateral)];
    let step = ((sigma_px / coarse) as usize).max(1);
    let sigma = sigma_px / step as f64;
    let mut large = match filter {
        Filter::Gaussian => {
            let mut large = Coarse::new(&normals, width, step);
            // The means have smoothed by their own width already.
            let own = if step > 1 { 1.0 / 12.0 } else { 0.0 };
            smooth(
                &mut large.vectors,
                large.width,
                (sigma * sigma - own).sqrt(),
            );
            large
        }
        // Each pixel is its own mean, and a copy of a large sheet takes memory.
        Filter::Bilateral if step == 1 => Coarse {
            vectors: bilateral(&normals, width, sigma as f32),
            width,
            step,
        },
        Filter::Bilateral => {
            let mut large = Coarse::new(&normals, width, step);
            large.vectors = bilateral(&large.vectors, large.width, sigma as f32);
            large
        }
    };
    let across = large.across(width);
    normals
        .par_chunks_mut(width)
        .enumerate()
        .for_each(|(y, row)| {
            large.row(y, &across, |x, b| {
                let n = row[x];
                row[x] = unit([n[0] - b[0], n[1] - b[1], n[2] - (b[2] - 1.0)]);
            });
        });
    large.vectors.par_iter_mut().for_each(|v| *v = unit(*v));
    Split {
        large,
        small: normals,
    }
}

fn unit(v: [f32; 3]) -> [f32; 3] {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    if length > 1e-6 && v[2] > 0.0 {
        v.map(|c| c / length)
    } else {
        [0.0, 0.0, 1.0]
    }
}

/// Vectors smoothed by a Gaussian of `sigma_px`; beyond the edge they go on as at it.
pub fn gaussian(vectors: &[[f32; 3]], width: usize, sigma_px: f64) -> Vec<[f32; 3]> {
    let mut smoothed = vectors.to_vec();
    smooth(&mut smoothed, width, sigma_px);
    smoothed
}

/// As [`gaussian`], in place: of a large sheet, vectors for each pixel take a quarter of all memory.
fn smooth(vectors: &mut [[f32; 3]], width: usize, sigma_px: f64) {
    if width == 0 || vectors.is_empty() {
        return;
    }
    // A box of radius r with its ends at share a has the variance
    // (r(r+1)(2r+1)/3 + 2a(r+1)²)/(2r+1+2a): Gwosdek and others 2011.
    let variance = sigma_px * sigma_px / BOXES as f64;
    let radius = ((0.5 * ((12.0 * variance + 1.0).sqrt() - 1.0)).floor()).max(0.0);
    let full = 2.0 * radius + 1.0;
    let share = full * (radius * (radius + 1.0) - 3.0 * variance)
        / (6.0 * (variance - (radius + 1.0).powi(2)));
    let kernel = (radius as usize, share as f32);
    let boxes = |line: &mut [[f32; 3]], buffer: &mut Vec<[f32; 3]>| {
        for _ in 0..BOXES {
            boxed(line, kernel, buffer);
        }
    };
    vectors
        .par_chunks_mut(width)
        .for_each_init(Vec::new, |buffer, row| boxes(row, buffer));
    let height = vectors.len() / width;
    along_columns(vectors, width, |columns, buffer| {
        for column in columns.chunks_exact_mut(height) {
            boxes(column, buffer);
        }
    });
}

/// One box along a line, in place.
fn boxed(line: &mut [[f32; 3]], (radius, share): (usize, f32), buffer: &mut Vec<[f32; 3]>) {
    buffer.clear();
    buffer.extend_from_slice(line);
    let last = line.len() - 1;
    let at = |i: isize| buffer[(i.max(0) as usize).min(last)];
    let scale = 1.0 / (2.0 * radius as f32 + 1.0 + 2.0 * share);
    let r = radius as isize;
    // A running sum in f64 does not drift.
    let mut sum = [0.0f64; 3];
    for i in -r..=r {
        for (sum, v) in sum.iter_mut().zip(at(i)) {
            *sum += f64::from(v);
        }
    }
    for i in 0..line.len() {
        let x = i as isize;
        let (before, after) = (at(x - r - 1), at(x + r + 1));
        for c in 0..3 {
            line[i][c] = (sum[c] as f32 + share * (before[c] + after[c])) * scale;
        }
        let gone = at(x - r);
        for c in 0..3 {
            sum[c] += f64::from(after[c]) - f64::from(gone[c]);
        }
    }
}

/// Vectors smoothed among those alike (Tomasi & Manduchi 1998).
fn bilateral(vectors: &[[f32; 3]], width: usize, sigma: f32) -> Vec<[f32; 3]> {
    let height = vectors.len() / width;
    let reach = (REACH * sigma).ceil() as usize;
    let near = |d: f32| (-0.5 * (d / sigma).powi(2)).exp();
    let across: Vec<f32> = (0..=reach).map(|d| near(d as f32)).collect();
    let smoothed = |i: usize| {
        let (x, y) = (i % width, i / width);
        let own = vectors[i];
        let mut sum = [0.0f32; 3];
        for v in y.saturating_sub(reach)..(y + reach + 1).min(height) {
            for u in x.saturating_sub(reach)..(x + reach + 1).min(width) {
                let other = vectors[v * width + u];
                let square: f32 = (0..3).map(|c| (own[c] - other[c]).powi(2)).sum();
                let alike = (-0.5 * square / (CREASE * CREASE)).exp();
                let weight = across[u.abs_diff(x)] * across[v.abs_diff(y)] * alike;
                for (sum, other) in sum.iter_mut().zip(other) {
                    *sum += weight * other;
                }
            }
        }
        unit(sum)
    };
    (0..vectors.len()).into_par_iter().map(smoothed).collect()
}
