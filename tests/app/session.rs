//! Whole visits: what somebody does at the glass, what is shown then, and what it looks like.

use std::sync::{
    Arc,
    atomic::{AtomicU32, Ordering},
};

use bevy::{input::touch::TouchPhase, prelude::*};
use glam::DVec2;
use recto::{
    manifest::exhibit::SideName,
    shot::Picture,
    visitor::{
        Attract, Chime, Closed, Doing, Hand, Manners,
        controls::{Control, Interface, Panel, Preset, Staff},
    },
};

use super::visit::{Session, WAITS, keep};

/// More than the promise: a picture follows a touch within so many frames.
const LATENCY_FRAMES: u32 = 2;
pub const MIDDLE: Vec2 = Vec2::new(480.0, 240.0);

/// Share of pixels over which something lies.
fn covered(picture: &Picture) -> f64 {
    let lies = picture.legend.iter().filter(|texel| texel[3] > 0.1);
    lies.count() as f64 / picture.legend.len() as f64
}

#[test]
fn a_finger_turns_the_sheet_at_once_and_lets_it_come_back() {
    let mut session = Session::new(Manners::default());
    let rest = session.shown().pose;
    session.touch(1, TouchPhase::Started, MIDDLE);
    session.frame();
    session.touch(1, TouchPhase::Moved, MIDDLE + Vec2::new(60.0, 0.0));
    let mut frames = 0;
    while session.shown().pose == rest {
        session.frame();
        frames += 1;
        assert!(frames <= LATENCY_FRAMES, "the sheet follows too late");
    }
    session.lift(1, MIDDLE + Vec2::new(60.0, 0.0));
    session.wait(4.0);
    assert_eq!(session.shown().pose, rest);
}

#[test]
fn two_visitors_a_palm_and_a_lost_touch_do_not_disturb_each_other() {
    let mut session = Session::new(Manners::default());
    session.press(Control::Open(Panel::Light));
    let dial = session.find(Control::Dial).expect("a dial");
    let lamp = |session: &mut Session| session.resource::<Hand>().lamp().expect("a lamp");
    // One holds the lamp, another brings the sheet nearer.
    let before = (session.shown().scene.camera.width_mm, lamp(&mut session));
    let on_dial = |x: f32, y: f32| dial.center() + Vec2::new(x, -y) * dial.width() / 2.0;
    session.drag(1, on_dial(-0.8, 0.0), on_dial(0.0, 0.7));
    session.touch(2, TouchPhase::Started, Vec2::new(300.0, 200.0));
    session.touch(3, TouchPhase::Started, Vec2::new(400.0, 200.0));
    session.frame();
    for step in 1..=10 {
        let by = 8.0 * step as f32;
        session.touch(1, TouchPhase::Moved, on_dial(0.07 * step as f32, 0.7));
        session.touch(2, TouchPhase::Moved, Vec2::new(300.0 - by, 200.0));
        session.touch(3, TouchPhase::Moved, Vec2::new(400.0 + by, 200.0));
        session.frame();
    }
    let after = (session.shown().scene.camera.width_mm, lamp(&mut session));
    assert!(after.0 < 0.6 * before.0, "{} → {}", before.0, after.0);
    assert!((after.1.azimuth_deg - 45.0).abs() < 3.0, "{:?}", after.1);
    assert!(before.1.azimuth_deg > 170.0);
    // The lamp's visitor goes without the glass hearing of it; the other goes on.
    session.lift(2, Vec2::new(220.0, 200.0));
    session.lift(3, Vec2::new(480.0, 200.0));
    session.wait(3.0);
    let still = session.shown();
    for (id, by) in [(10, 0.0), (11, 20.0), (12, 45.0), (13, 60.0)] {
        session.touch(
            id,
            TouchPhase::Started,
            Vec2::new(400.0 + by, 250.0 + by / 3.0),
        );
    }
    session.frame();
    for id in 10..14 {
        session.touch(id, TouchPhase::Moved, Vec2::new(330.0, 150.0 + id as f32));
    }
    session.frame();
    assert_eq!(session.shown().scene.camera, still.scene.camera, "a palm");
    session.drag(20, Vec2::new(150.0, 380.0), Vec2::new(210.0, 380.0));
    assert_ne!(session.shown().scene.camera, still.scene.camera);
}

