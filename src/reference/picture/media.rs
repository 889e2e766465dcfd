//! What lies on a place of a side: film, body colour, grains, paper; and how a photograph is
//! divided between them.
//!
//! Grains and body colour cover shares of a place, and paper with or without ink shows between
//! them. The photograph of a place is theirs in proportion to what the manifest's constants say
//! each would photograph as; where ink lies, it takes from the paper alone what is missing. (This
//! is how a manifest is read, and every renderer reads it so.) Of a grain's own photograph, a share
//! of its area mirrors as facets of its matter do, as large as the photograph leaves room for: no
//! more than it shows, and no less than leaves a rest that reflects all. The rest scatters evenly,
//! as tarnish and binder do.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use glam::{DVec2, DVec3};

use super::{PictureError, field::Field};
use crate::{
    manifest::exhibit::{Exhibit, MediaContent, MediaMap, Side},
    maps::{self, MAX_PARTICLES, MatterPart, MatterSlot, MediaChannels, MediaLayer},
    optics::medium::{BodyConstants, Matter, ParticleConstants},
    reference::{
        conductor::Conductor,
        rng::{Rng, stream, uniform},
    },
};

/// Sorts of grains in the first texture of shares.
const GRAINS_OF_FIRST: usize = 2;
/// Shares and albedos are divided by no less.
const LEAST: f64 = 1e-6;
/// Towards the lamp of reproduction photography.
const LAMP: DVec3 = DVec3::new(FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2);

/// Shares of a place; the rest is paper.
pub(super) struct Shares {
    pub film: f64,
    pub body: f64,
    grains: [f64; MAX_PARTICLES],
}

impl Shares {
    /// Share of all grains.
    pub fn covered(&self) -> f64 {
        self.grains.iter().sum::<f64>().min(1.0)
    }
}

/// A grain of a place.
pub(super) struct Grain {
    pub facets: Conductor,
    /// Share of its area that mirrors.
    pub gloss: f64,
    /// Albedo of what scatters evenly.
    pub diffuse: [f64; 3],
}

/// A sort of grains, and the albedo that its facets photograph as at 45°/0°.
struct Sort {
    facets: Conductor,
    captured: [f64; 3],
    /// Of the whole grain, as the manifest has it.
    albedo: [f64; 3],
}

pub(super) struct Media {
    first: Field,
    more: Option<Field>,
    sorts: Vec<Sort>,
    /// The mean of the side's body colours, as [`crate::optics::matter::Media`] has it: their maps
    /// are one.
    pub body: Option<BodyConstants>,
}

impl Media {
    /// `None` where nothing with a body of its own is drawn.
    pub fn load(
        exhibit: &Exhibit,
        media: &[MediaMap],
        paths: u64,
        seed: u64,
    ) -> Result<Option<Self>, PictureError> {
        let matter = |medium: usize| exhibit.media[medium].matter;
        let used: Vec<usize> = media.iter().flat_map(|map| map.content.media()).collect();
        let Some(lowest) = media.first() else {
            return Ok(None);
        };
        if used.iter().all(|&medium| matter(medium) == Matter::Relief) {
            return Ok(None);
        }
        let mut grains = Vec::new();
        for &medium in &used {
            if matches!(matter(medium), Matter::Particles(_)) && !grains.contains(&medium) {
                grains.push(medium);
            }
        }
        let slot = |medium: usize| match matter(medium) {
            Matter::Film(_) => MatterSlot::Film,
            Matter::Body(_) => MatterSlot::Body,
            Matter::Particles(_) => {
                let number = grains.iter().position(|&grain| grain == medium);
                number.map_or(MatterSlot::Nothing, MatterSlot::Particles)
            }
            Matter::Relief | Matter::Paper(_) => MatterSlot::Nothing,
        };
        let layers = layers(media, slot);
        let field = |part| -> Result<Option<Field>, PictureError> {
            let pyramid = maps::load_matter(&layers, part)?;
            Ok(Field::new(pyramid, lowest.file.uv_from_side))
        };
        let Some(first) = field(MatterPart::First)? else {
            return Ok(None);
        };
        let more = if grains.len() > GRAINS_OF_FIRST {
            field(MatterPart::More)?
        } else {
            None
        };
        let sorts = grains
            .iter()
            .filter_map(|&grain| match matter(grain) {
                Matter::Particles(of) => Some(Sort::new(&of, paths, seed)),
                _ => None,
            })
            .collect();
        let mut bodies = Vec::new();
        for &medium in &used {
            if let Matter::Body(body) = matter(medium)
                && !bodies.contains(&body)
            {
                bodies.push(body);
            }
        }
        let body = mean_body(&bodies);
        Ok(Some(Self {
            first,
            more,
            sorts,
            body,
        }))
    }

