//! Pictures of one side in several bands of light, as one picture.

use glam::{DAffine2, DVec2};
use rayon::prelude::*;

use super::{
    ColourEncoding, ColourMapName, MapError, Placed, Pyramid, linear::Linear, load::decode,
    pyramid, warp::Beyond,
};
use crate::colour::luminance;

/// The colours of a difference of two bands, from less to more.
pub const DIVERGING: ColourMapName = ColourMapName::Diverging;

/// A picture of a side in one band of light.
#[derive(Clone, Copy, Debug)]
pub struct BandPicture<'f> {
    pub file: Placed<'f>,
    pub encoding: ColourEncoding,
    /// From the side's frame in mm to texture coordinates, once it is bent.
    pub uv_from_side: DAffine2,
}

/// Reflectance times coverage, and coverage, of each texel.
struct Reflectance {
    size: [usize; 2],
    texels: Vec<[f32; 2]>,
    missing: u64,
}

impl Reflectance {
    fn load(band: &BandPicture<'_>) -> Result<Self, MapError> {
        let Placed { path, warp } = band.file;
        let raster = decode(path)?;
        let linear = Linear::new(path, &raster, band.encoding)?;
        let row = |y: usize, out: &mut [[f32; 2]]| {
            let mut colours = vec![[0.0; 4]; out.len()];
            linear.row(y, &mut colours);
            for (texel, [r, g, b, alpha]) in out.iter_mut().zip(colours) {
                let light = luminance([r, g, b].map(f64::from)) as f32;
                let alpha = alpha.clamp(0.0, 1.0);
                // Nothing reflects less than nothing or more than all.
                *texel = [light.clamp(0.0, 1.0) * alpha, alpha];
            }
        };
        let missing = raster.missing.count;
        if let Some(warp) = warp {
            return Ok(Self {
                size: warp.size().map(|n| n as usize),
                texels: warp.resampled(raster.size(), row, Beyond::Nothing),
                missing,
            });
        }
        let size = raster.size();
        let mut texels = vec![[0.0; 2]; size[0] * size[1]];
        texels
            .par_chunks_mut(size[0])
            .enumerate()
            .for_each(|(y, out)| row(y, out));
        Ok(Self {
            size,
            texels,
            missing,
        })
    }

    /// Linear between the middles of texels, and nothing beyond the edge.
    fn at(&self, uv: DVec2) -> [f32; 2] {
        if uv.cmplt(DVec2::ZERO).any() || uv.cmpgt(DVec2::ONE).any() {
            return [0.0; 2];
        }
        let [width, height] = self.size;
        let size = DVec2::new(width as f64, height as f64);
        let px = (uv * size - 0.5).clamp(DVec2::ZERO, size - 1.0);
        let (x, y) = (px.x as usize, px.y as usize);
        let (x_1, y_1) = ((x + 1).min(width - 1), (y + 1).min(height - 1));
        let part = px.fract().as_vec2();
        let texel = |x: usize, y: usize| self.texels[y * width + x];
        let [a, b] = [texel(x, y), texel(x_1, y)];
        let [c, d] = [texel(x, y_1), texel(x_1, y_1)];
        std::array::from_fn(|i| {
            let top = a[i] + (b[i] - a[i]) * part.x;
            let bottom = c[i] + (d[i] - c[i]) * part.x;
            top + (bottom - top) * part.y
        })
    }
}

/// Of each texel its sums and its coverage; the size, and how many pixels were missing.
type Sums<const C: usize> = (Vec<([f32; C], f32)>, [usize; 2], u64);

