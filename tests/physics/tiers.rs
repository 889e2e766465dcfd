//! The tiers in f64 against closed forms, direct integration and another renderer.
//!
//! Physics alone: the mutation run (tests/mutation) builds this file without the engine.

#[path = "baselines.rs"]
mod baselines;

use std::f64::consts::PI;

use glam::DVec3;
use recto::optics::{
    fresnel::fresnel_dielectric,
    microfacet::{d_ggx, directional_albedo, v_smith},
    table::{ALPHA_FIT_MIN, InterfaceTable},
    tier::{Facing, Surface, brdf_draft, brdf_gallery, brdf_lambert, facing},
};

/// OPTICS.md: what the gallery tier may gain or lose of the light that arrives.
const ENERGY: f64 = 5e-3;
/// Exchanging light and eye only exchanges factors: nothing but rounding is left.
const RECIPROCITY: f64 = 1e-6;
/// The interface's own promise for its polynomials (src/optics/table.rs), and the steps of the
/// integral here.
const INTERFACE: f64 = 5e-3;
/// Closed forms without an integral.
pub const EXACT: f64 = 1e-12;

pub fn at_cosine(mu: f64, azimuth: f64) -> DVec3 {
    let (sin, cos) = azimuth.sin_cos();
    DVec3::new(cos, sin, 0.0) * (1.0 - mu * mu).max(0.0).sqrt() + DVec3::Z * mu
}

/// Cosines of 64 directions, evenly spaced in the angle and ending 0.7° above the horizon.
fn furnace_cosines() -> impl Iterator<Item = f64> {
    (0..64).map(|i| ((f64::from(i) + 0.5) / 64.0 * PI / 2.0).cos())
}

/// ∫ lobe(l) μ_i dω over light from facets at `alpha`, for the eye at `mu_o`: midpoints over the
/// distribution's own cumulative, where `lobe` is the BRDF's value over the distribution D.
fn reflected(mu_o: f64, alpha: f64, lobe_over_d: impl Fn(&Facing) -> f64) -> f64 {
    const STEPS: u32 = 100;
    let v = at_cosine(mu_o, 0.0);
    let mut sum = 0.0;
    for i in 0..STEPS {
        // tan²θ = α² u/(1 − u) inverts the cumulative of D cosθ (Walter et al. 2007, eq. 35);
        // 1 − u = w³ gathers the steps in its long tail, which counts at grazing angles.
        let w = (f64::from(i) + 0.5) / f64::from(STEPS);
        let tail = w * w * w;
        let cos_h = (1.0 + alpha * alpha * (1.0 - tail) / tail).sqrt().recip();
        let density = 3.0 * w * w;
        for j in 0..STEPS {
            let h = at_cosine(cos_h, PI * (f64::from(j) + 0.5) / f64::from(STEPS));
            let cos_d = h.dot(v);
            let l = 2.0 * cos_d * h - v;
            if cos_d > 0.0 && l.z > 0.0 {
                let g = facing(DVec3::Z, l, v);
                // dω_l = 4 cos_d dω_h, and dω_h of each step is 1/(D cos_h).
                sum += density * lobe_over_d(&g) * l.z * 4.0 * cos_d / cos_h;
            }
        }
    }
    sum / f64::from(STEPS * STEPS)
}

/// 2π ∫ value(μ) μ dμ by midpoints, closer together towards grazing.
fn over_hemisphere(value: impl Fn(f64) -> f64) -> f64 {
    const STEPS: u32 = 400;
    let step = 1.0 / f64::from(STEPS);
    (0..STEPS)
        .map(|i| (f64::from(i) + 0.5) * step)
        .map(|x| value(x * x) * x * x * 2.0 * x * step)
        .sum::<f64>()
        * 2.0
        * PI
}

