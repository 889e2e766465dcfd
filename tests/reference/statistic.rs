//! χ² and z.

use recto::reference::Estimate;

/// Chance of a false alarm in one family of tests (OPTICS.md, sampling).
const SIGNIFICANCE: f64 = 0.01;
/// Cells with fewer expected counts are pooled.
const POOLED: f64 = 5.0;
/// Standard deviations between two estimates of one quantity: at most one false alarm in
/// 15 000 comparisons, and the seeds are fixed.
pub const Z_MAX: f64 = 4.0;

/// ln Γ (Lanczos, g = 7, n = 9).
fn ln_gamma(x: f64) -> f64 {
    const C: [f64; 9] = [
        0.999_999_999_999_809_9,
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    let x = x - 1.0;
    let t = x + 7.5;
    let sum: f64 = (1..9).map(|i| C[i] / (x + i as f64)).sum::<f64>() + C[0];
    0.5 * (2.0 * std::f64::consts::PI).ln() + (x + 0.5) * t.ln() - t + sum.ln()
}

/// P(χ² ≥ `x`) with `k` degrees of freedom, by the series of the incomplete Γ function.
pub fn p_value(x: f64, k: f64) -> f64 {
    let (a, x) = (0.5 * k, 0.5 * x);
    if x > a + 40.0 * a.sqrt() + 60.0 {
        return 0.0;
    }
    let mut term = 1.0 / a;
    let mut sum = term;
    let mut i = 1.0;
    while term > 1e-17 * sum {
        term *= x / (a + i);
        sum += term;
        i += 1.0;
    }
    (1.0 - sum * (a * x.ln() - x - ln_gamma(a)).exp()).clamp(0.0, 1.0)
}

/// p of counts against expected counts, small cells pooled.
pub fn chi_square(observed: &[f64], expected: &[f64]) -> f64 {
    let mut cells: Vec<(f64, f64)> = observed
        .iter()
        .zip(expected)
        .map(|(&o, &e)| (o, e))
        .collect();
    cells.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (mut sum, mut count) = (0.0, 0.0);
    let mut pool = (0.0, 0.0);
    for (o, e) in cells {
        pool = (pool.0 + o, pool.1 + e);
        if pool.1 >= POOLED {
            sum += (pool.0 - pool.1).powi(2) / pool.1;
            count += 1.0;
            pool = (0.0, 0.0);
        }
    }
    // What is left over and expected nowhere else.
    if pool.0 > 0.0 || pool.1 > 0.0 {
        sum += (pool.0 - pool.1).powi(2) / pool.1.max(1.0);
        count += 1.0;
    }
    p_value(sum, count - 1.0)
}

/// The p below which one of `tests` fails (Šidák).
pub fn sidak(tests: usize) -> f64 {
    1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / tests as f64)
}

pub fn z(a: &Estimate, b: &Estimate) -> f64 {
    (a.mean - b.mean) / (a.variance + b.variance).sqrt().max(1e-300)
}

pub fn exact(mean: f64) -> Estimate {
    Estimate {
        mean,
        variance: 0.0,
    }
}

/// Mean of many draws.
pub fn mean_of(count: u64, mut draw: impl FnMut() -> f64) -> Estimate {
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..count {
        let x = draw();
        sum += x;
        squares += x * x;
    }
    let count = count as f64;
    let mean = sum / count;
    Estimate {
        mean,
        variance: (squares / count - mean * mean).max(0.0) / count,
    }
}

#[test]
fn p_values_are_the_tables() {
    for (x, k, p) in [
        (3.841_459, 1.0, 0.05),
        (18.307_04, 10.0, 0.05),
        (135.806_7, 100.0, 0.01),
        (0.103, 2.0, 0.9498),
    ] {
        assert!(
            (p_value(x, k) - p).abs() < 1e-4,
            "{x} {k}: {}",
            p_value(x, k)
        );
    }
}
