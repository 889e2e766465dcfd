//! Real files of every format: opened at full depth, or refused in one clear line.

use std::{collections::BTreeSet, fs, io::Cursor, path::Path};

use exr::prelude::read_first_flat_layer_from_file;
use glam::DVec3;
use recto::{
    colour,
    maps::{self, ColourEncoding, ColourMapName, MapError, Pyramid, Texels, encode, probe, verify},
};

use super::{channel, correlation, files_below, folder, mean, support::data};
use crate::test_name;

/// Which TIFF files are refused, by a word of the reason.
const REFUSED: [(&str, &[&str]); 5] = [
    (
        "CMYK",
        &["cmyk-3c-16b", "seq-4c-16b-cmyk", "flower-separated"],
    ),
    ("palette", &["flower-palette"]),
    ("photometric interpretation", &["logluv"]),
    (
        "signed integers",
        &["int16", "minisblack-1c-i16b", "seq-1c-i16"],
    ),
    (
        "bits per channel",
        &[
            "10b-planar",
            "12b-planar",
            "14b-planar",
            "24b-planar",
            "minisblack-06",
            "minisblack-10",
            "minisblack-12",
            "minisblack-14",
            "minisblack-24",
            "minisblack-32",
            "-02",
            "-04",
            "-10",
            "-12",
            "-14",
            "-24",
            "-32",
        ],
    ),
];

#[test]
fn every_tiff_opens_at_full_depth_or_is_refused_in_one_line() {
    let Some(root) = data(test_name!(), "tiff") else {
        return;
    };
    let (mut opened, mut refused) = (0, 0);
    for path in files_below(&root) {
        let name = path
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        if !name.ends_with(".tif") && !name.ends_with(".tiff") {
            continue;
        }
        match probe(&path) {
            Ok(header) => {
                let map = maps::load_colour(&path, ColourEncoding::Linear).expect(&name);
                let level = &map.levels[0];
                assert_eq!([level.width, level.height], header.size, "{name}");
                if name.contains("16b") || name.contains("-16.tif") || name.contains("fp16") {
                    assert_eq!(header.bits, 16, "{name}");
                }
                assert_eq!(
                    header.float,
                    name.contains("fp16") || name.contains("f32"),
                    "{name}"
                );
                assert_eq!(map.missing, 0, "{name}");
                opened += 1;
            }
            Err(error) => {
                let line = error.to_string();
                assert!(!line.contains('\n') && line.starts_with(&*path.to_string_lossy()));
                let known = |(word, names): &(&str, &[&str])| {
                    line.contains(word) && names.iter().any(|part| name.contains(part))
                };
                // Three signed bands have no kind of colour at all.
                assert!(
                    REFUSED.iter().any(known) || name.contains("seq-3c-i16"),
                    "{line}"
                );
                refused += 1;
            }
        }
    }
    assert_eq!((opened, refused), (33, 41), "(opened, refused)");
}

#[test]
fn tiff_values_do_not_depend_on_how_they_are_stored() {
    let Some(root) = data(test_name!(), "tiff") else {
        return;
    };
    let load =
        |name: &str| maps::load_colour(&root.join(name), ColourEncoding::Linear).expect(name);
    for (a, b) in [
        ("images/planar-rgb-u8.tif", "images/tiled-rgb-u8.tif"),
        ("images/random-fp16.tiff", "images/random-fp16-pred2.tiff"),
        ("images/random-fp16.tiff", "images/random-fp16-pred3.tiff"),
        (
            "images/bigtiff/BigTIFF.tif",
            "images/bigtiff/BigTIFFMotorola.tif",
        ),
        (
            "images/seq/seq-1c-16b-tiled-68f373a0.tiff",
            "images/seq/seq-1c-16b-lzw-68f373a0.tiff",
        ),
        (
            "libtiffpic_depth/flower-rgb-contig-16.tif",
            "libtiffpic_depth/flower-rgb-planar-16.tif",
        ),
    ] {
        assert!(load(a) == load(b), "{a} {b}");
    }
    // Its name says what it holds: 0, 1, 2 … in 16 bits.
    let Texels::Unorm16(values) = load("images/seq/seq-1c-16b-bigendian-68f373a0.tiff").levels[0]
        .texels
        .clone()
    else {
        panic!("16 bits stay 16 bits");
    };
    let first: Vec<u16> = values.iter().step_by(4).copied().collect();
    assert!(
        first
            .iter()
            .enumerate()
            .all(|(i, &v)| usize::from(v) == i % 256),
        "{first:?}"
    );
    // Packed greys keep their place between black and white.
    let [two, four, eight] = ["02", "04", "08"].map(|bits| {
        channel(
            &load(&format!("libtiffpic_depth/flower-minisblack-{bits}.tif")),
            0,
            0,
        )
    });
    // Cut to 4 and 16 steps from the picture of 8 bits.
    assert!(correlation(&two, &eight) > 0.9 && correlation(&four, &eight) > 0.99);
}

