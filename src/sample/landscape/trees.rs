//! Trees: trunks that branch, and crowns of looping flicks and curved hatching.

use glam::Vec2;

use super::{
    pens,
    view::{View, project, scale_at},
};
use crate::sample::{
    hand::{Hand, Pen, arc, inside},
    noise::{Chance, mix},
};

/// The habit of a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Habit {
    /// A wide crown.
    Round,
    /// A tall, narrow crown.
    Slender,
    /// Leafless.
    Bare,
}

/// Direction of the hatching in shaded foliage, in radians.
const SHADE_SLANT: f32 = -0.85;

/// Whether a place of a cushion is turned away from the light.
fn in_shade(lobe: &Lobe, p: Vec2) -> bool {
    let d = (p - lobe.centre) / lobe.radii;
    d.x * 0.75 + d.y > 0.12
}

/// A cushion of leaves.
struct Lobe {
    centre: Vec2,
    radii: Vec2,
}

impl Lobe {
    fn holds(&self, p: Vec2, shrink: f32) -> bool {
        ((p - self.centre) / (self.radii * shrink)).length_squared() < 1.0
    }
}

/// A limb from root to tip with its widths, in mm.
struct Limb {
    path: Vec<Vec2>,
    widths: (f32, f32),
}

/// One tree on the sheet.
pub struct Tree {
    distance_m: f32,
    height_mm: f32,
    foot: Vec2,
    limbs: Vec<Limb>,
    /// From the farthest to the nearest.
    lobes: Vec<Lobe>,
}

impl Tree {
    /// Plants a tree at a place of the land, `height_m` tall.
    pub fn plant(view: &mut View, x: f32, y: f32, height_m: f32, habit: Habit, seed: u64) -> Self {
        let foot = project(view.on_ground(x, y));
        let height_mm = height_m * scale_at(y);
        let mut chance = Chance::new(seed);
        let mut tree = Self {
            distance_m: y,
            height_mm,
            foot,
            limbs: Vec::new(),
            lobes: Vec::new(),
        };
        if height_mm > 12.0 || habit == Habit::Bare {
            let lean = Vec2::new(0.10 * chance.centred(), -1.0).normalize();
            let level = if height_mm > 30.0 { 3 } else { 2 };
            tree.grow(
                &mut chance,
                foot,
                lean,
                0.42 * height_mm,
                0.050 * height_mm,
                level,
                habit,
            );
        } else {
            tree.crown(&mut chance, habit);
        }
        tree.lobes.sort_by(|a, b| a.centre.y.total_cmp(&b.centre.y));
        for lobe in &tree.lobes {
            let shrunk = arc(lobe.centre, lobe.radii * 0.92, 0.0, std::f32::consts::TAU);
            view.stand(&shrunk, y);
            let shade = lobe.centre + lobe.radii * 0.3;
            view.darken(shade, lobe.radii * 1.05, 0.42);
        }
        for limb in &tree.limbs {
            if limb.widths.0 > 0.5 {
                view.stand(&limb.hull(), y);
            }
        }
        if habit != Habit::Bare {
            let cast = foot + Vec2::new(0.22, 0.02) * height_mm;
            view.darken(cast, Vec2::new(0.36, 0.06) * height_mm, 0.45);
        }
        tree
    }

    fn crown(&mut self, chance: &mut Chance, habit: Habit) {
        let h = self.height_mm;
        let (wide, count) = if habit == Habit::Slender {
            (0.15, 5)
        } else {
            (0.34, 6)
        };
        for i in 0..count {
            let up = 0.30 + 0.58 * (i as f32 + chance.unit()) / count as f32;
            let swell = (1.0 - (up - 0.55).abs() * 1.2).max(0.3);
            let aside = wide * swell * chance.centred() * 1.2;
            let radius = h * (0.13 + 0.07 * chance.unit()) * mix(0.8, 1.1, swell);
            self.lobes.push(Lobe {
                centre: self.foot + Vec2::new(aside, -up) * h,
                radii: Vec2::new(radius * 1.15, radius * 0.9),
            });
        }
        let top = self.foot - Vec2::new(0.0, 0.4 * h);
        self.limbs.push(Limb {
            path: vec![self.foot, top],
            widths: (0.05 * h, 0.03 * h),
        });
    }

