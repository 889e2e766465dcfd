//! The baselines of the ladder: closed forms of their lobes, and what they are examples of.

use glam::DVec3;
use recto::optics::baselines::*;

use super::{EXACT, MITSUBA, RECIPROCITY, Surface, at_cosine, facing, over_hemisphere};
use std::f64::consts::PI;

/// Midpoints over a lobe, or the polynomial that normalises the Gaussian distribution (3e-4).
const NORMALISED: f64 = 1e-3;
/// From a matte surface to one whose lobe a grid still resolves.
const ALPHAS: [f64; 5] = [0.02, 0.1, 0.3, 0.6, 1.0];

/// A lobe of strength 1 without a diffuser.
fn lobe_only(alpha: f64) -> Surface {
    Surface {
        f_normal: 1.0,
        ..Surface::new(DVec3::ZERO, alpha, 1.5, 1.0)
    }
}

/// ∫ value(θ) cosθ dω over the hemisphere, for a lobe of width `alpha` about the normal.
fn around_normal(alpha: f64, value: impl Fn(f64) -> f64) -> f64 {
    const STEPS: u32 = 20_000;
    // θ = (π/2)·u^k gathers the steps in a narrow lobe.
    let k = 1.0 - alpha.log10() * 2.0;
    let sum: f64 = (0..STEPS)
        .map(|i| (f64::from(i) + 0.5) / f64::from(STEPS))
        .map(|u| {
            let theta = PI / 2.0 * u.powf(k);
            value(theta) * (2.0 * theta).sin() * PI / 2.0 * k * u.powf(k - 1.0)
        })
        .sum();
    sum * PI / f64::from(STEPS)
}

#[test]
fn facets_project_to_the_surface() {
    for alpha in ALPHAS {
        let sin2 = |theta: f64| theta.sin().powi(2);
        for (name, projected) in [
            ("gauss", around_normal(alpha, |t| d_gauss(sin2(t), alpha))),
            (
                "blinn",
                around_normal(alpha, |t| d_blinn(sin2(t), exponent_blinn(alpha))),
            ),
            (
                "beckmann",
                around_normal(alpha, |t| d_beckmann(sin2(t), alpha)),
            ),
        ] {
            let error = (projected - 1.0).abs();
            assert!(error < NORMALISED, "{name}, α {alpha}: {projected}");
        }
    }
}

/// The directional albedo towards the eye, of light from straight above.
fn from_above(alpha: f64, brdf: impl Fn(DVec3, DVec3) -> f64) -> f64 {
    around_normal(alpha, |theta| brdf(DVec3::Z, at_cosine(theta.cos(), 0.3)))
}

type Brdf = fn(&Surface, DVec3, DVec3) -> DVec3;

fn off(l: DVec3, v: DVec3) -> f64 {
    off_mirror(DVec3::Z, l, v)
}

/// Those that are BRDFs.
const RECIPROCAL: [(&str, Brdf); 7] = [
    ("phong", |s, l, v| brdf_phong(s, off(l, v))),
    ("blinn-phong", |s, l, v| {
        brdf_blinn_phong(s, &facing(DVec3::Z, l, v))
    }),
    ("cook-torrance-gauss", |s, l, v| {
        brdf_cook_torrance_gauss(s, &facing(DVec3::Z, l, v))
    }),
    ("cook-torrance-blinn", |s, l, v| {
        brdf_cook_torrance_blinn(s, &facing(DVec3::Z, l, v))
    }),
    ("cook-torrance", |s, l, v| {
        brdf_cook_torrance(s, &facing(DVec3::Z, l, v))
    }),
    ("oren-nayar", |s, l, v| {
        brdf_oren_nayar(s, &facing(DVec3::Z, l, v))
    }),
    ("isle", |s, l, v| brdf_isle(s, &facing(DVec3::Z, l, v))),
];
/// Those that are examples of why.
const PLAIN: [(&str, Brdf); 2] = [
    ("phong-plain", |s, l, v| {
        brdf_phong_plain(s, &facing(DVec3::Z, l, v), off(l, v))
    }),
    ("blinn-phong-plain", |s, l, v| {
        brdf_blinn_phong_plain(s, &facing(DVec3::Z, l, v))
    }),
];

