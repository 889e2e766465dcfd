//! The house that an installation describes: its displays with one picture over them, its manners, hours
//! and exhibits, and what it says of itself.

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
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
use jiff::Zoned;
use wgpu::PollType;

use super::{
    health::{self, Health},
    heartbeat::{self, Heart},
    journal::{Journal, Level},
    panes::{self, PaneMaterial, PanesPlugin},
    status::Status,
    usage::Usage,
};
use crate::{
    installation::{Contrast, Installation, Pane, Wall},
    manifest::exhibit::Exhibit,
    stage::{
        Shown,
        composite::PictureCamera,
        reload::{self, Reread},
        say,
    },
    visitor::{
        self, Attract, Closed, Due, Manners, ShowError, ShowOptions, StaffWish, Waits,
        controls::{Staff, draw::ProgramWords},
        glass::{self, Glass},
        letters::FontFolder,
    },
    wording::Wordings,
};

/// Between two looks at whether frames were completed.
const POLL: Duration = Duration::from_millis(500);
/// As long as a scene is looked at before it is counted again.
const COUNT: f64 = 10.0;

/// What follows the installation.
#[derive(Resource)]
struct Keeper {
    installation: Installation,
    health: Arc<Health>,
    journal: Journal,
    /// It has a receiver, which is not Sync.
    usage: Mutex<Usage>,
    heart: Option<Arc<Heart>>,
    _status: Option<Status>,
    /// When the program begins anew.
    restart: Option<Zoned>,
    /// Whose turn it is.
    turn: usize,
    /// The staff asked for so many exhibits more, the last of them just now.
    ahead: usize,
    asked: bool,
    /// When it opens or closes next.
    change: Option<Zoned>,
    /// The staff keeps the hours away, until the next change.
    stays: bool,
    was_open: bool,
    was_touring: bool,
    /// Whether the visitor is counted already, and how long the scene has been looked at.
    counted: bool,
    looked: f64,
}

/// Shows the exhibits of `installation` until somebody who may ends it.
///
/// # Errors
/// As [`visitor::show`], where none of its exhibits can be shown.
pub fn show(installation: Installation, options: &ShowOptions) -> Result<u8, ShowError> {
    let health = Arc::new(Health::new());
    let journal = match &installation.logs {
        Some(logs) => Journal::open(&logs.folder, logs.max_bytes, logs.keep, health.clone()),
        None => Journal::off(),
    };
    let usage = match installation.logs.as_ref().filter(|logs| logs.usage_counts) {
        Some(logs) => Usage::open(&logs.folder, health.clone()),
        None => Usage::off(),
    };
    let status = installation.status.and_then(|address| {
        let served = Status::serve(address, health.clone());
        served
            .map_err(|error| {
                journal.write(Level::Error, &error, &[]);
                say(format_args!("recto: {error}"));
            })
            .ok()
    });
    let folder = installation.interface.wording.as_deref();
    let (wordings, warnings) = Wordings::read(folder)?;
    for warning in warnings {
        say(warning);
    }
    let now = now(&installation);
    let turn = installation.exhibits.turn(&now);
    let path = showable(&installation.exhibits.folders, turn)?;
    let manners = manners(&installation, options.manners.clone());
    let options = ShowOptions {
        fullscreen: options.fullscreen && installation.wall.is_none(),
        manners,
        ..options.clone()
    };
    journal.write(
        Level::Info,
        "started",
        &[("version", env!("CARGO_PKG_VERSION").into())],
    );
    let heart = Heart::from_environment().map(Arc::new);
    let keeper = Keeper {
        // Without somebody who begins it anew, it would stay ended.
        restart: heart
            .as_ref()
            .and_then(|_| installation.hours.next_restart(&now)),
        turn,
        ahead: 0,
        asked: false,
        change: installation.hours.next_change(&now),
        stays: false,
        was_open: true,
        was_touring: false,
        counted: false,
        looked: 0.0,
        health,
        journal,
        usage: Mutex::new(usage),
        heart,
        _status: status,
        installation,
    };
    visitor::show_in(&path, &options, |app| furnish(app, keeper, wordings))
}

