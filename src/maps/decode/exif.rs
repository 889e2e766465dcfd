//! The few EXIF entries that decide how a picture lies and how large it is.

use super::{super::Header, Raster, Samples, plausible_dpi};

/// How the stored rows lie on the upright picture, as EXIF and TIFF number it (1…8).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) struct Orientation(u8);

impl Default for Orientation {
    fn default() -> Self {
        Self(1)
    }
}

impl Orientation {
    /// From an EXIF or TIFF tag; values outside 1…8 mean upright.
    pub fn from_tag(value: u64) -> Self {
        if (1..=8).contains(&value) {
            Self(value as u8)
        } else {
            Self::default()
        }
    }

    /// Rows and columns are exchanged.
    fn transposed(self) -> bool {
        self.0 >= 5
    }

    pub fn of_header(self, header: Header) -> Header {
        let [width, height] = header.size;
        if !self.transposed() {
            return header;
        }
        Header {
            size: [height, width],
            dpi: header.dpi.map(|[x, y]| [y, x]),
            ..header
        }
    }

    pub fn of_raster(self, raster: Raster) -> Raster {
        if self == Self::default() {
            return raster;
        }
        let (w, h, channels) = (raster.width, raster.height, raster.channels);
        let (width, height) = if self.transposed() { (h, w) } else { (w, h) };
        let samples = match raster.samples {
            Samples::U8(v) => Samples::U8(self.turn(&v, w, h, channels)),
            Samples::U16(v) => Samples::U16(self.turn(&v, w, h, channels)),
            Samples::F32(v) => Samples::F32(self.turn(&v, w, h, channels)),
        };
        Raster {
            width,
            height,
            samples,
            ..raster
        }
    }

    fn turn<T: Copy>(self, stored: &[T], w: usize, h: usize, channels: usize) -> Vec<T> {
        let (width, height) = if self.transposed() { (h, w) } else { (w, h) };
        let mut upright = Vec::with_capacity(stored.len());
        for y in 0..height {
            for x in 0..width {
                // Column and row of the stored picture (EXIF 2.32, tag 0x0112).
                let (column, row) = match self.0 {
                    2 => (w - 1 - x, y),
                    3 => (w - 1 - x, h - 1 - y),
                    4 => (x, h - 1 - y),
                    5 => (y, x),
                    6 => (y, h - 1 - x),
                    7 => (w - 1 - y, h - 1 - x),
                    8 => (w - 1 - y, x),
                    _ => (x, y),
                };
                let start = (row * w + column) * channels;
                upright.extend_from_slice(&stored[start..start + channels]);
            }
        }
        upright
    }
}

/// What EXIF says about a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Exif {
    pub orientation: Orientation,
    pub dpi: Option<[f64; 2]>,
}

/// Reads the first directory of an EXIF block (TIFF structure, with or without the `Exif\0\0`
/// prefix). A damaged block counts as absent: it is no part of the picture.
pub(super) fn read(block: &[u8]) -> Exif {
    parse(block.strip_prefix(b"Exif\0\0").unwrap_or(block)).unwrap_or_default()
}

fn parse(block: &[u8]) -> Option<Exif> {
    let little = match block.get(..4)? {
        b"II*\0" => true,
        b"MM\0*" => false,
        _ => return None,
    };
    let short = |at: usize| {
        let bytes = block.get(at..at.checked_add(2)?)?.try_into().ok()?;
        Some(if little {
            u16::from_le_bytes(bytes)
        } else {
            u16::from_be_bytes(bytes)
        })
    };
    let long = |at: usize| {
        let bytes = block.get(at..at.checked_add(4)?)?.try_into().ok()?;
        Some(if little {
            u32::from_le_bytes(bytes)
        } else {
            u32::from_be_bytes(bytes)
        })
    };
    let rational = |at: usize| {
        let at = long(at)? as usize;
        Some(f64::from(long(at)?) / f64::from(long(at.checked_add(4)?)?))
    };
    let directory = long(4)? as usize;
    let (mut orientation, mut x, mut y, mut unit) = (Orientation::default(), None, None, 2);
    for entry in 0..usize::from(short(directory)?) {
        let at = directory.checked_add(2 + 12 * entry)?;
        let value = at.checked_add(8)?;
        match short(at)? {
            0x0112 => orientation = Orientation::from_tag(short(value)?.into()),
            0x011a => x = rational(value),
            0x011b => y = rational(value),
            0x0128 => unit = short(value)?,
            _ => {}
        }
    }
    Some(Exif {
        orientation,
        dpi: dpi_of(unit.into(), x, y),
    })
}

/// Dots per inch from TIFF's ResolutionUnit (2 inch, 3 centimetre) and its two resolutions.
pub(super) fn dpi_of(unit: u64, x: Option<f64>, y: Option<f64>) -> Option<[f64; 2]> {
    let per_inch = match unit {
        2 => 1.0,
        3 => 2.54,
        _ => return None,
    };
    plausible_dpi(x? * per_inch, y? * per_inch)
}
