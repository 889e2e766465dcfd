// One picture of those of two members, or of one that is enhanced, pixel by pixel. Its f64 twins
// are `lab_from_linear` and `luminance` in src/colour.rs and CIEDE2000 in the crate palette, against which
// tests/frames/compare.rs holds it; sharpening is held against tests/frames/enhance.rs.

#ifdef DISPLAY
#import "embedded://recto/display.wgsl"::{dithered}
#endif

// What is made of both.
const ONE: u32 = 0u;
const BLEND: u32 = 1u;
const DELTA_E: u32 = 2u;
const LUMINANCE: u32 = 3u;
const PI: f32 = 3.14159265358979;

struct Composite {
    // Of light, where a perfect diffuser is shown at the display level `level`.
    stretch: vec2<f32>,
    mode: u32,
    // Share of the second member in a blend.
    at: f32,
    // The difference at the top of the scale.
    full: f32,
    level: f32,
    // 1 where the second is seen from behind, as through glass.
    mirrored: u32,
    // 1 where differences are colours, 0 where they are numbers.
    coded: u32,
    sharpen: f32,
    // Light of the table, in every channel.
    table: f32,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> composite: Composite;
@group(#{MATERIAL_BIND_GROUP}) @binding(1) var first: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(2) var second: texture_2d<f32>;
// The colours of a difference, from none to the top of its scale, in linear light.
@group(#{MATERIAL_BIND_GROUP}) @binding(3) var scale: texture_2d<f32>;

@vertex
fn vertex(@location(0) corner: vec3<f32>) -> @builtin(position) vec4<f32> {
    // Nearest: depth is reversed.
    return vec4(corner.xy, 1.0, 1.0);
}

fn first_at(pixel: vec2<i32>) -> vec3<f32> {
    return textureLoad(first, pixel, 0).rgb;
}

fn second_at(pixel: vec2<i32>) -> vec3<f32> {
    var place = pixel;
    if composite.mirrored == 1u {
        place.x = i32(textureDimensions(second).x) - 1 - place.x;
    }
    return textureLoad(second, place, 0).rgb;
}

// Twin of `luminance`.
fn luminance(rgb: vec3<f32>) -> f32 {
    return dot(rgb, vec3(0.2126390, 0.7151687, 0.0721923));
}

fn lab_f(t: f32) -> f32 {
    if t > 216.0 / 24389.0 {
        return pow(t, 1.0 / 3.0);
    }
    return (24389.0 / 27.0 * t + 16.0) / 116.0;
}

// Twin of `lab_from_linear`: linear sRGB to CIELAB under D65.
fn lab_from_linear(rgb: vec3<f32>) -> vec3<f32> {
    let x = dot(rgb, vec3(0.4123908, 0.3575843, 0.1804808)) / 0.9504559;
    let y = luminance(rgb);
    let z = dot(rgb, vec3(0.0193308, 0.1191948, 0.9505322)) / 1.0890578;
    let f = vec3(lab_f(x), lab_f(y), lab_f(z));
    return vec3(116.0 * f.y - 16.0, 500.0 * (f.x - f.y), 200.0 * (f.y - f.z));
}

fn hue(b: f32, a: f32) -> f32 {
    if a == 0.0 && b == 0.0 {
        return 0.0;
    }
    let h = atan2(b, a);
    return select(h, h + 2.0 * PI, h < 0.0);
}

fn to_seventh(x: f32) -> f32 {
    let cube = x * x * x;
    return cube * cube * x;
}

// Twin of `delta_e00`: CIEDE2000 (Sharma, Wu & Dalal 2005, eq. 2 to 22).
fn delta_e00(lab_1: vec3<f32>, lab_2: vec3<f32>) -> f32 {
    let chroma_mean = 0.5 * (length(lab_1.yz) + length(lab_2.yz));
    // c^7/(c^7 + 25^7), which would overflow.
    let share = 1.0 / (1.0 + to_seventh(25.0 / max(chroma_mean, 1e-4)));
    let g = 1.0 + 0.5 * (1.0 - sqrt(share));
    let a_1 = g * lab_1.y;
    let a_2 = g * lab_2.y;
    let c_1 = length(vec2(a_1, lab_1.z));
    let c_2 = length(vec2(a_2, lab_2.z));
    let h_1 = hue(lab_1.z, a_1);
    let h_2 = hue(lab_2.z, a_2);
    let grey = c_1 * c_2 == 0.0;
    var d_h = h_2 - h_1;
    d_h = select(d_h, d_h - 2.0 * PI, d_h > PI);
    d_h = select(d_h, d_h + 2.0 * PI, d_h < -PI);
    d_h = select(d_h, 0.0, grey);
    let d_l = lab_2.x - lab_1.x;
    let d_c = c_2 - c_1;
    let d_hue = 2.0 * sqrt(c_1 * c_2) * sin(0.5 * d_h);
    let l_mean = 0.5 * (lab_1.x + lab_2.x);
    let c_mean = 0.5 * (c_1 + c_2);
    var h_mean = 0.5 * (h_1 + h_2);
    if abs(h_1 - h_2) > PI {
        h_mean += select(-PI, PI, h_1 + h_2 < 2.0 * PI);
    }
    h_mean = select(h_mean, h_1 + h_2, grey);
    let t = 1.0 - 0.17 * cos(h_mean - PI / 6.0) + 0.24 * cos(2.0 * h_mean)
        + 0.32 * cos(3.0 * h_mean + PI / 30.0) - 0.2 * cos(4.0 * h_mean - 63.0 * PI / 180.0);
    let away = (h_mean * 180.0 / PI - 275.0) / 25.0;
    let d_theta = PI / 6.0 * exp(-away * away);
    let turning = -sin(2.0 * d_theta) * 2.0 * sqrt(1.0 / (1.0 + to_seventh(25.0 / max(c_mean, 1e-4))));
    let from_middle = (l_mean - 50.0) * (l_mean - 50.0);
    let s_l = 1.0 + 0.015 * from_middle / sqrt(20.0 + from_middle);
    let s_c = 1.0 + 0.045 * c_mean;
    let s_h = 1.0 + 0.015 * c_mean * t;
    let l = d_l / s_l;
    let c = d_c / s_c;
    let h = d_hue / s_h;
    return sqrt(max(l * l + c * c + h * h + turning * c * h, 0.0));
}

fn colour_of(share: f32) -> vec3<f32> {
    let last = i32(textureDimensions(scale).x) - 1;
    let place = clamp(share, 0.0, 1.0) * f32(last);
    let low = min(i32(place), last - 1);
    return mix(
        textureLoad(scale, vec2(low, 0), 0).rgb,
        textureLoad(scale, vec2(low + 1, 0), 0).rgb,
        place - f32(low),
    );
}

// Both colours are cleared to the table's, or mixed with nothing of the sheet, exactly.
fn is_table(light: vec3<f32>) -> bool {
    return all(abs(light - vec3(composite.table)) <= vec3(1e-6));
}

// Light that stands for the difference of two members; where neither has sheet, the table.
fn difference(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    if composite.coded == 1u && is_table(a) && is_table(b) {
        return vec3(composite.table);
    }
    var found: f32;
    if composite.mode == DELTA_E {
        // Of what a display shows.
        found = delta_e00(
            lab_from_linear(clamp(a * composite.level, vec3(0.0), vec3(1.0))),
            lab_from_linear(clamp(b * composite.level, vec3(0.0), vec3(1.0))),
        );
    } else {
        found = abs(luminance(a) - luminance(b));
    }
    if composite.coded == 0u {
        return vec3(found);
    }
    return colour_of(found / composite.full) / composite.level;
}

// Light at a pixel, the contrast stretched, where a display shows 1 at 1/level.
fn light(pixel: vec2<i32>) -> vec3<f32> {
    let last = vec2<i32>(textureDimensions(first)) - 1;
    let place = clamp(pixel, vec2(0), last);
    let a = first_at(place);
    if composite.mode == DELTA_E || composite.mode == LUMINANCE {
        return difference(a, second_at(place));
    }
    var seen = a;
    if composite.mode == BLEND {
        seen = mix(a, second_at(place), composite.at);
    }
    let span = composite.stretch.y - composite.stretch.x;
    return (seen - composite.stretch.x / composite.level) / span;
}

// Contrast-adaptive sharpening (Lottes 2019): the less, the nearer the neighbours come to black or
// white.
fn sharpened(pixel: vec2<i32>) -> vec3<f32> {
    let middle = clamp(light(pixel) * composite.level, vec3(0.0), vec3(1.0));
    var low = middle;
    var high = middle;
    var sum = vec3(0.0);
    for (var k = 0; k < 4; k++) {
        let step = array(vec2(0, -1), vec2(-1, 0), vec2(1, 0), vec2(0, 1));
        let beside = clamp(light(pixel + step[k]) * composite.level, vec3(0.0), vec3(1.0));
        low = min(low, beside);
        high = max(high, beside);
        sum += beside;
    }
    let room = clamp(min(low, 1.0 - high) / max(high, vec3(1e-4)), vec3(0.0), vec3(1.0));
    let weight = -sqrt(room) / mix(8.0, 5.0, composite.sharpen);
    return clamp((sum * weight + middle) / (1.0 + 4.0 * weight), vec3(0.0), vec3(1.0)) / composite.level;
}

@fragment
fn fragment(@builtin(position) place: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(place.xy);
    var seen = light(pixel);
    if composite.sharpen > 0.0 && composite.mode != DELTA_E && composite.mode != LUMINANCE {
        seen = sharpened(pixel);
    }
    seen = max(seen, vec3(0.0));
#ifdef DISPLAY
    seen = dithered(seen * composite.level, place.xy);
#endif
    return vec4(seen, 1.0);
}
