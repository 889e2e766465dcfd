//! Files → rasters at their full depth.

mod exif;
mod exr;
mod jpeg;
mod png;
mod rows;
mod tiff;

use std::{
    fs::File,
    io::{BufReader, ErrorKind, Read, Seek},
    path::Path,
};

use super::{Header, MAX_SIDE, MapError, Missing};
pub(super) use exif::Orientation;
pub(super) use rows::RowSource;

/// The most memory that one decoded picture may take, in bytes.
const MAX_BYTES: u64 = 2 << 30;

/// A decoded picture.
pub(super) struct Raster {
    pub width: usize,
    pub height: usize,
    /// 1 grey, 2 grey and alpha, 3 RGB, 4 RGB and alpha; interleaved.
    pub channels: usize,
    pub samples: Samples,
    /// Colour is multiplied by alpha already (only where there is alpha).
    pub premultiplied: bool,
    /// The embedded ICC profile.
    pub icc: Option<Vec<u8>>,
    /// Pixels in which a value was NaN or infinite.
    pub missing: Missing,
}

/// Channel values; floats are finite once the picture is decoded.
pub(super) enum Samples {
    U8(Vec<u8>),
    U16(Vec<u16>),
    F32(Vec<f32>),
}

/// The type of channel values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    U8,
    U16,
    F32,
}

impl Kind {
    /// Of one value.
    fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 => 2,
            Self::F32 => 4,
        }
    }
}

impl Samples {
    pub fn kind(&self) -> Kind {
        match self {
            Self::U8(_) => Kind::U8,
            Self::U16(_) => Kind::U16,
            Self::F32(_) => Kind::F32,
        }
    }
}

/// A channel value of any type.
pub(super) trait Sample: Copy + Send + Sync {
    /// Its number among all values of the type; floats have too many.
    fn code(self) -> Option<usize>;
    /// Integers as 0…1, floats as they are.
    fn unit(self) -> f32;
}

impl Sample for u8 {
    fn code(self) -> Option<usize> {
        Some(self.into())
    }
    fn unit(self) -> f32 {
        f32::from(self) / 255.0
    }
}

impl Sample for u16 {
    fn code(self) -> Option<usize> {
        Some(self.into())
    }
    fn unit(self) -> f32 {
        f32::from(self) / 65535.0
    }
}

impl Sample for f32 {
    fn code(self) -> Option<usize> {
        None
    }
    fn unit(self) -> f32 {
        self
    }
}

impl Raster {
    /// Calls `each` with the values of every pixel of row `y` in turn: its channels in 0…1 for
    /// integers, as they are for floats. Absent channels are 0.
    pub fn for_each_in_row(&self, y: usize, mut each: impl FnMut(usize, [f32; 4])) {
        fn run<T: Sample>(row: &[T], channels: usize, each: &mut impl FnMut(usize, [f32; 4])) {
            for (x, pixel) in row.chunks_exact(channels).enumerate() {
                let mut values = [0.0; 4];
                for (value, sample) in values.iter_mut().zip(pixel) {
                    *value = sample.unit();
                }
                each(x, values);
            }
        }
        let stride = self.width * self.channels;
        let range = y * stride..(y + 1) * stride;
        match &self.samples {
            Samples::U8(v) => run(&v[range], self.channels, &mut each),
            Samples::U16(v) => run(&v[range], self.channels, &mut each),
            Samples::F32(v) => run(&v[range], self.channels, &mut each),
        }
    }

    /// The alpha of a pixel, 0…1; 1 where the picture has none.
    pub fn alpha(&self, pixel: [f32; 4]) -> f32 {
        match self.channels {
            2 | 4 => pixel[self.channels - 1].clamp(0.0, 1.0),
            _ => 1.0,
        }
    }

    /// Divides colour by alpha where the file has multiplied it; wholly transparent pixels stay
    /// as they are.
    pub fn unmultiply(&mut self) {
        fn run<T: Copy + Default + PartialOrd>(
            values: &mut [T],
            channels: usize,
            divide: impl Fn(T, T) -> T,
        ) {
            for pixel in values.chunks_exact_mut(channels) {
                if let [colours @ .., alpha] = pixel
                    && *alpha > T::default()
                {
                    for value in colours {
                        *value = divide(*value, *alpha);
                    }
                }
            }
        }
        if !std::mem::take(&mut self.premultiplied) || !self.channels.is_multiple_of(2) {
            return;
        }
        let ratio = |value: f64, alpha: f64| value / alpha;
        // Casts to integers saturate.
        match &mut self.samples {
            Samples::U8(v) => run(v, self.channels, |v, a| {
                (ratio(v.into(), a.into()) * 255.0).round() as u8
            }),
            Samples::U16(v) => run(v, self.channels, |v, a| {
                (ratio(v.into(), a.into()) * 65535.0).round() as u16
            }),
            Samples::F32(v) => run(v, self.channels, |v, a| {
                ratio(v.into(), a.into()).clamp(f32::MIN.into(), f32::MAX.into()) as f32
            }),
        }
    }

    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }
}

