//! Plots of a report, as SVG within its page: each a figure with a title, axes with units and a text
//! for those who do not see it. What is to be told apart differs in form too, not in colour alone,
//! so that it is in print, and for the colour-blind; colours are of Okabe and Ito's palette.
//!
//! Marks have their numbers as tooltips, and captions or tables have them as text.

use std::fmt::Write as _;

use super::escaped;
use crate::{
    colour::{format_hex, srgb8_from_linear},
    prepare::{
        LampFound,
        colour::{
            chart::{COLORCHECKER24, linear_from_lab_d50},
            correct::Fitted,
        },
        residuals::Residuals,
        stereo::left_out::RelitOne,
    },
};

const INK: &str = "#222";
const GRID: &str = "#bbb";
/// Blue.
const OURS: &str = "#0072b2";
/// Vermillion.
const OTHERS: &str = "#d55e00";
/// Letters, in units of the drawing, which are pixels of a page that is wide enough.
const LETTER: f64 = 12.0;
const SMALL: f64 = 10.0;
const TITLE: f64 = 15.0;

/// A drawing that is being written. Writing to a string does not fail.
struct Drawing(String);

impl Drawing {
    /// Of this width and height, with a title on top and a text that says what it shows.
    fn new([width, height]: [f64; 2], title: &str, told: &str) -> Self {
        let title = escaped(title);
        let mut drawing = Self(format!(
            "<figure><svg viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
             height=\"{height:.0}\" role=\"img\" aria-label=\"{title}. {}\">",
            escaped(told)
        ));
        drawing.text([width / 2.0, 20.0], "middle", TITLE, &title);
        drawing
    }

    /// Words from, around or up to (`start`, `middle`, `end`) a place on their base line.
    fn text(&mut self, [x, y]: [f64; 2], anchor: &str, size: f64, words: &str) {
        // A white rim keeps them legible on lines.
        let _ = write!(
            self.0,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" font-size=\"{size}\" \
             fill=\"{INK}\" stroke=\"#fff\" stroke-width=\"3\" paint-order=\"stroke\">{words}</text>"
        );
    }

    /// Words that run upwards, around a place.
    fn upwards(&mut self, [x, y]: [f64; 2], words: &str) {
        let _ = write!(
            self.0,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\" font-size=\"{LETTER}\" \
             fill=\"{INK}\" transform=\"rotate(-90 {x:.1} {y:.1})\">{words}</text>"
        );
    }

    fn line(&mut self, from: [f64; 2], to: [f64; 2], style: &str) {
        let _ = write!(
            self.0,
            "<line x1=\"{:.2}\" y1=\"{:.2}\" x2=\"{:.2}\" y2=\"{:.2}\" {style}/>",
            from[0], from[1], to[0], to[1]
        );
    }

    fn circle(&mut self, [x, y]: [f64; 2], radius: f64, style: &str, tip: &str) {
        let _ = write!(
            self.0,
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\" {style}>"
        );
        self.tip(tip);
        self.0 += "</circle>";
    }

    fn bar(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2], style: &str, tip: &str) {
        let _ = write!(
            self.0,
            "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" {style}>"
        );
        self.tip(tip);
        self.0 += "</rect>";
    }

    fn tip(&mut self, words: &str) {
        if !words.is_empty() {
            let _ = write!(self.0, "<title>{words}</title>");
        }
    }

    /// The whole figure.
    fn finish(self, caption: &str) -> String {
        format!(
            "{}</svg><figcaption>{caption}</figcaption></figure>",
            self.0
        )
    }
}

fn thin(colour: &str) -> String {
    format!("stroke=\"{colour}\" stroke-width=\"1\"")
}

/// Marks of an axis from 0 to `high` or a little beyond, up to six of them, and their decimals.
fn marks(high: f64) -> (Vec<f64>, usize) {
    const MOST: f64 = 6.0;
    let high = if high.is_finite() && high > 0.0 {
        high
    } else {
        1.0
    };
    let decade = 10f64.powf((high / MOST).log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * decade);
    let step = steps.into_iter().find(|step| high <= step * MOST);
    let step = step.unwrap_or(10.0 * decade);
    let count = (high / step - 1e-9).ceil().max(1.0) as usize;
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    ((0..=count).map(|i| i as f64 * step).collect(), decimals)
}

