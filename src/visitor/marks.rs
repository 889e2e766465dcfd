//! Lines, rings and words that lie on the sheet, drawn over the picture.

use std::sync::Arc;

use bevy::{prelude::*, ui::UiTransform};
use glam::{DMat4, DVec2, DVec3, DVec4};

use super::caption::Texts;
use crate::{
    manifest::{
        comparison::Part,
        exhibit::{Drawing, Scene, SideName, Surface},
        eye::Eye,
        surface::SideSurface,
    },
    readings::sight::{Lying, surface_point},
    stage::{
        Arranged, Library, Shown,
        legend::{Face, TextCamera, line},
        library::{Held, Request},
    },
};

/// Along a curled sheet a line bends in steps of this length.
const STEP_MM: f64 = 3.0;
/// Radius of a ring, in logical pixels.
const RING_PX: f32 = 7.0;
const RIM_PX: f32 = 1.0;
/// Steps in which a line is looked at that leaves its sheet's part of the picture, and halvings that
/// find where: far below a pixel.
const LOOKS: usize = 24;
const HALVINGS: usize = 16;
/// Behind words on the sheet.
const DARK: Color = Color::srgba(0.05, 0.05, 0.05, 0.85);
/// Size of words on the sheet, against that of the legend.
const WORDS: f32 = 0.85;

/// How a mark is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// Light, for what can be opened.
    Quiet,
    /// Of what is open.
    Open,
    /// Of what is measured.
    Measured,
    /// Thin, where members of a comparison meet.
    Edge,
}

impl Ink {
    fn width_px(self) -> f32 {
        match self {
            Self::Quiet => 3.0,
            Self::Open => 5.0,
            Self::Measured => 3.5,
            Self::Edge => 3.0,
        }
    }

    fn colour(self) -> Color {
        match self {
            Self::Quiet | Self::Edge => Color::srgb(0.97, 0.96, 0.92),
            Self::Open => Color::srgb(1.0, 0.72, 0.1),
            Self::Measured => Color::srgb(0.45, 0.85, 1.0),
        }
    }
}

/// One thing over the picture, in logical pixels from its top left corner.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    Line {
        from: Vec2,
        to: Vec2,
        ink: Ink,
    },
    Ring {
        middle: Vec2,
        ink: Ink,
    },
    /// Beside a place, or above its middle.
    Words {
        at: Vec2,
        text: String,
        is_centred: bool,
    },
}

/// All that lies over the picture, by whose it is.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct Marks {
    pub compared: Vec<Mark>,
    pub hotspots: Vec<Mark>,
    pub measured: Vec<Mark>,
    pub pointer: Vec<Mark>,
}

/// How the sheet that is shown is shaped, once that is known.
#[derive(Resource, Clone, Debug, Default)]
pub struct Shape(Option<(Surface, DVec2, Arc<SideSurface>)>);

impl Shape {
    /// The recto's surface of a drawing.
    pub fn of(&self, drawing: &Drawing) -> Option<&Arc<SideSurface>> {
        let (surface, size_mm, shape) = self.0.as_ref()?;
        (*surface == drawing.surface && *size_mm == drawing.size_mm).then_some(shape)
    }
}

#[cfg(test)]
impl Shape {
    /// Of a flat drawing, without a stage.
    pub fn flat(drawing: &Drawing) -> Self {
        let shape = Arc::new(SideSurface::flat(drawing.size_mm));
        Self(Some((drawing.surface.clone(), drawing.size_mm, shape)))
    }
}

/// Learns how the sheet is shaped. On the stage it is loaded, and looking at it is no change.
pub fn learn(
    shown: Res<Shown>,
    (arranged, mut library): (Res<Arranged>, ResMut<Library>),
    mut shape: ResMut<Shape>,
) {
    let drawing = shown.exhibit.drawing_of(&shown.scene);
    if !arranged.is_settled() || (shape.of(drawing).is_some() && !arranged.is_fresh()) {
        return;
    }
    let request = Request::Surface(drawing.surface.clone(), drawing.size_mm);
    let held = library.bypass_change_detection().take(&[request], None);
    if let Some([Held::Surface(surface)]) = held.as_deref() {
        let same = shape
            .of(drawing)
            .is_some_and(|known| Arc::ptr_eq(known, surface));
        if !same {
            shape.0 = Some((drawing.surface.clone(), drawing.size_mm, surface.clone()));
        }
    }
}

