//! The hand that draws: paths become strokes with pressure, tremor, tapering ends, pooled ink
//! and a pen that runs dry and is dipped again.

use glam::Vec2;

use super::{
    noise::{Chance, mix, smoothstep},
    stroke::{Knot, Layer, Stroke},
};

/// Distance between knots, in mm: below the curvature of anything drawn.
const STEP_MM: f32 = 0.22;
/// Length of line that one dip of the pen lasts, in mm.
const DIP_MM: f32 = 260.0;
/// Share of the ink that is left on the pen just before it is dipped again.
const DRY_PEN: f32 = 0.68;
/// How far from the ends of a stroke ink pools, in mm.
const POOL_MM: f32 = 0.45;
/// How much denser ink stands where the pen is set down.
const POOL_GAIN: f32 = 0.35;

/// A tool and how it is held.
#[derive(Clone, Copy, Debug)]
pub struct Pen {
    /// What it leaves behind.
    pub layer: Layer,
    /// Full width of the line at normal pressure, in mm.
    pub width_mm: f32,
    /// Optical depth of the line.
    pub tau: f32,
    /// Relative width at the first and the last knot.
    pub ends: (f32, f32),
    /// Amplitude of the tremor, in mm.
    pub tremor_mm: f32,
}

impl Pen {
    /// A quill that is set down firmly and lifted in motion.
    pub const fn quill(layer: Layer, width_mm: f32, tau: f32) -> Self {
        Self {
            layer,
            width_mm,
            tau,
            ends: (0.85, 0.35),
            tremor_mm: 0.05,
        }
    }

    /// The same pen with these relative widths at its ends.
    pub const fn with_ends(self, start: f32, end: f32) -> Self {
        Self {
            ends: (start, end),
            ..self
        }
    }

    /// The same pen, wider or finer.
    pub fn scaled(self, factor: f32) -> Self {
        Self {
            width_mm: self.width_mm * factor,
            ..self
        }
    }

    /// The same pen with a steadier or looser hand.
    pub const fn with_tremor(self, tremor_mm: f32) -> Self {
        Self { tremor_mm, ..self }
    }

    /// The same pen with paler or darker ink.
    pub fn inked(self, factor: f32) -> Self {
        Self {
            tau: self.tau * factor,
            ..self
        }
    }
}

/// Draws strokes one after the other.
pub struct Hand {
    /// Everything drawn so far.
    pub strokes: Vec<Stroke>,
    /// The hand's irregularity.
    pub chance: Chance,
    since_dip_mm: f32,
}

impl Hand {
    /// A hand with its own irregularity.
    pub fn new(seed: u64) -> Self {
        Self {
            strokes: Vec::new(),
            chance: Chance::new(seed),
            since_dip_mm: 0.0,
        }
    }

    /// Draws a line through the points of a path, straight between them.
    pub fn line(&mut self, pen: Pen, path: &[Vec2]) {
        let points = resampled(path, STEP_MM);
        if points.len() < 2 {
            return;
        }
        let length = (points.len() - 1) as f32 * STEP_MM;
        let ink = mix(1.0, DRY_PEN, (self.since_dip_mm / DIP_MM).min(1.0));
        self.since_dip_mm += length;
        if self.since_dip_mm > DIP_MM {
            self.since_dip_mm = 0.0;
        }
        let phase = self.chance.between(0.0, 100.0);
        let firmness = self.chance.between(0.88, 1.12);
        let last = points.len() - 1;
        let ramp = (0.35 * length).min(2.5);
        let is_ink = matches!(pen.layer, Layer::PaleInk | Layer::DarkInk);
        let knots = points.iter().enumerate().map(|(i, &p)| {
            let s = i as f32 * STEP_MM;
            let rest = (last - i) as f32 * STEP_MM;
            let normal = (points[(i + 1).min(last)] - points[i.saturating_sub(1)])
                .normalize_or_zero()
                .perp();
            let tremor = wave(phase + s / 1.9) * 0.6 + wave(2.0 * phase + s / 5.3);
            let pressure = firmness
                * (1.0 + 0.12 * wave(phase + s / 3.1))
                * mix(pen.ends.0, 1.0, smoothstep(0.0, ramp, s))
                * mix(pen.ends.1, 1.0, smoothstep(0.0, ramp, rest));
            let pool = if is_ink {
                POOL_GAIN * (1.0 - smoothstep(0.0, POOL_MM, s))
            } else {
                0.0
            };
            Knot {
                at: p + normal * tremor * pen.tremor_mm,
                radius_mm: 0.5 * pen.width_mm * pressure,
                tau: pen.tau * ink * (0.9 + 0.15 * wave(3.0 * phase + s / 2.3) + pool),
            }
        });
        let knots = knots.collect();
        self.strokes.push(Stroke {
            layer: pen.layer,
            knots,
        });
    }

