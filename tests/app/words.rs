//! What is said in the window, in the language of whoever reads it.

use std::{fs, sync::Arc};

use bevy::{input::touch::TouchPhase, prelude::*};
use recto::{
    manifest::exhibit::Exhibit,
    maps::encode::save_png_rgb8,
    stage::reload::Reread,
    visitor::{
        Intent, Kind, Manners,
        controls::{Control, Interface, Panel},
    },
    wording::Wordings,
};

use super::{
    session::MIDDLE,
    visit::{Session, keep},
};

/// Marks that isolate what has a direction of its own, and begin a line from the right.
const ISOLATED: [char; 2] = ['\u{2068}', '\u{2069}'];
const FROM_RIGHT: char = '\u{200f}';
/// Frames after which a small map on disk is read, each of some ms, on a slow machine.
const PATIENCE: u32 = 3_000;

fn manners(languages: &[&str]) -> Manners {
    Manners {
        languages: languages.iter().map(|tag| (*tag).to_owned()).collect(),
        ..Manners::default()
    }
}

fn session(languages: &[&str]) -> Session {
    Session::new(manners(languages))
}

/// Everything that is written over the picture.
fn texts(session: &mut Session) -> Vec<String> {
    let world = session.world();
    let mut texts = world.query::<&Text>();
    texts.iter(world).map(|text| text.0.clone()).collect()
}

fn wish(session: &mut Session, intent: Intent) {
    session.world().write_message(intent);
    session.frame();
    session.frame();
}

/// The text that has this part, once it is there; with plain spaces.
fn text_with(session: &mut Session, part: &str) -> String {
    for _ in 0..PATIENCE {
        let plain = |text: String| text.replace('\u{a0}', " ");
        let mut all = texts(session).into_iter().map(plain);
        let found = all.find(|text| text.contains(part));
        if let Some(found) = found {
            return found;
        }
        session.frame();
    }
    panic!("{part} is not among {:?}", texts(session));
}

fn speak(session: &mut Session, language: usize) {
    if session.find(Control::Language(language)).is_none() {
        session.press(Control::Open(Panel::More));
    }
    session.press(Control::Language(language));
    session.frame();
}

/// Without numbers, units and symbols, and what is isolated.
fn has_english(text: &str) -> bool {
    let mut isolated = 0;
    let words: String = text
        .chars()
        .filter(|c| {
            isolated += i32::from(*c == ISOLATED[0]) - i32::from(*c == ISOLATED[1]);
            isolated == 0
        })
        .collect();
    let words = words.split(|c: char| !c.is_ascii_alphabetic());
    let known = ["", "mm", "nm", "L", "a", "b", "D"];
    words.into_iter().any(|word| !known.contains(&word))
}

#[test]
fn a_reading_is_worded_anew_for_whoever_chooses_a_language() {
    let mut session = session(&["en", "de", "ar", "ja"]);
    session.press(Control::Open(Panel::Measure));
    session.press(Control::Tool(Some(Kind::Ruler)));
    session.tap(MIDDLE - Vec2::new(100.0, 0.0));
    session.tap(MIDDLE + Vec2::new(61.0, 0.0));
    let english = text_with(&mut session, "length: ");
    assert!(
        english.starts_with("1 · Recto · Ruler · length: "),
        "{english}"
    );
    assert!(english.contains('.') && !english.contains(','), "{english}");
    let value = english.rsplit(": ").next().expect("a value").to_owned();
    assert!(
        texts(&mut session).contains(&value),
        "beside the ruler: {value}"
    );

    speak(&mut session, 1);
    let german = text_with(&mut session, "Länge: ");
    let with_comma = value.replace('.', ",");
    assert_eq!(german, format!("1 · Recto · Lineal · Länge: {with_comma}"));
    let all = texts(&mut session);
    assert!(all.contains(&with_comma), "beside the ruler");
    assert!(!all.iter().any(|text| text.contains("length")), "{all:?}");
    keep(&session.see(), "ruler-de.png");

    speak(&mut session, 2);
    let arabic = text_with(&mut session, "الطول");
    assert!(arabic.contains(FROM_RIGHT), "{arabic}");
    let isolated = format!("{}{value}{}", ISOLATED[0], ISOLATED[1]);
    assert!(arabic.contains(&isolated), "{arabic}");
    keep(&session.see(), "ruler-ar.png");

    speak(&mut session, 3);
    let japanese = text_with(&mut session, "長さ");
    assert!(!has_english(&japanese), "{japanese}");
    assert!(has_english(&english), "it can fail");
    keep(&session.see(), "ruler-ja.png");
}

