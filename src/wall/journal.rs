//! What happens at the wall, written into files: one JSON object a line, into a few files of a stated
//! size. A disk that is full, read-only or gone costs lines, which are counted, and never the
//! picture: a thread of its own writes, and nobody waits for it.

use std::{
    fmt,
    fs::{self, File, OpenOptions},
    io::{self, Write},
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
};

use jiff::Timestamp;
use serde_json::Value;
use tracing_appender::non_blocking::{NonBlocking, NonBlockingBuilder, WorkerGuard};

use super::health::Health;

/// The file that is written to; older ones are called `recto.1.log`, `recto.2.log`, …
pub const CURRENT: &str = "recto.log";
/// So many lines wait for a slow disk before the next ones are lost.
const MOST_WAITING: usize = 4096;
/// Longer words and values are cut.
const LONGEST: usize = 4096;
/// What every line has; fields of these names are left out.
const OWN: [&str; 3] = ["time", "level", "what"];

/// How much a line matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    Error,
    Warning,
    Info,
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Info => "info",
        })
    }
}

/// Where lines go. Clones write to the same files; the last one to be dropped waits a second at most for
/// what is yet to be written.
#[derive(Clone, Debug)]
pub struct Journal {
    inner: Option<Arc<Inner>>,
}

struct Inner {
    lines: NonBlocking,
    /// Lines that had no room to wait, as far as they were told to `health`.
    told: AtomicUsize,
    health: Arc<Health>,
    _guard: WorkerGuard,
}

impl fmt::Debug for Inner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Inner").finish_non_exhaustive()
    }
}

impl Journal {
    /// One that writes nothing.
    pub fn off() -> Self {
        Self { inner: None }
    }

    /// Writes into `folder`, which is made if it is absent, now or at any later line: at most `keep` files
    /// of at most `max_bytes` each. Lines that are lost are counted in `health`.
    pub fn open(folder: &Path, max_bytes: u64, keep: usize, health: Arc<Health>) -> Self {
        let files = Files {
            folder: folder.to_owned(),
            max_bytes,
            keep: keep.max(1),
            is_broken: false,
            health: health.clone(),
        };
        let (lines, guard) = NonBlockingBuilder::default()
            .lossy(true)
            .buffered_lines_limit(MOST_WAITING)
            .thread_name("journal")
            .finish(files);
        Self {
            inner: Some(Arc::new(Inner {
                lines,
                told: AtomicUsize::new(0),
                health,
                _guard: guard,
            })),
        }
    }

    /// Writes a line: when, how much it matters, what happened, in words, and what of it is of use
    /// to programs.
    pub fn write(&self, level: Level, what: impl fmt::Display, fields: &[(&str, Value)]) {
        self.write_at(Timestamp::now(), level, what, fields);
    }

    /// As [`Self::write`], by an injected clock.
    pub fn write_at(
        &self,
        now: Timestamp,
        level: Level,
        what: impl fmt::Display,
        fields: &[(&str, Value)],
    ) {
        let Some(inner) = &self.inner else { return };
        let line = line(now, level, &what.to_string(), fields);
        // It takes every line, and counts those that it has no room for.
        let _ = inner.lines.clone().write_all(line.as_bytes());
        let dropped = inner.lines.error_counter().dropped_lines();
        let told = inner.told.fetch_max(dropped, Ordering::Relaxed);
        inner.health.lines_lost(dropped.saturating_sub(told) as u64);
    }
}

/// The JSON of a line, with its end.
fn line(now: Timestamp, level: Level, what: &str, fields: &[(&str, Value)]) -> String {
    let mut line = format!(
        "{{\"time\":\"{}\",\"level\":\"{level}\",\"what\":{}",
        now.strftime("%FT%T%.3fZ"),
        Value::from(cut(what))
    );
    let mut seen: Vec<&str> = OWN.to_vec();
    for (name, value) in fields {
        if seen.contains(name) {
            continue;
        }
        seen.push(name);
        let value = match value {
            Value::String(text) => Value::from(cut(text)),
            other => other.clone(),
        };
        line += &format!(",{}:{value}", Value::from(*name));
    }
    line + "}\n"
}

