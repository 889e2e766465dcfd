//! Photographs that are left out of the fit, one after another, and computed from the others: what
//! the maps are worth under a lamp that nobody photographed.

use super::{Rig, Rows, Solver, relight};
use crate::prepare::lights::spread;

/// The fewest lamps of which one can be left out.
const FEWEST: usize = 4;
/// How many photographs are left out at most, spread evenly over all.
const MOST: usize = 8;
/// How many rows are looked at, spread evenly over the picture.
const ROWS: usize = 24;
/// Lamps whose photographs stand in for the missing one.
const NEIGHBOURS: usize = 2;

/// How far photographs that were left out are off, in shares of their mean value: roots of the mean
/// square over pixels, colours and photographs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relit {
    /// As computed from normals and albedo.
    pub computed: f64,
    /// Of the mean of the two nearest lamps' photographs, each brought to the lamp's brightness.
    pub neighbours: f64,
    /// How many photographs were left out, each by itself.
    pub photographs: usize,
}

/// As [`Relit`], of one photograph, in shares of its own mean value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelitOne {
    /// Whose lamp it is, counted from 0.
    pub lamp: usize,
    pub computed: f64,
    pub neighbours: f64,
}

/// What is summed over the pixels and colours of a photograph.
#[derive(Clone, Copy, Default)]
struct Sums {
    computed: f64,
    neighbours: f64,
    sum: f64,
    count: f64,
}

impl Sums {
    /// How far it is off as computed, and as its neighbours' mean; `None` where all was dark.
    fn off(&self) -> Option<[f64; 2]> {
        let mean = self.sum / self.count;
        let share = |squares: f64| (squares / self.count).sqrt() / mean;
        (mean > 0.0).then(|| [share(self.computed), share(self.neighbours)])
    }
}

/// Leaves photographs out while bands of rows run through.
pub struct LeftOut {
    rig: Rig,
    /// Without each lamp that is left out.
    others: Vec<(usize, Solver)>,
    /// Of each of these.
    sums: Vec<Sums>,
    /// Of every how many rows one is looked at.
    step: usize,
}

impl LeftOut {
    /// For a picture of `height` rows that `solver` solves. Lamps without which the others do not span
    /// space are not left out.
    pub fn new(solver: &Solver, height: usize) -> Self {
        let count = solver.rig.count();
        let step = count.div_ceil(MOST).max(1);
        let lamps = (0..count).step_by(step).filter(|_| count >= FEWEST);
        let others = lamps.filter_map(|i| {
            let others: Vec<usize> = (0..count).filter(|other| *other != i).collect();
            let rig = solver.rig.only(&others);
            let towards = rig.standing.directions();
            let solver = Solver {
                rig,
                ..solver.clone()
            };
            spread(&towards).is_ok().then_some((i, solver))
        });
        let others: Vec<_> = others.collect();
        Self {
            rig: solver.rig.clone(),
            sums: vec![Sums::default(); others.len()],
            others,
            step: height.div_ceil(ROWS).max(1),
        }
    }

    /// Looks at some of these rows.
    pub fn add(&mut self, rows: Rows<'_>) {
        let width = rows.width;
        let count = rows.planes.first().map_or(0, |planes| planes[0].len());
        if self.others.is_empty() || width == 0 {
            return;
        }
        let step = self.step;
        let wanted = |y: &usize| (rows.top + y) % step == step / 2;
        for y in (0..count / width).filter(wanted) {
            let range = y * width..(y + 1) * width;
            let row: Vec<[Vec<f32>; 3]> = rows
                .planes
                .iter()
                .map(|planes| planes.each_ref().map(|plane| plane[range.clone()].to_vec()))
                .collect();
            for i in 0..self.others.len() {
                self.leave_out(i, &row, rows.top + y);
            }
        }
    }

    fn leave_out(&mut self, which: usize, row: &[[Vec<f32>; 3]], top: usize) {
        let (lamp, solver) = &self.others[which];
        let mut kept = row.to_vec();
        let truth = kept.remove(*lamp);
        let rows = Rows {
            planes: &kept,
            width: truth[0].len(),
            top,
        };
        let solved = solver.solve(rows);
        let middle = self.rig.middle_px;
        let own = self.rig.lamp(*lamp, middle);
        let shown = relight(&solved, &solver.rig, rows, own.l, own.gain, NEIGHBOURS);
        let mut near: Vec<usize> = (0..kept.len()).collect();
        let closeness = |i: &usize| solver.rig.lamp(*i, middle).l.dot(own.l);
        near.sort_by(|a, b| closeness(b).total_cmp(&closeness(a)));
        near.truncate(NEIGHBOURS);
        // A flat diffuser's light under this lamp over that under each of them.
        let flat = |lit: super::rig::Lit| lit.gain * lit.l.z;
        let brought: Vec<f64> = near
            .iter()
            .map(|i| flat(own) / flat(solver.rig.lamp(*i, middle)).max(1e-9))
            .collect();
        let (mut computed, mut neighbours, mut sum) = (0.0, 0.0, 0.0);
        for c in 0..3 {
            for (x, (truth, shown)) in truth[c].iter().zip(&shown[c]).enumerate() {
                let values = near.iter().zip(&brought);
                let around: f64 = values
                    .map(|(i, factor)| f64::from(kept[*i][c][x]) * factor)
                    .sum();
                let truth = f64::from(*truth);
                computed += (f64::from(*shown) - truth).powi(2);
                neighbours += (around / near.len() as f64 - truth).powi(2);
                sum += truth;
            }
        }
        let sums = &mut self.sums[which];
        sums.computed += computed;
        sums.neighbours += neighbours;
        sums.sum += sum;
        sums.count += 3.0 * truth[0].len() as f64;
    }

    /// What came of it; `None` where nothing could be left out, or all was dark.
    pub fn relit(&self) -> Option<Relit> {
        let mut all = Sums::default();
        for sums in &self.sums {
            all.computed += sums.computed;
            all.neighbours += sums.neighbours;
            all.sum += sums.sum;
            all.count += sums.count;
        }
        let [computed, neighbours] = all.off()?;
        Some(Relit {
            computed,
            neighbours,
            photographs: self.others.len(),
        })
    }

    /// The same of each photograph that was left out; those that were all dark are missing.
    pub fn each(&self) -> Vec<RelitOne> {
        let each = self.others.iter().zip(&self.sums);
        each.filter_map(|((lamp, _), sums)| {
            let [computed, neighbours] = sums.off()?;
            Some(RelitOne {
                lamp: *lamp,
                computed,
                neighbours,
            })
        })
        .collect()
    }
}
