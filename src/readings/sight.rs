//! From a pixel of a picture to the place of the sheet that is seen there.

use glam::{DVec2, DVec3};

use super::ReadingError;
use crate::{
    manifest::{
        Exhibit, Scene,
        comparison::Part,
        exhibit::{SideName, Surface},
        eye::Eye,
        surface::SideSurface,
    },
    maps::MapError,
};

/// A line of sight that is nearer to lying in a triangle than this meets none.
const GRAZING: f64 = 1e-12;

/// How a scene's sheet is seen in a picture of some size.
pub struct Sight {
    size: DVec2,
    surface: SideSurface,
    /// Those parts of the picture that show the side.
    parts: Vec<(Eye, Part)>,
}

/// A place that is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// In the side frame.
    pub mm: DVec2,
    /// Size of the pixel there on the sheet, where it is longest.
    pub pixel_mm: f64,
}

impl Sight {
    /// Of `scene` in a picture of `size` pixels; of a comparison, of the members that show the same
    /// side of the same drawing, whatever their state.
    ///
    /// # Errors
    /// Of the sheet's shape, where it comes from a file.
    pub fn new(exhibit: &Exhibit, scene: &Scene, size: [u32; 2]) -> Result<Self, ReadingError> {
        let size = DVec2::from(size.map(|side| f64::from(side.max(1))));
        let aspect = size.x / size.y;
        let drawing = exhibit.drawing_of(scene);
        let size_mm = drawing.size_mm;
        let path = match &drawing.surface {
            Surface::Height(map) => map.file.path.clone(),
            Surface::Gltf(path) => path.clone(),
            Surface::Flat => exhibit.manifest.clone(),
        };
        let unread = |error: MapError| ReadingError::Map { path, error };
        let recto = SideSurface::load(&drawing.surface, size_mm).map_err(unread)?;
        let surface = match scene.side {
            SideName::Recto => recto,
            SideName::Verso => recto.other_side(size_mm, drawing.flip),
        };
        let parts = exhibit
            .parts(scene, aspect)
            .into_iter()
            .filter(|(member, _)| (member.drawing, member.side) == (scene.drawing, scene.side))
            .map(|(member, part)| {
                let camera = member.camera.fitted(size_mm, part.aspect(aspect));
                (Eye::new(&camera, size_mm), part)
            });
        Ok(Self {
            size,
            surface,
            parts: parts.collect(),
        })
    }

    /// What is seen at a place of the picture, in pixels from its top left corner (so that the
    /// middles of pixels lie at halves); `None` beside the sheet.
    pub fn seen(&self, pixel: DVec2) -> Option<Seen> {
        let mm = self.place(pixel)?;
        let pixel_mm = [DVec2::X, DVec2::Y]
            .into_iter()
            .flat_map(|step| [step, -step])
            .filter_map(|step| Some(self.place(pixel + step)?.distance(mm)))
            .fold(0.0, f64::max);
        Some(Seen { mm, pixel_mm })
    }

    fn place(&self, pixel: DVec2) -> Option<DVec2> {
        let ndc = DVec2::new(
            2.0 * pixel.x / self.size.x - 1.0,
            1.0 - 2.0 * pixel.y / self.size.y,
        );
        let aspect = self.size.x / self.size.y;
        let (eye, part) = self
            .parts
            .iter()
            .find(|(_, part)| part.shows(ndc, aspect))?;
        let own = (ndc - part.shift) / part.scale;
        let (origin, direction) = eye.ray(own, part.aspect(aspect));
        let surface = &self.surface;
        let mut nearest: Option<(f64, DVec2)> = None;
        for triangle in surface.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|k| triangle[k] as usize);
            let corners = [a, b, c].map(|i| surface.positions[i]);
            let Some((t, [u, v])) = meets(origin, direction, corners) else {
                continue;
            };
            if nearest.is_none_or(|(before, _)| t < before) {
                let [a, b, c] = [a, b, c].map(|i| surface.side[i]);
                nearest = Some((t, a + (b - a) * u + (c - a) * v));
            }
        }
        nearest.map(|(_, place)| place)
    }
}

/// Where a ray meets a triangle: how far along, and its weights of the second and third corner
/// (T. Möller & B. Trumbore, *J. Graphics Tools* 2 (1997) 21).
fn meets(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<(f64, [f64; 2])> {
    let (e_1, e_2) = (b - a, c - a);
    let p = direction.cross(e_2);
    let determinant = e_1.dot(p);
    if determinant.abs() <= GRAZING * direction.length() * e_1.length() * e_2.length() {
        return None;
    }
    let s = origin - a;
    let q = s.cross(e_1);
    let [u, v, t] = [s.dot(p), direction.dot(q), e_2.dot(q)].map(|d| d / determinant);
    // Neighbours share an edge, which rounding must not open.
    let edge = -1e-9;
    (t > 0.0 && u >= edge && v >= edge && u + v <= 1.0 - edge).then_some((t, [u, v]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_meets_a_triangle_from_either_side_and_not_beside_it() {
        let corners = [DVec3::ZERO, DVec3::X * 2.0, DVec3::Y * 2.0];
        let from = |x: f64, y: f64| meets(DVec3::new(x, y, 3.0), DVec3::NEG_Z, corners);
        assert_eq!(from(0.5, 0.25), Some((3.0, [0.25, 0.125])));
        assert!(meets(DVec3::new(0.5, 0.25, -3.0), DVec3::Z, corners).is_some());
        assert!(from(1.5, 1.0).is_none() && from(-0.1, 0.5).is_none());
        // Away from it, and along it.
        assert!(meets(DVec3::new(0.5, 0.25, 3.0), DVec3::Z, corners).is_none());
        assert!(meets(DVec3::new(-1.0, 0.5, 0.0), DVec3::X, corners).is_none());
    }
}
