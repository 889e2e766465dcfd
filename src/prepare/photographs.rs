//! Many photographs of one sheet, read together a band of rows at a time: what is in memory is
//! bounded by rows, whatever the number of photographs.

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::{capture::Crop, exposed::Tally, flat_field::FlatField, reduced::Grey};
use crate::maps::{ColourEncoding, ColourRows, MapError};

/// What a band takes in memory, in bytes: as much as stays in caches from one step to the next.
const BAND_BYTES: usize = 8 << 20;
/// More, so that there are rows for every processor.
const BAND_ROWS: usize = 64;
/// But not more than this: two bands are held at once, one being read and one solved.
const MOST_BYTES: usize = 48 << 20;
/// And one of a photograph that is read by itself, as each processor may read one.
const SINGLE_BYTES: usize = 8 << 20;
/// Bytes of one pixel of one photograph.
const PIXEL_BYTES: usize = 3 * size_of::<f32>();

/// Why photographs cannot be read together.
#[derive(Debug, thiserror::Error)]
pub enum StackError {
    #[error(transparent)]
    Map(#[from] MapError),
    /// The file was changed since the capture was checked.
    #[error(
        "{path}: is {found} pixels high or wide now, too small for what is to be read of it; begin again"
    )]
    Changed { path: PathBuf, found: String },
}

/// Photographs of one size.
pub struct Stack {
    readers: Vec<ColourRows>,
    ambient: Option<ColourRows>,
    crop: Crop,
    /// Rows of the crop that have been read.
    done: usize,
    band_rows: usize,
    /// Of so many rows one is read.
    step: usize,
    /// Planes of bands that are done with: memory that is given back has to be cleared again.
    spare: Vec<[Vec<f32>; 3]>,
    /// Of each photograph, where it was asked for.
    greys: Vec<Grey>,
    /// The same.
    tallies: Vec<Tally>,
}

/// Rows of all photographs of a stack.
pub struct Band {
    /// The first row, counted from the top of the crop.
    pub top: usize,
    /// From one row to the next: 1, unless the stack is thin.
    step: usize,
    pub rows: usize,
    pub width: usize,
    /// Of each photograph, linear red, green and blue.
    pub planes: Vec<[Vec<f32>; 3]>,
}

impl Band {
    /// Where a row of it is, counted from the top of the crop.
    pub fn y(&self, row: usize) -> usize {
        self.top + row * self.step
    }

    /// Red, green and blue of a row of a photograph.
    pub fn row(&self, photograph: usize, row: usize) -> [&[f32]; 3] {
        let range = row * self.width..(row + 1) * self.width;
        self.planes[photograph]
            .each_ref()
            .map(|plane| &plane[range.clone()])
    }

    /// Divides each photograph by its lamp's light; leaves them as they are without `fields`.
    pub fn divide(&mut self, fields: &[FlatField]) {
        let (rows, width, top, step) = (self.rows, self.width, self.top, self.step);
        let photographs = self.planes.par_iter_mut().zip(fields);
        photographs.for_each(|(planes, field)| {
            let [r, g, b] = planes;
            for row in 0..rows {
                let range = row * width..(row + 1) * width;
                let planes = [&mut r[range.clone()], &mut g[range.clone()], &mut b[range]];
                field.divide(top + row * step, planes);
            }
        });
    }
}

impl Stack {
    /// Opens photographs in the order of the lamps, and one without lamps that is taken from each;
    /// `crop` of them is read. What a format does not give row by row is laid down in `scratch`.
    ///
    /// # Errors
    /// The first file that cannot be opened.
    pub fn open(
        paths: &[PathBuf],
        ambient: Option<&Path>,
        encoding: ColourEncoding,
        crop: Crop,
        scratch: &Path,
    ) -> Result<Self, StackError> {
        let open = |path: &Path| -> Result<ColourRows, StackError> {
            let rows = ColourRows::open(path, encoding, scratch)?;
            let [width, height] = rows.header().size;
            if width < crop.right || height < crop.bottom {
                return Err(StackError::Changed {
                    path: path.to_owned(),
                    found: format!("{width} × {height}"),
                });
            }
            Ok(rows)
        };
        let mut readers = Vec::with_capacity(paths.len());
        for path in paths {
            readers.push(open(path)?);
        }
        let ambient = ambient.map(open).transpose()?;
        let full = readers.first().map_or(1, |rows| rows.header().size[0]) as usize;
        let count = paths.len() + usize::from(ambient.is_some());
        let bytes = full * PIXEL_BYTES * count.max(1);
        let band_rows = match count {
            0 | 1 => SINGLE_BYTES / bytes,
            _ => (BAND_BYTES / bytes).max(BAND_ROWS).min(MOST_BYTES / bytes),
        };
        let mut stack = Self {
            readers,
            ambient,
            crop,
            done: 0,
            spare: Vec::new(),
            greys: Vec::new(),
            tallies: Vec::new(),
            band_rows: band_rows.clamp(1, 512),
            step: 1,
        };
        stack.skip(crop.top as usize)?;
        Ok(stack)
    }

