//! The other side's ink in reflected light.

use glam::DVec3;

use super::{MapUse, Terms, matter};
use crate::{
    colour::{delta_e00, lab_from_linear},
    manifest::exhibit::{
        BARE_PAPER, ColourMap, Drawing, Exhibit, LampKind, Over, Scene, Side, SideName,
    },
    optics::{ink::DEPTH_MAX, matter::SideMedia, medium::Matter, show_through::Backed, tier::Tier},
};

/// Of the ΔE00 that the exhibit allows: less than this share is not worth a map.
const WORTH: f64 = 0.25;

/// What the other side's ink does to the light that this side reflects, beyond what its picture
/// holds. Returns what lies on the other side, where that is not known yet.
pub(super) fn show_through(
    exhibit: &Exhibit,
    scene: &Scene,
    drawing: &Drawing,
    name: SideName,
    terms: &mut Terms,
    maps: &mut Vec<MapUse>,
    say: &mut impl FnMut(String),
) -> SideMedia {
    let none = SideMedia::default();
    let mut lamps = scene.lamps.iter().map(|&lamp| &exhibit.lamps[lamp].kind);
    if scene.enhance.relief_only || !terms.ambient && lamps.all(LampKind::is_behind) {
        return none;
    }
    let Some(other) = drawing.side_in_state(name.other(), scene.state) else {
        return none;
    };
    let (here, there) = (name.word(), name.other().word());
    let over = drawing.photographed_over(name, scene.state);
    let (depth, why) = match over {
        Over::Same => {
            say(format!(
                "no show-through of the {there}'s ink is computed: the picture of the {here} holds \
                 it, as it was photographed (paper.show_through = \"photographed\")"
            ));
            return none;
        }
        Over::Nothing => (
            deepest(exhibit, &other),
            format!("of which the picture of the {here} holds none"),
        ),
        // More or less of it by all that a film can be.
        Over::Other(_) => (
            DVec3::splat(DEPTH_MAX),
            format!("other than when the {here} was photographed"),
        ),
    };
    let paper = &drawing.paper;
    let albedo = DVec3::from(paper.albedo.unwrap_or(BARE_PAPER));
    let backed = Backed::new(albedo, paper.index, &paper.slab(), depth);
    let lab = |colour: DVec3| lab_from_linear(colour.to_array());
    let worth = delta_e00(lab(backed.bare), lab(backed.inked));
    let passes = backed.transmitted.max_element();
    let sheet = format!("the paper's T0 is {passes:.3}");
    let allowed = exhibit.accuracy.max_delta_e;
    if worth < WORTH * allowed {
        say(format!(
            "no show-through of the {there}'s ink, {why}: it is ΔE00 {worth:.2} at most, less than \
             a quarter of the {allowed} that is allowed ({sheet})"
        ));
        return none;
    }
    if terms.tier != Tier::Study {
        say(format!(
            "no show-through of the {there}'s ink, {why}: only the study tier computes it; without \
             it the {here} is up to ΔE00 {worth:.2} off ({sheet})"
        ));
        return none;
    }
    say(format!(
        "show-through of the {there}'s ink, {why}: without it the {here} would be up to ΔE00 \
         {worth:.2} off ({sheet})"
    ));
    terms.show_through = true;
    let turn = drawing.recto_from(SideName::Verso);
    let turned = |map: &ColourMap| {
        let mut map = map.clone();
        // Turning the sheet over twice leads back: either way is the same.
        map.file.uv_from_side *= turn;
        map
    };
    let is_known = terms.other_albedo;
    if !is_known {
        terms.other_albedo = true;
        maps.push(MapUse::OtherAlbedo(turned(&other.albedo)));
    }
    if let Over::Other(map) = over {
        // Both are told by their darkness alone: of media then nobody knows.
        terms.photographed = true;
        maps.push(MapUse::Photographed(turned(map)));
        return none;
    }
    if is_known {
        return none;
    }
    matter::behind(exhibit, &other, turn, terms, maps, say)
}

/// τ of the deepest ink that lies on a side; of all that there can be where nothing tells.
fn deepest(exhibit: &Exhibit, side: &Side) -> DVec3 {
    let media = side.media.iter().flat_map(|map| map.content.media());
    let depths: Vec<DVec3> = media
        .filter_map(|medium| match exhibit.media[medium].matter {
            Matter::Relief => None,
            Matter::Film(film) => Some(film.depth.into()),
            // What covers counts as ink that photographs as dark.
            _ => Some(DVec3::splat(DEPTH_MAX)),
        })
        .collect();
    let deepest = depths.iter().copied().reduce(DVec3::max);
    deepest.unwrap_or(DVec3::splat(DEPTH_MAX))
}
