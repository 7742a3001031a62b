//! The world on disk: a Zarr v3 group that opens in xarray, and reads back to the same bits.
//!
//! ```text
//! world.zarr/
//!   zarr.json          name, recipe, seed, version, sea level, clock, cell, edges, ledger; consolidated metadata
//!   x  y               centres of the cells in metres, x to the east, y to the south
//!   height bedrock ... one array a layer, dimensions (y, x); height is derived and only for readers
//!   tables/NAME/COLUMN one array a column, dimension row
//!   timeline/          layers along t, where a run was told to keep them; timeline_2 and on after a zoom
//! ```
//!
//! Layers are f32, or integers where the catalogue calls them classes or identities and every value is one. Inner
//! chunks of 256 x 256 cells are compressed with zstd (with its checksum) and packed into shards of up to 1024 x 1024,
//! so that a world has few files and a window of it is still cheap to read. A store is written beside its place and
//! moved there when it is whole.
//!
//! This file and its children alone name zarrs. They know no process.

mod read;
mod said;
mod timeline;
mod write;

pub use read::read;
pub use said::said;
pub use timeline::{Frame, Recorder, Recording};
pub use write::write;

use std::path::{Path, PathBuf};

/// Says in the group's attributes that this is ours.
const FORMAT: &str = "upthrust world";
/// Raised when a store can no longer be read by older builds.
const FORMAT_VERSION: u64 = 1;
/// Side of the chunks that are compressed one by one, cells.
const CHUNK: u64 = 256;
/// Side of the files they are packed into, chunks.
const SHARD_CHUNKS: u64 = 4;

/// Where a world came from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// The recipe's name.
    pub name: String,
    /// The recipe's text.
    pub recipe: String,
    /// The seed.
    pub seed: u64,
    /// Version of the program that grew it.
    pub version: String,
}

/// Why a world could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// A layer has a value that is not a number.
    #[error("layer '{layer}' is not finite at cell ({x}, {y}); the world was not written")]
    NotFinite {
        /// The layer.
        layer: &'static str,
        /// Column of the cell.
        x: usize,
        /// Row of the cell.
        y: usize,
    },
    /// The disk refused.
    #[error("{path}: {}", said(.cause))]
    Disk {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        cause: std::io::Error,
    },
    /// The store could not be written.
    #[error("{path}: cannot write the world: {cause}")]
    Write {
        /// The store.
        path: PathBuf,
        /// What went wrong.
        cause: String,
    },
    /// There is no store.
    #[error("{0}: no world here (expected a world.zarr, or the folder that 'upthrust grow' made)")]
    Absent(PathBuf),
    /// The store is something else's.
    #[error("{0}: a Zarr store, but not a world that upthrust wrote")]
    Foreign(PathBuf),
    /// The store was written by a later version.
    #[error("{path}: written by a newer upthrust ({version}); update to read it")]
    Newer {
        /// The store.
        path: PathBuf,
        /// The version that wrote it.
        version: String,
    },
    /// The store is damaged.
    #[error("{path}: the world is damaged: {cause}; grow it again")]
    Damaged {
        /// The store.
        path: PathBuf,
        /// What is wrong.
        cause: String,
    },
}

/// The store at `path`: itself, or `world.zarr` in that folder.
fn locate(path: &Path) -> Result<PathBuf, StoreError> {
    [path.to_owned(), path.join("world.zarr")]
        .into_iter()
        .find(|p| p.join("zarr.json").is_file())
        .ok_or_else(|| StoreError::Absent(path.to_owned()))
}

