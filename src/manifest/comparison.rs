//! A comparison as the scenes of its members, and the part of the picture that each of them has.
//!
//! Places in the picture are in NDC: −1…1, x right, y up.

use glam::{DMat4, DVec2, DVec3, DVec4};

use super::{
    exhibit::{
        Camera, CompareMode, Comparison, Drawing, Exhibit, FlipAxis, Member, Scene, SideName,
    },
    frames,
    overrides::NO_STATE,
    raw::values::Choice,
};
use crate::units::Degrees;

/// Of a picture, what one member of a comparison has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// The member's own picture is scaled by this about its middle, and then shifted.
    pub scale: DVec2,
    pub shift: DVec2,
    /// The member is seen where a·x + b·y + c ≥ 0 for all of these (a, b, c),
    pub lines: [DVec3; 4],
    /// and where s·(r² − d²) ≥ 0, d the distance from the centre (x, y) with widths counted in half
    /// heights: (x, y, r, s), s 1 for the inside, −1 for the outside, 0 for no circle.
    pub circle: DVec4,
}

/// No line: everything lies on its inner side.
const NO_LINE: DVec3 = DVec3::Z;

impl Part {
    /// The whole picture.
    pub const WHOLE: Self = Self {
        scale: DVec2::ONE,
        shift: DVec2::ZERO,
        lines: [NO_LINE; 4],
        circle: DVec4::ZERO,
    };

    /// Nothing of the picture.
    const NOTHING: Self = Self {
        lines: [DVec3::NEG_Z; 4],
        ..Self::WHOLE
    };
    /// All of it, by the means of a part: those who take turns are drawn by one pipeline.
    const ALL: Self = Self {
        circle: DVec4::new(0.0, 0.0, 1e3, 1.0),
        ..Self::WHOLE
    };

    /// Whether anything of the picture is another member's.
    pub fn is_cut(&self) -> bool {
        self.lines != Self::WHOLE.lines || self.circle != Self::WHOLE.circle
    }

    /// Width over height of the member's own picture in one of `aspect`.
    pub fn aspect(&self, aspect: f64) -> f64 {
        aspect * self.scale.x / self.scale.y
    }

    /// The clip space of the whole from that of the member's own picture.
    pub fn clip_from_own(&self) -> DMat4 {
        let [scale, shift] = [self.scale, self.shift];
        DMat4::from_translation(shift.extend(0.0)) * DMat4::from_scale(scale.extend(1.0))
    }

    /// Whether the member is seen at `ndc` in a picture of `aspect`.
    pub fn shows(&self, ndc: DVec2, aspect: f64) -> bool {
        let [x, y, r, s] = self.circle.to_array();
        let from_centre = (ndc - DVec2::new(x, y)) * DVec2::new(aspect, 1.0);
        let beside = |line: &DVec3| line.dot(ndc.extend(1.0)) >= 0.0;
        self.lines.iter().all(beside) && s * (r * r - from_centre.length_squared()) >= 0.0
    }

    /// A place near the upper end of what the member has of a picture of `aspect`, in its middle;
    /// `None` where that is nothing.
    pub fn top(&self, aspect: f64) -> Option<DVec2> {
        let at = |k: usize| (k as f64 + 0.5) / LOOKS as f64 * 2.0 - 1.0;
        (0..LOOKS).rev().find_map(|row| {
            let shows = |column: &usize| self.shows(DVec2::new(at(*column), at(row)), aspect);
            let columns: Vec<usize> = (0..LOOKS).filter(shows).collect();
            // What another member lies in has two ends: in the middle of the longer one.
            let runs = columns.chunk_by(|a, b| a + 1 == *b);
            let run = runs.max_by_key(|run| run.len())?;
            Some(DVec2::new(at(run[run.len() / 2]), at(row)))
        })
    }

    /// The curtain's part `k` of `count`: bands across the direction at `angle` (radians,
    /// anticlockwise from the right), the first two of two divided at the share `at` of the way.
    fn band(k: usize, count: usize, at: f64, angle: f64, aspect: f64) -> Self {
        let (across, reach) = across(angle, aspect);
        let edge = |k: usize| edge(k, count, at, reach);
        let mut lines = [NO_LINE; 4];
        if k > 0 {
            lines[0] = across.extend(-edge(k));
        }
        if k + 1 < count {
            lines[1] = (-across).extend(edge(k + 1));
        }
        Self {
            lines,
            ..Self::WHOLE
        }
    }

