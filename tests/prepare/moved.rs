//! A camera that moved between photographs: told where it did, and not where only the light did.

use std::path::{Path, PathBuf};

use glam::{DAffine2, DVec2, DVec3};
use rand::{RngExt, SeedableRng, rngs::Xoshiro256PlusPlus};
use recto::{
    maps::{self, ColourEncoding, encode},
    prepare::{
        PrepareError,
        capture::Capture,
        lights::{direction, lp},
        moved::{self, STILL_PX, Stillness},
    },
};

use super::{folder, interrupted, support::data};
use crate::test_name;

const MM_PER_PX: f64 = 0.1;

fn check(
    folder: &Path,
    photographs: &[PathBuf],
    lamps: &[DVec3],
) -> Result<Stillness, PrepareError> {
    let list: Vec<String> = photographs.iter().map(|path| format!("{path:?}")).collect();
    let azimuths = (0..list.len()).map(|i| format!("{}", 360 * i / list.len()));
    let text = format!(
        "id = \"still\"\nencoding = \"srgb\"\nscale.mm_per_px = {MM_PER_PX}\n[lamps]\n\
         azimuth_deg = [{}]\nelevation_deg = 45\n[recto]\nphotographs = [{}]\n",
        azimuths.collect::<Vec<_>>().join(", "),
        list.join(", ")
    );
    let (capture, _) = Capture::parse(&folder.join("capture.toml"), &text).expect("a capture");
    moved::check(&capture.recto, lamps, MM_PER_PX, capture.encoding, folder)
}

struct Picture {
    size: [usize; 2],
    /// Encoded.
    values: Vec<[f64; 3]>,
}

impl Picture {
    fn read(path: &Path) -> Self {
        let mut values = Vec::new();
        let mut width = 0;
        maps::for_each_colour_row(path, ColourEncoding::Linear, |_, row| {
            width = row.len();
            values.extend(row.iter().map(|p| [0, 1, 2].map(|c| f64::from(p[c]))));
        })
        .expect("a picture");
        Self {
            size: [width, values.len() / width],
            values,
        }
    }

    fn at(&self, at: DVec2) -> [f64; 3] {
        let [w, h] = self.size;
        let place = (at - 0.5).clamp(DVec2::ZERO, DVec2::new(w as f64 - 1.001, h as f64 - 1.001));
        let (x, y) = (place.x as usize, place.y as usize);
        let part = place - place.floor();
        let v = |dx: usize, dy: usize, c: usize| self.values[(y + dy) * w + x + dx][c];
        [0, 1, 2].map(|c| {
            let top = v(0, 0, c) * (1.0 - part.x) + v(1, 0, c) * part.x;
            let bottom = v(0, 1, c) * (1.0 - part.x) + v(1, 1, c) * part.x;
            top * (1.0 - part.y) + bottom * part.y
        })
    }

    /// The same from a camera that moved: what was at a place is at `by` of it.
    fn moved(&self, path: &Path, by: DAffine2) {
        let back = by.inverse();
        let [w, h] = self.size;
        let pixels: Vec<[u8; 3]> = (0..w * h)
            .map(|i| {
                let at = DVec2::new((i % w) as f64 + 0.5, (i / w) as f64 + 0.5);
                self.at(back.transform_point2(at))
                    .map(|v| (v * 255.0).round() as u8)
            })
            .collect();
        encode::save_png_rgb8(path, w as u32, h as u32, &pixels, None).expect("written");
    }
}

fn told(stillness: &Stillness) -> String {
    let each = stillness.shifts.iter().map(|by| match by {
        Some(by) => format!("({:.2}, {:.2})", by.x, by.y),
        None => "-".to_owned(),
    });
    each.collect::<Vec<_>>().join(" ")
}

/// Photographs of the cat, and towards the lamps.
fn cat(root: &Path) -> (Vec<PathBuf>, Vec<DVec3>) {
    let photographs = (1..=12).map(|i| root.join(format!("Objects/Image_{i:02}.png")));
    let text = std::fs::read_to_string(root.join("light_directions.txt")).expect("numbers");
    let l: Vec<f64> = text
        .split_whitespace()
        .map(|word| word.parse().expect("a number"))
        .collect();
    let lamps = (0..12).map(|i| DVec3::new(l[i], l[12 + i], l[24 + i]).normalize());
    (photographs.collect(), lamps.collect())
}

