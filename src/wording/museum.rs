//! The museum's own wordings, and everything that is wrong with them, at once.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs, io,
    path::{Path, PathBuf},
};

use fluent_bundle::{FluentArgs, FluentError, FluentResource, resolver::ResolverError};
use unic_langid::LanguageIdentifier;

use super::{
    FALLBACK, LANGUAGE_NAME, Language, Wordings,
    catalogue::{BUTTON_LETTERS, BUTTONS, SHIPPED},
    letters,
    source::{self, Harm, Message},
};
use crate::manifest::{Fault, Faults, Place, Severity, did_you_mean, quote};

/// Every message with a long text, several times over.
const LARGEST_BYTES: u64 = 256 << 10;
/// How many faults of syntax are told of one file.
const MOST_SYNTAX_FAULTS: usize = 20;
/// Values at which wordings are tried: those that differ in the plural of some language.
const TRIED: [f64; 8] = [0.0, 1.0, 2.0, 3.0, 11.0, 100.0, 1.5, 1_000_000.0];

/// A file of the folder.
struct File {
    path: PathBuf,
    tag: String,
    text: String,
}

/// Reads the files of `folder`.
pub fn read(folder: &Path) -> Result<(Wordings, Vec<Fault>), Faults> {
    let mut faults = Vec::new();
    let mut files: BTreeMap<String, File> = BTreeMap::new();
    for path in paths(folder)? {
        let Some(tag) = language_of(&path, &mut faults) else {
            continue;
        };
        let Some(text) = text_of(&path, &mut faults) else {
            continue;
        };
        if let Some(other) = files.get(&tag) {
            let found = format!("the language \"{tag}\", which {} has", other.path.display());
            faults.push(Fault {
                severity: Severity::Error,
                ..of_file(
                    &path,
                    found,
                    "one file for each language",
                    "join the two files",
                )
            });
            continue;
        }
        files.insert(tag.clone(), File { path, tag, text });
    }
    if files.is_empty() && faults.is_empty() {
        faults.push(Fault {
            severity: Severity::Warning,
            ..of_file(
                folder,
                "no wordings",
                "files named by a language, such as it.ftl",
                "put one there, or leave the folder out",
            )
        });
    }

    let variables = Variables::shipped();
    let mut languages = Vec::new();
    for (tag, text) in SHIPPED {
        languages.extend(Language::new(
            tag,
            [text].into_iter().chain(own(&files, tag)),
        ));
    }
    let shipped = |tag: &str| SHIPPED.iter().any(|(shipped, _)| *shipped == tag);
    for file in files.values().filter(|file| !shipped(&file.tag)) {
        languages.extend(Language::new(&file.tag, [file.text.as_str()]));
    }
    for file in files.values() {
        let language = languages.iter().find(|language| language.tag == file.tag);
        check(file, language, &variables, &mut faults);
    }
    let is_error = |fault: &Fault| fault.severity == Severity::Error;
    if faults.iter().any(is_error)
        && let Some(faults) = Faults::new(faults.clone())
    {
        return Err(faults);
    }
    Ok((Wordings { languages }, faults))
}

fn own<'f>(files: &'f BTreeMap<String, File>, tag: &str) -> Option<&'f str> {
    files.get(tag).map(|file| file.text.as_str())
}

/// The variables of every message, as English has them.
struct Variables<'t>(BTreeMap<&'t str, BTreeSet<&'t str>>);

impl Variables<'static> {
    fn shipped() -> Self {
        let english = SHIPPED.iter().find(|(tag, _)| *tag == FALLBACK);
        let messages = english.map(|(_, text)| source::messages(text));
        let variables = messages.into_iter().flatten().map(|message| {
            let names = message.variables.iter().map(|(name, _)| *name);
            (message.id, names.collect())
        });
        Self(variables.collect())
    }
}

