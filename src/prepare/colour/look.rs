//! A colour chart of six by four patches, found in a photograph.
//!
//! 1. Plain places with the outline of a square in perspective are patches, or what looks like one.
//! 2. Of those that lie in rows and columns, each window of six by four is a chart, either way up.
//! 3. The one whose colours are a chart's, up to one linear map of the camera's channels, is it.

use std::collections::{HashMap, VecDeque};

use glam::DVec2;

use super::{
    super::{
        linear::{least_squares, solve_positive},
        reduced::Reduced,
    },
    chart::{
        COLUMNS, ChartError, PATCHES, ROWS, colours_unclipped, lab_under, linear_from_lab_d50,
        middles,
    },
};
use crate::colour::{D50, delta_e00};

/// Pixels along the longer side of the pictures that a chart is looked for in, one after another:
/// in the first, a chart of a sixth of the picture is still clear.
pub const LONGEST_PX: [usize; 2] = [900, 2400];
/// How much values (encoded, 0…1) may differ within 3 × 3 pixels of a plain place: at least and at
/// most, and how many times the middle of all pixels.
const PLAIN: [f32; 2] = [0.025, 0.06];
const PLAIN_NOISE: f32 = 2.5;
/// The fewest pixels of a patch.
const LEAST_AREA: usize = 30;
/// The largest share of the picture that a patch covers.
const LARGEST_SHARE: f64 = 0.03;
/// The area of a place over that of the parallelogram of its second moments.
const SQUARE: [f64; 2] = [0.82, 1.12];
/// The longest that a patch looks, in its breadths.
const LONGEST: f64 = 2.5;
/// Places beyond these, the largest first, are texture.
const MOST_PLACES: usize = 1500;
/// How the areas of patches of one chart may differ.
const AREAS: f64 = 2.5;
/// How far a patch may be from where its neighbours have it, in their distances.
const ASTRAY: f64 = 0.25;
/// How many of the 24 patches must be seen as such; black may run into the frame.
const LEAST_SEEN: usize = 15;
/// Mean ΔE00 of a chart's patches after one linear map; the lamp's fall-off is in it.
const LIKE_A_CHART: f64 = 7.0;
/// Of one patch: beyond, it is covered or shines.
const COVERED: f64 = 22.0;
/// How much worse the next best way to lay the chart must be.
const CLEARLY: f64 = 1.5;

/// A plain place.
#[derive(Clone, Copy, Debug)]
struct Place {
    middle: DVec2,
    area: f64,
}

/// Finds the middles of the patches at the chart's corners (dark skin, bluish green, black, white),
/// in pixels of the picture; `lab` are the chart's colours under D50.
///
/// # Errors
/// [`ChartError::NotFound`], [`ChartError::Covered`] or [`ChartError::Several`].
pub fn find(picture: &Reduced, lab: &[[f64; 3]]) -> Result<[DVec2; 4], ChartError> {
    let places = places(picture);
    let mut laid: Vec<Laid> = Vec::new();
    let mut taken = vec![false; places.len()];
    for seed in 0..places.len() {
        if taken[seed] {
            continue;
        }
        let Some(lattice) = lattice(&places, seed) else {
            continue;
        };
        for i in lattice.values() {
            taken[*i] = true;
        }
        for corners in windows(&lattice, &places) {
            laid.extend(judged(picture, corners, lab));
        }
    }
    laid.sort_by(|a, b| a.mean.total_cmp(&b.mean));
    let Some(best) = laid.first() else {
        return Err(ChartError::NotFound);
    };
    if best.mean > LIKE_A_CHART || best.worst.1 > COVERED {
        // Nearly all of it is a chart.
        return Err(match best.median <= LIKE_A_CHART {
            true => ChartError::Covered(best.worst.0),
            false => ChartError::NotFound,
        });
    }
    let step = best.corners[0].distance(best.corners[1]) / (COLUMNS - 1) as f64;
    let same = |other: &Laid| {
        let pairs = other.corners.iter().zip(&best.corners);
        pairs.into_iter().all(|(a, b)| a.distance(*b) < step / 2.0)
    };
    match laid.iter().find(|other| !same(other)) {
        Some(other) if other.mean < CLEARLY * best.mean.max(LIKE_A_CHART / CLEARLY) => {
            Err(ChartError::Several)
        }
        _ => Ok(best.corners),
    }
}

