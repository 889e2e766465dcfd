//! Publishing: a version of an exhibit is copied beside the others and only then pointed to, so
//! that whoever shows it sees the last one or the whole new one; see
//! [`manifest::published`](crate::manifest::published).

use std::{
    ffi::OsStr,
    fs::{self, File},
    io::{self, Read, Write},
    path::{Component, Path, PathBuf},
    time::SystemTime,
};

use crate::manifest::{
    Exhibit, Fault, Faults, MANIFEST,
    published::{POINTER, VERSIONS, pointed_to},
};

/// How many versions are kept unless somebody says otherwise.
pub const KEPT: usize = 5;
/// Names of copies that are not finished; versions begin with a year.
const UNFINISHED: &str = ".publishing-";
/// Held while a version is published.
const LOCK: &str = ".publish.lock";
/// Folders of version control, which are nothing to show.
const LEFT_OUT: [&str; 4] = [".git", ".hg", ".svn", ".DS_Store"];
/// Links lead to folders at most so deep.
const DEEPEST: usize = 32;

/// A version that is shown now.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Published {
    /// Its folder.
    pub version: PathBuf,
    /// Whether it was published now; the same files are not published twice.
    pub new: bool,
    /// Of the exhibit.
    pub warnings: Vec<Fault>,
    /// What could not be removed though it is no longer kept, in words.
    pub left_behind: Vec<String>,
}

/// Why nothing was published; what was shown before still is.
#[derive(Debug, thiserror::Error)]
pub enum PublishError {
    /// The exhibit is at fault.
    #[error(transparent)]
    Faults(#[from] Faults),
    /// The manifest goes by another name.
    #[error("{}: a folder is published, and its manifest is called {MANIFEST}", .0.display())]
    Manifest(PathBuf),
    /// The copy would be part of what is copied.
    #[error(
        "{}: lies in the exhibit's own folder; publish to a folder elsewhere",
        .0.display()
    )]
    Inside(PathBuf),
    /// Somebody put something else there.
    #[error(
        "{}: is neither a link nor a file that points to a version; move it away",
        .0.display()
    )]
    Pointer(PathBuf),
    /// Another one is being published.
    #[error("{}: something is being published there; try again when that is done", .0.display())]
    Busy(PathBuf),
    /// Somebody saved while it was copied.
    #[error(
        "{}: changed while it was being published; nothing was published, try again",
        .0.display()
    )]
    Changed(PathBuf),
    /// Of `needed` bytes, not all found room.
    #[error(
        "{}: no room for the {} MB of the exhibit; what was shown still is. Remove files there, or \
         keep fewer versions with --keep",
        path.display(),
        needed.div_ceil(1_000_000)
    )]
    Full {
        path: PathBuf,
        needed: u64,
        source: io::Error,
    },
    /// A file or folder cannot be read or written.
    #[error("{}: {source}; what was shown still is", path.display())]
    Io { path: PathBuf, source: io::Error },
}

/// Checks the exhibit of a folder, copies it beside the other versions of `root`, points to the
/// copy, and removes all but the last `keep` (at least two: the last one may still be read).
/// `progress` is told how many bytes of how many are copied.
///
/// # Errors
/// [`PublishError`]; what `root` showed before is still shown then.
pub fn publish(
    exhibit: &Path,
    root: &Path,
    keep: usize,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Published, PublishError> {
    let (exhibit, mut warnings) = Exhibit::read(exhibit)?;
    if exhibit.manifest.file_name() != Some(OsStr::new(MANIFEST)) {
        return Err(PublishError::Manifest(exhibit.manifest));
    }
    let source = &exhibit.folder;
    // Before their pixels are looked at, so that what is copied is what was.
    let files = listed(source)?;
    warnings.extend(exhibit.verify(exhibit.maps())?);

    let versions = root.join(VERSIONS);
    fs::create_dir_all(&versions).map_err(|error| failed(&versions, error))?;
    outside(root, source)?;
    let _held = lock(root)?;
    tidy(root, &versions)?;
    let pointer = root.join(POINTER);
    let before = pointed_to(root);
    if before.is_none() && pointer.symlink_metadata().is_ok() {
        return Err(PublishError::Pointer(pointer));
    }

    let copy = unfinished(&versions)?;
    let hash = copied(source, &files, copy.path(), progress)?;
    if listed(source)? != files {
        return Err(PublishError::Changed(source.clone()));
    }
    // What is left out of the copy is not missed by the exhibit.
    Exhibit::read(copy.path()).map_err(|faults| named_in(source, copy.path(), faults))?;
    let same = before.filter(|name| {
        name.ends_with(&format!("-{hash}")) && versions.join(name).join(MANIFEST).is_file()
    });
    let new = same.is_none();
    let name = match same {
        Some(name) => name,
        None => {
            let name = format!("{}-{hash}", stamp());
            let version = versions.join(&name);
            fs::rename(copy.path(), &version).map_err(|error| failed(&version, error))?;
            // It has another name now, and is not removed by the old one.
            let _ = copy.keep();
            let pointed = sync_folder(&versions)
                .and_then(|()| point(root, &name))
                .map_err(|error| failed(&pointer, error));
            if let Err(error) = pointed {
                if pointed_to(root).as_ref() != Some(&name) {
                    let _ = fs::remove_dir_all(&version);
                }
                return Err(error);
            }
            name
        }
    };
    Ok(Published {
        version: versions.join(&name),
        new,
        warnings,
        left_behind: prune(&versions, &name, keep.max(2)),
    })
}

/// Faults of the copy, as of what was copied.
fn named_in(source: &Path, copy: &Path, faults: Faults) -> PublishError {
    let named = faults.into_iter().map(|fault| Fault {
        file: fault.file.map(|file| match file.strip_prefix(copy) {
            Ok(within) => source.join(within),
            Err(_) => file,
        }),
        ..fault
    });
    match Faults::new(named.collect()) {
        Some(faults) => faults.into(),
        None => PublishError::Changed(source.to_owned()),
    }
}

fn failed(path: &Path, source: io::Error) -> PublishError {
    PublishError::Io {
        path: path.to_owned(),
        source,
    }
}

/// A file of the exhibit, and what tells one version of it from another.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Listed {
    /// Within the exhibit's folder.
    path: PathBuf,
    length: u64,
    modified: Option<SystemTime>,
}

