//! An exhibit goes out as IIIF and comes back; manifests of others come in.

use std::{collections::HashSet, fs, path::Path};

use glam::DVec2;
use image::{GrayImage, RgbImage};
use recto::{
    exchange::{self, DEFAULT_BASE, ExchangeError, Exported, Known},
    manifest::{Exhibit, OverlayKind, SideName, staging::StagingError},
    maps,
};
use serde_json::{Value, json};

use super::Desk;

/// An exhibit of everything that IIIF has a place for.
const EXHIBIT: &str = r##"
[exhibit]
title = { en = "Two sheets", it = "Due fogli", ja = "二枚" }
languages = ["en", "it", "ja"]

[[drawing]]
id = "valley"
title = { en = "Valley", it = "Valle" }
caption = { en = "Pen, \"two\" inks", it = "Penna" }
credit = "The museum, CC BY 4.0 (https://creativecommons.org/licenses/by/4.0/)"
date = "1473"
inventory = "8P"
size_mm = [120.0, 80.3]
recto.albedo = "recto.png"
verso = { albedo = "verso.jpg", register = { flip = "horizontal" } }

[[drawing.state]]
id = "before"
title = { en = "Before 1998", it = "Prima del 1998" }
date = "1997-11"
recto.albedo = "before.png"
verso.albedo = "verso.jpg"

[[drawing.state]]
id = "shifted"
recto = { albedo = "before.png", register = { offset_mm = [12.0, 0.0] } }

[[drawing.stack]]
id = "bands"
title = { en = "Bands" }
bands = [{ file = "grey.png", wavelength_nm = 940.5 }, { file = "grey.png", wavelength_nm = 550 }]

[[drawing.overlay]]
id = "infrared"
title = { en = "Infrared" }
kind = "picture"
file = "grey.png"
encoding = "linear"

[[drawing.overlay]]
id = "damage"
title = { en = "Damage" }
side = "verso"
kind = "categorical"
file = "damage.png"
legend = [{ colour = "#d55e00", label = { en = "Tear", it = "Strappo" } }]

[[drawing.hotspot]]
id = "town"
polygon_mm = [[10.5, 20.25], [40.0, 20.0], [33.3, 60.0]]
title = { en = "The town", it = "La città" }
text = { en = "It moved.\nTwice.", it = "Si è spostata." }

[[drawing.hotspot]]
id = "stamp"
side = "verso"
polygon_mm = [[100, 10], [110, 10], [110, 20], [100, 20]]
title = { en = "Stamp" }

[[drawing]]
id = "chart"
size_mm = [50, 50]
recto.albedo = "square.png"
"##;

fn exhibit(folder: &Path) -> Exhibit {
    fs::create_dir_all(folder).unwrap();
    let save = |name: &str, [width, height]: [u32; 2], at: fn(u32) -> [u8; 3]| {
        let picture = RgbImage::from_fn(width, height, |x, _| at(x).into());
        picture.save(folder.join(name)).unwrap();
    };
    save("recto.png", [241, 161], |x| [200, 190, x as u8]);
    save("verso.jpg", [240, 161], |_| [180, 170, 150]);
    save("square.png", [64, 64], |_| [90, 120, 150]);
    // Black to the left of the middle, white to its right.
    save("before.png", [120, 80], |x| {
        [if x < 60 { 0 } else { 255 }; 3]
    });
    save("damage.png", [120, 80], |x| {
        if x < 30 { [0xd5, 0x5e, 0x00] } else { [255; 3] }
    });
    GrayImage::from_pixel(120, 80, [128].into())
        .save(folder.join("grey.png"))
        .unwrap();
    fs::write(folder.join("exhibit.toml"), EXHIBIT).unwrap();
    Exhibit::read(folder)
        .unwrap_or_else(|faults| panic!("{faults}"))
        .0
}

/// The exhibit, and what it was exported to, in the desk's folder.
fn exported(desk: &Desk, base: &str) -> (Exhibit, Exported, Value) {
    let exhibit = exhibit(&desk.root.path().join("exhibit"));
    let exported = exchange::export_iiif(&exhibit, &desk.folder(), base);
    let exported = exported.unwrap_or_else(|error| panic!("{error}"));
    let json = fs::read(&exported.manifest).unwrap();
    (exhibit, exported, serde_json::from_slice(&json).unwrap())
}

