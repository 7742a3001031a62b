#import fire

// A puff of smoke as a square that faces the eye, and the light of lava that reaches it from below.

struct Puff {
    @builtin(vertex_index) corner: u32,
    // Middle and radius, m.
    @location(0) ball: vec4<f32>,
    // How thick it is, share of its life that is over, turn, picture.
    @location(1) state: vec4<f32>,
    // Optical depth of the smoke towards the light, and up.
    @location(2) depth: vec2<f32>,
}

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec3<f32>,
    @location(1) side: vec2<f32>,
    @location(2) @interpolate(flat) ball: vec4<f32>,
    @location(3) @interpolate(flat) state: vec4<f32>,
    @location(4) @interpolate(flat) depth: vec2<f32>,
    @location(5) @interpolate(flat) fire: vec3<f32>,
}

@vertex
fn main(in: Puff) -> Vertex {
    // Two triangles: corners 0 1 2 and 2 1 3.
    let corner = select(in.corner, array<u32, 3>(2u, 1u, 3u)[in.corner % 3u], in.corner > 2u);
    let side = vec2<f32>(f32(corner & 1u), f32(corner >> 1u)) * 2.0 - 1.0;
    let forward = normalize(in.ball.xyz - frame.eye.xyz);
    let right = normalize(cross(forward, vec3<f32>(0.0, 0.0, 1.0)) + vec3<f32>(1e-6, 0.0, 0.0));
    let up = cross(right, forward);
    let at = in.ball.xyz + (right * side.x + up * side.y) * in.ball.w;
    // What it sees of the glowing land grows wider with its height.
    let uv = clamp(place_of(in.ball.xy), vec2<f32>(0.0), vec2<f32>(1.0));
    let over = max(in.ball.z - height_at(uv, 0), 0.0);
    let cell = frame.map.x / f32(textureDimensions(fire_map).x);
    let level = clamp(log2(max((over + 0.5 * in.ball.w) / cell, 1.0)), 0.0, f32(textureNumLevels(fire_map)) - 1.0);
    let fire = fire_colour(textureSampleLevel(fire_map, smooth_clamp, uv, level).rg) * (1.0 - 0.88 * frame.sun.w);
    return Vertex(frame.view_projection * vec4<f32>(at, 1.0), at, side, in.ball, in.state, in.depth, fire);
}
