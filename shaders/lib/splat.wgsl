#import ground
#import noise

// What covers the ground: shares of sand, grass (whatever grows, or bare soil), rock and snow that add up to one.
@group(2) @binding(0) var textures: texture_2d_array<f32>;

// By height over the sea (drawn), the cosine of the slope, shares of snow and of loose ground by the world's own maps, and
// a number around zero that breaks the borders up.
fn shares(over_sea: f32, steep: f32, snow: f32, loose: f32, rough: f32) -> vec4<f32> {
    let cosine = steep + 0.10 * rough;
    let bare = 1.0 - smooth_between(frame.cover.z, frame.cover.y, cosine);
    let held = smooth_between(frame.cover2.y, frame.cover2.x, cosine);
    if (frame.cover2.z == 1.0) {
        return bands(over_sea + frame.bands.z * rough, bare, held);
    }
    let beach = frame.cover.x * (1.0 + 0.7 * rough);
    let flat_share = smooth_between(0.93, 0.98, cosine);
    let sand = max(1.0 - smooth_between(0.6 * beach, 1.4 * beach + 1e-3, over_sea), 0.0) * mix(0.35, 1.0, flat_share);
    let gravel = loose * smooth_between(0.8, 0.95, cosine) * 0.75;
    let open = mix(sand, 1.0, gravel * (1.0 - sand));
    let white = clamp(snow + 0.35 * rough * snow * (1.0 - snow) * 4.0, 0.0, 1.0) * held;
    let soil = vec3<f32>(open * (1.0 - bare), (1.0 - open) * (1.0 - bare), bare);
    return vec4<f32>(soil * (1.0 - white), white);
}

// Sand, grass, rock and snow by height, rock wherever it is steep.
fn bands(over_sea: f32, bare: f32, held: f32) -> vec4<f32> {
    let b = frame.bands.z;
    let t1 = smooth_between(frame.cover.x - 0.5 * b, frame.cover.x + 0.5 * b, over_sea);
    let t2 = smooth_between(frame.bands.x - b, frame.bands.x + b, over_sea);
    let t3 = smooth_between(frame.bands.y - b, frame.bands.y + b, over_sea);
    let w = vec4<f32>(1.0 - t1, t1 * (1.0 - t2), t1 * t2 * (1.0 - t3), t1 * t2 * t3);
    let slid = w.w * (1.0 - held);
    return vec4<f32>(w.x, w.y * (1.0 - bare), w.z + w.y * bare + slid, w.w - slid);
}

// A layer at the two sizes whose texels are nearest to a pixel's: whatever the distance, there is detail of its size. Slope
// across and up, height around zero, brightness around one.
fn sized(layer: i32, at: vec2<f32>, size: f32, share: f32, level: f32) -> vec4<f32> {
    let a = textureSampleLevel(textures, smooth_repeat, at / size, layer, level);
    let b = textureSampleLevel(textures, smooth_repeat, at / (2.0 * size) + 0.37, layer, level);
    return mix(a, b, share) * vec4<f32>(2.0, 2.0, 1.0, 2.0) - vec4<f32>(1.0, 1.0, 0.5, 0.0);
}
