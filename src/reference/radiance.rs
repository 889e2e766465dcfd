//! The radiance an eye sees: a walk that starts at the eye, with every lamp connected to every
//! collision (next-event estimation).
//!
//! By reciprocity the walk is that of a photon sent from the eye. At each collision, light
//! that came from a lamp without having met fibres is scattered back along it:
//!
//! L = E μ_l / n² Σ_collisions Σ_beams (weight/μ_b) p(−ω_b·ω_e)
//!
//! where a beam is a piece of the lamp's unscattered way (it was sampled through the interface,
//! so no facet distribution has to be hit by chance), and 1/n² turns radiance inside into
//! radiance in air. Light that never meets fibres is evaluated at the interfaces.

use std::array;

use glam::DVec3;

use super::{
    flux::Roulette,
    rng::Rng,
    statistics::{Estimate, Sums},
    walk::{Absorption, Beam, Face, Layers, Lengths, Observer, Photon, facing},
};

/// A distant lamp, on either side of the sheet.
#[derive(Clone, Copy, Debug)]
pub struct Lamp<const C: usize> {
    /// Towards the lamp, a unit vector; z > 0 is before the sheet.
    pub direction: DVec3,
    /// On a plane that faces the lamp, per channel.
    pub irradiance: [f64; C],
}

/// What lights a sheet.
#[derive(Clone, Copy, Debug)]
pub struct Lighting<'a, const C: usize> {
    pub lamps: &'a [Lamp<C>],
    /// Radiance of a Lambertian table behind the whole sheet, per channel; 0 where there is
    /// none. It reflects nothing.
    pub table: [f64; C],
}

/// What absorbs on the way of one walk.
///
/// The photograph of one side was taken with the other side's ink behind it: what that ink takes
/// from light that comes back is in the photograph already. It counts for light from behind alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Absorbers<'a, const C: usize> {
    /// Of light from lamps before the sheet.
    pub before: &'a [Absorption; C],
    /// Of light from behind it.
    pub behind: &'a [Absorption; C],
}

/// What an eye's walk can come upon.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scenery<'a, const C: usize> {
    pub lamps: &'a [Lamp<C>],
    /// Radiance from every direction before the sheet, and behind it.
    pub before: [f64; C],
    pub behind: [f64; C],
}

impl<const C: usize> Scenery<'_, C> {
    /// Whether there is no light at all.
    pub fn is_dark(&self) -> bool {
        self.lamps.is_empty() && self.before == [0.0; C] && self.behind == [0.0; C]
    }
}

struct Eye<'a, const C: usize> {
    layers: &'a Layers,
    absorbers: Absorbers<'a, C>,
    lamps: &'a [Lamp<C>],
    /// For each lamp, one sample of its unscattered way.
    beams: &'a [Vec<Beam>],
    roulette: Roulette<'a>,
    radiance: [f64; C],
}

impl<const C: usize> Eye<'_, C> {
    fn add(&mut self, lamp: &Lamp<C>, factor: f64, lengths: &Lengths) {
        let absorption = if lamp.direction.z > 0.0 {
            self.absorbers.before
        } else {
            self.absorbers.behind
        };
        let channels = lamp.irradiance.iter().zip(absorption);
        for (radiance, (irradiance, absorption)) in self.radiance.iter_mut().zip(channels) {
            // A lamp of one colour, or of one of many pictures that share their walks.
            if *irradiance != 0.0 {
                *radiance += irradiance * factor * absorption.kept(lengths);
            }
        }
    }
}

impl<const C: usize> Observer for Eye<'_, C> {
    fn collision(&mut self, photon: &Photon, rng: &mut Rng) -> bool {
        let (beams, lamps) = (self.beams, self.lamps);
        let n_2 = self.layers.n * self.layers.n;
        for (lamp, beams) in lamps.iter().zip(beams) {
            for beam in beams {
                let Some((brought, lengths)) = beam.at(photon.depth, self.layers, rng) else {
                    continue;
                };
                let p = self.layers.phase.value(-beam.direction().dot(photon.w));
                let factor = self.roulette.weight * lamp.direction.z.abs() / n_2 * brought * p;
                self.add(lamp, factor, &lengths.plus(&photon.lengths));
            }
        }
        self.roulette.collision(photon, rng)
    }

    fn unscattered(&mut self, face: Face, photon: &Photon, rng: &mut Rng) {
        let lamps = self.lamps;
        for lamp in lamps {
            let out = facing(face, lamp.direction);
            if out.z > 0.0 {
                let interface = self.layers.interface(face);
                let factor = interface.evaluate(facing(face, photon.w), out, rng);
                self.add(lamp, factor, &photon.lengths);
            }
        }
    }
}

/// Walks one path after another and keeps what they need of memory.
#[derive(Default)]
pub(super) struct Walker {
    beams: Vec<Vec<Beam>>,
}

impl Walker {
    /// One sample of the radiance in the direction `view`.
    pub fn sample<const C: usize>(
        &mut self,
        layers: &Layers,
        absorbers: Absorbers<C>,
        view: DVec3,
        scenery: &Scenery<C>,
        rng: &mut Rng,
    ) -> [f64; C] {
        let count = scenery.lamps.len();
        if self.beams.len() < count {
            self.beams.resize_with(count, Vec::new);
        }
        for (lamp, beams) in scenery.lamps.iter().zip(&mut self.beams) {
            layers.beams(-lamp.direction, beams, rng);
        }
        let mut eye = Eye {
            layers,
            absorbers,
            lamps: scenery.lamps,
            beams: &self.beams[..count],
            roulette: Roulette::new(absorbers.before),
            radiance: [0.0; C],
        };
        let left = layers.walk(-view, &mut eye, rng);
        let mut radiance = eye.radiance;
        if let Some(photon) = left {
            let (around, absorption) = if photon.w.z < 0.0 {
                (&scenery.behind, absorbers.behind)
            } else {
                (&scenery.before, absorbers.before)
            };
            for channel in 0..C {
                let kept = absorption[channel].kept(&photon.lengths);
                radiance[channel] += eye.roulette.weight * kept * around[channel];
            }
        }
        radiance
    }
}

/// Radiance per channel in the direction `view` (away from the sheet, a unit vector), with the
/// variance of its mean over `samples` walks.
///
/// The image of a lamp in a smooth interface is infinitely bright and is left out; a rough
/// interface's specular lobe is included, and so is a table's light that passes straight.
pub fn radiance<const C: usize>(
    layers: &Layers,
    absorption: &[Absorption; C],
    view: DVec3,
    lighting: &Lighting<C>,
    samples: u64,
    rng: &mut Rng,
) -> [Estimate; C] {
    let mut sums = [Sums::default(); C];
    let mut walker = Walker::default();
    let scenery = Scenery {
        lamps: lighting.lamps,
        before: [0.0; C],
        behind: lighting.table,
    };
    let absorbers = Absorbers {
        before: absorption,
        behind: absorption,
    };
    for _ in 0..samples {
        let radiance = walker.sample(layers, absorbers, view, &scenery, rng);
        for (sums, radiance) in sums.iter_mut().zip(radiance) {
            sums.add(radiance);
        }
    }
    array::from_fn(|channel| sums[channel].estimate(samples))
}
