// One display's part of the picture over the whole wall, in that display's own colours.

#import bevy_ui::ui_vertex_output::UiVertexOutput

struct Pane {
    // The part, as shares of the picture: left, top, right, bottom.
    part: vec4<f32>,
    // From linear sRGB to the light of the display's channels.
    rows: mat3x4<f32>,
    // Whether the display's values stand in the table, and nothing in the rows and the tone.
    has_table: u32,
}

@group(1) @binding(0) var<uniform> pane: Pane;
@group(1) @binding(1) var picture: texture_2d<f32>;
@group(1) @binding(2) var picture_sampler: sampler;
// Of each channel, over the square root of its light: what the surface has to be given, linear.
@group(1) @binding(3) var tone: texture_2d<f32>;
// The display's values over the square roots of red, green and blue light.
@group(1) @binding(4) var table: texture_3d<f32>;
@group(1) @binding(5) var table_sampler: sampler;

fn toned(light: vec3<f32>) -> vec3<f32> {
    let last = f32(textureDimensions(tone).x - 1u);
    let place = sqrt(clamp(light, vec3(0.0), vec3(1.0))) * last;
    let low = floor(place);
    let part = place - low;
    let below = vec3<u32>(low);
    let above = min(below + 1u, vec3(u32(last)));
    return vec3(
        mix(textureLoad(tone, vec2(below.x, 0u), 0).r, textureLoad(tone, vec2(above.x, 0u), 0).r, part.x),
        mix(textureLoad(tone, vec2(below.y, 0u), 0).g, textureLoad(tone, vec2(above.y, 0u), 0).g, part.y),
        mix(textureLoad(tone, vec2(below.z, 0u), 0).b, textureLoad(tone, vec2(above.z, 0u), 0).b, part.z),
    );
}

// What the surface has to be given, linear, so that the table's values come out.
fn looked_up(light: vec3<f32>) -> vec3<f32> {
    let steps = vec3<f32>(textureDimensions(table));
    let place = sqrt(clamp(light, vec3(0.0), vec3(1.0)));
    let value = textureSampleLevel(table, table_sampler, (place * (steps - 1.0) + 0.5) / steps, 0.0).rgb;
    return select(pow((value + 0.055) / 1.055, vec3(2.4)), value / 12.92, value <= vec3(0.04045));
}

@fragment
fn fragment(in: UiVertexOutput) -> @location(0) vec4<f32> {
    let uv = mix(pane.part.xy, pane.part.zw, in.uv);
    let seen = textureSample(picture, picture_sampler, uv).rgb;
    if pane.has_table != 0u {
        return vec4(looked_up(seen), 1.0);
    }
    let light = seen * mat3x3<f32>(pane.rows[0].xyz, pane.rows[1].xyz, pane.rows[2].xyz);
    return vec4(toned(light), 1.0);
}
