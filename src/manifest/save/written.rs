//! Scenes and lamps as a manifest writes them. Every field is named here, so that none that is
//! new can be forgotten.

use serde::Serialize;
use toml_edit::{DocumentMut, Item, Table, Value};

use super::super::{
    decode::{Brief, Dictionary, List, Pattern, Record},
    exhibit::{
        Ambient, Camera, CompareMode, Comparison, Drawing, Enhancement, Exhibit, Exposure, Lamp,
        LampColour, LampKind, Overlay, OverlayKind, Scene, Wording,
    },
    raw::{
        RawAmbient, RawCamera, RawCompare, RawEnhance, RawExposure, RawLamp, RawScene,
        RawShownOverlay, RawWording,
        lamp::{
            RawDisc, RawDistant, RawIes, RawLampCommon, RawLampKind, RawLightTable, RawPoint,
            RawRectangle, RawSpot,
        },
        values::{
            ConeDeg, DeltaE, DistanceMm, ElevationDeg, Exaggeration, Fraction, Id, LampCandela,
            LampLux, LampMm, LampNits, Language, LayerName, Level, LoupeRadius, Magnification,
            MemberText, PlaceMm, PositionMm, RoomLux, Temperature, Text, TiltDeg, TurnDeg, ViewMm,
        },
    },
    validate::DAYLIGHT_K,
};

/// Everything that decides the picture of `scene`, one of `exhibit`'s or made from one, and its
/// title and text; its lamps go by `lamps`. `None` where something in it has no written form.
pub fn scene(exhibit: &Exhibit, scene: &Scene, lamps: &[Id]) -> Option<RawScene> {
    let Scene {
        id,
        title,
        text,
        drawing,
        side,
        state,
        overlays,
        categories,
        compare,
        camera: eye,
        lamps: _,
        ambient,
        exposure,
        transmitted,
        enhance,
        language,
    } = scene;
    let drawing = &exhibit.drawings[*drawing];
    let overlays = overlays.iter().map(|(index, opacity)| {
        let overlay = &drawing.overlays[*index];
        let shown = match categories.get(index) {
            Some(shown) => Some(names(overlay, shown)?),
            None => None,
        };
        Some(Brief::Full(RawShownOverlay {
            id: LayerName::from_text(&overlay.id)?,
            opacity: Some(Fraction(*opacity)),
            categories: shown,
        }))
    });
    let overlays: Vec<_> = overlays.collect::<Option<_>>()?;
    let Exposure {
        illuminance,
        level,
        white,
    } = exposure;
    Some(RawScene {
        id: Id::from_text(id)?,
        like: None,
        title: wording(title)?,
        text: wording(text)?,
        drawing: Some(Id::from_text(&drawing.id)?),
        side: Some(*side),
        state: match state {
            Some(state) => Some(Id::from_text(&drawing.states[*state].id)?),
            None => None,
        },
        overlays: (!overlays.is_empty()).then(|| overlays.into_iter().collect()),
        compare: match compare {
            Some(compare) => Some(comparison(exhibit, drawing, compare)?),
            None => None,
        },
        camera: (*eye != Camera::whole_sheet(drawing.size_mm)).then(|| camera(eye)),
        lamps: Some(lamps.iter().cloned().collect()),
        ambient: room(ambient),
        exposure: Some(RawExposure {
            lux: illuminance.map(|lux| LampLux(lux.0)),
            level: Some(Level(*level)),
            white_kelvin: Some(Temperature(white.0)),
        }),
        transmitted: (*transmitted != 0.0).then_some(Fraction(*transmitted)),
        enhance: (*enhance != Enhancement::default()).then(|| enhanced(enhance)),
        language: match language {
            Some(tag) => Some(Language::from_text(tag)?),
            None => None,
        },
    })
}

/// What some categories of an overlay are called.
fn names(overlay: &Overlay, shown: &[usize]) -> Option<List<Text, 1, 256>> {
    let OverlayKind::Categorical(legend) = &overlay.kind else {
        return None;
    };
    let names = shown
        .iter()
        .map(|index| Text::from_text(legend[*index].name()));
    Some(names.collect::<Option<Vec<_>>>()?.into_iter().collect())
}

/// `None` within where there is no text, and altogether where one cannot be written.
fn wording(wording: &Wording) -> Option<Option<RawWording>> {
    let texts = wording.0.iter();
    let texts = texts.map(|(tag, text)| Some((Language::from_text(tag)?, Text::from_text(text)?)));
    let texts: Vec<_> = texts.collect::<Option<_>>()?;
    let written = !texts.is_empty();
    Some(written.then(|| Brief::Full(Dictionary(texts.into_iter().collect()))))
}

