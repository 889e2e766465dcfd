//! Codes of 16 bits, sRGB-encoded, and the linear light that they stand for, for whole maps.

use glam::DVec3;

use crate::colour::{srgb_decode, srgb_encode};

/// Linear light → codes of 16 bits, sRGB-encoded: straight lines between values of
/// [`srgb_encode`], 256 in each octave, which are 0.03 of a code off at most.
pub(super) struct SrgbCodes {
    /// From [`Self::FROM`] on, up to 1.
    table: Vec<f32>,
}

impl SrgbCodes {
    /// Below, sRGB is a straight line.
    const FROM: f32 = 1.0 / 512.0;
    /// Of a float's mantissa, the bits within a piece.
    const WITHIN: u32 = 15;

    pub fn new() -> Self {
        let (first, last) = (Self::piece(Self::FROM), Self::piece(1.0));
        let code = |piece: u32| {
            let linear = f32::from_bits(piece << Self::WITHIN);
            (srgb_encode(f64::from(linear)) * 65535.0) as f32
        };
        Self {
            table: (first..=last + 1).map(code).collect(),
        }
    }

    fn piece(linear: f32) -> u32 {
        linear.to_bits() >> Self::WITHIN
    }

    /// The nearest code; what is not a number is black.
    pub fn of(&self, linear: f32) -> u16 {
        if linear >= 1.0 {
            u16::MAX
        } else if linear >= Self::FROM {
            let piece = (Self::piece(linear) - Self::piece(Self::FROM)) as usize;
            let within = linear.to_bits() & ((1 << Self::WITHIN) - 1);
            let share = within as f32 / (1 << Self::WITHIN) as f32;
            let (a, b) = (self.table[piece], self.table[piece + 1]);
            (a + (b - a) * share + 0.5) as u16
        } else if linear > 0.0 {
            (srgb_encode(f64::from(linear)) * 65535.0 + 0.5) as u16
        } else {
            0
        }
    }
}

/// The linear light of each code.
pub(super) struct LinearCodes(Vec<f32>);

impl LinearCodes {
    pub fn new() -> Self {
        let value = |code: u32| srgb_decode(f64::from(code) / 65535.0) as f32;
        Self((0..1 << 16).map(value).collect())
    }

    pub fn of(&self, code: u16) -> f32 {
        self.0[usize::from(code)]
    }
}

/// Linear light of sRGB-encoded codes.
pub(super) fn linear(rgb: [u16; 3]) -> DVec3 {
    DVec3::from(rgb.map(|v| srgb_decode(f64::from(v) / 65535.0)))
}

/// The nearest codes of linear light.
pub(super) fn encoded(linear: DVec3) -> [u16; 3] {
    // Casts saturate.
    let encode = |v: f64| (srgb_encode(v).clamp(0.0, 1.0) * 65535.0).round() as u16;
    linear.to_array().map(encode)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_the_nearest_to_a_tenth() {
        let codes = SrgbCodes::new();
        let mut linear = 1e-6f32;
        while linear < 1.1 {
            let exact = srgb_encode(f64::from(linear.min(1.0))) * 65535.0;
            let off = (f64::from(codes.of(linear)) - exact).abs();
            assert!(off < 0.6, "{linear}: {off}");
            linear *= 1.0003;
        }
        for (linear, code) in [
            (0.0, 0),
            (-1.0, 0),
            (f32::NAN, 0),
            (1.0, 65535),
            (f32::INFINITY, 65535),
        ] {
            assert_eq!(codes.of(linear), code, "{linear}");
        }
    }
}
