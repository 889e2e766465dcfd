//! From what the devices report to what somebody wants.

use std::time::Duration;

use bevy::{
    input::{
        ButtonState,
        keyboard::{Key, KeyCode, KeyboardFocusLost, KeyboardInput},
        mouse::{MouseButtonInput, MouseScrollUnit, MouseWheel},
        touch::{TouchInput, TouchPhase},
    },
    prelude::*,
    window::WindowEvent,
};
use glam::DVec2;

use super::{
    controls::{Contact, Control, Laid, Phase},
    intent::Intent,
    staff::StaffPanel,
    touches::{Gesture, Touches},
};

/// Magnification of one notch of the wheel, or one press of a key.
const NOTCH: f64 = 1.2;
/// What a touch pad reports for one notch, in pixels.
const NOTCH_PX: f32 = 60.0;
/// Share of the picture's width that one press of an arrow pans by.
const PAN: f64 = 0.1;
/// Parts of the hemisphere's radius that one press of an arrow moves the lamp by.
const LAMP_STEP: f64 = 0.06;
const OPACITY_STEP: f64 = 0.1;
const TRANSMIT_STEP: f64 = 0.1;
/// Heights of the lamp that have a key, in degrees.
const OVERHEAD_DEG: f64 = 90.0;
const OBLIQUE_DEG: f64 = 45.0;
const RAKING_DEG: f64 = 12.0;
/// Nothing was heard for so long of a contact whose visitor has gone, and of one whose end was lost.
const GONE: Duration = Duration::from_secs(20);
const LOST: Duration = Duration::from_secs(60);
/// The mouse's left button is one finger among others.
const MOUSE: u64 = u64::MAX;

/// What somebody wants, or touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wish {
    Intent(Intent),
    Contact(Contact),
}

/// What there is to be touched.
#[derive(Clone, Copy)]
pub struct Ground<'g> {
    pub controls: &'g Laid,
    /// Whether a curtain or a loupe is taken at a place (−1…1, y up).
    pub compare: &'g dyn Fn(DVec2) -> bool,
}

/// Whom a contact that is not on the sheet belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Owner {
    Control(Control),
    Compare,
    /// What lies between controls.
    Nobody,
}

/// What is pressed, and where the pointers are.
#[derive(Resource, Debug, Default)]
pub struct Devices {
    /// The window's size in logical pixels.
    size: Vec2,
    cursor: Vec2,
    /// Where something points, the mouse or the last finger.
    pointer: Option<Vec2>,
    /// The button that holds the lamp.
    lamp: Option<MouseButton>,
    /// The left button is down.
    pressed: bool,
    shift: bool,
    control: bool,
    lamp_key: bool,
    touches: Touches,
    /// Contacts beside the sheet.
    others: Vec<Other>,
    /// When anything was done last.
    heard: Duration,
}

/// A contact that is not on the sheet.
#[derive(Clone, Copy, Debug)]
struct Other {
    id: u64,
    owner: Owner,
    at: Vec2,
    heard: Duration,
}

impl Devices {
    /// The window has this size in logical pixels, so many of which are a millimetre.
    pub fn resize(&mut self, size: Vec2, px_per_mm: f32) {
        self.size = size;
        self.touches.measure(px_per_mm);
    }

