#import lens

// One way of a Gaussian that is blurred along one axis after the other; weights add up to one.
@group(0) @binding(0) var source: texture_2d<f32>;
@group(0) @binding(1) var smooth_clamp: sampler;
// Step from texel to texel in shares of the texture; standard deviation in texels; share of what is added.
@group(0) @binding(2) var<uniform> along: vec4<f32>;

@fragment
fn main(in: Whole) -> @location(0) vec4<f32> {
    let uv = in.at * vec2<f32>(0.5, -0.5) + 0.5;
    var sum = vec4<f32>(0.0);
    var weights = 0.0;
    let reach = i32(ceil(3.0 * along.z));
    for (var k = -reach; k <= reach; k++) {
        let x = f32(k);
        let w = exp(-0.5 * x * x / (along.z * along.z));
        sum += w * textureSampleLevel(source, smooth_clamp, uv + along.xy * x, 0.0);
        weights += w;
    }
    return sum / weights;
}
