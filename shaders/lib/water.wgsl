#import light
#import haze
#import waves
#import mirror

// Water of sea, lakes and rivers: Fresnel's mirror of sky and land, the light that it scatters, and the bed that shines
// through as far as light reaches.

// Sand on the bed.
const BED: vec3<f32> = vec3<f32>(0.40, 0.36, 0.27);
// Mud on the bed of lakes, and the tint of fresh water.
const MUD: vec3<f32> = vec3<f32>(0.17, 0.15, 0.105);
const FRESH: vec3<f32> = vec3<f32>(1.25, 1.0, 0.72);
// How much faster than green the water takes red, green and blue (clear coastal water).
const ABSORPTION: vec3<f32> = vec3<f32>(3.3, 1.0, 0.78);

// What deep water sends back of the light, to the dark colour as it is seen: more green, as mirrored blue is added to it.
const DEEP: vec3<f32> = vec3<f32>(3.8, 2.2, 1.45);

// A piece of water.
struct Water {
    at: vec3<f32>,
    uv: vec2<f32>,
    // Depth, drawn, m; slope of the bed, drawn.
    depth: f32,
    steep: f32,
    // Height and length of its waves.
    height: f32,
    longest: f32,
    // Depth in which green light falls to 37 %, drawn, m.
    clarity: f32,
    // Share of the sun that reaches it.
    sun: f32,
    // 1 for the sea, with surf along its coasts and sand on its bed; 0 for fresh water.
    sea: f32,
    // 1 on the map, 0 beyond it.
    inside: f32,
}

// Schlick's approximation, with the loss at low angles of a surface of a roughness (Bruneton and others 2010).
fn fresnel(facing: f32, roughness: f32) -> f32 {
    return 0.02 + 0.98 * pow(1.0 - facing, 5.0 * exp(-2.69 * roughness)) / (1.0 + 22.7 * pow(roughness, 1.5));
}

// What the surface mirrors of the sun: Gaussian slopes, of which those that mirror it are seen as one.
fn glitter(view: vec3<f32>, slope: vec2<f32>, rest: f32, pixel: f32) -> vec3<f32> {
    let half_way = normalize(view + frame.toward.xyz);
    let spread = rest + 0.0002 + 0.25 * frame.toward.w * frame.toward.w;
    let off = half_way.xy / max(half_way.z, 0.05) + slope;
    let chance = exp(-0.5 * dot(off, off) / spread) / (2.0 * PI * spread);
    let facing = max(dot(half_way, view), 0.0);
    let mirrored = 0.02 + 0.98 * pow(1.0 - facing, 5.0);
    let z2 = half_way.z * half_way.z;
    // Much of a wide view's sea lies in slicks that send nothing back.
    let wide = smooth_between(20.0, 500.0, pixel);
    let bright = mix(1.0, 0.35, wide) * mirrored * chance / (4.0 * max(view.z, 0.08) * max(z2 * z2, 0.02));
    // Flanks hide each other the more the rougher they are and the lower the view: glitter has its most.
    let most = mix(mix(0.22, 0.11, wide), 1.2, exp(-150.0 * rest));
    return frame.light.rgb * (bright / (1.0 + bright / most));
}

// Glitter is made of sparks: a share that varies from pixel to pixel, one on the mean.
fn sparkle(at: vec2<f32>, pixel: f32, up: f32) -> f32 {
    let level = log2(2.5 * pixel);
    let size = exp2(floor(level));
    let time = frame.picture.w;
    let a = value_noise(at / size + 0.9 * time).x;
    let b = value_noise(at / (2.0 * size) - 0.7 * time).x;
    let n = mix(a, b, level - floor(level));
    // From so high that a pixel is wider than a wave there are only means; from the side rows of waves are still seen.
    return mix(0.7 + 1.8 * n * n * (1.0 + n), 1.0, smooth_between(1.5, 16.0, pixel) * smooth_between(0.05, 0.3, up));
}

// Colour of the water itself over its bed, as a reflectance.
fn body(water: Water, facing: f32) -> vec3<f32> {
    let dark = frame.dark.rgb * DEEP;
    let light = frame.shallow.rgb;
    if (frame.dark.w == 1.0) { return rim(water.depth, water.clarity); }
    if (frame.dark.w == 2.0) { return cells(water.at.xy, water.depth, water.clarity); }
    let optical = water.depth / water.clarity;
    // Light goes down from the sun and comes up to the eye, both bent towards the vertical.
    let way = 1.0 / sqrt(1.0 - 0.56 * (1.0 - facing * facing)) + 1.15;
    let through = exp(-ABSORPTION * (0.5 * way * optical));
    // Sand lies in banks, with weed between them.
    var patches = 0.0;
    if (frame.cover2.w > 0.5) { patches = fbm(water.at.xy / (6.0 * frame.water.z), 3).x; }
    let bed = mix(MUD, BED, water.sea) * (1.0 + mix(0.15, 0.5, water.sea) * patches) * mix(vec3<f32>(1.0), light * 2.0, 0.35 * (1.0 - exp(-2.5 * optical)));
    let shelf = mix(dark * 0.85, mix(dark, light, 0.22), exp(-0.28 * optical));
    let scattered = mix(shelf, light, mix(0.12, 0.45, water.sea) * exp(-0.9 * optical)) * mix(FRESH, vec3<f32>(1.0), water.sea) * (1.0 + 0.05 * patches);
    return mix(scattered, bed, through);
}

