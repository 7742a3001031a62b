#import frame

// How far away a sphere's face is, and how hot it is.

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec3<f32>,
    @location(1) @interpolate(flat) ball: vec4<f32>,
    @location(2) @interpolate(flat) own: vec2<f32>,
}

struct Felt {
    @location(0) felt: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn main(in: Vertex) -> Felt {
    let view = normalize(in.at - frame.eye.xyz);
    let way = in.ball.xyz - frame.eye.xyz;
    let along = dot(way, view);
    let beside = way - view * along;
    let inside = in.ball.w * in.ball.w - dot(beside, beside);
    if (inside <= 0.0 || along <= 0.0) { discard; }
    let away = max(along - sqrt(inside), 1e-3);
    let seen = frame.view_projection * vec4<f32>(frame.eye.xyz + view * away, 1.0);
    return Felt(vec4<f32>(away, in.own.x, 0.0, 1.0), seen.z / seen.w);
}
