//! `recto supervise`

use std::{ffi::OsString, path::PathBuf, time::Duration};

use super::{Failure, output};
use crate::wall::supervise::{self, Ended, Limits, Supervised};

/// Names another program than this one, for tests of what becomes of it.
const PROGRAM: &str = "RECTO_SUPERVISE_PROGRAM";

#[derive(clap::Args)]
pub struct Arguments {
    /// How many seconds the first frame may take after a start
    #[arg(long, value_name = "S", default_value = "180", value_parser = seconds)]
    start_limit: Duration,
    /// How many seconds the window may be silent; an idle one draws a frame a minute
    #[arg(long, value_name = "S", default_value = "90", value_parser = seconds)]
    idle_limit: Duration,
    /// How many seconds one frame may take
    #[arg(long, value_name = "S", default_value = "10", value_parser = seconds)]
    hang_limit: Duration,
    /// What `recto show` is told: its exhibit and options
    #[arg(last = true, value_name = "ARGUMENTS OF SHOW")]
    show: Vec<OsString>,
}

fn seconds(text: &str) -> Result<Duration, String> {
    let number = text.trim().parse().ok();
    number
        .filter(|seconds| (0.1..=86_400.0).contains(seconds))
        .map(Duration::from_secs_f64)
        .ok_or_else(|| "write a number of seconds from 0.1 to 86400".to_owned())
}

pub fn run(arguments: Arguments) -> Result<(), Failure> {
    // Found once: it may be replaced by a newer one while it runs, which then is started.
    let program = match std::env::var_os(PROGRAM) {
        Some(program) => PathBuf::from(program),
        None => std::env::current_exe()?,
    };
    let supervised = Supervised {
        program,
        arguments: [OsString::from("show")]
            .into_iter()
            .chain(arguments.show)
            .collect(),
        limits: Limits {
            start: arguments.start_limit,
            idle: arguments.idle_limit,
            hang: arguments.hang_limit,
        },
    };
    let mut say = |words: &str| output::say(words);
    match supervise::supervise(&supervised, &mut say) {
        Ok(Ended::Asked) => Ok(()),
        Ok(Ended::WrongUsage) => Err(Failure::Ended(2)),
        Err(error) => Err(Failure::Input(Box::new(error))),
    }
}
