// What of a colour is brighter than a threshold, with a soft knee before it.
fn bright(c: vec3<f32>, threshold: f32, knee: f32) -> vec3<f32> {
    let l = max(dot(c, vec3<f32>(0.2126, 0.7152, 0.0722)), 1e-6);
    let soft = clamp(l - threshold + knee, 0.0, 2.0 * knee);
    return c * (max(l - threshold, soft * soft / (4.0 * knee + 1e-6)) / l);
}
