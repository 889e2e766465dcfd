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
//!
//! Ink lies in paper as a film: slanted light goes a longer way through it. So dark places fall off
//! faster than paper does, by the factor e^(−τ(P(μ_i) + P(μ_o) − P_c)) of the study tier
//! (`optics::ink`), τ following from how dark the place is. Taken for paper, deep ink comes out
//! a quarter too steep.

use std::f64::consts::PI;

use glam::{DVec3, DVec4};

use crate::{
    optics::{
        fresnel::fresnel_dielectric,
        ink::{FILM_TERMS, capture_path},
        microfacet::ALPHA_MIN,
        refraction::PATH_TERMS,
        table::{InterfaceTable, MU_TERMS},
        tier::{Surface, capture_floor},
    },
    prepare::model::Model,
};

/// What light does at a surface.
#[derive(Clone, Debug, PartialEq)]
#[allow(
    clippy::large_enum_variant,
    reason = "there is one of it for a whole sheet"
)]
pub enum Response {
    /// A perfect diffuser of some albedo.
    Lambert,
    /// Paper.
    Paper(Paper),
    /// Paper, and something else where it is dark.
    Inked(Box<Inked>),
}

/// Paper on which dark places have a response of their own.
#[derive(Clone, Debug, PartialEq)]
pub struct Inked {
    pub paper: Paper,
    pub dark: Paper,
    /// The mean of a place's albedo (a quarter of red and blue, half of green) below which it is
    /// dark.
    pub below: f32,
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
    /// Ink in it.
    pub(super) film: Option<Film>,
}

/// A film of ink in paper, as deep as a place is dark.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Film {
    /// P·μ′ over powers of √μ, then of w = τ/(1 + τ).
    pub paths: [[f32; 4]; PATH_TERMS],
    /// P_c over powers of w.
    pub capture: [f32; 4],
    /// H over powers of u, for each channel.
    pub excess: [[f32; 3]; FILM_TERMS],
    /// The bare paper's albedo without what its surface adds, for each channel.
    pub bare: [f32; 3],
    /// Of the index, less 1: μ′² n² = n² − 1 + μ².
    pub square: f32,
    pub index: f32,
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
            film: None,
        }
    }

    /// Ink in the paper of `model`, under a surface of roughness `alpha` and index `eta`.
    #[must_use]
    pub fn inked(model: &Model, alpha: f64, eta: f64) -> Self {
        let film = model.film();
        let alpha = alpha.clamp(ALPHA_MIN, 1.0);
        let index = film.paths.n;
        let single = |v: DVec4| v.to_array().map(|v| v as f32);
        Self {
            film: Some(Film {
                paths: film.paths.row(alpha).map(single),
                capture: single(capture_path(&film.paths, alpha)),
                excess: film.excess.map(|term| term.to_array().map(|v| v as f32)),
                bare: model.bare().to_array().map(|v| v as f32),
                square: (index * index - 1.0) as f32,
                index: index as f32,
            }),
            ..Self::new(alpha, eta, 1.0)
        }
    }

    /// The same where photographs show this much of a perfect diffuser that they should show 1 of:
    /// gloss, and the paper below ink, are as much brighter.
    #[must_use]
    pub fn at_level(mut self, level: f64) -> Self {
        self.floor *= level;
        self.specular *= level as f32;
        self.late.iter_mut().for_each(|c| *c *= level.sqrt() as f32);
        if let Some(film) = &mut self.film {
            film.bare.iter_mut().for_each(|v| *v *= level as f32);
        }
        self
    }

    /// π times Fresnel's factor, for light from `l` and an eye straight above.
    pub(super) fn fresnel(&self, l: DVec3) -> f32 {
        let h = (l + DVec3::Z).normalize();
        (PI * fresnel_dielectric(l.dot(h).clamp(0.0, 1.0), self.eta)) as f32
    }
}

impl Response {
    /// What paper does, where it is paper.
    pub(super) fn paper(&self) -> Option<&Paper> {
        match self {
            Self::Lambert => None,
            Self::Paper(paper) => Some(paper),
            Self::Inked(inked) => Some(&inked.paper),
        }
    }

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
