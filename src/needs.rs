//! What a scene requires, and why: the terms of its shader, its maps, the sides that are seen.
//!
//! Nothing else decides what is loaded or which pipeline is specialised; `recto check
//! --explain` prints these reasons.

mod lobes;
mod matter;
mod show_through;

use std::path::Path;

use glam::DVec2;

use crate::{
    manifest::exhibit::{
        ColourMap, Drawing, Exhibit, HeightMap, LampKind, LegendEntry, MapFile, NormalMap, Overlay,
        OverlayKind, RoughnessMap, Scene, Side, SideName, Surface,
    },
    maps::{self, MapError, MatterPart, MatterSlot, Pyramid},
    optics::{matter::SideMedia, tier::Tier},
};
pub use matter::MediaStack;

/// From this tilt on, in degrees, a curved sheet can show its other side past its own edge.
const BOTH_SIDES_TILT_DEG: f64 = 60.0;

/// Lamps this high at the middle of the sheet, in degrees, and higher ones cast no shadows of its
/// relief: few slopes of paper are as steep.
const SHADOWS_BELOW_DEG: f64 = 45.0;

/// The parts of the shader that a side needs: one pipeline for each distinct value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Terms {
    pub tier: Tier,
    /// Normals and tangents come with the mesh.
    pub curved: bool,
    /// A normal map bends the normal.
    pub normal_map: bool,
    pub roughness_map: bool,
    /// The relief's heights are marched towards each lamp.
    pub relief_shadows: bool,
    /// How many textures tell the side's media apart: 0, 1, or 2 for more than two sorts of
    /// particles.
    pub matter: u32,
    /// Sorts of metal and chalk that lie on the side, up to the most that a shader tells apart.
    pub sorts: u32,
    /// Body colour lies on the side.
    pub body: bool,
    /// Ink or body colour has a surface of another refractive index than the paper's.
    pub media_index: bool,
    /// A map decides where there is paper.
    pub outline: bool,
    /// The sheet's straight edge is smoothed.
    pub edge: bool,
    /// All maps of the side lie on the sheet alike: one texture coordinate serves them.
    pub shared_uv: bool,
    pub specular: bool,
    pub ambient: bool,
    pub area_lamps: bool,
    /// A lamp shines as its photometric file says.
    pub ies: bool,
    /// All lamps are distant: neither place nor distance matters.
    pub distant_lamps: bool,
    /// There is no loop over lamps.
    pub one_lamp: bool,
    /// The eye is in one direction from everywhere.
    pub parallel_eye: bool,
    /// Light comes through the sheet.
    pub transmission: bool,
    /// A map says how much of it, from place to place.
    pub transmission_map: bool,
    /// The other side has a picture, whose ink that light crosses, or shows through.
    pub other_albedo: bool,
    /// Body colour or particles on the other side hold light back.
    pub other_matter: bool,
    /// The other side's ink darkens the light that this side reflects.
    pub show_through: bool,
    /// A picture says what ink of the other side this side's picture holds already.
    pub photographed: bool,
    /// A share of the gloss goes back to the lamp.
    pub retro: bool,
    pub sheen: bool,
    /// The gloss spreads more one way than across it.
    pub anisotropic: bool,
    /// How many overlays lie on the side.
    pub overlays: u32,
    /// A comparison gives part of the picture to another member.
    pub cut: bool,
}

/// A map with the property it is read for.
#[derive(Clone, Debug, PartialEq)]
pub enum MapUse {
    Albedo(ColourMap),
    Normal(NormalMap),
    /// Normals from the slopes of a height map, where no normal map is given; with the size of
    /// its picture on the sheet in mm.
    NormalFromHeight(HeightMap, DVec2),
    Roughness(RoughnessMap),
    /// For the shadows of the relief.
    Height(HeightMap),
    /// Roughness from the media and that of the paper between them, where no map of it is given.
    RoughnessOfMatter(MediaStack<Option<f64>>, f64),
    /// Shares of film, body colour, and particles of slots 0 and 1.
    Matter(MediaStack<MatterSlot>),
    /// Shares of particles of slots 2 to 5.
    MatterMore(MediaStack<MatterSlot>),
    Outline(MapFile),
    Transmission(MapFile),
    /// What the other side shows, for light that comes through it, and for its ink in reflected light.
    OtherAlbedo(ColourMap),
    /// What it showed when this side was photographed.
    Photographed(ColourMap),
    /// Shares of film, body colour and particles there, all sorts of these in one.
    OtherMatter(MediaStack<MatterSlot>),
    Overlay(Overlay),
}

