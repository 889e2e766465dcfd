//! When the screens are lit, and when the program begins anew: pure functions of a time.
//!
//! Hours are those of the clock on the wall of the room. Where the clock is put forward over the
//! beginning or end of a span, that moves with it; where it is put back, the first of the two
//! counts. So every opening happens once, and none is longer or shorter than clocks make it.

use jiff::{
    ToSpan, Zoned,
    civil::{Date, DateTime, Weekday},
    tz::TimeZone,
};

const DAY: u32 = 24 * 60;
/// How far ahead a change is looked for: more than a year, so that a museum that is closed for
/// one still has one.
const DAYS_AHEAD: usize = 400;

/// From one minute after midnight to another; the second may lie on the next day.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Span {
    /// Below 24 × 60.
    pub from: u32,
    /// Above `from`, and no more than 24 × 60 later.
    pub to: u32,
}

impl Span {
    /// A whole day.
    pub const WHOLE_DAY: Self = Self { from: 0, to: DAY };

    /// From minutes after midnight as written: past midnight where it ends no later than it
    /// begins; `None` if it begins and ends at once.
    pub fn new([from, to]: [u32; 2]) -> Option<Self> {
        match to {
            to if to == from => None,
            to if to > from => Some(Self { from, to }),
            to => Some(Self { from, to: to + DAY }),
        }
    }
}

/// Days on which nothing opens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Closed {
    /// The days from one to another, both included.
    Days(Date, Date),
    /// One day of every year, as month and day.
    EveryYear(i8, i8),
}

impl Closed {
    fn holds(&self, date: Date) -> bool {
        match *self {
            Self::Days(from, to) => (from..=to).contains(&date),
            Self::EveryYear(month, day) => (date.month(), date.day()) == (month, day),
        }
    }
}

/// When the screens are lit.
#[derive(Clone, Debug, PartialEq)]
pub struct Hours {
    pub time_zone: TimeZone,
    /// From Monday; sorted, not overlapping within a day.
    pub week: [Vec<Span>; 7],
    pub closed: Vec<Closed>,
    /// The minute after midnight at which the program begins anew.
    pub restart: Option<u32>,
}

impl Default for Hours {
    /// Always.
    fn default() -> Self {
        Self {
            time_zone: TimeZone::system(),
            week: [0; 7].map(|_| vec![Span::WHOLE_DAY]),
            closed: Vec::new(),
            restart: None,
        }
    }
}

impl Hours {
    /// The spans that begin on this day.
    pub fn spans(&self, date: Date) -> &[Span] {
        if self.closed.iter().any(|closed| closed.holds(date)) {
            return &[];
        }
        let day = usize::from(date.weekday().to_monday_zero_offset().unsigned_abs());
        self.week.get(day).map_or(&[], Vec::as_slice)
    }

    /// Whether the screens are lit at this time, of any time zone. Spans have their beginning and
    /// not their end.
    pub fn is_open(&self, at: &Zoned) -> bool {
        self.openings(at)
            .take_while(|(from, _)| from <= at)
            .any(|(_, to)| at < to)
    }

    /// When it opens or closes next, after this time; `None` if it does not within a year. To be
    /// asked once for each change, as it looks through the calendar.
    pub fn next_change(&self, at: &Zoned) -> Option<Zoned> {
        let mut until: Option<Zoned> = None;
        for (from, to) in self.openings(at) {
            match &until {
                // What begins when another ends, or before, is no change.
                Some(end) if from > *end => break,
                None if from > *at => return Some(from),
                _ if to > *at => {
                    let end = until.take().map_or(to.clone(), |end| end.max(to));
                    until = Some(end);
                }
                _ => {}
            }
        }
        let last_day = self
            .here(at)
            .date()
            .saturating_add((DAYS_AHEAD as i64 - 1).days());
        until.filter(|until| until.date() < last_day)
    }

    /// When the program begins anew next, after this time.
    pub fn next_restart(&self, at: &Zoned) -> Option<Zoned> {
        let minute = self.restart?;
        let today = self.here(at).date();
        let days = today.yesterday().ok()?.series(1.day()).take(4);
        days.filter_map(|date| self.time(date, minute))
            .find(|restart| restart > at)
    }

