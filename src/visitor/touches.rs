//! Contacts on the glass → what they do to the sheet: fingers, palms, sleeves, of one visitor or of
//! many. Thresholds are lengths on the real display, so that a hand means the same on every wall.

use std::time::Duration;

use glam::{DVec2, Vec2};

/// A contact that stays this near to where it landed has not moved.
const DEAD_MM: f32 = 2.5;
/// Two taps this near each other in place and time are one double tap.
const DOUBLE_MM: f32 = 8.0;
const DOUBLE: Duration = Duration::from_millis(400);
/// A contact that stays longer is no tap.
const TAP: Duration = Duration::from_millis(900);
/// A contact of which nothing was heard for so long when another one lands is resting, not holding.
const REST: Duration = Duration::from_millis(1500);
/// Contacts that land this near each other at once, three or more, are a palm.
const PALM_MM: f32 = 30.0;
const PALM: Duration = Duration::from_millis(250);
/// Farther than this from those who hold the sheet is somebody else.
const ELSEWHERE_MM: f32 = 600.0;
/// A contact of which nothing was heard for so long is forgotten: its end was lost.
const LOST: Duration = Duration::from_secs(60);
/// Two fingers that go this far together within this time turn the sheet over.
const SWEEP_MM: f32 = 40.0;
const SWEEP: Duration = Duration::from_millis(500);
/// Fingers of a sweep keep their distance within this share.
const SWEEP_APART: f32 = 0.3;
/// A pinch begins to turn the sheet when it has gone round by so many radians.
const TWIST: f32 = 0.12;
/// One report of a contact magnifies by no more than this, whatever it says.
const PINCH_MAX: f32 = 2.0;
/// Fingers nearer than this, root mean square, say nothing of how they turn.
const APART_MM: f32 = 3.0;

/// What a contact does to the sheet. Places are in logical pixels from the top left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gesture {
    /// Somebody takes the sheet, with one more finger or one less.
    Take,
    Drag {
        from: Vec2,
        to: Vec2,
    },
    /// What lies at `from` comes to `to`, magnified by `factor` and turned by `turn` radians, anticlockwise
    /// as seen, about it.
    Pinch {
        from: Vec2,
        to: Vec2,
        factor: f32,
        turn: f32,
    },
    /// The last finger lets go.
    Release,
    Tap(Vec2),
    DoubleTap(Vec2),
    /// Two fingers went across together.
    Sweep,
}

/// One contact.
#[derive(Clone, Copy, Debug)]
struct Finger {
    id: u64,
    start: Vec2,
    at: Vec2,
    since: Duration,
    heard: Duration,
    moved: bool,
    /// Of a palm, of somebody else, or resting: it does nothing.
    ignored: Ignored,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ignored {
    No,
    /// Until it moves.
    Resting,
    /// Until those are gone who hold the sheet.
    Elsewhere,
    /// Until it is lifted.
    Palm,
}

/// The contacts on the sheet.
#[derive(Clone, Debug)]
pub struct Touches {
    /// Logical pixels per millimetre of the display.
    px_per_mm: f32,
    fingers: Vec<Finger>,
    /// How far the fingers have turned about their middle since the last of them came.
    twist: f32,
    /// As many at once as there were since the first one landed, and when that was.
    most: usize,
    since: Duration,
    /// When and where the last tap began, unless it was the second of two.
    last_tap: Option<(Duration, Vec2)>,
    /// The contact is the second of a double tap.
    doubled: bool,
    /// Two that went across together: where each landed and was lifted.
    swept: Vec<(Vec2, Vec2)>,
}

impl Default for Touches {
    fn default() -> Self {
        Self {
            px_per_mm: 96.0 / 25.4,
            fingers: Vec::new(),
            twist: 0.0,
            most: 0,
            since: Duration::ZERO,
            last_tap: None,
            doubled: false,
            swept: Vec::new(),
        }
    }
}

impl Touches {
    /// The display has so many logical pixels per millimetre (> 0).
    pub fn measure(&mut self, px_per_mm: f32) {
        self.px_per_mm = px_per_mm;
    }

    /// As it was told last.
    pub fn px_per_mm(&self) -> f32 {
        self.px_per_mm
    }

    /// Whether anybody holds the sheet of whom something was heard within this time, and not a thing that
    /// lies on it.
    pub fn is_held(&self, now: Duration, within: Duration) -> bool {
        let is_there = |finger: &Finger| now.saturating_sub(finger.heard) <= within;
        self.active().any(is_there)
    }

