//! One side of a sheet as maps: strokes and paper become colour, relief and the rest, in bands
//! of rows that are computed in parallel.

use std::sync::LazyLock;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::{
    grid::{Grid, box_rows, transposed},
    paper::{Face, Paper},
    stroke::{Band, LAYERS, Layer, Stroke},
};

/// Heights of black and white of every height map, in µm.
pub const HEIGHT_RANGE_UM: [f32; 2] = [-128.0, 128.0];
/// How many grey quantities a side may have.
pub const GREYS: usize = 8;
/// Rows of one band.
const BAND_ROWS: usize = 48;
/// How far ageing ink spreads into the paper, in mm.
const HALO_MM: f32 = 0.22;
/// Thickness of the film of a stroke, in µm: at the least, per τ, and at the most.
const FILM_UM: [f32; 3] = [5.0, 2.2, 10.0];
/// Depth of a stylus groove and of the track of lead point, in µm.
const GROOVE_UM: f32 = 26.0;
const LEAD_TRACK_UM: f32 = 4.0;
/// Height of a fibre on the surface, in µm.
const FIBRE_UM: f32 = 5.0;
/// Optical depth of the materials by channel, relative to green.
const DARK_INK: Vec3 = Vec3::new(0.86, 1.0, 1.14);
const PALE_INK: Vec3 = Vec3::new(0.64, 1.0, 1.42);
const HALO: Vec3 = Vec3::new(0.45, 1.0, 1.9);
/// Colours of opaque particles in linear light.
const LEAD: Vec3 = Vec3::new(0.120, 0.118, 0.118);
const CHALK: Vec3 = Vec3::new(0.36, 0.090, 0.045);

/// What lies at one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Texel {
    /// Where it is, in the side's frame in mm.
    pub at: Vec2,
    /// The paper's tooth, about −1…1.
    pub tooth: f32,
    /// Optical depth per layer, after the paper has taken the ink unevenly.
    pub tau: [f32; LAYERS],
    /// Coverage per layer.
    pub cover: [f32; LAYERS],
    /// Ink that has spread around strokes.
    pub halo: f32,
    /// Colour of the bare paper in linear light.
    pub paper: Vec3,
}

impl Texel {
    /// Optical depth of a layer.
    pub fn tau(&self, layer: Layer) -> f32 {
        self.tau[layer as usize]
    }

    /// Coverage of a layer.
    pub fn cover(&self, layer: Layer) -> f32 {
        self.cover[layer as usize]
    }

    /// Share of the paper that chalk covers: it catches on the tooth.
    pub fn chalk(&self) -> f32 {
        let pressure = self.tau(Layer::Chalk);
        if pressure <= 0.0 {
            return 0.0;
        }
        // A light stroke touches the crests only, a heavy one fills the valleys.
        let crest = (0.62 * self.tooth + 0.98 * pressure.min(0.85) - 0.34) * 2.2;
        crest.clamp(0.0, 1.0) * (1.0 - (-3.2 * pressure).exp())
    }

    /// Share of the paper that lead point covers.
    pub fn lead(&self) -> f32 {
        let tau = self.tau(Layer::Lead);
        (1.0 - (-tau).exp()) * (0.8 + 0.5 * self.tooth).clamp(0.25, 1.2)
    }

    /// Colour of everything together in linear light; `wash` is the brush's τ by channel and
    /// `ageing` what time has added.
    pub fn colour(&self, wash: Vec3, ageing: Vec3) -> Vec3 {
        let fibre = 1.0 + 0.035 * self.tau(Layer::Fibre).min(1.0);
        let particles = |below: Vec3, pigment: Vec3, share: f32| below.lerp(pigment, share);
        let drawn = particles(self.paper * fibre, CHALK, self.chalk().min(0.96));
        let drawn = particles(drawn, LEAD, self.lead().min(0.9));
        let ink = self.tau(Layer::DarkInk) * DARK_INK
            + self.tau(Layer::PaleInk) * PALE_INK
            + self.halo * HALO;
        drawn * (-(ink + wash + ageing)).exp()
    }

