//! Embedded ICC profiles: device values to linear sRGB, relative colorimetric.

use std::{path::Path, sync::Arc};

use glam::{DMat3, DVec3, Mat3};
use moxcms::{
    BarycentricWeightScale, ColorProfile, DataColorSpace, Layout, RenderingIntent, ToneReprCurve,
    TransformF32Executor, TransformOptions, Xyzd,
};

use super::MapError;
use crate::colour;

/// A function of one value.
pub(super) type Curve = Box<dyn Fn(f32) -> f32 + Send + Sync>;

/// The steps from device values (0…1) to linear sRGB, in their order. Nothing is clamped to the
/// gamut, so that saturated colours survive.
pub(super) struct Profile {
    /// One for each channel, or one for grey.
    pub curves: Vec<Curve>,
    /// A table over RGB.
    pub table: Option<Arc<TransformF32Executor>>,
    pub matrix: Option<Mat3>,
}

impl Profile {
    /// Reads an embedded profile for a picture of `colours` channels (1 or 3) beside alpha.
    ///
    /// # Errors
    /// [`MapError::Profile`] where it is broken, or describes other channels.
    pub fn read(path: &Path, bytes: &[u8], colours: usize) -> Result<Self, MapError> {
        let broken = |error| MapError::profile(path, error);
        let profile = ColorProfile::new_from_slice(bytes).map_err(broken)?;
        let expected = if colours == 1 {
            DataColorSpace::Gray
        } else {
            DataColorSpace::Rgb
        };
        if profile.color_space != expected {
            let found = profile.color_space;
            let detail = format!("it describes {found:?} and the picture is {expected:?}");
            return Err(MapError::profile(path, detail));
        }
        if colours == 1 {
            let curve = profile
                .gray_trc
                .as_ref()
                .filter(|_| profile.pcs == DataColorSpace::Xyz);
            let curve = curve.ok_or_else(|| MapError::profile(path, "it has no tone curve"))?;
            return Ok(Self {
                curves: vec![evaluator(path, curve)?],
                table: None,
                matrix: None,
            });
        }
        if profile.lut_a_to_b_colorimetric.is_some() || profile.lut_a_to_b_perceptual.is_some() {
            return Self::from_table(path, &profile);
        }
        let [Some(red), Some(green), Some(blue)] =
            [&profile.red_trc, &profile.green_trc, &profile.blue_trc]
        else {
            return Err(MapError::profile(
                path,
                "it has neither tone curves nor a table",
            ));
        };
        let colorants = DMat3::from_cols_array_2d(&profile.colorant_matrix().v).transpose();
        if !(colorants.is_finite() && colorants.determinant().abs() > f64::EPSILON) {
            return Err(MapError::profile(path, "its primaries span no colours"));
        }
        Ok(Self {
            curves: vec![
                evaluator(path, red)?,
                evaluator(path, green)?,
                evaluator(path, blue)?,
            ],
            table: None,
            matrix: Some((srgb_from_pcs() * colorants).as_mat3()),
        })
    }

    fn from_table(path: &Path, profile: &ColorProfile) -> Result<Self, MapError> {
        // The engine clamps to its destination, so that is a linear space which holds every
        // surface colour (ROMM, ISO 22028-2, whose white is D50); the way on is ours.
        let primaries = [[0.7347, 0.2653], [0.1596, 0.8404], [0.0366, 0.0001]];
        let to_pcs = colour::xyz_from_rgb_matrix(primaries, colour::D50);
        let xyz = |column: DVec3| Xyzd {
            x: column.x,
            y: column.y,
            z: column.z,
        };
        // ICC's identity curve is an empty list of values.
        let identity = || Some(ToneReprCurve::Lut(Vec::new()));
        let mut wide = ColorProfile::new_pro_photo_rgb();
        wide.red_colorant = xyz(to_pcs.x_axis);
        wide.green_colorant = xyz(to_pcs.y_axis);
        wide.blue_colorant = xyz(to_pcs.z_axis);
        (wide.red_trc, wide.green_trc, wide.blue_trc) = (identity(), identity(), identity());
        wide.cicp = None;
        let options = TransformOptions {
            rendering_intent: RenderingIntent::RelativeColorimetric,
            // The lower scale takes the nearest of 256 values of each channel.
            barycentric_weight_scale: BarycentricWeightScale::High,
            ..TransformOptions::default()
        };
        let table = profile
            .create_transform_f32(Layout::Rgb, &wide, Layout::Rgb, options)
            .map_err(|error| MapError::profile(path, error))?;
        let matrix = (srgb_from_pcs() * to_pcs).as_mat3();
        Ok(Self {
            curves: vec![Box::new(|v| v)],
            table: Some(table),
            matrix: Some(matrix),
        })
    }
}

fn evaluator(path: &Path, curve: &ToneReprCurve) -> Result<Curve, MapError> {
    let curve = curve
        .make_linear_evaluator()
        .map_err(|error| MapError::profile(path, error))?;
    Ok(Box::new(move |v| curve.evaluate_value(v)))
}

/// From ICC's connection space (XYZ under D50) to linear sRGB.
fn srgb_from_pcs() -> DMat3 {
    colour::linear_from_xyz_matrix() * colour::bradford(colour::D50, colour::D65)
}