    /// What lies on a place that photographs as `albedo`. `bare` and `floor` as for
    /// [`Self::divided`].
    ///
    /// A map names the medium of a stroke, but a faint stroke of metal or chalk is paper between
    /// sparse grains: of the grains there are as many as bring the photograph, with bare paper and
    /// body colour around them, nearest to what it is.
    pub fn shares(&self, place: DVec2, albedo: [f64; 3], bare: [f64; 3], floor: f64) -> Shares {
        let [film, body, a, b] = self.first.at(place);
        let [c, d, e, f] = self.more.as_ref().map_or([0.0; 4], |more| more.at(place));
        let mut shares = Shares {
            film,
            body,
            grains: [a, b, c, d, e, f],
        };
        let covered = shares.covered();
        let of_body = self.body.map_or([0.0; 3], |body| body.albedo);
        let (mut along, mut whole) = (0.0, 0.0);
        for k in 0..3 {
            let grains = self.sorts.iter().zip(shares.grains);
            let grains: f64 = grains.map(|(sort, share)| sort.albedo[k] * share).sum();
            let lit_body = (of_body[k] - floor).max(0.0);
            let around = (bare[k] - floor) * (1.0 - body) + lit_body * body + floor;
            let less = bare[k] * covered - grains;
            along += (around - albedo[k]) * less;
            whole += less * less;
        }
        if whole > 1e-8 {
            let borne_out = (along / whole).clamp(0.0, 1.0);
            shares.grains = shares.grains.map(|share| share * borne_out);
        }
        shares
    }

    /// Divides the photograph of a place. `bare` is that of bare paper, of which the surface
    /// alone shows `floor`.
    pub fn divided(
        &self,
        shares: &Shares,
        albedo: [f64; 3],
        bare: [f64; 3],
        floor: f64,
        rng: &mut Rng,
    ) -> Divided {
        let covered = shares.covered();
        let open = (1.0 - covered - shares.body).max(0.0);
        let body = self.body.map_or([0.0; 3], |body| body.albedo);
        let film = (shares.film / open.max(LEAST)).clamp(0.0, 1.0);
        let mut divided = Divided {
            paper: [0.0; 3],
            body: [0.0; 3],
            grain: None,
        };
        let (mut scale, mut lit) = ([0.0; 3], [0.0; 3]);
        for c in 0..3 {
            let lit_body = (body[c] - floor).max(0.0);
            lit[c] = (albedo[c] - floor * (1.0 - covered)).max(0.0);
            let grains = self.sorts.iter().zip(shares.grains);
            let grains = grains.map(|(sort, share)| sort.albedo[c] * share);
            let hidden = lit_body * shares.body + grains.sum::<f64>();
            let even = lit[c] / ((bare[c] - floor) * open + hidden).max(LEAST);
            let inked = (lit[c] / hidden.max(LEAST)).min(1.0);
            scale[c] = even + (inked - even).max(0.0) * film;
            divided.body[c] = lit_body * scale[c] + floor;
            divided.paper[c] = (lit[c] - hidden * scale[c]).max(0.0) / open.max(LEAST) + floor;
        }
        if covered > 0.0 {
            let mut choice = uniform(rng);
            let sort = self.sorts.iter().zip(shares.grains).find(|(_, share)| {
                choice -= share;
                choice < 0.0
            });
            divided.grain = sort.map(|(sort, _)| sort.grain(scale, lit));
        }
        divided
    }
}