/// A line through places of a side in the sheet's own frame, on its `surface` where that is known.
pub fn on_sheet(
    drawing: &Drawing,
    surface: Option<&SideSurface>,
    side: SideName,
    places: &[DVec2],
    closed: bool,
) -> Vec<DVec3> {
    let flat = |place: &DVec2| drawing.on_sheet(side, *place);
    let Some(surface) = surface.filter(|_| drawing.surface != Surface::Flat) else {
        return places.iter().map(flat).collect();
    };
    let half = drawing.size_mm / 2.0;
    let curled = |place: DVec3| {
        let on_recto = DVec2::new(place.x + half.x, half.y - place.y);
        surface_point(surface, on_recto).unwrap_or(place)
    };
    let corners: Vec<DVec3> = places.iter().map(flat).collect();
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let count = if closed {
        corners.len()
    } else {
        corners.len().saturating_sub(1)
    };
    let steps = edges.take(count).flat_map(|(a, b)| {
        let count = (a.distance(*b) / STEP_MM).ceil().max(1.0) as usize;
        (0..count).map(move |k| a.lerp(*b, k as f64 / count as f64))
    });
    let end = corners.last().filter(|_| !closed);
    steps.chain(end.copied()).map(curled).collect()
}

/// A sheet in the picture, and the side of it that is seen.
#[derive(Clone, Debug)]
pub struct InView {
    /// Without a comparison of its own.
    pub scene: Scene,
    pub side: SideName,
    pub lying: Lying,
    clip: DMat4,
}

impl InView {
    /// Where a point of the sheet's own frame lies in the picture (−1…1, y up); `None` behind the
    /// eye.
    pub fn ndc(&self, point: DVec3) -> Option<DVec2> {
        let at: DVec4 = self.clip * point.extend(1.0);
        (at.w > 0.0).then(|| DVec2::new(at.x, at.y) / at.w)
    }
}

/// How often the drawing that is shown lies in the picture. Of members that are shown in one, each
/// place is the same in all, and the first stands for them.
pub fn in_view(shown: &Shown) -> Vec<InView> {
    let comparison = shown.scene.compare.as_ref();
    let in_one = comparison.is_some_and(|comparison| comparison.mode.combines());
    let count = if in_one { 1 } else { usize::MAX };
    let members = shown.members().into_iter().take(count);
    let drawing = shown.exhibit.drawing_of(&shown.scene);
    let of_drawing = members.filter(|member| member.scene.drawing == shown.scene.drawing);
    of_drawing
        .map(|member| {
            let aspect = member.part.aspect(shown.aspect);
            let camera = member.scene.camera.fitted(drawing.size_mm, aspect);
            let eye = Eye::new(&camera, drawing.size_mm);
            // Towards the eye, and for one at a finite distance its place, seen from the sheet's
            // middle.
            let towards = member.pose.inverse() * eye.place().truncate();
            InView {
                side: match towards.z >= 0.0 {
                    true => SideName::Recto,
                    false => SideName::Verso,
                },
                lying: Lying {
                    eye,
                    part: member.part,
                    pose: member.pose,
                },
                clip: member.part.clip_from_own()
                    * eye.clip_from_table(aspect)
                    * DMat4::from_quat(member.pose),
                scene: member.scene,
            }
        })
        .collect()
}

/// From −1…1 (y up) to pixels of a picture of `size` from its top left corner.
pub fn px(ndc: DVec2, size: Vec2) -> Vec2 {
    (DVec2::new(ndc.x + 1.0, 1.0 - ndc.y) / 2.0).as_vec2() * size
}

