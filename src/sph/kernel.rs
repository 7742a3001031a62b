//! Smoothing kernels in three dimensions, all with support `2h`, and their sizes.
//!
//! A kernel is written in `q = r / h`: `W = shape(q) / h³` and `∇W = slope(q) / h⁵ · x`, with `x` the way from the neighbour.
//! Shapes end at 0 without a branch, so that loops over neighbours vectorise.

use std::f32::consts::PI;

/// A smoothing kernel.
pub trait Kernel: Copy + Send + Sync + 'static {
    /// `W·h³`.
    fn shape(q: f32) -> f32;
    /// `dW/dq / q · h³`: finite at 0.
    fn slope(q: f32) -> f32;
    /// The share of the kernel beyond a plane at distance `q·h`, from ½ at the plane to 0.
    fn beyond(q: f32) -> f32;
    /// How fast [`Self::beyond`] falls with `q`.
    fn beyond_slope(q: f32) -> f32;
}

/// Below this `q` kernels with a kink at 0 divide by it instead: coincident particles push each other nowhere.
const LEAST_Q: f32 = 1e-3;

/// The cubic B-spline (Monaghan and Lattanzio 1985).
#[derive(Clone, Copy, Debug)]
pub struct CubicSpline;

impl Kernel for CubicSpline {
    #[inline(always)]
    fn shape(q: f32) -> f32 {
        let (a, b) = ((2.0 - q).max(0.0), (1.0 - q).max(0.0));
        (0.25 * a * a * a - b * b * b) * (1.0 / PI)
    }

    #[inline(always)]
    fn slope(q: f32) -> f32 {
        let (a, b) = ((2.0 - q).max(0.0), (1.0 - q).max(0.0));
        (3.0 * b * b - 0.75 * a * a) * (1.0 / PI) / q.max(LEAST_Q)
    }

    #[inline(always)]
    fn beyond(q: f32) -> f32 {
        let (q, u) = (q.max(0.0), (2.0 - q).max(0.0));
        let (q2, u5) = (q * q, u * u * u * u * u);
        let near = 0.5 - 0.7 * q + q * q2 * (1.0 / 3.0 - 0.15 * q2 + 0.05 * q2 * q);
        if q < 1.0 { near } else { u5 * (0.05 - u * (1.0 / 60.0)) }
    }

    #[inline(always)]
    fn beyond_slope(q: f32) -> f32 {
        let (q, u) = (q.max(0.0), (2.0 - q).max(0.0));
        let (q2, u4) = (q * q, u * u * u * u);
        if q < 1.0 { 0.7 - q2 + q2 * q2 * (0.75 - 0.3 * q) } else { u4 * (0.25 - 0.1 * u) }
    }
}

/// Wendland's C2 function: particles do not pair up, however many neighbours they have, and its gradient needs no division.
#[derive(Clone, Copy, Debug)]
pub struct WendlandC2;

impl Kernel for WendlandC2 {
    #[inline(always)]
    fn shape(q: f32) -> f32 {
        let u = (1.0 - 0.5 * q).max(0.0);
        let u2 = u * u;
        u2 * u2 * (2.0 * q + 1.0) * (21.0 / (16.0 * PI))
    }

    #[inline(always)]
    fn slope(q: f32) -> f32 {
        let u = (1.0 - 0.5 * q).max(0.0);
        u * u * u * (-105.0 / (16.0 * PI))
    }

    #[inline(always)]
    fn beyond(q: f32) -> f32 {
        let u = (1.0 - 0.5 * q.max(0.0)).max(0.0);
        let u2 = u * u;
        u2 * u2 * u2 * (3.5 - 4.5 * u + 1.5 * u2)
    }

    #[inline(always)]
    fn beyond_slope(q: f32) -> f32 {
        let u = (1.0 - 0.5 * q.max(0.0)).max(0.0);
        let u2 = u * u;
        u2 * u2 * u * (10.5 - 15.75 * u + 6.0 * u2)
    }
}

/// The spiky kernel of Desbrun and Gascuel (1996): its slope does not vanish at 0, which keeps particles apart.
#[derive(Clone, Copy, Debug)]
pub struct DesbrunGascuel;

impl Kernel for DesbrunGascuel {
    #[inline(always)]
    fn shape(q: f32) -> f32 {
        let u = (2.0 - q).max(0.0);
        u * u * u * (15.0 / (64.0 * PI))
    }

    #[inline(always)]
    fn slope(q: f32) -> f32 {
        let u = (2.0 - q).max(0.0);
        u * u * (-45.0 / (64.0 * PI)) / q.max(LEAST_Q)
    }

    #[inline(always)]
    fn beyond(q: f32) -> f32 {
        let u = (2.0 - q.max(0.0)).max(0.0);
        let u2 = u * u;
        u2 * u2 * u * (15.0 / 32.0) * (0.1 - u * (1.0 / 30.0))
    }

    #[inline(always)]
    fn beyond_slope(q: f32) -> f32 {
        let u = (2.0 - q.max(0.0)).max(0.0);
        let u2 = u * u;
        u2 * u2 * (15.0 / 32.0) * (0.5 - 0.2 * u)
    }
}

/// How large a kernel and a particle are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Distance of particles at rest, m.
    pub spacing_m: f32,
    /// Smoothing length, m.
    pub h_m: f32,
    /// Volume at which a cubic lattice of that spacing has exactly the rest density, m³: what a particle weighs in sums.
    pub volume_m3: f32,
}

impl Scale {
    /// The sizes for particles `spacing_m` apart and a smoothing length of `ratio` spacings.
    pub fn new<K: Kernel>(spacing_m: f64, ratio: f64) -> Self {
        let reach = libm::ceil(2.0 * ratio) as i64;
        let mut sum = 0.0;
        for z in -reach..=reach {
            for y in -reach..=reach {
                for x in -reach..=reach {
                    let q = ((x * x + y * y + z * z) as f64).sqrt() / ratio;
                    sum += K::shape(q as f32) as f64;
                }
            }
        }
        let h_m = ratio * spacing_m;
        Self { spacing_m: spacing_m as f32, h_m: h_m as f32, volume_m3: (h_m * h_m * h_m / sum) as f32 }
    }

    /// Distance beyond which particles do not feel each other, m.
    pub fn support_m(&self) -> f32 {
        2.0 * self.h_m
    }
}
