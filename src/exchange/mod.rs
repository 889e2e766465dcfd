//! Exchange with other programs: what they write → an exhibit or a capture, and an exhibit → IIIF.
//!
//! | step | where |
//! |---|---|
//! | a file → what it is, and who reads it | [`import`] |
//! | PTM, HSH and Relight's planes → albedo and normals | `relightable` |
//! | `.lp` and `.dome` → a starting capture file | `lamps` |
//! | IIIF Presentation 3 ↔ exhibit | `iiif` |
//! | JSON that somebody else wrote | `json` |
//! | a folder, whole or not at all | `stage` |

mod error;
mod iiif;
mod json;
mod kind;
mod lamps;
mod relightable;
mod stage;

use std::path::{Path, PathBuf};

use crate::manifest::Fault;
pub use error::ExchangeError;
pub use iiif::{DEFAULT_BASE, Exported, IIIF_MANIFEST, export_iiif};
use kind::Kind;

/// The side of a pixel on the sheet in mm where nothing says it: 254 pixels per inch.
const ASSUMED_MM_PER_PX: f64 = 0.1;

/// What a file does not say and whoever imports it may know.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Known {
    /// Width and height in mm of what the pictures show, each > 0.
    pub size_mm: Option<[f64; 2]>,
    /// The folder of the photographs that belong to a file of lamps; without it, the file's own.
    pub photographs: Option<PathBuf>,
}

/// What came of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// The manifest or capture file that was written.
    pub file: PathBuf,
    /// True where it is a capture file, for `recto prepare`.
    pub is_capture: bool,
    /// What was assumed, or left out.
    pub warnings: Vec<Fault>,
}

/// Makes an exhibit or a capture file in the folder `out`, which may be yet to be made, of a file
/// of another program: PTM, HSH, Relight's `info.json` or `.dome`, `.lp`, or a IIIF manifest. A
/// folder stands for the `info.json` or `manifest.json` in it.
///
/// # Errors
/// All faults of the file at once, or the one of a picture or of the folder; then nothing is in
/// `out` that was not there before.
pub fn import(file: &Path, out: &Path, known: &Known) -> Result<Imported, ExchangeError> {
    let file = kind::inside(file);
    match Kind::of(&file)? {
        Kind::Ptm => relightable::import_ptm(&file, out, known),
        Kind::Hsh => relightable::import_hsh(&file, out, known),
        Kind::Relight(json) => relightable::import_relight(&file, &json, out, known),
        Kind::Lp => lamps::import_lp(&file, out, known),
        Kind::Dome(json) => lamps::import_dome(&file, &json, out, known),
        Kind::Iiif(json) => iiif::import(&file, &json, out, known),
    }
}
