//! Lamps: enough of them, not all in one plane, and as many of everything.

use std::path::PathBuf;

use glam::DVec3;

use super::{
    super::{
        Circle, Intensities, Lamps, Light, MAX_LAMPS, MIN_LAMPS, Places, Shots, Sphere,
        raw::{RawCapture, RawLamps, RawSphere},
        values::Each,
    },
    Validator,
};
use crate::{
    manifest::{
        decode::List,
        document::{Trail, Words},
        quote,
    },
    prepare::lights::{self, direction, lp},
};

/// What a usual grey card reflects.
const GREY_CARD: f64 = 0.18;

/// Lamps as far as they are known without photographs.
pub(super) struct Placed {
    pub places: Places,
    /// Photographs that a file of lamps names.
    pub named: Vec<PathBuf>,
}

impl Placed {
    /// How many lamps there are; a ball in the recto's photographs shows as many as these are.
    pub fn count(&self, recto: Option<&Shots>) -> Option<usize> {
        match &self.places {
            Places::Directions(places) | Places::Positions(places) => Some(places.len()),
            Places::Sphere(sphere) if !sphere.photographs.is_empty() => {
                Some(sphere.photographs.len())
            }
            Places::Sphere(_) => Some(recto?.photographs.len()),
        }
    }
}

impl Validator<'_, '_> {
    /// Where the lamps stand.
    pub(super) fn placed(&mut self, raw: &RawLamps, trail: &Trail) -> Option<Placed> {
        let places = if let Some(list) = &raw.azimuth_deg {
            self.around(raw, list, trail)?
        } else if let Some(list) = &raw.position_mm {
            let trail = trail.key("position_mm");
            let mut sound = !list.has_holes();
            let mut positions = Vec::new();
            for (i, position) in list.iter() {
                let position = DVec3::from(position.map(|mm| mm.0));
                if position.z <= 0.0 {
                    let words = Words::new(
                        format!("a lamp {} mm behind the sheet", -position.z),
                        "lamps on the camera's side of the sheet, with a third number above 0",
                        "write right, up and towards the camera",
                    );
                    self.report.fault(&trail.index(i), words);
                    sound = false;
                }
                positions.push(position);
            }
            sound.then_some(Places::Positions(positions))?
        } else if let Some(file) = &raw.lp {
            let path = self.path(file);
            return self.lp(path, &trail.key("lp"));
        } else {
            self.sphere(raw.sphere.as_ref()?, &trail.key("sphere"))?
        };
        let named = Vec::new();
        Some(Placed { places, named })
    }

    fn around(
        &mut self,
        raw: &RawLamps,
        azimuths: &List<crate::manifest::raw::values::TurnDeg, 1, MAX_LAMPS>,
        trail: &Trail,
    ) -> Option<Places> {
        let count = azimuths.len();
        let elevation = raw.elevation_deg.as_ref()?;
        let elevations = self.each(elevation, count, |v| v.0, &trail.key("elevation_deg"));
        let distance = raw.distance_mm.as_ref();
        let distances =
            distance.map(|each| self.each(each, count, |v| v.0, &trail.key("distance_mm")));
        if azimuths.has_holes() {
            return None;
        }
        let directions: Vec<DVec3> = azimuths
            .iter()
            .zip(elevations?)
            .map(|((_, azimuth), elevation)| direction(azimuth.0, elevation))
            .collect();
        Some(match distances {
            None => Places::Directions(directions),
            Some(distances) => {
                let far = directions.iter().zip(distances?);
                Places::Positions(far.map(|(l, distance)| *l * distance).collect())
            }
        })
    }

    /// A value for each of `count` lamps.
    fn each<T>(
        &mut self,
        each: &Each<T>,
        count: usize,
        value: impl Fn(&T) -> f64,
        trail: &Trail,
    ) -> Option<Vec<f64>> {
        match each {
            Each::All(one) => Some(vec![value(one); count]),
            Each::Each(list) => {
                self.as_many(list.len(), count, "values", trail)?;
                let values = list.iter().map(|(_, one)| value(one)).collect();
                (!list.has_holes()).then_some(values)
            }
        }
    }

    fn as_many(&mut self, found: usize, lamps: usize, what: &str, trail: &Trail) -> Option<()> {
        if found == lamps {
            return Some(());
        }
        let words = Words::new(
            format!("{found} {what} for {lamps} lamps"),
            "one for each lamp",
            "add or remove some, in the order of the lamps",
        );
        self.report.fault(trail, words);
        None
    }

