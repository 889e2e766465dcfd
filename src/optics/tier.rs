//! The ladder of tiers: what each keeps of the physics, and its BRDF.

use std::{
    f64::consts::{FRAC_1_SQRT_2, FRAC_PI_8, PI},
    fmt,
    str::FromStr,
};

use glam::DVec3;

use super::{
    fresnel::{fresnel_dielectric, fresnel_schlick, normal_reflectance},
    microfacet::{ALPHA_MIN, MU_MIN, d_ggx, v_hammon, v_smith},
    table::{Interface, InterfaceMean},
};

/// A level of accuracy, or a baseline from the literature.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Tier {
    /// Lambert with the ink baked in, GGX with Schlick's Fresnel, punctual lamps.
    Draft,
    /// Diffuse light coupled to the interface, exact Fresnel, compensation, area lamps.
    #[default]
    Gallery,
    /// Ink as a layer of its own, single scattering apart, light through both sides.
    Study,
    /// The shader of Apollonio et al. 2021: Burley's diffuse term, GGX, Schlick.
    Isle,
    /// A perfect diffuser with the map's albedo.
    Lambert,
    /// Lambert and Phong's lobe, normalised.
    Phong,
    /// Lambert and Blinn's lobe, normalised.
    BlinnPhong,
    /// Lambert and Cook & Torrance's facets with Beckmann's distribution.
    CookTorrance,
    /// Rough diffusers by Oren & Nayar 1994, the qualitative model.
    OrenNayar,
    /// Phong's highlight as he wrote it, which is no BRDF.
    PhongPlain,
    /// Blinn's highlight as he wrote it, which is no BRDF.
    BlinnPhongPlain,
    /// Cook & Torrance with a Gaussian distribution.
    CookTorranceGauss,
    /// Cook & Torrance with Blinn's distribution.
    CookTorranceBlinn,
}

impl Tier {
    /// Every tier, in the order of the command line's help.
    pub const ALL: [Self; 13] = [
        Self::Draft,
        Self::Gallery,
        Self::Study,
        Self::Isle,
        Self::Lambert,
        Self::Phong,
        Self::BlinnPhong,
        Self::CookTorrance,
        Self::OrenNayar,
        Self::PhongPlain,
        Self::BlinnPhongPlain,
        Self::CookTorranceGauss,
        Self::CookTorranceBlinn,
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Draft => "draft",
            Self::Gallery => "gallery",
            Self::Study => "study",
            Self::Isle => "isle",
            Self::Lambert => "lambert",
            Self::Phong => "phong",
            Self::BlinnPhong => "blinn-phong",
            Self::CookTorrance => "cook-torrance",
            Self::OrenNayar => "oren-nayar",
            Self::PhongPlain => "phong-plain",
            Self::BlinnPhongPlain => "blinn-phong-plain",
            Self::CookTorranceGauss => "cook-torrance-gauss",
            Self::CookTorranceBlinn => "cook-torrance-blinn",
        }
    }

    /// Whether what the surface reflects is missing underneath: gallery and study.
    pub fn is_coupled(self) -> bool {
        matches!(self, Self::Gallery | Self::Study)
    }
}

impl fmt::Display for Tier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// No tier has this name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no tier has this name")]
pub struct UnknownTier;

impl FromStr for Tier {
    type Err = UnknownTier;

    fn from_str(name: &str) -> Result<Self, UnknownTier> {
        Self::ALL
            .into_iter()
            .find(|tier| tier.name() == name)
            .ok_or(UnknownTier)
    }
}

/// One point of the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Reflectance as photographed, ink included, linear sRGB.
    pub albedo: DVec3,
    /// GGX roughness, floored at [`ALPHA_MIN`].
    pub alpha: f64,
    /// Index of the surface over that of air.
    pub eta: f64,
    /// Reflectance at normal incidence.
    pub f_normal: f64,
    /// Strength of the specular lobe; 1 is physical.
    pub specular: f64,
    /// Fresnel reflectance of facets that mirror 45° light straight up, into a reproduction.
    pub f_capture: f64,
}

impl Surface {
    /// A surface from its constants, with the roughness floored.
    pub fn new(albedo: DVec3, alpha: f64, eta: f64, specular: f64) -> Self {
        let f_normal = normal_reflectance(eta);
        Self {
            albedo,
            alpha: alpha.clamp(ALPHA_MIN, 1.0),
            eta,
            f_normal,
            specular,
            f_capture: fresnel_dielectric(FRAC_PI_8.cos(), eta),
        }
    }
}

