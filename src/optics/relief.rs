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
//!
//! # Self-shadowing
//! From each point the height map is marched towards the lamp, in the plane of the sheet, over
//! distances that grow geometrically; heights further off are read from coarser levels, as wide
//! as the gap between two readings, so that no crest is stepped over. The steepest rise is the
//! horizon, and the lamp is hidden where its own rise is less. One march serves every sample of
//! a lamp with area. (Max 1988 stores such horizons for every azimuth; here they are found for
//! the one azimuth that is asked for.)

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

/// Readings of a march.
pub const MARCH_STEPS: u32 = 16;
/// Distance of the first reading over the width of a pixel or texel: nearer ones would see
/// their own slope, which the normal shades already.
pub const MARCH_START: f64 = 1.5;
/// No march goes further, in mm.
pub const REACH_MAX: f64 = 10.0;
/// Lamps rise by no less, against a division by none.
pub const RISE_MIN: f64 = 1e-4;

/// The steepest rise that a march met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Horizon {
    /// Tangent of its elevation.
    pub tangent: f64,
    /// Width of a reading over its distance: the share of the tangent over which a shadow's edge
    /// is soft.
    pub softness: f64,
}

/// Tangent of the elevation of the direction `l` above the sheet.
pub fn rise_of(l: DVec3) -> f64 {
    l.z / (l.x * l.x + l.y * l.y).sqrt().max(1e-6)
}

/// How far, in mm, something `room` mm higher can shadow from a lamp of this rise.
pub fn march_reach(room: f64, rise: f64) -> f64 {
    (room.max(0.0) / rise.max(RISE_MIN)).min(REACH_MAX)
}

/// Distance of each reading over that of the one before it.
pub fn march_growth(near: f64, reach: f64) -> f64 {
    (reach / near).powf(1.0 / f64::from(MARCH_STEPS - 1))
}

/// The horizon after a reading at the distance `t` that is `rise` mm higher.
pub fn horizon_with(horizon: Horizon, rise: f64, t: f64, width: f64) -> Horizon {
    // A height that is no number is none.
    if rise > horizon.tangent * t {
        Horizon {
            tangent: rise / t,
            softness: width / t,
        }
    } else {
        horizon
    }
}

/// Share of a lamp of this rise that is seen over `horizon`. The soft edge lies within the shadow:
/// whatever the horizon does not reach is fully lit.
pub fn visible_over(horizon: Horizon, rise: f64) -> f64 {
    if rise <= 0.0 {
        return 0.0;
    }
    if horizon.tangent <= rise {
        return 1.0;
    }
    (1.0 + (rise - horizon.tangent) / (rise * horizon.softness)).clamp(0.0, 1.0)
}

impl Horizon {
    /// The horizon towards a lamp of this rise. `height(t, width)` is the height at the distance
    /// `t`, averaged over `width`; `top` is the highest there is. All in mm. The shader's own
    /// loop reads a texture.
    pub fn marched(rise: f64, width: f64, top: f64, height: impl Fn(f64, f64) -> f64) -> Self {
        let mut horizon = Self {
            tangent: 0.0,
            softness: 1.0,
        };
        let here = height(0.0, width);
        let (near, reach) = (MARCH_START * width, march_reach(top - here, rise));
        if reach < near {
            return horizon;
        }
        let growth = march_growth(near, reach);
        let mut t = near;
        for _ in 0..MARCH_STEPS {
            let higher = height(t, width.max(t * (growth - 1.0))) - here;
            horizon = horizon_with(horizon, higher, t, width);
            t *= growth;
        }
        horizon
    }
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
    /// Of the map in these tests, mm.
    const TEXEL: f64 = 0.05;

    /// Share of a lamp seen from `x` over the profile `height`, the lamp on the side of +x.
    fn visible(x: f64, rise: f64, top: f64, height: impl Fn(f64) -> f64) -> f64 {
        // Box of the width that is asked for, as a level of the map averages.
        const TAPS: u32 = 16;
        let horizon = Horizon::marched(rise, TEXEL, top, |t, width| {
            let tap = |i| x + t + width * ((f64::from(i) + 0.5) / f64::from(TAPS) - 0.5);
            (0..TAPS).map(|i| height(tap(i))).sum::<f64>() / f64::from(TAPS)
        });
        visible_over(horizon, rise)
    }