/// A line through places of the picture (−1…1, y up), as far as it lies in `part`.
pub fn lines(
    places: &[DVec2],
    closed: bool,
    part: &Part,
    (aspect, size): (f64, Vec2),
    ink: Ink,
) -> Vec<Mark> {
    let edges = places.iter().zip(places.iter().cycle().skip(1));
    let count = if closed {
        places.len()
    } else {
        places.len().saturating_sub(1)
    };
    let mut pieces: Vec<(Vec2, Vec2)> = Vec::new();
    let mut through: Vec<Vec2> = Vec::new();
    for (a, b) in edges
        .take(count)
        .flat_map(|(a, b)| within(part, aspect, *a, *b))
    {
        let (from, to) = (px(a, size), px(b, size));
        // What goes straight on is one piece.
        if let Some((start, end)) = pieces.last_mut()
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
        pieces.push((from, to));
    }
    let line = |(from, to)| Mark::Line { from, to, ink };
    pieces.into_iter().map(line).collect()
}

/// The pieces of a straight line that lie in `part`.
fn within(part: &Part, aspect: f64, a: DVec2, b: DVec2) -> Vec<(DVec2, DVec2)> {
    if !part.is_cut() {
        return vec![(a, b)];
    }
    let shows = |t: f64| part.shows(a.lerp(b, t), aspect);
    // Where it enters or leaves, between a place that lies in the part and one that does not.
    let edge = |mut inside: f64, mut outside: f64| {
        for _ in 0..HALVINGS {
            let middle = (inside + outside) / 2.0;
            *(if shows(middle) {
                &mut inside
            } else {
                &mut outside
            }) = middle;
        }
        inside
    };
    let mut pieces = Vec::new();
    let mut entered = shows(0.0).then_some(0.0);
    for k in 1..=LOOKS {
        let [before, now] = [k - 1, k].map(|k| k as f64 / LOOKS as f64);
        match (entered, shows(now)) {
            (None, true) => entered = Some(edge(now, before)),
            (Some(from), false) => {
                pieces.push((from, edge(before, now)));
                entered = None;
            }
            _ => {}
        }
    }
    pieces.extend(entered.map(|from| (from, 1.0)));
    let piece = |(from, to)| (a.lerp(b, from), a.lerp(b, to));
    pieces.into_iter().map(piece).collect()
}

/// Whether a place lies on a line as far as can be seen.
fn is_near(place: Vec2, from: Vec2, to: Vec2) -> bool {
    const NEAR_PX: f32 = 0.4;
    let along = to - from;
    let t = (place - from).dot(along) / along.length_squared().max(1e-6);
    place.distance(from + along * t.clamp(0.0, 1.0)) <= NEAR_PX
}

/// A mark on screen.
#[derive(Component)]
pub struct Drawn;

/// Draws the marks that changed.
pub fn draw(
    mut commands: Commands,
    (marks, mut texts): (Res<Marks>, ResMut<Texts>),
    face: Option<Res<Face>>,
    cameras: Query<(Entity, &TextCamera)>,
    drawn: Query<Entity, With<Drawn>>,
    mut last: Local<Marks>,
) {
    let (Ok((camera, text)), Some(face)) = (cameras.single(), face) else {
        return;
    };
    if *last == *marks {
        return;
    }
    texts.set_changed();
    for mark in &drawn {
        commands.entity(mark).despawn();
    }
    let size = text.text_size() * WORDS;
    let all = marks
        .compared
        .iter()
        .chain(&marks.hotspots)
        .chain(&marks.measured)
        .chain(&marks.pointer);
    for mark in all {
        let mut spawned = match mark {
            Mark::Line { from, to, ink } => commands.spawn(stroke(*from, *to, *ink)),
            Mark::Ring { middle, ink } => commands.spawn(ring(*middle, *ink)),
            Mark::Words {
                at,
                text,
                is_centred,
            } => {
                let node = Node {
                    position_type: PositionType::Absolute,
                    left: Val::Px(if *is_centred { at.x } else { at.x + size }),
                    top: Val::Px(at.y - size * 0.7),
                    padding: UiRect::axes(Val::Px(size * 0.4), Val::Px(size * 0.15)),
                    ..default()
                };
                let across = if *is_centred { -50.0 } else { 0.0 };
                let aside = UiTransform::from_translation(Val2::percent(across, 0.0));
                let mut words = commands.spawn((node, aside, BackgroundColor(DARK)));
                words.with_child(line(text.clone(), &face.0, size));
                words
            }
        };
        // Below the texts.
        spawned.insert((Drawn, UiTargetCamera(camera), GlobalZIndex(-1)));
    }
    *last = marks.clone();
}

