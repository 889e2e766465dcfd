//! Hotspots under the hand: which are in view, where their outlines lie in the picture, which one
//! is open, and how they are drawn.

use std::sync::Arc;

use bevy::{prelude::*, ui::UiTransform};
use glam::{DVec2, DVec3, DVec4};

use super::{caption::Texts, hand::Hand, intent::Intent, view::wrapped};
use crate::{
    manifest::{
        comparison::Part,
        exhibit::{Drawing, Hotspot, SideName},
        eye::Eye,
        hotspot::contains,
        surface::SideSurface,
    },
    stage::{
        Arranged, Library, Shared, Shown,
        legend::TextCamera,
        library::{Held, Request},
    },
};

/// Along a curled sheet an outline bends in steps of this length.
const STEP_MM: f64 = 3.0;
/// Width of an outline with its dark rims, and of the open one's, in logical pixels.
const WIDTH_PX: f32 = 3.0;
const OPEN_WIDTH_PX: f32 = 5.0;
const RIM_PX: f32 = 1.0;

/// Which hotspots somebody asked to see, and which one they opened.
#[derive(Clone, Debug, Default)]
pub struct Hotspots {
    shown: bool,
    /// The id of the open one.
    open: Option<String>,
    /// Outlines on a sheet that is not flat.
    curled: Option<Curled>,
}

/// Outlines on the sheet as it is shaped.
#[derive(Clone, Debug)]
struct Curled {
    surface: Arc<SideSurface>,
    hotspots: Vec<Hotspot>,
    /// Of each hotspot, in the sheet's own frame.
    outlines: Vec<Vec<DVec3>>,
}

/// A hotspot in view.
#[derive(Clone, Debug)]
pub struct Seen {
    /// Index into the drawing's hotspots.
    pub hotspot: usize,
    /// Its outline in the picture (−1…1, y up).
    pub outline: Vec<DVec2>,
    /// What of the picture its sheet has.
    part: Part,
}

impl Hotspots {
    /// Learns how the sheet is shaped.
    fn learn(&mut self, drawing: &Drawing, surface: &Arc<SideSurface>) {
        let known = self.curled.as_ref().is_some_and(|curled| {
            Arc::ptr_eq(&curled.surface, surface) && curled.hotspots == drawing.hotspots
        });
        if known {
            return;
        }
        let half = drawing.size_mm / 2.0;
        let on_surface = |place: DVec3| {
            let on_recto = DVec2::new(place.x + half.x, half.y - place.y);
            surface_point(surface, on_recto).unwrap_or(place)
        };
        let outlines = drawing.hotspots.iter().map(|hotspot| {
            let corners = drawing.outline(hotspot);
            let edges = corners.iter().zip(corners.iter().cycle().skip(1));
            let steps = edges.flat_map(|(a, b)| {
                let count = (a.distance(*b) / STEP_MM).ceil().max(1.0) as usize;
                (0..count).map(move |k| a.lerp(*b, k as f64 / count as f64))
            });
            steps.map(on_surface).collect()
        });
        self.curled = Some(Curled {
            outlines: outlines.collect(),
            surface: surface.clone(),
            hotspots: drawing.hotspots.clone(),
        });
    }

    fn outline(&self, drawing: &Drawing, hotspot: usize) -> Vec<DVec3> {
        let curled = self.curled.as_ref();
        match curled.filter(|curled| curled.hotspots == drawing.hotspots) {
            Some(curled) => curled.outlines[hotspot].clone(),
            None => drawing.outline(&drawing.hotspots[hotspot]),
        }
    }

    /// Every hotspot of the drawing that is shown, on the sides that are in view.
    pub fn seen(&self, shown: &Shown) -> Vec<Seen> {
        let mut seen = Vec::new();
        let comparison = shown.scene.compare.as_ref();
        // Of members that are shown in one, each place is the same in all.
        let in_one = comparison.is_some_and(|comparison| comparison.mode.combines());
        let count = if in_one { 1 } else { usize::MAX };
        for member in shown.members().into_iter().take(count) {
            if member.scene.drawing != shown.scene.drawing {
                continue;
            }
            let drawing = shown.exhibit.drawing_of(&member.scene);
            let aspect = member.part.aspect(shown.aspect);
            let camera = member.scene.camera.fitted(drawing.size_mm, aspect);
            let eye = Eye::new(&camera, drawing.size_mm);
            let clip = member.part.clip_from_own() * eye.clip_from_table(aspect);
            let in_picture = |place: &DVec3| {
                let at: DVec4 = clip * (member.pose * *place).extend(1.0);
                (at.w > 0.0).then(|| DVec2::new(at.x, at.y) / at.w)
            };
            let side = facing(&member, &eye);
            for (index, hotspot) in drawing.hotspots.iter().enumerate() {
                if hotspot.side != side {
                    continue;
                }
                let outline = self.outline(drawing, index);
                // What reaches behind the eye has no outline in the picture.
                let outline: Option<Vec<DVec2>> = outline.iter().map(in_picture).collect();
                seen.extend(outline.map(|outline| Seen {
                    hotspot: index,
                    outline,
                    part: member.part,
                }));
            }
        }
        seen
    }
}

