//! Figures: the scale bar counted in pixels, and pictures that are made again from their sidecars.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Output,
};

use serde_json::Value;

use super::{Sheet, code, files, recto, stdout};

const SIZE: [u32; 2] = [640, 360];
/// The colour of the bar, which nothing else in the picture has in a row.
const INK: [u8; 3] = [235, 232, 224];

fn figure(sheet: &Sheet, out: &Path, more: &[&str]) -> Output {
    let mut command = recto();
    command.arg("render").arg(sheet.exhibit());
    command.args(["--size", "640x360", "--figure", "--out"]);
    command.arg(out).args(more).output().unwrap()
}

fn sidecar(out: &Path) -> Value {
    serde_json::from_slice(&fs::read(out.with_extension("json")).unwrap()).unwrap()
}

/// The longest run of the bar's colour in a row.
fn bar_px(picture: &Path) -> f64 {
    let picture = image::open(picture).unwrap().into_rgb8();
    let mut longest = 0;
    for row in picture.rows() {
        let mut run = 0;
        for pixel in row {
            run = if pixel.0 == INK { run + 1 } else { 0 };
            longest = longest.max(run);
        }
    }
    f64::from(longest)
}

#[test]
fn the_bar_is_right_at_every_zoom() {
    let sheet = Sheet::new();
    let mut found = Vec::new();
    for width in [40.0, 137.0, 300.0] {
        let out = sheet.out(&format!("{width}.png"));
        let camera = format!("width_mm={width}");
        code(&figure(&sheet, &out, &["--camera", &camera]), 0);
        let scale = &sidecar(&out)["scale"];
        let mm = scale["bar_mm"].as_f64().unwrap();
        assert_eq!(scale["holds"], "everywhere");
        // The camera's width fills the picture.
        let expected = mm / width * f64::from(SIZE[0]);
        // The last pixel shows a fraction.
        let counted = bar_px(&out);
        assert!(
            expected - counted < 1.0 && counted <= expected,
            "{width}: {counted} of {expected}"
        );
        found.push((mm, counted));
    }
    assert_eq!(
        found.iter().map(|f| f.0).collect::<Vec<_>>(),
        [10.0, 20.0, 50.0]
    );
    // The count tells a bar of another zoom.
    assert!((found[0].1 - 10.0 / 137.0 * 640.0).abs() > 1.0);
}

#[test]
fn a_slanted_view_says_where_its_bar_holds() {
    let sheet = Sheet::new();
    let out = sheet.out("x.png");
    for (more, holds) in [
        (&["--scene=tilted"][..], "at-the-centre"),
        (&["--camera=tilt_deg=30"], "along-the-horizontal"),
        (&["--camera=distance_mm=300"], "everywhere"),
        (
            &["--compare=side-by-side:side:recto,side:verso"],
            "everywhere",
        ),
        (
            &["--compare=loupe:side:recto,overlay:picture"],
            "everywhere",
        ),
    ] {
        code(&figure(&sheet, &out, more), 0);
        let scale = &sidecar(&out)["scale"];
        assert_eq!(scale["holds"], holds, "{more:?}");
        assert_eq!(scale["outside_the_loupe"], more[0].contains("loupe"));
        if more[0].contains("side-by-side") {
            // The whole sheet of 100 mm, and 4 % of it on either side, fills each half's width.
            let expected = 108.0 / f64::from(SIZE[0] / 2);
            let found = scale["mm_per_px"].as_f64().unwrap();
            assert!((found - expected).abs() < 1e-9, "{found}");
        }
        let [mm, px, each] =
            ["bar_mm", "bar_px", "mm_per_px"].map(|key| scale[key].as_f64().unwrap());
        assert!((mm - px * each).abs() < 1e-9 && (bar_px(&out) - px).abs() < 1.0);
    }
}

/// Makes a picture again from its sidecar, in a folder of its own.
fn again(out: &Path, sheet: &Sheet) -> PathBuf {
    let folder = sheet.out("again");
    fs::create_dir_all(&folder).unwrap();
    let arguments = sidecar(out)["arguments"].clone();
    let words: Vec<String> = serde_json::from_value(arguments).unwrap();
    let output = recto().args(&words).current_dir(&folder).output().unwrap();
    code(&output, 0);
    folder.join(out.file_name().unwrap())
}

