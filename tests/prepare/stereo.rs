//! Stereo: normals and albedo of surfaces that are known, photographed by the closed form of the
//! paper's optics in f64, with noise, rounding, highlights and cast shadows.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use rand::{SeedableRng, rngs::Xoshiro256PlusPlus};
use rand_distr::{Distribution, Normal};
use recto::{
    colour::{self, delta_e00},
    maps::{self, ColourEncoding},
    optics::{bsdf::Specimen, medium::MediumId, tier::Tier},
    prepare::{
        capture::Robustness,
        lights::{direction, lp},
        relief::{
            compare::{compare, range},
            integrate::{Perimeter, Slopes, integrate},
        },
        stereo::{Gain, Inked, Paper, Response, Rig, Rows, Solved, Solver, Standing, relight},
    },
};

use super::support::data;
use crate::test_name;

/// Mean error of normals on matte surfaces, in degrees.
const MATTE_DEG: f64 = 1.0;
/// With gloss and cast shadows.
const GLOSSY_DEG: f64 = 3.0;
/// RMS of heights over their range, on matte surfaces.
const HEIGHT: f64 = 0.01;
/// Mean ΔE00 of albedo.
const ALBEDO: f64 = 1.0;

const SIDE: usize = 96;

/// Heights in pixels: folds, and strokes across them.
fn height(x: f64, y: f64) -> f64 {
    let folds = 3.0 * (x / 17.0).sin() * (y / 23.0).cos() + 2.0 * ((x + 2.0 * y) / 31.0).sin();
    folds + 0.25 * ((x - y) / 2.3).sin()
}

fn normal(x: f64, y: f64) -> DVec3 {
    const STEP: f64 = 1e-4;
    let dx = (height(x + STEP, y) - height(x - STEP, y)) / (2.0 * STEP);
    let drow = (height(x, y + STEP) - height(x, y - STEP)) / (2.0 * STEP);
    // Rows run down, and y of normals up.
    DVec3::new(-dx, drow, 1.0).normalize()
}

/// Paper, with strokes of ink.
fn albedo(x: usize, y: usize) -> DVec3 {
    if (x / 5 + y / 9).is_multiple_of(4) {
        DVec3::new(0.16, 0.11, 0.08)
    } else {
        DVec3::new(0.72, 0.66, 0.55)
    }
}

/// What a photograph of a scene is like.
struct Scene {
    lamps: Vec<DVec3>,
    /// Glossy or matte, by the roughness; a perfect diffuser without.
    alpha: Option<f64>,
    /// Whether the relief casts shadows.
    shadows: bool,
    /// Standard deviation of a photograph's noise at white.
    noise: f64,
    bits: u32,
}

impl Scene {
    fn matte(lamps: Vec<DVec3>) -> Self {
        Self {
            lamps,
            alpha: None,
            shadows: false,
            noise: 0.002,
            bits: 16,
        }
    }

    /// Whether the relief, or a thread that hangs over the sheet, is between a place and a lamp.
    fn is_shadowed(&self, x: f64, y: f64, lamp: usize) -> bool {
        let l = self.lamps[lamp];
        if (x as usize + 13 * lamp) % 48 < 6 {
            return true;
        }
        let across = DVec2::new(l.x, -l.y);
        let rise = l.z / across.length();
        let step = across.normalize() * 0.5;
        let start = height(x, y);
        (1..80).any(|i| {
            let at = DVec2::new(x, y) + step * f64::from(i);
            height(at.x, at.y) > start + rise * 0.5 * f64::from(i) + 0.02
        })
    }

