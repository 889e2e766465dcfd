//! Whether the displays of the installation file are there: by the monitors that the system tells of, when
//! the program begins and whenever one is plugged in or out.

use std::time::Duration;

use bevy::{
    prelude::*,
    window::{Monitor, WindowPosition},
};

use super::{journal::Level, keeper::Keeper};
use crate::installation::{Display, PixelRect, WallWindow};

/// The system has told of all monitors by then.
const AFTER: Duration = Duration::from_secs(2);

/// What was seen of the desktop last.
#[derive(Resource, Debug)]
pub struct Desktop {
    displays: Vec<Display>,
    /// Windows, and the displays under each.
    windows: Vec<(Entity, Vec<usize>)>,
    seen: Vec<Seen>,
}

/// A monitor as the system tells of it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Seen {
    name: String,
    at: [i32; 2],
    size: [u32; 2],
}

/// What is to be said or done of a display.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Finding {
    Fine,
    /// Its monitor lies elsewhere on the desktop.
    At([i32; 2]),
    Missing(String),
}

impl Desktop {
    /// Of these windows, in the order of the wall's layout.
    pub fn new(displays: &[Display], windows: Vec<(Entity, WallWindow)>) -> Self {
        let of = |(entity, window): (Entity, WallWindow)| {
            let displays = window.panes.iter().map(|pane| pane.display);
            (entity, displays.collect())
        };
        Self {
            displays: displays.to_vec(),
            windows: windows.into_iter().map(of).collect(),
            seen: Vec::new(),
        }
    }
}

/// Looks whether displays are where they are said to be, tells of those that are not, and brings a window to
/// the monitor that its display names.
pub fn look(
    time: Res<Time<Real>>,
    mut desktop: ResMut<Desktop>,
    monitors: Query<&Monitor>,
    mut windows: Query<&mut Window>,
    keeper: Res<Keeper>,
) {
    if time.elapsed() < AFTER {
        return;
    }
    let mut seen: Vec<Seen> = monitors.iter().map(seen).collect();
    seen.sort();
    // A wall whose monitors are all switched off is told of by nobody, and begins again as it was.
    if seen.is_empty() || seen == desktop.seen {
        return;
    }
    for (entity, displays) in &desktop.windows {
        for k in displays {
            match find(&desktop.displays[*k], &seen) {
                Finding::Fine => {}
                Finding::Missing(words) => keeper.note(Level::Warning, &words),
                Finding::At([x, y]) => {
                    // A window over several displays has its place by all of them.
                    if let ([_], Ok(mut window)) = (&displays[..], windows.get_mut(*entity)) {
                        window.position = WindowPosition::At(IVec2::new(x, y));
                    } else {
                        let Display { id, on_desktop, .. } = &desktop.displays[*k];
                        let words = format!(
                            "display \"{id}\" is at {:?} on the desktop by desktop_px, and its monitor at \
                             {:?}; correct desktop_px, or arrange the monitors so",
                            on_desktop.at,
                            [x, y]
                        );
                        keeper.note(Level::Warning, &words);
                    }
                }
            }
        }
    }
    desktop.seen = seen;
}

fn seen(monitor: &Monitor) -> Seen {
    Seen {
        name: monitor.name.clone().unwrap_or_default(),
        at: monitor.physical_position.into(),
        size: [monitor.physical_width, monitor.physical_height],
    }
}

fn find(display: &Display, monitors: &[Seen]) -> Finding {
    let PixelRect { at, size } = display.on_desktop;
    let list = || {
        let each = monitors.iter().map(|monitor| {
            let Seen { name, at, size } = monitor;
            format!("{name} of {} × {} at {at:?}", size[0], size[1])
        });
        each.collect::<Vec<_>>().join(", ")
    };
    let id = &display.id;
    if let Some(name) = &display.monitor {
        let named = monitors.iter().find(|monitor| monitor.name == *name);
        return match named {
            Some(monitor) if monitor.at == at => Finding::Fine,
            Some(monitor) => Finding::At(monitor.at),
            None => Finding::Missing(format!(
                "display \"{id}\": the monitor \"{name}\" is not there, so that it is shown at {at:?} on the \
                 desktop; there are {}",
                list()
            )),
        };
    }
    // Its middle is on some monitor.
    let middle = [0, 1].map(|k| i64::from(at[k]) + i64::from(size[k]) / 2);
    let holds = |monitor: &Seen| {
        (0..2).all(|k| {
            let from = i64::from(monitor.at[k]);
            (from..from + i64::from(monitor.size[k])).contains(&middle[k])
        })
    };
    match monitors.iter().any(holds) {
        true => Finding::Fine,
        false => Finding::Missing(format!(
            "display \"{id}\" is at {at:?} on the desktop by desktop_px, where no monitor is; there are {}",
            list()
        )),
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::installation::{Profile, Rect};

    fn display(at: [i32; 2], monitor: Option<&str>) -> Display {
        Display {
            id: "left".into(),
            on_wall: Rect {
                min: DVec2::ZERO,
                max: DVec2::ONE,
            },
            on_desktop: PixelRect {
                at,
                size: [800, 600],
            },
            monitor: monitor.map(str::to_owned),
            machine: None,
            profile: Profile::Srgb,
        }
    }

    fn monitors() -> Vec<Seen> {
        let of = |(name, x): (&str, i32)| Seen {
            name: name.into(),
            at: [x, 0],
            size: [800, 600],
        };
        [("DP-1", 0), ("DP-2", 800)].map(of).into()
    }

    #[test]
    fn a_display_is_where_its_monitor_is_or_is_told_of() {
        let of = |at, monitor| find(&display(at, monitor), &monitors());
        assert_eq!(of([0, 0], None), Finding::Fine);
        assert_eq!(of([800, 0], Some("DP-2")), Finding::Fine);
        assert_eq!(of([0, 0], Some("DP-2")), Finding::At([800, 0]));
        let Finding::Missing(words) = of([1600, 0], None) else {
            panic!("it is beyond the desktop");
        };
        assert!(
            words.contains("[1600, 0]") && words.contains("DP-2"),
            "{words}"
        );
        let Finding::Missing(words) = of([0, 0], Some("HDMI-1")) else {
            panic!("no such monitor");
        };
        assert!(
            words.contains("HDMI-1") && words.contains("DP-1"),
            "{words}"
        );
    }
}