#[test]
fn the_sidecar_makes_the_same_picture_again() {
    let sheet = Sheet::new();
    for (name, more) in [
        ("a.png", &[][..]),
        (
            "b.png",
            &[
                "--scene=tilted",
                "--side=verso",
                "--lamp=kind=point,candela=90,position_mm=-80x0x50",
                "--camera=centre_mm=20x30,width_mm=40",
                "--tier=draft",
            ],
        ),
        ("c.exr", &["--overlay=picture=0.5", "--language=it"]),
        ("d.png", &["--compare=curtain:side:recto,side:verso,at=0.3"]),
    ] {
        let out = sheet.out(name);
        let output = figure(&sheet, &out, more);
        code(&output, 0);
        let named: Vec<&str> = stdout(&output).lines().collect();
        assert_eq!(
            named,
            [
                out.to_str().unwrap(),
                out.with_extension("json").to_str().unwrap()
            ]
        );
        let anew = again(&out, &sheet);
        assert!(
            fs::read(&out).unwrap() == fs::read(&anew).unwrap(),
            "{name}"
        );
        assert_eq!(sidecar(&out), sidecar(&anew), "{name}");
        let said = sidecar(&out);
        let hash = |path: &Path| blake3_of(&fs::read(path).unwrap());
        assert_eq!(said["picture"]["blake3"], hash(&out));
        assert_eq!(
            said["exhibit"]["blake3"],
            hash(&sheet.exhibit().join("exhibit.toml"))
        );
        assert_eq!(said["version"], env!("CARGO_PKG_VERSION"));
        assert!(said["accuracy"]["delta_e_mean"].is_f64(), "{said}");
        assert_eq!(said["scene"]["drawing"], "sheet");
        assert_eq!(said["scene"]["lamps"].as_array().unwrap().len(), 1);
        assert_eq!(said["lamps"].as_array().unwrap().len(), 1);
        assert_eq!(said["size_mm"][0], 100.0);
        let command = said["command"].as_str().unwrap();
        assert!(
            command.starts_with("recto render /") && command.contains("--figure"),
            "{command}"
        );
        assert_eq!(said["scale"]["bar_mm"].is_null(), name.ends_with("exr"));
    }
    // An EXR is the light, whatever it is used for.
    let plain = sheet.out("plain.exr");
    let mut command = recto();
    command
        .arg("render")
        .arg(sheet.exhibit())
        .args(["--size=640x360", "--overlay=picture=0.5"]);
    code(&command.arg("--out").arg(&plain).output().unwrap(), 0);
    assert!(fs::read(plain).unwrap() == fs::read(sheet.out("c.exr")).unwrap());
}

