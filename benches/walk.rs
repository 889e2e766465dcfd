//! Paths per second of the judge's walk beside Mitsuba's `volpath`, through one slab on the same
//! cores, turn by turn in one run: `cargo bench --bench walk`. Without Mitsuba (`pip install
//! mitsuba`) it measures the walk alone and says so.

use std::{
    path::Path,
    process::Command,
    time::{Duration, Instant},
};

use recto::reference::{Absorption, Layers, Phase, reflectance_transmittance};

/// Turns that each of the two takes.
const ROUNDS: u64 = 5;
const PATHS: u64 = 200_000;

/// OPTICS' slab between smooth interfaces, as in `walk.py`.
const SLAB: Layers = Layers {
    n: 1.5,
    alpha: [0.0; 2],
    sigma_s: 81.38,
    phase: Phase::single(1.0 / 3.0),
    thickness_mm: 0.262,
};
const GREY: Absorption = Absorption {
    sigma_a: 0.05,
    ..Absorption::NONE
};

/// Paths per second, and R + T.
fn ours(round: u64) -> (f64, f64) {
    let start = Instant::now();
    let flux = reflectance_transmittance(&SLAB, &[GREY], 1.0, PATHS, round)[0];
    let rate = PATHS as f64 / start.elapsed().max(Duration::from_nanos(1)).as_secs_f64();
    (rate, flux.reflected.mean + flux.transmitted.mean)
}

/// The same by Mitsuba; `None` where it does not run.
fn theirs() -> Option<(f64, f64)> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/walk.py");
    let output = Command::new("python3").arg(script).output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let line = text.lines().last()?;
    let words: Vec<&str> = line.split_whitespace().collect();
    let [_, _, paths, seconds, radiance] = words.as_slice() else {
        return None;
    };
    let paths: f64 = paths.parse().ok()?;
    let seconds: f64 = seconds.parse().ok()?;
    Some((paths / seconds, radiance.parse().ok()?))
}

fn main() {
    ours(0);
    let (mut walk, mut volpath) = (Vec::new(), Vec::new());
    for round in 1..=ROUNDS {
        let (rate, sum) = ours(round);
        print!("walk {rate:.0} paths/s, R + T {sum:.4}");
        walk.push(rate);
        match theirs() {
            Some((rate, sum)) => {
                println!("; volpath {rate:.0} paths/s, R + T {sum:.4}");
                volpath.push(rate);
            }
            None => println!("; no Mitsuba here: pip install mitsuba"),
        }
    }
    let median = |rates: &mut Vec<f64>| {
        rates.sort_by(f64::total_cmp);
        rates.get(rates.len() / 2).copied()
    };
    if let (Some(walk), Some(volpath)) = (median(&mut walk), median(&mut volpath)) {
        println!(
            "median of {ROUNDS} turns: walk {walk:.0}, volpath {volpath:.0} paths/s: {:.2} times \
             Mitsuba's",
            walk / volpath
        );
    }
}
