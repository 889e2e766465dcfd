//! Rasters → linear sRGB, row by row.

use std::{path::Path, sync::Arc};

use glam::{Mat3, Vec3};
use moxcms::TransformF32Executor;

use super::{
    ColourEncoding, MapError,
    decode::{Raster, Sample, Samples},
    icc::{Curve, Profile},
};
use crate::colour;

/// Converts rows of a raster to linear sRGB.
pub(super) struct Linear<'a> {
    raster: &'a Raster,
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
        let colours = if raster.channels >= 3 { 3 } else { 1 };
        let float = matches!(raster.samples, Samples::F32(_));
        let profile = match (encoding, &raster.icc) {
            (ColourEncoding::Embedded, Some(bytes)) => Profile::read(path, bytes, colours)?,
            (ColourEncoding::Linear, _) => without_profile(|v| v),
            (ColourEncoding::Embedded, None) if float => without_profile(|v| v),
            _ => without_profile(|v| colour::srgb_decode(v.into()) as f32),
        };
        let codes = match raster.samples {
            Samples::U8(_) => 1 << 8,
            Samples::U16(_) => 1 << 16,
            Samples::F32(_) => 0,
        };
        let response = |curve: Curve| {
            let value = |code| curve((f64::from(code) / f64::from(codes - 1)) as f32);
            Response {
                codes: (0..codes).map(value).collect(),
                curve,
            }
        };
        Ok(Self {
            raster,
            responses: profile.curves.into_iter().map(response).collect(),
            table: profile.table,
            matrix: profile.matrix,
            may_overflow: float || profile.matrix.is_some(),
        })
    }

    /// Writes row `y` as linear red, green, blue and straight alpha, all finite; alpha is 1
    /// where the picture has none.
    pub fn row(&self, y: usize, out: &mut [[f32; 4]]) {
        let stride = self.raster.width * self.raster.channels;
        let range = y * stride..(y + 1) * stride;
        match &self.raster.samples {
            Samples::U8(v) => self.convert(&v[range], out),
            Samples::U16(v) => self.convert(&v[range], out),
            Samples::F32(v) => self.convert(&v[range], out),
        }
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

    fn convert<T: Sample>(&self, row: &[T], out: &mut [[f32; 4]]) {
        // The number of channels is decided outside the loop over pixels.
        match self.raster.channels {
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
