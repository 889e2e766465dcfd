//! A picture that is to fill its display and does not: without a window manager, as on many walls, nobody
//! makes a window as large as the display, and it stays as small as it was opened.

use std::time::Duration;

use bevy::{
    prelude::*,
    window::{Monitor, OnMonitor, PrimaryMonitor, PrimaryWindow, WindowMode, WindowPosition},
};

/// A window manager has done it by then.
const AFTER: Duration = Duration::from_secs(2);

/// Until when to wait for a window manager.
#[derive(Resource, Debug, Default)]
pub struct Filling {
    is_done: bool,
}

impl Filling {
    /// How long it is until the window is looked at.
    pub fn next(&self, now: Duration) -> Option<Duration> {
        (!self.is_done).then(|| AFTER.saturating_sub(now))
    }
}

/// Looks once whether the window is as large as its display, and makes it so.
pub fn fill(
    mut filling: ResMut<Filling>,
    time: Res<Time<Real>>,
    mut windows: Query<(&mut Window, Option<&OnMonitor>), With<PrimaryWindow>>,
    monitors: Query<(&Monitor, Has<PrimaryMonitor>)>,
) {
    if filling.is_done || time.elapsed() < AFTER {
        return;
    }
    filling.is_done = true;
    let Ok((mut window, on)) = windows.single_mut() else {
        return;
    };
    let own = on.and_then(|on| monitors.get(on.0).ok());
    let first = || monitors.iter().max_by_key(|(_, is_first)| *is_first);
    let Some((monitor, _)) = own.or_else(first) else {
        return;
    };
    if let Some(size) = falls_short(&window, monitor) {
        window.mode = WindowMode::Windowed;
        window.decorations = false;
        window.position = WindowPosition::At(monitor.physical_position);
        window.resolution.set_physical_resolution(size.x, size.y);
    }
}

/// The display's size, where the window is to fill it and does not.
fn falls_short(window: &Window, monitor: &Monitor) -> Option<UVec2> {
    let size = UVec2::new(monitor.physical_width, monitor.physical_height);
    let is_to_fill = !matches!(window.mode, WindowMode::Windowed);
    (is_to_fill && size.min_element() > 0 && window.physical_size() != size).then_some(size)
}

#[cfg(test)]
mod tests {
    use bevy::window::{MonitorSelection, WindowResolution};

    use super::*;

    #[test]
    fn only_a_window_that_is_to_fill_its_display_and_does_not_is_made_larger() {
        let monitor = Monitor {
            name: None,
            physical_height: 1080,
            physical_width: 1920,
            physical_position: IVec2::ZERO,
            refresh_rate_millihertz: None,
            scale_factor: 1.0,
            video_modes: Vec::new(),
        };
        let window = |mode, width, height| Window {
            mode,
            resolution: WindowResolution::new(width, height),
            ..default()
        };
        let full = WindowMode::BorderlessFullscreen(MonitorSelection::Current);
        let size = UVec2::new(1920, 1080);
        let short = falls_short(&window(full, 800, 600), &monitor);
        assert_eq!(short, Some(size));
        assert_eq!(falls_short(&window(full, 1920, 1080), &monitor), None);
        let windowed = window(WindowMode::Windowed, 800, 600);
        assert_eq!(falls_short(&windowed, &monitor), None);
    }
}
