//! Lamps: found in glossy balls, read from files, and compared in brightness.

use std::fs;

use glam::{DVec2, DVec3};
use recto::{
    maps::{self, ColourEncoding},
    prepare::{
        capture::Circle,
        lights::{
            self, direction, intensity, lp,
            sphere::{NoHighlight, highlight, luma},
        },
    },
};

use super::support::data;
use crate::test_name;

/// What the probes' makers and this program may differ by, in degrees.
const PROBE_DEG: f64 = 0.05;

fn grey(path: &std::path::Path) -> (Vec<f32>, [usize; 2]) {
    let mut planes = [Vec::new(), Vec::new(), Vec::new()];
    let mut width = 0;
    maps::for_each_colour_row(path, ColourEncoding::Srgb, |_, row| {
        width = row.len();
        for (c, plane) in planes.iter_mut().enumerate() {
            plane.extend(row.iter().map(|pixel| pixel[c]));
        }
    })
    .expect("a picture");
    let height = planes[0].len() / width;
    (luma(planes.each_ref().map(Vec::as_slice)), [width, height])
}

fn numbers(path: &std::path::Path) -> Vec<f64> {
    let text = fs::read_to_string(path).expect("numbers");
    text.split_whitespace()
        .map(|word| word.parse().expect("a number"))
        .collect()
}

#[test]
fn the_probes_lamps_are_found() {
    let Some(root) = data(test_name!(), "psbox") else {
        return;
    };
    let mut off_by_mean = f64::INFINITY;
    for probe in ["LightProbe-1", "LightProbe-2"] {
        let folder = root.join(probe);
        // MATLAB counts pixel centres from 1, and this file counts rows from the lowest.
        let circle = numbers(&folder.join("circle_data.txt"));
        let [_, height] = maps::probe(&folder.join("ref.JPG"))
            .expect("a picture")
            .size;
        let circle = Circle {
            centre: DVec2::new(circle[0] - 0.5, f64::from(height) + 0.5 - circle[1]),
            radius: circle[2],
        };
        let wanted = numbers(&folder.join("light_directions.txt"));
        for i in 0..12 {
            let (grey, size) = grey(&folder.join(format!("Image_{:02}.JPG", i + 1)));
            let found = highlight(&grey, size, circle).expect("a highlight");
            let wanted = DVec3::new(wanted[i], wanted[12 + i], wanted[24 + i]);
            let off = found
                .direction
                .angle_between(wanted.normalize())
                .to_degrees();
            assert!(off < PROBE_DEG, "{probe} {i}: {off}°");
            let trapped = mean_of_bright(&grey, size, circle);
            off_by_mean = off_by_mean.min(trapped.angle_between(wanted).to_degrees());
        }
    }
    // The trap of the data's README is one: the comparison can fail.
    assert!(off_by_mean > 20.0 * PROBE_DEG, "{off_by_mean}°");
}

/// The direction by the mean of all that is 0.9 of the brightest or more, which is wrong.
fn mean_of_bright(grey: &[f32], [width, _]: [usize; 2], circle: Circle) -> DVec3 {
    let brightest = grey.iter().copied().fold(0.0, f32::max);
    let bright = 0.9 * brightest;
    let mut sum = DVec2::ZERO;
    let mut count = 0.0;
    for (i, value) in grey.iter().enumerate() {
        let at = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        if *value >= bright && at.distance(circle.centre) < circle.radius {
            sum += at;
            count += 1.0;
        }
    }
    lights::sphere::mirrored(sum / count, circle)
}

