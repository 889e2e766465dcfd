//! The legend of the overlays that lie on the sheet: on screen and in rendered pictures alike.

use bevy::prelude::*;

use super::{Shown, StageSet};
use crate::{
    colour,
    manifest::exhibit::{
        Band, BandMix, BandView, CompareMode, Enhancement, Overlay, OverlayKind, Wording,
    },
    maps::{ColourMapName, DIVERGING},
    wording::{FALLBACK, Spoken, Wordings},
};

/// Where a face that has more than ASCII usually lies; the first found is used.
const FACES: [&str; 4] = [
    "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/TTF/DejaVuSans.ttf",
    "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
    "/System/Library/Fonts/Helvetica.ttc",
];
/// Height of the text as a share of the picture's height, and its least size in pixels.
const TEXT_SHARE: f32 = 0.02;
const TEXT_MIN_PX: f32 = 11.0;
/// The colours of a difference of two members, from none to the top of its scale.
pub const DIFFERENCE_COLOURS: ColourMapName = ColourMapName::Magma;
/// Of numbers, at most.
const DECIMALS: usize = 6;
/// Steps of a continuous legend's bar.
const BAR_STEPS: u32 = 32;

/// Draws the legends.
pub struct LegendPlugin;

impl Plugin for LegendPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<ProgramWords>()
            .add_systems(Startup, load_face)
            .add_systems(
                Update,
                draw.in_set(StageSet::Arrange)
                    .run_if(resource_exists::<Shown>),
            );
    }
}

/// The face of every text.
#[derive(Resource, Clone, Default)]
pub struct Face(pub Handle<Font>);

/// The wordings of the program.
#[derive(Resource, Default)]
pub struct ProgramWords(pub Wordings);

/// The language in which the program's own words are read, where somebody reads them in a window; pictures
/// in files have them in English.
#[derive(Resource, Debug, Default)]
pub struct Speaks(pub String);

/// A tall picture's text is that of one of this shape, height over width.
const SHAPE: f32 = 0.75;

/// The camera that draws the texts, and the size of its picture in pixels, at the foot of which so many
/// are somebody else's.
#[derive(Component)]
pub struct TextCamera {
    pub height: f32,
    /// Where it is tall, people stand before it as before a wide one; infinite where nobody does.
    pub width: f32,
    pub foot: f32,
}

impl TextCamera {
    /// Size of the body text.
    pub fn text_size(&self) -> f32 {
        text_size_for(self.width, self.height)
    }
}

/// Size of the body text for a picture of so many pixels that people stand before.
pub fn text_size_for(width: f32, height: f32) -> f32 {
    text_size(height.min(SHAPE * width))
}

/// The legend's root node.
#[derive(Component)]
struct Legend;

/// A TrueType file: the first face that is found, or the one that is part of the program.
pub fn face() -> Vec<u8> {
    system_face().unwrap_or_else(|| bevy::text::DEFAULT_FONT_DATA.to_vec())
}

fn system_face() -> Option<Vec<u8>> {
    FACES.iter().find_map(|path| std::fs::read(path).ok())
}

fn load_face(mut commands: Commands, mut fonts: ResMut<Assets<Font>>) {
    let handle = system_face()
        .map(|bytes| fonts.add(Font::from_bytes(bytes)))
        .unwrap_or_default();
    commands.insert_resource(Face(handle));
}

/// Size of the body text for a picture of `height` pixels.
pub fn text_size(height: f32) -> f32 {
    (height * TEXT_SHARE).max(TEXT_MIN_PX)
}

