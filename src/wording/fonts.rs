//! Which font files have the letters of the languages in use: those of the installation first, then
//! those of the system.
//!
//! Fonts are told apart by their own maps of characters, not by their names; names only say which
//! files are looked into first.

use std::{
    collections::{BTreeMap, BTreeSet},
    env, fs,
    path::{Path, PathBuf},
};

use parley::fontique::{
    Blob, CharmapIndex, Collection, CollectionOptions, FallbackKey, FamilyId, Script,
};

use super::Wordings;
use crate::manifest::{Fault, Severity};

/// Larger files are no fonts, or more than a wall's memory is for.
const LARGEST_BYTES: u64 = 64 << 20;
/// How many files of unknown names are looked into, where the known ones are not enough.
const MOST_STRANGERS: usize = 300;
/// How many entries of folders are looked at.
const MOST_ENTRIES: usize = 20_000;
/// How deep folders of fonts are nested within each other.
const DEEPEST: usize = 6;

/// Files that are looked into first, by name and in this order: Latin and Arabic on Linux, macOS
/// and Windows, then Japanese, those with Japanese forms of Han characters first.
const KNOWN: [&str; 27] = [
    "DejaVuSans.ttf",
    "NotoSans-Regular.ttf",
    "LiberationSans-Regular.ttf",
    "Helvetica.ttc",
    "HelveticaNeue.ttc",
    "segoeui.ttf",
    "Arial.ttf",
    "arial.ttf",
    "NotoSansArabic-Regular.ttf",
    "NotoNaskhArabic-Regular.ttf",
    "GeezaPro.ttc",
    "MTLc3m.ttf",
    "NotoSansCJK-Regular.ttc",
    "NotoSansJP-Regular.otf",
    "NotoSansJP-Regular.ttf",
    "VL-PGothic-Regular.ttf",
    "VL-Gothic-Regular.ttf",
    "ipagp.ttf",
    "ipag.ttf",
    "ヒラギノ角ゴシック W3.ttc",
    "Hiragino Sans GB.ttc",
    "YuGothR.ttc",
    "meiryo.ttc",
    "msgothic.ttc",
    "DroidSansFallbackFull.ttf",
    "DroidSansFallback.ttf",
    "Arial Unicode.ttf",
];

/// What the program fills in, and notices and readings have, in every language.
const FILLED_IN: &str =
    "0123456789.,:;+−±×°%²µΔ*_-·|–—…“”‘’()[]<>/ ABCEKLMRSTabcdefghijklmnopqrstuvwxyz";

/// A script's tag, the package with a font for it, and its letters from … to.
type WrittenIn = ([u8; 4], &'static str, &'static [(char, char)]);

/// Scripts that the shipped languages and their neighbours are written in, with the package that
/// has a font for them.
const SCRIPTS: [WrittenIn; 10] = [
    (
        *b"Latn",
        "fonts-dejavu-core",
        &[('A', 'z'), ('À', 'ɏ'), ('Ḁ', 'ỿ')],
    ),
    (*b"Grek", "fonts-dejavu-core", &[('Ͱ', 'Ͽ'), ('ἀ', '῾')]),
    (*b"Cyrl", "fonts-dejavu-core", &[('Ѐ', 'ԯ')]),
    (
        *b"Arab",
        "fonts-dejavu-core",
        &[
            ('\u{600}', 'ۿ'),
            ('ݐ', 'ݿ'),
            ('ﭐ', '\u{fdff}'),
            ('\u{fe70}', 'ﻼ'),
        ],
    ),
    (*b"Hebr", "fonts-dejavu-core", &[('\u{591}', '\u{5f4}')]),
    (*b"Hira", JAPANESE, &[('ぁ', 'ゟ')]),
    (*b"Kana", JAPANESE, &[('゠', 'ヿ'), ('ㇰ', 'ㇿ'), ('･', 'ﾟ')]),
    (
        *b"Hani",
        JAPANESE,
        &[
            ('々', '〇'),
            ('㐀', '䶿'),
            ('一', '\u{9fff}'),
            ('豈', '\u{faff}'),
        ],
    ),
    (*b"Hang", "fonts-nanum", &[('가', '힣'), ('ᄀ', 'ᇿ')]),
    (*b"Thai", "fonts-thai-tlwg", &[('ก', '๛')]),
];
/// Debian's smallest font with Japanese forms of all characters in common use.
const JAPANESE: &str = "fonts-motoya-l-cedar";

