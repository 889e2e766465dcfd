//! Pictures by the walk: the judge of whole frames.
//!
//! A picture is made from the same exhibit, scene, lamps and eye as the renderer's. Every path has
//! a place of its own in the pixel, a ray from the eye through it onto the sheet, one point of
//! each lamp, and one walk.
//!
//! # Modes
//! [`Mode::Local`] takes the sheet for plane-parallel at each point: what the tiers are, and are
//! judged by. [`Mode::Lateral`] follows light to where it leaves: [`super::lateral`]. The
//! photograph holds the blur of that way already, and nobody has taken it out: the ink that is
//! looked up is that of the map, so a lateral picture is blurred once more than paper is. It says
//! what being local costs, not what the sheet looked like.
//!
//! # Simplified
//! - Shadows of the relief and of the bent sheet are cast; light that one part of the relief
//!   throws on another is not, and the room's even light reaches all of it. In a lateral walk, light
//!   enters from the lamps that its first point sees.
//! - Film and fibres have one refractive index, that of paper.
//! - A body colour is a slab of its own in place of paper, with its own index and scattering and
//!   the thickness of both (`sheet`); of several on one side, the first stands for all.
//! - Grains are opaque facets that mirror, beside even light of the rest of the photograph
//!   (`media`). Light neither passes between them and the paper nor under them.
//! - On the other side grains stop light from behind; all else there is a film to it. In reflected
//!   light that film shows only through a side whose picture holds none of it
//!   (`paper.show_through = "modelled"`); what a state changed there since the other side was photographed
//!   is left as it was.
//! - A transmission map is uneven thickness (`through`).
//! - A surface as smooth as a mirror does not show the lamps.

mod field;
mod lights;
mod media;
mod relief;
mod shape;
mod sheet;
mod through;
mod tone;

use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;

use super::{
    lateral::{Inks, LateralWalker},
    radiance::{Absorbers, Lamp, Scenery, Walker},
    rng::{Rng, stream, uniform},
    statistics::Sums,
    walk::{Face, LayersError},
};
use crate::{
    manifest::{
        exhibit::{Camera, Exhibit, Scene},
        eye::Eye,
        lighting::{Lighting, TABLE},
    },
    maps::MapError,
    optics::lamp::Light,
};
use media::Grain;
use shape::{Hit, Ray};
use sheet::{Sheet, Spot};

/// Of an eye below the horizon of a facet: as if it grazed it.
const GRAZING: f64 = 1e-3;
/// How far before the sheet a parallel eye's rays begin, in mm.
const BEFORE_MM: f64 = 2e4;
/// Paths that calibrate a side at each roughness, for pixels of so many paths: its albedo is known
/// several times better than a pixel, and at most within .2%.
pub fn capture_paths(samples: u64) -> u64 {
    samples.saturating_mul(1024).clamp(1 << 12, 1 << 18)
}

/// Where light may leave.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Where it entered.
    #[default]
    Local,
    /// Wherever it gets to.
    Lateral,
}

impl Mode {
    /// All of them, in the order of the command line's help.
    pub const ALL: [Self; 2] = [Self::Local, Self::Lateral];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Local => "local",
            Self::Lateral => "lateral",
        }
    }
}

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    #[error(transparent)]
    Map(#[from] MapError),
    #[error("the paper cannot be walked through: {0}")]
    Layers(#[from] LayersError),
}

/// A part of a frame, in pixels from its top left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    pub x: u32,
    pub y: u32,
    pub width: u32,
    pub height: u32,
}

impl Crop {
    /// Whether it has pixels, and all of them lie in a frame of `size`.
    pub fn is_within(&self, [width, height]: [u32; 2]) -> bool {
        let fits = |from: u32, many: u32, all: u32| {
            many > 0 && from.checked_add(many).is_some_and(|end| end <= all)
        };
        fits(self.x, self.width, width) && fits(self.y, self.height, height)
    }
}