    /// Takes in one event that happened at `now`.
    pub fn take(
        &mut self,
        event: &WindowEvent,
        now: Duration,
        ground: Ground,
        mut want: impl FnMut(Wish),
    ) {
        self.heard = now;
        match event {
            WindowEvent::KeyboardInput(key) => self.key(key, |intent| want(Wish::Intent(intent))),
            WindowEvent::CursorMoved(moved) => {
                self.pointer = Some(moved.position);
                let before = std::mem::replace(&mut self.cursor, moved.position);
                if self.lamp.is_some() {
                    let by = (moved.position - before) / (self.size.min_element() / 2.0);
                    let by = DVec2::new(by.x.into(), (-by.y).into());
                    want(Wish::Intent(Intent::MoveLamp(by)));
                } else if self.pressed {
                    self.go(MOUSE, moved.position, now, want);
                }
            }
            WindowEvent::MouseButtonInput(button) => self.button(button, now, ground, want),
            WindowEvent::MouseWheel(wheel) => want(Wish::Intent(Intent::Zoom {
                at: self.place(self.cursor),
                factor: NOTCH.powf(notches(wheel)),
            })),
            WindowEvent::CursorLeft(_) => self.pointer = None,
            WindowEvent::TouchInput(touch) => self.touch(touch, now, ground, want),
            WindowEvent::KeyboardFocusLost(_) => {
                self.let_go_of_keys();
                (self.pressed, self.lamp) = (false, None);
                for other in std::mem::take(&mut self.others) {
                    other.tell(Phase::Lost, &mut want);
                }
                let size = self.size;
                self.touches
                    .clear(|did| want(Wish::Intent(intent(size, did))));
            }
            _ => {}
        }
    }

    /// No key is held any more.
    pub fn let_go_of_keys(&mut self) {
        (self.shift, self.control, self.lamp_key) = (false, false, false);
    }

    /// Nothing is held any more.
    pub fn let_go(&mut self, now: Duration, want: impl FnMut(Wish)) {
        let controls = Laid::default();
        let ground = Ground {
            controls: &controls,
            compare: &|_| false,
        };
        self.take(
            &WindowEvent::KeyboardFocusLost(KeyboardFocusLost),
            now,
            ground,
            want,
        );
    }

    /// Where something points, in logical pixels from the top left corner.
    pub fn pointer(&self) -> Option<Vec2> {
        self.pointer
    }

    /// As another machine says.
    pub fn point_at(&mut self, at: Option<Vec2>) {
        self.pointer = at;
    }

    /// How long nobody has done anything.
    pub fn quiet(&self, now: Duration) -> Duration {
        now.saturating_sub(self.heard)
    }

    /// Whether somebody holds the sheet or a control; one of whom nothing was heard for long has gone, and
    /// the end of the touch was lost.
    pub fn is_held(&self, now: Duration) -> bool {
        let is_there = |other: &Other| now.saturating_sub(other.heard) <= GONE;
        self.touches.is_held(now, GONE) || self.others.iter().any(is_there)
    }

    /// Tells the staff's panel of what goes on in its corners.
    pub fn watch_corner(&self, event: &WindowEvent, now: Duration, staff: &mut StaffPanel) {
        let from_corner_mm = |at: Vec2| {
            let nearest = Vec2::new(at.x, at.y.min(self.size.y - at.y));
            nearest / self.touches.px_per_mm()
        };
        match event {
            WindowEvent::TouchInput(touch) => match touch.phase {
                TouchPhase::Started => staff.land(touch.id, from_corner_mm(touch.position), now),
                TouchPhase::Moved => {}
                _ => staff.lift(touch.id, from_corner_mm(touch.position), now),
            },
            WindowEvent::MouseButtonInput(button) if button.button == MouseButton::Left => {
                match button.state {
                    ButtonState::Pressed => staff.land(MOUSE, from_corner_mm(self.cursor), now),
                    ButtonState::Released => staff.lift(MOUSE, from_corner_mm(self.cursor), now),
                }
            }
            _ => {}
        }
    }

    /// From logical pixels to −1…1, y up.
    fn place(&self, at: Vec2) -> DVec2 {
        place(self.size, at)
    }