fn comparison(exhibit: &Exhibit, drawing: &Drawing, comparison: &Comparison) -> Option<RawCompare> {
    let Comparison {
        mode,
        of,
        at,
        angle,
        centre,
        radius,
        magnify,
        full_delta_e,
        full_luminance,
        coded: _,
        turn: _,
    } = comparison;
    let of = of
        .iter()
        .map(|member| MemberText::from_text(&exhibit.written_member(drawing, *member)));
    // What a mode uses is always written, so that it stays what it is whatever is usual later, and
    // what it does not use never.
    let is = |modes: &[CompareMode]| modes.contains(mode);
    use CompareMode::{Blend, Curtain, Difference, Glass, Loupe};
    let in_delta_e = is(&[Difference]) && full_luminance.is_none();
    Some(RawCompare {
        mode: *mode,
        of: of.collect::<Option<Vec<_>>>()?.into_iter().collect(),
        at: is(&[Curtain, Blend, Glass]).then_some(Fraction(*at)),
        angle_deg: is(&[Curtain]).then_some(TurnDeg(angle.0)),
        centre: is(&[Loupe]).then(|| centre.to_array().map(Fraction)),
        radius: is(&[Loupe]).then_some(LoupeRadius(*radius)),
        magnify: is(&[Loupe]).then_some(Magnification(*magnify)),
        full_delta_e: in_delta_e.then_some(DeltaE(*full_delta_e)),
        full_luminance: full_luminance.map(Level).filter(|_| is(&[Difference])),
    })
}

fn camera(camera: &Camera) -> RawCamera {
    let Camera {
        centre_mm,
        width_mm,
        tilt,
        turn,
        distance_mm,
    } = camera;
    RawCamera {
        centre_mm: Some(centre_mm.to_array().map(PlaceMm)),
        width_mm: Some(ViewMm(*width_mm)),
        tilt_deg: Some(TiltDeg(tilt.0)),
        turn_deg: Some(TurnDeg(turn.0)),
        distance_mm: distance_mm.map(DistanceMm),
    }
}

fn enhanced(enhance: &Enhancement) -> RawEnhance {
    let Enhancement {
        relief_only,
        exaggerate,
        stretch,
        sharpen,
    } = enhance;
    RawEnhance {
        relief_only: Some(*relief_only),
        exaggerate: Some(Exaggeration(*exaggerate)),
        stretch: stretch.map(|ends| ends.to_array().map(Fraction)),
        sharpen: Some(Fraction(*sharpen)),
    }
}

fn room(ambient: &Ambient) -> Option<RawAmbient> {
    let Ambient {
        illuminance,
        kelvin,
    } = ambient;
    let none = illuminance.0 == 0.0 && kelvin.0 == DAYLIGHT_K;
    (!none).then_some(RawAmbient {
        lux: RoomLux(illuminance.0),
        kelvin: Some(Temperature(kelvin.0)),
    })
}

/// A lamp by its own id.
pub fn same_lamp(lamp: &Lamp) -> Option<RawLamp> {
    self::lamp(&Id::from_text(&lamp.id)?, lamp)
}

