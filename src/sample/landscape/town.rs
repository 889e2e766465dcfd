//! Buildings: walls, towers and roofs as boxes in perspective.

use glam::{Vec2, Vec3};

use super::{
    pens,
    terrain::TOWN_M,
    view::{View, project},
};
use crate::sample::{
    hand::{Hand, Pen, inside},
    noise::{Chance, mix},
};

/// What covers a building.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Roof {
    Gable,
    Pyramid,
    Battlements,
}

/// One face of a building on the sheet.
struct Face {
    outline: Vec<Vec2>,
    /// Darkness 0…1.
    shade: f32,
    /// Roofs are hatched down their slope and have no windows.
    roof: bool,
}

/// A building that stands in the view.
pub struct Building {
    distance_m: f32,
    faces: Vec<Face>,
    merlons: Vec<Vec<Vec2>>,
}

/// Size in m and the angle of the plan.
struct Block {
    at: Vec3,
    wide: f32,
    deep: f32,
    high: f32,
    yaw: f32,
    roof: Roof,
}

impl Block {
    /// Roofed houses have weathered; towers and walls stand out pale.
    fn front_shade(&self) -> f32 {
        if self.roof == Roof::Gable { 0.24 } else { 0.16 }
    }
}

impl Building {
    fn build(view: &mut View, block: &Block) -> Self {
        let along = Vec2::from_angle(block.yaw);
        let corner = |u: f32, v: f32, z: f32| {
            let p = along * u * block.wide * 0.5 + along.perp() * v * block.deep * 0.5;
            project(block.at + p.extend(z))
        };
        let distance_m = block.at.y - 0.5 * block.deep;
        let (base, top) = (-2.5, block.high);
        let wall = |u0: f32, v0: f32, u1: f32, v1: f32| {
            vec![
                corner(u0, v0, base),
                corner(u0, v0, top),
                corner(u1, v1, top),
                corner(u1, v1, base),
            ]
        };
        let front = Face {
            outline: wall(-1.0, -1.0, 1.0, -1.0),
            shade: block.front_shade(),
            roof: false,
        };
        // The side that the eye sees turns away from the sun when it is the right one.
        let right_seen = corner(1.0, 1.0, 0.0).x > corner(1.0, -1.0, 0.0).x;
        let side = if right_seen {
            Face {
                outline: wall(1.0, -1.0, 1.0, 1.0),
                shade: 0.75,
                roof: false,
            }
        } else {
            Face {
                outline: wall(-1.0, 1.0, -1.0, -1.0),
                shade: 0.02,
                roof: false,
            }
        };
        let mut faces = vec![front, side];
        let mut merlons = Vec::new();
        match block.roof {
            Roof::Gable => {
                let ridge = top + 0.42 * block.deep;
                let slope = vec![
                    corner(-1.06, -1.1, top - 0.3),
                    corner(-1.0, 0.0, ridge),
                    corner(1.0, 0.0, ridge),
                    corner(1.06, -1.1, top - 0.3),
                ];
                faces.push(Face {
                    outline: slope,
                    shade: 0.32,
                    roof: true,
                });
                let u = if right_seen { 1.0 } else { -1.0 };
                let gable = vec![
                    corner(u, -1.0, top),
                    corner(u, 0.0, ridge),
                    corner(u, 1.0, top),
                ];
                let shade = if right_seen { 0.75 } else { 0.02 };
                faces.push(Face {
                    outline: gable,
                    shade,
                    roof: false,
                });
            }
            Roof::Pyramid => {
                let tip = corner(0.0, 0.0, top + 0.85 * block.wide);
                let eaves = |u: f32, v: f32| corner(u * 1.12, v * 1.12, top - 0.2);
                faces.push(Face {
                    outline: vec![eaves(-1.0, -1.0), tip, eaves(1.0, -1.0)],
                    shade: 0.22,
                    roof: true,
                });
                let u = if right_seen { 1.0 } else { -1.0 };
                let outline = vec![eaves(u, -1.0), tip, eaves(u, 1.0)];
                let shade = if right_seen { 0.85 } else { 0.1 };
                faces.push(Face {
                    outline,
                    shade,
                    roof: true,
                });
            }
            Roof::Battlements => {
                let count = ((block.wide / 2.6) as usize).max(3);
                for i in 0..count {
                    let u0 = -1.05 + 2.1 * i as f32 / count as f32;
                    let u1 = u0 + 1.15 / count as f32;
                    merlons.push(
                        [(u0, -0.4), (u0, 1.7), (u1, 1.7), (u1, -0.4)]
                            .map(|(u, z)| corner(u, -1.05, top + z))
                            .to_vec(),
                    );
                }
            }
        }
        for outline in faces.iter().map(|face| &face.outline).chain(&merlons) {
            view.stand(outline, distance_m);
        }
        Self {
            distance_m,
            faces,
            merlons,
        }
    }

