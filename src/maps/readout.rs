//! What a map's file says at one place.

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
    sync::Arc,
};

use glam::DVec2;

use super::{
    ColourEncoding, MapError, Placed,
    decode::Raster,
    legend::{find, for_each_colour},
    linear::Linear,
    load::decode,
};

/// Files that were decoded to be read at places, each once.
#[derive(Default)]
pub struct Rasters(HashMap<PathBuf, Arc<Raster>>);

impl Rasters {
    fn decoded(&mut self, path: &Path) -> Result<Arc<Raster>, MapError> {
        if let Some(held) = self.0.get(path) {
            return Ok(held.clone());
        }
        let raster = Arc::new(decode(path)?);
        self.0.insert(path.to_owned(), raster.clone());
        Ok(raster)
    }
}

/// A place in a file's pixels, `None` beyond its edges.
fn place(file: Placed<'_>, raster: &Raster, uv: DVec2) -> Option<DVec2> {
    let [width, height] = raster.size().map(|n| n as f64);
    let size = DVec2::new(width, height);
    let px = file
        .warp
        .map_or_else(|| uv * size, |warp| warp.px_from_uv(uv));
    (px.cmpge(DVec2::ZERO).all() && px.cmple(size).all()).then_some(px)
}

/// Quantities that may be averaged, linear between the middles of the four pixels around a place.
fn between<const C: usize>(
    raster: &Raster,
    px: DVec2,
    row: impl Fn(usize, &mut [[f32; C]]),
) -> [f64; C] {
    let [width, height] = raster.size();
    let most = DVec2::new(width as f64, height as f64) - 1.0;
    let px = (px - 0.5).clamp(DVec2::ZERO, most);
    let part = px.fract();
    let (x, y) = (px.x as usize, px.y as usize);
    let mut values = [0.0; C];
    let mut pixels = vec![[0.0; C]; width];
    for (y, share) in [(y, 1.0 - part.y), ((y + 1).min(height - 1), part.y)] {
        row(y, &mut pixels);
        let (left, right) = (pixels[x], pixels[(x + 1).min(width - 1)]);
        for (i, value) in values.iter_mut().enumerate() {
            let [left, right] = [left[i], right[i]].map(f64::from);
            *value += share * (left + (right - left) * part.x);
        }
    }
    values
}

/// Linear sRGB and alpha at texture coordinates of a picture, as [`super::load_overlay_picture`]
/// reads it but not multiplied by alpha; `None` where it shows nothing.
///
/// # Errors
/// As [`super::verify`].
pub fn colour_at<'f>(
    rasters: &mut Rasters,
    file: impl Into<Placed<'f>>,
    encoding: ColourEncoding,
    uv: DVec2,
) -> Result<Option<[f64; 3]>, MapError> {
    let file = file.into();
    let raster = rasters.decoded(file.path)?;
    let linear = Linear::new(file.path, &raster, encoding)?;
    let Some(px) = place(file, &raster, uv) else {
        return Ok(None);
    };
    let [r, g, b, alpha] = between(&raster, px, |y, out: &mut [[f32; 4]]| {
        linear.row(y, out);
        for pixel in out {
            let alpha = pixel[3].clamp(0.0, 1.0);
            *pixel = [pixel[0] * alpha, pixel[1] * alpha, pixel[2] * alpha, alpha];
        }
    });
    Ok((alpha > 0.0).then(|| [r, g, b].map(|v| v / alpha)))
}

/// A quantity over a declared range at texture coordinates, 0…1 of that range, as
/// [`super::load_overlay_continuous`] reads it; `None` where there is none.
///
/// # Errors
/// As [`super::verify`].
pub fn value_at<'f>(
    rasters: &mut Rasters,
    file: impl Into<Placed<'f>>,
    uv: DVec2,
) -> Result<Option<f64>, MapError> {
    let file = file.into();
    let raster = rasters.decoded(file.path)?;
    let Some(px) = place(file, &raster, uv) else {
        return Ok(None);
    };
    let [value, alpha] = between(&raster, px, |y, out: &mut [[f32; 2]]| {
        raster.for_each_in_row(y, |x, pixel| {
            let alpha = raster.alpha(pixel);
            out[x] = [pixel[0].clamp(0.0, 1.0) * alpha, alpha];
        });
    });
    Ok((alpha > 0.0).then(|| value / alpha))
}

/// Which colour of a legend the pixel at texture coordinates has, as
/// [`super::load_overlay_categorical`] reads it.
///
/// # Errors
/// As [`super::verify`].
pub fn category_at<'f>(
    rasters: &mut Rasters,
    file: impl Into<Placed<'f>>,
    legend: &[[u8; 3]],
    uv: DVec2,
) -> Result<Option<usize>, MapError> {
    let file = file.into();
    let raster = rasters.decoded(file.path)?;
    let Some(px) = place(file, &raster, uv) else {
        return Ok(None);
    };
    let (column, row) = (px.x as usize, px.y as usize);
    let column = column.min(raster.width - 1);
    let mut found = None;
    let mut last = None;
    for_each_colour(&raster, row.min(raster.height - 1), |x, colour| {
        if x == column {
            found = colour.and_then(|colour| find(legend, colour, &mut last));
        }
    });
    Ok(found)
}
