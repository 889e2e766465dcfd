//! TIFF and BigTIFF: strips and tiles, chunky and planar, grey and RGB with or without alpha,
//! 8 and 16 bit integers, half, single and double floats; packed greys of 1, 2 and 4 bits.

use std::{
    fs::File,
    io::BufReader,
    path::{Path, PathBuf},
};

use tiff::{
    ColorType, TiffError,
    decoder::{ChunkType, Decoder, DecodingResult, Limits, ifd::Value},
    tags::{PlanarConfiguration, Tag},
};

use super::{
    Header, MAX_BYTES, MapError, Missing, Orientation, Raster, Samples, check_memory, check_size,
    exif,
};

pub(in super::super) struct TiffPicture {
    path: PathBuf,
    decoder: Decoder<BufReader<File>>,
    /// Bits per channel in the file.
    stored_bits: u8,
    planar: bool,
    premultiplied: bool,
    icc: Option<Vec<u8>>,
    pub header: Header,
    pub orientation: Orientation,
}

const SAVE_AS: &str = "save it as grey or RGB with 8 or 16 bits, or as 32-bit float";

impl TiffPicture {
    pub fn open(path: &Path, file: BufReader<File>) -> Result<Self, MapError> {
        let refused = |error| refused(path, error);
        let mut limits = Limits::default();
        limits.decoding_buffer_size = MAX_BYTES as usize;
        limits.intermediate_buffer_size = MAX_BYTES as usize;
        // An ICC profile with tables can take a few megabytes.
        limits.ifd_value_size = 16 << 20;
        let mut decoder = Decoder::new(file).map_err(refused)?.with_limits(limits);
        let (width, height) = decoder.dimensions().map_err(refused)?;
        let size = check_size(path, width.into(), height.into())?;
        let photometric =
            unsigned_tag(&mut decoder, Tag::PhotometricInterpretation).map_err(refused)?;
        // TIFF 6.0, section 22 and the registered extensions.
        let foreign = match photometric {
            Some(3) => Some("a palette"),
            Some(5) => Some("CMYK colours"),
            Some(6) => Some("YCbCr colours"),
            Some(8..=10) => Some("Lab colours"),
            Some(32844 | 32845) => Some("LogLuv colours"),
            _ => None,
        };
        if let Some(colours) = foreign {
            let found = format!("holds {colours}");
            return Err(MapError::unsupported(
                path,
                found,
                "convert it to grey or RGB",
            ));
        }
        let (channels, stored_bits) = match decoder.colortype().map_err(refused)? {
            ColorType::Gray(bits) => (1, bits),
            ColorType::GrayA(bits)
            | ColorType::Multiband {
                bit_depth: bits,
                num_samples: 2,
            } => (2, bits),
            ColorType::RGB(bits) => (3, bits),
            ColorType::RGBA(bits) => (4, bits),
            other => {
                let found = format!("holds {} channels", other.num_samples());
                return Err(MapError::unsupported(path, found, "save it as grey or RGB"));
            }
        };
        let format = unsigned_tag(&mut decoder, Tag::SampleFormat)
            .map_err(refused)?
            .unwrap_or(1);
        let (bits, float) = match (format, stored_bits) {
            (1 | 4, 1 | 2 | 4) if channels == 1 => (8, false),
            (1 | 4, 8 | 16) => (stored_bits, false),
            (3, 16) => (16, true),
            (3, 32 | 64) => (32, true),
            _ => {
                let kind = match format {
                    2 => "signed integers",
                    3 => "floats",
                    5 | 6 => "complex numbers",
                    _ => "unsigned integers",
                };
                let found = format!("holds {kind} of {stored_bits} bits per channel");
                return Err(MapError::unsupported(path, found, SAVE_AS));
            }
        };
        let planar = unsigned_tag(&mut decoder, Tag::PlanarConfiguration).map_err(refused)?
            == Some(PlanarConfiguration::Planar.to_u16().into());
        let extra = unsigned_tag(&mut decoder, Tag::ExtraSamples).map_err(refused)?;
        let orientation = unsigned_tag(&mut decoder, Tag::Orientation).map_err(refused)?;
        let unit = unsigned_tag(&mut decoder, Tag::ResolutionUnit).map_err(refused)?;
        let x = rational_tag(&mut decoder, Tag::XResolution);
        let y = rational_tag(&mut decoder, Tag::YResolution);
        let icc = decoder
            .find_tag(Tag::IccProfile)
            .and_then(|tag| tag.map(Value::into_u8_vec).transpose())
            .map_err(refused)?;
        let header = Header {
            size,
            channels,
            bits,
            float,
            dpi: exif::dpi_of(unit.unwrap_or(2), x, y),
            icc: icc.is_some(),
        };
        check_memory(path, &header)?;
        Ok(Self {
            path: path.into(),
            decoder,
            stored_bits,
            planar: planar && channels > 1,
            premultiplied: extra == Some(1),
            icc,
            header,
            orientation: Orientation::from_tag(orientation.unwrap_or(1)),
        })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether whole rows of integers come strip after strip, upright, none of them too large to
    /// hold many at once.
    pub fn is_streamed(&self) -> bool {
        /// Of one strip.
        const MOST_BYTES: u64 = 16 << 20;
        let (width, height) = self.decoder.chunk_dimensions();
        let pixel = u64::from(self.header.channels) * u64::from(self.header.bits / 8);
        // A file may say anything of its strips.
        let bytes = (u64::from(width) * u64::from(height)).checked_mul(pixel);
        !self.planar
            && !self.header.float
            && !self.premultiplied
            && self.stored_bits >= 8
            && width == self.header.size[0]
            && bytes.is_some_and(|bytes| bytes <= MOST_BYTES)
            && self.decoder.get_chunk_type() == ChunkType::Strip
            && self.orientation == Orientation::default()
    }

    /// The embedded ICC profile.
    pub fn icc(&self) -> Option<Vec<u8>> {
        self.icc.clone()
    }

    /// How many rows a strip has, but for the last one, which may have fewer.
    pub fn strip_rows(&self) -> u32 {
        self.decoder.chunk_dimensions().1
    }

    /// The samples of a strip, counted from 0.
    pub fn strip(&mut self, index: u32) -> Result<Samples, MapError> {
        let path = &self.path;
        let read = self.decoder.read_chunk(index);
        match read.map_err(|error| refused(path, error))? {
            DecodingResult::U8(v) => Ok(Samples::U8(v)),
            DecodingResult::U16(v) => Ok(Samples::U16(v)),
            _ => Err(MapError::damaged(
                path,
                "its channels contradict its header",
            )),
        }
    }

    pub fn decode(mut self) -> Result<Raster, MapError> {
        let path = &self.path;
        let mut result = DecodingResult::U8(Vec::new());
        self.decoder
            .read_image_to_buffer(&mut result)
            .map_err(|error| refused(path, error))?;
        let [width, height] = self.header.size.map(|v| v as usize);
        let channels = usize::from(self.header.channels);
        let samples = match result {
            DecodingResult::U8(v) if self.stored_bits < 8 => {
                Samples::U8(unpack(&v, width, self.stored_bits))
            }
            DecodingResult::U8(v) => Samples::U8(self.chunky(v)),
            DecodingResult::U16(v) => Samples::U16(self.chunky(v)),
            DecodingResult::F16(v) => {
                Samples::F32(self.chunky(v.into_iter().map(f32::from).collect()))
            }
            DecodingResult::F32(v) => Samples::F32(self.chunky(v)),
            DecodingResult::F64(v) => {
                Samples::F32(self.chunky(v.into_iter().map(|v| v as f32).collect()))
            }
            _ => {
                return Err(MapError::damaged(
                    path,
                    "its channels contradict its header",
                ));
            }
        };
        let length = match &samples {
            Samples::U8(v) => v.len(),
            Samples::U16(v) => v.len(),
            Samples::F32(v) => v.len(),
        };
        if length != width * height * channels {
            return Err(MapError::damaged(
                path,
                "its channels contradict its header",
            ));
        }
        Ok(Raster {
            width,
            height,
            channels,
            samples,
            premultiplied: self.premultiplied,
            icc: self.icc,
            missing: Missing::default(),
        })
    }

    /// Interleaves planes that lie one after another.
    fn chunky<T: Copy>(&self, values: Vec<T>) -> Vec<T> {
        let channels = usize::from(self.header.channels);
        if !self.planar || !values.len().is_multiple_of(channels) {
            return values;
        }
        let plane = values.len() / channels;
        (0..values.len())
            .map(|i| values[i % channels * plane + i / channels])
            .collect()
    }
}

/// Greys of 1, 2 or 4 bits, rows padded to bytes, spread over 0…255.
fn unpack(packed: &[u8], width: usize, bits: u8) -> Vec<u8> {
    let per_byte = 8 / usize::from(bits);
    let scale = 255 / ((1u16 << bits) - 1) as u8;
    let mask = u8::MAX >> (8 - bits);
    let value = |row: &[u8], x: usize| {
        let shift = 8 - bits * (x % per_byte + 1) as u8;
        (row[x / per_byte] >> shift & mask) * scale
    };
    packed
        .chunks_exact(width.div_ceil(per_byte))
        .flat_map(|row| (0..width).map(move |x| value(row, x)))
        .collect()
}

/// The first value of a tag; one that is not an unsigned number counts as absent.
fn unsigned_tag(
    decoder: &mut Decoder<BufReader<File>>,
    tag: Tag,
) -> Result<Option<u64>, TiffError> {
    let value = decoder.find_tag(tag)?;
    Ok(value.and_then(|value| value.into_u64_vec().ok()?.first().copied()))
}

fn rational_tag(decoder: &mut Decoder<BufReader<File>>, tag: Tag) -> Option<f64> {
    match decoder.find_tag(tag).ok()?? {
        Value::Rational(n, d) => Some(f64::from(n) / f64::from(d)),
        _ => None,
    }
}

fn refused(path: &Path, error: TiffError) -> MapError {
    match error {
        TiffError::UnsupportedError(what) => {
            MapError::unsupported(path, super::super::error::one_line(what), SAVE_AS)
        }
        TiffError::IoError(source) if source.kind() != std::io::ErrorKind::UnexpectedEof => {
            MapError::damaged(path, source)
        }
        TiffError::IoError(_) => MapError::damaged(path, "it ends too early"),
        other => MapError::damaged(path, other),
    }
}
