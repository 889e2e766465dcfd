//! What the photograph saw: paper's absorption and ink's optical depth from a photographed
//! albedo.
//!
//! A fixed ensemble of paths in the capture geometry (lamp at 45°, camera at 0°) is walked
//! once. Absorption weighs each path by e^(−σa ℓ − τ m), so the albedo is a Laplace transform of
//! the ensemble: smooth, falling and log-convex in σa and τ, without noise between two values.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use glam::DVec3;
use rayon::prelude::*;

use super::{
    rng::{Rng, uniform},
    statistics::{Estimate, Sums, in_blocks},
    walk::{Absorption, Beam, Face, Layers, Lengths, Observer, Photon},
};

/// Optical depth is never taken larger (OPTICS.md, numeric trap 8).
pub const TAU_MAX: f64 = 20.0;

/// Towards the lamp of the capture geometry.
const LAMP: DVec3 = DVec3::new(FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2);

/// Paths summed by one thread; sums of chunks are joined in order.
const CHUNK: usize = 4096;

/// Whether a photographed albedo can come from such a sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    Inside,
    /// As dark as, or darker than, what the surface alone reflects: the darkest value is given.
    BelowFloor,
    /// Brighter than without any absorption: 0 is given.
    AboveLossless,
}

/// A solved absorption.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved {
    /// σa in mm⁻¹, or τ.
    pub value: f64,
    pub bound: Bound,
}

/// One path's light and lengths.
#[derive(Clone, Copy, Debug)]
struct Record {
    albedo: f64,
    lengths: Lengths,
}

/// Paths from camera to lamp through a sheet, in the capture geometry.
pub struct Capture {
    records: Vec<Record>,
    paths: u64,
    floor: Estimate,
}

/// The quantity solved for.
#[derive(Clone, Copy)]
enum Unknown {
    SigmaA,
    TauF,
}

impl Unknown {
    /// The largest value that is looked for.
    fn most(self) -> f64 {
        match self {
            // Far beyond any paper: e⁻¹ in a micrometre.
            Self::SigmaA => 1e3,
            Self::TauF => TAU_MAX,
        }
    }

    /// The value at a step of a curve: finest where there is little of it.
    fn at(self, step: f64) -> f64 {
        let share = step / Curve::STEPS as f64;
        let share_2 = share * share;
        match self {
            Self::SigmaA => self.most() * share_2 * share_2,
            Self::TauF => self.most() * share_2,
        }
    }

    /// Its derivative by the step.
    fn rate(self, step: f64) -> f64 {
        let share = step / Curve::STEPS as f64;
        let power = match self {
            Self::SigmaA => 4.0 * share * share * share,
            Self::TauF => 2.0 * share,
        };
        self.most() * power / Curve::STEPS as f64
    }

    fn set(self, around: &Absorption, value: f64) -> Absorption {
        match self {
            Self::SigmaA => Absorption {
                sigma_a: value,
                ..*around
            },
            Self::TauF => Absorption {
                tau_f: value,
                ..*around
            },
        }
    }
}

struct Recorder<'a> {
    layers: &'a Layers,
    beams: &'a [Beam],
    floor: f64,
    record: Record,
}

impl Recorder<'_> {
    /// Keeps one of all contributions, each as likely as its share.
    fn add(&mut self, albedo: f64, lengths: &Lengths, rng: &mut Rng) {
        self.record.albedo += albedo;
        if uniform(rng) * self.record.albedo < albedo {
            self.record.lengths = *lengths;
        }
    }
}

impl Observer for Recorder<'_> {
    fn collision(&mut self, photon: &Photon, rng: &mut Rng) -> bool {
        let beams = self.beams;
        for beam in beams {
            if let Some((brought, lengths)) = beam.at(photon.depth, self.layers, rng) {
                let p = self.layers.phase.value(-beam.direction().dot(photon.w));
                let n_2 = self.layers.n * self.layers.n;
                self.add(PI * brought * p / n_2, &lengths.plus(&photon.lengths), rng);
            }
        }
        true
    }

    fn unscattered(&mut self, face: Face, photon: &Photon, rng: &mut Rng) {
        // The lamp is before the sheet.
        if face == Face::Front {
            let density = self.layers.interface(face).evaluate(photon.w, LAMP, rng);
            let albedo = PI * density / LAMP.z;
            if photon.w.z < 0.0 {
                self.floor += albedo;
            } else {
                self.add(albedo, &photon.lengths, rng);
            }
        }
    }
}

