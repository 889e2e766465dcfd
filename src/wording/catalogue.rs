//! The languages that the program comes with, and what it says in them.

use super::Spoken;

/// Tag and Fluent text of each, English first: it decides which messages there are and which
/// variables they have.
pub const SHIPPED: [(&str, &str); 7] = [
    ("en", include_str!("../../assets/wording/en.ftl")),
    ("it", include_str!("../../assets/wording/it.ftl")),
    ("fr", include_str!("../../assets/wording/fr.ftl")),
    ("de", include_str!("../../assets/wording/de.ftl")),
    ("es", include_str!("../../assets/wording/es.ftl")),
    ("ar", include_str!("../../assets/wording/ar.ftl")),
    ("ja", include_str!("../../assets/wording/ja.ftl")),
];

/// Messages that stand on buttons, where room is short.
pub const BUTTONS: [&str; 63] = [
    "flip",
    "lamp",
    "scenes",
    "compare",
    "overlays",
    "light-table",
    "measure",
    "home",
    "language",
    "text-size",
    "contrast",
    "motion",
    "help",
    "close",
    "next",
    "previous",
    "back",
    "done",
    "take-back",
    "more",
    "enlarge",
    "normal-size",
    "high-contrast",
    "reduced-motion",
    "zoom-in",
    "zoom-out",
    "true-size",
    "hotspots",
    "caption",
    "legend",
    "recto",
    "verso",
    "before",
    "after",
    "zenithal",
    "oblique",
    "raking-left",
    "raking-right",
    "raking-top",
    "raking-bottom",
    "intensity",
    "brighter",
    "dimmer",
    "warmer",
    "cooler",
    "curtain",
    "side-by-side",
    "blend",
    "loupe",
    "difference",
    "flicker",
    "glass",
    "opacity",
    "no-overlay",
    "ruler",
    "line",
    "area",
    "angle",
    "profile",
    "laid-lines",
    "stroke",
    "probe",
    "closed",
];

/// Longest label of a button in characters, combining marks not counted; a full-width one counts
/// as two.
pub const BUTTON_LETTERS: usize = 14;

/// Keys and what they do, for the list of them: each by the id of a wording, or as it is printed on
/// the key, which [`super::Wordings::label`] says as it is.
pub const KEYS: [(&str, &str); 31] = [
    ("keys-drag", "key-turn"),
    ("keys-wheel", "key-zoom"),
    ("keys-double-click", "key-true-size"),
    ("keys-arrows", "key-move"),
    ("F", "key-flip"),
    ("keys-lamp", "key-lamp"),
    ("1  2  3", "key-presets"),
    ("S, Shift + S", "key-state"),
    ("O", "key-overlays"),
    ("[  ]", "key-opacity"),
    ("G, Shift + G", "key-category"),
    ("X, Shift + X", "key-compare"),
    (",  .", "key-share"),
    ("<  >", "key-angle"),
    ("9  0", "key-through"),
    ("R, Shift + R, B, Z", "key-enhance"),
    ("N, P", "key-scene"),
    ("H", "key-home"),
    ("I", "key-hotspots"),
    ("J, Shift + J, Enter", "key-next-hotspot"),
    ("Tab, Shift + Tab, Space", "key-next-control"),
    ("U", "key-controls"),
    ("M, Shift + M", "key-measure"),
    ("Enter, Backspace", "key-end-path"),
    ("V", "key-under"),
    ("W, Ctrl + S", "key-save"),
    ("K", "key-link"),
    ("E, Shift + E", "key-export"),
    ("T, Shift + T", "key-tier"),
    ("C", "key-caption"),
    ("F11, Esc", "key-escape"),
];

/// Names on keys, as [`KEYS`] has them, with the wordings of those that other keyboards name otherwise.
pub const KEY_NAMES: [(&str, &str); 5] = [
    ("Shift", "keyboard-shift"),
    ("Ctrl", "keyboard-control"),
    ("Enter", "keyboard-enter"),
    ("Backspace", "keyboard-backspace"),
    ("Space", "keyboard-space"),
];

/// What stands on keys in a row of [`KEYS`], as keyboards of the language name them.
pub fn keys(spoken: Spoken, keys: &str) -> String {
    if keys.starts_with("keys-") {
        return spoken.say(keys);
    }
    let name = |word: &str| {
        let known = KEY_NAMES.iter().find(|(name, _)| *name == word);
        known.map_or_else(|| word.to_owned(), |(_, id)| spoken.say(id))
    };
    let pieces = keys.split_inclusive([' ', ',']).map(|piece| {
        let word = piece.trim_end_matches([' ', ',']);
        name(word) + &piece[word.len()..]
    });
    pieces.collect()
}

/// The wording of a quantity that a reading names.
pub fn quantity(name: &str) -> Option<&'static str> {
    Some(match name {
        "length" => "quantity-length",
        "area" => "quantity-area",
        "perimeter" => "quantity-perimeter",
        "angle" => "quantity-angle",
        "width" => "quantity-width",
        "height without the trend (Pt)" => "quantity-height",
        "roughness without the trend (Pq)" => "quantity-roughness",
        "trend" => "quantity-trend",
        "spacing of laid lines" => "quantity-laid-spacing",
        "direction of laid lines" => "quantity-laid-direction",
        "spacing of chain lines" => "quantity-chain-spacing",
        "direction of chain lines" => "quantity-chain-direction",
        "ΔE00" => "quantity-difference",
        // Symbols of CIELAB are the same everywhere.
        _ => return None,
    })
}
