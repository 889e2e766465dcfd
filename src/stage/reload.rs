//! Hot reload: the exhibit and its maps are read again when a file of its folder is saved, or when
//! another version of it is published.
//!
//! A thread of its own watches, reads and checks, pixels included; only a sound exhibit comes
//! out, so that a faulty one never takes the place of what is on screen. Its faults go to the
//! terminal, once for each save.

use std::{
    collections::{BTreeMap, HashMap, HashSet},
    io,
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex,
        mpsc::{self, Receiver, RecvTimeoutError, Sender},
    },
    thread::{self, JoinHandle},
    time::{Duration, SystemTime},
};

use bevy::prelude::*;
use notify::{
    Event, EventKind, RecursiveMode, Watcher,
    event::{AccessKind, AccessMode},
};

use super::{Arranged, Library, StageSet, Waker, say};
use crate::{
    manifest::{
        Fault, Faults, Link,
        exhibit::{Drawing, Exhibit, MapFile, Surface},
        published,
    },
    maps::ColourEncoding,
};

/// Editors save in several steps, which follow each other faster than this.
const QUIET: Duration = Duration::from_millis(150);
/// How often a folder that was removed is looked for.
const LOOK_AGAIN: Duration = Duration::from_secs(2);

/// Reads `exhibit` again when its files change.
pub struct ReloadPlugin {
    pub exhibit: Arc<Exhibit>,
}

impl Plugin for ReloadPlugin {
    fn build(&self, app: &mut App) {
        app.add_message::<Reread>()
            .add_message::<Verdict>()
            .add_systems(Update, take_in.before(StageSet::Steer));
        follow(app.world_mut(), &self.exhibit);
    }
}

/// From now on the files of `exhibit` are watched, and those of the one before no longer.
pub fn follow(world: &mut World, exhibit: &Exhibit) {
    let waker = world.get_resource::<Waker>().cloned();
    let (news, thread) = News::of(exhibit, waker);
    if let Err(error) = thread {
        say(format_args!("recto: saves are not noticed, {error}"));
    }
    world.insert_resource(news);
}

/// The exhibit was read again and is sound.
#[derive(Message, Clone, Debug)]
pub struct Reread(pub Arc<Exhibit>);

/// Whether the files of what is shown, or is to be, are sound; their faults, in words, where not.
#[derive(Message, Clone, Debug)]
pub struct Verdict(pub Result<(), String>);

/// What the watching thread hears.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Noticed {
    Save,
    /// Another exhibit is followed.
    End,
}

/// A receiver is not Sync; only [`take_in`] takes it, and never blocks.
#[derive(Resource)]
struct News {
    receiver: Mutex<Receiver<Read>>,
    watcher: Sender<Noticed>,
}

impl News {
    /// What comes out of a thread of its own, which ends with it.
    fn of(exhibit: &Exhibit, waker: Option<Waker>) -> (Self, io::Result<JoinHandle<()>>) {
        let (sender, receiver) = mpsc::channel();
        let (saved, saves) = mpsc::channel();
        let (reader, noticed) = (Reader::new(exhibit), saved.clone());
        let thread = thread::Builder::new().name("reload".into()).spawn(move || {
            if let Err(error) = watch(reader, (noticed, &saves), &sender, waker.as_ref()) {
                // The exhibit is shown all the same.
                say(format_args!("recto: saves are not noticed, {error}"));
            }
        });
        let news = Self {
            receiver: Mutex::new(receiver),
            watcher: saved,
        };
        (news, thread)
    }
}

impl Drop for News {
    fn drop(&mut self) {
        // Its thread may have ended by itself.
        let _ = self.watcher.send(Noticed::End);
    }
}

/// What the watching thread found.
enum Read {
    Sound(Box<Sound>),
    /// What was sound before is so again.
    Mended,
    Faulty(String),
}

/// A sound exhibit, and whether any of its maps changed since the last one.
struct Sound {
    exhibit: Exhibit,
    maps_changed: bool,
}

fn take_in(
    mut news: ResMut<News>,
    mut library: ResMut<Library>,
    mut arranged: ResMut<Arranged>,
    mut reread: MessageWriter<Reread>,
    mut verdicts: MessageWriter<Verdict>,
) {
    let receiver = match news.bypass_change_detection().receiver.get_mut() {
        Ok(receiver) => receiver,
        Err(poisoned) => poisoned.into_inner(),
    };
    for read in receiver.try_iter() {
        let sound = match read {
            Read::Sound(sound) => sound,
            Read::Mended => {
                verdicts.write(Verdict(Ok(())));
                continue;
            }
            Read::Faulty(words) => {
                verdicts.write(Verdict(Err(words)));
                continue;
            }
        };
        verdicts.write(Verdict(Ok(())));
        if sound.maps_changed {
            library.clear();
        }
        arranged.reset();
        reread.write(Reread(Arc::new(sound.exhibit)));
    }
}