#[test]
fn the_cat_sat_still() {
    let Some(root) = data(test_name!(), "psbox") else {
        return;
    };
    let folder = folder();
    let (photographs, lamps) = cat(&root);
    let stillness = check(folder.path(), &photographs, &lamps).expect("nothing moved");
    eprintln!("{}", told(&stillness));
    assert!(stillness.compared() == 12, "{}", told(&stillness));
}

#[test]
fn a_cat_that_moved_is_told_by_name() {
    let Some(root) = data(test_name!(), "psbox") else {
        return;
    };
    let folder = folder();
    for (number, by) in [
        (4, DVec2::new(2.0, 0.0)),
        (0, DVec2::new(0.0, -2.0)),
        (7, DVec2::new(-31.0, 24.0)),
    ] {
        let (mut photographs, lamps) = cat(&root);
        let copy = folder.path().join(format!("moved-{number}.png"));
        Picture::read(&photographs[number]).moved(&copy, DAffine2::from_translation(by));
        photographs[number] = copy;
        match check(folder.path(), &photographs, &lamps) {
            Err(error @ PrepareError::Moved(_)) => {
                let told = error.to_string();
                let PrepareError::Moved(moved) = error else {
                    unreachable!()
                };
                assert_eq!(moved.len(), 1, "{told}");
                assert!(told.contains(&format!("moved-{number}.png")), "{told}");
                assert!(moved[0].by_px.distance(by) < 0.7, "{told}");
                assert!((moved[0].mm - moved[0].by_px.length() * MM_PER_PX).abs() < 1e-9);
            }
            other => panic!("{number} by {by}: {other:?}"),
        }
    }
}

#[test]
fn the_lion_lay_still_under_low_lamps() {
    let Some(root) = data(test_name!(), "rti_lion") else {
        return;
    };
    let text = std::fs::read_to_string(root.join("dirs.lp")).expect("text");
    let lamps = lp::read(&text).expect("lamps");
    let mut low: Vec<&lp::LpLamp> = lamps.iter().collect();
    low.sort_by(|a, b| a.direction.z.total_cmp(&b.direction.z));
    // The lowest, and every tenth.
    let folder = folder();
    let some = low.iter().take(12).chain(low.iter().step_by(10).skip(2));
    let (mut photographs, mut lamps) = (Vec::new(), Vec::new());
    for lamp in some {
        photographs.push(lamp.beside(&root));
        lamps.push(lamp.direction);
    }
    let stillness = check(folder.path(), &photographs, &lamps).expect("nothing moved");
    eprintln!("{}", told(&stillness));
    assert!(
        stillness.compared() * 4 > 3 * lamps.len(),
        "{}",
        told(&stillness)
    );
    // One of the low ones and one of the high ones, moved.
    let by = DVec2::new(2.0, 0.0);
    for number in [3, lamps.len() - 3] {
        let mut photographs = photographs.clone();
        let copy = folder.path().join("moved.png");
        Picture::read(&photographs[number]).moved(&copy, DAffine2::from_translation(by));
        photographs[number] = copy;
        let found = check(folder.path(), &photographs, &lamps);
        let Err(PrepareError::Moved(moved)) = &found else {
            panic!("{number}: {found:?}");
        };
        assert!(
            moved.len() == 1 && moved[0].path.ends_with("moved.png"),
            "{moved:?}"
        );
        assert!(moved[0].by_px.distance(by) < 0.7, "{moved:?}");
    }
}

/// A drawn sheet with relief, as lamps show it from a camera at `by`.
struct Sheet {
    noise: Vec<f64>,
}

const WIDTH: usize = 360;
const HEIGHT: usize = 260;

impl Sheet {
    fn new() -> Self {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
        Self {
            noise: (0..64 * 64).map(|_| random.random::<f64>() - 0.5).collect(),
        }
    }

    /// Smooth noise of so many pixels' period.
    fn smooth(&self, at: DVec2, period: f64) -> f64 {
        let place = at / period + 20.0;
        let (cell, part) = (place.floor(), place - place.floor());
        let part = part * part * (3.0 - 2.0 * part);
        let v = |dx: i64, dy: i64| {
            let (x, y) = (cell.x as i64 + dx, cell.y as i64 + dy);
            self.noise[(y.rem_euclid(64) * 64 + x.rem_euclid(64)) as usize]
        };
        let top = v(0, 0) * (1.0 - part.x) + v(1, 0) * part.x;
        let bottom = v(0, 1) * (1.0 - part.x) + v(1, 1) * part.x;
        top * (1.0 - part.y) + bottom * part.y
    }

    fn lamp(i: usize, elevation: f64) -> DVec3 {
        direction(77.0 * i as f64, elevation)
    }