    /// Photographs, divided by those of a grey card.
    fn photographs(&self) -> Vec<[Vec<f32>; 3]> {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
        let noise = Normal::new(0.0, self.noise).expect("a spread");
        let laid = "laid".parse::<MediumId>().expect("laid paper");
        let specimens = self.alpha.map(|alpha| {
            let specimen = |albedo: DVec3| {
                let mut specimen = Specimen::new(laid.medium(), albedo);
                specimen.surface.alpha = alpha;
                specimen
            };
            [albedo(0, 0), albedo(6, 0)].map(specimen)
        });
        let full = f64::from((1u32 << self.bits) - 1);
        let mut photographs = Vec::new();
        for (lamp, l) in self.lamps.iter().enumerate() {
            let mut planes = [0, 1, 2].map(|_| vec![0.0f32; SIDE * SIDE]);
            for (x, y) in (0..SIDE * SIDE).map(|i| (i % SIDE, i / SIDE)) {
                let i = y * SIDE + x;
                let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                let n = normal(px, py);
                let mu = n.dot(*l);
                let albedo = albedo(x, y);
                let mut shown = match &specimens {
                    _ if mu <= 0.0 || self.shadows && self.is_shadowed(px, py, lamp) => DVec3::ZERO,
                    None => albedo * mu,
                    Some(specimens) => {
                        let upright = glam::DQuat::from_rotation_arc(n, DVec3::Z);
                        let inked = usize::from(albedo.x > 0.5);
                        let specimen = &specimens[inked];
                        let (l, v) = (upright * *l, upright * DVec3::Z);
                        specimen.reflected(Tier::Gallery, l, v, 1.0) * PI * mu
                    }
                };
                // Exposed so that white paper under the lamp fills two thirds of the range.
                shown = shown * 0.9 + noise.sample(&mut random);
                for c in 0..3 {
                    let rounded = (shown[c].clamp(0.0, 1.0) * full).round() / full;
                    planes[c][i] = (rounded / 0.9 / l.z) as f32;
                }
            }
            photographs.push(planes);
        }
        photographs
    }

    fn solve(&self, response: Response, robustness: Robustness) -> Solved {
        self.solve_of(&self.photographs(), response, robustness)
    }

    fn solve_of(
        &self,
        planes: &[[Vec<f32>; 3]],
        response: Response,
        robustness: Robustness,
    ) -> Solved {
        let solver = Solver {
            rig: Rig::far(self.lamps.clone()),
            response,
            robustness,
        };
        solver.solve(Rows {
            planes,
            width: SIDE,
            top: 0,
        })
    }
}

/// Mean error of normals in degrees.
fn error_deg(solved: &Solved) -> f64 {
    let each = solved.normal.iter().enumerate().map(|(i, n)| {
        let (x, y) = (i % SIDE, i / SIDE);
        let truth = normal(x as f64 + 0.5, y as f64 + 0.5);
        DVec3::from(n.map(f64::from))
            .angle_between(truth)
            .to_degrees()
    });
    each.sum::<f64>() / solved.normal.len() as f64
}

/// RMS of integrated heights over their range.
fn height_error(solved: &Solved) -> f64 {
    let found = integrate(&Slopes::of_normals(&solved.normal, SIDE), Perimeter::Free);
    let place = |i: usize| [(i % SIDE) as f64 + 0.5, (i / SIDE) as f64 + 0.5];
    let truth = (0..SIDE * SIDE).map(|i| height(place(i)[0], place(i)[1]));
    let truth: Vec<f64> = truth.collect();
    let off = compare(&found, &truth, SIDE, 1.0, &[]).expect("a comparison");
    let [low, high] = range(&truth, [0.0, 1.0]).expect("heights");
    off.whole.sigma / (high - low)
}

/// Mean ΔE00 of albedo.
fn albedo_error(solved: &Solved) -> f64 {
    let each = (0..SIDE * SIDE).map(|i| {
        let truth: [f64; 3] = albedo(i % SIDE, i / SIDE).into();
        let found = [0, 1, 2].map(|c| f64::from(solved.albedo[c][i]));
        delta_e00(
            colour::lab_from_linear(found),
            colour::lab_from_linear(truth),
        )
    });
    each.sum::<f64>() / (SIDE * SIDE) as f64
}

fn ring(count: u32, elevation: f64) -> Vec<DVec3> {
    let step = 360.0 / f64::from(count);
    (0..count)
        .map(|i| direction(f64::from(i) * step + 10.0, elevation))
        .collect()
}

/// Two rings, as domes have them.
fn dome(count: u32) -> Vec<DVec3> {
    [ring(count / 2, 30.0), ring(count / 2, 55.0)].concat()
}

#[test]
fn a_matte_surface_is_found_under_any_number_of_lamps() {
    for lamps in [ring(3, 45.0), ring(4, 45.0), dome(8), dome(24)] {
        let count = lamps.len();
        let solved = Scene::matte(lamps).solve(Response::Lambert, Robustness::Robust);
        let (normals, colours) = (error_deg(&solved), albedo_error(&solved));
        let heights = height_error(&solved);
        eprintln!(
            "matte, {count} lamps: heights {:.3} % of their range",
            100.0 * heights
        );
        assert!(heights < HEIGHT, "{count}: {heights}");
        eprintln!("matte, {count} lamps: {normals:.3}°, ΔE00 {colours:.3}");
        assert!(
            normals < MATTE_DEG && colours < ALBEDO,
            "{count}: {normals}° {colours}"
        );
    }
}

