//! What a figure was made from, as JSON: enough to make it again, and to see whether it would
//! still be the same.

use std::{fs, path::Path};

use serde_json::{Map, Value, json};

use super::{FigureError, scale::Scale};
use crate::{
    manifest::{
        Exhibit, Scene, SideName,
        exhibit::{
            Ambient, Camera, Comparison, Enhancement, Exposure, LampColour, LampKind, Member,
            Surface,
        },
    },
    needs::Needs,
    optics::tier::Tier,
    tradeoff::{
        places::Maps,
        scene::{Sampled, is_flattened},
    },
};

/// Where the name of the picture stands in a sidecar.
pub const FILE_POINTER: &str = "/picture/file";

/// What is known of a figure before it is drawn.
pub struct Facts {
    exhibit: Value,
    maps: Vec<Value>,
    scene: Value,
    tier: &'static str,
    accuracy: Value,
    size: [u32; 2],
    pub scale: Scale,
    arguments: Vec<String>,
}

/// BLAKE3 in hexadecimal digits, as `b3sum` writes it.
fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

fn hash_of(path: &Path) -> Result<String, FigureError> {
    let bytes = fs::read(path).map_err(|source| FigureError::Read {
        path: path.to_owned(),
        source,
    })?;
    Ok(hash(&bytes))
}

impl Facts {
    /// Of `scene` at `tier` in a picture of `size`, which the program makes again when it is called
    /// with `arguments`. Predicts its accuracy, for which the maps are read.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn new(
        exhibit: &Exhibit,
        scene: &Scene,
        tier: Tier,
        size: [u32; 2],
        arguments: Vec<String>,
    ) -> Result<Self, FigureError> {
        let mut maps = Vec::new();
        let needs = exhibit
            .parts(scene, f64::from(size[0]) / f64::from(size[1].max(1)))
            .into_iter()
            .flat_map(|(member, _)| Needs::of(exhibit, &member, tier, false).sides);
        for side in needs {
            for map in &side.maps {
                let file = map.file();
                let name = file.path.strip_prefix(&exhibit.folder);
                let name = name.unwrap_or(&file.path).display().to_string();
                if !maps.iter().any(|known: &Value| known["file"] == name) {
                    maps.push(json!({
                        "file": name,
                        "source": file.source,
                        "blake3": hash_of(&file.path)?,
                    }));
                }
            }
        }
        let drawing = exhibit.drawing_of(scene);
        let shape = match &drawing.surface {
            Surface::Flat => None,
            Surface::Height(map) => Some((&map.file.path, json!(map.file.source))),
            Surface::Gltf(path) => Some((path, Value::Null)),
        };
        if let Some((path, source)) = shape {
            let name = path.strip_prefix(&exhibit.folder).unwrap_or(path);
            maps.push(json!({
                "file": name.display().to_string(),
                "source": source,
                "blake3": hash_of(path)?,
            }));
        }
        let manifest = &exhibit.manifest;
        let path = fs::canonicalize(manifest).unwrap_or_else(|_| manifest.clone());
        Ok(Self {
            exhibit: json!({
                "title": exhibit.title.0,
                "manifest": path.display().to_string(),
                "blake3": hash_of(manifest)?,
            }),
            maps,
            scene: scene_as_json(exhibit, scene),
            tier: tier.name(),
            accuracy: accuracy(exhibit, scene, tier, size),
            size,
            scale: Scale::new(exhibit, scene, size),
            arguments,
        })
    }

    /// The sidecar of a picture called `name`, of these bytes, with a bar of so many mm and pixels.
    pub fn of_picture(&self, name: &str, bytes: &[u8], bar: Option<(f64, f64)>) -> Value {
        let mut scale = json!(self.scale);
        if let Some((mm, px)) = bar {
            scale["bar_mm"] = json!(mm);
            scale["bar_px"] = json!(px);
        }
        let words = self.arguments.iter().map(String::as_str);
        let command = shlex::try_join(std::iter::once(env!("CARGO_PKG_NAME")).chain(words));
        json!({
            "program": env!("CARGO_PKG_NAME"),
            "version": env!("CARGO_PKG_VERSION"),
            "picture": {
                "file": name,
                "size_px": self.size,
                "blake3": hash(bytes),
            },
            "exhibit": self.exhibit,
            "maps": self.maps,
            "scene": self.scene,
            "tier": self.tier,
            "accuracy": self.accuracy,
            "scale": scale,
            // A path with a zero byte in it, which no system has.
            "command": command.unwrap_or_default(),
            "arguments": self.arguments,
        })
    }
}

