//! A camera, or a sheet, that moved between the photographs of one side.

use std::path::{Path, PathBuf};

use glam::DVec2;

use super::{
    PrepareError,
    capture::Shots,
    photographs::StackError,
    reduced::{Reduced, step_to},
    report::escaped,
};
use crate::maps::{
    ColourEncoding,
    registration::moved::{Detail, LONGEST_PX, Motion, motion},
};

/// How far a photograph may be shifted against the others, in its pixels.
pub const STILL_PX: f64 = 1.0;
/// And in pixels of the reduced picture that it is compared in: a lamp from another side draws
/// edges by this much to its own.
const STILL_REDUCED: f64 = 0.6;
/// How many times its uncertainty a shift is at least.
const CERTAIN: f64 = 4.0;

/// How still a side was held, photograph by photograph.
#[derive(Clone, Debug, PartialEq)]
pub struct Stillness {
    /// In the order of the lamps: the farthest that any place of the photograph is shifted against
    /// where most of them have it, in pixels to the right and down; `None` where too little of it
    /// could be compared.
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

    /// How many photographs could be compared.
    pub fn compared(&self) -> usize {
        self.shifts.iter().flatten().count()
    }
}

/// Compares the photographs of a side with that of number `reference`, best the one whose lamp
/// stands highest.
///
/// # Errors
/// [`PrepareError::Moved`] with every photograph that is shifted, and of the first that cannot be
/// read.
pub fn check(
    shots: &Shots,
    reference: usize,
    mm_per_px: f64,
    encoding: ColourEncoding,
    scratch: &Path,
) -> Result<Stillness, PrepareError> {
    let size = [shots.crop.width(), shots.crop.height()];
    let step = step_to(LONGEST_PX, size);
    let reduced = size.map(|side| side / step);
    let read = |path: &PathBuf| -> Result<Option<Detail>, StackError> {
        let small = Reduced::read(path, encoding, shots.crop, step, scratch)?;
        Ok(Detail::new(&small.grey(), small.size))
    };
    let first = match shots.photographs.get(reference) {
        Some(path) => read(path)?,
        None => None,
    };
    // One after another, each in parallel within: memory does not grow with their number.
    let mut motions: Vec<Option<Motion>> = Vec::with_capacity(shots.photographs.len());
    for (i, path) in shots.photographs.iter().enumerate() {
        let found = match &first {
            Some(first) if i != reference => {
                let second = read(path)?;
                second.and_then(|second| motion(first, &second))
            }
            _ => None,
        };
        motions.push(found);
    }
    let stillness = against_most(&motions, reference, first.is_some(), reduced, step as f64);
    let certain = |i: usize| {
        let error = motions[i].as_ref().map_or(0.0, |motion| motion.error_px);
        CERTAIN * error * step as f64
    };
    let moved: Vec<Moved> = (stillness.shifts.iter().enumerate())
        .filter_map(|(i, by)| Some((i, (*by)?)))
        .filter(|(i, by)| by.length() > stillness.limit_px.max(certain(*i)))
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

/// Shifts against where most photographs have the sheet: it may be the reference that moved.
fn against_most(
    motions: &[Option<Motion>],
    reference: usize,
    has_reference: bool,
    reduced: [usize; 2],
    step: f64,
) -> Stillness {
    let of = |i: usize| match &motions[i] {
        Some(motion) => Some(motion.farthest(reduced)),
        None => (i == reference && has_reference).then_some(DVec2::ZERO),
    };
    let shifts: Vec<Option<DVec2>> = (0..motions.len()).map(of).collect();
    let compared = shifts.iter().flatten().count();
    let middle = |along: fn(DVec2) -> f64| {
        let mut values: Vec<f64> = shifts.iter().flatten().map(|by| along(*by)).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or_default()
    };
    // Of two, neither is more still than the other.
    let rest = match compared > 2 {
        true => DVec2::new(middle(|by| by.x), middle(|by| by.y)),
        false => DVec2::ZERO,
    };
    let alone = compared < 2;
    Stillness {
        shifts: shifts
            .into_iter()
            .map(|by| by.filter(|_| !alone).map(|by| (by - rest) * step))
            .collect(),
        limit_px: STILL_PX.max(STILL_REDUCED * step),
    }
}
