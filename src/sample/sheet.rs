//! What belongs to the whole sheet of the landscape: outline, curl, light that passes through.

use glam::Vec2;

use super::{
    damage::Damage,
    grid::{Grid, Plane},
    paper::{Paper, watermark},
    side,
    stroke::{Band, Layer},
};

/// Heights of black and white of the macroscopic surface, in µm.
pub const CURL_RANGE_UM: [f32; 2] = [-1000.0, 5000.0];
/// Thickness of black and white of the thickness overlay, in µm.
pub const THICKNESS_RANGE_UM: [f32; 2] = [60.0, 260.0];
/// Where the watermark lies: between two chain lines, in the left half.
const WATERMARK_AT: Vec2 = Vec2::new(96.0, 99.0);
/// Thickness that the wire of the watermark displaced, in µm.
const WIRE_UM: f32 = 34.0;
/// Samples per mm of the watermark.
const PER_MM: f32 = 8.0;
/// Thickness over which light falls to 1/e, in µm.
const ATTENUATION_UM: f32 = 78.0;
/// Share of the light through the thinnest paper, so that the map uses its range.
const BRIGHTEST: f32 = 0.24;
/// Samples of each pixel of the outline, each way.
const OUTLINE_SAMPLES: usize = 3;

/// Thickness of the sheet with its watermark.
pub struct Thickness<'a> {
    paper: &'a Paper,
    wire: Plane,
}

impl<'a> Thickness<'a> {
    /// Lays the watermark into the paper.
    pub fn new(paper: &'a Paper, size_mm: Vec2) -> Self {
        let (w, h) = ((size_mm.x * PER_MM) as usize, (size_mm.y * PER_MM) as usize);
        let grid = Grid::with_pixels(size_mm, w, h);
        let mut band = Band::rasterise(grid, 0, grid.height, &watermark(WATERMARK_AT));
        let data = std::mem::take(&mut band.cover[Layer::Stylus as usize]);
        Self {
            paper,
            wire: Plane { grid, data }.blurred(0.17),
        }
    }

    /// At a place of the recto, in µm.
    pub fn um(&self, recto: Vec2) -> f32 {
        self.paper.thickness_um(recto) - WIRE_UM * self.wire.at(recto)
    }

    /// The sheet on a light table, 8-bit sRGB.
    pub fn transmission(&self, grid: Grid) -> Vec<u8> {
        grid.map(|p| side::srgb8((-self.um(p) / ATTENUATION_UM).exp() / BRIGHTEST))
    }

    /// Thickness over [`THICKNESS_RANGE_UM`], 8 bits.
    pub fn overlay(&self, grid: Grid) -> Vec<u8> {
        let [low, high] = THICKNESS_RANGE_UM;
        grid.map(|p| side::unit8((self.um(p) - low) / (high - low)))
    }
}

/// White where there is paper.
pub fn outline(grid: Grid, damage: &Damage) -> Vec<u8> {
    grid.map(|p| {
        let n = OUTLINE_SAMPLES;
        let hits = (0..n * n)
            .filter(|i| {
                let step = Vec2::new((i % n) as f32, (i / n) as f32) + 0.5;
                damage.present(p + (step / n as f32 - 0.5) * grid.pitch_mm)
            })
            .count();
        side::unit8(hits as f32 / (n * n) as f32)
    })
}

/// A sheet that has lain rolled: two corners lift, the fold stands a little.
pub fn curl(grid: Grid, size_mm: Vec2) -> Vec<u16> {
    let [low, high] = CURL_RANGE_UM;
    grid.map(|p| {
        let q = p / size_mm;
        let corner = |c: Vec2, reach: f32| (-((q - c) / reach).length_squared()).exp();
        let um = 3600.0 * corner(Vec2::new(1.02, 1.05), 0.30)
            + 2300.0 * corner(Vec2::new(-0.03, 0.95), 0.24)
            + 900.0 * corner(Vec2::new(0.95, -0.05), 0.28)
            + 420.0 * (-((q.x - 0.5) / 0.09).powi(2)).exp()
            + 260.0 * (5.5 * q.x + 1.0).sin() * (3.1 * q.y).sin();
        (((um - low) / (high - low)).clamp(0.0, 1.0) * 65535.0).round() as u16
    })
}
