#import ground

// Ground as patches of one lattice, coarser farther away. Near the end of its range a patch becomes the next coarser
// one, vertex by vertex, so that neither a crack nor a jump is seen (Strugar 2010). Reads four cells of two mips.

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
    let fine_height = height_at(fine, level);
    let away = distance(vec3<f32>(metres_of(fine), fine_height), frame.eye.xyz);
    let change = clamp((away - in.range.x) / (in.range.y - in.range.x), 0.0, 1.0);
    let coarse = uv_of(in.tile.xy + floor(lattice * 0.5) * 2.0 * step);
    let uv = mix(fine, coarse, change);
    let last = i32(textureNumLevels(height_map)) - 1;
    let height = mix(height_at(uv, level), height_at(uv, min(level + 1, last)), change);
    let at = vec3<f32>(metres_of(uv), height);
    return Vertex(frame.view_projection * vec4<f32>(at, 1.0), at, uv);
}
