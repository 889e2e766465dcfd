//! IIIF Presentation 3 ↔ exhibits (<https://iiif.io/api/presentation/3.0/>).
//!
//! | an exhibit has | IIIF has |
//! |---|---|
//! | a side of a drawing | a canvas, its `id` ending in `canvas/DRAWING/recto` or `…/verso` |
//! | albedo, states, bands, overlays | the items of a choice, which paints the canvas |
//! | the sheet's size in mm | a Physical Dimensions service of the canvas, and `Size` in its metadata |
//! | hotspots | annotations with an outline in SVG |
//! | credit | `requiredStatement`, and `rights` where it names a licence by its address |
//! | title, caption, date, inventory number | label, summary, metadata |
//!
//! | step | where |
//! |---|---|
//! | exhibit → manifest and pictures beside it | [`export`] |
//! | a map of an exhibit → a picture that browsers show | [`pictures`] |
//! | manifest → canvases | [`read`] |
//! | outlines in SVG and fragments ↔ places | [`outline`] |
//! | ids → files beside the manifest | [`resolve`] |
//! | canvases → sheets with a size, and what pictures show | [`sheet`] |
//! | sheets → an exhibit | [`starting`] |
//! | language maps ↔ wordings | [`words`] |

mod export;
mod outline;
mod pictures;
mod read;
mod resolve;
mod sheet;
mod starting;
mod words;

pub use export::{DEFAULT_BASE, Exported, export_iiif};
pub(super) use starting::import;

/// The usual name of a manifest.
pub const IIIF_MANIFEST: &str = "manifest.json";
/// The folder of pictures, beside the manifest or the exhibit's.
const IMAGES: &str = "images";
/// The physical dimensions of a canvas (<https://iiif.io/api/annex/services/#physical-dimensions>).
const PHYSDIM: &str = "http://iiif.io/api/annex/services/physdim";

/// What a picture of a side is, as its path says: `images/DRAWING/SIDE/albedo.png`,
/// `…/state/ID.png`, `…/band/STACK/NM.png`, `…/overlay/ID.png`.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Role {
    Albedo,
    State(String),
    Band(String, String),
    Overlay(String),
}

impl Role {
    /// The path within the folder of a side, without an extension.
    fn path(&self) -> String {
        match self {
            Self::Albedo => "albedo".to_owned(),
            Self::State(id) => format!("state/{id}"),
            Self::Band(stack, nm) => format!("band/{stack}/{nm}"),
            Self::Overlay(id) => format!("overlay/{id}"),
        }
    }

    /// The role that a path with an extension ends in, if it is one of these.
    fn of(path: &str) -> Option<Self> {
        let bare = path.rsplit_once('.').map_or(path, |(bare, _)| bare);
        let parts: Vec<&str> = bare.split('/').collect();
        match parts[..] {
            [.., "band", stack, nm] => Some(Self::Band(stack.to_owned(), nm.to_owned())),
            [.., "state", id] => Some(Self::State(id.to_owned())),
            [.., "overlay", id] => Some(Self::Overlay(id.to_owned())),
            [.., "albedo"] => Some(Self::Albedo),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_role_is_read_from_its_path() {
        let roles = [
            Role::Albedo,
            Role::State("before-1998".to_owned()),
            Role::Band("bands".to_owned(), "700.5".to_owned()),
            Role::Overlay("infrared".to_owned()),
        ];
        for role in roles {
            let path = format!("images/sheet/recto/{}.png", role.path());
            assert_eq!(Role::of(&path), Some(role));
        }
        assert_eq!(Role::of("scans/12.jpg"), None);
    }
}
