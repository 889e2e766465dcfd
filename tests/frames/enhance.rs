//! Enhancement: what it does to a picture, and that every picture says so.

use std::sync::Arc;

use glam::DVec2;
use recto::{
    manifest::{Exhibit, Scene, exhibit::Enhancement},
    optics::tier::Tier,
    shot::{Darkroom, Picture},
};

use crate::{crop, room};

const SIZE: [u32; 2] = [64, 48];
/// Of an 8-bit display.
const STEP: f32 = 1.0 / 255.0;

struct Enhanced {
    room: Darkroom,
    exhibit: Arc<Exhibit>,
    scene: Scene,
}

impl Enhanced {
    fn new(scene: &str) -> Self {
        let (exhibit, _) =
            Exhibit::read(&crop::folder()).unwrap_or_else(|faults| panic!("{faults}"));
        Self {
            room: room::darkroom(1),
            scene: exhibit.scene(scene).expect("a scene").1.clone(),
            exhibit: Arc::new(exhibit),
        }
    }

    fn picture(&mut self, enhance: Enhancement) -> Picture {
        let scene = Scene {
            enhance,
            ..self.scene.clone()
        };
        room::picture(&mut self.room, &self.exhibit, &scene, Tier::Gallery, SIZE)
    }
}

fn is_marked(picture: &Picture) -> bool {
    picture.legend.iter().any(|texel| texel[3] > 0.0)
}

#[test]
fn contrast_is_stretched_between_two_levels() {
    let mut enhanced = Enhanced::new("two-inks");
    let plain = enhanced.picture(Enhancement::default());
    let level = enhanced.scene.exposure.level as f32;
    let stretched = |[low, high]: [f32; 2]| {
        let mut picture = plain.clone();
        for light in &mut picture.pixels {
            *light = light.map(|v| ((v * level - low) / (high - low) / level).max(0.0));
        }
        picture
    };
    let found = enhanced.picture(Enhancement {
        stretch: Some(DVec2::new(0.2, 0.7)),
        ..Enhancement::default()
    });
    assert!(room::largest_difference(&found, &stretched([0.2, 0.7])) < STEP);
    assert!(room::largest_difference(&found, &stretched([0.2, 0.75])) > STEP);
    assert!(is_marked(&found) && !is_marked(&plain));
}

#[test]
fn sharpening_is_as_published() {
    let mut enhanced = Enhanced::new("two-inks");
    let plain = enhanced.picture(Enhancement::default());
    let level = enhanced.scene.exposure.level as f32;
    let sharpened = |sharpen: f32| {
        let [width, height] = SIZE.map(|n| n as i32);
        let at = |x: i32, y: i32, c: usize| {
            let (x, y) = (x.clamp(0, width - 1), y.clamp(0, height - 1));
            (plain.pixels[(y * width + x) as usize][c] * level).clamp(0.0, 1.0)
        };
        let mut picture = plain.clone();
        for y in 0..height {
            for x in 0..width {
                for c in 0..3 {
                    let beside =
                        [(0, -1), (-1, 0), (1, 0), (0, 1)].map(|(u, v)| at(x + u, y + v, c));
                    let middle = at(x, y, c);
                    let low = beside.iter().fold(middle, |a, b| a.min(*b));
                    let high = beside.iter().fold(middle, |a, b| a.max(*b));
                    let room = (low.min(1.0 - high) / high.max(1e-4)).clamp(0.0, 1.0);
                    let weight = -room.sqrt() / (8.0 - 3.0 * sharpen);
                    let sum: f32 = beside.iter().sum();
                    let seen = (sum * weight + middle) / (1.0 + 4.0 * weight);
                    picture.pixels[(y * width + x) as usize][c] = seen.clamp(0.0, 1.0) / level;
                }
            }
        }
        picture
    };
    let found = enhanced.picture(Enhancement {
        sharpen: 0.8,
        ..Enhancement::default()
    });
    assert!(room::largest_difference(&found, &sharpened(0.8)) < STEP);
    assert!(room::largest_difference(&found, &sharpened(0.2)) > STEP);
    assert!(is_marked(&found));
}

#[test]
fn relief_only_has_no_colour_and_steeper_relief_more_contrast() {
    // Under a high lamp, light goes with the slope; a raking one leaves half of each groove dark.
    let mut enhanced = Enhanced::new("two-inks");
    let plain = enhanced.picture(Enhancement::default());
    // All of one colour: green over red is the same wherever there is light.
    let spread = |picture: &Picture| {
        let shares = picture.pixels.iter().filter(|light| light[0] > 0.05);
        let shares: Vec<f32> = shares.map(|light| light[1] / light[0]).collect();
        let ends = |f: fn(f32, f32) -> f32, from: f32| shares.iter().copied().fold(from, f);
        ends(f32::max, 0.0) - ends(f32::min, 9.0)
    };
    let contrast = |picture: &Picture| {
        let light: Vec<f64> = picture.pixels.iter().map(|l| f64::from(l[1])).collect();
        let mean = light.iter().sum::<f64>() / light.len() as f64;
        let variance = light.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / light.len() as f64;
        variance.sqrt() / mean
    };
    let once = enhanced.picture(Enhancement {
        relief_only: true,
        ..Enhancement::default()
    });
    assert!(
        spread(&once) < 0.1 * spread(&plain),
        "{} {}",
        spread(&once),
        spread(&plain)
    );
    // So near that a pixel is no wider than the relief: from afar the sheet's own bend is seen.
    enhanced.scene.camera.centre_mm = DVec2::new(140.0, 60.0);
    enhanced.scene.camera.width_mm = 8.0;
    let [once_near, twice] = [1.0, 2.0].map(|exaggerate| {
        enhanced.picture(Enhancement {
            relief_only: true,
            exaggerate,
            ..Enhancement::default()
        })
    });
    let more = contrast(&twice) / contrast(&once_near);
    assert!((1.7..2.3).contains(&more), "{more}");
    assert!(is_marked(&once) && is_marked(&twice));
}
