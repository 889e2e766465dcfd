//! Every function of the shipped physics at the extremes of everything, a million tuples and more.
//!
//! Parts that other tests reach through a tier alone are called here by themselves, where a fault
//! of theirs cannot hide behind a larger term. `numbers!` writes a body that reads its inputs in
//! order.

use std::sync::Arc;

use glam::{DVec2, DVec3, DVec4};
use recto::{
    optics::{
        ink::{
            Film, beyond_capture, capture_path, inner_cosine, internal_reflectance, optical_depth,
        },
        microfacet::v_hammon,
        refraction::{PathTable, crossed, mean_inner_cosine, smooth_cosine, steeper_by},
        relief::{SHORTENING_NOISE, march_reach, mean_length, rise_of, slope_variance, widened},
        slab::Phase,
        study::{
            Split, phase_function, phase_lobe, single_scatter, split_even, split_mean, split_shape,
        },
        table::InterfaceTable,
        through::{KEPT_WITHIN, Seen, Through, crossing},
        tier::{albedo_of, brdf_gallery_specular},
    },
    sheet::{PAPER_BASELINES, PAPER_MEDIA, uniform::FilmUniform},
};

use super::{
    baselines,
    interfaces::{compare_interfaces, words},
    *,
};
use crate::{
    lamps::{judge_angles, judge_lamps},
    media::judge_media,
    relief::judge_relief,
    study::{compare_paths, judge_facets, judge_study},
};

/// The issue asks for a million tuples on the device.
const TUPLES: usize = 1_000_000;
/// One azimuth of combed_capture, which is called.
const PLACE_OF_ANOTHER: &str = "combed_capture_at";
/// Cases of each function here.
const CASES: usize = 40_000;

fn cases(seed: u64, case: impl Fn(&Seeded) -> Vec<f64>) -> Vec<Vec<f32>> {
    let seeded = Seeded::new(seed);
    (0..CASES)
        .map(|_| case(&seeded).into_iter().map(|x| x as f32).collect())
        .collect()
}

/// `given[at]`, `given[at + 1u]` … as one vector of the shader.
fn vector(from: usize) -> String {
    format!(
        "vec3(given[at + {from}u], given[at + {}u], given[at + {}u])",
        from + 1,
        from + 2
    )
}

fn colours(from: usize, f: &str) -> String {
    format!(
        "let c{from} = {f}; found[to + {from}u] = c{from}.x; found[to + {}u] = c{from}.y; \
         found[to + {}u] = c{from}.z;",
        from + 1,
        from + 2
    )
}

/// Within the shares of a surface: what the terms of a difference of albedos are rounded by.
fn surfaces() -> (Twins, impl Fn(&[f64]) -> f64) {
    let twins = Twins {
        name: "capture_floor, albedo_of, brdf_gallery_specular, v_hammon",
        body: format!(
            "{BRDF_INPUTS} found[to] = capture_floor(s, mean);
            found[to + 1u] = brdf_gallery_specular(s, g, at_i, at_o, mean);
            found[to + 2u] = v_hammon(g.mu_i, g.mu_o, s.alpha);
            let a = albedo_of(s, mean);
            found[to + 3u] = a.x; found[to + 4u] = a.y; found[to + 5u] = a.z;"
        ),
        twin: |x| {
            let (s, g, at_i, at_o, mean) = brdf_inputs(x);
            let gloss = brdf_gallery_specular(&s, &g, &at_i, &at_o, &mean);
            let hammon = v_hammon(g.mu_i, g.mu_o, s.alpha);
            let albedo = albedo_of(&s, &mean).to_array();
            [&[capture_floor(&s, &mean), gloss, hammon][..], &albedo].concat()
        },
        relative: |x| near_mirror(x[3]),
        cases: brdf_cases(),
    };
    let rounding = |x: &[f64]| {
        let (s, _, _, _, mean) = brdf_inputs(x);
        (s.albedo.max_element() + capture_floor(&s, &mean)) * UNIT_PRODUCT
    };
    (twins, rounding)
}

