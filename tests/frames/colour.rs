//! Colours shown must be colours meant: the ColorChecker through the whole program.

use std::process::Command;

use recto::{
    colour::{
        D65, bradford, delta_e00, lab_from_linear, linear_from_srgb8, linear_from_xyz, xyz_from_xyy,
    },
    maps::encode::save_exr_rgb,
};

use crate::{room::Fixture, support::data};

/// ΔE00 of a patch of 8-bit sRGB against its measured colour.
const SHOWN: f64 = 0.5;
/// Pixels of a patch, and patches in a row of the chart.
const PATCH: u32 = 16;
const COLUMNS: u32 = 6;

/// Name and linear sRGB (Bradford-adapted to D65) of the 24 patches, in the chart's order.
fn patches() -> Option<Vec<(String, [f64; 3])>> {
    let file = data(crate::test_name!(), "colorchecker/colorchecker24.json")?;
    let text = std::fs::read_to_string(file).expect("the chart");
    let json: serde_json::Value = serde_json::from_str(&text).expect("the chart's JSON");
    let chart = &json["chromaticities_xyY"]["ColorChecker24 - After November 2014"];
    let white: [f64; 2] =
        serde_json::from_value(chart["illuminant_xy"].clone()).expect("the chart's white");
    let adapt = bradford(white, D65);
    let patches = chart["patches"].as_object().expect("patches").iter();
    let patches: Vec<(String, [f64; 3])> = patches
        .map(|(name, xyy)| {
            let xyy: [f64; 3] = serde_json::from_value(xyy.clone()).expect("xyY");
            let xyz = adapt * glam::DVec3::from(xyz_from_xyy(xyy));
            (name.clone(), linear_from_xyz(xyz.into()))
        })
        .collect();
    assert_eq!(patches.len(), 24);
    Some(patches)
}

/// The chart as a sheet without specular reflection under the reference lamp, 45°/0°.
fn chart(patches: &[(String, [f64; 3])]) -> Fixture {
    let manifest = "[exhibit]\ntitle = \"Chart\"\n\
        [[drawing]]\nid = \"chart\"\nsize_mm = [60, 40]\n\
        paper = { kind = \"laid\", specular = 0 }\n\
        recto.albedo = { file = \"chart.exr\", encoding = \"linear\" }\n\
        [[lamp]]\nid = \"reference\"\nkind = \"distant\"\nlux_at_sheet = 1000\nkelvin = 6504\n\
        elevation_deg = 45\nazimuth_deg = 135\n\
        [[scene]]\nid = \"chart\"\ncamera = { centre_mm = [30, 20], width_mm = 60 }\n";
    Fixture::new(manifest, |folder| {
        let (width, height) = (COLUMNS * PATCH, 4 * PATCH);
        let pixels: Vec<[f32; 3]> = (0..width * height)
            .map(|i| {
                let (x, y) = (i % width / PATCH, i / width / PATCH);
                patches[(y * COLUMNS + x) as usize].1.map(|v| v as f32)
            })
            .collect();
        save_exr_rgb(&folder.join("chart.exr"), width, height, &pixels).expect("the chart");
    })
}

fn render(fixture: &Fixture, tier: &str, name: &str) -> std::path::PathBuf {
    let out = fixture.folder.path().join(name);
    let output = Command::new(env!("CARGO_BIN_EXE_recto"))
        .arg("render")
        .arg(fixture.folder.path())
        .args(["--tier", tier, "--size", "192x128", "--out"])
        .arg(&out)
        .output()
        .expect("recto runs");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    out
}

#[test]
fn every_patch_in_srgb_comes_out_as_measured() {
    let Some(patches) = patches() else { return };
    let fixture = chart(&patches);
    for tier in ["lambert", "draft", "gallery"] {
        let file = render(&fixture, tier, &format!("{tier}.png"));
        let frame = image::open(file).expect("the frame").into_rgb8();
        let mut judged = 0;
        for (i, (name, linear)) in patches.iter().enumerate() {
            // Cyan lies outside sRGB; an 8-bit file cannot hold it.
            if linear.iter().any(|v| !(0.0..=1.0).contains(v)) {
                assert_eq!(name, "cyan");
                continue;
            }
            let (column, row) = (i as u32 % COLUMNS, i as u32 / COLUMNS);
            let shown = frame.get_pixel(column * 32 + 16, row * 32 + 16).0;
            let shown = lab_from_linear(linear_from_srgb8(shown));
            let delta = delta_e00(shown, lab_from_linear(*linear));
            assert!(delta < SHOWN, "{tier}, {name}: ΔE00 {delta}");
            judged += 1;
        }
        assert_eq!(judged, 23);
    }
}

#[test]
fn cyan_keeps_its_negative_red_in_the_float_file() {
    let Some(patches) = patches() else { return };
    let fixture = chart(&patches);
    let (i, (_, linear)) = patches
        .iter()
        .enumerate()
        .find(|(_, (name, _))| name == "cyan")
        .expect("cyan");
    let file = render(&fixture, "gallery", "light.exr");
    let frame = exr::prelude::read_first_rgba_layer_from_file(
        file,
        |size, _| (size.width(), vec![[0f32; 3]; size.width() * size.height()]),
        |(width, pixels), at, (r, g, b, _): (f32, f32, f32, f32)| {
            pixels[at.y() * *width + at.x()] = [r, g, b];
        },
    )
    .expect("the frame");
    let (width, pixels) = frame.layer_data.channel_data.pixels;
    let (column, row) = (i % COLUMNS as usize, i / COLUMNS as usize);
    // The lamp comes from 45°, so the chart shows its albedo times that cosine over the
    // illuminance that the exposure is anchored to: its own.
    let shown = pixels[(row * 32 + 16) * width + column * 32 + 16].map(f64::from);
    assert!(shown[0] < 0.0, "{shown:?}");
    let delta = delta_e00(lab_from_linear(shown), lab_from_linear(*linear));
    assert!(delta < SHOWN, "cyan: ΔE00 {delta}");
}

#[test]
fn a_patch_off_by_one_step_of_display_would_be_found() {
    // The comparator must see a difference of the size it claims to.
    let a = lab_from_linear(linear_from_srgb8([118, 118, 118]));
    let b = lab_from_linear(linear_from_srgb8([120, 118, 118]));
    assert!(delta_e00(a, b) > SHOWN);
}
