//! What `recto publish` writes: versions of an exhibit side by side, and a pointer to the one that
//! is shown.
//!
//! ```text
//! ROOT/versions/20261126T071500123Z-1f3a9c02b7de/exhibit.toml …
//! ROOT/current -> versions/20261126T071500123Z-1f3a9c02b7de
//! ```
//!
//! The pointer is a symbolic link, or, where there are none, a file with that one line. Whoever
//! reads follows it once and then stays with that version, so that nobody sees parts of two.

use std::{
    ffi::OsStr,
    fs::{self, File},
    io::Read,
    path::{Component, Path, PathBuf},
};

use super::document::MANIFEST;

/// The name of the pointer.
pub const POINTER: &str = "current";
/// The name of the folder with all versions.
pub const VERSIONS: &str = "versions";

/// The folder of the version that `root` shows; `None` where `root` is no folder of published
/// versions, or is an exhibit itself.
pub fn current(root: &Path) -> Option<PathBuf> {
    if root.join(MANIFEST).exists() {
        return None;
    }
    let version = pointed_to(root)?;
    Some(root.join(VERSIONS).join(version))
}

/// The name of the version that the pointer names, which may not be there.
pub fn pointed_to(root: &Path) -> Option<String> {
    let pointer = root.join(POINTER);
    let target = fs::read_link(&pointer).ok().or_else(|| line(&pointer))?;
    // It leads to a version and nowhere else.
    match target.components().collect::<Vec<_>>()[..] {
        [Component::Normal(folder), Component::Normal(version)]
            if folder == OsStr::new(VERSIONS) =>
        {
            Some(version.to_str()?.to_owned())
        }
        _ => None,
    }
}

/// The one line of a pointer that is a file.
fn line(pointer: &Path) -> Option<PathBuf> {
    /// A pointer is shorter, and another file by its name may be of any length.
    const LONGEST: u64 = 512;
    let metadata = fs::metadata(pointer).ok()?;
    if !metadata.is_file() || metadata.len() > LONGEST {
        return None;
    }
    let mut text = String::new();
    File::open(pointer)
        .ok()?
        .take(LONGEST)
        .read_to_string(&mut text)
        .ok()?;
    Some(PathBuf::from(text.trim_end()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pointer_leads_to_a_version_and_nowhere_else() {
        let root = tempfile::tempdir().unwrap();
        let root = root.path();
        assert_eq!(current(root), None);
        for (text, version) in [
            ("versions/a\n", Some("a")),
            ("versions/a", Some("a")),
            ("versions/../../etc", None),
            ("versions/..", None),
            ("/etc/passwd", None),
            ("versions", None),
            ("", None),
        ] {
            fs::write(root.join(POINTER), text).unwrap();
            let expected = version.map(|version| root.join(VERSIONS).join(version));
            assert_eq!(current(root), expected, "{text:?}");
        }
        fs::write(root.join(POINTER), "versions/a").unwrap();
        fs::write(root.join(MANIFEST), "").unwrap();
        assert_eq!(current(root), None, "it is an exhibit itself");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_followed_as_a_line_is() {
        let root = tempfile::tempdir().unwrap();
        let root = root.path();
        std::os::unix::fs::symlink("versions/b", root.join(POINTER)).unwrap();
        assert_eq!(current(root), Some(root.join(VERSIONS).join("b")));
    }
}
