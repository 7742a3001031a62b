#import haze
#import ground

// Water that is cut at the map's rim, as through glass: the more of it lies behind, the less of the bed is seen.

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec3<f32>,
}

const STEPS: i32 = 12;

// How far a look goes through the water before it meets the bed, the surface or the map's end, m.
fn way_behind(at: vec3<f32>, look: vec3<f32>, longest: f32) -> f32 {
    var way = longest;
    for (var k = 1; k <= STEPS; k++) {
        let t = f32(k) / f32(STEPS);
        let along = longest * t * t;
        let there = at + look * along;
        let uv = place_of(there.xy);
        if (height_at(clamp(uv, vec2<f32>(0.0), vec2<f32>(1.0)), 0) > there.z || there.z > frame.map.z) {
            way = along;
            break;
        }
    }
    return way;
}

@fragment
fn main(in: Vertex) -> @location(0) vec4<f32> {
    let uv = place_of(in.at.xy);
    let depth = frame.map.z - in.at.z;
    let share = abs(in.at.xy) / frame.map.xy;
    let outward = select(vec2<f32>(0.0, sign(in.at.y)), vec2<f32>(sign(in.at.x), 0.0), share.x > share.y);
    let look = normalize(in.at - frame.eye.xyz);
    // Only what is turned to the eye, under the sea and over the bed.
    if (dot(look.xy, outward) >= 0.0 || depth < 0.0 || in.at.z < height_at(uv, 0)) { discard; }
    let clarity = frame.water.x;
    let longest = 12.0 * clarity;
    let way = way_behind(in.at, look, longest);
    // What lies deep is dark: no light comes up from it.
    let hidden = 1.0 - exp(-0.45 * (way + 1.5 * depth) / clarity);
    // Light fades with depth, but a cut is lit from its side too.
    let facing = max(dot(outward, frame.toward.xy), 0.0);
    let down = frame.light.rgb * (0.55 * max(frame.toward.z, 0.0) + 0.45 * facing) + frame.ambient.rgb * 0.7;
    let optical = depth / clarity;
    let colour = mix(frame.dark.rgb * vec3<f32>(4.0, 3.2, 2.2), frame.shallow.rgb, exp(-0.25 * optical));
    let faded = mix(0.55, 1.0, exp(-0.04 * optical));
    // The edge of the surface catches the light.
    let pixel = distance(in.at, frame.eye.xyz) * frame.eye.w;
    let edge = 0.5 * (1.0 - smooth_between(0.0, 2.0 * pixel, depth));
    let shown = colour * faded * down / PI + edge * frame.ambient.rgb / PI;
    return vec4<f32>(hazed(shown, vec3<f32>(in.at.xy, frame.map.z)), clamp(0.3 + 0.68 * hidden + edge, 0.0, 0.98));
}
