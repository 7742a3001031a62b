#import light
#import haze
#import fire
#import noise3

// A particle of lava as a lump of its own: a sphere with bumps, unlit while it glows.

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec3<f32>,
    @location(1) @interpolate(flat) ball: vec4<f32>,
    @location(2) @interpolate(flat) own: vec2<f32>,
}

struct Shown {
    @location(0) colour: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

const BUMPS: f32 = 0.3;

fn bumps(toward: vec3<f32>, own: f32) -> vec4<f32> {
    let p = toward * 1.9 + vec3<f32>(own * 3.7, own * 1.3, -own * 2.1);
    let a = value_noise3(p);
    let b = value_noise3(p * 2.3 + 5.0);
    return vec4<f32>(0.7 * a.x + 0.3 * b.x, 1.9 * (0.7 * a.yzw + 0.69 * b.yzw));
}

@fragment
fn main(in: Vertex) -> Shown {
    let view = normalize(in.at - frame.eye.xyz);
    let way = in.ball.xyz - frame.eye.xyz;
    let along = dot(way, view);
    let beside = view * along - way;
    let off = length(beside);
    // Out to the outline's own bumps; then the face's.
    let rim = in.ball.w * (1.0 + BUMPS * bumps(beside / max(off, 1e-6), in.own.y).x);
    if (off >= rim || along <= 0.0) { discard; }
    var depth = sqrt(rim * rim - off * off);
    let toward = normalize(beside - view * depth);
    let bump = bumps(toward, in.own.y);
    let radius = in.ball.w * (1.0 + BUMPS * bump.x);
    depth = mix(depth, sqrt(max(radius * radius - off * off, 0.0)), smooth_between(1.0, 0.6, off / rim));
    let at = frame.eye.xyz + view * (along - depth);
    let normal = normalize(toward - BUMPS * (bump.yzw - dot(bump.yzw, toward) * toward));
    let uv = clamp(place_of(at.xy), vec2<f32>(0.0), vec2<f32>(1.0));
    let sun = sun_share(uv, max(at.z - height_at(uv, 0), 0.0));
    let cold = 1.0 - smooth_between(500.0, 700.0, in.own.x);
    let heat = heat_light(in.own.x - 120.0 * frame.lava.x * (0.5 + bump.x)).rgb;
    let rock = lit(frozen_colour(0.12) * (1.0 + 0.4 * bump.x), normal, 1.0, sun);
    let seen = frame.view_projection * vec4<f32>(at, 1.0);
    return Shown(vec4<f32>(hazed(rock * cold + heat, at), 1.0), seen.z / seen.w);
}
