//! Writing a world.

use std::{
    collections::BTreeMap,
    fs, io,
    path::{Path, PathBuf},
    sync::Arc,
};

use rayon::prelude::*;
use serde_json::{Map, Value, json};
use zarrs::{
    array::{
        Array, ArrayBuilder, CodecOptions, Element,
        builder::{ArrayBuilderDataType, ArrayBuilderFillValue},
        codec::ZstdCodec,
        data_type,
    },
    filesystem::FilesystemStore,
    group::GroupBuilder,
};

use super::{FORMAT, FORMAT_VERSION, Provenance, StoreError, chunking};
use crate::{
    grid::Field,
    world::{Kind, Layer, Table, Values, World},
};

/// zstd level: terrain hardly shrinks further at higher ones.
const LEVEL: i32 = 1;

/// Writes `world` to `path`, in place of what was there.
pub fn write(world: &World, provenance: &Provenance, path: &Path) -> Result<(), StoreError> {
    let height = world.height();
    let bad = world.first_non_finite().or_else(|| height.first_non_finite().map(|(x, y)| (Layer::Height, x, y)));
    if let Some((layer, x, y)) = bad {
        return Err(StoreError::NotFinite { layer: layer.name(), x, y });
    }
    let beside = beside(path, "partial");
    remove(&beside)?;
    fs::create_dir_all(&beside).map_err(disk(&beside))?;
    let written = fill(world, &height, provenance, &beside);
    if let Err(error) = written.and_then(|()| replace(path, &beside)) {
        // The first error matters; what cannot be cleaned up stays hidden beside.
        let _ = remove(&beside);
        return Err(error);
    }
    Ok(())
}

/// Moves the finished store to its place; what stood there goes last.
fn replace(path: &Path, finished: &Path) -> Result<(), StoreError> {
    let old = beside(path, "old");
    remove(&old)?;
    if path.exists() {
        fs::rename(path, &old).map_err(disk(path))?;
    }
    fs::rename(finished, path).map_err(disk(path))?;
    remove(&old)
}

fn beside(path: &Path, what: &str) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.{what}-{}", std::process::id()))
}

fn remove(path: &Path) -> Result<(), StoreError> {
    match fs::symlink_metadata(path) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(e) => Err(disk(path)(e)),
        Ok(meta) if meta.is_dir() => fs::remove_dir_all(path).map_err(disk(path)),
        Ok(_) => fs::remove_file(path).map_err(disk(path)),
    }
}

pub(super) fn disk(path: &Path) -> impl Fn(io::Error) -> StoreError + '_ {
    move |cause| StoreError::Disk { path: path.to_owned(), cause }
}

/// A store being filled, and the metadata of all its nodes for the consolidated copy.
pub(super) struct Writer {
    store: Arc<FilesystemStore>,
    pub path: PathBuf,
    pub nodes: BTreeMap<String, Value>,
}

/// What an array says of itself.
pub(super) struct Head<'a> {
    pub node: &'a str,
    pub dimensions: &'a [&'a str],
    pub shape: &'a [u64],
    pub attributes: Value,
}

fn fill(world: &World, height: &Field<f32>, provenance: &Provenance, path: &Path) -> Result<(), StoreError> {
    let mut writer = Writer::new(path)?;
    writer.axis("x", "X", "distance east of the map's north-west corner", world.grid.width, world.grid.cell_m)?;
    writer.axis("y", "Y", "distance south of the map's north-west corner", world.grid.height, world.grid.cell_m)?;
    writer.layer(Layer::Height, height)?;
    for (layer, field) in world.layers() {
        writer.layer(layer, field)?;
    }
    if world.tables().next().is_some() {
        writer.group("tables", Map::new())?;
    }
    for table in world.tables() {
        writer.table(table)?;
    }
    writer.root(world, provenance)
}

impl Writer {
    pub fn new(path: &Path) -> Result<Self, StoreError> {
        let store = FilesystemStore::new(path)
            .map_err(|e| StoreError::Write { path: path.to_owned(), cause: e.to_string() })?;
        Ok(Self { store: Arc::new(store), path: path.to_owned(), nodes: BTreeMap::new() })
    }

