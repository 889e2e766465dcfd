//! What places are drawn with, how glossy and how deep it is: held against a sheet that is known.

use std::{path::PathBuf, sync::OnceLock};

use glam::DVec3;
use recto::{
    colour::{delta_e00, lab_from_linear},
    manifest::{Exhibit, exhibit::OverlayKind},
    maps::{self, ColourEncoding},
    optics::medium::{Matter, MediumId},
    prepare::{
        Report,
        capture::Capture,
        materials::{Materials, ways::Way},
    },
};

use super::made::{self, HEIGHT, MEDIA, SWATCHES, Stand, WIDTH, lies, medium, swatch, swatches};

/// Places whose class is found, of all and of held-out ones.
const AGREE: f64 = 0.95;
/// Of a roughness: what its own surface shows of it.
const ROUGHNESS: [(&str, f64); 4] = [
    ("iron-gall-ink", 0.02),
    ("wash", 0.02),
    ("bare-paper", 0.02),
    // Between its grains paper gleams, which the model has too, but not as much.
    ("red-chalk", 0.08),
];
/// Mean error of τ, over its mean.
const DEPTH: f64 = 0.06;

struct Prepared {
    stand: Stand,
    out: PathBuf,
    report: Report,
}

/// The sheet with all its swatches and its light table, prepared once.
pub fn prepared() -> (&'static Stand, &'static PathBuf, &'static Report) {
    static ALL: OnceLock<Prepared> = OnceLock::new();
    let all = ALL.get_or_init(|| {
        let stand = Stand::new();
        let out = stand.path("out");
        let table = "[transmitted]\nphotograph = \"through.png\"\nflat_field = \"table.png\"\n";
        let text = stand.text() + table + &swatches();
        let report = stand.prepare(&text, &out).expect("prepared");
        Prepared { stand, out, report }
    });
    (&all.stand, &all.out, &all.report)
}

pub fn pixels(path: &std::path::Path) -> Vec<[f32; 4]> {
    let mut pixels = Vec::new();
    maps::for_each_colour_row(path, ColourEncoding::Linear, |_, row| {
        pixels.extend_from_slice(row);
    })
    .expect("a picture");
    pixels
}

fn materials(report: &Report) -> &Materials {
    report.sides[0]
        .matter
        .materials
        .as_ref()
        .expect("materials")
}

/// The classes that the exhibit's own maps show.
fn classes(out: &std::path::Path) -> Vec<usize> {
    let (exhibit, warnings) = Exhibit::read(out).expect("an exhibit");
    assert!(warnings.is_empty(), "{warnings:?}");
    let mut classes = vec![0; WIDTH * HEIGHT];
    for map in &exhibit.drawings[0].recto.media {
        let recto::manifest::exhibit::MediaContent::Legend(legend) = &map.content else {
            panic!("a legend")
        };
        for (i, pixel) in pixels(&map.file.path).iter().enumerate() {
            let colour = [0, 1, 2].map(|c| (pixel[c] * 255.0).round() as u8);
            let named = legend
                .iter()
                .find(|(named, _)| *named == colour && pixel[3] > 0.5);
            if let Some((_, medium)) = named {
                let name = exhibit.media[*medium].name.clone();
                classes[i] = MEDIA.iter().position(|of| *of == name).expect("a class");
            }
        }
    }
    classes
}

#[test]
fn media_are_told_apart() {
    let (_, out, report) = prepared();
    let materials = materials(report);
    for trial in &materials.trials {
        eprintln!(
            "{}: {:.4} where chosen, {:.4} held out",
            trial.way,
            trial.choosing,
            trial.held_out.accuracy()
        );
    }
    // All were tried, and the best is taken.
    assert_eq!(materials.trials.len(), Way::ALL.len());
    let best = materials
        .trials
        .iter()
        .map(|t| t.choosing)
        .fold(0.0, f64::max);
    let taken = materials.trials.iter().find(|t| t.way == materials.chosen);
    assert_eq!(taken.expect("a trial").choosing, best);
    let confusion = materials.confusion().expect("a matrix");
    assert!(confusion.total() > 300);
    for (class, name) in MEDIA.iter().enumerate() {
        let recall = confusion.recall(class).expect("held-out places");
        assert!(recall >= AGREE, "{name}: {recall}");
    }
    let found = classes(out);
    let mut agree = 0;
    let mut by_class = [[0usize; 4]; 4];
    for (i, found) in found.iter().enumerate() {
        let is = lies(i % WIDTH, i / WIDTH).class();
        by_class[is][*found] += 1;
        agree += usize::from(is == *found);
    }
    let share = agree as f64 / found.len() as f64;
    eprintln!("{share:.4} of all places: {by_class:?}");
    assert!(share >= AGREE, "{share}");
    let sum: f64 = materials.coverage.iter().sum();
    assert!((sum - 1.0).abs() < 1e-9 && materials.paper_shown);
    assert!(!materials.swatches.is_empty());
    for told in &materials.swatches {
        assert!(told.right >= AGREE, "{told:?}");
    }
}

