//! Texts and their languages, and dates.

use std::collections::BTreeMap;

use oxilangtag::LanguageTag;

use super::super::{
    decode::{Brief, Pattern},
    document::{Trail, Words},
    exhibit::Wording,
    fault::quoted_list,
    raw::{
        RawExhibit, RawWording,
        values::{DateText, Language},
    },
};
use super::Validator;

impl Validator<'_, '_> {
    /// Finds the exhibit's languages: those it lists, or else those of its title.
    pub(super) fn languages(&mut self, about: Option<&RawExhibit>, trail: &Trail) {
        let declared = about.and_then(|about| about.languages.as_ref());
        self.languages_declared = declared.is_some();
        for (i, language) in declared.iter().flat_map(|list| list.iter()) {
            let trail = trail.key("languages").index(i);
            let Some(tag) = self.language(language, &trail) else {
                continue;
            };
            if self.languages.contains(&tag) {
                let words = Words::new(
                    format!("\"{tag}\" a second time"),
                    "each language once",
                    "remove one of the two",
                );
                self.report.fault(&trail, words);
            } else {
                self.languages.push(tag);
            }
        }
        if declared.is_some() {
            return;
        }
        if let Some(Brief::Full(texts)) = about.and_then(|about| about.title.as_ref()) {
            // A faulty tag is reported with the title.
            let tags = texts
                .0
                .keys()
                .filter_map(|tag| normalised(tag.as_str()).ok());
            self.languages.extend(tags);
            self.languages.sort_by_key(|tag| tag != "en");
        }
        if self.languages.is_empty() {
            self.languages.push("en".to_owned());
        }
    }

    /// A BCP 47 tag in its usual letter cases.
    pub(super) fn language(&mut self, language: &Language, trail: &Trail) -> Option<String> {
        match normalised(language.as_str()) {
            Ok(tag) => Some(tag),
            Err(reason) => {
                let words = Words::new(
                    format!("\"{}\" ({reason})", language.as_str()),
                    Language::ALLOWED,
                    Language::REMEDY,
                );
                self.report.fault(trail, words);
                None
            }
        }
    }

    /// A text; empty where there is none.
    pub(super) fn wording(&mut self, raw: Option<&RawWording>, trail: &Trail) -> Wording {
        let mut texts = BTreeMap::new();
        match raw {
            None => {}
            Some(Brief::Short(text)) => {
                let language = self.languages.first().map_or("en", String::as_str);
                texts.insert(language.to_owned(), text.as_str().to_owned());
            }
            Some(Brief::Full(by_language)) => {
                for (language, text) in &by_language.0 {
                    let trail = trail.key(language.as_str());
                    if let Some(tag) = self.language(language, &trail) {
                        self.warn_of_undeclared(&tag, &trail);
                        texts.insert(tag, text.as_str().to_owned());
                    }
                }
            }
        }
        Wording(texts)
    }

    fn warn_of_undeclared(&mut self, tag: &str, trail: &Trail) {
        if self.languages_declared && !self.languages.iter().any(|language| language == tag) {
            let words = Words::new(
                format!("a text in \"{tag}\", which visitors cannot choose"),
                quoted_list(self.languages.iter().map(String::as_str)),
                "add this language to exhibit.languages",
            );
            self.report.warn(trail, words);
        }
    }

    /// A date that the calendar has; empty where there is none.
    pub(super) fn date(&mut self, raw: Option<&DateText>, trail: &Trail) -> String {
        let Some(date) = raw else {
            return String::new();
        };
        if !in_calendar(date.as_str()) {
            let words = Words::new(
                format!("\"{}\"", date.as_str()),
                "a day that the calendar has",
                "correct the day",
            );
            self.report.fault(trail, words);
        }
        date.as_str().to_owned()
    }
}

/// A BCP 47 tag in its usual letter cases.
pub(crate) fn normalised(tag: &str) -> Result<String, oxilangtag::LanguageTagParseError> {
    LanguageTag::parse_and_normalize(tag).map(LanguageTag::into_inner)
}

fn in_calendar(date: &str) -> bool {
    let numbers: Vec<u32> = date
        .split('-')
        .filter_map(|part| part.parse().ok())
        .collect();
    let [year, month, day] = numbers[..] else {
        return true;
    };
    let leap = year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let days = match month {
        2 if leap => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    };
    day <= days
}
