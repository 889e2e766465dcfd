//! What people stand before: one picture, be it a window's or one over several displays.

use bevy::{prelude::*, window::WindowEvent};

/// The picture that is touched and looked at.
#[derive(Resource, Clone, Debug, PartialEq)]
pub struct Glass {
    /// In logical pixels, in which all places are told.
    pub size: Vec2,
    pub pixels: UVec2,
    /// Its width in mm, where it is not one window's.
    pub width_mm: Option<f64>,
    /// What windows show of it; without any, it is the window's own.
    pub panes: Vec<Pane>,
    /// The pane that was touched last, on which controls lie.
    pub home: usize,
}

/// A part of the picture in a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pane {
    /// None where another machine shows it.
    pub window: Option<Entity>,
    /// In the window's logical pixels.
    pub in_window: Rect,
    /// In the picture's.
    pub in_picture: Rect,
}

impl Default for Glass {
    fn default() -> Self {
        Self {
            size: Vec2::ONE,
            pixels: UVec2::ONE,
            width_mm: None,
            panes: Vec::new(),
            home: 0,
        }
    }
}

impl Glass {
    /// The place in the picture of a place in a window; beyond its panes, as the nearest one goes on.
    fn place(&self, window: Entity, at: Vec2) -> Vec2 {
        let panes = self.panes.iter();
        let panes = panes.filter(|pane| pane.window == Some(window));
        let away = |pane: &&Pane| {
            let nearest = at.clamp(pane.in_window.min, pane.in_window.max);
            nearest.distance_squared(at)
        };
        let nearest = panes.min_by(|a, b| away(a).total_cmp(&away(b)));
        nearest.map_or(at, |pane| {
            let share = (at - pane.in_window.min) / pane.in_window.size().max(Vec2::ONE);
            pane.in_picture.min + share * pane.in_picture.size()
        })
    }

    /// The number of a finger among all windows, whose glasses may number theirs alike.
    fn number(&self, window: Entity, id: u64) -> u64 {
        let mut windows = self.panes.iter().map(|pane| pane.window);
        let which = windows.position(|of| of == Some(window)).unwrap_or(0) as u64;
        id ^ which << 48
    }

    /// The part of the picture on which controls lie, on one display and under none of its frames.
    pub fn home(&self) -> Rect {
        let whole = Rect::from_corners(Vec2::ZERO, self.size);
        self.panes
            .get(self.home)
            .map_or(whole, |pane| pane.in_picture)
    }

    /// The pane of a place in the picture.
    pub fn pane_at(&self, at: Vec2) -> Option<usize> {
        let mut panes = self.panes.iter();
        panes.position(|pane| pane.in_picture.contains(at))
    }

    /// What happened in a window, as it is told of the picture.
    pub fn event(&self, event: &WindowEvent) -> WindowEvent {
        let mut event = event.clone();
        match &mut event {
            WindowEvent::TouchInput(touch) => {
                touch.position = self.place(touch.window, touch.position);
                touch.id = self.number(touch.window, touch.id);
            }
            WindowEvent::CursorMoved(moved) => {
                moved.position = self.place(moved.window, moved.position);
            }
            _ => {}
        }
        event
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_under_one_hand_is_told_across_displays() {
        let [left, right] = [1, 2].map(|k| Entity::from_raw_u32(k).expect("an entity"));
        let pane = |window, x: f32| Pane {
            window: Some(window),
            in_window: Rect::new(0.0, 0.0, 1000.0, 500.0),
            in_picture: Rect::new(x, 0.0, x + 1000.0, 500.0),
        };
        let glass = Glass {
            panes: vec![pane(left, 0.0), pane(right, 1020.0)],
            ..Glass::default()
        };
        assert_eq!(
            glass.place(left, Vec2::new(990.0, 20.0)),
            Vec2::new(990.0, 20.0)
        );
        assert_eq!(
            glass.place(right, Vec2::new(10.0, 20.0)),
            Vec2::new(1030.0, 20.0)
        );
        assert_ne!(glass.number(left, 1), glass.number(right, 1));
        // A finger that slides off goes on.
        assert_eq!(
            glass.place(left, Vec2::new(1010.0, 20.0)),
            Vec2::new(1010.0, 20.0)
        );
    }
}
