//! The validated exhibit: what a curator wrote, with every unit, range, file and reference
//! checked once. Nothing behind this module checks any of it again.
//!
//! # Frames
//! *Side frame*: millimetres on one side of the sheet as somebody sees who looks at that side:
//! origin at the top left corner, x right, y **down**. *Table frame*: millimetres around the
//! centre of the sheet at rest: x right, y **up**, z towards the viewer; lamps live here and
//! stay where they are when the sheet is turned over.

mod lamp;
mod scene;

use std::{collections::BTreeMap, path::PathBuf, sync::Arc};

use glam::{DAffine2, DVec2};
use serde::{Deserialize, Serialize};

pub use lamp::{Lamp, LampColour, LampKind};
pub use scene::{
    Ambient, Camera, CompareMode, Comparison, Enhancement, Exposure, MAX_LAMPS, MAX_OVERLAYS,
    Member, Scene,
};

use super::{document::Fingerprint, link::Link};
use crate::{
    maps::{
        ColourEncoding, ColourMapName, NormalY, Warp,
        registration::{FitKind, Residual},
    },
    optics::{
        medium::{Matter, MediumKind},
        slab::{Phase, Slab, UM_PER_MM},
    },
    units::{Degrees, Micrometres, Millimetres},
};

/// A folder with an `exhibit.toml`, validated.
#[derive(Clone, Debug, PartialEq)]
pub struct Exhibit {
    /// The folder that every path of the manifest is relative to.
    pub folder: PathBuf,
    /// The manifest's own path, as faults name it.
    pub manifest: PathBuf,
    pub title: Wording,
    /// BCP 47 tags in order of preference; the first is the fallback of every [`Wording`].
    pub languages: Vec<String>,
    /// Never empty.
    pub drawings: Vec<Drawing>,
    pub lamps: Vec<Lamp>,
    /// Those of the catalogue in its order, then the manifest's own.
    pub media: Vec<ResolvedMedium>,
    /// Never empty: a manifest without scenes gets one of each drawing's recto.
    pub scenes: Vec<Scene>,
    pub tours: Vec<Tour>,
    pub accuracy: Accuracy,
    /// The pictures that do not just cover their sheets.
    pub registered: Vec<Registered>,
    /// Of the manifest's text that this was read from.
    pub fingerprint: Fingerprint,
    /// The link that added the last of the scenes.
    pub link: Option<Link>,
    /// The folder of published versions that it was read by, where it was; `folder` is that of the
    /// version.
    pub published: Option<PathBuf>,
    /// What the manifest asks for that this version of Recto validates but does not show yet,
    /// each as a sentence for `recto check`.
    pub not_shown_yet: Vec<String>,
}

/// A text in one or more languages, by BCP 47 tag.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wording(pub BTreeMap<String, String>);

/// Where a map or constant comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Source {
    Measured,
    Fitted,
    Assumed,
}

/// One sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    pub id: String,
    pub title: Wording,
    pub caption: Wording,
    pub credit: String,
    pub date: String,
    pub inventory: String,
    /// Width and height in mm, both > 0.
    pub size_mm: DVec2,
    pub paper: Paper,
    /// Where the sheet is (white) and where it is not (black), in the recto's side frame.
    pub outline: Option<MapFile>,
    pub surface: Surface,
    pub recto: Side,
    /// `None`: the verso is bare paper.
    pub verso: Option<Side>,
    /// The axis about which the sheet is turned over, from `verso.register.flip`.
    pub flip: FlipAxis,
    pub transmission: Option<MapFile>,
    pub states: Vec<State>,
    /// The manifest's own, and behind them what can be shown of each stack: its bands and views.
    pub overlays: Vec<Overlay>,
    pub stacks: Vec<Stack>,
    pub hotspots: Vec<Hotspot>,
}

/// A medium with the constants that hold in this exhibit.
#[derive(Clone, Debug, PartialEq)]
pub struct ResolvedMedium {
    pub name: String,
    pub kind: MediumKind,
    pub matter: Matter,
    /// Of the constants that the manifest gives; `Assumed` where it gives none.
    pub source: Source,
    /// Where those of the catalogue come from, in words.
    pub origin: &'static str,
    /// Whether the manifest gives its albedo, which otherwise is the catalogue's.
    pub albedo_given: bool,
}

