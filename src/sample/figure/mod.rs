//! A standing draped figure in red chalk: modelled as a body under cloth, lit, and drawn.

mod model;

use glam::{Vec2, Vec3};

use super::{
    contour,
    grid::{Grid, Plane},
    hand::{Hand, Pen, arc, smooth},
    hatching::{Form, Hatcher, Pass},
    noise::{mix, smoothstep},
    stroke::Layer,
};
use model::Model;

/// Space around the figure on the sheet: half its width and the room above the head, in mm.
const HALF_WIDTH_MM: f32 = 48.0;
const ABOVE_MM: f32 = 6.0;
const FIELD_MM: Vec2 = Vec2::new(2.0 * HALF_WIDTH_MM, 180.0);
/// Samples per mm, and the plane where rays start and end, in mm.
const PER_MM: f32 = 3.0;
const FRONT_MM: f32 = 60.0;
const BACK_MM: f32 = -50.0;
/// Distance of the eye, only to order depths, in mm.
const EYE_MM: f32 = 400.0;
/// Light from the upper left.
const LIGHT: Vec3 = Vec3::new(-0.62, -0.50, 0.60);
/// Direction of the chalk's hatching on the sheet: falling to the right, as a left hand draws.
const HATCH_ANGLE: f32 = 0.92;

const CHALK: Pen = Pen {
    layer: Layer::Chalk,
    width_mm: 0.62,
    tau: 0.34,
    ends: (0.6, 0.35),
    tremor_mm: 0.06,
};

/// Draws the figure with the crown of its head at a place of the sheet; returns the soft tone of
/// rubbed chalk, 0…1, over the sheet.
pub fn draw(hand: &mut Hand, size_mm: Vec2, head: Vec2) -> Plane {
    let model = Model::new();
    let origin = head - Vec2::new(HALF_WIDTH_MM, ABOVE_MM);
    let figure = Figure::look(&model, origin);
    first_lines(hand, head);
    outlines(hand, &figure);
    let mut hatcher = Hatcher::new(size_mm);
    let (low, high) = (origin, origin + FIELD_MM);
    let pass = Pass {
        turn: 0.0,
        from_tone: 0.19,
        share: 0.72,
        patch_mm: 2.4,
        strokes: 22,
        parallel: true,
    };
    hatcher.pass(hand, &Parallel(&figure), low, high, pass);
    let around = Pass {
        from_tone: 0.50,
        share: 1.0,
        strokes: 12,
        parallel: false,
        ..pass
    };
    hatcher.pass(hand, &Around(&figure), low, high, around);
    let dark = Pass {
        turn: -0.3,
        from_tone: 0.68,
        share: 1.35,
        patch_mm: 2.0,
        ..pass
    };
    hatcher.pass(hand, &Parallel(&figure), low, high, dark);
    face(hand, head);
    ground(hand, head);
    let grid = Grid::with_pixels(
        size_mm,
        (2.0 * size_mm.x) as usize,
        (2.0 * size_mm.y) as usize,
    );
    Plane::from_fn(grid, |p| figure.tone(p)).blurred(1.1)
}

/// The figure as it appears on the sheet.
struct Figure {
    origin: Vec2,
    /// Distance of the eye in mm, ∞ beside the figure.
    distance: Plane,
    tone: Plane,
    /// Angle of the direction across the form, in radians.
    across: Plane,
}

impl Figure {
    fn look(model: &Model, origin: Vec2) -> Self {
        let (w, h) = (
            (FIELD_MM.x * PER_MM) as usize,
            (FIELD_MM.y * PER_MM) as usize,
        );
        let grid = Grid::with_pixels(FIELD_MM, w, h);
        let seen = grid.map(|p| {
            let start = (p - Vec2::new(HALF_WIDTH_MM, ABOVE_MM)).extend(FRONT_MM);
            let mut q = start;
            for _ in 0..140 {
                let d = model.distance(q);
                if d < 0.03 {
                    return Self::light(model, q);
                }
                q.z -= (0.8 * d).max(0.02);
                if q.z < BACK_MM {
                    break;
                }
            }
            (f32::INFINITY, 0.0, 0.0)
        });
        let plane = |pick: fn(&(f32, f32, f32)) -> f32| Plane {
            grid,
            data: seen.iter().map(pick).collect(),
        };
        let (distance, tone, across) = (plane(|s| s.0), plane(|s| s.1), plane(|s| s.2));
        Self {
            origin,
            distance,
            tone,
            across,
        }
    }

