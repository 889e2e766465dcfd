//! `recto supervise` with shell scripts for windows.

use std::{
    fs,
    os::unix::{fs::PermissionsExt, net::UnixDatagram},
    path::PathBuf,
    process::{Child, Command, Output, Stdio},
    thread,
    time::Duration,
};

use tempfile::TempDir;

use super::{code, recto};

/// What every script begins with: `n` counts the starts from 1, `beat COMPLETED REQUESTED STATE`
/// is a heartbeat, and `leave` is what staff do.
const BEGINNING: &str = r#"#!/bin/sh
here=$(dirname "$0")
n=$(cat "$here/starts" 2>/dev/null || echo 0)
n=$((n + 1))
echo $n > "$here/starts"
echo "$*" > "$here/arguments"
t=0
beat() {
    t=$((t + 1))
    echo "recto 1 completed=$1 requested=$2 unix_ms=$t state=$3" > "$RECTO_HEARTBEAT.sh"
    mv "$RECTO_HEARTBEAT.sh" "$RECTO_HEARTBEAT"
}
leave() { beat 9 9 end; exit 0; }
live() { i=1; while [ $i -le $1 ]; do beat $i $i running; i=$((i + 1)); sleep 0.05; done; }
"#;

/// A window's script, and the folder that it writes to.
struct Window {
    folder: TempDir,
}

impl Window {
    fn new(script: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("window");
        fs::write(&file, format!("{BEGINNING}{script}\n")).unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o755)).unwrap();
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_default()
    }

    /// The supervisor of it, quicker than a museum's.
    fn command(&self) -> Command {
        let mut command = recto();
        command
            .args(["supervise", "--start-limit", "20", "--idle-limit", "2"])
            .args(["--hang-limit", "1", "--", "exhibit", "--kiosk"])
            .env("RECTO_SUPERVISE_PROGRAM", self.path("window"))
            .env("XDG_RUNTIME_DIR", self.folder.path())
            .env_remove("NOTIFY_SOCKET")
            .env_remove("WATCHDOG_USEC");
        command
    }

    fn run(&self) -> Output {
        self.command().output().unwrap()
    }

    #[track_caller]
    fn log(&self, starts: u32) -> String {
        let log = code(&self.run(), 0);
        assert_eq!(self.text("starts").trim(), starts.to_string(), "{log}");
        log
    }

    /// Waits until the script has written a file.
    fn wait_for(&self, name: &str) {
        while self.text(name).is_empty() {
            thread::sleep(Duration::from_millis(5));
        }
    }
}

