//! The photographer's bench: photographs of a sheet under several lamps → maps of it.
//!
//! | step | where |
//! |---|---|
//! | `capture.toml` → what is known of the photographs | [`capture`] |
//! | many photographs, a band of rows at a time | [`photographs`] |
//! | the same made smaller, to look for things in | [`reduced`] |
//! | whether the camera was still | [`moved`] |
//! | where the lamps are, and how bright | [`lights`] |
//! | a lamp's light over the picture, from a grey card | [`flat_field`] |
//! | a camera's colours → the sheet's | [`colour`] |
//! | photographs under lamps → albedo and normals | [`stereo`] |
//! | normals → the sheet's shape and its grain, in mm | [`relief`] |
//! | a verso's place on its recto | [`verso`] |
//! | all of it, as a command does it | [`run`] |
//!
//! Lamps and normals are in the sheet's frame: x right, y up in the photograph, z towards the
//! camera; a photograph's rows run down from its top.

pub mod capture;
pub mod colour;
pub mod find;
pub mod flat_field;
pub mod lights;
pub mod linear;
pub mod moved;
pub mod photographs;
pub mod reduced;
pub mod relief;
mod report;
mod run;
mod stage;
pub mod stereo;
pub mod verso;
mod write;

pub use run::{LampFound, PrepareError, Progress, Report, SideReport, run};
