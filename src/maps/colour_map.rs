//! Colour maps for continuous overlays.

use super::ColourMapName;
use crate::colour;

/// Colours at equal steps from 0 to 1, 8-bit sRGB. Between them CIELAB is interpolated, within
/// ΔE00 2 of the full tables. Viridis and magma: N. Smith and S. van der Walt (CC0). Cividis:
/// J. Nuñez, C. Anderton and R. Renslow, *PLOS ONE* 13 (2018) e0199239.
const VIRIDIS: [[u8; 3]; 10] = [
    [0x44, 0x01, 0x54],
    [0x48, 0x28, 0x78],
    [0x3e, 0x4a, 0x89],
    [0x31, 0x68, 0x8e],
    [0x26, 0x82, 0x8e],
    [0x1f, 0x9e, 0x89],
    [0x35, 0xb7, 0x79],
    [0x6e, 0xce, 0x58],
    [0xb5, 0xde, 0x2b],
    [0xfd, 0xe7, 0x25],
];
const MAGMA: [[u8; 3]; 10] = [
    [0x00, 0x00, 0x04],
    [0x18, 0x0f, 0x3d],
    [0x44, 0x0f, 0x76],
    [0x72, 0x1f, 0x81],
    [0x9e, 0x2f, 0x7f],
    [0xcd, 0x40, 0x71],
    [0xf1, 0x60, 0x5d],
    [0xfd, 0x96, 0x68],
    [0xfe, 0xca, 0x8d],
    [0xfc, 0xfd, 0xbf],
];
const CIVIDIS: [[u8; 3]; 10] = [
    [0x00, 0x22, 0x4e],
    [0x12, 0x35, 0x70],
    [0x3b, 0x49, 0x6c],
    [0x57, 0x5d, 0x6d],
    [0x70, 0x71, 0x73],
    [0x8a, 0x86, 0x78],
    [0xa5, 0x9c, 0x74],
    [0xc3, 0xb3, 0x69],
    [0xe1, 0xcc, 0x55],
    [0xfe, 0xe8, 0x38],
];
/// Blue and red as dark as each other, with white between them: own choice, apart for all common
/// colour blindnesses.
const DIVERGING: [[u8; 3]; 5] = [
    [0x1b, 0x3f, 0x8f],
    [0x7f, 0xa6, 0xd8],
    [0xf5, 0xf4, 0xf2],
    [0xe3, 0x93, 0x79],
    [0x8e, 0x1c, 0x24],
];
const GREY: [[u8; 3]; 2] = [[0; 3], [255; 3]];

impl ColourMapName {
    /// The linear sRGB colour of `value`, which is clamped to 0…1 (NaN to 0). CIELAB lightness
    /// rises with it, but for that of [`Diverging`](Self::Diverging), which is highest in the
    /// middle and falls alike on both sides.
    pub fn colour(self, value: f64) -> [f64; 3] {
        let anchors: &[[u8; 3]] = match self {
            Self::Viridis => &VIRIDIS,
            Self::Magma => &MAGMA,
            Self::Cividis => &CIVIDIS,
            Self::Grey => &GREY,
            Self::Diverging => &DIVERGING,
        };
        let value = if value.is_nan() {
            0.0
        } else {
            value.clamp(0.0, 1.0)
        };
        let place = value * (anchors.len() - 1) as f64;
        // The last interval includes its end.
        let i = (place as usize).min(anchors.len() - 2);
        let share = place - i as f64;
        let lab = |i: usize| colour::lab_from_linear(colour::linear_from_srgb8(anchors[i]));
        let (low, high) = (lab(i), lab(i + 1));
        let mean = std::array::from_fn(|c| low[c] + share * (high[c] - low[c]));
        // Straight lines in CIELAB may just leave the gamut.
        colour::linear_from_lab(mean).map(|v| v.clamp(0.0, 1.0))
    }
}
