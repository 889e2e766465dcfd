//! The study tier: ink as a film of its own, single scattering apart and light through the sheet,
//! calibrated by the photograph. Particles and body colour are in [`super::matter`].

use std::{
    f64::consts::{FRAC_1_SQRT_2, FRAC_PI_8, PI},
    sync::Arc,
};

use glam::{DVec3, DVec4};

use super::{
    ink::{Film, beyond_capture, inner_cosine},
    quadrature::{chebyshev, gauss_legendre, through},
    refraction::{PathTable, crossed, mean_inner_cosine, steeper_by},
    slab::{Phase, Slab},
    table::{Interface, InterfaceMean, InterfaceTable},
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

/// Light through the sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Through {
    /// R0 and T0 of the paper between no boundaries, for diffuse light within.
    pub reflected: DVec3,
    /// As of [`Split`].
    pub inner_mean: f64,
    pub transmitted: DVec3,
    /// Optical thickness σt·d of the paper: light that is not scattered at all.
    pub ballistic: DVec3,
    /// −dR0/dμ′ and d ln T0/dμ′ by the mean cosine of light that enters.
    pub reflected_leaning: DVec3,
    pub transmitted_leaning: DVec3,
    /// Mean share of what has entered that goes straight through.
    pub straight_mean: DVec3,
    /// Share of a light table's radiance that bare paper shows on average, for tiers that
    /// know no angles.
    pub flat_share: DVec3,
    /// Coefficients of [`toned_paper`]'s logarithm over powers of that of the share.
    pub toned: [DVec3; TONE_TERMS],
    /// The largest share that counts: that of paper which absorbs nothing.
    pub lightest: DVec3,
}

/// Directions over a hemisphere: μ, its share of the light that enters, and its path.
type Directions = Vec<(f64, f64, DVec4)>;

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
fn per_channel(slabs: &[Slab; 3], of: impl Fn(&Slab) -> f64) -> DVec3 {
    DVec3::from_array(slabs.each_ref().map(of))
}

/// Of the bare paper's albedo: darker paper passes as little, a twentieth at most.
pub const TONE_MIN: f64 = 0.1;
/// Of the bare paper's albedo: no paper has lighter spots.
const TONE_MAX: f64 = 1.5;
/// ln of what the lightest spot passes beyond the sheet: where a sheet passes less than e^−20,
/// nobody sees more.
pub const TONE_LOG_MAX: f64 = 20.0;
/// Coefficients of what toned paper passes.
pub const TONE_TERMS: usize = 5;
/// τ of ink at which half of what the boundary sends back does not come again: ρ(1/6) is .49 of
/// ρ(0) (n = 1.5).
pub const LOST_DEPTH: f64 = 1.0 / 6.0;
/// Mean cosine of diffuse light within.
pub const DIFFUSE_COSINE: f64 = 2.0 / 3.0;

/// Share of ρ by which the paper's own light is returned from its boundary: it comes up a little
/// steeper than a perfect diffuser's. Found by walks through sheets that absorb nothing, with ink of
/// τ 0 to 2 on either side and both (n = 1.5, α = .4, d .05 and .165 mm, light at 0 and 60°): all
/// within 4.7%, with 1 within 8.9%.
pub const KEPT_WITHIN: f64 = 0.973;

