//! Lobes of paper that are off by default: retro-reflection, sheen, and a gloss that spreads
//! more one way than across it. Reciprocal each.
//!
//! *Retro-reflection* turns a share of the gloss back: the lobe around the direction of the lamp
//! is the mirror's with the eye turned by 180° about the normal (the back vector of Belcour et
//! al. 2014). Its directional albedo is that of the gloss itself, so that no energy is added,
//! and to an eye on the normal both are one, so that the photograph at 45°/0° is kept.
//!
//! *Sheen* is Burley 2012's (1 − cosθd)⁵, in sr⁻¹, over everything else, which gets
//! (1 − s E(μi))(1 − s E(μo)) of the light, E the directional albedo of the lobe: as what lies
//! below gives back no more than it gets, neither does the whole.
//!
//! *Anisotropy* a stretches the facets by 1/√(1 − .9a) one way and shrinks them across by the
//! same (Burley 2012). What goes through the interface is read from the tables at the roughness
//! that the facets have towards each direction ([`alpha_towards`]); what that adds to a lossless
//! sheet, or takes from it, is bounded in tests/physics/lobes.rs.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_8, PI};

use glam::DVec3;

use super::{
    fresnel::fresnel_dielectric,
    microfacet::{ALPHA_MIN, d_ggx, d_ggx_anisotropic, v_smith, v_smith_anisotropic},
    table::{Interface, InterfaceMean},
    tier::{Facing, Surface},
};

/// Mean of [`sheen_albedo`] over the cosine-weighted hemisphere.
pub const SHEEN_MEAN: f64 = 0.011575;

/// Facets' stretch along the longer axis, ≥ 1, for an anisotropy in [0, 1].
pub fn stretch(anisotropy: f64) -> f64 {
    1.0 / (1.0 - 0.9 * anisotropy.clamp(0.0, 1.0)).sqrt()
}

/// The eye turned half a turn about the normal `n`.
pub fn turned(n: DVec3, v: DVec3) -> DVec3 {
    n * (2.0 * n.dot(v)) - v
}

/// One bounce off the facets, in sr⁻¹ without the cosine.
pub fn gloss_lobe(s: &Surface, g: &Facing) -> f64 {
    d_ggx(g.sin2_h, s.alpha) * v_smith(g.mu_i, g.mu_o, s.alpha) * fresnel_dielectric(g.cos_d, s.eta)
}

/// The same off facets that are `stretch` times as rough along x; `l` and `v` are unit vectors
/// in a frame whose z is the normal.
pub fn gloss_lobe_anisotropic(s: &Surface, stretch: f64, l: DVec3, v: DVec3) -> f64 {
    let alpha_x = (s.alpha * stretch).clamp(ALPHA_MIN, 1.0);
    let alpha_y = (s.alpha / stretch).max(ALPHA_MIN);
    let sum = l + v;
    let h = sum / sum.length().max(1e-6);
    let facets =
        d_ggx_anisotropic(h.x, h.y, alpha_x, alpha_y) * v_smith_anisotropic(l, v, alpha_x, alpha_y);
    facets * fresnel_dielectric(l.dot(h).clamp(0.0, 1.0), s.eta)
}

/// What combed facets mirror into a photograph at 45°/0° over what even ones of the same mean
/// roughness do: the mean over lamps all around.
pub fn combed_capture(alpha: f64, stretch: f64) -> f64 {
    let alpha_x = (alpha * stretch).clamp(ALPHA_MIN, 1.0);
    let alpha_y = (alpha / stretch).max(ALPHA_MIN);
    let sum: f64 = CAPTURE_WAYS
        .iter()
        .map(|[x, y]| combed_capture_at(alpha_x, alpha_y, *x, *y))
        .sum();
    let even = d_ggx(CAPTURE_SIN_H * CAPTURE_SIN_H, alpha) * v_smith(FRAC_1_SQRT_2, 1.0, alpha);
    0.25 * sum / even
}

/// Facets with the lamp at 45° in the direction (x, y), a unit vector.
pub fn combed_capture_at(alpha_x: f64, alpha_y: f64, x: f64, y: f64) -> f64 {
    let l = FRAC_1_SQRT_2 * DVec3::new(x, y, 1.0);
    d_ggx_anisotropic(x * CAPTURE_SIN_H, y * CAPTURE_SIN_H, alpha_x, alpha_y)
        * v_smith_anisotropic(l, DVec3::Z, alpha_x, alpha_y)
}

/// Unit vectors at 11.25, 33.75, 56.25 and 78.75°: a quarter of the lamps around, midpoints.
const CAPTURE_WAYS: [[f64; 2]; 4] = [
    [0.980_785_280_403_23, 0.195_090_322_016_13],
    [0.831_469_612_302_55, 0.555_570_233_019_60],
    [0.555_570_233_019_60, 0.831_469_612_302_55],
    [0.195_090_322_016_13, 0.980_785_280_403_23],
];
/// sin 22.5°
const CAPTURE_SIN_H: f64 = 0.382_683_432_365_09;

/// Roughness of even facets that reflect, all together, about as much from the unit vector `d`
/// (in a frame whose x is the longer axis) as combed ones: the slopes' spread towards it, for
/// d on the normal the mean of both axes. Within .025 of what falls on a dielectric of index
/// 1.5.
pub fn alpha_towards(alpha: f64, stretch: f64, d: DVec3) -> f64 {
    let x = (alpha * stretch).min(1.0);
    let y = alpha / stretch;
    let even = 0.5 * (x * x + y * y);
    (x * x * d.x * d.x + y * y * d.y * d.y + even * d.z * d.z).sqrt()
}

/// The gloss with the lobe `straight`, of which the share `retro` is turned back as `back`, and
/// the compensation for more than one bounce.
pub fn brdf_gloss(
    s: &Surface,
    straight: f64,
    back: f64,
    retro: f64,
    at_i: &Interface,
    at_o: &Interface,
    mean: &InterfaceMean,
) -> f64 {
    let lobe = straight + (back - straight) * retro;
    s.specular * lobe + mean.compensation * at_i.late * at_o.late
}

/// Directional albedo of the sheen of strength 1, within 4e-5.
pub fn sheen_albedo(mu: f64) -> f64 {
    let m = mu.clamp(0.0, 1.0);
    (((0.028865 * m - 0.138507) * m + 0.272453) * m - 0.251032) * m + 0.088484
}

/// The sheen of `strength` in sr⁻¹, without the cosine.
pub fn brdf_sheen(strength: f64, cos_d: f64) -> f64 {
    let m = (1.0 - cos_d).clamp(0.0, 1.0);
    strength * m * m * m * m * m
}

/// What the sheen leaves of the light that goes in at `mu_i` and comes out at `mu_o`.
pub fn under_sheen(strength: f64, mu_i: f64, mu_o: f64) -> f64 {
    (1.0 - strength * sheen_albedo(mu_i)) * (1.0 - strength * sheen_albedo(mu_o))
}

/// The albedo, photographed at 45°/0°, of what lies under a sheen.
pub fn albedo_under_sheen(strength: f64, albedo: DVec3) -> DVec3 {
    let own = PI * brdf_sheen(strength, FRAC_PI_8.cos());
    (albedo - own) / under_sheen(strength, FRAC_1_SQRT_2, 1.0)
}
