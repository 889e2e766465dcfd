//! Machines of one wall as processes with windows, on an X server of their own.

use std::{
    fs,
    io::{Read, Write},
    net::TcpStream,
    path::Path,
    thread,
    time::{Duration, Instant},
};

use nix::{
    errno::Errno,
    sys::signal::{Signal, kill},
    unistd::Pid,
};
use recto::wall::journal::CURRENT;
use serde_json::{Value, json};

use super::{
    recto,
    screen::{self, Running, Screen},
    together::{self, MANIFEST, PATIENCE, Place},
};

/// Of 255, on average: what is seen to be another picture.
const OTHER: f64 = 1.0;

fn signal(process: &Running, signal: Signal) {
    kill(Pid::from_raw(process.0.id() as i32), signal).unwrap();
}

/// The half of the screen that the follower's window covers.
fn followed(screen: &Screen) -> Vec<[u8; 3]> {
    let (width, _, pixels) = screen.see();
    let rows = pixels.chunks_exact(width as usize);
    rows.flat_map(|row| row[row.len() / 2..].to_vec()).collect()
}

/// Mean difference of all channels.
fn apart(a: &[[u8; 3]], b: &[[u8; 3]]) -> f64 {
    let both = a.iter().flatten().zip(b.iter().flatten());
    let sum: f64 = both.map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
    sum / (3 * a.len()).max(1) as f64
}

fn show(place: &Place, machine: &str, display: &str) -> Running {
    let mut command = recto();
    command
        .args(["show", "--tier", "draft", "--installation"])
        .arg(place.file(machine))
        .env("RECTO_MACHINE", machine)
        .env("DISPLAY", display)
        .env_remove("WAYLAND_DISPLAY")
        .stderr(fs::File::create(place.folder(machine).join("stderr")).unwrap());
    Running(command.spawn().unwrap())
}

/// What a machine says of itself, while it answers.
fn status(port: u16) -> Option<Value> {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).ok()?;
    stream
        .set_read_timeout(Some(Duration::from_millis(500)))
        .ok()?;
    stream
        .write_all(b"GET /status.json HTTP/1.1\r\nHost: localhost\r\n\r\n")
        .ok()?;
    let mut text = String::new();
    stream.read_to_string(&mut text).ok()?;
    serde_json::from_str(text.split_once("\r\n\r\n")?.1).ok()
}

#[track_caller]
fn until(what: &str, holds: impl Fn() -> bool) {
    let begun = Instant::now();
    while !holds() {
        assert!(begun.elapsed() < PATIENCE, "{what}: never");
        thread::sleep(Duration::from_millis(20));
    }
    println!("{what}: {:.0} ms", begun.elapsed().as_secs_f64() * 1e3);
}

#[test]
fn processes_on_loopback_are_stopped_and_killed_and_go_on() {
    if screen::is_skipped() {
        return;
    }
    let place = Place::new();
    let mut screen = Screen::new([480, 240]);
    let (west, east) = (place.status, place.status + 1);
    let follower = show(&place, "east", &screen.display);
    let leader = show(&place, "west", &screen.display);
    let of = |port: u16, pointer: &str| status(port).and_then(|s| s.pointer(pointer).cloned());
    let shown = || of(east, "/machines/leader/shown_version").and_then(|v| v.as_u64());
    let heard = || of(east, "/machines/leader/heard_version").and_then(|v| v.as_u64());
    let width = |mm: u32| {
        let text = MANIFEST.replace("lamps = [\"left\"]\n[[scene]]", &format!(
            "lamps = [\"left\"]\ncamera = {{ centre_mm = [150, 100], width_mm = {mm} }}\n[[scene]]"
        ));
        assert_ne!(text, MANIFEST);
        for machine in ["west", "east"] {
            fs::write(place.exhibit(machine).join("exhibit.toml"), &text).unwrap();
        }
    };
    until("two processes are one wall", || shown().is_some());
    let faults = || {
        of(east, "/faults")
            .map(|f| f.to_string())
            .unwrap_or_default()
    };
    until("nothing is wrong", || faults() == "[]");
    let black = vec![[0; 3]; 240 * 240];
    until("it has a picture", || {
        apart(&followed(&screen), &black) > OTHER
    });

    // A follower that stands still, while the exhibit changes.
    let before = shown();
    signal(&follower, Signal::SIGSTOP);
    width(100);
    until("the leader misses it", || {
        of(west, "/faults").is_some_and(|f| f.to_string().contains("east has been silent"))
    });
    signal(&follower, Signal::SIGCONT);
    until("it has caught up", || {
        shown() > before && shown() == heard() && faults() == "[]"
    });
    until("and the leader knows", || {
        of(west, "/faults") == Some(json!([]))
    });

    // Somebody moves the sheet at the leader, above its controls.
    let before = followed(&screen);
    screen.drag([60, 10], [200, 45]);
    until("a hand at the leader is seen at the follower", || {
        apart(&followed(&screen), &before) > OTHER
    });
    until("all of it", || shown() == heard());
    // Its picture is on its way to the screen.
    until("it rests", || {
        let now = followed(&screen);
        thread::sleep(Duration::from_millis(500));
        now == followed(&screen)
    });
    let last = followed(&screen);

    // A leader that is killed, and begins anew.
    drop(leader);
    until("the follower misses it", || {
        faults().contains("west has been silent")
    });
    assert!(followed(&screen) == last, "its last picture stays");
    let leader = show(&place, "west", &screen.display);
    until("it is followed again", || faults() == "[]");
    until("from its start", || {
        apart(&followed(&screen), &last) > OTHER
    });
    let begun = heard();
    width(120);
    until("and goes on", || shown() > begun);
    drop((leader, follower));
}

