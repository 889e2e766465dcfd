//! What lies under a pointer.

use glam::DVec2;

use super::{Desk, Disc, ReadingError, pictures, words};
use crate::{
    manifest::{
        Wording,
        exhibit::{Member, OverlayKind, Stack},
        readout::{CurvePoint, ReadFault, Reading as Read},
    },
    measure::{self, Probe},
};

/// Radius in mm of the colour that is said: a place, and not the grain of one pixel.
const PLACE_MM: f64 = 0.5;

/// What a place of a side is, says and reflects.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Under {
    /// A line for the place with its colour, and one for each overlay that is shown there.
    pub lines: Vec<String>,
    /// Of every stack of bands on the side.
    pub curves: Vec<Curve>,
}

/// How much of each wavelength a place reflects.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The stack's title, or else its id.
    pub title: String,
    pub points: Vec<CurvePoint>,
}

impl Desk<'_> {
    /// What lies at a place of the side, in mm from its left and top edges: of overlays, those that
    /// the scene shows.
    ///
    /// # Errors
    /// The first map that cannot be read.
    pub fn under(&mut self, place: DVec2) -> Result<Under, ReadingError> {
        let unread = |fault: ReadFault| ReadingError::Map {
            path: fault.path,
            error: fault.error,
        };
        let (exhibit, drawing) = (self.exhibit, self.drawing());
        let language = self.scene.language.clone().unwrap_or_default();
        let say = |wording: &Wording| {
            exhibit
                .text(wording, &language)
                .unwrap_or_default()
                .to_owned()
        };
        let titled = |title: &Wording, id: &str| match say(title) {
            title if title.is_empty() => id.to_owned(),
            title => title,
        };
        let mut lines = vec![format!("{} mm", words::at(place))];
        if let Some(colour) = self.colour(place, self.scene.state)? {
            let [l, a, b] = colour.lab;
            lines[0] += &format!(" · L* {l:.1}, a* {a:.1}, b* {b:.1}");
        }
        if let Some([first, second]) = self.compared_states()
            && let (Some(a), Some(b)) = (self.colour(place, first)?, self.colour(place, second)?)
        {
            lines.push(format!("ΔE00 {:.1}", measure::difference(&a, &b)));
        }
        for (index, opacity) in self.scene.overlays.clone() {
            let overlay = &drawing.overlays[index];
            if opacity <= 0.0 || overlay.side != self.scene.side {
                continue;
            }
            let reading = overlay.reading(&mut self.rasters, place).map_err(unread)?;
            // A category that is switched off is not there.
            let alone = self.scene.categories.get(&index);
            let reading = reading.filter(|reading| match (reading, &overlay.kind, alone) {
                (Read::Category(entry), OverlayKind::Categorical(entries), Some(alone)) => {
                    let place = entries
                        .iter()
                        .position(|other| other.colour == entry.colour);
                    place.is_some_and(|place| alone.contains(&place))
                }
                _ => true,
            });
            let said = reading.map_or_else(|| "nothing".to_owned(), |reading| reading.words(say));
            lines.push(format!("{}: {said}", titled(&overlay.title, &overlay.id)));
        }
        let stacks = drawing.stacks.iter();
        let stacks = stacks.filter(|stack| stack.side == self.scene.side);
        let mut curve = |stack: &Stack| -> Result<Curve, ReadingError> {
            let points = stack.curve(&mut self.rasters, place).map_err(unread)?;
            let title = titled(&stack.title, &stack.id);
            Ok(Curve { title, points })
        };
        let curves = stacks
            .map(&mut curve)
            .collect::<Result<_, ReadingError>>()?;
        Ok(Under { lines, curves })
    }

    /// The states of the comparison, if it is of two.
    fn compared_states(&self) -> Option<[Option<usize>; 2]> {
        match self.scene.compare.as_ref()?.of[..] {
            [Member::State(first), Member::State(second)] => Some([first, second]),
            _ => None,
        }
    }

    /// The colour about a place in a state; `None` where there is none.
    fn colour(
        &mut self,
        place: DVec2,
        state: Option<usize>,
    ) -> Result<Option<Probe>, ReadingError> {
        let Some(side) = self.side(state) else {
            return Ok(None);
        };
        let pixel_mm = pictures::pixel_mm(&side.albedo.file).max_element();
        let disc = Disc {
            middle: place,
            // Of a coarse picture, some pixels.
            radius_mm: PLACE_MM.max(2.0 * pixel_mm),
        };
        match self.probed(disc, state) {
            Ok((probe, _)) => Ok(Some(probe)),
            Err(ReadingError::Measure(_)) => Ok(None),
            Err(error) => Err(error),
        }
    }
}