    /// Cell `k` of `count` (2 to 4): columns from the left, four in two rows.
    fn cell(k: usize, count: usize) -> Self {
        let (columns, rows) = if count == 4 { (2, 2) } else { (count, 1) };
        let scale = DVec2::new(1.0 / columns as f64, 1.0 / rows as f64);
        let column = (k % columns) as f64;
        let row = (k / columns) as f64;
        let shift = DVec2::new(
            (2.0 * column + 1.0) * scale.x - 1.0,
            1.0 - (2.0 * row + 1.0) * scale.y,
        );
        Self {
            scale,
            shift,
            lines: [
                DVec3::new(1.0, 0.0, scale.x - shift.x),
                DVec3::new(-1.0, 0.0, scale.x + shift.x),
                DVec3::new(0.0, 1.0, scale.y - shift.y),
                DVec3::new(0.0, -1.0, scale.y + shift.y),
            ],
            ..Self::WHOLE
        }
    }

    /// What a loupe shows (`inside`), larger by `magnify` about its centre, or leaves.
    fn loupe(inside: bool, comparison: &Comparison, aspect: f64) -> Self {
        let centre = DVec2::new(
            2.0 * comparison.centre.x - 1.0,
            1.0 - 2.0 * comparison.centre.y,
        );
        let radius = 2.0 * comparison.radius;
        let circle = |s: f64| DVec4::new(centre.x, centre.y, radius, s);
        if !inside {
            return Self {
                circle: circle(-1.0),
                ..Self::WHOLE
            };
        }
        // The square about it, which rasterisers can keep to.
        let [left, bottom] = [centre.x - radius / aspect, centre.y - radius];
        let [right, top] = [centre.x + radius / aspect, centre.y + radius];
        Self {
            scale: DVec2::splat(comparison.magnify),
            shift: centre * (1.0 - comparison.magnify),
            lines: [
                DVec3::new(1.0, 0.0, -left),
                DVec3::new(-1.0, 0.0, right),
                DVec3::new(0.0, 1.0, -bottom),
                DVec3::new(0.0, -1.0, top),
            ],
            circle: circle(1.0),
        }
    }
}

/// The way across a curtain, whose product with a place of the picture is in half heights, and the
/// largest such product.
fn across(angle: f64, aspect: f64) -> (DVec2, f64) {
    let across = DVec2::new(aspect * angle.cos(), angle.sin());
    (across, across.x.abs() + across.y.abs())
}

/// Where band `k` of `count` of a curtain begins.
fn edge(k: usize, count: usize, at: f64, reach: f64) -> f64 {
    let share = at + (k as f64 - 0.5 * count as f64) / count as f64;
    reach * (2.0 * share - 1.0)
}

/// The straight line where `across` · place = `at`, within the picture.
fn straight(across: DVec2, at: f64) -> Option<Vec<DVec2>> {
    let foot = across * at / across.length_squared();
    let along = across.perp().normalize();
    let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
    for (place, step) in [(foot.x, along.x), (foot.y, along.y)] {
        if step == 0.0 {
            if place.abs() > 1.0 {
                return None;
            }
            continue;
        }
        let ends = [(-1.0 - place) / step, (1.0 - place) / step];
        from = from.max(ends[0].min(ends[1]));
        to = to.min(ends[0].max(ends[1]));
    }
    (from < to).then(|| vec![foot + along * from, foot + along * to])
}

/// Rows and columns in which a part of the picture is looked for.
const LOOKS: usize = 24;

/// Straight pieces that make a circle round.
const ROUND: usize = 96;

/// How near to a curtain's edge it is taken by, in half heights of the picture.
const GRIP: f64 = 0.06;

