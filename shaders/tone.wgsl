#import frame
#import lens
#import bright

// From light to a picture: exposure, a film-like curve, sRGB by the target's format. A grain smaller than a step of
// eight bits hides the steps.
@group(1) @binding(0) var light_map: texture_2d<f32>;
@group(1) @binding(1) var glow_sum: texture_2d<f32>;

// Narkowicz's fit (2015) of the ACES curve.
fn film(x: vec3<f32>) -> vec3<f32> {
    return clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), vec3<f32>(0.0), vec3<f32>(1.0));
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
    let shown = film(max(spread, vec3<f32>(0.0)) * frame.picture.z);
    return vec4<f32>(shown + grain(in.position.xy) / 300.0, 1.0);
}
