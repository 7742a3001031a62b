//! The one table of layers: exporters, store, relief, inspect and app all read it.

/// How a layer's values are to be read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A quantity.
    Continuous,
    /// An identity: equal or not, without order.
    Id,
    /// One of a few named classes, 0, 1, 2, ...
    Class(&'static [&'static str]),
}

/// The colours a layer is drawn with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Palette {
    /// Hypsometric tints that change at sea level.
    Elevation,
    /// Dark to light, one quantity.
    Sequential,
    /// Two hues from a middle at zero.
    Diverging,
    /// Young (warm) to old (cool).
    Age,
    /// Steepness, grey to red.
    Slope,
    /// Parched to soaked, by square roots.
    Rain,
    /// Paper to deep water.
    Water,
    /// The same by powers of ten, for what flows.
    Flow,
    /// What glows: cold grey, black at 500 degC, red at 900, yellow at 1200.
    Heat,
    /// Distinct colours.
    Categorical,
}

/// What the catalogue says of one layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spec {
    /// Name in files, on the command line and in the store.
    pub name: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// SI unit or a multiple that people use; "1" for pure numbers.
    pub unit: &'static str,
    /// Values to be expected; a palette spans them.
    pub range: [f64; 2],
    /// Colours.
    pub palette: Palette,
    /// How to read the values.
    pub kind: Kind,
}

