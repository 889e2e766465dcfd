//! Pixels → files, each written whole or not at all and with the same bytes for the same input.

use std::{
    cell::Cell,
    fs::File,
    io::{self, BufWriter, Write},
    path::Path,
};

use exr::{
    image::{Encoding, Image, SpecificChannels, write::WritableImage},
    math::Vec2,
    meta::attribute::{Chromaticities, LineOrder},
    prelude::{ImageAttributes, Layer, LayerAttributes},
};
use png::{BitDepth, ColorType, Compression, Filter, PixelDimensions, Unit};

use super::MapError;
use crate::colour::{D65, SRGB_PRIMARIES};

/// Writes `path` through `fill` into a file beside it that then takes its name, so that a reader
/// sees the old file or the whole new one. The folder must exist.
///
/// # Errors
/// [`MapError::Write`]; nothing is left behind.
pub fn write_whole(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<Kept<'_>>) -> io::Result<()>,
) -> Result<(), MapError> {
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let failed = Cell::new(None);
    let write = || -> io::Result<()> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".recto-");
        // The default is readable by its owner only; this one obeys the umask.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = builder.tempfile_in(folder)?;
        let kept = Kept {
            file: file.as_file(),
            failed: &failed,
        };
        let mut writer = BufWriter::with_capacity(1 << 18, kept);
        fill(&mut writer)?;
        writer.flush()?;
        drop(writer);
        file.as_file().sync_all()?;
        file.persist(path)?;
        Ok(())
    };
    write().map_err(|source| {
        let first = failed.get().map(io::Error::from_raw_os_error);
        MapError::write(path, first.unwrap_or(source))
    })
}

/// A file that keeps the system's first error in writing it: encoders pass on no more than its
/// words.
pub struct Kept<'f> {
    file: &'f File,
    failed: &'f Cell<Option<i32>>,
}

impl Kept<'_> {
    fn keep<T>(&self, result: io::Result<T>) -> io::Result<T> {
        if let Err(error) = &result
            && self.failed.get().is_none()
            && error.kind() != io::ErrorKind::Interrupted
        {
            self.failed.set(error.raw_os_error());
        }
        result
    }
}

impl Write for Kept<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes);
        self.keep(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        let flushed = self.file.flush();
        self.keep(flushed)
    }
}

/// Writes an 8-bit grey PNG of `width * height` pixels; `dpi` is stored where given.
///
/// # Errors
/// [`MapError::Write`], also where the number of pixels does not fit the size.
pub fn save_png_grey8(
    path: &Path,
    width: u32,
    height: u32,
    pixels: &[u8],
    dpi: Option<f64>,
) -> Result<(), MapError> {
    save_png8(path, [width, height], ColorType::Grayscale, pixels, dpi)
}

/// Writes a 16-bit grey PNG; as [`save_png_grey8`].
///
/// # Errors
/// As [`save_png_grey8`].
pub fn save_png_grey16(
    path: &Path,
    width: u32,
    height: u32,
    pixels: &[u16],
    dpi: Option<f64>,
) -> Result<(), MapError> {
    save_png16(path, [width, height], ColorType::Grayscale, pixels, dpi)
}

/// Writes an 8-bit RGB PNG without profile (read as sRGB); as [`save_png_grey8`].
///
/// # Errors
/// As [`save_png_grey8`].
pub fn save_png_rgb8(
    path: &Path,
    width: u32,
    height: u32,
    pixels: &[[u8; 3]],
    dpi: Option<f64>,
) -> Result<(), MapError> {
    save_png8(
        path,
        [width, height],
        ColorType::Rgb,
        pixels.as_flattened(),
        dpi,
    )
}

/// Writes a 16-bit RGB PNG without profile (read as sRGB); as [`save_png_grey8`].
///
/// # Errors
/// As [`save_png_grey8`].
pub fn save_png_rgb16(
    path: &Path,
    width: u32,
    height: u32,
    pixels: &[[u16; 3]],
    dpi: Option<f64>,
) -> Result<(), MapError> {
    save_png16(
        path,
        [width, height],
        ColorType::Rgb,
        pixels.as_flattened(),
        dpi,
    )
}

/// Writes an 8-bit RGBA PNG with straight alpha; as [`save_png_rgb8`].
///
/// # Errors
/// As [`save_png_grey8`].
pub fn save_png_rgba8(
    path: &Path,
    width: u32,
    height: u32,
    pixels: &[[u8; 4]],
    dpi: Option<f64>,
) -> Result<(), MapError> {
    save_png8(
        path,
        [width, height],
        ColorType::Rgba,
        pixels.as_flattened(),
        dpi,
    )
}