impl Comparison {
    /// The same to the eye, with everything that its mode does not use as it is by itself.
    pub fn as_shown(&self) -> Self {
        let usual = Self::new(self.mode, self.of.clone());
        let Self {
            mode,
            at,
            angle,
            centre,
            radius,
            magnify,
            full_delta_e,
            full_luminance,
            coded,
            turn,
            of: _,
        } = *self;
        let usual = Self {
            coded,
            turn,
            ..usual
        };
        match mode {
            CompareMode::Curtain => Self { at, angle, ..usual },
            CompareMode::Blend | CompareMode::Glass => Self { at, ..usual },
            CompareMode::Loupe => Self {
                centre,
                radius,
                magnify,
                ..usual
            },
            CompareMode::Difference if full_luminance.is_some() => Self {
                full_luminance,
                ..usual
            },
            CompareMode::Difference => Self {
                full_delta_e,
                ..usual
            },
            CompareMode::SideBySide | CompareMode::Flicker => usual,
        }
    }

    /// Whether a hand at `ndc` takes its curtain or loupe, in a picture of `aspect`.
    pub fn is_taken_at(&self, ndc: DVec2, aspect: f64) -> bool {
        match self.mode {
            CompareMode::Curtain => {
                let (across, reach) = across(self.angle.radians(), aspect);
                let count = self.of.len();
                (1..count).any(|k| (across.dot(ndc) - edge(k, count, self.at, reach)).abs() <= GRIP)
            }
            CompareMode::Loupe => Part::loupe(true, self, aspect).shows(ndc, aspect),
            _ => false,
        }
    }

    /// The parts of members beside each other; none where they share one picture.
    pub fn cells(&self) -> Vec<Part> {
        let count = match self.mode {
            CompareMode::SideBySide => self.of.len(),
            _ => 0,
        };
        (0..count).map(|k| Part::cell(k, count)).collect()
    }

    /// Where members that have parts of a picture of `aspect` meet: lines through places of it, of a
    /// curtain straight ones, of a loupe a closed one around it.
    pub fn edges(&self, aspect: f64) -> Vec<Vec<DVec2>> {
        match self.mode {
            CompareMode::Curtain => {
                let (across, reach) = across(self.angle.radians(), aspect);
                let count = self.of.len();
                let line = |k| straight(across, edge(k, count, self.at, reach));
                (1..count).filter_map(line).collect()
            }
            CompareMode::Loupe => {
                let [x, y, radius, _] = Part::loupe(true, self, aspect).circle.to_array();
                let place = |k: usize| {
                    let angle = std::f64::consts::TAU * k as f64 / ROUND as f64;
                    DVec2::new(x + radius * angle.cos() / aspect, y + radius * angle.sin())
                };
                vec![(0..=ROUND).map(place).collect()]
            }
            _ => Vec::new(),
        }
    }

    /// Moves the curtain or loupe as far as a hand that holds it.
    pub fn drag(&mut self, from: DVec2, to: DVec2, aspect: f64) {
        match self.mode {
            CompareMode::Curtain => {
                let (across, reach) = across(self.angle.radians(), aspect);
                let by = across.dot(to - from) / (2.0 * reach);
                self.at = (self.at + by).clamp(0.0, 1.0);
            }
            CompareMode::Loupe => {
                let by = (to - from) * DVec2::new(0.5, -0.5);
                self.centre = (self.centre + by).clamp(DVec2::ZERO, DVec2::ONE);
            }
            _ => {}
        }
    }
}

impl Scene {
    /// The same to the eye, its comparison [as it is shown](Comparison::as_shown).
    pub fn as_shown(&self) -> Self {
        Self {
            compare: self.compare.as_ref().map(Comparison::as_shown),
            ..self.clone()
        }
    }
}

impl CompareMode {
    /// The word that manifests use.
    pub fn word(self) -> &'static str {
        let named = Self::WORDS.iter().find(|(_, mode)| *mode == self);
        named.map_or("", |(word, _)| word)
    }

    /// Whether each pixel is made of both members; otherwise it belongs to one.
    pub fn combines(self) -> bool {
        matches!(self, Self::Blend | Self::Difference | Self::Glass)
    }

    /// How many members it shows, at least and at most.
    pub fn members(self) -> [usize; 2] {
        match self {
            Self::Curtain | Self::Flicker => [2, 8],
            Self::SideBySide => [2, 4],
            Self::Blend | Self::Loupe | Self::Difference | Self::Glass => [2, 2],
        }
    }

    /// What is allowed, where `count` members are not.
    pub fn allowed_instead_of(self, count: usize) -> Option<String> {
        let [least, most] = self.members();
        let allowed = match least == most {
            true => format!("{least} for this mode"),
            false => format!("{least} to {most} for this mode"),
        };
        (!(least..=most).contains(&count)).then_some(allowed)
    }

    /// What is found and allowed, where it does not show these members against each other.
    pub fn refuses(self, of: &[Member]) -> Option<(String, String)> {
        let count = of.len();
        if let Some(allowed) = self.allowed_instead_of(count) {
            return Some((format!("{count} members"), allowed));
        }
        let is_side = |member: &Member| matches!(member, Member::Side(_));
        (self == Self::Glass && !of.iter().all(is_side)).then(|| {
            (
                "members that are not the two sides of the sheet".to_owned(),
                "side:recto and side:verso for glass".to_owned(),
            )
        })
    }
}

