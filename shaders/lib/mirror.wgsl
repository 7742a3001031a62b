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

// Light from a direction that leads up from the water: steps grow with the distance, and read coarser heights. A rough
// surface mirrors a cone, of which the land hides a part: by how far the ray passes over or under it, as soft shadows are.
fn mirrored(start: vec3<f32>, ray: vec3<f32>, roughness: f32, inside: f32) -> vec3<f32> {
    let sky = sky_light(ray);
    if (QUALITY < 2u) { return sky; }
    if (frame.inland.x == 0.0 || inside < 0.5 || ray.z > 0.8) { return sky; }
    let cell = frame.air.w;
    let flat = max(length(ray.xy), 1e-3);
    let reach = 0.5 * max(frame.map.x, frame.map.y);
    let first = 0.8 * cell;
    let grows = pow(reach / first, 1.0 / f32(MIRROR_STEPS - 1));
    let width = 0.012 + 0.7 * roughness;
    var before = 0.0;
    var step = first;
    var most = -1.0;
    var met = 0.0;
    for (var k = 0; k < MIRROR_STEPS; k++) {
        let at = start + ray * (step / flat);
        let uv = place_of(at.xy);
        if (any(uv < vec2<f32>(0.0)) || any(uv > vec2<f32>(1.0))) { break; }
        let level = i32(clamp(log2(step * (grows - 1.0) / cell), 0.0, 5.0));
        let over = (height_at(uv, level) - at.z) / (step * width);
        if (over > most) {
            most = over;
            met = step;
        }
        if (over > 1.0) {
            // Closer by halves.
            var low = before;
            var high = step;
            for (var n = 0; n < 4; n++) {
                let middle = 0.5 * (low + high);
                let there = start + ray * (middle / flat);
                if (height_at(place_of(there.xy), level) > there.z) { high = middle; } else { low = middle; }
            }
            met = high;
            break;
        }
        before = step;
        step *= grows;
    }
    if (most <= -1.0) { return sky; }
    let at = start + ray * (met / flat);
    let light = through_air(land_seen(place_of(at.xy), at), start, at, sky);
    return mix(sky, light, smooth_between(-1.0, 1.0, most));
}

// Haze on the way from the water to the land it mirrors.
fn through_air(light: vec3<f32>, a: vec3<f32>, b: vec3<f32>, sky: vec3<f32>) -> vec3<f32> {
    let over = max(0.5 * (a.z + b.z) - frame.map.z, 0.0);
    let through = exp(-frame.haze.xyz * (frame.air.y * distance(a, b) * exp(-over / frame.haze.w)));
    return mix(sky, light, through);
}
