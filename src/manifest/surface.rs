//! The sheet's shape: flat, curled by a height map, or modelled in a glTF file; and the same
//! shape seen from its other side. Every renderer takes it from here.

mod net;

use glam::{DVec2, DVec3};

use super::{
    exhibit::{FlipAxis, HeightMap, Surface},
    frames::other_side,
};
use crate::maps::{self, MapError};

/// Columns and rows of the finest quads of a curled sheet, a power of two. Where a curl is gentle its
/// triangles are larger: small ones cost a software driver more than the pixels in them.
const QUADS: usize = 128;
/// How far a triangle may lie from the finest ones, in mm: a tenth of a thin sheet.
const SAME_MM: f64 = 0.0125;
/// And its normals, in radians: 1% of the light at 10° above the sheet.
const SAME_NORMAL: f64 = 2e-3;
/// How far a flat sheet's mesh reaches beyond its edge, as a share of its size: room for the
/// smooth step that the shader draws there.
const MARGIN: f64 = 0.01;

/// One side's surface in its local frame (mm, x right, y up, z out of the side).
#[derive(Clone, Debug, PartialEq)]
pub struct SideSurface {
    pub positions: Vec<DVec3>,
    /// Place of each vertex in the side frame (mm, y down).
    pub side: Vec<DVec2>,
    pub normals: Vec<DVec3>,
    /// Unit vectors along growing x of the side frame.
    pub tangents: Vec<DVec3>,
    /// Triangles, anticlockwise as seen from outside.
    pub indices: Vec<u32>,
}

impl SideSurface {
    /// A flat sheet of `size_mm`.
    pub fn flat(size_mm: DVec2) -> Self {
        Self::grid(size_mm, 1, 1, MARGIN, |_| 0.0)
    }

    /// A sheet whose height in mm over each place of the side frame is `height`.
    pub fn curled(size_mm: DVec2, height: impl Fn(DVec2) -> f64) -> Self {
        Self::curled_within(SAME_MM, size_mm, height)
    }

    /// The same, whose triangles lie no farther than about `within_mm` from the finest.
    pub fn curled_within(within_mm: f64, size_mm: DVec2, height: impl Fn(DVec2) -> f64) -> Self {
        let fine = Self::grid(size_mm, QUADS, QUADS, 0.0, height);
        let off = |[a, b, m]: [usize; 3]| {
            let between = |of: &[DVec3]| of[a].midpoint(of[b]);
            let off = between(&fine.positions).distance(fine.positions[m]) / within_mm;
            let leaning = between(&fine.normals).normalize();
            off.max(leaning.angle_between(fine.normals[m]) / SAME_NORMAL)
        };
        let triangles = net::triangles(QUADS, off);
        fine.with_triangles(&triangles)
    }

    /// Of its vertices, those of some triangles.
    fn with_triangles(&self, triangles: &[[usize; 3]]) -> Self {
        let mut taken: Vec<Option<u32>> = vec![None; self.positions.len()];
        let mut some = Self {
            positions: Vec::new(),
            side: Vec::new(),
            normals: Vec::new(),
            tangents: Vec::new(),
            indices: Vec::new(),
        };
        for &vertex in triangles.iter().flatten() {
            let index = *taken[vertex].get_or_insert_with(|| {
                some.positions.push(self.positions[vertex]);
                some.side.push(self.side[vertex]);
                some.normals.push(self.normals[vertex]);
                some.tangents.push(self.tangents[vertex]);
                some.positions.len() as u32 - 1
            });
            some.indices.push(index);
        }
        some
    }

    /// The recto's surface of a sheet of `size_mm`.
    ///
    /// # Errors
    /// Of the file behind it.
    pub fn load(surface: &Surface, size_mm: DVec2) -> Result<Self, MapError> {
        match surface {
            Surface::Flat => Ok(Self::flat(size_mm)),
            Surface::Height(map) => curl(map, size_mm),
            Surface::Gltf(path) => {
                let model = maps::surface::load_gltf(path)?;
                let side = model.uvs.iter().map(|uv| *uv * size_mm).collect();
                Ok(Self::modelled(model.positions, side, model.indices))
            }
        }
    }

