//! Days of the wall, for which the test decides how late it is: opening hours, tours, visitors, exhibits in
//! their turns, one of them broken for an afternoon and one gone for another.

use std::{
    fs,
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicI64, Ordering},
    },
    time::Duration,
};

use bevy::prelude::*;
use jiff::{Timestamp, Zoned, tz::TimeZone};
use rand::{RngExt, SeedableRng, rngs::Xoshiro256PlusPlus as Random};
use recto::{
    installation::{Installation, Use},
    visitor::{Attract, Closed, Manners, controls::draw::Controls},
    wall::{
        house,
        keeper::{Clock, Keeper},
    },
    wording::Wordings,
};

use super::visit::{SIZE, Session, keep, resident_mib};

/// Days in the suite, and how many seconds pass between two frames of an open wall.
const DAYS: i64 = 2;
const STEP_S: i64 = 120;
/// As many as these say, at night.
const DAYS_ASKED: &str = "RECTO_WEEK_DAYS";
const STEP_ASKED: &str = "RECTO_WEEK_STEP_S";
/// While it is closed.
const NIGHT_STEP_S: i64 = 300;
/// On the average somebody comes so often.
const VISIT_EVERY_S: f64 = 900.0;
/// A Monday, at midnight in Rome.
const BEGINS: &str = "2026-11-23T00:00:00+01:00";
/// In an hour, each of which is seen: so much of what lies below the controls of a display that is lit is more
/// than twice as light as the table, though a visitor may have left the sheet turned away from a low lamp. A
/// display that is off is not lighter than this.
const LIT: f64 = 0.01;
const LIGHTER_THAN_THE_TABLE: f32 = 0.03;
const DARK: f64 = 1e-6;
/// So many entities more may be there at night, of what was open last.
const MORE: usize = 8;
/// The largest a log may be, and how many are kept.
const LOG_BYTES: u64 = 1 << 20;
const LOGS: u64 = 3;

const HOUSE: &str = r#"
languages = ["en", "it"]
[exhibits]
folders = ["first", "second"]
every_minutes = 90
[idle]
seconds = 120
countdown_seconds = 15
[hours]
time_zone = "Europe/Rome"
every_day = ["10:00-18:00"]
tuesday = ["10:00-18:00", "19:00-01:00"]
[logs]
folder = "logs"
max_megabytes = 1
keep = 3
usage_counts = true
[status]
address = "off"
[staff]
pin = "835017"
"#;

/// How late it is, in seconds since 1970.
#[derive(Clone)]
struct Hands(Arc<AtomicI64>);

impl Hands {
    fn at(&self) -> Zoned {
        let seconds = self.0.load(Ordering::Relaxed);
        let rome = TimeZone::get("Europe/Rome").expect("a time zone");
        timestamp(seconds).to_zoned(rome)
    }
}

fn timestamp(seconds: i64) -> Timestamp {
    Timestamp::from_second(seconds).expect("a time")
}

/// The wall, and what has happened to it.
struct Week {
    session: Session,
    hands: Hands,
    random: Random,
    visits: u64,
}

impl Week {
    fn begin() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for name in ["first", "second"] {
            let folder = folder.path().join(name);
            fs::create_dir(&folder).expect("a folder");
            super::write_exhibit(&folder);
        }
        let file = folder.path().join("installation.toml");
        fs::write(&file, HOUSE).expect("the installation is written");
        let read = Installation::read_for(&file, Use::Kiosk);
        let (installation, _) = read.unwrap_or_else(|faults| panic!("{faults}"));
        let begins: Timestamp = BEGINS.parse().expect("a time");
        let hands = Hands(Arc::new(AtomicI64::new(begins.as_second())));
        let clock = hands.clone();
        let clock = Clock::new(move || timestamp(clock.0.load(Ordering::Relaxed)));
        let kiosk = Manners {
            kiosk: true,
            ..Manners::default()
        };
        let manners = house::manners(&installation, kiosk);
        let mut keeper = Keeper::new(installation, clock);
        let exhibit = keeper.showable().unwrap_or_else(|error| panic!("{error}"));
        let session = Session::at(&exhibit, manners, folder, |app| {
            house::furnish(app, keeper, Wordings::default());
        });
        Self {
            session,
            hands,
            random: Random::seed_from_u64(47),
            visits: 0,
        }
    }

    /// One frame that comes so many seconds after the one before.
    fn pass(&mut self, seconds: i64) {
        self.hands.0.fetch_add(seconds, Ordering::Relaxed);
        self.session.pass(Duration::from_secs(seconds as u64));
    }

    fn is_closed(&mut self) -> bool {
        self.session.world().resource::<Closed>().0
    }

    /// Somebody comes, touches this and that, and leaves.
    fn visit(&mut self) {
        self.visits += 1;
        let [width, height] = SIZE.map(|side| side as f32);
        for _ in 0..self.random.random_range(2..8) {
            let place = |random: &mut Random| {
                Vec2::new(
                    random.random_range(0.0..width),
                    random.random_range(0.0..height),
                )
            };
            let (from, to) = (place(&mut self.random), place(&mut self.random));
            let controls = self.session.world().resource::<Controls>();
            let widgets = &controls.laid.widgets;
            let on_control = self.random.random_bool(0.6) && !widgets.is_empty();
            if on_control {
                let at = widgets[self.random.random_range(0..widgets.len())]
                    .rect
                    .center();
                self.session.tap(at);
            } else {
                self.session.drag(1, from, to);
                self.session.lift(1, to);
            }
            let pause = self.random.random_range(1..20);
            self.pass(pause);
        }
    }

    /// Mean luminance of what the display shows, and the share of the picture that is paper.
    fn light(&mut self, name: &str) -> [f64; 2] {
        let picture = self.session.see();
        keep(&picture, name);
        let is_paper = |below: &&[f32; 3]| below[1] > LIGHTER_THAN_THE_TABLE;
        let paper = picture.pixels.iter().filter(is_paper).count();
        let under = picture.pixels.iter().zip(&picture.legend);
        let light = under.map(|(below, over)| {
            let clear = 1.0 - over[3];
            f64::from(over[1] + clear * below[1].clamp(0.0, 1.0))
        });
        let count = picture.pixels.len() as f64;
        [light.sum::<f64>() / count, paper as f64 / count]
    }
}

