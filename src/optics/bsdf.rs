//! A tier's BSDF at pairs of directions, for tables: `recto bsdf`.

use std::{f64::consts::PI, sync::Arc};

use glam::{DVec3, DVec4};

use super::{
    baselines::{
        brdf_blinn_phong, brdf_blinn_phong_plain, brdf_cook_torrance, brdf_cook_torrance_blinn,
        brdf_cook_torrance_gauss, brdf_isle, brdf_oren_nayar, brdf_phong, brdf_phong_plain,
        off_mirror,
    },
    ink::{capture_path, internal_reflectance, optical_depth},
    matter::{
        Cover, Media, Particle, Shares, SideMedia, brdf_body, particle_capture, particle_gloss,
        particle_lobe, passing, shares_of, uncovered_share,
    },
    medium::{Matter, Medium},
    microfacet::MU_MIN,
    refraction::{PathTable, crossed},
    show_through::{shown_through, under_tone},
    slab::{Phase, Slab, UM_PER_MM},
    study::{Study, Ways, brdf_study},
    table::{Interface, InterfaceMean, InterfaceTable},
    through::{Seen, btdf_study, toned_paper},
    tier::{Facing, Surface, Tier, brdf_draft, brdf_gallery, brdf_lambert, facing},
};
use crate::units::Micrometres;

/// The columns that are read, in this order.
pub const COLUMNS: [&str; 4] = ["theta_i", "phi_i", "theta_o", "phi_o"];
/// What a drawn medium lies on, linear sRGB: paper of the catalogue's usual scattering.
const DRAWN_ON: DVec3 = DVec3::splat(0.8);
/// The least and the most that they may hold, in degrees.
const RANGES: [[f64; 2]; 4] = [[0.0, 90.0], [-360.0, 360.0], [0.0, 180.0], [-360.0, 360.0]];

/// Directions towards light and eye in degrees, in the order of [`COLUMNS`]: θ from the normal,
/// φ anticlockwise from the right. θo above 90° is light that has gone through the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair(pub [f64; 4]);

impl Pair {
    /// Unit vectors towards the light and the eye, in the local frame.
    pub fn directions(&self) -> [DVec3; 2] {
        let [theta_i, phi_i, theta_o, phi_o] = self.0.map(f64::to_radians);
        let direction = |theta: f64, phi: f64| {
            let across = theta.sin();
            DVec3::new(across * phi.cos(), across * phi.sin(), theta.cos())
        };
        [direction(theta_i, phi_i), direction(theta_o, phi_o)]
    }

    /// Whether the eye is on the side that the light does not reach.
    pub fn is_transmitted(&self) -> bool {
        self.0[2] > 90.0
    }
}

/// What a tier says of one pair, per channel of linear sRGB.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// In sr⁻¹, without the cosine.
    pub f: DVec3,
    /// Share of the light that a smooth surface mirrors into one direction. No tier so far has
    /// such a part: the smoothest surface has facets.
    pub mirror: DVec3,
    /// Share of the light that goes straight through the sheet, unscattered: to an eye exactly
    /// opposite.
    pub ballistic: DVec3,
}

/// A bare medium with what a tier asks of its interface.
#[derive(Clone, Debug)]
pub struct Specimen {
    pub surface: Surface,
    pub interface: InterfaceTable,
    /// The paper, or what a drawn medium lies on.
    pub study: Study,
    /// What a drawn medium is: ink, body colour or particles, at full coverage.
    pub cover: Cover,
    pub particle: Particle,
    pub body_albedo: DVec3,
    pub body_through: DVec3,
    /// Share of the paper's light that the ink of the other side leaves: see
    /// [`super::show_through`].
    pub left: DVec3,
}

/// Thickness of the sheet under a drawn medium.
const THICKNESS: Micrometres = Micrometres(150.0);
/// How near to opposite each other two directions are one, as the sum of their unit vectors.
const OPPOSITE: f64 = 1e-6;