    fn light(model: &Model, q: Vec3) -> (f32, f32, f32) {
        let normal = model.normal(q);
        let light = LIGHT.normalize();
        // Cloth in a hollow is darker: how far the surface is from where it would be if convex.
        let hollow: f32 = (1..=3)
            .map(|i| {
                let step = 2.2 * i as f32;
                (step - model.distance(q + normal * step)).max(0.0) / step
            })
            .sum::<f32>()
            / 3.0;
        let cast = (1..=10)
            .map(|i| {
                let step = 2.0 * i as f32;
                model.distance(q + normal * 0.8 + light * step) / step
            })
            .fold(1.0f32, f32::min);
        let shadow = smoothstep(0.12, -0.02, cast);
        let lambert = normal.dot(light);
        let dark = smoothstep(0.78, -0.35, lambert).max(0.72 * shadow) * 0.86 + 0.75 * hollow;
        let flat = Vec2::new(normal.x, normal.y);
        (EYE_MM - q.z, dark.min(1.15), flat.y.atan2(flat.x))
    }

    fn at(&self, sheet: Vec2) -> Option<Vec2> {
        let p = sheet - self.origin;
        let inside = p.cmpge(Vec2::ZERO).all() && p.cmplt(FIELD_MM).all();
        (inside && self.distance.nearest(p).is_finite()).then_some(p)
    }

    fn tone(&self, sheet: Vec2) -> f32 {
        self.at(sheet).map_or(0.0, |p| self.tone.nearest(p))
    }

    fn continues(&self, from: Vec2, to: Vec2) -> bool {
        match (self.at(from), self.at(to)) {
            (Some(a), Some(b)) => (self.distance.nearest(a) - self.distance.nearest(b)).abs() < 2.6,
            _ => false,
        }
    }
}

/// Slanted hatching that ignores the form.
struct Parallel<'a>(&'a Figure);

impl Form for Parallel<'_> {
    fn tone(&self, at: Vec2) -> f32 {
        self.0.tone(at)
    }

    fn direction(&self, at: Vec2) -> Option<Vec2> {
        self.0.at(at).map(|_| Vec2::from_angle(HATCH_ANGLE))
    }

    fn continues(&self, from: Vec2, to: Vec2) -> bool {
        self.0.continues(from, to)
    }

    fn pen(&self, at: Vec2) -> Pen {
        CHALK.inked(0.75 + 0.6 * self.0.tone(at)).scaled(0.9)
    }

    fn length_mm(&self, _: Vec2) -> f32 {
        7.0
    }
}

/// Hatching that runs around the form.
struct Around<'a>(&'a Figure);

impl Form for Around<'_> {
    fn tone(&self, at: Vec2) -> f32 {
        self.0.tone(at)
    }

    fn direction(&self, at: Vec2) -> Option<Vec2> {
        self.0
            .at(at)
            .map(|p| Vec2::from_angle(self.0.across.nearest(p)))
    }

    fn continues(&self, from: Vec2, to: Vec2) -> bool {
        self.0.continues(from, to)
    }

    fn pen(&self, at: Vec2) -> Pen {
        CHALK.inked(0.8 + 0.6 * self.0.tone(at)).scaled(0.8)
    }

    fn length_mm(&self, _: Vec2) -> f32 {
        3.4
    }
}

/// Searching first lines: the axis of the stance, shoulders and hips, ovals.
fn first_lines(hand: &mut Hand, head: Vec2) {
    let pen = CHALK.scaled(0.6).inked(0.5);
    let at = |x: f32, y: f32| head + Vec2::new(x, y);
    hand.curve(
        pen,
        &[
            at(1.0, -4.0),
            at(3.0, 30.0),
            at(-2.0, 80.0),
            at(-9.0, 122.0),
            at(-9.0, 168.0),
        ],
    );
    hand.line(pen, &[at(-25.0, 38.0), at(29.0, 30.0)]);
    hand.line(pen, &[at(-24.0, 78.0), at(26.0, 88.0)]);
    hand.line(pen, &arc(at(0.5, 10.5), Vec2::new(9.5, 12.0), 0.0, 7.0));
    hand.curve(pen, &[at(17.0, 86.0), at(24.0, 120.0), at(21.0, 168.0)]);
    hand.curve(
        pen,
        &[
            at(-26.0, 42.0),
            at(-33.0, 62.0),
            at(-20.0, 56.0),
            at(-10.0, 50.0),
        ],
    );
}

