//! Media on paper in f64: the photograph comes back, light and eye can be exchanged, no spot
//! gives more light than it gets, and gouache holds light back.

use std::{
    f64::consts::{FRAC_1_SQRT_2, PI, TAU},
    sync::Arc,
};

use glam::DVec3;
use recto::{
    colour::{delta_e00, lab_from_linear},
    optics::{
        ink::{capture_path, optical_depth},
        matter::{
            Cover, Media, Shares, SideMedia, borne_out, brdf_body, interface_of, layer_of_pigment,
            mean_of, particle_capture, particle_gloss, particle_lobe, passing, shares_of,
            uncovered_share, veiled, with_borne,
        },
        medium::{Matter, MediumId},
        refraction::PathTable,
        slab::Slab,
        study::{Study, Ways, brdf_study},
        table::{Interface, InterfaceMean, InterfaceTable},
        tier::{Surface, facing},
    },
    reference::{Absorption, Layers, Phase, reflectance_transmittance},
    units::Micrometres,
};

/// Exchanging light and eye only exchanges factors.
const RECIPROCITY: f64 = 1e-6;
/// OPTICS.md, "energy".
const ENERGY: f64 = 1e-3;
/// The same where a surface's index is not that of the tables; measured .0037.
const INDEXED: f64 = 5e-3;
/// The capture round trip; what is over is the calibration's, not the display's.
const ROUND_TRIP: f64 = 0.5;
/// The steps of the integrals over the hemisphere.
const STEPS: u32 = 64;

/// A side of laid paper with every drawn medium of the catalogue that has matter.
struct Side {
    surface: Surface,
    table: InterfaceTable,
    mean: InterfaceMean,
    study: Study,
    media: Media,
}

fn side_media(names: &[&str]) -> SideMedia {
    let mut side = SideMedia::default();
    for name in names {
        let id: MediumId = name.parse().expect("a medium");
        match id.medium().matter {
            Matter::Film(film) => side.films.push(film),
            Matter::Body(body) => side.bodies.push(body),
            Matter::Particles(particles) => side.particles.push(particles),
            other => panic!("{name}: {other:?}"),
        }
    }
    side
}

const NAMES: [&str; 7] = [
    "iron-gall-ink",
    "white-gouache",
    "lead-point",
    "silver-point",
    "black-chalk",
    "charcoal",
    "red-chalk",
];

impl Side {
    fn new(alpha: f64, bare: DVec3) -> Self {
        let table = InterfaceTable::at_roughness(alpha, 1.5, 1.0);
        let mean = table.mean_at(alpha);
        let surface = Surface::new(bare, alpha, 1.5, 1.0);
        let paths = Arc::new(PathTable::at_roughness(alpha, 1.5));
        let study = Study::new(&surface, &table, paths, Slab::rag_paper(Micrometres(165.0)));
        let media = Media::new(&side_media(&NAMES), &surface, &mean, &study);
        Self {
            surface,
            table,
            mean,
            study,
            media,
        }
    }
}

/// A spot as the shader puts it together.
#[derive(Clone)]
struct Spot {
    cover: Cover,
    /// Of each sort of particles.
    coverages: Vec<f64>,
    /// Whether body colour and ink have a surface of their own index.
    indexed: bool,
    /// To be found out: the mirrored light is not taken from what particles scatter.
    broken: bool,
}

impl Spot {
    fn new(side: &Side, film: f64, body: f64, coverages: &[f64]) -> Self {
        let particles: f64 = coverages.iter().sum();
        let open = (1.0 - particles - body).max(0.0);
        let grains = coverages
            .iter()
            .zip(&side.media.particles)
            .map(|(c, particle)| particle.albedo * *c)
            .sum();
        Self {
            cover: Cover {
                film: (film / open.max(1e-4)).clamp(0.0, 1.0),
                body,
                particles,
                grains,
            },
            coverages: coverages.to_vec(),
            indexed: false,
            broken: false,
        }
    }

