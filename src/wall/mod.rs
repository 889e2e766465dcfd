//! The wall, which runs by itself: what is known about its health, and who is told.
//!
//! | what | where |
//! |---|---|
//! | how it is: state, faults, frames, memory | [`health`] |
//! | a page and JSON of it for the technician | [`status`] |
//! | lines in files that never fill the disk | [`journal`] |
//! | counts of scenes and languages, without people | [`usage`] |

pub mod health;
pub mod journal;
pub mod status;
pub mod usage;
