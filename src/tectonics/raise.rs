//! Raising ranges along closing borders by the Voronoi form of RMP, in several widths at once, and thinning rifts by the
//! same draws.
//!
//! A volume of crust is shared out over the cells of random mosaics that a border crosses: sites set the width, volume the
//! height. Each octave has four times the sites of the one before and a smaller share. A cell takes in proportion to its
//! random weight, to how much of it is covered and to the room it has left, so that ranges which grew thick widen into
//! plateaus. Shares add up to one, so that crust is conserved.

use glam::DVec2;
use rayon::prelude::*;

use crate::{
    noise::Key,
    rmp::{self, Brush},
};

use super::plate::{Plate, Rock};

/// Draws that an octave makes in one step; a run of dozens of steps adds up to what is smooth.
const DRAWS: usize = 1;
/// Thickness below which crust is not stretched further, m.
pub const THINNEST_M: f32 = 8_000.0;

/// Widths and limits of the ranges.
#[derive(Clone, Copy, Debug)]
pub struct Belt {
    /// Half-height half-width of the widest octave, m.
    pub half_width_m: f64,
    /// Octaves.
    pub octaves: u32,
    /// Share of each octave against the one before.
    pub gain: f64,
    /// Thickness that takes no more, m.
    pub thickest_m: f64,
}

/// What is done along a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// Crust is added.
    Thicken,
    /// Crust is taken away.
    Thin,
}

/// A line along which crust is shared out.
#[derive(Clone, Debug)]
pub struct Line {
    /// The border, map metres.
    pub path_m: Vec<DVec2>,
    /// Unit vector towards the side on which the range leans, zero for none.
    pub lean: DVec2,
    /// Distance of the range's front from the border, m.
    pub offset_m: f64,
    /// Plates that take part.
    pub plates: [usize; 2],
    /// What is done.
    pub work: Work,
}

/// The share of the whole that one cell takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// The plate.
    pub plate: usize,
    /// Its cell.
    pub cell: usize,
    /// Share; all shares of a line sum to one.
    pub share: f64,
}

/// Shares one whole out along a line, octaves in parallel; empty if no cell can take any.
pub fn shares(plates: &[Plate], line: &Line, belt: &Belt, key: Key) -> Vec<Share> {
    let octaves: Vec<Vec<Share>> = (0..belt.octaves)
        .into_par_iter()
        .map(|octave| {
            let (mut shares, mut brush) = (Vec::new(), Brush::new());
            let half_width_m = belt.half_width_m / f64::from(1 << octave);
            for draw in 0..DRAWS {
                let key = key.with(octave as u64).with(draw as u64);
                draw_once(plates, line, belt, half_width_m, key, &mut brush, &mut shares);
            }
            let part: f64 = (0..octave).map(|_| belt.gain).product();
            let sum: f64 = shares.iter().map(|s| s.share).sum();
            shares.iter_mut().for_each(|s| s.share *= part / sum);
            shares
        })
        .collect();
    let mut shares = octaves.concat();
    let sum: f64 = shares.iter().map(|s| s.share).sum();
    shares.iter_mut().for_each(|s| s.share /= sum);
    shares
}

fn draw_once(
    plates: &[Plate],
    line: &Line,
    belt: &Belt,
    half_width_m: f64,
    key: Key,
    brush: &mut Brush,
    out: &mut Vec<Share>,
) {
    // Wide octaves lean further in than narrow ones: a steep front at the border, a long back slope.
    let shift = line.lean * (line.offset_m + 0.6 * half_width_m);
    let path: Vec<[f64; 2]> = line.path_m.iter().map(|&p| (p + shift).into()).collect();
    let members = if line.plates[0] == line.plates[1] { &line.plates[..1] } else { &line.plates[..] };
    for cell in rmp::cells_along(&path, rmp::density_for_half_width(half_width_m), key) {
        for &p in members {
            let plate = &plates[p];
            plate.cover(&cell, brush, |index, coverage| {
                let share = cell.weight * coverage * room(&plate.rock[index], belt, line.work);
                if share > 0.0 {
                    out.push(Share { plate: p, cell: index, share });
                }
            });
        }
    }
}

fn room(rock: &Rock, belt: &Belt, work: Work) -> f64 {
    let thickness = rock.thickness_m();
    match work {
        Work::Thicken => (1.0 - thickness / belt.thickest_m).max(0.0),
        Work::Thin => f64::from(rock.kind) * f64::from((rock.crust_m - THINNEST_M).max(0.0)) / 30_000.0,
    }
}

/// A polyline through a cloud of points, along its principal axis, with a vertex every `spacing_m` or so.
pub fn spine(points: &[DVec2], spacing_m: f64) -> Vec<DVec2> {
    let n = points.len() as f64;
    let mean = points.iter().sum::<DVec2>() / n;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for d in points.iter().map(|&p| p - mean) {
        (xx, xy, yy) = (xx + d.x * d.x, xy + d.x * d.y, yy + d.y * d.y);
    }
    let turn = 0.5 * libm::atan2(2.0 * xy, xx - yy);
    let axis = DVec2::new(libm::cos(turn), libm::sin(turn));
    let along = |p: DVec2| (p - mean).dot(axis);
    let (low, high) =
        points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &p| (l.min(along(p)), h.max(along(p))));
    let bins = (((high - low) / spacing_m).ceil() as usize).clamp(1, 200);
    let mut sums = vec![(DVec2::ZERO, 0.0); bins];
    for &p in points {
        let bin = (((along(p) - low) / (high - low).max(1e-9) * bins as f64) as usize).min(bins - 1);
        sums[bin].0 += p;
        sums[bin].1 += 1.0;
    }
    sums.into_iter().filter(|s| s.1 > 0.0).map(|(sum, count)| sum / count).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spine_follows_its_cloud() {
        let cloud: Vec<DVec2> =
            (0..200).map(|i| DVec2::new(i as f64, 0.3 * i as f64 + f64::from(i % 3) - 1.0)).collect();
        let spine = spine(&cloud, 20.0);
        assert!(spine.len() >= 9);
        assert!(spine.iter().all(|p| (p.y - 0.3 * p.x).abs() < 0.8));
        assert!(spine.windows(2).all(|w| w[1].x > w[0].x));
    }
}