/// Plain places of about a square's outline.
fn places(picture: &Reduced) -> Vec<Place> {
    let [width, height] = picture.size;
    if width < 8 || height < 8 {
        return Vec::new();
    }
    let planes = encoded(picture);
    let range = ranges(&planes, picture.size);
    let mut sorted = range.clone();
    let middle = sorted.len() / 2;
    let median = *sorted.select_nth_unstable_by(middle, f32::total_cmp).1;
    let limit = (PLAIN_NOISE * median).clamp(PLAIN[0], PLAIN[1]);
    let mut open: Vec<bool> = range.iter().map(|range| *range <= limit).collect();
    let mut places = Vec::new();
    let largest = LARGEST_SHARE * (width * height) as f64;
    let mut queue = VecDeque::new();
    for start in 0..open.len() {
        if !open[start] {
            continue;
        }
        open[start] = false;
        queue.push_back(start);
        let mut sums = [0.0f64; 6];
        while let Some(i) = queue.pop_front() {
            let (x, y) = (i % width, i / width);
            let (u, v) = (x as f64, y as f64);
            for (sum, term) in sums.iter_mut().zip([1.0, u, v, u * u, u * v, v * v]) {
                *sum += term;
            }
            let neighbours = [
                (x > 0).then(|| i - 1),
                (x + 1 < width).then(|| i + 1),
                (y > 0).then(|| i - width),
                (y + 1 < height).then(|| i + width),
            ];
            for next in neighbours.into_iter().flatten() {
                if std::mem::take(&mut open[next]) {
                    queue.push_back(next);
                }
            }
        }
        places.extend(square(sums).filter(|place| place.area <= largest));
    }
    places.sort_by(|a, b| b.area.total_cmp(&a.area));
    places.truncate(MOST_PLACES);
    places
}

/// A place with these moments, if it may be a square in perspective.
fn square([area, x, y, xx, xy, yy]: [f64; 6]) -> Option<Place> {
    if area < LEAST_AREA as f64 {
        return None;
    }
    let (x, y) = (x / area, y / area);
    // A pixel has an extent of its own.
    let (a, b, c) = (
        xx / area - x * x + 1.0 / 12.0,
        xy / area - x * y,
        yy / area - y * y + 1.0 / 12.0,
    );
    let determinant = a * c - b * b;
    if determinant <= 0.0 {
        return None;
    }
    // A parallelogram has the area 12 √det of its covariances.
    let filled = area / (12.0 * determinant.sqrt());
    let (mean, spread) = ((a + c) / 2.0, ((a - c) / 2.0).hypot(b));
    let long = ((mean + spread) / (mean - spread)).sqrt();
    let is_square = (SQUARE[0]..=SQUARE[1]).contains(&filled) && long <= LONGEST;
    is_square.then(|| Place {
        middle: DVec2::new(x, y) + 0.5,
        area,
    })
}

/// Planes as the eye sees them, smoothed over 3 × 3 pixels.
fn encoded(picture: &Reduced) -> [Vec<f32>; 3] {
    let [width, height] = picture.size;
    /// What is brighter gleams.
    const BRIGHTEST: f64 = 0.999;
    let mut all: Vec<f32> = picture.planes.iter().flatten().copied().collect();
    let i = ((all.len() - 1) as f64 * BRIGHTEST) as usize;
    let white = all
        .select_nth_unstable_by(i, f32::total_cmp)
        .1
        .max(f32::MIN_POSITIVE);
    picture.planes.each_ref().map(|plane| {
        let values: Vec<f32> = plane
            .iter()
            .map(|v| (v / white).clamp(0.0, 1.0).sqrt())
            .collect();
        let mut smooth = values.clone();
        for y in 1..height - 1 {
            for x in 1..width - 1 {
                let rows = (y - 1..=y + 1).map(|y| y * width + x);
                let sum: f32 = rows.flat_map(|i| &values[i - 1..=i + 1]).sum();
                smooth[y * width + x] = sum / 9.0;
            }
        }
        smooth
    })
}

/// The largest range of any channel over 3 × 3 pixels; of the outermost, all.
fn ranges(planes: &[Vec<f32>; 3], [width, height]: [usize; 2]) -> Vec<f32> {
    let mut range = vec![1.0f32; width * height];
    for y in 1..height - 1 {
        for x in 1..width - 1 {
            let of = |plane: &Vec<f32>| {
                let rows = (y - 1..=y + 1).map(|y| y * width + x);
                let values = rows.flat_map(|i| &plane[i - 1..=i + 1]);
                let (low, high) = values
                    .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), v| {
                        (low.min(*v), high.max(*v))
                    });
                high - low
            };
            range[y * width + x] = planes.iter().map(of).fold(0.0, f32::max);
        }
    }
    range
}

/// Places by column and row, x and y turning as in the picture.
type Lattice = HashMap<(i32, i32), usize>;

