#import light
#import haze

// What a smooth surface mirrors: the sky, or with full quality the land before it.

const MIRROR_STEPS: i32 = 24;

// The land that a ray meets, as lit as it is.
fn land_seen(uv: vec2<f32>, at: vec3<f32>) -> vec3<f32> {
    let cover = textureSampleLevel(cover_map, smooth_clamp, uv, 1.0).rgb;
    let state = textureSampleLevel(state_map, smooth_clamp, uv, 1.0);
    let slope = textureSampleLevel(slope_map, smooth_clamp, uv, 1.0).rg * frame.map.w;
    let normal = normalize(vec3<f32>(-slope, 1.0));
    let bare = 1.0 - smooth_between(frame.cover.z, frame.cover.y, normal.z);
    let ground = mix(mix(cover, vec3<f32>(0.30, 0.28, 0.25), 0.7 * bare), vec3<f32>(0.86, 0.88, 0.92), state.r);
    return lit(ground, normal, state.a, sun_share(uv, 0.0));
}

// Light from a direction that leads up from the water: steps grow with the distance, and read coarser heights.
fn mirrored(start: vec3<f32>, ray: vec3<f32>, inside: f32) -> vec3<f32> {
    let sky = sky_light(ray);
    if (frame.inland.x == 0.0 || inside < 0.5 || ray.z > 0.75) { return sky; }
    let cell = frame.air.w;
    let flat = max(length(ray.xy), 1e-3);
    let reach = 0.5 * max(frame.map.x, frame.map.y);
    let first = 0.8 * cell;
    let grows = pow(reach / first, 1.0 / f32(MIRROR_STEPS - 1));
    let dither = fract(52.9829189 * fract(dot(start.xy / frame.air.w, vec2<f32>(6.711056, 0.583715))));
    var before = 0.0;
    var step = first * mix(0.7, 1.0, dither);
    for (var k = 0; k < MIRROR_STEPS; k++) {
        let at = start + ray * (step / flat);
        let uv = place_of(at.xy);
        if (any(uv < vec2<f32>(0.0)) || any(uv > vec2<f32>(1.0))) { break; }
        let level = i32(clamp(log2(step * (grows - 1.0) / cell), 0.0, 6.0));
        if (height_at(uv, level) > at.z) {
            // Closer by halves.
            var low = before;
            var high = step;
            for (var n = 0; n < 4; n++) {
                let middle = 0.5 * (low + high);
                let there = start + ray * (middle / flat);
                if (height_at(place_of(there.xy), level) > there.z) { high = middle; } else { low = middle; }
            }
            let met = start + ray * (high / flat);
            let light = land_seen(place_of(met.xy), met);
            return through_air(light, start, met, sky);
        }
        before = step;
        step *= grows;
    }
    return sky;
}

// Haze on the way from the water to the land it mirrors.
fn through_air(light: vec3<f32>, a: vec3<f32>, b: vec3<f32>, sky: vec3<f32>) -> vec3<f32> {
    let over = max(0.5 * (a.z + b.z) - frame.map.z, 0.0);
    let through = exp(-frame.haze.xyz * (frame.air.y * distance(a, b) * exp(-over / frame.haze.w)));
    return mix(sky, light, through);
}
