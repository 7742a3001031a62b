//! Stream power on plain heights: routes, erodes, and carries what it took to lakes, sea and rim. Knows no world.
//!
//! `∂z/∂t = U − K·Q^m·S^n + (G/A)·q_s + D·∇²z`, where `Q` is catchment area times rain over a metre a year. Uplift first,
//! then the river network implicitly from the outlets up (Braun and Willett 2013), then diffusion.
//!
//! A cell that ends below its receiver's water, in a lake or on ground that rose too little, keeps its ground: it is not
//! eroded, and the water above it is the level that its donors fall to. So a lake falls as its outlet is cut. A lake takes the
//! sediment that arrives until it is full, the lowest places first.

use rayon::prelude::*;

use crate::{
    flow::{LENGTHS, ROOT, Router},
    grid::{Grid, sum_rows},
};

use super::{
    Rim,
    base::{Base, BaseLevel},
    coast::{self, Coast},
    deposition::{Deposition, Slopes},
    lake,
    law::settle,
    slide::Slide,
};
use crate::erosion::diffusion::diffuse;

/// Rain for which discharge equals catchment area, so that erodibility means the same for both; mm/yr.
const REFERENCE_RAIN_MM_PER_YR: f64 = 1000.0;

/// Constants of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// `K`, in m^(1-2m) a year.
    pub erodibility: f64,
    /// `m`.
    pub area_exponent: f64,
    /// `n`.
    pub slope_exponent: f64,
    /// `G`: share of the load that is laid down again, over catchment area.
    pub deposition: f64,
    /// Catchment under a metre of rain a year at which channels begin, m²; 0 where all water cuts.
    pub channel_area_m2: f64,
    /// Steepest slope to a receiver, rise over run.
    pub steepest: f64,
    /// Whether that slope is the steepest in any other direction as well.
    pub slides_all_round: bool,
    /// `D` on land, m²/yr.
    pub diffusivity_m2_per_yr: f64,
    /// Distance from the mouth over which a river's load falls to 1/e in the sea, m.
    pub marine_reach_m: f64,
    /// What the rim of an open map is.
    pub rim: Rim,
    /// Whether uplift moves base levels too.
    pub lifts_base: bool,
}

impl Law {
    /// How strongly water cuts, `Q^m`, on slopes by the share of it that runs in channels: `1 - exp(-Q/Q_c)`.
    fn pull(&self, water_m2: f64) -> f64 {
        let whole = power(water_m2, self.area_exponent);
        // Beyond 40 the share is 1 to the last bit.
        if water_m2 >= 40.0 * self.channel_area_m2 {
            whole
        } else {
            -libm::expm1(-water_m2 / self.channel_area_m2) * whole
        }
    }
}

/// What acts on the land during a step.
#[derive(Clone, Copy, Debug)]
pub struct Forcing<'a> {
    /// Height of the sea, m.
    pub sea_level_m: f64,
    /// Uplift, mm/yr.
    pub uplift_mm_per_yr: Option<&'a [f32]>,
    /// By what uplift is multiplied during the step.
    pub uplift_factor: f64,
    /// Rain, mm/yr, where there is a map of it.
    pub rain_mm_per_yr: Option<&'a [f32]>,
    /// Rain elsewhere, mm/yr.
    pub uniform_rain_mm_per_yr: f64,
    /// Cells where rivers come in, and their water, m² of catchment under a metre of rain a year.
    pub inflows: &'a [(usize, f64)],
    /// Cells of the rim about them, in ascending order; no water leaves there.
    pub gates: &'a [usize],
    /// Share of the erodibility that each cell has.
    pub ease: Option<&'a [f32]>,
}

/// What a step moved, as thickness summed over cells, m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moved {
    /// Came in by uplift, less what sank.
    pub lifted_m: f64,
    /// Left the map.
    pub left_m: f64,
}

/// The solver's buffers over one raster.
pub struct Carver {
    router: Router,
    base: BaseLevel,
    /// Share of a drop that stays, or the ratio of the law where it is not linear; at an outlet, the water that gathered
    /// there, m² of catchment.
    ratio: Vec<f64>,
    /// Ground after uplift, m.
    raised_m: Vec<f64>,
    /// Ground and the water on it, m.
    surface_m: Vec<f64>,
    /// Sediment on its way; where it ends, what was laid down.
    load_m: Vec<f64>,
    /// Whether water stands on the ground.
    drowned: Vec<bool>,
    /// How freely hillslopes creep, as a share.
    open: Vec<f32>,
    deposition: Deposition,
    coast: Coast,
    slide: Slide,
}

