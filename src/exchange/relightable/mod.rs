//! Relightable images: a function of the light's direction for each pixel → albedo and normals.
//!
//! | format | where |
//! |---|---|
//! | `.ptm` of HP's fitter and RTIBuilder | [`ptm`] |
//! | `.rti` with hemispherical harmonics, of RTIBuilder's HSH fitter | [`hsh`] |
//! | Relight's `info.json` with its planes | [`relight`] |
//! | their functions of the light's direction | [`basis`] |
//! | function → normal and albedo of a pixel | [`solve`] |
//! | pixels → maps and a manifest | [`write`] |
//!
//! Directions are in the sheet's frame: x right, y up in the picture, z towards the camera. All of
//! these formats hold values as a display takes them, which are read as sRGB here.

mod basis;
mod hsh;
mod ptm;
mod relight;
mod solve;
mod write;

pub(super) use hsh::import as import_hsh;
pub(super) use ptm::import as import_ptm;
pub(super) use relight::import as import_relight;

use std::{
    fs::File,
    io::{Read as _, Seek as _, SeekFrom},
    path::{Path, PathBuf},
};

use super::{
    ExchangeError,
    error::{Faulty, whole_file},
};
use crate::{
    manifest::document::Words,
    maps::{MAX_SIDE, MapError},
};
use basis::Basis;

/// How coefficients make colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Colours {
    /// The function is one of luminance, for a colour that the last three planes hold.
    Luminance,
    /// Each term has a coefficient for red, green and blue, in this order.
    Each,
    /// Each plane is the coefficient of a vector of red, green and blue that depends on the
    /// light.
    Together,
}

/// A relightable image without its coefficients.
struct Relightable {
    /// Width and height in pixels.
    size: [usize; 2],
    basis: Basis,
    colours: Colours,
    /// Of each pixel.
    planes: usize,
}

/// The coefficients of an image, from its top.
trait Coefficients {
    /// Makes ready to read, with files for a while in `scratch` where they are needed.
    fn begin(&mut self, scratch: &Path) -> Result<(), ExchangeError> {
        let _ = scratch;
        Ok(())
    }

    /// Reads the next row into `row`: the planes of its first pixel, and so on. Luminance and
    /// colours are 1 at a display's white.
    fn next_row(&mut self, row: &mut [f64]) -> Result<(), ExchangeError>;
}

/// A file of rows of bytes behind a header.
struct ByteRows {
    path: PathBuf,
    file: File,
}

impl ByteRows {
    /// Opens a file that must have this many bytes; of a longer one some are left over.
    fn open(path: &Path, bytes: u64) -> Result<Self, ExchangeError> {
        /// Fitters end files with a line feed, or not.
        const SPARE: u64 = 64;
        let unreadable = |reason| MapError::Read {
            path: path.to_owned(),
            reason,
        };
        let file = File::open(path).map_err(unreadable)?;
        let length = file.metadata().map_err(unreadable)?.len();
        if (bytes..=bytes + SPARE).contains(&length) {
            let path = path.to_owned();
            return Ok(Self { path, file });
        }
        let allowed = format!("{bytes} bytes, as its header says");
        let remedy = match length < bytes {
            true => "it ends too early; copy or export it again",
            false => "its header and its data do not belong together; export it again",
        };
        let words = Words::new(format!("{length} bytes"), allowed, remedy);
        Err(whole_file(path, words))
    }

    fn read(&mut self, at: u64, bytes: &mut [u8]) -> Result<(), ExchangeError> {
        let seek = self.file.seek(SeekFrom::Start(at));
        let read = seek.and_then(|_| self.file.read_exact(bytes));
        read.map_err(|reason| {
            MapError::Read {
                path: self.path.clone(),
                reason,
            }
            .into()
        })
    }
}

/// The first bytes of a file, in which its header is.
fn head(path: &Path) -> Result<Vec<u8>, ExchangeError> {
    const LONGEST: u64 = 8192;
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(LONGEST).read_to_end(&mut bytes));
    read.map_err(|reason| MapError::Read {
        path: path.to_owned(),
        reason,
    })?;
    Ok(bytes)
}

/// Width and height of a header, each a side that a picture may have.
fn sides(size: [Option<&str>; 2], faulty: &mut Faulty<'_>) -> Option<[usize; 2]> {
    let mut side = |key: &str, found: Option<&str>| {
        let number = found.and_then(|text| text.parse::<u64>().ok());
        let number = number.filter(|number| (1..=u64::from(MAX_SIDE)).contains(number));
        if number.is_none() {
            faulty.fault(
                key,
                Words::new(
                    found.map_or("nothing".to_owned(), crate::manifest::quote),
                    format!("1 to {MAX_SIDE} pixels"),
                    "export it again, smaller if it is larger",
                ),
            );
        }
        number.map(|number| number as usize)
    };
    let [width, height] = [side("width", size[0]), side("height", size[1])];
    Some([width?, height?])
}
