//! What decides a picture: which sheet in which light, by which eye, and what it is compared with.

use std::collections::BTreeMap;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::{Exhibit, SideName, Wording};
use crate::units::{Degrees, Kelvin, Lux};

/// Everything that decides a picture: the one saved state.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    pub id: String,
    pub title: Wording,
    pub text: Wording,
    /// Index into [`Exhibit::drawings`].
    pub drawing: usize,
    pub side: SideName,
    /// Index into the drawing's states; `None` is the sheet as its sides describe it.
    pub state: Option<usize>,
    /// Overlays from the lowest to the uppermost: index into the drawing's overlays, opacity
    /// 0…1. Only overlays of the scene's side.
    pub overlays: Vec<(usize, f64)>,
    /// Of overlays of categories of which not all are shown, those that are: index into the
    /// drawing's overlays → indices into its legend.
    pub categories: BTreeMap<usize, Vec<usize>>,
    pub compare: Option<Comparison>,
    pub camera: Camera,
    /// Indices into [`Exhibit::lamps`], at most [`MAX_LAMPS`].
    pub lamps: Vec<usize>,
    pub ambient: Ambient,
    /// Share of the light that comes through the sheet from behind, 0…1, beside what lamps give: the
    /// place of a slider between reflected and transmitted light.
    pub transmitted: f64,
    pub exposure: Exposure,
    pub enhance: Enhancement,
    /// The language of the captions; `None` is the exhibit's first.
    pub language: Option<String>,
}

impl Scene {
    /// Whether light comes through the sheet.
    pub fn is_lit_from_behind(&self, exhibit: &Exhibit) -> bool {
        let is_behind = |&lamp: &usize| exhibit.lamps[lamp].kind.is_behind();
        self.transmitted > 0.0 || self.lamps.iter().any(is_behind)
    }
}

/// What is shown other than it is, for the eye alone: said on every picture while on, and never part
/// of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enhancement {
    /// All paper has the colour of bare paper, and nothing is drawn on it.
    pub relief_only: bool,
    /// How many times steeper the relief is.
    pub exaggerate: f64,
    /// Linear display levels that are shown as black and as white.
    pub stretch: Option<DVec2>,
    /// Of contrast-adaptive sharpening, 0…1.
    pub sharpen: f64,
}

impl Default for Enhancement {
    fn default() -> Self {
        Self {
            relief_only: false,
            exaggerate: 1.0,
            stretch: None,
            sharpen: 0.0,
        }
    }
}

impl Enhancement {
    /// Whether finished pictures are changed, and not only the sheet.
    pub fn is_of_picture(&self) -> bool {
        self.stretch.is_some() || self.sharpen > 0.0
    }

    /// What a picture says of it, a line each; nothing where nothing is enhanced.
    pub fn marks(&self) -> Vec<String> {
        let mut marks = Vec::new();
        if self.relief_only {
            marks.push("relief only, without colour".to_owned());
        }
        if self.exaggerate != 1.0 {
            marks.push(format!("relief {:.1} times as steep", self.exaggerate));
        }
        if let Some(stretch) = self.stretch {
            let [low, high] = (stretch * 100.0).to_array();
            marks.push(format!(
                "contrast stretched: {low:.0} to {high:.0} % of white"
            ));
        }
        if self.sharpen > 0.0 {
            marks.push(format!("sharpened: {:.0} %", self.sharpen * 100.0));
        }
        marks
    }
}

/// How many lamps light one scene at most.
pub const MAX_LAMPS: usize = 8;
/// How many overlays lie on one scene at once at most.
pub const MAX_OVERLAYS: usize = 16;

/// Members shown against each other, all in the same light and by the same eye.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    pub mode: CompareMode,
    pub of: Vec<Member>,
    /// Where the curtain hangs, as a share of the way across the picture; how much of the second
    /// member a blend shows.
    pub at: f64,
    /// The way across the curtain, anticlockwise from the right.
    pub angle: Degrees,
    /// The loupe's centre, from the left and top edges of the picture, as shares of its width and
    /// height.
    pub centre: DVec2,
    /// Its radius as a share of the picture's height.
    pub radius: f64,
    /// How much larger it shows its member.
    pub magnify: f64,
    /// ΔE00 at which a difference is shown at the top of its scale.
    pub full_delta_e: f64,
    /// The same of luminance, as a share of a perfect diffuser's: the difference is one of light then.
    pub full_luminance: Option<f64>,
    /// Whether a difference is shown in colours; otherwise its numbers stand for light.
    pub coded: bool,
    /// Of members that take turns, whose it is.
    pub turn: usize,
}

impl Comparison {
    /// With the curtain in the middle, half of each member, and a loupe of a quarter of the height.
    pub fn new(mode: CompareMode, of: Vec<Member>) -> Self {
        Self {
            mode,
            of,
            at: 0.5,
            angle: Degrees(0.0),
            centre: DVec2::splat(0.5),
            radius: 0.25,
            magnify: 2.0,
            full_delta_e: 10.0,
            full_luminance: None,
            coded: true,
            turn: 0,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CompareMode {
    Curtain,
    SideBySide,
    Blend,
    Loupe,
    Difference,
    Flicker,
    /// Both as if the sheet were glass: the second is seen from behind.
    Glass,
}

/// One member of a comparison, written `state:before`, `side:verso`, `overlay:damage`,
/// `band:stack/700`, `drawing:landscape`. Indices into the scene's drawing, or the exhibit for `Drawing`.
/// Without a state, `state:none`, it is the sheet as its sides describe it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Member {
    State(Option<usize>),
    Side(SideName),
    Overlay(usize),
    Drawing(usize),
}

/// The eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// What it looks at, in the side frame of the scene's side.
    pub centre_mm: DVec2,
    /// Width of the sheet's plane that fills the picture, at the centre, in mm, > 0.
    pub width_mm: f64,
    /// How far the eye leans from straight above towards the bottom edge, 0…89°.
    pub tilt: Degrees,
    /// How far the eye walks around the sheet, anticlockwise as seen from above.
    pub turn: Degrees,
    /// Distance of the eye; `None` is a parallel projection.
    pub distance_mm: Option<f64>,
}

/// Even light from every direction of the room.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ambient {
    /// Illuminance that it alone gives to the sheet.
    pub illuminance: Lux,
    pub kelvin: Kelvin,
}

/// What a display shows at full level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposure {
    /// The illuminance at which a perfect diffuser is shown at `level`; `None` is what the
    /// scene's own lamps give to the centre of the flat sheet.
    pub illuminance: Option<Lux>,
    /// Linear display level of that diffuser, in (0, 1].
    pub level: f64,
    /// The colour temperature that is shown as neutral.
    pub white: Kelvin,
}
