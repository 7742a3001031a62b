//! Rectangles and discs with soft edges.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{grid::Grid, noise::smoothstep};

/// What a region looks like from above.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Outline {
    /// Four corners.
    #[default]
    Rectangle,
    /// A disc, or an ellipse where the two lengths differ.
    Disc,
}

/// A part of the map with a soft edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Region {
    pub outline: Outline,
    pub middle_m: [f64; 2],
    /// Lengths along its own axes.
    pub size_m: [f64; 2],
    /// Turn, clockwise, as cosine and sine.
    pub turn: [f64; 2],
    /// Width of the edge, half of it within.
    pub edge_m: f64,
}

impl Region {
    /// Half the map about its middle, unless stated otherwise.
    pub fn new(
        outline: Outline,
        (at_km, size_km): (Option<[f64; 2]>, Option<[f64; 2]>),
        (angle_deg, edge_km): (f64, f64),
        grid: &Grid,
    ) -> Self {
        let extent_m = grid.extent_m();
        let (sin, cos) = libm::sincos(angle_deg.to_radians());
        Self {
            outline,
            middle_m: at_km.map_or(extent_m.map(|m| 0.5 * m), |at| at.map(|km| km * 1e3)),
            size_m: size_km.map_or(extent_m.map(|m| 0.5 * m), |size| size.map(|km| km * 1e3)),
            turn: [cos, sin],
            edge_m: edge_km * 1e3,
        }
    }

    /// How much of a point lies within: 1 inside, 0 outside, smooth across the edge.
    pub fn share(&self, at_m: [f64; 2]) -> f64 {
        let d = [at_m[0] - self.middle_m[0], at_m[1] - self.middle_m[1]];
        let [c, s] = self.turn;
        let own = [c * d[0] + s * d[1], c * d[1] - s * d[0]];
        let half = self.size_m.map(|m| 0.5 * m);
        let within = |inner_m: f64| {
            if self.edge_m > 0.0 { smoothstep(inner_m / self.edge_m + 0.5) } else { f64::from(inner_m >= 0.0) }
        };
        match self.outline {
            Outline::Rectangle => within(half[0] - own[0].abs()) * within(half[1] - own[1].abs()),
            Outline::Disc => {
                // Distance to the ellipse's rim along the ray from its middle.
                let relative = libm::hypot(own[0] / half[0], own[1] / half[1]);
                let out_m = libm::hypot(own[0], own[1]);
                within(if relative > 0.0 { out_m / relative - out_m } else { half[0].min(half[1]) })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Edges;

    #[test]
    fn edges_are_half_way_in_and_turn_clockwise() {
        let grid = Grid::new(100, 100, 100e3, Edges::Open);
        for outline in [Outline::Rectangle, Outline::Disc] {
            let region = Region::new(outline, (Some([50.0, 50.0]), Some([40.0, 20.0])), (90.0, 4.0), &grid);
            // Turned by a quarter the longer side lies north-south.
            let shares =
                [[50e3, 50e3], [50e3, 31e3], [50e3, 30e3], [60e3, 50e3], [63e3, 50e3]].map(|p| region.share(p));
            assert!(shares[0] == 1.0 && shares[1] > 0.5 && shares[4] == 0.0, "{outline:?} {shares:?}");
            assert!((shares[2] - 0.5).abs() < 1e-9 && (shares[3] - 0.5).abs() < 1e-9, "{outline:?} {shares:?}");
        }
        let sharp = Region::new(Outline::Rectangle, (None, None), (0.0, 0.0), &grid);
        assert_eq!([sharp.share([25e3, 50e3]), sharp.share([24.9e3, 50e3])], [1.0, 0.0]);
    }
}
