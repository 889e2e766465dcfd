//! A colour chart that is found by itself.

use std::path::Path;

use glam::{DMat3, DVec2, DVec3};
use rand::{RngExt, SeedableRng, rngs::Xoshiro256PlusPlus};
use recto::{
    maps::{ColourEncoding, encode},
    prepare::{
        PrepareError,
        capture::{Capture, Crop},
        colour::{
            chart::{COLORCHECKER24, COLUMNS, ChartError, PATCHES, ROWS, linear_from_lab_d50},
            look,
        },
        find,
        reduced::Reduced,
    },
};

use super::folder;

/// How far a corner may be from where it is, in distances of patches: a fifth is read of them to
/// each side, and they are half as wide.
const OFF: f64 = 0.08;

/// A photograph with charts in it.
struct Scene {
    size: [usize; 2],
    /// From charts, whose patches are 1 apart and the first at 0, 0, to places in the picture.
    charts: Vec<DMat3>,
    /// How wide a patch is; between them is the black frame.
    patch: f64,
    /// Which patches a hand covers.
    covered: Vec<usize>,
    noise: f64,
    /// Things of all colours lie around.
    clutter: bool,
}

/// A chart whose middle is at a place, so many pixels from patch to patch, turned, and leaning
/// back by so much over its width.
fn chart(middle: [f64; 2], pitch: f64, turn_deg: f64, lean: [f64; 2]) -> DMat3 {
    let half = DVec2::new((COLUMNS - 1) as f64, (ROWS - 1) as f64) / 2.0;
    let lean = DMat3::from_cols(
        DVec3::new(1.0, 0.0, lean[0]),
        DVec3::new(0.0, 1.0, lean[1]),
        DVec3::Z,
    );
    DMat3::from_translation(middle.into())
        * DMat3::from_angle(turn_deg.to_radians())
        * DMat3::from_scale(DVec2::splat(pitch))
        * lean
        * DMat3::from_translation(-half)
}

fn project(onto: &DMat3, at: DVec2) -> DVec2 {
    let to = *onto * at.extend(1.0);
    to.truncate() / to.z
}

fn corners(onto: &DMat3) -> [DVec2; 4] {
    let (w, h) = ((COLUMNS - 1) as f64, (ROWS - 1) as f64);
    [[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]].map(|at| project(onto, at.into()))
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            size: [800, 600],
            charts: vec![chart([390.0, 310.0], 70.0, 3.0, [0.0, 0.0])],
            patch: 0.82,
            covered: Vec::new(),
            noise: 0.004,
            clutter: true,
        }
    }
}

impl Scene {
    fn of(onto: DMat3) -> Self {
        Self {
            charts: vec![onto],
            ..Self::default()
        }
    }

    /// `from` are the inverses of `charts`.
    fn at(&self, from: &[DMat3], at: DVec2) -> DVec3 {
        for from in from {
            let place = project(from, at);
            let (w, h) = (COLUMNS as f64 - 1.0, ROWS as f64 - 1.0);
            let margin = 0.8;
            let inside = place.x > -margin
                && place.y > -margin
                && place.x < w + margin
                && place.y < h + margin;
            if !inside {
                continue;
            }
            let nearest = place.round().clamp(DVec2::ZERO, DVec2::new(w, h));
            let off = (place - nearest).abs().max_element();
            let i = nearest.y as usize * COLUMNS + nearest.x as usize;
            if self.covered.contains(&i) && off < 0.55 {
                return DVec3::new(0.45, 0.28, 0.2);
            }
            return match off < self.patch / 2.0 {
                true => DVec3::from(linear_from_lab_d50(COLORCHECKER24[i].lab)).max(DVec3::ZERO),
                false => DVec3::splat(0.02),
            };
        }
        if self.clutter {
            // Books and boxes, and the table.
            for k in 0..12 {
                let k = f64::from(k);
                let low = DVec2::new((k * 173.0) % 760.0, (k * 97.0) % 560.0);
                let size = DVec2::new(30.0 + (k * 31.0) % 50.0, 24.0 + (k * 17.0) % 60.0);
                if at.cmpgt(low).all() && at.cmplt(low + size).all() {
                    return DVec3::new((k * 0.37) % 0.8, (k * 0.53) % 0.7, (k * 0.71) % 0.6) + 0.05;
                }
            }
        }
        DVec3::splat(0.35)
    }

