//! How the wall is: written by whoever knows, read by whoever asks, from any thread.

use std::{
    collections::VecDeque,
    fmt, fs,
    path::Path,
    sync::{
        Mutex, MutexGuard, OnceLock, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use jiff::{Timestamp, Zoned, civil::Date};
use serde::Serialize;

use super::together::Standing;

/// Frame times are kept for so long.
const WINDOW: Duration = Duration::from_secs(60);
/// And no more of them: a minute at 240 Hz.
const MOST_FRAMES: usize = 14_400;
/// More faults than these are not repeated; the terminal and the log have them all.
const MOST_FAULTS: usize = 100;

/// What the wall does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    #[default]
    Starting,
    /// An exhibit, to visitors.
    Showing,
    /// The tour, to nobody.
    Attract,
    /// Nothing, outside the opening hours.
    Closed,
    /// The last good exhibit, or none, as what was to be shown is at fault.
    Faulty,
}

impl State {
    /// As in JSON.
    pub fn word(self) -> &'static str {
        match self {
            Self::Starting => "starting",
            Self::Showing => "showing",
            Self::Attract => "attract",
            Self::Closed => "closed",
            Self::Faulty => "faulty",
        }
    }
}

/// What is shown.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct About {
    pub state: State,
    /// The exhibit's title.
    pub exhibit: String,
    /// The exhibit's folder.
    pub folder: String,
    /// The scene's id.
    pub scene: String,
    /// Its language, a tag.
    pub language: String,
    /// What is wrong with the installation and the exhibit, in words.
    pub faults: Vec<String>,
}

/// Milliseconds of the frames of the last minute; all 0 where there were none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FrameTimes {
    pub median_ms: f32,
    /// Of 20 frames, 19 took no longer.
    pub p95_ms: f32,
    pub worst_ms: f32,
    pub frames_in_last_minute: usize,
}

/// Everything that is known at one moment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    pub version: &'static str,
    pub now: String,
    pub started: String,
    pub uptime_s: u64,
    #[serde(flatten)]
    pub about: About,
    #[serde(flatten)]
    pub frame_times: FrameTimes,
    pub frames_completed: u64,
    /// Resident memory; `None` where the system does not say.
    pub memory_bytes: Option<u64>,
    /// The hottest part of the machine; `None` where the system does not say.
    pub temperature_c: Option<f64>,
    pub sessions_today: u64,
    /// Lines and counts that could not be written down.
    pub lines_lost: u64,
    /// Where several machines carry the wall.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub machines: Option<Standing>,
}

/// How the wall is. Shared by an `Arc`; no caller waits for another longer than it takes to copy a few
/// words.
#[derive(Debug)]
pub struct Health {
    started: (Instant, Timestamp),
    frames_completed: AtomicU64,
    lines_lost: AtomicU64,
    inner: Mutex<Inner>,
    machines: Machines,
}

/// Whoever knows how it is with other machines.
#[derive(Default)]
struct Machines(OnceLock<Box<dyn Fn() -> Option<Standing> + Send + Sync>>);

impl fmt::Debug for Machines {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Machines").finish_non_exhaustive()
    }
}

#[derive(Debug, Default)]
struct Inner {
    about: About,
    frames: VecDeque<(Instant, f32)>,
    sessions: (Option<Date>, u64),
}

impl Default for Health {
    fn default() -> Self {
        Self::new()
    }
}

impl Health {
    /// Of a program that starts now.
    pub fn new() -> Self {
        Self {
            started: (Instant::now(), Timestamp::now()),
            frames_completed: AtomicU64::new(0),
            lines_lost: AtomicU64::new(0),
            inner: Mutex::default(),
            machines: Machines::default(),
        }
    }

    /// From now on `asked` says how it is with other machines, whenever somebody wants to know.
    pub fn ask_machines(&self, asked: impl Fn() -> Option<Standing> + Send + Sync + 'static) {
        // There is one wall, and whoever came first stays.
        let _ = self.machines.0.set(Box::new(asked));
    }

    /// A frame was completed in so many milliseconds.
    pub fn frame(&self, ms: f32) {
        self.frame_at(Instant::now(), ms);
    }

    fn frame_at(&self, now: Instant, ms: f32) {
        self.frames_completed.fetch_add(1, Ordering::Relaxed);
        if !ms.is_finite() {
            return;
        }
        let frames = &mut self.inner().frames;
        frames.push_back((now, ms));
        if frames.len() > MOST_FRAMES {
            frames.pop_front();
        }
    }

    /// How many frames were completed since the start.
    pub fn frames_completed(&self) -> u64 {
        self.frames_completed.load(Ordering::Relaxed)
    }

    /// Changes what is known about what is shown.
    pub fn update(&self, change: impl FnOnce(&mut About)) {
        change(&mut self.inner().about);
    }

    /// A visitor, or several, began.
    pub fn session(&self) {
        self.session_on(Zoned::now().date());
    }

    /// As [`Self::session`], on a day of an injected clock.
    pub fn session_on(&self, day: Date) {
        let sessions = &mut self.inner().sessions;
        if sessions.0 != Some(day) {
            *sessions = (Some(day), 0);
        }
        sessions.1 += 1;
    }

    /// Something could not be written down.
    pub fn lines_lost(&self, how_many: u64) {
        self.lines_lost.fetch_add(how_many, Ordering::Relaxed);
    }