/// The letters that each language needs.
pub type Letters = BTreeMap<String, BTreeSet<char>>;

/// A font file that has letters which are needed.
#[derive(Clone, Debug)]
pub struct Face {
    pub path: PathBuf,
    /// The name of its first family, by which text asks for it.
    pub family: String,
    data: Blob<u8>,
    charmap: CharmapIndex,
}

impl Face {
    /// The bytes of the whole file, shared.
    pub fn data(&self) -> &Blob<u8> {
        &self.data
    }

    /// Whether it has a glyph for `letter`.
    pub fn has(&self, letter: char) -> bool {
        let charmap = self.charmap.charmap(self.data.as_ref());
        charmap.is_some_and(|map| map.map(letter).is_some_and(|glyph| glyph != 0))
    }

    /// The file at `path`; `None` if it is no font.
    fn read(path: &Path) -> Option<Self> {
        let metadata = fs::metadata(path).ok()?;
        if !metadata.is_file() || metadata.len() > LARGEST_BYTES {
            return None;
        }
        let data = Blob::from(fs::read(path).ok()?);
        let mut collection = Collection::new(CollectionOptions {
            shared: false,
            system_fonts: false,
        });
        let families = collection.register_fonts(data.clone(), None);
        let (family, fonts) = families.first()?;
        Some(Self {
            path: path.to_owned(),
            family: collection.family_name(*family)?.to_owned(),
            charmap: fonts.first()?.charmap_index(),
            data,
        })
    }
}

/// The fonts of an installation.
#[derive(Clone, Debug, Default)]
pub struct Fonts {
    /// In the order in which they were found.
    faces: Vec<Face>,
    /// By language, in the order in which they are asked for a letter.
    of: BTreeMap<String, Vec<usize>>,
    missing: Letters,
    /// Files of the installation's folder that are no fonts.
    unusable: Vec<PathBuf>,
}

impl Fonts {
    /// The fonts that have `letters`, of the installation's `folder` first, then of the system's
    /// usual folders, of which no more is read than is needed.
    pub fn find(letters: &Letters, folder: Option<&Path>) -> Self {
        Self::find_in(letters, folder, &system_folders())
    }

    /// As [`Self::find`], in these folders instead of the system's.
    pub fn find_in(letters: &Letters, folder: Option<&Path>, system: &[PathBuf]) -> Self {
        let mut fonts = Self {
            missing: letters.clone(),
            of: letters
                .keys()
                .map(|language| (language.clone(), Vec::new()))
                .collect(),
            ..Self::default()
        };
        for path in folder.map(files_below).unwrap_or_default() {
            match Face::read(&path) {
                Some(face) => fonts.offer(face),
                None => fonts.unusable.push(path),
            }
        }
        if fonts.is_complete() {
            return fonts;
        }
        let files: Vec<PathBuf> = system
            .iter()
            .flat_map(|folder| files_below(folder))
            .collect();
        let named = |path: &Path, name: &str| path.file_name().is_some_and(|file| file == name);
        let known = |path: &Path| KNOWN.iter().any(|name| named(path, name));
        let first = KNOWN
            .iter()
            .filter_map(|name| files.iter().find(|path| named(path, name)));
        let strangers = files
            .iter()
            .filter(|path| !known(path))
            .take(MOST_STRANGERS);
        for path in first.chain(strangers) {
            if fonts.is_complete() {
                break;
            }
            if let Some(face) = Face::read(path) {
                fonts.offer(face);
            }
        }
        fonts
    }

