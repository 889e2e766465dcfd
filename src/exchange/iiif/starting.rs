//! Canvases of IIIF → an exhibit: which are two sides of one sheet, how large it is, and what each
//! picture shows.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs::{self, File},
    io::{self, Write as _},
    path::{Path, PathBuf},
};

use glam::DVec2;
use serde_json::Value;

use super::{
    IMAGES, Role,
    read::{self, Canvas, Note},
    resolve::{Beside, Unresolved},
    sheet::{self, Ids, Sheet},
    words::{FIRST, Texts},
};
use crate::{
    exchange::{
        ExchangeError, Imported, Known,
        error::{Faulty, made_of},
        stage,
    },
    manifest::{
        MANIFEST, Pattern as _, SideName, check_shape,
        document::Words,
        hotspot::outline_faults,
        quote,
        raw::values::{DateText, Id},
    },
    maps::{self, MapError, encode::write_whole},
};

/// Makes an exhibit of a IIIF manifest and the pictures beside it.
pub(in super::super) fn import(
    file: &Path,
    json: &Value,
    out: &Path,
    known: &Known,
) -> Result<Imported, ExchangeError> {
    let mut faulty = Faulty::new(file);
    let manifest = read::manifest(json, &mut faulty);
    let folder = match file.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let real = folder
        .canonicalize()
        .map_err(ExchangeError::folder(folder))?;
    let source = Source {
        beside: Beside::new(real, manifest.id),
        credit: &manifest.credit,
        known,
    };
    let sheets = sheet::sheets(&manifest.canvases, &mut faulty);
    let mut drawings = Vec::new();
    for sheet in &sheets {
        drawings.extend(drawing(sheet, &source, &mut faulty)?);
    }
    faulty.check()?;
    let text = text(&manifest, &drawings);
    check_shape(&text).map_err(|faults| made_of(file, faults))?;
    let found = stage::whole(out, &[IMAGES, MANIFEST], |folder| {
        for (from, to) in drawings.iter().flat_map(|drawing| &drawing.files) {
            copy(from, &folder.join(to))?;
        }
        write_whole(&folder.join(MANIFEST), |manifest| {
            manifest.write_all(text.as_bytes())
        })?;
        stage::checked(file, folder, out)
    })?;
    let mut warnings = faulty.warnings()?;
    warnings.extend(found);
    Ok(Imported {
        file: out.join(MANIFEST),
        is_capture: false,
        warnings,
    })
}

fn copy(from: &Path, to: &Path) -> Result<(), ExchangeError> {
    if let Some(folder) = to.parent() {
        fs::create_dir_all(folder).map_err(ExchangeError::folder(folder))?;
    }
    let mut picture = File::open(from).map_err(|reason| MapError::Read {
        path: from.to_owned(),
        reason,
    })?;
    write_whole(to, |file| io::copy(&mut picture, file).map(|_| ()))?;
    Ok(())
}

/// What all sheets of a manifest come from.
struct Source<'s> {
    beside: Beside,
    /// Of what has none of its own.
    credit: &'s Texts,
    known: &'s Known,
}

/// A drawing, as lines of a manifest and files.
struct Drawing {
    text: String,
    languages: BTreeSet<String>,
    /// Files to copy, each to this path within the exhibit's folder.
    files: Vec<(PathBuf, String)>,
}

/// A picture of a side.
struct Found {
    role: Role,
    label: Texts,
    date: Option<String>,
    /// Within the exhibit's folder.
    path: String,
}

/// `None` where faults are recorded.
fn drawing(
    sheet: &Sheet<'_, '_>,
    source: &Source<'_>,
    faulty: &mut Faulty<'_>,
) -> Result<Option<Drawing>, ExchangeError> {
    let mut files = Vec::new();
    let mut sides = Vec::new();
    let mut header = None;
    let mut recto = Vec::new();
    for (side, canvas) in sheet.sides() {
        let mut found = Vec::new();
        let mut roles = Vec::new();
        let mut is_whole = true;
        for (i, picture) in canvas.pictures.iter().enumerate() {
            let (file, given) = match source.beside.find(&picture.ids) {
                Ok(found) => found,
                Err(why) => {
                    let id = picture.ids.first().copied().unwrap_or_default();
                    faulty.fault(format!("{}.id", picture.path), unresolved(id, &why));
                    is_whole = false;
                    continue;
                }
            };
            let probed = maps::probe(&file)?;
            header.get_or_insert(probed);
            let role = match i {
                0 => Role::Albedo,
                _ => sheet::role(&given, &picture.label, &roles, &recto),
            };
            roles.push(role.clone());
            let path = format!("{IMAGES}/{}/{}/{}", sheet.id, word(side), role.path());
            let path = format!("{path}.{}", extension(&file));
            files.push((file, path.clone()));
            found.push(Found {
                role,
                label: picture.label.clone(),
                date: picture.date.clone(),
                path,
            });
        }
        if !is_whole {
            return Ok(None);
        }
        recto = roles;
        sides.push((side, canvas, found));
    }
    let Some(header) = header else {
        return Ok(None);
    };
    let size_mm = sheet.size_mm(source.known, &header, faulty);
    let mut languages = BTreeSet::new();
    let text = Writer {
        sheet,
        size_mm,
        credit: source.credit,
        languages: &mut languages,
    }
    .drawing(&sides, faulty);
    Ok(Some(Drawing {
        text,
        languages,
        files,
    }))
}

