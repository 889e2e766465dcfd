//! Photometric stereo: what many lamps show of each place → where it faces, and its albedo
//! (Woodham, *Optical Engineering* 19 (1980) 139).
//!
//! | step | where |
//! |---|---|
//! | lamps as a place sees them, near or far | [`rig`] |
//! | paper's response instead of Lambert's | [`response`] |
//! | least squares of many pixels at once | `block` |
//! | the response divided out, round by round | `fit` |
//! | dark places, whose light is gloss for a good part | `refine` |
//! | light through ink | `film` |
//! | shadows and highlights | `robust` |
//! | photographs that were not taken | [`relight()`] |
//! | how well they are computed, by those that were | [`left_out`] |
//!
//! Photographs come as linear planes, in bands of rows; a band is solved by all processors, row by
//! row, in one pass over its values. Values are f32, as photographs have 16 bits at most; what is
//! summed over pixels is f64.

#![allow(
    clippy::needless_range_loop,
    reason = "several arrays run along one index, as their formulas do"
)]

mod block;
mod film;
mod fit;
pub mod left_out;
mod refine;
mod relight;
pub mod response;
pub mod rig;
mod robust;

use rayon::prelude::*;

use super::capture::Robustness;
pub use relight::relight;
pub use response::{Inked, Paper, Response};
pub use rig::{Gain, Rig, Standing};

use block::{LANES, Lane3};
use fit::{Block, Shown, WEIGHTS};

/// How many times the usual residual a place may leave over before it is looked at closely: 2.7
/// standard deviations with four lamps, more with more.
const CLOSELY: f32 = 4.0;
/// The usual residual is within these shares of a value, whatever the sheet: a photograph's
/// rounding, and a sheet that is all highlights.
const RESIDUALS: [f32; 2] = [0.002, 0.05];
/// Shares of its slope that a dark place is begun with: its gleam has turned it towards a lamp.
const HALF: [f32; 1] = [0.5];
/// And one that is in doubt.
const STARTS: [f32; 3] = [1.0, 0.5, 0.0];
/// Every how manieth block is asked for the usual residual.
const SAMPLED: usize = 23;

/// What is known before stereo.
#[derive(Clone, Debug, PartialEq)]
pub struct Solver {
    pub rig: Rig,
    pub response: Response,
    pub robustness: Robustness,
}

/// Rows of photographs: for each lamp, planes of linear red, green and blue.
#[derive(Clone, Copy)]
pub struct Rows<'b> {
    pub planes: &'b [[Vec<f32>; 3]],
    pub width: usize,
    /// The first row, counted from the top of what is solved.
    pub top: usize,
}

/// What rows of photographs show.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solved {
    /// Unit normals.
    pub normal: Vec<[f32; 3]>,
    /// Linear albedo, red, green and blue, as a reproduction at 45°/0° shows it.
    pub albedo: [Vec<f32>; 3],
    /// Root of the mean square that the photographs leave over, in shares of their mean value;
    /// 0 with three lamps.
    pub residual: Vec<f32>,
    /// How many pixels were looked at closely.
    pub doubted: u64,
}

impl Solved {
    /// For so many pixels; what was there is not cleared.
    fn resize(&mut self, count: usize) {
        self.normal.resize(count, [0.0; 3]);
        for plane in &mut self.albedo {
            plane.resize(count, 0.0);
        }
        self.residual.resize(count, 0.0);
    }
}

impl Solver {
    /// Solves rows of photographs.
    pub fn solve(&self, rows: Rows<'_>) -> Solved {
        let mut solved = Solved::default();
        self.solve_to(rows, &mut solved);
        solved
    }