    /// Height that the strokes add to the paper, in µm.
    pub fn film_um(&self) -> f32 {
        let [least, per_tau, most] = FILM_UM;
        let ink = [Layer::DarkInk, Layer::PaleInk].map(|layer| {
            self.cover(layer) * (least + per_tau * self.tau(layer)).clamp(least, most)
        });
        ink[0].max(ink[1]) + 6.0 * self.chalk() + FIBRE_UM * self.cover(Layer::Fibre)
            - GROOVE_UM * self.cover(Layer::Stylus)
            - LEAD_TRACK_UM * self.cover(Layer::Lead)
    }
}

/// A row-wise collection of one side's maps.
pub struct SideMaps<const COLOURS: usize> {
    /// Several colour pictures, 8-bit sRGB.
    pub colours: [Vec<[u8; 3]>; COLOURS],
    /// 16 bits over [`HEIGHT_RANGE_UM`].
    pub height: Vec<u16>,
    /// 8 bits, y up.
    pub normal: Vec<[u8; 3]>,
    /// GGX α, 8 bits.
    pub roughness: Vec<u8>,
    /// Up to [`GREYS`] grey quantities, 8 bits.
    pub greys: [Vec<u8>; GREYS],
}

/// What a side makes of one texel.
pub struct Shown<const COLOURS: usize> {
    /// Linear light.
    pub colours: [Vec3; COLOURS],
    /// GGX α.
    pub roughness: f32,
    /// Bytes as they are written.
    pub greys: [u8; GREYS],
}

/// Computes all maps of a side.
pub fn maps<const COLOURS: usize>(
    grid: Grid,
    paper: &Paper,
    face: Face,
    strokes: &[Stroke],
    show: impl Fn(&Texel) -> Shown<COLOURS> + Sync,
) -> SideMaps<COLOURS> {
    let bands: Vec<SideMaps<COLOURS>> = (0..grid.height.div_ceil(BAND_ROWS))
        .into_par_iter()
        .map(|i| {
            let first = i * BAND_ROWS;
            band(
                grid,
                first,
                BAND_ROWS.min(grid.height - first),
                paper,
                face,
                strokes,
                &show,
            )
        })
        .collect();
    let mut all = SideMaps::empty();
    for band in bands {
        all.append(band);
    }
    all
}

impl<const COLOURS: usize> SideMaps<COLOURS> {
    fn empty() -> Self {
        Self {
            colours: std::array::from_fn(|_| Vec::new()),
            height: Vec::new(),
            normal: Vec::new(),
            roughness: Vec::new(),
            greys: Default::default(),
        }
    }

    fn append(&mut self, other: Self) {
        for (all, more) in self.colours.iter_mut().zip(other.colours) {
            all.extend(more);
        }
        self.height.extend(other.height);
        self.normal.extend(other.normal);
        self.roughness.extend(other.roughness);
        for (all, more) in self.greys.iter_mut().zip(other.greys) {
            all.extend(more);
        }
    }
}

