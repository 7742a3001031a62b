//! Where the samples of an export lie on the map, and how they are shared out to tiles.

use crate::{
    export::{
        engine::Engine,
        raster::{Lattice, Raster, Sampling, Window},
    },
    world::World,
};

use super::{
    JobError,
    names::{Part, Sheet},
    order::{Order, refuse},
};

/// Most samples along a side of an export, all tiles together; they are held in memory.
const MOST_SIDE: usize = 16_385;
/// The map program's window has about as many points.
const AZGAAR_SIDE: usize = 2048;

/// Where the samples lie.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// All samples.
    pub lattice: Lattice,
    /// Tiles along a side; 1 for a single file.
    pub tiles: usize,
    /// Samples along a side of a tile.
    pub tile_side: usize,
}

impl Place {
    /// Columns and rows of the tiles, row by row from the north-west.
    pub fn tiles(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let tiles = self.tiles;
        (0..tiles * tiles).map(move |i| (i % tiles, i / tiles))
    }

    /// The samples of one tile.
    pub fn tile(&self) -> Lattice {
        if self.tiles == 1 { self.lattice } else { self.lattice.part(0, 0, self.tile_side, self.tile_side) }
    }

    /// The middles of the quads between vertices.
    pub fn quads(&self) -> Lattice {
        let [width, height] = [self.lattice.width - 1, self.lattice.height - 1];
        Lattice { width, height, sampling: Sampling::Cells, ..self.lattice }
    }

    /// `[x, y, width, height]` of a tile's samples in a sheet's raster.
    pub fn samples(&self, sheet: &Sheet, (x, y): (usize, usize), raster: &Raster) -> [usize; 4] {
        let quads = self.tile_side - 1;
        match (self.tiles, sheet.part) {
            (1, _) => [0, 0, raster.lattice.width, raster.lattice.height],
            // Quads belong to one tile, vertices on a border to both.
            (_, Part::FourChannels) => [x * quads, y * quads, quads, quads],
            _ => [x * quads, y * quads, self.tile_side, self.tile_side],
        }
    }
}

/// Finds the place, or says why there is none.
pub fn find(order: &Order, world: &World) -> Result<Place, JobError> {
    let (request, grid) = (order.request, &world.grid);
    if let Some(window) = request.window {
        check_window(window, world)?;
    }
    let vertices = request.tiles.is_some() || request.engine.is_some_and(|engine| engine != Engine::Azgaar);
    if vertices && request.window.is_none() && grid.width != grid.height {
        let short_km = grid.extent_m()[0].min(grid.extent_m()[1]) / 1000.0;
        let what = if request.tiles.is_some() { "--tiles" } else { "--engine" };
        return refuse(format!("{what} needs a square map; cut one with --window 0,0,{short_km}"));
    }
    let wide_m = request.window.map_or(grid.extent_m()[0].max(grid.extent_m()[1]), |window| window.size_m);
    let cells = ((wide_m / grid.cell_m).round() as usize).max(1);
    if !vertices {
        let side = match (request.size, request.engine) {
            (Some(size), _) => size,
            (None, Some(Engine::Azgaar)) => cells.min(AZGAAR_SIDE),
            (None, _) => cells,
        };
        check_side(side, 1, request.size)?;
        let untouched = request.window.is_none() && side == grid.width.max(grid.height);
        let lattice =
            if untouched { Lattice::cells(grid) } else { Lattice::over(grid, request.window, side, Sampling::Cells) };
        return Ok(Place { lattice, tiles: 1, tile_side: side });
    }
    let tiles = request.tiles.unwrap_or(1);
    let natural = cells / tiles + 1;
    let tile_side =
        request.size.unwrap_or_else(|| request.engine.map_or(natural.max(2), |engine| fitting(engine, natural, tiles)));
    let side = (tile_side - 1) * tiles + 1;
    check_side(side, tiles, request.size)?;
    let lattice = Lattice::over(grid, request.window, side, Sampling::Vertices);
    Ok(Place { lattice, tiles, tile_side })
}

/// The engine's nearest size of which so many tiles can be held.
fn fitting(engine: Engine, natural: usize, tiles: usize) -> usize {
    let most = (MOST_SIDE - 1) / tiles + 1;
    let near = engine.nearest_size(natural);
    let sizes = engine.demands().sizes.iter().copied().filter(|&size| size <= most.min(near));
    sizes.max().unwrap_or(near)
}

fn check_side(side: usize, tiles: usize, asked: Option<usize>) -> Result<(), JobError> {
    if side <= MOST_SIDE {
        return Ok(());
    }
    let what = asked.map_or(String::new(), |size| format!("--size {size}: "));
    let all = if tiles > 1 { format!(" in {tiles} tiles a side") } else { String::new() };
    refuse(format!("{what}{side} samples a side{all} are too many; at most {MOST_SIDE} are"))
}

/// Refuses a window that does not lie on the map.
pub fn check_window(window: Window, world: &World) -> Result<(), JobError> {
    let [wide_m, high_m] = world.grid.extent_m();
    let Window { x_m, y_m, size_m } = window;
    let shown = format!("--window {},{},{}", x_m / 1000.0, y_m / 1000.0, size_m / 1000.0);
    // A hair's breadth is rounding of kilometres.
    let hair_m = 1e-9 * wide_m.max(high_m);
    if size_m <= 0.0 {
        return refuse(format!("{shown}: the size must be above 0 km"));
    }
    if x_m < 0.0 || y_m < 0.0 || x_m + size_m > wide_m + hair_m || y_m + size_m > high_m + hair_m {
        let (wide_km, high_km) = (wide_m / 1000.0, high_m / 1000.0);
        return refuse(format!("{shown}: reaches beyond the map, which is {wide_km} x {high_km} km"));
    }
    if size_m < world.grid.cell_m {
        return refuse(format!("{shown}: smaller than one cell of {} km", world.grid.cell_m / 1000.0));
    }
    Ok(())
}
