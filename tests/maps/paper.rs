//! Measured paper: normals and heights of one surface must tell the same story.

use std::path::Path;

use recto::maps::{self, NormalY};

use super::{channel, correlation, support::data};
use crate::test_name;

/// Slopes of a height map along x (right) and y (down), by central differences that wrap.
fn slopes(path: &Path) -> (Vec<f32>, Vec<f32>) {
    let map = maps::load_height(path).expect("read");
    let (w, h) = (map.levels[0].width as usize, map.levels[0].height as usize);
    let height = channel(&map, 0, 0);
    let at = |x: usize, y: usize| height[y % h * w + x % w];
    let along = |dx: usize, dy: usize| {
        let slope = |i: usize| {
            let (x, y) = (i % w, i / w);
            at(x + dx, y + dy) - at(x + w - dx, y + h - dy)
        };
        (0..w * h).map(slope).collect()
    };
    (along(1, 0), along(0, 1))
}

/// corr(−∂h/∂x, n_x) and corr(∂h/∂row, n_y).
fn agreement(height: &Path, normal: &Path, y: NormalY) -> [f64; 2] {
    let (dx, drow) = slopes(height);
    let map = maps::load_normal(normal, y).expect("read");
    [
        -correlation(&dx, &channel(&map, 0, 0)),
        correlation(&drow, &channel(&map, 0, 1)),
    ]
}

#[test]
fn normals_follow_the_displacement() {
    let Some(root) = data(test_name!(), "paper") else {
        return;
    };
    // The README of the data gives 0.91 and 0.97, 0.95 and 0.96; other differences are used here.
    for (name, expected) in [("Paper001", [0.91, 0.97]), ("Paper003", [0.95, 0.96])] {
        let file = |kind: &str| root.join(format!("{name}_1K_{kind}.jpg"));
        let found = agreement(&file("Displacement"), &file("Normal"), NormalY::Up);
        assert!(
            (0..2).all(|i| (found[i] - expected[i]).abs() < 0.03),
            "{name}: {found:?}"
        );
    }
}

#[test]
fn both_conventions_give_one_surface() {
    let Some(root) = data(test_name!(), "paper/gl_dx") else {
        return;
    };
    let file = |kind: &str| root.join(format!("Paper001_1K-JPG_{kind}.jpg"));
    let y = |normal: &str, y| agreement(&file("Displacement"), &file(normal), y)[1];
    assert!(y("NormalGL", NormalY::Up) > 0.8);
    assert!(y("NormalDX", NormalY::Down) > 0.8);
    // Read the wrong way round.
    assert!(y("NormalDX", NormalY::Up) < -0.8);
    assert!(y("NormalGL", NormalY::Down) < -0.8);
}
