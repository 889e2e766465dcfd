//! Seeded random numbers: one stream for each block of photons, so that a result does not
//! depend on how many threads share the work.

use rand::{Rng as _, RngExt as _, SeedableRng as _, rngs::Xoshiro256PlusPlus};
use rand_distr::{Distribution as _, Exp1};

/// xoshiro256++ (Blackman & Vigna 2019).
pub type Rng = Xoshiro256PlusPlus;

/// The stream `index` of a `seed`; streams of one seed do not overlap in practice.
pub fn stream(seed: u64, index: u64) -> Rng {
    // Seed and index are mixed by a generator of their own, as neighbouring numbers are alike.
    let mixed = Rng::seed_from_u64(seed).next_u64();
    Rng::seed_from_u64(mixed ^ index.wrapping_mul(0x9e37_79b9_7f4a_7c15))
}

/// Uniform in [0, 1).
#[inline]
pub fn uniform(rng: &mut Rng) -> f64 {
    rng.random()
}

/// Exponential with mean 1.
#[inline]
pub fn exponential(rng: &mut Rng) -> f64 {
    Exp1.sample(rng)
}

/// A point of the unit disc, without its middle: (x, y, x² + y²).
#[inline]
pub fn disc(rng: &mut Rng) -> (f64, f64, f64) {
    loop {
        let x = 2.0 * uniform(rng) - 1.0;
        let y = 2.0 * uniform(rng) - 1.0;
        let r_2 = x * x + y * y;
        if r_2 <= 1.0 && r_2 > 0.0 {
            return (x, y, r_2);
        }
    }
}

/// A direction in the plane, as (cosine, sine), and an independent uniform number in (0, 1]:
/// the squared radius of a point of the disc, which does not depend on its angle
/// (Marsaglia 1972).
#[inline]
pub fn turn(rng: &mut Rng) -> (f64, f64, f64) {
    let (x, y, r_2) = disc(rng);
    let r = r_2.sqrt();
    (x / r, y / r, r_2)
}
