//! The window: opens, and follows the hand.

use std::{
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    time::Duration,
};

use bevy::{
    core_pipeline::{Core3d, Core3dSystems},
    prelude::*,
    render::{RenderApp, renderer::RenderAdapterInfo},
    window::{
        CursorOptions, Monitor, MonitorSelection, OnMonitor, PrimaryWindow, WindowCloseRequested,
        WindowMode, WindowResolution,
    },
    winit::{EventLoopProxyWrapper, WinitSettings, WinitUserEvent},
};

use wgpu::DeviceType;

use super::{
    Manners, NoDisplay, ShowOptions,
    alarm::Alarm,
    attending::{self, AskAgain, Closed, House},
    attract::Attract,
    board,
    caption::{self, Texts},
    chart::{self, Chart},
    chime::{self, Chime},
    comparing,
    controls::{
        Contact, Interface, Reading,
        draw::{self, Controls, Languages, ProgramWords, Reach},
        icons::Icons,
        operate::{self, Asked},
        thumbs::{self, Thumbs},
    },
    display,
    export::{self, Exports},
    filling::{self, Filling},
    foresight::{Foresight, foresee},
    glass::Glass,
    hand::{Hand, Picture, Retreat},
    hints::{self, Hints},
    hotspots,
    input::Devices,
    intent::Intent,
    letters::{self, FontFolder},
    marks::{self, Marks, Shape},
    measuring::Measuring,
    mirror::{self, Led, Unfollowed},
    pace::{self, Pace},
    pointing::{self, Pointer},
    reader::Reader,
    saving::{self, Saved},
    speech,
    staff::{StaffPanel, StaffWish},
    tools,
};
use crate::{
    manifest::exhibit::Exhibit,
    stage::{
        Arranged, Library, Shown, StagePlugin, StageSet, Waker,
        camera::{camera_bundle, without_clusters},
        composite::{PictureCamera, PictureSize},
        legend::{Speaks, TextCamera},
        reload::{ReloadPlugin, Reread, Verdict},
        say,
    },
};

/// Size of the window in pixels where none is asked for.
const SIZE: [u32; 2] = [1280, 800];
/// Samples along the steepest direction of a tilted map.
const ANISOTROPY: u16 = 16;
/// Pixels per inch of a display whose size is not known.
const PPI: f64 = 96.0;
const MM_PER_INCH: f64 = 25.4;
/// Writes the number of frames drawn into this file, for tests.
const FRAME_LOG: &str = "RECTO_FRAME_LOG";
/// How often.
const FRAME_LOG_PERIOD: Duration = Duration::from_millis(200);
/// Set to anything but 0, it turns motion into cuts.
const REDUCED_MOTION: &str = "RECTO_REDUCED_MOTION";

/// The size of the display's visible area in mm, if known.
#[derive(Resource, Clone, Copy)]
struct DisplayMm(Option<[f64; 2]>);

/// Shows scene number `scene` until the window closes, and returns the exit code.
pub fn run(
    exhibit: Arc<Exhibit>,
    scene: usize,
    options: &ShowOptions,
    furnish: impl FnOnce(&mut App),
) -> Result<u8, NoDisplay> {
    let mut app = App::new();
    let size = options.size.unwrap_or(SIZE);
    let window = Window {
        title: title(&exhibit),
        resolution: WindowResolution::new(size[0], size[1]),
        mode: mode(options.fullscreen),
        ..default()
    };
    display::open(&mut app, window)?;
    let proxy = (**app.world().resource::<EventLoopProxyWrapper>()).clone();
    // The loop is gone when the program is closing: nobody is left to wake.
    let wake = move || {
        let _ = proxy.send_event(WinitUserEvent::WakeUp);
    };
    let [width, height] = size.map(f64::from);
    let picture = Picture {
        aspect: width / height,
        width_mm: width * MM_PER_INCH / PPI,
        measured: false,
    };
    let asked = std::env::var_os(REDUCED_MOTION).is_some_and(|set| !set.is_empty() && set != "0");
    let mut manners = options.manners.clone();
    manners.calm |= asked;
    let tier = options.tier.unwrap_or_default();
    let mut hand = Hand::new(exhibit.clone(), scene, tier, picture, manners.calm);
    if options.tier.is_none() {
        hand.leave_tier_free();
    }
    let waker = Waker(Arc::new(wake));
    app.insert_resource(Alarm::new(waker.clone()))
        .insert_resource(waker)
        .insert_resource(Thumbs::by_itself())
        .add_plugins((
            StagePlugin {
                display: true,
                anisotropy: ANISOTROPY,
            },
            ReloadPlugin { exhibit },
            VisitorPlugin {
                hand,
                display_mm: options.display_mm,
                export: options.export.clone(),
                manners,
            },
        ))
        .init_resource::<Filling>()
        .add_systems(Update, filling::fill)
        .add_observer(display::outlive)
        .add_systems(Startup, (without_clusters, suit_device, set_up));
    count_frames(&mut app);
    furnish(&mut app);
    if options.manners.kiosk {
        if options.manners.chime {
            app.insert_resource(Chime::aloud());
        }
        hide_cursors(app.world_mut());
    }
    match app.run() {
        AppExit::Success => Ok(0),
        AppExit::Error(code) => Ok(code.get()),
    }
}

