//! The manifest's text and its tree with the place of every key, so that whoever finds a fault
//! at `drawing[0].recto.albedo` can say on which line and in which column.

use std::{
    fmt, fs,
    hash::{DefaultHasher, Hash, Hasher},
    io,
    ops::Range,
    path::{Path, PathBuf},
};

use toml::{
    Spanned,
    de::{DeTable, DeValue, Error},
};

use super::fault::{Fault, Faults, Place, Severity, quote};

/// The file name of a manifest.
pub const MANIFEST: &str = "exhibit.toml";
/// Some hundreds of drawings with texts in several languages; the parser reads as much within
/// a second even unoptimised.
const LARGEST_BYTES: u64 = 4 << 20;
/// How many syntax faults are listed: one slip can make every line after it one.
const MOST_SYNTAX_FAULTS: usize = 20;

/// A step from a table or array to a value in it.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Step {
    Key(String),
    Index(usize),
}

/// The way from the root of a manifest to one value.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Trail(Vec<Step>);

impl Trail {
    /// The way to the value of `key` in the table that `self` leads to.
    pub fn key(&self, key: &str) -> Self {
        self.step(Step::Key(key.to_owned()))
    }

    /// The way to an element of the array that `self` leads to.
    pub fn index(&self, index: usize) -> Self {
        self.step(Step::Index(index))
    }

    /// The header of the table that `self` leads to: its keys without indices.
    pub fn header(&self) -> String {
        let keys = self.0.iter().filter(|step| matches!(step, Step::Key(_)));
        Self(keys.cloned().collect()).to_string()
    }

    /// Whether `other` leads to the same value as `self` or to one inside it.
    pub fn holds(&self, other: &Self) -> bool {
        other.0.starts_with(&self.0)
    }

    fn step(&self, step: Step) -> Self {
        let mut steps = self.0.clone();
        steps.push(step);
        Self(steps)
    }
}

impl fmt::Display for Trail {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        for (i, step) in self.0.iter().enumerate() {
            match step {
                Step::Index(index) => write!(f, "[{index}]")?,
                Step::Key(key) => {
                    if i > 0 {
                        f.write_str(".")?;
                    }
                    if !key.is_empty() && key.len() <= 64 && key.chars().all(bare) {
                        f.write_str(key)?;
                    } else {
                        f.write_str(&quote(key))?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// Which part of an entry a fault is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum At {
    Key,
    Value,
}

/// The path of the manifest that `path`, an exhibit's folder or the manifest itself, means.
pub(crate) fn manifest_path(path: &Path) -> PathBuf {
    if path.is_dir() {
        path.join(MANIFEST)
    } else {
        path.to_owned()
    }
}

/// Reads the text of a manifest.
///
/// # Errors
/// One fault if the file is absent, not a file, too large or not UTF-8.
pub(crate) fn read_text(file: &Path) -> Result<String, Faults> {
    let allowed = "an exhibit's folder with an exhibit.toml, or that file itself";
    let remedy = "check the path, or begin an exhibit with `recto new`";
    read_text_of(file, allowed, remedy)
}

/// As [`read_text`], of a file of which `allowed` and `remedy` are said where it is absent.
///
/// # Errors
/// As [`read_text`].
pub(crate) fn read_text_of(file: &Path, allowed: &str, remedy: &str) -> Result<String, Faults> {
    let absent = [allowed, remedy];
    let whole = |found: String, allowed: &str, remedy: &str| -> Faults {
        Words::new(found, allowed, remedy).of_file(file).into()
    };
    let unreadable = |error: io::Error| match error.kind() {
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => {
            whole("no such file".to_owned(), absent[0], absent[1])
        }
        _ => whole(
            format!("a file that cannot be read ({error})"),
            "a readable text file",
            "check its permissions",
        ),
    };
    let metadata = fs::metadata(file).map_err(unreadable)?;
    if !metadata.is_file() {
        return Err(whole(
            "something that is not a file".to_owned(),
            "a TOML text file",
            "put the manifest's text in its place",
        ));
    }
    if metadata.len() > LARGEST_BYTES {
        return Err(whole(
            format!("a file of {} bytes", metadata.len()),
            &format!("at most {LARGEST_BYTES} bytes"),
            "keep pictures in files of their own and split the exhibit in two",
        ));
    }
    let bytes = fs::read(file).map_err(unreadable)?;
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let byte = error.as_bytes()[valid];
        let valid = String::from_utf8_lossy(&error.as_bytes()[..valid]);
        let words = Words::new(
            format!("the byte 0x{byte:02x}, which is not UTF-8"),
            "text in UTF-8",
            "save the file again with the encoding UTF-8",
        );
        Faults::from(Fault {
            place: Some(place_in(&valid, &line_starts(&valid), valid.len())),
            ..words.of_file(file)
        })
    })
}

/// Tells one text of a manifest from another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Fingerprint(u64);

impl Fingerprint {
    /// Of this text.
    pub fn of(text: &str) -> Self {
        let mut hasher = DefaultHasher::new();
        text.hash(&mut hasher);
        Self(hasher.finish())
    }
}

/// A parsed manifest.
pub(crate) struct Document<'t> {
    file: PathBuf,
    text: &'t str,
    /// The first byte of each line.
    lines: Vec<usize>,
    root: Spanned<DeValue<'t>>,
}

impl<'t> Document<'t> {
    /// Parses the text of `file`; the file itself is not touched.
    ///
    /// # Errors
    /// All faults of syntax.
    pub fn parse(file: &Path, text: &'t str) -> Result<Self, Faults> {
        let (table, errors) = DeTable::parse_recoverable(text);
        let span = table.span();
        let document = Self {
            file: file.to_owned(),
            text,
            lines: line_starts(text),
            root: Spanned::new(span, DeValue::Table(table.into_inner())),
        };
        match Faults::new(document.syntax_faults(&errors)) {
            Some(faults) => Err(faults),
            None => Ok(document),
        }
    }