    pub fn failed(&self, cause: impl std::fmt::Display) -> StoreError {
        StoreError::Write { path: self.path.clone(), cause: cause.to_string() }
    }

    pub fn axis(&mut self, name: &str, axis: &str, title: &str, cells: usize, cell_m: f64) -> Result<(), StoreError> {
        let centres: Vec<f64> = (0..cells).map(|i| (i as f64 + 0.5) * cell_m).collect();
        let attributes = json!({ "units": "m", "long_name": title, "axis": axis });
        let head = Head { node: name, dimensions: &[name], shape: &[cells as u64], attributes };
        self.line(&head, data_type::float64(), 0.0f64, centres)
    }

    fn layer(&mut self, layer: Layer, field: &Field<f32>) -> Result<(), StoreError> {
        let spec = layer.spec();
        let mut attributes = json!({ "units": spec.unit, "long_name": spec.title, "derived": layer.derived() });
        if let Kind::Class(names) = spec.kind {
            attributes["flag_values"] = (0..names.len()).collect();
            attributes["flag_meanings"] = names.join(" ").into();
        }
        let shape = [field.grid.height as u64, field.grid.width as u64];
        let head = Head { node: layer.name(), dimensions: &["y", "x"], shape: &shape, attributes };
        let whole = |low: f32, high: f32| {
            // A negative zero would come back positive.
            field.data.iter().all(|&v| v >= low && v <= high && v.fract() == 0.0 && (v != 0.0 || v.is_sign_positive()))
        };
        match spec.kind {
            Kind::Class(_) if whole(0.0, 255.0) => self.plane(&head, data_type::uint8(), field, |v| v as u8),
            Kind::Id if whole(-32768.0, 32767.0) => self.plane(&head, data_type::int16(), field, |v| v as i16),
            _ => self.plane(&head, data_type::float32(), field, |v| v),
        }
    }

    fn table(&mut self, table: &Table) -> Result<(), StoreError> {
        let group = format!("tables/{}", table.name);
        let columns: Vec<&str> = table.columns.iter().map(|c| c.name.as_str()).collect();
        self.group(&group, Map::from_iter([("columns".to_owned(), json!(columns))]))?;
        for column in &table.columns {
            let node = format!("{group}/{}", column.name);
            let shape = [column.values.len() as u64];
            let attributes = json!({ "units": column.unit });
            let head = Head { node: &node, dimensions: &["row"], shape: &shape, attributes };
            match &column.values {
                Values::Number(v) => self.line(&head, data_type::float64(), 0.0f64, v.clone())?,
                Values::Text(v) => self.line(&head, data_type::string(), "", v.clone())?,
            }
        }
        Ok(())
    }

    fn group(&mut self, node: &str, attributes: Map<String, Value>) -> Result<(), StoreError> {
        let mut group = GroupBuilder::new();
        group.attributes(attributes);
        let group = group.build(self.store.clone(), &format!("/{node}")).map_err(|e| self.failed(e))?;
        group.store_metadata().map_err(|e| self.failed(e))?;
        let metadata = serde_json::to_value(group.metadata()).map_err(|e| self.failed(e))?;
        self.nodes.insert(node.to_owned(), metadata);
        Ok(())
    }

    /// A one-dimensional array, in one chunk.
    pub fn line<T: Element>(
        &mut self,
        head: &Head,
        kind: impl Into<ArrayBuilderDataType>,
        fill: impl Into<ArrayBuilderFillValue>,
        values: Vec<T>,
    ) -> Result<(), StoreError> {
        let chunk = [head.shape[0].max(1)];
        let array = self.array(head, ArrayBuilder::new(head.shape.to_vec(), chunk.to_vec(), kind, fill))?;
        if values.is_empty() {
            return Ok(());
        }
        array.store_chunk_opt(&[0], values, &whole_chunks()).map_err(|e| self.failed(e))
    }

