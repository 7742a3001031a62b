//! The one bend through which the map reads the plates, so that borders, ranges, trenches and coasts curve together.
//!
//! A chain of displacements `p -> p + s·(f₁(p), f₂(p))`, from long and strong to short and weak, each with two independent
//! components. A link does not fold where `det(I + s·J) > 0`; its `s` is lowered until the determinant is at least
//! `LEAST_DETERMINANT` on a lattice that does not depend on the map's grid. Maps that don't fold, one after the other, don't
//! fold: a chain bends further than one sum of all wavelengths could.

use glam::DVec2;
use rayon::prelude::*;

use crate::noise::{Fbm, Key, Octaves, Sampler};

/// Wavelength of each link as a share of the map's longer side, and its displacement as a share of the bend asked for.
const LINKS: [(f64, f64); 6] = [(0.85, 1.0), (0.36, 0.42), (0.15, 0.16), (0.06, 0.08), (0.026, 0.045), (0.011, 0.02)];
/// Smallest area factor a link may have.
const LEAST_DETERMINANT: f64 = 0.4;
/// Points in a link's wavelength at which folding is looked for.
const PROBES: f64 = 6.0;
/// Parts of each side of the map in which its rim is looked at.
const RIM_PROBES: usize = 512;

/// A fold-free displacement of the plane.
#[derive(Clone, Debug)]
pub struct Warp {
    links: Vec<Link>,
    /// Corners of a box around all that the map reads, m.
    reads_m: [DVec2; 2],
}

#[derive(Clone, Debug)]
struct Link {
    parts: [Octaves; 2],
    amplitude_m: f64,
}

/// The rows of a Jacobian.
type Rows = [DVec2; 2];

impl Link {
    fn new(map_m: DVec2, wavelength_m: f64, amplitude_m: f64, key: Key) -> Self {
        let fbm = Fbm { octaves: Some(1.0), ..Fbm::new(wavelength_m, 1.0) };
        let parts = [fbm.octaves(key.named("east"), 0.0), fbm.octaves(key.named("south"), 0.0)];
        let mut link = Self { parts, amplitude_m };
        // Links before this one may have carried points a little outside the map.
        let (low, span) = (-0.2 * map_m, 1.4 * map_m);
        let count = (span / wavelength_m * PROBES).ceil();
        let slopes: Vec<Rows> = (0..(count.x * count.y) as usize)
            .into_par_iter()
            .map(|i| {
                let (x, y) = (i % count.x as usize, i / count.x as usize);
                let at = low + DVec2::new(x as f64 + 0.5, y as f64 + 0.5) / count * span;
                [0, 1].map(|k| DVec2::from(link.parts[k].gradient(at.into()).1))
            })
            .collect();
        while slopes.par_iter().any(|slope| determinant(&rows(slope, link.amplitude_m)) < LEAST_DETERMINANT) {
            link.amplitude_m *= 0.97;
        }
        link
    }

    /// Where the link leads, and its Jacobian, from the noise and the slope of its two parts.
    fn apply(&self, at_m: DVec2, [(x, gx), (y, gy)]: [(f64, [f64; 2]); 2]) -> (DVec2, Rows) {
        (at_m + self.amplitude_m * DVec2::new(x, y), rows(&[gx.into(), gy.into()], self.amplitude_m))
    }
}

fn rows(slopes: &Rows, amplitude_m: f64) -> Rows {
    [DVec2::X + amplitude_m * slopes[0], DVec2::Y + amplitude_m * slopes[1]]
}

fn determinant(rows: &Rows) -> f64 {
    rows[0].perp_dot(rows[1])
}

impl Warp {
    /// Bends by about `bend` of the map's longer side, less where that would fold.
    pub fn new(map_m: DVec2, bend: f64, key: Key) -> Self {
        let side = map_m.max_element();
        let links = LINKS.iter().enumerate().map(|(i, (wavelength, share))| {
            Link::new(map_m, wavelength * side, share * bend * side, key.with(i as u64))
        });
        let mut warp = Self { links: if bend > 0.0 { links.collect() } else { Vec::new() }, reads_m: [DVec2::ZERO; 2] };
        warp.reads_m = warp.box_around_rim(map_m);
        warp
    }

    /// A box around what the map's rim reads holds what lies inside too: nothing folds.
    fn box_around_rim(&self, map_m: DVec2) -> [DVec2; 2] {
        let spot = |i: usize| i as f64 / RIM_PROBES as f64;
        let sides = |t: f64| [DVec2::new(t, 0.0), DVec2::new(t, 1.0), DVec2::new(0.0, t), DVec2::new(1.0, t)];
        let rim = (0..=RIM_PROBES).flat_map(|i| sides(spot(i))).map(|share| self.read_at(share * map_m));
        let (low, high) =
            rim.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
        // The shortest link has five probes in a wavelength: between two of them the rim bulges out by far less than this.
        let bulge = 4.0 * map_m.max_element() / RIM_PROBES as f64;
        [low - bulge, high + bulge]
    }