fn cut(text: &str) -> &str {
    &text[..text.floor_char_boundary(LONGEST)]
}

/// The files of a folder, which never fail: what cannot be written is counted.
struct Files {
    folder: PathBuf,
    max_bytes: u64,
    keep: usize,
    /// The last line was written in part.
    is_broken: bool,
    health: Arc<Health>,
}

impl Files {
    fn append(&mut self, line: &[u8]) -> io::Result<()> {
        let mut file = self.current(line.len() as u64)?;
        if self.is_broken {
            file.write_all(b"\n")?;
            self.is_broken = false;
        }
        file.write_all(line).inspect_err(|_| self.is_broken = true)
    }

    /// The current file, with room for so many bytes more. It is opened for each line, of which there
    /// are few: whoever moves it or its folder away finds the next line in a new one.
    fn current(&self, more: u64) -> io::Result<File> {
        fs::create_dir_all(&self.folder)?;
        let path = self.folder.join(CURRENT);
        let length = fs::metadata(&path).map_or(0, |metadata| metadata.len());
        if length > 0 && length + more > self.max_bytes {
            self.rotate(&path)?;
        }
        OpenOptions::new().create(true).append(true).open(&path)
    }

    /// Moves every file to the next number, over the oldest.
    fn rotate(&self, current: &Path) -> io::Result<()> {
        if self.keep == 1 {
            return fs::remove_file(current);
        }
        let numbered = |number: usize| self.folder.join(format!("recto.{number}.log"));
        for number in (1..self.keep - 1).rev() {
            match fs::rename(numbered(number), numbered(number + 1)) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
        fs::rename(current, numbered(1))
    }
}

/// Whether lines can be written to a folder, which is made if it is not there.
///
/// # Errors
/// Of making the folder or a file in it.
pub fn can_write(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    let path = folder.join(CURRENT);
    let file = OpenOptions::new().create(true).append(true).open(path);
    file.map(drop)
}

impl Write for Files {
    fn write(&mut self, line: &[u8]) -> io::Result<usize> {
        if self.append(line).is_err() {
            self.health.lines_lost(1);
        }
        Ok(line.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("a folder").flatten();
        let mut names: Vec<String> = entries
            .map(|entry| entry.file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    /// Every line of the current file as JSON.
    fn lines(folder: &Path) -> Vec<Value> {
        let text = fs::read_to_string(folder.join(CURRENT)).expect("a log");
        let parsed = text
            .lines()
            .map(|line| serde_json::from_str(line).expect("JSON"));
        parsed.collect()
    }

    #[test]
    fn a_line_is_json_with_its_time_level_and_fields() {
        let folder = tempfile::tempdir().expect("a folder");
        let health = Arc::new(Health::new());
        let journal = Journal::open(&folder.path().join("logs"), 1 << 20, 3, health.clone());
        let now: Timestamp = "2026-11-26T07:30:00.25Z".parse().expect("a time");
        let fields = [
            ("exhibit", "a \"b\"\n".into()),
            ("faults", 2.into()),
            ("time", 0.into()),
            ("faults", 3.into()),
        ];
        journal.write_at(now, Level::Warning, "not shown:\nat fault", &fields);
        journal.clone().write(
            Level::Info,
            "x".repeat(100_000),
            &[("y", "é".repeat(9999).into())],
        );
        drop(journal);
        let lines = lines(&folder.path().join("logs"));
        let expected = serde_json::json!({
            "time": "2026-11-26T07:30:00.250Z", "level": "warning", "what": "not shown:\nat fault",
            "exhibit": "a \"b\"\n", "faults": 2
        });
        assert_eq!(lines[0], expected);
        assert_eq!(lines[1]["what"].as_str().map(str::len), Some(LONGEST));
        assert_eq!(lines.len(), 2);
        assert_eq!(health.report().lines_lost, 0);
    }

    #[test]
    fn files_keep_to_their_size_and_number_and_the_newest_lines_stay() {
        for keep in [1, 2, 4] {
            let folder = tempfile::tempdir().expect("a folder");
            let health = Arc::new(Health::new());
            let journal = Journal::open(folder.path(), 1000, keep, health.clone());
            for number in 0..200 {
                journal.write(Level::Info, "a line", &[("number", number.into())]);
            }
            drop(journal);
            let names = files(folder.path());
            assert_eq!(names.len(), keep, "{names:?}");
            assert!(names.contains(&CURRENT.to_owned()));
            for name in &names {
                let length = fs::metadata(folder.path().join(name))
                    .expect("a file")
                    .len();
                assert!(length <= 1000, "{name}: {length}");
            }
            let last = lines(folder.path())
                .last()
                .map(|line| line["number"].clone());
            assert_eq!(last, Some(199.into()));
            assert_eq!(health.report().lines_lost, 0);
        }
    }

    #[test]
    fn a_restarted_program_writes_on() {
        let folder = tempfile::tempdir().expect("a folder");
        for _ in 0..3 {
            let health = Arc::new(Health::new());
            let journal = Journal::open(folder.path(), 1 << 20, 3, health);
            journal.write(Level::Info, "started", &[]);
        }
        assert_eq!(lines(folder.path()).len(), 3);
    }

    #[test]
    fn a_disk_that_cannot_be_written_to_costs_lines_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a folder");
        let blocked = folder.path().join("logs");
        fs::write(&blocked, "a file where the folder should be").expect("a file");
        let health = Arc::new(Health::new());
        let journal = Journal::open(&blocked, 1000, 3, health.clone());
        for _ in 0..10 {
            journal.write(Level::Error, "lost", &[]);
        }
        wait_for(|| health.report().lines_lost == 10);
        // What blocked it is gone, and so is the fault.
        fs::remove_file(&blocked).expect("removed");
        journal.write(Level::Info, "back", &[]);
        drop(journal);
        assert_eq!(lines(&blocked).len(), 1);
        assert_eq!(health.report().lines_lost, 10);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_costs_lines_and_the_next_one_begins_afresh() {
        let folder = tempfile::tempdir().expect("a folder");
        let health = Arc::new(Health::new());
        let current = folder.path().join(CURRENT);
        // Every write to it says that the device is full.
        std::os::unix::fs::symlink("/dev/full", &current).expect("a link");
        let journal = Journal::open(folder.path(), 1000, 3, health.clone());
        journal.write(Level::Error, "lost", &[]);
        wait_for(|| health.report().lines_lost == 1);
        fs::remove_file(&current).expect("removed");
        fs::write(&current, "{\"half\":").expect("a file");
        journal.write(Level::Info, "back", &[]);
        drop(journal);
        let text = fs::read_to_string(&current).expect("a log");
        let last = text.lines().last().expect("a line");
        let last: Value = serde_json::from_str(last).expect("whole");
        assert_eq!(last["what"], "back");
    }

    #[test]
    fn nobody_waits_for_a_disk_that_hangs() {
        // A pipe that nobody reads: whoever opens it to write waits for ever.
        let folder = tempfile::tempdir().expect("a folder");
        let pipe = folder.path().join(CURRENT);
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        if !made.is_ok_and(|status| status.success()) {
            eprintln!("note: no mkfifo here, so a disk that hangs is not tried");
            return;
        }
        let health = Arc::new(Health::new());
        let journal = Journal::open(folder.path(), 1000, 3, health.clone());
        for _ in 0..MOST_WAITING + 100 {
            journal.write(Level::Info, "waiting", &[]);
        }
        assert!(health.report().lines_lost > 0);
        drop(journal);
    }

    fn wait_for(is_so: impl Fn() -> bool) {
        let ended = std::time::Instant::now() + std::time::Duration::from_secs(30);
        while !is_so() {
            assert!(std::time::Instant::now() < ended, "it never came");
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
    }
}
