//! Colour: the chart's constants, where its patches lie, and what a correction reaches.

use std::fs;

use glam::DVec2;
use recto::{
    colour::{self, delta_e00},
    prepare::colour::{
        chart::{
            COLORCHECKER24, ChartError, PATCHES, colours, lab_under, linear_from_lab_d50, middles,
        },
        correct::{Model, fit},
    },
};

use super::support::data;
use crate::test_name;

/// What two tables of one chart may differ by.
const SAME_CHART: f64 = 0.3;

#[test]
fn the_charts_constants_are_those_measured_elsewhere() {
    let Some(path) = data(test_name!(), "colorchecker/colorchecker24.json") else {
        return;
    };
    let text = fs::read_to_string(path).expect("text");
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let sets = json["chromaticities_xyY"].as_object().expect("sets");
    let worst = |name: &str| {
        let patches = sets[name]["patches"].as_object().expect("patches");
        let each = COLORCHECKER24.iter().map(|patch| {
            // "neutral 8 (.23 D)", "white 9.5 (.05 D)", "black 2 (1.5 D)".
            let key = patches
                .keys()
                .find(|key| key.starts_with(patch.name))
                .expect(patch.name);
            let xyy: Vec<f64> = patches[key]
                .as_array()
                .expect("xyY")
                .iter()
                .filter_map(|v| v.as_f64())
                .collect();
            let xyz = colour::xyz_from_xyy([xyy[0], xyy[1], xyy[2]]);
            delta_e00(
                colour::lab_from_xyz(xyz, colour::white_xyz(colour::D50)),
                patch.lab,
            )
        });
        each.fold(0.0, f64::max)
    };
    let after = worst("ColorChecker24 - After November 2014");
    assert!(after < SAME_CHART, "{after}");
    let other = sets
        .keys()
        .find(|key| key.contains("Before"))
        .expect("the older chart");
    assert!(worst(other) > SAME_CHART);
}

/// A camera whose channels are no mixture of the chart's own: each answers with a little of its
/// neighbours and bends.
fn camera([r, g, b]: [f64; 3], bend: f64) -> [f64; 3] {
    let mixed = [
        0.62 * r + 0.30 * g + 0.04 * b,
        0.14 * r + 0.72 * g + 0.10 * b,
        0.03 * r + 0.22 * g + 0.60 * b,
    ];
    let bent = (mixed[0] * mixed[1]).max(0.0).sqrt();
    [
        mixed[0] + bend * bent,
        mixed[1],
        mixed[2] - bend * 0.5 * bent,
    ]
}

fn measured(bend: f64) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let lab: Vec<[f64; 3]> = COLORCHECKER24.iter().map(|patch| patch.lab).collect();
    let seen = lab
        .iter()
        .map(|lab| camera(linear_from_lab_d50(*lab), bend))
        .collect();
    (seen, lab)
}

#[test]
fn a_linear_camera_is_corrected_by_a_linear_model() {
    let (seen, lab) = measured(0.0);
    let fitted = fit(&seen, &lab, colour::D50).expect("a fit");
    assert_eq!(fitted.correction.model, Model::Linear);
    assert!(fitted.after.iter().all(|e| *e < 0.01), "{:?}", fitted.after);
    assert!(fitted.before.iter().sum::<f64>() / 24.0 > 3.0);
}

#[test]
fn a_bent_camera_is_corrected_by_the_root_polynomial_and_by_it_alone() {
    let (seen, lab) = measured(0.25);
    let fitted = fit(&seen, &lab, colour::D50).expect("a fit");
    assert_eq!(fitted.correction.model, Model::RootPolynomial);
    let [linear, root] = [fitted.left_out[0].1, fitted.left_out[1].1];
    assert!(root < 0.7 * linear, "{linear} {root}");
    // Twice the light gives twice the colour.
    let one = fitted.correction.apply(seen[3]);
    let two = fitted.correction.apply(seen[3].map(|v| 2.0 * v));
    assert!((0..3).all(|c| (two[c] - 2.0 * one[c]).abs() < 1e-12));
    // Planes give what single colours do.
    let mut planes: Vec<Vec<f32>> = (0..3)
        .map(|c| seen.iter().map(|s| s[c] as f32).collect())
        .collect();
    let [r, g, b] = &mut planes[..] else {
        panic!("three planes")
    };
    fitted.correction.apply_planes([r, g, b]);
    for (i, seen) in seen.iter().enumerate() {
        let wanted = fitted.correction.apply(*seen);
        assert!((0..3).all(|c| (f64::from(planes[c][i]) - wanted[c]).abs() < 1e-5));
    }
    assert!(fit(&[[0.5; 3]; 24], &lab, colour::D50).is_none());
}

#[test]
fn patches_are_read_in_perspective() {
    let corners = [
        DVec2::new(60.0, 50.0),
        DVec2::new(420.0, 80.0),
        DVec2::new(400.0, 300.0),
        DVec2::new(80.0, 270.0),
    ];
    let places = middles(corners).expect("places");
    for (i, corner) in [0, 5, 23, 18].into_iter().zip(corners) {
        assert!(places[i].distance(corner) < 1e-9);
    }
    // Each pixel has the colour of the patch that is nearest.
    let size = [480, 360];
    let wanted: Vec<[f64; 3]> = COLORCHECKER24
        .iter()
        .map(|p| linear_from_lab_d50(p.lab))
        .collect();
    let mut planes = vec![vec![0.0f32; 480 * 360]; 3];
    for y in 0..360 {
        for x in 0..480 {
            let at = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let near = (0..PATCHES).min_by(|a, b| {
                let far = |i: &usize| places[*i].distance(at);
                far(a).total_cmp(&far(b))
            });
            for c in 0..3 {
                planes[c][y * 480 + x] = wanted[near.expect("one")][c] as f32;
            }
        }
    }
    let read =
        |planes: &[Vec<f32>], corners| colours([&planes[0], &planes[1], &planes[2]], size, corners);
    let found = read(&planes, corners).expect("colours");
    for (found, wanted) in found.iter().zip(&wanted) {
        assert!(
            delta_e00(
                lab_under(*found, colour::D50),
                lab_under(*wanted, colour::D50)
            ) < 0.01
        );
    }
    let outside = corners.map(|corner| corner - DVec2::new(55.0, 0.0));
    assert_eq!(read(&planes, outside), Err(ChartError::Outside(0)));
    let line = corners.map(|corner| DVec2::new(corner.x, corner.x));
    assert_eq!(read(&planes, line), Err(ChartError::Degenerate));
    let small = corners.map(|corner| corner * 0.04 + 100.0);
    assert!(matches!(read(&planes, small), Err(ChartError::Small(_))));
    planes[0].fill(1.0);
    assert_eq!(read(&planes, corners), Err(ChartError::Saturated(0)));
}