    /// Corners of a box around all that the map reads of the plates, m.
    pub fn reads_m(&self) -> [DVec2; 2] {
        self.reads_m
    }

    /// Where the map at `at_m` reads the plates.
    pub fn read_at(&self, at_m: DVec2) -> DVec2 {
        self.links.iter().fold(at_m, |at, link| {
            let part = |k: usize| link.parts[k].value(at.into());
            at + link.amplitude_m * DVec2::new(part(0), part(1))
        })
    }

    /// `read_at` and its Jacobian's rows.
    pub fn read_with_jacobian(&self, at_m: DVec2) -> (DVec2, Rows) {
        self.links.iter().fold((at_m, [DVec2::X, DVec2::Y]), |(at, before), link| {
            chained(link.apply(at, [0, 1].map(|k| link.parts[k].gradient(at.into()))), before)
        })
    }

    /// A reader for many places one near the other.
    pub fn reader(&self) -> Reader<'_> {
        Reader { links: self.links.iter().map(|link| (link, [0, 1].map(|k| link.parts[k].sampler()))).collect() }
    }

    /// [`Reader::shown_at`] for a single place.
    pub fn shown_at(&self, q_m: DVec2) -> DVec2 {
        self.reader().shown_at(q_m)
    }
}

/// Chain rule: a link's own Jacobian times that of the links before it.
fn chained((at, own): (DVec2, Rows), before: Rows) -> (DVec2, Rows) {
    (at, own.map(|row| row.x * before[0] + row.y * before[1]))
}

/// Reads a warp at many places, faster where they lie close to each other.
pub struct Reader<'a> {
    links: Vec<(&'a Link, [Sampler<'a>; 2])>,
}

impl Reader<'_> {
    /// [`Warp::read_with_jacobian`], bit for bit.
    fn read_with_jacobian(&mut self, at_m: DVec2) -> (DVec2, Rows) {
        self.links.iter_mut().fold((at_m, [DVec2::X, DVec2::Y]), |(at, before), (link, [east, south])| {
            chained(link.apply(at, [east.gradient(at.into()), south.gradient(at.into())]), before)
        })
    }

    /// The map point that reads a point of the plates; Newton's method, good to a metre.
    pub fn shown_at(&mut self, q_m: DVec2) -> DVec2 {
        let mut p = q_m;
        for _ in 0..30 {
            let (at, rows) = self.read_with_jacobian(p);
            let error = q_m - at;
            if error.length() < 1.0 {
                break;
            }
            let step = DVec2::new(rows[1].y * error.x - rows[0].y * error.y, rows[0].x * error.y - rows[1].x * error.x);
            // A step longer than twice the error would be one across a near fold.
            p += (step / determinant(&rows)).clamp_length_max(2.0 * error.length());
        }
        p
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn never_folds_and_inverts() {
        for seed in 0..12 {
            let map = DVec2::new(1_000e3, 700e3);
            let warp = Warp::new(map, 0.2, Key::new(seed));
            let (mut stream, mut reader) = (Key::new(seed).stream(), warp.reader());
            for _ in 0..3000 {
                let p = DVec2::new(stream.unit(), stream.unit()) * map;
                let (q, rows) = warp.read_with_jacobian(p);
                assert!(determinant(&rows) > 0.0, "seed {seed} folds at {p}");
                assert_eq!(q, warp.read_at(p));
                assert_eq!((q, rows), reader.read_with_jacobian(p));
            }
            let [low, high] = warp.reads_m();
            let all = (0..=60).flat_map(|j| (0..=60).map(move |i| DVec2::new(i as f64, j as f64) / 60.0 * map));
            assert!(all.map(|p| warp.read_at(p)).all(|q| q.cmpge(low).all() && q.cmple(high).all()), "seed {seed}");
            let p = map * 0.4;
            assert!((warp.shown_at(warp.read_at(p)) - p).length() < 20.0);
        }
    }

    #[test]
    fn the_jacobian_is_the_slope_of_the_chain() {
        let warp = Warp::new(DVec2::splat(500e3), 0.08, Key::new(4));
        let (p, e) = (DVec2::new(211e3, 97e3), 1.0);
        let rows = warp.read_with_jacobian(p).1;
        let dx = (warp.read_at(p + DVec2::X * e) - warp.read_at(p - DVec2::X * e)) / (2.0 * e);
        let dy = (warp.read_at(p + DVec2::Y * e) - warp.read_at(p - DVec2::Y * e)) / (2.0 * e);
        assert!((dx - DVec2::new(rows[0].x, rows[1].x)).length() < 1e-6);
        assert!((dy - DVec2::new(rows[0].y, rows[1].y)).length() < 1e-6);
    }
}
