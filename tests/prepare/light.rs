//! How bright things are: albedo has its level whatever grey cards, chart and exposure there are,
//! and what is assumed is said to be. A flat sheet of a perfect diffuser, whose albedo is known.

use std::{
    fs,
    path::{Path, PathBuf},
};

use glam::{DVec2, DVec3};
use recto::{
    manifest::{Exhibit, LampKind, Severity, Source},
    maps::{self, ColourEncoding, encode},
    prepare::{
        self, Report,
        capture::Capture,
        colour::chart::{COLORCHECKER24, COLUMNS, linear_from_lab_d50},
        find,
        lights::direction,
    },
};

use super::folder;

const SIZE: [usize; 2] = [96, 64];
const CHART: [usize; 2] = [180, 120];
/// Of an albedo, in shares of it.
const LEVEL: f64 = 0.02;

/// A table with a sheet on it, in a room.
struct Table {
    azimuth_deg: Vec<f64>,
    /// In turn, as with lamps of one height ink cannot be told from body colour.
    elevation_deg: [f64; 2],
    intensities: Vec<f64>,
    /// What a photograph shows of a perfect diffuser that faces a lamp of intensity 1.
    light: DVec3,
    /// And of one under the room's light alone.
    room: DVec3,
    /// Albedo of paper and of what is on it.
    albedo: [f64; 2],
    folder: tempfile::TempDir,
}

impl Table {
    fn new(exposure: f64, intensities: &[f64]) -> Self {
        let count = intensities.len();
        Self {
            azimuth_deg: (0..count)
                .map(|i| 360.0 * i as f64 / count as f64)
                .collect(),
            elevation_deg: [30.0, 45.0],
            intensities: intensities.to_vec(),
            // No white light.
            light: DVec3::new(1.0, 0.9, 0.75) * exposure,
            room: DVec3::ZERO,
            albedo: [0.5, 0.1],
            folder: folder(),
        }
    }

    fn elevation(&self, lamp: usize) -> f64 {
        self.elevation_deg[lamp % 2]
    }

    fn at(&self, x: usize, y: usize) -> f64 {
        self.albedo[usize::from((x + y) % 23 < 4)]
    }

    /// What the photograph under a lamp shows of a flat perfect diffuser.
    fn lit(&self, lamp: usize) -> DVec3 {
        let l = direction(self.azimuth_deg[lamp], self.elevation(lamp));
        self.light * (self.intensities[lamp] * l.z) + self.room
    }

    fn save(&self, name: &str, [w, h]: [usize; 2], at: impl Fn(usize, usize) -> DVec3) {
        let pixels: Vec<[u16; 3]> = (0..w * h)
            .map(|i| {
                let seen = at(i % w, i / w).to_array();
                assert!(seen.iter().all(|v| *v < 0.995), "{name} is clipped");
                seen.map(|v| (v.max(0.0) * 65535.0).round() as u16)
            })
            .collect();
        let path = self.folder.path().join(name);
        encode::save_png_rgb16(&path, w as u32, h as u32, &pixels, None).expect("written");
    }

    /// The sheet and a card of 50 % under each lamp and under none, and a chart with a card of its
    /// own, in even light and in light that falls off.
    fn photograph(&self) {
        for lamp in 0..self.intensities.len() {
            let light = self.lit(lamp);
            // No two photographs are the same to the last bit.
            let marked = |x: usize, y: usize| {
                let mark = if (x, y) == (0, 0) { 1e-3 } else { 0.0 };
                self.at(x, y) + mark * lamp as f64
            };
            self.save(&format!("r{lamp}.png"), SIZE, |x, y| light * marked(x, y));
            self.save(&format!("g{lamp}.png"), SIZE, |_, _| light * 0.5);
        }
        self.save("dark.png", SIZE, |x, y| self.room * self.at(x, y));
        self.save("dark-card.png", SIZE, |_, _| self.room * 0.5);
        let light = self.lit(0);
        let falls = |x: usize| 1.2 - 0.4 * (x as f64 + 0.5) / CHART[0] as f64;
        self.save("chart.png", CHART, |x, y| patch(x, y) * light);
        self.save("uneven.png", CHART, |x, y| patch(x, y) * light * falls(x));
        self.save("chart-card.png", CHART, |x, _| light * 0.5 * falls(x));
    }

