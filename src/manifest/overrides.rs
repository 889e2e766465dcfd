//! A scene made from one of the exhibit's by the options of a command.

mod spec;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use glam::DVec2;
use toml::{Table, Value};

use super::{
    Fault, Faults, Pattern, did_you_mean,
    exhibit::{
        Camera, Drawing, Enhancement, Exhibit, Lamp, LegendEntry, MAX_LAMPS, MAX_OVERLAYS, Member,
        OverlayKind, Scene, SideName,
    },
    frames, one,
    overlay::chosen,
    quote, quoted_list,
    raw::{RawCamera, RawCompare, RawEnhance, RawShownOverlay},
};
use crate::units::Degrees;
use spec::{decode, fault, parts, table, unreadable, validated, value};

/// The word for the sheet as its sides describe it.
pub const NO_STATE: &str = "none";
const CAMERA: &str = "--camera";
/// Begins a camera that shows the sheet in its true size; the display's resolution follows.
const TRUE_SIZE: &str = "true-size@";
/// Resolutions of displays, in pixels per inch.
const PPI_RANGE: [f64; 2] = [10.0, 2000.0];

/// What the options of a command change in a scene. Texts are as written; ids are those of the
/// manifest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides {
    /// The scene to begin with; without it, the first of `drawing`, or else of the exhibit.
    pub scene: Option<String>,
    /// Another drawing: the whole of its recto, in the light of the scene.
    pub drawing: Option<String>,
    /// Another side; the camera stays over the same place of the sheet.
    pub side: Option<SideName>,
    /// A state of conservation, or `none`.
    pub state: Option<String>,
    /// `ID`, `ID=OPACITY`, `ID:CATEGORY,…` or both, from the lowest; if any, they take the place of the scene's own.
    pub overlays: Vec<String>,
    /// `ID` or `key=value,…`; if any, they take the place of the scene's own.
    pub lamps: Vec<String>,
    /// `key=value,…` and `true-size@PPI`; keys that are not given stay as the scene has them.
    pub camera: Option<String>,
    /// `MODE:A,B`, what follows as in a manifest: `curtain:state:before,state:after,at=0.4`.
    pub compare: Option<String>,
    /// How much of the light comes through the sheet, 0 to 1.
    pub transmitted: Option<f64>,
    /// `key=value,…` as in a manifest; takes the place of the scene's own.
    pub enhance: Option<String>,
    /// A BCP 47 tag.
    pub language: Option<String>,
}

impl Overrides {
    /// The scene for a picture `width_px` pixels wide, with the exhibit that it belongs to: lamps
    /// that are described and not named are added to it.
    ///
    /// # Errors
    /// All faults, without file and place; their paths begin with the option.
    pub fn apply(&self, mut exhibit: Exhibit, width_px: u32) -> Result<(Exhibit, Scene), Faults> {
        let mut faults = Vec::new();
        // Whatever does not depend on the scene is checked even where there is none.
        let base = self.base(&exhibit).map_err(|found| faults.extend(found));
        let lamps = self.lamps(&mut exhibit, &mut faults);
        let language = self.language(&exhibit);
        let language = language.map_err(|found| faults.extend(found));
        let change = self.camera.as_deref().map(CameraChange::parse).transpose();
        let change = change.map_err(|found| faults.extend(found));
        let scene = base.map(|mut scene| {
            let drawing = &exhibit.drawings[scene.drawing];
            self.choose_side(&mut scene, drawing);
            if let Err(found) = self.choose_state(&mut scene, drawing) {
                faults.extend(found);
            }
            self.choose_overlays(&mut scene, drawing, &mut faults);
            match self.transmitted {
                Some(share) if (0.0..=1.0).contains(&share) => scene.transmitted = share,
                Some(share) => faults.push(unreadable(
                    "--transmitted",
                    share.to_string(),
                    "a number from 0 to 1",
                    "write 1 for a light table alone, 0 for the lamps alone",
                )),
                None => {}
            }
            match self.enhancement(&scene) {
                Ok(enhance) => scene.enhance = enhance,
                Err(found) => faults.extend(found),
            }
            if let Err(found) = self.choose_comparison(&mut scene, &exhibit, &mut faults) {
                faults.extend(found);
            }
            scene
        });
        match (scene, language, change, Faults::new(faults)) {
            (Ok(mut scene), Ok(language), Ok(change), None) => {
                if !self.lamps.is_empty() {
                    scene.lamps = lamps;
                }
                if let Some(change) = change {
                    scene.camera = change.applied(scene.camera, width_px);
                }
                scene.language = language.or(scene.language);
                Ok((exhibit, scene))
            }
            (.., Some(faults)) => Err(faults),
            // Whatever failed has left a fault.
            (.., None) => Err(fault("", "options that cannot be used", "", "").into()),
        }
    }

