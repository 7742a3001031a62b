//! How volcanoes are asked for.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::profile::{Cone, Profile};
use crate::{grid::Grid, process::ProcessError, volcano::length_m};

/// Volcanoes with craters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct VolcanoParams {
    /// What the volcanoes stand on: a place or a list of them, the way of a plate over a hot spot, or the arcs of the plates.
    #[schemars(extend("x-effect" = "at: where they are put; chain: behind a hot spot; arc: where the plates have their arcs"))]
    pub place: Place,
    /// Its axis, east and south of the map's north-west corner, or the hot spot; the middle of the map if not given.
    #[schemars(extend("x-unit" = "km", "x-effect" = "moves it east and south"))]
    pub at_km: Option<[f64; 2]>,
    /// Height of the rim above the foot.
    #[schemars(range(min = 0.0, max = 20000.0), extend("x-unit" = "m", "x-effect" = "a higher volcano"))]
    pub height_m: f64,
    /// Radius: there a Gaussian or exponential flank has 2 % of its height left; a fifth of the map's longer side if not given.
    #[schemars(range(min = 0.001, max = 10000.0), extend("x-unit" = "km", "x-effect" = "a broader volcano"))]
    pub radius_km: Option<f64>,
    /// Height of the crater's floor above the foot; 85 % of the rim's if not given.
    #[schemars(range(min = 0.0, max = 20000.0), extend("x-unit" = "m", "x-effect" = "a shallower crater"))]
    pub crater_height_m: Option<f64>,
    /// Radius of the rim; 8 % of the volcano's if not given, 0 for none.
    #[schemars(range(min = 0.0, max = 1000000.0), extend("x-unit" = "m", "x-effect" = "a wider crater, steeper flanks"))]
    pub crater_radius_m: Option<f64>,
    /// Form of the flanks.
    #[schemars(extend("x-effect" = "smoothstep ends at transition radii, gaussian is a bell, exponential a stratocone"))]
    pub profile: Profile,
    /// Where the noise, and a smoothstep flank, end, in radii.
    #[schemars(range(min = 1.0, max = 10.0), extend("x-unit" = "1", "x-effect" = "a gentler way out to the plain"))]
    pub transition: f64,
    /// Roughness: standard deviation of its fractal noise, as a share of the height.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "rougher; from 0.3 on spikes"))]
    pub noise: f64,
    /// Waves of the noise over a radius.
    #[schemars(range(min = 0.1, max = 100.0), extend("x-unit" = "1", "x-effect" = "smaller lumps"))]
    pub noise_frequency: f64,
    /// Strength of sharp valleys in the flanks, likewise.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "deeper creases"))]
    pub turbulence: f64,
    /// Hurst exponent of its noise: 1 is smooth, 0.2 rough.
    #[schemars(range(min = 0.05, max = 1.2), extend("x-unit" = "1", "x-effect" = "smoother flanks"))]
    pub hurst: f64,
    /// Another volcano of the same kind: its noise is another.
    #[schemars(range(min = 0, max = 1000000), extend("x-effect" = "another volcano of the same kind"))]
    pub variant: u32,
    /// Height of the foot where blend = "replace", "max" or "min": that of the sea floor; added to the ground with "add".
    #[schemars(range(min = -12000.0, max = 12000.0), extend("x-unit" = "m", "x-effect" = "lifts it and its surroundings"))]
    pub foot_m: f64,
    /// Time since it was active: it sinks, and is worn down into the sea.
    #[schemars(range(min = 0.0, max = 500.0), extend("x-unit" = "My", "x-effect" = "a lower, worn volcano"))]
    pub age_myr: f64,
    /// How much it sinks in its first million years; four times as long for twice as much.
    #[schemars(range(min = 0.0, max = 5000.0), extend("x-unit" = "m", "x-effect" = "old volcanoes drown sooner"))]
    pub sinks_m: f64,
    /// Time in which what rain and waves reach is worn to 37 %, and its crater filled likewise.
    #[schemars(range(min = 0.001, max = 1000.0), extend("x-unit" = "My", "x-effect" = "old volcanoes stay high longer"))]
    pub wear_myr: f64,
    /// Several volcanoes: each has its place, and otherwise the stage's own values unless it gives its own.
    pub volcanoes: Vec<VolcanoEntry>,
    /// The chain, for place = "chain".
    pub chain: Chain,
    /// The arcs, for place = "arc".
    pub arc: Arc,
}

