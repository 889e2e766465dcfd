//! Colour functions against published numbers.

use recto::colour::{self, D50, D65};

/// Pairs and differences of G. Sharma, W. Wu and E. Dalal, *Color Research & Application* 30
/// (2005) 21, table 1: those that catch hue means, discontinuities and large differences.
const SHARMA: [([f64; 3], [f64; 3], f64); 12] = [
    ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
    ([50.0, 3.1571, -77.2803], [50.0, 0.0, -82.7485], 2.8615),
    ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0000),
    ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
    ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0009], 7.1792),
    ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0011], 7.2195),
    ([50.0, -0.0010, 2.4900], [50.0, 0.0011, -2.4900], 4.7461),
    ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
    ([50.0, 2.5, 0.0], [58.0, 24.0, 15.0], 19.4535),
    (
        [60.2574, -34.0099, 36.2677],
        [60.4626, -34.1751, 39.4387],
        1.2644,
    ),
    (
        [22.7233, 20.0904, -46.6940],
        [23.0331, 14.9730, -42.5619],
        2.0373,
    ),
    (
        [2.0776, 0.0795, -1.1350],
        [0.9033, -0.0636, -0.5514],
        0.9082,
    ),
];

#[test]
fn delta_e00_agrees_with_sharma() {
    /// The table has four decimals.
    const ROUNDED: f64 = 5.1e-5;
    for (a, b, expected) in SHARMA {
        for (a, b) in [(a, b), (b, a)] {
            let found = colour::delta_e00(a, b);
            assert!(
                (found - expected).abs() < ROUNDED,
                "{a:?} {b:?}: {found} not {expected}"
            );
        }
    }
}

#[test]
fn srgb_is_that_of_the_standard() {
    // IEC 61966-2-1: code 10 is the last on the straight part, 11 the first on the curve.
    assert_eq!(colour::srgb_decode(10.0 / 255.0), 10.0 / 255.0 / 12.92);
    assert!((colour::srgb_decode(11.0 / 255.0) - 0.003_346_535_763_899_16).abs() < 1e-15);
    assert!((colour::srgb_decode(0.5) - 0.214_041_140_482_232_55).abs() < 1e-15);
    assert_eq!(
        [colour::srgb_decode(0.0), colour::srgb_decode(1.0)],
        [0.0, 1.0]
    );
    for code in 0..=255u8 {
        let linear = colour::linear_from_srgb8([code; 3]);
        assert_eq!(colour::srgb8_from_linear(linear), [code; 3]);
    }
    for v in [-0.7, -0.001, 0.2, 1.8] {
        assert!(
            (colour::srgb_decode(colour::srgb_encode(v)) - v).abs() < 1e-7,
            "{v}"
        );
    }
    assert_eq!(
        colour::srgb8_from_linear([-1.0, f64::NAN, 7.0]),
        [0, 0, 255]
    );
}

#[test]
fn primaries_give_the_standard_matrix() {
    // IEC 61966-2-1 prints four decimals.
    let standard = [
        [0.4124, 0.2126, 0.0193],
        [0.3576, 0.7152, 0.1192],
        [0.1805, 0.0722, 0.9505],
    ];
    for (i, column) in standard.into_iter().enumerate() {
        let mut unit = [0.0; 3];
        unit[i] = 1.0;
        let xyz = colour::xyz_from_linear(unit);
        assert!(
            xyz.iter().zip(column).all(|(a, b)| (a - b).abs() < 1e-4),
            "{xyz:?}"
        );
    }
}

#[test]
fn lab_round_trips_and_white_is_100() {
    let white = colour::white_xyz(D65);
    let [l, a, b] = colour::lab_from_xyz(white, white);
    assert!((l - 100.0).abs() < 1e-12 && a.abs() < 1e-12 && b.abs() < 1e-12);
    // Y = 0.184187 is L* = 50 (CIE 15).
    let [l, ..] = colour::lab_from_xyz([0.2, 0.184_186_518_512_444_16, 0.1], white);
    assert!((l - 50.0).abs() < 1e-9, "{l}");
    for xyz in [[0.3, 0.2, 0.1], [0.001, 0.002, 0.0005], [-0.01, 0.5, 0.9]] {
        let back = colour::xyz_from_lab(colour::lab_from_xyz(xyz, white), white);
        assert!(
            back.iter().zip(xyz).all(|(a, b)| (a - b).abs() < 1e-12),
            "{back:?}"
        );
    }
}

