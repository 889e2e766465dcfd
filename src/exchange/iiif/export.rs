//! An exhibit → a IIIF manifest, and pictures beside it.

use std::{
    io::Write as _,
    path::{Path, PathBuf},
};

use serde_json::{Value, json};

use super::{
    IIIF_MANIFEST, IMAGES, PHYSDIM, Role, outline,
    pictures::{self, Frame, Written},
    resolve::encoded,
    words,
};
use crate::{
    colour::format_hex,
    exchange::{ExchangeError, stage},
    manifest::{
        Drawing, Exhibit, Hotspot, Overlay, OverlayKind, Side, SideName, SidePatch, Wording,
    },
    maps::encode::write_whole,
};

/// Where the manifest's folder is on the web while it is tried: what `python3 -m http.server`
/// serves.
pub const DEFAULT_BASE: &str = "http://localhost:8000/";

/// What came of an exhibit.
#[derive(Clone, Debug, PartialEq)]
pub struct Exported {
    pub manifest: PathBuf,
    pub canvases: usize,
    /// Pictures, thumbnails apart.
    pub pictures: usize,
}

/// Writes `exhibit` to the folder `out`, which may be yet to be made, as a IIIF Presentation 3
/// manifest with static pictures beside it. `base` is the address that the folder will have, which
/// begins with http:// or https://; a / at its end is added.
///
/// # Errors
/// Where a manifest or a folder of images is there already, or a map cannot be read; then nothing
/// is in `out` that was not there before.
pub fn export_iiif(exhibit: &Exhibit, out: &Path, base: &str) -> Result<Exported, ExchangeError> {
    let base = format!("{}/", base.trim_end_matches('/'));
    stage::whole(out, &[IMAGES, IIIF_MANIFEST], |folder| {
        let mut exporter = Exporter {
            exhibit,
            folder,
            base,
            pictures: 0,
        };
        let (manifest, canvases) = exporter.manifest()?;
        write_whole(&folder.join(IIIF_MANIFEST), |file| {
            serde_json::to_writer_pretty(&mut *file, &manifest)?;
            file.write_all(b"\n")
        })?;
        Ok(Exported {
            manifest: out.join(IIIF_MANIFEST),
            canvases,
            pictures: exporter.pictures,
        })
    })
}

struct Exporter<'e> {
    exhibit: &'e Exhibit,
    folder: &'e Path,
    base: String,
    pictures: usize,
}

fn word(side: SideName) -> &'static str {
    match side {
        SideName::Recto => "recto",
        SideName::Verso => "verso",
    }
}

/// One side, and all that is needed to speak of its canvas.
#[derive(Clone, Copy)]
struct Place<'p> {
    drawing: &'p Drawing,
    name: SideName,
    side: &'p Side,
    /// The canvas's id.
    id: &'p str,
    frame: Frame<'p>,
}

