//! How a command can end other than well.

use std::{error::Error, io, process::ExitCode};

use super::output;
use crate::{
    device::NoDevice,
    figure::FigureError,
    manifest::{CreateError, Faults, SaveError},
    maps::MapError,
    prepare::PrepareError,
    sample::SampleError,
    shot::ShotError,
};

/// Why a command did not do what it was asked for.
#[derive(Debug)]
pub enum Failure {
    /// The arguments do not parse, or ask for help, which is no failure but ends here too.
    Arguments(Box<clap::Error>),
    /// The arguments parse and still cannot be followed.
    Usage(String),
    /// The manifest or the options about a scene are at fault: wrong usage where the value of an
    /// option cannot be read at all.
    Faults(Faults),
    /// A file is at fault.
    Input(Box<dyn Error + Send + Sync>),
    /// There is no graphics device, or it refused.
    Device(Box<dyn Error + Send + Sync>),
    /// A window that closed with this code, and has said why.
    Ended(u8),
    /// Whoever read standard output has had enough.
    Closed,
}

impl Failure {
    /// Says on standard error what happened, once, and gives the exit code.
    pub fn report(&self) -> ExitCode {
        match self {
            // Help goes to standard output, which may be closed.
            Self::Arguments(error) => drop(error.print()),
            Self::Usage(words) => output::say(format_args!("recto: {words}")),
            // These begin with file, line and column, which editors can follow.
            Self::Faults(faults) => output::say(faults),
            Self::Input(error) | Self::Device(error) => {
                output::say(format_args!("recto: {}", chain(&**error)));
            }
            Self::Ended(_) | Self::Closed => {}
        }
        ExitCode::from(self.code())
    }

    fn code(&self) -> u8 {
        match self {
            Self::Closed => 0,
            Self::Ended(code) => *code,
            Self::Arguments(error) => u8::try_from(error.exit_code()).unwrap_or(2),
            Self::Faults(faults) if faults.iter().any(|fault| fault.unreadable) => 2,
            Self::Faults(_) | Self::Input(_) => 1,
            Self::Usage(_) => 2,
            Self::Device(_) => 3,
        }
    }
}

/// An error with its causes, leaving out those whose words it says already.
fn chain(error: &dyn Error) -> String {
    let mut words = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let more = error.to_string();
        if !words.ends_with(&more) {
            words = format!("{words}: {more}");
        }
        cause = error.source();
    }
    words
}

impl From<clap::Error> for Failure {
    fn from(error: clap::Error) -> Self {
        Self::Arguments(Box::new(error))
    }
}

impl From<Faults> for Failure {
    fn from(faults: Faults) -> Self {
        Self::Faults(faults)
    }
}

impl From<MapError> for Failure {
    fn from(error: MapError) -> Self {
        Self::Input(Box::new(error))
    }
}

impl From<PrepareError> for Failure {
    fn from(error: PrepareError) -> Self {
        match error {
            PrepareError::Faults(faults) => faults.into(),
            error => Self::Input(Box::new(error)),
        }
    }
}

impl From<FigureError> for Failure {
    fn from(error: FigureError) -> Self {
        Self::Input(Box::new(error))
    }
}

impl From<SampleError> for Failure {
    fn from(error: SampleError) -> Self {
        Self::Input(Box::new(error))
    }
}

impl From<CreateError> for Failure {
    fn from(error: CreateError) -> Self {
        match error {
            CreateError::Faults(faults) => faults.into(),
            error => Self::Input(Box::new(error)),
        }
    }
}

impl From<SaveError> for Failure {
    fn from(error: SaveError) -> Self {
        match error {
            SaveError::Faults(faults) => faults.into(),
            error => Self::Input(Box::new(error)),
        }
    }
}

impl From<NoDevice> for Failure {
    fn from(error: NoDevice) -> Self {
        Self::Device(Box::new(error))
    }
}

impl From<ShotError> for Failure {
    fn from(error: ShotError) -> Self {
        match error {
            ShotError::Maps(_) => Self::Input(Box::new(error)),
            ShotError::NoDevice(_) | ShotError::Device(_) => Self::Device(Box::new(error)),
        }
    }
}

/// Of writing to standard output.
impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::Closed,
            _ => Self::Input(Box::new(error)),
        }
    }
}
