//! PNG: any colour type and depth; palettes and packed pixels become 8-bit colours or greys.

use std::{fs::File, io::BufReader, path::PathBuf};

use png::{BitDepth, DecodingError, Limits, Transformations, Unit};

use super::{
    Header, MapError, Missing, Orientation, Raster, Samples, check_memory, check_size, exif,
    plausible_dpi,
};

/// For chunks beside the pixels (profile, EXIF, text) and single rows.
const ANCILLARY_BYTES: usize = 64 << 20;

pub(in super::super) struct PngPicture {
    path: PathBuf,
    reader: png::Reader<BufReader<File>>,
    pub header: Header,
    pub orientation: Orientation,
}

impl PngPicture {
    pub fn open(path: &std::path::Path, file: BufReader<File>) -> Result<Self, MapError> {
        let damaged = |error| refused(path, error);
        let mut decoder = png::Decoder::new_with_limits(
            file,
            Limits {
                bytes: ANCILLARY_BYTES,
            },
        );
        decoder.set_transformations(Transformations::EXPAND);
        decoder.set_ignore_text_chunk(true);
        let info = decoder.read_header_info().map_err(damaged)?;
        let size = check_size(path, info.width.into(), info.height.into())?;
        let reader = decoder.read_info().map_err(damaged)?;
        let info = reader.info();
        let exif = info
            .exif_metadata
            .as_deref()
            .map(exif::read)
            .unwrap_or_default();
        let dpi = info
            .pixel_dims
            .filter(|dims| matches!(dims.unit, Unit::Meter))
            .and_then(|d| plausible_dpi(f64::from(d.xppu) * 0.0254, f64::from(d.yppu) * 0.0254))
            .or(exif.dpi);
        let (colour, depth) = reader.output_color_type();
        let header = Header {
            size,
            channels: colour.samples() as u8,
            bits: depth as u8,
            float: false,
            dpi,
            icc: info.icc_profile.is_some(),
        };
        check_memory(path, &header)?;
        Ok(Self {
            path: path.into(),
            reader,
            header,
            orientation: exif.orientation,
        })
    }

    pub fn path(&self) -> &std::path::Path {
        &self.path
    }

    /// Whether rows come one after another, upright.
    pub fn is_streamed(&self) -> bool {
        !self.reader.info().interlaced && self.orientation == Orientation::default()
    }

    /// The embedded ICC profile.
    pub fn icc(&self) -> Option<Vec<u8>> {
        let profile = self.reader.info().icc_profile.as_ref();
        profile.map(|profile| profile.to_vec())
    }

    /// The bytes of the next row, values of 16 bits with the high byte first.
    pub fn next_row(&mut self) -> Result<&[u8], MapError> {
        let path = &self.path;
        match self.reader.next_row() {
            Ok(Some(row)) => Ok(row.data()),
            Ok(None) => Err(MapError::damaged(path, "it ends too early")),
            Err(error) => Err(refused(path, error)),
        }
    }

    pub fn decode(mut self) -> Result<Raster, MapError> {
        let path = &self.path;
        let bytes = self
            .reader
            .output_buffer_size()
            .ok_or_else(|| MapError::damaged(path, "its size does not fit in memory"))?;
        let mut buffer = vec![0; bytes];
        self.reader
            .next_frame(&mut buffer)
            .map_err(|error| refused(path, error))?;
        let (colour, depth) = self.reader.output_color_type();
        let samples = if depth == BitDepth::Sixteen {
            let be = |pair: &[u8; 2]| u16::from_be_bytes(*pair);
            Samples::U16(buffer.as_chunks().0.iter().map(be).collect())
        } else {
            Samples::U8(buffer)
        };
        let [width, height] = self.header.size.map(|v| v as usize);
        let icc = self
            .reader
            .info()
            .icc_profile
            .as_ref()
            .map(|profile| profile.to_vec());
        Ok(Raster {
            width,
            height,
            channels: colour.samples(),
            samples,
            premultiplied: false,
            icc,
            missing: Missing::default(),
        })
    }
}

fn refused(path: &std::path::Path, error: DecodingError) -> MapError {
    match error {
        DecodingError::IoError(source) if source.kind() != std::io::ErrorKind::UnexpectedEof => {
            MapError::read(path, source)
        }
        DecodingError::IoError(_) => MapError::damaged(path, "it ends too early"),
        other => MapError::damaged(path, other),
    }
}
