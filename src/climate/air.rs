//! Moisture carried over the land by one wind, and the water it loses on the way.
//!
//! Two amounts of water stand over each square metre: vapour `W` and cloud `c`, kg/m² (mm). In steady state
//!
//! ```text
//! ∇·(u W) = E − (a + b) W + g c + r c/τ        E = e (Wsat − W) over the sea, 0 on land
//! ∇·(u c) =     (a + b) W − g c −   c/τ        rain = c/τ
//! ```
//!
//! - `a = η max(u·∇h, 0)/H`: air that is forced up loses what it can no longer hold (`H`: scale height of vapour), in the
//!   share `η` of the time in which it is moist enough; `g` likewise takes up cloud where air comes down. With the delay
//!   `τ` this is the orographic model of Smith and Barstad (2004), with a budget: what fell can't fall again.
//! - `b`: rain of weather systems, a mean stay of the vapour in the air; less where air has come down from a crest.
//! - `e`: the sea brings the air towards saturation (bulk formula). On land a share `r` of the rain evaporates again.
//!
//! Scheme: first-order upwind finite volumes, so that water is kept to rounding; the system is triangular in the order of
//! the wind, and solved in one sweep, two unknowns a cell. It is positive for every parameter. On a rim the air flows in
//! with a stated humidity and leaves freely. On a map that wraps a row is closed exactly (it is linear in what enters it),
//! the map by repeated laps.

mod budget;
mod laps;

pub use budget::Budget;

use crate::grid::{Edges, Field, Grid};

use super::Zone;

/// Density and exchange of moist air over the sea: a bulk coefficient times the wind of a usual day, m/s.
const SEA_EXCHANGE_M_PER_S: f64 = 1.2e-3 * 7.0;
/// Scale height of water vapour in the air, m.
const VAPOUR_M: f64 = 2000.0;
/// Mean stay of vapour in the air, s: eight days.
const STAY_S: f64 = 8.0 * 86_400.0;
/// Descent that takes up a cloud, m: fine drops are gone sooner than vapour comes.
const CLOUD_M: f64 = 500.0;
/// Descent that makes rain of weather systems rarer by e, m. Over a kilometre of it, warming by 9.8 K, relative humidity
/// falls to 0.57 (Clausius-Clapeyron), and rain depends steeply on humidity (Bretherton, Peters and Back 2004).
const DRY_M: f64 = 800.0;
/// Share of the rain on land that evaporates there again and goes on with the wind.
const RECYCLED: f64 = 0.4;

/// Water that saturates the air over a sea of that temperature, kg/m² (Magnus's formula over water, gas law).
pub fn saturation_mm(sea_degc: f64) -> f64 {
    let t = sea_degc.clamp(-60.0, 60.0);
    let pressure_pa = 610.94 * libm::exp(17.625 * t / (t + 243.04));
    pressure_pa / (461.5 * (t + 273.15)) * VAPOUR_M
}

/// What the ground is to the air, whatever the wind.
#[derive(Clone, Debug)]
pub struct Below {
    /// Height over the sea, as smooth as air sees it, m.
    pub height_m: Field<f32>,
    /// Its slope to the east and to the south.
    slope: Field<[f64; 2]>,
    /// Share of each cell under the sea.
    pub sea: Field<f32>,
    /// Rate at which the sea brings the air over each cell towards saturation, 1/s.
    exchange: Vec<f64>,
    /// What latitude brings, a row each.
    pub zones: Vec<Zone>,
}

impl Below {
    /// Ground of these heights over the sea, m, and shares of sea.
    pub fn new(height_m: Field<f32>, sea: Field<f32>, zones: Vec<Zone>) -> Self {
        let slope = Field::from_fn(height_m.grid, |x, y| height_m.gradient(x, y));
        let exchange = sea.data.iter().map(|&sea| sea as f64 * SEA_EXCHANGE_M_PER_S / VAPOUR_M).collect();
        Self { height_m, slope, sea, exchange, zones }
    }
}

/// How air behaves.
#[derive(Clone, Copy, Debug)]
pub struct Habits {
    /// Fastest wind, m/s.
    pub wind_m_per_s: f64,
    /// Humidity of what comes in over the rim.
    pub rim_humidity: f64,
    /// Share of lifting that rains.
    pub lift_share: f64,
    /// Time that rain takes to form and fall, s.
    pub delay_s: f64,
    /// How far air stays dry that came down, m.
    pub shadow_m: f64,
}