#[test]
fn the_map_of_media_is_an_overlay_with_its_legend() {
    let (_, out, report) = prepared();
    let (exhibit, _) = Exhibit::read(out).unwrap_or_else(|faults| panic!("{faults}"));
    let overlays = &exhibit.drawings[0].overlays;
    let media = overlays.iter().find(|overlay| overlay.id == "media");
    let media = media.expect("an overlay");
    let OverlayKind::Categorical(legend) = &media.kind else {
        panic!("{media:?}")
    };
    let named: Vec<Option<&str>> = legend.iter().map(|entry| entry.id.as_deref()).collect();
    let drawn = materials(report).media.iter().flatten();
    let drawn: Vec<Option<&str>> = drawn.map(|medium| Some(medium.name())).collect();
    assert_eq!(named, drawn);
    // The colours of its legend are the picture's.
    let codes: Vec<[u8; 3]> = legend.iter().map(|entry| entry.colour).collect();
    let shown = pixels(&out.join("maps/recto/media.png"));
    for code in &codes {
        let meets =
            |p: &[f32; 4]| p[3] > 0.5 && [0, 1, 2].map(|c| (p[c] * 255.0).round() as u8) == *code;
        assert!(shown.iter().any(meets), "{code:?}");
    }
}

#[test]
fn roughness_is_the_surface_s_own() {
    let (_, out, report) = prepared();
    for of in &report.sides[0].matter.roughness {
        eprintln!("{of:?}");
    }
    let (exhibit, _) = Exhibit::read(out).expect("an exhibit");
    for (name, bound) in ROUGHNESS {
        let id = name.parse::<MediumId>().ok();
        let of = &report.sides[0].matter.roughness;
        let found = of.iter().find(|of| of.medium == id).expect("a roughness");
        let truth = id.unwrap_or_else(|| medium("laid")).medium().roughness();
        assert!(found.within.is_some(), "{name} is assumed");
        assert!(
            (found.alpha - truth).abs() < bound,
            "{name}: {}",
            found.alpha
        );
        // As it is written, so it is shown.
        let shown = match id {
            None => exhibit.drawings[0].paper.roughness,
            Some(_) => {
                let medium = exhibit.media.iter().find(|medium| medium.name == name);
                medium.expect("a medium").matter.roughness()
            }
        };
        assert!((shown - found.alpha).abs() < 1e-3, "{name}: {shown}");
    }
}

#[test]
fn ink_is_as_deep_as_it_lies() {
    let (stand, out, report) = prepared();
    let matter = &report.sides[0].matter;
    let map = pixels(&out.join("maps/recto/ink-depth.png"));
    let found = classes(out);
    for (class, name) in [(1, "iron-gall-ink"), (2, "wash")] {
        let (mut off, mut bias, mut sum, mut count) = (0.0, 0.0, 0.0, 0.0);
        for (i, pixel) in map.iter().enumerate() {
            let lies = lies(i % WIDTH, i / WIDTH);
            if lies.class() == class && found[i] == class {
                let truth = stand.media.depth(lies).y;
                let found = f64::from(pixel[0]) * matter.depth_white;
                off += (found - truth).abs();
                bias += found - truth;
                sum += truth;
                count += 1.0;
            }
        }
        eprintln!(
            "{name}: τ {:.3}, off by {:.4}, on the whole by {:.4}",
            sum / count,
            off / count,
            bias / count
        );
        assert!(off / sum < DEPTH, "{name}: {}", off / sum);
        let ink = matter.inks.iter().find(|ink| ink.medium == medium(name));
        let ink = ink.expect("an ink");
        let Matter::Film(film) = medium(name).medium().matter else {
            panic!("a film")
        };
        // The strongest places have 1.05 of the catalogue's.
        assert!(
            (ink.strong[1] / film.depth[1] - 1.05).abs() < 0.15,
            "{ink:?}"
        );
    }
}

/// Mean ΔE00 of albedo and mean angle of normals in degrees, of each class.
const OF_CLASS: [[f64; 2]; 4] = [[0.5, 0.5], [1.0, 1.0], [0.5, 0.5], [0.5, 1.0]];

