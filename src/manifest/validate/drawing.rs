//! Drawings: paper, shape, sides, states, overlays and hotspots.

use std::collections::BTreeMap;

use glam::DVec2;

use super::{
    super::{
        decode::{Brief, List, Pattern},
        document::{Trail, Words},
        exhibit::{
            Drawing, FlipAxis, HeightMap, LegendEntry, MapFile, Overlay, OverlayKind, Side,
            SideName, SidePatch, Source, State, Surface, Wording,
        },
        overrides::NO_STATE,
        raw::{
            RawCategorical, RawDrawing, RawOverlay, RawOverlayKind, RawSide, RawState, RawSurface,
        },
    },
    Validator,
    names::Names,
    placement::Placement,
    side::{Named, no_maps},
    stack,
};

impl Validator<'_, '_> {
    pub(super) fn drawing(
        &mut self,
        raw: &RawDrawing,
        trail: &Trail,
        scenes: &Names,
    ) -> Option<Drawing> {
        let size_mm = DVec2::from(raw.size_mm.map(|mm| mm.0));
        let id = raw.id.as_str();
        let recto = self.whole_side(&raw.recto.0, trail, SideName::Recto, size_mm);
        let verso = raw
            .verso
            .as_ref()
            .map(|side| self.whole_side(&side.0, trail, SideName::Verso, size_mm));
        let flip = raw
            .verso
            .as_ref()
            .and_then(|side| side.0.register.as_ref()?.flip);
        let outline = raw.outline.as_ref().and_then(|map| {
            let named = Named::plain(map, &trail.key("outline"));
            self.covering_map(&named, size_mm)
        });
        let transmission = raw.transmission.as_ref().and_then(|transmission| {
            let trail = trail.key("transmission").key("map");
            self.covering_map(&Named::plain(&transmission.map, &trail), size_mm)
        });
        if let Some(Brief::Full(paper)) = &raw.paper
            && paper.chain_lines_mm.is_some()
        {
            self.not_shown_yet(format!(
                "Drawing \"{id}\": chain_lines_mm of the paper does not change the picture yet."
            ));
        }
        let states = self.each(
            &raw.state,
            &trail.key("state"),
            |validator, state, trail| validator.state(state, trail, size_mm, raw.verso.is_some()),
        );
        let overlays = self.each(
            &raw.overlay,
            &trail.key("overlay"),
            |validator, raw, trail| validator.overlay(raw, trail, size_mm),
        );
        let stacks = self.each(&raw.stack, &trail.key("stack"), |validator, raw, trail| {
            validator.stack(raw, trail, size_mm)
        });
        let hotspots = self.each(
            &raw.hotspot,
            &trail.key("hotspot"),
            |validator, raw, trail| validator.hotspot(raw, trail, size_mm, scenes),
        );
        self.unique_hotspots(raw, &trail.key("hotspot"));
        let facts = DrawingFacts::of(raw);
        self.unique(&facts.states, &trail.key("state"));
        self.unique(&facts.own_overlays, &trail.key("overlay"));
        self.unique(&facts.stacks, &trail.key("stack"));
        self.unique_views(raw, trail);
        let (stacks, views): (Vec<_>, Vec<_>) = stacks?.into_iter().unzip();
        let mut overlays = overlays?;
        overlays.extend(views.into_iter().flatten());
        Some(Drawing {
            id: id.to_owned(),
            title: self.wording(raw.title.as_ref(), &trail.key("title")),
            caption: self.wording(raw.caption.as_ref(), &trail.key("caption")),
            credit: raw
                .credit
                .as_ref()
                .map_or_else(String::new, |t| t.as_str().to_owned()),
            date: raw
                .date
                .as_ref()
                .map_or_else(String::new, |t| t.as_str().to_owned()),
            inventory: raw
                .inventory
                .as_ref()
                .map_or_else(String::new, |t| t.as_str().to_owned()),
            size_mm,
            paper: self.paper(raw.paper.as_ref(), &trail.key("paper"))?,
            outline,
            surface: self.surface(raw.surface.as_ref(), &trail.key("surface"), size_mm)?,
            recto: recto?,
            verso: match verso {
                Some(verso) => Some(verso?),
                None => None,
            },
            flip: flip.unwrap_or(FlipAxis::Vertical),
            transmission,
            states: states?,
            overlays,
            stacks,
            hotspots: hotspots?,
        })
    }

    /// Validates each element of a list, all before the first fault ends it.
    fn each<R, T>(
        &mut self,
        list: &Option<List<R>>,
        trail: &Trail,
        mut validate: impl FnMut(&mut Self, &R, &Trail) -> Option<T>,
    ) -> Option<Vec<T>> {
        let list = list.iter().flat_map(List::iter);
        let values: Vec<Option<T>> = list
            .map(|(i, raw)| validate(self, raw, &trail.index(i)))
            .collect();
        values.into_iter().collect()
    }

