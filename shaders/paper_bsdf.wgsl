// What paper and ink do with light: twins, by name and order, of src/optics in f32.
//
// Plain WGSL: no directives, no textures, no bindings, so that the same text is parsed alone,
// run in compute passes by the tests, and imported by paper_material.wgsl. Symbols, units and
// sources stand with the f64 twins. Struct members must not end in a digit.

const PI: f32 = 3.14159265358979;
// Multiplying is cheaper than dividing, and no less exact here.
const INV_PI: f32 = 0.31830988618379;
const ALPHA_MIN: f32 = 1e-4;
const MU_MIN: f32 = 1e-4;
const LENGTH_MIN: f32 = 1e-6;

// Twins of src/optics/fresnel.rs

fn fresnel_dielectric(cos_i: f32, eta: f32) -> f32 {
    let c = clamp(cos_i, 0.0, 1.0);
    let k = (eta - 1.0) * (eta + 1.0);
    let g_2 = k + c * c;
    if g_2 <= 0.0 {
        return 1.0;
    }
    let g = sqrt(g_2);
    let s = c + g;
    let p = (k + 1.0) * c + g;
    let r_s = k / (s * s);
    let r_p = k * ((k + 2.0) * c * c - 1.0) / (p * p);
    return 0.5 * (r_s * r_s + r_p * r_p);
}

fn fresnel_schlick(cos_i: f32, f_0: f32) -> f32 {
    let m = clamp(1.0 - cos_i, 0.0, 1.0);
    let m_2 = m * m;
    return f_0 + (1.0 - f_0) * m_2 * m_2 * m;
}

fn fresnel_conductor(cos_i: f32, n: vec3<f32>, k: vec3<f32>) -> vec3<f32> {
    let c = clamp(cos_i, 0.0, 1.0);
    let c_2 = c * c;
    let s_2 = 1.0 - c_2;
    let e = (n - 1.0) * (n + 1.0) - k * k;
    let d = e + c_2;
    let q = 2.0 * n * k;
    let half = 0.5 * q * q / max(sqrt(d * d + q * q) + abs(d), vec3(1e-12));
    let over = d >= vec3(0.0);
    let a_2 = select(half, d + half, over);
    let b_2 = select(half - d, half, over);
    let a = sqrt(a_2);
    let sum = max(a + c, vec3(1e-6));
    let difference = select(half - c_2, e + half, over) / sum;
    let r_s = (difference * difference + b_2) / (sum * sum + b_2);
    let p = a * c + s_2;
    let m = a * c - s_2;
    let r_p = r_s * (m * m + b_2 * c_2) / max(p * p + b_2 * c_2, vec3(1e-12));
    return 0.5 * (r_s + r_p);
}

// Twins of src/optics/microfacet.rs

fn d_ggx(sin2_h: f32, alpha: f32) -> f32 {
    let a_2 = alpha * alpha;
    let cos2_h = 1.0 - sin2_h;
    let d = cos2_h * a_2 + sin2_h;
    return a_2 * INV_PI / (d * d);
}

fn v_smith(mu_i: f32, mu_o: f32, alpha: f32) -> f32 {
    let a_2 = alpha * alpha;
    let l_i = mu_o * sqrt(a_2 + (1.0 - a_2) * mu_i * mu_i);
    let l_o = mu_i * sqrt(a_2 + (1.0 - a_2) * mu_o * mu_o);
    return 0.5 / (l_i + l_o);
}

fn d_ggx_anisotropic(h_x: f32, h_y: f32, alpha_x: f32, alpha_y: f32) -> f32 {
    let x = h_x / alpha_x;
    let y = h_y / alpha_y;
    let cos2_h = max(1.0 - h_x * h_x - h_y * h_y, 0.0);
    let d = x * x + y * y + cos2_h;
    return INV_PI / (alpha_x * alpha_y * d * d);
}

fn v_smith_anisotropic(l: vec3<f32>, v: vec3<f32>, alpha_x: f32, alpha_y: f32) -> f32 {
    let scale = vec3(alpha_x, alpha_y, 1.0);
    let l_i = max(v.z, MU_MIN) * length(l * scale);
    let l_o = max(l.z, MU_MIN) * length(v * scale);
    return 0.5 / (l_i + l_o);
}

