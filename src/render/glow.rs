//! Bloom: what is brighter than white is spread over ever smaller copies of the picture, each blurred one way and then
//! the other, and their mean is mixed back in. Light is moved, not made.

use super::{
    Gpu,
    passes::{LIGHT, Pass, Slot, Whole, view},
};
use wgpu::{BindGroupLayout, RenderPipeline, Sampler, Texture};

/// Sizes on which light is spread.
pub(super) const LEVELS: usize = 6;
/// Standard deviation of each blur, texels of its level.
const SIGMA: f32 = 1.6;

pub(super) struct Glow {
    layout: BindGroupLayout,
    shrink: RenderPipeline,
    spread: RenderPipeline,
    add: RenderPipeline,
    sampler: Sampler,
}

/// The copies for a picture of one size.
pub(super) struct Copies {
    levels: Vec<[Texture; 2]>,
}

impl Copies {
    pub fn new(gpu: &Gpu, [width, height]: [u32; 2]) -> Self {
        let size = |k: usize| [(width >> (k + 1)).max(1), (height >> (k + 1)).max(1)];
        let levels = (0..LEVELS).take_while(|&k| k == 0 || size(k)[0].min(size(k)[1]) >= 4);
        Self {
            levels: levels
                .map(|k| ["glow", "glow, half blurred"].map(|label| gpu.target(label, size(k), LIGHT, 1)))
                .collect(),
        }
    }

    /// What is mixed into the picture.
    pub fn sum(&self) -> &Texture {
        &self.levels[0][0]
    }
}

impl Glow {
    pub fn new(gpu: &Gpu) -> Self {
        let layout = gpu.layout(&[Slot::Filtered, Slot::Sampler, Slot::Uniform]);
        let pass = |shader, blend| {
            gpu.pipeline(&Pass { shaders: ["cover", shader], groups: &[&layout], blend, ..Pass::default() })
        };
        let part = |src_factor, dst_factor| wgpu::BlendComponent {
            src_factor,
            dst_factor,
            operation: wgpu::BlendOperation::Add,
        };
        let sum = part(wgpu::BlendFactor::One, wgpu::BlendFactor::One);
        Self {
            shrink: pass("shrink", None),
            spread: pass("spread", None),
            add: pass(
                "spread",
                Some(wgpu::BlendState { color: sum, alpha: part(wgpu::BlendFactor::Zero, wgpu::BlendFactor::One) }),
            ),
            sampler: gpu.sampler(wgpu::AddressMode::ClampToEdge, wgpu::AddressMode::ClampToEdge),
            layout,
        }
    }

    /// Spreads the light of a picture.
    pub fn run(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        from: &Texture,
        copies: &Copies,
        [threshold, knee]: [f32; 2],
    ) {
        let mut whole = Whole { encoder };
        let mut draw = |pipeline: &RenderPipeline, from: &Texture, to: &Texture, told: [f32; 4], over| {
            let uniform = gpu.buffer("glow", &told, wgpu::BufferUsages::UNIFORM);
            let source = view(from);
            let resources = vec![
                wgpu::BindingResource::TextureView(&source),
                wgpu::BindingResource::Sampler(&self.sampler),
                uniform.as_entire_binding(),
            ];
            whole.draw(pipeline, &[&gpu.group(&self.layout, resources)], to, over);
        };
        let mut source = from;
        for (k, [level, half]) in copies.levels.iter().enumerate() {
            draw(&self.shrink, source, level, [threshold, knee, f32::from(u8::from(k == 0)), 0.0], false);
            let step = [1.0 / level.width() as f32, 1.0 / level.height() as f32];
            draw(&self.spread, level, half, [step[0], 0.0, SIGMA, 1.0], false);
            draw(&self.spread, half, level, [0.0, step[1], SIGMA, 1.0], false);
            source = level;
        }
        for k in (1..copies.levels.len()).rev() {
            // A tent of the coarser level is added to the finer one.
            let (from, to) = (&copies.levels[k][0], &copies.levels[k - 1][0]);
            draw(&self.add, from, to, [0.0, 0.0, 0.5, 1.0], true);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use half::f16;

    fn adapter() -> Option<Gpu> {
        match Gpu::open() {
            Ok(gpu) => Some(gpu),
            Err(error) if std::env::var_os("UPTHRUST_TESTS_NEED_GPU").is_some() => panic!("{error}"),
            Err(error) => {
                eprintln!("skipped: {error}");
                None
            }
        }
    }

    /// The red of what is left after a picture was spread.
    fn spread(gpu: &Gpu, size: [u32; 2], light: impl Fn(u32, u32) -> f32) -> Vec<f32> {
        let pixels: Vec<[f16; 4]> =
            (0..size[0] * size[1]).map(|i| [f16::from_f32(light(i % size[0], i / size[0])); 4]).collect();
        let picture = gpu.raster("picture", LIGHT, &[(size.map(|n| n as usize), pixels)]);
        let copies = Copies::new(gpu, size);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        Glow::new(gpu).run(gpu, &mut encoder, &picture, &copies, [0.0, 0.0]);
        gpu.queue.submit([encoder.finish()]);
        let bytes = gpu.read_pixels(copies.sum()).unwrap();
        let halves: Vec<f16> = bytemuck::pod_collect_to_vec(&bytes);
        halves.chunks_exact(4).map(|p| p[0].to_f32() / copies.levels.len() as f32).collect()
    }

    #[test]
    fn an_even_picture_stays_even() {
        let Some(gpu) = adapter() else { return };
        for size in [[256, 256], [320, 180], [97, 61]] {
            let out = spread(&gpu, size, |_, _| 3.0);
            // Half floats have eleven bits.
            assert!(out.iter().all(|v| (v - 3.0).abs() < 0.01), "{size:?}");
        }
    }

    #[test]
    fn light_is_moved_not_made() {
        let Some(gpu) = adapter() else { return };
        // So large that next to nothing spreads over the rim.
        let spot = |x: u32, y: u32| if (248..264).contains(&x) && (248..264).contains(&y) { 100.0 } else { 0.0 };
        let out = spread(&gpu, [512, 512], spot);
        let sum: f32 = out.iter().sum::<f32>() * 4.0;
        assert!((sum / (256.0 * 100.0) - 1.0).abs() < 0.02, "{sum}");
        let at = |x: usize, y: usize| out[y * 256 + x];
        assert!(at(128, 128) > at(138, 128) && at(138, 128) > at(154, 128) && at(154, 128) > 0.0);
        assert!((at(138, 128) - at(128, 138)).abs() < 0.02 * at(128, 128));
    }
}
