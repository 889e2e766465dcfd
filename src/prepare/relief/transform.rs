//! Cosine and sine transforms of pictures, in which second differences are products.
//!
//! Two real lines share one complex transform (Makhoul, *IEEE Transactions on Acoustics, Speech and
//! Signal Processing* 28 (1980) 27, for the cosine transform's order of values).

use std::{f64::consts::PI, sync::Arc};

use rayon::prelude::*;
use rustfft::{Fft, FftPlanner, num_complex::Complex};

use super::real::Real;

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
pub struct Line<T: Real> {
    kind: Kind,
    length: usize,
    forward: Arc<dyn Fft<T>>,
    inverse: Arc<dyn Fft<T>>,
    /// e^(−iπk/2N).
    twiddles: Vec<Complex<T>>,
}

/// What a transform works in, kept from one line to the next.
#[derive(Default)]
pub(super) struct Room<T> {
    values: Vec<Complex<T>>,
    scratch: Vec<Complex<T>>,
}

impl<T: Real> Room<T> {
    fn transform(&mut self, fft: &dyn Fft<T>) {
        let least = fft.get_inplace_scratch_len();
        if self.scratch.len() < least {
            self.scratch.resize(least, Complex::default());
        }
        fft.process_with_scratch(&mut self.values, &mut self.scratch);
    }
}

