//! Something changes while people look: at no frame is the table empty.

use std::sync::{Arc, Mutex};

use bevy::{
    camera::RenderTarget,
    prelude::*,
    render::view::screenshot::{Screenshot, ScreenshotCaptured},
};
use recto::{
    manifest::exhibit::Scene,
    maps::encode::save_png_rgb8,
    optics::tier::Tier,
    shot::Darkroom,
    stage::{Library, Shown, TABLE, composite::PictureCamera},
};

use crate::room::{Fixture, darkroom};

const SIZE: [u32; 2] = [48, 32];
/// Frames that are looked at after a change.
const LOOKS: usize = 6;

const MANIFEST: &str = r#"
[[drawing]]
id = "sheet"
size_mm = [96, 64]
recto.albedo = "recto.png"
[[drawing.state]]
id = "before"
title = { en = "Before" }
recto.albedo = "before.png"
[[lamp]]
id = "above"
kind = "distant"
lux_at_sheet = 500
elevation_deg = 60
azimuth_deg = 0
[[scene]]
id = "now"
lamps = ["above"]
camera = { width_mm = 192 }
[[scene]]
id = "before"
state = "before"
lamps = ["above"]
camera = { width_mm = 192 }
"#;

/// The share of the picture that is not the bare table, in each of the frames after a change.
fn seen(room: &mut Darkroom, change: impl FnOnce(&mut Shown)) -> Vec<f64> {
    change(&mut room.world().resource_mut::<Shown>());
    let world = room.world();
    let mut cameras = world.query_filtered::<&RenderTarget, With<PictureCamera>>();
    let target = cameras.single(world).expect("a camera").clone();
    let RenderTarget::Image(target) = target else {
        panic!("a picture is drawn into an image");
    };
    let taken: Arc<Mutex<Vec<(usize, f64)>>> = Arc::default();
    for look in 0..LOOKS {
        room.world().resource_mut::<Library>().wait();
        let taken = taken.clone();
        room.world()
            .spawn(Screenshot::image(target.handle.clone()))
            .observe(move |event: On<ScreenshotCaptured>| {
                let bytes = event.image.data.as_deref().expect("texels");
                let texels = bytes.chunks_exact(16);
                let count = texels.len() as f64;
                let is_sheet = |texel: &&[u8]| {
                    let red = texel[..4].try_into().expect("four bytes");
                    (f32::from_le_bytes(red) - TABLE).abs() > 1e-4
                };
                let sheet = texels.filter(is_sheet).count() as f64;
                taken
                    .lock()
                    .expect("nobody panicked")
                    .push((look, sheet / count));
            });
        room.frame().unwrap_or_else(|error| panic!("{error}"));
    }
    for _ in 0..200 {
        if taken.lock().expect("nobody panicked").len() == LOOKS {
            break;
        }
        room.frame().unwrap_or_else(|error| panic!("{error}"));
    }
    let mut taken = taken.lock().expect("nobody panicked").clone();
    taken.sort_by_key(|(look, _)| *look);
    taken.into_iter().map(|(_, share)| share).collect()
}

#[test]
fn a_sheet_stays_in_sight_while_its_tier_or_state_changes() {
    let fixture = Fixture::new(MANIFEST, |folder| {
        for (name, grey) in [("recto.png", 200), ("before.png", 150)] {
            let pixels = [[grey; 3]; 96 * 64];
            save_png_rgb8(&folder.join(name), 96, 64, &pixels, None).expect("a picture");
        }
    });
    let exhibit = fixture.exhibit();
    let scene = |k: usize| -> Scene { exhibit.scenes[k].clone() };
    let mut room = darkroom(1);
    let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
    let shown = Shown::at_rest(exhibit.clone(), scene(0), Tier::Draft, aspect);
    room.arrange(shown, SIZE)
        .unwrap_or_else(|error| panic!("{error}"));
    // Half of the picture's width and of its height.
    let near = |share: &f64| (share - 0.25).abs() < 0.05;
    for tier in [Tier::Study, Tier::Gallery, Tier::Draft, Tier::Study] {
        let shares = seen(&mut room, |shown| shown.tier = tier);
        assert!(
            shares.len() == LOOKS && shares.iter().all(near),
            "{tier:?}: {shares:?}"
        );
    }
    for k in [1, 0, 1] {
        let shares = seen(&mut room, |shown| shown.scene = scene(k));
        assert!(
            shares.len() == LOOKS && shares.iter().all(near),
            "scene {k}: {shares:?}"
        );
    }
}
