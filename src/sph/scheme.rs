//! Steps in time for `x' = v`, `v' = a(x, v)`.
//!
//! A scheme looks at the acceleration once or twice a step; the second look is taken half a step ahead. What it then does
//! with what it saw are four weights, so that a loop over particles need not know which scheme it serves.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a step in time is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Scheme {
    /// Velocities first, places with the new ones: first order, and stable for what swings.
    #[default]
    SymplecticEuler,
    /// Everything by what is there: first order; what swings grows.
    Euler,
    /// The mean of the looks at the beginning and half a step ahead: first order, though it looks twice.
    Rk2Document,
    /// The look half a step ahead alone: second order.
    Midpoint,
}

/// What a step makes of velocities and accelerations seen at its beginning and, for those that look twice, half a step
/// ahead: `v + dt·(first·a + second·a_half)` and `x + dt·(old·v + half·v_half + new·v_new)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Of the acceleration at the beginning.
    pub first: f32,
    /// Of the acceleration half a step ahead.
    pub second: f32,
    /// Of the velocity at the beginning.
    pub old: f32,
    /// Of the velocity half a step ahead.
    pub half: f32,
    /// Of the velocity at the end.
    pub new: f32,
}

impl Scheme {
    /// Whether it takes a second look, half a step ahead.
    pub fn looks_twice(self) -> bool {
        matches!(self, Self::Rk2Document | Self::Midpoint)
    }

    /// What it makes of its looks.
    pub fn weights(self) -> Weights {
        let [first, second, old, half, new] = match self {
            Self::SymplecticEuler => [1.0, 0.0, 0.0, 0.0, 1.0],
            Self::Euler => [1.0, 0.0, 1.0, 0.0, 0.0],
            Self::Rk2Document => [0.5, 0.5, 0.5, 0.5, 0.0],
            Self::Midpoint => [0.0, 1.0, 0.0, 1.0, 0.0],
        };
        Weights { first, second, old, half, new }
    }
}

impl Weights {
    /// The new velocity.
    #[inline(always)]
    pub fn speed(&self, v: f32, [a, a_half]: [f32; 2], dt: f32) -> f32 {
        v + dt * (self.first * a + self.second * a_half)
    }

    /// The new place.
    #[inline(always)]
    pub fn place(&self, x: f32, [v, v_half, v_new]: [f32; 3], dt: f32) -> f32 {
        x + dt * (self.old * v + self.half * v_half + self.new * v_new)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How far `x'' = −x`, from rest at 1, is off after a second in so many steps; in 64ths of f32 nothing would be left to
    /// compare, so steps are few.
    fn off(scheme: Scheme, steps: usize) -> f64 {
        let (dt, weights) = (1.0 / steps as f32, scheme.weights());
        let (mut x, mut v) = (1.0f32, 0.0f32);
        for _ in 0..steps {
            let a = -x;
            let (x_half, v_half) = (x + 0.5 * dt * v, v + 0.5 * dt * a);
            let v_new = weights.speed(v, [a, -x_half], dt);
            x = weights.place(x, [v, v_half, v_new], dt);
            v = v_new;
        }
        let (x, v) = (x as f64 - libm::cos(1.0), v as f64 + libm::sin(1.0));
        (x * x + v * v).sqrt()
    }

    #[test]
    fn orders_are_what_they_are_said_to_be() {
        for (scheme, order) in
            [(Scheme::SymplecticEuler, 1.0), (Scheme::Euler, 1.0), (Scheme::Rk2Document, 1.0), (Scheme::Midpoint, 2.0)]
        {
            let measured = libm::log2(off(scheme, 16) / off(scheme, 32));
            assert!((measured - order).abs() < 0.1, "{scheme:?}: {measured}");
        }
    }

    #[test]
    fn only_symplectic_euler_keeps_a_swing_from_growing() {
        let swing = |scheme: Scheme| {
            let (dt, weights) = (0.1f32, scheme.weights());
            let (mut x, mut v, mut most) = (1.0f32, 0.0f32, 0.0f32);
            for _ in 0..2000 {
                let (x_half, v_half) = (x + 0.5 * dt * v, v - 0.5 * dt * x);
                let v_new = weights.speed(v, [-x, -x_half], dt);
                x = weights.place(x, [v, v_half, v_new], dt);
                v = v_new;
                most = most.max(x.abs());
            }
            most
        };
        assert!(swing(Scheme::SymplecticEuler) < 1.01);
        assert!(swing(Scheme::Euler) > 1e3);
        // Two half steps of Euler: it grows half as fast.
        assert!((100.0..1e3).contains(&swing(Scheme::Rk2Document)), "{}", swing(Scheme::Rk2Document));
        assert!(swing(Scheme::Midpoint) < 1.1);
    }
}
