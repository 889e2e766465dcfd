//! The sample landscape, photographed, prepared, and what it is found to be drawn with.

use std::{fs, path::Path};

use recto::{
    manifest::{Exhibit, exhibit::MediaContent},
    maps::{ColourEncoding, encode::save_exr_rgb, for_each_colour_row},
};

use super::{code, recto};

/// Of all places.
const AGREES: f64 = 0.95;
/// Of the places of each medium, at least: paper, lead point, stylus, wash and ink.
const EACH: [f64; 5] = [0.95, 0.4, 0.9, 0.85, 0.9];
/// The sample's maps have so many pixels in so many mm.
const MAPS: [f64; 2] = [3366.0, 285.0];
/// The part of them that is photographed: left, top, width and height in pixels. Like the whole sheet, three fifths of
/// it are paper and a third of its places lie at edges.
const PART: [usize; 4] = [971, 461, 768, 512];
const AZIMUTHS: [u32; 4] = [12, 102, 192, 282];
/// What the sample is drawn with, as the legends of its maps name it, and as a capture file does.
const PAPER: usize = 0;
const DRAWN: [([u8; 3], &str); 5] = [
    ([0x80, 0x80, 0x80], "lead-point"),
    ([0x2f, 0x9e, 0x8f], "blind-stylus"),
    ([0xb8, 0x86, 0x4b], "wash"),
    ([0xc2, 0x5a, 0x1e], "iron-gall-ink"),
    ([0x3b, 0x2a, 0x1a], "iron-gall-ink"),
];
/// Swatches of each, paper first: how many, and how many pixels wide and high.
const SWATCHES: [[usize; 2]; 6] = [[8, 16], [60, 3], [60, 2], [40, 6], [60, 3], [60, 4]];

/// The codes of a map of media, `None` where there is none.
fn map(file: &Path, [left, top, width, height]: [usize; 4]) -> Vec<Option<[u8; 3]>> {
    let mut codes = Vec::new();
    for_each_colour_row(file, ColourEncoding::Linear, |y, row| {
        if (top..top + height).contains(&y) {
            codes.extend(row[left..left + width].iter().map(|[r, g, b, a]| {
                let code = [r, g, b].map(|v| (v * 255.0).round() as u8);
                (*a > 0.5).then_some(code)
            }));
        }
    })
    .unwrap();
    assert_eq!(codes.len(), width * height);
    codes
}

/// What each place of the sample is drawn with: 0 for paper, else 1 + the index in [`DRAWN`].
fn truth(maps: &Path) -> Vec<usize> {
    let [lower, upper] =
        ["lower", "upper"].map(|layer| map(&maps.join(format!("media-{layer}.png")), PART));
    let places = lower.into_iter().zip(upper);
    places
        .map(|(lower, upper)| match upper.or(lower) {
            None => PAPER,
            Some(found) => {
                let drawn = DRAWN.iter().position(|(code, _)| *code == found);
                1 + drawn.expect("a code of the legend")
            }
        })
        .collect()
}

fn name(class: usize) -> &'static str {
    match class {
        PAPER => "bare-paper",
        drawn => DRAWN[drawn - 1].1,
    }
}

/// Swatches of one material each, from all over the part, as somebody takes them who knows the sheet.
fn swatches(truth: &[usize]) -> String {
    let [_, _, width, height] = PART;
    let mut text = String::new();
    for (class, [count, side]) in SWATCHES.into_iter().enumerate() {
        let mut taken: Vec<[usize; 2]> = Vec::new();
        // Places that lie evenly, in an order that goes all over (Roberts' sequence).
        for i in 1..40_000 {
            if taken.len() == count {
                break;
            }
            let part =
                |step: f64, pixels: usize| ((i as f64 * step).fract() * pixels as f64) as usize;
            let [x, y] = [
                part(0.754_877_67, width - side),
                part(0.569_840_29, height - side),
            ];
            let is_pure =
                (0..side * side).all(|k| truth[(y + k / side) * width + x + k % side] == class);
            let is_free = taken
                .iter()
                .all(|[a, b]| a.abs_diff(x) >= side || b.abs_diff(y) >= side);
            if is_pure && is_free {
                taken.push([x, y]);
                text += &format!(
                    "[[swatch]]\nmedium = \"{}\"\nrect_px = [{x}, {y}, {}, {}]\n",
                    name(class),
                    x + side,
                    y + side
                );
            }
        }
        assert_eq!(taken.len(), count, "{}", name(class));
    }
    text
}

