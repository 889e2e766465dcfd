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
fn points_at_odds_with_the_others_are_found_one_by_one() {
    // A reading error of some tenths of a millimetre, the same each time.
    let error = |i: usize| (i * 7919 % 13) as f64 / 40.0 - 0.15;
    let points = |wrong: &[(usize, f64)]| -> Vec<ControlPoint> {
        let mut points: Vec<ControlPoint> = (0..20)
            .map(|i| {
                let mm = dvec2((i % 5) as f64 * 45.0 + 10.0, (i / 5) as f64 * 30.0 + 5.0);
                (mm * 10.0, mm + dvec2(error(i), error(i + 5)))
            })
            .collect();
        for (i, mm) in wrong {
            points[*i].1.x += mm;
        }
        points
    };
    for fit in [FitKind::Similarity, FitKind::Affine, FitKind::ThinPlate] {
        let at_odds = |points: &[ControlPoint]| {
            let fitted = Fitted::new(points, Some(fit), PIXELS, SHEET).expect("a fit");
            fitted.at_odds(points, PIXELS, SHEET, 0.5)
        };
        assert_eq!(at_odds(&points(&[])), None, "{fit:?}");
        for wrong in [&[(7, 10.0)][..], &[(7, 10.0), (12, -6.0)]] {
            let found = at_odds(&points(wrong)).expect("points at odds");
            let which: Vec<usize> = found.points.iter().map(|(i, _)| *i).collect();
            let expected: Vec<usize> = wrong.iter().map(|(i, _)| *i).collect();
            assert_eq!(which, expected, "{fit:?}");
            // Of each of them the distance is known, the last one's from what is right alone.
            let (_, mm) = found.points[wrong.len() - 1];
            let (_, moved) = wrong[wrong.len() - 1];
            assert!((mm - f64::abs(moved)).abs() < 1.0, "{fit:?} {found:?}");
            assert!(found.usual_mm < 0.6, "{fit:?} {found:?}");
        }
    }
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
    for fit in [FitKind::Similarity, FitKind::Affine, FitKind::ThinPlate] {
        let error = refused(&far, Some(fit));
        assert!(error.contains("beside the sheet"), "{error}");
        // Of which some lies on the sheet.
        let near: Vec<ControlPoint> = square(None)
            .iter()
            .map(|&(px, mm)| (px + 900.0, mm))
            .collect();
        Fitted::new(&near, Some(fit), PIXELS, SHEET).expect("a fit");
    }
    let shifted = [(dvec2(0.0, 0.0), dvec2(201.0, 0.0))];
    assert!(refused(&shifted, None).contains("beside the sheet"));
    let shifted = [(dvec2(0.0, 0.0), dvec2(199.0, 0.0))];
    Fitted::new(&shifted, None, PIXELS, SHEET).expect("a fit");
    // Turned by 45° beside a corner: its outline's upright rectangle meets the sheet, it does not.
    let turned = |off: f64| {
        let corner = |x: f64, y: f64| {
            let on_sheet = DVec2::from_angle(std::f64::consts::FRAC_PI_4).rotate(dvec2(x, y));
            (dvec2(x, y), on_sheet / 20.0 + dvec2(200.0 + off, 0.0))
        };
        let points = [corner(0.0, 0.0), corner(2000.0, 1000.0)];
        Fitted::new(&points, None, PIXELS, SHEET)
    };
    assert!(turned(-1.0).is_ok());
    assert!(turned(36.0).is_err());
}

#[test]
fn one_place_of_the_picture_has_one_place_on_the_sheet() {
    for fit in [FitKind::Similarity, FitKind::Affine, FitKind::ThinPlate] {
        let mut points = square(None);
        points.push((dvec2(1000.0, 500.0), dvec2(100.0, 50.0)));
        Fitted::new(&points, Some(fit), PIXELS, SHEET).expect("a fit");
        points[4].0 = points[1].0;
        let error = Fitted::new(&points, Some(fit), PIXELS, SHEET).expect_err("doubled");
        assert_eq!(
            error.to_string(),
            "control points 2 and 5 lie in one place in the picture; remove one"
        );
    }
}

