#import lens
#import ground

// Light that haze scatters on its way from the sun to the eye, where the land does not shade it. A march of few steps;
// neighbouring pixels begin at other places (Bayer's order), and a blur that keeps edges evens that out.
@group(2) @binding(0) var distance_map: texture_2d<f32>;

const STEPS: i32 = 14;

fn bayer(at: vec2<i32>) -> f32 {
    let order = array<i32, 16>(0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5);
    return (f32(order[(at.y & 3) * 4 + (at.x & 3)]) + 0.5) / 16.0;
}

// Henyey and Greenstein's share of light by the cosine of its turn.
fn forward(cosine: f32, g: f32) -> f32 {
    let bent = 1.0 + g * g - 2.0 * g * cosine;
    return (1.0 - g * g) / (4.0 * PI * bent * sqrt(bent));
}

@fragment
fn main(in: Whole) -> @location(0) vec4<f32> {
    let seen = textureLoad(distance_map, 2 * vec2<i32>(in.position.xy), 0).r;
    let end = frame.from_picture * vec4<f32>(in.at, 0.5, 1.0);
    let view = normalize(end.xyz / end.w - frame.eye.xyz);
    // Beyond a few sides of the map there is no shade to be seen.
    let far = min(seen, 3.0 * max(frame.map.x, frame.map.y));
    let step = far / f32(STEPS);
    var at = step * bayer(vec2<i32>(in.position.xy));
    var light = vec3<f32>(0.0);
    var behind = vec3<f32>(0.0);
    for (var k = 0; k < STEPS; k++) {
        let place = frame.eye.xyz + view * at;
        let uv = place_of(place.xy);
        let inside = all(uv > vec2<f32>(0.0)) && all(uv < vec2<f32>(1.0));
        let thin = exp(-max(place.z - frame.map.z, 0.0) / frame.haze.w);
        let depth = frame.haze.xyz * (thin * step);
        var sun = 1.0;
        if (inside) {
            let ground = textureLoad(height_map, vec2<i32>(uv * vec2<f32>(textureDimensions(height_map, 2))), 2).r * frame.map.w;
            sun = sun_share(uv, max(place.z - ground, 0.0));
        }
        // The part of a step that is scattered is exact for an even one, however deep.
        light += sun * (1.0 - exp(-depth)) * exp(-behind);
        behind += depth;
        at += step;
    }
    let cosine = dot(view, frame.toward.xyz);
    let share = 0.75 * forward(cosine, 0.72) + 0.25 * forward(cosine, 0.0);
    return vec4<f32>(light * frame.light.rgb * share * frame.rays.x, 1.0);
}
