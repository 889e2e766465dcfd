//! Lamps against E·ρ·cos θ/π.

use std::{path::Path, sync::Arc};

use glam::DVec3;
use recto::{
    manifest::exhibit::LampKind, maps::encode::save_exr_rgb, optics::tier::Tier, units::Candela,
};

use crate::room::{Fixture, darkroom, mean, picture, pixel};

/// Relative error of a frame against the closed form: half floats of the albedo, f32 beyond.
const CLOSED_FORM: f64 = 1e-3;
const ALBEDO: [f32; 3] = [0.5, 0.25, 0.125];
const REFERENCE_LUX: f64 = 500.0;

fn plain(folder: &Path) {
    save_exr_rgb(&folder.join("plain.exr"), 4, 4, &[ALBEDO; 16]).expect("the albedo");
}

/// One scene for each lamp, looking straight at 1 mm around the sheet's centre.
fn manifest(lamps: &[String], more: &str) -> String {
    let mut text = format!(
        "[exhibit]\ntitle = \"Lamps\"\nexposure = {{ lux = {REFERENCE_LUX} }}\n\
         [[drawing]]\nid = \"sheet\"\nsize_mm = [100, 100]\n\
         recto.albedo = {{ file = \"plain.exr\", encoding = \"linear\" }}\n{more}\n"
    );
    for (i, lamp) in lamps.iter().enumerate() {
        text += &format!("[[lamp]]\nid = \"lamp-{i}\"\nkelvin = 6504\n{lamp}\n");
        text += &format!(
            "[[scene]]\nid = \"scene-{i}\"\nlamps = [\"lamp-{i}\"]\n\
             camera = {{ centre_mm = [50, 50], width_mm = 1 }}\n"
        );
    }
    text
}

/// Place in the table frame at this angle from the normal.
fn place(degrees: f64, distance_mm: f64) -> [f64; 3] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [sin * distance_mm, 0.0, cos * distance_mm]
}

#[test]
fn lambert_follows_the_cosine_for_every_punctual_lamp() {
    const ANGLES: [f64; 4] = [0.0, 45.0, 80.0, 89.0];
    const CANDELA: f64 = 250.0;
    const DISTANCE_MM: f64 = 800.0;
    let mut lamps = Vec::new();
    let mut expected = Vec::new();
    for degrees in ANGLES {
        let elevation = 90.0 - degrees;
        lamps.push(format!(
            "kind = \"distant\"\nlux_at_sheet = 700\nelevation_deg = {elevation}\nazimuth_deg = 0"
        ));
        expected.push(700.0 * degrees.to_radians().cos());
        let [x, y, z] = place(degrees, DISTANCE_MM);
        let metres = DISTANCE_MM / 1000.0;
        let lux = CANDELA / (metres * metres) * degrees.to_radians().cos();
        lamps.push(format!(
            "kind = \"point\"\ncandela = {CANDELA}\nposition_mm = [{x}, {y}, {z}]"
        ));
        expected.push(lux);
        lamps.push(format!(
            "kind = \"spot\"\ncandela = {CANDELA}\nposition_mm = [{x}, {y}, {z}]\n\
             hotspot_deg = 5\nfalloff_deg = 20"
        ));
        expected.push(lux);
    }
    let fixture = Fixture::new(&manifest(&lamps, ""), plain);
    let exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    for (scene, lux) in exhibit.scenes.iter().zip(expected) {
        let frame = picture(&mut room, &exhibit, scene, Tier::Lambert, [5, 5]);
        let found = pixel(&frame, 2, 2);
        for (channel, albedo) in found.iter().zip(ALBEDO) {
            let exact = lux * f64::from(albedo) / REFERENCE_LUX;
            assert!(
                (channel / exact - 1.0).abs() < CLOSED_FORM,
                "{}: {channel} where {exact} is due",
                exhibit.lamps[scene.lamps[0]].id
            );
        }
    }
}

#[test]
fn a_wrong_exponent_would_be_found() {
    // The same comparison must fail for light that falls with the distance instead of its
    // square: 0.8 m against 0.64 m².
    let exact = 250.0 / 0.64;
    let wrong: f64 = 250.0 / 0.8;
    assert!((wrong / exact - 1.0).abs() > CLOSED_FORM);
}

#[test]
fn a_rectangle_is_its_form_factor() {
    let lamp = "kind = \"rectangle\"\nlux_at_sheet = 500\nelevation_deg = 90\nazimuth_deg = 0\n\
                distance_mm = 400\nsize_mm = [300, 200]";
    let fixture = Fixture::new(&manifest(&[lamp.into()], ""), plain);
    let exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    let frame = picture(
        &mut room,
        &exhibit,
        &exhibit.scenes[0],
        Tier::Lambert,
        [5, 5],
    );
    // lux_at_sheet is exact for the rectangle; the frame samples it.
    let found = pixel(&frame, 2, 2)[0];
    assert!(
        (found / f64::from(ALBEDO[0]) - 1.0).abs() < CLOSED_FORM,
        "{found}"
    );
}