impl Carver {
    /// A solver over `grid`, its water down the steepest of eight ways.
    pub fn new(grid: Grid) -> Self {
        Self::routed(Router::new(grid))
    }

    /// A solver over the raster of a router, which says how water chooses its way.
    pub fn routed(router: Router) -> Self {
        let grid = router.grid();
        let zeros = || vec![0.0; grid.cells()];
        Self {
            router,
            base: BaseLevel::default(),
            ratio: zeros(),
            raised_m: zeros(),
            surface_m: zeros(),
            load_m: zeros(),
            drowned: vec![false; grid.cells()],
            open: vec![0.0; grid.cells()],
            deposition: Deposition::default(),
            coast: Coast::default(),
            slide: Slide::default(),
        }
    }

    /// The routing of the last step.
    pub fn router(&self) -> &Router {
        &self.router
    }

    /// Ground of the last step after uplift alone, m.
    pub fn raised_m(&self) -> &[f64] {
        &self.raised_m
    }

    /// One step of `years`: `height_m` becomes the ground after it.
    pub fn step(&mut self, law: &Law, forcing: &Forcing, height_m: &mut Vec<f64>, years: f64) -> Moved {
        self.route(law, forcing, height_m);
        self.weigh(law, forcing, years);
        let lifted_m = self.lift(law, forcing, height_m, years);
        self.erode(law, forcing, height_m, years);
        if law.slides_all_round {
            self.fail(law, height_m);
        }
        let left_m = self.carry(law, forcing, height_m);
        let left_m = left_m + self.creep(law, forcing, height_m, years);
        Moved { lifted_m, left_m }
    }

    fn grid(&self) -> Grid {
        self.router.grid()
    }

    /// Ways over the ground and the sea.
    fn route(&mut self, law: &Law, forcing: &Forcing, height_m: &[f64]) {
        self.base.find(self.grid(), height_m, forcing.sea_level_m, (law.rim, forcing.gates));
        let sea_m = forcing.sea_level_m;
        self.surface_m.par_iter_mut().zip(height_m).for_each(|(s, &z)| *s = z.max(sea_m));
        self.router.route(&self.surface_m, &self.base.outlet);
    }

    /// Gathers water, and weighs with it how strongly the law holds in each cell.
    fn weigh(&mut self, law: &Law, forcing: &Forcing, years: f64) {
        self.rain(forcing);
        let (way, cell_m) = (self.router.ways(), self.grid().cell_m);
        let per_length = LENGTHS.map(|cells| law.erodibility * years / libm::pow(cells * cell_m, law.slope_exponent));
        let stays = law.slope_exponent == 1.0 && law.deposition == 0.0;
        self.router.descend(&mut self.ratio, |_, water| *water);
        self.ratio.par_iter_mut().zip(way).enumerate().filter(|&(_, (_, &way))| way != ROOT).for_each(
            |(i, (ratio, &way))| {
                let ease = forcing.ease.map_or(1.0, |ease| ease[i] as f64);
                let strength = ease * per_length[way as usize & 7] * law.pull(*ratio);
                *ratio = if stays { 1.0 / (1.0 + strength) } else { strength };
            },
        );
        // What stands under water is not cut.
        for (i, _) in self.router.flooded(&self.surface_m) {
            self.ratio[i] = if stays { 1.0 } else { 0.0 };
        }
    }

    /// Begins the ratios with the water that each cell has of its own, m² of catchment.
    fn rain(&mut self, forcing: &Forcing) {
        let cell_m2 = self.grid().cell_area_m2() / REFERENCE_RAIN_MM_PER_YR;
        let water_m2 = &mut self.ratio;
        match forcing.rain_mm_per_yr {
            Some(rain) => water_m2.par_iter_mut().zip(rain).for_each(|(water, &rain)| *water = rain as f64 * cell_m2),
            None => water_m2.par_iter_mut().for_each(|water| *water = forcing.uniform_rain_mm_per_yr * cell_m2),
        }
        for &(i, inflow_m2) in forcing.inflows {
            water_m2[i] += inflow_m2;
        }
    }