/// A wind over the ground, solved.
pub struct Air<'a> {
    grid: Grid,
    below: &'a Below,
    habits: Habits,
    /// Wind to the east in each row, m/s.
    east: Vec<f64>,
    /// Wind to the south through each row's northern side, and the last one's southern side, m/s.
    south: Vec<f64>,
    /// Rows, each after those that it gets air from.
    order: Vec<usize>,
    cells: Vec<Cell>,
}

/// Rates at a place, 1/s, and the water over it, mm.
#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    rain_out: f64,
    cloud_up: f64,
    recycled: f64,
    water: Water,
}

/// Vapour and cloud over a square metre, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Water {
    vapour: f64,
    cloud: f64,
}

impl Water {
    fn plus(self, other: Water, times: f64) -> Water {
        Water { vapour: self.vapour + other.vapour * times, cloud: self.cloud + other.cloud * times }
    }
}

/// What flows into a row's cells, 1/s: from the cell before, down the wind, and from the rows beside it, each with where
/// it begins in the raster; none for the rim.
#[derive(Clone, Copy, Debug)]
struct Inflow {
    along: f64,
    beside: [(f64, Option<usize>); 2],
}

impl<'a> Air<'a> {
    /// The air over the ground, under the zones' winds turned clockwise by an angle.
    pub fn over(below: &'a Below, habits: Habits, turned_deg: f64) -> Self {
        let grid = below.height_m.grid;
        let (sine, cosine) = (libm::sin(turned_deg.to_radians()), libm::cos(turned_deg.to_radians()));
        let wind: Vec<[f64; 2]> = below
            .zones
            .iter()
            .map(|zone| [zone.wind[0] * cosine - zone.wind[1] * sine, zone.wind[0] * sine + zone.wind[1] * cosine])
            .map(|wind| wind.map(|part| part * habits.wind_m_per_s))
            .collect();
        let rows = grid.height;
        let side = |y: usize| 0.5 * (wind[y.max(1) - 1][1] + wind[y.min(rows - 1)][1]);
        let south: Vec<f64> = (0..=rows).map(side).collect();
        let east: Vec<f64> = wind.iter().map(|wind| wind[0]).collect();
        let order = order(&south);
        let mut air = Self { grid, below, habits, east, south, order, cells: vec![Cell::default(); grid.cells()] };
        let mut crest = below.height_m.data.iter().map(|&h| h as f64).collect::<Vec<f64>>();
        if grid.edges == Edges::Wrap {
            air.rate_laps(&mut crest);
            air.blow_laps();
        } else {
            // A row at a time from crests to water, while it is at hand.
            for y in air.order.clone() {
                air.climb(y, 1, &mut crest);
                air.rate(y, &crest);
                air.sweep(y, air.beyond(y));
            }
        }
        air
    }

