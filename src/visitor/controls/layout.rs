//! Where controls lie: all within the reach that the installation states, none smaller than a finger needs,
//! none over another, mirrored for those who read from the right.

use bevy::math::{Rect, Vec2};

use super::{Control, Facts, Panel, icons::Icon};
use crate::wording::letters;

/// Least side of what is touched.
const TARGET_MM: f32 = 15.0;
/// Between controls, of a target's side.
const GAP: f32 = 0.14;
/// Width of a character, and height of a line, in heights of the text.
const CHARACTER: f32 = 0.6;
/// And of one that fills a square.
const WIDE: f32 = 1.05;
const LINE: f32 = 1.35;
/// A sign's side in heights of the text.
const SIGN: f32 = 2.1;
/// Widest panel of the list at the side, in targets.
const LIST_TARGETS: f32 = 4.6;
/// The dial's diameter in targets, and the least that is left of it where there is little room.
const DIAL: f32 = 4.0;
const DIAL_LEAST: f32 = 2.2;
/// A picture of a scene, in targets.
const THUMB: Vec2 = Vec2::new(2.2, 1.5);
/// Texts at the side where reading begins take up so much of a row, in heights of their letters.
const TEXTS: f32 = 38.0;
/// What a line of words alone is larger by.
pub const LOUD: f32 = 1.25;
/// A window smaller than this, in targets, has keys only.
const LEAST: Vec2 = Vec2::new(10.0, 7.0);

/// The room that there is for controls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    /// The picture in logical pixels.
    pub size: Vec2,
    /// Of the display.
    pub px_per_mm: f32,
    /// From the top, in logical pixels, what everybody reaches.
    pub reach: Option<[f32; 2]>,
    /// Height of the text in logical pixels.
    pub text: f32,
    pub right_to_left: bool,
}

/// How a control looks.
#[derive(Clone, Debug, PartialEq)]
pub enum Look {
    Button {
        on: bool,
    },
    /// 0…1 from the side where reading begins.
    Slider {
        value: f32,
    },
    /// A lamp's place, −1…1 with y up.
    Dial {
        place: Vec2,
    },
    /// The picture of a scene.
    Picture {
        scene: usize,
        on: bool,
    },
    /// Words alone.
    Words,
}

/// A control in its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Widget {
    pub control: Control,
    /// In logical pixels from the top left corner.
    pub rect: Rect,
    pub icon: Option<Icon>,
    pub words: String,
    pub look: Look,
}

/// What lies under controls, to be read on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Laid {
    pub widgets: Vec<Widget>,
    pub grounds: Vec<Rect>,
    pub right_to_left: bool,
    /// Where the rows at the bottom begin, in logical pixels from the top.
    foot_from: f32,
}

impl Laid {
    /// The same in a part of the picture that begins at `corner`.
    pub fn moved(mut self, corner: Vec2) -> Self {
        let go = |rect: &mut Rect| (rect.min, rect.max) = (rect.min + corner, rect.max + corner);
        self.widgets
            .iter_mut()
            .for_each(|widget| go(&mut widget.rect));
        self.grounds.iter_mut().for_each(go);
        self
    }

    /// The control at a place.
    pub fn at(&self, place: Vec2) -> Option<&Widget> {
        let is_there = |widget: &&Widget| widget.rect.contains(place) && widget.look != Look::Words;
        self.widgets.iter().rev().find(is_there)
    }

    /// Whether a panel covers the sheet at a place.
    pub fn covers(&self, place: Vec2) -> bool {
        // What only says something is touched through.
        let says = |ground: &Rect| {
            let is_said = |w: &Widget| w.control == Control::Said && w.rect == *ground;
            self.widgets.iter().any(is_said)
        };
        let mut grounds = self.grounds.iter();
        grounds.any(|ground| ground.contains(place) && !says(ground))
    }

