//! Swatches divided into places to learn from, to choose by and to be judged by.
//!
//! Neighbouring pixels are alike: noise apart, a pixel beside one that was learnt from is no test.
//! So a swatch is cut into blocks, whole blocks are held out, and of each block the rim is left
//! out whose features look into its neighbours.

use super::features::REACH;
use crate::prepare::capture::Crop;

/// Blocks along the shorter side of a swatch, where it is large enough.
const ALONG: usize = 6;
/// The smallest block that leaves a core once its rim is gone.
const LEAST_PX: usize = 3 * REACH + 2;

/// What a place is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Classifiers are fitted to it.
    Learning,
    /// The better classifier is chosen by it.
    Choosing,
    /// It judges the chosen one, and has had no say before.
    HeldOut,
}

impl Part {
    /// Of one of a class's swatches that are too small to be cut: of four, two are learnt from.
    fn of_swatch(number: usize) -> Self {
        match number % 4 {
            0 | 2 => Self::Learning,
            1 => Self::Choosing,
            _ => Self::HeldOut,
        }
    }

    /// Of the block in this column and row: of four in a row two are learnt from, and the next row
    /// is shifted, so that all parts lie all over the swatch.
    fn of_block(column: usize, row: usize) -> Self {
        match (column + 2 * (row % 2) + row / 2) % 4 {
            0 | 3 => Self::Learning,
            1 => Self::HeldOut,
            _ => Self::Choosing,
        }
    }
}

/// A swatch in blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blocks {
    rect: Crop,
    side: usize,
    /// What all of it is for, where it is too small to be cut.
    whole: Option<Part>,
}

impl Blocks {
    /// Cuts a swatch, in pixels of what is solved: the one of this `number` in its class.
    pub fn new(rect: Crop, number: usize) -> Self {
        let [width, height] = [rect.width(), rect.height()];
        let side = (width.min(height) / ALONG).max(LEAST_PX);
        let is_small = width.max(height) < 2 * side;
        Self {
            rect,
            side,
            whole: is_small.then(|| Part::of_swatch(number)),
        }
    }

    /// What the pixel is for; `None` outside the swatch and in the rim of a block.
    pub fn part(&self, x: usize, y: usize) -> Option<Part> {
        let Crop {
            left,
            top,
            right,
            bottom,
        } = self.rect;
        let (left, top) = (left as usize, top as usize);
        if x < left || y < top || x >= right as usize || y >= bottom as usize {
            return None;
        }
        if self.whole.is_some() {
            return self.whole;
        }
        let column = self.along(x - left, self.rect.width())?;
        let row = self.along(y - top, self.rect.height())?;
        Some(Part::of_block(column, row))
    }

    /// The block along an axis, unless the place is in its rim. The last one takes what is left,
    /// and the swatch's own edge is no neighbour.
    fn along(&self, at: usize, length: usize) -> Option<usize> {
        let blocks = (length / self.side).max(1);
        let block = (at / self.side).min(blocks - 1);
        let within = at - block * self.side;
        let end = match block + 1 == blocks {
            true => length,
            false => (block + 1) * self.side,
        };
        let after = end - 1 - at;
        let clear = (block == 0 || within >= REACH) && (block + 1 == blocks || after >= REACH);
        clear.then_some(block)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_feature_sees_two_parts() {
        let rect = |right, bottom| Crop {
            left: 3,
            top: 5,
            right,
            bottom,
        };
        for rect in [rect(63, 45), rect(30, 200), rect(16, 17)] {
            let blocks = Blocks::new(rect, 0);
            let mut counts = [0; 3];
            for y in 0..210 {
                for x in 0..80 {
                    let Some(part) = blocks.part(x, y) else {
                        continue;
                    };
                    counts[part as usize] += 1;
                    for dy in 0..=2 * REACH {
                        for dx in 0..=2 * REACH {
                            let (u, v) =
                                ((x + dx).wrapping_sub(REACH), (y + dy).wrapping_sub(REACH));
                            let near = blocks.part(u, v);
                            assert!(near.is_none_or(|near| near == part), "{x} {y}");
                        }
                    }
                }
            }
            assert!(counts[0] > 0, "{rect:?}");
            if rect.bottom > 40 {
                assert!(counts.iter().all(|count| *count > 50), "{counts:?}");
                assert!(counts[0] > counts[1].max(counts[2]), "{counts:?}");
            }
        }
    }
}
