//! The quiet caption at the lower left, and the list of keys.

use bevy::prelude::*;

use super::{
    attract::Attract,
    comparing,
    controls::{Interface, draw::Controls, facts},
    hand::Hand,
    notice::Notice,
    speech::Speech,
};
use crate::{
    manifest::exhibit::{Hotspot, Member},
    optics::tier::Tier,
    stage::{
        Shown,
        legend::{Face, TextCamera, line},
    },
    wording::{Spoken, catalogue},
};

/// Widest line, in heights of its text.
const WIDTH: f32 = 36.0;
/// The title is larger than the rest by this factor.
const TITLE: f32 = 1.25;
/// A row of the list of keys, in heights of its text.
const KEY_ROW: f32 = 1.65;
/// Over all controls: it was asked for.
const OVER: i32 = 20;
/// The caption's text, against that of the legend.
const QUIET: f32 = 0.85;

/// Which texts are wanted.
#[derive(Resource, Debug)]
pub struct Texts {
    pub caption: bool,
    pub keys: bool,
    /// What became of a wish, until the next one.
    pub notice: Option<Notice>,
}

impl Default for Texts {
    fn default() -> Self {
        Self {
            caption: true,
            keys: false,
            notice: None,
        }
    }
}

/// A text that is drawn anew when it changes.
#[derive(Component)]
pub struct Panel;

/// Everything that decides the texts' pixels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawn {
    caption: Vec<String>,
    /// Rows of keys and what they do; none where nobody asked.
    keys: Vec<[String; 2]>,
    from_right: bool,
    foot: f32,
    size: f32,
    /// Of the picture, in logical pixels.
    height: f32,
}

/// Draws the texts that changed.
pub fn draw(
    mut commands: Commands,
    (shown, hand, texts): (Res<Shown>, Res<Hand>, Res<Texts>),
    (attract, interface, controls): (Res<Attract>, Res<Interface>, Res<Controls>),
    speech: Speech,
    (face, mut drawn): (Option<Res<Face>>, Local<Drawn>),
    cameras: Query<(Entity, &TextCamera)>,
    panels: Query<Entity, With<Panel>>,
) {
    let (Ok((camera, text)), Some(face)) = (cameras.single(), face) else {
        return;
    };
    let size = text.text_size() * QUIET * interface.text_factor();
    let spoken = speech.spoken();
    let invitation = attract.is_touring();
    let wanted = Drawn {
        caption: match hand.open_hotspot() {
            Some(hotspot) => hotspot_lines(&shown, hotspot, spoken),
            None if texts.caption && !controls.lists => lines(&shown, &hand, spoken),
            None => Vec::new(),
        }
        .into_iter()
        .chain(texts.notice.as_ref().map(|notice| notice.words(spoken)))
        .chain(invitation.then(|| spoken.say("attract-invitation")))
        .collect(),
        keys: match texts.keys {
            true => keys(spoken),
            false => Vec::new(),
        },
        from_right: spoken.from_right(),
        foot: text.foot,
        size,
        height: text.height,
    };
    if *drawn == wanted {
        return;
    }
    for panel in &panels {
        commands.entity(panel).despawn();
    }
    if !wanted.caption.is_empty() {
        let side = |wanted: bool| if wanted { Val::Px(size) } else { Val::Auto };
        let node = Node {
            left: side(!wanted.from_right),
            right: side(wanted.from_right),
            bottom: Val::Px(size + wanted.foot),
            align_items: match wanted.from_right {
                true => AlignItems::FlexEnd,
                false => AlignItems::FlexStart,
            },
            ..panel_node(size)
        };
        commands
            .spawn((Panel, UiTargetCamera(camera), node, BackgroundColor(DARK)))
            .with_children(|rows| {
                for (row, text) in wanted.caption.iter().enumerate() {
                    let font = if row == 0 { size * TITLE } else { size };
                    let wrapped = Node {
                        max_width: Val::Px(size * WIDTH),
                        ..default()
                    };
                    rows.spawn((line(text.clone(), &face.0, font), wrapped));
                }
            });
    }
    if !wanted.keys.is_empty() {
        let panel = (Panel, UiTargetCamera(camera), BackgroundColor(DARK));
        let mut panel = commands.spawn(panel);
        draw_keys(&mut panel, &wanted, &face.0);
    }
    *drawn = wanted;
}

/// Draws keys in one column and what they do in another, over all controls and no larger than there is room.
fn draw_keys(panel: &mut EntityCommands, wanted: &Drawn, face: &Handle<Font>) {
    let room = wanted.height / (wanted.keys.len() as f32 * KEY_ROW + 4.0);
    let size = wanted.size.min(room);
    let side = |wanted: bool| if wanted { Val::Px(size) } else { Val::Auto };
    let node = Node {
        left: side(!wanted.from_right),
        right: side(wanted.from_right),
        top: Val::Px(size),
        flex_direction: match wanted.from_right {
            true => FlexDirection::RowReverse,
            false => FlexDirection::Row,
        },
        column_gap: Val::Px(size * 1.5),
        ..panel_node(size)
    };
    let column = Node {
        flex_direction: FlexDirection::Column,
        row_gap: Val::Px(size * 0.35),
        align_items: match wanted.from_right {
            true => AlignItems::FlexEnd,
            false => AlignItems::FlexStart,
        },
        ..default()
    };
    panel
        .insert((node, GlobalZIndex(OVER)))
        .with_children(|columns| {
            for k in 0..2 {
                columns.spawn(column.clone()).with_children(|rows| {
                    for row in &wanted.keys {
                        rows.spawn(line(row[k].clone(), face, size));
                    }
                });
            }
        });
}

