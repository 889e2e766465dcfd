//! A scene's lamps as light: colour, exposure and shape, ready for any renderer.

use std::{f64::consts::PI, sync::Arc};

use glam::{DVec2, DVec3};

use super::exhibit::{Exhibit, LampColour, LampKind, Scene};
use crate::{
    colour,
    optics::{
        lamp::{Light, Shape},
        lamp_units::area_axes,
        photometry::Photometry,
    },
    units::{Degrees, Kelvin},
};

/// Linear level, relative to a perfect diffuser, of the dark table that the sheet lies on.
pub const TABLE: f32 = 0.012;
/// Square millimetres in a square metre: intensities in candela meet distances in mm.
const MM2_PER_M2: f64 = 1e6;
/// A lamp that lights the sheet by less than this is taken for darkness, in lx.
const DARK_LUX: f64 = 1e-9;

/// Transmittance of the diffuser by which a light table anchors an undeclared exposure. A thin
/// sheet of drawing paper passes .15 to .3 of diffuse light (slab of OPTICS.md: .18 at 262 µm),
/// so at a quarter bare paper comes out near what it shows in reflected light, and a watermark
/// still has room above it.
const TABLE_TRANSMITTANCE: f64 = 0.25;

/// The light of a scene in the table frame, pre-exposed: a perfect diffuser facing the
/// reference illuminance shows 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Lighting {
    pub lights: Vec<Light>,
    /// Illuminance of the room's even light, in the unit of [`Light::amount`].
    pub ambient: DVec3,
    /// Radiance of the light tables behind the sheet, times π over the reference illuminance:
    /// in the unit in which a perfect diffuser at that illuminance shows 1. A Lambertian
    /// emitter that covers the whole back of the sheet and gives the front no light, so it is
    /// none of `lights`.
    pub light_table: DVec3,
    /// The reference illuminance, declared or found, in lx.
    pub reference_lux: f64,
}

impl Lighting {
    /// The photometric files of the IES lamps, in the order of `lights`.
    pub fn photometry(&self) -> Vec<Arc<Photometry>> {
        self.lights
            .iter()
            .filter_map(|light| match &light.shape {
                Shape::Ies { photometry, .. } => Some(Arc::clone(photometry)),
                _ => None,
            })
            .collect()
    }
}

impl Exhibit {
    /// The light of `scene`.
    pub fn lighting(&self, scene: &Scene) -> Lighting {
        let white = scene.exposure.white;
        // First in photometric units; the exposure follows.
        let mut lights: Vec<Light> = scene
            .lamps
            .iter()
            .filter_map(|&lamp| {
                let lamp = &self.lamps[lamp];
                let (shape, amount) = shape(&lamp.kind)?;
                Some(Light {
                    shape,
                    amount: tint(lamp.colour, white) * amount,
                })
            })
            .collect();
        let mut light_table: DVec3 = scene
            .lamps
            .iter()
            .filter_map(|&lamp| {
                let lamp = &self.lamps[lamp];
                match lamp.kind {
                    LampKind::LightTable { luminance } => {
                        Some(tint(lamp.colour, white) * luminance.0)
                    }
                    _ => None,
                }
            })
            .sum();
        let ambient_lux = scene.ambient.illuminance.0;
        let reference_lux = scene.exposure.illuminance.map_or_else(
            || {
                let lit: DVec3 = lights
                    .iter()
                    .map(|light| light.illuminance(DVec3::ZERO, DVec3::Z))
                    .sum();
                // A sheet lit from both sides shows the sum of both.
                let through = light_table_lux(colour::luminance(light_table.to_array()));
                let lux = colour::luminance(lit.to_array()) + ambient_lux + through;
                if lux > DARK_LUX { lux } else { 1.0 }
            },
            |lux| lux.0,
        );
        let exposure = PI / reference_lux;
        for light in &mut lights {
            light.amount *= exposure;
        }
        light_table *= exposure;
        let mut ambient =
            tint(LampColour::Temperature(scene.ambient.kelvin), white) * (ambient_lux * exposure);
        if scene.transmitted > 0.0 {
            // From lamps alone to a neutral light table alone, under which an ordinary sheet looks as
            // bright.
            let reflected = 1.0 - scene.transmitted;
            for light in &mut lights {
                light.amount *= reflected;
            }
            ambient *= reflected;
            light_table += DVec3::splat(scene.transmitted / TABLE_TRANSMITTANCE);
        }
        Lighting {
            lights,
            ambient,
            light_table,
            reference_lux,
        }
    }
}

/// Illuminance, in lx, on the front of a white sheet that would look as bright as a light table
/// of `nits` does through an ordinary sheet: π·L·t.
pub fn light_table_lux(nits: f64) -> f64 {
    PI * nits * TABLE_TRANSMITTANCE
}

