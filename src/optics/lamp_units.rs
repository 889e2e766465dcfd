//! Photometric units into each other, for lamps as curators describe them.
//!
//! Places are in mm in any one frame, intensities in cd, illuminances in lx, fluxes in lm,
//! luminances in cd/m². *Facing the lamp* means that the receiver's normal points at the centre
//! of the lamp, so that no cosine is lost there.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::lamp::polygon_form;

/// mm² in a m².
const MM2_PER_M2: f64 = 1e6;

/// Intensity of a point lamp that sends `lumen` evenly in all directions: Φ / 4π.
pub fn point_intensity(lumen: f64) -> f64 {
    lumen / (4.0 * PI)
}

/// Intensity on the axis of a spot lamp that sends out `lumen`, where its intensity is even up to
/// the half angle of cosine `cos_hotspot` and falls, linearly in the cosine, to none at
/// `cos_falloff`: I = Φ / (2π (1 − (c_h + c_f)/2)).
pub fn spot_intensity(lumen: f64, cos_hotspot: f64, cos_falloff: f64) -> f64 {
    lumen / (2.0 * PI * (1.0 - 0.5 * (cos_hotspot + cos_falloff)))
}

/// Share, 0…1, of a spot lamp's axial intensity in a direction of cosine `cos` to its axis.
pub fn spot_share(cos: f64, cos_hotspot: f64, cos_falloff: f64) -> f64 {
    if cos >= cos_hotspot {
        1.0
    } else if cos <= cos_falloff {
        0.0
    } else {
        (cos - cos_falloff) / (cos_hotspot - cos_falloff)
    }
}

/// Intensity of a small lamp that gives `lux` at `distance_mm`, facing the lamp: E·d².
pub fn intensity_for(lux: f64, distance_mm: f64) -> f64 {
    lux * distance_mm * distance_mm / MM2_PER_M2
}

/// Luminance of a one-sided Lambertian area that sends out `lumen`: Φ / (π A).
pub fn area_luminance(lumen: f64, area_mm2: f64) -> f64 {
    lumen / (PI * area_mm2 / MM2_PER_M2)
}

/// A flat lamp's axes at `position` when it shines at `aim`: unit vectors along its width, its
/// height and its light. The width lies parallel to the sheet (perpendicular to z), and along x
/// where the lamp shines straight down. `None` where `aim` is `position`.
pub fn area_axes(position: DVec3, aim: DVec3) -> Option<[DVec3; 3]> {
    let axis = (aim - position).try_normalize()?;
    let width = DVec3::Z.cross(-axis).try_normalize().unwrap_or(DVec3::X);
    Some([width, (-axis).cross(width), axis])
}

/// Illuminance per unit luminance, in lx per cd/m², that a one-sided Lambertian rectangle of
/// `size` in mm at `position`, shining at `aim`, gives to `receiver`, facing the lamp. 0 where
/// the receiver is behind the lamp.
pub fn rectangle_form(position: DVec3, aim: DVec3, size: DVec2, receiver: DVec3) -> f64 {
    let corner = |x: f64, y: f64| DVec2::new(x, y) * size / 2.0;
    let outline = [
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
    ];
    flat_form(position, aim, &outline, receiver)
}

/// As [`rectangle_form`], for a disc of `diameter` in mm.
pub fn disc_form(position: DVec3, aim: DVec3, diameter: f64, receiver: DVec3) -> f64 {
    /// Corners of the polygon that stands for the circle: its form is within 1e-5 of it.
    const CORNERS: u32 = 1024;
    let step = 2.0 * PI / f64::from(CORNERS);
    // The polygon has the area of the circle.
    let radius = 0.5 * diameter * (step / step.sin()).sqrt();
    let corner = |i: u32| DVec2::from_angle(f64::from(i) * step) * radius;
    flat_form(
        position,
        aim,
        &(0..CORNERS).map(corner).collect::<Vec<_>>(),
        receiver,
    )
}

fn flat_form(position: DVec3, aim: DVec3, outline: &[DVec2], receiver: DVec3) -> f64 {
    let Some([width, height, axis]) = area_axes(position, aim) else {
        return 0.0;
    };
    let Some(n) = (position - receiver).try_normalize() else {
        return 0.0;
    };
    if axis.dot(n) >= 0.0 {
        return 0.0;
    }
    let corners: Vec<DVec3> = outline
        .iter()
        .map(|corner| position + width * corner.x + height * corner.y - receiver)
        .collect();
    polygon_form(&above(&corners, n), n)
}

