//! Who may import whom: the table of the architecture, read from the sources.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

/// Each module with the modules, or paths within them, that it may name. `bevy` stands for every
/// crate of Bevy's. The crate's root and `cli` may name everything.
const MAY_IMPORT: [(&str, &[&str]); 27] = [
    ("units", &[]),
    ("colour", &[]),
    ("optics", &["units", "colour"]),
    ("maps", &["units", "colour"]),
    ("measure", &["units", "colour"]),
    ("lettering", &[]),
    // Headers of pictures are checked at validation.
    ("manifest", &["units", "colour", "optics", "maps"]),
    // It is read by the manifest's machinery, and names exhibits and profiles of displays.
    ("installation", &["manifest", "maps", "colour"]),
    // What leaving a term out costs is told in ΔE00.
    ("needs", &["manifest", "optics", "maps", "colour"]),
    // What is measured lies on a side of an exhibit, in its maps.
    (
        "readings",
        &["manifest", "maps", "measure", "colour", "lettering"],
    ),
    // No tier: the judge shares constants, Fresnel and the facets' distribution only. Its pictures
    // are of the same exhibit, scene and lamps.
    (
        "reference",
        &[
            "manifest",
            "maps",
            "optics::fresnel::fresnel_conductor",
            "optics::fresnel::fresnel_dielectric",
            "optics::lamp::DISTANCE2_MIN_MM2",
            "optics::lamp::Light",
            "optics::lamp::Shape",
            "optics::medium::BodyConstants",
            "optics::medium::Matter",
            "optics::medium::ParticleConstants",
            "optics::microfacet::d_ggx",
        ],
    ),
    // A capture file is read by the manifest's machinery, and what is fitted is the paper's optics.
    (
        "prepare",
        &["units", "colour", "optics", "maps", "manifest", "lettering"],
    ),
    // What comes in is an exhibit or a capture, and what goes out an exhibit's.
    (
        "exchange",
        &[
            "colour",
            "maps",
            "manifest",
            "prepare::capture",
            "prepare::lights",
        ],
    ),
    ("sample", &["maps", "colour", "units"]),
    // Tiers are held against the judge here, and predicted on scenes.
    (
        "tradeoff",
        &[
            "units",
            "colour",
            "optics",
            "reference",
            "maps",
            "manifest",
            "needs",
            "lettering",
        ],
    ),
    ("develop", &["colour"]),
    // A print that can be made again: its scale bar, and what it was made from.
    (
        "figure",
        &[
            "colour",
            "develop",
            "lettering",
            "manifest",
            "measure",
            "needs",
            "optics::tier",
            "tradeoff",
        ],
    ),
    ("sheet", &["bevy", "needs", "manifest", "maps", "optics"]),
    (
        "stage",
        &[
            "bevy", "manifest", "needs", "maps", "optics", "sheet", "colour",
            // Legends are read in the language of whoever is there.
            "wording",
        ],
    ),
    ("device", &["bevy"]),
    ("compute", &["bevy", "device", "optics", "sheet"]),
    (
        "shot",
        &["bevy", "device", "manifest", "maps", "stage", "colour"],
    ),
    (
        "cost",
        &[
            "bevy",
            "device",
            "manifest",
            "maps",
            "needs",
            "optics::tier",
            "sheet",
            "shot",
            "stage",
            "tradeoff",
        ],
    ),
    (
        "visitor",
        &[
            "cost",
            "tradeoff",
            "bevy",
            "manifest",
            "stage",
            "device",
            "optics::tier",
            "units",
            // What a meter should read of the test chart.
            "colour",
            // Tools in the hand are those of the command line.
            "readings",
            // What is exported from the window: how small a figure may be, and its table's file.
            "figure::bar::LEAST_PX",
            "maps::encode",
            // What is read, and in which letters.
            "wording",
            "installation::Pin",
        ],
    ),
    // A museum's wordings are told of as its manifests are.
    ("wording", &["manifest"]),
    // Publishing checks an exhibit as it is read; what is supervised is another process. The house hangs
    // the visitor's picture on the displays of an installation, and follows its hours.
    (
        "wall",
        &[
            "bevy",
            "colour",
            "installation",
            "manifest",
            // A display's own values.
            "maps::LATTICE_STEPS",
            "maps::Lattice",
            "stage",
            "visitor",
            "wording",
        ],
    ),
    ("cli", &["*"]),
];

/// Files longer than this are worth splitting.
const LONG_FILE: usize = 600;

/// A source file by its path within src.
struct Source {
    file: String,
    /// Without comments, the contents of literals, and test modules.
    code: String,
}

impl Source {
    fn new(file: &str, text: &str) -> Self {
        Self {
            file: file.to_owned(),
            code: without_tests(&code_only(text)),
        }
    }

    /// Names of the modules around it, from the crate's root.
    fn path(&self) -> Vec<&str> {
        let path = self.file.trim_end_matches(".rs");
        let path = path.trim_end_matches("/mod");
        path.split('/').collect()
    }

