//! The macroscopic sheet as rays meet it: a plane, or triangles in a grid.

use glam::{DVec2, DVec3};

use crate::manifest::surface::SideSurface;

/// Cells along the longer edge of the grid over a bent sheet.
const CELLS: usize = 96;
/// Rays that leave a surface start as far above it, in mm, so as not to meet it again.
pub(super) const LIFT_MM: f64 = 1e-3;

/// A ray in the local frame of the side; `direction` is a unit vector.
#[derive(Clone, Copy)]
pub(super) struct Ray {
    pub origin: DVec3,
    pub direction: DVec3,
}

impl Ray {
    fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// Where a ray meets the sheet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    pub point: DVec3,
    /// In the side frame.
    pub place: DVec2,
    /// Unit vectors: out of the side, and along its x.
    pub normal: DVec3,
    pub tangent: DVec3,
}

pub(super) enum Shape {
    Flat { size_mm: DVec2 },
    Bent(Box<Bent>),
}

/// Triangles, by the cells of a grid over x and y that they touch.
pub(super) struct Bent {
    surface: SideSurface,
    low: DVec3,
    high: DVec3,
    cell: DVec2,
    count: [usize; 2],
    cells: Vec<Vec<u32>>,
}

impl Shape {
    pub fn flat(size_mm: DVec2) -> Self {
        Self::Flat { size_mm }
    }

    pub fn bent(surface: SideSurface) -> Self {
        Self::Bent(Box::new(Bent::new(surface)))
    }

    /// Where `ray` first meets the seen face of the sheet; `None` where it meets nothing, or its
    /// other face first.
    pub fn hit(&self, ray: &Ray) -> Option<Hit> {
        match self {
            Self::Flat { size_mm } => {
                let t = -ray.origin.z / ray.direction.z;
                let point = ray.at(t);
                let place = DVec2::new(point.x + size_mm.x / 2.0, size_mm.y / 2.0 - point.y);
                let inside = place.cmpge(DVec2::ZERO).all() && place.cmple(*size_mm).all();
                let seen = t.is_finite() && t > 0.0 && ray.direction.z < 0.0;
                (seen && inside).then_some(Hit {
                    point,
                    place,
                    normal: DVec3::Z,
                    tangent: DVec3::X,
                })
            }
            Self::Bent(bent) => bent.hit(ray),
        }
    }

    /// Whether the sheet itself lies between the start of `ray` and `distance` mm on.
    pub fn hides(&self, ray: &Ray, distance: f64) -> bool {
        match self {
            Self::Flat { .. } => false,
            Self::Bent(bent) => bent.first(ray, distance).is_some(),
        }
    }
}

impl Bent {
    fn new(surface: SideSurface) -> Self {
        let infinite = DVec3::INFINITY;
        let (low, high) = surface
            .positions
            .iter()
            .fold((infinite, -infinite), |(low, high), p| {
                (low.min(*p), high.max(*p))
            });
        let extent = (high - low).truncate().max(DVec2::splat(1e-6));
        let edge = extent.max_element() / CELLS as f64;
        let count = (extent / edge)
            .ceil()
            .to_array()
            .map(|n| (n as usize).max(1));
        let cell = extent / DVec2::new(count[0] as f64, count[1] as f64);
        let mut bent = Self {
            low,
            high,
            cell,
            count,
            cells: vec![Vec::new(); count[0] * count[1]],
            surface,
        };
        for triangle in 0..bent.surface.indices.len() / 3 {
            let corners = bent.corners(triangle);
            let (from, to) = corners
                .iter()
                .fold((infinite, -infinite), |(low, high), p| {
                    (low.min(*p), high.max(*p))
                });
            let ([x_0, y_0], [x_1, y_1]) = (bent.cell_of(from), bent.cell_of(to));
            for y in y_0..=y_1 {
                for x in x_0..=x_1 {
                    bent.cells[y * bent.count[0] + x].push(triangle as u32);
                }
            }
        }
        bent
    }

    fn vertices(&self, triangle: usize) -> [usize; 3] {
        std::array::from_fn(|k| self.surface.indices[3 * triangle + k] as usize)
    }

    fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.vertices(triangle).map(|v| self.surface.positions[v])
    }

    fn cell_of(&self, point: DVec3) -> [usize; 2] {
        let at = (point.truncate() - self.low.truncate()) / self.cell;
        // The cast saturates below.
        [
            (at.x as usize).min(self.count[0] - 1),
            (at.y as usize).min(self.count[1] - 1),
        ]
    }

    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let (triangle, t, [_, b, c]) = self.first(ray, f64::INFINITY)?;
        let [p, q, r] = self.corners(triangle);
        if (q - p).cross(r - p).dot(ray.direction) >= 0.0 {
            return None;
        }
        let a = 1.0 - b - c;
        let [i, j, k] = self.vertices(triangle);
        let s = &self.surface;
        let normal =
            (s.normals[i] * a + s.normals[j] * b + s.normals[k] * c).normalize_or(DVec3::Z);
        let tangent = s.tangents[i] * a + s.tangents[j] * b + s.tangents[k] * c;
        Some(Hit {
            point: ray.at(t),
            place: s.side[i] * a + s.side[j] * b + s.side[k] * c,
            normal,
            tangent: (tangent - normal * normal.dot(tangent)).normalize_or(DVec3::X),
        })
    }

    /// The first triangle that `ray` meets within `reach`, how far off, and where on it.
    fn first(&self, ray: &Ray, reach: f64) -> Option<(usize, f64, [f64; 3])> {
        let inverse = ray.direction.recip();
        let (to_low, to_high) = (
            (self.low - DVec3::splat(LIFT_MM) - ray.origin) * inverse,
            (self.high + DVec3::splat(LIFT_MM) - ray.origin) * inverse,
        );
        // 0 · ∞ is no bound.
        let bound = |v: f64, or: f64| if v.is_nan() { or } else { v };
        let (mut enter, mut leave) = (0.0f64, reach);
        for axis in 0..3 {
            let (a, b) = (to_low[axis], to_high[axis]);
            enter = enter.max(bound(a.min(b), 0.0));
            leave = leave.min(bound(a.max(b), reach));
        }
        if enter > leave {
            return None;
        }
        // From cell to cell (Amanatides & Woo 1987).
        let start = ray.at(enter);
        let mut at = self.cell_of(start);
        let step = |axis: usize| if ray.direction[axis] < 0.0 { -1i64 } else { 1 };
        let edge = |axis: usize, cell: usize| {
            let ahead = cell as f64 + f64::from(ray.direction[axis] >= 0.0);
            let to = self.low[axis] + ahead * self.cell[axis] - ray.origin[axis];
            let t = to * inverse[axis];
            if t.is_finite() { t } else { f64::INFINITY }
        };
        let mut found: Option<(usize, f64, [f64; 3])> = None;
        loop {
            let exits = [edge(0, at[0]), edge(1, at[1])];
            for &triangle in &self.cells[at[1] * self.count[0] + at[0]] {
                let triangle = triangle as usize;
                let best = found.map_or(reach, |(_, t, _)| t);
                if let Some((t, weights)) = meet(ray, self.corners(triangle))
                    && t < best
                {
                    found = Some((triangle, t, weights));
                }
            }
            let axis = usize::from(exits[1] < exits[0]);
            let exit = exits[axis];
            if found.is_some_and(|(_, t, _)| t <= exit) || exit >= leave {
                return found;
            }
            let next = at[axis] as i64 + step(axis);
            if next < 0 || next >= self.count[axis] as i64 {
                return found;
            }
            at[axis] = next as usize;
        }
    }
}

/// Distance and barycentric coordinates of a ray's point in a triangle (Möller & Trumbore 1997).
fn meet(ray: &Ray, [a, b, c]: [DVec3; 3]) -> Option<(f64, [f64; 3])> {
    let (e_1, e_2) = (b - a, c - a);
    let p = ray.direction.cross(e_2);
    let determinant = e_1.dot(p);
    let s = ray.origin - a;
    let u = s.dot(p) / determinant;
    let q = s.cross(e_1);
    let v = ray.direction.dot(q) / determinant;
    let t = e_2.dot(q) / determinant;
    // Between neighbours there is no gap.
    const EDGE: f64 = -1e-9;
    let inside = u >= EDGE && v >= EDGE && u + v <= 1.0 - EDGE && t > 0.0 && t.is_finite();
    inside.then_some((t, [1.0 - u - v, u, v]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bent_sheet_is_met_where_it_is() {
        let size = DVec2::new(200.0, 100.0);
        let height = |at: DVec2| 4.0 * (at.x / 60.0).sin() + at.y * 0.02;
        // Of the finest triangles: it is their hits that are judged, not how few of them there are.
        let shape = Shape::bent(SideSurface::curled_within(1e-4, size, height));
        for (x, y) in [(3.0, 4.0), (77.3, 55.1), (199.9, 99.9), (120.0, 0.1)] {
            let over = DVec3::new(x - 100.0, 50.0 - y, 0.0);
            for direction in [DVec3::NEG_Z, DVec3::new(0.3, -0.2, -0.6).normalize()] {
                let target = over.with_z(height(DVec2::new(x, y)));
                let origin = target - direction * 500.0;
                let hit = shape.hit(&Ray { origin, direction }).expect("the sheet");
                // A quad is 1.6 mm wide, and sags by 4/3600 · .8²/2.
                assert!(hit.place.distance(DVec2::new(x, y)) < 5e-3, "{hit:?}");
                assert!(hit.point.distance(target) < 5e-3, "{hit:?}");
                let behind = Ray {
                    origin: target + direction * 500.0,
                    direction: -direction,
                };
                assert!(shape.hit(&behind).is_none(), "its other face");
            }
        }
        let past = Ray {
            origin: DVec3::new(101.0, 0.0, 50.0),
            direction: DVec3::NEG_Z,
        };
        assert!(shape.hit(&past).is_none());
    }

    #[test]
    fn a_fold_throws_its_shadow() {
        let size = DVec2::new(100.0, 100.0);
        let shape = Shape::bent(SideSurface::curled(size, |at| {
            (10.0 - (at.x - 50.0).abs()).max(0.0)
        }));
        let from = |x: f64| Ray {
            origin: DVec3::new(x, 3.0, LIFT_MM),
            direction: DVec3::new(1.0, 0.0, 0.5).normalize(),
        };
        // The ridge is 10 mm high and the light falls by half: 20 mm of shadow.
        assert!(shape.hides(&from(-18.0), f64::INFINITY));
        assert!(!shape.hides(&from(-22.0), f64::INFINITY));
        assert!(!shape.hides(&from(-18.0), 5.0), "a lamp before the ridge");
        assert!(!shape.hides(&from(20.0), f64::INFINITY));
    }
}
