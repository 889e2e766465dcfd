//! The folder that a command writes to first: within the one that is asked for, so that what is
//! done takes its place by a change of names, and nothing half done is ever seen there.
//!
//! What an interrupted command left behind is taken away by the next one, whichever it is. That no
//! other is at work is told by a lock, which the system lifts from a process that ends in whatever
//! way.

use std::{
    fs::{self, File, TryLockError},
    io,
    path::{Component, Path, PathBuf},
};

use crate::maps::room;

/// What names of staging folders begin with.
const PREFIX: &str = ".recto-staging-";
/// The file that is locked while work goes on.
const LOCK: &str = ".recto.lock";
/// In a staging folder, from when on what is in it takes its place: the names of all of it, one a
/// line, in the order that they are moved in.
const PUBLISHING: &str = ".publishing";

/// Why a folder cannot be filled.
#[derive(Debug, thiserror::Error)]
pub enum StagingError {
    /// Something has a name of what is to be made.
    #[error("{}: is there already; choose another folder or remove it", .0.display())]
    Exists(PathBuf),
    #[error("{}: another command of Recto's is at work in this folder; wait for it, or choose another one", .0.display())]
    Busy(PathBuf),
    #[error("{}: {reason}{}", path.display(), room(reason))]
    Folder { path: PathBuf, reason: io::Error },
}

/// A folder that work is staged in; it is removed with this value.
pub struct Staging {
    folder: tempfile::TempDir,
    out: PathBuf,
    names: &'static [&'static str],
    /// How many interrupted commands left something behind, which is gone now.
    pub interrupted: usize,
    // Fields are dropped in their order: the lock goes last.
    _lock: Lock,
}

fn refused(path: &Path) -> impl Fn(io::Error) -> StagingError + use<> {
    let path = path.to_owned();
    move |reason| StagingError::Folder {
        path: path.clone(),
        reason,
    }
}

/// Whether nothing has this name, not even a link that leads nowhere.
fn free(path: PathBuf) -> Result<PathBuf, StagingError> {
    match fs::symlink_metadata(&path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(path),
        Err(error) => Err(refused(&path)(error)),
        Ok(_) => Err(StagingError::Exists(path)),
    }
}

impl Staging {
    /// Begins work in the folder `out`, which is there, and removes what interrupted work left.
    /// `names` is what may be made, the last of them what makes the rest an exhibit or a capture:
    /// whoever opens the folder while they take their places sees none, or the whole.
    ///
    /// # Errors
    /// [`StagingError::Busy`] where another command is at work there, [`StagingError::Exists`]
    /// where something has one of these names, and [`StagingError::Folder`].
    pub fn new(out: &Path, names: &'static [&'static str]) -> Result<Self, StagingError> {
        let lock = Lock::of(out)?;
        let interrupted = removed(out)?;
        // What makes a folder an exhibit is named last, and told of first.
        for name in names.iter().rev() {
            free(out.join(name))?;
        }
        let folder = tempfile::Builder::new()
            .prefix(PREFIX)
            .tempdir_in(out)
            .map_err(refused(out))?;
        Ok(Self {
            folder,
            out: out.to_owned(),
            names,
            interrupted,
            _lock: lock,
        })
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Moves what was staged to its place; names that were not made are passed over, and whatever
    /// else is staged goes with this value.
    ///
    /// # Errors
    /// [`StagingError::Exists`] where one of the names appeared meanwhile, and
    /// [`StagingError::Folder`]; then nothing of it is there.
    pub fn publish(self) -> Result<(), StagingError> {
        let made = self.names.iter().copied();
        let made: Vec<&str> = made
            .filter(|name| self.path().join(name).exists())
            .collect();
        let mark = self.path().join(PUBLISHING);
        fs::write(&mark, made.join("\n")).map_err(refused(&mark))?;
        for (i, name) in made.iter().enumerate() {
            // A change of names would take the place of a file without a word.
            let moved = free(self.out.join(name))
                .and_then(|to| fs::rename(self.path().join(name), &to).map_err(refused(&to)));
            if let Err(error) = moved {
                for name in &made[..i] {
                    // Back, to go with the rest.
                    let _ = fs::rename(self.out.join(name), self.path().join(name));
                }
                return Err(error);
            }
        }
        Ok(())
    }
}

/// A locked file, removed in the end.
struct Lock {
    path: PathBuf,
    file: File,
}