#[test]
fn a_window_that_staff_end_stays_ended() {
    let window = Window::new("live 3\nleave");
    let log = window.log(1);
    assert!(
        log.contains("recto supervise: ended, as staff asked for it"),
        "{log}"
    );
    assert_eq!(window.text("arguments").trim(), "show exhibit --kiosk");
    // Its heartbeat's folder goes with it.
    let left: Vec<_> = fs::read_dir(window.folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.starts_with("recto-"))
        .collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn a_crash_is_followed_by_a_new_start_and_the_log_says_how_long_it_took() {
    let window = Window::new("live 3\n[ $n = 1 ] && kill -ABRT $$\nlive 3\nleave");
    let log = window.log(2);
    assert!(log.contains("crashed (signal: 6"), "{log}");
    assert!(log.contains("; again in 1 s"), "{log}");
    assert!(
        log.contains("back, after ") && log.contains(" s without a picture"),
        "{log}"
    );
}

#[test]
fn an_end_that_nobody_asked_for_and_a_code_are_no_ends() {
    let window = Window::new("live 2\n[ $n = 1 ] && exit 0\n[ $n = 2 ] && exit 3\nleave");
    let log = window.log(3);
    assert!(log.contains("ended, and nobody asked for it"), "{log}");
    assert!(log.contains("ended with code 3"), "{log}");
}

#[test]
fn each_loss_of_the_picture_is_told_with_its_own_time() {
    let window = Window::new("live 24\n[ $n -lt 3 ] && exit 1\nleave");
    let log = window.log(3);
    let without: Vec<f64> = log
        .lines()
        .filter_map(|line| line.split_once("back, after ")?.1.split_once(" s without"))
        .map(|(seconds, _)| seconds.parse().unwrap())
        .collect();
    // It ran for more than a second in between, which is no part of the second loss.
    assert_eq!(without.len(), 2, "{log}");
    assert!(without[0] >= 1.0 && without[1] >= 2.0, "{log}");
    let ran = log
        .lines()
        .filter(|line| line.contains("code 1 after 1.") || line.contains("code 1 after 2."));
    assert_eq!(ran.count(), 2, "{log}");
}

#[test]
fn a_window_that_begins_anew_by_itself_does_so_at_once() {
    let window = Window::new("live 2\n[ $n -lt 4 ] && { beat 5 5 restart; exit 0; }\nleave");
    let log = window.log(4);
    assert_eq!(log.matches("ended to begin anew").count(), 3, "{log}");
    assert_eq!(log.matches("again at once").count(), 3, "{log}");
}

#[test]
fn a_heartbeat_that_stops_is_a_hang() {
    // It does not even end when it is asked to.
    let window =
        Window::new("live 3\n[ $n = 1 ] && { trap '' TERM; while :; do sleep 1; done; }\nleave");
    let log = window.log(2);
    assert!(log.contains("hung: no sign of it for 2."), "{log}");
    assert!(log.contains("back, after "), "{log}");
}

#[test]
fn frames_that_are_begun_and_never_completed_are_a_hang() {
    // The heartbeat goes on: the renderer hangs, and not the program.
    let window = Window::new(
        "live 3\n[ $n = 1 ] && { while :; do beat 3 $((t + 4)) running; sleep 0.05; done; }\nleave",
    );
    let log = window.log(2);
    assert!(log.contains("hung: no frame was completed for 1."), "{log}");
}

#[test]
fn a_window_without_a_first_frame_is_begun_anew() {
    let window = Window::new("[ $n = 1 ] && { beat 0 1 running; sleep 60; }\nleave");
    let mut command = recto();
    command
        .args(["supervise", "--start-limit", "1"])
        .env("RECTO_SUPERVISE_PROGRAM", window.path("window"));
    let log = code(&command.output().unwrap(), 0);
    assert!(log.contains("had no first frame within 1."), "{log}");
}

#[test]
fn one_that_fails_at_once_is_waited_for_longer_and_longer() {
    let window = Window::new("[ $n -lt 4 ] && exit 1\nleave");
    let log = window.log(4);
    let waits: Vec<&str> = log
        .lines()
        .filter_map(|line| line.split_once("again in ").map(|(_, wait)| wait))
        .collect();
    assert_eq!(waits, ["1 s", "2 s", "4 s"], "{log}");
}

#[test]
fn wrong_usage_is_not_tried_again() {
    let window = Window::new("echo 'no such option' >&2\nexit 2");
    let output = window.run();
    let log = code(&output, 2);
    assert_eq!(window.text("starts").trim(), "1");
    assert!(
        log.contains("no such option"),
        "the window's own words: {log}"
    );
    // After a frame it is no longer wrong usage.
    let window = Window::new("live 1\n[ $n = 1 ] && { sleep 0.3; exit 2; }\nleave");
    assert!(window.log(2).contains("ended with code 2"));
}

#[test]
fn a_program_that_is_not_there_is_told_and_tried_again() {
    let window = Window::new("leave");
    let mut child = window
        .command()
        .env("RECTO_SUPERVISE_PROGRAM", window.path("nothing"))
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().unwrap().is_none());
    ask(&child, "TERM");
    let log = code(&child.wait_with_output().unwrap(), 0);
    assert!(log.contains("nothing cannot be started"), "{log}");
}

