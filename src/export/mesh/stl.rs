//! Binary STL: the ground as a closed solid to be printed, with walls down to a flat base. In millimetres, z up, its base
//! at 0.
//!
//! Every edge belongs to two triangles that run along it in opposite directions: the top's rim is the walls' upper edge,
//! and the base is a fan from its middle to the walls' lower edge.

use std::io::{self, Write};

use super::{Lattice, MeshOptions, ground, put};
use crate::{export::ExportError, world::World};

/// Relief of a print, as a share of its width, that is reached if no exaggeration is asked for.
const PRINTED_SHARE: f64 = 0.1;

type Point = [f32; 3];

/// Writes the ground as an `.stl`.
pub fn write_stl(world: &World, options: &MeshOptions, out: &mut impl Write) -> Result<(), ExportError> {
    let ground = ground(world)?;
    let (low, high) = ground.range().unwrap_or((0.0, 0.0));
    let mm_per_m = options.width_mm / ground.grid.extent_m()[0];
    let relief_mm = (high as f64 - low as f64) * mm_per_m;
    let wanted = if relief_mm > 0.0 { PRINTED_SHARE * options.width_mm / relief_mm } else { 1.0 };
    let up = mm_per_m * options.exaggeration.unwrap_or(wanted.max(1.0));
    // The lattice's cubic may dip below the lowest cell by a little; the base stays under it all the same.
    let lattice = Lattice::new(&ground, options.size, mm_per_m, |height_m| (height_m as f64 - low as f64) * up);
    let dip_mm = lattice.heights.iter().fold(0.0f32, |dip, &h| dip.min(h));
    let solid = Solid { lattice, lift_mm: options.base_mm as f32 - dip_mm };
    Ok(solid.write(out)?)
}

struct Solid {
    lattice: Lattice,
    lift_mm: f32,
}

impl Solid {
    fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let lattice = &self.lattice;
        let rim = self.rim();
        let mut title = [b' '; 80];
        let text = concat!("Upthrust ", env!("CARGO_PKG_VERSION"), " terrain, mm, z up");
        title[..text.len()].copy_from_slice(text.as_bytes());
        out.write_all(&title)?;
        out.write_all(&((lattice.triangles() + 3 * rim.len()) as u32).to_le_bytes())?;
        lattice.each_triangle(|corners| triangle(out, corners.map(|i| self.top(i))))?;
        for (k, &p) in rim.iter().enumerate() {
            let (p, q) = (self.top(p), self.top(rim[(k + 1) % rim.len()]));
            let (below_p, below_q) = (under(p), under(q));
            triangle(out, [p, below_p, q])?;
            triangle(out, [q, below_p, below_q])?;
            triangle(out, [below_p, [0.0; 3], below_q])?;
        }
        Ok(())
    }

    fn top(&self, i: usize) -> Point {
        let (x, y) = (i % self.lattice.width, i / self.lattice.width);
        let [east, south] = self.lattice.place(x, y);
        [east as f32, -south as f32, self.lattice.at(x, y) + self.lift_mm]
    }

    /// The points of the rim, anticlockwise from above, from the north-west.
    fn rim(&self) -> Vec<usize> {
        let (w, h) = (self.lattice.width, self.lattice.height);
        let west = (0..h - 1).map(|y| y * w);
        let south = (0..w - 1).map(|x| (h - 1) * w + x);
        let east = (1..h).rev().map(|y| y * w + w - 1);
        let north = (1..w).rev();
        west.chain(south).chain(east).chain(north).collect()
    }
}

fn under(point: Point) -> Point {
    [point[0], point[1], 0.0]
}

fn triangle(out: &mut impl Write, [a, b, c]: [Point; 3]) -> io::Result<()> {
    let side = |p: Point| [0, 1, 2].map(|i| p[i] as f64 - a[i] as f64);
    let (u, v) = (side(b), side(c));
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
    put(out, &normal.map(|n| (n / length) as f32))?;
    put(out, &a)?;
    put(out, &b)?;
    put(out, &c)?;
    out.write_all(&[0; 2])
}
