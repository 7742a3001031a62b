//! What the lava of a sheet is like: how it flows and what heat it holds at an enthalpy, worked out of the parameters once.

use super::params::LavaSheetParams;
use crate::volcano::heat::{GRAVITY, Melt, grown, radiated_per_k};

/// The lava's laws.
#[derive(Clone, Debug)]
pub(super) struct Law {
    params: LavaSheetParams,
    /// Weight of a cubic metre, N/m³.
    pub(super) weight: f64,
    pub(super) melt: Melt,
    /// Enthalpies over 0 °C of what comes out, and at the solidus, J/kg.
    pub(super) fresh: f64,
    pub(super) rock: f64,
    pub(super) density: f64,
    pub(super) most_speed: f64,
}

/// How lava of an enthalpy flows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Flow {
    /// One over the viscosity, 1/(Pa·s).
    pub(super) fluidity: f64,
    /// Stress below which it rests, Pa.
    pub(super) stress: f64,
}

impl Law {
    pub(super) fn new(params: &LavaSheetParams) -> Self {
        let melt = Melt {
            specific_j_per_kg_k: params.specific_heat_j_per_kg_k,
            latent_j_per_kg: params.latent_heat_j_per_kg,
            solidus_degc: params.solidus_degc,
            liquidus_degc: params.liquidus_degc,
        };
        Self {
            params: params.clone(),
            weight: GRAVITY * params.density_kg_per_m3,
            melt,
            fresh: melt.enthalpy(params.temperature_degc),
            rock: melt.rock(),
            density: params.density_kg_per_m3,
            most_speed: params.most_speed_m_per_s,
        }
    }

    /// How lava of an enthalpy flows.
    pub(super) fn flow(&self, enthalpy: f64) -> Flow {
        let p = &self.params;
        let cooler_k = p.temperature_degc - self.melt.degc(enthalpy);
        let viscosity = p.viscosity_pa_s * grown(p.viscosity_per_k, cooler_k);
        let gains = grown(p.yield_per_k, cooler_k.max(0.0)) - 1.0;
        Flow {
            fluidity: 1.0 / viscosity.min(p.most_viscosity_pa_s.max(p.viscosity_pa_s)),
            stress: p.yield_pa + p.yield_growth_pa * gains,
        }
    }

    /// What a square metre loses upwards at a temperature, W/m², and how much more a kelvin hotter; `wet` is the share of
    /// the lava's depth that stands in the sea.
    pub(super) fn upwards(&self, degc: f64, wet: f64) -> (f64, f64) {
        let p = &self.params;
        let [per_k, more] = radiated_per_k(p.emissivity, degc, p.ambient_degc);
        let dry = p.crust_factor * (1.0 - wet);
        let taken = dry * p.air_w_per_m2_k + wet * p.sea_w_per_m2_k;
        ((dry * per_k + taken) * (degc - p.ambient_degc), dry * more + taken)
    }

    /// What a square metre loses to the ground at a temperature, W/m².
    pub(super) fn downwards(&self, degc: f64) -> f64 {
        (self.params.ground_w_per_m2_k * (degc - self.params.ambient_degc)).max(0.0)
    }
}

impl LavaSheetParams {
    /// What does not go together, in one line with what helps.
    pub(super) fn check(&self) -> Result<(), String> {
        let melt = Law::new(self).melt;
        melt.check()?;
        melt.check_fresh(self.temperature_degc, "")?;
        if self.ambient_degc >= self.solidus_degc {
            return Err(format!(
                "where it is ambient_degc = {} lava never freezes; lower it below solidus_degc = {}",
                self.ambient_degc, self.solidus_degc
            ));
        }
        Ok(())
    }
}
