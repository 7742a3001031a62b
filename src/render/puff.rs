//! What a puff of smoke looks like from a side: a ball of noise, marched through once on the processor. Several of them, each a
//! little later than the one before, go round: a puff rolls while it rises.

use rayon::prelude::*;

use super::{
    Gpu,
    ground::{byte, copies},
};

/// Texels of a side, and pictures that go round.
pub(super) const SIDE: usize = 128;
pub(super) const LAYERS: usize = 8;
/// Steps through a ball.
const STEPS: usize = 22;
/// Octaves of bulges, their first frequency over the ball's radius, and how much weaker each is.
const OCTAVES: usize = 5;
const FREQUENCY: f32 = 1.35;
const GAIN: f32 = 0.52;
/// Radius of a ball's core, and how far bulges stand out of it.
const CORE: f32 = 0.26;
const BULGE: f32 = 0.82;
/// Width of its edge, and optical depth of a radius of smoke.
const EDGE: f32 = 0.22;
const DEPTH: f32 = 5.0;
/// How far the noise goes from one picture to the next.
const ON: f32 = 0.2;

/// A value and its slope.
type Sloped = [f32; 4];

fn hash([x, y, z]: [i32; 3]) -> f32 {
    let mut h = (x as u32).wrapping_mul(0x9E37_79B1)
        ^ (y as u32).wrapping_mul(0x85EB_CA77)
        ^ (z as u32).wrapping_mul(0xC2B2_AE3D);
    h = (h ^ (h >> 15)).wrapping_mul(0x2C1B_3C6D);
    h = (h ^ (h >> 12)).wrapping_mul(0x297A_2D39);
    ((h ^ (h >> 15)) >> 8) as f32 / 8_388_608.0 - 1.0
}

/// Value noise in space, -1 to 1.
fn noise(at: [f32; 3]) -> Sloped {
    let cell = at.map(|v| v.floor() as i32);
    let t = [0, 1, 2].map(|k: usize| at[k] - cell[k] as f32);
    let w = t.map(|t| t * t * t * (t * (t * 6.0 - 15.0) + 10.0));
    let dw = t.map(|t| 30.0 * t * t * (t * (t - 2.0) + 1.0));
    let mut out = [0.0; 4];
    for corner in 0..8 {
        let on = [corner & 1, corner >> 1 & 1, corner >> 2];
        let v = hash([0, 1, 2].map(|k: usize| cell[k] + on[k]));
        let share = |k: usize| if on[k] == 1 { w[k] } else { 1.0 - w[k] };
        let slope = |k: usize| if on[k] == 1 { dw[k] } else { -dw[k] };
        let [a, b, c] = [0, 1, 2].map(share);
        out[0] += v * a * b * c;
        out[1] += v * slope(0) * b * c;
        out[2] += v * slope(1) * a * c;
        out[3] += v * slope(2) * a * b;
    }
    out
}

/// Turns by 36.87 degrees around one axis after the other: no octave lies along another's lattice.
fn turned([x, y, z]: [f32; 3]) -> [f32; 3] {
    let (x, y) = (0.8 * x + 0.6 * y, 0.8 * y - 0.6 * x);
    let (y, z) = (0.8 * y + 0.6 * z, 0.8 * z - 0.6 * y);
    [x, y, z]
}

/// The way back of so many turns.
fn back(mut v: [f32; 3], turns: usize) -> [f32; 3] {
    for _ in 0..turns {
        let [x, y, z] = v;
        let (y, z) = (0.8 * y - 0.6 * z, 0.8 * z + 0.6 * y);
        v = [0.8 * x - 0.6 * y, 0.8 * y + 0.6 * x, z];
    }
    v
}

/// Round bulges with creases between, about 0 to 1, and their slope, in which fine ones count for less.
fn bulges(at: [f32; 3]) -> Sloped {
    let (mut sum, mut most, mut amplitude, mut frequency, mut counts) = ([0.0; 4], 0.0, 1.0, FREQUENCY, 1.0);
    let mut p = turned(at);
    for octave in 0..OCTAVES {
        let n = noise(p.map(|v| v * frequency + 13.7 * octave as f32));
        let slope = back([n[1], n[2], n[3]], octave + 1);
        sum[0] += amplitude * n[0].abs();
        (0..3).for_each(|k| sum[k + 1] += counts * amplitude * frequency * n[0].signum() * slope[k]);
        most += amplitude;
        amplitude *= GAIN;
        frequency *= 2.07;
        counts *= 0.62;
        p = turned(p);
    }
    sum.map(|v| v / (0.62 * most))
}

