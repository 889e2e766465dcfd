//! Scenes, with what they take over from each other, and tours.

use std::collections::BTreeMap;

use glam::DVec2;

use super::{
    super::{
        decode::{Brief, List, Pattern},
        document::{Trail, Words},
        exhibit::{
            Ambient, Camera, Comparison, Enhancement, Exposure, Member, Scene, SideName, Tour,
        },
        overlay::chosen,
        overrides::NO_STATE,
        raw::{
            RawManifest,
            scene::{
                RawAmbient, RawCamera, RawCompare, RawEnhance, RawExposure, RawScene, RawTour,
            },
            values::{Choice, Id, Text},
        },
    },
    Validator,
    drawing::DrawingFacts,
    lamp::DAYLIGHT_K,
    names::Names,
};
use crate::units::{Degrees, Kelvin, Lux};

/// How long a stop of a tour lasts that does not say.
const DEFAULT_STOP_S: f64 = 10.0;

/// As [`Scene::overlays`] and [`Scene::categories`].
type ShownOverlays = (Vec<(usize, f64)>, BTreeMap<usize, Vec<usize>>);

/// How many scenes can take over from each other in a row.
const DEEPEST_LIKE: usize = 32;

/// What scenes refer to.
struct Surroundings<'n> {
    drawings: Vec<(usize, DrawingFacts)>,
    drawing_names: &'n Names,
    lamp_names: &'n Names,
    exposure: Option<&'n RawExposure>,
}

impl Validator<'_, '_> {
    pub(super) fn scenes(
        &mut self,
        raw: &RawManifest,
        root: &Trail,
        drawing_names: &Names,
        lamp_names: &Names,
        scene_names: &Names,
    ) -> Option<Vec<Scene>> {
        let surroundings = Surroundings {
            drawings: raw
                .drawing
                .iter()
                .map(|(i, d)| (i, DrawingFacts::of(d)))
                .collect(),
            drawing_names,
            lamp_names,
            exposure: raw
                .exhibit
                .as_ref()
                .and_then(|about| about.exposure.as_ref()),
        };
        let trail = root.key("scene");
        let Some(scenes) = &raw.scene else {
            let scenes = raw.drawing.iter().map(|(i, drawing)| {
                let scene = RawScene::of_drawing(&drawing.id);
                self.scene(&scene, &trail.index(i), &surroundings)
            });
            // All are looked at before the first fault ends it.
            return scenes.collect::<Vec<_>>().into_iter().collect();
        };
        // Scenes that others take over from come first, so that what is at fault in them is
        // reported there alone.
        let mut chains: Vec<Vec<usize>> = Vec::new();
        for (i, scene) in scenes.iter() {
            if self.report.is_full() {
                return None;
            }
            chains.extend(self.chain(i, scene, scenes, &trail, scene_names));
        }
        chains.sort_by_key(Vec::len);
        let mut done: Vec<(usize, Option<Scene>)> = Vec::new();
        for chain in &chains {
            let Some(&own) = chain.first() else { continue };
            if self.report.is_full() {
                return None;
            }
            let merged = chain
                .iter()
                .filter_map(|index| scenes.get(*index).cloned())
                .reduce(RawScene::like);
            let Some(merged) = merged else { continue };
            let inherits_faults = chain[1..]
                .iter()
                .any(|index| self.report.faulty_within(&trail.index(*index)));
            let mark = self.report.mark();
            let scene = self.scene(&merged, &trail.index(own), &surroundings);
            if inherits_faults {
                self.report.keep_written(mark);
            }
            done.push((own, scene));
        }
        if done.len() < scenes.iter().count() {
            return None;
        }
        done.sort_by_key(|(index, _)| *index);
        done.into_iter().map(|(_, scene)| scene).collect()
    }

