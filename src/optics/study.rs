//! The study tier: ink as a film of its own and single scattering apart, calibrated by the
//! photograph. Light through the sheet is in [`super::through`], particles and body colour in
//! [`super::matter`].

use std::{
    f64::consts::{FRAC_1_SQRT_2, FRAC_PI_8, PI},
    sync::Arc,
};

use glam::{DVec3, DVec4};

use super::{
    ink::{Film, beyond_capture, inner_cosine},
    quadrature::{chebyshev, gauss_legendre, through},
    refraction::{PathTable, mean_inner_cosine},
    slab::{Phase, Slab},
    table::{Interface, InterfaceMean, InterfaceTable},
    through::Through,
    tier::{Facing, Surface, albedo_of, brdf_gallery_specular},
};

/// What a side is made of, per linear sRGB channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// Diffuse part of the bare paper's photographed albedo, > 0.
    pub bare: DVec3,
    pub film: Film,
    pub split: Split,
    pub through: Through,
}

/// How the paper's diffuse light differs from one direction to another. Light scattered once
/// stands against its mean over all directions, and what enters at a slant is sent back sooner,
/// so that less of it crosses the sheet. The means of both over either direction are those of
/// diffusion, so that no light is made or lost. Light that enters steeply leaves a little more steeply.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// κ = ωπ(1 − r_i R_b)/R_b: a single scatter's share of what the paper sends back, over
    /// [`single_scatter`].
    pub kappa: DVec3,
    /// Mean of [`single_scatter`] over both hemispheres, weighted as light enters and leaves.
    pub mean: f64,
    /// 1 over the shape in the geometry of capture.
    pub at_capture: DVec3,
    /// Optical thickness σt·d.
    pub depth: f64,
    /// −d ln R/dμ′ of the slab, by the mean cosine μ′ of the light within.
    pub leaning: DVec3,
    /// Mean of μ′ over the hemisphere, weighted as light enters.
    pub inner_mean: f64,
    /// By how much more is sent on per deviation of both cosines from their mean: light that
    /// enters steeply comes deeper, and leaves a little more steeply.
    pub alike: f64,
    /// Sum of both cosines μ′ in the geometry of capture.
    pub captured: f64,
    /// Mean of [`single_scatter`] over one hemisphere: coefficients over powers of μ² of the other
    /// direction.
    pub of_direction: DVec4,
    pub phase: Phase,
}

/// Directions over a hemisphere: μ, its share of the light that enters, and its path.
pub(super) type Directions = Vec<(f64, f64, DVec4)>;

fn directions(interface: &InterfaceTable, paths: &PathTable, alpha: f64) -> Directions {
    const GRID: u32 = 7;
    let mut directions: Directions = (0..GRID)
        .map(|i| {
            let [x, weight] = gauss_legendre(GRID, i);
            // 2μ dμ = d(μ²).
            let mu = (0.5 + 0.5 * x).sqrt();
            (mu, weight * interface.at(mu, alpha).t, paths.at(mu, alpha))
        })
        .collect();
    let all: f64 = directions.iter().map(|(_, weight, _)| weight).sum();
    directions
        .iter_mut()
        .for_each(|(_, weight, _)| *weight /= all);
    directions
}

