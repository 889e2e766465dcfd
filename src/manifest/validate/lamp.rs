//! Lamps: places from angles, and every photometric unit into the one that is calculated with.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::{
    super::{
        decode::{Brief, List, Pattern},
        document::{Trail, Words},
        exhibit::{Exhibit, Lamp, LampColour, LampKind, Wording},
        raw::{
            RawManifest,
            lamp::{RawLamp, RawLampCommon, RawLampKind, RawSpectrum, Stand},
            values::{
                LampCandela, LampEfficacy, LampLumen, LampLux, LampNits, LampWatts, PositionMm,
            },
        },
        save::written::same_lamp,
    },
    Validator,
};
use crate::{
    optics::{lamp::DISTANCE2_MIN_MM2, lamp_units, quadrature::GRIDS, spectrum},
    units::{Candela, Degrees, Kelvin, Lux, Nits},
};

/// Daylight, and what a display shows as neutral unless a scene says otherwise.
pub(in super::super) const DAYLIGHT_K: f64 = 6504.0;
/// The id of the lamp that a manifest without lamps has.
pub(super) const DEFAULT_ID: &str = "reference";
/// Where a lamp stands whose distance is not given: a copy stand's arm.
const DEFAULT_DISTANCE_MM: f64 = 600.0;

/// How near to the plane of the sheet a lamp can be.
const LOWEST_MM: f64 = 1.0;

/// The luminous flux that a lamp is given, in lm or as watts times efficacy.
macro_rules! flux {
    ($lamp:expr) => {
        flux($lamp.lumen, $lamp.watts, $lamp.efficacy_lm_per_w)
    };
}

/// The lamp of a manifest without lamps.
fn usual_lamp() -> Lamp {
    Lamp {
        id: DEFAULT_ID.to_owned(),
        title: Wording::default(),
        colour: LampColour::Temperature(Kelvin(DAYLIGHT_K)),
        kind: LampKind::Distant {
            illuminance: Lux(1000.0),
            elevation: Degrees(45.0),
            azimuth: Degrees(135.0),
        },
        written: None,
    }
}

/// The lamps of a manifest without lamps, as it could write them.
pub(in super::super) fn usual_lamps() -> impl Iterator<Item = RawLamp> {
    same_lamp(&usual_lamp()).into_iter()
}

impl Validator<'_, '_> {
    /// The lamps of the manifest, or the reference lamp: distant, 1000 lx, from the top left at
    /// 45°, in the light that is shown as neutral, so that a photograph looks as it is.
    pub(super) fn lamps(&mut self, raw: &RawManifest, trail: &Trail) -> Option<Vec<Lamp>> {
        let Some(lamps) = &raw.lamp else {
            return Some(vec![usual_lamp()]);
        };
        let lamps: Vec<_> = List::iter(lamps)
            .map(|(i, lamp)| self.lamp(lamp, &trail.index(i)))
            .collect();
        lamps.into_iter().collect()
    }

    /// One lamp, written at `trail`.
    pub(super) fn lamp(&mut self, raw: &RawLamp, trail: &Trail) -> Option<Lamp> {
        let id = raw.common.id.as_str().to_owned();
        let title = self.wording(raw.common.title.as_ref(), &trail.key("title"));
        let colour = self.lamp_colour(&raw.common, trail);
        let kind = self.lamp_kind(raw, trail)?;
        Some(Lamp {
            id,
            title,
            colour: colour?,
            kind,
            written: Some(Arc::new(raw.clone())),
        })
    }

    fn lamp_colour(&mut self, raw: &RawLampCommon, trail: &Trail) -> Option<LampColour> {
        let trail = trail.key("spectrum");
        let xy = match &raw.spectrum {
            None => {
                let kelvin = raw.kelvin.map_or(DAYLIGHT_K, |kelvin| kelvin.0);
                return Some(LampColour::Temperature(Kelvin(kelvin)));
            }
            Some(Brief::Short(illuminant)) => illuminant.xy(),
            Some(Brief::Full(RawSpectrum {
                file: Some(file), ..
            })) => self.spectrum_file(file, &trail.key("file"))?,
            Some(Brief::Full(raw)) => {
                let wavelengths: Vec<f64> = raw
                    .wavelengths_nm
                    .as_ref()?
                    .iter()
                    .map(|(_, nm)| nm.0)
                    .collect();
                let power: Vec<f64> = raw.power.as_ref()?.iter().map(|(_, p)| p.0).collect();
                match spectrum::chromaticity(&wavelengths, &power) {
                    Ok(xy) => xy,
                    Err(error) => {
                        self.report.fault(&trail, spectrum_words(error.to_string()));
                        return None;
                    }
                }
            }
        };
        Some(LampColour::Chromaticity(xy))
    }

