//! Relief too fine for a pixel, and relief that shadows itself.
//!
//! # The scale effect
//! A pixel that covers many normals sees their mean m = E\[n\], shorter than 1. The irradiance
//! of a perfect diffuser is linear in the normal, so its mean is m·l, and not that of the unit
//! vector along m. With slopes p, n = (−p, 1)/√(1 + |p|²), so that to the second order
//! |m|² = 1 − Var p, where Var p = Var p_x + Var p_y: the length of the mean tells the variance
//! of the slopes, s² = (1 − |m|²)/|m|² (Toksvig 2005 takes (1 − |m|)/|m| for the exponent of
//! Blinn-Phong, the same to this order for one of the two axes). Facets of roughness α have the
//! slope variance α² over both axes (Olano & Baker 2010, section 3: Beckmann's α² = 2σ²), and
//! variances of a sum of independent slopes add (Han et al. 2007 convolve the distributions):
//! α'² = α² + s².

use glam::DVec3;

use super::microfacet::ALPHA_MIN;

/// Means of normals are never taken shorter: their spread is then beyond any roughness.
pub const MEAN_LENGTH_MIN: f64 = 0.1;
/// How far 1 − |m|² strays by 16-bit texels and 8-bit weights of filters: not a spread. The
/// roughness that it hides is .01.
pub const SHORTENING_NOISE: f64 = 1e-4;

/// Length of a mean of unit normals, in [[`MEAN_LENGTH_MIN`], 1].
pub fn mean_length(mean: DVec3) -> f64 {
    mean.dot(mean)
        .clamp(MEAN_LENGTH_MIN * MEAN_LENGTH_MIN, 1.0)
        .sqrt()
}

/// Variance s² of the slopes, both axes together, under a mean normal of this length.
pub fn slope_variance(length: f64) -> f64 {
    let l_2 = length * length;
    (1.0 - l_2 - SHORTENING_NOISE).max(0.0) / l_2
}

/// Roughness α' of facets of roughness `alpha` on relief whose mean normal has this length.
pub fn widened(alpha: f64, length: f64) -> f64 {
    (alpha * alpha + slope_variance(length))
        .sqrt()
        .clamp(ALPHA_MIN, 1.0)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::optics::microfacet::d_ggx;

    /// Slopes of a ripple, and of a ripple across it.
    const STEEP: f64 = 0.2;
    const STEPS: u32 = 256;

    /// Unit normals over one period of crossed ripples.
    fn normals() -> Vec<DVec3> {
        let slope = |i: u32| STEEP * (TAU * (f64::from(i) + 0.5) / f64::from(STEPS)).cos();
        (0..STEPS * STEPS)
            .map(|i| DVec3::new(-slope(i % STEPS), -slope(i / STEPS), 1.0).normalize())
            .collect()
    }

    fn mean(of: impl Fn(DVec3) -> f64) -> f64 {
        let normals = normals();
        normals.iter().map(|&n| of(n)).sum::<f64>() / normals.len() as f64
    }

    fn mean_normal() -> DVec3 {
        let normals = normals();
        normals.iter().sum::<DVec3>() / normals.len() as f64
    }

    fn towards(elevation: f64) -> DVec3 {
        let (sin, cos) = elevation.to_radians().sin_cos();
        DVec3::new(0.8 * cos, 0.6 * cos, sin)
    }

    #[test]
    fn far_and_near_diffusers_have_one_mean() {
        let far = mean_normal();
        let length = mean_length(far);
        // Above 16°, the steepest slope in this azimuth, every facet is lit.
        for elevation in [90.0, 45.0, 17.0] {
            let l = towards(elevation);
            let near = mean(|n| n.dot(l).max(0.0));
            let shown = far.normalize().dot(l) * length;
            assert!(
                (shown / near - 1.0).abs() < 1e-12,
                "{elevation}: {shown} {near}"
            );
            // At full length it is too bright by the lost 2%.
            assert!(far.normalize().dot(l) / near > 1.015);
        }
    }

    #[test]
    fn the_surface_receives_what_its_plane_does() {
        // The mean of (n·l)/n_z over the plane, where nothing is shadowed, is the plane's cosine.
        for elevation in [90.0, 45.0, 17.0] {
            let l = towards(elevation);
            let received = mean(|n| n.dot(l).max(0.0) / n.z);
            assert!((received - l.z).abs() < 1e-12, "{elevation}: {received}");
        }
    }

    #[test]
    fn the_length_tells_the_variance_of_slopes() {
        // Two ripples of variance STEEP²/2 each; the next order is about 3/2 of its square.
        let exact = STEEP * STEEP;
        let found = slope_variance(mean_length(mean_normal())) + SHORTENING_NOISE;
        assert!((found / exact - 1.0).abs() < 2.0 * exact, "{found} {exact}");
    }

    #[test]
    fn a_grained_mirror_seen_from_far_is_wide() {
        // Peak of the lobe, light and eye at the zenith, averaged over normally distributed
        // slopes (Box & Muller 1958). Both have the peak 1/(πα²); the convolution of GGX with
        // them is neither, hence a factor and not a tolerance.
        const FACTOR: f64 = 1.5;
        let alpha = 0.05;
        let grain: Vec<DVec3> = (0..STEPS * STEPS)
            .map(|i| {
                let share = |i: u32| (f64::from(i) + 0.5) / f64::from(STEPS);
                let steep = STEEP * (-share(i / STEPS).ln()).sqrt();
                let (sin, cos) = (TAU * share(i % STEPS)).sin_cos();
                DVec3::new(-steep * cos, -steep * sin, 1.0).normalize()
            })
            .collect();
        let count = grain.len() as f64;
        let peaks = grain.iter().map(|n| d_ggx(1.0 - n.z * n.z, alpha));
        let near = peaks.sum::<f64>() / count;
        let length = mean_length(grain.iter().sum::<DVec3>() / count);
        let shown = d_ggx(0.0, widened(alpha, length));
        assert!(
            shown / near < FACTOR && near / shown < FACTOR,
            "{shown} {near}"
        );
        let unwidened = d_ggx(0.0, alpha);
        assert!(unwidened / near > 5.0 * FACTOR, "{unwidened} {near}");
    }

    #[test]
    fn flat_paper_keeps_its_roughness() {
        for alpha in [ALPHA_MIN, 0.05, 1.0] {
            // What the coding of texels leaves of 1 is no spread.
            for length in [1.0, 1.0 - 4e-5] {
                assert_eq!(widened(alpha, length), alpha);
            }
        }
    }

    #[test]
    fn stays_within_its_range_for_any_mean() {
        for m in [0.0, 1e-30, 0.3, 1.0, 1.1, 1e30, f64::INFINITY] {
            let length = mean_length(DVec3::new(0.0, 0.0, m));
            assert!((MEAN_LENGTH_MIN..=1.0).contains(&length), "{m}: {length}");
            let alpha = widened(0.3, length);
            assert!((0.3..=1.0).contains(&alpha), "{m}: {alpha}");
        }
    }
}
