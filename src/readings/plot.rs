//! A profile as a picture, with mm along the line and µm up.

use plotters::prelude::*;

use super::Sample;
pub use crate::lettering::PlotError;
use crate::lettering::{FAINT, INK, fault, register, text};

/// Width and height of the picture in pixels.
pub const SIZE: [u32; 2] = [1280, 560];
const RELIEF: RGBColor = RGBColor(0, 92, 168);
/// How much of the height of the plot is left above and below the relief.
const ROOM: f64 = 0.08;
/// Least height that the axis spans, in µm: a level profile is a line and not noise.
const LEAST_UM: f64 = 1.0;

/// What is written on a plot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Labels<'l> {
    /// Above it; none where it is empty.
    pub title: &'l str,
    pub along: &'l str,
    pub up: &'l str,
    /// What separates decimals.
    pub separator: char,
}

impl<'l> Labels<'l> {
    /// For a file.
    pub fn english(title: &'l str) -> Self {
        Self {
            title,
            along: "mm along the line",
            up: "height in µm, towards the viewer",
            separator: '.',
        }
    }
}

/// Draws a profile under its title with the letters of `face`, a TrueType file: rows of RGB pixels of
/// [`SIZE`]. The band around the line is one standard uncertainty each way.
///
/// # Errors
/// [`PlotError`] where the face cannot be read.
pub fn pixels(
    labels: &Labels,
    samples: &[Sample],
    face: Vec<u8>,
) -> Result<Vec<[u8; 3]>, PlotError> {
    register(face);
    let [width, height] = SIZE;
    let mut bytes = vec![255; (width * height * 3) as usize];
    {
        let area = BitMapBackend::with_buffer(&mut bytes, (width, height)).into_drawing_area();
        draw(labels, samples, &area)?;
        area.present().map_err(fault)?;
    }
    Ok(bytes.as_chunks::<3>().0.to_vec())
}

/// A round number on an axis, without the noise of its last digits.
fn mark(value: f64, separator: char) -> String {
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    let text = if text == "-0" { "0" } else { text };
    text.replace('.', separator.encode_utf8(&mut [0; 4]))
}

fn draw(
    labels: &Labels,
    samples: &[Sample],
    area: &DrawingArea<BitMapBackend<'_>, plotters::coord::Shift>,
) -> Result<(), PlotError> {
    area.fill(&WHITE).map_err(fault)?;
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for sample in samples {
        low = low.min(sample.z_um - sample.sigma_um);
        high = high.max(sample.z_um + sample.sigma_um);
    }
    let length = samples.last().map_or(1.0, |sample| sample.s_mm).max(1e-9);
    if low > high {
        (low, high) = (0.0, 0.0);
    }
    let lacking = (LEAST_UM - (high - low)).max(0.0) / 2.0;
    let room = lacking + ROOM * (high - low);
    let mut chart = ChartBuilder::on(area);
    if !labels.title.is_empty() {
        chart.caption(labels.title, text(20.0, &INK));
    }
    let mut chart = chart
        .margin(20)
        .margin_right(36)
        .x_label_area_size(58)
        .y_label_area_size(84)
        .build_cartesian_2d(0.0..length, low - room..high + room)
        .map_err(fault)?;
    let mark = |value: &f64| mark(*value, labels.separator);
    chart
        .configure_mesh()
        .x_label_formatter(&mark)
        .y_label_formatter(&mark)
        .x_desc(labels.along)
        .y_desc(labels.up)
        .axis_desc_style(text(20.0, &INK))
        .label_style(text(18.0, &INK))
        .light_line_style(WHITE)
        .bold_line_style(FAINT.mix(0.35))
        .axis_style(INK)
        .draw()
        .map_err(fault)?;
    let edge = |sign: f64| {
        let at = move |sample: &Sample| (sample.s_mm, sample.z_um + sign * sample.sigma_um);
        samples.iter().map(at)
    };
    let band: Vec<(f64, f64)> = edge(1.0).chain(edge(-1.0).rev()).collect();
    let band = Polygon::new(band, RELIEF.mix(0.18));
    chart.draw_series([band]).map_err(fault)?;
    let line = LineSeries::new(edge(0.0), RELIEF.stroke_width(2));
    chart.draw_series(line).map_err(fault)?;
    Ok(())
}
