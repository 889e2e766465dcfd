//! The controls on the picture, quiet until they are needed, and what a screen reader says of them.

use accesskit::{Node as Spoken, Role};
use bevy::{a11y::AccessibilityNode, prelude::*};

use super::{
    Control, Interface, Laid, Look, Room, Widget,
    facts::{self, Spoken as Words},
    icons::Icons,
    layout::{self, Item},
    thumbs::Thumbs,
};
pub use crate::stage::legend::ProgramWords;
use crate::{
    stage::{
        Shown,
        legend::{Face, TextCamera, text_size_for},
    },
    visitor::{
        attract::Attract, glass::Glass, hand::Hand, hints::Hints, measuring::Measuring,
        speech::Speech, staff::StaffPanel,
    },
};

/// The text's size against that of the legend.
const QUIET: f32 = 0.85;
/// Rings of the dial: lamps at 45° and at the least height that a hand gives them.
const RINGS: [f32; 2] = [std::f32::consts::FRAC_1_SQRT_2, 0.9986];
/// The lamp on the dial, of the dial's side.
const KNOB: f32 = 0.14;
/// Controls lie on their ground, and both on all texts.
const UNDER: i32 = 10;
const OVER: i32 = 11;

/// The languages on offer, the first of which is spoken at home; none where scenes decide.
#[derive(Resource, Clone, Debug, Default)]
pub struct Languages {
    pub installed: Vec<String>,
    pub offered: Vec<String>,
}

impl Languages {
    /// The tag on offer that says `chosen`: the same, or the same language as another region has it.
    fn offer(&self, chosen: Option<&str>) -> Option<&str> {
        let chosen = chosen?;
        let base = |tag: &str| -> String {
            let base = tag.split(['-', '_']).next();
            base.unwrap_or_default().to_ascii_lowercase()
        };
        let same = |tag: &&String| tag.eq_ignore_ascii_case(chosen);
        let near = |tag: &&String| base(tag) == base(chosen);
        let mut offered = self.offered.iter();
        let offered = offered
            .find(same)
            .or_else(|| self.offered.iter().find(near));
        offered.map(String::as_str)
    }

    /// What is read where `chosen` was; as scenes say where nobody chose.
    pub fn spoken(&self, chosen: Option<&str>) -> Option<String> {
        let offered = self.offer(chosen).map(str::to_owned);
        offered.or_else(|| self.installed.first().cloned())
    }

    /// The tag of the program's own wordings where `chosen` was.
    pub fn tag(&self, chosen: Option<&str>) -> &str {
        let first = || self.offered.first().map_or("en", String::as_str);
        self.offer(chosen).unwrap_or_else(first)
    }
}

/// What everybody reaches, in logical pixels from the top; none where nobody said.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct Reach(pub Option<[f32; 2]>);

/// The controls in their places.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct Controls {
    pub laid: Laid,
    /// Height of the text in logical pixels.
    pub text: f32,
    /// From the bottom, what texts keep clear of, in logical pixels.
    pub foot: f32,
    /// A list lies where the caption is.
    pub lists: bool,
}

/// Lays them out.
pub fn arrange(
    (shown, hand, measuring, interface): (Res<Shown>, Res<Hand>, Res<Measuring>, Res<Interface>),
    (attract, staff): (Res<Attract>, Res<StaffPanel>),
    (speech, languages, reach): (Speech, Res<Languages>, Res<Reach>),
    hints: Res<Hints>,
    glass: Res<Glass>,
    mut texts: Query<&mut TextCamera>,
    mut controls: ResMut<Controls>,
) {
    let spoken = speech.spoken();
    let home = glass.home();
    let size = home.size();
    let room = Room {
        size,
        px_per_mm: glass.size.x / hand.picture().width_mm.max(1.0) as f32,
        reach: reach.0.map(|reach| reach.map(|row| row - home.min.y)),
        text: text_size_for(size.x, size.y) * QUIET * interface.text_factor(),
        right_to_left: spoken.from_right(),
    };
    let is_quiet = attract.is_touring() || staff.is_elsewhere();
    let shown_at_all = interface.wanted && !is_quiet || staff.is_open() && !staff.is_elsewhere();
    let laid = if shown_at_all {
        let offered = &languages.offered;
        let mut facts = facts::facts(&shown, &hand, &measuring, &interface, (spoken, offered));
        facts.countdown = attract.countdown().map(|left| countdown(left, spoken));
        facts.staff = staff.items(spoken);
        facts.hint = hints.said(spoken);
        layout::lay(&room, &facts).moved(home.min)
    } else {
        Laid::default()
    };
    let foot = match staff.is_open() || attract.countdown().is_some() {
        true => 0.0,
        false => laid.foot(&room) + (glass.size.y - home.max.y),
    };
    let wanted = Controls {
        laid,
        text: room.text,
        foot,
        lists: interface.open.iter().any(|panel| panel.is_list()),
    };
    controls.set_if_neq(wanted);
    for mut text in &mut texts {
        if text.foot != foot {
            text.foot = foot;
        }
    }
}

