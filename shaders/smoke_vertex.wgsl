#import light
#import haze
#import fire

// A puff of smoke as an octagon that faces the eye, and all that is the same over the whole of it: light, haze, its axes.

struct Puff {
    @builtin(vertex_index) corner: u32,
    // Middle and radius, m.
    @location(0) ball: vec4<f32>,
    // How thick it is, share of its life that is over, turn, picture.
    @location(1) state: vec4<f32>,
    // Optical depth of the smoke towards the light, and up.
    @location(2) depth: vec2<f32>,
}

struct Vertex {
    @builtin(position) position: vec4<f32>,
    // Place, and its radius if that reaches down to the ground, else 0.
    @location(0) at: vec4<f32>,
    @location(1) place: vec2<f32>,
    // Radius in pixels, thickness, share of its life that is over, picture.
    @location(2) @interpolate(flat) state: vec4<f32>,
    // Its picture's axes and the way to the eye: of the light's direction, and of up.
    @location(3) @interpolate(flat) light_axes: vec3<f32>,
    @location(4) @interpolate(flat) up_axes: vec3<f32>,
    // Light on it: direct, of it what goes through thin smoke, of the sky, of lava below; what haze takes and adds.
    @location(5) @interpolate(flat) direct: vec3<f32>,
    @location(6) @interpolate(flat) sky: vec3<f32>,
    @location(7) @interpolate(flat) below: vec3<f32>,
    @location(8) @interpolate(flat) through: vec4<f32>,
    @location(9) @interpolate(flat) veil: vec3<f32>,
}

// Nothing of a puff's picture lies beyond this share of its radius.
const REACH: f32 = 0.87;
const FRESH: vec3<f32> = vec3<f32>(0.085, 0.078, 0.072);
const OLD: vec3<f32> = vec3<f32>(0.54, 0.53, 0.52);

@vertex
fn main(in: Puff) -> Vertex {
    // Six triangles around the first corner.
    let corner = select(0u, in.corner / 3u + in.corner % 3u, in.corner % 3u > 0u);
    let angle = (f32(corner) + 0.5) * 0.25 * PI;
    let side = vec2<f32>(cos(angle), sin(angle)) * (REACH / cos(0.125 * PI));
    let way = in.ball.xyz - frame.eye.xyz;
    let away = max(length(way), 1e-3);
    let forward = way / away;
    let level_right = normalize(cross(forward, vec3<f32>(0.0, 0.0, 1.0)) + vec3<f32>(1e-6, 0.0, 0.0));
    let level_up = cross(level_right, forward);
    let turn = vec2<f32>(cos(in.state.z), sin(in.state.z));
    let right = level_right * turn.x + level_up * turn.y;
    let up = level_up * turn.x - level_right * turn.y;
    let at = in.ball.xyz + (right * side.x + up * side.y) * in.ball.w;
    let uv = clamp(place_of(in.ball.xy), vec2<f32>(0.0), vec2<f32>(1.0));
    let over = max(in.ball.z - max(height_at(uv, 0), frame.map.z), 0.0);
    // What it sees of the glowing land grows wider with its height.
    let cell = frame.map.x / f32(textureDimensions(fire_map).x);
    let level = clamp(log2(max((over + 0.5 * in.ball.w) / cell, 1.0)), 0.0, f32(textureNumLevels(fire_map)) - 1.0);
    let fire = fire_colour(textureSampleLevel(fire_map, smooth_clamp, uv, level).rg) * (1.0 - 0.88 * frame.sun.w);
    // Light goes on through smoke, scattered again and again: shade is never black.
    let reach = 0.8 * exp(-1.1 * in.depth.x) + 0.2 * exp(-0.22 * in.depth.x);
    let albedo = mix(FRESH, OLD, smooth_between(0.0, 0.85, in.state.y)) * (1.0 / PI);
    let direct = albedo * frame.light.rgb * (reach * sun_share(uv, over));
    let sky = albedo * frame.ambient.rgb * (0.35 + 0.65 * exp(-0.35 * in.depth.y));
    let below = mix(albedo, vec3<f32>(0.35 / PI), 0.6) * fire * 0.8;
    let veil = hazed(vec3<f32>(0.0), in.ball.xyz);
    let through = hazed(vec3<f32>(1.0), in.ball.xyz) - veil;
    let ahead = max(dot(forward, frame.toward.xyz), 0.0);
    // It fades before the eye.
    let thick = in.state.x * smooth_between(0.3, 1.5, away / in.ball.w);
    let size = in.ball.w / (away * frame.eye.w);
    return Vertex(
        frame.view_projection * vec4<f32>(at, 1.0),
        vec4<f32>(at, in.ball.w * select(0.0, 1.0, over < 2.5 * in.ball.w)),
        side,
        vec4<f32>(size, thick, in.state.y, in.state.w),
        vec3<f32>(dot(right, frame.toward.xyz), dot(up, frame.toward.xyz), -dot(forward, frame.toward.xyz)),
        vec3<f32>(right.z, up.z, -forward.z),
        direct,
        sky,
        below,
        vec4<f32>(through, 1.5 * pow(ahead, 6.0)),
        veil,
    );
}
