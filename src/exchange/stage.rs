//! A folder that is filled whole or not at all.

use std::{fs, path::Path};

use super::ExchangeError;

/// Fills a folder beside its place through `work`, and then moves everything by these `names` to
/// `out`, the last of them last: whoever opens `out` meanwhile sees nothing, or the whole. Names
/// that `work` does not make are passed over. `out` and the folders above it are made where they
/// are absent.
///
/// # Errors
/// Where one of the names is in `out` already, or nothing can be written there, and those of
/// `work`; then nothing is in `out` that was not there before.
pub fn whole<T>(
    out: &Path,
    names: &[&str],
    work: impl FnOnce(&Path) -> Result<T, ExchangeError>,
) -> Result<T, ExchangeError> {
    // What makes a folder an exhibit is named last, and told of first.
    if let Some(taken) = names.iter().rev().find(|name| out.join(name).exists()) {
        return Err(ExchangeError::Exists(out.join(taken)));
    }
    let missing = out
        .ancestors()
        .take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists());
    let made: Vec<_> = missing.map(Path::to_owned).collect();
    let result = fs::create_dir_all(out)
        .map_err(ExchangeError::folder(out))
        .and_then(|()| staged(out, names, work));
    if result.is_err() {
        // Only empty ones: somebody else may have put something there meanwhile.
        for folder in made {
            let _ = fs::remove_dir(folder);
        }
    }
    result
}

fn staged<T>(
    out: &Path,
    names: &[&str],
    work: impl FnOnce(&Path) -> Result<T, ExchangeError>,
) -> Result<T, ExchangeError> {
    let stage = tempfile::Builder::new()
        .prefix(".recto-exchange-")
        .tempdir_in(out)
        .map_err(ExchangeError::folder(out))?;
    let done = work(stage.path())?;
    let mut moved = Vec::new();
    for name in names {
        let (from, to) = (stage.path().join(name), out.join(name));
        if !from.exists() {
            continue;
        }
        if let Err(reason) = fs::rename(&from, &to) {
            for (from, to) in moved {
                let _ = fs::rename(to, from);
            }
            return Err(ExchangeError::Folder { path: to, reason });
        }
        moved.push((from, to));
    }
    Ok(done)
}
