//! Shadows of the mesostructure: rays cast over the height map.
//!
//! Between its texels the surface is the cubic B-spline over them, whose slope at a texel is the
//! central difference of its neighbours, as a normal map has it, and which lowers a ridge of one
//! texel by a third. Planes between texels would be
//! steeper than any normal: where a facet just faces the lamp by its normal, its own plane would
//! hide it, and half of a groove's wall would be dark for no reason.

use glam::DVec2;

use super::field::Field;
use crate::reference::rng::{Rng, uniform};

/// No ray is followed further, in mm: light then falls less than half a degree high on a relief of
/// 400 µm.
const REACH_MAX_MM: f64 = 50.0;
/// Steps over a texel.
const STEPS_PER_TEXEL: f64 = 2.0;
/// Heights above the ray by no more are the rounding of the map's texels, in mm.
const ROUNDING_MM: f64 = 1e-5;

/// Edge of a block of texels whose highest is known, so that rays above it skip it.
const BLOCK: usize = 16;

pub(super) struct Relief {
    heights: Field,
    /// Height of black, and how much higher white is, in mm.
    range_mm: [f64; 2],
    top_mm: f64,
    step_mm: f64,
    /// The highest texel that counts in each block, row by row, in mm.
    blocks: Vec<f64>,
    blocks_across: usize,
}

impl Relief {
    pub fn new(heights: Field, [low, high]: [f64; 2]) -> Self {
        let range_mm = [low / 1000.0, (high - low) / 1000.0];
        let at = |stored: f64| range_mm[0] + range_mm[1] * stored;
        let [width, height] = heights.size();
        let [blocks_across, blocks_down] = [width, height].map(|edge| edge.div_ceil(BLOCK));
        let mut blocks = vec![f64::NEG_INFINITY; blocks_across * blocks_down];
        for (i, most) in blocks.iter_mut().enumerate() {
            let [column, row] = [i % blocks_across, i / blocks_across].map(|block| block * BLOCK);
            // The spline reaches one texel back and two on.
            for y in row.saturating_sub(1)..(row + BLOCK + 2).min(height) {
                for x in column.saturating_sub(1)..(column + BLOCK + 2).min(width) {
                    *most = most.max(at(heights.texel([x, y])));
                }
            }
        }
        Self {
            top_mm: blocks.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            step_mm: heights.texel_mm() / STEPS_PER_TEXEL,
            heights,
            range_mm,
            blocks,
            blocks_across,
        }
    }

    /// At a place in texels.
    fn height(&self, at: DVec2) -> f64 {
        self.range_mm[0] + self.range_mm[1] * self.heights.spline(at)
    }

    /// How far, in mm, a ray from `at` that moves on by `along` texels per mm stays over one block,
    /// and how high that is.
    fn block(&self, at: DVec2, along: DVec2) -> (f64, f64) {
        let [width, height] = self.heights.size();
        let most = DVec2::new(width as f64, height as f64) - 1.0;
        let block = (at.clamp(DVec2::ZERO, most) / BLOCK as f64).floor();
        let index = block.y as usize * self.blocks_across + block.x as usize;
        let edge = (block + along.signum().max(DVec2::ZERO)) * BLOCK as f64;
        let left = (edge - at) / along;
        // Beyond the map's border the height stays.
        let left = DVec2::select(along.abs().cmpgt(DVec2::ZERO), left, DVec2::INFINITY);
        (left.min_element(), self.blocks[index])
    }

    /// Whether light comes to `place` (side frame) along `towards`, a unit vector of the side
    /// frame, from a lamp that rises by `rise` mm per mm.
    pub fn is_lit(&self, place: DVec2, towards: DVec2, rise: f64, rng: &mut Rng) -> bool {
        if rise <= 0.0 {
            return false;
        }
        let from = self.heights.in_texels(place);
        let along = self.heights.in_texels(place + towards) - from;
        let here = self.height(from) + ROUNDING_MM;
        let reach = ((self.top_mm - here) / rise).min(REACH_MAX_MM);
        // A start by chance keeps steps from beating with texels.
        let mut t = self.step_mm * (1.0 - 0.5 * uniform(rng));
        while t < reach {
            let at = from + along * t;
            let ray = here + rise * t;
            let (left, most) = self.block(at, along);
            if ray < most {
                if self.height(at) > ray {
                    return false;
                }
                t += self.step_mm;
            } else {
                t += self.step_mm * (left / self.step_mm).ceil().clamp(1.0, 1e6);
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use glam::DAffine2;

    use super::*;
    use crate::{
        maps::{Level, Pyramid, Texels},
        reference::rng::stream,
    };

    /// A relief of 64 × 4 texels of .1 mm from its profile in µm.
    fn relief(profile: impl Fn(usize) -> f64) -> Relief {
        const SIZE: [u32; 2] = [64, 4];
        let texel = |i: u32| ((profile((i % SIZE[0]) as usize) + 128.0) / 256.0 * 65535.0) as u16;
        let level = Level {
            width: SIZE[0],
            height: SIZE[1],
            texels: Texels::Unorm16((0..SIZE[0] * SIZE[1]).map(texel).collect()),
        };
        let pyramid = Pyramid {
            channels: 1,
            levels: vec![level],
            missing: 0,
        };
        let uv_from_side = DAffine2::from_scale(DVec2::new(1.0 / 6.4, 1.0 / 0.4));
        Relief::new(Field::new(pyramid, uv_from_side).unwrap(), [-128.0, 128.0])
    }

    fn lit(relief: &Relief, x: f64, rise: f64) -> bool {
        let mut rng = stream(7, 0);
        relief.is_lit(DVec2::new(x, 0.2), DVec2::NEG_X, rise, &mut rng)
    }

    #[test]
    fn a_wall_shadows_as_far_as_it_is_high() {
        // 100 µm high up to 1.55 mm, where the spline falls over two texels.
        let wall = relief(|x| if x < 16 { 100.0 } else { 0.0 });
        for rise in [0.1, 0.05] {
            let end = 1.55 + 0.1 / rise;
            assert!(!lit(&wall, end - 0.15, rise), "{rise}");
            assert!(lit(&wall, end + 0.15, rise), "{rise}");
        }
        assert!(lit(&wall, 1.0, 0.1) && !lit(&wall, 3.0, -0.1));
        // One texel in a corner of a block shadows what lies in the next but one.
        let needle = relief(|x| if x == 15 { 100.0 } else { 0.0 });
        assert!(!lit(&needle, 4.9, 0.018) && lit(&needle, 5.9, 0.018));
    }

    #[test]
    fn a_facet_that_faces_the_lamp_by_its_normal_is_not_hidden_by_itself() {
        // A groove whose wall falls by 14, 18 and 14 µm a texel: by central differences nowhere
        // steeper than .16, as planes .18 in the middle.
        let steps = [14.0, 18.0, 14.0];
        let groove = relief(|x| -steps.iter().take(x.saturating_sub(20)).sum::<f64>());
        let places = (0..60).map(|i| 2.0 + 0.01 * f64::from(i));
        assert!(places.clone().all(|x| lit(&groove, x, 0.17)));
        // A lamp lower than the wall is steep is hidden at its foot.
        assert!(places.clone().any(|x| !lit(&groove, x, 0.14)));
    }
}
