//! What the lava of a sheet is like: how it flows and what heat it holds at an enthalpy, worked out of the parameters once.

use super::params::LavaSheetParams;

/// Standard gravity, m/s².
const GRAVITY: f64 = 9.80665;
/// Stefan and Boltzmann's constant, W/m²/K⁴.
const STEFAN: f64 = 5.670_374_419e-8;
/// 0 °C, K.
const ICE_K: f64 = 273.15;
/// Exponents that no law goes beyond.
const MOST_EXPONENT: f64 = 60.0;

/// The lava's laws.
#[derive(Clone, Debug)]
pub(super) struct Law {
    params: LavaSheetParams,
    /// Weight of a cubic metre, N/m³.
    pub(super) weight: f64,
    /// Enthalpies over 0 °C of what comes out, and at the solidus and the liquidus, J/kg.
    pub(super) fresh: f64,
    pub(super) rock: f64,
    melt: f64,
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
        let c = params.specific_heat_j_per_kg_k;
        let law = Self {
            params: params.clone(),
            weight: GRAVITY * params.density_kg_per_m3,
            fresh: 0.0,
            rock: c * params.solidus_degc,
            melt: c * params.liquidus_degc + params.latent_heat_j_per_kg,
            density: params.density_kg_per_m3,
            most_speed: params.most_speed_m_per_s,
        };
        Self { fresh: law.enthalpy(params.temperature_degc), ..law }
    }

    /// Enthalpy at a temperature, J/kg over 0 °C.
    pub(super) fn enthalpy(&self, degc: f64) -> f64 {
        let p = &self.params;
        let molten = (degc - p.solidus_degc) / (p.liquidus_degc - p.solidus_degc);
        p.specific_heat_j_per_kg_k * degc + p.latent_heat_j_per_kg * molten.clamp(0.0, 1.0)
    }

    /// Temperature of an enthalpy, °C, and the heat of a kilogram for a kelvin there.
    pub(super) fn degc(&self, enthalpy: f64) -> (f64, f64) {
        let (p, c) = (&self.params, self.params.specific_heat_j_per_kg_k);
        if enthalpy < self.rock {
            return (enthalpy / c, c);
        }
        if enthalpy > self.melt {
            return ((enthalpy - p.latent_heat_j_per_kg) / c, c);
        }
        let span_k = p.liquidus_degc - p.solidus_degc;
        let mush = (self.melt - self.rock) / span_k;
        (p.solidus_degc + (enthalpy - self.rock) / mush, mush)
    }

    /// How lava of an enthalpy flows.
    pub(super) fn flow(&self, enthalpy: f64) -> Flow {
        let p = &self.params;
        let cooler_k = p.temperature_degc - self.degc(enthalpy).0;
        let grown = p.viscosity_pa_s * libm::exp((p.viscosity_per_k * cooler_k).min(MOST_EXPONENT));
        let gains = libm::exp((p.yield_per_k * cooler_k.max(0.0)).min(MOST_EXPONENT)) - 1.0;
        Flow {
            fluidity: 1.0 / grown.min(p.most_viscosity_pa_s.max(p.viscosity_pa_s)),
            stress: p.yield_pa + p.yield_growth_pa * gains,
        }
    }

    /// What a square metre loses upwards at a temperature, W/m², and how much more a kelvin hotter; `wet` is the share of
    /// the lava's depth that stands in the sea.
    pub(super) fn upwards(&self, degc: f64, wet: f64) -> (f64, f64) {
        let p = &self.params;
        let [hot, cold] = [degc, p.ambient_degc].map(|degc| degc + ICE_K);
        let radiance = p.emissivity * STEFAN;
        let dry = p.crust_factor * (1.0 - wet);
        let taken = dry * p.air_w_per_m2_k + wet * p.sea_w_per_m2_k;
        let loss = dry * radiance * (hot * hot * hot * hot - cold * cold * cold * cold) + taken * (hot - cold);
        (loss, 4.0 * dry * radiance * hot * hot * hot + taken)
    }

    /// What a square metre loses to the ground at a temperature, W/m².
    pub(super) fn downwards(&self, degc: f64) -> f64 {
        (self.params.ground_w_per_m2_k * (degc - self.params.ambient_degc)).max(0.0)
    }
}

impl LavaSheetParams {
    /// What does not go together, in one line with what helps.
    pub(super) fn check(&self) -> Result<(), String> {
        if self.liquidus_degc < self.solidus_degc + 1.0 {
            return Err("liquidus_degc must be at least a kelvin above solidus_degc".to_owned());
        }
        if self.temperature_degc <= self.solidus_degc {
            return Err(format!(
                "lava of temperature_degc = {} is rock before it comes out; raise it above solidus_degc = {}",
                self.temperature_degc, self.solidus_degc
            ));
        }
        if self.ambient_degc >= self.solidus_degc {
            return Err(format!(
                "where it is ambient_degc = {} lava never freezes; lower it below solidus_degc = {}",
                self.ambient_degc, self.solidus_degc
            ));
        }
        Ok(())
    }
}