#[test]
fn exr_values_come_in_untouched() {
    let Some(root) = data(test_name!(), "exr") else {
        return;
    };
    for name in [
        "TestImages/GrayRampsHorizontal.exr",
        "TestImages/BrightRings.exr",
    ] {
        let path = root.join(name);
        let map = maps::load_colour(&path, ColourEncoding::Embedded).expect(name);
        let image = read_first_flat_layer_from_file(&path).expect(name);
        let list = &image.layer_data.channel_data.list;
        let red = list
            .iter()
            .find(|c| c.name.eq("R") || c.name.eq("Y"))
            .expect("a channel");
        let ours = channel(&map, 0, 0);
        let half = matches!(map.levels[0].texels, Texels::Half(_));
        // The files hold half floats; within 0…1 they are stored in 16 bits.
        let step = if half { 0.0 } else { 0.51 / 65535.0 };
        for (ours, theirs) in ours.iter().zip(red.sample_data.values_as_f32()) {
            assert!((ours - theirs).abs() <= step, "{name}: {ours} {theirs}");
        }
    }
}

#[test]
fn exr_primaries_are_converted_and_white_is_kept() {
    let Some(root) = data(test_name!(), "exr/Chromaticities") else {
        return;
    };
    let load =
        |name: &str| maps::load_colour(&root.join(name), ColourEncoding::Embedded).expect(name);
    let (rec709, xyz) = (load("Rec709.exr"), load("XYZ.exr"));
    // The same picture twice, stored in half floats: a few steps of them.
    const HALF_STEPS: f64 = 4.0 / 2048.0;
    for c in 0..3 {
        let (a, b) = (channel(&rec709, 0, c), channel(&xyz, 0, c));
        let worst = a
            .iter()
            .zip(&b)
            .map(|(a, b)| f64::from((a - b).abs() / a.abs().max(0.05)));
        let bad = worst.filter(|&error| error > 5.0 * HALF_STEPS).count();
        assert!(bad * 1000 < a.len(), "channel {c}: {bad} of {}", a.len());
    }
    for name in ["Rec709_YC.exr", "XYZ_YC.exr"] {
        let error = probe(&root.join(name)).expect_err("subsampled").to_string();
        assert!(error.contains("subsampled"), "{error}");
    }
}

#[test]
fn nan_and_infinity_never_leave_the_loader() {
    let Some(root) = data(test_name!(), "exr/TestImages") else {
        return;
    };
    for (name, some) in [
        ("BrightRingsNanInf.exr", true),
        ("AllHalfValues.exr", true),
        ("BrightRings.exr", false),
    ] {
        let path = root.join(name);
        let map = maps::load_colour(&path, ColourEncoding::Embedded).expect(name);
        assert_eq!(map.missing > 0, some, "{name}: {}", map.missing);
        assert_eq!(verify(&path).expect(name).count, map.missing);
        for level in 0..map.levels.len() {
            for c in 0..4 {
                assert!(
                    channel(&map, level, c).iter().all(|v| v.is_finite()),
                    "{name}"
                );
            }
        }
    }
}

#[test]
fn a_map_without_any_number_is_damaged() {
    let folder = folder();
    let path = folder.path().join("nothing.exr");
    let some = |last| {
        [
            [f32::NAN; 3],
            [f32::INFINITY, 0.0, 0.0],
            [f32::NAN; 3],
            last,
        ]
    };
    encode::save_exr_rgb(&path, 2, 2, &some([f32::NAN; 3])).expect("written");
    let error = maps::load_colour(&path, ColourEncoding::Linear).expect_err("no number");
    assert!(error.to_string().contains("none of its pixels"), "{error}");
    assert!(verify(&path).is_err());
    // One is enough.
    encode::save_exr_rgb(&path, 2, 2, &some([0.5; 3])).expect("written");
    assert_eq!(verify(&path).expect("a number").count, 3);
}

