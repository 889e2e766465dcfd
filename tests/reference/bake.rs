//! Walks the crops that judge the tiers, and writes them down.

use std::{fmt::Write as _, fs};

use rayon::prelude::*;
use recto::{
    manifest::Exhibit,
    reference::picture::{Crop, Exposure, Mode, Studio},
};

use crate::crop::{self, CROPS, EDGE, HEADER, LIGHTS, Truth, judged};

/// Paths that undo the photograph at each roughness: its albedo within .2%, ΔE00 .05.
const CAPTURE_PATHS: u64 = 1 << 18;

/// Paths of each pixel in a round, and the share of them that a lateral picture gets.
const SAMPLES: u64 = 2048;
const LATERAL_SHARE: u64 = 4;

/// `RECTO_ROUNDS` rounds, each with a seed of its own; the fixture is written after each, so that
/// the test may be stopped at any time. `RECTO_CROP` names the one crop to walk, and the others stay
/// as they are; `RECTO_LIGHT` likewise.
#[test]
#[ignore = "writes the fixture: an hour of random walks"]
fn bake() {
    let rounds: u64 =
        std::env::var("RECTO_ROUNDS").map_or(16, |rounds| rounds.parse().expect("a number"));
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/crops.csv");
    let mut studios: Vec<Studio> = LIGHTS
        .iter()
        .map(|(_, lamp)| {
            let (exhibit, _) = Exhibit::read(&crop::folder()).unwrap_or_else(|f| panic!("{f}"));
            let (exhibit, scene) = crop::scene(exhibit, CROPS[0].1, lamp);
            Studio::new(&exhibit, &scene, CAPTURE_PATHS, 1).unwrap_or_else(|e| panic!("{e}"))
        })
        .collect();
    eprintln!("prepared");
    let only = std::env::var("RECTO_CROP").ok();
    let only_light = std::env::var("RECTO_LIGHT").ok();
    let is_wanted = |light: &str, crop: &str| {
        only.as_deref().is_none_or(|only| only == crop)
            && only_light.as_deref().is_none_or(|only| only == light)
    };
    let mut sums: Vec<Truth> = Vec::new();
    if only.is_some() || only_light.is_some() {
        let text = fs::read_to_string(path).expect("the fixture");
        sums = crop::read(&text);
        sums.retain(|truth| !is_wanted(&truth.light, &truth.crop));
    }
    for round in 0..rounds {
        for ((light, lamp), studio) in LIGHTS.iter().zip(&mut studios) {
            let wanted = CROPS.into_iter().filter(|(crop, _)| is_wanted(light, crop));
            for (crop, middle) in wanted {
                let (exhibit, _) = Exhibit::read(&crop::folder()).unwrap_or_else(|f| panic!("{f}"));
                let (_, scene) = crop::scene(exhibit, middle, lamp);
                studio.look(&scene.camera);
                for mode in Mode::ALL {
                    let samples = match mode {
                        Mode::Local => SAMPLES,
                        Mode::Lateral => SAMPLES / LATERAL_SHARE,
                    };
                    let pixels = walk(studio, samples, 100 + round, mode);
                    let before = sums.iter_mut().find(|truth| truth.is(light, crop, mode));
                    match before {
                        Some(truth) => add(truth, &pixels, round as f64),
                        None => sums.push(Truth {
                            light: (*light).to_owned(),
                            crop: crop.to_owned(),
                            mode: mode.name().to_owned(),
                            pixels,
                        }),
                    }
                }
            }
        }
        // In one order, whatever was walked last.
        let order = |truth: &Truth| {
            let light = LIGHTS.iter().position(|(light, _)| *light == truth.light);
            let crop = CROPS.iter().position(|(crop, _)| *crop == truth.crop);
            let mode = Mode::ALL.iter().position(|mode| mode.name() == truth.mode);
            (light, crop, mode)
        };
        sums.sort_by_key(order);
        fs::write(path, text_of(&sums)).expect("the fixture is written");
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

fn text_of(truths: &[Truth]) -> String {
    let mut text = format!("{HEADER}\n");
    for truth in truths {
        for [mean, variance] in &truth.pixels {
            let Truth {
                light, crop, mode, ..
            } = truth;
            write!(text, "{light},{crop},{mode}").expect("a String");
            for value in mean {
                write!(text, ",{value:.5}").expect("a String");
            }
            for value in variance {
                write!(text, ",{value:.1e}").expect("a String");
            }
            text.push('\n');
        }
    }
    text
}
