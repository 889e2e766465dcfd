//! Lamps as written.

use super::{
    super::{
        decode::{Brief, List, OfKind, Rule},
        macros::{kinds, record},
    },
    RawWording,
    values::{
        ConeDeg, DistanceMm, ElevationDeg, FilePath, Id, LampCandela, LampEfficacy, LampLumen,
        LampLux, LampMm, LampNits, LampWatts, PositionMm, SpectralPower, Temperature, TurnDeg,
        WavelengthNm,
    },
};
use crate::optics::spectrum::{Illuminant, MAX_POINTS};

/// A light source.
pub type RawLamp = OfKind<RawLampCommon, RawLampKind>;

record! {
    /// A light source.
    pub struct RawLampCommon {
        required {
            /// The name by which scenes refer to the lamp.
            id: Id,
        }
        optional {
            /// What the lamp is called.
            title: RawWording,
            /// Its colour temperature in K. Without it: 6504, which is daylight.
            kelvin: Temperature,
            /// Instead of kelvin: its spectral power, as the name of an illuminant of the CIE or
            /// as a table. Its colour is computed from it.
            spectrum: Brief<Illuminant, RawSpectrum>,
        }
        rules [Rule::AtMostOne(&["kelvin", "spectrum"])]
    }
}

record! {
    /// The spectral power of a lamp, linear between the points that are given and none outside.
    pub struct RawSpectrum {
        required {}
        optional {
            /// Rising wavelengths in nm.
            wavelengths_nm: List<WavelengthNm, 2, MAX_POINTS>,
            /// With wavelengths_nm: the power at each, in any unit per nm.
            power: List<SpectralPower, 2, MAX_POINTS>,
            /// A text file of two columns, wavelength in nm and power, instead.
            file: FilePath,
        }
        rules [
            Rule::ExactlyOne(&["wavelengths_nm", "file"]),
            Rule::Needs("wavelengths_nm", "power"),
            Rule::Needs("power", "wavelengths_nm"),
        ]
    }
}

kinds! {
    /// The kinds of lamp.
    pub enum RawLampKind {
        /// A lamp so far away that its light comes from one direction, as the sun's does.
        Distant(RawDistant) = "distant",
        /// A small lamp that shines in all directions.
        Point(RawPoint) = "point",
        /// A small lamp with a cone of light.
        Spot(RawSpot) = "spot",
        /// A shining rectangle, such as a soft box; its width lies parallel to the sheet.
        Rectangle(RawRectangle) = "rectangle",
        /// A shining disc.
        Disc(RawDisc) = "disc",
        /// A lamp as its photometric file (IES LM-63) describes it.
        Ies(RawIes) = "ies",
        /// A shining table behind the sheet.
        LightTable(RawLightTable) = "light-table",
    }
}

record! {
    /// A distant lamp.
    pub struct RawDistant {
        required {
            /// The illuminance in lx on a surface that faces the lamp.
            lux_at_sheet: LampLux,
            /// The angle in degrees above the plane of the sheet: 90 is straight above, 10 is
            /// raking.
            elevation_deg: ElevationDeg,
            /// Where the light comes from, in degrees: 0 right, 90 top, 180 left, 270 bottom.
            azimuth_deg: TurnDeg,
        }
        optional {}
        rules []
    }
}

/// Where a lamp stands that has a place; `None` is not given.
pub(crate) struct Stand {
    pub position_mm: Option<[PositionMm; 3]>,
    pub elevation_deg: Option<ElevationDeg>,
    pub azimuth_deg: Option<TurnDeg>,
    pub distance_mm: Option<DistanceMm>,
}

