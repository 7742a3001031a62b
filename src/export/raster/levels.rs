//! Quantities as whole numbers of gray: which value black and white stand for.

use serde::Serialize;

use crate::grid::Field;

/// What black (0) and white (the greatest number) stand for, in the layer's unit; linear between.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Levels {
    /// Value of black.
    pub black: f64,
    /// Value of white.
    pub white: f64,
}

impl Levels {
    /// The least and the greatest value of a field; `None` if one is no number. A flat field gets a range of 1.
    pub fn of(field: &Field<f32>) -> Option<Self> {
        let (low, high) = field.range()?;
        let black = low as f64;
        Some(Self { black, white: if high > low { high as f64 } else { black + 1.0 } })
    }

    /// Whole numbers as they are, up to `most`; shifted up only where they go below zero.
    pub fn numbers(field: &Field<f32>, most: f64) -> Option<Self> {
        let black = (field.range()?.0 as f64).min(0.0);
        Some(Self { black, white: black + most })
    }

    /// `white - black`.
    pub fn span(&self) -> f64 {
        self.white - self.black
    }

    /// A value as a number from 0 to `most`, not yet rounded or bounded.
    pub fn place(&self, value: f64, most: f64) -> f64 {
        (value - self.black) * most / self.span()
    }

    /// The field in 16 bits, half up, bounded by black and white.
    pub fn to_u16(self, field: &Field<f32>) -> Vec<u16> {
        // A cast saturates, so what lies outside becomes black or white.
        self.quantised(field, 65535.0, |v| v as u16)
    }

    /// The field in 8 bits.
    pub fn to_u8(self, field: &Field<f32>) -> Vec<u8> {
        self.quantised(field, 255.0, |v| v as u8)
    }

    fn quantised<T: Copy + Default + Send + Sync>(
        self,
        field: &Field<f32>,
        most: f64,
        cast: impl Fn(f64) -> T + Sync,
    ) -> Vec<T> {
        field.map(|v| cast(self.place(v as f64, most) + 0.5)).data
    }

    /// The share of a field's values that lie outside.
    pub fn outside(&self, field: &Field<f32>) -> f64 {
        let out = field.data.iter().filter(|&&v| !(self.black..=self.white).contains(&(v as f64))).count();
        out as f64 / field.data.len().max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    fn field(data: &[f32]) -> Field<f32> {
        Field { grid: Grid::new(data.len(), 1, 1.0, Edges::Open), data: data.to_vec() }
    }

    #[test]
    fn ends_and_middle() {
        let ramp = field(&[-100.0, 0.0, 100.0]);
        let levels = Levels::of(&ramp).unwrap();
        assert_eq!(levels.to_u16(&ramp), [0, 32768, 65535]);
        assert_eq!(levels.to_u8(&ramp), [0, 128, 255]);
        assert_eq!(Levels::of(&field(&[3.0, 3.0])), Some(Levels { black: 3.0, white: 4.0 }));
        assert_eq!(Levels::of(&field(&[3.0, f32::NAN])), None);
    }

    #[test]
    fn what_lies_outside_is_bounded_and_counted() {
        let ramp = field(&[-5.0, 0.0, 5.0, 20.0]);
        let levels = Levels { black: 0.0, white: 10.0 };
        assert_eq!(levels.to_u16(&ramp), [0, 0, 32768, 65535]);
        assert_eq!(levels.outside(&ramp), 0.5);
    }

    #[test]
    fn identities_keep_their_numbers() {
        let ids = field(&[0.0, 7.0, 63.0]);
        assert_eq!(Levels::numbers(&ids, 65535.0).unwrap().to_u16(&ids), [0, 7, 63]);
        assert_eq!(Levels::numbers(&ids, 255.0).unwrap().to_u8(&ids), [0, 7, 63]);
        let none = field(&[-1.0, 7.0]);
        assert_eq!(Levels::numbers(&none, 65535.0).unwrap().to_u16(&none), [0, 8]);
    }
}
