//! A IIIF manifest → its canvases, with what exhibits have a place for.

use serde_json::Value;

use super::{PHYSDIM, outline, words::Texts};
use crate::{
    exchange::{
        error::Faulty,
        json::{self, found},
    },
    manifest::document::Words,
};

/// A manifest.
pub struct Manifest<'j> {
    pub id: Option<&'j str>,
    pub label: Texts,
    pub credit: Texts,
    pub canvases: Vec<Canvas<'j>>,
}

/// A canvas.
pub struct Canvas<'j> {
    /// Its place in the manifest, as faults name it.
    pub path: String,
    pub id: &'j str,
    pub label: Texts,
    pub summary: Texts,
    pub credit: Texts,
    pub about: About,
    /// Width and height in its own pixels.
    pub size: [f64; 2],
    /// How large these pixels are.
    pub mm_per_px: Option<f64>,
    /// The first is shown first; never empty.
    pub pictures: Vec<Picture<'j>>,
    pub notes: Vec<Note<'j>>,
}

/// What metadata says.
#[derive(Default)]
pub struct About {
    pub date: Option<String>,
    pub inventory: Option<String>,
    pub dimensions: Option<String>,
}

/// A picture that paints a canvas.
pub struct Picture<'j> {
    pub path: String,
    /// Its own address, and those of services that it comes from.
    pub ids: Vec<&'j str>,
    pub label: Texts,
    pub date: Option<String>,
}

/// What is said about a region.
pub struct Note<'j> {
    pub path: String,
    pub id: &'j str,
    pub label: Texts,
    pub text: Texts,
    /// In pixels of the canvas.
    pub outline: Option<Vec<[f64; 2]>>,
}

fn text<'j>(value: &'j Value, key: &str) -> &'j str {
    value.get(key).and_then(Value::as_str).unwrap_or_default()
}

/// A list, or one alone in its place.
fn list(value: Option<&Value>) -> Vec<&Value> {
    match value {
        None | Some(Value::Null) => Vec::new(),
        Some(Value::Array(several)) => several.iter().collect(),
        Some(one) => vec![one],
    }
}

/// Reads what there is, and records what is wrong.
pub fn manifest<'j>(json: &'j Value, faulty: &mut Faulty<'_>) -> Manifest<'j> {
    let items = json.get("items").and_then(Value::as_array);
    if items.is_none_or(Vec::is_empty) {
        let allowed = "a list of canvases";
        let words = Words::new(
            found(json.get("items")),
            allowed,
            "ask for the whole manifest",
        );
        faulty.fault("items", words);
    }
    let canvases = items.into_iter().flatten().enumerate();
    let canvases = canvases.filter_map(|(i, item)| canvas(item, format!("items[{i}]"), faulty));
    Manifest {
        canvases: canvases.collect(),
        id: json.get("id").and_then(Value::as_str),
        label: Texts::of(json.get("label")),
        credit: credit(json),
    }
}

fn credit(value: &Value) -> Texts {
    let statement = value.get("requiredStatement");
    let credit = Texts::of(statement.and_then(|statement| statement.get("value")));
    match value.get("rights").and_then(Value::as_str) {
        Some(rights) if credit.is_empty() => {
            let mut texts = Texts::default();
            texts.add("none", rights);
            texts
        }
        _ => credit,
    }
}