impl Exhibit {
    /// What a picture of `aspect` (width over height) of `scene` is made of: scenes without
    /// comparisons, each with its part. Members that are combined have all of it.
    pub fn parts(&self, scene: &Scene, aspect: f64) -> Vec<(Scene, Part)> {
        let Some(comparison) = &scene.compare else {
            return vec![(scene.clone(), Part::WHOLE)];
        };
        let members = self.members(scene);
        let count = members.len();
        let angle = comparison.angle.radians();
        let part = |k: usize| match comparison.mode {
            CompareMode::Curtain => Part::band(k, count, comparison.at, angle, aspect),
            CompareMode::SideBySide => Part::cell(k, count),
            CompareMode::Loupe => Part::loupe(k > 0, comparison, aspect),
            CompareMode::Flicker if k == comparison.turn % count => Part::ALL,
            CompareMode::Flicker => Part::NOTHING,
            CompareMode::Blend | CompareMode::Difference | CompareMode::Glass => Part::WHOLE,
        };
        let members = members.into_iter().enumerate();
        members.map(|(k, member)| (member, part(k))).collect()
    }

    /// The members of a scene's comparison as scenes of their own, in order: the scene with
    /// another state, side, overlay or drawing, under the same lamps and the same eye.
    pub fn members(&self, scene: &Scene) -> Vec<Scene> {
        let Some(comparison) = &scene.compare else {
            return Vec::new();
        };
        let members = comparison.of.iter().enumerate();
        let member = |(k, member): (usize, &Member)| {
            let mut shown = self.member(scene, *member);
            if comparison.mode == CompareMode::Glass && k > 0 {
                shown.camera.turn =
                    turn_from_behind(scene.camera.turn, &self.drawings[scene.drawing]);
            }
            shown
        };
        members.map(member).collect()
    }

    /// Width over height of what a scene's camera fills in a picture of `aspect`: of one of those beside
    /// each other its cell.
    pub fn own_aspect(&self, scene: &Scene, aspect: f64) -> f64 {
        let cells = scene.compare.as_ref().map(Comparison::cells);
        let cell = cells.and_then(|cells| cells.first().copied());
        cell.unwrap_or(Part::WHOLE).aspect(aspect)
    }

    /// All that a scene shows, as scenes without comparisons: its members, or itself.
    pub fn each_alone(&self, scene: &Scene) -> Vec<Scene> {
        match scene.compare {
            Some(_) => self.members(scene),
            None => vec![scene.clone()],
        }
    }

    /// The members that a scene without a comparison has to show against each other: its drawing's
    /// first two states, or its sides; none where there is nothing to compare.
    pub fn comparable(&self, scene: &Scene) -> Vec<Member> {
        let drawing = &self.drawings[scene.drawing];
        if drawing.states.len() >= 2 {
            return vec![Member::State(Some(0)), Member::State(Some(1))];
        }
        self.both_sides(scene)
    }

    /// The sides of a scene's drawing, that in view first; none where only one has maps.
    pub fn both_sides(&self, scene: &Scene) -> Vec<Member> {
        match self.drawings[scene.drawing].verso {
            Some(_) => vec![Member::Side(scene.side), Member::Side(scene.side.other())],
            None => Vec::new(),
        }
    }

    /// A member of a comparison of `drawing`, as manifests and options write it.
    pub fn written_member(&self, drawing: &Drawing, member: Member) -> String {
        match member {
            Member::State(Some(state)) => format!("state:{}", drawing.states[state].id),
            Member::State(None) => format!("state:{NO_STATE}"),
            Member::Side(side) => format!("side:{}", side.word()),
            // Also of a stack: STACK/700.
            Member::Overlay(overlay) => format!("overlay:{}", drawing.overlays[overlay].id),
            Member::Drawing(other) => format!("drawing:{}", self.drawings[other].id),
        }
    }