    fn lamp_kind(&mut self, raw: &RawLamp, trail: &Trail) -> Option<LampKind> {
        match &raw.kind {
            RawLampKind::Distant(lamp) => Some(LampKind::Distant {
                illuminance: Lux(lamp.lux_at_sheet.0),
                elevation: Degrees(lamp.elevation_deg.0),
                azimuth: Degrees(lamp.azimuth_deg.0),
            }),
            RawLampKind::Point(lamp) => {
                let position_mm = self.stand(&lamp.stand(), trail)?;
                let intensity = intensity(
                    (lamp.lux_at_sheet, lamp.candela, flux!(lamp)),
                    position_mm,
                    lamp_units::point_intensity,
                )?;
                Some(LampKind::Point {
                    intensity: Candela(intensity),
                    position_mm,
                })
            }
            RawLampKind::Spot(lamp) => {
                let (hotspot, falloff) = (lamp.hotspot_deg.0, lamp.falloff_deg.0);
                let position_mm = self.stand(&lamp.stand(), trail);
                if hotspot > falloff {
                    let words = Words::new(
                        format!("{hotspot}°, wider than falloff_deg"),
                        format!("at most falloff_deg, {falloff}°"),
                        "exchange the two or widen falloff_deg",
                    );
                    self.report.fault(&trail.key("hotspot_deg"), words);
                    return None;
                }
                let position_mm = position_mm?;
                let aim_mm = self.aim(lamp.aim_mm, position_mm, trail)?;
                let cosines = [hotspot, falloff].map(|degrees| degrees.to_radians().cos());
                let [cos_hotspot, cos_falloff] = cosines;
                let axis = (aim_mm - position_mm).normalize();
                let cos = axis.dot(-position_mm.normalize());
                let share = lamp_units::spot_share(cos, cos_hotspot, cos_falloff);
                if lamp.lux_at_sheet.is_some() && share == 0.0 {
                    self.sheet_unlit(trail);
                    return None;
                }
                let intensity = intensity(
                    (
                        lamp.lux_at_sheet.map(|lux| LampLux(lux.0 / share)),
                        lamp.candela,
                        flux!(lamp),
                    ),
                    position_mm,
                    |lumen| lamp_units::spot_intensity(lumen, cos_hotspot, cos_falloff),
                )?;
                Some(LampKind::Spot {
                    intensity: Candela(intensity),
                    position_mm,
                    aim_mm,
                    hotspot: Degrees(hotspot),
                    falloff: Degrees(falloff),
                })
            }
            RawLampKind::Rectangle(lamp) => {
                let size_mm = DVec2::from(lamp.size_mm.map(|mm| mm.0));
                let position_mm = self.stand(&lamp.stand(), trail)?;
                let aim_mm = self.aim(lamp.aim_mm, position_mm, trail)?;
                self.clear_of_the_sheet(position_mm, aim_mm, size_mm.y, trail)?;
                let form = lamp_units::rectangle_form(position_mm, aim_mm, size_mm, DVec3::ZERO);
                let light = (lamp.lux_at_sheet, lamp.nits, flux!(lamp));
                let luminance = self.luminance(light, form, size_mm.x * size_mm.y, trail)?;
                Some(LampKind::Rectangle {
                    luminance,
                    position_mm,
                    aim_mm,
                    size_mm,
                })
            }
            RawLampKind::Disc(lamp) => {
                let diameter_mm = lamp.diameter_mm.0;
                let position_mm = self.stand(&lamp.stand(), trail)?;
                let aim_mm = self.aim(lamp.aim_mm, position_mm, trail)?;
                self.clear_of_the_sheet(position_mm, aim_mm, diameter_mm, trail)?;
                let form = lamp_units::disc_form(position_mm, aim_mm, diameter_mm, DVec3::ZERO);
                let area = std::f64::consts::PI * diameter_mm * diameter_mm / 4.0;
                let light = (lamp.lux_at_sheet, lamp.nits, flux!(lamp));
                let luminance = self.luminance(light, form, area, trail)?;
                Some(LampKind::Disc {
                    luminance,
                    position_mm,
                    aim_mm,
                    diameter_mm,
                })
            }
            RawLampKind::Ies(lamp) => {
                let photometry = self.photometry(&lamp.file, &trail.key("file"));
                let position_mm = self.stand(&lamp.stand(), trail)?;
                let aim_mm = self.aim(lamp.aim_mm, position_mm, trail)?;
                Some(LampKind::Ies {
                    photometry: Arc::new(photometry?),
                    position_mm,
                    aim_mm,
                })
            }
            RawLampKind::LightTable(lamp) => Some(LampKind::LightTable {
                luminance: Nits(lamp.nits.0),
            }),
        }
    }

