//! Hotspots under the hand: which are in view, where their outlines lie in the picture, and which one
//! is open.

use std::sync::Arc;

use bevy::prelude::*;
use glam::{DVec2, DVec3};

use super::{
    glass::Glass,
    hand::Hand,
    intent::Intent,
    marks::{self, Ink, Marks, Shape},
    view::wrapped,
};
use crate::{
    manifest::{
        comparison::Part,
        exhibit::{Drawing, Hotspot},
        hotspot::contains,
        surface::SideSurface,
    },
    stage::Shown,
};

/// Which hotspots somebody asked to see, and which one they opened.
#[derive(Clone, Debug, Default)]
pub struct Hotspots {
    shown: bool,
    /// The id of the open one.
    open: Option<String>,
    /// Outlines on a sheet that is not flat.
    curled: Option<Curled>,
}

/// Outlines on the sheet as it is shaped.
#[derive(Clone, Debug)]
struct Curled {
    surface: Arc<SideSurface>,
    hotspots: Vec<Hotspot>,
    /// Of each hotspot, in the sheet's own frame.
    outlines: Vec<Vec<DVec3>>,
}

/// A hotspot in view.
#[derive(Clone, Debug)]
pub struct Seen {
    /// Index into the drawing's hotspots.
    pub hotspot: usize,
    /// Its outline in the picture (−1…1, y up).
    pub outline: Vec<DVec2>,
    /// What of the picture its sheet has.
    part: Part,
}

impl Hotspots {
    /// Whether somebody asked to see them.
    pub fn is_shown(&self) -> bool {
        self.shown
    }

    /// The id of the open one.
    pub fn open_id(&self) -> Option<&str> {
        self.open.as_deref()
    }

    /// As another machine says it.
    pub fn be(&mut self, shown: bool, open: Option<String>) {
        (self.shown, self.open) = (shown, open);
    }

    /// Learns how the sheet is shaped.
    fn learn(&mut self, drawing: &Drawing, surface: &Arc<SideSurface>) {
        let known = self.curled.as_ref().is_some_and(|curled| {
            Arc::ptr_eq(&curled.surface, surface) && curled.hotspots == drawing.hotspots
        });
        if known {
            return;
        }
        let outline = |hotspot: &Hotspot| {
            let places = &hotspot.polygon_mm;
            marks::on_sheet(drawing, Some(surface), hotspot.side, places, true)
        };
        self.curled = Some(Curled {
            outlines: drawing.hotspots.iter().map(outline).collect(),
            surface: surface.clone(),
            hotspots: drawing.hotspots.clone(),
        });
    }

    fn outline(&self, drawing: &Drawing, hotspot: usize) -> Vec<DVec3> {
        let curled = self.curled.as_ref();
        match curled.filter(|curled| curled.hotspots == drawing.hotspots) {
            Some(curled) => curled.outlines[hotspot].clone(),
            None => drawing.outline(&drawing.hotspots[hotspot]),
        }
    }

    /// Every hotspot of the drawing that is shown, on the sides that are in view.
    pub fn seen(&self, shown: &Shown) -> Vec<Seen> {
        let drawing = shown.exhibit.drawing_of(&shown.scene);
        let mut seen = Vec::new();
        for view in marks::in_view(shown) {
            for (index, hotspot) in drawing.hotspots.iter().enumerate() {
                if hotspot.side != view.side {
                    continue;
                }
                let outline = self.outline(drawing, index);
                // What reaches behind the eye has no outline in the picture.
                let outline: Option<Vec<DVec2>> =
                    outline.iter().map(|point| view.ndc(*point)).collect();
                seen.extend(outline.map(|outline| Seen {
                    hotspot: index,
                    outline,
                    part: view.lying.part,
                }));
            }
        }
        seen
    }
}

impl Hand {
    /// Whether somebody asked to see the hotspots.
    pub fn shows_hotspots(&self) -> bool {
        self.hotspots.shown
    }

