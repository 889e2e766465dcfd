//! The paper that prepared maps are shown by, in `f64`: what the study tier makes of a place, for
//! fits that undo it.

use std::{f64::consts::PI, sync::Arc};

use glam::{DQuat, DVec3};

use crate::optics::{
    bsdf::Specimen,
    ink,
    matter::{
        Cover, Media, Particle, SideMedia, borne_out, passing, uncovered_share, veiled, with_borne,
    },
    medium::{Matter, Medium, MediumId, PaperConstants},
    refraction::PathTable,
    slab::{Phase, Slab, UM_PER_MM},
    study::Study,
    table::{InterfaceMean, InterfaceTable},
    through::{Seen, through_study, toned_paper},
    tier::{Surface, Tier, capture_floor},
};

/// A sheet whose bare paper is known, as the study tier shows it.
#[derive(Clone, Debug)]
pub struct Model {
    paper: PaperConstants,
    /// Bare paper.
    pub surface: Surface,
    interface: InterfaceTable,
    study: Study,
    mean: InterfaceMean,
}

impl Model {
    /// Paper of these constants, whose albedo is the bare paper's as photographed.
    pub fn new(paper: PaperConstants) -> Self {
        let surface = Surface::new(paper.albedo.into(), paper.roughness, paper.index, 1.0);
        let interface = InterfaceTable::new(paper.index, 1.0);
        let here = InterfaceTable::at_roughness(surface.alpha, paper.index, 1.0);
        let slab = Slab {
            scattering: paper.scattering_per_mm,
            absorption: 0.0,
            thickness: paper.thickness_um / UM_PER_MM,
            phase: Phase {
                forward_share: paper.forward_share,
                g_forward: paper.g_forward,
                g_backward: paper.g_backward,
            },
        };
        let paths: Arc<PathTable> = PathTable::new(paper.index);
        let study = Study::new(&surface, &here, paths, slab);
        let mean = here.mean_at(surface.alpha);
        Self {
            paper,
            surface,
            interface,
            study,
            mean,
        }
    }

    /// Laid paper of the catalogue whose bare places photograph as `albedo`.
    pub fn laid(albedo: DVec3) -> Option<Self> {
        let laid = "laid".parse::<MediumId>().ok()?.medium();
        let Matter::Paper(paper) = laid.matter else {
            return None;
        };
        Some(Self::new(PaperConstants {
            albedo: albedo.to_array(),
            ..paper
        }))
    }

    /// Its constants.
    pub fn paper(&self) -> PaperConstants {
        self.paper
    }

    /// The same with other constants.
    #[must_use]
    pub fn with(&self, change: impl FnOnce(&mut PaperConstants)) -> Self {
        let mut paper = self.paper;
        change(&mut paper);
        Self::new(paper)
    }

    /// A spot that `medium` covers, or of bare paper; its albedo is yet to be set.
    pub fn spot(&self, medium: Option<&Medium>) -> Spot<'_> {
        let mut cover = Cover::default();
        let mut side = SideMedia::default();
        let mut particle = Particle {
            alpha: 1.0,
            ..Particle::default()
        };
        let mut alpha = self.surface.alpha;
        match medium.map(|medium| medium.matter) {
            Some(Matter::Film(film)) => {
                cover.film = 1.0;
                alpha = film.roughness;
                side.films.push(film);
            }
            Some(Matter::Body(body)) => {
                cover.body = 1.0;
                alpha = body.roughness;
                side.bodies.push(body);
            }
            Some(Matter::Particles(particles)) => {
                particle = Particle::new(&particles);
                cover.particles = 1.0;
                cover.grains = particle.albedo;
                side.particles.push(particles);
            }
            _ => {}
        }
        let media = Media::new(&side, &self.surface, &self.mean, &self.study);
        let surface = Surface::new(self.surface.albedo, alpha, self.paper.index, 1.0);
        let mut spot = Spot {
            model: self,
            specimen: Specimen {
                surface,
                interface: self.interface.clone(),
                study: self.study.clone(),
                cover,
                particle,
                body_albedo: media.body_albedo,
                body_through: media.body_through,
                left: DVec3::ONE,
            },
            whole: cover,
        };
        spot.set_roughness(match medium.map(|medium| medium.matter) {
            Some(Matter::Particles(particles)) => particles.roughness,
            _ => alpha,
        });
        spot
    }
}