/// What volcanoes stand on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Place {
    /// A place, or several.
    #[default]
    At,
    /// The way of a plate over a hot spot.
    Chain,
    /// The arcs of the plates.
    Arc,
}

/// One of several volcanoes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VolcanoEntry {
    /// Its axis, east and south of the map's north-west corner.
    #[schemars(extend("x-unit" = "km"))]
    pub at_km: [f64; 2],
    /// Height of the rim above the foot.
    #[schemars(range(min = 0.0, max = 20000.0), extend("x-unit" = "m"))]
    pub height_m: Option<f64>,
    /// Radius; that of the stage in proportion to the height if not given.
    #[schemars(range(min = 0.001, max = 10000.0), extend("x-unit" = "km"))]
    pub radius_km: Option<f64>,
    /// Height of the crater's floor above the foot; in proportion if not given.
    #[schemars(range(min = 0.0, max = 20000.0), extend("x-unit" = "m"))]
    pub crater_height_m: Option<f64>,
    /// Radius of the rim; in proportion if not given.
    #[schemars(range(min = 0.0, max = 1000000.0), extend("x-unit" = "m"))]
    pub crater_radius_m: Option<f64>,
    /// Time since it was active.
    #[schemars(range(min = 0.0, max = 500.0), extend("x-unit" = "My"))]
    pub age_myr: Option<f64>,
    /// Form of the flanks.
    pub profile: Option<Profile>,
}

/// Volcanoes that a plate has carried off a hot spot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Chain {
    /// Volcanoes, the active one over the hot spot among them.
    #[schemars(range(min = 1, max = 200), extend("x-effect" = "a longer chain"))]
    pub count: u32,
    /// Time between one and the next.
    #[schemars(range(min = 0.001, max = 100.0), extend("x-unit" = "My", "x-effect" = "further apart, older"))]
    pub interval_myr: f64,
    /// Speed of the plate; that of the plates' table if not given, 90 without one.
    #[schemars(range(min = 0.0, max = 500.0), extend("x-unit" = "mm/yr", "x-effect" = "further apart"))]
    pub speed_mm_per_yr: Option<f64>,
    /// Where the plate goes, clockwise from north; that of the plates' table if not given, 300 without one.
    #[schemars(range(min = -360.0, max = 360.0), extend("x-unit" = "deg", "x-effect" = "turns the chain clockwise"))]
    pub heading_deg: Option<f64>,
    /// Time since when the plate goes there; what is older lies along earlier_heading_deg. Never turned if not given.
    #[schemars(range(min = 0.0, max = 500.0), extend("x-unit" = "My", "x-effect" = "the bend is further from the hot spot"))]
    pub bend_myr: Option<f64>,
    /// Where the plate went before the bend.
    #[schemars(range(min = -360.0, max = 360.0), extend("x-unit" = "deg", "x-effect" = "turns the older part clockwise"))]
    pub earlier_heading_deg: f64,
    /// How much the volcanoes differ in height and stand off the line, as a share of both.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "a less regular chain"))]
    pub variety: f64,
}

/// Volcanoes along the arcs of the plates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Arc {
    /// Distance between volcanoes.
    #[schemars(range(min = 0.1, max = 1000.0), extend("x-unit" = "km", "x-effect" = "fewer volcanoes"))]
    pub spacing_km: f64,
    /// How far from its line they may stand, as a share of the distance between them.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "a less regular arc"))]
    pub scatter: f64,
    /// Height of the lowest, as a share of the highest.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "more of them high"))]
    pub lowest: f64,
}

impl Default for VolcanoParams {
    fn default() -> Self {
        Self {
            place: Place::At,
            at_km: None,
            height_m: 2500.0,
            radius_km: None,
            crater_height_m: None,
            crater_radius_m: None,
            profile: Profile::Exponential,
            transition: 1.8,
            noise: 0.08,
            noise_frequency: 3.0,
            turbulence: 0.08,
            hurst: 0.8,
            variant: 0,
            foot_m: 0.0,
            age_myr: 0.0,
            sinks_m: 350.0,
            wear_myr: 3.0,
            volcanoes: Vec::new(),
            chain: Chain::default(),
            arc: Arc::default(),
        }
    }
}

impl Default for Chain {
    fn default() -> Self {
        Self {
            count: 8,
            interval_myr: 1.0,
            speed_mm_per_yr: None,
            heading_deg: None,
            bend_myr: None,
            earlier_heading_deg: 350.0,
            variety: 0.25,
        }
    }
}

