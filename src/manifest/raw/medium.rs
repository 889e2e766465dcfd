//! Media of the manifest's own, and changes to those of the catalogue.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;

use super::{
    super::{
        decode::{Decode, Node, Pattern, Report},
        document::Words,
        exhibit::Source,
        macros::record,
    },
    values::{
        BackwardCosine, Extinction, ForwardCosine, Fraction, HexColour, Id, LayerUm, MediumAlpha,
        OpticalDepth, ParticleIndex, Reflectance, RefractiveIndex, ScatteringPerMm, TurnDeg,
    },
};
use crate::colour;

record! {
    /// A medium of the catalogue with other constants, or a new one that is based on one of the
    /// catalogue. Which constants it has depends on what it is made of.
    pub struct RawMedium {
        required {
            /// The name of a medium of the catalogue, to change it; or a new name.
            id: Id,
        }
        optional {
            /// The medium of the catalogue that a new one is like. Without it: id names one.
            based_on: Id,
            /// Refractive index of the surface: papers, inks and body colours.
            index: RefractiveIndex,
            /// Roughness α of the surface, 0.01 (mirror) to 1.
            roughness: MediumAlpha,
            /// Scattering coefficient in 1/mm: papers and body colours.
            scattering_per_mm: ScatteringPerMm,
            /// Share of the light that papers scatter forwards.
            forward_share: Fraction,
            /// Mean cosine of what papers scatter forwards.
            g_forward: ForwardCosine,
            /// Mean cosine of what papers scatter backwards.
            g_backward: BackwardCosine,
            /// Thickness in µm: papers and body colours.
            thickness_um: LayerUm,
            /// Colour at full coverage as photographed: papers, particles and body colours.
            albedo: RawAlbedo,
            /// Share of a paper's gloss that goes back to the lamp, 0 (off) to 1.
            retro: Fraction,
            /// Strength of a paper's sheen, 0 (off) to 1.
            sheen: Fraction,
            /// How much more a paper's gloss spreads one way than across it, 0 to 1.
            anisotropy: Fraction,
            /// The way it spreads more, in degrees anticlockwise from the right as the recto is seen.
            anisotropy_deg: TurnDeg,
            /// Optical depths of inks for red, green and blue at full strength.
            depth: [OpticalDepth; 3],
            /// Real part of the refractive index of particles for red, green and blue.
            n: [ParticleIndex; 3],
            /// Imaginary part of the refractive index of particles for red, green and blue.
            k: [Extinction; 3],
            /// Where these constants come from. Without it: assumed.
            source: Source,
        }
        rules []
    }
}

/// A reflectance: a colour as in a style sheet, or its linear values for red, green and blue.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum RawAlbedo {
    Colour(HexColour),
    Linear([Reflectance; 3]),
}

impl RawAlbedo {
    /// Linear sRGB.
    pub fn linear(&self) -> [f64; 3] {
        match self {
            Self::Colour(text) => {
                // A HexColour is one that can be read.
                let rgb = colour::parse_hex(text.as_str()).unwrap_or_default();
                colour::linear_from_srgb8(rgb)
            }
            Self::Linear(values) => values.map(|value| value.0),
        }
    }
}

impl Decode for RawAlbedo {
    fn allowed() -> String {
        format!(
            "{}, or {}",
            HexColour::allowed(),
            <[Reflectance; 3]>::allowed()
        )
    }

    fn decode(node: &Node<'_>, report: &mut Report<'_>) -> Option<Self> {
        if node.text().is_some() {
            return HexColour::decode(node, report).map(Self::Colour);
        }
        if node.number().is_some() {
            let words = Words::new(node.found(), Self::allowed(), "write it for each channel");
            report.fault(node.trail(), words);
            return None;
        }
        <[Reflectance; 3]>::decode(node, report).map(Self::Linear)
    }
}

impl JsonSchema for RawAlbedo {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Albedo".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "anyOf": [
                generator.subschema_for::<HexColour>(),
                generator.subschema_for::<[Reflectance; 3]>(),
            ],
        })
    }
}
