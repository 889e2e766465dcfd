//! What a picture file is, without decoding its pixels.

use std::path::Path;

use super::{ColourEncoding, MapError, Missing, decode, linear::Linear};

/// What a picture's header says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Header {
    /// Width and height in pixels, each 1…[`super::MAX_SIDE`], after any EXIF orientation.
    pub size: [u32; 2],
    /// Channels as decoded: 1 grey, 2 grey with alpha, 3 RGB, 4 RGB with alpha. A palette counts
    /// as the colours it stands for.
    pub channels: u8,
    /// Bits per channel as decoded: 8, 16 or 32. Packed pixels of fewer bits become 8.
    pub bits: u8,
    /// True where channels are floating point.
    pub float: bool,
    /// Pixels per inch along x and y, where the file states a physical resolution.
    pub dpi: Option<[f64; 2]>,
    /// True where an ICC profile is embedded.
    pub icc: bool,
}

/// Reads a picture's header. The format is recognised by content, whatever the file's name.
///
/// # Errors
/// Any [`MapError`] but of writing: a file that cannot be read, of an unknown format, of a size
/// outside 1…[`super::MAX_SIDE`], of a kind that is not supported, or with a damaged header. A
/// good header says nothing about the body: see [`verify`].
pub fn probe(path: &Path) -> Result<Header, MapError> {
    Ok(decode::Picture::open(path)?.header())
}

/// Decodes the whole file and discards it, which finds truncated and damaged bodies. Returns the
/// pixels that are missing, which every loader fills.
///
/// # Errors
/// As [`probe`], and [`MapError::Damaged`].
pub fn verify(path: &Path) -> Result<Missing, MapError> {
    Ok(decode::read(path)?.missing)
}

/// Does the same for a map of colour, and finds colour profiles that cannot be used.
///
/// # Errors
/// As [`verify`], and [`MapError::Profile`].
pub fn verify_colour(path: &Path, encoding: ColourEncoding) -> Result<Missing, MapError> {
    let raster = decode::read(path)?;
    Linear::new(path, &raster, encoding)?;
    Ok(raster.missing)
}