/// Calls `add` with a row of sums, their coverage so far, and reflectance and coverage of each
/// band there; the texels are those of the first band.
fn sums<const C: usize>(
    bands: &[BandPicture<'_>],
    add: impl Fn(usize, &mut [f32; C], f32) + Sync,
) -> Result<Sums<C>, MapError> {
    let mut all: Vec<([f32; C], f32)> = Vec::new();
    let (mut size, mut missing) = ([1, 1], 0);
    for (k, band) in bands.iter().enumerate() {
        let found = Reflectance::load(band)?;
        missing += found.missing;
        if k == 0 {
            size = found.size;
            all = vec![([0.0; C], 1.0); size[0] * size[1]];
        }
        let alike = found.size == size && band.uv_from_side == bands[0].uv_from_side;
        let own_from_first = band.uv_from_side * bands[0].uv_from_side.inverse();
        let step = DVec2::new(size[0] as f64, size[1] as f64).recip();
        all.par_chunks_mut(size[0])
            .enumerate()
            .for_each(|(y, row)| {
                for (x, (sum, coverage)) in row.iter_mut().enumerate() {
                    let [value, alpha] = if alike {
                        found.texels[y * size[0] + x]
                    } else {
                        let uv = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) * step;
                        found.at(own_from_first.transform_point2(uv))
                    };
                    if alpha > 0.0 {
                        add(k, sum, value / alpha);
                    }
                    // Where one of them shows nothing, nothing is known of all.
                    *coverage = coverage.min(alpha);
                }
            });
    }
    Ok((all, size, missing))
}

/// Loads bands as one picture to lay over a side: red, green and blue are the sums of reflectance
/// times `weights`, those of each band in its order, within 0…1; linear sRGB multiplied by alpha,
/// 16 bits, with the texels of the first band. A band in colour counts by its luminance, and
/// where one of the bands shows nothing, nothing is.
///
/// # Errors
/// As [`super::verify`].
pub fn load_bands_as_colour(
    bands: &[BandPicture<'_>],
    weights: &[[f64; 3]],
) -> Result<Pyramid, MapError> {
    let weights: Vec<[f32; 3]> = weights.iter().map(|w| w.map(|w| w as f32)).collect();
    let add = |k: usize, sum: &mut [f32; 3], value: f32| {
        let weight = weights.get(k).copied().unwrap_or_default();
        for (sum, weight) in sum.iter_mut().zip(weight) {
            *sum += weight * value;
        }
    };
    let (all, size, missing) = sums::<3>(bands, add)?;
    let row = |y: usize, out: &mut [[f32; 4]]| {
        for (texel, (sum, alpha)) in out.iter_mut().zip(&all[y * size[0]..]) {
            let [r, g, b] = sum.map(|v| v.clamp(0.0, 1.0) * alpha);
            *texel = [r, g, b, *alpha];
        }
    };
    let pyramid = pyramid::build::<u16, 4, 4>(size, row, |pixel| pixel);
    Ok(Pyramid { missing, ..pyramid })
}

/// Loads the first of two bands less the second as a sign to lay over a side: `colours` from
/// −`full` to `full` of reflectance, multiplied by alpha, 16 bits, with the texels of the first.
/// Differences are filtered before they are coloured.
///
/// # Errors
/// As [`super::verify`].
pub fn load_bands_as_difference(
    bands: &[BandPicture<'_>],
    full: f64,
    colours: ColourMapName,
) -> Result<Pyramid, MapError> {
    /// Finer than 8 bits can tell apart.
    const STEPS: usize = 4096;
    let step = |i| colours.colour(i as f64 / STEPS as f64).map(|v| v as f32);
    let table: Vec<[f32; 3]> = (0..=STEPS).map(step).collect();
    let add = |k: usize, sum: &mut [f32; 1], value: f32| {
        sum[0] += if k == 0 { value } else { -value };
    };
    let (all, size, missing) = sums::<1>(bands, add)?;
    let row = |y: usize, out: &mut [[f32; 2]]| {
        for (texel, ([difference], alpha)) in out.iter_mut().zip(&all[y * size[0]..]) {
            *texel = [difference * alpha, *alpha];
        }
    };
    let full = full as f32;
    let paint = |[difference, alpha]: [f32; 2]| {
        if alpha <= 0.0 {
            return [0.0; 4];
        }
        let share = (0.5 + 0.5 * difference / (alpha * full)).clamp(0.0, 1.0);
        let [r, g, b] = table[(share * STEPS as f32).round() as usize];
        [r * alpha, g * alpha, b * alpha, alpha]
    };
    let pyramid = pyramid::build::<u16, 2, 4>(size, row, paint);
    Ok(Pyramid { missing, ..pyramid })
}
