//! Slides over a bed, step by step.

use super::{
    flux::{Shares, Slope, Terms},
    levels::{Ground, Slide, slide_coarse},
    params::ThermalParams,
};
use crate::{
    erosion::bed::{Bed, Family, Moved, Part, Saved},
    noise::smoothstep,
};

/// Slides, bound to their parameters and to a bed.
pub struct Thermal {
    params: ThermalParams,
    /// Loose ground when the stage began, then as it is, m.
    loose: Vec<f32>,
    shares: Shares,
    quantum_m: f32,
    slope: Option<Slope>,
}

impl Thermal {
    /// On a bed with so much loose ground on it, m.
    pub fn new(params: ThermalParams, bed: &Bed, loose: Vec<f32>) -> Self {
        let (low, high) = bed.start.iter().fold((0.0f32, 0.0f32), |(low, high), &z| (low.min(z), high.max(z)));
        // No change can be larger than the relief, so that single precision holds 2^23 quanta of it.
        let relief = f64::from(high - low).max(1.0);
        let quantum_m = libm::exp2(libm::ceil(libm::log2(relief)) - 23.0) as f32;
        let shares = shares(&params, bed);
        Self { params, loose, shares, quantum_m, slope: None }
    }

    fn slide(&self, bed: &Bed, part: Part) -> Slide {
        let [from, to] = part.of(self.params.duration_yr);
        let (passes, share) = self.params.passes(to - from);
        let cell_m = bed.grid.cell_m as f32;
        let terms = Terms {
            share,
            drop_m: self.params.talus().map(|rise| rise * cell_m),
            quantum_m: self.quantum_m,
            coast: bed.coast(),
        };
        Slide { method: self.params.method, terms, passes }
    }
}

/// Shares of the rate by mask, hardness and height.
fn shares(params: &ThermalParams, bed: &Bed) -> Shares {
    let by_height = params.hard_rate < 1.0;
    if !by_height && bed.rate.is_empty() {
        return Shares::default();
    }
    let (from, span) = (params.hard_from_m, (params.hard_to_m - params.hard_from_m).max(1e-3));
    let high = |z: f32| 1.0 + (params.hard_rate - 1.0) * smoothstep((f64::from(z - bed.sea_m) - from) / span);
    let soft = |(i, &z): (usize, &f32)| bed.soft(i) * if by_height { high(z) as f32 } else { 1.0 };
    Shares {
        soft: bed.start.iter().enumerate().map(soft).collect(),
        mask: if bed.mask.is_empty() { vec![1.0; bed.start.len()] } else { bed.mask.clone() },
    }
}

impl Family for Thermal {
    fn advance(&mut self, bed: &mut Bed, part: Part) -> Moved {
        let slide = self.slide(bed, part);
        if part.step == 0 && self.params.coarse_levels > 0 && !bed.locked {
            let ground = Ground {
                grid: bed.grid,
                height: bed.start.clone(),
                loose: self.loose.clone(),
                shares: self.shares.clone(),
            };
            // The whole stage's passes: what is coarse comes to rest before the fine begins.
            let whole = Slide { passes: slide.passes * part.steps, ..slide };
            bed.change = slide_coarse(&ground, &whole, self.params.coarse_levels);
            for (loose, gained) in self.loose.iter_mut().zip(&bed.change) {
                *loose = (*loose + gained).max(0.0);
            }
        }
        let mut slope = self.slope.take().unwrap_or_else(|| {
            let height: Vec<f32> = (0..bed.start.len()).map(|i| bed.height(i)).collect();
            Slope::new(bed.grid, &height, std::mem::take(&mut self.loose), &self.shares, &slide.terms)
        });
        slide.run(&mut slope, &bed.start, &mut bed.change);
        self.slope = Some(slope);
        Moved::default()
    }

    fn save(&self) -> Saved {
        let loose = self.slope.as_ref().map_or(&self.loose, |slope| &slope.loose);
        Saved { fields: vec![("loose", loose.clone())], blob: Vec::new() }
    }

    fn restore(&mut self, field: &dyn Fn(&str) -> Option<Vec<f32>>, _blob: &[u8]) -> Option<()> {
        self.loose = field("loose").filter(|loose| loose.len() == self.loose.len())?;
        Some(())
    }
}