impl MapUse {
    /// The file behind it, the lowest of several.
    pub fn file(&self) -> &MapFile {
        match self {
            Self::Albedo(map) => &map.file,
            Self::Normal(map) => &map.file,
            Self::NormalFromHeight(map, _) => &map.file,
            Self::Roughness(map) => &map.file,
            Self::Height(map) => &map.file,
            Self::Outline(file) | Self::Transmission(file) => file,
            Self::OtherAlbedo(map) | Self::Photographed(map) => &map.file,
            Self::RoughnessOfMatter(stack, _) => &stack.file,
            Self::Matter(stack) | Self::MatterMore(stack) | Self::OtherMatter(stack) => &stack.file,
            Self::Overlay(overlay) => &overlay.file,
        }
    }

    /// Every file that it is made of.
    pub fn files(&self) -> Vec<&Path> {
        match self {
            Self::RoughnessOfMatter(stack, _) => stack.files(),
            Self::Matter(stack) | Self::MatterMore(stack) | Self::OtherMatter(stack) => {
                stack.files()
            }
            Self::Overlay(overlay) => overlay.files(),
            map => vec![&map.file().path],
        }
    }

    /// The same, to change where it lies.
    pub fn file_mut(&mut self) -> &mut MapFile {
        match self {
            Self::Albedo(map) => &mut map.file,
            Self::Normal(map) => &mut map.file,
            Self::NormalFromHeight(map, _) => &mut map.file,
            Self::Roughness(map) => &mut map.file,
            Self::Height(map) => &mut map.file,
            Self::Outline(file) | Self::Transmission(file) => file,
            Self::OtherAlbedo(map) | Self::Photographed(map) => &mut map.file,
            Self::RoughnessOfMatter(stack, _) => &mut stack.file,
            Self::Matter(stack) | Self::MatterMore(stack) | Self::OtherMatter(stack) => {
                &mut stack.file
            }
            Self::Overlay(overlay) => &mut overlay.file,
        }
    }

    /// Decodes it: the one place where a map's file becomes texels.
    ///
    /// # Errors
    /// Where the file cannot be read, or is not what it is read for.
    pub fn load(&self) -> Result<Pyramid, MapError> {
        let file = self.file();
        match self {
            Self::Albedo(map) | Self::OtherAlbedo(map) | Self::Photographed(map) => {
                maps::load_colour(file, map.encoding)
            }
            Self::Normal(map) => maps::load_normal(file, map.y),
            Self::NormalFromHeight(map, extent_mm) => {
                maps::load_normal_from_height(file, map.range_um, *extent_mm)
            }
            Self::Roughness(map) => maps::load_roughness(file, map.gloss),
            Self::RoughnessOfMatter(stack, paper) => {
                maps::load_roughness_of_matter(&stack.layers, *paper)
            }
            Self::Matter(stack) | Self::OtherMatter(stack) => {
                maps::load_matter(&stack.layers, MatterPart::First)
            }
            Self::MatterMore(stack) => maps::load_matter(&stack.layers, MatterPart::More),
            Self::Outline(_) => maps::load_outline(&file.path),
            Self::Transmission(_) | Self::Height(_) => maps::load_height(file),
            Self::Overlay(overlay) => overlay.load(),
        }
    }

