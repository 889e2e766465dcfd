//! How slopes become the shape at large, as `[relief] integrate` of a capture file says: a folded
//! sheet whose fibres stand out along its fold, and one whose edges are pressed flat.

use std::{f64::consts::PI, fs, path::Path};

use glam::{DQuat, DVec3};
use recto::{
    maps::ColourEncoding,
    optics::{bsdf::Specimen, medium::MediumId, tier::Tier},
    prepare::{
        self,
        capture::{Capture, Integration, check_shape},
        lights::direction,
        relief::compare::remove_plane,
    },
};

use super::{
    folder,
    sitting::{Photographer, Sitting, pixels, rings},
};

const SIZE: [usize; 2] = [72, 56];
const MM_PER_PX: f64 = 0.25;
const UM_PER_PX: f64 = 1000.0 * MM_PER_PX;
/// The column of the fold.
const FOLD: usize = 36;
/// Of both sides of it.
const SLOPE: f64 = 0.12;

/// A place's slopes: of its height in pixels, per pixel to the right and down the rows.
type SlopesAt = fn(usize, usize) -> [f64; 2];

/// A roof, whose fibres stand out along some of its ridge: what they show is no slope of the sheet.
fn folded(x: usize, y: usize) -> [f64; 2] {
    match (x, y % 14) {
        (35..=36, 2..5) => [0.9, 0.0],
        _ if x < FOLD => [SLOPE, 0.0],
        _ => [-SLOPE, 0.0],
    }
}

fn roof(x: usize, _: usize) -> f64 {
    -SLOPE * (x as f64 + 0.5 - FOLD as f64).abs()
}

/// A cushion that lies at 0 all around.
fn cushion(x: usize, y: usize) -> f64 {
    let [u, v] = [x, y].map(|at| at as f64);
    let [across, down] = SIZE.map(|side| side as f64 - 1.0);
    3.0 * (PI * u / across).sin() * (PI * v / down).sin()
}

fn cushioned(x: usize, y: usize) -> [f64; 2] {
    let [u, v] = [x, y].map(|at| at as f64);
    let [across, down] = SIZE.map(|side| PI / (side as f64 - 1.0));
    let [(su, cu), (sv, cv)] = [(u * across).sin_cos(), (v * down).sin_cos()];
    [3.0 * across * cu * sv, 3.0 * down * su * cv]
}

fn photographed(slopes: SlopesAt, into: &Path) {
    let laid = "laid".parse::<MediumId>().expect("laid paper");
    let specimen = Specimen::new(laid.medium(), DVec3::splat(0.7));
    let lamps = rings(&[(8, 50.0)]);
    let frame = |[azimuth, elevation]: [f64; 2]| {
        let l = direction(azimuth, elevation);
        let shown = |i: usize| {
            let [right, down] = slopes(i % SIZE[0], i / SIZE[0]);
            let n = DVec3::new(-right, down, 1.0).normalize();
            let upright = DQuat::from_rotation_arc(n, DVec3::Z);
            let f = specimen.reflected(Tier::Gallery, upright * l, upright * DVec3::Z, 1.0);
            (f * PI * n.dot(l).max(0.0) / l.z).to_array()
        };
        (0..SIZE[0] * SIZE[1]).map(shown).collect()
    };
    let sitting = Sitting {
        frames: lamps.iter().map(|lamp| frame(*lamp)).collect(),
        lamps,
        size: SIZE,
        mm_per_px: MM_PER_PX,
    };
    let photographer = Photographer {
        ball: false,
        ..Photographer::default()
    };
    photographer.capture(&sitting, into);
}

