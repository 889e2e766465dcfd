//! Opening hours: days of the calendar, spans that do not overlap, and a time zone that is known.

use jiff::{civil::Date, tz::TimeZone};

use super::{
    super::{
        Closed, Hours, Span,
        hours::WEEKDAYS,
        raw::RawHours,
        values::{SpanText, clock_minutes, span_minutes},
    },
    Validator,
};
use crate::manifest::{
    Pattern,
    decode::List,
    document::{Trail, Words},
    quote,
};

impl Validator<'_, '_> {
    /// `None` if the hours are at fault.
    pub(super) fn hours(&mut self, raw: Option<&RawHours>, trail: &Trail) -> Option<Hours> {
        let Some(raw) = raw else {
            return Some(Hours::default());
        };
        let time_zone = self.time_zone(raw, &trail.key("time_zone"));
        let days = [
            &raw.monday,
            &raw.tuesday,
            &raw.wednesday,
            &raw.thursday,
            &raw.friday,
            &raw.saturday,
            &raw.sunday,
        ];
        let no_day_has_hours = raw.every_day.is_none() && days.iter().all(|day| day.is_none());
        let usual = match (&raw.every_day, no_day_has_hours) {
            (Some(list), _) => self.spans(list, &trail.key("every_day")),
            (None, true) => vec![Span::WHOLE_DAY],
            (None, false) => Vec::new(),
        };
        let mut week = [0; 7].map(|_| usual.clone());
        for (k, day) in days.iter().enumerate() {
            if let Some(list) = day {
                week[k] = self.spans(list, &trail.key(WEEKDAYS[k].0));
            }
        }
        let closed: Vec<Closed> = raw
            .closed
            .iter()
            .flat_map(|list| list.iter())
            .filter_map(|(i, day)| self.closed(day.as_str(), &trail.key("closed").index(i)))
            .collect();
        let restart = raw
            .restart
            .as_ref()
            .and_then(|clock| clock_minutes(clock.as_str()));
        let hours = Hours {
            time_zone: time_zone?,
            week,
            closed,
            restart,
        };
        if let Some(minute) = restart.filter(|minute| !no_day_has_hours && open_at(&hours, *minute))
        {
            let words = Words::new(
                format!(
                    "{:02}:{:02}, when the wall is open",
                    minute / 60,
                    minute % 60
                ),
                "a time at which it is closed on every day",
                "choose one at night",
            );
            self.report.warn(&trail.key("restart"), words);
        }
        Some(hours)
    }

    fn time_zone(&mut self, raw: &RawHours, trail: &Trail) -> Option<TimeZone> {
        let Some(name) = &raw.time_zone else {
            return Some(TimeZone::system());
        };
        match TimeZone::get(name.as_str()) {
            Ok(zone) => Some(zone),
            Err(_) => {
                let allowed = "a time zone of the IANA database, such as \"Europe/Rome\"";
                let remedy = match TimeZone::get("Europe/Rome") {
                    Ok(_) => "correct its name",
                    Err(_) => "install the package tzdata, without which none is known",
                };
                self.report
                    .fault(trail, Words::new(quote(name.as_str()), allowed, remedy));
                None
            }
        }
    }

    /// In their order.
    fn spans<const MAX: usize>(
        &mut self,
        list: &List<SpanText, 0, MAX>,
        trail: &Trail,
    ) -> Vec<Span> {
        let mut spans: Vec<(usize, Span)> = Vec::new();
        for (i, text) in list.iter() {
            match span_minutes(text.as_str()).and_then(Span::new) {
                Some(span) => spans.push((i, span)),
                None => {
                    let words = Words::new(
                        format!("{}, which ends as it begins", quote(text.as_str())),
                        "a span of time",
                        "write \"00:00-24:00\" for the whole day",
                    );
                    self.report.fault(&trail.index(i), words);
                }
            }
        }
        spans.sort_by_key(|(_, span)| *span);
        for pair in spans.windows(2) {
            let [(_, earlier), (i, span)] = pair else {
                continue;
            };
            if span.from < earlier.to {
                let words = Words::new(
                    format!("\"{span}\", which begins before \"{earlier}\" ends"),
                    "spans that follow each other",
                    "make one of the two",
                );
                self.report.fault(&trail.index(*i), words);
            }
        }
        spans.into_iter().map(|(_, span)| span).collect()
    }

    fn closed(&mut self, text: &str, trail: &Trail) -> Option<Closed> {
        let date = |text: &str| text.parse::<Date>().ok();
        let closed = match text.split_once('/') {
            Some((from, to)) => date(from)
                .zip(date(to))
                .map(|(from, to)| Closed::Days(from, to)),
            None if text.len() == "12-25".len() => {
                // A year that has a 29 February.
                date(&format!("2024-{text}")).map(|day| Closed::EveryYear(day.month(), day.day()))
            }
            None => date(text).map(|day| Closed::Days(day, day)),
        };
        let words = match closed {
            Some(Closed::Days(from, to)) if from > to => Words::new(
                format!("\"{text}\", which ends before it begins"),
                "the first day, a / and the last day",
                "exchange the two",
            ),
            Some(closed) => return Some(closed),
            None => Words::new(
                format!("\"{text}\", which no calendar has"),
                "days of the calendar",
                "correct it",
            ),
        };
        self.report.fault(trail, words);
        None
    }
}

/// Whether some day is open at this minute.
fn open_at(hours: &Hours, minute: u32) -> bool {
    let next_day = minute + 24 * 60;
    let mut spans = hours.week.iter().flatten();
    spans.any(|span| {
        [minute, next_day]
            .iter()
            .any(|m| (span.from..span.to).contains(m))
    })
}
