//! Cosine and sine transforms of pictures, in which second differences are products.
//!
//! Two real lines share one complex transform (Makhoul, *IEEE Transactions on Acoustics, Speech and
//! Signal Processing* 28 (1980) 27, for the cosine transform's order of values).

#![allow(
    clippy::needless_range_loop,
    reason = "several arrays run along one index, as their formulas do"
)]

use std::{f64::consts::PI, sync::Arc};

use rayon::prelude::*;
use rustfft::{Fft, FftPlanner, num_complex::Complex64};

/// What a line is expanded into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// DCT-II: lines that go on mirrored, so that nothing flows over their ends.
    Cosine,
    /// DST-I: lines that are 0 just beyond their ends.
    Sine,
    /// DST-II: what the slope of a [`Kind::Cosine`] line is expanded into, term by term; the first
    /// term, which has none, is 0. Only forwards.
    Slope,
}

/// The transform of lines of one length, and back.
pub struct Line {
    kind: Kind,
    length: usize,
    forward: Arc<dyn Fft<f64>>,
    inverse: Arc<dyn Fft<f64>>,
    /// e^(−iπk/2N).
    twiddles: Vec<Complex64>,
}

impl Line {
    pub fn new(kind: Kind, length: usize) -> Self {
        let mut planner = FftPlanner::new();
        let size = match kind {
            Kind::Cosine | Kind::Slope => length.max(1),
            Kind::Sine => 2 * (length + 1),
        };
        let turn = |k: usize| Complex64::from_polar(1.0, -PI * k as f64 / (2 * size) as f64);
        Self {
            kind,
            length,
            forward: planner.plan_fft_forward(size),
            inverse: planner.plan_fft_inverse(size),
            twiddles: (0..size).map(turn).collect(),
        }
    }

    /// The frequency of each term, in radians per pixel.
    pub fn frequencies(&self) -> Vec<f64> {
        let angle = |k: usize| match self.kind {
            Kind::Cosine | Kind::Slope => PI * k as f64 / self.length as f64,
            Kind::Sine => PI * (k + 1) as f64 / (self.length + 1) as f64,
        };
        (0..self.length).map(angle).collect()
    }

    /// The eigenvalue of −(second difference) for each term: 2 − 2 cos.
    pub fn eigenvalues(&self) -> Vec<f64> {
        // 4 sin²(θ/2) does not cancel for long waves.
        let terms = self.frequencies().into_iter();
        terms
            .map(|angle| 4.0 * (angle / 2.0).sin().powi(2))
            .collect()
    }

    /// Transforms two lines in place.
    fn apply(&self, a: &mut [f64], b: &mut [f64], back: bool, buffer: &mut Vec<Complex64>) {
        match (self.kind, back) {
            (Kind::Cosine, false) => self.cosine(a, b, buffer),
            (Kind::Cosine, true) => self.cosine_back(a, b, buffer),
            (Kind::Sine, back) => self.sine(a, b, back, buffer),
            (Kind::Slope, _) => self.slope(a, b, buffer),
        }
    }

    fn cosine(&self, a: &mut [f64], b: &mut [f64], buffer: &mut Vec<Complex64>) {
        let n = self.length;
        buffer.clear();
        buffer.extend((0..n.div_ceil(2)).map(|i| Complex64::new(a[2 * i], b[2 * i])));
        buffer.extend(
            (0..n / 2)
                .rev()
                .map(|i| Complex64::new(a[2 * i + 1], b[2 * i + 1])),
        );
        self.forward.process(buffer);
        for k in 0..n {
            let (z, mirrored) = (buffer[k], buffer[(n - k) % n].conj());
            let turn = self.twiddles[k];
            a[k] = ((z + mirrored) * turn).re / 2.0;
            b[k] = ((z - mirrored) * turn).im / 2.0;
        }
    }

    fn cosine_back(&self, a: &mut [f64], b: &mut [f64], buffer: &mut Vec<Complex64>) {
        let n = self.length;
        buffer.clear();
        let term = |line: &[f64], k: usize| {
            let other = if k == 0 { 0.0 } else { line[n - k] };
            Complex64::new(line[k], -other) * self.twiddles[k].conj()
        };
        buffer.extend((0..n).map(|k| term(a, k) + Complex64::i() * term(b, k)));
        self.inverse.process(buffer);
        let scale = 1.0 / n as f64;
        for i in 0..n {
            let from = if i % 2 == 0 { i / 2 } else { n - 1 - i / 2 };
            a[i] = buffer[from].re * scale;
            b[i] = buffer[from].im * scale;
        }
    }

