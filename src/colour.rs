//! Colour: encodings, spaces, differences and the colour of lamps.
//!
//! | symbol | meaning |
//! |---|---|
//! | `linear` | linear light in the sRGB primaries, D65 white; 1 is a perfect diffuser; may leave \[0, 1\] |
//! | `encoded` | the same with the sRGB transfer function applied |
//! | `xyz` | CIE 1931 tristimulus values, Y = 1 for the white |
//! | `xy` | CIE 1931 chromaticity |
//! | `lab` | CIELAB (1976) under a white that is named beside it, L* in 0…100 |
//!
//! Sources: IEC 61966-2-1 (sRGB), CIE 15:2018 (CIELAB, daylight locus), ICC.1:2022 annex E
//! (Bradford), ANSI/IES TM-30-18 (which lamp colour belongs to a temperature), M. Krystek, *Color
//! Research & Application* 10 (1985) 38 (Planckian locus).

use std::sync::LazyLock;

use glam::{DMat3, DVec3};
use palette::color_difference::Ciede2000;

/// Chromaticity of D65 as IEC 61966-2-1 rounds it.
pub const D65: [f64; 2] = [0.3127, 0.3290];
/// Chromaticity of D50, the white of ICC's connection space.
pub const D50: [f64; 2] = [0.345_702_914_918_791, 0.358_538_596_679_933];
/// Chromaticities of red, green and blue of sRGB (and ITU-R BT.709).
pub const SRGB_PRIMARIES: [[f64; 2]; 3] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];
/// Colour temperatures outside this range in K are clamped to it.
pub const KELVIN_RANGE: [f64; 2] = [1000.0, 25000.0];

static XYZ_FROM_LINEAR: LazyLock<DMat3> =
    LazyLock::new(|| xyz_from_rgb_matrix(SRGB_PRIMARIES, D65));
static LINEAR_FROM_XYZ: LazyLock<DMat3> = LazyLock::new(|| XYZ_FROM_LINEAR.inverse());

/// One encoded sRGB value to linear light (IEC 61966-2-1). Domain: all reals, odd about 0 so
/// that values outside the gamut survive; 0 ↦ 0 and 1 ↦ 1.
pub fn srgb_decode(encoded: f64) -> f64 {
    let v = encoded.abs();
    let linear = if v <= 0.04045 {
        v / 12.92
    } else {
        ((v + 0.055) / 1.055).powf(2.4)
    };
    linear.copysign(encoded)
}

/// One linear value to encoded sRGB, the inverse of [`srgb_decode`] over all reals (within 1e-7
/// where the standard's two pieces meet).
pub fn srgb_encode(linear: f64) -> f64 {
    let v = linear.abs();
    let encoded = if v <= 0.0031308 {
        v * 12.92
    } else {
        1.055 * v.powf(1.0 / 2.4) - 0.055
    };
    encoded.copysign(linear)
}

/// A linear colour as 8-bit sRGB, clamped to the gamut and rounded to nearest; NaN becomes 0.
pub fn srgb8_from_linear(linear: [f64; 3]) -> [u8; 3] {
    // Rust's float-to-integer cast saturates and sends NaN to 0.
    linear.map(|v| (srgb_encode(v) * 255.0).round() as u8)
}

/// 8-bit sRGB to linear light.
pub fn linear_from_srgb8(encoded: [u8; 3]) -> [f64; 3] {
    encoded.map(|v| srgb_decode(f64::from(v) / 255.0))
}

/// The matrix from linear RGB of the given primaries and white (chromaticities, y > 0) to XYZ
/// with Y = 1 for the white. The primaries must not lie on one line.
pub fn xyz_from_rgb_matrix(primaries: [[f64; 2]; 3], white: [f64; 2]) -> DMat3 {
    // Not divided by y, which is 0 for the primaries of XYZ itself.
    let [r, g, b] = primaries.map(|[x, y]| DVec3::new(x, y, 1.0 - x - y));
    let directions = DMat3::from_cols(r, g, b);
    let amounts = directions.inverse() * DVec3::from(white_xyz(white));
    directions * DMat3::from_diagonal(amounts)
}

