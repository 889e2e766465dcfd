//! What can be wrong with a picture file, each in one line that says what to do.

use std::{
    io,
    path::{Path, PathBuf},
};

/// Why a picture cannot be read or written. Every message is one line and begins with the path.
#[derive(Debug, thiserror::Error)]
pub enum MapError {
    /// The file cannot be opened or read. (The reason is part of the message, not its source, so
    /// that a printed chain does not say it twice.)
    #[error("{}: cannot be read: {reason}", path.display())]
    Read { path: PathBuf, reason: io::Error },
    /// The content is none of the formats we know.
    #[error(
        "{}: is not a PNG, JPEG, TIFF or OpenEXR picture; export it as one of these",
        path.display()
    )]
    UnknownFormat { path: PathBuf },
    /// A side is 0 or above [`super::MAX_SIDE`].
    #[error(
        "{}: is {width} × {height} pixels; each side must have 1 to {} pixels: resample it",
        path.display(),
        super::MAX_SIDE
    )]
    Size {
        path: PathBuf,
        width: u64,
        height: u64,
    },
    /// A well-formed file of a kind we do not read; `found` and `remedy` complete the sentence.
    #[error("{}: {found}; {remedy}", path.display())]
    Unsupported {
        path: PathBuf,
        found: String,
        remedy: &'static str,
    },
    /// The file breaks its own format, or ends early.
    #[error("{}: is damaged ({detail}); export or copy it again", path.display())]
    Damaged { path: PathBuf, detail: String },
    /// The embedded ICC profile is broken or of a kind that does not describe the pixels.
    #[error(
        "{}: its embedded colour profile cannot be used ({detail}); embed another one, or declare \
         the encoding as \"srgb\" or \"linear\"",
        path.display()
    )]
    Profile { path: PathBuf, detail: String },
    /// The file cannot be written.
    #[error("{}: cannot be written: {reason}{}", path.display(), room(reason))]
    Write { path: PathBuf, reason: io::Error },
}

impl MapError {
    pub(super) fn read(path: &Path, reason: io::Error) -> Self {
        Self::Read {
            path: path.into(),
            reason,
        }
    }

    pub(super) fn unsupported(path: &Path, found: impl Into<String>, remedy: &'static str) -> Self {
        Self::Unsupported {
            path: path.into(),
            found: found.into(),
            remedy,
        }
    }

    pub(super) fn damaged(path: &Path, detail: impl ToString) -> Self {
        Self::Damaged {
            path: path.into(),
            detail: one_line(detail),
        }
    }

    pub(super) fn profile(path: &Path, detail: impl ToString) -> Self {
        Self::Profile {
            path: path.into(),
            detail: one_line(detail),
        }
    }

    pub(super) fn write(path: &Path, reason: io::Error) -> Self {
        Self::Write {
            path: path.into(),
            reason,
        }
    }
}

/// What to do where a disk is full; nothing of other reasons.
pub fn room(reason: &io::Error) -> &'static str {
    match reason.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "; make room there, or choose another disk"
        }
        _ => "",
    }
}

/// Decoders' own messages may span lines or quote bytes of the file.
pub(super) fn one_line(detail: impl ToString) -> String {
    let line: String = detail
        .to_string()
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    line.split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
        .trim_end_matches('.')
        .to_owned()
}
