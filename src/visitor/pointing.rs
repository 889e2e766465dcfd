//! The pointer on the sheet that is shown: which place it is at, what lies there, and where the same place
//! lies on the other sheets in the picture.

use std::sync::Arc;

use bevy::prelude::*;
use glam::DVec2;

use super::{
    glass::Glass,
    hand::Hand,
    input::Devices,
    marks::{self, InView, Ink, Mark, Marks, Shape},
    measuring,
    reader::{Errand, Reader},
};
use crate::{
    manifest::{
        exhibit::{Exhibit, Scene, SideName},
        frames::other_side,
    },
    readings::{
        Under, Why,
        sight::{Seen, Sight},
    },
    stage::{Shown, Waker},
};

/// What lies under the pointer.
#[derive(Resource, Debug, Default)]
pub struct Pointer {
    /// Somebody asked for what lies there.
    wanted: bool,
    /// Where it is on the sheet.
    seen: Option<Seen>,
    /// What was asked for last, of which version.
    asked: Option<(Arc<Exhibit>, Scene, DVec2)>,
    /// And what is there.
    under: Option<Result<Under, Why>>,
}

impl Pointer {
    /// Whether somebody asked for what lies there.
    pub fn is_read(&self) -> bool {
        self.wanted
    }

    /// As another machine says.
    pub fn be(&mut self, reads: bool) {
        if self.wanted != reads {
            self.switch();
        }
    }

    /// Somebody asks for what lies there, or no longer.
    pub fn switch(&mut self) {
        self.wanted = !self.wanted;
        self.asked = None;
        self.under = None;
    }

    /// Nobody asks any more.
    pub fn rest(&mut self) {
        self.wanted = false;
    }

    /// Where it is on the sheet.
    pub fn seen(&self) -> Option<&Seen> {
        self.seen.as_ref()
    }

    /// Takes in what lies at a place, if that was asked for last.
    pub fn hear(&mut self, place: DVec2, under: Result<Under, Why>) {
        let asked = self.asked.as_ref().map(|(.., place)| *place);
        if asked == Some(place) {
            self.under = Some(under);
        }
    }

    /// What lies under it, or why that is not known; nothing beside the sheet.
    pub fn under(&self) -> Option<&Result<Under, Why>> {
        self.under.as_ref().filter(|_| self.wanted)
    }
}

/// The drawing's sheets in the picture, in logical pixels.
pub struct View {
    pub sheets: Vec<InView>,
    sight: Option<Sight>,
}

impl View {
    pub fn new(shown: &Shown, shape: &Shape, size: Vec2) -> Self {
        let drawing = shown.exhibit.drawing_of(&shown.scene);
        let sheets = marks::in_view(shown);
        let lying = sheets.iter().map(|sheet| sheet.lying).collect();
        let sight = shape
            .of(drawing)
            .map(|surface| Sight::of(drawing, surface.clone(), size.as_dvec2(), lying));
        Self { sheets, sight }
    }

    /// What is seen of the sheet itself, without the margin of its mesh.
    pub fn seen(&self, shown: &Shown, at: Vec2) -> Option<Seen> {
        let seen = self.sight.as_ref()?.seen(at.as_dvec2())?;
        let size_mm = shown.exhibit.drawing_of(&shown.scene).size_mm;
        measuring::is_on(seen.mm, size_mm).then_some(seen)
    }

    /// The scene whose side is read where something is seen.
    fn scene(&self, shown: &Shown, sheet: usize, side: SideName) -> Scene {
        Scene {
            side,
            // What two states are told apart by.
            compare: shown.scene.compare.clone(),
            ..self.sheets[sheet].scene.clone()
        }
    }
}

/// Points: shows the same place of every other sheet, and asks what lies there.
pub fn point(
    (devices, shown, shape, hand): (Res<Devices>, Res<Shown>, Res<Shape>, Res<Hand>),
    glass: Res<Glass>,
    (mut pointer, mut marks): (ResMut<Pointer>, ResMut<Marks>),
    (mut reader, waker): (ResMut<Reader>, Res<Waker>),
) {
    if !(devices.is_changed() || shown.is_changed() || shape.is_changed() || pointer.is_changed()) {
        return;
    }
    let view = View::new(&shown, &shape, glass.size);
    let seen = devices.pointer().and_then(|at| view.seen(&shown, at));
    if pointer.seen != seen {
        pointer.bypass_change_detection().seen = seen;
        pointer.set_changed();
    }
    let mut rings = Vec::new();
    if let (Some(seen), Some(sight)) = (&seen, &view.sight) {
        for (number, sheet) in view.sheets.iter().enumerate() {
            if number == seen.sheet {
                continue;
            }
            let drawing = shown.exhibit.drawing_of(&shown.scene);
            // A place of the recto lies over one of the verso.
            let place = match sheet.side == seen.side {
                true => seen.mm,
                false => other_side(seen.mm, drawing.size_mm, drawing.flip),
            };
            rings.extend(sight.pixel(number, sheet.side, place).map(|at| Mark::Ring {
                middle: at.as_vec2(),
                ink: Ink::Open,
            }));
        }
    }
    if marks.pointer != rings {
        marks.pointer = rings;
    }
    if !pointer.wanted || hand.is_moving() {
        return;
    }
    let Some(seen) = seen else {
        let silent = pointer.bypass_change_detection();
        let had = silent.under.take().is_some() | silent.asked.take().is_some();
        if had {
            pointer.set_changed();
        }
        return;
    };
    let scene = view.scene(&shown, seen.sheet, seen.side);
    // Where eye and lamps are makes no difference to a map.
    let asked = pointer.asked.as_ref().is_some_and(|(version, was, place)| {
        let same = |a: &Scene, b: &Scene| {
            (a.drawing, a.side, a.state) == (b.drawing, b.side, b.state)
                && a.overlays == b.overlays
                && a.categories == b.categories
                && a.compare.as_ref().map(|c| &c.of) == b.compare.as_ref().map(|c| &c.of)
        };
        Arc::ptr_eq(version, hand.exhibit()) && *place == seen.mm && same(was, &scene)
    });
    if !asked {
        let asked = (hand.exhibit().clone(), scene.clone(), seen.mm);
        pointer.bypass_change_detection().asked = Some(asked);
        let errand = Errand::Under(seen.mm);
        reader.ask(hand.exhibit().clone(), scene, errand, &waker);
    }
}
