//! Measured paper, white of 160 g/m² (RGL's database, Dupuy & Jakob 2018), against the tiers and
//! against Burley's diffuser under GGX (isle).
//!
//! All have the same constants to be fitted: roughness, index, strength of the gloss (study
//! takes gallery's), and an albedo per channel. They are fitted to every other direction of the light and judged by the
//! rest.

use std::sync::Arc;

use glam::DVec3;
use recto::{
    optics::{
        baselines::brdf_isle,
        ink::capture_path,
        refraction::PathTable,
        slab::Slab,
        study::{Study, Ways, brdf_study},
        table::InterfaceTable,
        tier::{Surface, albedo_of, brdf_gallery, facing},
    },
    units::Micrometres,
};

use crate::{
    rgl::{Reading, readings},
    support::data,
};

/// The most that light and eye may be off the normal: OPTICS' table of tiers ends there too.
const MOST_DEGREES: f64 = 75.0;
/// Copier paper of 160 g/m².
const THICKNESS: Micrometres = Micrometres(200.0);
/// Roughness, index (fibres, gum and size: OPTICS, "Constants") and strength of the gloss.
const LOW: [f64; 3] = [0.1, 1.3, 0.0];
const HIGH: [f64; 3] = [1.0, 1.7, 1.0];

/// Evaluates a tier, of these constants and albedo, at all readings.
type Model = fn(&[f64; 3], DVec3, &[Reading]) -> Vec<DVec3>;

fn isle(&[alpha, n, specular]: &[f64; 3], albedo: DVec3, readings: &[Reading]) -> Vec<DVec3> {
    let s = Surface::new(albedo, alpha, n, specular);
    let f = |r: &Reading| brdf_isle(&s, &facing(DVec3::Z, r.l, r.v));
    readings.iter().map(f).collect()
}

fn gallery(&[alpha, n, specular]: &[f64; 3], albedo: DVec3, readings: &[Reading]) -> Vec<DVec3> {
    let s = Surface::new(albedo, alpha, n, specular);
    let table = InterfaceTable::at_roughness(alpha, n, specular);
    let mean = table.mean_at(alpha);
    let f = |r: &Reading| {
        let g = facing(DVec3::Z, r.l, r.v);
        let [at_i, at_o] = [g.mu_i, g.mu_o].map(|mu| table.at(mu, alpha));
        brdf_gallery(&s, &g, &at_i, &at_o, &mean)
    };
    readings.iter().map(f).collect()
}

fn study(&[alpha, n, specular]: &[f64; 3], albedo: DVec3, readings: &[Reading]) -> Vec<DVec3> {
    let s = Surface::new(albedo, alpha, n, specular);
    let table = InterfaceTable::at_roughness(alpha, n, specular);
    let mean = table.mean_at(alpha);
    let paths = Arc::new(PathTable::at_roughness(alpha, n));
    let study = Study::new(&s, &table, paths.clone(), Slab::rag_paper(THICKNESS));
    let paper = albedo_of(&s, &mean);
    let f = |r: &Reading| {
        let g = facing(DVec3::Z, r.l, r.v);
        let [at_i, at_o] = [g.mu_i, g.mu_o].map(|mu| table.at(mu, alpha));
        let (split, bare) = (&study.split, DVec3::ZERO);
        let ways = Ways {
            capture: capture_path(&paths, alpha),
            path_i: paths.at(g.mu_i, alpha),
            path_o: paths.at(g.mu_o, alpha),
        };
        brdf_study(&s, &g, &at_i, &at_o, &mean, split, bare, &ways, paper, 1.0)
    };
    readings.iter().map(f).collect()
}

/// The albedo with the least squares of relative errors: all tiers are linear in it, study nearly.
fn best_albedo(model: Model, constants: &[f64; 3], readings: &[Reading]) -> DVec3 {
    let mut albedo = DVec3::splat(0.8);
    // Once more, as study is not quite linear.
    for _ in 0..2 {
        let step = 0.05;
        let here = model(constants, albedo, readings);
        let more = model(constants, albedo + step, readings);
        let (mut along, mut all) = (DVec3::ZERO, DVec3::ZERO);
        for ((here, more), r) in here.iter().zip(&more).zip(readings) {
            let slope = (more - here) / step / r.f;
            along += slope * (r.f - here) / r.f;
            all += slope * slope;
        }
        // No tier gives back more light than it gets.
        albedo = (albedo + along / all.max(DVec3::splat(1e-12))).clamp(DVec3::ZERO, DVec3::ONE);
    }
    albedo
}

