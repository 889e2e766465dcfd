//! Ink as an absorbing film between the paper and its surface (Williams & Clapper 1953), in the
//! form that a photograph calibrates.
//!
//! The film formula f = T(μi)T(μo) e^(−τ/μi′ − τ/μo′) R_b/(π n² [1 − ρ(τ)R_b]) has its slow
//! part, the bracket, in common with the photograph of the same spot at 45°/0°. So a tier
//! multiplies what the photograph shows by e^(−τ(1/μi′ + 1/μo′ − s0)), s0 the path in the
//! geometry of capture, and the optical depth τ alone has to be solved, from
//! x = (photographed albedo)/(that of the bare paper) = e^(−τ s0)(1 − r_i R_b)/(1 − ρ(τ)R_b).
//!
//! With u = √x, the solution is τ = (−ln x − H(u))/s0, and H and ρ are smooth in u:
//! polynomials of degree 6 through Chebyshev nodes are within 1e-3 (τ within 5e-4).

use glam::DVec3;

use super::{
    fresnel::fresnel_dielectric,
    quadrature::{chebyshev, through},
};

/// Coefficients over powers of u.
pub const FILM_TERMS: usize = 7;
/// Deeper films are as black.
pub const DEPTH_MAX: f64 = 20.0;
/// The share of the paper's light below which a photograph tells nothing more: τ = 20 or more.
pub const SHARE_MIN: f64 = 1e-20;
/// Steps of the integrals over the hemisphere.
const STEPS: u32 = 512;

/// Cosine inside a medium of index `eta` of a ray at cosine `mu` outside: μ′.
pub fn inner_cosine(mu: f64, eta: f64) -> f64 {
    (1.0 - (1.0 - mu * mu).max(0.0) / (eta * eta))
        .max(0.0)
        .sqrt()
}

/// The path s0 = 1/μ45′ + 1 through a film of unit depth, in and out, at 45°/0°.
pub fn capture_path(eta: f64) -> f64 {
    1.0 / inner_cosine(std::f64::consts::FRAC_1_SQRT_2, eta) + 1.0
}

/// Films over one paper, in fitted form.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// Coefficients of H(u) per channel.
    pub excess: [DVec3; FILM_TERMS],
    /// Coefficients of ρ(u) per channel.
    pub internal: [DVec3; FILM_TERMS],
    /// Coefficients of G(w), w = τ/(1 + τ): diffuse light crosses a film as e^(−τG).
    pub diffuse_path: [f64; 4],
    /// s0.
    pub capture_path: f64,
}