    fn lp(&mut self, path: PathBuf, trail: &Trail) -> Option<Placed> {
        let shown = quote(&path.to_string_lossy());
        let mut refuse = |found: String| {
            let words = Words::new(
                found,
                "a number of lamps, and then a line for each with a file name and x, y and z",
                "correct it, or write azimuth_deg and elevation_deg instead",
            );
            self.report.fault(trail, words);
        };
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) => {
                refuse(format!("{shown} ({error})"));
                return None;
            }
        };
        let lamps = match lp::read(&text) {
            Ok(lamps) => lamps,
            Err(faults) => {
                for fault in faults {
                    refuse(format!("{}: {fault}", path.display()));
                }
                return None;
            }
        };
        let folder = path.parent().unwrap_or(std::path::Path::new(""));
        let named = lamps.iter().map(|lamp| lamp.beside(folder)).collect();
        let directions = lamps.into_iter().map(|lamp| lamp.direction).collect();
        let places = Places::Directions(directions);
        Some(Placed { places, named })
    }

    fn sphere(&mut self, raw: &RawSphere, trail: &Trail) -> Option<Places> {
        let frames = raw.photographs.as_ref();
        let key = trail.key("photographs");
        let mut photographs = Vec::new();
        let mut sound = true;
        if let Some(list) = frames {
            sound = !list.has_holes();
            let (files, size) = self.photographs(list, &key, None);
            if let (Some(size), Some(circle)) = (size, raw.circle_px) {
                sound &= self.inside(circle.map(|px| px.0), size, &trail.key("circle_px"));
            }
            sound &= size.is_some();
            let named = files.iter().zip(list.iter());
            let named: Vec<_> = named.map(|(path, (i, _))| (path, key.index(i))).collect();
            sound &= self.all_differ(&named);
            photographs = files;
        }
        let circle = raw.circle_px.map(|px| {
            let [x, y, radius] = px.map(|px| px.0);
            Circle {
                centre: glam::DVec2::new(x, y),
                radius,
            }
        });
        sound.then_some(Places::Sphere(Sphere {
            photographs,
            circle,
        }))
    }

    /// Whether a ball's outline lies wholly in photographs of this size.
    fn inside(&mut self, [x, y, r]: [f64; 3], size: [u32; 2], trail: &Trail) -> bool {
        /// Its highlight has to be told from its outline.
        const SMALLEST_PX: f64 = 8.0;
        let [width, height] = size.map(f64::from);
        let whole = x - r >= 0.0 && y - r >= 0.0 && x + r <= width && y + r <= height;
        if whole && r >= SMALLEST_PX {
            return true;
        }
        let words = Words::new(
            format!("a circle of radius {r} at {x}, {y}"),
            format!(
                "a circle wholly within {width} × {height} pixels, with a radius of {SMALLEST_PX} \
                 or more"
            ),
            "correct it, or photograph the whole ball",
        );
        self.report.fault(trail, words);
        false
    }

    /// All that is known of the lamps.
    pub(super) fn lamps(
        &mut self,
        placed: Placed,
        raw: &RawLamps,
        [recto, verso]: [Option<&Shots>; 2],
        trail: &Trail,
    ) -> Option<Lamps> {
        let count = placed.count(recto)?;
        let Placed { places, .. } = placed;
        let mut sound = true;
        if !(MIN_LAMPS..=MAX_LAMPS).contains(&count) {
            let words = Words::new(
                format!("{count} lamps"),
                format!("{MIN_LAMPS} to {MAX_LAMPS} lamps"),
                match count > MAX_LAMPS {
                    true => "leave some of them out, such as every second one",
                    false => {
                        "photograph the sheet under lamps from at least three sides, better from four"
                    }
                },
            );
            self.report.fault(trail, words);
            sound = false;
        } else if let Places::Directions(places) | Places::Positions(places) = &places {
            let directions: Vec<DVec3> = places.iter().map(|place| place.normalize()).collect();
            if let Err(why) = lights::spread(&directions) {
                let words = Words::new(
                    why.to_string(),
                    "lamps around the sheet",
                    "move one of them to another side, or correct its place here",
                );
                self.report.fault(trail, words);
                sound = false;
            }
            self.apart(&directions, trail);
        }
        if let (Places::Sphere(sphere), Some(recto)) = (&places, recto)
            && let (Some(circle), true) = (sphere.circle, sphere.photographs.is_empty())
        {
            let edges = [circle.centre.x, circle.centre.y, circle.radius];
            sound &= self.inside(edges, recto.size, &trail.key("sphere").key("circle_px"));
        }
        let light = self.light(raw, count, [recto, verso], trail);
        sound.then_some(Lamps {
            places,
            count,
            light: light?,
        })
    }

    /// Two lamps that stand in one place are probably one that was written twice.
    fn apart(&mut self, directions: &[DVec3], trail: &Trail) {
        /// No two lamps stand so near to each other.
        const SAME_RAD: f64 = 1e-3;
        for (i, direction) in directions.iter().enumerate() {
            let earlier = &directions[..i];
            let same = |other: &DVec3| other.angle_between(*direction) < SAME_RAD;
            if let Some(other) = earlier.iter().position(same) {
                let words = Words::new(
                    format!("lamp {} in the direction of lamp {}", i + 1, other + 1),
                    "lamps each in a direction of its own",
                    "correct its place, or leave one of the two out with its photograph",
                );
                self.report.warn(trail, words);
            }
        }
    }

    /// Warns where the room's light is taken from some photographs, and not from others that say
    /// how bright lamps are.
    pub(super) fn room_light(&mut self, raw: &RawCapture, root: &Trail) {
        let sides = [Some(&raw.recto), raw.verso.as_ref()];
        let taken = sides.into_iter().flatten().any(|of| of.ambient.is_some());
        let lamps = root.key("lamps");
        let cards = raw.lamps.flat_field.is_some();
        let of_cards = raw.lamps.flat_field_ambient.is_some();
        if taken && cards && !of_cards {
            let words = Words::new(
                "grey cards with the room's light, which is taken from the sheet's photographs",
                "it taken from both, or from none",
                "photograph the card with all lamps off too, and add flat_field_ambient = \"…\"; \
                 else the sheet becomes too dark",
            );
            self.report.warn(&lamps.key("flat_field"), words);
        } else if of_cards && !taken {
            let words = Words::new(
                "room light that is taken from grey cards, and not from the sheet's photographs",
                "it taken from both, or from none",
                "photograph the sheet with all lamps off too, and add recto.ambient = \"…\"; else \
                 the sheet becomes too light",
            );
            self.report.warn(&lamps.key("flat_field_ambient"), words);
        }
        if taken && raw.chart.is_some() && !cards {
            let words = Words::new(
                "a chart with the room's light, which is taken from the sheet's photographs",
                "grey cards under each lamp, which say how bright the room is",
                "photograph the chart with the room dark, or add lamps.flat_field; else the sheet \
                 becomes too dark",
            );
            self.report.warn(&root.key("chart"), words);
        }
    }

    fn light(
        &mut self,
        raw: &RawLamps,
        count: usize,
        [recto, verso]: [Option<&Shots>; 2],
        trail: &Trail,
    ) -> Option<Light> {
        if let Some(list) = &raw.flat_field {
            let key = trail.key("flat_field");
            let many = self.as_many(list.len(), count, "photographs of a grey card", &key);
            let like = recto.map(|recto| (recto.size, recto.photographs[0].as_path()));
            let (photographs, size) = self.photographs(list, &key, like);
            let ambient = raw.flat_field_ambient.as_ref().map(|path| self.path(path));
            if let Some(path) = &ambient {
                let like = size.map(|size| (size, photographs[0].as_path()));
                self.same_size(&[(path, trail.key("flat_field_ambient"))], like)?;
            }
            many?;
            let size = size?;
            if let Some(verso) = verso.filter(|verso| verso.size != size) {
                let words = Words::new(
                    format!("{} × {} pixels of a grey card", size[0], size[1]),
                    format!(
                        "{} × {} pixels, as the verso's photographs have",
                        verso.size[0], verso.size[1]
                    ),
                    "photograph both sides and the card with one camera that is not moved, or leave the grey cards out",
                );
                self.report.fault(&key, words);
                return None;
            }
            return (!list.has_holes()).then_some(Light::FlatField {
                photographs,
                reflectance: raw.grey_card.map_or(GREY_CARD, |card| card.0),
                ambient,
            });
        }
        if let Some(list) = &raw.relative {
            self.as_many(list.len(), count, "values", &trail.key("relative"))?;
            let values = list.iter().map(|(_, one)| one.0).collect();
            return (!list.has_holes()).then_some(Light::Relative(values));
        }
        let unknown = raw.intensities.unwrap_or(Intensities::Solve);
        Some(Light::Unknown(unknown))
    }
}
