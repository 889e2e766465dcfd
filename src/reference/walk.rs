//! A photon's way through the sheet: air, rough interface, ink film, fibres, ink film, rough
//! interface, air.
//!
//! Absorption is not part of the walk. A path records how far it went in the fibres and how
//! often, by slant, it crossed each film; any absorption is a weight on that record, so one
//! walk serves every channel and every ink (and their differences are free of noise).

use glam::DVec3;
use thiserror::Error;

use super::{
    interface::Interface,
    phase::Phase,
    rng::{Rng, exponential, uniform},
};

/// The side of the sheet an interface or film lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// z = 0; directions with z > 0 lead out of it.
    Front,
    Back,
}

/// What scatters in a sheet: everything about it but absorption.
#[derive(Clone, Copy, Debug)]
pub struct Layers {
    /// Refractive index of fibres and films, in [1, 4].
    pub n: f64,
    /// GGX roughness α of front and back, in [0, 1].
    pub alpha: [f64; 2],
    /// Scattering coefficient in mm⁻¹, > 0.
    pub sigma_s: f64,
    pub phase: Phase,
    /// Thickness of the fibre layer, > 0. The films have none.
    pub thickness_mm: f64,
}

/// A constant that no sheet has.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("{name} = {found}: {allowed} is possible; {reason}")]
pub struct LayersError {
    pub name: &'static str,
    pub found: f64,
    pub allowed: &'static str,
    pub reason: &'static str,
}

impl Layers {
    /// The first constant out of its physical range.
    pub fn check(&self) -> Result<(), LayersError> {
        let phase = &self.phase;
        let unit = "0 to 1";
        let lobe = "|g| ≤ 0.99";
        #[rustfmt::skip]
        let rows = [
            ("n", self.n, 1.0, 4.0, "1 to 4", "light is no faster in matter than in air"),
            ("alpha (front)", self.alpha[0], 0.0, 1.0, unit, "GGX roughness ends at 1"),
            ("alpha (back)", self.alpha[1], 0.0, 1.0, unit, "GGX roughness ends at 1"),
            ("sigma_s", self.sigma_s, 1e-6, 1e6, "1e-6 to 1e6 per mm", "fibres scatter"),
            ("w_f", phase.w_f, 0.0, 1.0, unit, "it is the forward lobe's share"),
            ("g_f", phase.g_f, -0.99, 0.99, lobe, "a sharper lobe is a beam, not a phase"),
            ("g_b", phase.g_b, -0.99, 0.99, lobe, "a sharper lobe is a beam, not a phase"),
            ("thickness", self.thickness_mm, 1e-6, 1e3, "1e-6 to 1000 mm", "a sheet has one"),
            // A lossless walk has 2 n² σs d collisions in the mean.
            ("sigma_s × thickness", self.sigma_s * self.thickness_mm, 0.0, 1e4, "up to 10000",
                "no more is told from an endless depth, and no walk ends in time"),
        ];
        for (name, found, low, high, allowed, reason) in rows {
            if !(low..=high).contains(&found) {
                return Err(LayersError {
                    name,
                    found,
                    allowed,
                    reason,
                });
            }
        }
        Ok(())
    }

    pub(super) fn interface(&self, face: Face) -> Interface {
        Interface {
            n: self.n,
            alpha: match face {
                Face::Front => self.alpha[0],
                Face::Back => self.alpha[1],
            },
        }
    }
}

/// What absorbs, in one channel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Absorption {
    /// Absorption coefficient of the fibre layer in mm⁻¹, ≥ 0.
    pub sigma_a: f64,
    /// Optical depth of the front's film along the normal, ≥ 0.
    pub tau_f: f64,
    /// Optical depth of the back's film along the normal, ≥ 0.
    pub tau_b: f64,
}

impl Absorption {
    pub const NONE: Self = Self {
        sigma_a: 0.0,
        tau_f: 0.0,
        tau_b: 0.0,
    };

    /// The share of light left after `lengths`.
    #[inline]
    pub fn kept(&self, lengths: &Lengths) -> f64 {
        let depth =
            self.sigma_a * lengths.slab + self.tau_f * lengths.front + self.tau_b * lengths.back;
        if depth == 0.0 { 1.0 } else { (-depth).exp() }
    }
}

/// How far a path has gone in what can absorb.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lengths {
    /// In the fibre layer, in mm.
    pub slab: f64,
    /// In the front's film, in units of its thickness.
    pub front: f64,
    /// In the back's film, in units of its thickness.
    pub back: f64,
}

impl Lengths {
    #[inline]
    pub(super) fn plus(&self, other: &Self) -> Self {
        Self {
            slab: self.slab + other.slab,
            front: self.front + other.front,
            back: self.back + other.back,
        }
    }

    #[inline]
    fn cross(&mut self, face: Face, w: DVec3) {
        let slant = 1.0 / w.z.abs().max(f64::MIN_POSITIVE);
        match face {
            Face::Front => self.front += slant,
            Face::Back => self.back += slant,
        }
    }
}

/// A photon on its way.
#[derive(Clone, Copy, Debug)]
pub struct Photon {
    /// Direction of travel, a unit vector, z towards the front.
    pub w: DVec3,
    /// Depth below the front in mm.
    pub depth: f64,
    pub lengths: Lengths,
    /// How often fibres have scattered it.
    pub collisions: u32,
}

/// Watches a walk, and may end it.
pub trait Observer {
    /// Fibres are about to scatter the photon, whose direction is still that before; false
    /// ends the walk.
    #[inline]
    fn collision(&mut self, _photon: &Photon, _rng: &mut Rng) -> bool {
        true
    }

