//! Light that leaves paper elsewhere than it entered: the walk with its place on the sheet.
//!
//! Ink is a map, looked up wherever a photon crosses a film, so that light enters through one spot
//! and leaves through another. Fibres absorb everywhere as they do where the walk begins, and the
//! sheet is everywhere as thick. The eye's walk and its connections to lamps are those of
//! [`super::radiance`], whose weights are lengths; here each channel has a weight of its own, as
//! every crossing finds another ink.

use glam::{DVec2, DVec3};

use super::{
    radiance::{Lamp, Lighting, Scenery},
    rng::{Rng, exponential, uniform},
    statistics::{Estimate, Sums},
    walk::{Face, Layers, facing},
};

/// Weight below which light lives on by chance only.
const FAINT: f64 = 1e-2;
/// Crossings of a film that a connection to a lamp may have: of those that come back unscattered
/// from the far side, most come once.
const MOST_CROSSINGS: usize = 12;

/// The ink of a sheet.
pub trait Inks {
    /// Optical depth along the normal, per channel, of `face`'s film at `place`: mm along the x
    /// and y of the walk's frame from where it begins.
    fn tau(&self, face: Face, place: DVec2, rng: &mut Rng) -> [f64; 3];
}

/// The same ink everywhere.
impl Inks for [[f64; 3]; 2] {
    fn tau(&self, face: Face, _: DVec2, _: &mut Rng) -> [f64; 3] {
        match face {
            Face::Front => self[0],
            Face::Back => self[1],
        }
    }
}

/// A crossing of a film on a lamp's unscattered way: where, from its first, and how slantingly.
#[derive(Clone, Copy)]
struct Crossing {
    face: Face,
    place: DVec2,
    slant: f64,
}

/// A piece of a lamp's unscattered way, from one interface to the other.
#[derive(Clone, Copy)]
struct Piece {
    w: DVec3,
    depth: f64,
    /// From the way's first crossing.
    place: DVec2,
    weight: f64,
    /// Way in the fibres up to its start, in mm.
    slab: f64,
    /// Crossings up to its start.
    crossings: usize,
}

#[derive(Default)]
struct Way {
    pieces: Vec<Piece>,
    crossings: Vec<Crossing>,
}

/// Walks one path after another and keeps what they need of memory.
#[derive(Default)]
pub(super) struct LateralWalker {
    ways: Vec<Way>,
}

/// What is left of a path, per channel, of light from before the sheet and from behind it: the
/// photograph counts the other side's ink against the latter alone.
#[derive(Clone, Copy)]
struct Kept {
    before: DVec3,
    behind: DVec3,
}

impl Kept {
    fn cross(&mut self, face: Face, tau: [f64; 3], slant: f64) {
        let kept = passed(tau, slant);
        self.behind *= kept;
        if face == Face::Front {
            self.before *= kept;
        }
    }

    fn most(&self) -> f64 {
        self.before.max_element().max(self.behind.max_element())
    }
}

fn passed(tau: [f64; 3], slant: f64) -> DVec3 {
    DVec3::from_array(tau.map(|tau| if tau > 0.0 { (-tau * slant).exp() } else { 1.0 }))
}

fn slant(w: DVec3) -> f64 {
    1.0 / w.z.abs().max(f64::MIN_POSITIVE)
}

impl Layers {
    fn depth_of(&self, face: Face) -> f64 {
        match face {
            Face::Front => 0.0,
            Face::Back => self.thickness_mm,
        }
    }

    /// The interface ahead of a photon at `depth` along `w`, and the way to it.
    fn ahead_of(&self, depth: f64, w: DVec3) -> (Face, f64) {
        if w.z > 0.0 {
            (Face::Front, depth * slant(w))
        } else {
            (Face::Back, (self.thickness_mm - depth) * slant(w))
        }
    }

    fn way(&self, towards: DVec3, way: &mut Way, rng: &mut Rng) {
        way.pieces.clear();
        way.crossings.clear();
        let mut face = if towards.z > 0.0 {
            Face::Front
        } else {
            Face::Back
        };
        let mut w = facing(
            face,
            self.interface(face).scatter(facing(face, -towards), rng),
        );
        let (mut place, mut weight, mut slab) = (DVec2::ZERO, 1.0, 0.0);
        while facing(face, w).z < 0.0 && way.crossings.len() < MOST_CROSSINGS {
            let cross = |face, place, w| Crossing {
                face,
                place,
                slant: slant(w),
            };
            way.crossings.push(cross(face, place, w));
            let depth = self.depth_of(face);
            way.pieces.push(Piece {
                w,
                depth,
                place,
                weight,
                slab,
                crossings: way.crossings.len(),
            });
            let (next, ahead) = self.ahead_of(depth, w);
            weight *= (-self.sigma_s * ahead).exp();
            if weight < FAINT {
                if uniform(rng) * FAINT >= weight {
                    return;
                }
                weight = FAINT;
            }
            slab += ahead;
            place += w.truncate() * ahead;
            face = next;
            way.crossings.push(cross(face, place, w));
            w = facing(face, self.interface(face).scatter(facing(face, w), rng));
        }
    }
}

struct Eye<'a, I> {
    layers: &'a Layers,
    sigma_a: DVec3,
    inks: &'a I,
    radiance: DVec3,
}

