//! Back to what could be shown, where what was asked for cannot be.

use std::sync::Arc;

use super::Hand;
use crate::{manifest::exhibit::Exhibit, visitor::view::View};

/// What could be shown, also of an earlier version of the exhibit.
#[derive(Clone, Debug)]
pub(super) struct Good {
    exhibit: Arc<Exhibit>,
    scene: usize,
    view: View,
}

/// What became of a wish that cannot be shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Retreat {
    /// Nothing could be shown yet.
    Nowhere,
    /// Back to what could be shown.
    Back,
    /// It was what could be shown before, and no longer can be.
    Stuck,
}

impl Hand {
    /// What is shown now could be shown.
    pub fn keep(&mut self) {
        if self.flip.is_none() {
            self.good = Some(Good {
                exhibit: self.exhibit.clone(),
                scene: self.scene,
                view: self.view.clone(),
            });
        }
    }

    /// What was asked for cannot be shown: back to what could, be it of an earlier version.
    pub fn retreat(&mut self) -> Retreat {
        let Some(good) = self.good.clone() else {
            return Retreat::Nowhere;
        };
        let same_version = Arc::ptr_eq(&good.exhibit, &self.exhibit);
        let same_scene = same_version && good.scene == self.scene;
        if same_scene && good.view.shows_as(&self.view) && self.flip.is_none() {
            return Retreat::Stuck;
        }
        if !same_version {
            self.refused.clear();
        } else if good.scene != self.scene {
            self.refused.insert(self.scene);
        }
        self.exhibit = good.exhibit;
        self.scene = good.scene;
        self.view = good.view;
        self.still();
        self.relight();
        Retreat::Back
    }
}
