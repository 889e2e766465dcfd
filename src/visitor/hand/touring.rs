//! Scenes that follow each other while nobody is there: the eye travels from one to the next, the lamp
//! goes to and fro, and nothing stays on the same pixels for long.

use std::f64::consts::TAU;

use glam::DVec2;

use super::Hand;
use crate::{
    manifest::exhibit::{Camera, Exhibit},
    units::Degrees,
    visitor::lamp::LampPlace,
};

/// How long the eye travels, in seconds.
const TRAVEL_S: f64 = 3.0;
/// How far the lamp goes to either side, in degrees, and how long there and back takes.
const SWEEP_DEG: f64 = 40.0;
const SWEEP_S: f64 = 12.0;
/// How far the picture drifts, of its width, and how long it takes.
const DRIFT: DVec2 = DVec2::new(0.008, 0.006);
const DRIFT_S: DVec2 = DVec2::new(47.0, 61.0);
/// Scenes of an exhibit without a tour, in seconds each.
const STOP_S: f64 = 10.0;
/// The tour that is meant for a wall where nobody is.
const ATTRACT: &str = "attract";

/// A stop of a tour.
#[derive(Clone, Debug)]
pub(super) struct Stop {
    /// Where the eye comes from, where that is another part of the same sheet.
    from: Option<Camera>,
    lamp: Option<LampPlace>,
    /// Since it began, and since the tour did.
    seconds: f64,
    all: f64,
}

/// The stops of the tour, each a scene with its seconds: the tour for a wall where nobody is, or else the
/// first one, or else all scenes.
pub fn stops(exhibit: &Exhibit) -> Vec<(usize, f64)> {
    let meant = exhibit.tours.iter().find(|tour| tour.id == ATTRACT);
    match meant.or(exhibit.tours.first()) {
        Some(tour) => tour.stops.clone(),
        None => (0..exhibit.scenes.len())
            .map(|scene| (scene, STOP_S))
            .collect(),
    }
}

impl Hand {
    /// The tour comes to a scene.
    pub fn stop_at(&mut self, scene: usize) {
        if scene >= self.exhibit.scenes.len() || self.refused.contains(&scene) {
            return;
        }
        let seen = |hand: &Self| {
            let scene = hand.written();
            (scene.drawing, hand.view.side, scene.compare.is_some())
        };
        let (before, from) = (seen(self), self.camera());
        let all = self.stop.as_ref().map_or(0.0, |stop| stop.all);
        self.enter(scene);
        self.stop = Some(Stop {
            from: (before == seen(self) && !self.calm).then_some(from),
            lamp: self.view.lamp,
            seconds: 0.0,
            all,
        });
    }

    /// A visitor takes over where the tour is.
    pub fn end_tour(&mut self) {
        self.stop = None;
    }

    /// Lets the tour go on by `seconds`.
    pub(super) fn tour(&mut self, seconds: f64) {
        let Some(mut stop) = self.stop.take() else {
            return;
        };
        stop.seconds += seconds;
        stop.all += seconds;
        if !self.calm {
            let size = self.drawing().size_mm;
            let to = self.written().camera.fitted(size, self.aspect());
            let t = (stop.seconds / TRAVEL_S).clamp(0.0, 1.0);
            let share = t * t * (3.0 - 2.0 * t);
            let mut camera = match stop.from {
                Some(from) => between(from, to, share),
                None => to,
            };
            let swing = (TAU * stop.all / DRIFT_S).map(f64::sin);
            camera.centre_mm += swing * DRIFT * camera.width_mm;
            self.view.camera = camera;
            if let Some(lamp) = stop.lamp {
                let by = SWEEP_DEG * (TAU * stop.seconds / SWEEP_S).sin();
                let away = lamp.towards_deg(lamp.azimuth_deg + by);
                self.place_lamp(|_| away);
            }
        }
        self.stop = Some(stop);
    }
}

/// A part of the way from one view to another: widths by their ratio, the shorter way round.
fn between(from: Camera, to: Camera, share: f64) -> Camera {
    let round = (to.turn.0 - from.turn.0 + 180.0).rem_euclid(360.0) - 180.0;
    Camera {
        centre_mm: from.centre_mm.lerp(to.centre_mm, share),
        width_mm: from.width_mm * (to.width_mm / from.width_mm).powf(share),
        tilt: Degrees(from.tilt.0 + (to.tilt.0 - from.tilt.0) * share),
        turn: Degrees(from.turn.0 + round * share),
        ..to
    }
}
