//! Walks the crops that judge the tiers, and writes them down.

use std::fs;

use rayon::prelude::*;
use recto::{
    manifest::Exhibit,
    reference::picture::{Crop, Exposure, Mode, Studio},
};

use crate::crops::{self, CROPS, EDGE, LIGHTS, Truth, judged};

/// Paths that undo the photograph at each roughness: its albedo within .2%, ΔE00 .05.
const CAPTURE_PATHS: u64 = 1 << 18;

/// Paths of each pixel in a round, and the share of them that a lateral picture gets.
const SAMPLES: u64 = 2048;
const LATERAL_SHARE: u64 = 4;

/// `RECTO_ROUNDS` rounds, each with a seed of its own; the fixture is written after each, so that
/// the test may be stopped at any time. `RECTO_CROP` names the one crop to walk, and the others stay
/// as they are.
#[test]
#[ignore = "writes the fixture: an hour of random walks"]
fn bake() {
    let rounds: u64 =
        std::env::var("RECTO_ROUNDS").map_or(16, |rounds| rounds.parse().expect("a number"));
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/crops.csv");
    let mut studios: Vec<Studio> = LIGHTS
        .iter()
        .map(|(_, lamp)| {
            let (exhibit, _) = Exhibit::read(&crops::folder()).unwrap_or_else(|f| panic!("{f}"));
            let (exhibit, scene) = crops::scene(exhibit, CROPS[0].1, lamp);
            Studio::new(&exhibit, &scene, CAPTURE_PATHS, 1).unwrap_or_else(|e| panic!("{e}"))
        })
        .collect();
    eprintln!("prepared");
    let only = std::env::var("RECTO_CROP").ok();
    let is_wanted = |crop: &str| only.as_deref().is_none_or(|only| only == crop);
    let mut sums: Vec<Truth> = Vec::new();
    if only.is_some() {
        let text = fs::read_to_string(path).expect("the fixture");
        sums = crops::read(&text);
    }
    for round in 0..rounds {
        let mut at = 0;
        for ((light, lamp), studio) in LIGHTS.iter().zip(&mut studios) {
            for (crop, middle) in CROPS {
                let (exhibit, _) =
                    Exhibit::read(&crops::folder()).unwrap_or_else(|f| panic!("{f}"));
                let (_, scene) = crops::scene(exhibit, middle, lamp);
                studio.look(&scene.camera);
                for mode in Mode::ALL {
                    if !is_wanted(crop) {
                        at += 1;
                        continue;
                    }
                    let samples = match mode {
                        Mode::Local => SAMPLES,
                        Mode::Lateral => SAMPLES / LATERAL_SHARE,
                    };
                    let pixels = walk(studio, samples, 100 + round, mode);
                    match sums.get_mut(at) {
                        // The first round takes the place of what was there.
                        Some(truth) => add(truth, &pixels, round as f64),
                        None => sums.push(Truth {
                            light: (*light).to_owned(),
                            crop: crop.to_owned(),
                            mode: mode.name().to_owned(),
                            pixels,
                        }),
                    }
                    at += 1;
                }
            }
        }
        fs::write(path, crops::write(&sums)).expect("the fixture is written");
        eprintln!("round {round}");
    }
}

fn walk(studio: &Studio, samples: u64, seed: u64, mode: Mode) -> Vec<[[f64; 3]; 2]> {
    judged()
        .into_par_iter()
        .map(|[x, y]| {
            let exposure = Exposure {
                size: [EDGE; 2],
                crop: Crop {
                    x,
                    y,
                    width: 1,
                    height: 1,
                },
                samples,
                seed,
                mode,
            };
            let plate = studio.take(&exposure, || ());
            [plate.mean[0], plate.variance[0]]
        })
        .collect()
}

/// Takes one more round into the mean of `before` rounds.
fn add(truth: &mut Truth, pixels: &[[[f64; 3]; 2]], before: f64) {
    let all = before + 1.0;
    for (sum, new) in truth.pixels.iter_mut().zip(pixels) {
        for c in 0..3 {
            sum[0][c] += (new[0][c] - sum[0][c]) / all;
            sum[1][c] = (sum[1][c] * before * before + new[1][c]) / (all * all);
        }
    }
}