    fn list(&self, letter: &str) -> String {
        let names: Vec<String> = (0..self.intensities.len())
            .map(|i| format!("\"{letter}{i}.png\""))
            .collect();
        format!("[{}]", names.join(", "))
    }

    fn text(&self, lamps: &str, rest: &str) -> String {
        let elevations = (0..self.intensities.len()).map(|lamp| self.elevation(lamp));
        let elevations: Vec<f64> = elevations.collect();
        format!(
            "id = \"sheet\"\nencoding = \"linear\"\nscale.mm_per_px = 0.25\n[lamps]\n\
             azimuth_deg = {:?}\nelevation_deg = {elevations:?}\n{lamps}[recto]\nphotographs = {}\n{rest}",
            self.azimuth_deg,
            self.list("r")
        )
    }

    fn cards(&self) -> String {
        format!("flat_field = {}\ngrey_card = 0.5\n", self.list("g"))
    }

    /// What comes of the sheet, and the warnings.
    fn prepared(&self, name: &str, lamps: &str, rest: &str) -> (Prepared, Vec<String>) {
        let file = self.folder.path().join("capture.toml");
        let parsed = Capture::parse(&file, &self.text(lamps, rest));
        let (capture, warnings) = parsed.expect("a capture");
        let out = self.folder.path().join(name);
        let report = prepare::run(&capture, &out, &mut |_| {}).expect("prepared");
        let told = warnings.iter().map(|fault| {
            assert_eq!(fault.severity, Severity::Warning);
            fault.to_string()
        });
        (Prepared { out, report }, told.collect())
    }
}

/// Linear colour of a chart.
fn patch(x: usize, y: usize) -> DVec3 {
    let patch = &COLORCHECKER24[y / 30 * COLUMNS + x / 30];
    DVec3::from(linear_from_lab_d50(patch.lab)).max(DVec3::ZERO)
}

struct Prepared {
    out: PathBuf,
    report: Report,
}

impl Prepared {
    /// Median albedo of paper and of what is on it.
    fn albedo(&self, table: &Table) -> [DVec3; 2] {
        let read = pixels(&self.out.join("maps/recto/albedo.png"));
        [false, true].map(|dark| {
            let own = (1..read.len()).filter(|i| {
                let (x, y) = (i % SIZE[0], i / SIZE[0]);
                table.at(x, y) == table.albedo[usize::from(dark)]
            });
            let own: Vec<usize> = own.collect();
            let channel = |c: usize| {
                let mut values: Vec<f32> = own.iter().map(|i| read[*i][c]).collect();
                values.sort_by(f32::total_cmp);
                f64::from(values[values.len() / 2])
            };
            DVec3::new(channel(0), channel(1), channel(2))
        })
    }

    fn page(&self) -> String {
        fs::read_to_string(self.out.join("report.html")).expect("a report")
    }
}

fn pixels(path: &Path) -> Vec<[f32; 4]> {
    let mut pixels = Vec::new();
    maps::for_each_colour_row(path, ColourEncoding::Srgb, |_, row| {
        pixels.extend_from_slice(row)
    })
    .expect("a map");
    pixels
}

fn assert_near(found: [DVec3; 2], wanted: [f64; 2], within: f64, what: &str) {
    eprintln!("{what}: {:.4} {:.4}", found[0], found[1]);
    for (found, wanted) in found.into_iter().zip(wanted) {
        let off = (found / wanted - 1.0).abs().max_element();
        assert!(off < within, "{what}: {found:.4} is not {wanted}");
    }
}

