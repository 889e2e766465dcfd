//! Readings as a table.

use std::fmt::Write as _;

use super::Reading;

/// A row for each value of numbered readings, and for each place of a profile with its distance from
/// the start in `s_mm`. A remark says why there is no value, or else what is to be known of it. The marks of RFC 4180: what holds commas stands in quotation marks.
pub fn csv<'r>(readings: impl IntoIterator<Item = (usize, &'r Reading)>) -> String {
    let mut text =
        "reading,tool,places_mm,quantity,s_mm,value,sigma,unit,spread,count,remark,drawing,side,state\r\n"
            .to_owned();
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    for (place, reading) in readings {
        let places: Vec<String> = reading
            .places_mm
            .iter()
            .map(|[x, y]| format!("{x},{y}"))
            .collect();
        let start = format!("{place},{},{}", reading.tool, quoted(&places.join(":")));
        let on = [
            &reading.drawing,
            reading.side.word(),
            reading.state.as_deref().unwrap_or_default(),
        ]
        .map(quoted)
        .join(",");
        let notes: Vec<String> = reading.notes.iter().map(ToString::to_string).collect();
        let notes = notes.join("; ");
        for value in &reading.values {
            // Writing into a text does not fail.
            let _ = write!(
                text,
                "{start},{},,{},{},{},{},{},{},{on}\r\n",
                quoted(value.quantity),
                number(value.value),
                number(value.sigma),
                value.unit,
                number(value.spread),
                value
                    .count
                    .map_or_else(String::new, |count| count.to_string()),
                quoted(value.none.as_ref().unwrap_or(&notes)),
            );
        }
        for sample in &reading.samples {
            let _ = write!(
                text,
                "{start},\"height\",{},{},{},µm,,,\"\",{on}\r\n",
                sample.s_mm, sample.z_um, sample.sigma_um
            );
        }
    }
    text
}
