//! χ² of every sampler against its density; a wrong density must fail.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use recto::reference::{
    Phase,
    interface::Interface,
    rng::{exponential, stream, turn, uniform},
};

use crate::statistic::{chi_square, sidak};

const DRAWS: u64 = 200_000;
const CELLS: usize = 64;

/// Counts of draws in [0, 1), in equal cells.
fn counts(mut draw: impl FnMut() -> f64) -> Vec<f64> {
    let mut counts = vec![0.0; CELLS];
    for _ in 0..DRAWS {
        let cell = (draw() * CELLS as f64) as usize;
        counts[cell.min(CELLS - 1)] += 1.0;
    }
    counts
}

fn even() -> Vec<f64> {
    vec![DRAWS as f64 / CELLS as f64; CELLS]
}

#[test]
fn uniform_exponential_and_turn() {
    let mut rng = stream(1, 0);
    let limit = sidak(4);
    let p = [
        chi_square(&counts(|| uniform(&mut rng)), &even()),
        // 1 − e^(−x) is uniform.
        chi_square(&counts(|| -(-exponential(&mut rng)).exp_m1()), &even()),
        chi_square(
            &counts(|| {
                let (cos, sin, _) = turn(&mut rng);
                sin.atan2(cos).rem_euclid(TAU) / TAU
            }),
            &even(),
        ),
        chi_square(&counts(|| turn(&mut rng).2), &even()),
    ];
    assert!(p.iter().all(|&p| p >= limit), "{p:?}");
    // A mean of 1.03 instead of 1.
    let wrong = chi_square(
        &counts(|| -(-1.03 * exponential(&mut rng)).exp_m1()),
        &even(),
    );
    assert!(wrong < limit, "{wrong}");
}

/// Expected counts in cells of (1 + cos)/2, from [`Phase::value`] on a fine grid.
fn expected_cosines(phase: &Phase) -> Vec<f64> {
    const FINE: usize = 4000;
    (0..CELLS)
        .map(|cell| {
            let mean = (0..FINE)
                .map(|i| {
                    let share = (cell as f64 + (i as f64 + 0.5) / FINE as f64) / CELLS as f64;
                    phase.value(2.0 * share - 1.0)
                })
                .sum::<f64>()
                / FINE as f64;
            // dω = 2π dcos, dcos = 2/CELLS.
            mean * 2.0 * PI * 2.0 / CELLS as f64 * DRAWS as f64
        })
        .collect()
}

#[test]
fn phases() {
    let two = |w_f, g_f, g_b| Phase { w_f, g_f, g_b };
    let phases = [
        Phase::ISOTROPIC,
        Phase::single(1e-6),
        Phase::single(1.0 / 3.0),
        Phase::single(-0.8),
        Phase::single(0.99),
        two(0.85, 0.5, -0.61),
        two(0.3, 0.9, 0.0),
    ];
    let limit = sidak(2 * phases.len());
    let mut rng = stream(2, 0);
    for phase in phases {
        let w = DVec3::new(0.48, -0.6, 0.64);
        let (x, y) = w.any_orthonormal_pair();
        let expected = expected_cosines(&phase);
        let total: f64 = expected.iter().sum();
        assert!(
            (total / DRAWS as f64 - 1.0).abs() < 1e-3,
            "{phase:?} {total}"
        );
        let cosines = counts(|| 0.5 + 0.5 * w.dot(phase.sample(w, &mut rng)));
        let p = chi_square(&cosines, &expected);
        assert!(p >= limit, "{phase:?}: {p}");
        let azimuths = counts(|| {
            let out = phase.sample(w, &mut rng);
            out.dot(y).atan2(out.dot(x)).rem_euclid(TAU) / TAU
        });
        let p = chi_square(&azimuths, &even());
        assert!(p >= limit, "{phase:?}, azimuth: {p}");
        // The same lobe a little wider is found out.
        let wrong = two(phase.w_f, phase.g_f - 0.02, phase.g_b - 0.02);
        let p = chi_square(&cosines, &expected_cosines(&wrong));
        assert!(p < limit, "{phase:?}: the wrong density passes, {p}");
    }
}

/// Expected counts of visible facets in 8 × 8 cells of (s, φ): with tan²θ = α² (1 − s²)/s²,
/// D cosθ dω is uniform in s² and φ.
fn expected_facets(interface: &Interface, w: DVec3) -> Vec<f64> {
    const FINE: usize = 200;
    let seen = interface.projected(w);
    let mut expected = vec![0.0; 64];
    for i in 0..8 * FINE {
        let s = (i as f64 + 0.5) / (8 * FINE) as f64;
        let cos = 1.0 / (1.0 + interface.alpha.powi(2) * (1.0 - s * s) / (s * s)).sqrt();
        let sin = (1.0 - cos * cos).sqrt();
        for j in 0..8 * FINE {
            let phi = TAU * (j as f64 + 0.5) / (8 * FINE) as f64;
            let h = DVec3::new(sin * phi.cos(), sin * phi.sin(), cos);
            expected[i / FINE * 8 + j / FINE] += 2.0 * s * w.dot(h).max(0.0) / (cos * seen);
        }
    }
    let points = (64 * FINE * FINE) as f64;
    expected.iter().map(|e| e * DRAWS as f64 / points).collect()
}

#[test]
fn visible_facets_from_above_and_below() {
    let mut rng = stream(3, 0);
    let cases = [
        (1e-3, 0.7),
        (0.1, 1.0),
        (0.4, 0.05),
        (0.8, 0.5),
        (0.8, -0.3),
        (0.3, -0.05),
    ];
    let limit = sidak(cases.len());
    for (alpha, mu) in cases {
        let interface = Interface { n: 1.5, alpha };
        let w = DVec3::new((1.0f64 - mu * mu).sqrt(), 0.0, mu);
        let mut observed = vec![0.0; 64];
        for _ in 0..DRAWS {
            let h = interface.visible_facet(w, &mut rng);
            let tan2 = (h.x * h.x + h.y * h.y) / (h.z * h.z);
            let s = alpha / (alpha * alpha + tan2).sqrt();
            let phi = h.y.atan2(h.x).rem_euclid(TAU) / TAU;
            let row = ((s * 8.0) as usize).min(7);
            observed[row * 8 + ((phi * 8.0) as usize).min(7)] += 1.0;
        }
        let expected = expected_facets(&interface, w);
        let total: f64 = expected.iter().sum();
        assert!(
            (total / DRAWS as f64 - 1.0).abs() < 2e-3,
            "{alpha} {mu} {total}"
        );
        let p = chi_square(&observed, &expected);
        assert!(p >= limit, "alpha {alpha} mu {mu}: {p}");
        // Facets as seen from elsewhere are found out; near-mirrors look alike from everywhere.
        let tilted = DVec3::new((1.0 - (mu - 0.1f64).powi(2)).sqrt(), 0.0, mu - 0.1);
        let p = chi_square(&observed, &expected_facets(&interface, tilted));
        assert!(p < limit || alpha < 0.05, "alpha {alpha} mu {mu}: {p}");
    }
}
