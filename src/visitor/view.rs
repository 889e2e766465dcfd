//! What a hand can change of a scene, and what of it outlives a new version of the exhibit.

use std::{collections::BTreeMap, sync::Arc};

use glam::DVec2;

use super::{comparing, intent::Intent, lamp::LampPlace};
use crate::manifest::exhibit::{
    Camera, Comparison, Drawing, Enhancement, Exhibit, LampColour, MAX_OVERLAYS, OverlayKind,
    Scene, SideName,
};
use crate::units::Kelvin;

/// Opacity of an overlay that the scene does not mention.
const OPACITY: f64 = 0.7;
/// An overlay that is on can be made no fainter.
const FAINTEST: f64 = 0.1;

/// The relief is made no steeper.
const STEEPEST: f64 = 8.0;
/// Levels between which a key stretches the contrast: most drawings on old paper lie between them.
const STRETCH: DVec2 = DVec2::new(0.1, 0.75);
/// Of sharpening, by a key.
const SHARPEN: f64 = 0.6;

/// An overlay as the hand left it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Index into the drawing's overlays.
    pub overlay: usize,
    pub opacity: f64,
    pub on: bool,
}

/// The light of the lamp in the hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glow {
    /// Its colour, where the hand changed it.
    pub kelvin: Option<f64>,
    /// Factor of what is written.
    pub gain: f64,
}

impl Default for Glow {
    fn default() -> Self {
        Self {
            kelvin: None,
            gain: 1.0,
        }
    }
}

/// The changeable part of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    pub side: SideName,
    pub camera: Camera,
    /// Index into the drawing's states.
    pub state: Option<usize>,
    /// Every overlay of the drawing, those of the scene first, from the lowest.
    pub layers: Vec<Layer>,
    /// Of overlays of which not all categories are shown, those that are, as in a scene.
    pub categories: BTreeMap<usize, Vec<usize>>,
    /// Of the first lamp that can be moved.
    pub lamp: Option<LampPlace>,
    pub glow: Glow,
    pub compare: Option<Comparison>,
    pub enhance: Enhancement,
    /// Share of the light that comes through the sheet.
    pub transmitted: f64,
}

impl View {
    /// As the scene is written.
    pub fn of(exhibit: &Exhibit, scene: &Scene) -> Self {
        let drawing = exhibit.drawing_of(scene);
        let mut layers: Vec<Layer> = scene
            .overlays
            .iter()
            .map(|&(overlay, opacity)| Layer {
                overlay,
                opacity,
                on: opacity > 0.0,
            })
            .collect();
        for overlay in 0..drawing.overlays.len() {
            if layers.iter().all(|layer| layer.overlay != overlay) {
                layers.push(Layer {
                    overlay,
                    opacity: OPACITY,
                    on: false,
                });
            }
        }
        Self {
            side: scene.side,
            camera: scene.camera,
            state: scene.state,
            layers,
            categories: scene.categories.clone(),
            lamp: movable_lamp(exhibit, scene).and_then(|lamp| LampPlace::of(&exhibit.lamps[lamp])),
            glow: Glow::default(),
            compare: scene.compare.clone(),
            enhance: scene.enhance,
            transmitted: scene.transmitted,
        }
    }

    /// What this is in a new version of the exhibit: where the hand changed nothing, as the new
    /// scene is written; where it did, and the new drawing has it still, as the hand left it.
    pub fn carried(&self, (old, was): (&Exhibit, &Scene), (new, is): (&Exhibit, &Scene)) -> Self {
        let written = Self::of(old, was);
        let mut view = Self::of(new, is);
        let (before, after) = (old.drawing_of(was), new.drawing_of(is));
        if before.id != after.id {
            return view;
        }
        if self.side != written.side {
            view.side = self.side;
        }
        if self.camera != written.camera && before.size_mm == after.size_mm {
            view.camera = self.camera;
        }
        if self.state != written.state {
            view.state = match self.state {
                None => None,
                Some(state) => match after.state(&before.states[state].id) {
                    Some((index, _)) => Some(index),
                    None => view.state,
                },
            };
        }
        if self.layers != written.layers {
            for layer in &mut view.layers {
                let id = &after.overlays[layer.overlay].id;
                let mine = self
                    .layers
                    .iter()
                    .find(|mine| before.overlays[mine.overlay].id == *id);
                if let Some(mine) = mine {
                    (layer.on, layer.opacity) = (mine.on, mine.opacity);
                }
            }
        }
        // Categories are known by their places.
        if self.categories != written.categories && before.overlays == after.overlays {
            view.categories = self.categories.clone();
        }
        if self.lamp != written.lamp && view.lamp.is_some() {
            view.lamp = self.lamp;
        }
        view.glow = self.glow;
        // What is compared is known by its place: it is kept where the places are the same.
        let at_first = |view: &Self| {
            let mut compare = view.compare.clone();
            // Whose turn it is passes by itself.
            compare
                .iter_mut()
                .for_each(|comparison| comparison.turn = 0);
            compare
        };
        let same_drawings = old.drawings.len() == new.drawings.len()
            && old
                .drawings
                .iter()
                .zip(&new.drawings)
                .all(|(a, b)| a.id == b.id);
        if at_first(self) != at_first(&written) && same_drawings && is_alike(before, after) {
            view.compare = self.compare.clone();
        }
        if self.enhance != written.enhance {
            view.enhance = self.enhance;
        }
        if self.transmitted != written.transmitted {
            view.transmitted = self.transmitted;
        }
        view
    }