/// Lamps as seen from above, one for each photograph in their order: azimuth anticlockwise from the
/// right, elevation from 0° at the rim to 90° in the middle, areas in proportion to intensities.
pub fn lamps(lamps: &[LampFound]) -> String {
    const SIZE: [f64; 2] = [420.0, 430.0];
    const MIDDLE: [f64; 2] = [210.0, 228.0];
    const RADIUS: f64 = 160.0;
    let place = |azimuth_deg: f64, elevation_deg: f64| {
        let (sin, cos) = azimuth_deg.to_radians().sin_cos();
        let from_middle = RADIUS * (90.0 - elevation_deg) / 90.0;
        [MIDDLE[0] + from_middle * cos, MIDDLE[1] - from_middle * sin]
    };
    // Many are drawn smaller, to be told apart.
    let (letter, largest) = match lamps.len() {
        ..=24 => (LETTER, 9.0),
        25..=60 => (9.0, 6.0),
        _ => (7.0, 4.0),
    };
    let brightest = lamps.iter().filter_map(|lamp| lamp.intensity);
    let brightest = brightest.fold(0.0, f64::max);
    let known = brightest > 0.0 && lamps.iter().all(|lamp| lamp.intensity.is_some());
    let told = format!(
        "{} lamps by azimuth and elevation; their numbers are in the table beside.",
        lamps.len()
    );
    let mut drawing = Drawing::new(SIZE, "Lamps, seen from above", &told);
    // Where no lamp hides the marks of elevation.
    let from_lamps = |azimuth: f64| {
        let each = lamps.iter().map(|lamp| {
            let apart = (lamp.azimuth_deg - azimuth).rem_euclid(360.0);
            apart.min(360.0 - apart)
        });
        each.fold(f64::INFINITY, f64::min)
    };
    let between = (0..8).map(|i| 22.5 + 45.0 * f64::from(i));
    let free = between.max_by(|a, b| from_lamps(*a).total_cmp(&from_lamps(*b)));
    let free = free.unwrap_or(22.5);
    let no_fill = format!("fill=\"none\" {}", thin(GRID));
    for elevation in [0.0, 30.0, 60.0] {
        let radius = RADIUS * (90.0 - elevation) / 90.0;
        drawing.circle(MIDDLE, radius, &no_fill, "");
    }
    for azimuth in (0..360).step_by(45).map(f64::from) {
        drawing.line(MIDDLE, place(azimuth, 0.0), &thin(GRID));
    }
    for elevation in [0.0, 30.0, 60.0] {
        let at = place(free, elevation);
        drawing.text(at, "middle", SMALL, &format!("{elevation:.0}° up"));
    }
    for (azimuth, anchor, shift) in [
        (0.0, "start", [6.0, 4.0]),
        (90.0, "middle", [0.0, -6.0]),
        (180.0, "end", [-6.0, 4.0]),
        (270.0, "middle", [0.0, 16.0]),
    ] {
        let [x, y] = place(azimuth, 0.0);
        let words = format!("{azimuth:.0}°");
        drawing.text([x + shift[0], y + shift[1]], anchor, LETTER, &words);
    }
    for (i, lamp) in lamps.iter().enumerate() {
        let share = match lamp.intensity {
            Some(intensity) if known => (intensity / brightest).max(0.0),
            _ => 0.5,
        };
        let at = place(lamp.azimuth_deg, lamp.elevation_deg);
        let radius = largest * share.sqrt();
        let tip = format!(
            "Lamp {}: azimuth {:.1}°, elevation {:.1}°",
            i + 1,
            lamp.azimuth_deg,
            lamp.elevation_deg
        );
        drawing.circle(at, radius, &format!("fill=\"{OURS}\""), &tip);
    }
    for (i, lamp) in lamps.iter().enumerate() {
        let [x, y] = place(lamp.azimuth_deg, lamp.elevation_deg);
        let words = (i + 1).to_string();
        drawing.text([x, y - largest - 2.0], "middle", letter, &words);
    }
    drawing.finish(&format!(
        "Numbered as the photographs. Azimuth in degrees, anticlockwise from the right of the \
         photographs; elevation in degrees above the sheet, 0° at the rim and 90° in the middle. {}",
        match known {
            true => "The larger the area, the brighter the lamp.",
            false => "All alike: how bright they are, the grey card says.",
        }
    ))
}

