//! Opaque grains of metal or chalk as light meets them: GGX facets of a material n + ik, on which
//! light bounces as often as it likes, losing some at each bounce (Heitz, Hanika, d'Eon,
//! Dachsbacher 2016, §5.1).
//!
//! Directions are those of travel, z towards the air, as in [`super::interface`].

use glam::DVec3;

use super::{
    interface::{Interface, LN_U_MIN},
    rng::{Rng, exponential, uniform},
};
use crate::optics::{fresnel::fresnel_conductor, microfacet::d_ggx};

/// Weight below which light lives on by chance only.
const FAINT: f64 = 1e-2;

/// Facets of a material that lets no light through, in three channels.
#[derive(Clone, Copy, Debug)]
pub struct Conductor {
    facets: Interface,
    n: [f64; 3],
    k: [f64; 3],
}

impl Conductor {
    /// Facets of roughness `alpha` in (0, 1] and index `n` + i`k` per channel.
    pub fn new(alpha: f64, n: [f64; 3], k: [f64; 3]) -> Self {
        // The index of the facets' geometry is of no account.
        let facets = Interface { n: 1.5, alpha };
        Self { facets, n, k }
    }

    fn reflectance(&self, cos_i: f64) -> DVec3 {
        let channel = |c: usize| fresnel_conductor(cos_i, self.n[c], self.k[c]);
        DVec3::new(channel(0), channel(1), channel(2))
    }

    /// Calls `at_facet` with each facet's weight, logarithm of the height's share and direction
    /// towards the ray; gives the direction in which light leaves, and what is left of it.
    fn walk(
        &self,
        w: DVec3,
        rng: &mut Rng,
        mut at_facet: impl FnMut(DVec3, f64, DVec3),
    ) -> Option<(DVec3, DVec3)> {
        let (mut w, mut ln_u, mut weight) = (w, 0.0, DVec3::ONE);
        loop {
            let seen = self.facets.projected(-w);
            // Straight up, no facet is seen.
            if seen <= 0.0 {
                return Some((w, weight));
            }
            ln_u = (ln_u + exponential(rng) * w.z / seen).max(LN_U_MIN);
            if ln_u >= 0.0 {
                return Some((w, weight));
            }
            at_facet(weight, ln_u, -w);
            let h = self.facets.visible_facet(-w, rng);
            let cos_i = -w.dot(h);
            weight *= self.reflectance(cos_i);
            let most = weight.max_element();
            if most < FAINT {
                if uniform(rng) * FAINT >= most {
                    return None;
                }
                weight *= FAINT / most;
            }
            w = (2.0 * cos_i * h + w).normalize();
        }
    }

    /// Where light travelling along `w` (z < 0) goes, and its weight per channel.
    pub fn scatter(&self, w: DVec3, rng: &mut Rng) -> Option<(DVec3, [f64; 3])> {
        let (w, weight) = self.walk(w, rng, |_, _, _| ())?;
        Some((w, weight.to_array()))
    }

    /// Density per steradian and channel of light travelling along `w` that leaves along `out`
    /// (z > 0): the BRDF times the cosine of `out`. A random number whose mean is that.
    pub fn evaluate(&self, w: DVec3, out: DVec3, rng: &mut Rng) -> [f64; 3] {
        let alpha = self.facets.alpha;
        let mut sum = DVec3::ZERO;
        // What is lost on the way has sent its share already.
        self.walk(w, rng, |weight, ln_u, from| {
            let h = (from + out).normalize_or_zero();
            if h.z <= 0.0 {
                return;
            }
            let facets = d_ggx(h.x * h.x + h.y * h.y, alpha) / self.facets.projected(from);
            let unhindered = (ln_u * self.facets.projected(-out) / out.z).exp();
            sum += weight * self.reflectance(from.dot(h)) * (0.25 * facets * unhindered);
        });
        sum.to_array()
    }
}
