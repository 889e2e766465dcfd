//! A glossy ball that is found by itself: in real photographs, and in made ones that must be told.

use std::{
    fs,
    path::{Path, PathBuf},
};

use glam::{DVec2, DVec3};
use rand::{RngExt, SeedableRng, rngs::Xoshiro256PlusPlus};
use recto::{
    maps::{self, encode},
    prepare::{
        PrepareError,
        capture::{Capture, Circle},
        find::{self, FoundLamps},
        lights::{self, ball::NoBall, direction},
        stereo::Standing,
    },
};

use super::{folder, support::data};
use crate::test_name;

/// How far lamps may be from where they are, in degrees.
const LAMP_DEG: f64 = 0.2;

fn found(
    folder: &Path,
    photographs: &[PathBuf],
    circle: Option<Circle>,
) -> Result<FoundLamps, PrepareError> {
    let list: Vec<String> = photographs.iter().map(|path| format!("{path:?}")).collect();
    let circle = circle.map_or(String::new(), |circle| {
        let Circle { centre, radius } = circle;
        format!("circle_px = [{}, {}, {radius}]", centre.x, centre.y)
    });
    let text = format!(
        "id = \"ball\"\nencoding = \"srgb\"\nscale.mm_per_px = 0.1\n[lamps.sphere]\n{circle}\n\
         [recto]\nphotographs = [{}]\n",
        list.join(", ")
    );
    let (capture, _) = Capture::parse(&folder.join("capture.toml"), &text).expect("a capture");
    find::lamps(&capture, folder)
}

fn lamps(found: &FoundLamps) -> &[DVec3] {
    let (Standing::Far(lamps) | Standing::Near(lamps)) = &found.standing;
    lamps
}

fn worst_deg(found: &[DVec3], wanted: &[DVec3]) -> f64 {
    assert_eq!(found.len(), wanted.len());
    let off = found.iter().zip(wanted).map(|(f, w)| f.angle_between(*w));
    off.fold(0.0, f64::max).to_degrees()
}

fn numbers(path: &Path) -> Vec<f64> {
    let text = fs::read_to_string(path).expect("numbers");
    text.split_whitespace()
        .map(|word| word.parse().expect("a number"))
        .collect()
}

/// How far lamps may be from those that the probes' makers found with circles which they marked by
/// hand: their marks scatter by 1.5 pixels around them, and one pixel is 0.27°.
const MARKED_DEG: f64 = 0.6;

#[test]
fn the_probes_outlines_are_found() {
    let Some(root) = data(test_name!(), "psbox") else {
        return;
    };
    let scratch = folder();
    let mut of_probes = Vec::new();
    for probe in ["LightProbe-1", "LightProbe-2"] {
        let of = root.join(probe);
        let photographs: Vec<PathBuf> = (1..=12)
            .map(|i| of.join(format!("Image_{i:02}.JPG")))
            .collect();
        let found = found(scratch.path(), &photographs, None).expect("a ball");
        let marked = numbers(&of.join("circle_data.txt"));
        let [_, height] = maps::probe(&photographs[0]).expect("a picture").size;
        let centre = DVec2::new(marked[0] - 0.5, f64::from(height) + 0.5 - marked[1]);
        let circle = found.circle.expect("a circle");
        let wanted = numbers(&of.join("light_directions.txt"));
        let wanted: Vec<DVec3> = (0..12)
            .map(|i| DVec3::new(wanted[i], wanted[12 + i], wanted[24 + i]).normalize())
            .collect();
        let off = worst_deg(lamps(&found), &wanted);
        eprintln!(
            "{probe}: {circle:?} for {centre} {}; lamps off by {off:.3}°",
            marked[2],
        );
        of_probes.push((lamps(&found).to_vec(), wanted, off));
    }
    // Both probes saw the same lamps, nearly: the farther apart they stood, the more they differ,
    // but no more than by the circles that were marked.
    let [(a, marked_a, off_a), (b, marked_b, off_b)] = &of_probes[..] else {
        unreachable!();
    };
    let mean_deg = |a: &[DVec3], b: &[DVec3]| {
        let off = a
            .iter()
            .zip(b)
            .map(|(a, b)| a.angle_between(*b).to_degrees());
        off.sum::<f64>() / a.len() as f64
    };
    let (found, marked) = (mean_deg(a, b), mean_deg(marked_a, marked_b));
    eprintln!("from probe to probe: found {found:.3}°, marked {marked:.3}°");
    assert!(off_a.max(*off_b) < MARKED_DEG, "{off_a}° {off_b}°");
    assert!(found < marked, "{found}° {marked}°");
}

