//! The column of rock: how high a crust of given thickness and density floats, how deep the sea floor sinks with age.
//!
//! Local (Airy) isostasy: every column presses equally on the compensation depth. Columns below the sea carry its
//! water, which multiplies depths by ρm / (ρm - ρw). Knows no plate and no map.
//!
//! Sources: Turcotte and Schubert, *Geodynamics*; Parsons and Sclater 1977 for the depth of the sea floor.

use std::sync::LazyLock;

/// Density of the mantle, kg/m³.
pub const MANTLE: f64 = 3300.0;
/// Density of continental crust, kg/m³.
pub const CONTINENTAL: f64 = 2800.0;
/// Density of oceanic crust, kg/m³.
pub const OCEANIC: f64 = 2900.0;
/// Density of sea water, kg/m³.
pub const SEA_WATER: f64 = 1030.0;

/// Thickness of the continental column that stands at `REFERENCE_HEIGHT_M`, m.
pub const REFERENCE_THICKNESS_M: f64 = 35_000.0;
/// Mean height of the continents, m.
pub const REFERENCE_HEIGHT_M: f64 = 840.0;
/// Thickness of oceanic crust, m.
pub const OCEAN_THICKNESS_M: f64 = 7_000.0;

/// Shift of the plate model of [`sea_floor_depth_m`]; an exponential is dear.
static SHIFT_M: LazyLock<f64> =
    LazyLock::new(|| 2500.0 + 350.0 * 70f64.sqrt() - (6400.0 - 3200.0 * libm::exp(-70.0 / 62.8)));

/// Density of crust that is continental to the share `kind`, kg/m³.
pub fn density(kind: f64) -> f64 {
    OCEANIC + (CONTINENTAL - OCEANIC) * kind
}

/// Height at which a crust `thickness_m` thick of `density` floats, m above the sea, cold and in balance with the
/// reference continent.
pub fn airy_height_m(thickness_m: f64, density: f64) -> f64 {
    // Weight of the reference column and of this one, both above one depth, in metres of mantle:
    // T·(ρm - ρ)/ρm - h is the same for both.
    let reference = REFERENCE_THICKNESS_M * (MANTLE - CONTINENTAL) / MANTLE - REFERENCE_HEIGHT_M;
    let dry = thickness_m * (MANTLE - density) / MANTLE - reference;
    load_with_water(dry)
}

/// A height as it would stand in air, sunk by the water above it where it is below the sea.
pub fn load_with_water(dry_m: f64) -> f64 {
    if dry_m < 0.0 { dry_m * MANTLE / (MANTLE - SEA_WATER) } else { dry_m }
}

/// Depth of sea floor of a given age, m: the square-root law to 70 My, the plate model's decay beyond, joined without
/// a step.
pub fn sea_floor_depth_m(age_myr: f64) -> f64 {
    let age = age_myr.max(0.0);
    if age <= 70.0 {
        2500.0 + 350.0 * age.sqrt()
    } else {
        // Parsons and Sclater's 6400 - 3200·exp(-t/62.8), shifted by 30 m to meet the root at 70 My.
        6400.0 - 3200.0 * libm::exp(-age / 62.8) + *SHIFT_M
    }
}

/// How much higher young, hot oceanic lithosphere stands than the cold column of `airy_height_m`, m.
pub fn thermal_height_m(age_myr: f64) -> f64 {
    -airy_height_m(OCEAN_THICKNESS_M, OCEANIC) - sea_floor_depth_m(age_myr)
}

/// Height of crust `thickness_m` thick, continental to the share `kind`, `age_myr` old; m above the sea.
pub fn height_m(thickness_m: f64, kind: f64, age_myr: f64) -> f64 {
    let cold_m = airy_height_m(thickness_m, density(kind));
    if kind < 1.0 { cold_m + (1.0 - kind) * thermal_height_m(age_myr) } else { cold_m }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pressure at 200 km below the sea surface, Pa, of a column that stands at `height_m`.
    fn pressure(thickness_m: f64, density: f64, height_m: f64) -> f64 {
        let depth = 200_000.0;
        let water = (-height_m).max(0.0);
        9.81 * (SEA_WATER * water + density * thickness_m + MANTLE * (depth + height_m - thickness_m))
    }

    #[test]
    fn every_column_presses_equally() {
        let mut pressures = Vec::new();
        for density in [2750.0, CONTINENTAL, 2850.0, OCEANIC] {
            for step in 0..40 {
                let thickness = 5_000.0 + 1_700.0 * step as f64;
                pressures.push(pressure(thickness, density, airy_height_m(thickness, density)));
            }
        }
        let mean = pressures.iter().sum::<f64>() / pressures.len() as f64;
        let spread = pressures.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / pressures.len() as f64;
        assert!(spread.sqrt() / mean < 1e-9, "{}", spread.sqrt() / mean);
    }

    #[test]
    fn known_columns() {
        assert!((airy_height_m(35_000.0, CONTINENTAL) - 840.0).abs() < 1e-9);
        // A kilometre of relief for 6.6 km of crust.
        let slope = (airy_height_m(45_000.0, CONTINENTAL) - 840.0) / 10_000.0;
        assert!((slope - 500.0 / 3300.0).abs() < 1e-12);
        // Old ocean in balance with the reference continent: 5.25 km.
        assert!((airy_height_m(OCEAN_THICKNESS_M, OCEANIC) + 5250.0).abs() < 20.0);
    }

    #[test]
    fn sea_floor_follows_the_root_of_age() {
        for age in [0.0, 1.0, 16.0, 49.0, 70.0] {
            let height = height_m(OCEAN_THICKNESS_M, 0.0, age);
            assert!((-height - (2500.0 + 350.0 * age.sqrt())).abs() < 1e-6, "{age}");
        }
        assert!((sea_floor_depth_m(70.0001) - sea_floor_depth_m(70.0)).abs() < 0.01);
        assert!(sea_floor_depth_m(180.0) < 6300.0 && sea_floor_depth_m(180.0) > 6100.0);
    }
}