fn canvas<'j>(value: &'j Value, path: String, faulty: &mut Faulty<'_>) -> Option<Canvas<'j>> {
    let mut side = |key: &str| {
        let number = value.get(key).and_then(Value::as_f64);
        let number = number.filter(|number| (1.0..=1e6).contains(number));
        if number.is_none() {
            let words = Words::new(
                found(value.get(key)),
                "a number from 1 to 1000000",
                "write the size of the canvas",
            );
            faulty.fault(format!("{path}.{key}"), words);
        }
        number
    };
    let size = [side("width"), side("height")];
    let (pictures, scale) = pictures(value, &path, faulty);
    let size = [size[0]?, size[1]?];
    if pictures.is_empty() {
        let found = "a canvas without a picture";
        let remedy = "remove it, or paint a picture on it";
        faulty.fault(&path, Words::new(found, "canvases with pictures", remedy));
        return None;
    }
    // Of the first picture's pixels, where the canvas does not say it.
    let of_picture = scale.map(|(scale, width)| scale * width / size[0]);
    Some(Canvas {
        notes: notes(value, &path, size, faulty),
        id: text(value, "id"),
        label: Texts::of(value.get("label")),
        summary: Texts::of(value.get("summary")),
        credit: credit(value),
        about: about(value),
        mm_per_px: mm_per_px(value).or(of_picture),
        size,
        pictures,
        path,
    })
}

/// How large a pixel is, by a service of physical dimensions.
fn mm_per_px(value: &Value) -> Option<f64> {
    let services = list(value.get("service"));
    let service = services.iter().find(|service| {
        let said = [text(service, "profile"), text(service, "@context")];
        said.iter()
            .any(|said| said.contains("annex/services/physdim") || *said == PHYSDIM)
    });
    let service = match service {
        Some(service) => service,
        // An image service may carry it.
        None => return services.iter().find_map(|service| mm_per_px(service)),
    };
    let mm = match text(service, "physicalUnits") {
        "mm" => 1.0,
        "cm" => 10.0,
        "in" => 25.4,
        _ => return None,
    };
    let scale = service.get("physicalScale").and_then(Value::as_f64)? * mm;
    (scale > 0.0 && scale.is_finite()).then_some(scale)
}

fn about(value: &Value) -> About {
    let mut about = About::default();
    for entry in list(value.get("metadata")) {
        let label = Texts::of(entry.get("label"));
        let value = Texts::of(entry.get("value"));
        let (Some(label), Some(value)) = (label.any(), value.any()) else {
            continue;
        };
        let (label, value) = (label.to_lowercase(), value.to_owned());
        let is = |words: &[&str]| words.contains(&label.trim());
        if is(&[
            "date",
            "data",
            "datum",
            "datierung",
            "fecha",
            "date created",
            "created",
        ]) {
            about.date.get_or_insert(value);
        } else if is(&[
            "size",
            "dimensions",
            "dimensioni",
            "maße",
            "dimensiones",
            "measurements",
        ]) {
            about.dimensions.get_or_insert(value);
        } else if label.contains("inventory")
            || is(&["shelfmark", "accession number", "inventario"])
        {
            about.inventory.get_or_insert(value);
        }
    }
    about
}

/// The pictures of a canvas; and mm for a pixel of the first, and its width, where they are said.
fn pictures<'j>(
    canvas: &'j Value,
    path: &str,
    faulty: &mut Faulty<'_>,
) -> (Vec<Picture<'j>>, Option<(f64, f64)>) {
    let mut pictures = Vec::new();
    let mut scale = None;
    let mut painted = 0;
    for (p, page) in list(canvas.get("items")).into_iter().enumerate() {
        for (a, annotation) in list(page.get("items")).into_iter().enumerate() {
            let path = format!("{path}.items[{p}].items[{a}]");
            if text(annotation, "motivation") != "painting" {
                continue;
            }
            painted += 1;
            if painted > 1 {
                let found = "a second picture painted on the same canvas";
                let remedy = "it is left out; make a choice of both to keep it";
                faulty.warning(&path, Words::new(found, "", remedy));
                continue;
            }
            whole(annotation, canvas, &path, faulty);
            for body in list(annotation.get("body")) {
                for (i, item) in choices(body).into_iter().enumerate() {
                    let path = match text(body, "type") {
                        "Choice" => format!("{path}.body.items[{i}]"),
                        _ => format!("{path}.body"),
                    };
                    let Some(picture) = picture(item, path, faulty) else {
                        continue;
                    };
                    if pictures.is_empty() {
                        let width = source(item).get("width").and_then(Value::as_f64);
                        scale = mm_per_px(source(item)).zip(width);
                    }
                    pictures.push(picture);
                }
            }
        }
    }
    (pictures, scale)
}

