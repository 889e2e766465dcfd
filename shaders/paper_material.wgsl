// Bevy glue of the sheet's material: bindings, texture reads, entry points. The physics is in
// paper_bsdf.wgsl and paper_media.wgsl. Everything happens in the local frame of one side, in mm: x right, y up,
// z out of the side. The definitions (#ifdef) are set from `Terms` in src/sheet/material.rs.

enable clip_distances;

#import "embedded://recto/paper_bsdf.wgsl"::{
    ALPHA_MIN, INV_PI, MU_MIN,
    Facing, Film, Incidence, Interface, InterfaceMean, InterfaceRow, Light, Seen, Split,
    Surface, Through, Ways,
    albedo_of, beyond_capture, brdf_draft, brdf_gallery, brdf_lambert, brdf_study,
    brdf_study_diffuse, btdf_study, capture_floor, facing, fit_root, fresnel_dielectric,
    ies_angles, interface_at, internal_reflectance, light_disc,
    light_distant, light_ies, light_punctual, light_rectangle, mean_inner_cosine, mean_length,
    optical_depth, path_at, shown_through, split_even, through_study, toned_paper, under_tone,
    widened,
}
#import "embedded://recto/paper_media.wgsl"::{
    CAPTURE_COS_D, SHEEN_MEAN,
    Cover, Particle,
    albedo_under_sheen, alpha_towards, borne_out, brdf_body, brdf_gloss, brdf_sheen, combed_capture, gloss_lobe,
    gloss_lobe_anisotropic, interface_of, mean_of, particle_capture, particle_gloss, particle_lobe,
    passing, shares_of, sheen_albedo, turned, uncovered_share, under_sheen, veiled, with_borne,
}

#ifdef DISPLAY
#import "embedded://recto/display.wgsl"::{dithered}
#endif
#ifdef RELIEF_SHADOWS
#import "embedded://recto/paper_bsdf.wgsl"::{
    Horizon, MARCH_START, MARCH_STEPS, horizon_with, march_growth, march_reach, rise_of, visible_over,
}
#endif
#ifdef TIER_ISLE
#import "embedded://recto/paper_baselines.wgsl"::{brdf_isle}
#endif
#ifdef TIER_PHONG
#import "embedded://recto/paper_baselines.wgsl"::{brdf_phong, off_mirror}
#endif
#ifdef TIER_PHONG_PLAIN
#import "embedded://recto/paper_baselines.wgsl"::{brdf_phong_plain, off_mirror}
#endif
#ifdef TIER_BLINN_PHONG
#import "embedded://recto/paper_baselines.wgsl"::{brdf_blinn_phong}
#endif
#ifdef TIER_BLINN_PHONG_PLAIN
#import "embedded://recto/paper_baselines.wgsl"::{brdf_blinn_phong_plain}
#endif
#ifdef TIER_COOK_TORRANCE
#import "embedded://recto/paper_baselines.wgsl"::{brdf_cook_torrance}
#endif
#ifdef TIER_COOK_TORRANCE_GAUSS
#import "embedded://recto/paper_baselines.wgsl"::{brdf_cook_torrance_gauss}
#endif
#ifdef TIER_COOK_TORRANCE_BLINN
#import "embedded://recto/paper_baselines.wgsl"::{brdf_cook_torrance_blinn}
#endif
#ifdef TIER_OREN_NAYAR
#import "embedded://recto/paper_baselines.wgsl"::{brdf_oren_nayar}
#endif

// Largest value a half-float target holds.
const RADIANCE_MAX: f32 = 65504.0;

// Of half the picture, against seams: well above a rasteriser's step, well below a pixel.
const CLIP_MARGIN: f32 = 2e-5;

// Texture coordinates of a map: rows applied to (x, y, 1) of the side frame.
struct MapPlace {
    row_u: vec3<f32>,
    opacity: f32,
    row_v: vec3<f32>,
    // Overlays: 1 where the lamps light it as they light the paper, 0 where it is a sign.
    lit: f32,
}

#ifdef PARTICLES
// Sorts of particles: a constant, so that what is done for each is written out.
const SORTS: u32 = #{SORTS}u;
#endif

