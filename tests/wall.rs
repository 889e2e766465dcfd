//! A wall's picture on its displays, several machines that carry it, and what keeps it running, with real
//! processes: publishing beside a reader, and a supervisor with windows that crash, hang and end.
#![cfg(unix)]

#[path = "wall/panes.rs"]
mod panes;
#[path = "wall/processes.rs"]
mod processes;
#[path = "wall/publish.rs"]
mod publish;
#[path = "support/screen.rs"]
#[allow(dead_code, reason = "other tests click, and look at the light")]
mod screen;
#[path = "wall/supervise.rs"]
mod supervise;
#[path = "wall/together.rs"]
mod together;

use std::process::{Command, Output};

fn recto() -> Command {
    Command::new(env!("CARGO_BIN_EXE_recto"))
}

#[track_caller]
fn code(output: &Output, code: i32) -> String {
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{stderr}");
    stderr
}
