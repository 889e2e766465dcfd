//! One short line that says what to do: to whoever takes a measuring tool, opens the lamp, or touches the
//! sheet first. It goes when that is done, or by itself after a while.

use std::time::Duration;

use bevy::{input::touch::TouchPhase, prelude::*, window::WindowEvent};
use serde::{Deserialize, Serialize};

use super::{
    Hand,
    attending::{Closed, House},
    attract::Attract,
    controls::{Interface, Panel},
    intent::Intent,
    measuring::{Kind, Measuring},
    phrases,
};
use crate::wording::Spoken;

/// How long a line is there, in seconds: enough to read it twice.
const GESTURE_S: f64 = 8.0;
/// Whoever measures looks at the sheet first.
const TOOL_S: f64 = 20.0;

/// What there is to be told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Hint {
    /// A finger turns the sheet.
    Turn,
    /// A finger moves the sheet, which is close.
    Move,
    /// Two fingers bring it closer.
    Zoom,
    /// The lamp is held and moved.
    Lamp,
    /// How this tool is laid.
    Tool(Kind),
}

impl Hint {
    fn seconds(self) -> f64 {
        match self {
            Self::Tool(_) => TOOL_S,
            Self::Turn | Self::Move | Self::Zoom | Self::Lamp => GESTURE_S,
        }
    }

    /// Its wording.
    fn id(self) -> &'static str {
        match self {
            Self::Turn => "touch-to-turn",
            Self::Move => "touch-to-move",
            Self::Zoom => "pinch-to-zoom",
            Self::Lamp => "drag-lamp",
            Self::Tool(kind) => phrases::tool_ids(kind)[1],
        }
    }
}

/// What a visitor is being told, and what is known to them.
#[derive(Resource, Clone, Debug, Default)]
pub struct Hints {
    now: Option<Hint>,
    /// Seconds for which it stays.
    left_s: f64,
    /// Told before, or done without being told.
    known: Vec<Hint>,
    /// What the hand that has not let go yet is doing.
    doing: Option<Hint>,
    /// Somebody touches with fingers, and not with a mouse.
    fingers: bool,
    /// How many tools lay on the sheet.
    laid: usize,
}

impl Hints {
    /// The line, in the words of whoever reads it.
    pub fn said(&self, spoken: Spoken) -> Option<String> {
        Some(spoken.say(self.now?.id()))
    }

    /// What is being told.
    pub fn now(&self) -> Option<Hint> {
        self.now
    }

    /// As another machine says.
    pub fn be(&mut self, now: Option<Hint>) {
        let left_s = now.map_or(0.0, Hint::seconds);
        (self.now, self.left_s) = (now, left_s);
    }

    /// How long until the line goes by itself.
    pub fn next(&self) -> Option<Duration> {
        let left_s = self.now.map(|_| self.left_s.max(0.0));
        left_s.map(Duration::from_secs_f64)
    }

    fn tell(&mut self, hint: Hint) {
        if !matches!(hint, Hint::Tool(_)) {
            self.known.push(hint);
        }
        (self.now, self.left_s) = (Some(hint), hint.seconds());
    }

    /// What somebody does needs not be told any more.
    fn done(&mut self, hint: Hint) {
        if !self.known.contains(&hint) {
            self.known.push(hint);
        }
        if self.now == Some(hint) {
            self.now = None;
        }
    }

    /// Lets time pass.
    fn pass(&mut self, seconds: f64) {
        self.left_s -= seconds;
        if self.left_s <= 0.0 {
            self.now = None;
        }
    }

    /// The sheet is touched: of what can be done with it, the first that is not known yet is told.
    fn touched(&mut self, one_finger: Hint) {
        let mut all = [one_finger, Hint::Zoom].into_iter();
        let next = all.find(|hint| !self.known.contains(hint));
        // One line at a time, and no lesson: the second one comes with the second touch.
        if let (Some(hint), None) = (next, self.now) {
            self.tell(hint);
        }
    }

    /// Takes in one wish; `is_free` while no tool is in the hand, and `one_finger` does what it would do now.
    fn take(&mut self, intent: Intent, is_free: bool, one_finger: Hint) {
        match intent {
            Intent::Take | Intent::Tap(_) if is_free && self.fingers => self.touched(one_finger),
            Intent::Drag { .. } => self.doing = Some(one_finger),
            Intent::Pinch { .. } => self.doing = Some(Hint::Zoom),
            Intent::Release => {
                if let Some(done) = self.doing.take() {
                    self.done(done);
                }
            }
            Intent::Zoom { .. } | Intent::TrueSize { .. } => self.done(Hint::Zoom),
            Intent::LampTo(_) | Intent::MoveLamp(_) => self.done(Hint::Lamp),
            _ => {}
        }
    }

    /// Follows the tool in the hand, of which so many lie on the sheet.
    fn follow_tool(&mut self, tool: Option<Kind>, laid: usize, was: Option<Kind>) {
        let told = match self.now {
            Some(Hint::Tool(kind)) => Some(kind),
            _ => None,
        };
        if let Some(kind) = tool.filter(|_| tool != was) {
            self.tell(Hint::Tool(kind));
        } else if told.is_some() && (told != tool || laid > self.laid) {
            self.now = None;
        }
        self.laid = laid;
    }
}

