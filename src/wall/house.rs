//! The house that an installation describes: its displays with one picture over them, its manners and its
//! words.

use std::{
    sync::{
        Arc, OnceLock,
        atomic::{AtomicU64, Ordering},
        mpsc::Receiver,
    },
    thread,
    time::Duration,
};

use bevy::{
    camera::RenderTarget,
    prelude::*,
    render::{
        Render, RenderApp, RenderSystems,
        renderer::{RenderDevice, RenderQueue},
    },
    window::PrimaryWindow,
};
use glam::DVec2;
use wgpu::PollType;

use super::{
    desktop::{self, Desktop},
    heartbeat::Heart,
    keeper::{self, Clock, Keeper},
    panes::{self, PaneMaterial, PanesPlugin},
    signals::{self, Signal},
    together::{self, Turn},
};
use crate::{
    installation::{Contrast, Installation, Machine, Pane, Wall, WallWindow},
    manifest::{Fault, Faults, Severity},
    stage::{StageSet, Waker, composite::PictureCamera, say},
    visitor::{
        self, Manners, ShowError, ShowOptions, Waits,
        controls::draw::ProgramWords,
        glass::{self, Glass},
        letters::FontFolder,
    },
    wording::Wordings,
};

/// Between two looks at whether frames were completed.
const POLL: Duration = Duration::from_millis(500);
/// How long a program that was asked to end may take to say so in its log; its supervisor waits a little longer.
const LEAVING: Duration = Duration::from_secs(4);

/// Shows the exhibits of `installation` until somebody who may ends it; as one `machine` of several, its part
/// of them.
///
/// # Errors
/// As [`visitor::show`], where none of its exhibits can be shown.
pub fn show(
    installation: Installation,
    machine: Option<Machine>,
    options: &ShowOptions,
) -> Result<u8, ShowError> {
    // Before any thread is started: all of them leave signals to one.
    let signals = signals::taken();
    let (wordings, warnings) = wordings(&installation)?;
    for warning in warnings {
        say(warning);
    }
    let installation = match &machine {
        Some(machine) => machine.own(installation),
        None => installation,
    };
    let mut keeper = Keeper::new(installation, Clock::default());
    keeper.machine = machine;
    let path = keeper.showable()?;
    let manners = manners(&keeper.installation, options.manners.clone());
    let options = ShowOptions {
        fullscreen: options.fullscreen && keeper.installation.wall.is_none(),
        manners,
        ..options.clone()
    };
    let leaves = keeper.leaves.clone();
    visitor::show_in(&path, &options, |app| {
        furnish(app, keeper, wordings);
        match signals {
            Ok(signals) => heed(app, signals, leaves),
            Err(error) => say(format_args!("recto: signals cannot be taken ({error})")),
        }
    })
}

/// The words of `installation`, with warnings: a language that it offers and that nobody has words for is one.
///
/// # Errors
/// All faults of the museum's own words.
pub fn wordings(installation: &Installation) -> Result<(Wordings, Vec<Fault>), Faults> {
    let (wordings, mut warnings) = Wordings::read(installation.interface.wording.as_deref())?;
    let known: Vec<&str> = wordings.languages().collect();
    for (i, language) in installation.languages.iter().enumerate() {
        if wordings.speaks(language) {
            continue;
        }
        warnings.push(Fault {
            severity: Severity::Warning,
            file: Some(installation.file.clone()),
            place: None,
            path: format!("languages[{i}]"),
            found: format!("\"{language}\", in which controls have no words and are English"),
            allowed: known.join(", "),
            remedy: format!(
                "add {language}.ftl to the folder that [interface] wording names, or remove it"
            ),
            unreadable: false,
        });
    }
    Ok((wordings, warnings))
}

/// How the place wants its picture to behave.
pub fn manners(installation: &Installation, asked: Manners) -> Manners {
    let interface = &installation.interface;
    let reach = installation.wall.as_ref().and_then(|wall| {
        let (top, height) = (wall.top_above_floor_mm?, wall.size_mm().y);
        let share = |above_floor: f64| ((top - above_floor) / height).clamp(0.0, 1.0);
        Some([
            share(installation.reach.to_mm),
            share(installation.reach.from_mm),
        ])
    });
    Manners {
        waits: asked.kiosk.then_some(Waits {
            idle_s: installation.idle.after.as_secs_f64(),
            countdown_s: installation.idle.countdown.as_secs_f64(),
        }),
        chime: installation.idle.chime,
        languages: installation.languages.clone(),
        reach,
        pin: installation.pin.clone(),
        enlarge: interface.enlarge,
        contrast: interface.contrast == Contrast::High,
        calm: asked.calm || interface.reduced_motion,
        max_delta_e: installation.accuracy.max_delta_e,
        frame_ms: installation.accuracy.frame_ms,
        ..asked
    }
}

/// Everything that an installation adds to a window.
pub fn furnish(app: &mut App, keeper: Keeper, wordings: Wordings) {
    let fonts = keeper.installation.interface.fonts.clone();
    app.insert_resource(ProgramWords(wordings))
        .insert_resource(FontFolder(fonts));
    if let Some(wall) = keeper.installation.wall.clone() {
        hang(app, &wall, keeper.machine.as_ref());
    }
    if let Some(heart) = keeper.heart.clone() {
        beat(app, heart);
    }
    if let Some(party) = keeper.party() {
        together::join(app, party);
        app.insert_resource(Turn(keeper.showing()));
    }
    app.insert_resource(keeper).add_systems(
        Update,
        (
            keeper::keep.before(StageSet::Steer),
            keeper::tell.after(StageSet::Steer),
            desktop::look.run_if(resource_exists::<Desktop>),
        ),
    );
}