/// What the sheet is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Paper {
    /// The name of its kind, as in [`Exhibit::media`].
    pub kind: String,
    pub thickness: Micrometres,
    /// Distance between chain lines, for laid paper.
    pub chain_lines: Option<Millimetres>,
    /// GGX roughness α of the bare surface where no roughness map says otherwise, in (0, 1].
    pub roughness: f64,
    /// Refractive index of the surface, in [1, 3].
    pub index: f64,
    /// Strength of the specular lobe, 0 (off) to 1 (physical).
    pub specular: f64,
    /// Of the bare sheet as photographed at 45°/0°, linear sRGB in [0, 1]; `None` where it is to
    /// be estimated from the picture.
    pub albedo: Option<[f64; 3]>,
    /// σs in mm⁻¹, > 0.
    pub scattering_per_mm: f64,
    /// Share of the phase function's forward lobe, in [0, 1].
    pub forward_share: f64,
    /// Mean cosine of the forward lobe, in [0, .99].
    pub g_forward: f64,
    /// Mean cosine of the backward lobe, in [−.99, 0].
    pub g_backward: f64,
    /// Strength of the retro-reflective lobe, in [0, 1].
    pub retro: f64,
    /// Strength of the sheen lobe, in [0, 1].
    pub sheen: f64,
    /// Of the specular lobe, in [0, 1].
    pub anisotropy: f64,
    /// Direction of the lobe's longer axis, anticlockwise from the right as the recto is seen.
    pub anisotropy_angle: Degrees,
    pub show_through: ShowThrough,
    pub source: Source,
}

/// Where the other side's ink, as it shows in reflected light, comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShowThrough {
    /// From the sides' own pictures, which hold it: they are photographs.
    #[default]
    Photographed,
    /// From the paper: the pictures, generated or cleaned, hold none.
    Modelled,
}

/// What lay on the other side when a side's picture was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Over<'d> {
    /// What lies there now.
    Same,
    Nothing,
    /// Ink that this picture shows.
    Other(&'d ColourMap),
}

impl Paper {
    /// The sheet's body; its absorption follows from its albedo.
    pub fn slab(&self) -> Slab {
        Slab {
            scattering: self.scattering_per_mm,
            absorption: 0.0,
            thickness: self.thickness.0 / UM_PER_MM,
            phase: Phase {
                forward_share: self.forward_share,
                g_forward: self.g_forward,
                g_backward: self.g_backward,
            },
        }
    }
}

/// The macroscopic shape of the sheet.
#[derive(Clone, Debug, PartialEq)]
pub enum Surface {
    Flat,
    /// A height map in the recto's side frame, heights towards the recto's viewer.
    Height(HeightMap),
    /// A glTF file whose first mesh is the sheet, in mm in the table frame, with texture
    /// coordinates over the recto's side frame (0…1, v down).
    Gltf(PathBuf),
}

/// The axis about which a sheet is turned over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum FlipAxis {
    /// Turned about the sheet's vertical axis, as a page is (`flip = "horizontal"`).
    #[serde(rename = "horizontal")]
    Vertical,
    /// Turned about the sheet's horizontal axis (`flip = "vertical"`).
    #[serde(rename = "vertical")]
    Horizontal,
}

/// The maps of one side. All maps that a side itself declares have one size in pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Side {
    pub albedo: ColourMap,
    pub normal: Option<NormalMap>,
    pub height: Option<HeightMap>,
    pub roughness: Option<RoughnessMap>,
    /// From the lowest to the uppermost.
    pub media: Vec<MediaMap>,
}

/// Which side of a sheet.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum SideName {
    #[default]
    Recto,
    Verso,
}

/// An image file that was found, opened and measured (header only).
#[derive(Clone, Debug, PartialEq)]
pub struct MapFile {
    pub path: PathBuf,
    /// Width and height in pixels; of a picture that is bent, once it is.
    pub size: [u32; 2],
    /// Side frame (mm) → texture coordinates (0…1, v down) of this picture, once it is bent.
    pub uv_from_side: DAffine2,
    /// What bends it into its place where it is loaded.
    pub warp: Option<Arc<Warp>>,
    pub source: Source,
}

/// How a picture was put in its place, and how well what says so agrees.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Registered {
    /// The table of the manifest that places it, as faults name it.
    pub place: String,
    /// The first picture that lies so.
    pub file: PathBuf,
    /// What the control points do to it; `None` where offset, turn and scale are given.
    pub fit: Option<FitKind>,
    pub points: usize,
    /// How far the control points lie from where the fit puts them, on the sheet.
    pub residual: Option<Residual>,
    /// How far each lies from where the others alone put it.
    pub left_out: Option<Residual>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct ColourMap {
    pub file: MapFile,
    pub encoding: ColourEncoding,
}

