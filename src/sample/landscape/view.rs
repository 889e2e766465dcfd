//! The land as seen from one place: what is visible at each place of the sheet, how far it is,
//! and how dark a draughtsman would make it.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::terrain::{EYE_M, FALLS_M, FAR_M, Ground, NEAR_M, Terrain};
use crate::sample::{
    grid::{Grid, Plane},
    hand::inside,
    noise::smoothstep,
};

/// Vanishing point of everything level and straight ahead, in mm on the sheet.
pub const VANISHING_MM: Vec2 = Vec2::new(146.0, 66.0);
/// Distance of the picture plane, in mm.
const FOCAL_MM: f32 = 255.0;
/// Samples of the view per mm.
const PER_MM: f32 = 4.0;
/// Relative growth of the distance from one sample of a column to the next.
const MARCH: f32 = 0.0022;
/// Direction to the sun: upper left, in front of the hills.
const SUN: Vec3 = Vec3::new(-0.60, -0.40, 0.64);
/// Depth differences below this share do not hide anything.
const DEPTH_SLACK: f32 = 1.012;

/// The view and everything that stands in it.
pub struct View {
    /// The land.
    pub terrain: Terrain,
    /// Distance of the land in m, ∞ for the sky.
    land: Plane,
    /// Distance of the nearest thing that was put into the land in m, ∞ where there is none.
    things: Plane,
    /// Darkness that the land asks for, 0 (paper) to 1.
    tone: Plane,
    /// Slope of the land behind every other sample, each way.
    slopes: Vec<Vec2>,
    coarse: Grid,
}

/// Where a place in the land appears on the sheet, in mm.
pub fn project(world_m: Vec3) -> Vec2 {
    let scale = FOCAL_MM / world_m.y;
    VANISHING_MM + Vec2::new(world_m.x, EYE_M - world_m.z) * scale
}

/// Millimetres on the sheet per metre at a distance.
pub fn scale_at(distance_m: f32) -> f32 {
    FOCAL_MM / distance_m
}

impl View {
    /// Looks at the land from the eye's place.
    pub fn new(size_mm: Vec2) -> Self {
        let terrain = Terrain::new();
        let (w, h) = ((size_mm.x * PER_MM) as usize, (size_mm.y * PER_MM) as usize);
        let grid = Grid::with_pixels(size_mm, w, h);
        let land = march(&terrain, grid);
        let things = Plane::filled(grid, f32::INFINITY);
        let coarse = Grid::with_pixels(size_mm, w / 2, h / 2);
        let tone = Plane::filled(grid, 0.0);
        let mut view = Self {
            terrain,
            land,
            things,
            tone,
            slopes: Vec::new(),
            coarse,
        };
        view.slopes = coarse.map(|p| {
            view.world(p)
                .map_or(Vec2::ZERO, |world| view.terrain.slope(world.truncate()))
        });
        let tone = Plane::from_fn(coarse, |p| view.shade(p)).blurred(0.5);
        view.tone = Plane::from_fn(grid, |p| tone.at(p));
        view
    }

    /// Distance of the land in m, ∞ for the sky.
    pub fn land(&self) -> &Plane {
        &self.land
    }

    /// Distance of the land at a place of the sheet, in m; ∞ for the sky.
    pub fn distance(&self, at: Vec2) -> f32 {
        self.land.nearest(at)
    }

    /// Place in the land that appears here; `None` for the sky.
    pub fn world(&self, at: Vec2) -> Option<Vec3> {
        let y = self.distance(at);
        let offset = (at - VANISHING_MM) / FOCAL_MM;
        y.is_finite()
            .then(|| Vec3::new(offset.x * y, y, EYE_M - offset.y * y))
    }

    /// Place on the ground at these coordinates.
    pub fn on_ground(&self, x: f32, y: f32) -> Vec3 {
        Vec3::new(x, y, self.terrain.height(x, y))
    }

    /// Whether something at this distance can be seen at this place of the sheet.
    pub fn shows(&self, at: Vec2, distance_m: f32) -> bool {
        let i = self.land.index(at);
        distance_m <= self.land.data[i].min(self.things.data[i]) * DEPTH_SLACK
    }

    /// Whether nothing stands in front of the land here.
    pub fn land_shows(&self, at: Vec2) -> bool {
        let i = self.land.index(at);
        self.things.data[i] > self.land.data[i] || self.things.data[i].is_infinite()
    }

    /// Darkness that the land asks for, 0…1.
    pub fn tone(&self, at: Vec2) -> f32 {
        self.tone.nearest(at)
    }

    /// Makes a place at least this dark in its middle, less towards the radii.
    pub fn darken(&mut self, at: Vec2, radii: Vec2, amount: f32) {
        self.each_within(at - radii, at + radii, |view, i, p| {
            let r = ((p - at) / radii).length();
            view.tone.data[i] = view.tone.data[i].max(amount * smoothstep(1.0, 0.3, r));
        });
    }

    /// Puts a closed silhouette at a distance into the land: it hides what is behind it.
    pub fn stand(&mut self, silhouette: &[Vec2], distance_m: f32) {
        let low = silhouette
            .iter()
            .copied()
            .reduce(Vec2::min)
            .unwrap_or_default();
        let high = silhouette
            .iter()
            .copied()
            .reduce(Vec2::max)
            .unwrap_or_default();
        self.each_within(low, high, |view, i, p| {
            if inside(silhouette, p) && distance_m < view.land.data[i] * DEPTH_SLACK {
                view.things.data[i] = view.things.data[i].min(distance_m);
            }
        });
    }

