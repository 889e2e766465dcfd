//! What a hand does with a comparison: which one is shown, how its curtain, loupe and shares are moved,
//! and what is drawn where its members meet.

use bevy::prelude::*;

use super::{
    caption::{self, Texts},
    glass::Glass,
    marks::{self, Ink, Mark, Marks},
    speech::Speech,
};
use crate::{
    manifest::{
        comparison::Part,
        exhibit::{CompareMode, Comparison, Exhibit, Member, Scene},
    },
    stage::Shown,
    wording::Spoken,
};

/// In the order in which a key goes through them.
const MODES: [CompareMode; 7] = [
    CompareMode::Curtain,
    CompareMode::SideBySide,
    CompareMode::Loupe,
    CompareMode::Blend,
    CompareMode::Difference,
    CompareMode::Flicker,
    CompareMode::Glass,
];
/// How long a member is seen that takes turns with others, in seconds: two changes a second, below
/// the three flashes that nobody is to be shown.
pub const TURN_S: f64 = 0.5;
/// Share of the way by which one press moves a curtain or a blend.
const STEP: f64 = 0.05;
/// Factor by which one press magnifies a loupe or amplifies a difference.
const FACTOR: f64 = 1.25;
const MAGNIFY: [f64; 2] = [1.0, 20.0];
/// Of a difference's scale, in ΔE00 and of luminance, as manifests allow.
const FULL_DELTA_E: [f64; 2] = [0.01, 100.0];
const FULL_LUMINANCE: [f64; 2] = [0.01, 1.0];
/// Degrees by which one press turns a curtain.
const TURN_DEG: f64 = 15.0;
/// Of a loupe, as shares of the picture's height.
const RADIUS: [f64; 2] = [0.05, 1.0];

/// The members that a mode compares: those of `written`, or else what the scene's drawing has.
fn members(
    exhibit: &Exhibit,
    scene: &Scene,
    written: Option<&Comparison>,
    mode: CompareMode,
) -> Vec<Member> {
    match (mode, written) {
        (CompareMode::Glass, _) => exhibit.both_sides(scene),
        (_, Some(written)) => written.of.clone(),
        (_, None) => exhibit.comparable(scene),
    }
}

/// The modes that have something to compare, in their order.
pub fn modes(exhibit: &Exhibit, scene: &Scene, written: Option<&Comparison>) -> Vec<CompareMode> {
    let count = |mode: CompareMode| members(exhibit, scene, written, mode).len();
    let shown = |mode: &CompareMode| mode.allowed_instead_of(count(*mode)).is_none();
    MODES.into_iter().filter(shown).collect()
}

/// The comparison of this mode, otherwise like the one that is shown or written.
pub fn in_mode(
    exhibit: &Exhibit,
    scene: &Scene,
    written: Option<&Comparison>,
    mode: CompareMode,
) -> Comparison {
    let of = members(exhibit, scene, written, mode);
    match scene.compare.as_ref().or(written) {
        Some(like) => Comparison {
            mode,
            of,
            ..like.clone()
        },
        None => Comparison::new(mode, of),
    }
}

/// The comparison after (`by` 1) or before (−1) `now`; those of `written` are compared, or else what
/// the scene's drawing has.
pub fn stepped(
    exhibit: &Exhibit,
    scene: &Scene,
    written: Option<&Comparison>,
    by: i32,
) -> Option<Comparison> {
    let modes = modes(exhibit, scene, written);
    let now = scene.compare.as_ref();
    let place = now.and_then(|now| modes.iter().position(|mode| *mode == now.mode));
    let place = place.map_or(0, |place| place + 1);
    let next = super::view::wrapped(place, by, modes.len() + 1);
    let mode = modes[next.checked_sub(1)?];
    Some(in_mode(exhibit, scene, written, mode))
}

