//! Everything the metrics are read from, worked out once for a world.

use super::{
    Hypsometry, Missing, Reading, Slopes,
    ground::{self, BasinHypsometry, Inversion, LocalRelief, Modes, Pits, Spectra, Variogram},
    hypsometry,
    metrics::METRICS,
    slopes,
    streams::{self, Chi, Exceedance, Hack, Horton, Network, SlopeArea},
};
use crate::world::{Layer, World};

/// The landscape of a world in curves and laws, each of them there or with the reason why not.
#[derive(Clone, Debug)]
pub struct Survey {
    /// Cells from west to east and from north to south.
    pub size: [usize; 2],
    /// Side of a cell, m.
    pub cell_m: f64,
    /// Share of the map above the sea.
    pub land_share: f64,
    /// Catchment at which a channel begins, km².
    pub channel_km2: f64,
    /// Hypsometry of the land as a whole.
    pub land: Result<Hypsometry, Missing>,
    /// Hypsometry by basin.
    pub basins: Result<BasinHypsometry, Missing>,
    /// Slope against area.
    pub slope_area: Result<SlopeArea, Missing>,
    /// Height against χ.
    pub chi: Result<Chi, Missing>,
    /// Length against area.
    pub hack: Result<Hack, Missing>,
    /// Streams by order.
    pub horton: Result<Horton, Missing>,
    /// Area exceedance.
    pub exceedance: Result<Exceedance, Missing>,
    /// Length of channels over area, km/km².
    pub density_km_per_km2: Result<f64, Missing>,
    /// Share of channel cells that reach sea, rim or lake without flowing uphill.
    pub arriving_share: Result<f64, Missing>,
    /// Power spectra.
    pub spectra: Result<Spectra, Missing>,
    /// Variogram.
    pub variogram: Result<Variogram, Missing>,
    /// Slopes of the land.
    pub slopes: Result<Slopes, Missing>,
    /// Local relief.
    pub relief: Result<LocalRelief, Missing>,
    /// Pits and lakes.
    pub pits: Result<Pits, Missing>,
    /// What happens upside down.
    pub inversion: Result<Inversion, Missing>,
    /// Skewness of curvature.
    pub curvature_skewness: Result<f64, Missing>,
    /// Continents' and ocean floors' heights.
    pub modes: Result<Modes, Missing>,
    /// `[height over the sea, m; share of the map]` in classes of 250 m.
    pub heights: Vec<[f64; 2]>,
}

/// Surveys a world.
pub fn survey(world: &World) -> Survey {
    let height = world.height();
    let sea = world.sea_level_m;
    let lakes = world.layer(Layer::LakeDepth);
    let network = Network::of(&height, sea);
    let squares = ground::squares(&height, sea);
    let land: Vec<f32> = height.data.iter().copied().filter(|&h| h as f64 > sea).collect();
    let channels = || Missing::TooFew { what: "channel cells", found: 0, needed: 1 };
    Survey {
        size: [world.grid.width, world.grid.height],
        cell_m: world.grid.cell_m,
        land_share: land.len() as f64 / height.data.len().max(1) as f64,
        channel_km2: network.threshold_m2 * 1e-6,
        land: hypsometry(&land).ok_or(Missing::NoLand),
        basins: ground::basin_hypsometry(&network),
        slope_area: streams::slope_area(&streams::slope_area_points(&network)),
        chi: streams::chi(&network),
        hack: streams::hack(&network),
        horton: streams::horton(&network),
        exceedance: streams::exceedance(&network),
        density_km_per_km2: network.density_km_per_km2().ok_or(Missing::NoLand),
        arriving_share: network.arriving_share(lakes).ok_or_else(channels),
        spectra: ground::spectra(&height, sea, &squares),
        variogram: ground::variogram(&height, sea),
        slopes: slopes(&height, sea).ok_or(Missing::NoLand),
        relief: ground::local_relief(&height, sea),
        pits: Some(ground::pits(&height, sea, lakes)).filter(|p| p.land > 0).ok_or(Missing::NoLand),
        inversion: ground::inversion(&height, sea, &squares),
        curvature_skewness: ground::curvature_skewness(&height, sea),
        modes: ground::modes(&height, sea),
        heights: ground::histogram(&height, sea),
    }
}

impl Survey {
    /// Every metric, in the order of [`METRICS`].
    pub fn readings(&self) -> Vec<Reading> {
        METRICS.iter().map(|metric| metric.read(self)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        grid::{Edges, Field, Grid},
        measure::Verdict,
    };

    fn world(grid: Grid, f: impl Fn(usize, usize) -> f32 + Sync) -> World {
        let mut world = World::new(grid, 0.0);
        world.set_layer(Layer::Bedrock, Field::from_fn(grid, f));
        world
    }

    #[test]
    fn odd_worlds_have_reasons_and_no_number_is_none() {
        let grid = |w: usize, h: usize, edges| Grid::new(w, h, w as f64 * 500.0, edges);
        let open = grid(96, 96, Edges::Open);
        let worlds = [
            world(open, |_, _| 0.0),
            world(open, |_, _| 7.0),
            world(open, |_, _| -100.0),
            world(open, |x, y| if (x, y) == (40, 40) { 1.0 } else { -5.0 }),
            world(open, |x, y| (x * y) as f32),
            world(grid(1, 1, Edges::Open), |_, _| 5.0),
            world(grid(1, 1, Edges::Wrap), |_, _| 5.0),
            world(grid(1, 900, Edges::Closed), |_, y| y as f32),
            world(grid(2, 3, Edges::Wrap), |x, _| x as f32),
            world(grid(128, 128, Edges::Closed), |x, y| ((x as f32 - 64.0).powi(2) + (y as f32 - 64.0).powi(2)) + 1.0),
        ];
        for (which, world) in worlds.iter().enumerate() {
            for reading in survey(world).readings() {
                let told = reading.missing.as_ref().is_some_and(|why| !why.is_empty());
                assert!(reading.value.is_some_and(f64::is_finite) != told, "world {which}: {reading:?}");
                assert_eq!(reading.verdict == Verdict::Missing, told, "world {which}: {reading:?}");
            }
        }
        let why = |which: usize, name: &str| {
            let readings = survey(&worlds[which]).readings();
            readings.into_iter().find(|r| r.name == name).unwrap().missing.unwrap()
        };
        assert_eq!(why(0, "pits"), "no land above the sea");
        assert_eq!(why(1, "curvature_skewness"), "the ground is flat");
        assert_eq!(why(3, "concavity"), "too few classes of channel area with 10 cells: 0, at least 4 needed");
        assert_eq!(why(3, "transect_spectrum"), "no square of 64 x 64 cells that is nearly all land");
    }
}
