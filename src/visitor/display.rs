//! The display: whether there is one, found out before the window system's library would panic for want of
//! one, a window on it, and what becomes of that when it is switched off.

use std::{
    any::Any,
    ffi::OsStr,
    panic::{self, AssertUnwindSafe},
};

use bevy::{
    ecs::relationship::RelationshipTarget,
    log::{Level, LogPlugin},
    prelude::*,
    render::RenderPlugin,
    window::{ExitCondition, HasWindows, Monitor},
};

use crate::device;

/// No display that a window could open on.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no display: {reason}. `recto render` writes pictures into files without one, and on Debian \
     or Ubuntu `xvfb-run recto show …` opens the window on a virtual one"
)]
pub struct NoDisplay {
    reason: String,
}

/// Looks for the display that a window will open on.
///
/// # Errors
/// [`NoDisplay`] if none is named or none answers.
pub fn probe() -> Result<(), NoDisplay> {
    if !cfg!(target_os = "linux") {
        return Ok(());
    }
    let named = |name| std::env::var_os(name).filter(|value| !value.is_empty());
    if cfg!(feature = "wayland") && named("WAYLAND_DISPLAY").is_some() {
        return Ok(());
    }
    match named("DISPLAY") {
        Some(display) => answers(&display),
        None => Err(NoDisplay {
            reason: "DISPLAY is not set".into(),
        }),
    }
}

/// Opens a window. The window system's library panics where a display answers but cannot be used, such as
/// where its own libraries are missing.
///
/// # Errors
/// [`NoDisplay`] with what it said then.
pub fn open(app: &mut App, window: Window) -> Result<(), NoDisplay> {
    let plugins = DefaultPlugins
        .set(WindowPlugin {
            primary_window: Some(window),
            exit_condition: ExitCondition::DontExit,
            // A public wall would stay without its window, and a desk ends by itself.
            close_when_requested: false,
            ..default()
        })
        .set(RenderPlugin {
            render_creation: device::render_creation(),
            // A pipeline that compiles behind the scenes leaves the table empty meanwhile.
            synchronous_pipeline_compilation: true,
            ..default()
        })
        .set(LogPlugin {
            level: Level::ERROR,
            filter: String::new(),
            ..default()
        });
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    let opened = panic::catch_unwind(AssertUnwindSafe(|| {
        app.add_plugins(plugins);
    }));
    panic::set_hook(hook);
    opened.map_err(|words| NoDisplay {
        reason: reason(&*words),
    })
}

fn reason(panic: &(dyn Any + Send)) -> String {
    let words = panic.downcast_ref::<String>().cloned();
    words
        .or_else(|| panic.downcast_ref::<&str>().map(|&words| words.into()))
        .unwrap_or_else(|| "the window system refused".into())
}

/// A display that is switched off would take its windows with it.
pub fn outlive(display: On<Despawn, Monitor>, mut displays: Query<&mut HasWindows>) {
    if let Ok(mut windows) = displays.get_mut(display.entity) {
        windows.collection_mut_risky().clear();
    }
}

/// Whether an X server listens where `[host]:number[.screen]` says.
fn answers(display: &OsStr) -> Result<(), NoDisplay> {
    let no_display = |why: &str| NoDisplay {
        reason: format!("DISPLAY is {display:?}, {why}"),
    };
    let place = display.to_str().and_then(|text| text.rsplit_once(':'));
    let number = |(host, rest): (&str, &str)| {
        let number: u16 = rest.split('.').next()?.parse().ok()?;
        Some((host.to_owned(), number))
    };
    let (host, number) = place
        .and_then(number)
        .ok_or_else(|| no_display("which names none"))?;
    if connects(&host, number) {
        Ok(())
    } else {
        Err(no_display("and nothing answers there"))
    }
}

#[cfg(unix)]
fn connects(host: &str, number: u16) -> bool {
    use std::{net::TcpStream, os::unix::net::UnixStream};

    /// X servers listen on this port and those above it.
    const PORT: u16 = 6000;
    if !matches!(host, "" | "unix") && !host.starts_with('/') {
        return TcpStream::connect((host, PORT.saturating_add(number))).is_ok();
    }
    let path = format!("/tmp/.X11-unix/X{number}");
    UnixStream::connect(&path).is_ok() || connects_abstract(&path)
}

#[cfg(target_os = "linux")]
fn connects_abstract(path: &str) -> bool {
    use std::os::{
        linux::net::SocketAddrExt,
        unix::net::{SocketAddr, UnixStream},
    };

    SocketAddr::from_abstract_name(path)
        .and_then(|address| UnixStream::connect_addr(&address))
        .is_ok()
}

#[cfg(all(unix, not(target_os = "linux")))]
fn connects_abstract(_: &str) -> bool {
    false
}

#[cfg(not(unix))]
fn connects(_: &str, _: u16) -> bool {
    true
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use bevy::window::OnMonitor;

    use super::*;

    #[test]
    fn a_display_that_is_not_there_is_told() {
        for (display, words) in [
            ("nonsense", "names none"),
            (":", "names none"),
            (":54321.0", "nothing answers"),
        ] {
            let error = answers(OsStr::new(display)).expect_err(display);
            assert!(error.to_string().contains(words), "{error}");
        }
    }

    #[test]
    fn a_window_outlives_its_display() {
        let mut world = World::new();
        world.add_observer(outlive);
        let monitor = world
            .spawn(Monitor {
                name: None,
                physical_height: 1080,
                physical_width: 1920,
                physical_position: IVec2::ZERO,
                refresh_rate_millihertz: None,
                scale_factor: 1.0,
                video_modes: Vec::new(),
            })
            .id();
        let window = world.spawn((Window::default(), OnMonitor(monitor))).id();
        world.entity_mut(monitor).despawn();
        assert!(world.get_entity(window).is_ok());
    }
}
