//! The land itself: its contours, and hatching over slopes and rocks.

use glam::{Vec2, Vec3};

use super::{
    pens,
    terrain::{FALLS_M, Ground, UPPER_WATER_M},
    view::{View, project},
};
use crate::sample::{
    contour,
    grid::Plane,
    hand::{Hand, Pen, smooth},
    hatching::{Form, Hatcher, Pass},
    noise::{Noise, smoothstep},
};

/// Distances that differ by more than this share have a contour between them.
const CONTOUR_RATIO: f32 = 1.07;
/// The road from the viewer's feet to the bridge and on to the town: x, y in m.
const ROAD_M: [[f32; 2]; 12] = [
    [44.0, 84.0],
    [47.0, 112.0],
    [60.0, 140.0],
    [57.0, 175.0],
    [44.0, 215.0],
    [52.0, 262.0],
    [72.0, 310.0],
    [60.0, 340.0],
    [84.0, 390.0],
    [132.0, 430.0],
    [120.0, 470.0],
    [158.0, 510.0],
];

/// Draws the contours of hills, rocks and banks.
pub fn contours(hand: &mut Hand, view: &View) {
    let found = Noise::smooth(31, 9.0, 2);
    for contour in contour::trace(view.land(), |near, far| far / near > CONTOUR_RATIO) {
        {
            let pen = pens::contour(contour.near);
            let kept: Vec<(Vec2, f32)> = contour
                .points
                .iter()
                .map(|&p| {
                    // Lost and found: a contour fades where the eye completes it.
                    let lost = found.at(p) < -0.42 && contour.near > 260.0;
                    (p, if lost { f32::INFINITY } else { contour.near })
                })
                .collect();
            for run in view.visible_runs(&kept) {
                let weight = if contour.near < 240.0 { 1.0 } else { 0.9 };
                hand.line(pen.scaled(weight).with_ends(0.6, 0.4), &run);
                // The foreground is gone over a second time, not quite on the line.
                if contour.near < 300.0 && hand.chance.happens(0.45) {
                    let shift = Vec2::new(hand.chance.centred(), hand.chance.centred()) * 0.22;
                    let again: Vec<Vec2> = run.iter().map(|&p| p + shift).collect();
                    hand.line(pen.scaled(0.65).with_ends(0.4, 0.3), &again);
                }
            }
        }
    }
}

/// The land as something to hatch.
struct Slopes<'a> {
    view: &'a View,
    /// Tone is multiplied by this.
    strength: f32,
    only: Option<Ground>,
    /// Which beds of the rock stand out.
    beds: Noise,
}

impl Form for Slopes<'_> {
    fn tone(&self, at: Vec2) -> f32 {
        if !self.view.land_shows(at) {
            return 0.0;
        }
        // Thin far lines need more of them to tell.
        let far = smoothstep(1500.0, 4000.0, self.view.distance(at));
        self.view.tone(at) * self.strength * (1.0 + far)
    }

    fn direction(&self, at: Vec2) -> Option<Vec2> {
        let ground = self.view.ground(at)?;
        if ground == Ground::Water || self.only.is_some_and(|only| only != ground) {
            return None;
        }
        let fall = self.view.fall_line(at)?;
        // Never dead along the fall line: a hand slants across it, each facet of rock its own way.
        let turn = if ground == Ground::Rock {
            let world = self.view.world(at)?;
            -0.25 + 0.75 * self.view.terrain.facet(world.truncate(), world.z)
        } else {
            -0.38
        };
        Some(Vec2::from_angle(turn).rotate(if fall.y < 0.0 { -fall } else { fall }))
    }

    fn continues(&self, from: Vec2, to: Vec2) -> bool {
        let (a, b) = (self.view.distance(from), self.view.distance(to));
        a.is_finite() && b.is_finite() && (a / b - 1.0).abs() < 0.05 && self.view.land_shows(to)
    }

    fn pen(&self, at: Vec2) -> Pen {
        pens::hatch(self.view.distance(at)).with_ends(0.8, 0.3)
    }

    fn length_mm(&self, at: Vec2) -> f32 {
        let distance = self.view.distance(at).min(3000.0);
        (6.5 * (200.0 / distance).powf(0.45)).clamp(1.6, 8.0)
    }
}

/// Strata: hatching along the beds of the rock.
struct Strata<'a>(Slopes<'a>);

/// Darkness that the beds give even to lit rock.
const BEDS_TONE: f32 = 0.19;

impl Form for Strata<'_> {
    fn tone(&self, at: Vec2) -> f32 {
        let Some(world) = self.0.view.world(at) else {
            return 0.0;
        };
        let bed = self.0.beds.at(Vec2::new(
            0.06 * (world.x + world.y),
            world.z - 0.1 * world.x,
        ));
        let lit = if self.0.view.land_shows(at) {
            BEDS_TONE
        } else {
            0.0
        };
        (0.5 * self.0.tone(at)).max(lit) * smoothstep(-0.1, 0.35, bed)
    }

    fn direction(&self, at: Vec2) -> Option<Vec2> {
        self.0.direction(at)?;
        self.0.view.level_line(at)
    }

    fn continues(&self, from: Vec2, to: Vec2) -> bool {
        self.0.continues(from, to) && self.0.view.ground(to) == Some(Ground::Rock)
    }

    fn pen(&self, at: Vec2) -> Pen {
        self.0.pen(at).scaled(1.1).with_ends(0.5, 0.3)
    }

    fn length_mm(&self, at: Vec2) -> f32 {
        2.0 * self.0.length_mm(at)
    }
}

