//! The study tier: ink, single scattering, light through the sheet.

use super::*;
use crate::interfaces::words;
use recto::{
    optics::{
        fresnel::fresnel_conductor,
        ink::{DEPTH_MAX, capture_path, internal_reflectance, optical_depth},
        microfacet::{d_ggx_anisotropic, v_smith_anisotropic},
        refraction::{PathRow, PathTable, crossed, path_at, smooth_cosine},
        show_through::{BACKED_MIN, shown_through, under_tone},
        slab::{Phase, Slab},
        study::{Study, Ways, brdf_study, brdf_study_diffuse},
        through::{KEPT_WITHIN, Seen, TONE_MIN, Through, btdf_study, through_study, toned_paper},
        tier::albedo_of,
    },
    sheet::uniform::{FilmUniform, SplitUniform, ThroughUniform, narrow_paths},
};

pub fn conductors() -> Twins {
    let seeded = Seeded::new(11);
    // Air as well.
    let n = || match seeded.bits() % 8 {
        0 => 1.0,
        _ => seeded.log(1e-2, 6.0),
    };
    let k = || seeded.log_or_zero(1e-4, 20.0);
    Twins {
        name: "fresnel_conductor",
        body: format!(
            "let f = fresnel_conductor(given[at], vec3(given[at + 1u], given[at + 2u], given[at + 3u]),
                vec3(given[at + 4u], given[at + 5u], given[at + 6u])); {FOUND_COLOUR}"
        ),
        twin: |x| (1..4).map(|c| fresnel_conductor(x[0], x[c], x[c + 3])).collect(),
        relative: |_| RELATIVE,
        cases: (0..100_000)
            .map(|_| {
                let cosine = seeded.log_or_zero(1e-4, 1.0);
                [cosine, n(), n(), n(), k(), k(), k()].map(|x| x as f32).to_vec()
            })
            .collect(),
    }
}

fn anisotropic() -> Twins {
    let seeded = Seeded::new(12);
    Twins {
        name: "anisotropic facets",
        body: "let l = vec3(given[at], given[at + 1u], given[at + 2u]);
            let v = vec3(given[at + 3u], given[at + 4u], given[at + 5u]);
            found[to] = d_ggx_anisotropic(given[at], given[at + 1u], given[at + 6u], given[at + 7u]);
            found[to + 1u] = v_smith_anisotropic(l, v, given[at + 6u], given[at + 7u]);"
            .into(),
        twin: |x| {
            let [l, v] = [0, 3].map(|i| DVec3::from_slice(&x[i..]));
            vec![
                d_ggx_anisotropic(x[0], x[1], x[6], x[7]),
                v_smith_anisotropic(l, v, x[6], x[7]),
            ]
        },
        relative: |x| near_mirror(x[6].min(x[7])),
        cases: (0..100_000)
            .map(|_| {
                let up = |d: DVec3| DVec3::new(d.x, d.y, d.z.abs()).as_vec3().to_array();
                let alpha = [(); 2].map(|()| seeded.log(1e-2, 1.0) as f32);
                let (l, v) = (up(seeded.direction()), up(seeded.direction()));
                [&l[..], &v, &alpha].concat()
            })
            .collect(),
    }
}

pub fn compare_anisotropic(gpu: &Gpu, physics: &str) -> Result<f64, String> {
    // 1 − x² − y² of a half vector cancels towards grazing, as in f64 only later.
    anisotropic().compare_rounded(gpu, physics, |x| {
        let d = d_ggx_anisotropic(x[0], x[1], x[6], x[7]);
        let grazing = (x[0] / x[6]).hypot(x[1] / x[7]).powi(2).max(1e-6);
        4.0 * d * UNIT_PRODUCT / grazing
    })
}

/// Facets of metal and of combed paper.
pub fn judge_facets(gpu: &Gpu) {
    conductors().compare(gpu, bsdf()).unwrap();
    compare_anisotropic(gpu, bsdf()).unwrap();
}

