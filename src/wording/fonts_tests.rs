use std::fs;

use parley::{
    FontContext, FontFamily, LayoutContext, PositionedLayoutItem, StyleProperty,
    fontique::SourceCache,
};

use super::*;
use crate::wording::{Direction, catalogue::SHIPPED, direction, source};

/// Of the machine, for all that is shipped.
fn found() -> (Wordings, Fonts) {
    let wordings = Wordings::shipped();
    let fonts = Fonts::find(&wordings.letters(), None);
    (wordings, fonts)
}

#[test]
fn every_letter_of_every_shipped_wording_has_a_glyph() {
    let (wordings, fonts) = found();
    let warnings: Vec<String> = fonts.warnings().iter().map(Fault::to_string).collect();
    assert!(warnings.is_empty(), "{}", warnings.join("\n"));
    for language in wordings.languages() {
        assert!(fonts.for_language(language).count() > 0, "{language}");
    }
    let letters = wordings.letters();
    assert!(letters["ja"].contains(&'簀') && letters["ar"].contains(&'ع'));
}

/// A layout of `text` in the fonts of `language`: glyphs in the order of their places, with the byte of
/// the text that each is of, and whether its run goes from right to left.
fn laid(fonts: &Fonts, language: &str, text: &str) -> Vec<(u32, usize, bool)> {
    let mut collection = Collection::new(CollectionOptions {
        shared: false,
        system_fonts: false,
    });
    for face in fonts.faces() {
        collection.register_fonts(face.data().clone(), None);
    }
    assert!(fonts.hint(&mut collection));
    let mut context = FontContext {
        collection,
        source_cache: SourceCache::default(),
    };
    let mut layouts: LayoutContext<()> = LayoutContext::new();
    let mut builder = layouts.ranged_builder(&mut context, text, 1.0, true);
    let face = fonts.for_language(language).next().expect("a face");
    builder.push_default(StyleProperty::FontFamily(FontFamily::named(&face.family)));
    builder.push_default(StyleProperty::FontSize(24.0));
    let mut layout = builder.build(text);
    layout.break_all_lines(None);
    let mut glyphs = Vec::new();
    for line in layout.lines() {
        for item in line.items() {
            let PositionedLayoutItem::GlyphRun(run) = item else {
                panic!("{text}: no run of glyphs");
            };
            let run = run.run();
            for cluster in run.visual_clusters() {
                let at = cluster.text_range().start;
                glyphs.extend(cluster.glyphs().map(|glyph| (glyph.id, at, run.is_rtl())));
            }
        }
    }
    glyphs
}

#[test]
fn every_wording_is_drawn_in_every_language() {
    let (wordings, fonts) = found();
    let mut from_right = 0;
    for language in wordings.languages() {
        for message in source::messages(SHIPPED[0].1) {
            for number in [1, 2, 3, 11, 100] {
                let args: Vec<_> = message
                    .variables
                    .iter()
                    .map(|(name, _)| (*name, number.into()))
                    .collect();
                let text = wordings.say(language, message.id, &args);
                let glyphs = laid(&fonts, language, &text);
                assert!(!glyphs.is_empty(), "{language}: {text}");
                let drawn = |at: usize| text[at..].chars().next().is_some_and(is_drawn);
                for (glyph, at, _) in &glyphs {
                    assert!(
                        *glyph != 0 || !drawn(*at),
                        "{language}: {text:?} lacks {:?}",
                        &text[*at..]
                    );
                }
                if direction(language) == Direction::RightToLeft && number == 1 {
                    let arabic = |(_, at, _): &&(u32, usize, bool)| {
                        text[*at..].starts_with(|c| ('ء'..='ي').contains(&c))
                    };
                    let places: Vec<usize> =
                        glyphs.iter().filter(arabic).map(|(_, at, _)| *at).collect();
                    // What comes first in the text stands furthest to the right.
                    assert!(places.is_sorted_by(|a, b| a >= b), "{text}: {places:?}");
                    from_right += usize::from(places.len() > 1);
                }
                if message.variables.is_empty() {
                    break;
                }
            }
        }
    }
    assert!(
        from_right > 100,
        "{from_right} wordings were seen from right to left"
    );
}

