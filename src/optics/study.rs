//! The study tier: ink as a film of its own, single scattering apart, light through the sheet,
//! and particles of metal and chalk, all calibrated by the photograph.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use glam::DVec3;

use super::{
    fresnel::fresnel_conductor,
    ink::{Film, beyond_capture, capture_path, diffuse_share, inner_cosine},
    microfacet::{MU_MIN, d_ggx, v_smith},
    quadrature::gauss_legendre,
    slab::{Body, Phase, Slab},
    table::{Interface, InterfaceMean},
    tier::{Facing, Surface, albedo_of, brdf_gallery_specular, capture_floor},
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

/// Light scattered once within the paper, against its mean over all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// κ = ωπ(1 − r_i R_b)/R_b: a single scatter's share of what the paper sends back, over
    /// [`single_scatter`].
    pub kappa: DVec3,
    /// Mean of [`single_scatter`] over both hemispheres, weighted as light enters and leaves.
    pub mean: f64,
    /// Optical thickness σt·d.
    pub depth: f64,
    pub phase: Phase,
    /// s0 of the film.
    pub capture_path: f64,
    /// 1/(1 + κ(q − mean)) in the geometry of capture.
    pub at_capture: DVec3,
}

/// Light through the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Through {
    /// R0 and T0 of the paper alone.
    pub reflected: DVec3,
    pub transmitted: DVec3,
    /// Optical thickness σt·d of the paper: light that is not scattered at all.
    pub ballistic: DVec3,
    /// Share of a light table's radiance that bare paper shows on average, for tiers that
    /// know no angles.
    pub flat_share: DVec3,
}

/// Particles of metal or chalk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Particle {
    /// n + ik per channel.
    pub n: DVec3,
    /// GGX roughness of what they form.
    pub alpha: f64,
    pub k: DVec3,
    /// Share of a spot that they cover, in [0, 1].
    pub covered: f64,
}

impl Study {
    /// A side of paper whose bare spots photograph as `bare` (linear sRGB) with the surface
    /// `bare` of index `eta` (> 1), over its interface's means; `slab` gives scattering, phase
    /// and thickness, its absorption follows from the albedo. The sheet hangs free: behind it is
    /// its own boundary.
    pub fn new(bare: &Surface, mean: &InterfaceMean, slab: Slab) -> Self {
        let n2 = bare.eta * bare.eta;
        let r_i = (1.0 - mean.t_mean / n2).max(0.0);
        let albedo = albedo_of(bare, mean).max(DVec3::splat(1e-3));
        let r_b = albedo.map(|a| {
            let from_within = a * n2 * mean.capture;
            (from_within / (1.0 + r_i * from_within)).min(1.0)
        });
        let slabs = r_b.to_array().map(|r_b| slab.absorbing_to(r_b, r_i));
        let per_channel = |of: &dyn Fn(&Slab) -> f64| DVec3::from_array(slabs.each_ref().map(of));
        let body = |slab: &Slab| -> Body { slab.body(r_i) };
        let reflected = per_channel(&|slab| body(slab).reflected);
        let transmitted = per_channel(&|slab| body(slab).transmitted);
        let depth = per_channel(&|slab| (slab.scattering + slab.absorption) * slab.thickness);
        let omega = per_channel(&|slab| slab.scattering / (slab.scattering + slab.absorption));
        let through = Through {
            reflected,
            transmitted,
            ballistic: depth,
            flat_share: mean.t_mean
                * mean.t_mean
                * between_sides(reflected, transmitted, r_i, bare.eta),
        };
        Self {
            bare: albedo,
            film: Film::new(bare.eta, r_i, r_b),
            split: Split::new(
                omega * PI * (1.0 - r_i * r_b) / r_b.max(DVec3::splat(1e-3)),
                depth.element_sum() / 3.0,
                slab.phase,
                bare.eta,
            ),
            through,
        }
    }
}

/// T0/(n²[(1 − R0ρ)² − T0²ρ²]) with `rho` on both sides: light between two boundaries.
fn between_sides(reflected: DVec3, transmitted: DVec3, rho: f64, eta: f64) -> DVec3 {
    crossing(
        reflected,
        transmitted,
        DVec3::splat(rho),
        DVec3::splat(rho),
        eta,
    )
}

