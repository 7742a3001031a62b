//! Who owns what after the plates have moved: where two overlap one gives way, where none is new crust is made.
//!
//! Rigid plates can neither bend nor grow, so ownership carries subduction, collision and spreading. A cell is exchanged
//! only where an overlap or a gap is at least three cells wide: narrower ones come from two rasters lying askew, and would
//! gnaw at every border on every step.

use glam::DVec2;
use rayon::prelude::*;

use crate::grid::for_each_row;

use super::{
    domain::Domain,
    plate::{Plate, Rock},
};

/// No plate.
pub const NONE: u8 = u8::MAX;

/// Which plate wins where two overlap.
#[derive(Clone, Debug, PartialEq)]
pub struct Polarity {
    /// Rank among continents: the larger rank stays on top.
    pub continental: Vec<f64>,
    /// Rank among ocean floors: the larger (younger) rank stays on top.
    pub oceanic: Vec<f64>,
}

impl Polarity {
    /// Fixed when the run begins: of two continents the larger overrides, of two ocean floors the younger.
    pub fn of(plates: &[Plate]) -> Self {
        let mut polarity = Self { continental: Vec::new(), oceanic: Vec::new() };
        for plate in plates {
            let (mut land, mut sea, mut born) = (0.0, 0.0, 0.0);
            for (_, rock) in plate.owned.iter().zip(&plate.rock).filter(|(own, _)| **own) {
                land += rock.kind as f64;
                sea += 1.0 - rock.kind as f64;
                born += (1.0 - rock.kind as f64) * rock.born_myr as f64;
            }
            polarity.continental.push(land);
            polarity.oceanic.push(if sea > 0.0 { born / sea } else { 0.0 });
        }
        polarity
    }

    /// Whether rock `a` of plate `pa` stays on top of rock `b` of plate `pb`: continent over ocean, then by rank.
    pub fn wins(&self, pa: usize, a: &Rock, pb: usize, b: &Rock) -> bool {
        let (land_a, land_b) = (a.kind > 0.5, b.kind > 0.5);
        if land_a != land_b {
            return land_a;
        }
        let rank = if land_a { &self.continental } else { &self.oceanic };
        rank[pa].total_cmp(&rank[pb]).then(pb.cmp(&pa)).is_gt()
    }
}

/// Owners of every tectonic cell.
#[derive(Clone, Debug, Default)]
pub struct Owners {
    /// The plate on top, `NONE` in a gap.
    pub top: Vec<u8>,
    /// The plate below it, `NONE` where there is no overlap.
    pub below: Vec<u8>,
}

/// Reads the owners off the plates, rows in parallel.
pub fn compose(domain: &Domain, plates: &[Plate], polarity: &Polarity) -> Owners {
    let n = domain.cells;
    let bounds: Vec<[DVec2; 2]> = plates.iter().map(Plate::bounds_m).collect();
    let mut pairs = vec![(NONE, NONE); n * n];
    for_each_row(&mut pairs, n, |y, row| {
        let mut near = Vec::with_capacity(plates.len());
        for (block, cells) in row.chunks_mut(BLOCK).enumerate() {
            let x = block * BLOCK;
            let (first, last) = (domain.cell_center_m(x, y), domain.cell_center_m(x + cells.len() - 1, y));
            near.clear();
            near.extend(plates.iter().enumerate().zip(&bounds).filter_map(|((p, plate), [low, high])| {
                let meets = low.y <= first.y && high.y >= first.y && low.x <= last.x && high.x >= first.x;
                meets.then(|| Track::new(p, plate, first, domain.cell_m()))
            }));
            for (x, cell) in cells.iter_mut().enumerate() {
                *cell = owners_at(x as f64, &near, polarity);
            }
        }
    });
    let (top, below) = pairs.into_iter().unzip();
    Owners { top, below }
}

/// Cells of a row that are composed with one list of plates.
const BLOCK: usize = 32;

/// A row of the square as a plate's raster sees it: a straight line in evenly spaced steps.
struct Track<'a> {
    index: usize,
    plate: &'a Plate,
    first: DVec2,
    step: DVec2,
}

