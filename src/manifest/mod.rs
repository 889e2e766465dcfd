//! The exhibit manifest: what a curator wrote, read, checked once, and told back in plain words
//! where it is wrong.
//!
//! | step | where |
//! |---|---|
//! | text → tree with the place of every key | `document` |
//! | tree → plain data, every key declared once | `decode`, [`raw`] |
//! | the same declarations → JSON Schema | [`schema()`] |
//! | plain data → [`Exhibit`], with files, references and units | `validate` |
//! | what is wrong, where, and what to do | [`Fault`], [`Faults`] |
//! | a hotspot's outline, and what lies inside it | [`hotspot`] |
//! | a photograph → which of its pixels no sheet gives back | [`capture`] |
//! | a starting manifest from one picture | [`create`] |
//! | schema and shape of every file that people write | `shape` |
//! | a folder that a command fills whole or not at all | [`staging`] |
//! | which version of a published exhibit is shown | [`published`] |
//! | a lamp or camera in one line | `overrides::spec` |
//! | what lies over a side, as one picture each | [`Scene::laid`], [`Overlay::load`] |
//! | what overlays and stacks say at one place | [`readout`] |
//! | a scene changed by options of a command | [`overrides`] |
//! | a scene → the manifest's own text | [`Draft`] |
//! | a scene ↔ a word to pass on | [`Link`] |

pub mod capture;
pub mod comparison;
mod create;
pub(crate) mod decode;
pub(crate) mod document;
pub mod exhibit;
pub mod eye;
pub(crate) mod fault;
pub mod frames;
pub mod hotspot;
pub mod lighting;
mod link;
pub(crate) mod macros;
mod overlay;
pub mod overrides;
pub mod published;
mod query;
pub mod raw;
pub mod readout;
mod save;
mod schema;
pub(crate) mod shape;
pub mod staging;
pub mod surface;
mod validate;

use std::path::Path;

pub use create::{CreateError, create};
pub use decode::{Brief, Dictionary, List, OfKind, OneOrMany, Pattern};
pub use document::{Fingerprint, MANIFEST};
pub use exhibit::*;
pub use fault::{Fault, Faults, Place, Severity, did_you_mean, nearest, one, quote, quoted_list};
pub use link::Link;
pub use save::{Draft, SaveAs, SaveError};
pub use schema::schema;
pub(crate) use validate::normalised;

use decode::{Decode, Node, Report};
use document::Document;
use raw::RawManifest;

impl Exhibit {
    /// Reads the exhibit of a folder, or of a manifest by any name, or the version that a folder
    /// of published ones shows, and checks everything but
    /// the pixels of its pictures, of which only the headers are looked at
    /// (see [`Exhibit::verify`]). Returns it with its warnings.
    ///
    /// # Errors
    /// All faults, warnings included, in the order of their places.
    pub fn read(path: &Path) -> Result<(Self, Vec<Fault>), Faults> {
        Self::read_with(path, None)
    }

    /// As [`Self::read`], with the scene of a link behind its own.
    ///
    /// # Errors
    /// As [`Self::read`]; those of the link have no place.
    pub fn read_with(path: &Path, link: Option<&Link>) -> Result<(Self, Vec<Fault>), Faults> {
        // Followed once: what is read here is of one version.
        let version = published::current(path);
        let manifest = document::manifest_path(version.as_deref().unwrap_or(path));
        let text = document::read_text(&manifest)?;
        let folder = manifest.parent().unwrap_or(Path::new(""));
        // The folder of a bare file name is the current one.
        let folder = if folder.as_os_str().is_empty() {
            Path::new(".")
        } else {
            folder
        };
        let (mut exhibit, warnings) = Self::parse_with(&manifest, folder, &text, link)?;
        exhibit.published = version.map(|_| path.to_owned());
        Ok((exhibit, warnings))
    }

    fn parse(manifest: &Path, folder: &Path, text: &str) -> Result<(Self, Vec<Fault>), Faults> {
        Self::parse_with(manifest, folder, text, None)
    }

    fn parse_with(
        manifest: &Path,
        folder: &Path,
        text: &str,
        link: Option<&Link>,
    ) -> Result<(Self, Vec<Fault>), Faults> {
        let document = Document::parse(manifest, text)?;
        let mut report = Report::new(&document);
        let mut raw = RawManifest::decode(&Node::root(&document), &mut report);
        if let (Some(raw), Some(link)) = (&mut raw, link) {
            link.join(raw);
        }
        let raw = raw.as_ref();
        let exhibit = raw.and_then(|raw| validate::exhibit(raw, manifest, folder, &mut report));
        let mut faults = report.into_faults();
        if let (Some(raw), Some(_)) = (raw, link) {
            faults = Link::blamed(raw, faults);
        }
        fault::sort(&mut faults);
        match exhibit {
            Some(mut exhibit)
                if faults
                    .iter()
                    .all(|fault| fault.severity == Severity::Warning) =>
            {
                exhibit.fingerprint = Fingerprint::of(text);
                exhibit.link = link.cloned();
                Ok((exhibit, faults))
            }
            _ => Err(Faults::new(faults)
                .unwrap_or_else(|| shape::unexplained(manifest, "an exhibit").into())),
        }
    }
}

/// Checks keys, types, ranges and words of a manifest's text, which is what [`schema()`]
/// describes, and touches no file.
///
/// # Errors
/// All faults of syntax, or else of shape.
pub fn check_shape(text: &str) -> Result<(), Faults> {
    shape::check::<RawManifest>(MANIFEST, text)
}