/// Until the program ends or nobody listens any more.
fn watch(
    mut reader: Reader,
    (saved, saves): (Sender<Noticed>, &Receiver<Noticed>),
    sender: &Sender<Read>,
    waker: Option<&Waker>,
) -> notify::Result<()> {
    let mut watcher = notify::recommended_watcher(move |event: notify::Result<Event>| {
        if event.map_or(true, |event| is_save(event.kind)) {
            // The loop below has ended: nothing is left to be told.
            let _ = saved.send(Noticed::Save);
        }
    })?;
    let mut watched = Vec::new();
    // The folder may be gone by the time that this thread begins.
    let mut all_there = rewatch(&mut watcher, &mut watched, reader.places()).is_ok();
    loop {
        // A folder that is not there says nothing when it comes back.
        let news = match all_there {
            true => saves.recv().map_err(RecvTimeoutError::from),
            false => saves.recv_timeout(LOOK_AGAIN),
        };
        if matches!(news, Ok(Noticed::End) | Err(RecvTimeoutError::Disconnected)) {
            break;
        }
        while let Ok(noticed) = saves.recv_timeout(QUIET) {
            if noticed == Noticed::End {
                return Ok(());
            }
        }
        // Before it is read, so that what is saved meanwhile is news. A folder that was replaced is
        // another one by the same name, and so is that of a new version.
        all_there = rewatch(&mut watcher, &mut watched, reader.places()).is_ok();
        let was_faulty = reader.faulty.is_some();
        let read = match reader.read() {
            Ok(None) if was_faulty && reader.faulty.is_none() => Read::Mended,
            Ok(None) => continue,
            Ok(Some((sound, warnings))) => {
                for warning in warnings {
                    say(warning);
                }
                Read::Sound(Box::new(sound))
            }
            Err(faults) => {
                say(&faults);
                Read::Faulty(faults.to_string())
            }
        };
        // What is told of a fault is heard with the next frame; a picture that stays needs none.
        let is_sound = matches!(read, Read::Sound(_));
        if sender.send(read).is_err() {
            break;
        }
        if let Some(Waker(wake)) = waker.filter(|_| is_sound) {
            wake();
        }
    }
    Ok(())
}

/// Watches these places instead of those that were `watched`.
fn rewatch(
    watcher: &mut impl Watcher,
    watched: &mut Vec<PathBuf>,
    places: Vec<(PathBuf, RecursiveMode)>,
) -> notify::Result<()> {
    for place in watched.drain(..) {
        // It may be gone, and its watch with it.
        let _ = watcher.unwatch(&place);
    }
    let mut result = Ok(());
    for (place, mode) in places {
        match watcher.watch(&place, mode) {
            Ok(()) => watched.push(place),
            error => result = error,
        }
    }
    result
}

/// Reading the exhibit is no save, though the system reports that too.
fn is_save(kind: EventKind) -> bool {
    match kind {
        EventKind::Access(access) => access == AccessKind::Close(AccessMode::Write),
        EventKind::Create(_) | EventKind::Modify(_) | EventKind::Remove(_) => true,
        EventKind::Any | EventKind::Other => true,
    }
}

/// When a file was last changed, and its length; `None` while it is not there.
type Stamp = Option<(SystemTime, u64)>;

fn stamp(path: &Path) -> Stamp {
    let data = std::fs::metadata(path).ok()?;
    Some((data.modified().ok()?, data.len()))
}

type Stamps = BTreeMap<PathBuf, Stamp>;

/// Every file behind an exhibit.
fn stamps(exhibit: &Exhibit) -> Stamps {
    let surfaces = exhibit
        .drawings
        .iter()
        .filter_map(|drawing| match &drawing.surface {
            Surface::Gltf(path) => Some(path),
            Surface::Flat | Surface::Height(_) => None,
        });
    exhibit
        .maps()
        .map(|map| &map.path)
        .chain(surfaces)
        .chain([&exhibit.manifest])
        .map(|path| (path.clone(), stamp(path)))
        .collect()
}