/// What the tier is predicted to err by, as `recto check` says it for such a picture.
fn accuracy(exhibit: &Exhibit, scene: &Scene, tier: Tier, size: [u32; 2]) -> Value {
    let mut remarks = Vec::new();
    if is_flattened(exhibit.drawing_of(scene)) {
        remarks.push("the sheet is taken for flat");
    }
    if !scene.overlays.is_empty() {
        remarks.push("overlays are left aside");
    }
    if !scene.enhance.marks().is_empty() {
        remarks.push("enhancement is left aside");
    }
    if scene.compare.is_some() {
        remarks.push("predicted for the scene without its comparison");
    }
    let own = Scene {
        compare: None,
        ..scene.clone()
    };
    match Sampled::new(exhibit, &own, size, &mut Maps::default()) {
        Ok(sampled) if sampled.count() > 0 => {
            let forecasts = sampled.forecasts(&[tier]);
            let errors = forecasts.first().map(|forecast| forecast.errors);
            json!({
                "what": "predicted Delta E 2000 from the reference, over the visible sheet",
                "delta_e_mean": errors.map(|errors| errors.mean),
                "delta_e_p95": errors.map(|errors| errors.p95),
                "places": sampled.count(),
                "remarks": remarks,
            })
        }
        Ok(_) => json!({ "what": "nothing of the sheet is in the picture" }),
        Err(error) => json!({ "what": format!("not predicted: {error}") }),
    }
}

/// All of a scene, by the keys and the ids of a manifest. Every field is named, so that a new one
/// is not forgotten here.
fn scene_as_json(exhibit: &Exhibit, scene: &Scene) -> Value {
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
        camera,
        lamps,
        ambient,
        transmitted,
        exposure,
        enhance,
        language,
    } = scene;
    let sheet = &exhibit.drawings[*drawing];
    let overlays = overlays.iter().map(|(index, opacity)| {
        json!({
            "id": sheet.overlays[*index].id,
            "opacity": opacity,
            // Of its legend, from 0; null where all are shown.
            "categories": categories.get(index),
        })
    });
    let lamps = lamps.iter().map(|&lamp| lamp_as_json(exhibit, lamp));
    let Ambient {
        illuminance,
        kelvin,
    } = ambient;
    let Exposure {
        illuminance: exposed,
        level,
        white,
    } = exposure;
    let Enhancement {
        relief_only,
        exaggerate,
        stretch,
        sharpen,
    } = enhance;
    json!({
        "id": id,
        "title": title.0,
        "text": text.0,
        "drawing": sheet.id,
        "size_mm": sheet.size_mm.to_array(),
        "side": side,
        "state": state.map(|index| &sheet.states[index].id),
        "overlays": overlays.collect::<Vec<_>>(),
        "compare": compare.as_ref().map(|compare| comparison_as_json(exhibit, scene, compare)),
        "camera": camera_as_json(camera),
        "lamps": lamps.collect::<Vec<_>>(),
        "ambient": { "lux": illuminance, "kelvin": kelvin },
        "transmitted": transmitted,
        "exposure": { "lux": exposed, "level": level, "white_kelvin": white },
        "enhance": {
            "relief_only": relief_only,
            "exaggerate": exaggerate,
            "stretch": stretch.map(|stretch| stretch.to_array()),
            "sharpen": sharpen,
        },
        "language": language,
    })
}

