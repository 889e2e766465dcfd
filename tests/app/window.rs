//! The program in a real window, on an X server of its own.

use std::{
    fs,
    io::Read,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use super::screen::{self, Running, Screen};

const SCREEN: [u32; 2] = [640, 480];
/// How long anything may take on a slow machine.
const PATIENCE: Duration = Duration::from_secs(120);
/// Without a frame for so long, the window has settled.
const SETTLED: Duration = Duration::from_secs(3);
/// The promise: so long without a single frame.
const IDLE: Duration = Duration::from_secs(10);
const LOOK: Duration = Duration::from_millis(100);

/// `recto show` on an exhibit.
struct Window {
    program: Running,
    words: thread::JoinHandle<String>,
    log: PathBuf,
}

impl Window {
    fn open(display: &str, exhibit: &Path, log: PathBuf) -> Self {
        let mut program = Running(
            Command::new(env!("CARGO_BIN_EXE_recto"))
                .arg("show")
                .arg(exhibit)
                .args(["--size", "320x240", "--tier", "draft"])
                .env("DISPLAY", display)
                .env("RECTO_FRAME_LOG", &log)
                .env_remove("WAYLAND_DISPLAY")
                .stderr(Stdio::piped())
                .spawn()
                .expect("the program starts"),
        );
        let mut stderr = program.0.stderr.take().expect("its words");
        let words = thread::spawn(move || {
            let mut words = String::new();
            // What is not text is of no interest here.
            let _ = stderr.read_to_string(&mut words);
            words
        });
        Self {
            program,
            words,
            log,
        }
    }

    /// How many frames it has drawn.
    fn frames(&mut self) -> u64 {
        if let Some(status) = self.program.0.try_wait().expect("its status") {
            panic!("the window closed: {status}");
        }
        let text = fs::read_to_string(&self.log).unwrap_or_default();
        text.trim().parse().unwrap_or_default()
    }

    /// Waits until more than `before` frames are drawn, and then none for a while.
    fn settle_after(&mut self, before: u64) -> u64 {
        let start = Instant::now();
        let (mut last, mut since) = (self.frames(), Instant::now());
        while last <= before || since.elapsed() < SETTLED {
            assert!(start.elapsed() < PATIENCE, "it draws on: {last} frames");
            thread::sleep(LOOK);
            let now = self.frames();
            if now != last {
                (last, since) = (now, Instant::now());
            }
        }
        last
    }

    /// Closes it and returns what it wrote on standard error.
    fn close(mut self) -> String {
        self.program.0.kill().expect("it was running");
        self.words.join().expect("its words")
    }
}

#[test]
fn the_window_rests_reloads_and_outlives_a_faulty_save() {
    if screen::is_skipped() {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    super::write_exhibit(folder.path());
    let logs = tempfile::tempdir().expect("a temporary folder");
    let screen = Screen::new(SCREEN);
    let mut window = Window::open(&screen.display, folder.path(), logs.path().join("frames"));

    let settled = window.settle_after(0);
    thread::sleep(IDLE);
    assert_eq!(window.frames(), settled, "an idle window draws nothing");

    super::draw_paper(&folder.path().join("paper.png"), 90);
    let repainted = window.settle_after(settled);

    let manifest = folder.path().join("exhibit.toml");
    let faulty = super::MANIFEST.replace("size_mm = [300.0", "size_mn = [300.0");
    fs::write(&manifest, faulty).expect("the manifest is written");
    thread::sleep(SETTLED);
    assert_eq!(window.frames(), repainted, "the last good exhibit stays");

    // As editors do: the old file goes, a new one comes.
    let saved = folder.path().join("exhibit.toml.part");
    fs::write(&saved, super::MANIFEST.replace("Two", "Some")).expect("the manifest is written");
    fs::remove_file(&manifest).expect("the old one goes");
    fs::rename(&saved, &manifest).expect("the new one comes");
    window.settle_after(repainted);

    let words = window.close();
    assert!(words.contains("exhibit.toml:7:1"), "{words}");
    assert!(words.contains("did you mean \"size_mm\"?"), "{words}");
    assert_eq!(words.matches("size_mn").count(), 2, "told once: {words}");
}

/// Damages the pixels of a picture whose length and time stay, so that nothing notices before
/// it is decoded again; a picture that is written twice in a row does the same by chance.
fn damage_unseen(path: &Path) {
    let time = fs::metadata(path).and_then(|data| data.modified());
    let mut bytes = fs::read(path).expect("a picture");
    let data = bytes.windows(4).position(|name| name == b"IDAT");
    bytes[data.expect("its pixels") + 4..].fill(0);
    fs::write(path, bytes).expect("the picture is written");
    let file = fs::File::options().write(true).open(path);
    file.and_then(|file| file.set_modified(time?))
        .expect("its time is set back");
}

#[test]
fn a_damaged_map_leaves_the_last_picture_until_it_is_mended() {
    if screen::is_skipped() {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    super::write_exhibit(folder.path());
    let [paper, other] = ["paper.png", "other.png"].map(|name| folder.path().join(name));
    super::draw_paper(&other, 200);
    let manifest = folder.path().join("exhibit.toml");
    let (sheet, page) = super::MANIFEST
        .split_once("id = \"page\"")
        .expect("two drawings");
    let page = page.replace("paper.png", "other.png");
    let text = format!("{sheet}id = \"page\"{page}");
    fs::write(&manifest, &text).expect("the manifest is written");
    // A drawing that is not shown is damaged from the start.
    let whole = fs::read(&other).expect("a picture");
    damage_unseen(&other);
    let logs = tempfile::tempdir().expect("a temporary folder");
    let screen = Screen::new(SCREEN);
    let mut window = Window::open(&screen.display, folder.path(), logs.path().join("frames"));
    let settled = window.settle_after(0);

    // The first scene moves on to it.
    let moved = text.replacen("drawing = \"sheet\"", "drawing = \"page\"", 1);
    fs::write(&manifest, moved).expect("the manifest is written");
    thread::sleep(SETTLED);
    assert_eq!(window.frames(), settled, "the last good exhibit stays");

    fs::write(&other, whole).expect("the picture is written");
    fs::write(&manifest, &text).expect("the manifest is written");
    let settled = window.settle_after(settled);

    // The map on screen is read again, and neither version of the exhibit can be shown.
    damage_unseen(&paper);
    super::draw_paper(&other, 90);
    let stuck = window.settle_after(settled);

    super::draw_paper(&paper, 150);
    window.settle_after(stuck);

    let words = window.close();
    for name in ["other.png", "paper.png"] {
        let told = format!("found \"{name}\", which is damaged");
        assert_eq!(words.matches(&told).count(), 1, "{name}, once: {words}");
    }
}

#[test]
fn without_a_display_there_is_advice() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    super::write_exhibit(folder.path());
    for display in ["", ":54321"] {
        let output = Command::new(env!("CARGO_BIN_EXE_recto"))
            .arg("show")
            .arg(folder.path())
            .env("DISPLAY", display)
            .env_remove("WAYLAND_DISPLAY")
            .output()
            .expect("the program starts");
        let words = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{words}");
        assert!(words.contains("recto render"), "{words}");
    }
}
