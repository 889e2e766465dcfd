//! Boulders along the water and at the foot of the bluff.

use glam::Vec2;

use super::{
    pens,
    terrain::{FALLS_M, Terrain},
    view::{View, project, scale_at},
};
use crate::sample::{
    hand::{Hand, inside, smooth},
    noise::Chance,
};

/// One stone on the sheet.
pub struct Boulder {
    distance_m: f32,
    outline: Vec<Vec2>,
    /// Where its lit top meets its shaded flank.
    ridge: Vec<Vec2>,
    flank: Vec<Vec2>,
}

/// Lays the boulders into the view.
pub fn lay(view: &mut View) -> Vec<Boulder> {
    let mut chance = Chance::new(41);
    let mut boulders = Vec::new();
    // Rocks that part the falls, and one that stands in the pool.
    for [x, y, size] in [
        [13.0, 203.0, 3.6],
        [2.0, 202.0, 2.2],
        [-3.5, 200.0, 5.0],
        [24.0, 199.0, 6.5],
        [6.0, 168.0, 3.0],
        [11.0, 165.0, 2.0],
    ] {
        boulders.push(Boulder::lay(view, &mut chance, Vec2::new(x, y), size));
    }
    for _ in 0..190 {
        let y = chance.between(112.0, 300.0);
        let side = if chance.happens(0.55) { -1.0 } else { 1.0 };
        let off = chance.unit().powi(2) * if side < 0.0 { 22.0 } else { 15.0 };
        let x = view.terrain.bank_x(y, side) + side * off;
        let near_falls = (y - FALLS_M).abs() < 30.0;
        let size =
            chance.between(0.7, 2.0) + if near_falls { 2.6 } else { 1.5 } * chance.unit().powi(3);
        let steep = view.terrain.slope(Vec2::new(x, y)).length() > 1.0;
        let afloat = (x - Terrain::river_x(y)).abs() < 0.6 * Terrain::river_half_width(y);
        if !steep && !afloat {
            boulders.push(Boulder::lay(view, &mut chance, Vec2::new(x, y), size));
        }
    }
    boulders
}

impl Boulder {
    fn lay(view: &mut View, chance: &mut Chance, at_m: Vec2, size_m: f32) -> Self {
        let foot = project(view.on_ground(at_m.x, at_m.y));
        let size = size_m * scale_at(at_m.y);
        let mut corner = |u: f32, v: f32| {
            foot + Vec2::new(u + 0.16 * chance.centred(), -v + 0.14 * chance.centred()) * size
        };
        let left = corner(-0.95, 0.0);
        let shoulder = corner(-0.75, 0.55);
        let crest = corner(-0.15, 0.95);
        let brow = corner(0.45, 0.80);
        let right = corner(0.90, 0.30);
        let toe = corner(0.85, -0.12);
        let knee = corner(0.15, -0.2);
        let edge = corner(0.12, 0.48);
        let outline = vec![left, shoulder, crest, brow, right, toe, knee];
        view.stand(&outline, at_m.y - 0.3);
        view.darken(
            foot + Vec2::new(0.45, -0.1) * size,
            Vec2::new(0.7, 0.6) * size,
            0.4,
        );
        let ridge = vec![brow.lerp(crest, 0.4), edge, knee];
        let flank = vec![brow.lerp(crest, 0.4), brow, right, toe, knee, edge];
        Self {
            distance_m: at_m.y - 0.3,
            outline,
            ridge,
            flank,
        }
    }

    /// Draws it.
    pub fn draw(&self, hand: &mut Hand, view: &View) {
        let contour = pens::contour(self.distance_m);
        let hatch = pens::hatch(self.distance_m).scaled(0.9);
        let draw = |hand: &mut Hand, pen, path: &[Vec2]| {
            let path: Vec<_> = path.iter().map(|&p| (p, self.distance_m * 0.998)).collect();
            for run in view.visible_runs(&path) {
                hand.line(pen, &run);
            }
        };
        let [upper, lower] = [&self.outline[..5], &self.outline[4..]];
        draw(
            hand,
            contour.scaled(0.85).with_ends(0.5, 0.5),
            &angular(upper),
        );
        draw(
            hand,
            contour.scaled(1.25).with_ends(0.6, 0.4),
            &angular(lower),
        );
        draw(
            hand,
            contour.scaled(0.6).with_ends(0.7, 0.2),
            &angular(&self.ridge),
        );
        let low = self
            .flank
            .iter()
            .copied()
            .reduce(Vec2::min)
            .unwrap_or_default();
        let high = self
            .flank
            .iter()
            .copied()
            .reduce(Vec2::max)
            .unwrap_or_default();
        let along = Vec2::new(-0.42, 1.0);
        let tall = high.y - low.y;
        let mut x = low.x;
        while x < high.x + 0.42 * tall {
            let end = hand.chance.between(0.75, 1.0);
            let path: Vec<Vec2> = (0..=40)
                .map(|i| Vec2::new(x, low.y) + along * tall * end * i as f32 / 40.0)
                .filter(|&p| inside(&self.flank, p))
                .collect();
            draw(hand, hatch.with_ends(0.9, 0.35), &path);
            x += hatch.width_mm * hand.chance.between(1.9, 3.2);
        }
        // The ground's shadow.
        let toe = self.outline[5];
        let reach = 0.5 * (high.x - low.x) + 0.4;
        for i in 0..4 {
            let from = toe + Vec2::new(-reach * hand.chance.between(0.3, 1.0), 0.28 * i as f32);
            let to = toe + Vec2::new(reach * hand.chance.between(0.4, 1.2), 0.3 * i as f32 + 0.1);
            let path: Vec<Vec2> = (0..=8).map(|k| from.lerp(to, k as f32 / 8.0)).collect();
            draw(hand, hatch.with_ends(0.6, 0.25), &path);
        }
    }
}

/// A stone's edge: nearly straight between its corners.
fn angular(corners: &[Vec2]) -> Vec<Vec2> {
    let mut points = Vec::new();
    for pair in corners.windows(2) {
        points.extend([
            pair[0],
            pair[0].lerp(pair[1], 0.3),
            pair[0].lerp(pair[1], 0.7),
        ]);
    }
    points.extend(corners.last());
    smooth(&points)
}
