//! Somebody who touches everything, everywhere, at once, and types meanwhile.

use bevy::{
    input::{
        ButtonState,
        keyboard::{Key, KeyCode, KeyboardInput},
        mouse::{MouseButtonInput, MouseScrollUnit, MouseWheel},
        touch::TouchPhase,
    },
    prelude::*,
    window::{CursorMoved, WindowEvent},
};
use rand::{RngExt, SeedableRng, rngs::Xoshiro256PlusPlus as Random};
use recto::visitor::{
    Hand, Manners,
    controls::{Control, Interface},
};

use super::session::{SIZE, Session, WAITS};

/// Events in the suite; as many as this says at night.
const EVENTS: usize = 10_000;
const EVENTS_ASKED: &str = "RECTO_MONKEY_EVENTS";
/// Events between two frames.
const A_FRAME: usize = 10;
const KEYS: &str = "fh123imvgsok[]x,.<>90rbznptcjlu+-";

fn place(random: &mut Random) -> Vec2 {
    let [width, height] = SIZE.map(|side| side as f32);
    match random.random_range(0..50) {
        // Beyond the glass, and nonsense.
        0 => Vec2::new(-500.0, 9e9),
        1 => Vec2::new(f32::MAX, -f32::MAX),
        _ => Vec2::new(
            random.random_range(0.0..width),
            random.random_range(0.0..height),
        ),
    }
}

fn event(random: &mut Random) -> Option<WindowEvent> {
    let window = Entity::PLACEHOLDER;
    let button = |button, state| {
        WindowEvent::MouseButtonInput(MouseButtonInput {
            button,
            state,
            window,
        })
    };
    let state = match random.random_bool(0.5) {
        true => ButtonState::Pressed,
        false => ButtonState::Released,
    };
    let key = |key: Key| {
        WindowEvent::KeyboardInput(KeyboardInput {
            key_code: KeyCode::KeyA,
            logical_key: key,
            state,
            text: None,
            repeat: false,
            window,
        })
    };
    Some(match random.random_range(0..12) {
        0 => WindowEvent::CursorMoved(CursorMoved {
            window,
            position: place(random),
            delta: None,
        }),
        1 => button(MouseButton::Left, state),
        2 => button(MouseButton::Right, state),
        3 => WindowEvent::MouseWheel(MouseWheel {
            unit: MouseScrollUnit::Line,
            x: 0.0,
            y: random.random_range(-9.0..9.0),
            phase: TouchPhase::Moved,
            window,
        }),
        4 => {
            let letter = random.random_range(0..KEYS.len());
            key(Key::Character(KEYS[letter..=letter].into()))
        }
        5 => {
            let keys = [
                Key::Tab,
                Key::Space,
                Key::Enter,
                Key::Backspace,
                Key::ArrowLeft,
                Key::ArrowUp,
                Key::Shift,
                Key::Control,
                Key::Escape,
                Key::F11,
            ];
            key(keys[random.random_range(0..keys.len())].clone())
        }
        _ => return None,
    })
}

#[test]
fn whatever_is_touched_home_is_reached() {
    let asked = std::env::var(EVENTS_ASKED).ok();
    let events = asked.map_or(EVENTS, |count| count.parse().expect("a number of events"));
    let mut random = Random::seed_from_u64(20_261_126);
    let mut session = Session::new(Manners {
        kiosk: true,
        waits: Some(WAITS),
        languages: vec!["en".into(), "ar".into()],
        pin: recto::installation::Pin::new("4711").ok(),
        ..Manners::default()
    });
    for k in 0..events {
        match event(&mut random) {
            Some(event) => session.send(event),
            None => {
                let id = random.random_range(0..20);
                let phases = [
                    TouchPhase::Started,
                    TouchPhase::Started,
                    TouchPhase::Moved,
                    TouchPhase::Moved,
                    TouchPhase::Moved,
                    TouchPhase::Ended,
                    TouchPhase::Canceled,
                ];
                let phase = phases[random.random_range(0..phases.len())];
                let at = place(&mut random);
                session.touch(id, phase, at);
            }
        }
        if k % A_FRAME == 0 {
            let ms = random.random_range(1..60);
            session.pass(std::time::Duration::from_millis(ms));
            let camera = session.shown().scene.camera;
            let numbers = [
                camera.centre_mm.x,
                camera.centre_mm.y,
                camera.width_mm,
                camera.turn.0,
            ];
            assert!(numbers.iter().all(|n| n.is_finite()), "{k}: {camera:?}");
            assert!(session.shown().pose.is_finite(), "{k}");
        }
    }
    // All hands leave, and whoever comes next finds the way home.
    for id in 0..20 {
        session.touch(id, TouchPhase::Ended, Vec2::ZERO);
    }
    session.send(WindowEvent::KeyboardFocusLost(
        bevy::input::keyboard::KeyboardFocusLost,
    ));
    session.wait(2.0 * (WAITS.idle_s + WAITS.countdown_s) + 60.0);
    session.settle();
    session.tap(Vec2::new(480.0, 200.0));
    session.settle();
    if session.find(Control::Home).is_none() {
        // Whatever covers it is refused.
        session.tap(Vec2::new(480.0, 200.0));
    }
    session.press(Control::Home);
    session.wait(2.0);
    session.settle();
    let hand = session.resource::<Hand>();
    let written = &hand.exhibit().scenes[hand.scene()];
    assert_eq!(session.shown().scene.camera.turn, written.camera.turn);
    assert!(session.resource::<Interface>().open.is_empty());
}
