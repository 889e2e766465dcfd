//! The rough interface: GGX facets with height-correlated Smith shadowing.

use std::f64::consts::PI;

use glam::DVec3;

use super::fresnel::fresnel_dielectric;

/// Below this roughness the distribution is too narrow for f32; it is the floor everywhere.
pub const ALPHA_MIN: f64 = 1e-4;
/// Cosines are never taken smaller, so that visibility stays finite at grazing angles.
pub const MU_MIN: f64 = 1e-4;

/// GGX distribution of facet normals in sr⁻¹, from the squared sine of the angle between
/// normal and half vector: taking the sine avoids the cancellation in 1 − cos²
/// (Walter et al. 2007, eq. 33).
pub fn d_ggx(sin2_h: f64, alpha: f64) -> f64 {
    let a2 = alpha * alpha;
    let cos2_h = 1.0 - sin2_h;
    let d = cos2_h * a2 + sin2_h;
    a2 / (PI * d * d)
}

/// Visibility G2/(4 μi μo) of height-correlated Smith shadowing (Heitz 2014, eq. 99).
pub fn v_smith(mu_i: f64, mu_o: f64, alpha: f64) -> f64 {
    let a2 = alpha * alpha;
    let l_i = mu_o * (a2 + (1.0 - a2) * mu_i * mu_i).sqrt();
    let l_o = mu_i * (a2 + (1.0 - a2) * mu_o * mu_o).sqrt();
    0.5 / (l_i + l_o)
}

/// Anisotropic GGX in sr⁻¹, from the half vector's components along x and y of the surface
/// frame; `alpha_x` and `alpha_y` are the roughnesses along these (Heitz 2014, eq. 85). Equal
/// roughnesses give [`d_ggx`].
pub fn d_ggx_anisotropic(h_x: f64, h_y: f64, alpha_x: f64, alpha_y: f64) -> f64 {
    let (x, y) = (h_x / alpha_x, h_y / alpha_y);
    let cos2_h = (1.0 - h_x * h_x - h_y * h_y).max(0.0);
    let d = x * x + y * y + cos2_h;
    1.0 / (PI * alpha_x * alpha_y * d * d)
}

/// Visibility of anisotropic height-correlated Smith shadowing, from the unit directions in the
/// surface frame: √(αx²x² + αy²y² + z²) takes the place of √(α² + (1 − α²)μ²) (Heitz 2014,
/// eq. 86 and 99).
pub fn v_smith_anisotropic(l: DVec3, v: DVec3, alpha_x: f64, alpha_y: f64) -> f64 {
    let scale = DVec3::new(alpha_x, alpha_y, 1.0);
    let l_i = v.z.max(MU_MIN) * (l * scale).length();
    let l_o = l.z.max(MU_MIN) * (v * scale).length();
    0.5 / (l_i + l_o)
}

/// Visibility without square roots, for the draft tier: between both limits of
/// [`v_smith`], α → 0 and α → 1, in proportion to α (Hammon 2017, slide 84). Reciprocal.
pub fn v_hammon(mu_i: f64, mu_o: f64, alpha: f64) -> f64 {
    let smooth = 2.0 * mu_i * mu_o;
    0.5 / (smooth + (mu_i + mu_o - smooth) * alpha)
}

/// G2/G1(μ_o): the weight of a sample drawn from the visible normals.
fn g2_over_g1(mu_i: f64, mu_o: f64, alpha: f64) -> f64 {
    let lambda = |mu: f64| {
        let tan2 = (1.0 - mu * mu).max(0.0) / (mu * mu);
        0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)
    };
    let (l_i, l_o) = (lambda(mu_i), lambda(mu_o));
    (1.0 + l_o) / (1.0 + l_i + l_o)
}