// What lies on both sides, and the lobes of paper that are off by default.
struct Media {
    particles: array<Particle, 6>,
    body_albedo: vec3<f32>,
    body_through: vec3<f32>,
    film_eta: f32,
    film_gain: vec3<f32>,
    body_eta: f32,
    other_body_albedo: vec3<f32>,
    film_reflects: f32,
    other_body_through: vec3<f32>,
    body_reflects: f32,
    other_grains: vec3<f32>,
    sheen: f32,
    // The way the gloss spreads more, a unit vector.
    along: vec2<f32>,
    stretch: f32,
    retro: f32,
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
    // Of both textures of media.
    matter_place: MapPlace,
    media: Media,
    outline_place: MapPlace,
    // Linear level at which a window shows a perfect diffuser (x); the rest is unused.
    level: vec4<f32>,
    // Radiance of the light table behind the sheet, where a perfect diffuser at the reference
    // illuminance shows 1.
    light_table: vec3<f32>,
    // Scale and offset of the stored z of a normal map (xy).
    normal_out: vec4<f32>,
    lights: array<Light, 8>,
    overlays: array<MapPlace, 16>,
    // Of the rules of 1 to 7 points: nodes and weights (xy), and the azimuths of the first quarter
    // of a disc of as many rings (zw).
    quadrature: array<vec4<f32>, 28>,
    // Light through the sheet.
    through: Through,
    // Diffuse part of the bare paper's albedo on the side that is seen, and on the other.
    lit_bare: vec3<f32>,
    f_capture: f32,
    other_bare: vec3<f32>,
    // One over the mean of the transmission map.
    clear_scale: f32,
    other_place: MapPlace,
    other_matter_place: MapPlace,
    // The other side when this one was photographed.
    photographed_place: MapPlace,
    photographed_bare: vec3<f32>,
    transmission_place: MapPlace,
    height_place: MapPlace,
    // Heights of black, and how much higher white is, in mm.
    height_range: vec2<f32>,
    // Size of a texel of the height map in mm.
    height_texel: f32,
    // From √α to a row of `rows`.
    row_scale: f32,
    row_offset: f32,
    // Width over height of the whole picture, and what of it the side is seen in: as `Part` of
    // src/manifest/comparison.rs.
    picture_aspect: f32,
    cut_circle: vec4<f32>,
    cut_lines: array<vec4<f32>, 4>,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> paper: Paper;
@group(#{MATERIAL_BIND_GROUP}) @binding(1) var map_sampler: sampler;
@group(#{MATERIAL_BIND_GROUP}) @binding(2) var albedo_map: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(3) var normal_map: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(4) var roughness_map: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(5) var outline_map: texture_2d<f32>;
#ifdef RELIEF_SHADOWS
@group(#{MATERIAL_BIND_GROUP}) @binding(6) var height_map: texture_2d<f32>;
#endif
@group(#{MATERIAL_BIND_GROUP}) @binding(9) var transmission_map: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(10) var other_map: texture_2d<f32>;
#ifdef IES
@group(#{MATERIAL_BIND_GROUP}) @binding(11) var profiles: texture_2d<f32>;
#endif
#ifdef MATTER
// Shares of film, body colour, and particles of slots 0 and 1; the rest is paper.
@group(#{MATERIAL_BIND_GROUP}) @binding(7) var matter_map: texture_2d<f32>;
#endif
#ifdef MATTER_MORE
// Shares of particles of slots 2 to 5.
@group(#{MATERIAL_BIND_GROUP}) @binding(8) var matter_more_map: texture_2d<f32>;
#endif
#ifdef OTHER_MATTER
// Shares of film, body colour, and particles of all sorts on the other side.
@group(#{MATERIAL_BIND_GROUP}) @binding(12) var other_matter_map: texture_2d<f32>;
#endif
#ifdef COUPLED
@group(#{MATERIAL_BIND_GROUP}) @binding(13) var rows: texture_2d<f32>;
#endif
#ifdef PHOTOGRAPHED
// What the other side showed when this one was photographed.
@group(#{MATERIAL_BIND_GROUP}) @binding(14) var photographed_map: texture_2d<f32>;
#endif
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
#ifdef CUT
    // x, y and w of the clip space.
    @location(5) seen: vec3<f32>,
#endif
#ifdef CLIPS
    // Distances to the lines of the part: what lies beyond one of them is not rasterised.
    @builtin(clip_distances) within: array<f32, 4>,
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
#ifdef CUT
    out.seen = out.clip.xyw;
#endif
#ifdef CLIPS
    for (var k = 0; k < 4; k++) {
        out.within[k] = dot(paper.cut_lines[k].xyz, out.clip.xyw) + CLIP_MARGIN * out.clip.w;
    }
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

#ifdef CUT
fn is_cut_away(seen: vec3<f32>) -> bool {
    let place = seen.xy / seen.z;
    var within = true;
    for (var k = 0; k < 4; k++) {
        within = within && dot(paper.cut_lines[k].xyz, vec3(place, 1.0)) >= 0.0;
    }
    let from_centre = (place - paper.cut_circle.xy) * vec2(paper.picture_aspect, 1.0);
    let r = paper.cut_circle.z;
    return !(within && paper.cut_circle.w * (r * r - dot(from_centre, from_centre)) >= 0.0);
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

#ifdef IES
// Share of an IES lamp's peak at the angles γ and C: linear between columns, and between rows
// around the axis.
fn profile_at(light: Light, angles: vec2<f32>) -> f32 {
    let last = textureDimensions(profiles).x - 1u;
    let column = clamp(angles.x * INV_PI, 0.0, 1.0) * f32(last);
    let i = min(u32(column), last - 1u);
    let row = clamp(angles.y * (0.5 * INV_PI), 0.0, 1.0) * f32(light.profile_rows);
    let j = light.profile_row + u32(row) % light.profile_rows;
    let k = light.profile_row + (u32(row) + 1u) % light.profile_rows;
    let t = column - f32(i);
    let near = mix(
        textureLoad(profiles, vec2(i, j), 0).x, textureLoad(profiles, vec2(i + 1u, j), 0).x, t,
    );
    let far = mix(
        textureLoad(profiles, vec2(i, k), 0).x, textureLoad(profiles, vec2(i + 1u, k), 0).x, t,
    );
    return mix(near, far, fract(row));
}
#endif

// A lamp without area.
fn light_small(light: Light, p: vec3<f32>) -> Incidence {
#ifdef IES
    if light.profile_rows > 0u {
        return light_ies(light, p, profile_at(light, ies_angles(light, p)));
    }
#endif
    return light_punctual(light, p);
}

#ifdef COUPLED
// Rows over √α, narrowed by src/sheet/rows.rs; where there are paths, behind a first row of its
// own. Each holds what is the same for all directions, T and E₂ over powers of √μ with the index of
// the paths, P_c, and P over powers of √μ.
fn row_of(alpha: f32) -> i32 {
    return i32(fit_root(alpha) * paper.row_scale + paper.row_offset);
}

fn interface_mean(y: i32) -> InterfaceMean {
    let m = textureLoad(rows, vec2(0, y), 0);
    return InterfaceMean(m.x, m.y, m.z, m.w);
}

fn interface_row(y: i32) -> InterfaceRow {
    let a = textureLoad(rows, vec2(1, y), 0);
    let b = textureLoad(rows, vec2(2, y), 0);
    let c = textureLoad(rows, vec2(3, y), 0);
    let d = textureLoad(rows, vec2(4, y), 0);
    return InterfaceRow(
        array<f32, 7>(a.x, a.y, a.z, a.w, b.x, b.y, b.z),
        array<f32, 7>(c.x, c.y, c.z, c.w, d.x, d.y, d.z),
    );
}
#endif

#ifdef PATHS
// The first row holds what is the same at every roughness.
fn film_of_rows() -> Film {
    return Film(
        array<vec4<f32>, 7>(
            textureLoad(rows, vec2(0, 0), 0), textureLoad(rows, vec2(1, 0), 0),
            textureLoad(rows, vec2(2, 0), 0), textureLoad(rows, vec2(3, 0), 0),
            textureLoad(rows, vec2(4, 0), 0), textureLoad(rows, vec2(5, 0), 0),
            textureLoad(rows, vec2(6, 0), 0),
        ),
        array<vec4<f32>, 7>(
            textureLoad(rows, vec2(7, 0), 0), textureLoad(rows, vec2(8, 0), 0),
            textureLoad(rows, vec2(9, 0), 0), textureLoad(rows, vec2(10, 0), 0),
            textureLoad(rows, vec2(11, 0), 0), textureLoad(rows, vec2(12, 0), 0),
            textureLoad(rows, vec2(13, 0), 0),
        ),
        textureLoad(rows, vec2(14, 0), 0),
    );
}

fn split_of_rows() -> Split {
    let kappa = textureLoad(rows, vec2(15, 0), 0);
    let at_capture = textureLoad(rows, vec2(16, 0), 0);
    let leaning = textureLoad(rows, vec2(17, 0), 0);
    let of_direction = textureLoad(rows, vec2(18, 0), 0);
    let rest = textureLoad(rows, vec2(19, 0), 0);
    let last = textureLoad(rows, vec2(20, 0), 0);
    return Split(
        kappa.xyz, kappa.w, at_capture.xyz, at_capture.w, leaning.xyz, leaning.w,
        rest.x, rest.y, of_direction, rest.z, rest.w, last.x,
    );
}

fn path_index(y: i32) -> f32 {
    return textureLoad(rows, vec2(2, y), 0).w;
}

fn capture_path(y: i32) -> vec4<f32> {
    return textureLoad(rows, vec2(5, y), 0);
}

fn path_row(y: i32) -> array<vec4<f32>, 7> {
    return array<vec4<f32>, 7>(
        textureLoad(rows, vec2(6, y), 0), textureLoad(rows, vec2(7, y), 0),
        textureLoad(rows, vec2(8, y), 0), textureLoad(rows, vec2(9, y), 0),
        textureLoad(rows, vec2(10, y), 0), textureLoad(rows, vec2(11, y), 0),
        textureLoad(rows, vec2(12, y), 0),
    );
}
#endif

#ifdef RELIEF_SHADOWS
// Height of the relief in mm, averaged over `width` mm.
fn height_at(side: vec2<f32>, width: f32) -> f32 {
    let level = log2(max(width / paper.height_texel, 1.0));
    let stored = textureSampleLevel(
        height_map, map_sampler, place_uv(paper.height_place, side), level,
    ).x;
    return paper.height_range.x + paper.height_range.y * stored;
}

// The horizon towards `l`, above the plane that the sheet has here, for lamps of no less `rise`.
fn march(l: vec3<f32>, rise: f32, side: vec2<f32>, width: f32) -> Horizon {
    var horizon = Horizon(0.0, 1.0);
    let here = height_at(side, width);
    let top = paper.height_range.x + max(paper.height_range.y, 0.0);
    let near = MARCH_START * width;
    let reach = march_reach(top - here, rise);
    if reach < near {
        return horizon;
    }
    // The side frame's y runs down.
    let towards = vec2(l.x, -l.y) / max(length(l.xy), 1e-6);
    let growth = march_growth(near, reach);
    var t = near;
    for (var i = 0u; i < MARCH_STEPS; i++) {
        let higher = height_at(side + towards * t, max(width, t * (growth - 1.0))) - here;
        horizon = horizon_with(horizon, higher, t, width);
        t *= growth;
    }
    return horizon;
}
#endif

#ifndef CLIPS
@fragment
fn fragment(in: Varyings) -> @location(0) vec4<f32> {
#ifdef CUT
    if is_cut_away(in.seen) {
        discard;
    }
#endif
    // Every texture is read before anything branches; only the relief's heights are read at
    // levels of their own.
#ifdef RELIEF_SHADOWS
    let footprint = fwidth(in.side);
    let width = max(paper.height_texel, max(footprint.x, footprint.y));
#endif
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
#ifdef BEHIND
    var other_albedo = paper.other_bare;
#ifdef OTHER_ALBEDO
    other_albedo = textureSample(other_map, map_sampler, place_uv(paper.other_place, in.side)).rgb;
#endif
    var clear = 1.0;
#ifdef TRANSMISSION_MAP
    let clearness = textureSample(
        transmission_map, map_sampler, place_uv(paper.transmission_place, in.side),
    ).x;
    clear = clearness * paper.clear_scale;
#endif
#ifdef OTHER_MATTER
    let other_matter = textureSample(
        other_matter_map, map_sampler, place_uv(paper.other_matter_place, in.side),
    );
#endif
#ifdef PHOTOGRAPHED
    let photographed_albedo = textureSample(
        photographed_map, map_sampler, place_uv(paper.photographed_place, in.side),
    ).rgb;
#endif
#endif
#ifdef MATTER
    let matter = textureSample(matter_map, map_sampler, map_uv(paper.matter_place, in));
#ifdef PARTICLES
    var coverages = array<f32, 6>(matter.z, matter.w, 0.0, 0.0, 0.0, 0.0);
#ifdef MATTER_MORE
    let more = textureSample(matter_more_map, map_sampler, map_uv(paper.matter_place, in));
    coverages[2] = more.x;
    coverages[3] = more.y;
    coverages[4] = more.z;
    coverages[5] = more.w;
#endif
#endif
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
#ifdef RELIEF_SHADOWS
    // Columns are the axes of the sheet's plane here.
    var plane = mat3x3(vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0));
#ifdef CURVED
    plane = mat3x3(tangent, cross(geometric, tangent), geometric);
#endif
#endif

#ifdef PARALLEL_EYE
    let v = paper.eye.xyz;
#else
    let v = normalize(paper.eye.xyz - in.local);
#endif
#ifdef MATTER
    var cover = Cover(0.0, matter.y, 0.0, vec3(0.0));
#ifdef PARTICLES
    for (var k = 0u; k < SORTS; k++) {
        cover.particles += coverages[k];
        cover.grains += coverages[k] * paper.media.particles[k].albedo;
    }
#endif
    let open = max(1.0 - cover.particles - cover.body, 0.0);
    cover.film = clamp(matter.x / max(open, 1e-4), 0.0, 1.0);
#endif
    var eta = paper.eta;
    var f_capture = paper.f_capture;
#ifdef MEDIA_INDEX
    // Of what has a dielectric surface; without any, nothing asks for its index.
    let dielectric = max(1.0 - cover.particles, 1e-4);
    let of_film = min(matter.x / dielectric, 1.0);
    let of_body = min(matter.y / dielectric, 1.0);
    eta += of_film * (paper.media.film_eta - paper.eta) + of_body * (paper.media.body_eta - paper.eta);
    let reflects = 1.0 + of_film * (paper.media.film_reflects - 1.0)
        + of_body * (paper.media.body_reflects - 1.0);
    f_capture = fresnel_dielectric(CAPTURE_COS_D, eta);
#endif
#ifdef SHEEN
    var sheen = paper.media.sheen;
#ifdef MATTER
    sheen *= open * (1.0 - cover.film);
#endif
    albedo = albedo_under_sheen(sheen, albedo);
#endif
#ifdef ANISOTROPIC
    f_capture *= combed_capture(alpha, paper.media.stretch);
#endif
    let s = Surface(albedo, alpha, eta, paper.f_normal, paper.specular, f_capture);
#ifdef COUPLED
#ifdef ANISOTROPIC
    let y = row_of(alpha_towards(alpha, paper.media.stretch, vec3(0.0, 0.0, 1.0)));
    var grain_way = vec3(paper.media.along, 0.0);
#ifdef CURVED
    grain_way = tangent * paper.media.along.x + cross(geometric, tangent) * paper.media.along.y;
#endif
    // Rows of the frame in which the facets' longer axis is x.
    let along = normalize(grain_way - n * dot(n, grain_way));
    let frame = transpose(mat3x3(along, cross(n, along), n));
    let framed_v = frame * v;
#else
    let y = row_of(alpha);
#endif
    let row = interface_row(y);
    var mean = interface_mean(y);
    var at_o = interface_at(row, max(dot(n, v), MU_MIN));
#ifdef ANISOTROPIC
    let y_o = row_of(alpha_towards(alpha, paper.media.stretch, framed_v));
    at_o = interface_at(interface_row(y_o), max(dot(n, v), MU_MIN));
#endif
#ifdef MEDIA_INDEX
    mean = mean_of(mean, reflects);
    at_o = interface_of(at_o, reflects);
#endif
#ifdef MATTER
#ifdef PARTICLES
    let borne = borne_out(s, mean, paper.lit_bare, paper.media.body_albedo, cover);
    cover = with_borne(cover, borne);
#endif
    let shares = shares_of(s, mean, paper.lit_bare, paper.media.body_albedo, cover);
    var paper_albedo = shares.paper;
    let surface = shares.surface;
    var share_f = uncovered_share(shares, paper.lit_bare);
#ifdef MEDIA_INDEX
    share_f *= 1.0 + cover.film * (paper.media.film_gain - 1.0);
#endif
#else
    var paper_albedo = albedo_of(s, mean);
    let surface = 1.0;
    let share_f = paper_albedo / paper.lit_bare;
#endif
#endif
#ifdef PATHS
    // Films lie under the facets as they are, combed or not.
    let film = film_of_rows();
    let split = split_of_rows();
    let y_films = row_of(alpha);
    let paths = path_row(y_films);
    let path_n = path_index(y_films);
    let capture = capture_path(y_films);
    let path_o = path_at(paths, dot(n, v), path_n);
#endif
#ifdef TIER_STUDY
    let darkness = optical_depth(film, capture, share_f);
#ifdef MATTER
    // Elsewhere the paper itself is dark.
    let depth = darkness * cover.film;
#else
    let depth = darkness;
#endif
#endif
#ifdef PARTICLES
    // How much of each sort mirrors, and what all of them scatter.
    var gloss = array<f32, 6>();
    var grain_alphas = array<f32, 6>();
    var grains = vec3(0.0);
    for (var k = 0u; k < SORTS; k++) {
        let covered = coverages[k] * borne;
        if covered > 0.0 {
            let particle = paper.media.particles[k];
            var grain_alpha = particle.alpha;
#ifdef NORMAL_MAP
            grain_alpha = widened(grain_alpha, shortening);
#endif
            let photographed = particle.albedo * shares.scale;
            let mirrored = particle_capture(particle, grain_alpha);
            let mirrors = particle_gloss(photographed, mirrored, shares.lit);
            gloss[k] = mirrors * covered;
            grain_alphas[k] = grain_alpha;
            grains += max(photographed - mirrors * mirrored, vec3(0.0)) * covered;
        }
    }
    var lit_grains = grains * INV_PI;
#ifdef NORMAL_MAP
    lit_grains *= shortening;
#endif
#endif
#ifdef BEHIND
    // Both inks by their photographs, over the bare paper's.
#ifdef COUPLED
    let whole_b = max(other_albedo - capture_floor(s, mean), vec3(0.0)) / paper.other_bare;
#ifdef OTHER_MATTER
    let other_particles = other_matter.z;
    let other_open = max(1.0 - other_particles - other_matter.y, 0.0);
    var other_cover = Cover(
        clamp(other_matter.x / max(other_open, 1e-4), 0.0, 1.0), other_matter.y, other_particles,
        paper.media.other_grains * other_particles,
    );
    let of_other = Surface(other_albedo, alpha, eta, paper.f_normal, paper.specular, f_capture);
    let other_body = paper.media.other_body_albedo;
    other_cover = with_borne(
        other_cover, borne_out(of_other, mean, paper.other_bare, other_body, other_cover),
    );
    let other = shares_of(of_other, mean, paper.other_bare, other_body, other_cover);
    let share_b = max(uncovered_share(other, paper.other_bare), vec3(0.0));
#else
    let share_b = whole_b;
#endif
#else
    let share_f = albedo / paper.lit_bare;
    let share_b = other_albedo / paper.other_bare;
#endif
#ifdef TIER_STUDY
    var ink_f = share_f;
    var ink_b = share_b;
#ifdef MATTER
    // Where no ink lies, the paper itself is dark or light.
    let toned = toned_paper(paper.through, share_f);
    ink_f = mix(vec3(1.0), ink_f, cover.film);
#endif
#ifdef OTHER_MATTER
    ink_b = mix(vec3(1.0), ink_b, other_cover.film);
#endif
    var rho_f = internal_reflectance(film, ink_f);
    var rho_b = internal_reflectance(film, ink_b);
#ifdef SHOW_THROUGH
    var rho_shown = rho_b;
    var rho_bare = internal_reflectance(film, vec3(1.0));
    var rho_photographed = rho_bare;
#ifdef OTHER_MATTER
    // What covers the other side counts as ink that photographs as dark.
    rho_shown = mix(
        internal_reflectance(film, whole_b), rho_shown,
        max(1.0 - other_cover.particles - other_cover.body, 0.0),
    );
#endif
#ifdef PHOTOGRAPHED
    // By the darkness alone on both, so that the paper's own tone is in both.
    let share_photographed = max(photographed_albedo - capture_floor(s, mean), vec3(0.0))
        / paper.photographed_bare;
    rho_shown = internal_reflectance(film, whole_b);
    rho_photographed = internal_reflectance(film, share_photographed);
#endif
#endif
#ifdef MEDIA_INDEX
    // The film's numbers are of its own index; where none lies, the boundary is the paper's.
    let r_i = vec3(max(1.0 - interface_mean(y).t_mean / (paper.eta * paper.eta), 0.0));
    let of_boundary = r_i / max(internal_reflectance(film, vec3(1.0)), vec3(1e-3));
    rho_f = mix(r_i, internal_reflectance(film, share_f), cover.film);
    rho_b *= of_boundary;
#ifdef SHOW_THROUGH
    rho_shown *= of_boundary;
    rho_photographed *= of_boundary;
    rho_bare = r_i;
#endif
#endif
#ifdef SHOW_THROUGH
    var shown = shown_through(
        paper.through, clear, rho_f, rho_shown, rho_photographed, rho_bare,
    );
#ifdef MATTER
    shown = mix(under_tone(shown, toned, share_f), shown, cover.film);
#endif
    // No more than a sheet that gives back all light can photograph.
    paper_albedo = min(paper_albedo * shown, vec3(1.0 / (mean.t_mean * mean.capture)));
#endif
#endif
#endif
#ifdef TRANSMISSION
#ifdef TIER_STUDY
    // What covers either side lets less through.
    var baked = vec3(1.0);
    var depth_f = darkness;
    var depth_b = optical_depth(film, capture, share_b);
#ifdef MATTER
    baked *= passing(cover, paper.media.body_through, toned);
    depth_f = veiled(cover, paper.media.body_through, toned, darkness);
#endif
#ifdef OTHER_MATTER
    // The paper's own tone is seen, and counted, on this side.
    baked *= passing(other_cover, paper.media.other_body_through, vec3(1.0));
    depth_b = veiled(other_cover, paper.media.other_body_through, vec3(1.0), depth_b);
#endif
#ifdef SHEEN
    baked *= 1.0 - sheen * sheen_albedo(max(dot(n, v), MU_MIN));
#endif
    let seen = Seen(depth_f, clear, depth_b, rho_f, rho_b);
#else
    // Light crosses each ink once, where the photograph saw it crossed twice.
    let baked = sqrt(clamp(share_f, vec3(0.0), vec3(1.0)) * clamp(share_b, vec3(0.0), vec3(1.0)));
#ifdef COUPLED
    let r_i = vec3(1.0 - mean.t_mean / (s.eta * s.eta));
    let seen = Seen(vec3(0.0), clear, vec3(0.0), r_i, r_i);
#endif
#endif
#endif
    // The surface under directed light: its mean normal is `shortening` times the unit one.
    var lit = s;
#ifdef NORMAL_MAP
    lit.albedo *= shortening;
#endif
    var radiance = vec3(0.0);
#ifdef TRANSMISSION
#ifdef COUPLED
    let crossed = through_study(film, paper.through, seen, at_o, mean, path_o, s.eta);
#else
    let crossed = paper.through.flat_share * clear;
#endif
    radiance += crossed * baked * paper.light_table;
#endif
#ifdef ONE_LAMP
    {
        let light = paper.lights[0];
#else
    for (var k = 0u; k < paper.lamp_count; k++) {
        let light = paper.lights[k];
#endif
#ifdef RELIEF_SHADOWS
        let to_lamp = (light.place - light.near * in.local) * plane;
        var lowest = to_lamp;
#ifdef AREA_LAMPS
        if light.grid + light.rings > 0u {
            lowest.z -= abs(dot(light.half_edge_u, plane[2])) + abs(dot(light.half_edge_v, plane[2]));
        }
#endif
        let horizon = march(to_lamp, rise_of(lowest), in.side, width);
#endif
#ifdef AREA_LAMPS
        let spokes = 4u * light.rings;
        let samples = max(light.grid * light.grid + light.rings * spokes, 1u);
        for (var i = 0u; i < samples; i++) {
            var incidence: Incidence;
            if light.rings > 0u {
                let rule = light.rings * (light.rings - 1u) / 2u;
                let ring = paper.quadrature[rule + i / spokes].xy;
                let quarter = i % spokes / light.rings;
                var spoke = paper.quadrature[rule + i % light.rings].zw;
                spoke = select(spoke, vec2(-spoke.y, spoke.x), (quarter & 1u) == 1u);
                spoke = select(spoke, -spoke, quarter >= 2u);
                incidence = light_disc(light, in.local, ring, spoke);
            } else if light.grid == 0u {
                incidence = light_small(light, in.local);
            } else {
                // The rule of n points begins behind those of 1 … n − 1.
                let rule = light.grid * (light.grid - 1u) / 2u;
                let u = paper.quadrature[rule + i % light.grid].xy;
                let v = paper.quadrature[rule + i / light.grid].xy;
                incidence = light_rectangle(light, in.local, u, v);
            }
#else
        {
#ifdef DISTANT_LAMPS
            let incidence = light_distant(light);
#else
            let incidence = light_small(light, in.local);
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
#ifdef COUPLED
                var at_i = interface_at(row, mu_i);
#ifdef ANISOTROPIC
                let framed_l = frame * incidence.l;
                let y_i = row_of(alpha_towards(alpha, paper.media.stretch, framed_l));
                at_i = interface_at(interface_row(y_i), mu_i);
#endif
#ifdef MEDIA_INDEX
                at_i = interface_of(at_i, reflects);
#endif
#ifdef NORMAL_MAP
                // Before the albedo's bounds, as they belong to the paper and not to its relief.
                at_i.t *= shortening;
#endif
#endif
#ifdef TIER_GALLERY
                let f = brdf_gallery(s, facing(n, incidence.l, v), at_i, at_o, mean);
#endif
#ifdef TIER_STUDY
                let g = facing(n, incidence.l, v);
                let ways = Ways(capture, path_at(paths, mu_i, path_n), path_o);
#ifdef GLOSS
                var f = brdf_study_diffuse(
                    s, g, at_i, at_o, mean, split, depth, ways, paper_albedo,
                );
#ifdef ANISOTROPIC
                let straight = gloss_lobe_anisotropic(s, paper.media.stretch, framed_l, framed_v);
#else
                let straight = gloss_lobe(s, g);
#endif
                var back = straight;
#ifdef RETRO
#ifdef ANISOTROPIC
                let framed_turned = vec3(-framed_v.xy, framed_v.z);
                back = gloss_lobe_anisotropic(s, paper.media.stretch, framed_l, framed_turned);
#else
                back = gloss_lobe(s, facing(n, incidence.l, turned(n, v)));
#endif
#endif
                f += surface * brdf_gloss(s, straight, back, paper.media.retro, at_i, at_o, mean);
#else
                var f = brdf_study(
                    s, g, at_i, at_o, mean, split, depth, ways, paper_albedo, surface,
                );
#endif
#ifdef BODY
                f += brdf_body(shares.body, at_i, at_o, mean);
#endif
#ifdef PARTICLES
                f += lit_grains;
                for (var k = 0u; k < SORTS; k++) {
                    if gloss[k] > 0.0 {
                        f += gloss[k] * particle_lobe(paper.media.particles[k], grain_alphas[k], g);
                    }
                }
#endif
#ifdef SHEEN
                f = f * under_sheen(sheen, g.mu_i, g.mu_o) + brdf_sheen(sheen, g.cos_d);
#endif
#endif
#ifdef TIER_ISLE
                let f = brdf_isle(lit, facing(n, incidence.l, v));
#endif
#ifdef TIER_PHONG
                let f = brdf_phong(lit, off_mirror(n, incidence.l, v));
#endif
#ifdef TIER_PHONG_PLAIN
                let f = brdf_phong_plain(lit, facing(n, incidence.l, v), off_mirror(n, incidence.l, v));
#endif
#ifdef TIER_BLINN_PHONG
                let f = brdf_blinn_phong(lit, facing(n, incidence.l, v));
#endif
#ifdef TIER_BLINN_PHONG_PLAIN
                let f = brdf_blinn_phong_plain(lit, facing(n, incidence.l, v));
#endif
#ifdef TIER_COOK_TORRANCE
                let f = brdf_cook_torrance(lit, facing(n, incidence.l, v));
#endif
#ifdef TIER_COOK_TORRANCE_GAUSS
                let f = brdf_cook_torrance_gauss(lit, facing(n, incidence.l, v));
#endif
#ifdef TIER_COOK_TORRANCE_BLINN
                let f = brdf_cook_torrance_blinn(lit, facing(n, incidence.l, v));
#endif
#ifdef TIER_OREN_NAYAR
                let f = brdf_oren_nayar(lit, facing(n, incidence.l, v));
#endif
#ifdef RELIEF_SHADOWS
                radiance += f * incidence.e * (mu_i * visible_over(horizon, rise_of(incidence.l * plane)));
#else
                radiance += f * incidence.e * mu_i;
#endif
            }
#ifdef TRANSMISSION
#ifdef COUPLED
            let behind = -dot(geometric, incidence.l);
            if behind > 0.0 {
                let f = btdf_study(
                    paper.through, seen, interface_at(row, behind), at_o, mean,
                    path_at(paths, behind, path_n), path_o, s.eta,
                );
                radiance += f * baked * incidence.e * behind;
            }
#endif
#endif
        }
    }
#ifdef AMBIENT
#ifdef COUPLED
    var diffuse = paper_albedo * (at_o.t * mean.t_mean * mean.capture);
#ifdef TIER_STUDY
    diffuse *= beyond_capture(depth, capture, film.diffuse_path, path_o)
        * split_even(split, mean_inner_cosine(path_o), depth);
#ifdef BODY
    diffuse += shares.body * (at_o.t * mean.t_mean * mean.capture);
#endif
#ifdef PARTICLES
    // Metal and pigment reflect even light about as at 45°/0°.
    diffuse += grains;
    for (var k = 0u; k < SORTS; k++) {
        diffuse += gloss[k] * paper.media.particles[k].f_capture;
    }
#endif
    var even = diffuse + vec3((1.0 - at_o.t) * surface);
#ifdef SHEEN
    let mirrored_even = sheen * sheen_albedo(max(dot(n, v), MU_MIN));
    even = even * ((1.0 - mirrored_even) * (1.0 - sheen * SHEEN_MEAN)) + mirrored_even;
#endif
    radiance += even * paper.ambient * INV_PI;
#else
    radiance += (diffuse + vec3(1.0 - at_o.t)) * paper.ambient * INV_PI;
#endif
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
#endif
