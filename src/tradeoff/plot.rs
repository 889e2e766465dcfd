//! Error against cost, as a picture: every tier, the Pareto front, the reference's own noise.

use plotters::{
    coord::Shift,
    prelude::*,
    style::text_anchor::{HPos, Pos, VPos},
};

use super::{choice::LADDER, table::Table};
pub use crate::lettering::PlotError;
use crate::{
    lettering::{FAINT, INK, fault, register, text},
    optics::tier::Tier,
};

/// Width and height of the picture in pixels.
pub const SIZE: [u32; 2] = [1280, 860];
const LADDER_COLOUR: RGBColor = RGBColor(0, 92, 168);
const BASELINE_COLOUR: RGBColor = RGBColor(176, 96, 16);
const FRONT_COLOUR: RGBColor = RGBColor(196, 30, 58);
const LABEL_PX: f64 = 19.0;
/// Width of a letter over its height, for labels that keep clear of each other.
const LETTER: f64 = 0.56;

/// A tier over all subjects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    pub tier: Tier,
    /// Geometric mean of the cost ratios.
    pub cost: f64,
    /// Mean of the mean ΔE00, and of the 95th percentiles.
    pub mean: f64,
    pub p95: f64,
}

/// The tiers of a table that have costs.
pub fn points(table: &Table) -> Vec<Point> {
    Tier::ALL
        .into_iter()
        .filter_map(|tier| {
            let rows: Vec<_> = table
                .rows
                .iter()
                .filter(|row| row.tier == Some(tier))
                .filter_map(|row| Some((row.cost?.ratio, row.errors)))
                .collect();
            let count = rows.len() as f64;
            (!rows.is_empty()).then(|| Point {
                tier,
                cost: (rows
                    .iter()
                    .map(|(cost, _)| cost.max(1e-6).ln())
                    .sum::<f64>()
                    / count)
                    .exp(),
                mean: rows.iter().map(|(_, errors)| errors.mean).sum::<f64>() / count,
                p95: rows.iter().map(|(_, errors)| errors.p95).sum::<f64>() / count,
            })
        })
        .collect()
}

/// Those of which none other is both cheaper and nearer, from the cheapest.
pub fn front(points: &[Point]) -> Vec<Point> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.cost.total_cmp(&b.cost).then(a.mean.total_cmp(&b.mean)));
    let mut front: Vec<Point> = Vec::new();
    for point in sorted {
        if front.last().is_none_or(|last| point.mean < last.mean) {
            front.push(point);
        }
    }
    front
}

/// Draws `table` with the letters of `face`, a TrueType file: rows of RGB pixels of [`SIZE`].
///
/// # Errors
/// [`PlotError`] where the face cannot be read.
pub fn pixels(table: &Table, face: Vec<u8>) -> Result<Vec<[u8; 3]>, PlotError> {
    register(face);
    let [width, height] = SIZE;
    let mut bytes = vec![255; (width * height * 3) as usize];
    {
        let backend = BitMapBackend::with_buffer(&mut bytes, (width, height));
        let area = backend.into_drawing_area();
        draw(table, &area)?;
        area.present().map_err(fault)?;
    }
    Ok(bytes.as_chunks::<3>().0.to_vec())
}

/// The same as SVG.
///
/// # Errors
/// As [`pixels`].
pub fn svg(table: &Table, face: Vec<u8>) -> Result<String, PlotError> {
    register(face);
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (SIZE[0], SIZE[1])).into_drawing_area();
        draw(table, &area)?;
        area.present().map_err(fault)?;
    }
    Ok(text)
}

/// Powers of ten times these are marked where an axis spans a decade or less, and where it spans
/// more.
const CLOSE: &[f64] = &[1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];
const WIDE: &[f64] = &[1.0, 2.0, 5.0, 10.0];