impl Capture {
    /// Walks `paths` paths; 2¹⁷ give an albedo within about 0.3%.
    pub fn new(layers: &Layers, paths: u64, seed: u64) -> Self {
        let blocks = in_blocks(paths, seed, |count, rng| {
            let mut records = Vec::with_capacity(count as usize);
            let mut floor = Sums::default();
            let mut beams = Vec::new();
            for _ in 0..count {
                layers.beams(-LAMP, &mut beams, rng);
                let mut recorder = Recorder {
                    layers,
                    beams: &beams,
                    floor: 0.0,
                    record: Record {
                        albedo: 0.0,
                        lengths: Lengths::default(),
                    },
                };
                layers.walk(DVec3::NEG_Z, &mut recorder, rng);
                floor.add(recorder.floor);
                if recorder.record.albedo > 0.0 {
                    records.push(recorder.record);
                }
            }
            (records, floor)
        });
        let mut floor = Sums::default();
        let mut records = Vec::new();
        for (block, sums) in blocks {
            records.extend(block);
            floor.join(&sums);
        }
        Self {
            records,
            paths,
            floor: floor.estimate(paths),
        }
    }

    /// The albedo that the surface alone shows: light that never entered the sheet.
    pub fn floor(&self) -> Estimate {
        self.floor
    }

    /// The albedo that a photograph shows, floor included. Its variance is that of the
    /// ensemble against the truth.
    pub fn albedo(&self, absorption: &Absorption) -> Estimate {
        let chunks: Vec<Sums> = self
            .records
            .par_chunks(CHUNK)
            .map(|records| {
                let mut sums = Sums::default();
                for record in records {
                    sums.add(record.albedo * absorption.kept(&record.lengths));
                }
                sums
            })
            .collect();
        let mut sums = Sums::default();
        chunks.iter().for_each(|chunk| sums.join(chunk));
        let body = sums.estimate(self.paths);
        Estimate {
            mean: body.mean + self.floor.mean,
            variance: body.variance + self.floor.variance,
        }
    }

    /// The body's albedo, without the floor, and its derivative by the unknown.
    fn body(&self, absorption: &Absorption, unknown: Unknown) -> (f64, f64) {
        let chunks: Vec<(f64, f64)> = self
            .records
            .par_chunks(CHUNK)
            .map(|records| {
                records.iter().fold((0.0, 0.0), |(sum, slope), record| {
                    let kept = record.albedo * absorption.kept(&record.lengths);
                    let length = match unknown {
                        Unknown::SigmaA => record.lengths.slab,
                        Unknown::TauF => record.lengths.front,
                    };
                    (sum + kept, slope - kept * length)
                })
            })
            .collect();
        let (sum, slope) = chunks
            .iter()
            .fold((0.0, 0.0), |all, chunk| (all.0 + chunk.0, all.1 + chunk.1));
        let paths = self.paths.max(1) as f64;
        (sum / paths, slope / paths)
    }

    /// The absorption coefficient in mm⁻¹ of bare paper that shows `albedo`.
    pub fn solve_sigma_a(&self, albedo: f64) -> Solved {
        self.solve(albedo, Unknown::SigmaA, Absorption::NONE)
    }

    /// The optical depth of a film on the front that makes `paper`, whose own film there is
    /// left out, show `albedo`.
    pub fn solve_tau(&self, albedo: f64, paper: &Absorption) -> Solved {
        self.solve(albedo, Unknown::TauF, *paper)
    }

