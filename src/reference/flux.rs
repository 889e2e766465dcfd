//! Where a beam's light goes: reflectance, transmittance, and the BSDF in bins of direction.

use std::f64::consts::TAU;

use glam::DVec3;

use super::{
    rng::{Rng, uniform},
    statistics::{Estimate, Sums, in_blocks},
    walk::{Absorption, Layers, Observer, Photon},
};

/// Bins in the cosine of the outgoing direction, all of the same width.
pub const MU_BINS: usize = 10;
/// Bins in the azimuth of the outgoing direction.
pub const PHI_BINS: usize = 12;

/// Weight below which a photon lives on by chance only.
const FAINT: f64 = 1e-2;

/// What share of a beam is reflected and transmitted, in one channel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Flux {
    pub reflected: Estimate,
    pub transmitted: Estimate,
}

/// Ends walks by chance once no channel has much light left, and keeps the mean by giving
/// those that live on the weight of those that do not (Russian roulette).
pub(super) struct Roulette<'a> {
    absorption: &'a [Absorption],
    pub(super) weight: f64,
}

impl Roulette<'_> {
    pub(super) fn new(absorption: &[Absorption]) -> Roulette<'_> {
        Roulette {
            absorption,
            weight: 1.0,
        }
    }
}

impl Observer for Roulette<'_> {
    #[inline]
    fn collision(&mut self, photon: &Photon, rng: &mut Rng) -> bool {
        // Seldom enough to cost little.
        if photon.collisions % 16 != 15 {
            return true;
        }
        let kept = |absorption: &Absorption| absorption.kept(&photon.lengths);
        let most = self.absorption.iter().map(kept).fold(0.0, f64::max) * self.weight;
        if most >= FAINT {
            return true;
        }
        let survival = (most / FAINT).max(0.05);
        self.weight /= survival;
        uniform(rng) < survival
    }
}

/// The direction of travel of light that arrives at the front at a cosine `mu_i`, in the x-z
/// plane and towards −x.
fn arriving(mu_i: f64) -> DVec3 {
    let sin = (1.0 - mu_i * mu_i).max(0.0).sqrt();
    DVec3::new(-sin, 0.0, -mu_i)
}

/// Reflectance and transmittance of a beam that arrives at the front at a cosine `mu_i` in
/// (0, 1], specular and ballistic light included: one for each of `absorption`.
pub fn reflectance_transmittance(
    layers: &Layers,
    absorption: &[Absorption],
    mu_i: f64,
    photons: u64,
    seed: u64,
) -> Vec<Flux> {
    let w = arriving(mu_i);
    let blocks = in_blocks(photons, seed, |count, rng| {
        let mut sums = vec![[Sums::default(); 2]; absorption.len()];
        for _ in 0..count {
            let mut roulette = Roulette::new(absorption);
            let Some(photon) = layers.walk(w, &mut roulette, rng) else {
                continue;
            };
            let side = usize::from(photon.w.z < 0.0);
            for (sums, absorption) in sums.iter_mut().zip(absorption) {
                sums[side].add(roulette.weight * absorption.kept(&photon.lengths));
            }
        }
        sums
    });
    (0..absorption.len())
        .map(|channel| {
            let mut total = [Sums::default(); 2];
            for block in &blocks {
                total[0].join(&block[channel][0]);
                total[1].join(&block[channel][1]);
            }
            Flux {
                reflected: total[0].estimate(photons),
                transmitted: total[1].estimate(photons),
            }
        })
        .collect()
}

