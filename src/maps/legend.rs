//! Pictures whose colours or values stand for something: media, overlays.

use std::{collections::HashMap, path::Path};

use rayon::prelude::*;

use super::{
    ColourMapName, MapError, Missing, Placed, Pyramid,
    decode::{self, Raster, Samples},
    load::{decode, finish},
    pyramid,
    warp::{self, Beyond},
};
use crate::colour;

/// The most media that one file can hold: the channels of a texture.
pub const MAX_WEIGHTS: usize = 4;

/// 8-bit sRGB colours, and how many pixels have each.
pub type ColourCounts = Vec<([u8; 3], u64)>;

/// A map read by a legend.
#[derive(Clone, Debug, PartialEq)]
pub struct LegendMap {
    pub pyramid: Pyramid,
    /// Colours of the picture (8-bit sRGB) that the legend does not name, and how many pixels
    /// have each, the commonest first. Transparent pixels are not counted.
    pub unlisted: ColourCounts,
}

/// Loads a map of media whose colours a legend names: one channel of coverage for each colour in
/// the legend's order, 8 bits, so that filtering blends amounts and never names; unused channels
/// are 0. A pixel of any other colour, or transparent, has none of them.
///
/// # Errors
/// As [`super::verify`], and [`MapError::Unsupported`] for a legend of 0 or more than
/// [`MAX_WEIGHTS`] colours.
pub fn load_media_legend(path: &Path, legend: &[[u8; 3]]) -> Result<LegendMap, MapError> {
    check_weights(path, "colours in its legend", legend.len())?;
    let raster = decode(path)?;
    let row = |y: usize, out: &mut [[f32; 4]]| {
        let mut last = None;
        for_each_colour(&raster, y, |x, colour| {
            out[x] = [0.0; 4];
            if let Some(i) = colour.and_then(|colour| find(legend, colour, &mut last)) {
                out[x][i] = 1.0;
            }
        });
    };
    let pyramid = weights::<u8>(&raster, legend.len(), row);
    Ok(LegendMap {
        pyramid: finish(&raster, pyramid),
        unlisted: unlisted(&raster, legend),
    })
}

/// Decodes a picture that a legend reads, which finds damaged ones, and discards it. Returns
/// the pixels that are missing, and what [`LegendMap::unlisted`] says.
///
/// # Errors
/// As [`super::verify`].
pub fn verify_legend(path: &Path, legend: &[[u8; 3]]) -> Result<(Missing, ColourCounts), MapError> {
    let raster = decode(path)?;
    let unlisted = unlisted(&raster, legend);
    Ok((raster.missing, unlisted))
}

/// Loads a map of media whose first `count` channels are the coverage of one medium each; unused
/// channels are 0. 8 bits for files of 8 bits, else 16.
///
/// # Errors
/// As [`super::verify`], and [`MapError::Unsupported`] where the file has fewer channels or
/// `count` is 0 or more than [`MAX_WEIGHTS`].
pub fn load_media_weights(path: &Path, count: usize) -> Result<Pyramid, MapError> {
    check_weights(path, "media", count)?;
    // Every channel is an amount of its own, a fourth one too: none multiplies the others.
    let raster = decode::read(path)?;
    if raster.channels < count {
        return Err(MapError::unsupported(
            path,
            format!("has {} channels for {count} media", raster.channels),
            "give each medium a channel of its own",
        ));
    }
    let row = |y: usize, out: &mut [[f32; 4]]| {
        raster.for_each_in_row(y, |x, pixel| out[x] = pixel.map(|v| v.clamp(0.0, 1.0)));
    };
    let pyramid = match raster.samples {
        Samples::U8(_) => weights::<u8>(&raster, count, row),
        _ => weights::<u16>(&raster, count, row),
    };
    Ok(finish(&raster, pyramid))
}

pub(super) fn check_weights(path: &Path, what: &str, count: usize) -> Result<(), MapError> {
    if (1..=MAX_WEIGHTS).contains(&count) {
        return Ok(());
    }
    Err(MapError::unsupported(
        path,
        format!("is declared with {count} {what}, and 1 to {MAX_WEIGHTS} are allowed"),
        "split it into several files",
    ))
}

/// The first `count` of four quantities in 1, 2 or 4 channels.
fn weights<T: pyramid::Texel>(
    raster: &Raster,
    count: usize,
    row: impl Fn(usize, &mut [[f32; 4]]) + Sync,
) -> Pyramid {
    let size = raster.size();
    match count {
        1 => pyramid::build::<T, 4, 1>(size, row, |[a, ..]| [a]),
        2 => pyramid::build::<T, 4, 2>(size, row, |[a, b, ..]| [a, b]),
        3 => pyramid::build::<T, 4, 4>(size, row, |[a, b, c, _]| [a, b, c, 0.0]),
        _ => pyramid::build::<T, 4, 4>(size, row, |all| all),
    }
}