    /// As a camera with colours of its own has it, under a lamp from one side.
    fn picture(&self, path: &Path) {
        const SUB: usize = 2;
        let camera =
            DMat3::from_cols_array(&[0.62, 0.14, 0.03, 0.30, 0.72, 0.22, 0.05, 0.10, 0.60]);
        let mut random = Xoshiro256PlusPlus::seed_from_u64(21);
        let [w, h] = self.size;
        let from: Vec<DMat3> = self.charts.iter().map(DMat3::inverse).collect();
        let pixels: Vec<[u16; 3]> = (0..w * h)
            .map(|i| {
                let corner = DVec2::new((i % w) as f64, (i / w) as f64);
                let sum: DVec3 = (0..SUB * SUB)
                    .map(|s| {
                        let by = DVec2::new((s % SUB) as f64, (s / SUB) as f64) + 0.5;
                        self.at(&from, corner + by / SUB as f64)
                    })
                    .sum();
                let light = 0.75 * (1.0 + 0.25 * (corner.x / w as f64 - 0.5));
                let seen = camera * sum / (SUB * SUB) as f64 * light;
                seen.to_array().map(|v| {
                    let noise = self.noise * (random.random::<f64>() - 0.5) * 3.4;
                    ((v + noise).clamp(0.0, 1.0) * 65535.0).round() as u16
                })
            })
            .collect();
        encode::save_png_rgb16(path, w as u32, h as u32, &pixels, None).expect("written");
    }

    fn found(&self) -> Result<[DVec2; 4], ChartError> {
        let folder = folder();
        let path = folder.path().join("chart.png");
        self.picture(&path);
        let [right, bottom] = self.size.map(|side| side as u32);
        let whole = Crop {
            left: 0,
            top: 0,
            right,
            bottom,
        };
        let picture = Reduced::read(&path, ColourEncoding::Linear, whole, 1, folder.path())
            .expect("a picture");
        look::find(&picture, &COLORCHECKER24.map(|patch| patch.lab))
    }

    fn is_found(&self, name: &str) {
        let found = self.found().unwrap_or_else(|why| panic!("{name}: {why}"));
        let wanted = corners(&self.charts[0]);
        let pitch = wanted[0].distance(wanted[1]) / (COLUMNS - 1) as f64;
        let off = found
            .iter()
            .zip(&wanted)
            .map(|(a, b)| a.distance(*b) / pitch);
        let off = off.fold(0.0, f64::max);
        eprintln!("{name}: corners off by {off:.3} of a patch");
        assert!(off < OFF, "{name}: {found:?} for {wanted:?}");
    }
}

#[test]
fn charts_are_found_any_way_up() {
    for turn in [0.0, 90.0, 180.0, 270.0, 12.0, 45.0, 133.0, 250.0] {
        Scene::of(chart([400.0, 300.0], 62.0, turn, [0.0, 0.0])).is_found(&format!("{turn}°"));
    }
    Scene::of(chart([400.0, 300.0], 72.0, -8.0, [0.03, -0.04])).is_found("in perspective");
    Scene::of(chart([650.0, 120.0], 22.0, 95.0, [0.0, 0.0])).is_found("small");
    Scene {
        patch: 1.0,
        clutter: false,
        ..Scene::default()
    }
    .is_found("without a frame between");
    Scene {
        noise: 0.02,
        ..Scene::default()
    }
    .is_found("in noise");
}

#[test]
fn what_is_no_chart_or_not_clear_is_told() {
    let none = Scene {
        charts: Vec::new(),
        ..Scene::default()
    };
    assert_eq!(none.found(), Err(ChartError::NotFound));
    // Its first column is outside.
    let cut = Scene::of(chart([110.0, 300.0], 70.0, 0.0, [0.0, 0.0]));
    assert_eq!(cut.found(), Err(ChartError::NotFound));
    // A thumb.
    let covered = Scene {
        covered: vec![16, 17],
        ..Scene::default()
    };
    assert!(
        matches!(covered.found(), Err(ChartError::Covered(16 | 17))),
        "{:?}",
        covered.found()
    );
    // A hand.
    let hidden = Scene {
        covered: (0..12).collect(),
        ..Scene::default()
    };
    assert!(hidden.found().is_err());
    let two = Scene {
        charts: vec![
            chart([220.0, 300.0], 45.0, 4.0, [0.0, 0.0]),
            chart([580.0, 300.0], 45.0, -3.0, [0.0, 0.0]),
        ],
        ..Scene::default()
    };
    assert_eq!(two.found(), Err(ChartError::Several));
}

