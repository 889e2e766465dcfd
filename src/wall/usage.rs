//! How often and how long each scene was looked at in each language, by day: what a museum needs to
//! know which of them serve, and nothing about anyone. No time of day, no order, no visitor. Off
//! unless the museum switches it on.
//!
//! One table a year, `usage-2026.csv`: date, exhibit, scene, language, sessions, seconds.

use std::{
    collections::BTreeMap,
    fs,
    io::{self, Write},
    path::{Path, PathBuf},
    sync::{
        Arc,
        mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    },
    thread,
    time::{Duration, Instant},
};

use jiff::{Zoned, civil::Date};

use super::health::Health;

/// The first line of each table.
const HEADER: &str = "date,exhibit,scene,language,sessions,seconds";
/// Counts are written as soon as they are so old, or when the program ends.
const WRITE_EVERY: Duration = Duration::from_secs(60);
/// So many counts wait for a slow disk before the next ones are lost.
const MOST_WAITING: usize = 4096;
/// Rows of one year; more come of a fault, not of visitors.
const MOST_ROWS: usize = 200_000;
/// How long the end of the program waits for the last of them.
const LAST_WAIT: Duration = Duration::from_secs(1);
/// Longer names are cut.
const LONGEST_NAME: usize = 200;

/// What a row is of.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    date: Date,
    exhibit: String,
    scene: String,
    language: String,
}

/// What was counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Counts {
    sessions: u64,
    milliseconds: u64,
}

type Table = BTreeMap<Key, Counts>;

/// Counts, from any thread.
#[derive(Debug)]
pub struct Usage {
    /// `None` where nothing is counted.
    to: Option<SyncSender<(Key, Counts)>>,
    ended: Option<Receiver<()>>,
    health: Arc<Health>,
}

impl Usage {
    /// One that counts nothing.
    pub fn off() -> Self {
        Self {
            to: None,
            ended: None,
            health: Arc::default(),
        }
    }

    /// Counts into tables in `folder`, on top of what they have. What cannot be written is kept and
    /// tried again; what is lost is counted in `health`.
    pub fn open(folder: &Path, health: Arc<Health>) -> Self {
        Self::open_with(folder, health, WRITE_EVERY)
    }

    fn open_with(folder: &Path, health: Arc<Health>, every: Duration) -> Self {
        let (to, from) = sync_channel(MOST_WAITING);
        let (end, ended) = sync_channel(1);
        let mut tables = Tables {
            folder: folder.to_owned(),
            years: BTreeMap::new(),
            health: health.clone(),
        };
        let spawned = thread::Builder::new()
            .name("usage".to_owned())
            .spawn(move || {
                tables.keep(&from, every);
                let _ = end.send(());
            });
        Self {
            to: spawned.is_ok().then_some(to),
            ended: Some(ended),
            health,
        }
    }

    /// A scene was looked at, today, for so many seconds; `begins_session` if it is the first that this
    /// visitor looked at in this language.
    pub fn count(
        &self,
        exhibit: &str,
        scene: &str,
        language: &str,
        begins_session: bool,
        seconds: f64,
    ) {
        let date = Zoned::now().date();
        self.count_on(date, exhibit, scene, language, begins_session, seconds);
    }

    /// As [`Self::count`], on a day of an injected clock.
    pub fn count_on(
        &self,
        date: Date,
        exhibit: &str,
        scene: &str,
        language: &str,
        begins_session: bool,
        seconds: f64,
    ) {
        let Some(to) = &self.to else { return };
        let name = |text: &str| text[..text.floor_char_boundary(LONGEST_NAME)].to_owned();
        let key = Key {
            date,
            exhibit: name(exhibit),
            scene: name(scene),
            language: name(language),
        };
        let counts = Counts {
            sessions: begins_session.into(),
            // Of what is no number, or less than none, nothing is left.
            milliseconds: (seconds.clamp(0.0, 86_400.0) * 1000.0).round() as u64,
        };
        if to.try_send((key, counts)).is_err() {
            self.health.lines_lost(1);
        }
    }
}

impl Drop for Usage {
    fn drop(&mut self) {
        self.to = None;
        if let Some(ended) = &self.ended {
            // A disk that hangs does not keep the program from ending.
            let _ = ended.recv_timeout(LAST_WAIT);
        }
    }
}

/// The tables of a folder, by year.
struct Tables {
    folder: PathBuf,
    years: BTreeMap<i16, Year>,
    health: Arc<Health>,
}

#[derive(Default)]
struct Year {
    /// What its file had, and what was counted since; `None` while the file cannot be read.
    table: Option<Table>,
    /// What was counted while it could not.
    waiting: Table,
    is_changed: bool,
}