/// The windows are those that the samples' own description states.
#[test]
fn exr_pictures_fill_their_display_window() {
    let Some(root) = data(test_name!(), "exr/DisplayWindow") else {
        return;
    };
    for (name, size) in [
        ("t01.exr", [400, 300]),
        ("t08.exr", [501, 401]),
        ("t16.exr", [481, 371]),
    ] {
        let header = probe(&root.join(name)).expect(name);
        assert_eq!(header.size, size, "{name}");
        let map = maps::load_colour(&root.join(name), ColourEncoding::Embedded).expect(name);
        assert!(
            channel(&map, 0, 1).iter().any(|&v| v > 0.0),
            "{name} is black"
        );
    }
}

#[test]
fn colour_checker_survives_a_16_bit_png() {
    let Some(path) = data(test_name!(), "colorchecker/colorchecker24.json") else {
        return;
    };
    let text = fs::read_to_string(path).expect("read");
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let chart = &json["chromaticities_xyY"]["ColorChecker24 - After November 2014"];
    let numbers = |value: &serde_json::Value| -> Vec<f64> {
        value
            .as_array()
            .expect("a list")
            .iter()
            .map(|v| v.as_f64().expect("a number"))
            .collect()
    };
    let white = numbers(&chart["illuminant_xy"]);
    let adapt = colour::bradford([white[0], white[1]], colour::D65);
    let mut outside = BTreeSet::new();
    let mut patches = Vec::new();
    for (name, xyy) in chart["patches"].as_object().expect("patches") {
        let xyy = numbers(xyy);
        let xyz = colour::xyz_from_xyy([xyy[0], xyy[1], xyy[2]]);
        let linear = colour::linear_from_xyz((adapt * DVec3::from(xyz)).into());
        if linear.iter().any(|&v| v < 0.0) {
            outside.insert(name.as_str());
        }
        patches.push(linear);
    }
    assert_eq!(patches.len(), 24);
    assert_eq!(outside, BTreeSet::from(["cyan"]));

    let folder = folder();
    let png = folder.path().join("chart.png");
    let code = |v: f64| (colour::srgb_encode(v.clamp(0.0, 1.0)) * 65535.0).round() as u16;
    let codes: Vec<_> = patches.iter().map(|patch| patch.map(code)).collect();
    encode::save_png_rgb16(&png, 6, 4, &codes, None).expect("written");
    let map = maps::load_colour(&png, ColourEncoding::Embedded).expect("read");
    // Half a step of the file's code, at most 2.3 steps of linear light near white, and half a
    // step of the texel.
    const TWO_ROUNDINGS: f64 = 1.7 / 65535.0;
    for c in 0..3 {
        for (value, patch) in channel(&map, 0, c).iter().zip(&patches) {
            let expected = patch[c].clamp(0.0, 1.0);
            assert!(
                (f64::from(*value) - expected).abs() < TWO_ROUNDINGS,
                "{value} {expected}"
            );
        }
    }

    let exr = folder.path().join("chart.exr");
    let floats: Vec<_> = patches
        .iter()
        .map(|patch| patch.map(|v| v as f32))
        .collect();
    encode::save_exr_rgb(&exr, 6, 4, &floats).expect("written");
    let map = maps::load_colour(&exr, ColourEncoding::Embedded).expect("read");
    // Eleven bits of a half float.
    const HALF: f64 = 1.0 / 2048.0;
    for c in 0..3 {
        for (value, patch) in channel(&map, 0, c).iter().zip(&patches) {
            assert!(
                (f64::from(*value) - patch[c]).abs() <= HALF * patch[c].abs(),
                "{value}"
            );
        }
    }
    assert!(
        channel(&map, 0, 0).iter().any(|&red| red < -0.01),
        "cyan lost its negative red"
    );
}

