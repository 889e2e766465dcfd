//! Ink as a film in the paper, in arrays of lanes: [`crate::optics::ink`] in single precision.
//!
//! | symbol | meaning |
//! |---|---|
//! | τ | optical depth of the ink along the normal, by channel |
//! | `w` | τ/(1 + τ), of all channels together |
//! | P | effective path of light through a film of unit depth |

#![allow(
    clippy::needless_range_loop,
    reason = "several arrays run along one index, as their formulas do"
)]

use super::{
    block::{LANES, Lane, Lane3, MU_FLOOR},
    fit::WEIGHTS,
    response::Film,
};

/// The least share of the paper's light that a depth is told from: what is less is noise.
const SHARE_LEAST: f32 = 1e-3;
/// Steps towards a depth: each leaves about a tenth of what is missing.
const STEPS: usize = 3;

/// Ink at places whose normals are known so far.
pub struct Depth<'f> {
    film: &'f Film,
    pub tau: Lane3,
    /// By which all channels together fall with the path.
    pub grey: Lane,
    w: Lane,
    /// P(μ_o) − P_c
    beyond: Lane,
}

impl<'f> Depth<'f> {
    /// At places of this albedo, the surface's share taken out, seen at cosines `mu_o`.
    #[inline(always)]
    pub fn new(film: &'f Film, albedo: &Lane3, mu_o: &Lane) -> Self {
        let zero = [0.0; LANES];
        let mut depth = Self {
            film,
            tau: [zero; 3],
            grey: zero,
            w: zero,
            beyond: zero,
        };
        let [p0, p1, p2, p3] = film.capture;
        let mut light = zero;
        for c in 0..3 {
            for lane in 0..LANES {
                let body = albedo[c][lane].max(0.0);
                let x = (body / film.bare[c].max(1e-4)).clamp(SHARE_LEAST, 1.0);
                let u = x.sqrt();
                let mut excess = 0.0;
                for term in film.excess.iter().rev() {
                    excess = excess * u + term[c];
                }
                let crossed = (-x.ln() - excess).max(0.0);
                let mut tau = crossed / p0.max(2.0);
                for _ in 0..STEPS {
                    let w = tau / (1.0 + tau);
                    tau = crossed / (p0 + w * (p1 + w * (p2 + w * p3))).max(2.0);
                }
                depth.tau[c][lane] = tau;
                let weight = WEIGHTS[c] * body;
                depth.grey[lane] += weight * tau;
                light[lane] += weight;
            }
        }
        for lane in 0..LANES {
            let tau = depth.grey[lane] / light[lane].max(1e-9);
            let w = tau / (1.0 + tau);
            depth.grey[lane] = tau;
            depth.w[lane] = w;
            depth.beyond[lane] = -(p0 + w * (p1 + w * (p2 + w * p3)));
        }
        let out = depth.path(mu_o);
        for lane in 0..LANES {
            depth.beyond[lane] += out[lane];
        }
        depth
    }

    /// P at these cosines.
    #[inline(always)]
    fn path(&self, mu: &Lane) -> Lane {
        let mut path = [0.0; LANES];
        let Film {
            paths,
            square,
            index,
            ..
        } = self.film;
        for lane in 0..LANES {
            let mu = mu[lane].clamp(MU_FLOOR, 1.0);
            let (x, w) = (mu.sqrt(), self.w[lane]);
            let mut sum = 0.0;
            for [a, b, c, d] in paths.iter().rev() {
                sum = sum * x + (a + w * (b + w * (c + w * d)));
            }
            path[lane] = (sum * index / (square + mu * mu).sqrt()).max(1.0);
        }
        path
    }

    /// P(μ_i) + P(μ_o) − P_c for light at cosines `mu`.
    #[inline(always)]
    pub fn beyond_capture(&self, mu: &Lane) -> Lane {
        let mut path = self.path(mu);
        for lane in 0..LANES {
            path[lane] += self.beyond[lane];
        }
        path
    }
}
