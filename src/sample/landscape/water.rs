//! The river: its falls, ripples and reflections, and the bridge.

use glam::{Vec2, Vec3};

use super::{
    pens,
    terrain::{BRIDGE_M, FALLS_M, Ground, LOWER_WATER_M, Terrain, UPPER_WATER_M},
    view::{View, project, scale_at},
};
use crate::sample::hand::{Hand, arc};

/// Draws the water.
pub fn draw(hand: &mut Hand, view: &View, size_mm: Vec2) {
    falls(hand, view);
    pool(hand, view);
    ripples(hand, view, size_mm);
}

/// Threads of water from the lip of the falls to the pool.
fn falls(hand: &mut Hand, view: &View) {
    let middle = Terrain::river_x(FALLS_M);
    let half = Terrain::river_half_width(FALLS_M);
    let pen = pens::hatch(FALLS_M).scaled(0.7).with_ends(0.8, 0.25);
    for i in 0..90 {
        let across = (i as f32 + 0.5 * hand.chance.centred()) / 45.0 - 1.0;
        let x = middle + half * across * 0.97;
        let lip = project(Vec3::new(x, FALLS_M + 1.0, UPPER_WATER_M + 0.2));
        let foot = project(Vec3::new(x + 0.5 * across, FALLS_M - 3.0, LOWER_WATER_M));
        let (from, to) = (
            hand.chance.unit().powi(2) * 0.5,
            hand.chance.between(0.45, 1.0),
        );
        if to - from < 0.15 || hand.chance.happens(0.25) {
            continue;
        }
        let thread: Vec<(Vec2, f32)> = (0..=24)
            .map(|k| {
                let t = from + (to - from) * k as f32 / 24.0;
                let sway = 0.35 * (t * 9.0 + i as f32).sin() * t;
                // Water leaves the lip level and falls ever steeper.
                (
                    Vec2::new(
                        lip.x + (foot.x - lip.x) * t + sway,
                        lip.y + (foot.y - lip.y) * t * t.sqrt(),
                    ),
                    FALLS_M - 4.0,
                )
            })
            .collect();
        for run in view.visible_runs(&thread) {
            hand.line(pen, &run);
        }
    }
    for i in 0..16 {
        let across = i as f32 / 7.5 - 1.0;
        let foot = project(Vec3::new(
            middle + half * across,
            FALLS_M - 4.0,
            LOWER_WATER_M,
        ));
        let spray = arc(
            foot,
            Vec2::new(1.3, 0.8) * hand.chance.between(0.7, 1.5),
            3.3,
            6.1,
        );
        if view.shows(foot, FALLS_M - 5.0) {
            hand.loops(pen.scaled(0.9), &spray, 0.32, 0.55);
        }
    }
}

/// Rings that spread over the pool from the foot of the falls.
fn pool(hand: &mut Hand, view: &View) {
    let centre = Vec2::new(Terrain::river_x(FALLS_M), FALLS_M - 4.0);
    for ring in 0..26 {
        let radius = 5.0 + 2.9 * ring as f32;
        let pen = pens::hatch(FALLS_M - radius.min(90.0))
            .scaled(0.72)
            .with_ends(0.4, 0.25);
        let mut start = -2.9 + 0.5 * hand.chance.unit();
        while start < -0.25 {
            let end = start + hand.chance.between(0.12, 0.5);
            let ripple: Vec<(Vec2, f32)> = (0..=30)
                .map(|k| {
                    let angle = start + (end - start) * k as f32 / 30.0;
                    let wave = 0.5 * (angle * 23.0 + ring as f32).sin();
                    let p =
                        centre + Vec2::from_angle(angle) * Vec2::new(1.25, 1.1) * (radius + wave);
                    (p, angle)
                })
                .filter(|(p, _)| is_water(view, *p))
                .map(|(p, _)| (project(p.extend(LOWER_WATER_M)), p.y * 0.985))
                .collect();
            for run in view.visible_runs(&ripple) {
                hand.line(pen, &run);
            }
            start = end + hand.chance.between(0.05, 0.45);
        }
    }
}

fn is_water(view: &View, p: Vec2) -> bool {
    view.terrain.ground(p, view.terrain.slope(p)) == Ground::Water
}

/// Level strokes on the upper river: dark under the banks, none where the sky is mirrored.
fn ripples(hand: &mut Hand, view: &View, size_mm: Vec2) {
    for _ in 0..9000 {
        let at = Vec2::new(hand.chance.unit(), hand.chance.between(0.34, 0.80)) * size_mm;
        let Some(world) = view.world(at) else {
            continue;
        };
        if world.y < FALLS_M + 4.0 || view.ground(at) != Some(Ground::Water) || !view.land_shows(at)
        {
            continue;
        }
        let middle = Terrain::river_x(world.y);
        let off_bank = 1.0 - (world.x - middle).abs() / Terrain::river_half_width(world.y);
        let left = world.x < middle;
        let wanted = if left {
            0.85 - 1.6 * off_bank
        } else {
            0.45 - 1.4 * off_bank
        };
        if hand.chance.unit() > wanted.max(0.09) {
            continue;
        }
        let length = (0.35 * scale_at(world.y) * Terrain::river_half_width(world.y))
            .clamp(0.6, 5.0)
            * hand.chance.between(0.5, 1.2);
        let end = at + Vec2::new(length, 0.03 * length * hand.chance.centred());
        let bow = at.midpoint(end) + Vec2::new(0.0, 0.06 * length);
        let path = [at, bow, end].map(|p| (p, world.y * 0.99));
        if path
            .iter()
            .all(|(p, _)| view.ground(*p) == Some(Ground::Water) && view.land_shows(*p))
        {
            hand.curve(
                pens::hatch(world.y).scaled(0.8).with_ends(0.6, 0.3),
                &path.map(|(p, _)| p),
            );
        }
    }
}