    /// What it is read for, in a word.
    pub fn role(&self) -> &'static str {
        match self {
            Self::Albedo(_) => "albedo",
            Self::Normal(_) => "normal",
            Self::NormalFromHeight(..) => "normal from height",
            Self::Roughness(_) => "roughness",
            Self::Height(_) => "height",
            Self::RoughnessOfMatter(..) => "roughness from media",
            Self::Matter(_) => "media",
            Self::MatterMore(_) => "more media",
            Self::Outline(_) => "outline",
            Self::Transmission(_) => "transmission",
            Self::OtherAlbedo(_) => "albedo of the other side",
            Self::Photographed(_) => "albedo of the other side when this one was photographed",
            Self::OtherMatter(_) => "media of the other side",
            Self::Overlay(_) => "overlay",
        }
    }

    /// Bytes on the GPU, mipmaps included, as the loader stores it.
    pub fn gpu_bytes(&self) -> u64 {
        let [width, height] = self.file().size.map(u64::from);
        let texel = match self {
            Self::Albedo(_)
            | Self::OtherAlbedo(_)
            | Self::Photographed(_)
            | Self::Overlay(_)
            | Self::Normal(_)
            | Self::NormalFromHeight(..) => 8,
            Self::Roughness(_) | Self::Height(_) | Self::Transmission(_) => 2,
            Self::Outline(_) => 1,
            Self::Matter(_) | Self::MatterMore(_) | Self::OtherMatter(_) => 4,
            Self::RoughnessOfMatter(..) => 1,
        };
        width * height * texel * 4 / 3
    }
}

/// What one side of a scene requires.
#[derive(Clone, Debug, PartialEq)]
pub struct SideNeeds {
    pub side: SideName,
    pub terms: Terms,
    /// Overlays last, from the lowest.
    pub maps: Vec<MapUse>,
    /// What lies on it, where the tier tells media apart.
    pub media: SideMedia,
    /// What lies on the other side, where light comes through or its ink shows.
    pub other_media: SideMedia,
    /// How many times steeper the relief is shown.
    pub exaggerate: f64,
}

/// What a scene requires.
#[derive(Clone, Debug, PartialEq)]
pub struct Needs {
    /// The scene's own side first.
    pub sides: Vec<SideNeeds>,
    /// Why each thing is, or is not, required: sentences for the curator.
    pub reasons: Vec<String>,
}

impl Needs {
    /// What `scene` of `exhibit` requires at `tier`. `both_sides` adds the hidden side, for a
    /// sheet that somebody is turning.
    pub fn of(exhibit: &Exhibit, scene: &Scene, tier: Tier, both_sides: bool) -> Self {
        let drawing = &exhibit.drawings[scene.drawing];
        let mut reasons = Vec::new();
        let curved = drawing.surface != Surface::Flat;
        let mut names = vec![scene.side];
        if both_sides {
            names.push(scene.side.other());
            reasons.push("both sides: the sheet is being turned".into());
        } else if curved && scene.camera.tilt.0 >= BOTH_SIDES_TILT_DEG {
            names.push(scene.side.other());
            reasons.push(format!(
                "both sides: a curved sheet seen from {}° can show its other side",
                scene.camera.tilt.0
            ));
        }
        let sides = names
            .into_iter()
            .map(|side| side_needs(exhibit, scene, drawing, side, tier, &mut reasons))
            .collect();
        Self { sides, reasons }
    }

    /// Bytes of all maps on the GPU.
    pub fn gpu_bytes(&self) -> u64 {
        self.sides
            .iter()
            .flat_map(|side| &side.maps)
            .map(MapUse::gpu_bytes)
            .sum()
    }
}