fn countdown(left: u32, spoken: Words) -> Vec<Item> {
    vec![
        Item {
            control: Control::Said,
            icon: None,
            words: spoken.fill("countdown", &[("seconds", left.into())]),
            look: Look::Words,
        },
        Item::button(Control::Stay, None, spoken.say("stay"), true),
    ]
}

/// Everything that decides the controls' pixels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawn {
    laid: Laid,
    text: f32,
    contrast: bool,
    focus: Option<Control>,
    held: Vec<Control>,
    thumbs: usize,
}

/// A control on the picture.
#[derive(Component)]
pub struct Shape;

/// The colours of the controls.
#[derive(Clone, Copy)]
struct Colours {
    ground: Color,
    button: Color,
    held: Color,
    on: Color,
    words: Color,
    words_on: Color,
    focus: Color,
}

impl Colours {
    /// Those of paper and ink; every wording has a contrast of 7:1 at least over the whitest sheet.
    const QUIET: Self = Self {
        ground: Color::srgba(0.075, 0.065, 0.055, 0.88),
        button: Color::srgba(0.16, 0.145, 0.125, 0.9),
        held: Color::srgb(0.32, 0.29, 0.25),
        on: Color::srgb(0.88, 0.69, 0.38),
        words: Color::srgb(0.95, 0.92, 0.85),
        words_on: Color::srgb(0.05, 0.035, 0.02),
        focus: Color::srgb(0.45, 0.8, 1.0),
    };
    const HIGH: Self = Self {
        ground: Color::BLACK,
        button: Color::BLACK,
        held: Color::srgb(0.25, 0.25, 0.25),
        on: Color::srgb(1.0, 0.9, 0.0),
        words: Color::WHITE,
        words_on: Color::BLACK,
        focus: Color::srgb(0.0, 0.9, 1.0),
    };
}

/// What controls are drawn with.
struct Pen<'p> {
    colours: Colours,
    face: &'p Handle<Font>,
    text: f32,
    focus: Option<Control>,
    held: &'p [Control],
    contrast: bool,
}

/// Draws what changed.
pub fn draw(
    mut commands: Commands,
    (controls, interface, face): (Res<Controls>, Res<Interface>, Option<Res<Face>>),
    (mut icons, mut images, thumbs): (ResMut<Icons>, ResMut<Assets<Image>>, Res<Thumbs>),
    cameras: Query<Entity, With<TextCamera>>,
    shapes: Query<Entity, With<Shape>>,
    mut drawn: Local<Drawn>,
) {
    let (Ok(camera), Some(face)) = (cameras.single(), face) else {
        return;
    };
    let wanted = Drawn {
        laid: controls.laid.clone(),
        text: controls.text,
        contrast: interface.contrast,
        focus: interface.focus,
        held: interface.held.iter().map(|(_, control)| *control).collect(),
        thumbs: thumbs.count(),
    };
    if *drawn == wanted {
        return;
    }
    for shape in &shapes {
        commands.entity(shape).despawn();
    }
    let pen = Pen {
        colours: match wanted.contrast {
            true => Colours::HIGH,
            false => Colours::QUIET,
        },
        face: &face.0,
        text: wanted.text,
        focus: wanted.focus,
        held: &wanted.held,
        contrast: wanted.contrast,
    };
    for ground in &wanted.laid.grounds {
        commands.spawn((
            Shape,
            UiTargetCamera(camera),
            GlobalZIndex(UNDER),
            placed(*ground, wanted.text * 0.5),
            BackgroundColor(pen.colours.ground),
        ));
    }
    for widget in &wanted.laid.widgets {
        let icon = widget.icon.map(|icon| icons.get(icon, &mut images));
        let picture = match widget.look {
            Look::Picture { scene, .. } => thumbs.get(scene),
            _ => None,
        };
        let right_to_left = wanted.laid.right_to_left;
        pen.draw(
            &mut commands,
            camera,
            (widget, right_to_left),
            icon.or(picture),
        );
    }
    *drawn = wanted;
}

/// At a place of the picture, with round corners.
fn placed(rect: Rect, round: f32) -> Node {
    Node {
        position_type: PositionType::Absolute,
        left: Val::Px(rect.min.x),
        top: Val::Px(rect.min.y),
        width: Val::Px(rect.width()),
        height: Val::Px(rect.height()),
        border_radius: BorderRadius::all(Val::Px(round)),
        ..default()
    }
}

