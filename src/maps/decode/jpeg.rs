//! JPEG: baseline and progressive, grey and RGB, 8 bits.

use std::{
    fs::File,
    io::{BufReader, Read, Seek, SeekFrom},
    path::{Path, PathBuf},
};

use zune_core::{
    bytestream::{ZByteReaderTrait, ZCursor},
    colorspace::ColorSpace,
    options::DecoderOptions,
};
use zune_jpeg::JpegDecoder;

use super::{
    Header, MAX_SIDE, MapError, Missing, Orientation, Raster, Samples, check_memory, check_size,
    exif,
};

pub(in super::super) struct JpegPicture {
    path: PathBuf,
    file: BufReader<File>,
    pub header: Header,
    pub orientation: Orientation,
}

impl JpegPicture {
    pub fn open(path: &Path, mut file: BufReader<File>) -> Result<Self, MapError> {
        let jfif = jfif_dpi(&mut file);
        file.rewind()
            .map_err(|source| MapError::read(path, source))?;
        let mut decoder = JpegDecoder::new_with_options(file, options());
        decoder
            .decode_headers()
            .map_err(|error| MapError::damaged(path, error))?;
        let channels = channels(path, &decoder)?;
        let (width, height) = decoder
            .dimensions()
            .ok_or_else(|| MapError::damaged(path, "it states no size"))?;
        let exif = decoder
            .exif()
            .map(|block| exif::read(block))
            .unwrap_or_default();
        let header = Header {
            size: check_size(path, width as u64, height as u64)?,
            channels,
            bits: 8,
            float: false,
            dpi: jfif.or(exif.dpi),
            icc: decoder.icc_profile().is_some(),
        };
        check_memory(path, &header)?;
        let file = BufReader::new(File::open(path).map_err(|source| MapError::read(path, source))?);
        Ok(Self {
            path: path.into(),
            file,
            header,
            orientation: exif.orientation,
        })
    }

    pub fn decode(mut self) -> Result<Raster, MapError> {
        let path = &self.path;
        let mut bytes = Vec::new();
        self.file
            .read_to_end(&mut bytes)
            .map_err(|source| MapError::read(path, source))?;
        if !is_complete(&bytes) {
            return Err(MapError::damaged(path, "it ends too early"));
        }
        let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes.as_slice()), options());
        decoder
            .decode_headers()
            .map_err(|error| MapError::damaged(path, error))?;
        let channels = channels(path, &decoder)?;
        let space = if channels == 1 {
            ColorSpace::Luma
        } else {
            ColorSpace::RGB
        };
        // Headers are read leniently, as every viewer does; damage to the body is an error and
        // not a grey area.
        decoder.set_options(
            options()
                .set_strict_mode(true)
                .jpeg_set_out_colorspace(space),
        );
        let samples = decoder
            .decode()
            .map_err(|error| MapError::damaged(path, error))?;
        let [width, height] = self.header.size.map(|v| v as usize);
        // The file may have been replaced since its header was read.
        if samples.len() != width * height * usize::from(channels) {
            return Err(MapError::damaged(path, "it changed while it was read"));
        }
        Ok(Raster {
            width,
            height,
            channels: channels.into(),
            samples: Samples::U8(samples),
            premultiplied: false,
            icc: decoder.icc_profile(),
            missing: Missing::default(),
        })
    }
}

/// True where the last scan is followed by the end of the picture. The decoder does not miss the
/// end of a scan that breaks off in its last rows. Compressed data never look like a marker.
fn is_complete(bytes: &[u8]) -> bool {
    let last = |marker: u8| bytes.windows(2).rposition(|pair| pair == [0xff, marker]);
    last(0xd9) > last(0xda)
}

fn options() -> DecoderOptions {
    DecoderOptions::default()
        .set_strict_mode(false)
        .set_max_width(MAX_SIDE as usize)
        .set_max_height(MAX_SIDE as usize)
}

fn channels<T: ZByteReaderTrait>(path: &Path, decoder: &JpegDecoder<T>) -> Result<u8, MapError> {
    match decoder.input_colorspace() {
        Some(ColorSpace::Luma) => Ok(1),
        Some(ColorSpace::YCbCr | ColorSpace::RGB) => Ok(3),
        Some(ColorSpace::CMYK | ColorSpace::YCCK) => Err(MapError::unsupported(
            path,
            "holds CMYK colours",
            "convert it to RGB",
        )),
        other => Err(MapError::unsupported(
            path,
            format!("holds an unknown kind of colour ({other:?})"),
            "convert it to grey or RGB",
        )),
    }
}

/// The resolution of the JFIF segment, which the decoder skips. `None` where there is none.
fn jfif_dpi(file: &mut (impl Read + Seek)) -> Option<[f64; 2]> {
    let mut start = [0; 2];
    file.read_exact(&mut start).ok()?;
    loop {
        let mut segment = [0; 4];
        file.read_exact(&mut segment).ok()?;
        let [0xff, marker, high, low] = segment else {
            return None;
        };
        let length = u16::from_be_bytes([high, low]).checked_sub(2)?;
        if marker == 0xe0 && length >= 12 {
            let mut body = [0; 12];
            file.read_exact(&mut body).ok()?;
            if let [b'J', b'F', b'I', b'F', 0, _, _, unit, x0, x1, y0, y1] = body {
                let [x, y] = [[x0, x1], [y0, y1]].map(|v| f64::from(u16::from_be_bytes(v)));
                // Units as in TIFF, one less: 1 inch, 2 centimetre.
                return exif::dpi_of(u64::from(unit) + 1, Some(x), Some(y));
            }
            file.seek(SeekFrom::Current(i64::from(length) - 12)).ok()?;
        } else if marker == 0xda {
            return None;
        } else {
            file.seek(SeekFrom::Current(length.into())).ok()?;
        }
    }
}
