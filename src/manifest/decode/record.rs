//! Tables with known keys.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value};

use super::{
    super::{
        document::{At, Trail, Words},
        fault::{Severity, did_you_mean, nearest, quote},
    },
    Decode, Node, Report, Rule,
};

/// A table with known keys, as the `record!` macro declares it.
pub trait Record: Sized {
    /// All keys in the order of their declaration.
    const KEYS: &'static [&'static str];
    /// How many of them, from the first, have to be there.
    const REQUIRED: usize;
    const RULES: &'static [Rule];

    /// Decodes the values of the known keys, not looking for others.
    fn decode_fields(node: &Node<'_>, report: &mut Report<'_>) -> Option<Self>;

    /// Adds the schemas of the known keys.
    fn describe_fields(object: &mut ObjectSchema, generator: &mut SchemaGenerator);
}

/// Decodes a table whose only keys are those of `T`.
pub(crate) fn decode_record<T: Record + Decode>(
    node: &Node<'_>,
    report: &mut Report<'_>,
) -> Option<T> {
    if !node.is_table() {
        report.refuse::<T>(node, table_remedy(T::KEYS.first().unwrap_or(&"")));
        return None;
    }
    refuse_unknown_keys(node, T::KEYS, report);
    let fields = T::decode_fields(node, report);
    check_rules(node, T::RULES, report).and(fields)
}

/// As [`Decode::to_add`]: the table's header and the keys that it cannot be without.
pub(crate) fn table_to_add<T: Record>(trail: &Trail) -> String {
    let header = format!("add [{}]", trail.header());
    let required = T::KEYS[..T::REQUIRED].iter().map(|key| (*key).to_owned());
    let chosen = T::RULES.iter().filter_map(|rule| match rule {
        Rule::ExactlyOne(keys) => Some(keys.join(" or ")),
        _ => None,
    });
    let keys: Vec<String> = required.chain(chosen).collect();
    match keys.is_empty() {
        true => header,
        false => format!("{header} with {}", keys.join(", ")),
    }
}

pub(super) fn table_remedy(first_key: &str) -> String {
    format!("write a table, such as {{ {first_key} = … }}")
}

pub(super) fn check_rules(node: &Node<'_>, rules: &[Rule], report: &mut Report<'_>) -> Option<()> {
    // A misspelt or faulty key has said what is wrong already.
    if report.faulty_within(&node.trail) {
        return Some(());
    }
    for rule in rules {
        rule.check(node, report);
    }
    (!report.faulty_within(&node.trail)).then_some(())
}

pub(super) fn refuse_unknown_keys(node: &Node<'_>, known: &[&str], report: &mut Report<'_>) {
    for key in node.keys() {
        if known.contains(&key) {
            continue;
        }
        if report.is_full() {
            let words = Words::new("an unknown key", "", "");
            report.record(&node.trail, At::Key, Severity::Error, words);
            return;
        }
        let absent = || {
            known
                .iter()
                .copied()
                .filter(|known| node.get(known).is_none())
        };
        if let Some(meant) = nearest(key, absent()) {
            report.meant.push(node.trail.key(meant));
        }
        let words = Words::new(
            format!("the unknown key {}", quote(key)),
            known.join(", "),
            did_you_mean(key, absent(), "remove it"),
        );
        report.record(&node.trail.key(key), At::Key, Severity::Error, words);
    }
}

/// The value of a key that must be there.
pub(crate) fn required<T: Decode>(
    node: &Node<'_>,
    key: &str,
    report: &mut Report<'_>,
) -> Option<T> {
    match node.get(key) {
        Some(child) => T::decode(&child, report),
        None => {
            let trail = node.trail.key(key);
            if !report.meant.contains(&trail) {
                let remedy = T::to_add(&trail, key);
                report.fault(&trail, Words::new("nothing", T::allowed(), remedy));
            }
            None
        }
    }
}

/// The value of a key that may be there.
pub(crate) fn optional<T: Decode>(
    node: &Node<'_>,
    key: &str,
    report: &mut Report<'_>,
) -> Option<T> {
    node.get(key).and_then(|child| T::decode(&child, report))
}

/// The JSON Schema of a table in the making.
#[derive(Default)]
pub struct ObjectSchema {
    properties: Map<String, Value>,
    required: Vec<Value>,
    rules: Vec<Value>,
}

impl ObjectSchema {
    pub(crate) fn field<T: JsonSchema>(
        &mut self,
        key: &str,
        docs: &[&str],
        required: bool,
        generator: &mut SchemaGenerator,
    ) {
        let mut schema = generator.subschema_for::<T>();
        schema.insert("description".to_owned(), description(docs).into());
        self.property(key, schema.to_value(), required);
    }

    pub(super) fn property(&mut self, key: &str, schema: Value, required: bool) {
        self.properties.insert(key.to_owned(), schema);
        if required {
            self.required.push(key.into());
        }
    }

    pub(crate) fn rules(&mut self, rules: &[Rule]) {
        self.rules.extend(rules.iter().map(|rule| rule.schema()));
    }

    pub(crate) fn finish(self, description: String) -> Schema {
        let mut schema = json_schema!({
            "type": "object",
            "description": description,
            "properties": self.properties,
            "additionalProperties": false,
        });
        if !self.required.is_empty() {
            schema.insert("required".to_owned(), self.required.into());
        }
        if !self.rules.is_empty() {
            schema.insert("allOf".to_owned(), self.rules.into());
        }
        schema
    }
}

/// The lines of a doc comment as one paragraph, without the marks of rustdoc.
pub(crate) fn description(docs: &[&str]) -> String {
    let lines: Vec<_> = docs.iter().map(|line| line.trim()).collect();
    lines.join(" ").replace('`', "")
}

/// The schema of a record by itself.
pub(crate) fn record_schema<T: Record>(docs: &[&str], generator: &mut SchemaGenerator) -> Schema {
    let mut object = ObjectSchema::default();
    T::describe_fields(&mut object, generator);
    object.rules(T::RULES);
    object.finish(description(docs))
}
