//! The baselines of the ladder.

use recto::{optics::baselines::*, sheet::PAPER_BASELINES};

use super::*;

pub fn physics() -> String {
    format!("{}\n{}", bsdf(), gpu::baselines())
}

/// sin², or 1 − cos, from what f32 can hardly tell from 0 up to both ends.
fn shares() -> Vec<f32> {
    let mut shares = log_spaced(1e-14, 1.0, 100);
    shares.extend(log_spaced(1e-7, 0.5, 30).iter().map(|x| 1.0 - x));
    shares.extend([0.0, 0.5]);
    shares
}

/// A function of a share and a second number.
fn of_two(name: &'static str, twin: fn(&[f64]) -> Vec<f64>, second: Vec<f32>) -> Twins {
    Twins {
        name,
        body: format!("found[to] = {name}(given[at], given[at + 1u]);"),
        twin,
        relative: |_| RELATIVE,
        cases: grid(&[shares(), second]),
    }
}

fn helpers() -> [Twins; 8] {
    let of_one = |name: &'static str, twin: fn(&[f64]) -> Vec<f64>, cases: Vec<f32>| Twins {
        name,
        body: format!("found[to] = {name}(given[at]);"),
        twin,
        relative: |_| RELATIVE,
        cases: grid(&[cases]),
    };
    let mut exponents = log_spaced(1e-3, 2e8, 60);
    exponents.push(0.0);
    let mut near_one = alphas();
    near_one.extend(log_spaced(1e-6, 0.5, 20).iter().map(|x| 1.0 - x));
    [
        of_one(
            "exponent_blinn",
            |x| vec![exponent_blinn(x[0])],
            near_one.clone(),
        ),
        of_one("exponent_phong", |x| vec![exponent_phong(x[0])], near_one),
        of_one("angle_squared", |x| vec![angle_squared(x[0])], shares()),
        of_two(
            "power_below_one",
            |x| vec![power_below_one(x[0], x[1])],
            exponents.clone(),
        ),
        of_two(
            "lobe_phong",
            |x| vec![lobe_phong(x[0], x[1])],
            exponents.clone(),
        ),
        of_two("d_blinn", |x| vec![d_blinn(x[0], x[1])], exponents),
        of_two("d_gauss", |x| vec![d_gauss(x[0], x[1])], alphas()),
        of_two("d_beckmann", |x| vec![d_beckmann(x[0], x[1])], alphas()),
    ]
}

/// The cases of the tiers, with the eye's distance from the mirrored light instead of a table.
fn cases() -> Vec<Vec<f32>> {
    let seeded = Seeded::new(11);
    brdf_cases()
        .into_iter()
        .map(|mut case| {
            case[11] = seeded.log_or_zero(1e-14, 2.0) as f32;
            case
        })
        .collect()
}

type Baseline = fn(&Surface, &Facing, f64) -> DVec3;

macro_rules! baselines {
    ($($name:literal = $call:literal, $twin:expr;)+) => {
        vec![$(Twins {
            name: $name,
            body: brdf_body($call),
            twin: |x| {
                let twin: Baseline = $twin;
                let (s, g, ..) = brdf_inputs(x);
                twin(&s, &g, x[11]).to_array().to_vec()
            },
            relative: |x| near_mirror(x[3]),
            cases: cases(),
        }),+]
    };
}