/// Finds pictures that do not cover their canvas.
fn whole(annotation: &Value, canvas: &Value, path: &str, faulty: &mut Faulty<'_>) {
    let side = |key| canvas.get(key).and_then(Value::as_f64).unwrap_or_default();
    let size = [side("width"), side("height")];
    let target = annotation.get("target");
    let Some(places) = target.and_then(|target| outline::of_target(target, size)) else {
        return;
    };
    let fold = |i: usize, pick: fn(f64, f64) -> f64| {
        places
            .iter()
            .map(|place| place[i])
            .reduce(pick)
            .unwrap_or_default()
    };
    let covers = (0..2).all(|i| fold(i, f64::min) <= 1.0 && fold(i, f64::max) >= size[i] - 1.0);
    if !covers {
        let found = "a picture on a part of its canvas";
        let allowed = "pictures that cover their canvas";
        let remedy = "make the canvas as large as the picture, or crop it to the sheet";
        faulty.fault(format!("{path}.target"), Words::new(found, allowed, remedy));
    }
}

fn choices(body: &Value) -> Vec<&Value> {
    match text(body, "type") {
        "Choice" => list(body.get("items")),
        _ => vec![body],
    }
}

/// What a specific resource is of, or the resource itself.
fn source(body: &Value) -> &Value {
    match (text(body, "type"), body.get("source")) {
        ("SpecificResource", Some(source)) if source.is_object() => source,
        _ => body,
    }
}

fn picture<'j>(item: &'j Value, path: String, faulty: &mut Faulty<'_>) -> Option<Picture<'j>> {
    let own = source(item);
    let kind = text(own, "type");
    if kind != "Image" {
        let words = Words::new(found(own.get("type")), "\"Image\"", "paint pictures only");
        faulty.fault(format!("{path}.type"), words);
        return None;
    }
    let services = list(own.get("service"));
    let services = services
        .into_iter()
        .flat_map(|service| [text(service, "id"), text(service, "@id")]);
    let ids: Vec<&str> = std::iter::once(text(own, "id"))
        .chain(services)
        .filter(|id| !id.is_empty())
        .collect();
    let label = [item, own].map(|value| Texts::of(value.get("label")));
    let [label, other] = label;
    Some(Picture {
        ids,
        label: if label.is_empty() { other } else { label },
        date: about(item).date,
        path,
    })
}

/// What is said about regions of a canvas.
fn notes<'j>(
    canvas: &'j Value,
    path: &str,
    size: [f64; 2],
    faulty: &mut Faulty<'_>,
) -> Vec<Note<'j>> {
    let mut notes = Vec::new();
    for (p, page) in list(canvas.get("annotations")).into_iter().enumerate() {
        if page.get("items").is_none() {
            let found = json::found(page.get("id"));
            let remedy = "annotations in other files are left out; embed them";
            faulty.warning(
                format!("{path}.annotations[{p}]"),
                Words::new(found, "", remedy),
            );
        }
        for (a, annotation) in list(page.get("items")).into_iter().enumerate() {
            let mut text_ = Texts::default();
            for body in list(annotation.get("body")) {
                if text(body, "type") == "TextualBody" {
                    let language = body.get("language").and_then(Value::as_str);
                    text_.add(language.unwrap_or("none"), text(body, "value"));
                }
            }
            let target = annotation.get("target");
            notes.push(Note {
                path: format!("{path}.annotations[{p}].items[{a}]"),
                id: text(annotation, "id"),
                label: Texts::of(annotation.get("label")),
                text: text_,
                outline: target.and_then(|target| outline::of_target(target, size)),
            });
        }
    }
    notes
}
