//! `recto schema`

use super::{Failure, later, output};
use crate::{installation, manifest};

#[derive(clap::Args)]
pub struct Arguments {
    /// Of the installation file instead
    #[arg(long, conflicts_with = "capture")]
    installation: bool,
    /// Of the capture file instead (not in this version yet)
    #[arg(long)]
    capture: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.installation {
        return output::result(format_args!("{:#}", installation::schema()));
    }
    if arguments.capture {
        return Err(later::not_yet("the schema of the capture file"));
    }
    output::result(format_args!("{:#}", manifest::schema()))
}