#[test]
fn normalised_lobes_reflect_their_strength_from_above() {
    for alpha in ALPHAS {
        let s = lobe_only(alpha);
        for (name, brdf) in &RECIPROCAL[..2] {
            let albedo = from_above(alpha, |l, v| brdf(&s, l, v).x);
            assert!(
                (albedo - 1.0).abs() < NORMALISED,
                "{name}, α {alpha}: {albedo}"
            );
        }
    }
}

#[test]
fn facets_of_a_narrow_lobe_reflect_like_a_mirror() {
    // With Cook and Torrance's own 1/π in place of 1/4 it would be 4/π.
    let s = lobe_only(0.02);
    for (name, brdf) in &RECIPROCAL[2..5] {
        let albedo = from_above(s.alpha, |l, v| brdf(&s, l, v).x);
        assert!((albedo - 1.0).abs() < 2.0 * NORMALISED, "{name}: {albedo}");
    }
}

/// The directional albedo of light at `mu_i`, on a grid of the whole hemisphere.
fn albedo(mu_i: f64, brdf: impl Fn(DVec3, DVec3) -> f64) -> f64 {
    const AZIMUTHS: u32 = 64;
    let l = at_cosine(mu_i, 0.0);
    let azimuths = (0..AZIMUTHS).map(|j| 2.0 * PI * (f64::from(j) + 0.5) / f64::from(AZIMUTHS));
    let sum: f64 = azimuths
        .map(|phi| over_hemisphere(|mu_o| brdf(l, at_cosine(mu_o, phi))))
        .sum();
    sum / f64::from(AZIMUTHS)
}

#[test]
fn plain_highlights_give_more_light_than_they_get() {
    // A paper's own highlight, 4% strong, at 89.7°.
    let s = Surface::new(DVec3::ZERO, 0.6, 1.5, 1.0);
    for (name, brdf) in PLAIN {
        let lobe = albedo(0.005, |l, v| brdf(&s, l, v).x);
        assert!(lobe > 1.0, "{name}: {lobe}");
        // And no angle bounds it: half the cosine, twice the light.
        let lower = albedo(0.0025, |l, v| brdf(&s, l, v).x);
        assert!(lower > 1.5 * lobe, "{name}: {lower} after {lobe}");
    }
}

#[test]
fn light_may_go_either_way_but_not_with_plain_highlights() {
    let mut worst = 0.0f64;
    for alpha in [1e-4, 1e-2, 0.1, 0.5, 1.0] {
        let s = Surface::new(DVec3::new(0.9, 0.5, 0.1), alpha, 1.5, 0.8);
        for mu_i in [1e-4, 0.01, 0.3, 0.7, 1.0] {
            for mu_o in [1e-4, 0.02, 0.31, 0.9] {
                for azimuth in [0.0, 0.5, 2.0, PI] {
                    let (l, v) = (at_cosine(mu_i, 0.0), at_cosine(mu_o, azimuth));
                    for (_, brdf) in RECIPROCAL {
                        let (f, f_back) = (brdf(&s, l, v), brdf(&s, v, l));
                        worst = worst.max(((f - f_back) / f).abs().max_element());
                    }
                }
            }
        }
    }
    assert!(worst < RECIPROCITY, "{worst}");
    let s = lobe_only(0.5);
    let (l, v) = (at_cosine(0.9, 0.0), at_cosine(0.45, PI));
    for (name, brdf) in PLAIN {
        // The quotient of the cosines.
        let quotient = brdf(&s, v, l).x / brdf(&s, l, v).x;
        assert!((quotient - 2.0).abs() < RECIPROCITY, "{name}: {quotient}");
    }
}