impl Pen<'_> {
    fn words(&self, text: &str, size: f32, colour: Color) -> impl Bundle {
        self.set(text, size, colour, LineBreak::WordBoundary)
    }

    fn set(&self, text: &str, size: f32, colour: Color, linebreak: LineBreak) -> impl Bundle {
        (
            Text::new(text),
            TextFont {
                font: self.face.clone().into(),
                font_size: FontSize::Px(size),
                ..default()
            },
            TextColor(colour),
            TextLayout::new(Justify::Center, linebreak),
        )
    }

    /// Draws dark letters a second time: light is mixed linearly, and their edges would look thin.
    fn firm(&self) -> TextShadow {
        TextShadow {
            offset: Vec2::ZERO,
            color: self.colours.words_on,
        }
    }

    fn draw(
        &self,
        commands: &mut Commands,
        camera: Entity,
        (widget, right_to_left): (&Widget, bool),
        image: Option<Handle<Image>>,
    ) {
        let is_on = match widget.look {
            Look::Button { on } | Look::Picture { on, .. } => on,
            _ => false,
        };
        let is_held = self.held.contains(&widget.control);
        let (ground, words) = match (is_held, is_on) {
            (true, _) => (self.colours.held, self.colours.words),
            (_, true) => (self.colours.on, self.colours.words_on),
            _ => (self.colours.button, self.colours.words),
        };
        let round = match widget.look {
            Look::Dial { .. } => widget.rect.width() / 2.0,
            _ => self.text * 0.4,
        };
        let is_across = widget.icon.is_some() && widget.rect.width() > 2.6 * widget.rect.height();
        let node = Node {
            flex_direction: match is_across {
                true => FlexDirection::Row,
                false => FlexDirection::Column,
            },
            align_items: AlignItems::Center,
            justify_content: JustifyContent::Center,
            column_gap: Val::Px(self.text * 0.4),
            padding: UiRect::horizontal(Val::Px(self.text * 0.2)),
            overflow: Overflow::clip(),
            ..placed(widget.rect, round)
        };
        let mut shape = commands.spawn((Shape, UiTargetCamera(camera), GlobalZIndex(OVER), node));
        if widget.look == Look::Words {
            let size = match widget.control {
                Control::Said => self.text * layout::LOUD,
                _ => self.text,
            };
            let mut spoken = Spoken::new(Role::Label);
            spoken.set_value(widget.words.as_str());
            spoken.set_live(accesskit::Live::Assertive);
            shape
                .insert(AccessibilityNode(spoken))
                .with_child(self.words(&widget.words, size, self.colours.words));
            return;
        }
        shape.insert((BackgroundColor(ground), AccessibilityNode(spoken(widget))));
        if self.focus == Some(widget.control) {
            let width = Val::Px((self.text * 0.22).max(3.0));
            shape.insert(Outline::new(width, Val::Px(1.0), self.colours.focus));
        } else if self.contrast {
            shape.insert(Outline::new(Val::Px(2.0), Val::ZERO, Color::WHITE));
        }
        shape.with_children(|inside| match widget.look {
            Look::Dial { place } => self.dial(inside, place, widget.rect.width()),
            Look::Slider { value } => self.slider(inside, widget, value, right_to_left),
            Look::Picture { .. } => {
                let size = Vec2::new(
                    widget.rect.width() - self.text * 0.4,
                    widget.rect.height() - self.text * 1.6,
                );
                let node = Node {
                    width: Val::Px(size.x),
                    height: Val::Px(size.y),
                    ..default()
                };
                match image {
                    Some(image) => inside.spawn((ImageNode::new(image), node)),
                    None => inside.spawn((node, BackgroundColor(self.colours.held))),
                };
                let title = shortened(&widget.words, size.x / (self.text * 0.85 * 0.55));
                let size = self.text * 0.85;
                inside
                    .spawn(self.set(&title, size, words, LineBreak::NoWrap))
                    .insert_if(self.firm(), || is_on && !is_held);
            }
            _ => {
                if let Some(image) = image {
                    let side = Val::Px(self.text * 1.9);
                    let node = Node {
                        width: side,
                        height: side,
                        ..default()
                    };
                    inside.spawn((ImageNode::new(image).with_color(words), node));
                }
                if !widget.words.is_empty() {
                    inside
                        .spawn(self.words(&widget.words, self.text, words))
                        .insert_if(self.firm(), || is_on && !is_held);
                }
            }
        });
    }

    fn dial(&self, inside: &mut ChildSpawnerCommands, place: Vec2, side: f32) {
        let circle = |middle: Vec2, radius: f32| Node {
            border: UiRect::all(Val::Px((self.text * 0.1).max(1.5))),
            ..placed(
                Rect::from_center_half_size(middle, Vec2::splat(radius)),
                radius,
            )
        };
        let middle = Vec2::splat(side / 2.0);
        for ring in RINGS {
            let edge = BorderColor::all(self.colours.words.with_alpha(0.5));
            inside.spawn((circle(middle, ring * side / 2.0 - 2.0), edge));
        }
        // The sheet under it.
        let sheet = Rect::from_center_half_size(middle, Vec2::new(0.12, 0.085) * side);
        inside.spawn((
            placed(sheet, 1.0),
            BackgroundColor(self.colours.words.with_alpha(0.35)),
        ));
        let at = middle + place * Vec2::new(1.0, -1.0) * (side / 2.0) * (1.0 - KNOB / 2.0);
        let lamp = Color::srgb(1.0, 0.85, 0.4);
        inside.spawn((
            circle(at, KNOB * side),
            BackgroundColor(lamp.with_alpha(0.25)),
        ));
        inside.spawn((circle(at, KNOB * side / 2.0), BackgroundColor(lamp)));
    }

    fn slider(
        &self,
        inside: &mut ChildSpawnerCommands,
        widget: &Widget,
        value: f32,
        right_to_left: bool,
    ) {
        let size = widget.rect.size();
        let share = if right_to_left { 1.0 - value } else { value };
        let (thick, knob) = (self.text * 0.22, self.text * 0.62);
        let y = size.y * 0.72;
        let reach = size.x - 2.0 * knob;
        let track = Rect::new(knob, y - thick / 2.0, size.x - knob, y + thick / 2.0);
        let words = Node {
            position_type: PositionType::Absolute,
            top: Val::Px(size.y * 0.08),
            ..default()
        };
        inside.spawn((
            self.words(&widget.words, self.text, self.colours.words),
            words,
        ));
        inside.spawn((
            placed(track, thick / 2.0),
            BackgroundColor(self.colours.words.with_alpha(0.45)),
        ));
        let at = Vec2::new(knob + share * reach, y);
        let rect = Rect::from_center_half_size(at, Vec2::splat(knob));
        inside.spawn((placed(rect, knob), BackgroundColor(self.colours.on)));
    }
}

