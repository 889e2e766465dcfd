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
/// How much of the surroundings these show, in radii.
const AROUND: f64 = 0.12;

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
    let found = ball::scaled(found, step as f64);
    // The same at the scale of the edge.
    let reach = found.radius * (1.0 + AROUND);
    let low = (found.centre - reach).max(DVec2::ZERO);
    let high = found.centre + reach;
    let crop = Crop {
        left: low.x as u32,
        top: low.y as u32,
        right: (high.x.ceil() as u32).min(size[0]),
        bottom: (high.y.ceil() as u32).min(size[1]),
    };
    let step = ((found.radius / FINE_RADIUS) as usize).max(1);
    let (pictures, fine) = read(crop, step)?;
    let corner = DVec2::new(f64::from(crop.left), f64::from(crop.top));
    let around = Circle {
        centre: (found.centre - corner) / step as f64,
        radius: found.radius / step as f64,
    };
    let refined = ball::refine(&pictures, fine, around)
        .ok_or_else(|| refused(ball::NoBall::Ragged(found)))?;
    let refined = ball::scaled(refined, step as f64);
    let circle = Circle {
        centre: refined.centre + corner,
        ..refined
    };
    let low = circle.centre - circle.radius;
    let high = circle.centre + circle.radius;
    let inside = low.min_element() >= 0.0 && high.x <= width as f64 && high.y <= height as f64;
    match inside {
        true => Ok(circle),
        false => Err(refused(ball::NoBall::Outside(circle))),
    }
}
