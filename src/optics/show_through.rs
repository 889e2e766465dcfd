//! The other side's ink in reflected light.
//!
//! Light enters the recto, crosses the paper, meets the verso's ink and its boundary, and what
//! neither keeps comes back: where the verso is inked, the recto is a little darker. With R0 and T0
//! of the paper between no boundaries, ρ_f and ρ_b of both, ink included, the paper over its backing
//! reflects R_b(ρ_b) = R0 + T0²ρ_b/(1 − R0ρ_b), and the sheet S = R_b/(1 − ρ_f R_b).
//!
//! # What a photograph holds
//! A tier is calibrated so that its render gives the photograph back. So what counts is never S
//! itself but S now over S as it was photographed:
//! - A photograph of the recto, whatever the manifest calls its source, holds the verso's ink already:
//!   counting it again would double it. This is the default.
//! - A picture that was generated, or cleaned of it, was made over a bare verso, and gets
//!   S(ρ of the ink)/S(r_i). Only the manifest can know that: `paper.show_through = "modelled"`.
//! - Where a state replaces the verso's picture and leaves the recto's, the recto was photographed over
//!   the ink of before: S(ρ of the ink now)/S(ρ of the ink then).
//!
//! # What was measured
//! The ratio is taken for all directions alike. Against walks (n = 1.5, α .4, g 1/3; σs 20, 40 and
//! 81.38 mm⁻¹, σa .05 to 1 mm⁻¹, d .02 to .15 mm with σs′d ≥ 1; τ .2 to 4 behind, 0 and .5 before) the change
//! of the photograph and of the light from 0 and 60°, where it is above 1%, is met within 13%, and
//! within 14.9% where both sides are inked. Letting steep light count more, as
//! [`super::through::crossing`] does, was worse: the paper's own light is steeper there too.
//! Sheets of σs′d below 1, thinner than any paper, are up to 60% off: what goes straight through
//! them and is mirrored at the back has a direction.

use glam::DVec3;

use super::{
    fresnel::fresnel_dielectric,
    slab::{Body, Slab},
    study::DIFFUSE_COSINE,
    through::{KEPT_WITHIN, TONE_MIN, Through},
};

/// Share of the paper's reflected light that is left over a back boundary of internal reflectance
/// `rho_b` where the photograph was taken over one of `rho_photographed`, under a front boundary of
/// `rho_f`, each in [0, 1]: S(ρ_b)/S(ρ_photographed), above 1 where less ink lies there now.
/// `clear` as of [`super::through::Seen`]; `rho_bare` is that of a boundary without ink.
///
/// Under ink, what is sent back down is steeper and goes deeper, so that more of it sees the other side:
/// by the square of how much more steep light crosses than under bare paper.
pub fn shown_through(
    through: &Through,
    clear: f64,
    rho_f: DVec3,
    rho_b: DVec3,
    rho_photographed: DVec3,
    rho_bare: DVec3,
) -> DVec3 {
    // What crosses more is reflected less.
    let t = (through.transmitted * clear).min(through.reflected + through.transmitted);
    let r = through.reflected + through.transmitted - t;
    let (front, back) = (KEPT_WITHIN * rho_f, KEPT_WITHIN * rho_b);
    let before = KEPT_WITHIN * rho_photographed;
    // The difference of both S over the second, so that alike backings change nothing at all.
    let passes = (1.0 - r * front) * (1.0 - r * back) - t * t * front * back;
    let photographed = r * (1.0 - r * before) + t * t * before;
    let change = t * t * (back - before) / (passes * photographed).max(DVec3::splat(BACKED_MIN));
    let steeper = |rho: DVec3| {
        let returned = through.reflected_leaning * clear * rho;
        let leaning = through.transmitted_leaning * (1.0 - r * rho) - returned;
        let crosses = 1.0 + leaning * (through.inner_mean - DIFFUSE_COSINE);
        crosses.clamp(DVec3::splat(0.5), DVec3::splat(2.0))
    };
    let deeper = steeper(front) / steeper(KEPT_WITHIN * rho_bare);
    (1.0 + change * deeper * deeper).clamp(DVec3::ZERO, DVec3::splat(LIGHTER_MAX))
}

/// Paper that reflects less is black, and has nothing to lose.
pub const BACKED_MIN: f64 = 1e-6;
/// Where the photograph shows next to nothing, nobody knows what lay under it: without the other
/// side's ink paper of 20 µm is twice as light.
pub const LIGHTER_MAX: f64 = 10.0;

/// The same `shown` for paper that is itself darker than the sheet: `toned` is
/// [`super::through::toned_paper`] of the photographed `share`. Both crossings are dimmed, and what
/// is reflected is less.
pub fn under_tone(shown: DVec3, toned: DVec3, share: DVec3) -> DVec3 {
    let dimmed = toned * toned / share.max(DVec3::splat(TONE_MIN));
    1.0 + (shown - 1.0) * dimmed.min(DVec3::ONE)
}