    fn base(&self, exhibit: &Exhibit) -> Result<Scene, Vec<Fault>> {
        let named = match &self.scene {
            Some(id) => {
                let ids = exhibit.scenes.iter().map(|scene| scene.id.as_str());
                Some(resolve("--scene", "scene", id, ids)?)
            }
            None => None,
        };
        let Some(id) = &self.drawing else {
            return Ok(exhibit.scenes[named.unwrap_or_default()].clone());
        };
        let ids = exhibit.drawings.iter().map(|drawing| drawing.id.as_str());
        let drawing = resolve("--drawing", "drawing", id, ids)?;
        let of_drawing = || exhibit.scenes.iter().position(|s| s.drawing == drawing);
        let base = &exhibit.scenes[named.or_else(of_drawing).unwrap_or_default()];
        if named.is_some() && base.drawing == drawing {
            return Ok(base.clone());
        }
        Ok(Scene {
            drawing,
            side: SideName::Recto,
            state: None,
            overlays: Vec::new(),
            categories: BTreeMap::new(),
            compare: None,
            camera: Camera::whole_sheet(exhibit.drawings[drawing].size_mm),
            ..base.clone()
        })
    }

    fn choose_side(&self, scene: &mut Scene, drawing: &Drawing) {
        let Some(side) = self.side.filter(|side| *side != scene.side) else {
            return;
        };
        scene.side = side;
        let centre = &mut scene.camera.centre_mm;
        *centre = frames::other_side(*centre, drawing.size_mm, drawing.flip);
        scene.overlays.clear();
    }

    fn choose_state(&self, scene: &mut Scene, drawing: &Drawing) -> Result<(), Vec<Fault>> {
        scene.state = match self.state.as_deref() {
            None => return Ok(()),
            Some(NO_STATE) => None,
            Some(id) => {
                let ids = drawing.states.iter().map(|state| state.id.as_str());
                Some(resolve("--state", "state", id, ids.chain([NO_STATE]))?)
            }
        };
        Ok(())
    }

    fn choose_overlays(&self, scene: &mut Scene, drawing: &Drawing, faults: &mut Vec<Fault>) {
        const OPTION: &str = "--overlay";
        if self.overlays.is_empty() {
            return;
        }
        if self.overlays.len() > MAX_OVERLAYS {
            faults.push(too_many(OPTION, self.overlays.len(), MAX_OVERLAYS));
        }
        scene.overlays.clear();
        scene.categories.clear();
        for (i, spec) in self.overlays.iter().enumerate() {
            let option = numbered(OPTION, i, self.overlays.len());
            match shown_overlay(&option, spec, scene.side, drawing) {
                Ok((index, ..)) if scene.overlays.iter().any(|(i, _)| *i == index) => {
                    let found = format!("{} a second time", quote(&drawing.overlays[index].id));
                    faults.push(fault(
                        &option,
                        found,
                        "each overlay once",
                        "remove one of the two",
                    ));
                }
                Ok((index, opacity, categories)) => {
                    scene.overlays.push((index, opacity));
                    let shown = categories.map(|categories| (index, categories));
                    scene.categories.extend(shown);
                }
                Err(found) => faults.extend(found),
            }
        }
    }