/// The part of a convex polygon that lies above the plane through the origin with normal `n`.
fn above(corners: &[DVec3], n: DVec3) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let (height_a, height_b) = (a.dot(n), b.dot(n));
        if height_a >= 0.0 {
            kept.push(a);
        }
        if (height_a >= 0.0) != (height_b >= 0.0) {
            kept.push(a.lerp(b, height_a / (height_a - height_b)));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64, relative: f64) {
        assert!((a / b - 1.0).abs() < relative, "{a} is not {b}");
    }

    #[test]
    fn flux_of_a_spot_is_the_integral_of_its_intensity() {
        let (cos_hotspot, cos_falloff) = (0.95, 0.8);
        let intensity = spot_intensity(100.0, cos_hotspot, cos_falloff);
        const STEPS: u32 = 100_000;
        let flux: f64 = (0..STEPS)
            .map(|i| {
                let cos = (f64::from(i) + 0.5) / f64::from(STEPS);
                2.0 * PI * intensity * spot_share(cos, cos_hotspot, cos_falloff) / f64::from(STEPS)
            })
            .sum();
        close(flux, 100.0, 1e-4);
    }

    #[test]
    fn a_point_lamp_of_100_cd_gives_400_lx_at_half_a_metre() {
        close(intensity_for(400.0, 500.0), 100.0, 1e-12);
        close(point_intensity(4.0 * PI), 1.0, 1e-12);
    }

    /// Form of a parallel rectangle centred above a facet, of half sides `x`, `y` in units of the
    /// distance (Siegel and Howell, configuration factor C-3, four times), times π.
    fn parallel_rectangle(x: f64, y: f64) -> f64 {
        let part = |a: f64, b: f64| a / (1.0 + a * a).sqrt() * (b / (1.0 + a * a).sqrt()).atan();
        2.0 * (part(x, y) + part(y, x))
    }

    #[test]
    fn a_rectangle_on_the_axis_has_its_closed_form() {
        let size = DVec2::new(200.0, 40.0);
        for position in [DVec3::Z * 300.0, DVec3::new(-250.0, 120.0, 80.0)] {
            let d = position.length();
            let form = rectangle_form(position, DVec3::ZERO, size, DVec3::ZERO);
            close(form, parallel_rectangle(100.0 / d, 20.0 / d), 1e-9);
        }
    }

    #[test]
    fn a_disc_on_the_axis_has_its_closed_form() {
        // E = π L sin²θ, θ the half angle under which the disc is seen.
        let form = disc_form(DVec3::Z * 400.0, DVec3::ZERO, 200.0, DVec3::ZERO);
        close(
            form,
            PI * 100.0f64.powi(2) / (100.0f64.powi(2) + 400.0f64.powi(2)),
            1e-5,
        );
    }

    #[test]
    fn a_small_turned_rectangle_follows_the_cosine_and_none_shines_backwards() {
        let (position, size) = (DVec3::Z * 1000.0, DVec2::splat(10.0));
        let aim = DVec3::new(1000.0, 0.0, 0.0);
        let form = rectangle_form(position, aim, size, DVec3::ZERO);
        close(form, 100.0 / 1e6 * 0.5f64.sqrt(), 1e-4);
        assert_eq!(
            rectangle_form(position, DVec3::Z * 2000.0, size, DVec3::ZERO),
            0.0
        );
    }

    #[test]
    fn what_dips_below_the_receivers_horizon_gives_no_light() {
        // A large lamp close by and steeply turned: half of it lies behind the receiver's plane.
        let (position, aim) = (DVec3::Z * 10.0, DVec3::new(10.0, 0.0, 0.0));
        let form = rectangle_form(position, aim, DVec2::splat(5000.0), DVec3::ZERO);
        assert!(form > 0.0 && form < PI, "{form}");
    }

    #[test]
    fn a_lamps_width_is_parallel_to_the_sheet() {
        let [width, height, axis] = area_axes(DVec3::new(-500.0, 0.0, 100.0), DVec3::ZERO).unwrap();
        assert_eq!(width.z, 0.0);
        close(width.cross(height).dot(-axis), 1.0, 1e-12);
        let [width, ..] = area_axes(DVec3::Z * 500.0, DVec3::ZERO).unwrap();
        assert_eq!(width, DVec3::X);
    }
}
