//! Lava on the land: frozen lava is dark whatever grew there, flowing lava glows by its temperature.

use super::{
    palette::{Rgb, hex, mix},
    swatches::Scale,
};
use crate::{
    grid::Field,
    world::{Layer, World},
};

/// Bare basalt.
const BASALT: u32 = 0x45413f;
/// Depths at which frozen lava begins to hide the land and hides it as far as it ever does, m.
const FROZEN_M: [f32; 2] = [0.02, 0.8];
/// The same for lava that flows.
const FLOWING_M: [f32; 2] = [0.02, 0.3];
/// Share of the land's colour that frozen lava hides.
const HIDES: f32 = 0.85;

/// The layers by which lava is drawn.
pub const LAYERS: [Layer; 3] = [Layer::Lava, Layer::MoltenLava, Layer::MoltenTemperature];

/// Lava at a picture's raster.
pub struct Lava {
    /// Depth of what froze, of what flows, m, and the temperature of that, degC.
    layers: [Option<Field<f32>>; 3],
    heat: Scale,
}

impl Lava {
    /// That of a world; `None` where there is none.
    pub fn of(world: &World, bring: impl Fn(&Field<f32>) -> Field<f32>) -> Option<Self> {
        let layers = LAYERS.map(|layer| world.layer(layer));
        let there = layers[..2].iter().flatten().any(|layer| layer.data.iter().any(|&depth| depth > FROZEN_M[0]));
        let spec = Layer::MoltenTemperature.spec();
        there.then(|| Self { layers: layers.map(|layer| layer.map(&bring)), heat: Scale::over(&spec, spec.range) })
    }

    /// The flat colour of a pixel whose land is of this colour.
    pub fn over(&self, index: usize, land: Rgb) -> Rgb {
        let [frozen, flowing, degc] = [0, 1, 2].map(|k: usize| self.layers[k].as_ref().map_or(0.0, |f| f.data[index]));
        let dark = share(FROZEN_M, frozen);
        let land = if dark > 0.0 { mix(land, hex(BASALT), HIDES * dark) } else { land };
        let bright = share(FLOWING_M, flowing);
        if bright > 0.0 { mix(land, self.heat.at(degc), bright) } else { land }
    }
}

fn share([from, to]: [f32; 2], depth_m: f32) -> f32 {
    ((depth_m - from) / (to - from)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    #[test]
    fn frozen_lava_is_dark_and_flowing_lava_glows_by_its_heat() {
        let mut world = World::new(Grid::new(4, 1, 4.0, Edges::Open), 0.0);
        let bring = |field: &Field<f32>| field.clone();
        assert!(Lava::of(&world, bring).is_none());
        let row = |data: [f32; 4]| Field { grid: world.grid, data: data.to_vec() };
        let layers = [
            (Layer::Lava, row([0.0, 3.0, 3.0, 0.0])),
            (Layer::MoltenLava, row([0.0, 0.0, 2.0, 2.0])),
            (Layer::MoltenTemperature, row([0.0, 0.0, 900.0, 1200.0])),
        ];
        layers.into_iter().for_each(|(layer, field)| world.set_layer(layer, field));
        let lava = Lava::of(&world, bring).unwrap();
        let green = [0.1, 0.5, 0.1];
        assert_eq!(lava.over(0, green), green);
        let [r, g, b] = lava.over(1, green);
        assert!(g < 0.15 && (r - b).abs() < 0.05, "{r} {g} {b}");
        // The document's scale: red at 900, yellow at 1200.
        let near = |a: Rgb, b: Rgb| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.01);
        assert!(near(lava.over(2, green), [1.0, 0.0, 0.0]), "{:?}", lava.over(2, green));
        assert!(near(lava.over(3, green), [1.0, 1.0, 0.0]), "{:?}", lava.over(3, green));
    }
}
