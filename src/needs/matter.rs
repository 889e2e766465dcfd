//! What a side's media maps are needed for.

use std::path::Path;

use glam::DAffine2;

use super::{MapUse, Terms};
use crate::{
    manifest::exhibit::{Exhibit, MapFile, MediaContent, MediaMap, Paper, Side},
    maps::{MAX_PARTICLES, MatterSlot, MediaChannels, MediaLayer},
    optics::{matter::SideMedia, medium::Matter, tier::Tier},
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
    /// Those of its maps, from the lowest.
    pub fn files(&self) -> Vec<&Path> {
        self.layers
            .iter()
            .map(|layer| layer.path.as_path())
            .collect()
    }

    fn new(media: &[MediaMap], mut of_medium: impl FnMut(usize) -> T) -> Option<Self> {
        let layers = media
            .iter()
            .map(|map| MediaLayer {
                path: map.file.path.clone(),
                warp: map.file.warp.clone(),
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
/// the media; those of a tier that knows none are none.
pub(super) fn matter(
    exhibit: &Exhibit,
    side: &Side,
    paper: &Paper,
    terms: &mut Terms,
    maps: &mut Vec<MapUse>,
    say: &mut impl FnMut(String),
) -> SideMedia {
    let media = &side.media;
    let matter_of = |medium: usize| exhibit.media[medium].matter;
    let mut used = media.iter().flat_map(|map| map.content.media());
    if !used.any(|medium| matter_of(medium) != Matter::Relief) {
        return SideMedia::default();
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
        maps.push(MapUse::RoughnessOfMatter(stack, paper.roughness));
    }
    if terms.tier != Tier::Study {
        say(
            "no media maps for the light itself: only the study tier tells inks, particles and \
             body colours apart"
                .into(),
        );
        return SideMedia::default();
    }
    let sorts = particles(exhibit, media);
    let slot = |medium| match matter_of(medium) {
        Matter::Particles(_) => {
            let slot = sorts.iter().position(|of_slot| *of_slot == medium);
            slot.map_or(MatterSlot::Nothing, MatterSlot::Particles)
        }
        other => slot_of(&other),
    };
    let Some(stack) = MediaStack::new(media, slot) else {
        return SideMedia::default();
    };
    let names: Vec<String> = media.iter().map(|map| file_name(&map.file.path)).collect();
    say(format!(
        "media maps {}, in this order: where ink lies as a film, and where particles or body \
         colour cover the paper",
        names.join(", ")
    ));
    terms.matter = 1;
    maps.push(MapUse::Matter(stack.clone()));
    if sorts.len() > PARTICLES_OF_FIRST {
        say(format!(
            "a second texture for them: the side has {} sorts of particles, and the first holds \
             {PARTICLES_OF_FIRST}",
            sorts.len()
        ));
        terms.matter = 2;
        maps.push(MapUse::MatterMore(stack));
    }
    let media = side_media(exhibit, media);
    if !media.particles.is_empty() {
        say("a lobe for each sort of metal and chalk".into());
        terms.sorts = sorts.len().min(MAX_PARTICLES) as u32;
    }
    terms.body = !media.bodies.is_empty();
    if media.index_differs(paper.index) {
        say("the refractive index of ink and body colour, which is not the paper's".into());
        terms.media_index = true;
    }
    media
}

/// The media of the other side, where they hold back light that comes through. `turn` leads
/// from that side to this one.
pub(super) fn behind(
    exhibit: &Exhibit,
    other: &Side,
    turn: DAffine2,
    terms: &mut Terms,
    maps: &mut Vec<MapUse>,
    say: &mut impl FnMut(String),
) -> SideMedia {
    if terms.tier != Tier::Study {
        return SideMedia::default();
    }
    let media = side_media(exhibit, &other.media);
    if media == SideMedia::default() {
        return SideMedia::default();
    }
    let slot = |medium: usize| slot_of(&exhibit.media[medium].matter);
    let Some(mut stack) = MediaStack::new(&other.media, slot) else {
        return SideMedia::default();
    };
    say(
        "media maps of the other side: ink, particles and body colour there hold light back, and \
         the paper's own tone does not twice"
            .into(),
    );
    stack.file.uv_from_side *= turn;
    terms.other_matter = true;
    maps.push(MapUse::OtherMatter(stack));
    media
}

/// All sorts of particles in one slot.
fn slot_of(matter: &Matter) -> MatterSlot {
    match matter {
        Matter::Film(_) => MatterSlot::Film,
        Matter::Body(_) => MatterSlot::Body,
        Matter::Particles(_) => MatterSlot::Particles(0),
        // A manifest names no paper in a media map.
        Matter::Relief | Matter::Paper(_) => MatterSlot::Nothing,
    }
}

/// The constants of all media that these maps name, each medium once.
fn side_media(exhibit: &Exhibit, media: &[MediaMap]) -> SideMedia {
    let mut found = SideMedia::default();
    let mut seen = Vec::new();
    for medium in media.iter().flat_map(|map| map.content.media()) {
        if seen.contains(&medium) {
            continue;
        }
        seen.push(medium);
        match exhibit.media[medium].matter {
            Matter::Film(film) => found.films.push(film),
            Matter::Body(body) => found.bodies.push(body),
            Matter::Particles(particles) => found.particles.push(particles),
            Matter::Relief | Matter::Paper(_) => {}
        }
    }
    found
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
