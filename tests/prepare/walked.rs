//! Truth by the reference: a relief and inks that are known, as random walks through paper see them
//! under 24 lamps (`fixtures/walked-*.png`, written by the test `bake`), photographed, and prepared
//! from the files.
//!
//! One walk counts for all lamps of a place, so that its chance is that of the paper's albedo, and
//! hardly that of its normal.

use std::f64::consts::PI;

use glam::{DQuat, DVec2, DVec3};
use rayon::prelude::*;
use recto::{
    colour::{delta_e00, lab_from_linear},
    maps::ColourEncoding,
    prepare::{
        Report,
        capture::Robustness,
        gloss::first::{Seen, Surfaces, some_lamps},
        lights::direction,
        relief::compare::{compare, range, remove_plane},
        stereo::{Paper, Response, Rig, Rows, Solver, left_out::Relit},
    },
    reference::{
        Absorption, Capture, Lamp as Beam, Layers, Lighting, Phase, radiance, rng::stream,
    },
};

use super::{
    folder,
    sitting::{
        Frame, Lamp, Photographer, Sitting, fixture, fixture_path, heights, pixels, write_fixture,
    },
};

const SIZE: [usize; 2] = [40, 32];
const COUNT: usize = SIZE[0] * SIZE[1];
const MM_PER_PX: f64 = 0.25;
const LAMPS: usize = 24;
const CHANNELS: usize = 3 * LAMPS;
/// Walks of each pixel.
const WALKS: u64 = 1024;
/// Paths that undo a photograph: its albedo within .2 %.
const CAPTURE_PATHS: u64 = 1 << 18;

/// Mean error of normals in degrees: matte, and with gloss and cast shadows.
const MATTE_DEG: f64 = 1.0;
const GLOSSY_DEG: f64 = 3.0;
/// RMS of all heights over their range.
const HEIGHT: f64 = 0.03;
/// Mean ΔE00 of albedo.
const ALBEDO: f64 = 1.0;
/// Lamps, in degrees.
const LAMP_DEG: f64 = 0.2;

/// Of the paper.
const INDEX: f64 = 1.5;

/// A sheet that was walked through.
#[derive(Clone, Copy)]
struct Sheet {
    name: &'static str,
    /// Roughness of the paper, and of its ink.
    alpha: [f64; 2],
    paper: [f64; 3],
    ink: [f64; 3],
    /// In pixels.
    height: fn(f64, f64) -> f64,
    is_ink: fn(usize, usize) -> bool,
    seed: u64,
}

const MATTE: Sheet = Sheet {
    name: "matte",
    alpha: [0.5; 2],
    paper: [0.72, 0.66, 0.55],
    ink: [0.16, 0.11, 0.08],
    height: folds,
    is_ink: |x, y| (x + 2 * y) % 11 < 3,
    seed: 5,
};

const GLOSSY: Sheet = Sheet {
    name: "glossy",
    alpha: [0.25; 2],
    ..MATTE
};

/// Another relief, other paper and darker ink, each of a roughness of its own. How many places and
/// rounds there are was chosen with an eye on it; no constant of the optics was.
const OTHER: Sheet = Sheet {
    name: "other",
    alpha: [0.7, 0.35],
    paper: [0.64, 0.60, 0.52],
    ink: [0.085, 0.07, 0.06],
    height: waves,
    is_ink: |x, y| (x % 13 < 4) != (y % 16 < 3),
    seed: 77,
};

/// Folds, and a pen's ridges.
fn folds(x: f64, y: f64) -> f64 {
    2.2 * (x / 9.0).sin() * (y / 11.0).cos() + 0.8 * ((x - y) / 13.0).cos() + 0.1 * (x / 2.1).sin()
}

/// Waves of a sheet that dried on a line, and its grain.
fn waves(x: f64, y: f64) -> f64 {
    1.3 * ((x + 0.6 * y) / 6.5).sin() + 0.9 * ((y - 3.0) / 5.0).cos() + 0.08 * (y / 1.3).sin()
}

