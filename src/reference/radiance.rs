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

struct Eye<'a, const C: usize> {
    layers: &'a Layers,
    absorption: &'a [Absorption; C],
    lamps: &'a [Lamp<C>],
    /// For each lamp, one sample of its unscattered way.
    beams: &'a [Vec<Beam>],
    roulette: Roulette<'a>,
    radiance: [f64; C],
}

impl<const C: usize> Eye<'_, C> {
    fn add(&mut self, lamp: &Lamp<C>, factor: f64, lengths: &Lengths) {
        for channel in 0..C {
            // A lamp of one colour, or of one of many pictures that share their walks.
            if lamp.irradiance[channel] == 0.0 {
                continue;
            }
            let kept = self.absorption[channel].kept(lengths);
            self.radiance[channel] += lamp.irradiance[channel] * factor * kept;
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
    let mut beams = vec![Vec::new(); lighting.lamps.len()];
    for _ in 0..samples {
        for (lamp, beams) in lighting.lamps.iter().zip(&mut beams) {
            layers.beams(-lamp.direction, beams, rng);
        }
        let mut eye = Eye {
            layers,
            absorption,
            lamps: lighting.lamps,
            beams: &beams,
            roulette: Roulette::new(absorption),
            radiance: [0.0; C],
        };
        let left = layers.walk(-view, &mut eye, rng);
        let mut radiance = eye.radiance;
        if let Some(photon) = left.filter(|photon| photon.w.z < 0.0) {
            for channel in 0..C {
                let kept = absorption[channel].kept(&photon.lengths);
                radiance[channel] += eye.roulette.weight * kept * lighting.table[channel];
            }
        }
        for (sums, radiance) in sums.iter_mut().zip(radiance) {
            sums.add(radiance);
        }
    }
    array::from_fn(|channel| sums[channel].estimate(samples))
}
