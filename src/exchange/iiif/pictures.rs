//! Maps of an exhibit → pictures that browsers show, each covering its side.

use std::{
    fs::{self, File},
    io::{self, Read as _},
    path::Path,
};

use glam::DVec2;

use super::Role;
use crate::{
    colour::{srgb_encode, srgb8_from_linear},
    exchange::ExchangeError,
    manifest::{ColourMap, MapFile, Overlay},
    maps::{
        self, ColourEncoding, Level, MapError, Pyramid,
        encode::{save_png_rgb8, save_png_rgb16, save_png_rgba8, write_whole},
    },
};

/// The longer side of a thumbnail at most.
const THUMBNAIL_PX: u32 = 400;
/// A picture that covers its side so well, as a share of it, covers it.
const COVERS: f64 = 1e-6;

/// The side that pictures are to cover.
#[derive(Clone, Copy)]
pub struct Frame<'f> {
    pub size_mm: DVec2,
    /// Of its canvas.
    pub size: [u32; 2],
    /// Where the manifest is.
    pub folder: &'f Path,
    /// `images/DRAWING/SIDE` within it.
    pub within: &'f str,
}

/// A picture that was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// Its path from the manifest's folder.
    pub path: String,
    /// Its media type.
    pub format: &'static str,
    pub size: [u32; 2],
}

/// What browsers show.
#[derive(Clone, Copy)]
enum Format {
    Png,
    Jpeg,
}

impl Format {
    fn of(path: &Path) -> Result<Option<Self>, ExchangeError> {
        let mut start = Vec::new();
        let read = File::open(path).and_then(|file| file.take(4).read_to_end(&mut start));
        read.map_err(|reason| unreadable(path, reason))?;
        Ok(match start.as_slice() {
            [0x89, b'P', b'N', b'G'] => Some(Self::Png),
            [0xff, 0xd8, 0xff, _] => Some(Self::Jpeg),
            _ => None,
        })
    }

    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Png => ("png", "image/png"),
            Self::Jpeg => ("jpg", "image/jpeg"),
        }
    }
}

fn unreadable(path: &Path, reason: io::Error) -> MapError {
    MapError::Read {
        path: path.to_owned(),
        reason,
    }
}

/// Writes a map of colour: as it is where browsers show it so, otherwise laid into its place, in
/// sRGB.
pub fn colour(map: &ColourMap, role: &Role, frame: Frame<'_>) -> Result<Written, ExchangeError> {
    let path = &map.file.path;
    let covers = covers(&map.file, frame.size_mm);
    // A browser goes by the embedded profile, and takes integers without one for sRGB.
    let as_declared = match map.encoding {
        ColourEncoding::Embedded => true,
        ColourEncoding::Srgb => !maps::probe(path)?.icc,
        ColourEncoding::Linear => false,
    };
    if let Some(format) = Format::of(path)?.filter(|_| covers && as_declared) {
        let (extension, format) = format.words();
        let target = target(role, extension, frame)?;
        let mut picture = File::open(path).map_err(|reason| unreadable(path, reason))?;
        write_whole(&frame.folder.join(&target), |file| {
            io::copy(&mut picture, file).map(|_| ())
        })?;
        return Ok(Written {
            path: target,
            format,
            size: map.file.size,
        });
    }
    let pyramid = maps::load_colour(&map.file, map.encoding)?;
    let placed = Placed::new(&pyramid, &map.file, frame);
    let pixels = placed.pixels(|[r, g, b, _]| {
        // Casts saturate.
        [r, g, b].map(|v| (srgb_encode(v.into()).clamp(0.0, 1.0) * 65535.0).round() as u16)
    });
    let target = target(role, "png", frame)?;
    let [width, height] = placed.size;
    save_png_rgb16(&frame.folder.join(&target), width, height, &pixels, None)?;
    Ok(Written {
        path: target,
        format: "image/png",
        size: placed.size,
    })
}

/// Writes an overlay as it is shown, transparent where it is nothing.
pub fn overlay(overlay: &Overlay, role: &Role, frame: Frame<'_>) -> Result<Written, ExchangeError> {
    let pyramid = overlay.load()?;
    let placed = Placed::new(&pyramid, &overlay.file, frame);
    let pixels = placed.pixels(|[r, g, b, a]| {
        let straight = [r, g, b].map(|v| if a > 0.0 { f64::from(v / a) } else { 0.0 });
        let [r, g, b] = srgb8_from_linear(straight);
        [r, g, b, (a.clamp(0.0, 1.0) * 255.0).round() as u8]
    });
    let target = target(role, "png", frame)?;
    let [width, height] = placed.size;
    save_png_rgba8(&frame.folder.join(&target), width, height, &pixels, None)?;
    Ok(Written {
        path: target,
        format: "image/png",
        size: placed.size,
    })
}

