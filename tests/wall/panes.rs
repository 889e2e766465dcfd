//! What displays are given of one picture over all of them: their own part, in their own values.

use std::sync::{Arc, Mutex};

use bevy::{
    asset::RenderAssetUsages,
    camera::RenderTarget,
    core_pipeline::tonemapping::Tonemapping,
    prelude::*,
    render::{
        render_resource::{Extent3d, TextureDimension, TextureFormat, TextureUsages},
        view::screenshot::{Screenshot, ScreenshotCaptured},
    },
};
use glam::DVec2;
use recto::{
    installation::{Display, PixelRect, Profile, Rect as WallRect, Wall, Windows},
    maps::{DisplayProfile, LATTICE_STEPS, Lattice},
    shot::Darkroom,
    wall::panes::{self, PaneMaterial, PanesPlugin},
};

/// Pixels of a display, which has as many mm.
const SIZE: u32 = 32;
/// Between them, in mm.
const BEZEL: u32 = 8;
/// Of 255: what rounding to 8 bits and half floats leaves.
const STEPS: f64 = 1.5;
const PATIENCE_FRAMES: usize = 200;

fn display(left: u32, profile: Profile) -> Display {
    let min = DVec2::new(f64::from(left), 0.0);
    Display {
        id: left.to_string(),
        on_wall: WallRect {
            min,
            max: min + f64::from(SIZE),
        },
        on_desktop: PixelRect {
            at: [left as i32, 0],
            size: [SIZE; 2],
        },
        monitor: None,
        machine: None,
        profile,
    }
}

fn measured() -> Profile {
    Profile::Measured {
        white_xy: [0.33, 0.34],
        gamma: 2.4,
        luminance_nits: None,
    }
}

/// Of a display whose channels act upon each other, in no order that curves could say.
fn table() -> Profile {
    let steps = LATTICE_STEPS;
    let values = (0..steps.pow(3)).map(|at| {
        let places = [at % steps, at / steps % steps, at / (steps * steps)];
        let [r, g, b] = places.map(|place| place as f32 / (steps - 1) as f32);
        [
            0.9 * r,
            0.1 + 0.7 * g * (1.0 - 0.3 * r),
            0.8 * (b * g).sqrt(),
        ]
    });
    Profile::Icc {
        path: "table.icc".into(),
        display: Box::new(DisplayProfile::Table(Lattice {
            values: values.collect(),
        })),
        luminance_nits: None,
    }
}

/// Two displays side by side; the first is sRGB's.
fn wall(second: Profile) -> Wall {
    Wall {
        displays: vec![display(0, Profile::Srgb), display(SIZE + BEZEL, second)],
        windows: Windows::Each,
        top_above_floor_mm: None,
    }
}

/// Light over the wall: red rises to the right, green downwards.
fn light(x: u32, y: u32, width: u32) -> [f32; 3] {
    let at = |k: u32, count: u32| (k as f32 + 0.5) / count as f32;
    [at(x, width), at(y, SIZE), 0.25]
}

fn image(size: [u32; 2], bytes: Vec<u8>, format: TextureFormat) -> Image {
    let extent = Extent3d {
        width: size[0],
        height: size[1],
        depth_or_array_layers: 1,
    };
    let usage = RenderAssetUsages::RENDER_WORLD;
    let mut image = Image::new(extent, TextureDimension::D2, bytes, format, usage);
    image.texture_descriptor.usage |= TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
    image
}

/// The values, as sRGB surfaces hold them, of display `k`.
fn shown(wall: &Wall, k: usize) -> Vec<u8> {
    let built = Darkroom::with(1, |app| {
        app.add_plugins(PanesPlugin);
    });
    let mut room = built.unwrap_or_else(|error| panic!("{error}"));
    let size = panes::picture_size(wall);
    let texels = (0..size.y).flat_map(|y| (0..size.x).map(move |x| (x, y)));
    let floats = texels.flat_map(|(x, y)| {
        let [r, g, b] = light(x, y, size.x);
        [r, g, b, 1.0]
    });
    let bytes = floats.flat_map(f32::to_le_bytes).collect();
    let taken: Arc<Mutex<Option<Vec<u8>>>> = Arc::default();
    let world = room.world();
    let mut images = world.resource_mut::<Assets<Image>>();
    let picture = images.add(image(size.into(), bytes, TextureFormat::Rgba32Float));
    let blank = vec![0; (SIZE * SIZE * 4) as usize];
    let target = images.add(image([SIZE; 2], blank, TextureFormat::Rgba8UnormSrgb));
    let windows = wall.layout();
    let pane = &windows[k].panes[0];
    let correction = wall.displays[k].profile.correction();
    let material = panes::material(&mut images, &picture, pane, &correction);
    let material = world.resource_mut::<Assets<PaneMaterial>>().add(material);
    let camera = (
        Camera2d,
        RenderTarget::Image(target.clone().into()),
        Tonemapping::None,
        Msaa::Off,
    );
    let camera = world.spawn(camera).id();
    panes::hang_on(&mut world.commands(), camera, &[(pane.clone(), material)]);
    world.flush();
    for _ in 0..4 {
        room.frame().unwrap_or_else(|error| panic!("{error}"));
    }
    let slot = taken.clone();
    room.world()
        .spawn(Screenshot::image(target))
        .observe(move |event: On<ScreenshotCaptured>| {
            *slot.lock().expect("nobody panicked") = event.image.data.clone();
        });
    for _ in 0..PATIENCE_FRAMES {
        room.frame().unwrap_or_else(|error| panic!("{error}"));
        if let Some(bytes) = taken.lock().expect("nobody panicked").take() {
            return bytes;
        }
    }
    panic!("no picture came back");
}

/// The largest difference, of 255, from what display `profile_of` is to show where display `k` hangs.
fn off(wall: &Wall, bytes: &[u8], k: usize, profile_of: usize) -> f64 {
    let correction = wall.displays[profile_of].profile.correction();
    let width = panes::picture_size(wall).x;
    let left = wall.displays[k].on_wall.min.x as u32;
    let pixels = (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y)));
    let errors = pixels.flat_map(|(x, y)| {
        let meant = correction.encode(light(left + x, y, width).map(f64::from));
        let at = ((y * SIZE + x) * 4) as usize;
        [0, 1, 2].map(|c| (meant[c] * 255.0 - f64::from(bytes[at + c])).abs())
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn each_display_shows_its_part_in_its_own_values() {
    for second in [measured(), table()] {
        let wall = wall(second);
        for k in 0..2 {
            let bytes = shown(&wall, k);
            let own = off(&wall, &bytes, k, k);
            assert!(own <= STEPS, "display {k}: {own} of 255");
            // Another place, and another display's values, are told apart.
            assert!(off(&wall, &bytes, 1 - k, k) > 10.0 * STEPS);
            assert!(off(&wall, &bytes, k, 1 - k) > 2.0 * STEPS);
        }
    }
}