/// The largest lattice that a place and two of its neighbours span.
fn lattice(places: &[Place], seed: usize) -> Option<Lattice> {
    /// Neighbours that are tried.
    const NEAREST: usize = 8;
    let Place { middle, area } = places[seed];
    let alike = |place: &Place| (area / AREAS..=area * AREAS).contains(&place.area);
    // Places are smaller than patches by what the edges took.
    let reach = 2.0 * (area.sqrt() + 6.0);
    let mut near: Vec<DVec2> = places
        .iter()
        .enumerate()
        .filter(|(i, place)| *i != seed && alike(place) && place.middle.distance(middle) < reach)
        .map(|(_, place)| place.middle - middle)
        .collect();
    near.sort_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
    near.truncate(NEAREST);
    let mut best: Option<Lattice> = None;
    for u in &near {
        for v in &near {
            let (long, wide) = (u.length(), v.length());
            // As in the picture, neither mirrored nor flat.
            let upright = u.perp_dot(*v) > 0.8 * long * wide && u.x.abs() >= u.y.abs();
            if !upright || long > 1.7 * wide || wide > 1.7 * long {
                continue;
            }
            let grown = grown(places, seed, [*u, *v]);
            if best.as_ref().is_none_or(|best| grown.len() > best.len()) {
                best = Some(grown);
            }
        }
    }
    best.filter(|lattice| lattice.len() >= LEAST_SEEN)
}

fn grown(places: &[Place], seed: usize, steps: [DVec2; 2]) -> Lattice {
    /// Cells each way from the seed.
    const FARTHEST: i32 = 8;
    let area = places[seed].area;
    let near = ASTRAY * steps[0].length().min(steps[1].length());
    let mut lattice = Lattice::from([((0, 0), seed)]);
    let mut used = vec![false; places.len()];
    used[seed] = true;
    let mut queue = VecDeque::from([(0, 0)]);
    while let Some((m, n)) = queue.pop_front() {
        let here = places[lattice[&(m, n)]].middle;
        for (dm, dn, step) in [
            (1, 0, steps[0]),
            (-1, 0, -steps[0]),
            (0, 1, steps[1]),
            (0, -1, -steps[1]),
        ] {
            let next = (m + dm, n + dn);
            if lattice.contains_key(&next) || next.0.abs().max(next.1.abs()) > FARTHEST {
                continue;
            }
            // As far as from the one before, where it is known: perspective changes slowly.
            let before = lattice.get(&(m - dm, n - dn));
            let step = before.map_or(step, |i| here - places[*i].middle);
            let at = here + step;
            let nearest = places
                .iter()
                .enumerate()
                .filter(|(i, place)| {
                    !used[*i] && (area / AREAS..=area * AREAS).contains(&place.area)
                })
                .map(|(i, place)| (i, place.middle.distance(at)))
                .min_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((i, off)) = nearest
                && off <= near
            {
                used[i] = true;
                lattice.insert(next, i);
                queue.push_back(next);
            }
        }
    }
    lattice
}

/// The corners of every chart that a lattice has room for, in their order, four ways up.
fn windows(lattice: &Lattice, places: &[Place]) -> Vec<[DVec2; 4]> {
    let mut found = Vec::new();
    let columns = lattice.keys().map(|key| key.0);
    let rows = lattice.keys().map(|key| key.1);
    let (Some(left), Some(right)) = (columns.clone().min(), columns.max()) else {
        return found;
    };
    let (Some(top), Some(bottom)) = (rows.clone().min(), rows.max()) else {
        return found;
    };
    let (long, short) = (COLUMNS as i32, ROWS as i32);
    for (wide, high) in [(long, short), (short, long)] {
        // What is missing may be at the edge.
        for m in left - 2..=right + 2 {
            for n in top - 2..=bottom + 2 {
                let cells: Vec<(DVec2, DVec2)> = lattice
                    .iter()
                    .filter(|((x, y), _)| (m..m + wide).contains(x) && (n..n + high).contains(y))
                    .map(|((x, y), i)| {
                        let cell = DVec2::new(f64::from(x - m), f64::from(y - n));
                        (cell, places[*i].middle)
                    })
                    .collect();
                if cells.len() < LEAST_SEEN {
                    continue;
                }
                let Some(onto) = homography(&cells) else {
                    continue;
                };
                let (w, h) = (f64::from(wide - 1), f64::from(high - 1));
                let [a, b, c, d] =
                    [[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]].map(|at| onto.at(at.into()));
                match wide == long {
                    true => found.extend([[a, b, c, d], [c, d, a, b]]),
                    false => found.extend([[b, c, d, a], [d, a, b, c]]),
                }
            }
        }
    }
    found
}

