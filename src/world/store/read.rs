//! Reading a world.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::Arc,
};

use rayon::prelude::*;
use serde::{Deserialize, de::DeserializeOwned};
use serde_json::{Map, Value};
use zarrs::{
    array::{Array, ElementOwned, data_type},
    filesystem::FilesystemStore,
    group::Group,
};

use super::{FORMAT, FORMAT_VERSION, Provenance, StoreError, locate};
use crate::{
    grid::{Edges, Field, Grid},
    world::{Account, Clocks, Column, Layer, Ledger, Matter, Table, Values, World},
};

/// More cells than any world has; a damaged size must not ask for all memory.
const MOST_CELLS: usize = 1 << 31;

/// Reads the world at `path`, or in the folder `path`.
pub fn read(path: &Path) -> Result<(World, Provenance), StoreError> {
    let path = locate(path)?;
    let reader = Reader::open(path)?;
    let attributes = reader.attributes("")?;
    reader.check_format(&attributes)?;
    let provenance = Provenance {
        name: reader.get(&attributes, "name")?,
        recipe: reader.get(&attributes, "recipe")?,
        seed: reader.get(&attributes, "seed")?,
        version: reader.get(&attributes, "version")?,
    };
    let [width, height]: [usize; 2] = reader.get(&attributes, "size")?;
    let cell_m: f64 = reader.get(&attributes, "cell_m")?;
    let edges: Edges = reader.get(&attributes, "edges")?;
    let sane = width > 0 && height > 0 && width.checked_mul(height).is_some_and(|n| n <= MOST_CELLS);
    if !(sane && cell_m.is_finite() && cell_m > 0.0) {
        return Err(reader.damaged(format!("size {width} x {height} with cells of {cell_m} m")));
    }
    let grid = Grid { width, height, cell_m, edges };
    let mut world = World::new(grid, reader.get(&attributes, "sea_level_m")?);
    world.time_yr = reader.get(&attributes, "time_yr")?;
    world.ledger = reader.ledger(&attributes)?;
    for name in reader.get::<Vec<String>>(&attributes, "layers")? {
        let layer = Layer::from_name(&name)
            .filter(|layer| !layer.derived())
            .ok_or_else(|| reader.damaged(format!("layer '{name}' is not in the catalogue")))?;
        world.set_layer(layer, reader.layer(&name, grid)?);
    }
    for name in reader.get::<Vec<String>>(&attributes, "tables")? {
        world.set_table(reader.table(&name)?);
    }
    Ok((world, provenance))
}

pub(super) fn damaged(path: &Path, cause: impl std::fmt::Display) -> StoreError {
    // Errors from below may span lines; the user gets one.
    let cause = cause.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    StoreError::Damaged { path: path.to_owned(), cause }
}

pub(super) struct Reader {
    store: Arc<FilesystemStore>,
    pub path: PathBuf,
}

impl Reader {
    pub fn open(path: PathBuf) -> Result<Self, StoreError> {
        let store = FilesystemStore::new(&path).map_err(|e| damaged(&path, e))?;
        Ok(Self { store: Arc::new(store), path })
    }

    pub fn damaged(&self, cause: impl std::fmt::Display) -> StoreError {
        damaged(&self.path, cause)
    }

    pub fn attributes(&self, node: &str) -> Result<Map<String, Value>, StoreError> {
        let group = Group::open(self.store.clone(), &format!("/{node}"))
            .map_err(|e| self.damaged(format!("{}: {e}", if node.is_empty() { "zarr.json" } else { node })))?;
        Ok(group.attributes().clone())
    }

    pub fn get<T: DeserializeOwned>(&self, attributes: &Map<String, Value>, name: &str) -> Result<T, StoreError> {
        let value = attributes.get(name).ok_or_else(|| self.damaged(format!("the attribute '{name}' is missing")))?;
        T::deserialize(value).map_err(|e| self.damaged(format!("the attribute '{name}': {e}")))
    }

    fn check_format(&self, attributes: &Map<String, Value>) -> Result<(), StoreError> {
        if attributes.get("format").and_then(Value::as_str) != Some(FORMAT) {
            return Err(StoreError::Foreign(self.path.clone()));
        }
        let version: u64 = self.get(attributes, "format_version")?;
        if version > FORMAT_VERSION {
            let version = self.get(attributes, "version")?;
            return Err(StoreError::Newer { path: self.path.clone(), version });
        }
        Ok(())
    }

    fn ledger(&self, attributes: &Map<String, Value>) -> Result<Ledger, StoreError> {
        #[derive(Deserialize)]
        struct Entry {
            stage: String,
            matter: Matter,
            account: Account,
        }
        let mut ledger = Ledger::default();
        for Entry { stage, matter, account } in self.get::<Vec<Entry>>(attributes, "ledger")? {
            ledger.open(&stage, matter, account.start_m3);
            ledger.book_in(&stage, matter, account.came_in_m3);
            ledger.book_out(&stage, matter, account.left_m3);
            ledger.close(&stage, matter, account.end_m3);
        }
        // Stores that were written before there were any lack them.
        if attributes.contains_key("clocks") {
            let clocks: BTreeMap<String, Clocks> = self.get(attributes, "clocks")?;
            clocks.into_iter().for_each(|(stage, clocks)| ledger.set_clocks(&stage, clocks));
        }
        Ok(ledger)
    }