/// Cosines beyond 1 as rounding makes them, and indices down to none and from inside.
fn inner_cosines() -> Twins {
    let mut etas: Vec<f32> = log_spaced(1e-3, 2.0, 40).iter().map(|x| 1.0 + x).collect();
    etas.extend([0.5, 0.9, 1.0]);
    let mut mus = cosines();
    mus.extend([0.0, 1.0 + f32::EPSILON]);
    Twins {
        name: "inner_cosine, smooth_cosine",
        body: "found[to] = inner_cosine(given[at], given[at + 1u]);
            found[to + 1u] = smooth_cosine(given[at], given[at + 1u]);"
            .into(),
        twin: |x| vec![inner_cosine(x[0], x[1]), smooth_cosine(x[0], x[1])],
        relative: |_| RELATIVE,
        cases: grid(&[mus, etas]),
    }
}

/// Paths as an interface of this index and roughness has them, towards these cosines.
fn paths_of(seeded: &Seeded, tables: &[(f64, f64, PathTable)], count: usize) -> Vec<f64> {
    let (_, alpha, table) = &tables[seeded.bits() as usize % tables.len()];
    let at = |_| table.at(seeded.log_or_zero(1e-4, 1.0), *alpha).to_array();
    (0..count).flat_map(at).collect()
}

/// From hardly any refraction to a diamond's, from mirrors to the roughest.
fn path_tables() -> Vec<(f64, f64, PathTable)> {
    [(1.01, 0.4), (1.33, 0.0), (1.5, 0.4), (1.5, 1.0), (2.5, 0.2)]
        .map(|(n, alpha)| (n, alpha, PathTable::at_roughness(alpha, n)))
        .into()
}

/// Light along paths through films of any depth.
fn films_crossed() -> Twins {
    let tables = path_tables();
    let four = |from: usize| {
        let each: Vec<String> = (from..from + 4)
            .map(|i| format!("given[at + {i}u]"))
            .collect();
        format!("vec4({})", each.join(", "))
    };
    Twins {
        name: "beyond_capture, crossed, mean_inner_cosine, steeper_by",
        body: format!(
            "let capture = {} + {}; let path_i = {}; let path_o = {};
            {} {} {} found[to + 9u] = mean_inner_cosine(path_i);",
            four(3),
            four(7),
            four(11),
            four(15),
            colours(
                0,
                &format!("beyond_capture({}, capture, path_i, path_o)", vector(0))
            ),
            colours(3, &format!("crossed(path_i, {})", vector(0))),
            colours(6, &format!("steeper_by(path_i, {})", vector(0))),
        ),
        twin: |x| {
            let four = |i: usize| DVec4::from_slice(&x[i..]);
            let (tau, capture) = (DVec3::from_slice(x), four(3) + four(7));
            let beyond = beyond_capture(tau, capture, four(11), four(15)).to_array();
            let through = crossed(four(11), tau).to_array();
            let steeper = steeper_by(four(11), tau).to_array();
            let mean = mean_inner_cosine(four(11));
            [&beyond[..], &through, &steeper, &[mean]].concat()
        },
        relative: |_| RELATIVE,
        cases: cases(21, |seeded| {
            let depth = || seeded.log_or_zero(1e-6, 20.0);
            let mut case = vec![depth(), depth(), depth()];
            case.extend(paths_of(seeded, &tables, 4));
            case
        }),
    }
}

/// What the terms of a path are rounded by, times the depth (the exponent's error) and alone.
fn path_rounding(x: &[f64]) -> (f64, f64) {
    let terms: f64 = x[3..19].iter().map(|c| c.abs()).sum();
    let deepest = x[..3].iter().copied().fold(0.0, f64::max);
    (terms * UNIT_PRODUCT * (1.0 + deepest), terms * UNIT_PRODUCT)
}

fn through_of(x: &[f64]) -> (Through, Seen) {
    let v = |i: usize| DVec3::from_slice(&x[i..]);
    let through = Through {
        reflected: v(0),
        inner_mean: x[22],
        transmitted: v(3),
        reflected_leaning: v(6),
        transmitted_leaning: v(9),
        ..Through::default()
    };
    let seen = Seen {
        depth_f: DVec3::ZERO,
        clear: x[18],
        depth_b: DVec3::ZERO,
        rho_f: v(12),
        rho_b: v(15),
    };
    (through, seen)
}

