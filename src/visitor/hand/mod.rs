//! The hand that holds the sheet: one state, changed by intents and by time, and what is to be
//! shown of it. No device, window or engine is needed to move it.

mod carrying;
pub mod mirrored;
mod retreat;
mod serving;
mod touring;

pub use retreat::Retreat;
pub use serving::Serving;
pub use touring::stops;

use std::{collections::BTreeSet, f64::consts::PI, sync::Arc};

use bevy::prelude::Resource;
use glam::DVec2;

use self::retreat::Good;
use super::{
    comparing::{self, TURN_S},
    hotspots::Hotspots,
    intent::Intent,
    lamp::LampPlace,
    motion::{self, Speed},
    view::{Glow, View, movable_lamp, wrapped},
};
use crate::{
    manifest::{
        exhibit::{CompareMode, Comparison, Drawing, Exhibit, LampColour, Scene},
        frames::other_side,
    },
    optics::tier::Tier,
    stage::Shown,
    units::Lux,
};

/// A hand turns the sheet no further, in degrees: its other side stays hidden.
const FARTHEST_TURN_DEG: f64 = 60.0;
/// A zoom this near its target, relatively, has arrived.
const ARRIVED: f64 = 1e-3;
/// A turned sheet this near to rest, in degrees and degrees per second, rests.
const REST_DEG: f64 = 0.02;
/// Longest step of a sheet that is being turned over, in seconds.
const FLIP_STEP_S: f64 = 0.1;
/// A glide that would go on by less of the picture's width has ended.
const GLIDE_END: f64 = 5e-4;

fn takes_turns(comparison: &Comparison) -> bool {
    comparison.mode == CompareMode::Flicker
}

/// What a drag does, decided when it begins to move.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Grip {
    Undecided,
    Turn,
    Move,
    /// The curtain or the loupe.
    Compare,
}

/// How large the picture is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picture {
    /// Width over height.
    pub aspect: f64,
    /// Width in mm on the display, which shows the sheet at true size when that many mm of it
    /// fill the picture.
    pub width_mm: f64,
    /// Whether the display's size is known or guessed.
    pub measured: bool,
}

/// What the hand holds.
#[derive(Resource, Clone, Debug)]
pub struct Hand {
    exhibit: Arc<Exhibit>,
    /// The same with the lamp where the hand put it.
    lit: Arc<Exhibit>,
    /// What the scene as written is exposed for, while its lamp is elsewhere.
    exposed_for: Option<Lux>,
    scene: usize,
    view: View,
    tier: Tier,
    /// Nobody asked for a tier: the accuracy that the exhibit asks for decides.
    free: bool,
    serving: Option<Serving>,
    picture: Picture,
    /// Motion is reduced to cuts.
    calm: bool,
    /// Instead of what scenes say.
    language: Option<String>,
    /// Where the picture is coming to be turned to, in degrees.
    straight: Option<f64>,
    /// Of a tour that nobody is there to see.
    stop: Option<touring::Stop>,
    /// A cheaper tier is good enough just now.
    hurried: bool,
    /// How the sheet is turned from rest: a rotation vector in the table's plane, in degrees.
    turn: DVec2,
    /// Degrees a second while it turns, mm a second while the picture moves.
    speed: Speed,
    grip: Option<Grip>,
    /// Width in mm that the picture is coming to, and about which place.
    zoom: Option<(f64, DVec2)>,
    /// Width in mm before true size.
    before_true_size: Option<f64>,
    /// For how long the member has been seen that has its turn, in seconds.
    turns_for: f64,
    /// Seconds since the sheet began to be turned over.
    flip: Option<f64>,
    /// Both sides are loaded and stay so.
    both_sides: bool,
    /// What could be shown last.
    good: Option<Good>,
    /// Scenes that could not be shown.
    refused: BTreeSet<usize>,
    /// Another machine's hand moves it.
    is_led: bool,
    pub(super) hotspots: Hotspots,
}

