// Media on the paper, and the lobes of paper that are off by default: twins, by name and order,
// of src/optics/matter.rs and lobes.rs in f32.
//
// Plain WGSL as paper_bsdf.wgsl, behind which it is read: src/sheet/mod.rs puts the import of
// what it takes from there before it. Symbols, units and sources stand with the f64 twins.

const SHARE_LEAST: f32 = 1e-4;

// Twins of src/optics/matter.rs

struct Particle {
    n: vec3<f32>,
    alpha: f32,
    k: vec3<f32>,
    f_capture: vec3<f32>,
    albedo: vec3<f32>,
}

struct Cover {
    film: f32,
    body: f32,
    particles: f32,
    grains: vec3<f32>,
}

struct Shares {
    paper: vec3<f32>,
    surface: f32,
    body: vec3<f32>,
    uncovered: f32,
    scale: vec3<f32>,
    lit: vec3<f32>,
}

fn borne_out(
    s: Surface,
    mean: InterfaceMean,
    bare: vec3<f32>,
    body: vec3<f32>,
    cover: Cover,
) -> f32 {
    let floor = capture_floor(s, mean);
    let around = bare * (1.0 - cover.body) + body * cover.body + floor;
    let less = (bare + floor) * cover.particles - cover.grains;
    let found = dot(around - s.albedo, less);
    let whole = dot(less, less);
    if whole < 1e-8 {
        return 1.0;
    }
    return clamp(found / whole, 0.0, 1.0);
}

fn with_borne(cover: Cover, borne: f32) -> Cover {
    let particles = cover.particles * borne;
    let before = max(1.0 - cover.particles - cover.body, 0.0);
    let after = max(1.0 - particles - cover.body, SHARE_LEAST);
    return Cover(
        min(cover.film * before / after, 1.0), cover.body, particles, cover.grains * borne,
    );
}

fn shares_of(
    s: Surface,
    mean: InterfaceMean,
    bare: vec3<f32>,
    body: vec3<f32>,
    cover: Cover,
) -> Shares {
    let surface = max(1.0 - cover.particles, 0.0);
    let uncovered = max(surface - cover.body, 0.0);
    let most = vec3(1.0 / (mean.t_mean * mean.capture));
    let floored = s.albedo - capture_floor(s, mean) * surface;
    let lit = min(max(floored, min(s.albedo, vec3(0.0))), most);
    let seen = max(lit, vec3(0.0));
    let covered = body * cover.body + cover.grains;
    let even = seen / max(bare * uncovered + covered, vec3(1e-6));
    let inked = min(seen / max(covered, vec3(1e-6)), vec3(1.0));
    let scale = even + max(inked - even, vec3(0.0)) * cover.film;
    let own = body * cover.body * scale;
    return Shares(lit - covered * scale, surface, own, uncovered, scale, seen);
}

fn uncovered_share(shares: Shares, bare: vec3<f32>) -> vec3<f32> {
    let missing = max(SHARE_LEAST - shares.uncovered, 0.0);
    return (shares.paper + bare * missing) / (bare * max(shares.uncovered, SHARE_LEAST));
}

fn particle_capture(particle: Particle, alpha: f32) -> vec3<f32> {
    let facets = d_ggx(CAPTURE_SIN2_H, alpha) * v_smith(FRAC_1_SQRT_2, 1.0, alpha);
    return particle.f_capture * (PI * facets);
}

fn particle_gloss(albedo: vec3<f32>, mirrored: vec3<f32>, lit: vec3<f32>) -> f32 {
    let dark = albedo / max(mirrored, vec3(1e-6));
    let bright = (1.0 - max(albedo, lit)) / max(1.0 - mirrored, vec3(1e-6));
    let bound = min(dark, bright);
    return clamp(min(bound.x, min(bound.y, bound.z)), 0.0, 1.0);
}

fn particle_lobe(particle: Particle, alpha: f32, g: Facing) -> vec3<f32> {
    let facets = d_ggx(g.sin2_h, alpha) * v_smith(g.mu_i, g.mu_o, alpha);
    return fresnel_conductor(g.cos_d, particle.n, particle.k) * facets;
}

fn brdf_body(
    body: vec3<f32>,
    at_i: Interface,
    at_o: Interface,
    mean: InterfaceMean,
) -> vec3<f32> {
    return body * (at_i.t * at_o.t * mean.capture * INV_PI);
}

fn passing(cover: Cover, body_through: vec3<f32>, toned: vec3<f32>) -> vec3<f32> {
    let uncovered = max(1.0 - cover.particles - cover.body, 0.0);
    return uncovered * (cover.film + toned * (1.0 - cover.film)) + body_through * cover.body;
}

fn veiled(
    cover: Cover, body_through: vec3<f32>, toned: vec3<f32>, depth: vec3<f32>,
) -> vec3<f32> {
    let uncovered = max(1.0 - cover.particles - cover.body, 0.0);
    let beside = uncovered * toned * (1.0 - cover.film) + body_through * cover.body + 1e-6;
    let inked = uncovered * cover.film;
    let passes = inked * exp(-depth) + beside;
    return max(-log(passes / (inked + beside)), vec3(0.0));
}