/// A line with dark rims, which is seen on paper and on ink.
fn stroke(from: Vec2, to: Vec2, ink: Ink) -> impl Bundle {
    let width = ink.width_px();
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
        BackgroundColor(ink.colour()),
        BorderColor::all(Color::srgba(0.05, 0.05, 0.05, 0.8)),
        UiTransform::from_rotation(Rot2::radians(along.to_angle())),
    )
}

/// A ring about a place, within a dark one.
fn ring(middle: Vec2, ink: Ink) -> impl Bundle {
    let radius = RING_PX + 2.0 * RIM_PX;
    (
        Node {
            position_type: PositionType::Absolute,
            left: Val::Px(middle.x - radius),
            top: Val::Px(middle.y - radius),
            width: Val::Px(2.0 * radius),
            height: Val::Px(2.0 * radius),
            border: UiRect::all(Val::Px(2.0)),
            border_radius: BorderRadius::MAX,
            ..default()
        },
        BorderColor::all(ink.colour()),
        Outline {
            width: Val::Px(RIM_PX),
            offset: Val::ZERO,
            color: Color::srgba(0.05, 0.05, 0.05, 0.8),
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: (f64, Vec2) = (2.0, Vec2::new(400.0, 200.0));

    fn ends(marks: &[Mark]) -> Vec<[Vec2; 2]> {
        let ends = |mark: &Mark| match mark {
            Mark::Line { from, to, .. } => [*from, *to],
            other => panic!("{other:?}"),
        };
        marks.iter().map(ends).collect()
    }

    #[test]
    fn a_line_ends_where_its_part_of_the_picture_does() {
        let across = [DVec2::new(-0.5, 0.0), DVec2::new(0.5, 0.0)];
        let whole = ends(&lines(&across, false, &Part::WHOLE, WHOLE, Ink::Quiet));
        assert_eq!(whole, [[Vec2::new(100.0, 100.0), Vec2::new(300.0, 100.0)]]);
        // The right half, and what is left of a disc in the middle.
        let mut right = Part::WHOLE;
        right.lines[0] = DVec3::new(1.0, 0.0, 0.0);
        let cut = ends(&lines(&across, false, &right, WHOLE, Ink::Quiet));
        assert_eq!(cut.len(), 1);
        assert!(
            cut[0][0].distance(Vec2::new(200.0, 100.0)) < 0.01,
            "{cut:?}"
        );
        let around = Part {
            circle: DVec4::new(0.0, 0.0, 0.4, -1.0),
            ..Part::WHOLE
        };
        let cut = ends(&lines(&across, false, &around, WHOLE, Ink::Quiet));
        // Widths are counted in half heights.
        let edges: Vec<f32> = cut.iter().flatten().map(|place| place.x).collect();
        for (edge, right) in edges.iter().zip([100.0, 160.0, 240.0, 300.0]) {
            assert!((edge - right).abs() < 0.01, "{edges:?}");
        }
        assert_eq!(edges.len(), 4);
        right.lines[0] = DVec3::new(1.0, 0.0, -0.9);
        assert!(lines(&across, false, &right, WHOLE, Ink::Quiet).is_empty());
    }

    #[test]
    fn what_is_straight_is_one_piece_and_what_is_closed_comes_back() {
        let straight: Vec<DVec2> = (0..9)
            .map(|k| DVec2::new(f64::from(k) / 10.0, 0.3))
            .collect();
        assert_eq!(
            lines(&straight, false, &Part::WHOLE, WHOLE, Ink::Open).len(),
            1
        );
        let corner = [DVec2::ZERO, DVec2::new(0.5, 0.0), DVec2::new(0.5, 0.5)];
        assert_eq!(
            lines(&corner, false, &Part::WHOLE, WHOLE, Ink::Open).len(),
            2
        );
        assert_eq!(
            lines(&corner, true, &Part::WHOLE, WHOLE, Ink::Open).len(),
            3
        );
    }
}
