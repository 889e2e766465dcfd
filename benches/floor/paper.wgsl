// The study tier written by hand for one scene: a flat side with a picture and nothing else, one
// distant lamp, a parallel eye. What the glue compiles to costs as much as this where terms
// that a scene does not need cost nothing.

#import "embedded://recto/paper_bsdf.wgsl"::{
    MU_MIN, Film, Interface, InterfaceMean, InterfaceRow, Split, Surface, Ways,
    albedo_of, brdf_study, facing, interface_at, optical_depth, path_at,
}

struct Hand {
    clip_from_local: mat4x4<f32>,
    eye: vec3<f32>,
    alpha: f32,
    towards_lamp: vec3<f32>,
    eta: f32,
    light: vec3<f32>,
    f_normal: f32,
    row_u: vec3<f32>,
    specular: f32,
    row_v: vec3<f32>,
    f_capture: f32,
    lit_bare: vec3<f32>,
    table: vec3<f32>,
    size: vec2<f32>,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> hand: Hand;
@group(#{MATERIAL_BIND_GROUP}) @binding(1) var map_sampler: sampler;
@group(#{MATERIAL_BIND_GROUP}) @binding(2) var albedo_map: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(13) var rows: texture_2d<f32>;

struct Varyings {
    @builtin(position) clip: vec4<f32>,
    @location(0) side: vec2<f32>,
    @location(1) uv: vec2<f32>,
}

@vertex
fn vertex(@location(0) local: vec3<f32>, @location(1) side: vec2<f32>) -> Varyings {
    let p = vec3(side, 1.0);
    let uv = vec2(dot(hand.row_u, p), dot(hand.row_v, p));
    return Varyings(hand.clip_from_local * vec4(local, 1.0), side, uv);
}

// What the side is made of, and what it does at its roughness.
fn made_of(x: i32) -> vec4<f32> {
    return textureLoad(rows, vec2(x, 0), 0);
}

fn texel(x: i32) -> vec4<f32> {
    return textureLoad(rows, vec2(x, 1), 0);
}

@fragment
fn fragment(in: Varyings) -> @location(0) vec4<f32> {
    let albedo = textureSample(albedo_map, map_sampler, in.uv).rgb;
    let inside = min(in.side, hand.size - in.side);
    let steps = clamp(inside / max(fwidth(in.side), vec2(1e-6)) + 0.5, vec2(0.0), vec2(1.0));
    let s = Surface(albedo, hand.alpha, hand.eta, hand.f_normal, hand.specular, hand.f_capture);
    let n = vec3(0.0, 0.0, 1.0);
    let m = texel(0);
    let mean = InterfaceMean(m.x, m.y, m.z, m.w);
    let a = texel(1);
    let b = texel(2);
    let c = texel(3);
    let d = texel(4);
    let row = InterfaceRow(
        array<f32, 7>(a.x, a.y, a.z, a.w, b.x, b.y, b.z),
        array<f32, 7>(c.x, c.y, c.z, c.w, d.x, d.y, d.z),
    );
    let paths = array<vec4<f32>, 7>(
        texel(6), texel(7), texel(8), texel(9), texel(10), texel(11), texel(12),
    );
    let v = hand.eye;
    let l = hand.towards_lamp;
    var radiance = vec3(0.0);
    if l.z > 0.0 {
        let paper = albedo_of(s, mean);
        let capture = texel(5);
        let none = array<vec4<f32>, 7>();
        let film = Film(
            array<vec4<f32>, 7>(
                made_of(0), made_of(1), made_of(2), made_of(3), made_of(4), made_of(5), made_of(6),
            ),
            none, vec4(0.0),
        );
        let k = made_of(15);
        let q = made_of(16);
        let e = made_of(17);
        let r = made_of(19);
        let split = Split(
            k.xyz, k.w, q.xyz, q.w, e.xyz, e.w, r.x, r.y, made_of(18), r.z, r.w, made_of(20).x,
        );
        let depth = optical_depth(film, capture, paper / hand.lit_bare);
        let ways = Ways(capture, path_at(paths, l.z, b.w), path_at(paths, v.z, b.w));
        let f = brdf_study(
            s, facing(n, l, v), interface_at(row, l.z), interface_at(row, max(v.z, MU_MIN)), mean,
            split, depth, ways, paper, 1.0,
        );
        radiance = f * hand.light * l.z;
    }
    return vec4(mix(hand.table, radiance, steps.x * steps.y), 1.0);
}