/// Chunks along a side of `size` cells, and cells along a side of a chunk and of a shard.
fn chunking(size: u64) -> (u64, u64) {
    let chunk = size.clamp(1, CHUNK);
    let shard = chunk * size.div_ceil(chunk).clamp(1, SHARD_CHUNKS);
    (chunk, shard)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        grid::{Edges, Field, Grid},
        world::{Clocks, Layer, Matter, Table, World},
    };

    fn sample(width: usize, height: usize) -> (World, Provenance) {
        let grid = Grid::new(width, height, 1e6 / 3.0, Edges::Wrap);
        let mut world = World::new(grid, -0.1 - 0.2);
        world.time_yr = 1e7 / 3.0;
        let at = |x: usize, y: usize| ((x * 7919 + y * 104_729) % 65_521) as f32;
        world.set_layer(Layer::Bedrock, Field::from_fn(grid, |x, y| at(x, y) / 7.0 - 4000.0));
        world.set_layer(Layer::PlateId, Field::from_fn(grid, |x, y| (x / 5 + y / 5) as f32 - 1.0));
        world.set_layer(Layer::BoundaryKind, Field::from_fn(grid, |x, y| (at(x, y) as i32 % 5) as f32));
        world.set_layer(Layer::Hardness, Field::filled(grid, 0.0));
        world.set_table(
            Table::new("plates")
                .number("speed_mm_per_yr", "mm/yr", vec![0.1 + 0.2, f64::MIN_POSITIVE, -1e300])
                .text("style", vec!["Nazca".into(), String::new(), "düne \"q\"".into()])
                .number("id", "1", vec![0.0, 1.0, 2.0]),
        );
        world.set_table(Table::new("vents").number("x_km", "km", vec![]));
        world.ledger.open("plates", Matter::Rock, 1.0 / 3.0);
        world.ledger.book_in("plates", Matter::Rock, 1e17 / 7.0);
        world.ledger.book_out("plates", Matter::Crust, 0.1);
        world.ledger.close("plates", Matter::Rock, 2.0 / 3.0);
        world.ledger.set_clocks("storm", Clocks { water_s: 1e4 / 3.0, morphological_factor: 0.1 });
        let provenance = Provenance {
            name: "Test".into(),
            recipe: "seed = 1\n# \"ü\"\n".into(),
            seed: u64::MAX,
            version: "0.1.0".into(),
        };
        (world, provenance)
    }

    #[test]
    fn a_world_reads_back_to_the_same_bits() {
        let folder = tempfile::tempdir().unwrap();
        for (width, height) in [(1, 1), (70, 41), (300, 1100)] {
            let path = folder.path().join("world.zarr");
            let (world, provenance) = sample(width, height);
            write(&world, &provenance, &path).unwrap();
            let (back, from) = read(&path).unwrap();
            assert_eq!(from, provenance);
            assert_eq!(back, world);
            let bits =
                |w: &World| w.layer(Layer::Bedrock).unwrap().data.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&back), bits(&world));
            assert_eq!(read(folder.path()).unwrap().0, world, "the folder around it serves too");
        }
        let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(left, ["world.zarr"], "nothing is left beside it");
    }

    #[test]
    fn values_that_are_no_integers_survive_in_an_integer_layer() {
        let folder = tempfile::tempdir().unwrap();
        let (mut world, provenance) = sample(8, 8);
        world.layer_mut(Layer::PlateId).data[3] = 1e9;
        world.layer_mut(Layer::BoundaryKind).data[3] = 0.5;
        write(&world, &provenance, folder.path().join("w").as_path()).unwrap();
        assert_eq!(read(&folder.path().join("w")).unwrap().0, world);
    }

    #[test]
    fn same_world_same_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let (world, provenance) = sample(70, 41);
        for name in ["a", "b"] {
            write(&world, &provenance, &folder.path().join(name)).unwrap();
        }
        for file in ["zarr.json", "bedrock/zarr.json", "bedrock/c/0/0", "tables/plates/style/c/0"] {
            let bytes = ["a", "b"].map(|name| std::fs::read(folder.path().join(name).join(file)).unwrap());
            assert!(bytes[0] == bytes[1], "{file}");
        }
    }

    #[test]
    fn what_is_wrong_is_said_in_one_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("world.zarr");
        let line = |path: &Path| {
            let message = read(path).unwrap_err().to_string();
            assert!(!message.contains('\n'), "{message}");
            message
        };
        assert!(line(&path).contains("no world here"));
        let (world, provenance) = sample(300, 41);
        let put = |file: &str, bytes: &[u8]| {
            write(&world, &provenance, &path).unwrap();
            std::fs::write(path.join(file), bytes).unwrap();
        };
        put("zarr.json", b"{ garbage");
        assert!(line(&path).contains("damaged"));
        put("zarr.json", br#"{"zarr_format":3,"node_type":"group","attributes":{"title":"ERA5"}}"#);
        assert!(line(&path).contains("not a world"));
        put("bedrock/zarr.json", b"\0\xff");
        assert!(line(&path).contains("bedrock"));
        put("bedrock/c/0/0", b"short");
        assert!(line(&path).contains("bedrock"));

        write(&world, &provenance, &path).unwrap();
        let shard = path.join("bedrock/c/0/0");
        let mut bytes = std::fs::read(&shard).unwrap();
        bytes[1000] ^= 0x10;
        std::fs::write(&shard, bytes).unwrap();
        assert!(line(&path).contains("bedrock"), "one flipped bit is found");

        write(&world, &provenance, &path).unwrap();
        std::fs::remove_file(&shard).unwrap();
        assert!(line(&path).contains("bedrock"), "a missing shard is not read as zeros");

        write(&world, &provenance, &path).unwrap();
        let json = std::fs::read_to_string(path.join("zarr.json")).unwrap();
        put("zarr.json", json.replace("\"format_version\": 1", "\"format_version\": 99").as_bytes());
        assert!(line(&path).contains("newer"));
    }

    #[test]
    fn a_bad_cell_is_refused_and_the_old_world_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("world.zarr");
        let (mut world, provenance) = sample(8, 8);
        write(&world, &provenance, &path).unwrap();
        let good = world.clone();
        world.layer_mut(Layer::Bedrock).data[10] = f32::NAN;
        let message = write(&world, &provenance, &path).unwrap_err().to_string();
        assert!(message.contains("bedrock") && message.contains("(2, 1)"), "{message}");
        assert_eq!(read(&path).unwrap().0, good);
    }
}
