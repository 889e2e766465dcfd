//! `recto schema`

use super::{Failure, output};
use crate::{installation, manifest, prepare};

#[derive(clap::Args)]
pub struct Arguments {
    /// Of the installation file instead
    #[arg(long, conflicts_with = "capture")]
    installation: bool,
    /// Of the capture file instead
    #[arg(long)]
    capture: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.installation {
        return output::result(format_args!("{:#}", installation::schema()));
    }
    if arguments.capture {
        return output::result(format_args!("{:#}", prepare::capture::schema()));
    }
    output::result(format_args!("{:#}", manifest::schema()))
}
