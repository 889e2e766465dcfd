//! Displays on a wall: where each lies in millimetres and on the desktop, and what of one picture
//! it shows.
//!
//! # Frames
//! *Wall frame*: millimetres from the upper left corner of the rectangle around all visible areas,
//! x right, y **down**; what lies between displays (their bezels) belongs to it. *Desktop frame*:
//! pixels as the window system counts them, x right, y down; bezels are not in it.

use std::ops::Range;

use glam::DVec2;
use serde::Serialize;

use super::profile::Profile;

/// How windows lie on the displays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Windows {
    /// One over all displays.
    #[default]
    Spanning,
    /// One on each.
    Each,
}

/// A rectangle in mm or in shares, y down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    pub min: DVec2,
    pub max: DVec2,
}

impl Rect {
    pub fn size(&self) -> DVec2 {
        self.max - self.min
    }

    pub fn contains(&self, place: DVec2) -> bool {
        place.cmpge(self.min).all() && place.cmple(self.max).all()
    }

    fn union(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Whether the two share more than an edge.
    pub(super) fn overlaps(&self, other: &Self) -> bool {
        let both = self.max.min(other.max) - self.min.max(other.min);
        both.cmpgt(DVec2::ZERO).all()
    }
}

/// A rectangle of pixels, y down.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct PixelRect {
    pub at: [i32; 2],
    pub size: [u32; 2],
}

impl PixelRect {
    fn as_rect(&self) -> Rect {
        let min = DVec2::from(self.at.map(f64::from));
        Rect {
            min,
            max: min + DVec2::from(self.size.map(f64::from)),
        }
    }

    /// As far apart as two can be within the ranges of the installation file, an i32 holds it.
    fn union(&self, other: &Self) -> Self {
        let end = |rect: &Self, k: usize| i64::from(rect.at[k]) + i64::from(rect.size[k]);
        let at = [0, 1].map(|k| self.at[k].min(other.at[k]));
        Self {
            at,
            size: [0, 1].map(|k| {
                let size = end(self, k).max(end(other, k)) - i64::from(at[k]);
                u32::try_from(size).unwrap_or(u32::MAX)
            }),
        }
    }

    pub(super) fn overlaps(&self, other: &Self) -> bool {
        self.as_rect().overlaps(&other.as_rect())
    }
}

/// One display.
#[derive(Clone, Debug, PartialEq)]
pub struct Display {
    pub id: String,
    /// Its visible area, in the wall frame.
    pub on_wall: Rect,
    /// Its pixels, in the desktop frame.
    pub on_desktop: PixelRect,
    /// What the system calls it, where the installation says so.
    pub monitor: Option<String>,
    /// The machine that it is plugged into, where several carry the wall.
    pub machine: Option<String>,
    pub profile: Profile,
}

impl Display {
    /// Along x and y.
    pub fn px_per_mm(&self) -> DVec2 {
        DVec2::from(self.on_desktop.size.map(f64::from)) / self.on_wall.size()
    }

    /// The place in the wall frame of a place in pixels from the display's upper left corner.
    pub fn wall_of_px(&self, px: DVec2) -> DVec2 {
        self.on_wall.min + px / self.px_per_mm()
    }

    /// The inverse of [`Self::wall_of_px`]; also outside the display.
    pub fn px_of_wall(&self, mm: DVec2) -> DVec2 {
        (mm - self.on_wall.min) * self.px_per_mm()
    }
}

/// One window and what it shows.
#[derive(Clone, Debug, PartialEq)]
pub struct WallWindow {
    /// In the desktop frame.
    pub on_desktop: PixelRect,
    pub panes: Vec<Pane>,
}

/// The part of a window that lies on one display.
#[derive(Clone, Debug, PartialEq)]
pub struct Pane {
    /// Its index in [`Wall::displays`].
    pub display: usize,
    /// In pixels from the window's upper left corner.
    pub in_window: PixelRect,
    /// What of one picture over the whole wall it shows, as shares of that picture's width and
    /// height, 0 to 1: what lies under bezels is left out, not squeezed together.
    pub of_picture: Rect,
}

/// All displays.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// Never empty.
    pub displays: Vec<Display>,
    pub windows: Windows,
    /// How high above the floor the wall frame's origin is, in mm, where the installation says it.
    pub top_above_floor_mm: Option<f64>,
}

