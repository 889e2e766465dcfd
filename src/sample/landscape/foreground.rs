//! Plants at the viewer's feet, large enough to have leaves with two sides.

use glam::Vec2;

use super::{pens, view::View};
use crate::sample::{
    hand::{Hand, Pen, smooth},
    noise::{Chance, mix},
};

/// Root and size of each plant in mm.
const PLANTS: [([f32; 2], f32); 7] = [
    ([19.0, 187.0], 17.0),
    ([33.0, 191.0], 12.0),
    ([71.0, 188.5], 10.0),
    ([112.0, 190.0], 13.0),
    ([121.0, 192.0], 9.0),
    ([199.0, 189.0], 15.0),
    ([228.0, 186.0], 11.0),
];
/// Distance at which the foreground's pen is cut, in m.
const NEAR_M: f32 = 64.0;
/// Relative distance between leaves of one plant, in tenths: more than the view ignores.
const DEPTH_STEP: f32 = 0.15;

/// A lance-shaped leaf that bows under its own weight.
struct Leaf {
    rib: Vec<Vec2>,
    /// Its lit and its shaded edge.
    edges: [Vec<Vec2>; 2],
}

/// One plant.
pub struct Plant {
    root: Vec2,
    size_mm: f32,
    /// From the nearest to the farthest.
    leaves: Vec<Leaf>,
}

/// Lets the plants grow into the view.
pub fn grow(view: &mut View) -> Vec<Plant> {
    let mut chance = Chance::new(45);
    let plant = |([x, y], size_mm): ([f32; 2], f32)| {
        let root = Vec2::new(x, y);
        let count = 8 + (chance.unit() * 5.0) as usize;
        let mut leaves: Vec<Leaf> = (0..count)
            .map(|i| {
                let spread = (i as f32 + 0.5) / count as f32 * 2.0 - 1.0;
                let lean = spread * 1.15 + 0.15 * chance.centred();
                let reach = size_mm * mix(1.0, 0.62, spread.abs()) * chance.between(0.75, 1.1);
                Leaf::grown(root + Vec2::new(0.8 * spread, 0.0), lean, reach)
            })
            .collect();
        chance.shuffle(&mut leaves);
        for (i, leaf) in leaves.iter().enumerate() {
            let mut hull = leaf.edges[0].clone();
            hull.extend(leaf.edges[1].iter().rev());
            view.stand(&hull, NEAR_M + 0.1 * i as f32 * NEAR_M * DEPTH_STEP);
        }
        view.darken(
            root + Vec2::new(1.5, -1.0),
            Vec2::new(0.55 * size_mm, 2.6),
            0.5,
        );
        Plant {
            root,
            size_mm,
            leaves,
        }
    };
    PLANTS.map(plant).into()
}

impl Plant {
    /// Draws it.
    pub fn draw(&self, hand: &mut Hand, view: &View) {
        for (i, leaf) in self.leaves.iter().enumerate() {
            let distance = NEAR_M + 0.1 * i as f32 * NEAR_M * DEPTH_STEP;
            leaf.draw(hand, view, distance * 0.999);
        }
        for _ in 0..3 {
            let reach = self.size_mm * hand.chance.between(1.1, 1.5);
            stalk(hand, self.root, reach);
        }
    }
}

fn pen() -> Pen {
    pens::contour(NEAR_M)
}

impl Leaf {
    fn grown(root: Vec2, lean: f32, reach: f32) -> Self {
        let up = Vec2::new(lean.sin(), -lean.cos());
        let droop = Vec2::new(0.0, 0.34 * reach * lean.abs().min(1.2));
        let shape = [0.0, 0.5, 0.85, 1.0].map(|t: f32| root + up * t * reach + droop * t * t * t);
        let rib = smooth(&shape);
        let last = rib.len() - 1;
        let edge = |side: f32| -> Vec<Vec2> {
            (0..=last)
                .map(|i| {
                    let t = i as f32 / last as f32;
                    let along =
                        (rib[(i + 1).min(last)] - rib[i.saturating_sub(1)]).normalize_or_zero();
                    let half = 0.085 * reach * (t * 2.6).sin().max(0.0) * (1.0 - t * t * t);
                    rib[i] + along.perp() * side * half
                })
                .collect()
        };
        let shaded = if lean > 0.0 { 1.0 } else { -1.0 };
        let edges = [edge(-shaded), edge(shaded)];
        Self { rib, edges }
    }

    fn draw(&self, hand: &mut Hand, view: &View, distance_m: f32) {
        let draw = |hand: &mut Hand, pen, path: &[Vec2]| {
            let path: Vec<_> = path.iter().map(|&p| (p, distance_m)).collect();
            for run in view.visible_runs(&path) {
                hand.line(pen, &run);
            }
        };
        let [lit, shaded] = &self.edges;
        draw(hand, pen().scaled(0.75).with_ends(0.8, 0.3), lit);
        draw(hand, pen().scaled(1.1).with_ends(0.9, 0.4), shaded);
        draw(hand, pen().scaled(0.5).with_ends(0.9, 0.2), &self.rib);
        let last = self.rib.len() - 1;
        for i in (last / 10..last * 4 / 5).step_by(3) {
            let to = self.rib[i].lerp(shaded[(i + 4).min(last)], 0.95);
            let path = [0.0, 0.5, 1.0].map(|t| self.rib[i].lerp(to, t));
            draw(hand, pen().scaled(0.5).with_ends(0.3, 0.8), &path);
        }
    }
}

/// A stalk with a head of seeds.
fn stalk(hand: &mut Hand, root: Vec2, reach: f32) {
    let lean = 0.3 * hand.chance.centred();
    let tip = root + Vec2::new(lean * reach, -reach);
    let bow = root.midpoint(tip) + Vec2::new(-0.12 * lean.signum() * reach * lean.abs(), 0.0);
    hand.curve(pen().scaled(0.6).with_ends(1.0, 0.5), &[root, bow, tip]);
    for i in 0..7 {
        let at = tip.lerp(bow, 0.07 * i as f32);
        let side = if i % 2 == 0 { 1.0 } else { -1.0 };
        let seed = at + Vec2::new(0.75 * side, -0.75);
        hand.curve(
            pen().scaled(0.7),
            &[at, at.midpoint(seed) + Vec2::new(0.22 * side, 0.14), seed],
        );
    }
}