    /// The surface, its means, and how much more it reflects than the paper's.
    fn surface(&self, side: &Side, albedo: DVec3) -> (Surface, InterfaceMean, f64) {
        let (mut eta, mut reflects) = (side.surface.eta, 1.0);
        if self.indexed {
            let dielectric = (1.0 - self.cover.particles).max(1e-4);
            let open = (1.0 - self.cover.particles - self.cover.body).max(0.0);
            let film = (self.cover.film * open / dielectric).min(1.0);
            let body = (self.cover.body / dielectric).min(1.0);
            let media = &side.media;
            eta += film * (media.film_eta - side.surface.eta)
                + body * (media.body_eta - side.surface.eta);
            reflects += film * (media.film_reflects - 1.0) + body * (media.body_reflects - 1.0);
        }
        let surface = Surface::new(albedo, side.surface.alpha, eta, 1.0);
        (surface, mean_of(&side.mean, reflects), reflects)
    }

    fn shares(&self, side: &Side, albedo: DVec3) -> Shares {
        let (surface, mean, _) = self.surface(side, albedo);
        let (bare, body) = (side.study.bare, side.media.body_albedo);
        shares_of(&surface, &mean, bare, body, &self.cover)
    }

    fn brdf(&self, side: &Side, albedo: DVec3, l: DVec3, v: DVec3) -> DVec3 {
        let (s, mean, reflects) = self.surface(side, albedo);
        let shares = self.shares(side, albedo);
        let g = facing(DVec3::Z, l, v);
        let at = |mu: f64| -> Interface { interface_of(&side.table.at(mu, s.alpha), reflects) };
        let (at_i, at_o) = (at(g.mu_i), at(g.mu_o));
        let film = &side.study.film;
        let split = &side.study.split;
        let share = uncovered_share(&shares, side.study.bare);
        let ways = Ways {
            capture: capture_path(&film.paths, s.alpha),
            path_i: film.paths.at(g.mu_i, s.alpha),
            path_o: film.paths.at(g.mu_o, s.alpha),
        };
        let depth = optical_depth(film, ways.capture, share) * self.cover.film;
        let (paper, surface) = (shares.paper, shares.surface);
        let mut f = brdf_study(
            &s, &g, &at_i, &at_o, &mean, split, depth, &ways, paper, surface,
        );
        f += brdf_body(shares.body, &at_i, &at_o, &mean);
        for (covered, particle) in self.coverages.iter().zip(&side.media.particles) {
            let photographed = particle.albedo * shares.scale;
            let mirrored = particle_capture(particle, particle.alpha);
            let mirrors = particle_gloss(photographed, mirrored, shares.lit);
            let less = if self.broken { 0.0 } else { mirrors };
            f += (photographed - mirrored * less).max(DVec3::ZERO) * (covered / PI);
            f += particle_lobe(particle, particle.alpha, &g) * (mirrors * covered);
        }
        f
    }

    /// Share of the light from `mu` that is reflected.
    fn albedo(&self, side: &Side, albedo: DVec3, mu: f64) -> DVec3 {
        let l = DVec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
        let mut sum = DVec3::ZERO;
        for i in 0..STEPS {
            // In √μ the steps are finest at grazing angles.
            let x = (f64::from(i) + 0.5) / f64::from(STEPS);
            let (mu, step) = (x * x, 2.0 * x / f64::from(STEPS));
            let sin = (1.0 - mu * mu).sqrt();
            for j in 0..STEPS {
                let phi = TAU * (f64::from(j) + 0.5) / f64::from(STEPS);
                let v = DVec3::new(sin * phi.cos(), sin * phi.sin(), mu);
                sum += self.brdf(side, albedo, l, v) * (mu * step);
            }
        }
        sum * TAU / f64::from(STEPS)
    }
}

/// Paper, each medium alone and thin, and mixtures.
fn spots(side: &Side) -> Vec<Spot> {
    let none = [0.0; 5];
    let only = |sort: usize, share: f64| {
        let mut coverages = none;
        coverages[sort] = share;
        coverages
    };
    let mut spots = vec![
        Spot::new(side, 0.0, 0.0, &none),
        Spot::new(side, 1.0, 0.0, &none),
        Spot::new(side, 0.4, 0.0, &none),
        Spot::new(side, 0.0, 1.0, &none),
        Spot::new(side, 0.3, 0.5, &none),
        Spot::new(side, 0.2, 0.2, &[0.1, 0.1, 0.1, 0.1, 0.1]),
        Spot::new(side, 0.0, 0.0, &[0.2, 0.2, 0.2, 0.2, 0.2]),
        Spot::new(side, 0.5, 0.0, &[0.0, 0.5, 0.0, 0.0, 0.0]),
    ];
    for sort in 0..5 {
        spots.extend([0.05, 0.5, 1.0].map(|share| Spot::new(side, 0.0, 0.0, &only(sort, share))));
    }
    let indexed = spots.clone().into_iter().map(|spot| Spot {
        indexed: true,
        ..spot
    });
    spots.extend(indexed.collect::<Vec<_>>());
    spots
}

