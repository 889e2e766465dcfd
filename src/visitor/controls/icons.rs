//! The signs on the controls, drawn by strokes. Whoever reads none of the languages reads these.

use bevy::{
    asset::RenderAssetUsages,
    platform::collections::HashMap,
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};

/// Side of a sign's picture in pixels.
const SIDE: u32 = 96;
/// Half the width of a stroke, of the sign's side.
const STROKE: f32 = 0.035;
/// Straight parts of a whole circle.
const PARTS: usize = 40;

/// What a control's sign shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Icon {
    Home,
    Flip,
    Lamp,
    Scenes,
    Compare,
    Layers,
    Through,
    Measure,
    More,
    Close,
    Next,
    Previous,
    Overhead,
    Oblique,
    /// A lamp low at this side: 0 right, 1 top, 2 left, 3 bottom.
    Raking(u8),
    Language,
    TextSize,
    Contrast,
    Motion,
    Back,
    Done,
    /// A key that takes a letter back.
    Erase,
    /// A label beside a picture.
    Caption,
}

type Strokes = Vec<Vec<Vec2>>;

/// A part of a circle, from one angle to another, in turns, clockwise from the right.
fn arc(x: f32, y: f32, radius: f32, from: f32, to: f32) -> Vec<Vec2> {
    let parts = ((to - from).abs() * PARTS as f32).ceil().max(1.0) as usize;
    let place = |k: usize| {
        let turn = from + (to - from) * k as f32 / parts as f32;
        let (sin, cos) = (turn * std::f32::consts::TAU).sin_cos();
        Vec2::new(x + radius * cos, y + radius * sin)
    };
    (0..=parts).map(place).collect()
}

fn line(places: &[[f32; 2]]) -> Vec<Vec2> {
    places.iter().copied().map(Vec2::from).collect()
}

fn rectangle(left: f32, top: f32, right: f32, bottom: f32) -> Vec<Vec2> {
    line(&[
        [left, top],
        [right, top],
        [right, bottom],
        [left, bottom],
        [left, top],
    ])
}

/// Rays from `near` to `far` around a place, from one turn to another.
fn rays(x: f32, y: f32, near: f32, far: f32, turns: &[f32]) -> Strokes {
    let ray = |turn: &f32| {
        let (sin, cos) = (turn * std::f32::consts::TAU).sin_cos();
        let at = |r: f32| Vec2::new(x + r * cos, y + r * sin);
        vec![at(near), at(far)]
    };
    turns.iter().map(ray).collect()
}

/// A low lamp at the left, turned to its side.
fn raking(quarter: u8) -> Strokes {
    let mut strokes = vec![
        arc(0.16, 0.5, 0.09, 0.0, 1.0),
        rectangle(0.58, 0.22, 0.92, 0.78),
        line(&[[0.3, 0.5], [0.52, 0.5]]),
        line(&[[0.43, 0.41], [0.52, 0.5], [0.43, 0.59]]),
    ];
    let round = match quarter {
        0 => 0.5,
        1 => 0.25,
        2 => 0.0,
        _ => -0.25,
    };
    let turn = Vec2::from_angle(round * std::f32::consts::TAU);
    for place in strokes.iter_mut().flatten() {
        *place = turn.rotate(*place - 0.5) + 0.5;
    }
    strokes
}