#[test]
fn eight_bits_are_worse_than_sixteen() {
    let error = |bits| {
        let scene = Scene {
            noise: 0.0,
            bits,
            ..Scene::matte(ring(4, 45.0))
        };
        error_deg(&scene.solve(Response::Lambert, Robustness::Robust))
    };
    let (eight, sixteen) = (error(8), error(16));
    eprintln!("8 bits {eight:.4}°, 16 bits {sixteen:.5}°");
    // A test that sees no difference would be blind.
    assert!(eight > 20.0 * sixteen && eight > 0.05, "{eight} {sixteen}");
}

#[test]
fn paper_is_not_a_perfect_diffuser() {
    for lamps in [ring(4, 45.0), dome(24)] {
        let count = lamps.len();
        let scene = Scene {
            alpha: Some(0.5),
            ..Scene::matte(lamps)
        };
        let paper = Response::Paper(Paper::new(0.5, index(), 1.0));
        let planes = scene.photographs();
        let right = scene.solve_of(&planes, paper, Robustness::Robust);
        let lambert = scene.solve_of(&planes, Response::Lambert, Robustness::Robust);
        let [right_deg, lambert_deg] = [&right, &lambert].map(error_deg);
        let [right_colour, lambert_colour] = [&right, &lambert].map(albedo_error);
        eprintln!(
            "paper, {count} lamps: {right_deg:.3}° ΔE00 {right_colour:.3}; as a diffuser \
             {lambert_deg:.3}° ΔE00 {lambert_colour:.3}"
        );
        assert!(right_deg < MATTE_DEG && right_colour < ALBEDO);
        assert!(lambert_deg > 2.0 * right_deg);
    }
}

fn index() -> f64 {
    "laid"
        .parse::<MediumId>()
        .expect("laid paper")
        .medium()
        .index()
}

#[test]
fn highlights_and_cast_shadows_are_left_out() {
    for lamps in [ring(4, 20.0), ring(4, 30.0), dome(8), dome(24)] {
        let count = lamps.len();
        let scene = Scene {
            alpha: Some(0.25),
            shadows: true,
            ..Scene::matte(lamps)
        };
        let planes = scene.photographs();
        let error = |response: Response, robustness| {
            error_deg(&scene.solve_of(&planes, response, robustness))
        };
        // Taken for matte paper: nobody has told how glossy it is.
        let paper = || Response::Paper(Paper::new(0.5, index(), 1.0));
        let robust = error(paper(), Robustness::Robust);
        let drop = error(paper(), Robustness::Drop);
        let plain = error(paper(), Robustness::None);
        let lambert = [Robustness::Robust, Robustness::Drop, Robustness::None]
            .map(|robustness| error(Response::Lambert, robustness));
        eprintln!(
            "gloss and shadows, {count} lamps: robust {robust:.3}°, drop {drop:.3}°, plain \
             {plain:.3}°; as a diffuser {lambert:.3?}"
        );
        assert!(robust < GLOSSY_DEG, "{count}: {robust}°");
        // Photographs that are all believed show that there is something to leave out.
        assert!(plain > 1.5 * robust, "{count}: {robust}° {plain}°");
    }
}

/// Neighbours of a lamp.
const NEAREST: usize = 4;

