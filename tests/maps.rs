//! Maps: files → pixels → mip chains, judged by closed forms and by real files.

mod support;

#[path = "maps/bands.rs"]
mod bands;
#[path = "maps/bnf.rs"]
mod bnf;
#[path = "maps/colour.rs"]
mod colour;
#[path = "maps/encode.rs"]
mod encode;
#[path = "maps/files.rs"]
mod files;
#[path = "maps/fitted.rs"]
mod fitted;
#[path = "maps/hostile.rs"]
mod hostile;
#[path = "maps/icc.rs"]
mod icc;
#[path = "maps/levels.rs"]
mod levels;
#[path = "maps/matter.rs"]
mod matter;
#[path = "maps/paper.rs"]
mod paper;
#[path = "maps/propose.rs"]
mod propose;
#[path = "maps/registration.rs"]
mod registration;
#[path = "support/show_through.rs"]
mod show_through;

use std::path::PathBuf;

use recto::maps::{Level, Pyramid};
use show_through::{correlation, mean};

/// A folder that lives as long as the test.
fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// One channel of a level.
fn channel(pyramid: &Pyramid, level: usize, channel: usize) -> Vec<f32> {
    let Level { texels, .. } = &pyramid.levels[level];
    let stride = usize::from(pyramid.channels);
    (channel..texels.len())
        .step_by(stride)
        .map(|i| texels.get(i).expect("inside"))
        .collect()
}

/// Every file below a folder, in order.
fn files_below(folder: &std::path::Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(files_below(&path));
        } else {
            found.push(path);
        }
    }
    found.sort();
    found
}
