//! A starting exhibit from one picture.

use std::{
    fs::{self, File},
    io::{self, BufRead, BufReader, Write},
    path::{Path, PathBuf},
};

use super::{
    Exhibit, MANIFEST,
    fault::{Fault, Faults},
};
use crate::maps::{self, MapError, encode::write_whole};

/// Why no exhibit could be started.
#[derive(Debug, thiserror::Error)]
pub enum CreateError {
    /// There is an exhibit already.
    #[error(
        "{}: an exhibit is there already; choose another folder or remove the file",
        .0.display()
    )]
    Exists(PathBuf),
    /// Another file has the picture's name already.
    #[error(
        "{}: is another file than the picture; choose another folder or rename one of the two",
        .0.display()
    )]
    Occupied(PathBuf),
    /// The picture is none, or it or the manifest cannot be written.
    #[error(transparent)]
    File(#[from] MapError),
    /// The picture has no file name that a manifest could hold.
    #[error("{}: has no plain file name; rename it", .0.display())]
    Name(PathBuf),
    /// The folder cannot be made.
    #[error("{}: cannot be made: {source}", path.display())]
    Folder { path: PathBuf, source: io::Error },
    /// What was asked for cannot be an exhibit, such as a sheet without width.
    #[error(transparent)]
    Faults(#[from] Faults),
}

/// Makes a folder with a copy of the picture `albedo` and a manifest that shows it as a sheet of
/// `size_mm`. Returns the manifest's path and its warnings.
///
/// # Errors
/// If there is a manifest already or another file by the picture's name, if the picture or size
/// cannot be used, or if nothing can be written; then no manifest is left behind.
pub fn create(
    folder: &Path,
    albedo: &Path,
    size_mm: [f64; 2],
) -> Result<(PathBuf, Vec<Fault>), CreateError> {
    let manifest = folder.join(MANIFEST);
    if manifest.exists() {
        return Err(CreateError::Exists(manifest));
    }
    maps::probe(albedo)?;
    let name = albedo.file_name().and_then(|name| name.to_str());
    let name = name.ok_or_else(|| CreateError::Name(albedo.to_owned()))?;
    let text = starting_text(name, size_mm);
    super::check_shape(&text)?;
    fs::create_dir_all(folder).map_err(|source| CreateError::Folder {
        path: folder.to_owned(),
        source,
    })?;
    let copy = folder.join(name);
    if !copy.exists() {
        let mut picture = open(albedo)?;
        write_whole(&copy, |file| io::copy(&mut picture, file).map(|_| ()))?;
    } else if !same_content(albedo, &copy)? {
        return Err(CreateError::Occupied(copy));
    }
    let (_, warnings) = Exhibit::parse(&manifest, folder, &text)?;
    write_whole(&manifest, |file| file.write_all(text.as_bytes()))?;
    Ok((manifest, warnings))
}

fn open(path: &Path) -> Result<BufReader<File>, MapError> {
    File::open(path)
        .map(BufReader::new)
        .map_err(|reason| unreadable(path, reason))
}

fn unreadable(path: &Path, reason: io::Error) -> MapError {
    MapError::Read {
        path: path.to_owned(),
        reason,
    }
}

/// Whether two files hold the same bytes.
fn same_content(one: &Path, other: &Path) -> Result<bool, MapError> {
    let (mut a, mut b) = (open(one)?, open(other)?);
    loop {
        let left = a.fill_buf().map_err(|reason| unreadable(one, reason))?;
        let right = b.fill_buf().map_err(|reason| unreadable(other, reason))?;
        let both = left.len().min(right.len());
        if both == 0 {
            return Ok(left.is_empty() && right.is_empty());
        }
        if left[..both] != right[..both] {
            return Ok(false);
        }
        a.consume(both);
        b.consume(both);
    }
}

/// The manifest with its explanations.
fn starting_text(albedo: &str, [width, height]: [f64; 2]) -> String {
    let title = albedo.rsplit_once('.').map_or(albedo, |(stem, _)| stem);
    format!(
        r##"# An exhibit for Recto. `recto schema` prints what an editor needs to check this file
# while you type, and `recto check` names every fault.

[exhibit]
title = {{ en = {title} }}

[[drawing]]
id = "sheet"
# Width and height of the sheet in mm.
size_mm = [{width}, {height}]
recto.albedo = {albedo}
# Add what you have, each a picture of the same size:
# recto.normal = "normal.png"
# recto.height = {{ file = "height.png", range_um = [-50, 50] }}
# verso.albedo = "verso.jpg"
"##,
        title = toml::Value::from(title),
        width = toml::Value::from(width),
        height = toml::Value::from(height),
        albedo = toml::Value::from(albedo),
    )
}
