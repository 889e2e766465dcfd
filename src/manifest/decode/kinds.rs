//! Tables whose keys depend on their kind.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;

use super::{
    super::{
        document::Words,
        fault::{did_you_mean, quoted_list},
    },
    Decode, Node, Record, Report, Rule,
    record::{ObjectSchema, check_rules, description, refuse_unknown_keys, table_remedy},
};

/// The kinds of something, each with keys of its own, as the `kinds!` macro declares them.
pub trait Kinds: Sized {
    /// The word of each kind and what it is.
    const WORDS: &'static [(&'static str, &'static [&'static str])];

    /// The keys of a kind; none for an unknown word.
    fn keys(word: &str) -> &'static [&'static str];
    fn rules(word: &str) -> &'static [Rule];
    fn decode_fields(word: &str, node: &Node<'_>, report: &mut Report<'_>) -> Option<Self>;
    fn describe_fields(word: &str, object: &mut ObjectSchema, generator: &mut SchemaGenerator);
}

/// A table with some keys in common and others that depend on its `kind`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OfKind<C, K> {
    #[serde(flatten)]
    pub common: C,
    #[serde(flatten)]
    pub kind: K,
}

/// The key that tells the kind.
const KIND: &str = "kind";

impl<C: Record + JsonSchema, K: Kinds> Decode for OfKind<C, K> {
    fn allowed() -> String {
        format!(
            "a table with kind = {}",
            quoted_list(K::WORDS.iter().map(|(word, _)| *word))
        )
    }

    fn decode(node: &Node<'_>, report: &mut Report<'_>) -> Option<Self> {
        if !node.is_table() {
            report.refuse::<Self>(node, table_remedy(KIND));
            return None;
        }
        let words = || K::WORDS.iter().map(|(word, _)| *word);
        let trail = node.trail.key(KIND);
        let kind = node.get(KIND);
        let word = kind
            .as_ref()
            .and_then(Node::text)
            .filter(|word| words().any(|w| w == *word));
        let Some(word) = word else {
            let (found, remedy) = match &kind {
                None => ("nothing".to_owned(), format!("add {KIND}")),
                Some(kind) => {
                    let text = kind.text().unwrap_or_default();
                    (
                        kind.found(),
                        did_you_mean(text, words(), "write one of these words"),
                    )
                }
            };
            report.fault(&trail, Words::new(found, quoted_list(words()), remedy));
            // Which other keys are known depends on the kind: only the common ones are read.
            C::decode_fields(node, report);
            return None;
        };
        let keys: Vec<&str> = [KIND]
            .iter()
            .chain(C::KEYS)
            .chain(K::keys(word))
            .copied()
            .collect();
        refuse_unknown_keys(node, &keys, report);
        let common = C::decode_fields(node, report);
        let kind = K::decode_fields(word, node, report);
        let rules: Vec<Rule> = C::RULES.iter().chain(K::rules(word)).copied().collect();
        check_rules(node, &rules, report)?;
        Some(Self {
            common: common?,
            kind: kind?,
        })
    }
}

impl<C: Record + JsonSchema, K: Kinds> JsonSchema for OfKind<C, K> {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        C::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let kinds: Vec<Schema> = K::WORDS
            .iter()
            .map(|(word, docs)| {
                let mut object = ObjectSchema::default();
                object.property(
                    KIND,
                    serde_json::json!({ "const": word, "description": description(docs) }),
                    true,
                );
                C::describe_fields(&mut object, generator);
                K::describe_fields(word, &mut object, generator);
                object.rules(C::RULES);
                object.rules(K::rules(word));
                object.finish(description(docs))
            })
            .collect();
        json_schema!({ "oneOf": kinds })
    }
}
