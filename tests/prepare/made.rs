//! A sheet whose media are known, photographed through the study tier itself: laid paper with iron-
//! gall ink, wash and red chalk on it, on a stand and on a light table.

use std::{
    f64::consts::PI,
    path::{Path, PathBuf},
};

use glam::{DQuat, DVec3};
use rand::{SeedableRng, rngs::Xoshiro256PlusPlus};
use rand_distr::{Distribution, Normal};
use rayon::prelude::*;
use recto::{
    maps::encode,
    optics::{
        bsdf::Specimen,
        ink::internal_reflectance,
        medium::{Matter, MediumId},
        through::{Seen, through_study},
        tier::Tier,
    },
    prepare::{self, PrepareError, Report, capture::Capture, lights},
};

use super::folder;

pub const WIDTH: usize = 240;
pub const HEIGHT: usize = 176;
/// What bare paper photographs as: what a specimen of ink lies on.
pub const PAPER: f64 = 0.8;
/// Of the full strength of a film.
const STRENGTHS: usize = 24;
/// Light through the clearest and the thickest paper, over the mean.
const LAID: f64 = 0.08;
const WATERMARK: f64 = 0.25;

/// What lies on a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lies {
    Paper,
    /// Shares of the film's full strength.
    Ink(f64),
    Wash(f64),
    /// The share that grains cover.
    Chalk(f64),
}

/// Names of the classes.
pub const MEDIA: [&str; 4] = ["bare-paper", "iron-gall-ink", "wash", "red-chalk"];

impl Lies {
    pub fn class(self) -> usize {
        match self {
            Self::Paper => 0,
            Self::Ink(_) => 1,
            Self::Wash(_) => 2,
            Self::Chalk(_) => 3,
        }
    }
}

/// Left, top, right and bottom edge of each class's swatch.
pub const SWATCHES: [[usize; 4]; 4] = [
    [8, 6, 56, 38],
    [66, 6, 114, 38],
    [124, 6, 172, 38],
    [182, 6, 230, 38],
];

/// What lies where.
pub fn lies(x: usize, y: usize) -> Lies {
    let (u, v) = (x as f64, y as f64);
    let strength = 0.75 + 0.3 * (u / 17.0).sin() * (v / 13.0).cos();
    let grain = 0.72 + 0.22 * ((u * 0.9).sin() * (v * 1.1).cos());
    for (class, [left, top, right, bottom]) in SWATCHES.iter().enumerate() {
        if (*left..*right).contains(&x) && (*top..*bottom).contains(&y) {
            return match class {
                1 => Lies::Ink(strength),
                2 => Lies::Wash(strength),
                3 => Lies::Chalk(grain),
                _ => Lies::Paper,
            };
        }
    }
    if y < 44 {
        return Lies::Paper;
    }
    // Strokes of the pen, some over washes, and hatching in chalk.
    if (x + 2 * y) % 37 < 5 && x < 150 {
        return Lies::Ink(strength);
    }
    let pool = (u - 70.0).powi(2) + (v - 110.0).powi(2);
    if pool < 2600.0 {
        return Lies::Wash(strength);
    }
    if x > 160 && (2 * x + y) % 29 < 12 {
        return Lies::Chalk(grain);
    }
    Lies::Paper
}

/// Slopes of the fibres and of what pen and brush left.
pub fn normal(x: usize, y: usize) -> DVec3 {
    let (u, v) = (x as f64, y as f64);
    let p = 0.10 * (u / 1.9 + 0.3 * v).sin() + 0.08 * (v / 2.7 - u / 5.1).cos();
    let q = 0.10 * (v / 2.1 + 0.2 * u).sin() + 0.07 * (u / 3.3 + v / 4.7).cos();
    DVec3::new(p, q, 1.0).normalize()
}

/// How much of the light paper passes, over the mean: laid lines and a watermark.
pub fn clear(x: usize, y: usize) -> f64 {
    let laid = LAID * (y as f64 * PI / 4.0).sin();
    let mark = (x as f64 - 120.0).hypot(y as f64 - 100.0);
    let mark = if (30.0..38.0).contains(&mark) {
        WATERMARK
    } else {
        0.0
    };
    1.0 + laid + mark
}

pub fn medium(name: &str) -> MediumId {
    name.parse().expect("a medium")
}