#[test]
fn balls_without_a_lamp_are_refused() {
    let size = [100, 80];
    let circle = |x: f64| Circle {
        centre: DVec2::new(x, 40.0),
        radius: 30.0,
    };
    let dark = vec![0.0; 8000];
    assert_eq!(highlight(&dark, size, circle(50.0)), Err(NoHighlight::None));
    assert_eq!(
        highlight(&dark, size, circle(20.0)),
        Err(NoHighlight::Outside)
    );
    let white = vec![1.0; 8000];
    assert!(matches!(
        highlight(&white, size, circle(50.0)),
        Err(NoHighlight::Overexposed(_))
    ));
    // A single pixel is dust; a spot in the middle mirrors the camera's own place.
    let mut lit = dark;
    lit[40 * 100 + 50] = 1.0;
    assert_eq!(highlight(&lit, size, circle(50.5)), Err(NoHighlight::None));
    for (x, y) in [(49, 40), (51, 40), (50, 39), (50, 41)] {
        lit[y * 100 + x] = 1.0;
    }
    let found = highlight(&lit, size, circle(50.5)).expect("a lamp");
    assert!(found.direction.angle_between(DVec3::Z) < 0.04);
}

#[test]
fn the_lions_lamps_are_read() {
    let Some(root) = data(test_name!(), "rti_lion") else {
        return;
    };
    let text = fs::read_to_string(root.join("dirs.lp")).expect("text");
    let lamps = lp::read(&text).expect("lamps");
    assert_eq!(lamps.len(), 240);
    let elevations = lamps.iter().map(|lamp| lights::angles(lamp.direction)[1]);
    let (low, high) = elevations.fold((90.0, 0.0), |(low, high): (f64, f64), e| {
        (low.min(e), high.max(e))
    });
    // As the data's README says: 1° to 83°.
    assert!(
        (0.5..2.0).contains(&low) && (82.0..84.0).contains(&high),
        "{low} {high}"
    );
    assert!(lamps.iter().all(|lamp| lamp.beside(&root).is_file()));
    let directions: Vec<DVec3> = lamps.iter().map(|lamp| lamp.direction).collect();
    assert!(lights::spread(&directions).is_ok());
}

#[test]
fn angles_and_directions_are_inverse() {
    for [azimuth, elevation] in [[0.0, 45.0], [90.0, 10.0], [200.0, 80.0], [359.0, 1.0]] {
        let [a, e] = lights::angles(direction(azimuth, elevation));
        assert!((a - azimuth).abs() < 1e-9 && (e - elevation).abs() < 1e-9);
    }
    // From the left, as [[lamp]] of a manifest says it.
    assert!(direction(180.0, 12.0).x < -0.9);
}

/// How near a lamp's brightness is found, as a share.
const INTENSITY: f64 = 0.01;

#[test]
fn brightness_is_found_from_a_sheet_that_lies_flat() {
    let lamps: Vec<DVec3> = (0..6)
        .map(|i| direction(60.0 * f64::from(i), if i % 2 == 0 { 35.0 } else { 55.0 }))
        .collect();
    let given = [1.0, 0.7, 1.3, 0.9, 1.1, 1.0];
    let samples: Vec<Vec<f64>> = (0..400)
        .map(|i| {
            let (x, y) = (f64::from(i % 20) / 20.0, f64::from(i / 20) / 20.0);
            // Whole waves: the middle of all normals is upright.
            let slope = DVec2::new((x * 18.85).sin(), (y * 12.566).cos()) * 0.15;
            let normal = DVec3::new(-slope.x, -slope.y, 1.0).normalize();
            let albedo = 0.2 + 0.6 * x;
            let lamps = lamps.iter().zip(given);
            lamps.map(|(l, e)| albedo * e * l.dot(normal)).collect()
        })
        .collect();
    let found = intensity::solve(&lamps, &samples).expect("intensities");
    let worst = |found: &[f64]| {
        let each = found.iter().zip(given).map(|(f, g)| (f / g - 1.0).abs());
        each.fold(0.0, f64::max)
    };
    assert!(worst(&found) < INTENSITY, "{found:?}");
    assert!(worst(&[1.0; 6]) > INTENSITY);
    assert_eq!(intensity::solve(&lamps, &[vec![0.0; 6]]), None);
}
