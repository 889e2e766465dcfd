//! Roughness of minified relief.

use recto::optics::relief::{
    Horizon, MARCH_START, horizon_with, march_growth, march_reach, mean_length, rise_of,
    visible_over, widened,
};

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

pub fn judge_relief(gpu: &Gpu) {
    minified().compare(gpu, bsdf()).unwrap();
    marched().compare(gpu, bsdf()).unwrap();
}

#[test]
fn a_broken_widening_is_found() {
    let gpu = Gpu::sampling(BROKEN);
    let narrow = broken("alpha * alpha + slope_variance(length)", "alpha * alpha");
    assert!(minified().compare(&gpu, &narrow).is_err());
}

fn marched() -> Twins {
    Twins {
        name: "a march's reach, steps, horizon and visibility",
        // Lamp's elevation in degrees, room, width of a reading, a rise over the room.
        body: "let e = radians(given[at]);
            let rise = rise_of(vec3(-0.6 * cos(e), 0.8 * cos(e), sin(e)));
            let reach = march_reach(given[at + 1u], rise);
            let near = MARCH_START * given[at + 2u];
            let t = max(near, 0.5 * reach);
            let flat = Horizon(0.0, 1.0);
            let horizon = horizon_with(flat, given[at + 3u] * given[at + 1u], t, given[at + 2u]);
            found[to] = reach;
            found[to + 1u] = march_growth(near, max(reach, near));
            found[to + 2u] = horizon.tangent;
            found[to + 3u] = horizon.softness;
            found[to + 4u] = visible_over(Horizon(given[at + 3u], given[at + 2u]), 0.5);"
            .into(),
        twin: |x| {
            let (sin, cos) = x[0].to_radians().sin_cos();
            let rise = rise_of(DVec3::new(-0.6 * cos, 0.8 * cos, sin));
            let reach = march_reach(x[1], rise);
            let near = MARCH_START * x[2];
            let flat = Horizon {
                tangent: 0.0,
                softness: 1.0,
            };
            let horizon = horizon_with(flat, x[3] * x[1], near.max(0.5 * reach), x[2]);
            let given = Horizon {
                tangent: x[3],
                softness: x[2],
            };
            vec![
                reach,
                march_growth(near, reach.max(near)),
                horizon.tangent,
                horizon.softness,
                visible_over(given, 0.5),
            ]
        },
        relative: |_| RELATIVE,
        cases: grid(&[
            vec![0.1, 1.0, 5.0, 15.0, 45.0, 80.0],
            log_spaced(1e-4, 10.0, 12),
            log_spaced(1e-3, 1.0, 10),
            log_spaced(1e-2, 4.0, 12),
        ]),
    }
}

#[test]
fn a_broken_march_is_found() {
    let gpu = Gpu::sampling(BROKEN);
    for (right, wrong) in [
        ("Horizon(rise / t, width / t)", "Horizon(rise / t, width)"),
        ("(rise * horizon.softness)", "horizon.softness"),
        ("f32(MARCH_STEPS - 1u)", "f32(MARCH_STEPS)"),
    ] {
        assert!(marched().compare(&gpu, &broken(right, wrong)).is_err());
    }
}