    fn solve(&self, albedo: f64, unknown: Unknown, around: Absorption) -> Solved {
        let most = unknown.most();
        let with = |value: f64| unknown.set(&around, value);
        let wanted = albedo - self.floor.mean;
        if wanted.is_nan() || wanted <= self.body(&with(most), unknown).0 {
            return Solved {
                value: most,
                bound: Bound::BelowFloor,
            };
        }
        let mut value = 0.0;
        // A Laplace transform is log-convex: Newton's steps on its logarithm, begun at 0, come
        // from below and never pass the solution.
        for step in 0..100 {
            let (body, slope) = self.body(&with(value), unknown);
            if step == 0 && wanted > body {
                return Solved {
                    value: 0.0,
                    bound: Bound::AboveLossless,
                };
            }
            let change = (wanted / body).ln() * body / slope;
            value = (value + change).min(most);
            if change.abs() <= 1e-12 * value.max(1e-3) {
                break;
            }
        }
        Solved {
            value,
            bound: Bound::Inside,
        }
    }

    /// The albedos of a film on the front of `paper`, tabulated for whole pictures.
    pub fn film_curve(&self, paper: &Absorption) -> Curve {
        self.curve(Unknown::TauF, paper)
    }

    /// The albedos of bare paper, tabulated for whole pictures.
    pub fn paper_curve(&self) -> Curve {
        self.curve(Unknown::SigmaA, &Absorption::NONE)
    }

    fn curve(&self, unknown: Unknown, around: &Absorption) -> Curve {
        let knots = (0..=Curve::STEPS)
            .map(|step| {
                let step = step as f64;
                let absorption = unknown.set(around, unknown.at(step));
                let (body, slope) = self.body(&absorption, unknown);
                let body = body.max(f64::MIN_POSITIVE);
                Knot {
                    ln_albedo: body.ln(),
                    slope: slope / body * unknown.rate(step),
                }
            })
            .collect();
        Curve {
            unknown,
            floor: self.floor.mean,
            knots,
        }
    }
}

/// Logarithm of the body's albedo at a step, and its derivative by the step.
#[derive(Clone, Copy)]
struct Knot {
    ln_albedo: f64,
    slope: f64,
}

impl Knot {
    /// Between two knots, at `share` of the way: the cubic that has both slopes (Hermite).
    fn towards(&self, next: &Self, share: f64) -> f64 {
        let back = 1.0 - share;
        let rise = next.ln_albedo - self.ln_albedo;
        let bend = back * (self.slope - rise) + share * (rise - next.slope);
        self.ln_albedo + share * (rise + back * bend)
    }
}

/// Albedo against a film's optical depth or a paper's absorption, in one channel.
pub struct Curve {
    unknown: Unknown,
    floor: f64,
    /// Falling.
    knots: Vec<Knot>,
}

impl Curve {
    const STEPS: usize = 96;

    /// The albedo that the surface alone shows.
    pub fn floor(&self) -> f64 {
        self.floor
    }

    /// The optical depth or absorption that shows `albedo`: as [`Capture::solve_tau`] and
    /// [`Capture::solve_sigma_a`] within 10⁻⁴.
    pub fn solve(&self, albedo: f64) -> Solved {
        let wanted = (albedo - self.floor).max(0.0).ln();
        let above = self.knots.partition_point(|knot| knot.ln_albedo > wanted);
        if albedo.is_nan() || above > Self::STEPS {
            return Solved {
                value: self.unknown.most(),
                bound: Bound::BelowFloor,
            };
        }
        if above == 0 {
            let bound = if wanted > self.knots[0].ln_albedo {
                Bound::AboveLossless
            } else {
                Bound::Inside
            };
            return Solved { value: 0.0, bound };
        }
        let (from, to) = (&self.knots[above - 1], &self.knots[above]);
        // The curve falls between the knots; regula falsi, kept lively (Illinois), finds where.
        let (mut low, mut high) = (0.0, 1.0);
        let (mut f_low, mut f_high) = (from.ln_albedo - wanted, to.ln_albedo - wanted);
        let mut share = 0.0;
        for _ in 0..40 {
            share = low + (high - low) * f_low / (f_low - f_high);
            let f = from.towards(to, share) - wanted;
            if f.abs() < 1e-10 {
                break;
            }
            if f > 0.0 {
                (low, f_low, f_high) = (share, f, 0.5 * f_high);
            } else {
                (high, f_high, f_low) = (share, f, 0.5 * f_low);
            }
        }
        Solved {
            value: self.unknown.at((above - 1) as f64 + share),
            bound: Bound::Inside,
        }
    }
}