#[test]
fn controls_do_what_they_say() {
    let mut session = Session::new(Manners::default());
    session.press(Control::Flip);
    session.wait(1.5);
    session.settle();
    assert_eq!(session.shown().scene.side, SideName::Verso);
    session.press(Control::Open(Panel::Scenes));
    session.press(Control::Scene(1));
    assert_eq!(session.shown().scene.id, "detail");
    session.press(Control::Open(Panel::Layers));
    session.press(Control::Layer(0));
    assert_eq!(session.shown().scene.overlays.len(), 1);
    session.press(Control::Open(Panel::Compare));
    assert!(
        session.find(Control::Layer(0)).is_none(),
        "one list at a time"
    );
    let modes = session.resource::<Hand>().comparisons();
    session.press(Control::Mode(Some(modes[0])));
    assert_eq!(
        session.shown().scene.compare.map(|c| c.mode),
        Some(modes[0])
    );
    session.press(Control::Mode(None));
    assert_eq!(session.shown().scene.compare, None);
    session.press(Control::Open(Panel::Light));
    session.press(Control::Preset(Preset::Raking(3)));
    let lamp = session.resource::<Hand>().lamp().expect("a lamp");
    assert_eq!((lamp.elevation_deg, lamp.azimuth_deg), (12.0, 270.0));
    session.press(Control::Preset(Preset::LightTable));
    assert_eq!(session.shown().scene.transmitted, 1.0);
    session.press(Control::Preset(Preset::LightTable));
    assert_eq!(session.shown().scene.transmitted, 0.0);
    // The slider of the lamp's colour, warm at one end.
    let warmth = session.find(Control::Warmth).expect("a slider");
    session.tap(Vec2::new(warmth.min.x + 1.0, warmth.center().y));
    assert_eq!(session.resource::<Hand>().glow().kelvin, Some(2200.0));
    session.press(Control::Open(Panel::More));
    session.press(Control::TextSize);
    assert!(session.resource::<Interface>().text_factor() > 1.2);
    session.press(Control::Home);
    let interface = session.resource::<Interface>();
    assert!(interface.open.is_empty() && interface.text_factor() == 1.0);
    assert_eq!(session.resource::<Hand>().glow().kelvin, None);
}

#[test]
fn a_finger_on_a_control_leaves_the_sheet_alone() {
    let mut session = Session::new(Manners::default());
    let rest = session.shown();
    let home = session.find(Control::Home).expect("home");
    session.drag(1, home.center(), home.center() + Vec2::new(0.0, -300.0));
    session.lift(1, home.center() + Vec2::new(0.0, -300.0));
    assert_eq!(session.shown().pose, rest.pose);
    assert!(session.resource::<Interface>().held.is_empty());
}

#[test]
fn idle_counts_down_is_refused_tours_and_hands_over() {
    let manners = Manners {
        kiosk: true,
        waits: Some(WAITS),
        languages: vec!["it".into(), "ar".into()],
        ..Manners::default()
    };
    let mut session = Session::new(Manners {
        chime: true,
        ..manners
    });
    let rung = Arc::new(AtomicU32::new(0));
    let ring = rung.clone();
    let chime = Chime::new(move || {
        ring.fetch_add(1, Ordering::Relaxed);
    });
    session.world().insert_resource(chime);
    session.press(Control::Open(Panel::More));
    session.press(Control::Language(1));
    assert_eq!(session.shown().scene.language.as_deref(), Some("ar"));
    session.press(Control::Flip);
    session.wait(WAITS.idle_s - 2.0);
    assert!(session.find(Control::Stay).is_none());
    assert_eq!(rung.load(Ordering::Relaxed), 0);
    session.wait(3.0);
    assert_eq!(rung.load(Ordering::Relaxed), 1, "heard as well as seen");
    let stay = session.find(Control::Stay).expect("a countdown");
    keep(&session.see(), "countdown-ar.png");
    session.tap(stay.center());
    assert!(session.find(Control::Stay).is_none(), "refused");
    assert_eq!(
        session.shown().scene.language.as_deref(),
        Some("ar"),
        "nothing is lost"
    );
    assert_eq!(session.shown().scene.side, SideName::Verso);

    session.wait(WAITS.idle_s + WAITS.countdown_s + 1.0);
    assert!(session.resource::<Attract>().is_touring());
    assert_eq!(
        session.shown().scene.language.as_deref(),
        Some("it"),
        "home, language too"
    );
    assert_eq!(session.shown().scene.side, SideName::Recto);
    assert!(
        session.find(Control::Home).is_none(),
        "nothing lies on the sheet"
    );
    assert!(session.camera_moves(), "against burn-in");
    keep(&session.see(), "attract.png");
    session.wait(12.0);
    assert_eq!(session.shown().scene.id, "detail", "the tour goes on");

    let seen = session.shown().scene.id;
    session.touch(5, TouchPhase::Started, MIDDLE);
    session.frame();
    assert!(!session.resource::<Attract>().is_touring());
    session.lift(5, MIDDLE);
    session.frame();
    assert_eq!(
        session.shown().scene.id,
        seen,
        "the visitor begins where the tour was"
    );
    assert!(session.find(Control::Home).is_some());
    assert!(!session.camera_moves());
    session.press(Control::Home);
    assert!(matches!(
        session.resource::<Attract>().doing(),
        Doing::Waiting { .. }
    ));
}

