//! A camera, or a sheet, that moved between the photographs of one side.
//!
//! Each photograph is compared with those whose lamps stand next to its own, and all of them are
//! put where most of these comparisons want them (the least sum of distances, by iteratively
//! reweighted least squares).

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

use glam::{DAffine2, DVec2, DVec3};
use rayon::prelude::*;

use super::{
    PrepareError,
    capture::{Capture, Shots},
    linear::solve_positive,
    reduced::{Grey, Reduced, step_to},
    report::escaped,
};
use crate::maps::{
    ColourEncoding,
    registration::moved::{Detail, LONGEST_PX, motion},
};

/// How far a photograph may be shifted against the others, in its pixels.
pub const STILL_PX: f64 = 1.0;
/// And in pixels of the reduced picture that it is compared in: a lamp from another side draws
/// edges by up to this much to its own.
const STILL_REDUCED: f64 = 0.5;
/// How many photographs with lamps next to its own each is compared with.
const NEIGHBOURS: usize = 3;
/// How many comparisons must say so of a photograph that is shifted too far.
const WITNESSES: usize = 2;
/// How far from each other these may be, in pixels of the reduced picture.
const WITNESS_PX: f64 = 0.75;

/// Where a motion is told: in shares of the picture, its middle and its corners.
const PLACES: [[f64; 2]; 5] = [[0.5, 0.5], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
/// How these places are shifted, each to the right and down.
type Shifts = [f64; 2 * PLACES.len()];

/// How still a side was held, photograph by photograph.
#[derive(Clone, Debug, PartialEq)]
pub struct Stillness {
    /// In the order of the lamps: the farthest that the middle or a corner of the photograph is
    /// shifted against where most of them have it, in pixels to the right and down; `None` where
    /// too little of it could be compared.
    pub shifts: Vec<Option<DVec2>>,
    /// From where on a photograph counts as moved, in pixels.
    pub limit_px: f64,
}

/// A photograph that is shifted too far.
#[derive(Clone, Debug, PartialEq)]
pub struct Moved {
    pub path: PathBuf,
    /// To the right and down, in pixels.
    pub by_px: DVec2,
    /// How far, in mm on the sheet.
    pub mm: f64,
}

impl std::fmt::Display for Moved {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let DVec2 { x, y } = self.by_px;
        write!(
            f,
            "{} is shifted by {:.1} pixels ({x:.1} to the right, {y:.1} down; {:.2} mm on the sheet)",
            self.path.display(),
            self.by_px.length(),
            self.mm
        )
    }
}

impl Stillness {
    /// The farthest shift, and whose it is; `None` where none could be compared.
    pub fn farthest(&self) -> Option<(usize, DVec2)> {
        let known = self.shifts.iter().enumerate();
        known
            .filter_map(|(i, by)| Some((i, (*by)?)))
            .max_by(|a, b| a.1.length().total_cmp(&b.1.length()))
    }

    /// How many photographs could be compared.
    pub fn compared(&self) -> usize {
        self.shifts.iter().flatten().count()
    }

    /// A row of the report's table.
    pub(super) fn row(&self, shots: &Shots, mm_per_px: f64) -> String {
        let told = match self.farthest() {
            Some((i, by)) => format!(
                "{:.2} pixels ({:.3} mm), {}; {} of {} could be compared",
                by.length(),
                by.length() * mm_per_px,
                escaped(&shots.photographs[i].to_string_lossy()),
                self.compared(),
                self.shifts.len()
            ),
            None => "not known: too little is seen alike under two lamps".to_owned(),
        };
        format!("<tr><td>The farthest shift of a photograph against the others<td>{told}")
    }
}

/// A side, and its photographs made smaller by [`step`] where they were read before.
pub(super) type Seen<'s> = (&'s Shots, Option<Vec<Grey>>);

/// What each photograph of a side is made smaller by while it runs through, for [`check_seen`];
/// `None` where that many would take too much memory.
pub(super) fn step(shots: &Shots) -> Option<usize> {
    /// What the photographs of a side may take.
    const MOST_BYTES: usize = 160 << 20;
    let step = step_of(shots);
    let bytes = Grey::bytes(shots.crop, step) * shots.photographs.len();
    (bytes <= MOST_BYTES).then_some(step)
}