    /// The file that it was read from.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// The table of the whole document.
    pub fn root(&self) -> &Spanned<DeValue<'t>> {
        &self.root
    }

    /// Where the value at `trail` is written, or, where there is none, the innermost table that
    /// lacks it.
    pub fn place(&self, trail: &Trail, at: At) -> Place {
        let mut start = self.root.span().start;
        let mut steps = 0;
        self.walk(trail, |key, value| {
            steps += 1;
            start = match key {
                Some(key) if at == At::Key && steps == trail.0.len() => key.start,
                _ => value.start,
            };
        });
        self.place_of(start)
    }

    fn place_of(&self, byte: usize) -> Place {
        place_in(self.text, &self.lines, byte)
    }

    /// Whether there is a value at `trail`.
    pub fn contains(&self, trail: &Trail) -> bool {
        let mut steps = 0;
        self.walk(trail, |_, _| steps += 1);
        steps == trail.0.len()
    }

    /// Follows `trail` as far as there are values, and shows the spans of each and its key.
    fn walk(&self, trail: &Trail, mut visit: impl FnMut(Option<Range<usize>>, Range<usize>)) {
        let mut value = &self.root;
        for step in &trail.0 {
            let next = match (step, value.get_ref()) {
                (Step::Key(key), DeValue::Table(table)) => table
                    .get_key_value(key.as_str())
                    .map(|(key, value)| (Some(key.span()), value)),
                (Step::Index(index), DeValue::Array(array)) => {
                    array.get(*index).map(|value| (None, value))
                }
                _ => None,
            };
            let Some((key, next)) = next else { return };
            value = next;
            visit(key, value.span());
        }
    }

    /// The way to the first text, from the top of the file, that `is_it` is true of.
    pub fn find_text(&self, is_it: impl Fn(&str) -> bool) -> Option<Trail> {
        let mut found: Option<(usize, Trail)> = None;
        let mut open = vec![(Trail::default(), &self.root)];
        while let Some((trail, value)) = open.pop() {
            match value.get_ref() {
                DeValue::String(text) => {
                    let start = value.span().start;
                    if is_it(text) && found.as_ref().is_none_or(|(first, _)| start < *first) {
                        found = Some((start, trail));
                    }
                }
                DeValue::Table(table) => {
                    open.extend(
                        table
                            .iter()
                            .map(|(key, value)| (trail.key(key.get_ref()), value)),
                    );
                }
                DeValue::Array(array) => {
                    open.extend(array.iter().enumerate().map(|(i, v)| (trail.index(i), v)));
                }
                _ => {}
            }
        }
        found.map(|(_, trail)| trail)
    }

    /// A fault at `trail`.
    pub fn fault(&self, trail: &Trail, at: At, severity: Severity, words: Words) -> Fault {
        Fault {
            severity,
            place: Some(self.place(trail, at)),
            path: trail.to_string(),
            ..words.of_file(&self.file)
        }
    }

