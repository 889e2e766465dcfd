//! The land: a height field in metres that nobody ever stood on.
//!
//! x to the right, y away from the viewer, z up. The eye stands at the origin, [`EYE_M`] above
//! the sea.

use glam::{Vec2, Vec3};

use crate::sample::noise::{Noise, mix, smoothstep};

/// Height of the eye, in m.
pub const EYE_M: f32 = 70.0;
/// Nearest and farthest ground that is looked at, in m.
pub const NEAR_M: f32 = 62.0;
pub const FAR_M: f32 = 12_000.0;
/// Level of the river above and below its falls, in m.
pub const UPPER_WATER_M: f32 = 13.0;
pub const LOWER_WATER_M: f32 = 0.0;
/// Distance of the falls, in m.
pub const FALLS_M: f32 = 205.0;
/// Where the bridge crosses the river, in m from the viewer.
pub const BRIDGE_M: f32 = 345.0;
/// Middle of the fortified hill: x, y and height in m.
pub const TOWN_M: Vec3 = Vec3::new(172.0, 560.0, 92.0);

/// Hills: x, y, height, radius in m.
const HILLS: [[f32; 4]; 9] = [
    [-430.0, 1000.0, 150.0, 260.0],
    [-160.0, 1250.0, 74.0, 190.0],
    [420.0, 1150.0, 130.0, 230.0],
    [90.0, 1700.0, 70.0, 260.0],
    [620.0, 1900.0, 240.0, 420.0],
    [-700.0, 2000.0, 210.0, 420.0],
    [-120.0, 2500.0, 120.0, 330.0],
    [330.0, 2700.0, 150.0, 380.0],
    [310.0, 420.0, 44.0, 95.0],
];

/// Buttresses of the bluff: distance of each front and how far it stands out, in m.
const BUTTRESSES: [[f32; 2]; 5] = [
    [126.0, 14.0],
    [150.0, 19.0],
    [178.0, 15.0],
    [200.0, 12.0],
    [224.0, 11.0],
];

/// What the ground is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ground {
    /// Bare rock.
    Rock,
    /// Meadow, field or wooded slope.
    Soil,
    /// Standing or falling water.
    Water,
}

/// The height field and its noises.
pub struct Terrain {
    swell: Noise,
    crag: Noise,
    blocks: Noise,
    cracks: Noise,
    ridge: Noise,
    bank: Noise,
}

impl Terrain {
    /// The one land of the sample exhibit.
    pub fn new() -> Self {
        Self {
            swell: Noise::smooth(11, 150.0, 3),
            crag: Noise::smooth(12, 26.0, 4),
            blocks: Noise::cells(13, 13.0),
            cracks: Noise::ridged(14, 17.0, 3),
            ridge: Noise::ridged(21, 2300.0, 5),
            bank: Noise::smooth(15, 38.0, 2),
        }
    }

    /// Middle of the river at a distance y.
    pub fn river_x(y: f32) -> f32 {
        let free = smoothstep(330.0, 620.0, y);
        let far = smoothstep(800.0, 1600.0, y);
        let meander = 52.0 * ((y - 345.0) / 118.0).sin() + 30.0 * ((y - 300.0) / 300.0).sin();
        8.0 + 0.02 * (y - FALLS_M) + free * meander - far * 120.0
    }

    /// Half the width of the river at a distance y.
    pub fn river_half_width(y: f32) -> f32 {
        if y < FALLS_M {
            13.0 + 0.22 * (FALLS_M - y)
        } else {
            9.5 + 0.012 * (y - FALLS_M)
        }
    }

    /// The bank at a distance y, on the left (−1) or the right (1) of the river.
    pub fn bank_x(&self, y: f32, side: f32) -> f32 {
        let middle = Self::river_x(y);
        let mut x = middle + side * Self::river_half_width(y);
        for _ in 0..4 {
            x -= side * self.river_gap(x, y);
        }
        x
    }

    fn river_gap(&self, x: f32, y: f32) -> f32 {
        let ragged = 2.6 * self.bank.at(Vec2::new(x, y)) * (y / 250.0).clamp(0.6, 2.0);
        (x - Self::river_x(y)).abs() - Self::river_half_width(y) + ragged
    }

    /// Depth inside the foot of the bluff, in m; negative in front of it. The bluff is a row of
    /// buttresses that step back into the valley, each with a front and a flank.
    fn bluff_depth(&self, p: Vec2) -> f32 {
        let y = p.y + 5.0 * self.bank.at(p * 0.8);
        let front: f32 = BUTTRESSES
            .iter()
            .map(|&[at, step]| step * smoothstep(at - 5.0, at + 5.0, y))
            .sum();
        let behind = 1.3 * (y - 246.0).max(0.0);
        -92.0 + front - behind - p.x
    }

    /// Height of the bluff's top over its foot at a distance y.
    fn bluff_top(y: f32) -> f32 {
        22.0 + 26.0 * smoothstep(132.0, 165.0, y) + 36.0 * smoothstep(168.0, 200.0, y)
            - 14.0 * smoothstep(212.0, 236.0, y)
    }