/// How light, eye and normal lie to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facing {
    pub mu_i: f64,
    pub mu_o: f64,
    /// Cosine between the light and the half vector.
    pub cos_d: f64,
    /// Squared sine between the normal and the half vector.
    pub sin2_h: f64,
}

/// From unit vectors: normal, towards the light, towards the eye. Cosines are floored at
/// [`MU_MIN`]: whether light arrives at all is the caller's to decide.
pub fn facing(n: DVec3, l: DVec3, v: DVec3) -> Facing {
    let sum = l + v;
    // Light from straight behind the eye's opposite: any half vector will do, but no 0/0.
    let h = sum / sum.length().max(1e-6);
    let across = n.cross(h);
    Facing {
        mu_i: n.dot(l).max(MU_MIN),
        mu_o: n.dot(v).max(MU_MIN),
        cos_d: l.dot(h).clamp(0.0, 1.0),
        sin2_h: across.dot(across).min(1.0),
    }
}

/// A perfect diffuser's BRDF, without the cosine.
pub fn brdf_lambert(s: &Surface) -> DVec3 {
    s.albedo / PI
}

/// The draft tier: baked ink under an uncoupled lobe, without the cosine.
pub fn brdf_draft(s: &Surface, g: &Facing) -> DVec3 {
    let lobe = d_ggx(g.sin2_h, s.alpha)
        * v_hammon(g.mu_i, g.mu_o, s.alpha)
        * fresnel_schlick(g.cos_d, s.f_normal);
    s.albedo / PI + DVec3::splat(s.specular * lobe)
}

/// Squared sine of the half angle between light and eye in reproduction photography, 22.5°.
const CAPTURE_SIN2_H: f64 = 0.5 - 0.5 * FRAC_1_SQRT_2;

/// What the surface itself adds to an albedo photographed at 45°/0°: its lobe and compensation.
pub fn capture_floor(s: &Surface, mean: &InterfaceMean) -> f64 {
    let lobe = d_ggx(CAPTURE_SIN2_H, s.alpha) * v_smith(FRAC_1_SQRT_2, 1.0, s.alpha);
    PI * s.specular * lobe * s.f_capture + mean.floor
}

/// The diffuse part of the photographed albedo: without what the surface reflected into the
/// photograph, and no higher than a sheet that gives back all light can photograph, 1/(t̄·capture).
/// A spot darker than the surface's own reflection has none.
pub fn albedo_of(s: &Surface, mean: &InterfaceMean) -> DVec3 {
    // Colours outside sRGB have negative channels, which are kept.
    (s.albedo - capture_floor(s, mean))
        .max(s.albedo.min(DVec3::ZERO))
        .min(DVec3::splat(1.0 / (mean.t_mean * mean.capture)))
}

/// The gallery tier: what the interface reflects, the diffuser underneath does not get, on the
/// way in and on the way out; without the cosine. `at_i`, `at_o` and `mean` are the tabulated
/// interface at both cosines and the surface's roughness.
pub fn brdf_gallery(
    s: &Surface,
    g: &Facing,
    at_i: &Interface,
    at_o: &Interface,
    mean: &InterfaceMean,
) -> DVec3 {
    let diffuse = at_i.t * at_o.t * mean.capture / PI;
    albedo_of(s, mean) * diffuse + DVec3::splat(brdf_gallery_specular(s, g, at_i, at_o, mean))
}

/// The gallery tier's gloss: one bounce, and the compensation for more.
pub fn brdf_gallery_specular(
    s: &Surface,
    g: &Facing,
    at_i: &Interface,
    at_o: &Interface,
    mean: &InterfaceMean,
) -> f64 {
    let lobe = d_ggx(g.sin2_h, s.alpha)
        * v_smith(g.mu_i, g.mu_o, s.alpha)
        * fresnel_dielectric(g.cos_d, s.eta);
    s.specular * lobe + mean.compensation * at_i.late * at_o.late
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for tier in Tier::ALL {
            assert_eq!(tier.name().parse::<Tier>().ok(), Some(tier));
        }
        assert!("gallerie".parse::<Tier>().is_err());
    }
}
