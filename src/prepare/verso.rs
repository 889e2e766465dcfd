//! Where the verso's maps lie on the sheet: by its ink that shows through the recto, where that is
//! enough; else the photographs' own edges are taken for the sheet's.

use std::path::Path;

use glam::DVec2;

use super::{
    PrepareError,
    capture::Crop,
    reduced::{Reduced, step_to},
};
use crate::{
    manifest::{exhibit::FlipAxis, frames},
    maps::{
        ColourEncoding,
        registration::propose::{Grey, Mismatch, Proposal, control_points, recto_verso},
    },
};

/// How far, in mm, places of the verso may lie from where its photograph's edges have them.
pub const REACH_MM: f64 = 13.0;
/// Pixels along the longer side that are enough to see ink.
const LONGEST_PX: usize = 3600;

/// How a verso was put in its place.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// By ink that shows through.
    ByInk {
        /// The lines of a manifest that say so.
        lines: String,
        /// How many places agree.
        points: usize,
        /// How far they lie from one shift, turn and scale, as the root of the mean square, in mm.
        rms_mm: f64,
        /// How far the middle of the verso's photograph lies from the middle of the recto's, in mm
        /// to the right and down as seen from the verso.
        shift_mm: DVec2,
    },
    /// By the edges of its photographs.
    ByEdges(Mismatch),
}

impl Place {
    /// The lines of a manifest.
    pub(super) fn lines(&self) -> String {
        match self {
            Self::ByInk { lines, .. } => format!("{lines}\nfit = \"similarity\"\n"),
            Self::ByEdges(_) => "register = { flip = \"horizontal\" }\n".to_owned(),
        }
    }

    /// In words.
    pub fn told(&self) -> String {
        match self {
            Self::ByInk {
                points,
                rms_mm,
                shift_mm,
                ..
            } => format!(
                "measured: {points} places of ink that shows through agree to {rms_mm:.2} mm; its \
                 middle lies {:.2} mm to the right and {:.2} mm below that of its photograph",
                shift_mm.x, shift_mm.y
            ),
            Self::ByEdges(why) => format!(
                "assumed, the edges of its photographs are those of the sheet: too little ink shows \
                 through ({why}); `recto register` or control_points in exhibit.toml place it"
            ),
        }
    }
}

/// Places the verso of a folder of maps.
///
/// # Errors
/// Of maps that cannot be read.
pub(super) fn place(folder: &Path, mm_per_px: f64) -> Result<Place, PrepareError> {
    let [recto, verso] = ["recto", "verso"].map(|side| {
        folder
            .join(super::write::MAPS)
            .join(side)
            .join("albedo.png")
    });
    between(&recto, &verso, mm_per_px, ColourEncoding::Srgb, folder)
}

/// Places the picture of a verso, as photographed, by that of its recto, which covers the sheet;
/// both have pixels of `mm_per_px`.
///
/// # Errors
/// Of pictures that cannot be read.
pub fn between(
    recto: &Path,
    verso: &Path,
    mm_per_px: f64,
    encoding: ColourEncoding,
    scratch: &Path,
) -> Result<Place, PrepareError> {
    let read = |path: &Path| -> Result<(Grey, usize, DVec2), PrepareError> {
        let [right, bottom] = crate::maps::probe(path)?.size;
        let size = [right, bottom].map(|side| side as usize);
        let step = step_to(LONGEST_PX, size);
        let whole = Crop {
            left: 0,
            top: 0,
            right,
            bottom,
        };
        let small = Reduced::read(path, encoding, whole, step, scratch)?;
        let [_, green, _] = &small.planes;
        let grey = Grey {
            width: small.size[0],
            height: small.size[1],
            values: green.iter().map(|v| v.max(0.0).sqrt()).collect(),
            mm_per_px: mm_per_px * step as f64,
        };
        let size_mm = DVec2::new(f64::from(right), f64::from(bottom)) * mm_per_px;
        Ok((grey, step, size_mm))
    };
    let (recto, _, sheet_mm) = read(recto)?;
    let (verso, step, verso_mm) = read(verso)?;
    Ok(match recto_verso(&recto, &verso, REACH_MM) {
        Proposal::DoesNotMatch { why, .. } => Place::ByEdges(why),
        Proposal::Matches {
            points,
            fit,
            rms_mm,
        } => {
            let turned = |mm: DVec2| frames::other_side(mm, sheet_mm, FlipAxis::Vertical);
            let placed = points
                .iter()
                .map(|point| (point.px * step as f64, turned(point.mm)));
            let middle_px = verso_mm / 2.0 / verso.mm_per_px;
            let of_middle = fit.px_from_mm.inverse().transform_point2(middle_px);
            Place::ByInk {
                lines: control_points(placed),
                points: points.len(),
                rms_mm,
                shift_mm: turned(of_middle) - verso_mm / 2.0,
            }
        }
    })
}