impl Study {
    /// A side of paper whose bare spots photograph as `bare` (linear sRGB) with the surface
    /// `bare` of index `eta` (> 1), under `interface`, with its `paths`; `slab` gives scattering,
    /// phase and thickness, its absorption follows from the albedo. The sheet hangs free: behind
    /// it is its own boundary.
    pub fn new(
        bare: &Surface,
        interface: &InterfaceTable,
        paths: Arc<PathTable>,
        slab: Slab,
    ) -> Self {
        let mean = interface.mean_at(bare.alpha);
        let n2 = bare.eta * bare.eta;
        let r_i = (1.0 - mean.t_mean / n2).max(0.0);
        let directions = directions(interface, &paths, bare.alpha);
        let inner_mean = directions
            .iter()
            .map(|(_, weight, path)| weight * mean_inner_cosine(*path))
            .sum();
        let capture = [FRAC_1_SQRT_2, 1.0].map(|mu| mean_inner_cosine(paths.at(mu, bare.alpha)));
        let albedo = albedo_of(bare, &mean).max(DVec3::splat(1e-3));
        let whole = |share: DVec3, at_capture: DVec3| {
            let r_b = (albedo * share * at_capture).map(|a| {
                let from_within = a * n2 * mean.capture;
                (from_within / (1.0 + r_i * from_within)).min(1.0)
            });
            let slabs = r_b
                .to_array()
                .map(|r_b| slab.absorbing_to(r_b, r_i, inner_mean));
            let split = Split::new(&slabs, r_b, r_i, bare.eta, inner_mean, &directions, capture);
            (r_b, slabs, split)
        };
        // What the photograph shows more or less than the mean over all directions follows from
        // the paper, which follows from that mean.
        let mut at_capture = DVec3::ONE;
        for _ in 0..2 {
            at_capture = whole(DVec3::ONE, at_capture).2.at_capture;
        }
        let (r_b, slabs, split) = whole(DVec3::ONE, at_capture);
        let mut through = Through::new(
            &slabs,
            &mean,
            r_i,
            bare.eta,
            inner_mean,
            &directions,
            interface,
            bare.alpha,
        );
        let passes = |share: DVec3| {
            let mut at_capture = DVec3::ONE;
            for _ in 0..2 {
                at_capture = whole(share, at_capture).2.at_capture;
            }
            let (_, slabs, _) = whole(share, at_capture);
            per_channel(&slabs, |slab| slab.transmittance(r_i, inner_mean))
        };
        // More than all is what no slab reflects: none of these absorbs.
        let (_, clear, of_clear) = whole(DVec3::splat(1e9), DVec3::ONE);
        let from_within =
            per_channel(&clear, |slab| slab.reflectance(r_i, inner_mean)) / (1.0 - r_i);
        let most = from_within / (n2 * mean.capture * of_clear.at_capture);
        through.tone(most / albedo, passes);
        Self {
            bare: albedo,
            film: Film::new(bare.eta, bare.alpha, interface, paths, r_i, r_b),
            split,
            through,
        }
    }
}

/// A quantity of the slabs of all channels.
pub(super) fn per_channel(slabs: &[Slab; 3], of: impl Fn(&Slab) -> f64) -> DVec3 {
    DVec3::from_array(slabs.each_ref().map(of))
}

/// τ of ink at which half of what the boundary sends back does not come again: ρ(1/6) is .49 of
/// ρ(0) (n = 1.5).
pub const LOST_DEPTH: f64 = 1.0 / 6.0;
/// Mean cosine of diffuse light within.
pub const DIFFUSE_COSINE: f64 = 2.0 / 3.0;

/// Henyey & Greenstein's phase function in sr⁻¹ at the cosine of the deflection.
pub fn phase_lobe(g: f64, cos_deflection: f64) -> f64 {
    // 1 + g² − 2g cosΘ, which would cancel in the lobe's peak.
    let narrow = 1.0 - g.abs();
    let d = (narrow * narrow + 2.0 * (g.abs() - g * cos_deflection)).max(1e-6);
    (1.0 - g * g) / (4.0 * PI * d * d.sqrt())
}

/// Both lobes.
pub fn phase_function(split: &Split, cos_deflection: f64) -> f64 {
    let phase = &split.phase;
    phase.forward_share * phase_lobe(phase.g_forward, cos_deflection)
        + (1.0 - phase.forward_share) * phase_lobe(phase.g_backward, cos_deflection)
}

