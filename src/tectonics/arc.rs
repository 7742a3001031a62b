//! Volcanic arcs: where a slab has sunk deep enough, volcanoes stand along a line inland of the trench.
//!
//! Sites of volcanoes are fixed in the plate that carries them, on a jittered lattice, so that an arc grows the same cones
//! step after step and goes extinct with them when the trench moves on.

use glam::DVec2;

use crate::{
    noise::Key,
    rmp::{self, Brush},
};

use super::{
    plate::Plate,
    raise::Share,
    stretch::{Meeting, Stretch},
};

/// Distances and widths of an arc.
#[derive(Clone, Copy, Debug)]
pub struct Arc {
    /// From trench to arc, m.
    pub offset_m: f64,
    /// Between volcanoes, m.
    pub spacing_m: f64,
}

impl Arc {
    /// Where a stretch has its arc, if one plate sinks there.
    pub fn line(&self, stretch: &Stretch) -> Option<[DVec2; 2]> {
        let inland_m = stretch.inland * self.offset_m;
        (stretch.meeting == Meeting::Subduction).then(|| stretch.ends_m.map(|end| end + inland_m))
    }
}

/// The height each cell gains where a stretch raises volcanoes by `height_m` at their peaks.
pub fn cones(
    plate: &Plate,
    stretch: &Stretch,
    arc: &Arc,
    height_m: f64,
    key: Key,
    site_key: Key,
    brush: &mut Brush,
) -> Vec<Share> {
    let Some(line) = arc.line(stretch) else { return Vec::new() };
    let half_width_m = (0.12 * arc.spacing_m).max(1.2 * plate.frame.cell_m);
    let density = rmp::density_for_half_width(half_width_m);
    let mut gains = Vec::new();
    for (site, at_m, strength) in sites_near(plate, line, arc, site_key) {
        for cell in rmp::cells_along(&[at_m.into()], density, key.with(site)) {
            plate.cover(&cell, brush, |index, coverage| {
                gains.push(Share { plate: stretch.over, cell: index, share: height_m * strength * coverage });
            });
        }
    }
    gains
}

/// Where a stretch has volcanoes now: a key and the place of each.
pub fn volcanoes(plate: &Plate, stretch: &Stretch, arc: &Arc, site_key: Key) -> Vec<(u64, DVec2)> {
    let line = arc.line(stretch);
    let sites = line.map(|line| sites_near(plate, line, arc, site_key)).unwrap_or_default();
    sites.into_iter().map(|(site, at_m, _)| (site, at_m)).collect()
}

/// Volcano sites within a third of a spacing of a line: key, place and strength of each.
fn sites_near(plate: &Plate, line: [DVec2; 2], arc: &Arc, key: Key) -> Vec<(u64, DVec2, f64)> {
    let pitch = 0.6 * arc.spacing_m;
    let ends = line.map(|end| plate.pose.to_body(end));
    let (low, high) = (ends[0].min(ends[1]) - pitch, ends[0].max(ends[1]) + pitch);
    let range = |a: f64, b: f64| (a / pitch).floor() as i32..=(b / pitch).floor() as i32;
    let mut sites = Vec::new();
    for j in range(low.y, high.y) {
        for i in range(low.x, high.x) {
            let hash = key.lattice(i, j);
            let mut stream = key.with(hash).stream();
            let at = DVec2::new(i as f64 + stream.unit(), j as f64 + stream.unit()) * pitch;
            let strength = stream.between(0.3, 1.0);
            let axis = ends[1] - ends[0];
            let along = ((at - ends[0]).dot(axis) / axis.length_squared().max(1.0)).clamp(0.0, 1.0);
            if at.distance(ends[0] + axis * along) < arc.spacing_m / 4.0 {
                sites.push((hash, plate.pose.to_map(at), strength));
            }
        }
    }
    sites
}
