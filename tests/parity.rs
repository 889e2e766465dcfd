//! The shipped physics on the graphics device against its f64 twins, at the extremes of every
//! parameter. The twins get the f32 inputs widened, so that only the arithmetic differs.

use std::{
    cell::Cell,
    f64::consts::PI,
    sync::{Arc, LazyLock},
};

use bevy::render::render_resource::{
    ShaderType,
    encase::{StorageBuffer, internal::WriteInto},
};
use glam::{DVec3, DVec4, Vec3};
use recto::{
    optics::{
        fresnel::{fresnel_dielectric, fresnel_schlick, normal_reflectance},
        lamp::{Incidence, Light, Shape},
        microfacet::{d_ggx, v_smith},
        photometry::Photometry,
        quadrature::{GRIDS, disc_rule, gauss_legendre},
        table::{
            Interface, InterfaceMean, InterfaceRow, InterfaceTable, MU_TERMS, fit_root,
            interface_at,
        },
        tier::{Facing, Surface, brdf_draft, brdf_gallery, brdf_lambert, capture_floor, facing},
    },
    sheet::{
        PAPER_BSDF,
        uniform::{LightUniform, RowUniform},
    },
};

#[path = "parity/baselines.rs"]
mod baselines;
#[path = "parity/extremes.rs"]
mod extremes;
#[path = "support/gpu.rs"]
mod gpu;
#[path = "parity/guards.rs"]
mod guards;
#[path = "parity/interfaces.rs"]
mod interfaces;
#[path = "parity/lamps.rs"]
mod lamps;
#[path = "parity/media.rs"]
mod media;
#[path = "parity/relief.rs"]
mod relief;
#[path = "parity/study.rs"]
mod study;

use gpu::{Gpu, bsdf, entry};
use lamps::{Lamps, compare_lamps};

/// Some thousand f32 roundings: room for any driver's division and square root.
const RELATIVE: f64 = 2e-4;
/// Below what a display or a half float tells from black.
const ABSOLUTE: f64 = 1e-8;
/// Near-mirrors divide by α², which the rounding of a direction reaches.
const RELATIVE_NEAR_MIRROR: f64 = 2e-3;
/// From this roughness down a surface is a near-mirror.
const NEAR_MIRROR: f64 = 1e-3;
/// Rounding of the dot or cross product of two unit vectors, six operations of half a ULP of 1.
const UNIT_PRODUCT: f64 = 6.0 * 6e-8;
/// f(i, o) against f(o, i), both in f32.
const RECIPROCITY: f64 = 1e-4;

/// A result of the device, its twin, and how far apart they may be.
#[derive(Clone, Copy)]
struct Pair {
    gpu: f32,
    cpu: f64,
    allowed: f64,
}

impl Pair {
    fn new(gpu: f32, cpu: f64, relative: f64) -> Self {
        let allowed = relative * cpu.abs() + ABSOLUTE;
        Self { gpu, cpu, allowed }
    }

    /// Error in units of what is allowed; anything not finite or negative is beyond measure.
    fn error(&self) -> f64 {
        if self.gpu.is_finite() && self.cpu.is_finite() && self.gpu >= 0.0 && self.cpu >= 0.0 {
            (f64::from(self.gpu) - self.cpu).abs() / self.allowed
        } else {
            f64::INFINITY
        }
    }
}

/// The largest error, in units of what is allowed, or the worst case in words.
fn judge(name: &str, pairs: &[Pair], describe: impl Fn(usize) -> String) -> Result<f64, String> {
    assert!(!pairs.is_empty());
    let (worst, error) = pairs
        .iter()
        .map(Pair::error)
        .enumerate()
        .fold(
            (0, 0.0),
            |worst, each| if each.1 > worst.1 { each } else { worst },
        );
    let Pair { gpu, cpu, allowed } = pairs[worst];
    eprintln!(
        "{name}: {} numbers, worst {error:.3} of what is allowed",
        pairs.len()
    );
    if error <= 1.0 {
        return Ok(error);
    }
    let faulty = pairs.iter().filter(|pair| pair.error() > 1.0).count();
    Err(format!(
        "{name}: {faulty} of {} numbers differ; worst {gpu:e}, not {cpu:e} ± {allowed:e}, for {}",
        pairs.len(),
        describe(worst)
    ))
}

