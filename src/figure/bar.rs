//! A scale bar on a print.

use plotters::{
    prelude::*,
    style::text_anchor::{HPos, Pos, VPos},
};

use super::{FigureError, scale::Scale};
use crate::{
    colour,
    develop::Print,
    lettering::{FACE, fault, register},
    measure::{MeasureError, scale_bar},
};

/// Least size in pixels of a picture that has room for a bar with its words.
pub const LEAST_PX: [u32; 2] = [320, 180];
/// The longest bar as a share of the picture's width.
const LONGEST: f64 = 0.25;
/// Most of the picture's width that a letter's height may be: the longest words must fit.
const TEXT_OF_WIDTH: f64 = 0.03;
/// Linear light of the bar and its words, and of their ground with how much that covers: as the
/// legend has them.
const INK: [u8; 3] = [235, 232, 224];
const GROUND: RGBColor = RGBColor(13, 13, 13);
const COVER: f64 = 0.85;

/// A bar that lies on a print.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    pub mm: f64,
    /// Its length in pixels, to the fraction that its last pixel shows.
    pub px: f64,
    /// Where it begins, and its first row.
    pub left: u32,
    pub top: u32,
    /// How many rows it has.
    pub rows: u32,
}

/// The length of the bar in mm and in pixels, of a picture `width` pixels wide.
///
/// # Errors
/// A scale that no bar can show.
pub fn length(scale: &Scale, width: u32) -> Result<(f64, f64), MeasureError> {
    scale_bar(scale.mm_per_px, LONGEST * f64::from(width))
}

/// Lays a bar onto `print`, at the bottom left, or at the top left where `taken` (column and row)
/// says that something lies there. `text_px` is the height of the letters of `face`, a TrueType
/// file.
///
/// # Errors
/// A face that cannot be read, or a scale that no bar can show.
pub fn lay(
    print: &mut Print,
    scale: &Scale,
    text_px: f64,
    face: Vec<u8>,
    taken: impl Fn(u32, u32) -> bool,
) -> Result<Bar, FigureError> {
    let [width, height] = [print.width, print.height];
    let (mm, px) = length(scale, width).map_err(|error| FigureError::Picture(Box::new(error)))?;
    register(face);
    let text_px = text_px.min(TEXT_OF_WIDTH * f64::from(width)).round();
    let ink = RGBColor(INK[0], INK[1], INK[2]);
    let style = TextStyle::from((FACE, text_px).into_font())
        .color(&ink)
        .pos(Pos::new(HPos::Left, VPos::Top));
    let mut lines = vec![format!("{mm} mm")];
    lines.extend(scale.words().into_iter().map(str::to_owned));
    let mut text_width = 0;
    for line in &lines {
        let (wide, _) = style.font.box_size(line).map_err(fault)?;
        text_width = text_width.max(wide);
    }

    let margin = text_px as u32;
    let pad = (0.7 * text_px) as u32;
    let rows = ((0.25 * text_px).round() as u32).max(2);
    let line_height = (1.3 * text_px).round() as u32;
    let block = [
        (px.ceil() as u32).max(text_width) + 2 * pad,
        rows + pad / 2 + line_height * lines.len() as u32 + 2 * pad,
    ];
    let bottom = height.saturating_sub(margin + block[1]);
    let is_taken = |top: u32| {
        let columns = margin..(margin + block[0]).min(width);
        (top..(top + block[1]).min(height)).any(|y| columns.clone().any(|x| taken(x, y)))
    };
    let top = if is_taken(bottom) && !is_taken(margin) {
        margin
    } else {
        bottom
    };
    let bar = Bar {
        mm,
        px,
        left: margin + pad,
        top: top + pad,
        rows,
    };
    {
        let bytes = print.pixels.as_flattened_mut();
        let area = BitMapBackend::with_buffer(bytes, (width, height)).into_drawing_area();
        let [left, top] = [margin as i32, top as i32];
        let right = left + block[0] as i32;
        let ground = Rectangle::new(
            [(left, top), (right, top + block[1] as i32)],
            GROUND.mix(COVER).filled(),
        );
        area.draw(&ground).map_err(fault)?;
        for (i, line) in lines.iter().enumerate() {
            let down = rows + pad / 2 + line_height * i as u32;
            let at = (bar.left as i32, (bar.top + down) as i32);
            area.draw_text(line, &style, at).map_err(fault)?;
        }
        area.present().map_err(fault)?;
    }
    draw(print, &bar);
    Ok(bar)
}

