// The floor: what it costs to read the same maps with the same samplers and call it Lambert.

struct Floor {
    clip_from_local: mat4x4<f32>,
    towards_lamp: vec4<f32>,
    row_u: vec4<f32>,
    row_v: vec4<f32>,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> floor_paper: Floor;
@group(#{MATERIAL_BIND_GROUP}) @binding(1) var map_sampler: sampler;
@group(#{MATERIAL_BIND_GROUP}) @binding(2) var albedo_map: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(3) var normal_map: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(4) var roughness_map: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(5) var outline_map: texture_2d<f32>;

struct Varyings {
    @builtin(position) clip: vec4<f32>,
    @location(0) uv: vec2<f32>,
}

@vertex
fn vertex(@location(0) local: vec3<f32>, @location(1) side: vec2<f32>) -> Varyings {
    let p = vec3(side, 1.0);
    let uv = vec2(dot(floor_paper.row_u.xyz, p), dot(floor_paper.row_v.xyz, p));
    return Varyings(floor_paper.clip_from_local * vec4(local, 1.0), uv);
}

@fragment
fn fragment(in: Varyings) -> @location(0) vec4<f32> {
    let albedo = textureSample(albedo_map, map_sampler, in.uv).rgb;
    var light = 1.0;
#ifdef NORMAL_MAP
    let slope = 2.0 * textureSample(normal_map, map_sampler, in.uv).xy - 1.0;
    let n = vec3(slope, sqrt(max(1.0 - dot(slope, slope), 0.0)));
    light = max(dot(n, floor_paper.towards_lamp.xyz), 0.0);
#endif
    // Read, and let in by a hair, so that the compiler keeps them.
#ifdef ROUGHNESS_MAP
    light += 1e-6 * textureSample(roughness_map, map_sampler, in.uv).x;
#endif
#ifdef OUTLINE
    light += 1e-6 * textureSample(outline_map, map_sampler, in.uv).x;
#endif
    return vec4(albedo * light, 1.0);
}