    /// Follows a wish that is about nothing else.
    pub fn follow(&mut self, drawing: &Drawing, intent: Intent) {
        match intent {
            Intent::StepState(by) => {
                self.step_state(drawing, by);
            }
            Intent::StepOverlay => {
                self.step_overlay(drawing);
            }
            Intent::Opacity(by) => self.fade(by),
            Intent::OpacityTo(opacity) => {
                for layer in self.layers.iter_mut().filter(|layer| layer.on) {
                    layer.opacity = opacity.clamp(FAINTEST, 1.0);
                }
            }
            Intent::Overlay(overlay) => {
                let mut mine = self.layers.iter_mut();
                if let Some(layer) = mine.find(|layer| layer.overlay == overlay) {
                    layer.on = !layer.on;
                    layer.opacity = layer.opacity.max(FAINTEST);
                }
            }
            Intent::TransmitTo(share) => self.transmitted = share.clamp(0.0, 1.0),
            Intent::CompareTo(at) => {
                if let Some(comparison) = &mut self.compare {
                    comparison.at = at.clamp(0.0, 1.0);
                }
            }
            Intent::StepCategory(by) => self.step_category(drawing, by),
            Intent::ShiftCompare(by) => {
                if let Some(comparison) = &mut self.compare {
                    comparing::shift(comparison, by);
                }
            }
            Intent::TurnCompare(by) => {
                if let Some(comparison) = &mut self.compare {
                    comparing::turn(comparison, by);
                }
            }
            Intent::Transmit(by) => {
                // In hundredths, so that it comes back to none.
                let share = ((self.transmitted + by) * 100.0).round() / 100.0;
                self.transmitted = share.clamp(0.0, 1.0);
            }
            Intent::ReliefOnly => {
                let enhance = &mut self.enhance;
                enhance.relief_only = !enhance.relief_only;
            }
            Intent::Exaggerate => {
                let enhance = &mut self.enhance;
                enhance.exaggerate = match enhance.exaggerate {
                    times if times >= STEEPEST => 1.0,
                    times => 2.0 * times,
                };
            }
            Intent::Stretch => {
                let enhance = &mut self.enhance;
                enhance.stretch = match enhance.stretch {
                    None => Some(STRETCH),
                    Some(_) => None,
                };
            }
            Intent::Sharpen => {
                let enhance = &mut self.enhance;
                enhance.sharpen = if enhance.sharpen > 0.0 { 0.0 } else { SHARPEN };
            }
            _ => {}
        }
    }

    /// Whether `other` shows the same of the sheet, wherever eye and lamp are: these need no
    /// maps.
    pub fn shows_as(&self, other: &Self) -> bool {
        let compared = |view: &Self| view.compare.as_ref().map(|c| (c.mode, c.of.clone()));
        (self.side, self.state) == (other.side, other.state)
            && self.layers == other.layers
            && self.categories == other.categories
            && compared(self) == compared(other)
            && self.enhance.relief_only == other.enhance.relief_only
            && (self.transmitted > 0.0) == (other.transmitted > 0.0)
    }

    /// Every overlay of this side, by its place in the drawing, and its opacity where it is on.
    pub fn layers(&self, drawing: &Drawing) -> Vec<(usize, Option<f64>)> {
        let mine = self.layers.iter();
        let mine = mine.filter(|layer| drawing.overlays[layer.overlay].side == self.side);
        let mut mine: Vec<_> = mine
            .map(|layer| (layer.overlay, layer.on.then_some(layer.opacity)))
            .collect();
        mine.sort_by_key(|(overlay, _)| *overlay);
        mine
    }

    /// The overlays that lie on `side`, from the lowest.
    pub fn overlays(&self, drawing: &Drawing, side: SideName) -> Vec<(usize, f64)> {
        self.layers
            .iter()
            .filter(|layer| layer.on && drawing.overlays[layer.overlay].side == side)
            .map(|layer| (layer.overlay, layer.opacity))
            .take(MAX_OVERLAYS)
            .collect()
    }

