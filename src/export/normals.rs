//! Normal maps: which way the ground faces, in tangent space. Red is east, blue is up, green is north (OpenGL: Unity,
//! Godot, Blender) or south (DirectX: Unreal).

use crate::grid::Field;

/// Which way green points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub enum Green {
    /// North, the top of the picture: OpenGL, Unity, Godot, Blender.
    #[default]
    #[serde(rename = "up")]
    Up,
    /// South: DirectX, Unreal.
    #[serde(rename = "down")]
    Down,
}

/// Unit normals of a field of heights, three values a sample, -1 to 1.
pub fn normals(height: &Field<f32>, green: Green) -> Vec<f32> {
    let facing = Field::from_fn(height.grid, |x, y| {
        let [east, south] = height.gradient(x, y);
        let length = (east * east + south * south + 1.0).sqrt();
        // The ground faces against its gradient; north is minus south.
        let north = south / length;
        [(-east / length) as f32, if green == Green::Up { north } else { -north } as f32, (1.0 / length) as f32]
    });
    facing.data.into_iter().flatten().collect()
}

/// -1 to 1 as numbers from 0 to `most`; level ground has red and green halfway.
pub fn encoded(value: f32, most: f64) -> f64 {
    ((value as f64 + 1.0) * 0.5 * most + 0.5).clamp(0.0, most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    #[test]
    fn a_slope_to_the_east_and_one_to_the_north() {
        let grid = Grid::new(8, 8, 80.0, Edges::Open);
        let close = |got: &[f32], want: [f64; 3]| got.iter().zip(want).all(|(g, w)| (*g as f64 - w).abs() < 1e-6);
        let half = 0.5f64.sqrt();
        // Falls to the east at 45 degrees, so it faces east and up.
        let east = Field::from_fn(grid, |x, _| -10.0 * x as f32);
        assert!(normals(&east, Green::Up).chunks(3).all(|n| close(n, [half, 0.0, half])));
        // Falls to the north: rows grow to the south, so heights grow with them.
        let north = Field::from_fn(grid, |_, y| 10.0 * y as f32);
        assert!(normals(&north, Green::Up).chunks(3).all(|n| close(n, [0.0, half, half])));
        assert!(normals(&north, Green::Down).chunks(3).all(|n| close(n, [0.0, -half, half])));
        assert_eq!([-1.0, 0.0, 1.0].map(|v| encoded(v, 255.0) as u8), [0, 128, 255]);
    }
}
