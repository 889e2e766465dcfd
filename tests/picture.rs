//! Pictures by the walk: does the judge of frames see what its walk of one spot sees?
//!
//! Every test is seeded, so a z of 4 is a fault and not bad luck.

#[path = "support/crops.rs"]
mod crops;
#[path = "reference/statistic.rs"]
mod statistic;

#[path = "picture/bake.rs"]
mod bake;
#[path = "picture/grains.rs"]
mod grains;
#[path = "picture/lateral.rs"]
mod lateral;
#[path = "picture/sheets.rs"]
mod sheets;
