//! What was read, in the words of whoever reads it: values as the language writes numbers, what is to be
//! known of them, and why there are none.

use super::measuring::{Kind, Laid, Said};
use crate::{
    manifest::exhibit::{Source, Wording},
    readings::{Curve, Note, Reading, Says, Under, Value, Why, decimals},
    stage::Shown,
    wording::{Spoken, catalogue},
};

/// Between parts of a line, which is broken behind it.
const AND: &str = "\u{a0}· ";
/// Decimals of a value whose uncertainty is not known, of a place in mm, of a colour, and of a reflectance.
const UNKNOWN: usize = 3;
const PLACE: usize = 2;
const COLOUR: usize = 1;
const REFLECTANCE: usize = 3;
/// Decimals of what an overlay stands for, at most.
const QUANTITY: usize = 4;
/// Of a length over which something was read.
const LENGTH: usize = 1;

/// The wordings of a tool: its name, and what is to be done with it.
pub fn tool_ids(kind: Kind) -> [&'static str; 2] {
    match kind {
        Kind::Ruler => ["ruler", "ruler-hint"],
        Kind::Path => ["line", "line-hint"],
        Kind::Area => ["area", "area-hint"],
        Kind::Angle => ["angle", "angle-hint"],
        Kind::Profile => ["profile", "profile-hint"],
        Kind::Lines => ["laid-lines", "laid-lines-hint"],
        Kind::Stroke => ["stroke", "stroke-hint"],
        Kind::Probe => ["probe", "probe-hint"],
        Kind::Difference => ["difference", "difference-hint"],
    }
}

/// A value with its uncertainty and unit, to the digits that these have: `12.34 ± 0.05 mm`.
pub fn measured(value: &Value, spoken: Spoken) -> String {
    let space = match value.unit {
        "" | "°" => "",
        _ => " ",
    };
    let number = match (value.value, value.sigma) {
        (Some(value), Some(sigma)) => {
            let decimals = decimals(sigma);
            let [value, sigma] = [value, sigma].map(|v| spoken.number(v, decimals));
            format!("{value} ± {sigma}")
        }
        (Some(value), None) => spoken.number(value, UNKNOWN),
        (None, _) => return "–".to_owned(),
    };
    format!("{number}{space}{}", value.unit)
}

/// Beside a tool on the sheet: its first value.
pub fn label(laid: &Laid, spoken: Spoken) -> String {
    match &laid.said {
        Said::Waiting => "…".to_owned(),
        Said::Nothing(_) => "?".to_owned(),
        Said::Read(reading) => {
            let first = reading.values.first();
            let value = first.map_or_else(String::new, |value| measured(value, spoken));
            match laid.kind {
                Kind::Probe => format!("L* {value}"),
                Kind::Difference => format!("ΔE00 {value}"),
                _ => value,
            }
        }
    }
}

/// The line of a tool that lies on the sheet, `number` among all of them: where it lies, and what it read.
pub fn line(number: usize, laid: &Laid, shown: &Shown, spoken: Spoken) -> String {
    let drawings = &shown.exhibit.drawings;
    let drawing = drawings.iter().find(|d| d.id == laid.on.drawing);
    let state = laid.on.state.as_deref().map(|id| {
        let state = drawing.and_then(|drawing| drawing.state(id));
        state.map_or(id, |(_, state)| titled(&state.title, &state.id, shown))
    });
    let [name, _] = tool_ids(laid.kind);
    let mut parts = vec![spoken.isolated(&number.to_string())];
    parts.push(super::controls::facts::side_words(laid.on.side, spoken));
    parts.extend(state.map(|state| spoken.isolated(state)));
    parts.push(spoken.say(name));
    match &laid.said {
        Said::Waiting => parts.push(spoken.say("reading-waiting")),
        Said::Nothing(Why::Nothing) => parts.push(spoken.say("reading-nothing")),
        Said::Nothing(why) => parts.push(failed(*why, spoken)),
        Said::Read(reading) => parts.extend(values(laid.kind, reading, spoken)),
    }
    parts.join(AND)
}

/// What was read, value by value.
fn values(kind: Kind, reading: &Reading, spoken: Spoken) -> Vec<String> {
    // What two colours differ by is asked for, and not the two.
    let count = match kind {
        Kind::Difference => 1,
        _ => reading.values.len(),
    };
    let said = reading.values.iter().take(count).map(|value| {
        // A number stays with its unit.
        let number = measured(value, spoken).replace(' ', "\u{a0}");
        let Some(id) = catalogue::quantity(value.quantity) else {
            return spoken.isolated(&format!("{} {number}", value.quantity));
        };
        let quantity = spoken.say(id);
        match (value.value, value.why) {
            (Some(_), _) => spoken.fill(
                "reading",
                &[("quantity", quantity.into()), ("value", number.into())],
            ),
            (None, Some(reason)) => spoken.fill(
                "reading-none-why",
                &[
                    ("quantity", quantity.into()),
                    ("why", why(reason, spoken).into()),
                ],
            ),
            (None, None) => spoken.fill("reading-none", &[("quantity", quantity.into())]),
        }
    });
    said.collect()
}

