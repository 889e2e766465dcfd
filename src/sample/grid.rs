//! Pixels and millimetres. Places are in mm in a side frame: origin top left, x right, y down.

use glam::Vec2;
use rayon::prelude::*;

use super::noise::Noise;

const MM_PER_INCH: f64 = 25.4;
/// Samples per mm of a noise that is kept as a plane.
const NOISE_PER_MM: f32 = 4.0;

/// The pixel grid of one map, which fills its sheet exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Size of one pixel in mm.
    pub pitch_mm: Vec2,
}

impl Grid {
    /// The grid of a sheet of this size at this resolution.
    pub fn at_dpi(size_mm: Vec2, dpi: f64) -> Self {
        let pixels = |mm: f32| ((f64::from(mm) * dpi / MM_PER_INCH).round() as usize).max(1);
        Self::with_pixels(size_mm, pixels(size_mm.x), pixels(size_mm.y))
    }

    /// A grid of so many pixels over a sheet of this size.
    pub fn with_pixels(size_mm: Vec2, width: usize, height: usize) -> Self {
        let pitch_mm = Vec2::new(size_mm.x / width as f32, size_mm.y / height as f32);
        Self {
            width,
            height,
            pitch_mm,
        }
    }

    /// The same area in half as many pixels each way.
    pub fn halved(self) -> Self {
        let size = self.pitch_mm * Vec2::new(self.width as f32, self.height as f32);
        Self::with_pixels(size, self.width.div_ceil(2), self.height.div_ceil(2))
    }

    /// Centre of a pixel in mm.
    pub fn centre(&self, column: usize, row: usize) -> Vec2 {
        Vec2::new(column as f32 + 0.5, row as f32 + 0.5) * self.pitch_mm
    }

    /// Computes every pixel by itself, in parallel rows.
    pub fn map<T: Send>(&self, value: impl Fn(Vec2) -> T + Sync) -> Vec<T> {
        (0..self.width * self.height)
            .into_par_iter()
            .with_min_len(self.width)
            .map(|i| value(self.centre(i % self.width, i / self.width)))
            .collect()
    }
}

/// One smooth quantity over the sheet.
#[derive(Clone, Debug)]
pub struct Plane {
    /// Where its samples lie.
    pub grid: Grid,
    /// Row by row.
    pub data: Vec<f32>,
}

impl Plane {
    /// One value everywhere.
    pub fn filled(grid: Grid, value: f32) -> Self {
        Self {
            grid,
            data: vec![value; grid.width * grid.height],
        }
    }

    /// Samples a noise whose finest features are wider than a millimetre.
    pub fn of_noise(size_mm: Vec2, noise: &Noise) -> Self {
        let (w, h) = (size_mm.x * NOISE_PER_MM, size_mm.y * NOISE_PER_MM);
        Self::from_fn(Grid::with_pixels(size_mm, w as usize, h as usize), |p| {
            noise.at(p)
        })
    }

    /// Evaluates a function at every sample.
    pub fn from_fn(grid: Grid, value: impl Fn(Vec2) -> f32 + Sync) -> Self {
        Self {
            grid,
            data: grid.map(value),
        }
    }

    /// Index of the sample nearest to a place; places off the sheet count as on its edge.
    pub fn index(&self, at_mm: Vec2) -> usize {
        let p = at_mm / self.grid.pitch_mm;
        let column = (p.x.max(0.0) as usize).min(self.grid.width - 1);
        let row = (p.y.max(0.0) as usize).min(self.grid.height - 1);
        row * self.grid.width + column
    }

    /// The nearest sample.
    pub fn nearest(&self, at_mm: Vec2) -> f32 {
        self.data[self.index(at_mm)]
    }

    /// Interpolated between samples.
    pub fn at(&self, at_mm: Vec2) -> f32 {
        let limit = Vec2::new((self.grid.width - 1) as f32, (self.grid.height - 1) as f32);
        let p = (at_mm / self.grid.pitch_mm - 0.5).clamp(Vec2::ZERO, limit);
        let (column, row) = (p.x as usize, p.y as usize);
        let t = p - Vec2::new(column as f32, row as f32);
        let right = (column + 1).min(self.grid.width - 1);
        let below = (row + 1).min(self.grid.height - 1);
        let value = |c: usize, r: usize| self.data[r * self.grid.width + c];
        let upper = value(column, row) * (1.0 - t.x) + value(right, row) * t.x;
        let lower = value(column, below) * (1.0 - t.x) + value(right, below) * t.x;
        upper * (1.0 - t.y) + lower * t.y
    }

    /// Change per mm.
    pub fn gradient(&self, at_mm: Vec2) -> Vec2 {
        let h = self.grid.pitch_mm;
        let x = self.at(at_mm + Vec2::new(h.x, 0.0)) - self.at(at_mm - Vec2::new(h.x, 0.0));
        let y = self.at(at_mm + Vec2::new(0.0, h.y)) - self.at(at_mm - Vec2::new(0.0, h.y));
        Vec2::new(x, y) / (2.0 * h)
    }

    /// Smoothed by three box filters, close to a Gaussian of this standard deviation in mm.
    pub fn blurred(&self, sigma_mm: f32) -> Self {
        let mut data = self.data.clone();
        let (w, h) = (self.grid.width, self.grid.height);
        for _ in 0..3 {
            data = box_rows(&data, w, (sigma_mm / self.grid.pitch_mm.x).round() as usize);
            data = transposed(&data, w, h);
            data = box_rows(&data, h, (sigma_mm / self.grid.pitch_mm.y).round() as usize);
            data = transposed(&data, h, w);
        }
        Self {
            grid: self.grid,
            data,
        }
    }
}

/// A running mean over 2 · `radius` + 1 samples of each row, rows continued beyond their ends.
pub fn box_rows(data: &[f32], width: usize, radius: usize) -> Vec<f32> {
    let mut out = vec![0.0; data.len()];
    let scale = 1.0 / (2 * radius + 1) as f32;
    let rows = out.par_chunks_mut(width).zip(data.par_chunks(width));
    rows.for_each(|(out, row)| {
        let clamped = |i: isize| row[i.clamp(0, width as isize - 1) as usize];
        let radius = radius as isize;
        let mut sum: f32 = (-radius..=radius).map(clamped).sum();
        for (i, out) in out.iter_mut().enumerate() {
            *out = sum * scale;
            sum += clamped(i as isize + radius + 1) - clamped(i as isize - radius);
        }
    });
    out
}

/// Rows become columns.
pub fn transposed(data: &[f32], width: usize, height: usize) -> Vec<f32> {
    let mut out = Vec::with_capacity(data.len());
    for column in 0..width {
        out.extend((0..height).map(|row| data[row * width + column]));
    }
    out
}