/// Directional albedo of one bounce off the rough interface towards the air.
///
/// Integrated over the visible normals (Heitz 2018) on a `steps` × `steps` grid of
/// midpoints; `mu_o` in (0, 1]. `alpha` = 0 is the smooth interface.
pub fn directional_albedo(mu_o: f64, alpha: f64, n: f64, steps: u32) -> f64 {
    if alpha < ALPHA_MIN {
        return fresnel_dielectric(mu_o, n);
    }
    let mu_o = mu_o.max(MU_MIN);
    let view = [(1.0 - mu_o * mu_o).max(0.0).sqrt(), 0.0, mu_o];
    // Stretched view direction; x and z suffice, the view lies in the x-z plane.
    let stretched = {
        let (x, z) = (alpha * view[0], view[2]);
        let length = x.hypot(z);
        [x / length, z / length]
    };
    let mut sum = 0.0;
    for i in 0..steps {
        for j in 0..steps {
            let u_1 = (f64::from(i) + 0.5) / f64::from(steps);
            let u_2 = (f64::from(j) + 0.5) / f64::from(steps);
            // A point on the projected disc of visible normals (Heitz 2018, listing 1).
            let r = u_1.sqrt();
            let phi = 2.0 * PI * u_2;
            let t_1 = r * phi.cos();
            let s = 0.5 * (1.0 + stretched[1]);
            let t_2 = (1.0 - s) * (1.0 - t_1 * t_1).max(0.0).sqrt() + s * r * phi.sin();
            let t_3 = (1.0 - t_1 * t_1 - t_2 * t_2).max(0.0).sqrt();
            // Basis: T1 = y axis of the frame, T2 = across it in the x-z plane.
            let h = [
                alpha * (-stretched[1] * t_2 + stretched[0] * t_3),
                alpha * t_1,
                (stretched[0] * t_2 + stretched[1] * t_3).max(0.0),
            ];
            let length = (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]).sqrt();
            let cos_h = (view[0] * h[0] + view[2] * h[2]) / length;
            let mu_i = 2.0 * cos_h * h[2] / length - mu_o;
            if mu_i > 0.0 && cos_h > 0.0 {
                sum += g2_over_g1(mu_i, mu_o, alpha) * fresnel_dielectric(cos_h, n);
            }
        }
    }
    sum / (f64::from(steps) * f64::from(steps))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn facets_project_to_the_surface() {
        // ∫ D cosθ dω = 1 for every roughness, on a grid that follows the lobe.
        for alpha in [1e-3, 0.05, 0.4, 1.0] {
            let steps = 20_000;
            let mut sum = 0.0;
            for i in 0..steps {
                // tan²θ = α² u/(1 − u) inverts the cumulative distribution.
                let edge = |u: f64| alpha * alpha * u / (1.0 - u);
                let sin2 = |t2: f64| t2 / (1.0 + t2);
                let (a, b) = (f64::from(i), f64::from(i + 1));
                let low = sin2(edge(a / f64::from(steps)));
                let high = if i + 1 == steps {
                    1.0
                } else {
                    sin2(edge(b / f64::from(steps)))
                };
                // dω cosθ = π d(sin²θ).
                sum += d_ggx(0.5 * (low + high), alpha) * PI * (high - low);
            }
            assert!((sum - 1.0).abs() < 1e-3, "alpha {alpha}: {sum}");
        }
    }

    #[test]
    fn equal_roughnesses_are_isotropic_and_unequal_ones_still_project_to_the_surface() {
        let (l, v) = (
            DVec3::new(0.6, 0.0, 0.8),
            DVec3::new(-0.2, 0.3, 0.9).normalize(),
        );
        let h = (l + v).normalize();
        for alpha in [1e-3, 0.2, 1.0] {
            let sin2_h = h.x * h.x + h.y * h.y;
            let d = d_ggx_anisotropic(h.x, h.y, alpha, alpha) / d_ggx(sin2_h, alpha);
            assert!((d - 1.0).abs() < 1e-9, "{alpha}: {d}");
            let visible = v_smith_anisotropic(l, v, alpha, alpha) / v_smith(l.z, v.z, alpha);
            assert!((visible - 1.0).abs() < 1e-9, "{alpha}: {visible}");
        }
        let steps = 1000;
        let mut sum = 0.0;
        for i in 0..steps {
            for j in 0..steps {
                let sin2 = (f64::from(i) + 0.5) / f64::from(steps);
                let (sin, cos) = (2.0 * PI * (f64::from(j) + 0.5) / f64::from(steps)).sin_cos();
                let r = sin2.sqrt();
                sum += d_ggx_anisotropic(r * cos, r * sin, 0.5, 0.2);
            }
        }
        // dω cosθ = dφ d(sin²θ)/2.
        let sum = sum * PI / f64::from(steps * steps);
        assert!((sum - 1.0).abs() < 1e-3, "{sum}");
    }

    #[test]
    fn visible_normals_and_brdf_agree_on_the_albedo() {
        // The sampled albedo against ∫ D V F μ dω over directions.
        for (mu_o, alpha) in [(0.9, 0.5), (0.3, 0.5), (0.5, 1.0)] {
            let sampled = directional_albedo(mu_o, alpha, 1.5, 128);
            let view = [(1.0f64 - mu_o * mu_o).sqrt(), 0.0, mu_o];
            let steps = 400;
            let mut sum = 0.0;
            for i in 0..steps {
                let mu_i = (f64::from(i) + 0.5) / f64::from(steps);
                let sin_i = (1.0 - mu_i * mu_i).sqrt();
                for j in 0..steps {
                    let phi = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(steps);
                    let light = [sin_i * phi.cos(), sin_i * phi.sin(), mu_i];
                    let h: Vec<f64> = (0..3).map(|k| light[k] + view[k]).collect();
                    let length2: f64 = h.iter().map(|x| x * x).sum();
                    let sin2_h = (h[0] * h[0] + h[1] * h[1]) / length2;
                    let cos_d =
                        (light[0] * h[0] + light[1] * h[1] + light[2] * h[2]) / length2.sqrt();
                    sum += d_ggx(sin2_h, alpha)
                        * v_smith(mu_i, mu_o, alpha)
                        * fresnel_dielectric(cos_d, 1.5)
                        * mu_i;
                }
            }
            sum *= 2.0 * PI / (f64::from(steps) * f64::from(steps));
            assert!(
                (sum - sampled).abs() < 1e-3 * sum.max(0.05),
                "{mu_o} {alpha}: {sum} {sampled}"
            );
        }
    }

    #[test]
    fn the_draft_s_visibility_is_near_the_exact_one() {
        let mut worst = 0.0f64;
        for alpha in [1e-4, 0.1, 0.3, 0.6, 1.0] {
            for mu_i in [0.1, 0.3, 0.7, 1.0] {
                for mu_o in [0.1, 0.3, 0.7, 1.0] {
                    let exact = v_smith(mu_i, mu_o, alpha);
                    worst = worst.max((v_hammon(mu_i, mu_o, alpha) / exact - 1.0).abs());
                }
            }
        }
        // 26% at the worst of these.
        assert!((0.1..0.4).contains(&worst), "{worst}");
    }

    #[test]
    fn one_bounce_loses_energy_only_when_rough() {
        // So high an index makes a mirror.
        const MIRROR: f64 = 1e9;
        assert!(directional_albedo(0.5, 0.0, MIRROR, 8) > 1.0 - 1e-6);
        assert!(directional_albedo(0.5, 0.01, MIRROR, 32) > 0.999);
        let rough = directional_albedo(0.5, 1.0, MIRROR, 64);
        // Half a mirror's light at 60° needs a second bounce when the facets are this steep.
        assert!((0.4..0.5).contains(&rough), "{rough}");
    }
}
