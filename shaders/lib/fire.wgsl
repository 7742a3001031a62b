#import ground
#import noise

// Lava: what it gives off by its temperature, plates of crust that drift with it, rock that it froze to, and its light on the
// ground around.

struct Lava {
    // Share of what is seen.
    share: f32,
    albedo: vec3<f32>,
    normal: vec3<f32>,
    // Its own light.
    light: vec3<f32>,
}

// Light of lava and, last, how bright it is beside lava at 1200 degC.
fn heat_light(degc: f32) -> vec4<f32> {
    let at = clamp((degc - 400.0) / 50.0, 0.0, 16.0);
    let low = i32(min(floor(at), 15.0));
    return mix(frame.heat[low], frame.heat[low + 1], at - f32(low));
}

// Way to the nearest crack between plates, 0 to about 1, and a number of the plate's own.
fn plates(p: vec2<f32>) -> vec2<f32> {
    let bent = p + 0.35 * vec2<f32>(value_noise(p * 1.7 + 4.1).x, value_noise(p * 1.7 - 8.3).x);
    let cell = floor(bent);
    let at = bent - cell;
    var first = 8.0;
    var second = 8.0;
    var own = 0.0;
    for (var k = 0; k < 9; k++) {
        let step = vec2<i32>(k % 3 - 1, k / 3 - 1);
        let there = vec2<i32>(cell) + step;
        let chance = hash2(there);
        let to = vec2<f32>(step) + 0.15 + 0.7 * vec2<f32>(chance, fract(chance * 137.31)) - at;
        let away = dot(to, to);
        if (away < first) {
            second = first;
            first = away;
            own = fract(chance * 91.7);
        } else {
            second = min(second, away);
        }
    }
    return vec2<f32>(sqrt(second) - sqrt(first), own);
}

// Share of a place that is open, glowing melt, and how much of the plate's heat its crust keeps.
fn opened(p: vec2<f32>, open: f32) -> vec2<f32> {
    let large = plates(p);
    let small = plates(p * 2.7 + 31.0);
    // Cracks close as lava cools; each plate has its own age.
    let width = mix(0.04, 0.5, open * open) * (0.4 + large.y);
    let crack = 1.0 - smooth_between(0.3 * width, width, large.x);
    let fine = 1.0 - smooth_between(0.0, 0.5 * width + 0.04, small.x);
    let share = max(crack, fine * (0.25 + 0.5 * open));
    return vec2<f32>(share, 0.55 * large.y + 0.45 * small.x);
}

// The same where it drifts: two copies half a period apart, each faded while it jumps back.
fn drifting(at: vec2<f32>, size: f32, flow: vec2<f32>, open: f32) -> vec2<f32> {
    let time = frame.picture.w * 0.12;
    let a = fract(time);
    let b = fract(time + 0.5);
    let here = at / size;
    let share = abs(2.0 * a - 1.0);
    let one = opened(here - flow * (a - 0.5) + floor(time) * 7.13, open);
    if (QUALITY == 0u || dot(flow, flow) < 1e-4) { return one; }
    let two = opened(here - flow * (b - 0.5) + floor(time + 0.5) * 7.13 + 3.7, open);
    return mix(one, two, share);
}

// Light that molten lava gives off at a place of the map: crust where it has cooled, cracks between its plates.
fn melt_light(at: vec2<f32>, pixel: f32, flow: vec2<f32>, degc: f32) -> vec3<f32> {
    let crust = frame.lava.x;
    let level = log2(max(pixel * 17.0, 0.35));
    let whole = floor(level);
    let size = exp2(whole);
    let share = smooth_between(0.25, 0.75, level - whole);
    // Broad patches: channels that stay open, rafts that are shut.
    let broad = mix(fbm(at / (size * 9.0), 3).x, fbm(at / (size * 18.0), 3).x, share);
    let open = clamp(smooth_between(800.0, 1300.0, degc) + 0.7 * broad + 0.5 * (0.5 - crust), 0.0, 1.0);
    var seen = vec2<f32>(0.0);
    if (share < 0.98) { seen += (1.0 - share) * drifting(at, size, flow, open); }
    if (share > 0.02) { seen += share * drifting(at, 2.0 * size, flow, open); }
    let shut = clamp(2.0 * crust, 0.0, 1.6);
    let skin = degc - shut * (240.0 + 420.0 * (1.0 - open) * (1.0 - 0.6 * seen.y) + 260.0 * broad);
    let core = heat_light(degc).rgb;
    return mix(heat_light(min(skin, degc)).rgb, core, seen.x * mix(1.0, 0.75 + 0.6 * broad, min(shut, 1.0)));
}

