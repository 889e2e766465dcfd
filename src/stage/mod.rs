//! From the scene that is shown to entities: loads what [`Needs`](crate::needs::Needs) asks for, spawns the sheet's
//! sides, and keeps their lamps, eye and overlays true to [`Shown`].

pub mod camera;
pub mod composite;
pub mod fineness;
pub mod legend;
pub mod library;
pub mod reload;
mod sides;

use std::{fmt::Display, io::Write, sync::Arc};

use bevy::prelude::*;
use glam::DQuat;

pub use crate::manifest::lighting::TABLE;
pub use library::{Library, Waker};
pub use sides::Arranged;

use composite::Composite;

use crate::{
    manifest::{
        comparison::Part,
        exhibit::{CompareMode, Comparison, Exhibit, Scene, Wording},
        eye::Eye,
    },
    optics::tier::Tier,
    sheet::SheetPlugin,
};

/// What is shown now. Whoever changes it changes the picture.
#[derive(Resource, Clone, Debug)]
pub struct Shown {
    pub exhibit: Arc<Exhibit>,
    /// A scene of the exhibit, or one made from it by hand or command line.
    pub scene: Scene,
    pub tier: Tier,
    /// How the sheet is turned, table frame from the recto's local frame.
    pub pose: DQuat,
    /// The hidden side may come into sight: the sheet is being turned.
    pub both_sides: bool,
    /// Width over height of the picture.
    pub aspect: f64,
}

impl Shown {
    /// `scene` of `exhibit` with the sheet at rest.
    pub fn at_rest(exhibit: Arc<Exhibit>, scene: Scene, tier: Tier, aspect: f64) -> Self {
        let pose = exhibit.drawings[scene.drawing].rest_pose(scene.side);
        Self {
            exhibit,
            scene,
            tier,
            pose,
            both_sides: false,
            aspect,
        }
    }

    /// The eye of the scene's camera, for this picture's aspect.
    pub fn eye(&self) -> Eye {
        let size_mm = self.exhibit.drawing_of(&self.scene).size_mm;
        Eye::new(&self.scene.camera.fitted(size_mm, self.aspect), size_mm)
    }

    /// The sheets that share the picture, turned as what is shown is turned: one, unless its scene
    /// compares several.
    pub fn members(&self) -> Vec<Shared> {
        let parts = self.exhibit.parts(&self.scene, self.aspect).into_iter();
        let shared = parts.enumerate().map(|(k, (scene, part))| Shared {
            pose: self.pose_of(&scene, self.is_behind(k)),
            scene,
            part,
        });
        shared.collect()
    }

    /// How the sheet of another scene lies when it is turned as this one is, or, `behind` glass, so
    /// that its mirror image is.
    fn pose_of(&self, scene: &Scene, behind: bool) -> DQuat {
        let rest = |scene: &Scene| self.exhibit.drawing_of(scene).rest_pose(scene.side);
        let mut turned = self.pose * rest(&self.scene).inverse();
        if behind {
            turned = DQuat::from_xyzw(turned.x, -turned.y, -turned.z, turned.w);
        }
        turned * rest(scene)
    }

    /// Whether member `k` is seen from behind, as through glass.
    fn is_behind(&self, k: usize) -> bool {
        let glass = |c: &Comparison| c.mode == CompareMode::Glass;
        k > 0 && self.scene.compare.as_ref().is_some_and(glass)
    }

    /// Member `k` of the comparison that is shown, alone and whole; `None` where there is none.
    pub fn alone(&self, k: usize) -> Option<Self> {
        let scene = self.exhibit.members(&self.scene).into_iter().nth(k)?;
        Some(Self {
            pose: self.pose_of(&scene, self.is_behind(k)),
            scene,
            ..self.clone()
        })
    }

    /// `wording` in the scene's language, or as near to it as there is.
    pub fn text<'w>(&self, wording: &'w Wording) -> Option<&'w str> {
        self.exhibit
            .text(wording, self.scene.language.as_deref().unwrap_or_default())
    }
}

/// One of the sheets that share a picture.
#[derive(Clone, Debug)]
pub struct Shared {
    /// Without a comparison of its own.
    pub scene: Scene,
    pub part: Part,
    /// As [`Shown::pose`].
    pub pose: DQuat,
}

/// Words for the curator, on standard error; nobody may be listening there any more.
pub fn say(words: impl Display) {
    let _ = writeln!(std::io::stderr(), "{words}");
}

/// What happens to the stage in one frame, in this order.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub enum StageSet {
    /// Whoever steers changes [`Shown`].
    Steer,
    /// Maps that arrived are taken in, and what is shown is arranged from them.
    Arrange,
}

/// Shows [`Shown`].
pub struct StagePlugin {
    /// Draws into a window: at the display's level, with noise against banding.
    pub display: bool,
    /// Samples along the steepest direction of a tilted map, 1 to 16.
    pub anisotropy: u16,
}

impl Plugin for StagePlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((SheetPlugin, legend::LegendPlugin, fineness::FinenessPlugin))
            .init_resource::<Composite>()
            .insert_resource(Library::new(self.anisotropy))
            .insert_resource(Arranged::new(self.display))
            .add_systems(Startup, library::suit_device)
            .configure_sets(Update, (StageSet::Steer, StageSet::Arrange).chain())
            .add_systems(
                Update,
                (
                    library::receive,
                    sides::arrange,
                    composite::compose,
                    composite::follow,
                    composite::retire,
                )
                    .chain()
                    .in_set(StageSet::Arrange)
                    .run_if(resource_exists::<Shown>),
            );
    }
}
