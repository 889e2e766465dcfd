//! From a pixel of a picture to the place of the sheet that is seen there, and back.

use std::sync::Arc;

use glam::{DQuat, DVec2, DVec3, DVec4};

use super::ReadingError;
use crate::{
    manifest::{
        Exhibit, Scene,
        comparison::Part,
        exhibit::{Drawing, FlipAxis, SideName, Surface},
        eye::Eye,
        frames::other_side,
        surface::SideSurface,
    },
    maps::MapError,
};

/// A line of sight that is nearer to lying in a triangle than this meets none.
const GRAZING: f64 = 1e-12;

/// A sheet in a picture: one of those that a comparison shows, or the only one.
#[derive(Clone, Copy, Debug)]
pub struct Lying {
    /// The eye for its part of the picture.
    pub eye: Eye,
    pub part: Part,
    /// Table frame from the sheet's own: mm around its centre, x right and y up on the recto.
    pub pose: DQuat,
}

/// How a drawing's sheet is seen in a picture of some size, once or several times.
#[derive(Clone, Debug)]
pub struct Sight {
    size: DVec2,
    size_mm: DVec2,
    flip: FlipAxis,
    /// The recto's.
    surface: Arc<SideSurface>,
    sheets: Vec<Lying>,
    /// Of each sheet, if it was made from one.
    scenes: Vec<Scene>,
}

/// A place that is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// In the frame of `side`.
    pub mm: DVec2,
    /// Size of the pixel there on the sheet, where it is longest.
    pub pixel_mm: f64,
    pub side: SideName,
    /// Which of the sheets it is seen on.
    pub sheet: usize,
}

