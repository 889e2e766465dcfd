//! Measuring: what the tools read on sheets that are known, and the command around them.

use std::{f64::consts::TAU, fs, path::Path};

use glam::{DVec2, DVec3};
use recto::{
    manifest::{Camera, Exhibit, Scene, SideName, eye::Eye, frames},
    maps::encode,
    readings::{
        Desk, Disc, Reading, Tool,
        sight::{Seen, Sight},
    },
    sample,
    units::Degrees,
};
use serde_json::Value;

use super::{Sheet, code, files, recto, stdout};

/// What is read lies within so many standard uncertainties of what is there: one reading in 370
/// would not, and these are not drawn by chance.
const SIGMAS: f64 = 3.0;
/// What the issue asks of spacings and widths.
const LAID_TOLERANCE: f64 = 0.01;
const CHAIN_TOLERANCE: f64 = 0.02;
const STROKE_TOLERANCE: f64 = 0.15;

fn measure(exhibit: &Path, arguments: &[&str]) -> std::process::Output {
    let mut command = recto();
    command.arg("measure").arg(exhibit).args(arguments);
    command.output().unwrap()
}

fn read(folder: &Path) -> Exhibit {
    Exhibit::read(folder)
        .unwrap_or_else(|faults| panic!("{faults}"))
        .0
}

#[track_caller]
fn reading(exhibit: &Exhibit, scene: Scene, tool: &Tool) -> Reading {
    let mut desk = Desk::new(exhibit, scene);
    desk.read(tool, 0.0).unwrap_or_else(|errors| {
        let words: Vec<String> = errors.iter().map(ToString::to_string).collect();
        panic!("{}", words.join("\n"))
    })
}

#[track_caller]
fn value(reading: &Reading, quantity: &str) -> [f64; 2] {
    let value = reading
        .values
        .iter()
        .find(|value| value.quantity.starts_with(quantity));
    let value = value.unwrap_or_else(|| panic!("no {quantity} in {reading:?}"));
    assert!(value.sigma.is_some(), "{quantity} without an uncertainty");
    [value.value, value.sigma].map(|v| v.unwrap_or_else(|| panic!("no {quantity}: {reading:?}")))
}

const SIZE: DVec2 = DVec2::new(200.0, 140.0);
/// Rise of the curled sheet from its left to its right edge, in mm.
const RISE: f64 = 10.0;
const CURL: [u32; 2] = [64, 48];

/// A sheet of [`SIZE`] with two sides, flat or rising to the right as the recto is seen.
fn plain(folder: &Path, curled: bool) -> Exhibit {
    let grey = vec![150; 1000 * 700];
    encode::save_png_grey8(&folder.join("sheet.png"), 1000, 700, &grey, None).unwrap();
    let [width, height] = CURL;
    let ramp: Vec<u16> = (0..width * height)
        .map(|i| (f64::from(i % width) / f64::from(width - 1) * 65535.0).round() as u16)
        .collect();
    encode::save_png_grey16(&folder.join("curl.png"), width, height, &ramp, None).unwrap();
    let surface = match curled {
        true => "surface.height = { file = \"curl.png\", range_um = [0, 10000] }",
        false => "",
    };
    fs::write(
        folder.join("exhibit.toml"),
        format!(
            "[[drawing]]\nid = \"sheet\"\nsize_mm = [200, 140]\n{surface}\nrecto.albedo = \"sheet.png\"\n\
             verso.albedo = \"sheet.png\"\n"
        ),
    )
    .unwrap();
    read(folder)
}

/// Where paper lies on the table, of a sheet whose `side` is up.
fn on_table(
    place: DVec2,
    side: SideName,
    drawing: &recto::manifest::Drawing,
    curled: bool,
) -> DVec3 {
    let recto = match side {
        SideName::Recto => place,
        SideName::Verso => frames::other_side(place, SIZE, drawing.flip),
    };
    let width = f64::from(CURL[0]);
    let rise = (recto.x / SIZE.x * width - 0.5) / (width - 1.0) * RISE;
    let up = match (curled, side) {
        (false, _) => 0.0,
        (true, SideName::Recto) => rise,
        (true, SideName::Verso) => -rise,
    };
    DVec3::new(place.x - SIZE.x / 2.0, SIZE.y / 2.0 - place.y, up)
}