    /// As [`Self::solve`], in the memory of what was solved before.
    pub fn solve_to(&self, rows: Rows<'_>, solved: &mut Solved) {
        let width = rows.width;
        let count = rows.planes.first().map_or(0, |planes| planes[0].len());
        solved.resize(count);
        if width == 0 || count == 0 || rows.planes.len() != self.rig.count() {
            *solved = Solved::default();
            solved.resize(count);
            return;
        }
        let (light, dark) = self.parts();
        let dark = dark.as_ref();
        let usual = self.usual_residuals(&light, dark, &rows, count / width);
        let limits = usual.map(|usual| CLOSELY * usual);
        let doubts = self.robustness != Robustness::None && self.rig.count() > 3;
        let [red, green, blue] = &mut solved.albedo;
        let out = solved
            .normal
            .par_chunks_mut(width)
            .zip(red.par_chunks_mut(width))
            .zip(green.par_chunks_mut(width))
            .zip(blue.par_chunks_mut(width))
            .zip(solved.residual.par_chunks_mut(width));
        solved.doubted = out
            .enumerate()
            .map(|(y, ((((normal, red), green), blue), residual))| {
                let mut row = Row {
                    normal,
                    albedo: [red, green, blue],
                    residual,
                };
                let mut block = Block::new(&light, rows.planes.len());
                let all: Vec<usize> = (0..width).collect();
                let mut doubted = Vec::new();
                for places in all.chunks(LANES) {
                    block.read(&rows, places, y);
                    row.write(places, &block.solve(&light, &rows, places, y), true);
                }
                if doubts {
                    doubted.extend(all.iter().filter(|x| row.residual[**x] > limits[0]));
                }
                // Those in doubt are gathered: they are few, and take long.
                for places in doubted.chunks(LANES) {
                    block.read(&rows, places, y);
                    let shown = block.solve_doubted(&light, &rows, places, y, usual[0]);
                    row.write(places, &shown, false);
                }
                // As are those that are dark, shadows seen through.
                let Some((dark, below)) = dark else {
                    return doubted.len() as u64;
                };
                let of_dark: Vec<usize> =
                    all.into_iter().filter(|x| row.grey(*x) < *below).collect();
                let mut count = doubted.iter().filter(|x| row.grey(**x) >= *below).count();
                let mut block = Block::new(dark, rows.planes.len());
                let mut doubted: Vec<(usize, [f32; 3], [f32; 3])> = Vec::new();
                for places in of_dark.chunks(LANES) {
                    block.read(&rows, places, y);
                    let known = row.read(places);
                    let known = (&known[0], &known[1]);
                    let shown = block.refine(dark, &rows, (places, y), known, &HALF);
                    for (lane, &x) in places.iter().enumerate() {
                        if doubts && shown.residual[lane] > limits[1] {
                            let (normal, albedo) = known;
                            let [normal, albedo] =
                                [normal, albedo].map(|all| [0, 1, 2].map(|c| all[c][lane]));
                            doubted.push((x, normal, albedo));
                        }
                    }
                    row.write(places, &shown, true);
                }
                count += doubted.len();
                for some in doubted.chunks(LANES) {
                    let places: Vec<usize> = some.iter().map(|(x, ..)| *x).collect();
                    block.read(&rows, &places, y);
                    let mut known = [[[0.0; LANES]; 3]; 2];
                    for (lane, (_, normal, albedo)) in some.iter().enumerate() {
                        for c in 0..3 {
                            known[0][c][lane] = normal[c];
                            known[1][c][lane] = albedo[c];
                        }
                    }
                    let known = (&known[0], &known[1]);
                    let shown = block.refine(dark, &rows, (&places, y), known, &STARTS);
                    row.write(&places, &shown, false);
                }
                count as u64
            })
            .sum();
    }

    /// For what is light, and for what is dark by an albedo below this.
    fn parts(&self) -> (Self, Option<(Self, f32)>) {
        let with = |paper: &Paper| Self {
            response: Response::Paper(paper.clone()),
            ..self.clone()
        };
        match &self.response {
            Response::Inked(inked) => {
                let Inked { paper, dark, below } = &**inked;
                (with(paper), Some((with(dark), *below)))
            }
            _ => (self.clone(), None),
        }
    }

