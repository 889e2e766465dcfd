use std::{collections::BTreeSet, fs};

use super::{catalogue::*, *};
use crate::manifest::Severity;

fn ids() -> Vec<&'static str> {
    let english = source::messages(SHIPPED[0].1);
    english.into_iter().map(|message| message.id).collect()
}

fn variables(text: &str) -> Vec<(&str, BTreeSet<&str>)> {
    let mut all: Vec<(&str, BTreeSet<&str>)> = source::messages(text)
        .into_iter()
        .map(|message| {
            (
                message.id,
                message.variables.iter().map(|(name, _)| *name).collect(),
            )
        })
        .collect();
    all.sort();
    all
}

fn museum(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        fs::write(folder.path().join(name), text).expect("a file");
    }
    folder
}

fn read(files: &[(&str, &str)]) -> (Wordings, Vec<String>) {
    let folder = museum(files);
    let (wordings, warnings) = Wordings::with_folder(folder.path()).expect("no errors");
    (wordings, told(warnings, folder.path()))
}

fn refused(files: &[(&str, &str)]) -> Vec<String> {
    let folder = museum(files);
    let faults = Wordings::with_folder(folder.path()).expect_err("faults");
    told(faults, folder.path())
}

fn told(faults: impl IntoIterator<Item = Fault>, folder: &Path) -> Vec<String> {
    let folder = format!("{}/", folder.display());
    let words = faults
        .into_iter()
        .map(|fault| fault.to_string().replace(&folder, ""));
    words.collect()
}

#[test]
fn wordings_can_be_shared_between_threads() {
    fn shared<T: Send + Sync>() {}
    shared::<Wordings>();
}

#[test]
fn every_language_has_every_message_with_the_same_variables() {
    let english = variables(SHIPPED[0].1);
    assert!(english.len() > 100, "{}", english.len());
    for (tag, text) in SHIPPED {
        let (known, written): (Vec<_>, Vec<_>) = (english.clone(), variables(text));
        for (known, written) in known.iter().zip(&written) {
            assert_eq!(known, written, "{tag}");
        }
        assert_eq!(known.len(), written.len(), "{tag}");
    }
    let mut once = ids();
    once.sort_unstable();
    once.dedup();
    assert_eq!(once.len(), ids().len(), "an id is written twice");
}

#[test]
fn what_is_shipped_has_no_fault() {
    let files: Vec<(String, &str)> = SHIPPED
        .map(|(tag, text)| (format!("{tag}.ftl"), text))
        .into();
    let files: Vec<(&str, &str)> = files
        .iter()
        .map(|(name, text)| (name.as_str(), *text))
        .collect();
    assert_eq!(read(&files).1, Vec::<String>::new());
}

#[test]
fn buttons_are_labels_without_variables() {
    let wordings = Wordings::shipped();
    for id in BUTTONS {
        for tag in wordings.languages() {
            let label = wordings.label(tag, id);
            assert!(ids().contains(&id), "{id}");
            assert!(
                label != id && letters(label) <= BUTTON_LETTERS,
                "{tag}: {id} = {label}"
            );
        }
    }
}

#[test]
fn a_label_of_fifteen_letters_is_warned_of() {
    let (_, warnings) = read(&[(
        "it.ftl",
        "flip = Rovescia il foglio\nlamp = Lampada grande\n",
    )]);
    assert_eq!(
        warnings,
        [
            "it.ftl:1:1: warning: flip: found 18 letters on a button; allowed: at most 14; find a shorter \
          word, or see whether it fits"
        ]
    );
    assert_eq!(letters("文字を大きく"), 12);
    assert_eq!(letters("جنبًا إلى جنب"), 12);
}

