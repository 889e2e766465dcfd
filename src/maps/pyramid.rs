//! Mip chains: every level is the exact area mean of the picture, filtered before it is stored.

use half::{f16, slice::HalfFloatSliceExt};
use rayon::prelude::*;

/// Channel values as a graphics card stores them, interleaved, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// 0…255 stand for 0…1.
    Unorm8(Vec<u8>),
    /// 0…65535 stand for 0…1.
    Unorm16(Vec<u16>),
    /// The values themselves; finite.
    Half(Vec<f16>),
}

impl Texels {
    /// How many values there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Unorm8(v) => v.len(),
            Self::Unorm16(v) => v.len(),
            Self::Half(v) => v.len(),
        }
    }

    /// True where there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value at `index` as a shader reads it; `None` beyond the end.
    pub fn get(&self, index: usize) -> Option<f32> {
        Some(match self {
            Self::Unorm8(v) => f32::from(*v.get(index)?) / 255.0,
            Self::Unorm16(v) => f32::from(*v.get(index)?) / 65535.0,
            Self::Half(v) => v.get(index)?.to_f32(),
        })
    }

    /// Appends the bytes to upload, in the machine's order.
    pub fn append_to(&self, bytes: &mut Vec<u8>) {
        match self {
            Self::Unorm8(values) => bytes.extend_from_slice(values),
            Self::Unorm16(values) => bytes.extend_from_slice(bytemuck::cast_slice(values)),
            Self::Half(values) => {
                bytes.extend_from_slice(bytemuck::cast_slice(values.reinterpret_cast()));
            }
        }
    }

    /// The same values as half floats, for devices that do not read 16-bit integers.
    pub fn into_half(self) -> Self {
        match self {
            Self::Unorm16(values) => Self::Half(
                values
                    .into_iter()
                    .map(|value| f16::from_f32(f32::from(value) / 65535.0))
                    .collect(),
            ),
            other => other,
        }
    }
}

/// One level of a mip chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    pub width: u32,
    pub height: u32,
    /// `width * height * channels` values.
    pub texels: Texels,
}

/// A picture and its mip chain, ready for the graphics card.
#[derive(Clone, Debug, PartialEq)]
pub struct Pyramid {
    /// Values per texel: 1, 2 or 4.
    pub channels: u8,
    /// From full size to 1 × 1; each side is half of the one before, rounded down, at least 1.
    pub levels: Vec<Level>,
    /// How many pixels of the file are missing ([`super::Missing`]).
    pub missing: u64,
}

/// A stored value.
pub(super) trait Texel: Copy + Default + Send + Sync {
    /// From the value that a shader is to read; what cannot be stored is clamped.
    fn store(value: f32) -> Self;
    fn wrap(values: Vec<Self>) -> Texels;
}

impl Texel for u8 {
    fn store(value: f32) -> Self {
        // The cast saturates and sends NaN to 0.
        (value * 255.0 + 0.5) as u8
    }
    fn wrap(values: Vec<Self>) -> Texels {
        Texels::Unorm8(values)
    }
}

impl Texel for u16 {
    fn store(value: f32) -> Self {
        (value * 65535.0 + 0.5) as u16
    }
    fn wrap(values: Vec<Self>) -> Texels {
        Texels::Unorm16(values)
    }
}

impl Texel for f16 {
    fn store(value: f32) -> Self {
        f16::from_f32(value.clamp(f16::MIN.to_f32(), f16::MAX.to_f32()))
    }
    fn wrap(values: Vec<Self>) -> Texels {
        Texels::Half(values)
    }
}

/// Pixels of `C` quantities whose means are meaningful.
struct Plane<const C: usize> {
    width: usize,
    height: usize,
    pixels: Vec<[f32; C]>,
}

/// Builds the whole chain. `row(y, out)` gives a row of the picture as quantities that may be
/// averaged; `paint` turns such a mean into the texel that is stored.
pub(super) fn build<T: Texel, const C: usize, const N: usize>(
    [width, height]: [usize; 2],
    row: impl Fn(usize, &mut [[f32; C]]) + Sync,
    paint: impl Fn([f32; C]) -> [f32; N] + Sync,
) -> Pyramid {
    let mut levels = vec![store::<T, C, N>(width, height, &row, &paint)];
    if width > 1 || height > 1 {
        let mut plane = halve(width, height, &row);
        loop {
            let Plane {
                width,
                height,
                pixels,
            } = &plane;
            let copy = |y: usize, out: &mut [[f32; C]]| {
                out.copy_from_slice(&pixels[y * width..(y + 1) * width]);
            };
            levels.push(store::<T, C, N>(*width, *height, &copy, &paint));
            if *width == 1 && *height == 1 {
                break;
            }
            plane = halve(*width, *height, &copy);
        }
    }
    Pyramid {
        channels: N as u8,
        levels,
        missing: 0,
    }
}

fn store<T: Texel, const C: usize, const N: usize>(
    width: usize,
    height: usize,
    row: &(impl Fn(usize, &mut [[f32; C]]) + Sync),
    paint: &(impl Fn([f32; C]) -> [f32; N] + Sync),
) -> Level {
    let mut values = vec![T::default(); width * height * N];
    values.par_chunks_mut(width * N).enumerate().for_each_init(
        || vec![[0.0; C]; width],
        |pixels, (y, out)| {
            row(y, pixels);
            for (texel, pixel) in out.as_chunks_mut::<N>().0.iter_mut().zip(pixels.iter()) {
                *texel = paint(*pixel).map(T::store);
            }
        },
    );
    Level {
        width: width as u32,
        height: height as u32,
        texels: T::wrap(values),
    }
}

/// The next smaller level by exact area means.
fn halve<const C: usize>(
    width: usize,
    height: usize,
    row: &(impl Fn(usize, &mut [[f32; C]]) + Sync),
) -> Plane<C> {
    let (w, h) = ((width / 2).max(1), (height / 2).max(1));
    let mut pixels = vec![[0.0; C]; w * h];
    pixels.par_chunks_mut(w).enumerate().for_each_init(
        || (vec![[0.0; C]; width], vec![[0.0; C]; width]),
        |(source, column_means), (y, out)| {
            for (i, (y, weight)) in taps(y, height, h).enumerate() {
                row(y, source);
                for (mean, value) in column_means.iter_mut().zip(source.iter()) {
                    for c in 0..C {
                        let sum = if i == 0 { 0.0 } else { mean[c] };
                        mean[c] = sum + weight * value[c];
                    }
                }
            }
            for (x, mean) in out.iter_mut().enumerate() {
                let mut sum = [0.0; C];
                for (x, weight) in taps(x, width, w) {
                    for c in 0..C {
                        sum[c] += weight * column_means[x][c];
                    }
                }
                *mean = sum;
            }
        },
    );
    Plane {
        width: w,
        height: h,
        pixels,
    }
}

/// Which of `n` pixels lie under pixel `i` of `m`, and the share of it that each covers, where
/// `m` is `n / 2` rounded down, or both are 1. Every source pixel has the same total weight, so
/// means are conserved for odd sizes too.
fn taps(i: usize, n: usize, m: usize) -> impl Iterator<Item = (usize, f32)> {
    let (start, weights, count) = if n == m {
        (i, [1.0, 0.0, 0.0], 1)
    } else if n == 2 * m {
        (2 * i, [0.5, 0.5, 0.0], 2)
    } else {
        let share = |v: usize| v as f32 / n as f32;
        (2 * i, [share(m - i), share(m), share(i + 1)], 3)
    };
    (0..count).map(move |k| (start + k, weights[k]))
}