#[test]
fn bradford_moves_the_white() {
    // B. Lindbloom publishes D50 → D65 for ASTM's D65, whose Z is 1.0888 and not sRGB's 1.0891.
    const OTHER_WHITE: f64 = 1e-3;
    let m = colour::bradford(D50, D65).transpose();
    let expected = [
        [0.9555766, -0.0230393, 0.0631636],
        [-0.0282895, 1.0099416, 0.0210077],
        [0.0122982, -0.0204830, 1.3299098],
    ];
    for (row, expected) in [m.x_axis, m.y_axis, m.z_axis].into_iter().zip(expected) {
        assert!(
            row.to_array()
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < OTHER_WHITE),
            "{row}"
        );
    }
}

#[test]
fn temperatures_have_their_published_chromaticities() {
    // CIE 15:2018: illuminant A (2856 K), D50, D65 and D93 by their correlated temperatures.
    for (kelvin, [x, y], within) in [
        (2856.0, [0.44757, 0.40745], 4e-4),
        (5003.0, D50, 2e-4),
        (6504.0, D65, 2e-4),
        (9305.0, [0.28315, 0.29711], 2e-4),
    ] {
        let [fx, fy] = colour::kelvin_to_xy(kelvin);
        assert!(
            (fx - x).abs() < within && (fy - y).abs() < within,
            "{kelvin} K: {fx} {fy}"
        );
    }
    // Continuous where one locus gives way to the other, and clamped at the ends.
    for kelvin in [4000.0, 5000.0, 7000.0] {
        let [a, b] = [kelvin - 0.01, kelvin + 0.01].map(colour::kelvin_to_xy);
        assert!(
            (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-4,
            "{kelvin} K: {a:?} {b:?}"
        );
    }
    assert_eq!(colour::kelvin_to_xy(10.0), colour::kelvin_to_xy(1000.0));
    assert_eq!(colour::kelvin_to_xy(1e9), colour::kelvin_to_xy(25000.0));
}

#[test]
fn lamps_are_neutral_under_their_own_white_and_of_unit_luminance() {
    for kelvin in [1500.0, 3000.0, 4500.0, 6504.0, 20000.0] {
        assert_eq!(colour::lamp_rgb(kelvin, kelvin), [1.0; 3]);
        for white in [2700.0, 5000.0, 6504.0] {
            let luminance = colour::luminance(colour::lamp_rgb(kelvin, white));
            assert!(
                (luminance - 1.0).abs() < 1e-12,
                "{kelvin} K under {white} K: {luminance}"
            );
        }
    }
    let [r, g, b] = colour::lamp_rgb(2700.0, 6504.0);
    assert!(
        r > 1.3 && g < 1.0 && b < 0.5,
        "warm light is orange: {r} {g} {b}"
    );
    let [r, _, b] = colour::lamp_rgb(10000.0, 5000.0);
    assert!(r < 1.0 && b > 1.0, "cold light is blue: {r} {b}");
}

#[test]
fn hex_is_strict() {
    assert_eq!(colour::parse_hex("#3b2A1a"), Some([0x3b, 0x2a, 0x1a]));
    assert_eq!(colour::format_hex([0x3b, 0x2a, 0x01]), "#3b2a01");
    for wrong in [
        "", "#", "3b2a1a", "#3b2a1", "#3b2a1a0", "#+b2a1a", "#3b2a1g", "#é2a1a",
    ] {
        assert_eq!(colour::parse_hex(wrong), None, "{wrong}");
    }
}

#[test]
fn colour_maps_rise_in_lightness() {
    use recto::maps::ColourMapName::{Cividis, Grey, Magma, Viridis};
    for map in [Viridis, Magma, Cividis, Grey] {
        let lightness = |i: i32| colour::lab_from_linear(map.colour(f64::from(i) / 1000.0))[0];
        for i in 0..1000 {
            assert!(lightness(i) < lightness(i + 1), "{map:?} falls at {i}/1000");
        }
        assert_eq!(map.colour(f64::NAN), map.colour(0.0));
        assert_eq!(map.colour(9.0), map.colour(1.0));
    }
    // Less and more of a signed value are as dark as each other, step by step.
    let diverging = recto::maps::ColourMapName::Diverging;
    let lightness = |share: f64| colour::lab_from_linear(diverging.colour(share))[0];
    for i in 0..500 {
        let [left, right] = [i, 1000 - i].map(|i| lightness(f64::from(i) / 1000.0));
        assert!((left - right).abs() < 3.0, "{i}: {left} {right}");
        assert!(left < lightness(f64::from(i + 1) / 1000.0), "{i}");
    }
    assert_eq!(
        colour::srgb8_from_linear(Viridis.colour(0.0)),
        [0x44, 0x01, 0x54]
    );
    assert_eq!(
        colour::srgb8_from_linear(Viridis.colour(1.0)),
        [0xfd, 0xe7, 0x25]
    );
}