#[test]
fn countdowns_have_the_plurals_of_their_language() {
    let wordings = Wordings::shipped();
    let say = |tag: &str, seconds: u32| {
        let text = wordings.say(tag, "countdown", &[("seconds", seconds.into())]);
        text.replace(['\u{200f}', '\u{2068}', '\u{2069}'], "")
    };
    // CLDR: zero 0, one 1, two 2, few 3–10, many 11–99, other 100–102.
    for (seconds, end) in [
        (0, "الآن"),
        (1, "ثانية واحدة"),
        (2, "ثانيتين"),
        (3, "3 ثوانٍ"),
        (10, "10 ثوانٍ"),
        (11, "11 ثانية"),
        (99, "99 ثانية"),
        (100, "100 ثانية"),
        // From 103 on, the rules of intl_pluralrules 7 are not CLDR's: no countdown is so long.
    ] {
        let said = say("ar", seconds);
        assert!(said.ends_with(end), "{seconds}: {said}");
    }
    for (tag, one, other) in [
        ("en", "1 second", "10 seconds"),
        ("it", "1 secondo", "10 secondi"),
        ("fr", "1 seconde", "10 secondes"),
        ("de", "1 Sekunde", "10 Sekunden"),
        ("es", "1 segundo", "10 segundos"),
        ("ja", "あと1秒で最初に戻ります", "あと10秒で最初に戻ります"),
    ] {
        assert!(say(tag, 1).ends_with(one), "{}", say(tag, 1));
        assert!(say(tag, 10).ends_with(other), "{}", say(tag, 10));
    }
    // French alone counts nothing as one.
    assert!(say("fr", 0).ends_with("0 seconde"));
    assert!(say("it", 0).ends_with("0 secondi"));
}

#[test]
fn a_variant_is_chosen_by_a_word() {
    let wordings = Wordings::shipped();
    let args = |from: &'static str| {
        [
            ("elevation", Value::from(12.0)),
            ("azimuth", 180.0.into()),
            ("from", from.into()),
        ]
    };
    assert_eq!(
        wordings.say("en", "lamp-place", &args("left")),
        "lamp 12° high, from the left (180°)"
    );
    assert_eq!(
        wordings.say("de", "lamp-place", &args("top")),
        "Lampe 12° hoch, vom oberen Rand (180°)"
    );
}

#[test]
fn a_language_falls_back_to_what_it_derives_from_then_to_english_then_to_the_id() {
    let (wordings, warnings) = read(&[
        (
            "de-AT.ftl",
            "language-name = Deutsch (Österreich)\nflip = Umdrehen\n",
        ),
        ("nl.ftl", "flip = Omkeren\n"),
    ]);
    let tags: Vec<&str> = wordings.languages().collect();
    assert_eq!(
        tags,
        ["en", "it", "fr", "de", "es", "ar", "ja", "de-AT", "nl"]
    );
    assert_eq!(wordings.label("de-AT", "flip"), "Umdrehen");
    assert_eq!(wordings.label("DE_at", "flip"), "Umdrehen");
    assert_eq!(wordings.label("de-AT", "lamp"), "Lampe");
    assert_eq!(wordings.label("de-CH-1996", "flip"), "Wenden");
    assert_eq!(wordings.label("nl", "flip"), "Omkeren");
    assert_eq!(wordings.label("nl", "lamp"), "Lamp");
    assert_eq!(wordings.label("xx", "lamp"), "Lamp");
    assert_eq!(wordings.label("", "lamp"), "Lamp");
    assert_eq!(wordings.label("de", "nobody-says"), "nobody-says");
    assert_eq!(wordings.say("ja", "nobody-says", &[]), "nobody-says");
    assert_eq!(wordings.language_name("ja"), "日本語");
    assert_eq!(wordings.language_name("de-AT"), "Deutsch (Österreich)");
    assert_eq!(wordings.language_name("de-CH"), "Deutsch");
    // Dutch is not called English.
    assert_eq!(wordings.language_name("nl"), "nl");
    let [of_nl] = warnings.as_slice() else {
        panic!("{warnings:?}");
    };
    assert!(
        of_nl.starts_with("nl.ftl: warning: found no wording for after, "),
        "{of_nl}"
    );
}

