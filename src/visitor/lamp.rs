//! Where a lamp stands, as a hand moves it about the sheet's centre.

use glam::{DVec2, DVec3};

use crate::{
    manifest::{
        exhibit::{Lamp, LampKind},
        lighting::direction,
    },
    units::Degrees,
};

/// A hand brings no lamp lower than this, in degrees: below, only dust is lit.
pub const LOWEST_DEG: f64 = 3.0;
/// Between a large lamp's edge and the table.
const CLEARANCE_MM: f64 = 10.0;
/// Higher than this, in degrees, a direction is not worth naming.
const OVERHEAD_DEG: f64 = 88.0;

/// The direction towards a lamp from the centre of the sheet at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LampPlace {
    /// Above the table, up to 90°.
    pub elevation_deg: f64,
    /// Anticlockwise from the right edge, 0…360°; kept when the lamp stands straight above.
    pub azimuth_deg: f64,
}

impl LampPlace {
    /// Where `lamp` stands; `None` for one that cannot be moved about.
    pub fn of(lamp: &Lamp) -> Option<Self> {
        match lamp.kind {
            LampKind::Distant {
                elevation, azimuth, ..
            } => Some(Self {
                elevation_deg: elevation.0,
                azimuth_deg: azimuth.0.rem_euclid(360.0),
            }),
            LampKind::Point { position_mm, .. }
            | LampKind::Spot { position_mm, .. }
            | LampKind::Rectangle { position_mm, .. }
            | LampKind::Disc { position_mm, .. }
            | LampKind::Ies { position_mm, .. } => Self::towards(position_mm),
            LampKind::LightTable { .. } => None,
        }
    }

    fn towards(position: DVec3) -> Option<Self> {
        let to = position.try_normalize()?;
        Some(Self {
            elevation_deg: to.z.asin().to_degrees(),
            azimuth_deg: to.y.atan2(to.x).to_degrees().rem_euclid(360.0),
        })
    }

    /// Puts `lamp` here, at the distance that it has; a large one no lower than that all of it
    /// stays above the table.
    pub fn put(self, lamp: &mut Lamp) {
        let across_mm = match lamp.kind {
            LampKind::Rectangle { size_mm, .. } => size_mm.length(),
            LampKind::Disc { diameter_mm, .. } => diameter_mm,
            _ => 0.0,
        };
        if let LampKind::Rectangle { position_mm, .. } | LampKind::Disc { position_mm, .. } =
            lamp.kind
        {
            // It faces the sheet: what stands below its middle is half of it, foreshortened.
            let lowest = (across_mm / 2.0 + CLEARANCE_MM).atan2(position_mm.length());
            let elevation_deg = self.elevation_deg.max(lowest.to_degrees());
            return Self {
                elevation_deg,
                ..self
            }
            .place(lamp);
        }
        self.place(lamp);
    }

    fn place(self, lamp: &mut Lamp) {
        let towards = direction(Degrees(self.elevation_deg), Degrees(self.azimuth_deg));
        match &mut lamp.kind {
            LampKind::Distant {
                elevation, azimuth, ..
            } => {
                *elevation = Degrees(self.elevation_deg);
                *azimuth = Degrees(self.azimuth_deg);
            }
            LampKind::Point { position_mm, .. }
            | LampKind::Spot { position_mm, .. }
            | LampKind::Rectangle { position_mm, .. }
            | LampKind::Disc { position_mm, .. }
            | LampKind::Ies { position_mm, .. } => {
                *position_mm = towards * position_mm.length();
            }
            LampKind::LightTable { .. } => {}
        }
    }

    /// Moved over the hemisphere as seen from above, by parts of its radius: whichever way the
    /// hand goes, the lamp goes.
    pub fn moved(self, by: DVec2) -> Self {
        let seen = self.seen() + by;
        let radius = seen.length().min(LOWEST_DEG.to_radians().cos());
        Self {
            elevation_deg: radius.acos().to_degrees(),
            azimuth_deg: if radius > 1e-9 {
                seen.y.atan2(seen.x).to_degrees().rem_euclid(360.0)
            } else {
                self.azimuth_deg
            },
        }
    }