    /// Height of what lies at the bottom, in logical pixels, which texts keep clear of.
    pub fn foot(&self, room: &Room) -> f32 {
        match self.grounds.is_empty() {
            true => 0.0,
            false => (room.size.y - self.foot_from).max(0.0),
        }
    }
}

impl Room {
    /// Side of the smallest control.
    pub fn target(&self) -> f32 {
        (TARGET_MM * self.px_per_mm).max(self.text * (SIGN + LINE) * 1.1)
    }

    fn gap(&self) -> f32 {
        self.target() * GAP
    }

    /// Left, top, right and bottom of what controls may take up.
    fn free(&self) -> Rect {
        let gap = self.gap();
        let [top, bottom] = self.reach.unwrap_or([0.0, self.size.y]);
        let top = top.clamp(0.0, self.size.y) + gap;
        // A reach that this display has no part of is of no use.
        let bottom = (bottom.clamp(0.0, self.size.y) - gap).max(top);
        Rect::new(gap, top, self.size.x - gap, bottom)
    }

    /// Whether there is room for any.
    pub fn is_enough(&self) -> bool {
        let least = LEAST * TARGET_MM * self.px_per_mm.min(96.0 / 25.4);
        self.size.cmpge(least).all() && self.free().height() > 2.0 * self.target()
    }

    /// The place of a control as wide as `width` in a grid of them that begins at `corner`.
    fn cell(&self, corner: Vec2, [column, row]: [usize; 2], width: f32) -> Rect {
        let (gap, target) = (self.gap(), self.target());
        let at = Vec2::new(column as f32, row as f32);
        let min = corner + at * Vec2::new(width + gap, target + gap);
        Rect::from_corners(min, min + Vec2::new(width, target))
    }

    fn width_of(&self, words: &str) -> f32 {
        let widths = words.chars().map(|letter| match letter {
            // Ideographs and kana are as wide as they are high (Unicode's East Asian Width).
            '\u{2e80}'.. => WIDE,
            _ => CHARACTER,
        });
        widths.sum::<f32>() * self.text
    }

    /// `laid` as it is for those who read from the right.
    fn turned(&self, mut laid: Laid) -> Laid {
        if self.right_to_left {
            let turn = |rect: &mut Rect| {
                let (left, right) = (self.size.x - rect.max.x, self.size.x - rect.min.x);
                (rect.min.x, rect.max.x) = (left, right);
            };
            laid.widgets
                .iter_mut()
                .for_each(|widget| turn(&mut widget.rect));
            laid.grounds.iter_mut().for_each(turn);
            laid.right_to_left = true;
        }
        laid
    }
}

/// A button before it has a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    pub control: Control,
    pub icon: Option<Icon>,
    pub words: String,
    pub look: Look,
}

impl Item {
    pub fn button(control: Control, icon: Option<Icon>, words: String, on: bool) -> Self {
        Self {
            control,
            icon,
            words,
            look: Look::Button { on },
        }
    }

    fn at(&self, rect: Rect) -> Widget {
        Widget {
            control: self.control,
            rect,
            icon: self.icon,
            words: self.words.clone(),
            look: self.look.clone(),
        }
    }
}

