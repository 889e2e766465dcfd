//! `recto probe`

use std::{fs, path::Path};

use recto::maps::encode;

use super::{Sheet, code, recto, stdout};

fn stack() -> Sheet {
    let sheet = Sheet::new();
    let folder = sheet.exhibit();
    let grey = |name: &str, value: u8| {
        encode::save_png_grey8(&folder.join(name), 2, 2, &[value; 4], None).unwrap();
    };
    grey("550.png", 51);
    grey("850.png", 204);
    let manifest = folder.join("exhibit.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    let stack = "[[drawing.stack]]\nid = \"light\"\ntitle = \"Light\"\nencoding = \"linear\"\n\
        bands = [ { file = \"850.png\", wavelength_nm = 850 }, \
        { file = \"550.png\", wavelength_nm = 550 } ]\n\
        difference = [ { id = \"ink\", of = [850, 550] } ]\n\n[[scene]]";
    fs::write(&manifest, text.replacen("[[scene]]", stack, 1)).unwrap();
    sheet
}

fn probe(folder: &Path, more: &[&str]) -> std::process::Output {
    recto()
        .arg("probe")
        .arg(folder)
        .args(more)
        .output()
        .unwrap()
}

#[test]
fn a_place_is_read_in_words_as_json_and_as_a_table() {
    let sheet = stack();
    let folder = sheet.exhibit();
    let said = probe(&folder, &["--at", "20,30"]);
    code(&said, 0);
    let text = stdout(&said);
    for line in [
        "light/ink: +0.6000 of reflectance",
        "550 nm  0.2000",
        "850 nm  0.8000",
        "picture: L* ",
    ] {
        assert!(text.contains(line), "{line} is not in:\n{text}");
    }
    let csv = folder.join("curve.csv");
    let path = csv.display().to_string();
    let json = probe(
        &folder,
        &[
            "--at", "20,30", "--stack", "light", "--json", "--csv", &path,
        ],
    );
    code(&json, 0);
    let json: serde_json::Value = serde_json::from_str(stdout(&json)).unwrap();
    assert_eq!(json["overlays"].as_array().map(Vec::len), Some(0));
    assert_eq!(json["stacks"][0]["curve"][1]["wavelength_nm"], 850.0);
    let reflectance = json["stacks"][0]["curve"][1]["reflectance"]
        .as_f64()
        .unwrap();
    assert!((reflectance - 0.8).abs() < 1e-6, "{reflectance}");
    let table = fs::read_to_string(&csv).unwrap();
    assert_eq!(
        table,
        "stack,wavelength_nm,reflectance\nlight,550,0.200000\nlight,850,0.800000\n"
    );
}

#[test]
fn what_cannot_be_read_is_said() {
    let sheet = stack();
    let folder = sheet.exhibit();
    let refused = |more: &[&str]| code(&probe(&folder, more), 1);
    let beside = refused(&["--at", "120,30"]);
    assert!(
        beside.contains("beside the sheet") && beside.contains("0 to 100 mm"),
        "{beside}"
    );
    let unknown = refused(&["--at", "20,30", "--stack", "lihgt"]);
    assert!(unknown.contains("did you mean \"light\"?"), "{unknown}");
    let side = refused(&["--at", "20,30", "--stack", "light", "--side", "verso"]);
    assert!(side.contains("add --side recto"), "{side}");
    let none = refused(&["--at", "20,30", "--side", "verso", "--csv", "x.csv"]);
    assert!(none.contains("no stack"), "{none}");
    code(&probe(&folder, &["--at", "20"]), 2);
    code(&probe(&folder, &["--at", "nan,2"]), 2);
    // A file that is damaged is named where the manifest names it.
    fs::write(folder.join("550.png"), "no picture").unwrap();
    let damaged = refused(&["--at", "20,30"]);
    assert!(damaged.contains("550.png"), "{damaged}");
}

#[test]
fn categories_are_chosen_on_the_command_line() {
    let sheet = stack();
    let folder = sheet.exhibit();
    let render = |overlay: &str| {
        let out = folder.join("out.png");
        let arguments = ["--size", "16x16", "--overlay", overlay, "--out"];
        let output = recto()
            .arg("render")
            .arg(&folder)
            .args(arguments)
            .arg(out)
            .output();
        code(&output.unwrap(), 1)
    };
    let none = render("picture:tear");
    assert!(none.contains("leave categories out"), "{none}");
    let unknown = render("light/650");
    assert!(unknown.contains("light/550"), "{unknown}");
}