const PHOTOGRAPHS: [[f64; 3]; 6] = [
    [0.7, 0.65, 0.55],
    [0.36, 0.09, 0.045],
    [0.05, 0.04, 0.04],
    [0.2, 0.22, 0.25],
    [0.86, 0.86, 0.83],
    [0.95, 0.93, 0.9],
];

fn sides() -> [Side; 2] {
    [
        Side::new(0.3, DVec3::new(0.72, 0.67, 0.57)),
        Side::new(0.8, DVec3::splat(0.85)),
    ]
}

/// The largest ΔE00 of what 45°/0° shows to what was photographed.
fn round_trip(side: &Side, spot: &Spot) -> f64 {
    let l = DVec3::new(FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2);
    let back = |albedo: [f64; 3]| PI * spot.brdf(side, albedo.into(), l, DVec3::Z);
    let lab = |of: DVec3| lab_from_linear(of.to_array());
    let each = PHOTOGRAPHS.map(|albedo| delta_e00(lab(back(albedo)), lab(albedo.into())));
    each.into_iter().fold(0.0, f64::max)
}

#[test]
fn every_mixture_photographs_as_it_was_photographed() {
    for side in sides() {
        for spot in spots(&side) {
            let off = round_trip(&side, &spot);
            assert!(off < ROUND_TRIP, "{:?}: {off}", spot.cover);
        }
        let mut wrong = Spot::new(&side, 0.0, 0.0, &[0.0, 1.0, 0.0, 0.0, 0.0]);
        wrong.broken = true;
        assert!(round_trip(&side, &wrong) > ROUND_TRIP);
    }
}

#[test]
fn light_and_eye_can_be_exchanged() {
    let towards = |theta: f64, phi: f64| {
        let (sin, cos) = theta.to_radians().sin_cos();
        DVec3::new(sin * phi.cos(), sin * phi.sin(), cos)
    };
    for side in sides() {
        for spot in spots(&side) {
            for albedo in PHOTOGRAPHS.map(DVec3::from) {
                for (l, v) in [
                    (towards(10.0, 0.3), towards(70.0, 2.0)),
                    (towards(85.0, 0.0), towards(40.0, 3.1)),
                ] {
                    let (there, back) = (
                        spot.brdf(&side, albedo, l, v),
                        spot.brdf(&side, albedo, v, l),
                    );
                    let off = ((there - back) / there).abs().max_element();
                    assert!(off < RECIPROCITY, "{:?}: {there} {back}", spot.cover);
                    assert!(there.min_element() > 0.0);
                }
            }
        }
    }
}

#[test]
fn no_spot_gives_more_light_than_it_gets() {
    let mut most: f64 = 0.0;
    for side in sides() {
        let paper = Spot::new(&side, 0.0, 0.0, &[]);
        for albedo in [DVec3::ONE, DVec3::new(1.0, 0.3, 0.9), PHOTOGRAPHS[1].into()] {
            for mu in [0.05, 0.3, FRAC_1_SQRT_2, 1.0] {
                // The tier's own error for paper that is whiter than any is not a mixture's.
                let of_paper = paper.albedo(&side, albedo, mu).max_element();
                for spot in spots(&side) {
                    let all = spot.albedo(&side, albedo, mu).max_element();
                    most = most.max(all);
                    let own = if spot.indexed { INDEXED } else { ENERGY };
                    let bound = of_paper.max(1.0) + own;
                    assert!(all < bound, "{:?} {albedo} {mu}: {all}", spot.cover);
                }
            }
        }
    }
    // The bound is not idle.
    assert!(most > 0.97, "{most}");
}

