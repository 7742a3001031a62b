//! A user's own plates and continents: images stretched over the map, read onto the tectonic raster so that the map,
//! which reads the raster through the warp, shows them where they were drawn.

use std::{collections::BTreeMap, path::Path};

use glam::DVec2;
use image::{GrayImage, RgbImage};

use crate::{grid::Field, process::ProcessError, world::open_picture};

use super::{domain::Domain, exchange::NONE, partition::Polygon, warp::Warp};

/// A colour that covers less than this share of the picture is an edge's blend, not a plate.
const LEAST_SHARE: f64 = 0.004;
/// Most plates a picture may hold.
const MOST_PLATES: usize = 60;

/// The picture of the continents.
pub fn open_continents(path: &str) -> Result<GrayImage, ProcessError> {
    let picture = open_picture(Path::new(path)).map_err(|e| ProcessError::Unfit(format!("continents: {e}")))?;
    Ok(picture.into_luma8())
}

/// Brightness of a picture, 0 to 1, over the square; beyond the map its rim is continued.
pub fn light(domain: &Domain, warp: &Warp, path: &str) -> Result<Field<f32>, ProcessError> {
    let picture = open_continents(path)?;
    Ok(Field::from_fn(domain.grid(), |x, y| {
        let at_m = warp.shown_at(domain.cell_center_m(x, y));
        let [px, py] = pixel(domain, at_m, [picture.width(), picture.height()]);
        picture.get_pixel(px, py).0[0] as f32 / 255.0
    }))
}

fn pixel(domain: &Domain, at_m: DVec2, size: [u32; 2]) -> [u32; 2] {
    let at = at_m / domain.map_m;
    let clamp = |v: f64, n: u32| ((v * n as f64).max(0.0) as u32).min(n - 1);
    [clamp(at.x, size[0]), clamp(at.y, size[1])]
}

/// The picture of the plates and its colours, one a plate, the most frequent first.
pub fn open_plates(path: &str) -> Result<(RgbImage, Vec<[u8; 3]>), ProcessError> {
    let unfit = |text: String| ProcessError::Unfit(format!("map: {text}"));
    let picture = open_picture(Path::new(path)).map_err(|e| unfit(e.to_string()))?.into_rgb8();
    let mut colours: BTreeMap<[u8; 3], usize> = BTreeMap::new();
    for p in picture.pixels() {
        *colours.entry(p.0).or_default() += 1;
    }
    let least = (LEAST_SHARE * picture.pixels().len() as f64) as usize;
    let mut kept: Vec<([u8; 3], usize)> = colours.into_iter().filter(|(_, count)| *count > least).collect();
    kept.sort_by_key(|&(colour, count)| (std::cmp::Reverse(count), colour));
    if !(2..=MOST_PLATES).contains(&kept.len()) {
        return Err(unfit(format!(
            "{path} has {} colours; draw 2 to {MOST_PLATES} plates in one flat colour each",
            kept.len()
        )));
    }
    Ok((picture, kept.into_iter().map(|(colour, _)| colour).collect()))
}

/// Plate index of every tectonic cell: one plate for each colour of the picture, the most frequent first.
pub fn plates(domain: &Domain, warp: &Warp, path: &str) -> Result<(Vec<u8>, usize), ProcessError> {
    let (picture, kept) = open_plates(path)?;
    let distance = |a: [u8; 3], b: [u8; 3]| (0..3).map(|k| (a[k] as i32 - b[k] as i32).pow(2)).sum::<i32>();
    let owners = Field::from_fn(domain.grid(), |x, y| {
        let at_m = warp.shown_at(domain.cell_center_m(x, y));
        let [px, py] = pixel(domain, at_m, [picture.width(), picture.height()]);
        let colour = picture.get_pixel(px, py).0;
        (0..kept.len()).min_by_key(|&k| distance(kept[k], colour)).unwrap_or(0) as u8
    });
    if let Some(lost) = (0..kept.len()).find(|&k| !owners.data.contains(&(k as u8))) {
        let [r, g, b] = kept[lost];
        return Err(ProcessError::Unfit(format!(
            "map: {path}: the plate coloured #{r:02x}{g:02x}{b:02x} is too thin; draw it broader or raise cells"
        )));
    }
    Ok((owners.data, kept.len()))
}

/// Convex hull of each plate's cells, engine units, counter-clockwise: what the physics moves.
pub fn hulls(domain: &Domain, owners: &[u8], count: usize) -> Vec<Polygon> {
    let n = domain.cells;
    let mut points: Vec<Vec<DVec2>> = vec![Vec::new(); count];
    for y in 0..n {
        // The first and the last cell of a plate in each row hold its hull.
        let mut ends: Vec<Option<(usize, usize)>> = vec![None; count];
        for x in 0..n {
            let owner = owners[y * n + x];
            if owner != NONE {
                let end = ends[owner as usize].get_or_insert((x, x));
                end.1 = x;
            }
        }
        for (plate, end) in ends.into_iter().enumerate() {
            let Some((first, last)) = end else { continue };
            let half = 0.5 * domain.cell_m();
            for (x, side) in [(first, -half), (last, half)] {
                for dy in [-half, half] {
                    points[plate].push(domain.to_engine(domain.cell_center_m(x, y) + DVec2::new(side, dy)));
                }
            }
        }
    }
    points.into_iter().map(hull).collect()
}

/// Andrew's monotone chain.
fn hull(mut points: Vec<DVec2>) -> Polygon {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..] {
                if (b - a).perp_dot(p - b) > 1e-9 {
                    break;
                }
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut lower = half(&mut points.iter().copied());
    lower.extend(half(&mut points.iter().rev().copied()));
    lower
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hull_of_a_grid_is_its_square() {
        let points = (0..25).map(|i| DVec2::new((i % 5) as f64, (i / 5) as f64)).collect();
        let hull = hull(points);
        assert_eq!(hull.len(), 4);
        assert_eq!(super::super::partition::area(&hull), 16.0);
    }
}
