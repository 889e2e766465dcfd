//! What a window says of itself: how many frames it was asked for and how many it completed.
//!
//! A file of one line, written whole by renaming:
//!
//! ```text
//! recto 1 completed=5021 requested=5022 unix_ms=1795677301123 state=running
//! ```
//!
//! `completed` and `requested` count frames since the program began, `unix_ms` is when that was
//! true, for people; whoever judges goes by when the line *changed*, so that a clock that is set
//! does no harm. `state` is `starting` until there is a picture, then `running`, or how a program that is about to end wants that taken:
//! `end` (staff asked for it) or `restart` (it is to begin anew at once).

use std::{
    env, fmt,
    fs::{self, File},
    io::{self, Read, Write},
    path::{Path, PathBuf},
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread::{self, JoinHandle},
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

/// The environment variable with the file's path.
pub const HEARTBEAT: &str = "RECTO_HEARTBEAT";
/// Frames come faster, and the file is written no more often.
pub const EVERY: Duration = Duration::from_secs(1);
/// The first words of the line.
const FORMAT: &str = "recto 1";
/// A line is shorter.
const LONGEST: u64 = 256;

/// How a program that ends wants that taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum State {
    /// It has yet to show a picture.
    #[default]
    Starting,
    /// It shows its picture, and does not mean to end.
    Running,
    /// Staff asked for it: it stays ended.
    End,
    /// It begins anew at once, as every night.
    Restart,
}

impl State {
    const ALL: [Self; 4] = [Self::Starting, Self::Running, Self::End, Self::Restart];

    fn word(self) -> &'static str {
        match self {
            Self::Starting => "starting",
            Self::Running => "running",
            Self::End => "end",
            Self::Restart => "restart",
        }
    }
}

/// One line of the file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Beat {
    /// Frames that reached the screen since the program began.
    pub completed: u64,
    /// Frames that were begun since then.
    pub requested: u64,
    /// Milliseconds since 1970.
    pub unix_ms: u64,
    pub state: State,
}

impl fmt::Display for Beat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{FORMAT} completed={} requested={} unix_ms={} state={}",
            self.completed,
            self.requested,
            self.unix_ms,
            self.state.word()
        )
    }
}

impl Beat {
    /// What a file says; `None` if it is absent or says something else.
    pub fn read(file: &Path) -> Option<Self> {
        let mut text = String::new();
        let file = File::open(file).ok()?;
        file.take(LONGEST).read_to_string(&mut text).ok()?;
        Self::parse(&text)
    }

    fn parse(text: &str) -> Option<Self> {
        let mut words = text
            .strip_suffix('\n')?
            .strip_prefix(FORMAT)?
            .split(' ')
            .skip(1);
        let mut value = |key: &str| words.next()?.strip_prefix(key)?.strip_prefix('=');
        let beat = Self {
            completed: value("completed")?.parse().ok()?,
            requested: value("requested")?.parse().ok()?,
            unix_ms: value("unix_ms")?.parse().ok()?,
            state: {
                let word = value("state")?;
                State::ALL.into_iter().find(|state| state.word() == word)?
            },
        };
        words.next().is_none().then_some(beat)
    }

    /// Writes it whole, so that nobody reads half of it.
    ///
    /// # Errors
    /// Of writing or renaming; a file that was there is still there then.
    pub fn write(&self, file: &Path) -> io::Result<()> {
        let new = file.with_added_extension("new");
        let mut writer = File::create(&new)?;
        writeln!(writer, "{self}")?;
        drop(writer);
        fs::rename(&new, file)
    }
}

/// The writer of a program's heartbeat, which any thread may tell of frames. A thread of its own
/// writes, at most once a second and never without news: a program that hangs is silent.
#[derive(Debug)]
pub struct Heart {
    shared: Arc<Shared>,
    /// Taken when it is dropped.
    writer: Option<JoinHandle<()>>,
}

#[derive(Debug)]
struct Shared {
    /// Held while it is written, and before `news`: what is written later is newer.
    file: Mutex<PathBuf>,
    news: Mutex<News>,
    arrived: Condvar,
}

#[derive(Debug, Default)]
struct News {
    beat: Beat,
    /// Whether `beat` is yet to be written.
    unwritten: bool,
    /// Nothing more will come.
    over: bool,
    failures: u64,
}

impl Shared {
    /// Writes the latest news.
    fn write(&self) {
        let file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let beat = {
            let mut news = self.news();
            news.unwritten = false;
            news.beat
        };
        // Frames go on while the disk is slow.
        let failed = beat.write(&file).is_err();
        self.news().failures += u64::from(failed);
    }

