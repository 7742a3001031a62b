//! What lava is to heat, as particles and as a sheet: how hot an enthalpy is, what a surface radiates, how stiff it gets.

/// Standard gravity, m/s².
pub(super) const GRAVITY: f64 = 9.80665;
/// Stefan's and Boltzmann's constant, W/m²/K⁴.
const STEFAN: f64 = 5.670_374_419e-8;
/// 0 °C, K.
const ICE_K: f64 = 273.15;
/// Exponents that no law goes beyond.
const MOST_EXPONENT: f64 = 50.0;

/// Heat of a kilogram: specific heat, and latent heat that is set free evenly between liquidus and solidus.
#[derive(Clone, Copy, Debug)]
pub(super) struct Melt {
    pub(super) specific_j_per_kg_k: f64,
    pub(super) latent_j_per_kg: f64,
    pub(super) solidus_degc: f64,
    pub(super) liquidus_degc: f64,
}

impl Melt {
    /// What does not go together, in one line with what helps.
    pub(super) fn check(&self) -> Result<(), String> {
        if self.liquidus_degc < self.solidus_degc + 1.0 {
            return Err("liquidus_degc must be at least a kelvin above solidus_degc".to_owned());
        }
        Ok(())
    }

    /// The same for lava that is to freeze: what comes out so hot must be liquid.
    pub(super) fn check_fresh(&self, degc: f64, way_out: &str) -> Result<(), String> {
        if degc > self.solidus_degc {
            return Ok(());
        }
        let solidus = self.solidus_degc;
        Err(format!(
            "lava of temperature_degc = {degc} is rock before it comes out; raise it above solidus_degc = {solidus}{way_out}"
        ))
    }

    /// Enthalpy at the solidus, J/kg over 0 °C: what has less is rock.
    pub(super) fn rock(&self) -> f64 {
        self.specific_j_per_kg_k * self.solidus_degc
    }

    fn liquid(&self) -> f64 {
        self.specific_j_per_kg_k * self.liquidus_degc + self.latent_j_per_kg
    }

    fn mushy_k(&self) -> f64 {
        self.liquidus_degc - self.solidus_degc
    }

    /// Enthalpy at a temperature, J/kg over 0 °C.
    #[inline(always)]
    pub(super) fn enthalpy(&self, degc: f64) -> f64 {
        let molten = (degc - self.solidus_degc) / self.mushy_k();
        self.specific_j_per_kg_k * degc + self.latent_j_per_kg * molten.clamp(0.0, 1.0)
    }

    /// Temperature of an enthalpy, °C.
    #[inline(always)]
    pub(super) fn degc(&self, enthalpy: f64) -> f64 {
        let (rock, liquid) = (self.rock(), self.liquid());
        if enthalpy <= rock {
            enthalpy / self.specific_j_per_kg_k
        } else if enthalpy < liquid {
            self.solidus_degc + self.mushy_k() * (enthalpy - rock) / (liquid - rock)
        } else {
            (enthalpy - self.latent_j_per_kg) / self.specific_j_per_kg_k
        }
    }

    /// Heat of a kilogram for a kelvin more at an enthalpy, J/kg/K.
    #[inline(always)]
    pub(super) fn per_k(&self, enthalpy: f64) -> f64 {
        let (rock, liquid) = (self.rock(), self.liquid());
        if enthalpy < rock || enthalpy > liquid { self.specific_j_per_kg_k } else { (liquid - rock) / self.mushy_k() }
    }
}

/// What a bare surface radiates to surroundings of another temperature for a kelvin between them, W/m²/K, and that for a
/// kelvin more, `4·ε·σ·T³`: `ε·σ·(T⁴ − T_a⁴)` is the first times `T − T_a`.
#[inline(always)]
pub(super) fn radiated_per_k(emissivity: f64, degc: f64, ambient_degc: f64) -> [f64; 2] {
    let [hot, cold] = [degc, ambient_degc].map(|degc| (degc + ICE_K).max(0.0));
    let black = emissivity * STEFAN;
    [black * (hot * hot + cold * cold) * (hot + cold), 4.0 * black * hot * hot * hot]
}

/// By how many times a quantity has grown whose logarithm grows by so much with a kelvin less.
#[inline(always)]
pub(super) fn grown(per_k: f64, cooler_k: f64) -> f64 {
    libm::exp((per_k * cooler_k).min(MOST_EXPONENT))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heat_and_temperature_are_each_others_inverse() {
        let basalt =
            Melt { specific_j_per_kg_k: 1150.0, latent_j_per_kg: 3.5e5, solidus_degc: 1000.0, liquidus_degc: 1200.0 };
        for degc in [-20.0, 20.0, 999.0, 1000.0, 1050.0, 1199.0, 1200.0, 1300.0] {
            let heat = basalt.enthalpy(degc);
            assert!((basalt.degc(heat) - degc).abs() < 1e-9, "{degc}");
            let kelvin = basalt.enthalpy(degc + 0.5) - basalt.enthalpy(degc - 0.5);
            let bends = (degc - 1000.0).abs() < 1.0 || (degc - 1200.0).abs() <= 1.0;
            assert!(bends || (basalt.per_k(heat) / kelvin - 1.0).abs() < 1e-9, "{degc}");
        }
        let whole = basalt.enthalpy(1200.0) - basalt.rock();
        assert!((whole - 200.0 * 1150.0 - 3.5e5).abs() < 1e-6);
    }

    #[test]
    fn a_black_body_at_1450_k_radiates_a_quarter_of_a_megawatt() {
        let [per_k, slope] = radiated_per_k(1.0, 1450.0 - 273.15, -273.15);
        // σ·1450⁴ and 4·σ·1450³.
        assert!((per_k * 1450.0 / 250_659.3 - 1.0).abs() < 1e-4, "{}", per_k * 1450.0);
        assert!((slope / (4.0 * per_k) - 1.0).abs() < 1e-12);
    }
}
