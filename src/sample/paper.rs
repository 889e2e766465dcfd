//! A sheet of old laid rag paper: its colour, relief, thickness and watermark.
//!
//! Laid lines run across the sheet, chain lines up and down it. The felt side (recto) is a
//! little smoother than the mould side (verso).

use glam::{Vec2, Vec3};

use super::{
    grid::Plane,
    hand::{Hand, Pen, arc},
    noise::{Chance, Noise, smoothstep},
    stroke::{Knot, Layer, Stroke},
};

/// Colour of the paper in linear light.
pub const PAPER: Vec3 = Vec3::new(0.70, 0.635, 0.515);
/// Distance between laid lines and between chain lines, in mm.
const LAID_MM: f32 = 1.12;
pub const CHAIN_MM: f32 = 24.0;
/// Amplitudes of the relief, in µm.
const GRAIN_UM: f32 = 5.6;
const FELT_UM: f32 = 9.0;
const COCKLE_UM: f32 = 13.0;
const LAID_UM: [f32; 2] = [6.0, 9.0];
const CHAIN_UM: [f32; 2] = [5.0, 9.0];
const FOLD_UM: f32 = 24.0;
/// Half the width of the crease of the fold, in mm.
const FOLD_MM: f32 = 0.45;
/// Fibres per square millimetre that can be told apart.
const FIBRES_PER_MM2: f32 = 1.3;
/// Mean thickness and its swing by uneven pulp, in µm.
const THICKNESS_UM: f32 = 165.0;
const CLOUD_UM: f32 = 26.0;

/// Which face of the sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// The felt side.
    Recto,
    /// The mould side, seen mirror-wise.
    Verso,
}

/// One sheet.
pub struct Paper {
    size_mm: Vec2,
    grain: Noise,
    felt: Noise,
    /// Broad and slow, so kept as samples over the recto.
    cockle: Plane,
    cloud: Plane,
    stain: Plane,
    dust: Noise,
}

impl Paper {
    /// A sheet of this size.
    pub fn new(size_mm: Vec2, seed: i32) -> Self {
        let broad = |offset, scale, octaves| {
            Plane::of_noise(size_mm, &Noise::smooth(seed + offset, scale, octaves))
        };
        Self {
            size_mm,
            grain: Noise::smooth(seed, 0.42, 3),
            felt: Noise::smooth(seed + 1, 2.3, 2),
            cockle: broad(2, 46.0, 2),
            cloud: broad(3, 12.0, 4),
            stain: broad(4, 38.0, 3),
            dust: Noise::smooth(seed + 5, 1.1, 2),
        }
    }

    /// The same place in the recto's frame.
    pub fn on_recto(&self, face: Face, at: Vec2) -> Vec2 {
        match face {
            Face::Recto => at,
            Face::Verso => Vec2::new(self.size_mm.x - at.x, at.y),
        }
    }

    /// The tooth that catches chalk, about −1…1.
    pub fn tooth(&self, face: Face, at: Vec2) -> f32 {
        let offset = if face == Face::Recto {
            Vec2::ZERO
        } else {
            Vec2::new(517.0, 211.0)
        };
        self.grain.at(at + offset)
    }

    fn laid(&self, recto: Vec2) -> f32 {
        let bent = recto.y + 0.5 * self.cockle.at(recto * 0.8);
        (std::f32::consts::TAU * bent / LAID_MM).cos()
    }

    fn chain(recto: Vec2) -> f32 {
        let off = (recto.x / CHAIN_MM).fract() - 0.5;
        (-(off * CHAIN_MM / 0.55).powi(2)).exp()
    }

    fn fold(&self, recto: Vec2) -> f32 {
        let off = recto.x - 0.5 * self.size_mm.x - 0.35 * self.felt.at(recto * 0.12);
        (-(off / FOLD_MM).powi(2)).exp() - 0.35 * (-(off / (4.0 * FOLD_MM)).powi(2)).exp()
    }

    /// Height of the bare surface towards the viewer of this face, in µm, given its tooth.
    pub fn relief_um(&self, face: Face, at: Vec2, tooth: f32) -> f32 {
        let recto = self.on_recto(face, at);
        let (i, away) = if face == Face::Recto {
            (0, -1.0)
        } else {
            (1, 1.0)
        };
        let laid = self.laid(recto) * (0.75 + 0.4 * self.felt.at(recto * 0.3));
        GRAIN_UM * tooth
            + FELT_UM * self.felt.at(at)
            + away
                * (LAID_UM[i] * laid + CHAIN_UM[i] * Self::chain(recto)
                    - COCKLE_UM * self.cockle.at(recto)
                    + FOLD_UM * self.fold(recto))
    }

