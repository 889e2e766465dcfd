//! What the judge finds of each subject, by random walks in f64: baked into `judged.csv`, which is
//! part of the program, so that tiers are judged in no time.
//!
//! The walks know nothing of the tiers. They are baked anew, in minutes, where a subject, the
//! reference or a constant of the catalogue changes:
//! `cargo test --release --test tradeoff -- --ignored bake`

use std::{collections::HashMap, f64::consts::PI, fmt::Write, sync::LazyLock};

use glam::{DQuat, DVec3};
use rayon::prelude::*;

use super::subject::{CAPTURE, Lit, SUBJECTS, Subject, View};
use crate::{
    optics::{fresnel::fresnel_conductor, medium::ParticleConstants},
    reference::{
        Absorption, Capture, Estimate, Lamp, Layers, Lighting,
        interface::Interface,
        radiance,
        rng::{self, Rng},
    },
};

const TEXT: &str = include_str!("judged.csv");
/// Its first line.
const HEADER: &str = "subject,what,red,green,blue,variance_red,variance_green,variance_blue";
const COLUMNS: usize = 8;

/// Views that share their walks: lamps times colours.
const CHANNELS: usize = 63;
/// Independent parts of each estimate, shared out over cores.
const BLOCKS: u64 = 16;
/// Paths that find the paper's absorption.
const CAPTURE_PATHS: u64 = 1 << 17;

/// A colour with its variance; π times a radiance at unit illuminance, or the share of a table's
/// radiance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Colour {
    pub mean: DVec3,
    pub variance: DVec3,
}

/// What the judge says of a subject.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judged {
    /// Its bare paper in the geometry of capture.
    pub bare: Colour,
    /// The spot there.
    pub photograph: Colour,
    /// The back of the sheet there, and the back without its ink.
    pub back: Colour,
    /// Each of [`Subject::views`].
    pub views: Vec<Colour>,
}

static JUDGED: LazyLock<HashMap<&'static str, Judged>> = LazyLock::new(|| read(TEXT));

impl Judged {
    /// Of `subject`; empty where it has not been baked, which a test would find.
    pub fn of(subject: &Subject) -> Self {
        JUDGED.get(subject.name).cloned().unwrap_or_default()
    }
}

fn read(text: &'static str) -> HashMap<&'static str, Judged> {
    let mut all: HashMap<&str, Judged> = HashMap::new();
    for line in text.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let [subject, what, numbers @ ..] = cells.as_slice() else {
            continue;
        };
        let numbers: Vec<f64> = numbers
            .iter()
            .filter_map(|cell| cell.parse().ok())
            .collect();
        if numbers.len() != COLUMNS - 2 {
            continue;
        }
        let colour = Colour {
            mean: DVec3::from_slice(&numbers),
            variance: DVec3::from_slice(&numbers[3..]),
        };
        let judged = all.entry(subject).or_default();
        match *what {
            "bare" => judged.bare = colour,
            "photograph" => judged.photograph = colour,
            "back" => judged.back = colour,
            _ => judged.views.push(colour),
        }
    }
    all
}

/// Walks everything: the text of `judged.csv`, with `samples` walks for each eye.
pub fn bake(samples: u64) -> String {
    let mut text = format!("{HEADER}\n");
    // By the paper, which most subjects share.
    let mut absorptions = HashMap::new();
    for subject in &SUBJECTS {
        let sigma_a = *absorptions
            .entry(subject.paper())
            .or_insert_with(|| absorption(subject));
        let walker = Walker { subject, sigma_a };
        let mut row = |what: &str, colour: &Colour| {
            let numbers = [colour.mean.to_array(), colour.variance.to_array()].concat();
            let mut cells = format!("{},{what}", subject.name);
            for number in numbers {
                // A String takes everything.
                let _ = write!(cells, ",{number:.6e}");
            }
            text += &cells;
            text.push('\n');
        };
        row("bare", &walker.one(Spot::Bare, &CAPTURE, samples));
        row("photograph", &walker.one(Spot::Whole, &CAPTURE, samples));
        row("back", &walker.one(Spot::Back, &CAPTURE, samples));
        for (i, colour) in walker.all(&subject.views(), samples).iter().enumerate() {
            row(&i.to_string(), colour);
        }
    }
    text
}