impl Sheet {
    fn normal(&self, x: f64, y: f64) -> DVec3 {
        const STEP: f64 = 1e-4;
        let height = self.height;
        let dx = (height(x + STEP, y) - height(x - STEP, y)) / (2.0 * STEP);
        let drow = (height(x, y + STEP) - height(x, y - STEP)) / (2.0 * STEP);
        DVec3::new(-dx, drow, 1.0).normalize()
    }

    fn has_ink(&self, i: usize) -> bool {
        (self.is_ink)(i % SIZE[0], i / SIZE[0])
    }

    fn albedo(&self, i: usize) -> [f64; 3] {
        if self.has_ink(i) {
            self.ink
        } else {
            self.paper
        }
    }
}

fn middle(i: usize) -> [f64; 2] {
    [(i % SIZE[0]) as f64 + 0.5, (i / SIZE[0]) as f64 + 0.5]
}

/// Of the lamps, the first four stand around the sheet, and so do the first eight.
fn lamps() -> Vec<Lamp> {
    let ring = |count: usize, first: f64, elevation: f64| {
        (0..count).map(move |i| [first + 360.0 / count as f64 * i as f64, elevation])
    };
    let four = ring(4, 12.0, 45.0).chain(ring(4, 57.0, 45.0));
    four.chain(ring(8, 30.0, 25.0))
        .chain(ring(8, 8.0, 65.0))
        .collect()
}

/// What each lamp shows of each place, shadows left out.
fn walk(sheet: &Sheet) -> Vec<Frame> {
    let layers = sheet.alpha.map(|alpha| Layers {
        n: INDEX,
        alpha: [alpha, 0.5],
        sigma_s: 81.38,
        phase: Phase::single(1.0 / 3.0),
        thickness_mm: 0.3,
    });
    let capture = layers.map(|layers| Capture::new(&layers, CAPTURE_PATHS, 1));
    // The same paper below the ink, whatever its surface.
    let paper = sheet.paper.map(|albedo| Absorption {
        sigma_a: capture[0].solve_sigma_a(albedo).value,
        ..Absorption::NONE
    });
    let ink: [Absorption; 3] = std::array::from_fn(|c| Absorption {
        tau_f: capture[1].solve_tau(sheet.ink[c], &paper[c]).value,
        ..paper[c]
    });
    let lamps: Vec<DVec3> = lamps().into_iter().map(|[a, e]| direction(a, e)).collect();
    let seen: Vec<[f64; CHANNELS]> = (0..COUNT)
        .into_par_iter()
        .map(|i| {
            let [x, y] = middle(i);
            let upright = DQuat::from_rotation_arc(sheet.normal(x, y), DVec3::Z);
            let (spot, layers) = match sheet.has_ink(i) {
                true => (&ink, &layers[1]),
                false => (&paper, &layers[0]),
            };
            let absorption: [Absorption; CHANNELS] = std::array::from_fn(|k| spot[k % 3]);
            let beams: Vec<Beam<CHANNELS>> = lamps
                .iter()
                .enumerate()
                .filter_map(|(k, l)| {
                    let mut irradiance = [0.0; CHANNELS];
                    // A perfect diffuser that lies flat shows 1.
                    irradiance[3 * k..3 * k + 3].fill(PI / l.z);
                    let direction = upright * *l;
                    (direction.z > 0.0).then_some(Beam {
                        direction,
                        irradiance,
                    })
                })
                .collect();
            let lighting = Lighting {
                lamps: &beams,
                table: [0.0; CHANNELS],
            };
            let mut rng = stream(sheet.seed, i as u64);
            let eye = upright * DVec3::Z;
            radiance(layers, &absorption, eye, &lighting, WALKS, &mut rng).map(|e| e.mean)
        })
        .collect();
    let of_lamp = |k: usize| {
        seen.iter()
            .map(move |all| [0, 1, 2].map(|c| all[3 * k + c]))
    };
    (0..LAMPS).map(|k| of_lamp(k).collect()).collect()
}

fn name(sheet: &Sheet) -> String {
    format!("walked-{}.png", sheet.name)
}

#[test]
#[ignore = "writes the fixtures: minutes of random walks"]
fn bake() {
    for sheet in [MATTE, GLOSSY, OTHER] {
        // Those that are there stay.
        if !fixture_path(&name(&sheet)).exists() {
            write_fixture(&name(&sheet), SIZE, &walk(&sheet));
            eprintln!("{}", sheet.name);
        }
    }
}

