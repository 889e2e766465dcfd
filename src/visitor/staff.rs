//! What only the staff gets at: behind a finger that is held in a corner, and a PIN. Whoever guesses
//! waits longer each time.

use std::time::Duration;

use bevy::prelude::*;

use crate::installation::Pin;

use super::controls::{
    Control, Staff,
    facts::Spoken,
    icons::Icon,
    layout::{Item, Look},
};

/// Side of a corner; one at the upper left, and one at the lower left for walls that are taller than
/// people.
const CORNER_MM: f32 = 25.0;
/// How long a finger is held there.
const HOLD: Duration = Duration::from_secs(3);
/// A panel that nobody touches closes.
const FORGOTTEN: Duration = Duration::from_secs(30);
/// After the first wrong PIN; twice as long after each further one, up to the longest.
const WAIT: Duration = Duration::from_secs(2);
const LONGEST: Duration = Duration::from_secs(300);

/// Nobody types more digits: a PIN has no more.
const MOST_DIGITS: usize = 12;
/// The keys of the pad, in rows of three.
const PAD: [Control; 12] = [
    Control::Digit(1),
    Control::Digit(2),
    Control::Digit(3),
    Control::Digit(4),
    Control::Digit(5),
    Control::Digit(6),
    Control::Digit(7),
    Control::Digit(8),
    Control::Digit(9),
    Control::Erase,
    Control::Digit(0),
    Control::Enter,
];

/// What the staff asks of the house.
#[derive(Message, Clone, Copy, Debug, PartialEq, Eq)]
pub struct StaffWish(pub Staff);

/// Where the staff is.
#[derive(Clone, Debug, PartialEq)]
enum State {
    Closed,
    /// Typing, with what was typed.
    Asking(String),
    Open,
    /// On another machine.
    Elsewhere,
}

/// The staff's panel.
#[derive(Resource, Clone, Debug)]
pub struct StaffPanel {
    /// Without one there is no panel.
    pin: Option<Pin>,
    state: State,
    wrong: u32,
    /// Nothing is tried before.
    locked_until: Duration,
    /// When something was touched last.
    touched: Duration,
    /// The contact that is held in the corner, since when.
    held: Option<(u64, Duration)>,
    now: Duration,
}

impl StaffPanel {
    /// Closed, behind this PIN.
    pub fn new(pin: Option<Pin>) -> Self {
        Self {
            pin,
            state: State::Closed,
            wrong: 0,
            locked_until: Duration::ZERO,
            touched: Duration::ZERO,
            held: None,
            now: Duration::ZERO,
        }
    }

    /// Whether it covers the sheet.
    pub fn is_open(&self) -> bool {
        self.state != State::Closed
    }

    /// It is open on another machine, or not.
    pub fn be_elsewhere(&mut self, open: bool) {
        self.state = match open {
            true => State::Elsewhere,
            false => State::Closed,
        };
    }

    /// Whether it is open on another machine.
    pub fn is_elsewhere(&self) -> bool {
        self.state == State::Elsewhere
    }

    /// A contact lands so far from the nearest of the corners.
    pub fn land(&mut self, id: u64, from_corner_mm: Vec2, now: Duration) {
        if from_corner_mm.max_element() <= CORNER_MM {
            self.held = Some((id, now));
        }
    }

    /// A contact is lifted so far from the nearest of the corners; one that was held long enough in it asks for
    /// the PIN.
    pub fn lift(&mut self, id: u64, from_corner_mm: Vec2, now: Duration) {
        let Some((_, since)) = self.held.filter(|(held, _)| *held == id) else {
            return;
        };
        self.held = None;
        let stayed = from_corner_mm.max_element() <= 2.0 * CORNER_MM;
        if stayed && self.pin.is_some() && now.saturating_sub(since) >= HOLD && !self.is_open() {
            self.state = State::Asking(String::new());
            self.touched = now;
        }
    }

