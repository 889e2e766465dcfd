//! The whole chain: a sheet with a known relief and known ink is photographed under lamps of
//! uneven light by a camera with colours of its own, prepared from the files, and held against
//! what it is.

use std::{
    f64::consts::PI,
    fs,
    path::{Path, PathBuf},
};

use glam::{DMat3, DQuat, DVec2, DVec3};
use rand::{SeedableRng, rngs::Xoshiro256PlusPlus};
use rand_distr::{Distribution, Normal};
use recto::{
    colour::{self, delta_e00, linear_from_srgb8},
    manifest::{Exhibit, SideName},
    maps::{self, ColourEncoding, encode},
    optics::{bsdf::Specimen, medium::MediumId, tier::Tier},
    prepare::{
        self, PrepareError, Report,
        capture::Capture,
        colour::chart::{COLORCHECKER24, COLUMNS, ROWS, linear_from_lab_d50},
        lights,
    },
};

use super::folder;

const WIDTH: usize = 200;
const HEIGHT: usize = 140;
const MM_PER_PX: f64 = 0.25;
/// RMS of all heights over their range, on paper.
const PAPER_HEIGHT: f64 = 0.03;
/// Mean ΔE00 of albedo.
const ALBEDO: f64 = 1.0;
/// Lamps, in degrees.
const LAMP_DEG: f64 = 0.2;

/// Heights in pixels: the sheet cockles, and has a ridge as a pen leaves it.
fn height(x: f64, y: f64) -> f64 {
    let cockling = 4.0 * (x / 29.0).sin() * (y / 37.0).cos() + 1.5 * ((x - y) / 23.0).cos();
    cockling + 0.15 * (x / 2.1).sin()
}

fn normal(x: f64, y: f64) -> DVec3 {
    const STEP: f64 = 1e-4;
    let dx = (height(x + STEP, y) - height(x - STEP, y)) / (2.0 * STEP);
    let drow = (height(x, y + STEP) - height(x, y - STEP)) / (2.0 * STEP);
    DVec3::new(-dx, drow, 1.0).normalize()
}

const PAPER: [u8; 3] = [226, 214, 190];
const INK: [u8; 3] = [92, 70, 52];

fn is_ink(x: usize, y: usize) -> bool {
    (x + 2 * y) % 41 < 6
}

/// What the camera's channels see of linear sRGB.
fn camera() -> DMat3 {
    DMat3::from_cols_array(&[0.62, 0.14, 0.03, 0.30, 0.72, 0.22, 0.05, 0.10, 0.60])
}

/// A lamp's light over a picture, 1 in its middle or so.
fn fall_off(lamp: usize, u: f64, v: f64) -> f64 {
    let angle = lamp as f64 * PI / 2.0;
    1.0 / (1.0
        + 0.25 * (angle.cos() * (0.5 - u) + angle.sin() * (v - 0.5))
        + 0.2 * (u - 0.5).powi(2))
}

struct Studio {
    lamps: Vec<DVec3>,
    bits: u32,
    folder: tempfile::TempDir,
}

