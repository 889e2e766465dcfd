//! What there is to control in what is shown, in the words of the language that is read.

use bevy::prelude::*;

pub use crate::wording::Spoken;

use super::{
    Control, Facts, Interface, Panel, Preset,
    icons::Icon,
    layout::{Item, Look},
};
use crate::{
    manifest::exhibit::{CompareMode, Exhibit, SideName},
    stage::Shown,
    visitor::{
        hand::Hand,
        lamp::LampPlace,
        measuring::{Kind, Measuring},
        phrases,
    },
};

/// Ends of the slider of the lamp's colour: even steps in mired look even.
const MIRED: [f64; 2] = [1e6 / 2200.0, 1e6 / 8000.0];
/// What a lamp is taken for whose colour is not a temperature.
const KELVIN: f64 = 5000.0;
/// Octaves that the slider of the lamp's light goes up and down.
const OCTAVES: f64 = 2.0;
/// Of the presets.
pub const OVERHEAD_DEG: f64 = 90.0;
pub const OBLIQUE_DEG: f64 = 45.0;
pub const RAKING_DEG: f64 = 12.0;

/// From a slider's place to kelvin, and back.
pub fn kelvin(value: f64) -> f64 {
    let mired = MIRED[0] + (MIRED[1] - MIRED[0]) * value.clamp(0.0, 1.0);
    (1e6 / mired / 50.0).round() * 50.0
}

fn warmth(kelvin: f64) -> f64 {
    ((1e6 / kelvin - MIRED[0]) / (MIRED[1] - MIRED[0])).clamp(0.0, 1.0)
}

/// From a slider's place to a factor of the lamp's light, and back.
pub fn gain(value: f64) -> f64 {
    let octaves = (2.0 * value.clamp(0.0, 1.0) - 1.0) * OCTAVES;
    // So that the middle is as written.
    ((octaves * 10.0).round() / 10.0).exp2()
}

fn intensity(gain: f64) -> f64 {
    (gain.log2() / OCTAVES + 1.0) / 2.0
}

/// The wording of a mode.
pub fn mode_id(mode: CompareMode) -> &'static str {
    match mode {
        CompareMode::Curtain => "curtain",
        CompareMode::SideBySide => "side-by-side",
        CompareMode::Blend => "blend",
        CompareMode::Loupe => "loupe",
        CompareMode::Difference => "difference",
        CompareMode::Flicker => "flicker",
        CompareMode::Glass => "glass",
    }
}

/// What there is to control.
pub fn facts(
    shown: &Shown,
    hand: &Hand,
    measuring: &Measuring,
    interface: &Interface,
    (spoken, languages): (Spoken, &[String]),
) -> Facts {
    let exhibit = &shown.exhibit;
    let title = |scene: usize| {
        let scene = &exhibit.scenes[scene];
        let named = shown.text(&scene.title);
        named.unwrap_or(&scene.id).to_owned()
    };
    let signs = [Icon::Previous, Icon::Next];
    Facts {
        open: interface.open.clone(),
        latest: interface.latest,
        bar: bar(shown, hand, measuring, interface, spoken),
        scenes: (0..exhibit.scenes.len()).map(title).collect(),
        scene: hand.scene(),
        first_scene: interface.first_scene,
        arrows: Some(match spoken.from_right() {
            true => [signs[1], signs[0]],
            false => signs,
        }),
        lamp: hand.lamp_seen().map(|at| at.as_vec2()),
        lamp_words: hand
            .lamp()
            .map_or(String::new(), |lamp| dial_words(lamp, spoken)),
        presets: presets(hand, shown, spoken),
        sliders: sliders(hand, shown, spoken),
        list: list(shown, hand, measuring, interface, (spoken, languages)),
        hint: None,
        countdown: None,
        staff: None,
    }
}

