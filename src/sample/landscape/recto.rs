//! The recto as maps.

use glam::Vec3;

use super::composition::Drawn;
use crate::sample::{
    damage::Damage,
    grid::{Grid, Plane},
    noise::{Noise, smoothstep},
    paper::{Face, Paper},
    side::{self, Shown, SideMaps, Texel},
    stroke::Layer,
};

/// Optical depth of the washes by channel, relative to green.
const WASH: Vec3 = Vec3::new(0.60, 1.0, 1.55);
/// Washes laid over each other: darkness of the drawing where each begins, and its τ.
const WASHES: [(f32, f32); 3] = [(0.30, 0.14), (0.49, 0.20), (0.68, 0.28)];
/// Width of a tide line and how far it lies inside the wash's edge, in mm.
const TIDE_MM: f32 = 0.16;
/// How much denser a wash dries at its tide line.
const TIDE_GAIN: f32 = 0.9;
/// What is left of the inks' and the wash's τ around 1 µm, and what lead gains.
const INFRARED_INK: f32 = 0.08;
const INFRARED_WASH: f32 = 0.05;
const INFRARED_LEAD: f32 = 4.2;

/// What is left of the inks' and the wash's τ at 850 nm: iron-gall ink is brown-black for its
/// absorption of visible light, and fades from 800 nm on.
const NEAR_INFRARED_INK: f32 = 0.22;
const NEAR_INFRARED_WASH: f32 = 0.12;
/// Reflectance of lead point there, which is as dark as to the eye, and of paper.
const NEAR_INFRARED_LEAD: f32 = 0.12;

/// Grey planes of the recto, in the order of [`SideMaps::greys`].
pub const INFRARED: usize = 0;
pub const LOWER_MEDIA: usize = 1;
pub const UPPER_MEDIA: usize = 2;
pub const ALL_MEDIA: usize = 3;
/// Reflectance in each band, sRGB-encoded, from the first on.
pub const BANDS: usize = 4;
/// The bands, in nm.
pub const BANDS_NM: [u32; 4] = [450, 550, 650, 850];
/// Codes in the media planes.
pub const NONE: u8 = 0;
pub const LEAD: u8 = 1;
pub const STYLUS: u8 = 2;
pub const WASHED: u8 = 3;
pub const PALE: u8 = 4;
pub const DARK: u8 = 5;

/// The brush over the drawing.
struct Brush<'a> {
    wash: &'a Plane,
    edge: Noise,
    pool: Noise,
}

impl Brush<'_> {
    /// Optical depth of all washes at a place (green).
    fn tau(&self, texel: &Texel) -> f32 {
        let wanted = self.wash.at(texel.at) + 0.022 * self.edge.at(texel.at);
        if wanted < WASHES[0].0 - 0.06 {
            return 0.0;
        }
        let steep = self.wash.gradient(texel.at).length().max(0.012);
        let pooled = 1.0 + 0.35 * self.pool.at(texel.at) - 0.10 * texel.tooth;
        WASHES
            .iter()
            .map(|&(from, tau)| {
                let inside_mm = (wanted - from) / steep;
                let edge = (-((inside_mm - TIDE_MM) / TIDE_MM).powi(2)).exp();
                let crisp = smoothstep(-0.3, 0.6, self.pool.at(texel.at * 0.4));
                let body = smoothstep(
                    -0.15 - 1.6 * (1.0 - crisp),
                    0.2 + 1.2 * (1.0 - crisp),
                    inside_mm,
                );
                tau * (body + TIDE_GAIN * crisp * edge)
            })
            .sum::<f32>()
            * pooled
    }
}

/// All maps of the recto; colours are after and before restoration.
pub fn maps(grid: Grid, paper: &Paper, damage: &Damage, drawn: &Drawn) -> SideMaps<2> {
    let brush = Brush {
        wash: &drawn.wash,
        edge: Noise::smooth(72, 1.7, 3),
        pool: Noise::smooth(73, 6.5, 2),
    };
    let mut strokes = paper.fibres(91);
    strokes.extend(drawn.strokes.iter().cloned());
    side::maps(grid, paper, Face::Recto, &strokes, |texel| {
        let wash = brush.tau(texel);
        let after = damage.after(paper, Face::Recto, texel.at);
        let before = damage.before(paper, Face::Recto, texel.at);
        let colours = [after, before].map(|ageing| texel.colour(wash * WASH, ageing));
        Shown {
            colours,
            roughness: roughness(texel, wash),
            greys: {
                let [lower, upper] = media(texel, wash);
                // Bands of visible light are what the colour is made of.
                let [red, green, blue] = colours[0].to_array().map(side::srgb8);
                [
                    infrared(texel, wash),
                    lower,
                    upper,
                    if upper == NONE { lower } else { upper },
                    blue,
                    green,
                    red,
                    near_infrared(texel, wash),
                ]
            },
        }
    })
}

fn roughness(texel: &Texel, wash: f32) -> f32 {
    let bare = 0.60 + 0.04 * texel.tooth;
    let washed = bare - 0.10 * (wash * 4.0).min(1.0);
    let leaded = washed + (0.30 - washed) * 0.8 * texel.lead();
    let ink = texel
        .cover(Layer::DarkInk)
        .max(0.8 * texel.cover(Layer::PaleInk));
    leaded + (0.36 + 0.03 * texel.tooth - leaded) * ink
}

fn media(texel: &Texel, wash: f32) -> [u8; 2] {
    let lower = if texel.cover(Layer::Stylus) > 0.5 {
        STYLUS
    } else if texel.cover(Layer::Lead) > 0.45 {
        LEAD
    } else if wash > 0.07 {
        WASHED
    } else {
        NONE
    };
    let upper = if texel.cover(Layer::DarkInk) > 0.4 {
        DARK
    } else if texel.cover(Layer::PaleInk) > 0.4 {
        PALE
    } else {
        NONE
    };
    [lower, upper]
}

/// What a camera sees at 850 nm: ink is fading, lead is not.
fn near_infrared(texel: &Texel, wash: f32) -> u8 {
    let paper = 0.30 + 0.62 * texel.paper.x;
    let drawn = paper + (NEAR_INFRARED_LEAD - paper) * texel.lead().min(0.9);
    let ink = NEAR_INFRARED_INK * (texel.tau(Layer::DarkInk) + texel.tau(Layer::PaleInk))
        + NEAR_INFRARED_WASH * wash;
    side::srgb8(drawn * (-ink).exp())
}

/// What a camera sees around 1 µm: the inks fade, the lead point underneath stays.
fn infrared(texel: &Texel, wash: f32) -> u8 {
    let paper = 0.30 + 0.62 * texel.paper.x;
    let lead = 1.0 - (-INFRARED_LEAD * texel.tau(Layer::Lead)).exp();
    let lead = lead * (0.85 + 0.35 * texel.tooth).clamp(0.3, 1.1);
    let ink = INFRARED_INK * (texel.tau(Layer::DarkInk) + texel.tau(Layer::PaleInk))
        + INFRARED_WASH * wash;
    side::srgb8(paper * (1.0 - 0.88 * lead.min(1.0)) * (-ink).exp())
}