/// All files below a folder, by their paths. A link that leads out of it is nothing of it.
fn listed(folder: &Path) -> Result<Vec<Listed>, PublishError> {
    let real = folder
        .canonicalize()
        .map_err(|error| failed(folder, error))?;
    let mut files = Vec::new();
    let mut open = vec![PathBuf::new()];
    while let Some(within) = open.pop() {
        let here = folder.join(&within);
        let entries = fs::read_dir(&here).map_err(|error| failed(&here, error))?;
        let real_here = here.canonicalize().map_err(|error| failed(&here, error))?;
        for entry in entries {
            let entry = entry.map_err(|error| failed(&here, error))?;
            let name = entry.file_name();
            if LEFT_OUT.iter().any(|out| name == *out) {
                continue;
            }
            let path = within.join(&name);
            let full = folder.join(&path);
            let Ok(metadata) = fs::metadata(&full) else {
                // A link to nothing, or a file that was just removed.
                continue;
            };
            // Nor is one that leads round in a circle.
            let inside = full
                .canonicalize()
                .is_ok_and(|target| target.starts_with(&real) && !real_here.starts_with(target));
            if !inside {
                continue;
            }
            if metadata.is_dir() && path.components().count() < DEEPEST {
                open.push(path);
            } else if metadata.is_file() {
                files.push(Listed {
                    path,
                    length: metadata.len(),
                    modified: metadata.modified().ok(),
                });
            }
        }
    }
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(files)
}

/// Nothing is copied into itself.
fn outside(root: &Path, source: &Path) -> Result<(), PublishError> {
    let real = |path: &Path| path.canonicalize().map_err(|error| failed(path, error));
    if real(root)?.starts_with(real(source)?) {
        return Err(PublishError::Inside(root.to_owned()));
    }
    Ok(())
}

/// One is published at a time; the system lets go of it when the program ends, however it ends.
fn lock(root: &Path) -> Result<File, PublishError> {
    let path = root.join(LOCK);
    let file = File::options()
        .create(true)
        .truncate(false)
        .write(true)
        .open(&path)
        .map_err(|error| failed(&path, error))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(fs::TryLockError::WouldBlock) => Err(PublishError::Busy(root.to_owned())),
        // Some network file systems lock nothing; one technician publishes there at a time.
        Err(fs::TryLockError::Error(_)) => Ok(file),
    }
}

/// Removes what an interrupted publication left.
fn tidy(root: &Path, versions: &Path) -> Result<(), PublishError> {
    for folder in [root, versions] {
        let entries = fs::read_dir(folder).map_err(|error| failed(folder, error))?;
        for entry in entries.flatten() {
            if !entry.file_name().to_string_lossy().starts_with(UNFINISHED) {
                continue;
            }
            let path = entry.path();
            let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
            let removed = match is_folder {
                true => fs::remove_dir_all(&path),
                false => fs::remove_file(&path),
            };
            removed.map_err(|error| failed(&path, error))?;
        }
    }
    Ok(())
}

/// A folder for a copy, removed with it unless that is finished.
fn unfinished(versions: &Path) -> Result<tempfile::TempDir, PublishError> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(UNFINISHED);
    // The default is readable by its owner only; this one obeys the umask.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
    builder
        .tempdir_in(versions)
        .map_err(|error| failed(versions, error))
}