    fn grid(
        size_mm: DVec2,
        columns: usize,
        rows: usize,
        margin: f64,
        height: impl Fn(DVec2) -> f64,
    ) -> Self {
        let place = |i: usize, j: usize| {
            let uv = DVec2::new(i as f64 / columns as f64, j as f64 / rows as f64);
            size_mm * (uv * (1.0 + 2.0 * margin) - margin)
        };
        let mut surface = Self {
            positions: Vec::new(),
            side: Vec::new(),
            normals: Vec::new(),
            tangents: Vec::new(),
            indices: Vec::new(),
        };
        // Slopes by central differences over half a quad.
        let step = size_mm / DVec2::new(columns as f64, rows as f64) * 0.5;
        for j in 0..=rows {
            for i in 0..=columns {
                let at = place(i, j);
                let dx = DVec2::new(step.x, 0.0);
                let dy = DVec2::new(0.0, step.y);
                // Beside the sheet there is no height: at its edges, from within.
                let slope = |by: DVec2, step: f64| {
                    let [before, after] = [at - by, at + by].map(|p| p.clamp(DVec2::ZERO, size_mm));
                    let run = (after - before).dot(by) / step;
                    if run > 0.0 {
                        (height(after) - height(before)) / run
                    } else {
                        0.0
                    }
                };
                let slope_x = slope(dx, step.x);
                // The side frame counts y downwards.
                let slope_y = -slope(dy, step.y);
                surface.side.push(at);
                surface.positions.push(DVec3::new(
                    at.x - size_mm.x / 2.0,
                    size_mm.y / 2.0 - at.y,
                    height(at),
                ));
                surface
                    .normals
                    .push(DVec3::new(-slope_x, -slope_y, 1.0).normalize());
                surface
                    .tangents
                    .push(DVec3::new(1.0, 0.0, slope_x).normalize());
            }
        }
        for j in 0..rows {
            for i in 0..columns {
                let a = (j * (columns + 1) + i) as u32;
                let b = a + columns as u32 + 1;
                surface.indices.extend([a, b, a + 1, a + 1, b, b + 1]);
            }
        }
        surface
    }

    /// A modelled surface: positions in the recto's local frame, places in its side frame.
    /// Normals and tangents follow from the triangles.
    pub fn modelled(positions: Vec<DVec3>, side: Vec<DVec2>, indices: Vec<u32>) -> Self {
        let mut normals = vec![DVec3::ZERO; positions.len()];
        let mut tangents = normals.clone();
        for triangle in indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|k| triangle[k] as usize);
            let (e_1, e_2) = (positions[b] - positions[a], positions[c] - positions[a]);
            let (s_1, s_2) = (side[b] - side[a], side[c] - side[a]);
            // ∂p/∂x of the triangle, times its area in the side frame.
            let along_x = (e_1 * s_2.y - e_2 * s_1.y) * s_1.perp_dot(s_2).signum();
            for vertex in [a, b, c] {
                normals[vertex] += e_1.cross(e_2);
                tangents[vertex] += along_x;
            }
        }
        for (normal, tangent) in normals.iter_mut().zip(&mut tangents) {
            *normal = normal.normalize_or(DVec3::Z);
            *tangent = tangent
                .reject_from_normalized(*normal)
                .normalize_or(DVec3::X);
        }
        Self {
            positions,
            side,
            normals,
            tangents,
            indices,
        }
    }

    /// The same sheet from behind, after it was turned over about `flip`.
    pub fn other_side(&self, size_mm: DVec2, flip: FlipAxis) -> Self {
        let turn = |v: DVec3| match flip {
            FlipAxis::Vertical => DVec3::new(-v.x, v.y, -v.z),
            FlipAxis::Horizontal => DVec3::new(v.x, -v.y, -v.z),
        };
        // Turned about the vertical axis, x of the side frame runs the other way.
        let along = match flip {
            FlipAxis::Vertical => -1.0,
            FlipAxis::Horizontal => 1.0,
        };
        Self {
            positions: self.positions.iter().map(|&p| turn(p)).collect(),
            side: self
                .side
                .iter()
                .map(|&s| other_side(s, size_mm, flip))
                .collect(),
            normals: self.normals.iter().map(|&n| -turn(n)).collect(),
            tangents: self.tangents.iter().map(|&t| turn(t) * along).collect(),
            indices: self
                .indices
                .chunks_exact(3)
                .flat_map(|t| [t[0], t[2], t[1]])
                .collect(),
        }
    }
}

/// Micrometres in a millimetre.
const UM_PER_MM: f64 = 1000.0;

