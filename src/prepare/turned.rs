//! Lamps that are taken for others a quarter of a turn away.
//!
//! The slopes of a surface have no curl. Turned by a quarter they have nothing else: what was its divergence is
//! their curl. (Turned by a half, hills become hollows, which no photograph contradicts.)

use rayon::prelude::*;

/// Slopes are looked at over so many pixels at once: the finest has the paper's grain, where the coarser ones have
/// less noise.
const CELLS: [usize; 3] = [1, 2, 4];
/// Rows with so many of them in all are looked at, evenly spread: more say nothing new.
const LOOKED_AT: usize = 1 << 18;
/// By how much curl is stronger than divergence, in squares, where lamps are turned. Of noise alone both are alike.
const MOST: f64 = 3.0;
/// Steeper places say more of shadows than of the surface.
const STEEPEST: f64 = 2.0;

/// Whether unit normals (x right, y up, z out) in rows of `width` from the top are turned by a quarter.
pub fn by_a_quarter(normals: &[[f32; 3]], width: usize) -> bool {
    CELLS
        .iter()
        .filter_map(|cell| curl_and_divergence(normals, width, *cell))
        .any(|[curl, divergence]| curl > MOST * divergence)
}

/// Sums of their squares between squares of `cell` pixels; `None` where these are too few.
fn curl_and_divergence(normals: &[[f32; 3]], width: usize, cell: usize) -> Option<[f64; 2]> {
    /// Along each side.
    const FEWEST: usize = 12;
    let size = [width / cell, normals.len() / width.max(1) / cell];
    if size.iter().any(|side| *side < FEWEST) {
        return None;
    }
    let at = |x: usize, y: usize| {
        let (left, top) = (x * cell, y * cell);
        let mut sum = [0.0; 2];
        for y in top..top + cell {
            for [nx, ny, nz] in &normals[y * width + left..y * width + left + cell] {
                let up = f64::from(nz.max(0.05));
                // Down the rows, height falls where the normal leans down.
                sum[0] -= (f64::from(*nx) / up).clamp(-STEEPEST, STEEPEST);
                sum[1] += (f64::from(*ny) / up).clamp(-STEEPEST, STEEPEST);
            }
        }
        sum.map(|v| v / (cell * cell) as f64)
    };
    let row = |y: usize| {
        let (mut curl, mut divergence) = (0.0, 0.0);
        for x in 1..size[0] - 1 {
            let [right, left] = [at(x + 1, y), at(x - 1, y)];
            let [below, above] = [at(x, y + 1), at(x, y - 1)];
            let turns = (below[0] - above[0]) - (right[1] - left[1]);
            let spreads = (right[0] - left[0]) + (below[1] - above[1]);
            if turns.is_finite() && spreads.is_finite() {
                curl += turns * turns;
                divergence += spreads * spreads;
            }
        }
        [curl, divergence]
    };
    // Row by row, so that the sum does not depend on how many processors there are.
    let every = (size[0] * size[1]).div_ceil(LOOKED_AT);
    let rows = (1..size[1] - 1).into_par_iter().step_by(every);
    let rows: Vec<[f64; 2]> = rows.map(row).collect();
    let sum = |which: usize| rows.iter().map(|row| row[which]).sum::<f64>();
    Some([sum(0), sum(1)])
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use rand::{SeedableRng, rngs::Xoshiro256PlusPlus};
    use rand_distr::{Distribution, Normal};

    use super::*;

    /// Of hills, with noise, each normal turned by so many quarters.
    fn normals(hills: f64, noise: f64, quarters: usize) -> Vec<[f32; 3]> {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
        let spread = Normal::new(0.0, noise).expect("a spread");
        (0..96 * 80)
            .map(|i| {
                let (x, y) = ((i % 96) as f64, (i / 96) as f64);
                let slope = [
                    hills * (x / 7.0).cos() * (y / 9.0).cos(),
                    -hills * (x / 7.0).sin() * (y / 9.0).sin() * 7.0 / 9.0,
                ];
                let [mut a, mut b] = slope.map(|v| v + spread.sample(&mut random));
                for _ in 0..quarters {
                    (a, b) = (-b, a);
                }
                DVec3::new(-a, b, 1.0).normalize().as_vec3().into()
            })
            .collect()
    }

    #[test]
    fn of_a_large_sheet_some_rows_tell() {
        // The same hills nine times beside and below each other.
        let small = normals(0.2, 0.02, 1);
        let rows = (0..9 * 80).map(|y| &small[y % 80 * 96..(y % 80 + 1) * 96]);
        let large: Vec<[f32; 3]> = rows.flat_map(|row| row.repeat(9)).collect();
        assert!(large.len() > 2 * LOOKED_AT);
        assert!(by_a_quarter(&large, 9 * 96));
    }

    #[test]
    fn a_quarter_is_seen_and_nothing_else_is_taken_for_one() {
        for quarters in 0..4 {
            let turned = by_a_quarter(&normals(0.2, 0.05, quarters), 96);
            assert_eq!(turned, quarters % 2 == 1, "{quarters}");
        }
        // A flat sheet's noise says nothing, nor do a few pixels.
        assert!(!by_a_quarter(&normals(0.0, 0.1, 1), 96));
        assert!(!by_a_quarter(&normals(0.2, 0.0, 1)[..50], 10));
        assert!(!by_a_quarter(&[], 0));
    }
}
