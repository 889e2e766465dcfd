//! A view that was saved, rendered from the file, is the picture that was shown.

use std::{fs, sync::Arc};

use glam::DVec2;
use recto::{
    manifest::{Exhibit, Link, SaveAs},
    maps::encode::save_png_rgb8,
    optics::tier::Tier,
    visitor::{Hand, Intent, hand::Picture},
};

use crate::room::{self, Fixture};

const SIZE: [u32; 2] = [96, 60];
const ASPECT: f64 = 1.6;
/// Pictures of different views differ by more, in light relative to white, somewhere.
const VISIBLE: f32 = 0.05;

const MANIFEST: &str = r##"
[[drawing]]
id = "sheet"
size_mm = [200.0, 125.0]
recto.albedo = "recto.png"
verso.albedo = "verso.png"
[[drawing.state]]
id = "before"
recto.albedo = "verso.png"
[[drawing.overlay]]
id = "infrared"
kind = "picture"
file = "verso.png"

[[lamp]]
id = "left"
kind = "rectangle"
lux_at_sheet = 150
kelvin = 3000
elevation_deg = 35
azimuth_deg = 170
size_mm = [200, 100]

[[scene]]
id = "whole"
# A remark.
lamps = ["left"]
"##;

/// A picture that is nowhere alike.
fn draw(folder: &std::path::Path, name: &str, seed: u32) {
    const SIDE: [u32; 2] = [160, 100];
    let level = |k: u32| (k.wrapping_mul(2_654_435_761).rotate_left(11) ^ seed) as u8 | 64;
    let pixels: Vec<[u8; 3]> = (0..SIDE[0] * SIDE[1])
        .map(|k| [level(k / 8), level(k / 5), level(k / 3)])
        .collect();
    save_png_rgb8(&folder.join(name), SIDE[0], SIDE[1], &pixels, None).expect("a picture");
}

#[test]
fn a_saved_view_is_the_same_picture_to_the_last_bit() {
    let fixture = Fixture::new(MANIFEST, |folder| {
        draw(folder, "recto.png", 7);
        draw(folder, "verso.png", 91);
    });
    let mut room = room::darkroom(1);
    let picture = Picture {
        aspect: ASPECT,
        width_mm: 300.0,
        measured: true,
    };
    let zoom = Intent::Zoom {
        at: DVec2::new(0.3, 0.1),
        factor: 1.7,
    };
    let lamp = Intent::MoveLamp(DVec2::new(0.3, 0.2));
    let views: [&[Intent]; 4] = [
        &[],
        &[zoom, lamp, Intent::StepState(1)],
        &[lamp, Intent::StepOverlay, Intent::Opacity(-0.2)],
        &[zoom, Intent::Flip, Intent::RaiseLamp(20.0)],
    ];
    let mut shown = Vec::new();
    for (n, wishes) in views.into_iter().enumerate() {
        let mut hand = Hand::new(fixture.exhibit(), 0, Tier::Gallery, picture, true);
        for wish in wishes {
            hand.apply(*wish);
        }
        let mut at_rest = hand.shown();
        at_rest.both_sides = false;
        let seen = room.take(at_rest, SIZE).expect("a picture");

        let (exhibit, scene) = hand.view();
        let draft = exhibit.draft(&scene, SaveAs::Next("view"), &[]);
        let draft = draft.unwrap_or_else(|error| panic!("{error}"));
        draft.write().unwrap_or_else(|error| panic!("{error}"));
        let read = fixture.exhibit();
        let (_, saved) = read.scene(draft.id()).expect("the scene");
        let found = room::picture(&mut room, &read, saved, Tier::Gallery, SIZE);
        assert_eq!(room::largest_difference(&found, &seen), 0.0, "view {n}");

        let link = exhibit
            .link(&scene)
            .unwrap_or_else(|error| panic!("{error}"));
        let link = Link::read(&link).unwrap_or_else(|faults| panic!("{faults}"));
        let (linked, _) = Exhibit::read_with(fixture.folder.path(), Some(&link))
            .unwrap_or_else(|faults| panic!("{faults}"));
        let scene = linked.scenes.last().expect("the scene").clone();
        let found = room::picture(&mut room, &Arc::new(linked), &scene, Tier::Gallery, SIZE);
        assert_eq!(room::largest_difference(&found, &seen), 0.0, "link {n}");
        shown.push(seen);
    }
    for (n, one) in shown.iter().enumerate() {
        for other in &shown[..n] {
            assert!(room::largest_difference(one, other) > VISIBLE, "{n}");
        }
    }
    let text = fs::read_to_string(fixture.folder.path().join("exhibit.toml")).expect("text");
    assert!(text.contains("# A remark.\nlamps = [\"left\"]\n"), "{text}");
}