/// The Fluent files of a folder, sorted.
fn paths(folder: &Path) -> Result<Vec<PathBuf>, Faults> {
    let fault = |error: io::Error| -> Faults {
        of_file(
            folder,
            format!("a folder that cannot be read ({error})"),
            "a folder with files such as it.ftl",
            "check the path and its permissions",
        )
        .into()
    };
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(fault)? {
        let path = entry.map_err(fault)?.path();
        if path.extension().is_some_and(|extension| extension == "ftl") {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

/// The language that a file is named by.
fn language_of(path: &Path, faults: &mut Vec<Fault>) -> Option<String> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    match name.parse::<LanguageIdentifier>() {
        Ok(language) if language.language.as_str() != "und" => Some(language.to_string()),
        _ => {
            faults.push(of_file(
                path,
                format!("a file named {}, which is no language", quote(&name)),
                "a language tag (BCP 47), such as it.ftl or de-AT.ftl",
                "name the file by its language",
            ));
            None
        }
    }
}

fn text_of(path: &Path, faults: &mut Vec<Fault>) -> Option<String> {
    let unreadable = |error: io::Error| {
        let found = format!("a file that cannot be read ({error})");
        let fault = of_file(path, found, "a readable text file", "check its permissions");
        Box::new(fault)
    };
    let read = || -> Result<String, Box<Fault>> {
        let metadata = fs::metadata(path).map_err(unreadable)?;
        if !metadata.is_file() || metadata.len() > LARGEST_BYTES {
            let found = match metadata.is_file() {
                true => format!("a file of {} bytes", metadata.len()),
                false => "something that is not a file".to_owned(),
            };
            let allowed = format!("a text file of at most {LARGEST_BYTES} bytes");
            let fault = of_file(path, found, &allowed, "keep to the messages of Recto");
            return Err(fault.into());
        }
        let bytes = fs::read(path).map_err(unreadable)?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let valid = error.utf8_error().valid_up_to();
            let valid = String::from_utf8_lossy(&error.as_bytes()[..valid]).into_owned();
            Fault {
                place: Some(place(&valid, valid.len())),
                ..of_file(
                    path,
                    "bytes that are not UTF-8",
                    "text in UTF-8",
                    "save the file again with the encoding UTF-8",
                )
            }
        })?;
        // Some editors begin a file so; the parser would take it for a part of the first id.
        Ok(text.strip_prefix('\u{feff}').unwrap_or(&text).to_owned())
    };
    let text = match read() {
        Ok(text) => text,
        Err(fault) => {
            faults.push(*fault);
            return None;
        }
    };
    if let Some((harm, byte)) = source::harm(&text) {
        let (found, allowed, remedy) = match harm {
            Harm::TooDeep => (
                "braces within braces, too deep to be read",
                "a few of them within each other",
                "look for a { that is not closed",
            ),
            Harm::LongNumber => (
                "a number too long to be counted by",
                "at most 12 digits on either side of the point",
                "write it outside of braces",
            ),
        };
        faults.push(Fault {
            place: Some(place(&text, byte)),
            ..of_file(path, found, allowed, remedy)
        });
        return None;
    }
    Some(text)
}