fn v_hammon(mu_i: f32, mu_o: f32, alpha: f32) -> f32 {
    let smooth_limit = 2.0 * mu_i * mu_o;
    return 0.5 / (smooth_limit + (mu_i + mu_o - smooth_limit) * alpha);
}

// Twins of src/optics/table.rs

struct Interface {
    t: f32,
    late: f32,
}

struct InterfaceMean {
    compensation: f32,
    t_mean: f32,
    capture: f32,
    floor: f32,
}

const ALPHA_FIT_MIN: f32 = 0.1;

// Coefficients over powers of √μ.
struct InterfaceRow {
    t: array<f32, 7>,
    late: array<f32, 7>,
}

fn fit_root(alpha: f32) -> f32 {
    return sqrt(clamp(alpha, ALPHA_FIT_MIN, 1.0));
}

fn interface_at(row: InterfaceRow, mu: f32) -> Interface {
    let x = sqrt(clamp(mu, 0.0, 1.0));
    let c = row.t;
    let t = (((((c[6] * x + c[5]) * x + c[4]) * x + c[3]) * x + c[2]) * x + c[1]) * x + c[0];
    let d = row.late;
    let late =
        (((((d[6] * x + d[5]) * x + d[4]) * x + d[3]) * x + d[2]) * x + d[1]) * x + d[0];
    return Interface(clamp(t, 0.0, 1.0), clamp(late, 0.0, 1.0));
}

// Twins of src/optics/tier.rs

struct Surface {
    albedo: vec3<f32>,
    alpha: f32,
    eta: f32,
    f_normal: f32,
    specular: f32,
    f_capture: f32,
}

struct Facing {
    mu_i: f32,
    mu_o: f32,
    cos_d: f32,
    sin2_h: f32,
}

fn facing(n: vec3<f32>, l: vec3<f32>, v: vec3<f32>) -> Facing {
    let sum = l + v;
    let h = sum * inverseSqrt(max(dot(sum, sum), LENGTH_MIN * LENGTH_MIN));
    let across = cross(n, h);
    return Facing(
        max(dot(n, l), MU_MIN),
        max(dot(n, v), MU_MIN),
        clamp(dot(l, h), 0.0, 1.0),
        min(dot(across, across), 1.0),
    );
}

fn brdf_lambert(s: Surface) -> vec3<f32> {
    return s.albedo * INV_PI;
}

fn brdf_draft(s: Surface, g: Facing) -> vec3<f32> {
    let lobe = d_ggx(g.sin2_h, s.alpha)
        * v_hammon(g.mu_i, g.mu_o, s.alpha)
        * fresnel_schlick(g.cos_d, s.f_normal);
    return s.albedo * INV_PI + vec3(s.specular * lobe);
}

const CAPTURE_SIN2_H: f32 = 0.14644660940673;
const FRAC_1_SQRT_2: f32 = 0.70710678118655;

fn capture_floor(s: Surface, mean: InterfaceMean) -> f32 {
    let lobe = d_ggx(CAPTURE_SIN2_H, s.alpha) * v_smith(FRAC_1_SQRT_2, 1.0, s.alpha);
    return PI * s.specular * lobe * s.f_capture + mean.floor;
}

fn albedo_of(s: Surface, mean: InterfaceMean) -> vec3<f32> {
    let most = vec3(1.0 / (mean.t_mean * mean.capture));
    return min(max(s.albedo - capture_floor(s, mean), min(s.albedo, vec3(0.0))), most);
}

fn brdf_gallery(
    s: Surface,
    g: Facing,
    at_i: Interface,
    at_o: Interface,
    mean: InterfaceMean,
) -> vec3<f32> {
    let diffuse = at_i.t * at_o.t * mean.capture * INV_PI;
    return albedo_of(s, mean) * diffuse + vec3(brdf_gallery_specular(s, g, at_i, at_o, mean));
}

fn brdf_gallery_specular(
    s: Surface,
    g: Facing,
    at_i: Interface,
    at_o: Interface,
    mean: InterfaceMean,
) -> f32 {
    let lobe = d_ggx(g.sin2_h, s.alpha)
        * v_smith(g.mu_i, g.mu_o, s.alpha)
        * fresnel_dielectric(g.cos_d, s.eta);
    return s.specular * lobe + mean.compensation * at_i.late * at_o.late;
}

// Twins of src/optics/refraction.rs

const COSINE_MIN: f32 = 1e-3;

