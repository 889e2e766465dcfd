//! Hot reload: the exhibit and its maps are read again when a file of its folder is saved.
//!
//! A thread of its own watches, reads and checks, pixels included; only a sound exhibit comes
//! out, so that a faulty one never takes the place of what is on screen. Its faults go to the
//! terminal, once for each save.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex,
        mpsc::{self, Receiver, Sender},
    },
    thread,
    time::{Duration, SystemTime},
};

use bevy::prelude::*;
use notify::{
    Event, EventKind, RecursiveMode, Watcher,
    event::{AccessKind, AccessMode},
};

use super::{Arranged, Library, StageSet, Waker, say};
use crate::manifest::{
    Fault, Faults,
    exhibit::{Exhibit, MapFile, Surface},
};

/// Editors save in several steps, which follow each other faster than this.
const QUIET: Duration = Duration::from_millis(150);

/// Reads `exhibit` again when its files change.
pub struct ReloadPlugin {
    pub exhibit: Arc<Exhibit>,
}

impl Plugin for ReloadPlugin {
    fn build(&self, app: &mut App) {
        let (sender, receiver) = mpsc::channel();
        let waker = app.world().get_resource::<Waker>().cloned();
        let reader = Reader::new(&self.exhibit);
        let folder = self.exhibit.folder.clone();
        let watcher = thread::Builder::new().name("reload".into());
        let watching = watcher.spawn(move || {
            if let Err(error) = watch(&folder, reader, &sender, waker.as_ref()) {
                // The exhibit is shown all the same.
                say(format_args!("recto: saves are not noticed, {error}"));
            }
        });
        if let Err(error) = watching {
            say(format_args!("recto: saves are not noticed, {error}"));
        }
        app.insert_resource(News(Mutex::new(receiver)))
            .add_message::<Reread>()
            .add_systems(Update, take_in.before(StageSet::Steer));
    }
}

/// The exhibit was read again and is sound.
#[derive(Message, Clone, Debug)]
pub struct Reread(pub Arc<Exhibit>);

/// A receiver is not Sync; only [`take_in`] takes it, and never blocks.
#[derive(Resource)]
struct News(Mutex<Receiver<Sound>>);

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
) {
    let receiver = match news.bypass_change_detection().0.get_mut() {
        Ok(receiver) => receiver,
        Err(poisoned) => poisoned.into_inner(),
    };
    for sound in receiver.try_iter() {
        if sound.maps_changed {
            library.clear();
        }
        arranged.reset();
        reread.write(Reread(Arc::new(sound.exhibit)));
    }
}

/// Until the program ends or nobody listens any more.
fn watch(
    folder: &Path,
    mut reader: Reader,
    sender: &Sender<Sound>,
    waker: Option<&Waker>,
) -> notify::Result<()> {
    let (saved, saves) = mpsc::channel();
    let mut watcher = notify::recommended_watcher(move |event: notify::Result<Event>| {
        if event.map_or(true, |event| is_save(event.kind)) {
            // The loop below has ended: nothing is left to be told.
            let _ = saved.send(());
        }
    })?;
    watcher.watch(folder, RecursiveMode::Recursive)?;
    while saves.recv().is_ok() {
        while saves.recv_timeout(QUIET).is_ok() {}
        match reader.read() {
            Ok(None) => {}
            Ok(Some((sound, warnings))) => {
                for warning in warnings {
                    say(warning);
                }
                if sender.send(sound).is_err() {
                    break;
                }
                if let Some(Waker(wake)) = waker {
                    wake();
                }
            }
            Err(faults) => say(faults),
        }
    }
    Ok(())
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

/// Reads one exhibit again and again.
struct Reader {
    manifest: PathBuf,
    /// The files of the last sound version.
    sound: Stamps,
    /// The last faulty version, which is not told twice.
    faulty: Option<(Stamps, String)>,
}

impl Reader {
    fn new(exhibit: &Exhibit) -> Self {
        Self {
            manifest: exhibit.manifest.clone(),
            sound: stamps(exhibit),
            faulty: None,
        }
    }

    /// A version that is new and sound with its warnings, or `None` if nothing is new.
    fn read(&mut self) -> Result<Option<(Sound, Vec<Fault>)>, Faults> {
        let (exhibit, warnings) = match Exhibit::read(&self.manifest) {
            Ok(read) => read,
            Err(faults) => {
                let stamps = Stamps::from([(self.manifest.clone(), stamp(&self.manifest))]);
                return self.told(stamps, faults);
            }
        };
        let stamps = stamps(&exhibit);
        if stamps == self.sound {
            return Ok(None);
        }
        let changed = |map: &&MapFile| stamps.get(&map.path) != self.sound.get(&map.path);
        if let Err(faults) = exhibit.verify(exhibit.maps().filter(changed)) {
            return self.told(stamps, faults);
        }
        let maps_changed = stamps
            .iter()
            .any(|(path, stamp)| *path != self.manifest && self.sound.get(path) != Some(stamp));
        self.sound = stamps;
        self.faulty = None;
        Ok(Some((
            Sound {
                exhibit,
                maps_changed,
            },
            warnings,
        )))
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
mod tests {
    use super::*;

    /// Another version of `path`, which a coarse clock cannot take for the one before.
    fn save(path: &Path, text: &str) {
        std::fs::write(path, text).expect("the file is written");
    }

    #[test]
    fn only_what_is_new_and_sound_comes_out_and_faults_are_told_once() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let manifest = folder.path().join("exhibit.toml");
        let picture = folder.path().join("recto.png");
        let draw = |level: u8, side: u32| {
            let pixels = vec![[level; 3]; (side * side) as usize];
            crate::maps::encode::save_png_rgb8(&picture, side, side, &pixels, None)
                .expect("the picture is written");
        };
        let sound = "[exhibit]\ntitle = \"One\"\n[[drawing]]\nid = \"sheet\"\n\
                     size_mm = [20.0, 20.0]\nrecto.albedo = \"recto.png\"\n";
        draw(200, 8);
        save(&manifest, sound);
        let (exhibit, _) = Exhibit::read(folder.path()).expect("it is sound");
        let mut reader = Reader::new(&exhibit);
        assert!(reader.read().expect("it is sound").is_none());

        save(&manifest, &sound.replace("One", "Another"));
        let (read, _) = reader.read().expect("it is sound").expect("it is new");
        assert!(!read.maps_changed);

        save(&manifest, &sound.replace("size_mm", "size_nm"));
        assert!(reader.read().is_err());
        assert!(reader.read().expect("it is told already").is_none());

        save(&manifest, sound);
        draw(100, 9);
        let (read, _) = reader.read().expect("it is sound").expect("it is new");
        assert!(read.maps_changed);

        let bytes = std::fs::read(&picture).expect("a picture");
        std::fs::write(&picture, &bytes[..bytes.len() / 2]).expect("the file is written");
        assert!(reader.read().is_err(), "half a picture is a fault");
        std::fs::write(&picture, &bytes).expect("the file is written");
        let (read, _) = reader.read().expect("it is sound").expect("it is new");
        assert!(read.maps_changed);
    }
}
