//! What a hand does with a comparison: which one is shown, how its curtain, loupe and shares are moved,
//! and what is drawn where its members meet.

use bevy::prelude::*;

use super::{
    caption::{self, Texts},
    marks::{self, Ink, Mark, Marks},
};
use crate::{
    manifest::{
        comparison::Part,
        exhibit::{CompareMode, Comparison, Exhibit, Member, Scene},
    },
    stage::Shown,
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

/// The comparison after (`by` 1) or before (−1) `now`; those of `written` are compared, or else what
/// the scene's drawing has.
pub fn stepped(
    exhibit: &Exhibit,
    scene: &Scene,
    written: Option<&Comparison>,
    by: i32,
) -> Option<Comparison> {
    let now = scene.compare.as_ref();
    let of: Vec<Member> = match written {
        Some(written) => written.of.clone(),
        None => exhibit.comparable(scene),
    };
    let members = |mode: CompareMode| match mode {
        CompareMode::Glass => exhibit.both_sides(scene),
        _ => of.clone(),
    };
    let shown = |mode: &CompareMode| mode.allowed_instead_of(members(*mode).len()).is_none();
    let modes: Vec<CompareMode> = MODES.into_iter().filter(shown).collect();
    let place = now.and_then(|now| modes.iter().position(|mode| *mode == now.mode));
    let place = place.map_or(0, |place| place + 1);
    let next = super::view::wrapped(place, by, modes.len() + 1);
    let mode = modes[next.checked_sub(1)?];
    Some(match now.or(written) {
        Some(like) => Comparison {
            mode,
            of: members(mode),
            ..like.clone()
        },
        None => Comparison::new(mode, members(mode)),
    })
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
    windows: Query<&Window>,
    mut marks: ResMut<Marks>,
) {
    let Ok(window) = windows.single() else {
        return;
    };
    let mut wanted = Vec::new();
    if let Some(comparison) = shown.scene.compare.as_ref().filter(|c| !c.mode.combines()) {
        let picture = (shown.aspect, window.size());
        for edge in comparison.edges(shown.aspect) {
            wanted.extend(marks::lines(&edge, false, &Part::WHOLE, picture, Ink::Edge));
        }
        let parts = shown.exhibit.parts(&shown.scene, shown.aspect);
        for (member, (_, part)) in comparison.of.iter().zip(parts) {
            // They come and go with the caption.
            if let Some(at) = part.top(shown.aspect).filter(|_| texts.caption) {
                wanted.push(Mark::Words {
                    at: marks::px(at, window.size()),
                    text: caption::name(&shown, *member),
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
pub fn words(comparison: &Comparison) -> String {
    let share = |share: f64| format!("{:.0} %", share * 100.0);
    match comparison.mode {
        CompareMode::Curtain => "curtain".into(),
        CompareMode::SideBySide => "side by side".into(),
        CompareMode::Blend => format!("blend, {} of the second", share(comparison.at)),
        CompareMode::Loupe => format!("loupe, {:.1} times", comparison.magnify),
        CompareMode::Difference => "difference".into(),
        CompareMode::Flicker => format!("in turns, number {}", comparison.turn + 1),
        CompareMode::Glass => format!(
            "through the sheet, {} of the other side",
            share(comparison.at)
        ),
    }
}
