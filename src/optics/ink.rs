//! Ink as an absorbing film between the paper and its surface (Williams & Clapper 1953), in the
//! form that a photograph calibrates.
//!
//! The film formula f = T(μi)T(μo) A(μi,τ)A(μo,τ) R_b/(π n² [1 − ρ(τ)R_b]), where A = e^(−τP(μ))
//! is what crosses the film (`refraction`; e^(−τ/μ′) under a smooth surface), has its slow
//! part, the bracket, in common with the photograph of the same spot at 45°/0°. So a tier
//! multiplies what the photograph shows by e^(−τ(P(μi) + P(μo) − P_c)), P_c the path in the
//! geometry of capture, and the optical depth τ alone has to be solved, from
//! x = (photographed albedo)/(that of the bare paper) = e^(−τP_c)(1 − r_i R_b)/(1 − ρ(τ)R_b).
//!
//! With u = √x, τP_c = −ln x − H(u), and H and ρ are smooth in u: polynomials of degree 6
//! through Chebyshev nodes. As P_c itself falls slowly with τ, τ is found in a few steps of
//! τ ← (τP_c)/P_c(τ).

use std::{f64::consts::FRAC_1_SQRT_2, sync::Arc};

use glam::{DVec3, DVec4};

use super::{
    quadrature::{chebyshev, through},
    refraction::{PathTable, WaysBack, crossed},
    table::InterfaceTable,
};

/// Coefficients over powers of u.
pub const FILM_TERMS: usize = 7;
/// Deeper films are as black.
pub const DEPTH_MAX: f64 = 20.0;
/// The share of the paper's light below which a photograph tells nothing more: τ = 20 or more.
pub const SHARE_MIN: f64 = 1e-20;
/// Steps of the integral over the hemisphere.
const STEPS: u32 = 64;
/// Steps towards a depth: each leaves about a tenth of what is missing.
const DEPTH_STEPS: u32 = 4;

/// Cosine inside a medium of index `eta` of a ray at cosine `mu` outside: μ′.
pub fn inner_cosine(mu: f64, eta: f64) -> f64 {
    // 1 − (1 − μ²)/n² would cancel, in f32, at grazing angles where n is near 1.
    ((eta - 1.0) * (eta + 1.0) + mu * mu).max(0.0).sqrt() / eta
}

/// Films over one paper, in fitted form.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// Coefficients of H(u) per channel.
    pub excess: [DVec3; FILM_TERMS],
    /// Coefficients of ρ(u) per channel.
    pub internal: [DVec3; FILM_TERMS],
    /// Coefficients of G(w), w = τ/(1 + τ): diffuse light crosses a film as e^(−τG).
    pub diffuse_path: DVec4,
    /// P of every direction and roughness.
    pub paths: Arc<PathTable>,
}

impl Film {
    /// Films on paper of index `n` (> 1) and roughness `alpha` under `interface`, whose boundary
    /// has the internal diffuse reflectance `r_i` and whose body, with its backing, reflects `r_b`
    /// per channel (R_b, each in [0, 1]). Depths over other roughnesses are those of `paths`; H, ρ
    /// and the diffuse path, which bend little with it, are those of this one.
    pub fn new(
        n: f64,
        alpha: f64,
        interface: &InterfaceTable,
        paths: Arc<PathTable>,
        r_i: f64,
        r_b: DVec3,
    ) -> Self {
        let internal = Internal::new(n, alpha, r_i);
        let capture = capture_path(&paths, alpha);
        let nodes = chebyshev::<FILM_TERMS>();
        let mut film = Self {
            excess: [DVec3::ZERO; FILM_TERMS],
            internal: [DVec3::ZERO; FILM_TERMS],
            diffuse_path: diffuse_path(interface, &paths, alpha),
            paths,
        };
        for channel in 0..3 {
            let r_b = r_b[channel].clamp(0.0, 1.0);
            let depths = nodes.map(|u| internal.depth(u * u, r_b, capture));
            let rho = depths.map(|depth| internal.reflectance(depth));
            let excess = through(
                &nodes,
                &rho.map(|rho| ((1.0 - rho * r_b) / (1.0 - r_i * r_b)).ln()),
            );
            let rho = through(&nodes, &rho);
            for k in 0..FILM_TERMS {
                film.excess[k][channel] = excess[k];
                film.internal[k][channel] = rho[k];
            }
        }
        film
    }
}

/// P_c: the path of both crossings in the geometry of capture, at 45° and 0°.
pub fn capture_path(paths: &PathTable, alpha: f64) -> DVec4 {
    paths.at(FRAC_1_SQRT_2, alpha) + paths.at(1.0, alpha)
}

