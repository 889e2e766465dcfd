//! The photograph undone: albedo → absorption → albedo.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use glam::DVec3;
use recto::reference::{
    Absorption, Bound, Capture, Lamp, Layers, Lighting, Phase, radiance, rng::stream,
};

use crate::statistic::{Z_MAX, z};

const SHEET: Layers = Layers {
    n: 1.5,
    alpha: [0.4; 2],
    sigma_s: 81.38,
    phase: Phase::single(1.0 / 3.0),
    thickness_mm: 0.262,
};

const PAPER: Absorption = Absorption {
    sigma_a: 0.3,
    ..Absorption::NONE
};

fn inked(tau_f: f64) -> Absorption {
    Absorption { tau_f, ..PAPER }
}

#[test]
fn the_ensemble_is_the_sheet_in_its_capture_geometry() {
    let capture = Capture::new(&SHEET, 20_000, 30);
    let channels = [PAPER, inked(1.0)];
    // Lamp and eye the other way round: an independent estimate, by reciprocity.
    let lighting = Lighting {
        lamps: &[Lamp {
            direction: DVec3::Z,
            irradiance: [PI; 2],
        }],
        table: [0.0; 2],
    };
    let view = DVec3::new(FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2);
    let seen = radiance(
        &SHEET,
        &channels,
        view,
        &lighting,
        20_000,
        &mut stream(31, 0),
    );
    for (seen, absorption) in seen.iter().zip(&channels) {
        let albedo = capture.albedo(absorption);
        assert!(z(seen, &albedo).abs() < Z_MAX, "{seen:?} {albedo:?}");
    }
}

#[test]
fn what_was_put_in_comes_out() {
    // Newton's method stops at 1e-12; the floor's subtraction costs digits in dark ink.
    const ROUND_TRIP: f64 = 1e-8;
    // A curve's interpolation: ΔE00 stays below .01.
    const CURVE: f64 = 1e-3;
    let capture = Capture::new(&SHEET, 4_000, 32);
    for sigma_a in [0.0, 1e-4, 0.05, 0.3, 4.0, 80.0] {
        let albedo = capture.albedo(&Absorption {
            sigma_a,
            ..Absorption::NONE
        });
        let solved = capture.solve_sigma_a(albedo.mean - 1e-15);
        assert_eq!(solved.bound, Bound::Inside);
        assert!(
            (solved.value - sigma_a).abs() < ROUND_TRIP * sigma_a.max(1.0),
            "{solved:?}"
        );
    }
    let curve = capture.film_curve(&PAPER);
    for tau in [0.0, 1e-3, 0.05, 0.7, 2.0, 4.0] {
        let albedo = capture.albedo(&inked(tau)).mean - 1e-15;
        let solved = capture.solve_tau(albedo, &PAPER);
        assert_eq!(solved.bound, Bound::Inside, "{tau}");
        assert!(
            (solved.value - tau).abs() < ROUND_TRIP * tau.max(1.0),
            "{tau}: {solved:?}"
        );
        let quick = curve.solve(albedo);
        assert_eq!(quick.bound, Bound::Inside, "{tau}");
        assert!(
            (quick.value - tau).abs() < CURVE * tau.max(0.1),
            "{tau}: {quick:?}"
        );
    }
}

#[test]
fn albedos_that_no_such_sheet_has_are_flagged() {
    let capture = Capture::new(&SHEET, 4_000, 33);
    let floor = capture.floor().mean;
    assert!(floor > 1e-3, "{floor}");
    let curve = capture.film_curve(&PAPER);
    for dark in [0.0, 0.5 * floor, floor, f64::NAN] {
        assert_eq!(capture.solve_sigma_a(dark).bound, Bound::BelowFloor);
        assert_eq!(capture.solve_tau(dark, &PAPER).bound, Bound::BelowFloor);
        assert_eq!(curve.solve(dark).bound, Bound::BelowFloor, "{dark}");
    }
    let bright = capture.albedo(&Absorption::NONE).mean + 1e-6;
    let solved = capture.solve_sigma_a(bright);
    assert_eq!((solved.value, solved.bound), (0.0, Bound::AboveLossless));
    let bare = capture.albedo(&PAPER).mean + 1e-6;
    assert_eq!(capture.solve_tau(bare, &PAPER).bound, Bound::AboveLossless);
    assert_eq!(curve.solve(bare).bound, Bound::AboveLossless);
    // A smooth surface sends its mirror image elsewhere.
    let smooth = Layers {
        alpha: [0.0; 2],
        ..SHEET
    };
    assert_eq!(Capture::new(&smooth, 100, 34).floor().mean, 0.0);
}