fn ask(child: &Child, signal: &str) {
    let sent = Command::new("kill")
        .arg(format!("-{signal}"))
        .arg(child.id().to_string())
        .status()
        .unwrap();
    assert!(sent.success());
}

#[test]
fn a_signal_is_passed_on_and_both_end() {
    for signal in ["TERM", "INT", "HUP"] {
        let window = Window::new(
            "for s in TERM INT HUP; do trap \"echo $s > $here/got; exit 0\" $s; done\n\
             live 2\necho up > \"$here/up\"\nwhile :; do beat 2 2 running; sleep 0.05; done",
        );
        let child = window.command().stderr(Stdio::piped()).spawn().unwrap();
        window.wait_for("up");
        ask(&child, signal);
        let log = code(&child.wait_with_output().unwrap(), 0);
        assert_eq!(window.text("got").trim(), signal, "{log}");
        assert_eq!(window.text("starts").trim(), "1", "{log}");
        assert!(
            log.contains(&format!("ends, as SIG{signal} asks for it")),
            "{log}"
        );
    }
}

#[test]
fn the_shipped_unit_starts_what_there_is() {
    let unit = include_str!("../../assets/recto.service");
    let value = |key: &str| {
        let line = unit.lines().find_map(|line| line.strip_prefix(key));
        line.unwrap_or_else(|| panic!("no {key}"))
    };
    for (key, expected) in [("Type=", "notify"), ("Restart=", "always")] {
        assert_eq!(value(key), expected);
    }
    assert!(value("WatchdogSec=").parse::<u32>().unwrap() >= 10);
    // Its command line, with a window that ends as soon as staff ask for it.
    let window = Window::new("leave");
    let words: Vec<String> = value("ExecStart=")
        .split(' ')
        .map(|word| word.replace("%h", "/home/wall"))
        .collect();
    assert!(words[0].ends_with("/recto"));
    let output = recto()
        .args(&words[1..])
        .env("RECTO_SUPERVISE_PROGRAM", window.path("window"))
        .output()
        .unwrap();
    code(&output, 0);
    assert_eq!(
        window.text("arguments").trim(),
        "show --kiosk --installation /home/wall/recto/installation.toml"
    );
}

#[test]
fn systemd_is_told_how_it_is_and_the_window_is_not_told_of_systemd() {
    let window = Window::new(
        "echo \"socket=$NOTIFY_SOCKET usec=$WATCHDOG_USEC\" > \"$here/environment\"\n\
         live 12\n[ $n = 1 ] && kill -SEGV $$\nleave",
    );
    let socket = UnixDatagram::bind(window.path("notify")).unwrap();
    let reader = socket.try_clone().unwrap();
    // The socket holds a few words only, and whoever speaks waits until they are heard.
    let heard = thread::spawn(move || {
        let mut told = Vec::new();
        let mut buffer = [0; 512];
        while !told.iter().any(|text: &String| text.contains("STOPPING=1")) {
            let length = reader.recv(&mut buffer).unwrap();
            told.push(String::from_utf8_lossy(&buffer[..length]).into_owned());
        }
        told
    });
    let output = window
        .command()
        .env("NOTIFY_SOCKET", window.path("notify"))
        .env("WATCHDOG_USEC", "300000")
        .output()
        .unwrap();
    code(&output, 0);
    let told = heard.join().unwrap();
    let told_at = |words: &str| told.iter().position(|text| text.contains(words));
    let ready = told_at("READY=1").expect("it is ready with the first frame");
    let shows = told_at("STATUS=shows its picture").expect("and then there is a picture");
    assert!(ready < shows, "{told:?}");
    assert!(told_at("WATCHDOG=1").is_some(), "{told:?}");
    let failed = told_at("STATUS=1 restarts, the last as it crashed").unwrap();
    assert!(shows < failed, "{told:?}");
    assert_eq!(window.text("environment").trim(), "socket= usec=");
}
