//! From what the devices report to what somebody wants.

use std::time::Duration;

use bevy::{
    input::{
        ButtonState,
        keyboard::{Key, KeyCode, KeyboardInput},
        mouse::{MouseButtonInput, MouseScrollUnit, MouseWheel},
        touch::{TouchInput, TouchPhase},
    },
    prelude::*,
    window::WindowEvent,
};
use glam::DVec2;

use super::intent::Intent;

/// Longest time between the two clicks of a double click.
const DOUBLE: Duration = Duration::from_millis(400);
/// Farthest that they, or a tap's start and end, lie apart, in logical pixels.
const NEAR_PX: f32 = 8.0;
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

/// What a pressed button holds.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Held {
    Sheet,
    Lamp,
}

/// What is pressed, and where the pointers are.
#[derive(Resource, Debug, Default)]
pub struct Devices {
    /// The window's size in logical pixels.
    size: Vec2,
    cursor: Vec2,
    /// Where something points, the mouse or the last finger.
    pointer: Option<Vec2>,
    held: Option<(MouseButton, Held)>,
    shift: bool,
    control: bool,
    lamp_key: bool,
    /// Where the pointer went down that holds the sheet, while it has not gone far.
    tap: Option<Vec2>,
    /// When and where the last click or tap began.
    click: Option<(Duration, Vec2)>,
    /// Fingers on the screen, at most two of which are followed.
    fingers: Vec<(u64, Vec2)>,
}

impl Devices {
    /// The window has this size, in logical pixels.
    pub fn resize(&mut self, size: Vec2) {
        self.size = size;
    }

    /// Takes in one event that happened at `now`.
    pub fn take(&mut self, event: &WindowEvent, now: Duration, mut want: impl FnMut(Intent)) {
        match event {
            WindowEvent::KeyboardInput(key) => self.key(key, want),
            WindowEvent::CursorMoved(moved) => {
                self.wander(moved.position);
                self.pointer = Some(moved.position);
                let before = std::mem::replace(&mut self.cursor, moved.position);
                match self.held {
                    // A click whose hand trembles moves nothing.
                    Some((_, Held::Sheet)) if self.tap.is_some() => {}
                    Some((_, Held::Sheet)) => want(Intent::Drag {
                        from: self.place(before),
                        to: self.place(moved.position),
                    }),
                    Some((_, Held::Lamp)) => {
                        let by = (moved.position - before) / (self.size.min_element() / 2.0);
                        want(Intent::MoveLamp(DVec2::new(by.x.into(), (-by.y).into())));
                    }
                    None => {}
                }
            }
            WindowEvent::MouseButtonInput(button) => self.button(button, now, want),
            WindowEvent::MouseWheel(wheel) => want(Intent::Zoom {
                at: self.place(self.cursor),
                factor: NOTCH.powf(notches(wheel)),
            }),
            WindowEvent::CursorLeft(_) => self.pointer = None,
            WindowEvent::TouchInput(touch) => self.touch(touch, now, want),
            WindowEvent::KeyboardFocusLost(_) => {
                (self.shift, self.control, self.lamp_key) = (false, false, false);
                self.fingers.clear();
                self.tap = None;
                if let Some((_, Held::Sheet)) = self.held.take() {
                    want(Intent::Release);
                }
            }
            _ => {}
        }
    }

    /// Where something points, in logical pixels from the top left corner.
    pub fn pointer(&self) -> Option<Vec2> {
        self.pointer
    }

    /// From logical pixels to −1…1, y up.
    fn place(&self, at: Vec2) -> DVec2 {
        let part = (at / self.size.max(Vec2::ONE)).as_dvec2();
        DVec2::new(2.0 * part.x - 1.0, 1.0 - 2.0 * part.y)
    }

    /// A pointer that goes far, or a second one, makes a tap a drag.
    fn wander(&mut self, to: Vec2) {
        self.tap = self.tap.filter(|from| from.distance(to) <= NEAR_PX);
    }

    /// A pointer went up that had gone down here, if it was a tap.
    fn tapped(&mut self, mut want: impl FnMut(Intent)) {
        if let Some(at) = self.tap.take() {
            want(Intent::Tap(self.place(at)));
        }
    }

    fn button(&mut self, input: &MouseButtonInput, now: Duration, mut want: impl FnMut(Intent)) {
        if input.state == ButtonState::Released {
            if let Some((button, held)) = self.held
                && button == input.button
            {
                self.held = None;
                if held == Held::Sheet {
                    want(Intent::Release);
                    self.tapped(want);
                }
            }
            return;
        }
        let held = match input.button {
            MouseButton::Left if self.lamp_key => Held::Lamp,
            MouseButton::Left => Held::Sheet,
            MouseButton::Right => Held::Lamp,
            _ => return,
        };
        if self.held.is_some() {
            return;
        }
        self.held = Some((input.button, held));
        if held == Held::Sheet {
            want(Intent::Take);
            self.tap = Some(self.cursor);
            self.click_at(self.cursor, now, want);
        }
    }

    fn click_at(&mut self, at: Vec2, now: Duration, mut want: impl FnMut(Intent)) {
        let double = self.click.is_some_and(|(then, place)| {
            now.saturating_sub(then) <= DOUBLE && place.distance(at) <= NEAR_PX
        });
        self.click = (!double).then_some((now, at));
        if double {
            want(Intent::TrueSize { at: self.place(at) });
        }
    }

    fn touch(&mut self, touch: &TouchInput, now: Duration, mut want: impl FnMut(Intent)) {
        let known = self.fingers.iter().position(|(id, _)| *id == touch.id);
        // Where a finger was lifted it goes on pointing.
        self.pointer = Some(touch.position);
        match (touch.phase, known) {
            (TouchPhase::Started, None) => {
                self.fingers.push((touch.id, touch.position));
                want(Intent::Take);
                self.tap = None;
                if self.fingers.len() == 1 {
                    self.tap = Some(touch.position);
                    self.click_at(touch.position, now, want);
                }
            }
            (TouchPhase::Moved, Some(finger)) => {
                self.wander(touch.position);
                let before = self.spread();
                let from = std::mem::replace(&mut self.fingers[finger].1, touch.position);
                match (before, self.spread()) {
                    (Some((middle, apart)), Some((now_middle, now_apart))) if finger < 2 => {
                        want(Intent::Pinch {
                            from: self.place(middle),
                            to: self.place(now_middle),
                            factor: f64::from(now_apart / apart.max(1.0)),
                        });
                    }
                    (None, None) if self.tap.is_none() => want(Intent::Drag {
                        from: self.place(from),
                        to: self.place(touch.position),
                    }),
                    _ => {}
                }
            }
            (TouchPhase::Ended | TouchPhase::Canceled, Some(finger)) => {
                self.fingers.remove(finger);
                if !self.fingers.is_empty() {
                    want(Intent::Take);
                    return;
                }
                want(Intent::Release);
                if touch.phase == TouchPhase::Ended {
                    self.tapped(want);
                }
            }
            _ => {}
        }
    }

    /// The middle between two fingers, and how far they are apart.
    fn spread(&self) -> Option<(Vec2, f32)> {
        match self.fingers[..] {
            [(_, a), (_, b), ..] => Some(((a + b) / 2.0, a.distance(b))),
            _ => None,
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
            Key::Tab => Intent::StepHotspot(if self.shift { -1 } else { 1 }),
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
        let mut wishes = Vec::new();
        for event in events {
            devices.take(&event, Duration::ZERO, |intent| wishes.push(intent));
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
