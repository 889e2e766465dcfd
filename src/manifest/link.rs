//! A link: a scene with its lamps in one word that survives letters, shells and addresses.
//!
//! `recto1.` and, in base64url without padding, four bytes that tell a damaged link and the TOML
//! text of a scene and its lamps. Drawings, states and overlays go by their ids; whatever else
//! decides the picture is in it, so that it stays the same when the manifest's own scenes and lamps
//! change.

use std::{path::Path, sync::Arc};

use base64::{URL_SAFE_NO_PAD, decode_config, encode_config};

use super::{
    Exhibit, Fault, Faults, Pattern, SaveError, Scene, Severity,
    decode::{Decode, List, Node, Report},
    document::Document,
    macros::record,
    quote,
    raw::{RawLamp, RawManifest, RawScene, values::Id},
    save::written,
};

/// How a link of this version begins, and one of any version.
const BEGINNING: &str = "recto1.";
const ANY_BEGINNING: &str = "recto";
/// How faults name it, and the scene and lamps that it adds to an exhibit.
const OPTION: &str = "--link";
const SCENE: &str = "link";
const LAMP: &str = "link-lamp";
/// Longer ones are none.
const LONGEST: usize = 1 << 16;

record! {
    /// What a link says.
    pub struct RawLink {
        required {
            /// The scene.
            scene: RawScene,
        }
        optional {
            /// Its lamps.
            lamp: List<RawLamp>,
        }
        rules []
    }
}

/// A view that was put into words.
#[derive(Clone, Debug, PartialEq)]
pub struct Link(Arc<RawLink>);

impl Link {
    /// Reads a link as [`Exhibit::link`] writes it; white space within it is passed over.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn read(text: &str) -> Result<Self, Faults> {
        let refused = |found: String, remedy: &str| -> Faults {
            fault(found, "a link as K prints it in a window", remedy).into()
        };
        let text: String = text.split_whitespace().collect();
        let again = "copy it again, from its first letter to its last";
        let Some(coded) = text.strip_prefix(BEGINNING) else {
            let newer = text.starts_with(ANY_BEGINNING);
            return Err(refused(
                quote(&text),
                if newer {
                    "use the version of Recto that made it"
                } else {
                    again
                },
            ));
        };
        let damaged = || refused("a link that is damaged or cut short".to_owned(), again);
        if coded.len() > LONGEST {
            return Err(damaged());
        }
        let bytes = decode_config(coded, URL_SAFE_NO_PAD).map_err(|_| damaged())?;
        let (sum, text) = bytes.split_at_checked(4).ok_or_else(damaged)?;
        if sum != checksum(text) {
            return Err(damaged());
        }
        let text = std::str::from_utf8(text).map_err(|_| damaged())?;
        let document = Document::parse(Path::new(""), text).map_err(relabelled)?;
        let mut report = Report::new(&document);
        let link = RawLink::decode(&Node::root(&document), &mut report);
        match (link, Faults::new(report.into_faults())) {
            (Some(link), None) => Ok(Self(Arc::new(link))),
            (_, Some(faults)) => Err(relabelled(faults)),
            (None, None) => Err(damaged()),
        }
    }

    /// Adds its scene and lamps to a manifest that has no names in common with them; returns the
    /// scene's id.
    pub(super) fn join(&self, manifest: &mut RawManifest) -> Option<String> {
        let RawLink { scene, lamp } = &*self.0;
        let lamps = manifest
            .lamp
            .get_or_insert_with(|| super::validate::usual_lamps().collect());
        let mut ids = Vec::new();
        for (_, lamp) in lamp.iter().flat_map(List::iter) {
            let taken = |id: &str| lamps.iter().any(|(_, l)| l.common.id.as_str() == id);
            let id = free(LAMP, taken)?;
            ids.push(id.clone());
            let mut lamp = lamp.clone();
            lamp.common.id = id;
            lamps.push(lamp);
        }
        let drawings = &manifest.drawing;
        let scenes = manifest.scene.get_or_insert_with(|| {
            let ids = drawings.iter().map(|(_, drawing)| &drawing.id);
            ids.map(RawScene::of_drawing).collect()
        });
        let id = free(SCENE, |id| scenes.iter().any(|(_, s)| s.id.as_str() == id))?;
        scenes.push(RawScene {
            id: id.clone(),
            like: None,
            lamps: Some(ids.into_iter().collect()),
            ..scene.clone()
        });
        Some(id.as_str().to_owned())
    }

    /// The faults of a manifest that it was joined to, those in what it added as its own.
    pub(super) fn blamed(manifest: &RawManifest, mut faults: Vec<Fault>) -> Vec<Fault> {
        // What was added comes last.
        let scenes = manifest.scene.as_ref().map_or(0, List::len);
        let lamps = manifest.lamp.as_ref().map_or(0, List::len);
        let own = manifest.scene.iter().flat_map(List::iter).last();
        let count = own.and_then(|(_, scene)| Some(scene.lamps.as_ref()?.len()));
        let first_lamp = lamps - count.unwrap_or(0).min(lamps);
        let mine: Vec<String> = (first_lamp..lamps)
            .map(|lamp| format!("lamp[{lamp}]"))
            .chain([format!("scene[{}]", scenes.saturating_sub(1))])
            .collect();
        for fault in &mut faults {
            let within = mine.iter().find_map(|place| fault.path.strip_prefix(place));
            if let Some(rest) = within {
                fault.path = format!("{OPTION}{rest}");
                (fault.file, fault.place) = (None, None);
            }
        }
        faults
    }
}