#[test]
fn what_cannot_be_measured_and_what_is_to_be_known_are_said_in_every_language() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    super::write_exhibit(folder.path());
    // Fine enough for a colour to be the mean of many places.
    let paper = folder.path().join("paper.png");
    save_png_rgb8(&paper, 600, 400, &[[200; 3]; 600 * 400], None).expect("written");
    let mut session = Session::with(manners(&["it", "ja"]), folder);
    session.press(Control::Open(Panel::Measure));
    session.press(Control::Tool(Some(Kind::Profile)));
    session.tap(MIDDLE - Vec2::new(100.0, 0.0));
    session.tap(MIDDLE + Vec2::new(60.0, 0.0));
    let why = text_with(&mut session, "non misurato");
    assert!(
        why.ends_with("il rilievo di questo lato non è stato rilevato"),
        "{why}"
    );
    session.press(Control::Tool(Some(Kind::Probe)));
    session.tap(MIDDLE);
    let note = text_with(&mut session, "D65");
    assert!(note.starts_with("colori di paper.png"), "{note}");
    wish(&mut session, Intent::ReadOut);
    let under = text_with(&mut session, "mm da sinistra");
    assert!(under.ends_with("L* 80,6 · a* 0,0 · b* 0,0"), "{under}");
    speak(&mut session, 1);
    let why = text_with(&mut session, "測定できません");
    assert!(!has_english(&why), "{why}");
}

#[test]
fn keys_are_listed_in_the_language_that_is_read() {
    let mut session = session(&["it", "ar", "de"]);
    wish(&mut session, Intent::Keys);
    let all = texts(&mut session);
    for said in [
        "girare il foglio",
        "N, P",
        "X, Maiusc + X",
        "didascalia",
        "Invio, Backspace",
    ] {
        assert!(all.iter().any(|text| text == said), "{said}: {all:?}");
    }
    keep(&session.see(), "keys-it.png");
    speak(&mut session, 2);
    let all = texts(&mut session);
    for said in ["das Blatt wenden", "X, Umschalt + X", "W, Strg + S"] {
        assert!(all.iter().any(|text| text == said), "{said}: {all:?}");
    }
    keep(&session.see(), "keys-de.png");
    speak(&mut session, 1);
    let all = texts(&mut session);
    assert!(all.iter().any(|text| text == "قلب الورقة"), "{all:?}");
    keep(&session.see(), "keys-ar.png");
}

#[test]
fn a_saved_view_is_told_of_in_the_language_that_is_read() {
    let mut session = session(&["ja", "fr"]);
    wish(&mut session, Intent::SaveView);
    let said = text_with(&mut session, "保存しました");
    assert!(!has_english(&said.replace("view-1", "")), "{said}");
    // A file that somebody else writes meanwhile is not written over.
    let manifest = session.folder().join("exhibit.toml");
    let text = fs::read_to_string(&manifest).expect("a manifest");
    fs::write(&manifest, format!("{text}\n# mine\n")).expect("written");
    wish(&mut session, Intent::SaveView);
    text_with(&mut session, "保存できませんでした");
    keep(&session.see(), "saved-ja.png");
    session.world().resource_mut::<Interface>().language = Some("fr".into());
    session.frame();
    session.frame();
    text_with(&mut session, "non enregistré");
}

