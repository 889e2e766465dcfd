//! The photographer's bench: photographs → maps, judged by surfaces that are known.

mod support;

#[path = "prepare/ball.rs"]
mod ball;
#[path = "prepare/capture.rs"]
mod capture;
#[path = "prepare/chain.rs"]
mod chain;
#[path = "prepare/chart.rs"]
mod chart;
#[path = "prepare/colour.rs"]
mod colour;
#[path = "prepare/creased.rs"]
mod creased;
#[path = "prepare/gloss.rs"]
mod gloss;
#[path = "prepare/interrupted.rs"]
mod interrupted;
#[path = "prepare/light.rs"]
mod light;
#[path = "prepare/lights.rs"]
mod lights;
#[path = "prepare/made.rs"]
mod made;
#[path = "prepare/materials.rs"]
mod materials;
#[path = "prepare/memory.rs"]
mod memory;
#[path = "prepare/gltf.rs"]
mod model;
#[path = "prepare/moved.rs"]
mod moved;
#[path = "prepare/page.rs"]
mod page;
#[path = "prepare/photographs.rs"]
mod photographs;
#[path = "prepare/relief.rs"]
mod relief;
#[path = "prepare/reported.rs"]
mod reported;
#[path = "prepare/ruler.rs"]
mod ruler;
#[path = "prepare/shown.rs"]
mod shown;
#[path = "prepare/sitting.rs"]
mod sitting;
#[path = "prepare/stereo.rs"]
mod stereo;
#[path = "prepare/transmission.rs"]
mod transmission;
#[path = "prepare/verdicts.rs"]
mod verdicts;
#[path = "prepare/verso.rs"]
mod verso;
#[path = "prepare/walked.rs"]
mod walked;

/// A folder that lives as long as the test.
fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}
