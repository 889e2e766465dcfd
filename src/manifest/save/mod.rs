//! A view saved as a scene: into the manifest's own text, of which nothing else changes.
//!
//! | step | where |
//! |---|---|
//! | scene and lamps → what a manifest writes | `written` |
//! | that → the text, at its place | `text` |
//! | the text → the file, whole or not at all | `file` |

mod file;
mod text;
pub(super) mod written;

use std::{
    io,
    path::{Path, PathBuf},
};

use super::{
    Exhibit, Faults, Lamp, Pattern, Scene, document,
    document::Fingerprint,
    raw::{RawLamp, RawScene, values::Id},
};
use text::Source;

/// Lamps that a saved scene brings along are named after it.
const LAMP: &str = "lamp";
/// The longest id.
const LONGEST_ID: usize = 64;

/// Why a scene was not saved. Nothing is changed then.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// What it is to be called.
    #[error(
        "not saved: found {0:?}; allowed: {allowed}; {remedy}",
        allowed = Id::ALLOWED,
        remedy = Id::REMEDY
    )]
    Id(String),
    /// Somebody else wrote the file.
    #[error(
        "{}: not saved: it has changed since it was read; once the change is shown, save again",
        .0.display()
    )]
    Changed(PathBuf),
    /// Nobody may write the file.
    #[error(
        "{}: not saved: the file is read-only; make it writable, or copy the exhibit",
        .0.display()
    )]
    ReadOnly(PathBuf),
    /// The file cannot be written for another reason.
    #[error("{}: not saved: it cannot be written: {source}", path.display())]
    Write { path: PathBuf, source: io::Error },
    /// Nothing can be added to these scenes or lamps without changing what stands around.
    #[error(
        "{}: not saved: {found}; write each below its own [[{list}]], its tables right behind it",
        path.display()
    )]
    Form {
        path: PathBuf,
        list: &'static str,
        found: &'static str,
    },
    /// The manifest, as it is or as it would be, is at fault.
    #[error("not saved, for what is at fault:\n{0}")]
    Faults(#[from] Faults),
    /// A program's fault.
    #[error("{}: not saved: {why}; please report this with the manifest", path.display())]
    Unwritable { path: PathBuf, why: String },
}