    /// Everything that is known now.
    pub fn report(&self) -> Report {
        self.report_at(Instant::now(), Zoned::now().date())
    }

    fn report_at(&self, now: Instant, today: Date) -> Report {
        let (about, mut times, sessions_today) = {
            let mut inner = self.inner();
            while let Some((then, _)) = inner.frames.front()
                && now.saturating_duration_since(*then) > WINDOW
            {
                inner.frames.pop_front();
            }
            let times: Vec<f32> = inner.frames.iter().map(|(_, ms)| *ms).collect();
            let sessions = match inner.sessions {
                (Some(day), sessions) if day == today => sessions,
                _ => 0,
            };
            (inner.about.clone(), times, sessions)
        };
        let mut about = about;
        let machines = self.machines.0.get().and_then(|asked| asked());
        let missed = machines.iter().flat_map(|standing| &standing.faults);
        about.faults.extend(missed.cloned());
        about.faults.truncate(MOST_FAULTS);
        Report {
            version: env!("CARGO_PKG_VERSION"),
            now: Timestamp::now().strftime("%FT%TZ").to_string(),
            started: self.started.1.strftime("%FT%TZ").to_string(),
            uptime_s: self.started.0.elapsed().as_secs(),
            about,
            frame_times: frame_times(&mut times),
            frames_completed: self.frames_completed(),
            memory_bytes: memory_bytes(),
            temperature_c: temperature_c(Path::new("/sys/class/thermal")),
            sessions_today,
            lines_lost: self.lines_lost.load(Ordering::Relaxed),
            machines,
        }
    }

    /// Whoever panicked while holding it has left it whole: each change is a single assignment.
    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn frame_times(times: &mut [f32]) -> FrameTimes {
    times.sort_by(f32::total_cmp);
    // Of n sorted times the least that a share of them do not exceed.
    let at = |share: f64| {
        let rank = (times.len() as f64 * share).ceil() as usize;
        times.get(rank.saturating_sub(1)).copied().unwrap_or(0.0)
    };
    FrameTimes {
        median_ms: at(0.5),
        p95_ms: at(0.95),
        worst_ms: at(1.0),
        frames_in_last_minute: times.len(),
    }
}

/// What the process holds in memory, as Linux says.
fn memory_bytes() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}

/// The hottest of the zones that Linux knows.
fn temperature_c(zones: &Path) -> Option<f64> {
    let of = |zone: fs::DirEntry| {
        let text = fs::read_to_string(zone.path().join("temp")).ok()?;
        let thousandths: f64 = text.trim().parse().ok()?;
        Some(thousandths / 1000.0)
    };
    let temperatures = fs::read_dir(zones).ok()?.flatten().filter_map(of);
    temperatures.max_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_times_are_those_of_the_last_minute() {
        let health = Health::new();
        let start = Instant::now();
        let at = |s: u64| start + Duration::from_secs(s);
        health.frame_at(at(0), 500.0);
        for ms in 1..=100 {
            health.frame_at(at(30), ms as f32);
        }
        health.frame_at(at(30), f32::NAN);
        let today = Zoned::now().date();
        let report = health.report_at(at(60), today);
        assert_eq!(report.frame_times.worst_ms, 500.0);
        let report = health.report_at(at(61), today);
        let expected = FrameTimes {
            median_ms: 50.0,
            p95_ms: 95.0,
            worst_ms: 100.0,
            frames_in_last_minute: 100,
        };
        assert_eq!(report.frame_times, expected);
        assert_eq!(report.frames_completed, 102);
        assert_eq!(
            health.report_at(at(200), today).frame_times,
            FrameTimes::default()
        );
    }

    #[test]
    fn frames_do_not_fill_the_memory() {
        let health = Health::new();
        for _ in 0..3 * MOST_FRAMES {
            health.frame(1.0);
        }
        assert_eq!(
            health.report().frame_times.frames_in_last_minute,
            MOST_FRAMES
        );
        assert_eq!(health.frames_completed(), 3 * MOST_FRAMES as u64);
    }

    #[test]
    fn sessions_are_counted_by_day() {
        let health = Health::new();
        let (monday, tuesday) = (
            jiff::civil::date(2026, 11, 23),
            jiff::civil::date(2026, 11, 24),
        );
        health.session_on(monday);
        health.session_on(monday);
        assert_eq!(health.report_at(Instant::now(), monday).sessions_today, 2);
        assert_eq!(health.report_at(Instant::now(), tuesday).sessions_today, 0);
        health.session_on(tuesday);
        assert_eq!(health.report_at(Instant::now(), tuesday).sessions_today, 1);
    }

    #[test]
    fn the_hottest_zone_counts_and_none_is_none() {
        let zones = tempfile::tempdir().expect("a folder");
        assert_eq!(temperature_c(zones.path()), None);
        for (zone, text) in [
            ("a", "41500\n"),
            ("b", "63000\n"),
            ("c", "broken"),
            ("d", "-5000"),
        ] {
            fs::create_dir(zones.path().join(zone)).expect("a folder");
            fs::write(zones.path().join(zone).join("temp"), text).expect("a file");
        }
        assert_eq!(temperature_c(zones.path()), Some(63.0));
        assert_eq!(temperature_c(Path::new("/nowhere")), None);
        if cfg!(target_os = "linux") {
            assert!(memory_bytes().is_some_and(|bytes| bytes > 1 << 18));
        }
    }
}
