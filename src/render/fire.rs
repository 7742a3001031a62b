//! Light of lava: what it gives off by its temperature, where the world has lava, molten and frozen, and how far its light
//! reaches over the ground.

use half::f16;
use rayon::prelude::*;

use super::{frame::colour, ground::copies};
use crate::{
    grid::{Field, Grid},
    scene::LavaLook,
    world::{Layer, World},
};

/// Temperatures of the table of light, °C: the first, the last, and how many.
pub(super) const HEAT_DEGC: [f64; 2] = [400.0, 1200.0];
pub(super) const HEATS: usize = 17;
/// 0 °C, K.
const ZERO_K: f64 = 273.15;
/// Wavelengths of red, green and blue, m, and Planck's second constant of radiation, m K.
const WAVES_M: [f64; 3] = [610e-9, 550e-9, 465e-9];
const SECOND_M_K: f64 = 0.014_388;
/// What gives off white, K.
const WHITE_K: f64 = 6504.0;
/// What begins to glow visibly, K (Draper's point).
const DRAPER_K: f64 = 798.0;
/// A picture cannot show that lava at 1200 °C is a million times as bright as at 525 °C: brightness is raised to this power,
/// as the eye does, while its hue stays.
const SEEN: f64 = 0.5;
/// Brightness of lava at 1200 °C by day and, seen by eyes used to the dark, by night; the sun is 20.
const BRIGHT: [f64; 2] = [1.7, 11.0];
/// Depths from which molten and frozen lava hide the ground, m.
const MOLTEN_M: [f32; 2] = [0.02, 0.4];
const FROZEN_M: [f32; 2] = [0.05, 0.8];
/// Thickness of sediment that begins to hide frozen lava, and hides it.
const BURIED_M: [f32; 2] = [0.1, 1.5];
/// Codes of ages at which plants begin to grow on it, and have grown over it: a thousand and ten thousand years.
const GROWN: [f32; 2] = [0.75, 1.0];
/// Age of which frozen lava's code is 1, yr: its logarithm is coded.
const OLD_YR: f64 = 1e4;
/// Cells a side on which light from lava is spread, at most.
const MOST_SPREAD: usize = 256;
/// Sizes of its spread; each goes twice as far as the one before, and together they fall with the square of the distance.
const REACHES: usize = 7;

type Rgb = [f64; 3];

/// Light that a black body gives off, for red, green and blue, in units of its own.
fn planck(kelvin: f64) -> Rgb {
    WAVES_M.map(|m| 1e-31 / (libm::pow(m, 5.0) * libm::expm1(SECOND_M_K / (m * kelvin.max(1.0)))))
}

/// The same as shares of white's, red of 1200 °C being 1, brightness as it is seen; black below Draper's point.
fn black_body(degc: f64) -> Rgb {
    let white = planck(WHITE_K);
    let by_white = |kelvin: f64| {
        let light = planck(kelvin);
        [0, 1, 2].map(|c: usize| light[c] / white[c])
    };
    let most = by_white(HEAT_DEGC[1] + ZERO_K)[0];
    let seen = |kelvin: f64| libm::pow(by_white(kelvin)[0] / most, SEEN);
    let light = by_white(degc + ZERO_K);
    let (least, bright) = (seen(DRAPER_K), seen(degc + ZERO_K));
    let share = ((bright - least) / (1.0 - least)).max(0.0);
    light.map(|v| v / light[0] * share)
}

/// Colours at 500, 900 and 1200 °C, in proportion between.
fn gradient(degc: f64, colours: [[f32; 3]; 3]) -> Rgb {
    let between = |a: [f32; 3], b: [f32; 3], t: f64| {
        [0, 1, 2].map(|c: usize| f64::from(a[c]) + f64::from(b[c] - a[c]) * t.clamp(0.0, 1.0))
    };
    if degc < 900.0 {
        between(colours[0], colours[1], (degc - 500.0) / 400.0)
    } else {
        between(colours[1], colours[2], (degc - 900.0) / 300.0)
    }
}