/// Why nothing was read.
pub fn failed(reason: Why, spoken: Spoken) -> String {
    spoken.fill("reading-failed", &[("why", why(reason, spoken).into())])
}

fn why(why: Why, spoken: Spoken) -> String {
    match why {
        Why::OffSheet => spoken.say("why-off-sheet"),
        Why::TooWide => spoken.say("why-too-wide"),
        Why::NoPicture => spoken.say("why-no-picture"),
        Why::NoHeight => spoken.say("why-no-height"),
        Why::Unreadable => spoken.say("why-unreadable"),
        Why::Gone => spoken.say("why-gone"),
        Why::OnePlace => spoken.say("why-one-place"),
        Why::CrossesItself => spoken.say("why-crosses-itself"),
        Why::NoArea => spoken.say("why-no-area"),
        Why::NoStroke => spoken.say("why-no-stroke"),
        Why::SeveralStrokes(_) => spoken.say("why-several-strokes"),
        Why::NoPaper => spoken.say("why-no-paper"),
        Why::Oblique(degrees) => {
            spoken.fill("why-oblique", &[("degrees", degrees.abs().round().into())])
        }
        Why::TooLittle => spoken.say("why-too-little"),
        Why::Coarse => spoken.say("why-coarse"),
        Why::Small => spoken.say("why-small"),
        Why::Covered => spoken.say("why-covered"),
        Why::Faint => spoken.say("why-faint"),
        Why::Nothing => spoken.say("reading-nothing"),
    }
}

/// What else is to be known of a reading.
pub fn note(note: &Note, spoken: Spoken) -> String {
    let of_file = |id, file: &str| spoken.fill(id, &[("file", file.into())]);
    match note {
        Note::Unregistered { file } => of_file("note-unregistered", file),
        Note::NotMeasured { file, source } => match source {
            Source::Fitted => of_file("note-fitted", file),
            Source::Assumed | Source::Measured => of_file("note-assumed", file),
        },
        Note::NoPicture { .. } => spoken.say("note-no-picture"),
        Note::Stroke {
            file, spread_mm, ..
        } => {
            let length = format!("{} mm", spoken.number(*spread_mm, LENGTH));
            spoken.fill(
                "note-stroke",
                &[("file", file.as_str().into()), ("length", length.into())],
            )
        }
        Note::Lines { file } => of_file("note-lines", file),
        Note::Colours { file } => of_file("note-colours", file),
    }
}

/// What lies under the pointer, a line each.
pub fn under(under: &Under, shown: &Shown, spoken: Spoken) -> Vec<String> {
    let [across, down] = under.place_mm.to_array();
    let [across, down] = [across, down].map(|mm| spoken.short(mm, PLACE));
    let place = spoken.fill(
        "under-place",
        &[("across", across.into()), ("down", down.into())],
    );
    let colour = under
        .lab
        .map(|lab| spoken.isolated(&lab_words(lab, spoken)));
    let mut lines = vec![
        [Some(place), colour]
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
            .join(AND),
    ];
    let pair = |quantity: &str, value: String| {
        spoken.fill(
            "reading",
            &[("quantity", quantity.into()), ("value", value.into())],
        )
    };
    if let Some(difference) = under.difference {
        let quantity = spoken.say("quantity-difference");
        lines.push(pair(&quantity, spoken.number(difference, COLOUR)));
    }
    for overlay in &under.overlays {
        let said = match &overlay.says {
            None => spoken.say("under-nothing"),
            Some(Says::Category(label)) => shown.text(label).unwrap_or_default().to_owned(),
            Some(Says::Quantity { value, unit }) => {
                format!("{} {unit}", spoken.short(*value, QUANTITY))
            }
            Some(Says::Colour(lab)) => lab_words(*lab, spoken),
            Some(Says::FalseColour(linear)) => {
                let [red, green, blue] = linear.map(|c| spoken.number(c, REFLECTANCE).into());
                let args = [("red", red), ("green", green), ("blue", blue)];
                spoken.fill("under-false-colour", &args)
            }
            Some(Says::Difference(value)) => {
                let sign = if *value > 0.0 { "+" } else { "" };
                let value = format!("{sign}{}", spoken.number(*value, REFLECTANCE));
                spoken.fill("under-reflectance", &[("value", value.into())])
            }
        };
        lines.push(pair(titled(&overlay.title, &overlay.id, shown), said));
    }
    lines
}