    /// Time passes.
    pub fn pass(&mut self, now: Duration) {
        self.now = now;
        if self.is_open() && now.saturating_sub(self.touched) > FORGOTTEN {
            self.state = State::Closed;
        }
    }

    /// Until when there is something to wait for.
    pub fn next(&self) -> Option<Duration> {
        let lock = (self.locked_until > self.now).then(|| {
            // Each second is told.
            let left = self.locked_until - self.now;
            Duration::from_nanos(u64::from(left.subsec_nanos()).max(1_000_000))
        });
        let forgotten = (self.touched + FORGOTTEN).saturating_sub(self.now);
        match self.is_open() {
            true => Some(
                lock.unwrap_or(forgotten)
                    .min(forgotten + Duration::from_millis(50)),
            ),
            false => None,
        }
    }

    /// What is typed, unless nothing is taken just now.
    fn typed(&mut self) -> Option<&mut String> {
        self.touched = self.now;
        match &mut self.state {
            State::Asking(typed) if self.now >= self.locked_until => Some(typed),
            _ => None,
        }
    }

    /// A digit is typed.
    pub fn digit(&mut self, digit: u8) {
        if let Some(typed) = self.typed().filter(|typed| typed.len() < MOST_DIGITS) {
            typed.push(char::from(b'0' + digit.min(9)));
        }
    }

    /// The last digit is taken back.
    pub fn erase(&mut self) {
        if let Some(typed) = self.typed() {
            typed.pop();
        }
    }

    /// What was typed is the PIN, or is not: nothing before says how long it is.
    pub fn enter(&mut self) {
        let Some(typed) = self.typed().filter(|typed| !typed.is_empty()).cloned() else {
            return;
        };
        if self.pin.as_ref().is_some_and(|pin| pin.matches(&typed)) {
            (self.state, self.wrong) = (State::Open, 0);
            return;
        }
        let wait = WAIT * 2u32.saturating_pow(self.wrong.min(10));
        self.wrong = self.wrong.saturating_add(1);
        self.locked_until = self.now + wait.min(LONGEST);
        self.state = State::Asking(String::new());
    }

    /// What was asked for, if whoever asks may.
    pub fn ask(&mut self, staff: Staff) -> Option<Staff> {
        self.touched = self.now;
        let may = self.state == State::Open;
        if staff == Staff::Back || may {
            self.state = State::Closed;
        }
        (may && staff != Staff::Back).then_some(staff)
    }

