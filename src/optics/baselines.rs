//! The baselines of the ladder: shading models of the lectures and of ISLe, so that what a
//! museum would lose or gain with them stands in the same table.
//!
//! # Symbols
//! | symbol | meaning |
//! |---|---|
//! | `n` | exponent of a cosine lobe, ≥ 0 |
//! | `m` | root mean square slope of the facets times √2; α is taken for it |
//! | `off` | 1 − r·v: how far the eye is from the mirrored light, in [0, 2] |
//!
//! Sources: Phong 1975; Blinn 1977; Cook & Torrance 1982; Lafortune & Willems 1994; Oren & Nayar
//! 1994; Burley 2012; Apollonio et al. 2021 (ISLe). Each BRDF is in sr⁻¹ without the cosine, a
//! Lambertian term with the photographed albedo plus a lobe whose strength is the surface's
//! reflectance at normal incidence times `specular`.

use std::f64::consts::PI;

use glam::DVec3;

use super::{
    fresnel::fresnel_schlick,
    microfacet::{MU_MIN, d_ggx, v_smith},
    tier::{Facing, Surface},
};

/// The smallest base of a power, so that no logarithm is infinite.
pub const BASE_MIN: f64 = 1e-6;

/// Blinn's exponent of a surface of GGX or Beckmann roughness `alpha`: n = 2/α² − 2 (Walter et
/// al. 2007, §5.2).
pub fn exponent_blinn(alpha: f64) -> f64 {
    2.0 * (1.0 - alpha) * (1.0 + alpha) / (alpha * alpha)
}

/// Phong's exponent of the same highlight: his angle is twice the half vector's, hence n/4
/// (Fisher & Woo 1994).
pub fn exponent_phong(alpha: f64) -> f64 {
    0.25 * exponent_blinn(alpha)
}

/// (1 − x)ⁿ for x in [0, 1], n ≥ 0; the base is floored at 1e-6.
pub fn power_below_one(x: f64, n: f64) -> f64 {
    let decay = -(-x.min(1.0 - BASE_MIN)).ln_1p();
    (-n * decay).exp()
}

/// θ² in rad² from sin²θ, θ in [0, π/2].
pub fn angle_squared(sin2: f64) -> f64 {
    sin2.clamp(0.0, 1.0).sqrt().asin().powi(2)
}

/// Gaussian distribution of facet normals in sr⁻¹, c·e^(−θ²/m²) (Cook & Torrance 1982, §3), for
/// `m` in (0, 1].
///
/// The paper leaves c open. Here ∫ D cosθ dω = 1 by 1/c = π ∫₀^(π/2) e^(−θ²/m²) sin 2θ dθ, which
/// is πm² times a polynomial in m² that fits the integral within 3e-4.
pub fn d_gauss(sin2_h: f64, m: f64) -> f64 {
    let w = m * m;
    let norm = ((-0.036954 * w + 0.249574) * w - 0.664818) * w + 1.0;
    (-angle_squared(sin2_h) / w).exp() / (PI * w * norm)
}

/// Blinn's distribution (n + 2)/(2π) cosⁿθ in sr⁻¹, normalised to ∫ D cosθ dω = 1.
pub fn d_blinn(sin2_h: f64, n: f64) -> f64 {
    (n + 2.0) / (2.0 * PI) * power_below_one(sin2_h, 0.5 * n)
}

/// Beckmann's distribution e^(−tan²θ/α²)/(πα² cos⁴θ) in sr⁻¹ (Walter et al. 2007, eq. 25).
pub fn d_beckmann(sin2_h: f64, alpha: f64) -> f64 {
    let cos2_h = (1.0 - sin2_h).max(BASE_MIN);
    let a2 = alpha * alpha;
    (-sin2_h / (cos2_h * a2)).exp() / (PI * a2 * cos2_h * cos2_h)
}

/// G/(4 μi μo) with the masking of V-grooves, G = min(1, 2 cosθh μo/cosθd, 2 cosθh μi/cosθd)
/// (Cook & Torrance 1982, §3). The prefactor is 1/4, not their 1/π: their D is not normalised
/// as here.
pub fn v_groove(g: &Facing) -> f64 {
    let cos_h = (1.0 - g.sin2_h).max(0.0).sqrt();
    let open = 2.0 * cos_h / g.cos_d.max(MU_MIN);
    0.25 * (open * g.mu_i.min(g.mu_o)).min(1.0) / (g.mu_i * g.mu_o)
}

/// 1 − r·v from unit vectors, r the light mirrored at the normal: half the square of their
/// distance, which does not cancel where they meet.
pub fn off_mirror(n: DVec3, l: DVec3, v: DVec3) -> f64 {
    let apart = 2.0 * n.dot(l) * n - l - v;
    0.5 * apart.dot(apart)
}

/// (r·v)ⁿ where the eye is on the mirrored light's side, else 0.
pub fn lobe_phong(off: f64, n: f64) -> f64 {
    if off < 1.0 {
        power_below_one(off, n)
    } else {
        0.0
    }
}