impl<'a> Track<'a> {
    fn new(index: usize, plate: &'a Plate, first_m: DVec2, cell_m: f64) -> Self {
        let at = |m: DVec2| plate.frame.to_cells(plate.pose.to_body(m));
        let first = at(first_m);
        Self { index, plate, first, step: at(first_m + DVec2::X * cell_m) - first }
    }

    fn owned(&self, x: f64) -> Option<usize> {
        self.plate.frame.cell_at(self.first + self.step * x).filter(|&i| self.plate.owned[i])
    }
}

fn owners_at(x: f64, near: &[Track], polarity: &Polarity) -> (u8, u8) {
    let mut top: Option<(&Track, usize)> = None;
    let mut below = NONE;
    for track in near {
        let Some(i) = track.owned(x) else { continue };
        let p = track.index;
        match top {
            Some((q, j)) if !polarity.wins(p, &track.plate.rock[i], q.index, &q.plate.rock[j]) => below = p as u8,
            Some((q, _)) => (top, below) = (Some((track, i)), q.index as u8),
            None => top = Some((track, i)),
        }
    }
    (top.map_or(NONE, |(track, _)| track.index as u8), below)
}

/// Cells of a mask that lie within one cell of a 3 x 3 block wholly inside it: slivers removed.
fn opened(n: usize, mask: &[bool]) -> Vec<bool> {
    let inside = |x: usize, y: usize, all: bool, of: &[bool]| {
        let (xs, ys) = (x.saturating_sub(1)..=(x + 1).min(n - 1), y.saturating_sub(1)..=(y + 1).min(n - 1));
        let mut cells = ys.flat_map(|j| xs.clone().map(move |i| of[j * n + i]));
        if all { cells.all(|v| v) } else { cells.any(|v| v) }
    };
    let mut core = vec![false; n * n];
    for_each_row(&mut core, n, |y, row| {
        for (x, v) in row.iter_mut().enumerate() {
            *v = mask[y * n + x] && inside(x, y, true, mask);
        }
    });
    let mut open = vec![false; n * n];
    for_each_row(&mut open, n, |y, row| {
        for (x, v) in row.iter_mut().enumerate() {
            *v = mask[y * n + x] && inside(x, y, false, &core);
        }
    });
    open
}

/// A cell that gave way.
#[derive(Clone, Copy, Debug)]
pub struct Lost {
    /// The plate below.
    pub loser: usize,
    /// The plate on top of it.
    pub winner: usize,
    /// Where, map metres.
    pub at_m: DVec2,
    /// What was lost.
    pub rock: Rock,
}

/// Takes from every plate the cells that lie under another one; returned by plate and cell.
pub fn consume(domain: &Domain, plates: &mut [Plate], owners: &Owners) -> Vec<Lost> {
    let n = domain.cells;
    let overlapped: Vec<bool> = owners.below.iter().map(|&b| b != NONE).collect();
    if !overlapped.contains(&true) {
        return Vec::new();
    }
    let contested = opened(n, &overlapped);
    let mut under: Vec<Vec<usize>> = vec![Vec::new(); plates.len()];
    for w in (0..n * n).filter(|&w| contested[w]) {
        under[owners.below[w] as usize].push(w);
    }
    let lost: Vec<Vec<Lost>> = plates
        .par_iter_mut()
        .enumerate()
        .map(|(p, plate)| {
            // A third plate below two others waits until they have settled.
            let mut lost = Vec::new();
            for cell in cells_around(domain, plate, &under[p]).filter(|&cell| plate.owned[cell]).collect::<Vec<_>>() {
                let at_m = plate.center_m(cell);
                let below = |w: &usize| contested[*w] && owners.below[*w] == p as u8;
                if let Some(w) = cell_index(domain, at_m).filter(below) {
                    lost.push(Lost { loser: p, winner: owners.top[w] as usize, at_m, rock: plate.give(cell) });
                }
            }
            lost
        })
        .collect();
    lost.into_iter().flatten().collect()
}

