//! What is measured on a side of an exhibit: a tool laid on places of the side gives a reading with
//! values, units and uncertainties. The command line and a window both measure through this.
//!
//! | step | where |
//! |---|---|
//! | pixel of a picture → place on the side | [`sight`] |
//! | places → pictures that lie there, sampled | `pictures` |
//! | tool → [`Reading`] | [`Desk::read`] |
//! | a profile → a plot | [`plot`] |
//! | readings → a table | [`table`] |
//! | a place → what overlays and stacks say there | [`Desk::under`] |
//! | what is to be known beside values, and why there are none | [`Note`], [`Why`] |
//!
//! Places are in mm in the side frame of the side that is seen: from the top left corner, x right,
//! y down. Uncertainties are standard ones (1 σ), see [`crate::measure`]. What is measured is what
//! the maps say of the sheet, never what a lamp or an enhancement makes of them.

mod colour;
mod lines;
mod pictures;
pub mod plot;
mod relief;
mod said;
pub mod sight;
mod stroke;
pub mod table;
mod under;
mod words;

use std::path::PathBuf;

use glam::DVec2;
use serde::Serialize;

use crate::{
    manifest::{
        Drawing, Exhibit, Scene, Side,
        exhibit::{MapFile, SideName, Source},
    },
    maps::{MapError, Rasters},
    measure::{self, Accuracy, MeasureError, Measured, NoLines, profile::Relief},
};
use pictures::Pictures;
pub use pictures::registration_mm;
pub use said::{Note, Why};
pub use under::{Curve, Overlaid, Says, Under};
pub use words::decimals;
use words::{at, plus_minus};

/// Radius of a probe where none is given, in mm: what a spectrophotometer sees.
pub const PROBE_MM: f64 = 2.0;

/// What is laid on the side.
#[derive(Clone, Debug, PartialEq)]
pub enum Tool {
    /// The distance of two places.
    Ruler([DVec2; 2]),
    /// The length of a line through places; closed, also the area within.
    Path { places: Vec<DVec2>, closed: bool },
    /// The angle at the second place.
    Angle([DVec2; 3]),
    /// The relief along a line.
    Profile([DVec2; 2]),
    /// The mould's lines in an upright rectangle between two opposite corners.
    Lines([DVec2; 2]),
    /// The width of the stroke that a section crosses, from paper to paper.
    Stroke([DVec2; 2]),
    /// The mean colour of a disc.
    Probe(Disc),
    /// The difference of the mean colours of two discs.
    Difference([Disc; 2]),
    /// The difference of a disc's mean colour from that in another state, by its index.
    Against(Disc, Option<usize>),
}

/// A round patch, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    pub middle: DVec2,
    pub radius_mm: f64,
}

impl Tool {
    /// Its name on the command line.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Ruler(_) => "ruler",
            Self::Path { .. } => "path",
            Self::Angle(_) => "angle",
            Self::Profile(_) => "profile",
            Self::Lines(_) => "lines",
            Self::Stroke(_) => "stroke",
            Self::Probe(_) | Self::Difference(_) | Self::Against(..) => "probe",
        }
    }

    fn discs(&self) -> Vec<Disc> {
        match self {
            Self::Probe(disc) | Self::Against(disc, _) => vec![*disc],
            Self::Difference(two) => two.to_vec(),
            _ => Vec::new(),
        }
    }

    fn places(&self) -> Vec<DVec2> {
        match self {
            Self::Ruler(two) | Self::Profile(two) | Self::Lines(two) | Self::Stroke(two) => {
                two.to_vec()
            }
            Self::Path { places, .. } => places.clone(),
            Self::Angle(three) => three.to_vec(),
            Self::Probe(disc) | Self::Against(disc, _) => vec![disc.middle],
            Self::Difference(two) => two.map(|disc| disc.middle).to_vec(),
        }
    }
}

/// One quantity that was read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Value {
    /// Its name, in words.
    pub quantity: &'static str,
    /// `None` where there is none, such as the spacing of lines that are not there.
    pub value: Option<f64>,
    /// Standard uncertainty, in the same unit, where it is known.
    pub sigma: Option<f64>,
    /// Empty for a pure number.
    pub unit: &'static str,
    /// Standard deviation of the single places, where the value is a mean.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spread: Option<f64>,
    /// How many places the mean is of.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub count: Option<usize>,
    /// Why there is no value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub none: Option<String>,
    /// The same in short.
    #[serde(skip)]
    pub why: Option<Why>,
}