    fn module(&self) -> &str {
        self.path()[0]
    }
}

fn src() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// Every Rust file under src, sorted.
fn files() -> Vec<(String, String)> {
    fn collect(folder: &Path, files: &mut Vec<(String, String)>) {
        let entries = fs::read_dir(folder).unwrap_or_else(|error| {
            panic!("{}: {error}", folder.display());
        });
        for entry in entries {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                collect(&path, files);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = fs::read_to_string(&path).expect("text");
                let within = path.strip_prefix(src()).expect("under src");
                files.push((within.to_string_lossy().replace('\\', "/"), text));
            }
        }
    }
    let mut found = Vec::new();
    collect(&src(), &mut found);
    found.sort();
    found
}

/// Blanks comments and the contents of string and character literals.
fn code_only(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let at = |i: usize| chars.get(i).copied().unwrap_or('\n');
    let mut code = String::with_capacity(text.len());
    let mut i = 0;
    while i < chars.len() {
        let is_word = i > 0 && (at(i - 1).is_alphanumeric() || at(i - 1) == '_');
        match (at(i), at(i + 1)) {
            ('/', '/') => {
                while i < chars.len() && at(i) != '\n' {
                    i += 1;
                }
            }
            ('/', '*') => {
                let mut depth = 0;
                loop {
                    match (at(i), at(i + 1)) {
                        ('/', '*') => depth += 1,
                        ('*', '/') => depth -= 1,
                        _ => {}
                    }
                    i += 1;
                    if depth == 0 || i >= chars.len() {
                        break;
                    }
                }
                i += 1;
            }
            ('r', '"' | '#') if !is_word && raw_hashes(&chars, i).is_some() => {
                let hashes = raw_hashes(&chars, i).unwrap_or_default();
                i += hashes + 2;
                let closes = |i: usize| at(i) == '"' && (1..=hashes).all(|k| at(i + k) == '#');
                while i < chars.len() && !closes(i) {
                    i += 1;
                }
                i += hashes + 1;
                code.push_str("\"\"");
            }
            ('"', _) => {
                i += 1;
                while i < chars.len() && at(i) != '"' {
                    i += if at(i) == '\\' { 2 } else { 1 };
                }
                i += 1;
                code.push_str("\"\"");
            }
            ('\'', '\\') => {
                i += 3;
                while i < chars.len() && at(i) != '\'' {
                    i += 1;
                }
                i += 1;
            }
            // Otherwise a lifetime.
            ('\'', _) if at(i + 2) == '\'' => i += 3,
            (other, _) => {
                code.push(other);
                i += 1;
            }
        }
    }
    code
}

/// How many # stand between `r` at `i` and the quotation mark of a raw string.
fn raw_hashes(chars: &[char], i: usize) -> Option<usize> {
    let hashes = chars[i + 1..].iter().take_while(|&&c| c == '#').count();
    (chars.get(i + 1 + hashes) == Some(&'"')).then_some(hashes)
}

/// Removes every item behind `#[cfg(test)]`.
fn without_tests(code: &str) -> String {
    const MARK: &str = "#[cfg(test)]";
    let mut kept = String::with_capacity(code.len());
    let mut rest = code;
    while let Some((before, item)) = rest.split_once(MARK) {
        kept.push_str(before);
        let mut depth = 0;
        let end = item.char_indices().find(|&(_, c)| {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                _ => {}
            }
            depth == 0 && matches!(c, '}' | ';')
        });
        rest = end.map_or("", |(i, _)| &item[i + 1..]);
    }
    kept + rest
}

fn is_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The paths, by their segments, that a use tree or path at the start of `text` names.
fn paths(text: &str) -> Vec<Vec<String>> {
    let text = text.trim_start();
    if let Some(list) = text.strip_prefix('{') {
        let mut depth = 0;
        let inside = list
            .split(|c| {
                match c {
                    '{' => depth += 1,
                    '}' => depth -= 1,
                    _ => {}
                }
                depth < 0
            })
            .next()
            .unwrap_or_default();
        let mut depth = 0;
        let members = inside.split(|c| {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                _ => {}
            }
            c == ',' && depth == 0
        });
        return members
            .filter(|member| !member.trim().is_empty())
            .flat_map(paths)
            .collect();
    }
    let name: String = text.chars().take_while(|&c| is_name(c)).collect();
    let rest = &text[name.len()..];
    match rest.trim_start().strip_prefix("::") {
        Some(rest) => paths(rest)
            .into_iter()
            .map(|path| [vec![name.clone()], path].concat())
            .collect(),
        None => vec![vec![name]],
    }
}