fn draw(
    mut commands: Commands,
    shown: Res<Shown>,
    face: Option<Res<Face>>,
    (words, speaks): (Res<ProgramWords>, Option<Res<Speaks>>),
    cameras: Query<(Entity, Ref<TextCamera>)>,
    drawn: Query<Entity, With<Legend>>,
) {
    let (Ok((camera, text)), Some(face)) = (cameras.single(), face) else {
        return;
    };
    let is_spoken_anew = speaks.as_ref().is_some_and(|speaks| speaks.is_changed());
    if !shown.is_changed() && !text.is_changed() && !is_spoken_anew {
        return;
    }
    let language = speaks.as_ref().map(|speaks| speaks.0.as_str());
    let spoken = Spoken {
        wordings: &words.0,
        language: language.filter(|tag| !tag.is_empty()).unwrap_or(FALLBACK),
    };
    for entity in &drawn {
        commands.entity(entity).despawn();
    }
    let overlays = overlays(&shown);
    let difference = shown
        .scene
        .compare
        .as_ref()
        .filter(|comparison| comparison.mode == CompareMode::Difference);
    let marks = enhanced(&shown.scene.enhance, spoken);
    if overlays.is_empty() && difference.is_none() && marks.is_empty() {
        return;
    }
    let size = text.text_size();
    let words = Words {
        shown: &shown,
        face: &face.0,
        spoken,
        size,
    };
    commands
        .spawn((
            Legend,
            UiTargetCamera(camera),
            Node {
                position_type: PositionType::Absolute,
                left: if spoken.from_right() {
                    Val::Px(size)
                } else {
                    Val::Auto
                },
                right: if spoken.from_right() {
                    Val::Auto
                } else {
                    Val::Px(size)
                },
                bottom: Val::Px(size + text.foot),
                padding: UiRect::all(Val::Px(size * 0.7)),
                row_gap: Val::Px(size * 0.35),
                flex_direction: FlexDirection::Column,
                align_items: match spoken.from_right() {
                    true => AlignItems::FlexEnd,
                    false => AlignItems::FlexStart,
                },
                ..default()
            },
            BackgroundColor(Color::srgba(0.05, 0.05, 0.05, 0.85)),
        ))
        .with_children(|rows| {
            for mark in marks {
                rows.spawn(words.line(mark));
            }
            if let Some(comparison) = difference {
                let top = match comparison.full_luminance {
                    Some(full) => {
                        let value = spoken.short(full, DECIMALS);
                        spoken.fill("legend-luminance", &[("value", value.into())])
                    }
                    None => format!("{} ΔE00", spoken.short(comparison.full_delta_e, DECIMALS)),
                };
                words.scale(rows, DIFFERENCE_COLOURS, "0".to_owned(), top);
            }
            for (overlay, opacity) in &overlays {
                let title = words.say(&overlay.title, &overlay.id);
                let share = (opacity * 100.0).round();
                rows.spawn(words.line(spoken.fill(
                    "legend-layer",
                    &[("title", title.into()), ("share", share.into())],
                )));
                match &overlay.kind {
                    OverlayKind::Categorical(entries) => {
                        for entry in entries {
                            rows.spawn(words.row()).with_children(|row| {
                                row.spawn(words.swatch(entry.colour));
                                let label = words.say(&entry.label, "");
                                row.spawn(words.line(label));
                            });
                        }
                    }
                    OverlayKind::Continuous {
                        colour_map,
                        unit,
                        range,
                    } => {
                        let [low, high] = range.map(|end| spoken.short(end, DECIMALS));
                        words.scale(rows, *colour_map, low, format!("{high} {unit}"));
                    }
                    OverlayKind::Bands(view) => {
                        rows.spawn(words.line(bands(view, spoken)));
                        if let BandMix::Difference { full } = view.mix {
                            let full = spoken.short(full, DECIMALS);
                            words.scale(rows, DIVERGING, format!("−{full}"), format!("+{full}"));
                        }
                    }
                    OverlayKind::Picture(_) => {}
                }
            }
        });
}

/// What lies on the sheet, or on the members of a comparison, each overlay once.
fn overlays(shown: &Shown) -> Vec<(Overlay, f64)> {
    let exhibit = &shown.exhibit;
    let mut all: Vec<(Overlay, f64)> = Vec::new();
    let members = exhibit.members(&shown.scene);
    let scenes = if members.is_empty() {
        vec![shown.scene.clone()]
    } else {
        members
    };
    for scene in &scenes {
        for (overlay, opacity) in scene.laid(exhibit.drawing_of(scene)) {
            if !all.iter().any(|(known, _)| *known == overlay) {
                all.push((overlay, opacity));
            }
        }
    }
    all
}

/// What is enhanced, a line each: [`Enhancement::marks`] in the language that is read.
fn enhanced(enhance: &Enhancement, spoken: Spoken) -> Vec<String> {
    let percent = |share: f64| (share * 100.0).round();
    let mut lines = Vec::new();
    if enhance.relief_only {
        lines.push(spoken.say("enhanced-relief"));
    }
    if enhance.exaggerate != 1.0 {
        let times = spoken.number(enhance.exaggerate, 1);
        lines.push(spoken.fill("enhanced-steepness", &[("times", times.into())]));
    }
    if let Some(stretch) = enhance.stretch {
        let [low, high] = stretch.to_array().map(percent);
        let args = [("low", low.into()), ("high", high.into())];
        lines.push(spoken.fill("enhanced-contrast", &args));
    }
    if enhance.sharpen > 0.0 {
        let share = percent(enhance.sharpen);
        lines.push(spoken.fill("enhanced-sharpness", &[("share", share.into())]));
    }
    lines
}