#[test]
fn the_first_touch_and_a_tool_are_told_what_to_do_until_it_is_done() {
    let mut session = session(&["it", "de"]);
    let hint = |session: &mut Session, said: &str| texts(session).iter().any(|text| text == said);
    let turn = "Con un dito giri il foglio";
    assert!(!hint(&mut session, turn), "nobody is there");
    session.touch(1, TouchPhase::Started, MIDDLE);
    session.frame();
    session.frame();
    assert!(hint(&mut session, turn), "{:?}", texts(&mut session));
    keep(&session.see(), "hint-it.png");
    for step in 1..=6 {
        let at = MIDDLE + Vec2::new(15.0 * step as f32, 0.0);
        session.touch(1, TouchPhase::Moved, at);
        session.frame();
    }
    session.lift(1, MIDDLE + Vec2::new(90.0, 0.0));
    session.frame();
    assert!(!hint(&mut session, turn), "it is done");
    session.wait(2.0);
    session.press(Control::Open(Panel::Measure));
    session.press(Control::Tool(Some(Kind::Ruler)));
    session.frame();
    assert!(
        hint(&mut session, "Tocca due punti"),
        "{:?}",
        texts(&mut session)
    );
    keep(&session.see(), "hint-tool-it.png");
    session.world().resource_mut::<Interface>().language = Some("de".into());
    session.frame();
    session.frame();
    let said = "Zwei Stellen berühren";
    assert!(hint(&mut session, said), "in the other language at once");
    session.tap(MIDDLE);
    assert!(hint(&mut session, said), "while it is being laid");
    session.tap(MIDDLE + Vec2::new(80.0, 0.0));
    session.frame();
    assert!(!hint(&mut session, said), "it lies there");
    session.press(Control::Tool(Some(Kind::Angle)));
    session.frame();
    let said = "Drei Stellen berühren; die zweite ist der Scheitel";
    assert!(hint(&mut session, said));
    session.wait(25.0);
    assert!(!hint(&mut session, said), "by itself");
}

/// The exhibit of the session with other languages, in a folder of its own.
fn other(languages: &str) -> (tempfile::TempDir, Arc<Exhibit>) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    super::write_exhibit(folder.path());
    let path = folder.path().join("exhibit.toml");
    let text = fs::read_to_string(&path).expect("a manifest");
    let title = "title = \"Two sheets\"";
    let text = text.replace(title, &format!("{title}\nlanguages = {languages}"));
    fs::write(&path, text).expect("written");
    let (exhibit, _) = Exhibit::read(folder.path()).unwrap_or_else(|faults| panic!("{faults}"));
    (folder, Arc::new(exhibit))
}

#[test]
fn the_next_exhibit_is_read_in_the_same_language_where_it_has_it() {
    let mut session = session(&[]);
    let wordings = Wordings::shipped();
    let exhibits = [
        r#"["en", "it", "de"]"#,
        r#"["it", "fr", "en"]"#,
        r#"["fr", "es"]"#,
    ]
    .map(other);
    let show = |session: &mut Session, k: usize| {
        session.world().write_message(Reread(exhibits[k].1.clone()));
        session.settle();
        session.shown().scene.language
    };
    let home = |session: &mut Session, tag: &str| {
        let label = wordings.label(tag, "home").to_owned();
        texts(session).contains(&label)
    };
    show(&mut session, 0);
    assert!(home(&mut session, "en"));
    speak(&mut session, 1);
    assert!(home(&mut session, "it"));
    assert_eq!(
        show(&mut session, 1).as_deref(),
        Some("it"),
        "not the second one"
    );
    assert!(home(&mut session, "it"));
    assert_eq!(show(&mut session, 2), None, "it has no Italian");
    assert!(home(&mut session, "fr"), "{:?}", texts(&mut session));
    assert_eq!(
        show(&mut session, 0).as_deref(),
        Some("it"),
        "and here again"
    );
    session.press(Control::Home);
    session.frame();
    assert!(home(&mut session, "en"), "the next visitor's");
}