/// How a picture is taken.
#[derive(Clone, Copy, Debug)]
pub struct Exposure {
    /// Width and height of the whole frame in pixels.
    pub size: [u32; 2],
    /// The part of it that is wanted; within the frame.
    pub crop: Crop,
    /// Paths of each pixel, ≥ 1.
    pub samples: u64,
    pub seed: u64,
    pub mode: Mode,
}

/// A picture with the variance of its means; rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    pub width: u32,
    pub height: u32,
    /// Linear sRGB relative to a perfect diffuser.
    pub mean: Vec<[f64; 3]>,
    pub variance: Vec<[f64; 3]>,
}

/// A scene with everything decoded and calibrated.
pub struct Studio {
    sheet: Sheet,
    lights: Vec<Light>,
    /// Radiance of the room before the sheet, and of a light table behind it.
    before: [f64; 3],
    behind: [f64; 3],
    eye: Eye,
    size_mm: DVec2,
    /// What a sign's colour is multiplied by, so that the display shows it as it is meant.
    sign_gain: f64,
}

/// What one thread keeps from path to path.
#[derive(Default)]
struct Bench {
    walker: Walker,
    lateral: LateralWalker,
    lamps: Vec<Lamp<3>>,
}

impl Studio {
    /// Decodes the maps of `scene`, a scene of `exhibit`, and undoes its photograph with
    /// as many paths at each roughness as `capture_paths` says ([`capture_paths`]).
    ///
    /// # Errors
    /// [`PictureError`]: a map that cannot be decoded, or paper that is none.
    pub fn new(
        exhibit: &Exhibit,
        scene: &Scene,
        capture_paths: u64,
        seed: u64,
    ) -> Result<Self, PictureError> {
        let Lighting {
            lights,
            ambient,
            light_table,
            ..
        } = exhibit.lighting(scene);
        let size_mm = exhibit.drawing_of(scene).size_mm;
        Ok(Self {
            sheet: Sheet::load(exhibit, scene, capture_paths, seed)?,
            lights,
            before: (ambient / std::f64::consts::PI).to_array(),
            behind: light_table.to_array(),
            eye: Eye::new(&scene.camera, size_mm),
            size_mm,
            sign_gain: 1.0 / scene.exposure.level,
        })
    }

    /// Looks at the same scene through another camera.
    pub fn look(&mut self, camera: &Camera) {
        self.eye = Eye::new(camera, self.size_mm);
    }

    /// Takes a picture; `progress` is called for every pixel that is done. It depends on the
    /// seed and not on the number of threads, and a crop is that part of the whole frame.
    pub fn take(&self, exposure: &Exposure, progress: impl Fn() + Sync) -> Plate {
        let Exposure { size, crop, .. } = *exposure;
        let count = u64::from(crop.width) * u64::from(crop.height);
        let pixels: Vec<([f64; 3], [f64; 3])> = (0..count)
            .into_par_iter()
            .map_init(Bench::default, |bench, index| {
                let at = |index: u64, width: u32| {
                    let width = u64::from(width);
                    [(index % width) as u32, (index / width) as u32]
                };
                let [x, y] = at(index, crop.width);
                let pixel = [crop.x + x, crop.y + y];
                let number = u64::from(pixel[1]) * u64::from(size[0]) + u64::from(pixel[0]);
                let mut rng = stream(exposure.seed, number);
                let estimate = self.pixel(exposure, pixel, bench, &mut rng);
                progress();
                estimate
            })
            .collect();
        let (mean, variance) = pixels.into_iter().unzip();
        Plate {
            width: crop.width,
            height: crop.height,
            mean,
            variance,
        }
    }

