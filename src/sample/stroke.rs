//! Strokes: lines of varying width and density, rasterised in bands of rows.
//!
//! | symbol | meaning |
//! |---|---|
//! | τ | optical depth of the film along the normal, green channel |
//! | c | share of a pixel's area that a stroke covers |
//!
//! Within one stroke the densest place wins (a pen does not darken its own bend twice);
//! strokes over each other add their optical depths.

use glam::Vec2;

use super::grid::Grid;

/// What a stroke is drawn with. Each layer has planes of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Layer {
    /// Paper fibres that lie on the surface.
    Fibre,
    /// Grooves without colour.
    Stylus,
    /// Lead point.
    Lead,
    /// Red chalk.
    Chalk,
    /// The paler iron-gall ink.
    PaleInk,
    /// The darker iron-gall ink.
    DarkInk,
}

/// Number of layers.
pub const LAYERS: usize = 6;

/// One place of a stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knot {
    /// In mm.
    pub at: Vec2,
    /// Half the width of the stroke in mm.
    pub radius_mm: f32,
    /// Optical depth where the stroke covers the paper entirely.
    pub tau: f32,
}

/// A line drawn without lifting the tool.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Its tool.
    pub layer: Layer,
    /// In order along the line.
    pub knots: Vec<Knot>,
}

/// All layers over some rows of a grid.
pub struct Band {
    /// The whole grid.
    pub grid: Grid,
    /// First row of the band.
    pub first_row: usize,
    /// Number of rows.
    pub rows: usize,
    /// Optical depth per layer, summed over strokes.
    pub tau: [Vec<f32>; LAYERS],
    /// Largest coverage of a pixel per layer.
    pub cover: [Vec<f32>; LAYERS],
}

impl Band {
    /// Rasterises the strokes that touch these rows, in their order.
    pub fn rasterise(grid: Grid, first_row: usize, rows: usize, strokes: &[Stroke]) -> Self {
        let area = grid.width * rows;
        let planes = || std::array::from_fn(|_| vec![0.0; area]);
        let mut band = Self {
            grid,
            first_row,
            rows,
            tau: planes(),
            cover: planes(),
        };
        let mut scratch = vec![(0.0f32, 0.0f32); area];
        let mut touched = Vec::new();
        let top = first_row as f32 * grid.pitch_mm.y;
        let bottom = (first_row + rows) as f32 * grid.pitch_mm.y;
        for stroke in strokes {
            for pair in stroke.knots.windows(2) {
                let reach = pair[0].radius_mm.max(pair[1].radius_mm) + grid.pitch_mm.y;
                let (low, high) = (
                    pair[0].at.y.min(pair[1].at.y),
                    pair[0].at.y.max(pair[1].at.y),
                );
                if low - reach < bottom && high + reach > top {
                    band.segment(pair[0], pair[1], &mut scratch, &mut touched);
                }
            }
            let layer = stroke.layer as usize;
            for i in touched.drain(..) {
                let (tau, cover) = std::mem::take(&mut scratch[i]);
                band.tau[layer][i] += tau;
                band.cover[layer][i] = band.cover[layer][i].max(cover);
            }
        }
        band
    }

