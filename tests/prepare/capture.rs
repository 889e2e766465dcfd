//! The capture file: what is written, and what is said where it is wrong.

use std::{fs, path::Path};

use recto::{
    manifest::Fault,
    maps::{ColourEncoding, encode},
    prepare::capture::{self, Capture, Light, Places, Robustness},
};

use super::folder;

/// Four lamps, as a curator would write them.
const FOUR: &str = r#"
id = "landscape"
title = "Landscape"
encoding = "linear"
scale.dpi = 600

[lamps]
azimuth_deg = [0, 90, 180, 270]
elevation_deg = 45
flat_field = ["g1.png", "g2.png", "g3.png", "g4.png"]

[recto]
photographs = ["r1.png", "r2.png", "r3.png", "r4.png"]

[chart]
photograph = "r1.png"
corners_px = [[10, 10], [50, 10], [50, 30], [10, 30]]
"#;

/// A curator's patience.
const MOST_LINES: usize = 20;

/// Grey, another one for each name.
fn picture(path: &Path, [width, height]: [u32; 2]) {
    let name = path.file_name().expect("a name").as_encoded_bytes();
    let grey = name
        .iter()
        .fold(20_000u16, |grey, byte| grey + u16::from(*byte) % 32);
    let pixels = vec![grey; (width * height) as usize];
    encode::save_png_grey16(path, width, height, &pixels, None).expect("written");
}

fn written(names: &[&str]) -> tempfile::TempDir {
    let folder = folder();
    for name in names {
        picture(&folder.path().join(name), [64, 48]);
    }
    folder
}

const FILES: [&str; 8] = [
    "r1.png", "r2.png", "r3.png", "r4.png", "g1.png", "g2.png", "g3.png", "g4.png",
];

fn faults(folder: &Path, text: &str) -> Vec<Fault> {
    let file = folder.join("capture.toml");
    let found = Capture::parse(&file, text).expect_err("faults");
    found.into_iter().collect()
}

/// The one fault there is.
fn fault(folder: &Path, text: &str) -> Fault {
    let mut all = faults(folder, text);
    assert_eq!(all.len(), 1, "{all:?}");
    all.remove(0)
}

#[test]
fn four_lamps_take_twenty_lines() {
    let lines = FOUR.trim().lines().count();
    assert!(lines <= MOST_LINES, "{lines}");
    let folder = written(&FILES);
    fs::write(folder.path().join("capture.toml"), FOUR).expect("written");
    let (capture, warnings) = Capture::read(folder.path()).expect("a capture");
    assert!(warnings.is_empty());
    assert_eq!(capture.encoding, ColourEncoding::Linear);
    assert!((capture.mm_per_px - 25.4 / 600.0).abs() < 1e-12);
    assert_eq!(capture.lamps.count, 4);
    let Places::Directions(places) = &capture.lamps.places else {
        panic!("far lamps");
    };
    // The second lamp is above the sheet in the photograph.
    assert!(places[1].y > 0.7 && places[1].x.abs() < 1e-12);
    let Light::FlatField { photographs, .. } = &capture.lamps.light else {
        panic!("a grey card");
    };
    assert_eq!(photographs.len(), 4);
    assert_eq!(capture.recto.size, [64, 48]);
    assert_eq!(capture.relief.against_outliers, Robustness::Robust);
    capture::check_shape(FOUR).expect("the schema's shape");
}

#[test]
fn every_fault_is_told_with_its_place_at_once() {
    let folder = written(&FILES[..7]);
    picture(&folder.path().join("g4.png"), [64, 47]);
    let text = FOUR
        .replace("600", "-600")
        .replace("\"r4.png\"", "\"r5.png\"")
        .replace("title", "titel");
    let found = faults(folder.path(), &text);
    let told: Vec<String> = found.iter().map(ToString::to_string).collect();
    // A key that is misspelt, and a value out of range, stop before files are looked at.
    assert!(told[0].contains("capture.toml:3:1: "), "{told:?}");
    assert!(told[0].contains("title"), "{told:?}");
    assert!(told[1].contains("scale.dpi"), "{told:?}");
    let text = FOUR.replace("\"r4.png\"", "\"r5.png\"");
    let found = faults(folder.path(), &text);
    let told: Vec<String> = found.iter().map(ToString::to_string).collect();
    assert!(
        told.iter()
            .any(|t| t.contains("g4.png") && t.contains("64 × 47")),
        "{told:?}"
    );
    assert!(
        told.iter()
            .any(|t| t.contains("r5.png") && t.contains("not there")),
        "{told:?}"
    );
}