    fn whole_side(
        &mut self,
        raw: &RawSide,
        drawing: &Trail,
        name: SideName,
        size_mm: DVec2,
    ) -> Option<Side> {
        let key = match name {
            SideName::Recto => "recto",
            SideName::Verso => "verso",
        };
        let maps = self.side(raw, &drawing.key(key), name, false, size_mm);
        Some(Side {
            albedo: maps.albedo?,
            normal: maps.normal,
            height: maps.height,
            roughness: maps.roughness,
            media: maps.media.unwrap_or_default(),
        })
    }

    /// A picture that just covers the sheet.
    fn covering_map(&mut self, named: &Named<'_>, size_mm: DVec2) -> Option<MapFile> {
        let placement = Placement {
            register: None,
            control_points: None,
            fit: None,
            trail: &named.trail,
        };
        self.map_file(named, placement, size_mm, Source::Assumed)
            .map(|(map, _)| map)
    }

    fn surface(
        &mut self,
        raw: Option<&RawSurface>,
        trail: &Trail,
        size_mm: DVec2,
    ) -> Option<Surface> {
        let Some(raw) = raw else {
            return Some(Surface::Flat);
        };
        if let Some(height) = &raw.height {
            let trail = trail.key("height");
            let range_um = height.range_um.map(|um| um.0);
            self.has_extent(range_um, &trail.key("range_um"));
            let named = Named::of_table(&height.file, height.source, &trail);
            let file = self.covering_map(&named, size_mm)?;
            return Some(Surface::Height(HeightMap { file, range_um }));
        }
        let gltf = raw.gltf.as_ref()?;
        self.model(gltf, &trail.key("gltf")).map(Surface::Gltf)
    }

    fn state(
        &mut self,
        raw: &RawState,
        trail: &Trail,
        size_mm: DVec2,
        has_verso: bool,
    ) -> Option<State> {
        if raw.id.as_str() == NO_STATE {
            let words = Words::new(
                format!("the id \"{NO_STATE}\""),
                "any other id",
                "choose another: a scene asks by this word for no state",
            );
            self.report.fault(&trail.key("id"), words);
        }
        // Without an albedo from anywhere the side stays bare paper.
        if let Some(verso) = &raw.verso
            && !has_verso
            && verso.albedo.is_none()
            && !no_maps(verso)
        {
            let words = Words::new(
                "maps for a verso that the drawing lacks, without albedo",
                "an albedo here, or maps that replace those of a verso",
                "add albedo, or give the drawing a verso",
            );
            self.report.fault(&trail.key("verso"), words);
        }
        let mut patch = |side: &Option<RawSide>, name, key| {
            side.as_ref().map_or_else(SidePatch::default, |side| {
                self.side(side, &trail.key(key), name, true, size_mm)
            })
        };
        let recto = patch(&raw.recto, SideName::Recto, "recto");
        let verso = patch(&raw.verso, SideName::Verso, "verso");
        Some(State {
            id: raw.id.as_str().to_owned(),
            title: self.wording(raw.title.as_ref(), &trail.key("title")),
            date: self.date(raw.date.as_ref(), &trail.key("date")),
            recto,
            verso,
        })
    }

    fn overlay(&mut self, raw: &RawOverlay, trail: &Trail, size_mm: DVec2) -> Option<Overlay> {
        let common = &raw.common;
        self.refuse_flip(common.register.as_ref(), trail);
        let named = Named::of_table(&common.file, common.source, trail);
        let placement = Placement {
            register: common.register.as_ref(),
            control_points: common.control_points.as_ref(),
            fit: common.fit,
            trail,
        };
        let map = self.map_file(&named, placement, size_mm, Source::Assumed);
        let title = self.wording(common.title.as_ref(), &trail.key("title"));
        let kind = match &raw.kind {
            RawOverlayKind::Categorical(categorical) => {
                if let Some((file, header)) = &map {
                    self.exact_colours(&file.path, header, &named.trail);
                }
                OverlayKind::Categorical(self.legend(categorical, &trail.key("legend")))
            }
            RawOverlayKind::Continuous(continuous) => {
                let range = continuous.range.map(|value| value.0);
                self.has_extent(range, &trail.key("range"));
                OverlayKind::Continuous {
                    colour_map: continuous.colour_map.unwrap_or_default(),
                    unit: continuous.unit.as_str().to_owned(),
                    range,
                }
            }
            RawOverlayKind::Picture(picture) => {
                OverlayKind::Picture(picture.encoding.unwrap_or_default())
            }
        };
        let (file, _) = map?;
        let side = common.side.unwrap_or_default();
        Some(Overlay {
            id: common.id.as_str().to_owned(),
            title,
            side,
            file,
            kind,
        })
    }

