//! What lies on both sides of a sheet, and the optional lobes of its paper.

use bevy::render::render_resource::ShaderType;
use glam::{DVec2, Vec2, Vec3};

use crate::{
    manifest::exhibit::{Paper, SideName},
    maps::MAX_PARTICLES,
    optics::{
        lobes::stretch,
        matter::{Media, Particle},
    },
};

/// Twin of `Particle`.
#[derive(Clone, Copy, Debug, Default, ShaderType)]
pub struct ParticleUniform {
    pub n: Vec3,
    pub alpha: f32,
    pub k: Vec3,
    pub f_capture: Vec3,
    pub albedo: Vec3,
}

impl ParticleUniform {
    /// Narrows `particle`.
    pub fn new(particle: &Particle) -> Self {
        Self {
            n: particle.n.as_vec3(),
            alpha: particle.alpha as f32,
            k: particle.k.as_vec3(),
            f_capture: particle.f_capture.as_vec3(),
            albedo: particle.albedo.as_vec3(),
        }
    }
}

/// Twin of `Media`.
#[derive(Clone, Copy, Debug, Default, ShaderType)]
pub struct MediaUniform {
    pub particles: [ParticleUniform; MAX_PARTICLES],
    pub body_albedo: Vec3,
    pub body_through: Vec3,
    pub film_eta: f32,
    pub film_gain: Vec3,
    pub body_eta: f32,
    pub other_body_albedo: Vec3,
    pub film_reflects: f32,
    pub other_body_through: Vec3,
    pub body_reflects: f32,
    pub other_grains: Vec3,
    pub sheen: f32,
    pub along: Vec2,
    pub stretch: f32,
    pub retro: f32,
}

impl MediaUniform {
    /// Narrows the media of the side that is seen, of the other, and the lobes of `paper` as
    /// they lie on side `name`.
    pub fn new(media: &Media, other: &Media, paper: &Paper, name: SideName) -> Self {
        let mut uniform = Self {
            body_albedo: media.body_albedo.as_vec3(),
            body_through: media.body_through.as_vec3(),
            film_eta: media.film_eta as f32,
            film_gain: media.film_gain.as_vec3(),
            body_eta: media.body_eta as f32,
            film_reflects: media.film_reflects as f32,
            body_reflects: media.body_reflects as f32,
            other_body_albedo: other.body_albedo.as_vec3(),
            other_body_through: other.body_through.as_vec3(),
            other_grains: other.grains.as_vec3(),
            sheen: paper.sheen as f32,
            along: along(paper, name).as_vec2(),
            stretch: stretch(paper.anisotropy) as f32,
            retro: paper.retro as f32,
            ..Self::default()
        };
        for (slot, particle) in uniform.particles.iter_mut().zip(&media.particles) {
            *slot = ParticleUniform::new(particle);
        }
        uniform
    }
}

/// The way in which the gloss spreads more, x right and y up on the side: the same fibres run
/// the other way round on the back, whichever way the sheet is turned.
fn along(paper: &Paper, name: SideName) -> DVec2 {
    let (sin, cos) = paper.anisotropy_angle.0.to_radians().sin_cos();
    match name {
        SideName::Recto => DVec2::new(cos, sin),
        SideName::Verso => DVec2::new(cos, -sin),
    }
}
