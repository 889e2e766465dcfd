//! Manifests from end to end: sound ones become exhibits, every broken one gets its own words,
//! from the library and from the program alike, and the published schema agrees with the parser.

#[path = "manifests/broken.rs"]
mod broken;
#[path = "manifests/pictures.rs"]
mod pictures;
#[cfg(unix)]
#[path = "manifests/saving.rs"]
mod saving;
#[path = "manifests/schema.rs"]
mod schema;
#[path = "manifests/sound.rs"]
mod sound;

use std::{fs, path::PathBuf};

use tempfile::TempDir;

/// A folder for manifests, with pictures to name in them.
struct Folder {
    exhibit: PathBuf,
    // Removed when the last of it is dropped.
    _root: TempDir,
}

impl Folder {
    fn new() -> Self {
        let root = tempfile::tempdir().unwrap();
        let exhibit = root.path().join("exhibit");
        let outside = root.path().join("outside");
        fs::create_dir(&exhibit).unwrap();
        fs::create_dir(&outside).unwrap();
        pictures::write(&exhibit, &outside);
        Self {
            exhibit,
            _root: root,
        }
    }

    fn with(manifest: impl AsRef<[u8]>) -> Self {
        let folder = Self::new();
        folder.write(manifest);
        folder
    }

    fn write(&self, manifest: impl AsRef<[u8]>) {
        fs::write(self.exhibit.join("exhibit.toml"), manifest).unwrap();
    }

    /// A message without the folder's own path, which differs from run to run.
    fn relative(&self, message: &str) -> String {
        message.replace(&format!("{}/", self.exhibit.display()), "")
    }
}
