//! The single values of an installation file.

use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;

use crate::manifest::{
    decode::{Decode, Node, Report},
    document::Words,
    macros::{choice, number, pattern},
};

use super::{interface::Contrast, wall::Windows};

number! {
    /// A width or height of a display's visible area.
    DisplayMm = 10.0 ..= 100000.0, "mm";
    /// A place on the wall.
    WallMm = -100000.0 ..= 100000.0, "mm";
    /// A height above the floor; a wall may go on below it.
    FloorMm = -10000.0 ..= 100000.0, "mm";
    /// A height that hands reach.
    ReachMm = 0.0 ..= 3000.0, "mm";
    /// A chromaticity coordinate of a white.
    WhiteXy = 0.2 ..= 0.5, "", "no display's white lies elsewhere";
    /// An exponent of a display's tone curve.
    Gamma = 1.0 ..= 4.0, "";
    /// A display's luminance at full white.
    DisplayNits = 10.0 ..= 10000.0, "cd/m²";
    /// A time without a touch.
    IdleSeconds = 5.0 ..= 3600.0, "s";
    /// How long the countdown can be refused.
    CountdownSeconds = 3.0 ..= 120.0, "s";
    /// How long after the leader other machines show a picture.
    DelayMs = 0.0 ..= 500.0, "ms";
    /// How long a machine may be silent.
    LostSeconds = 2.0 ..= 600.0, "s";
    /// How much larger texts are.
    Enlargement = 1.0 ..= 3.0, "";
}

choice! {
    Windows { Spanning = "spanning", Each = "each", }
    Contrast { Normal = "normal", High = "high", }
}

/// Whole numbers with a range: `Name = min ..= max, "unit";`.
macro_rules! whole {
    ($($(#[doc = $doc:literal])+ $name:ident = $min:literal ..= $max:literal, $unit:literal;)*) => {$(
        $(#[doc = $doc])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
        #[serde(transparent)]
        pub struct $name(pub i32);

        impl Decode for $name {
            fn allowed() -> String {
                format!("a whole number from {} to {} {}", $min, $max, $unit).trim_end().to_owned()
            }

            fn decode(node: &Node<'_>, report: &mut Report<'_>) -> Option<Self> {
                let range = f64::from($min)..=f64::from($max);
                match node.number() {
                    // Within the range, which is that of an i32.
                    Some(number) if number.fract() == 0.0 && range.contains(&number) => {
                        Some(Self(number as i32))
                    }
                    number => {
                        let remedy = match number {
                            Some(_) => "write a whole number within this range",
                            None => "write a whole number, without quotation marks",
                        };
                        report.fault(node.trail(), Words::new(node.found(), Self::allowed(), remedy));
                        None
                    }
                }
            }
        }

        impl JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!({ "type": "integer", "minimum": $min, "maximum": $max })
            }
        }
    )*};
}

whole! {
    /// A width or height of a display.
    SidePx = 64 ..= 16384, "pixels";
    /// A place on the desktop.
    DesktopPx = -65536 ..= 65536, "pixels";
    /// How long an exhibit is shown before the next.
    EveryMinutes = 1 ..= 10080, "minutes";
    /// How large one log file may be.
    LogMegabytes = 1 ..= 1000, "MB";
    /// How many log files are kept.
    LogFiles = 1 ..= 365, "files";
}

