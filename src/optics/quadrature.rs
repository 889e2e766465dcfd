//! Gauss-Legendre rules: few points for smooth integrands, exact for polynomials of degree
//! 2n − 1.

use std::f64::consts::{FRAC_PI_2, PI};

/// Points along each edge that a rectangle can be sampled at, and rings that a disc can.
pub const GRIDS: std::ops::RangeInclusive<u32> = 1..=7;

/// Nodes on [−1, 1] and weights (of sum 1) of the rules of 1 to 7 points, one after the other (Abramowitz & Stegun, table 25.4).
pub const GAUSS_LEGENDRE: [[f64; 2]; 28] = [
    [0.0, 1.0],
    [-0.5773502691896257, 0.5],
    [0.5773502691896257, 0.5],
    [-0.7745966692414834, 0.27777777777777785],
    [0.0, 0.4444444444444444],
    [0.7745966692414834, 0.27777777777777785],
    [-0.8611363115940526, 0.17392742256872679],
    [-0.33998104358485626, 0.3260725774312732],
    [0.33998104358485626, 0.3260725774312732],
    [0.8611363115940526, 0.17392742256872679],
    [-0.906179845938664, 0.11846344252809464],
    [-0.5384693101056831, 0.23931433524968315],
    [0.0, 0.28444444444444433],
    [0.5384693101056831, 0.23931433524968315],
    [0.906179845938664, 0.11846344252809464],
    [-0.9324695142031519, 0.08566224618958514],
    [-0.6612093864662645, 0.18038078652406936],
    [-0.2386191860831969, 0.23395696728634552],
    [0.2386191860831969, 0.23395696728634552],
    [0.6612093864662645, 0.18038078652406936],
    [0.9324695142031519, 0.08566224618958514],
    [-0.9491079123427586, 0.06474248308443487],
    [-0.7415311855993945, 0.13985269574463843],
    [-0.4058451513773972, 0.19091502525255935],
    [0.0, 0.20897959183673465],
    [0.4058451513773972, 0.19091502525255935],
    [0.7415311855993945, 0.13985269574463843],
    [0.9491079123427586, 0.06474248308443487],
];

/// Node on [−1, 1] and weight of point `i` of the rule of `grid` points, `grid` in [`GRIDS`].
pub fn gauss_legendre(grid: u32, i: u32) -> [f64; 2] {
    GAUSS_LEGENDRE[(grid * (grid - 1) / 2 + i) as usize]
}

/// The first quarter of a ring's azimuths in the rule of `rings` rings: unit vector `i` of
/// `rings`. The other quarters are this one turned.
pub fn disc_spoke(rings: u32, i: u32) -> [f64; 2] {
    let (sin, cos) = ((f64::from(i) + 0.5) / f64::from(rings) * FRAC_PI_2).sin_cos();
    [cos, sin]
}

/// Place on the unit disc and weight (of sum 1) of point `i` of a rule of `rings` rings of
/// 4 `rings` points each, `rings` in [`GRIDS`].
///
/// Even azimuths times Gauss-Legendre over the square of the radius, in which a disc's area is
/// even: exact for polynomials of degree 4 `rings` − 1 in the plane (Abramowitz & Stegun,
/// 25.4.61, gives the first of them).
pub fn disc_rule(rings: u32, i: u32) -> ([f64; 2], f64) {
    let spokes = 4 * rings;
    let [node, weight] = gauss_legendre(rings, i / spokes);
    let [cos, sin] = disc_spoke(rings, i % rings);
    let [x, y] = match i % spokes / rings {
        0 => [cos, sin],
        1 => [-sin, cos],
        2 => [-cos, -sin],
        _ => [sin, -cos],
    };
    let r = (0.5 + 0.5 * node).sqrt();
    ([r * x, r * y], weight / f64::from(spokes))
}

/// Value at `x` of a polynomial, its coefficients from the constant upwards (Horner).
pub fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// Chebyshev nodes on [0, 1], where a polynomial strays least between them.
pub fn chebyshev<const N: usize>() -> [f64; N] {
    std::array::from_fn(|i| 0.5 - 0.5 * (PI * (i as f64 + 0.5) / N as f64).cos())
}