    /// The indices of the lamps, which are added to the exhibit where they are not its own.
    fn lamps(&self, exhibit: &mut Exhibit, faults: &mut Vec<Fault>) -> Vec<usize> {
        const OPTION: &str = "--lamp";
        if self.lamps.len() > MAX_LAMPS {
            faults.push(too_many(OPTION, self.lamps.len(), MAX_LAMPS));
        }
        let mut lamps = Vec::new();
        for (i, spec) in self.lamps.iter().enumerate() {
            let option = numbered(OPTION, i, self.lamps.len());
            let index = if spec.contains('=') {
                described_lamp(&option, spec, exhibit).map(|lamp| {
                    exhibit.lamps.push(lamp);
                    exhibit.lamps.len() - 1
                })
            } else {
                let ids = exhibit.lamps.iter().map(|lamp| lamp.id.as_str());
                resolve(&option, "lamp", spec, ids)
            };
            match index {
                Ok(index) => lamps.push(index),
                Err(found) => faults.extend(found),
            }
        }
        lamps
    }

    fn choose_comparison(
        &self,
        scene: &mut Scene,
        exhibit: &Exhibit,
        faults: &mut Vec<Fault>,
    ) -> Result<(), Vec<Fault>> {
        const OPTION: &str = "--compare";
        let Some(spec) = &self.compare else {
            return Ok(());
        };
        let Some((mode, rest)) = spec.split_once(':') else {
            let allowed = "a mode, a colon and members";
            let remedy = "write it like curtain:state:before,state:after";
            return Err(vec![unreadable(OPTION, quote(spec), allowed, remedy)]);
        };
        let (keys, members): (Vec<&str>, Vec<&str>) = parts(rest).partition(|p| p.contains('='));
        let mut written = table(OPTION, "at=0.4", keys)?;
        let members: Vec<Value> = members.into_iter().map(Value::from).collect();
        written.insert("mode".to_owned(), mode.into());
        written.insert("of".to_owned(), members.into());
        let raw: RawCompare = decode(OPTION, written.into())?;
        let drawing = &exhibit.drawings[scene.drawing];
        let mut of = Vec::new();
        for (i, text) in raw.of.iter() {
            let option = format!("{OPTION}.of[{i}]");
            match member(&option, text.as_str(), exhibit, drawing) {
                Ok(member) if of.contains(&member) => faults.push(fault(
                    &option,
                    format!("{} a second time", quote(text.as_str())),
                    "members that differ",
                    "remove one of the two",
                )),
                Ok(member) => of.push(member),
                Err(found) => faults.extend(found),
            }
        }
        if of.len() == raw.of.iter().count()
            && let Some((found, allowed)) = raw.mode.refuses(&of)
        {
            let remedy = "change them, or choose another mode";
            faults.push(fault(OPTION, found, allowed, remedy));
        }
        scene.compare = Some(raw.comparison(of));
        Ok(())
    }

    fn enhancement(&self, scene: &Scene) -> Result<Enhancement, Vec<Fault>> {
        const OPTION: &str = "--enhance";
        let Some(spec) = &self.enhance else {
            return Ok(scene.enhance);
        };
        let raw: RawEnhance = decode(OPTION, table(OPTION, "exaggerate=3", parts(spec))?.into())?;
        if !raw.is_stretch_sound() {
            let remedy = "write it like stretch=[0.2,0.8]";
            let allowed = "the lower end first, .01 apart at least";
            return Err(vec![unreadable(OPTION, quote(spec), allowed, remedy)]);
        }
        Ok(raw.enhancement())
    }

    fn language(&self, exhibit: &Exhibit) -> Result<Option<String>, Vec<Fault>> {
        let Some(tag) = &self.language else {
            return Ok(None);
        };
        let languages = Value::Array(vec![tag.clone().into()]);
        let about = Table::from_iter([("languages".to_owned(), languages)]);
        let place = "exhibit.languages[0]";
        validated("--language", "exhibit", about.into(), place, exhibit)
            .map(|valid| valid.languages.into_iter().next())
    }
}