pattern! {
    /// A file or folder of the machine.
    MachinePath = "^[^\\u0000-\\u001f\\u007f]+$", is_machine_path,
        "the path of a file or folder, from the installation file's folder or from /",
        "write the path in quotation marks";
    /// A time of day.
    ClockText = "^([01][0-9]|2[0-3]):[0-5][0-9]$", is_clock,
        "a time of day from \"00:00\" to \"23:59\"",
        "write hours and minutes with two digits each";
    /// From one time of day to another; past midnight where it ends no later than it begins.
    SpanText = "^([01][0-9]|2[0-3]):[0-5][0-9]-(([01][0-9]|2[0-3]):[0-5][0-9]|24:00)$", is_span,
        "two times of day from \"00:00\" to \"24:00\", such as \"10:00-18:00\", or \"18:00-02:00\" past midnight",
        "write hours up to 24 and minutes up to 59 with two digits each, and a hyphen between them";
    /// A day of one year, a day of every year, or the days from one to another.
    ClosedText = "^([0-9]{4}-)?(0[1-9]|1[0-2])-(0[1-9]|[12][0-9]|3[01])$|^[0-9]{4}-(0[1-9]|1[0-2])-(0[1-9]|[12][0-9]|3[01])/[0-9]{4}-(0[1-9]|1[0-2])-(0[1-9]|[12][0-9]|3[01])$",
        is_closed_text,
        "a day as \"2026-12-24\", one of every year as \"12-25\", or days as \"2027-01-11/2027-02-05\"",
        "write it in quotation marks, year first";
}

fn is_machine_path(text: &str) -> bool {
    !text.is_empty() && !text.contains(|c: char| c.is_ascii_control())
}

/// The minutes of `HH:MM`, since midnight.
pub(super) fn clock_minutes(text: &str) -> Option<u32> {
    let two = |part: &str, most: u32| {
        let digits = part.len() == 2 && part.bytes().all(|byte| byte.is_ascii_digit());
        let number = digits.then(|| part.parse::<u32>().ok()).flatten()?;
        (number <= most).then_some(number)
    };
    let (hours, minutes) = text.split_once(':')?;
    Some(two(hours, 23)? * 60 + two(minutes, 59)?)
}

/// The minutes since midnight at which a span begins and ends, as written.
pub(super) fn span_minutes(text: &str) -> Option<[u32; 2]> {
    let (from, to) = text.split_once('-')?;
    let to = match to {
        "24:00" => 24 * 60,
        to => clock_minutes(to)?,
    };
    Some([clock_minutes(from)?, to])
}

fn is_clock(text: &str) -> bool {
    clock_minutes(text).is_some()
}

fn is_span(text: &str) -> bool {
    span_minutes(text).is_some()
}

fn is_closed_text(text: &str) -> bool {
    let two = |part: &str, most: u32| {
        part.len() == 2
            && part.bytes().all(|byte| byte.is_ascii_digit())
            && part.parse().is_ok_and(|n| (1..=most).contains(&n))
    };
    let of_year = |text: &str| {
        text.split_once('-')
            .is_some_and(|(month, day)| two(month, 12) && two(day, 31))
    };
    let whole = |text: &str| {
        text.split_once('-').is_some_and(|(year, rest)| {
            year.len() == 4 && year.bytes().all(|byte| byte.is_ascii_digit()) && of_year(rest)
        })
    };
    match text.split_once('/') {
        Some((from, to)) => whole(from) && whole(to),
        None => whole(text) || of_year(text),
    }
}

/// What opens the staff's panel: digits, which no message repeats.
#[derive(Clone, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct PinText(pub(super) String);

impl PinText {
    const PATTERN: &str = "^[0-9]{4,12}$";
}

impl fmt::Debug for PinText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("PinText(…)")
    }
}

impl Decode for PinText {
    fn allowed() -> String {
        "4 to 12 digits in quotation marks".to_owned()
    }

    fn decode(node: &Node<'_>, report: &mut Report<'_>) -> Option<Self> {
        let (found, remedy) = match node.text() {
            Some(text) => {
                let digits = text.bytes().all(|byte| byte.is_ascii_digit());
                if digits && (4..=12).contains(&text.len()) {
                    return Some(Self(text.to_owned()));
                }
                let found = match digits {
                    true => format!("a PIN of {} digits", text.len()),
                    false => "a PIN with something else than digits".to_owned(),
                };
                (found, "choose another PIN")
            }
            None if node.number().is_some() => ("a number".to_owned(), "put it in quotation marks"),
            None => (node.found(), "write it in quotation marks"),
        };
        report.fault(node.trail(), Words::new(found, Self::allowed(), remedy));
        None
    }
}

impl JsonSchema for PinText {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "PinText".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "string", "pattern": Self::PATTERN })
    }
}
