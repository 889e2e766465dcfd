//! Energy and reciprocity of the tiers in f64, over directions, roughness, index and ink.

use std::{
    f64::consts::{FRAC_PI_2, PI, TAU},
    sync::Arc,
};

use glam::DVec3;
use recto::optics::{
    ink::{capture_path, internal_reflectance, optical_depth},
    matter::{
        Cover, Particle, particle_capture, particle_gloss, particle_lobe, shares_of,
        uncovered_share,
    },
    medium::{Matter, MediumId},
    refraction::PathTable,
    slab::Slab,
    study::{Study, Ways, brdf_study},
    table::{InterfaceMean, InterfaceTable},
    through::{Seen, btdf_study, through_study},
    tier::{Surface, albedo_of, capture_floor, facing},
};

use crate::{OPAQUE, THIN};

/// OPTICS, "energy": R + T ≤ 1 + 1e-3.
const ENERGY: f64 = 1e-3;
/// OPTICS, "reciprocity", in f64.
const RECIPROCITY: f64 = 1e-6;
const ALPHAS: [f64; 6] = [0.1, 0.2, 0.4, 0.6, 0.8, 1.0];
const INDICES: [f64; 3] = [1.3, 1.5, 1.66];
/// Directions of the furnace.
const DIRECTIONS: u32 = 64;

/// A side of any paper at the study tier.
struct Side {
    surface: Surface,
    table: InterfaceTable,
    mean: InterfaceMean,
    study: Study,
}

impl Side {
    /// Paper of the slab `slab` that absorbs nothing, by what it photographs as.
    fn lossless(slab: Slab, alpha: f64, n: f64) -> Self {
        let table = InterfaceTable::at_roughness(alpha, n, 1.0);
        let mean = table.mean_at(alpha);
        let r_i = 1.0 - mean.t_mean / (n * n);
        let unlit = Surface::new(DVec3::ZERO, alpha, n, 1.0);
        let paths = Arc::new(PathTable::at_roughness(alpha, n));
        let of = |albedo: f64| {
            let surface = Surface {
                albedo: DVec3::splat(albedo),
                ..unlit
            };
            (surface, Study::new(&surface, &table, paths.clone(), slab))
        };
        // What it photographs as, study tells from its mean.
        let (mut surface, mut study) = of(0.8);
        for _ in 0..3 {
            let r_b = slab.body(r_i, study.split.inner_mean).backed(r_i);
            let lit = r_b / (1.0 - r_i * r_b) / (n * n * mean.capture);
            (surface, study) = of(lit / study.split.at_capture.x + capture_floor(&unlit, &mean));
        }
        Self {
            surface,
            table,
            mean,
            study,
        }
    }

    /// A spot that photographs as the share `x` of the paper's diffuse light.
    fn inked(&self, x: DVec3) -> Surface {
        let floor = capture_floor(&self.surface, &self.mean);
        Surface {
            albedo: self.study.bare * x + floor,
            ..self.surface
        }
    }

    fn depth(&self, s: &Surface) -> DVec3 {
        let film = &self.study.film;
        let share = albedo_of(s, &self.mean) / self.study.bare;
        optical_depth(film, self.ways(1.0, 1.0).capture, share)
    }

    fn ways(&self, mu_i: f64, mu_o: f64) -> Ways {
        let (paths, alpha) = (&self.study.film.paths, self.surface.alpha);
        Ways {
            capture: capture_path(paths, alpha),
            path_i: paths.at(mu_i, alpha),
            path_o: paths.at(mu_o, alpha),
        }
    }

