//! Rasters → linear sRGB, row by row.

use std::{path::Path, sync::Arc};

use glam::{Mat3, Vec3};
use moxcms::TransformF32Executor;

use super::{
    ColourEncoding, MapError,
    decode::{Kind, Raster, Sample, Samples},
    icc::{Curve, Profile},
};
use crate::colour;

/// Converts rows of a raster to linear sRGB.
pub(super) struct Linear<'a> {
    raster: &'a Raster,
    converter: Converter,
}

/// Converts rows of samples to linear sRGB.
pub(super) struct Converter {
    channels: usize,
    /// One for each channel of colour, or one for all.
    responses: Vec<Response>,
    table: Option<Arc<TransformF32Executor>>,
    matrix: Option<Mat3>,
    may_overflow: bool,
}

/// From a stored value to linear light.
struct Response {
    curve: Curve,
    /// The curve at every code of an integer file; empty for floats.
    codes: Box<[f32]>,
}

impl Response {
    fn of<T: Sample>(&self, value: T) -> f32 {
        match value.code() {
            Some(code) => self.codes[code],
            None => (self.curve)(value.unit()),
        }
    }
}

impl<'a> Linear<'a> {
    /// # Errors
    /// [`MapError::Profile`] where the encoding is `Embedded` and the profile cannot be used.
    pub fn new(
        path: &Path,
        raster: &'a Raster,
        encoding: ColourEncoding,
    ) -> Result<Self, MapError> {
        let kind = raster.samples.kind();
        let icc = raster.icc.as_deref();
        Ok(Self {
            raster,
            converter: Converter::new(path, raster.channels, kind, icc, encoding)?,
        })
    }

    /// Writes row `y` as linear red, green, blue and straight alpha, all finite; alpha is 1
    /// where the picture has none.
    pub fn row(&self, y: usize, out: &mut [[f32; 4]]) {
        let stride = self.raster.width * self.raster.channels;
        let range = y * stride..(y + 1) * stride;
        match &self.raster.samples {
            Samples::U8(v) => self.converter.row(&v[range], out),
            Samples::U16(v) => self.converter.row(&v[range], out),
            Samples::F32(v) => self.converter.row(&v[range], out),
        }
    }
}

impl Converter {
    /// For samples of this kind, `channels` of them a pixel, with this embedded profile.
    ///
    /// # Errors
    /// [`MapError::Profile`] where the encoding is `Embedded` and the profile cannot be used.
    pub fn new(
        path: &Path,
        channels: usize,
        kind: Kind,
        icc: Option<&[u8]>,
        encoding: ColourEncoding,
    ) -> Result<Self, MapError> {
        let colours = if channels >= 3 { 3 } else { 1 };
        let float = kind == Kind::F32;
        let profile = match (encoding, icc) {
            (ColourEncoding::Embedded, Some(bytes)) => Profile::read(path, bytes, colours)?,
            (ColourEncoding::Linear, _) => without_profile(|v| v),
            (ColourEncoding::Embedded, None) if float => without_profile(|v| v),
            _ => without_profile(|v| colour::srgb_decode(v.into()) as f32),
        };
        let codes = match kind {
            Kind::U8 => 1 << 8,
            Kind::U16 => 1 << 16,
            Kind::F32 => 0,
        };
        let response = |curve: Curve| {
            let value = |code| curve((f64::from(code) / f64::from(codes - 1)) as f32);
            Response {
                codes: (0..codes).map(value).collect(),
                curve,
            }
        };
        Ok(Self {
            channels,
            responses: profile.curves.into_iter().map(response).collect(),
            table: profile.table,
            matrix: profile.matrix,
            may_overflow: float || profile.matrix.is_some(),
        })
    }

