//! Where maps, report and manifest are written first.

use std::path::Path;

use super::{PrepareError, report::REPORT, write::MAPS};
use crate::manifest::{
    MANIFEST,
    staging::{Staging, StagingError},
};

/// Begins work in the folder `out`, which is there.
///
/// # Errors
/// Those of [`Staging::new`].
pub(super) fn begin(out: &Path) -> Result<Staging, PrepareError> {
    Ok(Staging::new(out, &[MAPS, REPORT, MANIFEST])?)
}

impl From<StagingError> for PrepareError {
    fn from(error: StagingError) -> Self {
        match error {
            StagingError::Exists(path) => Self::Exists(path),
            StagingError::Busy(path) => Self::Busy(path),
            StagingError::Folder { path, reason } => Self::Folder { path, reason },
        }
    }
}