    fn legend(&mut self, raw: &RawCategorical, trail: &Trail) -> Vec<LegendEntry> {
        let mut entries: Vec<LegendEntry> = Vec::new();
        for (i, entry) in raw.legend.iter() {
            let trail = trail.index(i);
            let Some(colour) = crate::colour::parse_hex(entry.colour.as_str()) else {
                continue;
            };
            if entries.iter().any(|earlier| earlier.colour == colour) {
                let words = Words::new(
                    format!("the colour {} a second time", entry.colour.as_str()),
                    "each colour once",
                    "give each category a colour of its own",
                );
                self.report.fault(&trail.key("colour"), words);
            }
            let id = entry.id.as_ref().map(|id| id.as_str().to_owned());
            if id.is_some() && entries.iter().any(|earlier| earlier.id == id) {
                let words = Words::new(
                    format!("the id \"{}\" a second time", id.unwrap_or_default()),
                    "ids that differ",
                    "rename one of the two",
                );
                self.report.fault(&trail.key("id"), words);
                continue;
            }
            let label = self.wording(Some(&entry.label), &trail.key("label"));
            entries.push(LegendEntry { id, colour, label });
        }
        entries
    }
}

/// What scenes need to know of a drawing.
pub(super) struct DrawingFacts {
    pub size_mm: DVec2,
    pub has_verso: bool,
    pub states: Names,
    own_overlays: Names,
    stacks: Names,
    /// Of its overlays, and behind them of what can be shown of its stacks.
    pub overlays: Names,
    /// The side of each by its index.
    pub overlay_sides: Vec<(usize, SideName)>,
    /// The legends of those that have one.
    pub legends: Vec<(usize, Vec<LegendEntry>)>,
}

impl DrawingFacts {
    pub fn of(raw: &RawDrawing) -> Self {
        let states = raw.state.iter().flat_map(List::iter);
        let overlays = || raw.overlay.iter().flat_map(List::iter);
        let stacks = || raw.stack.iter().flat_map(List::iter);
        let own_overlays = Names::new(
            "overlay of this drawing",
            overlays().map(|(i, overlay)| (i, &overlay.common.id)),
            raw.overlay.as_ref().is_some_and(List::has_holes),
        );
        let mut names: Vec<(usize, String)> = overlays()
            .map(|(i, overlay)| (i, overlay.common.id.as_str().to_owned()))
            .collect();
        let mut overlay_sides: Vec<(usize, SideName)> = overlays()
            .map(|(i, overlay)| (i, overlay.common.side.unwrap_or_default()))
            .collect();
        for (_, stack) in stacks() {
            let (views, side) = stack::view_names(stack);
            for name in views {
                overlay_sides.push((names.len(), side));
                names.push((names.len(), name));
            }
        }
        let incomplete = own_overlays.is_incomplete()
            || raw.stack.as_ref().is_some_and(List::has_holes)
            || stacks().any(|(_, stack)| stack::has_holes(stack));
        Self {
            size_mm: DVec2::from(raw.size_mm.map(|mm| mm.0)),
            has_verso: raw.verso.is_some(),
            states: Names::new(
                "state of this drawing",
                states.map(|(i, state)| (i, &state.id)),
                raw.state.as_ref().is_some_and(List::has_holes),
            ),
            own_overlays,
            stacks: Names::new(
                "stack of this drawing",
                stacks().map(|(i, stack)| (i, &stack.id)),
                raw.stack.as_ref().is_some_and(List::has_holes),
            ),
            overlays: Names::of("overlay of this drawing", names, incomplete),
            overlay_sides,
            legends: overlays()
                .filter_map(|(i, overlay)| match &overlay.kind {
                    RawOverlayKind::Categorical(categorical) => Some((i, written(categorical))),
                    RawOverlayKind::Continuous(_) | RawOverlayKind::Picture(_) => None,
                })
                .collect(),
        }
    }
}

/// A legend without its colours.
fn written(raw: &RawCategorical) -> Vec<LegendEntry> {
    let entries = raw.legend.iter().map(|(_, entry)| LegendEntry {
        id: entry.id.as_ref().map(|id| id.as_str().to_owned()),
        colour: [0; 3],
        label: Wording(match &entry.label {
            Brief::Short(text) => BTreeMap::from([(String::new(), text.as_str().to_owned())]),
            Brief::Full(texts) => texts
                .0
                .iter()
                .map(|(tag, text)| (tag.as_str().to_owned(), text.as_str().to_owned()))
                .collect(),
        }),
    });
    entries.collect()
}