/// Light between both sides of the paper, down to sheets that give back all between mirrors.
fn crossings() -> Twins {
    Twins {
        name: "crossing",
        body: format!(
            "let none = vec3(0.0);
            let through = Through({}, given[at + 22u], {}, none, {}, {}, none, none,
                array(none, none, none, none, none), none);
            let seen = Seen(none, given[at + 18u], none, {}, {});
            {}",
            vector(0),
            vector(3),
            vector(6),
            vector(9),
            vector(12),
            vector(15),
            colours(
                0,
                "crossing(through, seen, given[at + 19u], vec3(given[at + 20u]), given[at + 21u])"
            ),
        ),
        twin: |x| {
            let (through, seen) = through_of(x);
            let crossed = crossing(&through, &seen, x[19], DVec3::splat(x[20]), x[21]);
            crossed.to_array().to_vec()
        },
        relative: |_| RELATIVE,
        cases: cases(24, |seeded| {
            let share = || seeded.log_or_zero(1e-6, 1.0);
            // R0 up to 1, T0 of what is left, and how both lean with the light.
            let r = [(); 3].map(|()| 1.0 - share());
            let t = r.map(|r| (1.0 - r) * share());
            let mut case = [r, t].concat();
            case.extend(t.map(|t| t * share()));
            case.extend(t.map(|t| t * share()));
            // ρ on both sides, up to a mirror's.
            case.extend((0..6).map(|_| match seeded.bits() % 8 {
                0 => 1.0,
                _ => share(),
            }));
            case.extend([seeded.log_or_zero(1e-2, 1e3), share(), share()]);
            case.push(1.0 + seeded.log(1e-2, 2.0));
            case.push(share());
            case
        }),
    }
}

/// What the rounding of light between both sides costs what crosses: differences of shares, over
/// the passes, which may nearly cancel.
fn crossing_rounding(x: &[f64]) -> f64 {
    let (through, seen) = through_of(x);
    let t = (through.transmitted * seen.clear).min(through.reflected + through.transmitted);
    let r = through.reflected + through.transmitted - t;
    let (f, b) = (seen.rho_f, seen.rho_b);
    let (f, b) = (KEPT_WITHIN * f, KEPT_WITHIN * b);
    let passes = (1.0 - r * f) * (1.0 - r * b) - t * t * f * b;
    let most = 1.0 + 2.0 * (through.transmitted_leaning + through.reflected_leaning * seen.clear);
    let terms = t * most * most;
    let crossed = crossing(&through, &seen, x[19], DVec3::splat(x[20]), x[21]);
    let rounded = terms / (x[21] * x[21] * passes) + crossed / passes;
    rounded.max_element() * 2.0 * UNIT_PRODUCT
}

fn split_of(x: &[f64]) -> Split {
    Split {
        kappa: DVec3::from_slice(x),
        mean: x[3],
        at_capture: DVec3::from_slice(&x[4..]),
        depth: x[7],
        leaning: DVec3::from_slice(&x[19..]),
        inner_mean: x[22],
        alike: x[8],
        captured: x[19] + x[20],
        of_direction: DVec4::from_slice(&x[23..]),
        phase: Phase {
            forward_share: x[8],
            g_forward: x[9],
            g_backward: x[10],
        },
    }
}

