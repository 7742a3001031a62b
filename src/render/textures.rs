//! Sand, grass, rock and snow as small seamless textures, computed: how bright each texel is, how high it stands, which way it slopes.
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
/// Mean brightness; the shader takes it for one.
const MIDDLE: f32 = 0.5263;

/// The textures of all layers: colours with heights, slopes.
pub(super) struct Textures {
    /// Red, green, blue around the layer's own colour, and height.
    pub colours: wgpu::Texture,
    /// Slope across and up.
    pub slopes: wgpu::Texture,
}

impl Textures {
    /// Computes them and hands them over.
    pub fn new(gpu: &Gpu) -> Self {
        let levels = SIDE.ilog2() + 1;
        let make = |label| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: SIDE as u32, height: SIDE as u32, depth_or_array_layers: 4 },
                mip_level_count: levels,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba8Unorm,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            })
        };
        let (colours, slopes) = (make("colours of the ground"), make("relief of the ground"));
        for (layer, recipe) in RECIPES.iter().enumerate() {
            let (colour, slope) = recipe.texels();
            for (texture, data) in [(&colours, colour), (&slopes, slope)] {
                for (level, (size, data)) in copies([SIDE; 2], data).iter().enumerate() {
                    gpu.write(texture, (level as u32, layer as u32), *size, data);
                }
            }
        }
        Self { colours, slopes }
    }
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

    fn texels(&self) -> (Vec<[u8; 4]>, Vec<[u8; 4]>) {
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
        let colour = |i: usize| {
            let over = (heights[i] - mean) / deviation;
            let bright = byte(MIDDLE * (1.0 + self.contrast * 0.4 * over.clamp(-2.2, 2.2)));
            [bright, bright, bright, byte(0.5 + over * 0.2)]
        };
        let lean = |i: usize| {
            let [a, b] = slope(i);
            [byte(0.5 + 0.5 * a * by), byte(0.5 + 0.5 * b * by), 128, 255]
        };
        let all = || (0..heights.len()).into_par_iter();
        (all().map(colour).collect(), all().map(lean).collect())
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
    let mut h = (x as u32).wrapping_mul(0x9E37_79B1) ^ (y as u32).wrapping_mul(0x85EB_CA77) ^ seed.wrapping_mul(0xC2B2_AE3D);
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
            let (colours, _) = recipe.texels();
            let mean = colours.iter().map(|c| f32::from(c[0])).sum::<f32>() / colours.len() as f32;
            assert!((mean / 255.0 - MIDDLE).abs() < 0.02, "{mean}");
            // Across the seam neighbours differ no more than elsewhere.
            let row = |y: usize| {
                (0..SIDE).map(|x| (f32::from(colours[y * SIDE + x][3]) - f32::from(colours[((y + 1) % SIDE) * SIDE + x][3])).abs()).sum::<f32>()
            };
            let inside = (0..SIDE - 1).map(row).sum::<f32>() / (SIDE - 1) as f32;
            assert!(row(SIDE - 1) < 1.5 * inside);
        }
    }
}
