//! Small exhibits and their pictures, for tests that look at frames.

use std::{path::Path, sync::Arc};

use recto::{
    manifest::{Exhibit, exhibit::Scene},
    optics::tier::Tier,
    shot::{Darkroom, Picture},
    stage::Shown,
};
use tempfile::TempDir;

/// An exhibit in a folder of its own, gone with the value.
pub struct Fixture {
    pub folder: TempDir,
}

impl Fixture {
    /// A folder with this manifest; pictures are added by `fill`.
    pub fn new(manifest: &str, fill: impl FnOnce(&Path)) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("exhibit.toml"), manifest).expect("the manifest");
        fill(folder.path());
        Self { folder }
    }

    pub fn exhibit(&self) -> Arc<Exhibit> {
        match Exhibit::read(self.folder.path()) {
            Ok((exhibit, _)) => Arc::new(exhibit),
            Err(faults) => panic!("{faults}"),
        }
    }
}

/// A darkroom, or the line that installs a driver as the test's failure.
pub fn darkroom(anisotropy: u16) -> Darkroom {
    match Darkroom::new(anisotropy) {
        Ok(room) => room,
        Err(error) => panic!("{error}"),
    }
}

/// `scene` of `exhibit` at rest.
pub fn picture(
    room: &mut Darkroom,
    exhibit: &Arc<Exhibit>,
    scene: &Scene,
    tier: Tier,
    size: [u32; 2],
) -> Picture {
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let shown = Shown::at_rest(exhibit.clone(), scene.clone(), tier, aspect);
    match room.take(shown, size) {
        Ok(picture) => picture,
        Err(error) => panic!("{}: {error}", scene.id),
    }
}

/// Pixel in f64.
pub fn pixel(picture: &Picture, x: u32, y: u32) -> [f64; 3] {
    picture.pixels[(y * picture.width + x) as usize].map(f64::from)
}

/// Largest difference of any channel of any pixel.
pub fn largest_difference(a: &Picture, b: &Picture) -> f32 {
    assert_eq!(a.pixels.len(), b.pixels.len());
    a.pixels
        .iter()
        .flatten()
        .zip(b.pixels.iter().flatten())
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f32::max)
}

/// Mean of the green channel over a rectangle of pixels.
pub fn mean(picture: &Picture, [x_0, y_0]: [u32; 2], [x_1, y_1]: [u32; 2]) -> f64 {
    let mut sum = 0.0;
    for y in y_0..y_1 {
        for x in x_0..x_1 {
            sum += pixel(picture, x, y)[1];
        }
    }
    sum / f64::from((x_1 - x_0) * (y_1 - y_0))
}
