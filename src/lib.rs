//! Recto.
#![forbid(unsafe_code)]

pub mod cli;
pub mod colour;
pub mod develop;
pub mod device;
pub mod manifest;
pub mod maps;
pub mod needs;
pub mod optics;
pub mod sample;
pub mod sheet;
pub mod shot;
pub mod stage;
pub mod units;
pub mod visitor;
