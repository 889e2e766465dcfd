//! Control points → transforms.

use glam::{DAffine2, DMat2, DVec2, dvec2};
use recto::maps::registration::{ControlPoint, Frame, RegistrationError, affine, similarity};

/// Places on a sheet and where `px_from_mm` puts them in a picture.
fn points(px_from_mm: DAffine2, mm: &[DVec2]) -> Vec<ControlPoint> {
    mm.iter()
        .map(|&mm| (px_from_mm.transform_point2(mm), mm))
        .collect()
}

const PLACES: [DVec2; 4] = [
    dvec2(10.0, 12.0),
    dvec2(270.0, 9.0),
    dvec2(265.0, 180.0),
    dvec2(30.0, 150.0),
];

fn close(a: DAffine2, b: DAffine2) -> bool {
    // Pixels over a sheet of a metre.
    PLACES
        .iter()
        .all(|&mm| (a.transform_point2(mm) - b.transform_point2(mm)).length() < 1e-9)
}

#[test]
fn exact_points_give_the_transform_back() {
    let turned = DAffine2 {
        matrix2: DMat2::from_angle(0.3) * 11.8,
        translation: dvec2(-40.0, 1e4),
    };
    let fit = similarity(&points(turned, &PLACES[..2])).expect("two points");
    assert!(close(fit.px_from_mm, turned));
    assert!(fit.residuals_mm.iter().all(|&r| r < 1e-9));
    let sheared = DAffine2 {
        matrix2: DMat2::from_cols(dvec2(11.0, 1.0), dvec2(-2.0, -13.0)),
        translation: dvec2(5.0, 7.0),
    };
    let fit = affine(&points(sheared, &PLACES[..3])).expect("three points");
    assert!(close(fit.px_from_mm, sheared));
}

#[test]
fn residuals_are_in_millimetres() {
    // Twelve pixels a millimetre, and one point read 6 pixels off.
    let scale = DAffine2::from_scale(DVec2::splat(12.0));
    let mut points = points(scale, &PLACES);
    points[1].0.x += 6.0;
    let fit = similarity(&points).expect("four points");
    let worst = fit.residuals_mm.iter().copied().fold(0.0, f64::max);
    assert!((0.2..0.5).contains(&worst), "{:?}", fit.residuals_mm);
    assert_eq!(fit.residuals_mm[1], worst);
}

#[test]
fn degenerate_points_say_why() {
    let scale = DAffine2::from_scale(DVec2::splat(12.0));
    let too_few = affine(&points(scale, &PLACES[..2])).expect_err("two");
    assert_eq!(
        too_few.to_string(),
        "2 control points are not enough: this needs at least 3"
    );
    let same = similarity(&points(scale, &[PLACES[0]; 3])).expect_err("one place");
    assert!(matches!(same, RegistrationError::OnePlace(_)), "{same}");
    let line: Vec<_> = (0..5)
        .map(|i| dvec2(10.0, 20.0) + f64::from(i) * dvec2(3.0, 1.0))
        .collect();
    let line = affine(&points(scale, &line)).expect_err("a line");
    assert_eq!(line, RegistrationError::OneLine(Frame::Picture));
    let mut nan = points(scale, &PLACES);
    nan[2].1.y = f64::NAN;
    assert_eq!(similarity(&nan), Err(RegistrationError::NotFinite));
    // A square read as its mirror image: no rotation fits better than any other.
    let square = [
        dvec2(0.0, 0.0),
        dvec2(9.0, 0.0),
        dvec2(9.0, 9.0),
        dvec2(0.0, 9.0),
    ];
    let mirrored = points(DAffine2::from_scale(dvec2(-1.0, 1.0)), &square);
    assert_eq!(similarity(&mirrored), Err(RegistrationError::NoSimilarity));
}