fn bar(
    shown: &Shown,
    hand: &Hand,
    measuring: &Measuring,
    interface: &Interface,
    spoken: Spoken,
) -> Vec<Item> {
    let drawing = shown.exhibit.drawing_of(&shown.scene);
    let open = |panel, icon, id: &str, active: bool| {
        let on = interface.open.contains(&panel) || active;
        Item::button(Control::Open(panel), Some(icon), spoken.say(id), on)
    };
    let mut items = vec![Item::button(
        Control::Home,
        Some(Icon::Home),
        spoken.say("home"),
        false,
    )];
    if drawing.verso.is_some() {
        let flip = Item::button(Control::Flip, Some(Icon::Flip), spoken.say("flip"), false);
        items.push(flip);
    }
    items.push(open(Panel::Light, Icon::Lamp, "lamp", false));
    if shown.exhibit.scenes.len() > 1 {
        items.push(open(Panel::Scenes, Icon::Scenes, "scenes", false));
    }
    if !hand.comparisons().is_empty() {
        let on = shown.scene.compare.is_some();
        items.push(open(Panel::Compare, Icon::Compare, "compare", on));
    }
    if !hand.layers().is_empty() {
        let on = !shown.scene.overlays.is_empty();
        items.push(open(Panel::Layers, Icon::Layers, "overlays", on));
    }
    let on = measuring.kind().is_some();
    items.push(open(Panel::Measure, Icon::Measure, "measure", on));
    items.push(open(Panel::More, Icon::More, "more", false));
    items
}

fn presets(hand: &Hand, shown: &Shown, spoken: Spoken) -> Vec<Item> {
    let button = |preset: Preset| {
        let (icon, id) = match preset {
            Preset::Zenithal => (Icon::Overhead, "zenithal"),
            Preset::Oblique => (Icon::Oblique, "oblique"),
            Preset::Raking(2) => (Icon::Raking(2), "raking-left"),
            Preset::Raking(0) => (Icon::Raking(0), "raking-right"),
            Preset::Raking(1) => (Icon::Raking(1), "raking-top"),
            Preset::Raking(_) => (Icon::Raking(3), "raking-bottom"),
            Preset::LightTable => (Icon::Through, "light-table"),
        };
        let on = preset == Preset::LightTable && shown.scene.transmitted > 0.0;
        Item::button(Control::Preset(preset), Some(icon), spoken.say(id), on)
    };
    let can = |preset: &Preset| *preset == Preset::LightTable || hand.lamp().is_some();
    Preset::ALL.into_iter().filter(can).map(button).collect()
}

fn sliders(hand: &Hand, shown: &Shown, spoken: Spoken) -> Vec<Item> {
    let slider = |control, words: String, value: f64| Item {
        control,
        icon: None,
        words,
        look: Look::Slider {
            value: value as f32,
        },
    };
    let mut items = Vec::new();
    if hand.lamp().is_some() {
        let glow = hand.glow();
        let kelvin = glow
            .kelvin
            .or_else(|| hand.written_kelvin())
            .unwrap_or(KELVIN);
        let words = spoken.fill("colour-temperature", &[("kelvin", kelvin.round().into())]);
        items.push(slider(Control::Warmth, words, warmth(kelvin)));
        let times = (glow.gain * 10.0).round() / 10.0;
        let words = spoken.fill("intensity-times", &[("times", times.into())]);
        items.push(slider(Control::Intensity, words, intensity(glow.gain)));
    }
    let share = shown.scene.transmitted;
    let percent = (share * 100.0).round();
    let words = spoken.fill("light-table-share", &[("share", percent.into())]);
    items.push(slider(Control::Through, words, share));
    items
}