/// Photographs the part with `fine` × `fine` places in each pixel, their mean being what a camera's pixel shows:
/// with more than one they are also blurred over the sample's pixels beside them, between which study interpolates.
fn photographed(fine: usize, room: &Path) {
    let sample = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/exhibits/landscape"));
    let [left, top, width, height] = PART;
    let mm_per_px = MAPS[1] / MAPS[0];
    let mm = |px: f64| px * mm_per_px;
    let middle = |from: usize, size: usize| mm(from as f64 + 0.5 * size as f64);
    let camera = format!(
        "centre_mm={}x{},width_mm={}",
        middle(left, width),
        middle(top, height),
        mm(width as f64)
    );
    for (k, azimuth) in AZIMUTHS.iter().enumerate() {
        let lamp = format!(
            "kind=distant,lux_at_sheet=150,kelvin=6504,elevation_deg=45,azimuth_deg={azimuth}"
        );
        let size = format!("{}x{}", fine * width, fine * height);
        let picture = room.join("places.exr");
        let output = recto()
            .arg("render")
            .arg(sample)
            .args([
                "--scene", "whole", "--lamp", &lamp, "--camera", &camera, "--tier", "study",
            ])
            .args(["--size", &size, "--out"])
            .arg(&picture)
            .output()
            .unwrap();
        code(&output, 0);
        let mut pixels = vec![[0.0f32; 3]; width * height];
        for_each_colour_row(&picture, ColourEncoding::Linear, |y, row| {
            for (x, place) in row.iter().enumerate() {
                let pixel = &mut pixels[y / fine * width + x / fine];
                for (sum, value) in pixel.iter_mut().zip(place) {
                    *sum += value / (fine * fine) as f32;
                }
            }
        })
        .unwrap();
        let path = room.join(format!("{k}.exr"));
        save_exr_rgb(&path, width as u32, height as u32, &pixels).unwrap();
    }
}

#[test]
fn the_media_of_the_landscape_are_told_from_four_photographs() {
    told(1);
}

#[test]
fn they_are_told_from_blurred_photographs_too() {
    told(3);
}

fn told(fine: usize) {
    let room = tempfile::tempdir().unwrap();
    let sample = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/exhibits/landscape"));
    let [_, _, width, height] = PART;
    let mm_per_px = MAPS[1] / MAPS[0];
    photographed(fine, room.path());
    let truth = truth(&sample.join("maps/recto"));
    let capture = format!(
        "id = \"part\"\ntitle = \"A part of the valley\"\nscale.mm_per_px = {mm_per_px}\n[lamps]\nazimuth_deg = {AZIMUTHS:?}\n\
         elevation_deg = 45\n[recto]\nphotographs = [\"0.exr\", \"1.exr\", \"2.exr\", \"3.exr\"]\n{}",
        swatches(&truth)
    );
    let file = room.path().join("capture.toml");
    fs::write(&file, capture).unwrap();
    let out = room.path().join("out");
    let output = recto()
        .arg("prepare")
        .arg(&file)
        .arg("--out")
        .arg(&out)
        .output()
        .unwrap();
    code(&output, 0);

    let (exhibit, _) = Exhibit::read(&out).unwrap_or_else(|faults| panic!("{faults}"));
    let mut found = vec![name(PAPER); width * height];
    for layer in &exhibit.drawings[0].recto.media {
        let MediaContent::Legend(legend) = &layer.content else {
            panic!("a map of media without its legend");
        };
        let codes = map(&layer.file.path, [0, 0, width, height]);
        for (found, code) in found.iter_mut().zip(codes) {
            if let Some((_, medium)) = legend.iter().find(|(of, _)| Some(*of) == code) {
                *found = &exhibit.media[*medium].name;
            }
        }
    }
    let mut table = [[0u32; 5]; 5];
    let index = |of: &str| match of {
        "bare-paper" => PAPER,
        of => 1 + DRAWN.iter().position(|(_, name)| *name == of).expect(of),
    };
    for (is, found) in truth.iter().zip(&found) {
        table[index(name(*is))][index(found)] += 1;
    }
    let right = (0..5).map(|class| table[class][class]).sum::<u32>();
    let agrees = f64::from(right) / truth.len() as f64;
    println!("{agrees:.4} of all places; what is (rows) was taken for (columns): {table:?}");
    assert!(agrees > AGREES, "{agrees}");
    for (class, least) in EACH.into_iter().enumerate() {
        let all: u32 = table[class].iter().sum();
        let share = f64::from(table[class][class]) / f64::from(all);
        assert!(share > least, "{}: {share}", name(class));
    }
}
