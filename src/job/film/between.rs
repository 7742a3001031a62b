//! A world on the way between two moments: quantities in proportion to time, names those of the nearer.

use crate::{
    grid::{Field, for_each_row},
    world::{Kind, Layer, World},
};

/// The world at `share` of the way from one moment to another on the same grid.
pub fn between(from: &World, to: &World, share: f32) -> World {
    if from.grid != to.grid || share >= 1.0 {
        return to.clone();
    }
    let near = if share < 0.5 { from } else { to };
    let part = |a: f64, b: f64| a + (b - a) * f64::from(share);
    let mut world = World::new(to.grid, part(from.sea_level_m, to.sea_level_m));
    world.time_yr = part(from.time_yr, to.time_yr);
    let empty = Field::filled(to.grid, 0.0f32);
    for &layer in Layer::ALL.iter().filter(|layer| !layer.derived()) {
        let made = match (from.layer(layer), to.layer(layer)) {
            (None, None) => continue,
            (Some(a), Some(b)) => mixed(layer, a, b, share),
            (None, Some(b)) if of_the_place(layer) => b.clone(),
            (Some(a), None) if of_the_place(layer) => a.clone(),
            (a, b) => mixed(layer, a.unwrap_or(&empty), b.unwrap_or(&empty), share),
        };
        world.set_layer(layer, made);
    }
    for table in near.tables() {
        world.set_table(table.clone());
    }
    // The later moment knows all smoke that the earlier one did.
    if let Some(plumes) = to.table("plumes") {
        world.set_table(plumes.clone());
    }
    world
}

/// Whether there is some of it everywhere, so that its lack means that nobody has worked it out.
fn of_the_place(layer: Layer) -> bool {
    use Layer::*;
    matches!(layer, Rain | Runoff | Temperature | SnowLine | Hardness | Wetness | CrustKind | CrustAge | CrustThickness)
        || !matches!(layer.spec().kind, Kind::Continuous)
}

/// Whether zero means that there is none, rather than little.
fn none_at_zero(layer: Layer) -> bool {
    matches!(layer, Layer::MoltenTemperature | Layer::LavaTemperature | Layer::LavaDate)
}

fn mixed(layer: Layer, a: &Field<f32>, b: &Field<f32>, share: f32) -> Field<f32> {
    if !matches!(layer.spec().kind, Kind::Continuous) {
        return if share < 0.5 { a.clone() } else { b.clone() };
    }
    let none = none_at_zero(layer);
    let mut out = a.clone();
    for_each_row(&mut out.data, b.grid.width, |y, row| {
        for (a, &b) in row.iter_mut().zip(b.row(y)) {
            *a = match none && (*a == 0.0 || b == 0.0) {
                true => a.max(b),
                false => *a + (b - *a) * share,
            };
        }
    });
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    #[test]
    fn quantities_go_in_proportion_and_names_change_half_way() {
        let grid = Grid::new(2, 1, 20.0, Edges::Open);
        let world = |bedrock: [f32; 2], time_yr: f64| {
            let mut world = World::new(grid, 10.0 + time_yr);
            world.time_yr = time_yr;
            world.layer_mut(Layer::Bedrock).data.copy_from_slice(&bedrock);
            world
        };
        let (mut a, mut b) = (world([0.0, 100.0], 0.0), world([40.0, 60.0], 8.0));
        a.layer_mut(Layer::PlateId).data.copy_from_slice(&[1.0, 2.0]);
        b.layer_mut(Layer::PlateId).data.copy_from_slice(&[3.0, 4.0]);
        b.layer_mut(Layer::Water).data.copy_from_slice(&[0.0, 4.0]);
        b.layer_mut(Layer::SnowLine).data.fill(2000.0);
        a.layer_mut(Layer::MoltenTemperature).data.copy_from_slice(&[0.0, 1000.0]);
        b.layer_mut(Layer::MoltenTemperature).data.copy_from_slice(&[900.0, 800.0]);
        let quarter = between(&a, &b, 0.25);
        let of = |layer: Layer| quarter.layer(layer).unwrap().data.clone();
        assert_eq!((quarter.time_yr, quarter.sea_level_m), (2.0, 12.0));
        assert_eq!((of(Layer::Bedrock), of(Layer::Water)), (vec![10.0, 90.0], vec![0.0, 1.0]));
        assert_eq!((of(Layer::PlateId), of(Layer::SnowLine)), (vec![1.0, 2.0], vec![2000.0; 2]));
        assert_eq!(of(Layer::MoltenTemperature), [900.0, 950.0]);
        assert_eq!(between(&a, &b, 0.75).layer(Layer::PlateId).unwrap().data, [3.0, 4.0]);
        assert_eq!(between(&a, &b, 1.0), b);
    }
}
