//! Scenes that no tier and no prediction was tuned on, drawn by seed: a small sheet of bare paper
//! and five inks under one lamp. What the judge finds at each ink is baked.

use std::{
    collections::HashMap,
    f64::consts::{FRAC_1_SQRT_2, PI},
    fmt::Write as _,
    path::Path,
};

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use recto::{
    manifest::{Exhibit, exhibit::Scene, eye::Eye},
    maps::encode::save_exr_rgb,
    optics::lamp::{Light, Shape},
    reference::{
        Absorption, Estimate, Lamp, Layers, Lighting, Phase, radiance,
        rng::{self, Rng, uniform},
    },
};

/// How many scenes.
pub const COUNT: usize = 48;
const SEED: u64 = 20_240_611;
/// Fields of bare paper and ink on the sheet.
pub const FIELDS: usize = 6;
const COLUMNS: usize = 3;
/// Edge of a field in mm, and in texels.
const FIELD_MM: f64 = 20.0;
const FIELD_PX: usize = 16;
/// Pictures are small: the sheet is what is looked at.
pub const SIZE: [u32; 2] = [96, 64];
/// Channels of one walk: the fields' colours.
const CHANNELS: usize = 3 * FIELDS;
const BLOCKS: u64 = 16;
const N: f64 = 1.5;
/// Areas are walked through finer than any tier samples them.
const GRID: u32 = 4;
const RINGS: u32 = 2;

const BAKED: &str = include_str!("judged.csv");

/// What was drawn.
#[derive(Clone, Debug)]
pub struct Draw {
    pub name: String,
    alpha: f64,
    sigma_s: f64,
    thickness_mm: f64,
    sigma_a: [f64; 3],
    /// τ of each field; bare paper first.
    depths: [[f64; 3]; FIELDS],
    lamp: String,
    camera: String,
}

/// All of them.
pub fn draws() -> Vec<Draw> {
    (0..COUNT).map(draw).collect()
}

fn between(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * uniform(rng)
}

fn draw(i: usize) -> Draw {
    let rng = &mut rng::stream(SEED, i as u64);
    let yellow = between(rng, 1.1, 2.2);
    let red = (between(rng, 0.02f64.ln(), 0.2f64.ln())).exp();
    let mut depths = [[0.0; 3]; FIELDS];
    for depth in &mut depths[1..] {
        let green = between(rng, 0.05f64.ln(), 3.0f64.ln()).exp();
        let warm = between(rng, 0.8, 1.3);
        *depth = [green / warm, green, green * warm];
    }
    let elevation = between(rng, 5f64.ln(), 90f64.ln()).exp();
    let azimuth = between(rng, 0.0, 360.0);
    let kinds = [
        "distant",
        "point",
        "spot",
        "rectangle",
        "disc",
        "distant",
        "rectangle",
        "table",
    ];
    let kind = kinds[i % kinds.len()];
    let stand = format!("elevation_deg = {elevation:.3}\nazimuth_deg = {azimuth:.3}\n");
    let away = format!("distance_mm = {:.1}\n", between(rng, 150.0, 600.0));
    let lit = "lux_at_sheet = 500\n";
    let lamp = match kind {
        "distant" => format!("kind = \"distant\"\n{lit}{stand}"),
        "point" => format!("kind = \"point\"\n{lit}{stand}{away}"),
        "spot" => {
            format!("kind = \"spot\"\nhotspot_deg = 30\nfalloff_deg = 45\n{lit}{stand}{away}")
        }
        "rectangle" => format!(
            "kind = \"rectangle\"\nsize_mm = [{:.1}, {:.1}]\n{lit}{stand}{away}",
            between(rng, 20.0, 250.0),
            between(rng, 20.0, 120.0)
        ),
        "disc" => format!(
            "kind = \"disc\"\ndiameter_mm = {:.1}\n{lit}{stand}{away}",
            between(rng, 20.0, 200.0)
        ),
        _ => "kind = \"light-table\"\nnits = 1000\n".to_owned(),
    };
    // Most eyes look straight down, as a museum's do.
    let tilt = if i.is_multiple_of(3) {
        between(rng, 10.0, 60.0)
    } else {
        0.0
    };
    let eye = if i % 4 == 1 {
        "distance_mm = 250, "
    } else {
        ""
    };
    let camera = format!(
        "{{ centre_mm = [30, 20], width_mm = 60, {eye}tilt_deg = {tilt:.2}, turn_deg = {:.2} }}",
        between(rng, 0.0, 360.0)
    );
    Draw {
        name: format!("{i:02}-{kind}"),
        alpha: between(rng, 0.25, 0.7),
        sigma_s: between(rng, 50.0, 110.0),
        thickness_mm: between(rng, 0.1, 0.2),
        sigma_a: [red, red * yellow, red * yellow * yellow],
        depths,
        lamp,
        camera,
    }
}