/// What crosses the paper between two boundaries of internal reflectances ρ_f, before it, and ρ_b,
/// behind it, over n², all passes counted (Williams & Clapper's sum for two sides), for light
/// that enters behind and leaves before at the mean cosines `m_b` and `m_f` within: of
///
/// T0/[(1 − R0ρ_f)(1 − R0ρ_b) − T0²ρ_fρ_b]
///
/// the first and the last pass are not those of diffuse light, as what enters steeply goes deeper,
/// and by reciprocity what leaves steeply came from there.
pub fn crossing(through: &Through, seen: &Seen, m_f: f64, m_b: DVec3, eta: f64) -> DVec3 {
    // What crosses more is reflected less.
    let t = (through.transmitted * seen.clear).min(through.reflected + through.transmitted);
    let r = through.reflected + through.transmitted - t;
    let (rho_f, rho_b) = (KEPT_WITHIN * seen.rho_f, KEPT_WITHIN * seen.rho_b);
    let returned = through.reflected_leaning * seen.clear;
    let steeper = |rho: DVec3, m: DVec3| {
        let leaning = through.transmitted_leaning * (1.0 - r * rho) - returned * rho;
        (1.0 + leaning * (m - DIFFUSE_COSINE)).max(DVec3::ZERO)
    };
    let passes = (1.0 - r * rho_f) * (1.0 - r * rho_b) - t * t * rho_f * rho_b;
    t * steeper(rho_f, DVec3::splat(m_f)) * steeper(rho_b, m_b) / (eta * eta * passes)
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
fn slope(slabs: &[Slab; 3], of: impl Fn(&Slab, f64) -> f64) -> DVec3 {
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

impl Through {
    #[expect(
        clippy::too_many_arguments,
        reason = "all that a sheet's transmission depends on"
    )]
    fn new(
        slabs: &[Slab; 3],
        mean: &InterfaceMean,
        r_i: f64,
        eta: f64,
        inner_mean: f64,
        directions: &Directions,
        interface: &InterfaceTable,
        alpha: f64,
    ) -> Self {
        // Between no boundaries.
        let free = |slab: &Slab, inner: f64| slab.with_boundaries(0.0, inner);
        let ballistic = per_channel(slabs, |slab| {
            (slab.scattering + slab.absorption) * slab.thickness
        });
        let transmitted = per_channel(slabs, |slab| free(slab, DIFFUSE_COSINE).1);
        let leaning = slope(slabs, |slab, inner| free(slab, inner).1);
        let mut through = Self {
            reflected: per_channel(slabs, |slab| free(slab, DIFFUSE_COSINE).0),
            inner_mean,
            transmitted,
            ballistic,
            reflected_leaning: -slope(slabs, |slab, inner| free(slab, inner).0),
            transmitted_leaning: leaning / transmitted.max(DVec3::splat(1e-30)),
            straight_mean: directions
                .iter()
                .map(|(mu, weight, path)| {
                    *weight * interface.at(*mu, alpha).t * crossed(*path, ballistic)
                })
                .sum(),
            flat_share: DVec3::ZERO,
            toned: [DVec3::ZERO; TONE_TERMS],
            lightest: DVec3::ONE,
        };
        let bare = Seen {
            depth_f: DVec3::ZERO,
            clear: 1.0,
            depth_b: DVec3::ZERO,
            rho_f: DVec3::splat(r_i),
            rho_b: DVec3::splat(r_i),
        };
        // The adding of diffuse passes is near what diffusion between the boundaries lets through;
        // what crosses more is reflected less.
        const ROUNDS: u32 = 6;
        let whole = per_channel(slabs, |slab| slab.transmittance(r_i, inner_mean));
        for _ in 0..ROUNDS {
            let inner = DVec3::splat(inner_mean);
            let steps = crossing(&through, &bare, inner_mean, inner, eta);
            let gain = whole / (steps * mean.t_mean).max(DVec3::splat(1e-30));
            let gain = gain.clamp(DVec3::splat(0.5), DVec3::splat(2.0));
            through.reflected -= through.transmitted * (gain - 1.0);
            through.transmitted *= gain;
        }
        through.flat_share = whole * mean.t_mean;
        through
    }
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

/// Share of the bare sheet's light that comes through paper without ink that photographs as
/// `share` of the bare paper's albedo: what dims light on its long way through a sheet dims it
/// little on its way back out of it, so that T falls with the third or fourth power of R.
pub fn toned_paper(through: &Through, share: DVec3) -> DVec3 {
    let x = share.clamp(DVec3::splat(TONE_MIN), through.lightest);
    let ln_x = x.map(f64::ln);
    let c = &through.toned;
    let ln_t = (((c[4] * ln_x + c[3]) * ln_x + c[2]) * ln_x + c[1]) * ln_x + c[0];
    ln_t.min(DVec3::splat(TONE_LOG_MAX)).exp()
}

/// The same of even light, which comes in along its mean path, `m_o` the mean cosine within
/// towards the eye.
pub fn split_even(split: &Split, m_o: f64, depth: DVec3) -> DVec3 {
    let lost = depth / (depth + LOST_DEPTH) * (split.inner_mean - DIFFUSE_COSINE);
    let alike = lost * (split.inner_mean + m_o - split.captured);
    let slanted = split.inner_mean - m_o;
    (1.0 + split.leaning * slanted + split.alike * alike).max(DVec3::ZERO) * split.at_capture
}

impl Through {
    /// Sets what toned paper passes, by what all of a sheet `passes` whose albedo is a share of
    /// the bare paper's; `lightest` is the share of paper that absorbs nothing.
    fn tone(&mut self, lightest: DVec3, passes: impl Fn(DVec3) -> DVec3) {
        const NODES: [f64; TONE_TERMS] = [1.0, 0.8, 0.55, 0.3, 0.13];
        self.lightest = lightest.clamp(DVec3::splat(TONE_MIN), DVec3::splat(TONE_MAX));
        let light = self.lightest.min(DVec3::ONE);
        let bare = passes(DVec3::ONE).max(DVec3::splat(1e-30));
        let passed = NODES.map(|of| passes(light * of) / bare);
        for channel in 0..3 {
            let nodes = NODES.map(|of| (of * light[channel]).ln());
            let fitted = through(&nodes, &passed.map(|share| share[channel].max(1e-30).ln()));
            for (term, c) in self.toned.iter_mut().zip(fitted) {
                term[channel] = c;
            }
        }
    }
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

/// Share of the radiance of an even light table behind the sheet that an eye sees through it
/// along `path_o`: scattered, and straight through.
pub fn through_study(
    film: &Film,
    through: &Through,
    seen: &Seen,
    at_o: &Interface,
    mean: &InterfaceMean,
    path_o: DVec4,
    eta: f64,
) -> DVec3 {
    let straight = at_o.t * crossed(path_o, through.ballistic);
    let m_o = mean_inner_cosine(path_o);
    // Ink leaves more of the steeper light.
    let m_i = through.inner_mean + steeper_by(film.diffuse_path, seen.depth_b);
    let whole = crossing(through, seen, m_o, m_i, eta) * mean.t_mean;
    // Diffusion counts what goes straight through too.
    let scattered = (whole - straight).max(DVec3::ZERO) * crossed(film.diffuse_path, seen.depth_b);
    let front = at_o.t * crossed(path_o, seen.depth_f);
    front * (scattered + straight * crossed(path_o, seen.depth_b))
}

/// BTDF without the cosine of what the sheet scatters, for a lamp behind it whose light enters
/// along `path_i`.
#[expect(
    clippy::too_many_arguments,
    reason = "the shader's twin has no structs to borrow"
)]
pub fn btdf_study(
    through: &Through,
    seen: &Seen,
    at_i: &Interface,
    at_o: &Interface,
    mean: &InterfaceMean,
    path_i: DVec4,
    path_o: DVec4,
    eta: f64,
) -> DVec3 {
    let inks = crossed(path_o, seen.depth_f) * crossed(path_i, seen.depth_b);
    let (m_o, m_i) = (mean_inner_cosine(path_o), mean_inner_cosine(path_i));
    let whole = crossing(through, seen, m_o, DVec3::splat(m_i), eta);
    // What goes straight through is in one direction only.
    let straight_i = at_i.t * crossed(path_i, through.ballistic);
    let straight_o = at_o.t * crossed(path_o, through.ballistic);
    let straight =
        straight_i * straight_o / (through.straight_mean * mean.t_mean).max(DVec3::splat(1e-30));
    inks * (whole - straight).max(DVec3::ZERO) * (at_i.t * at_o.t / PI)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{optics::tier::capture_floor, units::Micrometres};

    /// A sheet whose bare paper has this diffuse albedo.
    fn sheet(albedo: DVec3, thickness: f64) -> Study {
        const ALPHA: f64 = 0.6;
        let interface = InterfaceTable::at_roughness(ALPHA, 1.5, 1.0);
        let paths = Arc::new(PathTable::at_roughness(ALPHA, 1.5));
        let floor = capture_floor(
            &Surface::new(albedo, ALPHA, 1.5, 1.0),
            &interface.mean_at(ALPHA),
        );
        let slab = Slab {
            thickness,
            ..Slab::rag_paper(Micrometres(0.0))
        };
        let surface = Surface::new(albedo + floor, ALPHA, 1.5, 1.0);
        Study::new(&surface, &interface, paths, slab)
    }

    #[test]
    fn toned_paper_passes_what_a_sheet_of_that_tone_does() {
        /// Of what passes; and of the light through the bare sheet.
        const PASSES: f64 = 0.02;
        for (albedo, thickness) in [
            (DVec3::new(0.77, 0.69, 0.52), 0.165),
            (DVec3::new(0.77, 0.69, 0.52), 0.05),
            (DVec3::new(0.28, 0.18, 0.09), 0.15),
        ] {
            let bare = sheet(albedo, thickness);
            for share in [0.3, 0.5, 0.7, 0.9, 1.0, 1.05, 1.15] {
                let toned = sheet(albedo * share, thickness);
                let exact = toned.through.flat_share / bare.through.flat_share;
                let found = toned_paper(&bare.through, DVec3::splat(share));
                let off = (found - exact).abs() / exact.max(DVec3::splat(0.05));
                assert!(
                    off.max_element() < PASSES,
                    "{albedo} {share}: {found} {exact}"
                );
                // By the square of its albedo, as ink does it, far more would pass.
                if share == 0.5 && thickness > 0.1 {
                    assert!((DVec3::splat(share * share) - exact).max_element() > 0.1);
                }
            }
        }
    }
}
