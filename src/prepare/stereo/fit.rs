//! Normals and albedo of a block of pixels: paper's response, and ink's, is divided out with the
//! normal so far, and the least squares of the rest gives the next.

#![allow(
    clippy::needless_range_loop,
    reason = "several arrays run along one index, as their formulas do"
)]

use glam::DVec2;
use pulp::{Arch, Simd, WithSimd};

use super::{
    Rows, Solver,
    block::{self, LANES, Lamps, Lane, Lane3, Leaving, ONES, cosine, normals},
    refine::{Found, Task},
    response::Response,
    robust,
};

/// Rounds of a dark place.
const DARK_ROUNDS: usize = 4;

/// What of a colour counts when normals are solved: green has half of a camera's pixels, and the
/// least noise.
pub const WEIGHTS: [f32; 3] = [0.25, 0.5, 0.25];
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
/// What a residual is a share of, at least: in the dark a photograph's rounding is no
/// contradiction.
const DARK: f32 = 0.02;

/// Pixels that are worked on together.
pub struct Block {
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
pub struct Shown {
    pub normal: Lane3,
    pub albedo: Lane3,
    pub residual: Lane,
}

impl Shown {
    /// The mean of all channels of an albedo.
    pub fn grey(&self, lane: usize) -> f32 {
        (0..3).map(|c| WEIGHTS[c] * self.albedo[c][lane]).sum()
    }
}

impl Block {
    pub fn new(solver: &Solver, count: usize) -> Self {
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
    pub fn read(&mut self, rows: &Rows<'_>, places: &[usize], y: usize) {
        let start = y * rows.width;
        let lanes = places.len();
        let (first, last) = (places[0], places[lanes - 1]);
        let together = last - first + 1 == lanes;
        for (i, planes) in rows.planes.iter().enumerate() {
            for (lane, plane) in self.colours[i].iter_mut().zip(planes) {
                let all = plane[start + first..]
                    .first_chunk()
                    .filter(|_| together && lanes == LANES);
                if let Some(all) = all {
                    *lane = *all;
                    continue;
                }
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
    pub fn solve(&mut self, solver: &Solver, rows: &Rows<'_>, places: &[usize], y: usize) -> Shown {
        let lamps = self.lamps(solver, rows, places, y);
        let g = self.facing(solver, &lamps, None);
        let residual = self.residual(&lamps, &g);
        self.shown(solver, lamps, &g, residual, None)
    }

    /// Where photographs contradict each other by more than the `usual` residual.
    pub fn solve_doubted(
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

    /// Dark places, of which normal and albedo are known as of light ones: each is begun with all
    /// these shares of its slope, and what leaves least over is taken.
    pub fn refine(
        &mut self,
        solver: &Solver,
        rows: &Rows<'_>,
        (places, y): (&[usize], usize),
        (normal, albedo): (&Lane3, &Lane3),
        shares: &[f32],
    ) -> Shown {
        let lamps = self.lamps(solver, rows, places, y);
        let Some(paper) = solver.response.paper() else {
            return self.shown(solver, lamps, normal, [0.0; LANES], None);
        };
        let task = Task {
            paper,
            lamps: &lamps,
            colours: &self.colours,
            known: Found::start(paper, normal, albedo, 1.0).slopes,
        };
        let mut best: Option<Found> = None;
        for share in shares {
            let mut found = Found::start(paper, normal, albedo, *share);
            task.settle(&mut found, DARK_ROUNDS);
            match &mut best {
                None => best = Some(found),
                Some(best) => best.or(&found),
            }
        }
        let found = best.unwrap_or_else(|| Found::start(paper, normal, albedo, 1.0));
        let residual = task.residual(&found, DARK);
        let mut albedo = found.body;
        for channel in &mut albedo {
            channel.iter_mut().for_each(|v| *v += paper.floor as f32);
        }
        if lamps.inverse.is_some() {
            self.lamps = Some(lamps);
        }
        Shown {
            normal: found.normals(),
            albedo,
            residual,
        }
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
                    _ => usual.max(NOT_LAMBERT),
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
        Arch::new().dispatch(Facing {
            block: self,
            solver,
            lamps,
            w,
        })
    }

    #[inline(always)]
    fn wide_facing(&mut self, solver: &Solver, lamps: &Lamps, w: Option<&[Lane]>) -> Lane3 {
        let solve = |v: &[Lane]| match w {
            None => block::solve(lamps, v),
            some => block::solve_weighted(lamps, v, some),
        };
        let Some(paper) = solver.response.paper() else {
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
                let (grey, gain) = (&self.grey[i], &lamps.gain[i]);
                let (gleaming, plain) = (&mut self.gleaming[i], &mut self.plain[i]);
                for lane in 0..LANES {
                    let gleam = gain[lane] * mu[lane].max(0.0) * seen.gloss[lane];
                    let share = (gleam / grey[lane].max(1e-6)).clamp(0.0, MOST_GLEAM);
                    let share = share + kept * (gleaming[lane] - share);
                    gleaming[lane] = share;
                    plain[lane] = grey[lane] * (1.0 - share) / seen.diffuse[lane].max(0.3);
                }
            }
            let next = solve(&self.plain);
            let (mut moved, mut length) = ([0.0f32; LANES], [0.0f32; LANES]);
            for c in 0..3 {
                for lane in 0..LANES {
                    moved[lane] = moved[lane].max((next[c][lane] - g[c][lane]).abs());
                    length[lane] = length[lane].max(next[c][lane].abs());
                }
            }
            g = next;
            if block::most(&moved) < STILL * block::most(&length) {
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
        Arch::new().dispatch(Albedo {
            block: self,
            solver,
            lamps,
            normal,
            w,
        })
    }

    #[inline(always)]
    fn wide_albedo(
        &self,
        solver: &Solver,
        lamps: &Lamps,
        normal: &Lane3,
        w: Option<&[Lane]>,
    ) -> Lane3 {
        let mut along = [[0.0f32; LANES]; 3];
        let mut square = [0.0f32; LANES];
        let paper = solver.response.paper();
        let paper = paper.map(|paper| (paper, Leaving::new(paper, normal)));
        for i in 0..lamps.count() {
            let mu = cosine(normal, &lamps.l[i]);
            let seen = paper
                .as_ref()
                .map(|(paper, leaving)| block::response(paper, normal, leaving, lamps, i, &mu));
            let mut factor = [0.0f32; LANES];
            let mut gleam = [0.0f32; LANES];
            let gain = &lamps.gain[i];
            for lane in 0..LANES {
                factor[lane] = gain[lane] * mu[lane].max(0.0);
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
        let floor = solver
            .response
            .paper()
            .map_or(0.0, |paper| paper.floor as f32);
        for along in &mut along {
            for lane in 0..LANES {
                along[lane] = along[lane] / square[lane].max(1e-12) + floor;
            }
        }
        along
    }
}

/// [`Block::facing`], in wide vectors where the processor has them.
struct Facing<'b> {
    block: &'b mut Block,
    solver: &'b Solver,
    lamps: &'b Lamps,
    w: Option<&'b [Lane]>,
}

impl WithSimd for Facing<'_> {
    type Output = Lane3;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Lane3 {
        self.block.wide_facing(self.solver, self.lamps, self.w)
    }
}

/// [`Block::albedo`], likewise.
struct Albedo<'b> {
    block: &'b Block,
    solver: &'b Solver,
    lamps: &'b Lamps,
    normal: &'b Lane3,
    w: Option<&'b [Lane]>,
}

impl WithSimd for Albedo<'_> {
    type Output = Lane3;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Lane3 {
        let Self {
            block,
            solver,
            lamps,
            normal,
            w,
        } = self;
        block.wide_albedo(solver, lamps, normal, w)
    }
}