/// Contours, heavier on the side that the light does not reach, restated here and there.
fn outlines(hand: &mut Hand, figure: &Figure) {
    for contour in contour::trace(&figure.distance, |near, far| far - near > 2.4) {
        let last = contour.points.last().copied();
        let sparse = contour.points.iter().copied().step_by(7).chain(last);
        let sparse: Vec<Vec2> = sparse.map(|p| p + figure.origin).collect();
        let points = smooth(&sparse);
        for piece in points.chunks(60) {
            if piece.len() < 5 {
                continue;
            }
            let dark = piece.iter().map(|&p| figure.tone(p)).sum::<f32>() / piece.len() as f32;
            let pen = CHALK
                .scaled(mix(0.75, 1.15, dark))
                .inked(mix(1.2, 2.2, dark));
            hand.line(pen.with_ends(0.7, 0.5), piece);
            if hand.chance.happens(0.35) {
                let shift = Vec2::new(hand.chance.centred(), hand.chance.centred()) * 0.6;
                let again: Vec<Vec2> = piece.iter().map(|&p| p + shift).collect();
                hand.line(pen.scaled(0.7).inked(0.5).with_ends(0.3, 0.2), &again);
            }
        }
    }
}

/// A bowed head, turned to the left: brow, lids, nose, mouth, ear, and hair in strands.
fn face(hand: &mut Hand, head: Vec2) {
    let pen = CHALK.scaled(0.62).inked(2.0);
    let at = |x: f32, y: f32| head + Vec2::new(x, y);
    hand.curve(pen, &[at(-6.1, 10.3), at(-5.1, 9.7), at(-3.9, 10.1)]);
    hand.curve(pen, &[at(-2.3, 10.2), at(-0.6, 9.4), at(1.5, 10.2)]);
    hand.curve(
        pen.inked(1.15),
        &[at(-6.0, 11.9), at(-5.2, 12.4), at(-4.4, 12.1)],
    );
    hand.curve(
        pen.inked(1.15),
        &[at(-1.9, 12.2), at(-0.6, 12.9), at(0.8, 12.1)],
    );
    hand.curve(
        pen,
        &[
            at(-3.4, 10.4),
            at(-4.4, 13.2),
            at(-4.9, 14.9),
            at(-3.9, 15.4),
            at(-3.1, 15.0),
        ],
    );
    hand.curve(
        pen,
        &[
            at(-4.9, 17.2),
            at(-3.8, 16.9),
            at(-2.9, 17.2),
            at(-1.5, 17.1),
        ],
    );
    hand.curve(
        pen.inked(0.6),
        &[at(-4.2, 18.6), at(-3.3, 18.9), at(-2.2, 18.5)],
    );
    hand.curve(
        pen,
        &[
            at(4.6, 11.4),
            at(5.9, 10.8),
            at(6.1, 12.8),
            at(5.0, 14.3),
            at(4.6, 13.0),
        ],
    );
    for i in 0..26 {
        let t = i as f32 / 25.0;
        let root = at(-4.5 + 4.5 * t, 4.8 - 4.2 * t);
        let mid = at(2.5 + 6.0 * t, 5.2 - 3.0 * t + 2.0 * hand.chance.centred());
        let end = at(8.5 + 4.0 * t, 13.0 - 4.0 * t + 2.0 * hand.chance.centred());
        hand.curve(CHALK.scaled(0.5).inked(1.25), &[root, mid, end]);
    }
    let knot = arc(at(9.8, 13.0), Vec2::new(4.0, 3.4), 0.0, 9.0);
    hand.loops(CHALK.scaled(0.5).inked(1.2), &knot, 1.1, 2.2);
}

/// The ground and the shadow that the figure throws to the right.
fn ground(hand: &mut Hand, head: Vec2) {
    let foot = head + Vec2::new(2.0, 165.0);
    for i in 0..34 {
        let t = i as f32 / 33.0;
        let from = foot + Vec2::new(-14.0 + 40.0 * t + hand.chance.centred(), -1.5 + 2.5 * t);
        let reach = mix(14.0, 20.0, t) * hand.chance.between(0.6, 1.1);
        let pen = CHALK.inked(mix(1.0, 0.5, t)).with_ends(0.8, 0.2);
        hand.line(pen, &[from, from + Vec2::from_angle(0.18) * reach]);
    }
}
