//! A picture bent into its place: resampled where it is loaded, so that afterwards it lies on the
//! sheet as one does that was never bent.

use std::path::{Path, PathBuf};

use glam::{DAffine2, DMat2, DVec2};
use rayon::prelude::*;

use super::{
    MAX_SIDE,
    pyramid::{self, Texel},
    registration::{RegistrationError, plate::Plate},
};

/// A picture file, and what bends it into its place.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'f> {
    pub path: &'f Path,
    pub warp: Option<&'f Warp>,
}

impl<'f> From<&'f Path> for Placed<'f> {
    fn from(path: &'f Path) -> Self {
        Self { path, warp: None }
    }
}

impl<'f> From<&'f PathBuf> for Placed<'f> {
    fn from(path: &'f PathBuf) -> Self {
        path.as_path().into()
    }
}

/// Fields along each side of the rectangle where the picture is looked for,
const SEARCH: usize = 64;
/// and how often it is looked for in what was found before: a picture is found that is a millionth
/// of the sheet.
const SEARCHES: usize = 4;
/// A search that narrows the rectangle to more than this share of it is the last.
const NARROWER: f64 = 0.75;
/// Texels between places where the spline itself is evaluated. It hardly bends over so few: a bend
/// of 5 pixels over 600 departs from its chords by less than a hundredth of a pixel.
const STEP: usize = 8;
/// How many times more texels than pixels there are at most: a sheet is not filled by what a small
/// picture of it never showed.
const MOST_GROWTH: f64 = 4.0;

/// What lies beyond the edges of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Beyond {
    /// It goes on as it ends.
    Edge,
    /// Nothing: all quantities are 0.
    Nothing,
}

/// A thin plate as a way to resample one picture: onto an upright rectangle of the side, as fine as
/// the picture is.
#[derive(Clone, Debug, PartialEq)]
pub struct Warp {
    plate: Plate,
    /// Upper left corner of the rectangle and its size, in the side frame in mm.
    corner_mm: DVec2,
    extent_mm: DVec2,
    size: [u32; 2],
}

/// What a bent picture covers of a sheet.
struct Covered {
    /// Upper left corner of an upright rectangle around it, and its size.
    corner_mm: DVec2,
    extent_mm: DVec2,
    /// Pixels of the picture in a square mm, in the mean.
    px2_per_mm2: f64,
}

impl Covered {
    fn find(plate: &Plate, pixels: DVec2, sheet_mm: DVec2) -> Option<Self> {
        let (mut low, mut high) = (DVec2::ZERO, sheet_mm);
        for _ in 0..SEARCHES {
            let [from, to] = Self::narrowed(plate, pixels, low, high)?;
            let is_last = (to - from).cmpge((high - low) * NARROWER).all();
            (low, high) = (from, to);
            if is_last {
                break;
            }
        }
        let places = Self::places(low, high);
        let is_inside = |mm: &DVec2| {
            let px = plate.px_at(*mm);
            px.cmpge(DVec2::ZERO).all() && px.cmple(pixels).all()
        };
        let densities: Vec<f64> = places
            .into_par_iter()
            .filter(is_inside)
            .map(|mm| plate.jacobian_at(mm).determinant().abs())
            .collect();
        (!densities.is_empty()).then(|| Self {
            corner_mm: low,
            extent_mm: high - low,
            px2_per_mm2: densities.iter().sum::<f64>() / densities.len() as f64,
        })
    }

    /// Corners of the fields of a rectangle, in rows.
    fn places(low: DVec2, high: DVec2) -> Vec<DVec2> {
        let field = (high - low) / SEARCH as f64;
        let corner = |i: usize| DVec2::new((i % (SEARCH + 1)) as f64, (i / (SEARCH + 1)) as f64);
        let corners = (0..(SEARCH + 1) * (SEARCH + 1)).map(corner);
        corners.map(|corner| low + corner * field).collect()
    }