/// Lobes, both together, light scattered once, and its share: cosines of the deflection up to both
/// ends, slabs from a film of next to nothing on.
fn scattering() -> Twins {
    Twins {
        name: "phase_lobe, phase_function, single_scatter, split_mean, split_shape, split_even",
        body: format!(
            "let split = Split({}, given[at + 3u], {}, given[at + 7u], {}, given[at + 22u],
                given[at + 8u], given[at + 19u] + given[at + 20u], vec4({}, given[at + 26u]), given[at + 8u], given[at + 9u], given[at + 10u]);
            let g = Facing(given[at + 11u], given[at + 12u], given[at + 13u], 0.0);
            {} found[to + 6u] = split_mean(split, g.mu_i);
            let depth = vec3(given[at + 7u], given[at + 18u], 0.0);
            let even = split_even(split, given[at + 15u], depth);
            found[to + 7u] = even.x; found[to + 8u] = even.y; found[to + 9u] = even.z;
            found[to + 3u] = phase_lobe(split.g_forward, given[at + 17u]);
            found[to + 4u] = phase_function(split, given[at + 17u]);
            found[to + 5u] = single_scatter(split, given[at + 16u], g, given[at + 14u], given[at + 15u]);",
            vector(0),
            vector(4),
            vector(19),
            vector(23),
            colours(
                0,
                "split_shape(split, given[at + 18u], g, given[at + 14u], given[at + 15u], vec3(given[at + 7u], given[at + 18u], 0.0))"
            ),
        ),
        twin: |x| {
            let split = split_of(x);
            let g = Facing {
                mu_i: x[11],
                mu_o: x[12],
                cos_d: x[13],
                sin2_h: 0.0,
            };
            let depth = DVec3::new(x[7], x[18], 0.0);
            let shape = split_shape(&split, x[18], &g, x[14], x[15], depth).to_array();
            let others = [
                phase_lobe(split.phase.g_forward, x[17]),
                phase_function(&split, x[17]),
                single_scatter(&split, x[16], &g, x[14], x[15]),
                split_mean(&split, x[11]),
            ];
            let even = split_even(&split, x[15], depth).to_array();
            [&shape[..], &others, &even].concat()
        },
        relative: |_| RELATIVE,
        cases: cases(22, |seeded| {
            let share = || seeded.log_or_zero(1e-6, 1.0);
            let kappa = || seeded.log_or_zero(1e-3, 1e3);
            let cosine = || seeded.log(1e-4, 1.0);
            let eta = 1.0 + seeded.log(1e-2, 2.0);
            let (mu_i, mu_o) = (cosine(), cosine());
            let deflection = match seeded.bits() % 4 {
                0 => 1.0 - seeded.log_or_zero(1e-7, 1.0),
                1 => seeded.log_or_zero(1e-7, 1.0) - 1.0,
                _ => 2.0 * seeded.unit() - 1.0,
            };
            // The design's |g| ≤ .99, and the very ends, where the lobe has no width left.
            let g = || match seeded.bits() % 16 {
                0 => 1.0,
                _ => seeded.log_or_zero(1e-3, 0.99),
            };
            vec![
                kappa(),
                kappa(),
                kappa(),
                share(),
                kappa(),
                kappa(),
                kappa(),
                seeded.log(1e-8, 1e4),
                share(),
                g(),
                -g(),
                mu_i,
                mu_o,
                share(),
                inner_cosine(mu_i, eta),
                inner_cosine(mu_o, eta),
                eta,
                deflection,
                seeded.log_or_zero(1e-6, 10.0),
                share(),
                share(),
                share(),
                share(),
                share(),
                share(),
                share(),
                share(),
            ]
        }),
    }
}

/// The narrowest lobes are (1 − |g|)² wide, which the rounding of a cosine reaches; a shape is a
/// difference of κq and κq̄.
fn scattering_rounding(x: &[f64]) -> [f64; 10] {
    let split = split_of(x);
    let narrow = |g: f64| (1.0 - g.abs()).powi(2).max(1e-6);
    let phase = split.phase;
    let peak = 3.0 * UNIT_PRODUCT / narrow(phase.g_forward);
    let both = peak.max(3.0 * UNIT_PRODUCT / narrow(phase.g_backward));
    let g = Facing {
        mu_i: x[11],
        mu_o: x[12],
        cos_d: x[13],
        sin2_h: 0.0,
    };
    let means = x[18] + x[3] + 2.0 * split.of_direction.element_sum();
    let slanted = 2.0 * x[22] + x[14] + x[15];
    let alike = split.alike * (slanted * slanted + split.captured);
    let terms = 1.0 + split.kappa * means + split.leaning * slanted + alike;
    let shape = (terms * split.at_capture).max_element() * UNIT_PRODUCT;
    [
        shape,
        shape,
        shape,
        peak * phase_lobe(phase.g_forward, x[17]),
        both * phase_function(&split, x[17]),
        both * single_scatter(&split, x[16], &g, x[14], x[15]),
        0.0,
        shape,
        shape,
        shape,
    ]
}

