//! A print that can be made again: its scale bar, and a sidecar that says what it was made from.
//!
//! | step | where |
//! |---|---|
//! | camera → mm per pixel, and where that holds | [`scale`] |
//! | scale → a bar on the print | [`bar`] |
//! | exhibit, scene and options → the sidecar | [`sidecar`] |

pub mod bar;
pub mod scale;
pub mod sidecar;

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use serde_json::Value;

/// Why there is no figure.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    /// The sidecar's place is taken.
    #[error("{}: {what}; name the picture otherwise, or move that file away", path.display())]
    Taken { path: PathBuf, what: String },
    #[error("{}: cannot be written", path.display())]
    Write { path: PathBuf, source: io::Error },
    #[error("{}: cannot be read", path.display())]
    Read { path: PathBuf, source: io::Error },
    /// A picture that could not be encoded.
    #[error(transparent)]
    Picture(Box<dyn std::error::Error + Send + Sync>),
    #[error(transparent)]
    Plot(#[from] crate::lettering::PlotError),
}

/// The sidecar's file beside a picture's.
pub fn sidecar_of(picture: &Path) -> PathBuf {
    picture.with_extension("json")
}

/// Finds out, before any work is done, whether the sidecar of `picture` would take the place of
/// something else: only that of an older picture of the same name may go.
///
/// # Errors
/// [`FigureError::Taken`], or of reading what is there.
pub fn is_free(picture: &Path) -> Result<(), FigureError> {
    let path = sidecar_of(picture);
    let taken = |what: String| FigureError::Taken {
        path: path.clone(),
        what,
    };
    if path.is_dir() {
        return Err(taken("is a folder".to_owned()));
    }
    let text = match fs::read(&path) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(source) => return Err(FigureError::Read { path, source }),
    };
    let found: Option<Value> = serde_json::from_slice(&text).ok();
    let of = found
        .as_ref()
        .and_then(|found| found.pointer(sidecar::FILE_POINTER)?.as_str());
    let name = picture.file_name().unwrap_or_default();
    match of {
        None => Err(taken("is no sidecar of Recto's".to_owned())),
        Some(of) if of == name.to_string_lossy() => Ok(()),
        Some(of) => Err(taken(format!("is the sidecar of {of}"))),
    }
}

/// Writes a picture by `write`, which is given a path, and its sidecar, which `describe` makes of
/// the picture's bytes; both or neither.
///
/// # Errors
/// [`FigureError`]; nothing is left behind.
pub fn save<E: std::error::Error + Send + Sync + 'static>(
    picture: &Path,
    write: impl FnOnce(&Path) -> Result<(), E>,
    describe: impl FnOnce(&[u8]) -> Value,
) -> Result<(), FigureError> {
    let folder = match picture.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |source| FigureError::Write { path, source }
    };
    // Beside the picture, so that both only have to be renamed when they are whole.
    let hidden = tempfile::Builder::new()
        .prefix(".recto-")
        .tempdir_in(folder)
        .map_err(failed(picture))?;
    let drawn = hidden.path().join(picture.file_name().unwrap_or_default());
    write(&drawn).map_err(|error| FigureError::Picture(Box::new(error)))?;
    let bytes = fs::read(&drawn).map_err(failed(picture))?;
    let sidecar = sidecar_of(picture);
    let described = sidecar_of(&drawn);
    let text = format!("{:#}\n", describe(&bytes));
    fs::write(&described, text).map_err(failed(&sidecar))?;
    // A picture without its sidecar would say nothing of itself: the sidecar goes first.
    let before = fs::read(&sidecar).ok();
    fs::rename(&described, &sidecar).map_err(failed(&sidecar))?;
    fs::rename(&drawn, picture).map_err(|source| {
        match before {
            Some(before) => drop(fs::write(&sidecar, before)),
            None => drop(fs::remove_file(&sidecar)),
        }
        failed(picture)(source)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn describe(name: &str) -> impl FnOnce(&[u8]) -> Value + use<'_> {
        move |bytes| json!({ "picture": { "file": name, "bytes": bytes.len() } })
    }

    #[test]
    fn both_files_are_written_or_neither() {
        let folder = tempfile::tempdir().unwrap();
        let picture = folder.path().join("a.png");
        let count = || fs::read_dir(folder.path()).unwrap().count();
        let fail = |_: &Path| Err(io::Error::other("no ink"));
        assert!(save(&picture, fail, describe("a.png")).is_err());
        assert_eq!(count(), 0);
        // The picture cannot take the place of a folder that is not empty.
        fs::create_dir_all(picture.join("full")).unwrap();
        let write = |path: &Path| fs::write(path, b"ink");
        assert!(save(&picture, write, describe("a.png")).is_err());
        assert_eq!(count(), 1);
        fs::remove_dir_all(&picture).unwrap();
        save(&picture, write, describe("a.png")).unwrap();
        assert_eq!(count(), 2);
        assert_eq!(fs::read(&picture).unwrap(), b"ink");
    }

    #[test]
    fn what_is_no_sidecar_of_the_picture_stays() {
        let folder = tempfile::tempdir().unwrap();
        let [png, exr] = ["a.png", "a.exr"].map(|name| folder.path().join(name));
        is_free(&png).unwrap();
        let write = |path: &Path| fs::write(path, b"ink");
        save(&png, write, describe("a.png")).unwrap();
        is_free(&png).unwrap();
        let error = is_free(&exr).unwrap_err().to_string();
        assert!(error.contains("is the sidecar of a.png"), "{error}");
        for other in ["{}", "no json", ""] {
            fs::write(sidecar_of(&png), other).unwrap();
            assert!(matches!(is_free(&png), Err(FigureError::Taken { .. })));
        }
    }
}