#[test]
fn mirrored_flattened_and_folded_points_are_refused() {
    let bent: Vec<ControlPoint> = (0..20)
        .map(|i| {
            dvec2(
                f64::from(i % 5) * 45.0 + 10.0,
                f64::from(i / 5) * 30.0 + 5.0,
            )
        })
        .map(|mm| (mm * 10.0 + dvec2(mm.y * mm.y * 0.02, 0.0), mm))
        .collect();
    let refused = |points: &[ControlPoint], fit| {
        Fitted::new(points, Some(fit), PIXELS, SHEET)
            .expect_err("refused")
            .to_string()
    };
    for fit in [FitKind::Similarity, FitKind::Affine, FitKind::ThinPlate] {
        Fitted::new(&bent, Some(fit), PIXELS, SHEET).expect("a fit");
        // Upside down is no mirror image.
        let turned: Vec<_> = bent
            .iter()
            .map(|&(px, mm)| (dvec2(2000.0, 1000.0) - px, mm))
            .collect();
        Fitted::new(&turned, Some(fit), PIXELS, SHEET).expect("a fit");
        let mirrored: Vec<_> = bent
            .iter()
            .map(|&(px, mm)| (dvec2(2000.0 - px.x, px.y), mm))
            .collect();
        let error = refused(&mirrored, fit);
        assert!(error.contains("mirror"), "{error}");
    }
    // Points on a line have no mirror image to be told from them.
    let line: Vec<_> = bent[..5].to_vec();
    Fitted::new(&line, Some(FitKind::Similarity), PIXELS, SHEET).expect("a fit");
    let mut exchanged = square(None);
    (exchanged[0].0, exchanged[1].0) = (exchanged[1].0, exchanged[0].0);
    let error = refused(&exchanged, FitKind::Affine);
    assert!(error.contains("onto a line"), "{error}");
    let mut exchanged = bent.clone();
    (exchanged[7].0, exchanged[8].0) = (exchanged[8].0, exchanged[7].0);
    let error = refused(&exchanged, FitKind::ThinPlate);
    assert!(error.contains("folds"), "{error}");
}

#[test]
fn points_that_reading_errors_would_decide_about_lie_on_a_line() {
    let near_line = |off: f64| -> Vec<ControlPoint> {
        (0..6)
            .map(|i| dvec2(10.0 + f64::from(i) * 35.0, 50.0 + off * f64::from(i % 2)))
            .map(|mm| (mm * 10.0, mm))
            .collect()
    };
    let fit = |off| Fitted::new(&near_line(off), None, PIXELS, SHEET);
    let error = fit(0.05).expect_err("a line").to_string();
    assert!(error.contains("on one line"), "{error}");
    fit(5.0).expect("a fit");
}

#[test]
fn a_small_picture_is_bent_where_it_lies_on_a_large_sheet() {
    // Of 2 × 1 mm on a sheet of 2 m, with a bow of a twentieth of its size: beyond it the plate folds.
    let large = dvec2(2000.0, 1500.0);
    let at = |corner: DVec2| {
        let points: Vec<ControlPoint> = (0..15)
            .map(|i| dvec2(f64::from(i % 5) / 4.0, f64::from(i / 5) / 2.0))
            .map(|share| {
                let bow = 100.0 * share.y * (1.0 - share.y);
                let px = share * dvec2(2000.0, 1000.0) + dvec2(bow, 0.0);
                (px, corner + share * dvec2(2.0, 1.0))
            })
            .collect();
        Fitted::new(&points, Some(FitKind::ThinPlate), PIXELS, large)
    };
    for corner in [dvec2(1007.3, 707.9), dvec2(0.0, 0.0), dvec2(-1.0, 1499.5)] {
        let fitted = at(corner).expect("a fit");
        let middle = fitted
            .uv_from_side
            .transform_point2(corner + dvec2(1.0, 0.5));
        let warp = fitted.warp.expect("a warp");
        if corner.min_element() > 0.0 {
            // The rectangle is hardly larger than the picture, and as fine.
            assert!(middle.distance(DVec2::splat(0.5)) < 0.1, "{middle}");
            let [width, height] = warp.size();
            assert!(
                (1900..2400).contains(&width) && (950..1200).contains(&height),
                "{width} {height}"
            );
        }
        let px = warp.px_from_uv(middle);
        assert!(px.distance(dvec2(1025.0, 500.0)) < 0.5, "{px}");
    }
    let error = at(dvec2(2000.5, 700.0)).expect_err("beside").to_string();
    assert!(error.contains("beside the sheet"), "{error}");
}