/// A film of this share of its full strength.
fn film(name: &str, share: f64) -> Specimen {
    let medium = medium(name).medium();
    let Matter::Film(constants) = medium.matter else {
        unreachable!("a film")
    };
    // The albedo of each channel at which its depth is the film's, by bisection: it only falls.
    let (mut low, mut high) = (DVec3::ZERO, DVec3::splat(PAPER));
    let mut specimen = Specimen::new(medium, high);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        specimen.surface.albedo = middle;
        let depth = specimen.depth();
        for c in 0..3 {
            if depth[c] > share * constants.depth[c] {
                low[c] = middle[c];
            } else {
                high[c] = middle[c];
            }
        }
    }
    specimen.surface.albedo = 0.5 * (low + high);
    specimen
}

pub struct Media {
    paper: Specimen,
    chalk: Specimen,
    inks: Vec<Specimen>,
    washes: Vec<Specimen>,
}

impl Media {
    pub fn new() -> Self {
        let paper = medium("laid");
        let chalk = medium("red-chalk").medium();
        let Matter::Particles(grains) = chalk.matter else {
            unreachable!("grains")
        };
        let films = |name: &str| -> Vec<Specimen> {
            (0..STRENGTHS)
                .into_par_iter()
                .map(|i| film(name, 1.2 * (i as f64 + 0.5) / STRENGTHS as f64))
                .collect()
        };
        Self {
            paper: Specimen::new(paper.medium(), DVec3::splat(PAPER)),
            chalk: Specimen::new(chalk, grains.albedo.into()),
            inks: films("iron-gall-ink"),
            washes: films("wash"),
        }
    }

    fn of(films: &[Specimen], share: f64) -> &Specimen {
        let i = (share / 1.2 * STRENGTHS as f64) as usize;
        &films[i.min(STRENGTHS - 1)]
    }

    /// π times the radiance straight up of a place under light that a perfect diffuser which
    /// faces it shows as 1.
    pub fn shown(&self, lies: Lies, normal: DVec3, l: DVec3) -> DVec3 {
        let upright = DQuat::from_rotation_arc(normal, DVec3::Z);
        let of = |specimen: &Specimen| {
            specimen.reflected(Tier::Study, upright * l, upright * DVec3::Z, 1.0)
        };
        let f = match lies {
            Lies::Paper => of(&self.paper),
            Lies::Ink(share) => of(Self::of(&self.inks, share)),
            Lies::Wash(share) => of(Self::of(&self.washes, share)),
            Lies::Chalk(covered) => of(&self.paper).lerp(of(&self.chalk), covered),
        };
        f * PI * normal.dot(l).max(0.0)
    }

    /// τ of the ink of a place.
    pub fn depth(&self, lies: Lies) -> DVec3 {
        match lies {
            Lies::Ink(share) => Self::of(&self.inks, share).depth(),
            Lies::Wash(share) => Self::of(&self.washes, share).depth(),
            _ => DVec3::ZERO,
        }
    }

    /// What a place photographs as at 45°/0°.
    pub fn albedo(&self, lies: Lies) -> DVec3 {
        match lies {
            Lies::Paper => self.paper.surface.albedo,
            Lies::Ink(share) => Self::of(&self.inks, share).surface.albedo,
            Lies::Wash(share) => Self::of(&self.washes, share).surface.albedo,
            Lies::Chalk(covered) => {
                let paper = self.paper.surface.albedo;
                paper.lerp(self.chalk.surface.albedo, covered)
            }
        }
    }

    /// Share of a light table's radiance that shows through.
    fn passes(&self, lies: Lies, clear: f64) -> DVec3 {
        let through = |specimen: &Specimen, depth: DVec3| {
            let film = &specimen.study.film;
            let shares = specimen.shares();
            let share = match depth == DVec3::ZERO {
                true => DVec3::ONE,
                false => shares.paper / specimen.study.bare,
            };
            let seen = Seen {
                depth_f: depth,
                clear,
                depth_b: DVec3::ZERO,
                rho_f: internal_reflectance(film, share),
                rho_b: internal_reflectance(film, DVec3::ONE),
            };
            let alpha = specimen.surface.alpha;
            let at = specimen.interface.at(1.0, alpha);
            let mean = specimen.interface.mean_at(alpha);
            let (study, eta) = (&specimen.study, specimen.surface.eta);
            through_study(
                film,
                &study.through,
                &seen,
                &at,
                &mean,
                specimen.path(1.0),
                eta,
            )
        };
        match lies {
            Lies::Paper => through(&self.paper, DVec3::ZERO),
            Lies::Ink(share) | Lies::Wash(share) => {
                let films = if lies.class() == 1 {
                    &self.inks
                } else {
                    &self.washes
                };
                let specimen = Self::of(films, share);
                through(specimen, specimen.depth())
            }
            Lies::Chalk(covered) => through(&self.paper, DVec3::ZERO) * (1.0 - covered),
        }
    }
}

