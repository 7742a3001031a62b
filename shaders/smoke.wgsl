#import light
#import haze

// Smoke: dark and thick when fresh, pale and torn when old; lit by sun, sky and the lava below. Colours times their opacity.
@group(2) @binding(0) var puffs: texture_2d_array<f32>;

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec3<f32>,
    @location(1) side: vec2<f32>,
    @location(2) @interpolate(flat) ball: vec4<f32>,
    @location(3) @interpolate(flat) state: vec4<f32>,
    @location(4) @interpolate(flat) depth: vec2<f32>,
    @location(5) @interpolate(flat) fire: vec3<f32>,
}

const LAYERS: f32 = 8.0;
const FRESH: vec3<f32> = vec3<f32>(0.085, 0.078, 0.072);
const OLD: vec3<f32> = vec3<f32>(0.54, 0.53, 0.52);

@fragment
fn main(in: Vertex) -> @location(0) vec4<f32> {
    let turn = vec2<f32>(cos(in.state.z), sin(in.state.z));
    let place = vec2<f32>(dot(turn, in.side), turn.x * in.side.y - turn.y * in.side.x);
    let uv = place * vec2<f32>(0.5, -0.5) + 0.5;
    let layer = floor(in.state.w);
    let size = 2.0 * in.ball.w / (distance(in.at, frame.eye.xyz) * frame.eye.w);
    let level = max(log2(128.0 / max(size, 1.0)), 0.0);
    let a = textureSampleLevel(puffs, smooth_clamp, uv, i32(layer), level);
    let b = textureSampleLevel(puffs, smooth_clamp, uv, i32((layer + 1.0) % LAYERS), level);
    let t = mix(a, b, in.state.w - layer);
    let spent = in.state.y;
    // Old smoke is torn where it is thin.
    let torn = 0.30 * spent;
    let whole = clamp((t.a - torn) / (1.0 - torn), 0.0, 0.995);
    var alpha = 1.0 - pow(1.0 - whole, in.state.x);
    let map = clamp(place_of(in.at.xy), vec2<f32>(0.0), vec2<f32>(1.0));
    let over = in.at.z - max(height_at(map, 0), frame.map.z);
    // It ends softly at the ground, and before the eye.
    alpha *= smooth_between(-0.05, 0.45, over / in.ball.w);
    alpha *= smooth_between(0.3, 1.5, distance(in.ball.xyz, frame.eye.xyz) / in.ball.w);
    if (alpha < 0.004) { discard; }
    let face = t.rg * 2.0 - 1.0;
    let bent = vec2<f32>(turn.x * face.x - turn.y * face.y, turn.y * face.x + turn.x * face.y);
    let forward = normalize(in.ball.xyz - frame.eye.xyz);
    let right = normalize(cross(forward, vec3<f32>(0.0, 0.0, 1.0)) + vec3<f32>(1e-6, 0.0, 0.0));
    let up = cross(right, forward);
    let normal = normalize(right * bent.x + up * bent.y - forward * sqrt(max(1.0 - dot(bent, bent), 0.02)));
    let view = normalize(in.at - frame.eye.xyz);
    let albedo = mix(FRESH, OLD, smooth_between(0.0, 0.85, spent));
    // Light goes on through smoke, scattered again and again: shade is never black.
    let reach = 0.8 * exp(-1.1 * in.depth.x) + 0.2 * exp(-0.22 * in.depth.x);
    let facing = clamp(0.35 + 0.65 * dot(normal, frame.toward.xyz), 0.0, 1.0);
    let ahead = max(dot(view, frame.toward.xyz), 0.0);
    let through = pow(ahead, 6.0) * (1.0 - alpha) * 1.5;
    let shade = sun_share(map, max(over, 0.0));
    let direct = frame.light.rgb * (reach * shade * (facing * (0.4 + 0.6 * t.b) + through));
    let sky = frame.ambient.rgb * (0.35 + 0.65 * exp(-0.35 * in.depth.y)) * (0.6 + 0.4 * normal.z) * t.b;
    let under = clamp(0.55 - 0.6 * normal.z, 0.0, 1.0);
    let below = in.fire * (0.8 * under * (0.12 + 0.88 * t.b * t.b));
    let colour = albedo * (1.0 / PI) * (direct + sky) + mix(albedo, vec3<f32>(0.35), 0.6) * (1.0 / PI) * below;
    return vec4<f32>(hazed(colour, in.at) * alpha, alpha);
}