/// Whoever is at the picture: takes in what the devices of its window report, and changes what is
/// shown. It needs the stage, a camera for the texts, and somebody who reports.
pub struct VisitorPlugin {
    pub hand: Hand,
    /// As in [`ShowOptions`].
    pub display_mm: Option<[f64; 2]>,
    pub export: Option<PathBuf>,
    pub manners: Manners,
}

impl Plugin for VisitorPlugin {
    fn build(&self, app: &mut App) {
        let manners = &self.manners;
        let languages = Languages {
            installed: manners.languages.clone(),
            ..default()
        };
        let home = Reading {
            enlarge: manners.enlarge as f32,
            contrast: manners.contrast,
            calm: manners.calm,
        };
        let mut hand = self.hand.clone();
        if let [first, ..] = &manners.languages[..] {
            hand.speak(Some(first.clone()));
        }
        app.insert_resource(WinitSettings::continuous())
            .insert_resource(DisplayMm(self.display_mm))
            .insert_resource(hand.shown())
            .insert_resource(hand)
            .insert_resource(Interface::new(true, home))
            .insert_resource(Attract::new(manners.waits))
            .insert_resource(StaffPanel::new(manners.pin.clone()))
            .insert_resource(House(manners.clone()))
            .insert_resource(languages)
            .init_resource::<ProgramWords>()
            .init_resource::<Speaks>()
            .init_resource::<Hints>()
            .init_resource::<FontFolder>()
            .init_resource::<Reach>()
            .init_resource::<Glass>()
            .init_resource::<Closed>()
            .init_resource::<Chart>()
            .init_resource::<AskAgain>()
            .init_resource::<Unfollowed>()
            .add_message::<StaffWish>()
            .add_message::<Verdict>()
            .init_resource::<Controls>()
            .init_resource::<Icons>()
            .init_resource::<Thumbs>()
            .add_message::<Contact>()
            .add_message::<Asked>()
            .init_resource::<Devices>()
            .init_resource::<Texts>()
            .init_resource::<Saved>()
            .init_resource::<Pace>()
            .init_resource::<Foresight>()
            .init_resource::<Shape>()
            .init_resource::<Marks>()
            .init_resource::<Measuring>()
            .init_resource::<Pointer>()
            .init_resource::<Reader>()
            .insert_resource(Exports::into(self.export.clone()))
            .insert_resource(PictureSize(UVec2::ONE))
            .add_message::<Intent>()
            .add_message::<Reread>()
            .add_systems(Startup, letters::load)
            .add_systems(PreUpdate, letters::hint)
            .add_systems(
                Update,
                (
                    (
                        take_in_reread,
                        measure,
                        (
                            attending::attend,
                            chime::ring,
                            attending::read_devices,
                            operate::operate,
                            (attending::serve_staff, chart::forget).chain(),
                        )
                            .chain()
                            .run_if(not(resource_exists::<Led>)),
                        (mirror::leave, mirror::follow)
                            .chain()
                            .run_if(resource_exists::<Led>),
                        speech::speak,
                        steer.run_if(not(resource_exists::<Led>)),
                        tools::follow,
                        tools::ask_for_told.run_if(resource_exists::<Led>),
                        hints::follow.run_if(not(resource_exists::<Led>)),
                        follow_wishes,
                        saving::keep,
                        export::export,
                    )
                        .chain()
                        .in_set(StageSet::Steer),
                    (
                        (
                            fall_back,
                            foresee.run_if(not(resource_exists::<Led>)),
                            marks::learn,
                        )
                            .chain(),
                        (comparing::lay, hotspots::lay).chain(),
                        (tools::hear, pointing::point, tools::lay).chain(),
                        marks::draw,
                        draw::arrange,
                        board::write,
                        caption::draw,
                        (thumbs::gather, draw::draw, attending::darken, chart::draw).chain(),
                        pace::rest,
                    )
                        .chain()
                        .after(StageSet::Arrange),
                ),
            );
    }
}

fn mode(fullscreen: bool) -> WindowMode {
    if fullscreen {
        // Exclusive full screen does not survive a display that goes away.
        WindowMode::BorderlessFullscreen(MonitorSelection::Current)
    } else {
        WindowMode::Windowed
    }
}