/// T0/(n²[(1 − R0ρ_f)(1 − R0ρ_b) − T0²ρ_fρ_b]): what crosses the paper between two boundaries of
/// internal reflectances ρ_f and ρ_b, all passes counted (Williams & Clapper's sum for two sides).
pub fn crossing(r: DVec3, t: DVec3, rho_f: DVec3, rho_b: DVec3, eta: f64) -> DVec3 {
    let passes = (1.0 - r * rho_f) * (1.0 - r * rho_b) - t * t * rho_f * rho_b;
    t / (eta * eta * passes.max(DVec3::splat(1e-6)))
}

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
    fn new(kappa: DVec3, depth: f64, phase: Phase, eta: f64) -> Self {
        let mut split = Self {
            kappa,
            mean: 0.0,
            depth,
            phase,
            capture_path: capture_path(eta),
            at_capture: DVec3::ONE,
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
        const GRID: u32 = 7;
        const TURNS: u32 = 16;
        let mut mean = 0.0;
        for i in 0..GRID {
            for o in 0..GRID {
                let [x, weight_i] = gauss_legendre(GRID, i);
                let [y, weight_o] = gauss_legendre(GRID, o);
                // 2μ dμ = d(μ²).
                let (mu_i, mu_o) = ((0.5 + 0.5 * x).sqrt(), (0.5 + 0.5 * y).sqrt());
                for turn in 0..TURNS {
                    let phi = PI * (f64::from(turn) + 0.5) / f64::from(TURNS);
                    mean += weight_i * weight_o * q(mu_i, mu_o, phi.cos()) / f64::from(TURNS);
                }
            }
        }
        let captured = q(FRAC_1_SQRT_2, 1.0, 0.0);
        split.mean = mean;
        // Where light is scattered only once, no more than all of it is.
        split.kappa = kappa.min(DVec3::splat(1.0 / mean.max(1e-9)));
        split.at_capture = 1.0 / (1.0 + split.kappa * (captured - mean)).max(DVec3::splat(1e-3));
        split
    }
}

/// 1 + κ(q − q̄), over the same in the geometry of capture.
pub fn split_shape(split: &Split, q: f64) -> DVec3 {
    (1.0 + split.kappa * (q - split.mean)).max(DVec3::ZERO) * split.at_capture
}

/// The study tier without the cosine: gallery with the ink's own path, single scattering apart,
/// and what particles leave of both. `at_i`, `at_o` and `mean` as for
/// [`brdf_gallery`](super::tier::brdf_gallery); `depth` is τ of the ink times its share of the
/// spot, `shares` are [`particle_shares`] of the spot. [`brdf_particles`] is to be added.
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
    particle: &Particle,
    shares: &Shares,
) -> DVec3 {
    let (inner_i, inner_o) = (inner_cosine(g.mu_i, s.eta), inner_cosine(g.mu_o, s.eta));
    let q = single_scatter(split, s.eta, g, inner_i, inner_o);
    let through_ink = beyond_capture(depth, split.capture_path, inner_i, inner_o);
    let coupled = at_i.t * at_o.t * mean.capture;
    let paper = shares.paper * coupled * through_ink * split_shape(split, q);
    let gloss = brdf_gallery_specular(s, g, at_i, at_o, mean) * (1.0 - particle.covered);
    (paper + shares.particles) / PI + DVec3::splat(gloss)
}

/// The light that a spot's particles mirror, without the cosine.
pub fn brdf_particles(shares: &Shares, particle: &Particle, g: &Facing) -> DVec3 {
    shares.gloss * particle_lobe(particle, g)
}

/// What a spot's photographed albedo is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shares {
    /// Diffuse albedo of the paper between particles, and of the particles.
    pub paper: DVec3,
    /// Strength of the particles' lobe, in [0, covered].
    pub gloss: f64,
    pub particles: DVec3,
}