#[test]
fn a_letter_without_a_font_is_drawn_as_none_and_found_out() {
    let (_, fonts) = found();
    // Of Linear B, which no one's wall needs.
    let glyphs = laid(&fonts, "en", "a\u{10000}");
    assert!(glyphs[0].0 != 0 && glyphs[1].0 == 0);
    let arabic: Vec<usize> = laid(&fonts, "en", "ab")
        .iter()
        .map(|(_, at, _)| *at)
        .collect();
    assert_eq!(arabic, [0, 1]);
}

#[test]
fn letters_that_no_font_has_are_told_with_the_line_that_installs_one() {
    let dejavu = Fonts::find(&Letters::new(), None);
    assert!(
        dejavu.faces().is_empty(),
        "nothing is read where nothing is needed"
    );
    let mut letters = Letters::new();
    add(&mut letters, "ja", "紙に触れる\u{2068}");
    add(&mut letters, "en", "Sheet");
    let folder = tempfile::tempdir().expect("a folder");
    let empty = Fonts::find_in(&letters, None, &[folder.path().to_owned()]);
    let said: Vec<String> = empty.warnings().iter().map(Fault::to_string).collect();
    assert_eq!(
        said,
        [
            "warning: en: found no font for S e h t; sudo apt-get install fonts-dejavu-core, or put a font \
         that has them into the folder of fonts",
            "warning: ja: found no font for に る れ 紙 触; sudo apt-get install fonts-motoya-l-cedar, or put a \
         font that has them into the folder of fonts",
        ]
    );
    assert_eq!(empty.for_language("ja").count(), 0);
}

#[test]
fn the_installations_fonts_come_first_and_files_that_are_none_are_told() {
    let (_, system) = found();
    let japanese = system.for_language("ja").last().expect("a face");
    assert!(japanese.has('紙'));
    let folder = tempfile::tempdir().expect("a folder");
    let inner = folder.path().join("house");
    fs::create_dir(&inner).expect("a folder");
    fs::write(inner.join("house.ttf"), japanese.data().as_ref()).expect("a file");
    fs::write(folder.path().join("broken.otf"), "nothing").expect("a file");
    fs::write(folder.path().join("notes.txt"), "nothing").expect("a file");
    let mut letters = Letters::new();
    add(&mut letters, "ja", "紙");
    let fonts = Fonts::find(&letters, Some(folder.path()));
    let paths: Vec<&Path> = fonts
        .for_language("ja")
        .map(|face| face.path.as_path())
        .collect();
    assert_eq!(paths, [inner.join("house.ttf")]);
    let warnings = fonts.warnings();
    assert!(
        warnings.len() == 1
            && warnings[0]
                .to_string()
                .contains("broken.otf: warning: found a file")
    );
    // Cut short anywhere, a font is refused or used, and nothing panics.
    let whole = japanese.data().as_ref();
    for part in 1..20 {
        fs::write(
            folder.path().join("broken.otf"),
            &whole[..whole.len() * part / 20],
        )
        .expect("a file");
        let fonts = Fonts::find_in(&letters, Some(folder.path()), &[]);
        assert!(!fonts.faces().is_empty());
    }
}

#[test]
fn a_line_from_the_right_begins_at_the_right_also_where_all_of_it_is_filled_in() {
    let (wordings, fonts) = found();
    let args = [("quantity", "الطول".into()), ("value", "12 mm".into())];
    let text = wordings.say("ar", "reading", &args);
    let places: Vec<usize> = laid(&fonts, "ar", &text)
        .iter()
        .map(|(_, at, _)| *at)
        .collect();
    let (name, value) = (
        text.find('ا').expect("a letter"),
        text.find("12").expect("digits"),
    );
    let of = |byte: usize| places.iter().position(|at| *at == byte).expect("a glyph");
    assert!(of(value) < of(name), "{places:?}");
}

#[test]
fn each_script_is_asked_of_families_that_have_it() {
    let (_, fonts) = found();
    let of = |script: &[u8; 4]| {
        let script = Script::from_bytes(*script);
        let fallbacks = fonts.fallbacks();
        let found = fallbacks.into_iter().find(|(other, _)| *other == script);
        found.map(|(_, families)| families.len())
    };
    let japanese = fonts
        .for_language("ja")
        .filter(|face| face.has('紙'))
        .count();
    assert_eq!(of(b"Hani"), Some(japanese));
    assert!(of(b"Arab").is_some() && of(b"Hira").is_some() && of(b"Kana").is_some());
}
