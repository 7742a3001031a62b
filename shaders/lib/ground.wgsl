#import frame

// The map's rasters. Cell centres lie at (cell + 0.5) / size.
@group(1) @binding(0) var height_map: texture_2d<f32>;
@group(1) @binding(1) var slope_map: texture_2d<f32>;
@group(1) @binding(2) var cover_map: texture_2d<f32>;
@group(1) @binding(3) var state_map: texture_2d<f32>;
@group(1) @binding(4) var shadow_map: texture_2d<f32>;
@group(1) @binding(5) var glow_map: texture_2d<f32>;
// Height of the surface of inland water, and its depth, less than 0 in the dry.
@group(1) @binding(6) var water_map: texture_2d<f32>;
// Nearness to a river's middle, and half its width, in shares of the reach.
@group(1) @binding(7) var river_map: texture_2d<f32>;
@group(1) @binding(8) var fire_map: texture_2d<f32>;

// Height at a place of the map, 0 to 1, drawn, m: four cells of a mip.
fn height_at(uv: vec2<f32>, level: i32) -> f32 {
    return four(height_map, uv, level).x * frame.map.w;
}

fn four(map: texture_2d<f32>, uv: vec2<f32>, level: i32) -> vec2<f32> {
    let size = vec2<i32>(textureDimensions(map, level));
    let at = uv * vec2<f32>(size) - 0.5;
    let low = floor(at);
    let t = at - low;
    let a = clamp(vec2<i32>(low), vec2<i32>(0), size - 1);
    let b = clamp(vec2<i32>(low) + 1, vec2<i32>(0), size - 1);
    let north = mix(textureLoad(map, a, level).rg, textureLoad(map, vec2<i32>(b.x, a.y), level).rg, t.x);
    let south = mix(textureLoad(map, vec2<i32>(a.x, b.y), level).rg, textureLoad(map, b, level).rg, t.x);
    return mix(north, south, t.y);
}

// From the map's metres to its rasters.
fn place_of(at: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(at.x / frame.map.x + 0.5, 0.5 - at.y / frame.map.y);
}

fn metres_of(uv: vec2<f32>) -> vec2<f32> {
    return vec2<f32>((uv.x - 0.5) * frame.map.x, (0.5 - uv.y) * frame.map.y);
}

// Share of the sun's disc that is seen from a height over the ground at a place.
fn sun_share(uv: vec2<f32>, over_ground: f32) -> f32 {
    let shade = textureSampleLevel(shadow_map, smooth_clamp, uv, 0.0).rg;
    // Shade reaches so high over the ground; its edge is as wide as the disc seems from what throws it.
    let edge = max(shade.y * frame.air.w * frame.toward.w, 0.3 * frame.air.w * abs(frame.toward.z));
    return mix(1.0, smooth_between(-edge, edge, over_ground - shade.x), frame.light.w);
}