/// Loads a categorical overlay: the colours of the legend as linear sRGB multiplied by their
/// coverage, and that coverage as alpha, 16 bits; transparent elsewhere.
///
/// # Errors
/// As [`super::verify`].
pub fn load_overlay_categorical<'f>(
    file: impl Into<Placed<'f>>,
    legend: &[[u8; 3]],
) -> Result<LegendMap, MapError> {
    let Placed { path, warp } = file.into();
    let raster = decode(path)?;
    let texel = |&entry: &[u8; 3]| {
        let [r, g, b] = colour::linear_from_srgb8(entry).map(|v| v as f32);
        [r, g, b, 1.0]
    };
    let texels: Vec<[f32; 4]> = legend.iter().map(texel).collect();
    let row = |y: usize, out: &mut [[f32; 4]]| {
        let mut last = None;
        for_each_colour(&raster, y, |x, colour| {
            let entry = colour.and_then(|colour| find(legend, colour, &mut last));
            out[x] = entry.map_or([0.0; 4], |i| texels[i]);
        });
    };
    let size = raster.size();
    let pyramid = warp::build::<u16, 4, 4>(warp, size, row, |pixel| pixel, Beyond::Nothing);
    Ok(LegendMap {
        pyramid: finish(&raster, pyramid),
        unlisted: unlisted(&raster, legend),
    })
}

/// Loads a continuous overlay: the first channel (0…1 of the declared range; floats outside are
/// clamped) through a colour map, as linear sRGB multiplied by the file's alpha, 16 bits. Values
/// are filtered before they are coloured, so every colour is one of the map's.
///
/// # Errors
/// As [`super::verify`].
pub fn load_overlay_continuous<'f>(
    file: impl Into<Placed<'f>>,
    map: ColourMapName,
) -> Result<Pyramid, MapError> {
    let Placed { path, warp } = file.into();
    /// Finer than 8 bits can tell apart.
    const STEPS: usize = 4096;
    let step = |i| map.colour(i as f64 / STEPS as f64).map(|v| v as f32);
    let table: Vec<[f32; 3]> = (0..=STEPS).map(step).collect();
    let raster = decode(path)?;
    let row = |y: usize, out: &mut [[f32; 2]]| {
        raster.for_each_in_row(y, |x, pixel| {
            let alpha = raster.alpha(pixel);
            out[x] = [pixel[0].clamp(0.0, 1.0) * alpha, alpha];
        });
    };
    let paint = |[value, alpha]: [f32; 2]| {
        if alpha <= 0.0 {
            return [0.0; 4];
        }
        let place = (value / alpha).clamp(0.0, 1.0) * STEPS as f32;
        let [r, g, b] = table[place.round() as usize];
        [r * alpha, g * alpha, b * alpha, alpha]
    };
    let size = raster.size();
    let pyramid = warp::build::<u16, 2, 4>(warp, size, row, paint, Beyond::Nothing);
    Ok(finish(&raster, pyramid))
}

/// Calls `each` with the 8-bit colour of every pixel of a row, `None` where it is transparent.
pub(super) fn for_each_colour(
    raster: &Raster,
    y: usize,
    mut each: impl FnMut(usize, Option<[u8; 3]>),
) {
    raster.for_each_in_row(y, |x, pixel| {
        let visible = raster.alpha(pixel) >= 0.5;
        let [r, g, b, _] = pixel.map(|v| (v * 255.0 + 0.5) as u8);
        let colour = if raster.channels >= 3 {
            [r, g, b]
        } else {
            [r, r, r]
        };
        each(x, visible.then_some(colour));
    });
}

/// Where a colour stands in the legend. Neighbours are mostly alike: `last` remembers.
pub(super) fn find(
    legend: &[[u8; 3]],
    colour: [u8; 3],
    last: &mut Option<([u8; 3], Option<usize>)>,
) -> Option<usize> {
    match *last {
        Some((seen, place)) if seen == colour => place,
        _ => {
            let place = legend.iter().position(|&entry| entry == colour);
            *last = Some((colour, place));
            place
        }
    }
}

fn unlisted(raster: &Raster, legend: &[[u8; 3]]) -> ColourCounts {
    let add = |mut counts: HashMap<[u8; 3], u64>, (colour, run): ([u8; 3], u64)| {
        if !legend.contains(&colour) {
            *counts.entry(colour).or_default() += run;
        }
        counts
    };
    let count_row = |counts: HashMap<_, _>, y: usize| {
        let mut counts = counts;
        let mut run: Option<([u8; 3], u64)> = None;
        for_each_colour(raster, y, |_, colour| match (&mut run, colour) {
            (Some((seen, length)), Some(colour)) if *seen == colour => *length += 1,
            (_, next) => {
                if let Some(done) = run.take() {
                    counts = add(std::mem::take(&mut counts), done);
                }
                run = next.map(|colour| (colour, 1));
            }
        });
        match run {
            Some(done) => add(counts, done),
            None => counts,
        }
    };
    let counts = (0..raster.height)
        .into_par_iter()
        .fold(HashMap::new, count_row)
        .reduce(HashMap::new, |mut all, some| {
            for (colour, count) in some {
                *all.entry(colour).or_default() += count;
            }
            all
        });
    let mut counts: Vec<_> = counts.into_iter().collect();
    // By colour where equally common, so that the order is always the same.
    counts.sort_unstable_by_key(|&(colour, count)| (std::cmp::Reverse(count), colour));
    counts
}