    /// Uplift; gives the sum of it.
    fn lift(&mut self, law: &Law, forcing: &Forcing, height_m: &[f64], years: f64) -> f64 {
        let Some(uplift) = forcing.uplift_mm_per_yr else {
            self.raised_m.copy_from_slice(height_m);
            return 0.0;
        };
        let (way, per_rate) = (self.router.ways(), years * 1e-3 * forcing.uplift_factor);
        let cells = self.raised_m.par_iter_mut().zip(height_m).zip(uplift).zip(way);
        cells.for_each(|(((raised, &z), &rate), &way)| {
            let stays = way == ROOT && !law.lifts_base;
            *raised = if stays { z } else { z + rate as f64 * per_rate };
        });
        // A mouth is no base level: it rises with the land it drains.
        for &(i, base) in &self.base.edge {
            if matches!(base, Base::Mouth(_)) {
                self.raised_m[i] = height_m[i] + uplift[i] as f64 * per_rate;
            }
        }
        let width = self.grid().width;
        sum_rows(self.grid().height, |y| {
            let row = y * width..(y + 1) * width;
            self.raised_m[row.clone()].iter().zip(&height_m[row]).map(|(raised, z)| raised - z).sum()
        })
    }

    /// The network from its outlets up: `height_m` becomes the eroded ground, `surface_m` that with the water on it.
    fn erode(&mut self, law: &Law, forcing: &Forcing, height_m: &mut [f64], years: f64) {
        self.surface_m.par_iter_mut().zip(&self.raised_m).for_each(|(surface, &raised)| *surface = raised);
        self.set_base(law, forcing, height_m, years);
        let (router, ratio) = (&self.router, &self.ratio);
        let steepest = LENGTHS.map(|cells| cells * self.grid().cell_m * law.steepest);
        if law.deposition > 0.0 {
            let slopes = Slopes { ratio, exponent: law.slope_exponent, steepest_m: steepest };
            self.deposition.settle(router, &slopes, law.deposition, &self.raised_m, &mut self.surface_m, height_m);
            return;
        }
        let way = router.ways();
        if law.slope_exponent == 1.0 {
            router.climb(&mut self.surface_m, |i, raised, below| {
                let drop = (raised - below).max(0.0);
                below + (drop * ratio[i]).min(steepest[way[i] as usize & 7])
            });
        } else {
            router.climb(&mut self.surface_m, |i, raised, below| {
                let settled = settle(raised, below, ratio[i], law.slope_exponent);
                below + (settled - below).clamp(0.0, steepest[way[i] as usize & 7])
            });
        }
        let ground = height_m.par_iter_mut().zip(&self.surface_m).zip(&self.raised_m);
        ground.for_each(|((z, &surface), &raised)| *z = surface.min(raised));
    }

    /// Slopes that stand too steep in any direction. What falls joins the load of its cell.
    fn fail(&mut self, law: &Law, height_m: &mut [f64]) {
        let mut rest: Vec<bool> = self.router.ways().iter().map(|&way| way == ROOT).collect();
        for &(i, base) in &self.base.edge {
            rest[i] = base == Base::Fixed;
        }
        self.slide.settle(self.grid(), law.steepest, &rest, &mut self.surface_m);
        height_m.par_iter_mut().zip(&self.surface_m).zip(&rest).for_each(|((z, &surface), &rest)| {
            *z = if rest { *z } else { z.min(surface) };
        });
    }

    /// Levels of the outlets.
    fn set_base(&mut self, law: &Law, forcing: &Forcing, height_m: &[f64], years: f64) {
        let sea_m = forcing.sea_level_m;
        if self.base.sea {
            let (way, surface) = (self.router.ways(), &mut self.surface_m);
            surface.par_iter_mut().zip(way).for_each(|(s, &way)| *s = if way == ROOT { s.max(sea_m) } else { *s });
        }
        for &(i, base) in &self.base.edge {
            self.surface_m[i] = match base {
                Base::Mouth(slope) => {
                    let above = self.raised_m[i] - sea_m;
                    let ease = forcing.ease.map_or(1.0, |ease| ease[i] as f64);
                    let water = self.ratio[i];
                    // Beyond the rim the river runs at least as far as its catchment is wide.
                    let length = water.max(self.grid().cell_area_m2()).sqrt();
                    let slope = slope.min(law.steepest);
                    let rate = ease * law.erodibility * years * law.pull(water);
                    let cut = rate * libm::pow(slope.min(above.max(0.0) / length), law.slope_exponent);
                    let most = above.max(0.0) * (rate / length) / (1.0 + rate / length);
                    // Nor does the slope say anything of what lies further up than that.
                    let sunk = self.raised_m[i] - cut.min(most).min(slope * length);
                    if law.rim == Rim::Held { sunk.max(height_m[i].min(self.raised_m[i])) } else { sunk }
                }
                Base::Fixed => self.raised_m[i].max(sea_m),
            };
        }
    }