/// Linear sRGB to XYZ (D65 white, Y = 1).
pub fn xyz_from_linear(linear: [f64; 3]) -> [f64; 3] {
    (*XYZ_FROM_LINEAR * DVec3::from(linear)).into()
}

/// XYZ (D65 white, Y = 1) to linear sRGB; negative where the colour lies outside the gamut.
pub fn linear_from_xyz(xyz: [f64; 3]) -> [f64; 3] {
    (*LINEAR_FROM_XYZ * DVec3::from(xyz)).into()
}

/// The matrix from XYZ (D65 white, Y = 1) to linear sRGB.
pub fn linear_from_xyz_matrix() -> DMat3 {
    *LINEAR_FROM_XYZ
}

/// Luminance (Y) of a linear sRGB colour.
pub fn luminance(linear: [f64; 3]) -> f64 {
    xyz_from_linear(linear)[1]
}

/// xyY to XYZ. Domain: y ≠ 0; y = 0 gives black.
pub fn xyz_from_xyy([x, y, luminance]: [f64; 3]) -> [f64; 3] {
    if y == 0.0 {
        return [0.0; 3];
    }
    [x / y * luminance, luminance, (1.0 - x - y) / y * luminance]
}

/// XYZ to xyY; black has no chromaticity and gets that of D65.
pub fn xyy_from_xyz([x, y, z]: [f64; 3]) -> [f64; 3] {
    let sum = x + y + z;
    if sum == 0.0 {
        [D65[0], D65[1], 0.0]
    } else {
        [x / sum, y / sum, y]
    }
}

/// XYZ of a white of this chromaticity with Y = 1.
pub fn white_xyz(xy: [f64; 2]) -> [f64; 3] {
    xyz_from_xyy([xy[0], xy[1], 1.0])
}

/// XYZ to CIELAB under `white` (XYZ with Y = 1). Domain: all reals; L* is 0…100 for Y in 0…1.
pub fn lab_from_xyz(xyz: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let f = |i: usize| {
        let t: f64 = xyz[i] / white[i];
        if t > (6.0f64 / 29.0).powi(3) {
            t.cbrt()
        } else {
            t * (29.0f64 / 6.0).powi(2) / 3.0 + 4.0 / 29.0
        }
    };
    let (fx, fy, fz) = (f(0), f(1), f(2));
    [116.0 * fy - 16.0, 500.0 * (fx - fy), 200.0 * (fy - fz)]
}

/// CIELAB under `white` (XYZ with Y = 1) to XYZ, the inverse of [`lab_from_xyz`].
pub fn xyz_from_lab([l, a, b]: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let fy = (l + 16.0) / 116.0;
    let f = [fy + a / 500.0, fy, fy - b / 200.0];
    std::array::from_fn(|i| {
        let t = if f[i] > 6.0 / 29.0 {
            f[i].powi(3)
        } else {
            3.0 * (6.0f64 / 29.0).powi(2) * (f[i] - 4.0 / 29.0)
        };
        t * white[i]
    })
}

/// CIELAB (D65 white) of a linear sRGB colour.
pub fn lab_from_linear(linear: [f64; 3]) -> [f64; 3] {
    lab_from_xyz(xyz_from_linear(linear), white_xyz(D65))
}

/// Linear sRGB of a CIELAB colour under D65.
pub fn linear_from_lab(lab: [f64; 3]) -> [f64; 3] {
    linear_from_xyz(xyz_from_lab(lab, white_xyz(D65)))
}

/// Colour difference ΔE00 (CIE 142-2001, all weights 1) of two CIELAB colours under one white.
pub fn delta_e00(a: [f64; 3], b: [f64; 3]) -> f64 {
    // The white is a label to `palette`; the formula does not use it.
    type Lab = palette::Lab<palette::white_point::D65, f64>;
    Lab::from(a).difference(Lab::from(b))
}