/// A version of a map, and how its colours are read; what passed once need not be looked at
/// again.
#[derive(PartialEq)]
struct Check {
    stamp: Stamp,
    encodings: HashSet<ColourEncoding>,
}

/// How the colours of the picture at `path` are encoded, wherever it is one of colours.
fn encodings(exhibit: &Exhibit, path: &Path) -> HashSet<ColourEncoding> {
    let colours = exhibit.drawings.iter().flat_map(Drawing::colour_maps);
    colours
        .filter(|(file, _)| file.path == path)
        .map(|(_, encoding)| encoding)
        .collect()
}

/// Reads one exhibit again and again.
struct Reader {
    /// The manifest, or the folder of published versions.
    asked: PathBuf,
    /// Whether it is the latter.
    published: bool,
    /// Of the version that was read first.
    folder: PathBuf,
    /// Adds a scene each time.
    link: Option<Link>,
    /// The files of the last sound version, or of the first one.
    sound: Stamps,
    /// Maps whose pixels are sound. Of the first version, only what was shown was ever decoded.
    verified: HashMap<PathBuf, Check>,
    /// Of those maps, to be told with the next sound version.
    warnings: Vec<Fault>,
    /// The last faulty version, which is not told twice.
    faulty: Option<(Stamps, String)>,
}

impl Reader {
    fn new(exhibit: &Exhibit) -> Self {
        Self {
            asked: exhibit
                .published
                .as_ref()
                .unwrap_or(&exhibit.manifest)
                .clone(),
            published: exhibit.published.is_some(),
            folder: exhibit.folder.clone(),
            link: exhibit.link.clone(),
            sound: stamps(exhibit),
            verified: HashMap::new(),
            warnings: Vec::new(),
            faulty: None,
        }
    }

    /// What to watch: the exhibit's folder, and where it is a published one, the pointer to it.
    fn places(&self) -> Vec<(PathBuf, RecursiveMode)> {
        if !self.published {
            return vec![(self.folder.clone(), RecursiveMode::Recursive)];
        }
        let version = published::current(&self.asked);
        [(self.asked.clone(), RecursiveMode::NonRecursive)]
            .into_iter()
            .chain(version.map(|version| (version, RecursiveMode::Recursive)))
            .collect()
    }

    /// A version that is new and sound with its warnings, or `None` if nothing is new.
    fn read(&mut self) -> Result<Option<(Sound, Vec<Fault>)>, Faults> {
        let read = Exhibit::read_with(&self.asked, self.link.as_ref());
        let (exhibit, mut warnings) = match read {
            Ok(read) => read,
            Err(faults) => {
                let stamps = Stamps::from([(self.asked.clone(), stamp(&self.asked))]);
                return self.told(stamps, faults);
            }
        };
        let stamps = stamps(&exhibit);
        if stamps == self.sound {
            // A fault that was undone is news if it comes back.
            self.faulty = None;
            return Ok(None);
        }
        if let Some(faults) = self.verify(&exhibit, &stamps) {
            return self.told(stamps, faults);
        }
        let maps_changed = stamps
            .iter()
            .any(|(path, stamp)| *path != exhibit.manifest && self.sound.get(path) != Some(stamp));
        self.sound = stamps;
        self.faulty = None;
        warnings.append(&mut self.warnings);
        Ok(Some((
            Sound {
                exhibit,
                maps_changed,
            },
            warnings,
        )))
    }

    /// The faults in the pixels of `exhibit`, apart from maps that have passed already.
    fn verify(&mut self, exhibit: &Exhibit, stamps: &Stamps) -> Option<Faults> {
        let maps: BTreeMap<&Path, &MapFile> = exhibit
            .maps()
            .map(|map| (map.path.as_path(), map))
            .collect();
        let mut faults = Vec::new();
        for (path, map) in maps {
            let check = Check {
                stamp: stamps.get(path).copied().flatten(),
                encodings: encodings(exhibit, path),
            };
            if self.verified.get(path) == Some(&check) {
                continue;
            }
            match exhibit.verify([map]) {
                Ok(warnings) => {
                    self.verified.insert(path.into(), check);
                    self.warnings.extend(warnings);
                }
                Err(found) => faults.extend(found),
            }
        }
        Faults::new(faults)
    }

    fn told<T>(&mut self, stamps: Stamps, faults: Faults) -> Result<Option<T>, Faults> {
        let version = Some((stamps, faults.to_string()));
        if self.faulty == version {
            return Ok(None);
        }
        self.faulty = version;
        Err(faults)
    }
}

#[cfg(test)]
mod tests;