#[test]
fn the_museum_replaces_single_messages_and_keeps_the_rest() {
    let (wordings, warnings) = read(&[
        (
            "it.ftl",
            "\u{feff}-foglio = carta\nattract-invitation = Tocca la { -foglio }\n",
        ),
        ("notes.txt", "not a wording"),
    ]);
    assert_eq!(warnings, Vec::<String>::new());
    assert_eq!(wordings.label("it", "attract-invitation"), "Tocca la carta");
    assert_eq!(wordings.label("it", "lamp"), "Lampada");
    assert_eq!(
        wordings.label("en", "attract-invitation"),
        "Touch the sheet"
    );
}

#[test]
fn directions_are_isolated_only_from_right_to_left() {
    let wordings = Wordings::shipped();
    for tag in wordings.languages() {
        let text = wordings.say(tag, "hotspot-leads", &[("title", "The bridge".into())]);
        let isolated = text.contains('\u{2068}') && text.contains('\u{2069}');
        assert_eq!(isolated, tag == "ar", "{tag}: {text}");
    }
    assert_eq!(direction("ar"), Direction::RightToLeft);
    assert_eq!(direction("HE-il"), Direction::RightToLeft);
    assert_eq!(direction("az-Arab-IR"), Direction::RightToLeft);
    assert_eq!(direction("ks-Deva"), Direction::LeftToRight);
    assert_eq!(direction("de-1996"), Direction::LeftToRight);
    assert_eq!(direction(""), Direction::LeftToRight);
}

#[test]
fn decimals_are_separated_as_the_language_does() {
    let wordings = Wordings::shipped();
    let times = [("times", Value::from(1.5))];
    assert_eq!(
        wordings.say("en", "comparing-loupe", &times),
        "loupe, 1.5 times"
    );
    assert_eq!(
        wordings.say("de", "comparing-loupe", &times),
        "Lupe, 1,5fach"
    );
    assert_eq!(
        wordings.say("ja", "comparing-loupe", &times),
        "ルーペ、1.5倍"
    );
}

#[test]
fn missing_arguments_do_no_harm() {
    let wordings = Wordings::shipped();
    for id in ids() {
        for tag in wordings.languages() {
            assert!(!wordings.say(tag, id, &[]).is_empty(), "{tag} {id}");
        }
    }
    // The plural rules alone would panic at these.
    for seconds in [
        f64::NAN,
        f64::INFINITY,
        -1e300,
        1e-300,
        1e19,
        0.1 + 0.2,
        -0.0,
    ] {
        for tag in wordings.languages() {
            let said = wordings.say(tag, "countdown", &[("seconds", seconds.into())]);
            assert!(!said.is_empty() && !said.contains("000000004"), "{said}");
        }
    }
}

#[test]
fn all_faults_of_all_files_are_told_at_once() {
    let faults = refused(&[
        (
            "de.ftl",
            "flip = Wenden\nflop = Wenden\ncountdown = Noch { $secnds }\nlamp\nstay = { nobody }\n\
             closed = Zu { \"{ $no }\" }\n",
        ),
        ("english.en.ftl", "flip = Flip\n"),
        (
            "it.ftl",
            "staff-wait = Attendere\nhome = { home }\nflip = Gira {\n\nlamp = Luce\n",
        ),
    ]);
    let expected = [
        "english.en.ftl: found a file named \"english.en\", which is no language; allowed: a language tag \
         (BCP 47), such as it.ftl or de-AT.ftl; name the file by its language",
        "de.ftl:2:1: flop: found a message that Recto does not say; allowed: the ids of \
         assets/wording/en.ftl; did you mean \"flip\"?",
        "de.ftl:3:1: warning: countdown: found a wording without $seconds; allowed: $seconds; put it in, \
         unless it is left out on purpose",
        "de.ftl:3:20: countdown: found the variable $secnds; allowed: $seconds; did you mean \"seconds\"?",
        "de.ftl:5:1: stay: found a wording that cannot be said (Resolver error: Unknown message: nobody)",
        "it.ftl:1:1: warning: staff-wait: found a wording without $seconds",
        "it.ftl:2:1: home: found a wording that cannot be said (Resolver error: Cyclical dependency",
    ];
    for expected in expected {
        assert!(
            faults.iter().any(|fault| fault.starts_with(expected)),
            "{expected}\nis not in\n{}",
            faults.join("\n")
        );
    }
    let syntax = |file: &str| {
        let of_file = |fault: &&String| fault.starts_with(file) && fault.contains("not Fluent");
        faults.iter().filter(of_file).count()
    };
    assert!(syntax("de.ftl:") > 0 && syntax("it.ftl:") > 0, "{faults:?}");
    assert!(
        faults.iter().all(|fault| !fault.contains("$no")),
        "{faults:?}"
    );
}