/// A processor that stands in for a graphics device takes four times as long for a frame with
/// anisotropic filtering.
fn suit_device(adapter: Res<RenderAdapterInfo>, mut library: ResMut<Library>) {
    if adapter.device_type == DeviceType::Cpu {
        library.set_anisotropy(1);
    }
}

fn set_up(mut commands: Commands) {
    commands.spawn((
        PictureCamera,
        camera_bundle(0),
        TextCamera {
            height: 1.0,
            width: 1.0,
            foot: 0.0,
        },
    ));
}

/// Names the window after the exhibit.
fn entitle(mut windows: Query<&mut Window, With<PrimaryWindow>>, exhibit: &Exhibit) {
    for mut window in &mut windows {
        window.title = title(exhibit);
    }
}

/// Nobody points with a mouse on a wall.
fn hide_cursors(world: &mut World) {
    let mut windows = world.query_filtered::<Entity, With<Window>>();
    let windows: Vec<Entity> = windows.iter(world).collect();
    for window in windows {
        world.entity_mut(window).insert(CursorOptions {
            visible: false,
            ..default()
        });
    }
}

/// The window's, from the exhibit's.
fn title(exhibit: &Exhibit) -> String {
    let title = exhibit.text(&exhibit.title, "").unwrap_or_default();
    format!("{title} – Recto")
}

fn take_in_reread(
    mut reread: MessageReader<Reread>,
    mut hand: ResMut<Hand>,
    house: Res<House>,
    windows: Query<&mut Window, With<PrimaryWindow>>,
) {
    if let Some(Reread(exhibit)) = reread.read().last() {
        hand.replace(house.0.amended(exhibit.clone()));
        entitle(windows, exhibit);
    }
}

/// Follows the window's size.
fn measure(
    windows: Query<(Ref<Window>, Option<&OnMonitor>), With<PrimaryWindow>>,
    monitors: Query<&Monitor>,
    display_mm: Res<DisplayMm>,
    (mut hand, mut devices): (ResMut<Hand>, ResMut<Devices>),
    mut texts: Query<&mut TextCamera>,
    (mut picture_size, mut glass): (ResMut<PictureSize>, ResMut<Glass>),
    (mut reach, house): (ResMut<Reach>, Res<House>),
) {
    let Ok((window, monitor)) = windows.single() else {
        return;
    };
    let (size, pixels) = match glass.width_mm {
        Some(_) => (glass.size, glass.pixels),
        None => (window.size(), window.physical_size()),
    };
    if size.min_element() < 1.0 {
        return;
    }
    let wanted = Glass {
        size,
        pixels,
        ..glass.clone()
    };
    glass.set_if_neq(wanted);
    picture_size.0 = pixels;
    for mut text in &mut texts {
        if (text.width, text.height) != (size.x, size.y) {
            (text.width, text.height) = (size.x, size.y);
        }
    }
    let width_px = window.physical_width();
    let monitor = monitor.and_then(|on| monitors.get(on.0).ok());
    let measured = display_mm.0.zip(monitor).map(|([width, _], monitor)| {
        f64::from(width_px) * width / f64::from(monitor.physical_width.max(1))
    });
    let measured = glass.width_mm.or(measured);
    let width_mm = measured.unwrap_or(f64::from(size.x) * MM_PER_INCH / PPI);
    devices.resize(size, size.x / width_mm.max(1.0) as f32);
    reach.0 = house
        .0
        .reach
        .map(|shares| shares.map(|share| share as f32 * size.y));
    hand.resize(Picture {
        aspect: f64::from(size.x) / f64::from(size.y),
        width_mm,
        measured: measured.is_some(),
    });
}

/// Moves the hand, and shows what changed.
fn steer(
    mut intents: MessageReader<Intent>,
    (mut hand, measuring): (ResMut<Hand>, Res<Measuring>),
    time: Res<Time<Real>>,
    (arranged, foresight, mut pace): (Res<Arranged>, Res<Foresight>, ResMut<Pace>),
    (interface, controls): (Res<Interface>, Res<Controls>),
    mut shown: ResMut<Shown>,
) {
    let arrows_are_taken = operate::takes_arrows(&interface, &controls);
    let serving = foresight.serving(&shown.exhibit, hand.wanted(), pace.observed);
    hand.bypass_change_detection().serve(serving);
    hand.advance(time.delta_secs_f64(), arranged.is_settled());
    let mut moving = hand.is_moving();
    for intent in intents.read() {
        if tools::is_for_tool(&measuring, *intent)
            || arrows_are_taken && matches!(intent, Intent::Pan(_))
        {
            continue;
        }
        hand.apply(*intent);
        moving |= intent.is_motion();
    }
    if moving {
        pace.moved = time.elapsed();
        if pace.slow {
            hand.hurry(true);
        }
    }
    let wanted = hand.shown();
    if differs(&shown, &wanted) {
        *shown = wanted;
    }
}

