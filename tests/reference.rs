//! The judge itself: does the f64 random walk keep energy, sample what it says, and agree with
//! its own other halves, with OPTICS' figures and with another renderer?
//!
//! Every test is seeded, so a z of 4 is a fault and not bad luck.

#[path = "reference/statistic.rs"]
mod statistic;

#[path = "reference/calibration.rs"]
mod calibration;
#[path = "reference/interface.rs"]
mod interface;
#[path = "reference/mitsuba.rs"]
mod mitsuba;
#[path = "reference/sampling.rs"]
mod sampling;
#[path = "reference/sheet.rs"]
mod sheet;
