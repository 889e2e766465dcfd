//! Crops of the sample `landscape` that judge the tiers: where they are, in what light, and what
//! the walk found (`fixtures/crops.csv`, written by the test `bake`).

use std::path::PathBuf;

use recto::{
    manifest::{Exhibit, Scene, overrides::Overrides},
    reference::picture::Mode,
};

/// Edge of a crop in pixels: two for each texel of the maps at 300 dpi, edge on edge, so that
/// linear filtering at a pixel's middle is the mean over the pixel and nothing is judged here but
/// the light.
pub const EDGE: u32 = 32;
/// Width of a crop on the sheet in texels of its maps, 3366 of which are 285 mm.
const TEXELS: f64 = 16.0;

/// What is seen, and the middle of the crop in mm: underdrawing is lead point and a groove of the
/// stylus.
pub const CROPS: [(&str, [f64; 2]); 5] = [
    ("pen", [135.726_381, 77.989_524]),
    ("wash", [132.508_913, 111.183_763]),
    ("lead", [205.918_004, 148.103_885]),
    ("stylus", [111.087_344, 27.436_054]),
    ("paper", [229.540_998, 67.658_664]),
];

/// Scenes, by the lamp.
pub const LIGHTS: [(&str, &str); 3] = [
    (
        "zenithal",
        "kind=distant,lux_at_sheet=150,kelvin=6504,elevation_deg=90,azimuth_deg=0",
    ),
    (
        "raking",
        "kind=distant,lux_at_sheet=150,kelvin=6504,elevation_deg=10,azimuth_deg=180",
    ),
    ("light-table", "light-table"),
];

/// A quarter of a crop's pixels, spread evenly over it, are walked.
pub fn judged() -> Vec<[u32; 2]> {
    let all = (0..EDGE * EDGE).map(|i| [i % EDGE, i / EDGE]);
    all.filter(|[x, y]| (x + 2 * y) % 4 == 0).collect()
}

/// The sample, if its maps have been drawn.
pub fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/exhibits/landscape"))
}

/// A crop in a light.
pub fn scene(exhibit: Exhibit, [x, y]: [f64; 2], lamp: &str) -> (Exhibit, Scene) {
    let width = TEXELS * 285.0 / 3366.0;
    let overrides = Overrides {
        scene: Some("whole".to_owned()),
        lamps: vec![lamp.to_owned()],
        camera: Some(format!("centre_mm={x}x{y},width_mm={width}")),
        ..Overrides::default()
    };
    let applied = overrides.apply(exhibit, EDGE);
    let (exhibit, mut scene) = applied.unwrap_or_else(|faults| panic!("{faults}"));
    let sheet = exhibit.drawing_of(&scene).size_mm;
    scene.camera = scene.camera.fitted(sheet, 1.0);
    (exhibit, scene)
}

/// What the walk found in one crop, by [`judged`]: mean and variance per channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    pub light: String,
    pub crop: String,
    pub mode: String,
    pub pixels: Vec<[[f64; 3]; 2]>,
}

impl Truth {
    pub fn is(&self, light: &str, crop: &str, mode: Mode) -> bool {
        self.light == light && self.crop == crop && self.mode == mode.name()
    }
}

/// The columns of the fixture.
pub const HEADER: &str = "light,crop,mode,r,g,b,variance_r,variance_g,variance_b";

pub fn read(text: &str) -> Vec<Truth> {
    let mut truths: Vec<Truth> = Vec::new();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some(HEADER));
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let [light, crop, mode, values @ ..] = cells.as_slice() else {
            panic!("{line}");
        };
        let number = |i: usize| values[i].parse().expect("a number");
        let pixel = [0, 3].map(|from| [0, 1, 2].map(|c| number(from + c)));
        let same = |truth: &&mut Truth| {
            truth.light == *light && truth.crop == *crop && truth.mode == *mode
        };
        match truths.last_mut().filter(same) {
            Some(truth) => truth.pixels.push(pixel),
            None => truths.push(Truth {
                light: (*light).to_owned(),
                crop: (*crop).to_owned(),
                mode: (*mode).to_owned(),
                pixels: vec![pixel],
            }),
        }
    }
    truths
}
