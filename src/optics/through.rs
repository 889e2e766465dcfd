//! Light through the sheet, of the study tier: the paper between two boundaries with ink under
//! either, as [`super::study`] knows them.

use std::f64::consts::PI;

use glam::{DVec3, DVec4};

use super::{
    ink::Film,
    quadrature::through,
    refraction::{crossed, mean_inner_cosine, steeper_by},
    slab::Slab,
    study::{DIFFUSE_COSINE, Directions, per_channel, slope},
    table::{Interface, InterfaceMean, InterfaceTable},
};

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

/// Of the bare paper's albedo: darker paper passes as little, a twentieth at most.
pub const TONE_MIN: f64 = 0.1;
/// Of the bare paper's albedo: no paper has lighter spots.
const TONE_MAX: f64 = 1.5;
/// ln of what the lightest spot passes beyond the sheet: where a sheet passes less than e^−20,
/// nobody sees more.
pub const TONE_LOG_MAX: f64 = 20.0;
/// Coefficients of what toned paper passes.
pub const TONE_TERMS: usize = 5;
/// Share of ρ by which the paper's own light is returned from its boundary: it comes up a little
/// steeper than a perfect diffuser's. Found by walks through sheets that absorb nothing, with ink of
/// τ 0 to 2 on either side and both (n = 1.5, α = .4, d .05 and .165 mm, light at 0 and 60°): all
/// within 5.0%.
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

impl Through {
    #[expect(
        clippy::too_many_arguments,
        reason = "all that a sheet's transmission depends on"
    )]
    pub(super) fn new(
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

impl Through {
    /// Sets what toned paper passes, by what all of a sheet `passes` whose albedo is a share of
    /// the bare paper's; `lightest` is the share of paper that absorbs nothing.
    pub(super) fn tone(&mut self, lightest: DVec3, passes: impl Fn(DVec3) -> DVec3) {
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
    use std::sync::Arc;

    use super::*;
    use crate::{
        optics::{
            refraction::PathTable,
            study::Study,
            tier::{Surface, capture_floor},
        },
        units::Micrometres,
    };

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
