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
    // Heights of both ends in the haze; neither power can grow beyond all numbers, however high the eye is.
    let ends = max(vec2<f32>(frame.eye.z, at.z) - frame.map.z, vec2<f32>(-4.0 * scale)) / scale;
    let thin = exp(-ends);
    let rise = ends.y - ends.x;
    // (exp(-a) - exp(-b)) / (b - a) without its hole at b = a.
    let layers = select((thin.x - thin.y) / rise, thin.x * (1.0 - 0.5 * rise), abs(rise) < 1e-3);
    let depth = frame.haze.xyz * (distance * layers);
    let through = exp(-depth);
    // The haze lies in front of the land: it has the light of the lower sky in that direction.
    let level = normalize(vec3<f32>(view.xy, max(abs(view.z) * 0.25, 0.06)));
    let sunward = pow(max(dot(view, frame.sun.xyz), 0.0), 8.0) * frame.air.x * select(1.0, 0.4, frame.rays.x > 0.0);
    let glow = frame.light.rgb * (0.035 * sunward);
    var lit = frame.ambient.rgb * (1.0 / PI);
    if (QUALITY > 0u) { lit = mix(sky_light(level), lit, 0.35) * 0.9; }
    lit += glow;
    return colour * through + lit * (1.0 - through);
}
