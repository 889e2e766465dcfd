//! What a side's media maps are needed for.

use std::path::Path;

use super::{MapUse, Terms};
use crate::{
    manifest::exhibit::{Exhibit, MapFile, MediaContent, MediaMap, Side},
    maps::{MatterSlot, MediaChannels, MediaLayer},
    optics::{
        medium::{Matter, ParticleConstants},
        tier::Tier,
    },
};

/// Particles of the sorts that a matter map's first texture holds.
const PARTICLES_OF_FIRST: usize = 2;

/// Media maps of one side, which lie in one place, with something for each medium of theirs.
#[derive(Clone, Debug, PartialEq)]
pub struct MediaStack<T> {
    /// The lowest map.
    pub file: MapFile,
    /// From the lowest to the uppermost.
    pub layers: Vec<MediaLayer<T>>,
}

impl<T> MediaStack<T> {
    fn new(media: &[MediaMap], mut of_medium: impl FnMut(usize) -> T) -> Option<Self> {
        let layers = media
            .iter()
            .map(|map| MediaLayer {
                path: map.file.path.clone(),
                channels: match &map.content {
                    MediaContent::Legend(legend) => MediaChannels::Legend(
                        legend
                            .iter()
                            .map(|(colour, medium)| (*colour, of_medium(*medium)))
                            .collect(),
                    ),
                    MediaContent::Weights(weights) => MediaChannels::Weights(
                        weights.iter().map(|medium| of_medium(*medium)).collect(),
                    ),
                },
            })
            .collect();
        Some(Self {
            file: media.first()?.file.clone(),
            layers,
        })
    }
}

/// The maps that tell a side's media apart, and the roughness that follows from them. Returns
/// what its particles are made of, in the order of their slots.
pub(super) fn matter(
    exhibit: &Exhibit,
    side: &Side,
    paper_alpha: f64,
    terms: &mut Terms,
    maps: &mut Vec<MapUse>,
    say: &mut impl FnMut(String),
) -> Vec<ParticleConstants> {
    let media = &side.media;
    let matter_of = |medium: usize| exhibit.media[medium].matter;
    let mut used = media.iter().flat_map(|map| map.content.media());
    if !used.any(|medium| matter_of(medium) != Matter::Relief) {
        return Vec::new();
    }
    let alpha = |medium| match matter_of(medium) {
        Matter::Relief => None,
        matter => Some(matter.roughness()),
    };
    if terms.specular
        && side.roughness.is_none()
        && let Some(stack) = MediaStack::new(media, alpha)
    {
        say("roughness from the media maps, for the specular lobe: no map of it is given".into());
        terms.roughness_map = true;
        maps.push(MapUse::RoughnessOfMatter(stack, paper_alpha));
    }
    if terms.tier != Tier::Study {
        say(
            "no media maps for the light itself: only the study tier tells inks, particles and \
             body colours apart"
                .into(),
        );
        return Vec::new();
    }
    let particles = particles(exhibit, media);
    let slot = |medium| match matter_of(medium) {
        Matter::Film(_) => MatterSlot::Film,
        Matter::Body(_) => MatterSlot::Body,
        Matter::Particles(_) => {
            let slot = particles.iter().position(|of_slot| *of_slot == medium);
            slot.map_or(MatterSlot::Nothing, MatterSlot::Particles)
        }
        // A manifest names no paper in a media map.
        Matter::Relief | Matter::Paper(_) => MatterSlot::Nothing,
    };
    let Some(stack) = MediaStack::new(media, slot) else {
        return Vec::new();
    };
    let names: Vec<String> = media.iter().map(|map| file_name(&map.file.path)).collect();
    say(format!(
        "media maps {}, in this order: where ink lies as a film, and where particles or body \
         colour cover the paper",
        names.join(", ")
    ));
    terms.matter = 1;
    maps.push(MapUse::Matter(stack.clone()));
    if particles.len() > PARTICLES_OF_FIRST {
        say(format!(
            "a second texture for them: the side has {} sorts of particles, and the first holds \
             {PARTICLES_OF_FIRST}",
            particles.len()
        ));
        terms.matter = 2;
        maps.push(MapUse::MatterMore(stack));
    }
    particles
        .into_iter()
        .filter_map(|medium| match matter_of(medium) {
            Matter::Particles(constants) => Some(constants),
            _ => None,
        })
        .collect()
}

/// The media of a side that are particles, each once, in the order in which they lie.
fn particles(exhibit: &Exhibit, media: &[MediaMap]) -> Vec<usize> {
    let mut found = Vec::new();
    for medium in media.iter().flat_map(|map| map.content.media()) {
        let is_one = matches!(exhibit.media[medium].matter, Matter::Particles(_));
        if is_one && !found.contains(&medium) {
            found.push(medium);
        }
    }
    found
}

fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}
