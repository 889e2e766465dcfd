//! Recto.
#![forbid(unsafe_code)]

pub mod colour;
pub mod device;
pub mod manifest;
pub mod maps;
pub mod needs;
pub mod optics;
pub mod sheet;
pub mod shot;
pub mod stage;
pub mod units;