    /// The photon, not yet scattered, meets an interface from either side.
    #[inline]
    fn unscattered(&mut self, _face: Face, _photon: &Photon, _rng: &mut Rng) {}
}

/// Watches nothing.
impl Observer for () {}

/// Turns a direction between the sheet's frame and an interface's, whose z leads into the air.
#[inline]
pub(super) fn facing(face: Face, w: DVec3) -> DVec3 {
    match face {
        Face::Front => w,
        Face::Back => DVec3::new(w.x, w.y, -w.z),
    }
}

impl Layers {
    /// The photon after `face`'s interface, and whether it is in the fibres; films included.
    fn meet(&self, face: Face, photon: &mut Photon, rng: &mut Rng) -> bool {
        let out = self.interface(face).scatter(facing(face, photon.w), rng);
        photon.w = facing(face, out);
        if out.z > 0.0 {
            return false;
        }
        photon.lengths.cross(face, photon.w);
        photon.depth = match face {
            Face::Front => 0.0,
            Face::Back => self.thickness_mm,
        };
        true
    }

    /// A photon that arrives from the air along `w`, a unit vector, at the front where w.z < 0.
    fn arrive(&self, w: DVec3) -> (Face, Photon) {
        // −0 comes from the front.
        let z = w.z.abs().max(GRAZING).copysign(w.z);
        let face = if z < 0.0 { Face::Front } else { Face::Back };
        let photon = Photon {
            w: DVec3::new(w.x, w.y, z),
            depth: 0.0,
            lengths: Lengths::default(),
            collisions: 0,
        };
        (face, photon)
    }

    /// The interface ahead, and the way to it.
    #[inline]
    fn ahead(&self, photon: &Photon) -> (Face, f64) {
        let slant = photon.w.z.abs().max(f64::MIN_POSITIVE);
        if photon.w.z > 0.0 {
            (Face::Front, photon.depth / slant)
        } else {
            (Face::Back, (self.thickness_mm - photon.depth) / slant)
        }
    }

    /// Follows a photon that arrives from the air along `w` until it leaves; nothing is lost.
    /// `None` where the observer ends the walk, or `w` is no direction. The layers are those
    /// that pass [`Layers::check`].
    pub fn walk(&self, w: DVec3, observer: &mut impl Observer, rng: &mut Rng) -> Option<Photon> {
        if !w.is_finite() {
            return None;
        }
        let (face, mut photon) = self.arrive(w);
        observer.unscattered(face, &photon, rng);
        if !self.meet(face, &mut photon, rng) {
            return Some(photon);
        }
        let mean_free = 1.0 / self.sigma_s;
        loop {
            let free = exponential(rng) * mean_free;
            let depth = photon.depth - free * photon.w.z;
            if depth > 0.0 && depth < self.thickness_mm {
                photon.lengths.slab += free;
                photon.depth = depth;
                if !observer.collision(&photon, rng) {
                    return None;
                }
                photon.w = self.phase.sample(photon.w, rng);
                photon.collisions += 1;
                continue;
            }
            photon.w = photon.w.normalize();
            let (face, ahead) = self.ahead(&photon);
            photon.lengths.slab += ahead;
            photon.lengths.cross(face, photon.w);
            if photon.collisions == 0 {
                observer.unscattered(face, &photon, rng);
            }
            if !self.meet(face, &mut photon, rng) {
                return Some(photon);
            }
        }
    }

    /// A photon's unscattered way through the fibres: one piece for each crossing between the
    /// interfaces, with the weight that fibres have let through so far.
    pub(super) fn beams(&self, w: DVec3, beams: &mut Vec<Beam>, rng: &mut Rng) {
        beams.clear();
        if !w.is_finite() {
            return;
        }
        let (face, mut photon) = self.arrive(w);
        let mut weight = 1.0;
        let mut inside = self.meet(face, &mut photon, rng);
        while inside {
            beams.push(Beam { photon, weight });
            let (face, ahead) = self.ahead(&photon);
            let passed = (-self.sigma_s * ahead).exp();
            // Faint beams live on by chance (Russian roulette).
            weight *= passed;
            if weight < FAINT {
                if uniform(rng) * FAINT >= weight {
                    return;
                }
                weight = FAINT;
            }
            photon.lengths.slab += ahead;
            photon.lengths.cross(face, photon.w);
            inside = self.meet(face, &mut photon, rng);
        }
    }
}

/// Light in the very plane of the sheet arrives at this cosine.
const GRAZING: f64 = 1e-9;

/// Weight below which an unscattered beam lives on by chance only.
const FAINT: f64 = 1e-2;

/// A piece of an unscattered way through the fibres, from one interface to the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beam {
    /// At its start.
    photon: Photon,
    weight: f64,
}

impl Beam {
    pub(super) fn direction(&self) -> DVec3 {
        self.photon.w
    }

    /// Radiance it brings to `depth`, by the flux that arrived per area of the sheet, with
    /// absorption left out; and the lengths up to there. `None` where too little is left and
    /// chance (Russian roulette) is against it.
    #[inline]
    pub(super) fn at(&self, depth: f64, layers: &Layers, rng: &mut Rng) -> Option<(f64, Lengths)> {
        let slant = 1.0 / self.photon.w.z.abs().max(f64::MIN_POSITIVE);
        let ahead = (depth - self.photon.depth).abs() * slant;
        let mut passed = (-layers.sigma_s * ahead).exp();
        if passed < FAINT {
            if uniform(rng) * FAINT >= passed {
                return None;
            }
            passed = FAINT;
        }
        let mut lengths = self.photon.lengths;
        lengths.slab += ahead;
        Some((self.weight * passed * slant, lengths))
    }
}
