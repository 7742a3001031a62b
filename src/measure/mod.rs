//! Numbers about a world: what `inspect` prints and the manifest holds, and how its landscape compares with Earth's.
//!
//! [`inspect`] counts what is there; [`survey`] measures the landscape, and [`METRICS`] says what to read from it and what
//! is found on Earth. Heights decide: routing fills depressions, everything else looks at the ground as it is.
//!
//! This room reads worlds and never changes them, and writes no files. Sums run in f64 in a fixed order.

mod fit;
mod glance;
mod ground;
mod hypsometry;
mod inspect;
mod metric;
mod metrics;
pub mod report;
mod slopes;
mod spread;
mod streams;
mod survey;

pub use fit::{Line, quantile};
pub use ground::{BasinHypsometry, DISC_M, Inversion, LocalRelief, Modes, Pits, Spectra, Spectrum, Variogram};
mod stems;

pub use glance::{Glance, Rates};
pub use hypsometry::{Hypsometry, hypsometry};
pub use inspect::{Books, Inspection, inspect};
pub use metric::{Band, Metric, Missing, Reading, Verdict, short};
pub use metrics::METRICS;
pub use slopes::{Slopes, slopes};
pub use spread::{Spread, readings_text, spreads, spreads_text, tally};
pub use stems::{StemPoint, main_stems};
pub use streams::{Chi, Exceedance, Hack, Horton, OrderRow, SlopeArea, THETA_REF};
pub use survey::{Survey, survey};

use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::{
    grid::{Field, sum_f64},
    world::{Layer, World},
};

/// One layer in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayerStats {
    /// Its name.
    pub layer: String,
    /// The unit of its values.
    pub unit: String,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// Mean value.
    pub mean: f64,
    /// First 16 hexadecimal digits of the SHA-256 of the values' little-endian bytes, row by row from the north.
    pub hash: String,
}

/// The height and every stored layer in numbers, in catalogue order.
pub fn layer_stats(world: &World) -> Vec<LayerStats> {
    let height = world.height();
    std::iter::once((Layer::Height, &height)).chain(world.layers()).map(|(layer, field)| stats(layer, field)).collect()
}

fn stats(layer: Layer, field: &Field<f32>) -> LayerStats {
    let least = |a: f32, b: &f32| a.min(*b);
    let most = |a: f32, b: &f32| a.max(*b);
    LayerStats {
        layer: layer.name().to_owned(),
        unit: layer.spec().unit.to_owned(),
        min: field.data.iter().fold(f32::INFINITY, least) as f64,
        max: field.data.iter().fold(f32::NEG_INFINITY, most) as f64,
        mean: sum_f64(&field.data) / field.data.len() as f64,
        hash: hash(field),
    }
}

fn hash(field: &Field<f32>) -> String {
    let mut digest = Sha256::new();
    if cfg!(target_endian = "little") {
        digest.update(bytemuck::cast_slice::<f32, u8>(&field.data));
    } else {
        field.data.iter().for_each(|v| digest.update(v.to_le_bytes()));
    }
    digest.finalize()[..8].iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    #[test]
    fn layers_are_counted_and_hashed() {
        let grid = Grid::new(2, 1, 2.0, Edges::Open);
        let mut world = World::new(grid, 0.0);
        world.layer_mut(Layer::Bedrock).data.copy_from_slice(&[1.0, -2.0]);
        let stats = layer_stats(&world);
        assert_eq!(stats.iter().map(|s| s.layer.as_str()).collect::<Vec<_>>(), ["height", "bedrock"]);
        assert_eq!((stats[1].min, stats[1].max, stats[1].mean), (-2.0, 1.0, -0.5));
        // printf '\x00\x00\x80\x3f\x00\x00\x00\xc0' | sha256sum
        assert_eq!(stats[1].hash, "ee4ac73c2bd27756");
        assert_eq!(stats[0].hash, stats[1].hash);
    }
}
