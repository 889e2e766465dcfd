//! OPTICS' numeric traps in f64 (and where the trap is one of f32, in it): the expression without
//! its guard fails at the extreme where the shipped one holds. The shader's guards are taken out
//! in tests/parity/guards.rs.

use std::{f64::consts::PI, sync::Arc};

use glam::{DVec3, Vec3};
use recto::optics::{
    baselines::{d_beckmann, d_gauss, power_below_one, v_groove},
    fresnel::{fresnel_conductor, fresnel_dielectric},
    ink::{Film, capture_path, inner_cosine, optical_depth},
    lamp::{DISTANCE2_MIN_MM2, Light, Shape},
    lamp_units::{area_axes, point_intensity},
    microfacet::{ALPHA_MIN, MU_MIN, d_ggx, v_smith},
    refraction::PathTable,
    slab::Slab,
    study::phase_lobe,
    table::InterfaceTable,
    through::{Seen, Through, crossing},
    tier::{Facing, Surface, facing},
};

use crate::{N, OPAQUE};

/// What trap 1 allows D in f32.
const DISTRIBUTION: f64 = 1e-3;

#[test]
fn trap_1_the_squared_cosine_cancels_and_the_cross_product_does_not() {
    let (mut naive, mut shipped) = (0.0f64, 0.0f64);
    for (alpha, tilt) in [(2.025e-3, 1e-3), (ALPHA_MIN, 5e-5), (ALPHA_MIN, 2e-4)] {
        for turn in 0..32 {
            let phi = PI * f64::from(turn) / 16.0;
            let h = DVec3::new(phi.cos(), phi.sin(), 0.0) * f64::sin(tilt) + DVec3::Z * tilt.cos();
            // Away from the axes, where every component is rounded.
            let turned = |v: DVec3| {
                let x = DVec3::new(0.36, 0.48, -0.8);
                let y = DVec3::new(-0.8, 0.6, 0.0);
                (x * v.x + y * v.y + x.cross(y) * v.z).as_vec3()
            };
            let (n, h): (Vec3, Vec3) = (turned(DVec3::Z), turned(h));
            let exact = {
                let across = n.as_dvec3().normalize().cross(h.as_dvec3().normalize());
                d_ggx(across.length_squared(), alpha)
            };
            let off = |sin2: f32| (d_ggx(sin2.max(0.0).into(), alpha) / exact - 1.0).abs();
            naive = naive.max(off(1.0 - n.dot(h) * n.dot(h)));
            shipped = shipped.max(off(n.cross(h).length_squared()));
        }
    }
    println!("D off by {shipped:.1e} from the cross product, {naive:.1e} from the dot product");
    assert!(shipped < DISTRIBUTION, "{shipped}");
    assert!(naive > 1.0, "{naive}");
}

#[test]
fn traps_2_and_4_quotients_are_guarded_before_they_are_taken() {
    // Light from straight opposite the eye has no half vector.
    let v = DVec3::new(0.6, 0.0, 0.8);
    assert!(((v - v) / (v - v).length()).is_nan());
    let g = facing(DVec3::Z, -v, v);
    assert!(g.cos_d.is_finite() && g.sin2_h.is_finite());
    // Both in the plane of the sheet: V has no bound.
    assert_eq!(v_smith(0.0, 0.0, 0.3), f64::INFINITY);
    let g = facing(DVec3::Z, DVec3::X, -DVec3::X);
    assert_eq!((g.mu_i, g.mu_o), (MU_MIN, MU_MIN));
    assert!(v_smith(g.mu_i, g.mu_o, ALPHA_MIN).is_finite());
    let groove = Facing {
        cos_d: 0.0,
        sin2_h: 1.0,
        ..g
    };
    let nothing = std::hint::black_box(0.0f64);
    assert!((nothing / nothing).is_nan() && v_groove(&groove).is_finite());
    // No interface, met in its plane; and air as a conductor.
    assert_eq!(fresnel_dielectric(0.0, 1.0), 1.0);
    assert!(fresnel_conductor(0.0, 1.0, 0.0).is_finite());
    // A sheet that gives back all, between mirrors.
    let (none, all) = (DVec3::ZERO, DVec3::ONE);
    assert!((none / (none * none)).is_nan());
    let through = Through {
        reflected: all,
        inner_mean: 1.0,
        ..Through::default()
    };
    let seen = Seen {
        depth_f: none,
        clear: 1.0,
        depth_b: none,
        rho_f: all,
        rho_b: all,
    };
    assert_eq!(crossing(&through, &seen, 1.0, all, N), none);
}