/// The round numbers in a range.
fn marks(range: &std::ops::Range<f64>) -> Vec<f64> {
    let steps = if range.end / range.start < 10.0 {
        CLOSE
    } else {
        WIDE
    };
    let decades = range.start.log10().floor() as i32..=range.end.log10().floor() as i32;
    let mut marks: Vec<f64> = decades
        .flat_map(|decade| {
            // Ten to a negative power is not exact; one over its inverse is.
            let at = move |step: f64| match decade {
                0.. => step * 10f64.powi(decade),
                _ => step / 10f64.powi(-decade),
            };
            steps.iter().map(move |step| at(*step))
        })
        .filter(|mark| range.contains(mark))
        .collect();
    marks.dedup();
    marks
}

fn range(values: impl Iterator<Item = f64>, room: f64) -> std::ops::Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, 0.0f64), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if low > high {
        return 0.1..10.0;
    }
    low / room..high * room
}

fn draw<B: DrawingBackend>(table: &Table, area: &DrawingArea<B, Shift>) -> Result<(), PlotError>
where
    B::ErrorType: 'static,
{
    let points = points(table);
    let judge: Vec<f64> = table
        .rows
        .iter()
        .filter(|row| row.tier.is_none())
        .map(|row| row.errors.mean)
        .collect();
    let noise = judge.iter().sum::<f64>() / judge.len().max(1) as f64;
    let noise = (noise > 0.0).then_some(noise);
    area.fill(&WHITE).map_err(fault)?;
    let x_range = range(points.iter().map(|point| point.cost), 1.25);
    let errors = points.iter().flat_map(|point| [point.mean, point.p95]);
    let y_range = range(errors.chain(noise), 1.3);
    let mut chart = ChartBuilder::on(area)
        .caption("Error of each tier against what it costs", text(30.0, &INK))
        .margin(20)
        .x_label_area_size(58)
        .y_label_area_size(76)
        .build_cartesian_2d(x_range.clone().log_scale(), y_range.clone().log_scale())
        .map_err(fault)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .disable_axes()
        .draw()
        .map_err(fault)?;
    // The library's own marks are at powers of ten only.
    for x in marks(&x_range) {
        let line = [(x, y_range.start), (x, y_range.end)];
        let series = LineSeries::new(line, FAINT.mix(0.35));
        chart.draw_series(series).map_err(fault)?;
        let (at, bottom) = chart.backend_coord(&(x, y_range.start));
        let style = text(18.0, &INK).pos(Pos::new(HPos::Center, VPos::Top));
        area.draw_text(&format!("{x}×"), &style, (at, bottom + 6))
            .map_err(fault)?;
    }
    for y in marks(&y_range) {
        let line = [(x_range.start, y), (x_range.end, y)];
        let series = LineSeries::new(line, FAINT.mix(0.35));
        chart.draw_series(series).map_err(fault)?;
        let (left, at) = chart.backend_coord(&(x_range.start, y));
        let style = text(18.0, &INK).pos(Pos::new(HPos::Right, VPos::Center));
        area.draw_text(&format!("{y}"), &style, (left - 8, at))
            .map_err(fault)?;
    }
    let under = text(20.0, &INK).pos(Pos::new(HPos::Center, VPos::Bottom));
    let [width, height] = SIZE.map(|side| side as i32);
    let axis = "cost of a shaded pixel over the floor, geometric mean over the subjects";
    area.draw_text(axis, &under, (width / 2, height - 10))
        .map_err(fault)?;
    let along = text(20.0, &INK)
        .transform(FontTransform::Rotate270)
        .pos(Pos::new(HPos::Center, VPos::Top));
    area.draw_text("ΔE00 against the reference", &along, (14, height / 2))
        .map_err(fault)?;

    if let Some(noise) = noise {
        let line = [(x_range.start, noise), (x_range.end, noise)];
        let series = DashedLineSeries::new(line, 8, 6, INK.stroke_width(1));
        chart.draw_series(series).map_err(fault)?;
        let (right, at) = chart.backend_coord(&(x_range.end, noise));
        let style = text(17.0, &INK).pos(Pos::new(HPos::Right, VPos::Bottom));
        area.draw_text("reference: its own noise", &style, (right - 6, at - 3))
            .map_err(fault)?;
    }
    let front = front(&points);
    // From one tier to the next the error falls where the dearer one is paid for.
    let mut steps: Vec<(f64, f64)> = Vec::new();
    for point in &front {
        if let Some(&(_, before)) = steps.last() {
            steps.push((point.cost, before));
        }
        steps.push((point.cost, point.mean));
    }
    // Labels keep off the front, and off the legend.
    let mut taken = Vec::new();
    for pair in steps.windows(2) {
        let (x_0, y_0) = chart.backend_coord(&pair[0]);
        let (x_1, y_1) = chart.backend_coord(&pair[1]);
        taken.push(Rectangle {
            left: x_0.min(x_1) - 2,
            top: y_0.min(y_1) - 2,
            right: x_0.max(x_1) + 2,
            bottom: y_0.max(y_1) + 2,
        });
    }
    let line = LineSeries::new(steps, FRONT_COLOUR.stroke_width(2));
    chart.draw_series(line).map_err(fault)?;
    for point in &points {
        let colour = colour(point.tier);
        let whisker = [(point.cost, point.mean), (point.cost, point.p95)];
        let series = LineSeries::new(whisker, colour.mix(0.35).stroke_width(2));
        chart.draw_series(series).map_err(fault)?;
        let dot = Circle::new((point.cost, point.mean), 6, colour.filled());
        chart.draw_series([dot]).map_err(fault)?;
        let (x, y) = chart.backend_coord(&(point.cost, point.mean));
        taken.push(Rectangle::around((x, y), 8));
        let (_, top) = chart.backend_coord(&(point.cost, point.p95));
        taken.push(Rectangle {
            left: x - 2,
            top,
            right: x + 2,
            bottom: y,
        });
    }
    let frame = Rectangle {
        left: chart.backend_coord(&(x_range.start, y_range.end)).0 + 4,
        top: chart.backend_coord(&(x_range.start, y_range.end)).1 + 4,
        right: chart.backend_coord(&(x_range.end, y_range.start)).0 - 4,
        bottom: chart.backend_coord(&(x_range.end, y_range.start)).1 - 4,
    };
    let key = (frame.right - 330, frame.top + 6);
    taken.push(Rectangle {
        left: key.0 - 40,
        top: key.1,
        right: frame.right,
        bottom: key.1 + 80,
    });
    for point in &points {
        let at = chart.backend_coord(&(point.cost, point.mean));
        let name = point.tier.name();
        let size = (
            (name.len() as f64 * LABEL_PX * LETTER).ceil() as i32,
            LABEL_PX.ceil() as i32,
        );
        let place = free_place(at, size, &frame, &taken);
        taken.push(place);
        let (x, y) = place.nearest(at);
        if (x - at.0).abs() + (y - at.1).abs() > 14 {
            let leader = PathElement::new(vec![at, (x, y)], FAINT.stroke_width(1));
            area.draw(&leader).map_err(fault)?;
        }
        let style = text(LABEL_PX, colour(point.tier)).pos(Pos::new(HPos::Left, VPos::Top));
        area.draw_text(name, &style, (place.left, place.top))
            .map_err(fault)?;
    }
    legend(area, key)
}