    fn pixel(
        &self,
        exposure: &Exposure,
        [x, y]: [u32; 2],
        bench: &mut Bench,
        rng: &mut Rng,
    ) -> ([f64; 3], [f64; 3]) {
        // Places in the pixel by the plastic number's sequence (Roberts 2018), shifted by chance.
        const STEP: DVec2 = DVec2::new(0.754_877_666_246_692_7, 0.569_840_290_998_053_2);
        let shift = DVec2::new(uniform(rng), uniform(rng));
        let size = exposure.size.map(f64::from);
        let mut sums = [Sums::default(); 3];
        for sample in 0..exposure.samples {
            let within = (shift + STEP * sample as f64).fract();
            let at = DVec2::new(f64::from(x), f64::from(y)) + within;
            let ndc = DVec2::new(2.0 * at.x / size[0] - 1.0, 1.0 - 2.0 * at.y / size[1]);
            let seen = self.seen(&self.ray(ndc, size[0] / size[1]), exposure.mode, bench, rng);
            for (sums, seen) in sums.iter_mut().zip(seen) {
                sums.add(seen);
            }
        }
        let estimates = sums.map(|sums| sums.estimate(exposure.samples));
        (
            estimates.map(|estimate| estimate.mean),
            estimates.map(|estimate| estimate.variance),
        )
    }

    fn ray(&self, ndc: DVec2, aspect: f64) -> Ray {
        let eye = &self.eye;
        let on_plane = eye.centre
            + eye.right * (ndc.x * eye.half_width)
            + eye.up * (ndc.y * eye.half_width / aspect);
        match eye.distance {
            Some(distance) => {
                let origin = eye.centre + eye.towards * distance;
                Ray {
                    origin,
                    direction: (on_plane - origin).normalize_or(-eye.towards),
                }
            }
            None => Ray {
                origin: on_plane + eye.towards * BEFORE_MM,
                direction: -eye.towards,
            },
        }
    }

    /// One sample of what is seen along a ray.
    fn seen(&self, ray: &Ray, mode: Mode, bench: &mut Bench, rng: &mut Rng) -> [f64; 3] {
        let table = [f64::from(TABLE); 3];
        let Some(hit) = self.sheet.shape.hit(ray) else {
            return table;
        };
        let coverage = self.sheet.coverage(hit.place).clamp(0.0, 1.0);
        if coverage == 0.0 {
            return table;
        }
        let (albedo, sign) = self.sheet.albedo(hit.place);
        let paper = self.radiance(ray, &hit, albedo, mode, bench, rng);
        std::array::from_fn(|c| {
            let shown = paper[c] * (1.0 - sign[3]) + sign[c] * self.sign_gain;
            table[c] + (shown - table[c]) * coverage
        })
    }

    fn radiance(
        &self,
        ray: &Ray,
        hit: &Hit,
        albedo: [f64; 3],
        mode: Mode,
        bench: &mut Bench,
        rng: &mut Rng,
    ) -> [f64; 3] {
        // The plane of the sheet here, then the facet of its relief.
        let plane = DMat3::from_cols(hit.tangent, hit.normal.cross(hit.tangent), hit.normal);
        let normal = plane * self.sheet.normal(hit.place);
        let along = hit.tangent - normal * normal.dot(hit.tangent);
        let along = along.normalize_or(normal.any_orthonormal_vector());
        let local = DMat3::from_cols(along, normal.cross(along), normal);
        let view = local.transpose() * -ray.direction;
        let view = view.with_z(view.z.max(GRAZING)).normalize();
        let relief = self.sheet.relief.as_ref();
        let is_lit = |towards: DVec3, rng: &mut Rng| {
            let Some(relief) = relief else { return true };
            let towards = plane.transpose() * towards;
            let across = towards.truncate().length();
            // Right overhead nothing is in the way.
            if across < 1e-9 {
                return true;
            }
            let on_side = DVec2::new(towards.x, -towards.y) / across;
            relief.is_lit(hit.place, on_side, towards.z / across, rng)
        };
        let (shape, lamps) = (&self.sheet.shape, &mut bench.lamps);
        lights::gather(&self.lights, hit, &local, shape, is_lit, lamps, rng);
        let scenery = Scenery {
            lamps: &bench.lamps,
            before: self.before,
            behind: self.behind,
        };
        if scenery.is_dark() {
            return [0.0; 3];
        }
        match self.sheet.spot(hit.place, albedo, rng) {
            Spot::Grain(grain) => grain.radiance(view, &scenery, rng),
            Spot::Layered {
                layers,
                before,
                behind,
            } => match mode {
                Mode::Local => {
                    let absorbers = Absorbers {
                        before: &before,
                        behind: &behind,
                    };
                    bench.walker.sample(&layers, absorbers, view, &scenery, rng)
                }
                Mode::Lateral => {
                    let inks = InkMap {
                        sheet: &self.sheet,
                        place: hit.place,
                        onto: plane.transpose() * local,
                    };
                    let sigma_a = before.map(|absorption| absorption.sigma_a);
                    let walker = &mut bench.lateral;
                    walker.sample(&layers, sigma_a, &inks, view, &scenery, rng)
                }
            },
        }
    }
}

