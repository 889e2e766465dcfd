//! Reflectance of a smooth interface.

/// Unpolarised Fresnel reflectance of a dielectric, exact.
///
/// `cos_i` in [0, 1] is the cosine on the side the light comes from, `eta` > 0 the index behind
/// the interface over the index in front of it. Total reflection gives 1.
/// Source: Born & Wolf, Principles of Optics, §1.5.2.
pub fn fresnel_dielectric(cos_i: f64, eta: f64) -> f64 {
    let c = cos_i.clamp(0.0, 1.0);
    // With k = eta² − 1 and g = eta cos_t, both amplitudes are multiples of k: the usual
    // differences cancel in f32 at indices near 1, and 1 − sin² loses a grazing ray.
    let k = (eta - 1.0) * (eta + 1.0);
    let g2 = k + c * c;
    if g2 <= 0.0 {
        return 1.0;
    }
    let g = g2.sqrt();
    let s = c + g;
    let p = (k + 1.0) * c + g;
    let r_s = k / (s * s);
    let r_p = k * ((k + 2.0) * c * c - 1.0) / (p * p);
    0.5 * (r_s * r_s + r_p * r_p)
}

/// Schlick's approximation: `f_0` + (1 − `f_0`)(1 − `cos_i`)⁵ (Schlick 1994, eq. 15).
pub fn fresnel_schlick(cos_i: f64, f_0: f64) -> f64 {
    let m = (1.0 - cos_i).clamp(0.0, 1.0);
    let m2 = m * m;
    f_0 + (1.0 - f_0) * m2 * m2 * m
}

/// Unpolarised Fresnel reflectance of a material of index `n` + i`k` in air, exact.
///
/// `cos_i` in [0, 1], `n` > 0, `k` ≥ 0. With `k` = 0 it is [`fresnel_dielectric`].
/// Source: Born & Wolf, §14.2, in the arrangement of Lazányi & Szirmay-Kalos 2005, eq. 3 and 4.
pub fn fresnel_conductor(cos_i: f64, n: f64, k: f64) -> f64 {
    let c = cos_i.clamp(0.0, 1.0);
    let c2 = c * c;
    let s2 = 1.0 - c2;
    // a + ib is the root of (n + ik)² − s², whose real part is d = e + c². All differences are
    // taken before the squares, which would cancel where n + ik is near 1.
    let e = (n - 1.0) * (n + 1.0) - k * k;
    let d = e + c2;
    let q = 2.0 * n * k;
    let half = 0.5 * q * q / ((d * d + q * q).sqrt() + d.abs()).max(1e-12);
    let (a2, b2, a2_minus_c2) = if d >= 0.0 {
        (d + half, half, e + half)
    } else {
        (half, half - d, half - c2)
    };
    let a = a2.sqrt();
    let sum = (a + c).max(1e-6);
    let difference = a2_minus_c2 / sum;
    let r_s = (difference * difference + b2) / (sum * sum + b2);
    let (p, m) = (a * c + s2, a * c - s2);
    let r_p = r_s * (m * m + b2 * c2) / (p * p + b2 * c2).max(1e-12);
    0.5 * (r_s + r_p)
}

/// Reflectance at normal incidence of a dielectric of index ratio `eta`.
pub fn normal_reflectance(eta: f64) -> f64 {
    let r = (eta - 1.0) / (eta + 1.0);
    r * r
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conductors_meet_their_closed_forms() {
        let normal = |n: f64, k: f64| ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k);
        for (n, k) in [
            (0.06, 3.6),
            (1.83, 3.4),
            (3.32, 0.5),
            (1.5, 0.0),
            (1e-2, 20.0),
        ] {
            assert!((fresnel_conductor(1.0, n, k) - normal(n, k)).abs() < 1e-12);
            assert!((fresnel_conductor(0.0, n, k) - 1.0).abs() < 1e-9);
        }
        for cos_i in [0.01, 0.3, 0.5547, 0.9] {
            let (metal, glass) = (
                fresnel_conductor(cos_i, 1.5, 0.0),
                fresnel_dielectric(cos_i, 1.5),
            );
            assert!((metal - glass).abs() < 1e-12, "{cos_i}: {metal} {glass}");
        }
        // Silver hardly has a pseudo-Brewster dip, black chalk has one.
        assert!(fresnel_conductor(0.2, 0.06, 3.6) > 0.95);
        assert!(fresnel_conductor(0.55, 1.56, 0.46) < fresnel_conductor(0.1, 1.56, 0.46));
    }

    #[test]
    fn closed_forms_of_the_exact_reflectance() {
        assert!((fresnel_dielectric(1.0, 1.5) - 0.04).abs() < 1e-15);
        assert!((fresnel_dielectric(0.0, 1.5) - 1.0).abs() < 1e-12);
        // Brewster's angle: only the s part is left, ((1 − n²)/(1 + n²))²/2.
        let brewster = 1.5f64.atan().cos();
        let s_only = 0.5 * ((1.0 - 2.25f64) / (1.0 + 2.25)).powi(2);
        assert!((fresnel_dielectric(brewster, 1.5) - s_only).abs() < 1e-15);
        // Beyond the critical angle, seen from inside.
        assert_eq!(fresnel_dielectric(0.5, 1.0 / 1.5), 1.0);
    }

    #[test]
    fn diffuse_reflectance_is_the_published_one() {
        // r_e = 2∫Fμ dμ = .0918 for n = 1.5 (OPTICS.md, Interface).
        let steps = 20_000;
        let r_e: f64 = (0..steps)
            .map(|i| {
                let mu = (f64::from(i) + 0.5) / f64::from(steps);
                2.0 * fresnel_dielectric(mu, 1.5) * mu / f64::from(steps)
            })
            .sum();
        assert!((r_e - 0.0918).abs() < 5e-5, "{r_e}");
    }

    #[test]
    fn schlick_meets_the_exact_form_at_both_ends_only() {
        let f_0 = normal_reflectance(1.5);
        assert_eq!(fresnel_schlick(1.0, f_0), f_0);
        assert_eq!(fresnel_schlick(0.0, f_0), 1.0);
        let at_60 = (fresnel_schlick(0.5, f_0) - fresnel_dielectric(0.5, 1.5)).abs();
        assert!((0.005..0.05).contains(&at_60), "{at_60}");
    }
}