    /// What is to be seen and touched.
    pub fn items(&self, spoken: Spoken) -> Option<Vec<Item>> {
        let words = |words: String| Item {
            control: Control::Said,
            icon: None,
            words,
            look: Look::Words,
        };
        let button = |staff, icon, id: &str| {
            Item::button(Control::Staff(staff), icon, spoken.say(id), false)
        };
        let back = button(Staff::Back, Some(Icon::Back), "back");
        match &self.state {
            State::Closed | State::Elsewhere => None,
            State::Asking(typed) => {
                let left = self.locked_until.saturating_sub(self.now);
                let said = match (left.is_zero(), self.wrong) {
                    (true, 0) => spoken.say("staff-pin"),
                    (true, _) if typed.is_empty() => spoken.say("staff-wrong"),
                    (true, _) => spoken.say("staff-pin"),
                    (false, _) => {
                        let seconds = left.as_secs_f64().ceil();
                        spoken.fill("staff-wait", &[("seconds", seconds.into())])
                    }
                };
                let hidden = "*".repeat(typed.len());
                let key = |key: &Control| {
                    let (icon, words) = match key {
                        Control::Erase => (Some(Icon::Erase), spoken.say("take-back")),
                        Control::Enter => (Some(Icon::Done), spoken.say("done")),
                        Control::Digit(digit) => (None, digit.to_string()),
                        _ => (None, String::new()),
                    };
                    Item::button(*key, icon, words, false)
                };
                let head = [words(said), words(hidden)];
                let pad = PAD.iter().map(key);
                Some(head.into_iter().chain(pad).chain([back]).collect())
            }
            State::Open => Some(vec![
                words(spoken.say("staff-panel")),
                button(Staff::NextExhibit, None, "staff-next-exhibit"),
                button(Staff::Hours, None, "staff-hours-off"),
                button(Staff::Chart, None, "staff-chart"),
                button(Staff::Restart, None, "staff-restart"),
                button(Staff::Quit, None, "staff-quit"),
                back,
            ]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asking() -> StaffPanel {
        let mut panel = StaffPanel::new(Some(Pin::new("4711").expect("a PIN")));
        panel.land(1, Vec2::splat(10.0), Duration::from_secs(1));
        panel.lift(1, Vec2::splat(12.0), Duration::from_secs(5));
        assert!(panel.is_open());
        panel.pass(Duration::from_secs(5));
        panel
    }

    fn type_in(panel: &mut StaffPanel, pin: [u8; 4]) {
        pin.into_iter().for_each(|digit| panel.digit(digit));
        panel.enter();
    }

    #[test]
    fn only_a_long_hold_in_the_corner_asks() {
        let mut panel = StaffPanel::new(Some(Pin::new("4711").expect("a PIN")));
        let hold = |panel: &mut StaffPanel, at: f32, seconds: u64| {
            panel.land(1, Vec2::splat(at), Duration::from_secs(10));
            let end = Duration::from_secs(10 + seconds);
            panel.lift(1, Vec2::splat(at), end);
            panel.is_open()
        };
        assert!(!hold(&mut panel, 10.0, 2) && !hold(&mut panel, 300.0, 9));
        assert!(hold(&mut panel, 10.0, 4));
        let mut without = StaffPanel::new(None);
        assert!(!hold(&mut without, 10.0, 9), "no PIN, no panel");
    }

    #[test]
    fn guessing_takes_longer_each_time() {
        let mut panel = asking();
        assert_eq!(panel.ask(Staff::Quit), None, "not without the PIN");
        let mut now = Duration::from_secs(5);
        let mut waits = Vec::new();
        for _ in 0..12 {
            type_in(&mut panel, [1, 2, 3, 4]);
            waits.push(panel.locked_until - now);
            // While it is locked the right one is of no use either.
            type_in(&mut panel, [4, 7, 1, 1]);
            assert_eq!(panel.ask(Staff::Quit), None);
            now = panel.locked_until;
            panel.touched = now;
            panel.pass(now);
        }
        assert!(waits.windows(2).all(|pair| pair[1] >= pair[0]));
        assert_eq!(waits[..3], [2, 4, 8].map(Duration::from_secs));
        assert_eq!(waits[11], LONGEST);
        type_in(&mut panel, [4, 7, 1, 1]);
        assert_eq!(panel.ask(Staff::Quit), Some(Staff::Quit));
        assert!(!panel.is_open());
    }

    #[test]
    fn a_digit_is_taken_back_and_nothing_says_how_long_the_pin_is() {
        let mut panel = asking();
        for digit in [4, 7, 1, 2] {
            panel.digit(digit);
        }
        assert_eq!(
            panel.state,
            State::Asking("4712".into()),
            "nothing is tried"
        );
        panel.erase();
        panel.digit(1);
        panel.enter();
        assert_eq!(panel.state, State::Open);
        let mut panel = asking();
        panel.erase();
        panel.enter();
        assert_eq!(panel.wrong, 0, "nothing was typed");
        for _ in 0..40 {
            panel.digit(9);
        }
        assert_eq!(panel.state, State::Asking("9".repeat(MOST_DIGITS)));
    }

    #[test]
    fn a_forgotten_panel_closes() {
        let mut panel = asking();
        type_in(&mut panel, [4, 7, 1, 1]);
        panel.pass(Duration::from_secs(5) + FORGOTTEN);
        assert!(panel.is_open());
        panel.pass(Duration::from_secs(6) + FORGOTTEN);
        assert!(!panel.is_open());
    }
}
