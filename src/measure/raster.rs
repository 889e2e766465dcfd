//! An area of a map as grey values, and the same without writing and slow shades.

use super::{MeasureError, count, positive};

/// Most pixels of an area.
pub const MAX_PIXELS: usize = 1 << 27;
/// Darker than the paper around by this many standard deviations is taken for ink. Laid lines are
/// a wave, whose trough is 1.4 deviations deep.
const INK: f64 = 4.0;
/// How far around ink the paper is left out too, in mm: edges of strokes are soft.
const EDGE_MM: f64 = 0.2;
/// Single values are clipped to so many standard deviations, so that specks do not count.
const CLIP: f64 = 3.0;
/// Ink biases the mean by which it is told; so often is it told anew.
const ROUNDS: usize = 3;
/// Values from which the noise is estimated.
const NOISE_SAMPLES: usize = 100_000;

/// Grey values (transmission or albedo, higher is lighter) over an area of a side, row by row
/// from the top left. NaN stands for what is off the sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    width: usize,
    height: usize,
    values: Vec<f32>,
    mm_per_pixel: f64,
}

impl Raster {
    /// An area of `width` × `height` pixels of `mm_per_pixel` each way.
    ///
    /// # Errors
    /// As many values as pixels are needed, 1 to [`MAX_PIXELS`], and a pixel of finite size.
    pub fn new(
        width: usize,
        height: usize,
        values: Vec<f32>,
        mm_per_pixel: f64,
    ) -> Result<Self, MeasureError> {
        positive("the map's pixel in mm", mm_per_pixel)?;
        let pixels = width.saturating_mul(height);
        count("pixels", pixels, 1, MAX_PIXELS)?;
        count("values", values.len(), pixels, pixels)?;
        Ok(Self {
            width,
            height,
            values,
            mm_per_pixel,
        })
    }

    /// Width and height in mm.
    pub fn size_mm(&self) -> [f64; 2] {
        [self.width, self.height].map(|n| n as f64 * self.mm_per_pixel)
    }

    /// Size of a pixel in mm.
    pub fn mm_per_pixel(&self) -> f64 {
        self.mm_per_pixel
    }

    /// A value; NaN off the sheet and off the area.
    pub fn value(&self, column: usize, row: usize) -> f32 {
        let inside = column < self.width && row < self.height;
        if inside {
            self.values[row * self.width + column]
        } else {
            f32::NAN
        }
    }

    /// The same area in pixels that are a whole number of these and at most `mm`, each the mean
    /// of those on the sheet. A rest at the right and the bottom is left out.
    pub(super) fn coarser(&self, mm: f64) -> Self {
        let factor =
            ((mm / self.mm_per_pixel).floor() as usize).clamp(1, self.width.min(self.height));
        let (width, height) = (self.width / factor, self.height / factor);
        let mut values = Vec::with_capacity(width * height);
        for row in 0..height {
            for column in 0..width {
                let (mut sum, mut known) = (0.0, 0u32);
                for y in row * factor..(row + 1) * factor {
                    let start = y * self.width + column * factor;
                    for &v in self.values[start..start + factor]
                        .iter()
                        .filter(|v| v.is_finite())
                    {
                        sum += f64::from(v);
                        known += 1;
                    }
                }
                values.push(if known == 0 {
                    f32::NAN
                } else {
                    (sum / f64::from(known)) as f32
                });
            }
        }
        Self {
            width,
            height,
            values,
            mm_per_pixel: self.mm_per_pixel * factor as f64,
        }
    }

