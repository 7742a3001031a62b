//! A row of faces: what is pushed over them, then what donors can really give.

use super::{
    flow::{self, Sides},
    rules::Beat,
};

/// Fluxes over a row of faces.
#[derive(Clone, Debug)]
pub struct Faces {
    /// What passes in all.
    pub water: Vec<f32>,
    /// One-sided fluxes, where they are kept.
    pub ahead: Vec<f32>,
    pub back: Vec<f32>,
    pub load: Vec<f32>,
}

impl Faces {
    pub fn new(width: usize) -> Self {
        let row = || vec![0.0f32; width + 1];
        Self { water: row(), ahead: row(), back: row(), load: row() }
    }

    /// Fluxes over as many faces as `old` has, after this step's push.
    #[inline(always)]
    pub fn push(&mut self, beat: &Beat, mei: bool, sides: Sides, old: [&[f32]; 2]) {
        let n = old[0].len();
        if mei {
            flow::push_apart(beat, sides, old, &mut self.ahead[..n], &mut self.back[..n]);
        } else {
            // The row of loads is free until the fluxes are given.
            flow::push(beat, sides, old[0], &mut self.water[..n], &mut self.load);
        }
    }

    /// Sets one face to a flux that is known.
    #[inline(always)]
    pub fn set(&mut self, i: usize, flux: f32) {
        self.water[i] = flux;
        self.ahead[i] = flow::hi(flux, 0.0);
        self.back[i] = flow::hi(-flux, 0.0);
    }

    /// Gives what donors can: water and sediment.
    #[inline(always)]
    pub fn give(&mut self, mei: bool, share: [&[f32]; 2], thick: [&[f32]; 2], n: usize) {
        let (water, load) = (&mut self.water[..n], &mut self.load[..n]);
        if mei {
            flow::give_apart(share, thick, &mut self.ahead[..n], &mut self.back[..n], water, load);
        } else {
            flow::give(share, thick, water, load);
        }
    }
}
