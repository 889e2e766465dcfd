//! The rough interface as light meets it: a random walk on the facets.
//!
//! A Smith surface of GGX facets on which light bounces as often as it likes (Heitz, Hanika,
//! d'Eon, Dachsbacher 2016): nothing is lost, whatever the roughness. A facet's height enters
//! only as the share `u` of facets that lie below it, so the result does not depend on the
//! distribution of heights.
//!
//! Directions are those of travel, z towards the air: light that comes from the air has z < 0.

use glam::DVec3;

use super::rng::{Rng, exponential, turn, uniform};
use crate::optics::{fresnel::fresnel_dielectric, microfacet::d_ggx};

/// Roughness below which the interface is smooth (OPTICS.md, numeric trap 5).
pub const ALPHA_SMOOTH: f64 = 1e-3;

/// Indices nearer than this match: less than 10⁻⁸ is reflected.
const INDEX_MATCHED: f64 = 1e-4;

/// ln u is kept above this, so that a ray deep among the facets still comes out.
pub(super) const LN_U_MIN: f64 = -700.0;

/// A dielectric interface towards air, with GGX facets.
#[derive(Clone, Copy, Debug)]
pub struct Interface {
    /// Refractive index inside over outside, > 1 for paper.
    pub n: f64,
    /// GGX roughness α in [0, 1]; smooth below [`ALPHA_SMOOTH`].
    pub alpha: f64,
}

/// A ray among the facets, in the frame of the medium it is in: z points out of that medium's
/// side, so that inside the sheet everything is upside down (Heitz et al. 2016, §5.2).
struct Ray {
    /// Direction of travel.
    w: DVec3,
    /// Logarithm of the share of facets below the ray, ≤ 0.
    ln_u: f64,
    in_air: bool,
}

impl Ray {
    fn new(w: DVec3) -> Self {
        let in_air = w.z < 0.0;
        Self {
            w: if in_air { w } else { -w },
            ln_u: 0.0,
            in_air,
        }
    }

    /// Ln of the share of facets below the ray as seen from the other medium: ln(1 − u).
    fn ln_u_beyond(&self) -> f64 {
        (-self.ln_u.exp_m1()).ln().max(LN_U_MIN)
    }

    /// The direction in the interface's frame.
    fn outward(&self) -> DVec3 {
        if self.in_air { self.w } else { -self.w }
    }
}

impl Interface {
    /// Whether reflection and refraction are those of a plane. So they are, whatever the
    /// facets, where the indices match; and there a grazing ray, which nothing turns, would
    /// meet a billion facets.
    pub fn is_smooth(&self) -> bool {
        self.alpha < ALPHA_SMOOTH || (self.n - 1.0).abs() < INDEX_MATCHED
    }

    /// Index ratio of the medium behind the facet over that in front of it.
    fn eta(&self, in_air: bool) -> f64 {
        if in_air { self.n } else { 1.0 / self.n }
    }

    /// Where light travelling along `w` goes, each way as likely as the share of energy that
    /// takes it: into the air where the result's z > 0, inside where it is < 0.
    pub fn scatter(&self, w: DVec3, rng: &mut Rng) -> DVec3 {
        if self.is_smooth() {
            return self.scatter_smooth(w, rng);
        }
        let mut ray = Ray::new(w);
        while self.reach_facet(&mut ray, rng) {
            self.bounce(&mut ray, rng);
        }
        ray.outward()
    }

    fn scatter_smooth(&self, w: DVec3, rng: &mut Rng) -> DVec3 {
        let eta = self.eta(w.z < 0.0);
        let cos_i = w.z.abs();
        if uniform(rng) < fresnel_dielectric(cos_i, eta) {
            return DVec3::new(w.x, w.y, -w.z);
        }
        let (x, y) = (w.x / eta, w.y / eta);
        // At least the smallest positive cosine, so that the sign tells the side.
        let z = (1.0 - x * x - y * y).max(f64::MIN_POSITIVE).sqrt();
        DVec3::new(x, y, z.copysign(w.z))
    }

    /// Density, per steradian, of light travelling along `w` that leaves along `out`: the BSDF
    /// times the cosine of `out`. A random number whose mean is that density; 0 where the
    /// interface is smooth, as the density is then a mirror's.
    ///
    /// At each facet on the way, its phase function towards `out` times the chance to get away
    /// unhindered (Heitz et al. 2016, §5.3).
    pub fn evaluate(&self, w: DVec3, out: DVec3, rng: &mut Rng) -> f64 {
        if self.is_smooth() || out.z == 0.0 {
            return 0.0;
        }
        let mut ray = Ray::new(w);
        let mut sum = 0.0;
        while self.reach_facet(&mut ray, rng) {
            let to = if ray.in_air { out } else { -out };
            let (away, ln_u) = if to.z > 0.0 {
                (to, ray.ln_u)
            } else {
                (-to, ray.ln_u_beyond())
            };
            let unhindered = (ln_u * self.projected(-away) / away.z).exp();
            sum += self.facet_phase(-ray.w, to, ray.in_air) * unhindered;
            self.bounce(&mut ray, rng);
        }
        sum
    }