/// P at some depths, over interfaces from none to a diamond's and beyond.
pub fn compare_paths(gpu: &Gpu, physics: &str) -> Result<f64, String> {
    const DEPTHS: [f64; 4] = [0.0, 0.25, 0.5, 0.875];
    let over = |path: DVec4, w: f64| path.x + w * (path.y + w * (path.z + w * path.w));
    let mut worst = 0.0f64;
    let mut rows: Vec<(String, f64, PathRow)> = Vec::new();
    for n in [1.0, 1.01, 1.5, 3.0] {
        for alpha in alphas().into_iter().map(f64::from) {
            let row = PathTable::new(n).row(alpha);
            rows.push((format!("paths of index {n}, fitted, α {alpha}"), n, row));
        }
        for alpha in [0.0, 0.5] {
            let row = PathTable::at_roughness(alpha, n).row(alpha);
            rows.push((format!("paths of index {n}, α {alpha}"), n, row));
        }
    }
    let mut cosines = cosines();
    cosines.extend([0.0, 0.25, 0.9999]);
    let cases = grid(&[cosines]);
    for (name, n, row) in &rows {
        let constants: Vec<f32> = [*n as f32]
            .into_iter()
            .chain(narrow_paths(row).iter().flat_map(|term| term.to_array()))
            .collect();
        let from = constants.len();
        let terms: Vec<String> = (1..from)
            .step_by(4)
            .map(|at| {
                let numbers: Vec<String> = (at..at + 4).map(|i| format!("given[{i}u]")).collect();
                format!("vec4({})", numbers.join(", "))
            })
            .collect();
        let found: Vec<String> = DEPTHS
            .iter()
            .enumerate()
            .map(|(k, w)| {
                format!("found[to + {k}u] = p.x + {w} * (p.y + {w} * (p.z + {w} * p.w));")
            })
            .collect();
        let body = format!(
            "let row = array<vec4<f32>, 7>({});
            let p = path_at(row, given[{from}u + index], given[0]);
            {}",
            terms.join(", "),
            found.join("\n")
        );
        let text = format!(
            "{physics}\n{}",
            entry("f32", cases.len(), DEPTHS.len(), &body)
        );
        let given = [constants, cases.concat()].concat();
        let found = gpu.run(&text, &given, cases.len(), DEPTHS.len());
        let pairs: Vec<Pair> = cases
            .iter()
            .zip(found.chunks(DEPTHS.len()))
            .flat_map(|(case, found)| {
                let mu = f64::from(case[0]);
                let path = path_at(row, mu, *n);
                let rounding = path_rounding(row, mu, *n);
                std::array::from_fn::<_, { DEPTHS.len() }, _>(|k| {
                    let mut pair = Pair::new(found[k], over(path, DEPTHS[k]), RELATIVE);
                    pair.allowed += rounding;
                    pair
                })
            })
            .collect();
        let error = judge(name, &pairs, |i| {
            format!(
                "{:?}, w {}",
                cases[i / DEPTHS.len()],
                DEPTHS[i % DEPTHS.len()]
            )
        })?;
        worst = worst.max(error);
    }
    Ok(worst)
}

/// What the terms of P add up to before they cancel, times the rounding of each.
fn path_rounding(row: &PathRow, mu: f64, n: f64) -> f64 {
    let terms = row.iter().enumerate();
    let sum: f64 = terms
        .map(|(k, c)| c.abs().element_sum() * mu.sqrt().powi(k as i32))
        .sum();
    sum * UNIT_PRODUCT / smooth_cosine(mu, n)
}

/// Papers at the extremes: index, roughness, bare albedo, σs, thickness in mm, phase.
type Paper = (String, Surface, InterfaceMean, Study);

fn papers() -> &'static [Paper] {
    static PAPERS: LazyLock<Vec<Paper>> = LazyLock::new(make_papers);
    &PAPERS
}

