//! The photographer's bench: photographs of a sheet under several lamps → maps of it.
//!
//! | step | where |
//! |---|---|
//! | `capture.toml` → what is known of the photographs | [`capture`] |
//! | many photographs, a band of rows at a time | [`photographs`] |
//! | the same made smaller, to look for things in | [`reduced`] |
//! | whether the camera was still | [`moved`] |
//! | whether they are black or over-exposed | [`exposed`] |
//! | where the lamps are, and how bright | [`lights`] |
//! | a lamp's light over the picture, from a grey card | [`flat_field`] |
//! | a camera's colours → the sheet's | [`colour`] |
//! | how rough paper and ink are, before stereo | [`gloss::first`] |
//! | photographs under lamps → albedo and normals | [`stereo`] |
//! | whether lamps are a quarter of a turn away | [`turned`] |
//! | normals → the sheet's shape and its grain, in mm | [`relief`] |
//! | the paper that maps are shown by, for fits that undo it | [`model`] |
//! | swatches → what each place is drawn with | [`materials`] |
//! | photographs of a material → its roughness | [`gloss`] |
//! | a picture of ink → its depth | [`depth`] |
//! | the sheet on a light table → what its paper passes | [`transmission`] |
//! | these four for a side | [`matter`] |
//! | a verso's place on its recto | [`verso`] |
//! | the photographs of a side, run through once: normals, albedo, and the rest | `solve`, `albedo` |
//! | codes of maps and linear light | `codes` |
//! | its normals → shape at large, grain and strokes | `shape` |
//! | what the photographs leave over, counted | [`residuals`] |
//! | all of it, as a command does it | [`run`] |
//! | what came of it: a verdict, plots and pictures on one page | [`report`] |
//!
//! Lamps and normals are in the sheet's frame: x right, y up in the photograph, z towards the
//! camera; a photograph's rows run down from its top.

mod albedo;
pub mod capture;
mod codes;
pub mod colour;
pub mod depth;
pub mod exposed;
pub mod find;
pub mod flat_field;
pub mod gloss;
pub mod lights;
pub mod linear;
pub mod materials;
pub mod matter;
pub mod model;
pub mod moved;
pub mod photographs;
pub mod reduced;
pub mod relief;
pub mod report;
pub mod residuals;
mod run;
mod shape;
mod solve;
mod stage;
pub mod stereo;
pub mod transmission;
pub mod turned;
pub mod verso;
mod write;

pub use run::{LampFound, PrepareError, Progress, Report, SideReport, run};