/// τ per channel from the share of the bare paper's albedo that was photographed; in
/// [0, [`DEPTH_MAX`]], 0 where the spot is as light as the paper or lighter. `capture` is P_c of
/// the spot.
pub fn optical_depth(film: &Film, capture: DVec4, share: DVec3) -> DVec3 {
    let x = share.clamp(DVec3::splat(SHARE_MIN), DVec3::ONE);
    let excess = horner(&film.excess, x.powf(0.5));
    let crossed = (-x.map(f64::ln) - excess).max(DVec3::ZERO);
    let mut depth = crossed / capture.x;
    for _ in 0..DEPTH_STEPS {
        let w = depth / (1.0 + depth);
        let path = capture.x + w * (capture.y + w * (capture.z + w * capture.w));
        depth = crossed / path.max(DVec3::splat(2.0));
    }
    depth.min(DVec3::splat(DEPTH_MAX))
}

/// ρ per channel: what diffuse light from below gets back from the film and its boundary, by the
/// share of the bare paper's albedo that was photographed.
pub fn internal_reflectance(film: &Film, share: DVec3) -> DVec3 {
    let x = share.clamp(DVec3::ZERO, DVec3::ONE);
    horner(&film.internal, x.powf(0.5)).clamp(DVec3::ZERO, DVec3::ONE)
}

/// e^(−τ(P(μi) + P(μo) − P_c)): what a film of depth `tau` does along these paths beyond what
/// the photograph shows.
pub fn beyond_capture(tau: DVec3, capture: DVec4, path_i: DVec4, path_o: DVec4) -> DVec3 {
    let path = path_i + path_o - capture;
    let w = tau / (1.0 + tau);
    (-tau * (path.x + w * (path.y + w * (path.z + w * path.w)))).exp()
}

fn horner(coefficients: &[DVec3; FILM_TERMS], u: DVec3) -> DVec3 {
    coefficients
        .iter()
        .rev()
        .fold(DVec3::ZERO, |sum, c| sum * u + *c)
}

/// The boundary from inside.
struct Internal {
    /// Ways to it and back, and their shares of the diffuse light that sets out.
    ways: Vec<(f64, f64)>,
}

impl Internal {
    /// The boundary's ways, scaled to the diffuse reflectance `r_i` of its energy-preserving table.
    fn new(n: f64, alpha: f64, r_i: f64) -> Self {
        let back = WaysBack::new(alpha, n);
        let scaled = |(way, share): &(f64, f64)| (*way, share * r_i);
        Self {
            ways: back.ways.iter().map(scaled).collect(),
        }
    }

    /// ρ(τ) = ∫∫ e^(−τ(1/μ + 1/μ″)), weighted as the boundary sends diffuse light back.
    fn reflectance(&self, tau: f64) -> f64 {
        let back = |(way, share): &(f64, f64)| share * (-tau * way).exp();
        self.ways.iter().map(back).sum()
    }

