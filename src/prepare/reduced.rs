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
        let size = [crop.width() / step, crop.height() / step];
        let [width, height] = size;
        let mut planes = [0, 1, 2].map(|_| vec![0.0f32; width * height]);
        while let Some(band) = stack.next()? {
            for row in 0..band.rows {
                let y = (band.top + row) / step;
                if y >= height {
                    continue;
                }
                for (plane, pixels) in planes.iter_mut().zip(band.row(0, row)) {
                    let out = &mut plane[y * width..(y + 1) * width];
                    for (out, pixels) in out.iter_mut().zip(pixels.chunks_exact(step)) {
                        *out += pixels.iter().sum::<f32>();
                    }
                }
            }
        }
        let count = (step * step) as f32;
        for plane in &mut planes {
            plane.iter_mut().for_each(|value| *value /= count);
        }
        Ok(Self { size, planes })
    }

    /// Luminance as the eye sees it: the root of linear light over what nearly all of the picture
    /// stays below, in 0…1; what gleams is above 1.
    pub fn grey(&self) -> Vec<f32> {
        /// What is brighter gleams.
        const BRIGHTEST: f64 = 0.999;
        let [r, g, b] = &self.planes;
        let linear = r.iter().zip(g).zip(b);
        let linear: Vec<f32> = linear
            .map(|((r, g), b)| (0.25 * r + 0.5 * g + 0.25 * b).max(0.0))
            .collect();
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
}

/// The smallest step that makes a side of this many pixels at most `longest` squares long.
pub fn step_to(longest: usize, [width, height]: [usize; 2]) -> usize {
    width.max(height).div_ceil(longest).max(1)
}
