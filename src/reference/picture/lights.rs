//! Lamps as a walk meets them: one point of each for every path.

use glam::{DMat3, DVec3};

use super::shape::{Hit, LIFT_MM, Ray, Shape};
use crate::{
    optics::lamp::{DISTANCE2_MIN_MM2, Light, Shape as LampShape},
    reference::{
        radiance::Lamp,
        rng::{Rng, disc, uniform},
    },
};

/// Light that comes to a point.
pub(super) struct Arriving {
    /// Unit vector towards the lamp, in the frame of the lamps.
    pub towards: DVec3,
    /// On a plane that faces it, in the unit of [`Light::amount`].
    pub irradiance: DVec3,
    /// In mm; infinite for a distant lamp.
    pub distance: f64,
}

/// Light from one point of `light`, chosen evenly over its area, at `point`.
pub(super) fn arriving(light: &Light, point: DVec3, rng: &mut Rng) -> Arriving {
    let from = |place: DVec3, emits: &dyn Fn(DVec3) -> f64| {
        let way = place - point;
        let distance_2 = way.length_squared();
        let distance = distance_2.sqrt();
        let towards = way / distance.max(1e-6);
        Arriving {
            towards,
            irradiance: light.amount * (emits(towards) / distance_2.max(DISTANCE2_MIN_MM2)),
            distance,
        }
    };
    let facet = |axis: DVec3| move |towards: DVec3| (-axis.dot(towards)).max(0.0);
    match light.shape {
        LampShape::Distant { towards } => Arriving {
            towards,
            irradiance: light.amount,
            distance: f64::INFINITY,
        },
        LampShape::Point { position } => from(position, &|_| 1.0),
        LampShape::Spot {
            position,
            axis,
            cos_hotspot,
            cos_falloff,
        } => {
            let width = (cos_hotspot - cos_falloff).max(1e-6);
            from(position, &|towards| {
                ((-axis.dot(towards) - cos_falloff) / width).clamp(0.0, 1.0)
            })
        }
        LampShape::Rectangle {
            centre,
            axis,
            half_u,
            half_v,
            ..
        } => {
            let (u, v) = (2.0 * uniform(rng) - 1.0, 2.0 * uniform(rng) - 1.0);
            from(centre + half_u * u + half_v * v, &facet(axis))
        }
        LampShape::Disc {
            centre,
            axis,
            half_u,
            half_v,
            ..
        } => {
            let (u, v, _) = disc(rng);
            from(centre + half_u * u + half_v * v, &facet(axis))
        }
        LampShape::Ies {
            position,
            axis,
            across_u,
            across_v,
            ref photometry,
        } => from(position, &|towards| {
            let (u, v) = (-across_u.dot(towards), -across_v.dot(towards));
            let gamma = u.hypot(v).atan2(0.0 - axis.dot(towards));
            photometry.intensity(gamma, v.atan2(u)) / photometry.peak()
        }),
    }
}

/// The lamps that reach a point of the sheet, in the frame `local` (columns are its axes, the last
/// one the normal of the relief). `is_lit` says whether the relief lets through light along a
/// direction of the macroscopic frame.
pub(super) fn gather(
    lights: &[Light],
    hit: &Hit,
    local: &DMat3,
    shape: &Shape,
    mut is_lit: impl FnMut(DVec3, &mut Rng) -> bool,
    lamps: &mut Vec<Lamp<3>>,
    rng: &mut Rng,
) {
    lamps.clear();
    for light in lights {
        let Arriving {
            towards,
            irradiance,
            distance,
        } = arriving(light, hit.point, rng);
        let direction = local.transpose() * towards;
        let before = hit.normal.dot(towards);
        // A facet and the sheet's plane must face the lamp from the same side.
        if irradiance == DVec3::ZERO || before * direction.z <= 0.0 {
            continue;
        }
        if before > 0.0 {
            let ray = Ray {
                origin: hit.point + hit.normal * LIFT_MM,
                direction: towards,
            };
            if !is_lit(towards, rng) || shape.hides(&ray, distance) {
                continue;
            }
        }
        lamps.push(Lamp {
            direction,
            irradiance: irradiance.to_array(),
        });
    }
}