    /// Carries what was eroded down the network. Afterwards `load_m` is, at an outlet, all that came; under a lake, what
    /// was laid down there; elsewhere what came by.
    fn gather_load(&mut self, height_m: &[f64]) {
        let (raised, surface) = (&self.raised_m, &self.surface_m);
        let cells = self.load_m.par_iter_mut().zip(&mut self.drowned).zip(raised).zip(surface).zip(height_m);
        cells.for_each(|((((load, drowned), &raised), &surface), &z)| {
            *load = raised - z;
            *drowned = surface > z;
        });
        let drowned = &self.drowned;
        self.router.descend(&mut self.load_m, |i, load| {
            let came = *load;
            if !drowned[i] {
                return came;
            }
            *load = came.clamp(0.0, surface[i] - height_m[i]);
            came - *load
        });
    }

    /// Lays the load down in lakes and in the sea; gives what left the map.
    fn carry(&mut self, law: &Law, forcing: &Forcing, height_m: &mut [f64]) -> f64 {
        self.gather_load(height_m);
        let (grid, way, drowned, load) = (self.grid(), self.router.ways(), &self.drowned, &self.load_m);
        let in_lake = |&i: &usize| drowned[i] && way[i] != ROOT;
        let rows = (0..grid.height).into_par_iter();
        let laid: Vec<(usize, f64)> = rows
            .flat_map_iter(|y| (y * grid.width..(y + 1) * grid.width).filter(in_lake).map(|i| (i, load[i])))
            .collect();
        lake::settle(&self.router, &laid, height_m);
        let mut left_m = 0.0;
        for &(i, _) in &self.base.edge {
            left_m += std::mem::take(&mut self.load_m[i]);
        }
        if self.base.sea {
            left_m += self.lay_in_sea(law, forcing, height_m);
        }
        left_m
    }

    fn lay_in_sea(&mut self, law: &Law, forcing: &Forcing, height_m: &mut [f64]) -> f64 {
        let (way, sea_m) = (self.router.ways(), forcing.sea_level_m);
        // What was raised above the sea in this step has no room either.
        let cells = self.load_m.par_iter_mut().zip(&mut self.surface_m).zip(&*height_m).zip(way);
        cells.for_each(|(((load, room), &z), &way)| {
            *room = if way == ROOT { (sea_m - z).max(0.0) } else { 0.0 };
            *load = if way == ROOT { load.max(0.0) } else { 0.0 };
        });
        for &(i, _) in &self.base.edge {
            self.surface_m[i] = 0.0;
        }
        let (compass, room) = (self.router.compass(), &self.surface_m);
        let left = self.coast.lay(compass, &mut self.load_m, room, law.marine_reach_m, height_m);
        if left > 0.0 { coast::fill_evenly(left, sea_m, |i| room[i] > 0.0, height_m) } else { 0.0 }
    }

    /// Hillslopes; gives what left over a rim that keeps its height.
    fn creep(&mut self, law: &Law, forcing: &Forcing, height_m: &mut Vec<f64>, years: f64) -> f64 {
        if law.diffusivity_m2_per_yr == 0.0 {
            return 0.0;
        }
        let fixed: Vec<(usize, f64)> =
            self.base.edge.iter().filter(|(_, base)| *base == Base::Fixed).map(|&(i, _)| (i, height_m[i])).collect();
        let sea_m = forcing.sea_level_m;
        let cells = self.open.par_iter_mut().zip(&*height_m);
        match forcing.ease {
            Some(ease) => cells.zip(ease).for_each(|((open, &z), &ease)| *open = if z >= sea_m { ease } else { 0.0 }),
            None => cells.for_each(|(open, &z)| *open = if z >= sea_m { 1.0 } else { 0.0 }),
        }
        let spread_m2 = law.diffusivity_m2_per_yr * years;
        // The surface has been read for the last time in this step, and gives room.
        diffuse(self.router.grid(), height_m, spread_m2, &self.open, &mut self.surface_m);
        let mut left_m = 0.0;
        for (i, z) in fixed {
            left_m += std::mem::replace(&mut height_m[i], z) - z;
        }
        left_m
    }
}

/// `x^p`, with the roots that rivers mostly take made quick.
fn power(x: f64, p: f64) -> f64 {
    if p == 0.5 { x.sqrt() } else { libm::pow(x, p) }
}