impl Sight {
    /// Of `scene` at rest in a picture of `size` pixels; of a comparison, of the members that show the
    /// same side of the same drawing, whatever their state.
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
        let surface = SideSurface::load(&drawing.surface, size_mm).map_err(unread)?;
        let (scenes, parts): (Vec<Scene>, Vec<Lying>) = exhibit
            .parts(scene, aspect)
            .into_iter()
            .filter(|(member, _)| (member.drawing, member.side) == (scene.drawing, scene.side))
            .map(|(member, part)| {
                let camera = member.camera.fitted(size_mm, part.aspect(aspect));
                let lying = Lying {
                    eye: Eye::new(&camera, size_mm),
                    part,
                    pose: drawing.rest_pose(member.side),
                };
                (member, lying)
            })
            .unzip();
        Ok(Self {
            scenes,
            ..Self::of(drawing, Arc::new(surface), size, parts)
        })
    }

    /// Of the sheet of `drawing` with the recto's `surface`, lying as `sheets` in a picture of `size`
    /// pixels.
    pub fn of(
        drawing: &Drawing,
        surface: Arc<SideSurface>,
        size: DVec2,
        sheets: Vec<Lying>,
    ) -> Self {
        Self {
            size,
            size_mm: drawing.size_mm,
            flip: drawing.flip,
            surface,
            sheets,
            scenes: Vec::new(),
        }
    }

    /// The scene, without a comparison, whose sheet number `sheet` is seen; `None` where only the
    /// sheets are known.
    pub fn scene(&self, sheet: usize) -> Option<&Scene> {
        self.scenes.get(sheet)
    }

    /// What is seen at a place of the picture, in pixels from its top left corner (so that the
    /// middles of pixels lie at halves); `None` beside the sheet.
    pub fn seen(&self, pixel: DVec2) -> Option<Seen> {
        let (sheet, side, mm) = self.place(pixel)?;
        let pixel_mm = [DVec2::X, DVec2::Y]
            .into_iter()
            .flat_map(|step| [step, -step])
            .filter_map(|step| self.place(pixel + step))
            .filter(|(other, from, _)| (*other, *from) == (sheet, side))
            .map(|(.., there)| there.distance(mm))
            .fold(0.0, f64::max);
        Some(Seen {
            mm,
            pixel_mm,
            side,
            sheet,
        })
    }

    /// Where the part of the picture that sheet number `sheet` has shows a place of a side: in pixels
    /// from the top left corner. `None` where it is outside that part, or only its back is seen.
    pub fn pixel(&self, sheet: usize, side: SideName, mm: DVec2) -> Option<DVec2> {
        let lying = self.sheets.get(sheet)?;
        let on_recto = match side {
            SideName::Recto => mm,
            SideName::Verso => other_side(mm, self.size_mm, self.flip),
        };
        let point = lying.pose * surface_point(&self.surface, on_recto)?;
        let aspect = self.aspect();
        let clip =
            lying.part.clip_from_own() * lying.eye.clip_from_table(lying.part.aspect(aspect));
        let at: DVec4 = clip * point.extend(1.0);
        let ndc = DVec2::new(at.x, at.y) / at.w;
        let pixel = DVec2::new(1.0 + ndc.x, 1.0 - ndc.y) / 2.0 * self.size;
        let shown = at.w > 0.0 && lying.part.shows(ndc, aspect);
        // Something else may lie before it.
        let is_seen = |(on, from, _): (usize, SideName, DVec2)| (on, from) == (sheet, side);
        (shown && self.place(pixel).is_some_and(is_seen)).then_some(pixel)
    }

    /// How many sheets are seen.
    pub fn sheets(&self) -> usize {
        self.sheets.len()
    }

    fn aspect(&self) -> f64 {
        self.size.x / self.size.y
    }

    fn place(&self, pixel: DVec2) -> Option<(usize, SideName, DVec2)> {
        let ndc = DVec2::new(
            2.0 * pixel.x / self.size.x - 1.0,
            1.0 - 2.0 * pixel.y / self.size.y,
        );
        let aspect = self.aspect();
        let mut sheets = self.sheets.iter().enumerate();
        let (sheet, lying) = sheets.find(|(_, lying)| lying.part.shows(ndc, aspect))?;
        let part = &lying.part;
        let own = (ndc - part.shift) / part.scale;
        let (origin, direction) = lying.eye.ray(own, part.aspect(aspect));
        let to_sheet = lying.pose.inverse();
        let (origin, direction) = (to_sheet * origin, to_sheet * direction);
        let surface = &self.surface;
        let mut nearest: Option<(f64, SideName, DVec2)> = None;
        for triangle in surface.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|k| triangle[k] as usize);
            let corners = [a, b, c].map(|i| surface.positions[i]);
            let Some((t, [u, v])) = meets(origin, direction, corners) else {
                continue;
            };
            if nearest.is_none_or(|(before, ..)| t < before) {
                let [p, q, r] = corners;
                let side = match (q - p).cross(r - p).dot(direction) <= 0.0 {
                    true => SideName::Recto,
                    false => SideName::Verso,
                };
                let [a, b, c] = [a, b, c].map(|i| surface.side[i]);
                nearest = Some((t, side, a + (b - a) * u + (c - a) * v));
            }
        }
        nearest.map(|(_, side, place)| match side {
            SideName::Recto => (sheet, side, place),
            SideName::Verso => (sheet, side, other_side(place, self.size_mm, self.flip)),
        })
    }
}

/// The point of a sheet's surface over a place of its recto, in the sheet's own frame.
pub fn surface_point(surface: &SideSurface, place: DVec2) -> Option<DVec3> {
    surface.indices.chunks_exact(3).find_map(|triangle| {
        let [a, b, c] = [0, 1, 2].map(|k| triangle[k] as usize);
        let [origin, u, v] = [surface.side[a], surface.side[b], surface.side[c]];
        let (u, v, to) = (u - origin, v - origin, place - origin);
        let area = u.perp_dot(v);
        let (s, t) = (to.perp_dot(v) / area, u.perp_dot(to) / area);
        const NEAR: f64 = 1e-9;
        (s >= -NEAR && t >= -NEAR && s + t <= 1.0 + NEAR).then(|| {
            let at = surface.positions[a];
            at + (surface.positions[b] - at) * s + (surface.positions[c] - at) * t
        })
    })
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