fn side_needs(
    exhibit: &Exhibit,
    scene: &Scene,
    drawing: &Drawing,
    name: SideName,
    tier: Tier,
    reasons: &mut Vec<String>,
) -> SideNeeds {
    let mut say = |text: String| reasons.push(format!("{}: {text}", name.word()));
    let mut maps = Vec::new();
    let mut media = SideMedia::default();
    let side = drawing.side_in_state(name, scene.state);
    let mut terms = Terms {
        tier,
        curved: drawing.surface != Surface::Flat,
        ..Terms::default()
    };

    let shown: Vec<&LampKind> = scene
        .lamps
        .iter()
        .map(|&lamp| &exhibit.lamps[lamp].kind)
        .filter(|kind| !kind.is_behind())
        .collect();
    terms.area_lamps = tier != Tier::Draft
        && shown
            .iter()
            .any(|kind| matches!(kind, LampKind::Rectangle { .. } | LampKind::Disc { .. }));
    terms.ies = shown
        .iter()
        .any(|kind| matches!(kind, LampKind::Ies { .. }));
    terms.distant_lamps = shown
        .iter()
        .all(|kind| matches!(kind, LampKind::Distant { .. }));
    terms.one_lamp = shown.len() == 1;
    terms.parallel_eye = scene.camera.distance_mm.is_none();
    let directional = !shown.is_empty();
    terms.ambient = scene.ambient.illuminance.0 > 0.0;
    terms.specular = tier != Tier::Lambert && drawing.paper.specular > 0.0;

    match &side {
        None => say("no maps, it is bare paper".into()),
        Some(side) => {
            if scene.enhance.relief_only {
                say("no albedo and no media: relief only".into());
            } else {
                say(format!("albedo from {}", side.albedo.file.path.display()));
                maps.push(MapUse::Albedo(side.albedo.clone()));
            }
            relief(side, directional, &mut terms, &mut maps, &mut say);
            relief_shadows(side, &shown, &mut terms, &mut maps, &mut say);
            if let Some(roughness) = &side.roughness {
                // Their diffuse terms know of roughness too.
                let rough_diffuse = matches!(tier, Tier::OrenNayar | Tier::Isle);
                if terms.specular || rough_diffuse {
                    say("roughness map, for the tier's lobes".into());
                    terms.roughness_map = true;
                    maps.push(MapUse::Roughness(roughness.clone()));
                } else {
                    say("no roughness map: nothing is specular".into());
                }
            }
            if !scene.enhance.relief_only {
                let paper = &drawing.paper;
                media = matter::matter(exhibit, side, paper, &mut terms, &mut maps, &mut say);
            }
        }
    }
    if let Some(outline) = &drawing.outline {
        say("outline map, for edges, losses and holes".into());
        terms.outline = true;
        let mut outline = outline.clone();
        outline.uv_from_side *= drawing.recto_from(name);
        maps.push(MapUse::Outline(outline));
    }
    lobes::lobes(&drawing.paper, directional, &mut terms, &mut say);
    let mut other_media = transmission(
        exhibit, scene, drawing, name, &mut terms, &mut maps, &mut say,
    );
    let of_reflected = show_through::show_through(
        exhibit, scene, drawing, name, &mut terms, &mut maps, &mut say,
    );
    if !terms.transmission {
        other_media = of_reflected;
    }
    // The mesh of a curled sheet ends where the sheet does, and an outline cuts within it; a flat
    // one reaches further, for the smooth step.
    terms.edge = !(terms.curved && terms.outline);
    if name == scene.side {
        for (overlay, opacity) in scene.laid(drawing) {
            say(format!(
                "overlay \"{}\" at {:.0}%{}",
                overlay.id,
                opacity * 100.0,
                of_categories(&overlay, drawing)
            ));
            terms.overlays += 1;
            maps.push(MapUse::Overlay(overlay));
        }
    }
    let mut of_side = maps.iter().filter(|map| {
        !matches!(
            map,
            MapUse::Overlay(_)
                | MapUse::Height(_)
                | MapUse::Transmission(_)
                | MapUse::OtherAlbedo(_)
                | MapUse::Photographed(_)
                | MapUse::OtherMatter(_)
        )
    });
    let first = of_side.next().map(|map| map.file().uv_from_side);
    terms.shared_uv = of_side.all(|map| Some(map.file().uv_from_side) == first);
    if tier == Tier::Draft
        && shown
            .iter()
            .any(|kind| matches!(kind, LampKind::Rectangle { .. } | LampKind::Disc { .. }))
    {
        say("rectangle and disc lamps as points: the draft tier".into());
    }
    SideNeeds {
        side: name,
        terms,
        maps,
        media,
        other_media,
        exaggerate: scene.enhance.exaggerate,
    }
}