    /// DST-II_m = DCT-II_(N−m) of the line with every other value negated.
    fn slope(&self, a: &mut [f64], b: &mut [f64], buffer: &mut Vec<Complex64>) {
        for line in [&mut *a, &mut *b] {
            line.iter_mut().skip(1).step_by(2).for_each(|v| *v = -*v);
        }
        self.cosine(a, b, buffer);
        for line in [a, b] {
            // Terms N−1 … 1 become 1 … N−1; that of the highest frequency has no cosine.
            line[0] = 0.0;
            line[1..].reverse();
        }
    }

    fn sine(&self, a: &mut [f64], b: &mut [f64], back: bool, buffer: &mut Vec<Complex64>) {
        let (n, size) = (self.length, 2 * (self.length + 1));
        buffer.clear();
        buffer.resize(size, Complex64::ZERO);
        for i in 0..n {
            let value = Complex64::new(a[i], b[i]);
            buffer[i + 1] = value;
            buffer[size - 1 - i] = -value;
        }
        self.forward.process(buffer);
        // Of an odd line the transform is −2i times its sine transform.
        let scale = if back { 1.0 / (n + 1) as f64 } else { 1.0 };
        for k in 0..n {
            let z = buffer[k + 1];
            a[k] = -z.im / 2.0 * scale * 2.0_f64.powi(i32::from(back));
            b[k] = z.re / 2.0 * scale * 2.0_f64.powi(i32::from(back));
        }
    }
}

/// Transforms a picture of `width` along its rows and its columns, in place.
pub fn transform(picture: &mut [f64], width: usize, [across, down]: [&Line; 2], back: bool) {
    picture
        .par_chunks_mut(2 * width)
        .for_each_init(Vec::new, |buffer, rows| pairs(rows, across, back, buffer));
    along_columns(picture, width, |columns, buffer| {
        pairs(columns, down, back, buffer);
    });
}

/// Transforms lines one after another, two at a time.
fn pairs(lines: &mut [f64], line: &Line, back: bool, buffer: &mut Vec<Complex64>) {
    for pair in lines.chunks_mut(2 * line.length) {
        let (a, b) = pair.split_at_mut(line.length);
        if b.is_empty() {
            line.apply(a, &mut vec![0.0; line.length], back, buffer);
        } else {
            line.apply(a, b, back, buffer);
        }
    }
}

/// Calls `work` with all columns of a picture of `width` as lines one after another, an even number
/// of them at a time but for the last, and puts them back. A few are taken out at once: a second
/// picture, with rows and columns exchanged, would take as much memory as the first. `work` may use a
/// buffer that it finds as it left it, or empty.
pub(super) fn along_columns<T, B>(
    picture: &mut [T],
    width: usize,
    work: impl Fn(&mut [T], &mut B) + Sync,
) where
    T: Copy + Default + Send + Sync,
    B: Default + Send,
{
    /// Columns that are taken out at once: a few lines of a cache in each row.
    const TOGETHER: usize = 32;
    /// Rows that are exchanged at once, so that both sides stay in a cache.
    const TILE: usize = 8;
    let height = picture.len() / width;
    let strips = width.div_ceil(TOGETHER);
    let mut strips: Vec<Vec<&mut [T]>> = (0..strips).map(|_| Vec::with_capacity(height)).collect();
    for row in picture.chunks_exact_mut(width) {
        for (strip, part) in strips.iter_mut().zip(row.chunks_mut(TOGETHER)) {
            strip.push(part);
        }
    }
    strips.par_iter_mut().for_each_init(
        || (Vec::new(), B::default()),
        |(columns, buffer), strip| {
            let count = strip.first().map_or(0, |part| part.len());
            columns.resize(count * height, T::default());
            for (tile, rows) in strip.chunks(TILE).enumerate() {
                for x in 0..count {
                    let start = x * height + tile * TILE;
                    let column = &mut columns[start..start + rows.len()];
                    for (value, row) in column.iter_mut().zip(rows) {
                        *value = row[x];
                    }
                }
            }
            work(columns, buffer);
            for (tile, rows) in strip.chunks_mut(TILE).enumerate() {
                for x in 0..count {
                    let start = x * height + tile * TILE;
                    let column = &columns[start..start + rows.len()];
                    for (value, row) in column.iter().zip(rows.iter_mut()) {
                        row[x] = *value;
                    }
                }
            }
        },
    );
}
