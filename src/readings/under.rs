//! What lies under a pointer.

use glam::DVec2;

use super::{Desk, Disc, ReadingError, pictures};
use crate::{
    colour::lab_from_linear,
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
    /// Where it is on the side, in mm.
    pub place_mm: DVec2,
    /// CIELAB under D65, where there is a picture.
    pub lab: Option<[f64; 3]>,
    /// ΔE00 between the two states that are compared.
    pub difference: Option<f64>,
    /// Of the overlays that are shown there.
    pub overlays: Vec<Overlaid>,
    /// Of every stack of bands on the side.
    pub curves: Vec<Curve>,
}

/// What one overlay says.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlaid {
    /// Without one, it is called by its id.
    pub title: Wording,
    pub id: String,
    /// `None` where it says nothing.
    pub says: Option<Says>,
}

/// As [`Read`], for longer than the exhibit is held.
#[derive(Clone, Debug, PartialEq)]
pub enum Says {
    /// The label of the category that lies there.
    Category(Wording),
    Quantity {
        value: f64,
        unit: String,
    },
    /// CIELAB.
    Colour([f64; 3]),
    /// Of a stack, linear sRGB.
    FalseColour([f64; 3]),
    /// Of reflectance.
    Difference(f64),
}

impl From<Read<'_>> for Says {
    fn from(read: Read) -> Self {
        match read {
            Read::Category(entry) => Self::Category(entry.label.clone()),
            Read::Quantity { value, unit } => Self::Quantity {
                value,
                unit: unit.to_owned(),
            },
            Read::Colour(linear_srgb) => Self::Colour(lab_from_linear(linear_srgb)),
            Read::FalseColour(linear_srgb) => Self::FalseColour(linear_srgb),
            Read::Difference(value) => Self::Difference(value),
        }
    }
}

/// How much of each wavelength a place reflects.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The stack's; without one, it is called by its id.
    pub title: Wording,
    pub id: String,
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
        let drawing = self.drawing();
        let lab = self.colour(place, self.scene.state)?;
        let mut difference = None;
        if let Some([first, second]) = self.compared_states()
            && let (Some(a), Some(b)) = (self.colour(place, first)?, self.colour(place, second)?)
        {
            difference = Some(measure::difference(&a, &b));
        }
        let mut overlays = Vec::new();
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
            overlays.push(Overlaid {
                title: overlay.title.clone(),
                id: overlay.id.clone(),
                says: reading.map(Says::from),
            });
        }
        let stacks = drawing.stacks.iter();
        let stacks = stacks.filter(|stack| stack.side == self.scene.side);
        let mut curve = |stack: &Stack| -> Result<Curve, ReadingError> {
            Ok(Curve {
                title: stack.title.clone(),
                id: stack.id.clone(),
                points: stack.curve(&mut self.rasters, place).map_err(unread)?,
            })
        };
        let curves = stacks
            .map(&mut curve)
            .collect::<Result<_, ReadingError>>()?;
        Ok(Under {
            place_mm: place,
            lab: lab.map(|probe| probe.lab),
            difference,
            overlays,
            curves,
        })
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
