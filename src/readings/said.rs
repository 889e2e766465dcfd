//! What is said beside values: what else is to be known of a reading, and why there is none. Files and
//! terminals have it in English, which is here; a window has words for each of it in every language.

use std::fmt;

use serde::{Serialize, Serializer};

use super::ReadingError;
use crate::{
    manifest::exhibit::{SideName, Source},
    measure::{MeasureError, NoLines},
};

/// What else is to be known: what was assumed, what is not in the uncertainty. Files are named as the
/// manifest gives them.
#[derive(Clone, Debug, PartialEq)]
pub enum Note {
    /// How exactly a picture lies on the sheet is not known.
    Unregistered { file: String },
    /// A map is fitted or assumed.
    NotMeasured { file: String, source: Source },
    /// Places are seen in no picture.
    NoPicture {
        side: SideName,
        /// They were pointed at on a screen, and not given in mm.
        pointed: bool,
    },
    /// From what the width of a stroke was read.
    Stroke {
        file: String,
        cuts: usize,
        spread_mm: f64,
    },
    /// From what the mould's lines were read.
    Lines { file: String },
    /// Whose colours they are.
    Colours { file: String },
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unregistered { file } => write!(
                f,
                "how exactly {file} lies on the sheet is not known, and not in the uncertainty"
            ),
            Self::NotMeasured { file, source } => {
                let how = match source {
                    Source::Measured => "measured",
                    Source::Fitted => "fitted, not measured",
                    Source::Assumed => "assumed, not measured",
                };
                write!(f, "{file} is {how}: the uncertainty is that of reading it")
            }
            Self::NoPicture {
                side,
                pointed: true,
            } => write!(
                f,
                "the {} has no picture: the uncertainty is that of pointing at the screen alone",
                side.word()
            ),
            Self::NoPicture { side, .. } => write!(
                f,
                "the {} has no picture in which places are read: how exactly they are known is not known",
                side.word()
            ),
            Self::Stroke {
                file,
                cuts,
                spread_mm,
            } => write!(
                f,
                "read from {file} at half depth, by {cuts} cuts over {spread_mm:.1} mm of the stroke; a \
                 soft edge counts as drawn"
            ),
            Self::Lines { file } => write!(
                f,
                "read from {file}, whose scale is not in the uncertainty; directions are counted from the \
                 horizontal, clockwise as seen"
            ),
            Self::Colours { file } => write!(
                f,
                "colours are those of {file} under D65, whatever lamp is lit"
            ),
        }
    }
}

impl Serialize for Note {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Why there is no reading, or no value, as far as whoever measures can do something about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Why {
    OffSheet,
    TooWide,
    NoPicture,
    NoHeight,
    /// A map cannot be read.
    Unreadable,
    /// The drawing or the state that it was laid on is there no more.
    Gone,
    OnePlace,
    CrossesItself,
    NoArea,
    NoStroke,
    SeveralStrokes(usize),
    NoPaper,
    /// By so many degrees off square.
    Oblique(f64),
    /// Too little of it lies on the sheet.
    TooLittle,
    /// The picture does not resolve the lines.
    Coarse,
    Small,
    /// Hardly any bare paper.
    Covered,
    /// No lines stand out.
    Faint,
    /// There is nothing to measure.
    Nothing,
}

impl From<&ReadingError> for Why {
    fn from(error: &ReadingError) -> Self {
        match error {
            ReadingError::OffSheet { .. } => Self::OffSheet,
            ReadingError::TooWide { .. } => Self::TooWide,
            ReadingError::NoPicture { .. } => Self::NoPicture,
            ReadingError::NoHeight { .. } => Self::NoHeight,
            ReadingError::Map { .. } => Self::Unreadable,
            ReadingError::Measure(error) => match error {
                MeasureError::OnePlace { .. } => Self::OnePlace,
                MeasureError::CrossesItself { .. } => Self::CrossesItself,
                MeasureError::NoArea => Self::NoArea,
                MeasureError::NoStroke { .. } => Self::NoStroke,
                MeasureError::SeveralStrokes(count) => Self::SeveralStrokes(*count),
                MeasureError::NoPaper => Self::NoPaper,
                MeasureError::Oblique { found_deg } => Self::Oblique(*found_deg),
                MeasureError::OffSheet { .. } => Self::TooLittle,
                MeasureError::NotFinite(_)
                | MeasureError::Range { .. }
                | MeasureError::Count { .. } => Self::Nothing,
            },
        }
    }
}

impl From<NoLines> for Why {
    fn from(why: NoLines) -> Self {
        match why {
            NoLines::Coarse(_) => Self::Coarse,
            NoLines::Small { .. } => Self::Small,
            NoLines::Covered(_) => Self::Covered,
            NoLines::Faint { .. } | NoLines::NoLaid | NoLines::Uneven(_) | NoLines::Finer(_) => {
                Self::Faint
            }
        }
    }
}