    /// Rain, mm/s, row by row.
    pub fn rain(&self) -> impl Iterator<Item = f64> + '_ {
        self.cells.iter().map(|cell| cell.water.cloud / self.habits.delay_s)
    }

    /// The rates of a row's cells. How far the air has come down from the last crest shelters them.
    fn rate(&mut self, y: usize, crest: &[f64]) {
        let row = y * self.grid.width;
        let wind = [self.east[y], 0.5 * (self.south[y] + self.south[y + 1])];
        let weather = self.below.zones[y].belt / STAY_S;
        for (x, &crest) in crest[row..][..self.grid.width].iter().enumerate() {
            let i = row + x;
            let [gx, gy] = self.below.slope.data[i];
            let lift = wind[0] * gx + wind[1] * gy;
            let come_down_m = crest - self.below.height_m.data[i] as f64;
            self.cells[i] = Cell {
                rain_out: self.habits.lift_share * lift.max(0.0) / VAPOUR_M + weather * libm::exp(-come_down_m / DRY_M),
                cloud_up: (-lift).max(0.0) / CLOUD_M,
                recycled: (1.0 - self.below.sea.data[i] as f64) * RECYCLED,
                water: Water::default(),
            };
        }
    }

    /// The height of the last crest, m, as the air over a row's cells remembers it for a while; `times` round.
    fn climb(&self, y: usize, times: usize, crest: &mut [f64]) {
        let flow = self.inflow(y);
        let inflow = flow.along + flow.beside.iter().map(|(rate, _)| rate).sum::<f64>();
        if inflow <= 0.0 {
            return;
        }
        let speed = libm::hypot(self.east[y], 0.5 * (self.south[y] + self.south[y + 1])).max(1e-9);
        let kept = libm::exp(-speed / (inflow * self.habits.shadow_m));
        let height = &self.below.height_m.data;
        let mut behind = None;
        for x in (0..times).flat_map(|_| self.columns(y)) {
            let i = y * self.grid.width + x;
            let own = height[i] as f64;
            let mut sum = flow.along * behind.unwrap_or(own);
            for (rate, row) in flow.beside {
                if rate > 0.0 {
                    sum += rate * row.map_or(own, |row| crest[row + x]);
                }
            }
            crest[i] = own.max(own + (sum / inflow - own) * kept);
            behind = Some(crest[i]);
        }
    }

    /// The columns of a row, down the wind.
    fn columns(&self, y: usize) -> impl Iterator<Item = usize> + use<> {
        let (width, back) = (self.grid.width, self.east[y] < 0.0);
        (0..width).map(move |x| if back { width - 1 - x } else { x })
    }

    /// What flows into the cells of a row.
    fn inflow(&self, y: usize) -> Inflow {
        let grid = &self.grid;
        let per_m = 1.0 / grid.cell_m;
        let row = |inside: bool, dy: isize| (inside || grid.edges == Edges::Wrap).then(|| grid.row(y, dy) * grid.width);
        Inflow {
            along: self.east[y].abs() * per_m,
            beside: [
                (self.south[y].max(0.0) * per_m, row(y > 0, -1)),
                ((-self.south[y + 1]).max(0.0) * per_m, row(y + 1 < grid.height, 1)),
            ],
        }
    }

    fn outflow(&self, y: usize) -> f64 {
        (self.east[y].abs() + self.south[y + 1].max(0.0) + (-self.south[y]).max(0.0)) / self.grid.cell_m
    }

    /// What air brings over the rim: vapour, and the cloud that is on its way down in it.
    fn beyond(&self, y: usize) -> Water {
        let zone = &self.below.zones[y];
        let vapour = self.habits.rim_humidity * saturation_mm(zone.sea_degc);
        Water { vapour, cloud: vapour * zone.belt / STAY_S * self.habits.delay_s }
    }

    /// Solves a row down the wind; `entry` is what flows into its first cell along the row.
    fn sweep(&mut self, y: usize, entry: Water) {
        let (beyond, outflow, flow) = (self.beyond(y), self.outflow(y), self.inflow(y));
        let supply = saturation_mm(self.below.zones[y].sea_degc);
        let falls = 1.0 / self.habits.delay_s;
        let mut behind = entry;
        for x in self.columns(y) {
            let mut come = Water::default().plus(behind, flow.along);
            for (rate, row) in flow.beside {
                if rate > 0.0 {
                    come = come.plus(row.map_or(beyond, |row| self.cells[row + x].water), rate);
                }
            }
            let i = y * self.grid.width + x;
            let exchange = self.below.exchange[i];
            let cell = &mut self.cells[i];
            let Cell { rain_out, cloud_up, recycled, .. } = *cell;
            let (back, source) = (cloud_up + recycled * falls, come.vapour + exchange * supply);
            let (vapour_out, cloud_out) = (outflow + rain_out + exchange, outflow + falls + cloud_up);
            let per = 1.0 / (vapour_out * cloud_out - back * rain_out);
            behind = Water {
                vapour: (cloud_out * source + back * come.cloud) * per,
                cloud: (rain_out * source + vapour_out * come.cloud) * per,
            };
            cell.water = behind;
        }
    }
}

/// Rows, each after those that air comes from; `south` is the wind through the rows' sides.
fn order(south: &[f64]) -> Vec<usize> {
    let rows = south.len() - 1;
    let mut order = Vec::with_capacity(rows);
    // A run of rows that air crosses northwards is turned around: it is entered from its south.
    let mut first = 0;
    for y in 0..rows {
        if y + 1 == rows || south[y + 1] >= 0.0 {
            order.extend((first..=y).rev());
            first = y + 1;
        }
    }
    order
}
