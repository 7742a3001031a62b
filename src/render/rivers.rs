//! Rivers as a raster finer than the map's: at each place how near the middle of the nearest river is, and how wide it is there.
//! A picture can then draw each as wide as it is, or as a pixel needs.

use rayon::prelude::*;

use super::ground::{Lie, byte};
use crate::world::{Table, World};

/// Texels of a cell's side, and most of the raster's.
const FINER: usize = 4;
const MOST: usize = 4096;
/// Rows of texels that are filled as one.
const BAND: usize = 64;

/// Where rivers run.
pub struct Rivers {
    /// Texels a side.
    pub size: [usize; 2],
    /// Nearness to a river's middle (1 on it, 0 at the reach of [`Lie::river_reach_m`] and beyond), and half its width
    /// in shares of that reach; 255 is one.
    pub texels: Vec<[u8; 2]>,
}

/// A stretch of a river, texels.
#[derive(Clone, Copy)]
struct Stretch {
    from: [f32; 2],
    to: [f32; 2],
    /// Half the width at both ends, in shares of the reach.
    half: [f32; 2],
}

impl Rivers {
    /// Those of a world, as many as a map of this size may have in a texture of `most` texels a side.
    pub fn of(world: &World, lie: &Lie, most: usize) -> Option<Self> {
        let table = world.table("rivers")?;
        let [w, h] = [world.grid.width, world.grid.height];
        let finer = (MOST.min(most) / w.max(h)).clamp(1, FINER);
        let size = [w * finer, h * finer];
        let texel_m = lie.cell_m / finer as f64;
        let stretches = stretches(table, texel_m, lie.river_reach_m())?;
        let reach = ((lie.river_reach_m() / texel_m) as f32).max(2.0);
        let mut rows: Vec<Vec<u32>> = vec![Vec::new(); size[1].div_ceil(BAND)];
        for (k, stretch) in stretches.iter().enumerate() {
            let ends = [stretch.from[1], stretch.to[1]];
            let low = (ends[0].min(ends[1]) - reach).max(0.0) as usize / BAND;
            let high = (ends[0].max(ends[1]) + reach).max(0.0) as usize / BAND;
            let last = rows.len() - 1;
            rows[low.min(last)..=high.min(last)].iter_mut().for_each(|row| row.push(k as u32));
        }
        let mut texels = vec![[0u8; 2]; size[0] * size[1]];
        texels.par_chunks_mut(size[0] * BAND).zip(&rows).enumerate().for_each(|(band, (texels, row))| {
            for &k in row {
                stretches[k as usize].stamp(texels, size[0], band * BAND, reach);
            }
        });
        Some(Self { size, texels })
    }
}

fn stretches(table: &Table, texel_m: f64, reach_m: f64) -> Option<Vec<Stretch>> {
    let column = |name: &str| table.numbers(name);
    let (river, x, y, width) = (column("river")?, column("x_km")?, column("y_km")?, column("width_m")?);
    let place = |k: usize| [x[k], y[k]].map(|km| (km * 1000.0 / texel_m) as f32);
    let half = |k: usize| (0.5 * width[k] / reach_m).min(1.0) as f32;
    let all = (1..river.len()).filter(|&k| river[k] == river[k - 1]).map(|k| Stretch {
        from: place(k - 1),
        to: place(k),
        half: [half(k - 1), half(k)],
    });
    let all: Vec<_> = all.filter(|s| s.from.iter().chain(&s.to).all(|v| v.is_finite())).collect();
    (!all.is_empty()).then_some(all)
}