impl Value {
    fn new(
        quantity: &'static str,
        Measured { value, sigma }: Measured,
        unit: &'static str,
    ) -> Self {
        Self {
            quantity,
            value: Some(value),
            sigma: Some(sigma),
            unit,
            spread: None,
            count: None,
            none: None,
            why: None,
        }
    }

    /// As people read it, with its uncertainty: `12.34 ± 0.05 mm`.
    pub fn words(&self) -> String {
        let space = if matches!(self.unit, "" | "°") {
            ""
        } else {
            " "
        };
        match (self.value, self.sigma) {
            (Some(value), Some(sigma)) => {
                plus_minus(Measured { value, sigma }, &format!("{space}{}", self.unit))
            }
            (Some(value), None) => format!("{value}{space}{}", self.unit),
            (None, _) => "none".to_owned(),
        }
    }

    /// Of places that are as `accuracy` says; without an uncertainty where it says nothing.
    fn as_known(
        quantity: &'static str,
        measured: Measured,
        unit: &'static str,
        accuracy: Accuracy,
    ) -> Self {
        let value = Self::new(quantity, measured, unit);
        Self {
            sigma: value.sigma.filter(|_| is_known(accuracy)),
            ..value
        }
    }

    fn none(quantity: &'static str, unit: &'static str, why: NoLines) -> Self {
        Self {
            quantity,
            value: None,
            sigma: None,
            unit,
            spread: None,
            count: None,
            none: Some(why.to_string()),
            why: Some(why.into()),
        }
    }
}

/// What a tool read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reading {
    pub tool: &'static str,
    /// On which side of which drawing in which state, by their ids.
    pub drawing: String,
    pub side: SideName,
    pub state: Option<String>,
    /// Where it lay, in mm on the side.
    pub places_mm: Vec<[f64; 2]>,
    pub values: Vec<Value>,
    /// All of it in one line, with its uncertainty.
    pub words: String,
    /// What else is to be known: what was assumed, what is not in the uncertainty.
    pub notes: Vec<Note>,
    /// Of a profile only.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub samples: Vec<Sample>,
}

/// The relief at one place of a profile.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sample {
    /// From the start of the line, in mm.
    pub s_mm: f64,
    /// Towards the viewer of the side, in µm.
    pub z_um: f64,
    /// Standard uncertainty of the height, in µm.
    pub sigma_um: f64,
}

/// Why there is no reading.
#[derive(Debug, thiserror::Error)]
pub enum ReadingError {
    #[error("{}, off the sheet", at(*place))]
    OffSheet { place: DVec2, size_mm: DVec2 },
    #[error("a radius of {radius_mm} mm, wider than the sheet")]
    TooWide { radius_mm: f64, size_mm: DVec2 },
    #[error("a {side} without a picture{in_state}", side = side.word())]
    NoPicture { side: SideName, in_state: String },
    #[error("a {side} without a height map{in_state}", side = side.word())]
    NoHeight { side: SideName, in_state: String },
    #[error("{error}")]
    Map { path: PathBuf, error: MapError },
    #[error(transparent)]
    Measure(#[from] MeasureError),
}

impl ReadingError {
    /// What is allowed and what to do.
    pub fn remedy(&self) -> (String, &'static str) {
        match self {
            Self::OffSheet { size_mm, .. } => (
                format!("0 to {} across, 0 to {} down", size_mm.x, size_mm.y),
                "count mm from the top left corner of the side that is seen",
            ),
            Self::TooWide { size_mm, .. } => (
                format!("a radius of up to {} mm", size_mm.max_element() / 2.0),
                "give the radius in mm",
            ),
            Self::NoPicture { .. } => (
                String::new(),
                "add albedo to it, or choose another side or state",
            ),
            Self::NoHeight { .. } => (
                String::new(),
                "add height to it, or choose another side or state",
            ),
            Self::Map { .. } | Self::Measure(_) => (String::new(), ""),
        }
    }
}

/// Where a side of an exhibit is measured; maps are decoded once, when a tool needs them.
pub struct Desk<'e> {
    exhibit: &'e Exhibit,
    scene: Scene,
    pictures: Pictures,
    rasters: Rasters,
}

/// Decoded maps that outlive a desk.
#[derive(Default)]
pub struct Shelf {
    pictures: Pictures,
    rasters: Rasters,
}