/// A lamp as it is, in the units that are calculated with, so that nothing is rounded; without a
/// title. `None` for a spectrum or photometric file that is not known.
pub fn lamp(id: &Id, lamp: &Lamp) -> Option<RawLamp> {
    let Lamp {
        id: _,
        title: _,
        colour,
        kind,
        written,
    } = lamp;
    let (kelvin, spectrum) = match colour {
        LampColour::Temperature(kelvin) => (Some(Temperature(kelvin.0)), None),
        LampColour::Chromaticity(_) => (None, Some(written.as_ref()?.common.spectrum.clone()?)),
    };
    let place = |mm: glam::DVec3| Some(mm.to_array().map(PositionMm));
    let kind = match kind {
        LampKind::Distant {
            illuminance,
            elevation,
            azimuth,
        } => RawLampKind::Distant(RawDistant {
            lux_at_sheet: LampLux(illuminance.0),
            elevation_deg: ElevationDeg(elevation.0),
            azimuth_deg: TurnDeg(azimuth.0),
        }),
        LampKind::Point {
            intensity,
            position_mm,
        } => RawLampKind::Point(RawPoint {
            lux_at_sheet: None,
            candela: Some(LampCandela(intensity.0)),
            lumen: None,
            watts: None,
            efficacy_lm_per_w: None,
            position_mm: place(*position_mm),
            elevation_deg: None,
            azimuth_deg: None,
            distance_mm: None,
        }),
        LampKind::Spot {
            intensity,
            position_mm,
            aim_mm,
            hotspot,
            falloff,
        } => RawLampKind::Spot(RawSpot {
            hotspot_deg: ConeDeg(hotspot.0),
            falloff_deg: ConeDeg(falloff.0),
            lux_at_sheet: None,
            candela: Some(LampCandela(intensity.0)),
            lumen: None,
            watts: None,
            efficacy_lm_per_w: None,
            aim_mm: place(*aim_mm),
            position_mm: place(*position_mm),
            elevation_deg: None,
            azimuth_deg: None,
            distance_mm: None,
        }),
        LampKind::Rectangle {
            luminance,
            position_mm,
            aim_mm,
            size_mm,
        } => RawLampKind::Rectangle(RawRectangle {
            size_mm: size_mm.to_array().map(LampMm),
            lux_at_sheet: None,
            nits: Some(LampNits(luminance.0)),
            lumen: None,
            watts: None,
            efficacy_lm_per_w: None,
            aim_mm: place(*aim_mm),
            position_mm: place(*position_mm),
            elevation_deg: None,
            azimuth_deg: None,
            distance_mm: None,
        }),
        LampKind::Disc {
            luminance,
            position_mm,
            aim_mm,
            diameter_mm,
        } => RawLampKind::Disc(RawDisc {
            diameter_mm: LampMm(*diameter_mm),
            lux_at_sheet: None,
            nits: Some(LampNits(luminance.0)),
            lumen: None,
            watts: None,
            efficacy_lm_per_w: None,
            aim_mm: place(*aim_mm),
            position_mm: place(*position_mm),
            elevation_deg: None,
            azimuth_deg: None,
            distance_mm: None,
        }),
        LampKind::Ies {
            photometry: _,
            position_mm,
            aim_mm,
        } => {
            let RawLampKind::Ies(RawIes { file, .. }) = &written.as_ref()?.kind else {
                return None;
            };
            RawLampKind::Ies(RawIes {
                file: file.clone(),
                aim_mm: place(*aim_mm),
                position_mm: place(*position_mm),
                elevation_deg: None,
                azimuth_deg: None,
                distance_mm: None,
            })
        }
        LampKind::LightTable { luminance } => RawLampKind::LightTable(RawLightTable {
            nits: LampNits(luminance.0),
        }),
    };
    Some(RawLamp {
        common: RawLampCommon {
            id: id.clone(),
            title: None,
            kelvin,
            spectrum,
        },
        kind,
    })
}

/// Which of title and text a scene that takes the place of `replaced` leaves as they are.
pub fn same_words(replaced: &Scene, exhibit: &Exhibit, new: &RawScene) -> Vec<&'static str> {
    let old = scene(exhibit, replaced, &[]);
    let old = old.as_ref();
    let pairs = [
        ("title", old.map(|old| &old.title), &new.title),
        ("text", old.map(|old| &old.text), &new.text),
    ];
    let same = pairs.into_iter().filter(|(_, old, new)| *old == Some(*new));
    same.map(|(key, ..)| key).collect()
}

/// A scene's table, one key a line.
pub fn scene_table(raw: &RawScene) -> Result<Table, String> {
    table(raw, RawScene::KEYS)
}

/// A lamp's table, one key a line.
pub fn lamp_table(raw: &RawLamp) -> Result<Table, String> {
    table(raw, &["id", "title", "kind"])
}

/// A table whose keys come in the order of `first`, all on lines of their own.
fn table<T: Serialize>(raw: &T, first: &[&str]) -> Result<Table, String> {
    let text = toml::to_string(raw).map_err(|error| error.to_string())?;
    let document: DocumentMut = text
        .parse()
        .map_err(|error: toml_edit::TomlError| error.to_string())?;
    let mut entries: Vec<(String, Item)> = document
        .iter()
        .map(|(key, item)| (key.to_owned(), item.clone()))
        .collect();
    let place = |key: &str| first.iter().position(|known| *known == key);
    entries.sort_by_key(|(key, _)| place(key).unwrap_or(first.len()));
    let mut table = Table::new();
    for (key, mut item) in entries {
        item.make_value();
        if let Item::Value(value) = &mut item {
            tidy(value);
        }
        table.insert(&key, item);
    }
    Ok(table)
}

/// Everything in one line, with single spaces.
fn tidy(value: &mut Value) {
    match value {
        Value::Array(array) => {
            array.iter_mut().for_each(tidy);
            array.set_trailing("");
            array.set_trailing_comma(false);
            array.fmt();
        }
        Value::InlineTable(table) => {
            table.iter_mut().for_each(|(_, value)| tidy(value));
            table.fmt();
        }
        _ => {}
    }
    value.decor_mut().clear();
}
