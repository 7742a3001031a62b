//! The report of `upthrust inspect`.

use std::{collections::BTreeMap, fmt};

use serde::Serialize;

use super::{Hypsometry, LayerStats, Slopes, hypsometry, layer_stats, slopes};
use crate::{
    grid::{Edges, sum_f64},
    world::{Clocks, Layer, Matter, World},
};

/// One account of the ledger, with what it cannot explain.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Books {
    /// The stage that kept it.
    pub stage: String,
    /// What is counted.
    pub matter: Matter,
    /// Stock when the stage began, m³.
    pub start_m3: f64,
    /// Came in, m³.
    pub came_in_m3: f64,
    /// Left, m³.
    pub left_m3: f64,
    /// Stock when the stage ended, m³.
    pub end_m3: f64,
    /// What the books cannot explain, m³.
    pub residual_m3: f64,
    /// The residual as a share of what moved; absent where nothing moved and something is missing.
    pub residual_share: Option<f64>,
}

/// A world in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inspection {
    /// Cells from west to east and from north to south.
    pub size: [usize; 2],
    /// Extent from west to east and from north to south, km.
    pub extent_km: [f64; 2],
    /// Side of a cell, m.
    pub cell_m: f64,
    /// What lies beyond the rim.
    pub edges: Edges,
    /// Years since the recipe began.
    pub time_yr: f64,
    /// Height of the sea, m.
    pub sea_level_m: f64,
    /// Lowest ground, m.
    pub min_m: f64,
    /// Highest ground, m.
    pub max_m: f64,
    /// Mean height of the ground, m.
    pub mean_m: f64,
    /// Share of the area above the sea.
    pub land_share: f64,
    /// Mean height of the land over the sea, m; absent where there is none.
    pub mean_land_m: Option<f64>,
    /// Plates that are seen on the map; absent where there are none.
    pub plates: Option<usize>,
    /// Heights of the whole map.
    pub hypsometry: Option<Hypsometry>,
    /// Heights of the land alone; absent where there is none.
    pub land_hypsometry: Option<Hypsometry>,
    /// Slopes of the land; absent where there is none.
    pub land_slopes: Option<Slopes>,
    /// Every layer.
    pub layers: Vec<LayerStats>,
    /// Every account.
    pub ledger: Vec<Books>,
    /// How the clocks of stages go in which water runs in its own time.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub clocks: BTreeMap<String, Clocks>,
}

/// Measures a world.
pub fn inspect(world: &World) -> Inspection {
    let height = world.height();
    let sea = world.sea_level_m;
    let land: Vec<f32> = height.data.iter().copied().filter(|&h| h as f64 > sea).collect();
    let layers = layer_stats(world);
    let (min_m, max_m, mean_m) = (layers[0].min, layers[0].max, layers[0].mean);
    Inspection {
        size: [world.grid.width, world.grid.height],
        extent_km: world.grid.extent_m().map(|m| m / 1000.0),
        cell_m: world.grid.cell_m,
        edges: world.grid.edges,
        time_yr: world.time_yr,
        sea_level_m: sea,
        min_m,
        max_m,
        mean_m,
        land_share: land.len() as f64 / height.data.len() as f64,
        mean_land_m: (!land.is_empty()).then(|| sum_f64(&land) / land.len() as f64 - sea),
        plates: plates(world),
        hypsometry: hypsometry(&height.data),
        land_hypsometry: hypsometry(&land),
        land_slopes: slopes(&height, sea),
        layers,
        ledger: books(world),
        clocks: world.ledger.all_clocks().map(|(stage, clocks)| (stage.to_owned(), clocks)).collect(),
    }
}

fn plates(world: &World) -> Option<usize> {
    let mut ids: Vec<i64> = world.layer(Layer::PlateId)?.data.iter().map(|&id| id as i64).collect();
    ids.sort_unstable();
    ids.dedup();
    Some(ids.len())
}

fn books(world: &World) -> Vec<Books> {
    let entry = |(stage, matter, account): (&str, Matter, &crate::world::Account)| Books {
        stage: stage.to_owned(),
        matter,
        start_m3: account.start_m3,
        came_in_m3: account.came_in_m3,
        left_m3: account.left_m3,
        end_m3: account.end_m3,
        residual_m3: account.residual_m3(),
        residual_share: Some(account.residual_share()).filter(|share| share.is_finite()),
    };
    world.ledger.accounts().map(entry).collect()
}

impl fmt::Display for Inspection {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [width, height] = self.size;
        let [east_km, south_km] = self.extent_km;
        let edges = match self.edges {
            Edges::Open => "open",
            Edges::Closed => "closed",
            Edges::Wrap => "wrap",
        };
        writeln!(f, "size        {width} x {height} cells of {} m, edges {edges}", short(self.cell_m))?;
        writeln!(f, "extent      {} x {} km", short(east_km), short(south_km))?;
        writeln!(f, "clock       {} My", short(self.time_yr / 1e6))?;
        writeln!(f, "height      {:.1} to {:.1} m, mean {:.1} m", self.min_m, self.max_m, self.mean_m)?;
        write!(f, "sea level   {} m, land {:.1} %", short(self.sea_level_m), self.land_share * 100.0)?;
        match self.mean_land_m {
            Some(mean) => writeln!(f, ", {mean:.0} m high on average")?,
            None => writeln!(f)?,
        }
        if let Some(plates) = self.plates {
            writeln!(f, "plates      {plates} on the map")?;
        }
        for (name, curve) in [("whole map", &self.hypsometry), ("land", &self.land_hypsometry)] {
            if let Some(curve) = curve {
                write_curve(f, name, curve)?;
            }
        }
        if let Some(slopes) = &self.land_slopes {
            write_slopes(f, slopes)?;
        }
        self.write_layers(f)?;
        self.write_ledger(f)
    }
}

