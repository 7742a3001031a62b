#import noise

// Value noise in space, -1 to 1, and its slope.
fn value_noise3(p: vec3<f32>) -> vec4<f32> {
    let cell = floor(p);
    let at = vec3<i32>(cell);
    let t = p - cell;
    let w = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let dw = 30.0 * t * t * (t * (t - 2.0) + 1.0);
    var low = vec4<f32>(0.0);
    var high = vec4<f32>(0.0);
    for (var k = 0; k < 4; k++) {
        let step = vec3<i32>(k & 1, k >> 1u, 0);
        low[k] = hash3(at + step);
        high[k] = hash3(at + step + vec3<i32>(0, 0, 1));
    }
    let a = mix(low, high, w.z);
    let b = mix(a.xz, a.yw, w.x);
    let dx = mix(a.y - a.x, a.w - a.z, w.y) * dw.x;
    let dy = (b.y - b.x) * dw.y;
    let dz4 = high - low;
    let dzx = mix(dz4.xz, dz4.yw, w.x);
    let dz = mix(dzx.x, dzx.y, w.y) * dw.z;
    return vec4<f32>(2.0 * mix(b.x, b.y, w.y) - 1.0, 2.0 * vec3<f32>(dx, dy, dz));
}
