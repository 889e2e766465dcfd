//! The landscape: a valley from a height, drawn in two iron-gall inks.

mod boulders;
pub mod composition;
mod foreground;
mod land;
pub mod pens;
pub mod recto;
mod staffage;
mod terrain;
mod town;
mod trees;
mod underdrawing;
mod view;
mod water;
pub mod write;
