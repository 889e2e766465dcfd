//! Who is there: events of the devices are taken in, and what happens while nobody does anything, behind
//! the staff's PIN, and outside the opening hours.

use std::time::Duration;

use bevy::{
    input::{ButtonState, touch::TouchPhase},
    prelude::*,
    window::WindowEvent,
};
use glam::DVec2;

use super::{
    Manners,
    attract::{self, Attract, Touched},
    chart::Chart,
    controls::{
        Contact, Interface, Staff,
        draw::{Controls, Languages},
        operate::Asked,
    },
    glass::Glass,
    hand::{self, Hand},
    input::{Devices, Ground, Wish},
    intent::Intent,
    measuring::Measuring,
    staff::{StaffPanel, StaffWish},
};
use crate::stage::{Arranged, Shown, legend::TextCamera};

/// A measurement is left half drawn, and a picture that cannot be shown given up, after so long.
const LEFT: Duration = Duration::from_secs(300);

/// The screens are dark, and nothing is touched.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Closed(pub bool);

/// When the house wants to be asked again.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct AskAgain(pub Option<Duration>);

/// What darkens the picture.
#[derive(Component)]
pub struct Dark;

/// Darkens the picture, or not.
pub fn darken(
    mut commands: Commands,
    (closed, staff, chart): (Res<Closed>, Res<StaffPanel>, Res<Chart>),
    cameras: Query<Entity, With<TextCamera>>,
    dark: Query<Entity, With<Dark>>,
) {
    let Ok(camera) = cameras.single() else {
        return;
    };
    let is_dark = closed.0 && !staff.is_open() && !chart.is_shown();
    match (is_dark, dark.iter().next()) {
        (true, None) => drop(commands.spawn((
            Dark,
            UiTargetCamera(camera),
            GlobalZIndex(i32::MAX),
            Node {
                position_type: PositionType::Absolute,
                width: Val::Percent(100.0),
                height: Val::Percent(100.0),
                ..default()
            },
            BackgroundColor(Color::BLACK),
        ))),
        (false, Some(dark)) => commands.entity(dark).despawn(),
        _ => {}
    }
}

/// The manners of the house.
#[derive(Resource)]
pub struct House(pub Manners);

/// Sees whether somebody is there; goes home and tours while nobody is.
pub fn attend(
    time: Res<Time<Real>>,
    (arranged, measuring, controls): (Res<Arranged>, Res<Measuring>, Res<Controls>),
    mut attract: ResMut<Attract>,
    (mut hand, mut interface): (ResMut<Hand>, ResMut<Interface>),
    (languages, devices, mut staff): (Res<Languages>, Res<Devices>, ResMut<StaffPanel>),
    (house, closed, chart, mut scan): (Res<House>, Res<Closed>, Res<Chart>, Local<f64>),
    mut intents: MessageWriter<Intent>,
) {
    let now = time.elapsed();
    staff.bypass_change_detection().pass(now);
    if closed.0 {
        // In the dark nothing moves, and whoever comes next begins at home.
        if closed.is_changed() {
            attract.close();
            interface.go_home();
            intents.write(Intent::Home);
            hand.go_home(languages.spoken(None));
            hand.calm(interface.calm);
        }
        return;
    }
    // Nobody waits for a picture that is not there yet, nor for a measurement that was left half drawn.
    let at_work = !arranged.is_settled() || measuring.laying().is_some();
    // Whoever measures the chart touches nothing.
    let busy = chart.is_shown() || devices.is_held(now) || at_work && devices.quiet(now) < LEFT;
    let stops = hand::stops(hand.exhibit());
    let seconds = stop_seconds(&hand);
    let due = attract
        .bypass_change_detection()
        .advance(time.delta_secs_f64(), busy, &seconds);
    for due in due {
        match due {
            attract::Due::Home => {
                interface.go_home();
                intents.write(Intent::Home);
                hand.go_home(languages.spoken(None));
                hand.calm(interface.calm);
            }
            attract::Due::Stop(stop) => {
                if let Some((scene, _)) = stops.get(stop) {
                    hand.stop_at(*scene);
                }
            }
        }
    }
    if let Some(period) = house.0.scan_s.filter(|_| !controls.laid.widgets.is_empty()) {
        *scan += time.delta_secs_f64();
        if *scan >= period {
            *scan = 0.0;
            intents.write(Intent::StepFocus(1));
        }
    }
}

