//! A starting exhibit from one picture.

use std::{
    fs, io,
    io::Write,
    path::{Path, PathBuf},
};

use super::{Exhibit, MANIFEST, fault::Faults};
use crate::maps::{self, MapError};

/// Why no exhibit could be started.
#[derive(Debug, thiserror::Error)]
pub enum CreateError {
    /// There is an exhibit already.
    #[error(
        "{}: an exhibit is there already; choose another folder or remove the file",
        .0.display()
    )]
    Exists(PathBuf),
    /// The picture is none.
    #[error(transparent)]
    Picture(#[from] MapError),
    /// The picture has no file name that a manifest could hold.
    #[error("{}: has no plain file name; rename it", .0.display())]
    Name(PathBuf),
    /// Nothing can be written there.
    #[error("{}: cannot be written: {source}", path.display())]
    Write { path: PathBuf, source: io::Error },
    /// What was asked for cannot be an exhibit, such as a sheet without width.
    #[error(transparent)]
    Faults(#[from] Faults),
}

/// Makes a folder with a copy of the picture `albedo` and a manifest that shows it as a sheet of
/// `size_mm`. Returns the manifest's path.
///
/// # Errors
/// If there is a manifest already, if the picture or size cannot be used, or if nothing can be
/// written; then no manifest is left behind.
pub fn create(folder: &Path, albedo: &Path, size_mm: [f64; 2]) -> Result<PathBuf, CreateError> {
    let manifest = folder.join(MANIFEST);
    if manifest.exists() {
        return Err(CreateError::Exists(manifest));
    }
    maps::probe(albedo)?;
    let name = albedo.file_name().and_then(|name| name.to_str());
    let name = name.ok_or_else(|| CreateError::Name(albedo.to_owned()))?;
    let text = starting_text(name, size_mm);
    super::check_shape(&text)?;
    let failed = |path: &Path| {
        let path = path.to_owned();
        |source| CreateError::Write { path, source }
    };
    fs::create_dir_all(folder).map_err(failed(folder))?;
    let copy = folder.join(name);
    // Copying a file onto itself would empty it.
    if !copy.exists() {
        fs::copy(albedo, &copy).map_err(failed(&copy))?;
    }
    let mut file = tempfile::NamedTempFile::new_in(folder).map_err(failed(&manifest))?;
    file.write_all(text.as_bytes()).map_err(failed(&manifest))?;
    Exhibit::parse(&manifest, folder, &text)?;
    file.persist_noclobber(&manifest)
        .map_err(|error| failed(&manifest)(error.error))?;
    Ok(manifest)
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
