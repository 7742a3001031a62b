#import lens
#import bright

// Half the size: the mean of four by four texels. The first time only what is brighter than white is taken.
@group(0) @binding(0) var source: texture_2d<f32>;
@group(0) @binding(1) var smooth_clamp: sampler;
// Threshold, knee, 1 the first time.
@group(0) @binding(2) var<uniform> knee: vec4<f32>;

@fragment
fn main(in: Whole) -> @location(0) vec4<f32> {
    let texel = 1.0 / vec2<f32>(textureDimensions(source));
    let uv = in.at * vec2<f32>(0.5, -0.5) + 0.5;
    var sum = vec3<f32>(0.0);
    for (var k = 0u; k < 4u; k++) {
        let step = vec2<f32>(f32(k & 1u) * 2.0 - 1.0, f32(k >> 1u) * 2.0 - 1.0);
        let c = textureSampleLevel(source, smooth_clamp, uv + step * texel, 0.0).rgb;
        if (knee.z > 0.0) {
            sum += bright(c, knee.x, knee.y);
        } else {
            sum += c;
        }
    }
    return vec4<f32>(0.25 * sum, 1.0);
}