/// Everything that is wrong with a file that could be read.
fn check(file: &File, language: Option<&Language>, known: &Variables, faults: &mut Vec<Fault>) {
    let at = |byte: usize, path: &str, severity: Severity| Fault {
        severity,
        place: Some(place(&file.text, byte)),
        path: path.to_owned(),
        ..of_file(&file.path, "", "", "")
    };
    if let Err((_, errors)) = FluentResource::try_new(file.text.clone()) {
        for error in errors.iter().take(MOST_SYNTAX_FAULTS) {
            faults.push(Fault {
                found: format!("text that is not Fluent ({})", error.kind),
                allowed: "Fluent as described at https://projectfluent.org".into(),
                remedy: "correct this place".into(),
                ..at(error.pos.start, "", Severity::Error)
            });
        }
    }
    let messages = source::messages(&file.text);
    let mut seen = BTreeSet::new();
    for message in &messages {
        let fault = |found: String, allowed: String, remedy: String, severity| Fault {
            found,
            allowed,
            remedy,
            ..at(message.at.start, message.id, severity)
        };
        if !seen.insert(message.id) {
            faults.push(fault(
                "a message that is written twice".into(),
                "each message once".into(),
                "leave one of them out; the last one is said".into(),
                Severity::Warning,
            ));
        }
        let Some(variables) = known.0.get(message.id) else {
            faults.push(fault(
                "a message that Recto does not say".into(),
                "the ids of assets/wording/en.ftl".into(),
                did_you_mean(message.id, known.0.keys().copied(), "leave it out"),
                Severity::Error,
            ));
            continue;
        };
        for (name, byte) in &message.variables {
            if !variables.contains(name) {
                let allowed = names(variables);
                faults.push(Fault {
                    found: format!("the variable ${name}"),
                    remedy: did_you_mean(name, variables.iter().copied(), "leave it out"),
                    allowed,
                    ..at(*byte, message.id, Severity::Error)
                });
            }
        }
        let Some(language) = language.filter(|language| language.knows(message.id)) else {
            continue;
        };
        let (used, broken) = tried(language, message, variables);
        for variable in variables.iter().filter(|name| !used.contains(**name)) {
            faults.push(fault(
                format!("a wording without ${variable}"),
                names(variables),
                "put it in, unless it is left out on purpose".into(),
                Severity::Warning,
            ));
        }
        for error in broken {
            faults.push(fault(
                error,
                "messages, terms and functions that there are".into(),
                "correct it".into(),
                Severity::Error,
            ));
        }
        if let Some(label) = language.plain.get(message.id)
            && BUTTONS.contains(&message.id)
            && letters(label) > BUTTON_LETTERS
        {
            faults.push(fault(
                format!("{} letters on a button", letters(label)),
                format!("at most {BUTTON_LETTERS}"),
                "find a shorter word, or see whether it fits".into(),
                Severity::Warning,
            ));
        }
    }
    if SHIPPED.iter().all(|(tag, _)| *tag != file.tag) {
        let base = file.tag.split('-').next().unwrap_or_default();
        let derives = SHIPPED.iter().any(|(tag, _)| *tag == base);
        let missing = |id: &&&str| !seen.contains(**id) && (!derives || **id == LANGUAGE_NAME);
        let missing: Vec<&str> = known.0.keys().filter(missing).copied().collect();
        if !missing.is_empty() {
            faults.push(Fault {
                severity: Severity::Warning,
                ..of_file(
                    &file.path,
                    format!("no wording for {}", missing.join(", ")),
                    "all messages, in a language that Recto does not come with",
                    "what is missing is said in the language it derives from, or in English",
                )
            });
        }
    }
}

/// The variables that a message fills in, also by way of others, and what is wrong with it.
fn tried(
    language: &Language,
    message: &Message,
    variables: &BTreeSet<&str>,
) -> (BTreeSet<String>, BTreeSet<String>) {
    let own = message.variables.iter().map(|(name, _)| (*name).to_owned());
    let mut used: BTreeSet<String> = own.collect();
    let mut broken = BTreeSet::new();
    let found = language.bundle.get_message(message.id);
    let Some(pattern) = found.and_then(|message| message.value()) else {
        return (used, broken);
    };
    let mut try_with = |args: Option<&FluentArgs>| {
        let mut errors = Vec::new();
        language.bundle.format_pattern(pattern, args, &mut errors);
        for error in errors {
            match error {
                FluentError::ResolverError(ResolverError::Reference(
                    fluent_bundle::resolver::errors::ReferenceKind::Variable { id },
                )) => {
                    used.insert(id);
                }
                error => {
                    broken.insert(format!("a wording that cannot be said ({error})"));
                }
            }
        }
    };
    try_with(None);
    for value in TRIED {
        let args: FluentArgs = variables.iter().map(|name| (*name, value)).collect();
        try_with(Some(&args));
    }
    (used, broken)
}

fn names(variables: &BTreeSet<&str>) -> String {
    if variables.is_empty() {
        return "no variable".to_owned();
    }
    let names: Vec<String> = variables.iter().map(|name| format!("${name}")).collect();
    names.join(", ")
}

/// An error of a whole file or folder.
fn of_file(path: &Path, found: impl Into<String>, allowed: &str, remedy: &str) -> Fault {
    Fault {
        severity: Severity::Error,
        file: Some(path.to_owned()),
        place: None,
        path: String::new(),
        found: found.into(),
        allowed: allowed.to_owned(),
        remedy: remedy.to_owned(),
        unreadable: false,
    }
}

/// The place of a byte of `text`.
fn place(text: &str, byte: usize) -> Place {
    let before = &text[..text.floor_char_boundary(byte)];
    let line = before.rfind('\n').map_or(0, |newline| newline + 1);
    Place {
        line: before.matches('\n').count() + 1,
        column: before[line..].chars().count() + 1,
    }
}