impl Exporter<'_> {
    /// The manifest, and how many canvases it has.
    fn manifest(&mut self) -> Result<(Value, usize), ExchangeError> {
        let mut canvases = Vec::new();
        let mut ranges = Vec::new();
        for drawing in &self.exhibit.drawings {
            let own = self.canvases(drawing)?;
            let items: Vec<Value> = own
                .iter()
                .map(|canvas| json!({ "id": canvas["id"], "type": "Canvas" }))
                .collect();
            ranges.push(json!({
                "id": self.id(&format!("range/{}", drawing.id)),
                "type": "Range",
                "label": words::map(&drawing.title, &drawing.id),
                "items": items,
            }));
            canvases.extend(own);
        }
        let title = match self.exhibit.drawings.as_slice() {
            [only] if self.exhibit.title.0.is_empty() => words::map(&only.title, &only.id),
            _ => words::map(&self.exhibit.title, "Exhibit"),
        };
        let count = canvases.len();
        let mut manifest = json!({
            "@context": "http://iiif.io/api/presentation/3/context.json",
            "id": self.id(IIIF_MANIFEST),
            "type": "Manifest",
            "label": title,
            "items": canvases,
        });
        let mut credits: Vec<&str> = Vec::new();
        for drawing in &self.exhibit.drawings {
            let credit = drawing.credit.as_str();
            if !credit.is_empty() && !credits.contains(&credit) {
                credits.push(credit);
            }
        }
        if !credits.is_empty() {
            set_credit(&mut manifest, &credits.join("; "));
        }
        if ranges.len() > 1 {
            manifest["structures"] = Value::Array(ranges);
        }
        if let Some(thumbnail) = manifest["items"][0].get("thumbnail").cloned() {
            manifest["thumbnail"] = thumbnail;
        }
        Ok((manifest, count))
    }

    fn id(&self, path: &str) -> String {
        format!("{}{}", self.base, encoded(path))
    }

    fn canvases(&mut self, drawing: &Drawing) -> Result<Vec<Value>, ExchangeError> {
        let sides = [
            (SideName::Recto, Some(&drawing.recto)),
            (SideName::Verso, drawing.verso.as_ref()),
        ];
        let mut canvases = Vec::new();
        for (name, side) in sides {
            let Some(side) = side else { continue };
            let within = format!("{IMAGES}/{}/{}", drawing.id, word(name));
            let id = self.id(&format!("canvas/{}/{}", drawing.id, word(name)));
            let place = Place {
                drawing,
                name,
                side,
                id: &id,
                frame: Frame {
                    size_mm: drawing.size_mm,
                    size: canvas_size(drawing, side),
                    folder: self.folder,
                    within: &within,
                },
            };
            canvases.push(self.canvas(place)?);
        }
        Ok(canvases)
    }

    fn canvas(&mut self, place: Place<'_>) -> Result<Value, ExchangeError> {
        let Place {
            drawing,
            name,
            id,
            frame,
            ..
        } = place;
        let mut items = self.choices(place)?;
        let body = match items.len() {
            1 => items.remove(0),
            _ => json!({ "type": "Choice", "items": items }),
        };
        let thumbnail = pictures::thumbnail(&place.side.albedo, frame)?;
        let [width, height] = frame.size;
        let size = format!("{} × {} mm", drawing.size_mm.x, drawing.size_mm.y);
        let mut canvas = json!({
            "id": id,
            "type": "Canvas",
            "label": words::with(&drawing.title, &drawing.id, word(name)),
            "width": width,
            "height": height,
            "thumbnail": [self.image(&thumbnail)],
            "service": [{
                "@context": "http://iiif.io/api/annex/services/physdim/1/context.json",
                "@id": format!("{id}/physdim"),
                "@type": "Service",
                "profile": PHYSDIM,
                "physicalScale": drawing.size_mm.x / f64::from(width),
                "physicalUnits": "mm",
            }],
            "items": [{
                "id": format!("{id}/page"),
                "type": "AnnotationPage",
                "items": [{
                    "id": format!("{id}/picture"),
                    "type": "Annotation",
                    "motivation": "painting",
                    "body": body,
                    "target": id,
                }],
            }],
        });
        let facts = [
            ("Date", drawing.date.as_str()),
            ("Inventory number", drawing.inventory.as_str()),
            ("Size", size.as_str()),
        ];
        let facts = facts.iter().filter(|(_, value)| !value.is_empty());
        let facts: Vec<Value> = facts
            .map(|(label, value)| entry(words::english(label), value))
            .collect();
        canvas["metadata"] = Value::Array(facts);
        if !drawing.caption.0.is_empty() {
            canvas["summary"] = words::map(&drawing.caption, "");
        }
        if !drawing.credit.is_empty() {
            set_credit(&mut canvas, &drawing.credit);
        }
        let own = drawing
            .hotspots
            .iter()
            .filter(|hotspot| hotspot.side == name);
        let notes: Vec<Value> = own.map(|hotspot| note(hotspot, place)).collect();
        if !notes.is_empty() {
            canvas["annotations"] = json!([{
                "id": format!("{id}/hotspots"),
                "type": "AnnotationPage",
                "items": notes,
            }]);
        }
        Ok(canvas)
    }

    /// The pictures of a side: as it is, its states, its bands, its overlays.
    fn choices(&mut self, place: Place<'_>) -> Result<Vec<Value>, ExchangeError> {
        let Place {
            drawing,
            name,
            side,
            frame,
            ..
        } = place;
        let mut items = Vec::new();
        let written = pictures::colour(&side.albedo, &Role::Albedo, frame)?;
        let label = words::with(&drawing.title, &drawing.id, word(name));
        items.push(self.choice(&written, label));
        for state in &drawing.states {
            let patch: &SidePatch = match name {
                SideName::Recto => &state.recto,
                SideName::Verso => &state.verso,
            };
            let Some(albedo) = &patch.albedo else {
                continue;
            };
            let written = pictures::colour(albedo, &Role::State(state.id.clone()), frame)?;
            let mut item = self.choice(&written, words::map(&state.title, &state.id));
            if !state.date.is_empty() {
                item["metadata"] = json!([entry(words::english("Date"), &state.date)]);
            }
            items.push(item);
        }
        for stack in drawing.stacks.iter().filter(|stack| stack.side == name) {
            for band in &stack.bands {
                let nm = band.wavelength_nm.to_string();
                let role = Role::Band(stack.id.clone(), nm.clone());
                let written = pictures::colour(&band.map, &role, frame)?;
                let label = words::with(&stack.title, &stack.id, &format!("{nm} nm"));
                items.push(self.choice(&written, label));
            }
        }
        for overlay in drawing
            .own_overlays()
            .filter(|overlay| overlay.side == name)
        {
            let role = Role::Overlay(overlay.id.clone());
            let written = pictures::overlay(overlay, &role, frame)?;
            let mut item = self.choice(&written, words::map(&overlay.title, &overlay.id));
            let legend = legend(overlay);
            if !legend.is_empty() {
                item["metadata"] = Value::Array(legend);
            }
            items.push(item);
        }
        Ok(items)
    }

    fn choice(&mut self, written: &Written, label: Value) -> Value {
        self.pictures += 1;
        let mut image = self.image(written);
        image["label"] = label;
        image
    }

    fn image(&self, written: &Written) -> Value {
        json!({
            "id": self.id(&written.path),
            "type": "Image",
            "format": written.format,
            "width": written.size[0],
            "height": written.size[1],
        })
    }
}