    /// A contact lands.
    pub fn land(&mut self, id: u64, at: Vec2, now: Duration, mut did: impl FnMut(Gesture)) {
        self.forget(now, &mut did);
        // The end of one with the same number was lost.
        self.drop_finger(id, &mut did);
        // What only lies there does not make one finger two.
        if self.active().count() == 0 {
            (self.most, self.since) = (0, now);
            self.swept.clear();
        }
        let mut finger = Finger {
            id,
            start: at,
            at,
            since: now,
            heard: now,
            moved: false,
            ignored: Ignored::No,
        };
        for other in &mut self.fingers {
            if other.ignored == Ignored::No && now.saturating_sub(other.heard) > REST {
                (other.ignored, other.start, other.moved) = (Ignored::Resting, other.at, false);
            }
        }
        if let Some(middle) = self.middle()
            && middle.distance(at) > ELSEWHERE_MM * self.px_per_mm
        {
            finger.ignored = Ignored::Elsewhere;
        }
        self.fingers.push(finger);
        self.find_palm(now);
        self.twist = 0.0;
        self.most = self.most.max(self.active().count());
        // A palm is no hand that takes the sheet, and no tap.
        if self.active().count() == 0 {
            did(Gesture::Release);
            return;
        }
        did(Gesture::Take);
        let before = self.last_tap.take().filter(|_| self.most == 1);
        self.doubled = before.is_some_and(|(then, place)| {
            let near = DOUBLE_MM * self.px_per_mm;
            now.saturating_sub(then) <= DOUBLE && place.distance(at) <= near
        });
        if self.doubled {
            did(Gesture::DoubleTap(at));
        }
    }

    /// A contact moves.
    pub fn go(&mut self, id: u64, to: Vec2, now: Duration, mut did: impl FnMut(Gesture)) {
        let dead = DEAD_MM * self.px_per_mm;
        let Some(index) = self.fingers.iter().position(|finger| finger.id == id) else {
            return;
        };
        let finger = &mut self.fingers[index];
        finger.heard = now;
        if !finger.moved {
            if finger.start.distance(to) <= dead {
                finger.at = to;
                return;
            }
            finger.moved = true;
            if finger.ignored == Ignored::Resting {
                finger.ignored = Ignored::No;
                finger.at = to;
                did(Gesture::Take);
                return;
            }
        }
        let from = std::mem::replace(&mut finger.at, to);
        if finger.ignored != Ignored::No {
            return;
        }
        let mut others: Vec<Vec2> = self.active().filter(|f| f.id != id).map(|f| f.at).collect();
        if others.is_empty() {
            did(Gesture::Drag { from, to });
            return;
        }
        others.push(from);
        let before = others.clone();
        if let Some(last) = others.last_mut() {
            *last = to;
        }
        let (factor, turn) = self.similarity(&before, &others);
        let is_twisting = self.twist.abs() > TWIST;
        self.twist += turn;
        did(Gesture::Pinch {
            from: mean(&before),
            to: mean(&others),
            factor,
            turn: if is_twisting { turn } else { 0.0 },
        });
    }

    /// A contact is lifted, or `cancelled` by the system.
    pub fn lift(&mut self, id: u64, now: Duration, cancelled: bool, mut did: impl FnMut(Gesture)) {
        let Some(finger) = self.drop_finger(id, &mut did) else {
            return;
        };
        let counts = finger.ignored == Ignored::No && !cancelled;
        if counts && finger.moved {
            self.swept.push((finger.start, finger.at));
        }
        if self.active().count() > 0 {
            return;
        }
        let took = now.saturating_sub(self.since);
        if self.most == 2 && took <= SWEEP && self.is_sweep() {
            did(Gesture::Sweep);
        }
        self.swept.clear();
        if counts && self.most == 1 && !finger.moved && now.saturating_sub(finger.since) <= TAP {
            did(Gesture::Tap(finger.start));
            self.last_tap = (!self.doubled).then_some((finger.since, finger.start));
        }
    }

    /// Nothing is touched any more, as far as anybody can tell.
    pub fn clear(&mut self, mut did: impl FnMut(Gesture)) {
        if !self.fingers.is_empty() {
            self.fingers.clear();
            did(Gesture::Release);
        }
    }