/// Paths from the crate's root, and crates of Bevy's, that a source names.
fn imports(source: &Source) -> BTreeSet<Vec<String>> {
    let code = &source.code;
    let mut found = BTreeSet::new();
    let begins = |i: usize| !code[..i].ends_with(is_name);
    for (i, _) in code.match_indices("crate") {
        let rest = &code[i + "crate".len()..];
        if let Some(rest) = rest.trim_start().strip_prefix("::").filter(|_| begins(i)) {
            found.extend(paths(rest));
        }
    }
    for (i, _) in code.match_indices("super::") {
        // `super::super::` is counted from its first word.
        if !begins(i) || code[..i].ends_with("::") {
            continue;
        }
        let climbed = code[i..]
            .split("super::")
            .take_while(|part| part.is_empty())
            .count();
        let rest = &code[i + climbed * "super::".len()..];
        let around = source.path();
        let base = &around[..around.len().saturating_sub(climbed)];
        for path in paths(rest) {
            let absolute = base.iter().map(|&name| name.to_owned()).chain(path);
            found.insert(absolute.collect());
        }
    }
    for (i, _) in code.match_indices("bevy") {
        let name: String = code[i..].chars().take_while(|&c| is_name(c)).collect();
        let is_crate = name == "bevy" || name.starts_with("bevy_");
        let is_path = code[i + name.len()..].trim_start().starts_with("::");
        if begins(i) && is_crate && is_path {
            found.insert(vec!["bevy".to_owned()]);
        }
    }
    found
}

/// Imports that the table does not allow, one line each.
fn violations(source: &Source) -> Vec<String> {
    let module = source.module();
    if matches!(module, "lib" | "main") {
        return Vec::new();
    }
    let Some((_, allowed)) = MAY_IMPORT.iter().find(|(name, _)| *name == module) else {
        return vec![format!("{}: {module} is not in the table", source.file)];
    };
    imports(source)
        .into_iter()
        .filter(|path| path.first().is_some_and(|first| first != module))
        .map(|path| path.join("::"))
        .filter(|path| {
            !allowed.iter().any(|allowed| {
                *allowed == "*" || path == allowed || path.starts_with(&format!("{allowed}::"))
            })
        })
        .map(|path| format!("{}: {module} may not import {path}", source.file))
        .collect()
}

#[test]
fn every_import_is_in_the_table() {
    let faults: Vec<String> = files()
        .iter()
        .flat_map(|(file, text)| violations(&Source::new(file, text)))
        .collect();
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn planted_violations_are_found() {
    let planted = r###"
        //! crate::wall in words, and `bevy::prelude`.
        use crate::{
            maps::{self, encode::{save, load}}, // crate::wall
            stage::{Shown, legend},
            units::Lux,
        };
        use super::super::shot;
        const TEXT: &str = "crate::wall"; const RAW: &str = r#"" crate::wall "#;
        const QUOTE: char = '"'; fn f<'a>(x: &'a u32) -> u32 { crate::sheet::mesh(*x) }
        fn g() -> bevy::prelude::Entity { bevy_ecs :: none() }
        fn h(bevy: u32) -> u32 { bevy }
        #[cfg(test)]
        mod tests { use crate::wall; #[test] fn t() { crate::cli::run(); } }
        fn i() { $crate::visitor::hand(); }
    "###;
    let source = Source::new("optics/deep.rs", planted);
    let expected = [
        "bevy",
        "maps::encode::load",
        "maps::encode::save",
        "maps::self",
        "sheet::mesh",
        "shot",
        "stage::Shown",
        "stage::legend",
        "visitor::hand",
    ]
    .map(|path| format!("optics/deep.rs: optics may not import {path}"));
    assert_eq!(violations(&source), expected);

    let within = Source::new("visitor/hand.rs", "use crate::optics::{tier::Tier, lamp};");
    assert_eq!(
        violations(&within),
        ["visitor/hand.rs: visitor may not import optics::lamp"]
    );
    let stranger = Source::new("cellar.rs", "");
    assert_eq!(
        violations(&stranger),
        ["cellar.rs: cellar is not in the table"]
    );
}

#[test]
fn nothing_is_unsafe_and_every_exception_has_its_reason() {
    for (file, text) in files() {
        let code = code_only(&text);
        for (i, _) in code.match_indices("unsafe") {
            let alone =
                !code[..i].ends_with(is_name) && !code[i + "unsafe".len()..].starts_with(is_name);
            assert!(!alone, "{file}: unsafe code");
        }
        for kind in ["allow(", "expect("] {
            for attribute in ["#[", "#!["] {
                for rest in code.split(&format!("{attribute}{kind}")).skip(1) {
                    let list = rest.split(']').next().unwrap_or_default();
                    assert!(
                        list.contains("reason"),
                        "{file}: {kind}{list} without a reason"
                    );
                }
            }
        }
    }
}

#[test]
fn long_files_are_named() {
    for (file, text) in files() {
        let lines = text.lines().count();
        if lines > LONG_FILE {
            eprintln!("note: src/{file} has {lines} lines; think of splitting it");
        }
    }
}