/// q = p(Θ′)(1 − e^(−σt d(1/μi′ + 1/μo′)))/(μi′ + μo′), `l_dot_v` the cosine between the
/// directions in air (Hanrahan & Krueger 1993, eq. 5, of a finite slab).
pub fn single_scatter(split: &Split, eta: f64, g: &Facing, inner_i: f64, inner_o: f64) -> f64 {
    let l_dot_v = 2.0 * g.cos_d * g.cos_d - 1.0;
    let tangential = (l_dot_v - g.mu_i * g.mu_o) / (eta * eta);
    // Light goes down along −l′ and comes up along v′.
    let cos_deflection = (-tangential - inner_i * inner_o).clamp(-1.0, 1.0);
    let left = -(-split.depth * (1.0 / inner_i + 1.0 / inner_o)).exp_m1();
    phase_function(split, cos_deflection) * left / (inner_i + inner_o)
}

impl Split {
    fn new(
        slabs: &[Slab; 3],
        r_b: DVec3,
        r_i: f64,
        eta: f64,
        inner_mean: f64,
        directions: &Directions,
        capture: [f64; 2],
    ) -> Self {
        let depth = |slab: &Slab| (slab.scattering + slab.absorption) * slab.thickness;
        let omega = |slab: &Slab| slab.scattering / (slab.scattering + slab.absorption);
        let mut split = Self {
            kappa: per_channel(slabs, omega) * PI * (1.0 - r_i * r_b) / r_b.max(DVec3::splat(1e-3)),
            mean: 0.0,
            at_capture: DVec3::ONE,
            depth: per_channel(slabs, depth).element_sum() / 3.0,
            leaning: {
                let reflected = |slab: &Slab, inner| slab.reflectance(r_i, inner);
                let mean = per_channel(slabs, |slab| reflected(slab, inner_mean));
                -slope(slabs, reflected) / mean.max(DVec3::splat(1e-6))
            },
            inner_mean,
            alike: alike(slabs[0].phase.mean_cosine()),
            captured: capture[0] + capture[1],
            of_direction: DVec4::ZERO,
            phase: slabs[0].phase,
        };
        let q = |mu_i: f64, mu_o: f64, cos_phi: f64| {
            let sines = ((1.0 - mu_i * mu_i) * (1.0 - mu_o * mu_o)).sqrt();
            let l_dot_v = mu_i * mu_o + sines * cos_phi;
            let g = Facing {
                mu_i,
                mu_o,
                cos_d: (0.5 + 0.5 * l_dot_v).max(0.0).sqrt(),
                sin2_h: 0.0,
            };
            let (inner_i, inner_o) = (inner_cosine(mu_i, eta), inner_cosine(mu_o, eta));
            single_scatter(&split, eta, &g, inner_i, inner_o)
        };
        const TURNS: u32 = 16;
        let nodes = chebyshev::<4>();
        let means = nodes.map(|v| {
            let over_turns = |mu_o: f64| {
                let turns = (0..TURNS).map(|turn| PI * (f64::from(turn) + 0.5) / f64::from(TURNS));
                turns.map(|phi| q(v.sqrt(), mu_o, phi.cos())).sum::<f64>() / f64::from(TURNS)
            };
            let weighted = directions
                .iter()
                .map(|(mu, weight, _)| weight * over_turns(*mu));
            weighted.sum::<f64>()
        });
        let of_direction = DVec4::from_array(through(&nodes, &means));
        let captured = q(FRAC_1_SQRT_2, 1.0, 0.0);
        split.of_direction = of_direction;
        split.mean = directions
            .iter()
            .map(|(mu, weight, _)| weight * split_mean(&split, *mu))
            .sum();
        // Where light is scattered only once, no more than all of it is.
        split.kappa = split.kappa.min(DVec3::splat(1.0 / split.mean.max(1e-9)));
        let at_capture = Facing {
            mu_i: FRAC_1_SQRT_2,
            mu_o: 1.0,
            cos_d: FRAC_PI_8.cos(),
            sin2_h: FRAC_PI_8.sin().powi(2),
        };
        let shape = split_shape(
            &split,
            captured,
            &at_capture,
            capture[0],
            capture[1],
            DVec3::ZERO,
        );
        split.at_capture = 1.0 / shape.max(DVec3::splat(0.1));
        split
    }
}