fn blake3_of(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

#[test]
fn the_sidecar_has_every_file_that_decides_the_picture() {
    let sheet = Sheet::rich();
    let out = sheet.out("x.png");
    let listed = |more: &[&str]| {
        code(&figure(&sheet, &out, more), 0);
        let maps = sidecar(&out)["maps"].as_array().unwrap().clone();
        for map in &maps {
            let path = sheet.exhibit().join(map["file"].as_str().unwrap());
            assert_eq!(map["blake3"], blake3_of(&fs::read(path).unwrap()), "{map}");
        }
        let mut files: Vec<String> = maps
            .iter()
            .map(|map| map["file"].as_str().unwrap().to_owned())
            .collect();
        files.sort();
        files
    };
    // The light of every scene has a spectrum from a file.
    assert_eq!(
        listed(&["--scene=now", "--tier=lambert"]),
        ["even.csv", "sheet.png"]
    );
    // Media decide how rough the surface is, and of what it is.
    for tier in ["--tier=gallery", "--tier=study"] {
        assert_eq!(
            listed(&["--scene=now", tier]),
            ["even.csv", "over.png", "sheet.png", "under.png"]
        );
    }
    assert_eq!(
        listed(&["--scene=both", "--tier=lambert"]),
        ["before.png", "even.csv", "sheet.png"]
    );
    assert_eq!(
        listed(&["--scene=ink", "--tier=lambert"]),
        ["550.png", "850.png", "even.csv", "sheet.png"]
    );
    // The scene is told as the manifest would have it.
    let said = sidecar(&out);
    assert_eq!(said["scene"]["compare"]["mode"], "loupe");
    assert_eq!(said["scene"]["compare"]["of"][1], "overlay:light/ink");
    assert_eq!(said["scene"]["lamps"][0], "even");
    assert_eq!(said["lamps"][0]["spectrum"]["file"], "even.csv");
    assert!(said["accuracy"]["delta_e_mean"].is_f64(), "{said}");
}

#[test]
fn damaged_files_of_members_and_stacks_are_found_before_anything_is_written() {
    for (damaged, named) in [("before.png", "before.png"), ("850.png", "850.png")] {
        let sheet = Sheet::rich();
        let path = sheet.exhibit().join(damaged);
        let bytes = fs::read(&path).unwrap();
        fs::write(&path, &bytes[..bytes.len() - 20]).unwrap();
        let out = sheet.out("all");
        let stderr = code(&sheet.render(&out, &["--all-scenes"]).output().unwrap(), 1);
        assert!(stderr.contains(named), "{stderr}");
        assert!(!out.exists());
    }
}

#[test]
fn every_scene_has_its_own_sidecar() {
    let sheet = Sheet::new();
    let out = sheet.out("all");
    let output = figure(&sheet, &out, &["--all-scenes"]);
    code(&output, 0);
    assert_eq!(
        files(&out),
        [
            "contact-sheet.png",
            "tilted.json",
            "tilted.png",
            "whole.json",
            "whole.png"
        ]
    );
    let tilted = out.join("tilted.png");
    assert_eq!(sidecar(&tilted)["scene"]["id"], "tilted");
    assert!(fs::read(again(&tilted, &sheet)).unwrap() == fs::read(&tilted).unwrap());
}

#[test]
fn nothing_is_overwritten_or_half_written() {
    let sheet = Sheet::new();
    let out = sheet.out("x.png");
    let notes = sheet.out("x.json");
    fs::write(&notes, "{ \"notes\": \"mine\" }").unwrap();
    let stderr = code(&figure(&sheet, &out, &[]), 1);
    assert!(stderr.contains("is no sidecar of Recto's"), "{stderr}");
    assert_eq!(
        fs::read_to_string(&notes).unwrap(),
        "{ \"notes\": \"mine\" }"
    );
    fs::remove_file(&notes).unwrap();
    fs::create_dir(&notes).unwrap();
    let stderr = code(&figure(&sheet, &out, &[]), 1);
    assert!(stderr.contains("is a folder"), "{stderr}");
    fs::remove_dir(&notes).unwrap();
    code(&figure(&sheet, &out, &["--state=hole"]), 1);
    let mut small = recto();
    small
        .arg("render")
        .arg(sheet.exhibit())
        .args(["--figure", "--size=100x100", "--out"]);
    code(&small.arg(&out).output().unwrap(), 2);
    assert_eq!(files(sheet.root.path()), ["exhibit"]);

    code(&figure(&sheet, &out, &[]), 0);
    let first = fs::read(&out).unwrap();
    let stderr = code(&figure(&sheet, &sheet.out("x.exr"), &[]), 1);
    assert!(stderr.contains("is the sidecar of x.png"), "{stderr}");
    // The same picture takes the place of the older one, and another manifest has another hash.
    let manifest = sheet.exhibit().join("exhibit.toml");
    let before = sidecar(&out)["exhibit"]["blake3"].clone();
    let text = fs::read_to_string(&manifest).unwrap();
    fs::write(&manifest, format!("# A remark.\n{text}")).unwrap();
    code(&figure(&sheet, &out, &[]), 0);
    assert!(fs::read(&out).unwrap() == first);
    assert_ne!(sidecar(&out)["exhibit"]["blake3"], before);
    assert_eq!(files(sheet.root.path()), ["exhibit", "x.json", "x.png"]);
    fs::write(sheet.exhibit().join("sheet.png"), "no picture").unwrap();
    code(&figure(&sheet, &out, &[]), 1);
    assert!(fs::read(&out).unwrap() == first);
}