/// Cells of a plate's raster in the box around these tectonic cells.
fn cells_around(domain: &Domain, plate: &Plate, around: &[usize]) -> impl Iterator<Item = usize> + use<> {
    let n = domain.cells;
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for &w in around {
        let at = plate.frame.to_cells(plate.pose.to_body(domain.cell_center_m(w % n, w / n)));
        (low, high) = (low.min(at), high.max(at));
    }
    let (width, height) = (plate.frame.width, plate.frame.height);
    let range =
        |from: f64, to: f64, size: usize| (from - 1.0).max(0.0) as usize..((to + 2.0).max(0.0) as usize).min(size);
    let (xs, ys) = (range(low.x, high.x, width), range(low.y, high.y, height));
    ys.flat_map(move |y| xs.clone().map(move |x| y * width + x))
}

/// The tectonic cell under a point of the map.
pub fn cell_index(domain: &Domain, at_m: DVec2) -> Option<usize> {
    let at = domain.to_cells(at_m);
    let n = domain.cells as f64;
    (at.x >= 0.0 && at.y >= 0.0 && at.x < n && at.y < n).then(|| at.y as usize * domain.cells + at.x as usize)
}

/// A gap cell and the plate beside it.
#[derive(Clone, Copy, Debug)]
pub struct Gap {
    /// The tectonic cell.
    pub cell: usize,
    /// The plate whose rim is nearest.
    pub plate: usize,
    /// The nearest rim's tectonic cell.
    pub rim: usize,
}

/// The gaps that are wide enough to be real, in cell order.
pub fn gaps(domain: &Domain, owners: &Owners) -> Vec<Gap> {
    let n = domain.cells;
    let empty: Vec<bool> = owners.top.iter().map(|&t| t == NONE).collect();
    if !empty.contains(&true) {
        return Vec::new();
    }
    let open = opened(n, &empty);
    let cells: Vec<usize> = (0..n * n).filter(|&i| open[i]).collect();
    cells.into_par_iter().filter_map(|cell| nearest_rim(n, &owners.top, cell)).collect()
}

/// Searches growing squares around a gap cell for the nearest rim.
fn nearest_rim(n: usize, top: &[u8], cell: usize) -> Option<Gap> {
    const REACH: isize = 8;
    let (cx, cy) = ((cell % n) as isize, (cell / n) as isize);
    let mut nearest: Option<(isize, usize)> = None;
    for radius in 1..=REACH {
        // Cells of this ring are at least `radius` away.
        if nearest.is_some_and(|(distance2, _)| distance2 < radius * radius) {
            break;
        }
        for dy in -radius..=radius {
            let step = if dy.abs() == radius { 1 } else { 2 * radius };
            let mut dx = -radius;
            while dx <= radius {
                let (x, y) = (cx + dx, cy + dy);
                if x >= 0 && y >= 0 && x < n as isize && y < n as isize {
                    let i = (y * n as isize + x) as usize;
                    let candidate = (dx * dx + dy * dy, i);
                    if top[i] != NONE && nearest.is_none_or(|best| candidate < best) {
                        nearest = Some(candidate);
                    }
                }
                dx += step;
            }
        }
    }
    nearest.map(|(_, rim)| Gap { cell, plate: top[rim] as usize, rim })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slivers_are_not_exchanged() {
        let n = 12;
        let mut mask = vec![false; n * n];
        for y in 0..n {
            mask[y * n + 2] = true;
            mask[y * n + 3] = true;
            for x in 6..10 {
                mask[y * n + x] = true;
            }
        }
        let open = opened(n, &mask);
        for y in 0..n {
            assert!(!open[y * n + 2] && !open[y * n + 3]);
            assert!((6..10).all(|x| open[y * n + x]));
        }
    }

    #[test]
    fn a_gap_belongs_to_the_nearer_rim() {
        let n = 16;
        let mut top = vec![0u8; n * n];
        for y in 0..n {
            for x in 5..n {
                top[y * n + x] = if x < 11 { NONE } else { 1 };
            }
        }
        let gap = nearest_rim(n, &top, 8 * n + 6).unwrap();
        assert_eq!((gap.plate, gap.rim), (0, 8 * n + 4));
        let gap = nearest_rim(n, &top, 8 * n + 9).unwrap();
        assert_eq!((gap.plate, gap.rim), (1, 8 * n + 11));
    }
}
