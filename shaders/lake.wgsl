#import water

// Lakes and running water.

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec3<f32>,
    @location(1) uv: vec2<f32>,
}

@fragment
fn main(in: Vertex) -> @location(0) vec4<f32> {
    let deep = four(water_map, in.uv, 0).y * frame.map.w;
    if (deep <= 0.0) { discard; }
    let away = distance(in.at, frame.eye.xyz);
    let view = (frame.eye.xyz - in.at) / away;
    let pixel = away * frame.eye.w / pow(max(view.z, 0.02), 0.7);
    let slope = textureSampleLevel(slope_map, smooth_clamp, in.uv, 0.5).rg * frame.map.w;
    let longest = clamp(0.25 * frame.water.z, 4.0, 40.0);
    // Fresh water is less clear than the sea, and lies in the lee.
    let water = Water(in.at, in.uv, deep, length(slope), 0.4 * frame.water.y, longest, 0.3 * frame.water.x,
        sun_share(in.uv, deep), 0.0, 1.0);
    var colour = watered(water, pixel, view);
    // Where snow lies all year lakes are frozen.
    let ice = textureSampleLevel(state_map, smooth_clamp, in.uv, 0.0).r;
    if (ice > 0.0) {
        let white = vec3<f32>(0.62, 0.70, 0.76) * (1.0 + 0.15 * fbm(in.at.xy / (40.0 * longest), 4).x);
        colour = mix(colour, hazed(lit(white, vec3<f32>(0.0, 0.0, 1.0), 1.0, water.sun), in.at), 0.9 * ice);
    }
    return vec4<f32>(colour, smooth_between(0.0, 0.12 * frame.map.w, deep));
}