// `row` holds coefficients over powers of √μ, each over powers of w.
fn path_at(row: array<vec4<f32>, 7>, mu: f32, n: f32) -> vec4<f32> {
    let x = sqrt(clamp(mu, 0.0, 1.0));
    let sum = (((((row[6] * x + row[5]) * x + row[4]) * x + row[3]) * x + row[2]) * x + row[1]) * x
        + row[0];
    return sum / smooth_cosine(mu, n);
}

fn smooth_cosine(mu: f32, n: f32) -> f32 {
    return max(inner_cosine(clamp(mu, 0.0, 1.0), n), COSINE_MIN);
}

fn crossed(path: vec4<f32>, tau: vec3<f32>) -> vec3<f32> {
    let w = tau / (1.0 + tau);
    let p = path.x + w * (path.y + w * (path.z + w * path.w));
    return exp(-tau * max(p, vec3(1.0)));
}

fn mean_inner_cosine(path: vec4<f32>) -> f32 {
    return 1.0 / max(path.x + 0.5 * (path.y + 0.5 * (path.z + 0.5 * path.w)), 1.0);
}

fn steeper_by(path: vec4<f32>, tau: vec3<f32>) -> vec3<f32> {
    let w = tau / (1.0 + tau);
    let p = path.x + w * (path.y + w * (path.z + w * path.w));
    let slope = path.y + w * (2.0 * path.z + w * (3.0 * path.w));
    let left = max(p + w * (1.0 - w) * slope, vec3(1.0));
    return max(1.0 / left - 1.0 / max(path.x, 1.0), vec3(0.0));
}

// Twins of src/optics/ink.rs

const DEPTH_MAX: f32 = 20.0;
const SHARE_MIN: f32 = 1e-20;
const DEPTH_STEPS: u32 = 4u;

// Coefficients over powers of u (rgb); the last is over powers of w.
struct Film {
    excess: array<vec4<f32>, 7>,
    internal: array<vec4<f32>, 7>,
    diffuse_path: vec4<f32>,
}

fn inner_cosine(mu: f32, eta: f32) -> f32 {
    // 1 − (1 − μ²)/n² would cancel at grazing angles where n is near 1.
    return sqrt(max((eta - 1.0) * (eta + 1.0) + mu * mu, 0.0)) / eta;
}

fn optical_depth(film: Film, capture: vec4<f32>, share: vec3<f32>) -> vec3<f32> {
    let x = clamp(share, vec3(SHARE_MIN), vec3(1.0));
    let u = sqrt(x);
    let c = film.excess;
    let excess = (((((c[6].xyz * u + c[5].xyz) * u + c[4].xyz) * u + c[3].xyz) * u + c[2].xyz) * u
        + c[1].xyz) * u + c[0].xyz;
    let crossing = max(-log(x) - excess, vec3(0.0));
    var depth = crossing / capture.x;
    for (var i = 0u; i < DEPTH_STEPS; i++) {
        let w = depth / (1.0 + depth);
        let path = capture.x + w * (capture.y + w * (capture.z + w * capture.w));
        depth = crossing / max(path, vec3(2.0));
    }
    return min(depth, vec3(DEPTH_MAX));
}

fn internal_reflectance(film: Film, share: vec3<f32>) -> vec3<f32> {
    let u = sqrt(clamp(share, vec3(0.0), vec3(1.0)));
    let c = film.internal;
    let rho = (((((c[6].xyz * u + c[5].xyz) * u + c[4].xyz) * u + c[3].xyz) * u + c[2].xyz) * u
        + c[1].xyz) * u + c[0].xyz;
    return clamp(rho, vec3(0.0), vec3(1.0));
}

fn beyond_capture(
    tau: vec3<f32>, capture: vec4<f32>, path_i: vec4<f32>, path_o: vec4<f32>,
) -> vec3<f32> {
    let path = path_i + path_o - capture;
    let w = tau / (1.0 + tau);
    return exp(-tau * (path.x + w * (path.y + w * (path.z + w * path.w))));
}

// Twins of src/optics/study.rs

struct Split {
    kappa: vec3<f32>,
    mean: f32,
    at_capture: vec3<f32>,
    depth: f32,
    leaning: vec3<f32>,
    inner_mean: f32,
    alike: f32,
    captured: f32,
    of_direction: vec4<f32>,
    forward_share: f32,
    g_forward: f32,
    g_backward: f32,
}