/// Which bands are shown as which colours: [`BandView::words`] in the language that is read.
fn bands(view: &BandView, spoken: Spoken) -> String {
    let nm = |band: &Band| format!("{} nm", spoken.short(band.wavelength_nm, DECIMALS));
    match &view.mix {
        BandMix::Difference { .. } => {
            let ends = [view.bands.first(), view.bands.last()];
            let [first, second] = ends.map(|band| band.map(nm).unwrap_or_default().into());
            let args = [("first", first), ("second", second)];
            spoken.fill("legend-difference", &args)
        }
        BandMix::Colour(_) if view.bands.len() == 1 => {
            let band = nm(&view.bands[0]);
            spoken.fill("legend-band", &[("band", band.into())])
        }
        BandMix::Colour(weights) => {
            let [red, green, blue] = [0, 1, 2].map(|c| {
                let taken = view.bands.iter().zip(weights);
                let taken = taken.filter(|(_, weight)| weight[c] != 0.0);
                let sum: Vec<String> = taken
                    .map(|(band, weight)| match weight[c] {
                        1.0 => nm(band),
                        weight => format!("{} × {}", spoken.short(weight, DECIMALS), nm(band)),
                    })
                    .collect();
                sum.join(" + ").into()
            });
            let args = [("red", red), ("green", green), ("blue", blue)];
            spoken.fill("legend-bands", &args)
        }
    }
}

/// Bundles of one legend.
struct Words<'a> {
    shown: &'a Shown,
    face: &'a Handle<Font>,
    spoken: Spoken<'a>,
    size: f32,
}

impl Words<'_> {
    fn say(&self, wording: &Wording, fallback: &str) -> String {
        self.shown.text(wording).unwrap_or(fallback).to_owned()
    }

    fn line(&self, text: String) -> impl Bundle {
        line(text, self.face, self.size)
    }

    fn row(&self) -> impl Bundle {
        Node {
            flex_direction: match self.spoken.from_right() {
                true => FlexDirection::RowReverse,
                false => FlexDirection::Row,
            },
            align_items: AlignItems::Center,
            column_gap: Val::Px(self.size * 0.5),
            ..default()
        }
    }

    /// A bar of colours with what its ends stand for.
    fn scale(
        &self,
        rows: &mut ChildSpawnerCommands,
        map: ColourMapName,
        low: String,
        high: String,
    ) {
        rows.spawn(self.row()).with_children(|row| {
            row.spawn(self.line(low));
            let way = Node {
                flex_direction: match self.spoken.from_right() {
                    true => FlexDirection::RowReverse,
                    false => FlexDirection::Row,
                },
                ..default()
            };
            row.spawn(way).with_children(|bar| {
                for step in 0..BAR_STEPS {
                    bar.spawn(self.step(map, step));
                }
            });
            row.spawn(self.line(high));
        });
    }

    fn swatch(&self, [r, g, b]: [u8; 3]) -> impl Bundle {
        let edge = Val::Px(self.size);
        (
            Node {
                width: edge,
                height: edge,
                ..default()
            },
            BackgroundColor(Color::srgb_u8(r, g, b)),
        )
    }

    fn step(&self, map: ColourMapName, step: u32) -> impl Bundle {
        let at = (f64::from(step) + 0.5) / f64::from(BAR_STEPS);
        let [r, g, b] = map.colour(at).map(|c| colour::srgb_encode(c) as f32);
        (
            Node {
                // Whole pixels: seams would show between others.
                width: Val::Px((self.size * 0.25).max(1.0).round()),
                height: Val::Px(self.size),
                ..default()
            },
            BackgroundColor(Color::srgb(r, g, b)),
        )
    }
}

/// One line of text in the program's manner; wrapped, its lines begin where reading begins.
pub fn line(text: String, face: &Handle<Font>, size: f32) -> impl Bundle {
    (
        Text::new(text),
        TextFont {
            font: face.clone().into(),
            font_size: FontSize::Px(size),
            ..default()
        },
        TextColor(Color::srgb(0.92, 0.91, 0.88)),
        TextLayout {
            justify: Justify::Start,
            ..default()
        },
    )
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    #[test]
    fn english_legends_say_what_files_say_and_german_ones_do_not() {
        let wordings = Wordings::shipped();
        let [english, german] = ["en", "de"].map(|language| Spoken {
            wordings: &wordings,
            language,
        });
        let all = Enhancement {
            relief_only: true,
            exaggerate: 2.5,
            stretch: Some(DVec2::new(0.1, 0.9)),
            sharpen: 0.4,
        };
        assert_eq!(enhanced(&all, english), all.marks());
        let german = enhanced(&all, german);
        assert!(german[1].contains("2,5"), "{german:?}");
        for (german, english) in german.iter().zip(all.marks()) {
            assert_ne!(*german, english);
        }
        assert!(enhanced(&Enhancement::default(), english).is_empty());
    }
}