/// A photographer's stand, with the sheet on it.
pub struct Stand {
    pub media: Media,
    lamps: Vec<DVec3>,
    folder: tempfile::TempDir,
}

impl Stand {
    /// Photographs the sheet.
    pub fn new() -> Self {
        let lamps = (0..8).map(|i| {
            let elevation = if i % 2 == 0 { 34.0 } else { 58.0 };
            lights::direction(45.0 * f64::from(i) + 10.0, elevation)
        });
        let stand = Self {
            media: Media::new(),
            lamps: lamps.collect(),
            folder: folder(),
        };
        for (i, l) in stand.lamps.iter().enumerate() {
            let shown = |x: usize, y: usize| 0.8 * stand.media.shown(lies(x, y), normal(x, y), *l);
            stand.save(&format!("recto-{i}.png"), shown);
            stand.save(&format!("grey-{i}.png"), |_, _| {
                DVec3::splat(0.8 * 0.5 * l.z)
            });
        }
        // The table is brighter in its middle.
        let table = |x: usize, y: usize| {
            let (u, v) = (
                x as f64 / WIDTH as f64 - 0.5,
                y as f64 / HEIGHT as f64 - 0.5,
            );
            0.9 * (1.0 - 0.5 * (u * u + v * v))
        };
        let through =
            |x: usize, y: usize| stand.media.passes(lies(x, y), clear(x, y)) * table(x, y);
        stand.save("table.png", |x, y| DVec3::splat(table(x, y)));
        stand.save("through.png", through);
        stand.save("bright.png", |x, y| through(x, y) * 12.0);
        stand.save("black.png", |_, _| DVec3::ZERO);
        stand
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes linear light with the noise of a camera.
    fn save(&self, name: &str, at: impl Fn(usize, usize) -> DVec3 + Sync) {
        let seed = name
            .bytes()
            .fold(7, |seed, byte| seed * 31 + u64::from(byte));
        let rows: Vec<Vec<[u16; 3]>> = (0..HEIGHT)
            .into_par_iter()
            .map(|y| {
                let mut random = Xoshiro256PlusPlus::seed_from_u64(seed + y as u64);
                let noise = Normal::new(0.0, 1.0).expect("a spread");
                let pixel = |x: usize| {
                    at(x, y).to_array().map(|v| {
                        // Of a camera that reads out 5e-4, and holds a quarter of a million photons.
                        let spread = (2.5e-7 + 4e-6 * v.max(0.0)).sqrt();
                        let seen = (v + spread * noise.sample(&mut random)).clamp(0.0, 1.0);
                        (seen * 65535.0).round() as u16
                    })
                };
                (0..WIDTH).map(pixel).collect()
            })
            .collect();
        let (w, h) = (WIDTH as u32, HEIGHT as u32);
        encode::save_png_rgb16(&self.path(name), w, h, &rows.concat(), None).expect("written");
    }

    /// The capture without swatches and light table.
    pub fn text(&self) -> String {
        let list = |name: &str| {
            let each = (0..self.lamps.len()).map(|i| format!("\"{name}-{i}.png\""));
            each.collect::<Vec<_>>().join(", ")
        };
        let [azimuths, elevations] = [0, 1].map(|k| {
            let each = self
                .lamps
                .iter()
                .map(|l| format!("{:?}", lights::angles(*l)[k]));
            each.collect::<Vec<_>>().join(", ")
        });
        format!(
            "id = \"sheet\"\nencoding = \"linear\"\nscale.mm_per_px = 0.1\n\
             [lamps]\nazimuth_deg = [{azimuths}]\nelevation_deg = [{elevations}]\n\
             flat_field = [{}]\ngrey_card = 0.5\n[recto]\nphotographs = [{}]\n",
            list("grey"),
            list("recto"),
        )
    }

    pub fn capture(&self, text: &str) -> Capture {
        let (capture, warnings) =
            Capture::parse(&self.path("capture.toml"), text).expect("a capture");
        assert!(warnings.is_empty(), "{warnings:?}");
        capture
    }

    pub fn prepare(&self, text: &str, out: &Path) -> Result<Report, PrepareError> {
        prepare::run(&self.capture(text), out, &mut |_| {})
    }
}

/// A swatch, as a capture file names it.
pub fn swatch(name: &str, [left, top, right, bottom]: [usize; 4]) -> String {
    format!("[[swatch]]\nmedium = \"{name}\"\nrect_px = [{left}, {top}, {right}, {bottom}]\n")
}

/// All four.
pub fn swatches() -> String {
    let each = MEDIA.iter().zip(SWATCHES);
    each.map(|(name, rect)| swatch(name, rect)).collect()
}
