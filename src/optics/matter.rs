//! Media on the paper: how a spot's photograph is divided among paper, ink, body colour and
//! particles, and what body colour and particles do with light.
//!
//! A spot is a mixture, by area, of bare or inked paper, of body colour that hides it, and of
//! opaque particles. The shares are known from maps, those of particles as far as the photograph
//! bears them out, and the photograph of the whole spot: each part is lit in proportion to what its constants say, except that ink, whose depth nobody
//! knows beforehand, takes the darkness upon itself. So at 45°/0° the parts together are the
//! photograph again.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_8, PI};

use glam::DVec3;

use super::{
    fresnel::fresnel_conductor,
    ink::Film,
    medium::{BodyConstants, FilmConstants, ParticleConstants},
    microfacet::{ALPHA_MIN, d_ggx, v_smith},
    slab::{Body, UM_PER_MM},
    study::Study,
    table::{Interface, InterfaceMean, InterfaceTable},
    tier::{Facing, Surface, capture_floor},
};

/// Squared sine of the half angle between light and eye in reproduction photography, 22.5°.
const CAPTURE_SIN2_H: f64 = 0.5 - 0.5 * FRAC_1_SQRT_2;
/// Below this share of a spot nothing is told of a part's own colour.
pub const SHARE_LEAST: f64 = 1e-4;

/// A sort of particles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Particle {
    /// n + ik per channel.
    pub n: DVec3,
    /// GGX roughness of what they form.
    pub alpha: f64,
    pub k: DVec3,
    /// Fresnel reflectance in the geometry of capture.
    pub f_capture: DVec3,
    /// At full coverage as photographed at 45°/0°.
    pub albedo: DVec3,
}

impl Particle {
    /// From the constants of a medium.
    pub fn new(constants: &ParticleConstants) -> Self {
        let (n, k) = (constants.n, constants.k);
        let f = |c: usize| fresnel_conductor(FRAC_PI_8.cos(), n[c], k[c]);
        Self {
            n: n.into(),
            alpha: constants.roughness.clamp(ALPHA_MIN, 1.0),
            k: k.into(),
            f_capture: DVec3::new(f(0), f(1), f(2)),
            albedo: constants.albedo.into(),
        }
    }
}

/// What lies on a spot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cover {
    /// Share of what nothing else covers that ink does, in [0, 1].
    pub film: f64,
    /// Share of the spot that body colour covers, in [0, 1].
    pub body: f64,
    /// Share of the spot that particles of all sorts cover, in [0, 1 − body].
    pub particles: f64,
    /// What these particles photograph as by their constants: the sum of albedo × coverage.
    pub grains: DVec3,
}

/// Share of the particles' stated coverage that a spot's photograph bears out, in [0, 1]: a map
/// that names a medium covers its strokes wholly, but a faint stroke of metal or chalk is paper
/// between sparse grains. The coverage that, with bare paper and body colour around it, is
/// nearest to the photograph by least squares over the channels; ink beside it only darkens, and
/// then all is borne out. `bare` and `body` as for [`shares_of`].
pub fn borne_out(
    s: &Surface,
    mean: &InterfaceMean,
    bare: DVec3,
    body: DVec3,
    cover: &Cover,
) -> f64 {
    let floor = capture_floor(s, mean);
    let around = bare * (1.0 - cover.body) + body * cover.body + floor;
    let less = (bare + floor) * cover.particles - cover.grains;
    let found = (around - s.albedo).dot(less);
    let whole = less.dot(less);
    if whole < 1e-8 {
        return 1.0;
    }
    (found / whole).clamp(0.0, 1.0)
}

/// The cover of which the share `borne` of the particles is left.
pub fn with_borne(cover: &Cover, borne: f64) -> Cover {
    let particles = cover.particles * borne;
    let before = (1.0 - cover.particles - cover.body).max(0.0);
    let after = (1.0 - particles - cover.body).max(SHARE_LEAST);
    Cover {
        film: (cover.film * before / after).min(1.0),
        body: cover.body,
        particles,
        grains: cover.grains * borne,
    }
}

