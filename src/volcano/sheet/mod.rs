//! Lava as a sheet on the raster: a film of a Bingham liquid that runs down the slope of its own surface, cools, and freezes
//! into the ground. For flows of kilometres, which particles are too many for.
//!
//! Equations, integrated over depth `h` (molten) above the bed `b`, with `s = b + h` and `S = −∇s`:
//!
//! ```text
//! ∂h/∂t = −∇·q + source − freezing,  q = ρ g h³/(3μ) · (1 − 3/2 u + 1/2 u³) · S,  u = τ/(ρ g h |S|), 0 where u ≥ 1
//! ∂(h e)/∂t = −∇·(q e) + source·e₀ − losses/ρ,  T = T(e) with latent heat between solidus and liquidus
//! ```
//!
//! Scheme: finite volumes, one flux a face, depth and temperature from upwind. The slope of a surface decides over the whole
//! direction, not along the raster's axes, so that what stops, stops round. A step in time is as long as no cell loses more
//! than a third of its lava; that is what fronts need. Deep lava spreads far faster than that, `l²·3μ/(4ρ g h³)`: a crater
//! lake of 50 m would need steps of a millisecond. Where it does, the surface is solved for at the step's end, by one Newton
//! step on the fluxes (symmetric, positive: conjugate gradients); lava then moves by the fluxes over the faces, so none is
//! lost however well that was solved, and no cell gives more than it has. Freezing: what the ground takes freezes from
//! below, what air and sea take cools the whole depth, which freezes at the solidus.
//!
//! Boundaries: an open rim lets go what runs over it, a closed one holds, a wrapped one passes on.
//! Sources: the flux of a Bingham liquid on a slope after Hulme, Geophys. J. R. Astron. Soc. 39 (1974), 361–383; viscous
//! spreading after Huppert, J. Fluid Mech. 121 (1982), 43–58; viscosity's law after Dragoni, Bull. Volcanol. 51 (1989).

mod cells;
mod cool;
mod emission;
mod faces;
mod film;
mod law;
mod params;
mod rows;
mod smoke;
mod solve;
mod stage;
#[cfg(test)]
mod tests;

pub use film::Film;
pub use params::LavaSheetParams;
