#import light
#import haze
#import splat
#import river
#import fire

// Ground: four covers by their shares, lit, in haze.

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec3<f32>,
    @location(1) uv: vec2<f32>,
}

// Texels of a texture's side; a texel is somewhat smaller than a pixel.
const TEXTURE_SIDE: f32 = 512.0;
const TEXELS_PER_PIXEL: f32 = 0.8;
// How rough sand, grass, rock and snow are, and how much their height decides which lies on top.
const ROUGH: vec4<f32> = vec4<f32>(0.12, 0.42, 0.85, 0.14);
const SAND: vec3<f32> = vec3<f32>(0.47, 0.38, 0.26);
const GRAVEL: vec3<f32> = vec3<f32>(0.30, 0.27, 0.22);
const SNOW: vec3<f32> = vec3<f32>(0.86, 0.88, 0.92);
const SEABED: vec3<f32> = vec3<f32>(0.20, 0.19, 0.16);

struct Surface {
    albedo: vec3<f32>,
    normal: vec3<f32>,
}

// Sand, gravel or what grows, by the map and the height over the sea.
fn tints(at: vec3<f32>, cover: vec3<f32>, over_sea: f32) -> array<vec3<f32>, 3> {
    let rock = mix(vec3<f32>(0.255, 0.24, 0.225), cover, 0.22);
    let loose = mix(SAND, GRAVEL, smooth_between(frame.cover.x, 3.0 * frame.cover.x + 1.0, over_sea));
    return array<vec3<f32>, 3>(mix(loose, cover, 0.25), cover, rock);
}

fn under_water(over_sea: f32) -> f32 {
    return smooth_between(0.0, -2.0 * frame.cover.x - 1.0, over_sea);
}

fn plain(at: vec3<f32>, uv: vec2<f32>, normal: vec3<f32>, state: vec4<f32>, mip: f32) -> Surface {
    let cover = textureSampleLevel(cover_map, smooth_clamp, uv, mip);
    let over_sea = at.z - frame.map.z;
    let w = shares(over_sea, normal.z, state.r, state.b * (1.0 - 0.9 * cover.a), 0.0);
    let tint = tints(at, cover.rgb, over_sea);
    let albedo = tint[0] * w.x + tint[1] * w.y + tint[2] * w.z + SNOW * w.w;
    return Surface(mix(albedo, SEABED, under_water(over_sea)), normal);
}

fn covered(at: vec3<f32>, uv: vec2<f32>, normal: vec3<f32>, state: vec4<f32>, away: f32, mip: f32) -> Surface {
    let cover = textureSampleLevel(cover_map, smooth_clamp, uv, mip);
    let pixel = max(away * frame.eye.w, 0.004);
    let over_sea = at.z - frame.map.z;
    // Borders are broken up by noise of some cells and of many pixels; the land's tone varies over larger ones.
    let patches = exp2(floor(log2(pixel * 24.0 + frame.air.w * 0.6)));
    let rough = fbm(at.xy / patches, 3).x * 1.9;
    let wide = fbm(at.xy / (patches * 21.0) + 3.7, 2).x * 1.1;
    // Where much grows, plants hold what was laid down.
    var w = shares(over_sea, normal.z, state.r, state.b * (1.0 - 0.9 * cover.a), rough);
    var tint = tints(at, cover.rgb, over_sea);
    tint[2] = bedded(at, tint[2], wide, pixel);
    let level = log2(pixel);
    let whole = floor(level);
    let size = TEXTURE_SIDE * TEXELS_PER_PIXEL * exp2(whole);
    let share = level - whole;
    let toward = normalize(frame.eye.xyz - at);
    let blur = clamp(-0.7 * log2(max(dot(toward, normal), 0.05)), 0.0, 2.5);
    let sand = sized(0, at.xy, size, share, blur);
    let grass = sized(1, at.xy, size, share, blur);
    let snow = sized(3, at.xy, size, share, blur);
    // Rock is steep: it is laid from above and from two sides, by the cube of how it faces them.
    let faces = normal * normal * normal * normal;
    let sides = faces / (faces.x + faces.y + faces.z);
    let top = sized(2, at.xy, size, share, blur);
    let east = sized(2, at.yz, size, share, blur);
    let north = sized(2, at.xz, size, share, blur);
    let rock = sides.z * top + sides.x * east + sides.y * north;
    let rock_slope = sides.z * vec3<f32>(top.xy, 0.0) + sides.x * vec3<f32>(0.0, east.xy) + sides.y * vec3<f32>(north.x, 0.0, north.y);
    // What stands higher lies on top where two meet.
    let heights = vec4<f32>(sand.z, grass.z, rock.z, snow.z);
    let raised = w * (1.0 + 1.2 * heights);
    let highest = max(max(raised.x, raised.y), max(raised.z, raised.w));
    w = w * max(raised - highest + 0.45, vec4<f32>(0.0));
    w = w / max(w.x + w.y + w.z + w.w, 1e-5);
    // Where a pixel is larger than a cell, the land's own relief is all there is to see.
    let fine = mix(0.3, 1.0, clamp(frame.air.w / pixel * 0.6, 0.0, 1.0)) * frame.cover.w;
    let flat_slope = w.x * ROUGH.x * sand.xy + w.y * ROUGH.y * grass.xy + w.w * ROUGH.w * snow.xy;
    let slope = fine * (vec3<f32>(flat_slope, 0.0) + w.z * ROUGH.z * rock_slope);
    let bent = normalize(normal - (slope - dot(slope, normal) * normal));
    // Drier and browner here, lusher there.
    let tone = vec3<f32>(1.0) + vec3<f32>(0.34, 0.16, 0.10) * wide + 0.16 * rough;
    let soil = tint[0] * (w.x * sand.w) + tint[1] * (w.y * grass.w) + tint[2] * (w.z * rock.w);
    let albedo = soil * tone + SNOW * (w.w * mix(1.0, snow.w, 0.25));
    return Surface(mix(albedo, SEABED * (0.8 + 0.4 * rough), under_water(over_sea)), bent);
}