    fn draw(&self, hand: &mut Hand, view: &View, weight: f32) {
        let contour = pens::contour(self.distance_m)
            .scaled(weight)
            .with_tremor(0.04);
        let hatch = pens::hatch(self.distance_m)
            .scaled(weight)
            .with_ends(0.8, 0.5);
        for face in &self.faces {
            let mut edge = face.outline.clone();
            edge.push(face.outline[0]);
            let heavier = if face.shade > 0.5 { 1.1 } else { 0.85 };
            for pair in edge.windows(2) {
                self.seen(hand, view, contour.scaled(heavier), pair[0], pair[1]);
            }
            self.hatch(hand, view, face, hatch);
            if !face.roof && face.outline.len() == 4 {
                self.windows(hand, view, face, contour);
            }
        }
        for merlon in &self.merlons {
            for pair in merlon.windows(2) {
                self.seen(hand, view, contour.scaled(0.8), pair[0], pair[1]);
            }
        }
    }

    /// Draws the visible part of a straight line, a little past its end as a quick hand does.
    fn seen(&self, hand: &mut Hand, view: &View, pen: Pen, a: Vec2, b: Vec2) {
        let over = 0.12 * hand.chance.unit();
        let end = b + (b - a).normalize_or_zero() * over;
        let parts = (a.distance(end) / 0.2).ceil().max(2.0) as usize;
        let path: Vec<(Vec2, f32)> = (0..=parts)
            .map(|i| {
                (
                    a.lerp(end, i as f32 / parts as f32),
                    self.distance_m * 0.998,
                )
            })
            .collect();
        for run in view.visible_runs(&path) {
            hand.line(pen.with_ends(0.9, 0.7), &run);
        }
    }

    fn hatch(&self, hand: &mut Hand, view: &View, face: &Face, pen: Pen) {
        if face.shade < 0.15 {
            return;
        }
        let low = face
            .outline
            .iter()
            .copied()
            .reduce(Vec2::min)
            .unwrap_or_default();
        let high = face
            .outline
            .iter()
            .copied()
            .reduce(Vec2::max)
            .unwrap_or_default();
        let slant = if face.roof {
            Vec2::new(0.55, 1.0)
        } else {
            Vec2::new(0.16, 1.0)
        };
        let gap = pen.width_mm * (0.95 / face.shade).clamp(1.5, 4.5);
        let tall = high.y - low.y;
        let mut x = low.x - slant.x * tall;
        while x < high.x {
            let from = Vec2::new(x, low.y);
            let parts = (tall / 0.1).ceil().max(2.0) as usize;
            let path: Vec<(Vec2, f32)> = (0..=parts)
                .map(|i| from + slant * tall * i as f32 / parts as f32)
                .filter(|&p| inside(&face.outline, p))
                .map(|p| (p, self.distance_m * 0.998))
                .collect();
            for run in view.visible_runs(&path) {
                hand.line(pen, &run);
            }
            x += gap * hand.chance.between(0.75, 1.25);
        }
    }

    fn windows(&self, hand: &mut Hand, view: &View, face: &Face, pen: Pen) {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| face.outline[i]);
        let (wide, tall) = (b.distance(c), a.distance(b));
        if wide < 1.1 || tall < 1.6 {
            return;
        }
        let (columns, rows) = ((wide / 1.0) as usize, (tall / 1.8) as usize);
        for column in 0..columns {
            for row in 0..rows {
                if hand.chance.happens(0.6) {
                    continue;
                }
                let u = (column as f32 + 0.5) / columns as f32;
                let v = mix(0.92, 0.35, (row as f32 + 0.5) / rows.max(1) as f32);
                let p = a.lerp(d, u).lerp(b.lerp(c, u), v);
                let q = p + Vec2::new(0.0, 0.32);
                self.seen(hand, view, pen.scaled(1.25), p, q);
            }
        }
    }
}