const CORNERS: &str = "corners_px = [[15, 15], [165, 15], [165, 105], [15, 105]]\n";

#[test]
fn a_chart_says_the_level_with_and_without_grey_cards() {
    let table = Table::new(0.9, &[1.3, 0.8, 1.0, 1.1]);
    table.photograph();
    let cards = table.cards();
    let own = |photograph: &str| format!("[chart]\nphotograph = \"{photograph}\"\n{CORNERS}");
    let with_card = format!("{}flat_field = \"chart-card.png\"\n", own("uneven.png"));
    let stated = "relative = [2.6, 1.6, 2.0, 2.2]\n";
    for (name, lamps, chart) in [
        ("both", cards.as_str(), with_card.clone()),
        ("lamps alone", &cards, own("chart.png")),
        ("chart alone", "", with_card),
        ("neither", "", own("chart.png")),
        ("stated", stated, own("chart.png")),
    ] {
        let (prepared, warnings) = table.prepared(name, lamps, &chart);
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_near(prepared.albedo(&table), table.albedo, LEVEL, name);
        assert_eq!(prepared.report.sides[0].assumed_exposure, None);
    }
}

#[test]
fn a_chart_under_a_near_lamp_is_read_place_by_place() {
    const EXPOSURE: f64 = 0.4;
    let table = Table::new(EXPOSURE, &[1.2, 1.0, 0.8]);
    let at = |x: usize, y: usize| DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
    let capture = || {
        let text = table.text("distance_mm = 60\nrelative = [1.2, 1.0, 0.8]\n", "");
        let text = format!("{text}[chart]\nphotograph = \"r0.png\"\n{CORNERS}");
        let file = table.folder.path().join("capture.toml");
        Capture::parse(&file, &text).expect("a capture").0
    };
    let path = table.folder.path();
    let rig = |capture: &Capture| {
        let lamps = find::lamps(capture, path).expect("lamps");
        let looked = find::look(capture, &capture.recto, &lamps, path).expect("light");
        looked.rig(&capture.recto).expect("intensities")
    };
    for lamp in 0..3 {
        table.save(&format!("r{lamp}.png"), CHART, |_, _| {
            DVec3::splat(0.1 + lamp as f64 * 0.1)
        });
    }
    let lamps = rig(&capture());
    for lamp in 0..3 {
        table.save(&format!("r{lamp}.png"), CHART, |x, y| {
            let lit = lamps.lamp(lamp, at(x, y));
            patch(x, y) * (EXPOSURE * lit.gain * lit.l.z)
        });
    }
    let capture = capture();
    let fitted = find::correction(&capture, &rig(&capture), path).expect("a chart");
    let fitted = fitted.expect("a correction");
    // The lamp's fall-off, of a third from side to side, is taken out.
    assert!(fitted.off() < 1.0, "{}", fitted.off());
    for (white, shown) in fitted
        .correction
        .apply([1.0; 3])
        .into_iter()
        .zip(fitted.correction.white)
    {
        assert!((white - 1.0).abs() < 1e-6, "{white}");
        assert!((shown / EXPOSURE - 1.0).abs() < LEVEL, "{shown}");
    }
}