/// A place of a sheet.
#[derive(Clone, Debug)]
pub struct Spot<'m> {
    model: &'m Model,
    specimen: Specimen,
    /// As a map of media says, before the photograph bears it out.
    whole: Cover,
}

impl Spot<'_> {
    /// Sets the roughness of what lies on top: of grains, of a film or body colour, or of paper.
    pub fn set_roughness(&mut self, alpha: f64) {
        if self.whole.particles > 0.0 {
            self.specimen.particle.alpha = alpha;
            return;
        }
        let Surface { albedo, eta, .. } = self.specimen.surface;
        self.specimen.surface = Surface::new(albedo, alpha, eta, 1.0);
    }

    /// Sets what it photographs as at 45°/0°.
    pub fn set_albedo(&mut self, albedo: DVec3) {
        let surface = &mut self.specimen.surface;
        surface.albedo = albedo;
        if self.whole.particles > 0.0 {
            let mean = self.specimen.interface.mean_at(surface.alpha);
            let (bare, body) = (self.model.study.bare, self.specimen.body_albedo);
            let borne = borne_out(surface, &mean, bare, body, &self.whole);
            self.specimen.cover = with_borne(&self.whole, borne);
        }
    }

    /// π times the radiance towards the camera, straight above the sheet, over the light that
    /// falls on a place that faces it: from `l`, where the surface faces along `normal`.
    pub fn shown(&self, normal: DVec3, l: DVec3) -> DVec3 {
        let mu = normal.dot(l);
        if mu <= 0.0 {
            return DVec3::ZERO;
        }
        let upright = DQuat::from_rotation_arc(normal, DVec3::Z);
        let f = self
            .specimen
            .reflected(Tier::Study, upright * l, upright * DVec3::Z, 1.0);
        f * (PI * mu)
    }

    /// What its surface itself adds to its albedo; nothing of grains, whose albedo holds it.
    pub fn floor(&self) -> f64 {
        let Specimen {
            surface, interface, ..
        } = &self.specimen;
        match self.whole.particles > 0.0 {
            true => 0.0,
            false => capture_floor(surface, &interface.mean_at(surface.alpha)),
        }
    }

    fn share(&self) -> DVec3 {
        uncovered_share(&self.specimen.shares(), self.model.study.bare)
    }

    /// τ of its ink per channel; 0 where it is none.
    pub fn depth(&self) -> DVec3 {
        self.specimen.depth()
    }

    /// Share of a light table's radiance that the camera, straight above, sees through it, where
    /// the paper passes `clear` times what the sheet does.
    pub fn passes(&self, clear: f64) -> DVec3 {
        let Specimen {
            surface,
            interface,
            study,
            cover,
            body_through,
            ..
        } = &self.specimen;
        let mean = interface.mean_at(surface.alpha);
        let (film, through) = (&study.film, &study.through);
        let share = self.share();
        let toned = toned_paper(through, share);
        let rho = |share: DVec3| ink::internal_reflectance(film, share);
        let darkness = ink::optical_depth(film, self.specimen.capture(), share);
        let seen = Seen {
            depth_f: veiled(cover, *body_through, toned, darkness),
            clear,
            depth_b: DVec3::ZERO,
            rho_f: rho(DVec3::ONE.lerp(share, cover.film)),
            rho_b: rho(DVec3::ONE),
        };
        let at_o = interface.at(1.0, surface.alpha);
        let path_o = self.specimen.path(1.0);
        let crossed = through_study(film, through, &seen, &at_o, &mean, path_o, surface.eta);
        crossed * passing(cover, *body_through, toned)
    }
}