/// The matrix that adapts XYZ from one white to another (chromaticities), linear Bradford.
pub fn bradford(from_xy: [f64; 2], to_xy: [f64; 2]) -> DMat3 {
    // ICC.1:2022, annex E.3, rows written as columns.
    let cone = DMat3::from_cols_array(&[
        0.8951, -0.7502, 0.0389, 0.2664, 1.7135, -0.0685, -0.1614, 0.0367, 1.0296,
    ]);
    let from = cone * DVec3::from(white_xyz(from_xy));
    let to = cone * DVec3::from(white_xyz(to_xy));
    cone.inverse() * DMat3::from_diagonal(to / from) * cone
}

/// Writes 8-bit sRGB as `#rrggbb`.
pub fn format_hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Reads `#rrggbb`, in either case of letters; `None` for anything else.
pub fn parse_hex(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#')?;
    if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    let value = u32::from_str_radix(digits, 16).ok()?;
    let [_, r, g, b] = value.to_be_bytes();
    Some([r, g, b])
}

/// Chromaticity of a lamp of this correlated colour temperature: Planckian up to 4000 K, CIE
/// daylight from 5000 K, and a mixture of equal luminance between, as TM-30 defines its
/// reference, so that the colour is continuous in `kelvin`. Clamped to [`KELVIN_RANGE`].
pub fn kelvin_to_xy(kelvin: f64) -> [f64; 2] {
    let t = kelvin.clamp(KELVIN_RANGE[0], KELVIN_RANGE[1]);
    let daylight_share = ((t - 4000.0) / 1000.0).clamp(0.0, 1.0);
    if daylight_share == 0.0 {
        return planckian_xy(t);
    }
    let planckian = DVec3::from(white_xyz(planckian_xy(t.min(5000.0))));
    let daylight = DVec3::from(white_xyz(daylight_xy(t)));
    let [x, y, _] = xyy_from_xyz(planckian.lerp(daylight, daylight_share).into());
    [x, y]
}

/// Planckian locus by Krystek's rational fit in CIE 1960 (u, v), 1000…15000 K, within 1e-4.
fn planckian_xy(t: f64) -> [f64; 2] {
    let u = (0.860117757 + 1.54118254e-4 * t + 1.28641212e-7 * t * t)
        / (1.0 + 8.42420235e-4 * t + 7.08145163e-7 * t * t);
    let v = (0.317398726 + 4.22806245e-5 * t + 4.20481691e-8 * t * t)
        / (1.0 - 2.89741816e-5 * t + 1.61456053e-7 * t * t);
    let d = 2.0 * u - 8.0 * v + 4.0;
    [3.0 * u / d, 2.0 * v / d]
}

/// CIE daylight locus (CIE 15:2018, 4.1.2), 4000…25000 K.
fn daylight_xy(t: f64) -> [f64; 2] {
    let k = 1e3 / t;
    let x = if t <= 7000.0 {
        0.244063 + k * (0.09911 + k * (2.9678 - k * 4.6070))
    } else {
        0.237040 + k * (0.24748 + k * (1.9018 - k * 2.0064))
    };
    [x, -3.000 * x * x + 2.870 * x - 0.275]
}

/// Linear sRGB of a lamp of unit luminance whose temperature is `kelvin`, as somebody sees it
/// whose eye has adapted to `white_kelvin` (Bradford): exactly `[1, 1, 1]` where both agree, and
/// always of luminance 1. A deep red lamp can lie outside the gamut and have a negative blue.
pub fn lamp_rgb(kelvin: f64, white_kelvin: f64) -> [f64; 3] {
    lamp_xy_rgb(kelvin_to_xy(kelvin), white_kelvin)
}

/// As [`lamp_rgb`], for a lamp of chromaticity `lamp` (y > 0).
pub fn lamp_xy_rgb(lamp: [f64; 2], white_kelvin: f64) -> [f64; 3] {
    let white = kelvin_to_xy(white_kelvin);
    if lamp == white {
        return [1.0; 3];
    }
    let adapted = bradford(white, D65) * DVec3::from(white_xyz(lamp));
    // Adaptation changes Y a little; photometry must not.
    linear_from_xyz((adapted / adapted.y).into())
}