#[test]
fn a_distance_is_the_same_at_every_zoom_and_tilt_and_from_either_side() {
    const PX: [u32; 2] = [1280, 720];
    let paper = [DVec2::new(60.0, 50.0), DVec2::new(120.0, 85.0)];
    let truth = paper[0].distance(paper[1]);
    for curled in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let exhibit = plain(folder.path(), curled);
        let drawing = &exhibit.drawings[0];
        let mut looks = 0;
        for (side, distance_mm) in [
            (SideName::Recto, None),
            (SideName::Recto, Some(500.0)),
            (SideName::Verso, None),
            (SideName::Verso, Some(500.0)),
        ] {
            for (width_mm, tilt, turn) in [
                (90.0, 0.0, 0.0),
                (240.0, 0.0, 25.0),
                (90.0, 35.0, 0.0),
                (240.0, 60.0, -40.0),
                (600.0, 60.0, 0.0),
            ] {
                let there = |place: DVec2| match side {
                    SideName::Recto => place,
                    SideName::Verso => frames::other_side(place, SIZE, drawing.flip),
                };
                let scene = Scene {
                    side,
                    camera: Camera {
                        centre_mm: there(DVec2::new(90.0, 67.0)),
                        width_mm,
                        tilt: Degrees(tilt),
                        turn: Degrees(turn),
                        distance_mm,
                    },
                    ..exhibit.scenes[0].clone()
                };
                // From the paper to the picture by the renderers' own projection, to whole pixels.
                let size = DVec2::from(PX.map(f64::from));
                let clip = Eye::new(&scene.camera, SIZE).clip_from_table(size.x / size.y);
                let pixel = |place: DVec2| {
                    let at = clip * on_table(there(place), side, drawing, curled).extend(1.0);
                    let ndc = DVec2::new(at.x / at.w, -at.y / at.w);
                    ((ndc + 1.0) / 2.0 * size).floor() + 0.5
                };
                let sight = Sight::new(&exhibit, &scene, PX).unwrap();
                let seen = paper.map(|place| sight.seen(pixel(place)).expect("the sheet"));
                let screen_mm = seen[0].pixel_mm.max(seen[1].pixel_mm);
                for (Seen { mm, .. }, place) in seen.iter().zip(paper) {
                    assert!(
                        mm.distance(there(place)) <= screen_mm,
                        "{mm} {:?}",
                        scene.camera
                    );
                }
                let mut desk = Desk::new(&exhibit, scene.clone());
                let read = desk
                    .read(&Tool::Ruler(seen.map(|seen| seen.mm)), screen_mm)
                    .unwrap();
                let [length, sigma] = value(&read, "length");
                let off = (length - truth).abs();
                assert!(
                    off <= SIGMAS * sigma,
                    "{length} ± {sigma}: {:?}",
                    scene.camera
                );
                // A scale that is 5 % off is told from a right one.
                assert!((1.05 * length - truth).abs() > SIGMAS * sigma, "{sigma}");
                looks += 1;
            }
        }
        assert_eq!(looks, 20);
    }
}