/// A spot's photograph, divided.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shares {
    /// Diffuse albedo of paper and ink, as [`albedo_of`](super::tier::albedo_of) gives it for
    /// spots without anything else.
    pub paper: DVec3,
    /// Share of the spot that has a dielectric surface: all but the particles.
    pub surface: f64,
    /// Diffuse albedo of the body colour.
    pub body: DVec3,
    /// Share of the spot where paper or ink is seen.
    pub uncovered: f64,
    /// What each sort of particles photographs, as a multiple of what its constants say.
    pub scale: DVec3,
    /// Photographed light of the whole spot, its dielectric surface's taken out.
    pub lit: DVec3,
}

/// Divides the photograph of a spot, `s.albedo`. `bare` is the diffuse albedo of the bare paper,
/// `body` the albedo of the body colour.
pub fn shares_of(
    s: &Surface,
    mean: &InterfaceMean,
    bare: DVec3,
    body: DVec3,
    cover: &Cover,
) -> Shares {
    let surface = (1.0 - cover.particles).max(0.0);
    let uncovered = (surface - cover.body).max(0.0);
    let most = DVec3::splat(1.0 / (mean.t_mean * mean.capture));
    let lit = (s.albedo - capture_floor(s, mean) * surface)
        .max(s.albedo.min(DVec3::ZERO))
        .min(most);
    let seen = lit.max(DVec3::ZERO);
    let covered = body * cover.body + cover.grains;
    let even = seen / (bare * uncovered + covered).max(DVec3::splat(1e-6));
    let inked = (seen / covered.max(DVec3::splat(1e-6))).min(DVec3::ONE);
    // Where the spot is brighter than all constants say, ink explains nothing.
    let scale = even + (inked - even).max(DVec3::ZERO) * cover.film;
    Shares {
        paper: lit - covered * scale,
        surface,
        body: body * cover.body * scale,
        uncovered,
        scale,
        lit: seen,
    }
}

/// Photographed share of the bare paper's diffuse albedo, of what is not covered; that of bare
/// paper where everything is.
pub fn uncovered_share(shares: &Shares, bare: DVec3) -> DVec3 {
    let missing = (SHARE_LEAST - shares.uncovered).max(0.0);
    (shares.paper + bare * missing) / (bare * shares.uncovered.max(SHARE_LEAST))
}

/// π times the lobe of full coverage at 45°/0°.
pub fn particle_capture(particle: &Particle, alpha: f64) -> DVec3 {
    let facets = d_ggx(CAPTURE_SIN2_H, alpha) * v_smith(FRAC_1_SQRT_2, 1.0, alpha);
    particle.f_capture * (PI * facets)
}

/// Share of the covered area that mirrors as the pure material, where particles photograph as
/// `albedo` at full coverage and a pure mirror of them would as `mirrored`. Fresh metal reflects
/// more at 45°/0° than a sparse, tarnished stroke photographs: the photograph bounds its gloss.
/// What does not mirror scatters, and no more than falls on it: neither on the particles nor on
/// the whole spot, which photographs as `lit`.
pub fn particle_gloss(albedo: DVec3, mirrored: DVec3, lit: DVec3) -> f64 {
    let dark = albedo / mirrored.max(DVec3::splat(1e-6));
    let bright = (1.0 - albedo.max(lit)) / (1.0 - mirrored).max(DVec3::splat(1e-6));
    dark.min(bright).min_element().clamp(0.0, 1.0)
}

/// The lobe of full coverage, without the cosine; `alpha` is the particle's roughness, widened
/// where the relief is.
pub fn particle_lobe(particle: &Particle, alpha: f64, g: &Facing) -> DVec3 {
    let facets = d_ggx(g.sin2_h, alpha) * v_smith(g.mu_i, g.mu_o, alpha);
    let f = |c: usize| fresnel_conductor(g.cos_d, particle.n[c], particle.k[c]);
    DVec3::new(f(0), f(1), f(2)) * facets
}

/// Diffuse light of body colour, without the cosine: under a surface as paper is, with its own
/// scattering that has no ink above it.
pub fn brdf_body(body: DVec3, at_i: &Interface, at_o: &Interface, mean: &InterfaceMean) -> DVec3 {
    body * (at_i.t * at_o.t * mean.capture / PI)
}

/// Share of the light through bare paper that gets through a spot without ink: `body_through` is
/// what body colour lets through, `toned` what paper does where no ink lies (see
/// [`toned_paper`](super::study::toned_paper)).
pub fn passing(cover: &Cover, body_through: DVec3, toned: DVec3) -> DVec3 {
    let uncovered = (1.0 - cover.particles - cover.body).max(0.0);
    uncovered * (cover.film + toned * (1.0 - cover.film)) + body_through * cover.body
}

