//! What a lamp gives to each place of the photograph, from one of a grey card.
//!
//! A card's photograph is read as means over cells, which keep a lamp's fall-off and the lens's
//! shading and leave noise, dust and the card's own texture out; between the cells' middles it is
//! bilinear. A photograph divided by it shows π times the radiance of the sheet over that of a
//! perfect diffuser which lies flat in its place.

use std::path::{Path, PathBuf};

use super::{
    photographs::{Stack, StackError},
    reduced::sum_of,
};
use crate::maps::ColourEncoding;

use super::capture::Crop;

/// Cells along the longer side. A bilinear patch misses h²/8 of the curvature: 1e-4 of a fall-off
/// by half over the picture.
const CELLS: usize = 64;
/// The smallest side of a cell in pixels: what noise and texture are averaged over.
const LEAST_PX: usize = 8;
/// Rows of a cell that are enough to average over.
const ROWS: usize = 40;
/// The darkest cell over the brightest: below, division makes more noise than light.
const DARKEST: f64 = 0.02;
/// Linear light from which a channel counts as clipped.
const CLIPPED: f32 = 0.995;
/// The share of the card's photograph that may be clipped.
const CLIPPED_SHARE: f64 = 0.001;

/// Why a photograph of a grey card cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum FlatFieldError {
    #[error(transparent)]
    File(#[from] StackError),
    #[error(
        "{path}: what shows the light alone, a grey card or a light table, is saturated on {share:.1} % of the picture; photograph it with less exposure"
    )]
    Saturated { path: String, share: f64 },
    #[error("{path}: around column {x}, row {y} the grey card has {percent:.1} % of its brightest light, where at least {least} % are needed; it has to fill the whole picture", least = DARKEST * 100.0)]
    Dark {
        path: String,
        x: usize,
        y: usize,
        percent: f64,
    },
}

/// A lamp's light over the photograph.
#[derive(Clone, Debug, PartialEq)]
pub struct FlatField {
    /// Cells along x and y.
    cells: [usize; 2],
    /// Width and height of a cell in pixels.
    step: [f64; 2],
    /// Reflectance over mean light of each cell and channel, rows from the top: what a
    /// photograph's values are multiplied with.
    gain: Vec<[f32; 3]>,
}

impl FlatField {
    /// Reads the photograph of a card that reflects `reflectance` of the light; `crop` is what of
    /// it is needed. Of large cells some rows are read. `ambient` shows the card with all lamps
    /// off, and is taken from it.
    ///
    /// # Errors
    /// [`FlatFieldError`].
    pub fn read(
        path: &Path,
        ambient: Option<&Path>,
        encoding: ColourEncoding,
        crop: Crop,
        reflectance: f64,
        scratch: &Path,
    ) -> Result<Self, FlatFieldError> {
        // What is clipped shows before the room's light is taken off.
        let paths: Vec<PathBuf> = [Some(path), ambient]
            .into_iter()
            .flatten()
            .map(Path::to_owned)
            .collect();
        let mut stack = Stack::open(&paths, None, encoding, crop, scratch)?;
        let size = [crop.width(), crop.height()];
        let longer = size[0].max(size[1]);
        let side = longer.div_ceil(CELLS).max(LEAST_PX);
        stack.thin((side.min(size[1]) / ROWS).max(1));
        let cells = size.map(|pixels| (pixels / side).max(1));
        let step = [0, 1].map(|i| size[i] as f64 / cells[i] as f64);
        // The first column whose middle lies in each cell, and the end.
        let first = |cell: usize| ((cell as f64 * step[0] - 0.5).ceil() as usize).min(size[0]);
        let edges: Vec<usize> = (0..=cells[0])
            .map(|cell| {
                if cell == cells[0] {
                    size[0]
                } else {
                    first(cell)
                }
            })
            .collect();
        let mut sums = vec![[0.0f64; 4]; cells[0] * cells[1]];
        let mut clipped = 0u64;
        let mut count = 0;
        while let Some(band) = stack.next()? {
            for row in 0..band.rows {
                let cell_y = (((band.y(row) as f64 + 0.5) / step[1]) as usize).min(cells[1] - 1);
                let planes = band.row(0, row);
                for (cell, edge) in edges.windows(2).enumerate() {
                    let sum = &mut sums[cell_y * cells[0] + cell];
                    let [r, g, b] = planes.map(|plane| &plane[edge[0]..edge[1]]);
                    // As photographs have 16 bits, sums of a cell's row are exact enough.
                    let total = |plane: &[f32]| f64::from(sum_of(plane));
                    for (sum, plane) in sum.iter_mut().zip([r, g, b]) {
                        *sum += total(plane);
                    }
                    if ambient.is_some() {
                        let dark = band.row(1, row).map(|plane| &plane[edge[0]..edge[1]]);
                        for (sum, plane) in sum.iter_mut().zip(dark) {
                            *sum -= total(plane);
                        }
                    }
                    sum[3] += r.len() as f64;
                    let over = r.iter().zip(g).zip(b).filter(|((r, g), b)| {
                        let brightest = r.max(**g).max(**b);
                        brightest >= CLIPPED
                    });
                    clipped += over.count() as u64;
                }
            }
            count += band.rows * band.width;
            stack.recycle(band);
        }
        let share = clipped as f64 / count as f64;
        if share > CLIPPED_SHARE && !stack.is_float() {
            return Err(FlatFieldError::Saturated {
                path: path.display().to_string(),
                share: share * 100.0,
            });
        }
        let means: Vec<[f64; 3]> = sums
            .iter()
            .map(|sum| [0, 1, 2].map(|c| sum[c] / sum[3].max(1.0)))
            .collect();
        for c in 0..3 {
            let brightest = means.iter().map(|mean| mean[c]).fold(0.0, f64::max);
            let darkest = means
                .iter()
                .enumerate()
                .min_by(|a, b| a.1[c].total_cmp(&b.1[c]));
            if let Some((i, mean)) = darkest
                && (mean[c].is_nan() || mean[c] < DARKEST * brightest || mean[c] <= 0.0)
            {
                return Err(FlatFieldError::Dark {
                    path: path.display().to_string(),
                    x: ((i % cells[0]) as f64 * step[0]) as usize,
                    y: ((i / cells[0]) as f64 * step[1]) as usize,
                    percent: 100.0 * mean[c] / brightest.max(f64::MIN_POSITIVE),
                });
            }
        }
        let gain = means
            .into_iter()
            .map(|mean| mean.map(|value| (reflectance / value) as f32))
            .collect();
        Ok(Self { cells, step, gain })
    }