/// Lays out what there is.
pub fn lay(room: &Room, facts: &Facts) -> Laid {
    let mut laid = Laid::default();
    if !room.is_enough() {
        return laid;
    }
    if let Some(staff) = &facts.staff {
        grid(room, &mut laid, staff, 3);
        return room.turned(laid);
    }
    if let Some(countdown) = &facts.countdown {
        grid(room, &mut laid, countdown, 1);
        return room.turned(laid);
    }
    let mut top = bar(room, &mut laid, &facts.bar);
    if facts.open.contains(&Panel::Scenes) && !facts.scenes.is_empty() {
        top = strip(room, &mut laid, facts, top);
    }
    laid.foot_from = top;
    let sides = |top: f32| {
        let [mut lamp, mut items] = [Laid::default(), Laid::default()];
        if facts.open.contains(&Panel::Light) {
            light(room, &mut lamp, facts, top);
        }
        list(room, &mut items, &facts.list, top);
        [lamp, items]
    };
    let [mut lamp, mut items] = sides(top);
    if let Some(words) = &facts.hint {
        let ground = hint(room, &mut laid, words, top);
        let meets = |other: &Rect| !ground.intersect(*other).is_empty();
        if lamp.grounds.iter().chain(&items.grounds).any(meets) {
            [lamp, items] = sides(ground.min.y);
        }
        // Texts at the foot lie beside it where there is room.
        if ground.min.x < TEXTS * room.text {
            laid.foot_from = ground.min.y;
        }
    }
    // Where there is no room for both, what was opened last goes first.
    let collide = lamp.grounds.iter().any(|a| {
        let shared = |b: &Rect| !a.intersect(*b).is_empty();
        items.grounds.iter().any(shared)
    });
    let sides = match (collide, facts.latest) {
        (true, Some(Panel::Light)) => vec![lamp],
        (true, _) => vec![items],
        (false, _) => vec![lamp, items],
    };
    for side in sides {
        laid.widgets.extend(side.widgets);
        laid.grounds.extend(side.grounds);
    }
    room.turned(laid)
}

/// The row at the bottom, in as many rows as it takes; returns where it ends above.
fn bar(room: &Room, laid: &mut Laid, items: &[Item]) -> f32 {
    let (free, gap, target) = (room.free(), room.gap(), room.target());
    let widest = items.iter().map(|item| room.width_of(&item.words));
    let width = widest.fold(target, f32::max) + room.text * 0.6;
    let columns = (((free.width() - gap) / (width + gap)) as usize).clamp(1, items.len().max(1));
    let rows = items.len().div_ceil(columns);
    let columns = items.len().div_ceil(rows.max(1));
    let height = rows as f32 * (target + gap) + gap;
    let across = columns as f32 * (width + gap) + gap;
    let left = (room.size.x - across) / 2.0;
    let top = free.max.y - height;
    laid.grounds
        .push(Rect::new(left, top, left + across, free.max.y));
    for (k, item) in items.iter().enumerate() {
        let rect = room.cell(
            Vec2::new(left + gap, top + gap),
            [k % columns, k / columns],
            width,
        );
        laid.widgets.push(item.at(rect));
    }
    top
}

/// Pictures of scenes above `bottom`, with arrows where there are more; returns where it ends above.
fn strip(room: &Room, laid: &mut Laid, facts: &Facts, bottom: f32) -> f32 {
    let (free, gap, target) = (room.free(), room.gap(), room.target());
    let size = THUMB * target + Vec2::new(0.0, room.text * LINE);
    let room_for = ((free.width() - gap - 2.0 * (target + gap)) / (size.x + gap)) as usize;
    let count = room_for.clamp(1, facts.scenes.len());
    let first = facts.first_scene.min(facts.scenes.len() - count);
    let is_paged = count < facts.scenes.len();
    let arrows = if is_paged { 2.0 * (target + gap) } else { 0.0 };
    let across = count as f32 * (size.x + gap) + gap + arrows;
    let left = (room.size.x - across) / 2.0;
    let top = bottom - gap - size.y - 2.0 * gap;
    laid.grounds
        .push(Rect::new(left, top, left + across, bottom - gap));
    let mut x = left + gap;
    let [back, on] = facts.arrows.unwrap_or([Icon::Previous, Icon::Next]);
    let arrow = |x: f32, control, icon| Widget {
        control,
        rect: Rect::new(x, top + gap, x + target, top + gap + size.y),
        icon: Some(icon),
        words: String::new(),
        look: Look::Button { on: false },
    };
    if is_paged {
        laid.widgets.push(arrow(x, Control::Page(-1), back));
        x += target + gap;
    }
    for scene in first..first + count {
        let min = Vec2::new(x, top + gap);
        laid.widgets.push(Widget {
            control: Control::Scene(scene),
            rect: Rect::from_corners(min, min + size),
            icon: None,
            words: facts.scenes[scene].clone(),
            look: Look::Picture {
                scene,
                on: scene == facts.scene,
            },
        });
        x += size.x + gap;
    }
    if is_paged {
        laid.widgets.push(arrow(x, Control::Page(1), on));
    }
    top
}