/// Linear sRGB of unit luminance for a lamp seen by an eye adapted to `white`.
fn tint(lamp: LampColour, white: Kelvin) -> DVec3 {
    DVec3::from_array(match lamp {
        LampColour::Temperature(kelvin) => colour::lamp_rgb(kelvin.0, white.0),
        LampColour::Chromaticity(xy) => colour::lamp_xy_rgb(xy, white.0),
    })
}

/// Unit vector in the table frame: azimuth 0° is right and 90° the top edge.
pub fn direction(elevation: Degrees, azimuth: Degrees) -> DVec3 {
    let (sin_e, cos_e) = elevation.radians().sin_cos();
    let (sin_a, cos_a) = azimuth.radians().sin_cos();
    DVec3::new(cos_e * cos_a, cos_e * sin_a, sin_e)
}

/// Shape and unexposed amount; `None` for a light table, which lights neither side.
fn shape(kind: &LampKind) -> Option<(Shape, f64)> {
    Some(match *kind {
        LampKind::Distant {
            illuminance,
            elevation,
            azimuth,
        } => (
            Shape::Distant {
                towards: direction(elevation, azimuth),
            },
            illuminance.0,
        ),
        LampKind::Point {
            intensity,
            position_mm,
        } => (
            Shape::Point {
                position: position_mm,
            },
            intensity.0 * MM2_PER_M2,
        ),
        LampKind::Spot {
            intensity,
            position_mm,
            aim_mm,
            hotspot,
            falloff,
        } => {
            let shape = Shape::Spot {
                position: position_mm,
                axis: (aim_mm - position_mm).normalize_or(-DVec3::Z),
                cos_hotspot: hotspot.radians().cos(),
                cos_falloff: falloff.radians().cos(),
            };
            (shape, intensity.0 * MM2_PER_M2)
        }
        LampKind::Rectangle {
            luminance,
            position_mm,
            aim_mm,
            size_mm,
        } => {
            // L·A with A in m² is a candela; mm² for m² cancels MM2_PER_M2.
            let amount = luminance.0 * size_mm.x * size_mm.y;
            (rectangle(position_mm, aim_mm, size_mm), amount)
        }
        LampKind::Disc {
            luminance,
            position_mm,
            aim_mm,
            diameter_mm,
        } => {
            let radius = diameter_mm / 2.0;
            let amount = luminance.0 * PI * radius * radius;
            (disc(position_mm, aim_mm, radius), amount)
        }
        LampKind::Ies {
            ref photometry,
            position_mm,
            aim_mm,
        } => {
            let [across_u, across_v, axis] =
                area_axes(position_mm, aim_mm).unwrap_or([DVec3::X, DVec3::Y, -DVec3::Z]);
            let shape = Shape::Ies {
                position: position_mm,
                axis,
                across_u,
                across_v,
                photometry: Arc::clone(photometry),
            };
            (shape, photometry.peak() * MM2_PER_M2)
        }
        LampKind::LightTable { .. } => return None,
    })
}

/// A rectangle at `centre` that faces `aim`, its width horizontal, sampled finely enough for
/// how large it looks from there.
fn rectangle(centre: DVec3, aim: DVec3, size_mm: DVec2) -> Shape {
    // A lamp that aims at itself was refused; straight down is as good as any.
    let [u, v, axis] = area_axes(centre, aim).unwrap_or([DVec3::X, DVec3::Y, -DVec3::Z]);
    let apparent = size_mm.max_element() / (aim - centre).length().max(1e-6);
    let (half_u, half_v) = (u * (size_mm.x / 2.0), v * (size_mm.y / 2.0));
    Shape::Rectangle {
        centre,
        axis,
        half_u,
        half_v,
        grid: grid_for(apparent),
    }
}

/// A disc at `centre` that faces `aim`.
fn disc(centre: DVec3, aim: DVec3, radius: f64) -> Shape {
    let [u, v, axis] = area_axes(centre, aim).unwrap_or([DVec3::X, DVec3::Y, -DVec3::Z]);
    let apparent = 2.0 * radius / (aim - centre).length().max(1e-6);
    Shape::Disc {
        centre,
        axis,
        half_u: u * radius,
        half_v: v * radius,
        rings: rings_for(apparent),
    }
}

/// In how many rings to sample a disc whose diameter is `apparent` times its distance.
pub fn rings_for(apparent: f64) -> u32 {
    match apparent {
        a if a < 0.3 => 1,
        a if a < 1.0 => 2,
        a if a < 2.0 => 3,
        _ => 5,
    }
}

/// How finely to sample a rectangle whose longer edge is `apparent` times its distance.
pub fn grid_for(apparent: f64) -> u32 {
    match apparent {
        a if a < 0.3 => 2,
        a if a < 1.0 => 3,
        a if a < 2.0 => 5,
        _ => 7,
    }
}