/// The inks of a sheet around a place.
struct InkMap<'a> {
    sheet: &'a Sheet,
    place: DVec2,
    /// From the walk's frame to that of the sheet's plane.
    onto: DMat3,
}

impl Inks for InkMap<'_> {
    fn tau(&self, face: Face, place: DVec2, rng: &mut Rng) -> [f64; 3] {
        let away = self.onto * place.extend(0.0);
        // The side frame's y runs down.
        let place = self.place + DVec2::new(away.x, -away.y);
        match face {
            Face::Front => self.sheet.front_tau(place, rng),
            Face::Back => self.sheet.back_tau(place, rng),
        }
    }
}

impl Grain {
    fn radiance(&self, view: DVec3, scenery: &Scenery<3>, rng: &mut Rng) -> [f64; 3] {
        let mut radiance = [0.0; 3];
        for lamp in scenery.lamps.iter().filter(|lamp| lamp.direction.z > 0.0) {
            let mirrored = self.facets.evaluate(-view, lamp.direction, rng);
            let even = lamp.direction.z / std::f64::consts::PI;
            for c in 0..3 {
                let density = self.gloss * mirrored[c] + self.diffuse[c] * even;
                radiance[c] += lamp.irradiance[c] * density;
            }
        }
        if scenery.before != [0.0; 3] {
            let left = self.facets.scatter(-view, rng);
            let mirrored = left.map_or([0.0; 3], |(_, weight)| weight);
            for c in 0..3 {
                let share = self.gloss * mirrored[c] + self.diffuse[c];
                radiance[c] += share * scenery.before[c];
            }
        }
        radiance
    }
}

/// What the judge leaves out of this scene that its manifest asks for, in sentences.
pub fn left_out(exhibit: &Exhibit, scene: &Scene) -> Vec<String> {
    let paper = &exhibit.drawing_of(scene).paper;
    let mut sentences = Vec::new();
    let mut say = |is_asked: bool, what: &str| {
        if is_asked {
            sentences.push(what.to_owned());
        }
    };
    say(
        paper.specular != 1.0,
        "the reference knows no strength of the surface's reflection but the physical one: \
         paper.specular is taken for 1",
    );
    let lobes = paper.retro > 0.0 || paper.sheen > 0.0 || paper.anisotropy > 0.0;
    say(
        lobes,
        "the reference has no retro-reflection, sheen or anisotropy: they are left out",
    );
    say(
        scene.compare.is_some(),
        "the reference compares nothing: it walks the scene's own sheet",
    );
    say(
        !scene.enhance.marks().is_empty(),
        "the reference enhances nothing: it walks the sheet as it is",
    );
    say(
        scene.overlays.iter().any(|(_, opacity)| *opacity > 0.0),
        "the reference draws no legend beside overlays",
    );
    sentences
}
