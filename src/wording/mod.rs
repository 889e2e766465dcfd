//! What the program says on the screen, in every language: Fluent messages that are part of the
//! program, and those of the museum before them.
//!
//! | what | where |
//! |---|---|
//! | shipped languages, ids, which of them label buttons | [`catalogue`] |
//! | a message in a language, or as near to it as there is | [`Wordings::say`] |
//! | the museum's folder, with all its faults | [`Wordings::read`] |
//! | ids and variables of a file, with their places | `source` |
//! | which way a language is written, and its numbers | [`direction`], [`number`] |
//! | all of this in one language | [`Spoken`] |
//! | which font files have its letters | [`fonts`] |
//!
//! What an exhibit says is written in its manifest; messages for the curator and the technician
//! are English and not here.

pub mod catalogue;
pub mod fonts;
mod museum;
mod source;

use std::{
    borrow::Cow,
    collections::{BTreeSet, HashMap},
    fmt,
    path::Path,
};

use fluent_bundle::{FluentArgs, FluentResource, FluentValue, concurrent::FluentBundle};
use unic_langid::LanguageIdentifier;

use crate::manifest::{Fault, Faults};
use catalogue::SHIPPED;

/// The language of whoever asked for none, and of what is said in no other.
pub const FALLBACK: &str = "en";
/// A language's name in itself; the one message that no other language stands in for.
const LANGUAGE_NAME: &str = "language-name";

/// Encloses what has a direction of its own (FIRST STRONG ISOLATE, POP DIRECTIONAL ISOLATE).
const ISOLATED: [char; 2] = ['\u{2068}', '\u{2069}'];
/// Begins a line from the right (RIGHT-TO-LEFT MARK).
const RIGHT_TO_LEFT: char = '\u{200f}';

/// Which way a language is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Direction {
    #[default]
    LeftToRight,
    RightToLeft,
}

/// What is put in the place of a variable.
#[derive(Clone, Debug, PartialEq)]
pub enum Value<'v> {
    /// Written with six decimals at most, and as few as tell it from others: round it first.
    Number(f64),
    Text(Cow<'v, str>),
}

impl Value<'_> {
    fn filled(&self) -> FluentValue<'_> {
        /// The plural rules panic at numbers with more digits than this and the decimals have.
        const MOST: f64 = 1e12;
        const DECIMALS: f64 = 1e6;
        match self {
            Self::Number(number) if number.abs() < MOST => {
                FluentValue::from((number * DECIMALS).round() / DECIMALS)
            }
            Self::Number(number) => FluentValue::from(number.to_string()),
            Self::Text(text) => FluentValue::from(text.as_ref()),
        }
    }
}

impl From<f64> for Value<'_> {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<u32> for Value<'_> {
    fn from(number: u32) -> Self {
        Self::Number(f64::from(number))
    }
}

impl<'v> From<&'v str> for Value<'v> {
    fn from(text: &'v str) -> Self {
        Self::Text(text.into())
    }
}

impl From<String> for Value<'_> {
    fn from(text: String) -> Self {
        Self::Text(text.into())
    }
}

/// Every wording of the program, in all its languages.
#[derive(Debug)]
pub struct Wordings {
    /// The shipped ones in their order, then the museum's own by their tags.
    languages: Vec<Language>,
}

impl Default for Wordings {
    fn default() -> Self {
        Self::shipped()
    }
}

impl Wordings {
    /// What the program comes with.
    pub fn shipped() -> Self {
        let languages = SHIPPED
            .iter()
            .filter_map(|(tag, text)| Language::new(tag, [*text]));
        Self {
            languages: languages.collect(),
        }
    }

    /// What the program comes with in English alone, for the command line.
    pub fn english() -> Self {
        let [(tag, text), ..] = SHIPPED;
        Self {
            languages: Language::new(tag, [text]).into_iter().collect(),
        }
    }

    /// What the program comes with, with the messages of a museum's `folder` before it: a file
    /// `LANGUAGE.ftl` for each language, which may be one that the program does not come with and may
    /// have some of the messages only. Returned with warnings.
    ///
    /// # Errors
    /// All faults of all files, warnings included.
    pub fn read(folder: Option<&Path>) -> Result<(Self, Vec<Fault>), Faults> {
        match folder {
            Some(folder) => museum::read(folder),
            None => Ok((Self::shipped(), Vec::new())),
        }
    }

    /// As [`Self::read`].
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn with_folder(folder: &Path) -> Result<(Self, Vec<Fault>), Faults> {
        museum::read(folder)
    }

    /// The tags of all languages (BCP 47), English first.
    pub fn languages(&self) -> impl Iterator<Item = &str> {
        self.languages.iter().map(|language| language.tag.as_str())
    }

