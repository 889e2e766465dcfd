// What a display needs beyond linear light.

// Interleaved gradient noise (Jimenez 2014) over one 8-bit step of the display's encoding.
fn dithered(colour: vec3<f32>, pixel: vec2<f32>) -> vec3<f32> {
    let noise = fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))) - 0.5;
    let step = max(2.2 * sqrt(max(colour, vec3(0.0))), vec3(1.0 / 12.92)) / 255.0;
    return max(colour + noise * step, vec3(0.0));
}
