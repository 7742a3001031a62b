//! What lava can be told.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::choices::{Contact, Cooling, Mass, Smoothing, Solver, Viscosity};
use crate::{
    sph::Scheme,
    volcano::{outlet::VentParams, schedule::Key},
};

/// An eruption: lava as smoothed particles that push each other, rub, run down, cool, and freeze into the ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct LavaParams {
    /// How long lava is followed.
    #[schemars(range(min = 0.0, max = 1e5), extend("x-unit" = "min", "x-effect" = "lava runs further before what is left freezes where it lies"))]
    pub duration_min: f64,
    /// When how much comes out; keys add up where they overlap.
    #[schemars(extend("x-effect" = "bursts and pauses"))]
    pub schedule: Vec<Key>,
    /// A JSON file with such a list, instead.
    #[schemars(extend("x-path" = true, "x-effect" = "the schedule of another program"))]
    pub schedule_file: Option<String>,
    /// Where it comes out; without any the youngest of the table `vents`, or the summit.
    #[schemars(extend("x-effect" = "craters, and fissures with an end"))]
    pub vent: Vec<VentParams>,
    /// Speed with which lava leaves a vent, upwards.
    #[schemars(range(min = 0.0, max = 100.0), extend("x-unit" = "m/s", "x-effect" = "a fountain"))]
    pub exit_speed_m_per_s: f64,
    /// Most particles that flow at a time; what does not find room waits.
    #[schemars(range(min = 1, max = 4e6), extend("x-unit" = "1", "x-effect" = "more lava at a time, slower"))]
    pub max_particles: u32,
    /// Distance of particles at rest: 1.61 times the document's radius r_p; 0: half a cell.
    #[schemars(range(min = 0.0, max = 1e5), extend("x-unit" = "m", "x-effect" = "coarser lava, much faster"))]
    pub spacing_m: f64,
    /// How particles are smoothed.
    #[schemars(extend("x-effect" = "wendland: keeps particles apart and is smooth; desbrun: the document's"))]
    pub kernel: Smoothing,
    /// Smoothing length over spacing; the document's is 0.84.
    #[schemars(range(min = 0.8, max = 2.0), extend("x-unit" = "1", "x-effect" = "smoother and slower"))]
    pub smoothing: f64,
    /// What a particle weighs.
    #[schemars(extend("x-effect" = "document: lava swells as the document's does"))]
    pub mass: Mass,
    /// How steps in time are made.
    #[schemars(extend("x-effect" = "symplectic_euler is stable and looks once; the others are for comparison"))]
    pub integrator: Scheme,
    /// The longest step in time; 0: as long as the limits of sound, gravity and viscosity let it be.
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "s", "x-effect" = "shorter steps where it is below the limit"))]
    pub time_step_s: f64,
    /// Takes `time_step_s` also where it is beyond the limit, as the document does.
    #[schemars(extend("x-effect" = "lava may fly apart, and the run then ends with an error"))]
    pub force_time_step: bool,

    /// Density at rest.
    #[schemars(range(min = 100.0, max = 20000.0), extend("x-unit" = "kg/m3", "x-effect" = "heavier lava"))]
    pub density_kg_per_m3: f64,
    /// Pressure between particles.
    #[schemars(extend("x-effect" = "off: lava piles up in one place"))]
    pub pressure: bool,
    /// Pressure over density beyond that at rest, the document's k: the square of the speed of sound; 0: as stiff as what
    /// happens needs, so that lava is pressed together by 1 %.
    #[schemars(range(min = 0.0, max = 1e8), extend("x-unit" = "m2/s2", "x-effect" = "less is compressed, shorter steps"))]
    pub stiffness_m2_per_s2: f64,
    /// Weight.
    #[schemars(extend("x-effect" = "off: lava floats"))]
    pub gravity: bool,
    /// How lava meets the ground.
    #[schemars(extend("x-effect" = "slip: sheets that slide; off: lava falls through"))]
    pub ground: Contact,
    /// Friction of lava that slips, along the ground over onto it.
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "1", "x-effect" = "slower slides"))]
    pub friction: f64,

    /// How lava rubs.
    #[schemars(extend("x-effect" = "off: runs like water"))]
    pub viscosity: Viscosity,
    /// How viscosity is stepped.
    #[schemars(extend("x-effect" = "implicit: long steps however stiff lava is"))]
    pub viscosity_solver: Solver,
    /// Viscosity at the temperature at which lava comes out.
    #[schemars(range(min = 0.0, max = 1e12), extend("x-unit" = "Pa s", "x-effect" = "slower and thicker flows"))]
    pub viscosity_pa_s: f64,
    /// By how much the logarithm of viscosity grows with a kelvin less.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1/K", "x-effect" = "cooler lava is stiffer"))]
    pub viscosity_per_k: f64,
    /// The most that viscosity grows to.
    #[schemars(range(min = 0.0, max = 1e12), extend("x-unit" = "Pa s", "x-effect" = "stiffer crusts"))]
    pub most_viscosity_pa_s: f64,
    /// The document's a, of its own viscosity.
    #[schemars(range(min = 0.0, max = 100.0), extend("x-unit" = "1", "x-effect" = "cooler lava is stiffer"))]
    pub document_a: f64,
    /// The document's b, of its own viscosity.
    #[schemars(range(min = 0.0, max = 1e30), extend("x-unit" = "kg/m3/s", "x-effect" = "slower and thicker flows"))]
    pub document_b: f64,
    /// Stress below which lava at its first temperature does not flow (Bingham); 0: it always does.
    #[schemars(range(min = 0.0, max = 1e7), extend("x-unit" = "Pa", "x-effect" = "flows that stop thick"))]
    pub yield_pa: f64,
    /// By how much the logarithm of that stress grows with a kelvin less.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1/K", "x-effect" = "cooler lava stops sooner"))]
    pub yield_per_k: f64,
    /// How sharply it stops (Papanastasiou's m).
    #[schemars(range(min = 0.0, max = 1e4), extend("x-unit" = "s", "x-effect" = "less creep below the yield stress, stiffer"))]
    pub yield_sharpness_s: f64,

    /// Temperature at which lava comes out, the document's T_init.
    #[schemars(range(min = -200.0, max = 3000.0), extend("x-unit" = "degC", "x-effect" = "it stays liquid for longer"))]
    pub temperature_degc: f64,
    /// Temperature below which it is rock.
    #[schemars(range(min = -200.0, max = 3000.0), extend("x-unit" = "degC", "x-effect" = "it freezes sooner"))]
    pub solidus_degc: f64,
    /// Temperature above which nothing in it is solid.
    #[schemars(range(min = -200.0, max = 3000.0), extend("x-unit" = "degC", "x-effect" = "latent heat is spread wider"))]
    pub liquidus_degc: f64,
    /// Heat of a kilogram for a kelvin.
    #[schemars(range(min = 1.0, max = 1e5), extend("x-unit" = "J/kg/K", "x-effect" = "cools slower"))]
    pub specific_heat_j_per_kg_k: f64,
    /// Heat that freezing sets free.
    #[schemars(range(min = 0.0, max = 1e7), extend("x-unit" = "J/kg", "x-effect" = "freezes slower"))]
    pub latent_heat_j_per_kg: f64,
    /// How heat leaves.
    #[schemars(extend("x-effect" = "document: larger particles cool faster"))]
    pub cooling: Cooling,
    /// How many times faster heat flows than lava does: a second of flow for so many seconds of cooling.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "1", "x-effect" = "flows freeze within the time they are followed for"))]
    pub cooling_factor: f64,
    /// Heat passes from particle to particle.
    #[schemars(extend("x-effect" = "off: only what touches ground or air cools"))]
    pub conduct: bool,
    /// Heat passes to the ground.
    #[schemars(extend("x-effect" = "off: the foot stays hot"))]
    pub lose_to_ground: bool,
    /// Heat passes to the air.
    #[schemars(extend("x-effect" = "off: the surface stays hot"))]
    pub lose_to_air: bool,
    /// Heat is radiated.
    #[schemars(extend("x-effect" = "off: the surface stays hot"))]
    pub radiate: bool,
    /// Conductivity of lava.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "W/m/K", "x-effect" = "its inside cools with its skin"))]
    pub conductivity_w_per_m_k: f64,
    /// What a square metre of ground takes for a kelvin of difference.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "W/m2/K", "x-effect" = "cools from below"))]
    pub ground_w_per_m2_k: f64,
    /// What a square metre of air takes.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "W/m2/K", "x-effect" = "cools from above"))]
    pub air_w_per_m2_k: f64,
    /// What a square metre of sea takes.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "W/m2/K", "x-effect" = "freezes in the sea sooner, and builds steeper deltas"))]
    pub sea_w_per_m2_k: f64,
    /// Share of a black body's radiation.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "cools from above"))]
    pub emissivity: f64,
    /// Share of what a bare surface would lose to air and sky: crust keeps the rest in.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "cools faster from above"))]
    pub crust_factor: f64,
    /// Temperature of air, ground and sea, the document's T_ext.
    #[schemars(range(min = -200.0, max = 3000.0), extend("x-unit" = "degC", "x-effect" = "cools slower"))]
    pub ambient_degc: f64,
    /// The document's k_int, of its own cooling.
    #[schemars(range(min = 0.0, max = 100.0), extend("x-unit" = "m2/s", "x-effect" = "its inside cools with its skin"))]
    pub document_k_int: f64,
    /// The document's k_ext of the ground, of its own cooling.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "kg/m5/s", "x-effect" = "cools from below"))]
    pub document_k_ground: f64,
    /// The document's k_ext of the air, of its own cooling.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "kg/m5/s", "x-effect" = "cools from above"))]
    pub document_k_air: f64,

    /// Speed with which smoke leaves the vents, for pictures; 0: none.
    #[schemars(range(min = 0.0, max = 200.0), extend("x-unit" = "m/s", "x-effect" = "smoke rises higher and spreads wider"))]
    pub smoke_m_per_s: f64,
    /// Where the wind comes from that blows it: 0 north, 90 east.
    #[schemars(range(min = -360.0, max = 360.0), extend("x-unit" = "deg", "x-effect" = "turns the smoke clockwise"))]
    pub wind_from_deg: f64,
    /// Speed of that wind 100 m over the vents.
    #[schemars(range(min = 0.0, max = 150.0), extend("x-unit" = "m/s", "x-effect" = "smoke drifts further off"))]
    pub wind_m_per_s: f64,

    /// What is rock becomes ground.
    #[schemars(extend("x-effect" = "off: lava stays particles until it is over"))]
    pub freeze: bool,
    /// What is left in the end becomes ground where it lies.
    #[schemars(extend("x-effect" = "off: it is gone, as if it had never flowed"))]
    pub settle: bool,
    /// Hardness of frozen lava.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "later water carves it slower"))]
    pub hardness: f64,
}