#[test]
fn exif_turns_pictures_and_states_their_resolution() {
    use image::{ExtendedColorType, ImageEncoder, codecs::jpeg::JpegEncoder};
    // TIFF structure: orientation 6 (turn clockwise), 600 × 300 per inch.
    let mut exif = b"MM\0*\0\0\0\x08\0\x03".to_vec();
    exif.extend(b"\x01\x12\0\x03\0\0\0\x01\0\x06\0\0");
    exif.extend(b"\x01\x1a\0\x05\0\0\0\x01\0\0\0\x32");
    exif.extend(b"\x01\x1b\0\x05\0\0\0\x01\0\0\0\x3a");
    exif.extend([0; 4]);
    exif.extend([0, 0, 2, 0x58, 0, 0, 0, 1, 0, 0, 1, 0x2c, 0, 0, 0, 1]);
    let mut pixels = vec![0; 16 * 8];
    for row in pixels.chunks_mut(16) {
        row[..8].fill(255);
    }
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = JpegEncoder::new_with_quality(&mut bytes, 100);
    encoder.set_exif_metadata(exif).expect("EXIF");
    encoder
        .write_image(&pixels, 16, 8, ExtendedColorType::L8)
        .expect("encoded");
    // Without the JFIF segment, whose resolution would win.
    let bytes = without_jfif(bytes.into_inner());
    let folder = folder();
    let path = folder.path().join("photograph");
    fs::write(&path, bytes).expect("written");
    let header = probe(&path).expect("read");
    assert_eq!((header.size, header.dpi), ([8, 16], Some([300.0, 600.0])));
    // The bright left half of the stored rows is the top of the picture.
    let values = channel(&maps::load_roughness(&path, false).expect("read"), 0, 0);
    assert!(mean(&values[..64]) > 0.99 && mean(&values[64..]) < 0.01);
}

fn without_jfif(mut bytes: Vec<u8>) -> Vec<u8> {
    if let Some(at) = bytes.windows(2).position(|marker| marker == [0xff, 0xe0]) {
        let length = usize::from(u16::from_be_bytes([bytes[at + 2], bytes[at + 3]]));
        bytes.drain(at..at + 2 + length);
    }
    bytes
}

#[test]
fn the_format_is_that_of_the_content() {
    let folder = folder();
    let write = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, content).expect("written");
        path
    };
    let refusal = |path: &Path| probe(path).expect_err("refused").to_string();
    let text = write("albedo.png", b"not a picture");
    assert_eq!(
        refusal(&text),
        format!(
            "{}: is not a PNG, JPEG, TIFF or OpenEXR picture; export it as one of these",
            text.display()
        )
    );
    assert!(refusal(&write("empty.tif", b"")).contains("is not a PNG"));
    assert!(refusal(folder.path()).contains("cannot be read"));
    assert!(refusal(&folder.path().join("absent.png")).contains("cannot be read"));
    let png = folder.path().join("really-png.jpg");
    encode::save_png_grey8(&png, 1, 1, &[9], None).expect("written");
    assert_eq!(probe(&png).expect("read").size, [1, 1]);
}

#[test]
fn alpha_that_a_file_has_multiplied_already_counts_once() {
    let folder = folder();
    let path = folder.path().join("half.exr");
    // 0.8 under an opacity of one half.
    exr::prelude::write_rgba_file(&path, 2, 2, |_, _| (0.4f32, 0.4f32, 0.4f32, 0.5f32))
        .expect("written");
    let near = |pyramid: Result<Pyramid, MapError>, expected: &[f32]| {
        let texels = &pyramid.expect("read").levels[0].texels;
        for (i, expected) in expected.iter().enumerate() {
            let found = texels.get(i).expect("there");
            assert!((found - expected).abs() < 0.003, "{i}: {found} {expected}");
        }
    };
    let encoding = ColourEncoding::Embedded;
    near(maps::load_colour(&path, encoding), &[0.8, 0.8, 0.8, 1.0]);
    let picture = maps::load_overlay_picture(&path, encoding);
    near(picture, &[0.4, 0.4, 0.4, 0.5]);
    near(maps::load_outline(&path), &[0.4]);
    near(maps::load_height(&path), &[0.8]);
    let grey = ColourMapName::Grey;
    let [r, g, b] = grey.colour(0.8).map(|v| v as f32 * 0.5);
    near(maps::load_overlay_continuous(&path, grey), &[r, g, b, 0.5]);
}