/// Means of normals of any length, and roughness down to none.
fn relief_parts() -> (Twins, impl Fn(&[f64]) -> f64) {
    let mut lengths: Vec<f32> = log_spaced(1e-6, 1.0, 80).iter().map(|x| 1.0 - x).collect();
    lengths.extend([0.0, 1.0, 1.0001, 2.0]);
    let mut alphas = alphas();
    alphas.push(0.0);
    let twins = Twins {
        name: "mean_length, slope_variance, widened",
        body: "let length = mean_length(vec3(0.0, 0.0, given[at + 1u]));
            found[to] = length;
            found[to + 1u] = slope_variance(length);
            found[to + 2u] = widened(given[at], length);"
            .into(),
        twin: |x| {
            let length = mean_length(DVec3::Z * x[1]);
            vec![length, slope_variance(length), widened(x[0], length)]
        },
        relative: |_| RELATIVE,
        cases: grid(&[alphas, lengths]),
    };
    // 1 − ℓ² cancels to some roundings of 1, which the square root of a near-mirror magnifies.
    let rounding = |x: &[f64]| {
        let length = mean_length(DVec3::Z * x[1]);
        if 1.0 - length * length < SHORTENING_NOISE - UNIT_PRODUCT {
            return 0.0;
        }
        let variance = UNIT_PRODUCT / (length * length);
        variance.max(0.5 * variance / widened(x[0], length))
    };
    (twins, rounding)
}

/// What angle_of promises, in radians.
const ANGLE: f64 = 2e-6;

pub fn compare_angle_of(gpu: &Gpu, physics: &str) -> Result<f64, String> {
    let mut cases = cases(25, |seeded| {
        let side = || {
            let sign = if seeded.bits().is_multiple_of(2) {
                1.0
            } else {
                -1.0
            };
            sign * seeded.log_or_zero(1e-20, 1.0)
        };
        vec![side(), side()]
    });
    cases.push(vec![0.0, 0.0]);
    let twins = Twins {
        name: "angle_of",
        // An angle may be negative: it is judged by its distance from −π.
        body: "found[to] = angle_of(given[at], given[at + 1u]) + PI;".into(),
        twin: |x| vec![DVec2::new(x[0] + 0.0, x[1] + 0.0).to_angle() + PI],
        relative: |_| 0.0,
        cases,
    };
    let rounding = |_: &[f64]| ANGLE + 4.0 * UNIT_PRODUCT;
    twins.compare_rounded(gpu, physics, rounding)
}

/// Lamps in the zenith, at the horizon and below it, over rooms of any height.
fn rises() -> Twins {
    Twins {
        name: "rise_of, march_reach",
        body: format!(
            "found[to] = max(rise_of({}), 0.0); found[to + 1u] = march_reach(given[at + 3u], given[at + 4u]);",
            vector(0)
        ),
        twin: |x| {
            let rise = rise_of(DVec3::from_slice(x)).max(0.0);
            vec![rise, march_reach(x[3], x[4])]
        },
        relative: |_| RELATIVE,
        cases: cases(26, |seeded| {
            let mut case = match seeded.bits() % 8 {
                0 => DVec3::Z,
                1 => (DVec3::Z + seeded.direction() * seeded.log(1e-9, 1e-3)).normalize(),
                _ => seeded.direction(),
            }
            .to_array()
            .to_vec();
            let sign = seeded.pick(&[1.0, 1.0, -1.0]);
            case.push(sign * seeded.log_or_zero(1e-4, 10.0));
            case.push(seeded.pick(&[1.0, -1.0]) * seeded.log_or_zero(1e-8, 1e6));
            case
        }),
    }
}

