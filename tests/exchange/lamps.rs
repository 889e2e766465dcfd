//! Files of lamps → capture files that `recto prepare` takes.

use std::fs;

use glam::DVec3;
use image::RgbImage;
use recto::{
    exchange::Known,
    manifest::Severity,
    prepare::capture::{Capture, Places},
};
use serde_json::json;

use super::{Desk, support};

fn photograph(desk: &Desk, name: &str) {
    let path = desk.folder().join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    // Each is another picture.
    let own = name
        .bytes()
        .fold(0, |sum: u8, byte| sum.wrapping_mul(31).wrapping_add(byte));
    RgbImage::from_pixel(20, 10, [120, 110, own].into())
        .save(path)
        .unwrap();
}

fn capture(desk: &Desk, name: &str, known: &Known) -> (Capture, String) {
    let imported = desk
        .import_knowing(name, known)
        .unwrap_or_else(|error| panic!("{error}"));
    assert!(imported.is_capture);
    assert_eq!(imported.file, desk.out().join("capture.toml"));
    let (capture, _) = Capture::read(&desk.out()).unwrap_or_else(|faults| panic!("{faults}"));
    assert!(
        imported
            .warnings
            .iter()
            .all(|w| w.severity == Severity::Warning)
    );
    let warnings: Vec<String> = imported.warnings.iter().map(ToString::to_string).collect();
    (capture, warnings.join("\n"))
}

const LP: &str = "4\nC:\\dome\\a 1.png 0.6 0 0.8\nb.png 0 0.6 0.8\nc.png -0.6 0 0.8\nd.png 0 0 1\n";

#[test]
fn directions_and_their_photographs_become_a_capture() {
    let desk = Desk::new();
    for name in ["a 1.png", "b.png", "c.png", "d.png"] {
        photograph(&desk, &format!("photos/{name}"));
    }
    desk.write("photos/lamps.lp", LP);
    let (found, warnings) = capture(&desk, "photos/lamps.lp", &Known::default());
    let Places::Directions(lamps) = found.lamps.places else {
        panic!("{:?}", found.lamps.places)
    };
    assert_eq!(lamps[1], DVec3::new(0.0, 0.6, 0.8));
    assert_eq!(lamps.len(), 4);
    assert!(found.recto.photographs[0].ends_with("a 1.png"));
    assert_eq!(found.mm_per_px, 0.1);
    assert!(warnings.contains("how large a pixel is"), "{warnings}");
    let text = fs::read_to_string(desk.out().join("capture.toml")).unwrap();
    // The folder can be moved with both.
    assert!(text.contains("\"../in/photos/a 1.png\""), "{text}");

    // The photographs may be elsewhere, and the size may be known.
    let desk = Desk::new();
    for name in ["a 1.png", "b.png", "c.png", "d.png"] {
        photograph(&desk, &format!("elsewhere/{name}"));
    }
    desk.write("lamps.lp", LP);
    let refusal = desk.refusal("lamps.lp");
    assert!(
        refusal.contains("4 of 4 photographs missing") && refusal.contains("--photographs"),
        "{refusal}"
    );
    let known = Known {
        size_mm: Some([5.0, 2.5]),
        photographs: Some(desk.folder().join("elsewhere")),
    };
    let (found, warnings) = capture(&desk, "lamps.lp", &known);
    assert_eq!(found.mm_per_px, 0.25);
    assert!(warnings.is_empty(), "{warnings}");
}

#[test]
fn a_real_file_of_240_lamps_is_read() {
    let Some(folder) = support::data(crate::test_name!(), "rti_lion") else {
        return;
    };
    let desk = Desk::new();
    let imported = recto::exchange::import(&folder.join("dirs.lp"), &desk.out(), &Known::default());
    imported.unwrap_or_else(|error| panic!("{error}"));
    let (found, _) = Capture::read(&desk.out()).unwrap_or_else(|faults| panic!("{faults}"));
    assert_eq!(found.recto.photographs.len(), 240);
}

fn dome(configuration: &str) -> serde_json::Value {
    let vector = |v: DVec3| json!({ "x": v.x, "y": v.y, "z": v.z });
    let directions = [
        DVec3::new(0.6, 0.0, 0.8),
        DVec3::new(0.0, 0.6, 0.8),
        DVec3::new(-0.6, 0.0, 0.8),
        DVec3::Z,
    ];
    let all = |factor: f64| directions.map(|l| vector(l * factor));
    json!({
        "label": "Dome", "notes": "", "imageWidth": 100.0, "domeDiameter": 600.0,
        "verticalOffset": 0.0, "lightConfiguration": configuration,
        "directions": all(1.0), "positionsSphere": all(300.0), "positions3d": all(310.0),
        "ledAdjust": [],
    })
}

