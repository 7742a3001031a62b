#import lens

// One triangle that covers the picture, as far away as can be.
@vertex
fn main(@builtin(vertex_index) corner: u32) -> Whole {
    let at = vec2<f32>(f32(corner & 1u), f32(corner >> 1u)) * 4.0 - 1.0;
    return Whole(vec4<f32>(at, 0.0, 1.0), at);
}
