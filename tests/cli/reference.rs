//! Pictures by random walks, which need no graphics device.

use std::{fs, path::Path, process::Command};

use recto::develop::Print;

use super::{Sheet, code, files, recto, stdout};

fn reference(sheet: &Sheet, out: &Path, more: &[&str]) -> Command {
    let mut command = recto();
    command
        .arg("reference")
        .arg(sheet.exhibit())
        .args(["--size", "16x12", "--out"])
        .arg(out)
        .args(more)
        .env("VK_DRIVER_FILES", "/nonexistent");
    if !more.contains(&"--samples") {
        command.args(["--samples", "4"]);
    }
    command
}

fn linear(path: &Path) -> Vec<[f32; 3]> {
    let image = exr::prelude::read_first_rgba_layer_from_file(
        path,
        |size, _| (size.width(), vec![[0.0_f32; 3]; size.area()]),
        |(width, pixels), at, (r, g, b, _): (f32, f32, f32, f32)| {
            pixels[at.y() * *width + at.x()] = [r, g, b];
        },
    );
    image.unwrap().layer_data.channel_data.pixels.1
}

#[test]
fn a_crop_is_that_part_of_the_picture_in_either_format_and_mode() {
    let sheet = Sheet::new();
    for mode in ["local", "lateral"] {
        let [whole, noise, part, png] =
            ["whole.exr", "noise.exr", "part.exr", "part.png"].map(|name| sheet.out(name));
        let noisy = noise.to_str().unwrap();
        let variance = ["--samples", "4", "--mode", mode, "--variance", noisy];
        let output = reference(&sheet, &whole, &variance).output().unwrap();
        code(&output, 0);
        assert_eq!(
            stdout(&output),
            format!("{}\n{}\n", whole.display(), noise.display())
        );
        let crop = ["--samples", "4", "--mode", mode, "--crop", "5,3,4,2"];
        for out in [&part, &png] {
            code(&reference(&sheet, out, &crop).output().unwrap(), 0);
        }
        let (whole, part) = (linear(&whole), linear(&part));
        assert_eq!(part.len(), 8);
        for (i, pixel) in part.iter().enumerate() {
            assert_eq!(*pixel, whole[(3 + i / 4) * 16 + 5 + i % 4], "{mode} {i}");
        }
        let shown = image::open(png).unwrap().into_rgb8();
        let print = Print::develop(4, 2, &part, &[], 1.0);
        assert_eq!(shown.as_raw(), print.pixels.as_flattened());
        let noise = linear(&noise);
        assert!(noise.iter().flatten().all(|v| v.is_finite() && *v >= 0.0));
        assert!(noise.iter().flatten().any(|v| *v > 0.0));
    }
    // Another seed is another picture.
    let [a, b] = ["a.exr", "b.exr"].map(|name| sheet.out(name));
    for (out, seed) in [(&a, "1"), (&b, "2")] {
        code(
            &reference(&sheet, out, &["--samples", "4", "--seed", seed])
                .output()
                .unwrap(),
            0,
        );
    }
    assert!(fs::read(a).unwrap() != fs::read(b).unwrap());
}

#[test]
fn bad_arguments_are_refused_in_words_and_nothing_is_written() {
    let sheet = Sheet::new();
    let out = sheet.out("x.exr");
    for (options, words) in [
        (["--samples", "0"], "from 1 to"),
        (["--samples", "1.5"], "from 1 to"),
        (["--crop", "10,0,7,4"], "16 × 12 pixels"),
        (["--crop", "0,0,4294967295,1"], "16 × 12 pixels"),
        (["--crop", "4294967295,0,1,1"], "16 × 12 pixels"),
        (["--crop", "0,0,0,4"], "such as 600,400,32,32"),
        (["--crop", "1,2,3"], "such as 600,400,32,32"),
        (["--variance", "noise.png"], "must end in .exr"),
        (["--mode", "locally"], "lateral"),
        (["--tier", "study"], "--tier"),
    ] {
        let stderr = code(&reference(&sheet, &out, &options).output().unwrap(), 2);
        assert!(stderr.contains(words), "{options:?}: {stderr}");
        assert_eq!(files(sheet.root.path()), ["exhibit"], "{options:?}");
    }
    // What is wrong with the scene is said as render says it.
    let options = ["--scene", "hole", "--lamp", "kind=pint"];
    let stderr = code(&reference(&sheet, &out, &options).output().unwrap(), 2);
    assert!(stderr.contains("did you mean \"whole\"?"), "{stderr}");
    assert!(stderr.contains("did you mean \"point\"?"), "{stderr}");
    fs::write(sheet.exhibit().join("sheet.png"), "no picture").unwrap();
    code(&reference(&sheet, &out, &[]).output().unwrap(), 1);
    assert_eq!(files(sheet.root.path()), ["exhibit"]);
}
