//! What goes on moving by itself, and comes to rest. Solved exactly, so that no frame rate
//! changes where it ends.

use glam::DVec2;

/// Time in which a glide loses all but 1/e of its speed, in seconds.
const GLIDE_S: f64 = 0.16;
/// Time over which the speed of a hand is averaged, in seconds.
const HAND_S: f64 = 0.06;
/// Rate at which a turned sheet swings back, in 1/s.
const SPRING_RATE: f64 = 9.0;
/// Time in which a zoom comes nearer by all but 1/e, in seconds.
const ZOOM_S: f64 = 0.09;
/// How long turning over takes, in seconds.
const FLIP_S: f64 = 0.6;

/// The speed of a hand, per second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Speed(pub DVec2);

impl Speed {
    /// The hand went on by `by`.
    pub fn push(&mut self, by: DVec2) {
        self.0 += by / HAND_S;
    }

    /// Time passes while the hand holds on.
    pub fn forget(&mut self, seconds: f64) {
        self.0 *= (-seconds / HAND_S).exp();
    }

    /// A push that glides on by `by` altogether.
    pub fn throw(by: DVec2) -> Self {
        Self(by / GLIDE_S)
    }

    /// How far a glide goes in `seconds`; it slows down.
    pub fn glide(&mut self, seconds: f64) -> DVec2 {
        let kept = (-seconds / GLIDE_S).exp();
        let gone = self.0 * (GLIDE_S * (1.0 - kept));
        self.0 *= kept;
        gone
    }

    /// How far it would still glide.
    pub fn reach(self) -> f64 {
        self.0.length() * GLIDE_S
    }
}

/// One step of a critically damped spring towards zero: the place and its speed after
/// `seconds`.
pub fn spring(place: DVec2, speed: Speed, seconds: f64) -> (DVec2, Speed) {
    let slope = speed.0 + place * SPRING_RATE;
    let kept = (-SPRING_RATE * seconds).exp();
    (
        (place + slope * seconds) * kept,
        Speed((speed.0 - slope * (SPRING_RATE * seconds)) * kept),
    )
}

/// A width on its way to `target`, after `seconds`.
pub fn approach(width: f64, target: f64, seconds: f64) -> f64 {
    target * (width / target).powf((-seconds / ZOOM_S).exp())
}

/// How far a sheet that has been turning over for `seconds` has got, 0…1, gently at both ends.
pub fn flip_progress(seconds: f64) -> f64 {
    let t = (seconds / FLIP_S).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_frame_rate_changes_nothing() {
        let start = DVec2::new(40.0, -10.0);
        let thrown = Speed(DVec2::new(100.0, 30.0));
        let (mut place, mut speed) = (start, thrown);
        let (mut gone, mut glide, mut width) = (DVec2::ZERO, thrown, 300.0);
        for _ in 0..10 {
            (place, speed) = spring(place, speed, 0.02);
            gone += glide.glide(0.02);
            width = approach(width, 80.0, 0.02);
        }
        let (once, _) = spring(start, thrown, 0.2);
        assert!((place - once).length() < 1e-9);
        assert!((gone - thrown.clone().glide(0.2)).length() < 1e-9);
        assert!((width - approach(300.0, 80.0, 0.2)).abs() < 1e-9);
    }

    #[test]
    fn a_steady_hand_is_measured_at_its_speed() {
        let mut speed = Speed::default();
        for _ in 0..200 {
            speed.forget(0.005);
            speed.push(DVec2::new(0.5, 0.0));
        }
        assert!((speed.0.x - 100.0).abs() < 6.0, "{speed:?}");
        speed.forget(1.0);
        assert!(speed.reach() < 1e-3);
    }
}
