//! The maps of a side, each decoded and filtered by what it means.

use std::{
    ops::RangeInclusive,
    path::Path,
    sync::atomic::{AtomicBool, Ordering},
};

use half::f16;

use super::{
    ColourEncoding, MapError, NormalY, Placed, Pyramid, Texels, Warp,
    decode::{self, Raster, Samples},
    linear::Linear,
    pyramid::{self, Texel},
    warp::{self, Beyond},
};

/// Values that count as inside 0…1. ICC profiles round the nine numbers of their matrix to
/// 1/65536 each, and those of the most widespread sRGB profile (HP, 1998) add up to a white of
/// 1.0003; far below what can be seen, but half floats would then be coarser everywhere.
const INSIDE: RangeInclusive<f32> = -1e-4..=1.001;

/// Loads a map of colour as linear sRGB with alpha 1 (an alpha channel of the file is ignored,
/// and divided out where it multiplies the colours), averaged in linear light. 16-bit texels where every value lies in 0…1, else half floats, so
/// that colours outside sRGB keep their negative components; beyond ±65504 they are clamped.
///
/// # Errors
/// As [`super::verify`].
pub fn load_colour<'f>(
    file: impl Into<Placed<'f>>,
    encoding: ColourEncoding,
) -> Result<Pyramid, MapError> {
    let Placed { path, warp } = file.into();
    let raster = decode(path)?;
    let linear = Linear::new(path, &raster, encoding)?;
    let row = |y: usize, out: &mut [[f32; 4]]| linear.row(y, out);
    let opaque = |[r, g, b, _]: [f32; 4]| [r, g, b, 1.0];
    let pyramid = in_gamut(warp, &raster, row, opaque, Beyond::Edge);
    Ok(finish(&raster, pyramid))
}

/// Reads a map of colour as [`load_colour`] does, without levels and without narrowing: gives each
/// row, from the top, to `each` as linear sRGB; the fourth channel means nothing.
///
/// # Errors
/// As [`super::verify`].
pub fn for_each_colour_row<'f>(
    file: impl Into<Placed<'f>>,
    encoding: ColourEncoding,
    mut each: impl FnMut(usize, &[[f32; 4]]),
) -> Result<(), MapError> {
    let Placed { path, warp } = file.into();
    let raster = decode(path)?;
    let linear = Linear::new(path, &raster, encoding)?;
    if let Some(warp) = warp {
        let row = |y: usize, out: &mut [[f32; 4]]| linear.row(y, out);
        let texels = warp.resampled(raster.size(), row, Beyond::Edge);
        let rows = texels.chunks(warp.size()[0] as usize).enumerate();
        rows.for_each(|(y, row)| each(y, row));
        return Ok(());
    }
    let mut row = vec![[0.0; 4]; raster.width];
    for y in 0..raster.height {
        linear.row(y, &mut row);
        each(y, &row);
    }
    Ok(())
}

/// Loads a picture to lay over a side: linear sRGB multiplied by its alpha; otherwise as
/// [`load_colour`].
///
/// # Errors
/// As [`super::verify`].
pub fn load_overlay_picture<'f>(
    file: impl Into<Placed<'f>>,
    encoding: ColourEncoding,
) -> Result<Pyramid, MapError> {
    let Placed { path, warp } = file.into();
    let raster = decode(path)?;
    let linear = Linear::new(path, &raster, encoding)?;
    let row = |y: usize, out: &mut [[f32; 4]]| {
        linear.row(y, out);
        for pixel in out {
            let alpha = pixel[3].clamp(0.0, 1.0);
            *pixel = [pixel[0] * alpha, pixel[1] * alpha, pixel[2] * alpha, alpha];
        }
    };
    let pyramid = in_gamut(warp, &raster, row, |pixel| pixel, Beyond::Nothing);
    Ok(finish(&raster, pyramid))
}

