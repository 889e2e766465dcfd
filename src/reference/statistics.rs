//! Mean and variance, and the work shared out in blocks.

use rayon::prelude::*;

use super::rng::{Rng, stream};

/// Photons of one stream of random numbers; a unit of work for one thread.
const BLOCK: u64 = 2048;

/// A mean with its own variance (that of the mean, not of one sample).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    pub mean: f64,
    pub variance: f64,
}

impl Estimate {
    /// Standard deviation of the mean.
    pub fn deviation(&self) -> f64 {
        self.variance.sqrt()
    }

    /// The same quantity in another unit.
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            mean: self.mean * factor,
            variance: self.variance * factor * factor,
        }
    }
}

/// Sums of samples and of their squares.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sums {
    sum: f64,
    squares: f64,
}

impl Sums {
    #[inline]
    pub fn add(&mut self, sample: f64) {
        self.sum += sample;
        self.squares += sample * sample;
    }

    pub fn join(&mut self, other: &Self) {
        self.sum += other.sum;
        self.squares += other.squares;
    }

    /// Over `count` samples, of which those not added are 0.
    pub fn estimate(&self, count: u64) -> Estimate {
        let count = count.max(1) as f64;
        let mean = self.sum / count;
        let variance = (self.squares / count - mean * mean).max(0.0) / (count - 1.0).max(1.0);
        Estimate { mean, variance }
    }
}

/// Runs `block(count, rng)` on all cores until `photons` are shared out, and gives the results
/// in order: joined in that order, they do not depend on the number of threads.
pub fn in_blocks<T: Send>(
    photons: u64,
    seed: u64,
    block: impl Fn(u64, &mut Rng) -> T + Sync,
) -> Vec<T> {
    (0..photons.div_ceil(BLOCK))
        .into_par_iter()
        .map(|index| {
            let count = BLOCK.min(photons - index * BLOCK);
            block(count, &mut stream(seed, index))
        })
        .collect()
}