    /// Its place over the hemisphere as seen from above, of its radius.
    pub fn seen(self) -> DVec2 {
        DVec2::from_angle(self.azimuth_deg.to_radians()) * self.elevation_deg.to_radians().cos()
    }

    /// At this place over the hemisphere as seen from above.
    pub fn to(self, seen: DVec2) -> Self {
        self.moved(seen - self.seen())
    }

    /// At this azimuth, in degrees.
    pub fn towards_deg(self, azimuth_deg: f64) -> Self {
        Self {
            azimuth_deg: azimuth_deg.rem_euclid(360.0),
            ..self
        }
    }

    /// Raised or lowered to `elevation_deg`.
    pub fn raised(self, elevation_deg: f64) -> Self {
        Self {
            elevation_deg: elevation_deg.clamp(LOWEST_DEG, 90.0),
            ..self
        }
    }

    /// Which of eight directions it shines from, as wordings call it; none from straight above.
    pub fn sector(self) -> Option<&'static str> {
        const FROM: [&str; 8] = [
            "right",
            "upper-right",
            "top",
            "upper-left",
            "left",
            "lower-left",
            "bottom",
            "lower-right",
        ];
        let sector = (self.azimuth_deg / 45.0).round() as usize % FROM.len();
        (self.elevation_deg < OVERHEAD_DEG).then_some(FROM[sector])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        manifest::exhibit::{LampColour, Wording},
        units::{Candela, Kelvin, Nits},
    };

    fn raking() -> LampPlace {
        LampPlace {
            elevation_deg: 12.0,
            azimuth_deg: 180.0,
        }
    }

    #[test]
    fn a_lamp_goes_the_way_the_hand_goes() {
        let up = raking().moved(DVec2::new(0.0, 0.5));
        assert!(up.azimuth_deg > 90.0 && up.azimuth_deg < 180.0);
        let across = raking().moved(DVec2::new(2.0, 0.0));
        assert!(across.azimuth_deg.to_radians().cos() > 0.999);
        let out = raking().moved(DVec2::new(-5.0, 0.0));
        assert!((out.elevation_deg - LOWEST_DEG).abs() < 1e-9);
    }

    #[test]
    fn overhead_keeps_the_direction_to_come_back_from() {
        let overhead = raking().raised(90.0);
        assert_eq!(overhead.sector(), None);
        assert_eq!(overhead.raised(12.0).sector(), Some("left"));
    }

    #[test]
    fn a_large_lamp_stays_above_the_table() {
        let mut lamp = Lamp {
            id: "large".into(),
            title: Wording::default(),
            colour: LampColour::Temperature(Kelvin(3000.0)),
            kind: LampKind::Disc {
                luminance: Nits(1000.0),
                position_mm: DVec3::new(0.0, 0.0, 400.0),
                aim_mm: DVec3::ZERO,
                diameter_mm: 300.0,
            },
            written: None,
        };
        raking().put(&mut lamp);
        let place = LampPlace::of(&lamp).expect("it has a place");
        let lowest = 400.0 * place.elevation_deg.to_radians().sin()
            - 150.0 * place.elevation_deg.to_radians().cos();
        assert!((5.0..15.0).contains(&lowest), "{lowest}");
    }

    #[test]
    fn a_near_lamp_keeps_its_distance() {
        let mut lamp = Lamp {
            id: "near".into(),
            title: Wording::default(),
            colour: LampColour::Temperature(Kelvin(3000.0)),
            kind: LampKind::Point {
                intensity: Candela(10.0),
                position_mm: DVec3::new(-300.0, 0.0, 400.0),
            },
            written: None,
        };
        raking().put(&mut lamp);
        let place = LampPlace::of(&lamp).expect("it has a place");
        assert!((place.elevation_deg - 12.0).abs() < 1e-9);
        let LampKind::Point { position_mm, .. } = lamp.kind else {
            unreachable!("its kind stays");
        };
        assert!((position_mm.length() - 500.0).abs() < 1e-9 && position_mm.x < 0.0);
    }
}