/// τ of an even film through which, along the normal, as much light passes as through ink of
/// `depth` beside paper and body colour, which have none: [`passing`] is to be multiplied.
pub fn veiled(cover: &Cover, body_through: DVec3, toned: DVec3, depth: DVec3) -> DVec3 {
    let uncovered = (1.0 - cover.particles - cover.body).max(0.0);
    let beside = uncovered * toned * (1.0 - cover.film) + body_through * cover.body + 1e-6;
    let inked = uncovered * cover.film;
    let passes = inked * (-depth).exp() + beside;
    (-(passes / (inked + beside)).map(f64::ln)).max(DVec3::ZERO)
}

/// An interface that reflects `reflects` times as much as the tabulated one, for another index.
pub fn interface_of(at: &Interface, reflects: f64) -> Interface {
    Interface {
        t: (1.0 - reflects * (1.0 - at.t)).clamp(0.0, 1.0),
        late: at.late,
    }
}

/// Its means. The product of the transmittances at 0° and 45° is taken as a square: both are
/// within a few hundredths of 1.
pub fn mean_of(mean: &InterfaceMean, reflects: f64) -> InterfaceMean {
    let captured = 1.0 - reflects * (1.0 - (1.0 / mean.capture).sqrt());
    // More than one bounce reflects about as the square.
    let bounces = reflects * reflects;
    InterfaceMean {
        compensation: mean.compensation * bounces,
        t_mean: 1.0 - reflects * (1.0 - mean.t_mean),
        capture: 1.0 / (captured * captured),
        floor: mean.floor * bounces,
    }
}

/// The constants of all media of one side, as its spots need them.
#[derive(Clone, Debug, PartialEq)]
pub struct Media {
    pub particles: Vec<Particle>,
    /// The brightest photographed albedo of its sorts of particles at full coverage. Where all
    /// sorts count as one, a darker one's coverage is borne out all the same.
    pub grains: DVec3,
    /// Of the side's body colours, their mean: albedo of full coverage, diffuse part.
    pub body_albedo: DVec3,
    /// Light through paper and body colour over that through the bare paper.
    pub body_through: DVec3,
    /// Refractive index of the films' surface, their mean.
    pub film_eta: f64,
    /// Refractive index of the body colours' surface, their mean.
    pub body_eta: f64,
    /// Mean reflectance of the films' surface over that of the paper's.
    pub film_reflects: f64,
    /// The same of the body colours'.
    pub body_reflects: f64,
    /// What the photographed share of bare paper is multiplied by, as under the films' surface
    /// the same paper photographs otherwise.
    pub film_gain: DVec3,
}

/// The media that a side names, each once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SideMedia {
    pub films: Vec<FilmConstants>,
    pub bodies: Vec<BodyConstants>,
    /// In the order of the matter maps' slots.
    pub particles: Vec<ParticleConstants>,
}

impl SideMedia {
    /// Mean index of the films' surface; that of the paper, `eta`, without films.
    pub fn film_index(&self, eta: f64) -> f64 {
        mean_or(self.films.iter().map(|film| film.index), eta)
    }

    /// Whether a film or body colour has a surface of another index than paper of index `eta`.
    pub fn index_differs(&self, eta: f64) -> bool {
        let films = self.films.iter().map(|film| film.index);
        let bodies = self.bodies.iter().map(|body| body.index);
        films
            .chain(bodies)
            .any(|index| (index - eta).abs() >= INDEX_STEP)
    }
}

/// Indices nearer to each other are one: a surface reflects .003 more or less at most.
const INDEX_STEP: f64 = 0.02;

fn mean_or(values: impl Iterator<Item = f64>, otherwise: f64) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v, count + 1.0));
    if count > 0.0 { sum / count } else { otherwise }
}

fn mean_colour(values: impl Iterator<Item = DVec3>) -> DVec3 {
    let (sum, count) = values.fold((DVec3::ZERO, 0.0), |(sum, count), v| (sum + v, count + 1.0));
    if count > 0.0 {
        sum / count
    } else {
        DVec3::ZERO
    }
}