fn asked(name: &str, without: i64) -> i64 {
    let asked = std::env::var(name).ok();
    asked.map_or(without, |number| number.parse().expect("a number"))
}

fn bytes_of(folder: &Path) -> u64 {
    let files = fs::read_dir(folder).expect("a folder of logs");
    let sizes = files.map(|file| file.and_then(|file| file.metadata()));
    sizes.map(|data| data.expect("its size").len()).sum()
}

#[test]
fn days_go_by_and_it_is_as_it_was() {
    let (days, step) = (asked(DAYS_ASKED, DAYS), asked(STEP_ASKED, STEP_S));
    let mut week = Week::begin();
    let begins = week.hands.0.load(Ordering::Relaxed);
    let [first, second] = ["first", "second"].map(|name| week.session.folder().join(name));
    let aside = week.session.folder().join("aside");
    let manifest = second.join("exhibit.toml");
    let sound = fs::read_to_string(&manifest).expect("a manifest");
    let (mut hour, mut lit, mut toured) = (-1, 0, 0);
    let mut held = Vec::new();
    while week.hands.0.load(Ordering::Relaxed) < begins + days * 86_400 {
        let closed = week.is_closed();
        week.pass(if closed { NIGHT_STEP_S } else { step });
        if !closed && week.random.random_bool(step as f64 / VISIT_EVERY_S) {
            week.visit();
        }
        let now = week.hands.at();
        if i64::from(now.hour()) == hour {
            continue;
        }
        hour = i64::from(now.hour());
        match hour {
            12 => fs::write(&manifest, "[exhibit").expect("it is broken"),
            14 => fs::write(&manifest, &sound).expect("it is mended"),
            15 => fs::rename(&first, &aside).expect("it is taken away"),
            17 => fs::rename(&aside, &first).expect("it is put back"),
            _ => {}
        }
        let [light, paper] = week.light(&format!("week-{}.png", now.strftime("%d-%H")));
        if week.is_closed() {
            assert!(light < DARK, "{now}: {light}");
        } else {
            assert!(paper > LIT && light > DARK, "{now}: {paper}, {light}");
            lit += 1;
        }
        toured += i32::from(week.session.resource::<Attract>().is_touring());
        if hour == 3 {
            held.push(week.session.holds());
            let at = now.strftime("%A");
            println!("{at}: {:?}, {:.0} MiB", held.last(), resident_mib());
        }
    }
    // Eight hours a day, and Tuesday's night of six.
    assert_eq!(lit, 8 * days + if days > 1 { 6 } else { 0 });
    assert!(toured > lit as i32 / 4, "{toured} of {lit}");
    // What visitors open for the first time is kept, and by the third day all of it was.
    let entities = |held: Option<&[usize; 3]>| held.map_or(0, |held| held[0]);
    assert!(
        entities(held.last()) <= entities(held.first()) + MORE,
        "{held:?}"
    );
    let (first, later) = held.split_at(3.min(held.len()));
    // Fewer entities are there where nothing was open last.
    let most = first.iter().map(|[entities, ..]| *entities).max();
    for [entities, images, meshes] in later {
        assert!(Some(*entities) <= most, "more is held each day: {held:?}");
        assert_eq!([*images, *meshes], first[2][1..], "{held:?}");
    }
    let Week {
        session, visits, ..
    } = week;
    let folder = session.close();
    let logs = folder.path().join("logs");
    let bytes = bytes_of(&logs);
    println!("{visits} visits, {bytes} bytes of logs");
    assert!(bytes > 0 && bytes <= LOGS * LOG_BYTES, "{bytes}");
    let counts = fs::read_to_string(logs.join("usage-2026.csv")).expect("counts");
    let sessions = counts.lines().skip(1).map(|row| {
        let sessions = row.split(',').nth(4).and_then(|count| count.parse().ok());
        sessions.unwrap_or(0)
    });
    let sessions: u64 = sessions.sum();
    assert!(sessions > 0 && sessions <= visits, "{sessions} of {visits}");
}
