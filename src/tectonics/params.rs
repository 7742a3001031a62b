//! What a recipe can say of the `plates` stage.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How plates meet and what a meeting raises.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum PlateStyle {
    /// Plates override each other; crust, isostasy, trenches and arcs.
    #[default]
    Geologic,
    /// The thesis's rules: solid plates in a shaken box, one constant RMP step at the begin of each collision.
    Thesis,
}

/// The crust a plate is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum PlateCrust {
    /// As the continents were drawn.
    #[default]
    Mixed,
    /// Continental throughout.
    Continental,
    /// Oceanic throughout.
    Oceanic,
}

/// One plate singled out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PlateEntry {
    /// A point on the plate, from the map's north-west corner, x to the east and y to the south.
    #[schemars(extend("x-unit" = "km", "x-effect" = "picks the plate that lies there when the run begins"))]
    pub at_km: [f64; 2],
    /// Compass direction in which it drifts: 0 north, 90 east.
    #[schemars(range(min = -360.0, max = 360.0), extend("x-unit" = "deg", "x-effect" = "turns the drift clockwise"))]
    pub heading_deg: f64,
    /// Speed of its drift.
    #[schemars(range(min = 0.0, max = 200.0), extend("x-unit" = "mm/yr", "x-effect" = "faster drift"))]
    pub speed_mm_per_yr: f64,
    /// Crust it is made of.
    #[schemars(extend("x-effect" = "overrides the continents on this plate"))]
    pub crust: PlateCrust,
}

impl Default for PlateEntry {
    fn default() -> Self {
        Self { at_km: [0.0, 0.0], heading_deg: 0.0, speed_mm_per_yr: 20.0, crust: PlateCrust::Mixed }
    }
}