    /// The rectangle around those fields of a rectangle that may hold something of the picture.
    fn narrowed(plate: &Plate, pixels: DVec2, low: DVec2, high: DVec2) -> Option<[DVec2; 2]> {
        let places = Self::places(low, high);
        let px: Vec<DVec2> = places.par_iter().map(|mm| plate.px_at(*mm)).collect();
        let mut found: Option<[DVec2; 2]> = None;
        for i in 0..SEARCH * SEARCH {
            let first = i / SEARCH * (SEARCH + 1) + i % SEARCH;
            let last = first + SEARCH + 2;
            let corners = [first, first + 1, last - 1, last].map(|i| px[i]);
            let least = corners.into_iter().fold(DVec2::INFINITY, DVec2::min);
            let most = corners.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max);
            // Between its corners a field bends.
            let bend = (most - least) / 4.0;
            if (most + bend).cmpge(DVec2::ZERO).all() && (least - bend).cmple(pixels).all() {
                let [from, to] = found.unwrap_or([places[first], places[last]]);
                found = Some([from.min(places[first]), to.max(places[last])]);
            }
        }
        found
    }
}

impl Warp {
    /// Of a picture of `pixels` on a side of `sheet_mm`: onto what it covers of the sheet.
    ///
    /// # Errors
    /// [`RegistrationError::Beside`] where it covers nothing of it, and
    /// [`RegistrationError::Folded`] where it does and the plate folds.
    pub(super) fn new(
        plate: Plate,
        pixels: [u32; 2],
        sheet_mm: DVec2,
    ) -> Result<Self, RegistrationError> {
        let pixels = pixels.map(f64::from);
        let found = Covered::find(&plate, DVec2::from(pixels), sheet_mm);
        let Covered {
            corner_mm,
            extent_mm,
            px2_per_mm2,
        } = found.ok_or(RegistrationError::Beside)?;
        plate.refuse_folds(corner_mm, extent_mm)?;
        let wanted = extent_mm * px2_per_mm2.sqrt();
        let most = pixels[0] * pixels[1] * MOST_GROWTH;
        let shrink = (most / (wanted.x * wanted.y))
            .sqrt()
            .min(f64::from(MAX_SIDE) / wanted.max_element())
            .min(1.0);
        let size = (wanted * shrink).round().max(DVec2::ONE);
        Ok(Self {
            plate,
            corner_mm,
            extent_mm,
            size: [size.x as u32, size.y as u32],
        })
    }

    /// From the side frame in mm to texture coordinates of the resampled picture.
    pub fn uv_from_side(&self) -> DAffine2 {
        DAffine2::from_scale(self.extent_mm.recip()) * DAffine2::from_translation(-self.corner_mm)
    }

    /// Width and height of the resampled picture.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Where texture coordinates of the resampled picture lie in the file, in pixels.
    pub fn px_from_uv(&self, uv: DVec2) -> DVec2 {
        self.plate.px_at(self.corner_mm + uv * self.extent_mm)
    }

    fn texel_mm(&self) -> DVec2 {
        self.extent_mm / DVec2::new(self.size[0].into(), self.size[1].into())
    }

    /// Where the middles of texels lie in the file.
    fn lattice(&self) -> Lattice {
        let [columns, rows] = self.size.map(|n| n as usize / STEP + 2);
        let texel = self.texel_mm();
        let places = (0..rows * columns)
            .into_par_iter()
            .map(|i| {
                let at = DVec2::new((i % columns) as f64, (i / columns) as f64) * STEP as f64;
                self.plate.px_at(self.corner_mm + (at + 0.5) * texel)
            })
            .collect();
        Lattice { columns, places }
    }

    /// Every texel of what `row` gives of a picture of `from` pixels: quantities that may be
    /// averaged, linear between the middles of pixels.
    pub(super) fn resampled<const C: usize>(
        &self,
        from: [usize; 2],
        row: impl Fn(usize, &mut [[f32; C]]) + Sync,
        beyond: Beyond,
    ) -> Vec<[f32; C]> {
        let [width, height] = from;
        let mut file = vec![[0.0; C]; width * height];
        file.par_chunks_mut(width)
            .enumerate()
            .for_each(|(y, out)| row(y, out));
        let lattice = self.lattice();
        let size = DVec2::new(width as f64, height as f64);
        let at = |px: DVec2| -> [f32; C] {
            let is_beyond = px.cmplt(DVec2::ZERO).any() || px.cmpgt(size).any();
            if is_beyond && beyond == Beyond::Nothing {
                return [0.0; C];
            }
            let px = (px - 0.5).clamp(DVec2::ZERO, size - 1.0);
            let (x, y) = (px.x as usize, px.y as usize);
            let (x_1, y_1) = ((x + 1).min(width - 1), (y + 1).min(height - 1));
            let part = px.fract().as_vec2();
            let [a, b] = [file[y * width + x], file[y * width + x_1]];
            let [c, d] = [file[y_1 * width + x], file[y_1 * width + x_1]];
            std::array::from_fn(|i| {
                let top = a[i] + (b[i] - a[i]) * part.x;
                let bottom = c[i] + (d[i] - c[i]) * part.x;
                top + (bottom - top) * part.y
            })
        };
        let across = self.size[0] as usize;
        let mut texels = vec![[0.0; C]; across * self.size[1] as usize];
        texels
            .par_chunks_mut(across)
            .enumerate()
            .for_each(|(y, out)| {
                for (x, texel) in out.iter_mut().enumerate() {
                    *texel = at(lattice.at([x, y]));
                }
            });
        texels
    }

