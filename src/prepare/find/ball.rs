//! A glossy ball that is looked for in its photographs: coarsely in all of each, then closely around it.

use std::path::{Path, PathBuf};

use glam::DVec2;
use rayon::prelude::*;

use super::whole;
use crate::{
    maps::ColourEncoding,
    prepare::{
        PrepareError,
        capture::{Circle, Crop},
        lights::ball,
        reduced::{Reduced, step_to},
    },
};

/// The radius of the ball, in pixels, in the pictures that its outline is measured in: a tenth of
/// a pixel there is 0.03° of a lamp.
const FINE_RADIUS: f64 = 400.0;
/// Half the side of what is looked at closer around a small one, in radii.
const CLOSE: f64 = 1.8;
/// How much of the surroundings the finest pictures show, in radii.
const AROUND: f64 = 0.25;

/// The outline of the one ball in these photographs, in their pixels.
///
/// # Errors
/// [`PrepareError::NoBall`], and of the first photograph that cannot be read.
pub(super) fn outline(
    photographs: &[PathBuf],
    encoding: ColourEncoding,
    scratch: &Path,
) -> Result<Circle, PrepareError> {
    let first = photographs.first().cloned().unwrap_or_default();
    let size = crate::maps::probe(&first)?.size;
    let refused = |why| PrepareError::NoBall {
        path: first.clone(),
        why,
    };
    let [width, height] = size.map(|v| v as usize);
    let step = step_to(ball::COARSE_PX, [width, height]);
    let read = |crop: Crop, step: usize| -> Result<(Vec<Vec<f32>>, [usize; 2]), PrepareError> {
        let read = |path: &PathBuf| Reduced::read(path, encoding, crop, step, scratch);
        let small: Result<Vec<Reduced>, _> = photographs.par_iter().map(read).collect();
        let small = small?;
        let size = small.first().map_or([0, 0], |small| small.size);
        Ok((small.par_iter().map(Reduced::grey).collect(), size))
    };
    let (pictures, small) = read(whole(size), step)?;
    let found = ball::find(&pictures, small).map_err(|why| refused(why.scaled(step as f64)))?;
    drop(pictures);
    let mut found = ball::scaled(found, step as f64);
    let crop = |circle: Circle, reach: f64| -> (Crop, DVec2) {
        let low = (circle.centre - reach).max(DVec2::ZERO).floor();
        let high = circle.centre + reach;
        let crop = Crop {
            left: low.x as u32,
            top: low.y as u32,
            right: (high.x.ceil() as u32).min(size[0]),
            bottom: (high.y.ceil() as u32).min(size[1]),
        };
        (crop, low)
    };
    if step > 1 && found.radius < ball::CLEAR_RADIUS * step as f64 {
        // A small one, once more from nearer.
        let (crop, corner) = crop(found, CLOSE * found.radius);
        let step = ((found.radius / (2.0 * ball::CLEAR_RADIUS)) as usize).max(1);
        let (pictures, close) = read(crop, step)?;
        let seen = ball::find(&pictures, close)
            .map_err(|why| refused(why.scaled(step as f64).moved(corner)))?;
        found = ball::moved(ball::scaled(seen, step as f64), corner);
    }
    // The same at the scale of the edge.
    let (crop, corner) = crop(found, found.radius * (1.0 + AROUND));
    let step = ((found.radius / FINE_RADIUS) as usize).max(1);
    let (pictures, fine) = read(crop, step)?;
    let around = ball::scaled(ball::moved(found, -corner), (step as f64).recip());
    let refined = ball::refine(&pictures, fine, around)
        .ok_or_else(|| refused(ball::NoBall::Ragged(found)))?;
    let circle = ball::moved(ball::scaled(refined, step as f64), corner);
    let low = circle.centre - circle.radius;
    let high = circle.centre + circle.radius;
    let inside = low.min_element() >= 0.0 && high.x <= width as f64 && high.y <= height as f64;
    match inside {
        true => Ok(circle),
        false => Err(refused(ball::NoBall::Outside(circle))),
    }
}