impl Tables {
    fn keep(&mut self, from: &Receiver<(Key, Counts)>, every: Duration) {
        // When the oldest count that is not yet written came.
        let mut since: Option<Instant> = None;
        loop {
            let wait = since.map_or(every, |since| every.saturating_sub(since.elapsed()));
            match from.recv_timeout(wait) {
                Ok((key, counts)) => {
                    self.add(key, counts);
                    since = since.or_else(|| Some(Instant::now()));
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            if since.is_some_and(|since| since.elapsed() >= every) {
                since = (!self.write()).then(Instant::now);
            }
        }
        if !self.write() {
            let unwritten = self.years.values().filter(|year| year.is_changed);
            self.health.lines_lost(unwritten.count() as u64);
        }
    }

    fn add(&mut self, key: Key, counts: Counts) {
        let year = self.years.entry(key.date.year()).or_default();
        let table = year.table.as_mut().unwrap_or(&mut year.waiting);
        if table.len() >= MOST_ROWS && !table.contains_key(&key) {
            self.health.lines_lost(1);
            return;
        }
        add(table, key, counts);
        year.is_changed = true;
    }

    /// Writes every table that changed; whether all of them were written.
    fn write(&mut self) -> bool {
        let mut all = true;
        for (number, year) in &mut self.years {
            if year.is_changed {
                let path = self.folder.join(format!("usage-{number:04}.csv"));
                year.is_changed = year.write(&path).is_err();
                all &= !year.is_changed;
            }
        }
        // Past years come no more.
        let last = self.years.keys().next_back().copied();
        self.years
            .retain(|number, year| year.is_changed || Some(*number) == last);
        all
    }
}

impl Year {
    fn write(&mut self, path: &Path) -> io::Result<()> {
        let folder = path.parent().unwrap_or(Path::new("."));
        fs::create_dir_all(folder)?;
        let table = match &mut self.table {
            Some(table) => table,
            table => {
                let mut before = read(path)?;
                for (key, counts) in std::mem::take(&mut self.waiting) {
                    add(&mut before, key, counts);
                }
                table.insert(before)
            }
        };
        let mut file = tempfile::Builder::new()
            .prefix(".usage-")
            .tempfile_in(folder)?;
        file.write_all(written(table).as_bytes())?;
        file.as_file().sync_all()?;
        file.persist(path).map_err(|error| error.error)?;
        Ok(())
    }
}

fn add(table: &mut Table, key: Key, counts: Counts) {
    let sum = table.entry(key).or_default();
    sum.sessions = sum.sessions.saturating_add(counts.sessions);
    sum.milliseconds = sum.milliseconds.saturating_add(counts.milliseconds);
}

/// The table of a file; none for a file that is not there. One that is none of ours is put aside.
fn read(path: &Path) -> io::Result<Table> {
    let bytes = match fs::read(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Table::new()),
        read => read?,
    };
    let table = String::from_utf8(bytes).ok().and_then(|text| parsed(&text));
    match table {
        Some(table) => Ok(table),
        None => {
            let aside = |number: u32| path.with_extension(format!("{number}.unreadable.csv"));
            let free = (1..1000).map(aside).find(|path| !path.exists());
            fs::rename(path, free.unwrap_or_else(|| aside(0)))?;
            Ok(Table::new())
        }
    }
}

fn written(table: &Table) -> String {
    let mut text = format!("{HEADER}\n");
    for (key, counts) in table {
        let names = [&key.exhibit, &key.scene, &key.language].map(|name| quoted(name));
        let seconds = counts.milliseconds as f64 / 1000.0;
        let (date, sessions) = (key.date, counts.sessions);
        text += &format!("{date},{},{sessions},{seconds}\n", names.join(","));
    }
    text
}

/// As RFC 4180 has it.
fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.to_owned()
    }
}

/// `None` where it is not wholly such a table.
fn parsed(text: &str) -> Option<Table> {
    let mut records = records(text).into_iter();
    if records.next()?.join(",") != HEADER {
        return None;
    }
    let mut table = Table::new();
    for record in records {
        let [date, exhibit, scene, language, sessions, seconds]: [String; 6] =
            record.try_into().ok()?;
        let seconds: f64 = seconds.parse().ok()?;
        let key = Key {
            date: date.parse().ok()?,
            exhibit,
            scene,
            language,
        };
        let counts = Counts {
            sessions: sessions.parse().ok()?,
            milliseconds: (seconds.is_finite() && seconds >= 0.0)
                .then(|| (seconds * 1000.0).round() as u64)?,
        };
        add(&mut table, key, counts);
    }
    Some(table)
}

/// The fields of each line of a CSV text, by RFC 4180, also as spreadsheets save it.
fn records(text: &str) -> Vec<Vec<String>> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut records = Vec::new();
    let mut record = vec![String::new()];
    let mut is_quoted = false;
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        let field = record.last_mut();
        match c {
            '"' if is_quoted && chars.peek() == Some(&'"') => {
                chars.next();
                field.into_iter().for_each(|field| field.push('"'));
            }
            '"' => is_quoted = !is_quoted,
            ',' if !is_quoted => record.push(String::new()),
            '\r' if !is_quoted && chars.peek() == Some(&'\n') => {}
            '\n' if !is_quoted => records.push(std::mem::replace(&mut record, vec![String::new()])),
            c => field.into_iter().for_each(|field| field.push(c)),
        }
    }
    if record != [""] {
        records.push(record);
    }
    records
}