impl Hand {
    /// The scene of `exhibit` with this index, as written. `calm` reduces motion to cuts.
    pub fn new(
        exhibit: Arc<Exhibit>,
        scene: usize,
        tier: Tier,
        picture: Picture,
        calm: bool,
    ) -> Self {
        let view = View::of(&exhibit, &exhibit.scenes[scene]);
        Self {
            lit: exhibit.clone(),
            exposed_for: None,
            exhibit,
            scene,
            view,
            tier,
            free: false,
            serving: None,
            picture,
            calm,
            language: None,
            straight: None,
            stop: None,
            hurried: false,
            turn: DVec2::ZERO,
            speed: Speed::default(),
            grip: None,
            zoom: None,
            before_true_size: None,
            turns_for: 0.0,
            flip: None,
            both_sides: false,
            good: None,
            refused: BTreeSet::new(),
            is_led: false,
            hotspots: Hotspots::default(),
        }
    }

    /// The exhibit was read again: the same scene by its id, or the first, and of the view what
    /// is still there.
    pub fn replace(&mut self, exhibit: Arc<Exhibit>) {
        let was = self.written().clone();
        let (scene, is) = exhibit
            .scene(&was.id)
            .unwrap_or_else(|| (0, &exhibit.scenes[0]));
        if is.id == was.id {
            self.view = self.view.carried((&self.exhibit, &was), (&exhibit, is));
        } else {
            self.view = View::of(&exhibit, is);
            self.still();
        }
        // A sheet that is being turned over may no longer have that other side.
        if exhibit.drawing_of(is) != self.exhibit.drawing_of(&was) {
            self.flip = None;
        }
        self.scene = scene;
        self.exhibit = exhibit;
        self.refused.clear();
        self.relight();
    }

    /// The picture has another size now.
    pub fn resize(&mut self, picture: Picture) {
        self.picture = picture;
    }