/// Whether the relief, or a thread that hangs over the sheet, is between a place and a lamp.
fn is_shadowed(sheet: &Sheet, i: usize, lamp: usize, l: DVec3) -> bool {
    let height = sheet.height;
    let [x, y] = middle(i);
    if (x as usize + 7 * lamp) % 40 < 4 {
        return true;
    }
    let across = DVec2::new(l.x, -l.y);
    let rise = l.z / across.length();
    let step = across.normalize() * 0.25;
    (1..160).any(|k| {
        let at = DVec2::new(x, y) + step * f64::from(k);
        height(at.x, at.y) > height(x, y) + rise * 0.25 * f64::from(k) + 0.02
    })
}

/// The first `count` lamps.
fn sitting(sheet: &Sheet, count: usize, shadows: bool) -> Sitting {
    let lamps = lamps();
    let mut frames = fixture(&name(sheet), SIZE, LAMPS);
    frames.truncate(count);
    for (k, frame) in frames.iter_mut().enumerate().filter(|_| shadows) {
        let l = direction(lamps[k][0], lamps[k][1]);
        let shadowed = (0..COUNT).filter(|i| is_shadowed(sheet, *i, k, l));
        shadowed.for_each(|i| frame[i] = [0.0; 3]);
    }
    Sitting {
        lamps: lamps[..count].to_vec(),
        size: SIZE,
        mm_per_px: MM_PER_PX,
        frames,
    }
}

/// Mean error of normals in degrees, where photographs are as the photographer makes them.
fn normal_error(
    sheet: &Sheet,
    sitting: &Sitting,
    photographer: Photographer,
    response: Response,
) -> f64 {
    let planes: Vec<[Vec<f32>; 3]> = sitting
        .frames
        .iter()
        .enumerate()
        .map(|(i, frame)| photographer.planes(frame, i as u64))
        .collect();
    let towards = sitting.lamps.iter().map(|[a, e]| direction(*a, *e));
    let solver = Solver {
        rig: Rig::far(towards.collect()),
        response,
        robustness: Robustness::Robust,
    };
    let solved = solver.solve(Rows {
        planes: &planes,
        width: SIZE[0],
        top: 0,
    });
    let off: Vec<f64> = solved
        .normal
        .iter()
        .enumerate()
        .map(|(i, n)| {
            let [x, y] = middle(i);
            let found = DVec3::from(n.map(f64::from));
            found.angle_between(sheet.normal(x, y)).to_degrees()
        })
        .collect();
    off.iter().sum::<f64>() / COUNT as f64
}

/// What came of the files.
struct Errors {
    /// RMS over the range.
    height: f64,
    /// Mean ΔE00.
    albedo: f64,
    /// The farthest lamp, in degrees.
    lamp: f64,
    /// Of photographs left out of the fit.
    relit: Relit,
    /// What the report says to look at again.
    doubts: Vec<String>,
}

fn chain(sheet: &Sheet, sitting: &Sitting, photographer: Photographer) -> Errors {
    let room = folder();
    let (report, out) = photographer.prepared(sitting, room.path());
    let found = heights(&out, &report);
    let mut truth: Vec<f64> = (0..COUNT)
        .map(|i| (sheet.height)(middle(i)[0], middle(i)[1]) * MM_PER_PX * 1000.0)
        .collect();
    let off = compare(&found, &truth, SIZE[0], MM_PER_PX, &[]).expect("a comparison");
    remove_plane(&mut truth, SIZE[0]);
    let [low, high] = range(&truth, [0.0, 1.0]).expect("heights");
    let albedo = pixels(&out.join("maps/recto/albedo.png"), ColourEncoding::Srgb);
    let each = albedo.iter().enumerate().map(|(i, p)| {
        let truth = sheet.albedo(i);
        let found = [0, 1, 2].map(|c| f64::from(p[c]));
        delta_e00(lab_from_linear(found), lab_from_linear(truth))
    });
    Errors {
        height: off.whole.sigma / (high - low),
        albedo: each.sum::<f64>() / COUNT as f64,
        lamp: lamp_error(sitting, &report),
        relit: report.sides[0].relit.expect("photographs to leave out"),
        doubts: report.doubts(),
    }
}

