#import light
#import haze
#import noise

// The sea: waves as slopes, Fresnel's mirror of sky and land, and the bed that shines through as far as light reaches.

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec3<f32>,
}

const BED: vec3<f32> = vec3<f32>(0.36, 0.33, 0.25);

// Slope of the waves and how much of it is smaller than a pixel (a variance).
struct Waves {
    slope: vec2<f32>,
    rest: f32,
    crest: f32,
}

fn waves(at: vec2<f32>, pixel: f32) -> Waves {
    var out = Waves(vec2<f32>(0.0), 0.0, 0.0);
    let height = frame.water.y;
    if (height <= 0.0) { return out; }
    let time = frame.picture.w;
    var length = frame.water.z;
    var turn = 0.9;
    // Deep water: long waves run fast. Each is as steep as the next, so its height is in proportion to its length.
    for (var k = 0; k < 7; k++) {
        let number = 2.0 * PI / length;
        let toward = vec2<f32>(cos(turn), sin(turn));
        let phase = number * dot(toward, at) - sqrt(9.81 * number) * time + f32(k) * 1.7;
        let steep = 0.055 * height;
        let shown = 1.0 - smooth_between(0.25, 0.5, pixel / length);
        out.slope += toward * (steep * cos(phase) * shown);
        out.crest += sin(phase) * shown * steep;
        out.rest += 0.5 * steep * steep * (1.0 - shown);
        length *= 0.61;
        turn += 2.4;
    }
    let drift = vec2<f32>(0.6, 0.35) * time;
    var size = frame.water.z * 0.35;
    for (var k = 0; k < i32(frame.shallow.w); k++) {
        let n = value_noise((at + drift * (1.0 + f32(k))) / size + f32(k) * 11.3);
        let shown = 1.0 - smooth_between(0.25, 0.5, pixel / size);
        out.slope += n.yz * (0.05 * height * shown);
        out.rest += 0.0012 * height * height * (1.0 - shown);
        size *= 0.47;
    }
    return out;
}

@fragment
fn main(in: Vertex) -> @location(0) vec4<f32> {
    let uv = place_of(in.at.xy);
    let away = distance(in.at, frame.eye.xyz);
    let view = (frame.eye.xyz - in.at) / away;
    let pixel = away * frame.eye.w / max(view.z, 0.08);
    let inside = all(uv >= vec2<f32>(0.0)) && all(uv <= vec2<f32>(1.0));
    let bed = height_at(clamp(uv, vec2<f32>(0.0), vec2<f32>(1.0)), 0);
    let depth = max(frame.map.z - bed, 0.0);
    let wave = waves(in.at.xy, pixel);
    let slope = wave.slope;
    let normal = normalize(vec3<f32>(-slope, 1.0));
    let facing = max(dot(normal, view), 0.02);
    // Small waves show their flanks to a low view: the mirror is never perfect there.
    let rough = sqrt(wave.rest + 1e-4);
    let fresnel = 0.02 + 0.98 * pow(1.0 - facing, 5.0) / (1.0 + 12.0 * rough);
    var mirror = reflect(-view, normal);
    mirror = normalize(vec3<f32>(mirror.xy, abs(mirror.z) + rough * 0.5));
    let reflected = sky_light(mirror);
    let sun = sun_share(clamp(uv, vec2<f32>(0.0), vec2<f32>(1.0)), depth);
    // The sun's glitter: Blinn's half-way lobe as wide as the waves.
    let half_way = normalize(view + frame.toward.xyz);
    let spread = max(rough * rough + 0.0006, frame.toward.w * frame.toward.w * 2.0);
    let tilt = 1.0 - max(dot(normal, half_way), 0.0);
    let glitter = exp(-2.0 * tilt / spread) / (4.0 * PI * spread) * fresnel * sun;
    // Light goes down and comes back up.
    let clarity = frame.water.x;
    let way = depth / max(facing, 0.25) + depth;
    let absorb = vec3<f32>(0.45, 0.11, 0.075) / 0.11;
    let through = exp(-way / clarity * absorb);
    let light_down = (frame.light.rgb * max(frame.toward.z, 0.0) * sun + frame.ambient.rgb) / PI;
    let shallow = exp(-depth / clarity * 0.5);
    let own = mix(frame.dark.rgb, frame.shallow.rgb, shallow) * light_down * 0.55;
    var colour = own * (1.0 - through) + BED * light_down * through * 0.9;
    let crests = fbm(in.at.xy / (frame.water.z * 1.3) + slope, 4).x;
    let near = exp(-depth / (0.18 * clarity));
    let foam = smooth_between(0.25, 0.75, near + 0.45 * crests) * near * frame.water.w
        + smooth_between(0.14, 0.30, wave.crest + 0.1 * crests) * clamp(frame.water.y - 1.2, 0.0, 1.0) * 0.8;
    colour = mix(colour, reflected, fresnel) + frame.light.rgb * glitter;
    colour = mix(colour, vec3<f32>(0.75) * light_down, clamp(foam, 0.0, 0.9));
    // The last film of water is clear.
    let alpha = select(1.0, smooth_between(0.0, 0.02 * clarity, depth), inside);
    return vec4<f32>(hazed(colour, in.at), alpha);
}