    /// Message `id` with its variables filled in, in `language` (a tag by any case, `de-AT`), or in what
    /// it derives from (`de`), or in English; an id that nobody knows is said as it is.
    ///
    /// Free of marks that isolate directions, except in scripts from right to left.
    pub fn say(&self, language: &str, id: &str, args: &[(&str, Value)]) -> String {
        self.chain(language)
            .find_map(|language| language.say(id, args))
            .map_or_else(|| id.to_owned(), Cow::into_owned)
    }

    /// As [`Self::say`] for a message without variables; nothing is allocated, so that it can be asked
    /// for in every frame.
    pub fn label<'w>(&'w self, language: &str, id: &'w str) -> &'w str {
        self.chain(language)
            .find_map(|language| language.plain.get(id))
            .map_or(id, String::as_str)
    }

    /// A language's name in itself; the tag where nobody has written it.
    pub fn language_name<'w>(&'w self, language: &'w str) -> &'w str {
        self.lineage(language)
            .find_map(|language| language.plain.get(LANGUAGE_NAME))
            .map_or(language, String::as_str)
    }

    /// Whether there are words in `language`, or in what it derives from.
    pub fn speaks(&self, language: &str) -> bool {
        self.lineage(language).next().is_some()
    }

    /// Whether `id` is a message of any language.
    pub fn knows(&self, id: &str) -> bool {
        self.languages.iter().any(|language| language.knows(id))
    }

    /// `language`, then what it derives from, then English.
    fn chain(&self, language: &str) -> impl Iterator<Item = &Language> + use<'_> {
        self.lineage(language).chain(self.named(FALLBACK))
    }

    /// `language` and what it derives from.
    fn lineage(&self, language: &str) -> impl Iterator<Item = &Language> + use<'_> {
        let mut found = Vec::new();
        let mut tag = Some(language);
        while let Some(now) = tag {
            found.extend(self.named(now));
            tag = now.rfind(['-', '_']).map(|end| &now[..end]);
        }
        found.into_iter()
    }

    fn named(&self, tag: &str) -> Option<&Language> {
        let same = |c: char| {
            if c == '_' {
                '-'
            } else {
                c.to_ascii_lowercase()
            }
        };
        let is_it = |language: &&Language| language.tag.chars().map(same).eq(tag.chars().map(same));
        self.languages.iter().find(is_it)
    }
}

/// The words that are read, and in which language.
#[derive(Clone, Copy, Debug)]
pub struct Spoken<'w> {
    pub wordings: &'w Wordings,
    pub language: &'w str,
}

impl Spoken<'_> {
    /// A wording without variables.
    pub fn say(&self, id: &str) -> String {
        self.wordings.label(self.language, id).to_owned()
    }

    /// A wording with variables.
    pub fn fill(&self, id: &str, args: &[(&str, Value)]) -> String {
        self.wordings.say(self.language, id, args)
    }

    /// Whether it is read from the right.
    pub fn from_right(&self) -> bool {
        direction(self.language) == Direction::RightToLeft
    }

    /// A number with so many decimals.
    pub fn number(&self, value: f64, decimals: usize) -> String {
        number(self.language, value, decimals)
    }

    /// A number with as few decimals as tell it from others of so many.
    pub fn short(&self, value: f64, decimals: usize) -> String {
        let text = self.number(value, decimals);
        match text.contains(['.', ',']) {
            true => text
                .trim_end_matches('0')
                .trim_end_matches(['.', ','])
                .to_owned(),
            false => text,
        }
    }

    /// `text` of another language, or a value, beside others on one line: it does not turn what is around it.
    pub fn isolated(&self, text: &str) -> String {
        let [begin, end] = ISOLATED;
        match self.from_right() && !text.is_empty() {
            true => format!("{begin}{text}{end}"),
            false => text.to_owned(),
        }
    }
}

/// One language's messages.
struct Language {
    tag: String,
    bundle: FluentBundle<FluentResource>,
    /// Messages without variables, ready to be said.
    plain: HashMap<String, String>,
    /// Of everything that it can say, and a few more.
    letters: BTreeSet<char>,
}

impl fmt::Debug for Language {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Language")
            .field("tag", &self.tag)
            .finish_non_exhaustive()
    }
}