#[cfg(test)]
mod tests {
    use super::*;
    use jiff::civil::date;

    const MONDAY: Date = date(2026, 11, 23);

    fn open(folder: &Path) -> (Usage, Arc<Health>) {
        let health = Arc::new(Health::new());
        (Usage::open(folder, health.clone()), health)
    }

    fn table(folder: &Path) -> String {
        fs::read_to_string(folder.join("usage-2026.csv")).expect("a table")
    }

    #[test]
    fn scenes_and_languages_are_counted_by_day_over_restarts() {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path().join("made/later");
        for _ in 0..2 {
            let (usage, health) = open(&folder);
            usage.count_on(MONDAY, "landscape", "washes", "it", true, 12.25);
            usage.count_on(MONDAY, "landscape", "washes", "it", false, 3.0);
            usage.count_on(MONDAY, "landscape", "washes", "ja", true, f64::NAN);
            usage.count_on(date(2026, 11, 24), "a, \"b\"", "washes", "it", true, -1.0);
            drop(usage);
            assert_eq!(health.report().lines_lost, 0);
        }
        assert_eq!(
            table(&folder),
            "date,exhibit,scene,language,sessions,seconds\n\
             2026-11-23,landscape,washes,it,2,30.5\n\
             2026-11-23,landscape,washes,ja,2,0\n\
             2026-11-24,\"a, \"\"b\"\"\",washes,it,2,0\n"
        );
        // Nothing half written lies about.
        assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 1);
    }

    #[test]
    fn each_year_has_its_table() {
        let folder = tempfile::tempdir().expect("a folder");
        let (usage, _) = open(folder.path());
        usage.count_on(date(2026, 12, 31), "a", "b", "en", true, 1.0);
        usage.count_on(date(2027, 1, 1), "a", "b", "en", true, 2.0);
        drop(usage);
        assert!(table(folder.path()).ends_with("2026-12-31,a,b,en,1,1\n"));
        let next = fs::read_to_string(folder.path().join("usage-2027.csv")).expect("a table");
        assert!(next.ends_with("2027-01-01,a,b,en,1,2\n"));
    }

    #[test]
    fn nothing_is_written_where_it_is_off() {
        let usage = Usage::off();
        usage.count("a", "b", "en", true, 1.0);
    }

    #[test]
    fn counts_are_written_while_the_program_runs_and_wait_for_a_disk_that_cannot_be_written_to() {
        let folder = tempfile::tempdir().expect("a folder");
        let blocked = folder.path().join("logs");
        fs::write(&blocked, "a file where the folder should be").expect("a file");
        let health = Arc::new(Health::new());
        let usage = Usage::open_with(&blocked, health.clone(), Duration::from_millis(20));
        usage.count_on(MONDAY, "a", "b", "en", true, 1.0);
        thread::sleep(Duration::from_millis(100));
        fs::remove_file(&blocked).expect("removed");
        usage.count_on(MONDAY, "a", "b", "en", true, 1.0);
        let ended = Instant::now() + Duration::from_secs(30);
        while !fs::read_to_string(blocked.join("usage-2026.csv"))
            .is_ok_and(|t| t.ends_with(",2,2\n"))
        {
            assert!(Instant::now() < ended, "never written");
            thread::sleep(Duration::from_millis(5));
        }
        drop(usage);
        assert_eq!(health.report().lines_lost, 0);
    }

    #[test]
    fn a_table_that_was_edited_is_read_and_one_that_is_none_is_put_aside() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("usage-2026.csv");
        let edited = format!("\u{feff}{}\r\n2026-11-23,\"a\",b,en,5,1.5\r\n", HEADER);
        fs::write(&path, edited).expect("a file");
        let count = || {
            let (usage, _) = open(folder.path());
            usage.count_on(MONDAY, "a", "b", "en", true, 1.0);
        };
        count();
        assert!(table(folder.path()).ends_with("2026-11-23,a,b,en,6,2.5\n"));
        for broken in [
            "hello",
            "",
            "date,exhibit\n",
            "\u{0}",
            "date,exhibit,scene,language,sessions,seconds\nx",
        ] {
            fs::write(&path, broken).expect("a file");
            count();
            assert!(
                table(folder.path()).ends_with("2026-11-23,a,b,en,1,1\n"),
                "{broken:?}"
            );
        }
        fs::write(&path, [0xff, 0xfe]).expect("a file");
        count();
        let aside = folder.path().join("usage-2026.6.unreadable.csv");
        assert_eq!(fs::read(aside).expect("put aside"), [0xff, 0xfe]);
    }

    #[test]
    fn counts_that_never_reach_the_disk_are_told() {
        let folder = tempfile::tempdir().expect("a folder");
        let blocked = folder.path().join("logs");
        fs::write(&blocked, "a file where the folder should be").expect("a file");
        let (usage, health) = open(&blocked);
        usage.count_on(MONDAY, "a", "b", "en", true, 1.0);
        drop(usage);
        assert_eq!(health.report().lines_lost, 1);
    }
}
