// What all passes of a picture share. Twin of `Frame` in src/render/frame.rs.

struct Frame {
    // From the map's metres to the picture, and back.
    view_projection: mat4x4<f32>,
    from_picture: mat4x4<f32>,
    // The eye, m; the width of a pixel at a distance of one.
    eye: vec4<f32>,
    // Toward what shines (sun or moon), and the tangent of its disc's radius.
    toward: vec4<f32>,
    // Its light on a face turned to it; strength of shadows.
    light: vec4<f32>,
    // Toward the sun, wherever it is; 0 night to 1 day.
    sun: vec4<f32>,
    // Toward the moon; brightness of stars and moon.
    moon: vec4<f32>,
    // Light of the whole sky on level ground; strength of occlusion.
    ambient: vec4<f32>,
    // Width and height of the map, m; height of the sea, drawn, m; vertical exaggeration.
    map: vec4<f32>,
    // Haze: per metre at sea level for red, green, blue; height of its scale, m.
    haze: vec4<f32>,
    // Tint of haze by the sun, 0 or 1 for haze at all, lowest drawn ground, side of a cell, m.
    air: vec4<f32>,
    // Picture: width, height, px; exposure; seconds since the film began.
    picture: vec4<f32>,
    // Ground: sand's height, m over the sea; cosines at which plants end begin and end; strength of the textures' relief.
    cover: vec4<f32>,
    // Cosines at which snow begins to slide and has gone; style; quality (0 draft, 1 normal, 2 full).
    cover2: vec4<f32>,
    // Bands: drawn heights of rock and snow over the sea, half the width of their borders; thickness of
    // beds of rock.
    bands: vec4<f32>,
    // Water: clarity, m; height of waves; length of the longest, m; foam.
    water: vec4<f32>,
    // Colours of deep and shallow water; look; octaves.
    dark: vec4<f32>,
    shallow: vec4<f32>,
    // Glow: brightness from which light is spread, width of the knee there, share that is spread, levels.
    bloom: vec4<f32>,
    // Strength of shafts of light, of the lens's glare.
    rays: vec4<f32>,
    // Water: 1 where it mirrors the land, size of the looks' pattern, 1 for inland water, reach of the rivers' map, m.
    inland: vec4<f32>,
    // Lava: share of crust; 1 where there is any to draw; 1 where particles are drawn instead of the map's flows.
    lava: vec4<f32>,
    // Light of lava from 400 to 1200 degC in even steps, and how bright that is beside the last.
    heat: array<vec4<f32>, 17>,
}

// How carefully is drawn: 0 draft, 1 normal, 2 full. Every quality has pipelines of its own, since a processor that draws
// runs both ways of every branch.
override QUALITY: u32 = 2u;
// Whether the world has lava, and rivers.
override FIRE: bool = true;
override RIVERS: bool = true;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var sky_table: texture_2d<f32>;
@group(0) @binding(2) var smooth_clamp: sampler;
@group(0) @binding(3) var smooth_repeat: sampler;
@group(0) @binding(4) var smooth_sky: sampler;

const PI: f32 = 3.14159265;

fn smooth_between(low: f32, high: f32, v: f32) -> f32 {
    let t = clamp((v - low) / (high - low), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

fn luminance(c: vec3<f32>) -> f32 {
    return dot(c, vec3<f32>(0.2126, 0.7152, 0.0722));
}