#[test]
fn places_are_known_as_well_as_the_control_points_agree() {
    let folder = tempfile::tempdir().unwrap();
    plain(folder.path(), false);
    let manifest = folder.path().join("exhibit.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    // Five pixels to the mm; the last point lies `off` mm beside its place.
    let sigma = |off: f64, points: usize| {
        let all = [
            (20.0, 20.0),
            (180.0, 20.0),
            (180.0, 120.0),
            (20.0 + off, 120.0),
        ];
        let lines: Vec<String> = all[..points]
            .iter()
            .map(|(x, y)| {
                let [px, py] = [x * 5.0, y * 5.0];
                let x = if *y > 100.0 && *x < 100.0 { 20.0 } else { *x };
                format!("{{ picture = [{px}, {py}], sheet_mm = [{x}, {y}] }}")
            })
            .collect();
        let state = format!(
            "[[drawing.state]]\nid = \"before\"\n[drawing.state.recto]\nalbedo = \"sheet.png\"\n\
             control_points = [{}]\n",
            lines.join(", ")
        );
        fs::write(&manifest, format!("{text}{state}")).unwrap();
        let exhibit = read(folder.path());
        let scene = Scene {
            state: Some(0),
            ..exhibit.scenes[0].clone()
        };
        let ruler = Tool::Ruler([DVec2::new(30.0, 30.0), DVec2::new(130.0, 30.0)]);
        let read = reading(&exhibit, scene, &ruler);
        (value(&read, "length")[1], read.notes)
    };
    let pixel = 0.2 / 6f64.sqrt();
    assert!((sigma(0.0, 4).0 - pixel).abs() < 1e-3);
    // An affine fit leaves a quarter of 1 mm at each corner: σ_L² = pixel² + 2 · 0.25²/2.
    let (found, notes) = sigma(1.0, 4);
    assert!((found - pixel.hypot(0.25)).abs() < 0.01, "{found}");
    assert!(notes.is_empty(), "{notes:?}");
    // Three points agree whatever they are: nothing is known of them.
    assert!((sigma(0.0, 3).0 - pixel).abs() < 1e-3);
}

/// A sheet of 40 × 30 mm at 600 dpi with a stroke of 250 µm through its middle, and a relief of
/// waves of 4 mm and 20 µm.
fn stroke_and_waves(folder: &Path) -> Exhibit {
    const PX: [u32; 2] = [945, 709];
    let pixel = 40.0 / f64::from(PX[0]);
    let normal = DVec2::from_angle(30f64.to_radians()).perp();
    let at = |i: u32| DVec2::new(f64::from(i % PX[0]), f64::from(i / PX[0]));
    let mut noise = 1u32;
    let albedo: Vec<u8> = (0..PX[0] * PX[1])
        .map(|i| {
            let inside = (0..16).filter(|s| {
                let step = DVec2::new(f64::from(s % 4), f64::from(s / 4)) / 4.0 + 0.125;
                let place = (at(i) + step) * pixel - DVec2::new(20.0, 15.0);
                place.dot(normal).abs() < 0.125
            });
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let grain = f64::from(noise >> 24) / 255.0 * 4.0;
            (178.0 + grain - 80.0 * inside.count() as f64 / 16.0) as u8
        })
        .collect();
    encode::save_png_grey8(&folder.join("albedo.png"), PX[0], PX[1], &albedo, None).unwrap();
    let height: Vec<u16> = (0..PX[0] * PX[1])
        .map(|i| {
            let um = 20.0 * (TAU * (at(i).x + 0.5) * pixel / 4.0).sin();
            ((um + 32.0) / 64.0 * 65535.0).round() as u16
        })
        .collect();
    encode::save_png_grey16(&folder.join("height.png"), PX[0], PX[1], &height, None).unwrap();
    fs::write(
        folder.join("exhibit.toml"),
        "[[drawing]]\nid = \"sheet\"\nsize_mm = [40, 30]\n[drawing.recto]\nsource = \"measured\"\n\
         albedo = { file = \"albedo.png\", encoding = \"linear\" }\n\
         height = { file = \"height.png\", range_um = [-32, 32] }\n",
    )
    .unwrap();
    read(folder)
}

#[test]
fn tools_read_what_was_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let exhibit = stroke_and_waves(folder.path());
    let read = |tool: &Tool| reading(&exhibit, exhibit.scenes[0].clone(), tool);
    let across = DVec2::from_angle(30f64.to_radians()).perp();
    let middle = DVec2::new(20.0, 15.0);
    let stroke = read(&Tool::Stroke([middle - across, middle + across]));
    let [width, sigma] = value(&stroke, "width");
    assert!((width / 250.0 - 1.0).abs() < STROKE_TOLERANCE, "{width}");
    assert!(sigma < 25.0, "{sigma}");

    let profile = read(&Tool::Profile([
        DVec2::new(1.0, 7.0),
        DVec2::new(37.0, 7.0),
    ]));
    for (quantity, truth) in [
        ("length", 36.0),
        ("height", 40.0),
        ("roughness", 200f64.sqrt()),
    ] {
        let [found, sigma] = value(&profile, quantity);
        assert!(
            (found - truth).abs() <= SIGMAS * sigma,
            "{quantity} {found} ± {sigma}"
        );
        assert!(sigma < 0.05 * truth, "{quantity} {sigma}");
    }
    let samples = &profile.samples;
    assert!(samples.len() > 36 * 23, "{}", samples.len());
    assert_eq!(
        (samples[0].s_mm, samples[samples.len() - 1].s_mm),
        (0.0, 36.0)
    );
    for sample in samples {
        let truth = 20.0 * (TAU * (1.0 + sample.s_mm) / 4.0).sin();
        assert!((sample.z_um - truth).abs() < 0.1, "{sample:?}");
    }

    // Paper without lines has none, and says why.
    let lines = read(&Tool::Lines([DVec2::new(1.0, 1.0), DVec2::new(39.0, 29.0)]));
    assert!(
        lines
            .values
            .iter()
            .all(|value| value.value.is_none() && value.none.is_some())
    );
    assert!(lines.words.contains("none"), "{}", lines.words);

    let disc = |x: f64, y: f64| Disc {
        middle: DVec2::new(x, y),
        radius_mm: 0.06,
    };
    let ink = read(&Tool::Difference([disc(20.0, 15.0), disc(10.0, 5.0)]));
    let [difference, sigma] = value(&ink, "ΔE00");
    let lab = |linear: f64| recto::colour::lab_from_linear([linear / 255.0; 3]);
    let truth = recto::colour::delta_e00(lab(100.0), lab(180.0));
    assert!(
        (difference - truth).abs() < 0.5 && sigma < 0.3,
        "{difference} ± {sigma}, not {truth}"
    );
    let same = read(&Tool::Difference([disc(10.0, 5.0), disc(10.0, 5.0)]));
    let [difference, sigma] = value(&same, "ΔE00");
    assert!(difference == 0.0 && sigma > 0.0);
    assert!(
        same.notes
            .iter()
            .all(|note| !note.to_string().contains("assumed")),
        "{:?}",
        same.notes
    );
}

