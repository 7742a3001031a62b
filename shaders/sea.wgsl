#import water

// The sea, on the map and beyond it.

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec3<f32>,
}

@fragment
fn main(in: Vertex) -> @location(0) vec4<f32> {
    let free = place_of(in.at.xy);
    let uv = clamp(free, vec2<f32>(0.0), vec2<f32>(1.0));
    let away = distance(in.at, frame.eye.xyz);
    let view = (frame.eye.xyz - in.at) / away;
    let pixel = away * frame.eye.w / pow(max(view.z, 0.02), 0.7);
    // Beyond the map the bed goes down to the deep.
    let beyond = length(max(abs(free - 0.5) - 0.5, vec2<f32>(0.0)));
    let inside = 1.0 - smooth_between(0.0, 0.02, beyond);
    let rim = frame.map.z - height_at(uv, 0);
    let depth = max(mix(rim, max(rim, 25.0 * frame.water.x), smooth_between(0.0, 0.12, beyond)), 0.0);
    let slope = textureSampleLevel(slope_map, smooth_clamp, uv, 0.5).rg * frame.map.w;
    let sun = mix(1.0, sun_share(uv, rim), inside);
    // Waves lie down in the shallows.
    let shelter = mix(0.5, 1.0, smooth_between(0.0, 0.6 * frame.water.x, depth));
    let water = Water(in.at, uv, depth, length(slope), frame.water.y * shelter, frame.water.z, frame.water.x, sun, 1.0, inside);
    let colour = watered(water, pixel, view);
    // The last film of water is clear.
    let alpha = select(1.0, smooth_between(0.0, 0.025 * frame.water.x, depth), inside > 0.5);
    return vec4<f32>(colour, alpha);
}