#[test]
fn a_disc_is_its_closed_form() {
    // π L r²/(r² + d²), seen in a tier that samples the disc.
    let lamp = "kind = \"disc\"\nnits = 2000\nposition_mm = [0, 0, 400]\ndiameter_mm = 300";
    let fixture = Fixture::new(&manifest(&[lamp.into()], ""), plain);
    let exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    let scene = &exhibit.scenes[0];
    let frame = picture(&mut room, &exhibit, scene, Tier::Lambert, [5, 5]);
    let lux =
        std::f64::consts::PI * 2000.0 * 150.0f64.powi(2) / (150.0f64.powi(2) + 400.0f64.powi(2));
    let exact = lux / REFERENCE_LUX * f64::from(ALBEDO[0]);
    let found = pixel(&frame, 2, 2)[0];
    assert!((found / exact - 1.0).abs() < CLOSED_FORM, "{found} {exact}");
}

#[test]
fn an_ies_lamp_follows_its_file_around_and_along_its_axis() {
    // Straight down from 1 m: C = 0° is right and 90° up. Bilinear in both angles, so that the
    // file itself is the closed form; its second lamp stands behind the first in the texture.
    let (vertical, horizontal) = (
        [0.0f64, 30.0, 60.0, 90.0],
        [0.0f64, 90.0, 180.0, 270.0, 360.0],
    );
    let candela = |i: usize, j: usize| (400.0 - 120.0 * i as f64) * (1.0 + 0.2 * (j % 4) as f64);
    let file = |factor: f64| {
        let mut text = String::from("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 4 5 1 2 0 0 0\n1 1 9\n");
        text += "0 30 60 90\n0 90 180 270 360\n";
        for j in 0..5 {
            for i in 0..4 {
                text += &format!("{} ", factor * candela(i, j));
            }
        }
        text
    };
    let lamp =
        |name: &str| format!("kind = \"ies\"\nfile = \"{name}\"\nposition_mm = [0, 0, 1000]");
    let text = manifest(&[lamp("one.ies"), lamp("two.ies")], "")
        .replace("size_mm = [100, 100]", "size_mm = [2000, 2000]")
        .replace(
            "centre_mm = [50, 50], width_mm = 1 }",
            "centre_mm = [1000, 1000], width_mm = 1600 }",
        )
        .replace("lamps = [\"lamp-1\"]", "lamps = [\"lamp-0\", \"lamp-1\"]");
    let fixture = Fixture::new(&text, |folder| {
        plain(folder);
        std::fs::write(folder.join("one.ies"), file(1.0)).expect("a lamp");
        std::fs::write(folder.join("two.ies"), file(0.5)).expect("a lamp");
    });
    let exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    for (scene, factor) in exhibit.scenes.iter().zip([1.0, 1.5]) {
        const SIZE: usize = 16;
        let frame = picture(&mut room, &exhibit, scene, Tier::Lambert, [SIZE as u32; 2]);
        for row in 0..SIZE {
            for column in 0..SIZE {
                let mm = |i: usize| (i as f64 + 0.5 - SIZE as f64 / 2.0) * 100.0;
                let (x, y) = (mm(column), -mm(row));
                let gamma = x.hypot(y).atan2(1000.0).to_degrees();
                let c = y.atan2(x).to_degrees().rem_euclid(360.0);
                let place = |angles: &[f64], at: f64| {
                    let i = angles.partition_point(|angle| *angle <= at) - 1;
                    (i, (at - angles[i]) / (angles[i + 1] - angles[i]))
                };
                let ((i, s), (j, t)) = (place(&vertical, gamma), place(&horizontal, c));
                let along = |j: usize| candela(i, j) * (1.0 - s) + candela(i + 1, j) * s;
                let cd = factor * (along(j) * (1.0 - t) + along(j + 1) * t);
                let lux = cd * gamma.to_radians().cos().powi(3);
                let exact = lux / REFERENCE_LUX * f64::from(ALBEDO[0]);
                let found = pixel(&frame, column as u32, row as u32)[0];
                assert!(
                    (found / exact - 1.0).abs() < CLOSED_FORM,
                    "{x}, {y}: {found} {exact}"
                );
            }
        }
    }
}

#[test]
fn eight_lamps_add_up() {
    let one = "kind = \"distant\"\nlux_at_sheet = 100\nelevation_deg = 30\nazimuth_deg = ";
    let lamps: Vec<String> = (0..8).map(|i| format!("{one}{}", 45 * i)).collect();
    let mut text = manifest(&lamps, "");
    text += "[[scene]]\nid = \"all\"\ncamera = { centre_mm = [50, 50], width_mm = 1 }\nlamps = [";
    for i in 0..8 {
        text += &format!("\"lamp-{i}\", ");
    }
    text += "]\n";
    let fixture = Fixture::new(&text, plain);
    let exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    for tier in [Tier::Lambert, Tier::Draft, Tier::Gallery] {
        let mut sum = 0.0;
        for scene in &exhibit.scenes[..8] {
            sum += pixel(&picture(&mut room, &exhibit, scene, tier, [3, 3]), 1, 1)[1];
        }
        let all = pixel(
            &picture(&mut room, &exhibit, &exhibit.scenes[8], tier, [3, 3]),
            1,
            1,
        )[1];
        assert!((all / sum - 1.0).abs() < 1e-5, "{tier}: {all} {sum}");
    }
}