/// As [`check`], of several sides. The photographs of the first need not be read for it alone:
/// where they have not been yet, what is told of it is `None`, and [`check_seen`] tells it when they
/// run through, before anything is made of them.
///
/// # Errors
/// [`PrepareError::Moved`] with what moved of all sides, and as [`check`].
pub(super) fn check_all(
    sides: Vec<Seen<'_>>,
    towards: &[DVec3],
    capture: &Capture,
    scratch: &Path,
) -> Result<Vec<Option<Stillness>>, PrepareError> {
    let read = |shots| check(shots, towards, capture.mm_per_px, capture.encoding, scratch);
    let (mut still, mut later, mut moved) = (Vec::new(), None, Vec::new());
    for (i, (shots, greys)) in sides.into_iter().enumerate() {
        let checked = match greys {
            Some(greys) => check_seen(shots, towards, capture.mm_per_px, greys),
            None if i == 0 && step(shots).is_some() => {
                later = Some(shots);
                still.push(None);
                continue;
            }
            None => read(shots),
        };
        match checked {
            Ok(stillness) => still.push(Some(stillness)),
            Err(PrepareError::Moved(more)) => moved.extend(more),
            Err(other) => return Err(other),
        }
    }
    if moved.is_empty() {
        return Ok(still);
    }
    // All that has to be photographed again is told at once.
    match later.map(read) {
        Some(Err(PrepareError::Moved(mut first))) => {
            first.append(&mut moved);
            Err(PrepareError::Moved(first))
        }
        Some(Err(other)) => Err(other),
        Some(Ok(_)) | None => Err(PrepareError::Moved(moved)),
    }
}

/// Compares the photographs of a side with each other; `towards` are unit vectors towards their
/// lamps.
///
/// # Errors
/// [`PrepareError::Moved`] with every photograph that is shifted, and of the first that cannot be
/// read.
pub fn check(
    shots: &Shots,
    towards: &[DVec3],
    mm_per_px: f64,
    encoding: ColourEncoding,
    scratch: &Path,
) -> Result<Stillness, PrepareError> {
    let step = step_of(shots);
    let read = |path: &PathBuf| -> Result<Option<Detail>, PrepareError> {
        let small = Reduced::read(path, encoding, shots.crop, step, scratch)?;
        Ok(Detail::new(&small.grey(), small.size))
    };
    let details: Result<Vec<_>, PrepareError> = shots.photographs.par_iter().map(read).collect();
    compare(shots, towards, mm_per_px, &details?)
}

/// As [`check`], of photographs that were made smaller by [`step`] on the way.
///
/// # Errors
/// [`PrepareError::Moved`] with every photograph that is shifted.
pub(super) fn check_seen(
    shots: &Shots,
    towards: &[DVec3],
    mm_per_px: f64,
    greys: Vec<Grey>,
) -> Result<Stillness, PrepareError> {
    let detail = |grey: Grey| {
        let (size, values) = grey.finish();
        Detail::new(&values, size)
    };
    let details: Vec<_> = greys.into_par_iter().map(detail).collect();
    compare(shots, towards, mm_per_px, &details)
}

fn step_of(shots: &Shots) -> usize {
    step_to(LONGEST_PX, [shots.crop.width(), shots.crop.height()])
}

fn compare(
    shots: &Shots,
    towards: &[DVec3],
    mm_per_px: f64,
    details: &[Option<Detail>],
) -> Result<Stillness, PrepareError> {
    let step = step_of(shots);
    let reduced = [shots.crop.width() / step, shots.crop.height() / step];
    let pairs: Vec<[usize; 2]> = neighbours(towards).into_iter().collect();
    let compared: Vec<Pair> = pairs
        .par_iter()
        .filter_map(|[a, b]| {
            let by = motion(details.get(*a)?.as_ref()?, details.get(*b)?.as_ref()?)?;
            Some(([*a, *b], shifts_of(by, reduced)))
        })
        .collect();
    let step = step as f64;
    let limit_px = STILL_PX.max(STILL_REDUCED * step);
    let placed = placed(shots.photographs.len(), &compared);
    let shifts = (0..placed.len()).map(|i| {
        let shift = farthest(placed[i].as_ref()?) * step;
        let sure = shift.length() <= limit_px || witnesses(i, &placed, &compared) >= WITNESSES;
        sure.then_some(shift)
    });
    let stillness = Stillness {
        shifts: shifts.collect(),
        limit_px,
    };
    let moved: Vec<Moved> = (stillness.shifts.iter().enumerate())
        .filter_map(|(i, by)| Some((i, (*by)?)))
        .filter(|(_, by)| by.length() > limit_px)
        .map(|(i, by_px)| Moved {
            path: shots.photographs[i].clone(),
            by_px,
            mm: by_px.length() * mm_per_px,
        })
        .collect();
    match moved.is_empty() {
        true => Ok(stillness),
        false => Err(PrepareError::Moved(moved)),
    }
}

/// Two photographs, and how the second is shifted against the first.
type Pair = ([usize; 2], Shifts);

