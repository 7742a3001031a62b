//! The sheet of the sea: a square over the map, and around it, where the sea goes on, rings out to the horizon.

use super::Gpu;

/// Corners of the rings around the eye, and their radii, m: beyond the last one haze hides the edge.
const CORNERS: usize = 48;
const RADII_M: [f64; 9] = [0.0, 300.0, 2e3, 1e4, 4e4, 2e5, 1e6, 4e6, 2e7];

pub(super) struct Sea {
    square: wgpu::Buffer,
    rings: wgpu::Buffer,
    ring_corners: u32,
}

impl Sea {
    pub fn new(gpu: &Gpu) -> Self {
        let corner = |east: f64, north: f64, around: f32| [east as f32, north as f32, around];
        let square: Vec<_> = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)]
            .map(|(x, y)| corner(x, y, 0.0))
            .into();
        let mut rings = Vec::new();
        let at = |ring: usize, k: usize| {
            let turn = k as f64 / CORNERS as f64 * std::f64::consts::TAU;
            corner(RADII_M[ring] * libm::cos(turn), RADII_M[ring] * libm::sin(turn), 1.0)
        };
        for ring in 1..RADII_M.len() {
            for k in 0..CORNERS {
                let [a, b, c, d] = [at(ring - 1, k), at(ring - 1, k + 1), at(ring, k), at(ring, k + 1)];
                rings.extend([a, c, b, b, c, d]);
            }
        }
        Self {
            square: gpu.buffer("sea", &square, wgpu::BufferUsages::VERTEX),
            ring_corners: rings.len() as u32,
            rings: gpu.buffer("open sea", &rings, wgpu::BufferUsages::VERTEX),
        }
    }

    pub fn draw(&self, pass: &mut wgpu::RenderPass, around: bool) {
        let (corners, count) = if around { (&self.rings, self.ring_corners) } else { (&self.square, 6) };
        pass.set_vertex_buffer(0, corners.slice(..));
        pass.draw(0..count, 0..1);
    }
}
