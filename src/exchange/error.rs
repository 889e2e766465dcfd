//! What can be wrong with an exchange.

use std::{io, path::Path};

use crate::{
    manifest::{Fault, Faults, Severity, document::Words, staging::StagingError},
    maps::MapError,
};

/// Why nothing was imported or exported. Every message names a file.
#[derive(Debug, thiserror::Error)]
pub enum ExchangeError {
    /// Everything that is wrong with what was to be read.
    #[error(transparent)]
    Faults(#[from] Faults),
    /// Of a picture that cannot be read or written.
    #[error(transparent)]
    Map(#[from] MapError),
    /// Of the folder that is to be filled, or of another one.
    #[error(transparent)]
    Staging(#[from] StagingError),
}

impl From<Fault> for ExchangeError {
    fn from(fault: Fault) -> Self {
        Self::Faults(fault.into())
    }
}

impl ExchangeError {
    /// Of a folder, to be given to `map_err`.
    pub(super) fn folder(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |reason| StagingError::Folder { path, reason }.into()
    }
}

/// What is found wrong with one file while it is read on.
pub(super) struct Faulty<'f> {
    file: &'f Path,
    faults: Vec<Fault>,
    warnings: Vec<Fault>,
}

/// Nobody reads more, and a broken file can have one for each of its numbers.
const MOST_FAULTS: usize = 40;

impl<'f> Faulty<'f> {
    pub fn new(file: &'f Path) -> Self {
        Self {
            file,
            faults: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// Records a fault at `path`, the key as its format writes it; empty for the whole file.
    pub fn fault(&mut self, path: impl Into<String>, words: Words) {
        if self.faults.len() < MOST_FAULTS {
            self.faults.push(Fault {
                path: path.into(),
                ..words.of_file(self.file)
            });
        }
    }

    /// Records something that was assumed or left out.
    pub fn warning(&mut self, path: impl Into<String>, words: Words) {
        if self.warnings.len() < MOST_FAULTS {
            self.warnings.push(Fault {
                severity: Severity::Warning,
                path: path.into(),
                ..words.of_file(self.file)
            });
        }
    }

    /// The warnings, if there are no faults.
    pub fn warnings(self) -> Result<Vec<Fault>, Faults> {
        match Faults::new(self.faults) {
            Some(faults) => Err(faults),
            None => Ok(self.warnings),
        }
    }

    /// Ends here if there are faults.
    pub fn check(&mut self) -> Result<(), Faults> {
        Faults::new(std::mem::take(&mut self.faults)).map_or(Ok(()), Err)
    }
}

/// The one fault of a file that cannot be read on.
pub(super) fn whole_file(file: &Path, words: Words) -> ExchangeError {
    words.of_file(file).into()
}