fn unresolved(id: &str, why: &Unresolved) -> Words {
    let found = quote(id);
    let beside = "the address of a picture that lies beside the manifest";
    match why {
        Unresolved::NoAddress => Words::new(
            found,
            "an address that begins with http, without .. in its path",
            "write the picture's address",
        ),
        Unresolved::Absent(name) => Words::new(
            found,
            beside,
            format!(
                "download the picture, and put it beside the manifest as {}",
                quote(name)
            ),
        ),
        Unresolved::Outside(name) => Words::new(
            format!(
                "{found}, for which {} is a link out of the manifest's folder",
                quote(name)
            ),
            beside,
            "copy the picture itself beside the manifest",
        ),
    }
}

fn word(side: SideName) -> &'static str {
    match side {
        SideName::Recto => "recto",
        SideName::Verso => "verso",
    }
}

/// A plain extension; what a file is is told by its content.
fn extension(file: &Path) -> String {
    let extension = file.extension().map(|e| e.to_string_lossy().to_lowercase());
    let plain = extension.filter(|e| !e.is_empty() && e.chars().all(|c| c.is_ascii_alphanumeric()));
    plain.unwrap_or_else(|| "img".to_owned())
}

/// Writes a drawing.
struct Writer<'w> {
    sheet: &'w Sheet<'w, 'w>,
    size_mm: [f64; 2],
    credit: &'w Texts,
    languages: &'w mut BTreeSet<String>,
}

/// A side with what was found of it.
type Side<'s> = (SideName, &'s Canvas<'s>, Vec<Found>);