    /// Of which a photograph shows the same everywhere, this much of a perfect diffuser.
    pub fn of_white(white: [f64; 3]) -> Self {
        Self {
            cells: [1, 1],
            step: [1.0, 1.0],
            gain: vec![white.map(|value| value.recip() as f32)],
        }
    }

    /// Its middle alone, everywhere.
    #[must_use]
    pub fn even(&self) -> Self {
        Self {
            cells: [1, 1],
            step: [1.0, 1.0],
            gain: vec![self.middle()],
        }
    }

    /// How it falls off from its middle, which it leaves as it is.
    #[must_use]
    pub fn fall_off(mut self) -> Self {
        let middle = self.middle();
        for gain in &mut self.gain {
            for (gain, middle) in gain.iter_mut().zip(middle) {
                *gain /= middle;
            }
        }
        self
    }

    fn middle(&self) -> [f32; 3] {
        let half = |axis: usize| self.cells[axis] as f64 * self.step[axis] / 2.0;
        let (left, right, share_x) = self.between(0, half(0));
        let (top, bottom, share_y) = self.between(1, half(1));
        let mix = |a: f32, b: f32, share: f32| a + (b - a) * share;
        [0, 1, 2].map(|c| {
            let at = |x: usize, y: usize| self.gain[y * self.cells[0] + x][c];
            let across = |y: usize| mix(at(left, y), at(right, y), share_x);
            mix(across(top), across(bottom), share_y)
        })
    }

    /// Multiplies row `y` of a photograph (planes of red, green, blue) by its gain.
    pub fn divide(&self, y: usize, planes: [&mut [f32]; 3]) {
        let (top, bottom, share_y) = self.between(1, y as f64 + 0.5);
        let width = self.cells[0];
        // Down the rows once, and then along.
        let column = |x: usize, c: usize| {
            let [above, below] = [top, bottom].map(|row| self.gain[row * width + x][c]);
            above + (below - above) * share_y
        };
        for (c, plane) in planes.into_iter().enumerate() {
            let across: Vec<f32> = (0..width).map(|x| column(x, c)).collect();
            if width == 1 {
                plane.iter_mut().for_each(|value| *value *= across[0]);
                continue;
            }
            let mut x = 0;
            for cell in 0..width - 1 {
                // Up to the middle of the next cell; the last one to the edge.
                let end = match cell + 2 == width {
                    true => plane.len(),
                    false => (((cell as f64 + 1.5) * self.step[0]) as usize).clamp(x, plane.len()),
                };
                let slope = (across[cell + 1] - across[cell]) / self.step[0] as f32;
                let from = (x as f64 + 0.5 - (cell as f64 + 0.5) * self.step[0]) as f32;
                let at = across[cell];
                for (i, value) in plane[x..end].iter_mut().enumerate() {
                    // Compilers know how to make many floats of 32 bits at once.
                    *value *= at + slope * (from + i as i32 as f32);
                }
                x = end;
            }
        }
    }

    /// The cells on both sides of a place along an axis, and the second one's share; beyond the
    /// outermost middles the slope goes on.
    fn between(&self, axis: usize, at: f64) -> (usize, usize, f32) {
        let cells = self.cells[axis];
        if cells == 1 {
            return (0, 0, 0.0);
        }
        let place = at / self.step[axis] - 0.5;
        let first = (place.floor().max(0.0) as usize).min(cells - 2);
        (first, first + 1, (place - first as f64) as f32)
    }
}