fn list(
    shown: &Shown,
    hand: &Hand,
    measuring: &Measuring,
    interface: &Interface,
    (spoken, languages): (Spoken, &[String]),
) -> Vec<Item> {
    let slider = |control, words, value: f64| Item {
        control,
        icon: None,
        words,
        look: Look::Slider {
            value: value as f32,
        },
    };
    let open = |panel| interface.open.contains(&panel);
    let mut items = Vec::new();
    if open(Panel::Compare) {
        let now = shown.scene.compare.as_ref();
        for mode in hand.comparisons() {
            let on = now.is_some_and(|now| now.mode == mode);
            let words = spoken.say(mode_id(mode));
            items.push(Item::button(Control::Mode(Some(mode)), None, words, on));
        }
        let has_share = |mode| matches!(mode, CompareMode::Blend | CompareMode::Glass);
        if let Some(now) = now.filter(|now| has_share(now.mode)) {
            let percent = (now.at * 100.0).round();
            let words = spoken.fill("opacity-share", &[("share", percent.into())]);
            items.push(slider(Control::Share, words, now.at));
        }
        if now.is_some() {
            let words = spoken.say("close");
            items.push(Item::button(
                Control::Mode(None),
                Some(Icon::Close),
                words,
                false,
            ));
        }
    } else if open(Panel::Layers) {
        let drawing = shown.exhibit.drawing_of(&shown.scene);
        let layers = hand.layers();
        for (overlay, opacity) in &layers {
            let described = &drawing.overlays[*overlay];
            let title = shown.text(&described.title).unwrap_or(&described.id);
            let on = opacity.is_some();
            let layer = Control::Layer(*overlay);
            items.push(Item::button(layer, None, title.to_owned(), on));
        }
        if let Some(opacity) = layers.iter().find_map(|(_, opacity)| *opacity) {
            let percent = (opacity * 100.0).round();
            let words = spoken.fill("opacity-share", &[("share", percent.into())]);
            items.push(slider(Control::Opacity, words, opacity));
        }
    } else if open(Panel::Measure) {
        for kind in Kind::ALL {
            let on = measuring.kind() == Some(kind);
            let [name, _] = phrases::tool_ids(kind);
            let words = spoken.say(name);
            items.push(Item::button(Control::Tool(Some(kind)), None, words, on));
        }
        let button = |control, icon, id| Item::button(control, Some(icon), spoken.say(id), false);
        if measuring.laying().is_some() || !measuring.laid().is_empty() {
            items.push(button(Control::TakeBack, Icon::Back, "take-back"));
        }
        if measuring.laying().is_some() {
            items.push(button(Control::Done, Icon::Done, "done"));
        } else if measuring.kind().is_some() {
            items.push(button(Control::Tool(None), Icon::Close, "close"));
        }
    } else if open(Panel::More) {
        let setting = |control, icon, id, on| Item::button(control, Some(icon), spoken.say(id), on);
        if !shown.exhibit.drawing_of(&shown.scene).hotspots.is_empty() {
            let on = hand.shows_hotspots();
            items.push(setting(Control::Hotspots, Icon::Layers, "hotspots", on));
        }
        items.push(setting(Control::Caption, Icon::Caption, "caption", false));
        let larger = interface.text > 0;
        items.push(setting(
            Control::TextSize,
            Icon::TextSize,
            "enlarge",
            larger,
        ));
        let on = interface.contrast;
        items.push(setting(
            Control::Contrast,
            Icon::Contrast,
            "high-contrast",
            on,
        ));
        let on = interface.calm;
        items.push(setting(Control::Calm, Icon::Motion, "reduced-motion", on));
        if languages.len() > 1 {
            for (index, language) in languages.iter().enumerate() {
                let words = spoken.wordings.language_name(language).to_owned();
                let on = language == spoken.language;
                items.push(Item::button(Control::Language(index), None, words, on));
            }
        }
    }
    items
}

/// Where a lamp stands, in two numbers.
fn dial_words(lamp: LampPlace, spoken: Spoken) -> String {
    let numbers = [
        spoken.fill(
            "lamp-elevation",
            &[("elevation", lamp.elevation_deg.round().into())],
        ),
        spoken.fill(
            "lamp-azimuth",
            &[("azimuth", (lamp.azimuth_deg.round() % 360.0).into())],
        ),
    ];
    numbers.join(" · ")
}

/// Where a lamp stands, in words.
pub fn lamp_words(lamp: LampPlace, spoken: Spoken) -> String {
    match lamp.sector() {
        None => spoken.say("lamp-overhead"),
        Some(from) => spoken.fill(
            "lamp-place",
            &[
                ("elevation", lamp.elevation_deg.round().into()),
                ("from", from.into()),
                ("azimuth", (lamp.azimuth_deg.round() % 360.0).into()),
            ],
        ),
    }
}

/// Side `side` in the language that is read.
pub fn side_words(side: SideName, spoken: Spoken) -> String {
    spoken.say(side.word())
}

/// The languages that are on offer: those of the installation, or of the exhibit.
pub fn languages(installed: &[String], exhibit: &Exhibit) -> Vec<String> {
    match installed {
        [] => exhibit.languages.clone(),
        installed => installed.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sliders_come_back_to_where_they_were() {
        for k in 0..=20 {
            let value = f64::from(k) / 20.0;
            assert!((warmth(kelvin(value)) - value).abs() < 0.02);
            assert!((intensity(gain(value)) - value).abs() < 0.02);
        }
        assert_eq!(gain(0.5), 1.0);
        assert!(kelvin(0.0) < kelvin(1.0));
    }
}
