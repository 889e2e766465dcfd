//! The ICC profile of a display: which light its values make.

use std::{fs::File, io::Read, path::Path};

use glam::{DMat3, DVec3, Mat3};
use moxcms::ColorProfile;

use super::{MapError, icc::Profile, lattice::Lattice};
use crate::colour;

/// Samples of each tone curve; between them it is straight, which at 8 bits cannot be told.
const SAMPLES: usize = 1024;
/// Chromaticities as near as this are of one white: profiles round theirs.
const SAME_WHITE: f64 = 1e-3;
/// Matrices as near as this adapt alike; other cone responses than Bradford's differ by less.
const SAME_ADAPTATION: f64 = 0.2;
/// Display profiles with tables stay below this.
const MOST_BYTES: u64 = 16 << 20;

/// What a display does with its values.
#[derive(Clone, Debug, PartialEq)]
pub enum DisplayProfile {
    /// Each channel by itself.
    Curves {
        /// From linear device values to CIE XYZ, Y = 1 for the display's white; not adapted.
        xyz_from_device: DMat3,
        /// The light of each channel, 0 to 1, at equal steps of its value from 0 to 1; never falling.
        tone: [Vec<f64>; 3],
    },
    /// As a table says, in which channels may act upon each other.
    Table(Lattice),
}

impl DisplayProfile {
    /// Reads a profile file (`.icc`) of a display.
    ///
    /// # Errors
    /// [`MapError::Read`], or [`MapError::Profile`] if it is broken or of something else than RGB.
    pub fn read(path: &Path) -> Result<Self, MapError> {
        let unreadable = |reason| MapError::Read {
            path: path.to_owned(),
            reason,
        };
        let mut bytes = Vec::new();
        File::open(path)
            .and_then(|file| file.take(MOST_BYTES).read_to_end(&mut bytes))
            .map_err(unreadable)?;
        let Profile {
            curves,
            table,
            matrix,
        } = Profile::read(path, &bytes, 3)?;
        let matrix = matrix.unwrap_or(Mat3::IDENTITY).as_dmat3();
        let header =
            ColorProfile::new_from_slice(&bytes).map_err(|error| MapError::profile(path, error))?;
        let white = white(&header);
        if let Some(table) = table {
            let lattice = Lattice::invert(&*table, matrix, white);
            let lattice = lattice.map_err(|detail| MapError::profile(path, detail))?;
            return Ok(Self::Table(lattice));
        }
        let tone = |k: usize| -> Option<Vec<f64>> {
            let curve = curves.get(k)?;
            let mut level: f64 = 0.0;
            let samples = (0..SAMPLES).map(|i| {
                let light = curve(i as f32 / (SAMPLES - 1) as f32);
                level = level.max(f64::from(light).clamp(0.0, 1.0));
                level
            });
            let samples: Vec<f64> = samples.collect();
            (level > 0.0).then_some(samples)
        };
        let (Some(red), Some(green), Some(blue)) = (tone(0), tone(1), tone(2)) else {
            return Err(MapError::profile(path, "a channel gives no light"));
        };
        Ok(Self::Curves {
            // The profile's colours are adapted to D50, and `matrix` adapts them on to D65.
            xyz_from_device: colour::bradford(colour::D65, white)
                * colour::linear_from_xyz_matrix().inverse()
                * matrix,
            tone: [red, green, blue],
        })
    }
}

/// The chromaticity of the display's own white: what its `chad` tag adapts from, or, in version 2,
/// its media white point. Where neither says, as where that is D50, to which all profiles are
/// adapted, it is taken for what it is meant to be, D65.
fn white(profile: &ColorProfile) -> [f64; 2] {
    let d50 = DVec3::from(colour::white_xyz(colour::D50));
    let chromaticity = |xyz: DVec3| {
        let sound = xyz.is_finite() && xyz.min_element() > 0.0;
        sound.then(|| [xyz.x, xyz.y].map(|v| v / xyz.element_sum()))
    };
    let adapted = profile.chromatic_adaptation.as_ref().and_then(|matrix| {
        let chad = DMat3::from_cols_array_2d(&matrix.v).transpose();
        let white = chromaticity(chad.inverse() * d50)?;
        // Some programs write the cone responses there, which adapt nothing.
        let difference = colour::bradford(white, colour::D50) - chad;
        let largest = difference.to_cols_array().map(f64::abs);
        (largest.into_iter().fold(0.0, f64::max) < SAME_ADAPTATION).then_some(white)
    });
    let media = profile.media_white_point.as_ref();
    adapted
        .or_else(|| media.and_then(|white| chromaticity(DVec3::new(white.x, white.y, white.z))))
        .filter(|xy| (0..2).any(|k| (xy[k] - colour::D50[k]).abs() > SAME_WHITE))
        .unwrap_or(colour::D65)
}