/// How many places of a side are how far off: a histogram of [`Residuals`] with the `median` and
/// what 95 % of places stay within marked. Nothing where they are 0 everywhere, as with three lamps.
pub fn residuals(side: &str, residuals: &Residuals, [median, most]: [f64; 2]) -> String {
    const SIZE: [f64; 2] = [560.0, 300.0];
    const BOX: [f64; 4] = [64.0, 66.0, 540.0, 250.0];
    const BINS: f64 = 40.0;
    if residuals.quantile(1.0) <= 0.0 {
        return String::new();
    }
    let extent = residuals.quantile(0.995).max(1.2 * most).max(0.005);
    let width = (extent * 1000.0 / BINS).ceil().max(1.0) as usize;
    let bins = ((extent * 1000.0).ceil() as usize).div_ceil(width);
    let (shares, beyond) = residuals.shares(width, bins);
    let highest = shares.iter().copied().fold(0.0, f64::max) * 100.0;
    let (rows, row_decimals) = marks(highest);
    let (columns, column_decimals) = marks(extent * 100.0);
    let [left, top, right, bottom] = BOX;
    let end = (bins * width) as f64 / 10.0;
    let x = |percent: f64| left + (right - left) * percent / end;
    let y = |percent: f64| bottom - (bottom - top) * percent / rows.last().unwrap_or(&1.0);
    let told = format!(
        "Half of all places are off by {:.1} % or less, 95 % of them by {:.1} % or less.",
        median * 100.0,
        most * 100.0
    );
    let title = format!("{side}: what the photographs leave over");
    let mut drawing = Drawing::new(SIZE, &title, &told);
    for mark in &rows {
        drawing.line([left, y(*mark)], [right, y(*mark)], &thin(GRID));
        let words = format!("{mark:.row_decimals$}");
        drawing.text([left - 6.0, y(*mark) + 4.0], "end", LETTER, &words);
    }
    for mark in columns.iter().filter(|mark| **mark <= end) {
        drawing.line([x(*mark), bottom], [x(*mark), bottom + 5.0], &thin(INK));
        let words = format!("{mark:.column_decimals$}");
        drawing.text([x(*mark), bottom + 18.0], "middle", LETTER, &words);
    }
    let style = format!("fill=\"{OURS}\" stroke=\"#fff\" stroke-width=\"0.5\"");
    for (i, share) in shares.iter().enumerate() {
        let [from, to] = [i, i + 1].map(|at| (at * width) as f64 / 10.0);
        let percent = share * 100.0;
        let tip = format!("{from:.1} to {to:.1} %: {percent:.2} % of places");
        let size = [x(to) - x(from), bottom - y(percent)];
        drawing.bar([x(from), y(percent)], size, &style, &tip);
    }
    drawing.line([left, bottom], [right, bottom], &thin(INK));
    let lines = [
        (median, "", "half of all places", 38.0),
        (most, "stroke-dasharray=\"6 4\"", "95 % of places", 54.0),
    ];
    for (share, dashes, words, height) in lines {
        let at = x(share * 100.0);
        let style = format!("stroke=\"{OTHERS}\" stroke-width=\"2\" {dashes}");
        drawing.line([at, height - 8.0], [at, bottom], &style);
        let (anchor, shift) = match at < (left + right) / 2.0 {
            true => ("start", 5.0),
            false => ("end", -5.0),
        };
        let words = format!("{words}: up to {:.1} %", share * 100.0);
        drawing.text([at + shift, height], anchor, LETTER, &words);
    }
    let middle = (left + right) / 2.0;
    let axis = "difference between photographs and maps, % of the place's mean brightness";
    drawing.text([middle, SIZE[1] - 12.0], "middle", LETTER, axis);
    drawing.upwards([18.0, (top + bottom) / 2.0], "places, % of the side");
    let mut caption = "Share of places that are off by no more than:".to_owned();
    for share in [0.05, 0.25, 0.5, 0.75, 0.95] {
        let _ = write!(
            caption,
            " {:.0} % of them {:.1} %;",
            share * 100.0,
            residuals.quantile(share) * 100.0
        );
    }
    let _ = write!(
        caption,
        " {:.2} % of all are beyond the plot's right end.",
        beyond * 100.0
    );
    drawing.finish(&caption)
}

