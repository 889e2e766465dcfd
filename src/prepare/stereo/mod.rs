//! Photometric stereo: what many lamps show of each place → where it faces, and its albedo
//! (Woodham, *Optical Engineering* 19 (1980) 139).
//!
//! | step | where |
//! |---|---|
//! | lamps as a place sees them, near or far | [`rig`] |
//! | paper's response instead of Lambert's | [`response`] |
//! | least squares of many pixels at once | `block` |
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
pub mod left_out;
mod relight;
pub mod response;
pub mod rig;
mod robust;

use glam::DVec2;
use rayon::prelude::*;

use super::capture::Robustness;
pub use relight::relight;
pub use response::{Paper, Response};
pub use rig::{Gain, Rig, Standing};

use block::{LANES, Lamps, Lane, Lane3, Leaving, ONES, cosine, normals};

/// What of a colour counts when normals are solved: green has half of a camera's pixels, and the
/// least noise.
const WEIGHTS: [f32; 3] = [0.25, 0.5, 0.25];
/// Rounds in which paper's response is divided out.
const ROUNDS: usize = 6;
/// The largest share of gloss that is taken from a value: the rest is not known well enough.
const MOST_GLEAM: f32 = 0.8;
/// The share of gloss at which a value counts half, where photographs contradict each other.
const DOUBTED_GLEAM: f32 = 0.15;
/// What a round may move g by, in shares of it, to be the last: 0.03°.
const STILL: f32 = 5e-4;
/// How far paper is from a diffuser, in shares of a value.
const NOT_LAMBERT: f32 = 0.05;
/// How often weights are found anew with the normal that they gave.
const BELIEVED: usize = 2;
/// How many times the usual residual a place may leave over before it is looked at closely: 2.7
/// standard deviations with four lamps, more with more.
const CLOSELY: f32 = 4.0;
/// The usual residual is within these shares of a value, whatever the sheet: a photograph's
/// rounding, and a sheet that is all highlights.
const RESIDUALS: [f32; 2] = [0.002, 0.05];
/// What a residual is a share of, at least: in the dark a photograph's rounding is no
/// contradiction.
const DARK: f32 = 0.02;
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

