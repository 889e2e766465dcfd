//! Facets of metal and chalk: what is evaluated is what is walked.

use std::f64::consts::PI;

use glam::DVec3;
use recto::{
    optics::{
        fresnel::fresnel_conductor,
        microfacet::{d_ggx, v_smith},
    },
    reference::{
        Conductor, Estimate,
        rng::{stream, uniform},
    },
};

use crate::statistic::{Z_MAX, exact, mean_of, z};

const SILVER: ([f64; 3], [f64; 3]) = ([0.052, 0.060, 0.040], [4.41, 3.60, 2.65]);
const HEMATITE: ([f64; 3], [f64; 3]) = ([3.07, 3.32, 3.18], [0.06, 0.50, 1.02]);

fn arriving(mu: f64) -> DVec3 {
    DVec3::new(-(1.0 - mu * mu).sqrt(), 0.0, -mu)
}

fn albedo(facets: &Conductor, mu: f64, channel: usize) -> Estimate {
    let mut rng = stream(50, 0);
    mean_of(40_000, || {
        let left = facets.scatter(arriving(mu), &mut rng);
        left.map_or(0.0, |(_, weight)| weight[channel])
    })
}

#[test]
fn what_is_evaluated_is_what_is_walked() {
    for (alpha, (n, k)) in [(0.3, SILVER), (0.8, HEMATITE)] {
        let facets = Conductor::new(alpha, n, k);
        for mu in [1.0, 0.5, 0.15] {
            let walked = albedo(&facets, mu, 1);
            let mut rng = stream(51, 0);
            // Over the hemisphere, evenly.
            let evaluated = mean_of(60_000, || {
                let z = 1.0 - uniform(&mut rng);
                let (sin, phi) = ((1.0 - z * z).sqrt(), 2.0 * PI * uniform(&mut rng));
                let out = DVec3::new(sin * phi.cos(), sin * phi.sin(), z);
                2.0 * PI * facets.evaluate(arriving(mu), out, &mut rng)[1]
            });
            let off = z(&walked, &evaluated);
            assert!(off.abs() < Z_MAX, "{alpha} {mu}: {walked:?} {evaluated:?}");
            // The other channel is another colour, which must be seen.
            if (n[0] - n[1]).abs() > 0.1 {
                let red = albedo(&facets, mu, 0);
                assert!(z(&red, &evaluated).abs() > Z_MAX, "{alpha} {mu}");
            }
        }
    }
}

#[test]
fn what_mirrors_all_loses_nothing() {
    let mirror = Conductor::new(0.9, [1e-9; 3], [1e6; 3]);
    for mu in [1.0, 0.3, 0.02] {
        let all = albedo(&mirror, mu, 0);
        assert!((all.mean - 1.0).abs() < 1e-4, "{mu}: {all:?}");
    }
}

#[test]
fn smooth_facets_bounce_once_by_the_closed_form() {
    // At α = .05 and away from grazing a second bounce is below a thousandth.
    let facets = Conductor::new(0.05, SILVER.0, SILVER.1);
    let (mu_i, mu_o) = (0.8, 0.81);
    let out = DVec3::new(-(1.0f64 - mu_o * mu_o).sqrt(), 0.0, mu_o);
    let l = -arriving(mu_i);
    let h = (l + out).normalize();
    let lobe = d_ggx(h.x * h.x + h.y * h.y, 0.05) * v_smith(mu_i, mu_o, 0.05);
    let expected = lobe * fresnel_conductor(l.dot(h), SILVER.0[1], SILVER.1[1]) * mu_o;
    let mut rng = stream(52, 0);
    let found = mean_of(20_000, || facets.evaluate(arriving(mu_i), out, &mut rng)[1]);
    let room = exact(expected * (1.0 + 1e-3));
    assert!((found.mean / expected - 1.0).abs() < 2e-3 || z(&found, &room).abs() < Z_MAX);
    assert!(
        (found.mean / (1.02 * expected) - 1.0).abs() > 1e-2,
        "{found:?}"
    );
}
