//! A kept timeline: chosen layers of a world at many moments, as arrays along `t` in the world's store.
//!
//! ```text
//! world.zarr/timeline/
//!   t                  the world's clock, years (not necessarily all different)
//!   x  y               as in the store
//!   sea_level_m  stage  step  done
//!   height ...         one array a layer, dimensions (t, y, x); a frame is a shard of its own
//! ```
//!
//! The frames before and after a change of the map's raster are groups of their own: `timeline`, `timeline_2`, ...
//!
//! While a run goes on it is written beside the world, frame by frame; each frame's head is added to `frames.jsonl` after its
//! layers, so that a killed run finds what is whole. [`Recorder::finish`] turns that folder into a group of the store.

use std::{
    fs,
    io::{BufRead, Write},
    path::Path,
};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use zarrs::{
    array::{Array, ArrayBuilder, data_type},
    filesystem::FilesystemStore,
};

use super::{
    StoreError, chunking, locate,
    read::{Reader, damaged},
    write::{Head, Writer, disk, whole_chunks},
};
use crate::{
    grid::{Field, Grid},
    world::{Layer, World},
};

/// The name in a store of the nth group, from 0.
fn group_name(nth: usize) -> String {
    if nth == 0 { "timeline".to_owned() } else { format!("timeline_{}", nth + 1) }
}
/// The list of frames while they are being written.
const FRAMES: &str = "frames.jsonl";
/// The raster of the frames while they are being written.
const RASTER: &str = "grid.json";
/// More frames than any film has.
const MOST_FRAMES: u64 = 1 << 20;

/// Where a kept frame stands in its run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Which of the stages that ran, from 0.
    pub stage: usize,
    /// Steps done in it.
    pub step: u64,
    /// Share of it that is done.
    pub done: f64,
    /// The world's clock, years.
    pub time_yr: f64,
    /// Height of the sea, m.
    pub sea_level_m: f64,
}

/// Writes frames while a world grows.
pub struct Recorder {
    writer: Writer,
    grid: Grid,
    arrays: Vec<(Layer, Array<FilesystemStore>)>,
    frames: Vec<Frame>,
    list: fs::File,
}

impl Recorder {
    /// Records `layers` into a folder. Frames that an earlier run left there are kept up to `until` (stage and step); what
    /// lies behind is forgotten.
    pub fn begin(path: &Path, grid: Grid, layers: &[Layer], until: Option<(usize, u64)>) -> Result<Self, StoreError> {
        let mut frames = if until.is_some() { left_frames(path) } else { Vec::new() };
        frames.retain(|frame| until.is_some_and(|until| (frame.stage, frame.step) <= until));
        if frames.is_empty() && path.exists() {
            fs::remove_dir_all(path).map_err(disk(path))?;
        }
        fs::create_dir_all(path).map_err(disk(path))?;
        let beside = path.join("frames.partial");
        let mut text = Vec::new();
        frames.iter().for_each(|frame| text.extend(line(frame)));
        fs::write(&beside, text).map_err(disk(&beside))?;
        fs::write(path.join(RASTER), json!(grid).to_string()).map_err(disk(path))?;
        let list = path.join(FRAMES);
        fs::rename(&beside, &list).map_err(disk(&list))?;
        let list = fs::OpenOptions::new().append(true).open(&list).map_err(disk(&list))?;
        let mut writer = Writer::new(path)?;
        // How many frames there will be is known at the end.
        let arrays = layers.iter().map(|&layer| Ok((layer, array(&mut writer, grid, layer, MOST_FRAMES)?)));
        let arrays = arrays.collect::<Result<_, StoreError>>()?;
        Ok(Self { writer, grid, arrays, frames, list })
    }

    /// The raster of the frames that a stopped run left in a folder, if there are any.
    pub fn left_grid(path: &Path) -> Option<Grid> {
        serde_json::from_slice(&fs::read(path.join(RASTER)).ok()?).ok()
    }

    /// The raster of its frames.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// The frames so far.
    pub fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// Adds a frame.
    pub fn push(&mut self, world: &World, frame: Frame) -> Result<(), StoreError> {
        let t = self.frames.len() as u64;
        for (layer, array) in &self.arrays {
            // A layer that no process has made yet is empty.
            match world.view(*layer) {
                Some(field) => self.plane(array, t, &field)?,
                None => self.plane(array, t, &Field::filled(self.grid, 0.0))?,
            }
        }
        self.list.write_all(&line(&frame)).map_err(disk(&self.writer.path))?;
        self.frames.push(frame);
        Ok(())
    }