#[test]
fn the_room_s_even_light_shows_the_albedo_and_darkness_is_dark() {
    let lamp =
        |candela: f64| format!("kind = \"point\"\ncandela = {candela}\nposition_mm = [0, 0, 9]");
    let text = manifest(&[lamp(1000.0), lamp(900.0)], "")
        + "[[scene]]\nid = \"even\"\nlamps = []\nambient = { lux = 500 }\n\
           camera = { centre_mm = [50, 50], width_mm = 1 }\n";
    let fixture = Fixture::new(&text, plain);
    let mut exhibit = fixture.exhibit();
    // A manifest cannot put a lamp there; a hand that moves one can.
    let places = [DVec3::new(0.0, 0.0, -300.0), DVec3::new(200.0, 0.0, 0.0)];
    let lamps = &mut Arc::get_mut(&mut exhibit).expect("only here").lamps;
    for (lamp, position_mm) in lamps.iter_mut().zip(places) {
        lamp.kind = LampKind::Point {
            intensity: Candela(1000.0),
            position_mm,
        };
    }
    let mut room = darkroom(1);
    let even = picture(
        &mut room,
        &exhibit,
        &exhibit.scenes[2],
        Tier::Lambert,
        [3, 3],
    );
    assert!((pixel(&even, 1, 1)[0] / f64::from(ALBEDO[0]) - 1.0).abs() < CLOSED_FORM);
    for tier in [Tier::Lambert, Tier::Draft, Tier::Gallery] {
        for scene in &exhibit.scenes[..2] {
            let dark = picture(&mut room, &exhibit, scene, tier, [3, 3]);
            assert!(
                dark.pixels.iter().flatten().all(|value| *value == 0.0),
                "{tier}"
            );
        }
    }
}

#[test]
fn tiers_stay_finite_where_numbers_are_hard() {
    // Mirror-smooth and perfectly rough, lit and seen from everywhere, huge and tiny.
    let mut lamps = Vec::new();
    for elevation in [90.0, 45.0, 0.5] {
        for lux in [1e-3, 1e5] {
            lamps.push(format!(
                "kind = \"distant\"\nlux_at_sheet = {lux}\nelevation_deg = {elevation}\n\
                 azimuth_deg = 90"
            ));
        }
    }
    lamps.push("kind = \"point\"\nlumen = 10000\nposition_mm = [0, 0, 1]".into());
    let fixture = Fixture::new(&manifest(&lamps, ""), plain);
    let mut room = darkroom(1);
    for roughness in [0.0, 1e-4, 1.0] {
        let mut exhibit = fixture.exhibit();
        Arc::get_mut(&mut exhibit).expect("only here").drawings[0]
            .paper
            .roughness = roughness;
        for scene in &exhibit.scenes {
            for tilt in [0.0, 45.0, 89.0] {
                let mut scene = scene.clone();
                scene.camera.tilt.0 = tilt;
                for tier in [Tier::Lambert, Tier::Draft, Tier::Gallery] {
                    let frame = picture(&mut room, &exhibit, &scene, tier, [9, 9]);
                    let sound = |v: &f32| v.is_finite() && *v >= 0.0 && *v <= 65504.0;
                    assert!(
                        frame.pixels.iter().flatten().all(sound),
                        "{tier}, roughness {roughness}, {} at tilt {tilt}",
                        scene.id
                    );
                }
            }
        }
    }
}

#[test]
fn a_raking_lamp_on_the_left_brightens_what_faces_left() {
    // A ridge along y: its left flank must be the brighter one, with the lamp on the left.
    let text = manifest(
        &["kind = \"distant\"\nlux_at_sheet = 500\nelevation_deg = 20\nazimuth_deg = 180".into()],
        "recto.height = { file = \"ridge.png\", range_um = [0, 4000] }",
    )
    .replace("width_mm = 1 }", "width_mm = 100 }");
    let fixture = Fixture::new(&text, |folder| {
        plain(folder);
        // The side's maps are equal in size: a plain of the ridge's size.
        let ridge: Vec<u16> = (0..64 * 64)
            .map(|i| {
                let x = f64::from(i % 64) - 31.5;
                (65535.0 * (-x * x / 200.0).exp()) as u16
            })
            .collect();
        recto::maps::encode::save_png_grey16(&folder.join("ridge.png"), 64, 64, &ridge, None)
            .expect("the ridge");
        save_exr_rgb(&folder.join("plain.exr"), 64, 64, &[ALBEDO; 64 * 64]).expect("the albedo");
    });
    let exhibit = fixture.exhibit();
    let mut room = darkroom(1);
    let frame = picture(
        &mut room,
        &exhibit,
        &exhibit.scenes[0],
        Tier::Gallery,
        [64, 64],
    );
    let (left, right) = (
        mean(&frame, [16, 20], [30, 44]),
        mean(&frame, [34, 20], [48, 44]),
    );
    assert!(left > 1.5 * right, "left {left}, right {right}");
}