/// How long each stop of the tour lasts.
pub fn stop_seconds(hand: &Hand) -> Vec<f64> {
    let stops = hand::stops(hand.exhibit());
    stops.iter().map(|(_, seconds)| *seconds).collect()
}

/// Follows what the staff asked for, and the countdown's refusal.
pub fn serve_staff(
    mut asked: MessageReader<Asked>,
    mut staff: ResMut<StaffPanel>,
    (mut chart, time): (ResMut<Chart>, Res<Time<Real>>),
    mut wishes: MessageWriter<StaffWish>,
) {
    for asked in asked.read() {
        match asked {
            Asked::Digit(digit) => staff.digit(*digit),
            Asked::Erase => staff.erase(),
            Asked::Enter => staff.enter(),
            Asked::Staff(wish) => match staff.ask(*wish) {
                Some(Staff::Chart) => chart.show(time.elapsed()),
                Some(wish) => drop(wishes.write(StaffWish(wish))),
                None => {}
            },
            // The touch itself has said so.
            Asked::Stay => {}
        }
    }
}

pub fn read_devices(
    mut events: MessageReader<WindowEvent>,
    mut devices: ResMut<Devices>,
    time: Res<Time<Real>>,
    (controls, shown): (Res<Controls>, Res<Shown>),
    (house, mut glass, closed, mut chart): (Res<House>, ResMut<Glass>, Res<Closed>, ResMut<Chart>),
    (mut attract, mut staff, mut hand): (ResMut<Attract>, ResMut<StaffPanel>, ResMut<Hand>),
    (mut intents, mut contacts): (MessageWriter<Intent>, MessageWriter<Contact>),
) {
    let now = time.elapsed();
    if closed.is_changed() && closed.0 {
        // Whoever held something is not heard of any more.
        events.clear();
        devices.let_go(now, |wish| match wish {
            Wish::Intent(intent) => drop(intents.write(intent)),
            Wish::Contact(contact) => drop(contacts.write(contact)),
        });
    }
    let taken = |at: DVec2| {
        let compare = shown.scene.compare.as_ref();
        compare.is_some_and(|comparison| comparison.is_taken_at(at, shown.aspect))
    };
    let ground = Ground {
        controls: &controls.laid,
        compare: &taken,
    };
    for event in events.read() {
        // From one window to another of the same wall nothing is let go.
        if matches!(event, WindowEvent::KeyboardFocusLost(_)) && glass.panes.len() > 1 {
            devices.let_go_of_keys();
            continue;
        }
        let event = &glass.event(event);
        if chart.is_shown() {
            // The touch is about that alone.
            if is_touch(event) && !is_lifted(event) {
                chart.close();
            }
            continue;
        }
        let staff = staff.bypass_change_detection();
        devices.watch_corner(event, now, staff);
        if closed.0 && !staff.is_open() {
            continue;
        }
        if let WindowEvent::TouchInput(touch) = event
            && touch.phase == TouchPhase::Started
            && !devices.is_held(now)
            && let Some(pane) = glass.pane_at(touch.position)
            && glass.home != pane
        {
            glass.home = pane;
        }
        if is_touch(event) && attract.touch() != Touched::GoesOn {
            hand.end_tour();
        }
        devices.take(event, now, ground, |wish| match wish {
            Wish::Intent(intent) if house.0.kiosk && intent.leads_out() => {}
            Wish::Intent(intent) => drop(intents.write(intent)),
            Wish::Contact(contact) => drop(contacts.write(contact)),
        });
    }
}

/// Whether it is the end of what was begun before.
fn is_lifted(event: &WindowEvent) -> bool {
    match event {
        WindowEvent::TouchInput(touch) => touch.phase != TouchPhase::Started,
        WindowEvent::MouseButtonInput(button) => button.state == ButtonState::Released,
        WindowEvent::KeyboardInput(key) => key.state == ButtonState::Released,
        _ => false,
    }
}

/// Whether somebody does something, and not a mouse that trembles by itself.
fn is_touch(event: &WindowEvent) -> bool {
    // Fingers that move are held; a thing that lies there and trembles is nobody.
    matches!(event, WindowEvent::TouchInput(touch) if touch.phase != TouchPhase::Moved)
        || matches!(
            event,
            WindowEvent::MouseButtonInput(_)
                | WindowEvent::MouseWheel(_)
                | WindowEvent::KeyboardInput(_)
        )
}