/// Pairs of lamps that stand next to each other.
fn neighbours(towards: &[DVec3]) -> BTreeSet<[usize; 2]> {
    let mut pairs = BTreeSet::new();
    for (i, l) in towards.iter().enumerate() {
        let mut others: Vec<usize> = (0..towards.len()).filter(|other| *other != i).collect();
        others.sort_by(|a, b| l.dot(towards[*b]).total_cmp(&l.dot(towards[*a])));
        for other in others.into_iter().take(NEIGHBOURS) {
            pairs.insert([i.min(other), i.max(other)]);
        }
    }
    pairs
}

fn shifts_of(by: DAffine2, [width, height]: [usize; 2]) -> Shifts {
    let mut shifts = [0.0; 2 * PLACES.len()];
    for (shift, [u, v]) in shifts.chunks_exact_mut(2).zip(PLACES) {
        let at = DVec2::new(u * width as f64, v * height as f64);
        let moved = by.transform_point2(at) - at;
        shift.copy_from_slice(&[moved.x, moved.y]);
    }
    shifts
}

fn farthest(shifts: &Shifts) -> DVec2 {
    let each = shifts.chunks_exact(2).map(|by| DVec2::new(by[0], by[1]));
    each.fold(DVec2::ZERO, |far, by| {
        if by.length() > far.length() { by } else { far }
    })
}

/// How far a pair is from where its two photographs are put.
fn residual(by: &Shifts, placed: [&Shifts; 2]) -> f64 {
    let off: Shifts = std::array::from_fn(|k| placed[1][k] - placed[0][k] - by[k]);
    farthest(&off).length()
}

fn witnesses(i: usize, placed: &[Option<Shifts>], compared: &[Pair]) -> usize {
    let agrees = |(pair, by): &&Pair| {
        let [Some(a), Some(b)] = pair.map(|i| placed[i].as_ref()) else {
            return false;
        };
        pair.contains(&i) && residual(by, [a, b]) < WITNESS_PX
    };
    compared.iter().filter(agrees).count()
}

/// Where each photograph is put, against the middle of all that are connected with it; `None` of
/// one that is not connected with any.
fn placed(count: usize, compared: &[Pair]) -> Vec<Option<Shifts>> {
    /// Distances below count as squares.
    const SMALLEST: f64 = 0.05;
    /// Holds the whole, which nothing else does.
    const RIDGE: f64 = 1e-6;
    const TURNS: usize = 30;
    let mut weights = vec![1.0; compared.len()];
    let mut places: Vec<Shifts> = vec![[0.0; 2 * PLACES.len()]; count];
    for _ in 0..TURNS {
        let mut normal = vec![vec![0.0; count]; count];
        let mut right = vec![vec![0.0; count]; 2 * PLACES.len()];
        for (i, row) in normal.iter_mut().enumerate() {
            row[i] = RIDGE;
        }
        for (([a, b], by), weight) in compared.iter().zip(&weights) {
            normal[*a][*a] += weight;
            normal[*b][*b] += weight;
            normal[*a][*b] -= weight;
            normal[*b][*a] -= weight;
            for (right, by) in right.iter_mut().zip(by) {
                right[*a] -= weight * by;
                right[*b] += weight * by;
            }
        }
        let Some(solved) = solve_positive(&normal, &right) else {
            break;
        };
        for (i, place) in places.iter_mut().enumerate() {
            *place = std::array::from_fn(|k| solved[k][i]);
        }
        for ((pair, by), weight) in compared.iter().zip(&mut weights) {
            let off = residual(by, pair.map(|i| &places[i]));
            *weight = off.max(SMALLEST).recip();
        }
    }
    let groups = groups(count, compared);
    let mut against = vec![None; count];
    for group in groups.iter().collect::<BTreeSet<_>>() {
        let members: Vec<usize> = (0..count).filter(|i| groups[*i] == *group).collect();
        if members.len() < 2 {
            continue;
        }
        let middle: Shifts = std::array::from_fn(|k| {
            let mut values: Vec<f64> = members.iter().map(|i| places[*i][k]).collect();
            values.sort_by(f64::total_cmp);
            values[(values.len() - 1) / 2]
        });
        for i in members {
            against[i] = Some(std::array::from_fn(|k| places[i][k] - middle[k]));
        }
    }
    against
}

/// Numbers that photographs share which comparisons connect.
fn groups(count: usize, compared: &[Pair]) -> Vec<usize> {
    let mut groups: Vec<usize> = (0..count).collect();
    for ([a, b], _) in compared {
        let (keep, drop) = (groups[*a].min(groups[*b]), groups[*a].max(groups[*b]));
        groups
            .iter_mut()
            .filter(|group| **group == drop)
            .for_each(|group| *group = keep);
    }
    groups
}