/// What Presentation 3 asks of each resource (sections 3 and 5, and appendix A).
fn check_resource(value: &Value, ids: &mut HashSet<String>) {
    match value {
        Value::Array(list) => list.iter().for_each(|value| check_resource(value, ids)),
        Value::Object(object) => {
            let kind = object
                .get("type")
                .and_then(Value::as_str)
                .unwrap_or_default();
            let is_reference = kind == "Canvas" && !object.contains_key("items");
            if !matches!(
                kind,
                "" | "TextualBody" | "Choice" | "SpecificResource" | "SvgSelector"
            ) {
                let id = object["id"]
                    .as_str()
                    .unwrap_or_else(|| panic!("no id: {value}"));
                assert!(id.starts_with("http"), "{id}");
                // Pictures may be in several places, and thumbnails are.
                assert!(
                    ids.insert(id.to_owned()) || is_reference || kind == "Image",
                    "{id} twice"
                );
            }
            let needed: &[&str] = match kind {
                "Manifest" => &["@context", "label", "items"],
                "Canvas" if !is_reference => &["label", "width", "height", "items"],
                "AnnotationPage" | "Choice" | "Range" => &["items"],
                "Annotation" => &["motivation", "body", "target"],
                "Image" => &["format", "width", "height"],
                "TextualBody" => &["value", "language"],
                _ => &[],
            };
            for key in needed {
                assert!(object.contains_key(*key), "{kind} without {key}: {value}");
            }
            for key in ["label", "summary"] {
                if let Some(map) = object.get(key) {
                    check_language_map(map);
                }
            }
            for key in ["width", "height"] {
                let side = object.get(key);
                assert!(side.is_none_or(|side| side.as_u64().is_some_and(|side| side > 0)));
            }
            let entries = object.get("metadata").and_then(Value::as_array);
            for entry in entries
                .into_iter()
                .flatten()
                .chain(object.get("requiredStatement"))
            {
                check_language_map(&entry["label"]);
                check_language_map(&entry["value"]);
            }
            if let Some(service) = object.get("service") {
                for service in service.as_array().expect("a list") {
                    assert!(service["@id"].is_string() && service["@type"].is_string());
                }
            }
            let nested = ["items", "annotations", "body", "thumbnail", "structures"];
            nested
                .iter()
                .filter_map(|key| object.get(*key))
                .for_each(|value| check_resource(value, ids));
        }
        _ => {}
    }
}

fn check_language_map(map: &Value) {
    let map = map.as_object().expect("a language map");
    assert!(!map.is_empty());
    for list in map.values() {
        let list = list.as_array().expect("a list");
        assert!(
            !list.is_empty() && list.iter().all(Value::is_string),
            "{map:?}"
        );
    }
}

#[test]
fn what_is_exported_keeps_the_rules_of_presentation_3() {
    let desk = Desk::new();
    let (_, exported, json) = exported(&desk, "https://museum.example/iiif/valley");
    assert_eq!(exported.canvases, 3);
    // Recto: itself, two states, two bands, infrared. Verso: itself, a state, damage. The chart.
    assert_eq!(exported.pictures, 10);
    let mut ids = HashSet::new();
    check_resource(&json, &mut ids);
    assert_eq!(
        json["id"],
        "https://museum.example/iiif/valley/manifest.json"
    );
    assert_eq!(
        json["rights"],
        "http://creativecommons.org/licenses/by/4.0/"
    );
    assert_eq!(json["label"]["ja"][0], "二枚");
    // Every picture is where its address says, and of the size it says.
    let base = "https://museum.example/iiif/valley/";
    let pictures: Vec<&String> = ids.iter().filter(|id| id.contains("/images/")).collect();
    assert_eq!(pictures.len(), 13);
    for id in pictures {
        let file = desk.folder().join(id.strip_prefix(base).expect("its base"));
        maps::verify(&file).unwrap_or_else(|error| panic!("{error}"));
    }
    let canvas = &json["items"][0];
    assert_eq!(canvas["label"]["it"][0], "Valle, recto");
    let service = &canvas["service"][0];
    let width_mm = service["physicalScale"].as_f64().unwrap() * canvas["width"].as_f64().unwrap();
    assert!((width_mm - 120.0).abs() < 1e-9 && service["physicalUnits"] == "mm");
    assert_eq!(
        canvas["items"][0]["items"][0]["body"]["items"]
            .as_array()
            .unwrap()
            .len(),
        6
    );
    // One picture is no choice.
    assert_eq!(
        json["items"][2]["items"][0]["items"][0]["body"]["type"],
        "Image"
    );
    assert_eq!(json["structures"][0]["items"].as_array().unwrap().len(), 2);
    let damage = &json["items"][1]["items"][0]["items"][0]["body"]["items"][2];
    assert_eq!(damage["metadata"][0]["value"]["none"][0], "#d55e00");
}

