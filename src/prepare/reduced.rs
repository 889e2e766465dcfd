//! Photographs made smaller, for what is looked for at a coarser scale than it is measured at.

use std::path::Path;

use super::{
    capture::Crop,
    photographs::{Stack, StackError},
};
use crate::maps::ColourEncoding;

/// Means over squares of pixels of part of a photograph.
#[derive(Clone, Debug, PartialEq)]
pub struct Reduced {
    /// Squares along x and y; what does not fill one at the right and lower edge is left out.
    pub size: [usize; 2],
    /// Linear red, green and blue.
    pub planes: [Vec<f32>; 3],
}

impl Reduced {
    /// Reads `crop` of a photograph, squares of `step` pixels (1 or more) at a time.
    ///
    /// # Errors
    /// [`StackError`].
    pub fn read(
        path: &Path,
        encoding: ColourEncoding,
        crop: Crop,
        step: usize,
        scratch: &Path,
    ) -> Result<Self, StackError> {
        let paths = [path.to_owned()];
        let mut stack = Stack::open(&paths, None, encoding, crop, scratch)?;
        let mut squares = Squares::new(crop, step);
        let mut planes = [const { Vec::new() }; 3];
        while let Some(band) = stack.next()? {
            for row in 0..band.rows {
                squares.add(band.row(0, row), |means| {
                    for (plane, means) in planes.iter_mut().zip(means) {
                        plane.extend_from_slice(means);
                    }
                });
            }
            stack.recycle(band);
        }
        Ok(Self {
            size: squares.size,
            planes,
        })
    }

    /// Luminance as [`Grey`] has it.
    pub fn grey(&self) -> Vec<f32> {
        let [r, g, b] = self.planes.each_ref().map(Vec::as_slice);
        toned(luminance([r, g, b]).collect())
    }
}

/// The luminance of a photograph alone, made smaller while its rows run through for something else.
#[derive(Clone, Debug, PartialEq)]
pub struct Grey {
    squares: Squares,
    /// Linear light of the squares that are whole.
    linear: Vec<f32>,
}

impl Grey {
    /// Of `crop` of a photograph, squares of `step` pixels (1 or more) at a time.
    pub fn new(crop: Crop, step: usize) -> Self {
        let squares = Squares::new(crop, step);
        let [width, height] = squares.size;
        Self {
            squares,
            linear: Vec::with_capacity(width * height),
        }
    }

    /// How many bytes [`Self::new`] takes.
    pub fn bytes(crop: Crop, step: usize) -> usize {
        let [width, height] = Squares::size(crop, step);
        width * height * size_of::<f32>()
    }

    /// Takes the next row: its linear red, green and blue.
    pub fn add(&mut self, row: [&[f32]; 3]) {
        let Self { squares, linear } = self;
        squares.add(row, |means| linear.extend(luminance(means)));
    }

    /// Squares along x and y, and luminance as the eye sees it: the root of linear light over what
    /// nearly all of the picture stays below, in 0…1; what gleams is above 1.
    pub fn finish(self) -> ([usize; 2], Vec<f32>) {
        (self.squares.size, toned(self.linear))
    }
}

/// Sums over a row of squares of pixels.
#[derive(Clone, Debug, PartialEq)]
struct Squares {
    /// Squares along x and y; what does not fill one at the right and lower edge is left out.
    size: [usize; 2],
    step: usize,
    /// Rows of pixels that are in the sums.
    rows: usize,
    sums: [Vec<f32>; 3],
}

impl Squares {
    fn new(crop: Crop, step: usize) -> Self {
        let size = Self::size(crop, step);
        Self {
            size,
            step,
            rows: 0,
            sums: [0, 1, 2].map(|_| vec![0.0; size[0]]),
        }
    }

    fn size(crop: Crop, step: usize) -> [usize; 2] {
        [crop.width() / step, crop.height() / step]
    }

    /// Adds a row of pixels, and calls `whole` with the means of a row of squares once it is whole.
    fn add(&mut self, row: [&[f32]; 3], whole: impl FnOnce([&[f32]; 3])) {
        for (sums, pixels) in self.sums.iter_mut().zip(row) {
            for (sum, pixels) in sums.iter_mut().zip(pixels.chunks_exact(self.step)) {
                *sum += pixels.iter().sum::<f32>();
            }
        }
        self.rows += 1;
        if self.rows < self.step {
            return;
        }
        let count = (self.step * self.step) as f32;
        for sums in &mut self.sums {
            sums.iter_mut().for_each(|sum| *sum /= count);
        }
        whole(self.sums.each_ref().map(Vec::as_slice));
        self.rows = 0;
        for sums in &mut self.sums {
            sums.fill(0.0);
        }
    }
}

/// The sum of values: in lanes, which do not wait for each other.
pub fn sum_of(values: &[f32]) -> f32 {
    const LANES: usize = 16;
    let (whole, rest) = values.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for values in whole {
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum += value;
        }
    }
    sums.iter().chain(rest).sum()
}

fn luminance([r, g, b]: [&[f32]; 3]) -> impl Iterator<Item = f32> {
    let linear = r.iter().zip(g).zip(b);
    linear.map(|((r, g), b)| (0.25 * r + 0.5 * g + 0.25 * b).max(0.0))
}

/// Linear light → as the eye sees it.
fn toned(linear: Vec<f32>) -> Vec<f32> {
    /// What is brighter gleams.
    const BRIGHTEST: f64 = 0.999;
    let mut sorted = linear.clone();
    let Some(last) = sorted.len().checked_sub(1) else {
        return linear;
    };
    let i = (last as f64 * BRIGHTEST) as usize;
    let (_, &mut white, above) = sorted.select_nth_unstable_by(i, f32::total_cmp);
    // A picture that is black but for its gleam.
    let brightest = above.iter().copied().fold(white, f32::max);
    let white = white.max(brightest * 1e-3).max(f32::MIN_POSITIVE);
    linear.iter().map(|v| (v / white).sqrt()).collect()
}

/// The smallest step that makes a side of this many pixels at most `longest` squares long.
pub fn step_to(longest: usize, [width, height]: [usize; 2]) -> usize {
    width.max(height).div_ceil(longest).max(1)
}