#[test]
fn files_that_cannot_be_read_are_faults() {
    let folder = museum(&[
        ("en.ftl", ""),
        ("EN.ftl", ""),
        ("de.ftl", &"{".repeat(200_000)),
    ]);
    fs::write(folder.path().join("fr.ftl"), b"flip = \xff").expect("a file");
    fs::write(folder.path().join("es.ftl"), vec![b'#'; 300_000]).expect("a file");
    fs::create_dir(folder.path().join("it.ftl")).expect("a folder");
    let long = "flip = { 12345678901234567890123 ->\n   *[other] Gira\n }\n";
    fs::write(folder.path().join("ja.ftl"), long).expect("a file");
    let faults = Wordings::with_folder(folder.path()).expect_err("faults");
    let faults = told(faults, folder.path());
    for expected in [
        "en.ftl: found the language \"en\"",
        "de.ftl:1:101: found braces within braces",
        "fr.ftl:1:8: found bytes that are not UTF-8",
        "es.ftl: found a file of 300000 bytes",
        "it.ftl: found something that is not a file",
        "ja.ftl:1:22: found a number too long",
    ] {
        assert!(
            faults.iter().any(|fault| fault.starts_with(expected)),
            "{faults:?}"
        );
    }
    assert_eq!(faults.len(), 6);
    let nowhere = folder.path().join("nowhere");
    assert!(Wordings::with_folder(&nowhere).is_err());
    let empty = museum(&[]);
    let (_, warnings) = Wordings::with_folder(empty.path()).expect("no errors");
    assert!(warnings.len() == 1 && warnings[0].severity == Severity::Warning);
}

#[test]
fn no_text_makes_it_panic_or_hang() {
    use proptest::prelude::*;
    let tokens = prop::sample::select(vec![
        "flip",
        "countdown",
        " = ",
        "\n",
        "\n\n",
        "    ",
        "{ ",
        " }",
        "$seconds",
        "$",
        "->",
        "[one]",
        "*[other]",
        "*",
        "[",
        "]",
        "\"",
        "\\",
        "\\u00e9",
        "-",
        "-term",
        ".a",
        "#",
        "## ",
        "(",
        ")",
        "é",
        "日",
        "NUMBER(",
        ",",
        ": 1",
        "1.5",
        "\r\n",
        "\u{2068}",
        "{ flip }",
    ]);
    let texts = prop::collection::vec(tokens, 0..60).prop_map(|tokens| tokens.concat());
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("de.ftl");
    runner
        .run(&texts, |text| {
            fs::write(&file, &text).expect("a file");
            if let Ok((wordings, _)) = Wordings::with_folder(folder.path()) {
                wordings.say("de", "countdown", &[("seconds", 3.into())]);
            }
            Ok(())
        })
        .expect("no panic");
}

#[test]
fn numbers_have_a_minus_sign_and_no_sign_of_nothing() {
    assert_eq!(number("en", -1.25, 1), "−1.2");
    assert_eq!(number("de", -1.25, 2), "−1,25");
    assert_eq!(number("de-AT", 1000.0, 0), "1000");
    assert_eq!(number("ar", -0.04, 1), "0.0");
    assert_eq!(number("fr", f64::NAN, 2), "NaN");
    let wordings = Wordings::shipped();
    let [arabic, italian] = ["ar", "it"].map(|language| Spoken {
        wordings: &wordings,
        language,
    });
    assert_eq!(italian.short(20.0, 2), "20");
    assert_eq!(italian.short(7.505, 2), "7,5");
    assert_eq!(italian.short(400.0, 0), "400");
    assert_eq!(italian.isolated("view"), "view");
    assert_eq!(arabic.isolated("view"), "\u{2068}view\u{2069}");
    assert_eq!(arabic.isolated(""), "");
}

