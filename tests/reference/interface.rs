//! The rough interface: energy, the two ways of asking it, reciprocity, known limits.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use recto::{
    optics::{
        fresnel::fresnel_dielectric,
        microfacet::{d_ggx, v_smith},
    },
    reference::{
        interface::Interface,
        rng::{stream, turn, uniform},
    },
};

use crate::statistic::{Z_MAX, exact, mean_of, p_value, sidak, z};

const N: f64 = 1.5;

fn direction(mu: f64, phi: f64) -> DVec3 {
    let sin = (1.0 - mu * mu).sqrt();
    DVec3::new(sin * phi.cos(), sin * phi.sin(), mu)
}

#[test]
fn every_photon_comes_out() {
    let mut rng = stream(10, 0);
    for alpha in [0.0, 1e-4, 1e-3, 0.1, 0.4, 0.8, 1.0] {
        for mu in [1e-6, 0.05, 0.5, 1.0] {
            for side in [-1.0, 1.0] {
                let interface = Interface { n: N, alpha };
                for _ in 0..500 {
                    let out = interface.scatter(direction(side * mu, 1.0), &mut rng);
                    assert!((out.length() - 1.0).abs() < 1e-12, "{alpha} {mu} {out}");
                    assert!(out.z != 0.0, "{alpha} {mu} {out}");
                }
            }
        }
    }
}

/// Photons in 8 × 8 bins of both hemispheres against the mean of `evaluate` in each bin.
#[test]
fn samples_fall_where_evaluation_says() {
    let cases = [
        (0.8, -0.6),
        (0.8, 0.3),
        (0.4, -0.2),
        (0.4, 0.9),
        (0.2, -0.9),
        (0.2, 0.75),
    ];
    const PHOTONS: u64 = 200_000;
    const EVALUATIONS: u64 = 8_000;
    const SIDE: usize = 64;
    let limit = sidak(cases.len());
    let mut rng = stream(11, 0);
    for (alpha, mu) in cases {
        let interface = Interface { n: N, alpha };
        let w = direction(mu, 0.0);
        let mut counts = vec![0.0; 2 * SIDE];
        for _ in 0..PHOTONS {
            let out = interface.scatter(w, &mut rng);
            let row = ((out.z.abs() * 8.0) as usize).min(7);
            let phi = out.y.atan2(out.x).rem_euclid(TAU) / TAU;
            let column = ((phi * 8.0) as usize).min(7);
            counts[usize::from(out.z < 0.0) * SIDE + row * 8 + column] += 1.0;
        }
        let (mut sum, mut cells, mut wrong) = (0.0, 0.0, 0.0);
        for (cell, &count) in counts.iter().enumerate() {
            let (row, column) = (cell % SIDE / 8, cell % 8);
            let side = if cell < SIDE { 1.0 } else { -1.0 };
            let density = mean_of(EVALUATIONS, || {
                let mu_o = (row as f64 + uniform(&mut rng)) / 8.0;
                let phi = TAU * (column as f64 + uniform(&mut rng)) / 8.0;
                let out = direction(side * mu_o.max(1e-9), phi);
                interface.evaluate(w, out, &mut rng)
            });
            let expected = density.scaled(TAU / 64.0 * PHOTONS as f64);
            // Small cells have no normal distribution.
            if expected.mean < 25.0 {
                continue;
            }
            let variance = expected.variance + expected.mean;
            sum += (count - expected.mean).powi(2) / variance;
            wrong += (count - 1.05 * expected.mean).powi(2) / variance;
            cells += 1.0;
        }
        assert!(cells > 20.0, "alpha {alpha} mu {mu}: {cells} cells");
        let p = p_value(sum, cells);
        assert!(p >= limit, "alpha {alpha} mu {mu}: {p}, {sum} in {cells}");
        assert!(
            p_value(wrong, cells) < limit,
            "5% more passes: {wrong} in {cells}"
        );
    }
}

#[test]
fn evaluation_is_reciprocal() {
    let mut rng = stream(12, 0);
    const DRAWS: u64 = 40_000;
    for alpha in [0.2, 0.5, 1.0] {
        let interface = Interface { n: N, alpha };
        // Directions away from the surface.
        for (a, b) in [
            (direction(0.9, 0.3), direction(0.4, 2.5)),
            (direction(0.7, 0.0), direction(-0.8, 3.5)),
            (direction(-0.9, 0.0), direction(-0.8, 2.0)),
        ] {
            let f = |from: DVec3, to: DVec3, rng: &mut _| {
                let index = if to.z > 0.0 { 1.0 } else { N };
                mean_of(DRAWS, || interface.evaluate(-from, to, rng))
                    .scaled(1.0 / (to.z.abs() * index * index))
            };
            let (there, back) = (f(a, b, &mut rng), f(b, a, &mut rng));
            assert!(there.mean > 0.0);
            assert!(
                z(&there, &back).abs() < Z_MAX,
                "{alpha} {a} {b}: {there:?} {back:?}"
            );
            assert!(there.deviation() < 0.05 * there.mean, "too noisy to tell");
        }
    }
}

#[test]
fn one_bounce_is_the_microfacet_brdf() {
    // At these angles and α = .1 further bounces add less than 1%.
    const FURTHER: f64 = 0.01;
    let mut rng = stream(13, 0);
    let interface = Interface { n: N, alpha: 0.1 };
    let (i, o) = (direction(0.8, 0.0), direction(0.85, PI + 0.1));
    let h = (i + o).normalize();
    let single = d_ggx(h.x * h.x + h.y * h.y, 0.1)
        * v_smith(i.z, o.z, 0.1)
        * fresnel_dielectric(i.dot(h), N)
        * o.z;
    let walked = mean_of(50_000, || interface.evaluate(-i, o, &mut rng));
    let excess = walked.mean / single - 1.0;
    assert!((-1e-3..FURTHER).contains(&excess), "{excess} {walked:?}");
}

#[test]
fn a_smooth_interface_reflects_as_published() {
    // r_e = .0918, r_i = .5963 for n = 1.5 (OPTICS.md, Interface), of diffuse light.
    let mut rng = stream(14, 0);
    let interface = Interface { n: N, alpha: 0.0 };
    for (side, published) in [(-1.0, 0.091_78), (1.0, 0.596_34)] {
        let reflected = mean_of(200_000, || {
            let (cos, sin, u) = turn(&mut rng);
            let r = u.sqrt();
            let w = DVec3::new(r * cos, r * sin, side * (1.0 - u).sqrt());
            f64::from(u8::from(interface.scatter(w, &mut rng).z * side < 0.0))
        });
        assert!(
            z(&reflected, &exact(published)).abs() < Z_MAX,
            "{reflected:?}"
        );
    }
}
