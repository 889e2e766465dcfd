//! The visitor at the window: devices → intents → the hand → what is shown.
//!
//! | step | where |
//! |---|---|
//! | events of mouse and keys → [`Intent`], contacts with [`controls`] | `input` |
//! | fingers, palms and sleeves → gestures | `touches` |
//! | [`Intent`] and time → [`Hand`] | [`hand`], `view`, `lamp`, `motion` |
//! | [`Hand`] → [`crate::stage::Shown`] | [`Hand::shown`] |
//! | comparisons in the hand | `comparing` |
//! | hotspots under the hand | `hotspots` |
//! | the view as a scene or a link | `saving` |
//! | tools in the hand, what they read, and what lies under the pointer | `measuring`, `reader`, `tools`, `pointing` |
//! | the language that is read | `speech` |
//! | what became of a wish, what was read, and what is to be done, in words | `notice`, `phrases`, `hints` |
//! | all that was read, in a corner | `board` |
//! | lines and words that lie on the sheet | `marks` |
//! | the view as a figure, and what was measured as a table | `export` |
//! | the picture that people stand before | `glass` |
//! | texts, and the fonts of every language | `caption`, `letters` |
//! | while nobody is there | `attract` |
//! | what displays are measured by | [`chart`] |
//! | what another machine of the wall is told, and shows | [`mirror`] |
//! | what is heard when it is about to go home | `chime` |
//! | what only the staff gets at | `staff` |
//! | what a resting window is woken for | `alarm` |
//! | which tier serves what is shown | `foresight` |
//! | a display without a window manager | `filling` |
//! | how many pixels of it are drawn meanwhile | `fineness` |
//! | who is there, and what happens while nobody is | `attending` |
//! | the window | `window` |
//! | when it draws, and its rest | `pace` |

mod alarm;
mod attending;
mod attract;
mod board;
mod caption;
pub mod chart;
mod chime;
mod comparing;
pub mod controls;
mod display;
mod export;
mod filling;
mod fineness;
mod foresight;
pub mod glass;
pub mod hand;
mod hints;
mod hotspots;
mod input;
mod intent;
mod lamp;
pub mod letters;
mod marks;
mod measuring;
pub mod mirror;
mod motion;
mod notice;
mod pace;
mod phrases;
mod pointing;
mod reader;
mod saving;
mod speech;
mod staff;
mod tools;
mod touches;
mod view;
mod window;

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

pub use attending::{AskAgain, Closed};
pub use attract::{Attract, Doing, Waits};
pub use chime::Chime;
pub use display::NoDisplay;
pub use hand::{Hand, Serving};
pub use intent::Intent;
pub use lamp::{LOWEST_DEG, LampPlace};
pub use measuring::Kind;
pub use staff::StaffWish;
pub use window::VisitorPlugin;

use bevy::app::App;

use crate::{
    device::{self, NoDevice},
    installation::Pin,
    manifest::{
        Exhibit, Fault, Faults, Link, Severity, did_you_mean, exhibit::Accuracy, quote, quoted_list,
    },
    optics::tier::Tier,
    stage::say,
};

/// How an exhibit is shown.
#[derive(Clone, Debug, Default)]
pub struct ShowOptions {
    /// Id of the first scene; without it, the exhibit's first.
    pub scene: Option<String>,
    /// A link to the first scene, instead.
    pub link: Option<String>,
    /// Without it, the cheapest tier that is as exact as the exhibit asks.
    pub tier: Option<Tier>,
    /// Width and height in mm of the display's visible area, for true size.
    pub display_mm: Option<[f64; 2]>,
    /// Width and height of the window in pixels.
    pub size: Option<[u32; 2]>,
    pub fullscreen: bool,
    /// Where figures are exported to; without it, the folder that the program was started in.
    pub export: Option<PathBuf>,
    pub manners: Manners,
}

/// How the picture behaves towards those who stand before it.
#[derive(Clone, Debug, Default)]
pub struct Manners {
    /// For a public wall: no key and no gesture leads out of it.
    pub kiosk: bool,
    /// Without them, nothing happens while nobody is there.
    pub waits: Option<Waits>,
    /// Whether a sound begins the countdown.
    pub chime: bool,
    /// Tags of the languages on offer, the first of which is spoken at home; without any, those of the
    /// exhibit.
    pub languages: Vec<String>,
    /// What everybody reaches, from the picture's top, as shares of its height.
    pub reach: Option<[f64; 2]>,
    /// The staff's; without one there is no panel.
    pub pin: Option<Pin>,
    /// Factor of the text's size; 0 is 1.
    pub enlarge: f64,
    pub contrast: bool,
    pub calm: bool,
    /// A control after the other is pointed out, each for so many seconds, for those who press one switch.
    pub scan_s: Option<f64>,
    /// Instead of what exhibits ask for: ΔE00, and ms of a frame.
    pub max_delta_e: Option<f64>,
    pub frame_ms: Option<f64>,
}

impl Manners {
    /// `exhibit` with the accuracy that this place asks for.
    fn amended(&self, exhibit: Arc<Exhibit>) -> Arc<Exhibit> {
        let own = exhibit.accuracy;
        let accuracy = Accuracy {
            max_delta_e: self.max_delta_e.unwrap_or(own.max_delta_e),
            frame_ms: self.frame_ms.unwrap_or(own.frame_ms),
        };
        match accuracy == own {
            true => exhibit,
            false => Arc::new(Exhibit {
                accuracy,
                ..Exhibit::clone(&exhibit)
            }),
        }
    }
}

/// Why there is no window.
#[derive(Debug, thiserror::Error)]
pub enum ShowError {
    #[error(transparent)]
    Faults(#[from] Faults),
    #[error(transparent)]
    NoDevice(#[from] NoDevice),
    #[error(transparent)]
    NoDisplay(#[from] NoDisplay),
}

/// Opens the exhibit at `path` in a window, and returns the exit code when it closes.
///
/// # Errors
/// All faults of the exhibit, or [`ShowError::NoDevice`] or [`ShowError::NoDisplay`].
pub fn show(path: &Path, options: &ShowOptions) -> Result<u8, ShowError> {
    show_in(path, options, |_| {})
}

/// As [`show`], in a house that has more to it.
///
/// # Errors
/// As [`show`].
pub fn show_in(
    path: &Path,
    options: &ShowOptions,
    furnish: impl FnOnce(&mut App),
) -> Result<u8, ShowError> {
    let link = options.link.as_deref().map(Link::read).transpose()?;
    let (exhibit, warnings) = Exhibit::read_with(path, link.as_ref())?;
    let scene = match link {
        // A link's scene comes behind those of the manifest.
        Some(_) => exhibit.scenes.len() - 1,
        None => first_scene(&exhibit, options.scene.as_deref())?,
    };
    for warning in warnings {
        say(warning);
    }
    device::probe()?;
    display::probe()?;
    let exhibit = options.manners.amended(Arc::new(exhibit));
    Ok(window::run(exhibit, scene, options, furnish)?)
}

fn first_scene(exhibit: &Exhibit, id: Option<&str>) -> Result<usize, Faults> {
    let Some(id) = id else {
        return Ok(0);
    };
    let ids = || exhibit.scenes.iter().map(|scene| scene.id.as_str());
    exhibit.scene(id).map(|(index, _)| index).ok_or_else(|| {
        Fault {
            severity: Severity::Error,
            file: None,
            place: None,
            path: "--scene".into(),
            found: quote(id),
            allowed: quoted_list(ids()),
            remedy: did_you_mean(id, ids(), "name a scene of the exhibit"),
            unreadable: false,
        }
        .into()
    })
}
