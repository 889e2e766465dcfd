//! What is wrong with a manifest, said in one form: where, what was found, what is allowed and
//! what to do.

use std::{fmt, path::PathBuf};

use serde::Serialize;

/// How much a fault matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The exhibit cannot be shown as written.
    Error,
    /// The exhibit is shown, but probably not as meant.
    Warning,
}

/// A place in a text file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Place {
    /// From 1.
    pub line: usize,
    /// From 1, in characters.
    pub column: usize,
}

/// One fault. It is shown as
/// `file:line:column: path: found …; allowed: …; remedy`, with `warning: ` before the path
/// where it is one; parts that do not apply are left out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Fault {
    pub severity: Severity,
    /// `None` where the input came from elsewhere, such as the command line.
    pub file: Option<PathBuf>,
    /// `None` where the whole file is at fault.
    #[serde(flatten)]
    pub place: Option<Place>,
    /// The key at fault as TOML would name it, `drawing[0].size_mm`; empty for the whole file.
    pub path: String,
    /// What is there.
    pub found: String,
    /// What may be there.
    pub allowed: String,
    /// What to do, often the nearest right word.
    pub remedy: String,
    /// Whether it is the value of an option that cannot be read, whatever the exhibit: wrong usage,
    /// and no fault of an input.
    #[serde(skip)]
    pub unreadable: bool,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(file) = &self.file {
            write!(f, "{}:", file.display())?;
            if let Some(Place { line, column }) = self.place {
                write!(f, "{line}:{column}:")?;
            }
            f.write_str(" ")?;
        }
        if self.severity == Severity::Warning {
            f.write_str("warning: ")?;
        }
        if !self.path.is_empty() {
            write!(f, "{}: ", self.path)?;
        }
        write!(f, "found {}", self.found)?;
        if !self.allowed.is_empty() {
            write!(f, "; allowed: {}", self.allowed)?;
        }
        if !self.remedy.is_empty() {
            write!(f, "; {}", self.remedy)?;
        }
        Ok(())
    }
}

impl std::error::Error for Fault {}

/// All faults of one input, at least one, in the order of their files and places.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Faults(Vec<Fault>);

impl Faults {
    /// `None` if there is nothing to report.
    pub fn new(mut faults: Vec<Fault>) -> Option<Self> {
        sort(&mut faults);
        (!faults.is_empty()).then_some(Self(faults))
    }

    /// In the order of their places.
    pub fn iter(&self) -> impl Iterator<Item = &Fault> {
        self.0.iter()
    }
}

impl From<Fault> for Faults {
    fn from(fault: Fault) -> Self {
        Self(vec![fault])
    }
}

impl IntoIterator for Faults {
    type Item = Fault;
    type IntoIter = std::vec::IntoIter<Fault>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

/// One fault a line.
impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, fault) in self.0.iter().enumerate() {
            if i > 0 {
                f.write_str("\n")?;
            }
            fault.fmt(f)?;
        }
        Ok(())
    }
}

impl std::error::Error for Faults {}

/// Orders faults as somebody meets them who reads file after file from its top.
pub(crate) fn sort(faults: &mut [Fault]) {
    faults.sort_by_cached_key(|fault| (fault.file.clone(), fault.place, natural(&fault.path)));
}

/// A key that sorts `img2` before `img10`.
pub(crate) fn natural(name: &str) -> Vec<(String, u64)> {
    let mut parts = Vec::new();
    let mut rest = name;
    while !rest.is_empty() {
        let digits = rest
            .find(|c: char| c.is_ascii_digit())
            .unwrap_or(rest.len());
        let (word, numbered) = rest.split_at(digits);
        let end = numbered
            .find(|c: char| !c.is_ascii_digit())
            .unwrap_or(numbered.len());
        parts.push((word.to_owned(), numbered[..end].parse().unwrap_or(u64::MAX)));
        rest = &numbered[end..];
    }
    parts
}