#[test]
fn pictures_are_as_they_are_or_laid_into_their_place() {
    let desk = Desk::new();
    exported(&desk, DEFAULT_BASE);
    let images = desk.folder().join("images/valley");
    let bytes = |path: &Path| fs::read(path).unwrap();
    let exhibit = desk.root.path().join("exhibit");
    assert_eq!(
        bytes(&images.join("recto/albedo.png")),
        bytes(&exhibit.join("recto.png"))
    );
    assert_eq!(
        bytes(&images.join("verso/albedo.jpg")),
        bytes(&exhibit.join("verso.jpg"))
    );
    // 12 mm to the right of the middle, in pixels of the canvas; nothing where it is not.
    let shifted = image::open(images.join("recto/state/shifted.png"))
        .unwrap()
        .to_rgb8();
    assert_eq!(shifted.dimensions(), (241, 161));
    let at = |mm: f64| shifted.get_pixel((mm / 120.0 * 241.0) as u32, 80).0[0];
    assert_eq!([at(5.0), at(70.0), at(74.0)], [0, 0, 255]);
    // Linear values are no sRGB.
    let infrared = image::open(images.join("recto/overlay/infrared.png"))
        .unwrap()
        .to_rgba8();
    assert_eq!(infrared.get_pixel(3, 3).0, [188, 188, 188, 255]);
    let damage = image::open(images.join("verso/overlay/damage.png"))
        .unwrap()
        .to_rgba8();
    assert_eq!(damage.get_pixel(10, 10).0, [0xd5, 0x5e, 0x00, 255]);
    assert_eq!(damage.get_pixel(100, 10).0[3], 0);
}

#[test]
fn what_goes_out_comes_back() {
    for base in [DEFAULT_BASE, "https://museum.example/a%20b/"] {
        let desk = Desk::new();
        let (before, ..) = exported(&desk, base);
        let (after, warnings) = desk.exhibit("manifest.json", &Known::default());
        assert!(warnings.is_empty(), "{warnings}");
        assert_eq!(after.title, before.title);
        assert_eq!(after.languages, before.languages);
        assert_eq!(after.drawings.len(), before.drawings.len());
        let names = |e: &Exhibit| -> Vec<_> {
            e.drawings
                .iter()
                .map(|d| (d.id.clone(), d.size_mm, d.verso.is_some(), d.flip))
                .collect()
        };
        assert_eq!(names(&after), names(&before));
        let (own, other) = (&after.drawings[0], &before.drawings[0]);
        let texts = |d: &recto::manifest::Drawing| {
            (
                d.title.clone(),
                d.caption.clone(),
                d.credit.clone(),
                d.date.clone(),
                d.inventory.clone(),
            )
        };
        assert_eq!(texts(own), texts(other));
        assert_eq!(own.states.len(), 2);
        for (state, before) in own.states.iter().zip(&other.states) {
            assert_eq!((&state.id, &state.date), (&before.id, &before.date));
            assert_eq!(state.recto.albedo.is_some(), before.recto.albedo.is_some());
            assert_eq!(state.verso.albedo.is_some(), before.verso.albedo.is_some());
        }
        assert_eq!(own.states[0].title, other.states[0].title);
        let nm = |d: &recto::manifest::Drawing| -> Vec<f64> {
            d.stacks[0]
                .bands
                .iter()
                .map(|band| band.wavelength_nm)
                .collect()
        };
        assert_eq!(nm(own), [550.0, 940.5]);
        assert_eq!(own.stacks[0].id, "bands");
        let overlays: Vec<_> = own
            .own_overlays()
            .map(|o| (o.id.as_str(), o.side))
            .collect();
        assert_eq!(
            overlays,
            [("infrared", SideName::Recto), ("damage", SideName::Verso)]
        );
        assert!(
            own.own_overlays()
                .all(|o| matches!(o.kind, OverlayKind::Picture(_)))
        );
        assert_eq!(own.hotspots.len(), 2);
        for (hotspot, before) in own.hotspots.iter().zip(&other.hotspots) {
            assert_eq!((&hotspot.id, hotspot.side), (&before.id, before.side));
            assert_eq!(
                (&hotspot.title, &hotspot.text),
                (&before.title, &before.text)
            );
            assert_eq!(hotspot.polygon_mm.len(), before.polygon_mm.len());
            for (a, b) in hotspot.polygon_mm.iter().zip(&before.polygon_mm) {
                // SVG has hundredths of pixels, which are half a millimetre here.
                assert!(a.distance(*b) < 0.02, "{a} {b}");
            }
        }
    }
}

