//! The installation: the place where exhibits are shown, as `installation.toml` says it, read,
//! checked once, and told back in plain words where it is wrong.
//!
//! | step | where |
//! |---|---|
//! | text → plain data, every key declared once | [`raw`], by the machinery of [`manifest`](crate::manifest) |
//! | the same declarations → JSON Schema | [`schema()`] |
//! | plain data → [`Installation`] | `validate` |
//! | displays on the wall and on the desktop, and where hands reach | [`wall`] |
//! | which machine carries which of them, and who leads | [`machines`] |
//! | colours meant → values of a display | [`profile`] |
//! | when the screens are lit | [`hours`] |
//! | whose turn it is | [`exhibits`] |
//! | how texts and controls look, and when they go | [`interface`] |
//! | who may leave | [`staff`] |

pub mod exhibits;
pub mod hours;
pub mod interface;
pub mod machines;
pub mod profile;
pub mod raw;
pub mod staff;
mod validate;
pub mod values;
pub mod wall;

use std::{
    net::SocketAddr,
    path::{Path, PathBuf},
};

use serde_json::Value;

pub use exhibits::{Every, Exhibits};
pub use hours::{Closed, Hours, Span};
pub use interface::{Contrast, Idle, Interface};
pub use machines::{Machine, Machines};
pub use profile::{Correction, Profile, Tone};
pub use staff::Pin;
pub use wall::{Display, Pane, PixelRect, Reach, Rect, Wall, WallWindow, Windows};

use crate::manifest::{
    Accuracy, Fault, Faults, Severity,
    decode::{Decode, Node, Report},
    document::{Document, read_text_of},
    fault,
    shape::{self, schema_of},
};
use raw::RawInstallation;

/// The file name of an installation.
pub const INSTALLATION: &str = "installation.toml";

/// What an installation is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// A desk, or a check.
    Desk,
    /// A public wall, which nobody leaves without a PIN.
    Kiosk,
}

/// An `installation.toml`, validated.
#[derive(Clone, Debug, PartialEq)]
pub struct Installation {
    /// The file's own path, as faults name it.
    pub file: PathBuf,
    pub exhibits: Exhibits,
    /// BCP 47 tags, the first of which everything returns to; empty where each exhibit's own are
    /// offered.
    pub languages: Vec<String>,
    /// `None` where no display is described: the one that there is, as the system says it is.
    pub wall: Option<Wall>,
    /// `None` where one machine carries the wall alone.
    pub machines: Option<Machines>,
    pub reach: Reach,
    pub idle: Idle,
    pub hours: Hours,
    pub accuracy: PlaceAccuracy,
    pub interface: Interface,
    /// `None` where nothing is written down.
    pub logs: Option<Logs>,
    /// Where the status page is read; `None` where there is none.
    pub status: Option<SocketAddr>,
    /// Always there for [`Use::Kiosk`].
    pub pin: Option<Pin>,
}

/// What this place asks for instead of what each exhibit does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlaceAccuracy {
    /// ΔE00.
    pub max_delta_e: Option<f64>,
    /// ms for one frame while something moves.
    pub frame_ms: Option<f64>,
}

impl PlaceAccuracy {
    /// What is asked for of an exhibit that asks for `own`.
    pub fn over(&self, own: &Accuracy) -> Accuracy {
        Accuracy {
            max_delta_e: self.max_delta_e.unwrap_or(own.max_delta_e),
            frame_ms: self.frame_ms.unwrap_or(own.frame_ms),
        }
    }
}

/// What is written down.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Logs {
    /// May be yet to be made.
    pub folder: PathBuf,
    /// How large one file may be.
    pub max_bytes: u64,
    /// How many files are kept, at least one.
    pub keep: usize,
    /// Whether scenes and languages are counted there.
    pub usage_counts: bool,
}

impl Installation {
    /// Reads an installation file, or that of a folder, for a desk or a check. Of the exhibits it
    /// looks only whether they are there. Returns it with its warnings.
    ///
    /// # Errors
    /// All faults, warnings included, in the order of their places.
    pub fn read(path: &Path) -> Result<(Self, Vec<Fault>), Faults> {
        Self::read_for(path, Use::Desk)
    }

    /// As [`Self::read`], for a use.
    ///
    /// # Errors
    /// As [`Self::read`], and where a kiosk has no PIN.
    pub fn read_for(path: &Path, used: Use) -> Result<(Self, Vec<Fault>), Faults> {
        let file = match path.is_dir() {
            true => path.join(INSTALLATION),
            false => path.to_owned(),
        };
        let allowed = "an installation file";
        let remedy = "check the path, or begin with a copy of exhibits/installation.toml";
        let text = read_text_of(&file, allowed, remedy)?;
        let document = Document::parse(&file, &text)?;
        let mut report = Report::new(&document);
        let raw = RawInstallation::decode(&Node::root(&document), &mut report);
        let installation =
            raw.and_then(|raw| validate::installation(&raw, &file, used, &mut report));
        let mut faults = report.into_faults();
        fault::sort(&mut faults);
        let sound = faults
            .iter()
            .all(|fault| fault.severity == Severity::Warning);
        match installation {
            Some(installation) if sound => Ok((installation, faults)),
            _ => Err(Faults::new(faults)
                .unwrap_or_else(|| shape::unexplained(&file, "an installation").into())),
        }
    }
}

/// The schema that `recto schema --installation` prints.
pub fn schema() -> Value {
    schema_of::<RawInstallation>()
}

/// Checks keys, types, ranges and words of an installation's text, which is what [`schema()`]
/// describes, and touches no file.
///
/// # Errors
/// All faults of syntax, or else of shape.
pub fn check_shape(text: &str) -> Result<(), Faults> {
    shape::check::<RawInstallation>(INSTALLATION, text)
}