    /// Draws a smooth curve through the points.
    pub fn curve(&mut self, pen: Pen, through: &[Vec2]) {
        self.line(pen, &smooth(through));
    }

    /// Loops along a path without lifting the pen, as foliage and curls are drawn: a circle of
    /// `radius_mm` that advances by `advance_mm` per turn.
    pub fn loops(&mut self, pen: Pen, path: &[Vec2], radius_mm: f32, advance_mm: f32) {
        let spine = resampled(&smooth(path), 0.1);
        let mut angle = self.chance.between(0.0, 6.0);
        let mut size = 1.0;
        let mut points = Vec::with_capacity(spine.len() * 4);
        let per_step = std::f32::consts::TAU * 0.1 / advance_mm.max(0.05);
        for pair in spine.windows(2) {
            let parts = (per_step / 0.5).ceil().max(1.0) as usize;
            for part in 0..parts {
                angle += per_step / parts as f32;
                size += 0.12 * self.chance.centred();
                size = size.clamp(0.55, 1.5);
                let centre = pair[0].lerp(pair[1], part as f32 / parts as f32);
                points.push(centre + Vec2::from_angle(angle) * radius_mm * size);
            }
        }
        self.curve(pen, &points);
    }
}

/// A smooth periodic wobble in −1…1 without a visible period.
fn wave(x: f32) -> f32 {
    0.5 * ((x * 2.1).sin() + (x * 3.37 + 1.3).sin())
}

/// Points at equal steps along a path; the last step is stretched to meet its end.
pub fn resampled(path: &[Vec2], step_mm: f32) -> Vec<Vec2> {
    let length: f32 = path.windows(2).map(|p| p[0].distance(p[1])).sum();
    if path.len() < 2 || length < 1e-3 {
        return Vec::new();
    }
    let count = (length / step_mm).ceil().max(1.0);
    let step = length / count;
    let mut out = vec![path[0]];
    let mut next = step;
    let mut walked = 0.0;
    for pair in path.windows(2) {
        let piece = pair[0].distance(pair[1]);
        while next <= walked + piece && out.len() < count as usize {
            out.push(pair[0].lerp(pair[1], (next - walked) / piece.max(1e-9)));
            next += step;
        }
        walked += piece;
    }
    out.push(path[path.len() - 1]);
    out
}

/// A Catmull-Rom curve through the points, as a fine polyline.
pub fn smooth(points: &[Vec2]) -> Vec<Vec2> {
    if points.len() < 3 {
        return points.to_vec();
    }
    let mut out = Vec::new();
    let last = points.len() - 1;
    for i in 0..last {
        let (p0, p1) = (points[i.saturating_sub(1)], points[i]);
        let (p2, p3) = (points[i + 1], points[(i + 2).min(last)]);
        let parts = (p1.distance(p2) / STEP_MM).ceil().clamp(2.0, 40.0) as usize;
        for part in 0..parts {
            let t = part as f32 / parts as f32;
            out.push(
                0.5 * (2.0 * p1
                    + (p2 - p0) * t
                    + (2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3) * t * t
                    + (3.0 * p1 - p0 - 3.0 * p2 + p3) * t * t * t),
            );
        }
    }
    out.push(points[last]);
    out
}

/// The points of an ellipse's arc, from angle to angle in radians (y down: clockwise).
pub fn arc(centre: Vec2, radii: Vec2, from: f32, to: f32) -> Vec<Vec2> {
    let parts = ((to - from).abs() * radii.max_element() / STEP_MM)
        .ceil()
        .clamp(4.0, 400.0);
    (0..=parts as usize)
        .map(|i| centre + radii * Vec2::from_angle(mix(from, to, i as f32 / parts)))
        .collect()
}

/// Whether a point lies inside a closed polygon.
pub fn inside(polygon: &[Vec2], p: Vec2) -> bool {
    let mut odd = false;
    let mut b = polygon[polygon.len() - 1];
    for &a in polygon {
        if (a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x {
            odd = !odd;
        }
        b = a;
    }
    odd
}