impl Draw {
    fn layers(&self) -> Layers {
        Layers {
            n: N,
            alpha: [self.alpha; 2],
            sigma_s: self.sigma_s,
            phase: Phase::single(1.0 / 3.0),
            thickness_mm: self.thickness_mm,
        }
    }

    fn absorption(&self) -> [Absorption; CHANNELS] {
        std::array::from_fn(|i| Absorption {
            sigma_a: self.sigma_a[i % 3],
            tau_f: self.depths[i / 3][i % 3],
            tau_b: 0.0,
        })
    }

    /// All fields as an eye sees them along `v`, under `lamps` and a table.
    fn walked(&self, v: DVec3, lamps: &[(DVec3, DVec3)], table: DVec3, walks: u64) -> Vec<Seen> {
        let each = |colour: DVec3| std::array::from_fn(|i| colour[i % 3]);
        let lamps: Vec<Lamp<CHANNELS>> = lamps
            .iter()
            .map(|(direction, irradiance)| Lamp {
                direction: *direction,
                irradiance: each(*irradiance),
            })
            .collect();
        let lighting = Lighting {
            lamps: &lamps,
            table: each(table),
        };
        let (layers, absorption) = (self.layers(), self.absorption());
        let blocks: Vec<[Estimate; CHANNELS]> = (0..BLOCKS)
            .into_par_iter()
            .map(|block| {
                let mut rng = rng::stream(3, block);
                radiance(&layers, &absorption, v, &lighting, walks / BLOCKS, &mut rng)
            })
            .collect();
        let count = blocks.len() as f64;
        (0..FIELDS)
            .map(|field| {
                let sum = |of: &dyn Fn(&Estimate) -> f64| {
                    let channel = |c: usize| -> f64 {
                        blocks.iter().map(|block| of(&block[3 * field + c])).sum()
                    };
                    DVec3::new(channel(0), channel(1), channel(2))
                };
                Seen {
                    mean: sum(&|e| e.mean) / count,
                    variance: sum(&|e| e.variance) / (count * count),
                }
            })
            .collect()
    }

    /// The exhibit of this draw in `folder`, painted as it photographs.
    pub fn write(&self, folder: &Path, photographs: &[DVec3]) {
        let bare = photographs[0];
        let text = format!(
            "[[drawing]]\nid = \"sheet\"\nsize_mm = [60, 40]\n\
             paper = {{ kind = \"laid\", roughness = {:.6}, thickness_um = {:.3}, \
             scattering_per_mm = {:.4}, albedo = [{:.6}, {:.6}, {:.6}] }}\n\
             recto.albedo = {{ file = \"albedo.exr\", encoding = \"linear\" }}\n\
             [[lamp]]\nid = \"lamp\"\n{}\
             [[scene]]\nid = \"scene\"\nlamps = [\"lamp\"]\ncamera = {}\n",
            self.alpha,
            self.thickness_mm * 1000.0,
            self.sigma_s,
            bare.x,
            bare.y,
            bare.z,
            self.lamp,
            self.camera
        );
        std::fs::write(folder.join("exhibit.toml"), text).expect("the manifest");
        let (width, height) = (COLUMNS * FIELD_PX, FIELDS / COLUMNS * FIELD_PX);
        let pixels: Vec<[f32; 3]> = (0..width * height)
            .map(|i| {
                let (x, y) = (i % width / FIELD_PX, i / width / FIELD_PX);
                photographs[y * COLUMNS + x].as_vec3().to_array()
            })
            .collect();
        let path = folder.join("albedo.exr");
        save_exr_rgb(&path, width as u32, height as u32, &pixels).expect("the picture");
    }
}

/// A colour of the judge.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    pub mean: DVec3,
    pub variance: DVec3,
}

/// A field in the picture: its pixel, and the place on the table that the pixel's middle shows.
pub struct Target {
    pub field: usize,
    pub pixel: [u32; 2],
    pub at: DVec3,
}