/// The pixels of a canvas: as wide as the picture of its side, and of the sheet's shape.
fn canvas_size(drawing: &Drawing, side: &Side) -> [u32; 2] {
    let width = side.albedo.file.size[0];
    let height = f64::from(width) * drawing.size_mm.y / drawing.size_mm.x;
    // The cast saturates.
    [width, height.round().max(1.0) as u32]
}

fn entry(label: Value, value: &str) -> Value {
    json!({ "label": label, "value": words::plain(value) })
}

/// What must be said with it, and its licence where the credit names one by its address.
fn set_credit(resource: &mut Value, credit: &str) {
    resource["requiredStatement"] = entry(words::english("Credit"), credit);
    let address = credit.split(|c: char| c.is_whitespace() || matches!(c, '(' | ')' | ',' | ';'));
    let known = [
        "creativecommons.org/licenses/",
        "creativecommons.org/publicdomain/",
        "rightsstatements.org/vocab/",
    ];
    let rights = address.filter_map(|part| {
        let bare = part
            .strip_prefix("https://")
            .or_else(|| part.strip_prefix("http://"))?;
        let is_known = known.iter().any(|start| bare.starts_with(start));
        // Licences are named by their addresses with http.
        is_known.then(|| format!("http://{}", bare.trim_end_matches('.')))
    });
    if let Some(rights) = rights.into_iter().next() {
        resource["rights"] = json!(rights);
    }
}

/// What the colours and values of an overlay mean.
fn legend(overlay: &Overlay) -> Vec<Value> {
    match &overlay.kind {
        OverlayKind::Categorical(entries) => entries
            .iter()
            .map(|own| entry(words::map(&own.label, "?"), &format_hex(own.colour)))
            .collect(),
        OverlayKind::Continuous { unit, range, .. } => {
            let value = format!("{} to {} {unit}", range[0], range[1]);
            vec![entry(words::english("Range"), &value)]
        }
        OverlayKind::Picture(_) | OverlayKind::Bands(_) => Vec::new(),
    }
}

/// A hotspot as an annotation.
fn note(hotspot: &Hotspot, place: Place<'_>) -> Value {
    let Place { id, frame, .. } = place;
    let scale = [
        f64::from(frame.size[0]) / frame.size_mm.x,
        f64::from(frame.size[1]) / frame.size_mm.y,
    ];
    let places = hotspot.polygon_mm.iter();
    let places: Vec<[f64; 2]> = places
        .map(|mm| [mm.x * scale[0], mm.y * scale[1]])
        .collect();
    let texts: &Wording = match hotspot.text.0.is_empty() {
        true => &hotspot.title,
        false => &hotspot.text,
    };
    let bodies: Vec<Value> = texts
        .0
        .iter()
        .map(|(language, text)| {
            json!({
                "type": "TextualBody",
                "value": text,
                "language": language,
                "format": "text/plain",
            })
        })
        .collect();
    json!({
        "id": format!("{id}/hotspots/{}", hotspot.id),
        "type": "Annotation",
        "motivation": "commenting",
        "label": words::map(&hotspot.title, &hotspot.id),
        "body": bodies,
        "target": {
            "type": "SpecificResource",
            "source": id,
            "selector": { "type": "SvgSelector", "value": outline::svg(&places) },
        },
    })
}
