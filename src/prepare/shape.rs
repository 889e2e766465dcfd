//! Normals of a side → its shape at large, written as soon as it is known, and grain and strokes.

use rayon::prelude::*;

use super::{
    PrepareError,
    capture::{Capture, Integration},
    relief::{
        compare::{Comparison, range, remove_plane},
        filter::{Coarse, Split, split},
        integrate::{Perimeter, Slopes, integrate, integrate_level, integrate_robust},
        real::Real,
        surface,
    },
    write::SideFiles,
};
use crate::manifest::SideName;

/// The whole of a range.
const WHOLE: [f64; 2] = [0.0, 1.0];

/// What a side's normals are parted into.
pub(super) struct Shaped {
    /// Unit normals of grain and strokes.
    pub small: Vec<[f32; 3]>,
    /// Their slopes.
    pub slopes: Slopes,
    /// Lowest and highest place of the shape at large in µm.
    pub um: [f64; 2],
    /// How it differs from the other surface that the capture names, in µm.
    pub compared: Option<Comparison>,
    /// The lines of a manifest about it.
    pub text: String,
}

/// Parts unit normals, in rows of `width`, and writes the shape at large.
///
/// # Errors
/// Where the other surface cannot be read, or a map cannot be written.
pub(super) fn shape(
    capture: &Capture,
    side: SideName,
    maps: &SideFiles<'_>,
    normals: Vec<[f32; 3]>,
    width: usize,
) -> Result<Shaped, PrepareError> {
    let sigma_px = (capture.relief.split_mm / capture.mm_per_px).max(0.5);
    let Split { large, small } = split(normals, width, sigma_px, capture.relief.filter);
    let Coarse {
        vectors,
        width: across,
        step,
    } = large;
    let mm = capture.mm_per_px * step as f64;
    let slopes = Slopes::of_normals(&vectors, across);
    drop(vectors);
    let mut shape = heights(slopes, mm * 1000.0, capture.relief.integrate);
    if let Some(known) = capture.relief.known_range_um {
        let [low, high] = range(&shape, WHOLE).unwrap_or_default();
        if high > low {
            shape.iter_mut().for_each(|h| *h *= known / (high - low));
        }
    }
    let um = range(&shape, WHOLE).unwrap_or_default();
    let compared = match (&capture.compare, side) {
        (Some(other), SideName::Recto) => surface::compared(&shape, across, mm, other)?,
        _ => None,
    };
    let text = maps.shape(&shape, across, um)?;
    drop(shape);
    Ok(Shaped {
        slopes: Slopes::of_normals(&small, width),
        small,
        um,
        compared,
        text,
    })
}

/// Heights of grain and strokes in µm by their slopes, and the lowest and highest of them.
pub(super) fn grain(slopes: Slopes, um_per_px: f64) -> (Vec<f32>, [f64; 2]) {
    let heights = level(slopes, um_per_px);
    let um = range(&heights, WHOLE).unwrap_or_default();
    (heights, um)
}

/// Heights in µm of slopes, their mean plane taken out.
fn level<T: Real>(slopes: Slopes, um_per_px: f64) -> Vec<T> {
    let width = slopes.width;
    // Its plane would be taken out again.
    let mut heights = integrate_level(slopes, um_per_px);
    remove_plane(&mut heights, width);
    heights
}

/// Heights in µm of slopes. Their mean plane is taken out, unless the perimeter lies at 0.
fn heights(slopes: Slopes, um_per_px: f64, how: Integration) -> Vec<f64> {
    /// The error of a slope that is still usual, half a degree: what stereo is off by where its
    /// photographs agree.
    const USUAL: f64 = 0.01;
    let width = slopes.width;
    let mut heights = match how {
        Integration::Free => return level(slopes, um_per_px),
        Integration::Anchored => integrate(&slopes, Perimeter::Anchored),
        Integration::Robust => integrate_robust(&slopes, USUAL),
    };
    if how != Integration::Anchored {
        remove_plane(&mut heights, width);
    }
    heights.par_iter_mut().for_each(|h| *h *= um_per_px);
    heights
}
