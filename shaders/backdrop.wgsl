#import lens
#import sky
#import noise

// Sky, sun, moon and stars behind everything.

fn stars(view: vec3<f32>) -> vec3<f32> {
    let grid = view * 160.0;
    let cell = vec3<i32>(floor(grid));
    let chance = hash3(cell);
    if (chance > 0.06) {
        return vec3<f32>(0.0);
    }
    let at = vec3<f32>(hash3(cell + 31), hash3(cell + 57), hash3(cell + 91)) * 0.6 + 0.2;
    let away = length(fract(grid) - at);
    let bright = pow(hash3(cell + 11), 6.0) * 1.6 + 0.1;
    let warm = hash3(cell + 77);
    let tint = mix(vec3<f32>(1.0, 0.82, 0.65), vec3<f32>(0.72, 0.83, 1.0), warm);
    return tint * bright * exp(-away * away * 220.0);
}

fn disc(view: vec3<f32>, toward: vec3<f32>, radius: f32) -> f32 {
    let away = acos(clamp(dot(view, toward), -1.0, 1.0));
    let edge = max(frame.eye.w * 0.8, 0.02 * radius);
    return 1.0 - smooth_between(radius - edge, radius + edge, away);
}

fn moon_face(view: vec3<f32>) -> vec3<f32> {
    let radius = 0.0085;
    let shown = disc(view, frame.moon.xyz, radius);
    if (shown <= 0.0) {
        return vec3<f32>(0.0);
    }
    let right = normalize(cross(frame.moon.xyz, vec3<f32>(0.0, 0.0, 1.0)));
    let up = cross(right, frame.moon.xyz);
    let face = vec2<f32>(dot(view, right), dot(view, up)) / radius;
    let seas = smooth_between(0.0, 0.35, fbm(face * 1.6 + 5.0, 4).x);
    let normal = right * face.x + up * face.y - frame.moon.xyz * sqrt(max(1.0 - dot(face, face), 0.0));
    // Lit from where the sun is.
    let facing = max(dot(normal, frame.sun.xyz), 0.0);
    return vec3<f32>(1.0, 0.97, 0.9) * mix(0.55, 1.0, seas) * (facing + 0.02) * shown;
}

@fragment
fn main(in: Whole) -> @location(0) vec4<f32> {
    let far = frame.from_picture * vec4<f32>(in.at, 1.0, 1.0);
    let view = normalize(far.xyz / far.w - frame.eye.xyz);
    // Under the horizon there is only haze, paler downwards as in a studio.
    let level = normalize(vec3<f32>(view.xy, max(view.z, 0.025 - 0.25 * min(view.z, 0.0))));
    var colour = sky_light(level);
    let above = smooth_between(-0.004, 0.004, view.z);
    let night = frame.moon.w * (1.0 - frame.sun.w);
    if (night > 0.0) {
        let thin = smooth_between(0.0, 0.25, view.z);
        colour += (stars(view) * 0.02 * thin + moon_face(view) * 0.25) * night * above;
    }
    let shown = disc(view, frame.sun.xyz, 0.0047);
    let through = frame.light.rgb * (frame.sun.w / 20.0);
    colour += through * shown * above * 900.0;
    return vec4<f32>(min(colour, vec3<f32>(6.0e4)), 1.0);
}