#[test]
fn an_export_leaves_what_is_there_as_it_is() {
    let desk = Desk::new();
    let (exhibit, ..) = exported(&desk, DEFAULT_BASE);
    let again = exchange::export_iiif(&exhibit, &desk.folder(), DEFAULT_BASE).expect_err("refused");
    assert!(
        matches!(&again, ExchangeError::Staging(StagingError::Exists(path)) if path.ends_with("manifest.json")),
        "{again}"
    );
    // A picture that breaks in the middle leaves nothing.
    let folder = desk.root.path().join("exhibit");
    let sound = fs::read(folder.join("recto.png")).unwrap();
    fs::write(folder.join("recto.png"), &sound[..sound.len() / 2]).unwrap();
    let out = desk.root.path().join("new/deep");
    let error = exchange::export_iiif(&exhibit, &out, DEFAULT_BASE).expect_err("refused");
    assert!(error.to_string().contains("recto.png"), "{error}");
    assert!(!desk.root.path().join("new").exists());
}

/// A manifest as museums write them.
fn foreign() -> Value {
    let service = |name: &str| json!({ "id": format!("https://museum.org/iiif/3/{name}"), "type": "ImageService3", "profile": "level2" });
    let image = |name: &str, label: &str| {
        json!({ "id": format!("https://museum.org/iiif/3/{name}/full/max/0/default.jpg"), "type": "Image",
            "format": "image/jpeg", "width": 300, "height": 200, "label": { "en": [label] },
            "service": [service(name)] })
    };
    let canvas = |id: &str, label: &str, body: Value| {
        let id = format!("https://museum.org/canvas/{id}");
        json!({ "id": id, "type": "Canvas", "label": { "none": [label] }, "width": 3000, "height": 2000,
            "items": [{ "id": format!("{id}/p"), "type": "AnnotationPage", "items": [
                { "id": format!("{id}/a"), "type": "Annotation", "motivation": "painting", "body": body, "target": id }
            ] }] })
    };
    let choice = json!({ "type": "Choice", "items": [
        image("f1r", "Natural light"), image("f1r-940", "Infrared (940 nm)"), image("f1r-x", "X-ray"),
    ] });
    let mut recto = canvas("1", "f. 1r", choice);
    recto["service"] = json!([{ "@context": "http://iiif.io/api/annex/services/physdim/1/context.json",
        "profile": "http://iiif.io/api/annex/services/physdim", "physicalScale": 0.01, "physicalUnits": "cm" }]);
    recto["summary"] = json!({ "de": ["<p>Feder &amp; <i>Tinte</i></p>"] });
    recto["annotations"] = json!([{ "id": "https://museum.org/n", "type": "AnnotationPage", "items": [
        { "id": "https://museum.org/n/1", "type": "Annotation", "motivation": "tagging",
          "body": { "type": "TextualBody", "value": "A hand", "language": "en" },
          "target": "https://museum.org/canvas/1#xywh=300,200,600,400" },
        { "id": "https://museum.org/n/2", "type": "Annotation", "motivation": "commenting",
          "body": { "type": "TextualBody", "value": "All of it" }, "target": "https://museum.org/canvas/1" },
    ] }, { "id": "https://museum.org/elsewhere", "type": "AnnotationPage" }]);
    let mut cover = canvas("3", "Cover", image("cover", "Cover"));
    cover["metadata"] =
        json!([{ "label": { "en": ["Dimensions"] }, "value": { "en": ["21 × 31.5 cm"] } }]);
    json!({
        "@context": ["http://www.w3.org/ns/anno.jsonld", "http://iiif.io/api/presentation/3/context.json"],
        "id": "https://museum.org/manifest/7", "type": "Manifest", "label": { "en": ["A sketchbook"] },
        "rights": "http://rightsstatements.org/vocab/NoC-NC/1.0/",
        "items": [recto, canvas("2", "f. 1v", image("f1v", "f. 1v")), cover],
    })
}