#[test]
fn the_sample_measures_as_it_was_drawn() {
    // Fewer would not resolve its pen.
    const DPI: f64 = 200.0;
    let folder = tempfile::tempdir().unwrap();
    sample::write_all(folder.path(), DPI, &|_, _| {}).unwrap();
    let exhibit = read(&folder.path().join("landscape"));
    let whole = exhibit.scene("whole").unwrap().1;
    for side in [SideName::Recto, SideName::Verso] {
        let scene = Scene {
            side,
            ..whole.clone()
        };
        let corners = [DVec2::new(20.0, 20.0), DVec2::new(260.0, 170.0)];
        let lines = reading(&exhibit, scene, &Tool::Lines(corners));
        let [laid, sigma] = value(&lines, "spacing of laid");
        assert!(
            (laid / 1.12 - 1.0).abs() < LAID_TOLERANCE,
            "{side:?}: {laid} ± {sigma}"
        );
        let [chain, sigma] = value(&lines, "spacing of chain");
        assert!(
            (chain / 24.0 - 1.0).abs() < CHAIN_TOLERANCE,
            "{side:?}: {chain} ± {sigma}"
        );
    }
    let read = |tool: &Tool| reading(&exhibit, whole.clone(), tool);
    let profile = read(&Tool::Profile([
        DVec2::new(200.0, 60.0),
        DVec2::new(220.0, 60.0),
    ]));
    let [height, _] = value(&profile, "height");
    assert!((10.0..80.0).contains(&height), "{height}");
    // A short wave of the river.
    let section = [DVec2::new(156.56, 117.2), DVec2::new(156.56, 118.35)];
    let [width, sigma] = value(&read(&Tool::Stroke(section)), "width");
    assert!(
        (80.0..250.0).contains(&width) && sigma < 60.0,
        "{width} ± {sigma}"
    );
    let disc = Disc {
        middle: DVec2::new(260.0, 30.0),
        radius_mm: 3.0,
    };
    let before = exhibit.drawings[0].state("before").map(|(index, _)| index);
    let [changed, sigma] = value(&read(&Tool::Against(disc, before)), "ΔE00");
    assert!(changed > 1.0 && sigma < 0.2, "{changed} ± {sigma}");
    let after = exhibit.drawings[0].state("after").map(|(index, _)| index);
    assert_eq!(value(&read(&Tool::Against(disc, after)), "ΔE00")[0], 0.0);
}

