//! Colour charts of six by four patches: their colours, and where they lie in a photograph.

use glam::{DMat3, DVec2, DVec3};

use crate::colour;

/// Patches of a chart.
pub const PATCHES: usize = COLUMNS * ROWS;
/// In a row.
pub const COLUMNS: usize = 6;
pub const ROWS: usize = 4;
/// Half the side of what is read of a patch, in distances of patches.
const HALF: f64 = 0.2;
/// Linear light from which a channel counts as clipped.
const CLIPPED: f32 = 0.995;
/// The share of a patch that may be clipped: specks of dust shine.
const CLIPPED_SHARE: f64 = 0.01;
/// The fewest pixels of a patch that its colour is read from.
const FEWEST: usize = 16;

/// Mean ΔE00 of left-out patches above which they are not the chart's, or in another order: the worst of cameras
/// under the worst of lamps is below it.
pub const MOST_OFF: f64 = 12.0;

/// A patch of a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    pub name: &'static str,
    /// CIELAB under D50, 2° observer.
    pub lab: [f64; 3],
}

const fn patch(name: &'static str, lab: [f64; 3]) -> Patch {
    Patch { name, lab }
}

/// The ColorChecker Classic as made since November 2014, row by row, as X-Rite published it
/// (*New color specifications for ColorChecker SG and Classic charts*).
pub const COLORCHECKER24: [Patch; PATCHES] = [
    patch("dark skin", [37.54, 14.37, 14.92]),
    patch("light skin", [64.66, 19.27, 17.50]),
    patch("blue sky", [49.32, -3.82, -22.54]),
    patch("foliage", [43.46, -12.74, 22.72]),
    patch("blue flower", [54.94, 9.61, -24.79]),
    patch("bluish green", [70.48, -32.26, -0.37]),
    patch("orange", [62.73, 35.83, 56.50]),
    patch("purplish blue", [39.43, 10.75, -45.17]),
    patch("moderate red", [50.57, 48.64, 16.67]),
    patch("purple", [30.10, 22.54, -20.87]),
    patch("yellow green", [71.77, -24.13, 58.19]),
    patch("orange yellow", [71.51, 18.24, 67.37]),
    patch("blue", [28.37, 15.42, -49.80]),
    patch("green", [54.38, -39.72, 32.27]),
    patch("red", [42.43, 51.05, 28.62]),
    patch("yellow", [81.80, 2.67, 80.41]),
    patch("magenta", [50.63, 51.28, -14.12]),
    patch("cyan", [49.57, -29.71, -28.32]),
    patch("white", [95.19, -1.03, 2.93]),
    patch("neutral 8", [81.29, -0.57, 0.44]),
    patch("neutral 6.5", [66.89, -0.75, -0.06]),
    patch("neutral 5", [50.76, -0.13, 0.14]),
    patch("neutral 3.5", [35.63, -0.46, -0.48]),
    patch("black", [20.64, 0.07, -0.46]),
];

/// Linear sRGB of a CIELAB colour under D50, adapted to D65 (Bradford).
pub fn linear_from_lab_d50(lab: [f64; 3]) -> [f64; 3] {
    let xyz = colour::xyz_from_lab(lab, colour::white_xyz(colour::D50));
    let adapted = colour::bradford(colour::D50, colour::D65) * DVec3::from(xyz);
    colour::linear_from_xyz(adapted.into())
}

/// CIELAB of linear sRGB under the white `xy`, to which it is adapted (Bradford).
pub fn lab_under(linear: [f64; 3], xy: [f64; 2]) -> [f64; 3] {
    let xyz = DVec3::from(colour::xyz_from_linear(linear));
    let adapted = colour::bradford(colour::D65, xy) * xyz;
    colour::lab_from_xyz(adapted.into(), colour::white_xyz(xy))
}

/// Reads a chart's table: 24 lines of L*, a*, b* under D50, parted by commas, tabs or blanks; a
/// name may stand before, `#` begins a comment.
///
/// # Errors
/// In words.
pub fn read_table(text: &str) -> Result<Vec<[f64; 3]>, String> {
    let mut patches = Vec::new();
    for (i, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let row = line.split('#').next().unwrap_or_default().trim();
        if row.is_empty() {
            continue;
        }
        let cells: Vec<&str> = row
            .split(|c: char| c == ',' || c == ';' || c.is_whitespace())
            .filter(|cell| !cell.is_empty())
            .collect();
        let numbers: Vec<f64> = cells
            .iter()
            .rev()
            .map_while(|cell| cell.parse().ok())
            .take(3)
            .collect();
        let [b, a, l] = numbers[..] else {
            return Err(format!("line {}: three numbers are needed", i + 1));
        };
        let plausible = (0.0..=100.0).contains(&l) && a.abs() <= 160.0 && b.abs() <= 160.0;
        if !plausible {
            return Err(format!(
                "line {}: L* is 0 to 100, a* and b* -160 to 160",
                i + 1
            ));
        }
        patches.push([l, a, b]);
    }
    match patches.len() {
        PATCHES => Ok(patches),
        count => Err(format!("{count} patches where there are {PATCHES}")),
    }
}