/// A signal ends the program after a line in its log; one whose loop does not turn any more ends all the same.
fn heed(app: &App, signals: Receiver<Signal>, leaves: Arc<OnceLock<Signal>>) {
    let waker = app.world().resource::<Waker>().clone();
    thread::spawn(move || {
        if let Ok(signal) = signals.recv() {
            let _ = leaves.set(signal);
            (waker.0)();
            thread::sleep(LEAVING);
            std::process::exit(1);
        }
    });
}

/// One picture over all displays, in the windows of this machine.
fn hang(app: &mut App, wall: &Wall, machine: Option<&Machine>) {
    app.add_plugins(PanesPlugin);
    let size = panes::picture_size(wall);
    let world = app.world_mut();
    let picture = world
        .resource_mut::<Assets<Image>>()
        .add(panes::picture(size));
    let mut windows = world.query_filtered::<Entity, With<PrimaryWindow>>();
    let primary = windows.iter(world).next();
    let mut hung = Vec::new();
    let layout = wall.layout_on(machine.map(|machine| machine.name.as_str()));
    for (k, of) in layout.iter().enumerate() {
        let window = panes::window(of, "Recto");
        let entity = match primary.filter(|_| k == 0) {
            Some(entity) => world.entity_mut(entity).insert(window).id(),
            None => world.spawn(window).id(),
        };
        let of: Vec<(Pane, Handle<PaneMaterial>)> = of
            .panes
            .iter()
            .map(|pane| {
                let correction = wall.displays[pane.display].profile.correction();
                let images = &mut world.resource_mut::<Assets<Image>>();
                let material = panes::material(images, &picture, pane, &correction);
                let materials = &mut world.resource_mut::<Assets<PaneMaterial>>();
                (pane.clone(), materials.add(material))
            })
            .collect();
        hung.push((entity, of));
    }
    let own = hung
        .iter()
        .flat_map(|(window, of)| of.iter().map(|(pane, _)| (*window, pane)));
    world.insert_resource(glass_of(wall, &own.collect::<Vec<_>>(), size));
    let windows = hung.iter().map(|(window, _)| *window);
    let windows = windows.zip(layout.iter().cloned()).collect();
    world.insert_resource(Desktop::new(&wall.displays, windows));
    let mut hung = Some(hung);
    app.add_systems(
        PostStartup,
        move |mut commands: Commands, cameras: Query<Entity, With<PictureCamera>>| {
            for camera in &cameras {
                commands
                    .entity(camera)
                    .insert(RenderTarget::Image(picture.clone().into()));
            }
            for (k, (window, panes)) in hung.take().into_iter().flatten().enumerate() {
                panes::hang(&mut commands, (window, 10 + k as isize), &panes);
            }
        },
    );
}

/// The whole picture, with all panes in the order of the displays, so that machines name them alike.
fn glass_of(wall: &Wall, own: &[(Entity, &Pane)], size: UVec2) -> Glass {
    let all: Vec<WallWindow> = wall.layout();
    let mut panes: Vec<&Pane> = all.iter().flat_map(|window| &window.panes).collect();
    panes.sort_by_key(|pane| pane.display);
    let window = |display: usize| own.iter().find(|(_, pane)| pane.display == display);
    Glass {
        size: size.as_vec2(),
        pixels: size,
        width_mm: Some(wall.size_mm().x),
        home: own.first().map_or(0, |(_, pane)| pane.display),
        panes: panes
            .into_iter()
            .map(|pane| match window(pane.display) {
                Some((window, pane)) => on_glass(Some(*window), pane, size),
                None => on_glass(None, pane, size),
            })
            .collect(),
    }
}

fn on_glass(window: Option<Entity>, pane: &Pane, size: UVec2) -> glass::Pane {
    let rect = |min: DVec2, max: DVec2| Rect::from_corners(min.as_vec2(), max.as_vec2());
    let at = DVec2::from(pane.in_window.at.map(f64::from));
    let across = DVec2::from(pane.in_window.size.map(f64::from));
    let picture = size.as_dvec2();
    glass::Pane {
        window,
        in_window: rect(at, at + across),
        in_picture: rect(pane.of_picture.min * picture, pane.of_picture.max * picture),
    }
}

/// Tells whoever supervises how many frames were begun and completed.
fn beat(app: &mut App, heart: Arc<Heart>) {
    let Some(render) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    let [requested, completed] = [0, 0].map(|count| Arc::new(AtomicU64::new(count)));
    let (asked, done) = (requested.clone(), completed.clone());
    let mut begun = false;
    render.add_systems(
        Render,
        (move |queue: Res<RenderQueue>, device: Res<RenderDevice>| {
            asked.fetch_add(1, Ordering::Relaxed);
            let done = done.clone();
            queue.on_submitted_work_done(move || {
                done.fetch_add(1, Ordering::Relaxed);
            });
            if !std::mem::replace(&mut begun, true) {
                let (device, heart) = (device.clone(), heart.clone());
                let (requested, completed) = (requested.clone(), completed.clone());
                thread::spawn(move || watch(&device, &heart, [&completed, &requested]));
            }
        })
        .after(RenderSystems::Render),
    );
}

/// Until the program ends.
fn watch(device: &RenderDevice, heart: &Heart, [completed, requested]: [&AtomicU64; 2]) {
    let mut last = [0; 2];
    loop {
        // A window that rests asks for nothing, and hears of nothing.
        let _ = device.wgpu_device().poll(PollType::Poll);
        let now = [completed, requested].map(|count| count.load(Ordering::Relaxed));
        if now != last {
            last = now;
            heart.beat(now[0], now[1]);
        }
        thread::sleep(POLL);
    }
}