fn make_papers() -> Vec<Paper> {
    let phases = [[1.0, 0.33, 0.0], [0.5, 0.99, -0.99], [0.0, 0.0, 0.0]];
    [
        (1.5, 0.6, DVec3::new(0.8, 0.7, 0.55), 81.38, 0.165),
        (1.33, 0.1, DVec3::new(0.03, 0.2, 0.9), 81.38, 0.05),
        (2.5, 1.0, DVec3::splat(1.5), 1e3, 10.0),
        (1.5, 0.3, DVec3::ZERO, 1e-2, 1e-3),
        (1.01, 0.4, DVec3::new(0.5, 0.9, 0.1), 20.0, 0.15),
    ]
    .into_iter()
    .zip(phases.iter().cycle())
    .map(|((index, alpha, bare, scattering, thickness), phase)| {
        let surface = Surface::new(bare, alpha, index, 1.0);
        let table = InterfaceTable::at_roughness(alpha, index, 1.0);
        let mean = table.mean_at(alpha);
        let slab = Slab {
            scattering,
            absorption: 0.0,
            thickness,
            phase: Phase {
                forward_share: phase[0],
                g_forward: phase[1],
                g_backward: phase[2],
            },
        };
        let name = format!("n {index}, α {alpha}, albedo {bare}, σs {scattering}, d {thickness}");
        let paths = Arc::new(PathTable::at_roughness(alpha, index));
        (
            name,
            surface,
            mean,
            Study::new(&surface, &table, paths, slab),
        )
    })
    .collect()
}

const NUMBERS: usize = 29;
/// Where a case's paths begin.
const PATHS: usize = 17;
/// Where the other side's ink begins, behind what is compared with itself.
const SHOWN: usize = 21;
const OUTPUTS: usize = 27;

fn spots(paper: &Surface, study: &Study, count: usize) -> Vec<Vec<f32>> {
    let seeded = Seeded::new(13);
    (0..count)
        .map(|_| {
            let share = || seeded.log_or_zero(1e-6, 1.0);
            let cosine = || seeded.log(1e-4, 1.0);
            let mut case = vec![cosine(), cosine(), seeded.log_or_zero(1e-3, 1.0)];
            case.push(seeded.log_or_zero(1e-14, 1.0));
            case.extend([share(), share(), share(), share()]);
            // Photographs of both sides, to beyond white.
            case.extend((0..6).map(|_| seeded.log_or_zero(1e-6, 2.0)));
            case.extend([seeded.log_or_zero(1e-3, 10.0), share(), share()]);
            let paths = &study.film.paths;
            case.extend(capture_path(paths, paper.alpha).to_array());
            for mu in [case[0], case[1]] {
                case.extend(paths.at(mu, paper.alpha).to_array());
            }
            case.iter().map(|&x| x as f32).collect()
        })
        .collect()
}

/// All that the study tier computes for a spot: reflected, from a light table, from a lamp
/// behind.
fn spot(x: &[f64], paper: &Surface, mean: &InterfaceMean, study: &Study) -> [DVec3; 5] {
    let g = Facing {
        mu_i: x[0],
        mu_o: x[1],
        cos_d: x[2],
        sin2_h: x[3],
    };
    let (at_i, at_o) = (
        Interface {
            t: x[4],
            late: x[5],
        },
        Interface {
            t: x[6],
            late: x[7],
        },
    );
    let (front, back) = (DVec3::from_slice(&x[8..]), DVec3::from_slice(&x[11..]));
    let s = Surface {
        albedo: front,
        ..*paper
    };
    let ways = Ways {
        capture: DVec4::from_slice(&x[PATHS..]),
        path_i: DVec4::from_slice(&x[PATHS + 4..]),
        path_o: DVec4::from_slice(&x[PATHS + 8..]),
    };
    let depth = optical_depth(&study.film, ways.capture, front) * x[15];
    let seen = Seen {
        depth_f: depth,
        depth_b: optical_depth(&study.film, ways.capture, back),
        rho_f: internal_reflectance(&study.film, front),
        rho_b: internal_reflectance(&study.film, back),
        clear: x[14],
    };
    let lit = albedo_of(&s, mean);
    let (split, through) = (&study.split, &study.through);
    [
        brdf_study(&s, &g, &at_i, &at_o, mean, split, depth, &ways, lit, x[16]),
        through_study(&study.film, through, &seen, &at_o, mean, ways.path_o, s.eta),
        btdf_study(
            through,
            &seen,
            &at_i,
            &at_o,
            mean,
            ways.path_i,
            ways.path_o,
            s.eta,
        ),
        brdf_study_diffuse(&s, &g, &at_i, &at_o, mean, split, depth, &ways, lit),
        toned_paper(through, front),
    ]
}