/// Directional-hemispherical reflectance of the gallery tier: of its surface, and of diffusers
/// below it that photograph as white, and as whiter than anything can.
fn gallery_albedo(s: &Surface, table: &InterfaceTable, mu_o: f64) -> [f64; 3] {
    let (at_o, mean) = (table.at(mu_o, s.alpha), table.mean_at(s.alpha));
    let lobe = reflected(mu_o, s.alpha, |g| {
        s.specular * v_smith(g.mu_i, g.mu_o, s.alpha) * fresnel_dielectric(g.cos_d, s.eta)
    });
    // The rest does not depend on the azimuth: the BRDF without its lobe.
    let rest = |albedo: f64| {
        let matt = Surface {
            albedo: DVec3::splat(albedo),
            specular: 0.0,
            ..*s
        };
        over_hemisphere(|mu_i| {
            let g = Facing {
                mu_i,
                mu_o,
                cos_d: 1.0,
                sin2_h: 0.0,
            };
            brdf_gallery(&matt, &g, &table.at(mu_i, s.alpha), &at_o, &mean).x
        })
    };
    let black = rest(0.0);
    [lobe + black, rest(1.0) - black, rest(2.0) - black]
}

/// Smoother than the fit is made for, the grazing cusp of the transmittance is rounded off.
const ENERGY_NEAR_MIRROR: f64 = 1.5e-2;

#[test]
fn the_gallery_tier_gives_back_all_light_and_no_more() {
    // Errors of [α from ALPHA_FIT_MIN on, smoother ones]; the most that albedo 1 gives.
    let (mut worst, mut most) = ([0.0f64; 2], 0.0f64);
    for index in [1.3, 1.5, 1.557] {
        for specular in [0.0, 0.3, 1.0] {
            let fitted = InterfaceTable::new(index, specular);
            for alpha in [0.05, ALPHA_FIT_MIN, 0.2, 0.4, 0.7, 1.0] {
                let mirror = alpha < ALPHA_FIT_MIN;
                let own = InterfaceTable::at_roughness(alpha, index, specular);
                // A map of roughness reads the fit over all of them.
                let tables = if mirror {
                    vec![own]
                } else {
                    vec![own, fitted.clone()]
                };
                for table in tables {
                    let s = Surface::new(DVec3::ONE, alpha, index, specular);
                    for mu_o in furnace_cosines() {
                        let [surface, white, whitest] = gallery_albedo(&s, &table, mu_o);
                        let error = (surface + whitest - 1.0).abs();
                        let worst = &mut worst[usize::from(mirror)];
                        *worst = worst.max(error);
                        most = most.max(surface + white);
                    }
                }
            }
        }
    }
    eprintln!("lossless: {worst:.4?} off, albedo 1 gives at most {most:.4}");
    assert!(worst[0] < ENERGY, "{worst:?}");
    assert!(worst[1] < ENERGY_NEAR_MIRROR, "{worst:?}");
    assert!(most < 1.0 + ENERGY_NEAR_MIRROR, "{most}");
}

#[test]
fn mirror_facets_lose_nothing_once_compensated() {
    // So high an index makes a mirror.
    const MIRROR: f64 = 1e9;
    let mut worst = 0.0f64;
    for alpha in [0.05, 0.2, 0.4, 0.7, 1.0] {
        for mu_o in furnace_cosines().step_by(3) {
            let once = reflected(mu_o, alpha, |g| v_smith(g.mu_i, g.mu_o, alpha));
            // What several bounces send back of mirrors is all that one leaves.
            let compensation = 1.0 - directional_albedo(mu_o, alpha, MIRROR, 48);
            worst = worst.max((once + compensation - 1.0).abs());
        }
    }
    eprintln!("mirror facets: {worst:.1e} off");
    assert!(worst < ENERGY, "{worst}");
}

/// The draft tier's diffuser does not know of the lobe above it. This is its price, and why a
/// glossy sheet at a raking angle wants the gallery tier.
#[test]
fn the_draft_tier_gives_more_than_it_gets_at_grazing_angles() {
    let s = Surface::new(DVec3::ONE, 0.2, 1.5, 1.0);
    let whole = |mu_o: f64| {
        let over_d = |g: &Facing| {
            let lobe = brdf_draft(&s, g).x - brdf_lambert(&s).x;
            lobe / d_ggx(g.sin2_h, s.alpha)
        };
        1.0 + reflected(mu_o, s.alpha, over_d)
    };
    let (above, grazing) = (whole(1.0), whole(0.05));
    eprintln!("draft: {above:.3} from above, {grazing:.3} at 87°");
    assert!((above - 1.04).abs() < ENERGY, "{above}");
    assert!((1.1..1.8).contains(&grazing), "{grazing}");
}

