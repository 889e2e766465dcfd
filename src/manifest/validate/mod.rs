//! From what was written to what can be relied on: [`RawManifest`] → [`Exhibit`], gathering
//! every fault.

mod drawing;
mod files;
mod hotspot;
mod lamp;
mod medium;
mod names;
mod placement;
mod scene;
mod side;
mod stack;
mod wording;

use std::path::{Path, PathBuf};

use super::{
    decode::Report,
    document::{Fingerprint, Trail},
    exhibit::{Accuracy, Exhibit, Registered, ResolvedMedium},
    raw::RawManifest,
};
use names::Names;
pub(crate) use wording::normalised;

pub(crate) use files::{PICTURE, map_words};
pub(super) use lamp::{DAYLIGHT_K, usual_lamps};

/// What all parts of the validation share.
struct Validator<'r, 'd> {
    report: &'r mut Report<'d>,
    /// As the caller named it.
    folder: PathBuf,
    /// The same folder with every link followed.
    real_folder: PathBuf,
    languages: Vec<String>,
    /// Whether the manifest lists its languages itself.
    languages_declared: bool,
    /// What media maps and papers can name, in the order of [`Exhibit::media`].
    media: Vec<ResolvedMedium>,
    /// Whether media are missing there because they are at fault.
    media_incomplete: bool,
    registered: Vec<Registered>,
    not_shown_yet: Vec<String>,
}

/// Validates a manifest of `folder`. `None` only if there are faults in `report`.
pub(super) fn exhibit(
    raw: &RawManifest,
    manifest: &Path,
    folder: &Path,
    report: &mut Report<'_>,
) -> Option<Exhibit> {
    Validator::new(folder, report).exhibit(raw, manifest)
}

impl<'r, 'd> Validator<'r, 'd> {
    fn new(folder: &Path, report: &'r mut Report<'d>) -> Self {
        Self {
            report,
            folder: folder.to_owned(),
            // Where even this fails, each file of the manifest will be reported as absent.
            real_folder: folder.canonicalize().unwrap_or_else(|_| folder.to_owned()),
            languages: Vec::new(),
            languages_declared: false,
            media: Vec::new(),
            media_incomplete: false,
            registered: Vec::new(),
            not_shown_yet: Vec::new(),
        }
    }
}

impl Validator<'_, '_> {
    fn exhibit(&mut self, raw: &RawManifest, manifest: &Path) -> Option<Exhibit> {
        let root = Trail::default();
        let about = raw.exhibit.as_ref();
        let about_trail = root.key("exhibit");
        self.languages(about, &about_trail);
        let title = self.wording(
            about.and_then(|about| about.title.as_ref()),
            &about_trail.key("title"),
        );

        let lamp_names = match &raw.lamp {
            Some(lamps) => {
                let ids = lamps.iter().map(|(i, lamp)| (i, &lamp.common.id));
                Names::new("lamp", ids, lamps.has_holes())
            }
            None => Names::of_one("lamp", lamp::DEFAULT_ID),
        };
        self.unique(&lamp_names, &root.key("lamp"));
        let lamps = self.lamps(raw, &root.key("lamp"));

        self.media(raw, &root.key("medium"));

        let drawings_trail = root.key("drawing");
        let ids = raw.drawing.iter().map(|(i, drawing)| (i, &drawing.id));
        let drawing_names = Names::new("drawing", ids, raw.drawing.has_holes());
        self.unique(&drawing_names, &drawings_trail);
        let scene_names = match &raw.scene {
            Some(scenes) => {
                let ids = scenes.iter().map(|(i, scene)| (i, &scene.id));
                Names::new("scene", ids, scenes.has_holes())
            }
            // Without scenes each drawing is one, by the same id.
            None => drawing_names.clone().called("scene"),
        };
        if raw.scene.is_some() {
            self.unique(&scene_names, &root.key("scene"));
        }

        let drawings: Vec<_> = raw
            .drawing
            .iter()
            .map(|(i, raw)| self.drawing(raw, &drawings_trail.index(i), &scene_names))
            .collect();
        let scenes = self.scenes(raw, &root, &drawing_names, &lamp_names, &scene_names);
        let tours = self.tours(raw, &root.key("tour"), &scene_names);
        let accuracy = raw.accuracy.as_ref();
        let exhibit = Exhibit {
            folder: self.folder.clone(),
            manifest: manifest.to_owned(),
            title,
            languages: self.languages.clone(),
            drawings: drawings.into_iter().collect::<Option<_>>()?,
            lamps: lamps?,
            media: std::mem::take(&mut self.media),
            scenes: scenes?,
            tours: tours?,
            accuracy: Accuracy {
                max_delta_e: accuracy.and_then(|a| a.max_delta_e).map_or(1.0, |e| e.0),
                frame_ms: accuracy.and_then(|a| a.frame_ms).map_or(16.0, |ms| ms.0),
            },
            registered: std::mem::take(&mut self.registered),
            fingerprint: Fingerprint::default(),
            link: None,
            published: None,
            not_shown_yet: std::mem::take(&mut self.not_shown_yet),
        };
        self.near_lamps(&exhibit, &root.key("lamp"));
        Some(exhibit)
    }

    fn not_shown_yet(&mut self, sentence: String) {
        self.not_shown_yet.push(sentence);
    }
}