    /// Takes a face for every language that lacks a letter which it has.
    fn offer(&mut self, face: Face) {
        let index = self.faces.len();
        let mut is_needed = false;
        for (language, missing) in &mut self.missing {
            let before = missing.len();
            missing.retain(|letter| !face.has(*letter));
            if missing.len() < before {
                self.of.entry(language.clone()).or_default().push(index);
                is_needed = true;
            }
        }
        if is_needed {
            self.faces.push(face);
        }
    }

    fn is_complete(&self) -> bool {
        self.missing.values().all(BTreeSet::is_empty)
    }

    /// All faces, each once: load them all, and keep their handles.
    pub fn faces(&self) -> &[Face] {
        &self.faces
    }

    /// The faces of a language, the one that its text is set in first; those of no language where it
    /// was not among those asked for.
    pub fn for_language(&self, language: &str) -> impl Iterator<Item = &Face> {
        let of = self.of.get(language).into_iter().flatten();
        of.filter_map(|index| self.faces.get(*index))
    }

    /// The letters that no font has, by language; languages without any are left out.
    pub fn missing(&self) -> impl Iterator<Item = (&str, &BTreeSet<char>)> {
        let missing = self
            .missing
            .iter()
            .filter(|(_, missing)| !missing.is_empty());
        missing.map(|(language, missing)| (language.as_str(), missing))
    }

    /// Which families are asked, in this order, for letters of a script that the font of a text has
    /// not: of those languages that need the script.
    pub fn fallbacks(&self) -> Vec<(Script, Vec<&str>)> {
        let mut fallbacks = Vec::new();
        for (script, _, ranges) in SCRIPTS {
            let sampled = || {
                ranges
                    .iter()
                    .flat_map(|(from, to)| (*from..=*to).step_by(7))
            };
            let count = |face: &Face| sampled().filter(|c| face.has(*c)).count();
            let counts: Vec<usize> = self.faces.iter().map(count).collect();
            let most = counts.iter().copied().max().unwrap_or_default();
            let mut families: Vec<&str> = Vec::new();
            for (face, count) in self.faces.iter().zip(counts) {
                // A letter or two of a script are not the script.
                let has_it = count > 3 && count * 10 >= most;
                if has_it && !families.contains(&face.family.as_str()) {
                    families.push(&face.family);
                }
            }
            if !families.is_empty() {
                fallbacks.push((Script::from_bytes(script), families));
            }
        }
        fallbacks
    }

    /// Tells `collection`, in which the faces are registered, which of them to ask for which
    /// script. Whether all of them are registered there by now.
    pub fn hint(&self, collection: &mut Collection) -> bool {
        let mut all = true;
        for (script, families) in self.fallbacks() {
            let ids: Vec<Option<FamilyId>> = families
                .iter()
                .map(|family| collection.family_id(family))
                .collect();
            all &= ids.iter().all(Option::is_some);
            collection.set_fallbacks(FallbackKey::new(script, None), ids.into_iter().flatten());
        }
        all
    }

    /// What is worth telling the technician.
    pub fn warnings(&self) -> Vec<Fault> {
        let unusable = self.unusable.iter().map(|path| Fault {
            severity: Severity::Warning,
            file: Some(path.clone()),
            place: None,
            path: String::new(),
            found: "a file that is no font".into(),
            allowed: "TrueType and OpenType fonts (.ttf, .otf, .ttc)".into(),
            remedy: "take it out of the folder".into(),
            unreadable: false,
        });
        let missing = self.missing().map(|(language, letters)| {
            let packages: BTreeSet<&str> = letters.iter().filter_map(|c| package(*c)).collect();
            let packages: Vec<&str> = packages.into_iter().collect();
            let remedy = match packages.as_slice() {
                [] => "put a font that has them into the folder of fonts".to_owned(),
                packages => format!(
                    "sudo apt-get install {}, or put a font that has them into the folder of fonts",
                    packages.join(" ")
                ),
            };
            Fault {
                severity: Severity::Warning,
                file: None,
                place: None,
                path: language.to_owned(),
                found: format!("no font for {}", listed(letters)),
                allowed: String::new(),
                remedy,
                unreadable: false,
            }
        });
        unusable.chain(missing).collect()
    }
}