    /// The depth τ of a film that leaves the share `x` of the light that comes back from paper of
    /// reflectance `r_b` along `capture`, by bisection: the share falls with τ.
    fn depth(&self, x: f64, r_b: f64, capture: DVec4) -> f64 {
        let share = |tau: f64| {
            crossed(capture, DVec3::splat(tau)).x * (1.0 - self.reflectance(0.0) * r_b)
                / (1.0 - self.reflectance(tau) * r_b)
        };
        let (mut low, mut high) = (0.0, 2.0 * DEPTH_MAX);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if share(middle) > x {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

/// Coefficients of G(w) with e^(−τG) = ∫T(μ)A(μ,τ)μ dμ / ∫T(μ)μ dμ.
fn diffuse_path(interface: &InterfaceTable, paths: &PathTable, alpha: f64) -> DVec4 {
    let directions: Vec<(f64, DVec4)> = (0..STEPS)
        .map(|i| {
            // Finer towards grazing light.
            let v = (f64::from(i) + 0.5) / f64::from(STEPS);
            let mu = v * v;
            (interface.at(mu, alpha).t * mu * v, paths.at(mu, alpha))
        })
        .collect();
    let all: f64 = directions.iter().map(|(weight, _)| weight).sum();
    let share = |tau: f64| {
        let lit = |(weight, path): &(f64, DVec4)| weight * crossed(*path, DVec3::splat(tau)).x;
        directions.iter().map(lit).sum::<f64>() / all
    };
    // G bends where hardly any light is left: the fit ends with the deepest film.
    let nodes = chebyshev::<4>().map(|v| v * DEPTH_MAX / (1.0 + DEPTH_MAX));
    DVec4::from_array(through(
        &nodes,
        &nodes.map(|w| {
            let tau = w / (1.0 - w);
            -share(tau).max(f64::MIN_POSITIVE).ln() / tau
        }),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: f64 = 1.5;
    const R_I: f64 = 0.5963;
    /// The fit's error in τ, of a film up to 4 deep; beyond, of τ itself.
    const DEPTH_FIT: f64 = 2e-3;
    /// The fit's error in ρ.
    const RHO_FIT: f64 = 4e-3;
    /// The fit's error in diffuse light, of what falls on the film.
    const SHARE_FIT: f64 = 2e-3;

    fn film(alpha: f64, r_b: DVec3) -> Film {
        let interface = InterfaceTable::at_roughness(alpha, N, 1.0);
        let paths = Arc::new(PathTable::at_roughness(alpha, N));
        Film::new(N, alpha, &interface, paths, R_I, r_b)
    }

    fn share(film: &Film, alpha: f64, tau: f64, r_b: f64) -> f64 {
        let internal = Internal::new(N, alpha, R_I);
        let capture = capture_path(&film.paths, alpha);
        crossed(capture, DVec3::splat(tau)).x * (1.0 - R_I * r_b)
            / (1.0 - internal.reflectance(tau) * r_b)
    }

    #[test]
    fn depth_is_found_again_from_the_photograph() {
        for alpha in [0.0, 0.4, 1.0] {
            for r_b in [0.05, 0.3, 0.7, 0.9, 0.97] {
                let film = film(alpha, DVec3::splat(r_b));
                let capture = capture_path(&film.paths, alpha);
                for tau in [0.0, 1e-4, 1e-3, 0.05, 0.3, 1.0, 2.0, 4.0, 8.0] {
                    let x = share(&film, alpha, tau, r_b);
                    let found = optical_depth(&film, capture, DVec3::splat(x)).x;
                    let off = (found - tau).abs() / tau.max(4.0) * 4.0;
                    assert!(off < DEPTH_FIT, "{alpha} {r_b} {tau}: {found}");
                    let rho = internal_reflectance(&film, DVec3::splat(x)).x;
                    let exact = Internal::new(N, alpha, R_I).reflectance(tau);
                    let off = (rho - exact).abs();
                    assert!(off < RHO_FIT, "{alpha} {r_b} {tau}: {rho} {exact}");
                }
            }
        }
    }

    #[test]
    fn bare_paper_and_what_is_lighter_carry_no_ink() {
        let film = film(0.4, DVec3::new(0.9, 0.8, 0.6));
        let capture = capture_path(&film.paths, 0.4);
        let depth = |x: f64| optical_depth(&film, capture, DVec3::splat(x));
        assert!(depth(1.0).max_element() < DEPTH_FIT);
        assert!(depth(7.0).max_element() < DEPTH_FIT);
        let off = (internal_reflectance(&film, DVec3::ONE) - R_I).abs();
        assert!(off.max_element() < RHO_FIT, "{off}");
        for x in [0.0, -1.0, 1e-300] {
            assert!(
                depth(x).min_element() > 0.9 * DEPTH_MAX,
                "{x}: {}",
                depth(x)
            );
            assert!(depth(x).max_element() <= DEPTH_MAX);
        }
    }

    #[test]
    fn a_smooth_boundary_sends_back_what_its_fresnel_law_says() {
        use crate::optics::fresnel::fresnel_dielectric;
        let internal = Internal::new(N, 0.0, R_I);
        for tau in [0.0, 0.05, 0.3, 1.0, 4.0] {
            // ρ(τ) = 2∫R_int(μ) e^(−2τ/μ) μ dμ, in small steps.
            let (mut back, mut all) = (0.0, 0.0);
            for i in 0..100_000 {
                let mu = (f64::from(i) + 0.5) / 100_000.0;
                let weight = fresnel_dielectric(mu, 1.0 / N) * mu;
                all += weight;
                back += weight * (-2.0 * tau / mu).exp();
            }
            let (found, exact) = (internal.reflectance(tau), R_I * back / all);
            assert!((found - exact).abs() < 3e-3, "{tau}: {found} {exact}");
        }
    }

    #[test]
    fn diffuse_light_crosses_a_film_along_its_mean_path() {
        for alpha in [0.0, 0.6] {
            let film = film(alpha, DVec3::ONE);
            let interface = InterfaceTable::at_roughness(alpha, N, 1.0);
            for tau in [1e-3, 0.1, 1.0, 4.0] {
                let (mut lit, mut all) = (0.0, 0.0);
                for i in 0..2_000 {
                    let mu = (f64::from(i) + 0.5) / 2_000.0;
                    let weight = interface.at(mu, alpha).t * mu;
                    all += weight;
                    lit += weight * crossed(film.paths.at(mu, alpha), DVec3::splat(tau)).x;
                }
                let fitted = crossed(film.diffuse_path, DVec3::splat(tau)).x;
                // Of the light that falls on the film.
                assert!((fitted - lit / all).abs() < SHARE_FIT, "{tau}: {fitted}");
            }
        }
    }

    #[test]
    fn light_at_the_angles_of_capture_is_what_was_photographed() {
        let film = film(0.4, DVec3::ONE);
        let capture = capture_path(&film.paths, 0.4);
        let at = |mu: f64| film.paths.at(mu, 0.4);
        let depths = DVec3::new(0.1, 2.0, 20.0);
        let beyond = beyond_capture(depths, capture, at(FRAC_1_SQRT_2), at(1.0));
        assert!((beyond - 1.0).abs().max_element() < 1e-9);
        // Grazing light goes a longer way through ink.
        assert!(beyond_capture(DVec3::ONE, capture, at(0.1), at(1.0)).x < 0.8);
    }
}
