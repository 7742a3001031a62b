//! Sand, grass, rock and snow as small seamless textures, computed: which way each texel slopes, how high it stands, how bright it is.
//! They hold nothing larger than a few dozen texels, so that no pattern shows where they repeat.

use rayon::prelude::*;

use super::{Gpu, ground::copies};

/// Texels of a side.
pub const SIDE: usize = 512;

/// What a texture is like.
struct Recipe {
    /// Wavelengths of the first and of the last octave, texels; both divide the side.
    lengths: [usize; 2],
    /// How much lower each octave is than the one before.
    gain: f32,
    /// Share of ridged noise: sharp crests instead of round hills.
    ridged: f32,
    /// How much brighter heights are than hollows.
    contrast: f32,
    seed: u32,
}

/// Sand, grass, rock, snow.
const RECIPES: [Recipe; 4] = [
    Recipe { lengths: [32, 2], gain: 0.55, ridged: 0.2, contrast: 0.16, seed: 11 },
    Recipe { lengths: [32, 2], gain: 0.78, ridged: 0.0, contrast: 0.62, seed: 23 },
    Recipe { lengths: [64, 2], gain: 0.62, ridged: 0.85, contrast: 0.42, seed: 37 },
    Recipe { lengths: [64, 4], gain: 0.5, ridged: 0.25, contrast: 0.10, seed: 53 },
];
/// Root mean square of the slopes, of which ±1 is the most that is kept.
const TYPICAL_SLOPE: f32 = 0.33;

/// The textures of all layers: slope across and up, height, brightness; half is zero slope, middle height, own colour.
pub(super) fn textures(gpu: &Gpu) -> wgpu::Texture {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("textures of the ground"),
        size: wgpu::Extent3d { width: SIDE as u32, height: SIDE as u32, depth_or_array_layers: 4 },
        mip_level_count: SIDE.ilog2() + 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (layer, recipe) in RECIPES.iter().enumerate() {
        for (level, (size, data)) in copies([SIDE; 2], recipe.texels()).iter().enumerate() {
            gpu.write(&texture, (level as u32, layer as u32), *size, data);
        }
    }
    texture
}

impl Recipe {
    fn height(&self, x: usize, y: usize) -> f32 {
        let (mut sum, mut most, mut amplitude, mut length) = (0.0, 0.0, 1.0, self.lengths[0]);
        while length >= self.lengths[1] {
            let n = lattice(x, y, length, self.seed.wrapping_add(length as u32));
            let ridge = 1.0 - 2.0 * n.abs();
            sum += amplitude * (n + (ridge - n) * self.ridged);
            most += amplitude;
            amplitude *= self.gain;
            length /= 2;
        }
        sum / most
    }

    fn texels(&self) -> Vec<[u8; 4]> {
        let heights: Vec<f32> = (0..SIDE * SIDE).into_par_iter().map(|i| self.height(i % SIDE, i / SIDE)).collect();
        let n = heights.len() as f32;
        let mean = heights.iter().sum::<f32>() / n;
        let deviation = (heights.iter().map(|h| (h - mean) * (h - mean)).sum::<f32>() / n).sqrt();
        let at = |x: usize, y: usize| heights[(y % SIDE) * SIDE + x % SIDE];
        let slope = |i: usize| {
            let (x, y) = (i % SIDE + SIDE, i / SIDE + SIDE);
            [at(x + 1, y) - at(x - 1, y), at(x, y + 1) - at(x, y - 1)]
        };
        let steep = (0..heights.len()).map(|i| slope(i).iter().map(|s| s * s).sum::<f32>()).sum::<f32>() / (2.0 * n);
        let by = TYPICAL_SLOPE / steep.sqrt();
        let byte = |v: f32| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        let texel = |i: usize| {
            let over = (heights[i] - mean) / deviation;
            let [a, b] = slope(i).map(|s| byte(0.5 + 0.5 * s * by));
            [a, b, byte(0.5 + over * 0.2), byte(0.5 * (1.0 + self.contrast * 0.4 * over.clamp(-2.2, 2.2)))]
        };
        (0..heights.len()).into_par_iter().map(texel).collect()
    }
}

/// Gradient noise on a lattice of a length, seamless over the side; about -1 to 1.
fn lattice(x: usize, y: usize, length: usize, seed: u32) -> f32 {
    let cells = SIDE / length;
    let at = |v: usize| ((v / length) % cells, (v % length) as f32 / length as f32 + 0.5 / length as f32);
    let ((cx, u), (cy, v)) = (at(x), at(y));
    let corner = |dx: usize, dy: usize| {
        let turn = hash((cx + dx) % cells, (cy + dy) % cells, seed) * std::f32::consts::TAU;
        turn.cos() * (u - dx as f32) + turn.sin() * (v - dy as f32)
    };
    let fade = |t: f32| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let (wu, wv) = (fade(u), fade(v));
    mix(mix(corner(0, 0), corner(1, 0), wu), mix(corner(0, 1), corner(1, 1), wu), wv) * 1.4
}

fn hash(x: usize, y: usize, seed: u32) -> f32 {
    let mut h =
        (x as u32).wrapping_mul(0x9E37_79B1) ^ (y as u32).wrapping_mul(0x85EB_CA77) ^ seed.wrapping_mul(0xC2B2_AE3D);
    h = (h ^ (h >> 15)).wrapping_mul(0x2C1B_3C6D);
    h = (h ^ (h >> 12)).wrapping_mul(0x297A_2D39);
    ((h ^ (h >> 15)) >> 8) as f32 / 16_777_216.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn textures_are_even_and_seamless() {
        for recipe in &RECIPES {
            let texels = recipe.texels();
            for channel in 0..4 {
                let mean = texels.iter().map(|t| f32::from(t[channel])).sum::<f32>() / texels.len() as f32;
                assert!((mean / 255.0 - 0.5).abs() < 0.01, "{channel}: {mean}");
            }
            // Across the seam neighbours differ no more than elsewhere.
            let row = |y: usize| {
                (0..SIDE)
                    .map(|x| {
                        (f32::from(texels[y * SIDE + x][2]) - f32::from(texels[((y + 1) % SIDE) * SIDE + x][2])).abs()
                    })
                    .sum::<f32>()
            };
            let inside = (0..SIDE - 1).map(row).sum::<f32>() / (SIDE - 1) as f32;
            assert!(row(SIDE - 1) < 1.5 * inside);
        }
    }
}
