// Bevy glue of the sheet's material: bindings, texture reads, entry points. The physics is in
// paper_bsdf.wgsl. Everything happens in the local frame of one side, in mm: x right, y up,
// z out of the side. The definitions (#ifdef) are set from `Terms` in src/sheet/material.rs.

#import "embedded://recto/paper_bsdf.wgsl"::{
    ALPHA_MIN, INV_PI, MU_MIN,
    Facing, Incidence, Interface, InterfaceMean, InterfaceTable, Light, Surface,
    albedo_of, brdf_draft, brdf_gallery, brdf_lambert, facing, fit_powers, interface_at,
    interface_mean_at, interface_row, light_distant, light_punctual, light_rectangle,
    mean_length, widened,
}

// Largest value a half-float target holds.
const RADIANCE_MAX: f32 = 65504.0;

// Texture coordinates of a map: rows applied to (x, y, 1) of the side frame.
struct MapPlace {
    row_u: vec3<f32>,
    opacity: f32,
    row_v: vec3<f32>,
    // Overlays: 1 where the lamps light it as they light the paper, 0 where it is a sign.
    lit: f32,
}

struct Paper {
    clip_from_local: mat4x4<f32>,
    // Place of the eye, or the unit vector towards it (PARALLEL_EYE).
    eye: vec4<f32>,
    ambient: vec3<f32>,
    lamp_count: u32,
    table: vec3<f32>,
    alpha: f32,
    // Albedo of a side without maps.
    bare: vec3<f32>,
    specular: f32,
    size: vec2<f32>,
    eta: f32,
    f_normal: f32,
    // Columns turn the stored x and y of a normal map into those of the side; then the offset.
    normal_axes: vec4<f32>,
    normal_offset: vec2<f32>,
    // What a sign's colour is multiplied by before the display's level, so that it is shown as
    // its legend says.
    sign_gain: f32,
    overlay_count: u32,
    albedo_place: MapPlace,
    normal_place: MapPlace,
    roughness_place: MapPlace,
    outline_place: MapPlace,
    // Linear level at which a window shows a perfect diffuser (x); the rest is unused.
    level: vec4<f32>,
    // Scale and offset of the stored z of a normal map (xy).
    normal_out: vec4<f32>,
    interface_table: InterfaceTable,
    lights: array<Light, 8>,
    overlays: array<MapPlace, 16>,
    // Nodes and weights (xy) of the rules of 2 to 7 points.
    quadrature: array<vec4<f32>, 27>,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> paper: Paper;
@group(#{MATERIAL_BIND_GROUP}) @binding(1) var map_sampler: sampler;
@group(#{MATERIAL_BIND_GROUP}) @binding(2) var albedo_map: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(3) var normal_map: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(4) var roughness_map: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(5) var outline_map: texture_2d<f32>;
#ifdef OVERLAYS
@group(#{MATERIAL_BIND_GROUP}) @binding(16) var overlay_map_a: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(17) var overlay_map_b: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(18) var overlay_map_c: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(19) var overlay_map_d: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(20) var overlay_map_e: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(21) var overlay_map_f: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(22) var overlay_map_g: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(23) var overlay_map_h: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(24) var overlay_map_i: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(25) var overlay_map_j: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(26) var overlay_map_k: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(27) var overlay_map_l: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(28) var overlay_map_m: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(29) var overlay_map_n: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(30) var overlay_map_o: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(31) var overlay_map_p: texture_2d<f32>;
#endif

struct Vertex {
    @location(0) local: vec3<f32>,
    @location(1) side: vec2<f32>,
#ifdef CURVED
    @location(2) normal: vec3<f32>,
    @location(3) tangent: vec4<f32>,
#endif
}

struct Varyings {
    @builtin(position) clip: vec4<f32>,
    @location(0) local: vec3<f32>,
    // Place in the side frame, or the texture coordinates where all maps share them.
    @location(1) side: vec2<f32>,
    @location(2) uv: vec2<f32>,
#ifdef CURVED
    @location(3) normal: vec3<f32>,
    @location(4) tangent: vec3<f32>,
#endif
}

fn place_uv(place: MapPlace, side: vec2<f32>) -> vec2<f32> {
    let p = vec3(side, 1.0);
    return vec2(dot(place.row_u, p), dot(place.row_v, p));
}

@vertex
fn vertex(in: Vertex) -> Varyings {
    var out: Varyings;
    out.clip = paper.clip_from_local * vec4(in.local, 1.0);
    out.local = in.local;
    out.side = in.side;
    out.uv = place_uv(paper.albedo_place, in.side);
#ifdef CURVED
    out.normal = in.normal;
    out.tangent = in.tangent.xyz;
#endif
    return out;
}

fn map_uv(place: MapPlace, in: Varyings) -> vec2<f32> {
#ifdef SHARED_UV
    return in.uv;
#else
    return place_uv(place, in.side);
#endif
}

#ifdef EDGE
// Share of a pixel that the rectangular sheet covers, with a smooth step one pixel wide.
fn edge_coverage(side: vec2<f32>) -> f32 {
    let inside = min(side, paper.size - side);
    let steps = inside / max(fwidth(side), vec2(1e-6)) + 0.5;
    let covered = clamp(steps, vec2(0.0), vec2(1.0));
    return covered.x * covered.y;
}
#endif

#ifdef OVERLAYS
// Adds one overlay (premultiplied colour) to what lies on the paper or above its light.
// The texture is read under uniform control flow: the count of overlays is a uniform.
fn lay(
    map: texture_2d<f32>,
    place: MapPlace,
    side: vec2<f32>,
    albedo: ptr<function, vec3<f32>>,
    sign_colour: ptr<function, vec4<f32>>,
) {
    let uv = place_uv(place, side);
    let texel = textureSample(map, map_sampler, uv);
    let inside = all(uv >= vec2(0.0)) && all(uv <= vec2(1.0));
    let laid = texel * select(0.0, place.opacity, inside);
    if place.lit > 0.5 {
        *albedo = *albedo * (1.0 - laid.a) + laid.rgb;
        *sign_colour = *sign_colour * (1.0 - laid.a);
    } else {
        *sign_colour = *sign_colour * (1.0 - laid.a) + laid;
    }
}
#endif

#ifdef DISPLAY
// Interleaved gradient noise (Jimenez 2014) over one 8-bit step of the display's encoding.
fn dithered(colour: vec3<f32>, pixel: vec2<f32>) -> vec3<f32> {
    let noise = fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))) - 0.5;
    let step = max(2.2 * sqrt(max(colour, vec3(0.0))), vec3(1.0 / 12.92)) / 255.0;
    return max(colour + noise * step, vec3(0.0));
}
#endif

@fragment
fn fragment(in: Varyings) -> @location(0) vec4<f32> {
    // Every texture is read before anything branches.
    var albedo = paper.bare;
#ifdef ALBEDO_MAP
    albedo = textureSample(albedo_map, map_sampler, map_uv(paper.albedo_place, in)).rgb;
#endif
    var n = vec3(0.0, 0.0, 1.0);
#ifdef NORMAL_MAP
    let stored = textureSample(normal_map, map_sampler, map_uv(paper.normal_place, in)).xyz;
    n = vec3(
        paper.normal_axes.xy * stored.x + paper.normal_axes.zw * stored.y + paper.normal_offset,
        paper.normal_out.x * stored.z + paper.normal_out.y,
    );
    // What the spread of the normals under the pixel takes from its diffuse light and adds to
    // its roughness.
    let shortening = mean_length(n);
    n = normalize(n);
#endif
    var alpha = paper.alpha;
#ifdef ROUGHNESS_MAP
    alpha = textureSample(roughness_map, map_sampler, map_uv(paper.roughness_place, in)).x;
    alpha = clamp(alpha, ALPHA_MIN, 1.0);
#endif
#ifdef NORMAL_MAP
    alpha = widened(alpha, shortening);
#endif
    var coverage = 1.0;
#ifdef OUTLINE
    coverage = textureSample(outline_map, map_sampler, map_uv(paper.outline_place, in)).x;
#endif
#ifdef EDGE
    coverage *= edge_coverage(in.side);
#endif
#ifdef OVERLAYS
    var sign_colour = vec4(0.0);
    if paper.overlay_count > 0u {
        lay(overlay_map_a, paper.overlays[0], in.side, &albedo, &sign_colour);
    }
    if paper.overlay_count > 1u {
        lay(overlay_map_b, paper.overlays[1], in.side, &albedo, &sign_colour);
    }
    if paper.overlay_count > 2u {
        lay(overlay_map_c, paper.overlays[2], in.side, &albedo, &sign_colour);
    }
    if paper.overlay_count > 3u {
        lay(overlay_map_d, paper.overlays[3], in.side, &albedo, &sign_colour);
    }
    if paper.overlay_count > 4u {
        lay(overlay_map_e, paper.overlays[4], in.side, &albedo, &sign_colour);
    }
    if paper.overlay_count > 5u {
        lay(overlay_map_f, paper.overlays[5], in.side, &albedo, &sign_colour);
    }
    if paper.overlay_count > 6u {
        lay(overlay_map_g, paper.overlays[6], in.side, &albedo, &sign_colour);
    }
    if paper.overlay_count > 7u {
        lay(overlay_map_h, paper.overlays[7], in.side, &albedo, &sign_colour);
    }
    if paper.overlay_count > 8u {
        lay(overlay_map_i, paper.overlays[8], in.side, &albedo, &sign_colour);
    }
    if paper.overlay_count > 9u {
        lay(overlay_map_j, paper.overlays[9], in.side, &albedo, &sign_colour);
    }
    if paper.overlay_count > 10u {
        lay(overlay_map_k, paper.overlays[10], in.side, &albedo, &sign_colour);
    }
    if paper.overlay_count > 11u {
        lay(overlay_map_l, paper.overlays[11], in.side, &albedo, &sign_colour);
    }
    if paper.overlay_count > 12u {
        lay(overlay_map_m, paper.overlays[12], in.side, &albedo, &sign_colour);
    }
    if paper.overlay_count > 13u {
        lay(overlay_map_n, paper.overlays[13], in.side, &albedo, &sign_colour);
    }
    if paper.overlay_count > 14u {
        lay(overlay_map_o, paper.overlays[14], in.side, &albedo, &sign_colour);
    }
    if paper.overlay_count > 15u {
        lay(overlay_map_p, paper.overlays[15], in.side, &albedo, &sign_colour);
    }
#endif

    var geometric = vec3(0.0, 0.0, 1.0);
#ifdef CURVED
    geometric = normalize(in.normal);
    let tangent = normalize(in.tangent - geometric * dot(geometric, in.tangent));
    n = tangent * n.x + cross(geometric, tangent) * n.y + geometric * n.z;
#endif

#ifdef PARALLEL_EYE
    let v = paper.eye.xyz;
#else
    let v = normalize(paper.eye.xyz - in.local);
#endif
    let s = Surface(albedo, alpha, paper.eta, paper.f_normal, paper.specular);
#ifdef TIER_GALLERY
    var powers = vec4(1.0, 0.0, 0.0, 0.0);
#ifdef ROUGHNESS_MAP
    powers = fit_powers(alpha);
#endif
#ifdef NORMAL_MAP
    powers = fit_powers(alpha);
#endif
    let row = interface_row(paper.interface_table, powers);
    let mean = interface_mean_at(paper.interface_table, powers);
    let at_o = interface_at(row, max(dot(n, v), MU_MIN));
#endif
    // The surface under directed light: its mean normal is `shortening` times the unit one.
    var lit = s;
#ifdef NORMAL_MAP
    lit.albedo *= shortening;
#endif
    var radiance = vec3(0.0);
#ifdef ONE_LAMP
    {
        let light = paper.lights[0];
#else
    for (var k = 0u; k < paper.lamp_count; k++) {
        let light = paper.lights[k];
#endif
#ifdef AREA_LAMPS
        let samples = max(light.grid * light.grid, 1u);
        for (var i = 0u; i < samples; i++) {
            var incidence: Incidence;
            if light.grid == 0u {
                incidence = light_punctual(light, in.local);
            } else {
                // The rule of n points begins behind those of 2 … n − 1.
                let rule = light.grid * (light.grid - 1u) / 2u - 1u;
                let u = paper.quadrature[rule + i % light.grid].xy;
                let v = paper.quadrature[rule + i / light.grid].xy;
                incidence = light_rectangle(light, in.local, u, v);
            }
#else
        {
#ifdef DISTANT_LAMPS
            let incidence = light_distant(light);
#else
            let incidence = light_punctual(light, in.local);
#endif
#endif
            let mu_i = dot(n, incidence.l);
            if mu_i > 0.0 && dot(geometric, incidence.l) > 0.0 {
#ifdef TIER_LAMBERT
                let f = brdf_lambert(lit);
#endif
#ifdef TIER_DRAFT
                let f = brdf_draft(lit, facing(n, incidence.l, v));
#endif
#ifdef TIER_GALLERY
                var at_i = interface_at(row, mu_i);
#ifdef NORMAL_MAP
                // Before the albedo's bounds, as they belong to the paper and not to its relief.
                at_i.t *= shortening;
#endif
                let f = brdf_gallery(s, facing(n, incidence.l, v), at_i, at_o, mean);
#endif
                radiance += f * incidence.e * mu_i;
            }
        }
    }
#ifdef AMBIENT
#ifdef TIER_GALLERY
    let diffuse = albedo_of(s, mean) * (at_o.t * mean.t_mean * mean.capture);
    radiance += (diffuse + vec3(1.0 - at_o.t)) * paper.ambient * INV_PI;
#else
    radiance += brdf_lambert(s) * paper.ambient;
#endif
#endif
#ifdef OVERLAYS
    radiance = radiance * (1.0 - sign_colour.a) + sign_colour.rgb * paper.sign_gain;
#endif
    var colour = mix(paper.table, radiance, coverage);
#ifdef DISPLAY
    // Files keep linear light; their level is applied when they are encoded.
    colour = dithered(colour * paper.level.x, in.clip.xy);
#endif
    return vec4(min(colour, vec3(RADIANCE_MAX)), 1.0);
}
