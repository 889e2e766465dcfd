//! From a camera's colours to those of the sheet: a chart, and a correction fitted to it.

pub mod chart;
pub mod correct;
pub mod look;