/// A bare sheet's colour at 45°/0°, and the same with ink all over its other side, linear sRGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Backed {
    pub bare: DVec3,
    pub inked: DVec3,
    /// T0 of the sheet between no boundaries.
    pub transmitted: DVec3,
}

impl Backed {
    /// A sheet that photographs as `albedo` (linear sRGB) under a smooth surface of index `eta` (> 1):
    /// `slab` gives scattering, phase and thickness. `depth` is τ of the ink per channel.
    ///
    /// It asks for no table, so that it can be asked for in each frame; what it says is that of
    /// [`shown_through`] within a few per cent.
    pub fn new(albedo: DVec3, eta: f64, slab: &Slab, depth: DVec3) -> Self {
        let n2 = eta * eta;
        let boundary = |tau: f64| internal(eta, tau);
        let r_i = boundary(0.0);
        let enters = |mu: f64| 1.0 - fresnel_dielectric(mu, eta);
        let capture = 1.0 / (enters(std::f64::consts::FRAC_1_SQRT_2) * enters(1.0));
        let bare = albedo.clamp(DVec3::splat(1e-3), DVec3::ONE);
        let mut found = Self {
            bare,
            inked: bare,
            transmitted: DVec3::ZERO,
        };
        for c in 0..3 {
            let from_within = bare[c] * n2 * capture;
            let r_b = (from_within / (1.0 + r_i * from_within)).min(1.0);
            let (reflected, transmitted) = slab
                .absorbing_to(r_b, r_i, DIFFUSE_COSINE)
                .with_boundaries(0.0, DIFFUSE_COSINE);
            let body = Body {
                reflected,
                transmitted,
            };
            let sent_back = |backing: f64| {
                let r_b = body.backed(KEPT_WITHIN * backing);
                r_b / (1.0 - KEPT_WITHIN * r_i * r_b)
            };
            let left = sent_back(boundary(depth[c])) / sent_back(r_i).max(BACKED_MIN);
            found.inked[c] *= left.min(1.0);
            found.transmitted[c] = transmitted;
        }
        found
    }
}