fn lamp_error(sitting: &Sitting, report: &Report) -> f64 {
    let pairs = report.lamps.iter().zip(&sitting.lamps);
    let off = pairs.map(|(found, [azimuth, elevation])| {
        let found = direction(found.azimuth_deg, found.elevation_deg);
        found
            .angle_between(direction(*azimuth, *elevation))
            .to_degrees()
    });
    off.fold(0.0, f64::max)
}

#[test]
fn a_sheet_is_found_in_its_photographs() {
    for count in [4, 8, LAMPS] {
        let sitting = sitting(&MATTE, count, false);
        let photographer = Photographer::default();
        let Errors {
            height,
            albedo,
            lamp,
            relit,
            doubts,
        } = chain(&MATTE, &sitting, photographer);
        eprintln!("walked, {count} lamps: {relit:?}");
        assert!(relit.computed < relit.neighbours, "{count}: {relit:?}");
        let of_lamps = |doubt: &&String| doubt.starts_with("lamps: ");
        assert_eq!(doubts.iter().find(of_lamps), None, "{count}");
        eprintln!(
            "walked, {count} lamps: heights {:.3} % of their range, albedo ΔE00 {albedo:.3}, lamps {lamp:.3}°",
            100.0 * height
        );
        assert!(height < HEIGHT, "{count}: {height}");
        assert!(albedo < ALBEDO, "{count}: {albedo}");
        assert!(lamp < LAMP_DEG, "{count}: {lamp}");
    }
}

#[test]
fn photographs_under_lamps_exchanged_are_not_computed_from_each_other() {
    let mut sitting = sitting(&MATTE, 8, false);
    let right = chain(&MATTE, &sitting, Photographer::default()).relit;
    // Those of the first lamp and of the one opposite.
    sitting.frames.swap(0, 2);
    let photographer = Photographer {
        ball: false,
        ..Photographer::default()
    };
    let wrong = chain(&MATTE, &sitting, photographer);
    // And it is said.
    let told =
        |doubt: &String| doubt.starts_with("lamps: ") && doubt.contains("order of the lamps");
    assert!(wrong.doubts.iter().any(told), "{:?}", wrong.doubts);
    let wrong = wrong.relit;
    eprintln!("walked, relit: {right:?}, exchanged {wrong:?}");
    assert!(wrong.computed > 2.0 * right.computed, "{right:?} {wrong:?}");
}

/// What is known of a sheet's surfaces before it is solved.
#[derive(Clone, Copy, Debug)]
enum Known {
    /// Nothing: the catalogue's laid paper is assumed.
    Nothing,
    /// How rough its paper is; ink is taken for paper.
    Paper,
    /// What its photographs show, as `recto prepare` finds it.
    Photographs,
}

/// As the photographs show them under some of the lamps.
fn surfaces(sitting: &Sitting) -> Surfaces {
    let towards = sitting.lamps.iter().map(|[a, e]| direction(*a, *e));
    let rig = Rig::far(towards.collect());
    let lamps = some_lamps(&rig);
    let planes: Vec<[Vec<f32>; 3]> = lamps
        .iter()
        .map(|i| Photographer::default().planes(&sitting.frames[*i], *i as u64))
        .collect();
    let seen = |i: usize| Seen {
        at: DVec2::from(middle(i)),
        shown: planes
            .iter()
            .map(|planes| DVec3::from(planes.each_ref().map(|plane| f64::from(plane[i]))))
            .collect(),
    };
    let places: Vec<Seen> = (0..COUNT).map(seen).collect();
    Surfaces::new(&places, &rig.only(&lamps), &|_| 1.0, true)
}