fn band<const COLOURS: usize>(
    grid: Grid,
    first: usize,
    rows: usize,
    paper: &Paper,
    face: Face,
    strokes: &[Stroke],
    show: &impl Fn(&Texel) -> Shown<COLOURS>,
) -> SideMaps<COLOURS> {
    let radius = (HALO_MM / grid.pitch_mm.y).round().max(1.0) as usize;
    let margin = 2 * radius + 1;
    let top = first.saturating_sub(margin);
    let bottom = (first + rows + margin).min(grid.height);
    let layers = Band::rasterise(grid, top, bottom - top, strokes);
    let halo = halo(&layers, radius);
    let texel = |column: usize, row: usize| {
        let i = (row - top) * grid.width + column;
        let at = grid.centre(column, row);
        let tooth = paper.tooth(face, at);
        let mut tau: [f32; LAYERS] = std::array::from_fn(|layer| layers.tau[layer][i]);
        // Ink sinks into the valleys between fibres.
        tau[Layer::DarkInk as usize] *= 1.0 - 0.16 * tooth;
        tau[Layer::PaleInk as usize] *= 1.0 - 0.28 * tooth;
        Texel {
            at,
            tooth,
            tau,
            cover: std::array::from_fn(|layer| layers.cover[layer][i]),
            halo: 0.075 * halo[i],
            paper: Vec3::ZERO,
        }
    };
    let relief = |texel: &Texel| paper.relief_um(face, texel.at, texel.tooth) + texel.film_um();
    let mut out = SideMaps::empty();
    let row_of = |row: usize| -> (Vec<Texel>, Vec<f32>) {
        let texels: Vec<Texel> = (0..grid.width).map(|column| texel(column, row)).collect();
        let heights = texels.iter().map(relief).collect();
        (texels, heights)
    };
    let mut above = row_of(first.saturating_sub(1)).1;
    let (mut texels, mut heights) = row_of(first);
    for row in first..first + rows {
        let (next_texels, below) = row_of((row + 1).min(grid.height - 1));
        for column in 0..grid.width {
            let mut here = texels[column];
            here.paper = paper.albedo(face, here.at, here.tooth);
            let shown = show(&here);
            for (out, colour) in out.colours.iter_mut().zip(shown.colours) {
                out.push(colour.to_array().map(srgb8));
            }
            out.normal
                .push(normal(grid, column, [&above, &heights, &below]));
            out.height.push(height16(heights[column]));
            out.roughness.push(unit8(shown.roughness));
            for (out, grey) in out.greys.iter_mut().zip(shown.greys) {
                out.push(grey);
            }
        }
        above = std::mem::replace(&mut heights, below);
        texels = next_texels;
    }
    out
}

/// The normal at a column of the middle one of three rows of heights in µm: 8 bits, y up.
fn normal(grid: Grid, column: usize, [above, here, below]: [&[f32]; 3]) -> [u8; 3] {
    let (left, right) = (column.saturating_sub(1), (column + 1).min(grid.width - 1));
    let per_um = 0.5e-3 / grid.pitch_mm;
    let slope_x = (here[right] - here[left]) * per_um.x;
    let slope_y = (above[column] - below[column]) * per_um.y;
    let normal = Vec3::new(-slope_x, -slope_y, 1.0).normalize();
    (normal * 0.5 + 0.5).to_array().map(unit8)
}

/// Normals of a whole grid of heights in µm: 8 bits, y up.
pub fn normals(grid: Grid, heights: &[f32]) -> Vec<[u8; 3]> {
    let row = |row: usize| &heights[row * grid.width..(row + 1) * grid.width];
    (0..grid.height)
        .flat_map(|y| {
            let rows = [
                row(y.saturating_sub(1)),
                row(y),
                row((y + 1).min(grid.height - 1)),
            ];
            (0..grid.width).map(move |column| normal(grid, column, rows))
        })
        .collect()
}

fn halo(layers: &Band, radius: usize) -> Vec<f32> {
    let width = layers.grid.width;
    let mut data = layers.tau[Layer::DarkInk as usize].clone();
    for _ in 0..2 {
        data = box_rows(&data, width, radius);
        data = transposed(&data, width, layers.rows);
        data = box_rows(&data, layers.rows, radius);
        data = transposed(&data, layers.rows, width);
    }
    data
}

/// Linear light 0…1 as an 8-bit sRGB level.
pub fn srgb8(linear: f32) -> u8 {
    SRGB8[(linear.clamp(0.0, 1.0) * SRGB_STEPS).round() as usize]
}

/// Steps of the table of levels: the steepest of them is a twentieth of a level.
const SRGB_STEPS: f32 = 65535.0;

