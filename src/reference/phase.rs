//! Where fibres send light: two lobes of Henyey and Greenstein.

use std::f64::consts::PI;

use glam::DVec3;

use super::rng::{Rng, disc, uniform};

/// p = w_f HG(g_f) + (1 − w_f) HG(g_b), per steradian, ∫p = 1.
#[derive(Clone, Copy, Debug)]
pub struct Phase {
    /// Weight of the forward lobe, in [0, 1].
    pub w_f: f64,
    /// Mean cosine of the forward lobe, |g| ≤ .99.
    pub g_f: f64,
    /// Mean cosine of the backward lobe (negative where it points back), |g| ≤ .99.
    pub g_b: f64,
}

impl Phase {
    /// Light goes in all directions alike.
    pub const ISOTROPIC: Self = Self::single(0.0);

    /// One lobe.
    pub const fn single(g: f64) -> Self {
        Self {
            w_f: 1.0,
            g_f: g,
            g_b: g,
        }
    }

    /// Mean cosine g = w_f g_f + w_b g_b.
    pub fn mean_cosine(&self) -> f64 {
        self.w_f * self.g_f + (1.0 - self.w_f) * self.g_b
    }

    /// Density in sr⁻¹ at an angle of cosine `cos` between both directions of travel.
    #[inline]
    pub fn value(&self, cos: f64) -> f64 {
        let forward = henyey_greenstein(cos, self.g_f);
        if self.w_f == 1.0 {
            return forward;
        }
        self.w_f * forward + (1.0 - self.w_f) * henyey_greenstein(cos, self.g_b)
    }

    /// A direction of travel after `w`. Its length is 1 within rounding, which many
    /// scatterings add up; interfaces mend it.
    #[inline]
    pub fn sample(&self, w: DVec3, rng: &mut Rng) -> DVec3 {
        let forward = self.w_f == 1.0 || uniform(rng) < self.w_f;
        let g = if forward { self.g_f } else { self.g_b };
        // One point of the disc holds the azimuth and, in its radius, the angle.
        let (x, y, r_2) = disc(rng);
        let s = 1.0 - 2.0 * r_2;
        if g == 0.0 {
            let k = 2.0 * (1.0 - r_2).sqrt();
            return DVec3::new(k * x, k * y, s);
        }
        // cos = (1 + g² − t²)/2g, with the difference divided out by hand, so that small g
        // cost no digits.
        let inverse = 1.0 / (1.0 + g * s);
        let t = (1.0 - g * g) * inverse;
        let cos = 0.5 * (g + (s + g) * (1.0 + t) * inverse);
        let k = ((1.0 - cos * cos).max(0.0) / r_2).sqrt();
        let (e_x, e_y) = w.any_orthonormal_pair();
        cos * w + (k * x) * e_x + (k * y) * e_y
    }
}

#[inline]
fn henyey_greenstein(cos: f64, g: f64) -> f64 {
    let root = (1.0 + g * g - 2.0 * g * cos).sqrt();
    (1.0 - g * g) / (4.0 * PI * root * root * root)
}
