//! What the glue can be composed with.

use std::sync::LazyLock;

pub use recto::cost::Composer;
use recto::sheet::{PAPER_MATERIAL, material::CLIPS};

/// Every name that the glue asks for with `#ifdef`, but for that of the vertex shader alone, sorted.
pub static DEFINITIONS: LazyLock<Vec<&'static str>> = LazyLock::new(|| {
    let mut names: Vec<&str> = PAPER_MATERIAL
        .lines()
        .filter_map(|line| line.trim().strip_prefix("#ifdef "))
        .map(str::trim)
        .filter(|name| *name != CLIPS)
        .collect();
    names.sort_unstable();
    names.dedup();
    names
});
