//! The program: everything is in the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    recto::cli::run(std::env::args_os())
        .map_or_else(|failure| failure.report(), |()| ExitCode::SUCCESS)
}
