#import frame

// Light of the sky from a direction, from the table.
fn sky_light(view: vec3<f32>) -> vec3<f32> {
    let turn = atan2(view.x, view.y) * (0.5 / PI);
    let over = asin(clamp(view.z, -1.0, 1.0)) / (0.5 * PI);
    let place = 0.5 + 0.5 * sign(over) * sqrt(abs(over));
    return textureSampleLevel(sky_table, smooth_sky, vec2<f32>(turn, place), 0.0).rgb;
}
