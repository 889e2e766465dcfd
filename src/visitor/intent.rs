//! What somebody wants, whatever device they said it with.

use bevy::prelude::Message;
use glam::DVec2;

use super::measuring::Kind;
use crate::manifest::exhibit::CompareMode;

/// A wish of the visitor. Places in the picture are −1…1 in both directions, y up.
#[derive(Message, Clone, Copy, Debug, PartialEq)]
pub enum Intent {
    /// A finger or the mouse's button went down on the picture: everything that glides stops.
    Take,
    /// What lies at `from` is to come to `to`: turns the sheet at rest size, moves the picture
    /// when zoomed in.
    Drag {
        from: DVec2,
        to: DVec2,
    },
    /// The hand lets go.
    Release,
    /// Pans by this share of the picture's width, x right and y up.
    Pan(DVec2),
    /// Magnifies by `factor` about the place `at`.
    Zoom {
        at: DVec2,
        factor: f64,
    },
    /// Two fingers or more: what lies at `from` comes to `to`, magnified by `factor` and turned by `turn`
    /// radians, anticlockwise, about it.
    Pinch {
        from: DVec2,
        to: DVec2,
        factor: f64,
        turn: f64,
    },
    /// To true size about the place `at`, and back.
    TrueSize {
        at: DVec2,
    },
    /// Turns the sheet over.
    Flip,
    /// The scene as it is written.
    Home,
    /// Moves the lamp over the hemisphere above the sheet as seen from above, by parts of its
    /// radius, x right and y up.
    MoveLamp(DVec2),
    /// Brings the lamp to this height, in degrees above the sheet, from where it stands.
    RaiseLamp(f64),
    /// Brings the lamp to this place over the hemisphere as seen from above, of its radius.
    LampTo(DVec2),
    /// Another set-up of the lamp, in degrees: its height, and where it stands as seen,
    /// anticlockwise from the right.
    SetLamp {
        elevation_deg: f64,
        azimuth_deg: f64,
    },
    /// The lamp's colour, in kelvin.
    Warmth(f64),
    /// The lamp's light, as a factor of what is written.
    Intensity(f64),
    /// This share of the light comes through the sheet.
    TransmitTo(f64),
    /// All of the light comes through the sheet, or again as much as the scene says.
    SwitchTable,
    /// To the scene with this index.
    GoTo(usize),
    /// This comparison, or none.
    Compare(Option<CompareMode>),
    /// The curtain's place, or the share of a blend, 0…1.
    CompareTo(f64),
    /// The curtain or the loupe goes with a finger from one place to the other.
    MoveCompare {
        from: DVec2,
        to: DVec2,
    },
    /// Lays the overlay with this index on the sheet, or takes it away.
    Overlay(usize),
    /// This opacity of the overlays that are on.
    OpacityTo(f64),
    /// Takes this tool, or puts it away.
    Tool(Option<Kind>),
    /// The next control (1) or the one before (−1) is the one that keys are about.
    StepFocus(i32),
    /// Touches that control.
    Activate,
    /// To another state of conservation, forwards (1) or back (−1).
    StepState(i32),
    /// None, each overlay of the side, all of them.
    StepOverlay,
    /// Makes the overlays stronger or fainter by this share.
    Opacity(f64),
    /// To another comparison, forwards (1) or back (−1), with none between the last and the first.
    StepCompare(i32),
    /// Moves the curtain or the share of a blend, a loupe's magnification, a difference's scale.
    ShiftCompare(f64),
    /// Turns the curtain, makes the loupe larger, measures a difference otherwise.
    TurnCompare(f64),
    /// More (or less) of the light comes through the sheet, by this share.
    Transmit(f64),
    /// Shows the relief without colour, or with it again.
    ReliefOnly,
    /// To the next steepness of the relief.
    Exaggerate,
    /// Stretches the contrast, or no longer.
    Stretch,
    /// Sharpens, or no longer.
    Sharpen,
    /// To another scene, forwards (1) or back (−1).
    StepScene(i32),
    /// To another tier of accuracy, forwards (1) or back (−1).
    StepTier(i32),
    /// A click or tap at this place that was no drag: lays the tool in the hand there; without one, opens a hotspot that is shown there, goes where
    /// an open one leads, or closes it from beside it.
    Tap(DVec2),
    /// Shows or hides the hotspots of the side in view.
    Hotspots,
    /// Shows the hotspots and opens the next one (1) or the one before (−1).
    StepHotspot(i32),
    /// Ends what is being measured, or else goes to the scene of the open hotspot.
    GoOn,
    /// Takes the next measuring tool (1) or the one before (−1), with none between the last and the
    /// first.
    StepTool(i32),
    /// Takes back the last place of a tool, or else the last that was measured.
    TakeBack,
    /// Says, or no longer says, what lies under the pointer.
    ReadOut,
    /// To the next category (1) of the uppermost overlay that has some, or back (−1), shown alone,
    /// with all of them between the last and the first.
    StepCategory(i32),
    /// Exports what is seen, as a print or in numbers, with what was measured.
    Export {
        linear: bool,
    },
    /// Saves the view as a scene of the manifest.
    SaveView,
    /// Prints a link to the view.
    Link,
    /// Shows or hides the controls.
    Controls,
    /// Shows or hides the caption.
    Caption,
    /// Shows or hides the list of keys.
    Keys,
    Fullscreen,
    /// Puts the tool away, closes the hotspot that is open, or else the window.
    Quit,
}

impl Intent {
    /// Whether it is none of a visitor's business on a public wall: the curator's files, and the window.
    pub fn leads_out(self) -> bool {
        matches!(
            self,
            Self::Fullscreen
                | Self::SaveView
                | Self::Link
                | Self::Export { .. }
                | Self::StepTier(_)
                | Self::Keys
                | Self::Controls
        )
    }

    /// Whether more of the same is likely to follow at once.
    pub fn is_motion(self) -> bool {
        matches!(
            self,
            Self::Drag { .. }
                | Self::Pinch { .. }
                | Self::Zoom { .. }
                | Self::MoveLamp(_)
                | Self::LampTo(_)
                | Self::Warmth(_)
                | Self::Intensity(_)
                | Self::TransmitTo(_)
                | Self::CompareTo(_)
                | Self::MoveCompare { .. }
                | Self::OpacityTo(_)
        )
    }
}