const DIFFUSE_COSINE: f32 = 0.66666666666667;
const LOST_DEPTH: f32 = 0.16666666666667;

fn phase_lobe(g: f32, cos_deflection: f32) -> f32 {
    // 1 + g² − 2g cosΘ, which would cancel in the lobe's peak.
    let narrow = 1.0 - abs(g);
    let d = max(narrow * narrow + 2.0 * (abs(g) - g * cos_deflection), 1e-6);
    return 0.25 * INV_PI * (1.0 - g * g) / (d * sqrt(d));
}

fn phase_function(split: Split, cos_deflection: f32) -> f32 {
    return split.forward_share * phase_lobe(split.g_forward, cos_deflection)
        + (1.0 - split.forward_share) * phase_lobe(split.g_backward, cos_deflection);
}

fn single_scatter(split: Split, eta: f32, g: Facing, inner_i: f32, inner_o: f32) -> f32 {
    let l_dot_v = 2.0 * g.cos_d * g.cos_d - 1.0;
    let tangential = (l_dot_v - g.mu_i * g.mu_o) / (eta * eta);
    let cos_deflection = clamp(-tangential - inner_i * inner_o, -1.0, 1.0);
    let path = split.depth * (1.0 / inner_i + 1.0 / inner_o);
    // The difference cancels for thin films.
    let left = select(1.0 - exp(-path), path * (1.0 - 0.5 * path), path < 1e-3);
    return phase_function(split, cos_deflection) * left / (inner_i + inner_o);
}

fn split_mean(split: Split, mu: f32) -> f32 {
    let c = split.of_direction;
    let v = mu * mu;
    return c.x + v * (c.y + v * (c.z + v * c.w));
}

fn split_shape(
    split: Split, q: f32, g: Facing, m_i: f32, m_o: f32, depth: vec3<f32>,
) -> vec3<f32> {
    let once = q - split_mean(split, g.mu_i) - split_mean(split, g.mu_o) + split.mean;
    let slanted = 2.0 * split.inner_mean - m_i - m_o;
    let lost = depth / (depth + LOST_DEPTH) * (split.inner_mean - DIFFUSE_COSINE);
    let alike = (m_i - split.inner_mean) * (m_o - split.inner_mean)
        + lost * (m_i + m_o - split.captured);
    let shape = 1.0 + split.kappa * once + split.leaning * slanted + split.alike * alike;
    return max(shape, vec3(0.0)) * split.at_capture;
}

fn split_even(split: Split, m_o: f32, depth: vec3<f32>) -> vec3<f32> {
    let lost = depth / (depth + LOST_DEPTH) * (split.inner_mean - DIFFUSE_COSINE);
    let alike = lost * (split.inner_mean + m_o - split.captured);
    let slanted = split.inner_mean - m_o;
    return max(1.0 + split.leaning * slanted + split.alike * alike, vec3(0.0)) * split.at_capture;
}

struct Ways {
    capture: vec4<f32>,
    path_i: vec4<f32>,
    path_o: vec4<f32>,
}

fn brdf_study(
    s: Surface,
    g: Facing,
    at_i: Interface,
    at_o: Interface,
    mean: InterfaceMean,
    split: Split,
    depth: vec3<f32>,
    ways: Ways,
    paper: vec3<f32>,
    surface: f32,
) -> vec3<f32> {
    let gloss = brdf_gallery_specular(s, g, at_i, at_o, mean) * surface;
    return brdf_study_diffuse(s, g, at_i, at_o, mean, split, depth, ways, paper) + vec3(gloss);
}

fn brdf_study_diffuse(
    s: Surface,
    g: Facing,
    at_i: Interface,
    at_o: Interface,
    mean: InterfaceMean,
    split: Split,
    depth: vec3<f32>,
    ways: Ways,
    paper: vec3<f32>,
) -> vec3<f32> {
    let inner_i = inner_cosine(g.mu_i, s.eta);
    let inner_o = inner_cosine(g.mu_o, s.eta);
    let q = single_scatter(split, s.eta, g, inner_i, inner_o);
    let m_i = mean_inner_cosine(ways.path_i);
    let m_o = mean_inner_cosine(ways.path_o);
    let shape = split_shape(split, q, g, m_i, m_o, depth);
    let through_ink = beyond_capture(depth, ways.capture, ways.path_i, ways.path_o);
    let coupled = at_i.t * at_o.t * mean.capture;
    return paper * coupled * through_ink * shape * INV_PI;
}

