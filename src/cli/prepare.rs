//! `recto prepare`

use std::path::PathBuf;

use super::{Failure, output, warn};
use crate::prepare::{self, capture::Capture};

#[derive(clap::Args)]
pub struct Arguments {
    /// The capture file, or the folder it is in
    capture: PathBuf,
    /// The folder of the exhibit, made if it is absent
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Steps of the bar.
const STEPS: u64 = 1000;

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (capture, warnings) = Capture::read(&arguments.capture)?;
    warn(&warnings);
    output::can_write_folder(&arguments.out)?;
    let bar = output::progress(STEPS);
    let report = prepare::run(&capture, &arguments.out, &mut |progress| {
        bar.set_message(progress.step);
        // A cast saturates.
        bar.set_position((progress.done * STEPS as f64) as u64);
    });
    bar.finish_and_clear();
    let report = report?;
    for side in &report.sides {
        output::say(format_args!(
            "{} × {} pixels; photographs leave {:.1} % over, {:.1} % of places were doubted",
            side.size[0],
            side.size[1],
            side.residual[0] * 100.0,
            side.doubted * 100.0
        ));
    }
    output::result(report.manifest.display())
}