#[test]
fn without_grey_cards_exposure_changes_no_albedo() {
    // The brightest paper is taken for .85.
    let wanted = [0.85, 0.05 * 0.85 / 0.7];
    let mut of_exposures = Vec::new();
    for exposure in [0.8, 0.08] {
        let mut table = Table::new(exposure, &[1.0, 0.9, 1.0, 1.1]);
        (table.albedo, table.elevation_deg) = ([0.7, 0.05], [45.0, 65.0]);
        table.light = DVec3::splat(exposure);
        table.photograph();
        let (solved, _) = table.prepared("solved", "", "");
        let solved = solved.albedo(&table);
        assert_near(solved, wanted, 0.03, &format!("solved, {exposure}"));
        of_exposures.push(solved);
        let of = |factor: f64| {
            let values = table.intensities.iter().map(|v| v * factor);
            let values: Vec<f64> = values.collect();
            let out = format!("relative {factor}");
            let (stated, _) = table.prepared(&out, &format!("relative = {values:?}\n"), "");
            stated.albedo(&table)
        };
        let plain = of(1.0);
        assert_near(plain, wanted, 0.03, &format!("stated, {exposure}"));
        // Only their ratios matter.
        for (one, other) in plain.into_iter().zip(of(20.0)) {
            assert!((one - other).abs().max_element() < 1e-4, "{one} {other}");
        }
    }
    for (one, other) in of_exposures[0].into_iter().zip(of_exposures[1]) {
        let off = (one / other - 1.0).abs().max_element();
        assert!(off < 0.02, "{one} {other}");
    }
}

#[test]
fn room_light_is_taken_from_grey_cards_too() {
    let mut table = Table::new(0.8, &[1.0, 0.9, 1.0, 1.1]);
    // A quarter of what a lamp gives.
    table.room = DVec3::splat(0.1);
    table.photograph();
    let (cards, ambient) = (table.cards(), "ambient = \"dark.png\"\n");
    let with = format!("{cards}flat_field_ambient = \"dark-card.png\"\n");
    let (both, warnings) = table.prepared("both", &with, ambient);
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_near(both.albedo(&table), table.albedo, LEVEL, "room light");
    // As has the chart, whose card has the same room's light in it, or the first lamp's has.
    let chart = format!("{ambient}[chart]\nphotograph = \"chart.png\"\n{CORNERS}");
    let (chart, warnings) = table.prepared("chart", &with, &chart);
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_near(chart.albedo(&table), table.albedo, LEVEL, "and a chart");
    // Where it is taken from one of the two alone, the sheet is off, and that is told.
    let (one, warnings) = table.prepared("sheet", &cards, ambient);
    assert!(one.albedo(&table)[0].max_element() < 0.45);
    assert!(
        warnings.len() == 1 && warnings[0].contains("flat_field_ambient = \"…\""),
        "{warnings:?}"
    );
    let (_, warnings) = table.prepared("cards", &with, "");
    assert!(
        warnings.len() == 1 && warnings[0].contains("recto.ambient = \"…\""),
        "{warnings:?}"
    );
    // A chart without any card keeps the room's light.
    let chart = format!("{ambient}[chart]\nphotograph = \"chart.png\"\n{CORNERS}");
    let (_, warnings) = table.prepared("bare", "", &chart);
    assert!(
        warnings.len() == 1 && warnings[0].contains("chart"),
        "{warnings:?}"
    );
    let faults = |lamps: &str| {
        let file = table.folder.path().join("capture.toml");
        let faults = Capture::parse(&file, &table.text(lamps, "")).expect_err("faults");
        let told: Vec<String> = faults.into_iter().map(|f| f.to_string()).collect();
        told.join("\n")
    };
    let other_size = faults(&format!("{cards}flat_field_ambient = \"chart.png\"\n"));
    assert!(
        other_size.contains("lamps.flat_field_ambient") && other_size.contains("180 × 120"),
        "{other_size}"
    );
    let missing = faults(&format!("{cards}flat_field_ambient = \"none.png\"\n"));
    assert!(missing.contains("not there"), "{missing}");
    let alone = faults("flat_field_ambient = \"dark-card.png\"\n");
    assert!(alone.contains("flat_field"), "{alone}");
}