/// `count` values from `low` to `high`, evenly spaced in the logarithm, both ends included.
fn log_spaced(low: f64, high: f64, count: usize) -> Vec<f32> {
    let step = (high / low).ln() / (count - 1) as f64;
    (0..count)
        .map(|i| ((low.ln() + step * i as f64).exp() as f32).min(high as f32))
        .collect()
}

/// Every combination of the values of each parameter.
fn grid(parameters: &[Vec<f32>]) -> Vec<Vec<f32>> {
    parameters.iter().fold(vec![Vec::new()], |cases, values| {
        cases
            .iter()
            .flat_map(|case| {
                values
                    .iter()
                    .map(move |&value| case.iter().copied().chain([value]).collect())
            })
            .collect()
    })
}

/// A seeded sequence (SplitMix64, Steele et al. 2014).
struct Seeded(Cell<u64>);

impl Seeded {
    fn new(seed: u64) -> Self {
        Self(Cell::new(seed))
    }

    fn bits(&self) -> u64 {
        let state = self.0.get().wrapping_add(0x9e37_79b9_7f4a_7c15);
        self.0.set(state);
        let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    fn unit(&self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Evenly spread in the logarithm, and one time in eight at either end.
    fn log(&self, low: f64, high: f64) -> f64 {
        match self.bits() % 16 {
            0 => low,
            1 => high,
            _ => low * (high / low).powf(self.unit()),
        }
    }

    /// As [`Self::log`], or 0.
    fn log_or_zero(&self, low: f64, high: f64) -> f64 {
        if self.bits().is_multiple_of(16) {
            0.0
        } else {
            self.log(low, high)
        }
    }

    fn pick<T: Copy>(&self, of: &[T]) -> T {
        of[(self.bits() % of.len() as u64) as usize]
    }

    /// A unit vector, evenly over the sphere.
    fn direction(&self) -> DVec3 {
        let z = 2.0 * self.unit() - 1.0;
        let (sin, cos) = (2.0 * PI * self.unit()).sin_cos();
        DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z
    }
}

/// A function of numbers: how the shader calls it, its twin, its inputs and its tolerance.
struct Twins {
    name: &'static str,
    body: String,
    twin: fn(&[f64]) -> Vec<f64>,
    relative: fn(&[f64]) -> f64,
    cases: Vec<Vec<f32>>,
}

impl Twins {
    fn outputs(&self) -> usize {
        (self.twin)(&widen(&self.cases[0])).len()
    }

    /// Those of the cases that this device is to run.
    fn cases(&self, gpu: &Gpu) -> Vec<&[f32]> {
        let cases = self.cases.iter().step_by(gpu.every);
        cases.map(Vec::as_slice).collect()
    }

    fn found(&self, gpu: &Gpu, physics: &str) -> Vec<f32> {
        let given = self.cases(gpu);
        let (cases, arity, outputs) = (given.len(), self.cases[0].len(), self.outputs());
        let body = format!("let at = index * {arity}u;\n{}", self.body);
        let entry = entry("f32", cases, outputs, &body);
        let text = format!("{physics}\n{entry}");
        gpu.run(&text, &given.concat(), cases, outputs)
    }

    fn compare(&self, gpu: &Gpu, physics: &str) -> Result<f64, String> {
        self.compare_rounded(gpu, physics, |_| 0.0)
    }

    /// With what the rounding of a difference of inputs costs a case beyond its tolerance.
    fn compare_rounded(
        &self,
        gpu: &Gpu,
        physics: &str,
        rounding: impl Fn(&[f64]) -> f64,
    ) -> Result<f64, String> {
        let (found, cases) = (self.found(gpu, physics), self.cases(gpu));
        let pairs: Vec<Pair> = cases
            .iter()
            .zip(found.chunks(self.outputs()))
            .flat_map(|(case, found)| {
                let case = widen(case);
                let (relative, rounding) = ((self.relative)(&case), rounding(&case));
                found
                    .iter()
                    .zip((self.twin)(&case))
                    .map(move |(&gpu, cpu)| {
                        let mut pair = Pair::new(gpu, cpu, relative);
                        pair.allowed += rounding;
                        pair
                    })
                    .collect::<Vec<_>>()
            })
            .collect();
        let case = |i: usize| format!("{:?}", cases[i / self.outputs()]);
        judge(self.name, &pairs, case)
    }
}

fn widen(case: &[f32]) -> Vec<f64> {
    case.iter().map(|&x| f64::from(x)).collect()
}

fn cosines() -> Vec<f32> {
    log_spaced(1e-4, 1.0, 60)
}

fn alphas() -> Vec<f32> {
    log_spaced(1e-4, 1.0, 40)
}

fn fresnel() -> Twins {
    // η − 1 evenly spaced, and 1 itself: no interface at all; then the same from inside.
    let mut etas: Vec<f32> = log_spaced(1e-6, 2.0, 60).iter().map(|x| 1.0 + x).collect();
    etas.extend(etas.clone().iter().map(|eta| 1.0 / eta));
    etas.push(1.0);
    // Cosines near 1 as well as near 0, and both ends.
    let mut cosines = cosines();
    cosines.extend(log_spaced(1e-7, 0.5, 40).iter().map(|x| 1.0 - x));
    cosines.push(0.0);
    Twins {
        name: "fresnel_dielectric",
        body: "found[to] = fresnel_dielectric(given[at], given[at + 1u]);".into(),
        twin: |x| vec![fresnel_dielectric(x[0], x[1])],
        relative: |_| RELATIVE,
        cases: grid(&[cosines, etas]),
    }
}

fn schlick() -> Twins {
    let mut cosines = cosines();
    cosines.extend([0.0, 0.25, 0.5, 0.75]);
    let mut f_normal = log_spaced(1e-8, 1.0, 30);
    f_normal.push(0.0);
    Twins {
        name: "fresnel_schlick",
        body: "found[to] = fresnel_schlick(given[at], given[at + 1u]);".into(),
        twin: |x| vec![fresnel_schlick(x[0], x[1])],
        relative: |_| RELATIVE,
        cases: grid(&[cosines, f_normal]),
    }
}

fn near_mirror(alpha: f64) -> f64 {
    if alpha < NEAR_MIRROR {
        RELATIVE_NEAR_MIRROR
    } else {
        RELATIVE
    }
}

fn distribution() -> Twins {
    let mut sin2 = log_spaced(1e-14, 1.0, 100);
    sin2.push(0.0);
    Twins {
        name: "d_ggx",
        body: "found[to] = d_ggx(given[at], given[at + 1u]);".into(),
        twin: |x| vec![d_ggx(x[0], x[1])],
        relative: |x| near_mirror(x[1]),
        cases: grid(&[sin2, alphas()]),
    }
}

fn visibility() -> Twins {
    Twins {
        name: "v_smith",
        body: "found[to] = v_smith(given[at], given[at + 1u], given[at + 2u]);".into(),
        twin: |x| vec![v_smith(x[0], x[1], x[2])],
        relative: |x| near_mirror(x[2]),
        cases: grid(&[cosines(), cosines(), alphas()]),
    }
}

/// Reads a `Surface`, a `Facing` and the tabulated interface from the numbers of a case.
const BRDF_INPUTS: &str = "
    let s = Surface(vec3(given[at], given[at + 1u], given[at + 2u]),
        given[at + 3u], given[at + 4u], given[at + 5u], given[at + 6u], given[at + 18u]);
    let g = Facing(given[at + 7u], given[at + 8u], given[at + 9u], given[at + 10u]);
    let at_i = Interface(given[at + 11u], given[at + 12u]);
    let at_o = Interface(given[at + 13u], given[at + 14u]);
    let mean = InterfaceMean(given[at + 15u], given[at + 16u], given[at + 17u], given[at + 19u]);";

fn brdf_body(call: &str) -> String {
    format!("{BRDF_INPUTS} let f = {call}; {FOUND_COLOUR}")
}

/// Writes a colour `f`.
const FOUND_COLOUR: &str = "found[to] = f.x; found[to + 1u] = f.y; found[to + 2u] = f.z;";

type BrdfInputs = (Surface, Facing, Interface, Interface, InterfaceMean);

/// Twin of [`BRDF_INPUTS`].
fn brdf_inputs(x: &[f64]) -> BrdfInputs {
    let s = Surface {
        albedo: DVec3::from_slice(x),
        alpha: x[3],
        eta: x[4],
        f_normal: x[5],
        specular: x[6],
        f_capture: x[18],
    };
    let g = Facing {
        mu_i: x[7],
        mu_o: x[8],
        cos_d: x[9],
        sin2_h: x[10],
    };
    let interface = |t: f64, late: f64| Interface { t, late };
    let mean = InterfaceMean {
        compensation: x[15],
        t_mean: x[16],
        capture: x[17],
        floor: x[19],
    };
    (s, g, interface(x[11], x[12]), interface(x[13], x[14]), mean)
}

fn brdf_cases() -> Vec<Vec<f32>> {
    // A dozen functions are asked the same.
    static CASES: LazyLock<Vec<Vec<f32>>> = LazyLock::new(draw_brdf_cases);
    CASES.clone()
}

fn draw_brdf_cases() -> Vec<Vec<f32>> {
    let seeded = Seeded::new(1);
    (0..200_000)
        .map(|_| {
            let eta = 1.0 + seeded.log_or_zero(1e-4, 2.0);
            let share = || seeded.log_or_zero(1e-5, 1.0);
            let cosine = || seeded.log(1e-4, 1.0);
            let case = [
                seeded.log(1e-5, 1.0),
                seeded.log(1e-5, 1.0),
                seeded.log(1e-5, 1.0),
                seeded.log(1e-4, 1.0),
                eta,
                normal_reflectance(eta),
                share(),
                cosine(),
                cosine(),
                seeded.log_or_zero(1e-4, 1.0),
                seeded.log_or_zero(1e-14, 1.0),
                share(),
                share(),
                share(),
                share(),
                seeded.log_or_zero(1e-5, 10.0),
                share(),
                1.0 + seeded.log_or_zero(1e-5, 4.0),
                share(),
                seeded.log_or_zero(1e-5, 0.1),
            ];
            case.map(|x| x as f32).to_vec()
        })
        .collect()
}

fn brdfs() -> [Twins; 3] {
    [
        Twins {
            name: "brdf_lambert",
            body: brdf_body("brdf_lambert(s)"),
            twin: |x| brdf_lambert(&brdf_inputs(x).0).to_array().to_vec(),
            relative: |_| RELATIVE,
            cases: brdf_cases(),
        },
        Twins {
            name: "brdf_draft",
            body: brdf_body("brdf_draft(s, g)"),
            twin: |x| {
                let (s, g, ..) = brdf_inputs(x);
                brdf_draft(&s, &g).to_array().to_vec()
            },
            relative: |x| near_mirror(x[3]),
            cases: brdf_cases(),
        },
        Twins {
            name: "brdf_gallery",
            body: brdf_body("brdf_gallery(s, g, at_i, at_o, mean)"),
            twin: |x| {
                let (s, g, at_i, at_o, mean) = brdf_inputs(x);
                brdf_gallery(&s, &g, &at_i, &at_o, &mean)
                    .to_array()
                    .to_vec()
            },
            relative: |x| near_mirror(x[3]),
            cases: brdf_cases(),
        },
    ]
}

/// What the rounding of (photographed albedo − floor) costs the coupled tiers.
fn albedo_rounding(name: &str) -> impl Fn(&[f64]) -> f64 + use<> {
    let coupled = name == "brdf_gallery";
    move |x| {
        if !coupled {
            return 0.0;
        }
        let (s, _, at_i, at_o, mean) = brdf_inputs(x);
        let terms = s.albedo.max_element() + capture_floor(&s, &mean);
        terms * UNIT_PRODUCT * at_i.t * at_o.t * mean.capture / PI
    }
}

/// Functions of numbers.
fn judge_numbers(gpu: &Gpu) {
    for twins in [fresnel(), schlick(), distribution(), visibility()]
        .into_iter()
        .chain(brdfs())
    {
        let rounding = albedo_rounding(twins.name);
        twins.compare_rounded(gpu, bsdf(), rounding).unwrap();
    }
}

/// Unit vectors in f32: normal, light, eye; and a roughness.
fn facing_cases() -> Vec<Vec<f32>> {
    let seeded = Seeded::new(2);
    (0..200_000)
        .map(|_| {
            // Normals as without a normal map, of faint relief, and of any kind.
            let n = match seeded.bits() % 4 {
                0 => DVec3::Z,
                1 => (DVec3::Z + seeded.direction() * 1e-3).normalize(),
                _ => seeded.direction(),
            };
            let aside = seeded.direction().reject_from(n).normalize();
            // Above the horizon, and now and then below it.
            let mu_o = seeded.pick(&[1.0, 1.0, 1.0, -1.0]) * seeded.log(1e-4, 1.0);
            let v = n * mu_o + aside * (1.0 - mu_o * mu_o).max(0.0).sqrt();
            let mirrored = 2.0 * n.dot(v) * n - v;
            let l = match seeded.bits() % 8 {
                0 => seeded.direction(),
                // From straight opposite the eye: no half vector.
                1 => -v + seeded.direction() * seeded.log_or_zero(1e-7, 1e-3),
                // About the mirror direction.
                _ => mirrored + seeded.direction() * seeded.log_or_zero(1e-7, 1.0),
            };
            let l = l.try_normalize().unwrap_or(n);
            let [n, l, v] = [n, l, v].map(|of| of.as_vec3().to_array());
            [&n[..], &l, &v, &[seeded.log(1e-4, 1.0) as f32]].concat()
        })
        .collect()
}

fn facings() -> Twins {
    Twins {
        name: "facing",
        body: "let g = facing(vec3(given[at], given[at + 1u], given[at + 2u]),
                vec3(given[at + 3u], given[at + 4u], given[at + 5u]),
                vec3(given[at + 6u], given[at + 7u], given[at + 8u]));
            found[to] = g.mu_i;
            found[to + 1u] = g.mu_o;
            found[to + 2u] = g.cos_d;
            found[to + 3u] = g.sin2_h;
            found[to + 4u] = d_ggx(g.sin2_h, given[at + 9u]);"
            .into(),
        twin: |x| {
            let [n, l, v] = [0, 3, 6].map(|i| DVec3::from_slice(&x[i..]));
            let g = facing(n, l, v);
            vec![g.mu_i, g.mu_o, g.cos_d, g.sin2_h, d_ggx(g.sin2_h, x[9])]
        },
        // Not the whole tolerance: `compare_facing` adds what a direction's rounding costs.
        relative: |x| near_mirror(x[9]),
        cases: facing_cases(),
    }
}

fn compare_facing(gpu: &Gpu, physics: &str) -> Result<f64, String> {
    let twins = facings();
    let found = twins.found(gpu, physics);
    let mut of_output: [Vec<Pair>; 5] = Default::default();
    let cases = twins.cases(gpu);
    for (case, found) in cases.iter().zip(found.chunks(5)) {
        let case = widen(case);
        let expected = (twins.twin)(&case);
        let sin_h = expected[3].sqrt();
        // What each output moves by when a product of unit vectors is rounded.
        let rounding = [
            UNIT_PRODUCT,
            UNIT_PRODUCT,
            UNIT_PRODUCT,
            (2.0 * sin_h + UNIT_PRODUCT) * UNIT_PRODUCT,
            0.0,
        ];
        for (k, pairs) in of_output.iter_mut().enumerate() {
            let relative = if k == 4 {
                (twins.relative)(&case)
            } else {
                RELATIVE
            };
            let mut pair = Pair::new(found[k], expected[k], relative);
            pair.allowed += rounding[k];
            pairs.push(pair);
        }
    }
    let names = ["mu_i", "mu_o", "cos_d", "sin2_h", "d_ggx of sin2_h"];
    let mut worst = 0.0f64;
    for (name, pairs) in names.into_iter().zip(&of_output) {
        let name = format!("facing: {name}");
        worst = worst.max(judge(&name, pairs, |i| format!("{:?}", cases[i]))?);
    }
    Ok(worst)
}

/// The tiers of plain surfaces that claim to be reciprocal, with light and eye exchanged; study
/// is judged with its own inputs.
fn judge_reciprocity(gpu: &Gpu, physics: &str) -> Result<f64, String> {
    // In place of a table, how far the eye is from the mirrored light: symmetric in both.
    let off = "given[at + 11u]";
    let calls = [
        ("brdf_draft(s, g)", "brdf_draft(s, back)"),
        (
            "brdf_gallery(s, g, at_i, at_o, mean)",
            "brdf_gallery(s, back, at_o, at_i, mean)",
        ),
        ("brdf_blinn_phong(s, g)", "brdf_blinn_phong(s, back)"),
        ("brdf_cook_torrance(s, g)", "brdf_cook_torrance(s, back)"),
        (
            "brdf_cook_torrance_gauss(s, g)",
            "brdf_cook_torrance_gauss(s, back)",
        ),
        (
            "brdf_cook_torrance_blinn(s, g)",
            "brdf_cook_torrance_blinn(s, back)",
        ),
        ("brdf_oren_nayar(s, g)", "brdf_oren_nayar(s, back)"),
        ("brdf_isle(s, g)", "brdf_isle(s, back)"),
        (
            &format!("brdf_phong(s, {off})"),
            &format!("brdf_phong(s, {off})"),
        ),
    ];
    let both: String = (0..calls.len())
        .map(|k| {
            let ((there, back), to) = (calls[k], 2 * k);
            format!(
                "{{ let f = {there}; let f_back = {back};
                found[to + {to}u] = f.y; found[to + {to}u + 1u] = f_back.y; }}"
            )
        })
        .collect();
    let cases: Vec<Vec<f32>> = brdf_cases().into_iter().step_by(gpu.every).collect();
    let (arity, outputs) = (cases[0].len(), 2 * calls.len());
    let body = format!(
        "let at = index * {arity}u; {BRDF_INPUTS}
        let back = Facing(g.mu_o, g.mu_i, g.cos_d, g.sin2_h); {both}"
    );
    let text = format!("{physics}\n{}", entry("f32", cases.len(), outputs, &body));
    let found = gpu.run(&text, &cases.concat(), cases.len(), outputs);
    let pairs: Vec<Pair> = found
        .chunks(2)
        .map(|both| Pair::new(both[0], f64::from(both[1]), RECIPROCITY))
        .collect();
    judge("reciprocity", &pairs, |i| {
        format!("{}, {:?}", calls[i % calls.len()].0, cases[i / calls.len()])
    })
}