impl Media {
    /// Media on the paper of `study`, whose surface is `paper` with these means.
    pub fn new(media: &SideMedia, paper: &Surface, mean: &InterfaceMean, study: &Study) -> Self {
        let film_eta = media.film_index(paper.eta);
        let body_eta = mean_or(media.bodies.iter().map(|body| body.index), paper.eta);
        let film_mean = mean_under(paper, film_eta);
        let reflects = |under: &InterfaceMean| {
            // A surface that reflects nothing reflects nothing under any index.
            let here = (1.0 - mean.t_mean).max(1e-6);
            if paper.specular > 0.0 {
                (1.0 - under.t_mean) / here
            } else {
                1.0
            }
        };
        let of_bodies: Vec<BodyLight> = media
            .bodies
            .iter()
            .map(|body| BodyLight::new(body, paper, mean, study))
            .collect();
        let through = mean_colour(of_bodies.iter().map(|body| body.through));
        let particles: Vec<Particle> = media.particles.iter().map(Particle::new).collect();
        Self {
            grains: particles
                .iter()
                .fold(DVec3::ZERO, |most, each| most.max(each.albedo)),
            particles,
            body_albedo: mean_colour(of_bodies.iter().map(|body| body.albedo)),
            body_through: through,
            film_eta,
            body_eta,
            film_reflects: reflects(&film_mean),
            body_reflects: reflects(&mean_under(paper, body_eta)),
            film_gain: film_gain([(paper.eta, mean), (film_eta, &film_mean)], study),
        }
    }

    /// `study`, whose paths are those in the films, with films of the side's own index.
    pub fn with_films(&self, paper: &Surface, mean: &InterfaceMean, study: Study) -> Study {
        let interface = InterfaceTable::at_roughness(paper.alpha, self.film_eta, paper.specular);
        let r_i = internal(&interface.mean_at(paper.alpha), self.film_eta);
        let r_b = backed(&study, internal(mean, paper.eta));
        let paths = study.film.paths.clone();
        let film = Film::new(self.film_eta, paper.alpha, &interface, paths, r_i, r_b);
        Study { film, ..study }
    }
}

/// r_i of a surface.
fn internal(mean: &InterfaceMean, eta: f64) -> f64 {
    (1.0 - mean.t_mean / (eta * eta)).max(0.0)
}

/// R_b of the paper over its own boundary.
fn backed(study: &Study, r_i: f64) -> DVec3 {
    let (r, t) = (study.through.reflected, study.through.transmitted);
    r + t * t * r_i / (1.0 - r * r_i)
}

/// What bare paper photographs as, without its gloss, over what it does under a clear film.
fn film_gain(surfaces: [(f64, &InterfaceMean); 2], study: &Study) -> DVec3 {
    let (eta, mean) = surfaces[0];
    let r_b = backed(study, internal(mean, eta));
    let [without, under] = surfaces.map(|(eta, mean)| {
        let passes = (1.0 - internal(mean, eta) * r_b).max(DVec3::splat(1e-6));
        1.0 / (passes * mean.capture * eta * eta)
    });
    without / under
}

/// Means of the paper's surface, were its index `eta`.
fn mean_under(paper: &Surface, eta: f64) -> InterfaceMean {
    InterfaceTable::at_roughness(paper.alpha, eta, paper.specular).mean_at(paper.alpha)
}

/// Body colour at full coverage.
struct BodyLight {
    albedo: DVec3,
    through: DVec3,
}

