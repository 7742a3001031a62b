#import lens
#import frame

// How far away what is seen is, m. Where there is nothing, very far.
@group(1) @binding(0) var depth_map: texture_depth_2d;

@fragment
fn main(in: Whole) -> @location(0) vec4<f32> {
    let at = vec2<i32>(in.position.xy);
    let depth = textureLoad(depth_map, at, 0);
    let clip = vec4<f32>(in.at, max(depth, 1e-9), 1.0);
    let world = frame.from_picture * clip;
    return vec4<f32>(distance(world.xyz / world.w, frame.eye.xyz), 0.0, 0.0, 1.0);
}
