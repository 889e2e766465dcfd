//! A folder that is filled whole or not at all.

use std::{fs, path::Path};

use super::{ExchangeError, error::made_of};
use crate::manifest::{Exhibit, Fault, staging::Staging};

/// Fills a folder within `out` through `work`, and then moves everything by these `names` to `out`,
/// the last of them last, as [`Staging`] says. `out` and the folders above it are made where they
/// are absent.
///
/// # Errors
/// Those of [`Staging`], and those of `work`; then nothing is in `out` that was not there before.
pub fn whole<T>(
    out: &Path,
    names: &'static [&'static str],
    work: impl FnOnce(&Path) -> Result<T, ExchangeError>,
) -> Result<T, ExchangeError> {
    let missing = out
        .ancestors()
        .take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists());
    let made: Vec<_> = missing.map(Path::to_owned).collect();
    let result = fs::create_dir_all(out)
        .map_err(ExchangeError::folder(out))
        .and_then(|()| {
            let staging = Staging::new(out, names)?;
            let done = work(staging.path())?;
            staging.publish()?;
            Ok(done)
        });
    if result.is_err() {
        // Only empty ones: somebody else may have put something there meanwhile.
        for folder in made {
            let _ = fs::remove_dir(folder);
        }
    }
    result
}

/// Reads the exhibit that was made of `file` in the folder `staged`, as `recto check` does, and
/// gives its warnings, by the names that its files will have in `out`.
///
/// # Errors
/// Its faults, as those of `file`.
pub fn checked(file: &Path, staged: &Path, out: &Path) -> Result<Vec<Fault>, ExchangeError> {
    let (_, mut warnings) = Exhibit::read(staged).map_err(|faults| made_of(file, faults))?;
    for warning in &mut warnings {
        if let Some(file) = &mut warning.file
            && let Ok(own) = file.strip_prefix(staged)
        {
            *file = out.join(own);
        }
    }
    Ok(warnings)
}