    /// Changes what an intent is about.
    pub fn apply(&mut self, intent: Intent) {
        match intent {
            Intent::Take => {
                self.speed = Speed::default();
                self.zoom = None;
                self.straight = None;
                self.grip = Some(Grip::Undecided);
            }
            Intent::Drag { from, to } => self.drag(from, to),
            Intent::Release => {
                self.grip = None;
                self.straighten();
            }
            Intent::Pan(share) => {
                let by = self.on_table(share * self.camera().width_mm);
                self.speed = Speed::default();
                if self.calm {
                    self.move_centre(by);
                } else {
                    self.speed = Speed::throw(by);
                }
            }
            Intent::Zoom { at, factor } => {
                let width = self.zoom.map_or(self.camera().width_mm, |(width, _)| width);
                self.zoom_to(width / factor, at);
            }
            Intent::Pinch {
                from,
                to,
                factor,
                turn,
            } => {
                self.set_width(self.camera().width_mm / factor, from);
                self.turn_picture(turn, from);
                self.shift(from, to);
            }
            // Two clicks on a hotspot are about it.
            Intent::TrueSize { at } if self.hotspot_at(at).is_some() => {}
            Intent::TrueSize { at } => self.true_size(at),
            Intent::Flip => self.turn_over(),
            Intent::Home => self.enter(self.scene),
            Intent::MoveLamp(by) => {
                let by = self.on_table(by);
                self.place_lamp(|lamp| lamp.moved(by));
            }
            Intent::RaiseLamp(elevation) => {
                self.place_lamp(|lamp| lamp.raised(elevation));
                self.adapt();
            }
            Intent::LampTo(place) => {
                let place = self.on_table(place);
                self.place_lamp(|lamp| lamp.to(place));
            }
            Intent::SetLamp {
                elevation_deg,
                azimuth_deg,
            } => {
                let turned = azimuth_deg + self.view.camera.turn.0;
                self.place_lamp(|lamp| lamp.raised(elevation_deg).towards_deg(turned));
                self.adapt();
            }
            Intent::Warmth(kelvin) => {
                self.view.glow.kelvin = Some(kelvin);
                self.relight();
            }
            Intent::Intensity(gain) => {
                self.view.glow.gain = gain;
                self.relight();
            }
            Intent::SwitchTable => {
                let written = self.written().transmitted;
                self.view.transmitted = match self.view.transmitted {
                    share if share < 1.0 => 1.0,
                    _ if written < 1.0 => written,
                    _ => 0.0,
                };
            }
            Intent::GoTo(scene) => {
                if scene < self.exhibit.scenes.len() && !self.refused.contains(&scene) {
                    self.enter(scene);
                }
            }
            Intent::Compare(mode) => {
                let scene = self.shown().scene;
                let written = self.written().compare.clone();
                let compared =
                    |mode| comparing::in_mode(&self.exhibit, &scene, written.as_ref(), mode);
                self.view.compare = mode.map(compared);
                self.turns_for = 0.0;
            }
            Intent::MoveCompare { from, to } => {
                if let Some(comparison) = &mut self.view.compare {
                    comparison.drag(from, to, self.picture.aspect);
                }
            }
            Intent::StepCompare(by) => {
                let scene = self.shown().scene;
                let written = self.written().compare.clone();
                self.view.compare = comparing::stepped(&self.exhibit, &scene, written.as_ref(), by);
                self.turns_for = 0.0;
            }
            Intent::StepState(_)
            | Intent::StepOverlay
            | Intent::Opacity(_)
            | Intent::StepCategory(_)
            | Intent::ShiftCompare(_)
            | Intent::TurnCompare(_)
            | Intent::Transmit(_)
            | Intent::TransmitTo(_)
            | Intent::CompareTo(_)
            | Intent::Overlay(_)
            | Intent::OpacityTo(_)
            | Intent::ReliefOnly
            | Intent::Exaggerate
            | Intent::Stretch
            | Intent::Sharpen => {
                let drawing = self.exhibit.drawing_of(&self.exhibit.scenes[self.scene]);
                self.view.follow(drawing, intent);
            }
            Intent::StepScene(by) => {
                let count = self.exhibit.scenes.len();
                let mut next = wrapped(self.scene, by, count);
                while self.refused.contains(&next) && next != self.scene {
                    next = wrapped(next, by, count);
                }
                self.enter(next);
            }
            Intent::StepTier(by) => {
                let from = self.tier_at_rest();
                let at = Tier::ALL.iter().position(|tier| *tier == from);
                self.free = false;
                self.tier = Tier::ALL[wrapped(at.unwrap_or_default(), by, Tier::ALL.len())];
            }
            Intent::Tap(_) | Intent::Hotspots | Intent::StepHotspot(_) | Intent::GoOn => {
                self.point_out(intent);
            }
            Intent::StepTool(_)
            | Intent::Tool(_)
            | Intent::StepFocus(_)
            | Intent::Controls
            | Intent::Activate
            | Intent::TakeBack
            | Intent::ReadOut
            | Intent::Export { .. }
            | Intent::SaveView
            | Intent::Link
            | Intent::Caption
            | Intent::Keys
            | Intent::Fullscreen
            | Intent::Quit => {}
        }
    }

    /// Lets `seconds` pass. A sheet is turned over only while what is shown is `settled`: its
    /// other side may still be loading.
    pub fn advance(&mut self, seconds: f64, settled: bool) {
        self.tour(if settled { seconds } else { 0.0 });
        // Once loaded, the other side stays at hand.
        self.both_sides |= self.is_steep();
        if let Some((target, at)) = self.zoom {
            let next = motion::approach(self.camera().width_mm, target, seconds);
            let arrived = (next / target - 1.0).abs() < ARRIVED;
            self.set_width(if arrived { target } else { next }, at);
            if arrived {
                self.zoom = None;
            }
        }
        if let Some(target) = self.straight {
            let left = target - self.view.camera.turn.0;
            let (left, _) = motion::spring(DVec2::new(left, 0.0), Speed::default(), seconds);
            let arrived = left.x.abs() < REST_DEG;
            self.view.camera.turn.0 = if arrived { target } else { target - left.x };
            if arrived {
                self.straight = None;
            }
        }
        if let Some(elapsed) = self.flip
            && settled
        {
            // Slow frames slow it down: none of them is to skip it.
            let elapsed = elapsed + seconds.min(FLIP_STEP_S);
            self.flip = Some(elapsed);
            if motion::flip_progress(elapsed) >= 1.0 {
                self.finish_flip();
            }
        }
        if let Some(comparison) = self.view.compare.as_mut().filter(|c| takes_turns(c))
            && settled
            && !self.calm
        {
            self.turns_for += seconds.min(TURN_S);
            if self.turns_for >= TURN_S {
                self.turns_for = 0.0;
                comparing::take_turns(comparison);
            }
        }
        if self.grip.is_some() {
            self.speed.forget(seconds);
        } else if self.turn != DVec2::ZERO {
            let (turn, speed) = motion::spring(self.turn, self.speed, seconds);
            self.turn = turn.clamp_length_max(FARTHEST_TURN_DEG);
            self.speed = speed;
            if self.calm || (turn.length() < REST_DEG && speed.0.length() < REST_DEG) {
                self.turn = DVec2::ZERO;
                self.speed = Speed::default();
            }
        } else if self.speed != Speed::default() {
            let by = self.speed.glide(seconds);
            self.move_centre(by);
            if self.calm || self.speed.reach() < GLIDE_END * self.camera().width_mm {
                self.speed = Speed::default();
            }
        }
    }

