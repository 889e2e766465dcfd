//! Frames of the shipped program on whatever Vulkan driver there is, judged by closed forms
//! and by real data.

mod support;

#[path = "support/crop.rs"]
mod crop;
#[path = "support/room.rs"]
mod room;
#[path = "support/show_through.rs"]
mod show_through;

#[path = "frames/baselines.rs"]
mod baselines;
#[path = "frames/capture.rs"]
mod capture;
#[path = "frames/changes.rs"]
mod changes;
#[path = "frames/colour.rs"]
mod colour;
#[path = "frames/compare.rs"]
mod compare;
#[path = "frames/crops.rs"]
mod crops;
#[path = "frames/enhance.rs"]
mod enhance;
#[path = "frames/fineness.rs"]
mod fineness;
#[path = "frames/glass.rs"]
mod glass;
#[path = "frames/lamps.rs"]
mod lamps;
#[path = "frames/layers.rs"]
mod layers;
#[path = "frames/media.rs"]
mod media;
#[path = "frames/relief.rs"]
mod relief;
#[path = "frames/saved.rs"]
mod saved;
#[path = "frames/sheets.rs"]
mod sheets;
#[path = "frames/show_through.rs"]
mod shown_through;
#[path = "frames/strange.rs"]
mod strange;
