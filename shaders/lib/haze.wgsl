#import sky

// Haze between the eye and a point: extinction thins with height over the sea, and what it scatters is the light of the sky
// behind it. Exact for air in layers and a constant sky.
fn hazed(colour: vec3<f32>, at: vec3<f32>) -> vec3<f32> {
    if (frame.air.y == 0.0) {
        return colour;
    }
    let away = at - frame.eye.xyz;
    let distance = length(away);
    let view = away / max(distance, 1e-6);
    let scale = frame.haze.w;
    let low = exp(-max(frame.eye.z - frame.map.z, -4.0 * scale) / scale);
    let rise = view.z * distance / scale;
    // (1 - exp(-x)) / x without its hole at 0.
    let layers = select((1.0 - exp(-rise)) / rise, 1.0 - 0.5 * rise, abs(rise) < 1e-3);
    let depth = frame.haze.xyz * (distance * low * layers);
    let through = exp(-depth);
    // The haze lies in front of the land: it has the light of the lower sky in that direction.
    let level = normalize(vec3<f32>(view.xy, max(abs(view.z) * 0.25, 0.06)));
    let sunward = pow(max(dot(view, frame.sun.xyz), 0.0), 8.0) * frame.air.x * select(1.0, 0.4, frame.rays.x > 0.0);
    let glow = frame.light.rgb * (0.035 * sunward);
    let lit = mix(sky_light(level), frame.ambient.rgb * (1.0 / PI), 0.35) * 0.9 + glow;
    return colour * through + lit * (1.0 - through);
}
