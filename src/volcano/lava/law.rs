//! What lava is like: sizes, heat, viscosity and its limits in time, worked out of the parameters once.

use super::{
    choices::{Cooling, Mass, Smoothing, Solver, Viscosity},
    params::LavaParams,
};
use crate::{
    grid::Grid,
    sph::{CubicSpline, DesbrunGascuel, Kernel, Scale, Touch, WendlandC2},
    volcano::heat::{GRAVITY, Melt, grown},
};

/// Density of the sea, kg/m³.
pub(super) const SEA: f64 = 1025.0;
/// Spacing over the document's radius: a ball of that radius has the volume of a cube of that side.
pub(super) const SPACING_PER_RADIUS: f64 = 1.611_992;
/// Smoothing length over the document's radius, `(5/2)^(1/3)`: a particle alone has the rest density.
const DOCUMENT_H_PER_RADIUS: f64 = 1.357_209;
/// How much faster sound is than anything else: a column as high as a fall to that speed is pressed together by 1 %.
pub(super) const SOUND: f64 = 7.0;
/// Most of a smoothing length that sound and flow may cross in a step.
const COURANT: f64 = 0.4;
/// Share of `h·c` that lava has as viscosity at least, to wear off the ringing of a weakly compressible liquid.
const NUMERIC: f64 = 0.01;
/// Speed that no particle exceeds, m/s: three times the fastest flows that were seen.
const FASTEST: f64 = 60.0;
/// Most steps in time that a run may need.
const MOST_STEPS: f64 = 2e7;
/// Most that a share of a particle's diffusion time may be in a step.
const DIFFUSION: f64 = 0.125;
/// Lava that is solved for all at once takes this many times as long a step.
const IMPLICIT_COSTS: f64 = 6.0;

/// Lava of given particles.
#[derive(Clone, Debug)]
pub(super) struct Law {
    pub(super) params: LavaParams,
    /// Distance of particles at rest, m.
    pub(super) spacing: f64,
    pub(super) scale: Scale,
    melt: Melt,
}

/// Time steps, and how viscosity is taken in them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pace {
    pub(super) dt: f64,
    pub(super) implicit: bool,
}

impl Law {
    pub(super) fn new(params: &LavaParams, grid: &Grid) -> Self {
        let spacing = if params.spacing_m > 0.0 { params.spacing_m } else { 0.5 * grid.cell_m };
        let scale = match params.kernel {
            Smoothing::Wendland => scale::<WendlandC2>(params, spacing),
            Smoothing::Cubic => scale::<CubicSpline>(params, spacing),
            Smoothing::Desbrun => scale::<DesbrunGascuel>(params, spacing),
        };
        let melt = Melt {
            specific_j_per_kg_k: params.specific_heat_j_per_kg_k,
            latent_j_per_kg: if params.cooling == Cooling::Physical { params.latent_heat_j_per_kg } else { 0.0 },
            solidus_degc: params.solidus_degc,
            liquidus_degc: params.liquidus_degc,
        };
        Self { params: params.clone(), spacing, scale, melt }
    }

    /// What keeps these parameters from running, and what to change.
    pub(super) fn check(&self, grid: &Grid) -> Result<(), String> {
        let p = &self.params;
        let cells = self.spacing / grid.cell_m;
        if !(0.05..=4.0).contains(&cells) {
            return Err(format!(
                "particles {:.3} m apart do not suit cells of {:.3} m; set spacing_m from {:.3} to {:.3}, or to 0",
                self.spacing,
                grid.cell_m,
                0.05 * grid.cell_m,
                4.0 * grid.cell_m
            ));
        }
        self.melt.check()?;
        if p.freeze {
            self.melt.check_fresh(p.temperature_degc, ", or set freeze = false")?;
        }
        if p.force_time_step && p.time_step_s <= 0.0 {
            return Err("force_time_step needs a time_step_s".into());
        }
        let steps = 60.0 * p.duration_min / self.least_step_s();
        if steps > MOST_STEPS {
            return Err(format!(
                "lava may need {steps:.1e} steps in time, {MOST_STEPS:.0e} at most; lower duration_min, stiffness_m2_per_s2 \
                 or exit_speed_m_per_s, raise spacing_m or time_step_s, or set viscosity_solver = \"auto\""
            ));
        }
        Ok(())
    }

    /// Volume of a particle, m³.
    pub(super) fn volume_m3(&self) -> f64 {
        self.spacing * self.spacing * self.spacing
    }

