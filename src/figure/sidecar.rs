//! What a figure was made from, as JSON: enough to make it again, and to see whether it would
//! still be the same.

use std::{fs, path::Path};

use serde_json::{Value, json};

use super::{FigureError, scale::Scale};
use crate::{
    manifest::{Exhibit, Scene, Source, exhibit::Surface},
    needs::Needs,
    optics::tier::Tier,
    tradeoff::{
        places::Maps,
        scene::{Seen, is_flattened},
    },
};

/// Where the name of the picture stands in a sidecar.
pub const FILE_POINTER: &str = "/picture/file";

/// What is known of a figure before it is drawn.
pub struct Facts {
    exhibit: Value,
    maps: Vec<Value>,
    /// As a manifest has it,
    scene: Value,
    /// and its lamps.
    lamps: Value,
    size_mm: [f64; 2],
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

/// What a picture is made of.
struct Files<'e> {
    exhibit: &'e Exhibit,
    found: Vec<Value>,
}

impl Files<'_> {
    /// Adds a file that is not there yet; without a source, that which the manifest says of it.
    fn add(&mut self, path: &Path, source: Option<Source>) -> Result<(), FigureError> {
        let name = path.strip_prefix(&self.exhibit.folder).unwrap_or(path);
        let name = name.display().to_string();
        if self.found.iter().any(|known| known["file"] == name) {
            return Ok(());
        }
        let said = || Some(self.exhibit.maps().find(|map| map.path == path)?.source);
        let source = source.or_else(said);
        self.found.push(json!({
            "file": name,
            "source": source,
            "blake3": hash_of(path)?,
        }));
        Ok(())
    }
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
        let mut files = Files {
            exhibit,
            found: Vec::new(),
        };
        for member in exhibit.each_alone(scene) {
            for side in Needs::of(exhibit, &member, tier, false).sides {
                for map in &side.maps {
                    for path in map.files() {
                        let own = map.file();
                        files.add(path, (own.path == path).then_some(own.source))?;
                    }
                }
            }
            match &exhibit.drawing_of(&member).surface {
                Surface::Flat => {}
                Surface::Height(map) => files.add(&map.file.path, Some(map.file.source))?,
                Surface::Gltf(path) => files.add(path, None)?,
            }
        }
        for path in exhibit.lamp_files(scene) {
            files.add(&path, None)?;
        }
        let maps = files.found;
        let manifest = &exhibit.manifest;
        let path = fs::canonicalize(manifest).unwrap_or_else(|_| manifest.clone());
        Ok(Self {
            exhibit: json!({
                "title": exhibit.title.0,
                "manifest": path.display().to_string(),
                "blake3": hash_of(manifest)?,
            }),
            maps,
            scene: exhibit
                .written_scene(scene)
                .map_or(Value::Null, |scene| json!(scene)),
            lamps: exhibit
                .written_lamps(scene)
                .map_or(Value::Null, |lamps| json!(lamps)),
            size_mm: exhibit.drawing_of(scene).size_mm.to_array(),
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
            "lamps": self.lamps,
            "size_mm": self.size_mm,
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
        remarks.push("of the comparison's members the worst");
    }
    match Seen::new(exhibit, scene, size, &mut Maps::default()) {
        Ok(seen) if seen.count() > 0 => {
            let forecasts = seen.forecasts(&[tier]);
            let errors = forecasts.first().map(|forecast| forecast.errors);
            json!({
                "what": "predicted Delta E 2000 from the reference, over the visible sheet",
                "delta_e_mean": errors.map(|errors| errors.mean),
                "delta_e_p95": errors.map(|errors| errors.p95),
                "places": seen.count(),
                "remarks": remarks,
            })
        }
        Ok(_) => json!({ "what": "nothing of the sheet is in the picture" }),
        Err(error) => json!({ "what": format!("not predicted: {error}") }),
    }
}
