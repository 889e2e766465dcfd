//! Photographs that cannot be given back: `recto check --masks`.

use recto::maps::encode;

use super::{EDGE, Sheet, code, files, recto, stdout};

#[test]
fn pixels_that_cannot_be_given_back_are_counted_and_shown_in_a_mask() {
    let sheet = Sheet::new();
    let colour = |i: u32| match i {
        0..=2 => [0; 3],
        3..=7 => [255, 128, 128],
        _ => [150; 3],
    };
    let pixels: Vec<[u8; 3]> = (0..EDGE * EDGE).map(colour).collect();
    encode::save_png_rgb8(
        &sheet.exhibit().join("sheet.png"),
        EDGE,
        EDGE,
        &pixels,
        None,
    )
    .unwrap();
    let masks = sheet.out("masks");
    let check = |more: &[&str]| {
        let output = recto()
            .arg("check")
            .arg(sheet.exhibit())
            .args(more)
            .output()
            .unwrap();
        code(&output, 0);
        stdout(&output).to_owned()
    };
    let text = check(&["--masks", masks.to_str().unwrap()]);
    let line = text.lines().find(|line| line.contains("sheet.png"));
    let line = line.unwrap_or_else(|| panic!("{text}"));
    assert!(line.contains("3 pixels (1.17%) darker"), "{line}");
    assert!(line.contains("5 pixels (1.95%) clipped"), "{line}");
    // The verso's photograph can be given back: it is named where everything is.
    assert!(!text.contains("verso.png"), "{text}");
    assert!(check(&["--explain"]).contains("verso.png (verso): 0 pixels"));
    let json: serde_json::Value = serde_json::from_str(&check(&["--json"])).unwrap();
    assert_eq!(json["photographs"][0]["too_dark"], 3);
    assert_eq!(json["photographs"][0]["saturated"], 5);

    assert_eq!(files(&masks), ["sheet-recto.png", "sheet-verso.png"]);
    let mask = image::open(masks.join("sheet-recto.png"))
        .unwrap()
        .into_luma8();
    let expected = |i: u32| match i {
        0..=2 => 128,
        3..=7 => 255,
        _ => 0,
    };
    let expected: Vec<u8> = (0..EDGE * EDGE).map(expected).collect();
    assert_eq!(mask.as_raw(), &expected);
}