/// The process that a supervisor began last, which is its only one.
fn window_of(supervisor: &Running) -> Option<Pid> {
    let id = supervisor.0.id();
    let children = fs::read_to_string(format!("/proc/{id}/task/{id}/children")).ok()?;
    children.trim().parse().ok().map(Pid::from_raw)
}

/// What a window's log says, but for a line that is being written.
fn lines(log: &Path) -> Vec<Value> {
    let text = fs::read_to_string(log).unwrap_or_default();
    let lines = text.lines();
    lines.flat_map(serde_json::from_str).collect()
}

#[test]
fn a_killed_window_is_begun_anew_and_its_log_says_why_and_how_it_ended() {
    if screen::is_skipped() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("installation.toml");
    together::write_exhibit(&folder.path().join("exhibit"), MANIFEST);
    let text = "[exhibits]\nfolders = [\"exhibit\"]\n[logs]\nfolder = \"logs\"\n\
                [status]\naddress = \"off\"\n\
                [[display]]\nid = \"only\"\npixels = [320, 240]\nsize_mm = [320, 240]\n";
    fs::write(&file, text).unwrap();
    let screen = Screen::new([320, 240]);
    let mut command = recto();
    command
        .args(["supervise", "--", "--tier", "draft", "--installation"])
        .arg(&file)
        .env("DISPLAY", &screen.display)
        .env("XDG_RUNTIME_DIR", folder.path())
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("NOTIFY_SOCKET")
        .env_remove("WATCHDOG_USEC")
        .stderr(fs::File::create(folder.path().join("stderr")).unwrap());
    let mut supervisor = Running(command.spawn().unwrap());
    let log = folder.path().join("logs").join(CURRENT);
    let said = |what: &str, field: &str, part: &str| {
        lines(&log).iter().any(|line| {
            line["what"] == what && line[field].as_str().is_some_and(|text| text.contains(part))
        })
    };
    let version = env!("CARGO_PKG_VERSION");

    until("it has a picture", || screen.light() > OTHER);
    until("its log says so", || said("started", "version", version));
    assert!(!said("started anew", "version", version));
    let first = window_of(&supervisor).expect("a window");
    kill(first, Signal::SIGKILL).unwrap();
    until("the next one says why it was begun", || {
        said("started anew", "the last one", "SIGKILL")
    });
    until("it has its picture back", || screen.light() > OTHER);
    let second = window_of(&supervisor).expect("the next window");
    assert_ne!(second, first);

    signal(&supervisor, Signal::SIGTERM);
    until("it says how it ended", || said("ends", "signal", "SIGTERM"));
    let begun = Instant::now();
    let status = loop {
        if let Some(status) = supervisor.0.try_wait().unwrap() {
            break status;
        }
        assert!(begun.elapsed() < PATIENCE, "the supervisor ends: never");
        thread::sleep(Duration::from_millis(20));
    };
    assert!(status.success(), "{status}");
    assert_eq!(
        kill(second, None),
        Err(Errno::ESRCH),
        "the window has ended"
    );
}
