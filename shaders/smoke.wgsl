#import ground

// Smoke: dark and thick when fresh, pale and torn when old; lit by sun, sky and the lava below. Colours times their opacity.
@group(2) @binding(0) var puffs: texture_2d_array<f32>;

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec4<f32>,
    @location(1) place: vec2<f32>,
    @location(2) @interpolate(flat) state: vec4<f32>,
    @location(3) @interpolate(flat) light_axes: vec3<f32>,
    @location(4) @interpolate(flat) up_axes: vec3<f32>,
    @location(5) @interpolate(flat) direct: vec3<f32>,
    @location(6) @interpolate(flat) sky: vec3<f32>,
    @location(7) @interpolate(flat) below: vec3<f32>,
    @location(8) @interpolate(flat) through: vec4<f32>,
    @location(9) @interpolate(flat) veil: vec3<f32>,
}

const LAYERS: f32 = 8.0;
const SIDE: f32 = 128.0;

@fragment
fn main(in: Vertex) -> @location(0) vec4<f32> {
    let uv = in.place * vec2<f32>(0.5, -0.5) + 0.5;
    let layer = floor(in.state.w);
    let level = floor(max(log2(0.5 * SIDE / in.state.x), 0.0));
    var t = textureSampleLevel(puffs, smooth_clamp, uv, i32(layer), level);
    if (QUALITY > 0u) {
        let next = textureSampleLevel(puffs, smooth_clamp, uv, i32((layer + 1.0) % LAYERS), level);
        t = mix(t, next, in.state.w - layer);
    }
    // Old smoke is torn where it is thin.
    let torn = 0.30 * in.state.z;
    let whole = clamp((t.a - torn) / (1.0 - torn), 0.0, 0.995);
    var alpha = 1.0 - pow(1.0 - whole, in.state.y);
    if (in.at.w > 0.0) {
        // It ends softly at the ground.
        let map = clamp(place_of(in.at.xy), vec2<f32>(0.0), vec2<f32>(1.0));
        let over = in.at.z - max(height_at(map, 0), frame.map.z);
        alpha *= smooth_between(-0.05, 0.45, over / in.at.w);
    }
    if (alpha < 0.004) { discard; }
    let flat_face = t.rg * 2.0 - 1.0;
    let face = vec3<f32>(flat_face, sqrt(max(1.0 - dot(flat_face, flat_face), 0.02)));
    let up = dot(face, in.up_axes);
    let facing = clamp(0.35 + 0.65 * dot(face, in.light_axes), 0.0, 1.0);
    let sun = facing * (0.4 + 0.6 * t.b) + in.through.w * (1.0 - alpha);
    let under = clamp(0.55 - 0.6 * up, 0.0, 1.0) * (0.12 + 0.88 * t.b * t.b);
    let colour = in.direct * sun + in.sky * ((0.6 + 0.4 * up) * t.b) + in.below * under;
    return vec4<f32>((colour * in.through.rgb + in.veil) * alpha, alpha);
}