    fn button(
        &mut self,
        input: &MouseButtonInput,
        now: Duration,
        ground: Ground,
        want: impl FnMut(Wish),
    ) {
        let pressed = input.state == ButtonState::Pressed;
        match input.button {
            MouseButton::Left | MouseButton::Right if !pressed => {
                if self.lamp == Some(input.button) {
                    self.lamp = None;
                } else if input.button == MouseButton::Left && self.pressed {
                    self.pressed = false;
                    self.lift(MOUSE, now, false, want);
                }
            }
            // One button at a time.
            _ if self.pressed || self.lamp.is_some() => {}
            MouseButton::Left if !self.lamp_key => {
                self.pressed = true;
                self.land(MOUSE, self.cursor, now, ground, want);
            }
            MouseButton::Left | MouseButton::Right => self.lamp = Some(input.button),
            _ => {}
        }
    }

    fn touch(&mut self, touch: &TouchInput, now: Duration, ground: Ground, want: impl FnMut(Wish)) {
        // Where a finger was lifted it goes on pointing.
        self.pointer = Some(touch.position);
        match touch.phase {
            TouchPhase::Started => self.land(touch.id, touch.position, now, ground, want),
            TouchPhase::Moved => self.go(touch.id, touch.position, now, want),
            TouchPhase::Ended => self.lift(touch.id, now, false, want),
            TouchPhase::Canceled => self.lift(touch.id, now, true, want),
        }
    }

    fn land(
        &mut self,
        id: u64,
        at: Vec2,
        now: Duration,
        ground: Ground,
        mut want: impl FnMut(Wish),
    ) {
        // The end of one with the same number was lost.
        self.lift(id, now, true, &mut want);
        let owner = if let Some(widget) = ground.controls.at(at) {
            Owner::Control(widget.control)
        } else if ground.controls.covers(at) {
            Owner::Nobody
        } else if (ground.compare)(self.place(at)) {
            Owner::Compare
        } else {
            let size = self.size;
            let did = |did| want(Wish::Intent(intent(size, did)));
            self.touches.land(id, at, now, did);
            return;
        };
        let is_lost = |other: &mut Other| now.saturating_sub(other.heard) > LOST;
        for other in self.others.extract_if(.., is_lost) {
            other.tell(Phase::Lost, &mut want);
        }
        let other = Other {
            id,
            owner,
            at,
            heard: now,
        };
        self.others.push(other);
        other.tell(Phase::Landed, &mut want);
    }

    fn go(&mut self, id: u64, to: Vec2, now: Duration, mut want: impl FnMut(Wish)) {
        let size = self.size;
        if let Some(other) = self.others.iter_mut().find(|other| other.id == id) {
            let from = std::mem::replace(&mut other.at, to);
            other.heard = now;
            if other.owner == Owner::Compare {
                want(Wish::Intent(Intent::MoveCompare {
                    from: place(size, from),
                    to: place(size, to),
                }));
            }
            other.tell(Phase::Moved, &mut want);
        } else {
            let did = |did| want(Wish::Intent(intent(size, did)));
            self.touches.go(id, to, now, did);
        }
    }

    fn lift(&mut self, id: u64, now: Duration, cancelled: bool, mut want: impl FnMut(Wish)) {
        if let Some(index) = self.others.iter().position(|other| other.id == id) {
            let phase = match cancelled {
                true => Phase::Lost,
                false => Phase::Lifted,
            };
            self.others.remove(index).tell(phase, &mut want);
        } else {
            let size = self.size;
            let did = |did| want(Wish::Intent(intent(size, did)));
            self.touches.lift(id, now, cancelled, did);
        }
    }

