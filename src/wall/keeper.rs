//! Who keeps the house: follows the clock, the staff and the visitors, changes the exhibits, and says how it
//! is.

use std::{
    path::{Path, PathBuf},
    sync::{Arc, Mutex, OnceLock, PoisonError},
    time::Duration,
};

use bevy::{prelude::*, window::RequestRedraw};
use jiff::{Timestamp, Zoned};

use super::{
    health::{self, Health},
    heartbeat::{self, Heart},
    journal::{self, Journal, Level},
    signals::Signal,
    status::Status,
    supervise::BEGUN_ANEW,
    together::{self, Following, Party, Turn},
    usage::Usage,
};
use crate::{
    installation::{Installation, Machine},
    manifest::exhibit::Exhibit,
    stage::{
        Arranged, Shown,
        reload::{self, Reread, Verdict},
        say,
    },
    visitor::{AskAgain, Attract, Closed, ShowError, StaffWish, controls::Staff},
};

/// A new sheet is drawn in its second frame, and a picture is there when the frame after it is asked for.
const DRAWN_AFTER: u32 = 3;
/// As long as a scene is looked at before it is counted again.
const COUNT: f64 = 10.0;

/// Where the house has the time of day from.
#[derive(Clone)]
pub struct Clock(Arc<dyn Fn() -> Timestamp + Send + Sync>);

impl Clock {
    /// What `ask` answers.
    pub fn new(ask: impl Fn() -> Timestamp + Send + Sync + 'static) -> Self {
        Self(Arc::new(ask))
    }
}

/// That of the machine.
impl Default for Clock {
    fn default() -> Self {
        Self::new(Timestamp::now)
    }
}

/// What follows the installation.
#[derive(Resource)]
pub struct Keeper {
    pub installation: Installation,
    /// Which one this is, where several carry the wall.
    pub machine: Option<Machine>,
    clock: Clock,
    health: Arc<Health>,
    journal: Journal,
    /// It has a receiver, which is not Sync.
    usage: Mutex<Usage>,
    pub heart: Option<Arc<Heart>>,
    /// The signal that asked the program to end, once there was one.
    pub leaves: Arc<OnceLock<Signal>>,
    _status: Option<Status>,
    /// When the program begins anew.
    restart: Option<Zoned>,
    /// Whose turn it is.
    turn: usize,
    /// Whose picture is shown, where that one is at fault.
    showing: usize,
    /// The staff asked for so many exhibits more, the last of them just now.
    ahead: usize,
    asked: bool,
    /// Something was on the wall already.
    has_shown: bool,
    /// Frames since everything for the first picture was there.
    settled_frames: u32,
    /// When it opens or closes next.
    change: Option<Zoned>,
    /// The staff keeps the hours away, until the next change.
    stays: bool,
    was_open: bool,
    /// Whether somebody is there, is counted already, and how long they have looked at the scene.
    was_visited: bool,
    counted: bool,
    looked: f64,
}

