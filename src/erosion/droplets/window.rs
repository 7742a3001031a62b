//! A map cut into windows. In a phase each window belongs to one thread, which runs the droplets in it one after
//! another on its own copy of the ground; a droplet that comes too near to a cut waits for the next phase, which cuts
//! elsewhere.
//!
//! So droplets see what those before them have done, never touch what another thread works on, and it does not matter
//! how many threads there are.

use crate::grid::{Edges, Grid};

use super::{
    ground::Ground,
    walk::{Droplet, End},
};

/// Side of a window, cells: small enough for a core's own cache, much wider than what droplets keep from a cut.
pub const SIDE: usize = 128;

/// One piece of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Piece {
    /// First cell.
    pub from: usize,
    /// Cells.
    pub size: usize,
    /// Whether its ends are the map's rim.
    pub rim: [bool; 2],
}

/// An axis of `size` cells cut into pieces, the first cut `offset` (0 to 1) of a window from its beginning.
pub fn cut(size: usize, edges: Edges, offset: f64) -> Vec<Piece> {
    if edges == Edges::Wrap {
        let count = (size / SIDE).max(1);
        let shift = (offset * size as f64) as usize;
        let place = |k: usize| k * size / count;
        return (0..count)
            .map(|k| Piece { from: (shift + place(k)) % size, size: place(k + 1) - place(k), rim: [false; 2] })
            .collect();
    }
    let mut cuts = vec![0];
    if 2 * size > 3 * SIDE {
        let first = 1 + (offset * (SIDE - 1) as f64) as usize;
        cuts.extend((first..size).step_by(SIDE));
    }
    cuts.push(size);
    cuts.windows(2)
        .map(|pair| Piece { from: pair[0], size: pair[1] - pair[0], rim: [pair[0] == 0, pair[1] == size] })
        .collect()
}

/// The piece that each cell of an axis belongs to.
pub fn owners(pieces: &[Piece], size: usize) -> Vec<usize> {
    let mut owners = vec![0; size];
    for (k, piece) in pieces.iter().enumerate() {
        for i in 0..piece.size {
            owners[(piece.from + i) % size] = k;
        }
    }
    owners
}

/// A piece of the map that one thread works on.
#[derive(Default)]
pub struct Window {
    /// Its columns and rows.
    pub pieces: [Piece; 2],
    /// Its ground.
    pub ground: Ground,
    /// Droplets to run.
    pub queue: Vec<Droplet>,
    /// Droplets that came near to a cut.
    pub later: Vec<Droplet>,
    /// What ended with a load: the cell on the map, and m of rock on it.
    pub rest: Vec<(usize, f64)>,
    /// What left over the rim, m of a cell.
    pub left: f64,
    /// Steps taken.
    pub steps: u64,
}

impl Window {
    /// Makes it another piece of the map, of which nothing has been copied.
    pub fn shut(&mut self, pieces: [Piece; 2]) {
        self.pieces = pieces;
        self.ground.loaded = 0..0;
    }

    /// Writes row `y` of the map back, where it is one of the window's and a droplet came near, and adds what passed.
    pub fn close(&self, grid: &Grid, y: usize, row: &mut [f32], passed: &mut [f32]) {
        let [columns, rows] = self.pieces;
        let local = (y + grid.height - rows.from) % grid.height;
        if self.ground.loaded.contains(&local) {
            let of = self.ground.framed(0, local);
            for (at, from, size) in runs(columns, grid.width) {
                row[from..][..size].copy_from_slice(&self.ground.change[of + at..][..size]);
                let own = &self.ground.passed[local * self.ground.columns + at..][..size];
                passed[from..][..size].iter_mut().zip(own).for_each(|(all, own)| *all += own);
            }
        }
    }

    /// Takes the end of a droplet.
    pub fn book(&mut self, end: End, at: [f32; 2], load: f64, grid: &Grid) {
        match end {
            End::Left => self.left += load,
            End::Still if load == 0.0 => {}
            End::Still => {
                let [columns, rows] = self.pieces;
                let cell =
                    |v: f32, piece: Piece, size: usize| (piece.from + ((v + 0.5) as usize).min(piece.size - 1)) % size;
                let i = grid.index(cell(at[0], columns, grid.width), cell(at[1], rows, grid.height));
                self.rest.push((i, load));
            }
        }
    }
}

/// The one or two runs of a piece on a row of the map: where in the piece, where on the map, how many cells.
pub fn runs(piece: Piece, size: usize) -> impl Iterator<Item = (usize, usize, usize)> {
    let first = piece.size.min(size - piece.from);
    [(0, piece.from, first), (first, 0, piece.size - first)].into_iter().filter(|run| run.2 > 0)
}

/// A place on the map as one in a window, from its first cell's centre.
pub fn local(pieces: [Piece; 2], at: [f64; 2], grid: &Grid) -> [f32; 2] {
    let of = |k: usize, size: usize| {
        let local = at[k] - pieces[k].from as f64;
        (if local < 0.0 { local + size as f64 } else { local }) as f32
    };
    [of(0, grid.width), of(1, grid.height)]
}

/// A place in a window as one on the map.
pub fn global(pieces: [Piece; 2], at: [f32; 2], grid: &Grid) -> [f64; 2] {
    let of = |k: usize, size: usize| {
        let global = at[k] as f64 + pieces[k].from as f64;
        if global >= size as f64 { global - size as f64 } else { global }
    };
    [of(0, grid.width), of(1, grid.height)]
}