impl Wall {
    /// Width and height in mm of the rectangle around all visible areas, bezels between them
    /// included.
    pub fn size_mm(&self) -> DVec2 {
        self.displays
            .iter()
            .map(|display| display.on_wall.max)
            .fold(DVec2::ZERO, DVec2::max)
    }

    /// The windows that cover it, where one machine carries it.
    pub fn layout(&self) -> Vec<WallWindow> {
        self.layout_on(None)
    }

    /// The windows that cover the displays of a machine, or of all; none where it has no displays.
    pub fn layout_on(&self, machine: Option<&str>) -> Vec<WallWindow> {
        let is_on =
            |k: &usize| machine.is_none() || self.displays[*k].machine.as_deref() == machine;
        let all: Vec<usize> = (0..self.displays.len()).filter(is_on).collect();
        if all.is_empty() {
            return Vec::new();
        }
        let groups: Vec<&[usize]> = match self.windows {
            Windows::Spanning => vec![&all],
            Windows::Each => all.chunks(1).collect(),
        };
        groups.into_iter().map(|of| self.window(of)).collect()
    }

    fn window(&self, displays: &[usize]) -> WallWindow {
        let places = || displays.iter().map(|k| self.displays[*k].on_desktop);
        let on_desktop = places().skip(1).fold(
            places().next().unwrap_or(PixelRect {
                at: [0; 2],
                size: [0; 2],
            }),
            |all, one| all.union(&one),
        );
        let whole = self.size_mm();
        let pane = |k: &usize| {
            let display = &self.displays[*k];
            let PixelRect { at, size } = display.on_desktop;
            Pane {
                display: *k,
                in_window: PixelRect {
                    at: [0, 1].map(|i| at[i] - on_desktop.at[i]),
                    size,
                },
                of_picture: Rect {
                    min: display.on_wall.min / whole,
                    max: display.on_wall.max / whole,
                },
            }
        };
        WallWindow {
            on_desktop,
            panes: displays.iter().map(pane).collect(),
        }
    }

    /// The display that shows a place of the wall frame; none under a bezel.
    pub fn display_at(&self, mm: DVec2) -> Option<&Display> {
        self.displays
            .iter()
            .find(|display| display.on_wall.contains(mm))
    }

    /// The place in the wall frame of a place in the desktop frame; `None` outside all displays.
    pub fn wall_of_desktop(&self, px: DVec2) -> Option<DVec2> {
        let display = self
            .displays
            .iter()
            .find(|display| display.on_desktop.as_rect().contains(px))?;
        Some(display.wall_of_px(px - display.on_desktop.as_rect().min))
    }

    /// The rows of a display within which controls may lie, in pixels from its upper edge; `None`
    /// if no hand reaches it, and all of them where nobody said how high the wall hangs.
    pub fn reach_px(&self, display: &Display, reach: &Reach) -> Option<Range<f64>> {
        let rows = f64::from(display.on_desktop.size[1]);
        let Some(top) = self.top_above_floor_mm else {
            return Some(0.0..rows);
        };
        let row = |above_floor: f64| {
            let mm = DVec2::new(0.0, top - above_floor);
            display.px_of_wall(mm).y.clamp(0.0, rows)
        };
        let band = row(reach.to_mm)..row(reach.from_mm);
        (band.start < band.end).then_some(band)
    }
}

/// The heights above the floor that hands reach.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Reach {
    pub from_mm: f64,
    pub to_mm: f64,
}

impl Default for Reach {
    /// What is reached forwards from a wheelchair (2010 ADA Standards, 308.2.1).
    fn default() -> Self {
        Self {
            from_mm: 380.0,
            to_mm: 1220.0,
        }
    }
}