impl Specimen {
    /// `medium` where it photographs with this `albedo` (linear sRGB, each in [0, 1]), a drawn
    /// one at full coverage on paper that photographs .8.
    pub fn new(medium: &Medium, albedo: DVec3) -> Self {
        let surface = Surface::new(albedo, medium.roughness(), medium.index(), 1.0);
        let interface = InterfaceTable::at_roughness(surface.alpha, medium.index(), 1.0);
        let mean = interface.mean_at(surface.alpha);
        let sheet = Slab::rag_paper(THICKNESS);
        let (bare, slab) = match medium.matter {
            Matter::Paper(paper) => (
                albedo,
                Slab {
                    scattering: paper.scattering_per_mm,
                    thickness: paper.thickness_um / UM_PER_MM,
                    phase: Phase {
                        forward_share: paper.forward_share,
                        g_forward: paper.g_forward,
                        g_backward: paper.g_backward,
                    },
                    ..sheet
                },
            ),
            // A groove is the paper's own.
            Matter::Relief => (albedo, sheet),
            _ => (DRAWN_ON, sheet),
        };
        let bare = Surface {
            albedo: bare,
            ..surface
        };
        let paths = Arc::new(PathTable::at_roughness(surface.alpha, medium.index()));
        let study = Study::new(&bare, &interface, paths, slab);
        let mut cover = Cover::default();
        let mut side = SideMedia::default();
        let mut particle = Particle {
            alpha: 1.0,
            ..Particle::default()
        };
        match medium.matter {
            Matter::Film(_) => cover.film = 1.0,
            Matter::Body(body) => {
                cover.body = 1.0;
                side.bodies.push(body);
            }
            Matter::Particles(particles) => {
                particle = Particle::new(&particles);
                cover.particles = 1.0;
                cover.grains = particle.albedo;
            }
            Matter::Paper(_) | Matter::Relief => {}
        }
        let media = Media::new(&side, &bare, &mean, &study);
        Self {
            surface,
            interface,
            study,
            cover,
            particle,
            body_albedo: media.body_albedo,
            body_through: media.body_through,
            left: DVec3::ONE,
        }
    }

    /// What the other side's ink leaves of the paper's light, where the other side shows the share
    /// `share_b` of its bare paper's light, and showed `share_photographed` when this one was
    /// photographed.
    pub fn left(&self, share_b: DVec3, share_photographed: DVec3) -> DVec3 {
        let Study { film, through, .. } = &self.study;
        let share_f = uncovered_share(&self.shares(), self.study.bare);
        let rho = |share: DVec3| internal_reflectance(film, share);
        let shown = shown_through(
            through,
            1.0,
            rho(DVec3::ONE.lerp(share_f, self.cover.film)),
            rho(share_b),
            rho(share_photographed),
            rho(DVec3::ONE),
        );
        under_tone(shown, toned_paper(through, share_f), share_f).lerp(shown, self.cover.film)
    }

    /// What light through the sheet meets: a drawn medium on the side of the light.
    pub fn seen(&self) -> Seen {
        let share = uncovered_share(&self.shares(), self.study.bare);
        Seen {
            depth_f: DVec3::ZERO,
            depth_b: self.depth(),
            rho_f: internal_reflectance(&self.study.film, DVec3::ONE),
            rho_b: internal_reflectance(&self.study.film, share),
            clear: 1.0,
        }
    }

    /// `paper`, the diffuse albedo of the spot, with what the other side's ink leaves of it: no more
    /// than a sheet that gives back all light can photograph.
    pub fn remaining(&self, paper: DVec3, mean: &InterfaceMean) -> DVec3 {
        (paper * self.left).min(DVec3::splat(1.0 / (mean.t_mean * mean.capture)))
    }

    /// The path through its film in the geometry of capture.
    pub fn capture(&self) -> DVec4 {
        capture_path(&self.study.film.paths, self.surface.alpha)
    }

    /// The path through its film of light at the cosine `mu`.
    pub fn path(&self, mu: f64) -> DVec4 {
        self.study.film.paths.at(mu, self.surface.alpha)
    }

    /// The photograph of the spot, divided.
    pub fn shares(&self) -> Shares {
        let mean = self.interface.mean_at(self.surface.alpha);
        let (bare, body) = (self.study.bare, self.body_albedo);
        shares_of(&self.surface, &mean, bare, body, &self.cover)
    }

    /// τ of the ink.
    pub fn depth(&self) -> DVec3 {
        let film = &self.study.film;
        let share = uncovered_share(&self.shares(), self.study.bare);
        optical_depth(film, self.capture(), share) * self.cover.film
    }