/// Which side of a member's sheet the eye sees.
fn facing(member: &Shared, eye: &Eye) -> SideName {
    // Towards the eye, and for one at a finite distance its place, seen from the sheet's middle.
    let towards = member.pose.inverse() * eye.place().truncate();
    match towards.z >= 0.0 {
        true => SideName::Recto,
        false => SideName::Verso,
    }
}

/// The point of a sheet's surface over a place of its recto.
fn surface_point(surface: &SideSurface, place: DVec2) -> Option<DVec3> {
    surface.indices.chunks_exact(3).find_map(|triangle| {
        let [a, b, c] = [0, 1, 2].map(|k| triangle[k] as usize);
        let [origin, u, v] = [surface.side[a], surface.side[b], surface.side[c]];
        let (u, v, to) = (u - origin, v - origin, place - origin);
        let area = u.perp_dot(v);
        let (s, t) = (to.perp_dot(v) / area, u.perp_dot(to) / area);
        const NEAR: f64 = 1e-9;
        (s >= -NEAR && t >= -NEAR && s + t <= 1.0 + NEAR).then(|| {
            let at = surface.positions[a];
            at + (surface.positions[b] - at) * s + (surface.positions[c] - at) * t
        })
    })
}

impl Hand {
    /// Whether somebody asked to see the hotspots.
    pub fn shows_hotspots(&self) -> bool {
        self.hotspots.shown
    }

    /// The hotspot that is open, if its side is in view.
    pub fn open_hotspot(&self) -> Option<&Hotspot> {
        let id = self.hotspots.open.as_ref()?;
        let hotspots = self.drawing().hotspots.iter();
        let open = hotspots.enumerate().find(|(_, hotspot)| hotspot.id == *id);
        let (index, hotspot) = open?;
        let seen = self.hotspots.seen(&self.shown());
        seen.iter()
            .any(|seen| seen.hotspot == index)
            .then_some(hotspot)
    }

    /// Closes the hotspot that is open; whether there was one.
    pub fn close_hotspot(&mut self) -> bool {
        let open = self.open_hotspot().is_some();
        self.hotspots.open = None;
        open
    }

    /// The smallest hotspot at a place of the picture, while they are shown.
    pub(super) fn hotspot_at(&self, at: DVec2) -> Option<usize> {
        if !self.hotspots.shown {
            return None;
        }
        let shown = self.shown();
        let hotspots = &self.drawing().hotspots;
        let seen = self.hotspots.seen(&shown);
        let under = seen
            .iter()
            .filter(|seen| seen.part.shows(at, shown.aspect) && contains(&seen.outline, at));
        let area = |index: &usize| hotspots[*index].area_mm2();
        under
            .map(|seen| seen.hotspot)
            .min_by(|a, b| area(a).total_cmp(&area(b)))
    }

    /// Follows a wish that is about hotspots.
    pub(super) fn point_out(&mut self, intent: Intent) {
        match intent {
            Intent::Hotspots => {
                self.hotspots.shown = !self.hotspots.shown;
                self.hotspots.open = None;
            }
            Intent::Tap(at) if self.hotspots.shown => match self.hotspot_at(at) {
                Some(index) if self.open_index() == Some(index) => self.go_on(),
                hit => self.open(hit),
            },
            Intent::StepHotspot(by) => {
                self.hotspots.shown = true;
                let mut seen: Vec<usize> = self
                    .hotspots
                    .seen(&self.shown())
                    .iter()
                    .map(|seen| seen.hotspot)
                    .collect();
                seen.sort_unstable();
                seen.dedup();
                let open = self.open_index();
                let at = open.and_then(|open| seen.iter().position(|index| *index == open));
                let next = match at {
                    Some(at) => wrapped(at, by, seen.len()),
                    None if by < 0 => seen.len().saturating_sub(1),
                    None => 0,
                };
                self.open(seen.get(next).copied());
            }
            Intent::GoOn => self.go_on(),
            _ => {}
        }
    }

    fn open_index(&self) -> Option<usize> {
        let id = &self.open_hotspot()?.id;
        let hotspots = self.drawing().hotspots.iter();
        hotspots
            .map(|hotspot| &hotspot.id)
            .position(|other| other == id)
    }

    fn open(&mut self, index: Option<usize>) {
        self.hotspots.open = index.map(|index| self.drawing().hotspots[index].id.clone());
    }

