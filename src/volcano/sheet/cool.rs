//! Heat that leaves, and lava that freezes.

use super::{cells::Sheet, law::Law};

impl Sheet {
    /// What a step's cooling does. What air, sea and sky take cools the whole depth: one linearly implicit (Rosenbrock)
    /// step, which does not overshoot however thin the lava. What the ground takes freezes lava from below, at the solidus.
    pub(super) fn cool(&mut self, law: &Law, dt: f64) {
        let Self { rows, molten, heat, frozen, bed, sea_m, .. } = self;
        let mut slabs = std::mem::take(&mut self.share);
        let lost = rows.each_two((&mut *heat, &mut slabs), |x, y, heat, slab| {
            let i = y * rows.width + x;
            let depth = molten[i];
            *slab = 0.0;
            if depth <= 0.0 {
                return 0.0;
            }
            let before = *heat / depth;
            let (degc, per_k) = (law.melt.degc(before), law.melt.per_k(before));
            let wet = ((*sea_m - bed[i]) / depth).clamp(0.0, 1.0);
            let (loss, slope) = law.upwards(degc, wet);
            let mass = law.density * depth;
            let after = before - dt * loss / (mass * (1.0 + dt * slope / (mass * per_k)));
            if after <= law.rock {
                *slab = depth;
                *heat = depth * after;
                return depth * (before - after);
            }
            let below = dt * law.downwards(degc) / law.density;
            // The slab gives its heat above the solidus.
            *slab = (below / (after - law.rock)).min(depth);
            *heat = (depth - *slab) * after + *slab * law.rock;
            depth * (before - after) + *slab * (after - law.rock)
        });
        let chilled = rows.each_two((&mut *molten, &mut *heat), |x, y, depth, heat| {
            let slab = slabs[y * rows.width + x];
            if slab <= 0.0 {
                return 0.0;
            }
            if slab >= *depth {
                *depth = 0.0;
                return std::mem::take(heat);
            }
            *depth -= slab;
            *heat -= slab * law.rock;
            slab * law.rock
        });
        let froze = rows.each_two((&mut *frozen, &mut *bed), |x, y, frozen, bed| {
            let slab = slabs[y * rows.width + x];
            *frozen += slab;
            *bed += slab;
            slab
        });
        self.share = slabs;
        self.books.heat_lost += lost;
        self.books.heat_frozen += chilled;
        self.books.frozen += froze;
    }
}