/// What the other side's ink leaves, on the sheet's own paper and where that is darker.
fn shown(x: &[f64], study: &Study) -> [DVec3; 2] {
    let rho = |share: DVec3| internal_reflectance(&study.film, share);
    let (front, back) = (DVec3::from_slice(&x[8..]), DVec3::from_slice(&x[11..]));
    let (before, bare) = (rho(DVec3::splat(x[16])), rho(DVec3::ONE));
    let through = &study.through;
    let shown = shown_through(through, x[14], rho(front), rho(back), before, bare);
    [shown, under_tone(shown, toned_paper(through, front), front)]
}

/// What rounding costs there: of ρ before their difference, and of the passes before theirs.
fn shown_rounding(x: &[f64], study: &Study) -> f64 {
    let through = &study.through;
    let rho = |share: DVec3| KEPT_WITHIN * internal_reflectance(&study.film, share);
    let (front, back) = (
        rho(DVec3::from_slice(&x[8..])),
        rho(DVec3::from_slice(&x[11..])),
    );
    let before = rho(DVec3::splat(x[16]));
    let all = through.reflected + through.transmitted;
    let t = (through.transmitted * x[14]).min(all);
    let r = all - t;
    let passes = (1.0 - r * front) * (1.0 - r * back) - t * t * front * back;
    let photographed = r * (1.0 - r * before) + t * t * before;
    let over = (passes * photographed).max(DVec3::splat(BACKED_MIN));
    // What ρ is made of cancels too.
    let terms: DVec3 = study.film.internal.iter().map(|c| c.abs()).sum();
    let of_rho = (terms + 1.0) * t * t / over;
    let of_passes = t * t * (back - before).abs() / over * (1.0 + t * t + r) / passes.abs();
    UNIT_PRODUCT * 4.0 * (of_rho + of_passes).max_element()
}

/// What the terms of `crossing` add up to before they cancel, dimmed by the seen side's ink, times
/// the rounding of each.
fn crossing_rounding(x: &[f64], study: &Study) -> f64 {
    let through = &study.through;
    let returned = through.reflected_leaning.abs() * x[14];
    let most = 1.0 + 2.0 * (through.transmitted_leaning.abs() + returned);
    let terms = through.reflected + through.transmitted * most * most;
    let capture = DVec4::from_slice(&x[PATHS..]);
    let depth = optical_depth(&study.film, capture, DVec3::from_slice(&x[8..]));
    let dimmed = terms * crossed(DVec4::from_slice(&x[PATHS + 8..]), depth);
    2.0 * UNIT_PRODUCT * dimmed.max_element()
}

/// The deepest that light crosses along a path.
fn deepest(x: &[f64], study: &Study) -> f64 {
    let capture = DVec4::from_slice(&x[PATHS..]);
    let depth = |from: usize| {
        optical_depth(&study.film, capture, DVec3::from_slice(&x[from..])).max_element()
    };
    // Light that goes straight through is followed to where nothing of it is left.
    let straight = study.through.ballistic.max_element().min(DEPTH_MAX);
    depth(8).max(depth(11)).max(straight)
}