// A cubic ramp from the dark to the light colour towards the shore.
fn rim(depth: f32, clarity: f32) -> vec3<f32> {
    let near = clamp(1.0 - depth / (3.0 * clarity * frame.inland.y), 0.0, 1.0);
    return mix(frame.dark.rgb, frame.shallow.rgb, near * near * near);
}

// Distance to the nearest of points strewn one a cell (Worley 1996), in octaves.
fn nearest_point(p: vec2<f32>) -> f32 {
    let cell = floor(p);
    var least = 8.0;
    for (var y = -1; y <= 1; y++) {
        for (var x = -1; x <= 1; x++) {
            let there = cell + vec2<f32>(f32(x), f32(y));
            let key = vec2<i32>(there);
            let point = there + vec2<f32>(hash2(key), hash2(key + vec2<i32>(57, 113)));
            let off = point - p;
            least = min(least, dot(off, off));
        }
    }
    return sqrt(least);
}

fn cells(at: vec2<f32>, depth: f32, clarity: f32) -> vec3<f32> {
    var p = at / (1.5 * frame.water.z * frame.inland.y) + vec2<f32>(0.05, 0.03) * frame.picture.w;
    var sum = 0.0;
    var weight = 0.5;
    for (var k = 0; k < i32(frame.shallow.w); k++) {
        sum += weight * nearest_point(p);
        p = mat2x2<f32>(1.6, 1.2, -1.2, 1.6) * p + 5.3;
        weight *= 0.5;
    }
    let near = exp(-depth / (2.0 * clarity));
    return mix(frame.dark.rgb, frame.shallow.rgb, clamp(sum * sum * 1.6 + 0.55 * near, 0.0, 1.0));
}

// Surf along the coast: broken lines at their distances from the shore, and what they leave between.
fn surf(water: Water, pixel: f32) -> f32 {
    if (water.sea <= 0.0 || frame.cover2.w < 0.5 || frame.water.w <= 0.0) { return 0.0; }
    let width = max(0.35 * water.longest, 0.8 * pixel);
    let shore = water.depth / max(water.steep, 0.012);
    let away = shore / width;
    let near = exp(-0.55 * away) * exp(-water.depth / (1.2 * water.clarity));
    if (near < 0.01) { return 0.0; }
    let rough = fbm(water.at.xy / (0.9 * width) + vec2<f32>(0.11, -0.07) * frame.picture.w, 4).x;
    let phase = 3.2 * away + 2.2 * rough - 0.5 * frame.picture.w;
    let lines = smooth_between(0.35, 0.95, 0.5 + 0.5 * sin(phase) + 0.5 * rough);
    let wash = smooth_between(0.45, 1.1, near + 0.5 * rough);
    return clamp((0.75 * lines * near + 0.7 * wash) * frame.water.w, 0.0, 0.92) * water.sea;
}

// For drafts: without a wave of its own, as rough as all of them are.
fn plain_water(water: Water, pixel: f32, view: vec3<f32>) -> vec3<f32> {
    let rest = 0.0008 + 0.004 * water.height;
    let roughness = sqrt(2.0 * rest);
    let facing = clamp(view.z, 0.03, 1.0);
    let share = fresnel(facing, roughness);
    let reflected = sky_light(normalize(vec3<f32>(-view.xy, facing + 0.9 * roughness)));
    let down = frame.light.rgb * (max(frame.toward.z, 0.0) * water.sun) + frame.ambient.rgb;
    var colour = body(water, facing) * down * ((1.0 - share) / PI) + reflected * share;
    colour += glitter(view, vec2<f32>(0.0), rest, pixel) * water.sun;
    return hazed(colour, water.at);
}

// All of it, in haze.
fn watered(water: Water, pixel: f32, view: vec3<f32>) -> vec3<f32> {
    if (QUALITY == 0u) { return plain_water(water, pixel, view); }
    let wave = waves(water.at.xy, pixel, water.height, water.longest);
    let normal = normalize(vec3<f32>(-wave.slope, 1.0));
    let facing = clamp(dot(normal, view), 0.03, 1.0);
    let roughness = sqrt(2.0 * wave.rest);
    let share = fresnel(facing, roughness);
    var ray = reflect(-view, normal);
    // A rough mirror looks higher up the lower the view: flanks turned to the eye are seen, the others hide.
    ray = normalize(vec3<f32>(ray.xy, max(ray.z, 0.0) + 0.9 * roughness + 0.004));
    let reflected = mirrored(water.at, ray, roughness, water.inside);
    let down = frame.light.rgb * (max(dot(mix(vec3<f32>(0.0, 0.0, 1.0), normal, 0.6), frame.toward.xyz), 0.0) * water.sun) + frame.ambient.rgb;
    // Light comes through crests, and troughs have less.
    let swell = clamp(1.0 + 0.28 * wave.crest * min(water.height, 2.5), 0.4, 1.9);
    var colour = body(water, facing) * down * (swell * (1.0 - share) / PI);
    // Gusts roughen some of the sea more than the rest.
    var slick = 1.0;
    if (frame.cover2.w > 0.5) { slick += 0.45 * fbm(water.at.xy / (22.0 * water.longest), 3).x; }
    colour += reflected * share + glitter(view, wave.slope, wave.rest * slick, pixel) * (water.sun * sparkle(water.at.xy, pixel, view.z));
    let caps = whitecaps(water.at.xy, pixel, water.height, water.longest, wave.crest);
    let foam = max(surf(water, pixel), caps);
    colour = mix(colour, down * (0.72 / PI), foam);
    return hazed(colour, water.at);
}
