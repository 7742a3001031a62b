//! Numbers of the ground itself: basins' hypsometry, roughness, spectrum, curvature, relief, pits, modes.

mod basins;
mod curvature;
mod fft;
mod inversion;
mod local_relief;
mod modes;
mod pits;
mod spectrum;
mod squares;
mod variogram;

pub use basins::{BasinHypsometry, basin_hypsometry};
pub use curvature::curvature_skewness;
pub use inversion::{Inversion, inversion};
pub use local_relief::{DISC_M, LocalRelief, local_relief};
pub use modes::{Modes, histogram, modes};
pub use pits::{Pits, pits};
pub use spectrum::{Spectra, Spectrum, spectra};
pub use squares::squares;
pub use variogram::{Variogram, variogram};

#[cfg(test)]
pub(super) mod shapes {
    //! Grounds whose numbers are known.

    use super::fft::{fft_rows, transpose};
    use crate::grid::{Edges, Field, Grid};

    /// Fractional Brownian ground of a Hurst exponent, by filtering white noise: its spectrum is `k^(−2H−2)` exactly on
    /// the average, and it closes on itself. Unit standard deviation, 1 km cells, all land.
    pub fn fbm(side: usize, hurst: f64, seed: u64) -> Field<f32> {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        let mut unit = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64
        };
        let wave = |i: usize| if i <= side / 2 { i as f64 } else { i as f64 - side as f64 };
        let mut modes = vec![[0.0; 2]; side * side];
        for (i, mode) in modes.iter_mut().enumerate() {
            let k = (wave(i % side).powi(2) + wave(i / side).powi(2)).sqrt();
            let (size, turn) = ((-2.0 * (1.0 - unit()).ln()).sqrt(), unit() * std::f64::consts::TAU);
            if k > 0.0 {
                let size = size * k.powf(-hurst - 1.0);
                *mode = [size * turn.cos(), size * turn.sin()];
            }
        }
        fft_rows(&mut modes, side);
        transpose(&mut modes, side);
        fft_rows(&mut modes, side);
        // The real part of a complex ground is a real one with the same spectrum.
        let deviation = (modes.iter().map(|m| m[0] * m[0]).sum::<f64>() / modes.len() as f64).sqrt();
        let grid = Grid::new(side, side, side as f64 * 1000.0, Edges::Open);
        Field { grid, data: modes.iter().map(|m| (m[0] / deviation * 300.0) as f32).collect() }
    }
}