#[test]
fn a_clipped_card_is_refused_whatever_the_room_gives() {
    let mut table = Table::new(0.8, &[1.0, 0.9, 1.0, 1.1]);
    table.room = DVec3::splat(0.1);
    table.photograph();
    let white = vec![[u16::MAX; 3]; SIZE[0] * SIZE[1]];
    let path = table.folder.path().join("g1.png");
    encode::save_png_rgb16(&path, SIZE[0] as u32, SIZE[1] as u32, &white, None).expect("written");
    let lamps = format!("{}flat_field_ambient = \"dark-card.png\"\n", table.cards());
    let file = table.folder.path().join("capture.toml");
    let text = table.text(&lamps, "ambient = \"dark.png\"\n");
    let (capture, _) = Capture::parse(&file, &text).expect("a capture");
    let error = prepare::run(&capture, &table.folder.path().join("out"), &mut |_| {});
    let told = error.expect_err("a clipped card").to_string();
    assert!(
        told.contains("g1.png") && told.contains("saturated"),
        "{told}"
    );
}

#[test]
fn a_level_that_was_assumed_is_said_to_be() {
    let table = Table::new(0.8, &[1.0, 0.9, 1.0, 1.1]);
    table.photograph();
    for (name, lamps, source) in [
        ("assumed", String::new(), Source::Assumed),
        ("measured", table.cards(), Source::Measured),
    ] {
        let (prepared, _) = table.prepared(name, &lamps, "");
        let (exhibit, _) = Exhibit::read(&prepared.out).expect("an exhibit");
        let side = &exhibit.drawings[0].recto;
        assert_eq!(side.albedo.file.source, source, "{name}");
        let normal = side.normal.as_ref().expect("normals");
        assert_eq!(normal.file.source, Source::Measured, "{name}");
        let height = side.height.as_ref().expect("heights");
        assert_eq!(height.file.source, Source::Measured, "{name}");
    }
}

#[test]
fn an_exhibit_shows_lamps_from_all_around_as_bright_as_they_were() {
    let intensities: Vec<f64> = (0..12).map(|i| 1.0 + 0.05 * f64::from(i)).collect();
    let mut table = Table::new(0.6, &intensities);
    table.elevation_deg = [30.0, 30.0];
    table.photograph();
    let (prepared, _) = table.prepared("twelve", &format!("relative = {intensities:?}\n"), "");
    let page = prepared.page();
    assert!(page.contains("under 8 of the 12 lamps"), "{page}");
    let (exhibit, _) = Exhibit::read(&prepared.out).expect("an exhibit");
    let shown: Vec<(usize, f64, f64)> = exhibit
        .lamps
        .iter()
        .map(|lamp| {
            let number = lamp.id.strip_prefix("photographed-").expect("its name");
            let number: usize = number.parse().expect("its number");
            let LampKind::Distant {
                illuminance,
                azimuth,
                ..
            } = &lamp.kind
            else {
                panic!("far away")
            };
            (number - 1, azimuth.0, illuminance.0)
        })
        .collect();
    assert_eq!(shown.len(), 8);
    for pair in shown.windows(2) {
        // The first eight would leave a third of the circle dark.
        assert!(pair[1].1 - pair[0].1 <= 61.0, "{shown:?}");
    }
    assert!(shown[0].1 + 360.0 - shown[7].1 <= 61.0, "{shown:?}");
    let mean = shown.iter().map(|(.., lux)| lux).sum::<f64>() / 8.0;
    assert!((mean - 150.0).abs() < 0.01, "{mean}");
    for (i, azimuth, lux) in &shown {
        assert!((azimuth - table.azimuth_deg[*i]).abs() < 0.06);
        let of_first = lux / shown[0].2 * intensities[shown[0].0] / intensities[*i];
        assert!((of_first - 1.0).abs() < 1e-3, "{shown:?}");
    }
    // Where all are shown, nothing is said; grey cards leave them alike.
    let table = Table::new(0.8, &[1.0, 0.9, 1.0, 1.1]);
    table.photograph();
    let (four, _) = table.prepared("four", &table.cards(), "");
    assert!(!four.page().contains("of the 4 lamps"));
}
