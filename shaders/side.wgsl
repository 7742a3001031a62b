#import haze
#import noise

// Walls of the block: beds of rock, darker with depth.

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec3<f32>,
    @location(1) top: f32,
}

@fragment
fn main(in: Vertex) -> @location(0) vec4<f32> {
    let normal = normalize(cross(dpdx(in.at), dpdy(in.at)));
    let out = select(normal, -normal, dot(normal, in.at - frame.eye.xyz) > 0.0);
    let span = max(in.top - frame.air.z, 1.0);
    let depth = in.top - in.at.z;
    // Beds follow the ground a little less the deeper they lie.
    let along = fbm((in.at.xy + in.at.yx * 0.3) / (0.08 * frame.map.x), 4).x;
    let bed = (depth + 0.25 * span * along) / span;
    let band = value_noise(vec2<f32>(bed * 26.0, 3.0)).x * 0.6 + value_noise(vec2<f32>(bed * 71.0, 9.0)).x * 0.4;
    let albedo = mix(vec3<f32>(0.25, 0.21, 0.17), vec3<f32>(0.16, 0.145, 0.135), smooth_between(0.0, 1.0, bed))
        * (1.0 + 0.22 * band);
    let facing = max(dot(out, frame.toward.xyz), 0.0);
    let light = frame.light.rgb * facing + frame.ambient.rgb * 0.45;
    // Under the sea the air is as thick as on it.
    let open = vec3<f32>(in.at.xy, max(in.at.z, frame.map.z));
    return vec4<f32>(hazed(albedo * light / PI, open), 1.0);
}