    /// The paper's own structure: less its slow shades, over its standard deviation, 0 where
    /// there is ink or no sheet. The shade at a place is the mean of the paper in the square of
    /// `shade_mm` each way.
    pub(super) fn cleaned(&self, shade_mm: f64) -> Cleaned {
        let reach = |mm: f64| {
            (mm / self.mm_per_pixel)
                .ceil()
                .min(self.width.max(self.height) as f64) as usize
        };
        let on_sheet: Vec<bool> = self.values.iter().map(|v| v.is_finite()).collect();
        let mut paper = on_sheet.clone();
        let mut rest = vec![0.0f32; self.values.len()];
        let mut sigma = 0.0;
        for _ in 0..ROUNDS {
            self.subtract_shade(&paper, reach(shade_mm), &mut rest);
            sigma = deviation(&rest, &paper);
            let dark = -INK * sigma;
            for ((paper, &on_sheet), &rest) in paper.iter_mut().zip(&on_sheet).zip(&rest) {
                *paper = on_sheet && f64::from(rest) >= dark;
            }
        }
        let paper = self.shrunk(&paper, reach(EDGE_MM));
        self.subtract_shade(&paper, reach(shade_mm), &mut rest);
        let scale = if sigma > 0.0 { 1.0 / sigma } else { 0.0 };
        for (rest, &paper) in rest.iter_mut().zip(&paper) {
            let clipped = (f64::from(*rest) * scale).clamp(-CLIP, CLIP);
            *rest = if paper { clipped as f32 } else { 0.0 };
        }
        Cleaned {
            width: self.width,
            height: self.height,
            mm_per_pixel: self.mm_per_pixel,
            values: rest,
            paper,
        }
    }

    /// Each value less the mean of the paper in the square around it.
    fn subtract_shade(&self, paper: &[bool], reach: usize, rest: &mut [f32]) {
        let sums = Sums::new(self.width, self.height, |i| {
            if paper[i] {
                (f64::from(self.values[i]), 1.0)
            } else {
                (0.0, 0.0)
            }
        });
        for row in 0..self.height {
            for column in 0..self.width {
                let i = row * self.width + column;
                let (sum, known) = sums.around(column, row, reach);
                let shade = if known > 0.0 {
                    sum / known
                } else {
                    f64::from(self.values[i])
                };
                let value = f64::from(self.values[i]) - shade;
                rest[i] = if value.is_finite() { value as f32 } else { 0.0 };
            }
        }
    }

    /// Paper that has nothing but paper within `reach` pixels.
    fn shrunk(&self, paper: &[bool], reach: usize) -> Vec<bool> {
        let sums = Sums::new(self.width, self.height, |i| {
            (f64::from(u8::from(!paper[i])), 0.0)
        });
        (0..paper.len())
            .map(|i| sums.around(i % self.width, i / self.width, reach).0 < 0.5)
            .collect()
    }
}

/// An area that shows the paper's structure only.
pub(super) struct Cleaned {
    pub width: usize,
    pub height: usize,
    pub mm_per_pixel: f64,
    /// Structure in standard deviations of the noise; 0 where `paper` is false.
    pub values: Vec<f32>,
    /// Where there is bare paper.
    pub paper: Vec<bool>,
}

impl Cleaned {
    /// Share of the area that is bare paper.
    pub fn bare(&self) -> f64 {
        self.paper.iter().filter(|&&p| p).count() as f64 / self.paper.len() as f64
    }

    /// The pattern of what was left out, as if it were paper's structure.
    pub fn gaps(&self, shade_mm: f64) -> Self {
        let pattern = Raster {
            width: self.width,
            height: self.height,
            values: self.paper.iter().map(|&p| f32::from(u8::from(p))).collect(),
            mm_per_pixel: self.mm_per_pixel,
        };
        let everywhere = vec![true; self.paper.len()];
        let mut values = vec![0.0; self.paper.len()];
        let reach = (shade_mm / self.mm_per_pixel)
            .ceil()
            .min(self.paper.len() as f64) as usize;
        pattern.subtract_shade(&everywhere, reach, &mut values);
        Self {
            width: self.width,
            height: self.height,
            mm_per_pixel: self.mm_per_pixel,
            values,
            paper: everywhere,
        }
    }
}

/// Standard deviation of the values on paper by their median absolute deviation, so that ink
/// that is still there does not count: 1.4826 MAD for normal noise.
fn deviation(values: &[f32], paper: &[bool]) -> f64 {
    // A stride that is odd does not keep step with the rows of most areas.
    let stride = (values.len() / NOISE_SAMPLES) | 1;
    let mut sizes: Vec<f32> = values
        .iter()
        .zip(paper)
        .step_by(stride)
        .filter_map(|(v, &p)| p.then_some(v.abs()))
        .collect();
    if sizes.is_empty() {
        return 0.0;
    }
    let middle = sizes.len() / 2;
    let (_, &mut median, _) = sizes.select_nth_unstable_by(middle, f32::total_cmp);
    1.4826 * f64::from(median)
}

/// Sums over any upright rectangle in constant time (F. C. Crow, *SIGGRAPH* 1984, 207), of a value
/// and its weight.
struct Sums {
    width: usize,
    height: usize,
    table: Vec<(f64, f64)>,
}