/// 16-bit texels where every value lies in 0…1, else half floats.
fn in_gamut(
    warp: Option<&Warp>,
    raster: &Raster,
    row: impl Fn(usize, &mut [[f32; 4]]) + Sync,
    paint: impl Fn([f32; 4]) -> [f32; 4] + Sync,
    beyond: Beyond,
) -> Pyramid {
    let outside = AtomicBool::new(false);
    let watched = |y: usize, out: &mut [[f32; 4]]| {
        row(y, out);
        if !out.as_flattened().iter().all(|v| INSIDE.contains(v)) {
            outside.store(true, Ordering::Relaxed);
        }
    };
    let pyramid = warp::build::<u16, 4, 4>(warp, raster.size(), watched, &paint, beyond);
    if !outside.into_inner() {
        return pyramid;
    }
    drop(pyramid);
    warp::build::<f16, 4, 4>(warp, raster.size(), row, paint, beyond)
}

/// Loads a normal map as the x (right), y (up) and z (out) of unit normals, in 16 bits, with 1 as
/// a fourth channel. Smaller levels hold the means of the vectors as they are, shorter than 1:
/// what they lost is the spread of the normals under a texel (`optics::relief`). Integer files
/// code −1…1 around their middle code (128 or 32768 is exactly 0), float files hold the
/// components themselves. Normals without length, or that face away from the viewer, are flat.
/// [`normal_coding`] says how the texels are to be read.
///
/// # Errors
/// As [`super::verify`], and [`MapError::Unsupported`] for fewer than 3 channels.
pub fn load_normal<'f>(file: impl Into<Placed<'f>>, y: NormalY) -> Result<Pyramid, MapError> {
    let Placed { path, warp } = file.into();
    let raster = decode(path)?;
    if raster.channels < 3 {
        return Err(MapError::unsupported(
            path,
            format!("has {} of the 3 channels of a normal map", raster.channels),
            "name a normal map, or declare this file as height",
        ));
    }
    let up = if y == NormalY::Up { 1.0 } else { -1.0 };
    let pyramid = match raster.samples {
        Samples::U8(_) => normals(warp, &raster, up, Coding::of_codes(255.0, 128.0)),
        Samples::U16(_) => normals(warp, &raster, up, Coding::of_codes(65535.0, 32768.0)),
        Samples::F32(_) => normals(
            warp,
            &raster,
            up,
            Coding {
                scale: 1.0,
                offset: 0.0,
            },
        ),
    };
    Ok(finish(&raster, pyramid))
}

/// How a component of a normal follows from what a shader reads: `scale · stored + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coding {
    pub scale: f64,
    pub offset: f64,
}

impl Coding {
    /// The middle code is 0 and the highest 1; the lowest is just below −1 and clamped.
    fn of_codes(top: f64, middle: f64) -> Self {
        Self {
            scale: top / (top - middle),
            offset: -middle / (top - middle),
        }
    }

    fn decode(self, stored: f32) -> f32 {
        (self.scale * f64::from(stored) + self.offset).max(-1.0) as f32
    }

    fn encode(self, component: f32) -> f32 {
        ((f64::from(component) - self.offset) / self.scale) as f32
    }
}

/// How the texels of [`load_normal`] are coded.
pub fn normal_coding(texels: &Texels) -> Coding {
    match texels {
        Texels::Unorm8(_) => Coding::of_codes(255.0, 128.0),
        Texels::Unorm16(_) => Coding::of_codes(65535.0, 32768.0),
        Texels::Half(_) => Coding {
            scale: 1.0,
            offset: 0.0,
        },
    }
}

fn normals(warp: Option<&Warp>, raster: &Raster, up: f32, file: Coding) -> Pyramid {
    let row = |y: usize, out: &mut [[f32; 3]]| {
        raster.for_each_in_row(y, |x, [nx, ny, nz, _]| {
            let [nx, ny, nz] = [nx, ny, nz].map(|v| file.decode(v));
            out[x] = unit([nx, ny * up, nz]);
        });
    };
    let Some(warp) = warp else {
        return pack_normals(raster.size(), row);
    };
    let mut texels = warp.resampled(raster.size(), row, Beyond::Edge);
    warp.turn(&mut texels);
    let size = warp.size().map(|n| n as usize);
    pack_normals(size, |y, out: &mut [[f32; 3]]| {
        out.copy_from_slice(&texels[y * size[0]..(y + 1) * size[0]]);
    })
}