/// What [`Split::alike`] is, by the mean cosine of scattering: .24, .44 and .85 were found by walks
/// without boundaries, of light that is scattered more than once, for 0, 1/3 and .7 (σs 81.38 mm⁻¹,
/// sheets of .05 to 1 mm, σa .3 to 2 mm⁻¹).
fn alike(g: f64) -> f64 {
    0.24 + g * (0.36 + 0.72 * g)
}

/// df/dμ′ of a quantity of the slabs by the mean cosine of light that enters.
pub(super) fn slope(slabs: &[Slab; 3], of: impl Fn(&Slab, f64) -> f64) -> DVec3 {
    // Between diffuse light and a beam along the normal.
    per_channel(slabs, |slab| {
        (of(slab, 1.0) - of(slab, DIFFUSE_COSINE)) / (1.0 - DIFFUSE_COSINE)
    })
}

/// Mean of [`single_scatter`] over one hemisphere at the cosine `mu` in the other.
pub fn split_mean(split: &Split, mu: f64) -> f64 {
    let c = split.of_direction;
    let v = mu * mu;
    c.x + v * (c.y + v * (c.z + v * c.w))
}

/// What the paper sends from one direction into another, over its mean over all and over the
/// same in the geometry of capture: `q` is [`single_scatter`], `m_i` and `m_o` the mean cosines
/// within, `depth` τ of the ink over it.
///
/// Light that enters steeply comes deeper and leaves a little more steeply. Under bare paper that
/// matters little, as what leaves flatly is sent back by the boundary and has another try; under
/// ink it is lost there. So the cosines count by how far they are from their mean over what gets
/// out where there is no ink, and from that of diffuse light where there is.
pub fn split_shape(split: &Split, q: f64, g: &Facing, m_i: f64, m_o: f64, depth: DVec3) -> DVec3 {
    let once = q - split_mean(split, g.mu_i) - split_mean(split, g.mu_o) + split.mean;
    let slanted = 2.0 * split.inner_mean - m_i - m_o;
    let lost = depth / (depth + LOST_DEPTH) * (split.inner_mean - DIFFUSE_COSINE);
    let alike =
        (m_i - split.inner_mean) * (m_o - split.inner_mean) + lost * (m_i + m_o - split.captured);
    (1.0 + split.kappa * once + split.leaning * slanted + split.alike * alike).max(DVec3::ZERO)
        * split.at_capture
}

/// Ways of light through a spot's film: in the geometry of capture, of the light, to the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ways {
    pub capture: DVec4,
    pub path_i: DVec4,
    pub path_o: DVec4,
}

/// The study tier without the cosine: gallery with the ink's own path and single scattering
/// apart. `at_i`, `at_o` and `mean` as for [`brdf_gallery`](super::tier::brdf_gallery); `depth`
/// is τ of the ink, `paper` the diffuse albedo of paper and ink, and `surface` the share of the
/// spot with a dielectric surface: 1 but where particles lie (see [`super::matter`]).
#[expect(
    clippy::too_many_arguments,
    reason = "the shader's twin has no structs to borrow"
)]
pub fn brdf_study(
    s: &Surface,
    g: &Facing,
    at_i: &Interface,
    at_o: &Interface,
    mean: &InterfaceMean,
    split: &Split,
    depth: DVec3,
    ways: &Ways,
    paper: DVec3,
    surface: f64,
) -> DVec3 {
    let gloss = brdf_gallery_specular(s, g, at_i, at_o, mean) * surface;
    brdf_study_diffuse(s, g, at_i, at_o, mean, split, depth, ways, paper) + DVec3::splat(gloss)
}

