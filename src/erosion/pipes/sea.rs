//! The sea: cells whose bed is below its level hold that level, and what sediment comes to them falls to the ground.

use super::{
    flow::{hi, lo},
    line::Line,
    rules::{Rules, STRIDE},
    sediment::room,
};

/// Drops what water carries in the sea's cells, up to the sea's level: deltas.
pub fn drop(rules: &Rules, line: &Line, bed: &mut [f32], load: &mut [f32]) {
    for (i, (bed, load)) in bed.iter_mut().zip(load).enumerate() {
        let z = line.ground[i + 1];
        if line.land[i + 1] == 0.0 {
            let free = if rules.locked { 0.25 * room(rules, z) } else { hi(rules.sea_m - z, 0.0) };
            let laid = lo(rules.factor * *load, lo(free, STRIDE * rules.cell_m)) * line.rate[i + 1];
            let left = hi(*load - laid / rules.factor, 0.0);
            *bed += rules.factor * (*load - left);
            *load = left;
        }
    }
}

/// Sets the sea's cells to its level; gives the water that went into it, m, or nothing where there is no sea. `came` is
/// what fluxes brought to a cell, m, `dried` what then dried up, `made` what rounding added.
#[inline(always)]
pub fn level(
    rules: &Rules,
    line: &Line,
    [start, change]: [&[f32]; 2],
    [dried, made]: [&[f32]; 2],
    came: impl Fn(usize) -> f32,
    depth: &mut [f32],
) -> Option<f64> {
    let n = change.len();
    let start = &start[..n];
    let under = |i: usize| start[i] + change[i] < rules.sea_m;
    let mut flooded = 0u32;
    for i in 0..n {
        flooded += u32::from(start[i] + change[i] < rules.sea_m);
    }
    if !line.sea && flooded == 0 {
        return None;
    }
    let mut drowned = 0.0;
    for i in 0..change.len() {
        if line.land[i + 1] == 0.0 {
            // From the parts: their sum is lost in a depth of kilometres.
            drowned += line.rain[i] as f64 + came(i) as f64 + made[i] as f64 - dried[i] as f64;
            depth[i] = 0.0;
        }
        if under(i) {
            drowned += depth[i] as f64;
            depth[i] = rules.sea_m - (start[i] + change[i]);
        }
    }
    Some(drowned)
}

/// The greatest depth of a row on land.
pub fn deepest(rules: &Rules, start: &[f32], change: &[f32], depth: &[f32]) -> f32 {
    let land = |i: usize| start[i] + change[i] >= rules.sea_m;
    (0..depth.len()).filter(|&i| land(i)).fold(0.0, |most, i| hi(depth[i], most))
}
