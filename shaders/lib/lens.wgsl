// Once over the whole picture.

struct Whole {
    @builtin(position) position: vec4<f32>,
    // -1 to 1, to the right and up.
    @location(0) at: vec2<f32>,
}
