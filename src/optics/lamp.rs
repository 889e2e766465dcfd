//! Light arriving at a point of the sheet, from lamps in photometric units.

use std::sync::Arc;

use glam::DVec3;

use super::{
    photometry::Photometry,
    quadrature::{disc_rule, gauss_legendre},
};

/// Squared distances (mm²) are never taken smaller: 1e-4 m².
pub const DISTANCE2_MIN_MM2: f64 = 100.0;

/// A lamp as the shader sees it: pre-exposed, and placed in any one frame in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    pub shape: Shape,
    /// Linear sRGB amount: illuminance facing a distant lamp, otherwise (peak) intensity
    /// times 1e6 mm²/m² (for a rectangle or a disc, luminance times area), already divided by the reference
    /// illuminance and times π, so that a perfect diffuser facing that illuminance shows 1.
    pub amount: DVec3,
}

/// Where the light comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Unit vector towards the lamp.
    Distant {
        towards: DVec3,
    },
    Point {
        position: DVec3,
    },
    /// `axis` is the unit vector along the beam; between the cosines the intensity is linear.
    Spot {
        position: DVec3,
        axis: DVec3,
        cos_hotspot: f64,
        cos_falloff: f64,
    },
    /// `half_u`, `half_v` span half the rectangle; it shines along `axis` only. Sampled at
    /// `grid` × `grid` points of a Gauss-Legendre rule, `grid` in [`super::quadrature::GRIDS`].
    Rectangle {
        centre: DVec3,
        axis: DVec3,
        half_u: DVec3,
        half_v: DVec3,
        grid: u32,
    },
    /// A Lambertian disc whose radius along two directions is `half_u` and `half_v`; it shines
    /// along `axis` only. Sampled by [`disc_rule`] of `rings` rings.
    Disc {
        centre: DVec3,
        axis: DVec3,
        half_u: DVec3,
        half_v: DVec3,
        rings: u32,
    },
    /// A small lamp with the intensities of a photometric file, as shares of their peak. Unit
    /// vectors: `axis` along γ = 0, `across_u` and `across_v` at γ = 90° along C = 0° and 90°.
    Ies {
        position: DVec3,
        axis: DVec3,
        across_u: DVec3,
        across_v: DVec3,
        photometry: Arc<Photometry>,
    },
}

/// Light at a point from one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incidence {
    /// Unit vector towards the light.
    pub l: DVec3,
    /// Illuminance on a surface facing `l`, in the unit of [`Light::amount`].
    pub e: DVec3,
}

impl Light {
    /// The light at `p` (mm), one [`Incidence`] for each sample of the lamp.
    pub fn at(&self, p: DVec3) -> Vec<Incidence> {
        match self.shape {
            Shape::Ies {
                position,
                axis,
                across_u,
                across_v,
                ref photometry,
            } => {
                let share = |l: DVec3| {
                    let (u, v) = (-across_u.dot(l), -across_v.dot(l));
                    // Without a direction, at the lamp's own place, γ is 0: never −0.
                    let gamma = u.hypot(v).atan2(0.0 - axis.dot(l));
                    photometry.intensity(gamma, v.atan2(u)) / photometry.peak()
                };
                vec![self.inverse_square(position - p, share)]
            }
            Shape::Distant { towards } => vec![Incidence {
                l: towards,
                e: self.amount,
            }],
            Shape::Point { position } => vec![self.inverse_square(position - p, |_| 1.0)],
            Shape::Spot {
                position,
                axis,
                cos_hotspot,
                cos_falloff,
            } => {
                let width = (cos_hotspot - cos_falloff).max(1e-6);
                let beam = |l: DVec3| ((-axis.dot(l) - cos_falloff) / width).clamp(0.0, 1.0);
                vec![self.inverse_square(position - p, beam)]
            }
            Shape::Rectangle {
                centre,
                axis,
                half_u,
                half_v,
                grid,
            } => (0..grid * grid)
                .map(|i| {
                    let [u, weight_u] = gauss_legendre(grid, i % grid);
                    let [v, weight_v] = gauss_legendre(grid, i / grid);
                    let sample = centre + half_u * u + half_v * v;
                    let share = weight_u * weight_v;
                    self.inverse_square(sample - p, |l| share * (-axis.dot(l)).max(0.0))
                })
                .collect(),
            Shape::Disc {
                centre,
                axis,
                half_u,
                half_v,
                rings,
            } => (0..4 * rings * rings)
                .map(|i| {
                    let ([x, y], share) = disc_rule(rings, i);
                    let sample = centre + half_u * x + half_v * y;
                    self.inverse_square(sample - p, |l| share * (-axis.dot(l)).max(0.0))
                })
                .collect(),
        }
    }