    fn news(&self) -> MutexGuard<'_, News> {
        // Numbers are whole whoever panicked beside them.
        self.news.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Heart {
    /// The heart of a program that is looked after; `None` if nobody asked for one.
    pub fn from_environment() -> Option<Self> {
        let file = env::var_os(HEARTBEAT).filter(|file| !file.is_empty())?;
        Some(Self::new(PathBuf::from(file)))
    }

    /// A heart that writes to `file`.
    pub fn new(file: PathBuf) -> Self {
        let shared = Arc::new(Shared {
            file: Mutex::new(file),
            news: Mutex::default(),
            arrived: Condvar::new(),
        });
        let of_writer = Arc::clone(&shared);
        let writer = thread::Builder::new()
            .name("heartbeat".into())
            .spawn(move || write_all(&of_writer))
            .ok();
        Self { shared, writer }
    }

    /// Frames completed and requested since the program began. Errors of writing are counted.
    pub fn beat(&self, completed: u64, requested: u64) {
        self.tell(|beat| {
            beat.completed = completed;
            beat.requested = requested;
        });
    }

    /// The picture is there, with all that belongs to it.
    pub fn shows(&self) {
        self.tell(|beat| {
            if beat.state == State::Starting {
                beat.state = State::Running;
            }
        });
    }

    /// The program is about to end, and wants that taken so; it is written when this returns.
    pub fn leave(&self, state: State) {
        self.tell(|beat| beat.state = state);
        self.shared.write();
    }

    fn tell(&self, change: impl FnOnce(&mut Beat)) {
        let mut news = self.shared.news();
        change(&mut news.beat);
        news.beat.unix_ms = unix_ms();
        news.unwritten = true;
        drop(news);
        self.shared.arrived.notify_one();
    }

    /// How many times the file could not be written.
    pub fn failures(&self) -> u64 {
        self.shared.news().failures
    }
}

impl Drop for Heart {
    /// The last news is written.
    fn drop(&mut self) {
        self.shared.news().over = true;
        self.shared.arrived.notify_one();
        if let Some(writer) = self.writer.take() {
            let _ = writer.join();
        }
    }
}

fn write_all(shared: &Shared) {
    let mut last: Option<Instant> = None;
    let mut news = shared.news();
    loop {
        let wait = last.map_or(Duration::ZERO, |last| EVERY.saturating_sub(last.elapsed()));
        if news.unwritten && (news.over || wait.is_zero()) {
            drop(news);
            shared.write();
            last = Some(Instant::now());
            news = shared.news();
        } else if news.over {
            return;
        } else if news.unwritten {
            let waited = shared.arrived.wait_timeout(news, wait);
            news = waited.unwrap_or_else(PoisonError::into_inner).0;
        } else {
            let waited = shared.arrived.wait(news);
            news = waited.unwrap_or_else(PoisonError::into_inner);
        }
    }
}

fn unix_ms() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| {
        u64::try_from(since.as_millis()).unwrap_or(u64::MAX)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_read_as_it_was_written_and_nothing_else_is() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("heart");
        assert_eq!(Beat::read(&file), None);
        for state in State::ALL {
            let beat = Beat {
                completed: 5,
                requested: u64::MAX,
                unix_ms: 17,
                state,
            };
            beat.write(&file).unwrap();
            assert_eq!(Beat::read(&file), Some(beat));
        }
        let line = fs::read_to_string(&file).unwrap();
        for broken in [
            "",
            "\n",
            &line[..line.len() - 1],
            &line[1..],
            &line.replace("recto 1", "recto 2"),
            &line.replace("=5", "=-5"),
            &line.replace("restart", "resting"),
            &line.replace('\n', " more=1\n"),
            &line.repeat(2),
        ] {
            fs::write(&file, broken).unwrap();
            assert_eq!(Beat::read(&file), None, "{broken:?}");
        }
        fs::write(&file, [0xff; 999]).unwrap();
        assert_eq!(Beat::read(&file), None);
    }

    #[test]
    fn the_last_news_reaches_the_file_though_frames_come_faster() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("heart");
        let heart = Heart::new(file.clone());
        for frame in 1..=1000 {
            heart.beat(frame - 1, frame);
        }
        heart.beat(1000, 1000);
        heart.leave(State::Restart);
        assert_eq!(heart.failures(), 0);
        drop(heart);
        let beat = Beat::read(&file).unwrap();
        assert_eq!((beat.completed, beat.requested), (1000, 1000));
        assert_eq!(beat.state, State::Restart);
    }

    #[test]
    fn without_another_frame_the_last_one_is_written_all_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("heart");
        let heart = Heart::new(file.clone());
        heart.beat(0, 1);
        while Beat::read(&file).is_none() {
            thread::sleep(Duration::from_millis(1));
        }
        // Within the second, and then nothing more: an idle wall must not look like one that hangs.
        heart.beat(1, 1);
        while Beat::read(&file).is_none_or(|beat| beat.completed < 1) {
            thread::sleep(Duration::from_millis(10));
        }
    }

    #[test]
    fn a_file_that_cannot_be_written_is_counted() {
        let heart = Heart::new(PathBuf::from("/nowhere/at/all"));
        heart.beat(1, 1);
        while heart.failures() == 0 {
            thread::sleep(Duration::from_millis(1));
        }
    }
}