    /// A scene and those that it takes over from, in this order; `None` where they come round
    /// to themselves or one of them is missing.
    fn chain(
        &mut self,
        start: usize,
        scene: &RawScene,
        scenes: &List<RawScene>,
        trail: &Trail,
        names: &Names,
    ) -> Option<Vec<usize>> {
        let mut chain = vec![start];
        let mut ids = vec![scene.id.as_str()];
        let mut current = scene;
        while let Some(like) = &current.like {
            let last = chain.len() - 1;
            let parent_trail = trail.index(chain[last]).key("like");
            // Only the scene itself reports that its reference does not resolve.
            let parent = if last == 0 {
                self.resolve(like.as_str(), names, &parent_trail)?
            } else {
                names.position(like.as_str())?
            };
            ids.push(like.as_str());
            if let Some(first) = chain.iter().position(|index| *index == parent) {
                // Of the scenes on the circle the first in the file reports it.
                if first == 0 && chain.iter().all(|index| *index >= start) {
                    let words = Words::new(
                        format!(
                            "scenes that are like each other in a circle: {}",
                            ids.join(" → ")
                        ),
                        "a scene that is like an earlier one",
                        "remove one like",
                    );
                    self.report.fault(&trail.index(start).key("like"), words);
                }
                return None;
            }
            if chain.len() == DEEPEST_LIKE {
                let words = Words::new(
                    format!("more than {DEEPEST_LIKE} scenes like one another in a row"),
                    "fewer",
                    "give this scene its own keys",
                );
                self.report.fault(&trail.index(start).key("like"), words);
                return None;
            }
            chain.push(parent);
            current = scenes.get(parent)?;
        }
        Some(chain)
    }

    fn scene(&mut self, raw: &RawScene, trail: &Trail, around: &Surroundings<'_>) -> Option<Scene> {
        let id = raw.id.as_str().to_owned();
        let title = self.wording(raw.title.as_ref(), &trail.key("title"));
        let text = self.wording(raw.text.as_ref(), &trail.key("text"));
        let language = raw
            .language
            .as_ref()
            .and_then(|language| self.language(language, &trail.key("language")));
        let lamps = self.scene_lamps(raw, trail, around.lamp_names);
        let ambient = ambient(raw.ambient.as_ref());
        if lamps.as_ref().is_some_and(Vec::is_empty)
            && ambient.illuminance.0 == 0.0
            && raw.transmitted.is_none_or(|share| share.0 == 0.0)
        {
            let words = Words::new(
                "no light",
                "at least one lamp, or ambient light",
                "name a lamp or set ambient.lux",
            );
            self.report.fault(&trail.key("lamps"), words);
        }
        let drawing = self.scene_drawing(raw, trail, around)?;
        let position = around
            .drawings
            .binary_search_by_key(&drawing, |(index, _)| *index)
            .ok()?;
        let facts = &around.drawings[position].1;
        let side = raw.side.unwrap_or_default();
        let state = match &raw.state {
            Some(id) if id.as_str() != NO_STATE => self
                .resolve(id.as_str(), &facts.states, &trail.key("state"))
                .map(Some),
            _ => Some(None),
        };
        let overlays = self.shown_overlays(raw, &trail.key("overlays"), side, facts);
        let compare = match &raw.compare {
            Some(compare) => self.comparison(compare, &trail.key("compare"), facts, around),
            None => Some(None),
        };
        let camera = self.camera(raw.camera.as_ref(), &trail.key("camera"), facts.size_mm);
        let (overlays, categories) = overlays?;
        Some(Scene {
            id,
            title,
            text,
            drawing,
            side,
            state: state?,
            overlays,
            categories,
            compare: compare?,
            camera,
            lamps: lamps?,
            ambient,
            transmitted: raw.transmitted.map_or(0.0, |share| share.0),
            exposure: exposure(raw.exposure.as_ref(), around.exposure),
            enhance: self.enhance(raw.enhance.as_ref(), &trail.key("enhance")),
            language,
        })
    }