/// The shipped physics with one line of it broken.
fn broken(sound: &str, wrong: &str) -> String {
    assert!(PAPER_BSDF.contains(sound), "{sound} is not in the shader");
    PAPER_BSDF.replace(sound, wrong)
}

/// Of a broken shader one case in so many tells.
const BROKEN: usize = 16;

#[test]
fn a_broken_shader_is_found() {
    let gpu = Gpu::sampling(BROKEN);
    let cosine = broken(
        "min(dot(across, across), 1.0)",
        "max(1.0 - dot(n, h) * dot(n, h), 0.0)",
    );
    let power = broken("m_2 * m_2 * m;", "m_2 * m_2;");
    let floor = broken(
        "max(sqrt(distance_squared), LENGTH_MIN)",
        "sqrt(distance_squared)",
    );
    let facets = broken("/ (d * d)", "/ d");
    let coupling = broken(
        "at_i.t * at_o.t * mean.capture",
        "at_i.t * at_i.t * mean.capture",
    );
    let [_, draft, gallery] = brdfs();
    for outcome in [
        compare_facing(&gpu, &cosine),
        schlick().compare(&gpu, &power),
        draft.compare(&gpu, &power),
        compare_lamps(&gpu, &floor, Lamps::Punctual),
        compare_lamps(&gpu, &floor, Lamps::Rectangle),
        distribution().compare(&gpu, &facets),
        gallery.compare(&gpu, &coupling),
        judge_reciprocity(&gpu, &format!("{coupling}\n{}", gpu::baselines())),
    ] {
        assert!(outcome.is_err(), "a broken shader passed: {outcome:?}");
    }
}