    /// From the day before `at`, which may go on past midnight, each with beginning and end, by
    /// their beginning.
    fn openings(&self, at: &Zoned) -> impl Iterator<Item = (Zoned, Zoned)> + '_ {
        let today = self.here(at).date();
        let first = today.yesterday().unwrap_or(today);
        let days = first.series(1.day()).take(DAYS_AHEAD);
        days.flat_map(|date| {
            let openings = self.spans(date).iter().filter_map(|span| {
                let [from, to] = [span.from, span.to].map(|minute| self.time(date, minute));
                // The clock may be put forward over all of it.
                Some((from?, to?)).filter(|(from, to)| from < to)
            });
            let mut openings: Vec<_> = openings.collect();
            // Or over its beginning, and past that of the next.
            openings.sort();
            openings
        })
    }

    fn here(&self, at: &Zoned) -> Zoned {
        at.with_time_zone(self.time_zone.clone())
    }

    /// The time of so many minutes after the midnight that `date` begins with.
    fn time(&self, date: Date, minute: u32) -> Option<Zoned> {
        let date = match minute / DAY {
            0 => date,
            days => date.checked_add(i64::from(days).days()).ok()?,
        };
        let minute = minute % DAY;
        let [hours, minutes] = [minute / 60, minute % 60].map(|part| i8::try_from(part).ok());
        let time = DateTime::from_parts(date, jiff::civil::Time::new(hours?, minutes?, 0, 0).ok()?);
        self.time_zone.to_zoned(time).ok()
    }
}

/// `10:00-18:00`, past midnight as `18:00-02:00`.
impl std::fmt::Display for Span {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let clock = |minute: u32| (minute / 60, minute % 60);
        let (from, from_minute) = clock(self.from);
        let (to, to_minute) = match self.to {
            DAY => (24, 0),
            to => clock(to % DAY),
        };
        write!(f, "{from:02}:{from_minute:02}-{to:02}:{to_minute:02}")
    }
}

/// The days of the week from Monday, as the installation file writes them.
pub const WEEKDAYS: [(&str, Weekday); 7] = [
    ("monday", Weekday::Monday),
    ("tuesday", Weekday::Tuesday),
    ("wednesday", Weekday::Wednesday),
    ("thursday", Weekday::Thursday),
    ("friday", Weekday::Friday),
    ("saturday", Weekday::Saturday),
    ("sunday", Weekday::Sunday),
];

#[cfg(test)]
mod tests {
    use jiff::{SignedDuration, Timestamp, civil::date};

    use super::*;

    /// Central European time, which needs no database.
    fn rome() -> TimeZone {
        TimeZone::posix("CET-1CEST,M3.5.0,M10.5.0/3").unwrap()
    }

    fn span(from: u32, to: u32) -> Span {
        Span::new([from, to]).unwrap()
    }

    /// Tuesday to Sunday from ten to six, Friday from four to two in the morning as well.
    fn museum() -> Hours {
        let day = vec![span(600, 1080)];
        let mut week = [0; 7].map(|_| day.clone());
        week[0] = Vec::new();
        week[4] = vec![span(600, 780), span(960, 120)];
        Hours {
            time_zone: rome(),
            week,
            closed: vec![
                Closed::EveryYear(12, 25),
                Closed::Days(date(2026, 1, 12), date(2026, 1, 18)),
            ],
            restart: Some(4 * 60),
        }
    }

    fn at(year: i16, month: i8, day: i8, hour: i8, minute: i8) -> Zoned {
        let time = date(year, month, day).at(hour, minute, 0, 0);
        rome().to_zoned(time).unwrap()
    }

    #[test]
    fn spans_begin_and_end_and_go_past_midnight() {
        let hours = museum();
        // 27 November 2026 is a Friday.
        for (time, open) in [
            (at(2026, 11, 27, 9, 59), false),
            (at(2026, 11, 27, 10, 0), true),
            (at(2026, 11, 27, 12, 59), true),
            (at(2026, 11, 27, 13, 0), false),
            (at(2026, 11, 27, 23, 59), true),
            (at(2026, 11, 28, 1, 59), true),
            (at(2026, 11, 28, 2, 0), false),
            (at(2026, 11, 30, 12, 0), false),
            (at(2026, 12, 25, 12, 0), false),
            // It opened on the 24th, a Thursday, and closed at six.
            (at(2026, 12, 24, 17, 0), true),
            (at(2026, 1, 16, 12, 0), false),
            (at(2026, 1, 20, 12, 0), true),
        ] {
            assert_eq!(hours.is_open(&time), open, "{time}");
        }
        let next = |time: Zoned| hours.next_change(&time).unwrap();
        assert_eq!(next(at(2026, 11, 27, 13, 0)), at(2026, 11, 27, 16, 0));
        assert_eq!(next(at(2026, 11, 27, 16, 0)), at(2026, 11, 28, 2, 0));
        assert_eq!(next(at(2026, 11, 29, 18, 0)), at(2026, 12, 1, 10, 0));
        assert_eq!(next(at(2026, 1, 11, 18, 0)), at(2026, 1, 20, 10, 0));
    }

    #[test]
    fn a_time_of_another_zone_is_the_same_moment() {
        let hours = museum();
        let utc = at(2026, 11, 27, 10, 0).with_time_zone(TimeZone::UTC);
        assert!(hours.is_open(&utc));
        assert!(!hours.is_open(&(&utc - SignedDuration::from_mins(1))));
    }

