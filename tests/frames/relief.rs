//! The scale effect: relief from close by and from far away has one mean radiance.

use std::f64::consts::TAU;

use recto::{
    maps::encode::{save_exr_rgb, save_png_grey16, save_png_rgb16},
    optics::tier::Tier,
};

use crate::room::{Fixture, darkroom, mean, picture};

/// Texels along each edge of the patch; each is one pixel from close by.
const TEXELS: u32 = 256;
/// Texels of one period of the ripples.
const PERIOD: u32 = 16;
const STEEP: f64 = 0.15;
/// Diffuse light: 16-bit texels of three components. 1e-5 was measured.
const DIFFUSE: f64 = 2e-4;
/// The widened lobe is not quite the mean of the near ones, and T bends over the facets: at
/// most 3.3e-3 was measured, at 15°. Half of what the shortening is worth.
const WITH_LOBE: f64 = 5e-3;

fn rippled() -> Fixture {
    let mut text = String::from(
        "[exhibit]\ntitle = \"Ripples\"\nexposure = { lux = 500 }\n\
         [[drawing]]\nid = \"sheet\"\nsize_mm = [64, 64]\n\
         [drawing.recto]\nalbedo = { file = \"plain.exr\", encoding = \"linear\" }\n\
         normal = { file = \"normal.png\", y = \"up\" }\n",
    );
    for elevation in [90, 45, 15] {
        text += &format!(
            "[[lamp]]\nid = \"lamp-{elevation}\"\nkind = \"distant\"\nlux_at_sheet = 500\n\
             elevation_deg = {elevation}\nazimuth_deg = 30\n"
        );
        for (name, width) in [("near", 32), ("far", 2048)] {
            text += &format!(
                "[[scene]]\nid = \"{name}-{elevation}\"\nlamps = [\"lamp-{elevation}\"]\n\
                 camera = {{ centre_mm = [32, 32], width_mm = {width} }}\n"
            );
        }
    }
    Fixture::new(&text, |folder| {
        let plain = vec![[0.5; 3]; (TEXELS * TEXELS) as usize];
        save_exr_rgb(&folder.join("plain.exr"), TEXELS, TEXELS, &plain).expect("the albedo");
        let slope = |i: u32| STEEP * (TAU * (f64::from(i) + 0.5) / f64::from(PERIOD)).cos();
        let pixels: Vec<[u16; 3]> = (0..TEXELS * TEXELS)
            .map(|i| {
                let (x, y) = (slope(i % TEXELS), slope(i / TEXELS));
                let length = (x * x + y * y + 1.0).sqrt();
                [-x, -y, 1.0].map(|v| ((v / length * 32767.0).round() + 32768.0) as u16)
            })
            .collect();
        let path = folder.join("normal.png");
        save_png_rgb16(&path, TEXELS, TEXELS, &pixels, None).expect("the normals");
    })
}

#[test]
fn near_and_far_relief_have_one_mean_radiance() {
    let fixture = rippled();
    let exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    for (tier, tolerance) in [
        (Tier::Lambert, DIFFUSE),
        (Tier::Draft, WITH_LOBE),
        (Tier::Gallery, WITH_LOBE),
    ] {
        for scenes in exhibit.scenes.chunks(2) {
            // Close by a texel is a pixel; from far the sheet is 8 pixels wide, and the middle 4
            // are within it.
            let near = picture(&mut room, &exhibit, &scenes[0], tier, [128, 128]);
            let far = picture(&mut room, &exhibit, &scenes[1], tier, [256, 256]);
            let near = mean(&near, [0, 0], [128, 128]);
            let far = mean(&far, [126, 126], [130, 130]);
            eprintln!(
                "{tier} {}: near {near:.5}, far {far:.5}, {:+.5}",
                scenes[0].id,
                far / near - 1.0
            );
            assert!(
                (far / near - 1.0).abs() < tolerance,
                "{tier}, {}: near {near}, far {far}",
                scenes[0].id
            );
            // What the unit normal along the mean would show: 1/|m| more.
            let full_length = far * (1.0 + STEEP * STEEP).sqrt();
            assert!(full_length / near - 1.0 > tolerance, "the test cannot fail");
        }
    }
}

