//! Displays: each in its place, none in that of another.

use std::collections::BTreeMap;

use glam::DVec2;

use super::{
    super::{
        Display, PixelRect, Profile, Rect, Wall,
        raw::{RawDisplay, RawInstallation, RawProfile},
        wall,
    },
    Validator,
};
use crate::{
    manifest::{
        Pattern,
        document::{Trail, Words},
        quote,
    },
    maps::{DisplayProfile, MapError},
};

/// How far from square pixels may be before a size is doubted: sizes are stated to the mm.
const SQUARE: f64 = 0.02;

impl Validator<'_, '_> {
    pub(super) fn wall(&mut self, raw: &RawInstallation, root: &Trail) -> Option<Wall> {
        let bottom = raw.bottom_above_floor_mm.map(|mm| mm.0);
        let bottom_trail = root.key("bottom_above_floor_mm");
        let Some(list) = &raw.display else {
            if bottom.is_some() {
                let words = Words::new(
                    "a height above the floor without a display",
                    "it together with [[display]]",
                    "add a [[display]] with its pixels and size_mm",
                );
                self.report.fault(&bottom_trail, words);
            }
            if raw.windows.is_some() {
                let words = Words::new(
                    "windows without a display",
                    "it together with [[display]]",
                    "add each [[display]], or remove it",
                );
                self.report.fault(&root.key("windows"), words);
            }
            return None;
        };
        let trail = root.key("display");
        let from_floor = list
            .iter()
            .any(|(_, display)| display.bottom_above_floor_mm.is_some());
        let mut displays: Vec<(usize, Display)> = Vec::new();
        // Each machine has a desktop of its own.
        let mut next_px: BTreeMap<Option<&str>, i32> = BTreeMap::new();
        for (i, raw) in list.iter() {
            let one = trail.index(i);
            if from_floor && raw.bottom_above_floor_mm.is_none() {
                let words = Words::new(
                    "no bottom_above_floor_mm, which another display has",
                    "it for all displays or for none",
                    "add it, instead of top_mm",
                );
                self.report.fault(&one, words);
            }
            let machine = raw.machine.as_ref().map(|machine| machine.as_str());
            let display = self.display(raw, next_px.entry(machine).or_default(), &one);
            for (other, earlier) in &displays {
                self.apart(&display, earlier, [&one, &trail.index(*other)], *other);
            }
            displays.push((i, display));
        }
        if let (true, Some(_)) = (from_floor, bottom) {
            let words = Words::new(
                "a height above the floor here and in displays",
                "it here or in displays",
                "remove one of the two",
            );
            self.report.fault(&bottom_trail, words);
        }
        if list.has_holes() {
            return None;
        }
        let mut displays: Vec<Display> = displays.into_iter().map(|(_, one)| one).collect();
        let around = wall::around(displays.iter().map(|display| display.on_wall))?;
        for Rect { min, max } in displays.iter_mut().map(|display| &mut display.on_wall) {
            *min -= around.min;
            *max -= around.min;
        }
        let top_above_floor_mm = match from_floor {
            // Down from the floor, below which nothing lies.
            true => Some(-around.min.y),
            false => bottom.map(|bottom| bottom + around.size().y),
        };
        Some(Wall {
            displays,
            windows: raw.windows.unwrap_or_default(),
            top_above_floor_mm,
        })
    }

