//! Slabs between smooth interfaces against Mitsuba 3's volpath (tests/fixtures/slab.py).

use std::{fs, path::Path};

use recto::reference::{Absorption, Estimate, Layers, Phase, reflectance_transmittance};

use crate::statistic::{Z_MAX, p_value, sidak, z};

#[test]
fn slabs_are_mitsuba_s() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/slab.csv");
    let text = fs::read_to_string(&path).expect("the fixture");
    let (mut sum, mut count) = (0.0, 0.0);
    for line in text.lines().skip(1) {
        let row: Vec<f64> = line
            .split(',')
            .map(|value| value.parse().expect("a number"))
            .collect();
        let &[n, sigma_s, sigma_a, g, thickness_mm, mu, r, r_sd, t, t_sd] = row.as_slice() else {
            panic!("{line}: ten columns");
        };
        let layers = Layers {
            n,
            alpha: [0.0; 2],
            sigma_s,
            phase: Phase::single(g),
            thickness_mm,
        };
        let grey = Absorption {
            sigma_a,
            ..Absorption::NONE
        };
        let ours = reflectance_transmittance(&layers, &[grey], mu, 40_000, 40)[0];
        for (ours, mean, deviation) in [(ours.reflected, r, r_sd), (ours.transmitted, t, t_sd)] {
            let theirs = Estimate {
                mean,
                variance: deviation * deviation,
            };
            let z = z(&ours, &theirs);
            assert!(z.abs() < Z_MAX, "{line}: {ours:?}, z = {z}");
            sum += z * z;
            count += 1.0;
        }
    }
    assert!(count >= 36.0, "{count} values");
    // Nor may many small differences add up.
    assert!(
        p_value(sum, count) >= sidak(1),
        "χ² {sum} over {count} values"
    );
}