/// The fields whose middles are in the picture.
pub fn targets(exhibit: &Exhibit, scene: &Scene) -> Vec<Target> {
    let size = exhibit.drawing_of(scene).size_mm;
    let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
    let eye = Eye::new(&scene.camera.fitted(size, aspect), size);
    let clip = eye.clip_from_table(aspect);
    (0..FIELDS)
        .filter_map(|field| {
            let (column, row) = ((field % COLUMNS) as f64, (field / COLUMNS) as f64);
            let at = DVec3::new(
                (column + 0.5) * FIELD_MM - size.x / 2.0,
                size.y / 2.0 - (row + 0.5) * FIELD_MM,
                0.0,
            );
            let seen = clip * at.extend(1.0);
            let seen = seen.truncate() / seen.w;
            let pixel = DVec2::new(seen.x + 1.0, 1.0 - seen.y)
                * 0.5
                * DVec2::new(SIZE[0].into(), SIZE[1].into());
            let inside = pixel.min_element() >= 0.0
                && pixel.x < f64::from(SIZE[0])
                && pixel.y < f64::from(SIZE[1]);
            let pixel = [pixel.x as u32, pixel.y as u32];
            let ndc = DVec2::new(
                (f64::from(pixel[0]) + 0.5) / f64::from(SIZE[0]) * 2.0 - 1.0,
                1.0 - (f64::from(pixel[1]) + 0.5) / f64::from(SIZE[1]) * 2.0,
            );
            let at = eye.table_point(ndc, aspect).filter(|_| inside)?;
            Some(Target { field, pixel, at })
        })
        .collect()
}

/// A lamp in many small ones: direction towards each, and illuminance facing it.
fn fine(light: &Light, at: DVec3) -> Vec<(DVec3, DVec3)> {
    let mut light = light.clone();
    match &mut light.shape {
        Shape::Rectangle { grid, .. } => *grid = (*grid).max(GRID),
        Shape::Disc { rings, .. } => *rings = (*rings).max(RINGS),
        _ => {}
    }
    let small = light.at(at).into_iter();
    small
        .filter(|incidence| incidence.e != DVec3::ZERO)
        .map(|incidence| (incidence.l, incidence.e))
        .collect()
}

/// Baked: photographs of the fields, and what is seen of them in the scene, by scene and field.
pub struct Judged(HashMap<(String, String), Seen>);

impl Judged {
    pub fn read() -> Self {
        let row = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            let [scene, what, numbers @ ..] = cells.as_slice() else {
                return None;
            };
            let numbers: Vec<f64> = numbers.iter().filter_map(|x| x.parse().ok()).collect();
            let seen = Seen {
                mean: DVec3::from_slice(numbers.get(..3)?),
                variance: DVec3::from_slice(numbers.get(3..)?),
            };
            Some((((*scene).to_owned(), (*what).to_owned()), seen))
        };
        Self(BAKED.lines().skip(1).filter_map(row).collect())
    }

    fn get(&self, scene: &str, what: String) -> Seen {
        *self
            .0
            .get(&(scene.to_owned(), what.clone()))
            .unwrap_or_else(|| panic!("not baked: {scene} {what}"))
    }

    pub fn photographs(&self, draw: &Draw) -> Vec<DVec3> {
        (0..FIELDS)
            .map(|field| self.get(&draw.name, format!("photograph {field}")).mean)
            .collect()
    }

    pub fn seen(&self, draw: &Draw, field: usize) -> Seen {
        self.get(&draw.name, format!("seen {field}"))
    }
}

/// Walks everything: the text of `judged.csv`.
pub fn bake(walks: u64) -> String {
    let mut text =
        String::from("scene,what,red,green,blue,variance_red,variance_green,variance_blue\n");
    for draw in draws() {
        let mut row = |what: String, seen: &Seen| {
            let numbers = [seen.mean.to_array(), seen.variance.to_array()].concat();
            let cells: Vec<String> = numbers.iter().map(|x| format!("{x:.6e}")).collect();
            writeln!(text, "{},{what},{}", draw.name, cells.join(",")).expect("a String");
        };
        let lamp = DVec3::new(FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2);
        let lit = DVec3::splat(PI / FRAC_1_SQRT_2);
        let photographs = draw.walked(DVec3::Z, &[(lamp, lit)], DVec3::ZERO, 2 * walks);
        for (field, seen) in photographs.iter().enumerate() {
            row(format!("photograph {field}"), seen);
        }
        let folder = tempfile::tempdir().expect("a temporary folder");
        let means: Vec<DVec3> = photographs.iter().map(|seen| seen.mean).collect();
        draw.write(folder.path(), &means);
        let (exhibit, _) = Exhibit::read(folder.path()).unwrap_or_else(|e| panic!("{e}"));
        let scene = &exhibit.scenes[0];
        let lighting = exhibit.lighting(scene);
        let size = exhibit.drawing_of(scene).size_mm;
        let eye = Eye::new(&scene.camera, size).place();
        for target in targets(&exhibit, scene) {
            let v = if eye.w > 0.0 {
                (eye.truncate() - target.at).normalize()
            } else {
                eye.truncate()
            };
            let lamps: Vec<(DVec3, DVec3)> = lighting
                .lights
                .iter()
                .flat_map(|light| fine(light, target.at))
                .collect();
            let all = draw.walked(v, &lamps, lighting.light_table, walks);
            row(format!("seen {}", target.field), &all[target.field]);
        }
    }
    text
}
