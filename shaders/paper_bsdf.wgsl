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

fn v_hammon(mu_i: f32, mu_o: f32, alpha: f32) -> f32 {
    let smooth_limit = 2.0 * mu_i * mu_o;
    return 0.5 / (smooth_limit + (mu_i + mu_o - smooth_limit) * alpha);
}

// Twins of src/optics/table.rs

struct Interface {
    t: f32,
    lost: f32,
}

struct InterfaceMean {
    compensation: f32,
    t_mean: f32,
    capture: f32,
}

const ALPHA_FIT_MIN: f32 = 0.1;

// Coefficients over the powers of √μ, each over the powers of √α.
struct InterfaceTable {
    t: array<vec4<f32>, 7>,
    lost: array<vec4<f32>, 4>,
    compensation: vec4<f32>,
    t_mean: vec4<f32>,
    capture: vec4<f32>,
}

// The table at one roughness: what interface_at needs for every direction of a pixel.
struct InterfaceRow {
    t: array<f32, 7>,
    lost: array<f32, 4>,
}

// Powers of √α.
fn fit_powers(alpha: f32) -> vec4<f32> {
    let s = sqrt(clamp(alpha, ALPHA_FIT_MIN, 1.0));
    return vec4(1.0, s, s * s, s * s * s);
}

// `p` are the powers of √α, or (1, 0, 0, 0) for a table at one roughness.
fn interface_row(table: InterfaceTable, p: vec4<f32>) -> InterfaceRow {
    return InterfaceRow(
        array<f32, 7>(
            dot(table.t[0], p), dot(table.t[1], p), dot(table.t[2], p), dot(table.t[3], p),
            dot(table.t[4], p), dot(table.t[5], p), dot(table.t[6], p),
        ),
        array<f32, 4>(
            dot(table.lost[0], p), dot(table.lost[1], p), dot(table.lost[2], p),
            dot(table.lost[3], p),
        ),
    );
}

fn interface_at(row: InterfaceRow, mu: f32) -> Interface {
    let x = sqrt(clamp(mu, 0.0, 1.0));
    let c = row.t;
    let t = (((((c[6] * x + c[5]) * x + c[4]) * x + c[3]) * x + c[2]) * x + c[1]) * x + c[0];
    let d = row.lost;
    let lost = ((d[3] * x + d[2]) * x + d[1]) * x + d[0];
    return Interface(clamp(t, 0.0, 1.0), clamp(lost, 0.0, 1.0));
}

fn interface_mean_at(table: InterfaceTable, p: vec4<f32>) -> InterfaceMean {
    return InterfaceMean(
        max(dot(table.compensation, p), 0.0),
        dot(table.t_mean, p),
        dot(table.capture, p),
    );
}

// Twins of src/optics/tier.rs

struct Surface {
    albedo: vec3<f32>,
    alpha: f32,
    eta: f32,
    f_normal: f32,
    specular: f32,
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

fn albedo_of(s: Surface, mean: InterfaceMean) -> vec3<f32> {
    return min(s.albedo, vec3(1.0 / (mean.t_mean * mean.capture)));
}

fn brdf_gallery(
    s: Surface,
    g: Facing,
    at_i: Interface,
    at_o: Interface,
    mean: InterfaceMean,
) -> vec3<f32> {
    let lobe = d_ggx(g.sin2_h, s.alpha)
        * v_smith(g.mu_i, g.mu_o, s.alpha)
        * fresnel_dielectric(g.cos_d, s.eta);
    let albedo = albedo_of(s, mean);
    let diffuse = at_i.t * at_o.t * mean.capture * INV_PI;
    let compensated = mean.compensation * at_i.lost * at_o.lost;
    return albedo * diffuse + vec3(s.specular * lobe + compensated);
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
