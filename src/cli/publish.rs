//! `recto publish`

use std::path::PathBuf;

use super::{Failure, output};
use crate::wall::publish::{self, KEPT, PublishError};

#[derive(clap::Args)]
pub struct Arguments {
    /// The exhibit's folder
    exhibit: PathBuf,
    /// Where its versions lie, which `recto show` and installations then name
    #[arg(long, value_name = "ROOT")]
    to: PathBuf,
    /// How many versions are kept
    #[arg(long, value_name = "N", default_value_t = KEPT, value_parser = kept)]
    keep: usize,
}

fn kept(text: &str) -> Result<usize, String> {
    let number = text.parse().ok();
    number
        .filter(|number| (2..=1000).contains(number))
        .ok_or_else(|| {
            "write a number from 2 to 1000: the version before may still be read".to_owned()
        })
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let bar = output::progress(0);
    let mut progress = |done: u64, of: u64| {
        bar.set_length(of);
        bar.set_position(done);
        bar.set_message("copied");
    };
    let published = publish::publish(
        &arguments.exhibit,
        &arguments.to,
        arguments.keep,
        &mut progress,
    );
    bar.finish_and_clear();
    let published = published?;
    super::warn(&published.warnings);
    if !published.new {
        output::say("recto: the same files are shown already; nothing was published");
    }
    for words in &published.left_behind {
        output::say(format_args!("recto: {words}"));
    }
    output::result(published.version.display())
}

impl From<PublishError> for Failure {
    fn from(error: PublishError) -> Self {
        match error {
            PublishError::Faults(faults) => faults.into(),
            error => Self::Input(Box::new(error)),
        }
    }
}
