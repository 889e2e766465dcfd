//! What was on the sheet before the pen: lead-point construction and first ideas that were not
//! followed, and lines of a blind stylus.

use glam::{Vec2, Vec3};

use super::{
    terrain::{BRIDGE_M, TOWN_M, UPPER_WATER_M},
    view::{VANISHING_MM, View, project},
};
use crate::sample::{
    hand::{Hand, Pen, arc},
    stroke::Layer,
};

const LEAD: Pen = Pen {
    layer: Layer::Lead,
    width_mm: 0.28,
    tau: 0.34,
    ends: (0.5, 0.35),
    tremor_mm: 0.07,
};
const STYLUS: Pen = Pen {
    layer: Layer::Stylus,
    width_mm: 0.24,
    tau: 1.0,
    ends: (0.9, 0.6),
    tremor_mm: 0.02,
};

/// Lead point under the pen.
pub fn lead(hand: &mut Hand, view: &View, size_mm: Vec2) {
    // Horizon and the lines to the vanishing point.
    let horizon = VANISHING_MM.y + 0.4;
    hand.line(
        LEAD,
        &[
            Vec2::new(4.0, horizon),
            Vec2::new(size_mm.x - 6.0, horizon - 0.3),
        ],
    );
    for angle in [0.18f32, 0.42, 0.75, 1.25, 1.9, 2.35, 2.72, 2.95] {
        let ray = Vec2::from_angle(angle);
        let (from, to) = (
            hand.chance.between(12.0, 25.0),
            hand.chance.between(70.0, 125.0),
        );
        hand.line(
            LEAD.inked(0.75),
            &[VANISHING_MM + ray * from, VANISHING_MM + ray * to],
        );
    }
    first_hill(hand);
    first_bridge(hand);
    searching(hand, view, size_mm);
}

/// The town was first meant to stand farther left and lower, with one round tower.
fn first_hill(hand: &mut Hand) {
    let foot = project(TOWN_M) + Vec2::new(-46.0, 8.0);
    for (dx, dy, tau) in [(0.0, 0.0, 1.0f32), (1.1, -0.9, 0.8), (-0.8, 0.7, 0.6)] {
        let d = Vec2::new(dx, dy);
        let hill: Vec<Vec2> = [
            [-34.0, 24.0],
            [-22.0, 15.0],
            [-12.0, 4.0],
            [-3.0, 0.0],
            [8.0, 1.0],
            [17.0, 9.0],
            [27.0, 20.0],
            [38.0, 26.0],
        ]
        .map(|[x, y]| foot + d + Vec2::new(x, y))
        .to_vec();
        hand.curve(LEAD.inked(tau * 1.15), &hill);
    }
    for (x, wide, high) in [(0.0, 8.5, 19.0), (-7.5, 5.0, 11.0), (8.0, 6.0, 13.0)] {
        let a = foot + Vec2::new(x - 0.5 * wide, 0.5);
        let pen = LEAD.inked(1.15);
        hand.line(pen, &[a, a - Vec2::new(-0.3, high)]);
        hand.line(
            pen,
            &[a + Vec2::new(wide, 0.0), a + Vec2::new(wide - 0.3, -high)],
        );
        let rim = a + Vec2::new(0.5 * wide, -high);
        hand.line(pen, &arc(rim, Vec2::new(0.5 * wide, 1.3), 0.0, 6.6));
    }
    for i in 0..22 {
        let a = foot + Vec2::new(6.0 + 0.9 * i as f32, 2.5 + 0.75 * i as f32);
        let b = a + Vec2::new(-4.5, 7.5 + hand.chance.centred());
        hand.line(LEAD.inked(0.9), &[a, b]);
    }
}

/// The bridge was first a single high arch, nearer to the falls.
fn first_bridge(hand: &mut Hand) {
    let middle = project(Vec3::new(16.0, BRIDGE_M - 70.0, UPPER_WATER_M));
    for (lift, tau) in [(0.0, 1.1f32), (1.3, 0.9), (-1.0, 0.6)] {
        let bow = arc(middle, Vec2::new(23.0, 13.5 + lift), 3.25, 6.18);
        hand.line(LEAD.inked(tau), &bow);
    }
    let deck = arc(
        middle - Vec2::new(0.0, 3.0),
        Vec2::new(36.0, 14.5),
        3.5,
        5.95,
    );
    hand.line(LEAD, &deck);
}

