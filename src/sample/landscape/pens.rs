//! The two inks, and how they thin with distance.

use crate::sample::{
    hand::Pen,
    noise::{mix, smoothstep},
    stroke::Layer,
};

/// Beyond this distance, in m, the paler ink is used.
pub const PALE_FROM_M: f32 = 470.0;
/// The finest line of the drawing, in mm.
pub const FINEST_MM: f32 = 0.09;
/// Widest contour and hatching of the foreground, in mm.
const CONTOUR_MM: f32 = 0.30;
const HATCH_MM: f32 = 0.20;

/// The pen for contours at a distance in m.
pub fn contour(distance_m: f32) -> Pen {
    at(distance_m, CONTOUR_MM)
}

/// The pen for hatching at a distance in m.
pub fn hatch(distance_m: f32) -> Pen {
    at(distance_m, HATCH_MM)
}

fn at(distance_m: f32, near_mm: f32) -> Pen {
    let far = (distance_m / 130.0).max(1.0).ln() / (1800.0f32 / 130.0).ln();
    let width = mix(near_mm, FINEST_MM, far.min(1.0).powf(0.8));
    if distance_m < PALE_FROM_M {
        Pen::quill(
            Layer::DarkInk,
            width,
            mix(1.9, 1.25, smoothstep(130.0, PALE_FROM_M, distance_m)),
        )
    } else {
        Pen::quill(
            Layer::PaleInk,
            width,
            mix(1.15, 0.62, smoothstep(PALE_FROM_M, 2600.0, distance_m)),
        )
        .with_tremor(0.035)
    }
}
