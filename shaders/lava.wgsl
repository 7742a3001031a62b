#import lens
#import light
#import haze
#import fire

// The surface of lava's particles: lit rock where it is cold, its own light where it is hot.
@group(2) @binding(0) var felt: texture_2d<f32>;

struct Shown {
    @location(0) colour: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

fn view_of(at: vec2<f32>) -> vec3<f32> {
    let picture = vec2<f32>(at.x / frame.picture.x * 2.0 - 1.0, 1.0 - at.y / frame.picture.y * 2.0);
    let near = frame.from_picture * vec4<f32>(picture, 1.0, 1.0);
    return normalize(near.xyz / near.w - frame.eye.xyz);
}

// Where the surface is a step beside a pixel, by the side on which it goes on.
fn beside(pixel: vec2<f32>, here: f32, step: vec2<f32>) -> vec3<f32> {
    let most = vec2<i32>(frame.picture.xy) - 1;
    let on = textureLoad(felt, clamp(vec2<i32>(pixel + step), vec2<i32>(0), most), 0).r;
    let back = textureLoad(felt, clamp(vec2<i32>(pixel - step), vec2<i32>(0), most), 0).r;
    let middle = frame.eye.xyz + view_of(pixel) * here;
    if (on > 0.0 && (back <= 0.0 || abs(on - here) < abs(back - here))) {
        return frame.eye.xyz + view_of(pixel + step) * on - middle;
    }
    if (back > 0.0) { return middle - frame.eye.xyz - view_of(pixel - step) * back; }
    return view_of(pixel + step) * here - view_of(pixel) * here;
}

@fragment
fn main(in: Whole) -> Shown {
    let pixel = in.position.xy;
    let here = textureLoad(felt, vec2<i32>(pixel), 0).rg;
    if (here.r <= 0.0) { discard; }
    let view = view_of(pixel);
    let at = frame.eye.xyz + view * here.r;
    let across = beside(pixel, here.r, vec2<f32>(1.0, 0.0));
    let up = beside(pixel, here.r, vec2<f32>(0.0, -1.0));
    var normal = normalize(cross(across, up));
    if (dot(normal, view) > 0.0) { normal = -normal; }
    let wide = here.r * frame.eye.w;
    let rough = fbm(at.xy / exp2(floor(log2(wide * 24.0))), 4);
    let cold = 1.0 - smooth_between(700.0, 1100.0, here.g);
    let slope = vec3<f32>((0.15 + 0.3 * cold) * rough.yz * frame.cover.w, 0.0);
    let bent = normalize(normal - (slope - dot(slope, normal) * normal));
    let uv = clamp(place_of(at.xy), vec2<f32>(0.0), vec2<f32>(1.0));
    let sun = sun_share(uv, max(at.z - height_at(uv, 0), 0.0));
    let albedo = frozen_colour(0.12) * (1.0 + 0.5 * rough.x);
    var colour = lit(albedo, bent, 1.0, sun) + albedo * (1.0 / PI) * fire_light(uv, bent);
    colour += melt_light(at.xy, wide, drift_at(uv), here.g);
    let seen = frame.view_projection * vec4<f32>(at, 1.0);
    // Its rim is as soft as a pixel.
    var around = 0.0;
    for (var k = 0; k < 9; k++) {
        let there = vec2<i32>(pixel) + vec2<i32>(k % 3, k / 3) - 1;
        around += select(0.0, 1.0, textureLoad(felt, max(there, vec2<i32>(0)), 0).r > 0.0);
    }
    return Shown(vec4<f32>(hazed(colour, at), smooth_between(1.0, 7.0, around)), seen.z / seen.w);
}