impl<'e> Desk<'e> {
    /// The side that `scene` of `exhibit` shows, in its state. Of a comparison, this is the side it
    /// begins with.
    pub fn new(exhibit: &'e Exhibit, scene: Scene) -> Self {
        Self::with(exhibit, scene, Shelf::default())
    }

    /// The same, with what an earlier desk of the same files has decoded.
    pub fn with(exhibit: &'e Exhibit, scene: Scene, shelf: Shelf) -> Self {
        Self {
            exhibit,
            scene,
            pictures: shelf.pictures,
            rasters: shelf.rasters,
        }
    }

    /// Clears the desk, and keeps what it has decoded.
    pub fn clear(self) -> Shelf {
        Shelf {
            pictures: self.pictures,
            rasters: self.rasters,
        }
    }

    /// Reads a tool. `screen_mm` is the size of a pixel in mm on the sheet where its places were
    /// pointed at; 0 for places that are given in mm.
    ///
    /// # Errors
    /// All reasons why there is no reading.
    pub fn read(&mut self, tool: &Tool, screen_mm: f64) -> Result<Reading, Vec<ReadingError>> {
        let size_mm = self.drawing().size_mm;
        let off = |place: &DVec2| !(place.cmpge(DVec2::ZERO).all() && place.cmple(size_mm).all());
        let faults: Vec<ReadingError> = tool
            .places()
            .into_iter()
            .filter(off)
            .map(|place| ReadingError::OffSheet { place, size_mm })
            .collect();
        let too_wide = tool
            .discs()
            .into_iter()
            .map(|disc| disc.radius_mm)
            .filter(|radius_mm| *radius_mm > size_mm.max_element() / 2.0)
            .map(|radius_mm| ReadingError::TooWide { radius_mm, size_mm });
        let faults: Vec<ReadingError> = faults.into_iter().chain(too_wide).collect();
        if !faults.is_empty() {
            return Err(faults);
        }
        let mut reading = self.laid(tool, screen_mm).map_err(|error| vec![error])?;
        let drawing = self.drawing();
        reading.drawing.clone_from(&drawing.id);
        reading.side = self.scene.side;
        reading.state = self
            .scene
            .state
            .map(|state| drawing.states[state].id.clone());
        reading.places_mm = tool.places().iter().map(DVec2::to_array).collect();
        Ok(reading)
    }

    fn laid(&mut self, tool: &Tool, screen_mm: f64) -> Result<Reading, ReadingError> {
        match tool {
            Tool::Ruler([from, to]) => {
                let (accuracy, notes) = self.accuracy(screen_mm);
                let length = measure::ruler(*from, *to, accuracy)?;
                let words = format!(
                    "ruler {} to {}: {}",
                    at(*from),
                    at(*to),
                    as_known(length, " mm", accuracy)
                );
                let values = vec![Value::as_known("length", length, "mm", accuracy)];
                Ok(reading(tool, values, words, notes))
            }
            Tool::Path { places, closed } => {
                let (accuracy, notes) = self.accuracy(screen_mm);
                if !closed {
                    let length = measure::polyline(places, accuracy)?;
                    let words = format!(
                        "path of {} places: {}",
                        places.len(),
                        as_known(length, " mm", accuracy)
                    );
                    return Ok(reading(
                        tool,
                        vec![Value::as_known("length", length, "mm", accuracy)],
                        words,
                        notes,
                    ));
                }
                let area = measure::area(places, accuracy)?;
                let perimeter = measure::length::perimeter(places, accuracy)?;
                let words = format!(
                    "outline of {} corners: area {}, perimeter {}",
                    places.len(),
                    as_known(area, " mm²", accuracy),
                    as_known(perimeter, " mm", accuracy)
                );
                let values = vec![
                    Value::as_known("area", area, "mm²", accuracy),
                    Value::as_known("perimeter", perimeter, "mm", accuracy),
                ];
                Ok(reading(tool, values, words, notes))
            }
            Tool::Angle([from, corner, to]) => {
                let (accuracy, notes) = self.accuracy(screen_mm);
                let angle = measure::angle(*from, *corner, *to, accuracy)?;
                let words = format!(
                    "angle at {}: {}",
                    at(*corner),
                    as_known(angle, "°", accuracy)
                );
                let values = vec![Value::as_known("angle", angle, "°", accuracy)];
                Ok(reading(tool, values, words, notes))
            }
            Tool::Profile(ends) => self.relief(tool, *ends, screen_mm),
            Tool::Lines(corners) => self.mould(tool, *corners),
            Tool::Stroke(ends) => self.stroke(tool, *ends),
            Tool::Probe(disc) => self.probe(tool, *disc),
            Tool::Difference(discs) => self.difference(tool, *discs),
            Tool::Against(disc, state) => self.against(tool, *disc, *state),
        }
    }

