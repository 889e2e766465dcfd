//! Somebody who touches everything, everywhere, at once, and types meanwhile, while a curator saves sound
//! and faulty versions of the exhibit.

use std::{fs, path::Path};

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

use super::visit::{SIZE, Session, WAITS, resident_mib};

/// Events in the suite; as many as this says at night.
const EVENTS: usize = 10_000;
const EVENTS_ASKED: &str = "RECTO_MONKEY_EVENTS";
/// Events between two frames on the average; some frames have one, some twice as many. In a long run they are as
/// many as twenty fingers send in a frame of a 60 Hz display by a glass that looks 120 times a second.
const A_FRAME: usize = 10;
const A_FRAME_LONG: usize = 40;
/// And between two saves.
const A_SAVE: usize = 500;
/// So many times it is looked at how much is held.
const LOOKS: usize = 20;
/// More in the second half than ever in the first one is a leak: of entities and the like, and of MiB, which
/// the tests beside this one use as well, so that they are judged in a long run alone.
const LEAK: f64 = 1.2;
/// That many come and go with what is open just then.
const SLACK: f64 = 10.0;
const LEAK_MIB: f64 = 1.05;
const LONG: usize = 100_000;
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

/// A version of the exhibit, sound or not.
fn save(random: &mut Random, folder: &Path) {
    let manifest = folder.join("exhibit.toml");
    let write = |text: &str| fs::write(&manifest, text).expect("the manifest is written");
    let sound = crate::MANIFEST;
    match random.random_range(0..7) {
        0 => write(&sound.replace("Two sheets", "Two other sheets")),
        1 => write(&sound.replace("elevation_deg = 25", "elevation_deg = 60")),
        // One scene less.
        2 => write(sound.rsplit_once("[[scene]]").expect("a scene").0),
        3 => write(&sound[..random.random_range(0..sound.len())]),
        4 => write(&sound.replace("elevation_deg = 25", "elevation_deg = -25")),
        5 => fs::write(folder.join("paper.png"), b"no picture").expect("a file"),
        _ => {
            crate::draw_paper(&folder.join("paper.png"), random.random_range(90..250));
            write(sound);
        }
    }
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
    let folder = session.folder().to_owned();
    let mut held = Vec::new();
    let a_frame = if events < LONG { A_FRAME } else { A_FRAME_LONG };
    let mut next_frame = 0;
    for k in 0..events {
        if k % A_SAVE == A_SAVE - 1 {
            save(&mut random, &folder);
        }
        if k % (events / LOOKS).max(1) == 0 {
            let [entities, images, meshes] = session.holds().map(|count| count as f64);
            held.push([entities, images, meshes, resident_mib()]);
        }
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
        if k == next_frame {
            next_frame += random.random_range(1..2 * a_frame);
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
    for (kind, most) in [LEAK, LEAK, LEAK, LEAK_MIB].into_iter().enumerate() {
        let (early, late) = held.split_at(held.len() / 2);
        let most_of = |part: &[[f64; 4]]| part.iter().map(|held| held[kind]).fold(0.0, f64::max);
        println!("{kind}: {} and then {}", most_of(early), most_of(late));
        if kind < 3 || events >= LONG {
            let most = most * most_of(early) + SLACK;
            assert!(most_of(late) <= most, "{kind}: {held:?}");
        }
    }
    crate::write_exhibit(&folder);
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