/// A sheet that follows a macro height map, read with bilinear weights.
fn curl(map: &HeightMap, size_mm: DVec2) -> Result<SideSurface, MapError> {
    let pyramid = maps::load_height(&map.file.path)?;
    let level = &pyramid.levels[0];
    let (width, height) = (level.width as usize, level.height as usize);
    let texel = |x: usize, y: usize| f64::from(level.texels.get(y * width + x).unwrap_or_default());
    let [low, high] = map.range_um;
    Ok(SideSurface::curled(size_mm, |at| {
        let uv = map.file.uv_from_side.transform_point2(at);
        let uv = uv.clamp(DVec2::ZERO, DVec2::ONE);
        let place = uv * DVec2::new(width as f64, height as f64) - 0.5;
        // Between the middles of the outermost pixels and the edge the slope goes on.
        let (x, y) = (
            (place.x as usize).min(width.saturating_sub(2)),
            (place.y as usize).min(height.saturating_sub(2)),
        );
        let (x_1, y_1) = ((x + 1).min(width - 1), (y + 1).min(height - 1));
        let part = place - DVec2::new(x as f64, y as f64);
        let top = texel(x, y) + (texel(x_1, y) - texel(x, y)) * part.x;
        let bottom = texel(x, y_1) + (texel(x_1, y_1) - texel(x, y_1)) * part.x;
        (low + (high - low) * (top + (bottom - top) * part.y)) / UM_PER_MM
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: DVec2 = DVec2::new(200.0, 100.0);

    fn outward(surface: &SideSurface) -> bool {
        surface.indices.chunks_exact(3).all(|t| {
            let [a, b, c] = [0, 1, 2].map(|k| surface.positions[t[k] as usize]);
            (b - a).cross(c - a).dot(surface.normals[t[0] as usize]) > 0.0
        })
    }

    #[test]
    fn triangles_face_outwards_on_both_sides() {
        let curled = SideSurface::curled(SIZE, |at| 4.0 * (at.x / 60.0).sin() + at.y * 0.02);
        assert!(outward(&curled));
        for flip in [FlipAxis::Vertical, FlipAxis::Horizontal] {
            let behind = curled.other_side(SIZE, flip);
            assert!(outward(&behind));
            assert!(
                behind.normals.iter().all(|n| n.z > 0.0),
                "seen from its own side"
            );
            // Turned over twice, up to the rounding of the side frame.
            let again = behind.other_side(SIZE, flip);
            assert!(again.indices == curled.indices && again.positions == curled.positions);
            let moved = again
                .side
                .iter()
                .zip(&curled.side)
                .map(|(a, b)| a.distance(*b));
            assert!(moved.fold(0.0, f64::max) < 1e-9);
        }
    }

    #[test]
    fn a_curl_has_no_more_triangles_than_it_needs() {
        let count = |within: f64, height: &dyn Fn(DVec2) -> f64| {
            let surface = SideSurface::curled(SIZE, height);
            // Wherever it is looked at, the surface is where it should be.
            for k in 0..500 {
                let at = DVec2::new(f64::from(k % 25) + 0.3, f64::from(k / 25) + 0.6) * 4.0;
                let found = surface.indices.chunks_exact(3).find_map(|triangle| {
                    let [a, b, c] = [0, 1, 2].map(|k| triangle[k] as usize);
                    let [origin, u, v] = [a, b, c].map(|i| surface.side[i]);
                    let (u, v, to) = (u - origin, v - origin, at - origin);
                    let (s, t) = (
                        to.perp_dot(v) / u.perp_dot(v),
                        u.perp_dot(to) / u.perp_dot(v),
                    );
                    let p = |i: usize| surface.positions[i].z;
                    let inside = s >= 0.0 && t >= 0.0 && s + t <= 1.0;
                    inside.then(|| p(a) + (p(b) - p(a)) * s + (p(c) - p(a)) * t)
                });
                let off = (found.expect("on the sheet") - height(at)).abs();
                assert!(off <= within, "{at}: {off}");
            }
            surface.indices.len() / 3
        };
        assert_eq!(count(1e-9, &|_| 0.0), 2);
        let gentle = count(2.0 * SAME_MM, &|at| 0.5 * (at.x / 60.0).sin() + at.y * 0.02);
        // Half a fine quad of the crease lies beside its edge.
        let creased = count(0.16, &|at| 0.2 * (at.x - 101.0).abs());
        assert!(
            gentle < creased && creased < QUADS * QUADS,
            "{gentle} {creased}"
        );
        // What is rough everywhere has nearly all of them.
        let rough = count(0.05, &|at| 0.05 * (at.x * 1.1).sin() * (at.y * 2.3).sin());
        assert!(rough > 2 * QUADS * QUADS * 9 / 10, "{rough}");
    }

    #[test]
    fn frame_follows_a_ramp() {
        // Rising 1 in 10 to the right: normal leans left, tangent climbs.
        let ramp = SideSurface::curled(SIZE, |at| at.x / 10.0);
        let expected = DVec3::new(-0.1, 0.0, 1.0).normalize();
        assert!(ramp.normals.iter().all(|n| n.distance(expected) < 1e-9));
        assert!(ramp.tangents.iter().all(|t| t.z > 0.0));
        // The same triangles as a model give the same frame.
        let model = SideSurface::modelled(
            ramp.positions.clone(),
            ramp.side.clone(),
            ramp.indices.clone(),
        );
        for (a, b) in ramp.normals.iter().zip(&model.normals) {
            assert!(a.distance(*b) < 1e-9);
        }
        for (a, b) in ramp.tangents.iter().zip(&model.tangents) {
            assert!(a.distance(*b) < 1e-9);
        }
    }
}
