#import frame
#import lens

// One way of a blur of distances and temperatures that keeps what lies apart apart.
@group(1) @binding(0) var felt: texture_2d<f32>;
// Along which way, radius of the spheres, m.
@group(1) @binding(1) var<uniform> along: vec4<f32>;

const TAPS: i32 = 7;

@fragment
fn main(in: Whole) -> @location(0) vec4<f32> {
    let at = vec2<i32>(in.position.xy);
    let here = textureLoad(felt, at, 0).rg;
    if (here.r <= 0.0) { return vec4<f32>(0.0); }
    let most = vec2<i32>(textureDimensions(felt)) - 1;
    // Two radii to each side, however near they are.
    let wide = clamp(2.0 * along.z / (here.r * frame.eye.w), 1.0, 48.0);
    let step = wide / f32(TAPS);
    var sum = here;
    var weights = 1.0;
    for (var k = 1; k <= TAPS; k++) {
        let off = f32(k) * step;
        let near = exp(-4.0 * f32(k * k) / f32(TAPS * TAPS));
        let move_by = vec2<i32>(round(along.xy * off));
        let a = textureLoad(felt, clamp(at + move_by, vec2<i32>(0), most), 0).rg;
        let b = textureLoad(felt, clamp(at - move_by, vec2<i32>(0), most), 0).rg;
        var wa = near * alike(a.r, here.r);
        var wb = near * alike(b.r, here.r);
        // In pairs, so that a slope stays one.
        let both = sqrt(wa * wb);
        wa = mix(both, wa, 0.15);
        wb = mix(both, wb, 0.15);
        sum += wa * a + wb * b;
        weights += wa + wb;
    }
    return vec4<f32>(sum / weights, 0.0, 1.0);
}

fn alike(there: f32, here: f32) -> f32 {
    let apart = (there - here) / (1.6 * along.z);
    return select(exp(-apart * apart), 0.0, there <= 0.0);
}