/// Writes linear RGB as a 32-bit float OpenEXR file with the chromaticities of Rec. 709, values
/// untouched.
///
/// # Errors
/// As [`save_png_grey8`].
pub fn save_exr_rgb(
    path: &Path,
    width: u32,
    height: u32,
    pixels: &[[f32; 3]],
) -> Result<(), MapError> {
    check_length([width, height], 1, pixels.len())
        .map_err(|source| MapError::write(path, source))?;
    let size = Vec2(width as usize, height as usize);
    let channels = SpecificChannels::rgb(|at: Vec2<usize>| {
        let [r, g, b] = pixels[at.y() * size.x() + at.x()];
        (r, g, b)
    });
    // Blocks are compressed in parallel: only an increasing order makes the bytes repeatable.
    let encoding = Encoding {
        line_order: LineOrder::Increasing,
        ..Encoding::SMALL_LOSSLESS
    };
    let layer = Layer::new(size, LayerAttributes::default(), encoding, channels);
    let [red, green, blue] = SRGB_PRIMARIES.map(chromaticity);
    let chromaticities = Chromaticities {
        red,
        green,
        blue,
        white: chromaticity(D65),
    };
    let mut attributes = ImageAttributes::with_size(size);
    attributes.chromaticities = Some(chromaticities);
    let image = Image::empty(attributes).with_layer(layer);
    write_whole(path, |writer| {
        // OpenEXR's offset table is written last, so the writer must seek.
        let mut bytes = io::Cursor::new(Vec::new());
        image
            .write()
            .to_buffered(&mut bytes)
            .map_err(io::Error::other)?;
        writer.write_all(bytes.get_ref())
    })
}

fn chromaticity(xy: [f64; 2]) -> Vec2<f32> {
    Vec2(xy[0] as f32, xy[1] as f32)
}

fn save_png8(
    path: &Path,
    size: [u32; 2],
    colour: ColorType,
    samples: &[u8],
    dpi: Option<f64>,
) -> Result<(), MapError> {
    save_png(
        path,
        size,
        colour,
        BitDepth::Eight,
        samples.len(),
        dpi,
        |out| out.write_all(samples),
    )
}

fn save_png16(
    path: &Path,
    size: [u32; 2],
    colour: ColorType,
    samples: &[u16],
    dpi: Option<f64>,
) -> Result<(), MapError> {
    const CHUNK: usize = 1 << 15;
    save_png(
        path,
        size,
        colour,
        BitDepth::Sixteen,
        samples.len(),
        dpi,
        |out| {
            let mut bytes = vec![[0; 2]; CHUNK];
            for chunk in samples.chunks(CHUNK) {
                for (bytes, sample) in bytes.iter_mut().zip(chunk) {
                    *bytes = sample.to_be_bytes();
                }
                out.write_all(bytes[..chunk.len()].as_flattened())?;
            }
            Ok(())
        },
    )
}

fn save_png(
    path: &Path,
    [width, height]: [u32; 2],
    colour: ColorType,
    depth: BitDepth,
    samples: usize,
    dpi: Option<f64>,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), MapError> {
    check_length([width, height], colour.samples(), samples)
        .map_err(|source| MapError::write(path, source))?;
    write_whole(path, |writer| {
        let mut encoder = png::Encoder::new(writer, width, height);
        encoder.set_color(colour);
        encoder.set_depth(depth);
        encoder.set_compression(Compression::Fast);
        if depth == BitDepth::Sixteen {
            // To try all filters for each row takes longer than all the rest, and makes albedo,
            // normals and heights smaller by 3 % at most (measured on the sample's).
            encoder.set_filter(Filter::Avg);
        }
        encoder.set_pixel_dims(dpi.map(|dpi| {
            let per_metre = (dpi / 0.0254).round() as u32;
            PixelDimensions {
                xppu: per_metre,
                yppu: per_metre,
                unit: Unit::Meter,
            }
        }));
        let mut header = encoder.write_header()?;
        let mut stream = header.stream_writer()?;
        fill(&mut stream)?;
        stream.finish()?;
        header.finish()?;
        Ok(())
    })
}

fn check_length([width, height]: [u32; 2], channels: usize, found: usize) -> io::Result<()> {
    let expected = width as usize * height as usize * channels;
    if found == expected && expected > 0 {
        return Ok(());
    }
    Err(io::Error::new(
        io::ErrorKind::InvalidInput,
        format!("{width} × {height} pixels need {expected} values, not {found}"),
    ))
}
