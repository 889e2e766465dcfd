//! The rough dielectric interface in closed form: what it lets through, and what its facets send
//! back after several bounces, as polynomials through nodes.
//!
//! Of the light that arrives at cosine μ, one bounce sends back E₁(μ), an integral, and several
//! E₂(μ), found by a walk on the facets (`refraction`): also what was refracted and comes out again
//! without having met the paper. So T = 1 − E₁ − E₂. What comes late is spread evenly, as
//! E₂(μi)E₂(μo)/(π Ē₂): reciprocal, and no light is made or lost, by the form of Kulla & Conty
//! 2017. Their estimate of E₂, from a mirror's loss and a mean Fresnel factor, knows of
//! reflections only: it left T up to 1.2% too high at a slant and half of the late light out of
//! photographs (measured, α = .1 to 1, n = 1.5).
//!
//! Both quantities are smooth in x = √μ and s = √α once the surface is not a mirror. A
//! polynomial of degree 6 in x and 3 in s through Chebyshev nodes is within 4e-3 of the
//! integral for α ≥ [`ALPHA_FIT_MIN`] (8e-4 in the mean). It costs a few multiplications
//! where a texture would cost ten reads a pixel.

use std::f64::consts::PI;

use super::{
    late::late,
    microfacet::directional_albedo,
    quadrature::{chebyshev, polynomial, through},
};

/// Coefficients over powers of x = √μ.
pub const MU_TERMS: usize = 7;
/// The same for what comes late, which is a hundredth of the light.
pub const LATE_TERMS: usize = 7;
/// Coefficients over powers of s = √α.
pub const ALPHA_TERMS: usize = 4;
/// Below this roughness a fit over all roughnesses reads this one: nearer to a mirror the
/// transmittance has a cusp at grazing angles that no low polynomial follows.
pub const ALPHA_FIT_MIN: f64 = 0.1;
/// Steps of the integral at each node, in both directions.
const STEPS: u32 = 64;

/// Cosine of the light in reproduction photography.
const OBLIQUE: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// A polynomial in s.
pub type AlphaPolynomial = [f64; ALPHA_TERMS];

/// A rough dielectric interface for one index and one strength of its specular reflection.
#[derive(Clone, Debug, PartialEq)]
pub struct InterfaceTable {
    /// Coefficients of [`Interface::t`], from x⁰ upwards.
    pub t: [AlphaPolynomial; MU_TERMS],
    /// Coefficients of [`Interface::late`], from x⁰ upwards.
    pub late: [AlphaPolynomial; LATE_TERMS],
    pub compensation: AlphaPolynomial,
    pub t_mean: AlphaPolynomial,
    pub capture: AlphaPolynomial,
    pub floor: AlphaPolynomial,
}

/// The interface at one roughness: coefficients over powers of x.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InterfaceRow {
    pub t: [f64; MU_TERMS],
    pub late: [f64; LATE_TERMS],
}

/// The interface at one cosine and roughness.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Interface {
    /// Directional transmittance 1 − E(μ), all bounces counted, in [0, 1].
    pub t: f64,
    /// E₂(μ): what several bounces send back, in [0, 1].
    pub late: f64,
}

/// The interface at one roughness.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InterfaceMean {
    /// 1/(πĒ₂), in sr⁻¹, of the late light E₂(μi)E₂(μo)/(πĒ₂).
    pub compensation: f64,
    /// Mean of `t` over the cosine-weighted hemisphere.
    pub t_mean: f64,
    /// 1/(t(cos 45°)·t(1)): undoes the interface in the geometry of reproduction photography,
    /// so that a photographed albedo is what 45°/0° shows.
    pub capture: f64,
    /// What late light adds to an albedo photographed at 45°/0°.
    pub floor: f64,
}

