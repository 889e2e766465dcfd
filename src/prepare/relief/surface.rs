//! The sheet's shape as a mesh, and another mesh or picture of it read as heights.

use std::path::Path;

use glam::DVec2;
use rayon::prelude::*;

use super::compare::{Comparison, PATCHES_MM, of_difference};
use crate::{
    manifest::surface::SideSurface,
    maps::{
        self, MapError,
        surface::{Model, load_gltf, save_gltf},
    },
    prepare::capture::OtherSurface,
};

/// The file of the mesh.
pub const MESH: &str = "shape.glb";
/// µm in a mm.
const UM_PER_MM: f64 = 1000.0;

/// Heights over a sheet, in rows of `width` from its upper left corner, NaN where there are none.
struct Heights<'h> {
    um: &'h [f64],
    width: usize,
}

impl Heights<'_> {
    /// Between the pixels, at a place in shares of the sheet's size; at its edges the slope goes on.
    fn at(&self, uv: DVec2) -> f64 {
        let height = self.um.len() / self.width;
        let between = |at: f64, count: usize| {
            let place = at * count as f64 - 0.5;
            let first = (place.max(0.0) as usize).min(count.saturating_sub(2));
            (first, (first + 1).min(count - 1), place - first as f64)
        };
        let (left, right, u) = between(uv.x, self.width);
        let (above, below, v) = between(uv.y, height);
        let along = |y: usize| {
            let [a, b] = [left, right].map(|x| self.um[y * self.width + x]);
            a + (b - a) * u
        };
        let (top, bottom) = (along(above), along(below));
        top + (bottom - top) * v
    }
}

/// Writes the mesh of heights in µm over a sheet of `size_mm` into `folder`: in mm, x right, y up,
/// z out of the sheet, the origin in its middle, with as many triangles as the shape needs and
/// [`SideSurface`] allows, as `surface.gltf` of a manifest takes it.
///
/// # Errors
/// [`MapError::Write`].
pub fn save(um: &[f64], width: usize, size_mm: DVec2, folder: &Path) -> Result<(), MapError> {
    let heights = Heights { um, width };
    let mesh = SideSurface::curled(size_mm, |at| heights.at(at / size_mm) / UM_PER_MM);
    let model = Model {
        uvs: mesh.side.iter().map(|at| *at / size_mm).collect(),
        positions: mesh.positions,
        indices: mesh.indices,
    };
    save_gltf(&folder.join(MESH), &model, &mesh.normals)
}

/// Heights in µm of another surface of the same sheet, in the middles of `width` × `height` cells
/// of it; NaN where it has none.
///
/// # Errors
/// Of its file.
pub fn heights(other: &OtherSurface, [width, height]: [usize; 2]) -> Result<Vec<f64>, MapError> {
    let Some([low, high]) = other.range_um else {
        return Ok(rasterised(&load_gltf(&other.path)?, [width, height]));
    };
    let pyramid = maps::load_height(other.path.as_path())?;
    let level = &pyramid.levels[0];
    let count = level.width as usize * level.height as usize;
    let value = |i: usize| f64::from(level.texels.get(i).unwrap_or_default());
    let um: Vec<f64> = (0..count).map(|i| low + (high - low) * value(i)).collect();
    let heights = Heights {
        um: &um,
        width: level.width as usize,
    };
    let at = |i: usize| heights.at(middle(i, [width, height]));
    Ok((0..width * height).into_par_iter().map(at).collect())
}

fn middle(i: usize, [width, height]: [usize; 2]) -> DVec2 {
    let at = DVec2::new((i % width) as f64, (i / width) as f64) + 0.5;
    at / DVec2::new(width as f64, height as f64)
}

/// Of each cell's middle, the highest triangle's height.
fn rasterised(model: &Model, [width, height]: [usize; 2]) -> Vec<f64> {
    let mut um = vec![f64::NAN; width * height];
    let cells = DVec2::new(width as f64, height as f64);
    for triangle in model.indices.chunks_exact(3) {
        let corners = [0, 1, 2].map(|k| triangle[k] as usize);
        let places = corners.map(|i| model.uvs[i] * cells - 0.5);
        let heights = corners.map(|i| model.positions[i].z * UM_PER_MM);
        let [a, b, c] = places;
        let area = (b - a).perp_dot(c - a);
        if area.is_nan() || area == 0.0 {
            continue;
        }
        let low = a.min(b).min(c).max(DVec2::ZERO).ceil();
        let high = a.max(b).max(c).min(cells - 1.0).floor();
        let mut y = low.y;
        while y <= high.y {
            let mut x = low.x;
            while x <= high.x {
                let at = DVec2::new(x, y);
                let t = [
                    (b - at).perp_dot(c - at) / area,
                    (c - at).perp_dot(a - at) / area,
                    (a - at).perp_dot(b - at) / area,
                ];
                if t.iter().all(|t| *t >= -1e-9) {
                    let z = (0..3).map(|k| t[k] * heights[k]).sum();
                    let cell = &mut um[y as usize * width + x as usize];
                    *cell = cell.max(z);
                }
                x += 1.0;
            }
            y += 1.0;
        }
    }
    um
}

/// How heights in µm, in rows of `width` cells of `mm_per_cell`, differ from another surface of
/// the same sheet. `None` where that covers too little of it.
///
/// # Errors
/// Of its file.
pub fn compared(
    um: &[f64],
    width: usize,
    mm_per_cell: f64,
    other: &OtherSurface,
) -> Result<Option<Comparison>, MapError> {
    // In their place: they take as much memory as `um`.
    let mut off = heights(other, [width, um.len() / width.max(1)])?;
    let places = off.par_iter_mut().zip(um);
    places.for_each(|(off, um)| *off = um - *off);
    Ok(of_difference(off, width, mm_per_cell, &PATCHES_MM))
}
