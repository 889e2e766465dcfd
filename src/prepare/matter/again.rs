//! Places whose surface is not paper's, solved again: stereo took every surface for paper's, and
//! ink's narrower gleam, of which most of its light is, turned its normals towards the lamps. Now
//! that its roughness is known, the study tier itself is fitted to each of its places.

use std::path::Path;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::Bench;
use crate::{
    optics::medium::Medium,
    prepare::{
        PrepareError,
        codes::{encoded, linear},
        gloss::{Place, Settler},
        model::Model,
        photographs::Stack,
    },
};

/// Maps of a side.
pub struct Maps<'m> {
    /// sRGB-encoded.
    pub albedo: &'m mut [[u16; 3]],
    pub normals: &'m mut [[f32; 3]],
}

/// Reads the photographs once more, and replaces normal and albedo of each place that is of a
/// class with a medium in `glossy`.
///
/// # Errors
/// Of the first photograph that cannot be read now.
pub fn solve(
    bench: &Bench<'_>,
    scratch: &Path,
    model: &Model,
    glossy: &[Option<Medium>],
    classes: &[u8],
    maps: Maps<'_>,
) -> Result<(), PrepareError> {
    if glossy.iter().all(Option::is_none) {
        return Ok(());
    }
    let settlers: Vec<Option<Settler<'_>>> = glossy
        .iter()
        .map(|medium| medium.as_ref().map(|medium| Settler::new(model, medium)))
        .collect();
    let shots = bench.shots;
    let ambient = shots.ambient.as_deref();
    let encoding = bench.capture.encoding;
    let mut stack = Stack::open(&shots.photographs, ambient, encoding, shots.crop, scratch)?;
    stack.divide(bench.fields);
    while let Some(band) = stack.next()? {
        let start = band.top * band.width;
        let range = start..start + band.rows * band.width;
        let of_band = &classes[range.clone()];
        let here = |class: &u8| {
            settlers
                .get(usize::from(*class))
                .is_some_and(Option::is_some)
        };
        if !of_band.iter().any(here) {
            stack.recycle(band);
            continue;
        }
        let settlers = &settlers;
        let places = maps.albedo[range.clone()].par_iter_mut();
        let places = places
            .zip(&mut maps.normals[range])
            .zip(of_band)
            .enumerate();
        places.for_each_init(
            || settlers.clone(),
            |settlers, (i, ((rgb, normal), class))| {
                let settler = settlers
                    .get_mut(usize::from(*class))
                    .and_then(Option::as_mut);
                let Some(settler) = settler else {
                    return;
                };
                let (x, y) = (i % band.width, band.top + i / band.width);
                let shown = band
                    .planes
                    .iter()
                    .map(|planes| bench.colour(planes.each_ref().map(|plane| plane[i])));
                let place = Place {
                    at: DVec2::new(x as f64 + 0.5, y as f64 + 0.5),
                    shown: shown.collect(),
                    normal: DVec3::from(normal.map(f64::from)).normalize_or(DVec3::Z),
                    albedo: linear(*rgb),
                };
                let (found, albedo) = settler.settle(&place, bench.rig);
                *normal = found.as_vec3().into();
                *rgb = encoded(albedo);
            },
        );
        stack.recycle(band);
    }
    Ok(())
}