/// What one word of a comparison refers to.
fn member(
    option: &str,
    text: &str,
    exhibit: &Exhibit,
    drawing: &Drawing,
) -> Result<Member, Vec<Fault>> {
    let (kind, id) = text.split_once(':').unwrap_or((text, ""));
    match kind {
        "state" if id == NO_STATE => Ok(Member::State(None)),
        "state" => {
            let ids = drawing.states.iter().map(|state| state.id.as_str());
            let index = resolve(option, "state", id, ids.chain([NO_STATE]))?;
            Ok(Member::State(Some(index)))
        }
        "overlay" | "band" => {
            let ids = drawing.overlays.iter().map(|overlay| overlay.id.as_str());
            resolve(option, "overlay", id, ids).map(Member::Overlay)
        }
        "drawing" => {
            let ids = exhibit.drawings.iter().map(|drawing| drawing.id.as_str());
            resolve(option, "drawing", id, ids).map(Member::Drawing)
        }
        _ if id == SideName::Verso.word() => Ok(Member::Side(SideName::Verso)),
        _ => Ok(Member::Side(SideName::Recto)),
    }
}

/// Index, opacity, and the categories that are shown where not all are.
type ShownOverlay = (usize, f64, Option<Vec<usize>>);

fn shown_overlay(
    option: &str,
    spec: &str,
    side: SideName,
    drawing: &Drawing,
) -> Result<ShownOverlay, Vec<Fault>> {
    let (rest, categories) = match spec.split_once(':') {
        Some((rest, categories)) => (rest, Some(categories)),
        None => (spec, None),
    };
    let (id, opacity) = match rest.split_once('=') {
        Some((id, opacity)) => (id, Some(value(opacity))),
        None => (rest, None),
    };
    if categories.is_some_and(|list| list.trim().is_empty()) {
        return Err(vec![unreadable(
            option,
            format!("{}, a colon and no category", quote(spec)),
            "ID[=OPACITY][:CATEGORY,…]",
            "name the categories to be shown, or leave the colon out to show all of them",
        )]);
    }
    let ids = drawing.overlays.iter().map(|overlay| overlay.id.as_str());
    let index = resolve(option, "overlay", id, ids)?;
    let overlay = &drawing.overlays[index];
    if overlay.side != side {
        let side = overlay.side.word();
        return Err(vec![fault(
            option,
            format!("{}, an overlay of the {side}", quote(id)),
            "overlays of the side that is shown",
            format!("add --side {side}"),
        )]);
    }
    let mut written = Table::from_iter([("id".to_owned(), Value::from(id))]);
    written.extend(opacity.map(|opacity| ("opacity".to_owned(), opacity)));
    let names: Option<Vec<Value>> = categories.map(|list| parts(list).map(Value::from).collect());
    written.extend(names.map(|names| ("categories".to_owned(), names.into())));
    let shown: RawShownOverlay = decode(option, written.into())?;
    let legend: &[LegendEntry] = match &overlay.kind {
        OverlayKind::Categorical(legend) => legend,
        _ => &[],
    };
    let mut faults = Vec::new();
    let categories = shown.categories.map(|list| {
        let (indices, found) = chosen(legend, list.iter().map(|(i, name)| (i, name.as_str())));
        let found = found.into_iter();
        faults.extend(
            found.map(|(_, words)| fault(option, words.found, words.allowed, words.remedy)),
        );
        indices
    });
    if faults.is_empty() {
        let opacity = shown.opacity.map_or(1.0, |opacity| opacity.0);
        Ok((index, opacity, categories))
    } else {
        Err(faults)
    }
}

fn described_lamp(option: &str, spec: &str, exhibit: &Exhibit) -> Result<Lamp, Vec<Fault>> {
    let mut lamp = table(option, "kind=point", parts(spec))?;
    // Nothing refers to it by its id.
    lamp.entry("id").or_insert_with(|| "lamp".into());
    let lamps = Value::Array(vec![lamp.into()]);
    let mut valid = validated(option, "lamp", lamps, "lamp[0]", exhibit)?;
    valid.lamps.pop().ok_or_else(Vec::new)
}

