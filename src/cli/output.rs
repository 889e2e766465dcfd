//! The two streams, neither of which has to be open, and files that are yet to be written.

pub use crate::stage::say;
use std::{
    fmt::Display,
    fs,
    io::{self, Write},
    path::Path,
};

use indicatif::{ProgressBar, ProgressStyle};

use super::Failure;
use crate::manifest::Exhibit;

/// Writes a result and a newline to standard output.
pub fn result(text: impl Display) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    writeln!(out, "{text}")?;
    Ok(out.flush()?)
}

/// A bar on standard error, where that is a terminal.
pub fn progress(steps: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:40} {percent:>3} % {wide_msg}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(steps).with_style(style)
}

/// The same, with the time that is left, for work of minutes.
pub fn long_progress(steps: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:40} {percent:>3} %, {eta} left {wide_msg}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(steps).with_style(style)
}

/// Finds out, before any work is done, whether the file `path` could be written, and that it is none
/// of those that `exhibit` is made of.
pub fn can_write_file(path: &Path, exhibit: &Exhibit) -> Result<(), Failure> {
    if path.is_dir() {
        return Err(refused(path, "is a folder; name a file in it"));
    }
    spares(exhibit, path)?;
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    can_write_into(folder)
}

/// Finds out that what is written to `path` takes the place of nothing that `exhibit` is made of.
pub fn spares(exhibit: &Exhibit, path: &Path) -> Result<(), Failure> {
    // Where nothing is yet, nothing is lost.
    let Ok(there) = path.canonicalize() else {
        return Ok(());
    };
    let maps = exhibit.maps().map(|map| map.path.as_path());
    let mut own = maps.chain([exhibit.manifest.as_path()]);
    if own.any(|own| own.canonicalize().is_ok_and(|own| own == there)) {
        let why = "is part of the exhibit and would be lost; choose another name";
        return Err(refused(path, why));
    }
    Ok(())
}

/// Finds out whether the folder `path` could be made, if it is absent, and written to.
pub fn can_write_folder(path: &Path) -> Result<(), Failure> {
    let mut existing = path;
    // The current folder may have been deleted, and nothing is above it by this name.
    while !existing.exists() && existing != Path::new(".") {
        existing = match existing.parent() {
            Some(parent) if parent != Path::new("") => parent,
            _ => Path::new("."),
        };
    }
    can_write_into(existing)
}

/// Makes a folder and those above it.
pub fn make_folder(path: &Path) -> Result<(), Failure> {
    fs::create_dir_all(path)
        .map_err(|error| refused(path, &format!("the folder cannot be made: {error}")))
}

fn can_write_into(folder: &Path) -> Result<(), Failure> {
    if !folder.exists() {
        return Err(refused(folder, "no such folder; make it first"));
    }
    if !folder.is_dir() {
        return Err(refused(folder, "is not a folder"));
    }
    tempfile::tempfile_in(folder).map(drop).map_err(|error| {
        refused(
            folder,
            &format!("cannot be written to: {error}; choose another folder"),
        )
    })
}

fn refused(path: &Path, why: &str) -> Failure {
    Failure::Input(format!("{}: {why}", path.display()).into())
}