    /// The BSDF of `tier` at `pair`. Light goes through the sheet in the study tier alone.
    pub fn at(&self, tier: Tier, pair: &Pair) -> Sample {
        let [l, v] = pair.directions();
        if !pair.is_transmitted() {
            return Sample {
                f: self.reflected(tier, l, v, 1.0),
                ..Sample::default()
            };
        }
        if tier != Tier::Study {
            return Sample::default();
        }
        Sample {
            f: self.transmitted(l, v),
            ballistic: self.ballistic(pair),
            ..Sample::default()
        }
    }

    fn transmitted(&self, l: DVec3, v: DVec3) -> DVec3 {
        let s = &self.surface;
        // Both cosines are taken from the side that they are on.
        let (mu_i, mu_o) = (l.z.max(MU_MIN), (-v.z).max(MU_MIN));
        let at = |mu: f64| self.interface.at(mu, s.alpha);
        let f = btdf_study(
            &self.study.through,
            &self.seen(),
            &at(mu_i),
            &at(mu_o),
            &self.interface.mean_at(s.alpha),
            self.path(mu_i),
            self.path(mu_o),
            s.eta,
        );
        f * passing(&self.cover, self.body_through, DVec3::ONE)
    }

    /// What goes straight through, to an eye opposite the light.
    pub fn ballistic(&self, pair: &Pair) -> DVec3 {
        let [l, v] = pair.directions();
        if !pair.is_transmitted() || (l + v).length() > OPPOSITE {
            return DVec3::ZERO;
        }
        let mu = l.z.max(MU_MIN);
        let t = self.interface.at(mu, self.surface.alpha).t;
        let depth = self.seen().depth_b + self.study.through.ballistic;
        let passed = passing(&self.cover, self.body_through, DVec3::ONE);
        passed * (t * t) * crossed(self.path(mu), depth)
    }

    fn studied(&self, g: &Facing, shortening: f64) -> DVec3 {
        let s = &self.surface;
        let mean = self.interface.mean_at(s.alpha);
        let (at_i, at_o) = self.boundaries(g, shortening);
        let shares = self.shares();
        let particle = &self.particle;
        let albedo = particle.albedo * shares.scale;
        let mirrored = particle_capture(particle, particle.alpha);
        let mirrors = particle_gloss(albedo, mirrored, shares.lit);
        let (split, depth) = (&self.study.split, self.depth());
        let (paper, surface) = (self.remaining(shares.paper, &mean), shares.surface);
        let grains = (albedo - mirrored * mirrors).max(DVec3::ZERO) / PI
            + particle_lobe(particle, particle.alpha, g) * mirrors;
        let ways = Ways {
            capture: self.capture(),
            path_i: self.path(g.mu_i),
            path_o: self.path(g.mu_o),
        };
        brdf_study(
            s, g, &at_i, &at_o, &mean, split, depth, &ways, paper, surface,
        ) + brdf_body(shares.body, &at_i, &at_o, &mean)
            + grains * self.cover.particles
    }

    fn boundaries(&self, g: &Facing, shortening: f64) -> (Interface, Interface) {
        let at = |mu: f64| self.interface.at(mu, self.surface.alpha);
        let lit = at(g.mu_i);
        let lit = Interface {
            t: lit.t * shortening,
            ..lit
        };
        (lit, at(g.mu_o))
    }