/// ΔE00 of each patch of a chart before its correction and after it, in bars of the patches' colours,
/// CIELAB under D50 in `lab`.
pub fn chart(fitted: &Fitted, lab: &[[f64; 3]]) -> String {
    const WIDTH: f64 = 620.0;
    const ROW: f64 = 24.0;
    const LEFT: f64 = 150.0;
    const RIGHT: f64 = 570.0;
    const TOP: f64 = 62.0;
    let count = fitted.before.len();
    let bottom = TOP + ROW * count as f64;
    let all = fitted.before.iter().chain(&fitted.after);
    let highest = all.copied().filter(|v| v.is_finite()).fold(0.0, f64::max);
    let (columns, decimals) = marks(highest);
    let x = |value: f64| LEFT + (RIGHT - LEFT) * value / columns.last().unwrap_or(&1.0);
    let mean = |values: &[f64]| values.iter().sum::<f64>() / count.max(1) as f64;
    let told = format!(
        "The mean over {count} patches is {:.2} before and {:.2} after; each is in the table.",
        mean(&fitted.before),
        mean(&fitted.after)
    );
    let title = "Error of the chart's colours, before and after the correction";
    let mut drawing = Drawing::new([WIDTH, bottom + 44.0], title, &told);
    let before_style = format!("stroke=\"{INK}\" stroke-width=\"1\" stroke-dasharray=\"3 2\"");
    let after_style = format!("stroke=\"{INK}\" stroke-width=\"1.5\"");
    let keys = [("before", 5.0, &before_style), ("after", 9.0, &after_style)];
    for ((words, height, style), at) in keys.into_iter().zip([LEFT, LEFT + 200.0]) {
        let style = format!("fill=\"#999\" {style}");
        drawing.bar([at, 44.0 - height / 2.0], [36.0, height], &style, "");
        let words = match words {
            "before" => "before: thin, dashed rim",
            _ => "after: thick, firm rim",
        };
        drawing.text([at + 42.0, 48.0], "start", LETTER, words);
    }
    for mark in &columns {
        drawing.line([x(*mark), TOP], [x(*mark), bottom], &thin(GRID));
        let words = format!("{mark:.decimals$}");
        drawing.text([x(*mark), bottom + 16.0], "middle", LETTER, &words);
    }
    for (i, both) in fitted.before.iter().zip(&fitted.after).enumerate() {
        let top = TOP + ROW * i as f64;
        let name = COLORCHECKER24.get(i).map_or("", |patch| patch.name);
        let words = format!("{} {name}", i + 1);
        drawing.text([LEFT - 8.0, top + 16.0], "end", LETTER, &words);
        let rgb = lab.get(i).map(|lab| linear_from_lab_d50(*lab));
        let colour = format_hex(srgb8_from_linear(rgb.unwrap_or([0.3; 3])));
        let bars = [
            ("before", *both.0, 3.0, 5.0, &before_style),
            ("after", *both.1, 10.0, 9.0, &after_style),
        ];
        for (when, value, down, height, style) in bars {
            let style = format!("fill=\"{colour}\" {style}");
            let tip = format!("{} {name}, {when}: {value:.2}", i + 1);
            let length = (x(value) - LEFT).max(0.0);
            drawing.bar([LEFT, top + down], [length, height], &style, &tip);
        }
    }
    drawing.line([LEFT, TOP], [LEFT, bottom], &thin(INK));
    let middle = (LEFT + RIGHT) / 2.0;
    let axis = "ΔE00 (1 is just seen side by side)";
    drawing.text([middle, bottom + 36.0], "middle", LETTER, axis);
    drawing.finish("Numbered row by row, from the patch dark skin.")
}