    /// To the next choice: none of the side's overlays, each of them, all of them but the bands of
    /// stacks, which would cover each other.
    pub fn step_overlay(&mut self, drawing: &Drawing) {
        let mut mine: Vec<&mut Layer> = self
            .layers
            .iter_mut()
            .filter(|layer| drawing.overlays[layer.overlay].side == self.side)
            .collect();
        mine.sort_by_key(|layer| layer.overlay);
        let count = mine.len();
        let on: Vec<usize> = (0..count).filter(|&layer| mine[layer].on).collect();
        // They stand behind the manifest's own.
        let is_own = |layer: &&&mut Layer| {
            !matches!(drawing.overlays[layer.overlay].kind, OverlayKind::Bands(_))
        };
        let own = mine.iter().filter(is_own).count();
        let next = match on[..] {
            [] => 0..count.min(1),
            [one] if one + 1 < count => one + 1..one + 2,
            [_] if own > 1 => 0..own,
            _ => 0..0,
        };
        for (index, layer) in mine.into_iter().enumerate() {
            layer.on = next.contains(&index);
            // One that the scene names at no opacity would stay unseen.
            layer.opacity = layer.opacity.max(FAINTEST);
        }
    }

    /// To the next category of the uppermost overlay in view that has more than one, alone, or back,
    /// with all of them between the last and the first.
    fn step_category(&mut self, drawing: &Drawing, by: i32) {
        let entries = |overlay: usize| match &drawing.overlays[overlay].kind {
            OverlayKind::Categorical(entries) if entries.len() > 1 => Some(entries.len()),
            _ => None,
        };
        let shown = self.overlays(drawing, self.side);
        let found = shown.iter().rev();
        let found = found.filter_map(|(overlay, _)| Some((*overlay, entries(*overlay)?)));
        let Some((overlay, count)) = found.into_iter().next() else {
            return;
        };
        let alone = match self.categories.get(&overlay).map(Vec::as_slice) {
            Some([one]) => one + 1,
            _ => 0,
        };
        match wrapped(alone, by, count + 1).checked_sub(1) {
            Some(one) => self.categories.insert(overlay, vec![one]),
            None => self.categories.remove(&overlay),
        };
    }

    /// Makes the overlays that are on stronger or fainter.
    pub fn fade(&mut self, by: f64) {
        for layer in self.layers.iter_mut().filter(|layer| layer.on) {
            layer.opacity = (layer.opacity + by).clamp(FAINTEST, 1.0);
        }
    }

    /// To the next state or back, past the sheet as its sides describe it.
    pub fn step_state(&mut self, drawing: &Drawing, by: i32) {
        let place = self.state.map_or(0, |state| state + 1);
        let next = wrapped(place, by, drawing.states.len() + 1);
        self.state = next.checked_sub(1);
    }

    /// The exhibit with the scene's lamp where the hand put it.
    pub fn lit(&self, exhibit: &Arc<Exhibit>, scene: &Scene) -> Arc<Exhibit> {
        match (movable_lamp(exhibit, scene), self.lamp) {
            (Some(lamp), Some(place))
                if LampPlace::of(&exhibit.lamps[lamp]) != self.lamp
                    || self.glow != Glow::default() =>
            {
                let mut lit = Exhibit::clone(exhibit);
                let lamp = &mut lit.lamps[lamp];
                place.put(lamp);
                if let Some(kelvin) = self.glow.kelvin {
                    lamp.colour = LampColour::Temperature(Kelvin(kelvin));
                }
                lamp.kind.dim(self.glow.gain);
                Arc::new(lit)
            }
            _ => exhibit.clone(),
        }
    }
}

/// Whether two drawings have the same states, sides and overlays, by their places.
fn is_alike(a: &Drawing, b: &Drawing) -> bool {
    let states = |d: &Drawing| d.states.iter().map(|s| s.id.clone()).collect::<Vec<_>>();
    let overlays = |d: &Drawing| d.overlays.iter().map(|o| o.id.clone()).collect::<Vec<_>>();
    states(a) == states(b) && overlays(a) == overlays(b) && a.verso.is_some() == b.verso.is_some()
}

/// `place` of `count` after `by` steps, around.
pub fn wrapped(place: usize, by: i32, count: usize) -> usize {
    let count = count.max(1) as i64;
    (place as i64 + i64::from(by)).rem_euclid(count) as usize
}

/// Index of the scene's first lamp that a hand can move.
pub fn movable_lamp(exhibit: &Exhibit, scene: &Scene) -> Option<usize> {
    let movable = |lamp: &usize| LampPlace::of(&exhibit.lamps[*lamp]).is_some();
    scene.lamps.iter().copied().find(movable)
}