impl BodyLight {
    fn new(body: &BodyConstants, paper: &Surface, mean: &InterfaceMean, study: &Study) -> Self {
        let r_i = internal(mean, paper.eta);
        let photographed = Surface {
            albedo: body.albedo.into(),
            ..*paper
        };
        let albedo = super::tier::albedo_of(&photographed, mean).max(DVec3::splat(1e-3));
        let (r_p, t_p) = (study.through.reflected, study.through.transmitted);
        // The surface of the layer on top; behind, the paper's own.
        let eta = body.index;
        let mean_f = mean_under(paper, eta);
        let r_f = internal(&mean_f, eta);
        // Between both boundaries, all passes counted.
        let crossing = |front: f64, r_f: f64, back: f64, t: f64| {
            let passes = (1.0 - front * r_f) * (1.0 - back * r_i) - t * t * r_f * r_i;
            t / passes.max(1e-6)
        };
        let narrower = (paper.eta / eta).powi(2);
        let below = backed(study, r_i);
        let mut through = DVec3::ZERO;
        for c in 0..3 {
            let from_within = albedo[c] * eta * eta * mean_f.capture;
            let r_b = (from_within / (1.0 + r_f * from_within)).min(1.0);
            let thickness = body.scattering_per_mm * body.thickness_um / UM_PER_MM;
            let layer = layer_photographed(thickness, r_b, below[c]);
            // Both layers, all passes between them counted (Kubelka's sum).
            let between = 1.0 / (1.0 - layer.reflected * r_p[c]).max(1e-6);
            let t = layer.transmitted * t_p[c] * between;
            let front = layer.reflected + layer.transmitted.powi(2) * r_p[c] * between;
            let back = r_p[c] + t_p[c].powi(2) * layer.reflected * between;
            let alone = crossing(r_p[c], r_i, r_p[c], t_p[c]).max(1e-12);
            through[c] = (narrower * crossing(front, r_f, back, t) / alone).clamp(0.0, 1.0);
        }
        Self { albedo, through }
    }
}

/// A layer of pigment of scattering optical thickness `tau` and absorption σa/σs `loss`, by
/// Kubelka & Munk 1931 with S = ¾σs and K = 2σa, isotropic. The paper's diffusion needs several
/// scatterings; paint is as thin as one. Against the random walk in diffuse light, without a
/// surface: T .870/.727/.571/.400/.182/.118 at τ = .2/.5/1/2/6/10 where the walk gives
/// .853/.707/.556/.390/.178/.115 (diffusion: .548/.623/.759/.500/.212/.134).
pub fn layer_of_pigment(tau: f64, loss: f64) -> Body {
    let s = 0.75 * tau;
    let k = 2.0 * loss * tau;
    // a = 1 + K/S, b = √(a² − 1): b S d and its limit for K → 0.
    let x = (k * (k + 2.0 * s)).max(0.0).sqrt();
    if x < 1e-6 {
        return Body {
            reflected: s / (1.0 + s),
            transmitted: 1.0 / (1.0 + s),
        };
    }
    // Both over sinh, which overflows where nothing comes through.
    let coth = 1.0 / x.tanh();
    let all = s + k + x * coth;
    Body {
        reflected: s / all,
        transmitted: (x / all) * 2.0 * (-x).exp() / -(-2.0 * x).exp_m1(),
    }
}