/// Photographs of balls in front of something.
struct Scene {
    size: [u32; 2],
    balls: Vec<Circle>,
    /// Of the ground, and of the ball where it mirrors no lamp, as encoded.
    ground: f64,
    body: f64,
    noise: f64,
    glossy: bool,
    /// Of the ball that is hidden by its stand, from below, in radii.
    stand: f64,
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            size: [640, 480],
            balls: vec![circle(300.3, 220.7, 91.4)],
            ground: 0.5,
            body: 0.12,
            noise: 0.01,
            glossy: true,
            stand: 0.0,
        }
    }
}

fn circle(x: f64, y: f64, radius: f64) -> Circle {
    Circle {
        centre: DVec2::new(x, y),
        radius,
    }
}

fn around() -> Vec<DVec3> {
    (0..6)
        .map(|i| direction(60.0 * f64::from(i) + 7.0, 35.0 + 5.0 * f64::from(i % 3)))
        .collect()
}

impl Scene {
    /// Encoded grey of a place under a lamp.
    fn at(&self, at: DVec2, l: DVec3) -> f64 {
        // The ground is shaded, and differently by each lamp.
        let shade = 1.0 + 0.2 * (l.x * (at.x / 640.0 - 0.5) - l.y * (at.y / 480.0 - 0.5));
        for Circle { centre, radius } in &self.balls {
            let d = (at - *centre) / *radius;
            let square = d.length_squared();
            if square < 1.0 && d.y < 1.0 - self.stand {
                let n = DVec3::new(d.x, -d.y, (1.0 - square).sqrt());
                let mirrored = 2.0 * n.z * n - DVec3::Z;
                let off = mirrored.angle_between(l);
                return match self.glossy {
                    // A lamp, and the room, brighter above.
                    true if off < 0.06 => 1.0,
                    true => self.body * (1.0 + 0.4 * mirrored.y),
                    false => 0.75 * n.dot(l).max(0.0).sqrt(),
                };
            }
        }
        self.ground * shade
    }

    fn photographs(&self, folder: &Path) -> Vec<PathBuf> {
        const SUB: u32 = 4;
        let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
        let [width, height] = self.size;
        let each = around().into_iter().enumerate().map(|(i, l)| {
            let pixels: Vec<u8> = (0..width * height)
                .map(|p| {
                    let corner = DVec2::new(f64::from(p % width), f64::from(p / width));
                    // The outline alone has to be smooth.
                    let is_edge =
                        |ball: &Circle| (corner.distance(ball.centre) - ball.radius).abs() < 3.0;
                    let sub = if self.balls.iter().any(is_edge) {
                        SUB
                    } else {
                        1
                    };
                    let sum: f64 = (0..sub * sub)
                        .map(|s| {
                            let by = DVec2::new(f64::from(s % sub), f64::from(s / sub)) + 0.5;
                            self.at(corner + by / f64::from(sub), l)
                        })
                        .sum();
                    let noise = self.noise * (random.random::<f64>() - 0.5) * 12f64.sqrt();
                    ((sum / f64::from(sub * sub) + noise).clamp(0.0, 1.0) * 255.0).round() as u8
                })
                .collect();
            let path = folder.join(format!("ball-{i}.png"));
            encode::save_png_grey8(&path, width, height, &pixels, None).expect("written");
            path
        });
        each.collect()
    }

