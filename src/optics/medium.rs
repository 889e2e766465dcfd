//! The catalogue of media: what lies on the table, by name, with its constants.
//!
//! Triples stand for the channels R, G, B of linear sRGB. Sources that list wavelengths are read
//! at 650, 550 and 450 nm, **in this order**.

mod catalogue;

use std::{fmt, str::FromStr};

use serde::Serialize;

/// A paper or drawing material of the catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MediumId(usize);

/// What a medium is, which decides where a manifest may name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MediumKind {
    /// A sheet to draw on: `paper.kind`.
    Paper,
    /// Drawn on the sheet: a media map's legend.
    Drawn,
}

/// One entry of the catalogue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// The name that manifests use.
    pub name: &'static str,
    pub kind: MediumKind,
    pub matter: Matter,
    /// Where its constants come from.
    pub source: &'static str,
}

/// Whose values of the constants.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
pub enum Preset {
    /// Values of the visible range.
    #[default]
    #[serde(rename = "recto")]
    Recto,
    /// Those that Apollonio et al. 2021 (doi 10.1145/3433606) print, to reproduce the article's
    /// own rendering: taken from infrared and terahertz tables, hence no defaults.
    #[serde(rename = "isle-2021")]
    Isle2021,
}

/// What a medium does with light, by what it is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Matter {
    /// A scattering slab with two rough surfaces.
    Paper(PaperConstants),
    /// A transparent film that absorbs: ink, wash.
    Film(FilmConstants),
    /// Opaque grains that cover a share of what lies below: metal, chalk.
    Particles(ParticleConstants),
    /// A scattering film that hides what lies below: gouache, grounds.
    Body(BodyConstants),
    /// No matter at all, only a groove.
    Relief,
}

/// A sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperConstants {
    /// Refractive index of the surface, 1 to 3.
    pub index: f64,
    /// GGX roughness α of the bare surface, 0.1 to 1.
    pub roughness: f64,
    /// σs in mm⁻¹, > 0.
    pub scattering_per_mm: f64,
    /// Share of the phase function's forward lobe, 0 to 1.
    pub forward_share: f64,
    /// Mean cosine of the forward lobe, 0 to .99.
    pub g_forward: f64,
    /// Mean cosine of the backward lobe, −.99 to 0.
    pub g_backward: f64,
    /// In µm, > 0.
    pub thickness_um: f64,
    /// Of the bare sheet as photographed at 45°/0°, 0 to 1.
    pub albedo: [f64; 3],
    /// Share of the gloss that goes back to the lamp, 0 (off) to 1.
    pub retro: f64,
    /// Strength of the sheen lobe, 0 (off) to 1 sr⁻¹ at grazing angles.
    pub sheen: f64,
    /// Of the specular lobe, 0 (none) to 1.
    pub anisotropy: f64,
    /// Direction of the lobe's longer axis, anticlockwise from the right as the recto is seen.
    pub anisotropy_deg: f64,
}

/// A transparent film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmConstants {
    /// Refractive index, 1 to 3.
    pub index: f64,
    /// GGX roughness α, 0.01 to 1.
    pub roughness: f64,
    /// Optical depth τ along the normal at full strength, 0 to 20.
    pub depth: [f64; 3],
}

/// Opaque grains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParticleConstants {
    /// Real part of the refractive index, .01 to 6.
    pub n: [f64; 3],
    /// Its imaginary part, 0 to 20.
    pub k: [f64; 3],
    /// GGX roughness α of the surface that they form, 0.01 to 1.
    pub roughness: f64,
    /// At full coverage as photographed at 45°/0°, 0 to 1: what they mirror into the photograph
    /// is in it.
    pub albedo: [f64; 3],
}

/// A scattering film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyConstants {
    /// Refractive index of the surface, 1 to 3.
    pub index: f64,
    /// GGX roughness α, 0.01 to 1.
    pub roughness: f64,
    /// σs in mm⁻¹, > 0.
    pub scattering_per_mm: f64,
    /// In µm, > 0.
    pub thickness_um: f64,
    /// At full coverage as photographed at 45°/0°, 0 to 1.
    pub albedo: [f64; 3],
}

/// Roughness and index of what has no surface of its own.
const BARE: (f64, f64) = (0.5, 1.5);

impl Matter {
    /// GGX roughness α of the surface; that of smooth paper for a groove.
    pub fn roughness(&self) -> f64 {
        match self {
            Self::Paper(paper) => paper.roughness,
            Self::Film(film) => film.roughness,
            Self::Particles(particles) => particles.roughness,
            Self::Body(body) => body.roughness,
            Self::Relief => BARE.0,
        }
    }

    /// Real refractive index of the surface where a tier knows dielectrics only; for particles,
    /// between which paper shines, and a groove that of paper.
    pub fn index(&self) -> f64 {
        match self {
            Self::Paper(paper) => paper.index,
            Self::Film(film) => film.index,
            Self::Body(body) => body.index,
            Self::Particles(_) | Self::Relief => BARE.1,
        }
    }
}

impl Medium {
    /// GGX roughness α of its surface, in (0, 1].
    pub fn roughness(&self) -> f64 {
        self.matter.roughness()
    }

    /// Real refractive index of its surface.
    pub fn index(&self) -> f64 {
        self.matter.index()
    }
}

impl MediumId {
    /// All media of the catalogue, in its order.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..catalogue::CATALOGUE.len()).map(Self)
    }

    /// The medium with its constants of the visible range.
    pub fn medium(self) -> &'static Medium {
        &catalogue::CATALOGUE[self.0]
    }

    /// The medium with a preset's constants.
    pub fn of_preset(self, preset: Preset) -> Medium {
        match preset {
            Preset::Recto => *self.medium(),
            Preset::Isle2021 => catalogue::isle_2021(self.medium()),
        }
    }

    /// The name that manifests use.
    pub fn name(self) -> &'static str {
        self.medium().name
    }
}

impl fmt::Display for MediumId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// No medium of the catalogue has this name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no medium of the catalogue has this name")]
pub struct UnknownMedium;

impl FromStr for MediumId {
    type Err = UnknownMedium;

    fn from_str(name: &str) -> Result<Self, UnknownMedium> {
        Self::all()
            .find(|id| id.name() == name)
            .ok_or(UnknownMedium)
    }
}

#[cfg(test)]
mod tests;