/// A projective map of the plane.
struct Homography {
    /// By rows, the last one 1.
    h: [f64; 8],
    middle: DVec2,
    scale: f64,
}

impl Homography {
    fn at(&self, at: DVec2) -> DVec2 {
        let h = &self.h;
        let w = h[6] * at.x + h[7] * at.y + 1.0;
        let to = DVec2::new(
            h[0] * at.x + h[1] * at.y + h[2],
            h[3] * at.x + h[4] * at.y + h[5],
        );
        to / w * self.scale + self.middle
    }
}

/// The map of cells onto places, by least squares; `None` where it is none, or they do not lie so.
fn homography(cells: &[(DVec2, DVec2)]) -> Option<Homography> {
    let count = cells.len() as f64;
    let middle = cells.iter().map(|(_, at)| *at).sum::<DVec2>() / count;
    let scale = cells.iter().map(|(_, at)| at.distance(middle)).sum::<f64>() / count;
    let mut rows = Vec::new();
    let mut right = Vec::new();
    for (cell, at) in cells {
        let to = (*at - middle) / scale;
        let DVec2 { x, y } = *cell;
        rows.push(vec![x, y, 1.0, 0.0, 0.0, 0.0, -x * to.x, -y * to.x]);
        right.push(to.x);
        rows.push(vec![0.0, 0.0, 0.0, x, y, 1.0, -x * to.y, -y * to.y]);
        right.push(to.y);
    }
    let weights = vec![1.0; rows.len()];
    let h = least_squares(&rows, &weights, &[right], 0.0)?.pop()?;
    let onto = Homography {
        h: h.try_into().ok()?,
        middle,
        scale,
    };
    // A distance of patches.
    let step = onto.at(DVec2::ZERO).distance(onto.at(DVec2::X));
    let fits = cells
        .iter()
        .all(|(cell, at)| onto.at(*cell).distance(*at) < ASTRAY * step);
    fits.then_some(onto)
}

/// A chart laid on the picture.
struct Laid {
    corners: [DVec2; 4],
    /// ΔE00 of its patches once one linear map has made them as like a chart's as can be.
    mean: f64,
    median: f64,
    /// The patch that is least like it.
    worst: (usize, f64),
}

fn judged(picture: &Reduced, corners: [DVec2; 4], lab: &[[f64; 3]]) -> Option<Laid> {
    middles(corners).ok()?;
    let planes = picture.planes.each_ref().map(Vec::as_slice);
    let colours = colours_unclipped(planes, picture.size, corners).ok()?;
    let wanted: Vec<[f64; 3]> = lab.iter().map(|lab| linear_from_lab_d50(*lab)).collect();
    let mut weights = vec![1.0; PATCHES];
    let mut errors = vec![0.0; PATCHES];
    // What is covered has no say in the second turn.
    for _ in 0..2 {
        let map = linear_map(&colours, &wanted, &weights)?;
        for i in 0..PATCHES {
            let seen = map
                .each_ref()
                .map(|row| (0..3).map(|c| row[c] * colours[i][c]).sum::<f64>());
            errors[i] = delta_e00(lab_under(seen, D50), lab_under(wanted[i], D50));
        }
        let mut sorted = errors.clone();
        sorted.sort_by(f64::total_cmp);
        let limit = 3.0 * sorted[PATCHES / 2];
        for (weight, error) in weights.iter_mut().zip(&errors) {
            *weight = if *error > limit.max(LIKE_A_CHART) {
                0.0
            } else {
                1.0
            };
        }
    }
    let mut sorted = errors.clone();
    sorted.sort_by(f64::total_cmp);
    let worst = errors
        .iter()
        .copied()
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    let mean = errors.iter().sum::<f64>() / PATCHES as f64;
    mean.is_finite().then(|| Laid {
        corners,
        mean,
        median: sorted[PATCHES / 2],
        worst,
    })
}

/// The rows of the linear map that brings colours nearest to others.
fn linear_map(from: &[[f64; 3]], to: &[[f64; 3]], weights: &[f64]) -> Option<[Vec<f64>; 3]> {
    let mut normal = vec![vec![0.0; 3]; 3];
    let mut right = vec![vec![0.0; 3]; 3];
    for ((from, to), weight) in from.iter().zip(to).zip(weights) {
        // Dark patches count as the eye counts them.
        let weight = weight / (0.02 + to.iter().sum::<f64>().max(0.0));
        for i in 0..3 {
            for j in 0..3 {
                normal[i][j] += weight * from[i] * from[j];
                right[j][i] += weight * from[i] * to[j];
            }
        }
    }
    solve_positive(&normal, &right)?.try_into().ok()
}