pub fn compare_rises(gpu: &Gpu, physics: &str) -> Result<f64, String> {
    rises().compare(gpu, physics)
}

/// The film of each paper, at any photographed share: below 0, none, and lighter than the paper.
pub fn compare_films(gpu: &Gpu, physics: &str) -> Result<f64, String> {
    let mut worst = 0.0f64;
    let shares = {
        let mut shares = log_spaced(1e-30, 1.0, 400);
        shares.extend(log_spaced(1e-6, 0.5, 40).iter().map(|x| 1.0 - x));
        shares.extend([-1.0, -1e-6, 0.0, 1.0, 7.0]);
        shares
    };
    let depths = log_spaced(1e-8, 20.0, 445);
    for (n, alpha, r_b) in [
        (1.01, 0.4, DVec3::splat(0.9)),
        (1.33, 0.1, DVec3::new(0.05, 0.3, 0.97)),
        (1.5, 1.0, DVec3::new(1.0, 0.8, 0.5)),
        (2.5, 0.6, DVec3::new(0.9, 0.6, 0.01)),
    ] {
        let table = InterfaceTable::at_roughness(alpha, n, 1.0);
        let r_i = (1.0 - table.mean_at(alpha).t_mean / (n * n)).max(0.0);
        let paths = Arc::new(PathTable::at_roughness(alpha, n));
        let capture = capture_path(&paths, alpha);
        let film = Film::new(n, alpha, &table, paths, r_i, r_b);
        let constants = words(&FilmUniform::new(&film));
        let count = constants.len();
        let rows: Vec<String> = (0..count)
            .step_by(4)
            .map(|i| {
                let each: Vec<String> = (i..i + 4).map(|i| format!("given[{i}u]")).collect();
                format!("vec4({})", each.join(", "))
            })
            .collect();
        let body = format!(
            "let film = Film(array({}), array({}), {});
            let at = {count}u + 2u * index;
            let share = vec3(given[at]);
            {} {} {}",
            rows[..7].join(", "),
            rows[7..14].join(", "),
            rows[14],
            colours(
                0,
                &format!(
                    "optical_depth(film, vec4({:e}, {:e}, {:e}, {:e}), share)",
                    capture.x, capture.y, capture.z, capture.w
                )
            ),
            colours(3, "internal_reflectance(film, share)"),
            colours(6, "crossed(film.diffuse_path, vec3(given[at + 1u]))"),
        );
        let cases: Vec<[f32; 2]> = shares.iter().zip(&depths).map(|(x, t)| [*x, *t]).collect();
        let text = format!("{physics}\n{}", entry("f32", cases.len(), 9, &body));
        let given = [constants, cases.concat()].concat();
        let found = gpu.run(&text, &given, cases.len(), 9);
        // What the terms of H and ρ add up to before they cancel.
        let terms = |of: &[DVec3]| of.iter().map(|c| c.abs().max_element()).sum::<f64>();
        let pairs: Vec<Pair> = cases
            .iter()
            .zip(found.chunks(9))
            .flat_map(|(case, found)| {
                let (share, tau) = (DVec3::splat(case[0].into()), DVec3::splat(case[1].into()));
                let depth = optical_depth(&film, capture, share);
                let expected = [
                    depth,
                    internal_reflectance(&film, share),
                    crossed(film.diffuse_path, tau),
                ];
                let excess = (1.0 + terms(&film.excess)) * UNIT_PRODUCT;
                let rounding = [excess, terms(&film.internal) * UNIT_PRODUCT, 0.0];
                std::array::from_fn::<_, 9, _>(|k| {
                    let mut pair = Pair::new(found[k], expected[k / 3][k % 3], RELATIVE);
                    pair.allowed += rounding[k / 3];
                    pair
                })
            })
            .collect();
        let error = judge(&format!("films on n {n}"), &pairs, |i| {
            format!("{:?}, output {}", cases[i / 9], i % 9)
        })?;
        worst = worst.max(error);
    }
    Ok(worst)
}