    /// A layer: shards in parallel, those over the rim padded with zeros.
    fn plane<T: Element + Copy + Default + Send + Sync + Into<ArrayBuilderFillValue>>(
        &mut self,
        head: &Head,
        kind: impl Into<ArrayBuilderDataType>,
        field: &Field<f32>,
        convert: impl Fn(f32) -> T + Sync,
    ) -> Result<(), StoreError> {
        let (chunk, shard): (Vec<u64>, Vec<u64>) = head.shape.iter().map(|&size| chunking(size)).unzip();
        let mut builder = ArrayBuilder::new(head.shape.to_vec(), shard.clone(), kind, T::default());
        builder.subchunk_shape(chunk);
        let array = self.array(head, builder)?;
        let across = head.shape[1].div_ceil(shard[1]);
        let (tall, wide) = (shard[0] as usize, shard[1] as usize);
        (0..head.shape[0].div_ceil(shard[0]) * across).into_par_iter().try_for_each(|i| {
            let at = [i / across, i % across];
            let (top, left) = (at[0] as usize * tall, at[1] as usize * wide);
            let mut values = vec![T::default(); tall * wide];
            for (y, row) in values.chunks_exact_mut(wide).enumerate().take(field.grid.height - top) {
                for (value, &v) in row.iter_mut().zip(&field.row(top + y)[left..]) {
                    *value = convert(v);
                }
            }
            array.store_chunk_opt(&at, values, &whole_chunks()).map_err(|e| self.failed(e))
        })
    }

    pub fn array(&mut self, head: &Head, mut builder: ArrayBuilder) -> Result<Array<FilesystemStore>, StoreError> {
        if let Value::Object(attributes) = &head.attributes {
            builder.attributes(attributes.clone());
        }
        builder
            .dimension_names(Some(head.dimensions.iter().copied()))
            .bytes_to_bytes_codecs(vec![Arc::new(ZstdCodec::new(LEVEL, true))]);
        let array = builder.build(self.store.clone(), &format!("/{}", head.node)).map_err(|e| self.failed(e))?;
        array.store_metadata().map_err(|e| self.failed(e))?;
        let metadata = serde_json::to_value(array.metadata()).map_err(|e| self.failed(e))?;
        self.nodes.insert(head.node.to_owned(), metadata);
        Ok(array)
    }

    /// The group over all, written last, with a copy of every node's metadata so that readers open one file.
    fn root(&mut self, world: &World, provenance: &Provenance) -> Result<(), StoreError> {
        let ledger: Vec<Value> = world
            .ledger
            .accounts()
            .map(|(stage, matter, account)| json!({ "stage": stage, "matter": matter, "account": account }))
            .collect();
        let clocks: Map<String, Value> =
            world.ledger.all_clocks().map(|(stage, clocks)| (stage.to_owned(), json!(clocks))).collect();
        let root = json!({
            "zarr_format": 3,
            "node_type": "group",
            "attributes": {
                "format": FORMAT,
                "format_version": FORMAT_VERSION,
                "name": provenance.name,
                "recipe": provenance.recipe,
                "seed": provenance.seed,
                "version": provenance.version,
                "size": [world.grid.width, world.grid.height],
                "cell_m": world.grid.cell_m,
                "edges": world.grid.edges,
                "sea_level_m": world.sea_level_m,
                "time_yr": world.time_yr,
                "layers": world.layers().map(|(layer, _)| layer.name()).collect::<Vec<_>>(),
                "tables": world.tables().map(|table| table.name.as_str()).collect::<Vec<_>>(),
                "ledger": ledger,
                "clocks": clocks,
            },
            "consolidated_metadata": { "kind": "inline", "must_understand": false, "metadata": self.nodes },
        });
        let text = serde_json::to_string_pretty(&root).map_err(|e| self.failed(e))?;
        fs::write(self.path.join("zarr.json"), text).map_err(disk(&self.path))
    }
}

/// Chunks of nothing but zeros are stored too, so that a missing file is a damaged world.
pub(super) fn whole_chunks() -> CodecOptions {
    CodecOptions::default().with_store_empty_chunks(true)
}