impl Language {
    /// Of Fluent `texts`, the later ones before the earlier; what cannot be parsed in them is left
    /// out. `None` if `tag` is none.
    fn new<'t>(tag: &str, texts: impl IntoIterator<Item = &'t str>) -> Option<Self> {
        let language: LanguageIdentifier = tag.parse().ok()?;
        let tag = language.to_string();
        let mut bundle = FluentBundle::new_concurrent(vec![language]);
        bundle.set_use_isolating(direction(&tag) == Direction::RightToLeft);
        if has_decimal_comma(&tag) {
            bundle.set_formatter(Some(|value, _| match value {
                FluentValue::Number(number) => Some(number.as_string().replace('.', ",")),
                _ => None,
            }));
        }
        let mut plain = HashMap::new();
        let mut ids = Vec::new();
        let mut letters = BTreeSet::new();
        for text in texts {
            ids.extend(source::messages(text).into_iter().map(|m| m.id.to_owned()));
            let lines = text.lines().filter(|line| !line.starts_with('#'));
            letters.extend(lines.flat_map(str::chars));
            let resource = match FluentResource::try_new(text.to_owned()) {
                Ok(resource) | Err((resource, _)) => resource,
            };
            bundle.add_resource_overriding(resource);
        }
        for id in ids {
            let Some(pattern) = bundle.get_message(&id).and_then(|m| m.value()) else {
                continue;
            };
            let mut errors = Vec::new();
            let text = bundle.format_pattern(pattern, None, &mut errors);
            if errors.is_empty() {
                plain.insert(id, text.into_owned());
            }
        }
        Some(Self {
            tag,
            bundle,
            plain,
            letters,
        })
    }

    fn knows(&self, id: &str) -> bool {
        let message = self.bundle.get_message(id);
        message.is_some_and(|message| message.value().is_some())
    }

    /// `None` for a message that it has not.
    fn say(&self, id: &str, args: &[(&str, Value)]) -> Option<Cow<'_, str>> {
        if let Some(text) = self.plain.get(id) {
            return Some(text.into());
        }
        let message = self.bundle.get_message(id)?;
        let args: FluentArgs = args
            .iter()
            .map(|(name, value)| (*name, value.filled()))
            .collect();
        let pattern = message.value()?;
        let text = self
            .bundle
            .format_pattern(pattern, Some(&args), &mut Vec::new());
        Some(match direction(&self.tag) {
            // What is filled in says nothing of the line's own direction, and where nothing else
            // does, the line would be laid from the left.
            Direction::RightToLeft => format!("{RIGHT_TO_LEFT}{text}").into(),
            Direction::LeftToRight => text.into_owned().into(),
        })
    }
}

/// Which way `language` is written; a script in its tag (`ks-Arab`) decides, else what is usual.
pub fn direction(language: &str) -> Direction {
    const SCRIPTS: [&str; 12] = [
        "adlm", "arab", "aran", "hebr", "mand", "mend", "nkoo", "rohg", "samr", "syrc", "thaa",
        "yezi",
    ];
    const LANGUAGES: [&str; 17] = [
        "ar", "arc", "arz", "ckb", "dv", "fa", "he", "iw", "ks", "lrc", "nqo", "ps", "sd", "syr",
        "ug", "ur", "yi",
    ];
    let lower = language.to_ascii_lowercase();
    let mut parts = lower.split(['-', '_']);
    let language = parts.next().unwrap_or_default();
    let script =
        parts.find(|part| part.len() == 4 && part.chars().all(|c| c.is_ascii_alphabetic()));
    let from_right = match script {
        Some(script) => SCRIPTS.contains(&script),
        None => LANGUAGES.contains(&language),
    };
    if from_right {
        Direction::RightToLeft
    } else {
        Direction::LeftToRight
    }
}

/// `value` with so many decimals, as `language` separates them.
pub fn number(language: &str, value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let digits = text.trim_start_matches('-');
    // What rounds to nothing has no sign.
    let is_nothing = digits.chars().all(|c| matches!(c, '0' | '.'));
    let sign = match text.len() > digits.len() && !is_nothing {
        true => "−",
        false => "",
    };
    let separator = separator(language).to_string();
    format!("{sign}{}", digits.replace('.', &separator))
}

/// What separates decimals in `language`.
pub fn separator(language: &str) -> char {
    match has_decimal_comma(language) {
        true => ',',
        false => '.',
    }
}

/// Whether `language` separates decimals by a comma.
fn has_decimal_comma(language: &str) -> bool {
    const POINT: [&str; 12] = [
        "ar", "en", "fa", "he", "hi", "ja", "ko", "ms", "sw", "th", "ur", "zh",
    ];
    let base = language.split(['-', '_']).next().unwrap_or_default();
    !POINT.contains(&base)
}

/// How much room a label takes in letters: marks above and below take none, full-width letters
/// two.
pub fn letters(text: &str) -> usize {
    let of = |c: char| match c {
        '\u{300}'..='\u{36f}' | '\u{64b}'..='\u{65f}' | '\u{200b}'..='\u{200f}' => 0,
        '\u{2066}'..='\u{2069}' => 0,
        '\u{1100}'..='\u{115f}' | '\u{2e80}'..='\u{a4cf}' | '\u{ac00}'..='\u{d7a3}' => 2,
        '\u{f900}'..='\u{faff}' | '\u{fe30}'..='\u{fe6f}' | '\u{ff00}'..='\u{ff60}' => 2,
        _ => 1,
    };
    text.chars().map(of).sum()
}

#[cfg(test)]
mod tests;
