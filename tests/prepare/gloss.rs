//! Roughness from photographs of places whose normal nobody knows.

use glam::{DVec2, DVec3};
use rand::{RngExt as _, SeedableRng, rngs::Xoshiro256PlusPlus};
use recto::{
    optics::medium::{Matter, Medium},
    prepare::{
        gloss::{Place, fit},
        lights,
        model::Model,
        stereo::Rig,
    },
};

use super::made::{Lies, Media, PAPER, medium};

/// Of a roughness.
const OFF: f64 = 0.04;
const PLACES: usize = 120;
/// Of white.
const NOISE: f64 = 5e-4;

fn rig(elevations: [f64; 2]) -> Rig {
    let lamps = (0..8).map(|i| {
        let elevation = elevations[i % 2];
        lights::direction(45.0 * i as f64 + 10.0, elevation)
    });
    Rig::far(lamps.collect())
}

fn model() -> Model {
    Model::laid(DVec3::new(0.72, 0.67, 0.57)).expect("laid paper")
}

/// Iron-gall ink of some roughness.
fn ink(alpha: f64) -> Medium {
    let mut medium = *medium("iron-gall-ink").medium();
    let Matter::Film(film) = &mut medium.matter else {
        unreachable!("a film")
    };
    film.roughness = alpha;
    medium
}

/// Places of ink of this roughness with slopes of this size, `wrong` of them in a cast shadow or a
/// speck under one lamp.
fn places(rig: &Rig, alpha: f64, slope: f64, wrong: f64) -> Vec<Place> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
    let model = model();
    let mut spot = model.spot(Some(&ink(alpha)));
    let mut places = Vec::new();
    for i in 0..PLACES {
        let mut between = |bound: f64| (2.0 * random.random::<f64>() - 1.0) * bound;
        let normal = DVec3::new(between(slope), between(slope), 1.0).normalize();
        let albedo = DVec3::new(0.10, 0.075, 0.06) * (1.0 + between(0.3));
        spot.set_albedo(albedo);
        let at = DVec2::new(i as f64 + 0.5, 0.5);
        let mut shown: Vec<DVec3> = (0..rig.count())
            .map(|k| {
                let lit = rig.lamp(k, at);
                let noise = DVec3::new(between(NOISE), between(NOISE), between(NOISE));
                spot.shown(normal, lit.l) * lit.gain + 1.7 * noise
            })
            .collect();
        let fate = between(1.0);
        if fate.abs() < wrong {
            let k = i % rig.count();
            shown[k] *= if fate < 0.0 { 0.1 } else { 4.0 };
        }
        places.push(Place {
            at,
            shown,
            // As stereo leaves them, off by a degree or two.
            normal: (normal + DVec3::new(between(0.03), between(0.03), 0.0)).normalize(),
            albedo: albedo * (1.0 + between(0.05)),
        });
    }
    places
}

#[test]
fn roughness_is_found_again() {
    let rig = rig([34.0, 58.0]);
    let name = medium("iron-gall-ink");
    for (alpha, wrong) in [(0.2, 0.0), (0.35, 0.15), (0.55, 0.0)] {
        let places = places(&rig, alpha, 0.12, wrong);
        let (found, amendment) = fit(&model(), Some(name), Some(name.medium()), &places, &rig);
        eprintln!("{alpha}: {found:?}");
        let within = found.within.expect("a bound");
        assert!((found.alpha - alpha).abs() < OFF, "{alpha}: {found:?}");
        assert!(within < 0.1, "{found:?}");
        assert!(found.residual < 0.05, "{found:?}");
        assert!(amendment.is_some());
    }
}

/// Ink at all strengths, as the optics' own specimens show it, whose normals stereo has turned by
/// ten degrees: its roughness, and its albedo.
#[test]
fn deep_ink_is_found_from_normals_that_are_wrong() {
    let rig = rig([34.0, 58.0]);
    let media = Media::new();
    let model = Model::laid(DVec3::splat(PAPER)).expect("laid paper");
    let mut random = Xoshiro256PlusPlus::seed_from_u64(8);
    let mut truth = Vec::new();
    let places: Vec<Place> = (0..PLACES)
        .map(|i| {
            let mut between = |bound: f64| (2.0 * random.random::<f64>() - 1.0) * bound;
            let lies = Lies::Ink(0.75 + between(0.3));
            let slope = [between(0.15), between(0.15)];
            let normal = DVec3::new(slope[0], slope[1], 1.0).normalize();
            let at = DVec2::new(i as f64 + 0.5, 0.5);
            let shown = (0..rig.count()).map(|k| {
                let lit = rig.lamp(k, at);
                let noise = DVec3::new(between(NOISE), between(NOISE), between(NOISE));
                media.shown(lies, normal, lit.l) * lit.gain + 1.7 * noise
            });
            let shown = shown.collect();
            truth.push(media.albedo(lies));
            let turned = DVec3::new(slope[0] + between(0.2), slope[1] + between(0.2), 1.0);
            Place {
                at,
                shown,
                normal: turned.normalize(),
                albedo: media.albedo(lies) + between(0.02),
            }
        })
        .collect();
    let name = medium("iron-gall-ink");
    let (found, amendment) = fit(&model, Some(name), Some(name.medium()), &places, &rig);
    let amendment = amendment.expect("an amendment");
    let (mut before, mut after, mut bias) = (0.0, 0.0, 0.0);
    for (place, truth) in places.iter().zip(&truth) {
        before += (place.albedo.y - truth.y).abs() / PLACES as f64;
        let amended = amendment.apply(place.albedo, place.normal).y;
        after += (amended - truth.y).abs() / PLACES as f64;
        bias += (amended - truth.y) / PLACES as f64;
    }
    eprintln!("{found:?} albedo off by {before:.5}, {after:.5}, on the whole {bias:.5}");
    assert!(
        found.within.is_some() && (found.alpha - 0.35).abs() < OFF,
        "{found:?}"
    );
    assert!(bias.abs() < 0.002, "{bias}");
}

#[test]
fn lamps_of_one_height_over_an_even_surface_say_nothing() {
    let rig = rig([45.0, 45.0]);
    let name = medium("iron-gall-ink");
    let places = places(&rig, 0.2, 0.0, 0.0);
    let (found, _) = fit(&model(), Some(name), Some(name.medium()), &places, &rig);
    // Assumed, and said to be.
    assert_eq!(found.within, None, "{found:?}");
    assert_eq!(found.alpha, name.medium().roughness());
    // As are too few places.
    let (found, _) = fit(
        &model(),
        Some(name),
        Some(name.medium()),
        &places[..20],
        &rig,
    );
    assert_eq!(found.within, None);
    let (found, _) = fit(&model(), None, None, &[], &rig);
    assert_eq!((found.within, found.places), (None, 0));
}
