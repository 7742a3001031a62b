//! Vents: where molten rock comes, or once came, to the surface. Those that build volcanoes write them, those that let lava
//! flow read them; a table, so that they are stored and carried along like everything else.

use super::{Table, World};

/// The table of vents.
const VENTS: &str = "vents";

/// An opening in the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vent {
    /// Where, from the map's north-west corner, m.
    pub at_m: [f64; 2],
    /// Its radius: that of the crater around it, m.
    pub radius_m: f64,
    /// Years since it last was active, when it was written; 0 for one that is active.
    pub age_yr: f64,
}

impl World {
    /// The vents, in the order in which they were written.
    pub fn vents(&self) -> Vec<Vent> {
        let Some(table) = self.table(VENTS) else { return Vec::new() };
        let columns = ["x_m", "y_m", "radius_m", "age_yr"].map(|name| table.numbers(name));
        let [Some(x), Some(y), Some(radius), Some(age)] = columns else { return Vec::new() };
        (0..table.rows()).map(|i| Vent { at_m: [x[i], y[i]], radius_m: radius[i], age_yr: age[i] }).collect()
    }

    /// Adds vents to those that are there.
    pub fn add_vents(&mut self, new: &[Vent]) {
        let all: Vec<Vent> = self.vents().into_iter().chain(new.iter().copied()).collect();
        self.set_vents(&all);
    }

    /// Sets the vents in place of those that are there.
    pub fn set_vents(&mut self, all: &[Vent]) {
        self.remove_table(VENTS);
        if all.is_empty() {
            return;
        }
        let column = |f: fn(&Vent) -> f64| all.iter().map(f).collect::<Vec<_>>();
        self.set_table(
            Table::new(VENTS)
                .number("x_m", "m", column(|vent| vent.at_m[0]))
                .number("y_m", "m", column(|vent| vent.at_m[1]))
                .number("radius_m", "m", column(|vent| vent.radius_m))
                .number("age_yr", "yr", column(|vent| vent.age_yr)),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    #[test]
    fn vents_are_added_and_read_back() {
        let mut world = World::new(Grid::new(4, 4, 4.0, Edges::Open), 0.0);
        assert_eq!(world.vents(), []);
        let [a, b] = [1.0, 2.0].map(|x| Vent { at_m: [x, 3.0], radius_m: 0.5, age_yr: 1e6 * x });
        world.add_vents(&[a]);
        world.add_vents(&[b]);
        assert_eq!(world.vents(), [a, b]);
    }
}