/// What a scene is to be called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SaveAs<'n> {
    /// By this id; a scene that has it already is replaced.
    Id(&'n str),
    /// By these letters and the first number from 1 that is free: `view-1`.
    Next(&'n str),
}

/// A manifest with a scene in it that is not saved yet, found sound.
#[derive(Clone, Debug)]
pub struct Draft {
    /// The file itself, every link followed.
    path: PathBuf,
    old: String,
    new: String,
    /// Of the scene.
    id: String,
}

impl Exhibit {
    /// Puts `scene`, one of this exhibit or made from one, into the manifest's text. Its title and
    /// text are those of `scene`, or else of the scene that it replaces. A lamp that the manifest
    /// does not have, such as one that a hand moved, becomes a new one. `known` are texts of the
    /// manifest besides the one that this exhibit was read from that may be built upon.
    ///
    /// # Errors
    /// [`SaveError`]; nothing is written by this in any case.
    pub fn draft(
        &self,
        scene: &Scene,
        name: SaveAs<'_>,
        known: &[Fingerprint],
    ) -> Result<Draft, SaveError> {
        if let SaveAs::Id(id) | SaveAs::Next(id) = name
            && Id::from_text(id).is_none()
        {
            return Err(SaveError::Id(id.to_owned()));
        }
        let path = file::writable(&self.manifest)?;
        let old = document::read_text(&path)?;
        let fingerprint = Fingerprint::of(&old);
        if fingerprint != self.fingerprint && !known.contains(&fingerprint) {
            return Err(SaveError::Changed(self.manifest.clone()));
        }
        // With what was saved since, and without what only the command line added.
        let (there, _) = Self::parse(&self.manifest, &self.folder, &old)?;
        let id = match name {
            SaveAs::Id(id) => id.to_owned(),
            SaveAs::Next(stem) => free(stem, 1, |id| there.scene(id).is_some()),
        };
        let replaced = there.scene(&id).map(|(_, scene)| scene);
        let mut scene = Scene {
            id: id.clone(),
            ..scene.clone()
        };
        // Of overlays that are off, nobody sees which categories were.
        let is_on = |index: &usize| scene.overlays.iter().any(|(on, _)| on == index);
        let off: Vec<usize> = scene
            .categories
            .keys()
            .filter(|i| !is_on(i))
            .copied()
            .collect();
        for index in off {
            scene.categories.remove(&index);
        }
        if let Some(comparison) = &mut scene.compare {
            // Whose turn it is passes, and a difference in numbers is a file's.
            (comparison.turn, comparison.coded) = (0, true);
        }
        if let Some(replaced) = replaced {
            if scene.title.0.is_empty() {
                scene.title = replaced.title.clone();
            }
            if scene.text.0.is_empty() {
                scene.text = replaced.text.clone();
            }
        }
        let unwritable = |why: &str| SaveError::Unwritable {
            path: self.manifest.clone(),
            why: why.to_owned(),
        };
        let lamps = self
            .lamps_for(&scene, &there)
            .ok_or_else(|| unwritable("a lamp of the view cannot be written"))?;
        let raw = written::scene(self, &scene, &lamps.ids)
            .ok_or_else(|| unwritable("the view cannot be written"))?;
        let new = there.edited(&old, &raw, &lamps.new, replaced)?;
        let (read, _) = Self::parse(&self.manifest, &self.folder, &new)?;
        if !read.has(&scene, self) {
            return Err(unwritable("it would not be the same view"));
        }
        // Scenes that are like the one that is replaced would change with it.
        let others = there.scenes.iter().filter(|other| other.id != id);
        if let Some(other) = others.into_iter().find(|other| !read.has(other, &there)) {
            return Err(unwritable(&format!(
                "the scene \"{}\", which is like it, would change; save under another id",
                other.id
            )));
        }
        Ok(Draft { path, old, new, id })
    }

    /// The manifest's text with a scene and lamps in it; `self` is what `old` says.
    fn edited(
        &self,
        old: &str,
        scene: &RawScene,
        lamps: &[RawLamp],
        replaced: Option<&Scene>,
    ) -> Result<String, SaveError> {
        let form = |(list, found): (&'static str, &'static str)| SaveError::Form {
            path: self.manifest.clone(),
            list,
            found,
        };
        let unwritable = |why: String| SaveError::Unwritable {
            path: self.manifest.clone(),
            why,
        };
        let block = |raw: &RawScene| written::scene_table(raw).map_err(unwritable);
        let source = Source::read(old).map_err(unwritable)?;
        let mut new_lamps = Vec::new();
        if !lamps.is_empty() && source.tables("lamp").map_err(form)?.is_empty() {
            // With the first lamp of its own a manifest loses the one that it had without any.
            let usual: Option<Vec<RawLamp>> = self.lamps.iter().map(written::same_lamp).collect();
            new_lamps.extend(usual.unwrap_or_default());
        }
        new_lamps.extend(lamps.iter().cloned());
        let mut new_scenes = Vec::new();
        let scenes = source.tables("scene").map_err(form)?;
        let there = scenes.position(scene.id.as_str());
        if scenes.is_empty() {
            // And the scenes that it had without any.
            let usual = self.scenes.iter().filter(|s| s.id != scene.id.as_str());
            for usual in usual {
                let drawing = Id::from_text(&usual.id);
                let drawing = drawing.ok_or_else(|| unwritable("a drawing's id".to_owned()))?;
                new_scenes.push(block(&RawScene::of_drawing(&drawing))?);
            }
        }
        let table = block(scene)?;
        let mut edits = Vec::new();
        let lamp_tables = source.tables("lamp").map_err(form)?;
        let new_lamps: Result<Vec<_>, _> = new_lamps.iter().map(written::lamp_table).collect();
        edits.extend(lamp_tables.appended(&new_lamps.map_err(unwritable)?));
        match there {
            Some(at) => {
                let kept = replaced.map_or_else(Vec::new, |replaced| {
                    written::same_words(replaced, self, scene)
                });
                edits.push(scenes.replaced(at, &table, &kept).map_err(form)?);
            }
            None => {
                new_scenes.push(table);
                edits.extend(scenes.appended(&new_scenes));
            }
        }
        Ok(source.with(edits))
    }

    /// Lamps for a scene in the manifest that `there` was read from: those that it has, by their
    /// ids, and new ones.
    fn lamps_for(&self, scene: &Scene, there: &Self) -> Option<LampsFor> {
        let mut ids = Vec::new();
        let mut new: Vec<(RawLamp, &Lamp)> = Vec::new();
        let same = |a: &Lamp, b: &Lamp| a.kind == b.kind && a.colour == b.colour;
        for index in &scene.lamps {
            let lamp = &self.lamps[*index];
            let by_id = there
                .lamps
                .iter()
                .find(|l| l.id == lamp.id && same(l, lamp));
            let any = || there.lamps.iter().find(|l| same(l, lamp));
            let id = match by_id.or_else(any) {
                Some(lamp) => Id::from_text(&lamp.id)?,
                None => match new.iter().find(|(_, l)| same(l, lamp)) {
                    Some((raw, _)) => raw.common.id.clone(),
                    None => {
                        let room = LONGEST_ID - LAMP.len() - 5;
                        let stem: String = scene.id.chars().take(room).collect();
                        let stem = format!("{stem}-{LAMP}");
                        let taken = |id: &str| {
                            there.lamps.iter().any(|l| l.id == id)
                                || new.iter().any(|(raw, _)| raw.common.id.as_str() == id)
                        };
                        let id = match taken(&stem) {
                            false => stem,
                            true => free(&stem, 2, taken),
                        };
                        let raw = written::lamp(&Id::from_text(&id)?, lamp)?;
                        let id = raw.common.id.clone();
                        new.push((raw, lamp));
                        id
                    }
                },
            };
            ids.push(id);
        }
        let new = new.into_iter().map(|(raw, _)| raw).collect();
        Some(LampsFor { ids, new })
    }

    /// A scene as a manifest has it, its lamps by their ids. `None` where something in it has no
    /// written form.
    pub fn written_scene(&self, scene: &Scene) -> Option<RawScene> {
        let lamps = scene.lamps.iter();
        let ids: Option<Vec<Id>> = lamps
            .map(|lamp| Id::from_text(&self.lamps[*lamp].id))
            .collect();
        written::scene(self, scene, &ids?)
    }

    /// The lamps of a scene as a manifest has them. `None` as above.
    pub fn written_lamps(&self, scene: &Scene) -> Option<Vec<RawLamp>> {
        let lamps = scene.lamps.iter();
        lamps
            .map(|lamp| written::same_lamp(&self.lamps[*lamp]))
            .collect()
    }

    /// Whether this exhibit has a scene that is the same as `scene` of `other`, in the same light.
    pub fn has(&self, scene: &Scene, other: &Self) -> bool {
        let Some((_, mine)) = self.scene(&scene.id) else {
            return false;
        };
        let lamps = |exhibit: &Self, scene: &Scene| -> Vec<_> {
            let lamps = scene.lamps.iter().map(|lamp| &exhibit.lamps[*lamp]);
            lamps.map(|lamp| (lamp.colour, lamp.kind.clone())).collect()
        };
        let same_light = lamps(self, mine) == lamps(other, scene);
        let lamps = scene.lamps.clone();
        same_light
            && Scene {
                lamps,
                ..mine.as_shown()
            } == scene.as_shown()
    }
}

/// The lamps of a scene in their order.
struct LampsFor {
    ids: Vec<Id>,
    new: Vec<RawLamp>,
}

impl Draft {
    /// The id of the scene.
    pub fn id(&self) -> &str {
        &self.id
    }

    /// The whole text of the manifest to be.
    pub fn text(&self) -> &str {
        &self.new
    }

    /// Replaces the manifest's file, and returns what tells its new text from others.
    ///
    /// # Errors
    /// [`SaveError::Changed`] where it is no longer what the draft was made from, or
    /// [`SaveError::Write`]; the file is left as it was.
    pub fn write(&self) -> Result<Fingerprint, SaveError> {
        file::replace(&self.path, &self.old, &self.new)?;
        Ok(Fingerprint::of(&self.new))
    }

    /// The manifest's file.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// `stem-N` with the first N from `first` that is not taken.
fn free(stem: &str, first: usize, taken: impl Fn(&str) -> bool) -> String {
    let ids = (first..).map(|n| format!("{stem}-{n}"));
    // There are more numbers than ids.
    ids.into_iter().find(|id| !taken(id)).unwrap_or_default()
}
