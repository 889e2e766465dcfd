//! Files of the exhibit: there, inside its folder, readable, and pictures that can be shown.

use std::{
    fs,
    io::{self, Read},
    path::{Component, Path, PathBuf},
};

use super::super::{
    decode::Pattern,
    document::{Trail, Words},
    fault::{did_you_mean, quote},
    raw::values::FilePath,
};
use super::{Validator, lamp::spectrum_words};
use crate::{
    maps::{self, Header, MAX_SIDE, MapError},
    optics::{photometry::Photometry, spectrum},
};

impl Validator<'_, '_> {
    /// The path of a file of the exhibit, named at `trail`.
    pub(super) fn file(&mut self, file: &FilePath, trail: &Trail) -> Option<PathBuf> {
        if self.report.is_full() {
            return None;
        }
        let words = match self.inside(file) {
            Ok(path) => return Some(path),
            Err(words) => words,
        };
        self.report.fault(trail, words);
        None
    }

    fn inside(&self, file: &FilePath) -> Result<PathBuf, Words> {
        let quoted = quote(file.as_str());
        if file.as_str().contains('\\') {
            return Err(Words::new(
                quoted,
                FilePath::ALLOWED,
                "write / instead of \\",
            ));
        }
        let path = self.folder.join(file.as_str());
        if leaves_its_folder(Path::new(file.as_str())) {
            return Err(Words::new(
                format!("{quoted}, which leaves the exhibit's folder"),
                FilePath::ALLOWED,
                FilePath::REMEDY,
            ));
        }
        let real = path.canonicalize().map_err(|error| match error.kind() {
            io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => absent(file, &path),
            _ => unreadable(&quoted, &error),
        })?;
        if !real.starts_with(&self.real_folder) {
            return Err(Words::new(
                format!("{quoted}, a link that leads out of the exhibit's folder"),
                FilePath::ALLOWED,
                "copy the file itself into the exhibit's folder",
            ));
        }
        if !real.is_file() {
            return Err(Words::new(
                format!("{quoted}, which is not a file"),
                FilePath::ALLOWED,
                "name a file in it",
            ));
        }
        Ok(path)
    }

    /// A picture of the exhibit, named at `trail`, and what its header says.
    pub(super) fn picture(&mut self, file: &FilePath, trail: &Trail) -> Option<(PathBuf, Header)> {
        let path = self.file(file, trail)?;
        match maps::probe(&path) {
            Ok(header) => Some((path, header)),
            Err(error) => {
                self.report
                    .fault(trail, map_words(file.as_str(), &error, PICTURE));
                None
            }
        }
    }

    /// A modelled shape of the exhibit, named at `trail`.
    pub(super) fn model(&mut self, file: &FilePath, trail: &Trail) -> Option<PathBuf> {
        let path = self.file(file, trail)?;
        match maps::surface::load_gltf(&path) {
            Ok(_) => Some(path),
            Err(error) => {
                self.report
                    .fault(trail, map_words(file.as_str(), &error, MODEL));
                None
            }
        }
    }

    /// The chromaticity of a table of spectral power of the exhibit, named at `trail`.
    pub(super) fn spectrum_file(&mut self, file: &FilePath, trail: &Trail) -> Option<[f64; 2]> {
        let path = self.file(file, trail)?;
        let xy = small_text(&path).and_then(|text| {
            let [wavelengths, power] = spectrum::two_columns(&text)
                .map_err(|line| format!("line {line} is not two numbers"))?;
            spectrum::chromaticity(&wavelengths, &power).map_err(|error| error.to_string())
        });
        match xy {
            Ok(xy) => Some(xy),
            Err(reason) => {
                let found = format!("{} ({reason})", quote(file.as_str()));
                self.report.fault(trail, spectrum_words(found));
                None
            }
        }
    }

    /// A photometric file of the exhibit, named at `trail`.
    pub(super) fn photometry(&mut self, file: &FilePath, trail: &Trail) -> Option<Photometry> {
        let path = self.file(file, trail)?;
        let lamp = small_text(&path)
            .and_then(|text| Photometry::parse(&text).map_err(|error| error.to_string()));
        match lamp {
            Ok(lamp) => Some(lamp),
            Err(reason) => {
                let found = format!("{} ({reason})", quote(file.as_str()));
                let allowed = "a photometric file, IES LM-63, of type C and with TILT=NONE";
                self.report
                    .fault(trail, Words::new(found, allowed, "export it again"));
                None
            }
        }
    }
}

