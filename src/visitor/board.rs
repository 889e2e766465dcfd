//! The board at the upper corner where reading ends: the tool in the hand, what was measured, and what lies under the
//! pointer.

use bevy::{
    asset::RenderAssetUsages,
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};

use super::{
    caption::{self, Texts},
    controls::{Interface, draw::Controls},
    glass::Glass,
    measuring::{Kind, Laid, Measuring, Said},
    phrases,
    pointing::Pointer,
    speech::Speech,
};
use crate::{
    manifest::readout::CurvePoint,
    readings::{
        Curve,
        plot::{self, Labels},
    },
    stage::{
        Shown,
        legend::{self, Face, TextCamera, line},
    },
    wording::{self, Spoken},
};

/// Widest line, in heights of its text.
const WIDTH: f32 = 34.0;
/// And of a narrow picture's width.
const SHARE: f32 = 0.46;
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
    /// Each with what stands over it.
    curves: Vec<(String, Vec<CurvePoint>)>,
    profile: Option<Profile>,
    from_right: bool,
    size: f32,
    /// Of the widest line, in logical pixels.
    width: f32,
}

/// The number of the profile that is plotted, and how its decimals are separated.
type Profile = (u64, char);

/// The profile that was plotted last, and its plot.
type Plotted = Option<(Profile, Handle<Image>)>;

/// Writes what changed.
pub fn write(
    mut commands: Commands,
    (measuring, pointer, mut texts): (Res<Measuring>, Res<Pointer>, ResMut<Texts>),
    (shown, controls, glass): (Res<Shown>, Res<Controls>, Res<Glass>),
    (speech, interface, face): (Speech, Res<Interface>, Option<Res<Face>>),
    cameras: Query<(Entity, &TextCamera)>,
    boards: Query<Entity, With<Board>>,
    (mut images, mut last, mut plotted): (ResMut<Assets<Image>>, Local<Written>, Local<Plotted>),
) {
    let (Ok((camera, text)), Some(face)) = (cameras.single(), face) else {
        return;
    };
    let spoken = speech.spoken();
    let size = text.text_size() * QUIET * interface.text_factor();
    let profile = profile(&measuring);
    let curve = |curve: &Curve| {
        let title = phrases::curve(curve, &shown, spoken);
        (title, curve.points.clone())
    };
    let separator = wording::separator(spoken.language);
    let wanted = Written {
        lines: lines(&measuring, &pointer, (&shown, &controls), spoken),
        curves: match pointer.under() {
            Some(Ok(under)) => under.curves.iter().map(curve).collect(),
            _ => Vec::new(),
        },
        profile: profile.map(|laid| (laid.number, separator)),
        from_right: spoken.from_right(),
        size,
        width: (size * WIDTH).min(glass.size.x * SHARE),
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
        .filter(|(profile, _)| Some(*profile) == wanted.profile);
    // Units are the same in every language; the line above says the rest, in letters of its own.
    let labels = Labels {
        title: "",
        along: "mm",
        up: "µm",
        separator,
    };
    if let (None, Some(laid)) = (&*plotted, profile)
        && let Said::Read(reading) = &laid.said
        && let Ok(pixels) = plot::pixels(&labels, &reading.samples, legend::face())
    {
        *plotted = Some(((laid.number, separator), images.add(picture(&pixels))));
    }
    if !wanted.lines.is_empty() || !wanted.curves.is_empty() {
        let side = |wanted: bool| if wanted { Val::Px(size) } else { Val::Auto };
        let node = Node {
            left: side(wanted.from_right),
            right: side(!wanted.from_right),
            top: Val::Px(size),
            align_items: match wanted.from_right {
                true => AlignItems::FlexEnd,
                false => AlignItems::FlexStart,
            },
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
                    max_width: Val::Px(wanted.width),
                    ..default()
                };
                rows.spawn((line(text.clone(), &face.0, size), wrapped));
            }
            for (title, points) in &wanted.curves {
                draw_curve(rows, (title, points), &face.0, size);
            }
            if let Some((_, image)) = &*plotted {
                let [width, height] = plot::SIZE.map(|side| side as f32);
                rows.spawn((
                    ImageNode::new(image.clone()),
                    Node {
                        width: Val::Px(wanted.width),
                        height: Val::Px(wanted.width * height / width),
                        ..default()
                    },
                ));
            }
        });
    }
    *last = wanted;
}

/// The last profile that was measured, if nothing was measured after it.
fn profile(measuring: &Measuring) -> Option<&Laid> {
    let last = measuring.laid().last()?;
    let is_read = matches!(last.said, Said::Read(_));
    (is_read && last.kind == Kind::Profile).then_some(last)
}

fn lines(
    measuring: &Measuring,
    pointer: &Pointer,
    (shown, controls): (&Shown, &Controls),
    spoken: Spoken,
) -> Vec<String> {
    let mut lines = Vec::new();
    // Among controls it is said what is to be done, and which tool is in the hand.
    if let Some(kind) = measuring
        .kind()
        .filter(|_| controls.laid.widgets.is_empty())
    {
        let [name, hint] = phrases::tool_ids(kind);
        lines.push(format!("{} · {}", spoken.say(name), spoken.say(hint)));
    }
    let laid = measuring.laid();
    let first = laid.len().saturating_sub(LAST);
    for (index, laid) in laid.iter().enumerate().skip(first) {
        lines.push(phrases::line(index + 1, laid, shown, spoken));
    }
    if let Some(Said::Read(reading)) = laid.last().map(|laid| &laid.said) {
        let notes = reading.notes.iter();
        lines.extend(notes.map(|note| phrases::note(note, spoken)));
    }
    if pointer.is_read() {
        match pointer.under() {
            Some(Ok(under)) => lines.extend(phrases::under(under, shown, spoken)),
            Some(Err(why)) => lines.push(phrases::failed(*why, spoken)),
            None => lines.push(spoken.say("reading-hint")),
        }
    }
    lines
}

/// A curve of reflectance: a bar for each band, below what stands over it.
fn draw_curve(
    rows: &mut ChildSpawnerCommands,
    (title, points): (&str, &[CurvePoint]),
    face: &Handle<Font>,
    size: f32,
) {
    rows.spawn(line(title.to_owned(), face, size));
    let room = 0.8 * WIDTH / points.len().max(1) as f32;
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
        for point in points {
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