    /// Inverse square law from a point `towards` away, weighted by what it emits along −`l`.
    fn inverse_square(&self, towards: DVec3, emits: impl Fn(DVec3) -> f64) -> Incidence {
        let distance2 = towards.length_squared();
        let l = towards / distance2.sqrt().max(1e-6);
        Incidence {
            l,
            e: self.amount * (emits(l) / distance2.max(DISTANCE2_MIN_MM2)),
        }
    }

    /// Illuminance on a surface at `p` with unit normal `n`, in the unit of `amount`.
    pub fn illuminance(&self, p: DVec3, n: DVec3) -> DVec3 {
        self.at(p)
            .iter()
            .map(|incidence| incidence.e * n.dot(incidence.l).max(0.0))
            .sum()
    }

    /// The same lamp seen from a frame that is `rotate`d (world to frame) about the origin.
    pub fn rotated(&self, rotate: glam::DQuat) -> Self {
        let shape = match self.shape {
            Shape::Ies {
                position,
                axis,
                across_u,
                across_v,
                ref photometry,
            } => Shape::Ies {
                position: rotate * position,
                axis: rotate * axis,
                across_u: rotate * across_u,
                across_v: rotate * across_v,
                photometry: Arc::clone(photometry),
            },
            Shape::Distant { towards } => Shape::Distant {
                towards: rotate * towards,
            },
            Shape::Point { position } => Shape::Point {
                position: rotate * position,
            },
            Shape::Spot {
                position,
                axis,
                cos_hotspot,
                cos_falloff,
            } => Shape::Spot {
                position: rotate * position,
                axis: rotate * axis,
                cos_hotspot,
                cos_falloff,
            },
            Shape::Rectangle {
                centre,
                axis,
                half_u,
                half_v,
                grid,
            } => Shape::Rectangle {
                centre: rotate * centre,
                axis: rotate * axis,
                half_u: rotate * half_u,
                half_v: rotate * half_v,
                grid,
            },
            Shape::Disc {
                centre,
                axis,
                half_u,
                half_v,
                rings,
            } => Shape::Disc {
                centre: rotate * centre,
                axis: rotate * axis,
                half_u: rotate * half_u,
                half_v: rotate * half_v,
                rings,
            },
        };
        Self {
            shape,
            amount: self.amount,
        }
    }
}