/// Why a chart cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ChartError {
    #[error(
        "the chart's corners lie on one line; write them in the order dark skin, bluish green, black, white"
    )]
    Degenerate,
    #[error("the patch \"{}\" lies outside the photograph; correct the chart's corners", name(*.0))]
    Outside(usize),
    #[error("the patch \"{}\" has fewer than {FEWEST} pixels; photograph the chart from nearer", name(*.0))]
    Small(usize),
    #[error("the patch \"{}\" is saturated; photograph the chart, and all the rest, with less exposure", name(*.0))]
    Saturated(usize),
    #[error(
        "the chart's patches have one hue: it lies under coloured light, or is no chart; correct its corners or the photograph"
    )]
    Flat,
    #[error(
        "the patches are ΔE00 {0:.0} from the chart's colours in the mean, where a camera's are below {MOST_OFF}; \
         write the corners in the order dark skin, bluish green, black, white, or correct the chart's table"
    )]
    Unlike(f64),
    #[error("the patch \"{}\" is covered, shines or is not of the chart's colours; photograph the chart again, or write the middles of its corner patches as corners_px", name(*.0))]
    Covered(usize),
    #[error(
        "more than one chart is seen, or it may lie in several ways; write the middles of its corner patches as corners_px"
    )]
    Several,
    #[error(
        "no chart was found, or it is over-exposed; write the middles of its corner patches as corners_px"
    )]
    NotFound,
}

fn name(patch: usize) -> &'static str {
    COLORCHECKER24.get(patch).map_or("?", |patch| patch.name)
}

/// The middles of all patches, row by row, from those at the corners (dark skin, bluish green,
/// black, white), by the perspective that they define.
///
/// # Errors
/// [`ChartError::Degenerate`].
pub fn middles(corners: [DVec2; 4]) -> Result<Vec<DVec2>, ChartError> {
    let onto = perspective(corners).ok_or(ChartError::Degenerate)?;
    let places = (0..PATCHES).map(|i| {
        let (column, row) = (i % COLUMNS, i / COLUMNS);
        let u = column as f64 / (COLUMNS - 1) as f64;
        let v = row as f64 / (ROWS - 1) as f64;
        let at = onto * DVec3::new(u, v, 1.0);
        at.truncate() / at.z
    });
    let places: Vec<DVec2> = places.collect();
    match places.iter().all(|place| place.is_finite()) {
        true => Ok(places),
        false => Err(ChartError::Degenerate),
    }
}

/// The projective map of the unit square's corners (0,0), (1,0), (1,1), (0,1) onto these.
fn perspective(corners: [DVec2; 4]) -> Option<DMat3> {
    // Heckbert 1989, *Fundamentals of Texture Mapping*, 2.2.3.
    let [a, b, c, d] = corners;
    let (to_c, from_d, sum) = (b - c, d - c, a - b + c - d);
    let area = to_c.perp_dot(from_d);
    let size = to_c.length() * from_d.length();
    if area.is_nan() || area.abs() <= 1e-3 * size {
        return None;
    }
    let g = sum.perp_dot(from_d) / area;
    let h = to_c.perp_dot(sum) / area;
    let x = b - a + g * b;
    let y = d - a + h * d;
    Some(DMat3::from_cols(x.extend(g), y.extend(h), a.extend(1.0)))
}

/// The colours of a chart's patches: the medians of linear `planes` (red, green, blue) around
/// their middles.
///
/// # Errors
/// [`ChartError`]: outside, too small, or clipped.
pub fn colours(
    planes: [&[f32]; 3],
    size: [usize; 2],
    corners: [DVec2; 4],
) -> Result<Vec<[f64; 3]>, ChartError> {
    read_patches(planes, size, corners, CLIPPED)
}

/// As [`colours`], of a photograph divided by a grey card's, in which no level means clipping.
///
/// # Errors
/// As [`colours`].
pub fn colours_unclipped(
    planes: [&[f32]; 3],
    size: [usize; 2],
    corners: [DVec2; 4],
) -> Result<Vec<[f64; 3]>, ChartError> {
    read_patches(planes, size, corners, f32::INFINITY)
}

fn read_patches(
    planes: [&[f32]; 3],
    [width, height]: [usize; 2],
    corners: [DVec2; 4],
    clipped: f32,
) -> Result<Vec<[f64; 3]>, ChartError> {
    let middles = middles(corners)?;
    let half = patch_half(&middles);
    let read = |i: usize| {
        let middle = middles[i];
        let (low, high) = (middle - half, middle + half);
        let inside = low.min_element() >= 0.0 && high.x < width as f64 && high.y < height as f64;
        if !inside {
            return Err(ChartError::Outside(i));
        }
        let rows = low.y.ceil() as usize..high.y.floor() as usize;
        let columns = low.x.ceil() as usize..high.x.floor() as usize;
        let count = rows.len() * columns.len();
        if count < FEWEST {
            return Err(ChartError::Small(i));
        }
        let mut colour = [0.0; 3];
        for (value, plane) in colour.iter_mut().zip(planes) {
            let pixels = rows
                .clone()
                .flat_map(|y| &plane[y * width + columns.start..y * width + columns.end]);
            let mut pixels: Vec<f32> = pixels.copied().collect();
            let over = pixels.iter().filter(|v| **v >= clipped).count();
            if over as f64 > CLIPPED_SHARE * count as f64 {
                return Err(ChartError::Saturated(i));
            }
            let middle = pixels.len() / 2;
            let (_, median, _) = pixels.select_nth_unstable_by(middle, f32::total_cmp);
            *value = f64::from(*median);
        }
        Ok(colour)
    };
    (0..PATCHES).map(read).collect()
}

/// Half the side of what is read of each patch, in pixels.
fn patch_half(middles: &[DVec2]) -> f64 {
    let steps = (0..PATCHES).flat_map(|i| {
        let right = (i % COLUMNS + 1 < COLUMNS).then(|| middles[i].distance(middles[i + 1]));
        let below = (i + COLUMNS < PATCHES).then(|| middles[i].distance(middles[i + COLUMNS]));
        right.into_iter().chain(below)
    });
    HALF * steps.fold(f64::INFINITY, f64::min)
}