    /// Turns vectors that lie in the picture as (right, up, out) with it: into the same of the
    /// sheet. Their length stays.
    pub(super) fn turn(&self, vectors: &mut [[f32; 3]]) {
        let lattice = self.lattice();
        let texel = self.texel_mm();
        let across = self.size[0] as usize;
        vectors
            .par_chunks_mut(across)
            .enumerate()
            .for_each(|(y, row)| {
                for (x, vector) in row.iter_mut().enumerate() {
                    let [right, up] = lattice.axes([x, y], texel);
                    let [a, b] = [f64::from(vector[0]), f64::from(vector[1])];
                    let turned = right * a + up * b;
                    // The picture's axes need not be square to each other once it is bent.
                    let kept = a.hypot(b);
                    let turned = turned.normalize_or_zero() * kept;
                    *vector = [turned.x as f32, turned.y as f32, vector[2]];
                }
            });
    }
}

/// Places in a file, every [`STEP`] texels.
struct Lattice {
    columns: usize,
    places: Vec<DVec2>,
}

impl Lattice {
    fn corners(&self, [x, y]: [usize; 2]) -> ([DVec2; 4], DVec2) {
        let i = (y / STEP) * self.columns + x / STEP;
        let part = DVec2::new((x % STEP) as f64, (y % STEP) as f64) / STEP as f64;
        let below = i + self.columns;
        let corners = [i, i + 1, below, below + 1].map(|i| self.places[i]);
        (corners, part)
    }

    fn at(&self, texel: [usize; 2]) -> DVec2 {
        let ([a, b, c, d], part) = self.corners(texel);
        let top = a + (b - a) * part.x;
        let bottom = c + (d - c) * part.x;
        top + (bottom - top) * part.y
    }

    /// Unit directions on the sheet (x right, y up) of the picture's right and up.
    fn axes(&self, texel: [usize; 2], texel_mm: DVec2) -> [DVec2; 2] {
        let ([a, b, c, d], part) = self.corners(texel);
        let along = (b - a) + (d - c - b + a) * part.y;
        let down = (c - a) + (d - b - c + a) * part.x;
        let px_from_mm = DMat2::from_cols(along / texel_mm.x, down / texel_mm.y);
        let mm_from_px = px_from_mm.inverse();
        let up = |v: DVec2| DVec2::new(v.x, -v.y).normalize_or(DVec2::X);
        [up(mm_from_px.x_axis), up(-mm_from_px.y_axis)]
    }
}

/// [`pyramid::build`] of a picture of `size` once it is bent into its place.
pub(super) fn build<T: Texel, const C: usize, const N: usize>(
    warp: Option<&Warp>,
    size: [usize; 2],
    row: impl Fn(usize, &mut [[f32; C]]) + Sync,
    paint: impl Fn([f32; C]) -> [f32; N] + Sync,
    beyond: Beyond,
) -> pyramid::Pyramid {
    let Some(warp) = warp else {
        return pyramid::build::<T, C, N>(size, row, paint);
    };
    let texels = warp.resampled(size, row, beyond);
    of_texels::<T, C, N>(warp, &texels, paint)
}

/// [`pyramid::build`] of texels that a warp has resampled.
pub(super) fn of_texels<T: Texel, const C: usize, const N: usize>(
    warp: &Warp,
    texels: &[[f32; C]],
    paint: impl Fn([f32; C]) -> [f32; N] + Sync,
) -> pyramid::Pyramid {
    let size = warp.size.map(|n| n as usize);
    let row = |y: usize, out: &mut [[f32; C]]| {
        out.copy_from_slice(&texels[y * size[0]..(y + 1) * size[0]]);
    };
    pyramid::build::<T, C, N>(size, row, paint)
}
