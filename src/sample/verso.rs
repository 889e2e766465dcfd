//! The verso of the landscape's sheet as maps: the red-chalk figure, ink trials, and the recto
//! showing through.

use glam::{Vec2, Vec3};

use super::{
    damage::Damage,
    figure,
    grid::{Grid, Plane},
    hand::{Hand, Pen},
    paper::{Face, Paper},
    script,
    side::{self, Shown, SideMaps},
    stroke::{Band, Layer, Stroke},
};

/// Crown of the figure's head, in mm.
const HEAD: Vec2 = Vec2::new(118.0, 14.0);
/// Colour that rubbed chalk gives, as optical depth by channel.
const RUBBED: Vec3 = Vec3::new(0.10, 0.42, 0.50);
/// How the recto's ink shows through, as optical depth by channel per τ of ink.
const STRIKE_THROUGH: Vec3 = Vec3::new(0.060, 0.105, 0.165);
/// How far ink spreads on its way through, in mm.
const SPREAD_MM: f32 = 0.4;
/// Samples per mm of what shows through.
const PER_MM: f32 = 4.0;
const TRIAL_PEN: Pen = Pen::quill(Layer::DarkInk, 0.42, 1.7);
const ACCOUNT_PEN: Pen = Pen::quill(Layer::PaleInk, 0.24, 1.25);

/// Grey planes of the verso, in the order of [`SideMaps::greys`].
pub const CHALK: usize = 0;
pub const INK: usize = 1;

/// All maps of the verso; colours are after and before restoration.
pub fn maps(
    grid: Grid,
    size_mm: Vec2,
    paper: &Paper,
    damage: &Damage,
    recto: &[Stroke],
) -> SideMaps<2> {
    let through = strike_through(size_mm, recto);
    let mut hand = Hand::new(211);
    let rubbed = figure::draw(&mut hand, size_mm, HEAD);
    script::pen_trials(&mut hand, TRIAL_PEN, Vec2::new(196.0, 40.0));
    script::accounts(&mut hand, ACCOUNT_PEN, Vec2::new(203.0, 108.0), 9);
    let mut strokes = paper.fibres(92);
    strokes.append(&mut hand.strokes);
    side::maps(grid, paper, Face::Verso, &strokes, |texel| {
        let recto = paper.on_recto(Face::Verso, texel.at);
        let tint = RUBBED * rubbed.at(texel.at) * (0.8 + 0.5 * texel.tooth)
            + STRIKE_THROUGH * through.at(recto);
        let after = damage.after(paper, Face::Verso, texel.at);
        let before = damage.before(paper, Face::Verso, texel.at);
        let chalk = texel.chalk();
        let ink = texel.cover(Layer::DarkInk).max(texel.cover(Layer::PaleInk));
        let bare = 0.62 + 0.04 * texel.tooth;
        let dusty = bare + (0.80 - bare) * chalk;
        Shown {
            colours: [after, before].map(|ageing| texel.colour(tint, ageing)),
            roughness: dusty + (0.36 - dusty) * ink,
            greys: [side::unit8(chalk), side::unit8(ink), 0, 0, 0, 0, 0, 0],
        }
    })
}

/// Optical depth of the recto's inks, blurred, in the recto's frame.
fn strike_through(size_mm: Vec2, recto: &[Stroke]) -> Plane {
    let (w, h) = ((size_mm.x * PER_MM) as usize, (size_mm.y * PER_MM) as usize);
    let grid = Grid::with_pixels(size_mm, w, h);
    let mut band = Band::rasterise(grid, 0, grid.height, recto);
    let data = std::mem::take(&mut band.tau[Layer::DarkInk as usize]);
    Plane { grid, data }.blurred(SPREAD_MM)
}
