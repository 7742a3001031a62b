//! The words that a recipe may choose between.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How particles are smoothed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Smoothing {
    /// Wendland's C2 function.
    #[default]
    Wendland,
    /// The cubic B-spline.
    Cubic,
    /// Desbrun's and Gascuel's spiky kernel, the document's.
    Desbrun,
}

/// What a particle weighs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mass {
    /// So much that a lattice of them has the rest density.
    #[default]
    Lattice,
    /// So much that one alone has it, as in the document: any neighbour is too many, and lava swells.
    Document,
}

/// How lava rubs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Viscosity {
    /// Equal and opposite in every pair, in Pa·s.
    #[default]
    Pairs,
    /// As in the document: `α(T) = b·exp(−a·T/T_init)`, neighbours' speeds weighed by the kernel.
    Document,
    /// Not at all.
    Off,
}

/// How viscosity is stepped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Solver {
    /// All at once where it is too stiff to be followed, else followed.
    #[default]
    Auto,
    /// Followed, in steps as short as that needs.
    Explicit,
    /// All at once, by conjugate gradients.
    Implicit,
}

/// How lava meets the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Contact {
    /// It sticks: the ground holds the lava on it by its viscosity.
    #[default]
    Stick,
    /// It slips, and friction holds it.
    Slip,
    /// As in the document: what is below the ground is put on it and stands still.
    Document,
    /// There is no ground.
    Off,
}

/// How heat leaves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Cooling {
    /// Through surfaces, in W/m², with latent heat.
    #[default]
    Physical,
    /// As in the document: `k·(T − T_ext)·r²/ρ`, and no latent heat.
    Document,
}