impl Inspection {
    fn write_layers(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "\n{:<16} {:<6} {:>12} {:>12} {:>12}  hash", "layer", "unit", "min", "max", "mean")?;
        for s in &self.layers {
            let values = [s.min, s.max, s.mean].map(short);
            let [min, max, mean] = values;
            writeln!(f, "{:<16} {:<6} {min:>12} {max:>12} {mean:>12}  {}", s.layer, s.unit, s.hash)?;
        }
        Ok(())
    }

    fn write_ledger(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if self.ledger.is_empty() {
            return Ok(());
        }
        writeln!(f, "\n{:<24} {:>12} {:>12} {:>12} {:>10}", "ledger, m³", "came in", "left", "change", "residual")?;
        for b in &self.ledger {
            let name = format!("{} {}", b.stage, format!("{:?}", b.matter).to_lowercase());
            let change = b.end_m3 - b.start_m3;
            write!(f, "{name:<24} {:>12.4e} {:>12.4e} {change:>12.4e} ", b.came_in_m3, b.left_m3)?;
            match b.residual_share {
                Some(share) => writeln!(f, "{share:>10.1e}")?,
                None => writeln!(f, "{:>10}", "unbooked")?,
            }
        }
        for (stage, Clocks { water_s, morphological_factor }) in &self.clocks {
            let hours = short(water_s / 3600.0);
            writeln!(f, "{stage:<24} {hours:>12} h of water, {} times that of its bed", short(*morphological_factor))?;
        }
        Ok(())
    }
}

fn write_curve(f: &mut fmt::Formatter, name: &str, hypsometry: &Hypsometry) -> fmt::Result {
    let integral = hypsometry.integral.map_or("flat".to_owned(), |i| format!("{i:.3}"));
    writeln!(f, "\nhypsometry of the {name}: integral {integral}")?;
    let every = hypsometry.curve.iter().step_by(2);
    let cells: Vec<(String, String)> =
        every.map(|[share, h]| (format!("{:.0} %", share * 100.0), format!("{h:.0}"))).collect();
    write!(f, "  area above")?;
    cells.iter().try_for_each(|(share, _)| write!(f, " {share:>7}"))?;
    write!(f, "\n  height, m ")?;
    cells.iter().try_for_each(|(_, h)| write!(f, " {h:>7}"))?;
    writeln!(f)
}

fn write_slopes(f: &mut fmt::Formatter, slopes: &Slopes) -> fmt::Result {
    writeln!(f, "\nslope of the land: mean {:.2}°, steepest {:.2}°", slopes.mean_deg, slopes.max_deg)?;
    write!(f, "  flatter, %")?;
    slopes.percentiles_deg.iter().try_for_each(|(p, _)| write!(f, " {p:>7}"))?;
    write!(f, "\n  slope, deg")?;
    slopes.percentiles_deg.iter().try_for_each(|(_, s)| write!(f, " {s:>7.2}"))?;
    writeln!(f)
}

/// Six significant digits at most, without trailing zeros.
fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = libm::floor(libm::log10(value.abs())) as i32;
    if !(-4..9).contains(&digits) {
        return format!("{value:.4e}");
    }
    let text = format!("{value:.*}", (5 - digits).max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Field, Grid};

    fn world() -> World {
        let grid = Grid::new(100, 50, 100_000.0, Edges::Open);
        let mut world = World::new(grid, 0.0);
        world.set_layer(Layer::Bedrock, Field::from_fn(grid, |x, _| (x as f32 - 79.5) * 10.0));
        world.set_layer(Layer::PlateId, Field::from_fn(grid, |x, _| (x / 50) as f32 * 3.0));
        world.ledger.book_in("hills", Matter::Rock, 5.0);
        world.ledger.close("hills", Matter::Rock, 5.0);
        world.ledger.close("ghosts", Matter::Rock, 5.0);
        world
    }

    #[test]
    fn a_ramp_in_numbers() {
        let found = inspect(&world());
        assert_eq!((found.size, found.extent_km), ([100, 50], [100.0, 50.0]));
        assert_eq!((found.land_share, found.mean_land_m), (0.2, Some(100.0)));
        assert_eq!((found.min_m, found.max_m, found.mean_m), (-795.0, 195.0, -300.0));
        assert_eq!(found.plates, Some(2));
        assert!((found.land_slopes.unwrap().mean_deg - 0.01f64.atan().to_degrees()).abs() < 1e-6);
        assert_eq!(found.ledger[1].residual_share, Some(0.0));
        assert_eq!(found.ledger[0].residual_share, None);
    }

    #[test]
    fn the_report_reads_and_serializes() {
        let found = inspect(&world());
        let text = found.to_string();
        for part in
            ["100 x 50 cells of 1000 m", "land 20.0 %", "plates      2 on the map", "hills rock", "unbooked", "bedrock"]
        {
            assert!(text.contains(part), "{part} missing in\n{text}");
        }
        let json = serde_json::to_value(&found).unwrap();
        assert_eq!(json["land_share"], 0.2);
        assert_eq!(json["layers"][0]["layer"], "height");
        let sea = inspect(&World::new(Grid::new(4, 4, 4.0, Edges::Wrap), 10.0));
        assert!(sea.to_string().contains("land 0.0 %"));
    }

    #[test]
    fn numbers_are_short() {
        for (value, text) in
            [(0.0, "0"), (976.5625, "976.562"), (1000.0, "1000"), (-0.25, "-0.25"), (123_456_789.0, "123456789")]
        {
            assert_eq!(short(value), text);
        }
        assert_eq!(short(1.5e12), "1.5000e12");
    }
}