impl Solver {
    /// Solves rows of photographs.
    pub fn solve(&self, rows: Rows<'_>) -> Solved {
        let width = rows.width;
        let count = rows.planes.first().map_or(0, |planes| planes[0].len());
        let mut solved = Solved {
            normal: vec![[0.0; 3]; count],
            albedo: [0, 1, 2].map(|_| vec![0.0; count]),
            residual: vec![0.0; count],
            doubted: 0,
        };
        if width == 0 || count == 0 || rows.planes.len() != self.rig.count() {
            return solved;
        }
        let usual = self.usual_residual(&rows, count / width);
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
                let mut block = Block::new(self, rows.planes.len());
                let mut doubted = Vec::new();
                let limit = CLOSELY * usual;
                let doubts = self.robustness != Robustness::None && self.rig.count() > 3;
                for x in (0..width).step_by(LANES) {
                    let places: [usize; LANES] = std::array::from_fn(|lane| x + lane);
                    let places = &places[..LANES.min(width - x)];
                    block.read(&rows, places, y);
                    let shown = block.solve(self, &rows, places, y);
                    let lanes = places.len();
                    for (lane, normal) in normal[x..x + lanes].iter_mut().enumerate() {
                        *normal = [0, 1, 2].map(|c| shown.normal[c][lane]);
                    }
                    red[x..x + lanes].copy_from_slice(&shown.albedo[0][..lanes]);
                    green[x..x + lanes].copy_from_slice(&shown.albedo[1][..lanes]);
                    blue[x..x + lanes].copy_from_slice(&shown.albedo[2][..lanes]);
                    // Of the plain solution: it tells how well the photographs agree.
                    residual[x..x + lanes].copy_from_slice(&shown.residual[..lanes]);
                    if doubts {
                        let lanes = shown.residual.iter().zip(places);
                        doubted.extend(lanes.filter(|(r, _)| **r > limit).map(|(_, x)| *x));
                    }
                }
                // Those in doubt are gathered: they are few, and take long.
                for places in doubted.chunks(LANES) {
                    block.read(&rows, places, y);
                    let shown = block.solve_doubted(self, &rows, places, y, usual);
                    for (lane, &x) in places.iter().enumerate() {
                        normal[x] = [0, 1, 2].map(|c| shown.normal[c][lane]);
                        red[x] = shown.albedo[0][lane];
                        green[x] = shown.albedo[1][lane];
                        blue[x] = shown.albedo[2][lane];
                    }
                }
                doubted.len() as u64
            })
            .sum();
        solved
    }

    /// The median residual of some blocks all over the rows: what is usual on this sheet.
    fn usual_residual(&self, rows: &Rows<'_>, height: usize) -> f32 {
        let [least, most] = RESIDUALS;
        if self.rig.count() <= 3 || self.robustness == Robustness::None {
            return most;
        }
        let across = rows.width.div_ceil(LANES);
        let mut found: Vec<f32> = (0..across * height)
            .into_par_iter()
            .step_by(SAMPLED)
            .flat_map_iter(|i| {
                let (x, y) = (i % across * LANES, i / across);
                let mut block = Block::new(self, rows.planes.len());
                let places: [usize; LANES] = std::array::from_fn(|lane| x + lane);
                let places = &places[..LANES.min(rows.width - x)];
                block.read(rows, places, y);
                let shown = block.solve(self, rows, places, y);
                shown.residual.into_iter().take(places.len())
            })
            .filter(|residual| residual.is_finite())
            .collect();
        if found.is_empty() {
            return most;
        }
        let middle = found.len() / 2;
        let (_, median, _) = found.select_nth_unstable_by(middle, f32::total_cmp);
        median.clamp(least, most)
    }
}

/// Pixels that are worked on together.
struct Block {
    /// For each lamp and colour.
    colours: Vec<Lane3>,
    /// Their weighted mean.
    grey: Vec<Lane>,
    /// What a diffuser would show instead.
    plain: Vec<Lane>,
    /// The share of gloss in each value.
    gleaming: Vec<Lane>,
    lamps: Option<Lamps>,
}

/// What a block shows.
struct Shown {
    normal: Lane3,
    albedo: Lane3,
    residual: Lane,
}

impl Block {
    fn new(solver: &Solver, count: usize) -> Self {
        let uniform = solver.rig.is_uniform();
        Self {
            colours: vec![[[0.0; LANES]; 3]; count],
            grey: vec![[0.0; LANES]; count],
            plain: vec![[0.0; LANES]; count],
            gleaming: vec![[0.0; LANES]; count],
            lamps: uniform
                .then(|| Lamps::new(&solver.rig, &solver.response, &[DVec2::ZERO; LANES])),
        }
    }

    /// Reads the pixels `places` (at most as many as there are lanes) of row `y`.
    fn read(&mut self, rows: &Rows<'_>, places: &[usize], y: usize) {
        let start = y * rows.width;
        let lanes = places.len();
        let (first, last) = (places[0], places[lanes - 1]);
        let together = last - first + 1 == lanes;
        for (i, planes) in rows.planes.iter().enumerate() {
            for (lane, plane) in self.colours[i].iter_mut().zip(planes) {
                if together {
                    lane[..lanes].copy_from_slice(&plane[start + first..start + first + lanes]);
                } else {
                    for (value, x) in lane.iter_mut().zip(places) {
                        *value = plane[start + x];
                    }
                }
                lane[lanes..].fill(0.0);
            }
            let [r, g, b] = &self.colours[i];
            for lane in 0..LANES {
                self.grey[i][lane] =
                    WEIGHTS[0] * r[lane] + WEIGHTS[1] * g[lane] + WEIGHTS[2] * b[lane];
            }
        }
    }