/// The shape at large in µm of the capture in `from`, integrated this way.
fn shape(from: &Path, integrate: &str) -> Vec<f64> {
    let file = from.join("capture.toml");
    let text = fs::read_to_string(&file).expect("a capture file");
    let text = format!("{text}[relief]\nsplit_mm = 0.25\nintegrate = \"{integrate}\"\n");
    let (capture, warnings) = Capture::parse(&file, &text).unwrap_or_else(|e| panic!("{e}"));
    assert!(warnings.is_empty(), "{warnings:?}");
    let out = from.join(integrate);
    let report = prepare::run(&capture, &out, &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
    let text = fs::read_to_string(&report.manifest).expect("a manifest");
    let manifest: toml::Table = text.parse().expect("TOML");
    let range = &manifest["drawing"][0]["surface"]["height"]["range_um"];
    let number = |i: usize| {
        let value = &range[i];
        let integer = value.as_integer().map(|v| v as f64);
        value.as_float().or(integer).expect("a number")
    };
    let (low, high) = (number(0), number(1));
    let page = fs::read_to_string(out.join("report.html")).expect("a page");
    let elements = super::page::check(&page);
    // So small a sheet is shown larger, its pixels as squares.
    let albedo = elements.iter().find(|e| e.get("alt") == "Albedo");
    let albedo = albedo.expect("a picture");
    assert_eq!([albedo.get("width"), albedo.get("height")], ["576", "448"]);
    assert!(albedo.get("style").contains("image-rendering:pixelated"));
    let named = [("anchored", "edges held flat"), ("robust", "robustly")];
    for (way, words) in named {
        assert_eq!(
            page.contains(words),
            way == integrate,
            "{integrate}: {words}"
        );
    }
    let codes = pixels(&out.join("maps/shape.png"), ColourEncoding::Linear);
    assert_eq!(codes.len(), SIZE[0] * SIZE[1]);
    let um = codes.iter().map(|p| low + (high - low) * f64::from(p[0]));
    um.collect()
}

/// RMS against `truth` in µm, shift and tilt taken out.
fn off(found: &[f64], truth: impl Fn(usize, usize) -> f64) -> f64 {
    let each = found.iter().enumerate();
    let mut off: Vec<f64> = each
        .map(|(i, um)| um - UM_PER_PX * truth(i % SIZE[0], i / SIZE[0]))
        .collect();
    remove_plane(&mut off, SIZE[0]).expect("a plane");
    (off.iter().map(|um| um * um).sum::<f64>() / off.len() as f64).sqrt()
}

/// How far from what it should the fold of [`roof`] falls on either side of its ridge, in shares of
/// that, in the worst row: a blunt or broken fold falls on one side only, or not at all.
fn blunt(found: &[f64]) -> f64 {
    /// Beyond what the split of a pixel's width rounds off.
    const PX: usize = 6;
    let of_row = |y: usize| {
        let at = |x: usize| found[y * SIZE[0] + x];
        let ridge = 0.5 * (at(FOLD - 1) + at(FOLD));
        let sides = [at(FOLD - 1 - PX), at(FOLD + PX)];
        let wanted = SLOPE * PX as f64 * UM_PER_PX;
        sides.map(|side| ((ridge - side) / wanted - 1.0).abs())
    };
    (0..SIZE[1]).flat_map(of_row).fold(0.0, f64::max)
}

#[test]
fn a_torn_fold_stays_sharp_the_robust_way() {
    let room = folder();
    photographed(folded, room.path());
    let [free, robust] = ["free", "robust"].map(|way| shape(room.path(), way));
    let errors = [off(&free, roof), off(&robust, roof)];
    let blunt = [blunt(&free), blunt(&robust)];
    eprintln!("free and robust: {errors:.1?} µm, the fold is blunt by {blunt:.3?}");
    assert!(errors[1] < 0.3 * errors[0], "{errors:?}");
    assert!(blunt[1] < 0.5 * blunt[0], "{blunt:?}");
}

/// The farthest from 0 of the outermost pixels.
fn perimeter(um: &[f64]) -> f64 {
    let outer = |i: &usize| {
        let (x, y) = (i % SIZE[0], i / SIZE[0]);
        x == 0 || y == 0 || x + 1 == SIZE[0] || y + 1 == SIZE[1]
    };
    let each = (0..um.len()).filter(outer).map(|i| um[i].abs());
    each.fold(0.0, f64::max)
}

#[test]
fn an_anchored_sheet_has_its_perimeter_at_zero() {
    let room = folder();
    photographed(cushioned, room.path());
    let [free, anchored] = ["free", "anchored"].map(|way| shape(room.path(), way));
    let both = [perimeter(&free), perimeter(&anchored)];
    eprintln!(
        "perimeter {both:.2?} µm; off by {:.2} and {:.2} µm",
        off(&free, cushion),
        off(&anchored, cushion)
    );
    // A code of the map is a hundredth of a µm.
    assert!(both[1] < 0.05 && both[0] > 100.0, "{both:?}");
    // It is the cushion all the same, within 3 % of its height.
    assert!(off(&anchored, cushion) < 0.03 * 3.0 * UM_PER_PX);
}

#[test]
fn what_is_not_written_is_free() {
    assert_eq!(Integration::default(), Integration::Free);
    let check = |way: &str| {
        check_shape(&format!(
            "id = \"a\"\nscale.dpi = 600\n[lamps]\nazimuth_deg = [0, 90, 180]\nelevation_deg = 45\n\
             [recto]\nphotographs = [\"a\", \"b\", \"c\"]\n[relief]\nintegrate = \"{way}\"\n"
        ))
    };
    for way in ["free", "anchored", "robust"] {
        check(way).unwrap_or_else(|faults| panic!("{faults}"));
    }
    let wrong = check("anchor").expect_err("no such way").to_string();
    assert!(
        wrong.contains("anchored") && wrong.contains("integrate"),
        "{wrong}"
    );
}
