//! What a sheet of lava can be told.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::volcano::{outlet::VentParams, schedule::SheetKey};

/// An eruption of kilometres: lava as a sheet on the raster that runs, cools and freezes into the ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct LavaSheetParams {
    /// How long lava is followed; what is molten then freezes where it lies.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "h", "x-effect" = "lava runs further before what is left freezes"))]
    pub duration_h: f64,
    /// When how much comes out; keys add up where they overlap.
    #[schemars(extend("x-effect" = "pulses and pauses: flows over and beside each other"))]
    pub schedule: Vec<SheetKey>,
    /// Where it comes out; without any the youngest of the table `vents`, or the summit.
    #[schemars(extend("x-effect" = "craters, and fissures with an end"))]
    pub vent: Vec<VentParams>,
    /// Density.
    #[schemars(range(min = 100.0, max = 20000.0), extend("x-unit" = "kg/m3", "x-effect" = "thinner, faster flows"))]
    pub density_kg_per_m3: f64,
    /// Viscosity at the temperature at which lava comes out.
    #[schemars(range(min = 1.0, max = 1e12), extend("x-unit" = "Pa s", "x-effect" = "slower, thicker, shorter flows"))]
    pub viscosity_pa_s: f64,
    /// By how much the logarithm of viscosity grows with a kelvin less.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1/K", "x-effect" = "cooler lava is stiffer"))]
    pub viscosity_per_k: f64,
    /// The most that viscosity grows to.
    #[schemars(range(min = 1.0, max = 1e15), extend("x-unit" = "Pa s", "x-effect" = "stiffer fronts"))]
    pub most_viscosity_pa_s: f64,
    /// Stress below which lava as it comes out does not flow (Bingham).
    #[schemars(range(min = 0.0, max = 1e7), extend("x-unit" = "Pa", "x-effect" = "thicker flows with steeper edges"))]
    pub yield_pa: f64,
    /// What is added to that stress as lava cools: so much, times an exponential less one.
    #[schemars(range(min = 0.0, max = 1e7), extend("x-unit" = "Pa", "x-effect" = "cooler lava stops sooner, levees grow"))]
    pub yield_growth_pa: f64,
    /// The exponential's rate.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1/K", "x-effect" = "cooler lava stops sooner, levees grow"))]
    pub yield_per_k: f64,
    /// Speed that no flow exceeds: faster ones are turbulent and held by it.
    #[schemars(range(min = 0.1, max = 100.0), extend("x-unit" = "m/s", "x-effect" = "faster flows, shorter steps"))]
    pub most_speed_m_per_s: f64,
    /// Temperature at which lava comes out.
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
    /// Share of a black body's radiation.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "cools faster"))]
    pub emissivity: f64,
    /// What a square metre of air takes.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "W/m2/K", "x-effect" = "cools faster"))]
    pub air_w_per_m2_k: f64,
    /// Share of what a bare surface would lose to air and sky: crust keeps the rest in.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "cools faster, shorter flows"))]
    pub crust_factor: f64,
    /// What a square metre of ground takes: so much freezes from below.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "W/m2/K", "x-effect" = "more is left along the way"))]
    pub ground_w_per_m2_k: f64,
    /// What a square metre of sea takes.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "W/m2/K", "x-effect" = "freezes in the sea sooner, and builds steeper deltas"))]
    pub sea_w_per_m2_k: f64,
    /// Temperature of air, ground and sea.
    #[schemars(range(min = -200.0, max = 3000.0), extend("x-unit" = "degC", "x-effect" = "cools slower"))]
    pub ambient_degc: f64,
    /// Speed with which smoke leaves the vents, for pictures; 0: none.
    #[schemars(range(min = 0.0, max = 200.0), extend("x-unit" = "m/s", "x-effect" = "smoke rises higher and spreads wider"))]
    pub smoke_m_per_s: f64,
    /// Where the wind comes from that blows it: 0 north, 90 east.
    #[schemars(range(min = -360.0, max = 360.0), extend("x-unit" = "deg", "x-effect" = "turns the smoke clockwise"))]
    pub wind_from_deg: f64,
    /// Speed of that wind a kilometre over the vents.
    #[schemars(range(min = 0.0, max = 150.0), extend("x-unit" = "m/s", "x-effect" = "smoke drifts further off"))]
    pub wind_m_per_s: f64,
    /// Hardness of frozen lava.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "later water carves it slower"))]
    pub hardness: f64,
}

impl Default for LavaSheetParams {
    fn default() -> Self {
        Self {
            duration_h: 48.0,
            schedule: vec![SheetKey { start_h: 0.0, duration_h: Some(24.0), m3_per_s: 50.0 }],
            vent: Vec::new(),
            density_kg_per_m3: 2600.0,
            viscosity_pa_s: 1000.0,
            viscosity_per_k: 0.04,
            most_viscosity_pa_s: 1e7,
            yield_pa: 100.0,
            yield_growth_pa: 1.0,
            yield_per_k: 0.06,
            most_speed_m_per_s: 15.0,
            temperature_degc: 1150.0,
            solidus_degc: 1000.0,
            liquidus_degc: 1200.0,
            specific_heat_j_per_kg_k: 1150.0,
            latent_heat_j_per_kg: 3.5e5,
            emissivity: 0.95,
            air_w_per_m2_k: 50.0,
            crust_factor: 0.1,
            ground_w_per_m2_k: 5.0,
            sea_w_per_m2_k: 5000.0,
            ambient_degc: 20.0,
            smoke_m_per_s: 10.0,
            wind_from_deg: 270.0,
            wind_m_per_s: 6.0,
            hardness: 0.6,
        }
    }
}