impl Default for Arc {
    fn default() -> Self {
        Self { spacing_km: 50.0, scatter: 0.2, lowest: 0.35 }
    }
}

/// Radius, in the map's longer side; crater, in the volcano's height and radius.
const RADIUS: f64 = 0.2;
const CRATER_HEIGHT: f64 = 0.85;
const CRATER_RADIUS: f64 = 0.08;

impl VolcanoParams {
    /// The stage's own volcano.
    pub(super) fn cone(&self, grid: &Grid) -> Cone {
        let radius_m = length_m(self.radius_km, RADIUS, grid);
        Cone {
            height_m: self.height_m,
            radius_m,
            crater_height_m: self.crater_height_m.unwrap_or(CRATER_HEIGHT * self.height_m),
            crater_radius_m: self.crater_radius_m.unwrap_or(CRATER_RADIUS * radius_m),
            transition: self.transition,
            profile: self.profile,
        }
    }

    /// One of several.
    pub(super) fn listed(&self, entry: &VolcanoEntry, grid: &Grid) -> Cone {
        let own = self.cone(grid);
        let height_m = entry.height_m.unwrap_or(own.height_m);
        let scaled = own.scaled(if own.height_m > 0.0 { height_m / own.height_m } else { 1.0 });
        let radius_m = entry.radius_km.map_or(scaled.radius_m, |km| km * 1e3);
        Cone {
            height_m,
            radius_m,
            crater_height_m: entry.crater_height_m.unwrap_or(scaled.crater_height_m),
            crater_radius_m: entry.crater_radius_m.unwrap_or(scaled.crater_radius_m * radius_m / scaled.radius_m),
            profile: entry.profile.unwrap_or(self.profile),
            ..scaled
        }
    }

    /// What does not go together.
    pub(super) fn check(&self, grid: &Grid) -> Result<(), ProcessError> {
        let unfit = |text: String| Err(ProcessError::Unfit(text));
        let finite = |at_km: &[f64; 2]| at_km.iter().all(|v| v.is_finite() && v.abs() <= 1e6);
        if !self.at_km.iter().all(finite) {
            return unfit("at_km must be two numbers of kilometres, at most a million".to_owned());
        }
        check_cone(&self.cone(grid), "")?;
        if self.place != Place::At {
            if !self.volcanoes.is_empty() {
                return unfit(
                    "'volcanoes' says where each stands; with place = \"chain\" or \"arc\" leave it out".to_owned(),
                );
            }
            return Ok(());
        }
        let off = |at_m: [f64; 2], cone: &Cone, who: &str| {
            let [w, h] = grid.extent_m().map(|m| m / 1e3);
            let [x, y] = at_m.map(|m| m / 1e3);
            match crate::volcano::off_map_m(at_m, grid) > cone.reach_m() {
                true => unfit(format!(
                    "{who}at_km = [{x}, {y}] is so far off the map (0 to {w}, 0 to {h}) that nothing of it would be seen"
                )),
                false => Ok(()),
            }
        };
        if self.volcanoes.is_empty() {
            return off(crate::volcano::place_m(self.at_km, grid), &self.cone(grid), "");
        }
        for (i, entry) in self.volcanoes.iter().enumerate() {
            let (cone, who) = (self.listed(entry, grid), format!("volcanoes[{}]: ", i + 1));
            if !finite(&entry.at_km) {
                return unfit(format!("{who}at_km must be two numbers of kilometres, at most a million"));
            }
            check_cone(&cone, &who)?;
            off(entry.at_km.map(|km| km * 1e3), &cone, &who)?;
        }
        Ok(())
    }
}

fn check_cone(cone: &Cone, who: &str) -> Result<(), ProcessError> {
    if cone.crater_radius_m >= cone.radius_m {
        return Err(ProcessError::Unfit(format!(
            "{who}a crater of {} m is as wide as the volcano of {} m; lower crater_radius_m or raise radius_km",
            cone.crater_radius_m, cone.radius_m
        )));
    }
    if cone.crater_height_m > cone.height_m {
        return Err(ProcessError::Unfit(format!(
            "{who}the crater's floor at {} m is higher than its rim at {} m; lower crater_height_m or raise height_m",
            cone.crater_height_m, cone.height_m
        )));
    }
    Ok(())
}