/// Cracks between the blocks of the rock: firm where they open, lost where they close.
pub fn cracks(hand: &mut Hand, view: &View) {
    let grid = view.land().grid;
    let facets = Plane::from_fn(grid, |p| match view.world(p) {
        Some(world) if view.ground(p) == Some(Ground::Rock) => {
            FACET_BASE + view.terrain.facet(world.truncate(), world.z)
        }
        _ => f32::INFINITY,
    });
    let open = Noise::smooth(39, 13.0, 3);
    for crack in contour::trace(&facets, |near, far| far.is_finite() && far - near > 0.12) {
        for piece in crack
            .points
            .chunk_by(|&a, &b| open.at(a) > 0.0 && open.at(b) > 0.0)
        {
            if piece.len() < 8 {
                continue;
            }
            let distance = view.distance(piece[piece.len() / 2]);
            let path: Vec<(Vec2, f32)> = piece.iter().map(|&p| (p, view.distance(p))).collect();
            let weight = 0.45 + 0.6 * open.at(piece[piece.len() / 2]);
            for run in view.visible_runs(&path) {
                hand.line(
                    pens::contour(distance).scaled(weight).with_ends(0.4, 0.2),
                    &run,
                );
            }
        }
    }
}

/// Added to the facets' numbers, so that all are positive.
const FACET_BASE: f32 = 30.0;

/// Hatches slopes, rocks and shadows in several passes.
pub fn hatching(hand: &mut Hand, view: &View, size_mm: Vec2) {
    let mut hatcher = Hatcher::new(size_mm);
    let top = Vec2::new(0.0, 20.0);
    let first = Pass {
        turn: 0.0,
        from_tone: 0.10,
        share: 0.66,
        patch_mm: 1.5,
        strokes: 18,
        parallel: false,
    };
    let slopes = |only| Slopes {
        view,
        strength: 0.74,
        only,
        beds: Noise::smooth(38, 9.0, 2),
    };
    let strata = Strata(slopes(Some(Ground::Rock)));
    hatcher.pass(
        hand,
        &strata,
        top,
        size_mm,
        Pass {
            share: 0.8,
            strokes: 4,
            patch_mm: 2.2,
            ..first
        },
    );
    hatcher.pass(hand, &slopes(None), top, size_mm, first);
    let across = Pass {
        turn: -0.5,
        from_tone: 0.36,
        share: 0.9,
        parallel: true,
        ..first
    };
    hatcher.pass(hand, &slopes(None), top, size_mm, across);
    let darkest = Pass {
        turn: 0.4,
        from_tone: 0.47,
        share: 1.05,
        patch_mm: 2.0,
        ..across
    };
    hatcher.pass(hand, &slopes(None), top, size_mm, darkest);
}

/// The banks of the river and the road that comes down to the bridge.
pub fn banks_and_road(hand: &mut Hand, view: &View) {
    for side in [-1.0, 1.0] {
        let bank: Vec<(Vec2, f32)> = (0..700)
            .map(|i| {
                let y = FALLS_M * 1.003f32.powi(i);
                let x = view.terrain.bank_x(y, side) + side * 0.3;
                (project(Vec3::new(x, y, UPPER_WATER_M + 0.4)), y * 0.985)
            })
            .collect();
        // Drawn in pieces, each with the pen of its distance.
        for piece in bank.chunks(34) {
            let pen = pens::contour(piece[0].1).scaled(0.85).with_ends(0.7, 0.5);
            for run in view.visible_runs(piece) {
                hand.line(pen, &run);
                for pair in run.windows(7).step_by(3) {
                    let drop = Vec2::new(0.25 * side, 0.9) * (200.0 / piece[0].1).sqrt();
                    if hand.chance.happens(0.6) {
                        hand.line(
                            pen.scaled(0.7).with_ends(0.9, 0.2),
                            &[pair[0], pair[0] + drop],
                        );
                    }
                }
            }
        }
    }
    let road = smooth(&ROAD_M.map(Vec2::from_array));
    for (side, weight) in [(-1.0, 0.9), (1.0, 0.75)] {
        let edge: Vec<(Vec2, f32)> = road
            .windows(2)
            .map(|pair| {
                let p = pair[0] + (pair[1] - pair[0]).normalize_or_zero().perp() * 1.5 * side;
                (project(view.on_ground(p.x, p.y)), p.y * 0.99)
            })
            .collect();
        for piece in edge.chunks(60) {
            let pen = pens::contour(piece[0].1)
                .scaled(0.7 * weight)
                .with_ends(0.5, 0.3);
            for run in view.visible_runs(piece) {
                hand.line(pen, &run);
            }
        }
    }
}

