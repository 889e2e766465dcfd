//! Looks after a window: begins it anew when it crashes, hangs or ends without being asked to.
//!
//! The window says what it does by its [heartbeat](super::heartbeat). It is taken to hang if the
//! heartbeat falls silent, or if a frame was begun and none was completed for a while, which is
//! what a renderer that hangs looks like from outside. What it ends with decides what follows:
//!
//! | end | then |
//! |---|---|
//! | code 0, heartbeat says `end` | it stays ended: staff asked for it |
//! | code 0, heartbeat says `restart` | it begins anew at once, as every night |
//! | code 2 before any frame ever | it stays ended: no restart heals wrong usage |
//! | anything else | it begins anew after 1 s, 2 s, 4 s … 60 s; after ten quiet minutes, from 1 s |
//! | SIGTERM, SIGINT or SIGHUP to the supervisor | it is passed on, and both end |

use std::{
    ffi::OsString,
    fmt::{self, Display},
    fs, io,
    path::{Path, PathBuf},
    process::{Child, Command, ExitStatus},
    sync::mpsc::{Receiver, RecvTimeoutError},
    time::{Duration, Instant},
};

use sd_notify::NotifyState;

use super::{
    heartbeat::{Beat, HEARTBEAT, State},
    signals::{self, Signal},
};

/// How often the child is looked at.
const LOOK: Duration = Duration::from_millis(100);
/// How long a child that was asked to end may take.
const GRACE: Duration = Duration::from_secs(5);
/// The longest wait between two starts.
const LONGEST_WAIT: Duration = Duration::from_secs(60);
/// A child that ran so long starts the waits anew.
const QUIET: Duration = Duration::from_secs(600);
/// The code of wrong usage.
const USAGE: i32 = 2;
/// The environment variable that tells a window why it was begun anew, for its log.
pub const BEGUN_ANEW: &str = "RECTO_BEGUN_ANEW";
/// What systemd tells its services, of which the window is none.
const OF_SYSTEMD: [&str; 3] = ["NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"];

/// How long what may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// From the start to the first completed frame.
    pub start: Duration,
    /// Between two heartbeats: an idle wall draws a frame a minute.
    pub idle: Duration,
    /// From a frame's beginning to the next completed one.
    pub hang: Duration,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            start: Duration::from_secs(180),
            idle: Duration::from_secs(90),
            hang: Duration::from_secs(10),
        }
    }
}

/// How a child is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Health {
    /// No frame yet.
    Starting,
    Well,
    /// No first frame for so long.
    NeverStarted(Duration),
    /// No heartbeat for so long.
    Silent(Duration),
    /// A frame was begun so long ago, and none was completed since.
    Behind(Duration),
}

impl Health {
    /// How long it has been ill.
    fn ill_for(self) -> Option<Duration> {
        match self {
            Self::Starting | Self::Well => None,
            Self::NeverStarted(time) | Self::Silent(time) | Self::Behind(time) => Some(time),
        }
    }
}

/// Judges a child by its heartbeat.
#[derive(Clone, Debug)]
pub struct Watch {
    limits: Limits,
    started: Instant,
    /// The last line, and when it was new.
    last: Option<(Beat, Instant)>,
    /// Since when more frames are begun than completed, at this number of completed ones.
    behind: Option<(u64, Instant)>,
    first_frame: Option<Instant>,
    first_picture: Option<Instant>,
}

impl Watch {
    /// Of a child that was started at `now`.
    pub fn new(limits: Limits, now: Instant) -> Self {
        Self {
            limits,
            started: now,
            last: None,
            behind: None,
            first_frame: None,
            first_picture: None,
        }
    }