    fn enhance(&mut self, raw: Option<&RawEnhance>, trail: &Trail) -> Enhancement {
        let Some(raw) = raw else {
            return Enhancement::default();
        };
        if !raw.is_stretch_sound() {
            let words = Words::new(
                "ends of a stretched contrast that are the same or in the wrong order",
                "the lower first, .01 apart at least",
                "write it like [0.2, 0.8]",
            );
            self.report.fault(&trail.key("stretch"), words);
        }
        raw.enhancement()
    }

    fn scene_drawing(
        &mut self,
        raw: &RawScene,
        trail: &Trail,
        around: &Surroundings<'_>,
    ) -> Option<usize> {
        let names = around.drawing_names;
        let trail = trail.key("drawing");
        if let Some(id) = &raw.drawing {
            return self.resolve(id.as_str(), names, &trail);
        }
        let only = names.only();
        if only.is_none() && names.words().nth(1).is_some() {
            let allowed = names.listed();
            self.report
                .fault(&trail, Words::new("nothing", allowed, "add drawing"));
        }
        only
    }

    fn scene_lamps(&mut self, raw: &RawScene, trail: &Trail, names: &Names) -> Option<Vec<usize>> {
        let trail = trail.key("lamps");
        let Some(lamps) = &raw.lamps else {
            // Of a faulty first lamp it is not known that it gives no light.
            return (!names.is_incomplete()).then(|| names.first().into_iter().collect());
        };
        let lamps: Vec<_> = lamps
            .iter()
            .map(|(i, id)| self.resolve(id.as_str(), names, &trail.index(i)))
            .collect();
        lamps.into_iter().collect()
    }

    fn shown_overlays(
        &mut self,
        raw: &RawScene,
        trail: &Trail,
        side: SideName,
        facts: &DrawingFacts,
    ) -> Option<ShownOverlays> {
        let mut shown = Some((Vec::<(usize, f64)>::new(), BTreeMap::new()));
        for (i, overlay) in raw.overlays.iter().flat_map(List::iter) {
            let (id, opacity, categories, trail) = match overlay {
                Brief::Short(id) => (id, 1.0, None, trail.index(i)),
                Brief::Full(full) => {
                    let opacity = full.opacity.map_or(1.0, |opacity| opacity.0);
                    let categories = full.categories.as_ref();
                    let categories =
                        categories.map(|list| (list, trail.index(i).key("categories")));
                    (&full.id, opacity, categories, trail.index(i).key("id"))
                }
            };
            let Some(index) = self.resolve(id.as_str(), &facts.overlays, &trail) else {
                shown = None;
                continue;
            };
            let on = facts
                .overlay_sides
                .binary_search_by_key(&index, |(index, _)| *index);
            if on.is_ok_and(|position| facts.overlay_sides[position].1 != side) {
                let words = Words::new(
                    format!("\"{}\", an overlay of the other side", id.as_str()),
                    format!("overlays of the {}", side.word()),
                    "remove it, or show the other side",
                );
                self.report.fault(&trail, words);
            }
            let categories = match categories {
                None => Some(None),
                Some((list, trail)) => self.shown_categories(list, &trail, index, facts).map(Some),
            };
            let Some(categories) = categories else {
                shown = None;
                continue;
            };
            if let Some((shown, of_each)) = &mut shown {
                if shown.iter().any(|(earlier, _)| *earlier == index) {
                    let words = Words::new(
                        format!("\"{}\" a second time", id.as_str()),
                        "each overlay once",
                        "remove one of the two",
                    );
                    self.report.fault(&trail, words);
                }
                shown.push((index, opacity));
                of_each.extend(categories.map(|categories| (index, categories)));
            }
        }
        shown
    }

    /// Indices into the legend of the overlay `index`, in its order.
    fn shown_categories(
        &mut self,
        list: &List<Text, 1, 256>,
        trail: &Trail,
        index: usize,
        facts: &DrawingFacts,
    ) -> Option<Vec<usize>> {
        let of_overlay = facts.legends.iter().find(|(i, _)| *i == index);
        let legend = of_overlay.map_or(&[][..], |(_, legend)| legend);
        let (indices, faults) = chosen(legend, list.iter().map(|(i, name)| (i, name.as_str())));
        let complete = faults.is_empty() && !list.has_holes();
        for (i, words) in faults {
            self.report.fault(&trail.index(i), words);
        }
        complete.then_some(indices)
    }