/// As [`Twins::compare_rounded`], with a rounding for each output.
fn compare_each<const N: usize>(
    twins: &Twins,
    gpu: &Gpu,
    physics: &str,
    rounding: impl Fn(&[f64]) -> [f64; N],
) -> Result<f64, String> {
    let (found, cases) = (twins.found(gpu, physics), twins.cases(gpu));
    let pairs: Vec<Pair> = cases
        .iter()
        .zip(found.chunks(N))
        .flat_map(|(case, found)| {
            let case = widen(case);
            let (rounding, expected) = (rounding(&case), (twins.twin)(&case));
            let relative = (twins.relative)(&case);
            std::array::from_fn::<_, N, _>(|k| {
                let mut pair = Pair::new(found[k], expected[k], relative);
                pair.allowed += rounding[k];
                pair
            })
        })
        .collect();
    judge(twins.name, &pairs, |i| {
        format!("{:?}, output {}", cases[i / N], i % N)
    })
}

pub fn compare_inner_cosines(gpu: &Gpu, physics: &str) -> Result<f64, String> {
    inner_cosines().compare(gpu, physics)
}

pub fn compare_ink(gpu: &Gpu, physics: &str) -> Result<f64, String> {
    let films = films_crossed();
    let films = compare_each(&films, gpu, physics, |x| {
        let twins = (films.twin)(x);
        let (exponent, path) = path_rounding(x);
        std::array::from_fn::<_, 10, _>(|k| match k {
            0..6 => twins[k] * exponent,
            _ => path,
        })
    })?;
    let crossed = crossings().compare_rounded(gpu, physics, crossing_rounding)?;
    Ok(films.max(crossed))
}

pub fn compare_scattering(gpu: &Gpu, physics: &str) -> Result<f64, String> {
    compare_each(&scattering(), gpu, physics, scattering_rounding)
}

pub fn compare_relief(gpu: &Gpu, physics: &str) -> Result<f64, String> {
    let (relief, rounding) = relief_parts();
    relief.compare_rounded(gpu, physics, rounding)
}

#[test]
fn every_function_at_a_million_extremes() {
    let gpu = Gpu::new();
    judge_numbers(&gpu);
    compare_facing(&gpu, bsdf()).unwrap();
    let (surfaces, rounding) = surfaces();
    surfaces.compare_rounded(&gpu, bsdf(), rounding).unwrap();
    compare_inner_cosines(&gpu, bsdf()).unwrap();
    compare_ink(&gpu, bsdf()).unwrap();
    compare_scattering(&gpu, bsdf()).unwrap();
    compare_relief(&gpu, bsdf()).unwrap();
    judge_relief(&gpu);
    compare_rises(&gpu, bsdf()).unwrap();
    compare_angle_of(&gpu, bsdf()).unwrap();
    compare_films(&gpu, bsdf()).unwrap();
    compare_interfaces(&gpu, bsdf()).unwrap();
    compare_paths(&gpu, bsdf()).unwrap();
    judge_facets(&gpu);
    judge_study(&gpu);
    judge_media(&gpu);
    judge_lamps(&gpu);
    judge_angles(&gpu);
    baselines::judge_baselines(&gpu);
    baselines::judge_off_mirror(&gpu);
    judge_reciprocity(&gpu, &baselines::physics()).unwrap();

    let tuples = gpu.tuples() * gpu.every;
    eprintln!("{tuples} tuples");
    assert!(tuples >= TUPLES, "{tuples} tuples");
    // Whatever is shipped is among what was asked.
    let names = |text: &'static str| {
        let functions = text.lines().filter_map(|line| line.strip_prefix("fn "));
        functions.filter_map(|line| line.split('(').next())
    };
    let missing: Vec<&str> = names(PAPER_BSDF)
        .chain(names(PAPER_BASELINES))
        .chain(names(PAPER_MEDIA))
        .filter(|name| !gpu.has_called(name) && *name != PLACE_OF_ANOTHER)
        .collect();
    assert!(missing.is_empty(), "never called by itself: {missing:?}");
}
