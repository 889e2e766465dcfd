//! The width of a stroke, from the side's picture.

use glam::DVec2;

use super::{Desk, Note, Reading, ReadingError, Tool, Value, reading, words};
use crate::{
    colour::luminance,
    measure::{MeasureError, Measured, Section, stroke_width},
};

/// Cuts across the stroke, and the length of it over which they lie: a stroke of the pen is
/// straight for about so long.
const CUTS: usize = 24;
const SPREAD_MM: f64 = 1.0;

impl Desk<'_> {
    pub(super) fn stroke(
        &mut self,
        tool: &Tool,
        [from, to]: [DVec2; 2],
    ) -> Result<Reading, ReadingError> {
        let (map, picture) = self.albedo(self.scene.state)?;
        let across = to - from;
        let section = Section {
            middle: 0.5 * (from + to),
            across: if across == DVec2::ZERO {
                DVec2::X
            } else {
                across
            },
            length_mm: across.length(),
            cuts: CUTS,
            // No further along the stroke than the section is long, so that a short section
            // measures a short stroke.
            spread_mm: SPREAD_MM.min(across.length()),
        };
        let reflectance = |place| picture.colour_at(place).map_or(f64::NAN, luminance);
        let found = stroke_width(section, picture.pitch_mm(), reflectance).map_err(|error| {
            match error {
                // Of the picture beside the sheet, into which a cut may reach.
                MeasureError::NotFinite(_) => MeasureError::NoPaper,
                error => error,
            }
        })?;
        let width = Measured {
            value: found.width_um,
            sigma: found.sigma_um,
        };
        let words = format!(
            "stroke at {}: {} wide, {:.0}° off square to the section",
            words::at(section.middle),
            words::plus_minus(width, " µm"),
            found.oblique_deg.abs()
        );
        let mut notes = vec![Note::Stroke {
            file: self.name_of(&map.file),
            cuts: CUTS,
            spread_mm: section.spread_mm,
        }];
        notes.extend(self.source(&map.file));
        let values = vec![Value::new("width", width, "µm")];
        Ok(reading(tool, values, words, notes))
    }
}