    /// Whether members of a comparison take turns by themselves.
    pub fn takes_turns(&self) -> bool {
        !self.calm && !self.is_led && self.view.compare.as_ref().is_some_and(takes_turns)
    }

    /// Whether something goes on moving without being touched.
    pub fn is_moving(&self) -> bool {
        let glides = self.turn != DVec2::ZERO || self.speed != Speed::default();
        let comes = self.stop.is_some() && !self.calm
            || self.zoom.is_some()
            || self.straight.is_some()
            || self.flip.is_some();
        !self.is_led && (comes || (glides && self.grip.is_none()))
    }

    /// What is to be shown.
    pub fn shown(&self) -> Shown {
        let progress = self.flip.map_or(0.0, motion::flip_progress);
        let mut scene = self.written().clone();
        let drawing = self.drawing();
        scene.camera = self.camera();
        scene.side = self.view.side;
        scene.state = self.view.state;
        scene.compare.clone_from(&self.view.compare);
        scene.enhance = self.view.enhance;
        scene.transmitted = self.view.transmitted;
        if self.language.is_some() {
            scene.language.clone_from(&self.language);
        }
        // A lamp that is lowered darkens the sheet, as before the eyes of a visitor.
        if self.exposed_for.is_some() {
            scene.exposure.illuminance = self.exposed_for;
        }
        if self.flip.is_some() {
            // The place under view stays the same place of the sheet while it goes round.
            let there = other_side(scene.camera.centre_mm, drawing.size_mm, drawing.flip);
            let part = (1.0 - (PI * progress).cos()) / 2.0;
            scene.camera.centre_mm = scene.camera.centre_mm.lerp(there, part);
            if progress >= 0.5 {
                scene.side = scene.side.other();
            }
        }
        scene.overlays = self.view.overlays(drawing, scene.side);
        scene.categories.clone_from(&self.view.categories);
        let pose = self.turned() * self.half_turned(progress);
        Shown {
            exhibit: self.lit.clone(),
            scene,
            tier: match self.tier_at_rest() {
                tier @ (Tier::Gallery | Tier::Study) if self.hurried => {
                    self.serving
                        .map_or(Tier::Draft, |serving| match serving.in_motion {
                            // Of another wish, which was dearer.
                            Tier::Study if tier == Tier::Gallery => tier,
                            in_motion => in_motion,
                        })
                }
                tier => tier,
            },
            pose,
            both_sides: self.both_sides || self.is_steep(),
            aspect: self.picture.aspect,
        }
    }

    /// How large the picture is.
    pub fn picture(&self) -> Picture {
        self.picture
    }

    /// The exhibit's first scene as written, in the language of scenes, or in this one.
    pub fn go_home(&mut self, language: Option<String>) {
        self.stop = None;
        self.language = language;
        self.hotspots = Hotspots::default();
        self.enter(0);
    }

    /// What is shown belongs to it, with its lamps where they are written.
    pub fn exhibit(&self) -> &Arc<Exhibit> {
        &self.exhibit
    }