/// Copies `files` of one folder into another, down to the disk, and gives the first digits of a
/// hash of their names and contents.
fn copied(
    from: &Path,
    files: &[Listed],
    to: &Path,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<String, PublishError> {
    const DIGITS: usize = 12;
    let needed = files.iter().map(|file| file.length).sum();
    let write_failed = |path: &Path, source: io::Error| match source.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge => {
            PublishError::Full {
                path: to.parent().unwrap_or(to).to_owned(),
                needed,
                source,
            }
        }
        _ => failed(path, source),
    };
    let mut hasher = blake3::Hasher::new();
    let mut buffer = vec![0; 1 << 20];
    let mut done = 0;
    let mut folders = vec![to.to_owned()];
    for file in files {
        let target = to.join(&file.path);
        for folder in file
            .path
            .ancestors()
            .skip(1)
            .collect::<Vec<_>>()
            .into_iter()
            .rev()
        {
            let folder = to.join(folder);
            if !folder.is_dir() {
                fs::create_dir(&folder).map_err(|error| write_failed(&folder, error))?;
                folders.push(folder);
            }
        }
        // Separators differ between systems, and the hash does not.
        for part in file.path.components() {
            if let Component::Normal(name) = part {
                hasher.update(name.as_encoded_bytes());
                hasher.update(b"/");
            }
        }
        hasher.update(&file.length.to_le_bytes());
        let path = from.join(&file.path);
        let mut source = File::open(&path).map_err(|error| failed(&path, error))?;
        let mut copy = File::create(&target).map_err(|error| write_failed(&target, error))?;
        loop {
            let read = match source.read(&mut buffer) {
                Ok(0) => break,
                Ok(read) => read,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => return Err(failed(&path, error)),
            };
            hasher.update(&buffer[..read]);
            copy.write_all(&buffer[..read])
                .map_err(|error| write_failed(&target, error))?;
            done += read as u64;
            progress(done, needed);
        }
        copy.sync_all()
            .map_err(|error| write_failed(&target, error))?;
    }
    for folder in &folders {
        sync_folder(folder).map_err(|error| write_failed(folder, error))?;
    }
    Ok(hasher.finalize().to_hex()[..DIGITS].to_owned())
}

/// The names in a folder reach the disk.
fn sync_folder(folder: &Path) -> io::Result<()> {
    // Elsewhere folders cannot be opened, and their names are written with the files.
    if cfg!(unix) {
        File::open(folder)?.sync_all()?;
    }
    Ok(())
}

/// The time as a name, to the millisecond: names are in the order of their times.
fn stamp() -> String {
    let now = jiff::Timestamp::now();
    let millis = now.as_millisecond().rem_euclid(1000);
    format!("{}{millis:03}Z", now.strftime("%Y%m%dT%H%M%S"))
}

/// Points to a version of `root` at one stroke.
fn point(root: &Path, name: &str) -> io::Result<()> {
    let target = Path::new(VERSIONS).join(name);
    let new = root.join(format!("{UNFINISHED}{POINTER}"));
    let linked = link(&target, &new);
    if linked.is_err() {
        // Where there are no links, as on memory sticks: one line.
        let mut file = File::create(&new)?;
        writeln!(file, "{VERSIONS}/{name}")?;
        file.sync_all()?;
    }
    fs::rename(&new, root.join(POINTER)).inspect_err(|_| drop(fs::remove_file(&new)))?;
    sync_folder(root)
}

#[cfg(unix)]
fn link(target: &Path, link: &Path) -> io::Result<()> {
    std::os::unix::fs::symlink(target, link)
}

#[cfg(not(unix))]
fn link(_: &Path, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Removes all versions but the last `keep`, never `current`; gives those that would not go.
fn prune(versions: &Path, current: &str, keep: usize) -> Vec<String> {
    let Ok(entries) = fs::read_dir(versions) else {
        return Vec::new();
    };
    let mut names: Vec<String> = entries
        .flatten()
        .filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_dir()))
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(|name| name != current && is_version(name))
        .collect();
    names.sort();
    let surplus = (names.len() + 1).saturating_sub(keep);
    let left = names.into_iter().take(surplus).filter_map(|name| {
        let path = versions.join(name);
        let error = fs::remove_dir_all(&path).err()?;
        Some(format!("{}: cannot be removed ({error})", path.display()))
    });
    left.collect()
}

/// Whether a folder's name is one that [`stamp`] and a hash made; others are somebody's own.
fn is_version(name: &str) -> bool {
    name.split_once('-').is_some_and(|(time, hash)| {
        time.len() == "20261126T071500123Z".len()
            && time.ends_with('Z')
            && time.starts_with(|c: char| c.is_ascii_digit())
            && hash.bytes().all(|byte| byte.is_ascii_hexdigit())
    })
}