    fn member(&self, scene: &Scene, member: Member) -> Scene {
        let drawing = &self.drawings[scene.drawing];
        let mut shown = Scene {
            compare: None,
            ..scene.clone()
        };
        match member {
            Member::State(state) => shown.state = state,
            Member::Side(side) => turn(&mut shown, drawing, side),
            // On the side that it belongs to.
            Member::Overlay(overlay) => {
                turn(&mut shown, drawing, drawing.overlays[overlay].side);
                shown.overlays.retain(|(index, _)| *index != overlay);
                shown.overlays.push((overlay, 1.0));
            }
            // The middles of both sheets lie under the same place of the eye.
            Member::Drawing(other) => {
                let size_mm = self.drawings[other].size_mm;
                let offset = scene.camera.centre_mm - drawing.size_mm / 2.0;
                shown.drawing = other;
                shown.side = SideName::Recto;
                shown.state = None;
                shown.overlays.clear();
                shown.categories.clear();
                shown.camera = Camera {
                    centre_mm: size_mm / 2.0 + offset,
                    ..scene.camera
                };
            }
        }
        shown
    }
}

/// How the eye walks around a sheet whose picture, mirrored sideways, is that seen through glass.
fn turn_from_behind(turn: Degrees, drawing: &Drawing) -> Degrees {
    match drawing.flip {
        FlipAxis::Vertical => Degrees(-turn.0),
        FlipAxis::Horizontal => Degrees(180.0 - turn.0),
    }
}