fn baselines() -> Vec<Twins> {
    baselines! {
        "v_groove" = "vec3(v_groove(g))", |_, g, _| DVec3::splat(v_groove(g));
        "brdf_facets" = "brdf_facets(s, g, given[at + 11u])", brdf_facets;
        "phong" = "brdf_phong(s, given[at + 11u])", |s, _, off| brdf_phong(s, off);
        "phong-plain" = "brdf_phong_plain(s, g, given[at + 11u])", brdf_phong_plain;
        "blinn-phong" = "brdf_blinn_phong(s, g)", |s, g, _| brdf_blinn_phong(s, g);
        "blinn-phong-plain" = "brdf_blinn_phong_plain(s, g)",
            |s, g, _| brdf_blinn_phong_plain(s, g);
        "cook-torrance" = "brdf_cook_torrance(s, g)", |s, g, _| brdf_cook_torrance(s, g);
        "cook-torrance-gauss" = "brdf_cook_torrance_gauss(s, g)",
            |s, g, _| brdf_cook_torrance_gauss(s, g);
        "cook-torrance-blinn" = "brdf_cook_torrance_blinn(s, g)",
            |s, g, _| brdf_cook_torrance_blinn(s, g);
        "oren-nayar" = "brdf_oren_nayar(s, g)", |s, g, _| brdf_oren_nayar(s, g);
        "burley" = "brdf_burley(s, g)", |s, g, _| brdf_burley(s, g);
        "isle" = "brdf_isle(s, g)", |s, g, _| brdf_isle(s, g);
    }
}

/// The function or baseline of this name.
pub fn compare(name: &str, gpu: &Gpu, physics: &str) -> Result<f64, String> {
    let mut twins = helpers().into_iter().chain(baselines());
    let twins = twins.find(|twins| twins.name == name).expect(name);
    twins.compare(gpu, physics)
}

pub fn judge_baselines(gpu: &Gpu) {
    let faults: Vec<String> = helpers()
        .into_iter()
        .chain(baselines())
        .filter_map(|twins| twins.compare(gpu, &physics()).err())
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Eyes off the mirrored light.
pub fn judge_off_mirror(gpu: &Gpu) {
    let cases: Vec<Vec<f32>> = facing_cases();
    let twins = Twins {
        name: "off_mirror",
        body: "found[to] = off_mirror(vec3(given[at], given[at + 1u], given[at + 2u]),
                vec3(given[at + 3u], given[at + 4u], given[at + 5u]),
                vec3(given[at + 6u], given[at + 7u], given[at + 8u]));"
            .into(),
        twin: |x| {
            let [n, l, v] = [0, 3, 6].map(|i| DVec3::from_slice(&x[i..]));
            vec![off_mirror(n, l, v)]
        },
        relative: |_| RELATIVE,
        cases,
    };
    let found = twins.found(gpu, &physics());
    let cases = twins.cases(gpu);
    let pairs: Vec<Pair> = cases
        .iter()
        .zip(&found)
        .map(|(case, &found)| {
            let expected = (twins.twin)(&widen(case))[0];
            let mut pair = Pair::new(found, expected, RELATIVE);
            // Each component of the distance is rounded like a product of unit vectors.
            let apart = (2.0 * expected).sqrt();
            pair.allowed += (apart + UNIT_PRODUCT) * 2.0 * UNIT_PRODUCT;
            pair
        })
        .collect();
    judge(twins.name, &pairs, |i| format!("{:?}", cases[i])).unwrap();
}

#[test]
fn broken_baselines_are_found() {
    let gpu = Gpu::sampling(BROKEN);
    for (name, sound, wrong) in [
        ("power_below_one", "x < 0.5);", "x < 0.0);"),
        ("angle_squared", "16.0 * t * (1.0 + series)", "16.0 * t"),
        ("blinn-phong", "exp2(-0.5 * min", "exp2(0.5 * min"),
        (
            "cook-torrance",
            "0.25 * min(1.0, open",
            "INV_PI * min(1.0, open",
        ),
        ("oren-nayar", "along / max(", "along / min("),
        ("isle", "0.5 + 2.0 * sqrt(s.alpha)", "0.5 + 2.0 * s.alpha"),
    ] {
        assert!(
            PAPER_BASELINES.contains(sound),
            "{sound} is not in the shader"
        );
        let text = format!("{PAPER_BSDF}\n{}", PAPER_BASELINES.replace(sound, wrong));
        let outcome = compare(name, &gpu, &text);
        assert!(outcome.is_err(), "{name}: {wrong} passed: {outcome:?}");
    }
}