impl Lock {
    fn of(out: &Path) -> Result<Self, StagingError> {
        /// Nobody finds so many others just ending.
        const TRIES: usize = 100;
        let path = out.join(LOCK);
        for _ in 0..TRIES {
            let file = File::create(&path).map_err(refused(&path))?;
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => break,
                // Whoever held it removed it after it was opened here: a third may hold a new one.
                Ok(()) if !is_named(&file, &path) => {}
                // Some network folders know no locks.
                Ok(()) | Err(TryLockError::Error(_)) => return Ok(Self { path, file }),
            }
        }
        Err(StagingError::Busy(out.to_owned()))
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // While it is held: whoever opened it before will see that it has no name any more. Where
        // that cannot be seen it stays, and does no harm.
        if cfg!(unix) && is_named(&self.file, &self.path) {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Whether it is this open file that has this name.
#[cfg(unix)]
fn is_named(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let own = file.metadata().ok();
    let named = fs::symlink_metadata(path).ok();
    own.zip(named)
        .is_some_and(|(own, named)| (own.dev(), own.ino()) == (named.dev(), named.ino()))
}

#[cfg(not(unix))]
fn is_named(_: &File, _: &Path) -> bool {
    true
}

/// Removes what interrupted commands left in a folder, and says of how many. Nobody else is at
/// work.
fn removed(out: &Path) -> Result<usize, StagingError> {
    let mut count = 0;
    for entry in fs::read_dir(out).map_err(refused(out))? {
        let entry = entry.map_err(refused(out))?;
        let path = entry.path();
        let is_ours = entry.file_name().to_string_lossy().starts_with(PREFIX)
            && entry.file_type().is_ok_and(|kind| kind.is_dir());
        if !is_ours {
            continue;
        }
        for name in placed(&path) {
            let place = out.join(name);
            let gone = match place.is_dir() {
                true => fs::remove_dir_all(&place),
                false => fs::remove_file(&place),
            };
            match gone {
                Err(error) if error.kind() != io::ErrorKind::NotFound => {
                    return Err(refused(&place)(error));
                }
                _ => {}
            }
        }
        fs::remove_dir_all(&path).map_err(refused(&path))?;
        count += 1;
    }
    Ok(count)
}

/// What a command that broke off between the first change of names and the last has put in place.
fn placed(staging: &Path) -> Vec<String> {
    let Ok(mark) = fs::read_to_string(staging.join(PUBLISHING)) else {
        return Vec::new();
    };
    let is_name = |name: &&str| {
        let mut parts = Path::new(*name).components();
        matches!(
            (parts.next(), parts.next()),
            (Some(Component::Normal(_)), None)
        )
    };
    let names: Vec<&str> = mark.lines().filter(is_name).collect();
    let is_here = |name: &&str| staging.join(name).exists();
    match names.last() {
        Some(last) if is_here(last) => {
            let gone = names.iter().filter(|name| !is_here(name));
            gone.map(|name| (*name).to_owned()).collect()
        }
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use std::{
        sync::atomic::{AtomicBool, AtomicUsize, Ordering},
        thread,
    };

    use super::*;

    const NAMES: &[&str] = &["maps", "report.html", "exhibit.toml"];

    fn filled(out: &Path) -> Staging {
        let staging = Staging::new(out, NAMES).unwrap();
        fs::create_dir(staging.path().join("maps")).unwrap();
        fs::write(staging.path().join("maps/a.png"), "a").unwrap();
        fs::write(staging.path().join("exhibit.toml"), "new").unwrap();
        staging
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn what_appeared_meanwhile_is_not_replaced() {
        let root = tempfile::tempdir().unwrap();
        let out = root.path();
        let staging = filled(out);
        fs::write(out.join("exhibit.toml"), "mine").unwrap();
        let error = staging.publish().unwrap_err();
        assert!(matches!(&error, StagingError::Exists(path) if path.ends_with("exhibit.toml")));
        assert_eq!(
            fs::read_to_string(out.join("exhibit.toml")).unwrap(),
            "mine"
        );
        assert_eq!(names(out), ["exhibit.toml"]);
        fs::remove_file(out.join("exhibit.toml")).unwrap();
        filled(out).publish().unwrap();
        assert_eq!(names(out), ["exhibit.toml", "maps"]);
    }

    #[test]
    fn only_one_at_a_time_holds_the_lock() {
        let root = tempfile::tempdir().unwrap();
        let inside = AtomicUsize::new(0);
        let together = AtomicBool::new(false);
        thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    for _ in 0..400 {
                        let lock = Lock::of(root.path());
                        if lock.is_ok() {
                            if inside.fetch_add(1, Ordering::SeqCst) > 0 {
                                together.store(true, Ordering::SeqCst);
                            }
                            thread::yield_now();
                            inside.fetch_sub(1, Ordering::SeqCst);
                        }
                    }
                });
            }
        });
        assert!(!together.load(Ordering::SeqCst));
        assert_eq!(names(root.path()), [""; 0]);
    }

    #[test]
    fn a_lock_of_a_file_that_lost_its_name_is_none() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join(LOCK);
        let first = Lock::of(root.path()).unwrap();
        let early = File::create(&path).unwrap();
        assert!(is_named(&early, &path));
        drop(first);
        assert!(early.try_lock().is_ok() && !is_named(&early, &path));
        // The new one is another file; that of somebody else stays where it is.
        let second = Lock::of(root.path()).unwrap();
        assert!(!is_named(&early, &path) && is_named(&second.file, &path));
        drop(Lock {
            path: path.clone(),
            file: early,
        });
        assert!(path.exists());
        assert!(matches!(Lock::of(root.path()), Err(StagingError::Busy(_))));
    }

    #[test]
    fn what_took_its_place_in_part_is_taken_back_whichever_command_it_was() {
        let root = tempfile::tempdir().unwrap();
        let out = root.path();
        let left = out.join(format!("{PREFIX}abc"));
        fs::create_dir(&left).unwrap();
        fs::write(left.join(PUBLISHING), "images\n../notes.txt\nmanifest.json").unwrap();
        fs::write(left.join("manifest.json"), "{}").unwrap();
        fs::create_dir(out.join("images")).unwrap();
        fs::write(out.join("notes.txt"), "mine").unwrap();
        let staging = Staging::new(out, NAMES).unwrap();
        assert_eq!(staging.interrupted, 1);
        drop(staging);
        assert_eq!(names(out), ["notes.txt"]);
        // One that never began to take its place says nothing of what is there.
        fs::create_dir(&left).unwrap();
        fs::write(left.join("manifest.json"), "{}").unwrap();
        fs::create_dir(out.join("images")).unwrap();
        assert_eq!(Staging::new(out, NAMES).unwrap().interrupted, 1);
        assert_eq!(names(out), ["images", "notes.txt"]);
    }
}
