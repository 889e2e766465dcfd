//! The room's technician: what keeps a wall running when nobody looks after it.
//!
//! | module | what it is |
//! |---|---|
//! | [`publish`] | an exhibit's new version, whole or not at all |
//! | [`heartbeat`] | what a window says of itself, for whoever looks after it |
//! | [`supervise`] | begins it anew when it crashes, hangs or ends |

pub mod heartbeat;
pub mod publish;
mod signals;
pub mod supervise;