    /// The BRDF of `tier` without the cosine, in the frame of the normal: unit vectors towards the
    /// light and the eye. A mean of normals of this length (`shortening`, 1 on even paper) takes
    /// that share from the diffuse part, as [`super::relief`] says.
    pub fn reflected(&self, tier: Tier, l: DVec3, v: DVec3, shortening: f64) -> DVec3 {
        let s = &match tier {
            // Before the albedo's bounds, as they belong to the paper and not to its relief.
            Tier::Gallery | Tier::Study => self.surface,
            _ => Surface {
                albedo: self.surface.albedo * shortening,
                ..self.surface
            },
        };
        let g = facing(DVec3::Z, l, v);
        let off = off_mirror(DVec3::Z, l, v);
        match tier {
            Tier::Draft => brdf_draft(s, &g),
            Tier::Gallery => {
                let (at_i, at_o) = self.boundaries(&g, shortening);
                let mean = self.interface.mean_at(s.alpha);
                brdf_gallery(s, &g, &at_i, &at_o, &mean)
            }
            Tier::Study => self.studied(&g, shortening),
            Tier::Isle => brdf_isle(s, &g),
            Tier::Lambert => brdf_lambert(s),
            Tier::Phong => brdf_phong(s, off),
            Tier::BlinnPhong => brdf_blinn_phong(s, &g),
            Tier::CookTorrance => brdf_cook_torrance(s, &g),
            Tier::OrenNayar => brdf_oren_nayar(s, &g),
            Tier::PhongPlain => brdf_phong_plain(s, &g, off),
            Tier::BlinnPhongPlain => brdf_blinn_phong_plain(s, &g),
            Tier::CookTorranceGauss => brdf_cook_torrance_gauss(s, &g),
            Tier::CookTorranceBlinn => brdf_cook_torrance_blinn(s, &g),
        }
    }
}

/// What is wrong at a place of a table of pairs; lines and columns count from 1, columns by the
/// commas.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("line {line}, column {column}: found {found:?}; {remedy}")]
pub struct PairFault {
    pub line: usize,
    pub column: usize,
    pub found: String,
    pub remedy: String,
}

