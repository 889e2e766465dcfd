//! The tabulated interface: what a rough dielectric lets through, and what its facets owe.

use std::f64::consts::PI;

use rayon::prelude::*;

use super::microfacet::directional_albedo;

/// Nodes over μ, at μ = (i/(N − 1))²: transmission bends most at grazing angles.
pub const MU_NODES: usize = 32;
/// Nodes over α, at α = j/(M − 1).
pub const ALPHA_NODES: usize = 16;

/// A rough dielectric interface over all cosines and roughnesses, for one index and one
/// strength of its specular reflection.
#[derive(Clone, Debug)]
pub struct InterfaceTable {
    /// `nodes[j][i]` over roughness j and cosine i.
    pub nodes: Vec<[Interface; MU_NODES]>,
    /// What depends on roughness j alone.
    pub means: Vec<InterfaceMean>,
}

/// The interface at one cosine and roughness.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Interface {
    /// Directional transmittance 1 − E(μ), all bounces counted, in [0, 1].
    pub t: f64,
    /// 1 − E_m(μ) of mirror facets: what one bounce loses, in [0, 1].
    pub lost: f64,
}

/// The interface at one roughness.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InterfaceMean {
    /// Strength k of the compensation k·lost(μi)·lost(μo), in sr⁻¹.
    pub compensation: f64,
    /// Mean of `t` over the cosine-weighted hemisphere.
    pub t_mean: f64,
    /// 1/(t(cos 45°)·t(1)): undoes the interface in the geometry of reproduction photography,
    /// so that a photographed albedo is what 45°/0° shows.
    pub capture: f64,
}

impl InterfaceTable {
    /// Tabulates an interface of index `n` (in [1, 3]) whose reflection is scaled by
    /// `specular` (in [0, 1]; 1 is physical); some tens of milliseconds.
    ///
    /// The compensation is Kulla & Conty 2017 with the averaged Fresnel factor
    /// F_ms = F̄²Ē/(1 − F̄(1 − Ē)), reciprocal by its form.
    pub fn new(n: f64, specular: f64) -> Self {
        let rows: Vec<([Interface; MU_NODES], f64)> = (0..ALPHA_NODES)
            .into_par_iter()
            .map(|j| {
                let alpha = j as f64 / (ALPHA_NODES - 1) as f64;
                row(alpha, n, specular)
            })
            .collect();
        let (nodes, compensations): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
        let mut table = Self {
            nodes,
            means: vec![InterfaceMean::default(); ALPHA_NODES],
        };
        for (j, compensation) in compensations.into_iter().enumerate() {
            let alpha = j as f64 / (ALPHA_NODES - 1) as f64;
            let oblique = table.at(std::f64::consts::FRAC_1_SQRT_2, alpha).t;
            table.means[j] = InterfaceMean {
                compensation,
                t_mean: hemisphere_mean(|i| table.nodes[j][i].t),
                capture: 1.0 / (oblique * table.at(1.0, alpha).t),
            };
        }
        table
    }

    /// Bilinear between the nodes; `mu` and `alpha` are clamped to [0, 1].
    /// Twin of `interface_at` in `paper_material.wgsl`, which reads the nodes from a texture.
    pub fn at(&self, mu: f64, alpha: f64) -> Interface {
        let (i, u) = cell(mu.clamp(0.0, 1.0).sqrt(), MU_NODES);
        let (j, v) = cell(alpha, ALPHA_NODES);
        let value = |of: fn(&Interface) -> f64| {
            let row = |j: usize| mix(of(&self.nodes[j][i]), of(&self.nodes[j][i + 1]), u);
            mix(row(j), row(j + 1), v)
        };
        Interface {
            t: value(|node| node.t),
            lost: value(|node| node.lost),
        }
    }

    /// Linear between the roughnesses; `alpha` is clamped to [0, 1].
    pub fn mean_at(&self, alpha: f64) -> InterfaceMean {
        let (j, v) = cell(alpha, ALPHA_NODES);
        let (a, b) = (&self.means[j], &self.means[j + 1]);
        InterfaceMean {
            compensation: mix(a.compensation, b.compensation, v),
            t_mean: mix(a.t_mean, b.t_mean, v),
            capture: mix(a.capture, b.capture, v),
        }
    }
}

