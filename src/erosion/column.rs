//! The column of rock under a solver: read as one height in `f64`, written back layer by layer, and booked.
//!
//! What wears away is taken from the sediment first, then from lava, then from bedrock; what is laid down is sediment. A
//! change below what the layers can hold waits in `rest`, which belongs to the solver's state.

use rayon::prelude::*;

use crate::{
    grid::{Field, Grid, for_each_row, sum_f64},
    world::{Layer, Matter, World},
};

/// What the layers of the column could not hold yet, m.
#[derive(Clone, Debug)]
pub(super) struct Column {
    rest: Field<f32>,
}

/// The layers a step changes, taken out of the world while it does.
struct Layers {
    bedrock: Field<f32>,
    lava: Option<Field<f32>>,
    sediment: Field<f32>,
    wear: Field<f32>,
    deposit: Field<f32>,
}

impl Column {
    /// With nothing waiting.
    pub(super) fn new(grid: Grid) -> Self {
        Self { rest: Field::filled(grid, 0.0) }
    }

    /// From a saved state.
    pub(super) fn restored(rest: Field<f32>) -> Self {
        Self { rest }
    }

    /// To be saved.
    pub(super) fn rest(&self) -> &Field<f32> {
        &self.rest
    }

    /// Reads the height of the ground, m.
    pub(super) fn read(&self, world: &World, height_m: &mut Vec<f64>) {
        height_m.clear();
        height_m.extend(self.rest.data.iter().map(|&v| v as f64));
        for part in Layer::COLUMN.iter().filter_map(|&layer| world.layer(layer)) {
            for_each_row(height_m, world.grid.width, |y, row| {
                for (h, &v) in row.iter_mut().zip(part.row(y)) {
                    *h += v as f64;
                }
            });
        }
    }

    /// Writes the ground back; what was lifted joins the bedrock. Books what came in by uplift and left over the rim, both
    /// in m³.
    pub(super) fn write(&mut self, world: &mut World, change: &Change, stage: &str) {
        let stock = world.rock_m3();
        let mut take = |layer: Layer| {
            world.layer_mut(layer);
            world.remove_layer(layer).unwrap_or_else(|| Field::filled(world.grid, 0.0))
        };
        let mut layers = Layers {
            bedrock: take(Layer::Bedrock),
            lava: None,
            sediment: take(Layer::Sediment),
            wear: take(Layer::Wear),
            deposit: take(Layer::Deposit),
        };
        layers.lava = world.remove_layer(Layer::Lava);
        let waited = sum_f64(&self.rest.data);
        self.spread(&mut layers, change);
        let waiting = (sum_f64(&self.rest.data) - waited) * world.grid.cell_area_m2();
        for (layer, field) in [
            (Layer::Bedrock, layers.bedrock),
            (Layer::Sediment, layers.sediment),
            (Layer::Wear, layers.wear),
            (Layer::Deposit, layers.deposit),
        ] {
            world.set_layer(layer, field);
        }
        if let Some(lava) = layers.lava {
            world.set_layer(Layer::Lava, lava);
        }
        // What waits has not come in or left yet.
        let booked = change.lifted_m3 - change.left_m3 - waiting;
        let stored = world.rock_m3() - stock;
        // The sum over a whole world is good to some 1e-13 of it. Within that, what is there decides.
        let agrees = (stored - booked).abs() <= 1e-12 * stock.abs().max(world.rock_m3().abs());
        let gained = if agrees { stored } else { booked };
        for gained in [change.lifted_m3, gained - change.lifted_m3] {
            if gained >= 0.0 {
                world.ledger.book_in(stage, Matter::Rock, gained);
            } else {
                world.ledger.book_out(stage, Matter::Rock, -gained);
            }
        }
    }

    fn spread(&mut self, layers: &mut Layers, change: &Change) {
        let width = self.rest.grid.width.max(1);
        let lava: Vec<Option<&mut [f32]>> = match &mut layers.lava {
            Some(lava) => lava.data.chunks_mut(width).map(Some).collect(),
            None => (0..self.rest.grid.height).map(|_| None).collect(),
        };
        (layers.bedrock.data.par_chunks_mut(width), layers.sediment.data.par_chunks_mut(width), lava)
            .into_par_iter()
            .zip((
                layers.wear.data.par_chunks_mut(width),
                layers.deposit.data.par_chunks_mut(width),
                self.rest.data.par_chunks_mut(width),
            ))
            .enumerate()
            .for_each(|(y, ((bedrock, sediment, mut lava), (wear, deposit, rest)))| {
                for x in 0..bedrock.len() {
                    let molten = lava.as_ref().map_or(0.0, |lava| lava[x]);
                    let (raised, height) = change.ground.at(y * width + x, [rest[x], bedrock[x], molten, sediment[x]]);
                    let gained = height - raised;
                    let mut frozen = molten;
                    if gained > 0.0 {
                        sediment[x] = (sediment[x] as f64 + gained) as f32;
                        deposit[x] = (deposit[x] as f64 + gained) as f32;
                    } else if gained < 0.0 {
                        let loose = (sediment[x] as f64).min(-gained).max(0.0);
                        sediment[x] = (sediment[x] as f64 - loose) as f32;
                        let taken = (molten as f64).min(-gained - loose).max(0.0);
                        frozen = (molten as f64 - taken) as f32;
                        wear[x] = (wear[x] as f64 - gained) as f32;
                    }
                    if let Some(lava) = &mut lava {
                        lava[x] = frozen;
                    }
                    let solid = height - (sediment[x] as f64 + frozen as f64);
                    bedrock[x] = solid as f32;
                    rest[x] = (solid - bedrock[x] as f64) as f32;
                }
            });
    }
}

/// What a step did.
pub(super) struct Change<'a> {
    /// The ground.
    pub(super) ground: Ground<'a>,
    /// Came in by uplift, m³.
    pub(super) lifted_m3: f64,
    /// Left the map, m³.
    pub(super) left_m3: f64,
}

/// What a step did to the ground.
pub(super) enum Ground<'a> {
    /// Its heights by uplift alone and after all, m.
    Heights([&'a [f64]; 2]),
    /// What all steps so far have changed it by, before this one and after it, m: no map of heights is needed.
    Changes([&'a [f32]; 2]),
}

impl Ground<'_> {
    /// Heights of a cell by uplift alone and after all, m; `column` is what it was made of, in the order of
    /// [`Column::read`].
    #[inline]
    fn at(&self, i: usize, column: [f32; 4]) -> (f64, f64) {
        match self {
            Self::Heights([raised, height]) => (raised[i], height[i]),
            Self::Changes([before, after]) => {
                let raised = column.into_iter().map(f64::from).reduce(|sum, part| sum + part).unwrap_or(0.0);
                (raised, raised + (f64::from(after[i]) - f64::from(before[i])))
            }
        }
    }
}