/// A texel: slope of its face to the right and up, how open to light it is, how much it hides.
fn texel(layer: usize, [u, v]: [f32; 2]) -> [u8; 4] {
    let turn = layer as f32 / LAYERS as f32 * std::f32::consts::TAU;
    let round = ON * LAYERS as f32 / std::f32::consts::TAU;
    let (dx, dy) = (round * turn.cos(), round * turn.sin());
    let flat = u * u + v * v;
    let (mut through, mut light, mut open) = (1.0f32, [0.0f32; 3], 0.0);
    if flat < 1.0 {
        let half = (1.0 - flat).sqrt();
        let step = 2.0 * half / STEPS as f32;
        for k in 0..STEPS {
            let z = half - (k as f32 + 0.5) * step;
            let at = [u, v, z];
            let r = (flat + z * z).sqrt();
            let b = bulges([u + dx, v + dy, z + 0.6 * dy]);
            // Nothing reaches the ball's rim.
            let fall = 1.0 - r.powi(6);
            let inside = (CORE + BULGE * b[0] * fall - r) / EDGE;
            if inside <= 0.0 {
                continue;
            }
            let here = through * (1.0 - (-DEPTH * inside.min(1.0) * step).exp());
            through -= here;
            let slope = [0, 1, 2].map(|k: usize| at[k] / r.max(1e-3) - 0.75 * BULGE * b[k + 1]);
            let length = slope.iter().map(|s| s * s).sum::<f32>().sqrt().max(1e-3);
            (0..3).for_each(|k| light[k] += here * slope[k] / length);
            // Creases lie in the shade of the bulges beside them.
            open += here * (0.25 + 0.75 * (b[0] * 1.25).min(1.0)) * (0.55 + 0.45 * r.min(1.0));
        }
    }
    let hidden = 1.0 - through;
    let mean = |v: f32| if hidden > 1e-3 { v / hidden } else { 0.0 };
    [byte(0.5 + 0.5 * mean(light[0])), byte(0.5 + 0.5 * mean(light[1])), byte(mean(open)), byte(hidden)]
}

/// All pictures of a puff, seen from a side, up being up.
fn texels(layer: usize) -> Vec<[u8; 4]> {
    let place = |k: usize| (k as f32 + 0.5) / SIDE as f32 * 2.0 - 1.0;
    (0..SIDE * SIDE).into_par_iter().map(|i| texel(layer, [place(i % SIDE), -place(i / SIDE)])).collect()
}

/// Computes them and hands them over.
pub(super) fn texture(gpu: &Gpu) -> wgpu::Texture {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("puffs of smoke"),
        size: wgpu::Extent3d { width: SIDE as u32, height: SIDE as u32, depth_or_array_layers: LAYERS as u32 },
        mip_level_count: SIDE.ilog2() + 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for layer in 0..LAYERS {
        for (level, (size, data)) in copies([SIDE; 2], texels(layer)).iter().enumerate() {
            gpu.write(&texture, (level as u32, layer as u32), *size, data);
        }
    }
    texture
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_puff_hides_its_middle_and_ends_before_its_rim() {
        for layer in 0..LAYERS {
            let all = texels(layer);
            let at = |x: usize, y: usize| all[y * SIDE + x];
            assert!(at(SIDE / 2, SIDE / 2)[3] > 150, "{layer}");
            assert!(
                (0..SIDE).all(|k| [at(k, 0), at(0, k), at(k, SIDE - 1), at(SIDE - 1, k)].iter().all(|t| t[3] == 0))
            );
            // Beyond what the shader draws there is nothing.
            let out = |k: usize| (k as f32 + 0.5) / SIDE as f32 * 2.0 - 1.0;
            assert!((0..SIDE * SIDE).all(|i| all[i][3] < 2 || libm::hypotf(out(i % SIDE), out(i / SIDE)) < 0.87));
            // It is no disc: along a circle it comes and goes.
            let ring = (0..64).map(|k| {
                let (sin, cos) = libm::sincos(f64::from(k) / 64.0 * std::f64::consts::TAU);
                let place = |v: f64| ((0.5 + 0.34 * v) * SIDE as f64) as usize;
                f64::from(at(place(cos), place(sin))[3])
            });
            let (low, high) = ring.fold((255.0f64, 0.0f64), |(a, b), v| (a.min(v), b.max(v)));
            assert!(high - low > 90.0, "{layer}: {low} {high}");
        }
    }

    #[test]
    fn slopes_are_those_of_the_noise() {
        for k in 0..200 {
            let p = [0.37, 0.81, -0.53].map(|v| v * k as f32 * 0.1);
            for axis in 0..3 {
                let (mut a, mut b) = (p, p);
                a[axis] -= 1e-2;
                b[axis] += 1e-2;
                let want = (noise(b)[0] - noise(a)[0]) / 2e-2;
                // Half the third derivative of quintic curves times the square of the step, and what single precision leaves.
                assert!((noise(p)[axis + 1] - want).abs() < 2e-2, "{p:?} {axis}");
            }
        }
    }

    #[test]
    fn one_picture_goes_over_into_the_next() {
        let apart = |a: &[[u8; 4]], b: &[[u8; 4]]| {
            a.iter().zip(b).map(|(a, b)| u32::from(a[3].abs_diff(b[3]))).sum::<u32>() as f64 / a.len() as f64
        };
        let all: Vec<_> = (0..LAYERS).map(texels).collect();
        let far = apart(&all[0], &all[LAYERS / 2]);
        assert!((0..LAYERS).all(|k| apart(&all[k], &all[(k + 1) % LAYERS]) < 0.8 * far));
    }
}