fn legend<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    (x, y): (i32, i32),
) -> Result<(), PlotError>
where
    B::ErrorType: 'static,
{
    let rows = [
        (
            LADDER_COLOUR,
            "tiers; dot: mean, line: to the 95th percentile",
        ),
        (BASELINE_COLOUR, "baselines from the literature"),
        (FRONT_COLOUR, "Pareto front of the means"),
    ];
    for (i, (colour, words)) in rows.into_iter().enumerate() {
        let y = y + 24 * i as i32;
        let line = PathElement::new(
            vec![(x - 34, y + 9), (x - 12, y + 9)],
            colour.stroke_width(3),
        );
        area.draw(&line).map_err(fault)?;
        let style = text(16.0, &INK).pos(Pos::new(HPos::Left, VPos::Top));
        area.draw_text(words, &style, (x, y)).map_err(fault)?;
    }
    Ok(())
}

fn colour(tier: Tier) -> &'static RGBColor {
    if LADDER.contains(&tier) {
        &LADDER_COLOUR
    } else {
        &BASELINE_COLOUR
    }
}

/// In pixels, y down.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Rectangle {
    left: i32,
    top: i32,
    right: i32,
    bottom: i32,
}

impl Rectangle {
    fn around((x, y): (i32, i32), radius: i32) -> Self {
        Self {
            left: x - radius,
            top: y - radius,
            right: x + radius,
            bottom: y + radius,
        }
    }