    /// The hotspot that is open, if its side is in view.
    pub fn open_hotspot(&self) -> Option<&Hotspot> {
        let id = self.hotspots.open.as_ref()?;
        let hotspots = self.drawing().hotspots.iter();
        let open = hotspots.enumerate().find(|(_, hotspot)| hotspot.id == *id);
        let (index, hotspot) = open?;
        let seen = self.hotspots.seen(&self.shown());
        seen.iter()
            .any(|seen| seen.hotspot == index)
            .then_some(hotspot)
    }

    /// Closes the hotspot that is open; whether there was one.
    pub fn close_hotspot(&mut self) -> bool {
        let open = self.open_hotspot().is_some();
        self.hotspots.open = None;
        open
    }

    /// The smallest hotspot at a place of the picture, while they are shown.
    pub(super) fn hotspot_at(&self, at: DVec2) -> Option<usize> {
        if !self.hotspots.shown {
            return None;
        }
        let shown = self.shown();
        let hotspots = &self.drawing().hotspots;
        let seen = self.hotspots.seen(&shown);
        let under = seen
            .iter()
            .filter(|seen| seen.part.shows(at, shown.aspect) && contains(&seen.outline, at));
        let area = |index: &usize| hotspots[*index].area_mm2();
        under
            .map(|seen| seen.hotspot)
            .min_by(|a, b| area(a).total_cmp(&area(b)))
    }

    /// Follows a wish that is about hotspots.
    pub(super) fn point_out(&mut self, intent: Intent) {
        match intent {
            Intent::Hotspots => {
                self.hotspots.shown = !self.hotspots.shown;
                self.hotspots.open = None;
            }
            Intent::Tap(at) if self.hotspots.shown => match self.hotspot_at(at) {
                Some(index) if self.open_index() == Some(index) => self.go_on(),
                hit => self.open(hit),
            },
            Intent::StepHotspot(by) => {
                self.hotspots.shown = true;
                let mut seen: Vec<usize> = self
                    .hotspots
                    .seen(&self.shown())
                    .iter()
                    .map(|seen| seen.hotspot)
                    .collect();
                seen.sort_unstable();
                seen.dedup();
                let open = self.open_index();
                let at = open.and_then(|open| seen.iter().position(|index| *index == open));
                let next = match at {
                    Some(at) => wrapped(at, by, seen.len()),
                    None if by < 0 => seen.len().saturating_sub(1),
                    None => 0,
                };
                self.open(seen.get(next).copied());
            }
            Intent::GoOn => self.go_on(),
            _ => {}
        }
    }

    fn open_index(&self) -> Option<usize> {
        let id = &self.open_hotspot()?.id;
        let hotspots = self.drawing().hotspots.iter();
        hotspots
            .map(|hotspot| &hotspot.id)
            .position(|other| other == id)
    }

    fn open(&mut self, index: Option<usize>) {
        self.hotspots.open = index.map(|index| self.drawing().hotspots[index].id.clone());
    }

    /// To the scene of the open hotspot, if it leads to one.
    fn go_on(&mut self) {
        if let Some(scene) = self.open_hotspot().and_then(|hotspot| hotspot.scene) {
            self.enter(scene);
        }
    }
}

/// Lays the outlines over the picture.
pub fn lay(
    (shown, shape, mut hand): (Res<Shown>, Res<Shape>, ResMut<Hand>),
    glass: Res<Glass>,
    mut marks: ResMut<Marks>,
) {
    let mut outlines = Vec::new();
    if hand.shows_hotspots() {
        let drawing = shown.exhibit.drawing_of(&shown.scene);
        if let Some(surface) = shape.of(drawing) {
            // No change of what is shown.
            let hand = hand.bypass_change_detection();
            hand.hotspots.learn(drawing, surface);
        }
        let open = hand.open_index();
        for seen in hand.hotspots.seen(&shown) {
            let ink = match open == Some(seen.hotspot) {
                true => Ink::Open,
                false => Ink::Quiet,
            };
            let picture = (shown.aspect, glass.size);
            outlines.extend(marks::lines(&seen.outline, true, &seen.part, picture, ink));
        }
    }
    if marks.hotspots != outlines {
        marks.hotspots = outlines;
    }
}