    /// Contacts whose end was lost.
    fn forget(&mut self, now: Duration, did: &mut impl FnMut(Gesture)) {
        let before = self.active().count();
        let lost = |finger: &Finger| now.saturating_sub(finger.heard) > LOST;
        self.fingers.retain(|finger| !lost(finger));
        if before > 0 && self.active().count() == 0 {
            did(Gesture::Release);
        }
    }

    /// Takes a contact away; those that are left take the sheet anew.
    fn drop_finger(&mut self, id: u64, did: &mut impl FnMut(Gesture)) -> Option<Finger> {
        let index = self.fingers.iter().position(|finger| finger.id == id)?;
        let finger = self.fingers.remove(index);
        self.twist = 0.0;
        if finger.ignored != Ignored::No {
            return Some(finger);
        }
        if self.active().count() > 0 {
            did(Gesture::Take);
            return Some(finger);
        }
        did(Gesture::Release);
        // Whoever stood aside may take it now.
        for other in &mut self.fingers {
            if other.ignored == Ignored::Elsewhere {
                (other.ignored, other.start, other.moved) = (Ignored::Resting, other.at, false);
            }
        }
        Some(finger)
    }

    fn active(&self) -> impl Iterator<Item = &Finger> {
        let active = |finger: &&Finger| finger.ignored == Ignored::No;
        self.fingers.iter().filter(active)
    }

    fn middle(&self) -> Option<Vec2> {
        let places: Vec<Vec2> = self.active().map(|finger| finger.at).collect();
        (!places.is_empty()).then(|| mean(&places))
    }

    /// Those that landed just now around the last one.
    fn find_palm(&mut self, now: Duration) {
        let Some(last) = self.fingers.last().map(|finger| finger.at) else {
            return;
        };
        let near = PALM_MM * self.px_per_mm;
        let is_part = |finger: &Finger| {
            finger.ignored == Ignored::Palm && finger.at.distance(last) <= near
                || now.saturating_sub(finger.since) <= PALM && finger.at.distance(last) <= near
        };
        if self.fingers.iter().filter(|finger| is_part(finger)).count() < 3 {
            return;
        }
        for finger in self.fingers.iter_mut().filter(|finger| is_part(finger)) {
            finger.ignored = Ignored::Palm;
        }
    }

    /// How places turn and grow about their middle, by least squares.
    fn similarity(&self, before: &[Vec2], after: &[Vec2]) -> (f32, f32) {
        let (from, to) = (mean(before).as_dvec2(), mean(after).as_dvec2());
        let (mut along, mut across, mut square) = (0.0, 0.0, 0.0);
        for (a, b) in before.iter().zip(after) {
            let (a, b) = (a.as_dvec2() - from, b.as_dvec2() - to);
            along += a.dot(b);
            across += a.perp_dot(b);
            square += a.length_squared();
        }
        let least = f64::from(APART_MM * self.px_per_mm);
        if square < least * least {
            return (1.0, 0.0);
        }
        let factor = (along.hypot(across) / square) as f32;
        // Down is positive on the glass.
        let turn = -across.atan2(along) as f32;
        (factor.clamp(1.0 / PINCH_MAX, PINCH_MAX), turn)
    }

