//! Arrays, tables with free keys, and values that can be written in two ways.

use std::collections::BTreeMap;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Serialize, Serializer, ser::SerializeMap};

use super::{
    super::{
        document::{At, Words},
        fault::{Severity, quote},
    },
    Decode, Node, Report,
};

/// An array of `MIN` to `MAX` values.
#[derive(Clone, Debug, PartialEq)]
pub struct List<T, const MIN: usize = 0, const MAX: usize = { usize::MAX }>(Vec<Option<T>>);

impl<T, const MIN: usize, const MAX: usize> List<T, MIN, MAX> {
    /// The values that are not at fault, each with its index.
    pub fn iter(&self) -> impl Iterator<Item = (usize, &T)> {
        self.0
            .iter()
            .enumerate()
            .filter_map(|(i, value)| Some((i, value.as_ref()?)))
    }

    /// The element with this index, unless it is at fault.
    pub(crate) fn get(&self, index: usize) -> Option<&T> {
        self.0.get(index)?.as_ref()
    }

    /// How many there are, those at fault included.
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// Adds an element behind the others.
    pub(crate) fn push(&mut self, value: T) {
        self.0.push(Some(value));
    }

    /// Whether elements were left out because they are at fault.
    pub(crate) fn has_holes(&self) -> bool {
        self.0.iter().any(Option::is_none)
    }
}

impl<T, const MIN: usize, const MAX: usize> FromIterator<T> for List<T, MIN, MAX> {
    fn from_iter<I: IntoIterator<Item = T>>(values: I) -> Self {
        Self(values.into_iter().map(Some).collect())
    }
}

impl<T: Serialize, const MIN: usize, const MAX: usize> Serialize for List<T, MIN, MAX> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.iter().flatten())
    }
}

impl<T: Decode, const MIN: usize, const MAX: usize> Decode for List<T, MIN, MAX> {
    fn allowed() -> String {
        let count = match (MIN, MAX) {
            (0, usize::MAX) => "an array".to_owned(),
            (_, usize::MAX) => format!("an array of {MIN} or more"),
            _ => format!("an array of {MIN} to {MAX}"),
        };
        format!("{count}, each {}", T::allowed())
    }

    fn decode(node: &Node<'_>, report: &mut Report<'_>) -> Option<Self> {
        let Some(elements) = node.elements() else {
            let remedy = if node.is_table() {
                format!(
                    "write [[{}]] above it, with two brackets",
                    node.trail.header()
                )
            } else if MIN == 0 {
                "put it in square brackets; [] is none".to_owned()
            } else {
                "put it in square brackets".to_owned()
            };
            report.refuse::<Self>(node, remedy);
            return None;
        };
        if !(MIN..=MAX).contains(&elements.len()) {
            report.refuse::<Self>(node, "add or remove values");
            return None;
        }
        Some(Self(
            elements
                .iter()
                .map(|element| T::decode(element, report))
                .collect(),
        ))
    }
}

impl<T: JsonSchema, const MIN: usize, const MAX: usize> JsonSchema for List<T, MIN, MAX> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        format!("List_of_{}", T::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut schema = json_schema!({ "type": "array", "items": generator.subschema_for::<T>() });
        if MIN > 0 {
            schema.insert("minItems".to_owned(), MIN.into());
        }
        if MAX < usize::MAX {
            schema.insert("maxItems".to_owned(), MAX.into());
        }
        schema
    }
}

impl<T: Decode, const N: usize> Decode for [T; N]
where
    [T; N]: JsonSchema,
{
    fn allowed() -> String {
        format!("an array of {N}, each {}", T::allowed())
    }

    fn decode(node: &Node<'_>, report: &mut Report<'_>) -> Option<Self> {
        let Some(elements) = node.elements().filter(|elements| elements.len() == N) else {
            report.refuse::<Self>(node, format!("write {N} values in square brackets"));
            return None;
        };
        // All elements are decoded before any is found missing, so that each fault is recorded.
        let values: Vec<Option<T>> = elements
            .iter()
            .map(|element| T::decode(element, report))
            .collect();
        let values: Option<Vec<T>> = values.into_iter().collect();
        values?.try_into().ok()
    }
}

/// Something written in short as one text, or in full as a table.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Brief<S, F> {
    Short(S),
    Full(F),
}