#[test]
fn glossy_ink_bends_neither_albedo_nor_normals() {
    let (stand, out, _) = prepared();
    let mut albedo = Vec::new();
    maps::for_each_colour_row(
        &out.join("maps/recto/albedo.png"),
        ColourEncoding::Srgb,
        |_, row| albedo.extend_from_slice(row),
    )
    .expect("a picture");
    let normals = pixels(&out.join("maps/recto/normal.png"));
    let mut sums = [[0.0; 5]; 4];
    for (i, (albedo, normal)) in albedo.iter().zip(&normals).enumerate() {
        let (x, y) = (i % WIDTH, i / WIDTH);
        let lies = lies(x, y);
        let truth = stand.media.albedo(lies);
        let found = DVec3::from([0, 1, 2].map(|c| f64::from(albedo[c])));
        let lab = |rgb: DVec3| lab_from_linear(rgb.to_array());
        let n = DVec3::from([0, 1, 2].map(|c| f64::from(normal[c]) * 2.0 - 1.0)).normalize();
        let sum = &mut sums[lies.class()];
        sum[0] += delta_e00(lab(found), lab(truth));
        sum[1] += n.angle_between(made::normal(x, y)).to_degrees();
        sum[2] += found.y;
        sum[3] += truth.y;
        sum[4] += 1.0;
    }
    for (class, sum) in sums.iter().enumerate() {
        let [delta_e, angle, found, truth, _] = sum.map(|v| v / sum[4]);
        eprintln!(
            "{}: ΔE00 {delta_e:.3}, {angle:.3}°, {found:.4} for {truth:.4}",
            MEDIA[class]
        );
    }
    for (class, sum) in sums.iter().enumerate() {
        let [delta_e, angle, ..] = sum.map(|v| v / sum[4]);
        let [most, widest] = OF_CLASS[class];
        assert!(delta_e < most && angle < widest, "{}", MEDIA[class]);
    }
}

#[test]
fn the_report_says_how_well() {
    let (_, out, _) = prepared();
    let page = std::fs::read_to_string(out.join("report.html")).expect("a page");
    super::page::check(&page);
    for word in [
        "linear discriminant",
        "Levenberg-Marquardt",
        "taken for red-chalk",
        "held-out",
    ] {
        assert!(page.contains(word), "{word}");
    }
}

/// Prepared anew with other swatches.
fn with(name: &str, swatches: &str) -> (PathBuf, Report) {
    let (stand, ..) = prepared();
    let out = stand.path(name);
    let report = stand
        .prepare(&(stand.text() + swatches), &out)
        .expect("prepared");
    (out, report)
}

#[test]
fn without_swatches_there_is_no_map_and_it_is_said() {
    let (out, report) = with("none", "");
    assert!(report.sides[0].matter.materials.is_none());
    assert!(!out.join("maps/recto/media.png").exists());
    let page = std::fs::read_to_string(out.join("report.html")).expect("a page");
    assert!(page.contains("no map of media"));
    assert!(classes(&out).iter().all(|class| *class == 0));
    // Bare paper alone is no medium either.
    let (out, report) = with("one", &swatch(MEDIA[0], SWATCHES[0]));
    assert!(report.sides[0].matter.materials.is_none());
    assert!(!out.join("maps/recto/media.png").exists());
}

#[test]
fn one_medium_stands_against_the_lights() {
    let (out, report) = with("ink", &swatch(MEDIA[1], SWATCHES[1]));
    let materials = materials(&report);
    assert!(!materials.paper_shown);
    assert_eq!(materials.media.len(), 2);
    let found = classes(&out);
    let ink = |i: &usize| lies(i % WIDTH, i / WIDTH).class() == 1;
    let all = (0..found.len()).filter(ink).count();
    let right = (0..found.len())
        .filter(ink)
        .filter(|i| found[*i] == 1)
        .count();
    assert!(right as f64 > AGREE * all as f64, "{right} of {all}");
    // What no swatch shows is counted.
    assert!(materials.unlike > 0.05, "{}", materials.unlike);
}

#[test]
fn media_that_look_the_same_are_taken_for_each_other() {
    // Both swatches lie in the same ink, whose two halves bear two names.
    let [left, top, right, bottom] = SWATCHES[1];
    let middle = (left + right) / 2;
    let swatches = swatch(MEDIA[0], SWATCHES[0])
        + &swatch("iron-gall-ink", [left, top, middle, bottom])
        + &swatch("carbon-ink", [middle, top, right, bottom]);
    let (_, report) = with("alike", &swatches);
    let materials = materials(&report);
    let confusion = materials.confusion().expect("a matrix");
    eprintln!("{confusion:?}");
    let [a, b] = [1, 2].map(|class| confusion.recall(class).expect("held-out places"));
    assert!(0.5 * (a + b) < 0.85, "{a} {b}");
    assert!(confusion.recall(0).expect("paper") > AGREE);
}

#[test]
fn a_swatch_outside_is_a_fault() {
    let (stand, ..) = prepared();
    let outside = |text: String| {
        let faults = Capture::parse(&stand.path("capture.toml"), &text).expect_err("a fault");
        faults.to_string()
    };
    let told = outside(stand.text() + &swatch("wash", [200, 100, 260, 120]));
    assert!(
        told.contains("swatch[0].rect_px") && told.contains("240 × 176"),
        "{told}"
    );
    // Within the photograph, but not of the sheet.
    let cropped = stand.text() + "crop_px = [0, 40, 240, 176]\n";
    let told = outside(cropped + &swatch("wash", SWATCHES[2]));
    assert!(
        told.contains("swatch[0].rect_px") && told.contains("crop_px"),
        "{told}"
    );
}