    fn comparison(
        &mut self,
        raw: &RawCompare,
        trail: &Trail,
        facts: &DrawingFacts,
        around: &Surroundings<'_>,
    ) -> Option<Option<Comparison>> {
        let mut of: Vec<Member> = Vec::new();
        let mut complete = true;
        for (i, text) in raw.of.iter() {
            let trail = trail.key("of").index(i);
            let Some(member) = self.member(text.as_str(), &trail, facts, around) else {
                complete = false;
                continue;
            };
            if of.contains(&member) {
                let words = Words::new(
                    format!("\"{}\" a second time", text.as_str()),
                    "members that differ",
                    "remove one of the two",
                );
                self.report.fault(&trail, words);
            }
            of.push(member);
        }
        if let Some((found, allowed)) = raw.mode.refuses(&of).filter(|_| complete) {
            let words = Words::new(found, allowed, "change them, or choose another mode");
            self.report.fault(&trail.key("of"), words);
            return None;
        }
        complete.then(|| Some(raw.comparison(of)))
    }

    fn member(
        &mut self,
        text: &str,
        trail: &Trail,
        facts: &DrawingFacts,
        around: &Surroundings<'_>,
    ) -> Option<Member> {
        let (kind, id) = text.split_once(':')?;
        match kind {
            "state" if id == NO_STATE => Some(Member::State(None)),
            "state" => {
                let state = self.resolve(id, &facts.states, trail)?;
                Some(Member::State(Some(state)))
            }
            // What can be shown of a stack lies over the sheet as overlays do.
            "overlay" | "band" => self
                .resolve(id, &facts.overlays, trail)
                .map(Member::Overlay),
            "drawing" => self
                .resolve(id, around.drawing_names, trail)
                .map(Member::Drawing),
            _ => {
                let side = SideName::WORDS.iter().find(|(word, _)| *word == id)?.1;
                if side == SideName::Verso && !facts.has_verso {
                    let words = Words::new(
                        "the verso of a drawing that has none",
                        "a side with maps",
                        "add [drawing.verso] or compare something else",
                    );
                    self.report.fault(trail, words);
                }
                Some(Member::Side(side))
            }
        }
    }

    pub(super) fn camera(
        &mut self,
        raw: Option<&RawCamera>,
        trail: &Trail,
        size_mm: DVec2,
    ) -> Camera {
        let whole = Camera::whole_sheet(size_mm);
        let Some(raw) = raw else { return whole };
        let centre_mm = raw
            .centre_mm
            .map_or(whole.centre_mm, |mm| DVec2::from(mm.map(|mm| mm.0)));
        if centre_mm.cmplt(DVec2::ZERO).any() || centre_mm.cmpgt(size_mm).any() {
            let words = Words::new(
                format!(
                    "a place beside the sheet, {} mm, {} mm",
                    centre_mm.x, centre_mm.y
                ),
                format!("0 to {} mm and 0 to {} mm", size_mm.x, size_mm.y),
                "measure from the left and top edges of the side that is shown",
            );
            self.report.warn(&trail.key("centre_mm"), words);
        }
        Camera {
            centre_mm,
            width_mm: raw.width_mm.map_or(whole.width_mm, |mm| mm.0),
            tilt: Degrees(raw.tilt_deg.map_or(0.0, |degrees| degrees.0)),
            turn: Degrees(raw.turn_deg.map_or(0.0, |degrees| degrees.0)),
            distance_mm: raw.distance_mm.map(|mm| mm.0),
        }
    }