    /// Height of the ground, in m.
    pub fn height(&self, x: f32, y: f32) -> f32 {
        let p = Vec2::new(x, y);
        let terrace = smoothstep(FALLS_M - 1.5, FALLS_M + 1.0, y);
        let water = mix(LOWER_WATER_M, UPPER_WATER_M, terrace);
        let gap = self.river_gap(x, y);
        let plain = water + 1.2 + 2.5 * smoothstep(400.0, 900.0, y);
        let mut z = plain + self.swell.at(p) * 5.0 * smoothstep(240.0, 700.0, y);
        z += self.hills(p);
        z += self.near_bank(p);
        z = z.max(water + 1.0);
        let shore = smoothstep(0.0, 5.0 + 0.01 * y, gap);
        z = mix(water - 0.2, z, shore);
        let bluff = self.bluff_depth(p);
        if bluff > -14.0 {
            z = z.max(self.bluff(p, bluff, water));
        }
        if y > 1900.0 {
            z = z.max(self.mountains(p));
        }
        z
    }

    fn hills(&self, p: Vec2) -> f32 {
        let mut z = 0.0f32;
        for [x, y, height, radius] in HILLS {
            let r = p.distance(Vec2::new(x, y)) / radius;
            if r < 2.4 {
                z += height * (-1.6 * r * r).exp() * (1.0 + 0.22 * self.swell.at(p * 1.3));
            }
        }
        let r = p.distance(TOWN_M.truncate());
        if r < 300.0 {
            let rough = 16.0 * self.crag.at(p * 0.5) + 9.0 * self.blocks.at(p * 0.55);
            let crag = smoothstep(112.0, 46.0, r + rough) * 0.42;
            let slope = (-(r / 128.0).powi(2) * 1.3).exp() * 0.58;
            z += TOWN_M.z * (crag + slope);
        }
        z
    }

    /// The ground at the viewer's feet, to the right of the pool.
    fn near_bank(&self, p: Vec2) -> f32 {
        let rise = (p.x - 24.0 - 0.05 * (p.y - 100.0)).max(0.0);
        let back = 1.0 - smoothstep(165.0, 250.0, p.y + 6.0 * self.bank.at(p));
        let steps = 2.2 * self.crag.at(p * 1.2) + 4.2 * self.bank.at(p * 0.9);
        let ledge = 5.0 * smoothstep(0.15, 0.4, self.swell.at(p * 4.0));
        ((rise * 0.55).min(16.0 + 0.14 * rise) + (steps + ledge) * smoothstep(4.0, 20.0, rise))
            * back
    }

    fn bluff(&self, p: Vec2, depth: f32, foot: f32) -> f32 {
        let broken = 5.0 * self.crag.at(p) + 6.0 * self.blocks.at(p) + 2.6 * self.cracks.at(p);
        let s = depth + broken;
        // Beds of rock, each a cliff with a ledge above it.
        let bed = |from: f32| smoothstep(from, from + 3.0, s);
        let ledges = 0.10 * smoothstep(0.0, 40.0, s);
        let rise = 0.34 * bed(0.0) + 0.16 * bed(5.5) + 0.22 * bed(9.0) + 0.18 * bed(15.0) + ledges;
        foot + Self::bluff_top(p.y) * (1.0 + 0.16 * self.bank.at(p * 0.7)) * rise
            + 1.5 * self.crag.at(p * 2.6)
            + 0.9 * self.blocks.at(p * 3.1)
    }

    fn mountains(&self, p: Vec2) -> f32 {
        let rise = smoothstep(2600.0, 5600.0, p.y);
        // Where across the sheet a range stands highest.
        let across = p.x / p.y;
        let massif = (-((across + 0.05) / 0.20).powi(2)).exp()
            + 0.55 * (-((across - 0.42) / 0.13).powi(2)).exp()
            + 0.22;
        let crest = 0.5 + 0.5 * self.ridge.at(p);
        rise * massif * (130.0 + 820.0 * crest * crest)
    }

    /// Slope: change of height per metre in x and y, over a distance that suits the view.
    pub fn slope(&self, p: Vec2) -> Vec2 {
        let h = (0.0045 * p.y).max(0.5);
        let x = self.height(p.x + h, p.y) - self.height(p.x - h, p.y);
        let y = self.height(p.x, p.y + h) - self.height(p.x, p.y - h);
        Vec2::new(x, y) / (2.0 * h)
    }

    /// A number about −1…1 that is constant over one facet of rock.
    pub fn facet(&self, p: Vec2, z: f32) -> f32 {
        self.blocks
            .at(Vec2::new(p.x + 0.4 * p.y, 1.3 * z + 0.5 * p.y))
    }

    /// What lies here, given the slope.
    pub fn ground(&self, p: Vec2, slope: Vec2) -> Ground {
        let falls = (p.y - FALLS_M).abs() < 3.0;
        if self.river_gap(p.x, p.y) < 0.6 && (falls || slope.length() < 0.5) {
            return Ground::Water;
        }
        let near_rock = self.bluff_depth(p) > -4.0 || slope.length() > 0.95;
        if near_rock && p.y < 2600.0 {
            Ground::Rock
        } else {
            Ground::Soil
        }
    }
}