// Twins of src/optics/through.rs

struct Through {
    reflected: vec3<f32>,
    inner_mean: f32,
    transmitted: vec3<f32>,
    ballistic: vec3<f32>,
    reflected_leaning: vec3<f32>,
    transmitted_leaning: vec3<f32>,
    straight_mean: vec3<f32>,
    flat_share: vec3<f32>,
    toned: array<vec3<f32>, 5>,
    lightest: vec3<f32>,
}

const TONE_MIN: f32 = 0.1;
const TONE_LOG_MAX: f32 = 20.0;
const KEPT_WITHIN: f32 = 0.973;

fn crossing(through: Through, seen: Seen, m_f: f32, m_b: vec3<f32>, eta: f32) -> vec3<f32> {
    let t = min(through.transmitted * seen.clear, through.reflected + through.transmitted);
    let r = through.reflected + through.transmitted - t;
    let rho_f = KEPT_WITHIN * seen.rho_f;
    let rho_b = KEPT_WITHIN * seen.rho_b;
    let returned = through.reflected_leaning * seen.clear;
    let leaning_f = through.transmitted_leaning * (1.0 - r * rho_f) - returned * rho_f;
    let leaning_b = through.transmitted_leaning * (1.0 - r * rho_b) - returned * rho_b;
    let steeper_f = max(1.0 + leaning_f * (m_f - DIFFUSE_COSINE), vec3(0.0));
    let steeper_b = max(1.0 + leaning_b * (m_b - DIFFUSE_COSINE), vec3(0.0));
    let passes = (1.0 - r * rho_f) * (1.0 - r * rho_b) - t * t * rho_f * rho_b;
    return t * steeper_f * steeper_b / (eta * eta * passes);
}

fn toned_paper(through: Through, share: vec3<f32>) -> vec3<f32> {
    let x = clamp(share, vec3(TONE_MIN), through.lightest);
    let ln_x = log(x);
    let c = through.toned;
    let ln_t = (((c[4] * ln_x + c[3]) * ln_x + c[2]) * ln_x + c[1]) * ln_x + c[0];
    return exp(min(ln_t, vec3(TONE_LOG_MAX)));
}

struct Seen {
    depth_f: vec3<f32>,
    clear: f32,
    depth_b: vec3<f32>,
    rho_f: vec3<f32>,
    rho_b: vec3<f32>,
}

fn through_study(
    film: Film,
    through: Through,
    seen: Seen,
    at_o: Interface,
    mean: InterfaceMean,
    path_o: vec4<f32>,
    eta: f32,
) -> vec3<f32> {
    let straight = at_o.t * crossed(path_o, through.ballistic);
    let m_o = mean_inner_cosine(path_o);
    let m_i = through.inner_mean + steeper_by(film.diffuse_path, seen.depth_b);
    let whole = crossing(through, seen, m_o, m_i, eta) * mean.t_mean;
    let scattered = max(whole - straight, vec3(0.0)) * crossed(film.diffuse_path, seen.depth_b);
    let front = at_o.t * crossed(path_o, seen.depth_f);
    return front * (scattered + straight * crossed(path_o, seen.depth_b));
}

fn btdf_study(
    through: Through,
    seen: Seen,
    at_i: Interface,
    at_o: Interface,
    mean: InterfaceMean,
    path_i: vec4<f32>,
    path_o: vec4<f32>,
    eta: f32,
) -> vec3<f32> {
    let inks = crossed(path_o, seen.depth_f) * crossed(path_i, seen.depth_b);
    let m_o = mean_inner_cosine(path_o);
    let m_i = mean_inner_cosine(path_i);
    let whole = crossing(through, seen, m_o, vec3(m_i), eta);
    let straight_i = at_i.t * crossed(path_i, through.ballistic);
    let straight_o = at_o.t * crossed(path_o, through.ballistic);
    let straight = straight_i * straight_o / max(through.straight_mean * mean.t_mean, vec3(1e-30));
    return inks * max(whole - straight, vec3(0.0)) * (at_i.t * at_o.t * INV_PI);
}

// Twins of src/optics/show_through.rs

const BACKED_MIN: f32 = 1e-6;
const LIGHTER_MAX: f32 = 10.0;