/// Reads a table of pairs: CSV with a header of [`COLUMNS`]; `#` begins a comment, and empty lines
/// are passed over.
///
/// # Errors
/// All faults.
pub fn read_pairs(text: &str) -> Result<Vec<Pair>, Vec<PairFault>> {
    let mut faults = Vec::new();
    let mut rows = text
        .trim_start_matches('\u{feff}')
        .lines()
        .enumerate()
        .map(|(i, line)| (i + 1, line.split('#').next().unwrap_or_default().trim()))
        .filter(|(_, line)| !line.is_empty());
    let fault = |line, column, found: &str, remedy: String| PairFault {
        line,
        column,
        found: found.into(),
        remedy,
    };
    let header = COLUMNS.join(",");
    match rows.next() {
        Some((_, line)) if line.split(',').map(str::trim).eq(COLUMNS) => {}
        Some((line, found)) => {
            let remedy = format!("write the header {header} first");
            return Err(vec![fault(line, 1, found, remedy)]);
        }
        None => {
            let remedy = format!("write the header {header} and pairs of directions below");
            return Err(vec![fault(1, 1, "", remedy)]);
        }
    }
    let mut pairs = Vec::new();
    for (line, row) in rows {
        let cells: Vec<&str> = row.split(',').map(str::trim).collect();
        if cells.len() != COLUMNS.len() {
            let remedy = format!("write four numbers, {header}");
            faults.push(fault(line, cells.len().min(COLUMNS.len() + 1), row, remedy));
            continue;
        }
        let mut pair = [0.0; 4];
        for (i, (cell, [low, high])) in cells.iter().zip(RANGES).enumerate() {
            match cell.parse::<f64>() {
                Ok(degrees) if (low..=high).contains(&degrees) => pair[i] = degrees,
                _ => {
                    let name = COLUMNS[i];
                    let remedy = format!("{name} is a number from {low} to {high}, in degrees");
                    faults.push(fault(line, i + 1, cell, remedy));
                }
            }
        }
        pairs.push(Pair(pair));
    }
    if faults.is_empty() {
        Ok(pairs)
    } else {
        Err(faults)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::medium::MediumId;

    #[test]
    fn all_faults_of_a_table_are_found_at_once() {
        let text = "# pairs\ntheta_i,phi_i,theta_o,phi_o\n1,2,3,4 # sound\n\n\
                    91,0,0,0\n0,x,0,NaN\n1,2,3\n-0,-360,180,360\n";
        let faults = read_pairs(text).expect_err("faults");
        let places: Vec<_> = faults.iter().map(|f| (f.line, f.column)).collect();
        assert_eq!(places, [(5, 1), (6, 2), (6, 4), (7, 3)]);
        assert_eq!(read_pairs("").expect_err("no header").len(), 1);
        assert_eq!(read_pairs("0,0,0,0").expect_err("no header")[0].line, 1);
        let sound = "\u{feff}theta_i, phi_i, theta_o, phi_o\r\n45, 0, 0, 0\r\n";
        assert_eq!(read_pairs(sound), Ok(vec![Pair([45.0, 0.0, 0.0, 0.0])]));
    }

    #[test]
    fn every_tier_is_evaluated_and_only_study_lets_light_through() {
        let albedo = DVec3::new(0.8, 0.5, 0.2);
        for id in MediumId::all() {
            let specimen = Specimen::new(id.medium(), albedo);
            for tier in Tier::ALL {
                let at = |theta_i, theta_o| specimen.at(tier, &Pair([theta_i, 0.0, theta_o, 0.0]));
                for (theta_i, theta_o) in [(0.0, 0.0), (45.0, 0.0), (90.0, 90.0), (90.0, 0.0)] {
                    let sample = at(theta_i, theta_o);
                    let sound = sample.f.is_finite() && sample.f.min_element() >= 0.0;
                    assert!(sound, "{tier}");
                    let through = at(theta_i, 180.0 - theta_i.min(89.0));
                    let passes =
                        tier == Tier::Study && !matches!(id.medium().matter, Matter::Particles(_));
                    assert_eq!(through.f.max_element() > 0.0, passes, "{id} {tier}");
                }
            }
        }
    }

    #[test]
    fn unscattered_light_meets_only_the_eye_opposite() {
        let laid = "laid".parse::<MediumId>().expect("laid paper");
        let specimen = Specimen::new(laid.medium(), DVec3::splat(0.8));
        let at = |pair| specimen.at(Tier::Study, &Pair(pair)).ballistic.x;
        assert!(at([0.0, 0.0, 180.0, 0.0]) > 0.0);
        assert!(at([30.0, 20.0, 150.0, 200.0]) > 0.0);
        assert_eq!(at([30.0, 20.0, 150.0, 210.0]), 0.0);
        assert_eq!(at([0.0, 0.0, 0.0, 0.0]), 0.0);
    }

    #[test]
    fn ink_and_sheet_both_dim_what_goes_straight_through() {
        const STRAIGHT: Pair = Pair([0.0, 0.0, 180.0, 0.0]);
        let of = |id: &str, albedo: f64| {
            let id = id.parse::<MediumId>().expect("a medium");
            let specimen = Specimen::new(id.medium(), DVec3::splat(albedo));
            let passed = specimen.at(Tier::Study, &STRAIGHT).ballistic.x;
            // What an unscattering sheet without ink would let through.
            let t = specimen.interface.at(1.0, specimen.surface.alpha).t;
            let sheet = specimen.study.through.ballistic.x;
            (passed, t * t, sheet, specimen.depth().x)
        };
        for (id, albedo) in [
            ("laid", 0.8),
            ("iron-gall-ink", 0.5),
            ("iron-gall-ink", 0.05),
        ] {
            let (passed, clear, sheet, ink) = of(id, albedo);
            // A way through is never shorter than what it leads through is deep.
            let most = clear * (-(sheet + ink)).exp();
            assert!(
                passed > 0.0 && passed <= most * (1.0 + 1e-12),
                "{id} {albedo}: {passed} {most}"
            );
            assert!(passed > 0.2 * most, "{id} {albedo}: {passed} {most}");
        }
        assert!(of("iron-gall-ink", 0.05).3 > 5.0 * of("iron-gall-ink", 0.5).3);
    }

    #[test]
    fn a_sheet_of_no_depth_passes_what_both_its_surfaces_do() {
        let laid = "laid".parse::<MediumId>().expect("laid paper");
        let mut specimen = Specimen::new(laid.medium(), DVec3::splat(0.8));
        specimen.study.through.ballistic = DVec3::ZERO;
        for theta in [0.0, 40.0, 80.0] {
            let straight = Pair([theta, 0.0, 180.0 - theta, 180.0]);
            let passed = specimen.at(Tier::Study, &straight).ballistic.x;
            let mu = theta.to_radians().cos();
            let t = specimen.interface.at(mu, specimen.surface.alpha).t;
            assert!((passed / (t * t) - 1.0).abs() < 1e-9, "{theta}: {passed}");
        }
    }
}