impl InterfaceTable {
    /// The interface of index `n` (in [1, 3]) for every roughness from [`ALPHA_FIT_MIN`] on,
    /// its reflection scaled by `specular` (in [0, 1]; 1 is physical).
    pub fn new(n: f64, specular: f64) -> Self {
        let low = ALPHA_FIT_MIN.sqrt();
        let s_nodes = chebyshev::<ALPHA_TERMS>().map(|u| low + (1.0 - low) * u);
        let rows = s_nodes.map(|s| Row::new(s * s, n, specular));
        let over_s = |of: &dyn Fn(&Row) -> f64| {
            through(
                &s_nodes,
                &std::array::from_fn::<f64, ALPHA_TERMS, _>(|j| of(&rows[j])),
            )
        };
        Self {
            t: std::array::from_fn(|i| over_s(&|row| row.t[i])),
            late: std::array::from_fn(|i| over_s(&|row| row.late[i])),
            compensation: over_s(&|row| row.mean.compensation),
            t_mean: over_s(&|row| row.mean.t_mean),
            capture: over_s(&|row| row.mean.capture),
            floor: over_s(&|row| row.mean.floor),
        }
    }

    /// The same interface at one roughness (in [0, 1]), whatever `alpha` it is later asked for.
    pub fn at_roughness(alpha: f64, n: f64, specular: f64) -> Self {
        let row = Row::new(alpha, n, specular);
        let constant = |value: f64| [value, 0.0, 0.0, 0.0];
        Self {
            t: row.t.map(constant),
            late: row.late.map(constant),
            compensation: constant(row.mean.compensation),
            t_mean: constant(row.mean.t_mean),
            capture: constant(row.mean.capture),
            floor: constant(row.mean.floor),
        }
    }

    /// At cosine `mu` in [0, 1] and roughness `alpha` in [0, 1].
    pub fn at(&self, mu: f64, alpha: f64) -> Interface {
        interface_at(&self.row(alpha), mu)
    }

    /// For every direction, at roughness `alpha` in [0, 1].
    pub fn row(&self, alpha: f64) -> InterfaceRow {
        let s = fit_root(alpha);
        InterfaceRow {
            t: self.t.map(|over_s| polynomial(&over_s, s)),
            late: self.late.map(|over_s| polynomial(&over_s, s)),
        }
    }

    /// At roughness `alpha` in [0, 1].
    pub fn mean_at(&self, alpha: f64) -> InterfaceMean {
        let s = fit_root(alpha);
        InterfaceMean {
            compensation: polynomial(&self.compensation, s).max(0.0),
            t_mean: polynomial(&self.t_mean, s),
            capture: polynomial(&self.capture, s),
            floor: polynomial(&self.floor, s).max(0.0),
        }
    }
}

/// The interface at cosine `mu` in [0, 1].
pub fn interface_at(row: &InterfaceRow, mu: f64) -> Interface {
    let x = mu.clamp(0.0, 1.0).sqrt();
    Interface {
        t: polynomial(&row.t, x).clamp(0.0, 1.0),
        late: polynomial(&row.late, x).clamp(0.0, 1.0),
    }
}

/// s = √α, of a roughness `alpha` within the bounds of what is fitted.
pub fn fit_root(alpha: f64) -> f64 {
    alpha.clamp(ALPHA_FIT_MIN, 1.0).sqrt()
}

/// One roughness.
struct Row {
    t: [f64; MU_TERMS],
    late: [f64; LATE_TERMS],
    mean: InterfaceMean,
}

impl Row {
    fn new(alpha: f64, n: f64, specular: f64) -> Self {
        let x_nodes = chebyshev::<MU_TERMS>();
        let once = x_nodes.map(|x| directional_albedo(x * x, alpha, n, STEPS));
        let once = through(&x_nodes, &once);
        let late = late(alpha, n).map(|c| specular * c);
        let t = std::array::from_fn(|i| {
            let one = if i == 0 { 1.0 } else { 0.0 };
            one - specular * once[i] - late[i]
        });
        let late_mean = hemisphere_mean(&late);
        // A smooth interface sends nothing back late.
        let compensation = if late_mean > 1e-9 {
            1.0 / (PI * late_mean)
        } else {
            0.0
        };
        let oblique = polynomial(&t, OBLIQUE.sqrt());
        let capture = 1.0 / (oblique * polynomial(&t, 1.0));
        let late_at = |mu: f64| polynomial(&late, mu.sqrt()).max(0.0);
        let mean = InterfaceMean {
            compensation,
            t_mean: hemisphere_mean(&t),
            capture,
            floor: PI * compensation * late_at(OBLIQUE) * late_at(1.0),
        };
        Self { t, late, mean }
    }
}

