//! From crust to heights: isostasy, trenches, forelands and rifts on the tectonic raster, then the map's own reading of it
//! through the warp, with the detail that its cells resolve.

use glam::DVec2;
use rayon::prelude::*;

use crate::{
    crust,
    grid::{Corners, Field, Grid, blur, cubic, for_each_row, linear, nearest_feature, nearest_from},
    noise::{Fbm, Gullies, Key, Octaves, Sampler, smoothstep},
    world::Layer,
};

use super::{
    border::{BorderCell, border_cells},
    domain::Domain,
    exchange::NONE,
    params::PlatesParams,
    plate::Rock,
    profiles::profiles,
    simulation::Simulation,
    stretch::Meeting,
    warp::Warp,
    window::Window,
};

/// Spacing of the widest valleys that rivers cut side by side, m.
const WIDEST_VALLEY_M: f64 = 30e3;
/// Thickening that leaves a third of the smoothing of what lay there before, m.
const STRENGTH_M: f32 = 8_000.0;
/// Standard deviation to which the shapes that borders press into the ground are smoothed, cells.
const SHAPES_CELLS: f64 = 1.5;

/// What the map reads, on the part of the tectonic raster that it reads.
pub struct Surface {
    /// That part.
    pub window: Window,
    /// Height without the map's own detail, m.
    pub height: Field<f32>,
    /// Height that young mountains have over the land around them, m.
    mountain: Field<f32>,
    /// Continental share.
    pub kind: Field<f32>,
    /// Age of the crust, My.
    age: Field<f32>,
    /// Owner.
    plate: Vec<u8>,
    rock: Field<Rock>,
    borders: Vec<BorderCell>,
    time_myr: f64,
}

/// What the plates know besides, on the same part.
struct Crust {
    /// Crust, km.
    thickness: Field<f32>,
    /// Uplift, mm/yr.
    uplift: Field<f32>,
    /// Boundary class and distance to it, m.
    boundary: (Vec<u8>, Field<f32>),
}

/// One cell of the map.
#[derive(Clone, Copy, Default)]
struct Reading {
    height: f32,
    plate: f32,
    kind: f32,
    age: f32,
    thickness: f32,
    uplift: f32,
    boundary: f32,
}

impl Surface {
    /// The part of the tectonic raster that bears on what a map reads: a blur's three boxes reach at most three standard
    /// deviations and three cells, slopes and cubic stencils three more.
    pub fn window(domain: &Domain, params: &PlatesParams, warp: &Warp) -> Window {
        let widest = stiffness_m(params).max(SHAPES_CELLS * domain.cell_m());
        Window::around(domain, warp, 3.0 * widest / domain.cell_m() + 6.0)
    }

    /// The surface of a run as it stands.
    pub fn of(run: &Simulation, params: &PlatesParams, window: Window) -> Self {
        let grid = window.grid;
        let owners = owners(run);
        let borders = border_cells(run, &owners);
        let plate = Field::from_fn(grid, |x, y| owners[window.cell(x, y)]).data;
        let rock = Field::from_fn(grid, |x, y| rock(run, window.cell(x, y)));
        let base = Field::from_fn(grid, |x, y| {
            let r = rock.at(x, y);
            crust::height_m(r.crust_m as f64, r.kind as f64, run.time_myr - r.born_myr as f64) as f32
        });
        let mountain = Field::from_fn(grid, |x, y| {
            let r = rock.at(x, y);
            // What heat lifts is in the base already.
            let cold_m = |thickness_m: f32| crust::airy_height_m(thickness_m as f64, crust::density(r.kind as f64));
            (cold_m(r.crust_m + r.added_m - r.worn_m) - cold_m(r.crust_m)) as f32 + r.edifice_m
        });
        // The plates' strength carries short loads: what the crust was at the start shows smoothed, but not below the
        // ranges raised since, whose height is their own.
        let smooth = |field: &Field<f32>, deviation_m: f64| blur(field, deviation_m / grid.cell_m);
        let stiff = smooth(&base, stiffness_m(params));
        let shapes = profiles(run, params, &borders, &window, |i| (plate[i], &rock.data[i]));
        let shapes = smooth(&shapes, SHAPES_CELLS * grid.cell_m);
        let mountain = smooth(&mountain, 0.7 * grid.cell_m);
        let height = Field::from_fn(grid, |x, y| {
            let i = grid.index(x, y);
            let bent = stiff.data[i] - base.data[i];
            // Most ground was never thickened, and an exponential is dear.
            let added_m = rock.data[i].added_m;
            let free = if added_m == 0.0 { 1.0 } else { libm::expf(-added_m / STRENGTH_M) };
            base.data[i] + bent * free + shapes.data[i] + mountain.data[i]
        });
        let time = run.time_myr as f32;
        Self {
            window,
            mountain,
            kind: Field::from_fn(grid, |x, y| rock.at(x, y).kind),
            age: Field::from_fn(grid, |x, y| time - rock.at(x, y).born_myr),
            height,
            plate,
            rock,
            borders,
            time_myr: run.time_myr,
        }
    }

