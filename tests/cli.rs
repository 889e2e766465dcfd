//! The command line as a contract: exit codes, streams and files.

#[path = "cli/bsdf.rs"]
mod bsdf;
#[path = "cli/commands.rs"]
mod commands;
#[path = "cli/drawn.rs"]
mod drawn;
#[path = "cli/figure.rs"]
mod figure;
#[path = "cli/masks.rs"]
mod masks;
#[path = "cli/measure.rs"]
mod measure;
#[path = "cli/missing.rs"]
mod missing;
#[path = "cli/place.rs"]
mod place;
#[path = "cli/probe.rs"]
mod probe;
#[path = "cli/reference.rs"]
mod reference;
#[path = "cli/register.rs"]
mod register;
#[path = "cli/render.rs"]
mod render;
mod support;

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
};

use recto::maps::encode;
use tempfile::TempDir;

/// Edge of the sheet's picture in pixels.
const EDGE: u32 = 16;

fn recto() -> Command {
    Command::new(env!("CARGO_BIN_EXE_recto"))
}

fn run(arguments: &[&str]) -> Output {
    recto().args(arguments).output().unwrap()
}

#[track_caller]
fn code(output: &Output, code: i32) -> String {
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{stderr}");
    stderr
}

fn stdout(output: &Output) -> &str {
    std::str::from_utf8(&output.stdout).unwrap()
}

/// An exhibit of one small sheet in two scenes, removed when it is dropped.
struct Sheet {
    root: TempDir,
}

impl Sheet {
    fn new() -> Self {
        let sheet = Self {
            root: tempfile::tempdir().unwrap(),
        };
        fs::create_dir(sheet.exhibit()).unwrap();
        write_picture(&sheet.exhibit().join("sheet.png"), None);
        let grey = [150; (EDGE * EDGE) as usize];
        encode::save_png_grey8(&sheet.exhibit().join("verso.png"), EDGE, EDGE, &grey, None)
            .unwrap();
        fs::write(
            sheet.exhibit().join("exhibit.toml"),
            r##"
[[drawing]]
id = "sheet"
size_mm = [100, 100]
recto.albedo = "sheet.png"
verso.albedo = "verso.png"

[[drawing.overlay]]
id = "picture"
kind = "picture"
file = "sheet.png"

[[scene]]
id = "whole"

[[scene]]
id = "tilted"
camera = { tilt_deg = 40, distance_mm = 300 }
overlays = [{ id = "picture", opacity = 0.5 }]
"##,
        )
        .unwrap();
        sheet
    }

    /// The same with a state, media in two layers, a stack of two bands and a lamp with a spectrum
    /// from a file, in scenes that each need some of it.
    fn rich() -> Self {
        let sheet = Self::new();
        let grey = |name: &str, value: u8| {
            let pixels = [value; (EDGE * EDGE) as usize];
            encode::save_png_grey8(&sheet.exhibit().join(name), EDGE, EDGE, &pixels, None).unwrap();
        };
        for (name, value) in [("before.png", 90), ("550.png", 51), ("850.png", 204)] {
            grey(name, value);
        }
        for (name, value) in [("under.png", 255), ("over.png", 100)] {
            grey(name, value);
        }
        fs::write(sheet.exhibit().join("even.csv"), "nm,W\n360,2\n800,2\n").unwrap();
        fs::write(
            sheet.exhibit().join("exhibit.toml"),
            r##"
[[drawing]]
id = "sheet"
size_mm = [100, 100]
recto.albedo = "sheet.png"
recto.media = [
    { file = "under.png", weights = ["iron-gall-ink"] },
    { file = "over.png", weights = ["white-gouache"] },
]
verso.albedo = "verso.png"

[[drawing.state]]
id = "before"
recto.albedo = "before.png"

[[drawing.stack]]
id = "light"
encoding = "linear"
bands = [{ file = "850.png", wavelength_nm = 850 }, { file = "550.png", wavelength_nm = 550 }]
difference = [{ id = "ink", of = [850, 550] }]

[[lamp]]
id = "even"
kind = "distant"
lux_at_sheet = 500
elevation_deg = 45
azimuth_deg = 135
spectrum = { file = "even.csv" }

[[scene]]
id = "now"

[[scene]]
id = "then"
state = "before"

[[scene]]
id = "both"
compare = { mode = "curtain", of = ["state:before", "state:none"] }
enhance = { exaggerate = 2, sharpen = 0.5 }

[[scene]]
id = "ink"
compare = { mode = "loupe", of = ["side:recto", "band:light/ink"] }
"##,
        )
        .unwrap();
        sheet
    }

    fn exhibit(&self) -> PathBuf {
        self.root.path().join("exhibit")
    }

    fn out(&self, name: &str) -> PathBuf {
        self.root.path().join(name)
    }

    fn render(&self, out: &Path, more: &[&str]) -> Command {
        let mut command = recto();
        command
            .arg("render")
            .arg(self.exhibit())
            .args(["--size", "64x64", "--out"])
            .arg(out)
            .args(more);
        command
    }
}

/// A colourful picture that is nowhere symmetrical.
fn write_picture(path: &Path, dpi: Option<f64>) {
    let pixels: Vec<[u8; 3]> = (0..EDGE * EDGE)
        .map(|i| [i % 256, 40 + i / EDGE * 12, 255 - i % EDGE * 15].map(|v| v as u8))
        .collect();
    encode::save_png_rgb8(path, EDGE, EDGE, &pixels, dpi).unwrap();
}

/// The files in a folder, by name.
fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// Runs a command whose standard output is closed from the start.
fn with_closed_stdout(command: &mut Command) -> Output {
    let mut child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    child.wait_with_output().unwrap()
}
