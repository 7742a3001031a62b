#import frame
#import noise

// Waves on water: slopes that a pixel resolves, and how rough it is below that.

struct Waves {
    // Slope of the surface.
    slope: vec2<f32>,
    // Variance of the slopes that are smaller than a pixel, along one axis.
    rest: f32,
    // Height of the swell, about -1 to 1.
    crest: f32,
}

// Which way the wind blows.
const WIND: vec2<f32> = vec2<f32>(0.8, 0.6);
// Each octave of ripples is so many times shorter.
const SHORTER: f32 = 2.9;
// The longest ripples that are drawn, in pixels: what is longer is swell, or too flat to be seen.
const LONGEST_PX: f32 = 320.0;
// The shortest ripples there are, m.
const CAPILLARY_M: f32 = 0.02;

fn turned(by: f32) -> vec2<f32> {
    let c = cos(by);
    let s = sin(by);
    return vec2<f32>(WIND.x * c - WIND.y * s, WIND.x * s + WIND.y * c);
}

// Steepness of one octave of ripples: wind makes more of them steep, not each without end (after Cox and Munk 1954).
fn ripple_steepness(height: f32) -> f32 {
    return 0.09 * sqrt(height);
}

// Waves at a place, for pixels of a width (m), of a height (1 a breeze) and a longest length (m).
fn waves(at: vec2<f32>, pixel: f32, height: f32, longest: f32) -> Waves {
    var out = Waves(vec2<f32>(0.0), 0.00002, 0.0);
    if (height <= 0.0) { return out; }
    let time = frame.picture.w;
    // Swell: sines of deep water, whose phases and heights wander so that no pattern returns.
    let wander = value_noise(at / (3.1 * longest) + 7.7).x;
    let wander2 = value_noise(at / (5.3 * longest) - 3.1).x;
    let seen = 1.0 - smooth_between(0.03, 0.16, pixel / longest);
    if (seen > 0.0) {
        var length = longest;
        for (var k = 0; k < 4; k++) {
            let way = turned(0.8 * sin(2.4 * f32(k) + 0.4));
            let number = 2.0 * PI / length;
            let phase = number * dot(way, at) - sqrt(9.81 * number) * time + 2.3 * f32(k)
                + 3.4 * (wander * cos(1.9 * f32(k)) + wander2 * sin(1.3 * f32(k) + 0.5));
            let steep = 0.032 * height * (0.62 + 0.38 * sin(1.7 * f32(k) + 4.0 * wander2 - 2.5 * wander));
            let shown = 1.0 - smooth_between(0.03, 0.16, pixel / length);
            // Crests are sharper than troughs.
            let sharp = 1.0 + 0.45 * min(height, 2.0) * sin(phase) * 0.5;
            out.slope += way * (steep * sharp * cos(phase) * shown);
            out.crest += 0.3 * sin(phase) * shown;
            out.rest += 0.25 * steep * steep * (1.0 - shown);
            length *= 0.67;
        }
    } else {
        out.rest += 0.0005 * height * height;
    }
    // Ripples: stretched noise that drifts, from the longest a pixel shows down to its own size.
    let steep = ripple_steepness(height);
    let level = log(pixel * LONGEST_PX) / log(SHORTER);
    let whole = floor(level);
    let share = level - whole;
    var length = pow(SHORTER, whole);
    let count = select(i32(frame.shallow.w) + 2, 2, frame.cover2.w < 0.5);
    for (var k = 0; k < count; k++) {
        var shown = (1.0 - smooth_between(0.12, 0.4, pixel / length)) * (1.0 - smooth_between(0.25, 0.7, length / longest))
            * smooth_between(0.5 * CAPILLARY_M, CAPILLARY_M, length);
        if (k == 0) { shown *= share; }
        if (shown > 0.0) {
            let odd = f32((i32(whole) - k) & 3);
            let way = turned(-0.95 + 0.62 * odd);
            let across = vec2<f32>(-way.y, way.x);
            let speed = 0.55 * sqrt(9.81 * length / (2.0 * PI));
            let p = vec2<f32>(dot(at, way) - speed * time, dot(at, across) * 0.7) / length;
            let n = value_noise(p + 13.7 * odd + 0.6 * wander);
            out.slope += (way * n.y + across * (0.7 * n.z)) * (steep * shown);
            out.crest += 0.16 * n.x * shown;
        }
        length /= SHORTER;
    }
    let octaves = min(log(longest / CAPILLARY_M) / log(SHORTER), 7.0);
    let hidden = clamp(log(2.5 * pixel / CAPILLARY_M) / log(SHORTER), 0.0, octaves);
    out.rest += steep * steep * 0.5 * hidden;
    return out;
}

// Noise in two octaves that is long in the wind's direction.
fn streaked(along: f32, across: f32) -> f32 {
    return value_noise(vec2<f32>(along, across)).x * 0.65 + value_noise(vec2<f32>(along * 2.1 + 5.7, across * 2.3 - 3.9)).x * 0.35;
}

// Share of the surface that breaks, 0 to 1: torn crests of a strong wind, and streaks that it draws out of them.
fn whitecaps(at: vec2<f32>, pixel: f32, height: f32, longest: f32, crest: f32) -> f32 {
    let strength = clamp((height - 1.1) / 2.9, 0.0, 1.5);
    if (strength <= 0.0) { return 0.0; }
    let time = frame.picture.w;
    let mean = 0.06 * strength;
    let near = 1.0 - smooth_between(0.06, 0.4, pixel / longest);
    if (near <= 0.0) { return mean; }
    let along = dot(at, WIND);
    let across = dot(at, vec2<f32>(-WIND.y, WIND.x));
    let rough = fbm(vec2<f32>(along - 1.5 * time, across) / (0.22 * longest), 5).x;
    let lace = fbm(at / (0.035 * longest), 4).x;
    let over = 1.3 * crest + 0.9 * rough - (1.35 - 0.35 * strength);
    let bend = value_noise(at / (0.9 * longest)).x;
    let caps = smooth_between(0.0, 0.3, over) * clamp(0.42 + 1.5 * lace + 0.3 * over, 0.0, 1.0);
    // Foam that stays behind the crests.
    let left = smooth_between(-0.35, 0.25, over) * smooth_between(0.02, 0.28, lace) * 0.35;
    let streaks = streaked(along / (1.6 * longest), (across + 0.3 * longest * bend) / (0.07 * longest) + 1.6 * rough);
    let torn = smooth_between(0.18, 0.6, streaks) * smooth_between(-0.25, 0.3, lace) * 0.3 * clamp(1.6 * strength - 0.5, 0.0, 1.0);
    return clamp(mix(mean, max(caps, max(left, torn)), near), 0.0, 0.88);
}