    fn crust(&self) -> Crust {
        let grid = self.height.grid;
        let part = |f: &(dyn Fn(&Rock) -> f32 + Sync)| Field::from_fn(grid, |x, y| f(&self.rock.at(x, y)));
        // Thickening shows as uplift by Airy's factor; m/My are mm/yr times a thousand.
        let airy = ((1.0 - crust::CONTINENTAL / crust::MANTLE) * 1e-3) as f32;
        Crust {
            thickness: part(&|rock| (rock.thickness_m() * 1e-3) as f32),
            uplift: part(&|rock| rock.rate_at(self.time_myr as f32) * airy),
            boundary: boundary_layer(&self.window, &self.borders),
        }
    }

    /// Reads the surface onto a map: one field a layer, heights with the detail that the map's cells resolve.
    pub fn read(&self, warp: &Warp, detail: &Detail) -> Vec<(Layer, Field<f32>)> {
        let (map, grid) = (detail.plains.map, self.height.grid);
        let slope = [0, 1].map(|axis| Field::from_fn(grid, |x, y| self.height.gradient(x, y)[axis] as f32));
        let crust = self.crust();
        let mut readings = vec![Reading::default(); map.cells()];
        for_each_row(&mut readings, map.width, |y, row| {
            let mut ridges = detail.ridges.sampler();
            for (x, reading) in row.iter_mut().enumerate() {
                *reading = self.read_cell(map.center_m(x, y).into(), warp, (&slope, &crust), detail, &mut ridges);
            }
        });
        type Part = fn(&Reading) -> f32;
        let layers: [(Layer, Part); 7] = [
            (Layer::Bedrock, |r| r.height),
            (Layer::PlateId, |r| r.plate),
            (Layer::CrustKind, |r| r.kind),
            (Layer::CrustAge, |r| r.age),
            (Layer::CrustThickness, |r| r.thickness),
            (Layer::Uplift, |r| r.uplift),
            (Layer::BoundaryKind, |r| r.boundary),
        ];
        layers
            .into_par_iter()
            .map(|(layer, part)| (layer, Field { grid: map, data: readings.iter().map(part).collect() }))
            .collect()
    }

    /// The sea level that leaves this share of the map dry before detail is added, m; the same for every grid.
    pub fn sea_level_for(&self, map_m: DVec2, warp: &Warp, land_share: f64) -> f64 {
        const PROBES: usize = 192;
        let probes = Grid::new(PROBES, PROBES, 1.0, crate::grid::Edges::Closed);
        let heights = Field::from_fn(probes, |x, y| {
            let at_m = DVec2::from(probes.center_m(x, y)) * map_m;
            linear(&self.height, self.at(warp.read_at(at_m))) as f32
        });
        heights.level_above(land_share)
    }

    fn read_cell(
        &self,
        at_m: DVec2,
        warp: &Warp,
        (slope, crust): (&[Field<f32>; 2], &Crust),
        detail: &Detail,
        ridges: &mut Sampler,
    ) -> Reading {
        let (q_m, rows) = warp.read_with_jacobian(at_m);
        let q = self.at(q_m);
        let base = cubic(&self.height, q);
        let here = Corners::at(&self.height.grid, q);
        let slope = DVec2::new(here.read(&slope[0]), here.read(&slope[1]));
        // Chain rule: the slope on the map is the transposed Jacobian times the slope in the plates.
        let slope = DVec2::new(rows[0].x * slope.x + rows[1].x * slope.y, rows[0].y * slope.x + rows[1].y * slope.y);
        let kind = here.read(&self.kind);
        let mountain = here.read(&self.mountain);
        Reading {
            height: (base + detail.height(at_m, base, slope, [kind, mountain], ridges)) as f32,
            plate: self.plate_at(&here) as f32,
            kind: kind.clamp(0.0, 1.0) as f32,
            age: here.read(&self.age).max(0.0) as f32,
            thickness: here.read(&crust.thickness) as f32,
            uplift: here.read(&crust.uplift) as f32,
            boundary: self.boundary_at(&here, &crust.boundary, detail.plains.border_m),
        }
    }