    /// What is shown as a scene, at rest, with the exhibit that its lamps belong to.
    pub fn view(&self) -> (Arc<Exhibit>, Scene) {
        let mut scene = self.shown().scene;
        // Not as it is halfway round, nor fitted to this picture's shape.
        scene.side = self.view.side;
        scene.camera = self.view.camera;
        scene.overlays = self.view.overlays(self.drawing(), scene.side);
        (self.lit.clone(), scene)
    }

    /// Index of the scene that the view is of.
    pub fn scene(&self) -> usize {
        self.scene
    }

    /// The temperature of that lamp's colour as it is written, in kelvin, where it has one.
    pub fn written_kelvin(&self) -> Option<f64> {
        let lamp = movable_lamp(&self.exhibit, self.written())?;
        match self.exhibit.lamps[lamp].colour {
            LampColour::Temperature(kelvin) => Some(kelvin.0),
            LampColour::Chromaticity(_) => None,
        }
    }

    /// The light of that lamp.
    pub fn glow(&self) -> Glow {
        self.view.glow
    }

    /// Where that lamp stands as seen from above, of the hemisphere's radius, y up in the picture.
    pub fn lamp_seen(&self) -> Option<DVec2> {
        let turn = DVec2::from_angle(-self.view.camera.turn.radians());
        self.view.lamp.map(|lamp| turn.rotate(lamp.seen()))
    }

    /// Every overlay of the side in view, and its opacity where it is on.
    pub fn layers(&self) -> Vec<(usize, Option<f64>)> {
        self.view.layers(self.drawing())
    }

    /// Comparisons that have something to compare.
    pub fn comparisons(&self) -> Vec<CompareMode> {
        let scene = self.shown().scene;
        comparing::modes(&self.exhibit, &scene, self.written().compare.as_ref())
    }

    /// What everything is read in; without one, as scenes say.
    pub fn language(&self) -> Option<&str> {
        self.language.as_deref()
    }

    /// Everything is read in `language` (BCP 47) from now on; without one, as scenes say.
    pub fn speak(&mut self, language: Option<String>) {
        self.language = language;
    }

    /// Whether motion is reduced to cuts.
    pub fn calm(&mut self, calm: bool) {
        self.calm = calm;
    }

    /// Where the lamp stands that the hand moves.
    pub fn lamp(&self) -> Option<LampPlace> {
        self.view.lamp
    }

    /// Whether the sheet is seen at true size, and if so whether the display's size is known.
    pub fn at_true_size(&self) -> Option<bool> {
        let width = self.camera().width_mm;
        let at_true = (width / self.true_width_mm() - 1.0).abs() < 2.0 * ARRIVED;
        at_true.then_some(self.picture.measured)
    }

    fn written(&self) -> &Scene {
        &self.exhibit.scenes[self.scene]
    }

    pub(super) fn drawing(&self) -> &Drawing {
        self.exhibit.drawing_of(self.written())
    }

    pub(super) fn enter(&mut self, scene: usize) {
        self.close_hotspot();
        self.scene = scene;
        self.view = View::of(&self.exhibit, self.written());
        self.still();
        self.relight();
    }

    fn still(&mut self) {
        self.turn = DVec2::ZERO;
        self.speed = Speed::default();
        self.grip = None;
        self.zoom = None;
        self.straight = None;
        self.before_true_size = None;
        self.flip = None;
        self.both_sides = false;
    }

    fn place_lamp(&mut self, change: impl FnOnce(LampPlace) -> LampPlace) {
        self.view.lamp = self.view.lamp.map(change);
        self.relight();
    }

    /// Another set-up of the lamp, to which the eye adapts, unlike a lamp that is only moved.
    fn adapt(&mut self) {
        if self.exposed_for.is_some() {
            self.exposed_for = Some(Lux(self.lit.lighting(self.written()).reference_lux));
        }
    }

    fn relight(&mut self) {
        self.lit = self.view.lit(&self.exhibit, self.written());
        let moved = !Arc::ptr_eq(&self.lit, &self.exhibit);
        let held = self.exposed_for.take();
        self.exposed_for = moved.then(|| {
            held.unwrap_or_else(|| Lux(self.exhibit.lighting(self.written()).reference_lux))
        });
    }
}