/// A picture file, opened and its header read.
pub(super) enum Picture {
    Png(Box<png::PngPicture>),
    Jpeg(jpeg::JpegPicture),
    Tiff(Box<tiff::TiffPicture>),
    Exr(exr::ExrPicture),
}

impl Picture {
    pub fn open(path: &Path) -> Result<Self, MapError> {
        let read_error = |source| MapError::read(path, source);
        // Opening a folder succeeds on Unix and reading it then fails with a less clear word.
        let mut file = File::open(path).map_err(read_error)?;
        if file.metadata().map_err(read_error)?.is_dir() {
            return Err(read_error(ErrorKind::IsADirectory.into()));
        }
        let mut magic = [0; 8];
        let mut length = 0;
        while length < magic.len() {
            match file.read(&mut magic[length..]).map_err(read_error)? {
                0 => break,
                n => length += n,
            }
        }
        file.rewind().map_err(read_error)?;
        let file = BufReader::with_capacity(1 << 16, file);
        match &magic[..length] {
            b"\x89PNG\r\n\x1a\n" => {
                png::PngPicture::open(path, file).map(|picture| Self::Png(Box::new(picture)))
            }
            [0xff, 0xd8, 0xff, ..] => jpeg::JpegPicture::open(path, file).map(Self::Jpeg),
            [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => {
                tiff::TiffPicture::open(path, file).map(|picture| Self::Tiff(Box::new(picture)))
            }
            [0x76, 0x2f, 0x31, 0x01, ..] => exr::ExrPicture::open(path, file).map(Self::Exr),
            _ => Err(MapError::UnknownFormat { path: path.into() }),
        }
    }

    pub fn header(&self) -> Header {
        let (header, orientation) = match self {
            Self::Png(picture) => (picture.header, picture.orientation),
            Self::Jpeg(picture) => (picture.header, picture.orientation),
            Self::Tiff(picture) => (picture.header, picture.orientation),
            Self::Exr(picture) => (picture.header, Orientation::default()),
        };
        orientation.of_header(header)
    }

    /// The upright picture, its missing pixels filled.
    fn decode(self) -> Result<Raster, MapError> {
        let mut raster = match self {
            Self::Png(picture) => {
                let orientation = picture.orientation;
                orientation.of_raster(picture.decode()?)
            }
            Self::Jpeg(picture) => {
                let orientation = picture.orientation;
                orientation.of_raster(picture.decode()?)
            }
            Self::Tiff(picture) => {
                let orientation = picture.orientation;
                orientation.of_raster(picture.decode()?)
            }
            Self::Exr(picture) => picture.decode()?,
        };
        if let Samples::F32(values) = &mut raster.samples {
            raster.missing = Missing::fill(values, raster.width, raster.channels);
        }
        Ok(raster)
    }
}

/// The upright picture of a file, its missing pixels filled.
///
/// # Errors
/// Whatever [`MapError`] says of files, and a picture in which no pixel is a number.
pub fn read(path: &Path) -> Result<Raster, MapError> {
    let raster = Picture::open(path)?.decode()?;
    if raster.missing.count == (raster.width * raster.height) as u64 {
        return Err(MapError::damaged(path, "none of its pixels is a number"));
    }
    Ok(raster)
}

/// Refuses sizes that no texture can have, before anything is allocated.
fn check_size(path: &Path, width: u64, height: u64) -> Result<[u32; 2], MapError> {
    let allowed = 1..=u64::from(MAX_SIDE);
    if allowed.contains(&width) && allowed.contains(&height) {
        return Ok([width as u32, height as u32]);
    }
    Err(MapError::Size {
        path: path.into(),
        width,
        height,
    })
}

/// Refuses pictures that would not fit in memory once decoded, before anything is allocated.
fn check_memory(path: &Path, header: &Header) -> Result<(), MapError> {
    let [width, height] = header.size.map(u64::from);
    let bytes = width * height * u64::from(header.channels) * u64::from(header.bits / 8);
    if bytes <= MAX_BYTES {
        return Ok(());
    }
    let gib = bytes as f64 / f64::from(1 << 30);
    Err(MapError::unsupported(
        path,
        format!("takes {gib:.1} GiB once decoded"),
        "2 GiB are allowed: resample it, or save it with fewer bits or channels",
    ))
}

/// A resolution that means something: files without one often say 0 or 1.
fn plausible_dpi(x: f64, y: f64) -> Option<[f64; 2]> {
    let plausible = |v: f64| v.is_finite() && v > 1.0;
    (plausible(x) && plausible(y)).then_some([x, y])
}