impl<I: Inks> Eye<'_, I> {
    fn of(kept: &Kept, lamp: &Lamp<3>) -> DVec3 {
        let kept = if lamp.direction.z > 0.0 {
            kept.before
        } else {
            kept.behind
        };
        kept * DVec3::from_array(lamp.irradiance)
    }

    /// Light of a lamp that has met no fibres, off an interface.
    fn unscattered(
        &mut self,
        face: Face,
        w: DVec3,
        kept: &Kept,
        scenery: &Scenery<3>,
        rng: &mut Rng,
    ) {
        for lamp in scenery.lamps {
            let out = facing(face, lamp.direction);
            if out.z > 0.0 {
                let interface = self.layers.interface(face);
                self.radiance +=
                    Self::of(kept, lamp) * interface.evaluate(facing(face, w), out, rng);
            }
        }
    }

    /// Light of a lamp that fibres at `depth` below `place` scatter once, into a path along `w`.
    fn connect(
        &mut self,
        lamp: &Lamp<3>,
        way: &Way,
        (w, depth, place): (DVec3, f64, DVec2),
        light: DVec3,
        rng: &mut Rng,
    ) {
        let layers = self.layers;
        for piece in &way.pieces {
            let slant = slant(piece.w);
            let ahead = (depth - piece.depth).abs() * slant;
            let mut beam = (-layers.sigma_s * ahead).exp();
            if beam < FAINT {
                if uniform(rng) * FAINT >= beam {
                    continue;
                }
                beam = FAINT;
            }
            let entry = place - piece.place - piece.w.truncate() * ahead;
            let mut kept = (-self.sigma_a * (piece.slab + ahead)).exp();
            for crossing in &way.crossings[..piece.crossings] {
                // The photograph holds the other side's ink against a lamp before the sheet.
                if crossing.face == Face::Front || lamp.direction.z < 0.0 {
                    let tau = self.inks.tau(crossing.face, entry + crossing.place, rng);
                    kept *= passed(tau, crossing.slant);
                }
            }
            let p = layers.phase.value(-piece.w.dot(w));
            let n_2 = layers.n * layers.n;
            let factor = lamp.direction.z.abs() / n_2 * piece.weight * beam * slant * p;
            self.radiance += light * kept * factor;
        }
    }
}

impl LateralWalker {
    /// One sample of the radiance in the direction `view`, of fibres that absorb `sigma_a` per mm.
    pub fn sample(
        &mut self,
        layers: &Layers,
        sigma_a: [f64; 3],
        inks: &impl Inks,
        view: DVec3,
        scenery: &Scenery<3>,
        rng: &mut Rng,
    ) -> [f64; 3] {
        let count = scenery.lamps.len();
        if self.ways.len() < count {
            self.ways.resize_with(count, Way::default);
        }
        for (lamp, way) in scenery.lamps.iter().zip(&mut self.ways) {
            layers.way(lamp.direction, way, rng);
        }
        let mut eye = Eye {
            layers,
            sigma_a: DVec3::from_array(sigma_a),
            inks,
            radiance: DVec3::ZERO,
        };
        let mut kept = Kept {
            before: DVec3::ONE,
            behind: DVec3::ONE,
        };
        let mut place = DVec2::ZERO;
        let mut face = Face::Front;
        let mut w = -view;
        let mut collisions = 0u32;
        eye.unscattered(face, w, &kept, scenery, rng);
        loop {
            w = facing(face, layers.interface(face).scatter(facing(face, w), rng));
            if facing(face, w).z > 0.0 {
                let around = match face {
                    Face::Front => kept.before * DVec3::from_array(scenery.before),
                    Face::Back => kept.behind * DVec3::from_array(scenery.behind),
                };
                return (eye.radiance + around).to_array();
            }
            kept.cross(face, inks.tau(face, place, rng), slant(w));
            let mut depth = layers.depth_of(face);
            // From collision to collision, up to the next interface.
            loop {
                let free = exponential(rng) / layers.sigma_s;
                let (next, ahead) = layers.ahead_of(depth, w);
                let step = free.min(ahead);
                let through = (-eye.sigma_a * step).exp();
                kept.before *= through;
                kept.behind *= through;
                place += w.truncate() * step;
                if free >= ahead {
                    w = w.normalize();
                    kept.cross(next, inks.tau(next, place, rng), slant(w));
                    face = next;
                    if collisions == 0 {
                        eye.unscattered(face, w, &kept, scenery, rng);
                    }
                    break;
                }
                depth -= free * w.z;
                for (lamp, way) in scenery.lamps.iter().zip(&self.ways) {
                    let light = Eye::<[[f64; 3]; 2]>::of(&kept, lamp);
                    eye.connect(lamp, way, (w, depth, place), light, rng);
                }
                w = layers.phase.sample(w, rng);
                collisions += 1;
                if collisions.is_multiple_of(16) {
                    let most = kept.most();
                    if most < FAINT {
                        let survival = (most / FAINT).max(0.05);
                        if uniform(rng) >= survival {
                            return eye.radiance.to_array();
                        }
                        kept.before /= survival;
                        kept.behind /= survival;
                    }
                }
            }
        }
    }
}

/// Radiance per channel in the direction `view` (away from the sheet, a unit vector), with the
/// variance of its mean over `samples` walks that begin at the place 0: [`super::radiance`] with
/// light that leaves elsewhere than it entered. `lighting` as there.
pub fn radiance(
    layers: &Layers,
    sigma_a: [f64; 3],
    inks: &impl Inks,
    view: DVec3,
    lighting: &Lighting<3>,
    samples: u64,
    rng: &mut Rng,
) -> [Estimate; 3] {
    let mut sums = [Sums::default(); 3];
    let mut walker = LateralWalker::default();
    let scenery = Scenery {
        lamps: lighting.lamps,
        before: [0.0; 3],
        behind: lighting.table,
    };
    for _ in 0..samples {
        let radiance = walker.sample(layers, sigma_a, inks, view, &scenery, rng);
        for (sums, radiance) in sums.iter_mut().zip(radiance) {
            sums.add(radiance);
        }
    }
    sums.map(|sums| sums.estimate(samples))
}