#[test]
fn readings_go_to_standard_output_as_words_as_json_and_as_csv() {
    let sheet = Sheet::new();
    let csv = sheet.out("x.csv");
    let arguments = [
        "--ruler",
        "10,10:70,90",
        "--ruler=1,1:2,40",
        "--path=10,10:40,10:40,50",
        "--area",
        "--angle=90,10:10,10:10,90",
        "--probe=50,50,20",
        "--csv",
        csv.to_str().unwrap(),
    ];
    let output = measure(&sheet.exhibit(), &arguments);
    let stderr = code(&output, 0);
    let words: Vec<&str> = stdout(&output).lines().collect();
    assert_eq!(words.len(), 5);
    assert!(
        words[0].starts_with("ruler 10,10 to 70,90: 100.0 ± 2.6 mm"),
        "{}",
        words[0]
    );
    assert!(words[2].contains("area 600"), "{}", words[2]);
    assert!(
        stderr.contains("1 σ") && stderr.contains("assumed"),
        "{stderr}"
    );
    let rows = fs::read_to_string(&csv).unwrap();
    assert_eq!(rows.lines().count(), 1 + 2 + 2 + 1 + 3, "{rows}");
    let columns = |row: &str| {
        row.split('"')
            .step_by(2)
            .map(|part| part.matches(',').count())
            .sum::<usize>()
    };
    assert!(rows.lines().all(|row| columns(row) == 13), "{rows}");

    let output = measure(&sheet.exhibit(), &[&arguments[..7], &["--json"]].concat());
    code(&output, 0);
    let json: Value = serde_json::from_str(stdout(&output)).unwrap();
    assert_eq!(json["side"], "recto");
    let readings = json["readings"].as_array().unwrap();
    assert_eq!(readings.len(), 5);
    for value in readings
        .iter()
        .flat_map(|reading| reading["values"].as_array().unwrap())
    {
        assert!(
            value["value"].is_f64() && value["sigma"].is_f64(),
            "{value}"
        );
    }
    assert_eq!(readings[3]["values"][0]["unit"], "°");
    assert_eq!(
        readings[4]["values"][0]["count"], 32,
        "a disc of 40 mm of pixels of 6.25 mm"
    );
}

#[test]
fn every_fault_is_named_at_once() {
    let sheet = Sheet::new();
    let plot = sheet.out("x.png");
    let arguments = [
        "--ruler=-1,5:400,5",
        "--ruler=5,5:5,5",
        "--angle=1,1:2",
        "--profile=10,10:50,50",
        "--probe=50,50,-2",
        "--against=befor",
        "--state=hole",
        "--plot",
        plot.to_str().unwrap(),
    ];
    let output = measure(&sheet.exhibit(), &arguments);
    // Two of them cannot be read, whatever the exhibit is.
    let stderr = code(&output, 2);
    assert!(output.stdout.is_empty());
    for words in [
        "--ruler[0]: found -1,5, off the sheet; allowed: 0 to 100 across, 0 to 100 down",
        "--ruler[0]: found 400,5, off the sheet",
        "--ruler[1]: found places 1 and 2 are 0.000 mm apart",
        "--angle: found \"2\"",
        "--profile: found a recto without a height map",
        "--probe: found a radius of -2 mm",
        "--against: found \"befor\"",
        "--state: found \"hole\"",
    ] {
        assert!(stderr.contains(words), "{words}\n{stderr}");
    }
    assert_eq!(files(sheet.root.path()), ["exhibit"]);

    let output = measure(&sheet.exhibit(), &[&arguments[..7], &["--json"]].concat());
    code(&output, 2);
    let json: Value = serde_json::from_str(stdout(&output)).unwrap();
    assert_eq!(json["sound"], false);
    assert_eq!(json["faults"].as_array().unwrap().len(), 8);
}

