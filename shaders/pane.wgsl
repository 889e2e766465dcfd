// One display's part of the picture over the whole wall, in that display's own colours.

#import bevy_ui::ui_vertex_output::UiVertexOutput

struct Pane {
    // The part, as shares of the picture: left, top, right, bottom.
    part: vec4<f32>,
    // From linear sRGB to the light of the display's channels.
    rows: mat3x4<f32>,
}

@group(1) @binding(0) var<uniform> pane: Pane;
@group(1) @binding(1) var picture: texture_2d<f32>;
@group(1) @binding(2) var picture_sampler: sampler;
// Of each channel, over the square root of its light: what the surface has to be given, linear.
@group(1) @binding(3) var tone: texture_2d<f32>;

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

@fragment
fn fragment(in: UiVertexOutput) -> @location(0) vec4<f32> {
    let uv = mix(pane.part.xy, pane.part.zw, in.uv);
    let seen = textureSample(picture, picture_sampler, uv).rgb;
    let light = seen * mat3x3<f32>(pane.rows[0].xyz, pane.rows[1].xyz, pane.rows[2].xyz);
    return vec4(toned(light), 1.0);
}
