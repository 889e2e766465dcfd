//! `recto check`

use std::path::PathBuf;

use super::{
    Failure, output,
    report::{Refused, Report},
};
use crate::manifest::{Exhibit, Faults};

#[derive(clap::Args)]
pub struct Arguments {
    /// The exhibit's folder, or its manifest
    exhibit: PathBuf,
    /// Say what each scene requires and why, and where each map and constant comes from
    #[arg(long)]
    explain: bool,
    /// Say all of it as JSON
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    match report(arguments) {
        Ok(report) if arguments.json => output::result(json(&report)?),
        Ok(report) if arguments.explain => output::result(format_args!("{report:#}")),
        Ok(report) => output::result(report),
        Err(faults) => {
            if arguments.json {
                output::result(json(&Refused::new(&faults))?)?;
            }
            Err(faults.into())
        }
    }
}

fn report(arguments: &Arguments) -> Result<Report, Faults> {
    let (exhibit, mut warnings) = Exhibit::read(&arguments.exhibit)?;
    // Those that no scene needs today are still part of the exhibit.
    warnings.extend(exhibit.verify(exhibit.maps())?);
    super::warn(&warnings);
    Ok(Report::new(&exhibit, warnings))
}

fn json(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(value).map_err(|error| Failure::Input(Box::new(error)))
}