#[test]
fn a_sorts_gloss_is_what_its_photograph_leaves_room_for() {
    let mirrored = DVec3::splat(0.5);
    let of =
        |albedo: f64, lit: f64| particle_gloss(DVec3::splat(albedo), mirrored, DVec3::splat(lit));
    assert_eq!(of(0.0, 0.3), 0.0);
    assert_eq!(of(0.5, 0.3), 1.0);
    assert!((of(0.25, 0.3) - 0.5).abs() < 1e-12);
    // What scatters nearly all light has no room for a mirror, nor has it in a spot that does.
    assert!((of(0.9, 0.3) - 0.2).abs() < 1e-12);
    assert!((of(0.5, 0.9) - 0.2).abs() < 1e-12);
    assert_eq!(of(1.5, 0.3), 0.0);
}

/// Of what falls on a layer of pigment: measured up to .024.
const PIGMENT: f64 = 0.03;

#[test]
fn a_layer_of_pigment_is_the_judges() {
    for tau in [0.5, 2.0, 10.0] {
        for loss in [0.0, 0.02] {
            let scattering = tau / 0.025;
            let layers = Layers {
                n: 1.0,
                alpha: [0.0; 2],
                sigma_s: scattering,
                phase: Phase::single(0.0),
                thickness_mm: 0.025,
            };
            let inks = [Absorption {
                sigma_a: scattering * loss,
                ..Absorption::NONE
            }];
            let (mut reflected, mut transmitted) = (0.0, 0.0);
            for i in 0..4 {
                // Diffuse light: dμ² is even.
                let mu = ((f64::from(i) + 0.5) / 4.0).sqrt();
                let flux = &reflectance_transmittance(&layers, &inks, mu, 20_000, 7)[0];
                reflected += flux.reflected.mean / 4.0;
                transmitted += flux.transmitted.mean / 4.0;
            }
            let layer = layer_of_pigment(tau, loss);
            assert!(
                (layer.reflected - reflected).abs() < PIGMENT,
                "{tau} {loss}"
            );
            assert!(
                (layer.transmitted - transmitted).abs() < PIGMENT,
                "{tau} {loss}"
            );
            // A layer of half the scattering is another one.
            let other = layer_of_pigment(0.5 * tau, loss);
            assert!(
                (other.transmitted - transmitted).abs() > PIGMENT,
                "{tau} {loss}"
            );
        }
    }
    for (tau, loss) in [
        (0.0, 0.0),
        (1e-9, 1e9),
        (1e6, 1.0),
        (1e6, 0.0),
        (20.0, 1e-12),
    ] {
        let layer = layer_of_pigment(tau, loss);
        let sum = layer.reflected + layer.transmitted;
        assert!(layer.reflected >= 0.0 && layer.transmitted >= 0.0 && sum < 1.0 + 1e-9);
    }
}

#[test]
fn darkness_is_ink_where_a_film_lies_and_paper_elsewhere() {
    let side = &sides()[0];
    let chalk = |film| Spot::new(side, film, 0.0, &[0.0, 0.0, 0.5, 0.0, 0.0]);
    let dark = DVec3::splat(0.1);
    // Ink beside chalk explains the darkness: chalk keeps what its constants say.
    let inked = chalk(0.5).shares(side, dark);
    assert!((inked.scale - 1.0).abs().max_element() < 1e-9, "{inked:?}");
    // Without ink both are darker alike.
    let plain = chalk(0.0).shares(side, dark);
    assert!(plain.scale.max_element() < 0.5, "{plain:?}");
    // Either way nothing of the photograph is lost.
    for shares in [inked, plain] {
        let sum = shares.paper + chalk(0.0).cover.grains * shares.scale;
        let floor = recto::optics::tier::capture_floor(&side.surface, &side.mean) * 0.5;
        assert!((sum - (dark - floor)).abs().max_element() < 1e-12);
    }
}

/// Of what white paint on white paper passes. The paint's absorption lies on top of the paper, the
/// judge's all over one slab, which is the same where there is little.
const PAINTED: f64 = 0.05;