    /// Judges what the heartbeat's file says at `now`.
    pub fn look(&mut self, now: Instant, beat: Option<Beat>) -> Health {
        if let Some(beat) = beat
            && self.last.is_none_or(|(last, _)| last != beat)
        {
            self.last = Some((beat, now));
        }
        let Some((beat, changed)) = self.last.filter(|(beat, _)| beat.completed > 0) else {
            let time = now - self.started;
            return match time > self.limits.start {
                true => Health::NeverStarted(time),
                false => Health::Starting,
            };
        };
        self.first_frame.get_or_insert(now);
        if beat.state != State::Starting {
            self.first_picture.get_or_insert(now);
        }
        if beat.requested <= beat.completed {
            self.behind = None;
        } else if self.behind.is_none_or(|(at, _)| at != beat.completed) {
            self.behind = Some((beat.completed, now));
        }
        if let Some((_, since)) = self.behind
            && now - since > self.limits.hang
        {
            return Health::Behind(now - since);
        }
        match now - changed > self.limits.idle {
            true => Health::Silent(now - changed),
            false => Health::Well,
        }
    }

    /// When the first frame was complete.
    pub fn first_frame(&self) -> Option<Instant> {
        self.first_frame
    }

    /// When the first picture was there, with all that belongs to it.
    pub fn first_picture(&self) -> Option<Instant> {
        self.first_picture
    }
}

/// How long to wait before the next start, after so many failures in a row (from 1).
pub fn wait_after(failures: u32) -> Duration {
    let doublings = failures.saturating_sub(1).min(6);
    LONGEST_WAIT.min(Duration::from_secs(1 << doublings))
}

/// What is looked after, and how.
#[derive(Clone, Debug)]
pub struct Supervised {
    pub program: PathBuf,
    pub arguments: Vec<OsString>,
    pub limits: Limits,
}

/// How it came to stay ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// Staff asked the window for it, or a signal the supervisor.
    Asked,
    /// Its arguments are wrong, which it has said.
    WrongUsage,
}

/// Starts it and looks after it until it is to stay ended. `say` writes one line of the log.
///
/// # Errors
/// If there is nowhere for its heartbeat, or signals cannot be taken.
pub fn supervise(supervised: &Supervised, say: &mut dyn FnMut(&str)) -> io::Result<Ended> {
    // Before any thread is started: all of them leave signals to one.
    let signals = signals::taken()?;
    let folder = heartbeat_folder()?;
    let mut supervisor = Supervisor {
        supervised,
        heartbeat: folder.path().join("heartbeat"),
        signals,
        say,
        restarts: 0,
        down: None,
        ever_shown: false,
        watchdog: sd_notify::watchdog_enabled().map(|limit| limit / 3),
        last_ping: Instant::now(),
    };
    let ended = supervisor.run();
    notify(&[NotifyState::Stopping]);
    Ok(ended)
}

/// In memory where there is such a folder: a full disk leaves it alone.
fn heartbeat_folder() -> io::Result<tempfile::TempDir> {
    let mut builder = tempfile::Builder::new();
    builder.prefix("recto-supervise-");
    let in_memory = std::env::var_os("XDG_RUNTIME_DIR").map(PathBuf::from);
    in_memory
        .filter(|folder| folder.is_dir())
        .and_then(|folder| builder.tempdir_in(folder).ok())
        .map_or_else(|| builder.tempdir(), Ok)
}

/// Where there is no systemd nobody listens, and that is fine.
fn notify(states: &[NotifyState<'_>]) {
    let _ = sd_notify::notify(states);
}

/// Why a child has to begin anew.
struct Failure {
    words: String,
    /// Since when there was no picture to trust.
    down_since: Instant,
}

/// What became of a child.
enum Outcome {
    Failed(Failure),
    /// It wants to begin anew.
    Restart(Instant),
    Stay(Ended),
}

struct Supervisor<'s> {
    supervised: &'s Supervised,
    heartbeat: PathBuf,
    signals: Receiver<Signal>,
    say: &'s mut dyn FnMut(&str),
    restarts: u32,
    /// Since when there is no picture to trust, after one was lost.
    down: Option<Instant>,
    /// Whether any child completed a frame.
    ever_shown: bool,
    /// How often systemd is told that this is running.
    watchdog: Option<Duration>,
    last_ping: Instant,
}

