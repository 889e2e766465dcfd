//! The judge itself: does the f64 random walk keep energy, sample what it says, and agree with
//! its own other halves, with OPTICS' figures and with another renderer?
//!
//! Every test is seeded, so a z of 4 is a fault and not bad luck.

#[path = "support/crop.rs"]
mod crop;
#[path = "reference/statistic.rs"]
mod statistic;

#[path = "reference/bake.rs"]
mod bake;
#[path = "reference/calibration.rs"]
mod calibration;
#[path = "reference/grains.rs"]
mod grains;
#[path = "reference/interface.rs"]
mod interface;
#[path = "reference/lateral.rs"]
mod lateral;
#[path = "reference/mitsuba.rs"]
mod mitsuba;
#[path = "reference/pictures.rs"]
mod pictures;
#[path = "reference/sampling.rs"]
mod sampling;
#[path = "reference/sheet.rs"]
mod sheet;
