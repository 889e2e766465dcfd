//! `recto sample`

use std::path::PathBuf;

use super::{Failure, output};
use crate::sample::{self, DEFAULT_DPI, DPI_RANGE};

#[derive(clap::Args)]
pub struct Arguments {
    /// Where the sample exhibits go, each into a folder of its own
    dir: PathBuf,
    /// Resolution of the maps, in pixels per inch
    #[arg(long, value_name = "N", default_value_t = DEFAULT_DPI, value_parser = dpi)]
    dpi: f64,
}

fn dpi(text: &str) -> Result<f64, String> {
    let [least, most] = DPI_RANGE;
    text.parse()
        .ok()
        .filter(|dpi| (least..=most).contains(dpi))
        .ok_or_else(|| format!("write a number from {least} to {most}"))
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    const STEPS: f64 = 1000.0;
    let bar = output::progress(STEPS as u64);
    let progress = |share: f64, done: &str| {
        bar.set_position((share * STEPS) as u64);
        bar.set_message(done.to_owned());
    };
    let files = sample::write_all(&arguments.dir, arguments.dpi, &progress)?;
    bar.finish_and_clear();
    for file in files {
        output::result(file.display())?;
    }
    Ok(())
}
