//! The legend of the overlays that lie on the sheet: on screen and in rendered pictures alike.

use bevy::prelude::*;

use super::{Shown, StageSet};
use crate::{
    colour,
    manifest::exhibit::{BandMix, CompareMode, Overlay, OverlayKind, Wording},
    maps::{ColourMapName, DIVERGING},
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
/// Steps of a continuous legend's bar.
const BAR_STEPS: u32 = 32;

/// Draws the legends.
pub struct LegendPlugin;

impl Plugin for LegendPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Startup, load_face).add_systems(
            Update,
            draw.in_set(StageSet::Arrange)
                .run_if(resource_exists::<Shown>),
        );
    }
}

/// The face of every text.
#[derive(Resource, Clone, Default)]
pub struct Face(pub Handle<Font>);

/// The camera that draws the texts, and the height of its picture in pixels, at the foot of which so
/// many are somebody else's.
#[derive(Component)]
pub struct TextCamera {
    pub height: f32,
    pub foot: f32,
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
    cameras: Query<(Entity, Ref<TextCamera>)>,
    drawn: Query<Entity, With<Legend>>,
) {
    let (Ok((camera, text)), Some(face)) = (cameras.single(), face) else {
        return;
    };
    if !shown.is_changed() && !text.is_changed() {
        return;
    }
    for entity in &drawn {
        commands.entity(entity).despawn();
    }
    let overlays = overlays(&shown);
    let difference = shown
        .scene
        .compare
        .as_ref()
        .filter(|comparison| comparison.mode == CompareMode::Difference);
    let marks = shown.scene.enhance.marks();
    if overlays.is_empty() && difference.is_none() && marks.is_empty() {
        return;
    }
    let size = text_size(text.height);
    let words = Words {
        shown: &shown,
        face: &face.0,
        size,
    };
    commands
        .spawn((
            Legend,
            UiTargetCamera(camera),
            Node {
                position_type: PositionType::Absolute,
                right: Val::Px(size),
                bottom: Val::Px(size + text.foot),
                padding: UiRect::all(Val::Px(size * 0.7)),
                row_gap: Val::Px(size * 0.35),
                flex_direction: FlexDirection::Column,
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
                    Some(full) => format!("{full} of white's luminance"),
                    None => format!("{} ΔE00", comparison.full_delta_e),
                };
                words.scale(rows, DIFFERENCE_COLOURS, "0".to_owned(), top);
            }
            for (overlay, opacity) in &overlays {
                rows.spawn(words.line(format!(
                    "{} · {:.0} %",
                    words.say(&overlay.title, &overlay.id),
                    opacity * 100.0
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
                        let top = format!("{} {unit}", range[1]);
                        words.scale(rows, *colour_map, range[0].to_string(), top);
                    }
                    OverlayKind::Bands(view) => {
                        rows.spawn(words.line(view.words()));
                        if let BandMix::Difference { full } = view.mix {
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

/// Bundles of one legend.
struct Words<'a> {
    shown: &'a Shown,
    face: &'a Handle<Font>,
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
            row.spawn(Node::default()).with_children(|bar| {
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

/// One line of text in the program's manner.
pub fn line(text: String, face: &Handle<Font>, size: f32) -> impl Bundle {
    (
        Text::new(text),
        TextFont {
            font: face.clone().into(),
            font_size: FontSize::Px(size),
            ..default()
        },
        TextColor(Color::srgb(0.92, 0.91, 0.88)),
    )
}