fn shown_through(
    through: Through,
    clear: f32,
    rho_f: vec3<f32>,
    rho_b: vec3<f32>,
    rho_photographed: vec3<f32>,
    rho_bare: vec3<f32>,
) -> vec3<f32> {
    let t = min(through.transmitted * clear, through.reflected + through.transmitted);
    let r = through.reflected + through.transmitted - t;
    let front = KEPT_WITHIN * rho_f;
    let back = KEPT_WITHIN * rho_b;
    let before = KEPT_WITHIN * rho_photographed;
    let passes = (1.0 - r * front) * (1.0 - r * back) - t * t * front * back;
    let photographed = r * (1.0 - r * before) + t * t * before;
    let change = t * t * (back - before) / max(passes * photographed, vec3(BACKED_MIN));
    let bare = KEPT_WITHIN * rho_bare;
    let returned = through.reflected_leaning * clear;
    let leaning_f = through.transmitted_leaning * (1.0 - r * front) - returned * front;
    let leaning = through.transmitted_leaning * (1.0 - r * bare) - returned * bare;
    let slant = through.inner_mean - DIFFUSE_COSINE;
    let deeper = clamp(1.0 + leaning_f * slant, vec3(0.5), vec3(2.0))
        / clamp(1.0 + leaning * slant, vec3(0.5), vec3(2.0));
    return clamp(1.0 + change * deeper * deeper, vec3(0.0), vec3(LIGHTER_MAX));
}

fn under_tone(shown: vec3<f32>, toned: vec3<f32>, share: vec3<f32>) -> vec3<f32> {
    let dimmed = toned * toned / max(share, vec3(TONE_MIN));
    return 1.0 + (shown - 1.0) * min(dimmed, vec3(1.0));
}

// Twins of src/optics/lamp.rs. A lamp of any shape in one layout, narrowed on the CPU by
// src/sheet/uniform.rs, so that lamps without area need no branch.

struct Light {
    // Towards a distant lamp, or the place of any other in mm.
    place: vec3<f32>,
    // 0 for a distant lamp, 1 for any other.
    near: f32,
    amount: vec3<f32>,
    // Samples along each edge of a rectangle; 0 for lamps without area.
    grid: u32,
    axis: vec3<f32>,
    // A spot's 1/(cos hotspot − cos fall-off).
    beam_scale: f32,
    half_edge_u: vec3<f32>,
    cos_falloff: f32,
    half_edge_v: vec3<f32>,
    distance_squared_min: f32,
    // Rings of samples of a disc; 0 for any other lamp.
    rings: u32,
    // First row and count of rows of an IES lamp's profile; no rows for any other lamp.
    profile_row: u32,
    profile_rows: u32,
}

struct Incidence {
    l: vec3<f32>,
    e: vec3<f32>,
}

fn light_distant(light: Light) -> Incidence {
    return Incidence(light.place, light.amount);
}

fn light_punctual(light: Light, p: vec3<f32>) -> Incidence {
    let towards = light.place - light.near * p;
    let distance_squared = dot(towards, towards);
    let l = towards / max(sqrt(distance_squared), LENGTH_MIN);
    let beam = clamp((-dot(light.axis, l) - light.cos_falloff) * light.beam_scale, 0.0, 1.0);
    return Incidence(l, light.amount * (beam / max(distance_squared, light.distance_squared_min)));
}

// `u` and `v` are a node on [−1, 1] and its weight along each edge (src/optics/quadrature.rs):
// a table of them here would be copied for every sample.
fn light_rectangle(light: Light, p: vec3<f32>, u: vec2<f32>, v: vec2<f32>) -> Incidence {
    let towards = light.place + light.half_edge_u * u.x + light.half_edge_v * v.x - p;
    let distance_squared = dot(towards, towards);
    let l = towards / max(sqrt(distance_squared), LENGTH_MIN);
    let emits = max(-dot(light.axis, l), 0.0) * u.y * v.y;
    return Incidence(l, light.amount * (emits / max(distance_squared, light.distance_squared_min)));
}