#[derive(Clone, Debug, PartialEq)]
pub struct NormalMap {
    pub file: MapFile,
    pub y: NormalY,
}

#[derive(Clone, Debug, PartialEq)]
pub struct HeightMap {
    pub file: MapFile,
    /// Heights of black and white in µm.
    pub range_um: [f64; 2],
}

#[derive(Clone, Debug, PartialEq)]
pub struct RoughnessMap {
    pub file: MapFile,
    /// True where white is smooth.
    pub gloss: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub struct MediaMap {
    pub file: MapFile,
    pub content: MediaContent,
}

#[derive(Clone, Debug, PartialEq)]
pub enum MediaContent {
    /// 8-bit sRGB colours in the file, each a medium by its index in [`Exhibit::media`]; any other
    /// colour is bare paper.
    Legend(Vec<([u8; 3], usize)>),
    /// One medium for each channel of the file in its order; values are coverage.
    Weights(Vec<usize>),
}

impl MediaContent {
    /// The media of its channels, as [`crate::maps`] loads them: indices in [`Exhibit::media`].
    pub fn media(&self) -> Vec<usize> {
        match self {
            Self::Legend(legend) => legend.iter().map(|(_, medium)| *medium).collect(),
            Self::Weights(media) => media.clone(),
        }
    }
}

/// A dated state of conservation: maps that replace those of the sides.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    pub id: String,
    pub title: Wording,
    pub date: String,
    pub recto: SidePatch,
    pub verso: SidePatch,
}

/// What a state replaces on one side.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SidePatch {
    pub albedo: Option<ColourMap>,
    pub normal: Option<NormalMap>,
    pub height: Option<HeightMap>,
    pub roughness: Option<RoughnessMap>,
    pub media: Option<Vec<MediaMap>>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Overlay {
    pub id: String,
    pub title: Wording,
    pub side: SideName,
    pub file: MapFile,
    pub kind: OverlayKind,
}

#[derive(Clone, Debug, PartialEq)]
pub enum OverlayKind {
    Categorical(Vec<LegendEntry>),
    /// Grey values of the file span `range` of the quantity, shown by `colour_map`.
    Continuous {
        colour_map: ColourMapName,
        unit: String,
        range: [f64; 2],
    },
    Picture(ColourEncoding),
    /// Of a stack; its file is that of the first of these bands.
    Bands(BandView),
}

#[derive(Clone, Debug, PartialEq)]
pub struct LegendEntry {
    pub id: Option<String>,
    /// 8-bit sRGB, both in the file and on screen.
    pub colour: [u8; 3],
    pub label: Wording,
}

/// Pictures of one side in several bands of light.
#[derive(Clone, Debug, PartialEq)]
pub struct Stack {
    pub id: String,
    pub title: Wording,
    pub side: SideName,
    /// By rising wavelength; never empty.
    pub bands: Vec<Band>,
}

/// How much a side reflects in one band of light.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    pub wavelength_nm: f64,
    pub map: ColourMap,
}

/// What is shown of a stack.
#[derive(Clone, Debug, PartialEq)]
pub struct BandView {
    /// Those that it takes; never empty.
    pub bands: Vec<Band>,
    pub mix: BandMix,
}

#[derive(Clone, Debug, PartialEq)]
pub enum BandMix {
    /// What each band gives to red, green and blue, times its reflectance.
    Colour(Vec<[f64; 3]>),
    /// The first of two bands less the second, on a scale from −`full` to `full` of reflectance.
    Difference { full: f64 },
}

/// A region of a side that something is said about.
#[derive(Clone, Debug, PartialEq)]
pub struct Hotspot {
    pub id: String,
    pub side: SideName,
    /// The places around it in the side frame, at least three: a simple polygon with an area.
    pub polygon_mm: Vec<DVec2>,
    pub title: Wording,
    pub text: Wording,
    /// Where it leads: index into [`Exhibit::scenes`].
    pub scene: Option<usize>,
}

/// Albedo of bare paper, linear sRGB, where neither manifest nor picture says one: the measured
/// white of an old rag sheet is not known here, this is a usual one.
pub const BARE_PAPER: [f64; 3] = [0.72, 0.67, 0.57];

#[derive(Clone, Debug, PartialEq)]
pub struct Tour {
    pub id: String,
    pub title: Wording,
    /// Index into [`Exhibit::scenes`] and seconds (> 0).
    pub stops: Vec<(usize, f64)>,
}

/// What the curator asks of the rendering.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    pub max_delta_e: f64,
    pub frame_ms: f64,
}