/// A line of words above `bottom`, in as many lines as it takes; returns its ground.
fn hint(room: &Room, laid: &mut Laid, words: &str, bottom: f32) -> Rect {
    let (free, gap) = (room.free(), room.gap());
    let long = LOUD * letters(words) as f32 * CHARACTER * room.text + 2.0 * room.text;
    let across = long.min(free.width());
    let lines = (long / across).ceil().max(1.0);
    let height = lines * LOUD * LINE * room.text + 0.8 * room.text;
    let left = (room.size.x - across) / 2.0;
    let ground = Rect::new(left, bottom - gap - height, left + across, bottom - gap);
    laid.grounds.push(ground);
    laid.widgets.push(Widget {
        control: Control::Said,
        rect: ground,
        icon: None,
        words: words.to_owned(),
        look: Look::Words,
    });
    ground
}

/// The lamp in the hand, at the side where reading ends.
fn light(room: &Room, laid: &mut Laid, facts: &Facts, bottom: f32) {
    let (free, gap, target) = (room.free(), room.gap(), room.target());
    let columns = 4;
    let words = facts.presets.iter().flat_map(|item| item.words.split(' '));
    let widest = words.map(|word| room.width_of(word) + 0.6 * room.text);
    let width = widest.fold(target, f32::max);
    let across = columns as f32 * (width + gap) + gap;
    let rows = facts.presets.len().div_ceil(columns);
    let line = room.text * LINE;
    // Words in two lines leave their sign its room.
    let breaks = |item: &Item| room.width_of(&item.words) + 0.6 * room.text > width;
    let preset = match facts.presets.iter().any(breaks) {
        true => target + line,
        false => target,
    };
    let room_for = bottom - gap - free.min.y;
    let tall = |sliders: usize| {
        rows as f32 * (preset + gap) + sliders as f32 * (target + gap) + 3.0 * gap + line
    };
    // What there is no room for is left to keys: the lamp itself comes first.
    let sliders = match tall(facts.sliders.len()) - line <= room_for {
        true => &facts.sliders[..],
        false => &[],
    };
    let fixed = tall(sliders.len());
    let above = (DIAL * target).min(room_for - fixed - gap).max(0.0);
    // Where there is no room above the rest, the dial lies beside it.
    let is_beside = above < DIAL_LEAST * target && facts.lamp.is_some();
    let beside = (DIAL * target).min(fixed - line - 3.0 * gap);
    let diameter = if is_beside { beside } else { above };
    let has_dial = facts.lamp.is_some();
    let height = match (has_dial, is_beside) {
        (true, false) => fixed + diameter,
        _ => fixed - line,
    };
    let (left, top) = (free.max.x - across, bottom - gap - height);
    let ground_left = match is_beside {
        true => left - diameter - 2.0 * gap,
        false => left,
    };
    laid.grounds
        .push(Rect::new(ground_left, top, free.max.x, bottom - gap));
    let mut y = top + gap;
    if let Some(place) = facts.lamp {
        let x = match is_beside {
            true => ground_left + gap,
            false => left + (across - diameter) / 2.0,
        };
        let min = Vec2::new(x, y);
        laid.widgets.push(Widget {
            control: Control::Dial,
            rect: Rect::from_corners(min, min + diameter),
            icon: None,
            words: String::new(),
            look: Look::Dial { place },
        });
        if !is_beside {
            y += diameter;
            laid.widgets.push(Widget {
                control: Control::Dial,
                rect: Rect::new(left, y, free.max.x, y + line),
                icon: None,
                words: facts.lamp_words.clone(),
                look: Look::Words,
            });
            y += line + gap;
        }
    }
    for (k, item) in facts.presets.iter().enumerate() {
        let cell = Vec2::new((k % columns) as f32, (k / columns) as f32);
        let min = Vec2::new(left + gap, y) + cell * (Vec2::new(width, preset) + gap);
        let rect = Rect::from_corners(min, min + Vec2::new(width, preset));
        laid.widgets.push(item.at(rect));
    }
    y += rows as f32 * (preset + gap);
    for item in sliders {
        laid.widgets
            .push(item.at(Rect::new(left + gap, y, free.max.x - gap, y + target)));
        y += target + gap;
    }
}

