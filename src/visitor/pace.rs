//! How the window draws: in every frame while something moves or is on its way, and then not at all.

use std::time::Duration;

use bevy::{
    ecs::system::SystemParam,
    prelude::*,
    winit::{UpdateMode, WinitSettings},
};

use super::{
    alarm::Alarm,
    attending::{self, AskAgain, Closed, House},
    attract::Attract,
    caption::Texts,
    chart::Chart,
    controls::{Interface, draw::Controls, thumbs::Thumbs},
    filling::Filling,
    fineness,
    foresight::Observed,
    hand::Hand,
    hints::Hints,
    staff::StaffPanel,
};
use crate::stage::{
    Arranged, Library, Shown,
    composite::{Composite, is_composite},
    fineness::Fineness,
};

/// Frames drawn after the stage has settled, until maps and pipelines have reached the screen.
const SETTLING_FRAMES: u32 = 4;
/// Frames drawn after a change that needs nothing new on the GPU.
const CHANGE_FRAMES: u32 = 1;
/// Frames are too slow that take longer than the exhibit asks by this factor: a display that is
/// waited for may be a little slower than a round number of ms.
const SLOW: f64 = 1.25;
/// A hand that rests longer has come to rest.
const PAUSE: Duration = Duration::from_millis(400);
/// Between two looks at whether the first maps have arrived.
const LOADING_PAUSE: Duration = Duration::from_millis(30);
/// A public wall that rests draws a frame as often as this, to show that it could.
const HEARTBEAT: Duration = Duration::from_secs(60);

/// How the window draws just now.
#[derive(Resource, Default)]
pub struct Pace {
    /// Frames that follow without being asked for.
    pub left: u32,
    /// Frames at the tier at rest come too slowly to follow a hand.
    pub slow: bool,
    /// How long a frame took last that followed another at once.
    pub observed: Option<Observed>,
    /// When something last moved, since the start.
    pub moved: Duration,
    /// Something has been shown.
    pub begun: bool,
    /// What was learnt of how fine the picture may be in motion.
    pub fineness: fineness::Fineness,
    /// What is wanted cannot be shown until a file is saved: there is nothing to wait for.
    pub stuck: bool,
}

/// Everybody who is to be asked again at some time, and what wakes the window for them.
#[derive(SystemParam)]
pub struct Dues<'w> {
    attract: Res<'w, Attract>,
    staff: Res<'w, StaffPanel>,
    hints: Res<'w, Hints>,
    chart: Res<'w, Chart>,
    house: Res<'w, House>,
    asked: Res<'w, AskAgain>,
    filling: Option<Res<'w, Filling>>,
    alarm: Option<Res<'w, Alarm>>,
}

impl Dues<'_> {
    /// Sets the alarm to whatever is due first.
    fn set(&self, now: Duration, hand: &Hand) {
        let Some(alarm) = &self.alarm else {
            return;
        };
        let kiosk = self.house.0.kiosk;
        let due = [
            self.attract
                .next_s(&attending::stop_seconds(hand))
                .map(Duration::from_secs_f64),
            self.staff.next(),
            self.hints.next(),
            self.chart.next(now),
            self.house.0.scan_s.map(Duration::from_secs_f64),
            kiosk.then_some(HEARTBEAT),
            self.asked.0,
            self.filling.as_ref().and_then(|filling| filling.next(now)),
        ];
        alarm.set(due.into_iter().flatten().min());
    }
}

/// Draws on while something moves or is on its way, and then not at all.
pub fn rest(
    (shown, texts, controls): (Res<Shown>, Res<Texts>, Res<Controls>),
    (interface, thumbs): (Res<Interface>, Res<Thumbs>),
    (time, closed): (Res<Time<Real>>, Res<Closed>),
    dues: Dues,
    (arranged, library, composite): (Res<Arranged>, Res<Library>, Res<Composite>),
    (mut hand, mut pace): (ResMut<Hand>, ResMut<Pace>),
    (mut settings, mut fineness): (ResMut<WinitSettings>, ResMut<Fineness>),
) {
    let settled = arranged.is_settled();
    // Only a frame that follows another at once tells how long they take.
    if settled && pace.left > 0 && !hand.is_hurried() {
        let ms = time.delta_secs_f64() * 1e3;
        pace.slow = ms > SLOW * shown.exhibit.accuracy.frame_ms;
        pace.observed = Some(Observed {
            tier: shown.tier,
            ms,
        });
    }
    if settled && pace.left > 0 && hand.is_hurried() {
        let most_ms = SLOW * shown.exhibit.accuracy.frame_ms;
        pace.fineness.frame(time.delta_secs_f64() * 1e3, most_ms);
    }
    pace.begun |= settled;
    pace.left = pace.left.saturating_sub(1);
    if (!settled && !pace.stuck) || arranged.is_fresh() || composite.is_fresh() {
        pace.left = SETTLING_FRAMES;
    } else if shown.is_changed()
        || texts.is_changed()
        || controls.is_changed()
        || interface.is_changed()
        || dues.hints.is_changed()
        || thumbs.is_changed()
        || closed.is_changed()
        || dues.chart.is_changed()
        || hand.is_moving()
    {
        pace.left = pace.left.max(CHANGE_FRAMES);
    } else if pace.left == 0 && hand.is_hurried() {
        // At rest, the picture refines; a hand that only pauses does not wait for that.
        if time.elapsed().saturating_sub(pace.moved) > PAUSE {
            hand.hurry(false);
            pace.fineness.rest();
        }
        pace.left = CHANGE_FRAMES;
    } else if hand.takes_turns() {
        pace.left = pace.left.max(CHANGE_FRAMES);
    }
    // What is put together pixel by pixel is drawn with all of them.
    let share = match hand.is_hurried() && !is_composite(&shown.scene) {
        true => pace.fineness.share(),
        false => 1.0,
    };
    if fineness.set_if_neq(Fineness(share)) {
        pace.left = pace.left.max(CHANGE_FRAMES);
    }
    let loading = !settled && library.is_busy();
    if loading && !pace.begun {
        // Nothing to see yet: the processor is better used by the maps.
        std::thread::sleep(LOADING_PAUSE);
    }
    // The library wakes a window that waits for it, except that a new one also waits for its
    // shaders, which do not. From one mode straight to the other: a finite wait in between
    // keeps a core busy.
    let mode = if pace.left > 0 && !(loading && pace.begun) {
        UpdateMode::Continuous
    } else {
        UpdateMode::reactive_low_power(Duration::MAX)
    };
    if settings.focused_mode != mode {
        settings.focused_mode = mode;
        settings.unfocused_mode = mode;
    }
    dues.set(time.elapsed(), &hand);
}
