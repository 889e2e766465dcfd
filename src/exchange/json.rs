//! JSON that another program wrote: read within bounds, and told back by the key at fault.

use std::{
    fs::File,
    io::{self, Read as _},
    path::Path,
};

use serde_json::Value;

use super::{
    ExchangeError,
    error::{Faulty, whole_file},
};
use crate::manifest::{document::Words, quote};

/// What descriptions of pictures stay below.
const MOST_BYTES: u64 = 64 << 20;

/// Reads a file whole, if it is not larger than descriptions are.
///
/// # Errors
/// One fault.
pub fn bytes(file: &Path) -> Result<Vec<u8>, ExchangeError> {
    let refused = |found: String, allowed: &str, remedy: &str| {
        whole_file(file, Words::new(found, allowed, remedy))
    };
    let unreadable = |error: io::Error| match error.kind() {
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => refused(
            "no such file".to_owned(),
            "a file that exists",
            "check the path",
        ),
        _ => refused(
            format!("a file that cannot be read ({error})"),
            "a readable file",
            "check its permissions",
        ),
    };
    if file.is_dir() {
        return Err(refused(
            "a folder without an info.json or manifest.json".to_owned(),
            "a file",
            "name the file itself",
        ));
    }
    let opened = File::open(file).map_err(unreadable)?;
    let mut bytes = Vec::new();
    let read = opened.take(MOST_BYTES + 1).read_to_end(&mut bytes);
    read.map_err(unreadable)?;
    if bytes.len() as u64 > MOST_BYTES {
        let found = format!("a file of more than {MOST_BYTES} bytes");
        return Err(refused(
            found,
            "a description of pictures, with the pictures in files of their own",
            "check that it is the right file",
        ));
    }
    Ok(bytes)
}

/// Parses the JSON of a file.
///
/// # Errors
/// One fault, with line and column.
pub fn parse(file: &Path, bytes: &[u8]) -> Result<Value, ExchangeError> {
    let text = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
    serde_json::from_slice(text).map_err(|error| {
        let remedy = match error.to_string() {
            words if words.contains("recursion") => {
                "no such file needs more than a hundred levels; look for an unclosed bracket"
            }
            _ if error.is_eof() => "it ends too early; export or copy it again",
            _ => "export or copy it again",
        };
        let found = format!("text that is not JSON ({error})");
        whole_file(file, Words::new(found, "JSON", remedy))
    })
}

/// What a value is, for a message.
pub fn found(value: Option<&Value>) -> String {
    match value {
        None => "nothing".to_owned(),
        Some(Value::String(text)) => quote(text),
        Some(Value::Array(list)) => format!("a list of {}", list.len()),
        Some(Value::Object(_)) => "an object".to_owned(),
        Some(other) => other.to_string(),
    }
}

/// A whole number of `object` within a range.
pub fn whole(
    object: &Value,
    key: &str,
    range: std::ops::RangeInclusive<u64>,
    faulty: &mut Faulty<'_>,
) -> Option<u64> {
    let value = object.get(key);
    let number = value
        .and_then(Value::as_u64)
        .filter(|number| range.contains(number));
    if number.is_none() {
        let allowed = format!("a whole number from {} to {}", range.start(), range.end());
        let remedy = "export it again, or correct this number";
        faulty.fault(key, Words::new(found(value), allowed, remedy));
    }
    number
}

/// A list of `count` numbers in `object`, whose own key is `within`.
pub fn numbers(
    object: &Value,
    within: &str,
    key: &str,
    count: usize,
    faulty: &mut Faulty<'_>,
) -> Option<Vec<f64>> {
    let value = object.get(key);
    let list = value.and_then(Value::as_array);
    let list: Option<Vec<f64>> = list
        .filter(|list| list.len() == count)
        .and_then(|list| list.iter().map(Value::as_f64).collect());
    if list.is_none() {
        let allowed = format!("a list of {count} numbers");
        let remedy = "one for each plane; export it again";
        let path = match within {
            "" => key.to_owned(),
            within => format!("{within}.{key}"),
        };
        faulty.fault(path, Words::new(found(value), allowed, remedy));
    }
    list
}