/// Mean error of normals under the first four, eight and all lamps.
fn normal_errors(sheet: &Sheet, shadows: bool, known: Known) -> [f64; 3] {
    [4, 8, LAMPS].map(|count| {
        let sitting = sitting(sheet, count, shadows);
        let response = match known {
            Known::Nothing => Response::laid_paper(),
            Known::Paper => Response::Paper(Paper::new(sheet.alpha[0], INDEX, 1.0)),
            Known::Photographs => surfaces(&sitting).response,
        };
        let off = normal_error(sheet, &sitting, Photographer::default(), response);
        let name = sheet.name;
        eprintln!("walked, {name}, {count} lamps, by {known:?}: {off:.3}°");
        off
    })
}

#[test]
fn normals_of_a_matte_sheet_are_found() {
    let off = normal_errors(&MATTE, false, Known::Photographs);
    assert!(off.iter().all(|off| *off < MATTE_DEG), "{off:?}");
    // Assumed, the same surface misses it, and so does the right one with ink taken for paper.
    let assumed = normal_errors(&MATTE, false, Known::Nothing);
    assert!(assumed.iter().all(|off| *off > MATTE_DEG), "{assumed:?}");
    let paper = normal_errors(&MATTE, false, Known::Paper);
    assert!((0..3).all(|i| paper[i] > 1.5 * off[i]), "{paper:?} {off:?}");
}

#[test]
fn gloss_and_cast_shadows_are_seen_through() {
    for sheet in [GLOSSY, OTHER] {
        let off = normal_errors(&sheet, true, Known::Photographs);
        assert!(off.iter().all(|off| *off < GLOSSY_DEG), "{off:?}");
        // Taken for another paper, it is not: what is found makes the difference.
        let assumed = normal_errors(&sheet, true, Known::Nothing);
        assert!(
            (0..3).all(|i| assumed[i] > 2.0 * off[i]),
            "{assumed:?} {off:?}"
        );
    }
}

#[test]
fn surfaces_are_found_before_anything_is_solved() {
    /// Of a roughness.
    const OFF: f64 = 0.04;
    for (sheet, shadows) in [(MATTE, false), (GLOSSY, true), (OTHER, true)] {
        let found = surfaces(&sitting(&sheet, LAMPS, shadows));
        let dark = found.dark.expect("ink");
        assert!(dark.is_film, "{}", sheet.name);
        for (of, alpha) in [found.paper, dark.roughness].iter().zip(sheet.alpha) {
            eprintln!("walked, {}: {of:?} of {alpha}", sheet.name);
            let within = of.within.expect("a bound");
            assert!((of.alpha - alpha).abs() < OFF.max(within), "{of:?} {alpha}");
        }
    }
    // Without ink nothing is dark.
    let mut bare = sitting(&MATTE, 8, false);
    let paper: Vec<usize> = (0..COUNT).filter(|i| !MATTE.has_ink(*i)).collect();
    for frame in &mut bare.frames {
        for i in (0..COUNT).filter(|i| MATTE.has_ink(*i)) {
            frame[i] = frame[paper[i * 7 % paper.len()]];
        }
    }
    let found = surfaces(&bare);
    assert!(found.dark.is_none(), "{:?}", found.dark);
    assert!((found.paper.alpha - MATTE.alpha[0]).abs() < OFF);
}

#[test]
fn eight_bits_are_worse_than_sixteen() {
    let sitting = sitting(&MATTE, 4, false);
    let error = |bits| {
        let photographer = Photographer {
            bits,
            noise: 0.0,
            ..Photographer::default()
        };
        // What rounding moves, and not what is wrong with both.
        let fine = Photographer {
            bits: 16,
            ..photographer
        };
        let planes = |p: Photographer| p.planes(&sitting.frames[0], 0);
        let [a, b] = [planes(photographer), planes(fine)];
        let each = a[1]
            .iter()
            .zip(&b[1])
            .map(|(a, b)| f64::from((a - b).powi(2)));
        let moved = (each.sum::<f64>() / COUNT as f64).sqrt();
        (moved, chain(&MATTE, &sitting, photographer).albedo)
    };
    let ((moved, eight), (_, sixteen)) = (error(8), error(16));
    eprintln!(
        "walked, 8 bits: photograph off by {moved:.5}, albedo ΔE00 {eight:.4}; 16 bits {sixteen:.4}"
    );
    assert!(moved > 1e-3, "{moved}");
    assert!(eight > 1.02 * sixteen, "{eight} {sixteen}");
}