impl Wordings {
    /// The letters of everything that can be said, by language, with those that are filled in.
    pub fn letters(&self) -> Letters {
        let of = self.languages.iter().map(|language| {
            let letters = language.letters.iter().copied().chain(FILLED_IN.chars());
            (
                language.tag.clone(),
                letters.filter(|c| is_drawn(*c)).collect(),
            )
        });
        of.collect()
    }
}

/// Adds the letters of a `text`, such as the title of an exhibit, to those that a language needs.
pub fn add(letters: &mut Letters, language: &str, text: &str) {
    let of = letters.entry(language.to_owned()).or_default();
    of.extend(text.chars().filter(|c| is_drawn(*c)));
}

/// Whether a letter has a glyph: not what only steers the line or the letters around it.
fn is_drawn(letter: char) -> bool {
    !letter.is_control()
        && !matches!(letter,
            '\u{ad}' | '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{fe00}'..='\u{fe0f}' | '\u{feff}')
}

/// The package with a font for a letter.
fn package(letter: char) -> Option<&'static str> {
    let has = |ranges: &&[(char, char)]| ranges.iter().any(|(a, b)| (*a..=*b).contains(&letter));
    let script = SCRIPTS.iter().find(|(_, _, ranges)| has(ranges));
    script.map(|(_, package, _)| *package)
}

/// The first of `letters`, and how many more there are.
fn listed(letters: &BTreeSet<char>) -> String {
    const SHOWN: usize = 12;
    let shown: Vec<String> = letters.iter().take(SHOWN).map(char::to_string).collect();
    match letters.len().saturating_sub(SHOWN) {
        0 => shown.join(" "),
        more => format!("{} and {more} more", shown.join(" ")),
    }
}

/// Where the systems keep fonts; folders that are not there do no harm.
fn system_folders() -> Vec<PathBuf> {
    let under = |variable: &str, folder: &str| {
        env::var_os(variable).map(|base| PathBuf::from(base).join(folder))
    };
    let fixed = [
        "/usr/local/share/fonts",
        "/usr/share/fonts",
        "/Library/Fonts",
        "/System/Library/Fonts",
    ];
    let own = [
        under("XDG_DATA_HOME", "fonts"),
        under("HOME", ".local/share/fonts"),
        under("HOME", ".fonts"),
        under("HOME", "Library/Fonts"),
        under("LOCALAPPDATA", "Microsoft\\Windows\\Fonts"),
        under("WINDIR", "Fonts"),
    ];
    own.into_iter()
        .flatten()
        .chain(fixed.map(PathBuf::from))
        .collect()
}

/// The font files of a folder and of those in it, sorted.
fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut open = vec![(folder.to_owned(), 0)];
    let mut entries = 0;
    while let Some((folder, depth)) = open.pop() {
        for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
            entries += 1;
            if entries > MOST_ENTRIES {
                break;
            }
            let path = entry.path();
            if path.is_dir() {
                if depth < DEEPEST {
                    open.push((path, depth + 1));
                }
            } else if is_font(&path) {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

fn is_font(path: &Path) -> bool {
    let extension = path
        .extension()
        .unwrap_or_default()
        .to_string_lossy()
        .to_lowercase();
    matches!(extension.as_str(), "ttf" | "otf" | "ttc" | "otc")
}

#[cfg(test)]
#[path = "fonts_tests.rs"]
mod tests;
