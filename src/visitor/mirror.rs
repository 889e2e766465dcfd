//! What stands before the visitors, as another machine of the same wall is told of it, and a window that is
//! led: it shows what it is told and hears nobody itself.

use std::collections::BTreeSet;

use bevy::{
    input::{
        ButtonState,
        keyboard::{Key, KeyboardInput},
    },
    prelude::*,
};
use serde::{Deserialize, Serialize};

use super::{
    attending::{Closed, House},
    attract::{Attract, Doing},
    caption::Texts,
    controls::{Control, Interface, Panel, TEXT_SIZES},
    glass::Glass,
    hand::{
        Hand,
        mirrored::{Exact, Pair, ToldHand, vector},
    },
    hints::{Hint, Hints},
    input::Devices,
    measuring::{Measuring, ToldMeasuring},
    notice::Notice,
    pointing::Pointer,
    staff::StaffPanel,
};
use crate::stage::Shown;

/// More fingers than these are told of as these.
const MOST_HELD: usize = 32;
/// Nobody points farther away, in logical pixels.
const FARTHEST_PX: f64 = 1e6;

/// Everything that decides the picture and what lies over it, for a machine with the same exhibit, wordings
/// and wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Told {
    hand: ToldHand,
    interface: ToldInterface,
    measuring: ToldMeasuring,
    /// What somebody points at, in logical pixels of the picture, and whether it is read there.
    pointer: Option<Pair>,
    reads: bool,
    doing: ToldDoing,
    /// Among all panes of the wall, that on which controls lie.
    home: usize,
    /// The screens are dark.
    dark: bool,
    /// The staff's panel is open on another machine, and what is typed there stays there.
    staff: bool,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct ToldInterface {
    wanted: bool,
    open: BTreeSet<Panel>,
    latest: Option<Panel>,
    language: Option<String>,
    text: usize,
    contrast: bool,
    calm: bool,
    first_scene: usize,
    focus: Option<Control>,
    held: Vec<Control>,
    caption: bool,
    keys: bool,
    notice: Option<Notice>,
    hint: Option<Hint>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum ToldDoing {
    Waiting,
    /// So many seconds are left.
    Counting(u32),
    Touring,
}

/// A window that another machine leads: it shows this, once it was told.
#[derive(Resource, Clone, Debug, Default)]
pub struct Led(pub Option<Told>);

/// Why a window does not show what it was told.
#[derive(Resource, Clone, Debug, Default, PartialEq, Eq)]
pub struct Unfollowed(pub Option<String>);

impl Told {
    /// What is shown in this world.
    pub fn of(world: &World) -> Option<Self> {
        let interface = world.get_resource::<Interface>()?;
        let texts = world.get_resource::<Texts>()?;
        let staff = world.get_resource::<StaffPanel>()?.is_open();
        let attract = world.get_resource::<Attract>()?;
        let glass = world.get_resource::<Glass>()?;
        let pointed = world.get_resource::<Devices>()?.pointer();
        // What the staff touches is nobody's business.
        let told_of = |control: &Control| !staff && !matches!(control, Control::Digit(_));
        let held = interface.held.iter().map(|(_, control)| *control);
        Some(Self {
            hand: world.get_resource::<Hand>()?.told(),
            interface: ToldInterface {
                wanted: interface.wanted,
                open: interface.open.clone(),
                latest: interface.latest,
                language: interface.language.clone(),
                text: interface.text,
                contrast: interface.contrast,
                calm: interface.calm,
                first_scene: interface.first_scene,
                focus: interface.focus.filter(told_of),
                held: held.filter(told_of).take(MOST_HELD).collect(),
                caption: texts.caption,
                keys: texts.keys,
                notice: texts.notice.clone(),
                hint: world.get_resource::<Hints>()?.now(),
            },
            measuring: world.get_resource::<Measuring>()?.told(),
            pointer: pointed.map(|at| at.to_array().map(|px| Exact(px.into()))),
            reads: world.get_resource::<Pointer>()?.is_read(),
            doing: match (attract.doing(), attract.countdown()) {
                (Doing::Touring { .. }, _) => ToldDoing::Touring,
                (_, Some(left)) => ToldDoing::Counting(left),
                _ => ToldDoing::Waiting,
            },
            home: glass.home,
            dark: world.get_resource::<Closed>()?.0 && !staff,
            staff,
        })
    }

    /// Whether the leader's screens are dark.
    pub fn is_dark(&self) -> bool {
        self.dark
    }
}

/// Takes in what another machine says, and shows it.
pub fn follow(
    led: Res<Led>,
    (mut hand, mut shown): (ResMut<Hand>, ResMut<Shown>),
    (mut interface, mut texts, mut hints): (ResMut<Interface>, ResMut<Texts>, ResMut<Hints>),
    (mut measuring, mut pointer, mut devices): (
        ResMut<Measuring>,
        ResMut<Pointer>,
        ResMut<Devices>,
    ),
    (mut attract, mut staff, mut glass): (ResMut<Attract>, ResMut<StaffPanel>, ResMut<Glass>),
    mut unfollowed: ResMut<Unfollowed>,
) {
    let followed = match led.0.as_ref().filter(|_| led.is_changed()) {
        None => Ok(false),
        Some(told) => told
            .check(&hand, &glass)
            .and_then(|()| hand.be(&told.hand))
            .map(|()| true),
    };
    let told = match (followed, &led.0) {
        (Ok(true), Some(told)) => told,
        (Err(found), _) => {
            unfollowed.set_if_neq(Unfollowed(Some(found)));
            return;
        }
        _ => {
            show(&hand, &mut shown);
            return;
        }
    };
    unfollowed.set_if_neq(Unfollowed(None));
    let of = &told.interface;
    *interface = Interface {
        wanted: of.wanted,
        open: of.open.clone(),
        latest: of.latest,
        language: of.language.clone(),
        text: of.text.min(TEXT_SIZES.len() - 1),
        contrast: of.contrast,
        calm: of.calm,
        first_scene: of.first_scene,
        focus: of.focus,
        held: (0..).zip(of.held.iter().copied()).collect(),
        home: interface.home,
    };
    *texts = Texts {
        caption: of.caption,
        keys: of.keys,
        notice: of.notice.clone(),
    };
    hints.be(of.hint);
    measuring.be(&told.measuring);
    pointer.be(told.reads);
    devices.point_at(told.pointer.map(|at| vector(at).as_vec2()));
    attract.be(match told.doing {
        ToldDoing::Waiting => Doing::Waiting { idle_s: 0.0 },
        ToldDoing::Counting(left) => Doing::Counting {
            left_s: left.into(),
        },
        ToldDoing::Touring => Doing::Touring {
            stop: 0,
            seconds: 0.0,
        },
    });
    staff.be_elsewhere(told.staff);
    glass.home = told.home;
    show(&hand, &mut shown);
}

fn show(hand: &Hand, shown: &mut ResMut<Shown>) {
    let wanted = hand.shown();
    if super::window::differs(shown, &wanted) {
        **shown = wanted;
    }
}

/// At a desk, a window that is led is closed by a key as any other.
pub fn leave(
    mut keys: MessageReader<KeyboardInput>,
    house: Res<House>,
    mut exit: MessageWriter<AppExit>,
) {
    let leaves = |input: &KeyboardInput| {
        input.state == ButtonState::Pressed && input.logical_key == Key::Escape
    };
    if keys.read().any(leaves) && !house.0.kiosk {
        exit.write(AppExit::Success);
    }
}

impl Told {
    /// Whether it is about this exhibit and this wall.
    fn check(&self, hand: &Hand, glass: &Glass) -> Result<(), String> {
        let interface = &self.interface;
        let scenes = hand.exhibit().scenes.len();
        let panes = glass.panes.len().max(1);
        if interface.first_scene >= scenes {
            return Err(format!("scene number {}", interface.first_scene));
        }
        if interface.held.len() > MOST_HELD {
            return Err(format!("{} fingers", interface.held.len()));
        }
        if let Some(at) = self.pointer.filter(|at| vector(*at).length() > FARTHEST_PX) {
            return Err(format!("a pointer at {}", vector(at)));
        }
        if self.home >= panes {
            return Err(format!("pane number {} of {panes}", self.home));
        }
        self.measuring.check()
    }
}