/// The table of light by temperature, and of how bright that is beside lava at 1200 °C; `day` is 0 by night, 1 by day.
pub(super) fn heats(look: &LavaLook, day: f64) -> [[f32; 4]; HEATS] {
    let colours = [0, 1, 2].map(|k: usize| colour(&look.colours[k]));
    let bright = look.glow * (BRIGHT[0] + (BRIGHT[1] - BRIGHT[0]) * day);
    std::array::from_fn(|k| {
        let degc = degc_of(k);
        let [r, g, b] = if look.black_body { black_body(degc) } else { gradient(degc, colours) };
        [r * bright, g * bright, b * bright, black_body(degc)[0]].map(|v| v as f32)
    })
}

fn degc_of(k: usize) -> f64 {
    HEAT_DEGC[0] + (HEAT_DEGC[1] - HEAT_DEGC[0]) * k as f64 / (HEATS - 1) as f64
}

fn smooth([from, to]: [f32; 2], v: f32) -> f32 {
    let t = ((v - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Where a world has lava: share of a cell that is molten, its temperature times that, share that is frozen, its age's code
/// times that. `None` where there is none.
pub(super) fn lava(world: &World) -> Option<Vec<[f32; 4]>> {
    let molten = [Layer::MoltenLava, Layer::MoltenTemperature].map(|layer| world.layer(layer));
    let frozen = Frozen::of(world);
    let layers = [molten[0], frozen.as_ref().map(|frozen| frozen.lava)];
    let there = layers.iter().flatten().any(|layer| layer.data.iter().any(|&m| m > MOLTEN_M[0]));
    let cell = |i: usize| {
        let [molten_m, degc] = molten.map(|layer| layer.map_or(0.0, |layer| layer.data[i]));
        let share = smooth(MOLTEN_M, molten_m);
        let [cold, age] = frozen.as_ref().map_or([0.0; 2], |frozen| frozen.at(i));
        [share, share * degc, cold, cold * age]
    };
    there.then(|| (0..world.grid.cells()).into_par_iter().map(cell).collect())
}

/// Frozen lava of a world.
pub(super) struct Frozen<'a> {
    lava: &'a Field<f32>,
    date: Option<&'a Field<f32>>,
    sediment: Option<&'a Field<f32>>,
    time_yr: f64,
}

impl<'a> Frozen<'a> {
    /// `None` where the world has no such layer.
    pub fn of(world: &'a World) -> Option<Self> {
        let [date, sediment] = [Layer::LavaDate, Layer::Sediment].map(|layer| world.layer(layer));
        world.layer(Layer::Lava).map(|lava| Self { lava, date, sediment, time_yr: world.time_yr })
    }

    /// Share of a cell that is frozen lava with nothing on it, and the code of its age.
    pub fn at(&self, i: usize) -> [f32; 2] {
        let buried = self.sediment.map_or(0.0, |sediment| smooth(BURIED_M, sediment.data[i]));
        let date = self.date.map_or(0.0, |date| date.data[i]);
        [smooth(FROZEN_M, self.lava.data[i]) * (1.0 - buried), age_code(self.time_yr - f64::from(date))]
    }

    /// Share of a cell on which nothing grows yet.
    pub fn bare(&self, i: usize) -> f32 {
        let [share, age] = self.at(i);
        share * (1.0 - smooth(GROWN, age))
    }
}

/// 0 for lava that froze now, 1 for what did ten thousand years ago.
fn age_code(age_yr: f64) -> f32 {
    (libm::log1p(age_yr.max(0.0)) / libm::log1p(OLD_YR)).min(1.0) as f32
}

/// The rasters of lava as halves, with their smaller copies.
pub(super) fn halves<const N: usize>(size: [usize; 2], data: Vec<[f32; N]>) -> Vec<([usize; 2], Vec<[f16; N]>)> {
    let half = |(size, data): ([usize; 2], Vec<[f32; N]>)| (size, data.iter().map(|v| v.map(f16::from_f32)).collect());
    copies(size, data).into_iter().map(half).collect()
}

/// What shines onto the ground: brightness from all around, and that times temperature in thousands of degC.
pub(super) struct Spread {
    grid: Grid,
    light: Vec<[f32; 2]>,
}

impl Spread {
    /// A dark one for a map.
    pub fn new(map: &Grid) -> Self {
        let by = map.width.max(map.height).div_ceil(MOST_SPREAD).max(1);
        let grid = Grid {
            width: map.width.div_ceil(by),
            height: map.height.div_ceil(by),
            cell_m: map.cell_m * by as f64,
            ..*map
        };
        Self { grid, light: vec![[0.0; 2]; grid.cells()] }
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.grid.width, self.grid.height]
    }

    /// Adds lava at a place, m from the map's north-west corner, over an area.
    pub fn add(&mut self, at_m: [f64; 2], area_m2: f64, degc: f64) {
        let [x, y] = at_m.map(|m| m / self.grid.cell_m);
        if x < 0.0 || y < 0.0 || x >= self.grid.width as f64 || y >= self.grid.height as f64 {
            return;
        }
        let bright = black_body(degc)[0] * area_m2 / (self.grid.cell_m * self.grid.cell_m);
        let cell = &mut self.light[y as usize * self.grid.width + x as usize];
        cell[0] += bright as f32;
        cell[1] += (bright * degc * 1e-3) as f32;
    }

    /// Adds the lava of a world's raster.
    pub fn add_all(&mut self, map: &Grid, lava: &[[f32; 4]]) {
        for (i, cell) in lava.iter().enumerate().filter(|(_, cell)| cell[0] > 0.0) {
            let at = [i % map.width, i / map.width].map(|k| (k as f64 + 0.5) * map.cell_m);
            let area = f64::from(cell[0]) * map.cell_m * map.cell_m;
            self.add(at, area, f64::from(cell[1] / cell[0]));
        }
    }

    /// The light on the ground all around: a sum of ever wider blurs, each as strong as the one before.
    pub fn spread(mut self) -> Vec<[f32; 2]> {
        // No cell shines more than if lava covered it.
        for cell in &mut self.light {
            let over = cell[0].max(1.0);
            *cell = cell.map(|v| v / over);
        }
        let mut sum = vec![[0.0; 2]; self.light.len()];
        let levels = copies(self.size(), std::mem::take(&mut self.light));
        let blurred = levels.iter().take(REACHES).map(|(size, data)| (*size, blur(*size, data)));
        for (level, (size, data)) in blurred.enumerate() {
            let scale = 1.0 / (1 << level) as f32;
            sum.par_iter_mut().enumerate().for_each(|(i, out)| {
                let at = [i % self.grid.width, i / self.grid.width].map(|k| (k as f32 + 0.5) * scale - 0.5);
                let here = linear(size, &data, at);
                (0..2).for_each(|c| out[c] += here[c] / REACHES as f32);
            });
        }
        sum
    }
}

fn linear([w, h]: [usize; 2], data: &[[f32; 2]], at: [f32; 2]) -> [f32; 2] {
    let corner = |k: f32, size: usize| {
        let k = k.clamp(0.0, (size - 1) as f32);
        (k as usize, (k as usize + 1).min(size - 1), k.fract())
    };
    let ((x0, x1, u), (y0, y1, v)) = (corner(at[0], w), corner(at[1], h));
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    [0, 1].map(|c: usize| {
        let of = |x: usize, y: usize| data[y * w + x][c];
        mix(mix(of(x0, y0), of(x1, y0), u), mix(of(x0, y1), of(x1, y1), u), v)
    })
}

/// A binomial blur of seven cells each way; what lies beyond the rim is dark.
fn blur([w, h]: [usize; 2], data: &[[f32; 2]]) -> Vec<[f32; 2]> {
    const WEIGHTS: [f32; 4] = [20.0 / 64.0, 15.0 / 64.0, 6.0 / 64.0, 1.0 / 64.0];
    let pass = |data: &[[f32; 2]], along_x: bool| -> Vec<[f32; 2]> {
        let at = |i: usize| {
            let (x, y) = ((i % w) as isize, (i / w) as isize);
            let mut sum = [0.0; 2];
            for k in -3isize..=3 {
                let (x, y) = if along_x { (x + k, y) } else { (x, y + k) };
                if x < 0 || y < 0 || x >= w as isize || y >= h as isize {
                    continue;
                }
                let there = data[y as usize * w + x as usize];
                (0..2).for_each(|c| sum[c] += WEIGHTS[k.unsigned_abs()] * there[c]);
            }
            sum
        };
        (0..w * h).into_par_iter().map(at).collect()
    };
    pass(&pass(data, true), false)
}

/// Ground with the lava that flows over it, m.
pub(super) fn with_molten(world: &World, mut height: Field<f32>) -> Field<f32> {
    if let Some(molten) = world.layer(Layer::MoltenLava) {
        height.data.iter_mut().zip(&molten.data).for_each(|(height, depth)| *height += depth.max(0.0));
    }
    height
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Edges;

    #[test]
    fn lava_is_orange_as_planck_has_it_and_begins_to_glow_at_drapers_point() {
        let [r, g, b] = planck(1473.0);
        assert!((g / r - 0.29).abs() < 0.005 && (b / r - 0.026).abs() < 0.0005, "{} {}", g / r, b / r);
        let [r, g, b] = black_body(1200.0);
        assert!((r - 1.0).abs() < 1e-9 && (0.24..0.29).contains(&g) && b < 0.026);
        assert_eq!(black_body(500.0), [0.0; 3]);
        assert!(black_body(530.0)[0] > 0.0 && black_body(530.0)[0] < 1e-3);
        let red = |degc: i32| black_body(f64::from(degc));
        assert!(
            (530..1199).all(|k| red(k + 1)[0] > red(k)[0] && red(k + 1)[1] / red(k + 1)[0] > red(k)[1] / red(k)[0])
        );
    }

    #[test]
    fn three_colours_stand_where_they_are_told_to() {
        let look = LavaLook { black_body: false, glow: 1.0 / BRIGHT[1], ..LavaLook::default() };
        let table = heats(&look, 1.0);
        let at = |degc: f64| {
            let k = (0..HEATS).find(|&k| degc_of(k) == degc).unwrap();
            [table[k][0], table[k][1], table[k][2]].map(|v| (f64::from(v) * 1e6).round() / 1e6)
        };
        assert_eq!([at(400.0), at(500.0)], [[0.0; 3]; 2]);
        assert_eq!([at(900.0), at(1200.0), at(700.0)], [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.5, 0.0, 0.0]]);
    }

    #[test]
    fn light_falls_with_distance_and_none_is_made() {
        let grid = Grid::new(128, 128, 1280.0, Edges::Open);
        let mut spread = Spread::new(&grid);
        spread.add([645.0, 645.0], 100.0, 1200.0);
        let light = spread.spread();
        let row: Vec<f32> = light[64 * 128 + 64..65 * 128].iter().map(|v| v[0]).collect();
        assert!(row.windows(2).all(|v| v[1] <= v[0] + 1e-9) && row[0] > 20.0 * row[8] && row[20] > 0.0);
        assert!(light.iter().map(|v| v[0]).sum::<f32>() <= 1.0 + 1e-3);
        // Its temperature stays.
        assert!(light.iter().filter(|v| v[0] > 1e-6).all(|v| (v[1] / v[0] - 1.2).abs() < 1e-3));
    }

    #[test]
    fn a_world_without_lava_has_none_and_ages_are_told() {
        let mut world = World::new(Grid::new(4, 1, 4.0, Edges::Open), 0.0);
        assert!(lava(&world).is_none());
        let row = |data: [f32; 4]| Field { grid: world.grid, data: data.to_vec() };
        let layers = [
            (Layer::Lava, row([0.0, 3.0, 3.0, 0.0])),
            (Layer::LavaDate, row([0.0, 1000.0, 10.0, 0.0])),
            (Layer::MoltenLava, row([0.0, 0.0, 2.0, 2.0])),
            (Layer::MoltenTemperature, row([0.0, 0.0, 900.0, 1200.0])),
        ];
        layers.into_iter().for_each(|(layer, field)| world.set_layer(layer, field));
        world.time_yr = 1000.0;
        let cells = lava(&world).unwrap();
        assert_eq!(cells[0], [0.0; 4]);
        assert_eq!(cells[1], [0.0, 0.0, 1.0, 0.0]);
        assert!(cells[2][0] == 1.0 && cells[2][1] == 900.0 && (0.7..0.8).contains(&cells[2][3]));
        assert_eq!(cells[3], [1.0, 1200.0, 0.0, 0.0]);
        assert_eq!(with_molten(&world, Field::filled(world.grid, 1.0)).data, [1.0, 1.0, 3.0, 3.0]);
    }
}
