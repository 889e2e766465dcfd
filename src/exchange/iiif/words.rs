//! Language maps of IIIF ↔ wordings.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Map, Value, json};

use crate::manifest::{Pattern as _, Wording, normalised, raw::values::Language};

/// The key of texts in no language.
const NONE: &str = "none";
/// What texts in no language are taken for where there are others.
pub const FIRST: &str = "en";

/// A language map of a wording, or of `fallback` where it has no text.
pub fn map(wording: &Wording, fallback: &str) -> Value {
    if wording.0.is_empty() {
        return plain(fallback);
    }
    let entries = wording
        .0
        .iter()
        .map(|(tag, text)| (tag.clone(), json!([text])));
    Value::Object(entries.collect::<Map<_, _>>())
}

/// A language map of a text in no language.
pub fn plain(text: &str) -> Value {
    json!({ NONE: [text] })
}

/// A language map of a text in English.
pub fn english(text: &str) -> Value {
    json!({ "en": [text] })
}

/// The wording with ` (more)` behind each of its texts.
pub fn with(wording: &Wording, fallback: &str, more: &str) -> Value {
    let mut longer = wording.clone();
    longer
        .0
        .values_mut()
        .for_each(|text| *text = format!("{text}, {more}"));
    map(&longer, &format!("{fallback}, {more}"))
}

/// Texts by language, as another program wrote them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Texts(pub BTreeMap<String, String>);

impl Texts {
    /// Of a language map; what is none has no texts.
    pub fn of(value: Option<&Value>) -> Self {
        let mut texts = Self::default();
        for (tag, list) in value.and_then(Value::as_object).into_iter().flatten() {
            let lines = list
                .as_array()
                .into_iter()
                .flatten()
                .filter_map(Value::as_str);
            let lines: Vec<String> = lines
                .map(readable)
                .filter(|line| !line.is_empty())
                .collect();
            texts.add(tag, &lines.join("\n"));
        }
        texts
    }

    /// Adds a text in a language; a second one below the first.
    pub fn add(&mut self, tag: &str, text: &str) {
        let text = readable(text);
        // What a manifest refuses, such as `x-default`, is no language.
        let known = Language::from_text(tag).and_then(|tag| normalised(tag.as_str()).ok());
        let tag = known
            .filter(|tag| tag != NONE)
            .unwrap_or_else(|| NONE.to_owned());
        if text.is_empty() {
            return;
        }
        let own = self.0.entry(tag).or_default();
        if !own.is_empty() {
            own.push('\n');
        }
        own.push_str(&text);
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Any one text, for names.
    pub fn any(&self) -> Option<&str> {
        let english = self.0.get("en").or_else(|| self.0.values().next());
        english.map(String::as_str)
    }

    /// Each text changed.
    pub fn each(&self, change: impl Fn(&str) -> String) -> Self {
        let changed = self.0.iter().map(|(tag, text)| (tag.clone(), change(text)));
        Self(
            changed
                .filter(|(_, text)| !text.trim().is_empty())
                .collect(),
        )
    }

    /// Adds the languages that there are texts in.
    pub fn languages(&self, all: &mut BTreeSet<String>) {
        let tags = self.0.keys().map(|tag| match tag.as_str() {
            NONE => FIRST,
            tag => tag,
        });
        all.extend(tags.filter(|_| !self.is_plain()).map(str::to_owned));
    }

    /// Whether there is a text in no language alone.
    fn is_plain(&self) -> bool {
        self.0.keys().all(|tag| tag == NONE)
    }

    /// As a manifest's value.
    pub fn toml(&self) -> String {
        let mut texts = self.0.clone();
        if let Some(text) = texts.remove(NONE) {
            if texts.is_empty() {
                return toml::Value::from(text).to_string();
            }
            texts.entry(FIRST.to_owned()).or_insert(text);
        }
        let entries: Vec<String> = texts
            .into_iter()
            .map(|(tag, text)| format!("{tag} = {}", toml::Value::from(text)))
            .collect();
        format!("{{ {} }}", entries.join(", "))
    }
}

/// A text without the few tags of HTML that IIIF allows in it, and without control characters.
fn readable(text: &str) -> String {
    let text = text.trim();
    let bare = if text.starts_with('<') && text.ends_with('>') {
        let mut depth = 0_u32;
        let outside = text.chars().filter(|c| {
            match c {
                '<' => depth += 1,
                '>' => {
                    depth = depth.saturating_sub(1);
                    return false;
                }
                _ => {}
            }
            depth == 0
        });
        let bare: String = outside.collect();
        let entities = [
            ("&lt;", "<"),
            ("&gt;", ">"),
            ("&quot;", "\""),
            ("&#39;", "'"),
            ("&amp;", "&"),
        ];
        entities
            .iter()
            .fold(bare, |text, (entity, plain)| text.replace(entity, plain))
    } else {
        text.to_owned()
    };
    let plain = bare
        .chars()
        .map(|c| if c.is_control() && c != '\n' { ' ' } else { c });
    plain.collect::<String>().trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_come_through_and_tags_do_not() {
        let value = json!({ "en": ["One", "Two"], "none": ["<p>A &amp; <b>B</b></p>"], "it": [] });
        let texts = Texts::of(Some(&value));
        assert_eq!(texts.0["en"], "One\nTwo");
        assert_eq!(texts.0["none"], "A & B");
        assert_eq!(texts.0.len(), 2);
        assert_eq!(texts.toml(), "{ en = \"\"\"\nOne\nTwo\"\"\" }");
        assert_eq!(Texts::of(Some(&json!({ "x y": ["a"] }))).toml(), "\"a\"");
        assert!(Texts::of(Some(&json!(3))).is_empty());
        for tag in [
            "x-default",
            "i-klingon",
            "",
            "e",
            "en--US",
            "\u{201}\u{201}",
            "@none",
        ] {
            let texts = Texts::of(Some(&json!({ tag: ["a"] })));
            let mut languages = BTreeSet::new();
            texts.languages(&mut languages);
            assert!(languages.is_empty() && texts.any() == Some("a"), "{tag}");
        }
    }
}