fn museum(manifest: &Value) -> Desk {
    let desk = Desk::new();
    for name in ["f1r", "f1r-940", "f1r-x", "f1v", "cover"] {
        let path = desk.folder().join(format!("{name}.jpg"));
        RgbImage::from_pixel(300, 200, [150, 140, 120].into())
            .save(path)
            .unwrap();
    }
    desk.write("book.json", manifest.to_string());
    desk
}

#[test]
fn a_manifest_of_a_museum_comes_in_as_sheets_with_sides() {
    let desk = museum(&foreign());
    let (exhibit, warnings) = desk.exhibit("book.json", &Known::default());
    assert_eq!(exhibit.drawings.len(), 2);
    let sheet = &exhibit.drawings[0];
    assert_eq!(
        (sheet.id.as_str(), sheet.size_mm),
        ("f-1", DVec2::new(300.0, 200.0))
    );
    assert!(sheet.verso.is_some());
    assert_eq!(sheet.caption.0["de"], "Feder & Tinte");
    assert_eq!(sheet.stacks[0].bands[0].wavelength_nm, 940.0);
    let overlays: Vec<&str> = sheet.own_overlays().map(|o| o.id.as_str()).collect();
    assert_eq!(overlays, ["x-ray"]);
    assert_eq!(sheet.hotspots.len(), 1);
    assert_eq!(sheet.hotspots[0].polygon_mm[2], DVec2::new(90.0, 60.0));
    assert_eq!(sheet.hotspots[0].title.0["en"], "A hand");
    // Height first, as museums write.
    let cover = &exhibit.drawings[1];
    assert_eq!(
        (cover.id.as_str(), cover.size_mm),
        ("cover", DVec2::new(315.0, 210.0))
    );
    assert!(cover.verso.is_none());
    // What holds for the whole holds for each.
    let rights = "http://rightsstatements.org/vocab/NoC-NC/1.0/";
    assert_eq!([&sheet.credit, &cover.credit], [rights; 2]);
    assert_eq!(warnings.lines().count(), 2, "{warnings}");
    assert!(
        warnings.contains("other files") && warnings.contains("without an outline"),
        "{warnings}"
    );
}

#[test]
fn a_size_that_is_not_said_is_assumed_or_given() {
    let mut manifest = foreign();
    manifest["items"][0]
        .as_object_mut()
        .unwrap()
        .remove("service");
    let desk = museum(&manifest);
    let (exhibit, warnings) = desk.exhibit("book.json", &Known::default());
    assert_eq!(exhibit.drawings[0].size_mm, DVec2::new(30.0, 20.0));
    assert!(warnings.contains("--size-mm"), "{warnings}");
    let known = Known {
        size_mm: Some([290.0, 195.0]),
        ..Known::default()
    };
    let (exhibit, warnings) = museum(&manifest).exhibit("book.json", &known);
    assert_eq!(exhibit.drawings[0].size_mm, DVec2::new(290.0, 195.0));
    assert!(!warnings.contains("--size-mm"), "{warnings}");
    // A service without sense is none.
    for scale in [json!(0), json!(-1), json!("x"), json!(1e30)] {
        let mut manifest = foreign();
        manifest["items"][0]["service"][0]["physicalScale"] = scale;
        let (exhibit, _) = museum(&manifest).exhibit("book.json", &Known::default());
        assert_eq!(exhibit.drawings[0].size_mm, DVec2::new(30.0, 20.0));
    }
}