/// Follows what is done.
pub fn follow(
    (mut intents, mut events): (MessageReader<Intent>, MessageReader<WindowEvent>),
    (measuring, interface, attract): (Res<Measuring>, Res<Interface>, Res<Attract>),
    hand: Res<Hand>,
    (closed, house, time): (Res<Closed>, Res<House>, Res<Time<Real>>),
    mut hints: ResMut<Hints>,
    mut tool: Local<Option<Kind>>,
) {
    let silent = hints.bypass_change_detection();
    let before = silent.now;
    if attract.is_touring() || closed.0 {
        // Whoever comes next has been told nothing.
        *silent = Hints::default();
        events.clear();
        intents.clear();
    } else {
        let is_finger = |event: &WindowEvent| matches!(event, WindowEvent::TouchInput(touch) if touch.phase == TouchPhase::Started);
        silent.fingers |= house.0.kiosk | events.read().any(is_finger);
        silent.pass(time.delta_secs_f64());
        let kind = measuring.kind();
        for intent in intents.read() {
            let one_finger = match hand.moves_by_one_finger() {
                true => Hint::Move,
                false => Hint::Turn,
            };
            silent.take(*intent, kind.is_none(), one_finger);
        }
        silent.follow_tool(kind, measuring.laid().len(), *tool);
        let is_lit =
            interface.open.contains(&Panel::Light) && interface.latest == Some(Panel::Light);
        if is_lit && kind.is_none() && !silent.known.contains(&Hint::Lamp) {
            silent.tell(Hint::Lamp);
        }
    }
    *tool = measuring.kind();
    if silent.now != before {
        hints.set_changed();
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    const DRAG: Intent = Intent::Drag {
        from: DVec2::ZERO,
        to: DVec2::ONE,
    };

    fn visitor() -> Hints {
        Hints {
            fingers: true,
            ..Hints::default()
        }
    }

    #[test]
    fn the_first_touch_is_told_what_to_do_until_it_is_done() {
        let mut hints = visitor();
        assert_eq!(hints.now(), None);
        hints.take(Intent::Take, true, Hint::Turn);
        assert_eq!(hints.now(), Some(Hint::Turn));
        hints.take(DRAG, true, Hint::Turn);
        assert_eq!(hints.now(), Some(Hint::Turn), "while the hand turns it");
        hints.take(Intent::Release, true, Hint::Turn);
        assert_eq!(hints.now(), None);
        hints.take(Intent::Take, true, Hint::Turn);
        assert_eq!(hints.now(), Some(Hint::Zoom));
        hints.pass(GESTURE_S - 0.1);
        assert!(hints.now().is_some() && hints.next().is_some());
        hints.pass(0.2);
        assert_eq!((hints.now(), hints.next()), (None, None), "by itself");
        hints.take(Intent::Take, true, Hint::Turn);
        assert_eq!(hints.now(), None, "nothing is told twice");
    }

    #[test]
    fn a_sheet_that_is_close_moves_under_the_finger_and_so_it_is_told() {
        let mut hints = visitor();
        hints.take(Intent::Take, true, Hint::Move);
        assert_eq!(hints.now(), Some(Hint::Move));
        hints.take(DRAG, true, Hint::Move);
        hints.take(Intent::Release, true, Hint::Move);
        assert_eq!(hints.now(), None);
        // Once it is at rest size again, the finger does something else.
        hints.take(Intent::Take, true, Hint::Turn);
        assert_eq!(hints.now(), Some(Hint::Turn));
    }

    #[test]
    fn a_mouse_is_not_told_of_fingers_and_a_tool_is_not_told_of_the_sheet() {
        let mut hints = Hints::default();
        hints.take(Intent::Take, true, Hint::Turn);
        assert_eq!(hints.now(), None);
        let mut hints = visitor();
        hints.take(Intent::Take, false, Hint::Turn);
        assert_eq!(hints.now(), None);
    }

    #[test]
    fn a_tool_says_how_it_is_laid_until_it_lies_there_or_is_put_away() {
        let mut hints = visitor();
        let ruler = Some(Kind::Ruler);
        hints.follow_tool(ruler, 0, None);
        assert_eq!(hints.now(), Some(Hint::Tool(Kind::Ruler)));
        hints.follow_tool(ruler, 1, ruler);
        assert_eq!(hints.now(), None, "it lies there");
        hints.follow_tool(Some(Kind::Angle), 1, ruler);
        assert_eq!(hints.now(), Some(Hint::Tool(Kind::Angle)));
        hints.follow_tool(None, 1, Some(Kind::Angle));
        assert_eq!(hints.now(), None, "it is put away");
        // Another tool is told of again.
        hints.follow_tool(ruler, 1, None);
        hints.pass(TOOL_S + 0.1);
        assert_eq!(hints.now(), None);
        hints.follow_tool(ruler, 1, ruler);
        assert_eq!(hints.now(), None);
    }
}