// A disc's radii are its half edges. `ring` is a node on [−1, 1] and its weight, `spoke` the unit
// vector of one of the 4 azimuths per ring and ring.
fn light_disc(light: Light, p: vec3<f32>, ring: vec2<f32>, spoke: vec2<f32>) -> Incidence {
    let r = sqrt(0.5 + 0.5 * ring.x);
    let place = light.place + (light.half_edge_u * spoke.x + light.half_edge_v * spoke.y) * r;
    let towards = place - p;
    let distance_squared = dot(towards, towards);
    let l = towards / max(sqrt(distance_squared), LENGTH_MIN);
    let share = ring.y / (4.0 * f32(light.rings));
    let emits = max(-dot(light.axis, l), 0.0) * share;
    return Incidence(l, light.amount * (emits / max(distance_squared, light.distance_squared_min)));
}

// Angle of (x, y) from the x axis, −π to π, within 2e-6: Abramowitz & Stegun 4.4.49 (2e-8 in
// exact arithmetic), as atan2 may be off by 4096 ULP.
fn angle_of(x: f32, y: f32) -> f32 {
    let a = abs(x);
    let b = abs(y);
    let t = min(a, b) / max(max(a, b), 1e-30);
    let s = t * t;
    var angle = t * (1.0 + s * (-0.3333314528 + s * (0.1999355085 + s * (-0.1420889944
        + s * (0.1065626393 + s * (-0.0752896400 + s * (0.0429096138
        + s * (-0.0161657367 + s * 0.0028662257))))))));
    angle = select(angle, 0.5 * PI - angle, b > a);
    angle = select(angle, PI - angle, x < 0.0);
    return select(angle, -angle, y < 0.0);
}

// γ in 0…π and C in 0…2π in which an IES lamp is seen from `p`. The half edges are its C = 0° and
// 90°.
fn ies_angles(light: Light, p: vec3<f32>) -> vec2<f32> {
    let d = p - light.place;
    let l = d / max(sqrt(dot(d, d)), LENGTH_MIN);
    let u = dot(light.half_edge_u, l);
    let v = dot(light.half_edge_v, l);
    let c = angle_of(u, v);
    return vec2(
        angle_of(dot(light.axis, l), sqrt(u * u + v * v)),
        select(c, c + 2.0 * PI, c < 0.0),
    );
}

// `share` of the peak, looked up at ies_angles.
fn light_ies(light: Light, p: vec3<f32>, share: f32) -> Incidence {
    let towards = light.place - p;
    let distance_squared = dot(towards, towards);
    let l = towards / max(sqrt(distance_squared), LENGTH_MIN);
    return Incidence(l, light.amount * (share / max(distance_squared, light.distance_squared_min)));
}

// Twins of src/optics/relief.rs

const MEAN_LENGTH_MIN: f32 = 0.1;
const SHORTENING_NOISE: f32 = 1e-4;

fn mean_length(mean: vec3<f32>) -> f32 {
    return sqrt(clamp(dot(mean, mean), MEAN_LENGTH_MIN * MEAN_LENGTH_MIN, 1.0));
}

fn slope_variance(length: f32) -> f32 {
    let l_2 = length * length;
    return max(1.0 - l_2 - SHORTENING_NOISE, 0.0) / l_2;
}

fn widened(alpha: f32, length: f32) -> f32 {
    return clamp(sqrt(alpha * alpha + slope_variance(length)), ALPHA_MIN, 1.0);
}

const MARCH_STEPS: u32 = 16u;
const MARCH_START: f32 = 1.5;
const REACH_MAX: f32 = 10.0;
const RISE_MIN: f32 = 1e-4;

struct Horizon {
    tangent: f32,
    softness: f32,
}

fn rise_of(l: vec3<f32>) -> f32 {
    return l.z / max(length(l.xy), 1e-6);
}

fn march_reach(room: f32, rise: f32) -> f32 {
    return min(max(room, 0.0) / max(rise, RISE_MIN), REACH_MAX);
}

fn march_growth(near: f32, reach: f32) -> f32 {
    return pow(reach / near, 1.0 / f32(MARCH_STEPS - 1u));
}

fn horizon_with(horizon: Horizon, rise: f32, t: f32, width: f32) -> Horizon {
    if rise > horizon.tangent * t {
        return Horizon(rise / t, width / t);
    }
    return horizon;
}

fn visible_over(horizon: Horizon, rise: f32) -> f32 {
    if rise <= 0.0 {
        return 0.0;
    }
    if horizon.tangent <= rise {
        return 1.0;
    }
    return clamp(1.0 + (rise - horizon.tangent) / (rise * horizon.softness), 0.0, 1.0);
}
