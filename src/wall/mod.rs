//! The room and its technician: what keeps a wall running when nobody looks after it, and who is told how
//! it is.
//!
//! | module | what it is |
//! |---|---|
//! | [`house`] | an installation's displays, manners and words, and the window that has them |
//! | [`keeper`] | follows the clock, the staff and the visitors in it |
//! | [`desktop`] | whether displays are where the file says, by the monitors there are |
//! | [`panes`] | one picture over several displays |
//! | [`together`] | several machines of one wall: one leads, the others follow |
//! | [`publish`] | an exhibit's new version, whole or not at all |
//! | [`heartbeat`] | what a window says of itself, for whoever looks after it |
//! | [`supervise`] | begins it anew when it crashes, hangs or ends |
//! | [`health`] | how it is: state, faults, frames, memory |
//! | [`status`] | a page and JSON of it for the technician |
//! | [`journal`] | lines in files that never fill the disk |
//! | [`usage`] | counts of scenes and languages, without people |

pub mod desktop;
pub mod health;
pub mod heartbeat;
pub mod house;
pub mod journal;
pub mod keeper;
pub mod panes;
pub mod publish;
mod signals;
pub mod status;
pub mod supervise;
pub mod together;
pub mod usage;
