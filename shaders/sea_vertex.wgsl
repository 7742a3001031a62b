#import ground

// A sheet of water at the height of the sea: a square, or rings out to the horizon around the eye.

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec3<f32>,
}

struct Corner {
    // Place, in shares of what is drawn: of the map's half sides, or of metres around the eye.
    @location(0) at: vec2<f32>,
    // 1 around the eye.
    @location(1) around_eye: f32,
}

@vertex
fn main(in: Corner) -> Vertex {
    // The ground ends at the centres of its outermost cells.
    let half = 0.5 * frame.map.xy * (1.0 - 1.0 / vec2<f32>(textureDimensions(height_map, 0)));
    let flat = select(in.at * half, in.at + frame.eye.xy, in.around_eye > 0.5);
    let at = vec3<f32>(flat, frame.map.z);
    return Vertex(frame.view_projection * vec4<f32>(at, 1.0), at);
}