    fn rise(elevation: f64) -> f64 {
        rise_of(towards(elevation))
    }

    #[test]
    fn a_ridge_casts_a_shadow_as_long_as_it_should() {
        const HIGH: f64 = 0.2;
        // A wall from 0 to 1 mm; the lamp is beyond it.
        let wall = |x: f64| if (0.0..1.0).contains(&x) { HIGH } else { 0.0 };
        for elevation in [5.0, 10.0, 15.0, 30.0] {
            let expected = HIGH / rise(elevation);
            let dark = |x: &f64| visible(-x, rise(elevation), HIGH, wall) < 0.5;
            let steps = (0..8000).map(|i| f64::from(i) * 1e-3);
            let length = steps.skip(76).take_while(dark).count() as f64 * 1e-3 + 0.076;
            // The edge is a texel wide and within the shadow; readings are a gap apart.
            let reach = march_reach(HIGH, rise(elevation));
            let gap = reach * (march_growth(MARCH_START * TEXEL, reach) - 1.0);
            assert!(
                (length - expected).abs() < TEXEL + gap,
                "{elevation}: {length}, not {expected}; {gap}"
            );
            // On the side of the lamp there is none.
            assert_eq!(visible(1.2, rise(elevation), HIGH, wall), 1.0);
        }
    }

    #[test]
    fn what_nothing_hides_is_lit_exactly() {
        for elevation in [1.0, 20.0, 90.0] {
            assert_eq!(visible(0.0, rise(elevation), 0.2, |_| 0.0), 1.0);
            // A slope that faces the lamp, or faces away from it by less than its elevation.
            let slope = 0.9 * rise(elevation).min(1.0);
            assert_eq!(visible(0.0, rise(elevation), 9.0, |x| -slope * x), 1.0);
            assert_eq!(visible(0.0, rise(elevation), 9.0, |x| slope * x), 1.0);
        }
        let rough = |x: f64| 0.1 * (20.0 * x).sin();
        assert_eq!(visible(0.3, rise_of(DVec3::Z), 0.1, rough), 1.0);
    }

    #[test]
    fn a_lamp_below_the_sheet_gives_nothing() {
        assert_eq!(visible(0.0, -0.1, 0.2, |_| 0.0), 0.0);
    }

    #[test]
    fn any_height_gives_a_finite_share() {
        for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300] {
            for rise in [1e-9, 0.1, 1e6] {
                let hole = |x: f64| if x.abs() < 0.2 { 0.0 } else { bad };
                for height in [&hole as &dyn Fn(f64) -> f64, &|_| bad] {
                    let share = visible(0.0, rise, 1.0, height);
                    assert!((0.0..=1.0).contains(&share), "{bad} {rise}: {share}");
                }
            }
        }
    }

    #[test]
    fn a_shadowed_surface_receives_what_its_plane_does() {
        // Ripples steeper than the lamp: the facets alone receive more than their plane. The
        // shadows take it back, but for what widths of a texel leave.
        const KEPT: f64 = 0.05;
        let (period, steep) = (2.0, 0.8);
        let high = steep * period / TAU;
        let height = |x: f64| high * (TAU * x / period).sin();
        let rise = rise_of(DVec3::new(
            20f64.to_radians().cos(),
            0.0,
            20f64.to_radians().sin(),
        ));
        let received = |shadowed: bool| {
            let each = (0..4096).map(|i| {
                let x = period * f64::from(i) / 4096.0;
                let slope = steep * (TAU * x / period).cos();
                // (n·l)⁺/n_z over the cosine of the plane.
                let facet = (1.0 - slope / rise).max(0.0);
                let share = if shadowed {
                    visible(x, rise, high, height)
                } else {
                    1.0
                };
                facet * share
            });
            each.sum::<f64>() / 4096.0
        };
        let (with, without) = (received(true), received(false));
        eprintln!("received {with:.4} with shadows, {without:.4} without");
        assert!((with - 1.0).abs() < KEPT, "{with}");
        assert!(without - 1.0 > 4.0 * KEPT, "{without}");
    }
}
