#import frame

// Walls of the block that the map is cut out of. Heights stand in the vertex.

struct Corner {
    // East, north, height over the datum, m; 1 at the top.
    @location(0) at: vec4<f32>,
}

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec3<f32>,
    // Height of the ground above, drawn, m.
    @location(1) top: f32,
}

@vertex
fn main(in: Corner) -> Vertex {
    let top = in.at.z * frame.map.w;
    let at = vec3<f32>(in.at.xy, mix(frame.air.z, top, in.at.w));
    return Vertex(frame.view_projection * vec4<f32>(at, 1.0), at, top);
}
