//! Pictures, which need a graphics device, and how to do without one.

use std::fs;

use image::GenericImageView;
use recto::{develop::Print, maps::encode};

use super::{Sheet, code, files, recto, stdout};

#[test]
fn without_a_driver_the_program_ends_with_3_and_says_what_to_install() {
    let sheet = Sheet::new();
    let out = sheet.out("x.png");
    let output = sheet
        .render(&out, &[])
        .env("VK_DRIVER_FILES", "/nonexistent")
        .env("VK_ICD_FILENAMES", "/nonexistent")
        .output()
        .unwrap();
    let stderr = code(&output, 3);
    assert!(
        stderr.contains("apt-get install mesa-vulkan-drivers"),
        "{stderr}"
    );
    assert!(output.stdout.is_empty());
    assert_eq!(files(sheet.root.path()), ["exhibit"]);

    // The input's faults come first: a curator needs no graphics device to hear of them.
    fs::write(sheet.exhibit().join("sheet.png"), "no picture").unwrap();
    let output = sheet
        .render(&out, &[])
        .env("VK_DRIVER_FILES", "/nonexistent")
        .output()
        .unwrap();
    code(&output, 1);
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let sheet = Sheet::new();
    for scene in ["whole", "tilted"] {
        let [first, second] = ["a.png", "b.png"].map(|name| {
            let out = sheet.out(name);
            let output = sheet.render(&out, &["--scene", scene]).output().unwrap();
            code(&output, 0);
            assert_eq!(stdout(&output).trim_end(), out.to_str().unwrap());
            fs::read(out).unwrap()
        });
        assert!(first == second, "{scene}");
    }
    assert_eq!(files(sheet.root.path()), ["a.png", "b.png", "exhibit"]);
}

#[test]
fn png_is_exr_as_a_display_shows_it() {
    let sheet = Sheet::new();
    let [png, exr] = ["a.png", "a.EXR"].map(|name| sheet.out(name));
    for out in [&png, &exr] {
        code(&sheet.render(out, &[]).output().unwrap(), 0);
    }
    let exr = exr::prelude::read_first_rgba_layer_from_file(
        &exr,
        |size, _| vec![[0.0_f32; 3]; size.area()],
        |pixels, at, (r, g, b, _): (f32, f32, f32, f32)| pixels[at.y() * 64 + at.x()] = [r, g, b],
    )
    .unwrap();
    let linear = exr.layer_data.channel_data.pixels;
    let print = Print::develop(64, 64, &linear, &[], 1.0);
    let shown = image::open(png).unwrap().into_rgb8();
    assert_eq!(shown.as_raw(), print.pixels.as_flattened());
    // It is a picture: not one colour, and lit as a photograph is.
    let colours: std::collections::BTreeSet<_> = print.pixels.iter().collect();
    assert!(colours.len() > 50, "{}", colours.len());
}

#[test]
fn options_change_the_picture() {
    let sheet = Sheet::new();
    let pictures = [
        &[][..],
        &["--side", "verso"],
        &["--overlay", "picture=0.5"],
        &["--lamp", "kind=point,candela=90,position_mm=-80x0x50"],
        &["--camera", "centre_mm=20x30,width_mm=40"],
        &["--tier", "lambert", "--camera", "true-size@96"],
        &["--scene", "tilted"],
    ]
    .map(|options| {
        let out = sheet.out("x.png");
        code(&sheet.render(&out, options).output().unwrap(), 0);
        fs::read(out).unwrap()
    });
    for (i, picture) in pictures.iter().enumerate() {
        assert!(!pictures[..i].contains(picture), "{i}");
    }
}

#[test]
fn faulty_options_are_all_named_and_nothing_is_written() {
    let sheet = Sheet::new();
    let out = sheet.out("x.png");
    let options = ["--scene", "hole", "--lamp", "kind=pint", "--language", "?"];
    let output = sheet.render(&out, &options).output().unwrap();
    // Some of them cannot be read whatever the exhibit is.
    let stderr = code(&output, 2);
    assert!(stderr.contains("did you mean \"whole\"?"), "{stderr}");
    assert!(stderr.contains("did you mean \"point\"?"), "{stderr}");
    assert!(stderr.contains("--language"), "{stderr}");
    assert_eq!(files(sheet.root.path()), ["exhibit"]);
}