    #[expect(clippy::too_many_arguments, reason = "the state of a growing limb")]
    fn grow(
        &mut self,
        chance: &mut Chance,
        from: Vec2,
        heading: Vec2,
        length: f32,
        width: f32,
        level: usize,
        habit: Habit,
    ) {
        let bend = heading.perp() * length * 0.16 * chance.centred();
        let tip = from + heading * length;
        let path = vec![
            from,
            from.lerp(tip, 0.35) + bend,
            from.lerp(tip, 0.7) + bend * 0.6,
            tip,
        ];
        self.limbs.push(Limb {
            path,
            widths: (width, width * 0.55),
        });
        let slender = habit == Habit::Slender;
        if level == 0 {
            if habit != Habit::Bare {
                self.leaves(chance, tip, heading, slender);
            }
            return;
        }
        let forks = 3 + usize::from(chance.happens(0.5));
        let spread = if slender { 0.5 } else { 1.0 };
        for i in 0..forks {
            let side = (i as f32 + 0.5) / forks as f32 * 2.0 - 1.0;
            let turn = side * spread * 0.95 + 0.3 * chance.centred();
            let aimed = Vec2::from_angle(turn).rotate(heading);
            // Limbs reach for the light.
            let aimed = (aimed - Vec2::new(0.0, 0.22)).normalize();
            let root = from.lerp(tip, chance.between(0.72, 1.0));
            let reach = length * chance.between(0.55, 0.74);
            self.grow(chance, root, aimed, reach, width * 0.55, level - 1, habit);
        }
        if habit != Habit::Bare && level < 3 {
            self.leaves(chance, from.lerp(tip, 0.85), heading, slender);
        }
    }

    fn leaves(&mut self, chance: &mut Chance, at: Vec2, heading: Vec2, slender: bool) {
        let h = self.height_mm;
        let radius = h * chance.between(0.045, 0.075);
        let aspect = if slender { 0.95 } else { 1.3 };
        let centre = at + heading * radius * 0.4 + Vec2::new(chance.centred(), 0.0) * radius * 0.6;
        self.lobes.push(Lobe {
            centre,
            radii: Vec2::new(radius * aspect, radius * 0.85),
        });
    }

    /// Draws it.
    pub fn draw(&self, hand: &mut Hand, view: &View) {
        let contour = pens::contour(self.distance_m);
        let hatch = pens::hatch(self.distance_m).scaled(0.9);
        for limb in &self.limbs {
            self.limb(hand, view, limb, contour, hatch);
        }
        for index in (0..self.lobes.len()).rev() {
            self.lobe(hand, view, index, hatch);
        }
        self.ground_shadow(hand, view, hatch);
    }

    fn free(&self, view: &View, p: Vec2, behind: usize) -> bool {
        view.shows(p, self.distance_m * 0.98)
            && self.lobes[behind.min(self.lobes.len())..]
                .iter()
                .all(|lobe| !lobe.holds(p, 0.82))
    }

    fn runs(&self, view: &View, path: &[Vec2], behind: usize) -> Vec<Vec<Vec2>> {
        let free = |p: &Vec2| self.free(view, *p, behind);
        path.chunk_by(|a, b| free(a) && free(b))
            .filter(|run| run.len() > 2)
            .map(<[Vec2]>::to_vec)
            .collect()
    }

    fn limb(&self, hand: &mut Hand, view: &View, limb: &Limb, contour: Pen, hatch: Pen) {
        let spine = crate::sample::hand::smooth(&limb.path);
        if limb.widths.0 < 0.45 {
            for run in self.runs(view, &spine, 0) {
                hand.line(contour.scaled(0.8).with_ends(1.0, 0.3), &run);
            }
            return;
        }
        let hull = limb.hull();
        let half = hull.len() / 2;
        for (edge, weight) in [(&hull[..half], 0.75), (&hull[half..], 1.15)] {
            for run in self.runs(view, edge, 0) {
                hand.line(contour.scaled(weight), &run);
            }
        }
        // Bark: hoops around the shaded side.
        let gap = (hatch.width_mm * 2.6).max(0.3);
        let length: f32 = spine.windows(2).map(|p| p[0].distance(p[1])).sum();
        let mut s = 0.3;
        while s < length {
            let i = ((s / length) * (half - 1) as f32) as usize;
            let (left, right) = (hull[i], hull[hull.len() - 1 - i]);
            let (left, right) = if left.x < right.x {
                (left, right)
            } else {
                (right, left)
            };
            let from = left.lerp(right, hand.chance.between(0.35, 0.62));
            let sag = from.midpoint(right) + Vec2::new(0.0, 0.18 * left.distance(right));
            if self.free(view, from, 0) && self.free(view, right, 0) {
                hand.curve(hatch.with_ends(0.4, 0.9), &[from, sag, right]);
            }
            s += gap * hand.chance.between(0.7, 1.5);
        }
    }