#[test]
fn white_paint_on_white_paper_passes_what_one_slab_of_both_does() {
    const ALPHA: f64 = 0.6;
    const INDEX: f64 = 1.5;
    const WHITE: f64 = 0.86;
    let paper = Slab::rag_paper(Micrometres(165.0));
    let surface = Surface::new(DVec3::splat(WHITE), ALPHA, INDEX, 1.0);
    let table = InterfaceTable::at_roughness(ALPHA, INDEX, 1.0);
    let mean = table.mean_at(ALPHA);
    let paths = Arc::new(PathTable::at_roughness(ALPHA, INDEX));
    let study = Study::new(&surface, &table, paths, paper);
    let mut media = side_media(&["white-gouache"]);
    let paint = &mut media.bodies[0];
    (paint.index, paint.roughness, paint.albedo) = (INDEX, ALPHA, [WHITE; 3]);
    let paint_mm = paint.thickness_um * 1e-3;
    let paint_depth = paint.scattering_per_mm * paint_mm;
    let passed = |layers: &Layers| {
        let flux = reflectance_transmittance(layers, &[Absorption::NONE], 1.0, 100_000, 5);
        flux[0].transmitted.mean
    };
    let bare = Layers {
        n: INDEX,
        alpha: [ALPHA; 2],
        sigma_s: paper.scattering,
        phase: Phase::single(1.0 / 3.0),
        thickness_mm: paper.thickness,
    };
    let thickness_mm = paint_mm + paper.thickness;
    let paper_depth = paper.scattering * (2.0 / 3.0) * paper.thickness;
    let painted = Layers {
        sigma_s: (paint_depth + paper_depth) / thickness_mm,
        phase: Phase::ISOTROPIC,
        thickness_mm,
        ..bare
    };
    let walked = passed(&painted) / passed(&bare);
    let share = Media::new(&media, &surface, &mean, &study).body_through.x;
    assert!((share / walked - 1.0).abs() < PAINTED, "{share} {walked}");
    media.bodies[0].thickness_um /= 2.0;
    let thin = Media::new(&media, &surface, &mean, &study).body_through.x;
    assert!((thin / walked - 1.0).abs() > PAINTED, "{thin} {walked}");
}

#[test]
fn gouache_holds_light_back_and_thicker_gouache_more() {
    let through = |thickness_um: f64, scattering: f64| {
        let side = Side::new(0.5, DVec3::splat(0.8));
        let mut media = side_media(&["white-gouache"]);
        media.bodies[0].thickness_um = thickness_um;
        media.bodies[0].scattering_per_mm = scattering;
        // One of another index would return more light into the paper, however thin.
        media.bodies[0].index = side.surface.eta;
        Media::new(&media, &side.surface, &side.mean, &side.study).body_through
    };
    let usual = through(25.0, 400.0);
    assert!(
        usual.max_element() < 0.6 && usual.min_element() > 0.05,
        "{usual}"
    );
    assert!(through(100.0, 400.0).max_element() < 0.5 * usual.min_element());
    // Next to nothing hides next to nothing.
    let clear = through(0.1, 0.01);
    assert!((clear - 1.0).abs().max_element() < 1e-2, "{clear}");
    let cover = Cover {
        particles: 0.25,
        body: 0.5,
        ..Cover::default()
    };
    let passes = passing(&cover, usual, DVec3::ONE);
    assert!((passes - (0.25 + 0.5 * usual)).abs().max_element() < 1e-12);
}

#[test]
fn a_clear_film_on_paper_is_no_ink() {
    // Paper under a film of lower index photographs brighter: the gain takes that back.
    let side = Side::new(0.5, DVec3::new(0.8, 0.7, 0.5));
    for index in [1.35, 1.6] {
        let mut media = side_media(&["iron-gall-ink"]);
        media.films[0].index = index;
        assert!(media.index_differs(1.5));
        let of_index = Media::new(&media, &side.surface, &side.mean, &side.study);
        let brighter = index < 1.5;
        assert_eq!(of_index.film_gain.max_element() < 1.0, brighter, "{index}");
        assert_eq!(of_index.film_reflects < 1.0, brighter, "{index}");
        let paths = Arc::new(PathTable::at_roughness(0.5, index));
        let slab = Slab::rag_paper(Micrometres(165.0));
        let study = Study::new(&side.surface, &side.table, paths, slab);
        let study = of_index.with_films(&side.surface, &side.mean, study);
        let capture = |study: &Study| capture_path(&study.film.paths, 0.5);
        // Another way through the film.
        let off = (capture(&study).x / capture(&side.study).x - 1.0).abs();
        assert!(off > 1e-3, "{index}: {off}");
        let clear = optical_depth(&study.film, capture(&study), DVec3::ONE);
        assert!(clear.max_element() < 2e-3, "{clear}");
    }
    let near = Media::new(&side_media(&[]), &side.surface, &side.mean, &side.study);
    assert!((near.film_gain - 1.0).abs().max_element() < 1e-12);
    assert!(near.film_reflects == 1.0 && near.body_through == DVec3::ZERO);
    assert!(side.media.particles.len() == 5);
    // Red chalk is the reddest, silver point the greenest and bluest of them.
    assert_eq!(side.media.grains, DVec3::new(0.36, 0.22, 0.20));
}

