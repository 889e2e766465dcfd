//! From colours that are meant to the values that a display shows them with.

use std::path::PathBuf;

use glam::{DMat3, DVec3};

use crate::{
    colour::{self, SRGB_PRIMARIES, srgb_encode},
    maps::{DisplayProfile, Lattice},
};

/// How a display shows colours.
#[derive(Clone, Debug, PartialEq)]
pub enum Profile {
    /// As IEC 61966-2-1 says.
    Srgb,
    /// As was measured on it; its primaries are taken for sRGB's.
    Measured {
        /// CIE 1931 chromaticity of its white.
        white_xy: [f64; 2],
        /// Exponent of its tone curve.
        gamma: f64,
        /// Luminance of its white in cd/m².
        luminance_nits: Option<f64>,
    },
    /// As its ICC profile says.
    Icc {
        path: PathBuf,
        display: Box<DisplayProfile>,
        /// Luminance of its white in cd/m².
        luminance_nits: Option<f64>,
    },
}

/// The tone curve of one channel, from light to value.
#[derive(Clone, Debug, PartialEq)]
pub enum Tone {
    Srgb,
    Power(f64),
    /// The light at equal steps of the value, never falling.
    Table(Vec<f64>),
}

/// From linear sRGB to a display's values.
/// White stays the white of sRGB, whatever the display's own is: the channel that has too much of it
/// is dimmed.
#[derive(Clone, Debug, PartialEq)]
pub enum Correction {
    /// Each channel by itself.
    Curves {
        /// From linear sRGB to the light of the display's channels, 0 to 1.
        matrix: DMat3,
        tone: [Tone; 3],
    },
    /// All channels at once.
    Table(Lattice),
}

impl Profile {
    /// Luminance of white in cd/m², where it is known.
    pub fn luminance_nits(&self) -> Option<f64> {
        match self {
            Self::Srgb => None,
            Self::Measured { luminance_nits, .. } | Self::Icc { luminance_nits, .. } => {
                *luminance_nits
            }
        }
    }

    /// What makes colours meant colours shown.
    pub fn correction(&self) -> Correction {
        let (xyz_from_device, tone) = match self {
            Self::Srgb => {
                return Correction::Curves {
                    matrix: DMat3::IDENTITY,
                    tone: [Tone::Srgb, Tone::Srgb, Tone::Srgb],
                };
            }
            Self::Measured {
                white_xy, gamma, ..
            } => (
                colour::xyz_from_rgb_matrix(SRGB_PRIMARIES, *white_xy),
                [0; 3].map(|_| Tone::Power(*gamma)),
            ),
            Self::Icc { display, .. } => match &**display {
                DisplayProfile::Curves {
                    xyz_from_device,
                    tone,
                } => (*xyz_from_device, tone.clone().map(Tone::Table)),
                DisplayProfile::Table(lattice) => return Correction::Table(lattice.clone()),
            },
        };
        let matrix = xyz_from_device.inverse() * colour::linear_from_xyz_matrix().inverse();
        let brightest = (matrix * DVec3::ONE).max_element();
        Correction::Curves {
            matrix: matrix * brightest.recip(),
            tone,
        }
    }
}

impl Correction {
    /// The display's values, 0 to 1, for a colour in linear sRGB; what it cannot show is clamped.
    pub fn encode(&self, linear: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Curves { matrix, tone } => {
                let light = (*matrix * DVec3::from(linear)).clamp(DVec3::ZERO, DVec3::ONE);
                [0, 1, 2].map(|k| tone[k].value(light[k]))
            }
            Self::Table(lattice) => lattice.encode(linear),
        }
    }
}

impl Tone {
    /// The value in [0, 1] that makes this light in [0, 1].
    pub fn value(&self, light: f64) -> f64 {
        match self {
            Self::Srgb => srgb_encode(light),
            Self::Power(gamma) => light.powf(gamma.recip()),
            Self::Table(levels) => {
                let last = levels.len().saturating_sub(1).max(1) as f64;
                let above = levels.partition_point(|level| *level < light);
                let (Some(below), Some(top)) = (
                    above.checked_sub(1).and_then(|k| levels.get(k)),
                    levels.get(above),
                ) else {
                    return if above == 0 { 0.0 } else { 1.0 };
                };
                (above as f64 - 1.0 + (light - below) / (top - below)) / last
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hundredth of an 8-bit step.
    const FINE: f64 = 4e-5;

    fn near(a: [f64; 3], b: [f64; 3]) -> bool {
        (DVec3::from(a) - DVec3::from(b)).abs().max_element() < FINE
    }

    /// What light a display measured like this makes of `values`, as XYZ.
    fn shown(values: [f64; 3], white_xy: [f64; 2], gamma: f64) -> DVec3 {
        let light = values.map(|v| v.powf(gamma));
        colour::xyz_from_rgb_matrix(SRGB_PRIMARIES, white_xy) * DVec3::from(light)
    }

    #[test]
    fn srgb_is_left_alone() {
        let correction = Profile::Srgb.correction();
        let grey = [0.2, 0.5, 0.9];
        assert!(near(correction.encode(grey), grey.map(srgb_encode)));
    }

    #[test]
    fn colours_meant_are_colours_shown_on_a_bluish_display() {
        let (white_xy, gamma) = ([0.285, 0.293], 1.9);
        let profile = Profile::Measured {
            white_xy,
            gamma,
            luminance_nits: None,
        };
        let correction = profile.correction();
        let chromaticity = |xyz: DVec3| [xyz.x, xyz.y].map(|v| v / xyz.element_sum());
        for meant in [[1.0, 1.0, 1.0], [0.3, 0.3, 0.3], [0.5, 0.3, 0.2]] {
            let xyz = shown(correction.encode(meant), white_xy, gamma);
            let [x, y] = chromaticity(xyz);
            let [u, v] = chromaticity(DVec3::from(colour::xyz_from_linear(meant)));
            assert!((x - u).abs() + (y - v).abs() < FINE, "{meant:?}: {x} {y}");
        }
        // Without the correction it is off by far more than the tolerance.
        let raw = shown([1.0; 3], white_xy, gamma);
        assert!((chromaticity(raw)[0] - colour::D65[0]).abs() > 100.0 * FINE);
    }

    #[test]
    fn a_table_is_inverted() {
        let levels: Vec<f64> = (0..1024).map(|i| (f64::from(i) / 1023.0).powi(2)).collect();
        let tone = Tone::Table(levels);
        for value in [0.0, 0.01, 0.3, 0.77, 1.0] {
            assert!((tone.value(value * value) - value).abs() < 1e-3, "{value}");
        }
        let flat = Tone::Table(vec![0.0, 0.0, 0.5, 0.5, 1.0]);
        assert!(flat.value(0.5).is_finite() && flat.value(0.0) == 0.0);
    }
}
