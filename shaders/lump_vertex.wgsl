#import frame

// A square that hides a sphere from the eye.

struct Lump {
    @builtin(vertex_index) corner: u32,
    // Middle and radius, m.
    @location(0) ball: vec4<f32>,
    // Temperature, degC; a number of its own.
    @location(1) own: vec2<f32>,
}

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec3<f32>,
    @location(1) @interpolate(flat) ball: vec4<f32>,
    @location(2) @interpolate(flat) own: vec2<f32>,
}

@vertex
fn main(in: Lump) -> Vertex {
    // Two triangles: corners 0 1 2 and 2 1 3.
    let corner = select(in.corner, array<u32, 3>(2u, 1u, 3u)[in.corner % 3u], in.corner > 2u);
    let side = vec2<f32>(f32(corner & 1u), f32(corner >> 1u)) * 2.0 - 1.0;
    let way = in.ball.xyz - frame.eye.xyz;
    let away = length(way);
    let forward = way / max(away, 1e-6);
    let right = normalize(cross(forward, vec3<f32>(0.0, 0.0, 1.0)) + vec3<f32>(1e-6, 0.0, 0.0));
    let up = cross(right, forward);
    // As wide as the sphere's outline, and its bumps.
    let wide = 1.35 * in.ball.w * away / sqrt(max(away * away - 1.8 * in.ball.w * in.ball.w, 0.01 * away * away));
    let at = in.ball.xyz + (right * side.x + up * side.y) * wide;
    return Vertex(frame.view_projection * vec4<f32>(at, 1.0), at, in.ball, in.own);
}
