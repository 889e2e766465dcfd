//! How large the sheet is in a picture, and where in it.

use glam::DVec2;
use serde::Serialize;

use crate::manifest::{
    Exhibit, Scene,
    exhibit::{CompareMode, Surface},
};

/// The scale of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Scale {
    pub mm_per_px: f64,
    pub holds: Holds,
    /// Whether a loupe shows a part of the picture larger.
    pub outside_the_loupe: bool,
}

/// Where a scale holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Holds {
    /// The sheet lies flat under the eye, or is seen in parallel projection from straight above.
    Everywhere,
    /// A parallel projection at a slant: along the horizontals of the picture, anywhere.
    AlongTheHorizontal,
    /// In perspective: along the horizontal through the middle of what is looked at.
    AtTheCentre,
}

impl Scale {
    /// Of `scene` in a picture of `size` pixels; of a comparison, of its first member. (`scene`'s
    /// camera may be fitted to its part of the picture already, as [`crate::manifest::Camera::fitted`]
    /// does.)
    pub fn new(exhibit: &Exhibit, scene: &Scene, size: [u32; 2]) -> Self {
        let [width, height] = size.map(|side| f64::from(side.max(1)));
        let aspect = width / height;
        let parts = exhibit.parts(scene, aspect);
        let (first, scale) = parts
            .first()
            .map_or((scene, DVec2::ONE), |(member, part)| (member, part.scale));
        let drawing = exhibit.drawing_of(first);
        let own_aspect = aspect * scale.x / scale.y;
        let camera = first.camera.fitted(drawing.size_mm, own_aspect);
        let is_flat = drawing.surface == Surface::Flat;
        let holds = match (camera.distance_mm, camera.tilt.0 == 0.0) {
            (None, true) => Holds::Everywhere,
            (Some(_), true) if is_flat => Holds::Everywhere,
            (None, false) => Holds::AlongTheHorizontal,
            (Some(_), _) => Holds::AtTheCentre,
        };
        let mode = scene.compare.as_ref().map(|comparison| comparison.mode);
        Self {
            mm_per_px: camera.width_mm / (width * scale.x),
            holds,
            outside_the_loupe: mode == Some(CompareMode::Loupe),
        }
    }

    /// What a bar must say beside its length, a line each; none where there is nothing to say.
    pub fn words(&self) -> Vec<&'static str> {
        let holds = match self.holds {
            Holds::Everywhere => None,
            Holds::AlongTheHorizontal => Some("along the horizontal"),
            Holds::AtTheCentre => Some("at the centre, along the horizontal"),
        };
        let loupe = self.outside_the_loupe.then_some("outside the loupe");
        holds.into_iter().chain(loupe).collect()
    }
}
