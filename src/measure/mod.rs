//! Measuring on a side: lengths, relief, the mould's lines, strokes and colour, in f64.
//!
//! Nothing here draws or reads files. Whoever measures passes places in mm in the side frame
//! (origin top left, x right, y down) and a function that samples a map there.
//!
//! | module | what it measures |
//! |---|---|
//! | [`length`] | ruler, polyline, area, angle, each with its standard uncertainty; scale bar |
//! | [`profile`](mod@profile) | relief along a line, its range and roughness |
//! | [`raster`] | an area of a map as grey values, cleaned of writing |
//! | [`spectrum`] | the power spectrum of such an area and its sharp peaks |
//! | [`lines`] | spacing and direction of laid and chain lines |
//! | [`comb`] | equally spaced marks in a row of values, which chain lines are |
//! | [`stroke`], `blur` | width of a stroke, without that of the pixels |
//! | [`probe`](mod@probe) | mean colour of a patch, and the difference of two |
//!
//! # Symbols
//! | symbol | meaning |
//! |---|---|
//! | `sigma` | standard uncertainty (1 σ), JCGM 100:2008 (GUM) |
//! | `z` | significance in standard deviations of the noise |
//! | `f` | spatial frequency in cycles per mm |
//!
//! Uncertainties propagate to first order (GUM, equation 10), so they hold where they are small
//! beside what is measured.

use glam::DVec2;

mod blur;
pub mod comb;
pub mod length;
pub mod lines;
pub mod probe;
pub mod profile;
pub mod raster;
pub mod spectrum;
pub mod stroke;

pub use length::{Accuracy, Measured, angle, area, polyline, ruler, scale_bar};
pub use lines::{Lines, Mould, NoLines, mould_lines};
pub use probe::{Patch, Probe, difference, probe};
pub use profile::{Profile, Relief, profile};
pub use raster::Raster;
pub use stroke::{Section, StrokeWidth, stroke_width};

/// How exactly that is known, where it is no matter of exactness that they are one place.
fn known_to(sigma_mm: f64) -> String {
    match sigma_mm > 0.0 {
        true => format!(" and known to {sigma_mm:.3} mm"),
        false => String::new(),
    }
}

/// Why something cannot be measured.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MeasureError {
    /// A number is NaN or infinite.
    #[error("{0} is not a finite number")]
    NotFinite(&'static str),
    /// A number that must lie within a range does not.
    #[error("{what} is {found}; it must be {allowed}")]
    Range {
        what: &'static str,
        found: f64,
        allowed: &'static str,
    },
    /// Too few or too many places or samples.
    #[error("{found} {what}: this needs {least} to {most}")]
    Count {
        what: &'static str,
        found: usize,
        least: usize,
        most: usize,
    },
    /// Two places that must differ are nearer to each other than they can be told apart.
    #[error(
        "places {} and {} are {distance_mm:.3} mm apart{}; set them further apart",
        first + 1,
        second + 1,
        known_to(*sigma_mm)
    )]
    OnePlace {
        first: usize,
        second: usize,
        distance_mm: f64,
        /// 0 where they are one place however well it is known.
        sigma_mm: f64,
    },
    /// An outline crosses or touches itself.
    #[error(
        "the outline crosses itself: side {} meets side {}; set its corners in order",
        first + 1,
        second + 1
    )]
    CrossesItself { first: usize, second: usize },
    /// An outline without an inside.
    #[error("the corners lie on one line and enclose no area")]
    NoArea,
    /// Nothing darker than the paper lies across the section.
    #[error(
        "no stroke here: the darkest place is {depth:.4} darker than the paper, whose own noise is {noise:.4}"
    )]
    NoStroke { depth: f64, noise: f64 },
    /// More than one stroke lies across the section.
    #[error("{0} strokes here; choose a section across one of them")]
    SeveralStrokes(usize),
    /// The stroke leaves no paper beside it to compare with.
    #[error(
        "no even paper at both ends of the section; lay it from bare paper to bare paper, and longer"
    )]
    NoPaper,
    /// The stroke runs too much along the section.
    #[error("the stroke runs {found_deg:.0}° off square to the section; turn the section by that")]
    Oblique { found_deg: f64 },
    /// Too much of a patch lies off the sheet.
    #[error(
        "the patch has {found} places on the sheet; this needs {needed}; make it larger than a few \
         pixels, or move it onto the sheet"
    )]
    OffSheet { found: usize, needed: usize },
}

/// A finite number.
fn finite(what: &'static str, value: f64) -> Result<f64, MeasureError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(MeasureError::NotFinite(what))
    }
}

/// A finite number above 0.
fn positive(what: &'static str, value: f64) -> Result<f64, MeasureError> {
    let found = finite(what, value)?;
    if found > 0.0 {
        return Ok(found);
    }
    Err(MeasureError::Range {
        what,
        found,
        allowed: "above 0",
    })
}

/// Places that are all finite, and as many as allowed.
fn places(found: &[DVec2], least: usize, most: usize) -> Result<(), MeasureError> {
    count("places", found.len(), least, most)?;
    if found.iter().all(|p| p.is_finite()) {
        Ok(())
    } else {
        Err(MeasureError::NotFinite("a place"))
    }
}

/// As many of something as allowed.
fn count(what: &'static str, found: usize, least: usize, most: usize) -> Result<(), MeasureError> {
    if (least..=most).contains(&found) {
        return Ok(());
    }
    Err(MeasureError::Count {
        what,
        found,
        least,
        most,
    })
}
