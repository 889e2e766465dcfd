//! What can be wrong with an exchange.

use std::{io, path::Path};

use crate::{
    manifest::{
        Fault, Faults, Severity, document::Words, shape::unexplained, staging::StagingError,
    },
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
    faults: Told,
    warnings: Told,
}

/// Faults, and how many more there are.
#[derive(Default)]
struct Told {
    faults: Vec<Fault>,
    more: usize,
}

impl Told {
    fn add(&mut self, fault: impl FnOnce() -> Fault) {
        match self.faults.len() < MOST_FAULTS {
            true => self.faults.push(fault()),
            false => self.more += 1,
        }
    }

    /// All of them, and how many more there are as the last.
    fn all(self, file: &Path, severity: Severity) -> Vec<Fault> {
        let mut faults = self.faults;
        if self.more > 0 {
            let remedy = match severity {
                Severity::Error => "correct these, and import it again to see those",
                Severity::Warning => "",
            };
            let words = Words::new(format!("{} more like these", self.more), "", remedy);
            faults.push(Fault {
                severity,
                // Behind all keys where they are sorted.
                path: "…".to_owned(),
                ..words.of_file(file)
            });
        }
        faults
    }
}

/// Nobody reads more, and a broken file can have one for each of its numbers.
const MOST_FAULTS: usize = 40;

impl<'f> Faulty<'f> {
    pub fn new(file: &'f Path) -> Self {
        Self {
            file,
            faults: Told::default(),
            warnings: Told::default(),
        }
    }

    /// Records a fault at `path`, the key as its format writes it; empty for the whole file.
    pub fn fault(&mut self, path: impl Into<String>, words: Words) {
        self.faults.add(|| Fault {
            path: path.into(),
            ..words.of_file(self.file)
        });
    }

    /// Records something that was assumed or left out.
    pub fn warning(&mut self, path: impl Into<String>, words: Words) {
        self.warnings.add(|| Fault {
            severity: Severity::Warning,
            path: path.into(),
            ..words.of_file(self.file)
        });
    }

    /// The warnings, if there are no faults.
    pub fn warnings(mut self) -> Result<Vec<Fault>, Faults> {
        self.check()?;
        Ok(self.warnings.all(self.file, Severity::Warning))
    }

    /// Ends here if there are faults.
    pub fn check(&mut self) -> Result<(), Faults> {
        let faults = std::mem::take(&mut self.faults);
        Faults::new(faults.all(self.file, Severity::Error)).map_or(Ok(()), Err)
    }
}

/// The one fault of a file that cannot be read on.
pub(super) fn whole_file(file: &Path, words: Words) -> ExchangeError {
    words.of_file(file).into()
}

/// Faults of what was made of `file`, as its own: nobody has seen what was made.
pub(super) fn made_of(file: &Path, faults: Faults) -> ExchangeError {
    let own = faults.into_iter().map(|fault| {
        let key = match fault.path.as_str() {
            "" => String::new(),
            path => format!("{path}: "),
        };
        Fault {
            file: Some(file.to_owned()),
            place: None,
            path: String::new(),
            found: format!("what was made of it is refused: {key}{}", fault.found),
            ..fault
        }
    });
    match Faults::new(own.collect()) {
        Some(faults) => faults.into(),
        None => unexplained(file, "a file").into(),
    }
}