    /// Where a lamp stands in the table frame, above the sheet.
    fn stand(&mut self, stand: &Stand, trail: &Trail) -> Option<DVec3> {
        if let Some(position) = stand.position_mm {
            let position = vector(position);
            if position.z >= LOWEST_MM {
                return Some(position);
            }
            let words = Words::new(
                format!("a lamp {} mm above the plane of the sheet", position.z),
                format!("a third coordinate of at least {LOWEST_MM} mm"),
                "raise the lamp; light through the sheet comes from kind = \"light-table\"",
            );
            self.report.fault(&trail.key("position_mm").index(2), words);
            return None;
        }
        let elevation = stand.elevation_deg?.0.to_radians();
        let azimuth = stand.azimuth_deg?.0.to_radians();
        let distance = stand.distance_mm.map_or(DEFAULT_DISTANCE_MM, |mm| mm.0);
        let (sin, cos) = elevation.sin_cos();
        Some(DVec3::new(cos * azimuth.cos(), cos * azimuth.sin(), sin) * distance)
    }

    /// Finds out whether a flat lamp, so high across its horizontal edge, ends above the plane of the
    /// sheet.
    fn clear_of_the_sheet(
        &mut self,
        position: DVec3,
        aim: DVec3,
        height_mm: f64,
        trail: &Trail,
    ) -> Option<()> {
        let [_, up, _] = lamp_units::area_axes(position, aim)?;
        let lowest = position.z - 0.5 * height_mm * up.z.abs();
        if lowest >= LOWEST_MM {
            return Some(());
        }
        let found = if lowest < 0.0 {
            format!(
                "a lamp that reaches {:.1} mm below the plane of the sheet",
                -lowest
            )
        } else {
            format!("a lamp that ends {lowest:.1} mm above the plane of the sheet")
        };
        let allowed = format!("all of it at least {LOWEST_MM} mm above");
        let words = Words::new(found, allowed, "raise the lamp or make it smaller");
        self.report.fault(trail, words);
        None
    }

    /// Warns of flat lamps so near to a sheet that the points they are sampled at are seen.
    pub(super) fn near_lamps(&mut self, exhibit: &Exhibit, trail: &Trail) {
        /// Points are this many along an edge, and light from one of them is wrong nearer than
        /// they are to each other.
        const POINTS: f64 = *GRIDS.end() as f64;
        for (i, lamp) in exhibit.lamps.iter().enumerate() {
            let (position, aim, size) = match lamp.kind {
                LampKind::Rectangle {
                    position_mm,
                    aim_mm,
                    size_mm,
                    ..
                } => (position_mm, aim_mm, size_mm),
                LampKind::Disc {
                    position_mm,
                    aim_mm,
                    diameter_mm,
                    ..
                } => (position_mm, aim_mm, DVec2::splat(diameter_mm)),
                _ => continue,
            };
            let Some([across, up, _]) = lamp_units::area_axes(position, aim) else {
                continue;
            };
            let lit = exhibit.scenes.iter().filter(|s| s.lamps.contains(&i));
            let nearest = lit
                .map(|scene| {
                    let half = exhibit.drawing_of(scene).size_mm / 2.0;
                    let places = (0..=8).flat_map(|u| (0..=8).map(move |v| [u, v]));
                    let distances = places.map(|place| {
                        let [u, v] = place.map(|k| f64::from(k) / 8.0 - 0.5);
                        let p = position + across * (u * size.x) + up * (v * size.y);
                        let on_sheet = p.truncate().clamp(-half, half);
                        p.distance(on_sheet.extend(0.0))
                    });
                    distances.fold(f64::INFINITY, f64::min)
                })
                .fold(f64::INFINITY, f64::min);
            let least = size.max_element() / POINTS;
            if nearest < least {
                let words = Words::new(
                    format!(
                        "a lamp of {} × {} mm that comes as near as {nearest:.0} mm to the sheet",
                        size.x, size.y
                    ),
                    format!(
                        "at least {least:.0} mm, a {POINTS}th of its longer edge: nearer, the \
                         points that it is sampled at are seen"
                    ),
                    "move the lamp away, or make several smaller ones of it",
                );
                self.report.warn(&trail.index(i), words);
            }
        }
    }