/// Many lamps, low ones among them, on a real face that shines and shades itself.
#[test]
fn a_real_face_under_240_lamps_is_relit() {
    let Some(root) = data(test_name!(), "rti_lion") else {
        return;
    };
    let text = std::fs::read_to_string(root.join("dirs.lp")).expect("text");
    let lamps = lp::read(&text).expect("lamps");
    let mut width = 0;
    let photographs: Vec<[Vec<f32>; 3]> = lamps
        .iter()
        .map(|lamp| {
            let mut planes = [Vec::new(), Vec::new(), Vec::new()];
            maps::for_each_colour_row(&lamp.beside(&root), ColourEncoding::Srgb, |_, row| {
                width = row.len();
                for (c, plane) in planes.iter_mut().enumerate() {
                    plane.extend(row.iter().map(|p| p[c]));
                }
            })
            .expect("a picture");
            planes
        })
        .collect();
    let (mut relit, mut dull, mut won) = (0.0, 0.0, 0);
    let left_out: Vec<usize> = (10..240).step_by(23).collect();
    for &out in &left_out {
        let kept: Vec<usize> = (0..lamps.len()).filter(|i| *i != out).collect();
        let planes: Vec<_> = kept.iter().map(|&i| photographs[i].clone()).collect();
        let solver = Solver {
            rig: Rig {
                gain: Gain::Relative(vec![1.0; kept.len()]),
                ..Rig::far(kept.iter().map(|&i| lamps[i].direction).collect())
            },
            response: Response::Lambert,
            robustness: Robustness::Robust,
        };
        let rows = Rows {
            planes: &planes,
            width,
            top: 0,
        };
        let solved = solver.solve(rows);
        let l = lamps[out].direction;
        let shown = relight(&solved, &solver.rig, rows, l, 1.0, NEAREST);
        let mut near: Vec<usize> = (0..kept.len()).collect();
        near.sort_by(|a, b| {
            let cosine = |i: &usize| lamps[kept[*i]].direction.dot(l);
            cosine(b).total_cmp(&cosine(a))
        });
        let (mut own, mut mean) = (0.0, 0.0);
        for c in 0..3 {
            for (p, shown) in shown[c].iter().enumerate() {
                let truth = photographs[out][c][p];
                let around: f32 = near[..NEAREST].iter().map(|&i| planes[i][c][p]).sum();
                own += f64::from(shown - truth).powi(2);
                mean += f64::from(around / NEAREST as f32 - truth).powi(2);
            }
        }
        relit += own;
        dull += mean;
        won += usize::from(own < mean);
    }
    eprintln!(
        "lion: relit RMS over that of its neighbours' mean {:.3}, better in {won} of {}",
        (relit / dull).sqrt(),
        left_out.len()
    );
    assert!(relit < dull && won > left_out.len() / 2, "{won}");
}

#[test]
fn near_lamps_are_taken_where_they_are() {
    // At 200 mm from a sheet of 96 × 1 mm.
    let places: Vec<DVec3> = ring(6, 45.0).into_iter().map(|l| l * 200.0).collect();
    let middle = DVec2::splat(SIDE as f64 / 2.0);
    let rig = |standing, gain| Rig {
        standing,
        gain,
        mm_per_px: 1.0,
        middle_px: middle,
    };
    let near = rig(Standing::Near(places.clone()), Gain::Relative(vec![1.0; 6]));
    let planes: Vec<[Vec<f32>; 3]> = (0..6)
        .map(|i| {
            let shown = (0..SIDE * SIDE).map(|p| {
                let at = DVec2::new((p % SIDE) as f64 + 0.5, (p / SIDE) as f64 + 0.5);
                // Not by the rig: by the inverse square of the distance.
                let to = places[i] - DVec3::new(at.x - middle.x, middle.y - at.y, 0.0);
                let light = 200.0 * 200.0 / to.length_squared();
                (0.7 * light * normal(at.x, at.y).dot(to.normalize()).max(0.0)) as f32
            });
            let plane: Vec<f32> = shown.collect();
            [plane.clone(), plane.clone(), plane]
        })
        .collect();
    let error = |rig: Rig| {
        let solver = Solver {
            rig,
            response: Response::Lambert,
            robustness: Robustness::None,
        };
        let rows = Rows {
            planes: &planes,
            width: SIDE,
            top: 0,
        };
        let solved = solver.solve(rows);
        // Rows in bands give what all at once do.
        let half = SIDE / 2 * SIDE;
        let below: Vec<[Vec<f32>; 3]> = planes
            .iter()
            .map(|planes| planes.each_ref().map(|plane| plane[half..].to_vec()))
            .collect();
        let band = solver.solve(Rows {
            planes: &below,
            width: SIDE,
            top: SIDE / 2,
        });
        assert!(band.normal == solved.normal[half..]);
        error_deg(&solved)
    };
    let far = rig(
        Standing::Far(places.iter().map(|p| p.normalize()).collect()),
        Gain::Relative(vec![1.0; 6]),
    );
    let (near, far) = (error(near), error(far));
    eprintln!("near lamps {near:.4}°, taken for far ones {far:.3}°");
    assert!(near < 0.01 && far > MATTE_DEG, "{near} {far}");
}