/// Heights of the ridge's map along each edge of 32 mm: an eighth of a mm each.
const HEIGHTS: u32 = 256;
const RIDGE_MM: f64 = 0.2;
/// Of the ridge's shadow, pixels in a mm.
const ZOOM: u32 = 32;

fn ridged() -> Fixture {
    let mut text = String::from(
        "[exhibit]\ntitle = \"Ridge\"\nexposure = { lux = 500 }\n\
         [[drawing]]\nid = \"sheet\"\nsize_mm = [32, 32]\n\
         [drawing.recto]\nalbedo = { file = \"plain.exr\", encoding = \"linear\" }\n\
         height = { file = \"height.png\", range_um = [0, 200] }\n",
    );
    for (side, azimuth) in [("left", 180), ("top", 90)] {
        text += &format!(
            "[[lamp]]\nid = \"{side}\"\nkind = \"distant\"\nlux_at_sheet = 500\n\
             elevation_deg = 15\nazimuth_deg = {azimuth}\n\
             [[scene]]\nid = \"{side}\"\nlamps = [\"{side}\"]\n\
             camera = {{ centre_mm = [16, 16], width_mm = 8 }}\n"
        );
    }
    Fixture::new(&text, |folder| {
        let plain = vec![[0.5; 3]; (HEIGHTS * HEIGHTS) as usize];
        save_exr_rgb(&folder.join("plain.exr"), HEIGHTS, HEIGHTS, &plain).expect("the albedo");
        // An L: a millimetre to the left of the middle, and a millimetre above it.
        let low = |i: u32| !(120..128).contains(&i);
        let pixels: Vec<u16> = (0..HEIGHTS * HEIGHTS)
            .map(|i| {
                let flat = low(i % HEIGHTS) && low(i / HEIGHTS);
                if flat { 0 } else { u16::MAX }
            })
            .collect();
        let path = folder.join("height.png");
        save_png_grey16(&path, HEIGHTS, HEIGHTS, &pixels, None).expect("the heights");
    })
}

#[test]
fn a_ridge_shadows_the_paper_behind_it() {
    let fixture = ridged();
    let exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    let size = 8 * ZOOM;
    // A texel for the soft edge and one for the filtered foot of the ridge, in mm.
    const STEP: f64 = 0.25;
    let long = RIDGE_MM / 15f64.to_radians().tan();
    for scene in &exhibit.scenes {
        let [study, draft] = [Tier::Study, Tier::Draft]
            .map(|tier| picture(&mut room, &exhibit, scene, tier, [size; 2]));
        // Across the ridge that the lamp faces, where the other one does not reach.
        let at = |along: u32| {
            let other = 6 * ZOOM;
            let (x, y) = match scene.id.as_str() {
                "left" => (along, other),
                _ => (other, along),
            };
            ([x, y], [x + 1, y + 1])
        };
        let paper = mean(&study, at(7 * ZOOM).0, at(7 * ZOOM).1);
        // From half a texel behind the foot on: its own slope faces away.
        let foot = 4 * ZOOM + ZOOM / 8;
        let dark = |of: &_, i: u32| mean(of, at(i).0, at(i).1) < 0.5 * paper;
        let shadow = (foot..7 * ZOOM).take_while(|&i| dark(&study, i)).count();
        let length = shadow as f64 / f64::from(ZOOM) + 0.125;
        eprintln!("{}: {length:.3} mm of {long:.3}", scene.id);
        assert!(
            (length - long).abs() < STEP,
            "{}: {length}, not {long}",
            scene.id
        );
        // Before the ridge, on the lamp's side, and in the draft tier there is none.
        let before = 3 * ZOOM - ZOOM / 2;
        assert!((mean(&study, at(before).0, at(before).1) / paper - 1.0).abs() < 1e-3);
        assert!((foot..7 * ZOOM).all(|i| !dark(&draft, i + ZOOM / 8)));
    }
}