impl Sums {
    fn new(width: usize, height: usize, value: impl Fn(usize) -> (f64, f64)) -> Self {
        let mut table = vec![(0.0, 0.0); (width + 1) * (height + 1)];
        for row in 0..height {
            let mut line = (0.0, 0.0);
            for column in 0..width {
                let (sum, weight) = value(row * width + column);
                line = (line.0 + sum, line.1 + weight);
                let above = table[row * (width + 1) + column + 1];
                table[(row + 1) * (width + 1) + column + 1] = (above.0 + line.0, above.1 + line.1);
            }
        }
        Self {
            width,
            height,
            table,
        }
    }

    /// Over the square of `reach` pixels each way, as far as it lies in the area.
    fn around(&self, column: usize, row: usize, reach: usize) -> (f64, f64) {
        let (left, right) = (
            column.saturating_sub(reach),
            (column + reach + 1).min(self.width),
        );
        let (top, bottom) = (
            row.saturating_sub(reach),
            (row + reach + 1).min(self.height),
        );
        let at = |x: usize, y: usize| self.table[y * (self.width + 1) + x];
        let (a, b, c, d) = (
            at(right, bottom),
            at(left, bottom),
            at(right, top),
            at(left, top),
        );
        (a.0 - b.0 - c.0 + d.0, a.1 - b.1 - c.1 + d.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raster(width: usize, height: usize, value: impl Fn(usize, usize) -> f32) -> Raster {
        let values = (0..width * height)
            .map(|i| value(i % width, i / width))
            .collect();
        Raster::new(width, height, values, 0.1).unwrap()
    }

    #[test]
    fn ink_and_shades_are_taken_out() {
        let wave = |x: usize| 0.02 * (x as f32 * 0.6).cos();
        let ink = |x: usize, y: usize| x % 90 < 5 && y % 70 < 40;
        let page = raster(300, 280, |x, y| {
            (0.5 + 0.001 * y as f32 + wave(x)) * if ink(x, y) { 0.3 } else { 1.0 }
        });
        let cleaned = page.cleaned(3.0);
        for y in (0..280).step_by(7) {
            for x in 0..300 {
                let i = y * 300 + x;
                assert!(!(ink(x, y) && cleaned.paper[i]), "{x} {y}");
            }
        }
        assert!((0.7..0.98).contains(&cleaned.bare()));
        // The shade is gone and the wave is left.
        let mean = cleaned.values.iter().sum::<f32>() / 84000.0;
        assert!(mean.abs() < 0.02, "{mean}");
        let power = cleaned.values.iter().map(|v| v * v).sum::<f32>() / 84000.0;
        assert!((0.3..1.2).contains(&power), "{power}");
    }

    #[test]
    fn coarser_pixels_are_means() {
        let page = raster(7, 5, |x, y| {
            if (x, y) == (0, 0) {
                f32::NAN
            } else {
                (x + 10 * y) as f32
            }
        });
        let coarse = page.coarser(0.25);
        assert_eq!((coarse.width, coarse.height), (3, 2));
        assert!((coarse.mm_per_pixel - 0.2).abs() < 1e-12);
        assert!((coarse.values[0] - 22.0 / 3.0).abs() < 1e-5);
        assert!((coarse.values[1] - 7.5).abs() < 1e-5);
        assert_eq!(page.coarser(0.01).width, 7);
    }

    #[test]
    fn odd_areas_are_refused_or_survive() {
        assert!(Raster::new(2, 2, vec![0.0; 3], 0.1).is_err());
        assert!(Raster::new(0, 2, vec![], 0.1).is_err());
        assert!(Raster::new(usize::MAX, usize::MAX, vec![0.0; 3], 0.1).is_err());
        for mm in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Raster::new(1, 1, vec![0.0], mm).is_err());
        }
        for value in [0.5, f32::NAN, f32::INFINITY, f32::MAX] {
            let cleaned = raster(1, 1, |_, _| value).coarser(1.0).cleaned(3.0);
            assert_eq!(cleaned.values, [0.0]);
            let cleaned = raster(9, 4, |x, _| if x > 3 { -value } else { value }).cleaned(3.0);
            assert!(cleaned.values.iter().all(|v| v.is_finite()));
        }
    }
}