#[test]
fn nothing_is_found_in_the_dark_and_nothing_breaks() {
    for value in [0.0, f32::MIN_POSITIVE, 1e30] {
        for lamps in [ring(3, 45.0), ring(4, 45.0), dome(8)] {
            let planes = vec![[0, 1, 2].map(|_| vec![value; 70]); lamps.len()];
            for response in [Response::Lambert, Response::laid_paper()] {
                for robustness in [Robustness::None, Robustness::Drop, Robustness::Robust] {
                    let solver = Solver {
                        rig: Rig::far(lamps.clone()),
                        response: response.clone(),
                        robustness,
                    };
                    let solved = solver.solve(Rows {
                        planes: &planes,
                        width: 35,
                        top: 0,
                    });
                    let sound = |n: &[f32; 3]| n.iter().all(|v| v.is_finite()) && n[2] >= 0.0;
                    assert!(solved.normal.iter().all(sound), "{value}");
                    assert!(solved.albedo.iter().flatten().all(|v| !v.is_nan()));
                }
            }
        }
    }
    // One photograph too few: an empty answer, and no panic.
    let solver = Solver {
        rig: Rig::far(ring(4, 45.0)),
        response: Response::Lambert,
        robustness: Robustness::Robust,
    };
    let planes = vec![[0, 1, 2].map(|_| vec![0.5; 4]); 3];
    let solved = solver.solve(Rows {
        planes: &planes,
        width: 2,
        top: 0,
    });
    assert_eq!(solved.normal, [[0.0; 3]; 4]);
}

#[test]
fn dark_places_are_solved_alike_wherever_they_lie_in_a_row() {
    const WIDTH: usize = 40;
    let lamps = ring(4, 45.0);
    let inked = Response::Inked(Box::new(Inked {
        paper: Paper::new(0.5, 1.5, 1.0),
        dark: Paper::new(0.3, 1.5, 1.0),
        below: 0.2,
    }));
    let solver = Solver {
        rig: Rig::far(lamps.clone()),
        response: inked,
        robustness: Robustness::None,
    };
    // Facing a little aside, and gleaming under one lamp.
    let shown = |lamp: usize, is_dark: bool| match is_dark {
        true => [0.065, 0.05, 0.042, 0.051][lamp],
        false => [0.62, 0.55, 0.5, 0.56][lamp],
    };
    let solved = |dark: &[usize]| {
        let planes: Vec<[Vec<f32>; 3]> = (0..lamps.len())
            .map(|lamp| {
                let row = (0..WIDTH).map(|x| shown(lamp, dark.contains(&x)));
                let row: Vec<f32> = row.collect();
                [0, 1, 2].map(|_| row.clone())
            })
            .collect();
        solver.solve(Rows {
            planes: &planes,
            width: WIDTH,
            top: 0,
        })
    };
    // Normal, albedo and residual.
    let of = |solved: &Solved, x: usize| -> Vec<f32> {
        let albedo = solved.albedo.each_ref().map(|plane| plane[x]);
        let normal = solved.normal[x];
        normal
            .into_iter()
            .chain(albedo)
            .chain([solved.residual[x]])
            .collect()
    };
    let alike = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 2e-3);
    let all: Vec<usize> = (0..WIDTH).collect();
    let light = of(&solved(&[]), 5);
    let expected = of(&solved(&all), 5);
    // As paper the dark ones would leave more over.
    let paper = Solver {
        response: Response::Paper(Paper::new(0.5, 1.5, 1.0)),
        ..solver.clone()
    };
    let planes: Vec<[Vec<f32>; 3]> = (0..lamps.len())
        .map(|lamp| [0, 1, 2].map(|_| vec![shown(lamp, true)]))
        .collect();
    let rows = Rows {
        planes: &planes,
        width: 1,
        top: 0,
    };
    let as_paper = of(&paper.solve(rows), 0);
    assert!(
        !alike(&expected[6..], &as_paper[6..]),
        "{expected:?} {as_paper:?}"
    );
    // As many as are worked on together lie between the first two.
    for dark in [vec![0, 31], vec![3, 4, 34], vec![0, 39], vec![7]] {
        let some = solved(&dark);
        for x in 0..WIDTH {
            let known = if dark.contains(&x) { &expected } else { &light };
            let found = of(&some, x);
            assert!(alike(&found, known), "{dark:?} {x}: {found:?} {known:?}");
        }
    }
}