/// The rectangle around all of them.
pub(super) fn around(rects: impl IntoIterator<Item = Rect>) -> Option<Rect> {
    rects.into_iter().reduce(|all, one| all.union(&one))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Positions are in mm and pixels; nothing here is larger than 10⁴.
    const EXACT: f64 = 1e-9;

    fn display(id: &str, at_mm: [f64; 2], desktop: [i32; 2]) -> Display {
        let min = DVec2::from(at_mm);
        Display {
            id: id.to_owned(),
            on_wall: Rect {
                min,
                max: min + DVec2::new(960.0, 540.0),
            },
            on_desktop: PixelRect {
                at: desktop,
                size: [1920, 1080],
            },
            monitor: None,
            machine: None,
            profile: Profile::Srgb,
        }
    }

    /// Two displays of 2 pixels a mm with 25 mm of bezels between them.
    fn two(windows: Windows) -> Wall {
        Wall {
            displays: vec![
                display("left", [0.0, 0.0], [0, 0]),
                display("right", [985.0, 0.0], [1920, 0]),
            ],
            windows,
            top_above_floor_mm: Some(1600.0),
        }
    }

    #[test]
    fn what_lies_under_a_bezel_is_skipped_and_not_squeezed() {
        let wall = two(Windows::Spanning);
        assert_eq!(wall.size_mm(), DVec2::new(1945.0, 540.0));
        // A line of slope 1/10 over the wall, followed pixel by pixel: the same on both sides.
        let line = |mm: DVec2| mm.y - mm.x / 10.0;
        let before = wall.wall_of_desktop(DVec2::new(1919.5, 200.0)).unwrap();
        let after = wall.wall_of_desktop(DVec2::new(1920.5, 200.0)).unwrap();
        // Half a mm of pixel centres, and the bezel.
        assert!((after.x - before.x - 25.5).abs() < EXACT);
        let drop_px = (line(before) - line(after)) * 2.0;
        assert!((drop_px - 5.1).abs() < EXACT, "{drop_px}");
        assert!(wall.display_at(DVec2::new(970.0, 100.0)).is_none());
        assert_eq!(wall.display_at(DVec2::new(990.0, 9.0)).unwrap().id, "right");
        let [window] = &wall.layout()[..] else {
            panic!("one window");
        };
        assert_eq!(window.on_desktop.size, [3840, 1080]);
        for pane in &window.panes {
            let shown = &wall.displays[pane.display];
            let mm = pane.of_picture.size() * wall.size_mm();
            assert!((mm - shown.on_wall.size()).length() < EXACT);
        }
        let [left, right] = &window.panes[..] else {
            panic!("two panes");
        };
        let skipped = (right.of_picture.min.x - left.of_picture.max.x) * wall.size_mm().x;
        assert!((skipped - 25.0).abs() < EXACT);
        assert_eq!(right.in_window.at, [1920, 0]);
    }

    #[test]
    fn one_window_for_each_display_shows_the_same_parts() {
        let (spanning, each) = (two(Windows::Spanning), two(Windows::Each));
        let parts = |wall: &Wall| -> Vec<Rect> {
            let windows = wall.layout();
            let panes = windows.iter().flat_map(|window| &window.panes);
            panes.map(|pane| pane.of_picture).collect()
        };
        assert_eq!(parts(&spanning), parts(&each));
        assert_eq!(each.layout().len(), 2);
        for window in each.layout() {
            assert_eq!(window.panes.len(), 1);
            assert_eq!(window.panes[0].in_window.at, [0, 0]);
            assert_eq!(window.on_desktop.size, [1920, 1080]);
        }
    }

    #[test]
    fn places_go_to_pixels_and_back() {
        let wall = two(Windows::Spanning);
        for px in [DVec2::new(3.0, 7.0), DVec2::new(1920.0, 1080.0)] {
            for display in &wall.displays {
                let back = display.px_of_wall(display.wall_of_px(px));
                assert!((back - px).length() < EXACT);
            }
        }
        assert!(wall.wall_of_desktop(DVec2::new(-1.0, 5.0)).is_none());
    }

    #[test]
    fn controls_lie_where_hands_reach() {
        // Upper edge at 1600 mm, lower at 1060: hands reach from 380 to 1220.
        let wall = two(Windows::Each);
        let reach = Reach::default();
        let band = |wall: &Wall| wall.reach_px(&wall.displays[0], &reach);
        assert_eq!(band(&wall), Some(760.0..1080.0));
        let at = |top: Option<f64>| Wall {
            top_above_floor_mm: top,
            ..wall.clone()
        };
        assert_eq!(band(&at(Some(1220.0))), Some(0.0..1080.0));
        assert_eq!(band(&at(Some(600.0))), Some(0.0..440.0));
        assert_eq!(band(&at(Some(2400.0))), None, "it hangs too high");
        assert_eq!(band(&at(Some(300.0))), None, "it lies in the floor");
        assert_eq!(band(&at(None)), Some(0.0..1080.0));
    }
}
