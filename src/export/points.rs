//! Particles at a moment, as points for other programs.
//!
//! | ending | holds | axes, unit |
//! |---|---|---|
//! | `.ply` | place, temperature, age, radius, number of each (binary, little-endian) | x east, y north, z up; m; the middle of the map is the origin |
//! | `.csv` | number, place, temperature, age, radius | x east, y south from the north-west corner, z up; m |

use std::{io::Write, path::Path};

use super::{ExportError, write_whole};
use crate::bake::Particle;

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

/// Particles and what is the same for all.
#[derive(Clone, Copy, Debug)]
pub struct Points<'a> {
    /// The particles.
    pub particles: &'a [Particle],
    /// Radius of each, m.
    pub radius_m: f64,
    /// West-east and north-south extent of their map, m.
    pub extent_m: [f64; 2],
    /// The moment, s.
    pub time_s: f64,
}

/// Writes points, whole or not at all.
pub fn write_points(points: &Points, format: PointFormat, path: &Path) -> Result<(), ExportError> {
    write_whole(path, |file| {
        let written = match format {
            PointFormat::Ply => ply(points, file),
            PointFormat::Csv => csv(points, file),
        };
        written.map_err(|cause| ExportError::Disk { path: path.to_owned(), cause })
    })
}

fn ply(points: &Points, out: &mut impl Write) -> std::io::Result<()> {
    let [width, height] = points.extent_m;
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment Upthrust {}; x east, y north, z up, m; {} s\nelement vertex {}\n\
         property float x\nproperty float y\nproperty float z\nproperty float temperature\nproperty float age\n\
         property float radius\nproperty uint id\nend_header\n",
        env!("CARGO_PKG_VERSION"),
        points.time_s,
        points.particles.len()
    )?;
    for particle in points.particles {
        let [x, y, z] = particle.at_m;
        let [x, y] = [x - 0.5 * width, 0.5 * height - y];
        for value in [x, y, z, particle.temperature_degc, particle.age_s, points.radius_m] {
            out.write_all(&(value as f32).to_le_bytes())?;
        }
        out.write_all(&particle.id.to_le_bytes())?;
    }
    Ok(())
}

fn csv(points: &Points, out: &mut impl Write) -> std::io::Result<()> {
    writeln!(out, "id,x_m,y_m,z_m,temperature_degc,age_s,radius_m")?;
    for particle in points.particles {
        let ([x, y, z], heat, age) = (particle.at_m, particle.temperature_degc, particle.age_s);
        writeln!(out, "{},{x:.4},{y:.4},{z:.4},{heat:.3},{age:.4},{:.5}", particle.id, points.radius_m)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lie_where_the_mesh_does() {
        let particles = [Particle { id: 7, at_m: [30.0, 10.0, 5.0], temperature_degc: 900.0, age_s: 1.5 }];
        let points = Points { particles: &particles, radius_m: 0.25, extent_m: [40.0, 40.0], time_s: 2.0 };
        let mut bytes = Vec::new();
        ply(&points, &mut bytes).unwrap();
        let body = &bytes[bytes.len() - 28..];
        let numbers: Vec<f32> = body[..24].as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        assert_eq!((numbers, body[24]), (vec![10.0, 10.0, 5.0, 900.0, 1.5, 0.25], 7));
        assert!(String::from_utf8_lossy(&bytes).contains("element vertex 1\n"));
        let mut text = Vec::new();
        csv(&points, &mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        assert_eq!(text.lines().nth(1), Some("7,30.0000,10.0000,5.0000,900.000,1.5000,0.25000"));
    }
}