#[test]
fn keys_are_named_as_keyboards_of_the_language_name_them() {
    let wordings = Wordings::shipped();
    let said = |language, of| {
        let spoken = Spoken {
            wordings: &wordings,
            language,
        };
        keys(spoken, of)
    };
    assert_eq!(
        said("en", "Tab, Shift + Tab, Space"),
        "Tab, Shift + Tab, Space"
    );
    assert_eq!(
        said("de", "Tab, Shift + Tab, Space"),
        "Tab, Umschalt + Tab, Leertaste"
    );
    assert_eq!(said("it", "1  2  3"), "1  2  3");
    assert_eq!(said("fr", ",  ."), ",  .");
    assert_eq!(said("es", "W, Ctrl + S"), "W, Ctrl + S");
    assert_eq!(said("fr", "keys-arrows"), "flèches");
    for (name, id) in KEY_NAMES {
        assert_eq!(said("en", name), name, "{id}");
    }
}

#[test]
fn the_command_line_has_english_alone() {
    let english = Wordings::english();
    assert_eq!(english.languages().collect::<Vec<_>>(), ["en"]);
    assert_eq!(english.label("en", "key-flip"), "turn the sheet over");
}

/// The literal ids that the program's own sources ask for.
fn asked_for() -> BTreeSet<String> {
    fn collect(folder: &Path, ids: &mut BTreeSet<String>) {
        for entry in fs::read_dir(folder).expect("a folder").flatten() {
            let path = entry.path();
            if path.is_dir() {
                collect(&path, ids);
            } else if let Ok(text) = fs::read_to_string(&path) {
                for asks in ["spoken.say(", "spoken.fill("] {
                    let first = |rest: &str| {
                        let literal = rest.trim_start().strip_prefix('"')?;
                        let id = literal.split('"').next()?;
                        let is_id = |c: char| c.is_ascii_lowercase() || c == '-';
                        id.chars().all(is_id).then(|| id.to_owned())
                    };
                    ids.extend(text.split(asks).skip(1).filter_map(first));
                }
            }
        }
    }
    let mut ids = BTreeSet::new();
    collect(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut ids);
    ids
}

#[test]
fn what_the_program_asks_for_is_a_message() {
    let (known, mut asked) = (ids(), asked_for());
    asked.extend(KEYS.iter().map(|(_, what)| (*what).to_owned()));
    let words = KEYS
        .iter()
        .map(|(keys, _)| *keys)
        .filter(|keys| keys.starts_with("keys-"));
    asked.extend(words.map(str::to_owned));
    assert!(asked.len() > 10, "{asked:?}");
    let unknown: Vec<String> = asked
        .into_iter()
        .filter(|id| !known.contains(&id.as_str()))
        .collect();
    assert!(unknown.is_empty(), "{unknown:?}");
}

#[test]
fn every_quantity_that_a_reading_names_has_a_wording() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/readings");
    let named = |file: &str, call: &str| -> Vec<String> {
        let text = fs::read_to_string(src.join(file)).expect("a source");
        let literals = text.split(call).skip(1);
        literals
            .filter_map(|rest| rest.split('"').next().map(str::to_owned))
            .collect()
    };
    let mut names = Vec::new();
    for file in ["mod.rs", "relief.rs", "stroke.rs", "colour.rs"] {
        for call in ["Value::new(\"", "Value::as_known(\""] {
            names.extend(named(file, call));
        }
    }
    names.extend(
        named("lines.rs", "\"spacing ")
            .iter()
            .map(|name| format!("spacing {name}")),
    );
    names.extend(
        named("lines.rs", "\"direction ")
            .iter()
            .map(|name| format!("direction {name}")),
    );
    assert!(names.len() > 10, "{names:?}");
    for name in names {
        let id = quantity(&name).unwrap_or_else(|| panic!("{name} has no wording"));
        assert!(ids().contains(&id), "{id}");
    }
}
