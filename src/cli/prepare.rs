//! `recto prepare`

use std::path::PathBuf;

use super::{Failure, output, warn};
use crate::prepare::{self, capture::Capture, report::REPORT};

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
    let bar = output::long_progress(STEPS);
    let mut told = "";
    let report = prepare::run(&capture, &arguments.out, &mut |progress| {
        // Without a terminal there is no bar, and a large sheet takes minutes.
        if bar.is_hidden() && progress.step != told {
            told = progress.step;
            output::say(format_args!("{:.0} %: {told}", 100.0 * progress.done));
        }
        bar.set_message(progress.step);
        // A cast saturates.
        bar.set_position((progress.done * STEPS as f64) as u64);
    });
    bar.finish_and_clear();
    let report = report?;
    if report.interrupted > 0 {
        output::say(format_args!(
            "what {} interrupted before had left in {} was removed",
            match report.interrupted {
                1 => "a run".to_owned(),
                count => format!("{count} runs"),
            },
            arguments.out.display()
        ));
    }
    for (side, stillness) in report.sides.iter().zip(&report.stillness) {
        output::say(format_args!(
            "{} × {} pixels; photographs leave {:.1} % over, {:.1} % of places were doubted",
            side.size[0],
            side.size[1],
            side.residual[0] * 100.0,
            side.doubted * 100.0
        ));
        if let Some((_, by)) = stillness.farthest() {
            output::say(format_args!(
                "the farthest shift of a photograph against the others is {:.2} pixels",
                by.length()
            ));
        }
        if let Some(compared) = &side.compared {
            output::say(format_args!(
                "its shape differs from the other surface by {:.1} µm (standard deviation)",
                compared.whole.sigma
            ));
        }
    }
    if let Some(verso) = &report.verso {
        output::say(format_args!("place of the verso {}", verso.told()));
    }
    for doubt in report.doubts() {
        output::say(format_args!("warning: {doubt}"));
    }
    output::say(format_args!(
        "{} says how well all of it was found",
        report.manifest.with_file_name(REPORT).display()
    ));
    output::result(report.manifest.display())
}
