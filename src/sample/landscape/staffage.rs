//! Small things that give a landscape its size: travellers, birds, boats.

use glam::Vec2;

use super::{
    pens,
    view::{View, project, scale_at},
};
use crate::sample::hand::{Hand, Pen, arc};

/// A traveller with a staff, seen from behind, `height_m` tall.
pub fn traveller(hand: &mut Hand, view: &View, x: f32, y: f32, lean: f32) {
    let foot = project(view.on_ground(x, y));
    let unit = 1.75 * scale_at(y) / 7.0;
    let pen = pens::contour(y).scaled(0.8);
    let at = |u: f32, v: f32| foot + Vec2::new(u + lean * v * 0.1, -v) * unit;
    hand.line(
        pen.scaled(0.9),
        &arc(at(0.0, 6.4), Vec2::new(0.48, 0.58) * unit, 0.0, 6.5),
    );
    // A hat, a cloak, legs, the staff.
    hand.curve(
        pen,
        &[at(-0.9, 6.6), at(-0.2, 7.0), at(0.2, 7.2), at(0.9, 6.6)],
    );
    hand.curve(
        pen,
        &[at(-0.2, 5.7), at(-1.0, 4.6), at(-1.3, 2.6), at(-1.5, 1.6)],
    );
    hand.curve(
        pen.scaled(1.3),
        &[at(0.3, 5.7), at(1.0, 4.8), at(1.2, 3.0), at(1.5, 1.7)],
    );
    hand.curve(
        pen,
        &[at(-1.5, 1.6), at(-0.4, 1.3), at(0.6, 1.5), at(1.5, 1.7)],
    );
    hand.curve(pen, &[at(-0.5, 1.4), at(-0.7, 0.6), at(-0.9, 0.0)]);
    hand.curve(pen, &[at(0.5, 1.4), at(0.7, 0.7), at(1.0, 0.1)]);
    hand.line(pen.scaled(0.7), &[at(2.1, 5.4), at(2.5, -0.1)]);
    hand.curve(pen.scaled(0.8), &[at(0.7, 4.7), at(1.5, 4.1), at(2.2, 4.3)]);
    for i in 0..9 {
        let u = -0.3 + 0.18 * i as f32;
        hand.curve(
            pen.scaled(0.6),
            &[
                at(u, 5.2 - 0.1 * i as f32),
                at(u + 0.25, 3.4),
                at(u + 0.15, 1.7),
            ],
        );
    }
    for i in 0..6 {
        let from = at(0.6, -0.15 * i as f32);
        hand.line(
            pen.scaled(0.6),
            &[from, from + Vec2::new(3.4 - 0.3 * i as f32, 0.5) * unit],
        );
    }
}

/// Birds in the bare sky: two flicks each.
pub fn birds(hand: &mut Hand, pen: Pen) {
    for [x, y, size] in [
        [168.0, 24.0, 1.7],
        [174.0, 21.5, 1.4],
        [179.5, 25.5, 1.2],
        [163.0, 29.0, 1.0],
        [186.0, 22.5, 0.9],
        [191.0, 27.5, 0.8],
    ] {
        let at = Vec2::new(x, y);
        let left = at + Vec2::new(-1.5, -0.55) * size;
        let right = at + Vec2::new(1.4, -0.75) * size;
        let raised = Vec2::new(0.0, -0.55 * size);
        hand.curve(
            pen.with_ends(0.3, 1.0),
            &[left, left.lerp(at, 0.45) + raised, at],
        );
        hand.curve(
            pen.with_ends(1.0, 0.2),
            &[at, at.lerp(right, 0.5) + raised, right],
        );
    }
}