impl Film {
    /// Films on paper of index `n` (> 1) whose boundary has the internal diffuse reflectance
    /// `r_i` and whose body, with its backing, reflects `r_b` per channel (R_b, each in [0, 1]).
    pub fn new(n: f64, r_i: f64, r_b: DVec3) -> Self {
        let capture_path = capture_path(n);
        let internal = Internal::new(n, r_i);
        let nodes = chebyshev::<FILM_TERMS>();
        let mut film = Self {
            excess: [DVec3::ZERO; FILM_TERMS],
            internal: [DVec3::ZERO; FILM_TERMS],
            diffuse_path: diffuse_path(n),
            capture_path,
        };
        for channel in 0..3 {
            let r_b = r_b[channel].clamp(0.0, 1.0);
            let depths = nodes.map(|u| internal.depth(u * u, r_b, capture_path));
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

/// τ per channel from the share of the bare paper's albedo that was photographed; in
/// [0, [`DEPTH_MAX`]], 0 where the spot is as light as the paper or lighter. `capture_path` is s0.
pub fn optical_depth(film: &Film, capture_path: f64, share: DVec3) -> DVec3 {
    let x = share.clamp(DVec3::splat(SHARE_MIN), DVec3::ONE);
    let excess = horner(&film.excess, x.powf(0.5));
    let depth = (-x.map(f64::ln) - excess) / capture_path;
    depth.clamp(DVec3::ZERO, DVec3::splat(DEPTH_MAX))
}

/// ρ per channel: what diffuse light from below gets back from the film and its boundary, by the
/// share of the bare paper's albedo that was photographed.
pub fn internal_reflectance(film: &Film, share: DVec3) -> DVec3 {
    let x = share.clamp(DVec3::ZERO, DVec3::ONE);
    horner(&film.internal, x.powf(0.5)).clamp(DVec3::ZERO, DVec3::ONE)
}

/// The share of diffuse light from outside that crosses a film of depth `tau`.
pub fn diffuse_share(film: &Film, tau: DVec3) -> DVec3 {
    let w = tau / (1.0 + tau);
    let [a, b, c, d] = film.diffuse_path;
    (-tau * (a + w * (b + w * (c + w * d)))).exp()
}

/// e^(−τ(1/μi′ + 1/μo′ − s0)): what a film of depth `tau` does at these inner cosines beyond
/// what the photograph shows; `capture_path` is s0.
pub fn beyond_capture(tau: DVec3, capture_path: f64, inner_i: f64, inner_o: f64) -> DVec3 {
    (-tau * (1.0 / inner_i + 1.0 / inner_o - capture_path)).exp()
}

fn horner(coefficients: &[DVec3; FILM_TERMS], u: DVec3) -> DVec3 {
    coefficients
        .iter()
        .rev()
        .fold(DVec3::ZERO, |sum, c| sum * u + *c)
}

/// The boundary from inside.
struct Internal {
    /// μ, and the weight 2 R_int(μ) μ dμ.
    weights: Vec<(f64, f64)>,
}

impl Internal {
    /// The smooth boundary's angular law, scaled to the diffuse reflectance `r_i` of the rough
    /// one.
    fn new(n: f64, r_i: f64) -> Self {
        let mut weights: Vec<(f64, f64)> = midpoints()
            .map(|(mu, step)| (mu, 2.0 * fresnel_dielectric(mu, 1.0 / n) * mu * step))
            .collect();
        let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
        if sum > 0.0 {
            for (_, weight) in &mut weights {
                *weight *= r_i / sum;
            }
        }
        Self { weights }
    }

    /// ρ(τ) = 2∫R_int(μ) e^(−2τ/μ) μ dμ.
    fn reflectance(&self, tau: f64) -> f64 {
        self.weights
            .iter()
            .map(|(mu, weight)| weight * (-2.0 * tau / mu).exp())
            .sum()
    }

    /// The depth τ of a film that leaves the share `x` of the light that comes back from paper of
    /// reflectance `r_b` at 45°/0°, by bisection: the share falls with τ.
    fn depth(&self, x: f64, r_b: f64, capture_path: f64) -> f64 {
        let share = |tau: f64| {
            (-tau * capture_path).exp() * (1.0 - self.reflectance(0.0) * r_b)
                / (1.0 - self.reflectance(tau) * r_b)
        };
        let (mut low, mut high) = (0.0, 2.0 * DEPTH_MAX);
        for _ in 0..80 {
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

/// μ and step of a midpoint rule that is finer towards grazing light.
fn midpoints() -> impl Iterator<Item = (f64, f64)> {
    (0..STEPS).map(|i| {
        let v = (f64::from(i) + 0.5) / f64::from(STEPS);
        (v * v, 2.0 * v / f64::from(STEPS))
    })
}

/// Coefficients of G(w) with e^(−τG) = ∫T(μ)e^(−τ/μ′)μ dμ / ∫T(μ)μ dμ.
fn diffuse_path(n: f64) -> [f64; 4] {
    let share = |tau: f64| {
        let (mut lit, mut all) = (0.0, 0.0);
        for (mu, step) in midpoints() {
            let weight = (1.0 - fresnel_dielectric(mu, n)) * mu * step;
            all += weight;
            lit += weight * (-tau / inner_cosine(mu, n)).exp();
        }
        lit / all
    };
    // G bends where hardly any light is left: the fit ends with the deepest film.
    let nodes = chebyshev::<4>().map(|v| v * DEPTH_MAX / (1.0 + DEPTH_MAX));
    through(
        &nodes,
        &nodes.map(|w| {
            let tau = w / (1.0 - w);
            -share(tau).ln() / tau
        }),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: f64 = 1.5;
    const R_I: f64 = 0.5963;
    /// The fit's error in τ.
    const DEPTH_FIT: f64 = 1e-3;
    /// The fit's error in diffuse light, of what falls on the film.
    const SHARE_FIT: f64 = 1e-3;

    fn share(tau: f64, r_b: f64) -> f64 {
        let internal = Internal::new(N, R_I);
        (-tau * capture_path(N)).exp() * (1.0 - R_I * r_b) / (1.0 - internal.reflectance(tau) * r_b)
    }

    #[test]
    fn depth_is_found_again_from_the_photograph() {
        for r_b in [0.05, 0.3, 0.7, 0.9, 0.97] {
            let film = Film::new(N, R_I, DVec3::splat(r_b));
            for tau in [0.0, 1e-4, 1e-3, 0.05, 0.3, 1.0, 2.0, 4.0, 8.0] {
                let x = share(tau, r_b);
                let found = optical_depth(&film, film.capture_path, DVec3::splat(x)).x;
                assert!((found - tau).abs() < DEPTH_FIT, "{r_b} {tau}: {found}");
                let rho = internal_reflectance(&film, DVec3::splat(x)).x;
                let exact = Internal::new(N, R_I).reflectance(tau);
                assert!((rho - exact).abs() < 2e-3, "{r_b} {tau}: {rho} {exact}");
            }
        }
    }

    #[test]
    fn bare_paper_and_what_is_lighter_carry_no_ink() {
        let film = Film::new(N, R_I, DVec3::new(0.9, 0.8, 0.6));
        assert!(optical_depth(&film, film.capture_path, DVec3::ONE).max_element() < DEPTH_FIT);
        assert!(
            optical_depth(&film, film.capture_path, DVec3::splat(7.0)).max_element() < DEPTH_FIT
        );
        assert!(
            (internal_reflectance(&film, DVec3::ONE) - R_I)
                .abs()
                .max_element()
                < 1e-3
        );
        for x in [0.0, -1.0, 1e-300] {
            assert_eq!(
                optical_depth(&film, film.capture_path, DVec3::splat(x)),
                DVec3::splat(DEPTH_MAX)
            );
        }
    }

    #[test]
    fn diffuse_light_crosses_a_film_along_its_mean_path() {
        let film = Film::new(N, R_I, DVec3::ONE);
        for tau in [1e-3, 0.1, 1.0, 4.0] {
            let (mut lit, mut all) = (0.0, 0.0);
            for i in 0..20_000 {
                let mu = (f64::from(i) + 0.5) / 20_000.0;
                let weight = (1.0 - fresnel_dielectric(mu, N)) * mu;
                all += weight;
                lit += weight * (-tau / inner_cosine(mu, N)).exp();
            }
            let fitted = diffuse_share(&film, DVec3::splat(tau)).x;
            // Of the light that falls on the film.
            assert!((fitted - lit / all).abs() < SHARE_FIT, "{tau}: {fitted}");
        }
    }

    #[test]
    fn light_at_the_angles_of_capture_is_what_was_photographed() {
        let s0 = capture_path(N);
        let inner = inner_cosine(std::f64::consts::FRAC_1_SQRT_2, N);
        let beyond = beyond_capture(DVec3::new(0.1, 2.0, 20.0), s0, inner, 1.0);
        assert!((beyond - 1.0).abs().max_element() < 1e-9);
        // Grazing light goes a longer way through ink.
        assert!(beyond_capture(DVec3::ONE, s0, inner_cosine(0.1, N), 1.0).x < 0.95);
    }
}