impl Writer<'_> {
    /// A line with a wording, or nothing where there is no text.
    fn wording(&mut self, key: &str, texts: &Texts) -> String {
        if texts.is_empty() {
            return String::new();
        }
        texts.languages(self.languages);
        format!("{key} = {}\n", texts.toml())
    }

    fn drawing(mut self, sides: &[Side<'_>], faulty: &mut Faulty<'_>) -> String {
        let line = |key: &str, text: Option<&str>| {
            let text = text.filter(|text| !text.trim().is_empty());
            text.map_or(String::new(), |text| {
                format!("{key} = {}\n", toml::Value::from(text))
            })
        };
        let first = sides[0].1;
        let mut text = format!("[[drawing]]\nid = \"{}\"\n", self.sheet.id);
        text += &self.wording("title", &self.sheet.title.clone());
        text += &self.wording("caption", &first.summary);
        text += &line("credit", first.credit.any().or(self.credit.any()));
        text += &line("date", first.about.date.as_deref());
        text += &line("inventory", first.about.inventory.as_deref());
        let [width, height] = self.size_mm;
        text += &format!("size_mm = [{width:?}, {height:?}]\n");
        text += "# What it is made of is not said.\npaper = { kind = \"laid\", source = \"assumed\" }\n\n";
        for (side, _, found) in sides {
            text += &format!("[drawing.{}]\nalbedo = {}\n", word(*side), file(&found[0]));
            if *side == SideName::Verso {
                text += "register = { flip = \"horizontal\" }\n";
            }
            text += "\n";
        }
        text += &self.states(sides);
        for (side, _, found) in sides {
            text += &self.stacks(*side, found);
            text += &self.overlays(*side, found);
        }
        let mut ids = Ids::default();
        for (side, canvas, _) in sides {
            for note in &canvas.notes {
                text += &self.hotspot(*side, canvas, note, &mut ids, faulty);
            }
        }
        text
    }

    /// A state may be of both sides.
    fn states(&mut self, sides: &[Side<'_>]) -> String {
        let mut ids: Vec<&str> = Vec::new();
        for (_, _, found) in sides {
            for found in found {
                match &found.role {
                    Role::State(id) if !ids.contains(&id.as_str()) => ids.push(id),
                    _ => {}
                }
            }
        }
        let mut text = String::new();
        for id in ids {
            let role = Role::State(id.to_owned());
            let own: Vec<(SideName, &Found)> = sides
                .iter()
                .filter_map(|(side, _, found)| {
                    Some((*side, found.iter().find(|found| found.role == role)?))
                })
                .collect();
            let (_, first) = own[0];
            text += &format!("[[drawing.state]]\nid = \"{id}\"\n");
            text += &self.wording("title", &first.label);
            let date = first.date.as_deref().and_then(DateText::from_text);
            if let Some(date) = date {
                text += &format!("date = \"{}\"\n", date.as_str());
            }
            for (side, found) in own {
                text += &format!("{}.albedo = {}\n", word(side), file(found));
            }
            text += "\n";
        }
        text
    }

    fn stacks(&mut self, side: SideName, found: &[Found]) -> String {
        let mut stacks: BTreeMap<&str, Vec<(&str, &Found)>> = BTreeMap::new();
        for found in found {
            if let Role::Band(stack, nm) = &found.role {
                stacks.entry(stack).or_default().push((nm, found));
            }
        }
        let mut text = String::new();
        for (stack, bands) in stacks {
            text += &format!(
                "[[drawing.stack]]\nid = \"{stack}\"\nside = \"{}\"\nbands = [\n",
                word(side)
            );
            for (nm, found) in bands {
                text += &format!("    {{ file = {}, wavelength_nm = {nm} }},\n", file(found));
            }
            text += "]\n\n";
        }
        text
    }

    fn overlays(&mut self, side: SideName, found: &[Found]) -> String {
        let mut text = String::new();
        for found in found {
            if let Role::Overlay(id) = &found.role {
                text += &format!("[[drawing.overlay]]\nid = \"{id}\"\n");
                text += &self.wording("title", &found.label);
                text += &format!(
                    "side = \"{}\"\nkind = \"picture\"\nfile = {}\n\n",
                    word(side),
                    file(found)
                );
            }
        }
        text
    }

    fn hotspot(
        &mut self,
        side: SideName,
        canvas: &Canvas<'_>,
        note: &Note<'_>,
        ids: &mut Ids,
        faulty: &mut Faulty<'_>,
    ) -> String {
        let scale = [0, 1].map(|i| self.size_mm[i] / canvas.size[i]);
        let rounded = |v: f64| (v * 100.0).round() / 100.0;
        let outline = note.outline.iter().flatten();
        let places: Vec<DVec2> = outline
            .map(|[x, y]| DVec2::new(rounded(x * scale[0]), rounded(y * scale[1])))
            .collect();
        let is_far = places
            .iter()
            .any(|place| place.abs().max_element() > 5000.0);
        if places.is_empty() || is_far || !outline_faults(&places).is_empty() {
            let found = "an annotation without an outline that goes around a region once";
            faulty.warning(&note.path, Words::new(found, "", "it is left out"));
            return String::new();
        }
        // What has no name of its own is called by its first line.
        let title = match note.label.is_empty() {
            true => note
                .text
                .each(|text| text.lines().next().unwrap_or_default().to_owned()),
            false => note.label.clone(),
        };
        if title.is_empty() {
            let found = "an annotation without a text";
            faulty.warning(&note.path, Words::new(found, "", "it is left out"));
            return String::new();
        }
        let last = note
            .id
            .trim_end_matches('/')
            .rsplit(['/', '#'])
            .next()
            .unwrap_or_default();
        let own = Id::from_text(last);
        let id = ids.free(own.as_ref().map_or("hotspot", Id::as_str));
        let places: Vec<String> = places
            .iter()
            .map(|place| format!("[{:?}, {:?}]", place.x, place.y))
            .collect();
        let mut text = format!(
            "[[drawing.hotspot]]\nid = \"{id}\"\nside = \"{}\"\npolygon_mm = [{}]\n",
            word(side),
            places.join(", ")
        );
        text += &self.wording("title", &title);
        if title != note.text {
            text += &self.wording("text", &note.text);
        }
        text + "\n"
    }
}

fn file(found: &Found) -> toml::Value {
    toml::Value::from(found.path.as_str())
}

/// The manifest.
fn text(manifest: &read::Manifest<'_>, drawings: &[Drawing]) -> String {
    let mut languages = BTreeSet::new();
    manifest.label.languages(&mut languages);
    for drawing in drawings {
        languages.extend(drawing.languages.iter().cloned());
    }
    let mut text = "# Made by `recto import` from a IIIF manifest. `recto schema` prints what an editor needs to\n\
                    # check this file while you type.\n\n[exhibit]\n"
        .to_owned();
    if !manifest.label.is_empty() {
        text += &format!("title = {}\n", manifest.label.toml());
    }
    if !languages.is_empty() {
        // The first is what is read where a text is in no other.
        let mut tags: Vec<&String> = languages.iter().collect();
        tags.sort_by_key(|tag| *tag != FIRST);
        let tags: Vec<String> = tags.iter().map(|tag| format!("\"{tag}\"")).collect();
        text += &format!("languages = [{}]\n", tags.join(", "));
    }
    text += "\n";
    for drawing in drawings {
        text += &drawing.text;
    }
    text.trim_end().to_owned() + "\n"
}
