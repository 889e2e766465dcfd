//! What lies on a place of a side: film, body colour, grains, paper; and how a photograph is
//! divided between them.
//!
//! Grains cover a share of a place, opaque, and paper with or without ink shows between them. The
//! photograph is the paper's as far as bare paper can explain it, and the grains' beyond that:
//! first what their facets mirror, then what tarnish and binder scatter evenly. Fresh metal would
//! often photograph brighter than a stroke does; then so much less of it is there.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use glam::{DVec2, DVec3};

use super::{PictureError, field::Field};
use crate::{
    manifest::exhibit::{Exhibit, MediaContent, MediaMap, Side},
    maps::{self, MAX_PARTICLES, MatterPart, MatterSlot, MediaChannels, MediaLayer},
    optics::medium::{BodyConstants, Matter},
    reference::{
        conductor::Conductor,
        rng::{Rng, stream, uniform},
    },
};

/// Sorts of grains in the first texture of shares.
const GRAINS_OF_FIRST: usize = 2;
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
}

pub(super) struct Media {
    first: Field,
    more: Option<Field>,
    sorts: Vec<Sort>,
    /// The first body colour on the side, which stands for all.
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
                Matter::Particles(of) => {
                    let facets = Conductor::new(of.roughness, of.n, of.k);
                    Some(Sort::new(facets, paths, seed))
                }
                _ => None,
            })
            .collect();
        let body = used.iter().find_map(|&medium| match matter(medium) {
            Matter::Body(body) => Some(body),
            _ => None,
        });
        Ok(Some(Self {
            first,
            more,
            sorts,
            body,
        }))
    }

    pub fn shares(&self, place: DVec2) -> Shares {
        let [film, body, a, b] = self.first.at(place);
        let [c, d, e, f] = self.more.as_ref().map_or([0.0; 4], |more| more.at(place));
        Shares {
            film,
            body,
            grains: [a, b, c, d, e, f],
        }
    }

    /// Divides the photograph of a place: the albedo of what lies between its grains, where
    /// `bare` is that of bare paper; and a grain where chance picks one.
    pub fn divided(
        &self,
        shares: &Shares,
        albedo: [f64; 3],
        bare: [f64; 3],
        rng: &mut Rng,
    ) -> ([f64; 3], Option<Grain>) {
        let covered = shares.covered();
        if covered <= 0.0 {
            return (albedo, None);
        }
        let between = beside(shares, albedo, bare);
        let mut choice = uniform(rng);
        let Some(sort) = self
            .sorts
            .iter()
            .zip(shares.grains)
            .find_map(|(sort, share)| {
                choice -= share;
                (choice < 0.0).then_some(sort)
            })
        else {
            return (between, None);
        };
        let mut mirrored = [0.0; 3];
        for (sort, share) in self.sorts.iter().zip(shares.grains) {
            for c in 0..3 {
                mirrored[c] += sort.captured[c] * share / covered;
            }
        }
        // What the grains alone photograph as.
        let grains: [f64; 3] = std::array::from_fn(|c| {
            ((albedo[c] - between[c] * (1.0 - covered)) / covered).max(0.0)
        });
        let gloss = (0..3)
            .map(|c| grains[c] / mirrored[c].max(1e-9))
            .fold(1.0, f64::min);
        let grain = Grain {
            facets: sort.facets,
            gloss,
            diffuse: std::array::from_fn(|c| (grains[c] - gloss * mirrored[c]).max(0.0)),
        };
        (between, Some(grain))
    }
}

/// The albedo of what lies between the grains of a place: the photograph as far as paper, `bare`
/// at most, explains it.
pub(super) fn beside(shares: &Shares, albedo: [f64; 3], bare: [f64; 3]) -> [f64; 3] {
    let open = 1.0 - shares.covered();
    if open >= 1.0 {
        return albedo;
    }
    std::array::from_fn(|c| (albedo[c] / open.max(1e-9)).min(bare[c]))
}

impl Sort {
    fn new(facets: Conductor, paths: u64, seed: u64) -> Self {
        let mut rng = stream(seed, 0);
        let mut captured = [0.0; 3];
        for _ in 0..paths {
            let density = facets.evaluate(DVec3::NEG_Z, LAMP, &mut rng);
            for c in 0..3 {
                captured[c] += PI * density[c] / LAMP.z / paths as f64;
            }
        }
        Self { facets, captured }
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
        let pyramid = maps::load_roughness(&map.file.path, map.gloss)?;
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