impl Icon {
    /// Strokes in a square of side 1, y down.
    fn strokes(self) -> Strokes {
        match self {
            Self::Home => vec![
                line(&[[0.1, 0.52], [0.5, 0.14], [0.9, 0.52]]),
                line(&[[0.22, 0.44], [0.22, 0.86], [0.78, 0.86], [0.78, 0.44]]),
                line(&[[0.42, 0.86], [0.42, 0.62], [0.58, 0.62], [0.58, 0.86]]),
            ],
            Self::Flip => vec![
                line(&[
                    [0.44, 0.2],
                    [0.14, 0.3],
                    [0.14, 0.84],
                    [0.44, 0.74],
                    [0.44, 0.2],
                ]),
                line(&[
                    [0.56, 0.2],
                    [0.86, 0.3],
                    [0.86, 0.84],
                    [0.56, 0.74],
                    [0.56, 0.2],
                ]),
                arc(0.5, 0.3, 0.2, 0.58, 0.92),
                line(&[[0.57, 0.14], [0.69, 0.21], [0.64, 0.08]]),
            ],
            Self::Lamp => {
                let mut strokes = rays(0.5, 0.42, 0.34, 0.44, &[0.5, 0.62, 0.75, 0.88, 1.0]);
                strokes.push(arc(0.5, 0.42, 0.24, 0.35, 1.15));
                strokes.push(line(&[
                    [0.36, 0.62],
                    [0.4, 0.74],
                    [0.6, 0.74],
                    [0.64, 0.62],
                ]));
                strokes.push(line(&[[0.42, 0.86], [0.58, 0.86]]));
                strokes
            }
            Self::Scenes => vec![
                rectangle(0.08, 0.26, 0.46, 0.54),
                rectangle(0.54, 0.26, 0.92, 0.54),
                line(&[[0.08, 0.7], [0.92, 0.7]]),
                line(&[[0.28, 0.82], [0.72, 0.82]]),
            ],
            Self::Compare => vec![
                rectangle(0.1, 0.2, 0.9, 0.8),
                line(&[[0.5, 0.1], [0.5, 0.9]]),
                line(&[[0.34, 0.42], [0.24, 0.5], [0.34, 0.58]]),
                line(&[[0.66, 0.42], [0.76, 0.5], [0.66, 0.58]]),
            ],
            Self::Layers => vec![
                line(&[
                    [0.5, 0.12],
                    [0.9, 0.34],
                    [0.5, 0.56],
                    [0.1, 0.34],
                    [0.5, 0.12],
                ]),
                line(&[[0.1, 0.52], [0.5, 0.74], [0.9, 0.52]]),
                line(&[[0.1, 0.68], [0.5, 0.9], [0.9, 0.68]]),
            ],
            Self::Through => vec![
                rectangle(0.44, 0.12, 0.56, 0.88),
                line(&[[0.06, 0.34], [0.36, 0.34]]),
                line(&[[0.06, 0.5], [0.36, 0.5]]),
                line(&[[0.06, 0.66], [0.36, 0.66]]),
                line(&[[0.64, 0.5], [0.92, 0.5]]),
                line(&[[0.82, 0.4], [0.92, 0.5], [0.82, 0.6]]),
            ],
            Self::Measure => vec![
                rectangle(0.06, 0.34, 0.94, 0.66),
                line(&[[0.22, 0.34], [0.22, 0.5]]),
                line(&[[0.36, 0.34], [0.36, 0.44]]),
                line(&[[0.5, 0.34], [0.5, 0.5]]),
                line(&[[0.64, 0.34], [0.64, 0.44]]),
                line(&[[0.78, 0.34], [0.78, 0.5]]),
            ],
            Self::More => vec![
                arc(0.2, 0.5, 0.05, 0.0, 1.0),
                arc(0.5, 0.5, 0.05, 0.0, 1.0),
                arc(0.8, 0.5, 0.05, 0.0, 1.0),
            ],
            Self::Close => vec![
                line(&[[0.24, 0.24], [0.76, 0.76]]),
                line(&[[0.76, 0.24], [0.24, 0.76]]),
            ],
            Self::Next => vec![line(&[[0.38, 0.2], [0.66, 0.5], [0.38, 0.8]])],
            Self::Previous => vec![line(&[[0.62, 0.2], [0.34, 0.5], [0.62, 0.8]])],
            Self::Overhead => vec![
                arc(0.5, 0.2, 0.1, 0.0, 1.0),
                line(&[[0.5, 0.38], [0.5, 0.66]]),
                line(&[[0.41, 0.57], [0.5, 0.66], [0.59, 0.57]]),
                line(&[[0.14, 0.82], [0.86, 0.82]]),
            ],
            Self::Oblique => vec![
                arc(0.2, 0.24, 0.1, 0.0, 1.0),
                line(&[[0.32, 0.36], [0.58, 0.62]]),
                line(&[[0.46, 0.62], [0.58, 0.62], [0.58, 0.5]]),
                line(&[[0.14, 0.82], [0.86, 0.82]]),
            ],
            Self::Raking(quarter) => raking(quarter),
            Self::Language => vec![
                arc(0.5, 0.5, 0.38, 0.0, 1.0),
                line(&[[0.12, 0.5], [0.88, 0.5]]),
                arc(0.92, 0.5, 0.58, 0.385, 0.615),
                arc(0.08, 0.5, 0.58, -0.115, 0.115),
            ],
            Self::TextSize => vec![
                line(&[[0.06, 0.8], [0.22, 0.4], [0.38, 0.8]]),
                line(&[[0.12, 0.66], [0.32, 0.66]]),
                line(&[[0.42, 0.8], [0.68, 0.16], [0.94, 0.8]]),
                line(&[[0.52, 0.56], [0.84, 0.56]]),
            ],
            Self::Contrast => {
                let mut strokes = vec![arc(0.5, 0.5, 0.36, 0.0, 1.0)];
                strokes.extend((0..8).map(|k| arc(0.5, 0.5, 0.045 * k as f32, -0.25, 0.25)));
                strokes.push(line(&[[0.5, 0.14], [0.5, 0.86]]));
                strokes
            }
            Self::Motion => vec![
                line(&[[0.08, 0.36], [0.4, 0.36]]),
                line(&[[0.08, 0.64], [0.4, 0.64]]),
                line(&[[0.18, 0.5], [0.5, 0.5]]),
                arc(0.72, 0.5, 0.16, 0.0, 1.0),
            ],
            Self::Back => vec![
                line(&[[0.86, 0.5], [0.14, 0.5]]),
                line(&[[0.4, 0.24], [0.14, 0.5], [0.4, 0.76]]),
            ],
            Self::Erase => vec![
                line(&[
                    [0.06, 0.5],
                    [0.34, 0.22],
                    [0.94, 0.22],
                    [0.94, 0.78],
                    [0.34, 0.78],
                    [0.06, 0.5],
                ]),
                line(&[[0.5, 0.38], [0.74, 0.62]]),
                line(&[[0.74, 0.38], [0.5, 0.62]]),
            ],
            Self::Caption => vec![
                rectangle(0.12, 0.14, 0.88, 0.86),
                line(&[[0.26, 0.36], [0.6, 0.36]]),
                line(&[[0.26, 0.52], [0.74, 0.52]]),
                line(&[[0.26, 0.66], [0.74, 0.66]]),
            ],
            Self::Done => vec![line(&[[0.14, 0.54], [0.4, 0.8], [0.86, 0.24]])],
        }
    }

