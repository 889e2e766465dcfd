//! Embedded profiles change what is decoded by the amount that their definition says.

use std::{borrow::Cow, fs, path::Path};

use glam::DVec3;
use png::{BitDepth, ColorType, Info};
use recto::{
    colour,
    maps::{self, ColourEncoding, Texels},
};

use super::{channel, files_below, folder, support::data};
use crate::test_name;

/// Writes 8-bit pixels (grey or RGB) with an embedded profile.
fn save(path: &Path, pixels: &[u8], rgb: bool, icc: &[u8]) {
    let channels = if rgb { 3 } else { 1 };
    let mut info = Info::with_size((pixels.len() / channels) as u32, 1);
    info.color_type = if rgb {
        ColorType::Rgb
    } else {
        ColorType::Grayscale
    };
    info.bit_depth = BitDepth::Eight;
    info.icc_profile = Some(Cow::Borrowed(icc));
    let file = fs::File::create(path).expect("created");
    let encoder = png::Encoder::with_info(file, info).expect("an encoder");
    encoder
        .write_header()
        .expect("a header")
        .write_image_data(pixels)
        .expect("pixels");
}

const PIXELS: [[u8; 3]; 7] = [
    [255, 255, 255],
    [128, 128, 128],
    [200, 100, 50],
    [30, 60, 90],
    [0, 255, 0],
    [255, 0, 0],
    [0, 0, 255],
];

/// Profiles round their matrices to 1/65536, nine numbers after an inverse of size 3.
const ROUNDED: f64 = 3e-4;
/// Half floats hold 11 bits, of values up to 1.7 here.
const HALF: f64 = 1.7 / 4096.0;

#[test]
fn profiles_agree_with_the_closed_form_of_their_space() {
    let Some(root) = data(test_name!(), "icc") else {
        return;
    };
    let gamma = |g: f64| move |v: f64| v.powf(g);
    let p3 = [[0.680, 0.320], [0.265, 0.690], [0.150, 0.060]];
    let adobe = [[0.64, 0.33], [0.21, 0.71], [0.15, 0.06]];
    let rec2020 = [[0.708, 0.292], [0.170, 0.797], [0.131, 0.046]];
    type Curve = Box<dyn Fn(f64) -> f64>;
    let cases: [(&str, [[f64; 2]; 3], Curve); 4] = [
        ("DisplayP3-v4.icc", p3, Box::new(colour::srgb_decode)),
        ("AdobeCompat-v4.icc", adobe, Box::new(gamma(563.0 / 256.0))),
        ("Rec2020-g24-v4.icc", rec2020, Box::new(gamma(2.4))),
        (
            "sRGB-v4.icc",
            colour::SRGB_PRIMARIES,
            Box::new(colour::srgb_decode),
        ),
    ];
    let folder = folder();
    let path = folder.path().join("patches.png");
    for (name, primaries, curve) in cases {
        let icc = fs::read(root.join(name)).expect(name);
        save(&path, PIXELS.as_flattened(), true, &icc);
        let map = maps::load_colour(&path, ColourEncoding::Embedded).expect(name);
        let outside = matches!(map.levels[0].texels, Texels::Half(_));
        // Only a wide space leaves sRGB.
        assert_eq!(outside, !name.starts_with("sRGB"), "{name}");
        let to_xyz = colour::xyz_from_rgb_matrix(primaries, colour::D65);
        for (i, pixel) in PIXELS.iter().enumerate() {
            let device = DVec3::from(pixel.map(|v| curve(f64::from(v) / 255.0)));
            let expected = colour::linear_from_xyz((to_xyz * device).into());
            for c in 0..3 {
                let found = f64::from(channel(&map, 0, c)[i]);
                let error = (found - expected[c]).abs();
                assert!(
                    error < ROUNDED + HALF,
                    "{name} {pixel:?}: {found} not {expected:?}"
                );
            }
        }
        // A declared encoding overrides the profile.
        let declared = maps::load_colour(&path, ColourEncoding::Srgb).expect(name);
        let found = f64::from(channel(&declared, 0, 0)[2]);
        assert!((found - colour::srgb_decode(200.0 / 255.0)).abs() < 1e-5);
    }
}

#[test]
fn every_profile_shows_white_as_white_or_is_refused_by_name() {
    let Some(root) = data(test_name!(), "icc") else {
        return;
    };
    let folder = folder();
    let path = folder.path().join("white.png");
    let (mut rgb, mut grey) = (0, 0);
    for profile in files_below(&root)
        .iter()
        .filter(|p| p.extension().is_some_and(|e| e == "icc"))
    {
        let icc = fs::read(profile).expect("read");
        let name = profile.file_name().expect("a name").to_string_lossy();
        let cmyk = name.starts_with("CGATS");
        for is_rgb in [true, false] {
            save(&path, &[255; 3], is_rgb, &icc);
            let expected = !cmyk && is_rgb != name.starts_with("sGrey");
            match maps::load_colour(&path, ColourEncoding::Embedded) {
                Ok(map) => {
                    assert!(expected, "{name} was used for the wrong channels");
                    for c in 0..3 {
                        let white = f64::from(channel(&map, 0, c)[0]);
                        assert!((white - 1.0).abs() < ROUNDED + HALF, "{name}: {white}");
                    }
                    *(if is_rgb { &mut rgb } else { &mut grey }) += 1;
                }
                Err(error) => {
                    assert!(!expected, "{name}: {error}");
                    assert!(
                        error
                            .to_string()
                            .contains("white.png: its embedded colour profile")
                    );
                }
            }
        }
    }
    assert_eq!((rgb, grey), (39, 4));
}

#[test]
fn a_grey_profile_bends_greys() {
    let Some(root) = data(test_name!(), "icc/sGrey-v4.icc") else {
        return;
    };
    let folder = folder();
    let path = folder.path().join("grey.png");
    save(&path, &[0, 128, 255], false, &fs::read(root).expect("read"));
    let map = maps::load_colour(&path, ColourEncoding::Embedded).expect("read");
    let expected = colour::srgb_decode(128.0 / 255.0);
    for c in 0..3 {
        let grey = f64::from(channel(&map, 0, c)[1]);
        assert!((grey - expected).abs() < ROUNDED, "{grey} not {expected}");
    }
}

#[test]
fn a_broken_profile_names_the_file_and_the_remedy() {
    let folder = folder();
    let path = folder.path().join("broken.png");
    save(
        &path,
        &[255; 3],
        true,
        b"this is no profile at all, and much too short",
    );
    let error = maps::load_colour(&path, ColourEncoding::Embedded).expect_err("broken");
    let line = error.to_string();
    assert!(
        line.contains("broken.png: its embedded colour profile cannot be used"),
        "{line}"
    );
    assert!(
        line.contains("declare the encoding") && !line.contains('\n'),
        "{line}"
    );
    assert_eq!(
        maps::verify_colour(&path, ColourEncoding::Embedded)
            .expect_err("broken")
            .to_string(),
        line
    );
    maps::load_colour(&path, ColourEncoding::Srgb).expect("the profile is not needed");
    let Some(good) = data(test_name!(), "icc/sRGB-v4.icc") else {
        return;
    };
    // Cut short at every length: an error or a picture, never a panic.
    let good = fs::read(good).expect("read");
    for length in 0..good.len() {
        save(&path, &[255; 3], true, &good[..length]);
        let _ = maps::load_colour(&path, ColourEncoding::Embedded);
    }
}