    /// To the scene of the open hotspot, if it leads to one.
    fn go_on(&mut self) {
        if let Some(scene) = self.open_hotspot().and_then(|hotspot| hotspot.scene) {
            self.enter(scene);
        }
    }
}

/// One straight piece of an outline on screen.
#[derive(Component)]
pub struct Line;

/// A piece of an outline: from where to where in logical pixels, and whether it is the open one's.
type Piece = (Vec2, Vec2, bool);

/// Draws the outlines that moved.
pub fn draw(
    mut commands: Commands,
    (shown, mut hand, mut texts): (Res<Shown>, ResMut<Hand>, ResMut<Texts>),
    (arranged, mut library): (Res<Arranged>, ResMut<Library>),
    (windows, cameras): (Query<&Window>, Query<Entity, With<TextCamera>>),
    lines: Query<Entity, With<Line>>,
    mut drawn: Local<Vec<Piece>>,
) {
    let (Ok(camera), Ok(window)) = (cameras.single(), windows.single()) else {
        return;
    };
    let mut pieces = Vec::new();
    if hand.shows_hotspots() {
        let drawing = shown.exhibit.drawing_of(&shown.scene);
        if arranged.is_settled() {
            // On the stage it is loaded, and looking at it is no change.
            let shape = Request::Surface(drawing.surface.clone(), drawing.size_mm);
            let held = library.bypass_change_detection().take(&[shape], None);
            if let Some([Held::Surface(surface)]) = held.as_deref() {
                hand.bypass_change_detection()
                    .hotspots
                    .learn(drawing, surface);
            }
        }
        let open = hand.open_index();
        for seen in hand.hotspots.seen(&shown) {
            pieces.extend(self::pieces(&seen, shown.aspect, window.size(), open));
        }
    }
    if *drawn == pieces {
        return;
    }
    texts.set_changed();
    for line in &lines {
        commands.entity(line).despawn();
    }
    for (from, to, open) in &pieces {
        commands.spawn((Line, UiTargetCamera(camera), stroke(*from, *to, *open)));
    }
    *drawn = pieces;
}

/// The straight pieces of an outline, in pixels from the top left.
fn pieces(seen: &Seen, aspect: f64, size: Vec2, open: Option<usize>) -> Vec<Piece> {
    let outline = &seen.outline;
    let px = |at: &DVec2| {
        let share = DVec2::new(at.x + 1.0, 1.0 - at.y) / 2.0;
        share.as_vec2() * size
    };
    let mut pieces: Vec<Piece> = Vec::new();
    let mut through: Vec<Vec2> = Vec::new();
    for (a, b) in outline.iter().zip(outline.iter().cycle().skip(1)) {
        if !(seen.part.shows(*a, aspect) && seen.part.shows(*b, aspect)) {
            through.clear();
            continue;
        }
        let (from, to) = (px(a), px(b));
        // What goes straight on is one piece.
        if let Some((start, end, _)) = pieces.last_mut()
            && *end == from
            && through
                .iter()
                .chain([&from])
                .all(|p| is_near(*p, *start, to))
        {
            *end = to;
            through.push(from);
            continue;
        }
        through.clear();
        pieces.push((from, to, open == Some(seen.hotspot)));
    }
    pieces
}

/// Whether a place lies on a line as far as can be seen.
fn is_near(place: Vec2, from: Vec2, to: Vec2) -> bool {
    const NEAR_PX: f32 = 0.4;
    let along = to - from;
    let t = (place - from).dot(along) / along.length_squared().max(1e-6);
    place.distance(from + along * t.clamp(0.0, 1.0)) <= NEAR_PX
}

/// A light line with dark rims, which is seen on paper and on ink.
fn stroke(from: Vec2, to: Vec2, open: bool) -> impl Bundle {
    let width = if open { OPEN_WIDTH_PX } else { WIDTH_PX };
    let colour = match open {
        true => Color::srgb(1.0, 0.72, 0.1),
        false => Color::srgb(0.97, 0.96, 0.92),
    };
    let (along, middle) = (to - from, (from + to) / 2.0);
    // As long as it is wide beyond its ends, so that corners are closed.
    let length = along.length() + width;
    (
        Node {
            position_type: PositionType::Absolute,
            left: Val::Px(middle.x - length / 2.0),
            top: Val::Px(middle.y - width / 2.0),
            width: Val::Px(length),
            height: Val::Px(width),
            border: UiRect::vertical(Val::Px(RIM_PX)),
            ..default()
        },
        BackgroundColor(colour),
        BorderColor::all(Color::srgba(0.05, 0.05, 0.05, 0.8)),
        UiTransform::from_rotation(Rot2::radians(along.to_angle())),
        // Below the texts.
        GlobalZIndex(-1),
    )
}