/// The open list at the side where reading begins, in one column or two.
fn list(room: &Room, laid: &mut Laid, items: &[Item], bottom: f32) {
    if items.is_empty() {
        return;
    }
    let (free, gap, target) = (room.free(), room.gap(), room.target());
    let fits = |count: usize| count as f32 * (target + gap) + 2.0 * gap <= bottom - free.min.y;
    let columns = (1..4)
        .find(|columns| fits(items.len().div_ceil(*columns)))
        .unwrap_or(4);
    let rows = items.len().div_ceil(columns);
    let widest = items.iter().map(|item| {
        room.width_of(&item.words) + room.text * if item.icon.is_some() { SIGN + 0.6 } else { 0.6 }
    });
    let widest = widest.fold(2.0 * target, f32::max);
    let width = widest.min(LIST_TARGETS * target);
    let across = columns as f32 * (width + gap) + gap;
    let height = rows as f32 * (target + gap) + gap;
    let top = (bottom - gap - height).max(free.min.y);
    laid.grounds.push(Rect::new(
        free.min.x,
        top,
        free.min.x + across,
        bottom - gap,
    ));
    for (k, item) in items.iter().enumerate() {
        let rect = room.cell(
            Vec2::new(free.min.x + gap, top + gap),
            [k / rows, k % rows],
            width,
        );
        laid.widgets.push(item.at(rect));
    }
}

/// Words and buttons in the middle of what is reached, `columns` in a row below a line of words.
fn grid(room: &Room, laid: &mut Laid, items: &[Item], columns: usize) {
    let (free, gap, target) = (room.free(), room.gap(), room.target());
    let is_words = |item: &&Item| item.look == Look::Words;
    let (words, buttons): (Vec<&Item>, Vec<&Item>) = items.iter().partition(is_words);
    let widest = buttons.iter().map(|item| room.width_of(&item.words));
    let width = widest.fold(1.4 * target, f32::max) + room.text;
    let line = room.text * LINE * 1.4;
    let rows = buttons.len().div_ceil(columns.max(1));
    let head = words.len() as f32 * line;
    let said = words.iter().map(|item| room.width_of(&item.words) * 1.25);
    let across = said.fold(columns as f32 * (width + gap) + gap, f32::max) + 2.0 * gap;
    let height = head + rows as f32 * (target + gap) + 3.0 * gap;
    let middle = Vec2::new(room.size.x / 2.0, free.center().y);
    let min = middle - Vec2::new(across, height) / 2.0;
    laid.grounds
        .push(Rect::from_corners(min, min + Vec2::new(across, height)));
    for (k, item) in words.iter().enumerate() {
        let y = min.y + gap + k as f32 * line;
        laid.widgets
            .push(item.at(Rect::new(min.x, y, min.x + across, y + line)));
    }
    let left = middle.x - (columns as f32 * (width + gap) - gap) / 2.0;
    for (k, item) in buttons.iter().enumerate() {
        let corner = Vec2::new(left, min.y + head + 2.0 * gap);
        let rect = room.cell(corner, [k % columns, k / columns], width);
        laid.widgets.push(item.at(rect));
    }
}

#[cfg(test)]
mod tests;