    fn syntax_faults(&self, errors: &[Error]) -> Vec<Fault> {
        let fault = |error: &Error, words: Words| Fault {
            place: error.span().map(|span| self.place_of(span.start)),
            ..words.of_file(&self.file)
        };
        // Too deep nesting leaves everything behind it unread and makes many faults of one.
        if let Some(error) = errors
            .iter()
            .find(|error| error.message().contains("recurs"))
        {
            let words = Words::new(
                "tables or arrays nested too deeply",
                "at most 80 levels",
                "a manifest needs fewer than ten; look for an unclosed bracket",
            );
            return vec![fault(error, words)];
        }
        let mut faults: Vec<Fault> = Vec::new();
        for error in errors {
            let words = Words::new(
                format!("text that is not TOML ({})", error.message()),
                "TOML as described at https://toml.io",
                self.syntax_remedy(error),
            );
            let fault = fault(error, words);
            if faults.last() != Some(&fault) {
                faults.push(fault);
            }
            if faults.len() == MOST_SYNTAX_FAULTS {
                break;
            }
        }
        faults
    }

    /// Whether a text processor's quotation marks stand in the line of an error.
    fn has_curly_quotes(&self, error: &Error) -> bool {
        let at = error.span().map_or(0, |span| span.start);
        let at = self.text.floor_char_boundary(at);
        let start = self.text[..at].rfind('\n').map_or(0, |newline| newline + 1);
        let line = self.text[start..].lines().next().unwrap_or_default();
        line.contains(['“', '”', '„', '‘', '’', '«', '»'])
    }

    fn syntax_remedy(&self, error: &Error) -> &'static str {
        let message = error.message();
        if message.contains("duplicate key") {
            "write each key once, or begin a new [[…]] table"
        } else if message.contains("leading zero") {
            "put what begins with 0 and is no number, such as a PIN, in quotation marks"
        } else if message.contains("escaped value") {
            "write paths with / instead of \\, or in single quotation marks"
        } else if self.has_curly_quotes(error) {
            "write straight quotation marks: \" instead of “ and ”"
        } else if error
            .span()
            .is_some_and(|span| span.start >= self.text.trim_end().len())
        {
            "the text ends too early; close the last bracket or quotation mark"
        } else {
            "correct this place"
        }
    }
}

/// What a fault says, before its place is known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Words {
    pub found: String,
    pub allowed: String,
    pub remedy: String,
}

impl Words {
    pub fn new(
        found: impl Into<String>,
        allowed: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self {
            found: found.into(),
            allowed: allowed.into(),
            remedy: remedy.into(),
        }
    }
}

impl Words {
    /// The fault of a whole file.
    pub fn of_file(self, file: &Path) -> Fault {
        Fault {
            severity: Severity::Error,
            file: Some(file.to_owned()),
            place: None,
            path: String::new(),
            found: self.found,
            allowed: self.allowed,
            remedy: self.remedy,
            unreadable: false,
        }
    }
}

fn line_starts(text: &str) -> Vec<usize> {
    let after_newlines = text.match_indices('\n').map(|(newline, _)| newline + 1);
    std::iter::once(0).chain(after_newlines).collect()
}

/// The line and column of a byte of `text`, whose `lines` begin at these bytes.
fn place_in(text: &str, lines: &[usize], byte: usize) -> Place {
    let byte = text.floor_char_boundary(byte);
    let line = lines.partition_point(|start| *start <= byte).max(1);
    let start = lines.get(line - 1).copied().unwrap_or(0);
    Place {
        line,
        column: text[start..byte].chars().count() + 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "\
# über
[[drawing]]
id = \"a\"
recto.albedo = \"a.png\"
paper = { kind = \"laid\" }
";

    fn place(trail: &Trail, at: At) -> (usize, usize) {
        let document = Document::parse(Path::new("exhibit.toml"), TEXT).unwrap();
        let place = document.place(trail, at);
        (place.line, place.column)
    }

    #[test]
    fn dotted_keys_and_inline_tables_have_places() {
        let drawing = Trail::default().key("drawing").index(0);
        assert_eq!(place(&drawing, At::Value), (2, 1));
        assert_eq!(
            place(&drawing.key("recto").key("albedo"), At::Value),
            (4, 16)
        );
        assert_eq!(place(&drawing.key("recto").key("albedo"), At::Key), (4, 7));
        assert_eq!(place(&drawing.key("paper").key("kind"), At::Value), (5, 18));
    }

    #[test]
    fn a_missing_value_is_placed_at_the_table_that_lacks_it() {
        let drawing = Trail::default().key("drawing").index(0);
        assert_eq!(place(&drawing.key("size_mm"), At::Value), (2, 1));
        assert_eq!(
            place(&drawing.key("recto").key("normal").key("file"), At::Value),
            (4, 1)
        );
        assert_eq!(place(&Trail::default().key("lamp"), At::Value), (1, 1));
    }

    #[test]
    fn trails_are_written_as_toml_writes_keys() {
        let trail = Trail::default()
            .key("drawing")
            .index(1)
            .key("legend")
            .key("#aabbcc");
        assert_eq!(trail.to_string(), "drawing[1].legend.\"#aabbcc\"");
    }
}