impl<T: Real> Line<T> {
    pub fn new(kind: Kind, length: usize) -> Self {
        let mut planner = FftPlanner::new();
        let size = match kind {
            Kind::Cosine | Kind::Slope => length.max(1),
            Kind::Sine => 2 * (length + 1),
        };
        let turn = |k: usize| {
            let turn = Complex::from_polar(1.0, -PI * k as f64 / (2 * size) as f64);
            Complex::new(T::of(turn.re), T::of(turn.im))
        };
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
    fn apply(&self, a: &mut [T], b: &mut [T], back: bool, room: &mut Room<T>) {
        match (self.kind, back) {
            (Kind::Cosine, false) => self.cosine(a, b, room),
            (Kind::Cosine, true) => self.cosine_back(a, b, room),
            (Kind::Sine, back) => self.sine(a, b, back, room),
            (Kind::Slope, _) => self.slope(a, b, room),
        }
    }

    fn cosine(&self, a: &mut [T], b: &mut [T], room: &mut Room<T>) {
        let even = a.iter().step_by(2).zip(b.iter().step_by(2));
        // Backwards, from the last one of an odd place.
        let odd = a.chunks_exact(2).zip(b.chunks_exact(2)).rev();
        let values = &mut room.values;
        values.clear();
        values.extend(even.map(|(a, b)| Complex::new(*a, *b)));
        values.extend(odd.map(|(a, b)| Complex::new(a[1], b[1])));
        room.transform(&*self.forward);
        let half = T::of(0.5);
        let of_both = |z: &Complex<T>, mirror: &Complex<T>, turn: &Complex<T>| {
            (
                ((z.re + mirror.re) * turn.re - (z.im - mirror.im) * turn.im) * half,
                ((z.re - mirror.re) * turn.im + (z.im + mirror.im) * turn.re) * half,
            )
        };
        // The first term is its own mirror.
        let ([first, rest @ ..], [turn, turns @ ..]) = (&*room.values, &*self.twiddles) else {
            return;
        };
        (a[0], b[0]) = of_both(first, first, turn);
        let terms = rest.iter().zip(rest.iter().rev()).zip(turns);
        for ((a, b), ((z, mirror), turn)) in a[1..].iter_mut().zip(&mut b[1..]).zip(terms) {
            (*a, *b) = of_both(z, mirror, turn);
        }
    }

    fn cosine_back(&self, a: &mut [T], b: &mut [T], room: &mut Room<T>) {
        let n = self.length;
        let scale = T::of(1.0 / n as f64);
        // (a − ip + i(b − iq)) times the conjugate of the turn.
        let term = |[a, p]: [&T; 2], [b, q]: [&T; 2], turn: &Complex<T>| {
            let (re, im) = (*a + *q, *b - *p);
            Complex::new(
                (re * turn.re + im * turn.im) * scale,
                (im * turn.re - re * turn.im) * scale,
            )
        };
        let ([first_a, rest_a @ ..], [first_b, rest_b @ ..], [turn, turns @ ..]) =
            (&*a, &*b, &*self.twiddles)
        else {
            return;
        };
        let none = T::default();
        let terms_a = rest_a.iter().zip(rest_a.iter().rev());
        let terms_b = rest_b.iter().zip(rest_b.iter().rev());
        let values = &mut room.values;
        values.clear();
        values.push(term([first_a, &none], [first_b, &none], turn));
        let terms = terms_a.zip(terms_b).zip(turns);
        values.extend(terms.map(|(((a, p), (b, q)), turn)| term([a, p], [b, q], turn)));
        room.transform(&*self.inverse);
        let (even, odd) = room.values.split_at(n.div_ceil(2));
        for ((a, b), z) in a
            .iter_mut()
            .step_by(2)
            .zip(b.iter_mut().step_by(2))
            .zip(even)
        {
            (*a, *b) = (z.re, z.im);
        }
        let (a, b) = (
            a.iter_mut().skip(1).step_by(2),
            b.iter_mut().skip(1).step_by(2),
        );
        for ((a, b), z) in a.zip(b).zip(odd.iter().rev()) {
            (*a, *b) = (z.re, z.im);
        }
    }

    /// DST-II_m = DCT-II_(N−m) of the line with every other value negated.
    fn slope(&self, a: &mut [T], b: &mut [T], room: &mut Room<T>) {
        for line in [&mut *a, &mut *b] {
            line.iter_mut().skip(1).step_by(2).for_each(|v| *v = -*v);
        }
        self.cosine(a, b, room);
        for line in [a, b] {
            // Terms N−1 … 1 become 1 … N−1; that of the highest frequency has no cosine.
            line[0] = T::default();
            line[1..].reverse();
        }
    }

    fn sine(&self, a: &mut [T], b: &mut [T], back: bool, room: &mut Room<T>) {
        let (n, size) = (self.length, 2 * (self.length + 1));
        room.values.clear();
        room.values.resize(size, Complex::default());
        for i in 0..n {
            let value = Complex::new(a[i], b[i]);
            room.values[i + 1] = value;
            room.values[size - 1 - i] = -value;
        }
        room.transform(&*self.forward);
        // Of an odd line the transform is −2i times its sine transform.
        let scale = T::of(if back { 1.0 / (n + 1) as f64 } else { 0.5 });
        for ((a, b), z) in a.iter_mut().zip(b).zip(&room.values[1..]) {
            *a = -z.im * scale;
            *b = z.re * scale;
        }
    }
}

/// Transforms a picture of `width` along its rows and its columns, in place.
pub fn transform<T: Real>(
    picture: &mut [T],
    width: usize,
    [across, down]: [&Line<T>; 2],
    back: bool,
) {
    picture
        .par_chunks_mut(2 * width)
        .for_each_init(Room::default, |room, rows| pairs(rows, across, back, room));
    along_columns(picture, width, |columns, room| {
        pairs(columns, down, back, room);
    });
}

/// Transforms lines one after another, two at a time.
fn pairs<T: Real>(lines: &mut [T], line: &Line<T>, back: bool, room: &mut Room<T>) {
    for pair in lines.chunks_mut(2 * line.length) {
        let (a, b) = pair.split_at_mut(line.length);
        if b.is_empty() {
            line.apply(a, &mut vec![T::default(); line.length], back, room);
        } else {
            line.apply(a, b, back, room);
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
    /// Bytes of each row that are taken out at once: a few lines of a cache.
    const BYTES: usize = 256;
    /// Rows that are exchanged at once: of each a stretch is copied as it lies, so that not every
    /// value has to be waited for.
    const TILE: usize = 16;
    let together = (BYTES / size_of::<T>()).next_multiple_of(2).max(2);
    let height = picture.len() / width;
    let strips = width.div_ceil(together);
    let mut strips: Vec<Vec<&mut [T]>> = (0..strips).map(|_| Vec::with_capacity(height)).collect();
    for row in picture.chunks_exact_mut(width) {
        for (strip, part) in strips.iter_mut().zip(row.chunks_mut(together)) {
            strip.push(part);
        }
    }
    strips.par_iter_mut().for_each_init(
        || {
            (
                Vec::new(),
                vec![T::default(); together * TILE],
                B::default(),
            )
        },
        |(columns, tile, buffer), strip| {
            let count = strip.first().map_or(0, |part| part.len());
            columns.resize(count * height, T::default());
            for (i, rows) in strip.chunks(TILE).enumerate() {
                for (out, row) in tile.chunks_exact_mut(count).zip(rows) {
                    out.copy_from_slice(row);
                }
                for x in 0..count {
                    let start = x * height + i * TILE;
                    let column = &mut columns[start..start + rows.len()];
                    let values = tile[x..].iter().step_by(count);
                    for (out, value) in column.iter_mut().zip(values) {
                        *out = *value;
                    }
                }
            }
            work(columns, buffer);
            for (i, rows) in strip.chunks_mut(TILE).enumerate() {
                for x in 0..count {
                    let start = x * height + i * TILE;
                    let column = &columns[start..start + rows.len()];
                    let values = tile[x..].iter_mut().step_by(count);
                    for (out, value) in values.zip(column) {
                        *out = *value;
                    }
                }
                for (row, values) in rows.iter_mut().zip(tile.chunks_exact(count)) {
                    row.copy_from_slice(values);
                }
            }
        },
    );
}