    fn aim(
        &mut self,
        aim: Option<[PositionMm; 3]>,
        position: DVec3,
        trail: &Trail,
    ) -> Option<DVec3> {
        let aim = aim.map_or(DVec3::ZERO, vector);
        if aim.distance(position) >= 1.0 {
            return Some(aim);
        }
        let words = Words::new(
            "an aim at the lamp's own place",
            "a place at least 1 mm away from it",
            "aim at the sheet, or leave aim_mm out",
        );
        self.report.fault(&trail.key("aim_mm"), words);
        None
    }

    fn luminance(
        &mut self,
        light: (Option<LampLux>, Option<LampNits>, Option<LampLumen>),
        form: f64,
        area_mm2: f64,
        trail: &Trail,
    ) -> Option<Nits> {
        match light {
            (Some(_), _, _) if form <= 0.0 => {
                self.sheet_unlit(trail);
                None
            }
            (Some(lux), _, _) => Some(Nits(lux.0 / form)),
            (_, Some(nits), _) => Some(Nits(nits.0)),
            (_, _, Some(lumen)) => Some(Nits(lamp_units::area_luminance(lumen.0, area_mm2))),
            (None, None, None) => None,
        }
    }

    fn sheet_unlit(&mut self, trail: &Trail) {
        let words = Words::new(
            "an illuminance of the sheet's centre, which the lamp does not shine at",
            "a lamp whose light reaches the centre",
            "correct aim_mm, or give the lamp's own strength instead",
        );
        self.report.fault(&trail.key("lux_at_sheet"), words);
    }
}

/// What is wrong with a table of spectral power.
pub(super) fn spectrum_words(found: String) -> Words {
    let allowed = "rising wavelengths in nm, each with a power from zero up, some of it visible";
    Words::new(
        found,
        allowed,
        "correct the table, or name an illuminant such as \"LED-B3\"",
    )
}

/// Φ = P·η where a lamp has watts, otherwise the flux that is given.
fn flux(
    lumen: Option<LampLumen>,
    watts: Option<LampWatts>,
    efficacy: Option<LampEfficacy>,
) -> Option<LampLumen> {
    lumen.or_else(|| Some(LampLumen(watts?.0 * efficacy?.0)))
}

/// The intensity of a small lamp in cd from the one unit that is given.
fn intensity(
    light: (Option<LampLux>, Option<LampCandela>, Option<LampLumen>),
    position_mm: DVec3,
    from_flux: impl FnOnce(f64) -> f64,
) -> Option<f64> {
    match light {
        (Some(lux), _, _) => {
            // Light is calculated as from no nearer, and the sheet is to get what was asked for.
            let distance_mm = position_mm.length().max(DISTANCE2_MIN_MM2.sqrt());
            Some(lamp_units::intensity_for(lux.0, distance_mm))
        }
        (_, Some(candela), _) => Some(candela.0),
        (_, _, Some(lumen)) => Some(from_flux(lumen.0)),
        (None, None, None) => None,
    }
}

fn vector(mm: [PositionMm; 3]) -> DVec3 {
    DVec3::from(mm.map(|mm| mm.0))
}