#[test]
fn light_may_go_either_way() {
    let table = InterfaceTable::new(1.5, 0.8);
    let mut worst = 0.0f64;
    for alpha in [1e-4, 1e-2, 0.1, 0.5, 1.0] {
        let s = Surface::new(DVec3::new(0.9, 0.5, 0.1), alpha, 1.5, 0.8);
        let mean = table.mean_at(alpha);
        for mu_i in [1e-4, 0.01, 0.3, 0.7, 1.0] {
            for mu_o in [1e-4, 0.02, 0.31, 0.9] {
                for azimuth in [0.0, 0.5, 2.0, PI] {
                    let (l, v) = (at_cosine(mu_i, 0.0), at_cosine(mu_o, azimuth));
                    let (at_i, at_o) = (table.at(mu_i, alpha), table.at(mu_o, alpha));
                    let (there, back) = (facing(DVec3::Z, l, v), facing(DVec3::Z, v, l));
                    for (f, f_back) in [
                        (brdf_draft(&s, &there), brdf_draft(&s, &back)),
                        (
                            brdf_gallery(&s, &there, &at_i, &at_o, &mean),
                            brdf_gallery(&s, &back, &at_o, &at_i, &mean),
                        ),
                    ] {
                        worst = worst.max(((f - f_back) / f).abs().max_element());
                    }
                }
            }
        }
    }
    assert!(worst < RECIPROCITY, "{worst}");
}

#[test]
fn a_photograph_is_given_back_in_its_own_geometry() {
    // No photograph of a sheet under index 3 could be whiter than three quarters, nor darker
    // than its surface alone.
    let albedo = DVec3::new(0.7, 0.35, 0.15);
    let black = DVec3::splat(1e-3);
    let (oblique, above) = (std::f64::consts::FRAC_1_SQRT_2, 1.0);
    let g = facing(DVec3::Z, at_cosine(oblique, 0.0), DVec3::Z);
    let mut worst = 0.0f64;
    for (index, specular, alpha) in [
        (1.5, 0.0, 0.3),
        (1.5, 1.0, 0.3),
        (1.5, 1.0, 0.05),
        (1.557, 0.5, 1.0),
        (2.5, 1.0, 0.2),
    ] {
        let shown = |table: &InterfaceTable| {
            let f = |albedo: DVec3| {
                let s = Surface::new(albedo, alpha, index, specular);
                let (at_i, at_o) = (table.at(oblique, alpha), table.at(above, alpha));
                brdf_gallery(&s, &g, &at_i, &at_o, &table.mean_at(alpha))
            };
            assert!(specular > 0.0 || f(DVec3::ZERO) == DVec3::ZERO);
            // What is darker than the surface's own reflection shows as that.
            let floor = f(DVec3::ZERO).x * PI;
            assert!(black.x > floor || f(black) == f(DVec3::ZERO));
            assert!(floor < albedo.z, "{floor}");
            (f(albedo) * PI / albedo - 1.0).abs().max_element()
        };
        let own = shown(&InterfaceTable::at_roughness(alpha, index, specular));
        assert!(
            own < EXACT,
            "n {index}, specular {specular}, α {alpha}: {own}"
        );
        worst = worst.max(shown(&InterfaceTable::new(index, specular)));
    }
    eprintln!("photograph: {worst:.1e} off under a map of roughness");
    assert!(worst < INTERFACE, "{worst}");
    let s = Surface::new(albedo, 0.5, 1.5, 1.0);
    assert_eq!(brdf_lambert(&s), albedo / PI);
}

