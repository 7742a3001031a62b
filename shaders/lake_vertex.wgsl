#import ground

// The surface of inland water on the ground's patches; twin of `ground_vertex`, so that both meet at shores at any distance.

struct Patch {
    @builtin(vertex_index) corner: u32,
    // First cell, cells from one vertex to the next, level.
    @location(0) tile: vec4<f32>,
    // Distances at which the patch begins to change and is changed; vertices a side.
    @location(1) range: vec4<f32>,
}

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec3<f32>,
    @location(1) uv: vec2<f32>,
}

fn uv_of(cell: vec2<f32>) -> vec2<f32> {
    let size = vec2<f32>(textureDimensions(height_map, 0));
    return (clamp(cell, vec2<f32>(0.0), size - 1.0) + 0.5) / size;
}

@vertex
fn main(in: Patch) -> Vertex {
    let side = u32(in.range.z);
    let lattice = vec2<f32>(f32(in.corner % side), f32(in.corner / side));
    let step = in.tile.z;
    let level = i32(in.tile.w);
    let fine = uv_of(in.tile.xy + lattice * step);
    // The ground decides how far a vertex has changed: its distance is the ground's.
    let away = distance(vec3<f32>(metres_of(fine), height_at(fine, level)), frame.eye.xyz);
    let change = clamp((away - in.range.x) / (in.range.y - in.range.x), 0.0, 1.0);
    let coarse = uv_of(in.tile.xy + floor(lattice * 0.5) * 2.0 * step);
    let uv = mix(fine, coarse, change);
    let last = i32(textureNumLevels(height_map)) - 1;
    let surface = mix(four(water_map, uv, level).x, four(water_map, uv, min(level + 1, last)).x, change) * frame.map.w;
    let at = vec3<f32>(metres_of(uv), surface);
    var position = frame.view_projection * vec4<f32>(at, 1.0);
    // Far away the ground's coarse cells would stand out of the water: it is tested as if it lay nearer by such a cell.
    let eye = frame.eye.xyz - at;
    let near = at + eye * min(0.6 * frame.air.w * (step - 1.0 + change) / max(length(eye), 1e-3), 0.5);
    let before = frame.view_projection * vec4<f32>(near, 1.0);
    position.z = before.z / before.w * position.w;
    return Vertex(position, at, uv);
}
