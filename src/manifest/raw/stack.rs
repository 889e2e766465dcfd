//! Stacks of bands as written.

use super::{
    super::{
        decode::{Dictionary, List, Rule},
        exhibit::{SideName, Source},
        macros::{placed_record, record},
    },
    RawControlPoint, RawRegister, RawWording,
    values::{BandKey, BandNm, FilePath, Id, Reflectance, Weight},
};
use crate::maps::{ColourEncoding, registration::FitKind};

/// The most bands of one stack.
pub const MAX_BANDS: usize = 64;

placed_record! {
    /// Pictures of one side in several bands of light, each of how much it reflects there.
    pub struct RawStack {
        required {
            /// The name by which scenes refer to the stack: its band of 700 nm is ID/700.
            id: Id,
            /// The bands, in any order.
            bands: List<RawBand, 1, MAX_BANDS>,
        }
        optional {
            /// What the stack is called.
            title: RawWording,
            /// The side that it belongs to. Without it: recto.
            side: SideName,
            /// How its pictures' values encode reflectance. Without it: by the embedded ICC
            /// profile, or else sRGB for integers and linear for floats.
            encoding: ColourEncoding,
            /// Bands shown as red, green and blue.
            false_colour: List<RawFalseColour>,
            /// Bands shown against each other.
            difference: List<RawDifference>,
        }
        placed by {
            /// How the bands lie on the sheet that do not say so themselves, where they do not
            /// cover it exactly.
            register,
            /// Points of these bands' pictures and where they lie on the sheet.
            control_points,
            /// Where it comes from. Without it: assumed.
            source,
        }
    }
}

placed_record! {
    /// One band.
    pub struct RawBand {
        required {
            /// The picture; of one in colour, its luminance counts.
            file: FilePath,
            /// The middle of the band in nm.
            wavelength_nm: BandNm,
        }
        optional {}
        placed by {
            /// How it lies on the sheet, where it does not lie as the stack says.
            register,
            /// Points of the picture and where they lie on the sheet.
            control_points,
            /// Where it comes from. Without it: as the stack says.
            source,
        }
    }
}

record! {
    /// Bands shown as red, green and blue: each the sum of reflectances times their weights.
    pub struct RawFalseColour {
        required {
            /// The name by which scenes refer to it: STACK/ID.
            id: Id,
            /// What shows as red: wavelengths of bands in nm, and their weights.
            red: Dictionary<BandKey, Weight, MAX_BANDS>,
            /// What shows as green.
            green: Dictionary<BandKey, Weight, MAX_BANDS>,
            /// What shows as blue.
            blue: Dictionary<BandKey, Weight, MAX_BANDS>,
        }
        optional {
            /// What it is called.
            title: RawWording,
        }
        rules []
    }
}

record! {
    /// One band less another, by a scale of colours from blue (less) over white to red (more).
    pub struct RawDifference {
        required {
            /// The name by which scenes refer to it: STACK/ID.
            id: Id,
            /// The wavelengths in nm of the band and of the one that is taken from it.
            of: [BandNm; 2],
        }
        optional {
            /// What it is called.
            title: RawWording,
            /// The difference of reflectance at both ends of the scale. Without it: 0.5.
            full: Reflectance,
        }
        rules []
    }
}