    pub(super) fn tours(
        &mut self,
        raw: &RawManifest,
        trail: &Trail,
        scenes: &Names,
    ) -> Option<Vec<Tour>> {
        let Some(tours) = &raw.tour else {
            return Some(Vec::new());
        };
        let ids = tours.iter().map(|(i, tour)| (i, &tour.id));
        self.unique(&Names::new("tour", ids, tours.has_holes()), trail);
        let tours: Vec<_> = tours
            .iter()
            .map(|(i, tour)| self.tour(tour, &trail.index(i), scenes))
            .collect();
        tours.into_iter().collect()
    }

    fn tour(&mut self, raw: &RawTour, trail: &Trail, scenes: &Names) -> Option<Tour> {
        let id = raw.id.as_str().to_owned();
        let stops: Vec<_> = raw
            .scenes
            .iter()
            .map(|(i, stop)| {
                let trail = trail.key("scenes").index(i);
                match stop {
                    Brief::Short(scene) => Some((
                        self.resolve(scene.as_str(), scenes, &trail)?,
                        DEFAULT_STOP_S,
                    )),
                    Brief::Full(stop) => {
                        let trail = trail.key("scene");
                        let scene = self.resolve(stop.scene.as_str(), scenes, &trail)?;
                        Some((
                            scene,
                            stop.seconds.map_or(DEFAULT_STOP_S, |seconds| seconds.0),
                        ))
                    }
                }
            })
            .collect();
        let title = self.wording(raw.title.as_ref(), &trail.key("title"));
        Some(Tour {
            id,
            title,
            stops: stops.into_iter().collect::<Option<_>>()?,
        })
    }
}

fn ambient(raw: Option<&RawAmbient>) -> Ambient {
    Ambient {
        illuminance: Lux(raw.map_or(0.0, |ambient| ambient.lux.0)),
        kelvin: Kelvin(
            raw.and_then(|ambient| ambient.kelvin)
                .map_or(DAYLIGHT_K, |kelvin| kelvin.0),
        ),
    }
}

/// What a scene says of its exposure, and for the rest the exhibit.
fn exposure(scene: Option<&RawExposure>, exhibit: Option<&RawExposure>) -> Exposure {
    let first = |get: fn(&RawExposure) -> Option<f64>| {
        scene.and_then(get).or_else(|| exhibit.and_then(get))
    };
    Exposure {
        illuminance: first(|exposure| exposure.lux.map(|lux| lux.0)).map(Lux),
        level: first(|exposure| exposure.level.map(|level| level.0)).unwrap_or(1.0),
        white: Kelvin(
            first(|exposure| exposure.white_kelvin.map(|kelvin| kelvin.0)).unwrap_or(DAYLIGHT_K),
        ),
    }
}

impl RawScene {
    /// The scene of a drawing in a manifest without scenes.
    pub(in super::super) fn of_drawing(id: &Id) -> Self {
        Self {
            id: id.clone(),
            like: None,
            title: None,
            text: None,
            drawing: Some(id.clone()),
            side: None,
            state: None,
            overlays: None,
            compare: None,
            camera: None,
            lamps: None,
            ambient: None,
            transmitted: None,
            exposure: None,
            enhance: None,
            language: None,
        }
    }

    /// `self`, with what it does not give taken from `other`.
    fn like(self, other: Self) -> Self {
        Self {
            id: self.id,
            like: self.like,
            title: self.title.or(other.title),
            text: self.text.or(other.text),
            drawing: self.drawing.or(other.drawing),
            side: self.side.or(other.side),
            state: self.state.or(other.state),
            overlays: self.overlays.or(other.overlays),
            compare: self.compare.or(other.compare),
            camera: self.camera.or(other.camera),
            lamps: self.lamps.or(other.lamps),
            ambient: self.ambient.or(other.ambient),
            transmitted: self.transmitted.or(other.transmitted),
            exposure: self.exposure.or(other.exposure),
            enhance: self.enhance.or(other.enhance),
            language: self.language.or(other.language),
        }
    }
}