    /// Whether any photograph holds floats, which have no level of clipping.
    pub fn is_float(&self) -> bool {
        self.readers.iter().any(|rows| rows.header().float)
    }

    fn skip(&mut self, rows: usize) -> Result<(), StackError> {
        for reader in self.readers.iter_mut().chain(&mut self.ambient) {
            reader.skip(rows)?;
        }
        Ok(())
    }

    /// Of so many rows (1 or more) one is read from now on, from the first one that is left. Not
    /// together with [`Self::reduce`], which needs all of them.
    pub fn thin(&mut self, step: usize) {
        self.step = step;
    }

    /// From now on, makes smaller what each photograph shows, its room's light included, as
    /// [`Self::greys`] gives it.
    pub fn reduce(&mut self, step: usize) {
        let crop = self.crop;
        self.greys = self.readers.iter().map(|_| Grey::new(crop, step)).collect();
    }

    /// The photographs made smaller, once all bands have been read; none without [`Self::reduce`].
    pub fn greys(&mut self) -> Vec<Grey> {
        std::mem::take(&mut self.greys)
    }

    /// From now on, counts how much light each photograph holds.
    pub fn tally(&mut self) {
        self.tallies = vec![Tally::default(); self.readers.len()];
    }

    /// How much light the photographs hold, as far as they have been read since [`Self::tally`], their room's
    /// included.
    pub fn tallies(&self) -> &[Tally] {
        &self.tallies
    }

    /// Takes back a band that is done with, for its memory.
    pub fn recycle(&mut self, band: Band) {
        self.spare = band.planes;
    }

    /// The next band; `None` at the lower edge.
    ///
    /// # Errors
    /// Of the first photograph that breaks off.
    #[allow(
        clippy::should_implement_trait,
        reason = "an iterator would hide that reading can fail"
    )]
    pub fn next(&mut self) -> Result<Option<Band>, StackError> {
        let step = self.step;
        let left = self.crop.height() - self.done;
        let rows = self.band_rows.min(left.div_ceil(step));
        if rows == 0 {
            return Ok(None);
        }
        let crop = self.crop;
        let read = |reader: &mut ColourRows,
                    spare: Option<[Vec<f32>; 3]>,
                    grey: Option<&mut Grey>|
         -> Result<[Vec<f32>; 3], MapError> {
            let full = reader.header().size[0] as usize;
            let mut planes = spare.unwrap_or_default();
            for plane in &mut planes {
                plane.resize(full * rows, 0.0);
            }
            if step == 1 {
                reader.read(planes.each_mut().map(Vec::as_mut_slice))?;
            } else {
                for row in 0..rows {
                    let range = row * full..(row + 1) * full;
                    reader.read(planes.each_mut().map(|plane| &mut plane[range.clone()]))?;
                    reader.skip((step - 1).min(left - 1 - row * step))?;
                }
            }
            if crop.width() < full {
                for plane in &mut planes {
                    for y in 0..rows {
                        let from = y * full + crop.left as usize;
                        plane.copy_within(from..from + crop.width(), y * crop.width());
                    }
                    plane.truncate(rows * crop.width());
                }
            }
            if let Some(grey) = grey {
                for y in 0..rows {
                    let range = y * crop.width()..(y + 1) * crop.width();
                    grey.add(planes.each_ref().map(|plane| &plane[range.clone()]));
                }
            }
            Ok(planes)
        };
        let mut spare: Vec<_> = self.spare.drain(..).map(Some).collect();
        spare.resize_with(self.readers.len(), || None);
        let mut greys: Vec<_> = self.greys.iter_mut().map(Some).collect();
        greys.resize_with(self.readers.len(), || None);
        let mut tallies: Vec<_> = self.tallies.iter_mut().map(Some).collect();
        tallies.resize_with(self.readers.len(), || None);
        let planes: Result<Vec<_>, MapError> = self
            .readers
            .par_iter_mut()
            .zip(spare)
            .zip(greys)
            .zip(tallies)
            .map(|(((reader, spare), grey), tally)| {
                let planes = read(reader, spare, grey)?;
                if let Some(tally) = tally {
                    let [r, g, b] = planes.each_ref().map(Vec::as_slice);
                    tally.add([r, g, b], reader.header().float);
                }
                Ok(planes)
            })
            .collect();
        let mut planes = planes?;
        let ambient = self.ambient.as_mut().map(|reader| read(reader, None, None));
        if let Some(ambient) = ambient.transpose()? {
            for photograph in &mut planes {
                for (plane, dark) in photograph.iter_mut().zip(&ambient) {
                    for (value, dark) in plane.iter_mut().zip(dark) {
                        *value -= dark;
                    }
                }
            }
        }
        let band = Band {
            top: self.done,
            step,
            rows,
            width: crop.width(),
            planes,
        };
        self.done += (rows * step).min(left);
        Ok(Some(band))
    }
}