/// Which of its categories are shown, where not all are.
fn of_categories(shown: &Overlay, drawing: &Drawing) -> String {
    let OverlayKind::Categorical(legend) = &shown.kind else {
        return String::new();
    };
    match drawing.overlay(&shown.id) {
        Some((_, whole)) if whole.kind != shown.kind => {
            let names: Vec<&str> = legend.iter().map(LegendEntry::name).collect();
            format!(", only {}", names.join(", "))
        }
        _ => String::new(),
    }
}

/// Light through the sheet: from a light table behind it. Returns what lies on the other side.
fn transmission(
    exhibit: &Exhibit,
    scene: &Scene,
    drawing: &Drawing,
    name: SideName,
    terms: &mut Terms,
    maps: &mut Vec<MapUse>,
    say: &mut impl FnMut(String),
) -> SideMedia {
    if !scene.is_lit_from_behind(exhibit) {
        return SideMedia::default();
    }
    say("light through the sheet, from the light table".into());
    terms.transmission = true;
    if let Some(map) = &drawing.transmission {
        let mut map = map.clone();
        map.uv_from_side *= drawing.recto_from(name);
        say("transmission map, for the paper's structure".into());
        terms.transmission_map = true;
        maps.push(MapUse::Transmission(map));
    }
    if !scene.enhance.relief_only
        && let Some(other) = drawing.side_in_state(name.other(), scene.state)
    {
        let mut albedo = other.albedo.clone();
        // Turning the sheet over twice leads back: either way is the same.
        albedo.file.uv_from_side *= drawing.recto_from(SideName::Verso);
        say(format!(
            "the {}'s ink, through the paper",
            name.other().word()
        ));
        terms.other_albedo = true;
        maps.push(MapUse::OtherAlbedo(albedo));
        let turn = drawing.recto_from(SideName::Verso);
        return matter::behind(exhibit, &other, turn, terms, maps, say);
    }
    SideMedia::default()
}

/// The mesostructure, from a normal map or from the slopes of a height map.
fn relief(
    side: &Side,
    directional: bool,
    terms: &mut Terms,
    maps: &mut Vec<MapUse>,
    say: &mut impl FnMut(String),
) {
    let map = match (&side.normal, &side.height) {
        (Some(normal), _) => MapUse::Normal(normal.clone()),
        (None, Some(height)) => MapUse::NormalFromHeight(height.clone(), height.file.extent_mm()),
        (None, None) => return,
    };
    if directional {
        say(format!(
            "{} map, for the relief in directed light",
            map.role()
        ));
        terms.normal_map = true;
        maps.push(map);
    } else {
        say("no relief: all light is even".into());
    }
}

/// The shadows that the relief casts on itself.
fn relief_shadows(
    side: &Side,
    shown: &[&LampKind],
    terms: &mut Terms,
    maps: &mut Vec<MapUse>,
    say: &mut impl FnMut(String),
) {
    let lowest = shown
        .iter()
        .filter_map(|kind| kind.elevation_deg())
        .reduce(f64::min);
    let Some(lowest) = lowest else { return };
    if lowest >= SHADOWS_BELOW_DEG {
        say(format!(
            "no shadows of the relief: no lamp is lower than {SHADOWS_BELOW_DEG}°"
        ));
        return;
    }
    let Some(height) = &side.height else {
        say("no shadows of the relief: it has no height map".into());
        return;
    };
    if terms.tier != Tier::Study {
        say(format!(
            "no shadows of the relief: the {} tier casts none",
            terms.tier
        ));
        return;
    }
    say(format!(
        "height map, for the shadows of the relief: a lamp is {lowest:.0}° high"
    ));
    terms.relief_shadows = true;
    maps.push(MapUse::Height(height.clone()));
}
