//! The catalogue of media: what lies on the table, by name, with the constants of its surface.

use std::{fmt, str::FromStr};

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
#[derive(Debug)]
pub struct Medium {
    /// The name that manifests use.
    pub name: &'static str,
    pub kind: MediumKind,
    /// GGX roughness α of its surface, in (0, 1].
    pub roughness: f64,
    /// Real refractive index of its surface.
    pub index: f64,
}

const fn paper(name: &'static str, roughness: f64) -> Medium {
    // Fabritius et al. 2006: 1.557 for bleached kraft fibre; Chen 2020: 1.525 to 1.537 for
    // delignified wood. The surface is fibre, size and air, hence the lower customary value.
    Medium {
        name,
        kind: MediumKind::Paper,
        roughness,
        index: 1.5,
    }
}

const fn drawn(name: &'static str, roughness: f64, index: f64) -> Medium {
    Medium {
        name,
        kind: MediumKind::Drawn,
        roughness,
        index,
    }
}

/// Every medium a manifest can name. Roughness is assumed, from the look of the material;
/// indices are those of the sources in `OPTICS.md`, or of gum arabic where a gum binds.
const CATALOGUE: &[Medium] = &[
    paper("laid", 0.6),
    paper("wove", 0.55),
    paper("burnished", 0.25),
    paper("parchment", 0.4),
    paper("prepared", 0.7),
    drawn("iron-gall-ink", 0.35, 1.49),
    drawn("wash", 0.5, 1.48),
    drawn("lead-point", 0.3, 1.5),
    drawn("silver-point", 0.3, 1.5),
    drawn("black-chalk", 0.85, 1.56),
    drawn("charcoal", 0.9, 1.56),
    drawn("red-chalk", 0.8, 1.6),
    drawn("white-gouache", 0.7, 1.6),
    drawn("watercolour", 0.5, 1.48),
    drawn("carbon-ink", 0.4, 1.49),
    drawn("bistre", 0.45, 1.49),
    drawn("blind-stylus", 0.5, 1.5),
    drawn("prepared-ground", 0.7, 1.6),
];

impl MediumId {
    /// All media of the catalogue, in its order.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..CATALOGUE.len()).map(Self)
    }

    /// The medium's constants.
    pub fn medium(self) -> &'static Medium {
        &CATALOGUE[self.0]
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