    fn drawing(&self) -> &'e Drawing {
        self.exhibit.drawing_of(&self.scene)
    }

    /// The side in a state; `None` for bare paper.
    fn side(&self, state: Option<usize>) -> Option<Side> {
        self.drawing().side_in_state(self.scene.side, state)
    }

    /// In words, for what is missing; nothing for the sheet as its sides describe it.
    fn in_state(&self, state: Option<usize>) -> String {
        state.map_or_else(String::new, |index| {
            format!(" in the state \"{}\"", self.drawing().states[index].id)
        })
    }

    /// How exactly places are known that are seen in the side's picture and the overlays on it:
    /// by the coarsest of them, and by the one that is registered worst.
    fn accuracy(&self, screen_mm: f64) -> (Accuracy, Vec<Note>) {
        let drawing = self.drawing();
        let overlays = self.scene.overlays.iter();
        let overlays = overlays
            .filter(|(_, opacity)| *opacity > 0.0)
            .map(|(index, _)| drawing.overlays[*index].file.clone());
        let albedo = self.side(self.scene.state).map(|side| side.albedo.file);
        let mut accuracy = Accuracy {
            map_mm: 0.0,
            registration_mm: 0.0,
            screen_mm,
        };
        let mut notes = Vec::new();
        for file in albedo.into_iter().chain(overlays) {
            let pixel = pictures::pixel_mm(&file).max_element();
            accuracy.map_mm = accuracy.map_mm.max(pixel);
            let (residual, note) = self.registration(&file);
            accuracy.registration_mm = accuracy.registration_mm.max(residual);
            notes.extend(note);
        }
        if accuracy.map_mm == 0.0 {
            notes.push(Note::NoPicture {
                side: self.scene.side,
                pointed: screen_mm > 0.0,
            });
        }
        notes.sort_by_key(Note::to_string);
        notes.dedup();
        (accuracy, notes)
    }

    /// The residual of a picture's control points in mm, 0 where none is known; and what to say
    /// where it should be.
    fn registration(&self, file: &MapFile) -> (f64, Option<Note>) {
        if let Some(residual) = registration_mm(self.exhibit, file) {
            return (residual, None);
        }
        let is_moved = pictures::is_moved(file, self.drawing().size_mm);
        let note = is_moved.then(|| Note::Unregistered {
            file: self.name_of(file),
        });
        (0.0, note)
    }

    /// A file's name as the manifest gives it.
    fn name_of(&self, file: &MapFile) -> String {
        let name = file.path.strip_prefix(&self.exhibit.folder);
        name.unwrap_or(&file.path).display().to_string()
    }

    /// What is to be said of a map that was not measured.
    fn source(&self, file: &MapFile) -> Option<Note> {
        (file.source != Source::Measured).then(|| Note::NotMeasured {
            file: self.name_of(file),
            source: file.source,
        })
    }
}

/// Whether anything is known of how exact places are.
fn is_known(accuracy: Accuracy) -> bool {
    accuracy.map_mm.max(accuracy.screen_mm) > 0.0
}

/// In words, with its uncertainty where that is known.
fn as_known(measured: Measured, unit: &str, accuracy: Accuracy) -> String {
    match is_known(accuracy) {
        true => plus_minus(measured, unit),
        false => format!("{:.3}{unit}, how exactly is not known", measured.value),
    }
}

fn reading(tool: &Tool, values: Vec<Value>, words: String, notes: Vec<Note>) -> Reading {
    Reading {
        tool: tool.name(),
        drawing: String::new(),
        side: SideName::Recto,
        state: None,
        places_mm: Vec::new(),
        values,
        words,
        notes,
        samples: Vec::new(),
    }
}

/// The samples of a profile, all as uncertain as `sigma_um`.
fn samples(relief: &[Relief], sigma_um: f64) -> Vec<Sample> {
    let sample = |relief: &Relief| Sample {
        s_mm: relief.distance_mm,
        z_um: relief.height_um,
        sigma_um,
    };
    relief.iter().map(sample).collect()
}