#[test]
fn a_broken_or_hostile_manifest_is_refused_in_words() {
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut manifest = foreign();
        change(&mut manifest);
        let desk = museum(&manifest);
        fs::write(desk.root.path().join("secret.jpg"), "x").unwrap();
        desk.refusal("book.json")
    };
    let set_id = |id: &'static str| {
        move |v: &mut Value| {
            let image = &mut v["items"][2]["items"][0]["items"][0]["body"];
            image["id"] = json!(id);
            image.as_object_mut().unwrap().remove("service");
        }
    };
    type Change<'c> = (&'c dyn Fn(&mut Value), &'c str);
    let cases: [Change; 14] = [
        (&set_id("https://museum.org/../secret.jpg"), "without .."),
        (
            &set_id("https://museum.org/%2e%2e%2fsecret.jpg"),
            "without ..",
        ),
        (&set_id("file:///etc/hostname"), "begins with http"),
        (&set_id("/etc/hostname"), "begins with http"),
        (
            &set_id("https://museum.org/iiif/3/back/full/max/0/default.jpg"),
            "as \"back.jpg\"",
        ),
        (&|v| v["items"] = json!([]), "a list of canvases"),
        (&|v| v["items"] = json!(7), "a list of canvases"),
        (&|v| v["items"][1] = json!(null), "items[1].width"),
        (&|v| v["items"][1]["width"] = json!(0), "items[1].width"),
        (
            &|v| v["items"][1]["height"] = json!(1e300),
            "items[1].height",
        ),
        (
            &|v| v["items"][1]["items"] = json!([]),
            "a canvas without a picture",
        ),
        (
            &|v| v["items"][1]["items"][0]["items"][0]["body"]["type"] = json!("Video"),
            "\"Image\"",
        ),
        (
            &|v| {
                v["items"][1]["items"][0]["items"][0]["target"] =
                    json!("https://m.org/c#xywh=0,0,1500,2000")
            },
            "a part of its canvas",
        ),
        (&|v| v["type"] = json!("Range"), "not a manifest"),
    ];
    for (change, words) in cases {
        let found = changed(change);
        assert!(found.contains(words), "{words}: {found}");
    }
    // Every fault at once.
    let several = changed(&|v| {
        for i in 0..3 {
            v["items"][i]["width"] = json!("wide");
        }
    });
    assert_eq!(several.lines().count(), 3, "{several}");
    // A picture that is none is told by its own name.
    let desk = museum(&foreign());
    desk.write("f1v.jpg", "no picture");
    let error = desk.import("book.json").expect_err("refused").to_string();
    assert!(error.contains("f1v.jpg"), "{error}");
    assert!(!desk.out().exists());
}

#[cfg(unix)]
#[test]
fn a_link_out_of_the_folder_is_refused() {
    let desk = museum(&foreign());
    let secret = desk.root.path().join("secret.jpg");
    fs::rename(desk.folder().join("cover.jpg"), &secret).unwrap();
    std::os::unix::fs::symlink(&secret, desk.folder().join("cover.jpg")).unwrap();
    let words = desk.refusal("book.json");
    assert!(words.contains("out of the manifest's folder"), "{words}");
}

#[test]
fn outlines_that_are_none_are_left_out() {
    let mut manifest = foreign();
    let svg = |points: &str| {
        json!({ "type": "SpecificResource", "source": "https://museum.org/canvas/1", "selector":
            { "type": "SvgSelector", "value": format!("<svg><polygon points=\"{points}\"/></svg>") } })
    };
    let notes = &mut manifest["items"][0]["annotations"][0]["items"];
    let targets = [
        svg("0,0 100,100 100,0 0,100"),
        svg("0,0 1e9,0 0,1e9"),
        svg("0,0 nan,0 0,5"),
        svg("5,5 6,6"),
        svg(&"1,2 ".repeat(100_000)),
    ];
    for target in targets {
        let mut note = notes[0].clone();
        note["target"] = target;
        notes.as_array_mut().unwrap().push(note);
    }
    let (exhibit, warnings) = museum(&manifest).exhibit("book.json", &Known::default());
    assert_eq!(exhibit.drawings[0].hotspots.len(), 1);
    assert_eq!(warnings.matches("it is left out").count(), 6, "{warnings}");
}

