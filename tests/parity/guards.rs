//! OPTICS' numeric traps: with the guard against one taken out of the shader, a test must fail.
//!
//! Where a driver happens to be exact, or saturates, without its guard, the text itself is held to
//! the rule.

use recto::sheet::PAPER_MEDIA;

use super::{
    baselines::{self, physics},
    extremes::*,
    interfaces::compare_interfaces,
    study::{compare_anisotropic, conductors},
    *,
};

/// All of the physics, that of media too.
fn whole() -> String {
    // The baselines come last: `loose` tells them apart.
    let physics = physics();
    let (tiers, baselines) = physics
        .split_once(gpu::baselines())
        .unwrap_or((&physics, ""));
    format!("{tiers}{PAPER_MEDIA}\n{}{baselines}", gpu::baselines())
}

/// The physics in which `sound`, standing once in this function, is replaced.
fn without(function: &str, sound: &str, wrong: &str) -> String {
    let physics = whole();
    let begin = physics.find(&format!("fn {function}("));
    let begin = begin.unwrap_or_else(|| panic!("no function {function}"));
    let length = physics[begin..].find("\n}").expect("its end");
    let (before, rest) = physics.split_at(begin);
    let (body, after) = rest.split_at(length);
    let count = body.matches(sound).count();
    assert_eq!(count, 1, "{function}: {sound}");
    format!("{before}{}{after}", body.replace(sound, wrong))
}

type Comparator = fn(&Gpu, &str) -> Result<f64, String>;