#[test]
fn the_interface_is_what_its_integral_says() {
    let mut worst = [0.0f64; 2];
    for index in [1.3, 1.5, 1.557] {
        let fitted = InterfaceTable::new(index, 1.0);
        // Between the nodes of the fit.
        for alpha in [0.13, 0.27, 0.55, 0.9] {
            let own = InterfaceTable::at_roughness(alpha, index, 1.0);
            for mu in [0.03, 0.11, 0.35, 0.6, 0.93] {
                let lobe = reflected(mu, alpha, |g| {
                    v_smith(g.mu_i, g.mu_o, alpha) * fresnel_dielectric(g.cos_d, index)
                });
                for table in [&own, &fitted] {
                    let (at, mean) = (table.at(mu, alpha), table.mean_at(alpha));
                    let compensation = over_hemisphere(|mu_i| {
                        mean.compensation * at.late * table.at(mu_i, alpha).late
                    });
                    let error = (1.0 - lobe - compensation - at.t).abs();
                    worst[0] = worst[0].max(error);
                    let t_mean = over_hemisphere(|mu| table.at(mu, alpha).t) / PI;
                    worst[1] = worst[1].max((t_mean - mean.t_mean).abs());
                }
            }
        }
    }
    eprintln!(
        "interface: t {:.1e}, its mean {:.1e} off",
        worst[0], worst[1]
    );
    assert!(worst[0] < INTERFACE && worst[1] < INTERFACE, "{worst:?}");
}

/// Mitsuba 3 is an independent oracle: its values and the script that asked for them lie beside
/// each other. It computes in f32, and shadows by G1·G1 where Recto correlates.
const MITSUBA: f64 = 2e-5;
/// Mitsuba takes the mean transmittance of plastic from a fit.
const MITSUBA_PLASTIC: f64 = 2e-3;

#[test]
fn another_renderer_agrees() {
    let g_1 = |mu: f64, alpha: f64| {
        let tan2 = (1.0 - mu * mu) / (mu * mu);
        2.0 / (1.0 + (1.0 + alpha * alpha * tan2).sqrt())
    };
    let mut worst: [(&str, f64); 3] = [("mirror", 0.0), ("glass", 0.0), ("plastic", 0.0)];
    let table = include_str!("../fixtures/oracle.csv");
    let rows = table.lines().skip(1);
    // Burley's have a test of their own.
    for line in rows.filter(|line| !line.starts_with("burley")) {
        let (model, numbers) = line.split_once(',').expect("a model");
        let numbers: Vec<f64> = numbers
            .split(',')
            .map(|number| number.parse().expect("a number"))
            .collect();
        let [alpha, index, mu_i, mu_o, azimuth, value] = numbers[..] else {
            panic!("{line}");
        };
        let (l, v) = (at_cosine(mu_i, 0.0), at_cosine(mu_o, azimuth.to_radians()));
        let g = facing(DVec3::Z, l, v);
        let facets = || {
            let shadowing = g_1(mu_i, alpha) * g_1(mu_o, alpha) / (4.0 * mu_i * mu_o);
            d_ggx(g.sin2_h, alpha) * shadowing
        };
        let expected = match model {
            "mirror" => facets(),
            "glass" => facets() * fresnel_dielectric(g.cos_d, index),
            // Fresnel twice around a diffuser, as the gallery tier over a mirror interface, but
            // scaled for its mean transmittance and not for a photograph.
            "plastic" => {
                let t = |mu: f64| 1.0 - fresnel_dielectric(mu, index);
                0.5 * t(mu_i) * t(mu_o) / over_hemisphere(t)
            }
            other => panic!("{other}"),
        };
        let error = &mut worst
            .iter_mut()
            .find(|(name, _)| *name == model)
            .expect(model)
            .1;
        *error = error.max((value / expected - 1.0).abs());
    }
    eprintln!("against Mitsuba, relative: {worst:?}");
    for (model, error) in worst {
        let tolerance = if model == "plastic" {
            MITSUBA_PLASTIC
        } else {
            MITSUBA
        };
        assert!(error > 0.0 && error < tolerance, "{model}: {error}");
    }
}
