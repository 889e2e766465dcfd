//! The folder that everything is written to first: within the one that is asked for, so that what
//! is done takes its place by a change of names, and nothing half done is ever seen there.
//!
//! What an interrupted run left behind is taken away by the next one. That no other run is at work
//! is told by a lock, which the system lifts from a process that ends in whatever way.

use std::{
    fs::{self, File, TryLockError},
    io,
    path::{Path, PathBuf},
};

use super::{PrepareError, report::REPORT, write::MAPS};
use crate::manifest::MANIFEST;

/// What names of staging folders begin with.
const PREFIX: &str = ".recto-prepare-";
/// The file that is locked while work goes on.
const LOCK: &str = ".recto-prepare.lock";
/// In a staging folder, from when on what is in it takes its place.
const PUBLISHING: &str = ".publishing";
/// What takes its place, the manifest last: whoever opens the folder meanwhile sees no exhibit, or
/// the whole.
const PUBLISHED: [&str; 3] = [MAPS, REPORT, MANIFEST];

/// A folder that work is staged in; it is removed with this value.
pub(super) struct Stage {
    folder: tempfile::TempDir,
    out: PathBuf,
    /// How many interrupted runs left something behind, which is gone now.
    pub interrupted: usize,
    // Fields are dropped in their order: the lock goes last.
    _lock: Lock,
}

/// A locked file, removed in the end.
struct Lock {
    path: PathBuf,
    _file: File,
}

impl Drop for Lock {
    fn drop(&mut self) {
        // A file that is left over does no harm: the lock decides.
        let _ = fs::remove_file(&self.path);
    }
}

fn refused(path: &Path) -> impl Fn(io::Error) -> PrepareError + use<> {
    let path = path.to_owned();
    move |reason| PrepareError::Folder {
        path: path.clone(),
        reason,
    }
}

impl Stage {
    /// Begins work in the folder `out`, which is there, and removes what interrupted work left.
    ///
    /// # Errors
    /// [`PrepareError::Busy`] where another run is at work there, [`PrepareError::Exists`] where
    /// something has the name of what is to be made, and [`PrepareError::Folder`].
    pub fn new(out: &Path) -> Result<Self, PrepareError> {
        let lock = locked(out)?;
        let interrupted = removed(out)?;
        for name in PUBLISHED {
            let path = out.join(name);
            if path.exists() {
                return Err(PrepareError::Exists(path));
            }
        }
        let folder = tempfile::Builder::new()
            .prefix(PREFIX)
            .tempdir_in(out)
            .map_err(refused(out))?;
        Ok(Self {
            folder,
            out: out.to_owned(),
            interrupted,
            _lock: lock,
        })
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Moves what was staged to its place.
    ///
    /// # Errors
    /// [`PrepareError::Folder`]; then nothing of it is there.
    pub fn publish(self) -> Result<(), PrepareError> {
        let mark = self.path().join(PUBLISHING);
        fs::write(&mark, "").map_err(refused(&mark))?;
        for (i, name) in PUBLISHED.iter().enumerate() {
            let to = self.out.join(name);
            if let Err(reason) = fs::rename(self.path().join(name), &to) {
                for name in &PUBLISHED[..i] {
                    // Back, to go with the rest.
                    let _ = fs::rename(self.out.join(name), self.path().join(name));
                }
                return Err(refused(&to)(reason));
            }
        }
        Ok(())
    }
}

fn locked(out: &Path) -> Result<Lock, PrepareError> {
    let path = out.join(LOCK);
    let file = File::create(&path).map_err(refused(&path))?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(PrepareError::Busy(out.to_owned())),
        // Some network folders know no locks.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(Lock { path, _file: file }),
    }
}

/// Removes what interrupted runs left in a folder, and says of how many. Nobody else is at work.
fn removed(out: &Path) -> Result<usize, PrepareError> {
    let mut count = 0;
    for entry in fs::read_dir(out).map_err(refused(out))? {
        let path = entry.map_err(refused(out))?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if !name.starts_with(PREFIX) || !path.is_dir() {
            continue;
        }
        // It broke off between the first change of names and the last: what is in place is its own.
        if path.join(PUBLISHING).exists() && path.join(MANIFEST).exists() {
            for name in PUBLISHED.iter().filter(|name| !path.join(name).exists()) {
                let placed = out.join(name);
                let gone = match placed.is_dir() {
                    true => fs::remove_dir_all(&placed),
                    false => fs::remove_file(&placed),
                };
                match gone {
                    Err(error) if error.kind() != io::ErrorKind::NotFound => {
                        return Err(refused(&placed)(error));
                    }
                    _ => {}
                }
            }
        }
        fs::remove_dir_all(&path).map_err(refused(&path))?;
        count += 1;
    }
    Ok(count)
}
