//! What is shown in turns.

use std::{path::PathBuf, time::Duration};

use jiff::Zoned;

/// How long each exhibit is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Every {
    /// Below a week.
    Minutes(u32),
    Day,
}

/// The exhibits and their turns.
#[derive(Clone, Debug, PartialEq)]
pub struct Exhibits {
    /// Folders, or what `recto publish` writes to; never empty.
    pub folders: Vec<PathBuf>,
    pub every: Every,
}

impl Exhibits {
    /// Whose turn it is: an index of [`Self::folders`]. It depends on the time alone, so that a
    /// program that begins anew, and another machine, show the same. Days are those of the time
    /// zone of `at`.
    pub fn turn(&self, at: &Zoned) -> usize {
        let turns = match self.every {
            Every::Minutes(minutes) => at
                .timestamp()
                .as_second()
                .div_euclid(60 * i64::from(minutes.max(1))),
            Every::Day => {
                let days = at.date().duration_since(jiff::civil::date(1970, 1, 1));
                days.as_hours().div_euclid(24)
            }
        };
        let count = self.folders.len().max(1) as i64;
        usize::try_from(turns.rem_euclid(count)).unwrap_or(0)
    }

    /// How long it is until the next one's turn; `None` where there is one only.
    pub fn until_next(&self, at: &Zoned) -> Option<Duration> {
        if self.folders.len() < 2 {
            return None;
        }
        let left = match self.every {
            Every::Minutes(minutes) => {
                let period = 60 * i64::from(minutes.max(1));
                period - at.timestamp().as_second().rem_euclid(period)
            }
            Every::Day => {
                let next = at.tomorrow().and_then(|next| next.start_of_day()).ok()?;
                next.timestamp().as_second() - at.timestamp().as_second()
            }
        };
        // The next turn is not begun early.
        Some(Duration::from_secs(u64::try_from(left).unwrap_or(0).max(1)))
    }
}

#[cfg(test)]
mod tests {
    use jiff::{SignedDuration, civil::date, tz::TimeZone};

    use super::*;

    fn three(every: Every) -> Exhibits {
        Exhibits {
            folders: ["a", "b", "c"].map(PathBuf::from).into(),
            every,
        }
    }

    fn rome(day: i8, hour: i8) -> Zoned {
        let zone = TimeZone::posix("CET-1CEST,M3.5.0,M10.5.0/3").unwrap();
        zone.to_zoned(date(2026, 3, day).at(hour, 0, 0, 0)).unwrap()
    }

    #[test]
    fn each_has_its_turn_and_the_next_comes_when_it_is_said_to() {
        for every in [Every::Day, Every::Minutes(45), Every::Minutes(1440)] {
            let exhibits = three(every);
            // Over the night on which clocks are put forward.
            let mut now = rome(27, 9);
            for _ in 0..12 {
                let turn = exhibits.turn(&now);
                let wait = exhibits.until_next(&now).unwrap();
                let next = &now + SignedDuration::try_from(wait).unwrap();
                let just_before = &next - SignedDuration::from_secs(1);
                assert_eq!(exhibits.turn(&just_before), turn, "{every:?} {now}");
                assert_eq!(exhibits.turn(&next), (turn + 1) % 3, "{every:?} {now}");
                now = next;
            }
        }
    }

    #[test]
    fn one_alone_has_every_turn() {
        let one = Exhibits {
            folders: vec![PathBuf::from("a")],
            every: Every::Day,
        };
        assert_eq!(one.turn(&rome(29, 1)), 0);
        assert_eq!(one.until_next(&rome(29, 1)), None);
    }
}