#[test]
fn raw_files_are_refused_with_the_way_to_develop_them() {
    let folder = written(&FILES);
    fs::write(folder.path().join("r9.nef"), b"MM\0*rest").expect("written");
    // By what is in it, whatever it is called.
    fs::write(
        folder.path().join("r8.tif"),
        b"II*\0\x10\0\0\0CR\x02\0more and more",
    )
    .expect("written");
    for name in ["r9.nef", "r8.tif"] {
        let text = FOUR.replace("[\"r1.png\"", &format!("[\"{name}\""));
        let fault = fault(folder.path(), &text);
        assert!(fault.found.contains("raw file"), "{fault}");
        assert!(fault.remedy.contains("16-bit linear TIFF"), "{fault}");
    }
}

#[test]
fn what_is_there_twice_is_told() {
    let folder = written(&FILES);
    let same = fault(folder.path(), &FOUR.replace("\"r3.png\"", "\"r2.png\""));
    assert!(
        same.path == "recto.photographs[2]" && same.found.contains("same picture"),
        "{same}"
    );
    // A copy under another name as well.
    fs::copy(folder.path().join("r1.png"), folder.path().join("r4.png")).expect("a copy");
    let copied = fault(folder.path(), FOUR);
    assert_eq!(copied.path, "recto.photographs[3]", "{copied}");
    let folder = written(&FILES);
    // One grey card may do for all lamps.
    let one = FOUR.replace("\"g2.png\", \"g3.png\"", "\"g1.png\", \"g1.png\"");
    let file = folder.path().join("capture.toml");
    assert!(Capture::parse(&file, &one).is_ok());
    let twice = FOUR.replace("180, 270]", "180, 180]");
    let (_, warnings) = Capture::parse(&file, &twice).expect("a capture");
    assert!(
        warnings.len() == 1
            && warnings[0]
                .found
                .contains("lamp 4 in the direction of lamp 3"),
        "{warnings:?}"
    );
    fs::write(folder.path().join("r2.png"), b"").expect("an empty file");
    let empty = fault(folder.path(), FOUR);
    assert!(empty.found.contains("an empty file"), "{empty}");
}

#[test]
fn a_sheet_is_neither_a_speck_nor_a_field_and_cards_are_of_its_photographs() {
    let folder = written(&FILES);
    for (scale, told) in [
        ("mm_per_px = 0.001", "0.06 × 0.05 mm"),
        ("mm_per_px = 9", "sides of"),
    ] {
        let text = FOUR.replace("scale.dpi = 600", &format!("scale.{scale}"));
        match told {
            "sides of" => assert!(
                Capture::parse(&folder.path().join("capture.toml"), &text).is_ok(),
                "576 mm are a sheet"
            ),
            told => {
                let fault = fault(folder.path(), &text);
                assert!(
                    fault.path == "scale" && fault.found.contains(told),
                    "{fault}"
                );
            }
        }
    }
    for name in ["v1.png", "v2.png", "v3.png", "v4.png"] {
        picture(&folder.path().join(name), [60, 40]);
    }
    let verso = "[verso]\nphotographs = [\"v1.png\", \"v2.png\", \"v3.png\", \"v4.png\"]\n";
    let other = fault(folder.path(), &format!("{FOUR}{verso}"));
    assert!(
        other.path == "lamps.flat_field" && other.allowed.contains("60 × 40"),
        "{other}"
    );
}

#[test]
fn lamps_have_to_stand_around_the_sheet() {
    let folder = written(&FILES);
    let told = |text: &str| {
        let found = faults(folder.path(), text);
        let told: Vec<String> = found.iter().map(ToString::to_string).collect();
        told.join("\n")
    };
    let in_one_plane = FOUR.replace("[0, 90, 180, 270]", "[0, 180, 0, 180]");
    assert!(told(&in_one_plane).contains("one plane"));
    let two = FOUR
        .replace("[0, 90, 180, 270]", "[0, 90]")
        .replace(", \"g3.png\", \"g4.png\"", "")
        .replace(", \"r3.png\", \"r4.png\"", "");
    assert!(
        told(&two).contains("found 2 lamps; allowed: 3 to 500 lamps"),
        "{}",
        told(&two)
    );
    let five = FOUR.replace("270]", "270, 300]");
    assert!(told(&five).contains("4 photographs for 5 lamps"));
    let behind = FOUR
        .replace(
            "azimuth_deg = [0, 90, 180, 270]",
            "position_mm = [[1, 0, 5], [0, 1, 5], [-1, 0, 5], [0, -1, -5]]",
        )
        .replace("elevation_deg = 45\n", "");
    assert!(
        told(&behind).contains("behind the sheet"),
        "{}",
        told(&behind)
    );
    // Without the last lamp's slip it is sound: a test that must be able to pass.
    let near = behind.replace("-5]]", "5]]");
    assert!(Capture::parse(&folder.path().join("capture.toml"), &near).is_ok());
    let two_ways = FOUR.replace("[lamps]", "[lamps]\nlp = \"a.lp\"");
    assert!(told(&two_ways).contains("together"));
}