    /// White on nothing, with the share of each pixel that is covered.
    fn picture(self) -> Image {
        let strokes = self.strokes();
        let mut rgba = Vec::with_capacity((SIDE * SIDE * 4) as usize);
        for y in 0..SIDE {
            for x in 0..SIDE {
                let at = (Vec2::new(x as f32, y as f32) + 0.5) / SIDE as f32;
                let segments = strokes.iter().flat_map(|stroke| stroke.windows(2));
                let nearest = segments
                    .map(|ends| distance(at, ends[0], ends[1]))
                    .fold(f32::INFINITY, f32::min);
                let covered = ((STROKE - nearest) * SIDE as f32 + 0.5).clamp(0.0, 1.0);
                rgba.extend([255, 255, 255, (covered * 255.0).round() as u8]);
            }
        }
        let size = Extent3d {
            width: SIDE,
            height: SIDE,
            depth_or_array_layers: 1,
        };
        let format = TextureFormat::Rgba8UnormSrgb;
        let usage = RenderAssetUsages::RENDER_WORLD;
        Image::new(size, TextureDimension::D2, rgba, format, usage)
    }
}

fn distance(at: Vec2, from: Vec2, to: Vec2) -> f32 {
    let along = to - from;
    let share = (at - from).dot(along) / along.length_squared().max(1e-12);
    at.distance(from + along * share.clamp(0.0, 1.0))
}

/// The pictures of the signs that were asked for.
#[derive(Resource, Default)]
pub struct Icons(HashMap<Icon, Handle<Image>>);

impl Icons {
    /// The picture of `icon`.
    pub fn get(&mut self, icon: Icon, images: &mut Assets<Image>) -> Handle<Image> {
        let add = || images.add(icon.picture());
        self.0.entry(icon).or_insert_with(add).clone()
    }
}