/// What is walked through.
#[derive(Clone, Copy, PartialEq)]
enum Spot {
    Bare,
    Whole,
    /// The sheet turned over.
    Back,
}

/// A sheet with its absorption found.
struct Walker<'s> {
    subject: &'s Subject,
    sigma_a: [f64; 3],
}

/// σa of the paper that photographs as the catalogue says.
fn absorption(subject: &Subject) -> [f64; 3] {
    let layers = subject.on_whole_sheet().layers(subject.bare_alpha());
    let capture = Capture::new(&layers, CAPTURE_PATHS, 1);
    subject
        .bare()
        .map(|albedo| capture.solve_sigma_a(albedo).value)
}

impl Walker<'_> {
    fn absorption(&self, spot: Spot) -> [Absorption; 3] {
        let (mut front, mut back) = (self.subject.depth(), self.subject.depth_behind());
        match spot {
            Spot::Bare => (front, back) = ([0.0; 3], [0.0; 3]),
            Spot::Whole => {}
            Spot::Back => std::mem::swap(&mut front, &mut back),
        }
        // A photographer lays the sheet on something dark; what is on its back is not seen.
        std::array::from_fn(|c| Absorption {
            sigma_a: self.sigma_a[c],
            tau_f: front[c],
            tau_b: if spot == Spot::Whole { back[c] } else { 0.0 },
        })
    }

    fn layers(&self, spot: Spot) -> Layers {
        let alpha = match spot {
            Spot::Bare => self.subject.bare_alpha(),
            Spot::Back if self.subject.depth_behind() == [0.0; 3] => self.subject.bare_alpha(),
            Spot::Whole | Spot::Back => self.subject.alpha(),
        };
        self.subject.layers(alpha)
    }

    /// A sheet lit from the front; the photograph does not see the ink of the back.
    fn one(&self, spot: Spot, view: &View, samples: u64) -> Colour {
        let mut absorption = self.absorption(spot);
        if spot == Spot::Whole {
            for channel in &mut absorption {
                channel.tau_b = 0.0;
            }
        }
        self.colours(
            &self.layers(spot),
            &absorption,
            &[*view],
            [0.0; 3],
            spot,
            samples,
        )[0]
    }

    /// All views, those of one eye with the same walks.
    fn all(&self, views: &[View], samples: u64) -> Vec<Colour> {
        let (layers, absorption) = (self.layers(Spot::Whole), self.absorption(Spot::Whole));
        let table = match self.subject.lit {
            Lit::Table => [1.0; 3],
            Lit::Lamps | Lit::Raking => [0.0; 3],
        };
        let mut found = Vec::with_capacity(views.len());
        let mut rest = views;
        while let Some(first) = rest.first() {
            let same = |view: &&View| view.v == first.v && view.normal == first.normal;
            let count = rest.iter().take_while(same).count().min(CHANNELS / 3);
            let (group, others) = rest.split_at(count);
            let colours = self.colours(&layers, &absorption, group, table, Spot::Whole, samples);
            found.extend(group.iter().zip(colours).map(|(view, colour)| {
                if self.subject.lit == Lit::Raking && !view.is_lit() {
                    Colour::default()
                } else {
                    colour
                }
            }));
            rest = others;
        }
        found
    }

    /// One colour for each of `views`, which share eye and normal: π L over the illuminance of the
    /// even sheet, or the share of the table's radiance.
    fn colours(
        &self,
        layers: &Layers,
        absorption: &[Absorption; 3],
        views: &[View],
        table: [f64; 3],
        spot: Spot,
        samples: u64,
    ) -> Vec<Colour> {
        let Some(first) = views.first() else {
            return Vec::new();
        };
        let upright = DQuat::from_rotation_arc(first.normal, DVec3::Z);
        let eye = upright * first.v;
        let is_table = table != [0.0; 3];
        let mut every = [Absorption::NONE; CHANNELS];
        for (i, slot) in every.iter_mut().enumerate() {
            *slot = absorption[i % 3];
        }
        let mut lamps = Vec::new();
        for (k, view) in views.iter().enumerate() {
            let direction = upright * view.l;
            // A facet that turns away from the lamp gets none of its light.
            if !is_table && direction.z > 0.0 {
                let mut irradiance = [0.0; CHANNELS];
                irradiance[3 * k..3 * k + 3].fill(PI / view.l.z);
                lamps.push(Lamp {
                    direction,
                    irradiance,
                });
            }
        }
        let mut behind = [0.0; CHANNELS];
        behind[..3].copy_from_slice(&table);
        let lighting = Lighting {
            lamps: &lamps,
            table: behind,
        };
        let blocks: Vec<[Estimate; CHANNELS]> = (0..BLOCKS)
            .into_par_iter()
            .map(|block| {
                let mut rng = rng::stream(7, block);
                radiance(layers, &every, eye, &lighting, samples / BLOCKS, &mut rng)
            })
            .collect();
        let particles = self.subject.particles().filter(|_| spot == Spot::Whole);
        views
            .iter()
            .enumerate()
            .map(|(k, view)| {
                let colour = joined(&blocks, 3 * k);
                match particles {
                    None => colour,
                    // (1 − c) f_paper + c f_particle: the definition of coverage.
                    Some((of, covered)) => {
                        let lobe = lobe(&of, upright * view.l, eye, samples, k as u64);
                        let (mirrors, diffuse) = tarnished(&of, samples);
                        Colour {
                            mean: colour.mean * (1.0 - covered)
                                + (lobe.mean * mirrors + diffuse) * covered,
                            variance: colour.variance * (1.0 - covered).powi(2)
                                + lobe.variance * (mirrors * covered).powi(2),
                        }
                    }
                }
            })
            .collect()
    }
}

