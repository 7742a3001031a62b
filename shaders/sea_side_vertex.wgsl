#import ground

// The cut through the sea along the block's walls: from its surface down to the bed.

struct Corner {
    // East, north, height of the ground over the datum, m; 1 at the top.
    @location(0) at: vec4<f32>,
}

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec3<f32>,
}

@vertex
fn main(in: Corner) -> Vertex {
    let at = vec3<f32>(in.at.xy, select(in.at.z * frame.map.w, frame.map.z, in.at.w > 0.5));
    return Vertex(frame.view_projection * vec4<f32>(at, 1.0), at);
}