    fn found(&self) -> Result<FoundLamps, PrepareError> {
        let folder = folder();
        let photographs = self.photographs(folder.path());
        found(folder.path(), &photographs, None)
    }

    fn is_found(&self) {
        let folder = folder();
        let photographs = self.photographs(folder.path());
        let found = super::ball::found(folder.path(), &photographs, None).expect("a ball");
        let circle = found.circle.expect("a circle");
        let truth = self.balls[0];
        let (off, radius) = (
            circle.centre.distance(truth.centre),
            circle.radius - truth.radius,
        );
        // What a highlight is found to in this few pixels, apart.
        let given = super::ball::found(folder.path(), &photographs, Some(truth)).expect("lamps");
        let lamps_off = worst_deg(lamps(&found), lamps(&given));
        eprintln!("centre off by {off:.3}, radius by {radius:.3}, lamps by {lamps_off:.3}°");
        assert!(
            lamps_off < LAMP_DEG,
            "{circle:?}: {off} {radius} {lamps_off}°"
        );
        // A pixel of the highlight's place is up to 2.6° on the smallest of these balls.
        assert!(worst_deg(lamps(&found), &around()) < 3.0);
    }

    fn why(&self) -> NoBall {
        match self.found() {
            Err(error @ PrepareError::NoBall { why, .. }) => {
                let told = error.to_string();
                assert!(
                    told.contains("ball-0.png") && told.contains("circle_px"),
                    "{told}"
                );
                why
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn balls_are_found_where_they_are() {
    Scene::default().is_found();
    // Dark on dark, in noise.
    Scene {
        ground: 0.10,
        body: 0.05,
        noise: 0.02,
        ..Scene::default()
    }
    .is_found();
    // On a stand that hides its foot, brighter than the ground.
    Scene {
        ground: 0.1,
        body: 0.3,
        stand: 0.25,
        ..Scene::default()
    }
    .is_found();
    // Small in the corner of a larger picture.
    Scene {
        size: [1500, 1000],
        balls: vec![circle(1400.2, 901.9, 44.7)],
        ..Scene::default()
    }
    .is_found();
    // Nearly as large as the picture.
    Scene {
        balls: vec![circle(318.8, 240.2, 234.1)],
        ..Scene::default()
    }
    .is_found();
}

#[test]
fn what_is_no_ball_or_not_one_is_told() {
    let none = Scene {
        balls: Vec::new(),
        ..Scene::default()
    };
    assert_eq!(none.why(), NoBall::None);
    let noise = Scene { noise: 0.3, ..none };
    assert_eq!(noise.why(), NoBall::None);
    // Matte.
    let dull = Scene {
        glossy: false,
        ..Scene::default()
    };
    assert!(matches!(dull.why(), NoBall::Dull(_)), "{:?}", dull.why());
    let two = Scene {
        balls: vec![circle(180.0, 220.0, 90.0), circle(450.0, 240.0, 80.0)],
        ..Scene::default()
    };
    let NoBall::Several(one, other) = two.why() else {
        panic!("{:?}", two.why());
    };
    let mut found = [one.centre.x, other.centre.x];
    found.sort_by(f64::total_cmp);
    assert!((found[0] - 180.0).abs() < 5.0 && (found[1] - 450.0).abs() < 5.0);
    for [x, y] in [[40.0, 220.0], [300.0, 430.0], [600.0, 60.0], [-10.0, 220.0]] {
        let outside = Scene {
            balls: vec![circle(x, y, 90.0)],
            ..Scene::default()
        };
        assert!(
            matches!(outside.why(), NoBall::Outside(_)),
            "{x}, {y}: {:?}",
            outside.why()
        );
    }
}

#[test]
fn a_circle_that_was_written_is_taken() {
    let scene = Scene::default();
    let folder = folder();
    let photographs = scene.photographs(folder.path());
    let written = circle(301.0, 220.0, 90.0);
    let found = found(folder.path(), &photographs, Some(written)).expect("lamps");
    assert_eq!(found.circle, Some(written));
    assert!(lights::spread(lamps(&found)).is_ok());
}