/// The chain of a picture of unit normals, coded as [`normal_coding`] says.
pub(super) fn pack_normals(
    size: [usize; 2],
    row: impl Fn(usize, &mut [[f32; 3]]) + Sync,
) -> Pyramid {
    // Three channels are no format of graphics cards; 8 bits cannot tell a mean that is shorter
    // by less than 1/256, which is a spread of 7°.
    let texels = Coding::of_codes(65535.0, 32768.0);
    pyramid::build::<u16, 3, 4>(size, row, |[x, y, z]| {
        [texels.encode(x), texels.encode(y), texels.encode(z), 1.0]
    })
}

/// The unit vector along a normal; flat where it has no length or no front.
fn unit([x, y, z]: [f32; 3]) -> [f32; 3] {
    /// Shorter ones are noise around an undefined direction.
    const SHORTEST: f32 = 0.1;
    let length = (x * x + y * y + z * z).sqrt();
    if length > SHORTEST && length.is_finite() && z > 0.0 {
        [x / length, y / length, z / length]
    } else {
        [0.0, 0.0, 1.0]
    }
}

/// Loads a map of heights, or of any other quantity over a declared range: its first channel as
/// 0…1 of that range, 16 bits. Floats outside are clamped.
///
/// # Errors
/// As [`super::verify`].
pub fn load_height<'f>(file: impl Into<Placed<'f>>) -> Result<Pyramid, MapError> {
    let Placed { path, warp } = file.into();
    let raster = decode(path)?;
    Ok(finish(&raster, scalar::<u16>(warp, &raster, |v, _| v)))
}

/// Loads a map of roughness, 0 smooth to 1 rough, from its first channel; where `gloss`, from a
/// map in which white is smooth. 8 bits for files of 8 bits, else 16.
///
/// # Errors
/// As [`super::verify`].
pub fn load_roughness<'f>(file: impl Into<Placed<'f>>, gloss: bool) -> Result<Pyramid, MapError> {
    let Placed { path, warp } = file.into();
    let raster = decode(path)?;
    let value = |v: f32, _| if gloss { 1.0 - v } else { v };
    let pyramid = match raster.samples {
        Samples::U8(_) => scalar::<u8>(warp, &raster, value),
        _ => scalar::<u16>(warp, &raster, value),
    };
    Ok(finish(&raster, pyramid))
}

/// Loads an outline: how much of each texel is sheet, 8 bits, from the first channel (white is
/// sheet) times alpha.
///
/// # Errors
/// As [`super::verify`].
pub fn load_outline(path: &Path) -> Result<Pyramid, MapError> {
    let raster = decode(path)?;
    Ok(finish(
        &raster,
        scalar::<u8>(None, &raster, |v, alpha| v * alpha),
    ))
}

/// One channel from the first channel and alpha of each pixel, both within 0…1.
fn scalar<T: Texel>(
    warp: Option<&Warp>,
    raster: &Raster,
    value: impl Fn(f32, f32) -> f32 + Sync,
) -> Pyramid {
    let row = |y: usize, out: &mut [[f32; 1]]| {
        raster.for_each_in_row(y, |x, pixel| {
            let alpha = raster.alpha(pixel);
            out[x] = [value(pixel[0].clamp(0.0, 1.0), alpha)];
        });
    };
    warp::build::<T, 1, 1>(warp, raster.size(), row, |mean| mean, Beyond::Edge)
}

/// A picture whose colours do not depend on its alpha, whichever way its file stores them.
pub(super) fn decode(path: &Path) -> Result<Raster, MapError> {
    let mut raster = decode::read(path)?;
    raster.unmultiply();
    Ok(raster)
}

pub(super) fn finish(raster: &Raster, pyramid: Pyramid) -> Pyramid {
    Pyramid {
        missing: raster.missing.count,
        ..pyramid
    }
}