    fn segment(&self, a: Knot, b: Knot, scratch: &mut [(f32, f32)], touched: &mut Vec<usize>) {
        let pitch = self.grid.pitch_mm;
        let half_pixel = 0.25 * (pitch.x + pitch.y);
        let reach = a.radius_mm.max(b.radius_mm) + half_pixel;
        let low = (a.at.min(b.at) - reach) / pitch - 0.5;
        let high = (a.at.max(b.at) + reach) / pitch - 0.5;
        let last_row = self.first_row + self.rows;
        let rows = (low.y.ceil().max(self.first_row as f32) as usize)
            ..((high.y.floor() + 1.0).clamp(0.0, last_row as f32) as usize);
        let columns = (low.x.ceil().max(0.0) as usize)
            ..((high.x.floor() + 1.0).clamp(0.0, self.grid.width as f32) as usize);
        let along = b.at - a.at;
        let per_length = 1.0 / along.length_squared().max(1e-12);
        for row in rows {
            for column in columns.clone() {
                let from_a = self.grid.centre(column, row) - a.at;
                let t = (from_a.dot(along) * per_length).clamp(0.0, 1.0);
                let distance = (from_a - along * t).length();
                let radius = a.radius_mm + (b.radius_mm - a.radius_mm) * t;
                let cover = footprint_cover(distance, radius, half_pixel);
                if cover <= 0.0 {
                    continue;
                }
                let rim = (distance / radius.max(half_pixel)).min(1.0);
                let full = (a.tau + (b.tau - a.tau) * t) * (CENTRE_TAU + RIM_TAU * rim * rim);
                // A partly covered pixel transmits 1 − c + c·e^(−τ).
                let tau = -(-cover * (1.0 - (-full).exp())).ln_1p();
                let i = (row - self.first_row) * self.grid.width + column;
                if scratch[i].1 == 0.0 {
                    touched.push(i);
                }
                scratch[i] = (scratch[i].0.max(tau), scratch[i].1.max(cover));
            }
        }
    }
}

/// Ink drawn to the edges of a stroke as it dries: relative τ in its middle, and what the rim
/// has more.
const CENTRE_TAU: f32 = 0.85;
const RIM_TAU: f32 = 0.35;

/// Share of a pixel (a box across the stroke) that a stroke of this radius covers.
fn footprint_cover(distance: f32, radius: f32, half_pixel: f32) -> f32 {
    let overlap = (distance + half_pixel).min(radius) - (distance - half_pixel).max(-radius);
    (overlap / (2.0 * half_pixel)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The finest pen line of the landscape, in mm.
    const FINEST_MM: f32 = 0.09;

    #[test]
    fn the_finest_stroke_measures_90_micrometres_on_the_raster() {
        for dpi in [300.0, 600.0] {
            let grid = Grid::at_dpi(Vec2::new(10.0, 10.0), dpi);
            let knot = |x: f32, y: f32| Knot {
                at: Vec2::new(x, y),
                radius_mm: FINEST_MM / 2.0,
                tau: 1.0,
            };
            let strokes = [Stroke {
                layer: Layer::DarkInk,
                knots: vec![knot(3.01, 1.0), knot(3.63, 9.0)],
            }];
            let band = Band::rasterise(grid, 0, grid.height, &strokes);
            let row = grid.height / 2;
            let covered: f32 = (0..grid.width)
                .map(|column| band.cover[Layer::DarkInk as usize][row * grid.width + column])
                .sum();
            let width_mm = covered * grid.pitch_mm.x;
            assert!(
                (width_mm - FINEST_MM).abs() < 0.01,
                "{width_mm} mm at {dpi} dpi"
            );
        }
    }

    #[test]
    fn bands_join_without_a_seam() {
        let grid = Grid::at_dpi(Vec2::new(10.0, 10.0), 100.0);
        let knot = |x: f32, y: f32| Knot {
            at: Vec2::new(x, y),
            radius_mm: 0.3,
            tau: 1.0,
        };
        let strokes = [
            Stroke {
                layer: Layer::PaleInk,
                knots: vec![knot(1.0, 1.0), knot(9.0, 8.0)],
            },
            Stroke {
                layer: Layer::PaleInk,
                knots: vec![knot(9.0, 1.0), knot(1.0, 8.0)],
            },
        ];
        let whole = Band::rasterise(grid, 0, grid.height, &strokes);
        let layer = Layer::PaleInk as usize;
        let mut joined = Vec::new();
        for first in (0..grid.height).step_by(7) {
            let rows = 7.min(grid.height - first);
            joined.extend(Band::rasterise(grid, first, rows, &strokes).tau[layer].clone());
        }
        assert_eq!(whole.tau[layer], joined);
    }
}