/// Writes a small picture of a map of colour.
pub fn thumbnail(map: &ColourMap, frame: Frame<'_>) -> Result<Written, ExchangeError> {
    let pyramid = maps::load_colour(&map.file, map.encoding)?;
    let small = |level: &&Level| level.width.max(level.height) <= THUMBNAIL_PX;
    // The last is of one pixel.
    let level = pyramid
        .levels
        .iter()
        .find(small)
        .unwrap_or(&pyramid.levels[0]);
    let count = level.width as usize * level.height as usize;
    let pixels: Vec<[u8; 3]> = (0..count)
        .map(|i| {
            let [r, g, b, _] = texel(level, i);
            srgb8_from_linear([r, g, b].map(f64::from))
        })
        .collect();
    let path = format!("{}/thumbnail.png", frame.within);
    make_folder(&frame.folder.join(&path))?;
    let (width, height) = (level.width, level.height);
    save_png_rgb8(&frame.folder.join(&path), width, height, &pixels, None)?;
    Ok(Written {
        path,
        format: "image/png",
        size: [width, height],
    })
}

/// The path of a picture from the manifest's folder; makes its own folder.
fn target(role: &Role, extension: &str, frame: Frame<'_>) -> Result<String, ExchangeError> {
    let path = format!("{}/{}.{extension}", frame.within, role.path());
    make_folder(&frame.folder.join(&path))?;
    Ok(path)
}

fn make_folder(file: &Path) -> Result<(), ExchangeError> {
    match file.parent() {
        Some(folder) => fs::create_dir_all(folder).map_err(ExchangeError::folder(folder)),
        None => Ok(()),
    }
}

/// Whether a picture just covers its side.
fn covers(file: &MapFile, size_mm: DVec2) -> bool {
    let corner = |mm: DVec2| file.uv_from_side.transform_point2(mm);
    let ends = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
    file.warp.is_none()
        && ends
            .iter()
            .all(|end| (corner(*end * size_mm) - *end).abs().max_element() < COVERS)
}

fn texel(level: &Level, i: usize) -> [f32; 4] {
    [0, 1, 2, 3].map(|c| level.texels.get(4 * i + c).unwrap_or_default())
}

/// A picture that is laid into its place.
struct Placed<'p> {
    level: &'p Level,
    file: &'p MapFile,
    frame: Frame<'p>,
    /// In pixels.
    size: [u32; 2],
    covers: bool,
}

impl<'p> Placed<'p> {
    /// `pyramid` has four channels.
    fn new(pyramid: &'p Pyramid, file: &'p MapFile, frame: Frame<'p>) -> Self {
        let level = &pyramid.levels[0];
        let covers = covers(file, frame.size_mm);
        Self {
            size: match covers {
                true => [level.width, level.height],
                false => frame.size,
            },
            level,
            file,
            frame,
            covers,
        }
    }

    /// Its pixels from the top left; nothing (0, 0, 0, 0) where the picture is not.
    fn pixels<T>(&self, paint: impl Fn([f32; 4]) -> T) -> Vec<T> {
        let [width, height] = self.size;
        let count = width as usize * height as usize;
        if self.covers {
            return (0..count).map(|i| paint(texel(self.level, i))).collect();
        }
        let places = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        places
            .map(|[x, y]| {
                let share = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)
                    / DVec2::new(width.into(), height.into());
                let uv = self
                    .file
                    .uv_from_side
                    .transform_point2(share * self.frame.size_mm);
                paint(self.at(uv))
            })
            .collect()
    }

    /// Linear between the middles of the four texels around a place.
    fn at(&self, uv: DVec2) -> [f32; 4] {
        if !(uv.cmpge(DVec2::ZERO).all() && uv.cmple(DVec2::ONE).all()) {
            return [0.0; 4];
        }
        let size = DVec2::new(self.level.width.into(), self.level.height.into());
        let px = (uv * size - 0.5).clamp(DVec2::ZERO, size - 1.0);
        let (x, y) = (px.x as usize, px.y as usize);
        let part = px.fract();
        let width = self.level.width as usize;
        let right = (x + 1).min(width - 1);
        let low = (y + 1).min(self.level.height as usize - 1);
        let mut sum = [0.0; 4];
        for (x, y, share) in [
            (x, y, (1.0 - part.x) * (1.0 - part.y)),
            (right, y, part.x * (1.0 - part.y)),
            (x, low, (1.0 - part.x) * part.y),
            (right, low, part.x * part.y),
        ] {
            for (sum, value) in sum.iter_mut().zip(texel(self.level, y * width + x)) {
                *sum += value * share as f32;
            }
        }
        sum
    }
}