    /// Colour in linear light, given the tooth.
    pub fn albedo(&self, face: Face, at: Vec2, tooth: f32) -> Vec3 {
        let recto = self.on_recto(face, at);
        let cloud = self.cloud.at(recto);
        let stain = self.stain.at(recto);
        let edge = self.edge_mm(recto);
        // Light and fingers have browned the margins.
        let brown = 0.40 * (-(edge / 3.0)).exp() + 0.16 * (-(edge / 16.0)).exp();
        let brown = brown * (0.8 + 0.6 * stain) + 0.07 * stain;
        let fold = self.fold(recto).max(0.0);
        let lines = 0.010 * self.laid(recto) + 0.018 * Self::chain(recto);
        let grime = 0.05 * smoothstep(0.25, 0.75, self.dust.at(at)) * smoothstep(-0.2, 0.5, stain);
        let dark = brown * 0.55 + 0.012 * cloud + lines + 0.09 * fold + grime - 0.012 * tooth;
        PAPER * (-dark.max(-0.08) * Vec3::new(0.72, 1.0, 1.45)).exp()
    }

    /// Distance from the nearest edge, in mm.
    pub fn edge_mm(&self, recto: Vec2) -> f32 {
        let far = self.size_mm - recto;
        recto.x.min(recto.y).min(far.x).min(far.y)
    }

    /// Thickness of the sheet without its watermark, in µm.
    pub fn thickness_um(&self, recto: Vec2) -> f32 {
        let lines = 13.0 * self.laid(recto) * (1.0 - 0.4 * Self::chain(recto))
            - 14.0 * Self::chain(recto)
            + 10.0 * smoothstep(0.6, 1.9, 12.0 * Self::chain(recto + Vec2::new(1.1, 0.0)));
        THICKNESS_UM - lines
            + CLOUD_UM * self.cloud.at(recto)
            + 9.0 * self.felt.at(recto)
            + 5.0 * self.tooth(Face::Recto, recto)
    }

    /// Fibres that lie visibly on a face.
    pub fn fibres(&self, seed: u64) -> Vec<Stroke> {
        let mut chance = Chance::new(seed);
        let count = (self.size_mm.x * self.size_mm.y * FIBRES_PER_MM2) as usize;
        let fibre = |_| {
            let at = Vec2::new(chance.unit(), chance.unit()) * self.size_mm;
            let heading = Vec2::from_angle(chance.between(0.0, std::f32::consts::TAU));
            let length = chance.between(0.4, 2.0);
            let bend = heading.perp() * length * 0.3 * chance.centred();
            let radius_mm = chance.between(0.008, 0.02);
            let tau = chance.between(0.2, 1.0);
            let knots = [
                at,
                at + heading * length * 0.5 + bend,
                at + heading * length,
            ]
            .map(|at| Knot { at, radius_mm, tau });
            Stroke {
                layer: Layer::Fibre,
                knots: knots.to_vec(),
            }
        };
        (0..count).map(fibre).collect()
    }
}

/// The papermaker's wire: a flower of six petals over a ladder in a ring, with an initial.
pub fn watermark(middle: Vec2) -> Vec<Stroke> {
    let mut hand = Hand::new(7);
    let wire = Pen {
        layer: Layer::Stylus,
        width_mm: 0.62,
        tau: 1.0,
        ends: (1.0, 1.0),
        tremor_mm: 0.06,
    };
    let full = std::f32::consts::TAU;
    hand.line(wire, &arc(middle, Vec2::splat(20.0), 0.3, 0.3 + full));
    for side in [-3.2, 3.2] {
        let rail = [Vec2::new(side, 17.0), Vec2::new(side * 0.85, -1.0)];
        hand.line(wire, &rail.map(|p| middle + p));
    }
    for rung in 0..5 {
        let y = 14.5 - 3.6 * rung as f32;
        hand.line(
            wire,
            &[Vec2::new(-3.2, y), Vec2::new(3.2, y + 0.3)].map(|p| middle + p),
        );
    }
    let heart = middle + Vec2::new(0.0, -9.0);
    hand.line(wire, &arc(heart, Vec2::splat(1.7), 0.0, full));
    for petal in 0..6 {
        let out = Vec2::from_angle(full * (petal as f32 + 0.5) / 6.0);
        let across = out.perp();
        let points = [
            (1.7, -0.5),
            (4.6, -2.3),
            (7.6, -1.3),
            (8.3, 0.0),
            (7.6, 1.3),
            (4.6, 2.3),
            (1.7, 0.5),
        ];
        hand.curve(wire, &points.map(|(u, v)| heart + out * u + across * v));
    }
    hand.line(
        wire,
        &[Vec2::new(0.0, -20.0), Vec2::new(0.0, -25.0)].map(|p| middle + p),
    );
    hand.line(
        wire,
        &[Vec2::new(-2.4, -23.0), Vec2::new(2.4, -23.0)].map(|p| middle + p),
    );
    hand.strokes
}