    fn key(&mut self, input: &KeyboardInput, mut want: impl FnMut(Intent)) {
        let pressed = input.state == ButtonState::Pressed;
        match &input.logical_key {
            Key::Shift => self.shift = pressed,
            Key::Control => self.control = pressed,
            Key::Character(text) if text.eq_ignore_ascii_case("l") => self.lamp_key = pressed,
            _ => {}
        }
        if !pressed {
            return;
        }
        let intent = match (self.named(&input.logical_key), input.key_code) {
            (Some(intent), _) => intent,
            // On some keyboards the digits are shifted.
            (None, KeyCode::Digit1 | KeyCode::Numpad1) => Intent::RaiseLamp(OVERHEAD_DEG),
            (None, KeyCode::Digit2 | KeyCode::Numpad2) => Intent::RaiseLamp(OBLIQUE_DEG),
            (None, KeyCode::Digit3 | KeyCode::Numpad3) => Intent::RaiseLamp(RAKING_DEG),
            _ => return,
        };
        // A held key goes on zooming and moving, and does nothing else twice.
        let goes_on = matches!(
            intent,
            Intent::Pan(_)
                | Intent::Zoom { .. }
                | Intent::MoveLamp(_)
                | Intent::Opacity(_)
                | Intent::ShiftCompare(_)
                | Intent::TurnCompare(_)
                | Intent::Transmit(_)
        );
        if goes_on || !input.repeat {
            want(intent);
        }
    }

    fn named(&self, key: &Key) -> Option<Intent> {
        let arrow = |x: f64, y: f64| {
            let way = DVec2::new(x, y);
            if self.shift {
                Intent::MoveLamp(way * LAMP_STEP)
            } else {
                Intent::Pan(way * PAN)
            }
        };
        let zoom = |factor| Intent::Zoom {
            at: DVec2::ZERO,
            factor,
        };
        Some(match key {
            Key::ArrowLeft => arrow(-1.0, 0.0),
            Key::ArrowRight => arrow(1.0, 0.0),
            Key::ArrowUp => arrow(0.0, 1.0),
            Key::ArrowDown => arrow(0.0, -1.0),
            Key::PageDown => Intent::StepScene(1),
            Key::PageUp => Intent::StepScene(-1),
            Key::Home => Intent::Home,
            Key::Escape => Intent::Quit,
            Key::Tab => Intent::StepFocus(if self.shift { -1 } else { 1 }),
            Key::Space => Intent::Activate,
            Key::Enter => Intent::GoOn,
            Key::Backspace | Key::Delete => Intent::TakeBack,
            Key::F1 => Intent::Keys,
            Key::F11 => Intent::Fullscreen,
            Key::Character(text) => match text.to_lowercase().as_str() {
                "+" | "=" => zoom(NOTCH),
                "-" | "−" | "_" => zoom(1.0 / NOTCH),
                "f" => Intent::Flip,
                "h" => Intent::Home,
                "1" => Intent::RaiseLamp(OVERHEAD_DEG),
                "2" => Intent::RaiseLamp(OBLIQUE_DEG),
                "3" => Intent::RaiseLamp(RAKING_DEG),
                "i" => Intent::Hotspots,
                "j" => Intent::StepHotspot(if self.shift { -1 } else { 1 }),
                "u" => Intent::Controls,
                "m" => Intent::StepTool(if self.shift { -1 } else { 1 }),
                "v" => Intent::ReadOut,
                "g" => Intent::StepCategory(if self.shift { -1 } else { 1 }),
                "e" => Intent::Export { linear: self.shift },
                "w" => Intent::SaveView,
                "s" if self.control => Intent::SaveView,
                "k" => Intent::Link,
                "s" => Intent::StepState(if self.shift { -1 } else { 1 }),
                "o" => Intent::StepOverlay,
                "[" => Intent::Opacity(-OPACITY_STEP),
                "]" => Intent::Opacity(OPACITY_STEP),
                "x" => Intent::StepCompare(if self.shift { -1 } else { 1 }),
                "," => Intent::ShiftCompare(-1.0),
                "." => Intent::ShiftCompare(1.0),
                "<" | ";" => Intent::TurnCompare(-1.0),
                ">" | ":" => Intent::TurnCompare(1.0),
                "9" => Intent::Transmit(-TRANSMIT_STEP),
                "0" => Intent::Transmit(TRANSMIT_STEP),
                "r" if self.shift => Intent::Exaggerate,
                "r" => Intent::ReliefOnly,
                "b" => Intent::Stretch,
                "z" => Intent::Sharpen,
                "n" => Intent::StepScene(1),
                "p" => Intent::StepScene(-1),
                "t" => Intent::StepTier(if self.shift { -1 } else { 1 }),
                "c" => Intent::Caption,
                "?" => Intent::Keys,
                _ => return None,
            },
            _ => return None,
        })
    }
}

