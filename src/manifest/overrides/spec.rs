//! What options of a command say, as values of a manifest that go through its own decoding and
//! validation: the format is declared once.

use std::path::Path;

use toml::{Table, Value};

use super::super::{
    Fault, Severity,
    decode::{Decode, List, Node, Report, optional},
    document::Document,
    exhibit::Exhibit,
    quote,
    raw::RawManifest,
    validate,
};

/// The parts of `key=value,key=value`, split at commas that no bracket or quotation mark holds.
pub fn parts(spec: &str) -> impl Iterator<Item = &str> {
    let mut depth = 0_u32;
    let mut quoted = false;
    spec.split(move |c: char| {
        match c {
            '"' => quoted = !quoted,
            '[' | '{' if !quoted => depth += 1,
            ']' | '}' if !quoted => depth = depth.saturating_sub(1),
            _ => {}
        }
        c == ',' && depth == 0 && !quoted
    })
    .map(str::trim)
}

/// The table that `parts`, each `key=value` such as `example`, stand for.
pub fn table<'s>(
    option: &str,
    example: &str,
    parts: impl IntoIterator<Item = &'s str>,
) -> Result<Table, Vec<Fault>> {
    let mut table = Table::new();
    let mut faults = Vec::new();
    for part in parts {
        let Some((key, text)) = part.split_once('=') else {
            let found = match part {
                "" => "nothing".to_owned(),
                part => quote(part),
            };
            let remedy = format!("write the keys that the manifest has, such as {example}");
            faults.push(unreadable(option, found, "key=value,key=value…", remedy));
            continue;
        };
        if table.insert(key.trim().to_owned(), value(text)).is_some() {
            let found = format!("{} a second time", quote(key));
            faults.push(unreadable(
                option,
                found,
                "each key once",
                "remove one of the two",
            ));
        }
    }
    if faults.is_empty() {
        Ok(table)
    } else {
        Err(faults)
    }
}

/// A value as TOML writes it, or `92x60` for an array of numbers, or else a text that needs no
/// quotation marks.
pub fn value(text: &str) -> Value {
    let text = text.trim();
    let numbers: Option<Vec<f64>> = text.split('x').map(|part| part.parse().ok()).collect();
    match numbers {
        Some(numbers) if numbers.len() > 1 => numbers.into(),
        // A fraction as people write it, which TOML wants a 0 before.
        _ if text.trim_start_matches(['-', '+']).starts_with('.') => text
            .parse::<f64>()
            .map_or_else(|_| Value::from(text), Value::from),
        _ => text.parse().unwrap_or_else(|_| Value::from(text)),
    }
}

/// Decodes a value as the manifest would.
pub fn decode<T: Decode>(option: &str, value: Value) -> Result<T, Vec<Fault>> {
    const KEY: &str = "value";
    read(KEY, value, |root, report| {
        root.get(KEY).and_then(|node| T::decode(&node, report))
    })
    .map_err(|found| relabelled(found, KEY, option, true))
}

/// Validates a manifest that has nothing but `value` at `key`, in the folder of `exhibit`. Faults
/// at `place` in it become those of `option`.
pub fn validated(
    option: &str,
    key: &str,
    value: Value,
    place: &str,
    exhibit: &Exhibit,
) -> Result<Exhibit, Vec<Fault>> {
    let mut is_read = false;
    read(key, value, |root, report| {
        let raw = RawManifest {
            drawing: List::from_iter([]),
            exhibit: optional(root, "exhibit", report),
            lamp: optional(root, "lamp", report),
            medium: None,
            scene: None,
            tour: None,
            accuracy: None,
        };
        is_read = report.mark() == 0;
        validate::exhibit(&raw, &exhibit.manifest, &exhibit.folder, report)
    })
    .map_err(|found| relabelled(found, place, option, !is_read))
}

fn read<T>(
    key: &str,
    value: Value,
    read: impl FnOnce(&Node<'_>, &mut Report<'_>) -> Option<T>,
) -> Result<T, Vec<Fault>> {
    let document = Table::from_iter([(key.to_owned(), value)]);
    let text = toml::to_string(&document)
        .map_err(|error| vec![fault(key, error.to_string(), "values of a manifest", "")])?;
    let document = Document::parse(Path::new(""), &text)
        .map_err(|faults| faults.into_iter().collect::<Vec<_>>())?;
    let mut report = Report::new(&document);
    let read = read(&Node::root(&document), &mut report);
    let mut faults = report.into_faults();
    faults.retain(|fault| fault.severity == Severity::Error);
    match read {
        Some(read) if faults.is_empty() => Ok(read),
        _ => Err(faults),
    }
}

/// Faults within `place` as faults of `option`, which has no file.
fn relabelled(mut faults: Vec<Fault>, place: &str, option: &str, unreadable: bool) -> Vec<Fault> {
    for fault in &mut faults {
        fault.unreadable = unreadable;
        fault.file = None;
        fault.place = None;
        if let Some(rest) = fault.path.strip_prefix(place) {
            fault.path = format!("{option}{rest}");
        }
    }
    faults
}

/// A fault of the option `path` whose value cannot be read.
pub fn unreadable(
    path: &str,
    found: impl Into<String>,
    allowed: impl Into<String>,
    remedy: impl Into<String>,
) -> Fault {
    Fault {
        unreadable: true,
        ..fault(path, found, allowed, remedy)
    }
}

/// A fault of the option `path`.
pub fn fault(
    path: &str,
    found: impl Into<String>,
    allowed: impl Into<String>,
    remedy: impl Into<String>,
) -> Fault {
    Fault {
        severity: Severity::Error,
        file: None,
        place: None,
        path: path.to_owned(),
        found: found.into(),
        allowed: allowed.into(),
        remedy: remedy.into(),
        unreadable: false,
    }
}
