//! One file, replaced whole or not at all.

use std::{
    fs,
    io::{self, Write},
    path::{Path, PathBuf},
};

use super::SaveError;

/// The file behind `path`, every link followed, if it may be written.
pub fn writable(path: &Path) -> Result<PathBuf, SaveError> {
    let failed = |source: io::Error| SaveError::Write {
        path: path.to_owned(),
        source,
    };
    let real = path.canonicalize().map_err(failed)?;
    let metadata = fs::metadata(&real).map_err(failed)?;
    // A file beside it could take its place all the same: that is not what was meant.
    if metadata.permissions().readonly() {
        return Err(SaveError::ReadOnly(path.to_owned()));
    }
    match fs::OpenOptions::new().append(true).open(&real) {
        Ok(_) => Ok(real),
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => {
            Err(SaveError::ReadOnly(path.to_owned()))
        }
        Err(error) => Err(failed(error)),
    }
}

/// Writes `new` into a file beside `path` that takes its name and its permissions, if its text is
/// `old` to the last.
pub fn replace(path: &Path, old: &str, new: &str) -> Result<(), SaveError> {
    let failed = |source: io::Error| SaveError::Write {
        path: path.to_owned(),
        source,
    };
    let folder = path.parent().unwrap_or(Path::new("."));
    let write = || -> io::Result<tempfile::NamedTempFile> {
        let metadata = fs::metadata(path)?;
        let mut file = tempfile::Builder::new()
            .prefix(".recto-")
            .tempfile_in(folder)?;
        file.write_all(new.as_bytes())?;
        #[cfg(unix)]
        {
            use std::os::unix::fs::{MetadataExt, fchown};
            // Only the superuser can give a file away, and only he would take one over.
            let _ = fchown(&file, Some(metadata.uid()), Some(metadata.gid()));
        }
        file.as_file().set_permissions(metadata.permissions())?;
        file.as_file().sync_all()?;
        Ok(file)
    };
    let file = write().map_err(failed)?;
    // Whoever saves at this moment is not to lose it.
    if fs::read(path).map_err(failed)? != old.as_bytes() {
        return Err(SaveError::Changed(path.to_owned()));
    }
    file.persist(path).map_err(|error| failed(error.error))?;
    Ok(())
}