    /// As [`Interface::evaluate`] for facets of metal, which let nothing in: `fresnel` is what one
    /// of them reflects, by the cosine of the light on it.
    pub fn evaluate_opaque<const C: usize>(
        &self,
        w: DVec3,
        out: DVec3,
        fresnel: impl Fn(f64) -> [f64; C],
        rng: &mut Rng,
    ) -> [f64; C] {
        let mut sum = [0.0; C];
        if self.is_smooth() || out.z <= 0.0 {
            return sum;
        }
        let mut ray = Ray::new(w);
        let mut weight = [1.0; C];
        while self.reach_facet(&mut ray, rng) {
            let from = -ray.w;
            let h = (from + out).normalize_or_zero();
            if h.z > 0.0 {
                let density = d_ggx(h.x * h.x + h.y * h.y, self.alpha) / self.projected(from) / 4.0;
                let unhindered = (ray.ln_u * self.projected(-out) / out.z).exp();
                let reflected = fresnel(from.dot(h));
                for channel in 0..C {
                    sum[channel] += weight[channel] * reflected[channel] * density * unhindered;
                }
            }
            let h = self.visible_facet(from, rng);
            let cos = from.dot(h).clamp(0.0, 1.0);
            let reflected = fresnel(cos);
            for channel in 0..C {
                weight[channel] *= reflected[channel];
            }
            ray.w = (2.0 * cos * h + ray.w).normalize();
        }
        sum
    }

    /// Area of facets, by that of the surface, that are seen from `w`: ∫ D(h) (w·h)⁺ dh
    /// (Heitz et al. 2016, eq. 7). Λ(w) = σ(−w)/w.z.
    pub fn projected(&self, w: DVec3) -> f64 {
        let sin2 = w.x * w.x + w.y * w.y;
        let a2_sin2 = self.alpha * self.alpha * sin2;
        let root = (w.z * w.z + a2_sin2).sqrt();
        if w.z >= 0.0 {
            0.5 * (w.z + root)
        } else {
            // Seen from below: without the difference of two near numbers.
            0.5 * a2_sin2 / (root - w.z)
        }
    }

    /// Moves the ray to the next facet; false where it escapes (Heitz et al. 2016, eq. 13).
    fn reach_facet(&self, ray: &mut Ray, rng: &mut Rng) -> bool {
        let seen = self.projected(-ray.w);
        // Straight up, no facet is seen.
        if seen <= 0.0 {
            return false;
        }
        let ln_u = ray.ln_u + exponential(rng) * ray.w.z / seen;
        if ln_u >= 0.0 {
            return false;
        }
        ray.ln_u = ln_u.max(LN_U_MIN);
        true
    }

    /// Reflection or refraction at a visible facet.
    fn bounce(&self, ray: &mut Ray, rng: &mut Rng) {
        let to_ray = -ray.w;
        let h = self.visible_facet(to_ray, rng);
        let cos_i = to_ray.dot(h).clamp(0.0, 1.0);
        let eta = self.eta(ray.in_air);
        if uniform(rng) < fresnel_dielectric(cos_i, eta) {
            ray.w = (2.0 * cos_i * h + ray.w).normalize();
            return;
        }
        let cos_t = (1.0 - (1.0 - cos_i * cos_i) / (eta * eta)).max(0.0).sqrt();
        let refracted = ray.w / eta + (cos_i / eta - cos_t) * h;
        *ray = Ray {
            w: -refracted.normalize(),
            ln_u: ray.ln_u_beyond(),
            in_air: !ray.in_air,
        };
    }

    /// A facet, with the density of those that are seen from `w`, also from below: in the
    /// frame where the facets are those of a sphere, directions of reflection are uniform
    /// (Dupuy & Benyoub 2023, listing 3).
    pub fn visible_facet(&self, w: DVec3, rng: &mut Rng) -> DVec3 {
        let alpha = self.alpha;
        let v = DVec3::new(alpha * w.x, alpha * w.y, w.z).normalize();
        let (cos_phi, sin_phi, u) = turn(rng);
        // The half vector's z first: positive without cancellation.
        let h_z = u * (1.0 + v.z);
        let c_z = h_z - v.z;
        let sin = (1.0 - c_z * c_z).max(0.0).sqrt();
        DVec3::new(
            alpha * (sin * cos_phi + v.x),
            alpha * (sin * sin_phi + v.y),
            h_z.max(f64::MIN_POSITIVE),
        )
        .normalize()
    }

    /// Density of one bounce from a facet seen from `from` (a direction away from it) towards
    /// `to`, in the frame of the medium the ray is in: `to.z` < 0 is refraction
    /// (Heitz et al. 2016, eq. 29; Jacobians of Walter et al. 2007, eq. 14 and 17).
    fn facet_phase(&self, from: DVec3, to: DVec3, in_air: bool) -> f64 {
        let eta = self.eta(in_air);
        let density = |h: DVec3| d_ggx(h.x * h.x + h.y * h.y, self.alpha) / self.projected(from);
        if to.z > 0.0 {
            let h = (from + to).normalize_or_zero();
            if h.z <= 0.0 {
                return 0.0;
            }
            return density(h) * fresnel_dielectric(from.dot(h), eta) / 4.0;
        }
        let sum = from + eta * to;
        let h = sum.normalize_or_zero();
        let h = if h.z < 0.0 { -h } else { h };
        let (cos_i, cos_t) = (from.dot(h), to.dot(h));
        if h.z <= 0.0 || cos_i <= 0.0 || cos_t >= 0.0 {
            return 0.0;
        }
        let transmitted = 1.0 - fresnel_dielectric(cos_i, eta);
        density(h) * cos_i * transmitted * eta * eta * -cos_t / sum.length_squared()
    }
}
