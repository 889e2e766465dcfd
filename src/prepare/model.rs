//! The paper that prepared maps are shown by, in `f64`: what the study tier makes of a place, for
//! fits that undo it.

use std::{f64::consts::PI, sync::Arc};

use glam::{DVec3, DVec4};

use crate::optics::{
    bsdf::Specimen,
    ink,
    matter::{
        Cover, Media, Particle, SideMedia, borne_out, brdf_body, particle_capture, particle_gloss,
        particle_lobe, passing, shares_of, uncovered_share, veiled, with_borne,
    },
    medium::{Matter, Medium, MediumId, PaperConstants},
    refraction::{PathRow, PathTable, path_at},
    slab::{Phase, Slab, UM_PER_MM},
    study::{Study, Ways, brdf_study},
    table::{InterfaceMean, InterfaceRow, InterfaceTable, interface_at},
    through::{Seen, through_study, toned_paper},
    tier::{Surface, capture_floor, facing},
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

    /// Films of ink in it.
    pub fn film(&self) -> &ink::Film {
        &self.study.film
    }

    /// Linear albedo of its bare places, without what their surface adds.
    pub fn bare(&self) -> DVec3 {
        self.surface.albedo - capture_floor(&self.surface, &self.mean)
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
        // Of black ink nearly all light is its surface's: a hundredth of the index is seen. What it
        // does to the paper's light below is less than that.
        let index = match medium.map(|medium| medium.matter) {
            Some(Matter::Film(film)) => film.index,
            Some(Matter::Body(body)) => body.index,
            _ => self.paper.index,
        };
        let interface = match index == self.paper.index {
            true => self.interface.clone(),
            false => InterfaceTable::new(index, 1.0),
        };
        let surface = Surface::new(self.surface.albedo, alpha, index, 1.0);
        let mut spot = Spot {
            model: self,
            surface: OfSurface::new(&interface, &self.study.film.paths, surface.alpha),
            specimen: Specimen {
                surface,
                interface,
                study: self.study.clone(),
                cover,
                particle,
                body_albedo: media.body_albedo,
                body_through: media.body_through,
                left: DVec3::ONE,
            },
            whole: cover,
            photograph: OfPhotograph::default(),
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
    surface: OfSurface,
    photograph: OfPhotograph,
}

/// What follows from its roughness.
#[derive(Clone, Debug)]
struct OfSurface {
    row: InterfaceRow,
    mean: InterfaceMean,
    path: PathRow,
    capture: DVec4,
}

/// What follows from its albedo.
#[derive(Clone, Copy, Debug, Default)]
struct OfPhotograph {
    paper: DVec3,
    body: DVec3,
    depth: DVec3,
    /// Share that has a dielectric surface.
    surface: f64,
    /// π times what grains scatter, and the share of them that mirrors.
    grains: DVec3,
    mirrors: f64,
}

impl OfSurface {
    fn new(interface: &InterfaceTable, paths: &PathTable, alpha: f64) -> Self {
        Self {
            row: interface.row(alpha),
            mean: interface.mean_at(alpha),
            path: paths.row(alpha),
            capture: ink::capture_path(paths, alpha),
        }
    }
}

impl Spot<'_> {
    /// Sets the roughness of what lies on top: of grains, of a film or body colour, or of paper.
    /// Its albedo is to be set anew.
    pub fn set_roughness(&mut self, alpha: f64) {
        if self.whole.particles > 0.0 {
            self.specimen.particle.alpha = alpha;
            return;
        }
        let Surface { albedo, eta, .. } = self.specimen.surface;
        self.specimen.surface = Surface::new(albedo, alpha, eta, 1.0);
        let paths = &self.model.study.film.paths;
        let Specimen {
            surface, interface, ..
        } = &self.specimen;
        self.surface = OfSurface::new(interface, paths, surface.alpha);
    }

    /// Sets what it photographs as at 45°/0°.
    pub fn set_albedo(&mut self, albedo: DVec3) {
        let Study { bare, film, .. } = &self.model.study;
        let OfSurface { mean, capture, .. } = &self.surface;
        let Specimen {
            surface,
            cover,
            particle,
            body_albedo,
            ..
        } = &mut self.specimen;
        surface.albedo = albedo;
        if self.whole.particles > 0.0 {
            let borne = borne_out(surface, mean, *bare, *body_albedo, &self.whole);
            *cover = with_borne(&self.whole, borne);
        }
        let shares = shares_of(surface, mean, *bare, *body_albedo, cover);
        let mut photograph = OfPhotograph {
            paper: shares
                .paper
                .min(DVec3::splat(1.0 / (mean.t_mean * mean.capture))),
            body: shares.body,
            surface: shares.surface,
            ..OfPhotograph::default()
        };
        if cover.film > 0.0 {
            let share = uncovered_share(&shares, *bare);
            photograph.depth = ink::optical_depth(film, *capture, share) * cover.film;
        }
        if cover.particles > 0.0 {
            let albedo = particle.albedo * shares.scale;
            let mirrored = particle_capture(particle, particle.alpha);
            photograph.mirrors = particle_gloss(albedo, mirrored, shares.lit);
            photograph.grains = (albedo - mirrored * photograph.mirrors).max(DVec3::ZERO);
        }
        self.photograph = photograph;
    }

    /// π times the radiance towards the camera, straight above the sheet, over the light that
    /// falls on a place that faces it: from `l`, where the surface faces along `normal`. It is
    /// [`Specimen::reflected`]'s of the study tier, of which all is kept that does not change from
    /// lamp to lamp.
    pub fn shown(&self, normal: DVec3, l: DVec3) -> DVec3 {
        let mu = normal.dot(l);
        if mu <= 0.0 {
            return DVec3::ZERO;
        }
        let Specimen {
            surface,
            study,
            cover,
            particle,
            ..
        } = &self.specimen;
        let OfSurface {
            row,
            mean,
            path,
            capture,
        } = &self.surface;
        let of = &self.photograph;
        let g = facing(normal, l, DVec3::Z);
        let [at_i, at_o] = [g.mu_i, g.mu_o].map(|mu| interface_at(row, mu));
        let [path_i, path_o] = [g.mu_i, g.mu_o].map(|mu| path_at(path, mu, self.model.paper.index));
        let ways = Ways {
            capture: *capture,
            path_i,
            path_o,
        };
        let (split, depth) = (&study.split, of.depth);
        let mut f = brdf_study(
            surface, &g, &at_i, &at_o, mean, split, depth, &ways, of.paper, of.surface,
        );
        if cover.body > 0.0 {
            f += brdf_body(of.body, &at_i, &at_o, mean);
        }
        if cover.particles > 0.0 {
            let lobe = particle_lobe(particle, particle.alpha, &g) * of.mirrors;
            f += (of.grains / PI + lobe) * cover.particles;
        }
        f * (PI * mu)
    }

    /// What its surface itself adds to its albedo; nothing of grains, whose albedo holds it.
    pub fn floor(&self) -> f64 {
        match self.whole.particles > 0.0 {
            true => 0.0,
            false => capture_floor(&self.specimen.surface, &self.surface.mean),
        }
    }

    fn share(&self) -> DVec3 {
        uncovered_share(&self.specimen.shares(), self.model.study.bare)
    }

    /// τ of its ink per channel; 0 where it is none.
    pub fn depth(&self) -> DVec3 {
        self.photograph.depth
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

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;
    use crate::optics::tier::Tier;

    #[test]
    fn it_is_the_study_tier() {
        let model = Model::laid(DVec3::new(0.72, 0.67, 0.57)).expect("laid paper");
        let names = [
            "iron-gall-ink",
            "wash",
            "red-chalk",
            "lead-point",
            "white-gouache",
        ];
        let media = names.map(|name| name.parse::<MediumId>().ok());
        for medium in media.into_iter().chain([None]) {
            let mut spot = model.spot(medium.map(MediumId::medium));
            for alpha in [0.2, 0.45, 0.8] {
                spot.set_roughness(alpha);
                for albedo in [[0.3, 0.2, 0.1], [0.05, 0.04, 0.03], [0.7, 0.65, 0.6]] {
                    spot.set_albedo(albedo.into());
                    for n in [[0.0, 0.0, 1.0], [0.1, -0.1, 1.0]] {
                        let n = DVec3::from(n).normalize();
                        for l in [[0.5, 0.2, 0.9], [-0.9, 0.3, 0.2]] {
                            let l = DVec3::from(l).normalize();
                            let upright = DQuat::from_rotation_arc(n, DVec3::Z);
                            let tier = Tier::Study;
                            let f =
                                spot.specimen
                                    .reflected(tier, upright * l, upright * DVec3::Z, 1.0);
                            // One of the lamps is below the horizon of a place that is turned away.
                            let whole = f * PI * n.dot(l).max(0.0);
                            let off = (spot.shown(n, l) - whole).abs().max_element();
                            assert!(off < 1e-9, "{medium:?} {alpha} {albedo:?}: {off}");
                        }
                    }
                }
            }
        }
    }
}