    fn shown(&self, at: DVec2, l: DVec3, drawn: bool) -> f64 {
        let height = |at: DVec2| 2.5 * self.smooth(at, 6.0) + 8.0 * self.smooth(at, 40.0);
        let dx = height(at + DVec2::X * 0.5) - height(at - DVec2::X * 0.5);
        let dy = height(at + DVec2::Y * 0.5) - height(at - DVec2::Y * 0.5);
        let n = DVec3::new(-dx, dy, 1.0).normalize();
        let stroke = self.smooth(at + 500.0, 23.0).abs() < 0.02;
        let albedo = if drawn && stroke { 0.25 } else { 0.8 };
        (albedo * n.dot(l).max(0.0)).clamp(0.0, 1.0).sqrt()
    }

    fn photographs(
        &self,
        folder: &Path,
        elevation: f64,
        drawn: bool,
        by: &[DAffine2],
    ) -> Vec<PathBuf> {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(8);
        let each = by.iter().enumerate().map(|(i, by)| {
            let l = Self::lamp(i, elevation);
            let back = by.inverse();
            let pixels: Vec<u8> = (0..WIDTH * HEIGHT)
                .map(|p| {
                    let at = DVec2::new((p % WIDTH) as f64 + 0.5, (p / WIDTH) as f64 + 0.5);
                    let shown = self.shown(back.transform_point2(at), l, drawn);
                    let noise = 0.01 * (random.random::<f64>() - 0.5);
                    ((shown + noise).clamp(0.0, 1.0) * 255.0).round() as u8
                })
                .collect();
            let path = folder.join(format!("sheet-{i}.png"));
            encode::save_png_grey8(&path, WIDTH as u32, HEIGHT as u32, &pixels, None)
                .expect("written");
            path
        });
        each.collect()
    }
}

const STILL: DAffine2 = DAffine2::IDENTITY;

#[test]
fn light_alone_moves_nothing() {
    let sheet = Sheet::new();
    for (elevation, drawn) in [(45.0, true), (20.0, true), (45.0, false), (12.0, false)] {
        let folder = folder();
        let photographs = sheet.photographs(folder.path(), elevation, drawn, &[STILL; 6]);
        let lamps: Vec<DVec3> = (0..6).map(|i| Sheet::lamp(i, elevation)).collect();
        let stillness = check(folder.path(), &photographs, &lamps).expect("nothing moved");
        eprintln!("{elevation}° {drawn}: {}", told(&stillness));
        if let Some((_, by)) = stillness.farthest() {
            assert!(by.length() < STILL_PX, "{}", told(&stillness));
        }
        // What is drawn can be compared.
        assert!(
            !drawn || elevation < 30.0 || stillness.compared() == 6,
            "{}",
            told(&stillness)
        );
    }
}

#[test]
fn shifts_turns_and_scales_are_measured() {
    let sheet = Sheet::new();
    let middle = DVec2::new(WIDTH as f64, HEIGHT as f64) / 2.0;
    let around = |by: DAffine2| {
        DAffine2::from_translation(middle) * by * DAffine2::from_translation(-middle)
    };
    // By less than a pixel: told, and let pass.
    let folder = folder();
    let slight = DVec2::new(0.5, -0.3);
    let mut by = [STILL; 6];
    by[3] = DAffine2::from_translation(slight);
    let photographs = sheet.photographs(folder.path(), 45.0, true, &by);
    let lamps: Vec<DVec3> = (0..6).map(|i| Sheet::lamp(i, 45.0)).collect();
    let stillness = check(folder.path(), &photographs, &lamps).expect("still enough");
    eprintln!("slight: {}", told(&stillness));
    let (which, shift) = stillness.farthest().expect("compared");
    assert!(
        which == 3 && shift.distance(slight) < 0.2,
        "{}",
        told(&stillness)
    );
    for (name, motion) in [
        ("shift", DAffine2::from_translation(DVec2::new(-1.6, 1.2))),
        ("turn", around(DAffine2::from_angle(0.02))),
        ("scale", around(DAffine2::from_scale(DVec2::splat(1.015)))),
    ] {
        let mut by = [STILL; 6];
        by[2] = motion;
        let photographs = sheet.photographs(folder.path(), 45.0, true, &by);
        let Err(PrepareError::Moved(moved)) = check(folder.path(), &photographs, &lamps) else {
            panic!("{name} is not told");
        };
        assert_eq!(moved.len(), 1, "{name}: {moved:?}");
        assert!(moved[0].path.ends_with("sheet-2.png"));
        let farthest = [DVec2::ZERO, DVec2::new(WIDTH as f64, 0.0)]
            .map(|at| motion.transform_point2(at).distance(at));
        let farthest = farthest[0].max(farthest[1]);
        let off = moved[0].by_px.length() - farthest;
        eprintln!("{name}: {:.2} of {farthest:.2}", moved[0].by_px.length());
        assert!(off.abs() < 0.4, "{name}: {off}");
    }
}