/// Illuminance per unit luminance that a Lambertian polygon gives to a point at the origin with
/// unit normal `n`; the polygon must lie wholly above the plane (Lambert 1760; Arvo 1994).
pub fn polygon_form(corners: &[DVec3], n: DVec3) -> f64 {
    let unit: Vec<DVec3> = corners.iter().map(|c| c.normalize_or_zero()).collect();
    let sum: f64 = (0..unit.len())
        .map(|i| {
            let (a, b) = (unit[i], unit[(i + 1) % unit.len()]);
            let cross = a.cross(b);
            cross.length().atan2(a.dot(b)) * cross.normalize_or_zero().dot(n)
        })
        .sum();
    (0.5 * sum).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(shape: Shape) -> Light {
        Light {
            shape,
            amount: DVec3::ONE,
        }
    }

    #[test]
    fn point_and_spot_follow_inverse_square_and_cosine() {
        for degrees in [0.0f64, 45.0, 80.0, 89.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let position = DVec3::new(sin, 0.0, cos) * 500.0;
            let expected = cos / 250_000.0;
            let point = light(Shape::Point { position }).illuminance(DVec3::ZERO, DVec3::Z);
            assert!((point.x / expected - 1.0).abs() < 1e-12);
            let spot = Shape::Spot {
                position,
                axis: -position.normalize(),
                cos_hotspot: 0.9,
                cos_falloff: 0.8,
            };
            let spot = light(spot).illuminance(DVec3::ZERO, DVec3::Z);
            assert!((spot.x / expected - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn spot_is_half_bright_half_way_in_the_cosine() {
        let axis = DVec3::new(-(1.0f64 - 0.85 * 0.85).sqrt(), 0.0, -0.85);
        let spot = |cos_hotspot, cos_falloff| {
            light(Shape::Spot {
                position: DVec3::Z * 100.0,
                axis,
                cos_hotspot,
                cos_falloff,
            })
            .illuminance(DVec3::ZERO, DVec3::Z)
            .x
        };
        assert!((spot(0.9, 0.8) * 1e4 - 0.5).abs() < 1e-12);
        assert_eq!(spot(0.95, 0.9), 0.0);
        // No width between hotspot and fall-off must not divide by zero.
        assert!(spot(0.85, 0.85).is_finite());
    }

    #[test]
    fn a_profile_turns_from_c_0_along_u_towards_v() {
        // The same at every γ: 100, 200, 300 and 400 cd at C = 0, 90, 180 and 270°.
        let text = "IESNA:LM-63-2002\nTILT=NONE\n1 100 1 2 4 1 2 0 0 0\n1 1 40\n0 90\n\
                    0 90 180 270\n100 100 200 200 300 300 400 400\n";
        let lamp = light(Shape::Ies {
            position: DVec3::Z * 500.0,
            axis: -DVec3::Z,
            across_u: DVec3::X,
            across_v: DVec3::Y,
            photometry: Arc::new(Photometry::parse(text).expect("a file")),
        });
        for (p, share) in [
            (DVec3::X, 0.25),
            (DVec3::Y, 0.5),
            (-DVec3::X, 0.75),
            (-DVec3::Y, 1.0),
        ] {
            let e = lamp.at(p * 500.0)[0].e.x;
            assert!((e * 500_000.0 - share).abs() < 1e-9, "{p}: {e}");
        }
    }

    #[test]
    fn rectangle_meets_the_polygon_formula() {
        let (half_u, half_v) = (DVec3::X * 100.0, DVec3::Y * 20.0);
        for centre in [DVec3::new(0.0, 0.0, 400.0), DVec3::new(300.0, 100.0, 200.0)] {
            let shape = Shape::Rectangle {
                centre,
                axis: -DVec3::Z,
                half_u,
                half_v,
                grid: 4,
            };
            let area = 200.0 * 40.0;
            let sampled = light(shape).illuminance(DVec3::ZERO, DVec3::Z).x * area;
            let corners = [
                centre - half_u - half_v,
                centre + half_u - half_v,
                centre + half_u + half_v,
                centre - half_u + half_v,
            ];
            let exact = polygon_form(&corners, DVec3::Z);
            assert!((sampled / exact - 1.0).abs() < 1e-3, "{sampled} {exact}");
        }
    }

    #[test]
    fn lamps_behind_and_in_the_plane_give_nothing_and_the_nearest_stays_finite() {
        for position in [DVec3::X * 100.0, DVec3::new(0.0, 0.0, -50.0), DVec3::ZERO] {
            let e = light(Shape::Point { position }).illuminance(DVec3::ZERO, DVec3::Z);
            assert_eq!(e, DVec3::ZERO, "{position}");
        }
        let near = light(Shape::Point {
            position: DVec3::Z * 1e-9,
        });
        assert!(near.illuminance(DVec3::ZERO, DVec3::Z).is_finite());
    }
}