    /// Reads onto a map what the surface knows besides its height; `reads_m` are the points of the plates it reads.
    pub fn read_crust(&self, reads_m: &[Field<f32>; 2], border_m: f64) -> Vec<(Layer, Field<f32>)> {
        let (map, crust) = (reads_m[0].grid, self.crust());
        let part = |layer: Layer, f: &(dyn Fn(&Corners) -> f32 + Sync)| {
            let field = Field::from_fn(map, |x, y| {
                let at_m = DVec2::new(reads_m[0].at(x, y) as f64, reads_m[1].at(x, y) as f64);
                f(&Corners::at(&self.height.grid, self.at(at_m)))
            });
            (layer, field)
        };
        vec![
            part(Layer::PlateId, &|here| self.plate_at(here) as f32),
            part(Layer::CrustKind, &|here| here.read(&self.kind).clamp(0.0, 1.0) as f32),
            part(Layer::CrustAge, &|here| here.read(&self.age).max(0.0) as f32),
            part(Layer::CrustThickness, &|here| here.read(&crust.thickness) as f32),
            part(Layer::BoundaryKind, &|here| self.boundary_at(here, &crust.boundary, border_m)),
        ]
    }

    /// Class of the border nearest to a point, 0 where it is further than `border_m`.
    fn boundary_at(&self, here: &Corners, (class, distance): &(Vec<u8>, Field<f32>), border_m: f64) -> f32 {
        let i = here.cells(&self.height.grid)[here.holder()];
        if (distance.data[i] as f64) < border_m { class[i] as f32 } else { 0.0 }
    }

    /// A point of the plates' square from the window's corner, m.
    pub fn at(&self, at_m: DVec2) -> [f64; 2] {
        (at_m - self.window.corner_m).into()
    }

    /// Its height as a map reads it, m; `reads_m` are the points of the plates it reads.
    pub fn shown(&self, reads_m: &[Field<f32>; 2]) -> Field<f32> {
        Field::from_fn(reads_m[0].grid, |x, y| {
            cubic(&self.height, self.at(DVec2::new(reads_m[0].at(x, y) as f64, reads_m[1].at(x, y) as f64))) as f32
        })
    }

    /// Whether this is sea floor made in the last so many My.
    #[inline]
    pub fn is_newer(&self, here: &Corners, myr: f64) -> bool {
        let i = here.cells(&self.height.grid)[here.holder()];
        (self.age.data[i] as f64) < myr && self.kind.data[i] < 0.5
    }

    /// The owner with most of the bilinear weight around a point: borders smoother than the raster's steps.
    #[inline]
    pub fn plate_at(&self, here: &Corners) -> u8 {
        let corners = here.cells(&self.height.grid).map(|i| self.plate[i]);
        if corners.iter().all(|&c| c == corners[0]) {
            return corners[0];
        }
        let weights = here.weights();
        let weight = |id: u8| (0..4).filter(|&k| corners[k] == id).map(|k| weights[k]).sum::<f64>();
        corners.into_iter().max_by(|&a, &b| weight(a).total_cmp(&weight(b)).then(b.cmp(&a))).unwrap_or(corners[0])
    }
}

/// Standard deviation to which the plates' strength smooths short loads, m.
fn stiffness_m(params: &PlatesParams) -> f64 {
    params.belt_km * 1e3 / 4.0
}

/// The cell whose plate a tectonic cell shows: its own, or in a crack too narrow to be exchanged the nearest one's.
fn shown(run: &Simulation, cell: usize) -> usize {
    let owned = |i: usize| run.owners.top[i] != NONE;
    if owned(cell) { cell } else { nearest_from(run.domain.grid(), cell, owned).unwrap_or(cell) }
}

/// Owner of a tectonic cell.
fn owner(run: &Simulation, shown: usize) -> u8 {
    Some(run.owners.top[shown]).filter(|&owner| owner != NONE).unwrap_or(0)
}

/// Owners of all tectonic cells.
fn owners(run: &Simulation) -> Vec<u8> {
    (0..run.owners.top.len()).into_par_iter().map(|cell| owner(run, shown(run, cell))).collect()
}

/// Rock of a tectonic cell.
fn rock(run: &Simulation, cell: usize) -> Rock {
    let (n, shown) = (run.domain.cells, shown(run, cell));
    let plate = &run.plates[owner(run, shown) as usize];
    let rock = |cell: usize| plate.sample(run.domain.cell_center_m(cell % n, cell / n), run.time_myr as f32);
    let bare = Rock { crust_m: crust::OCEAN_THICKNESS_M as f32, ..Rock::default() };
    rock(cell).or_else(|| rock(shown)).unwrap_or(bare)
}