/// The exhibit whose turn it is, or the next one that can be shown.
///
/// # Errors
/// The faults of the one whose turn it is, where none can.
fn showable(folders: &[PathBuf], turn: usize) -> Result<PathBuf, ShowError> {
    let mut first = None;
    for k in 0..folders.len() {
        let folder = &folders[(turn + k) % folders.len()];
        match Exhibit::read(folder) {
            Ok(_) => return Ok(folder.clone()),
            Err(faults) => {
                say(&faults);
                first = first.or(Some(faults));
            }
        }
    }
    match first {
        Some(faults) => Err(faults.into()),
        None => Ok(PathBuf::from(".")),
    }
}

fn now(installation: &Installation) -> Zoned {
    Zoned::now().with_time_zone(installation.hours.time_zone.clone())
}

/// How the place wants its picture to behave.
fn manners(installation: &Installation, asked: Manners) -> Manners {
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
fn furnish(app: &mut App, keeper: Keeper, wordings: Wordings) {
    let fonts = keeper.installation.interface.fonts.clone();
    app.insert_resource(ProgramWords(wordings))
        .insert_resource(FontFolder(fonts));
    if let Some(wall) = keeper.installation.wall.clone() {
        hang(app, &wall);
    }
    if let Some(heart) = keeper.heart.clone() {
        beat(app, heart);
    }
    app.insert_resource(keeper)
        .add_systems(Update, keep.before(crate::stage::StageSet::Steer));
}

/// One picture over all displays.
fn hang(app: &mut App, wall: &Wall) {
    app.add_plugins(PanesPlugin);
    let size = panes::picture_size(wall);
    let world = app.world_mut();
    let picture = world
        .resource_mut::<Assets<Image>>()
        .add(panes::picture(size));
    let mut windows = world.query_filtered::<Entity, With<PrimaryWindow>>();
    let primary = windows.iter(world).next();
    let mut hung = Vec::new();
    for (k, of) in wall.layout().iter().enumerate() {
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
                let tone = panes::tone(&correction);
                let tone = world.resource_mut::<Assets<Image>>().add(tone);
                let material = PaneMaterial {
                    pane: panes::uniform(pane, &correction),
                    picture: picture.clone(),
                    tone,
                };
                let materials = &mut world.resource_mut::<Assets<PaneMaterial>>();
                (pane.clone(), materials.add(material))
            })
            .collect();
        hung.push((entity, of));
    }
    let glass = Glass {
        size: size.as_vec2(),
        pixels: size,
        width_mm: Some(wall.size_mm().x),
        home: 0,
        panes: hung
            .iter()
            .flat_map(|(window, of)| of.iter().map(|(pane, _)| on_glass(*window, pane, size)))
            .collect(),
    };
    world.insert_resource(glass);
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

