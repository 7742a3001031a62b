//! How lava cools: from particle to particle, to the ground, to the air and the sky, and in the sea.
//!
//! Heat is kept as enthalpy in `f64`. What conduction takes from one particle it gives to another, to the last bit of the
//! product. What leaves is `c·(T − T_a)·(1 − e^(−H·dt/(m·c)))` with `H` in W/K: exact for Newton's law, never beyond the
//! surroundings' temperature for any step, and slower than it while latent heat is set free.

use super::{choices::Cooling, law::Law};
use crate::{
    sph::{Around, Kernel},
    volcano::heat::radiated_per_k,
};

/// Share of a surface, in smoothing lengths, that disorder alone makes inside lava.
const DISORDER: f32 = 0.15;
/// Density below which a particle has hardly a neighbour, and down to that of one alone.
const LONELY: f32 = 0.6;
/// Most that a share of a particle's conduction may be in a step.
pub(super) const CONDUCTION: f64 = 0.1;

/// Heat that has left, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lost {
    /// To the ground.
    pub ground: f64,
    /// To the air.
    pub air: f64,
    /// To the sky.
    pub sky: f64,
    /// To the sea.
    pub sea: f64,
}

/// Where a particle stands when it cools.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) around: Around,
    /// Relative density.
    pub(super) density: f32,
    /// Height over the ground, m.
    pub(super) gap: f32,
    pub(super) normal: [f32; 3],
    pub(super) submerged: bool,
}

/// Surfaces of a particle, m².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Surfaces {
    pub(super) free: f64,
    pub(super) ground: f64,
}

impl Law {
    /// What of a particle's surface is free and what lies on the ground: the outermost layer of a lattice has just the area of
    /// what it covers, whatever lies beneath.
    pub(super) fn surfaces<K: Kernel>(&self, place: &Place) -> Surfaces {
        let h = self.scale.h_m;
        let below = K::beyond_slope(place.gap / h) / h;
        let [x, y, z] = [0, 1, 2].map(|axis| place.around.inward[axis] - below * place.normal[axis]);
        let bare = (x * x + y * y + z * z).sqrt();
        let slices = |spacings: f32| K::beyond_slope(spacings * self.scale.spacing_m / h);
        let (first, second) = (slices(0.5), slices(1.5));
        let area =
            |share: f32, none: f32| f64::from(((share - none) / (first - none)).max(0.0)) * self.spacing * self.spacing;
        let alone = self.scale.volume_m3 / (h * h * h) * K::shape(0.0);
        let lonely = ((LONELY - place.density) / (LONELY - alone)).clamp(0.0, 1.0);
        let ball = std::f64::consts::PI * self.spacing * self.spacing;
        Surfaces {
            free: area(bare * h, DISORDER).max(ball * f64::from(lonely)).min(2.0 * ball),
            ground: area(below * h, second).min(ball),
        }
    }

    /// What conduction changes of a particle's enthalpy in a second, J/kg/s, for the Laplacian of temperature.
    pub(super) fn conducted(&self, laplacian: f64) -> f64 {
        let p = &self.params;
        let diffusion = match p.cooling {
            Cooling::Physical => p.conductivity_w_per_m_k / p.density_kg_per_m3,
            Cooling::Document => p.document_k_int * p.specific_heat_j_per_kg_k,
        };
        p.cooling_factor * diffusion * laplacian
    }

    /// The longest step of conduction, s.
    pub(super) fn conduction_limit_s(&self) -> f64 {
        let h = self.scale.h_m as f64;
        let rate = self.conducted(1.0) / self.params.specific_heat_j_per_kg_k;
        if self.params.conduct && rate > 0.0 { CONDUCTION * h * h / rate } else { f64::INFINITY }
    }

    /// A particle's enthalpy after it has lost what its surroundings take in a time, J/kg.
    pub(super) fn cooled<K: Kernel>(&self, enthalpy: f64, place: &Place, dt: f64, lost: &mut Lost) -> f64 {
        match self.params.cooling {
            Cooling::Physical => {
                let surfaces = self.surfaces::<K>(place);
                self.cooled_by(enthalpy, surfaces, place.submerged, dt, lost)
            }
            Cooling::Document => self.cooled_as_documented(enthalpy, place, dt, lost),
        }
    }

    /// The same for surfaces that are known.
    pub(super) fn cooled_by(&self, enthalpy: f64, at: Surfaces, submerged: bool, dt: f64, lost: &mut Lost) -> f64 {
        let p = &self.params;
        let mut left = enthalpy;
        if p.lose_to_ground && at.ground > 0.0 {
            lost.ground += self.take(&mut left, p.ground_w_per_m2_k * at.ground, dt);
        }
        if submerged && p.lose_to_air {
            lost.sea += self.take(&mut left, p.sea_w_per_m2_k * at.free, dt);
        } else if at.free > 0.0 {
            let bare = at.free * p.crust_factor;
            if p.lose_to_air {
                lost.air += self.take(&mut left, p.air_w_per_m2_k * bare, dt);
            }
            if p.radiate {
                let [per_k, _] = radiated_per_k(p.emissivity, self.degc(left), p.ambient_degc);
                lost.sky += self.take(&mut left, per_k * bare, dt);
            }
        }
        left
    }

    /// Takes what surroundings that conduct so many W/K take in a time; gives it, J.
    fn take(&self, enthalpy: &mut f64, watt_per_k: f64, dt: f64) -> f64 {
        let (c, mass) = (self.params.specific_heat_j_per_kg_k, self.mass_kg());
        let over = self.degc(*enthalpy) - self.params.ambient_degc;
        let gone = c * over * -libm::expm1(-self.params.cooling_factor * watt_per_k * dt / (mass * c));
        *enthalpy -= gone;
        gone * mass
    }

    /// `dT/dt = −k·(T − T_ext)·r²/ρ` where it touches the ground, and again where nobody is above it.
    fn cooled_as_documented(&self, enthalpy: f64, place: &Place, dt: f64, lost: &mut Lost) -> f64 {
        let p = &self.params;
        let radius = self.spacing / super::law::SPACING_PER_RADIUS;
        let per_k = radius * radius / (p.density_kg_per_m3 * f64::from(place.density)) * self.mass_kg();
        let c = p.specific_heat_j_per_kg_k;
        let mut left = enthalpy;
        if p.lose_to_ground && f64::from(place.gap) < 1.05 * radius.max(0.5 * self.spacing) {
            lost.ground += self.take(&mut left, p.document_k_ground * c * per_k, dt);
        }
        if p.lose_to_air && !place.around.covered {
            lost.air += self.take(&mut left, p.document_k_air * c * per_k, dt);
        }
        left
    }
}