impl Stretch {
    /// Marks the texels of a band that begins at row `top`.
    fn stamp(&self, texels: &mut [[u8; 2]], width: usize, top: usize, reach: f32) {
        let rows = texels.len() / width;
        let span = |axis: usize, base: usize, size: usize| {
            let (low, high) = (self.from[axis].min(self.to[axis]), self.from[axis].max(self.to[axis]));
            let cut = |v: f32| (v - base as f32).clamp(0.0, size as f32) as usize;
            cut(low - reach)..cut(high + reach + 1.0)
        };
        let along = [self.to[0] - self.from[0], self.to[1] - self.from[1]];
        let square = (along[0] * along[0] + along[1] * along[1]).max(1e-6);
        for y in span(1, top, rows) {
            for x in span(0, 0, width) {
                let p = [x as f32 + 0.5 - self.from[0], (y + top) as f32 + 0.5 - self.from[1]];
                let t = ((p[0] * along[0] + p[1] * along[1]) / square).clamp(0.0, 1.0);
                let off = [p[0] - t * along[0], p[1] - t * along[1]];
                let near = 1.0 - (off[0] * off[0] + off[1] * off[1]).sqrt() / reach;
                if near > 0.0 {
                    let out = &mut texels[y * width + x];
                    let half = self.half[0] + (self.half[1] - self.half[0]) * t;
                    // A wide river keeps its width where a brook joins it.
                    *out = [out[0].max(byte(near)), out[1].max(byte(half))];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        grid::{Edges, Field, Grid},
        render::ground::Rasters,
        scene::SceneParams,
        world::Layer,
    };

    fn raster(width_m: Vec<f64>, y_km: Vec<f64>) -> (Rivers, Lie) {
        let grid = Grid::new(64, 64, 64_000.0, Edges::Open);
        let mut world = World::new(grid, 0.0);
        world.set_layer(Layer::Bedrock, Field::filled(grid, 100.0));
        let lie = Rasters::new(&world, &SceneParams::default()).unwrap().lie;
        let count = width_m.len();
        world.set_table(
            Table::new("rivers")
                .number("river", "1", vec![1.0; count])
                .number("x_km", "km", (0..count).map(|k| 10.0 + 40.0 * k as f64 / (count - 1) as f64).collect())
                .number("y_km", "km", y_km)
                .number("width_m", "m", width_m),
        );
        (Rivers::of(&world, &lie, 8192).unwrap(), lie)
    }

    #[test]
    fn nearness_falls_with_the_distance_to_the_middle() {
        let (rivers, lie) = raster(vec![40.0; 5], vec![32.0; 5]);
        assert_eq!(rivers.size, [256, 256]);
        let texel_m = 250.0;
        let reach = f64::max(lie.river_reach_m() / texel_m, 2.0);
        for y in 120..136 {
            let away = (y as f64 + 0.5 - 128.0).abs();
            let want = (1.0 - away / reach).max(0.0);
            let got = f64::from(rivers.texels[y * 256 + 120][0]) / 255.0;
            // Half a step of eight bits.
            assert!((got - want).abs() <= 0.5 / 255.0 + 1e-6, "{y}: {got} {want}");
        }
        // Nothing before its head and beyond its mouth.
        assert!(rivers.texels[128 * 256 + 30] == [0, 0] && rivers.texels[128 * 256 + 210] == [0, 0]);
    }

    #[test]
    fn it_widens_downstream() {
        let (rivers, lie) = raster(vec![20.0, 60.0, 100.0], vec![20.0, 32.0, 44.0]);
        let half = |x: usize, y: usize| f64::from(rivers.texels[y * 256 + x][1]) / 255.0 * lie.river_reach_m();
        // Its ends and its middle, texels.
        let [head, middle, mouth] = [half(41, 81), half(120, 128), half(199, 175)];
        assert!(
            (head - 10.0).abs() < 0.6 && (middle - 30.0).abs() < 0.6 && (mouth - 50.0).abs() < 0.6,
            "{head} {middle} {mouth}"
        );
    }

    #[test]
    fn a_world_without_rivers_has_no_raster() {
        let grid = Grid::new(8, 8, 800.0, Edges::Open);
        let (_, lie) = raster(vec![1.0; 2], vec![1.0; 2]);
        assert!(Rivers::of(&World::new(grid, 0.0), &lie, 8192).is_none());
    }
}