/// Values at `M` Chebyshev nodes of the polynomial of degree `M` − 1 nearest, by least squares, to
/// `values` at `N` ≥ `M` Chebyshev nodes: at these nodes the Chebyshev polynomials are orthogonal
/// (Mason & Handscomb 2003, §4.6), so that the series only has to be cut off.
pub fn chebyshev_fit<const N: usize, const M: usize>(values: &[f64; N]) -> [f64; M] {
    let term =
        |k: usize, i: usize, nodes: usize| (k as f64 * PI * (i as f64 + 0.5) / nodes as f64).cos();
    let series: [f64; M] = std::array::from_fn(|k| {
        let sum: f64 = (0..N).map(|i| values[i] * term(k, i, N)).sum();
        sum * if k == 0 { 1.0 } else { 2.0 } / N as f64
    });
    std::array::from_fn(|j| (0..M).map(|k| series[k] * term(k, j, M)).sum())
}

/// Coefficients of the polynomial through (`nodes`, `values`): Newton's divided differences,
/// then expanded (Björck & Pereyra 1970).
pub fn through<const N: usize>(nodes: &[f64; N], values: &[f64; N]) -> [f64; N] {
    let mut c = *values;
    for k in 0..N {
        for i in (k + 1..N).rev() {
            c[i] = (c[i] - c[i - 1]) / (nodes[i] - nodes[i - k - 1]);
        }
    }
    for k in (0..N).rev() {
        for i in k..N - 1 {
            c[i] -= nodes[k] * c[i + 1];
        }
    }
    c
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_are_exact_up_to_their_degree_and_not_beyond() {
        for grid in GRIDS {
            let integral = |power: i32| -> f64 {
                (0..grid)
                    .map(|i| gauss_legendre(grid, i))
                    .map(|[node, weight]| weight * node.powi(power))
                    .sum()
            };
            for power in 0..2 * grid as i32 {
                // Half of ∫ xᵖ dx over [−1, 1].
                let exact = if power % 2 == 0 {
                    1.0 / f64::from(power + 1)
                } else {
                    0.0
                };
                assert!(
                    (integral(power) - exact).abs() < 1e-14,
                    "{grid} points, x^{power}"
                );
            }
            let beyond = 2 * grid as i32;
            assert!((integral(beyond) - 1.0 / f64::from(beyond + 1)).abs() > 1e-6);
        }
    }

    #[test]
    fn a_polynomial_goes_through_its_nodes() {
        let nodes = chebyshev::<7>();
        let cubic = |x: f64| 1.0 - 2.0 * x + 0.5 * x * x * x;
        let c = through(&nodes, &nodes.map(cubic));
        for (found, expected) in c.iter().zip([1.0, -2.0, 0.0, 0.5, 0.0, 0.0, 0.0]) {
            assert!((found - expected).abs() < 1e-11, "{c:?}");
        }
    }

    #[test]
    fn disc_rules_are_exact_up_to_their_degree() {
        for rings in GRIDS {
            let mean = |p: i32, q: i32| -> f64 {
                (0..4 * rings * rings)
                    .map(|i| disc_rule(rings, i))
                    .map(|([x, y], weight)| weight * x.powi(p) * y.powi(q))
                    .sum()
            };
            // Over the unit disc the mean of r²ᵏ is 1/(k + 1), and that of x²ᵏ is this times
            // the mean of cos²ᵏ, (2k − 1)!!/(2k)!!.
            let mut wallis = 1.0;
            for k in 0..2 * rings as i32 {
                let exact = wallis / f64::from(k + 1);
                assert!(
                    (mean(2 * k, 0) - exact).abs() < 1e-14,
                    "{rings}: x^{}",
                    2 * k
                );
                assert!(
                    (mean(0, 2 * k) - exact).abs() < 1e-14,
                    "{rings}: y^{}",
                    2 * k
                );
                assert!(mean(2 * k + 1, 0).abs() < 1e-14);
                assert!(mean(1, 2 * k).abs() < 1e-14);
                assert!(mean(2 * k, 1).abs() < 1e-14);
                wallis *= f64::from(2 * k + 1) / f64::from(2 * k + 2);
            }
            assert!((mean(4 * rings as i32, 0) - wallis / f64::from(2 * rings + 1)).abs() > 1e-9);
        }
    }
}