    /// Writes a row as linear red, green, blue and straight alpha, all finite; alpha is 1 where
    /// the picture has none.
    pub fn row<T: Sample>(&self, row: &[T], out: &mut [[f32; 4]]) {
        self.convert(row, out);
        if let Some(table) = &self.table {
            let encoded: Vec<f32> = out.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
            let mut linear = vec![0.0; encoded.len()];
            // Both buffers hold whole pixels, which is all that could be wrong; were it not so,
            // the row would be black.
            if table.transform(&encoded, &mut linear).is_ok() {
                for (out, rgb) in out.iter_mut().zip(linear.as_chunks::<3>().0) {
                    out[..3].copy_from_slice(rgb);
                }
            }
        }
        if let Some(matrix) = self.matrix {
            for pixel in out.iter_mut() {
                let rgb = matrix * Vec3::new(pixel[0], pixel[1], pixel[2]);
                rgb.write_to_slice(&mut pixel[..3]);
            }
        }
        // A float file or a strange profile can overflow.
        if self.may_overflow {
            for value in out.as_flattened_mut().iter_mut().filter(|v| !v.is_finite()) {
                *value = 0.0;
            }
        }
    }

    /// Writes a row as planes of linear red, green and blue, all finite; alpha is left out.
    pub fn planes<T: Sample>(&self, row: &[T], out: [&mut [f32]; 3]) {
        if self.table.is_some() || self.channels < 3 {
            let mut pixels = vec![[0.0; 4]; out[0].len()];
            self.row(row, &mut pixels);
            let [r, g, b] = out;
            for (((pixel, r), g), b) in pixels.iter().zip(r).zip(g).zip(b) {
                [*r, *g, *b] = [pixel[0], pixel[1], pixel[2]];
            }
            return;
        }
        let [r, g, b] = out;
        let responses = [0, 1, 2].map(|c| &self.responses[c % self.responses.len()]);
        let pixels = row.chunks_exact(self.channels);
        for (((pixel, r), g), b) in pixels.zip(&mut *r).zip(&mut *g).zip(&mut *b) {
            *r = responses[0].of(pixel[0]);
            *g = responses[1].of(pixel[1]);
            *b = responses[2].of(pixel[2]);
        }
        if let Some(matrix) = self.matrix {
            for ((r, g), b) in r.iter_mut().zip(&mut *g).zip(&mut *b) {
                (*r, *g, *b) = (matrix * Vec3::new(*r, *g, *b)).into();
            }
        }
        if self.may_overflow {
            for plane in [r, g, b] {
                for value in plane.iter_mut().filter(|v| !v.is_finite()) {
                    *value = 0.0;
                }
            }
        }
    }

    fn convert<T: Sample>(&self, row: &[T], out: &mut [[f32; 4]]) {
        // The number of channels is decided outside the loop over pixels.
        match self.channels {
            1 => self.convert_channels::<T, 1>(row, out),
            2 => self.convert_channels::<T, 2>(row, out),
            3 => self.convert_channels::<T, 3>(row, out),
            _ => self.convert_channels::<T, 4>(row, out),
        }
    }

    fn convert_channels<T: Sample, const N: usize>(&self, row: &[T], out: &mut [[f32; 4]]) {
        let responses = [0, 1, 2].map(|c| &self.responses[c % self.responses.len()]);
        for (pixel, out) in row.as_chunks::<N>().0.iter().zip(out) {
            let alpha = if N.is_multiple_of(2) {
                pixel[N - 1].unit()
            } else {
                1.0
            };
            *out = if N >= 3 {
                let [r, g, b] = [0, 1, 2].map(|c| responses[c].of(pixel[c]));
                [r, g, b, alpha]
            } else {
                // A grey picture has one curve.
                let grey = responses[0].of(pixel[0]);
                [grey, grey, grey, alpha]
            };
        }
    }
}

fn without_profile(curve: impl Fn(f32) -> f32 + Send + Sync + 'static) -> Profile {
    Profile {
        curves: vec![Box::new(curve)],
        table: None,
        matrix: None,
    }
}
