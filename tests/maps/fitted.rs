//! What control points ask for, and how well they agree with it.

use glam::{DVec2, dvec2};
use recto::maps::registration::{ControlPoint, FitKind, Fitted};

const SHEET: DVec2 = DVec2::new(200.0, 100.0);
const PIXELS: [u32; 2] = [2000, 1000];

/// Ten pixels to the mm, point `moved` displaced by 1 mm to the right in the picture.
fn square(moved: Option<usize>) -> Vec<ControlPoint> {
    let mut points: Vec<ControlPoint> = [(20.0, 20.0), (180.0, 20.0), (180.0, 80.0), (20.0, 80.0)]
        .map(|(x, y)| (dvec2(x, y) * 10.0, dvec2(x, y)))
        .to_vec();
    if let Some(moved) = moved {
        points[moved].0.x += 10.0;
    }
    points
}

#[test]
fn points_that_agree_have_no_residual_and_one_that_does_not_has_a_known_one() {
    let fitted = Fitted::new(&square(None), None, PIXELS, SHEET).expect("a fit");
    assert_eq!(fitted.fit, FitKind::Affine);
    assert!(fitted.residual().is_some_and(|r| r.largest_mm < 1e-9));
    // One of four corners off by 1 mm: the affine fit leaves a quarter of it at each, and the
    // other three alone put it a whole 1 mm away.
    let fitted = Fitted::new(&square(Some(2)), None, PIXELS, SHEET).expect("a fit");
    let residual = fitted.residual().expect("residuals");
    assert!((residual.rms_mm - 0.25).abs() < 0.01, "{residual:?}");
    let left_out = fitted.left_out_mm[2].expect("a residual");
    assert!((left_out - 1.0).abs() < 0.02, "{left_out}");
    // Two corners of a similarity determine the others less well than three of an affine fit.
    let fit = Some(FitKind::Similarity);
    let fitted = Fitted::new(&square(Some(2)), fit, PIXELS, SHEET).expect("a fit");
    let similar = fitted.residual().expect("residuals");
    assert!(similar.rms_mm > residual.rms_mm, "{similar:?}");
}

#[test]
fn as_few_points_as_a_fit_takes_say_nothing_of_it() {
    for (count, fit) in [
        (1, FitKind::Shift),
        (2, FitKind::Similarity),
        (3, FitKind::Affine),
    ] {
        let points = &square(Some(2))[..count];
        let fitted = Fitted::new(points, None, PIXELS, SHEET).expect("a fit");
        assert_eq!(fitted.fit, fit);
        assert_eq!(fitted.left_out(), None, "{fit:?}");
        assert!(fitted.residual().is_some_and(|r| r.largest_mm < 1e-9));
    }
}

#[test]
fn a_plate_s_own_residual_is_that_of_the_point_left_out() {
    let mut points = square(Some(2));
    points.push((dvec2(1000.0, 500.0), dvec2(100.0, 50.0)));
    let plate = Some(FitKind::ThinPlate);
    let fitted = Fitted::new(&points, plate, PIXELS, SHEET).expect("a fit");
    assert!(fitted.warp.is_some());
    assert!(fitted.residual().is_some_and(|r| r.largest_mm < 1e-6));
    let left_out = fitted.left_out().expect("residuals");
    assert!((0.5..1.5).contains(&left_out.largest_mm), "{left_out:?}");
}

#[test]
fn points_that_place_nothing_are_refused() {
    let refused = |points: &[ControlPoint], fit| {
        Fitted::new(points, fit, PIXELS, SHEET)
            .expect_err("refused")
            .to_string()
    };
    for fit in [FitKind::Similarity, FitKind::Affine, FitKind::ThinPlate] {
        let mut points = square(None);
        points.push(points[1]);
        let error = refused(&points, Some(fit));
        assert!(error.contains("points 2 and 5 lie in one place"), "{error}");
        let few = refused(&square(None)[..fit.least_points() - 1], Some(fit));
        assert!(few.contains("at least"), "{few}");
    }
    let line: Vec<ControlPoint> = (0..5)
        .map(|i| dvec2(f64::from(i) * 10.0, 50.0))
        .map(|mm| (mm * 10.0, mm))
        .collect();
    for fit in [FitKind::Affine, FitKind::ThinPlate] {
        let error = refused(&line, Some(fit));
        assert!(error.contains("on one line"), "{error}");
    }
    let far: Vec<ControlPoint> = square(None)
        .iter()
        .map(|&(px, mm)| (px + 5000.0, mm))
        .collect();
    let error = refused(&far, Some(FitKind::ThinPlate));
    assert!(error.contains("beside the sheet"), "{error}");
}