impl Supervisor<'_> {
    fn run(&mut self) -> Ended {
        let mut failures = 0;
        let mut last_end = None;
        loop {
            let started = Instant::now();
            let outcome = match self.start(last_end.as_deref()) {
                Ok(child) => self.look_after(child),
                Err(error) => Outcome::Failed(Failure {
                    words: format!(
                        "{} cannot be started: {error}",
                        self.supervised.program.display()
                    ),
                    down_since: started,
                }),
            };
            let (words, since, wait) = match outcome {
                Outcome::Stay(ended) => return ended,
                Outcome::Restart(since) => {
                    failures = 0;
                    ("ended to begin anew".to_owned(), since, Duration::ZERO)
                }
                Outcome::Failed(Failure { words, down_since }) => {
                    if started.elapsed() >= QUIET {
                        failures = 0;
                    }
                    failures += 1;
                    (words, down_since, wait_after(failures))
                }
            };
            // Of several failures in a row, the picture is gone since the first.
            self.down.get_or_insert(since);
            self.restarts += 1;
            let ran = Span(started.elapsed());
            let next = match wait.is_zero() {
                true => "again at once".to_owned(),
                false => format!("again in {} s", wait.as_secs()),
            };
            self.log(&format!("{words} after {ran}; {next}"));
            last_end = Some(format!("{words} after {ran}"));
            let status = format!("{} restarts, the last as it {words}", self.restarts);
            notify(&[NotifyState::Status(&status)]);
            if self.pause(wait).is_some() {
                return Ended::Asked;
            }
        }
    }

    fn log(&mut self, words: &str) {
        (self.say)(&format!("recto supervise: {words}"));
    }

    fn start(&self, last_end: Option<&str>) -> io::Result<Child> {
        match fs::remove_file(&self.heartbeat) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
        let mut command = Command::new(&self.supervised.program);
        command
            .args(&self.supervised.arguments)
            .env(HEARTBEAT, &self.heartbeat);
        if let Some(words) = last_end {
            command.env(BEGUN_ANEW, words);
        }
        for name in OF_SYSTEMD {
            command.env_remove(name);
        }
        command.spawn()
    }

    /// Until the child has ended, whoever ended it.
    fn look_after(&mut self, mut child: Child) -> Outcome {
        let mut watch = Watch::new(self.supervised.limits, Instant::now());
        let (mut draws, mut shown) = (false, false);
        let mut doubted = false;
        loop {
            if let Some(signal) = self.pause(LOOK) {
                self.log(&format!("ends, as {signal} asks for it"));
                signals::pass_on(&mut child, signal);
                end(&mut child);
                return Outcome::Stay(Ended::Asked);
            }
            let beat = Beat::read(&self.heartbeat);
            let health = watch.look(Instant::now(), beat);
            if !draws && watch.first_frame().is_some() {
                draws = true;
                self.ever_shown = true;
                notify(&[NotifyState::Ready]);
            }
            if let (false, Some(first)) = (shown, watch.first_picture()) {
                shown = true;
                self.is_back(first);
            }
            match child.try_wait() {
                Ok(None) => {}
                Ok(Some(status)) => {
                    // It may have written its last word just before.
                    let state = Beat::read(&self.heartbeat).map(|beat| beat.state);
                    return self.ended(status, state.unwrap_or_default());
                }
                Err(error) => {
                    let words = format!("could not be waited for ({error})");
                    end(&mut child);
                    return failed(words, Instant::now());
                }
            }
            let Some(ill_for) = health.ill_for() else {
                doubted = false;
                continue;
            };
            if !can_write(&self.heartbeat) {
                // Then silence says nothing about the child.
                if !doubted {
                    self.log("cannot tell whether the window is well: the disk is full");
                }
                doubted = true;
                continue;
            }
            end(&mut child);
            let words = match health {
                Health::NeverStarted(time) => format!("had no first frame within {}", Span(time)),
                Health::Behind(time) => format!("hung: no frame was completed for {}", Span(time)),
                _ => format!("hung: no sign of it for {}", Span(ill_for)),
            };
            let now = Instant::now();
            return failed(words, now.checked_sub(ill_for).unwrap_or(now));
        }
    }

    /// The first picture of a child is there.
    fn is_back(&mut self, first: Instant) {
        let status = match self.restarts {
            0 => "shows its picture".to_owned(),
            1 => "shows its picture, after 1 restart".to_owned(),
            restarts => format!("shows its picture, after {restarts} restarts"),
        };
        if let Some(down) = self.down.take() {
            let without = first.saturating_duration_since(down);
            self.log(&format!("back, after {} without a picture", Span(without)));
        }
        notify(&[NotifyState::Status(&status)]);
    }

    fn ended(&mut self, status: ExitStatus, state: State) -> Outcome {
        let now = Instant::now();
        match (status.code(), state) {
            (Some(0), State::End) => {
                self.log("ended, as staff asked for it");
                Outcome::Stay(Ended::Asked)
            }
            (Some(0), State::Restart) => Outcome::Restart(now),
            (Some(0), State::Starting | State::Running) => {
                failed("ended, and nobody asked for it".to_owned(), now)
            }
            (Some(USAGE), _) if !self.ever_shown => Outcome::Stay(Ended::WrongUsage),
            (Some(code), _) => failed(format!("ended with code {code}"), now),
            (None, _) => failed(format!("crashed ({status})"), now),
        }
    }

    /// Waits, and tells systemd meanwhile that this is running; a signal ends it early.
    fn pause(&mut self, time: Duration) -> Option<Signal> {
        let until = Instant::now() + time;
        loop {
            if let Some(every) = self.watchdog
                && self.last_ping.elapsed() >= every
            {
                notify(&[NotifyState::Watchdog]);
                self.last_ping = Instant::now();
            }
            let left = until.saturating_duration_since(Instant::now());
            match self.signals.recv_timeout(left.min(LOOK)) {
                Ok(signal) => return Some(signal),
                Err(RecvTimeoutError::Timeout) if left <= LOOK => return None,
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    // Where there are no signals.
                    std::thread::sleep(left.min(LOOK));
                    if left <= LOOK {
                        return None;
                    }
                }
            }
        }
    }
}