/// A few level strokes here and there that lay the lit ground flat.
pub fn ground_lines(hand: &mut Hand, view: &View, size_mm: Vec2) {
    let bare = Noise::smooth(36, 26.0, 2);
    for _ in 0..520 {
        let at = Vec2::new(hand.chance.unit(), hand.chance.between(0.45, 1.0)) * size_mm;
        let distance = view.distance(at);
        let lit = view.ground(at) == Some(Ground::Soil) && view.tone(at) < 0.2;
        if !lit || distance > 420.0 || bare.at(at) < -0.05 || !view.land_shows(at) {
            continue;
        }
        let Some(level) = view.level_line(at) else {
            continue;
        };
        // Level ground has no fall line to speak of; the hand then draws across the sheet.
        let along = (level + Vec2::X * 1.5).normalize_or(Vec2::X);
        let reach = 7.0 * (150.0 / distance).sqrt();
        let pen = pens::hatch(distance).scaled(0.75).with_ends(0.35, 0.25);
        for row in 0..(2 + (hand.chance.unit() * 4.0) as usize) {
            let aside = Vec2::new(reach * 0.5 * hand.chance.centred(), 0.62 * row as f32);
            let length = reach * hand.chance.between(0.4, 1.0);
            let from = at + aside - along * 0.5 * length;
            let sag = Vec2::new(0.0, 0.05 * length * hand.chance.centred());
            let path = smooth(&[
                from,
                from + along * 0.5 * length + sag,
                from + along * length,
            ]);
            let path: Vec<(Vec2, f32)> = path
                .into_iter()
                .filter(|&p| view.ground(p) == Some(Ground::Soil))
                .map(|p| (p, view.distance(p)))
                .collect();
            for run in view.visible_runs(&path) {
                hand.line(pen, &run);
            }
        }
    }
}

/// Tufts of grass and small plants on the ground near the viewer.
pub fn plants(hand: &mut Hand, view: &View, size_mm: Vec2) {
    let thick = Noise::smooth(37, 14.0, 2);
    for _ in 0..1100 {
        let at = Vec2::new(hand.chance.unit(), hand.chance.between(0.55, 1.0)) * size_mm;
        let distance = view.distance(at);
        let grows = view.ground(at) == Some(Ground::Soil)
            || (view.ground(at) == Some(Ground::Rock) && view.tone(at) < 0.35);
        let kept = hand.chance.unit() < 0.45 + 0.8 * thick.at(at);
        if !grows || !kept || distance > 190.0 || !view.land_shows(at) {
            continue;
        }
        let height = 2.4 * (110.0 / distance) * hand.chance.between(0.5, 1.3);
        let pen = pens::hatch(distance).scaled(0.6).with_ends(0.5, 0.2);
        let blades = 3 + (hand.chance.unit() * 6.0) as usize;
        for blade in 0..blades {
            let lean = (blade as f32 / blades as f32 - 0.45) * 1.3 + 0.2 * hand.chance.centred();
            let tip = at + Vec2::new(lean, -1.0) * height * hand.chance.between(0.6, 1.0);
            let middle = at.lerp(tip, 0.55) - Vec2::new(0.22 * lean * height, 0.0);
            hand.curve(pen, &[at, middle, tip]);
        }
    }
}

/// Fields of the plain: furrows and hedges in perspective.
pub fn fields(hand: &mut Hand, view: &View) {
    for _ in 0..120 {
        let y = 420.0 * (1.0 + 3.2 * hand.chance.unit().powf(1.4));
        let x = hand.chance.between(-0.45, 0.5) * y;
        let angle = 0.5 * hand.chance.centred() + if hand.chance.happens(0.5) { 0.0 } else { 1.45 };
        let along = Vec2::from_angle(angle);
        let (length, width) = (
            hand.chance.between(40.0, 90.0),
            hand.chance.between(25.0, 60.0),
        );
        let rows = (hand.chance.between(5.0, 10.0)) as usize;
        let pen = pens::hatch(y).scaled(0.85).with_ends(0.7, 0.4);
        for row in 0..=rows {
            let aside = along.perp() * width * (row as f32 / rows as f32 - 0.5);
            let reach = length * hand.chance.between(0.42, 0.5);
            let furrow: Vec<(Vec2, f32)> = (0..=40)
                .filter_map(|i| {
                    let p = Vec2::new(x, y) + aside + along * reach * (i as f32 / 20.0 - 1.0);
                    let slope = view.terrain.slope(p);
                    let level =
                        slope.length() < 0.32 && view.terrain.ground(p, slope) == Ground::Soil;
                    let world = view.on_ground(p.x, p.y);
                    level.then(|| (project(world), world.y * 0.99))
                })
                .collect();
            let fade = 1.0 - 0.4 * smoothstep(600.0, 1700.0, y);
            for run in view.visible_runs(&furrow) {
                hand.line(pen.inked(fade), &run);
            }
        }
    }
}