/// IEC 61966-2-1, tabled because it is asked for a hundred million times.
static SRGB8: LazyLock<Vec<u8>> = LazyLock::new(|| {
    (0..=SRGB_STEPS as u32)
        .map(|step| {
            let x = step as f32 / SRGB_STEPS;
            unit8(if x <= 0.003_130_8 {
                12.92 * x
            } else {
                1.055 * x.powf(1.0 / 2.4) - 0.055
            })
        })
        .collect()
});

/// 0…1 as a byte.
pub fn unit8(x: f32) -> u8 {
    (x.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// A height in µm as 16 bits over [`HEIGHT_RANGE_UM`].
pub fn height16(um: f32) -> u16 {
    let [low, high] = HEIGHT_RANGE_UM;
    (((um - low) / (high - low)).clamp(0.0, 1.0) * 65535.0).round() as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::stroke::Knot;

    const SIZE_MM: Vec2 = Vec2::new(40.0, 30.0);
    const DPI: f64 = 300.0;

    fn texel(layer: Layer, tau: f32) -> Texel {
        let mut texel = Texel {
            at: Vec2::ZERO,
            tooth: 0.0,
            tau: [0.0; LAYERS],
            cover: [0.0; LAYERS],
            halo: 0.0,
            paper: Vec3::ONE,
        };
        texel.tau[layer as usize] = tau;
        texel.cover[layer as usize] = 1.0;
        texel
    }

    #[test]
    fn ink_stands_5_to_10_micrometres_high_and_the_stylus_cuts_20_to_30() {
        for layer in [Layer::DarkInk, Layer::PaleInk] {
            for tau in [0.05, 0.5, 1.0, 2.0, 6.0] {
                let um = texel(layer, tau).film_um();
                assert!((5.0..=10.0).contains(&um), "{layer:?} at τ {tau}: {um} µm");
            }
        }
        let groove = texel(Layer::Stylus, 1.0).film_um();
        assert!((-30.0..=-20.0).contains(&groove), "{groove} µm");
    }

    #[test]
    fn heights_stay_within_the_declared_range_and_grain_below_100_micrometres() {
        let paper = Paper::new(SIZE_MM, 100);
        let grid = Grid::at_dpi(SIZE_MM, DPI);
        for face in [Face::Recto, Face::Verso] {
            let bare = grid.map(|at| paper.relief_um(face, at, paper.tooth(face, at)));
            let low = bare.iter().copied().fold(f32::MAX, f32::min);
            let high = bare.iter().copied().fold(f32::MIN, f32::max);
            assert!(high - low < 100.0, "{face:?}: {low} to {high} µm");
            assert!(low - GROOVE_UM > HEIGHT_RANGE_UM[0] && high + 30.0 < HEIGHT_RANGE_UM[1]);
        }
    }

    #[test]
    fn ink_darkens_and_adds_up() {
        let knots = |y: f32| -> Vec<Knot> {
            [2.0, 38.0]
                .map(|x| Knot {
                    at: Vec2::new(x, y),
                    radius_mm: 0.5,
                    tau: 0.8,
                })
                .into()
        };
        let once = Stroke {
            layer: Layer::DarkInk,
            knots: knots(10.0),
        };
        let twice = Stroke {
            layer: Layer::DarkInk,
            knots: knots(20.0),
        };
        let strokes = [once, twice.clone(), twice];
        let grid = Grid::at_dpi(SIZE_MM, DPI);
        let paper = Paper::new(SIZE_MM, 100);
        let maps = maps(grid, &paper, Face::Recto, &strokes, |texel| Shown {
            colours: [texel.colour(Vec3::ZERO, Vec3::ZERO)],
            roughness: 0.5,
            greys: [0; GREYS],
        });
        let green_at = |y: f32| {
            let row = (y / grid.pitch_mm.y) as usize;
            maps.colours[0][row * grid.width + grid.width / 2][1]
        };
        let (bare, one, two) = (green_at(15.0), green_at(10.0), green_at(20.0));
        assert!(bare > one + 40 && one > two + 20, "{bare}, {one}, {two}");
    }
}