/// Class of the nearest border (catalogue numbers) and the distance to it.
fn boundary_layer(window: &Window, borders: &[BorderCell]) -> (Vec<u8>, Field<f32>) {
    let mut class = vec![0u8; window.square.cells()];
    for border in borders {
        class[border.cell] = match border.meeting {
            Meeting::Collision => 1,
            Meeting::Subduction => 2,
            Meeting::Spreading => 3,
            Meeting::Transform => 4,
        };
    }
    let near = nearest_feature(window.square, |i| class[i] != 0);
    let nearest = |cell: usize| class.get(near.index.data[cell] as usize).copied().unwrap_or(0);
    (
        Field::from_fn(window.grid, |x, y| nearest(window.cell(x, y))).data,
        Field::from_fn(window.grid, |x, y| near.distance_m.data[window.cell(x, y)]),
    )
}

/// Ground finer than the tectonic cells where nothing was raised: plains, uplands and the hills of the sea floor.
pub struct Plains {
    octaves: Octaves,
    map: Grid,
    sea_m: f64,
    /// How wide a border is drawn, m.
    pub border_m: f64,
}

impl Plains {
    /// For a map with the sea at `sea_m`.
    pub fn new(map: Grid, params: &PlatesParams, sea_m: f64, key: Key) -> Self {
        let belt_m = params.belt_km * 1e3;
        Self {
            octaves: Fbm::new(2.0 * belt_m, 0.7).octaves(key.named("plains"), map.cell_m),
            map,
            sea_m,
            border_m: map.cell_m.max(belt_m / 12.0),
        }
    }

    /// What is added to a base height on crust that is continental to the share `kind`, m.
    pub fn height(&self, at_m: [f64; 2], base: f64, kind: f64) -> f64 {
        self.octaves.value(at_m) * self.rolling(base, kind)
    }

    /// Half the height of its hills, m: low ground near the sea is smooth, uplands are rolling, the deep floor has its hills.
    fn rolling(&self, base: f64, kind: f64) -> f64 {
        let above = base - self.sea_m;
        let upland = smoothstep(above / 1200.0);
        let floor = smoothstep(-above / 3000.0) * (1.0 - kind).clamp(0.0, 1.0);
        55.0 + 130.0 * upland + 80.0 * floor
    }
}

/// Detail finer than the tectonic cells: plains, and mountains by ridges and gullies.
pub struct Detail {
    plains: Plains,
    ridges: Octaves,
    gullies: Gullies,
    gully_key: Key,
    ruggedness: f64,
}

impl Detail {
    /// For a map with the sea at `sea_m`.
    pub fn new(map: Grid, params: &PlatesParams, sea_m: f64, key: Key) -> Self {
        let belt_m = params.belt_km * 1e3;
        Self {
            plains: Plains::new(map, params, sea_m, key),
            ridges: Fbm::new(0.9 * belt_m, 0.9).octaves(key.named("ridges"), map.cell_m),
            gullies: Gullies {
                wavelength_m: (0.3 * belt_m).min(WIDEST_VALLEY_M),
                octaves: 6,
                relief: 0.07,
                half_slope: 0.11,
            },
            gully_key: key.named("gullies"),
            ruggedness: params.ruggedness,
        }
    }

    fn height(&self, at_m: DVec2, base: f64, slope: DVec2, [kind, mountain]: [f64; 2], ridges: &mut Sampler) -> f64 {
        let at = at_m.into();
        let rolling = self.plains.rolling(base, kind);
        let (plain, plain_slope) = self.plains.octaves.gradient(at);
        let mut height = plain * rolling;
        let rough = (mountain.max(0.0) / 2500.0).min(1.4) * self.ruggedness;
        if rough > 0.02 {
            // Ridged sums lie between 0 and 1 with a mean near 0.7.
            height += rough * 1100.0 * (ridges.ridged(at) - 0.7);
        }
        // Valleys are cut above the sea, the deeper the higher the ground.
        let cut = smoothstep((base - self.plains.sea_m + 100.0) / 1500.0) * self.ruggedness;
        if cut > 0.01 {
            // The rolling ground turns the valleys, so that they do not run in ranks.
            let slope = slope + DVec2::from(plain_slope) * (0.5 * rolling);
            height += cut * self.gullies.value(self.gully_key, at, slope.into(), self.plains.map.cell_m);
        }
        height
    }
}
