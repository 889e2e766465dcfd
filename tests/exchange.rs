//! Exchange with other programs: files made here byte by byte, of surfaces that are known, and an
//! exhibit that goes out and comes back.

mod support;

#[path = "exchange/bad.rs"]
mod bad;
#[path = "exchange/iiif.rs"]
mod iiif;
#[path = "exchange/lamps.rs"]
mod lamps;
#[path = "exchange/relightable.rs"]
mod relightable;

use std::{
    fs,
    path::{Path, PathBuf},
};

use recto::{
    exchange::{self, ExchangeError, Imported, Known},
    manifest::Exhibit,
};
use tempfile::TempDir;

/// A folder with what another program wrote, and the place of what comes of it.
struct Desk {
    root: TempDir,
}

impl Desk {
    fn new() -> Self {
        let desk = Self {
            root: tempfile::tempdir().expect("a temporary folder"),
        };
        fs::create_dir(desk.folder()).expect("a folder");
        desk
    }

    fn folder(&self) -> PathBuf {
        self.root.path().join("in")
    }

    fn out(&self) -> PathBuf {
        self.root.path().join("out")
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.folder().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(&path, bytes).expect("written");
        path
    }

    fn import(&self, name: &str) -> Result<Imported, ExchangeError> {
        self.import_knowing(name, &Known::default())
    }

    fn import_knowing(&self, name: &str, known: &Known) -> Result<Imported, ExchangeError> {
        exchange::import(&self.folder().join(name), &self.out(), known)
    }

    /// The exhibit that comes of a file, and its warnings as text.
    fn exhibit(&self, name: &str, known: &Known) -> (Exhibit, String) {
        let imported = match self.import_knowing(name, known) {
            Ok(imported) => imported,
            Err(error) => panic!("{error}"),
        };
        assert_eq!(imported.file, self.out().join("exhibit.toml"));
        assert!(!imported.is_capture);
        let (exhibit, _) = Exhibit::read(&self.out()).expect("an exhibit");
        // Bodies of pictures too.
        exhibit.verify(exhibit.maps()).expect("sound pictures");
        for file in imported.warnings.iter().filter_map(|w| w.file.as_ref()) {
            assert!(file.is_file(), "{} is not there", file.display());
        }
        let warnings: Vec<String> = imported.warnings.iter().map(ToString::to_string).collect();
        (exhibit, warnings.join("\n"))
    }

    /// The words of a refusal, after which nothing is there that was not before.
    fn refusal(&self, name: &str) -> String {
        let error = self.import(name).expect_err("a refusal").to_string();
        let last = Path::new(name)
            .file_name()
            .expect("a name")
            .to_string_lossy();
        assert!(error.contains(&*last), "names no file: {error}");
        assert!(!self.out().exists(), "something was left after: {error}");
        error
    }
}
