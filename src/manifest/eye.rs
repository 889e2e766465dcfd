//! Where the eye is: the one projection that the window, the files and the reference share.

use glam::{DMat4, DVec2, DVec3, DVec4};

use super::exhibit::Camera;

/// Depth range (mm) of a parallel projection to each side of what it looks at.
const PARALLEL_DEPTH_MM: f64 = 20_000.0;
/// Nearest depth (mm) of a perspective projection.
const NEAR_MM: f64 = 1.0;

/// An eye in the table frame (see [`super::exhibit`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// What it looks at.
    pub centre: DVec3,
    /// Unit vectors of the picture, and from the centre to the eye.
    pub right: DVec3,
    pub up: DVec3,
    pub towards: DVec3,
    /// Half the width in mm that fills the picture at the centre.
    pub half_width: f64,
    /// Distance from the centre in mm; `None` is a parallel projection.
    pub distance: Option<f64>,
}

impl Eye {
    /// The eye of `camera` over a sheet of `size_mm` at rest.
    pub fn new(camera: &Camera, size_mm: DVec2) -> Self {
        let (sin_tilt, cos_tilt) = camera.tilt.radians().sin_cos();
        let (sin_turn, cos_turn) = camera.turn.radians().sin_cos();
        let about_z = |v: DVec3| {
            DVec3::new(
                v.x * cos_turn - v.y * sin_turn,
                v.x * sin_turn + v.y * cos_turn,
                v.z,
            )
        };
        Self {
            centre: DVec3::new(
                camera.centre_mm.x - size_mm.x / 2.0,
                size_mm.y / 2.0 - camera.centre_mm.y,
                0.0,
            ),
            right: about_z(DVec3::X),
            up: about_z(DVec3::new(0.0, cos_tilt, sin_tilt)),
            towards: about_z(DVec3::new(0.0, -sin_tilt, cos_tilt)),
            half_width: camera.width_mm / 2.0,
            distance: camera.distance_mm,
        }
    }

    /// Table frame → clip space with reversed depth (1 near, 0 far), for a picture of
    /// `aspect` = width/height.
    pub fn clip_from_table(&self, aspect: f64) -> DMat4 {
        let scale = 1.0 / self.half_width;
        let row =
            |axis: DVec3, factor: f64| (axis * factor).extend(-axis.dot(self.centre) * factor);
        let along = row(self.towards, 1.0);
        let (zoom, depth, w) = match self.distance {
            // Divided by w = distance − along, which is the distance at the centre.
            Some(distance) => {
                let w = DVec4::new(0.0, 0.0, 0.0, distance) - along;
                (scale * distance, DVec4::new(0.0, 0.0, 0.0, NEAR_MM), w)
            }
            None => {
                let depth = along / (2.0 * PARALLEL_DEPTH_MM) + DVec4::new(0.0, 0.0, 0.0, 0.5);
                (scale, depth, DVec4::W)
            }
        };
        let (x, y) = (row(self.right, zoom), row(self.up, zoom * aspect));
        DMat4::from_cols(x, y, depth, w).transpose()
    }

    /// Where the eye is (w = 1), or the direction towards it (w = 0).
    pub fn place(&self) -> DVec4 {
        match self.distance {
            Some(distance) => (self.centre + self.towards * distance).extend(1.0),
            None => self.towards.extend(0.0),
        }
    }

    /// The line of sight through `ndc` (−1…1, y up) in a picture of `aspect`: a place that lies
    /// before everything that is seen, and the direction away from the eye, of any length.
    pub fn ray(&self, ndc: DVec2, aspect: f64) -> (DVec3, DVec3) {
        let offset =
            self.right * (ndc.x * self.half_width) + self.up * (ndc.y * self.half_width / aspect);
        let on_plane = self.centre + offset;
        match self.distance {
            Some(distance) => {
                let eye = self.centre + self.towards * distance;
                (eye, on_plane - eye)
            }
            None => (on_plane + self.towards * PARALLEL_DEPTH_MM, -self.towards),
        }
    }

    /// The point of the plane z = 0 of the table seen at `ndc` (−1…1, y up) in a picture of
    /// `aspect`; `None` where the eye looks past it.
    pub fn table_point(&self, ndc: DVec2, aspect: f64) -> Option<DVec3> {
        let (origin, direction) = self.ray(ndc, aspect);
        let t = -origin.z / direction.z;
        (t.is_finite() && t > 0.0).then(|| origin + direction * t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Degrees;

    fn camera(tilt: f64, turn: f64, distance_mm: Option<f64>) -> Camera {
        Camera {
            centre_mm: DVec2::new(80.0, 60.0),
            width_mm: 100.0,
            tilt: Degrees(tilt),
            turn: Degrees(turn),
            distance_mm,
        }
    }

    #[test]
    fn centre_and_edges_land_where_they_should() {
        let size = DVec2::new(285.0, 194.0);
        for distance in [None, Some(500.0)] {
            for (tilt, turn) in [(0.0, 0.0), (60.0, 0.0), (30.0, 90.0)] {
                let eye = Eye::new(&camera(tilt, turn, distance), size);
                let clip = eye.clip_from_table(1.5);
                let at = |p: DVec3| {
                    let c = clip * p.extend(1.0);
                    c / c.w
                };
                assert!(at(eye.centre).truncate().truncate().length() < 1e-12);
                assert!((at(eye.centre + eye.right * 50.0).x - 1.0).abs() < 1e-12);
                assert!((at(eye.centre + eye.up * 50.0).y - 1.5).abs() < 1e-12);
                // Nearer is greater.
                assert!(at(eye.centre + eye.towards).z > at(eye.centre).z);
                let seen = eye
                    .table_point(DVec2::new(0.3, -0.4), 1.5)
                    .expect("on the table");
                let back = at(seen);
                assert!((back.x - 0.3).abs() < 1e-9 && (back.y + 0.4).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn tilt_leans_towards_the_bottom_edge() {
        let eye = Eye::new(&camera(30.0, 0.0, None), DVec2::new(285.0, 194.0));
        assert!(eye.towards.y < 0.0 && eye.towards.z > 0.0);
    }
}