#[test]
fn other_charts_of_the_same_grid_are_refused() {
    // The same patches, each in another one's place, as another maker has them.
    let scene = Scene::default();
    let folder = folder();
    let path = folder.path().join("chart.png");
    scene.picture(&path);
    let [right, bottom] = scene.size.map(|side| side as u32);
    let whole = Crop {
        left: 0,
        top: 0,
        right,
        bottom,
    };
    let picture =
        Reduced::read(&path, ColourEncoding::Linear, whole, 1, folder.path()).expect("a picture");
    let other: Vec<[f64; 3]> = (0..PATCHES)
        .map(|i| COLORCHECKER24[(i * 7 + 3) % PATCHES].lab)
        .collect();
    assert!(look::find(&picture, &other).is_err());
}

#[test]
fn a_capture_without_corners_has_its_colours_corrected() {
    let folder = folder();
    let path = folder.path();
    let write = |name: &str, scene: &Scene| scene.picture(&path.join(name));
    write(
        "chart.png",
        &Scene::of(chart([400.0, 300.0], 62.0, 187.0, [0.01, 0.0])),
    );
    for (i, name) in ["b.png", "c.png"].into_iter().enumerate() {
        let [w, h] = Scene::default().size;
        let pixels = vec![[20_000 + i as u16; 3]; w * h];
        encode::save_png_rgb16(&path.join(name), w as u32, h as u32, &pixels, None)
            .expect("a photograph");
    }
    let text = |corners: &str| {
        format!(
            "id = \"chart\"\nencoding = \"linear\"\nscale.mm_per_px = 0.1\n\
             lamps = {{ azimuth_deg = [0, 120, 240], elevation_deg = 45 }}\n\
             recto.photographs = [\"chart.png\", \"b.png\", \"c.png\"]\n\
             chart = {{ photograph = \"chart.png\"{corners} }}\n"
        )
    };
    let fitted = |corners: &str| {
        let (capture, _) =
            Capture::parse(&path.join("capture.toml"), &text(corners)).expect("a capture");
        let lamps = find::lamps(&capture, path).expect("lamps");
        let looked = find::look(&capture, &capture.recto, &lamps, path).expect("light");
        let rig = looked.rig(&capture.recto).expect("intensities");
        find::correction(&capture, &rig, path)
    };
    let found = fitted("").expect("a chart").expect("a correction");
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    eprintln!(
        "ΔE00 {:.2} → {:.2}",
        mean(&found.before),
        mean(&found.after)
    );
    // The lamp's fall-off remains, as no grey card says it.
    assert!(mean(&found.after) < 3.0 && mean(&found.after) < 0.5 * mean(&found.before));
    // Corners in another order are refused, and do not make paper red.
    let known = corners(&chart([400.0, 300.0], 62.0, 187.0, [0.01, 0.0]));
    let in_order = |order: [usize; 4]| {
        let list = order.map(|i| format!("[{:.2}, {:.2}]", known[i].x, known[i].y));
        fitted(&format!(", corners_px = [{}]", list.join(", ")))
    };
    assert!(in_order([0, 1, 2, 3]).expect("a chart").is_some());
    for order in [[1, 0, 3, 2], [2, 3, 0, 1], [3, 2, 1, 0]] {
        let error = in_order(order).expect_err("another order").to_string();
        assert!(error.contains("dark skin, bluish green"), "{error}");
    }
    write(
        "chart.png",
        &Scene {
            charts: Vec::new(),
            ..Scene::default()
        },
    );
    let error = fitted("").expect_err("no chart");
    assert!(matches!(error, PrepareError::Chart { .. }));
    let told = error.to_string();
    assert!(
        told.contains("chart.png") && told.contains("corners_px"),
        "{told}"
    );
}
