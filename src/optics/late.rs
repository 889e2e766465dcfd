//! What a rough interface sends back after several bounces: E₂ by direction, roughness and index.
//!
//! The numbers are measured: shares of 2²¹ walks on the facets each
//! ([`sent_back_late`](super::refraction::sent_back_late)), at Chebyshev nodes over √μ and √α and
//! four indices. The ignored test `measure` prints them:
//! `cargo test --release --lib late -- --ignored --nocapture`.

use super::{
    quadrature::{chebyshev, polynomial, through},
    table::{ALPHA_FIT_MIN, ALPHA_TERMS, MU_TERMS},
};

/// Indices of the rows.
const INDICES: [f64; 4] = [1.2, 1.5, 2.0, 3.0];

/// Coefficients of E₂ over powers of √μ, at roughness `alpha` in [0, 1] and index `n` in [1, 3].
pub(super) fn late(alpha: f64, n: f64) -> [f64; MU_TERMS] {
    let low = ALPHA_FIT_MIN.sqrt();
    let s_nodes = chebyshev::<ALPHA_TERMS>().map(|u| low + (1.0 - low) * u);
    let s = alpha.clamp(ALPHA_FIT_MIN, 1.0).sqrt();
    // Nearer to a mirror, fewer facets hide each other.
    let smoother = (alpha / ALPHA_FIT_MIN).clamp(0.0, 1.0);
    let values = std::array::from_fn(|i| {
        let by_index = INDICES.iter().zip(&LATE).map(|(index, of_index)| {
            let by_alpha = std::array::from_fn(|j| of_index[j][i]);
            (
                contrast(*index),
                polynomial(&through(&s_nodes, &by_alpha), s),
            )
        });
        // An index of 1 sends nothing back.
        let (mut below, mut value) = ((0.0, 0.0), 0.0);
        for above in by_index {
            let share = ((contrast(n) - below.0) / (above.0 - below.0)).clamp(0.0, 1.0);
            value = if share > 0.0 {
                below.1 + (above.1 - below.1) * share
            } else {
                value
            };
            below = above;
        }
        (value * smoother).max(0.0)
    });
    through(&chebyshev::<MU_TERMS>(), &values)
}

/// (n − 1)/(n + 1), in which E₂ bends least.
fn contrast(n: f64) -> f64 {
    (n - 1.0) / (n + 1.0)
}

/// E₂ at the nodes: by index, √α, √μ.
#[rustfmt::skip]
const LATE: [[[f64; MU_TERMS]; ALPHA_TERMS]; INDICES.len()] = [
    [
        [0.004123, 0.006141, 0.015370, 0.006575, 0.000855, 0.000130, 0.000039],
        [0.011235, 0.009395, 0.007360, 0.005151, 0.001687, 0.000412, 0.000172],
        [0.014871, 0.013797, 0.009707, 0.004560, 0.001797, 0.000769, 0.000533],
        [0.015441, 0.014695, 0.010770, 0.005013, 0.001859, 0.000839, 0.000650],
    ],
    [
        [0.001553, 0.006065, 0.021369, 0.011041, 0.001970, 0.000443, 0.000210],
        [0.004852, 0.005004, 0.008253, 0.009155, 0.004194, 0.001578, 0.000899],
        [0.010245, 0.009900, 0.008833, 0.006604, 0.004286, 0.002865, 0.002331],
        [0.012627, 0.012513, 0.011105, 0.007246, 0.004251, 0.002988, 0.002704],
    ],
    [
        [0.000927, 0.006584, 0.025177, 0.014033, 0.003083, 0.000983, 0.000598],
        [0.001856, 0.003394, 0.010350, 0.013795, 0.007961, 0.004057, 0.002850],
        [0.005126, 0.006104, 0.009012, 0.010846, 0.010100, 0.008590, 0.007900],
        [0.007519, 0.008677, 0.011215, 0.011539, 0.010294, 0.009275, 0.008966],
    ],
    [
        [0.000752, 0.007213, 0.027638, 0.016390, 0.004708, 0.002043, 0.001466],
        [0.000761, 0.003526, 0.014210, 0.020518, 0.014910, 0.009818, 0.007927],
        [0.001883, 0.004740, 0.013775, 0.022274, 0.025281, 0.025115, 0.024658],
        [0.003036, 0.006667, 0.017185, 0.025962, 0.029234, 0.029710, 0.029603],
    ],
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::refraction::sent_back_late;

    #[test]
    #[ignore = "measures the table: a minute"]
    fn measure() {
        use rayon::prelude::*;
        let low = ALPHA_FIT_MIN.sqrt();
        for n in INDICES {
            println!("    [");
            for u in chebyshev::<ALPHA_TERMS>() {
                let s = low + (1.0 - low) * u;
                let row: Vec<String> = chebyshev::<MU_TERMS>()
                    .into_par_iter()
                    .map(|x| format!("{:.6}", sent_back_late(x * x, s * s, n, 1 << 21)))
                    .collect();
                println!("        [{}],", row.join(", "));
            }
            println!("    ],");
        }
    }

    #[test]
    fn the_table_is_what_the_walk_finds() {
        // Three times the spread of as many walks, and the chord of the fit.
        const NOISE: f64 = 2.5e-3;
        for n in [1.33, 1.5, 1.8] {
            for alpha in [0.12, 0.3, 0.6, 1.0] {
                let coefficients = late(alpha, n);
                for mu in [0.05, 0.2, 0.5, 1.0f64] {
                    let found = polynomial(&coefficients, mu.sqrt());
                    let walked = sent_back_late(mu, alpha, n, 16_384);
                    assert!(
                        (found - walked).abs() < NOISE,
                        "{n} {alpha} {mu}: {found} {walked}"
                    );
                }
            }
        }
    }
}