/// What is to change in a camera.
struct CameraChange {
    /// Resolution of the display in pixels per inch.
    true_size: Option<f64>,
    raw: RawCamera,
}

impl CameraChange {
    fn parse(spec: &str) -> Result<Self, Vec<Fault>> {
        let (sizes, keys): (Vec<&str>, Vec<&str>) =
            parts(spec).partition(|part| part.starts_with(TRUE_SIZE));
        let mut faults = Vec::new();
        let raw = table(CAMERA, "tilt_deg=30", keys)
            .and_then(|table| decode::<RawCamera>(CAMERA, table.into()))
            .map_err(|found| faults.extend(found));
        let true_size = match sizes[..] {
            [] => None,
            [size] => pixels_per_inch(size)
                .map_err(|found| faults.extend(found))
                .ok(),
            [_, again, ..] => {
                let found = format!("{} as well", quote(again));
                let remedy = "remove one of the two";
                faults.push(unreadable(CAMERA, found, "one resolution", remedy));
                None
            }
        };
        if matches!(&raw, Ok(raw) if raw.width_mm.is_some()) && !sizes.is_empty() {
            let found = format!("width_mm together with {TRUE_SIZE}");
            let remedy = "remove one of the two";
            faults.push(unreadable(CAMERA, found, "one of them", remedy));
        }
        match raw {
            Ok(raw) if faults.is_empty() => Ok(Self { true_size, raw }),
            _ => Err(faults),
        }
    }

    fn applied(&self, camera: Camera, width_px: u32) -> Camera {
        const MM_PER_INCH: f64 = 25.4;
        let raw = &self.raw;
        let true_width = self
            .true_size
            .map(|ppi| f64::from(width_px) / ppi * MM_PER_INCH);
        let width_mm = true_width.or(raw.width_mm.map(|mm| mm.0));
        Camera {
            centre_mm: raw
                .centre_mm
                .map_or(camera.centre_mm, |mm| DVec2::from(mm.map(|mm| mm.0))),
            width_mm: width_mm.unwrap_or(camera.width_mm),
            tilt: raw.tilt_deg.map_or(camera.tilt, |deg| Degrees(deg.0)),
            turn: raw.turn_deg.map_or(camera.turn, |deg| Degrees(deg.0)),
            distance_mm: raw.distance_mm.map(|mm| mm.0).or(camera.distance_mm),
        }
    }
}

fn pixels_per_inch(part: &str) -> Result<f64, Vec<Fault>> {
    let [least, most] = PPI_RANGE;
    let text = part.strip_prefix(TRUE_SIZE).unwrap_or_default();
    let ppi = text.parse().ok();
    ppi.filter(|ppi| (least..=most).contains(ppi))
        .ok_or_else(|| {
            vec![unreadable(
                CAMERA,
                quote(part),
                format!("{TRUE_SIZE} and a number from {least} to {most}"),
                "write how many pixels the display has in an inch",
            )]
        })
}

fn resolve<'i>(
    option: &str,
    what: &str,
    id: &str,
    ids: impl Iterator<Item = &'i str> + Clone,
) -> Result<usize, Vec<Fault>> {
    ids.clone().position(|known| known == id).ok_or_else(|| {
        let allowed = match ids.clone().next() {
            Some(_) => format!("the id of {}: {}", one(what), quoted_list(ids.clone())),
            None => format!("the id of {}, and there is none", one(what)),
        };
        let remedy = did_you_mean(id, ids, "correct it");
        vec![fault(option, quote(id), allowed, remedy)]
    })
}

fn too_many(option: &str, found: usize, most: usize) -> Fault {
    let found = format!("this option {found} times");
    unreadable(option, found, format!("up to {most} times"), "remove some")
}

/// How faults name one of `count` options of the same name.
fn numbered(option: &str, index: usize, count: usize) -> String {
    match count {
        1 => option.to_owned(),
        _ => format!("{option}[{index}]"),
    }
}
