#import light
#import haze
#import splat

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

// Where the ground is seen from above its texture lies flat; on steep ground it is laid from two sides.
fn side_weights(normal: vec3<f32>) -> vec3<f32> {
    let w = pow(abs(normal), vec3<f32>(6.0));
    return w / (w.x + w.y + w.z);
}

fn covered(at: vec3<f32>, uv: vec2<f32>, normal: vec3<f32>, away: f32) -> Surface {
    let cover = textureSampleLevel(cover_map, smooth_clamp, uv, 0.0);
    // A map's colours are draped over the land.
    if (frame.cover2.z == 3.0) { return Surface(cover.rgb, normal); }
    let state = textureSampleLevel(state_map, smooth_clamp, uv, 0.0);
    let pixel = max(away * frame.eye.w, 0.004);
    let over_sea = at.z - frame.map.z;
    let coarse = fbm(at.xy / (pixel * 90.0 + frame.air.w * 1.5), 3);
    let rough = coarse.x * 1.4;
    var w = shares(over_sea, normal.z, state.r, state.b, rough);
    let quality = frame.cover2.w;
    let old = vec3<f32>(0.95) + 0.30 * rough;
    let rock_tint = mix(vec3<f32>(0.31, 0.285, 0.26), cover.rgb, 0.28);
    let loose = mix(SAND, GRAVEL, smooth_between(frame.cover.x, 3.0 * frame.cover.x + 1.0, over_sea));
    let sand_tint = mix(loose, cover.rgb, 0.25);
    let under = smooth_between(0.0, -2.0 * frame.cover.x - 1.0, over_sea);
    if (quality < 0.5) {
        let plain = (sand_tint * w.x + cover.rgb * w.y + rock_tint * w.z) * old + SNOW * w.w;
        return Surface(mix(plain, SEABED, under), normal);
    }
    let level = log2(pixel);
    let whole = floor(level);
    let size = TEXTURE_SIDE * TEXELS_PER_PIXEL * exp2(whole);
    let share = level - whole;
    let toward = normalize(frame.eye.xyz - at);
    let blur = clamp(-0.7 * log2(max(dot(toward, normal), 0.05)), 0.0, 2.5);
    let sides = side_weights(normal);
    var texels: array<Texel, 4>;
    var slopes: array<vec3<f32>, 4>;
    for (var k = 0; k < 4; k++) {
        texels[k] = Texel(vec3<f32>(1.0), -0.5, vec2<f32>(0.0));
        slopes[k] = vec3<f32>(0.0);
        if (w[k] < 0.004) { continue; }
        var t = Texel(vec3<f32>(0.0), 0.0, vec2<f32>(0.0));
        var slope = vec3<f32>(0.0);
        let top = select(sides.z, 1.0, k == 3 || k == 0);
        if (top > 0.03) {
            let seen = sized(k, at.xy, size, share, blur);
            t = Texel(seen.colour * top, seen.height * top, vec2<f32>(0.0));
            slope += top * vec3<f32>(seen.slope, 0.0);
        }
        if (top < 1.0) {
            if (sides.x > 0.03) {
                let seen = sized(k, at.yz, size, share, blur);
                t = Texel(t.colour + seen.colour * sides.x, t.height + seen.height * sides.x, vec2<f32>(0.0));
                slope += sides.x * vec3<f32>(0.0, seen.slope);
            }
            if (sides.y > 0.03) {
                let seen = sized(k, at.xz, size, share, blur);
                t = Texel(t.colour + seen.colour * sides.y, t.height + seen.height * sides.y, vec2<f32>(0.0));
                slope += sides.y * vec3<f32>(seen.slope.x, 0.0, seen.slope.y);
            }
        }
        texels[k] = t;
        slopes[k] = slope;
    }
    // What stands higher lies on top where two meet.
    var top = 0.0;
    for (var k = 0; k < 4; k++) { top = max(top, w[k] * (1.0 + 1.2 * texels[k].height)); }
    for (var k = 0; k < 4; k++) { w[k] = w[k] * max(w[k] * (1.0 + 1.2 * texels[k].height) - top + 0.45, 0.0); }
    w = w / max(w.x + w.y + w.z + w.w, 1e-5);
    // Where a pixel is larger than a cell, the land's own relief is all there is to see.
    let fine = mix(0.3, 1.0, clamp(frame.air.w / pixel * 0.6, 0.0, 1.0)) * frame.cover.w;
    var slope = vec3<f32>(0.0);
    for (var k = 0; k < 4; k++) { slope += w[k] * ROUGH[k] * fine * slopes[k]; }
    let bent = normalize(normal - (slope - dot(slope, normal) * normal));
    let albedo = sand_tint * texels[0].colour * w.x * 1.9 + cover.rgb * texels[1].colour * w.y * 1.9
        + rock_tint * texels[2].colour * w.z * 1.9 + SNOW * mix(vec3<f32>(1.0), texels[3].colour * 1.9, 0.25) * w.w;
    let varied = mix(albedo * old, albedo, w.w);
    return Surface(mix(varied, SEABED * (0.8 + 0.4 * rough), under), bent);
}

fn burning(at: vec3<f32>, uv: vec2<f32>, colour: vec3<f32>) -> vec3<f32> {
    return colour;
}

@fragment
fn main(in: Vertex) -> @location(0) vec4<f32> {
    let slope = textureSample(slope_map, smooth_clamp, in.uv).rg * frame.map.w;
    let normal = normalize(vec3<f32>(-slope, 1.0));
    let away = distance(in.at, frame.eye.xyz);
    let surface = covered(in.at, in.uv, normal, away);
    let open = textureSampleLevel(state_map, smooth_clamp, in.uv, 0.0).a;
    let sun = sun_share(in.uv, 0.0);
    var colour = lit(surface.albedo, surface.normal, open, sun);
    colour = burning(in.at, in.uv, colour);
    return vec4<f32>(hazed(colour, in.at), 1.0);
}
