//! Water over faces, row by row. Rows of cells have one cell more at either end, which stands for what lies beyond.

use std::hint::select_unpredictable;

use super::rules::{Beat, GRAVITY, PIPE_M, RIM_FALL, Rules};

/// The greater, in one instruction: `f32::max` takes three to be right about what is not a number.
#[inline(always)]
pub fn hi(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The lesser.
#[inline(always)]
pub fn lo(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// `x^(−1/3)` to 2e-5 for positive normal numbers: the exponent by a third, then Newton twice, without a division.
#[inline(always)]
pub fn inverse_cbrt(x: f32) -> f32 {
    let bits = x.to_bits();
    let third = (bits >> 2) + (bits >> 4);
    let third = third + (third >> 4);
    let third = third + (third >> 8);
    let r = f32::from_bits(0x54a2_fa8c - third);
    let part = x * (1.0 / 3.0);
    let r = r * (4.0 / 3.0 - part * (r * r * r));
    r * (4.0 / 3.0 - part * (r * r * r))
}

/// What a face needs to know about the cells at its two sides.
#[derive(Clone, Copy)]
pub struct Sides<'a> {
    pub start: [&'a [f32]; 2],
    /// Change of the bed and depth together.
    pub wet: [&'a [f32]; 2],
    pub depth: [&'a [f32]; 2],
    /// 1 on land, 0 in the sea.
    pub land: [&'a [f32]; 2],
    /// Whether any of them is in the sea.
    pub sea: bool,
}

impl<'a> Sides<'a> {
    #[inline(always)]
    pub fn cut(self, n: usize) -> Self {
        let cut = |[a, b]: [&'a [f32]; 2]| [&a[..n], &b[..n]];
        Self { start: cut(self.start), wet: cut(self.wet), depth: cut(self.depth), land: cut(self.land), ..self }
    }

    /// Fall of the surface from one side to the other, and depth of what passes: never above the sill between them.
    #[inline(always)]
    pub fn fall(&self, i: usize) -> (f32, f32) {
        // Starts apart from the rest: their difference is exact, and lakes stay level to a micrometre on any mountain.
        let fall = (self.start[0][i] - self.start[1][i]) + (self.wet[0][i] - self.wet[1][i]);
        let (a, b) = (self.depth[0][i], self.depth[1][i]);
        let (up, down) = if fall >= 0.0 { (a, b) } else { (b, a) };
        (fall, hi(lo(up, down + fall.abs()), PIPE_M))
    }

    /// 0 between two cells of the sea.
    #[inline(always)]
    fn open(&self, i: usize) -> f32 {
        let (a, b) = (self.land[0][i], self.land[1][i]);
        // Not `hi`: that would choose the place to read from.
        select_unpredictable(a > b, a, b)
    }
}

/// `drag/d^(7/3)`: what friction has to do with a flux; at least `steep/d²`, so that on steep ground it keeps the flux to
/// `FROUDE·d·√(g·d)`.
#[inline(always)]
fn roughness(drag: f32, steep: f32, deep: f32) -> f32 {
    let r = inverse_cbrt(deep);
    let r2 = r * r;
    r2 * r2 * r2 * hi(drag * r, steep)
}

/// The flux after friction: the positive root of `a·q² + q = y`, which is Manning's law where it no longer changes.
#[inline(always)]
fn rub(y: f32, roughness: f32) -> f32 {
    let inner = 1.0 + roughness * y.abs();
    (y + y) / (1.0 + inner.sqrt())
}

/// Signed fluxes over a row of faces, m²/s, positive from side 0 to side 1, from those of the step before; `rough` is room
/// for a row.
#[inline(always)]
pub fn push(beat: &Beat, sides: Sides, old: &[f32], flux: &mut [f32], rough: &mut [f32]) {
    let n = flux.len();
    let (sides, old, rough) = (sides.cut(n), &old[..n], &mut rough[..n]);
    // Two short loops rather than one: a processor that waits for each step of a long one has no room to begin the next.
    for i in 0..n {
        let (fall, deep) = sides.fall(i);
        flux[i] = old[i] + beat.pull * deep * fall;
        rough[i] = roughness(beat.drag, beat.steep * fall.abs(), deep);
    }
    if beat.drag != 0.0 {
        for i in 0..n {
            flux[i] = rub(flux[i], rough[i]);
        }
    }
    if sides.sea {
        for i in 0..n {
            flux[i] *= sides.open(i);
        }
    }
}

/// One-sided fluxes over a row of faces: `ahead` from side 0 to side 1, `back` the other way.
#[inline(always)]
pub fn push_apart(beat: &Beat, sides: Sides, old: [&[f32]; 2], ahead: &mut [f32], back: &mut [f32]) {
    let n = ahead.len();
    let (sides, old, back) = (sides.cut(n), [&old[0][..n], &old[1][..n]], &mut back[..n]);
    for i in 0..n {
        let (fall, deep) = sides.fall(i);
        let gain = beat.pull * deep * fall;
        let (a, b) = (hi(old[0][i] + gain, 0.0), hi(old[1][i] - gain, 0.0));
        let (free, rough) = (beat.drag == 0.0, roughness(beat.drag, beat.steep * fall.abs(), deep));
        ahead[i] = if free { a } else { rub(a, rough) } * sides.open(i);
        back[i] = if free { b } else { rub(b, rough) } * sides.open(i);
    }
}

/// Keeps what a cell gives below what it has, however the division is rounded.
const LESS: f32 = 1.0 - 1e-6;

/// The share of its outflow that each cell can really give; `x` are the faces of the row from west to east.
#[inline(always)]
pub fn ration(pace: f32, depth: &[f32], x: &[f32], [north, south]: [&[f32]; 2], out: &mut [f32]) {
    let n = out.len();
    let (depth, east, west) = (&depth[..n], &x[1..][..n], &x[..n]);
    let (north, south) = (&north[..n], &south[..n]);
    for i in 0..n {
        let leaves = (hi(east[i], 0.0) + hi(-west[i], 0.0)) + (hi(south[i], 0.0) + hi(-north[i], 0.0));
        let wanted = leaves * pace;
        out[i] = if wanted > depth[i] { LESS * depth[i] / wanted } else { 1.0 };
    }
}

/// The same for one-sided fluxes: those ahead to the east and south, those back to the west and north.
#[inline(always)]
pub fn ration_apart(pace: f32, depth: &[f32], ahead: [&[f32]; 2], back: [&[f32]; 2], out: &mut [f32]) {
    let n = out.len();
    let (depth, east, south) = (&depth[..n], &ahead[0][1..][..n], &ahead[1][..n]);
    let (west, north) = (&back[0][..n], &back[1][..n]);
    for i in 0..n {
        let wanted = ((east[i] + west[i]) + (south[i] + north[i])) * pace;
        out[i] = if wanted > depth[i] { LESS * depth[i] / wanted } else { 1.0 };
    }
}

/// Fluxes by their donors' shares, and the sediment that goes with them.
#[inline(always)]
pub fn give(share: [&[f32]; 2], thick: [&[f32]; 2], flux: &mut [f32], load: &mut [f32]) {
    let n = flux.len();
    let (share, thick) = ([&share[0][..n], &share[1][..n]], [&thick[0][..n], &thick[1][..n]]);
    let load = &mut load[..n];
    for i in 0..n {
        // Not an `if`: that would choose the place to read from, and slow gathers would read it.
        let ahead = flux[i] >= 0.0;
        let q = flux[i] * select_unpredictable(ahead, share[0][i], share[1][i]);
        flux[i] = q;
        load[i] = q * select_unpredictable(ahead, thick[0][i], thick[1][i]);
    }
}

/// The same for one-sided fluxes; `flux` becomes what passes in all, `ahead` and `back` are kept for the next step.
#[inline(always)]
pub fn give_apart(
    share: [&[f32]; 2],
    thick: [&[f32]; 2],
    ahead: &mut [f32],
    back: &mut [f32],
    flux: &mut [f32],
    load: &mut [f32],
) {
    for i in 0..flux.len() {
        let (a, b) = (ahead[i] * share[0][i], back[i] * share[1][i]);
        ahead[i] = a;
        back[i] = b;
        flux[i] = a - b;
        load[i] = a * thick[0][i] - b * thick[1][i];
    }
}

/// What a cell at an open rim lets go, m²/s: water keeps its depth and the ground its fall, as in an endless slope, but no
/// faster than its waves.
#[inline(always)]
pub fn spill(rules: &Rules, depth: f32, fall_m: f32) -> f32 {
    let d = hi(depth, PIPE_M);
    let fall = hi(fall_m / rules.cell_m, RIM_FALL);
    let manning = d * d * inverse_cbrt(d) * fall.sqrt() * rules.smooth;
    lo(manning, d * (GRAVITY * d).sqrt())
}