    fn plane(&self, array: &Array<FilesystemStore>, t: u64, field: &Field<f32>) -> Result<(), StoreError> {
        let ((_, high), (_, broad)) = (chunking(self.grid.height as u64), chunking(self.grid.width as u64));
        let (tall, wide) = (high as usize, broad as usize);
        let (down, across) = (self.grid.height.div_ceil(tall), self.grid.width.div_ceil(wide));
        (0..down * across).into_par_iter().try_for_each(|i| {
            let (top, left) = (i / across * tall, i % across * wide);
            let mut values = vec![0.0f32; tall * wide];
            for (y, row) in values.chunks_exact_mut(wide).enumerate().take(self.grid.height - top) {
                for (value, &v) in row.iter_mut().zip(&field.row(top + y)[left..]) {
                    *value = v;
                }
            }
            let at = [t, (i / across) as u64, (i % across) as u64];
            array.store_chunk_opt(&at, values, &whole_chunks()).map_err(|e| self.writer.failed(e))
        })
    }

    /// Makes the frames the nth timeline, from 0, of the store at `world`.
    pub fn finish(mut self, world: &Path, nth: usize) -> Result<(), StoreError> {
        let count = self.frames.len() as u64;
        for (layer, _) in &self.arrays {
            array(&mut self.writer, self.grid, *layer, count)?;
        }
        self.writer.axis(
            "x",
            "X",
            "distance east of the map's north-west corner",
            self.grid.width,
            self.grid.cell_m,
        )?;
        self.writer.axis(
            "y",
            "Y",
            "distance south of the map's north-west corner",
            self.grid.height,
            self.grid.cell_m,
        )?;
        type Part = fn(&Frame) -> f64;
        let columns: [(&str, &str, Part); 5] = [
            ("t", "yr", |frame| frame.time_yr),
            ("sea_level_m", "m", |frame| frame.sea_level_m),
            ("stage", "1", |frame| frame.stage as f64),
            ("step", "1", |frame| frame.step as f64),
            ("done", "1", |frame| frame.done),
        ];
        for (name, unit, part) in columns {
            let values: Vec<f64> = self.frames.iter().map(part).collect();
            let head = Head { node: name, dimensions: &["t"], shape: &[count], attributes: json!({ "units": unit }) };
            self.writer.line(&head, data_type::float64(), 0.0f64, values)?;
        }
        let layers: Vec<&str> = self.arrays.iter().map(|(layer, _)| layer.name()).collect();
        let attributes = json!({ "layers": layers, "grid": self.grid });
        let group = json!({ "zarr_format": 3, "node_type": "group", "attributes": attributes });
        let path = self.writer.path.clone();
        fs::write(path.join("zarr.json"), group.to_string()).map_err(disk(&path))?;
        drop(self.list);
        for list in [FRAMES, RASTER] {
            fs::remove_file(path.join(list)).map_err(disk(&path))?;
        }
        let name = group_name(nth);
        let place = world.join(&name);
        fs::rename(&path, &place).map_err(disk(&place))?;
        let nodes = self.writer.nodes.into_iter().map(|(node, metadata)| (format!("{name}/{node}"), metadata));
        list_nodes(world, nodes.chain([(name.clone(), group)]))
    }
}

/// The array of a layer along `frames` moments.
fn array(writer: &mut Writer, grid: Grid, layer: Layer, frames: u64) -> Result<Array<FilesystemStore>, StoreError> {
    let spec = layer.spec();
    let shape = [frames, grid.height as u64, grid.width as u64];
    let attributes = json!({ "units": spec.unit, "long_name": spec.title });
    let head = Head { node: layer.name(), dimensions: &["t", "y", "x"], shape: &shape, attributes };
    let ((tall, high), (wide, broad)) = (chunking(shape[1]), chunking(shape[2]));
    let mut builder = ArrayBuilder::new(shape.to_vec(), vec![1, high, broad], data_type::float32(), 0.0f32);
    builder.subchunk_shape(vec![1, tall, wide]);
    writer.array(&head, builder)
}

fn line(frame: &Frame) -> Vec<u8> {
    // Finite numbers and nothing else: there is nothing in it that JSON cannot say.
    let mut line = serde_json::to_vec(frame).unwrap_or_default();
    line.push(b'\n');
    line
}

/// The frames that a stopped run wrote whole.
fn left_frames(path: &Path) -> Vec<Frame> {
    let Ok(file) = fs::File::open(path.join(FRAMES)) else { return Vec::new() };
    let lines = std::io::BufReader::new(file).lines();
    lines.map_while(|line| serde_json::from_str(&line.ok()?).ok()).collect()
}

/// Adds nodes to the copy of all metadata in a store's root.
fn list_nodes(world: &Path, nodes: impl Iterator<Item = (String, Value)>) -> Result<(), StoreError> {
    let path = world.join("zarr.json");
    let text = fs::read_to_string(&path).map_err(disk(&path))?;
    let mut root: Value = serde_json::from_str(&text).map_err(|e| damaged(world, e))?;
    let listed = root["consolidated_metadata"]["metadata"].as_object_mut();
    listed.ok_or_else(|| damaged(world, "its metadata is not listed"))?.extend(nodes.collect::<Map<_, _>>());
    let text = serde_json::to_string_pretty(&root).map_err(|e| damaged(world, e))?;
    fs::write(&path, text).map_err(disk(&path))
}

