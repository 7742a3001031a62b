//! What flows over a face between two cells: lubrication of a Bingham liquid, and how that changes with the surface.

use super::law::{Flow, Law};

/// Depth below which lava does not flow, m.
pub(super) const FILM_M: f64 = 1e-4;
/// What heights may be off by, as a share of them.
const ROUNDING: f64 = 1e-15;

/// A cell as its faces see it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Side {
    /// Top of the ground, m.
    pub(super) bed: f64,
    /// Top of the lava, m.
    pub(super) surface: f64,
    pub(super) flow: Flow,
    /// By how much its depth grows across it, towards east and south, m; no more than its neighbours bear out.
    pub(super) tilt: [f64; 2],
}

impl Side {
    /// The surface as lava of another surface beside it feels it: dry ground that stands above that is a wall, not a slope.
    #[inline(always)]
    pub(super) fn felt_from(&self, surface: f64) -> f64 {
        if self.surface - self.bed < FILM_M { self.surface.min(surface) } else { self.surface }
    }
}

/// By how much depth grows across a cell between two others: the mean of both differences, none at a crest, and never twice
/// the lesser (van Leer's monotonized central limiter).
#[inline(always)]
pub(super) fn tilt(before: f64, here: f64, after: f64) -> f64 {
    let (back, ahead) = (here - before, after - here);
    if back * ahead <= 0.0 {
        0.0
    } else {
        (0.5 * (back + ahead)).clamp(-2.0 * back.abs().min(ahead.abs()), 2.0 * back.abs().min(ahead.abs()))
    }
}

/// Lava over a metre of face from the first cell to the second, m²/s, and by how much more a steeper slope makes it, m²/s;
/// `across` is the surface's slope along the face.
#[inline(always)]
pub(super) fn face(law: &Law, [one, two]: [&Side; 2], axis: usize, across: f64, cell_m: f64) -> [f64; 2] {
    let fall = one.surface - two.surface;
    let onwards = fall > 0.0 || (fall == 0.0 && one.bed > two.bed);
    let (donor, taker, lean) =
        if onwards { (one, two, 0.5 * one.tilt[axis]) } else { (two, one, -0.5 * two.tilt[axis]) };
    // What stands above the higher bed can pass.
    let sill = one.bed.max(two.bed);
    let (high, low) = (donor.surface - sill, (taker.surface - sill).max(0.0));
    if high < FILM_M {
        return [0.0; 2];
    }
    // Two levels that differ by their rounding are one.
    let level = fall.abs() <= ROUNDING * (one.surface.abs() + two.surface.abs());
    let slope = if level { 0.0 } else { fall / cell_m };
    // Where lava runs down its own surface over level ground the integral over the face is known: of h³ from one depth to
    // the other. Where the ground falls, what comes from upwind decides.
    let drops = one.bed - two.bed;
    let (sinks, drops) = ((fall - drops).abs(), drops.abs());
    let spreads = if sinks + drops > 0.0 { sinks / (sinks + drops) } else { 1.0 };
    let upwind = if donor.bed < sill { high } else { (high + lean).max(0.0) };
    let depth = upwind + spreads * (0.5 * (high + low) - upwind);
    let integral = 0.25 * (high * high * high + low * (high * high + low * (high + low)));
    let cube = upwind * upwind * upwind;
    let cube = cube + spreads * (integral - cube);
    let steep = libm::sqrt(slope * slope + across * across);
    let pull = law.weight * depth * steep;
    let stress = donor.flow.stress;
    if stress > 0.0 && pull <= stress {
        return [0.0; 2];
    }
    let plug = if pull > 0.0 { stress / pull } else { 0.0 };
    let ease = law.weight * cube * donor.flow.fluidity / 3.0;
    let free = 1.0 - 1.5 * plug + 0.5 * plug * plug * plug;
    let most = law.most_speed * depth;
    if ease * free * steep > most {
        let ease = most / steep;
        return [ease * slope, ease];
    }
    let along = if steep > 0.0 { slope * slope / (steep * steep) } else { 0.0 };
    [ease * free * slope, ease * (free + 1.5 * plug * (1.0 - plug * plug) * along)]
}