#[test]
fn ink_beside_gouache_darkens_only_what_it_covers() {
    let through = DVec3::splat(0.25);
    let depth = DVec3::splat(2.0);
    let cover = |body: f64, particles: f64| Cover {
        film: 1.0,
        body,
        particles,
        ..Cover::default()
    };
    let toned = DVec3::splat(1.5);
    let all = |cover: &Cover| {
        passing(cover, through, toned) * (-veiled(cover, through, toned, depth)).exp()
    };
    let half = all(&cover(0.5, 0.0)).x;
    assert!(
        (half - (0.5 * (-2.0_f64).exp() + 0.5 * 0.25)).abs() < 1e-5,
        "{half}"
    );
    assert!((all(&cover(1.0, 0.0)).x - 0.25).abs() < 1e-5);
    assert!((all(&cover(0.0, 0.0)).x - (-2.0_f64).exp()).abs() < 1e-5);
    assert_eq!(all(&cover(0.0, 1.0)), DVec3::ZERO);
    // Half of it ink, half of it paper that passes more, or less, than the sheet's mean.
    for tone in [1.5, 0.4] {
        let cover = Cover {
            film: 0.5,
            ..Cover::default()
        };
        let toned = DVec3::splat(tone);
        let found =
            passing(&cover, through, toned) * (-veiled(&cover, through, toned, depth)).exp();
        let expected = 0.5 * (-2.0_f64).exp() + 0.5 * tone;
        assert!((found.x - expected).abs() < 1e-5, "{tone}: {found}");
    }
    // Paper alone has no depth: it is as dark at a slant as from above.
    let paper = Cover::default();
    let toned = DVec3::splat(0.3);
    assert!(veiled(&paper, through, toned, depth).max_element() < 1e-5);
    assert_eq!(passing(&paper, through, toned), toned);
}

#[test]
fn a_faint_stroke_is_paper_between_sparse_grains() {
    let side = &sides()[0];
    let spot = Spot::new(side, 0.0, 0.0, &[0.0, 1.0, 0.0, 0.0, 0.0]);
    let (bare, silver) = (side.surface.albedo, spot.cover.grains);
    let found = |albedo: DVec3| {
        let surface = Surface {
            albedo,
            ..side.surface
        };
        let (bare, body) = (side.study.bare, side.media.body_albedo);
        borne_out(&surface, &side.mean, bare, body, &spot.cover)
    };
    for share in [0.0, 0.1, 0.5, 1.0] {
        let borne = found(bare.lerp(silver, share));
        assert!((borne - share).abs() < 1e-6, "{share}: {borne}");
    }
    // Lighter than the paper is no silver, and darker than silver is all of it.
    assert_eq!(found(DVec3::ONE), 0.0);
    assert_eq!(found(0.5 * silver), 1.0);
    let left = with_borne(&spot.cover, 0.25);
    assert!((left.particles - 0.25).abs() < 1e-12 && left.film == 0.0);
    // Ink keeps its own area when there is more paper around it.
    let inked = with_borne(&Spot::new(side, 0.5, 0.0, &[0.5]).cover, 0.5);
    assert!((inked.film - 0.5 / 0.75).abs() < 1e-12, "{inked:?}");
    // Where nothing is stated nothing is in question.
    let none = Spot::new(side, 0.0, 0.0, &[]).cover;
    let (bare, body) = (side.study.bare, side.media.body_albedo);
    assert_eq!(borne_out(&side.surface, &side.mean, bare, body, &none), 1.0);
}
