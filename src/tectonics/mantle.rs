//! The mantle's flow, which drags the plates: a seeded, steady velocity field.
//!
//! Sum of a stirring part from a stream function, `v = (∂ψ/∂y, -∂ψ/∂x)`, `ψ = Σ aₖ sin(k·x + φₖ)`, and a straight
//! closing (or opening) of the whole square along one seeded direction. Both are scaled so that the mean speed is the
//! one asked for.

use glam::DVec2;

use crate::noise::Key;

/// Waves of the stream function.
const WAVES: usize = 5;

/// A steady flow over the square, in units of the wanted speed; coordinates in sides of the square from its centre.
#[derive(Clone, Debug)]
pub struct Mantle {
    waves: [Wave; WAVES],
    /// Unit direction along which the flow closes.
    axis: DVec2,
    /// Where the flow closes, in sides of the square.
    sink: DVec2,
    stirring: f64,
    closing: f64,
}

#[derive(Clone, Copy, Debug)]
struct Wave {
    vector: DVec2,
    phase: f64,
    amplitude: f64,
}

impl Mantle {
    /// A flow with a share `closing` of straight convergence (-1 pure opening, 0 pure stirring, 1 pure closing).
    pub fn new(closing: f64, key: Key) -> Self {
        let mut stream = key.stream();
        let waves = std::array::from_fn(|_| {
            let turn = stream.between(0.0, std::f64::consts::TAU);
            // Half to one and a half waves over the square: cells as wide as a few plates.
            let number = std::f64::consts::TAU * stream.between(0.5, 1.5);
            Wave {
                vector: DVec2::new(libm::cos(turn), libm::sin(turn)) * number,
                phase: stream.between(0.0, std::f64::consts::TAU),
                amplitude: stream.between(0.5, 1.0) / number,
            }
        });
        let turn = stream.between(0.0, std::f64::consts::PI);
        let sink = DVec2::new(stream.between(-0.1, 0.1), stream.between(-0.1, 0.1));
        let axis = DVec2::new(libm::cos(turn), libm::sin(turn));
        let mut flow = Self { waves, axis, sink, stirring: 1.0, closing: 0.0 };
        flow.stirring = (1.0 - closing.abs()) / flow.mean_speed();
        flow.closing = closing;
        flow
    }

    /// Velocity at a point, in units of the wanted speed.
    pub fn velocity(&self, at: DVec2) -> DVec2 {
        let mut swirl = DVec2::ZERO;
        for wave in &self.waves {
            let slope = wave.amplitude * libm::cos(wave.vector.dot(at) + wave.phase);
            swirl += DVec2::new(wave.vector.y, -wave.vector.x) * slope;
        }
        // Full speed a sixth of the square away from the sink: plates move as wholes and meet over it.
        let distance = (at - self.sink).dot(self.axis);
        self.stirring * swirl - self.closing * self.axis * libm::tanh(6.0 * distance)
    }

    fn mean_speed(&self) -> f64 {
        const N: usize = 24;
        let at = |i: usize| (i as f64 + 0.5) / N as f64 - 0.5;
        let sum: f64 = (0..N * N).map(|i| self.velocity(DVec2::new(at(i % N), at(i / N))).length_squared()).sum();
        (sum / (N * N) as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stirring_has_unit_speed_and_no_divergence() {
        for seed in 0..20 {
            let flow = Mantle::new(0.0, Key::new(seed));
            assert!((flow.mean_speed() - 1.0).abs() < 1e-12);
            let (p, e) = (DVec2::new(0.13, -0.2), 1e-5);
            let dx = flow.velocity(p + DVec2::X * e).x - flow.velocity(p - DVec2::X * e).x;
            let dy = flow.velocity(p + DVec2::Y * e).y - flow.velocity(p - DVec2::Y * e).y;
            assert!(((dx + dy) / (2.0 * e)).abs() < 1e-5);
        }
    }

    #[test]
    fn closing_brings_both_sides_together() {
        let flow = Mantle::new(1.0, Key::new(3));
        let far = flow.axis * 0.45;
        assert!(flow.velocity(flow.sink + far).dot(far) < -0.4);
        assert!(flow.velocity(flow.sink - far).dot(-far) < -0.4);
    }
}