/// Rigid plates drift, collide, part and slide; ranges rise where they close.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PlatesParams {
    /// Number of plates the square is cut into; about that many in the thesis style.
    #[schemars(range(min = 2, max = 60), extend("x-unit" = "1", "x-effect" = "more and smaller plates, more ranges"))]
    pub count: u32,
    /// How long the plates move.
    #[schemars(range(min = 0.01, max = 500.0), extend("x-unit" = "My", "x-effect" = "more convergence, higher and wider ranges"))]
    pub duration_myr: f64,
    /// Typical (root mean square) speed of the mantle below the plates; two plates that meet close at about twice this.
    #[schemars(range(min = 0.1, max = 200.0), extend("x-unit" = "mm/yr", "x-effect" = "more convergence in the same time"))]
    pub speed_mm_per_yr: f64,
    /// Share of straight closing in the mantle's flow: 1 closing, 0 stirring, -1 opening.
    #[schemars(range(min = -1.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "from rifts to one great collision"))]
    pub closing: f64,
    /// Side of the square of plates, in widths of the map.
    #[schemars(range(min = 1.0, max = 4.0), extend("x-unit" = "1", "x-effect" = "pushes the square's rim farther out of the picture"))]
    pub margin: f64,
    /// Share of the map under continental crust.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "larger continents"))]
    pub continental_share: f64,
    /// Width of the largest continents.
    #[schemars(range(min = 1.0, max = 20000.0), extend("x-unit" = "km", "x-effect" = "fewer and broader continents"))]
    pub continent_km: f64,
    /// Width of the slope from continent to ocean floor.
    #[schemars(range(min = 0.1, max = 1000.0), extend("x-unit" = "km", "x-effect" = "wider shelves, gentler continental slopes"))]
    pub shelf_km: f64,
    /// Share of the map above the sea; met by solving for the sea level. Without it the sea stays where it is.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "lowers the sea"))]
    pub land_share: Option<f64>,
    /// Half-height half-width of a young range (its massif).
    #[schemars(range(min = 0.1, max = 2000.0), extend("x-unit" = "km", "x-effect" = "broader and lower ranges"))]
    pub belt_km: f64,
    /// Widths a range is raised in at once: massif, chain, crest, ... each half as wide.
    #[schemars(range(min = 1, max = 6), extend("x-unit" = "1", "x-effect" = "finer structure in the ranges"))]
    pub belt_octaves: u32,
    /// Share of the height that each narrower width has of the one before.
    #[schemars(range(min = 0.1, max = 1.0), extend("x-unit" = "1", "x-effect" = "sharper crests"))]
    pub belt_gain: f64,
    /// Distance from trench to volcanic arc.
    #[schemars(range(min = 1.0, max = 1000.0), extend("x-unit" = "km", "x-effect" = "moves arcs inland"))]
    pub arc_km: f64,
    /// Distance between volcanoes along an arc.
    #[schemars(range(min = 1.0, max = 1000.0), extend("x-unit" = "km", "x-effect" = "fewer volcanoes"))]
    pub volcano_spacing_km: f64,
    /// Height that a volcano gains in a million years of subduction at the plate speed.
    #[schemars(range(min = 0.0, max = 2000.0), extend("x-unit" = "m/My", "x-effect" = "higher volcanoes"))]
    pub volcano_m_per_myr: f64,
    /// Crust that subduction adds to the overriding plate, as thickness over the length that closed.
    #[schemars(range(min = 0.0, max = 60.0), extend("x-unit" = "km", "x-effect" = "higher arcs and coastal ranges"))]
    pub accretion_km: f64,
    /// Thickness at which crust spreads rather than thickens.
    #[schemars(range(min = 30.0, max = 90.0), extend("x-unit" = "km", "x-effect" = "higher ranges before they turn to plateaus"))]
    pub thickest_km: f64,
    /// Depth of a trench below the sea floor around it.
    #[schemars(range(min = 0.0, max = 6000.0), extend("x-unit" = "m", "x-effect" = "deeper trenches"))]
    pub trench_m: f64,
    /// Share of the drive that two continents take from each other per 100 km of overlap.
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "1/100 km", "x-effect" = "collisions that stop sooner"))]
    pub resistance: f64,
    /// Pull of a sinking plate on itself, as a share of the drive.
    #[schemars(range(min = 0.0, max = 2.0), extend("x-unit" = "1", "x-effect" = "faster subduction"))]
    pub slab_pull: f64,
    /// Old, worn belts on the continents when the run begins.
    #[schemars(range(min = 0, max = 60), extend("x-unit" = "1", "x-effect" = "more old belts"))]
    pub old_belts: u32,
    /// How far borders, ranges and coasts are bent, as a share of the map's width.
    #[schemars(range(min = 0.0, max = 0.2), extend("x-unit" = "1", "x-effect" = "curlier ranges and coasts"))]
    pub bend: f64,
    /// Strength of the spurs and valleys on young ranges.
    #[schemars(range(min = 0.0, max = 3.0), extend("x-unit" = "1", "x-effect" = "rougher mountains"))]
    pub ruggedness: f64,
    /// Tectonic cells across the square; the map reads them smoothly.
    #[schemars(range(min = 64, max = 2048), extend("x-unit" = "1", "x-effect" = "finer borders and ranges, slower"))]
    pub cells: u32,
    /// Map of continents: an image stretched over the map, light is continental crust.
    #[schemars(extend("x-path" = true, "x-effect" = "draws the continents"))]
    pub continents: Option<String>,
    /// Map of plates: an image stretched over the map, one colour a plate.
    #[schemars(extend("x-path" = true, "x-effect" = "draws the plates"))]
    pub map: Option<String>,
    /// Plates singled out by a point on them.
    pub plate: Vec<PlateEntry>,
    /// Rules of the meeting.
    #[schemars(extend("x-effect" = "thesis: solid plates in a shaken box"))]
    pub style: PlateStyle,
    /// Thesis style: height of one RMP step.
    #[schemars(range(min = 0.0, max = 10000.0), extend("x-unit" = "m", "x-effect" = "higher steps"))]
    pub thesis_step_m: f64,
    /// Thesis style: Voronoi sites over the map.
    #[schemars(range(min = 4, max = 100000), extend("x-unit" = "1", "x-effect" = "narrower steps"))]
    pub thesis_sites: u32,
}

impl Default for PlatesParams {
    fn default() -> Self {
        Self {
            count: 12,
            duration_myr: 10.0,
            speed_mm_per_yr: 18.0,
            closing: 0.5,
            margin: 1.5,
            continental_share: 0.72,
            continent_km: 700.0,
            shelf_km: 45.0,
            land_share: None,
            belt_km: 45.0,
            belt_octaves: 4,
            belt_gain: 0.6,
            arc_km: 110.0,
            volcano_spacing_km: 55.0,
            volcano_m_per_myr: 250.0,
            accretion_km: 10.0,
            thickest_km: 62.0,
            trench_m: 3000.0,
            resistance: 0.15,
            slab_pull: 0.3,
            old_belts: 6,
            bend: 0.075,
            ruggedness: 1.0,
            cells: 400,
            continents: None,
            map: None,
            plate: Vec::new(),
            style: PlateStyle::Geologic,
            thesis_step_m: 2500.0,
            thesis_sites: 100,
        }
    }
}