/// Moves what a key moves: the curtain, the share of a blend, a loupe's magnification, the top of a
/// difference's scale; members that take turns, by one.
pub fn shift(comparison: &mut Comparison, by: f64) {
    match comparison.mode {
        CompareMode::Curtain | CompareMode::Blend | CompareMode::Glass => {
            comparison.at = (comparison.at + by * STEP).clamp(0.0, 1.0);
        }
        CompareMode::Loupe => {
            let [least, most] = MAGNIFY;
            comparison.magnify = (comparison.magnify * FACTOR.powf(by)).clamp(least, most);
        }
        CompareMode::Difference => {
            let (full, [least, most]) = match &mut comparison.full_luminance {
                Some(full) => (full, FULL_LUMINANCE),
                None => (&mut comparison.full_delta_e, FULL_DELTA_E),
            };
            *full = (*full * FACTOR.powf(-by)).clamp(least, most);
        }
        CompareMode::Flicker => take_turns(comparison),
        CompareMode::SideBySide => {}
    }
}

/// Turns a curtain, or makes a loupe larger.
pub fn turn(comparison: &mut Comparison, by: f64) {
    match comparison.mode {
        CompareMode::Curtain => {
            comparison.angle.0 = (comparison.angle.0 + by * TURN_DEG).rem_euclid(360.0);
        }
        CompareMode::Loupe => {
            let [least, most] = RADIUS;
            comparison.radius = (comparison.radius * FACTOR.powf(by)).clamp(least, most);
        }
        CompareMode::Difference => {
            // From ΔE00 to luminance and back.
            comparison.full_luminance = match comparison.full_luminance {
                None => {
                    let [least, most] = FULL_LUMINANCE;
                    Some((comparison.full_delta_e / 100.0).clamp(least, most))
                }
                Some(_) => None,
            };
        }
        _ => {}
    }
}

/// The next of those that take turns is seen.
pub fn take_turns(comparison: &mut Comparison) {
    comparison.turn = (comparison.turn + 1) % comparison.of.len().max(1);
}

/// Lays edges and names over members that have parts of the picture, in a window only.
pub fn lay(
    (shown, texts): (Res<Shown>, Res<Texts>),
    speech: Speech,
    glass: Res<Glass>,
    mut marks: ResMut<Marks>,
) {
    let spoken = speech.spoken();
    let mut wanted = Vec::new();
    if let Some(comparison) = shown.scene.compare.as_ref().filter(|c| !c.mode.combines()) {
        let picture = (shown.aspect, glass.size);
        for edge in comparison.edges(shown.aspect) {
            wanted.extend(marks::lines(&edge, false, &Part::WHOLE, picture, Ink::Edge));
        }
        let parts = shown.exhibit.parts(&shown.scene, shown.aspect);
        for (member, (_, part)) in comparison.of.iter().zip(parts) {
            // They come and go with the caption.
            if let Some(at) = part.top(shown.aspect).filter(|_| texts.caption) {
                wanted.push(Mark::Words {
                    at: marks::px(at, glass.size),
                    text: caption::name(&shown, *member, spoken),
                    is_centred: true,
                });
            }
        }
    }
    if marks.compared != wanted {
        marks.compared = wanted;
    }
}

/// For the caption.
pub fn words(comparison: &Comparison, spoken: Spoken) -> String {
    let share = (comparison.at * 100.0).round();
    match comparison.mode {
        CompareMode::Curtain => spoken.say("comparing-curtain"),
        CompareMode::SideBySide => spoken.say("comparing-side-by-side"),
        CompareMode::Difference => spoken.say("comparing-difference"),
        CompareMode::Blend => spoken.fill("comparing-blend", &[("share", share.into())]),
        CompareMode::Glass => spoken.fill("comparing-glass", &[("share", share.into())]),
        CompareMode::Loupe => {
            let times = (comparison.magnify * 10.0).round() / 10.0;
            spoken.fill("comparing-loupe", &[("times", times.into())])
        }
        CompareMode::Flicker => {
            let number = comparison.turn as f64 + 1.0;
            spoken.fill("comparing-flicker", &[("number", number.into())])
        }
    }
}
