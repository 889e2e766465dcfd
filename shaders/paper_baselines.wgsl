// The baselines of the ladder: twins, by name and order, of src/optics/baselines.rs in f32.
//
// Plain WGSL as paper_bsdf.wgsl, behind which it is read: src/sheet/mod.rs puts the import of
// what it takes from there before it. Symbols, units and sources stand with the f64 twins.

// The smallest base of a power, so that no logarithm is infinite.
const BASE_MIN: f32 = 1e-6;
// The largest exponent of e^−x that is told from 0.
const DECAY_MAX: f32 = 80.0;

// Twins of src/optics/baselines.rs

fn exponent_blinn(alpha: f32) -> f32 {
    return 2.0 * (1.0 - alpha) * (1.0 + alpha) / (alpha * alpha);
}

fn exponent_phong(alpha: f32) -> f32 {
    return 0.25 * exponent_blinn(alpha);
}

// log has an absolute error near 1, which an exponent of 10⁸ would magnify: there its own series.
fn power_below_one(x: f32, n: f32) -> f32 {
    let y = x / (2.0 - min(x, 0.5));
    let y_2 = y * y;
    let series = ((((y_2 / 11.0 + 1.0 / 9.0) * y_2 + 1.0 / 7.0) * y_2 + 0.2) * y_2 + 1.0 / 3.0) * y_2;
    let far = -log(max(1.0 - x, BASE_MIN));
    let decay = select(far, 2.0 * y * (1.0 + series), x < 0.5);
    return exp(-min(n * decay, DECAY_MAX));
}

// asin has an absolute error: halved twice, the angle's square has a short series.
fn angle_squared(sin2: f32) -> f32 {
    let half = sin2 / (2.0 + 2.0 * sqrt(max(1.0 - sin2, 0.0)));
    let t = half / (2.0 + 2.0 * sqrt(1.0 - half));
    let series = (((((0.0487123 * t + 0.0615681) * t + 0.0812698) * t + 0.1142857) * t + 0.1777778)
        * t + 0.3333333) * t;
    return 16.0 * t * (1.0 + series);
}

fn d_gauss(sin2_h: f32, m: f32) -> f32 {
    let w = m * m;
    let norm = ((-0.036954 * w + 0.249574) * w - 0.664818) * w + 1.0;
    return exp(-min(angle_squared(sin2_h) / w, DECAY_MAX)) * INV_PI / (w * norm);
}

fn d_blinn(sin2_h: f32, n: f32) -> f32 {
    return (n + 2.0) * 0.5 * INV_PI * power_below_one(sin2_h, 0.5 * n);
}

fn d_beckmann(sin2_h: f32, alpha: f32) -> f32 {
    let cos2_h = max(1.0 - sin2_h, BASE_MIN);
    let a_2 = alpha * alpha;
    let decay = exp(-min(sin2_h / (cos2_h * a_2), DECAY_MAX));
    return decay * INV_PI / (a_2 * cos2_h * cos2_h);
}

fn v_groove(g: Facing) -> f32 {
    let cos_h = sqrt(max(1.0 - g.sin2_h, 0.0));
    let open = 2.0 * cos_h / max(g.cos_d, MU_MIN);
    return 0.25 * min(1.0, open * min(g.mu_i, g.mu_o)) / (g.mu_i * g.mu_o);
}

fn off_mirror(n: vec3<f32>, l: vec3<f32>, v: vec3<f32>) -> f32 {
    let apart = 2.0 * dot(n, l) * n - l - v;
    return 0.5 * dot(apart, apart);
}

fn lobe_phong(off: f32, n: f32) -> f32 {
    return select(0.0, power_below_one(off, n), off < 1.0);
}

fn brdf_phong_plain(s: Surface, g: Facing, off: f32) -> vec3<f32> {
    let lobe = lobe_phong(off, exponent_phong(s.alpha)) / g.mu_i;
    return (s.albedo + vec3(s.specular * s.f_normal * lobe)) * INV_PI;
}

fn brdf_phong(s: Surface, off: f32) -> vec3<f32> {
    let n = exponent_phong(s.alpha);
    let lobe = 0.5 * (n + 2.0) * lobe_phong(off, n);
    return (s.albedo + vec3(s.specular * s.f_normal * lobe)) * INV_PI;
}

fn brdf_blinn_phong_plain(s: Surface, g: Facing) -> vec3<f32> {
    let lobe = power_below_one(g.sin2_h, 0.5 * exponent_blinn(s.alpha)) / g.mu_i;
    return (s.albedo + vec3(s.specular * s.f_normal * lobe)) * INV_PI;
}

fn brdf_blinn_phong(s: Surface, g: Facing) -> vec3<f32> {
    let n = exponent_blinn(s.alpha);
    let norm = (n + 2.0) * (n + 4.0) / (8.0 * (n + exp2(-0.5 * min(n, DECAY_MAX))));
    let lobe = norm * power_below_one(g.sin2_h, 0.5 * n);
    return (s.albedo + vec3(s.specular * s.f_normal * lobe)) * INV_PI;
}

fn brdf_facets(s: Surface, g: Facing, d: f32) -> vec3<f32> {
    let lobe = d * v_groove(g) * fresnel_schlick(g.cos_d, s.f_normal);
    return s.albedo * INV_PI + vec3(s.specular * lobe);
}

fn brdf_cook_torrance_gauss(s: Surface, g: Facing) -> vec3<f32> {
    return brdf_facets(s, g, d_gauss(g.sin2_h, s.alpha));
}

fn brdf_cook_torrance_blinn(s: Surface, g: Facing) -> vec3<f32> {
    return brdf_facets(s, g, d_blinn(g.sin2_h, exponent_blinn(s.alpha)));
}

fn brdf_cook_torrance(s: Surface, g: Facing) -> vec3<f32> {
    return brdf_facets(s, g, d_beckmann(g.sin2_h, s.alpha));
}

fn brdf_oren_nayar(s: Surface, g: Facing) -> vec3<f32> {
    let sigma_2 = 0.5 * s.alpha * s.alpha;
    let a = 1.0 - 0.5 * sigma_2 / (sigma_2 + 0.33);
    let b = 0.45 * sigma_2 / (sigma_2 + 0.09);
    let along = max(2.0 * g.cos_d * g.cos_d - 1.0 - g.mu_i * g.mu_o, 0.0);
    return s.albedo * INV_PI * (a + b * along / max(g.mu_i, g.mu_o));
}

fn brdf_burley(s: Surface, g: Facing) -> vec3<f32> {
    let f_90 = 0.5 + 2.0 * sqrt(s.alpha) * g.cos_d * g.cos_d;
    let at_i = 1.0 + (f_90 - 1.0) * fresnel_schlick(g.mu_i, 0.0);
    let at_o = 1.0 + (f_90 - 1.0) * fresnel_schlick(g.mu_o, 0.0);
    return s.albedo * INV_PI * (at_i * at_o);
}

fn brdf_isle(s: Surface, g: Facing) -> vec3<f32> {
    let lobe = d_ggx(g.sin2_h, s.alpha)
        * v_smith(g.mu_i, g.mu_o, s.alpha)
        * fresnel_schlick(g.cos_d, s.f_normal);
    return brdf_burley(s, g) + vec3(s.specular * lobe);
}