/// A guard: the trap's number in OPTICS.md, where it stands, what stands there without it, and
/// what then fails.
struct Guard(u32, &'static str, &'static str, &'static str, Comparator);

const PUNCTUAL: Comparator = |gpu, text| compare_lamps(gpu, text, Lamps::Punctual);
const RECTANGLE: Comparator = |gpu, text| compare_lamps(gpu, text, Lamps::Rectangle);
const DISC: Comparator = |gpu, text| compare_lamps(gpu, text, Lamps::Disc);
const IES: Comparator = |gpu, text| compare_lamps(gpu, text, Lamps::Ies);
const CONDUCTORS: Comparator = |gpu, text| conductors().compare(gpu, text);

const GUARDS: [Guard; 34] = [
    Guard(
        1,
        "facing",
        "min(dot(across, across), 1.0)",
        "max(1.0 - dot(n, h) * dot(n, h), 0.0)",
        compare_facing,
    ),
    Guard(
        2,
        "facing",
        "max(dot(sum, sum), LENGTH_MIN * LENGTH_MIN)",
        "dot(sum, sum)",
        compare_facing,
    ),
    Guard(
        2,
        "fresnel_dielectric",
        "if g_2 <= 0.0 {\n        return 1.0;\n    }",
        "",
        |gpu, text| fresnel().compare(gpu, text),
    ),
    Guard(
        2,
        "fresnel_conductor",
        "max(sqrt(d * d + q * q) + abs(d), vec3(1e-12))",
        "(sqrt(d * d + q * q) + abs(d))",
        CONDUCTORS,
    ),
    Guard(
        2,
        "fresnel_conductor",
        "max(a + c, vec3(1e-6))",
        "(a + c)",
        CONDUCTORS,
    ),
    Guard(
        2,
        "light_punctual",
        "max(sqrt(distance_squared), LENGTH_MIN)",
        "sqrt(distance_squared)",
        PUNCTUAL,
    ),
    Guard(
        2,
        "light_rectangle",
        "max(sqrt(distance_squared), LENGTH_MIN)",
        "sqrt(distance_squared)",
        RECTANGLE,
    ),
    Guard(
        2,
        "light_disc",
        "max(sqrt(distance_squared), LENGTH_MIN)",
        "sqrt(distance_squared)",
        DISC,
    ),
    Guard(
        2,
        "light_ies",
        "max(sqrt(distance_squared), LENGTH_MIN)",
        "sqrt(distance_squared)",
        IES,
    ),
    Guard(
        2,
        "angle_of",
        "max(max(a, b), 1e-30)",
        "max(a, b)",
        compare_angle_of,
    ),
    Guard(
        2,
        "rise_of",
        "max(length(l.xy), 1e-6)",
        "length(l.xy)",
        compare_rises,
    ),
    Guard(
        2,
        "march_reach",
        "max(rise, RISE_MIN)",
        "rise",
        compare_rises,
    ),
    Guard(
        2,
        "d_beckmann",
        "max(1.0 - sin2_h, BASE_MIN)",
        "(1.0 - sin2_h)",
        |gpu, text| baselines::compare("d_beckmann", gpu, text),
    ),
    Guard(
        2,
        "power_below_one",
        "max(1.0 - x, BASE_MIN)",
        "(1.0 - x)",
        |gpu, text| baselines::compare("power_below_one", gpu, text),
    ),
    Guard(
        4,
        "facing",
        "max(dot(n, l), MU_MIN)",
        "dot(n, l)",
        compare_facing,
    ),
    Guard(
        4,
        "facing",
        "max(dot(n, v), MU_MIN)",
        "dot(n, v)",
        compare_facing,
    ),
    Guard(
        4,
        "v_smith_anisotropic",
        "max(v.z, MU_MIN)",
        "v.z",
        compare_anisotropic,
    ),
    Guard(
        4,
        "v_groove",
        "max(g.cos_d, MU_MIN)",
        "g.cos_d",
        |gpu, text| baselines::compare("v_groove", gpu, text),
    ),
    Guard(5, "widened", "ALPHA_MIN, 1.0", "0.0, 1.0", compare_relief),
    Guard(
        5,
        "fit_root",
        "clamp(alpha, ALPHA_FIT_MIN, 1.0)",
        "alpha",
        compare_interfaces,
    ),
    Guard(
        5,
        "brdf_gallery_specular",
        " + mean.compensation * at_i.late * at_o.late",
        "",
        |gpu, text| brdfs()[2].compare(gpu, text),
    ),
    Guard(
        6,
        "single_scatter",
        "select(1.0 - exp(-path), path * (1.0 - 0.5 * path), path < 1e-3)",
        "1.0 - exp(-path)",
        compare_scattering,
    ),
    Guard(
        8,
        "optical_depth",
        "min(depth, vec3(DEPTH_MAX))",
        "depth",
        compare_films,
    ),
    Guard(
        8,
        "optical_depth",
        "max(-log(x) - excess, vec3(0.0))",
        "(-log(x) - excess)",
        compare_films,
    ),
    Guard(
        8,
        "optical_depth",
        "clamp(share, vec3(SHARE_MIN), vec3(1.0))",
        "share",
        compare_films,
    ),
    Guard(
        9,
        "inner_cosine",
        "max((eta - 1.0) * (eta + 1.0) + mu * mu, 0.0)",
        "(eta - 1.0) * (eta + 1.0) + mu * mu",
        compare_inner_cosines,
    ),
    Guard(
        9,
        "inner_cosine",
        "sqrt(max((eta - 1.0) * (eta + 1.0) + mu * mu, 0.0)) / eta",
        "sqrt(max(1.0 - (1.0 - mu * mu) / (eta * eta), 0.0))",
        compare_inner_cosines,
    ),
    Guard(
        9,
        "phase_lobe",
        "max(narrow * narrow + 2.0 * (abs(g) - g * cos_deflection), 1e-6)",
        "narrow * narrow + 2.0 * (abs(g) - g * cos_deflection)",
        compare_scattering,
    ),
    Guard(
        9,
        "single_scatter",
        "clamp(-tangential - inner_i * inner_o, -1.0, 1.0)",
        "-tangential - inner_i * inner_o",
        compare_scattering,
    ),
    Guard(
        11,
        "light_punctual",
        "max(distance_squared, light.distance_squared_min)",
        "distance_squared",
        PUNCTUAL,
    ),
    Guard(
        11,
        "light_rectangle",
        "max(distance_squared, light.distance_squared_min)",
        "distance_squared",
        RECTANGLE,
    ),
    Guard(
        11,
        "light_disc",
        "max(distance_squared, light.distance_squared_min)",
        "distance_squared",
        DISC,
    ),
    Guard(
        11,
        "light_ies",
        "max(distance_squared, light.distance_squared_min)",
        "distance_squared",
        IES,
    ),
    Guard(
        11,
        "light_punctual",
        "clamp((-dot(light.axis, l) - light.cos_falloff) * light.beam_scale, 0.0, 1.0)",
        "(-dot(light.axis, l) - light.cos_falloff) * light.beam_scale",
        PUNCTUAL,
    ),
];

#[test]
fn no_guard_can_be_taken_out() {
    let gpu = Gpu::sampling(8);
    let mut passed = Vec::new();
    let (whole, quick) = (physics(), Gpu::sampling(64));
    for Guard(trap, function, sound, wrong, compare) in &GUARDS {
        compare(&quick, &whole).unwrap();
        if let Ok(error) = compare(&gpu, &without(function, sound, wrong)) {
            passed.push(format!("trap {trap}, {function} without {sound}: {error}"));
        }
    }
    assert!(passed.is_empty(), "\n{}", passed.join("\n"));
}

/// Functions that WGSL lets be loose, or that are 0/0 at a vector of no length.
const LOOSE: [&str; 9] = [
    "pow",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "atan2",
    "normalize",
];
/// The one power that is left: it sets distances of a march, which need no digits.
const ALLOWED: &str = "pow(reach / near, 1.0 / f32(MARCH_STEPS - 1u))";

/// What the physics may not call (traps 3 and 10), and exponentials of a quotient that has no
/// bound: what is wrong with this text.
fn loose(text: &str) -> Vec<String> {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let code: Vec<&str> = text
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default())
        .collect();
    let code = code.join("\n").replace(ALLOWED, "");
    let mut found = Vec::new();
    for name in LOOSE {
        let call = format!("{name}(");
        let alone = |(at, _): &(usize, &str)| !code[..*at].ends_with(is_name);
        let count = code.match_indices(&call).filter(alone).count();
        if count > 0 {
            found.push(format!("{count} × {name}"));
        }
    }
    // In the baselines exponents reach 1e16, where an exponential has no digit left.
    let baselines = code.split("fn exponent_blinn").nth(1).unwrap_or_default();
    for rest in baselines.split("exp(").skip(1) {
        if !rest.starts_with("-min(") {
            found.push(format!("exp({}", rest.lines().next().unwrap_or_default()));
        }
    }
    // Where nothing is mirrored the driver that this was written on takes 0/0 for 0, by luck.
    if code.contains("/ mirrored") {
        found.push("a quotient by what may be nothing".into());
    }
    found
}

#[test]
fn no_loose_function_is_called_and_no_exponent_is_unbounded() {
    assert_eq!(loose(&whole()), [""; 0]);
    for (function, sound, wrong) in [
        ("fresnel_schlick", "m_2 * m_2 * m", "pow(m, 5.0)"),
        (
            "facing",
            "sum * inverseSqrt(max(dot(sum, sum), LENGTH_MIN * LENGTH_MIN))",
            "normalize(sum)",
        ),
        (
            "power_below_one",
            "min(n * decay, DECAY_MAX)",
            "(n * decay)",
        ),
        ("particle_gloss", "max(mirrored, vec3(1e-6))", "mirrored"),
        (
            "d_gauss",
            "min(angle_squared(sin2_h) / w, DECAY_MAX)",
            "acos(sin2_h) / w",
        ),
    ] {
        assert!(
            !loose(&without(function, sound, wrong)).is_empty(),
            "{wrong}"
        );
    }
}