    /// Mass of a particle, kg.
    pub(super) fn mass_kg(&self) -> f64 {
        self.params.density_kg_per_m3 * self.volume_m3()
    }

    /// A speed that no particle exceeds, m/s.
    pub(super) fn most_speed(&self) -> f64 {
        FASTEST.max(2.0 * self.params.exit_speed_m_per_s).max((20.0 * GRAVITY * self.spacing).sqrt())
    }

    /// Speed of sound for what goes as fast as this or has come down from so high, m/s.
    pub(super) fn sound(&self, speed: f64, height: f64) -> f64 {
        if self.params.stiffness_m2_per_s2 > 0.0 {
            return self.params.stiffness_m2_per_s2.sqrt();
        }
        let fall = if self.params.gravity { (2.0 * GRAVITY * height.max(self.spacing)).sqrt() } else { 0.0 };
        SOUND * speed.max(fall).clamp((0.1 * self.spacing).min(1.0), self.most_speed())
    }

    /// The longest step for sound, flow and weight, s.
    fn limit_s(&self, speed: f64, sound: f64) -> f64 {
        let h = self.scale.h_m as f64;
        let weight = if self.params.gravity { 0.25 * (h / GRAVITY).sqrt() } else { f64::INFINITY };
        (COURANT * h / (speed + sound)).min(weight)
    }

    /// The longest step for a viscosity, s.
    fn creep_s(&self, viscosity_m2_per_s: f64) -> f64 {
        let h = self.scale.h_m as f64;
        if viscosity_m2_per_s > 0.0 { DIFFUSION * h * h / viscosity_m2_per_s } else { f64::INFINITY }
    }

    /// The step at a speed, a speed of sound and a greatest viscosity.
    pub(super) fn pace(&self, speed: f64, sound: f64, viscosity_m2_per_s: f64) -> Pace {
        let (flow, creep) = (self.limit_s(speed, sound), self.creep_s(viscosity_m2_per_s));
        let implicit = match (self.params.viscosity, self.params.viscosity_solver) {
            (Viscosity::Pairs, Solver::Implicit) => true,
            (Viscosity::Pairs, Solver::Auto) => creep * IMPLICIT_COSTS < flow,
            _ => false,
        };
        let limit = if implicit { flow } else { flow.min(creep) };
        let dt = match self.params.time_step_s {
            own if own > 0.0 && self.params.force_time_step => own,
            own if own > 0.0 => own.min(limit),
            _ => limit,
        };
        Pace { dt, implicit }
    }

    /// A line for a step that the recipe asks for and cannot have: even lava at rest, one particle deep and as hot as it
    /// comes out, needs a shorter one.
    pub(super) fn shortened(&self) -> Option<String> {
        let asked = self.params.time_step_s;
        let sound = self.sound(0.0, 0.0);
        let stiff = match self.params.viscosity {
            Viscosity::Off => 0.0,
            Viscosity::Document => self.document_viscosity(self.params.temperature_degc),
            Viscosity::Pairs => self.viscosity(self.params.temperature_degc, sound),
        };
        let most = self.pace(0.0, sound, stiff).dt;
        (most < asked).then(|| {
            format!(
                "time_step_s = {asked} is shortened to at most {most:.4} s, and further where lava is faster or stiffer; \
                 lower it, or set force_time_step = true"
            )
        })
    }

    /// What sound alone allows, whatever the recipe asks for, s.
    pub(super) fn free_pace(&self, sound: f64) -> f64 {
        self.limit_s(0.0, sound)
    }

    /// How a particle meets the ground: it does not bounce, and what holds it along the ground is no friction of this kind.
    pub(super) fn touch(&self) -> Touch {
        Touch {
            radius: (0.5 * self.spacing) as f32,
            restitution: 0.0,
            calm: (0.2 * (GRAVITY * self.spacing).sqrt()) as f32,
            friction_per_m: 0.0,
            layer: 0.0,
        }
    }

    /// The shortest that a step can get, s.
    pub(super) fn least_step_s(&self) -> f64 {
        let (most, p) = (self.most_speed(), &self.params);
        let sound = if p.stiffness_m2_per_s2 > 0.0 { p.stiffness_m2_per_s2.sqrt() } else { SOUND * most };
        let stiff = match p.viscosity {
            Viscosity::Off => 0.0,
            Viscosity::Document => self.document_viscosity(-273.15),
            Viscosity::Pairs => {
                let plastic = if p.yield_pa > 0.0 { self.most_yield_pa() * p.yield_sharpness_s } else { 0.0 };
                self.least_viscosity(sound).max((p.most_viscosity_pa_s + plastic) / p.density_kg_per_m3)
            }
        };
        self.pace(most, sound, stiff).dt
    }

