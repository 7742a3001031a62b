#import lens

// Ground under one sun. Twin of the arithmetic in src/render/hillshade.rs; looks one cell to each side.

struct Sun {
    // Unit vector to the sun: east, south, up.
    toward: vec3<f32>,
    // Vertical exaggeration over the side of a cell.
    per_cell: f32,
    // 1 where east meets west and north meets south.
    wraps: u32,
}

@group(0) @binding(0) var height_m: texture_2d<f32>;
@group(0) @binding(1) var<uniform> sun: Sun;

// The neighbour `step` cells on, along one axis.
fn neighbour(at: i32, step: i32, size: i32) -> i32 {
    if sun.wraps == 1u {
        return (at + step + size) % size;
    }
    return clamp(at + step, 0, size - 1);
}

// Central differences, one-sided at a rim that does not wrap.
fn slope(low: f32, high: f32, before: i32, after: i32) -> f32 {
    if before == after {
        return 0.0;
    }
    let cells = select(2.0, f32(min(after - before, 2)), after > before);
    return (high - low) / cells * sun.per_cell;
}

@fragment
fn main(in: Whole) -> @location(0) vec4<f32> {
    let at = vec2<i32>(in.position.xy);
    let size = vec2<i32>(textureDimensions(height_m));
    let west = neighbour(at.x, -1, size.x);
    let east = neighbour(at.x, 1, size.x);
    let north = neighbour(at.y, -1, size.y);
    let south = neighbour(at.y, 1, size.y);
    let z = array<f32, 4>(
        textureLoad(height_m, vec2<i32>(west, at.y), 0).r,
        textureLoad(height_m, vec2<i32>(east, at.y), 0).r,
        textureLoad(height_m, vec2<i32>(at.x, north), 0).r,
        textureLoad(height_m, vec2<i32>(at.x, south), 0).r,
    );
    let up = vec3<f32>(-slope(z[0], z[1], west, east), -slope(z[2], z[3], north, south), 1.0);
    let light = max(dot(normalize(up), sun.toward), 0.0);
    return vec4<f32>(light, light, light, 1.0);
}