    /// The median residuals of some blocks all over the rows, where it is light and where it is
    /// dark: what is usual on this sheet.
    fn usual_residuals(
        &self,
        light: &Self,
        dark: Option<&(Self, f32)>,
        rows: &Rows<'_>,
        height: usize,
    ) -> [f32; 2] {
        let [least, most] = RESIDUALS;
        if self.rig.count() <= 3 || self.robustness == Robustness::None {
            return [most; 2];
        }
        let across = rows.width.div_ceil(LANES);
        let found: Vec<(bool, f32)> = (0..across * height)
            .into_par_iter()
            .step_by(SAMPLED)
            .flat_map_iter(|i| {
                let (x, y) = (i % across * LANES, i / across);
                let mut block = Block::new(light, rows.planes.len());
                let places: Vec<usize> = (x..rows.width.min(x + LANES)).collect();
                block.read(rows, &places, y);
                let shown = block.solve(light, rows, &places, y);
                let mut found: Vec<(bool, f32)> = (0..places.len())
                    .map(|lane| (false, shown.residual[lane]))
                    .collect();
                if let Some((dark, below)) = dark {
                    let is_dark = |lane: usize| shown.grey(lane) < *below;
                    if (0..places.len()).any(is_dark) {
                        let mut block = Block::new(dark, rows.planes.len());
                        block.read(rows, &places, y);
                        let known = (&shown.normal, &shown.albedo);
                        let inked = block.refine(dark, rows, (&places, y), known, &HALF);
                        for (lane, found) in found.iter_mut().enumerate() {
                            if is_dark(lane) {
                                *found = (true, inked.residual[lane]);
                            }
                        }
                    }
                }
                found
            })
            .filter(|(_, residual)| residual.is_finite())
            .collect();
        [false, true].map(|is_dark| {
            let own = found.iter().filter(|(dark, _)| *dark == is_dark);
            let mut own: Vec<f32> = own.map(|(_, residual)| *residual).collect();
            if own.is_empty() {
                return most;
            }
            let middle = own.len() / 2;
            let (_, median, _) = own.select_nth_unstable_by(middle, f32::total_cmp);
            median.clamp(least, most)
        })
    }
}

/// A row of what comes out.
struct Row<'r> {
    normal: &'r mut [[f32; 3]],
    albedo: [&'r mut [f32]; 3],
    residual: &'r mut [f32],
}

impl Row<'_> {
    /// `plain`: of all photographs alike. Their residual is the one that is told: it says how well
    /// the photographs agree.
    fn write(&mut self, places: &[usize], shown: &Shown, plain: bool) {
        for (lane, &x) in places.iter().enumerate() {
            self.normal[x] = [0, 1, 2].map(|c| shown.normal[c][lane]);
        }
        let residual = plain.then_some((&mut *self.residual, &shown.residual));
        let albedo = self.albedo.iter_mut().map(|plane| &mut **plane);
        for (plane, lanes) in albedo.zip(&shown.albedo).chain(residual) {
            let lanes = &lanes[..places.len()];
            match places {
                [first, .., last] if last - first + 1 == lanes.len() => {
                    let out = &mut plane[*first..=*last];
                    // Of a known length they are copied without a call.
                    match (out.as_mut_array::<LANES>(), lanes.as_array::<LANES>()) {
                        (Some(out), Some(lanes)) => *out = *lanes,
                        _ => out.copy_from_slice(lanes),
                    }
                }
                _ => {
                    for (&x, value) in places.iter().zip(lanes) {
                        plane[x] = *value;
                    }
                }
            }
        }
    }

    /// Normals and albedo of these places.
    fn read(&self, places: &[usize]) -> [Lane3; 2] {
        let mut known = [[[0.0; LANES]; 3]; 2];
        for (lane, &x) in places.iter().enumerate() {
            for c in 0..3 {
                known[0][c][lane] = self.normal[x][c];
                known[1][c][lane] = self.albedo[c][x];
            }
        }
        known
    }

    fn grey(&self, x: usize) -> f32 {
        (0..3).map(|c| WEIGHTS[c] * self.albedo[c][x]).sum()
    }
}
