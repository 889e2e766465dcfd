//! A picture of colour a few rows at a time, for work on many pictures at once.

use std::path::Path;

use super::{
    ColourEncoding, Header, MapError,
    decode::{RowSource, Samples},
    linear::Converter,
};

/// A picture as rows of linear sRGB, from its top. What is in memory is bounded by the rows asked
/// for, and not by the picture, once it is open.
pub struct ColourRows {
    source: RowSource,
    converter: Converter,
    left: usize,
}

impl ColourRows {
    /// Opens a picture. One that its format does not give row by row is decoded whole, once, and
    /// laid down in a nameless file in the folder `scratch`.
    ///
    /// # Errors
    /// As [`super::verify_colour`], and [`MapError::Write`] where `scratch` has no room.
    pub fn open(path: &Path, encoding: ColourEncoding, scratch: &Path) -> Result<Self, MapError> {
        let source = RowSource::open(path, scratch)?;
        let header = source.header;
        let channels = usize::from(header.channels);
        let icc = source.icc.as_deref();
        let converter = Converter::new(path, channels, source.kind, icc, encoding)?;
        Ok(Self {
            source,
            converter,
            left: header.size[1] as usize,
        })
    }

    pub fn header(&self) -> Header {
        self.source.header
    }

    /// How many rows have not been read.
    pub fn left(&self) -> usize {
        self.left
    }

    /// Leaves the next rows out.
    ///
    /// # Errors
    /// As [`Self::read`], unless nothing of what is left out has to be read.
    pub fn skip(&mut self, rows: usize) -> Result<(), MapError> {
        self.left = self.left.saturating_sub(rows);
        self.source.skip(rows)
    }

    /// Reads the next rows: as many as there are in `out`, planes of linear red, green and blue, of
    /// a length that is a multiple of the width. All values are finite; no clipping.
    ///
    /// # Errors
    /// [`MapError::Damaged`] or [`MapError::Read`], also where fewer rows are left.
    pub fn read(&mut self, [r, g, b]: [&mut [f32]; 3]) -> Result<(), MapError> {
        let width = self.source.header.size[0] as usize;
        let rows = r.len() / width;
        self.left = self.left.saturating_sub(rows);
        for y in 0..rows {
            let out =
                [&mut *r, &mut *g, &mut *b].map(|plane| &mut plane[y * width..(y + 1) * width]);
            let (samples, range) = self.source.next_row()?;
            match samples {
                Samples::U8(v) => self.converter.planes(&v[range], out),
                Samples::U16(v) => self.converter.planes(&v[range], out),
                Samples::F32(v) => self.converter.planes(&v[range], out),
            }
        }
        Ok(())
    }
}