/// Phong's shading as a quotient of radiance and irradiance. His highlight does not go with the
/// cosine of the light, hence 1/μi: neither reciprocal nor bounded in energy, so no BRDF.
pub fn brdf_phong_plain(s: &Surface, g: &Facing, off: f64) -> DVec3 {
    let lobe = lobe_phong(off, exponent_phong(s.alpha)) / g.mu_i;
    (s.albedo + DVec3::splat(s.specular * s.f_normal * lobe)) / PI
}

/// Phong's lobe normalised, (n + 2)/(2π)(r·v)ⁿ (Lafortune & Willems 1994): at normal incidence
/// it reflects its strength, and reciprocally.
pub fn brdf_phong(s: &Surface, off: f64) -> DVec3 {
    let n = exponent_phong(s.alpha);
    let lobe = 0.5 * (n + 2.0) * lobe_phong(off, n);
    (s.albedo + DVec3::splat(s.specular * s.f_normal * lobe)) / PI
}

/// Blinn's shading as a quotient of radiance and irradiance: as [`brdf_phong_plain`], with the
/// half vector. No BRDF either.
pub fn brdf_blinn_phong_plain(s: &Surface, g: &Facing) -> DVec3 {
    let lobe = power_below_one(g.sin2_h, 0.5 * exponent_blinn(s.alpha)) / g.mu_i;
    (s.albedo + DVec3::splat(s.specular * s.f_normal * lobe)) / PI
}

/// Blinn-Phong normalised by (n + 2)(n + 4)/(8π(n + 2^(−n/2))): at normal incidence it reflects
/// its strength. (One of the lecture's slides prints 2^(n/2).)
pub fn brdf_blinn_phong(s: &Surface, g: &Facing) -> DVec3 {
    let n = exponent_blinn(s.alpha);
    let norm = (n + 2.0) * (n + 4.0) / (8.0 * (n + (-0.5 * n).exp2()));
    let lobe = norm * power_below_one(g.sin2_h, 0.5 * n);
    (s.albedo + DVec3::splat(s.specular * s.f_normal * lobe)) / PI
}

/// Cook-Torrance around the value `d` of a distribution: V-grooves, Schlick's Fresnel factor.
pub fn brdf_facets(s: &Surface, g: &Facing, d: f64) -> DVec3 {
    let lobe = d * v_groove(g) * fresnel_schlick(g.cos_d, s.f_normal);
    s.albedo / PI + DVec3::splat(s.specular * lobe)
}

/// Cook-Torrance with [`d_gauss`].
pub fn brdf_cook_torrance_gauss(s: &Surface, g: &Facing) -> DVec3 {
    brdf_facets(s, g, d_gauss(g.sin2_h, s.alpha))
}

/// Cook-Torrance with [`d_blinn`].
pub fn brdf_cook_torrance_blinn(s: &Surface, g: &Facing) -> DVec3 {
    brdf_facets(s, g, d_blinn(g.sin2_h, exponent_blinn(s.alpha)))
}

/// Cook-Torrance with [`d_beckmann`], as its authors recommend.
pub fn brdf_cook_torrance(s: &Surface, g: &Facing) -> DVec3 {
    brdf_facets(s, g, d_beckmann(g.sin2_h, s.alpha))
}

/// Oren & Nayar 1994, the qualitative model (eq. 30), with σ = α/√2: α is √2 times the facets'
/// root mean square slope. Its authors drop the inter-reflection of their full model here.
/// Written without angles: cos(φi − φo) sin α tan β = (l·v − μi μo)/max(μi, μo).
pub fn brdf_oren_nayar(s: &Surface, g: &Facing) -> DVec3 {
    let sigma_2 = 0.5 * s.alpha * s.alpha;
    let a = 1.0 - 0.5 * sigma_2 / (sigma_2 + 0.33);
    let b = 0.45 * sigma_2 / (sigma_2 + 0.09);
    let along = (2.0 * g.cos_d * g.cos_d - 1.0 - g.mu_i * g.mu_o).max(0.0);
    s.albedo / PI * (a + b * along / g.mu_i.max(g.mu_o))
}

/// Burley's diffuse term (Burley 2012, §5.3), whose roughness is √α.
pub fn brdf_burley(s: &Surface, g: &Facing) -> DVec3 {
    let f_90 = 0.5 + 2.0 * s.alpha.sqrt() * g.cos_d * g.cos_d;
    let at_i = 1.0 + (f_90 - 1.0) * fresnel_schlick(g.mu_i, 0.0);
    let at_o = 1.0 + (f_90 - 1.0) * fresnel_schlick(g.mu_o, 0.0);
    s.albedo / PI * (at_i * at_o)
}

/// The shader of Apollonio et al. 2021: Burley's diffuse term, GGX with height-correlated Smith
/// shadowing, Schlick. Its ink attenuates the paper by a factor that knows no direction
/// (Clapper & Yule 1953): that factor is in the photographed albedo.
pub fn brdf_isle(s: &Surface, g: &Facing) -> DVec3 {
    let lobe = d_ggx(g.sin2_h, s.alpha)
        * v_smith(g.mu_i, g.mu_o, s.alpha)
        * fresnel_schlick(g.cos_d, s.f_normal);
    brdf_burley(s, g) + DVec3::splat(s.specular * lobe)
}