/// Searching lines beside the final contours, and a figure that was left out.
fn searching(hand: &mut Hand, view: &View, size_mm: Vec2) {
    for _ in 0..70 {
        let at = Vec2::new(hand.chance.unit(), hand.chance.between(0.25, 0.95)) * size_mm;
        let Some(fall) = view.fall_line(at) else {
            continue;
        };
        let bend = fall.perp() * hand.chance.between(-2.0, 2.0);
        let reach = hand.chance.between(4.0, 13.0);
        let path = [at, at + fall * reach * 0.5 + bend, at + fall * reach];
        let pressure = hand.chance.between(0.5, 1.0);
        hand.curve(LEAD.inked(pressure), &path);
    }
    woman_with_jar(hand, Vec2::new(206.0, 158.0));
}

/// A woman who carries a jar on her shoulder, felt for in a few lines and left out.
fn woman_with_jar(hand: &mut Hand, foot: Vec2) {
    let lines: [&[[f32; 2]]; 12] = [
        &[
            [0.9, -17.6],
            [-0.2, -18.6],
            [0.1, -20.2],
            [1.4, -20.6],
            [2.2, -19.4],
            [1.6, -17.8],
        ],
        &[
            [0.2, -17.4],
            [-2.4, -16.0],
            [-3.0, -13.2],
            [-1.9, -10.2],
            [-3.2, -5.0],
            [-5.0, 3.4],
        ],
        &[
            [1.8, -17.3],
            [3.4, -15.8],
            [3.2, -12.6],
            [2.6, -10.0],
            [4.6, -4.0],
            [5.4, 3.6],
        ],
        &[[-5.0, 3.4], [-2.0, 4.4], [1.6, 3.6], [5.4, 3.6]],
        &[[-2.4, -16.0], [-4.6, -17.6], [-3.6, -21.6]],
        &[[-1.6, -15.0], [-4.0, -16.2], [-2.6, -20.8]],
        &[
            [-4.8, -21.4],
            [-5.8, -24.2],
            [-4.0, -26.4],
            [-2.2, -24.4],
            [-2.9, -21.3],
            [-4.8, -21.4],
        ],
        &[[3.2, -14.6], [5.4, -11.0], [4.2, -7.6]],
        &[[-1.6, -10.0], [0.6, -9.2], [2.6, -10.2]],
        &[[-0.8, -9.2], [-1.8, -3.0], [-1.4, 3.0]],
        &[[0.8, -9.0], [1.4, -3.4], [0.4, 3.4]],
        &[[2.0, -9.4], [3.2, -3.0], [3.0, 3.4]],
    ];
    for line in lines {
        let path: Vec<Vec2> = line.iter().map(|p| foot + Vec2::from_array(*p)).collect();
        hand.curve(LEAD.inked(1.2), &path);
        if hand.chance.happens(0.6) {
            let shift = Vec2::new(hand.chance.centred(), hand.chance.centred()) * 0.8;
            let again: Vec<Vec2> = path.iter().map(|&p| p + shift).collect();
            hand.curve(LEAD.inked(0.6), &again);
        }
    }
}

/// Grooves without colour: a frame, diagonals, a ruled horizon, and a compass arc.
pub fn stylus(hand: &mut Hand, size_mm: Vec2) {
    let (low, high) = (Vec2::splat(9.0), size_mm - Vec2::splat(9.5));
    let corners = [
        low,
        Vec2::new(high.x, low.y),
        high,
        Vec2::new(low.x, high.y),
    ];
    for i in 0..4 {
        hand.line(STYLUS, &[corners[i], corners[(i + 1) % 4]]);
    }
    let ruled = |y: f32| [Vec2::new(low.x, y), Vec2::new(high.x, y - 0.2)];
    hand.line(STYLUS, &ruled(VANISHING_MM.y));
    hand.line(STYLUS.scaled(0.8), &[low, high]);
    hand.line(STYLUS.scaled(0.8), &[corners[1], corners[3]]);
    for angle in [0.25f32, 0.6, 1.1, 2.05, 2.5, 2.85] {
        let ray = Vec2::from_angle(angle);
        let reach = (high.y - VANISHING_MM.y) / ray.y.max(0.35);
        hand.line(
            STYLUS.scaled(0.8),
            &[VANISHING_MM, VANISHING_MM + ray * reach.min(125.0)],
        );
    }
    hand.line(STYLUS, &arc(VANISHING_MM, Vec2::splat(52.0), 3.35, 6.1));
}