    pub fn array(&self, node: &str) -> Result<Array<FilesystemStore>, StoreError> {
        Array::open(self.store.clone(), &format!("/{node}")).map_err(|e| self.damaged(format!("{node}: {e}")))
    }

    fn layer(&self, node: &str, grid: Grid) -> Result<Field<f32>, StoreError> {
        let array = self.array(node)?;
        if array.shape() != [grid.height as u64, grid.width as u64] {
            return Err(self.damaged(format!("{node}: its shape is not that of the world")));
        }
        let kind = array.data_type();
        let data = if *kind == data_type::float32() {
            self.plane(node, &array, &[], grid, |v: f32| v)?
        } else if *kind == data_type::uint8() {
            self.plane(node, &array, &[], grid, |v: u8| v as f32)?
        } else if *kind == data_type::int16() {
            self.plane(node, &array, &[], grid, |v: i16| v as f32)?
        } else {
            return Err(self.damaged(format!("{node}: values of kind {kind}")));
        };
        let field = Field { grid, data };
        match field.first_non_finite() {
            Some((x, y)) => Err(self.damaged(format!("{node} is not finite at cell ({x}, {y})"))),
            None => Ok(field),
        }
    }

    /// The plane of an array at these leading indices.
    pub fn plane<T: ElementOwned + Copy + Send>(
        &self,
        node: &str,
        array: &Array<FilesystemStore>,
        before: &[u64],
        grid: Grid,
        convert: impl Fn(T) -> f32 + Sync,
    ) -> Result<Vec<f32>, StoreError> {
        let failed = |cause: &dyn std::fmt::Display| self.damaged(format!("{node}: {cause}"));
        let place = |row: u64, column: u64| [before, &[row, column]].concat();
        let shard = array.chunk_shape_usize(&place(0, 0)).map_err(|e| failed(&e))?;
        let (tall, wide) = match shard[..] {
            [.., tall, wide] if tall > 0 && wide > 0 => (tall, wide),
            _ => return Err(failed(&"its chunks are not those of a map")),
        };
        if tall.checked_mul(wide).is_none_or(|cells| cells > MOST_CELLS) {
            return Err(failed(&"its chunks are too large"));
        }
        let across = grid.width.div_ceil(wide);
        let mut data = vec![0.0; grid.cells()];
        // One band of shards after the other: its shards are read in parallel, then copied.
        for (band, rows) in data.chunks_mut(tall * grid.width).enumerate() {
            let shards: Vec<Vec<T>> = (0..across)
                .into_par_iter()
                .map(|column| {
                    let at = place(band as u64, column as u64);
                    let values = array.retrieve_chunk_if_exists::<Vec<T>>(&at).map_err(|e| failed(&e))?;
                    values
                        .filter(|values| values.len() == tall * wide)
                        .ok_or_else(|| failed(&format!("chunk {band}/{column} is missing")))
                })
                .collect::<Result<_, _>>()?;
            for (column, values) in shards.iter().enumerate() {
                let left = column * wide;
                for (row, from) in rows.chunks_mut(grid.width).zip(values.chunks_exact(wide)) {
                    for (cell, &v) in row[left..].iter_mut().zip(from) {
                        *cell = convert(v);
                    }
                }
            }
        }
        Ok(data)
    }

    fn table(&self, name: &str) -> Result<Table, StoreError> {
        let group = format!("tables/{name}");
        let attributes = self.attributes(&group)?;
        let mut table = Table::new(name);
        for name in self.get::<Vec<String>>(&attributes, "columns")? {
            let node = format!("{group}/{name}");
            let array = self.array(&node)?;
            let unit = self.get(array.attributes(), "units")?;
            let values = if *array.data_type() == data_type::string() {
                Values::Text(self.line(&node, &array)?)
            } else if *array.data_type() == data_type::float64() {
                Values::Number(self.line(&node, &array)?)
            } else {
                return Err(self.damaged(format!("{node}: values of kind {}", array.data_type())));
            };
            table.columns.push(Column { name, unit, values });
        }
        if table.columns.iter().any(|column| column.values.len() != table.rows()) {
            return Err(self.damaged(format!("{group}: its columns differ in length")));
        }
        Ok(table)
    }

    pub fn line<T: ElementOwned>(&self, node: &str, array: &Array<FilesystemStore>) -> Result<Vec<T>, StoreError> {
        if array.shape() == [0] {
            return Ok(Vec::new());
        }
        let values = array.retrieve_chunk_if_exists::<Vec<T>>(&[0]);
        let values = values.map_err(|e| self.damaged(format!("{node}: {e}")))?;
        values
            .filter(|values| [values.len() as u64] == array.shape())
            .ok_or_else(|| self.damaged(format!("{node}: values are missing")))
    }
}