/// From logical pixels in a window of this size to −1…1, y up.
fn place(size: Vec2, at: Vec2) -> DVec2 {
    let part = (at / size.max(Vec2::ONE)).as_dvec2();
    DVec2::new(2.0 * part.x - 1.0, 1.0 - 2.0 * part.y)
}

/// What a gesture on the sheet is about.
fn intent(size: Vec2, did: Gesture) -> Intent {
    match did {
        Gesture::Take => Intent::Take,
        Gesture::Drag { from, to } => Intent::Drag {
            from: place(size, from),
            to: place(size, to),
        },
        Gesture::Pinch {
            from,
            to,
            factor,
            turn,
        } => Intent::Pinch {
            from: place(size, from),
            to: place(size, to),
            factor: factor.into(),
            turn: turn.into(),
        },
        Gesture::Release => Intent::Release,
        Gesture::Tap(at) => Intent::Tap(place(size, at)),
        Gesture::DoubleTap(at) => Intent::TrueSize {
            at: place(size, at),
        },
        Gesture::Sweep => Intent::Flip,
    }
}

impl Other {
    fn tell(self, phase: Phase, want: &mut impl FnMut(Wish)) {
        if let Owner::Control(control) = self.owner {
            want(Wish::Contact(Contact {
                id: self.id,
                control,
                phase,
                at: self.at,
            }));
        }
    }
}

fn notches(wheel: &MouseWheel) -> f64 {
    let y = match wheel.unit {
        MouseScrollUnit::Line => wheel.y,
        MouseScrollUnit::Pixel => wheel.y / NOTCH_PX,
    };
    f64::from(y)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wishes(moves: &[[f32; 2]]) -> Vec<Intent> {
        let mut devices = Devices {
            size: Vec2::new(400.0, 200.0),
            cursor: Vec2::new(100.0, 50.0),
            ..Devices::default()
        };
        let button = |state| {
            WindowEvent::MouseButtonInput(MouseButtonInput {
                button: MouseButton::Left,
                state,
                window: Entity::PLACEHOLDER,
            })
        };
        let moved = |position: &[f32; 2]| {
            WindowEvent::CursorMoved(CursorMoved {
                window: Entity::PLACEHOLDER,
                position: Vec2::from(*position),
                delta: None,
            })
        };
        let events = std::iter::once(button(ButtonState::Pressed))
            .chain(moves.iter().map(moved))
            .chain([button(ButtonState::Released)]);
        let controls = Laid::default();
        let ground = Ground {
            controls: &controls,
            compare: &|_| false,
        };
        let mut wishes = Vec::new();
        for event in events {
            devices.take(&event, Duration::ZERO, ground, |wish| {
                if let Wish::Intent(intent) = wish {
                    wishes.push(intent);
                }
            });
        }
        wishes
    }

    #[test]
    fn a_click_that_goes_nowhere_is_a_tap_and_a_drag_is_none() {
        let tap = Intent::Tap(DVec2::new(-0.5, 0.5));
        assert!(wishes(&[]).contains(&tap));
        let trembling = wishes(&[[104.0, 52.0]]);
        assert!(trembling.contains(&tap));
        let is_drag = |wish: &Intent| matches!(wish, Intent::Drag { .. });
        assert!(!trembling.iter().any(is_drag), "it moves nothing");
        for drag in [vec![[150.0, 50.0]], vec![[150.0, 50.0], [100.0, 50.0]]] {
            let wishes = wishes(&drag);
            assert!(!wishes.iter().any(|wish| matches!(wish, Intent::Tap(_))));
            assert!(wishes.iter().any(is_drag));
        }
    }
}
