//! Small linear systems, in f64.

#![allow(
    clippy::needless_range_loop,
    reason = "several arrays run along one index, as their formulas do"
)]

/// Solves the symmetric positive system `a x = b` of `b.len()` unknowns for each right side in
/// turn, by Cholesky's factors. `None` where it is singular to rounding.
pub fn solve_positive(a: &[Vec<f64>], right: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let n = a.len();
    let mut l = vec![vec![0.0; n]; n];
    let scale = (0..n).map(|i| a[i][i].abs()).fold(0.0, f64::max);
    for i in 0..n {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
            let rest = a[i][j] - known;
            if i == j {
                if rest.is_nan() || rest <= scale * 1e-14 {
                    return None;
                }
                l[i][i] = rest.sqrt();
            } else {
                l[i][j] = rest / l[j][j];
            }
        }
    }
    let solve = |b: &Vec<f64>| {
        let mut y = vec![0.0; n];
        for i in 0..n {
            let known: f64 = (0..i).map(|k| l[i][k] * y[k]).sum();
            y[i] = (b[i] - known) / l[i][i];
        }
        let mut x = vec![0.0; n];
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|k| l[k][i] * x[k]).sum();
            x[i] = (y[i] - known) / l[i][i];
        }
        x
    };
    Some(right.iter().map(solve).collect())
}

/// Weighted least squares: for each right side the x that makes Σ w (row·x − b)² least, with a
/// `ridge` (relative to the mean of the squares) that keeps it finite where rows say nothing.
pub fn least_squares(
    rows: &[Vec<f64>],
    weights: &[f64],
    right: &[Vec<f64>],
    ridge: f64,
) -> Option<Vec<Vec<f64>>> {
    let n = rows.first()?.len();
    let mut a = vec![vec![0.0; n]; n];
    for (row, weight) in rows.iter().zip(weights) {
        for i in 0..n {
            for j in 0..n {
                a[i][j] += weight * row[i] * row[j];
            }
        }
    }
    let mean = (0..n).map(|i| a[i][i]).sum::<f64>() / n as f64;
    for (i, row) in a.iter_mut().enumerate() {
        row[i] += ridge * mean;
    }
    let sides: Vec<Vec<f64>> = right
        .iter()
        .map(|b| {
            (0..n)
                .map(|i| {
                    let terms = rows.iter().zip(weights).zip(b);
                    terms.map(|((row, w), b)| w * row[i] * b).sum()
                })
                .collect()
        })
        .collect();
    solve_positive(&a, &sides)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_and_a_singular_system_is_refused() {
        let rows: Vec<Vec<f64>> = (0..5).map(|i| vec![1.0, f64::from(i)]).collect();
        let b = (0..5).map(|i| 2.0 - 0.5 * f64::from(i)).collect();
        let x = least_squares(&rows, &[1.0; 5], &[b], 0.0).expect("a line");
        assert!((x[0][0] - 2.0).abs() < 1e-12 && (x[0][1] + 0.5).abs() < 1e-12);
        let same: Vec<Vec<f64>> = vec![vec![1.0, 1.0]; 3];
        assert_eq!(least_squares(&same, &[1.0; 3], &[vec![1.0; 3]], 0.0), None);
    }
}