/// The word of `words` that was probably meant by `word`, if any is near enough.
pub fn nearest<'w>(word: &str, words: impl IntoIterator<Item = &'w str>) -> Option<&'w str> {
    /// Comparing is quadratic, and nobody misspells one word at such length.
    const LONGEST: usize = 64;
    /// Nobody means one of so many either.
    const MOST: usize = 1000;
    if word.chars().count() > LONGEST {
        return None;
    }
    /// Fewer letters begin too many words.
    const BEGINNING: usize = 3;
    let lower = word.to_lowercase();
    let words: Vec<&str> = words.into_iter().take(MOST).collect();
    let begins = |candidate: &&&str| candidate.to_lowercase().starts_with(&lower);
    let mut longer = words.iter().filter(begins);
    if let (true, Some(only), None) = (
        lower.chars().count() >= BEGINNING,
        longer.next(),
        longer.next(),
    ) {
        return Some(only);
    }
    words
        .into_iter()
        .map(|candidate| {
            (
                strsim::damerau_levenshtein(&lower, &candidate.to_lowercase()),
                candidate,
            )
        })
        .filter(|(distance, candidate)| *distance <= candidate.chars().count().max(3) / 3)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// The remedy for a misspelt word: the nearest right one, or else `otherwise`.
pub fn did_you_mean<'w>(
    word: &str,
    words: impl IntoIterator<Item = &'w str>,
    otherwise: &str,
) -> String {
    nearest(word, words).map_or_else(
        || otherwise.to_owned(),
        |word| format!("did you mean \"{word}\"?"),
    )
}

/// `what` with its article: "a lamp", "an overlay".
pub fn one(what: &str) -> String {
    let article = if what.starts_with(['a', 'e', 'i', 'o', 'u']) {
        "an"
    } else {
        "a"
    };
    format!("{article} {what}")
}

/// `"a", "b" or "c"`.
pub fn quoted_list<'w>(words: impl IntoIterator<Item = &'w str>) -> String {
    let words: Vec<_> = words
        .into_iter()
        .map(|word| format!("\"{word}\""))
        .collect();
    match words.split_last() {
        None => String::new(),
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
    }
}

/// A text in quotation marks, on one line and not too long to read.
pub fn quote(text: &str) -> String {
    const SHOWN: usize = 60;
    let mut shown: String = text.chars().take(SHOWN).collect();
    if text.chars().nth(SHOWN).is_some() {
        shown.push('…');
    }
    format!("{shown:?}")
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{super::document::Words, *};

    #[test]
    fn a_near_word_is_offered_and_a_far_one_is_not() {
        let words = ["albedo", "normal", "roughness"];
        assert_eq!(nearest("albdeo", words), Some("albedo"));
        assert_eq!(nearest("ROUGHNESS", words), Some("roughness"));
        assert_eq!(nearest("colour", words), None);
        assert_eq!(nearest(&"a".repeat(100_000), words), None);
    }

    #[test]
    fn names_sort_by_their_numbers() {
        let mut names = ["b10.png", "b9.png", "a.png", "b010x.png"];
        names.sort_by_cached_key(|name| natural(name));
        assert_eq!(names, ["a.png", "b9.png", "b10.png", "b010x.png"]);
        let fault = |path: &str| Fault {
            path: path.to_owned(),
            ..Words::new("", "", "").of_file(Path::new("book.json"))
        };
        let faults = [
            "items[10].id",
            "items[2]",
            "items[1].items[11]",
            "items[1].items[3]",
        ];
        let faults = Faults::new(faults.map(fault).to_vec()).unwrap();
        let paths: Vec<&str> = faults.iter().map(|fault| fault.path.as_str()).collect();
        assert_eq!(
            paths,
            [
                "items[1].items[3]",
                "items[1].items[11]",
                "items[2]",
                "items[10].id"
            ]
        );
    }

    #[test]
    fn a_fault_without_file_or_place_is_still_a_sentence() {
        let fault = Fault {
            severity: Severity::Warning,
            file: None,
            place: None,
            path: "--lamp".into(),
            found: "\"sun\"".into(),
            allowed: String::new(),
            remedy: "name a lamp".into(),
            unreadable: false,
        };
        assert_eq!(
            fault.to_string(),
            "warning: --lamp: found \"sun\"; name a lamp"
        );
    }
}
