//! The table of metrics: what is read, what is found on Earth, at which cell sizes, and who says so.
//!
//! One table: the printed numbers, JSON, reports and `docs/realism.md` all come from it.

use super::{
    Missing,
    metric::{Band, Metric},
};

/// Any size of cells.
const ANY: Option<Band> = None;
/// Rivers as trees: cells that resolve channels, up to continents in cells of some kilometres.
const TREES: Option<Band> = Some(Band::new(5.0, 5000.0));
/// What hillslopes make: cells of a DEM.
const HILLSLOPES: Option<Band> = Some(Band::new(10.0, 100.0));

/// Every metric, in the order they are reported.
pub const METRICS: &[Metric] = &[
    Metric {
        name: "hypsometric_integral",
        title: "hypsometric integral",
        unit: "1",
        band: Some(Band::new(0.3, 0.6)),
        cells_m: TREES,
        method: "(mean − lowest)/(highest − lowest) height of a basin; the median of the 40 largest basins of 256 cells or more",
        source: "Strahler 1952 (0.35 to 0.6 at equilibrium, more where young); many orogens 0.3 to 0.5; Pike and Wilson 1971",
        value: |s| Ok(s.basins.as_ref().map_err(Missing::clone)?.integral),
    },
    Metric {
        name: "concavity",
        title: "concavity θ",
        unit: "1",
        band: Some(Band::new(0.225, 0.575)),
        cells_m: TREES,
        method: "slope S of channel cells to their receivers against catchment A: −d log S/d log A of the medians in five classes a decade",
        source: "Gailleton et al. 2021, quartiles of rivers worldwide (median 0.425); Flint 1974; 0.45 is the usual reference",
        value: |s| Ok(s.slope_area.as_ref().map_err(Missing::clone)?.theta),
    },
    Metric {
        name: "chi_linearity",
        title: "χ linearity R²",
        unit: "1",
        band: Some(Band::new(0.95, 1.0)),
        cells_m: TREES,
        method: "R² of height over χ = ∫(1 m²/A)^0.45 dx, all channels of a basin; the median of the 12 largest basins",
        source: "Perron and Royden 2013: over 0.95 at steady state; less where uplift, rock or climate changed",
        value: |s| Ok(s.chi.as_ref().map_err(Missing::clone)?.r2),
    },
    Metric {
        name: "steepness",
        title: "steepness k_sn",
        unit: "m^0.9",
        band: Some(Band::new(50.0, 600.0)),
        cells_m: TREES,
        method: "slope of height over χ, that is S·A^0.45; the median of the 12 largest basins",
        source: "Wobus et al. 2006; Kirby and Whipple 2012: 50 to 100 in quiet, 200 to 600 in active ranges",
        value: |s| Ok(s.chi.as_ref().map_err(Missing::clone)?.steepness),
    },
    Metric {
        name: "hack_exponent",
        title: "Hack's exponent",
        unit: "1",
        band: Some(Band::new(0.5, 0.65)),
        cells_m: TREES,
        method: "longest stream L against area A of the basin above each channel cell: d log L/d log A of the medians in five classes a decade, up to a twentieth of the largest basin",
        source: "Hack 1957 (0.6); Rigon et al. 1996 (0.5 to 0.6); Dodds and Rothman 2000",
        value: |s| Ok(s.hack.as_ref().map_err(Missing::clone)?.exponent),
    },
    Metric {
        name: "bifurcation_ratio",
        title: "Horton R_B, numbers",
        unit: "1",
        band: Some(Band::new(3.0, 5.0)),
        cells_m: TREES,
        method: "log-linear fit of the number of streams by Strahler order, orders with three streams or more",
        source: "Horton 1945; Strahler 1957; random networks have it too",
        value: |s| Ok(s.horton.as_ref().map_err(Missing::clone)?.bifurcation),
    },
    Metric {
        name: "length_ratio",
        title: "Horton R_L, lengths",
        unit: "1",
        band: Some(Band::new(1.5, 3.5)),
        cells_m: TREES,
        method: "the same of their mean lengths",
        source: "Horton 1945; Strahler 1957",
        value: |s| Ok(s.horton.as_ref().map_err(Missing::clone)?.length),
    },
    Metric {
        name: "area_ratio",
        title: "Horton R_A, areas",
        unit: "1",
        band: Some(Band::new(3.0, 6.0)),
        cells_m: TREES,
        method: "the same of their mean catchments",
        source: "Horton 1945; Schumm 1956",
        value: |s| Ok(s.horton.as_ref().map_err(Missing::clone)?.area),
    },
    Metric {
        name: "area_exceedance",
        title: "area exceedance β",
        unit: "1",
        band: Some(Band::new(0.4, 0.46)),
        cells_m: TREES,
        method: "share of a basin that drains more than an area a, P ∝ a^−β, from the channels' threshold to a twentieth of the basin; the median of the 12 largest basins",
        source: "Rodriguez-Iturbe et al. 1992: 0.43 ± 0.03",
        value: |s| Ok(s.exceedance.as_ref().map_err(Missing::clone)?.beta),
    },
    Metric {
        name: "drainage_density",
        title: "drainage density",
        unit: "km/km2",
        band: Some(Band::new(1.0, 10.0)),
        cells_m: Some(Band::new(5.0, 225.0)),
        method: "length of channels over area of land; a channel begins at 1 km², or at 20 cells where those are larger",
        source: "Montgomery and Dietrich 1989; humid mountains 2 to 6; goes with the threshold",
        value: |s| s.density_km_per_km2.clone(),
    },
    Metric {
        name: "rivers_arrive",
        title: "rivers that arrive",
        unit: "1",
        band: Some(Band::new(0.999, 1.0)),
        cells_m: ANY,
        method: "share of channel cells whose water reaches sea, rim or a lake without flowing uphill over the unfilled ground",
        source: "by definition of a river",
        value: |s| s.arriving_share.clone(),
    },
    Metric {
        name: "pits",
        title: "pits in 10,000 cells",
        unit: "1",
        band: Some(Band::new(0.0, 1.0)),
        cells_m: ANY,
        method: "level patches of land without a lower neighbour, on the unfilled ground, in 10,000 cells of land; hollows with a lake are not counted",
        source: "ground that rivers made has next to none; noise has one in some ten cells",
        value: |s| s.pits.as_ref().map_err(Missing::clone)?.per_10_000().ok_or(Missing::NoLand),
    },
    Metric {
        name: "pit_density",
        title: "pits in a km²",
        unit: "1/km2",
        band: None,
        cells_m: ANY,
        method: "the same over the area of land",
        source: "goes with the cells",
        value: |s| {
            let pits = s.pits.as_ref().map_err(Missing::clone)?;
            Ok(pits.pits as f64 / (pits.land as f64 * s.cell_m * s.cell_m * 1e-6))
        },
    },
    Metric {
        name: "transect_spectrum",
        title: "spectrum of transects β",
        unit: "1",
        band: Some(Band::new(1.8, 2.2)),
        cells_m: Some(Band::new(250.0, 5000.0)),
        method: "power along rows and columns of squares of land, k^−β: detrended, Hann window, from a fourth of the side to four cells or 200 m",
        source: "Pelletier 1997: 1.8 to 2; Huang and Turcotte 1989: 2; over waves of a kilometre, below which valleys and hillslopes steepen it",
        value: |s| Ok(s.spectra.as_ref().map_err(Missing::clone)?.transect.beta),
    },
    Metric {
        name: "radial_spectrum",
        title: "spectrum of the plane β",
        unit: "1",
        band: Some(Band::new(2.8, 3.2)),
        cells_m: Some(Band::new(250.0, 5000.0)),
        method: "mean power of the plane's modes by wave number, in the same squares",
        source: "one more than that of transects; Perron et al. 2008",
        value: |s| Ok(s.spectra.as_ref().map_err(Missing::clone)?.radial.beta),
    },
    Metric {
        name: "fractal_dimension",
        title: "fractal dimension",
        unit: "1",
        band: Some(Band::new(2.1, 2.5)),
        cells_m: Some(Band::new(5.0, 5000.0)),
        method: "3 − H from the variogram of the land, γ ∝ d^(2H), lags of 2 to 50 cells",
        source: "Mark and Aronson 1984; Klinkenberg and Goodchild 1992; goes with scale",
        value: |s| Ok(s.variogram.as_ref().map_err(Missing::clone)?.dimension),
    },
    Metric {
        name: "mean_slope",
        title: "mean slope",
        unit: "deg",
        band: Some(Band::new(25.0, 35.0)),
        cells_m: HILLSLOPES,
        method: "arctangent of the gradient by central differences, mean over land",
        source: "active ranges; Burbank et al. 1996; Montgomery and Brandon 2002",
        value: |s| Ok(s.slopes.as_ref().map_err(Missing::clone)?.mean_deg),
    },
    Metric {
        name: "slope_spread",
        title: "spread of slope",
        unit: "deg",
        band: None,
        cells_m: HILLSLOPES,
        method: "standard deviation of the same",
        source: "no band that holds for all ranges",
        value: |s| Ok(s.slopes.as_ref().map_err(Missing::clone)?.deviation_deg),
    },
    Metric {
        name: "steep_share",
        title: "share over 45°",
        unit: "1",
        band: Some(Band::new(0.0, 0.05)),
        cells_m: HILLSLOPES,
        method: "share of the land steeper than 45°",
        source: "few slopes stand above the threshold of landslides; Burbank et al. 1996",
        value: |s| Ok(s.slopes.as_ref().map_err(Missing::clone)?.histogram[9..].iter().sum()),
    },
    Metric {
        name: "erosion_score",
        title: "Olsen's erosion score",
        unit: "1",
        band: None,
        cells_m: ANY,
        method: "standard deviation over mean of the tangent of slope, on land",
        source: "Olsen 2004: noise 0.42 to 0.48, eroded ground 1 and more; a score of games, not of Earth",
        value: |s| s.slopes.as_ref().map_err(Missing::clone)?.erosion_score.ok_or(Missing::Flat),
    },
    Metric {
        name: "local_relief",
        title: "local relief in 5 km",
        unit: "m",
        band: Some(Band::new(500.0, 2000.0)),
        cells_m: Some(Band::new(5.0, 250.0)),
        method: "highest less lowest ground in a disc of 5 km that lies on land; the median of the discs",
        source: "mountains; Ahnert 1970; Montgomery and Brandon 2002",
        value: |s| Ok(s.relief.as_ref().map_err(Missing::clone)?.median_m),
    },
    Metric {
        name: "curvature_skewness",
        title: "skewness of curvature",
        unit: "1",
        band: Some(Band::above(0.0)),
        cells_m: Some(Band::new(5.0, 500.0)),
        method: "skewness of ∇²z over inland cells",
        source: "rivers cut valleys sharper than ridges; noise has 0",
        value: |s| s.curvature_skewness.clone(),
    },
    Metric {
        name: "inversion_fill",
        title: "hollows upside down",
        unit: "1",
        band: Some(Band::new(0.5, 1.0)),
        cells_m: ANY,
        method: "(h' − h)/(h' + h), h the share of a square of land that routing has to fill and h' the same upside down",
        source: "a measure of this program: noise 0, ground that drains 1",
        value: |s| s.inversion.as_ref().map_err(Missing::clone)?.fill.ok_or(Missing::Flat),
    },
    Metric {
        name: "inversion_concavity",
        title: "concavity less inverted",
        unit: "1",
        band: None,
        cells_m: ANY,
        method: "concavity θ of the squares less that of the same upside down",
        source: "noise 0",
        value: |s| s.inversion.as_ref().map_err(Missing::clone)?.theta.clone(),
    },
    Metric {
        name: "continent_mode",
        title: "continents' mode",
        unit: "m",
        band: Some(Band::new(0.0, 800.0)),
        cells_m: Some(Band::above(500.0)),
        method: "commonest height over the sea above −1.5 km, in classes of 250 m",
        source: "Earth: 100 to 800 m",
        value: |s| Ok(s.modes.as_ref().map_err(Missing::clone)?.continent_m),
    },
    Metric {
        name: "ocean_mode",
        title: "ocean floors' mode",
        unit: "m",
        band: Some(Band::new(-5000.0, -4000.0)),
        cells_m: Some(Band::above(500.0)),
        method: "the same below −1.5 km",
        source: "Earth: −4 to −5 km",
        value: |s| Ok(s.modes.as_ref().map_err(Missing::clone)?.ocean_m),
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_whole_and_names_are_unique() {
        for (i, metric) in METRICS.iter().enumerate() {
            assert!(METRICS[..i].iter().all(|m| m.name != metric.name && m.title != metric.title), "{}", metric.name);
            assert!(!metric.method.is_empty() && !metric.source.is_empty() && !metric.unit.is_empty());
            assert!(metric.name.chars().all(|c| c.is_ascii_lowercase() || c == '_'));
            // A column of the printed table.
            assert!(metric.title.chars().count() <= 24, "{}", metric.title);
        }
    }
}