#[test]
fn what_shows_nothing_is_not_compared() {
    let folder = folder();
    let photographs: Vec<PathBuf> = (0..3)
        .map(|i| {
            let path = folder.path().join(format!("flat-{i}.png"));
            let pixels = vec![120 + i as u8; 200 * 150];
            encode::save_png_grey8(&path, 200, 150, &pixels, None).expect("written");
            path
        })
        .collect();
    let lamps: Vec<DVec3> = (0..3)
        .map(|i| direction(120.0 * f64::from(i), 45.0))
        .collect();
    let stillness = check(folder.path(), &photographs, &lamps).expect("nothing moved");
    assert_eq!((stillness.compared(), stillness.farthest()), (0, None));
}

#[test]
fn what_moved_is_not_prepared() {
    let folder = folder();
    let capture = interrupted::capture(folder.path(), 160);
    let out = folder.path().join("out");
    let moved = folder.path().join("r2.png");
    Picture::read(&moved).moved(&moved, DAffine2::from_translation(DVec2::new(2.0, 1.0)));
    let told = interrupted::run(&capture, &out)
        .expect_err("it moved")
        .to_string();
    assert!(
        told.contains("r2.png") && told.contains("2.2 pixels") && told.contains("0.22 mm"),
        "{told}"
    );
    assert!(told.contains("photograph them again"), "{told}");
    assert!(!told.contains("r1.png") && !out.exists());
}

/// A capture of a sheet whose lamps are as bright as `how` says, with a back where `verso`.
fn sheet(folder: &Path, how: &str, verso: bool) -> PathBuf {
    let path = interrupted::capture(folder, 160);
    let text = std::fs::read_to_string(&path).expect("a capture");
    let mut text = text.replace("elevation_deg = 45", &format!("elevation_deg = 45{how}"));
    if verso {
        for i in 0..4 {
            let [from, to] = ["r", "v"].map(|side| folder.join(format!("{side}{i}.png")));
            std::fs::copy(from, to).expect("copied");
        }
        text += "verso.photographs = [\"v0.png\", \"v1.png\", \"v2.png\", \"v3.png\"]\n";
    }
    std::fs::write(&path, text).expect("written");
    path
}

/// Brightness is solved, which reads the photographs for it; or nothing reads them before they are
/// solved.
const BRIGHT: [&str; 2] = ["", ", intensities = \"equal\""];

#[test]
fn photographs_that_run_through_tell_what_they_tell_by_themselves() {
    for how in BRIGHT {
        let folder = folder();
        let path = sheet(folder.path(), how, true);
        let report = interrupted::run(&path, &folder.path().join("out")).expect("prepared");
        let (capture, _) = Capture::read(&path).expect("a capture");
        let lamps: Vec<DVec3> = (0..4)
            .map(|i| direction(90.0 * f64::from(i), 45.0))
            .collect();
        let verso = capture.verso.as_ref().expect("a back");
        let alone = [&capture.recto, verso].map(|shots| {
            let encoding = capture.encoding;
            moved::check(shots, &lamps, MM_PER_PX, encoding, folder.path()).expect("still")
        });
        assert_eq!(report.stillness, alone, "{how:?}");
        assert_eq!(alone[0].compared(), 4);
    }
}

#[test]
fn what_moved_of_both_sides_is_told_at_once() {
    let by = DAffine2::from_translation(DVec2::new(2.0, 1.0));
    for how in BRIGHT {
        for wrong in [&["r1.png"][..], &["v3.png"], &["r2.png", "v0.png"]] {
            let folder = folder();
            let path = sheet(folder.path(), how, true);
            for name in wrong {
                let path = folder.path().join(name);
                Picture::read(&path).moved(&path, by);
            }
            let out = folder.path().join("out");
            let told = interrupted::run(&path, &out)
                .expect_err("it moved")
                .to_string();
            for name in ["r0", "r1", "r2", "r3", "v0", "v1", "v2", "v3"] {
                let name = format!("{name}.png");
                assert_eq!(
                    told.contains(&name),
                    wrong.contains(&name.as_str()),
                    "{told}"
                );
            }
            assert!(!out.exists());
        }
    }
}
