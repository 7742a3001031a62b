//! What grows by mean temperature and rain of a year: Whittaker's biomes (1975), their borders drawn as straight lines.

/// The classes of the layer `biome`, in the catalogue's order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Biome {
    /// Below sea level.
    Sea,
    /// Above the snow line.
    Ice,
    /// Too cold for trees.
    Tundra,
    /// Conifers of the north.
    Taiga,
    /// Trees that shed their leaves in winter.
    TemperateForest,
    /// Giants of mild wet coasts.
    TemperateRainForest,
    /// Steppe and prairie.
    Grassland,
    /// Scrub and open woodland.
    Shrubland,
    /// Little or nothing, cold or hot.
    Desert,
    /// Grass with trees.
    Savanna,
    /// Trees that shed their leaves in the dry season.
    TropicalDryForest,
    /// Trees that never need to.
    TropicalRainForest,
}

/// Mean temperatures between tundra and taiga, taiga and temperate, temperate and tropical, degC.
const BORDERS_DEGC: [f64; 3] = [-5.0, 4.0, 20.0];

impl Biome {
    /// What grows on land below the snow line.
    pub fn of(temperature_degc: f64, rain_mm_per_yr: f64) -> Self {
        use Biome::*;
        let [tundra, taiga, temperate] = BORDERS_DEGC;
        let (t, rain) = (temperature_degc, rain_mm_per_yr);
        // The classes of a belt from dry to wet, each up to its border in mm.
        let belt: &[(f64, Biome)] = if t < tundra {
            &[(f64::INFINITY, Tundra)]
        } else if t < taiga {
            &[(100.0, Desert), (250.0, Grassland), (f64::INFINITY, Taiga)]
        } else if t < temperate {
            // Warmth needs water: the same rain that grows a wood at 5 degC leaves a steppe at 20.
            &[
                (100.0 + 8.0 * t, Desert),
                (200.0 + 15.0 * t, Grassland),
                (350.0 + 25.0 * t, Shrubland),
                (2000.0, TemperateForest),
                (f64::INFINITY, TemperateRainForest),
            ]
        } else {
            &[
                (350.0, Desert),
                (600.0, Shrubland),
                (1100.0, Savanna),
                (2000.0, TropicalDryForest),
                (f64::INFINITY, TropicalRainForest),
            ]
        };
        belt.iter().find(|(border, _)| rain < *border).map_or(Tundra, |&(_, biome)| biome)
    }
}
