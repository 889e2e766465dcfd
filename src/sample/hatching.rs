//! Hatching: patches of parallel strokes that follow a form, laid until a place is as dark as
//! it should be.

use glam::Vec2;

use super::{
    grid::{Grid, Plane},
    hand::{Hand, Pen},
};

/// Form and light as a draughtsman sees them, at places of the sheet in mm.
pub trait Form {
    /// Darkness wanted, 0…1 (share of the paper under ink).
    fn tone(&self, at: Vec2) -> f32;
    /// Direction in which strokes run here; `None` where nothing is drawn.
    fn direction(&self, at: Vec2) -> Option<Vec2>;
    /// Whether a stroke may pass from one place to the next (no contour between them).
    fn continues(&self, from: Vec2, to: Vec2) -> bool;
    /// The pen for this place.
    fn pen(&self, at: Vec2) -> Pen;
    /// Length of a stroke here in mm.
    fn length_mm(&self, at: Vec2) -> f32;
}

/// One pass of hatching over a sheet.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    /// Turned against the form's own direction, in radians.
    pub turn: f32,
    /// Tone below which the pass leaves the paper alone.
    pub from_tone: f32,
    /// Share of the wanted tone that this pass lays.
    pub share: f32,
    /// Distance between the places where patches begin, in mm.
    pub patch_mm: f32,
    /// Most strokes in one patch.
    pub strokes: usize,
    /// Whether all strokes of a patch keep the direction of its middle.
    pub parallel: bool,
}

/// Samples per mm of the record of what has been laid.
const RECORD_PER_MM: f32 = 2.0;
/// Steps along a stroke, in mm.
const STEP_MM: f32 = 0.3;
/// Least and greatest distance between strokes, in widths of the pen.
const CLOSEST: f32 = 1.7;
const WIDEST: f32 = 6.5;

/// Lays hatching and remembers how dark it has become.
pub struct Hatcher {
    laid: Plane,
}

impl Hatcher {
    /// Nothing laid yet on a sheet of this size.
    pub fn new(size_mm: Vec2) -> Self {
        let (w, h) = (size_mm.x * RECORD_PER_MM, size_mm.y * RECORD_PER_MM);
        Self {
            laid: Plane::filled(Grid::with_pixels(size_mm, w as usize, h as usize), 0.0),
        }
    }

    /// Hatches everything between two corners, in patches taken in random order.
    pub fn pass(&mut self, hand: &mut Hand, form: &impl Form, low: Vec2, high: Vec2, pass: Pass) {
        let (columns, rows) = (
            ((high.x - low.x) / pass.patch_mm).ceil() as usize,
            ((high.y - low.y) / pass.patch_mm).ceil() as usize,
        );
        let mut order: Vec<usize> = (0..columns * rows).collect();
        hand.chance.shuffle(&mut order);
        for i in order {
            let jitter = Vec2::new(hand.chance.unit(), hand.chance.unit());
            let cell = Vec2::new((i % columns) as f32, (i / columns) as f32);
            self.patch(hand, form, low + (cell + jitter) * pass.patch_mm, pass);
        }
    }

    fn wanting(&self, form: &impl Form, at: Vec2, pass: Pass) -> f32 {
        let tone = form.tone(at);
        if tone < pass.from_tone {
            0.0
        } else {
            tone * pass.share - self.laid.nearest(at)
        }
    }

    fn patch(&mut self, hand: &mut Hand, form: &impl Form, seed: Vec2, pass: Pass) {
        let wanting = self.wanting(form, seed, pass);
        let Some(direction) = form.direction(seed) else {
            return;
        };
        if wanting < 0.035 {
            return;
        }
        let pen = form.pen(seed);
        let spacing = pen.width_mm * (0.9 / wanting).clamp(CLOSEST, WIDEST);
        let turn = Vec2::from_angle(pass.turn + 0.10 * hand.chance.centred());
        let held = turn.rotate(direction);
        let length = form.length_mm(seed) * hand.chance.between(0.75, 1.25);
        let bend = hand.chance.between(-0.05, 0.05);
        for side in [1.0, -1.0] {
            let mut start = seed;
            for k in 0..pass.strokes / 2 {
                if k > 0 || side < 0.0 {
                    let across = self.heading(form, start, held, turn, pass).perp() * side;
                    let next = start + across * spacing * hand.chance.between(0.8, 1.2);
                    if !form.continues(start, next) || self.wanting(form, next, pass) < 0.03 {
                        break;
                    }
                    start = next;
                }
                let reach = length * hand.chance.between(0.8, 1.1);
                let path = self.trace(form, start, held, turn, reach, bend, pass);
                if path.len() as f32 * STEP_MM > 0.25 * length {
                    self.record(&path, pen.width_mm);
                    hand.line(pen, &path);
                }
            }
        }
    }

    fn heading(&self, form: &impl Form, at: Vec2, held: Vec2, turn: Vec2, pass: Pass) -> Vec2 {
        if pass.parallel {
            return held;
        }
        let Some(own) = form.direction(at) else {
            return held;
        };
        let own = turn.rotate(own);
        let own = if own.dot(held) < 0.0 { -own } else { own };
        (own * 0.7 + held * 0.3).normalize_or(held)
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "one stroke is all of these together"
    )]
    fn trace(
        &self,
        form: &impl Form,
        start: Vec2,
        held: Vec2,
        turn: Vec2,
        length_mm: f32,
        bend: f32,
        pass: Pass,
    ) -> Vec<Vec2> {
        let mut path = vec![start];
        for way in [-1.0, 1.0] {
            let mut at = start;
            let mut heading = held * way;
            for _ in 0..(0.5 * length_mm / STEP_MM) as usize {
                let towards = self.heading(form, at, heading, turn, pass);
                heading = Vec2::from_angle(bend * way * STEP_MM)
                    .rotate(heading * 0.6 + towards * 0.4)
                    .normalize_or(heading);
                let next = at + heading * STEP_MM;
                if !form.continues(at, next) || form.tone(next) < 0.8 * pass.from_tone {
                    break;
                }
                path.push(next);
                at = next;
            }
            if way < 0.0 {
                path.reverse();
            }
        }
        path
    }

    fn record(&mut self, path: &[Vec2], width_mm: f32) {
        let share = width_mm * STEP_MM * RECORD_PER_MM * RECORD_PER_MM;
        for &p in path {
            let i = self.laid.index(p);
            let width = self.laid.grid.width;
            // Spread over the neighbours, since a stroke serves a wider place than its own.
            for (offset, weight) in [
                (0isize, 0.4),
                (1, 0.15),
                (-1, 0.15),
                (width as isize, 0.15),
                (-(width as isize), 0.15),
            ] {
                if let Some(cell) = self.laid.data.get_mut((i as isize + offset) as usize) {
                    *cell += share * weight;
                }
            }
        }
    }
}
