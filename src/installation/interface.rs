//! How texts and controls look, and when they go, before a visitor changes it.

use std::{path::PathBuf, time::Duration};

use serde::Serialize;

/// The contrast of texts and controls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Contrast {
    #[default]
    Normal,
    High,
}

/// How texts and controls look.
#[derive(Clone, Debug, PartialEq)]
pub struct Interface {
    /// A folder with the museum's own wording, as `LANGUAGE.ftl`.
    pub wording: Option<PathBuf>,
    /// A folder with fonts.
    pub fonts: Option<PathBuf>,
    /// How much larger texts are, 1 to 3.
    pub enlarge: f64,
    pub contrast: Contrast,
    pub reduced_motion: bool,
}

impl Default for Interface {
    fn default() -> Self {
        Self {
            wording: None,
            fonts: None,
            enlarge: 1.0,
            contrast: Contrast::Normal,
            reduced_motion: false,
        }
    }
}

/// When nobody is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Idle {
    /// Without a touch, until the countdown begins.
    pub after: Duration,
    /// How long the countdown can be refused.
    pub countdown: Duration,
    /// Whether a sound begins it.
    pub chime: bool,
}

impl Default for Idle {
    fn default() -> Self {
        Self {
            after: Duration::from_secs(120),
            countdown: Duration::from_secs(15),
            chime: true,
        }
    }
}
