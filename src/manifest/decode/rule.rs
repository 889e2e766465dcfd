//! What the keys of one table demand of each other.

use serde_json::Value;

use super::{
    super::{
        document::Words,
        fault::{quote, quoted_list},
    },
    Node, Report,
};

/// What the keys of one table demand of each other.
#[derive(Clone, Copy, Debug)]
pub enum Rule {
    /// One of the keys is there, no two are.
    ExactlyOne(&'static [&'static str]),
    /// No two of the keys are there.
    AtMostOne(&'static [&'static str]),
    /// One or more of the keys are there.
    AtLeastOne(&'static [&'static str]),
    /// The first key is only there with the second.
    Needs(&'static str, &'static str),
    /// The first key is only there where the second is one of these words.
    OnlyWith(&'static str, &'static str, &'static [&'static str]),
}

impl Rule {
    pub(super) fn check(self, node: &Node<'_>, report: &mut Report<'_>) {
        let trail = match self {
            Self::OnlyWith(key, ..) => node.trail.key(key),
            _ => node.trail.clone(),
        };
        let present = |keys: &[&'static str]| -> Vec<&'static str> {
            keys.iter()
                .copied()
                .filter(|key| node.get(key).is_some())
                .collect()
        };
        let (found, allowed, remedy) = match self {
            Self::ExactlyOne(keys) | Self::AtMostOne(keys) if present(keys).len() > 1 => (
                format!("{} together", quoted_and(&present(keys))),
                format!("one of {}", quoted_list(keys.iter().copied())),
                format!("keep {}", quoted_list(present(keys))),
            ),
            Self::ExactlyOne(keys) | Self::AtLeastOne(keys) if present(keys).is_empty() => (
                format!("none of {}", quoted_list(keys.iter().copied())),
                if matches!(self, Self::ExactlyOne(_)) {
                    "exactly one of them".to_owned()
                } else {
                    "one or more of them".to_owned()
                },
                "add the one that you know".to_owned(),
            ),
            Self::Needs(key, other) if node.get(key).is_some() && node.get(other).is_none() => (
                format!("\"{key}\" without \"{other}\""),
                "both together".to_owned(),
                format!("add \"{other}\""),
            ),
            Self::OnlyWith(key, other, words) if node.get(key).is_some() => {
                match node.get(other).and_then(|node| node.text()) {
                    Some(word) if !words.contains(&word) => (
                        format!("a key that {other} {} does not use", quote(word)),
                        format!("it with {}", quoted_list(words.iter().copied())),
                        "remove it".to_owned(),
                    ),
                    _ => return,
                }
            }
            _ => return,
        };
        report.fault(&trail, Words::new(found, allowed, remedy));
    }

    /// The rule as a JSON Schema of any draft.
    pub(super) fn schema(self) -> Value {
        let has = |key: &str| serde_json::json!({ "required": [key] });
        let each = |keys: &[&str]| keys.iter().map(|key| has(key)).collect::<Vec<_>>();
        let lacks = |key: &str| serde_json::json!({ "not": has(key) });
        match self {
            Self::ExactlyOne(keys) => serde_json::json!({ "oneOf": each(keys) }),
            Self::AtLeastOne(keys) => serde_json::json!({ "anyOf": each(keys) }),
            Self::AtMostOne(keys) => {
                let mut choices = each(keys);
                choices.push(serde_json::json!({ "not": { "anyOf": each(keys) } }));
                serde_json::json!({ "oneOf": choices })
            }
            Self::Needs(key, other) => serde_json::json!({ "anyOf": [lacks(key), has(other)] }),
            Self::OnlyWith(key, other, words) => serde_json::json!({
                "anyOf": [lacks(key), { "properties": { other: {
                    "enum": words,
                    "description": format!("What goes with {key}."),
                } } }],
            }),
        }
    }
}

fn quoted_and(words: &[&str]) -> String {
    let words: Vec<_> = words.iter().map(|word| format!("\"{word}\"")).collect();
    words.join(" and ")
}
