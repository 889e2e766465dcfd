// The whole picture from the part of the target that was drawn, straight between its pixels.

struct Upscale {
    // Of the part and of the whole, in pixels.
    drawn: vec2<f32>,
    whole: vec2<f32>,
}

@group(0) @binding(0) var target_texture: texture_2d<f32>;
@group(0) @binding(1) var target_sampler: sampler;
@group(0) @binding(2) var<uniform> upscale: Upscale;

@fragment
fn fragment(@location(0) uv: vec2<f32>) -> @location(0) vec4<f32> {
    // Beyond the middle of its last pixels lies what an earlier frame left.
    let at = clamp(uv * upscale.drawn, vec2(0.5), upscale.drawn - 0.5);
    return textureSampleLevel(target_texture, target_sampler, at / upscale.whole, 0.0);
}