/// At most so many characters.
fn shortened(words: &str, room: f32) -> String {
    let room = room.max(4.0) as usize;
    match words.chars().count() > room {
        true => words.chars().take(room - 1).chain(['…']).collect(),
        false => words.to_owned(),
    }
}

/// What a screen reader says of a control.
fn spoken(widget: &Widget) -> Spoken {
    let mut node = Spoken::new(match widget.look {
        Look::Slider { .. } | Look::Dial { .. } => Role::Slider,
        _ => Role::Button,
    });
    node.set_label(widget.words.as_str());
    match widget.look {
        Look::Button { on } | Look::Picture { on, .. } => node.set_selected(on),
        Look::Slider { value } => {
            node.set_numeric_value(f64::from(value) * 100.0);
            node.set_min_numeric_value(0.0);
            node.set_max_numeric_value(100.0);
        }
        _ => {}
    }
    node
}

#[cfg(test)]
mod tests {
    use super::*;

    /// WCAG 2.2, relative luminance and contrast.
    fn contrast(a: Color, b: Color) -> f32 {
        let [a, b] = [a, b].map(|colour| colour.to_linear().with_alpha(1.0).luminance() + 0.05);
        a.max(b) / a.min(b)
    }

    /// `over` the whitest sheet.
    fn over_white(over: Color) -> Color {
        let over = over.to_linear();
        let mixed = over.to_vec3() * over.alpha + Vec3::splat(1.0 - over.alpha);
        Color::LinearRgba(LinearRgba::from_vec3(mixed))
    }

    #[test]
    fn every_wording_is_told_from_its_ground() {
        for colours in [Colours::QUIET, Colours::HIGH] {
            assert!(contrast(colours.words, over_white(colours.ground)) >= 4.5);
            assert!(contrast(colours.words, colours.held) >= 4.5);
            assert!(contrast(colours.words_on, colours.on) >= 4.5);
        }
        assert!(
            contrast(Colours::QUIET.words, Colours::QUIET.on) < 4.5,
            "it can fail"
        );
    }

    #[test]
    fn a_long_title_is_shortened_by_characters() {
        assert_eq!(shortened("Größe", 9.0), "Größe");
        assert_eq!(
            shortened("مناظر طبيعية", 6.0),
            "مناظر…".chars().take(5).chain(['…']).collect::<String>()
        );
    }
}
