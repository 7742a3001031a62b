#import sky
#import ground

// Light that a rough face sends back: direct light, the sky's, and what the land around sends up.
fn lit(albedo: vec3<f32>, normal: vec3<f32>, open: f32, sun: f32) -> vec3<f32> {
    let facing = max(dot(normal, frame.toward.xyz), 0.0);
    let direct = frame.light.rgb * facing * sun;
    let up = 0.5 + 0.5 * normal.z;
    let seen = mix(1.0, open, frame.ambient.w);
    let around = frame.ambient.rgb * seen * up;
    let bounce = (frame.light.rgb * max(frame.toward.z, 0.0) * 0.5 + frame.ambient.rgb) * (1.0 - 0.5 * seen) * 0.22;
    return albedo * (1.0 / PI) * (direct + around + bounce * albedo * 2.0);
}