/// The colour that scatters and photographs as `bodies` do in the mean; `None` without any.
fn mean_body(bodies: &[BodyConstants]) -> Option<BodyConstants> {
    let mean = |of: &dyn Fn(&BodyConstants) -> f64| {
        bodies.iter().map(of).sum::<f64>() / bodies.len() as f64
    };
    let thickness_um = mean(&|body| body.thickness_um);
    let depth = mean(&|body| body.scattering_per_mm * body.thickness_um);
    (!bodies.is_empty()).then(|| BodyConstants {
        index: mean(&|body| body.index),
        roughness: mean(&|body| body.roughness),
        scattering_per_mm: depth / thickness_um,
        thickness_um,
        albedo: std::array::from_fn(|channel| mean(&|body| body.albedo[channel])),
    })
}

/// The photograph of a place, divided: the albedo of what lies between its grains, and a grain
/// where chance picks one.
pub(super) struct Divided {
    pub paper: [f64; 3],
    pub body: [f64; 3],
    pub grain: Option<Grain>,
}

impl Sort {
    /// A grain whose constant albedo is to be multiplied by `scale`, at a place that photographs
    /// as `lit`.
    fn grain(&self, scale: [f64; 3], lit: [f64; 3]) -> Grain {
        let mut gloss = 1.0f64;
        let albedo: [f64; 3] = std::array::from_fn(|c| self.albedo[c] * scale[c]);
        for c in 0..3 {
            let mirrored = self.captured[c];
            let most = albedo[c] / mirrored.max(LEAST);
            let room = (1.0 - albedo[c].max(lit[c])) / (1.0 - mirrored).max(LEAST);
            gloss = gloss.min(most).min(room).max(0.0);
        }
        Grain {
            facets: self.facets,
            gloss,
            diffuse: std::array::from_fn(|c| (albedo[c] - gloss * self.captured[c]).max(0.0)),
        }
    }

    fn new(of: &ParticleConstants, paths: u64, seed: u64) -> Self {
        let facets = Conductor::new(of.roughness, of.n, of.k);
        let mut rng = stream(seed, 0);
        let mut captured = [0.0; 3];
        for _ in 0..paths {
            let density = facets.evaluate(DVec3::NEG_Z, LAMP, &mut rng);
            for c in 0..3 {
                captured[c] += PI * density[c] / LAMP.z / paths as f64;
            }
        }
        Self {
            facets,
            captured,
            albedo: of.albedo,
        }
    }
}

fn layers<T>(media: &[MediaMap], of: impl Fn(usize) -> T) -> Vec<MediaLayer<T>> {
    let channels = |content: &MediaContent| match content {
        MediaContent::Legend(legend) => MediaChannels::Legend(
            legend
                .iter()
                .map(|(colour, medium)| (*colour, of(*medium)))
                .collect(),
        ),
        MediaContent::Weights(weights) => {
            MediaChannels::Weights(weights.iter().map(|medium| of(*medium)).collect())
        }
    };
    media
        .iter()
        .map(|map| MediaLayer {
            path: map.file.path.clone(),
            warp: map.file.warp.clone(),
            channels: channels(&map.content),
        })
        .collect()
}

/// Roughness of a side: its map, or what its media say.
pub(super) fn roughness(
    exhibit: &Exhibit,
    side: &Side,
    paper: f64,
) -> Result<Option<Field>, PictureError> {
    if let Some(map) = &side.roughness {
        let pyramid = maps::load_roughness(&map.file, map.gloss)?;
        return Ok(Field::new(pyramid, map.file.uv_from_side));
    }
    let Some(lowest) = side.media.first() else {
        return Ok(None);
    };
    let layers = layers(&side.media, |medium| match exhibit.media[medium].matter {
        Matter::Relief => None,
        matter => Some(matter.roughness()),
    });
    let pyramid = maps::load_roughness_of_matter(&layers, paper)?;
    Ok(Field::new(pyramid, lowest.file.uv_from_side))
}