fn camera_as_json(camera: &Camera) -> Value {
    let Camera {
        centre_mm,
        width_mm,
        tilt,
        turn,
        distance_mm,
    } = camera;
    json!({
        "centre_mm": centre_mm.to_array(),
        "width_mm": width_mm,
        "tilt_deg": tilt,
        "turn_deg": turn,
        "distance_mm": distance_mm,
    })
}

fn comparison_as_json(exhibit: &Exhibit, scene: &Scene, comparison: &Comparison) -> Value {
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
    let sheet = exhibit.drawing_of(scene);
    let member = |member: &Member| match member {
        Member::State(index) => format!("state:{}", sheet.states[*index].id),
        Member::Side(SideName::Recto) => "side:recto".to_owned(),
        Member::Side(SideName::Verso) => "side:verso".to_owned(),
        Member::Overlay(index) => format!("overlay:{}", sheet.overlays[*index].id),
        Member::Drawing(index) => format!("drawing:{}", exhibit.drawings[*index].id),
    };
    json!({
        "mode": mode,
        "of": of.iter().map(member).collect::<Vec<_>>(),
        "at": at,
        "angle_deg": angle,
        "centre": centre.to_array(),
        "radius": radius,
        "magnify": magnify,
        "full_delta_e": full_delta_e,
        "full_luminance": full_luminance,
    })
}

fn lamp_as_json(exhibit: &Exhibit, lamp: usize) -> Value {
    let lamp = &exhibit.lamps[lamp];
    let mut written = match &lamp.kind {
        LampKind::Distant {
            illuminance,
            elevation,
            azimuth,
        } => json!({
            "kind": "distant",
            "lux_at_sheet": illuminance,
            "elevation_deg": elevation,
            "azimuth_deg": azimuth,
        }),
        LampKind::Point {
            intensity,
            position_mm,
        } => json!({
            "kind": "point",
            "candela": intensity,
            "position_mm": position_mm.to_array(),
        }),
        LampKind::Spot {
            intensity,
            position_mm,
            aim_mm,
            hotspot,
            falloff,
        } => json!({
            "kind": "spot",
            "candela": intensity,
            "position_mm": position_mm.to_array(),
            "aim_mm": aim_mm.to_array(),
            "hotspot_deg": hotspot,
            "falloff_deg": falloff,
        }),
        LampKind::Rectangle {
            luminance,
            position_mm,
            aim_mm,
            size_mm,
        } => json!({
            "kind": "rectangle",
            "nits": luminance,
            "position_mm": position_mm.to_array(),
            "aim_mm": aim_mm.to_array(),
            "size_mm": size_mm.to_array(),
        }),
        LampKind::Disc {
            luminance,
            position_mm,
            aim_mm,
            diameter_mm,
        } => json!({
            "kind": "disc",
            "nits": luminance,
            "position_mm": position_mm.to_array(),
            "aim_mm": aim_mm.to_array(),
            "diameter_mm": diameter_mm,
        }),
        LampKind::Ies {
            photometry: _,
            position_mm,
            aim_mm,
        } => json!({
            "kind": "ies",
            "position_mm": position_mm.to_array(),
            "aim_mm": aim_mm.to_array(),
        }),
        LampKind::LightTable { luminance } => json!({
            "kind": "light-table",
            "nits": luminance,
        }),
    };
    let colour = match lamp.colour {
        LampColour::Temperature(kelvin) => ("kelvin", json!(kelvin)),
        LampColour::Chromaticity(xy) => ("xy", json!(xy)),
    };
    if let Value::Object(written) = &mut written {
        let named = Map::from_iter([
            ("id".to_owned(), json!(lamp.id)),
            ("title".to_owned(), json!(lamp.title.0)),
            (colour.0.to_owned(), colour.1),
        ]);
        written.extend(named);
    }
    written
}