pub(super) fn differs(a: &Shown, b: &Shown) -> bool {
    !Arc::ptr_eq(&a.exhibit, &b.exhibit)
        || a.scene != b.scene
        || a.pose != b.pose
        || a.both_sides != b.both_sides
        || a.aspect != b.aspect
        || a.tier != b.tier
}

/// Wishes that are about the window and its texts.
fn follow_wishes(
    mut intents: MessageReader<Intent>,
    mut closed: MessageReader<WindowCloseRequested>,
    (mut hand, mut measuring, mut texts): (ResMut<Hand>, ResMut<Measuring>, ResMut<Texts>),
    (mut interface, house): (ResMut<Interface>, Res<House>),
    mut windows: Query<&mut Window, With<PrimaryWindow>>,
    mut exit: MessageWriter<AppExit>,
) {
    for intent in intents.read() {
        match intent {
            // On a wall the next visitor finds what the first one did.
            Intent::Home if house.0.kiosk => *texts = Texts::default(),
            Intent::Caption => texts.caption = !texts.caption,
            Intent::Keys => texts.keys = !texts.keys,
            Intent::Fullscreen => {
                for mut window in &mut windows {
                    window.mode = mode(window.mode == WindowMode::Windowed);
                }
            }
            // What is in the hand, or open, goes first.
            Intent::Quit if measuring.bypass_change_detection().put_away() => {
                measuring.set_changed();
            }
            Intent::Quit if hand.bypass_change_detection().close_hotspot() => texts.set_changed(),
            Intent::Quit if texts.keys => texts.keys = false,
            Intent::Quit if !interface.open.is_empty() || interface.focus.is_some() => {
                interface.open.clear();
                interface.focus = None;
            }
            Intent::Quit if house.0.kiosk => {}
            Intent::Quit => drop(exit.write(AppExit::Success)),
            _ => {}
        }
    }
    if closed.read().next().is_some() && !house.0.kiosk {
        exit.write(AppExit::Success);
    }
}

/// Where maps cannot be decoded, the curator is told and the visitor sees what was there
/// before. Its files may be at fault by now as well, and then the last picture stays; if there
/// was none, the exhibit is at fault.
fn fall_back(
    (mut hand, mut shown): (ResMut<Hand>, ResMut<Shown>),
    arranged: Res<Arranged>,
    mut library: ResMut<Library>,
    (mut pace, house): (ResMut<Pace>, Res<House>),
    windows: Query<&mut Window, With<PrimaryWindow>>,
    (mut verdicts, mut exit): (MessageWriter<Verdict>, MessageWriter<AppExit>),
) {
    pace.stuck = false;
    if arranged.is_settled() {
        hand.bypass_change_detection().keep();
        return;
    }
    if library.is_busy() {
        return;
    }
    // Taken out of the list, none of them is told twice.
    let faults = std::mem::take(&mut library.bypass_change_detection().faults);
    let told = faults.iter().map(|(path, error)| {
        let fault = shown.exhibit.map_fault(path, error);
        say(&fault);
        fault.to_string()
    });
    let told: Vec<String> = told.collect();
    if !told.is_empty() {
        verdicts.write(Verdict(Err(told.join("\n"))));
    }
    match hand.bypass_change_detection().retreat() {
        Retreat::Back => {
            *shown = hand.shown();
            entitle(windows, &shown.exhibit);
        }
        Retreat::Stuck => pace.stuck = true,
        // A wall waits for another exhibit, or for a file that is saved.
        Retreat::Nowhere if house.0.kiosk => pace.stuck = true,
        Retreat::Nowhere => drop(exit.write(AppExit::from_code(1))),
    }
}

/// Counts the frames that are drawn, if a test asks for it.
fn count_frames(app: &mut App) {
    let (Some(path), Some(render)) = (
        std::env::var_os(FRAME_LOG).map(PathBuf::from),
        app.get_sub_app_mut(RenderApp),
    ) else {
        return;
    };
    let frames = Arc::new(AtomicU64::new(0));
    let drawn = frames.clone();
    let count = move || {
        drawn.fetch_add(1, Ordering::Relaxed);
    };
    render.add_systems(Core3d, count.in_set(Core3dSystems::MainPass));
    std::thread::spawn(move || {
        let mut last = None;
        loop {
            let now = frames.load(Ordering::Relaxed);
            if last != Some(now) {
                // A test that misses a number reads the next one.
                let _ = std::fs::write(&path, format!("{now}\n"));
                last = Some(now);
            }
            std::thread::sleep(FRAME_LOG_PERIOD);
        }
    });
}
