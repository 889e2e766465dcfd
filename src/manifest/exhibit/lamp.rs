//! The lamps of an exhibit, in photometric units.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::Wording;
use crate::{
    manifest::raw::RawLamp,
    optics::photometry::Photometry,
    units::{Candela, Degrees, Kelvin, Lux, Nits},
};

/// A light source in photometric units.
#[derive(Clone, Debug, PartialEq)]
pub struct Lamp {
    pub id: String,
    pub title: Wording,
    pub colour: LampColour,
    pub kind: LampKind,
    /// As it is written, for a copy that names the same files; `None` for one that is not.
    pub written: Option<Arc<RawLamp>>,
}

/// The colour of a lamp's light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LampColour {
    Temperature(Kelvin),
    /// x, y for the 2° observer, from the lamp's spectrum.
    Chromaticity([f64; 2]),
}

/// Places are in the table frame; every lamp that has a direction looks at the sheet's centre
/// unless it says otherwise.
#[derive(Clone, Debug, PartialEq)]
pub enum LampKind {
    /// `illuminance` is measured facing the lamp, so the sheet receives it times cos θ.
    Distant {
        illuminance: Lux,
        elevation: Degrees,
        azimuth: Degrees,
    },
    Point {
        intensity: Candela,
        position_mm: DVec3,
    },
    /// Full intensity within `hotspot` of the axis, none beyond `falloff`, linear in the
    /// cosine between (both half angles).
    Spot {
        intensity: Candela,
        position_mm: DVec3,
        aim_mm: DVec3,
        hotspot: Degrees,
        falloff: Degrees,
    },
    /// One-sided Lambertian rectangle; its width is horizontal.
    Rectangle {
        luminance: Nits,
        position_mm: DVec3,
        aim_mm: DVec3,
        size_mm: DVec2,
    },
    /// One-sided Lambertian disc.
    Disc {
        luminance: Nits,
        position_mm: DVec3,
        aim_mm: DVec3,
        diameter_mm: f64,
    },
    /// A small lamp with the intensities of a photometric file.
    Ies {
        photometry: Arc<Photometry>,
        position_mm: DVec3,
        aim_mm: DVec3,
    },
    /// A luminous table behind the whole sheet: it shines through it and not on its front.
    LightTable { luminance: Nits },
}

impl LampKind {
    /// Gives `gain` times the light.
    pub fn dim(&mut self, gain: f64) {
        match self {
            Self::Distant { illuminance, .. } => illuminance.0 *= gain,
            Self::Point { intensity, .. } | Self::Spot { intensity, .. } => intensity.0 *= gain,
            Self::Rectangle { luminance, .. }
            | Self::Disc { luminance, .. }
            | Self::LightTable { luminance } => luminance.0 *= gain,
            Self::Ies { photometry, .. } => {
                let dimmed = Photometry::clone(photometry).dimmed(gain);
                *photometry = Arc::new(dimmed);
            }
        }
    }

    /// How high it is over the middle of the sheet; `None` for a light table.
    pub fn elevation_deg(&self) -> Option<f64> {
        match self {
            Self::Distant { elevation, .. } => Some(elevation.0),
            Self::Point { position_mm, .. }
            | Self::Spot { position_mm, .. }
            | Self::Rectangle { position_mm, .. }
            | Self::Disc { position_mm, .. }
            | Self::Ies { position_mm, .. } => {
                let away = position_mm.truncate().length();
                Some(position_mm.z.atan2(away).to_degrees())
            }
            Self::LightTable { .. } => None,
        }
    }

    /// Whether it shines through the sheet from behind, and on neither side of it.
    pub fn is_behind(&self) -> bool {
        matches!(self, Self::LightTable { .. })
    }
}