/// What stands over a curve: whose it is, and its ends.
pub fn curve(curve: &Curve, shown: &Shown, spoken: Spoken) -> String {
    let ends = [curve.points.first(), curve.points.last()];
    let ends = ends.into_iter().flatten().map(|point| {
        let reflectance = point.reflectance;
        let reflectance =
            reflectance.map_or_else(|| "–".to_owned(), |r| spoken.number(r, REFLECTANCE));
        format!("{} nm {reflectance}", spoken.short(point.wavelength_nm, 1))
    });
    let ends: Vec<String> = ends.collect();
    spoken.fill(
        "reading",
        &[
            ("quantity", titled(&curve.title, &curve.id, shown).into()),
            ("value", ends.join(" … ").into()),
        ],
    )
}

/// Symbols of CIELAB are the same in every language.
fn lab_words([l, a, b]: [f64; 3], spoken: Spoken) -> String {
    let [l, a, b] = [l, a, b].map(|v| spoken.number(v, COLOUR));
    format!("L* {l} · a* {a} · b* {b}")
}

fn titled<'t>(title: &'t Wording, id: &'t str, shown: &'t Shown) -> &'t str {
    shown
        .text(title)
        .filter(|title| !title.is_empty())
        .unwrap_or(id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{manifest::exhibit::SideName, wording::Wordings};

    const ALL_REASONS: [Why; 19] = [
        Why::OffSheet,
        Why::TooWide,
        Why::NoPicture,
        Why::NoHeight,
        Why::Unreadable,
        Why::Gone,
        Why::OnePlace,
        Why::CrossesItself,
        Why::NoArea,
        Why::NoStroke,
        Why::SeveralStrokes(2),
        Why::NoPaper,
        Why::Oblique(34.6),
        Why::TooLittle,
        Why::Coarse,
        Why::Small,
        Why::Covered,
        Why::Faint,
        Why::Nothing,
    ];

    fn notes() -> Vec<Note> {
        let file = || "maps/recto.png".to_owned();
        let source = |source| Note::NotMeasured {
            file: file(),
            source,
        };
        vec![
            Note::Unregistered { file: file() },
            source(Source::Fitted),
            source(Source::Assumed),
            Note::NoPicture {
                side: SideName::Verso,
                pointed: true,
            },
            Note::Stroke {
                file: file(),
                cuts: 24,
                spread_mm: 1.5,
            },
            Note::Lines { file: file() },
            Note::Colours { file: file() },
        ]
    }

    fn value(value: Option<f64>, sigma: Option<f64>, unit: &'static str) -> Value {
        Value {
            quantity: "length",
            value,
            sigma,
            unit,
            spread: None,
            count: None,
            none: None,
            why: None,
        }
    }

    #[test]
    fn numbers_are_written_as_the_language_does() {
        let wordings = Wordings::shipped();
        let said = |language, value: &Value| {
            measured(
                value,
                Spoken {
                    wordings: &wordings,
                    language,
                },
            )
        };
        let length = value(Some(1234.5678), Some(0.034), "mm");
        assert_eq!(said("en", &length), length.words());
        assert_eq!(said("de", &length), "1234,568 ± 0,034 mm");
        assert_eq!(said("ja", &length), "1234.568 ± 0.034 mm");
        let angle = value(Some(-3.25), Some(0.5), "°");
        assert_eq!(said("fr", &angle), "−3,25 ± 0,50°");
        assert_eq!(said("it", &value(Some(2.0), None, "mm²")), "2,000 mm²");
        assert_eq!(
            said("it", &value(Some(-0.0001), Some(0.1), "")),
            "0,00 ± 0,10"
        );
        assert_eq!(said("it", &value(None, None, "mm")), "–");
    }

    #[test]
    fn every_reason_and_every_note_is_said_in_every_language() {
        let wordings = Wordings::shipped();
        let all = |language: &str| -> Vec<String> {
            let spoken = Spoken {
                wordings: &wordings,
                language,
            };
            let reasons = ALL_REASONS.iter().map(|reason| failed(*reason, spoken));
            let notes = notes();
            let notes = notes.iter().map(|of| note(of, spoken));
            reasons.chain(notes).collect()
        };
        let english = all("en");
        for (k, said) in english.iter().enumerate() {
            assert!(!english[..k].contains(said), "{said} is said of two things");
        }
        for language in wordings.languages().filter(|tag| *tag != "en") {
            for (said, english) in all(language).iter().zip(&english) {
                assert_ne!(said, english, "{language}");
                // An id that nobody says would be said as it is.
                assert!(!said.contains("why-") && !said.contains("note-"), "{said}");
            }
        }
        assert!(all("de").iter().any(|said| said.contains("35°")));
        assert!(all("es").iter().any(|said| said.contains("1,5 mm")));
    }
}
