//! Terms of liquids whose viscosity differs from particle to particle.
//!
//! Viscosity is Morris's with the harmonic mean of the two, `a_i = Σ V·4/(r_i + r_j)·(x·∇W)/r²·v_ij` with `r = n²/ν`: where
//! densities are equal that is his `2ν/(n_i·n_j)`. Equal and opposite in every pair, so momentum is kept. What has no
//! viscosity has an endless `r` and rubs nobody.

use std::marker::PhantomData;

use super::{Kernel, Particle, Scale, Term};

/// Pressure and viscosity, as accelerations, m/s². Marks are `p/n²`, notes `n²/ν`.
#[derive(Clone, Copy, Debug)]
pub struct Flowing<K> {
    weight: f32,
    kernel: PhantomData<K>,
}

/// Viscosity alone, without the minus that makes it a drag: `Σ V·4/(r_i + r_j)·|∇W|/r·(v_i − v_j)`, 1/s times the vector.
/// Notes are `n²/ν`.
#[derive(Clone, Copy, Debug)]
pub struct Rubbing<K> {
    weight: f32,
    kernel: PhantomData<K>,
}

/// What [`Rubbing`] has on its diagonal, 1/s.
#[derive(Clone, Copy, Debug)]
pub struct Diagonal<K> {
    weight: f32,
    kernel: PhantomData<K>,
}

/// Pressure, and viscosity as Stora and others (1999) have it, who weigh neighbours' velocities by the kernel itself. Sums 0 to
/// 2 are the pressure's, m/s²; sums 3 to 5 are `Σ V/n_j·W·(v_j − v_i)`, m/s, to be multiplied by the particle's own
/// `α_i/(ρ·n_i)`: what one gives is not what the other gets where they differ. Marks are `p/n²`, notes `1/n`.
#[derive(Clone, Copy, Debug)]
pub struct Drawn<K> {
    slope: f32,
    shape: f32,
    kernel: PhantomData<K>,
}

/// The gradient of velocity by the differences to neighbours, rows for the direction of the derivative, 1/s; and behind them
/// what the same sums make of places, which is 1 on each axis inside a liquid and less beside what has no particles. Marks
/// are `1/n`.
#[derive(Clone, Copy, Debug)]
pub struct Shear<K> {
    weight: f32,
    kernel: PhantomData<K>,
}

macro_rules! weighed {
    ($($name:ident)*) => {
        $(impl<K: Kernel> $name<K> {
            /// For particles of this size.
            pub fn new(scale: &Scale) -> Self {
                let h = scale.h_m;
                Self { weight: scale.volume_m3 / (h * h * h * h * h), kernel: PhantomData }
            }
        })*
    };
}

weighed! { Flowing Rubbing Diagonal Shear }

impl<K: Kernel> Drawn<K> {
    /// For particles of this size.
    pub fn new(scale: &Scale) -> Self {
        let shape = scale.volume_m3 / (scale.h_m * scale.h_m * scale.h_m);
        Self { slope: shape / (scale.h_m * scale.h_m), shape, kernel: PhantomData }
    }
}

impl<K: Kernel> Term<3> for Flowing<K> {
    #[inline(always)]
    fn of(&self, own: &Particle, other: &Particle, way: [f32; 3], q: f32) -> [f32; 3] {
        let slope = self.weight * K::slope(q);
        let out = -(own.mark + other.mark) * slope;
        let along = 4.0 / (own.note + other.note) * slope;
        [0, 1, 2].map(|axis| out * way[axis] + along * (own.v[axis] - other.v[axis]))
    }
}

impl<K: Kernel> Term<3> for Rubbing<K> {
    #[inline(always)]
    fn of(&self, own: &Particle, other: &Particle, _way: [f32; 3], q: f32) -> [f32; 3] {
        let along = -4.0 / (own.note + other.note) * (self.weight * K::slope(q));
        [0, 1, 2].map(|axis| along * (own.v[axis] - other.v[axis]))
    }
}

impl<K: Kernel> Term<1> for Diagonal<K> {
    #[inline(always)]
    fn of(&self, own: &Particle, other: &Particle, way: [f32; 3], q: f32) -> [f32; 1] {
        // Only the particle itself is nowhere away.
        let apart = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
        let along = -4.0 / (own.note + other.note) * (self.weight * K::slope(q));
        [std::hint::select_unpredictable(apart > 0.0, along, 0.0)]
    }
}

impl<K: Kernel> Term<6> for Drawn<K> {
    #[inline(always)]
    fn of(&self, own: &Particle, other: &Particle, way: [f32; 3], q: f32) -> [f32; 6] {
        let out = -(own.mark + other.mark) * (self.slope * K::slope(q));
        let draw = other.note * (self.shape * K::shape(q));
        let v = [0, 1, 2].map(|axis| draw * (other.v[axis] - own.v[axis]));
        [out * way[0], out * way[1], out * way[2], v[0], v[1], v[2]]
    }
}

impl<K: Kernel> Term<12> for Shear<K> {
    #[inline(always)]
    fn of(&self, own: &Particle, other: &Particle, way: [f32; 3], q: f32) -> [f32; 12] {
        let slope = other.mark * (self.weight * K::slope(q));
        let [x, y, z] = way.map(|way| slope * way);
        let [u, v, w] = [0, 1, 2].map(|axis| other.v[axis] - own.v[axis]);
        [x * u, x * v, x * w, y * u, y * v, y * w, z * u, z * v, z * w, -x * way[0], -y * way[1], -z * way[2]]
    }
}

/// The rate of shear `√(½ D:D)`, `D = ∇v + ∇vᵀ`, of the sums of [`Shear`], 1/s. Each row is divided by what it lacks, down to
/// a third: beside a free surface half of the neighbours are missing.
pub fn shear_rate(sums: &[f32; 12]) -> f32 {
    let row = |k: usize| {
        let whole = sums[9 + k].max(1.0 / 3.0);
        [0, 1, 2].map(|axis| sums[3 * k + axis] / whole)
    };
    let g = [row(0), row(1), row(2)];
    let mut sum = 0.0;
    for (a, b) in (0..3).flat_map(|a| (0..3).map(move |b| (a, b))) {
        let d: f32 = g[a][b] + g[b][a];
        sum += d * d;
    }
    (0.5 * sum).sqrt()
}