// Which way lava runs: down the ground's broad slope, faster where it is steep.
fn drift_at(uv: vec2<f32>) -> vec2<f32> {
    let slope = -textureSampleLevel(slope_map, smooth_clamp, uv, 2.0).rg;
    let steep = length(slope);
    return slope / max(steep, 1e-4) * min(0.25 + 2.0 * steep, 1.2) * smooth_between(0.0, 0.02, steep);
}

// Rock by the code of its age: black glass when fresh, grey-brown when old.
fn frozen_colour(age: f32) -> vec3<f32> {
    let grey = mix(vec3<f32>(0.018, 0.017, 0.018), vec3<f32>(0.052, 0.048, 0.045), smooth_between(0.0, 0.35, age));
    return mix(grey, vec3<f32>(0.10, 0.080, 0.060), smooth_between(0.3, 0.85, age));
}

fn lava_at(at: vec3<f32>, uv: vec2<f32>, normal: vec3<f32>, away: f32, snow: f32) -> Lava {
    var out = Lava(0.0, vec3<f32>(0.0), normal, vec3<f32>(0.0));
    let map = textureSampleLevel(glow_map, smooth_clamp, uv, 0.0);
    if (map.r + map.b < 0.004 || frame.lava.y == 0.0) { return out; }
    let pixel = max(away * frame.eye.w, 0.004);
    // Borders are lobes of their own size, not the map's cells.
    let lobes = fbm(at.xy / (2.5 * frame.air.w), 4);
    let rough = fbm(at.xy / exp2(floor(log2(pixel * 24.0)) ), 4);
    let frozen = smooth_between(0.3, 0.7, map.b + 0.45 * lobes.x) * (1.0 - snow);
    var molten = smooth_between(0.35, 0.6, map.r + 0.4 * lobes.x);
    if (frame.lava.z > 0.0) { molten = 0.0; }
    let age = map.a / max(map.b, 1e-3);
    // What is older is hidden by what grows.
    let bare = max(frozen * (1.0 - smooth_between(0.75, 1.0, age + 0.1 * rough.x)), molten);
    out.share = bare;
    out.albedo = frozen_colour(age * (1.0 - molten)) * (1.0 + 0.5 * rough.x + 0.25 * lobes.x);
    let slope = vec3<f32>(0.45 * rough.yz * frame.cover.w, 0.0);
    out.normal = normalize(normal - (slope - dot(slope, normal) * normal));
    if (molten > 0.0) {
        let degc = map.g / max(map.r, 1e-3);
        // A flow's margin has cooled.
        let edge = 1.0 - smooth_between(0.0, 1.0, molten);
        out.light = melt_light(at.xy, pixel, drift_at(uv), degc - 220.0 * edge) * smooth_between(0.0, 0.5, molten);
    }
    return out;
}

// Light of lava all around on a face of the ground: most from the side where there is more.
fn fire_light(uv: vec2<f32>, normal: vec3<f32>) -> vec3<f32> {
    let here = textureSampleLevel(fire_map, smooth_clamp, uv, 0.0).rg;
    if (here.r < 1e-5 || frame.lava.y == 0.0) { return vec3<f32>(0.0); }
    let size = vec2<f32>(textureDimensions(fire_map));
    let step = 1.5 / size;
    let east = textureSampleLevel(fire_map, smooth_clamp, uv + vec2<f32>(step.x, 0.0), 0.0).r;
    let north = textureSampleLevel(fire_map, smooth_clamp, uv - vec2<f32>(0.0, step.y), 0.0).r;
    let rise = vec2<f32>(east - here.r, north - here.r) / here.r;
    let toward = normalize(vec3<f32>(rise * 2.0, 0.35));
    // By day the picture is not exposed for it.
    return fire_colour(here) * (1.0 - 0.75 * frame.sun.w) * (0.25 + 1.2 * max(dot(normal, toward), 0.0));
}

// The light of a place of the map of fire.
fn fire_colour(place: vec2<f32>) -> vec3<f32> {
    let heat = heat_light(1000.0 * place.g / max(place.r, 1e-5));
    return heat.rgb * (4.0 * PI * place.r / max(heat.w, 0.05));
}