/// The bar itself, to the fraction of its last pixel in linear light.
fn draw(print: &mut Print, bar: &Bar) {
    let ink = colour::linear_from_srgb8(INK);
    for row in bar.top..(bar.top + bar.rows).min(print.height) {
        for column in 0..bar.px.ceil() as u32 {
            let x = bar.left + column;
            if x >= print.width {
                break;
            }
            let cover = (bar.px - f64::from(column)).min(1.0);
            let at = row as usize * print.width as usize + x as usize;
            let under = colour::linear_from_srgb8(print.pixels[at]);
            let mixed = std::array::from_fn(|c| under[c] + (ink[c] - under[c]) * cover);
            print.pixels[at] = colour::srgb8_from_linear(mixed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::scale::Holds;

    fn scale(mm_per_px: f64) -> Scale {
        Scale {
            mm_per_px,
            holds: Holds::AtTheCentre,
            outside_the_loupe: true,
        }
    }

    fn white(width: u32, height: u32) -> Print {
        Print {
            width,
            height,
            pixels: vec![[255; 3]; width as usize * height as usize],
        }
    }

    #[test]
    fn a_bar_is_as_long_as_it_says_and_keeps_off_the_legend() {
        let face = crate::stage::legend::face();
        for (size, mm_per_px) in [
            ([320, 180], 0.9),
            ([1280, 720], 0.0613),
            ([320, 4000], 12.0),
        ] {
            let mut print = white(size[0], size[1]);
            let bar = lay(&mut print, &scale(mm_per_px), 40.0, face.clone(), |_, _| {
                false
            })
            .unwrap();
            assert!((bar.px * mm_per_px - bar.mm).abs() < 1e-9);
            let start = (bar.top * size[0]) as usize;
            let row = &print.pixels[start..start + size[0] as usize];
            let ink = |pixel: &[u8; 3]| colour::linear_from_srgb8(*pixel)[0];
            let [ground, full] = [
                ink(&row[bar.left as usize - 1]),
                ink(&row[bar.left as usize]),
            ];
            let reach = bar.left as usize..(bar.left as usize + bar.px.ceil() as usize);
            let found: f64 = row[reach]
                .iter()
                .map(|p| (ink(p) - ground) / (full - ground))
                .sum();
            assert!(
                (found - bar.px).abs() < 0.02,
                "{size:?}: {found} of {}",
                bar.px
            );
            // Everything stays within the picture: its edge is as it was.
            assert!(
                print
                    .pixels
                    .chunks_exact(size[0] as usize)
                    .all(|row| row[row.len() - 1] == [255; 3])
            );

            let half = size[1] / 2;
            let above = lay(
                &mut white(size[0], size[1]),
                &scale(mm_per_px),
                40.0,
                face.clone(),
                |_, y| y > half,
            )
            .unwrap();
            assert!(above.top < half && bar.top > half);
        }
    }

    #[test]
    fn a_scale_without_an_end_has_no_bar() {
        for mm_per_px in [0.0, f64::NAN, f64::INFINITY] {
            let mut print = white(320, 180);
            assert!(
                lay(&mut print, &scale(mm_per_px), 12.0, Vec::new(), |_, _| {
                    false
                })
                .is_err()
            );
            assert_eq!(print, white(320, 180));
        }
    }
}