#[test]
fn a_dome_and_its_photographs_become_a_capture() {
    for (configuration, radius) in [
        ("directional", None),
        ("spherical", Some(300.0)),
        ("lights3d", Some(310.0)),
    ] {
        let desk = Desk::new();
        // In the order of their numbers.
        for i in [10, 9, 8, 11] {
            photograph(&desk, &format!("img{i}.png"));
        }
        desk.write("mine.dome", dome(configuration).to_string());
        let (found, warnings) = capture(&desk, "mine.dome", &Known::default());
        assert!(warnings.is_empty(), "{warnings}");
        // 100 mm over 20 pixels.
        assert_eq!(found.mm_per_px, 5.0);
        assert!(found.recto.photographs[0].ends_with("img8.png"));
        assert!(found.recto.photographs[3].ends_with("img11.png"));
        let (lamps, expected) = match (&found.lamps.places, radius) {
            (Places::Directions(lamps), None) => (lamps, 1.0),
            (Places::Positions(lamps), Some(radius)) => (lamps, radius),
            other => panic!("{other:?}"),
        };
        let off = (lamps[1] - DVec3::new(0.0, 0.6, 0.8) * expected).length();
        assert!(off < 1e-3 * expected, "{lamps:?}");
    }
}

#[test]
fn domes_that_do_not_fit_are_refused_in_words() {
    let photographs = |desk: &Desk, count: usize| {
        (0..count).for_each(|i| photograph(desk, &format!("{i}.png")));
    };
    let desk = Desk::new();
    photographs(&desk, 3);
    desk.write("mine.dome", dome("directional").to_string());
    let words = desk.refusal("mine.dome");
    assert!(words.contains("4 lamps, and 3 photographs"), "{words}");

    let desk = Desk::new();
    photographs(&desk, 4);
    let mut behind = dome("directional");
    behind["directions"][2]["z"] = json!(-0.5);
    behind["directions"][3] = json!({ "x": 1 });
    desk.write("mine.dome", behind.to_string());
    let words = desk.refusal("mine.dome");
    assert!(
        words.contains("directions[2]") && words.contains("directions[3]"),
        "{words}"
    );

    // Two lamps, or lamps in one plane, tell nothing.
    for count in [2, 3] {
        let desk = Desk::new();
        photographs(&desk, count);
        let lamps: Vec<_> = (0..count)
            .map(|i| json!([0.1 * i as f64, 0.0, 1.0]))
            .collect();
        desk.write("flat.dome", json!({ "directions": lamps }).to_string());
        let error = desk.import("flat.dome").expect_err("refused").to_string();
        assert!(error.contains("lamps"), "{error}");
        assert!(!desk.out().exists());
    }
    // An older file in cm seems to have its lamps on the sheet.
    let desk = Desk::new();
    photographs(&desk, 4);
    let mut small = dome("spherical");
    for lamp in small["positionsSphere"].as_array_mut().unwrap() {
        for axis in ["x", "y", "z"] {
            lamp[axis] = json!(lamp[axis].as_f64().unwrap() / 30.0);
        }
    }
    desk.write("cm.dome", small.to_string());
    let (found, warnings) = capture(&desk, "cm.dome", &Known::default());
    assert!(warnings.contains("cm"), "{warnings}");
    assert!(matches!(found.lamps.places, Places::Directions(_)));
}

#[test]
fn faults_name_the_file_that_is_imported_and_its_own_keys() {
    let refusal = |change: &dyn Fn(&mut serde_json::Value), configuration: &str| {
        let desk = Desk::new();
        for i in 0..4 {
            photograph(&desk, &format!("{i}.png"));
        }
        let mut dome = dome(configuration);
        change(&mut dome);
        desk.write("mine.dome", dome.to_string());
        let words = desk.refusal("mine.dome");
        assert!(
            words.lines().all(|line| line.contains("mine.dome: "))
                && !words.contains("capture.toml"),
            "{words}"
        );
        words
    };
    let wide = refusal(&|v| v["imageWidth"] = json!(1e9), "directional");
    assert!(
        wide.contains("mine.dome: imageWidth: found 1000000000; allowed: 0.02 to 200 mm"),
        "{wide}"
    );
    for width in [json!(-3), json!("wide"), json!([])] {
        let words = refusal(&|v| v["imageWidth"] = width.clone(), "directional");
        assert!(words.contains("mine.dome: imageWidth: found "), "{words}");
    }
    let low = refusal(&|v| v["directions"][1]["z"] = json!(0.001), "directional");
    assert!(low.contains("directions[1]"), "{low}");
    let far = refusal(&|v| v["positions3d"][2]["x"] = json!(1e7), "lights3d");
    assert!(far.contains("positions3d[2]"), "{far}");
    let on_it = refusal(
        &|v| v["positionsSphere"][0]["z"] = json!(0.001),
        "spherical",
    );
    assert!(on_it.contains("positionsSphere[0]"), "{on_it}");
    // What is only found in the capture is told of the dome all the same.
    let alike = refusal(
        &|v| v["directions"] = json!(vec![[0.1, 0.1, 1.0]; 4]),
        "directional",
    );
    assert!(
        alike.contains("what was made of it is refused: lamps"),
        "{alike}"
    );

    let desk = Desk::new();
    for i in 0..4 {
        photograph(&desk, &format!("{i}.png"));
    }
    desk.write("mine.dome", dome("directional").to_string());
    let known = Known {
        size_mm: Some([5000.0, 2500.0]),
        ..Known::default()
    };
    let error = desk
        .import_knowing("mine.dome", &known)
        .expect_err("refused");
    assert!(error.to_string().contains("--size-mm"), "{error}");
    // 0 is what RelightLab writes of what it does not know.
    let mut unknown = dome("directional");
    unknown["imageWidth"] = json!(0);
    desk.write("mine.dome", unknown.to_string());
    let (found, _) = capture(&desk, "mine.dome", &Known::default());
    assert_eq!(found.mm_per_px, 0.1);
}
