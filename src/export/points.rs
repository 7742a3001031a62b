//! Particles or puffs of smoke at a moment, as points for other programs.
//!
//! | ending | holds | axes, unit |
//! |---|---|---|
//! | `.ply` | place, values, number of each (binary, little-endian) | x east, y north, z up; m; the middle of the map is the origin |
//! | `.csv` | number, place, values | x east, y south from the north-west corner, z up; m |
//!
//! Particles have temperature, age and radius; puffs have radius, opacity, age, and the number of their plume.

use std::{io::Write, path::Path};

use super::{ExportError, raster::Out};
use crate::{bake::Particle, world::Puff};

/// A format of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointFormat {
    /// Polygon file format, points only.
    Ply,
    /// Comma-separated values.
    Csv,
}

/// The formats of points, by their endings.
pub const POINT_FORMATS: [(&str, PointFormat); 2] = [("ply", PointFormat::Ply), ("csv", PointFormat::Csv)];

/// A value that each point has.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Value {
    /// Its name in `.ply`.
    property: &'static str,
    /// Its name in `.csv`, with its unit.
    column: &'static str,
    /// Decimals of it in `.csv`.
    decimals: usize,
}

const fn value(property: &'static str, column: &'static str, decimals: usize) -> Value {
    Value { property, column, decimals }
}

const OF_PARTICLES: [Value; 3] =
    [value("temperature", "temperature_degc", 3), value("age", "age_s", 4), value("radius", "radius_m", 5)];
const OF_PUFFS: [Value; 4] = [
    value("radius", "radius_m", 4),
    value("opacity", "opacity", 5),
    value("age", "age_s", 4),
    value("plume", "plume", 0),
];

/// Points of a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    values: &'static [Value],
    /// Number, place and values of each.
    rows: Vec<(u32, [f64; 3], [f64; 4])>,
    /// West-east and north-south extent of their map, m.
    extent_m: [f64; 2],
    /// The moment, s.
    time_s: f64,
}

impl Points {
    /// Particles, all of one radius, on a map of this extent, m, at a moment, s.
    pub fn particles(particles: &[Particle], radius_m: f64, extent_m: [f64; 2], time_s: f64) -> Self {
        let row = |p: &Particle| (p.id, p.at_m, [p.temperature_degc, p.age_s, radius_m, 0.0]);
        Self { values: &OF_PARTICLES, rows: particles.iter().map(row).collect(), extent_m, time_s }
    }

    /// Puffs with the number of the plume that each belongs to, likewise.
    pub fn puffs(puffs: &[(usize, Puff)], extent_m: [f64; 2], time_s: f64) -> Self {
        let row = |(plume, puff): &(usize, Puff)| {
            (puff.number as u32, puff.at_m, [puff.radius_m, puff.opacity, puff.age_s, *plume as f64])
        };
        Self { values: &OF_PUFFS, rows: puffs.iter().map(row).collect(), extent_m, time_s }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Writes them into a file.
    pub fn fill(&self, format: PointFormat, path: &Path, out: &mut Out) -> Result<(), ExportError> {
        let written = match format {
            PointFormat::Ply => self.ply(out),
            PointFormat::Csv => self.csv(out),
        };
        written.map_err(|cause| ExportError::Disk { path: path.to_owned(), cause })
    }

    fn ply(&self, out: &mut impl Write) -> std::io::Result<()> {
        let [width, height] = self.extent_m;
        write!(
            out,
            "ply\nformat binary_little_endian 1.0\ncomment Upthrust {}; x east, y north, z up, m; {} s\n\
             element vertex {}\nproperty float x\nproperty float y\nproperty float z\n",
            env!("CARGO_PKG_VERSION"),
            self.time_s,
            self.rows.len()
        )?;
        for value in self.values {
            writeln!(out, "property float {}", value.property)?;
        }
        write!(out, "property uint id\nend_header\n")?;
        for (id, [x, y, z], values) in &self.rows {
            let place = [x - 0.5 * width, 0.5 * height - y, *z];
            for value in place.iter().chain(&values[..self.values.len()]) {
                out.write_all(&(*value as f32).to_le_bytes())?;
            }
            out.write_all(&id.to_le_bytes())?;
        }
        Ok(())
    }

    fn csv(&self, out: &mut impl Write) -> std::io::Result<()> {
        write!(out, "id,x_m,y_m,z_m")?;
        for value in self.values {
            write!(out, ",{}", value.column)?;
        }
        writeln!(out)?;
        for (id, [x, y, z], values) in &self.rows {
            write!(out, "{id},{x:.4},{y:.4},{z:.4}")?;
            for (value, number) in self.values.iter().zip(values) {
                write!(out, ",{number:.*}", value.decimals)?;
            }
            writeln!(out)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lie_where_the_mesh_does() {
        let particles = [Particle { id: 7, at_m: [30.0, 10.0, 5.0], temperature_degc: 900.0, age_s: 1.5 }];
        let points = Points::particles(&particles, 0.25, [40.0, 40.0], 2.0);
        let mut bytes = Vec::new();
        points.ply(&mut bytes).unwrap();
        let body = &bytes[bytes.len() - 28..];
        let numbers: Vec<f32> = body[..24].as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        assert_eq!((numbers, body[24]), (vec![10.0, 10.0, 5.0, 900.0, 1.5, 0.25], 7));
        assert!(String::from_utf8_lossy(&bytes).contains("element vertex 1\n"));
        let mut text = Vec::new();
        points.csv(&mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        assert_eq!(text.lines().nth(1), Some("7,30.0000,10.0000,5.0000,900.000,1.5000,0.25000"));
    }
    #[test]
    fn puffs_are_points_with_other_values() {
        let at_m = [30.0, 10.0, 5.0];
        let puff = Puff { number: 3, at_m, radius_m: 2.0, age_s: 1.5, spent: 0.1, opacity: 0.25, turn_rad: 0.0 };
        let points = Points::puffs(&[(1, puff)], [40.0, 40.0], 2.0);
        let (mut text, mut bytes) = (Vec::new(), Vec::new());
        points.csv(&mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        let want = ["id,x_m,y_m,z_m,radius_m,opacity,age_s,plume", "3,30.0000,10.0000,5.0000,2.0000,0.25000,1.5000,1"];
        assert_eq!(text.lines().collect::<Vec<_>>(), want);
        points.ply(&mut bytes).unwrap();
        let body = &bytes[bytes.len() - 32..];
        let numbers: Vec<f32> = body[..28].as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        assert_eq!((numbers, body[28]), (vec![10.0, 10.0, 5.0, 2.0, 0.25, 1.5, 1.0], 3));
    }
}
