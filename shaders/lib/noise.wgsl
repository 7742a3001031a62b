// Noise by an integer hash: the same on every adapter.

fn hash2(at: vec2<i32>) -> f32 {
    var h = bitcast<u32>(at.x) * 0x9E3779B1u ^ bitcast<u32>(at.y) * 0x85EBCA77u;
    h = (h ^ (h >> 15u)) * 0x2C1B3C6Du;
    h = (h ^ (h >> 12u)) * 0x297A2D39u;
    h = h ^ (h >> 15u);
    return f32(h >> 8u) * (1.0 / 16777216.0);
}

fn hash3(at: vec3<i32>) -> f32 {
    return hash2(vec2<i32>(at.x + at.z * 7919, at.y ^ (at.z * 104729)));
}

// Value noise, -1 to 1, with its derivatives: (value, d/dx, d/dy). Quintic, so that slopes have no kink.
fn value_noise(p: vec2<f32>) -> vec3<f32> {
    let cell = floor(p);
    let at = vec2<i32>(cell);
    let t = p - cell;
    let w = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let dw = 30.0 * t * t * (t * (t - 2.0) + 1.0);
    let a = hash2(at);
    let b = hash2(at + vec2<i32>(1, 0));
    let c = hash2(at + vec2<i32>(0, 1));
    let d = hash2(at + vec2<i32>(1, 1));
    let k1 = b - a;
    let k2 = c - a;
    let k3 = a - b - c + d;
    let v = a + k1 * w.x + k2 * w.y + k3 * w.x * w.y;
    return vec3<f32>(2.0 * v - 1.0, 2.0 * dw * vec2<f32>(k1 + k3 * w.y, k2 + k3 * w.x));
}

// Octaves of it, each turned and half as high; value and slope, in units of the first octave's length.
fn fbm(p: vec2<f32>, octaves: i32) -> vec3<f32> {
    var sum = vec3<f32>(0.0);
    var amplitude = 0.5;
    var frequency = 1.0;
    var q = p;
    // Turns by 36.87 degrees: no octave lies along another's lattice.
    var turn = mat2x2<f32>(1.0, 0.0, 0.0, 1.0);
    for (var i = 0; i < octaves; i++) {
        let n = value_noise(q * frequency);
        sum += vec3<f32>(amplitude * n.x, amplitude * frequency * (transpose(turn) * n.yz));
        amplitude *= 0.5;
        frequency *= 2.03;
        let by = mat2x2<f32>(0.8, 0.6, -0.6, 0.8);
        turn = by * turn;
        q = by * q + vec2<f32>(17.3, -9.1);
    }
    return sum;
}