#[test]
fn a_ball_lies_within_its_photographs() {
    let folder = written(&FILES);
    let with = |circle: &str| {
        FOUR.replace(
            "azimuth_deg = [0, 90, 180, 270]",
            &format!("sphere.circle_px = {circle}"),
        )
        .replace("elevation_deg = 45\n", "")
    };
    let fault = fault(folder.path(), &with("[60, 24, 10]"));
    assert!(fault.path.ends_with("circle_px"), "{fault}");
    let sound = Capture::parse(&folder.path().join("capture.toml"), &with("[30, 24, 10]"));
    let Ok((capture, _)) = sound else {
        panic!("{sound:?}");
    };
    assert!(matches!(capture.lamps.places, Places::Sphere(_)));
}

#[test]
fn rulers_swatches_and_tables_are_checked() {
    let folder = written(&FILES);
    let file = folder.path().join("capture.toml");
    let ruler = "scale.ruler = { from_px = [2, 3], to_px = [62, 3], length_mm = 30 }";
    let text = FOUR.replace("scale.dpi = 600", ruler);
    let (capture, _) = Capture::parse(&file, &text).expect("a capture");
    assert_eq!(capture.mm_per_px, 0.5);
    let short = text.replace("62, 3", "12, 3");
    assert!(fault(folder.path(), &short).path.ends_with("ruler"));

    let swatch = "\n[[swatch]]\nmedium = \"iron-gall-ink\"\nrect_px = [1, 2, 9, 8]\n\
                  [[swatch]]\nmedium = \"bare-paper\"\nrect_px = [11, 2, 19, 8]\n";
    let text = format!("{FOUR}{swatch}");
    let (capture, _) = Capture::parse(&file, &text).expect("a capture");
    assert!(capture.swatches[0].medium.is_some() && capture.swatches[1].medium.is_none());
    let wrong = text.replace("bare-paper", "bear-paper");
    assert!(fault(folder.path(), &wrong).remedy.contains("bare-paper"));
    let outside = text.replace("9, 8]\n[[", "90, 8]\n[[");
    assert!(
        fault(folder.path(), &outside)
            .path
            .contains("swatch[0].rect_px")
    );

    let over = text.replace("[11, 2, 19", "[8, 2, 19");
    let told = fault(folder.path(), &over);
    assert!(
        told.path == "swatch[1].rect_px" && told.found.contains("iron-gall-ink"),
        "{told}"
    );
    let tiny = text.replace("[11, 2, 19, 8]", "[11, 2, 13, 8]");
    let told = fault(folder.path(), &tiny);
    assert!(told.found.contains("12 pixels of bare-paper"), "{told}");
    // Several small ones do as well as a large one.
    let many = format!("{tiny}[[swatch]]\nmedium = \"bare-paper\"\nrect_px = [30, 2, 38, 8]\n");
    assert!(Capture::parse(&file, &many).is_ok());

    fs::write(folder.path().join("chart.csv"), "50,0,0\n").expect("written");
    let text = format!("{FOUR}file = \"chart.csv\"\n");
    assert!(fault(folder.path(), &text).found.contains("1 patches"));
}

#[test]
fn the_schema_knows_every_key_and_no_other() {
    let schema = capture::schema();
    let validator = jsonschema::validator_for(&schema).expect("a schema");
    let value =
        |text: &str| serde_json::to_value(toml::from_str::<toml::Table>(text).unwrap()).unwrap();
    assert!(validator.is_valid(&value(FOUR)));
    for wrong in [
        FOUR.replace("title", "titel"),
        FOUR.replace("600", "-600"),
        FOUR.replace("elevation_deg = 45\n", ""),
    ] {
        assert!(!validator.is_valid(&value(&wrong)), "{wrong}");
    }
}
