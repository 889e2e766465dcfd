//! The photographer's bench: photographs → maps, judged by surfaces that are known.

mod support;

#[path = "prepare/capture.rs"]
mod capture;
#[path = "prepare/chain.rs"]
mod chain;
#[path = "prepare/colour.rs"]
mod colour;
#[path = "prepare/lights.rs"]
mod lights;
#[path = "prepare/photographs.rs"]
mod photographs;

#[path = "prepare/relief.rs"]
mod relief;
#[path = "prepare/shown.rs"]
mod shown;
#[path = "prepare/sitting.rs"]
mod sitting;
#[path = "prepare/stereo.rs"]
mod stereo;
#[path = "prepare/walked.rs"]
mod walked;

/// A folder that lives as long as the test.
fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}
