//! The scale of photographs from a ruler in them, and lamps that tell nothing.

use recto::{manifest::Fault, maps::encode, prepare::capture::Capture};

use super::folder;

fn parsed(scale: &str, lamps: &str) -> Result<Capture, Vec<Fault>> {
    let folder = folder();
    let names: Vec<String> = (0..4).map(|i| format!("r{i}.png")).collect();
    for (i, name) in names.iter().enumerate() {
        let pixels = vec![20_000 + i as u16; 640 * 480];
        encode::save_png_grey16(&folder.path().join(name), 640, 480, &pixels, None)
            .expect("written");
    }
    let text = format!(
        "id = \"ruler\"\n[scale]\n{scale}\n[lamps]\n{lamps}\n[recto]\nphotographs = {names:?}\n"
    );
    match Capture::parse(&folder.path().join("capture.toml"), &text) {
        Ok((capture, warnings)) => {
            assert!(warnings.is_empty(), "{warnings:?}");
            Ok(capture)
        }
        Err(faults) => Err(faults.into_iter().collect()),
    }
}

const AROUND: &str = "azimuth_deg = [0, 90, 180, 270]\nelevation_deg = 45";

fn fault(scale: &str, lamps: &str) -> String {
    let faults = parsed(scale, lamps).expect_err("a fault");
    assert_eq!(faults.len(), 1, "{faults:?}");
    faults[0].to_string()
}

#[test]
fn a_ruler_says_how_large_a_pixel_is() {
    // 3, 4, 5.
    let ruler = "ruler = { from_px = [100, 40.5], to_px = [400, 440.5], length_mm = 100 }";
    let capture = parsed(ruler, AROUND).expect("a capture");
    assert!((capture.mm_per_px - 0.2).abs() < 1e-12);
    let same = parsed("mm_per_px = 0.2", AROUND).expect("a capture");
    assert!((same.mm_per_px - capture.mm_per_px).abs() < 1e-12);
}

#[test]
fn a_ruler_that_says_little_or_too_much_is_told() {
    let told = fault(
        "ruler = { from_px = [100, 40], to_px = [120, 40], length_mm = 100 }",
        AROUND,
    );
    assert!(
        told.contains("scale.ruler") && told.contains("20.0 pixels"),
        "{told}"
    );
    let told = fault(
        "ruler = { from_px = [100, 40], to_px = [300, 40], length_mm = 0.2 }",
        AROUND,
    );
    assert!(told.contains("length_mm"), "{told}");
    let both = "dpi = 300\nruler = { from_px = [100, 40], to_px = [300, 40], length_mm = 10 }";
    let told = fault(both, AROUND);
    assert!(told.contains("dpi") && told.contains("ruler"), "{told}");
    let told = fault("", AROUND);
    assert!(told.contains("mm_per_px"), "{told}");
}

#[test]
fn lamps_in_one_plane_are_refused() {
    let scale = "dpi = 300";
    // All in a plane through the sheet's middle: east and west, and two above the line between.
    let told = fault(
        scale,
        "azimuth_deg = [0, 180, 0, 180]\nelevation_deg = [20, 20, 60, 70]",
    );
    assert!(told.contains("one plane"), "{told}");
    let told = fault(
        scale,
        "position_mm = [[0, 900, 400], [0, 300, 900], [0, -500, 700], [0, -900, 300]]",
    );
    assert!(told.contains("one plane"), "{told}");
    // Of one elevation all around is no plane with the middle.
    assert!(parsed(scale, AROUND).is_ok());
    // But in one place all of them it is.
    let told = fault(
        scale,
        "azimuth_deg = [0, 1, 2, 1]\nelevation_deg = [45, 45, 45, 46]",
    );
    assert!(told.contains("one plane"), "{told}");
}