    /// Foliage as a pen makes it: broken rows of loops that swell around a cushion, open
    /// where light falls, and slanted hatching that binds the shaded cushions together.
    fn lobe(&self, hand: &mut Hand, view: &View, index: usize, pen: Pen) {
        let lobe = &self.lobes[index];
        let small = lobe.radii.y;
        let loop_mm = (0.17 * small).clamp(0.11, 0.42);
        let fine = pen.scaled(0.85).with_tremor(0.03);
        let rows = 4 + (1.5 * small) as usize;
        for row in 0..rows {
            let out = if row < 4 {
                hand.chance.between(0.82, 1.12)
            } else {
                hand.chance.between(0.2, 0.8)
            };
            // Around the rim first, then within; seldom along the shaded foot.
            let middle =
                3.9 + 1.9 * hand.chance.centred() + 0.4 * row as f32 * hand.chance.centred();
            let reach = hand.chance.between(0.25, 0.6);
            let turn = 0.3 * hand.chance.centred();
            let bow: Vec<Vec2> = arc(Vec2::ZERO, lobe.radii * out, middle - reach, middle + reach)
                .into_iter()
                .map(|p| lobe.centre + Vec2::from_angle(turn).rotate(p))
                .collect();
            let advance = loop_mm * hand.chance.between(1.5, 2.6);
            for run in self.runs(view, &bow, index + 1) {
                hand.loops(
                    fine.scaled(if row < 4 { 1.0 } else { 0.8 }),
                    &run,
                    loop_mm,
                    advance,
                );
            }
        }
        self.shade(hand, view, index, fine);
        // Leaves that leave the outline.
        for _ in 0..(2.0 + small * 2.2) as usize {
            let angle = hand.chance.between(0.0, std::f32::consts::TAU);
            let at =
                lobe.centre + lobe.radii * Vec2::from_angle(angle) * hand.chance.between(0.8, 1.15);
            let aim = Vec2::from_angle(angle + 0.9 * hand.chance.centred());
            let tip = at + aim * loop_mm * hand.chance.between(1.6, 3.4);
            let belly = at.midpoint(tip) + (tip - at).perp() * 0.3;
            if self.free(view, at, index + 1) && self.free(view, tip, index + 1) {
                hand.curve(fine.scaled(0.9).with_ends(1.0, 0.2), &[at, belly, tip]);
            }
        }
    }

    /// Slanted strokes over the lower right of a lobe, all of one direction.
    fn shade(&self, hand: &mut Hand, view: &View, index: usize, pen: Pen) {
        let lobe = &self.lobes[index];
        let outline = arc(lobe.centre, lobe.radii * 1.02, 0.0, std::f32::consts::TAU);
        let slant = Vec2::from_angle(SHADE_SLANT);
        let reach = lobe.radii.max_element() * 1.3;
        let gap = pen.width_mm * 2.3;
        let mut offset = -reach;
        while offset < reach {
            let through = lobe.centre + lobe.radii * Vec2::new(0.34, 0.30) + slant.perp() * offset;
            let from = -hand.chance.between(0.45, 0.75) * reach;
            let path: Vec<Vec2> = (0..=16)
                .map(|k| {
                    let t = k as f32 / 16.0;
                    through
                        + slant * mix(from, 0.9 * reach, t)
                        + slant.perp() * 0.06 * reach * (t * 3.0).sin()
                })
                .filter(|&p| inside(&outline, p) && in_shade(lobe, p))
                .collect();
            for run in self.runs(view, &path, index + 1) {
                hand.line(pen.with_ends(0.8, 0.3), &run);
            }
            offset += gap * hand.chance.between(0.7, 1.5);
        }
    }

    fn ground_shadow(&self, hand: &mut Hand, view: &View, pen: Pen) {
        let count = (self.height_mm * 0.8).clamp(2.0, 12.0) as usize;
        for i in 0..count {
            let length = self.height_mm * hand.chance.between(0.18, 0.45);
            let y = self.foot.y + 0.35 * i as f32 * (self.height_mm * 0.06).clamp(0.5, 1.4) * 0.5;
            let a = Vec2::new(self.foot.x - 0.1 * length + 0.4 * hand.chance.centred(), y);
            let b = a + Vec2::new(length, 0.12 * length);
            let path: Vec<(Vec2, f32)> = (0..=10)
                .map(|k| (a.lerp(b, k as f32 / 10.0), self.distance_m * 0.95))
                .collect();
            for run in view.visible_runs(&path) {
                hand.line(pen.with_ends(0.8, 0.25), &run);
            }
        }
    }
}

impl Limb {
    /// Its two edges as one closed line: down the left, back up the right.
    fn hull(&self) -> Vec<Vec2> {
        let spine = crate::sample::hand::smooth(&self.path);
        let last = spine.len() - 1;
        let edge = |i: usize, side: f32| {
            let along = (spine[(i + 1).min(last)] - spine[i.saturating_sub(1)]).normalize_or_zero();
            let t = i as f32 / last as f32;
            // The root of a trunk flares.
            let flare = 1.0 + 0.6 * (-t * 9.0).exp();
            spine[i] + along.perp() * side * 0.5 * mix(self.widths.0, self.widths.1, t) * flare
        };
        let mut hull: Vec<Vec2> = (0..=last).map(|i| edge(i, -1.0)).collect();
        hull.extend((0..=last).rev().map(|i| edge(i, 1.0)));
        hull
    }
}
