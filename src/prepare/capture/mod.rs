//! The capture file: what a photographer wrote about a set of photographs, read, checked once,
//! and told back in plain words where it is wrong.
//!
//! | step | where |
//! |---|---|
//! | text → plain data, every key declared once | [`raw`], by the machinery of [`manifest`](crate::manifest) |
//! | the same declarations → JSON Schema | [`schema()`] |
//! | plain data → [`Capture`], files opened and measured | `validate` |
//!
//! Photographs run from the top left, x right and y down, pixel centres at halves. Lamps are in the
//! sheet's frame: x right, y *up* in the photograph, z out of it towards the camera, in mm from the
//! middle of the photograph.

pub mod raw;
mod validate;
pub mod values;

use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3};
use serde::Serialize;
use serde_json::Value;

use crate::{
    manifest::{
        Fault, Faults, Severity, SideName,
        decode::{Decode, Node, Report},
        document::{Document, read_text_of},
        fault,
        shape::{self, schema_of},
    },
    maps::ColourEncoding,
    optics::{medium::MediumId, spectrum::Illuminant},
};
use raw::RawCapture;

/// The usual name of a capture file.
pub const CAPTURE: &str = "capture.toml";
/// The fewest lamps that tell where a surface faces.
pub const MIN_LAMPS: usize = 3;
/// The most lamps of one capture.
pub const MAX_LAMPS: usize = 500;
/// What a swatch says of a place where nothing is drawn.
pub const BARE_PAPER: &str = "bare-paper";

/// Whose colours a chart has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ChartValues {
    /// Made since November 2014.
    #[default]
    ColorChecker24,
}

/// What is known of how bright lamps are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Intensities {
    Equal,
    Solve,
}

/// What is done against shadows and highlights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Robustness {
    /// Plain least squares.
    None,
    /// The brightest and the darkest are left out, unless the surface is matte already.
    Drop,
    /// Iteratively reweighted.
    #[default]
    Robust,
}

/// How relief is split into the sheet's shape and its grain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Filter {
    #[default]
    Gaussian,
    /// Which keeps creases.
    Bilateral,
}

/// How slopes become the sheet's shape at large.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Integration {
    /// Least squares; nothing is asked of the perimeter.
    #[default]
    Free,
    /// Least squares, the perimeter at height 0.
    Anchored,
    /// Slopes that contradict the others lose their weight; nothing is asked of the perimeter.
    Robust,
}

/// A capture file, validated: every file is there and of the size it must have, and there is one
/// photograph for each lamp.
#[derive(Clone, Debug, PartialEq)]
pub struct Capture {
    /// The file's own path, as faults name it.
    pub file: PathBuf,
    pub id: String,
    pub title: Option<String>,
    pub encoding: ColourEncoding,
    pub illuminant: Illuminant,
    /// The side of a pixel on the sheet in mm.
    pub mm_per_px: f64,
    pub lamps: Lamps,
    pub recto: Shots,
    pub verso: Option<Shots>,
    pub chart: Option<Chart>,
    pub transmitted: Option<Transmitted>,
    pub swatches: Vec<Swatch>,
    pub relief: Relief,
    /// What the shape is compared with.
    pub compare: Option<OtherSurface>,
}

/// Another surface of the whole sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct OtherSurface {
    pub path: PathBuf,
    /// Of a picture of heights, those of black and of white in µm; `None` for a glTF file.
    pub range_um: Option<[f64; 2]>,
}

/// The lamps of a capture.
#[derive(Clone, Debug, PartialEq)]
pub struct Lamps {
    pub places: Places,
    /// How many.
    pub count: usize,
    pub light: Light,
}

/// Where lamps stand.
#[derive(Clone, Debug, PartialEq)]
pub enum Places {
    /// Unit vectors towards lamps far away.
    Directions(Vec<DVec3>),
    /// In mm.
    Positions(Vec<DVec3>),
    /// To be found in a glossy ball.
    Sphere(Sphere),
}

/// A glossy ball.
#[derive(Clone, Debug, PartialEq)]
pub struct Sphere {
    /// One under each lamp; empty where it lies in the recto's.
    pub photographs: Vec<PathBuf>,
    /// `None` where it has to be found.
    pub circle: Option<Circle>,
}

/// A ball's outline in a photograph, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    pub centre: DVec2,
    pub radius: f64,
}