/// Three channels from the one numbered `first`, of all blocks together.
fn joined(blocks: &[[Estimate; CHANNELS]], first: usize) -> Colour {
    let count = blocks.len() as f64;
    let sum = |of: &dyn Fn(&Estimate) -> f64| {
        let channel = |c: usize| {
            blocks
                .iter()
                .map(|block| of(&block[first + c]))
                .sum::<f64>()
        };
        DVec3::new(channel(0), channel(1), channel(2))
    };
    Colour {
        mean: sum(&|estimate| estimate.mean) / count,
        variance: sum(&|estimate| estimate.variance) / (count * count),
    }
}

/// π times the BRDF of facets of pure metal.
fn lobe(of: &ParticleConstants, l: DVec3, v: DVec3, samples: u64, index: u64) -> Colour {
    let mut rng = rng::stream(8, index);
    let f = mean(samples, |rng: &mut Rng| metal(of, l, v, rng), &mut rng);
    Colour {
        mean: f.mean * PI,
        variance: f.variance * (PI * PI),
    }
}

/// The share of particles that mirrors as the pure metal, and the diffuse albedo of the rest, such
/// that together they photograph as the catalogue says: no more mirrors than the photograph has.
fn tarnished(of: &ParticleConstants, samples: u64) -> (f64, DVec3) {
    let albedo = DVec3::from_array(of.albedo);
    let captured = lobe(of, CAPTURE.l, CAPTURE.v, samples, 0).mean;
    let mirrors = (albedo / captured).min_element().clamp(0.0, 1.0);
    (mirrors, albedo - captured * mirrors)
}

/// The BRDF of facets of metal, all bounces walked; a random number per channel.
fn metal(of: &ParticleConstants, l: DVec3, v: DVec3, rng: &mut Rng) -> DVec3 {
    let facets = Interface {
        n: 1.5,
        alpha: of.roughness,
    };
    let fresnel = |cos: f64| std::array::from_fn(|c| fresnel_conductor(cos, of.n[c], of.k[c]));
    DVec3::from_array(facets.evaluate_opaque::<3>(-l, v, fresnel, rng)) / v.z
}

fn mean(samples: u64, f: impl Fn(&mut Rng) -> DVec3, rng: &mut Rng) -> Colour {
    let (mut sum, mut squares) = (DVec3::ZERO, DVec3::ZERO);
    for _ in 0..samples {
        let x = f(rng);
        sum += x;
        squares += x * x;
    }
    let count = samples.max(2) as f64;
    let mean = sum / count;
    Colour {
        mean,
        variance: (squares / count - mean * mean).max(DVec3::ZERO) / (count - 1.0),
    }
}