/// The fortified town, the church below it, farms in the plain.
pub fn build(view: &mut View) -> Vec<Building> {
    let mut chance = Chance::new(51);
    let mut blocks = Vec::new();
    let mut block = |x: f32, y: f32, size: [f32; 3], yaw: f32, roof: Roof| {
        let [wide, deep, high] = size;
        blocks.push((
            x,
            y,
            Block {
                at: Vec3::ZERO,
                wide,
                deep,
                high,
                yaw,
                roof,
            },
        ));
    };
    let (tx, ty) = (TOWN_M.x, TOWN_M.y);
    // The keep and its towers.
    block(
        tx + 2.0,
        ty + 4.0,
        [15.0, 15.0, 38.0],
        0.22,
        Roof::Battlements,
    );
    block(tx - 17.0, ty + 10.0, [9.0, 9.0, 29.0], 0.1, Roof::Pyramid);
    block(
        tx + 24.0,
        ty + 12.0,
        [8.0, 8.0, 33.0],
        0.3,
        Roof::Battlements,
    );
    block(tx + 10.0, ty + 22.0, [24.0, 14.0, 20.0], 0.2, Roof::Gable);
    // Houses crowded behind the wall.
    for i in 0..17 {
        let angle = std::f32::consts::PI * (1.02 + 0.96 * i as f32 / 16.0);
        let radius = chance.between(20.0, 42.0);
        let p =
            Vec2::new(tx, ty) + Vec2::from_angle(angle) * Vec2::new(radius * 1.15, radius * 0.8);
        let size = [
            chance.between(8.0, 13.0),
            chance.between(7.0, 10.0),
            chance.between(6.0, 12.0),
        ];
        block(p.x, p.y, size, 0.5 * chance.centred() + 0.15, Roof::Gable);
    }
    // The wall with its towers, and the gate.
    for i in 0..11 {
        let angle = std::f32::consts::PI * (0.98 + 1.04 * i as f32 / 10.0);
        let next = std::f32::consts::PI * (0.98 + 1.04 * (i as f32 + 0.5) / 10.0);
        let on = |a: f32, r: f32| {
            Vec2::new(tx, ty) + Vec2::from_angle(a) * Vec2::new(r * 1.12, r * 0.86)
        };
        let p = on(angle, 56.0);
        let high = if i % 3 == 0 { 21.0 } else { 14.0 };
        let roof = if i % 4 == 1 {
            Roof::Pyramid
        } else {
            Roof::Battlements
        };
        block(p.x, p.y, [7.5, 7.5, high], 0.3 * chance.centred(), roof);
        if i < 10 {
            let m = on(next, 55.0);
            let tangent = on(next + 0.05, 55.0) - on(next - 0.05, 55.0);
            let yaw = tangent.y.atan2(tangent.x);
            block(m.x, m.y, [19.0, 2.5, 8.5], yaw, Roof::Battlements);
        }
    }
    // A church at the foot of the hill, and farms.
    block(96.0, 430.0, [9.0, 20.0, 10.0], 0.35, Roof::Gable);
    block(104.0, 438.0, [6.0, 6.0, 25.0], 0.35, Roof::Pyramid);
    for [x, y] in [
        [80.0, 452.0],
        [118.0, 424.0],
        [-52.0, 470.0],
        [-64.0, 486.0],
        [-40.0, 500.0],
        [-120.0, 690.0],
        [-104.0, 706.0],
        [38.0, 640.0],
        [60.0, 655.0],
        [300.0, 700.0],
        [322.0, 716.0],
        [-210.0, 900.0],
        [-190.0, 915.0],
        [120.0, 1010.0],
        [145.0, 1020.0],
    ] {
        let size = [
            chance.between(9.0, 14.0),
            chance.between(8.0, 11.0),
            chance.between(5.0, 8.0),
        ];
        block(x, y, size, 0.7 * chance.centred(), Roof::Gable);
    }
    for [x, y, high] in [
        [-46.0, 492.0, 19.0],
        [-112.0, 712.0, 26.0],
        [132.0, 1030.0, 34.0],
        [-205.0, 925.0, 30.0],
    ] {
        block(x, y, [5.5, 5.5, high], 0.2, Roof::Pyramid);
    }
    let placed = blocks.into_iter().map(|(x, y, block)| {
        let at = view.on_ground(x, y);
        Building::build(view, &Block { at, ..block })
    });
    placed.collect()
}

/// Draws the buildings from the nearest to the farthest.
pub fn draw(hand: &mut Hand, view: &View, buildings: &[Building]) {
    for building in buildings {
        let weight = if building.distance_m > 600.0 {
            1.0
        } else {
            0.9
        };
        building.draw(hand, view, weight);
    }
}