    fn lamps(&mut self, solver: &Solver, rows: &Rows<'_>, places: &[usize], y: usize) -> Lamps {
        self.lamps.take().unwrap_or_else(|| {
            let at = std::array::from_fn(|lane| {
                let x = places
                    .get(lane)
                    .or(places.last())
                    .copied()
                    .unwrap_or_default();
                DVec2::new(x as f64 + 0.5, (rows.top + y) as f64 + 0.5)
            });
            Lamps::new(&solver.rig, &solver.response, &at)
        })
    }

    /// All photographs believed.
    fn solve(&mut self, solver: &Solver, rows: &Rows<'_>, places: &[usize], y: usize) -> Shown {
        let lamps = self.lamps(solver, rows, places, y);
        let g = self.facing(solver, &lamps, None);
        let residual = self.residual(&lamps, &g);
        self.shown(solver, lamps, &g, residual, None)
    }

    /// Where photographs contradict each other by more than the `usual` residual.
    fn solve_doubted(
        &mut self,
        solver: &Solver,
        rows: &Rows<'_>,
        places: &[usize],
        y: usize,
        usual: f32,
    ) -> Shown {
        let lamps = self.lamps(solver, rows, places, y);
        // More than once: paper's response, which is divided out with the normal so far, is of use
        // only once shadows no longer bend that normal.
        let mut w = self.believed(solver, &lamps, usual, None);
        let mut g = self.facing(solver, &lamps, Some(&w));
        for _ in 0..BELIEVED {
            w = self.believed(solver, &lamps, usual, Some(&g));
            g = self.facing(solver, &lamps, Some(&w));
        }
        let residual = [0.0; LANES];
        self.shown(solver, lamps, &g, residual, Some(&w))
    }

    fn shown(
        &mut self,
        solver: &Solver,
        lamps: Lamps,
        g: &Lane3,
        residual: Lane,
        w: Option<&[Lane]>,
    ) -> Shown {
        let normal = normals(g);
        let albedo = self.albedo(solver, &lamps, &normal, w);
        if lamps.inverse.is_some() {
            self.lamps = Some(lamps);
        }
        Shown {
            normal,
            albedo,
            residual,
        }
    }

    /// Weights of the photographs by what is left over of `g`, or of a first guess.
    fn believed(
        &mut self,
        solver: &Solver,
        lamps: &Lamps,
        usual: f32,
        g: Option<&Lane3>,
    ) -> Vec<Lane> {
        let (g, noise) = match g {
            Some(g) => (*g, usual),
            None => {
                self.plain.copy_from_slice(&self.grey);
                self.gleaming.fill([0.0; LANES]);
                let noise = match solver.response {
                    Response::Lambert => usual,
                    Response::Paper(_) => usual.max(NOT_LAMBERT),
                };
                (block::solve(lamps, &self.plain), noise)
            }
        };
        let mut w = robust::weights(solver.robustness, lamps, &self.plain, &g, noise);
        for (w, gleaming) in w.iter_mut().zip(&self.gleaming) {
            for lane in 0..LANES {
                // What is mostly gleam says little of what is not.
                let share = gleaming[lane] / DOUBTED_GLEAM;
                w[lane] /= 1.0 + share * share;
            }
        }
        w
    }