/// The layer that, over a backing of reflectance `below`, reflects the share `r_b` of diffuse
/// light; without absorption where even that is too dark.
fn layer_photographed(tau: f64, r_b: f64, below: f64) -> Body {
    let lit = |loss: f64| layer_of_pigment(tau, loss).backed(below);
    let (mut low, mut high) = (0.0, 1.0);
    if lit(low) <= r_b {
        return layer_of_pigment(tau, 0.0);
    }
    while lit(high) > r_b && high < 1e6 {
        high *= 2.0;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if lit(middle) > r_b {
            low = middle;
        } else {
            high = middle;
        }
    }
    layer_of_pigment(tau, 0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::{
        bsdf::Specimen,
        medium::{Matter, MediumId},
    };

    /// Laid paper under reproduction light, and its means.
    fn laid() -> (Specimen, InterfaceMean) {
        let id = "laid".parse::<MediumId>().expect("laid paper");
        let laid = Specimen::new(id.medium(), DVec3::new(0.8, 0.7, 0.5));
        let mean = laid.interface.mean_at(laid.surface.alpha);
        (laid, mean)
    }

    #[test]
    fn films_of_the_papers_index_change_nothing_of_it() {
        let (paper, mean) = laid();
        let media = Media::new(&SideMedia::default(), &paper.surface, &mean, &paper.study);
        for reflects in [media.film_reflects, media.body_reflects] {
            assert!((reflects - 1.0).abs() < 1e-9, "{reflects}");
        }
        assert!((media.film_gain - 1.0).abs().max_element() < 1e-9);
        // A film that water would be reflects less.
        let water = SideMedia {
            films: vec![FilmConstants {
                index: 1.33,
                roughness: paper.surface.alpha,
                depth: [0.1; 3],
            }],
            ..SideMedia::default()
        };
        let wet = Media::new(&water, &paper.surface, &mean, &paper.study);
        assert!(wet.film_reflects < 0.9, "{}", wet.film_reflects);
    }

    #[test]
    fn a_backed_sheet_is_the_sum_of_all_passes() {
        let (paper, mean) = laid();
        let r_i = internal(&mean, paper.surface.eta);
        let (r, t) = (
            paper.study.through.reflected,
            paper.study.through.transmitted,
        );
        // Through, back at the boundary, and so often within as light is left.
        let mut sum = r;
        let mut within = t * r_i;
        for _ in 0..200 {
            sum += within * t;
            within *= r * r_i;
        }
        let found = backed(&paper.study, r_i);
        assert!((found - sum).abs().max_element() < 1e-12, "{found} {sum}");
    }

    #[test]
    fn a_surface_of_hardly_another_index_sends_hardly_anything_back() {
        let mean = InterfaceMean {
            t_mean: 1.0,
            ..InterfaceMean::default()
        };
        // 1 − 1/n²; what passes a boundary of no index is all, whatever rounding says.
        assert!((internal(&mean, 1.02) - 0.0404 / 1.0404).abs() < 1e-12);
        assert_eq!(internal(&mean, 1.0), 0.0);
    }

    #[test]
    fn particles_are_no_rougher_than_facets_can_be() {
        let Matter::Particles(constants) = "silver-point"
            .parse::<MediumId>()
            .expect("silver point")
            .medium()
            .matter
        else {
            panic!("silver point is not made of particles");
        };
        let rough = ParticleConstants {
            roughness: 1.5,
            ..constants
        };
        assert_eq!(Particle::new(&rough).alpha, 1.0);
        assert!((CAPTURE_SIN2_H - FRAC_PI_8.sin().powi(2)).abs() < 1e-15);
    }

    /// A photograph is divided by it.
    #[test]
    fn the_blackest_paint_still_reflects_a_thousandth() {
        let (paper, mean) = laid();
        let id = "white-gouache".parse::<MediumId>().expect("white gouache");
        let Matter::Body(white) = id.medium().matter else {
            panic!("white gouache is no body colour");
        };
        let body = |albedo: [f64; 3]| {
            let side = SideMedia {
                bodies: vec![BodyConstants { albedo, ..white }],
                ..SideMedia::default()
            };
            Media::new(&side, &paper.surface, &mean, &paper.study)
        };
        let black = body([0.0; 3]);
        assert_eq!(black.body_albedo, DVec3::splat(1e-3));
        // And lets through less than white.
        let white = body(white.albedo);
        assert!(black.body_through.cmplt(white.body_through).all());
        assert!(black.body_through.min_element() >= 0.0);
    }

    /// Kubelka 1948: R = sinh bS/(a sinh bS + b cosh bS), T = b over the same.
    #[test]
    fn layers_of_pigment_meet_their_closed_form() {
        for tau in [0.2, 1.0, 6.0] {
            let clear = layer_of_pigment(tau, 0.0);
            assert!((clear.reflected + clear.transmitted - 1.0).abs() < 1e-12);
            for loss in [1e-3, 0.1, 2.0] {
                let (s, k) = (0.75 * tau, 2.0 * loss * tau);
                let a = 1.0 + k / s;
                let b = (a * a - 1.0).sqrt();
                let below = a * (b * s).sinh() + b * (b * s).cosh();
                let layer = layer_of_pigment(tau, loss);
                assert!((layer.reflected - (b * s).sinh() / below).abs() < 1e-9);
                assert!((layer.transmitted - b / below).abs() < 1e-9, "{tau} {loss}");
            }
        }
    }

    #[test]
    fn paint_over_paper_reflects_what_was_photographed() {
        for tau in [0.5, 2.0, 10.0] {
            for below in [0.1, 0.6] {
                let clear = layer_of_pigment(tau, 0.0).backed(below);
                for share in [0.3, 0.7, 0.95] {
                    let r_b = share * clear;
                    let layer = layer_photographed(tau, r_b, below);
                    assert!(
                        (layer.backed(below) - r_b).abs() < 1e-9,
                        "{tau} {below} {share}"
                    );
                }
                // Lighter than without any absorption is as light as that.
                let white = layer_photographed(tau, 1.1 * clear, below);
                assert!((white.backed(below) - clear).abs() < 1e-12);
            }
        }
    }
}