    fn is_sweep(&self) -> bool {
        let [(a, a_end), (b, b_end)] = self.swept[..] else {
            return false;
        };
        let reach = SWEEP_MM * self.px_per_mm;
        let goes = |by: Vec2| by.x.abs() > reach && by.y.abs() < 0.6 * by.x.abs();
        let (by_a, by_b) = (a_end - a, b_end - b);
        let apart = (a.distance(b), a_end.distance(b_end));
        goes(by_a)
            && goes(by_b)
            && by_a.x.signum() == by_b.x.signum()
            && (apart.1 - apart.0).abs() <= SWEEP_APART * apart.0.max(reach)
    }
}

fn mean(places: &[Vec2]) -> Vec2 {
    let count = places.len().max(1) as f64;
    let sum: DVec2 = places.iter().map(|place| place.as_dvec2()).sum();
    (sum / count).as_vec2()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A place in mm of a display.
    fn mm(x: f32, y: f32) -> Vec2 {
        Vec2::new(x, y) * (96.0 / 25.4)
    }

    fn ms(ms: u64) -> Duration {
        Duration::from_millis(ms)
    }

    struct Glass {
        touches: Touches,
        did: Vec<Gesture>,
    }

    impl Glass {
        fn new() -> Self {
            Self {
                touches: Touches::default(),
                did: Vec::new(),
            }
        }

        fn land(&mut self, id: u64, at: Vec2, now: u64) {
            self.touches.land(id, at, ms(now), |g| self.did.push(g));
        }

        fn go(&mut self, id: u64, to: Vec2, now: u64) {
            self.touches.go(id, to, ms(now), |g| self.did.push(g));
        }

        fn lift(&mut self, id: u64, now: u64) {
            self.touches.lift(id, ms(now), false, |g| self.did.push(g));
        }

        fn take(&mut self) -> Vec<Gesture> {
            std::mem::take(&mut self.did)
        }

        /// Whether anything of the sheet was moved.
        fn moved(&mut self) -> bool {
            self.take()
                .iter()
                .any(|g| matches!(g, Gesture::Drag { .. } | Gesture::Pinch { .. }))
        }
    }

    #[test]
    fn a_finger_that_trembles_taps_and_two_taps_are_one_double_tap() {
        let mut glass = Glass::new();
        glass.land(1, mm(50.0, 50.0), 0);
        glass.go(1, mm(51.0, 51.5), 20);
        glass.lift(1, 90);
        assert!(glass.did.contains(&Gesture::Tap(mm(50.0, 50.0))));
        assert!(!glass.did.iter().any(|g| matches!(g, Gesture::DoubleTap(_))));
        assert!(!glass.moved());
        glass.land(1, mm(53.0, 52.0), 300);
        glass.lift(1, 380);
        assert!(glass.did.contains(&Gesture::DoubleTap(mm(53.0, 52.0))));
        glass.take();
        // A third one begins anew, and one that stays is none.
        glass.land(1, mm(53.0, 52.0), 500);
        glass.lift(1, 580);
        assert!(!glass.did.iter().any(|g| matches!(g, Gesture::DoubleTap(_))));
        glass.take();
        glass.land(1, mm(53.0, 52.0), 2000);
        glass.lift(1, 4000);
        assert!(!glass.did.iter().any(|g| matches!(g, Gesture::Tap(_))));
    }

    #[test]
    fn two_fingers_pinch_and_turn_about_their_middle() {
        let mut glass = Glass::new();
        glass.land(1, mm(100.0, 100.0), 0);
        glass.land(2, mm(200.0, 100.0), 50);
        glass.take();
        // Round by a right angle, anticlockwise as seen, twice as far apart.
        let (mut factor, mut turn) = (1.0, 0.0);
        for step in 1..=90 {
            let angle = (step as f32).to_radians();
            let reach = 50.0 + 50.0 * step as f32 / 90.0;
            let arm = Vec2::new(angle.cos(), -angle.sin()) * reach;
            let now = 50 + step * 10;
            glass.go(1, mm(150.0 - arm.x, 100.0 - arm.y), now);
            glass.go(2, mm(150.0 + arm.x, 100.0 + arm.y), now);
        }
        for gesture in glass.take() {
            if let Gesture::Pinch {
                factor: f, turn: t, ..
            } = gesture
            {
                factor *= f;
                turn += t;
            }
        }
        // Without what it took to tell a hand from a tremor.
        assert!((factor - 2.0).abs() < 0.06, "{factor}");
        assert!((turn.to_degrees() - 90.0).abs() < 12.0, "{turn}");
        assert!(turn > 0.0);
    }

    #[test]
    fn two_fingers_that_go_across_together_turn_the_sheet_over() {
        let sweep = |by: [f32; 2], slow: u64| {
            let mut glass = Glass::new();
            glass.land(1, mm(100.0, 100.0), 0);
            glass.land(2, mm(100.0, 130.0), 20);
            for step in 1..=10u64 {
                let share = step as f32 / 10.0;
                glass.go(1, mm(100.0 + by[0] * share, 100.0), 20 + slow * step);
                glass.go(2, mm(100.0 + by[1] * share, 130.0), 20 + slow * step);
            }
            glass.lift(1, 25 + slow * 10);
            glass.lift(2, 30 + slow * 10);
            glass.did.contains(&Gesture::Sweep)
        };
        assert!(sweep([60.0, 62.0], 20) && sweep([-60.0, -58.0], 20));
        assert!(!sweep([60.0, -60.0], 20), "a pinch");
        assert!(!sweep([60.0, 60.0], 80), "too slow");
        assert!(!sweep([20.0, 20.0], 20), "too short");
    }

    #[test]
    fn a_palm_and_a_sleeve_do_nothing_and_a_finger_beside_them_does() {
        let mut glass = Glass::new();
        for (id, x) in [(1, 0.0), (2, 12.0), (3, 20.0), (4, 9.0)] {
            glass.land(id, mm(300.0 + x, 200.0 + x / 2.0), id * 20);
        }
        for (id, x) in [(1, 0.0), (2, 12.0), (3, 20.0), (4, 9.0)] {
            glass.go(id, mm(306.0 + x, 212.0 + x / 2.0), 200);
        }
        assert!(!glass.moved(), "a palm");
        glass.land(9, mm(150.0, 100.0), 400);
        glass.go(9, mm(160.0, 100.0), 420);
        assert!(glass.did.iter().any(|g| matches!(g, Gesture::Drag { .. })));
        glass.lift(9, 500);
        glass.take();
        glass.land(9, mm(150.0, 100.0), 600);
        glass.lift(9, 650);
        let tap = Gesture::Tap(mm(150.0, 100.0));
        assert!(glass.did.contains(&tap), "beside a palm too");
        // An elbow that has leant there for long does not take part in a drag.
        let mut glass = Glass::new();
        glass.land(1, mm(300.0, 300.0), 0);
        glass.land(2, mm(150.0, 100.0), 5000);
        glass.go(2, mm(170.0, 100.0), 5100);
        assert!(glass.did.iter().any(|g| matches!(g, Gesture::Drag { .. })));
        assert!(!glass.did.iter().any(|g| matches!(g, Gesture::Pinch { .. })));
    }

    #[test]
    fn one_that_holds_still_while_the_other_goes_still_pinches() {
        let mut glass = Glass::new();
        glass.land(1, mm(100.0, 100.0), 0);
        glass.land(2, mm(150.0, 100.0), 300);
        for step in 1..=40 {
            glass.go(2, mm(150.0 + step as f32, 100.0), 300 + step * 100);
        }
        assert!(!glass.did.iter().any(|g| matches!(g, Gesture::Drag { .. })));
        assert!(matches!(glass.did.last(), Some(Gesture::Pinch { .. })));
    }

    #[test]
    fn somebody_elsewhere_waits_until_the_sheet_is_free() {
        let mut glass = Glass::new();
        glass.land(1, mm(100.0, 300.0), 0);
        glass.go(1, mm(110.0, 300.0), 50);
        glass.land(2, mm(900.0, 300.0), 100);
        glass.take();
        glass.go(2, mm(930.0, 300.0), 150);
        assert!(!glass.moved());
        glass.lift(1, 200);
        glass.go(2, mm(940.0, 300.0), 250);
        glass.go(2, mm(960.0, 300.0), 260);
        assert!(glass.moved());
    }

    #[test]
    fn lost_ends_and_reused_numbers_leave_nothing_behind() {
        let mut glass = Glass::new();
        glass.land(7, mm(100.0, 100.0), 0);
        glass.land(7, mm(50.0, 50.0), 100);
        glass.go(7, mm(70.0, 50.0), 150);
        assert!(matches!(glass.take().last(), Some(Gesture::Drag { .. })));
        // Its end never comes, and the next one drags all the same.
        glass.land(8, mm(300.0, 100.0), 100_000);
        glass.go(8, mm(320.0, 100.0), 100_050);
        assert!(matches!(glass.take().last(), Some(Gesture::Drag { .. })));
        let holds = |id| glass.touches.fingers.iter().any(|finger| finger.id == id);
        assert!(!holds(7) && holds(8));
        // Numbers that never landed are of no interest.
        glass.go(99, mm(1.0, 1.0), 100_060);
        glass.lift(99, 100_070);
        assert_eq!(glass.take(), []);
    }

    #[test]
    fn twenty_at_once_on_one_place_stay_finite() {
        let mut glass = Glass::new();
        for id in 0..20 {
            glass.land(id, mm(100.0, 100.0 + 40.0 * (id % 2) as f32), id * 300);
        }
        for id in 0..20 {
            glass.go(id, mm(100.0 + 5.0 * id as f32, 500.0), 7000);
            glass.go(id, Vec2::splat(f32::MAX / 4.0), 7001);
        }
        for gesture in glass.take() {
            if let Gesture::Pinch { factor, turn, .. } = gesture {
                assert!((0.5..=2.0).contains(&factor) && turn.is_finite());
            }
        }
        for id in 0..20 {
            glass.lift(id, 8000);
        }
        assert_eq!(glass.did.last(), Some(&Gesture::Release));
    }
}