/// A stone bridge of three arches.
pub struct Bridge {
    outline: Vec<Vec2>,
    deck: [Vec<Vec2>; 2],
    arches: Vec<Vec<Vec2>>,
}

/// Height of the deck over the water at the banks and in the middle, and spans, in m.
const DECK_M: f32 = 7.5;
const CROWN_M: f32 = 11.5;
const ARCHES: usize = 3;
const LENGTH_M: f32 = 52.0;
const PARAPET_M: f32 = 1.7;

impl Bridge {
    /// Builds it into the view.
    pub fn build(view: &mut View) -> Self {
        let x0 = Terrain::river_x(BRIDGE_M) - 0.5 * LENGTH_M;
        let at =
            |t: f32, z: f32| project(Vec3::new(x0 + LENGTH_M * t, BRIDGE_M, UPPER_WATER_M + z));
        let deck_z = |t: f32| DECK_M + (CROWN_M - DECK_M) * (1.0 - (2.0 * t - 1.0).abs());
        let line = |lift: f32| -> Vec<Vec2> {
            (0..=40)
                .map(|i| at(i as f32 / 40.0, deck_z(i as f32 / 40.0) + lift))
                .collect()
        };
        let arches: Vec<Vec<Vec2>> = (0..ARCHES)
            .map(|i| {
                let middle = (i as f32 + 0.5) / ARCHES as f32;
                let half = 0.36 / ARCHES as f32 * if i == 1 { 1.15 } else { 0.95 };
                let rise = if i == 1 { 8.2 } else { 5.6 };
                (0..=24)
                    .map(|k| {
                        let angle = std::f32::consts::PI * k as f32 / 24.0;
                        at(middle - half * angle.cos(), rise * angle.sin() - 0.6)
                    })
                    .collect()
            })
            .collect();
        let mut outline = line(PARAPET_M);
        outline.push(at(1.0, -1.0));
        for arch in arches.iter().rev() {
            outline.extend(arch.iter().rev());
        }
        outline.push(at(0.0, -1.0));
        view.stand(&outline, BRIDGE_M);
        Self {
            outline,
            deck: [line(PARAPET_M), line(0.0)],
            arches,
        }
    }

    /// Draws it.
    pub fn draw(&self, hand: &mut Hand, view: &View) {
        let pen = pens::contour(BRIDGE_M * 0.75);
        let draw = |hand: &mut Hand, pen, path: &[Vec2]| {
            let path: Vec<_> = path.iter().map(|&p| (p, BRIDGE_M * 0.995)).collect();
            for run in view.visible_runs(&path) {
                hand.line(pen, &run);
            }
        };
        draw(hand, pen, &self.deck[0]);
        draw(hand, pen.scaled(0.7), &self.deck[1]);
        let thin = pens::hatch(BRIDGE_M).scaled(0.9).with_ends(0.8, 0.5);
        for arch in &self.arches {
            draw(hand, pen, arch);
            let crown = arch[arch.len() / 2];
            let raised: Vec<Vec2> = arch.iter().map(|&p| p.lerp(crown, -0.09)).collect();
            draw(hand, thin.scaled(0.8), &raised);
            // The vault's shadow, and its reflection in the river.
            let foot = arch[0].y;
            for i in 3..arch.len() * 3 / 5 {
                let from = arch[i];
                let depth = (foot - from.y) * (1.0 - i as f32 / (0.62 * arch.len() as f32));
                hand.line(
                    thin,
                    &[
                        from + Vec2::new(0.05, 0.1),
                        from + Vec2::new(0.3, depth + 0.2),
                    ],
                );
            }
            let width = arch[arch.len() - 1].x - arch[0].x;
            for i in 0..9 {
                let y = foot + 0.5 + 0.42 * i as f32;
                let inset = width * (0.04 * i as f32 + 0.1 * hand.chance.unit());
                let sway = 0.3 * hand.chance.centred();
                let a = Vec2::new(arch[0].x + inset + sway, y);
                let b = Vec2::new(
                    arch[0].x + width - inset + sway,
                    y + 0.1 * hand.chance.centred(),
                );
                if b.x > a.x {
                    hand.line(thin.with_ends(0.5, 0.3), &[a, b]);
                }
            }
        }
        // Ashlar: short courses on the spandrels, hatching on the shaded end.
        for _ in 0..240 {
            let i = (hand.chance.unit() * 40.0) as usize;
            let top = self.deck[1][i.min(40)];
            let p = top + Vec2::new(hand.chance.between(0.0, 0.9), hand.chance.between(0.5, 4.6));
            let q = p + Vec2::new(hand.chance.between(0.4, 1.0), 0.05 * hand.chance.centred());
            let within = |p| crate::sample::hand::inside(&self.outline, p);
            if within(p) && within(q) && within(q + Vec2::new(0.0, 0.3)) {
                draw(hand, thin.scaled(0.75), &[p, q]);
            }
        }
    }
}