#[test]
fn whoever_measures_is_not_sent_home() {
    let manners = Manners {
        waits: Some(WAITS),
        ..Manners::default()
    };
    let mut session = Session::new(manners);
    session.press(Control::Open(Panel::Measure));
    session.press(Control::Tool(Some(recto::visitor::Kind::Ruler)));
    session.tap(MIDDLE);
    session.wait(3.0 * WAITS.idle_s);
    assert!(session.find(Control::Stay).is_none());
    session.tap(MIDDLE + Vec2::new(80.0, 0.0));
    session.wait(WAITS.idle_s + 1.0);
    assert!(session.find(Control::Stay).is_some(), "it is measured");
}

#[test]
fn what_is_touched_is_seen_and_read_from_the_right_where_people_do() {
    let mut session = Session::new(Manners {
        languages: vec!["en".into(), "ar".into(), "ja".into()],
        ..Manners::default()
    });
    let closed = session.see();
    keep(&closed, "controls.png");
    session.press(Control::Open(Panel::Light));
    session.press(Control::Open(Panel::Scenes));
    session.press(Control::Open(Panel::More));
    let open = session.see();
    keep(&open, "controls-open.png");
    assert!(covered(&open) > covered(&closed) + 0.2);
    let left = session.find(Control::Language(1)).expect("languages");
    assert!(left.max.x < MIDDLE.x);
    session.press(Control::Language(1));
    let right = session.find(Control::Language(1)).expect("languages");
    assert!(right.min.x > MIDDLE.x, "mirrored");
    let mirrored = session.see();
    keep(&mirrored, "controls-ar.png");
    assert!(mirrored.legend != open.legend);
    session.press(Control::Language(2));
    keep(&session.see(), "controls-ja.png");
    session.press(Control::Contrast);
    session.press(Control::TextSize);
    keep(&session.see(), "controls-large.png");
}

#[test]
fn a_sheet_is_turned_round_by_two_fingers_and_set_upright() {
    let mut session = Session::new(Manners::default());
    let about = Vec2::new(400.0, 250.0);
    let arm = |degrees: f32| Vec2::from_angle(-degrees.to_radians()) * 90.0;
    session.touch(1, TouchPhase::Started, about + arm(0.0));
    session.touch(2, TouchPhase::Started, about - arm(0.0));
    session.frame();
    for step in 1..=40 {
        let degrees = 2.5 * step as f32;
        session.touch(1, TouchPhase::Moved, about + arm(degrees));
        session.touch(2, TouchPhase::Moved, about - arm(degrees));
        session.frame();
    }
    let turned = session.shown().scene.camera.turn.0;
    // Anticlockwise on the glass is the camera going clockwise; some of the way tells a turn from a tremor.
    assert!((turned + 100.0).abs() < 14.0, "{turned}");
    session.lift(1, about);
    session.lift(2, about);
    session.wait(3.0);
    let upright = session.shown().scene.camera.turn.0;
    assert!(
        (turned - upright).abs() < 1e-9 || upright == -90.0,
        "{upright}"
    );
    assert_ne!(DVec2::from_angle(upright.to_radians()), DVec2::X);
}

#[test]
fn staff_have_a_chart_in_the_dark_too_and_it_goes_by_itself() {
    let mut session = Session::new(Manners {
        kiosk: true,
        waits: Some(WAITS),
        pin: recto::installation::Pin::new("8350").ok(),
        ..Manners::default()
    });
    let [upper, lower] = [10.0, super::visit::SIZE[1] as f32 - 10.0].map(|y| Vec2::new(10.0, y));
    let ask = |session: &mut Session, corner: Vec2| {
        session.touch(9, TouchPhase::Started, corner);
        session.wait(3.5);
        session.lift(9, corner);
        session.frame();
        for digit in [8, 3, 5, 0] {
            session.press(Control::Digit(digit));
        }
        session.press(Control::Enter);
        session.press(Control::Staff(Staff::Chart));
        session.frame();
    };
    // Pure red, where a sheet of paper has none, covers all of its patch.
    let red = |picture: &Picture| {
        let is_red = |texel: &&[f32; 4]| texel[0] > 0.99 && texel[1] < 0.01 && texel[3] > 0.99;
        picture.legend.iter().filter(is_red).count() as f64 / picture.legend.len() as f64
    };
    let without = session.see();
    assert_eq!(red(&without), 0.0);
    ask(&mut session, upper);
    let chart = session.see();
    keep(&chart, "chart.png");
    assert!(red(&chart) > 0.02, "{}", red(&chart));
    session.wait(WAITS.idle_s + WAITS.countdown_s + 5.0);
    assert!(
        !session.resource::<Attract>().is_touring(),
        "it is being measured"
    );
    session.tap(MIDDLE);
    assert_eq!(red(&session.see()), 0.0, "the next touch closes it");

    session.world().insert_resource(Closed(true));
    session.frame();
    ask(&mut session, lower);
    assert!(red(&session.see()) > 0.02);
    session.wait(1000.0);
    let dark = session.see();
    assert_eq!(red(&dark), 0.0, "forgotten");
    assert!(covered(&dark) > 0.999, "dark again");
}
