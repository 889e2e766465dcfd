//! The photographer's bench: photographs → maps, judged by surfaces that are known.

mod support;

#[path = "prepare/capture.rs"]
mod capture;
#[path = "prepare/chain.rs"]
mod chain;
#[path = "prepare/colour.rs"]
mod colour;
#[path = "prepare/gloss.rs"]
mod gloss;
#[path = "prepare/lights.rs"]
mod lights;
#[path = "prepare/made.rs"]
mod made;
#[path = "prepare/materials.rs"]
mod materials;
#[path = "prepare/photographs.rs"]
mod photographs;

#[path = "prepare/relief.rs"]
mod relief;
#[path = "prepare/stereo.rs"]
mod stereo;
#[path = "prepare/transmission.rs"]
mod transmission;

/// A folder that lives as long as the test.
fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}
