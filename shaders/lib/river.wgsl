#import water

// Rivers, drawn on the ground: as wide as they are, or as wide as a picture needs to show them.

// Share of a pixel that is river.
fn river_share(uv: vec2<f32>, pixel: f32) -> f32 {
    let reach = frame.inland.w;
    let size = vec2<f32>(textureDimensions(river_map));
    let texel = frame.map.x / size.x;
    let level = clamp(log2(pixel / texel) - 0.5, 0.0, max(log2(reach / texel) - 1.0, 0.0));
    let told = textureSampleLevel(river_map, smooth_clamp, uv, level).rg;
    if (told.x <= 0.0) { return 0.0; }
    let away = (1.0 - told.x) * max(reach, 2.0 * texel);
    let half = told.y * reach;
    // Great rivers are never thinner than a pixel and a half; brooks may vanish.
    let great = smooth_between(0.02, 0.16, half / (0.25 * reach));
    let wanted = max(half, min(0.95 * pixel, 0.6 * reach) * great);
    // Between the raster's texels a thinner line would break up: it is drawn as wide as a texel, but fainter.
    let shown = max(wanted, 0.62 * texel);
    let faint = mix(0.3, 1.0, clamp(2.2 * wanted / shown, 0.0, 1.0));
    let p = max(pixel, 1e-3);
    return faint * (clamp((shown - away) / p + 0.5, 0.0, 1.0) - clamp((-shown - away) / p + 0.5, 0.0, 1.0));
}

// The ground with its rivers.
fn with_river(colour: vec3<f32>, at: vec3<f32>, uv: vec2<f32>, slope: vec2<f32>, sun: f32) -> vec3<f32> {
    if (frame.inland.z == 0.0 || textureDimensions(river_map).x <= 1u || at.z < frame.map.z) { return colour; }
    let away = distance(at, frame.eye.xyz);
    let pixel = away * frame.eye.w;
    let share = river_share(uv, pixel);
    if (share <= 0.003) { return colour; }
    let down = frame.light.rgb * (max(frame.toward.z, 0.0) * sun) + frame.ambient.rgb;
    let clear = mix(frame.dark.rgb * DEEP, frame.shallow.rgb, 0.16) * FRESH;
    let own = mix(clear, MUD, 0.25);
    if (QUALITY == 0u) { return mix(colour, (own + 0.05) * down / PI, share); }
    let view = (frame.eye.xyz - at) / away;
    // Ripples go with the stream: down the valley.
    let fall = -slope / max(length(slope), 1e-3);
    let along = vec2<f32>(dot(at.xy, fall), dot(at.xy, vec2<f32>(-fall.y, fall.x)));
    let size = max(3.0, 3.0 * pixel);
    let n = value_noise(vec2<f32>(along.x - 1.5 * frame.picture.w, along.y * 2.0) / size);
    let ripple = 0.05 * n.yz * (1.0 - smooth_between(0.1, 0.4, pixel / size));
    let normal = normalize(vec3<f32>(-ripple, 1.0));
    let facing = clamp(dot(normal, view), 0.03, 1.0);
    let rest = 0.006;
    let mirror = fresnel(facing, sqrt(2.0 * rest));
    var ray = reflect(-view, normal);
    ray = normalize(vec3<f32>(ray.xy, max(ray.z, 0.0) + 0.12));
    var shown = own * down * ((1.0 - mirror) / PI) + sky_light(ray) * mirror;
    shown += glitter(view, ripple, rest, pixel) * sun;
    return mix(colour, shown, share);
}
