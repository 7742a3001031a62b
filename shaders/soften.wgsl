#import lens

// A blur along one axis, at half the size, that stops where the distance jumps.
@group(0) @binding(0) var source: texture_2d<f32>;
@group(0) @binding(1) var distance_map: texture_2d<f32>;
// Texels to the next sample; standard deviation in texels.
@group(0) @binding(2) var<uniform> along: vec4<f32>;

const REACH: i32 = 5;

@fragment
fn main(in: Whole) -> @location(0) vec4<f32> {
    let size = vec2<i32>(textureDimensions(source));
    let here = vec2<i32>(in.position.xy);
    let own = textureLoad(distance_map, 2 * here, 0).r;
    var sum = vec3<f32>(0.0);
    var weights = 0.0;
    for (var k = -REACH; k <= REACH; k++) {
        let at = clamp(here + vec2<i32>(along.xy) * k, vec2<i32>(0), size - 1);
        let jump = (textureLoad(distance_map, 2 * at, 0).r - own) / (0.03 * own + 0.01);
        let x = f32(k);
        let w = exp(-0.5 * x * x / (along.z * along.z) - jump * jump);
        sum += w * textureLoad(source, at, 0).rgb;
        weights += w;
    }
    return vec4<f32>(sum / weights, 1.0);
}