fn failed(words: String, down_since: Instant) -> Outcome {
    Outcome::Failed(Failure { words, down_since })
}

/// Whether a file can be written beside the heartbeat.
fn can_write(heartbeat: &Path) -> bool {
    let file = heartbeat.with_extension("probe");
    let written = fs::write(&file, [b'.'; 256]).is_ok();
    let _ = fs::remove_file(&file);
    written
}

/// Asks a child to end, and ends it if it does not.
fn end(child: &mut Child) {
    signals::pass_on(child, Signal::Terminate);
    let asked = Instant::now();
    while asked.elapsed() < GRACE {
        match child.try_wait() {
            Ok(Some(_)) => return,
            Ok(None) => std::thread::sleep(LOOK / 4),
            Err(_) => break,
        }
    }
    // Of one that has just ended there is nothing to end.
    let _ = child.kill();
    let _ = child.wait();
}

/// A time as people say it.
struct Span(Duration);

impl Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = self.0.as_secs();
        match seconds {
            0..60 => write!(f, "{:.1} s", self.0.as_secs_f64()),
            60..3600 => write!(f, "{} min {} s", seconds / 60, seconds % 60),
            3600..86_400 => write!(f, "{} h {} min", seconds / 3600, seconds / 60 % 60),
            _ => write!(f, "{} d {} h", seconds / 86_400, seconds / 3600 % 24),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    fn beat(completed: u64, requested: u64, unix_ms: u64) -> Option<Beat> {
        Some(Beat {
            completed,
            requested,
            unix_ms,
            state: State::Running,
        })
    }

    fn watch() -> (Watch, Instant) {
        let start = Instant::now();
        (Watch::new(Limits::default(), start), start)
    }

    #[test]
    fn an_idle_wall_is_well_and_a_silent_one_is_not() {
        let (mut watch, start) = watch();
        let mut now = start;
        for minute in 0..10 {
            let frame = beat(minute + 1, minute + 1, minute);
            for _ in 0..600 {
                now += SECOND / 10;
                assert_eq!(watch.look(now, frame), Health::Well);
            }
        }
        for _ in 0..29 {
            now += SECOND;
            assert_eq!(watch.look(now, beat(10, 10, 9)), Health::Well);
        }
        now += 2 * SECOND;
        assert!(matches!(
            watch.look(now, beat(10, 10, 9)),
            Health::Silent(_)
        ));
        // A file that was removed is as silent.
        assert!(matches!(watch.look(now, None), Health::Silent(_)));
    }

    #[test]
    fn a_renderer_that_hangs_is_told_from_one_that_works() {
        let (mut watch, start) = watch();
        let mut now = start;
        // One frame is always under way.
        for frame in 1..1000 {
            now += SECOND / 10;
            assert_eq!(watch.look(now, beat(frame, frame + 1, frame)), Health::Well);
        }
        // An idle minute, and then a frame that takes nine seconds.
        now += SECOND;
        watch.look(now, beat(1000, 1000, 1000));
        now += 59 * SECOND;
        assert_eq!(watch.look(now, beat(1000, 1001, 1001)), Health::Well);
        now += 9 * SECOND;
        assert_eq!(watch.look(now, beat(1000, 1001, 1001)), Health::Well);
        assert_eq!(watch.look(now, beat(1001, 1001, 1002)), Health::Well);
        // One that is never completed, though more are asked for.
        for more in 0..10 {
            assert_eq!(
                watch.look(now, beat(1001, 1002 + more, 1003 + more)),
                Health::Well
            );
            now += SECOND;
        }
        now += SECOND / 10;
        let hangs = watch.look(now, beat(1001, 1013, 1013));
        assert!(matches!(hangs, Health::Behind(_)), "{hangs:?}");
    }

    #[test]
    fn a_first_frame_may_take_long_and_not_for_ever() {
        let (mut watch, start) = watch();
        let mut now = start;
        for second in 0..180 {
            now += SECOND;
            // Frames are begun while maps are loaded, and none is complete.
            assert_eq!(watch.look(now, beat(0, second, second)), Health::Starting);
        }
        now += SECOND;
        assert!(matches!(watch.look(now, None), Health::NeverStarted(_)));
        assert_eq!(watch.look(now, beat(1, 1, 1)), Health::Well);
        assert_eq!(watch.first_frame(), Some(now));
    }

    #[test]
    fn a_clock_that_is_set_does_no_harm() {
        let (mut watch, start) = watch();
        assert_eq!(watch.look(start, beat(1, 1, 9_000_000)), Health::Well);
        let later = start + 60 * SECOND;
        assert_eq!(watch.look(later, beat(2, 2, 5)), Health::Well);
        assert_eq!(watch.look(later + 60 * SECOND, beat(2, 2, 5)), Health::Well);
    }

    #[test]
    fn waits_double_up_to_a_minute() {
        let seconds: Vec<u64> = (1..=9).map(|n| wait_after(n).as_secs()).collect();
        assert_eq!(seconds, [1, 2, 4, 8, 16, 32, 60, 60, 60]);
        assert_eq!(wait_after(u32::MAX), LONGEST_WAIT);
    }

    #[test]
    fn times_are_said_as_people_say_them() {
        for (seconds, words) in [
            (0.25, "0.2 s"),
            (61.0, "1 min 1 s"),
            (7260.0, "2 h 1 min"),
            (90_000.0, "1 d 1 h"),
        ] {
            assert_eq!(Span(Duration::from_secs_f64(seconds)).to_string(), words);
        }
    }
}
