//! From light to what a display shows: exposure level, legend, clamping and the sRGB encoding,
//! exactly and on the CPU, so that the same light gives the same bytes everywhere.

use std::sync::LazyLock;

use rayon::prelude::*;

use crate::colour;

/// Pixels between the pictures of a contact sheet, and around them.
const GAP_PX: u32 = 16;
/// The ground of a contact sheet, 8-bit sRGB: a dark neutral grey, as in a viewing booth.
const GROUND: [u8; 3] = [48; 3];

static LINEAR_FROM_BYTE: LazyLock<[f64; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| colour::srgb_decode(byte as f64 / 255.0)));

/// A picture as a display shows it: 8-bit sRGB, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Print {
    pub width: u32,
    pub height: u32,
    pub pixels: Vec<[u8; 3]>,
}

impl Print {
    /// Develops `pixels`, linear sRGB relative to a perfect diffuser, which is shown at the
    /// linear display `level`. `legend`, premultiplied linear RGBA of the display, lies over
    /// it; it is empty or has as many pixels. Not dithered; NaN becomes black.
    pub fn develop(
        width: u32,
        height: u32,
        pixels: &[[f32; 3]],
        legend: &[[f32; 4]],
        level: f64,
    ) -> Self {
        const CLEAR: [f32; 4] = [0.0; 4];
        let develop = |(at, light): (usize, &[f32; 3])| {
            let [r, g, b, cover] = legend.get(at).unwrap_or(&CLEAR).map(f64::from);
            let over = [r, g, b];
            colour::srgb8_from_linear(std::array::from_fn(|c| {
                f64::from(light[c]) * level * (1.0 - cover) + over[c]
            }))
        };
        Self {
            width,
            height,
            pixels: pixels.par_iter().enumerate().map(develop).collect(),
        }
    }

    /// The picture at `width` pixels, or as it is if it is not wider: the mean of the light of
    /// the pixels that fall into each.
    pub fn reduced(&self, width: u32) -> Self {
        let width = width.max(1);
        if width >= self.width {
            return self.clone();
        }
        let exact = f64::from(self.height) * f64::from(width) / f64::from(self.width);
        let height = (exact.round() as u32).max(1);
        let pixel = |at: u32| {
            let (x, y) = (at % width, at / width);
            let (left, right) = span(x, width, self.width);
            let (top, bottom) = span(y, height, self.height);
            let mut sum = [0.0; 3];
            for row in top..bottom {
                let row = row as usize * self.width as usize;
                for pixel in &self.pixels[row + left as usize..row + right as usize] {
                    for (sum, byte) in sum.iter_mut().zip(pixel) {
                        *sum += LINEAR_FROM_BYTE[usize::from(*byte)];
                    }
                }
            }
            let count = f64::from((right - left) * (bottom - top));
            colour::srgb8_from_linear(sum.map(|sum| sum / count))
        };
        Self {
            width,
            height,
            pixels: (0..width * height).into_par_iter().map(pixel).collect(),
        }
    }
}

/// The source pixels that fall into one of `count`, at least one.
fn span(at: u32, count: u32, source: u32) -> (u32, u32) {
    let edge = |at: u32| (u64::from(at) * u64::from(source) / u64::from(count)) as u32;
    let first = edge(at).min(source - 1);
    (first, edge(at + 1).clamp(first + 1, source))
}

/// Pictures of one size side by side, in rows that make about a square of them. `None` if there
/// are none.
pub fn contact_sheet(prints: &[Print]) -> Option<Print> {
    let first = prints.first()?;
    let count = prints.len() as u32;
    let columns = (f64::from(count).sqrt().ceil() as u32).max(1);
    let rows = count.div_ceil(columns);
    let [step_x, step_y] = [first.width + GAP_PX, first.height + GAP_PX];
    let [width, height] = [columns * step_x + GAP_PX, rows * step_y + GAP_PX];
    let mut pixels = vec![GROUND; width as usize * height as usize];
    for (at, print) in (0..).zip(prints) {
        let (left, top) = (
            at % columns * step_x + GAP_PX,
            at / columns * step_y + GAP_PX,
        );
        let rows = print.pixels.chunks_exact(print.width as usize);
        for (y, row) in (top..).zip(rows) {
            let start = y as usize * width as usize + left as usize;
            pixels[start..start + row.len()].copy_from_slice(row);
        }
    }
    Some(Print {
        width,
        height,
        pixels,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_is_scaled_covered_clamped_and_encoded() {
        let pixels = [[0.5, 1.0, 4.0], [1.0, 1.0, 1.0], [f32::NAN, -1.0, 0.0]];
        let print = Print::develop(3, 1, &pixels, &[], 0.5);
        let encoded = |linear: f64| (colour::srgb_encode(linear) * 255.0).round() as u8;
        assert_eq!(print.pixels[0], [encoded(0.25), encoded(0.5), 255]);
        assert_eq!(print.pixels[2], [0; 3]);
        let legend = [[0.0; 4], [0.0, 0.1, 0.25, 0.5], [0.2, 0.0, 0.0, 1.0]];
        let covered = Print::develop(3, 1, &pixels, &legend, 0.5);
        assert_eq!(covered.pixels[0], print.pixels[0]);
        // The level is the exposure's, the legend is the display's own.
        assert_eq!(
            covered.pixels[1],
            [encoded(0.25), encoded(0.35), encoded(0.5)]
        );
    }

    #[test]
    fn pictures_are_reduced_in_linear_light() {
        let print = Print {
            width: 2,
            height: 2,
            pixels: vec![[0; 3], [255; 3], [255; 3], [0; 3]],
        };
        let grey = colour::srgb8_from_linear([0.5; 3]);
        let reduced = print.reduced(1);
        assert_eq!((reduced.width, reduced.height), (1, 1));
        assert_eq!(reduced.pixels, [grey]);
        assert_eq!(print.reduced(2), print);
        assert_eq!(print.reduced(9), print);
    }

    #[test]
    fn every_source_pixel_falls_into_one_span() {
        for (count, source) in [(3, 7), (7, 7), (1, 5)] {
            let spans: Vec<_> = (0..count).map(|at| span(at, count, source)).collect();
            assert_eq!((spans[0].0, spans[spans.len() - 1].1), (0, source));
            assert!(spans.windows(2).all(|pair| pair[0].1 == pair[1].0));
        }
    }

    #[test]
    fn a_contact_sheet_has_every_picture() {
        let print = |value: u8| Print {
            width: 3,
            height: 2,
            pixels: vec![[value; 3]; 6],
        };
        assert_eq!(contact_sheet(&[]), None);
        let sheet = contact_sheet(&[print(1), print(2), print(3)]).unwrap();
        assert_eq!(
            (sheet.width, sheet.height),
            (2 * 3 + 3 * GAP_PX, 2 * 2 + 3 * GAP_PX)
        );
        for value in 1..=3 {
            let found = sheet.pixels.iter().filter(|pixel| **pixel == [value; 3]);
            assert_eq!(found.count(), 6);
        }
    }
}