/// ρ(τ) = 2∫R_int(μ)e^(−2τ/μ)μ dμ of a smooth boundary.
fn internal(eta: f64, tau: f64) -> f64 {
    const STEPS: u32 = 256;
    (0..STEPS)
        .map(|i| {
            let mu = (f64::from(i) + 0.5) / f64::from(STEPS);
            let back = fresnel_dielectric(mu, 1.0 / eta) * (-2.0 * tau / mu).exp();
            2.0 * mu * back / f64::from(STEPS)
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::{
        optics::{
            ink::internal_reflectance, refraction::PathTable, study::Study, table::InterfaceTable,
            tier::Surface,
        },
        units::Micrometres,
    };

    fn through(reflected: f64, transmitted: f64) -> Through {
        Through {
            reflected: DVec3::splat(reflected),
            transmitted: DVec3::splat(transmitted),
            ..Through::default()
        }
    }

    fn shown(through: &Through, rho_b: f64) -> f64 {
        shown_through(
            through,
            1.0,
            DVec3::splat(0.6),
            DVec3::splat(rho_b),
            DVec3::splat(0.6),
            DVec3::splat(0.6),
        )
        .x
    }

    #[test]
    fn alike_backings_change_nothing_at_all() {
        for (r, t) in [(0.8, 0.2), (0.0, 1.0), (0.3, 0.1), (1.0, 0.0), (0.0, 0.0)] {
            assert_eq!(shown(&through(r, t), 0.6), 1.0);
        }
    }

    #[test]
    fn an_endless_sheet_shows_nothing_and_a_clear_one_all() {
        assert_eq!(shown(&through(0.9, 0.0), 0.0), 1.0);
        // Without paper there is only what the backing sends back.
        assert!(shown(&through(0.0, 1.0), 0.0) < 1e-12);
        let found = shown(&through(0.0, 1.0), 0.3);
        let sent = |rho: f64| KEPT_WITHIN * rho / (1.0 - KEPT_WITHIN * KEPT_WITHIN * 0.6 * rho);
        assert!((found - sent(0.3) / sent(0.6)).abs() < 1e-12, "{found}");
    }

    #[test]
    fn it_is_the_quotient_of_two_sheets_over_their_backings() {
        for (r, t) in [(0.7, 0.25), (0.4, 0.5), (0.1, 0.85)] {
            let body = Body {
                reflected: r,
                transmitted: t,
            };
            let sent = |rho: f64| {
                let r_b = body.backed(KEPT_WITHIN * rho);
                r_b / (1.0 - KEPT_WITHIN * 0.6 * r_b)
            };
            for rho in [0.0, 0.2, 0.5, 0.9] {
                let exact = sent(rho) / sent(0.6);
                let found = shown(&through(r, t), rho);
                assert!((found - exact).abs() < 1e-12, "{r} {t} {rho}: {found}");
                // With the boundary crossed once, it would be another.
                assert!((found - sent(rho.sqrt()) / sent(0.6)).abs() > 1e-3 || rho == 0.0);
                // What is taken away is put back again.
                let back = shown_through(
                    &through(r, t),
                    1.0,
                    DVec3::splat(0.6),
                    DVec3::splat(0.6),
                    DVec3::splat(rho),
                    DVec3::splat(0.6),
                );
                assert!((back.x * found - 1.0).abs() < 1e-12);
                // No light is made: what S gives back and what the back lets out are no more than all.
                let r_b = body.backed(KEPT_WITHIN * rho);
                assert!(r_b <= 1.0 && sent(rho) * (1.0 - 0.6) <= 1.0);
            }
        }
    }

    #[test]
    fn extremes_are_finite_and_no_light_is_negative() {
        for (r, t) in [
            (0.0, 0.0),
            (0.0, 1.0),
            (1.0, 0.0),
            (0.5, 0.5),
            (1e-30, 1e-30),
        ] {
            for clear in [0.0, 1e-3, 1.0, 10.0, 1e6] {
                for [f, b, before] in [[0.0, 0.0, 0.0], [1.0; 3], [1.0, 0.0, 1.0], [0.0, 1.0, 0.0]]
                {
                    let [f, b, before] = [f, b, before].map(DVec3::splat);
                    let found = shown_through(&through(r, t), clear, f, b, before, before).x;
                    assert!(
                        found.is_finite() && found >= 0.0,
                        "{r} {t} {clear}: {found}"
                    );
                }
            }
        }
    }

    #[test]
    fn tone_dims_what_shows() {
        let left = DVec3::splat(0.8);
        assert_eq!(under_tone(left, DVec3::ONE, DVec3::ONE), left);
        let toned = under_tone(left, DVec3::splat(0.5), DVec3::splat(0.75)).x;
        assert!((toned - (1.0 - 0.2 / 3.0)).abs() < 1e-12, "{toned}");
        // Lighter paper shows no more than the sheet does.
        assert_eq!(under_tone(left, DVec3::splat(1.3), DVec3::splat(1.1)), left);
        assert_eq!(under_tone(left, DVec3::ZERO, DVec3::ZERO), DVec3::ONE);
    }

    const LAID: DVec3 = DVec3::new(0.72, 0.67, 0.57);

    fn backed(thickness: f64, tau: f64) -> f64 {
        let slab = Slab::rag_paper(Micrometres(thickness));
        Backed::new(LAID, 1.5, &slab, DVec3::splat(tau)).inked.y
    }

    #[test]
    fn thinner_paper_and_deeper_ink_show_more() {
        let thicknesses = [20.0, 50.0, 100.0, 165.0, 300.0, 1e4];
        let depths = [0.0, 0.05, 0.2, 1.0, 4.0, 20.0];
        for pair in thicknesses.windows(2) {
            for tau in &depths[1..] {
                assert!(backed(pair[0], *tau) < backed(pair[1], *tau) + 1e-12);
            }
        }
        for pair in depths.windows(2) {
            for thickness in &thicknesses[..5] {
                assert!(backed(*thickness, pair[1]) < backed(*thickness, pair[0]));
            }
        }
        assert_eq!(backed(50.0, 0.0), LAID.y);
        assert!((backed(1e4, 20.0) / LAID.y - 1.0).abs() < 1e-9);
    }

    #[test]
    fn without_tables_it_is_nearly_the_same() {
        /// Of the change.
        const NEAR: f64 = 0.15;
        for thickness in [50.0, 100.0, 165.0] {
            let slab = Slab::rag_paper(Micrometres(thickness));
            let table = InterfaceTable::at_roughness(0.4, 1.5, 1.0);
            let paths = Arc::new(PathTable::at_roughness(0.4, 1.5));
            let study = Study::new(&Surface::new(LAID, 0.4, 1.5, 1.0), &table, paths, slab);
            let rho = |share: f64| internal_reflectance(&study.film, DVec3::splat(share));
            let exact = shown_through(&study.through, 1.0, rho(1.0), rho(0.0), rho(1.0), rho(1.0));
            let found = Backed::new(LAID, 1.5, &slab, DVec3::splat(20.0));
            let found = found.inked / found.bare;
            let off = ((1.0 - found) / (1.0 - exact) - 1.0).abs();
            assert!(off.max_element() < NEAR, "{thickness}: {found} {exact}");
            // A sheet twice as thick is not near.
            let other = Slab::rag_paper(Micrometres(2.0 * thickness));
            let other = Backed::new(LAID, 1.5, &other, DVec3::splat(20.0));
            let other = other.inked / other.bare;
            assert!(((1.0 - other) / (1.0 - exact) - 1.0).abs().max_element() > NEAR);
        }
    }
}
