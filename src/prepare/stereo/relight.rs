//! A photograph that was not taken: under a lamp between others.

use glam::DVec3;
use rayon::prelude::*;

use super::{Rows, Solved, rig::Rig};

/// What rows of a photograph would show under a lamp far away in direction `l`, with gain
/// `gain` (see [`Rig`]): what the normals and albedo say, and of what they leave over (gloss,
/// shadows) the mean of what they leave over under the `nearest` lamps.
pub fn relight(
    solved: &Solved,
    rig: &Rig,
    rows: Rows<'_>,
    l: DVec3,
    gain: f64,
    nearest: usize,
) -> [Vec<f32>; 3] {
    let middle = rig.middle_px;
    let mut near: Vec<usize> = (0..rig.count()).collect();
    let closeness = |i: &usize| rig.lamp(*i, middle).l.dot(l);
    near.sort_by(|a, b| closeness(b).total_cmp(&closeness(a)));
    near.truncate(nearest);
    let lamps: Vec<([f32; 3], f32)> = near
        .iter()
        .map(|&i| {
            let lit = rig.lamp(i, middle);
            (lit.l.as_vec3().into(), lit.gain as f32)
        })
        .collect();
    let facing = |n: &[f32; 3], l: &[f32; 3]| (n[0] * l[0] + n[1] * l[1] + n[2] * l[2]).max(0.0);
    let (l, gain): ([f32; 3], f32) = (l.as_vec3().into(), gain as f32);
    let share = 1.0 / near.len().max(1) as f32;
    let shown = |c: usize| -> Vec<f32> {
        (0..solved.normal.len())
            .into_par_iter()
            .map(|p| {
                let (n, albedo) = (&solved.normal[p], solved.albedo[c][p]);
                let left: f32 = near
                    .iter()
                    .zip(&lamps)
                    .map(|(&i, (to, gain))| rows.planes[i][c][p] / gain - albedo * facing(n, to))
                    .sum();
                ((albedo * facing(n, &l) + left * share) * gain).max(0.0)
            })
            .collect()
    };
    [shown(0), shown(1), shown(2)]
}