#[test]
fn what_is_not_shown_yet_is_said_by_check_alone() {
    let sheet = Sheet::new();
    let manifest = sheet.exhibit().join("exhibit.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    let paper = "paper = { kind = \"laid\", chain_lines_mm = 24 }\nsize_mm";
    fs::write(&manifest, text.replacen("size_mm", paper, 1)).unwrap();
    let check = recto().arg("check").arg(sheet.exhibit()).output().unwrap();
    assert!(
        stdout(&check).contains("chain_lines_mm of the paper does not change the picture yet"),
        "{}",
        stdout(&check)
    );
    let out = sheet.out("x.png");
    assert_eq!(code(&sheet.render(&out, &[]).output().unwrap(), 0), "");
}

#[test]
fn where_nothing_can_be_written_is_found_before_rendering() {
    let sheet = Sheet::new();
    let file = sheet.exhibit().join("sheet.png");
    for (out, words) in [
        (sheet.out("absent/x.png"), "no such folder"),
        (file.join("x.png"), "is not a folder"),
    ] {
        // No driver would be the next thing to be found.
        let output = sheet
            .render(&out, &[])
            .env("VK_DRIVER_FILES", "/nonexistent")
            .output()
            .unwrap();
        let stderr = code(&output, 1);
        assert!(stderr.contains(words), "{stderr}");
    }
    let folder = sheet.out("folder.png");
    fs::create_dir(&folder).unwrap();
    let stderr = code(&sheet.render(&folder, &[]).output().unwrap(), 1);
    assert!(stderr.contains("is a folder"), "{stderr}");
}

#[test]
fn all_scenes_come_with_a_contact_sheet() {
    let sheet = Sheet::new();
    let out = sheet.out("deep/er");
    let output = sheet.render(&out, &["--all-scenes"]).output().unwrap();
    code(&output, 0);
    assert_eq!(
        files(&out),
        ["contact-sheet.png", "tilted.png", "whole.png"]
    );
    assert_eq!(stdout(&output).lines().count(), 3);
    let contact = image::open(out.join("contact-sheet.png")).unwrap();
    assert!(contact.width() > 2 * 64 && contact.height() > 64);
    // A scene is the same picture alone.
    for scene in ["whole", "tilted"] {
        let alone = sheet.out("alone.png");
        code(
            &sheet.render(&alone, &["--scene", scene]).output().unwrap(),
            0,
        );
        let together = fs::read(out.join(format!("{scene}.png"))).unwrap();
        assert!(fs::read(alone).unwrap() == together, "{scene}");
    }
}

#[test]
fn an_old_file_is_replaced_whole() {
    let sheet = Sheet::new();
    let out = sheet.out("x.png");
    encode::save_png_grey8(&out, 1, 1, &[7], None).unwrap();
    code(&sheet.render(&out, &[]).output().unwrap(), 0);
    assert_eq!(image::open(&out).unwrap().dimensions(), (64, 64));
}

#[cfg(unix)]
#[test]
fn a_current_folder_that_was_deleted_is_refused() {
    let sheet = Sheet::new();
    let gone = sheet.out("gone");
    fs::create_dir(&gone).unwrap();
    let output = std::process::Command::new("sh")
        .args([
            "-c",
            r#"cd "$1" && rmdir "$1" && exec "$2" render "$3" --all-scenes --out out"#,
        ])
        .arg("sh")
        .arg(&gone)
        .arg(env!("CARGO_BIN_EXE_recto"))
        .arg(sheet.exhibit())
        .output()
        .unwrap();
    let stderr = code(&output, 1);
    assert!(stderr.starts_with("recto: .: "), "{stderr}");
}

#[test]
fn no_output_takes_the_place_of_what_the_exhibit_is_made_of() {
    let sheet = Sheet::new();
    let [manifest, map] = ["exhibit.toml", "sheet.png"].map(|name| sheet.exhibit().join(name));
    let before = [&manifest, &map].map(|file| fs::read(file).unwrap());
    let exhibit = sheet.exhibit();
    let exhibit = exhibit.to_str().unwrap();
    let out = map.to_str().unwrap();
    let over_map = super::run(&["render", exhibit, "--size", "16x12", "--out", out]);
    let stderr = code(&over_map, 1);
    assert!(stderr.contains("is part of the exhibit"), "{stderr}");
    let table = manifest.to_str().unwrap();
    let ruler = ["measure", exhibit, "--ruler", "1,1:5,5", "--csv", table];
    code(&super::run(&ruler), 2);
    assert!(before == [&manifest, &map].map(|file| fs::read(file).unwrap()));
}