/// One roughness: its nodes over μ, and the strength of the compensation.
fn row(alpha: f64, n: f64, specular: f64) -> ([Interface; MU_NODES], f64) {
    let albedos: Vec<(f64, f64)> = (0..MU_NODES)
        .map(|i| directional_albedo(node_mu(i), alpha, n, 40))
        .collect();
    let mirror_mean = hemisphere_mean(|i| albedos[i].1);
    let fresnel_mean = hemisphere_mean(|i| albedos[i].0) / mirror_mean;
    let owed = 1.0 - mirror_mean;
    let f_ms = fresnel_mean * fresnel_mean * mirror_mean / (1.0 - fresnel_mean * owed);
    // A smooth interface owes nothing but the rounding of the sum.
    let compensation = if owed > 1e-6 { f_ms / (PI * owed) } else { 0.0 };
    let nodes = std::array::from_fn(|i| {
        let (single, mirror) = albedos[i];
        let lost = (1.0 - mirror).max(0.0);
        // ∫ k lost(μi) lost(μo) μi dω = F_ms lost(μo).
        Interface {
            t: (1.0 - specular * (single + f_ms * lost)).clamp(0.0, 1.0),
            lost,
        }
    });
    (nodes, specular * compensation)
}

/// The cell of `x` in [0, 1] among evenly spaced `nodes`, and the place within it.
fn cell(x: f64, nodes: usize) -> (usize, f64) {
    let x = x.clamp(0.0, 1.0) * (nodes - 1) as f64;
    let i = (x as usize).min(nodes - 2);
    (i, x - i as f64)
}

fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// The cosine of node `i`.
pub fn node_mu(i: usize) -> f64 {
    let x = i as f64 / (MU_NODES - 1) as f64;
    x * x
}

/// 2∫ value(μ) μ dμ with the value linear in √μ between nodes, as [`InterfaceTable::at`] reads it.
fn hemisphere_mean(value: impl Fn(usize) -> f64) -> f64 {
    let steps = 16;
    let mut sum = 0.0;
    for i in 0..MU_NODES - 1 {
        for s in 0..steps {
            let u = (f64::from(s) + 0.5) / f64::from(steps);
            let x = (i as f64 + u) / (MU_NODES - 1) as f64;
            // μ = x², dμ = 2x dx.
            let weight = 2.0 * x * x * 2.0 * x / (f64::from(steps) * (MU_NODES - 1) as f64);
            sum += weight * mix(value(i), value(i + 1), u);
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::fresnel::fresnel_dielectric;

    #[test]
    fn smooth_row_is_fresnel() {
        let table = InterfaceTable::new(1.5, 1.0);
        for i in 0..MU_NODES {
            let exact = 1.0 - fresnel_dielectric(node_mu(i), 1.5);
            assert!((table.nodes[0][i].t - exact).abs() < 1e-12);
        }
        // Between nodes, where the curve bends: bounded by the spacing.
        for mu in [0.02, 0.1, 0.37, 0.8] {
            let exact = 1.0 - fresnel_dielectric(mu, 1.5);
            assert!((table.at(mu, 0.0).t - exact).abs() < 4e-3, "{mu}");
        }
        assert!((1.0 - table.mean_at(0.0).t_mean - 0.0918).abs() < 1e-3);
    }

    #[test]
    fn stays_within_its_range_at_the_extremes() {
        for n in [1.0, 1.5, 3.0] {
            let table = InterfaceTable::new(n, 1.0);
            for mu in [-1.0, 0.0, 1e-9, 0.5, 1.0, 2.0] {
                for alpha in [-1.0, 0.0, 1e-4, 0.5, 1.0, 9.0] {
                    let at = table.at(mu, alpha);
                    assert!((0.0..=1.0).contains(&at.t), "{n} {mu} {alpha}: {at:?}");
                    assert!((0.0..=1.0).contains(&at.lost));
                    let mean = table.mean_at(alpha);
                    assert!(mean.compensation.is_finite() && mean.compensation >= 0.0);
                    assert!(mean.capture.is_finite() && mean.capture >= 1.0 - 1e-12);
                }
            }
        }
    }
}