    fn each_within(
        &mut self,
        low: Vec2,
        high: Vec2,
        mut change: impl FnMut(&mut Self, usize, Vec2),
    ) {
        let grid = self.land.grid;
        let low = (low / grid.pitch_mm).max(Vec2::ZERO);
        let high = (high / grid.pitch_mm).max(Vec2::ZERO);
        for row in (low.y as usize)..((high.y as usize + 1).min(grid.height)) {
            for column in (low.x as usize)..((high.x as usize + 1).min(grid.width)) {
                change(self, row * grid.width + column, grid.centre(column, row));
            }
        }
    }

    /// The visible parts of a path whose points have distances in m.
    pub fn visible_runs(&self, path: &[(Vec2, f32)]) -> Vec<Vec<Vec2>> {
        let mut runs = vec![Vec::new()];
        for &(p, distance) in path {
            let open = runs.len() - 1;
            if self.shows(p, distance) {
                runs[open].push(p);
            } else if !runs[open].is_empty() {
                runs.push(Vec::new());
            }
        }
        runs.retain(|run| run.len() > 1);
        runs
    }

    /// Slope of the land that appears here.
    fn slope(&self, at: Vec2) -> Vec2 {
        let p = (at / self.coarse.pitch_mm).max(Vec2::ZERO);
        let column = (p.x as usize).min(self.coarse.width - 1);
        let row = (p.y as usize).min(self.coarse.height - 1);
        self.slopes[row * self.coarse.width + column]
    }

    /// Direction across the form at a place: the fall line as it appears on the sheet.
    pub fn fall_line(&self, at: Vec2) -> Option<Vec2> {
        let world = self.world(at)?;
        let slope = self.slope(at);
        let steep = slope.length().max(1e-3);
        let down = (-slope / steep).extend(-steep);
        let step = 0.004 * world.y;
        let moved = project(world + down * step / down.length());
        (moved - at).try_normalize()
    }

    /// Direction along the form at a place: level on the ground, as it appears on the sheet.
    pub fn level_line(&self, at: Vec2) -> Option<Vec2> {
        let world = self.world(at)?;
        let level = self.slope(at).perp().try_normalize()?;
        let moved = project(world + (level * 0.004 * world.y).extend(0.0));
        let line = (moved - at).try_normalize()?;
        Some(if line.x < 0.0 { -line } else { line })
    }

    /// What the ground is made of here.
    pub fn ground(&self, at: Vec2) -> Option<Ground> {
        let world = self.world(at)?.truncate();
        Some(self.terrain.ground(world, self.slope(at)))
    }

    fn shade(&self, at: Vec2) -> f32 {
        let Some(world) = self.world(at) else {
            return 0.0;
        };
        let slope = self.slope(at);
        if self.terrain.ground(world.truncate(), slope) == Ground::Water {
            return 0.03;
        }
        let normal = (-slope).extend(1.0).normalize();
        let sun = SUN.normalize();
        let lit = normal.dot(sun);
        let mut dark = 0.92 * smoothstep(0.88, -0.5, lit);
        if slope.length() > 0.75 {
            dark *= 1.0 + 0.35 * self.terrain.facet(world.truncate(), world.z);
        }
        if lit > 0.0 && self.in_shadow(world, sun) {
            dark = dark.max(0.40 + 0.3 * (1.0 - lit));
        }
        // Far things are paler: the air between.
        let air = (-(world.y - 150.0).max(0.0) / 3000.0).exp();
        (dark * air.max(0.48)).clamp(0.0, 1.0)
    }

    fn in_shadow(&self, from: Vec3, sun: Vec3) -> bool {
        let mut step = (0.012 * from.y).max(2.0);
        let mut p = from + sun * step;
        for _ in 0..12 {
            if self.terrain.height(p.x, p.y) > p.z + 0.6 {
                return true;
            }
            p += sun * step;
            step *= 1.25;
        }
        false
    }
}

/// Distance of the land behind every sample, column by column from the bottom upwards.
fn march(terrain: &Terrain, grid: Grid) -> Plane {
    let columns: Vec<Vec<f32>> = (0..grid.width)
        .into_par_iter()
        .map(|column| {
            let across = (grid.centre(column, 0).x - VANISHING_MM.x) / FOCAL_MM;
            let mut distances = vec![f32::INFINITY; grid.height];
            let mut highest = grid.height;
            let mut y = NEAR_M;
            while y < FAR_M && highest > 0 {
                let seen = project(Vec3::new(across * y, y, terrain.height(across * y, y)));
                let row = (seen.y / grid.pitch_mm.y).max(0.0) as usize;
                while highest > row {
                    highest -= 1;
                    distances[highest] = y;
                }
                // Finer where the falls drop within a step.
                let finer = if (y - FALLS_M).abs() < 6.0 { 0.3 } else { 1.0 };
                y *= 1.0 + MARCH * finer;
            }
            distances
        })
        .collect();
    let data = (0..grid.width * grid.height)
        .map(|i| columns[i % grid.width][i / grid.width])
        .collect();
    Plane { grid, data }
}