/// A record with the keys of a place added.
macro_rules! standing_lamp {
    (
        $(#[doc = $doc:literal])+
        pub struct $name:ident {
            required { $($required:tt)* }
            optional { $($optional:tt)* }
            rules [$($rule:expr),* $(,)?]
        }
    ) => {
        record! {
            $(#[doc = $doc])+
            pub struct $name {
                required { $($required)* }
                optional {
                    $($optional)*
                    /// Its place in mm from the centre of the sheet: right, up, towards the
                    /// viewer.
                    position_mm: [PositionMm; 3],
                    /// Instead of position_mm: the angle in degrees above the plane of the
                    /// sheet.
                    elevation_deg: ElevationDeg,
                    /// With elevation_deg: where the lamp is, in degrees: 0 right, 90 top, 180
                    /// left, 270 bottom.
                    azimuth_deg: TurnDeg,
                    /// With elevation_deg: the distance from the centre of the sheet in mm.
                    /// Without it: 600.
                    distance_mm: DistanceMm,
                }
                rules [
                    $($rule,)*
                    Rule::ExactlyOne(&["position_mm", "elevation_deg"]),
                    Rule::Needs("elevation_deg", "azimuth_deg"),
                    Rule::Needs("azimuth_deg", "elevation_deg"),
                    Rule::Needs("distance_mm", "elevation_deg"),
                ]
            }
        }

        impl $name {
            pub(crate) fn stand(&self) -> Stand {
                Stand {
                    position_mm: self.position_mm,
                    elevation_deg: self.elevation_deg,
                    azimuth_deg: self.azimuth_deg,
                    distance_mm: self.distance_mm,
                }
            }
        }
    };
}

standing_lamp! {
    /// A point lamp.
    pub struct RawPoint {
        required {}
        optional {
            /// The illuminance in lx that it gives to the centre of the sheet, facing the lamp.
            lux_at_sheet: LampLux,
            /// Its intensity in cd.
            candela: LampCandela,
            /// Its whole light in lm.
            lumen: LampLumen,
            /// The electric power that it takes, in W; its light follows by efficacy_lm_per_w.
            watts: LampWatts,
            /// With watts: the light that it gives for each watt, in lm/W, as its maker states:
            /// about 15 for halogen, 80 to 150 for LED. 683 is the most there can be.
            efficacy_lm_per_w: LampEfficacy,
        }
        rules [
            Rule::ExactlyOne(&["lux_at_sheet", "candela", "lumen", "watts"]),
            Rule::Needs("watts", "efficacy_lm_per_w"),
            Rule::Needs("efficacy_lm_per_w", "watts"),
        ]
    }
}

standing_lamp! {
    /// A spot lamp.
    pub struct RawSpot {
        required {
            /// Up to this angle from its axis, in degrees, it shines with full intensity.
            hotspot_deg: ConeDeg,
            /// From this angle from its axis on, in degrees, it gives no light.
            falloff_deg: ConeDeg,
        }
        optional {
            /// The illuminance in lx that it gives to the centre of the sheet, facing the lamp.
            lux_at_sheet: LampLux,
            /// Its intensity on the axis in cd.
            candela: LampCandela,
            /// Its whole light in lm.
            lumen: LampLumen,
            /// The electric power that it takes, in W; its light follows by efficacy_lm_per_w.
            watts: LampWatts,
            /// With watts: the light that it gives for each watt, in lm/W, as its maker states:
            /// about 15 for halogen, 80 to 150 for LED. 683 is the most there can be.
            efficacy_lm_per_w: LampEfficacy,
            /// What it shines at, in mm from the centre of the sheet: right, up, towards the
            /// viewer. Without it: the centre.
            aim_mm: [PositionMm; 3],
        }
        rules [
            Rule::ExactlyOne(&["lux_at_sheet", "candela", "lumen", "watts"]),
            Rule::Needs("watts", "efficacy_lm_per_w"),
            Rule::Needs("efficacy_lm_per_w", "watts"),
        ]
    }
}

standing_lamp! {
    /// A rectangular lamp.
    pub struct RawRectangle {
        required {
            /// Its width and height in mm.
            size_mm: [LampMm; 2],
        }
        optional {
            /// The illuminance in lx that it gives to the centre of the sheet, facing the lamp.
            lux_at_sheet: LampLux,
            /// Its luminance in cd/m².
            nits: LampNits,
            /// Its whole light in lm.
            lumen: LampLumen,
            /// The electric power that it takes, in W; its light follows by efficacy_lm_per_w.
            watts: LampWatts,
            /// With watts: the light that it gives for each watt, in lm/W, as its maker states:
            /// about 15 for halogen, 80 to 150 for LED. 683 is the most there can be.
            efficacy_lm_per_w: LampEfficacy,
            /// What it faces, in mm from the centre of the sheet: right, up, towards the viewer.
            /// Without it: the centre.
            aim_mm: [PositionMm; 3],
        }
        rules [
            Rule::ExactlyOne(&["lux_at_sheet", "nits", "lumen", "watts"]),
            Rule::Needs("watts", "efficacy_lm_per_w"),
            Rule::Needs("efficacy_lm_per_w", "watts"),
        ]
    }
}

standing_lamp! {
    /// A round lamp.
    pub struct RawDisc {
        required {
            /// Its diameter in mm.
            diameter_mm: LampMm,
        }
        optional {
            /// The illuminance in lx that it gives to the centre of the sheet, facing the lamp.
            lux_at_sheet: LampLux,
            /// Its luminance in cd/m².
            nits: LampNits,
            /// Its whole light in lm.
            lumen: LampLumen,
            /// The electric power that it takes, in W; its light follows by efficacy_lm_per_w.
            watts: LampWatts,
            /// With watts: the light that it gives for each watt, in lm/W, as its maker states:
            /// about 15 for halogen, 80 to 150 for LED. 683 is the most there can be.
            efficacy_lm_per_w: LampEfficacy,
            /// What it faces, in mm from the centre of the sheet: right, up, towards the viewer.
            /// Without it: the centre.
            aim_mm: [PositionMm; 3],
        }
        rules [
            Rule::ExactlyOne(&["lux_at_sheet", "nits", "lumen", "watts"]),
            Rule::Needs("watts", "efficacy_lm_per_w"),
            Rule::Needs("efficacy_lm_per_w", "watts"),
        ]
    }
}

standing_lamp! {
    /// A lamp as its file describes it.
    pub struct RawIes {
        required {
            /// The photometric file, IES LM-63.
            file: FilePath,
        }
        optional {
            /// What it faces, in mm from the centre of the sheet: right, up, towards the viewer.
            /// Without it: the centre.
            aim_mm: [PositionMm; 3],
        }
        rules []
    }
}

record! {
    /// A light table.
    pub struct RawLightTable {
        required {
            /// Its luminance in cd/m².
            nits: LampNits,
        }
        optional {}
        rules []
    }
}