/// The study tier's light from below the surface.
#[expect(
    clippy::too_many_arguments,
    reason = "the shader's twin has no structs to borrow"
)]
pub fn brdf_study_diffuse(
    s: &Surface,
    g: &Facing,
    at_i: &Interface,
    at_o: &Interface,
    mean: &InterfaceMean,
    split: &Split,
    depth: DVec3,
    ways: &Ways,
    paper: DVec3,
) -> DVec3 {
    let (inner_i, inner_o) = (inner_cosine(g.mu_i, s.eta), inner_cosine(g.mu_o, s.eta));
    let q = single_scatter(split, s.eta, g, inner_i, inner_o);
    let (m_i, m_o) = (
        mean_inner_cosine(ways.path_i),
        mean_inner_cosine(ways.path_o),
    );
    let shape = split_shape(split, q, g, m_i, m_o, depth);
    let through_ink = beyond_capture(depth, ways.capture, ways.path_i, ways.path_o);
    let coupled = at_i.t * at_o.t * mean.capture;
    paper * coupled * through_ink * shape / PI
}

/// The same of even light, which comes in along its mean path, `m_o` the mean cosine within
/// towards the eye.
pub fn split_even(split: &Split, m_o: f64, depth: DVec3) -> DVec3 {
    let lost = depth / (depth + LOST_DEPTH) * (split.inner_mean - DIFFUSE_COSINE);
    let alike = lost * (split.inner_mean + m_o - split.captured);
    let slanted = split.inner_mean - m_o;
    (1.0 + split.leaning * slanted + split.alike * alike).max(DVec3::ZERO) * split.at_capture
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::{bsdf::Specimen, medium::MediumId};

    #[test]
    fn light_leaves_as_steeply_as_the_walks_found() {
        for (g, walked) in [(0.0, 0.24), (1.0 / 3.0, 0.44), (0.7, 0.85)] {
            assert!((alike(g) - walked).abs() < 0.01, "{g}: {}", alike(g));
        }
    }

    /// The polynomial's nodes are seven directions, turned sixteen times; here are many more.
    #[test]
    fn the_mean_of_a_single_scatter_is_its_integral() {
        const WITHIN: f64 = 1e-3;
        const STEPS: u32 = 64;
        let laid = "laid".parse::<MediumId>().expect("laid paper");
        let Specimen {
            surface,
            interface,
            study: Study { split, .. },
            ..
        } = Specimen::new(laid.medium(), DVec3::splat(0.8));
        let directions: Vec<[f64; 2]> = (0..STEPS)
            .map(|i| {
                let mu = ((f64::from(i) + 0.5) / f64::from(STEPS)).sqrt();
                [mu, interface.at(mu, surface.alpha).t]
            })
            .collect();
        let all: f64 = directions.iter().map(|[_, t]| t).sum();
        let scattered = |mu_i: f64, mu_o: f64, phi: f64| {
            let sines = ((1.0 - mu_i * mu_i) * (1.0 - mu_o * mu_o)).sqrt();
            let l_dot_v = mu_i * mu_o + sines * phi.cos();
            let g = Facing {
                mu_i,
                mu_o,
                cos_d: (0.5 + 0.5 * l_dot_v).sqrt(),
                sin2_h: 0.0,
            };
            let [inner_i, inner_o] = [mu_i, mu_o].map(|mu| inner_cosine(mu, surface.eta));
            single_scatter(&split, surface.eta, &g, inner_i, inner_o)
        };
        let over_all = |mu_i: f64| {
            let around = |mu_o: f64| {
                let turns = (0..STEPS).map(|turn| PI * (f64::from(turn) + 0.5) / f64::from(STEPS));
                turns.map(|phi| scattered(mu_i, mu_o, phi)).sum::<f64>() / f64::from(STEPS)
            };
            let weighted = directions.iter().map(|[mu, t]| t * around(*mu));
            weighted.sum::<f64>() / all
        };
        for mu in [0.1, 0.3, 0.6, 0.9, 1.0] {
            let [found, exact] = [split_mean(&split, mu), over_all(mu)];
            assert!(
                (found / exact - 1.0).abs() < WITHIN,
                "{mu}: {found} {exact}"
            );
        }
        let exact: f64 = directions.iter().map(|[mu, t]| t * over_all(*mu)).sum();
        let exact = exact / all;
        assert!(
            (split.mean / exact - 1.0).abs() < WITHIN,
            "{} {exact}",
            split.mean
        );
    }
}
