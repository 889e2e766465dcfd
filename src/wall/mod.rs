//! The wall, which runs by itself: what is known about its health, who is told, and what keeps it
//! running when nobody looks after it.
//!
//! | what | where |
//! |---|---|
//! | how it is: state, faults, frames, memory | [`health`] |
//! | a page and JSON of it for the technician | [`status`] |
//! | lines in files that never fill the disk | [`journal`] |
//! | counts of scenes and languages, without people | [`usage`] |
//! | an exhibit's new version, whole or not at all | [`publish`] |
//! | what a window says of itself, for whoever looks after it | [`heartbeat`] |
//! | a window begun anew when it crashes, hangs or ends | [`supervise`] |

pub mod health;
pub mod heartbeat;
pub mod journal;
pub mod publish;
mod signals;
pub mod status;
pub mod supervise;
pub mod usage;