/// 2∫ value(μ) μ dμ for a polynomial in x = √μ: each xᵏ gives 4/(k + 4).
fn hemisphere_mean(coefficients: &[f64]) -> f64 {
    coefficients
        .iter()
        .zip(4..)
        .map(|(c, k)| c * 4.0 / f64::from(k))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fit's largest error over all directions, see the module's head.
    const FIT: f64 = 4e-3;
    /// Of late light, in units of what arrives.
    const LATE_FIT: f64 = 4e-3;

    #[test]
    fn follows_bounces_between_its_nodes() {
        let table = InterfaceTable::new(1.5, 1.0);
        for alpha in [0.1, 0.17, 0.3, 0.55, 0.8, 1.0] {
            let here = InterfaceTable::at_roughness(alpha, 1.5, 1.0);
            for mu in [1e-4, 0.01, 0.05, 0.2, 0.5, 0.9, 1.0f64] {
                let late = polynomial(&late(alpha, 1.5), mu.sqrt());
                let exact = 1.0 - directional_albedo(mu, alpha, 1.5, 128) - late;
                for table in [&table, &here] {
                    let at = table.at(mu, alpha);
                    assert!(
                        (at.t - exact).abs() < FIT,
                        "α {alpha} μ {mu}: {} {exact}",
                        at.t
                    );
                    let off = (at.late - late).abs();
                    assert!(off < LATE_FIT, "α {alpha} μ {mu}: {} {late}", at.late);
                }
            }
        }
    }

    #[test]
    fn late_light_is_neither_made_nor_lost() {
        for alpha in [0.1, 0.4, 1.0] {
            let table = InterfaceTable::at_roughness(alpha, 1.5, 1.0);
            let mean = table.mean_at(alpha);
            let steps = 1000;
            let over_hemisphere: f64 = (0..steps)
                .map(|i| {
                    let mu = (f64::from(i) + 0.5) / f64::from(steps);
                    2.0 * PI * mu / f64::from(steps) * table.at(mu, alpha).late
                })
                .sum();
            let whole = mean.compensation * over_hemisphere;
            // Near a mirror the polynomial dips below none, which is cut off.
            assert!((whole - 1.0).abs() < 0.03, "{alpha}: {whole}");
        }
    }

    #[test]
    fn smooth_interface_has_the_published_means() {
        // r_e = .0918 for n = 1.5 (OPTICS.md, Interface).
        let table = InterfaceTable::at_roughness(0.0, 1.5, 1.0);
        let mean = table.mean_at(0.0);
        assert!((1.0 - mean.t_mean - 0.0918).abs() < 1e-3, "{mean:?}");
        assert_eq!(mean.compensation, 0.0);
        assert!(
            (mean.capture - 1.0 / (0.96 * 0.9498)).abs() < 2e-3,
            "{mean:?}"
        );
    }

    #[test]
    fn without_reflection_everything_is_let_through() {
        let table = InterfaceTable::new(1.5, 0.0);
        let (at, mean) = (table.at(0.3, 0.5), table.mean_at(0.5));
        assert!((at.t - 1.0).abs() < 1e-12);
        assert!((mean.capture - 1.0).abs() < 1e-12 && mean.compensation.abs() < 1e-12);
    }

    #[test]
    fn stays_within_its_range_at_the_extremes() {
        for n in [1.0, 1.5, 3.0] {
            let table = InterfaceTable::new(n, 1.0);
            for mu in [-1.0, 0.0, 1e-9, 0.5, 1.0, 2.0] {
                for alpha in [-1.0, 0.0, 1e-4, 0.5, 1.0, 9.0] {
                    let at = table.at(mu, alpha);
                    assert!((0.0..=1.0).contains(&at.t), "{n} {mu} {alpha}: {at:?}");
                    assert!((0.0..=1.0).contains(&at.late));
                    let mean = table.mean_at(alpha);
                    assert!(mean.compensation.is_finite() && mean.compensation >= 0.0);
                    assert!(mean.capture.is_finite() && mean.capture > 0.99);
                }
            }
        }
    }
}
