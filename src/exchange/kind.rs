//! What a file of another program is, by what is in it.

use std::{
    fs::File,
    io::Read as _,
    path::{Path, PathBuf},
};

use serde_json::Value;

use super::{ExchangeError, error::whole_file, iiif::IIIF_MANIFEST, json};
use crate::manifest::document::Words;

/// What can be imported.
const ALLOWED: &str = "a polynomial texture map (.ptm), hemispherical harmonics (.rti), Relight's \
     info.json or .dome, a file of light directions (.lp), or a IIIF Presentation 3 manifest";

/// The kinds of file, with what was read of them already.
pub(super) enum Kind {
    Ptm,
    Hsh,
    Lp,
    Relight(Value),
    Dome(Value),
    Iiif(Value),
}

/// The file that `path` means: a folder stands for what describes the pictures in it.
pub(super) fn inside(path: &Path) -> PathBuf {
    if path.is_dir() {
        let usual = ["info.json", IIIF_MANIFEST].map(|name| path.join(name));
        if let Some(found) = usual.into_iter().find(|file| file.is_file()) {
            return found;
        }
    }
    path.to_owned()
}

impl Kind {
    /// # Errors
    /// One fault, of a file that is none of these or cannot be read.
    pub fn of(file: &Path) -> Result<Self, ExchangeError> {
        let extension = file.extension().map(|e| e.to_string_lossy().to_lowercase());
        let extension = extension.as_deref().unwrap_or_default();
        let mut start = Vec::new();
        if let Ok(opened) = File::open(file) {
            // A file that cannot be read is told of below.
            let _ = opened.take(64).read_to_end(&mut start);
        }
        if start.starts_with(b"PTM_") || extension == "ptm" {
            return Ok(Self::Ptm);
        }
        if start.starts_with(b"#HSH") || extension == "rti" {
            return Ok(Self::Hsh);
        }
        let bytes = json::bytes(file)?;
        let text = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(&bytes);
        if text.trim_ascii_start().starts_with(b"{") || matches!(extension, "json" | "dome") {
            return Self::of_json(file, json::parse(file, &bytes)?);
        }
        if extension == "lp" {
            return Ok(Self::Lp);
        }
        let found = "a file of a kind that is not known here";
        Err(refused(file, found, "name one of these files"))
    }

    fn of_json(file: &Path, json: Value) -> Result<Self, ExchangeError> {
        let contexts = match json.get("@context") {
            Some(Value::Array(several)) => several.iter().filter_map(Value::as_str).collect(),
            Some(Value::String(one)) => vec![one.as_str()],
            _ => Vec::new(),
        };
        let speaks = |version: &str| {
            let context = format!("//iiif.io/api/presentation/{version}/context.json");
            contexts.iter().any(|own| own.ends_with(&context))
        };
        if speaks("3") {
            return match json.get("type").and_then(Value::as_str) {
                Some("Manifest") => Ok(Self::Iiif(json)),
                _ => Err(refused(
                    file,
                    "a IIIF resource that is not a manifest",
                    "name a manifest: what a collection lists",
                )),
            };
        }
        if speaks("2") || contexts.iter().any(|own| own.contains("shared-canvas")) {
            return Err(refused(
                file,
                "a IIIF Presentation 2 manifest",
                "ask for version 3, or convert it, for instance with @iiif/upgrader",
            ));
        }
        if json.get("materials").is_some() && json.get("type").is_some() {
            return Ok(Self::Relight(json));
        }
        let keys = ["lightConfiguration", "domeDiameter", "directions"];
        if keys.iter().any(|key| json.get(key).is_some()) {
            return Ok(Self::Dome(json));
        }
        let found = "JSON without the keys of any of these";
        Err(refused(file, found, "name one of these files"))
    }
}

fn refused(file: &Path, found: &str, remedy: &str) -> ExchangeError {
    whole_file(file, Words::new(found, ALLOWED, remedy))
}