/// The largest that the terms of [`toned_paper`]'s logarithm add up to before they cancel.
fn toned_terms(through: &Through) -> f64 {
    let ln_x = TONE_MIN.ln().abs();
    let terms = through.toned.iter().rev();
    let sum = terms.fold(DVec3::ZERO, |sum, c| sum * ln_x + c.abs());
    // What it is made of is narrowed, and so is the logarithm itself.
    2.0 * sum.max_element()
}

fn literal(value: f64) -> String {
    format!("f32({:e})", value as f32)
}

fn colour(value: DVec3) -> String {
    let [r, g, b] = value.to_array().map(literal);
    format!("vec3({r}, {g}, {b})")
}

/// Reads the constants of `study` from the beginning of the numbers.
fn constants(study: &Study) -> (Vec<f32>, String) {
    let film = words(&FilmUniform::new(&study.film));
    let vectors: Vec<String> = (0..film.len())
        .step_by(4)
        .map(|i| {
            format!(
                "vec4(given[{i}u], given[{}u], given[{}u], given[{}u])",
                i + 1,
                i + 2,
                i + 3
            )
        })
        .collect();
    let (excess, rest) = vectors.split_at(7);
    let (internal, path) = rest.split_at(7);
    let split = SplitUniform::new(&study.split);
    let through = ThroughUniform::new(&study.through);
    let wide = |v: Vec3| colour(v.as_dvec3());
    let narrow = |x: f32| literal(f64::from(x));
    let of_direction = split.of_direction.to_array().map(narrow).join(", ");
    let of_direction = format!("vec4({of_direction})");
    let text = format!(
        "let film = Film(array({}), array({}), {});
        let split = Split({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {});
        let through = Through({}, {}, {}, {}, {}, {}, {}, {}, array({}), {});",
        excess.join(", "),
        internal.join(", "),
        path[0],
        wide(split.kappa),
        narrow(split.mean),
        wide(split.at_capture),
        narrow(split.depth),
        wide(split.leaning),
        narrow(split.inner_mean),
        narrow(split.alike),
        narrow(split.captured),
        of_direction,
        narrow(split.forward_share),
        narrow(split.g_forward),
        narrow(split.g_backward),
        wide(through.reflected),
        narrow(through.inner_mean),
        wide(through.transmitted),
        wide(through.ballistic),
        wide(through.reflected_leaning),
        wide(through.transmitted_leaning),
        wide(through.straight_mean),
        wide(through.flat_share),
        through.toned.map(wide).join(", "),
        wide(through.lightest),
    );
    (film, text)
}

/// Compares the study tier with `physics`, for the paper of this number.
pub fn compare_study(gpu: &Gpu, physics: &str, number: usize) -> Result<f64, String> {
    let (name, paper, mean, study) = &papers()[number];
    let (film, constants) = constants(study);
    let cases = spots(paper, study, 100_000 / gpu.every);
    let path = |i: usize| {
        let at = |k: usize| format!("given[at + {}u]", PATHS + 4 * i + k);
        format!("vec4({}, {}, {}, {})", at(0), at(1), at(2), at(3))
    };
    let (capture, path_i, path_o) = (path(0), path(1), path(2));
    let body = format!(
        "{constants}
        let at = {}u + index * {NUMBERS}u;
        let front = vec3(given[at + 8u], given[at + 9u], given[at + 10u]);
        let back = vec3(given[at + 11u], given[at + 12u], given[at + 13u]);
        let s = Surface(front, {}, {}, {}, 1.0, {});
        let g = Facing(given[at], given[at + 1u], given[at + 2u], given[at + 3u]);
        let at_i = Interface(given[at + 4u], given[at + 5u]);
        let at_o = Interface(given[at + 6u], given[at + 7u]);
        let mean = InterfaceMean({}, {}, {}, {});
        let ways = Ways({capture}, {path_i}, {path_o});
        let depth = optical_depth(film, ways.capture, front) * given[at + 15u];
        let seen = Seen(depth, given[at + 14u], optical_depth(film, ways.capture, back),
            internal_reflectance(film, front), internal_reflectance(film, back));
        let lit = albedo_of(s, mean);
        let a = brdf_study(s, g, at_i, at_o, mean, split, depth, ways, lit, given[at + 16u]);
        let b = through_study(film, through, seen, at_o, mean, ways.path_o, s.eta);
        let c = btdf_study(through, seen, at_i, at_o, mean, ways.path_i, ways.path_o, s.eta);
        found[to] = a.x; found[to + 1u] = a.y; found[to + 2u] = a.z;
        found[to + 3u] = b.x; found[to + 4u] = b.y; found[to + 5u] = b.z;
        found[to + 6u] = c.x; found[to + 7u] = c.y; found[to + 8u] = c.z;
        // Light and eye exchanged, and the sheet turned over with them.
        let exchanged = Facing(g.mu_o, g.mu_i, g.cos_d, g.sin2_h);
        let d = brdf_study_diffuse(s, g, at_i, at_o, mean, split, depth, ways, lit);
        found[to + 9u] = d.x; found[to + 10u] = d.y; found[to + 11u] = d.z;
        let p = toned_paper(through, front);
        found[to + 12u] = p.x; found[to + 13u] = p.y; found[to + 14u] = p.z;
        let turned = Seen(seen.depth_b, seen.clear, seen.depth_f, seen.rho_b, seen.rho_f);
        let other = Ways(ways.capture, ways.path_o, ways.path_i);
        let e = brdf_study(
            s, exchanged, at_o, at_i, mean, split, depth, other, lit, given[at + 16u]);
        let h = btdf_study(through, turned, at_o, at_i, mean, ways.path_o, ways.path_i, s.eta);
        found[to + 15u] = e.x; found[to + 16u] = e.y; found[to + 17u] = e.z;
        found[to + 18u] = h.x; found[to + 19u] = h.y; found[to + 20u] = h.z;
        let w = shown_through(through, seen.clear, seen.rho_f, seen.rho_b,
            internal_reflectance(film, vec3(given[at + 16u])),
            internal_reflectance(film, vec3(1.0)));
        let u = under_tone(w, p, front);
        found[to + 21u] = w.x; found[to + 22u] = w.y; found[to + 23u] = w.z;
        found[to + 24u] = u.x; found[to + 25u] = u.y; found[to + 26u] = u.z;",
        film.len(),
        literal(paper.alpha),
        literal(paper.eta),
        literal(paper.f_normal),
        literal(paper.f_capture),
        literal(mean.compensation),
        literal(mean.t_mean),
        literal(mean.capture),
        literal(mean.floor),
    );
    let text = format!("{physics}\n{}", entry("f32", cases.len(), OUTPUTS, &body));
    let given = [film, cases.concat()].concat();
    let found = gpu.run(&text, &given, cases.len(), OUTPUTS);
    let mut without_straight = study.clone();
    without_straight.through.ballistic = DVec3::splat(1e4);
    let (mut pairs, mut ways, mut behind) = (Vec::new(), Vec::new(), Vec::new());
    for (case, found) in cases.iter().zip(found.chunks(OUTPUTS)) {
        let x = widen(case);
        let expected = spot(&x, paper, mean, study);
        let terms =
            x[8].max(x[9]).max(x[10]) + capture_floor(paper, mean) + study.bare.max_element();
        // What the rounding of differences of albedos costs: diffusely, and in the lobe.
        let diffuse = terms * UNIT_PRODUCT * (1.0 + x[4] * x[6] * mean.capture) / PI;
        // A deflection's cosine is rounded, and the narrowest lobes are (1 − |g|)² wide.
        let narrow = 1.0
            - study
                .split
                .phase
                .g_forward
                .max(-study.split.phase.g_backward);
        let peak = 3.0 * UNIT_PRODUCT / (narrow * narrow);
        for (there, back) in (0..3).chain(6..9).zip(15..OUTPUTS) {
            ways.push(Pair::new(found[back], found[there].into(), RECIPROCITY));
        }
        // The terms of a path cancel, and inks are crossed along it.
        let terms: f64 = x[PATHS..].iter().map(|term| term.abs()).sum();
        // So do those of an ink's depth, which is then crossed along both ways.
        let of_depth: f64 = study
            .film
            .excess
            .iter()
            .map(|c| c.abs().max_element())
            .sum();
        let both = x[PATHS + 4].max(1.0) + x[PATHS + 8].max(1.0);
        let along = UNIT_PRODUCT * (terms * deepest(&x, study) + of_depth * both);
        // What goes straight through is taken out of all that crosses.
        let scattered = spot(&x, paper, mean, &without_straight);
        let crossed_terms = crossing_rounding(&x, study);
        // The logarithm of what passes is a sum of terms that cancel.
        let toned = toned_terms(&study.through) * UNIT_PRODUCT;
        let of_other = shown(&x, study);
        for (k, &gpu) in found[SHOWN..].iter().enumerate() {
            let mut pair = Pair::new(gpu, of_other[k / 3][k % 3], RELATIVE);
            // The tone is squared.
            let tones = 2.0 * toned * (of_other[0][k % 3] - 1.0).abs();
            pair.allowed += shown_rounding(&x, study) + tones;
            behind.push(pair);
        }
        for (k, &gpu) in found[..15].iter().enumerate() {
            let mut pair = Pair::new(gpu, expected[k / 3][k % 3], RELATIVE);
            let diffuse = diffuse + peak * pair.cpu;
            let through = along * scattered[k / 3][k % 3] + crossed_terms;
            let toned = toned * pair.cpu;
            pair.allowed += [diffuse, through, through, diffuse, toned][k / 3];
            pairs.push(pair);
        }
    }
    let shows = judge(&format!("{name}: the other side's ink"), &behind, |i| {
        format!("{:?}, output {}", cases[i / 6], SHOWN + i % 6)
    })?;
    let either = judge(&format!("{name}: exchanged"), &ways, |i| {
        format!("{:?}, output {}", cases[i / 6], i % 6)
    })?;
    let alike = judge(name, &pairs, |i| {
        format!("{:?}, output {}", cases[i / 15], i % 15)
    })?;
    Ok(either.max(alike).max(shows))
}

/// Ink and light through the sheet.
pub fn judge_study(gpu: &Gpu) {
    for number in 0..papers().len() {
        compare_study(gpu, bsdf(), number).unwrap();
    }
}

#[test]
fn a_broken_study_is_found() {
    let gpu = Gpu::sampling(BROKEN);
    for (sound, wrong) in [
        (
            "let path = path_i + path_o - capture;",
            "let path = path_i + path_o;",
        ),
        ("- t * t * rho_f * rho_b", "+ t * t * rho_f * rho_b"),
        ("(1.0 - g * g) / (d * sqrt(d))", "(1.0 - g * g) / d"),
        ("+ split.alike * alike", "- split.alike * alike"),
        ("lost * (m_i + m_o - split.captured)", "lost * (m_i + m_o)"),
        ("clamp(share, vec3(TONE_MIN), through.lightest)", "share"),
        ("t * t * (back - before)", "t * (back - before)"),
        (
            "let slant = through.inner_mean - DIFFUSE_COSINE;",
            "let slant = 0.0;",
        ),
        ("let dimmed = toned * toned", "let dimmed = toned"),
    ] {
        let physics = broken(sound, wrong);
        let outcome = compare_study(&gpu, &physics, 0);
        assert!(outcome.is_err(), "{wrong} passed: {outcome:?}");
    }
    let physics = broken("return sum / smooth_cosine(mu, n);", "return sum;");
    assert!(compare_paths(&gpu, &physics).is_err());
}