    fn display(&mut self, raw: &RawDisplay, next_px: &mut i32, trail: &Trail) -> Display {
        let size_mm = DVec2::from(raw.size_mm.map(|mm| mm.0));
        let pixels = raw.pixels.map(|px| px.0.unsigned_abs());
        let left = raw.left_mm.map_or(0.0, |mm| mm.0);
        let top = match raw.bottom_above_floor_mm {
            Some(bottom) => -(bottom.0 + size_mm.y),
            None => raw.top_mm.map_or(0.0, |mm| mm.0),
        };
        let at = raw.desktop_px.map_or([*next_px, 0], |px| px.map(|px| px.0));
        *next_px = at[0] + raw.pixels[0].0;
        let px_per_mm = DVec2::from(pixels.map(f64::from)) / size_mm;
        if (px_per_mm.x / px_per_mm.y - 1.0).abs() > SQUARE {
            let words = Words::new(
                format!(
                    "pixels of {:.4} × {:.4} mm",
                    px_per_mm.x.recip(),
                    px_per_mm.y.recip()
                ),
                "square pixels, as displays have them",
                "measure width and height of the visible area again, without the frame",
            );
            self.report.warn(&trail.key("size_mm"), words);
        }
        let min = DVec2::new(left, top);
        Display {
            id: raw.id.as_str().to_owned(),
            on_wall: Rect {
                min,
                max: min + size_mm,
            },
            on_desktop: PixelRect { at, size: pixels },
            monitor: raw
                .monitor
                .as_ref()
                .map(|monitor| monitor.as_str().to_owned()),
            machine: raw
                .machine
                .as_ref()
                .map(|machine| machine.as_str().to_owned()),
            profile: self.profile(raw.profile.as_ref(), &trail.key("profile")),
        }
    }

    /// Two displays have neither a name nor a place in common.
    fn apart(
        &mut self,
        display: &Display,
        earlier: &Display,
        [trail, earlier_trail]: [&Trail; 2],
        other: usize,
    ) {
        // A place that could not be read covers nothing.
        let are_placed = [trail, earlier_trail].iter().all(|trail| {
            let keys = ["left_mm", "top_mm", "bottom_above_floor_mm"];
            keys.iter()
                .all(|key| !self.report.faulty_within(&trail.key(key)))
        });
        let mut refuse = |key: &str, found: String, allowed: &str, remedy: &str| {
            let words = Words::new(found, allowed, remedy);
            self.report.fault(&trail.key(key), words);
        };
        if display.id == earlier.id {
            let found = format!(
                "the id \"{}\", which display[{other}] has already",
                display.id
            );
            refuse("id", found, "ids that differ", "rename one of the two");
        }
        let shares_desktop = display.machine == earlier.machine;
        if display.monitor.is_some() && display.monitor == earlier.monitor && shares_desktop {
            let found = format!("the monitor of display[{other}]");
            refuse(
                "monitor",
                found,
                "a monitor of its own",
                "correct one of the two",
            );
        }
        if are_placed && display.on_wall.overlaps(&earlier.on_wall) {
            let both = display.on_wall.max.min(earlier.on_wall.max)
                - display.on_wall.min.max(earlier.on_wall.min);
            let found = format!(
                "a place where it covers {:.0} × {:.0} mm of \"{}\"",
                both.x, both.y, earlier.id
            );
            let remedy = "correct left_mm, top_mm or bottom_above_floor_mm of one of the two";
            refuse("left_mm", found, "displays side by side", remedy);
        }
        if display.on_desktop.overlaps(&earlier.on_desktop) && shares_desktop {
            let found = format!("pixels of the desktop that \"{}\" shows", earlier.id);
            refuse(
                "desktop_px",
                found,
                "pixels of its own",
                "correct one of the two",
            );
        }
    }

    fn profile(&mut self, raw: Option<&RawProfile>, trail: &Trail) -> Profile {
        let Some(raw) = raw else {
            return Profile::Srgb;
        };
        let luminance_nits = raw.luminance_nits.map(|nits| nits.0);
        if let Some(white) = raw.white_xy {
            return Profile::Measured {
                white_xy: white.map(|xy| xy.0),
                gamma: raw.gamma.map_or(2.2, |gamma| gamma.0),
                luminance_nits,
            };
        }
        let Some(icc) = &raw.icc else {
            return Profile::Srgb;
        };
        let path = self.path(icc);
        match DisplayProfile::read(&path) {
            Ok(display) => Profile::Icc {
                path,
                display: Box::new(display),
                luminance_nits,
            },
            Err(error) => {
                let reason = match error {
                    MapError::Read { reason, .. } => reason.to_string(),
                    MapError::Profile { detail, .. } => detail,
                    error => error.to_string(),
                };
                let words = Words::new(
                    format!("{} ({reason})", quote(icc.as_str())),
                    "an ICC profile of an RGB display",
                    "correct the path or export it again so, or write white_xy, gamma and luminance_nits",
                );
                self.report.fault(&trail.key("icc"), words);
                Profile::Srgb
            }
        }
    }
}