/// How much light each lamp gives.
#[derive(Clone, Debug, PartialEq)]
pub enum Light {
    /// As photographs of a grey card say.
    FlatField {
        photographs: Vec<PathBuf>,
        /// Of the card.
        reflectance: f64,
        /// The card with all lamps off.
        ambient: Option<PathBuf>,
    },
    /// In proportion to these.
    Relative(Vec<f64>),
    Unknown(Intensities),
}

/// The photographs of one side.
#[derive(Clone, Debug, PartialEq)]
pub struct Shots {
    /// One for each lamp.
    pub photographs: Vec<PathBuf>,
    /// With all lamps off.
    pub ambient: Option<PathBuf>,
    /// Width and height of every photograph in pixels.
    pub size: [u32; 2],
    /// What is the sheet.
    pub crop: Crop,
}

/// A rectangle of whole pixels; `right` and `bottom` are just outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    pub left: u32,
    pub top: u32,
    pub right: u32,
    pub bottom: u32,
}

impl Crop {
    pub fn width(&self) -> usize {
        (self.right - self.left) as usize
    }

    pub fn height(&self) -> usize {
        (self.bottom - self.top) as usize
    }
}

/// A colour chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    pub photograph: PathBuf,
    /// Middles of the patches at its corners, in pixels; `None` where they have to be found.
    pub corners: Option<[DVec2; 4]>,
    /// CIELAB under D50 of its 24 patches, row by row.
    pub lab: Vec<[f64; 3]>,
    pub flat_field: Option<PathBuf>,
}

/// The sheet on a light table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Transmitted {
    pub photograph: PathBuf,
    pub flat_field: Option<PathBuf>,
}

/// A place whose material is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Swatch {
    pub side: SideName,
    /// `None` for bare paper.
    pub medium: Option<MediumId>,
    /// In pixels of the photographs.
    pub rect: Crop,
}

/// How relief is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relief {
    pub split_mm: f64,
    pub filter: Filter,
    pub against_outliers: Robustness,
    /// Of the shape at large; grain and strokes are always free.
    pub integrate: Integration,
    pub known_range_um: Option<f64>,
}

impl Default for Relief {
    fn default() -> Self {
        Self {
            split_mm: 2.0,
            filter: Filter::default(),
            against_outliers: Robustness::default(),
            integrate: Integration::default(),
            known_range_um: None,
        }
    }
}

impl Capture {
    /// Reads a capture file, or that of a folder, and checks everything but the pixels of its
    /// photographs, of which only the headers are looked at. Returns it with its warnings.
    ///
    /// # Errors
    /// All faults, warnings included, in the order of their places.
    pub fn read(path: &Path) -> Result<(Self, Vec<Fault>), Faults> {
        let file = match path.is_dir() {
            true => path.join(CAPTURE),
            false => path.to_owned(),
        };
        let allowed = "a capture file";
        let remedy = "check the path, or write one as README.md describes";
        let text = read_text_of(&file, allowed, remedy)?;
        Self::parse(&file, &text)
    }

    /// As [`Self::read`], of the text of a file at `file`, which decides where photographs are
    /// looked for.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(file: &Path, text: &str) -> Result<(Self, Vec<Fault>), Faults> {
        let document = Document::parse(file, text)?;
        let mut report = Report::new(&document);
        let raw = RawCapture::decode(&Node::root(&document), &mut report);
        let capture = raw.and_then(|raw| validate::capture(&raw, file, &mut report));
        let mut faults = report.into_faults();
        fault::sort(&mut faults);
        let sound = faults
            .iter()
            .all(|fault| fault.severity == Severity::Warning);
        match capture {
            Some(capture) if sound => Ok((capture, faults)),
            _ => {
                Err(Faults::new(faults)
                    .unwrap_or_else(|| shape::unexplained(file, "a capture").into()))
            }
        }
    }
}

/// The schema that `recto schema --capture` prints.
pub fn schema() -> Value {
    schema_of::<RawCapture>()
}

/// Checks keys, types, ranges and words of a capture's text, which is what [`schema()`]
/// describes, and touches no file.
///
/// # Errors
/// All faults of syntax, or else of shape.
pub fn check_shape(text: &str) -> Result<(), Faults> {
    shape::check::<RawCapture>(CAPTURE, text)
}