    /// Enthalpy at a temperature, J/kg over 0 °C.
    pub(super) fn enthalpy(&self, degc: f64) -> f64 {
        self.melt.enthalpy(degc)
    }

    /// Temperature of an enthalpy, °C.
    pub(super) fn degc(&self, enthalpy: f64) -> f64 {
        self.melt.degc(enthalpy)
    }

    /// Kinematic viscosity at a temperature, m²/s.
    pub(super) fn viscosity(&self, degc: f64, sound: f64) -> f64 {
        let p = &self.params;
        let grown = p.viscosity_pa_s * grown(p.viscosity_per_k, p.temperature_degc - degc);
        (grown.min(p.most_viscosity_pa_s) / p.density_kg_per_m3).max(self.least_viscosity(sound))
    }

    fn least_viscosity(&self, sound: f64) -> f64 {
        NUMERIC * self.scale.h_m as f64 * sound
    }

    /// Stress below which lava does not flow, over its density, m²/s².
    pub(super) fn yield_m2_per_s2(&self, degc: f64) -> f64 {
        let p = &self.params;
        let cooler = (p.temperature_degc - degc).clamp(0.0, (p.temperature_degc - p.solidus_degc).max(0.0));
        p.yield_pa * grown(p.yield_per_k, cooler) / p.density_kg_per_m3
    }

    fn most_yield_pa(&self) -> f64 {
        self.yield_m2_per_s2(self.params.solidus_degc) * self.params.density_kg_per_m3
    }

    /// The document's α over the rest density, 1/s.
    pub(super) fn document_alpha(&self, degc: f64) -> f64 {
        let p = &self.params;
        let share = (degc + 273.15).max(0.0) / (p.temperature_degc + 273.15).max(1.0);
        p.document_b * libm::exp(-p.document_a * share) / p.density_kg_per_m3
    }

    /// What kinematic viscosity that α comes to, m²/s: its kernel spreads momentum by `h²/7`.
    pub(super) fn document_viscosity(&self, degc: f64) -> f64 {
        let h = self.scale.h_m as f64;
        self.document_alpha(degc) * h * h / 7.0
    }
}

fn scale<K: Kernel>(params: &LavaParams, spacing: f64) -> Scale {
    match params.mass {
        Mass::Lattice => Scale::new::<K>(spacing, params.smoothing),
        Mass::Document => {
            let h_m = (spacing / SPACING_PER_RADIUS * DOCUMENT_H_PER_RADIUS) as f32;
            Scale { spacing_m: spacing as f32, h_m, volume_m3: h_m * h_m * h_m / K::shape(0.0) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Edges;

    fn law(params: LavaParams) -> Law {
        Law::new(&params, &Grid::new(64, 64, 64.0, Edges::Open))
    }

    #[test]
    fn the_documents_sizes_are_those_of_its_code() {
        let own = LavaParams {
            spacing_m: 0.3 * SPACING_PER_RADIUS,
            kernel: Smoothing::Desbrun,
            mass: Mass::Document,
            ..LavaParams::default()
        };
        let law = law(own);
        let ball = 4.0 / 3.0 * std::f64::consts::PI * 0.027;
        assert!((law.volume_m3() / ball - 1.0).abs() < 1e-5);
        assert!((law.scale.volume_m3 as f64 / ball - 1.0).abs() < 1e-5);
        assert!((law.scale.h_m - 0.407).abs() < 1e-3);
        // 2.23e5 and 4.11e5 kg/m³/s at 1200 and 600 °C.
        let hot = Law { params: LavaParams { temperature_degc: 1200.0, ..law.params.clone() }, ..law };
        let alpha = |degc: f64| hot.document_alpha(degc) * hot.params.density_kg_per_m3;
        assert!((alpha(1200.0) / 2.23e5 - 1.0).abs() < 5e-3 && (alpha(600.0) / 4.11e5 - 1.0).abs() < 5e-3);
    }

    #[test]
    fn the_documents_step_is_within_its_limit_and_its_failure_is_not() {
        let own = LavaParams { stiffness_m2_per_s2: 200.0, viscosity: Viscosity::Off, ..LavaParams::default() };
        let law = law(LavaParams { spacing_m: 0.4836, mass: Mass::Document, kernel: Smoothing::Desbrun, ..own });
        let limit = law.pace(0.0, 200f64.sqrt(), 0.0).dt;
        assert!(limit > 0.01 && limit < 0.03, "{limit}");
    }
}
