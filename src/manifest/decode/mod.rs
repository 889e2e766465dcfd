//! From the spanned tree to plain data, and the same declarations to a JSON Schema, so that what
//! an editor accepts and what the program accepts cannot drift apart.
//!
//! Decoding never stops at the first fault. A faulty optional value is left out after its fault
//! is recorded; a faulty element of a list leaves a hole in the [`List`], so that indices, and
//! with them the places of later faults, stay right.

mod collection;
mod kinds;
mod record;
mod rule;

use schemars::JsonSchema;
use toml::{Spanned, de::DeValue};

use super::{
    document::{At, Document, Trail, Words},
    fault::{Fault, Severity, quote},
};

pub use collection::{Brief, Dictionary, List, OneOrMany, Pattern};
pub use kinds::{Kinds, OfKind};
pub use record::{ObjectSchema, Record};
pub(crate) use record::{decode_record, optional, record_schema, required, table_to_add};
pub use rule::Rule;

/// A value of the tree and the way to it.
pub struct Node<'d> {
    value: &'d Spanned<DeValue<'d>>,
    trail: Trail,
}

impl<'d> Node<'d> {
    /// The whole document.
    pub(crate) fn root(document: &'d Document<'d>) -> Self {
        Self {
            value: document.root(),
            trail: Trail::default(),
        }
    }

    pub(crate) fn trail(&self) -> &Trail {
        &self.trail
    }

    pub(crate) fn text(&self) -> Option<&'d str> {
        self.value.get_ref().as_str()
    }

    /// The value of an integer or float; infinite where it is too large for either.
    pub(crate) fn number(&self) -> Option<f64> {
        match self.value.get_ref() {
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
            DeValue::Integer(integer) => Some(
                i128::from_str_radix(integer.as_str(), integer.radix())
                    .map_or(f64::INFINITY, |integer| integer as f64),
            ),
            DeValue::Float(float) => float.as_str().parse().ok(),
            _ => None,
        }
    }

    fn is_table(&self) -> bool {
        self.value.get_ref().is_table()
    }

    fn keys(&self) -> Vec<&'d str> {
        match self.value.get_ref() {
            DeValue::Table(table) => table.keys().map(|key| &**key.get_ref()).collect(),
            _ => Vec::new(),
        }
    }

    pub(crate) fn get(&self, key: &str) -> Option<Self> {
        let value = self.value.get_ref().get(key)?;
        Some(Self {
            value,
            trail: self.trail.key(key),
        })
    }

    fn elements(&self) -> Option<Vec<Self>> {
        let array = self.value.get_ref().as_array()?;
        let element = |(i, value)| Self {
            value,
            trail: self.trail.index(i),
        };
        Some(array.iter().enumerate().map(element).collect())
    }

    /// The value as a fault quotes it.
    pub(crate) fn found(&self) -> String {
        match self.value.get_ref() {
            DeValue::String(text) => quote(text),
            DeValue::Integer(integer) => shorten(integer.to_string()),
            DeValue::Float(float) => shorten(float.to_string()),
            DeValue::Boolean(boolean) => boolean.to_string(),
            DeValue::Datetime(datetime) => format!("the date {datetime}"),
            DeValue::Array(array) if array.len() == 1 => "an array of 1 value".to_owned(),
            DeValue::Array(array) => format!("an array of {} values", array.len()),
            DeValue::Table(_) => "a table".to_owned(),
        }
    }
}

fn shorten(number: String) -> String {
    const SHOWN: usize = 24;
    if number.len() <= SHOWN {
        return number;
    }
    format!("{}…", number.chars().take(SHOWN).collect::<String>())
}

/// How many faults are listed: more only hide the first ones.
const MOST_FAULTS: usize = 200;

/// Collects the faults of one document.
pub struct Report<'d> {
    document: &'d Document<'d>,
    faults: Vec<(Trail, Fault)>,
    /// Whether there were more than are listed.
    overflown: bool,
    /// Keys that a misspelt one probably stands for: they are not missing as well.
    meant: Vec<Trail>,
}

impl<'d> Report<'d> {
    pub(crate) fn new(document: &'d Document<'d>) -> Self {
        Self {
            document,
            faults: Vec::new(),
            overflown: false,
            meant: Vec::new(),
        }
    }

    pub(crate) fn into_faults(self) -> Vec<Fault> {
        let more = self.overflown.then(|| {
            let found = format!("more than {MOST_FAULTS} faults");
            Words::new(found, "none", "correct these first").of_file(self.document.file())
        });
        let faults = self.faults.into_iter().map(|(_, fault)| fault);
        more.into_iter().chain(faults).collect()
    }

    /// Whether as many faults are known as are listed, so that looking for more is idle.
    pub(crate) fn is_full(&self) -> bool {
        self.faults.len() >= MOST_FAULTS
    }

    /// Records that the value at `trail` is at fault, or that it is missing.
    pub(crate) fn fault(&mut self, trail: &Trail, words: Words) {
        self.record(trail, At::Value, Severity::Error, words);
    }

    /// Records that the value at `trail` is probably not what was meant.
    pub(crate) fn warn(&mut self, trail: &Trail, words: Words) {
        self.record(trail, At::Value, Severity::Warning, words);
    }

    /// Whether anything inside the value at `trail` is at fault, or its key is misspelt.
    pub(crate) fn faulty_within(&self, trail: &Trail) -> bool {
        // Of what is not listed the trail is not known.
        self.overflown
            || self.meant.iter().any(|place| trail.holds(place))
            || self
                .faults
                .iter()
                .any(|(place, fault)| fault.severity == Severity::Error && trail.holds(place))
    }

    /// How many faults there are so far, for [`Self::keep_written`].
    pub(crate) fn mark(&self) -> usize {
        self.faults.len()
    }

    /// Forgets the faults since `mark` that are about values which are not written where they
    /// were looked for.
    pub(crate) fn keep_written(&mut self, mark: usize) {
        let document = self.document;
        let mut position = 0;
        self.faults.retain(|(trail, _)| {
            position += 1;
            position <= mark || document.contains(trail)
        });
    }

    /// Records that `node` holds something that is not allowed there.
    fn refuse<T: Decode>(&mut self, node: &Node<'_>, remedy: impl Into<String>) {
        self.fault(&node.trail, Words::new(node.found(), T::allowed(), remedy));
    }

    fn record(&mut self, trail: &Trail, at: At, severity: Severity, words: Words) {
        if self.is_full() {
            self.overflown = true;
            return;
        }
        let fault = self.document.fault(trail, at, severity, words);
        self.faults.push((trail.clone(), fault));
    }
}

/// A value that a manifest can hold.
pub trait Decode: Sized + JsonSchema {
    /// What may be written, as the `allowed` part of a fault.
    fn allowed() -> String;

    /// `None` if the value is at fault, which is then in `report`.
    fn decode(node: &Node<'_>, report: &mut Report<'_>) -> Option<Self>;

    /// What to do where it is missing at `trail`, which ends in `key`.
    fn to_add(_trail: &Trail, key: &str) -> String {
        format!("add {key}")
    }
}

impl Decode for bool {
    fn allowed() -> String {
        "true or false".to_owned()
    }

    fn decode(node: &Node<'_>, report: &mut Report<'_>) -> Option<Self> {
        let DeValue::Boolean(value) = node.value.get_ref() else {
            report.refuse::<Self>(node, "write one of these words without quotes");
            return None;
        };
        Some(*value)
    }
}