#[test]
fn trap_3_exponents_stay_in_range() {
    assert!(f64::ln(0.0).is_infinite());
    for n in [0.0, 1.0, 2e8] {
        let p = power_below_one(1.0, n);
        assert!((0.0..=1.0).contains(&p), "{n}: {p}");
    }
    for sin2 in [0.0, 0.5, 1.0] {
        for d in [d_beckmann(sin2, ALPHA_MIN), d_gauss(sin2, ALPHA_MIN)] {
            assert!(d.is_finite() && d >= 0.0, "{sin2}: {d}");
        }
    }
}

#[test]
fn trap_5_a_mirror_has_a_width() {
    assert!(d_ggx(0.0, 0.0).is_nan());
    let mirror = Surface::new(DVec3::ONE, 0.0, N, 1.0);
    assert_eq!(mirror.alpha, ALPHA_MIN);
    assert!(d_ggx(0.0, mirror.alpha).is_finite());
    assert_eq!(Surface::new(DVec3::ONE, 7.0, N, 1.0).alpha, 1.0);
}

/// Of a quotient whose own digits have gone.
const LOST: f64 = 1e-3;

#[test]
fn trap_6_a_thin_film_is_told_from_none() {
    // 1 − e^(−τ) as it stands, in both widths.
    let naive = 1.0 - f64::exp(-1e-18);
    assert_eq!(naive, 0.0);
    let naive = f64::from(1.0 - f32::exp(-2e-5));
    assert!((naive / 2e-5 - 1.0).abs() > LOST, "{naive}");
    let series = f64::from(2e-5f32 * (1.0 - 0.5 * 2e-5f32));
    assert!((series / -f64::exp_m1(-2e-5) - 1.0).abs() < 1e-6);
    // Where the shader's series ends it is still the function.
    let end = 1e-3;
    assert!((end * (1.0 - 0.5 * end) / -f64::exp_m1(-end) - 1.0).abs() < 1e-6);
}

#[test]
fn trap_7_quotients_of_sines_meet_both_limits() {
    let naive = |sigma: f64, k: f64, l: f64| (sigma * k).sinh() / (sigma * l).sinh();
    assert!(naive(0.0, 0.3, 1.0).is_nan());
    assert!(naive(1e4, 0.3, 1.0).is_nan());
    let r_i = 0.5963;
    for absorption in [0.0, 1e-30, 1e-12, 1.0, 1e6, 1e12] {
        for thickness in [1e-6, 0.15, 1e3] {
            let slab = Slab {
                absorption,
                thickness,
                ..OPAQUE.slab()
            };
            let body = slab.body(r_i, 1.0);
            let shares = [body.reflected, body.transmitted];
            let sound = |share: &f64| (0.0..=1.0).contains(share);
            assert!(shares.iter().all(sound), "{slab:?}: {body:?}");
        }
    }
    // And meet each other: no step where the series begins.
    let at = |sigma_tr_l: f64| {
        let slab = OPAQUE.slab();
        // σtr L = √(3 σa σt′) L, L nearly that of a lossless slab.
        let sigma_t = (1.0 - slab.phase.mean_cosine()) * slab.scattering;
        let l = slab.thickness + 4.0 * (1.0 + r_i) / (1.0 - r_i) / (3.0 * sigma_t);
        let absorption = (sigma_tr_l / l).powi(2) / (3.0 * sigma_t);
        Slab { absorption, ..slab }.body(r_i, 1.0).transmitted
    };
    let steps: Vec<f64> = (0..20).map(|i| at(0.9e-3 + 1e-5 * f64::from(i))).collect();
    for two in steps.windows(2) {
        assert!((two[0] - two[1]).abs() < 1e-6, "{two:?}");
    }
}