    /// A spot of which `particle` covers the share `covered`.
    fn brdf(&self, s: &Surface, particle: &Particle, covered: f64, l: DVec3, v: DVec3) -> DVec3 {
        let g = facing(DVec3::Z, l, v);
        let [at_i, at_o] = [g.mu_i, g.mu_o].map(|mu| self.table.at(mu, s.alpha));
        let cover = Cover {
            film: 1.0,
            particles: covered,
            grains: particle.albedo * covered,
            ..Cover::default()
        };
        let (mean, split, bare) = (&self.mean, &self.study.split, self.study.bare);
        let shares = shares_of(s, mean, bare, DVec3::ONE, &cover);
        let ways = self.ways(g.mu_i, g.mu_o);
        let share = uncovered_share(&shares, bare);
        let depth = optical_depth(&self.study.film, ways.capture, share);
        let (paper, surface) = (shares.paper, shares.surface);
        let albedo = particle.albedo * shares.scale;
        let mirrored = particle_capture(particle, particle.alpha);
        let mirrors = particle_gloss(albedo, mirrored, shares.lit);
        let grains = (albedo - mirrored * mirrors).max(DVec3::ZERO) / PI
            + particle_lobe(particle, particle.alpha, &g) * mirrors;
        brdf_study(
            s, &g, &at_i, &at_o, mean, split, depth, &ways, paper, surface,
        ) + grains * covered
    }

    /// ∫ f μ dω of what is not the surface's own reflection.
    fn diffuse_albedo(&self, s: &Surface, l: DVec3) -> f64 {
        const STEPS: u32 = 12;
        let matt = Surface {
            specular: 0.0,
            f_normal: 0.0,
            ..*s
        };
        let unlit = InterfaceMean {
            compensation: 0.0,
            ..self.mean
        };
        let paper = albedo_of(s, &self.mean);
        let depth = self.depth(s);
        let mut sum = 0.0;
        for i in 0..STEPS {
            // Even in μ², as cosines weigh.
            let mu = ((f64::from(i) + 0.5) / f64::from(STEPS)).sqrt();
            for j in 0..STEPS {
                let phi = PI * (f64::from(j) + 0.5) / f64::from(STEPS);
                let sin = (1.0 - mu * mu).sqrt();
                let g = facing(
                    DVec3::Z,
                    l,
                    DVec3::new(sin * phi.cos(), sin * phi.sin(), mu),
                );
                let [at_i, at_o] = [g.mu_i, g.mu_o].map(|mu| self.table.at(mu, s.alpha));
                let split = &self.study.split;
                let ways = self.ways(g.mu_i, g.mu_o);
                sum += brdf_study(
                    &matt, &g, &at_i, &at_o, &unlit, split, depth, &ways, paper, 1.0,
                )
                .x;
            }
        }
        PI * sum / f64::from(STEPS * STEPS)
    }

    fn seen(&self, front: DVec3, back: DVec3) -> Seen {
        let film = &self.study.film;
        let capture = self.ways(1.0, 1.0).capture;
        Seen {
            depth_f: optical_depth(film, capture, front),
            depth_b: optical_depth(film, capture, back),
            rho_f: internal_reflectance(film, front),
            rho_b: internal_reflectance(film, back),
            clear: 1.0,
        }
    }

    /// Light that crosses the sheet from a direction, by reciprocity with an even light table.
    fn transmitted(&self, front: DVec3, back: DVec3, mu: f64) -> f64 {
        let at_o = self.table.at(mu, self.surface.alpha);
        let (film, through) = (&self.study.film, &self.study.through);
        let seen = self.seen(front, back);
        let path_o = self.ways(1.0, mu).path_o;
        let eta = self.surface.eta;
        through_study(film, through, &seen, &at_o, &self.mean, path_o, eta).x
    }
}