impl Exhibit {
    /// `scene`, one of this exhibit or made from one, as a link.
    ///
    /// # Errors
    /// [`SaveError::Unwritable`].
    pub fn link(&self, scene: &Scene) -> Result<String, SaveError> {
        let unwritable = |why: String| SaveError::Unwritable {
            path: self.manifest.clone(),
            why,
        };
        let written = || {
            let mut ids = Vec::new();
            let mut lamps = Vec::new();
            for (n, lamp) in scene.lamps.iter().enumerate() {
                let id = Id::from_text(&format!("{LAMP}-{n}"))?;
                lamps.push(written::lamp(&id, &self.lamps[*lamp])?);
                ids.push(id);
            }
            let mut raw = written::scene(self, scene, &ids)?;
            raw.id = Id::from_text(SCENE)?;
            // Words are no part of the view, and make a link long.
            (raw.title, raw.text) = (None, None);
            let lamp = (!lamps.is_empty()).then(|| lamps.into_iter().collect());
            Some(RawLink { scene: raw, lamp })
        };
        let link =
            written().ok_or_else(|| unwritable("the view has no written form".to_owned()))?;
        let text = toml::to_string(&link).map_err(|error| unwritable(error.to_string()))?;
        let mut bytes = checksum(text.as_bytes()).to_vec();
        bytes.extend(text.as_bytes());
        Ok(format!(
            "{BEGINNING}{}",
            encode_config(bytes, URL_SAFE_NO_PAD)
        ))
    }
}

/// `stem`, or with the first number from 2 that is not taken.
fn free(stem: &str, taken: impl Fn(&str) -> bool) -> Option<Id> {
    let numbered = (2..).map(|n| format!("{stem}-{n}"));
    let mut ids = std::iter::once(stem.to_owned()).chain(numbered);
    Id::from_text(&ids.find(|id| !taken(id))?)
}

/// FNV-1a of 32 bits (draft-eastlake-fnv), little-endian: enough to notice a slip.
fn checksum(bytes: &[u8]) -> [u8; 4] {
    const OFFSET: u32 = 0x811c_9dc5;
    const PRIME: u32 = 0x0100_0193;
    let step = |hash: u32, byte: &u8| (hash ^ u32::from(*byte)).wrapping_mul(PRIME);
    bytes.iter().fold(OFFSET, step).to_le_bytes()
}

fn relabelled(faults: Faults) -> Faults {
    let mut faults: Vec<Fault> = faults.into_iter().collect();
    for fault in &mut faults {
        fault.path = format!("{OPTION}: {}", fault.path);
        (fault.file, fault.place) = (None, None);
    }
    // There was at least one.
    Faults::new(faults).unwrap_or_else(|| fault(String::new(), "", "").into())
}

fn fault(found: impl Into<String>, allowed: &str, remedy: &str) -> Fault {
    Fault {
        severity: Severity::Error,
        file: None,
        place: None,
        path: OPTION.to_owned(),
        found: found.into(),
        allowed: allowed.to_owned(),
        remedy: remedy.to_owned(),
        unreadable: false,
    }
}