fn relative_rms(found: &[DVec3], readings: &[Reading]) -> f64 {
    let squares = found.iter().zip(readings).map(|(f, r)| {
        let off = (f - r.f) / r.f;
        off.dot(off) / 3.0
    });
    (squares.sum::<f64>() / readings.len() as f64).sqrt()
}

/// Constants and albedo with the least relative RMS: a search in the neighbourhood of the best so
/// far, which is halved where nothing in it is better.
fn fit(model: Model, readings: &[Reading]) -> ([f64; 3], DVec3) {
    let error = |constants: &[f64; 3]| {
        let albedo = best_albedo(model, constants, readings);
        relative_rms(&model(constants, albedo, readings), readings)
    };
    let mut best = [0.4, 1.5, 0.9];
    let mut least = error(&best);
    let mut width = 0.25;
    while width > 1e-2 {
        let mut moved = false;
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let mut next = best;
                let step = side * width * (HIGH[axis] - LOW[axis]);
                next[axis] = (next[axis] + step).clamp(LOW[axis], HIGH[axis]);
                let found = error(&next);
                if found < least {
                    (best, least, moved) = (next, found, true);
                }
            }
        }
        if !moved {
            width *= 0.5;
        }
    }
    (best, best_albedo(model, &best, readings))
}

#[test]
fn measured_paper_is_nearer_to_our_tiers_than_to_burley_under_ggx() {
    let Some(file) = data(crate::test_name!(), "brdf/paper_white_rgb.bsdf") else {
        return;
    };
    let bytes = std::fs::read(file).expect("the measurement");
    let least = MOST_DEGREES.to_radians().cos();
    let all = readings(&bytes).expect("readings");
    let (fitted, judged): (Vec<Reading>, Vec<Reading>) = all
        .into_iter()
        .filter(|r| r.l.z >= least && r.v.z >= least && r.f.min_element() > 0.0)
        .partition(|r| r.light % 2 == 0);
    assert!(fitted.len() > 1000 && judged.len() > 1000);
    // Neighbouring nodes tell little more.
    let some: Vec<Reading> = fitted.iter().step_by(4).copied().collect();
    let judge = |name: &str, model: Model, (constants, albedo): ([f64; 3], DVec3)| {
        let of = |of: &[Reading]| relative_rms(&model(&constants, albedo, of), of);
        let (own, error) = (of(&fitted), of(&judged));
        println!(
            "{name}: {error:.4} ({own:.4} where fitted), α, n, specular {constants:.3?}, albedo {albedo:.3}"
        );
        error
    };
    let isle = judge("isle", isle, fit(isle, &some));
    let (constants, albedo) = fit(gallery, &some);
    let gallery = judge("gallery", gallery, (constants, albedo));
    // Its gloss is gallery's.
    let albedo = best_albedo(study, &constants, &some);
    let study = judge("study", study, (constants, albedo));
    assert!(gallery < isle, "gallery {gallery}, isle {isle}");
    assert!(study < isle, "study {study}, isle {isle}");
}

/// Noise of the measurement, and the step between neighbouring nodes.
const MEASURED: f64 = 0.03;

#[test]
fn the_measurement_is_read_as_a_reciprocal_brdf() {
    let Some(file) = data(crate::test_name!(), "brdf/paper_white_rgb.bsdf") else {
        return;
    };
    let bytes = std::fs::read(file).expect("the measurement");
    let all = readings(&bytes).expect("readings");
    let near = |l: DVec3, v: DVec3| {
        let apart = |r: &&Reading| r.l.distance(l) + r.v.distance(v);
        all.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)))
    };
    let mut lights: Vec<DVec3> = all.iter().map(|r| r.l).collect();
    lights.dedup();
    for l in lights.into_iter().skip(1).filter(|l| l.z > 0.3) {
        let there = near(l, DVec3::Z).expect("a reading");
        let back = near(DVec3::Z, l).expect("a reading");
        let off = (there.f / back.f - 1.0).abs().max_element();
        assert!(off < MEASURED, "{l}: {} {}", there.f, back.f);
        // With the cosine left in it would not be.
        let wrong = (there.f * there.v.z / (back.f * back.v.z) - 1.0).abs();
        assert!(wrong.min_element() > 3.0 * MEASURED, "{l}: {wrong}");
    }
    for end in [0, 11, 100, 4000, bytes.len() - 2000] {
        assert!(readings(&bytes[..end]).is_err(), "{end}");
    }
}
