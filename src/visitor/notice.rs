//! What became of a wish, in the words of whoever reads it.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::{manifest::SaveError, wording::Spoken};

/// What became of a wish.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Notice {
    /// As a scene of this id.
    Saved(String),
    NotSaved(NotSaved),
    /// A link is in the terminal.
    Linked,
    Exporting(PathBuf),
    Exported(PathBuf),
    NotExported,
}

/// Why a view is not saved; the terminal has it all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NotSaved {
    Changed,
    ReadOnly,
    Unwritable,
    AtFault,
    Otherwise,
}

impl From<&SaveError> for NotSaved {
    fn from(error: &SaveError) -> Self {
        match error {
            SaveError::Changed(_) => Self::Changed,
            SaveError::ReadOnly(_) => Self::ReadOnly,
            SaveError::Write { .. } => Self::Unwritable,
            SaveError::Faults(_) => Self::AtFault,
            SaveError::Form { .. } | SaveError::Id(_) | SaveError::Unwritable { .. } => {
                Self::Otherwise
            }
        }
    }
}

impl Notice {
    /// One line.
    pub fn words(&self, spoken: Spoken) -> String {
        let of_file = |id, path: &PathBuf| {
            let file = path.display().to_string();
            spoken.fill(id, &[("file", file.into())])
        };
        match self {
            Self::Saved(id) => spoken.fill("saved", &[("name", id.as_str().into())]),
            Self::NotSaved(why) => spoken.say(match why {
                NotSaved::Changed => "not-saved-changed",
                NotSaved::ReadOnly => "not-saved-read-only",
                NotSaved::Unwritable => "not-saved-unwritable",
                NotSaved::AtFault => "not-saved-at-fault",
                NotSaved::Otherwise => "not-saved",
            }),
            Self::Linked => spoken.say("link-printed"),
            Self::Exporting(path) => of_file("exporting", path),
            Self::Exported(path) => of_file("exported", path),
            Self::NotExported => spoken.say("not-exported"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wording::Wordings;

    #[test]
    fn every_notice_is_said_in_the_language_that_is_read() {
        let wordings = Wordings::shipped();
        let file = || PathBuf::from("/srv/sheet-1.png");
        let why = [
            NotSaved::Changed,
            NotSaved::ReadOnly,
            NotSaved::Unwritable,
            NotSaved::AtFault,
            NotSaved::Otherwise,
        ];
        let all = [
            Notice::Saved("view-1".into()),
            Notice::Linked,
            Notice::Exporting(file()),
            Notice::Exported(file()),
            Notice::NotExported,
        ];
        for notice in all.into_iter().chain(why.map(Notice::NotSaved)) {
            let said = |language| {
                let words = notice.words(Spoken {
                    wordings: &wordings,
                    language,
                });
                words.replace("view-1", "").replace("/srv/sheet-1.png", "")
            };
            let has_latin = |text: &str| text.chars().any(|c| c.is_ascii_alphabetic());
            assert!(has_latin(&said("en")), "it can fail");
            for language in ["ja", "ar"] {
                assert!(!has_latin(&said(language)), "{}", said(language));
            }
            assert_ne!(said("de"), said("en"));
        }
    }
}
