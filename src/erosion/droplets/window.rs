//! A map cut into windows. In a phase each window belongs to one thread, which runs the droplets in it one after
//! another on its own copy of the ground; a droplet that comes too near to a cut waits for the next phase, which cuts
//! elsewhere.
//!
//! So droplets see what those before them have done, never touch what another thread works on, and it does not matter
//! how many threads there are.

use crate::grid::{Edges, Grid};

use super::{
    super::bed::Bed,
    walk::{Droplet, End},
};

/// Side of a window, cells: small enough for a core's own cache, much wider than what droplets keep from a cut.
pub const SIDE: usize = 128;

/// One piece of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
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

/// The ground in a window, with a frame around it in which nothing changes.
#[derive(Default)]
pub struct Ground {
    /// Heights at the start, m.
    pub start: Vec<f32>,
    /// Changes, m.
    pub change: Vec<f32>,
    /// Shares of the rates; 0 in the frame.
    pub rate: Vec<f32>,
    /// Cells in a row with the frame.
    pub stride: usize,
    frame: usize,
    /// The sea, m.
    pub sea_m: f32,
    /// Whether land stays land, and sea sea.
    pub locked: bool,
}

impl Ground {
    /// Index of a cell of the window.
    #[inline(always)]
    pub fn framed(&self, x: usize, y: usize) -> usize {
        (y + self.frame) * self.stride + x + self.frame
    }

    /// Height of a cell, m.
    #[inline(always)]
    fn height(&self, i: usize) -> f32 {
        self.start[i] + self.change[i]
    }

    /// Height and fall (m a cell, to the east and to the south) between the cells around a point.
    #[inline(always)]
    pub fn sample(&self, at: [f32; 2], most: [usize; 2]) -> (f32, [f32; 2]) {
        let [x, y] = [(at[0] as usize).min(most[0]), (at[1] as usize).min(most[1])];
        let [across, down] = [at[0] - x as f32, at[1] - y as f32];
        let i = self.framed(x, y);
        let [a, b] = [self.height(i), self.height(i + 1)];
        let [c, d] = [self.height(i + self.stride), self.height(i + self.stride + 1)];
        let fall = [(b - a) + ((d - c) - (b - a)) * down, (c - a) + ((d - b) - (c - a)) * across];
        let [north, south] = [a + (b - a) * across, c + (d - c) * across];
        (north + (south - north) * down, fall)
    }
}

/// A piece of the map that one thread works on.
#[derive(Default)]
pub struct Window {
    /// Its columns and rows.
    pub pieces: Option<[Piece; 2]>,
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
    /// Copies the ground from the bed.
    pub fn open(&mut self, bed: &Bed, frame: usize) {
        let Some([columns, rows]) = self.pieces else { return };
        let ground = &mut self.ground;
        (ground.stride, ground.frame) = (columns.size + 2 * frame, frame);
        (ground.sea_m, ground.locked) = (bed.sea_m, bed.locked);
        let cells = ground.stride * (rows.size + 2 * frame);
        for data in [&mut ground.start, &mut ground.change, &mut ground.rate] {
            data.clear();
            data.resize(cells, 0.0);
        }
        for y in 0..rows.size {
            let row = (rows.from + y) % bed.grid.height * bed.grid.width;
            let to = ground.framed(0, y);
            for (at, from, size) in runs(columns, bed.grid.width) {
                ground.start[to + at..][..size].copy_from_slice(&bed.start[row + from..][..size]);
                ground.change[to + at..][..size].copy_from_slice(&bed.change[row + from..][..size]);
                let rate = &mut ground.rate[to + at..][..size];
                match bed.rate.get(row + from..row + from + size) {
                    Some(of) => rate.copy_from_slice(of),
                    None => rate.fill(1.0),
                }
            }
        }
    }

    /// Writes row `y` of the map back, where it is one of the window's.
    pub fn close(&self, grid: &Grid, y: usize, row: &mut [f32]) {
        let Some([columns, rows]) = self.pieces else { return };
        let local = (y + grid.height - rows.from) % grid.height;
        if local < rows.size {
            let of = self.ground.framed(0, local);
            for (at, from, size) in runs(columns, grid.width) {
                row[from..][..size].copy_from_slice(&self.ground.change[of + at..][..size]);
            }
        }
    }

    /// Takes the end of a droplet.
    #[inline(always)]
    pub fn book(&mut self, end: End, at: [f32; 2], load: f64, grid: &Grid) {
        match end {
            End::Left => self.left += load,
            End::Still if load == 0.0 => {}
            End::Still => {
                let Some([columns, rows]) = self.pieces else { return };
                let cell =
                    |v: f32, piece: Piece, size: usize| (piece.from + ((v + 0.5) as usize).min(piece.size - 1)) % size;
                let i = grid.index(cell(at[0], columns, grid.width), cell(at[1], rows, grid.height));
                self.rest.push((i, load));
            }
        }
    }
}

/// The one or two runs of a piece on a row of the map: where in the piece, where on the map, how many cells.
fn runs(piece: Piece, size: usize) -> impl Iterator<Item = (usize, usize, usize)> {
    let first = piece.size.min(size - piece.from);
    [(0, piece.from, first), (first, 0, piece.size - first)].into_iter().filter(|run| run.2 > 0)
}