fn on_glass(window: Entity, pane: &Pane, size: UVec2) -> glass::Pane {
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

/// Follows the clock, the staff and the visitors.
fn keep(
    time: Res<Time<Real>>,
    (shown, attract): (Res<Shown>, Res<Attract>),
    (mut keeper, mut closed, mut due): (ResMut<Keeper>, ResMut<Closed>, ResMut<Due>),
    mut wishes: MessageReader<StaffWish>,
    mut reread: MessageWriter<Reread>,
    mut exit: MessageWriter<AppExit>,
    mut commands: Commands,
) {
    let keeper = &mut *keeper;
    let now = now(&keeper.installation);
    let seconds = time.delta_secs_f64();
    if seconds < 1.0 {
        keeper.health.frame((seconds * 1e3) as f32);
    }
    let mut end = None;
    for StaffWish(wish) in wishes.read() {
        let said = format!("{wish:?}");
        keeper
            .journal
            .write(Level::Info, "staff", &[("wish", said.into())]);
        match wish {
            Staff::Quit => end = Some(heartbeat::State::End),
            Staff::Restart => end = Some(heartbeat::State::Restart),
            Staff::NextExhibit => (keeper.ahead, keeper.asked) = (keeper.ahead + 1, true),
            Staff::Hours => keeper.stays = true,
            Staff::Back => {}
        }
    }
    if keeper
        .restart
        .as_ref()
        .is_some_and(|restart| *restart <= now)
    {
        end = Some(heartbeat::State::Restart);
    }
    if let Some(state) = end {
        keeper.journal.write(Level::Info, "ends", &[]);
        if let Some(heart) = &keeper.heart {
            heart.leave(state);
        }
        exit.write(AppExit::Success);
        return;
    }
    keeper.open(&now, &mut closed);
    keeper.change_exhibit(
        &now,
        attract.is_touring() || closed.0,
        &mut reread,
        &mut commands,
    );
    keeper.tell(&shown, &attract, closed.0, seconds);
    let next = [keeper.change.clone(), keeper.restart.clone()];
    let next = next.into_iter().flatten().filter_map(|then| {
        let seconds = then.timestamp().as_second() - now.timestamp().as_second();
        u64::try_from(seconds)
            .ok()
            .map(|s| Duration::from_secs(s + 1))
    });
    let turn = keeper.installation.exhibits.until_next(&now);
    due.0 = next.chain(turn).min();
}

impl Keeper {
    /// Dark outside the opening hours.
    fn open(&mut self, now: &Zoned, closed: &mut ResMut<Closed>) {
        let hours = &self.installation.hours;
        if self.change.as_ref().is_some_and(|change| change <= now) {
            self.change = hours.next_change(now);
        }
        let is_open = hours.is_open(now);
        if is_open != self.was_open {
            self.was_open = is_open;
            // Whoever stays open longer does so until it would open again.
            self.stays &= !is_open;
            let said = if is_open { "opens" } else { "closes" };
            self.journal.write(Level::Info, said, &[]);
        }
        closed.set_if_neq(Closed(!is_open && !self.stays));
    }

    /// The next exhibit in its turn, while nobody is there; one that cannot be shown is told of and passed
    /// over.
    fn change_exhibit(
        &mut self,
        now: &Zoned,
        is_empty: bool,
        reread: &mut MessageWriter<Reread>,
        commands: &mut Commands,
    ) {
        let folders = &self.installation.exhibits.folders;
        let turn = (self.installation.exhibits.turn(now) + self.ahead) % folders.len().max(1);
        if turn == self.turn || !(is_empty || self.asked) {
            return;
        }
        (self.turn, self.asked) = (turn, false);
        for k in 0..folders.len() {
            let folder = &folders[(turn + k) % folders.len()];
            match Exhibit::read(folder) {
                Ok((exhibit, _)) => {
                    let said = folder.display().to_string();
                    self.journal
                        .write(Level::Info, "exhibit", &[("folder", said.into())]);
                    let exhibit = Arc::new(exhibit);
                    reread.write(Reread(exhibit.clone()));
                    commands.queue(move |world: &mut World| reload::follow(world, &exhibit));
                    return;
                }
                Err(faults) => {
                    self.journal.write(Level::Error, &faults, &[]);
                    let words = faults.to_string();
                    self.health.update(|about| about.faults = vec![words]);
                    say(faults);
                }
            }
        }
    }

    /// How it is, and what was looked at.
    fn tell(&mut self, shown: &Shown, attract: &Attract, closed: bool, seconds: f64) {
        let touring = attract.is_touring();
        let language = shown.scene.language.clone();
        let language = language.or_else(|| shown.exhibit.languages.first().cloned());
        let language = language.unwrap_or_default();
        let title = shown
            .exhibit
            .text(&shown.exhibit.title, "")
            .unwrap_or_default();
        let folder = shown.exhibit.folder.display().to_string();
        self.health.update(|about| {
            about.state = match (closed, touring) {
                (true, _) => health::State::Closed,
                (_, true) => health::State::Attract,
                _ => health::State::Showing,
            };
            if about.exhibit != title || about.scene != shown.scene.id || about.language != language
            {
                title.clone_into(&mut about.exhibit);
                about.scene.clone_from(&shown.scene.id);
                about.language.clone_from(&language);
                about.folder.clone_from(&folder);
            }
        });
        if touring || closed {
            (self.counted, self.looked) = (false, 0.0);
        } else {
            if !self.counted && self.was_touring {
                self.health.session();
            }
            self.looked += seconds.min(COUNT);
            if self.looked >= COUNT {
                let id = Path::new(&folder).file_name().unwrap_or_default();
                let exhibit = id.to_string_lossy();
                let begins = !self.counted;
                let usage = self.usage.get_mut();
                usage.unwrap_or_else(PoisonError::into_inner).count(
                    &exhibit,
                    &shown.scene.id,
                    &language,
                    begins,
                    self.looked,
                );
                (self.counted, self.looked) = (true, 0.0);
            }
        }
        self.was_touring = touring;
    }
}
