//! Normals from the slopes of a height map, for sides that have no normal map of their own.

use glam::DVec2;
use rayon::prelude::*;

use super::{
    MapError, Placed, Pyramid,
    load::{decode, finish, pack_normals},
    warp::Beyond,
};

/// Micrometres in a millimetre.
const UM_PER_MM: f64 = 1000.0;

/// Loads a height map as the normals of its relief, coded as [`super::load_normal`] codes them:
/// 16 bits. `range_um` are the heights of black and white in µm, `extent_mm` the size of the
/// picture on the sheet in mm. Slopes are central differences, one-sided at the border.
///
/// # Errors
/// As [`super::verify`].
pub fn load_normal_from_height<'f>(
    file: impl Into<Placed<'f>>,
    range_um: [f64; 2],
    extent_mm: DVec2,
) -> Result<Pyramid, MapError> {
    let Placed { path, warp } = file.into();
    let raster = decode(path)?;
    let row = |y: usize, out: &mut [[f32; 1]]| {
        raster.for_each_in_row(y, |x, pixel| out[x] = [pixel[0].clamp(0.0, 1.0)]);
    };
    // What is bent is bent before its slopes are taken.
    let ([width, height], heights) = match warp {
        Some(warp) => {
            let heights = warp.resampled(raster.size(), row, Beyond::Edge);
            (warp.size().map(|n| n as usize), heights)
        }
        None => {
            let [width, height] = raster.size();
            let mut heights = vec![[0.0f32]; width * height];
            heights
                .par_chunks_mut(width)
                .enumerate()
                .for_each(|(y, out)| row(y, out));
            ([width, height], heights)
        }
    };
    let span_mm = (range_um[1] - range_um[0]) / UM_PER_MM;
    let texel_mm = extent_mm / DVec2::new(width as f64, height as f64);
    let slope = |low: usize, high: usize, steps: usize, texel: f64| {
        let rise = f64::from(heights[high][0]) - f64::from(heights[low][0]);
        if steps == 0 {
            0.0
        } else {
            rise * span_mm / (steps as f64 * texel)
        }
    };
    let row = |y: usize, out: &mut [[f32; 3]]| {
        let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
        for (x, normal) in out.iter_mut().enumerate() {
            let (left, right) = (x.saturating_sub(1), (x + 1).min(width - 1));
            let along_x = slope(
                y * width + left,
                y * width + right,
                right - left,
                texel_mm.x,
            );
            // Rows run downwards, y of a normal upwards.
            let along_y = -slope(
                above * width + x,
                below * width + x,
                below - above,
                texel_mm.y,
            );
            let length = (along_x * along_x + along_y * along_y + 1.0).sqrt();
            *normal = [-along_x, -along_y, 1.0].map(|v| (v / length) as f32);
        }
    };
    Ok(finish(&raster, pack_normals([width, height], row)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maps::{Coding, encode::save_png_grey16, normal_coding};

    #[test]
    fn a_ramp_leans_against_its_rise() -> Result<(), Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("ramp.png");
        // Rises to the right and to the top by 1000 of 65535 a texel.
        let pixels: Vec<u16> = (0..64)
            .map(|i| 1000 * (i % 8) + 1000 * (7 - i / 8))
            .collect();
        save_png_grey16(&path, 8, 8, &pixels, None)?;
        // Texels of 0.1 mm; 1000 codes are 10 µm: a slope of 1 in 10.
        let pyramid = load_normal_from_height(&path, [0.0, 655.35], DVec2::splat(0.8))?;
        let Coding { scale, offset } = normal_coding(&pyramid.levels[0].texels);
        let expected = -0.1 / 1.02f64.sqrt();
        for i in 0..64 {
            for c in 0..2 {
                let stored = pyramid.levels[0]
                    .texels
                    .get(4 * i + c)
                    .map(f64::from)
                    .unwrap_or(f64::NAN);
                assert!(
                    (scale * stored + offset - expected).abs() < 1e-4,
                    "{i}: {stored}"
                );
            }
        }
        Ok(())
    }
}