/// Reads a kept timeline.
pub struct Recording {
    reader: Reader,
    parts: Vec<Part>,
    frames: Vec<Frame>,
}

/// Frames on one raster.
struct Part {
    group: String,
    grid: Grid,
    layers: Vec<Layer>,
    /// How many frames there are, and how many before.
    count: usize,
    before: usize,
}

impl Recording {
    /// The timeline of the world at `path`, whose grid is that of its frames where they do not say; `None` where none was
    /// kept.
    pub fn open(path: &Path, grid: Grid) -> Result<Option<Self>, StoreError> {
        let path = locate(path)?;
        let groups: Vec<String> =
            (0..).map(group_name).take_while(|group| path.join(group).join("zarr.json").is_file()).collect();
        if groups.is_empty() {
            return Ok(None);
        }
        let mut recording = Self { reader: Reader::open(path)?, parts: Vec::new(), frames: Vec::new() };
        groups.into_iter().try_for_each(|group| recording.add(group, grid))?;
        Ok(Some(recording))
    }

    fn add(&mut self, group: String, usual: Grid) -> Result<(), StoreError> {
        let reader = &self.reader;
        let attributes = reader.attributes(&group)?;
        let names: Vec<String> = reader.get(&attributes, "layers")?;
        let layers = names.iter().map(|name| {
            Layer::from_name(name).ok_or_else(|| reader.damaged(format!("layer '{name}' is not in the catalogue")))
        });
        let layers = layers.collect::<Result<_, _>>()?;
        let grid = if attributes.contains_key("grid") { reader.get(&attributes, "grid")? } else { usual };
        if !(grid.width > 0 && grid.height > 0 && grid.cell_m.is_finite() && grid.cell_m > 0.0) {
            return Err(reader.damaged(format!("{group}: {} x {} cells of {} m", grid.width, grid.height, grid.cell_m)));
        }
        let column = |name: &str| -> Result<Vec<f64>, StoreError> {
            let node = format!("{group}/{name}");
            reader.line(&node, &reader.array(&node)?)
        };
        let [time, sea, stage, step, done] =
            [column("t")?, column("sea_level_m")?, column("stage")?, column("step")?, column("done")?];
        if [&sea, &stage, &step, &done].iter().any(|column| column.len() != time.len()) {
            return Err(reader.damaged("the timeline's columns differ in length"));
        }
        self.parts.push(Part { group, grid, layers, count: time.len(), before: self.frames.len() });
        self.frames.extend((0..time.len()).map(|i| Frame {
            stage: stage[i] as usize,
            step: step[i] as u64,
            done: done[i],
            time_yr: time[i],
            sea_level_m: sea[i],
        }));
        Ok(())
    }

    /// Where each frame stands.
    pub fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// The layers that were kept.
    pub fn layers(&self) -> &[Layer] {
        self.parts.first().map_or(&[], |part| &part.layers)
    }

    /// The raster of the first frame.
    pub fn first_grid(&self) -> Option<Grid> {
        self.parts.first().map(|part| part.grid)
    }

    /// The world of a frame, as far as it was kept: a kept height stands as bedrock.
    pub fn world(&self, index: usize) -> Result<World, StoreError> {
        let frame = &self.frames[index];
        let at = self.parts.partition_point(|part| part.before <= index) - 1;
        let Part { group, grid, layers, count, before } = &self.parts[at];
        let mut world = World::new(*grid, frame.sea_level_m);
        world.time_yr = frame.time_yr;
        for &layer in layers {
            let node = format!("{group}/{}", layer.name());
            let array = self.reader.array(&node)?;
            let shape = [*count as u64, grid.height as u64, grid.width as u64];
            if array.shape() != shape || *array.data_type() != data_type::float32() {
                return Err(self.reader.damaged(format!("{node}: not the shape or kind that was written")));
            }
            let data = self.reader.plane(&node, &array, &[(index - before) as u64], *grid, |v: f32| v)?;
            let field = Field { grid: *grid, data };
            if let Some((x, y)) = field.first_non_finite() {
                return Err(self.reader.damaged(format!("{node} is not finite at cell ({x}, {y})")));
            }
            match layer {
                Layer::Height => world.set_layer(Layer::Bedrock, field),
                layer if layer.derived() => {}
                // Nothing but zeros: no process had made it yet.
                _ if field.data.iter().all(|&v| v == 0.0) => {}
                layer => world.set_layer(layer, field),
            }
        }
        Ok(world)
    }
}
