#import frame
#import lens
#import bright

// From light to a picture: exposure, a film-like curve, sRGB by the target's format. A grain smaller than a step of
// eight bits hides the steps.
@group(1) @binding(0) var light_map: texture_2d<f32>;
@group(1) @binding(1) var glow_sum: texture_2d<f32>;
@group(1) @binding(2) var shaft_map: texture_2d<f32>;
@group(1) @binding(3) var distance_map: texture_2d<f32>;

// Of the four half-size texels around a pixel those count that are as far away as it is: edges stay sharp.
fn shafts(at: vec2<i32>) -> vec3<f32> {
    let own = textureLoad(distance_map, at, 0).r;
    let size = vec2<i32>(textureDimensions(shaft_map));
    let low = (at - 1) / 2;
    var sum = vec3<f32>(0.0);
    var weights = 1e-6;
    for (var k = 0; k < 4; k++) {
        let texel = min(low + vec2<i32>(k & 1, k >> 1u), size - 1);
        let off = abs(vec2<f32>(at) - 2.0 * vec2<f32>(texel) - 0.5) * 0.5;
        let jump = (textureLoad(distance_map, 2 * texel, 0).r - own) / (0.03 * own + 0.01);
        let w = max((1.0 - off.x) * (1.0 - off.y), 0.02) * max(exp(-jump * jump), 1e-4);
        sum += w * textureLoad(shaft_map, texel, 0).rgb;
        weights += w;
    }
    return sum / weights;
}

// The lens: a veil around the sun as bright as what of it is seen, and faint rings on the line through the picture's middle.
fn glare(at: vec2<f32>) -> vec3<f32> {
    let clip = frame.view_projection * vec4<f32>(frame.eye.xyz + frame.sun.xyz * 1e5, 1.0);
    if (clip.w <= 0.0) { return vec3<f32>(0.0); }
    let sun = clip.xy / clip.w;
    let rim = max(abs(sun.x), abs(sun.y));
    if (rim > 1.2) { return vec3<f32>(0.0); }
    let uv = sun * vec2<f32>(0.5, -0.5) + 0.5;
    let shine = textureSampleLevel(glow_sum, smooth_clamp, uv, 0.0).rgb / frame.bloom.w;
    let power = min(luminance(shine), 12.0) * (1.0 - smooth_between(0.9, 1.2, rim)) * frame.rays.y;
    let wide = vec2<f32>(frame.picture.x / frame.picture.y, 1.0);
    let tint = shine / max(luminance(shine), 1e-4);
    let away = length((at - sun) * wide);
    var sum = tint * (0.020 / (0.08 + away * away * 4.0));
    let places = array<f32, 4>(0.45, -0.35, -0.7, 1.4);
    let sizes = array<f32, 4>(0.05, 0.11, 0.06, 0.16);
    let tints = array<vec3<f32>, 4>(vec3<f32>(0.4, 0.8, 0.5), vec3<f32>(0.8, 0.5, 0.3), vec3<f32>(0.3, 0.5, 0.9), vec3<f32>(0.6, 0.4, 0.7));
    for (var k = 0; k < 4; k++) {
        let from_middle = length((at - sun * places[k]) * wide);
        let ring = smooth_between(sizes[k], 0.85 * sizes[k], from_middle) * (0.35 + 0.65 * smooth_between(0.5 * sizes[k], sizes[k], from_middle));
        sum += tints[k] * ring * 0.006;
    }
    return sum * power;
}

// Reinhard's curve (2002) with a white of 5, on brightness and on each colour by halves: bright colours pale, but not at
// once. A weak S on top, as film has it, keeps shadows open.
fn film(x: vec3<f32>) -> vec3<f32> {
    let white = 5.0;
    let l = max(luminance(x), 1e-5);
    let by_brightness = x * ((1.0 + l / (white * white)) / (1.0 + l));
    let by_colour = x * (1.0 + x / (white * white)) / (1.0 + x);
    let c = clamp(mix(by_brightness, by_colour, 0.5), vec3<f32>(0.0), vec3<f32>(1.0));
    return mix(c, c * c * (3.0 - 2.0 * c), 0.6);
}

fn grain(at: vec2<f32>) -> f32 {
    return fract(52.9829189 * fract(dot(at, vec2<f32>(0.06711056, 0.00583715)))) - 0.5;
}

@fragment
fn main(in: Whole) -> @location(0) vec4<f32> {
    let at = vec2<i32>(in.position.xy);
    let light = textureLoad(light_map, at, 0).rgb;
    let uv = in.position.xy / frame.picture.xy;
    var spread = light;
    if (frame.bloom.z > 0.0) {
        let glow = textureSampleLevel(glow_sum, smooth_clamp, uv, 0.0).rgb / frame.bloom.w;
        // What glows around is taken from what is bright: no light is made.
        spread += frame.bloom.z * (glow - bright(light, frame.bloom.x, frame.bloom.y));
    }
    if (frame.rays.x > 0.0) {
        spread += shafts(at);
    }
    if (frame.rays.y > 0.0 && frame.bloom.z > 0.0) {
        spread += glare(in.at);
    }
    let shown = film(max(spread, vec3<f32>(0.0)) * frame.picture.z);
    return vec4<f32>(shown + grain(in.position.xy) / 300.0, 1.0);
}