    /// The normal times the albedo; leaves in `plain` what a diffuser would show.
    fn facing(&mut self, solver: &Solver, lamps: &Lamps, w: Option<&[Lane]>) -> Lane3 {
        let solve = |v: &[Lane]| match w {
            None => block::solve(lamps, v),
            some => block::solve_weighted(lamps, v, some),
        };
        let Response::Paper(paper) = &solver.response else {
            self.plain.copy_from_slice(&self.grey);
            return solve(&self.plain);
        };
        if w.is_none() {
            self.plain.copy_from_slice(&self.grey);
            self.gleaming.fill([0.0; LANES]);
        }
        let mut g = solve(&self.plain);
        for round in 0..ROUNDS {
            // Half of a step: a narrow gleam turns the normal, which moves the gleam. Of nothing, the
            // first guess is nearer.
            let kept = if round == 0 && w.is_none() { 0.0 } else { 0.5 };
            let n = normals(&g);
            let leaving = Leaving::new(paper, &n);
            for i in 0..lamps.count() {
                let mu = cosine(&n, &lamps.l[i]);
                let seen = block::response(paper, &n, &leaving, lamps, i, &mu);
                for lane in 0..LANES {
                    let grey = self.grey[i][lane];
                    let gleam = lamps.gain[i][lane] * mu[lane].max(0.0) * seen.gloss[lane];
                    let share = (gleam / grey.max(1e-6)).clamp(0.0, MOST_GLEAM);
                    let share = share + kept * (self.gleaming[i][lane] - share);
                    self.gleaming[i][lane] = share;
                    self.plain[i][lane] = grey * (1.0 - share) / seen.diffuse[lane].max(0.3);
                }
            }
            let next = solve(&self.plain);
            let (mut moved, mut length) = (0.0f32, 0.0f32);
            for c in 0..3 {
                for lane in 0..LANES {
                    moved = moved.max((next[c][lane] - g[c][lane]).abs());
                    length = length.max(next[c][lane].abs());
                }
            }
            g = next;
            if moved < STILL * length {
                break;
            }
        }
        g
    }

    fn residual(&self, lamps: &Lamps, g: &Lane3) -> Lane {
        let mut residual = [0.0; LANES];
        let spare = lamps.count().saturating_sub(3);
        if spare == 0 {
            return residual;
        }
        let mut mean = [0.0; LANES];
        for i in 0..lamps.count() {
            let facing = cosine(g, &lamps.l[i]);
            for lane in 0..LANES {
                let off = self.plain[i][lane] - lamps.gain[i][lane] * facing[lane];
                residual[lane] += off * off;
                mean[lane] += self.plain[i][lane].abs();
            }
        }
        for lane in 0..LANES {
            let mean = (mean[lane] / lamps.count() as f32).max(DARK);
            residual[lane] = (residual[lane] / spare as f32).sqrt() / mean;
        }
        residual
    }

    /// For each colour the least squares with the normal known.
    fn albedo(&self, solver: &Solver, lamps: &Lamps, normal: &Lane3, w: Option<&[Lane]>) -> Lane3 {
        let mut along = [[0.0f32; LANES]; 3];
        let mut square = [0.0f32; LANES];
        let paper = match &solver.response {
            Response::Lambert => None,
            Response::Paper(paper) => Some((paper, Leaving::new(paper, normal))),
        };
        for i in 0..lamps.count() {
            let mu = cosine(normal, &lamps.l[i]);
            let seen = paper
                .as_ref()
                .map(|(paper, leaving)| block::response(paper, normal, leaving, lamps, i, &mu));
            let mut factor = [0.0f32; LANES];
            let mut gleam = [0.0f32; LANES];
            for lane in 0..LANES {
                factor[lane] = lamps.gain[i][lane] * mu[lane].max(0.0);
            }
            if let Some(seen) = &seen {
                for lane in 0..LANES {
                    gleam[lane] = factor[lane] * seen.gloss[lane];
                    factor[lane] *= seen.diffuse[lane];
                }
            }
            let weights = w.map_or(&ONES, |w| &w[i]);
            let mut weighted = [0.0f32; LANES];
            for lane in 0..LANES {
                weighted[lane] = factor[lane] * weights[lane];
                square[lane] += weighted[lane] * factor[lane];
            }
            for (along, colour) in along.iter_mut().zip(&self.colours[i]) {
                for lane in 0..LANES {
                    along[lane] += weighted[lane] * (colour[lane] - gleam[lane]);
                }
            }
        }
        let floor = match &solver.response {
            Response::Lambert => 0.0,
            Response::Paper(paper) => paper.floor as f32,
        };
        for along in &mut along {
            for lane in 0..LANES {
                along[lane] = along[lane] / square[lane].max(1e-12) + floor;
            }
        }
        along
    }
}