/// Follows the clock, the staff and the visitors.
pub fn keep(
    time: Res<Time<Real>>,
    (attract, arranged): (Res<Attract>, Res<Arranged>),
    (mut keeper, mut closed, mut due): (ResMut<Keeper>, ResMut<Closed>, ResMut<AskAgain>),
    (following, told): (Option<Res<Following>>, Option<ResMut<Turn>>),
    (mut wishes, mut verdicts): (MessageReader<StaffWish>, MessageReader<Verdict>),
    (mut reread, mut exit, mut redraw): (
        MessageWriter<Reread>,
        MessageWriter<AppExit>,
        MessageWriter<RequestRedraw>,
    ),
    mut commands: Commands,
) {
    let keeper = &mut *keeper;
    let now = keeper.now();
    let seconds = time.delta_secs_f64();
    if seconds < 1.0 {
        keeper.health.frame((seconds * 1e3) as f32);
    }
    if let Some(signal) = keeper.leaves.get() {
        let signal = signal.to_string();
        keeper
            .journal
            .write(Level::Info, "ends", &[("signal", signal.into())]);
        exit.write(AppExit::Success);
        return;
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
            // Between the staff and the displays.
            Staff::Chart | Staff::Back => {}
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
    if !keeper.has_shown && arranged.is_settled() {
        keeper.settled_frames += 1;
        if keeper.settled_frames > DRAWN_AFTER {
            keeper.has_shown = true;
            if let Some(heart) = &keeper.heart {
                heart.shows();
            }
        }
        redraw.write(RequestRedraw);
    }
    for Verdict(verdict) in verdicts.read() {
        keeper.hear(verdict);
    }
    let led = following.as_ref().and_then(|following| following.is_dark());
    keeper.open(&now, led, &mut closed);
    // A machine that follows shows what the one that leads does.
    if following.is_none() {
        let is_empty = !attract.is_visited() || closed.0;
        keeper.change_exhibit(&now, is_empty, &mut reread, &mut commands);
        if let Some(mut told) = told {
            told.set_if_neq(Turn(keeper.showing()));
        }
    }
    let next = [keeper.change.clone(), keeper.restart.clone()];
    let next = next.into_iter().flatten().filter_map(|then| {
        let seconds = then.timestamp().as_second() - now.timestamp().as_second();
        u64::try_from(seconds)
            .ok()
            .map(|s| Duration::from_secs(s + 1))
    });
    let turn = keeper.installation.exhibits.until_next(&now);
    let again = following.and_then(|following| following.due());
    due.0 = next.chain(turn).chain(again).min();
}

/// Says how it is once the frame's touches were followed: a picture that rests is told of no more.
pub fn tell(
    time: Res<Time<Real>>,
    (shown, attract, closed): (Res<Shown>, Res<Attract>, Res<Closed>),
    mut keeper: ResMut<Keeper>,
) {
    keeper.tell(&shown, &attract, closed.0, time.delta_secs_f64());
}

impl Keeper {
    /// Opens the logs, the counts and the status page; what cannot be opened is told of, and gone without.
    pub fn new(installation: Installation, clock: Clock) -> Self {
        let health = Arc::new(Health::new());
        let journal = match &installation.logs {
            Some(logs) => Journal::open(&logs.folder, logs.max_bytes, logs.keep, health.clone()),
            None => Journal::off(),
        };
        if let Some(logs) = &installation.logs
            && let Err(error) = journal::can_write(&logs.folder)
        {
            say(format_args!(
                "recto: {}: logs cannot be written ({error}); make the folder writable for this user, or name \
                 another one as folder of [logs]",
                logs.folder.display()
            ));
        }
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
        let version = ("version", env!("CARGO_PKG_VERSION").into());
        match std::env::var(BEGUN_ANEW) {
            Ok(words) => journal.write(
                Level::Warning,
                "started anew",
                &[version, ("the last one", words.into())],
            ),
            Err(_) => journal.write(Level::Info, "started", &[version]),
        }
        let heart = Heart::from_environment().map(Arc::new);
        let now = (clock.0)().to_zoned(installation.hours.time_zone.clone());
        Self {
            // Without somebody who begins it anew, it would stay ended.
            restart: heart
                .as_ref()
                .and_then(|_| installation.hours.next_restart(&now)),
            turn: installation.exhibits.turn(&now),
            showing: installation.exhibits.turn(&now),
            machine: None,
            ahead: 0,
            asked: false,
            has_shown: false,
            settled_frames: 0,
            change: installation.hours.next_change(&now),
            stays: false,
            was_open: true,
            was_visited: false,
            counted: false,
            looked: 0.0,
            health,
            journal,
            usage: Mutex::new(usage),
            heart,
            leaves: Arc::default(),
            _status: status,
            clock,
            installation,
        }
    }

    /// Tells the log and whoever started the program.
    pub fn note(&self, level: Level, words: &str) {
        self.journal.write(level, words, &[]);
        say(format_args!("recto: {words}"));
    }

    fn now(&self) -> Zoned {
        (self.clock.0)().to_zoned(self.installation.hours.time_zone.clone())
    }

    /// The exhibit whose turn it is, or the next one that can be shown.
    ///
    /// # Errors
    /// The faults of the one whose turn it is, where none can.
    pub fn showable(&mut self) -> Result<PathBuf, ShowError> {
        let folders = &self.installation.exhibits.folders;
        let mut first = None;
        for k in 0..folders.len() {
            let showing = (self.turn + k) % folders.len();
            let folder = &folders[showing];
            match Exhibit::read(folder) {
                Ok(_) => {
                    self.showing = showing;
                    return Ok(folder.clone());
                }
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

    /// The place of the exhibit that is shown among those of the installation.
    pub fn showing(&self) -> usize {
        self.showing
    }

    /// What makes it one of several, where it is.
    pub fn party(&self) -> Option<Party> {
        Some(Party {
            machine: self.machine.clone()?,
            wall: together::wall_print(&self.installation),
            folders: self.installation.exhibits.folders.clone(),
            journal: self.journal.clone(),
            health: self.health.clone(),
        })
    }

    /// Dark outside the opening hours, or as the machine that leads says, while it is heard.
    fn open(&mut self, now: &Zoned, led: Option<bool>, closed: &mut ResMut<Closed>) {
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
        closed.set_if_neq(Closed(led.unwrap_or(!is_open && !self.stays)));
    }

    /// Files were found sound or faulty.
    fn hear(&mut self, verdict: &Result<(), String>) {
        let faults = match verdict {
            Ok(()) => Vec::new(),
            Err(words) => {
                self.journal.write(Level::Error, words, &[]);
                // With nothing on the wall yet, the next one is better than none; each is tried once.
                let others = self.installation.exhibits.folders.len().saturating_sub(1);
                if !self.has_shown && self.ahead < others {
                    (self.ahead, self.asked) = (self.ahead + 1, true);
                }
                vec![words.clone()]
            }
        };
        self.health.update(|about| about.faults = faults);
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
            let showing = (turn + k) % folders.len();
            let folder = &folders[showing];
            match Exhibit::read(folder) {
                Ok((exhibit, _)) => {
                    self.showing = showing;
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
        let has_shown = self.has_shown;
        self.health.update(|about| {
            about.state = match (closed, touring) {
                _ if !about.faults.is_empty() => health::State::Faulty,
                _ if !has_shown => health::State::Starting,
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
        let visited = attract.is_visited() && !closed;
        if visited && !self.was_visited {
            self.health.session();
        }
        if !visited {
            (self.counted, self.looked) = (false, 0.0);
        } else {
            // The longest a picture rests between two frames of somebody who looks.
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
        self.was_visited = visited;
    }
}