/// How far photographs that were left out are off: computed from the others, beside the mean of
/// those of their neighbours. Nothing where none was left out.
pub fn left_out(side: &str, each: &[RelitOne]) -> String {
    const SIZE: [f64; 2] = [560.0, 310.0];
    const BOX: [f64; 4] = [64.0, 66.0, 540.0, 256.0];
    if each.is_empty() {
        return String::new();
    }
    let [left, top, right, bottom] = BOX;
    let values = each.iter().flat_map(|one| [one.computed, one.neighbours]);
    let highest = values.filter(|v| v.is_finite()).fold(0.0, f64::max) * 100.0;
    let (rows, decimals) = marks(highest);
    let y = |percent: f64| bottom - (bottom - top) * percent / rows.last().unwrap_or(&1.0);
    let better = each.iter().filter(|one| one.computed < one.neighbours);
    let told = format!(
        "Computed, {} of {} are nearer to the photograph than the mean of its neighbours; each is in \
         the table.",
        better.count(),
        each.len()
    );
    let title = format!("{side}: photographs that were left out and computed from the others");
    let mut drawing = Drawing::new(SIZE, &title, &told);
    let ours = format!("fill=\"{OURS}\" stroke=\"{OURS}\" stroke-width=\"2\"");
    let others = format!("fill=\"#fff\" stroke=\"{OTHERS}\" stroke-width=\"2\"");
    let keys = [
        ("computed (full)", &ours),
        ("mean of neighbours (hollow)", &others),
    ];
    for ((words, style), at) in keys.into_iter().zip([left, left + 170.0]) {
        drawing.bar([at, 36.0], [20.0, 12.0], style, "");
        drawing.text([at + 28.0, 46.0], "start", LETTER, words);
    }
    for mark in &rows {
        drawing.line([left, y(*mark)], [right, y(*mark)], &thin(GRID));
        let words = format!("{mark:.decimals$}");
        drawing.text([left - 6.0, y(*mark) + 4.0], "end", LETTER, &words);
    }
    let pitch = (right - left) / each.len() as f64;
    let wide = (pitch * 0.32).min(40.0);
    for (i, one) in each.iter().enumerate() {
        let middle = left + pitch * (i as f64 + 0.5);
        let number = one.lamp + 1;
        let bars = [
            ("computed", one.computed, middle - wide - 1.5, &ours),
            ("mean of neighbours", one.neighbours, middle + 1.5, &others),
        ];
        for (words, share, at, style) in bars {
            let percent = share * 100.0;
            let tip = format!("Photograph {number}, {words}: {percent:.1} %");
            let height = (bottom - y(percent)).max(0.0);
            drawing.bar([at, bottom - height], [wide, height], style, &tip);
        }
        drawing.text(
            [middle, bottom + 18.0],
            "middle",
            LETTER,
            &number.to_string(),
        );
    }
    drawing.line([left, bottom], [right, bottom], &thin(INK));
    let axis = "photograph, by the number of its lamp";
    drawing.text(
        [(left + right) / 2.0, SIZE[1] - 14.0],
        "middle",
        LETTER,
        axis,
    );
    drawing.upwards([18.0, (top + bottom) / 2.0], "off by, % of its mean");
    let mut caption = "The lower, the better. ".to_owned();
    caption += "<table><tr><th>Photograph<th>Computed<th>Mean of neighbours";
    for one in each {
        let _ = write!(
            caption,
            "<tr><td>{}<td>{:.1} %<td>{:.1} %",
            one.lamp + 1,
            one.computed * 100.0,
            one.neighbours * 100.0
        );
    }
    drawing.finish(&format!("{caption}</table>"))
}