#[test]
fn trap_8_black_is_a_depth() {
    let alpha = 0.4;
    let table = InterfaceTable::at_roughness(alpha, N, 1.0);
    let paths = Arc::new(PathTable::at_roughness(alpha, N));
    let capture = capture_path(&paths, alpha);
    assert!((-f64::ln(0.0) / capture.x).is_infinite());
    let film = Film::new(N, alpha, &table, paths, 0.5963, DVec3::splat(0.85));
    let depth = |x: f64| optical_depth(&film, capture, DVec3::splat(x)).x;
    for x in [-1.0, 0.0, 1e-300, 1e-20] {
        assert_eq!(depth(x), 20.0, "{x}");
    }
    // R = 7e-5 at τ = 4 is below a step of 8 bits, and still tells the depth.
    let steps: Vec<f64> = [4e-5, 7e-5, 1e-4].map(|r| depth(r / 0.75)).to_vec();
    assert!(
        steps[0] > steps[1] + 0.1 && steps[1] > steps[2] + 0.1,
        "{steps:?}"
    );
}

#[test]
fn trap_9_lobes_and_refraction_end_where_they_should() {
    let naive = |g: f64, cos: f64| (1.0 - g * g) / (1.0 + g * g - 2.0 * g * cos).powf(1.5);
    assert!(naive(1.0, 1.0).is_nan());
    assert!(phase_lobe(1.0, 1.0).is_finite() && phase_lobe(-1.0, -1.0).is_finite());
    assert!((1.0f64 - 1.0 / 0.81).sqrt().is_nan());
    assert_eq!(inner_cosine(0.0, 0.9), 0.0);
    assert!((inner_cosine(1.0 + 1e-9, N) - 1.0).abs() < 1e-8);
    // A sheet of no thickness has no inside.
    let none = Slab {
        thickness: 1e-12,
        ..OPAQUE.slab()
    };
    let (x, t) = none.with_boundaries(0.5963, 1.0);
    assert!(x.is_finite() && t.is_finite() && x + t <= 1.0 + 1e-9);
}

#[test]
fn trap_10_a_lamp_straight_above_has_axes() {
    assert!(DVec3::Z.cross(DVec3::Z).normalize().is_nan());
    let above = DVec3::Z * 500.0;
    let axes = area_axes(above, DVec3::ZERO).expect("it shines somewhere");
    assert!(axes.iter().all(|axis| (axis.length() - 1.0).abs() < 1e-12));
    assert_eq!(area_axes(above, above), None);
    // Seen from straight above, as a museum hangs it.
    let g = facing(DVec3::Z, DVec3::Z, DVec3::Z);
    assert_eq!((g.mu_i, g.mu_o, g.cos_d, g.sin2_h), (1.0, 1.0, 1.0, 0.0));
}

#[test]
fn trap_11_nothing_is_nearer_than_a_centimetre() {
    for lumen in [1e-3, 1e7] {
        let amount = DVec3::splat(point_intensity(lumen) * 1e6);
        for distance in [0.0, 1e-300, 1e-3, 9.9] {
            let position = DVec3::Z * distance;
            let at = Light {
                shape: Shape::Point { position },
                amount,
            }
            .at(DVec3::ZERO);
            let naive = amount.x / (distance * distance);
            assert!(naive > at[0].e.x, "{distance}");
            assert_eq!(at[0].e.x, amount.x / DISTANCE2_MIN_MM2);
            assert!(at[0].l.is_finite());
        }
    }
}
