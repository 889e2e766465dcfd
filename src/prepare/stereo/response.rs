//! How much light a surface sends straight up, by where it faces.
//!
//! Paper is not Lambertian: what its surface mirrors does not reach the fibres, on the way in and
//! on the way out, so that at a slant it is darker than n·l says, and near the mirror's angle it
//! gleams. This is the gallery tier of the same paper (`optics::tier`), in which a photograph
//! shows
//!
//! > gain · μ_i · \[body · T(μ_i) T(μ_o) capture + π f_s\],  body = albedo − floor
//!
//! with the albedo as a reproduction at 45°/0° shows it. The solver divides by it what it sees,
//! with the normal that it has so far.

use std::f64::consts::PI;

use glam::DVec3;

use crate::optics::{
    fresnel::fresnel_dielectric,
    microfacet::ALPHA_MIN,
    table::{InterfaceTable, MU_TERMS},
    tier::{Surface, capture_floor},
};

/// What light does at a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Response {
    /// A perfect diffuser of some albedo.
    Lambert,
    /// Paper.
    Paper(Paper),
}

/// Paper of one roughness and index.
#[derive(Clone, Debug, PartialEq)]
pub struct Paper {
    /// T over powers of √μ.
    pub(super) t: [f32; MU_TERMS],
    /// Compensation for several bounces, over powers of √μ: its square root times what comes late.
    pub(super) late: [f32; MU_TERMS],
    pub(super) capture: f32,
    pub(super) alpha: f32,
    pub(super) specular: f32,
    eta: f64,
    /// What the surface itself adds to a reproduction's albedo.
    pub floor: f64,
}

impl Paper {
    /// Paper of GGX roughness `alpha` and index `eta`, whose gloss has this strength (1 is
    /// physical).
    pub fn new(alpha: f64, eta: f64, specular: f64) -> Self {
        let alpha = alpha.clamp(ALPHA_MIN, 1.0);
        let table = InterfaceTable::at_roughness(alpha, eta, specular);
        let row = table.row(alpha);
        let mean = table.mean_at(alpha);
        let surface = Surface::new(DVec3::ONE, alpha, eta, specular);
        let late_scale = (PI * mean.compensation).sqrt();
        Self {
            t: row.t.map(|c| c as f32),
            late: row.late.map(|c| (c * late_scale) as f32),
            capture: mean.capture as f32,
            alpha: alpha as f32,
            specular: specular as f32,
            eta,
            floor: capture_floor(&surface, &mean),
        }
    }

    /// π times Fresnel's factor, for light from `l` and an eye straight above.
    pub(super) fn fresnel(&self, l: DVec3) -> f32 {
        let h = (l + DVec3::Z).normalize();
        (PI * fresnel_dielectric(l.dot(h).clamp(0.0, 1.0), self.eta)) as f32
    }
}

impl Response {
    /// Bare laid paper's, by the catalogue.
    pub fn laid_paper() -> Self {
        use crate::optics::medium::MediumId;
        let laid = "laid".parse::<MediumId>().ok();
        laid.map_or(Self::Lambert, |laid| {
            let medium = laid.medium();
            Self::Paper(Paper::new(medium.roughness(), medium.index(), 1.0))
        })
    }
}