    #[test]
    fn touching_spans_are_one_and_always_open_never_changes() {
        let always = Hours {
            time_zone: rome(),
            ..Hours::default()
        };
        assert!(always.is_open(&at(2026, 3, 29, 3, 30)));
        assert_eq!(always.next_change(&at(2026, 6, 1, 0, 0)), None);
        let but_one = Hours {
            closed: vec![Closed::EveryYear(12, 25)],
            ..always
        };
        let christmas = but_one.next_change(&at(2026, 6, 1, 12, 0));
        assert_eq!(christmas, Some(at(2026, 12, 25, 0, 0)));
        let after = but_one.next_change(&at(2026, 12, 25, 8, 0));
        assert_eq!(after, Some(at(2026, 12, 26, 0, 0)));
        let never = Hours {
            week: [0; 7].map(|_| Vec::new()),
            ..but_one
        };
        assert!(!never.is_open(&at(2026, 6, 1, 12, 0)));
        assert_eq!(never.next_change(&at(2026, 6, 1, 12, 0)), None);
    }

    #[test]
    fn a_clock_that_is_put_forward_or_back_opens_once() {
        let night = Hours {
            week: [0; 7].map(|_| vec![span(150, 240)]),
            time_zone: rome(),
            closed: Vec::new(),
            restart: Some(150),
        };
        // 29 March 2026: from 2 to 3 there is no time; half past two is half past three.
        let opens = night.next_change(&at(2026, 3, 28, 12, 0)).unwrap();
        assert_eq!(opens, at(2026, 3, 29, 3, 30));
        assert_eq!(night.next_change(&opens), Some(at(2026, 3, 29, 4, 0)));
        // 25 October 2026: from 2 to 3 twice; the first half past two counts, and an hour and a
        // half by the clock lasts two and a half.
        let opens = night.next_change(&at(2026, 10, 24, 12, 0)).unwrap();
        let closes = night.next_change(&opens).unwrap();
        let minutes = closes.timestamp().as_second() - opens.timestamp().as_second();
        assert_eq!(minutes / 60, 150);
        let once = |from: Zoned, to: Zoned| {
            let mut restarts = Vec::new();
            let mut now = from;
            while let Some(next) = night.next_restart(&now).filter(|next| *next < to) {
                restarts.push(next.clone());
                now = next;
            }
            restarts
        };
        let spring = once(at(2026, 3, 28, 12, 0), at(2026, 3, 30, 12, 0));
        assert_eq!(spring, [at(2026, 3, 29, 3, 30), at(2026, 3, 30, 2, 30)]);
        let autumn = once(at(2026, 10, 24, 12, 0), at(2026, 10, 26, 12, 0));
        assert_eq!(autumn.len(), 2);
    }

    /// By the clock alone, minute by minute, without intervals: what is right but for the two
    /// nights on which clocks change.
    fn by_the_clock(hours: &Hours, at: &Zoned) -> bool {
        let minute = at.hour().unsigned_abs() as u32 * 60 + at.minute().unsigned_abs() as u32;
        let within = |date: Date, minute: u32| {
            let spans = hours.spans(date).iter();
            spans
                .clone()
                .any(|span| (span.from..span.to).contains(&minute))
        };
        within(at.date(), minute) || within(at.date().yesterday().unwrap(), minute + DAY)
    }

    #[test]
    fn a_year_agrees_with_the_clock_on_the_wall() {
        /// A step that meets every minute of the hour in time.
        const STEP: SignedDuration = SignedDuration::from_mins(17);
        let hours = museum();
        let (mut now, end) = (at(2026, 1, 1, 0, 0), at(2027, 1, 1, 0, 0));
        let mut next = hours.next_change(&now).unwrap();
        let (mut open_samples, mut samples, mut changes) = (0, 0, 0);
        while now < end {
            let open = hours.is_open(&now);
            assert_eq!(open, by_the_clock(&hours, &now), "{now}");
            samples += 1;
            open_samples += u32::from(open);
            let later = &now + STEP;
            // No change between the samples is missed, and none is said that is none.
            while next <= later {
                let before = &next - SignedDuration::from_secs(1);
                assert_ne!(hours.is_open(&before), hours.is_open(&next), "{next}");
                changes += 1;
                next = hours.next_change(&next).unwrap();
            }
            now = later;
        }
        assert!(samples > 30_000 && open_samples > 8_000);
        // 52 weeks of 6 days with two changes, and two more on Fridays, less the closed days.
        assert!((680..740).contains(&changes), "{changes}");
        let mut restarts = 0;
        let mut now = at(2026, 1, 1, 0, 0);
        while let Some(next) = hours.next_restart(&now).filter(|next| *next < end) {
            assert_eq!((next.hour(), next.minute()), (4, 0));
            restarts += 1;
            now = next;
        }
        assert_eq!(restarts, 365);
    }

    #[test]
    fn the_ends_of_time_do_no_harm() {
        for moment in [Timestamp::MIN, Timestamp::MAX] {
            let at = moment.to_zoned(rome());
            let hours = museum();
            hours.is_open(&at);
            hours.next_change(&at);
            hours.next_restart(&at);
        }
    }
}