#[test]
fn what_both_sides_call_alike_has_ids_that_differ() {
    let mut manifest = foreign();
    let body = |v: &Value, i: usize| v["items"][i]["items"][0]["items"][0]["body"].clone();
    let mut choice = body(&manifest, 0);
    choice["items"][0] = body(&manifest, 1);
    // Another infrared on each side, which says no wavelength.
    for (own, label) in [(1, "Infrared (940 nm)"), (2, "Infrared")] {
        choice["items"][own]["label"] = json!({ "en": [label] });
    }
    manifest["items"][1]["items"][0]["items"][0]["body"] = choice;
    let recto = &mut manifest["items"][0]["items"][0]["items"][0]["body"];
    recto["items"][2]["label"] = json!({ "en": ["Infrared"] });
    let (exhibit, _) = museum(&manifest).exhibit("book.json", &Known::default());
    let sheet = &exhibit.drawings[0];
    let overlays: Vec<_> = sheet
        .own_overlays()
        .map(|overlay| (overlay.id.as_str(), overlay.side))
        .collect();
    assert_eq!(
        overlays,
        [
            ("infrared", SideName::Recto),
            ("infrared-verso", SideName::Verso)
        ]
    );
    let stacks: Vec<_> = sheet
        .stacks
        .iter()
        .map(|stack| (stack.id.as_str(), stack.side, stack.bands[0].wavelength_nm))
        .collect();
    assert_eq!(
        stacks,
        [
            ("bands", SideName::Recto, 940.0),
            ("bands-verso", SideName::Verso, 940.0)
        ]
    );
}

#[test]
fn canvases_of_one_name_are_counted_and_odd_languages_are_none() {
    let mut manifest = foreign();
    let label = json!({ "x-default": ["Sheet 2"] });
    for i in 0..3 {
        manifest["items"][i]["label"] = label.clone();
    }
    manifest["label"] = json!({ "x-default": ["A book"], "de": ["Ein Buch"] });
    let (exhibit, warnings) = museum(&manifest).exhibit("book.json", &Known::default());
    assert!(!warnings.contains("visitors cannot choose"), "{warnings}");
    let ids: Vec<&str> = exhibit.drawings.iter().map(|d| d.id.as_str()).collect();
    assert_eq!(ids, ["sheet-2", "sheet-2-2", "sheet-2-3"]);
    assert_eq!(exhibit.languages, ["en", "de"]);
    assert_eq!(exhibit.title.0["en"], "A book");
}

#[test]
fn faults_are_in_the_order_of_the_manifest_and_counted() {
    let mut manifest = foreign();
    let canvas = manifest["items"][2].clone();
    let items = manifest["items"].as_array_mut().unwrap();
    items.clear();
    for _ in 0..55 {
        let mut canvas = canvas.clone();
        canvas["width"] = json!(0);
        items.push(canvas);
    }
    let words = museum(&manifest).refusal("book.json");
    let lines: Vec<&str> = words.lines().collect();
    assert_eq!(lines.len(), 41, "{words}");
    for (i, line) in lines[..40].iter().enumerate() {
        assert!(line.contains(&format!("items[{i}].width")), "{i}: {line}");
    }
    assert!(lines[40].contains("15 more"), "{words}");
}

#[test]
fn what_was_killed_is_cleared_by_the_next_import_or_export() {
    let desk = museum(&foreign());
    // As if an export had ended after its first change of names, and an import before.
    let left = desk.out().join(".recto-staging-abc");
    fs::create_dir_all(&left).unwrap();
    fs::write(left.join(".publishing"), "images\nmanifest.json").unwrap();
    fs::write(left.join("manifest.json"), "{}").unwrap();
    fs::create_dir(desk.out().join("images")).unwrap();
    fs::create_dir(desk.out().join(".recto-staging-def")).unwrap();
    desk.exhibit("book.json", &Known::default());
    let entries = fs::read_dir(desk.out()).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["exhibit.toml", "images"]);
}
