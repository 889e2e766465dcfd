//! The board at the upper right: the tool in the hand, what was measured, and what lies under the
//! pointer.

use bevy::{
    asset::RenderAssetUsages,
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};

use super::{
    caption::{self, Texts},
    measuring::{Kind, Laid, Measuring, Said},
    tools::Pointer,
};
use crate::{
    readings::{Curve, plot},
    stage::legend::{self, Face, TextCamera, line, text_size},
};

/// Widest line, in heights of its text.
const WIDTH: f32 = 34.0;
const QUIET: f32 = 0.85;
/// As many of the last that were measured.
const LAST: usize = 5;
/// Height of a curve, and the most that one of its bands is wide, in heights of the text.
const CURVE_HEIGHT: f32 = 5.0;
const BAND_WIDTH: f32 = 2.4;

/// A text of the board, which is drawn anew when it changes.
#[derive(Component)]
pub struct Board;

/// Everything that decides its pixels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Written {
    lines: Vec<String>,
    curves: Vec<Curve>,
    /// The number of the profile that is plotted.
    profile: Option<u64>,
    size: f32,
}

/// The number of the profile that was plotted last, and its plot.
type Plotted = Option<(u64, Handle<Image>)>;

/// Writes what changed.
pub fn write(
    mut commands: Commands,
    (measuring, pointer, mut texts): (Res<Measuring>, Res<Pointer>, ResMut<Texts>),
    face: Option<Res<Face>>,
    cameras: Query<(Entity, &TextCamera)>,
    boards: Query<Entity, With<Board>>,
    mut images: ResMut<Assets<Image>>,
    (mut last, mut plotted): (Local<Written>, Local<Plotted>),
) {
    let (Ok((camera, text)), Some(face)) = (cameras.single(), face) else {
        return;
    };
    let size = text_size(text.height) * QUIET;
    let profile = profile(&measuring);
    let wanted = Written {
        lines: lines(&measuring, &pointer),
        curves: match pointer.under() {
            Some(Ok(under)) => under.curves.clone(),
            _ => Vec::new(),
        },
        profile: profile.as_ref().map(|(laid, _)| laid.number),
        size,
    };
    if *last == wanted {
        return;
    }
    texts.set_changed();
    for board in &boards {
        commands.entity(board).despawn();
    }
    *plotted = plotted
        .take()
        .filter(|(number, _)| Some(*number) == wanted.profile);
    if let (None, Some((laid, title))) = (&*plotted, profile)
        && let Said::Read(reading) = &laid.said
        && let Ok(pixels) = plot::pixels(&title, &reading.samples, legend::face())
    {
        *plotted = Some((laid.number, images.add(picture(&pixels))));
    }
    if !wanted.lines.is_empty() || !wanted.curves.is_empty() {
        let node = Node {
            right: Val::Px(size),
            top: Val::Px(size),
            ..caption::panel_node(size)
        };
        let panel = (
            Board,
            UiTargetCamera(camera),
            node,
            BackgroundColor(caption::DARK),
        );
        commands.spawn(panel).with_children(|rows| {
            for text in &wanted.lines {
                let wrapped = Node {
                    max_width: Val::Px(size * WIDTH),
                    ..default()
                };
                rows.spawn((line(text.clone(), &face.0, size), wrapped));
            }
            for curve in &wanted.curves {
                draw_curve(rows, curve, &face.0, size);
            }
            if let Some((_, image)) = &*plotted {
                let [width, height] = plot::SIZE.map(|side| side as f32);
                rows.spawn((
                    ImageNode::new(image.clone()),
                    Node {
                        width: Val::Px(size * WIDTH),
                        height: Val::Px(size * WIDTH * height / width),
                        ..default()
                    },
                ));
            }
        });
    }
    *last = wanted;
}

/// The last profile that was measured, if nothing was measured after it, with its title.
fn profile(measuring: &Measuring) -> Option<(&Laid, String)> {
    let last = measuring.laid().last()?;
    match &last.said {
        Said::Read(reading) if last.kind == Kind::Profile => {
            let title = format!("{}: {}", last.on.side.word(), reading.words);
            Some((last, title))
        }
        _ => None,
    }
}

fn lines(measuring: &Measuring, pointer: &Pointer) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(kind) = measuring.kind() {
        lines.push(kind.words().to_owned());
        lines.push("Backspace takes back, M is the next tool, Esc puts it away".to_owned());
    }
    let laid = measuring.laid();
    let first = laid.len().saturating_sub(LAST);
    for (index, laid) in laid.iter().enumerate().skip(first) {
        let said = match &laid.said {
            Said::Waiting => "…".to_owned(),
            Said::Read(reading) => reading.words.clone(),
            Said::Nothing(why) => format!("nothing: {why}"),
        };
        let state = laid.on.state.as_ref();
        let state = state.map_or(String::new(), |state| format!(" ({state})"));
        let side = laid.on.side.word();
        lines.push(format!("{}  {side}{state}, {said}", index + 1));
    }
    if let Some(Said::Read(reading)) = laid.last().map(|laid| &laid.said) {
        lines.extend(reading.notes.iter().cloned());
    }
    if pointer.is_read() {
        match pointer.under() {
            Some(Ok(under)) => lines.extend(under.lines.iter().cloned()),
            Some(Err(why)) => lines.push(why.clone()),
            None => lines.push("point at the sheet to read what lies there".to_owned()),
        }
    }
    lines
}

/// A curve of reflectance: a bar for each band, with its wavelengths below and its values above.
fn draw_curve(rows: &mut ChildSpawnerCommands, curve: &Curve, face: &Handle<Font>, size: f32) {
    let ends = [curve.points.first(), curve.points.last()];
    let said: Vec<String> = ends
        .into_iter()
        .flatten()
        .map(|point| match point.reflectance {
            Some(reflectance) => format!("{} nm {reflectance:.3}", point.wavelength_nm),
            None => format!("{} nm –", point.wavelength_nm),
        })
        .collect();
    let title = format!("{}: {}", curve.title, said.join(" … "));
    rows.spawn(line(title, face, size));
    let room = 0.8 * WIDTH / curve.points.len().max(1) as f32;
    let chart = Node {
        align_self: AlignSelf::FlexStart,
        height: Val::Px(size * CURVE_HEIGHT),
        align_items: AlignItems::FlexEnd,
        column_gap: Val::Px(size * 0.15 * room.min(1.0)),
        border: UiRect::bottom(Val::Px(1.0)),
        ..default()
    };
    let axis = BorderColor::all(Color::srgb(0.7, 0.7, 0.7));
    rows.spawn((chart, axis)).with_children(|bars| {
        for point in &curve.points {
            let share = point.reflectance.unwrap_or_default().clamp(0.0, 1.0) as f32;
            bars.spawn((
                Node {
                    width: Val::Px(size * BAND_WIDTH.min(room)),
                    height: Val::Percent(share * 100.0),
                    ..default()
                },
                BackgroundColor(Color::srgb(0.45, 0.85, 1.0)),
            ));
        }
    });
}

fn picture(pixels: &[[u8; 3]]) -> Image {
    let [width, height] = plot::SIZE;
    let rgba = pixels.iter().flat_map(|[r, g, b]| [*r, *g, *b, u8::MAX]);
    Image::new(
        Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        rgba.collect(),
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::RENDER_WORLD,
    )
}
