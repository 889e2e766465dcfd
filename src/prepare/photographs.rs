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
    photographs: Vec<Photograph>,
    ambient: Option<Photograph>,
    crop: Crop,
    /// Rows of the crop that have been read.
    done: usize,
    band_rows: usize,
    /// Of so many rows one is read.
    step: usize,
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
}

/// A photograph, and what is done with each of its rows as soon as it is read, while caches hold it.
struct Photograph {
    reader: ColourRows,
    /// Planes of a band that is done with: memory that is given back has to be cleared again.
    spare: [Vec<f32>; 3],
    /// Where it was asked for, as are the others.
    grey: Option<Grey>,
    tally: Option<Tally>,
    /// What it is divided by.
    field: Option<FlatField>,
}

/// Rows that are to be read.
#[derive(Clone, Copy)]
struct Wanted {
    crop: Crop,
    /// The first one, counted from the top of the crop.
    top: usize,
    rows: usize,
    /// From one to the next.
    step: usize,
}

impl Photograph {
    fn open(
        path: &Path,
        encoding: ColourEncoding,
        crop: Crop,
        scratch: &Path,
    ) -> Result<Self, StackError> {
        let reader = ColourRows::open(path, encoding, scratch)?;
        let [width, height] = reader.header().size;
        if width < crop.right || height < crop.bottom {
            return Err(StackError::Changed {
                path: path.to_owned(),
                found: format!("{width} × {height}"),
            });
        }
        Ok(Self {
            reader,
            spare: Default::default(),
            grey: None,
            tally: None,
            field: None,
        })
    }

    /// Planes of the next rows, less what `ambient` shows there.
    fn read(
        &mut self,
        wanted: Wanted,
        ambient: Option<&[Vec<f32>; 3]>,
    ) -> Result<[Vec<f32>; 3], MapError> {
        let Wanted {
            crop,
            top,
            rows,
            step,
        } = wanted;
        let header = self.reader.header();
        let (full, width) = (header.size[0] as usize, crop.width());
        let mut planes = std::mem::take(&mut self.spare);
        for plane in &mut planes {
            plane.resize(width * rows, 0.0);
        }
        let cut = width < full;
        let mut whole = [0, 1, 2].map(|_| vec![0.0; if cut { full } else { 0 }]);
        for row in 0..rows {
            let range = row * width..(row + 1) * width;
            let mut out = planes.each_mut().map(|plane| &mut plane[range.clone()]);
            if cut {
                self.reader.read(whole.each_mut().map(Vec::as_mut_slice))?;
                for (out, whole) in out.iter_mut().zip(&whole) {
                    out.copy_from_slice(&whole[crop.left as usize..][..width]);
                }
            } else {
                self.reader.read(out.each_mut().map(|plane| &mut **plane))?;
            }
            let y = top + row * step;
            // None are left beyond the lower edge of the crop.
            self.reader.skip((step - 1).min(crop.height() - 1 - y))?;
            if let Some(grey) = &mut self.grey {
                grey.add(out.each_ref().map(|plane| &**plane));
            }
            if let Some(tally) = &mut self.tally {
                tally.add(out.each_ref().map(|plane| &**plane), header.float);
            }
            if let Some(ambient) = ambient {
                for (plane, dark) in out.iter_mut().zip(ambient) {
                    for (value, dark) in plane.iter_mut().zip(&dark[range.clone()]) {
                        *value -= dark;
                    }
                }
            }
            if let Some(field) = &self.field {
                field.divide(y, out);
            }
        }
        Ok(planes)
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
        let open = |path: &Path| Photograph::open(path, encoding, crop, scratch);
        let mut photographs = Vec::with_capacity(paths.len());
        for path in paths {
            photographs.push(open(path)?);
        }
        let mut ambient = ambient.map(open).transpose()?;
        let full = photographs
            .first()
            .map_or(1, |first| first.reader.header().size[0]) as usize;
        let count = paths.len() + usize::from(ambient.is_some());
        let bytes = full * PIXEL_BYTES * count.max(1);
        let band_rows = match count {
            0 | 1 => SINGLE_BYTES / bytes,
            _ => (BAND_BYTES / bytes).max(BAND_ROWS).min(MOST_BYTES / bytes),
        };
        for photograph in photographs.iter_mut().chain(&mut ambient) {
            photograph.reader.skip(crop.top as usize)?;
        }
        Ok(Self {
            photographs,
            ambient,
            crop,
            done: 0,
            band_rows: band_rows.clamp(1, 512),
            step: 1,
        })
    }

    /// Whether any photograph holds floats, which have no level of clipping.
    pub fn is_float(&self) -> bool {
        let mut headers = self.photographs.iter().map(|of| of.reader.header());
        headers.any(|header| header.float)
    }

    /// Of so many rows (1 or more) one is read from now on, from the first one that is left. Not
    /// together with [`Self::reduce`], which needs all of them.
    pub fn thin(&mut self, step: usize) {
        self.step = step;
    }

    /// From now on, makes smaller what each photograph shows, its room's light included, as
    /// [`Self::greys`] gives it.
    pub fn reduce(&mut self, step: usize) {
        for photograph in &mut self.photographs {
            photograph.grey = Some(Grey::new(self.crop, step));
        }
    }

    /// The photographs made smaller, once all bands have been read; none without [`Self::reduce`].
    pub fn greys(&mut self) -> Vec<Grey> {
        let each = self.photographs.iter_mut();
        each.filter_map(|of| of.grey.take()).collect()
    }

    /// From now on, counts how much light each photograph holds.
    pub fn tally(&mut self) {
        for photograph in &mut self.photographs {
            photograph.tally = Some(Tally::default());
        }
    }

    /// How much light the photographs hold, as far as they have been read since [`Self::tally`], their room's
    /// included.
    pub fn tallies(&self) -> Vec<Tally> {
        self.photographs.iter().filter_map(|of| of.tally).collect()
    }

    /// From now on, divides each photograph that has one of `fields` by its lamp's light.
    pub fn divide(&mut self, fields: &[FlatField]) {
        for (photograph, field) in self.photographs.iter_mut().zip(fields) {
            photograph.field = Some(field.clone());
        }
    }

    /// Takes back a band that is done with, for its memory.
    pub fn recycle(&mut self, band: Band) {
        for (photograph, planes) in self.photographs.iter_mut().zip(band.planes) {
            photograph.spare = planes;
        }
    }

    /// The next band; `None` at the lower edge.
    ///
    /// # Errors
    /// Of the first photograph that breaks off, the one without lamps before all others.
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
        let wanted = Wanted {
            crop: self.crop,
            top: self.done,
            rows,
            step,
        };
        let ambient = self.ambient.as_mut().map(|of| of.read(wanted, None));
        let ambient = ambient.transpose()?;
        let planes: Result<Vec<_>, MapError> = self
            .photographs
            .par_iter_mut()
            .map(|of| of.read(wanted, ambient.as_ref()))
            .collect();
        let band = Band {
            top: self.done,
            step,
            rows,
            width: self.crop.width(),
            planes: planes?,
        };
        if let (Some(of), Some(planes)) = (&mut self.ambient, ambient) {
            of.spare = planes;
        }
        self.done += (rows * step).min(left);
        Ok(Some(band))
    }
}