impl Default for LavaParams {
    fn default() -> Self {
        Self {
            duration_min: 3.0,
            schedule: vec![Key::volume(0.0, 60.0, 20.0)],
            schedule_file: None,
            vent: Vec::new(),
            exit_speed_m_per_s: 0.0,
            max_particles: 20_000,
            spacing_m: 0.0,
            kernel: Smoothing::Wendland,
            smoothing: 1.3,
            mass: Mass::Lattice,
            integrator: Scheme::SymplecticEuler,
            time_step_s: 0.0,
            force_time_step: false,
            density_kg_per_m3: 2600.0,
            pressure: true,
            stiffness_m2_per_s2: 0.0,
            gravity: true,
            ground: Contact::Stick,
            friction: 0.3,
            viscosity: Viscosity::Pairs,
            viscosity_solver: Solver::Auto,
            viscosity_pa_s: 300.0,
            viscosity_per_k: 0.04,
            most_viscosity_pa_s: 1e6,
            document_a: 1.5,
            document_b: 1e6,
            yield_pa: 0.0,
            yield_per_k: 0.02,
            yield_sharpness_s: 20.0,
            temperature_degc: 1150.0,
            solidus_degc: 1000.0,
            liquidus_degc: 1200.0,
            specific_heat_j_per_kg_k: 1150.0,
            latent_heat_j_per_kg: 3.5e5,
            cooling: Cooling::Physical,
            cooling_factor: 1.0,
            conduct: true,
            lose_to_ground: true,
            lose_to_air: true,
            radiate: true,
            conductivity_w_per_m_k: 2.0,
            ground_w_per_m2_k: 100.0,
            air_w_per_m2_k: 50.0,
            sea_w_per_m2_k: 5000.0,
            emissivity: 0.95,
            crust_factor: 0.2,
            ambient_degc: 20.0,
            document_k_int: 0.1,
            document_k_ground: 1000.0,
            document_k_air: 400.0,
            smoke_m_per_s: 8.0,
            wind_from_deg: 270.0,
            wind_m_per_s: 6.0,
            freeze: true,
            settle: true,
            hardness: 0.6,
        }
    }
}