/// Splits the photograph of a spot between paper, `bare` where nothing lies on it, and
/// particles. Fresh metal reflects more at 45°/0° than a sparse, tarnished stroke photographs:
/// the photograph bounds its gloss.
pub fn particle_shares(
    s: &Surface,
    mean: &InterfaceMean,
    bare: DVec3,
    particle: &Particle,
) -> Shares {
    let uncovered = 1.0 - particle.covered;
    let lit = (s.albedo - capture_floor(s, mean) * uncovered).max(DVec3::ZERO);
    let paper = lit.min(bare * uncovered);
    let rest = lit - paper;
    let mirrored = particle_capture(particle) * particle.covered;
    let bound = (rest / mirrored.max(DVec3::splat(1e-6))).min_element();
    let gloss = bound.clamp(0.0, 1.0);
    Shares {
        paper,
        gloss: gloss * particle.covered,
        particles: (rest - mirrored * gloss).max(DVec3::ZERO),
    }
}

/// π times the particles' lobe at 45°/0°.
pub fn particle_capture(particle: &Particle) -> DVec3 {
    let g = Facing {
        mu_i: FRAC_1_SQRT_2,
        mu_o: 1.0,
        cos_d: (0.5 + 0.5 * FRAC_1_SQRT_2).sqrt(),
        sin2_h: 0.5 - 0.5 * FRAC_1_SQRT_2,
    };
    PI * particle_lobe(particle, &g)
}

/// The lobe of full coverage, without the cosine.
pub fn particle_lobe(particle: &Particle, g: &Facing) -> DVec3 {
    let facets = d_ggx(g.sin2_h, particle.alpha) * v_smith(g.mu_i, g.mu_o, particle.alpha);
    let f = |c: usize| fresnel_conductor(g.cos_d, particle.n[c], particle.k[c]);
    DVec3::new(f(0), f(1), f(2)) * facets
}

/// Both sides of a spot, for light through it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// τ of the side that is seen, and of the other.
    pub depth_f: DVec3,
    /// Transmittance of the spot's paper over that of the sheet: laid lines, watermark.
    pub clear: f64,
    pub depth_b: DVec3,
    /// ρ of both.
    pub rho_f: DVec3,
    pub rho_b: DVec3,
}

/// T0 of a spot that is `clear` times as transparent as the sheet: what crosses more is
/// reflected less.
pub fn spot_transmitted(through: &Through, clear: f64) -> DVec3 {
    (through.transmitted * clear).min(through.reflected + through.transmitted)
}

/// [`crossing`] of a spot.
pub fn spot_crossing(through: &Through, seen: &Seen, eta: f64) -> DVec3 {
    let t = spot_transmitted(through, seen.clear);
    let r = through.reflected + through.transmitted - t;
    crossing(r, t, seen.rho_f, seen.rho_b, eta)
}

/// Share of the radiance of an even light table behind the sheet that an eye at cosine `mu_o`
/// sees through it: scattered, and straight through.
pub fn through_study(
    film: &Film,
    through: &Through,
    seen: &Seen,
    at_o: &Interface,
    mean: &InterfaceMean,
    mu_o: f64,
    eta: f64,
) -> DVec3 {
    let inner_o = inner_cosine(mu_o.max(MU_MIN), eta);
    let front = at_o.t * (-seen.depth_f / inner_o).exp();
    let scattered =
        spot_crossing(through, seen, eta) * diffuse_share(film, seen.depth_b) * mean.t_mean;
    let straight = at_o.t * (-(seen.depth_b + through.ballistic) / inner_o).exp();
    front * (scattered + straight)
}

/// BTDF without the cosine, for a lamp behind the sheet at cosine `g.mu_i` from its back.
pub fn btdf_study(
    through: &Through,
    seen: &Seen,
    g: &Facing,
    at_i: &Interface,
    at_o: &Interface,
    eta: f64,
) -> DVec3 {
    let (inner_i, inner_o) = (inner_cosine(g.mu_i, eta), inner_cosine(g.mu_o, eta));
    let inks = (-seen.depth_f / inner_o - seen.depth_b / inner_i).exp();
    inks * spot_crossing(through, seen, eta) * (at_i.t * at_o.t / PI)
}
