//! Controls: objects that lie on the picture, for everybody at once. Two people may have the lamp and
//! the scenes open at the same time; nothing here is a mode of the whole wall.
//!
//! | step | where |
//! |---|---|
//! | what there is to control in what is shown → [`Facts`] | `facts` |
//! | [`Facts`] and the room → [`Laid`] | `layout` |
//! | contacts with controls → intents | `operate` |
//! | [`Laid`] → nodes, with what a screen reader says | `draw` |
//! | pictures of the scenes | `thumbs` |

pub mod draw;
pub mod facts;
pub mod icons;
pub mod layout;
pub mod operate;
pub mod thumbs;

use std::collections::BTreeSet;

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::measuring::Kind;
use crate::manifest::exhibit::CompareMode;

pub use layout::{Laid, Look, Room, Widget};

use icons::Icon;
use layout::Item;

/// What can be opened. Of those at the side where reading begins one is open at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Panel {
    Light,
    Scenes,
    Compare,
    Layers,
    Measure,
    More,
}

impl Panel {
    /// Whether it is a list at the side.
    pub fn is_list(self) -> bool {
        !matches!(self, Self::Light | Self::Scenes)
    }
}

/// Set-ups of the lamp that are one touch away.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Preset {
    Zenithal,
    Oblique,
    /// 0 right, 1 top, 2 left, 3 bottom, as seen.
    Raking(u8),
    LightTable,
}

impl Preset {
    /// In the order in which they lie.
    pub const ALL: [Self; 7] = [
        Self::Zenithal,
        Self::Raking(2),
        Self::Raking(0),
        Self::Oblique,
        Self::LightTable,
        Self::Raking(1),
        Self::Raking(3),
    ];
}

/// What the staff can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Staff {
    Quit,
    Restart,
    NextExhibit,
    /// What each display should show, to be measured.
    Chart,
    /// Stays open, or closes, whatever the hour.
    Hours,
    Back,
}

/// What is touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Control {
    Home,
    Flip,
    Open(Panel),
    Dial,
    Preset(Preset),
    Warmth,
    Intensity,
    /// From reflected to transmitted light.
    Through,
    Scene(usize),
    Page(i32),
    Mode(Option<CompareMode>),
    /// The curtain's place, or the share of a blend.
    Share,
    Layer(usize),
    Opacity,
    Tool(Option<Kind>),
    TakeBack,
    Done,
    Language(usize),
    TextSize,
    Contrast,
    Calm,
    Hotspots,
    Caption,
    /// Refuses the countdown.
    Stay,
    Digit(u8),
    /// Takes the last digit back.
    Erase,
    /// The digits are typed.
    Enter,
    Staff(Staff),
    /// Nothing: words.
    Said,
}

/// A contact with a control.
#[derive(Message, Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    pub id: u64,
    pub control: Control,
    pub phase: Phase,
    /// In logical pixels from the top left corner.
    pub at: Vec2,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    Landed,
    Moved,
    Lifted,
    /// The system took it away.
    Lost,
}

/// Sizes of the text, as factors.
pub const TEXT_SIZES: [f32; 3] = [1.0, 1.3, 1.6];

/// What of the controls is open, and how they are read.
#[derive(Resource, Clone, Debug)]
pub struct Interface {
    /// Whether there are any.
    pub wanted: bool,
    pub open: BTreeSet<Panel>,
    /// The one that was opened last.
    pub latest: Option<Panel>,
    /// The tag of the language that was chosen for everything that is read.
    pub language: Option<String>,
    /// Index into [`TEXT_SIZES`].
    pub text: usize,
    pub contrast: bool,
    pub calm: bool,
    /// The first scene of the strip.
    pub first_scene: usize,
    /// The control that keys are about.
    pub focus: Option<Control>,
    /// Controls that are held.
    pub held: Vec<(u64, Control)>,
    /// As it is when nobody has touched it.
    pub home: Reading,
}

/// How somebody reads.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// Factor of the text's size before anybody changes it; 0 is 1.
    pub enlarge: f32,
    pub contrast: bool,
    pub calm: bool,
}

impl Interface {
    /// As a visitor finds it.
    pub fn new(wanted: bool, home: Reading) -> Self {
        Self {
            wanted,
            open: BTreeSet::new(),
            latest: None,
            language: None,
            text: 0,
            contrast: home.contrast,
            calm: home.calm,
            first_scene: 0,
            focus: None,
            held: Vec::new(),
            home,
        }
    }

    /// As the last visitor found it; fingers that are on a control stay there.
    pub fn go_home(&mut self) {
        let held = std::mem::take(&mut self.held);
        *self = Self {
            held,
            ..Self::new(self.wanted, self.home)
        };
    }

    /// Opens or closes a panel.
    pub fn toggle(&mut self, panel: Panel) {
        if self.open.remove(&panel) {
            return;
        }
        if panel.is_list() {
            self.open.retain(|open| !open.is_list());
        }
        self.open.insert(panel);
        self.latest = Some(panel);
    }

    /// Factor of the text's size.
    pub fn text_factor(&self) -> f32 {
        let home = if self.home.enlarge > 0.0 {
            self.home.enlarge
        } else {
            1.0
        };
        home * TEXT_SIZES[self.text.min(TEXT_SIZES.len() - 1)]
    }
}

/// What there is to control.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facts {
    pub open: BTreeSet<Panel>,
    /// The one that was opened last.
    pub latest: Option<Panel>,
    pub bar: Vec<Item>,
    /// Titles of the scenes.
    pub scenes: Vec<String>,
    pub scene: usize,
    pub first_scene: usize,
    /// Signs of back and on.
    pub arrows: Option<[Icon; 2]>,
    /// Where the lamp stands as seen from above, −1…1 with y up.
    pub lamp: Option<Vec2>,
    pub lamp_words: String,
    pub presets: Vec<Item>,
    pub sliders: Vec<Item>,
    pub list: Vec<Item>,
    /// What to do, in one line.
    pub hint: Option<String>,
    /// Instead of all else: a countdown, or what the staff sees.
    pub countdown: Option<Vec<Item>>,
    pub staff: Option<Vec<Item>>,
}
