//! Float maps with pixels that are no numbers.

use std::{fs, path::Path};

use recto::maps::encode::save_exr_rgb;

use super::{Sheet, code, recto, stdout};

const SIZE: u32 = 4;
const PAPER: [f32; 3] = [0.6, 0.5, 0.4];

/// A sheet of paper with these pixels, and a height map with the same.
fn exhibit(pixels: &[(usize, f32)]) -> Sheet {
    let sheet = Sheet::new();
    let write = |name: &str, value: [f32; 3]| {
        let mut map = vec![value; (SIZE * SIZE) as usize];
        for (i, bad) in pixels {
            map[*i][0] = *bad;
        }
        save_exr_rgb(&sheet.exhibit().join(name), SIZE, SIZE, &map).unwrap();
    };
    write("albedo.exr", PAPER);
    write("height.exr", [0.5; 3]);
    let manifest = "[[drawing]]\nid = \"sheet\"\nsize_mm = [100, 100]\n\
        recto.albedo = \"albedo.exr\"\n\
        recto.height = { file = \"height.exr\", range_um = [0, 80] }\n\
        [[lamp]]\nid = \"raking\"\nkind = \"distant\"\nlux_at_sheet = 300\n\
        elevation_deg = 15\nazimuth_deg = 180\n\
        [[scene]]\nid = \"whole\"\nlamps = [\"raking\"]\n";
    fs::write(sheet.exhibit().join("exhibit.toml"), manifest).unwrap();
    sheet
}

fn render(sheet: &Sheet) -> Vec<[f32; 3]> {
    let out = sheet.out("x.exr");
    code(&sheet.render(&out, &[]).output().unwrap(), 0);
    pixels(&out)
}

fn pixels(path: &Path) -> Vec<[f32; 3]> {
    let exr = exr::prelude::read_first_rgba_layer_from_file(
        path,
        |size, _| vec![[0.0_f32; 3]; size.area()],
        |pixels, at, (r, g, b, _): (f32, f32, f32, f32)| pixels[at.y() * 64 + at.x()] = [r, g, b],
    );
    exr.unwrap().layer_data.channel_data.pixels
}

#[test]
fn pixels_without_a_number_are_named_and_shown_as_their_neighbours() {
    let faulty = exhibit(&[(6, f32::NAN), (8, f32::INFINITY), (15, f32::NEG_INFINITY)]);
    let output = recto().arg("check").arg(faulty.exhibit()).output().unwrap();
    let stderr = code(&output, 0);
    for name in ["albedo.exr", "height.exr"] {
        let line = stderr.lines().find(|line| line.contains(name));
        let line = line.unwrap_or_else(|| panic!("{stderr}"));
        // Column and row of the pixels, and where the manifest names the map.
        assert!(
            line.contains("3 pixels") && line.contains("(2, 1), (0, 2), (3, 3)"),
            "{line}"
        );
        assert!(line.contains("exhibit.toml:"), "{line}");
    }
    assert!(
        stdout(&output).contains("2 warnings"),
        "{}",
        stdout(&output)
    );

    // All pixels are alike: whole, the map is the same picture.
    let sound = exhibit(&[]);
    let output = recto().arg("check").arg(sound.exhibit()).output().unwrap();
    assert!(!code(&output, 0).contains("pixel"));
    let (found, expected) = (render(&faulty), render(&sound));
    assert!(found.iter().flatten().all(|value| value.is_finite()));
    assert_eq!(found, expected);
    // A wrong number is another one.
    let darker = exhibit(&[(6, 0.0), (8, 0.0), (15, 0.0)]);
    assert_ne!(render(&darker), expected);
}