/// Light text on this keeps a contrast above 4.5:1 over the whitest paper.
pub(super) const DARK: Color = Color::srgba(0.05, 0.05, 0.05, 0.93);

/// A panel at a corner of the picture.
pub(super) fn panel_node(size: f32) -> Node {
    Node {
        position_type: PositionType::Absolute,
        padding: UiRect::all(Val::Px(size * 0.7)),
        row_gap: Val::Px(size * 0.35),
        flex_direction: FlexDirection::Column,
        ..default()
    }
}

/// Keys and what they do.
fn keys(spoken: Spoken) -> Vec<[String; 2]> {
    let rows = catalogue::KEYS.iter();
    rows.map(|(keys, what)| [catalogue::keys(spoken, keys), spoken.say(what)])
        .collect()
}

/// The caption's lines, the title first.
fn lines(shown: &Shown, hand: &Hand, spoken: Spoken) -> Vec<String> {
    let drawing = shown.exhibit.drawing_of(&shown.scene);
    let say = |wording| shown.text(wording).unwrap_or_default();
    let title = match say(&drawing.title) {
        "" => say(&shown.exhibit.title),
        title => title,
    };
    let mut lines = vec![joined(&[title, &drawing.date])];
    lines.push(say(&drawing.caption).into());
    lines.push(joined(&[&drawing.credit, &drawing.inventory]));
    lines.push(say(&shown.scene.text).into());
    let state = shown.scene.state.map(|state| &drawing.states[state]);
    let state = state.map_or("", |state| match say(&state.title) {
        "" => &state.id,
        title => title,
    });
    let lamp = hand.lamp().map(|lamp| facts::lamp_words(lamp, spoken));
    let lamp = lamp.unwrap_or_default();
    let size = match hand.at_true_size() {
        Some(true) => spoken.say("at-true-size"),
        Some(false) => spoken.say("at-true-size-perhaps"),
        None => String::new(),
    };
    // What everybody sees who asked for nothing needs no name.
    let tier = match hand.tier() {
        tier if tier == Tier::default() => String::new(),
        Tier::Draft => spoken.say("tier-draft"),
        Tier::Study => spoken.say("tier-study"),
        // The names of their authors, or of what they are compared with.
        tier => tier.name().to_owned(),
    };
    let compared = shown.scene.compare.as_ref().map(|comparison| {
        let names = comparison.of.iter().map(|of| name(shown, *of, spoken));
        let names: Vec<String> = names.collect();
        format!(
            "{}: {}",
            comparing::words(comparison, spoken),
            names.join(" | ")
        )
    });
    let compared = compared.unwrap_or_default();
    let through = match shown.scene.transmitted {
        0.0 => String::new(),
        share => {
            let share = (share * 100.0).round();
            spoken.fill("light-through", &[("share", share.into())])
        }
    };
    let hotspots = match drawing.hotspots.iter().any(|h| h.side == shown.scene.side) {
        false if hand.shows_hotspots() => spoken.say("no-hotspots"),
        _ => String::new(),
    };
    let side = facts::side_words(shown.scene.side, spoken);
    let parts = [
        side.as_str(),
        state,
        &compared,
        &lamp,
        &through,
        &size,
        &tier,
        &hotspots,
    ];
    lines.push(joined(&parts));
    lines.retain(|line| !line.is_empty());
    lines
}

/// What an open hotspot says, its title first, and where it leads.
fn hotspot_lines(shown: &Shown, hotspot: &Hotspot, spoken: Spoken) -> Vec<String> {
    let say = |wording| shown.text(wording).unwrap_or_default();
    let scene = hotspot.scene.map(|scene| &shown.exhibit.scenes[scene]);
    let leads = scene.map_or(String::new(), |scene| {
        let title = shown.text(&scene.title).unwrap_or(&scene.id);
        spoken.fill("hotspot-leads", &[("title", title.into())])
    });
    let mut lines = vec![
        say(&hotspot.title).to_owned(),
        say(&hotspot.text).to_owned(),
        leads,
    ];
    lines.retain(|line| !line.is_empty());
    lines
}

/// What a member of a comparison is called.
pub(super) fn name(shown: &Shown, member: Member, spoken: Spoken) -> String {
    let drawing = shown.exhibit.drawing_of(&shown.scene);
    let (title, id) = match member {
        Member::State(Some(state)) => (&drawing.states[state].title, &drawing.states[state].id),
        Member::State(None) => return spoken.say("no-state"),
        Member::Side(side) => return facts::side_words(side, spoken),
        Member::Overlay(overlay) => {
            let overlay = &drawing.overlays[overlay];
            (&overlay.title, &overlay.id)
        }
        Member::Drawing(other) => {
            let other = &shown.exhibit.drawings[other];
            (&other.title, &other.id)
        }
    };
    shown.text(title).unwrap_or(id).to_owned()
}

fn joined(parts: &[&str]) -> String {
    let said: Vec<&str> = parts
        .iter()
        .copied()
        .filter(|part| !part.is_empty())
        .collect();
    said.join(" · ")
}