// Beds of rock, one on the other: hard pale ones and soft dark ones, bent a little; redder where the land is dry.
fn bedded(at: vec3<f32>, tint: vec3<f32>, wide: f32, pixel: f32) -> vec3<f32> {
    let thick = max(frame.bands.w, pixel * 6.0);
    let place = at.z / thick + 2.2 * wide;
    let band = value_noise(vec2<f32>(place, 7.0 + 0.3 * wide)).x * 0.8;
    let dry = clamp((tint.r - tint.b) * 7.0 - 0.2, 0.0, 1.0);
    let red = mix(vec3<f32>(1.0), vec3<f32>(1.12, 0.94, 0.80), dry * (0.5 + 0.5 * band));
    return tint * red * (1.0 + 0.20 * band);
}

@fragment
fn main(in: Vertex) -> @location(0) vec4<f32> {
    let away = distance(in.at, frame.eye.xyz);
    // The smaller copy whose texels are as large as a pixel, a little sharper than that.
    let mip = max(log2(away * frame.eye.w / frame.air.w), 0.0);
    let slope = textureSampleLevel(slope_map, smooth_clamp, in.uv, mip).rg * frame.map.w;
    let state = textureSampleLevel(state_map, smooth_clamp, in.uv, mip);
    let normal = normalize(vec3<f32>(-slope, 1.0));
    var surface = plain(in.at, in.uv, normal, state, mip);
    if (QUALITY > 0u) { surface = covered(in.at, in.uv, normal, state, away, mip); }
    // A map's colours are draped over the land as they are.
    let draped = frame.cover2.z == 3.0;
    var dry = 0.0;
    if (draped) { surface = Surface(textureSampleLevel(cover_map, smooth_clamp, in.uv, mip).rgb, normal); }
    let sun = sun_share(in.uv, 0.0);
    var light = vec3<f32>(0.0);
    if (FIRE && !draped) {
        let lava = lava_at(in.at, in.uv, normal, away, state.r);
        surface.albedo = mix(surface.albedo, lava.albedo, lava.share);
        surface.normal = normalize(mix(surface.normal, lava.normal, lava.share));
        light = surface.albedo * (1.0 / PI) * fire_light(in.uv, surface.normal) + lava.light;
        dry = lava.share;
    }
    var colour = lit(surface.albedo, surface.normal, state.a, sun) + light;
    if (RIVERS && !draped) { colour = mix(with_river(colour, in.at, in.uv, slope, sun), colour, dry); }
    return vec4<f32>(hazed(colour, in.at), 1.0);
}