/// The text of a file that is a table, and no film under the wrong name. Older programs write
/// other encodings than UTF-8; what is not ASCII in such files is somebody's name.
fn small_text(path: &Path) -> Result<String, String> {
    const MOST_BYTES: u64 = 4 << 20;
    let mut bytes = Vec::new();
    fs::File::open(path)
        .and_then(|file| file.take(MOST_BYTES + 1).read_to_end(&mut bytes))
        .map_err(|error| error.to_string())?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err("more than 4 MiB".to_owned());
    }
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Whether a relative path climbs above where it starts, even if it comes back.
fn leaves_its_folder(path: &Path) -> bool {
    let mut depth = 0_usize;
    for component in path.components() {
        match component {
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
            Component::ParentDir if depth > 0 => depth -= 1,
            Component::ParentDir | Component::RootDir | Component::Prefix(_) => return true,
        }
    }
    false
}

fn absent(file: &FilePath, path: &Path) -> Words {
    let quoted = quote(file.as_str());
    if path.symlink_metadata().is_ok() {
        return Words::new(
            format!("{quoted}, a link to a file that is not there"),
            FilePath::ALLOWED,
            "copy the file itself into the exhibit's folder",
        );
    }
    let wanted = path.file_name().unwrap_or_default().to_string_lossy();
    let others = names_beside(path);
    Words::new(
        format!("{quoted}, which is not there"),
        FilePath::ALLOWED,
        did_you_mean(
            &wanted,
            others.iter().map(String::as_str),
            "put the file there or correct the path",
        ),
    )
}

/// The names of the files in the folder of `path`.
fn names_beside(path: &Path) -> Vec<String> {
    let entries = path.parent().and_then(|folder| fs::read_dir(folder).ok());
    let mut names: Vec<String> = entries
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    // Folders are read in any order, and the same fault should read the same everywhere.
    names.sort();
    names
}

fn unreadable(quoted: &str, error: &io::Error) -> Words {
    Words::new(
        format!("{quoted}, which cannot be read ({error})"),
        "a readable file",
        "check its name and permissions",
    )
}

/// What pictures may be, as the `allowed` part of a fault.
pub(crate) const PICTURE: &str = "a PNG, JPEG, TIFF or OpenEXR picture in grey or RGB";
/// What shapes may be.
pub(super) const MODEL: &str = "one .glb file with a triangle mesh and texture coordinates";

/// What a fault says about a picture or shape that cannot be used.
pub(crate) fn map_words(name: &str, error: &MapError, allowed: &str) -> Words {
    let quoted = quote(name);
    match error {
        MapError::Read { reason, .. } | MapError::Write { reason, .. } => {
            unreadable(&quoted, reason)
        }
        MapError::UnknownFormat { .. } => Words::new(
            format!("{quoted}, which is no picture of a known format"),
            allowed,
            "export it as one of these",
        ),
        MapError::Size { width, height, .. } => Words::new(
            format!("{quoted}, a picture of {width} × {height} pixels"),
            format!("1 to {MAX_SIDE} pixels a side"),
            "resample it",
        ),
        MapError::Unsupported { found, remedy, .. } => {
            Words::new(format!("{quoted}, which {found}"), allowed, *remedy)
        }
        MapError::Damaged { detail, .. } => Words::new(
            format!("{quoted}, which is damaged ({detail})"),
            "a whole file",
            "export or copy it again",
        ),
        MapError::Profile { detail, .. } => Words::new(
            format!("{quoted}, a picture whose colour profile cannot be used ({detail})"),
            "an ICC profile for its own pixels",
            "embed another one, or set encoding to \"srgb\" or \"linear\"",
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_may_go_up_only_as_far_as_it_went_down() {
        assert!(!leaves_its_folder(Path::new("a/../b.png")));
        assert!(leaves_its_folder(Path::new("a/../../b.png")));
        assert!(leaves_its_folder(Path::new("../exhibit/b.png")));
        assert!(leaves_its_folder(Path::new("/b.png")));
    }
}