#[test]
fn a_probe_that_is_wider_than_the_sheet_or_finer_than_its_pixels_says_so() {
    let sheet = Sheet::new();
    let said = |probe: &str, with: i32| code(&measure(&sheet.exhibit(), &[probe]), with);
    let wide = said("--probe=50,50,1e9", 1);
    assert!(
        wide.contains("found a radius of 1000000000 mm, wider than the sheet; allowed: a radius of up to 50 mm"),
        "{wide}"
    );
    let fine = said("--probe=50,50,0.001", 1);
    assert!(fine.contains("make it larger than a few pixels"), "{fine}");
    let none = said("--probe=50,50,0", 2);
    assert!(none.contains("write it like 20,30 or 20,30,2"), "{none}");
    said("--probe=50,50,50", 0);
}

#[test]
fn where_nothing_is_read_how_exactly_is_not_known() {
    let sheet = Sheet::new();
    let manifest = sheet.exhibit().join("exhibit.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    fs::write(
        &manifest,
        text.replace("verso.albedo = \"verso.png\"\n", ""),
    )
    .unwrap();
    let bare = |more: &[&str]| {
        let arguments = [
            "--side=verso",
            "--ruler=10,20:60,20",
            "--angle=60,20:10,20:10,70",
        ];
        measure(&sheet.exhibit(), &[&arguments[..], more].concat())
    };
    let said = bare(&[]);
    let notes = code(&said, 0);
    assert!(
        stdout(&said).contains("50.000 mm, how exactly is not known")
            && stdout(&said).contains("90.000°, how exactly is not known"),
        "{}",
        stdout(&said)
    );
    assert!(notes.contains("the verso has no picture"), "{notes}");
    let json: Value = serde_json::from_str(stdout(&bare(&["--json"]))).unwrap();
    assert_eq!(json["readings"][0]["values"][0]["sigma"], Value::Null);
    let recto = measure(&sheet.exhibit(), &["--ruler=10,20:60,20"]);
    assert!(stdout(&recto).contains(" ± "), "{}", stdout(&recto));
}

#[test]
fn wrong_usage_ends_with_2() {
    let sheet = Sheet::new();
    for arguments in [
        &[][..],
        &["--area", "--ruler=1,1:2,2"],
        &["--against=none", "--ruler=1,1:2,2"],
        &["--plot=x.png", "--ruler=1,1:2,2"],
        &["--plot=x.jpg", "--profile=1,1:2,2"],
        &["--plot=x.png", "--profile=1,1:2,2", "--profile=1,1:2,2"],
        &["--px=0x4", "--ruler=1,1:2,2"],
    ] {
        code(&measure(&sheet.exhibit(), arguments), 2);
    }
    let arguments = [
        "--px=64x64",
        "--ruler=1,1:60,60",
        "--camera=centre_mm=0x0,width_mm=20",
    ];
    let stderr = code(&measure(&sheet.exhibit(), &arguments), 1);
    assert!(stderr.contains("1,1 px, beside the sheet"), "{stderr}");
}

#[test]
fn a_profile_is_drawn() {
    let sheet = tempfile::tempdir().unwrap();
    stroke_and_waves(sheet.path());
    let plot = sheet.path().join("plot.png");
    let plot = plot.to_str().unwrap();
    code(
        &measure(sheet.path(), &["--profile=2,7:38,7", "--plot", plot]),
        0,
    );
    let picture = image::open(plot).unwrap().into_rgb8();
    // Nine waves: the line crosses the middle of the plot eighteen times.
    let blue = |x: u32, y: u32| {
        let [r, _, b] = picture.get_pixel(x, y).0.map(i32::from);
        b > r + 100
    };
    let middle = (0..picture.height())
        .max_by_key(|y| {
            (0..picture.width())
                .filter(|x| blue(*x, *y) != blue(x.saturating_sub(1), *y))
                .count()
        })
        .unwrap();
    let crossings = (1..picture.width())
        .filter(|x| blue(*x, middle) && !blue(x - 1, middle))
        .count();
    assert!((17..=19).contains(&crossings), "{crossings}");
}