#[test]
fn extremes_are_finite_and_not_negative() {
    for alpha in [1e-4, 1e-3, 0.1, 0.5, 0.999_999, 1.0] {
        let s = Surface::new(DVec3::new(1.0, 0.5, 0.0), alpha, 3.0, 1.0);
        for mu_i in [0.0, 1e-4, 0.3, 1.0] {
            for mu_o in [0.0, 1e-4, 0.3, 1.0] {
                for azimuth in [0.0, 1.0, PI] {
                    let (l, v) = (at_cosine(mu_i, 0.0), at_cosine(mu_o, azimuth));
                    for (name, brdf) in RECIPROCAL.into_iter().chain(PLAIN) {
                        let f = brdf(&s, l, v);
                        let sound = f.is_finite() && f.min_element() >= 0.0;
                        assert!(sound, "{name}, α {alpha}, {mu_i} {mu_o} {azimuth}: {f}");
                    }
                }
            }
        }
    }
}

#[test]
fn smooth_facets_of_a_diffuser_are_lambert() {
    let s = Surface {
        alpha: 0.0,
        ..Surface::new(DVec3::new(0.9, 0.5, 0.1), 1.0, 1.5, 1.0)
    };
    for (mu_i, mu_o) in [(1.0, 0.2), (0.3, 0.3)] {
        let g = facing(DVec3::Z, at_cosine(mu_i, 0.0), at_cosine(mu_o, 0.4));
        assert_eq!(brdf_oren_nayar(&s, &g), s.albedo / PI);
    }
    // Rough ones shine back to where the light came from.
    let rough = Surface { alpha: 0.8, ..s };
    let (l, across) = (at_cosine(0.4, 0.0), at_cosine(0.4, PI));
    let back = brdf_oren_nayar(&rough, &facing(DVec3::Z, l, l));
    assert!(back.x > 1.3 * brdf_oren_nayar(&rough, &facing(DVec3::Z, l, across)).x);
}

#[test]
fn helpers_meet_their_closed_forms() {
    for theta in [0.0f64, 1e-6, 0.3, 1.0, 1.5] {
        let error = angle_squared(theta.sin().powi(2)) - theta * theta;
        assert!(error.abs() < EXACT, "{theta}: {error}");
    }
    assert!((power_below_one(0.25, 3.0) - 0.421_875).abs() < EXACT);
    assert_eq!(power_below_one(0.0, 2e8), 1.0);
    // Half the angle, a quarter of the exponent: the highlights have one width.
    let (alpha, tilt) = (0.1, 0.02f64);
    let phong = lobe_phong(1.0 - (2.0 * tilt).cos(), exponent_phong(alpha));
    let blinn = power_below_one(tilt.sin().powi(2), 0.5 * exponent_blinn(alpha));
    assert!((phong / blinn - 1.0).abs() < NORMALISED, "{phong} {blinn}");
}

#[test]
fn another_renderer_agrees_about_burley() {
    let mut worst = 0.0f64;
    let mut count = 0;
    let rows = include_str!("../fixtures/oracle.csv").lines();
    for line in rows.filter_map(|line| line.strip_prefix("burley,")) {
        let numbers: Vec<f64> = line.split(',').map(|n| n.parse().expect(line)).collect();
        let [alpha, index, mu_i, mu_o, azimuth, value] = numbers[..] else {
            panic!("{line}");
        };
        let s = Surface::new(DVec3::splat(0.5), alpha, index, 1.0);
        let (l, v) = (at_cosine(mu_i, 0.0), at_cosine(mu_o, azimuth.to_radians()));
        let f = brdf_burley(&s, &facing(DVec3::Z, l, v)).x;
        worst = worst.max((value / f - 1.0).abs());
        count += 1;
    }
    eprintln!("Burley against Mitsuba: {worst:.1e} off");
    assert!(count == 180 && worst < MITSUBA, "{count} {worst}");
}
