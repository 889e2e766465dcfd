//! Seeded chance and smooth noise: the only sources of irregularity of the sample exhibits.

use fastnoise_lite::{CellularReturnType, FastNoiseLite, FractalType, NoiseType};
use glam::Vec2;

/// A reproducible sequence of pseudo-random numbers (SplitMix64, Steele et al. 2014).
#[derive(Clone, Debug)]
pub struct Chance(u64);

impl Chance {
    /// The sequence of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5dee_ce66_d1ce_4e5b)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// In [low, high).
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// In [−1, 1), more often near 0.
    pub fn centred(&mut self) -> f32 {
        self.unit() + self.unit() - 1.0
    }

    /// True with this probability.
    pub fn happens(&mut self, probability: f32) -> bool {
        self.unit() < probability
    }

    /// Puts the items into a random order.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, (self.next() % (i as u64 + 1)) as usize);
        }
    }
}

/// Smooth noise over the plane, about −1…1.
pub struct Noise(FastNoiseLite);

impl Noise {
    /// Gradient noise whose coarsest features measure about `scale`, in the unit of the points.
    pub fn smooth(seed: i32, scale: f32, octaves: i32) -> Self {
        let mut noise = FastNoiseLite::with_seed(seed);
        noise.set_noise_type(Some(NoiseType::OpenSimplex2));
        noise.set_frequency(Some(1.0 / scale));
        if octaves > 1 {
            noise.set_fractal_type(Some(FractalType::FBm));
            noise.set_fractal_octaves(Some(octaves));
        }
        Self(noise)
    }

    /// Sharp crests and rounded valleys.
    pub fn ridged(seed: i32, scale: f32, octaves: i32) -> Self {
        let mut noise = Self::smooth(seed, scale, octaves);
        noise.0.set_fractal_type(Some(FractalType::Ridged));
        noise
    }

    /// Flat cells, each of one value.
    pub fn cells(seed: i32, scale: f32) -> Self {
        let mut noise = FastNoiseLite::with_seed(seed);
        noise.set_noise_type(Some(NoiseType::Cellular));
        noise.set_cellular_return_type(Some(CellularReturnType::CellValue));
        noise.set_frequency(Some(1.0 / scale));
        Self(noise)
    }

    /// The value at a point.
    pub fn at(&self, p: Vec2) -> f32 {
        self.0.get_noise_2d(p.x, p.y)
    }
}

/// 0 below `from`, 1 above `to`, smooth between.
pub fn smoothstep(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// `a` at 0, `b` at 1.
pub fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}