/// A BSDF in one channel for one incoming direction, in bins of the outgoing one.
///
/// All bins are in sr⁻¹, averaged over each bin with the cosine as weight: `MU_BINS` rows of
/// `PHI_BINS`, as [`bin`] counts them.
#[derive(Clone, Debug)]
pub struct Bins {
    /// Light that fibres have scattered back.
    pub reflected: Vec<Estimate>,
    /// Light that fibres have scattered and that leaves at the back.
    pub transmitted: Vec<Estimate>,
    /// Reflected light that has not met fibres, a delta in one bin where the interface is
    /// smooth: the specular lobe, and what comes back from the far interface.
    pub reflected_unscattered: Vec<Estimate>,
    /// Light that passes without having met fibres, a delta where the interfaces are smooth.
    pub transmitted_unscattered: Vec<Estimate>,
    /// Share of light in `reflected_unscattered`.
    pub mirror: Estimate,
    /// Share of light in `transmitted_unscattered`.
    pub ballistic: Estimate,
}

/// The bin of an outgoing direction, away from the sheet: azimuth 0 is where a mirror would
/// send light.
pub fn bin(w: DVec3) -> usize {
    let row = (w.z.abs() * MU_BINS as f64) as usize;
    // Light travels towards −x.
    let phi = (-w.y).atan2(-w.x).rem_euclid(TAU);
    let column = (phi / TAU * PHI_BINS as f64) as usize;
    row.min(MU_BINS - 1) * PHI_BINS + column.min(PHI_BINS - 1)
}

/// ∫ μ dω over a bin, by which its flux is divided.
pub fn projected_solid_angle(bin: usize) -> f64 {
    let row = (bin / PHI_BINS) as f64;
    let width = 1.0 / MU_BINS as f64;
    (row + 0.5) * width * width * TAU / PHI_BINS as f64
}

/// Cosine and azimuth of a bin's middle.
pub fn bin_middle(bin: usize) -> (f64, f64) {
    let row = (bin / PHI_BINS) as f64 + 0.5;
    let column = (bin % PHI_BINS) as f64 + 0.5;
    (row / MU_BINS as f64, column * TAU / PHI_BINS as f64)
}

/// The BSDF for light that arrives at the front at a cosine `mu_i` in (0, 1]: one for each of
/// `absorption`.
pub fn bins(
    layers: &Layers,
    absorption: &[Absorption],
    mu_i: f64,
    photons: u64,
    seed: u64,
) -> Vec<Bins> {
    const SIDE: usize = MU_BINS * PHI_BINS;
    /// Four sets of bins, and both totals.
    const CELLS: usize = 4 * SIDE + 2;
    let w = arriving(mu_i);
    let blocks = in_blocks(photons, seed, |count, rng| {
        let mut sums = vec![[Sums::default(); CELLS]; absorption.len()];
        for _ in 0..count {
            let mut roulette = Roulette::new(absorption);
            let Some(photon) = layers.walk(w, &mut roulette, rng) else {
                continue;
            };
            let behind = usize::from(photon.w.z < 0.0);
            let unscattered = photon.collisions == 0;
            let set = behind + if unscattered { 2 } else { 0 };
            for (sums, absorption) in sums.iter_mut().zip(absorption) {
                let weight = roulette.weight * absorption.kept(&photon.lengths);
                sums[set * SIDE + bin(photon.w)].add(weight);
                if unscattered {
                    sums[4 * SIDE + behind].add(weight);
                }
            }
        }
        sums
    });
    (0..absorption.len())
        .map(|channel| {
            let mut total = vec![Sums::default(); CELLS];
            for block in &blocks {
                for (total, sums) in total.iter_mut().zip(&block[channel]) {
                    total.join(sums);
                }
            }
            let set = |set: usize| {
                (0..SIDE)
                    .map(|bin| {
                        let flux = total[set * SIDE + bin].estimate(photons);
                        flux.scaled(1.0 / projected_solid_angle(bin))
                    })
                    .collect()
            };
            Bins {
                reflected: set(0),
                transmitted: set(1),
                reflected_unscattered: set(2),
                transmitted_unscattered: set(3),
                mirror: total[4 * SIDE].estimate(photons),
                ballistic: total[4 * SIDE + 1].estimate(photons),
            }
        })
        .collect()
}
