//! Storm water in virtual pipes between cells, what it wears off and lays down, and banks that slide (Mei, Decaudin and Hu
//! 2007; Jákó 2011; with the mendings below).
//!
//! **Water.** A face has one signed flux `q`, m²/s for each metre of its length, from side 0 to side 1. With the surface
//! `H = b + d` and the depth over the sill `d_f = min(d_up, d_down + |ΔH|) ≥ 0.1 mm`:
//!
//! `q* = q + Δt·g·d_f·ΔH/l`, then `q* = q + a·|q|q` with `a = Δt·g·n²/d_f^(7/3)` solved for `q`: Manning's friction, all
//! implicit, so that thin films don't swing; on steep ground it is rougher, so that water is at most 1.5 times as fast as
//! its waves. A cell's outflow is cut to what it has, by one factor for all its faces; then
//! `d += Δt/l·Σq`. Waves run at `√(g·d)`; steps are 0.9 of `l/(√2·√(g·d_max))` and no water crosses more than a cell.
//! `flux = "mei"` keeps two one-sided fluxes a face and takes steps of `0.9·l/2c`. `momentum` adds what `momentum.rs` says.
//!
//! **Sediment.** `s`, in metres of rock a cell, rides on the water's fluxes from upwind: what leaves one cell comes to the
//! next, to the last bit of the product. Then, with `Δt`-shares at most 1, water takes up or drops
//! `K·(C·d − s)`, `C = K_c·sin α·|v|·S(d/d_film)·(1 − S((d − d_1)/(d_2 − d_1)))`, `S` a smooth step, `C` at most 0.4. `K` is
//! `dissolve_per_s` times softness where it takes, `settle_per_s` where it drops. In a step a bed sinks at most a quarter
//! of the way to its lowest neighbour, rises at most a quarter of the way to a little above their mean, and moves at most
//! 2 % of a cell and 5 % of its water's depth.
//!
//! **The bed's time.** Beds change much more slowly than water runs. `morphological_factor` `M` counts each hour of water
//! for `M` hours of bed: what the bed gives or gets is `M` times what the water gets or gives, and slippage has `M·Δt`. So
//! `Σ b + M·Σ s` is kept, and rock that is on its way, or leaves, is counted `M` times. It is sound while a bed changes
//! little in the time that water takes to run by: with a capacity of a few per cent, up to about 100.
//!
//! A delta that grows `M` times too fast would push the water of its pond away `M` times too fast, and a bed that sank or
//! rose by more than its water is deep would send waves down the river. So where water stands (slower than 0.3 of its waves,
//! deeper than some decimetres) its surface stays while its bed rises: `1 − 1/M` of the rise comes off the depth and leaves
//! the map, as it would in the hours that are not run. Running water keeps its depth: rock on its way is several times the
//! volume of the water, times `M`, and would drink up rivers or make them from nothing. Nothing is given where a bed sinks.
//!
//! **Slippage.** Fluxes to eight neighbours above the talus angle, which is lower where the ground is wet.
//!
//! **Rims and sea.** Over an open rim water goes as down an endless slope of the fall that it comes with, by Manning, at most
//! at its waves' speed; it and its sediment are counted. The bed of a rim is never dug below its neighbours. In the sea the
//! level is fixed, what flows in has left, and its sediment falls down to the sea's level.
//!
//! **Single precision.** Falls of the surface are summed from differences of starts and of changes. What a bed's `change`
//! cannot hold stays in `rest` until it can, so that the books of rock close to 1e-6 of what was moved.
//!
//! A step reads two cells away (fluxes are cut by what neighbours have), with momentum three. Made for cells of 1 to 100 m;
//! on larger ones gullies are narrower than a cell and depths mean little. With four faces a
//! cell, gullies in even slopes still like to run along the axes; `|v|²` is half the sum of the squares over the faces of a
//! cell, so that a stream that turns is as strong as a straight one.

// Loops over several rows at once read better, and vectorise surer, by index.
#![allow(clippy::needless_range_loop)]

mod advect;
mod bench;
mod faces;
mod family;
mod flow;
mod line;
mod momentum;
mod params;
mod process;
mod rows;
mod rules;
mod sea;
mod sediment;
mod slip;
mod sums;
mod sweep;
mod view;

#[cfg(test)]
mod tests;

pub use family::Pipes;
pub use params::{Flux, PipesParams, Sediment, Spring};
