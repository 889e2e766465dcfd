//! Roughness of minified relief.

use recto::optics::relief::{mean_length, widened};

use super::*;

fn minified() -> Twins {
    let mut lengths = log_spaced(1e-6, 1.0, 80)
        .iter()
        .map(|x| 1.0 - x)
        .collect::<Vec<f32>>();
    lengths.extend([1.0, 1.0001, 2.0]);
    Twins {
        name: "mean_length and widened",
        body: "let length = mean_length(vec3(0.6, 0.0, 0.8) * given[at + 1u]);
            found[to] = length;
            found[to + 1u] = widened(given[at], length);"
            .into(),
        twin: |x| {
            let length = mean_length(DVec3::new(f64::from(0.6f32), 0.0, f64::from(0.8f32)) * x[1]);
            vec![length, widened(x[0], length)]
        },
        // 1 − ℓ² cancels to some roundings of 1, beside the α² of a near-mirror: up to 3e-7
        // of 1e-8. From α = .05 on that is 6e-5 of α'.
        relative: |_| RELATIVE,
        cases: grid(&[log_spaced(0.05, 1.0, 40), lengths]),
    }
}

#[test]
fn relief_widens_alike() {
    let gpu = Gpu::new();
    minified().compare(&gpu, PAPER_BSDF).unwrap();
    let narrow = broken("alpha * alpha + slope_variance(length)", "alpha * alpha");
    assert!(minified().compare(&gpu, &narrow).is_err());
}