impl Studio {
    fn new(bits: u32) -> Self {
        let lamps =
            (0..4).map(|i| lights::direction(90.0 * f64::from(i) + 12.0, 42.0 + f64::from(i)));
        let studio = Self {
            lamps: lamps.collect(),
            bits,
            folder: folder(),
        };
        studio.photograph();
        studio
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes linear light as the camera sees it, noise and rounding included.
    fn save(&self, name: &str, [width, height]: [usize; 2], at: impl Fn(usize, usize) -> DVec3) {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(name.len() as u64 + 11);
        let noise = Normal::new(0.0, 5e-4).expect("a spread");
        let full = f64::from((1u32 << self.bits) - 1);
        let pixels: Vec<[u16; 3]> = (0..width * height)
            .map(|i| {
                let seen = camera() * at(i % width, i / width) + noise.sample(&mut random);
                seen.to_array().map(|v| {
                    let code = (v.clamp(0.0, 1.0) * full).round() / full;
                    (code * 65535.0).round() as u16
                })
            })
            .collect();
        let (w, h) = (width as u32, height as u32);
        encode::save_png_rgb16(&self.path(name), w, h, &pixels, None).expect("written");
    }

    fn photograph(&self) {
        let laid = "laid".parse::<MediumId>().expect("laid paper");
        let specimens = [PAPER, INK]
            .map(|rgb| Specimen::new(laid.medium(), DVec3::from(linear_from_srgb8(rgb))));
        for (i, l) in self.lamps.iter().enumerate() {
            let light = |x: usize, y: usize, [w, h]: [usize; 2]| {
                0.8 * fall_off(i, x as f64 / w as f64, y as f64 / h as f64)
            };
            let size = [WIDTH, HEIGHT];
            self.save(&format!("recto-{i}.png"), size, |x, y| {
                let n = normal(x as f64 + 0.5, y as f64 + 0.5);
                let upright = DQuat::from_rotation_arc(n, DVec3::Z);
                let mu = n.dot(*l).max(0.0);
                let specimen = &specimens[usize::from(is_ink(x, y))];
                let f = specimen.reflected(Tier::Gallery, upright * *l, upright * DVec3::Z, 1.0);
                f * PI * mu * light(x, y, size)
            });
            self.save(&format!("grey-{i}.png"), size, |x, y| {
                DVec3::splat(0.5 * l.z * light(x, y, size))
            });
            self.save(&format!("ball-{i}.png"), [840, 840], |x, y| {
                let d = (DVec2::new(x as f64, y as f64) + 0.5 - 420.0) / 400.0;
                let square = d.length_squared();
                if square >= 1.0 {
                    return DVec3::splat(0.3);
                }
                let n = DVec3::new(d.x, -d.y, (1.0 - square).sqrt());
                let mirrored = 2.0 * n.z * n - DVec3::Z;
                // A lamp of 60 mm at 1.5 m.
                let lit = mirrored.angle_between(*l) < 0.02;
                DVec3::splat(if lit { 4.0 } else { 0.05 })
            });
        }
        let size = [6 * 30, 4 * 30];
        let chart = |x: usize, y: usize| {
            let patch =
                &COLORCHECKER24[(y / 30).min(ROWS - 1) * COLUMNS + (x / 30).min(COLUMNS - 1)];
            DVec3::from(linear_from_lab_d50(patch.lab))
        };
        let light = |x: usize, y: usize| {
            0.8 * self.lamps[0].z * fall_off(0, x as f64 / 180.0, y as f64 / 120.0)
        };
        self.save("chart.png", size, |x, y| chart(x, y) * light(x, y));
        self.save("chart-grey.png", size, |x, y| {
            DVec3::splat(0.5 * light(x, y))
        });
    }

    fn text(&self) -> String {
        let list = |name: &str| {
            let each = (0..self.lamps.len()).map(|i| format!("\"{name}-{i}.png\""));
            each.collect::<Vec<_>>().join(", ")
        };
        format!(
            "id = \"sheet\"\ntitle = \"A <sheet> & its \\\"verso\\\"\"\nencoding = \"linear\"\n\
             scale.mm_per_px = {MM_PER_PX}\n\
             [lamps]\nsphere = {{ photographs = [{}], circle_px = [420, 420, 400] }}\n\
             flat_field = [{}]\ngrey_card = 0.5\n\
             [recto]\nphotographs = [{}]\n\
             [chart]\nphotograph = \"chart.png\"\nflat_field = \"chart-grey.png\"\n\
             corners_px = [[15, 15], [165, 15], [165, 105], [15, 105]]\n",
            list("ball"),
            list("grey"),
            list("recto"),
        )
    }

    fn capture(&self) -> Capture {
        let (capture, warnings) =
            Capture::parse(&self.path("capture.toml"), &self.text()).expect("a capture");
        assert!(warnings.is_empty());
        capture
    }

    fn prepare(&self, out: &Path) -> Result<Report, PrepareError> {
        let mut last = 0.0;
        let report = prepare::run(&self.capture(), out, &mut |progress| {
            assert!(
                progress.done >= last && progress.done <= 1.0,
                "{progress:?}"
            );
            last = progress.done;
        });
        assert!(report.is_err() || last == 1.0);
        report
    }
}

fn values(path: &Path, encoding: ColourEncoding) -> Vec<[f32; 4]> {
    let mut pixels = Vec::new();
    maps::for_each_colour_row(path, encoding, |_, row| pixels.extend_from_slice(row))
        .expect("a picture");
    pixels
}

/// RMS of heights over their range, shift and tilt taken out, of shape and grain together.
fn height_error(out: &Path, report: &Report) -> f64 {
    let text = fs::read_to_string(&report.manifest).expect("a manifest");
    let manifest: toml::Table = text.parse().expect("TOML");
    let drawing = &manifest["drawing"][0];
    let heights = |map: &toml::Value| {
        let number = |i: usize| {
            let value = &map["range_um"][i];
            value
                .as_float()
                .or(value.as_integer().map(|v| v as f64))
                .expect("a number")
        };
        let (low, high) = (number(0), number(1));
        let pixels = values(
            &out.join(map["file"].as_str().expect("a file")),
            ColourEncoding::Linear,
        );
        let um = pixels
            .iter()
            .map(move |p| low + (high - low) * f64::from(p[0]));
        um.collect::<Vec<f64>>()
    };
    let shape = heights(&drawing["surface"]["height"]);
    let grain = heights(&drawing["recto"]["height"]);
    let found: Vec<f64> = shape.iter().zip(&grain).map(|(a, b)| a + b).collect();
    let mut truth: Vec<f64> = (0..WIDTH * HEIGHT)
        .map(|i| height((i % WIDTH) as f64 + 0.5, (i / WIDTH) as f64 + 0.5) * MM_PER_PX * 1000.0)
        .collect();
    let difference = prepare::relief::compare::compare(&found, &truth, WIDTH, MM_PER_PX, &[]);
    prepare::relief::compare::remove_plane(&mut truth, WIDTH);
    let [low, high] = prepare::relief::compare::range(&truth, [0.0, 1.0]).expect("heights");
    difference.expect("a comparison").whole.sigma / (high - low)
}

fn albedo_error(out: &Path) -> f64 {
    let pixels = values(&out.join("maps/recto/albedo.png"), ColourEncoding::Srgb);
    let each = pixels.iter().enumerate().map(|(i, p)| {
        let truth = linear_from_srgb8(if is_ink(i % WIDTH, i / WIDTH) {
            INK
        } else {
            PAPER
        });
        let found = [0, 1, 2].map(|c| f64::from(p[c]));
        delta_e00(
            colour::lab_from_linear(found),
            colour::lab_from_linear(truth),
        )
    });
    each.sum::<f64>() / pixels.len() as f64
}

#[test]
fn photographs_become_an_exhibit_that_is_the_sheet() {
    let studio = Studio::new(16);
    let out = studio.path("out");
    let report = studio.prepare(&out).expect("prepared");
    for (found, given) in report.lamps.iter().zip(&studio.lamps) {
        let found = lights::direction(found.azimuth_deg, found.elevation_deg);
        let off = found.angle_between(*given).to_degrees();
        assert!(off < LAMP_DEG, "{off}°");
    }
    let fitted = report.colour.as_ref().expect("a correction");
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (before, after) = (mean(&fitted.before), mean(&fitted.after));
    let heights = height_error(&out, &report);
    let albedo = albedo_error(&out);
    eprintln!(
        "chart {before:.2} → {after:.3}, heights {:.3} % of their range, albedo ΔE00 {albedo:.3}",
        100.0 * heights
    );
    assert!(before > 3.0 && after < 0.5, "{before} {after}");
    assert!(heights < PAPER_HEIGHT, "{heights}");
    assert!(albedo < ALBEDO, "{albedo}");
    // `recto check` passes it.
    let (exhibit, warnings) = Exhibit::read(&out).expect("an exhibit");
    assert!(warnings.is_empty(), "{warnings:?}");
    let drawing = &exhibit.drawings[0];
    assert!((drawing.size_mm.x - WIDTH as f64 * MM_PER_PX).abs() < 1e-9);
    assert_eq!(report.sides[0].side, SideName::Recto);
    // The page needs nothing else, and shows a title as it is written.
    let page = fs::read_to_string(out.join("report.html")).expect("a page");
    assert!(page.contains("A &lt;sheet&gt; &amp; its") && page.contains("data:image/png;base64,"));
    assert!(!page.contains("src=\"maps") && !page.contains("http"));
    let drawn = super::page::check(&page);
    assert_eq!(drawn.iter().filter(|e| e.name == "svg").count(), 4);
    assert_eq!(report.doubts(), Vec::<String>::new());
    let verdict = page.find("<h2>In short").expect("a verdict");
    assert!(verdict < page.find("<table").expect("tables"));
    for told in [
        "Lamps: good.",
        "Colour: good.",
        "Materials: not all of it is measured.",
    ] {
        assert!(page.contains(told), "{told}");
    }
    // Nothing else is left.
    let mut names: Vec<String> = fs::read_dir(&out)
        .expect("a folder")
        .map(|entry| {
            entry
                .expect("an entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    names.sort();
    assert_eq!(names, ["exhibit.toml", "maps", "report.html"]);
    // An exhibit that is there is not written over.
    let again = studio.prepare(&out).expect_err("an exhibit is there");
    assert!(matches!(again, PrepareError::Exists(_)));
}

#[test]
fn eight_bits_show_in_the_figures() {
    let error = |bits| {
        let studio = Studio::new(bits);
        let out = studio.path("out");
        let report = studio.prepare(&out).expect("prepared");
        // Of grain, which is the smallest.
        let residual = report.sides[0].residual[0];
        (height_error(&out, &report), albedo_error(&out), residual)
    };
    let (eight, sixteen) = (error(8), error(16));
    eprintln!("8 bits {eight:?}, 16 bits {sixteen:?}");
    assert!(
        eight.1 > 1.2 * sixteen.1 || eight.0 > 1.2 * sixteen.0,
        "{eight:?} {sixteen:?}"
    );
}

#[test]
fn what_fails_leaves_nothing_behind() {
    let studio = Studio::new(16);
    let out = studio.path("out");
    let fails = |text: &str| {
        let (capture, _) = Capture::parse(&studio.path("capture.toml"), text).expect("a capture");
        let error = prepare::run(&capture, &out, &mut |_| {}).expect_err("a fault");
        assert!(!out.exists(), "{error}");
        error.to_string()
    };
    // A ball without a highlight, where the recto lies.
    let told = fails(
        &studio
            .text()
            .replace("\"ball-2.png\"", "\"flat.png\"")
            .replace("flat.png", {
                studio.save("flat.png", [840, 840], |_, _| DVec3::ZERO);
                "flat.png"
            }),
    );
    assert!(
        told.contains("flat.png") && told.contains("highlight"),
        "{told}"
    );
    // A grey card that does not fill the picture.
    studio.save("half.png", [WIDTH, HEIGHT], |x, _| {
        DVec3::splat(if x < 60 { 0.0 } else { 0.3 })
    });
    let told = fails(&studio.text().replace("\"grey-1.png\"", "\"half.png\""));
    assert!(
        told.contains("half.png") && told.contains("grey card"),
        "{told}"
    );
    // A chart that is clipped.
    studio.save("white.png", [180, 120], |_, _| DVec3::splat(3.0));
    let told = fails(&studio.text().replace("\"chart.png\"", "\"white.png\""));
    assert!(
        told.contains("white.png") && told.contains("saturated"),
        "{told}"
    );
    // The chart of one grey.
    studio.save("dull.png", [180, 120], |_, _| DVec3::splat(0.3));
    let told = fails(&studio.text().replace("\"chart.png\"", "\"dull.png\""));
    assert!(told.contains("dull.png"), "{told}");
    // Lamps that a ball shows in one place.
    // A lamp that did not fire, and one that was too bright.
    for (name, light, word) in [
        ("dark.png", 0.0, "black"),
        ("bright.png", 9.0, "over-exposed"),
    ] {
        studio.save(name, [WIDTH, HEIGHT], |_, _| DVec3::splat(light));
        let told = fails(
            &studio
                .text()
                .replace("\"recto-2.png\"", &format!("\"{name}\"")),
        );
        assert!(told.contains(name) && told.contains(word), "{told}");
    }
    for name in ["again-1.png", "again-2.png"] {
        // What lies behind a picture's end is no part of it.
        let mut file = std::fs::read(studio.path("ball-0.png")).expect("a ball");
        file.extend(name.bytes());
        std::fs::write(studio.path(name), file).expect("written");
    }
    let told = fails(&studio.text().replace(
        "\"ball-1.png\", \"ball-2.png\", \"ball-3.png\"",
        "\"again-1.png\", \"again-2.png\", \"ball-2.png\"",
    ));
    assert!(told.contains("one plane"), "{told}");
}
