//! A wall of two windows on a screen of its own, under its supervisor: somebody visits it with a mouse, and
//! then everything is done to it that happens in a year. How long it takes to come back is printed.

use std::{
    fs,
    io::{Read, Write},
    net::{TcpListener, TcpStream},
    os::unix::fs::symlink,
    path::Path,
    process::{Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use serde_json::Value;

use super::screen::{self, Running, Screen};

const SCREEN: [u32; 2] = [960, 400];
/// A place on paper, in the left one and in the right one of two windows.
const LEFT: [i16; 2] = [200, 120];
const RIGHT: [i16; 2] = [760, 120];
/// How long anything may take on a slow machine.
const PATIENCE: Duration = Duration::from_secs(120);
const LOOK: Duration = Duration::from_millis(100);
/// A picture that changed differs by more, and one that did not by less, of 255: the sheet's light moves a
/// little while it tours.
const CHANGED: f64 = 0.5;
/// A screen that shows paper is brighter than this.
const LIT: f64 = 12.0;

/// The wall, and the port of its status.
struct Wall {
    supervisor: Running,
    port: u16,
}

impl Wall {
    /// On `screen`, with what lies in `folder`.
    fn hang(screen: &Screen, folder: &Path) -> Self {
        let free = TcpListener::bind("127.0.0.1:0").and_then(|socket| socket.local_addr());
        let port = free.expect("a free port").port();
        let file = folder.join("installation.toml");
        fs::write(&file, house(port)).expect("the installation is written");
        let supervisor = Command::new(env!("CARGO_BIN_EXE_recto"))
            .args(["supervise", "--start-limit", "60", "--idle-limit", "20"])
            .args(["--hang-limit", "8", "--", "--kiosk", "--tier", "draft"])
            .arg("--installation")
            .arg(&file)
            .env("DISPLAY", &screen.display)
            .env_remove("WAYLAND_DISPLAY")
            .env("XDG_RUNTIME_DIR", folder)
            .stderr(Stdio::inherit())
            .spawn();
        Self {
            supervisor: Running(supervisor.expect("the program starts")),
            port,
        }
    }

    /// What its status says, while there is one.
    fn status(&self) -> Option<Value> {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).ok()?;
        stream.set_read_timeout(Some(Duration::from_secs(2))).ok()?;
        let ask = format!(
            "GET /status.json HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nConnection: close\r\n\r\n",
            self.port
        );
        stream.write_all(ask.as_bytes()).ok()?;
        let mut text = String::new();
        stream.read_to_string(&mut text).ok()?;
        let (_, body) = text.split_once("\r\n\r\n")?;
        serde_json::from_str(body).ok()
    }

    /// Waits until its status is as wanted, and prints how long that took after what happened.
    #[track_caller]
    fn wait(&self, happened: &str, wanted: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        loop {
            let status = self.status();
            if let Some(status) = status.filter(&wanted) {
                println!("{happened}: {:.1} s", start.elapsed().as_secs_f64());
                return status;
            }
            let seen = start.elapsed() < PATIENCE;
            assert!(seen, "{happened}: {:?}", self.status());
            thread::sleep(LOOK);
        }
    }

    /// The process that has the windows.
    fn window(&self) -> Option<u32> {
        let supervisor = self.supervisor.0.id();
        let children = format!("/proc/{supervisor}/task/{supervisor}/children");
        let children = fs::read_to_string(children).ok()?;
        children.split_whitespace().next()?.parse().ok()
    }

    fn signal(&self, name: &str) {
        let window = self.window().expect("a window").to_string();
        let sent = Command::new("kill").args(["-s", name, &window]).status();
        assert!(sent.is_ok_and(|status| status.success()), "{name}");
    }
}

fn house(port: u16) -> String {
    format!(
        r#"
windows = "each"
[exhibits]
folders = ["exhibit"]
[[display]]
id = "left"
pixels = [480, 400]
size_mm = [240, 200]
left_mm = 0
[[display]]
id = "right"
pixels = [480, 400]
size_mm = [240, 200]
left_mm = 250
desktop_px = [480, 0]
[idle]
seconds = 14
countdown_seconds = 20
chime = false
[interface]
reduced_motion = false
[logs]
folder = "logs"
max_megabytes = 1
keep = 2
[status]
address = "127.0.0.1:{port}"
[staff]
pin = "835017"
"#
    )
}

/// Whether it has drawn and says so in this word.
fn is(word: &'static str) -> impl Fn(&Value) -> bool {
    move |status| status["state"] == word && status["frames_completed"].as_u64() > Some(0)
}

/// Whether it shows something, to somebody or nobody.
fn shows(status: &Value) -> bool {
    is("showing")(status) || is("attract")(status)
}

fn pause(seconds: f64) {
    thread::sleep(Duration::from_secs_f64(seconds));
}

/// Waits until the screen differs from what was `seen`, or is as it was, and says how long that took.
#[track_caller]
fn until(screen: &Screen, what: &str, is_so: impl Fn(&Screen) -> bool) {
    let start = Instant::now();
    while !is_so(screen) {
        assert!(start.elapsed() < PATIENCE, "{what}");
        thread::sleep(LOOK);
    }
    println!("{what}: {:.1} s", start.elapsed().as_secs_f64());
}

/// Whether nothing on it moves.
fn is_still(screen: &Screen) -> bool {
    let (_, _, seen) = screen.see();
    pause(0.4);
    screen.differs(&seen) == 0.0
}

#[test]
fn a_wall_is_visited_and_comes_back_from_whatever_happens() {
    if screen::is_skipped() {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let exhibit = folder.path().join("exhibit");
    fs::create_dir(&exhibit).expect("a folder");
    super::write_exhibit(&exhibit);
    // The disk for the logs is full from the start.
    let logs = folder.path().join("logs");
    fs::create_dir(&logs).expect("a folder");
    symlink("/dev/full", logs.join("recto.log")).expect("a link");
    let mut screen = Screen::new(SCREEN);
    let wall = Wall::hang(&screen, folder.path());

    wall.wait("started", is("showing"));
    until(&screen, "a picture", |screen| screen.light() > LIT);
    // A visitor turns the sheet, in either window.
    for place in [LEFT, RIGHT] {
        screen.point(place);
        pause(1.0);
        let (_, _, before) = screen.see();
        screen.drag(place, [place[0] + 60, place[1] + 40]);
        until(&screen, "turned", |screen| {
            screen.differs(&before) > CHANGED
        });
        // It comes back, and the controls come to the display that was touched.
        until(&screen, "at rest", is_still);
    }
    // They look until the hint has gone, say that they are still there, and leave.
    pause(9.0);
    let (_, _, before) = screen.see();
    until(&screen, "counts down", |screen| {
        screen.differs(&before) > CHANGED
    });
    screen.click(RIGHT);
    wall.wait("refused", is("showing"));
    let status = wall.status().expect("a status");
    assert_eq!(status["sessions_today"], 1, "{status}");
    wall.wait("tours", is("attract"));
    screen.click(RIGHT);
    wall.wait("handed over", is("showing"));
    let status = wall.status().expect("a status");
    assert!(status["lines_lost"].as_u64() > Some(0), "{status}");

    // The program is killed, and then its windows hang.
    for (signal, happened) in [("KILL", "killed"), ("STOP", "hung")] {
        let window = wall.window();
        wall.signal(signal);
        until(&screen, happened, |_| {
            wall.window().is_some_and(|now| Some(now) != window)
        });
        wall.wait("and shows again", shows);
        until(&screen, "a picture", |screen| screen.light() > LIT);
    }

    // The exhibit's folder is gone, the picture is not, and the technician is told.
    let aside = folder.path().join("aside");
    fs::rename(&exhibit, &aside).expect("it is taken away");
    let status = wall.wait("gone", |status| status["state"] == "faulty");
    let told = status["faults"].to_string();
    assert!(told.contains("exhibit"), "{told}");
    pause(2.0);
    assert!(screen.light() > LIT);
    fs::rename(&aside, &exhibit).expect("it is put back");
    wall.wait("put back", shows);

    // There is room for logs again.
    fs::remove_file(logs.join("recto.log")).expect("the full disk");
    super::draw_paper(&exhibit.join("paper.png"), 120);
    wall.signal("KILL");
    until(&screen, "written down again", |_| {
        fs::read_to_string(logs.join("recto.log")).is_ok_and(|text| text.contains("started"))
    });
    wall.wait("and shows", shows);
}