    fn meets(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    fn holds(&self, other: &Self) -> bool {
        self.left <= other.left
            && other.right <= self.right
            && self.top <= other.top
            && other.bottom <= self.bottom
    }

    fn nearest(&self, (x, y): (i32, i32)) -> (i32, i32) {
        (
            x.clamp(self.left, self.right),
            y.clamp(self.top, self.bottom),
        )
    }
}

/// Where a label of this size lies nearest to its point without covering anything.
fn free_place(
    (x, y): (i32, i32),
    (width, height): (i32, i32),
    frame: &Rectangle,
    taken: &[Rectangle],
) -> Rectangle {
    let place = |left: i32, top: i32| Rectangle {
        left,
        top,
        right: left + width,
        bottom: top + height,
    };
    let right = place(x + 11, y - height / 2);
    let candidates = (0..40).flat_map(|ring| {
        let away = 11 + 9 * ring;
        [
            place(x + away, y - height / 2),
            place(x - away - width, y - height / 2),
            place(x + away * 7 / 10, y - away * 7 / 10 - height),
            place(x + away * 7 / 10, y + away * 7 / 10),
            place(x - away * 7 / 10 - width, y - away * 7 / 10 - height),
            place(x - away * 7 / 10 - width, y + away * 7 / 10),
            place(x - width / 2, y + away),
            place(x - width / 2, y - away - height),
        ]
    });
    let free =
        |place: &Rectangle| frame.holds(place) && !taken.iter().any(|taken| taken.meets(place));
    candidates.into_iter().find(free).unwrap_or(right)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_has_no_point_that_another_beats() {
        let point = |tier, cost, mean| Point {
            tier,
            cost,
            mean,
            p95: mean,
        };
        let points = [
            point(Tier::Study, 2.6, 0.5),
            point(Tier::Lambert, 1.1, 3.0),
            point(Tier::Phong, 1.3, 4.0),
            point(Tier::Gallery, 1.5, 0.8),
            point(Tier::Draft, 1.1, 2.0),
            point(Tier::Isle, 2.0, 0.8),
        ];
        let tiers: Vec<Tier> = front(&points).iter().map(|point| point.tier).collect();
        assert_eq!(tiers, [Tier::Draft, Tier::Gallery, Tier::Study]);
    }

    #[test]
    fn labels_keep_clear_of_each_other() {
        let frame = Rectangle {
            left: 0,
            top: 0,
            right: 600,
            bottom: 400,
        };
        let mut taken = vec![Rectangle::around((300, 200), 8)];
        for _ in 0..12 {
            let place = free_place((300, 200), (90, 19), &frame, &taken);
            assert!(frame.holds(&place));
            assert!(!taken.iter().any(|taken| taken.meets(&place)), "{place:?}");
            taken.push(place);
        }
        // Nowhere is free: the place to its right, whatever lies there.
        let full = [frame];
        let forced = free_place((300, 200), (90, 19), &frame, &full);
        assert!(forced.meets(&frame));
    }

    #[test]
    fn marks_are_round() {
        assert_eq!(
            marks(&(0.04..30.0)),
            [0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0]
        );
        assert_eq!(marks(&(0.9..2.2)), [1.0, 1.2, 1.5, 2.0]);
    }
}