macro_rules! catalogue {
    ($($(#[$doc:meta])* $layer:ident: $name:literal, $title:literal, $unit:literal, $range:expr, $palette:ident, $kind:expr;)*) => {
        /// A named layer of a world.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Layer { $($(#[$doc])* $layer,)* }

        impl Layer {
            /// Every layer, in catalogue order.
            pub const ALL: &'static [Layer] = &[$(Layer::$layer),*];

            /// The catalogue's row.
            pub const fn spec(self) -> Spec {
                match self {
                    $(Layer::$layer => Spec {
                        name: $name, title: $title, unit: $unit, range: $range,
                        palette: Palette::$palette, kind: $kind,
                    },)*
                }
            }
        }
    };
}

catalogue! {
    /// Top of the ground: bedrock, lava and sediment together. Derived.
    Height: "height", "Height", "m", [-8000.0, 6000.0], Elevation, Kind::Continuous;
    /// Steepness of the ground. Derived.
    Slope: "slope", "Slope", "deg", [0.0, 45.0], Slope, Kind::Continuous;
    /// Top of the bedrock.
    Bedrock: "bedrock", "Bedrock", "m", [-8000.0, 6000.0], Elevation, Kind::Continuous;
    /// Thickness of frozen lava on the bedrock.
    Lava: "lava", "Frozen lava", "m", [0.0, 500.0], Sequential, Kind::Continuous;
    /// Thickness of loose sediment on top.
    Sediment: "sediment", "Sediment", "m", [0.0, 200.0], Sequential, Kind::Continuous;
    /// Depth of water, without the sea.
    Water: "water", "Water", "m", [0.0, 20.0], Sequential, Kind::Continuous;
    /// Resistance to erosion; rates are scaled by one minus it.
    Hardness: "hardness", "Hardness", "1", [0.0, 1.0], Sequential, Kind::Continuous;
    /// Speed at which rock is being raised.
    Uplift: "uplift", "Uplift rate", "mm/yr", [-2.0, 2.0], Diverging, Kind::Continuous;
    /// Which plate carries the ground.
    PlateId: "plate_id", "Plate", "1", [0.0, 63.0], Categorical, Kind::Id;
    /// Share of continental crust: 0 oceanic, 1 continental.
    CrustKind: "crust_kind", "Crust kind", "1", [0.0, 1.0], Sequential, Kind::Continuous;
    /// Age of the crust.
    CrustAge: "crust_age", "Crust age", "My", [0.0, 200.0], Age, Kind::Continuous;
    /// Thickness of the crust.
    CrustThickness: "crust_thickness", "Crust thickness", "km", [5.0, 70.0], Sequential, Kind::Continuous;
    /// What the nearest plate boundary does, where one is near.
    BoundaryKind: "boundary_kind", "Boundary", "1", [0.0, 4.0], Categorical,
        Kind::Class(&["none", "collision", "subduction", "spreading", "transform"]);
    /// Rock and soil taken away since the world began.
    Wear: "wear", "Wear", "m", [0.0, 3000.0], Sequential, Kind::Continuous;
    /// Sediment laid down since the world began.
    Deposit: "deposit", "Deposit", "m", [0.0, 500.0], Sequential, Kind::Continuous;
    /// Rain and snow of a year.
    Rain: "rain", "Rain", "mm/yr", [0.0, 3000.0], Rain, Kind::Continuous;
    /// What of the rain runs off to rivers in a year; the rest evaporates.
    Runoff: "runoff", "Runoff", "mm/yr", [0.0, 2000.0], Rain, Kind::Continuous;
    /// Mean temperature of a year at the ground.
    Temperature: "temperature", "Temperature", "degC", [-30.0, 30.0], Diverging, Kind::Continuous;
    /// Height above which snow outlasts the summer.
    SnowLine: "snow_line", "Snow line", "m", [0.0, 6000.0], Sequential, Kind::Continuous;
    /// What grows there.
    Biome: "biome", "Biome", "1", [0.0, 11.0], Categorical,
        Kind::Class(&["sea", "ice", "tundra", "taiga", "temperate forest", "temperate rain forest", "grassland",
            "shrubland", "desert", "savanna", "tropical dry forest", "tropical rain forest"]);
    /// Water that runs off through a cell, a year's mean.
    Discharge: "discharge", "Discharge", "m3/s", [0.0, 5000.0], Flow, Kind::Continuous;
    /// Width of the river at bank-full flow; 0 where none runs.
    RiverWidth: "river_width", "River width", "m", [0.0, 500.0], Water, Kind::Continuous;
    /// Depth of the river at bank-full flow.
    RiverDepth: "river_depth", "River depth", "m", [0.0, 20.0], Water, Kind::Continuous;
    /// Depth of standing water on land.
    LakeDepth: "lake_depth", "Lake depth", "m", [0.0, 200.0], Water, Kind::Continuous;
    /// Which river's basin the cell lies in, numbered from the largest, 1; 0 in the sea.
    Basin: "basin", "Basin", "1", [0.0, 255.0], Categorical, Kind::Id;
    /// Strahler's order of the stream; 0 where none runs.
    StreamOrder: "stream_order", "Stream order", "1", [0.0, 9.0], Categorical,
        Kind::Class(&["none", "1", "2", "3", "4", "5", "6", "7", "8", "9"]);
    /// Topographic wetness index: logarithm of what drains through a metre of contour over the slope; 0 in the sea.
    Wetness: "wetness", "Wetness", "ln m", [2.0, 14.0], Water, Kind::Continuous;
    /// Most water that passed a cell while it ran, in the last stage that let it run.
    Flow: "flow", "Flow of storm water", "m3/s", [0.0, 50.0], Flow, Kind::Continuous;
    /// Greatest speed of that water.
    FlowSpeed: "flow_speed", "Speed of storm water", "m/s", [0.0, 10.0], Sequential, Kind::Continuous;
    /// Velocity of that water to the east, at its greatest speed.
    FlowEast: "flow_east", "Velocity of storm water to the east", "m/s", [-5.0, 5.0], Diverging, Kind::Continuous;
    /// Velocity of that water to the south, at its greatest speed.
    FlowSouth: "flow_south", "Velocity of storm water to the south", "m/s", [-5.0, 5.0], Diverging, Kind::Continuous;
    /// Rock on its way in the water, as a layer of that thickness.
    Suspended: "suspended", "Sediment in the water", "m", [0.0, 0.1], Sequential, Kind::Continuous;
    /// Depth of lava that flows.
    MoltenLava: "molten_lava", "Flowing lava", "m", [0.0, 10.0], Sequential, Kind::Continuous;
    /// Mean temperature of the lava that flows; 0 where none does.
    MoltenTemperature: "molten_temperature", "Temperature of flowing lava", "degC", [0.0, 1200.0], Heat, Kind::Continuous;
    /// Mean temperature at which the lava there froze; 0 where none did.
    LavaTemperature: "lava_temperature", "Temperature of freezing lava", "degC", [0.0, 1200.0], Heat, Kind::Continuous;
    /// When lava last froze there, on the world's clock; 0 where none did.
    LavaDate: "lava_date", "Date of the lava", "yr", [0.0, 1000000.0], Sequential, Kind::Continuous;
    /// Ash that has fallen since the world began, as thick as it fell.
    Ash: "ash", "Fallen ash", "m", [0.0, 2.0], Sequential, Kind::Continuous;
}

impl Layer {
    /// The layers that make up the column of rock, from the bottom.
    pub const COLUMN: [Layer; 3] = [Layer::Bedrock, Layer::Lava, Layer::Sediment];

    /// Name in files, on the command line and in the store.
    pub const fn name(self) -> &'static str {
        self.spec().name
    }

    /// Worked out from other layers when asked for, never stored in a world.
    pub const fn derived(self) -> bool {
        matches!(self, Layer::Height | Layer::Slope)
    }

    /// The layer of that name.
    pub fn from_name(name: &str) -> Option<Layer> {
        Self::ALL.iter().copied().find(|layer| layer.name() == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_found() {
        for &layer in Layer::ALL {
            assert_eq!(Layer::from_name(layer.name()), Some(layer));
            let [low, high] = layer.spec().range;
            assert!(low < high && !layer.spec().unit.is_empty());
        }
        assert_eq!(Layer::from_name("hight"), None);
    }
}