/// Shows the same place of `side`, without what lies on the other.
fn turn(scene: &mut Scene, drawing: &Drawing, side: SideName) {
    if side == scene.side {
        return;
    }
    scene.side = side;
    let centre = scene.camera.centre_mm;
    scene.camera.centre_mm = frames::other_side(centre, drawing.size_mm, drawing.flip);
    scene.overlays.clear();
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The parts of `count` members cover each place of the picture once.
    fn divide(parts: &[Part], aspect: f64) {
        for i in 0..40 {
            for j in 0..40 {
                let at = |k: i32| (f64::from(k) + 0.37) / 20.0 - 1.0;
                let place = DVec2::new(at(i), at(j));
                let seen = parts.iter().filter(|part| part.shows(place, aspect));
                assert_eq!(seen.count(), 1, "{place}");
            }
        }
    }

    #[test]
    fn members_meet_where_one_ends_and_the_next_begins() {
        const NEAR: f64 = 1e-6;
        let curtain = Comparison {
            at: 0.6,
            angle: Degrees(25.0),
            ..Comparison::new(CompareMode::Curtain, vec![Member::State(Some(0)); 3])
        };
        let loupe = Comparison::new(CompareMode::Loupe, vec![Member::State(Some(0)); 2]);
        for comparison in [curtain, loupe] {
            let aspect = 1.6;
            let parts: Vec<Part> = match comparison.mode {
                CompareMode::Curtain => {
                    let angle = comparison.angle.radians();
                    let band = |k| Part::band(k, 3, comparison.at, angle, aspect);
                    (0..3).map(band).collect()
                }
                _ => [false, true]
                    .map(|inside| Part::loupe(inside, &comparison, aspect))
                    .into(),
            };
            let edges = comparison.edges(aspect);
            assert_eq!(edges.len(), parts.len() - 1);
            for pair in edges.iter().flat_map(|edge| edge.windows(2)) {
                let [from, to] = [pair[0], pair[1]];
                assert!(from.abs().max_element() <= 1.0 + NEAR, "{from}");
                let beside = (to - from).perp().normalize() * 1e-3;
                let whose = |at: DVec2| parts.iter().position(|part| part.shows(at, aspect));
                let [left, right] = [from + beside, from - beside].map(whose);
                assert!(left != right, "{from}");
            }
        }
        let aside = Comparison::new(CompareMode::SideBySide, vec![Member::State(Some(0)); 2]);
        assert!(aside.edges(1.6).is_empty());
    }

    #[test]
    fn a_name_lies_on_its_member() {
        let names = |parts: &[Part]| -> Vec<DVec2> {
            let place = |part: &Part| part.top(1.6).expect("a place");
            parts.iter().map(place).collect()
        };
        let cells: Vec<Part> = (0..4).map(|k| Part::cell(k, 4)).collect();
        for (part, at) in cells.iter().zip(names(&cells)) {
            assert!(part.shows(at, 1.6), "{at}");
        }
        // Not where the loupe is.
        let comparison = Comparison {
            centre: DVec2::new(0.5, 0.1),
            radius: 0.3,
            ..Comparison::new(CompareMode::Loupe, Vec::new())
        };
        let loupe = [false, true].map(|inside| Part::loupe(inside, &comparison, 1.6));
        let [outside, inside] = names(&loupe)[..] else {
            panic!("two names")
        };
        assert!(
            inside.x.abs() < 0.1 && outside.x.abs() > 0.5,
            "{inside} {outside}"
        );
        assert_eq!(Part::NOTHING.top(1.6), None);
    }

    #[test]
    fn every_place_belongs_to_one_member() {
        for count in 2..=8 {
            for angle in [0.0, 0.7, 1.57, 3.0, -2.0] {
                let band = |k| Part::band(k, count, 0.45, angle, 1.6);
                divide(&(0..count).map(band).collect::<Vec<_>>(), 1.6);
            }
        }
        for count in 2..=4 {
            let cell = |k| Part::cell(k, count);
            divide(&(0..count).map(cell).collect::<Vec<_>>(), 1.6);
        }
        let comparison = Comparison {
            centre: DVec2::new(0.3, 0.6),
            radius: 0.2,
            magnify: 3.0,
            ..Comparison::new(CompareMode::Loupe, Vec::new())
        };
        let loupe = [false, true].map(|inside| Part::loupe(inside, &comparison, 1.6));
        divide(&loupe, 1.6);
        // The place under the middle of the loupe stays there.
        let own = DVec2::new(-0.4, -0.2);
        let seen = own * loupe[1].scale + loupe[1].shift;
        assert!((seen - own).length() < 1e-12);
    }

    #[test]
    fn a_curtain_begins_on_the_left_and_divides_where_it_is_drawn_to() {
        let [left, right] = [0, 1].map(|k| Part::band(k, 2, 0.25, 0.0, 1.6));
        assert!(
            left.shows(DVec2::new(-0.51, 0.9), 1.6) && right.shows(DVec2::new(-0.49, 0.9), 1.6)
        );
        assert!(left.is_cut() && !Part::WHOLE.is_cut());
    }

    #[test]
    fn a_hand_takes_a_curtain_by_its_edge_and_it_stays_under_the_hand() {
        let mut curtain = Comparison {
            at: 0.3,
            angle: Degrees(30.0),
            of: vec![Member::State(Some(0)), Member::State(Some(1))],
            ..Comparison::new(CompareMode::Curtain, Vec::new())
        };
        let (across, reach) = across(curtain.angle.radians(), 1.6);
        let at = across * (edge(1, 2, 0.3, reach) / across.length_squared());
        assert!(curtain.is_taken_at(at, 1.6));
        assert!(!curtain.is_taken_at(at + across * 0.2, 1.6));
        let to = at + DVec2::new(0.2, -0.1);
        curtain.drag(at, to, 1.6);
        assert!(curtain.is_taken_at(to, 1.6) && !curtain.is_taken_at(at, 1.6));
        let mut loupe = Comparison::new(CompareMode::Loupe, Vec::new());
        loupe.drag(DVec2::ZERO, DVec2::new(0.5, 0.5), 1.6);
        assert!(loupe.is_taken_at(DVec2::new(0.5, 0.5), 1.6));
        assert!(!loupe.is_taken_at(DVec2::new(-0.5, -0.5), 1.6));
    }

    #[test]
    fn a_cell_s_own_picture_fills_it() {
        let cell = Part::cell(2, 4);
        let corner = |x: f64, y: f64| DVec2::new(x, y) * cell.scale + cell.shift;
        assert_eq!(corner(-1.0, -1.0), DVec2::new(-1.0, -1.0));
        assert_eq!(corner(1.0, 1.0), DVec2::ZERO);
        assert_eq!(Part::cell(0, 2).aspect(1.6), 0.8);
    }
}