fn interface_of(at: Interface, reflects: f32) -> Interface {
    return Interface(clamp(1.0 - reflects * (1.0 - at.t), 0.0, 1.0), at.late);
}

fn mean_of(mean: InterfaceMean, reflects: f32) -> InterfaceMean {
    let captured = 1.0 - reflects * (1.0 - sqrt(1.0 / mean.capture));
    let bounces = reflects * reflects;
    return InterfaceMean(
        mean.compensation * bounces,
        1.0 - reflects * (1.0 - mean.t_mean),
        1.0 / (captured * captured),
        mean.floor * bounces,
    );
}

// Twins of src/optics/lobes.rs

const SHEEN_MEAN: f32 = 0.011575;

fn turned(n: vec3<f32>, v: vec3<f32>) -> vec3<f32> {
    return n * (2.0 * dot(n, v)) - v;
}

fn gloss_lobe(s: Surface, g: Facing) -> f32 {
    return d_ggx(g.sin2_h, s.alpha)
        * v_smith(g.mu_i, g.mu_o, s.alpha)
        * fresnel_dielectric(g.cos_d, s.eta);
}

fn gloss_lobe_anisotropic(s: Surface, stretch: f32, l: vec3<f32>, v: vec3<f32>) -> f32 {
    let alpha_x = clamp(s.alpha * stretch, ALPHA_MIN, 1.0);
    let alpha_y = max(s.alpha / stretch, ALPHA_MIN);
    let sum = l + v;
    let h = sum * inverseSqrt(max(dot(sum, sum), LENGTH_MIN * LENGTH_MIN));
    let facets = d_ggx_anisotropic(h.x, h.y, alpha_x, alpha_y)
        * v_smith_anisotropic(l, v, alpha_x, alpha_y);
    return facets * fresnel_dielectric(clamp(dot(l, h), 0.0, 1.0), s.eta);
}

// sin 22.5°
const CAPTURE_SIN_H: f32 = 0.38268343236509;

fn combed_capture_at(alpha_x: f32, alpha_y: f32, x: f32, y: f32) -> f32 {
    let l = FRAC_1_SQRT_2 * vec3(x, y, 1.0);
    return d_ggx_anisotropic(x * CAPTURE_SIN_H, y * CAPTURE_SIN_H, alpha_x, alpha_y)
        * v_smith_anisotropic(l, vec3(0.0, 0.0, 1.0), alpha_x, alpha_y);
}

fn combed_capture(alpha: f32, stretch: f32) -> f32 {
    let alpha_x = clamp(alpha * stretch, ALPHA_MIN, 1.0);
    let alpha_y = max(alpha / stretch, ALPHA_MIN);
    let sum = combed_capture_at(alpha_x, alpha_y, 0.98078528040323, 0.19509032201613)
        + combed_capture_at(alpha_x, alpha_y, 0.83146961230255, 0.55557023301960)
        + combed_capture_at(alpha_x, alpha_y, 0.55557023301960, 0.83146961230255)
        + combed_capture_at(alpha_x, alpha_y, 0.19509032201613, 0.98078528040323);
    let even = d_ggx(CAPTURE_SIN2_H, alpha) * v_smith(FRAC_1_SQRT_2, 1.0, alpha);
    return 0.25 * sum / even;
}

fn alpha_towards(alpha: f32, stretch: f32, d: vec3<f32>) -> f32 {
    let x = min(alpha * stretch, 1.0);
    let y = alpha / stretch;
    let even = 0.5 * (x * x + y * y);
    return sqrt(x * x * d.x * d.x + y * y * d.y * d.y + even * d.z * d.z);
}

fn brdf_gloss(
    s: Surface,
    straight: f32,
    back: f32,
    retro: f32,
    at_i: Interface,
    at_o: Interface,
    mean: InterfaceMean,
) -> f32 {
    let lobe = straight + (back - straight) * retro;
    return s.specular * lobe + mean.compensation * at_i.late * at_o.late;
}

fn sheen_albedo(mu: f32) -> f32 {
    let m = clamp(mu, 0.0, 1.0);
    return (((0.028865 * m - 0.138507) * m + 0.272453) * m - 0.251032) * m + 0.088484;
}

fn brdf_sheen(strength: f32, cos_d: f32) -> f32 {
    let m = clamp(1.0 - cos_d, 0.0, 1.0);
    return strength * m * m * m * m * m;
}

fn under_sheen(strength: f32, mu_i: f32, mu_o: f32) -> f32 {
    return (1.0 - strength * sheen_albedo(mu_i)) * (1.0 - strength * sheen_albedo(mu_o));
}

// cos 22.5°
const CAPTURE_COS_D: f32 = 0.92387953251129;

fn albedo_under_sheen(strength: f32, albedo: vec3<f32>) -> vec3<f32> {
    let own = PI * brdf_sheen(strength, CAPTURE_COS_D);
    return (albedo - own) / under_sheen(strength, FRAC_1_SQRT_2, 1.0);
}