#[test]
fn an_inked_sheet_gives_no_more_light_than_it_gets() {
    // The share of the paper's light that is photographed, from a faint wash on.
    const SHARES: [f64; 4] = [0.9, 0.3, 0.01, 1e-3];
    let (mut most, mut wrong) = (0.0f64, 0.0f64);
    let (mut depths, mut count) = ([f64::MAX, 0.0], 0);
    for sheet in [OPAQUE, THIN] {
        for n in INDICES {
            for alpha in ALPHAS {
                let side = Side::lossless(sheet.slab(), alpha, n);
                for x in SHARES {
                    let (x, s) = (DVec3::splat(x), side.inked(DVec3::splat(x)));
                    let depth = side.depth(&s).x;
                    depths = [depths[0].min(depth), depths[1].max(depth)];
                    for i in 0..DIRECTIONS {
                        let mu = (FRAC_PI_2 * (f64::from(i) + 0.5) / f64::from(DIRECTIONS)).cos();
                        let l = DVec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
                        let mirrored = 1.0 - side.table.at(mu, alpha).t;
                        let reflected = mirrored + side.diffuse_albedo(&s, l);
                        // Ink on the side of the light alone lets most through.
                        let through = side.transmitted(x, DVec3::ONE, mu);
                        let sum = reflected + through;
                        wrong = wrong.max(sum + through);
                        assert!(
                            sum <= 1.0 + ENERGY,
                            "{}, n {n}, α {alpha}, τ {depth}, μ {mu}: {sum}",
                            sheet.name
                        );
                        most = most.max(sum);
                        count += 1;
                    }
                }
            }
        }
    }
    // Light counted twice would be found.
    assert!(wrong > 1.0 + ENERGY, "{wrong}");
    println!("furnace of {count} inked sheets, τ from {depths:.3?}: at most {most:.4}");
}

fn direction(mu: f64, phi: f64) -> DVec3 {
    let (sin, cos) = phi.sin_cos();
    DVec3::new(cos, sin, 0.0) * (1.0 - mu * mu).max(0.0).sqrt() + DVec3::Z * mu
}

/// Largest relative difference of two colours.
fn apart(a: DVec3, b: DVec3) -> f64 {
    ((a - b) / a.max(b).max(DVec3::splat(1e-300)))
        .abs()
        .max_element()
}

#[test]
fn light_may_go_either_way_through_ink_particles_and_the_sheet() {
    let silver: MediumId = "silver-point".parse().expect("in the catalogue");
    let Matter::Particles(silver) = silver.medium().matter else {
        panic!("silver is particles");
    };
    let silver = Particle::new(&silver);
    let cosines = [1e-4, 0.02, 0.3, 0.7, 1.0];
    let (mut worst, mut through, mut one_way) = (0.0f64, 0.0f64, 0.0f64);
    for sheet in [OPAQUE, THIN] {
        for n in INDICES {
            for alpha in [1e-4, 0.05, 0.4, 1.0] {
                let side = Side::lossless(sheet.slab(), alpha, n);
                let (front, back) = (DVec3::new(0.9, 0.3, 1e-3), DVec3::new(0.5, 1.0, 0.05));
                let s = side.inked(front);
                for (mu_i, mu_o) in cosines.into_iter().flat_map(|i| cosines.map(|o| (i, o))) {
                    for phi in [0.0, 0.5, 2.0, PI, TAU - 1.0] {
                        let (l, v) = (direction(mu_i, 0.0), direction(mu_o, phi));
                        for covered in [0.0, 0.4] {
                            let there = side.brdf(&s, &silver, covered, l, v);
                            let back = side.brdf(&s, &silver, covered, v, l);
                            worst = worst.max(apart(there, back));
                        }
                    }
                    // Light from behind, and the sheet turned over. Both sides are in air: what
                    // n² radiance gains on the way in, it loses on the way out.
                    let [at_i, at_o] = [mu_i, mu_o].map(|mu| side.table.at(mu, alpha));
                    let paper = &side.study.through;
                    let ways = [side.seen(front, back), side.seen(back, front)];
                    let mean = &side.mean;
                    let Ways { path_i, path_o, .. } = side.ways(mu_i, mu_o);
                    let there = btdf_study(paper, &ways[0], &at_i, &at_o, mean, path_i, path_o, n);
                    let back = btdf_study(paper, &ways[1], &at_o, &at_i, mean, path_o, path_i, n);
                    through = through.max(apart(there, back));
                    // Without turning the inks with the sheet it is another one.
                    let same = btdf_study(paper, &ways[0], &at_o, &at_i, mean, path_o, path_i, n);
                    one_way = one_way.max(apart(there, same));
                }
            }
        }
    }
    println!("reciprocity: reflected {worst:.1e}, transmitted {through:.1e}");
    assert!(
        worst < RECIPROCITY && through < RECIPROCITY,
        "{worst} {through}"
    );
    assert!(one_way > 1e3 * RECIPROCITY, "{one_way}");
}