impl<S: Decode, F: Decode> Decode for Brief<S, F> {
    fn allowed() -> String {
        format!("{}, or {}", S::allowed(), F::allowed())
    }

    fn decode(node: &Node<'_>, report: &mut Report<'_>) -> Option<Self> {
        if node.text().is_some() {
            S::decode(node, report).map(Self::Short)
        } else if node.is_table() {
            F::decode(node, report).map(Self::Full)
        } else {
            report.refuse::<Self>(
                node,
                "write a text in quotation marks, or a table in braces",
            );
            None
        }
    }
}

impl<S: JsonSchema, F: JsonSchema> JsonSchema for Brief<S, F> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        format!("{}_or_{}", S::schema_name(), F::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "anyOf": [generator.subschema_for::<S>(), generator.subschema_for::<F>()],
        })
    }
}

/// One table, or an array of them where there are several.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum OneOrMany<T> {
    One(T),
    Many(List<T, 1>),
}

impl<T: Decode> Decode for OneOrMany<T> {
    fn allowed() -> String {
        format!("{}, or an array of them", T::allowed())
    }

    fn decode(node: &Node<'_>, report: &mut Report<'_>) -> Option<Self> {
        if node.is_table() {
            T::decode(node, report).map(Self::One)
        } else {
            List::decode(node, report).map(Self::Many)
        }
    }
}

impl<T: JsonSchema> JsonSchema for OneOrMany<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        format!("One_or_many_{}", T::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "anyOf": [generator.subschema_for::<T>(), generator.subschema_for::<List<T, 1>>()],
        })
    }
}

/// A text of a fixed form, as the `pattern!` macro declares it.
pub trait Pattern: Sized + Ord {
    /// As a regular expression of JSON Schema.
    const PATTERN: &'static str;
    /// What it is, in words.
    const ALLOWED: &'static str;
    /// How to correct it.
    const REMEDY: &'static str;

    /// `None` if the text does not match.
    fn from_text(text: &str) -> Option<Self>;

    fn as_str(&self) -> &str;
}

/// A table with keys of the curator's choice, 1 to `MAX` of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Dictionary<K, V, const MAX: usize = { usize::MAX }>(pub BTreeMap<K, V>);

impl<K: Pattern, V: Serialize, const MAX: usize> Serialize for Dictionary<K, V, MAX> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (key, value) in &self.0 {
            map.serialize_entry(key.as_str(), value)?;
        }
        map.end()
    }
}

impl<K: Pattern, V: Decode, const MAX: usize> Decode for Dictionary<K, V, MAX> {
    fn allowed() -> String {
        let count = match MAX {
            usize::MAX => String::new(),
            _ => format!("up to {MAX} "),
        };
        format!("a table of {count}{} with {}", K::ALLOWED, V::allowed())
    }

    fn decode(node: &Node<'_>, report: &mut Report<'_>) -> Option<Self> {
        let count = node.keys().len();
        if !node.is_table() || count == 0 {
            report.refuse::<Self>(node, "write one or more entries in braces");
            return None;
        }
        if count > MAX {
            let words = Words::new(
                format!("a table of {count} entries"),
                Self::allowed(),
                "split it into several",
            );
            report.fault(&node.trail, words);
            return None;
        }
        let mut entries = BTreeMap::new();
        for name in node.keys() {
            let key = K::from_text(name);
            if key.is_none() {
                let words = Words::new(format!("the key {}", quote(name)), K::ALLOWED, K::REMEDY);
                report.record(&node.trail.key(name), At::Key, Severity::Error, words);
            }
            let value = node.get(name).and_then(|child| V::decode(&child, report));
            entries.extend(key.zip(value));
        }
        Some(Self(entries))
    }
}

impl<K: Pattern, V: JsonSchema, const MAX: usize> JsonSchema for Dictionary<K, V, MAX> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        format!("Dictionary_of_{}", V::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut schema = json_schema!({
            "type": "object",
            "minProperties": 1,
            "patternProperties": { K::PATTERN: generator.subschema_for::<V>() },
            "additionalProperties": false,
        });
        if MAX < usize::MAX {
            schema.insert("maxProperties".to_owned(), MAX.into());
        }
        schema
    }
}
