//! The stage on small worlds whose waters are known, and on worlds that nobody would wish.

use std::{collections::BTreeMap, sync::atomic::AtomicBool};

use super::RiversParams;
use crate::{
    grid::{Edges, Field, Grid},
    noise::Key,
    process::{Context, Placement},
    world::{Inflow, Layer, Matter, World},
};

/// Rough land: an island with hills and hollows, or the same without a sea.
fn rough(size: usize, edges: Edges, sea_m: f64) -> World {
    let grid = Grid::new(size, size, size as f64 * 2000.0, edges);
    let mut stream = Key::new(7).stream();
    let bumps: Vec<[f64; 4]> = (0..60)
        .map(|_| [stream.unit(), stream.unit(), 0.02 + 0.08 * stream.unit(), 700.0 * (stream.unit() - 0.5)])
        .collect();
    let mut world = World::new(grid, sea_m);
    let height = Field::from_fn(grid, |x, y| {
        let (u, v) = ((x as f64 + 0.5) / size as f64, (y as f64 + 0.5) / size as f64);
        let r2 = (u - 0.5).powi(2) + (v - 0.5).powi(2);
        let hills: f64 =
            bumps.iter().map(|[bx, by, s, h]| h * libm::exp(-((u - bx).powi(2) + (v - by).powi(2)) / (s * s))).sum();
        (900.0 - 6000.0 * r2 + hills) as f32
    });
    world.set_layer(Layer::Bedrock, height);
    world
}

fn run(world: &mut World, params: RiversParams) {
    let stay = AtomicBool::new(false);
    let context = Context::new(1, "rivers", &stay);
    world.ledger.open("rivers", Matter::Rock, world.rock_m3());
    let mut process = params.process(Placement::default());
    process.step(world, &context).unwrap();
    world.ledger.close("rivers", Matter::Rock, world.rock_m3());
}

fn fine() -> RiversParams {
    RiversParams { least_discharge_m3_s: Some(0.5), ..RiversParams::default() }
}

struct Line {
    at: Vec<[f64; 2]>,
    z: Vec<f64>,
    discharge: Vec<f64>,
    width: Vec<f64>,
    into: String,
    into_id: u32,
}

fn lines(world: &World) -> BTreeMap<u32, Line> {
    let table = world.table("rivers").unwrap();
    let column = |name: &str| table.numbers(name).unwrap();
    let mut lines: BTreeMap<u32, Line> = BTreeMap::new();
    for k in 0..table.rows() {
        let line = lines.entry(column("river")[k] as u32).or_insert_with(|| Line {
            at: vec![],
            z: vec![],
            discharge: vec![],
            width: vec![],
            into: table.words("into").unwrap()[k].clone(),
            into_id: column("into_id")[k] as u32,
        });
        line.at.push([column("x_km")[k], column("y_km")[k]]);
        line.z.push(column("z_m")[k]);
        line.discharge.push(column("discharge_m3_s")[k]);
        line.width.push(column("width_m")[k]);
    }
    lines
}

fn keep_the_rules(world: &World) {
    let lines = lines(world);
    let mut at_last = f64::INFINITY;
    for (id, line) in &lines {
        assert!(line.at.len() > 1, "river {id}");
        assert!(line.discharge.windows(2).all(|w| w[0] <= w[1]), "river {id} loses water");
        assert!(line.z.windows(2).all(|w| w[0] >= w[1]), "river {id} runs uphill: {:?}", line.z);
        assert!(line.width.iter().all(|&w| w > 0.0), "river {id}");
        let (end, q) = (*line.at.last().unwrap(), *line.discharge.last().unwrap());
        assert!(q <= at_last, "rivers come largest first");
        at_last = q;
        match line.into.as_str() {
            "river" => assert!(lines[&line.into_id].at.contains(&end), "river {id} does not meet {}", line.into_id),
            "lake" => assert!(line.into_id as usize <= world.table("lakes").unwrap().rows()),
            "sea" | "rim" | "sink" => {}
            other => panic!("{other}"),
        }
    }
    let account = world.ledger.account("rivers", Matter::Rock).unwrap();
    assert!(account.residual_share() < 1e-6, "{account:?}");
}

/// Cells of land outside lakes that are lower than all around.
fn pits(world: &World) -> usize {
    let (height, lake) = (world.height(), world.layer(Layer::LakeDepth).unwrap());
    let grid = world.grid;
    let rim = |i: usize| {
        let (x, y) = grid.cell_of(i);
        grid.edges == Edges::Open && (x == 0 || y == 0 || x + 1 == grid.width || y + 1 == grid.height)
    };
    let lowest = |i: usize| crate::flow::neighbours(grid, i).all(|(j, _)| height.data[j] > height.data[i]);
    let land = |i: usize| height.data[i] as f64 >= world.sea_level_m && lake.data[i] == 0.0;
    (0..grid.cells()).filter(|&i| land(i) && !rim(i) && lowest(i)).count()
}

#[test]
fn rivers_of_an_island_reach_the_sea_or_a_lake_and_nothing_is_lost() {
    let mut world = rough(96, Edges::Open, 0.0);
    let before = world.height();
    run(&mut world, fine());
    keep_the_rules(&world);
    assert_eq!(pits(&world), 0);
    let lines = lines(&world);
    assert!(lines.len() > 20 && lines.values().any(|line| line.into == "river"));
    assert!(lines.values().all(|line| ["sea", "lake", "river"].contains(&line.into.as_str())));
    assert!(world.table("lakes").unwrap().rows() > 0);
    // All rain on land arrives: 600 mm a year.
    let (discharge, basin) = (world.layer(Layer::Discharge).unwrap(), world.layer(Layer::Basin).unwrap());
    let land = before.data.iter().filter(|&&h| h >= 0.0).count();
    assert_eq!(basin.data.iter().filter(|&&id| id > 0.0).count(), land);
    let most = discharge.data.iter().fold(0.0f32, |a, &b| a.max(b)) as f64;
    assert!(most < land as f64 * 4e6 * 0.6 / 31_557_600.0 && most > 5.0, "{most}");
    // The coast stays where it was: beds end at the sea.
    let (h, sea) = (world.height(), |v: f32| v < 0.0);
    assert!(h.data.iter().zip(&before.data).all(|(&a, &b)| sea(a) == sea(b)));
}

#[test]
fn beds_are_cut_only_as_deep_as_asked() {
    let ground = |carve: f64| {
        let mut world = rough(64, Edges::Open, 0.0);
        run(&mut world, RiversParams { carve, ..fine() });
        let wear = world.layer(Layer::Wear).unwrap().clone();
        (world, wear)
    };
    let ((plain, worn), (carved, cut)) = (ground(0.0), ground(1.0));
    let depth = carved.layer(Layer::RiverDepth).unwrap();
    assert_eq!(plain.layer(Layer::Discharge), carved.layer(Layer::Discharge));
    let mut cells = 0;
    for i in 0..depth.data.len() {
        let more = cut.data[i] - worn.data[i];
        // Rounding of f32 heights below 2048 m.
        assert!(more <= depth.data[i] + 3e-4 && more >= -3e-4, "{more} {}", depth.data[i]);
        cells += usize::from(more > 0.5 * depth.data[i] && depth.data[i] > 0.0);
    }
    assert!(cells > 100);
}

#[test]
fn a_plain_has_branching_rivers_not_parallel_lines() {
    let grid = Grid::new(96, 96, 96_000.0, Edges::Closed);
    let mut world = World::new(grid, 0.0);
    // Level land on the north of a sea.
    world.set_layer(Layer::Bedrock, Field::from_fn(grid, |_, y| if y > 90 { -50.0 } else { 20.0 }));
    run(&mut world, fine());
    keep_the_rules(&world);
    assert_eq!(pits(&world), 0);
    let lines = lines(&world);
    let joined = lines.values().filter(|line| line.into == "river").count();
    let order = world.layer(Layer::StreamOrder).unwrap().data.iter().fold(0.0f32, |a, &b| a.max(b));
    assert!(2 * joined > lines.len() && order >= 3.0, "{joined} of {}, order {order}", lines.len());
    // It stays a plain: the farthest place is raised by a few cm a cell.
    let top = world.height().range().unwrap().1;
    assert!(top < 23.0, "{top}");
}

#[test]
fn a_river_wider_than_a_cell_has_a_bed_of_its_width() {
    let grid = Grid::new(120, 60, 1200.0, Edges::Open);
    let mut world = World::new(grid, -1e3);
    world
        .set_layer(Layer::Bedrock, Field::from_fn(grid, |x, y| 100.0 - 0.1 * x as f32 + 0.2 * (y as f32 - 30.0).abs()));
    world.set_inflows(&[Inflow { cell: grid.index(0, 30), area_m2: 0.0, discharge_m3_s: 60.0, z_m: 0.0 }]);
    run(&mut world, RiversParams { least_discharge_m3_s: Some(5.0), bankfull_ratio: 1.0, ..fine() });
    keep_the_rules(&world);
    assert_eq!(pits(&world), 0);
    // 7.2·√60 = 56 m wide and 0.27·60^0.39 = 1.33 m deep.
    let wear = world.layer(Layer::Wear).unwrap();
    let cut: Vec<f32> = (0..60).map(|y| wear.at(60, y)).collect();
    let width = cut.iter().filter(|&&m| m > 0.05).count();
    assert!((4..=7).contains(&width), "{width}");
    assert!((cut[30] - 1.33).abs() < 0.1 && cut[30] > cut[32], "{cut:?}");
}

#[test]
fn worlds_nobody_would_wish_have_the_rivers_they_deserve() {
    let size = 24;
    let grid = Grid::new(size, size, 48_000.0, Edges::Open);
    let filled = |edges: Edges, h: f32| {
        let mut world = World::new(Grid { edges, ..grid }, 0.0);
        world.set_layer(Layer::Bedrock, Field::filled(Grid { edges, ..grid }, h));
        world
    };
    let mut sea = filled(Edges::Open, -100.0);
    run(&mut sea, fine());
    assert!(lines(&sea).is_empty());
    for edges in [Edges::Open, Edges::Closed, Edges::Wrap] {
        let mut flat = filled(edges, 10.0);
        run(&mut flat, fine());
        keep_the_rules(&flat);
        let mut island = filled(edges, -50.0);
        island.layer_mut(Layer::Bedrock).data[size * 12 + 12] = 5.0;
        run(&mut island, RiversParams { least_discharge_m3_s: Some(1e-6), ..fine() });
        keep_the_rules(&island);
        assert_eq!(lines(&island).len(), 1);
        let mut rough = rough(48, edges, -1e4);
        run(&mut rough, fine());
        keep_the_rules(&rough);
        assert!(lines(&rough).values().all(|line| line.into != "sea"));
    }
    let mut nothing = World::new(grid, 0.0);
    run(&mut nothing, fine());
    let mut dry = rough(32, Edges::Open, 0.0);
    run(&mut dry, RiversParams { rain_mm_per_yr: 0.0, ..RiversParams::default() });
    assert!(lines(&dry).is_empty());
    let mut point = World::new(Grid::new(1, 1, 1000.0, Edges::Open), 0.0);
    run(&mut point, RiversParams::default());
}

/// A round basin, 100 m deep, in a plateau that falls to the rim.
fn basin() -> World {
    let grid = Grid::new(81, 81, 81_000.0, Edges::Open);
    let mut world = World::new(grid, 0.0);
    let height = Field::from_fn(grid, |x, y| {
        let r = ((x as f32 - 40.0).powi(2) + (y as f32 - 40.0).powi(2)).sqrt();
        let rim = if x == 40 && y < 40 && r > 18.0 && r < 30.0 { -8.0 } else { 0.0 };
        200.0 + rim + if r < 20.0 { -100.0 + 5.0 * r } else { -2.0 * (r - 20.0) }
    });
    world.set_layer(Layer::Bedrock, height);
    world
}

#[test]
fn a_closed_basin_fills_to_its_brim_or_to_where_the_air_takes_all() {
    let lake = |loss: f64| {
        let mut world = basin();
        let params = RiversParams { lake_loss_mm_per_yr: loss, carve: 0.0, smallest_lake_km2: Some(25.0), ..fine() };
        run(&mut world, params);
        keep_the_rules(&world);
        let table = world.table("lakes").unwrap().clone();
        let number = |name: &str| table.numbers(name).unwrap()[0];
        assert_eq!(table.rows(), 1);
        (number("level_m"), number("area_km2"), number("outflow_m3_s"))
    };
    let (level_m, area_km2, outflow) = lake(0.0);
    // The notch in the brim is 8 m deep.
    assert!((191.0..193.0).contains(&level_m) && outflow > 0.0, "{level_m} {outflow}");
    assert!(area_km2 > 1000.0);
    let (level_m, area_km2, outflow) = lake(3000.0);
    assert!(level_m < 180.0 && outflow == 0.0);
    // Gain and loss are even: 600 mm on the 1256 km² around the bottom, of which the lake itself gains nothing.
    let even = 1256.0 * 0.6 / 3.6;
    assert!((area_km2 / even - 1.0).abs() < 0.3, "{area_km2} {even}");
}

#[test]
fn outlines_of_lakes_enclose_their_area() {
    let mut world = basin();
    run(&mut world, RiversParams { carve: 0.0, smallest_lake_km2: Some(25.0), ..fine() });
    let outline = world.table("lake_outlines").unwrap();
    let (x, y) = (outline.numbers("x_km").unwrap(), outline.numbers("y_km").unwrap());
    let area: f64 = (0..x.len()).map(|k| (k, (k + 1) % x.len())).map(|(a, b)| 0.5 * (x[a] * y[b] - x[b] * y[a])).sum();
    // Where the water's edge lies on the slope of 5 m a km: 92 m up, 18.4 km from the middle.
    let want = std::f64::consts::PI * 18.4f64.powi(2);
    assert!((area / want - 1.0).abs() < 0.03, "{area} {want}");
}

#[test]
fn what_flows_in_over_the_rim_goes_on() {
    let mut world = rough(64, Edges::Open, -1e4);
    let height = world.height();
    let high = (0..64).max_by(|&a, &b| height.at(a, 0).total_cmp(&height.at(b, 0))).unwrap();
    run(&mut world, fine());
    let alone = world.layer(Layer::Discharge).unwrap().data.iter().fold(0.0f32, |a, &b| a.max(b));
    let mut fed = rough(64, Edges::Open, -1e4);
    fed.set_inflows(&[Inflow { cell: high, area_m2: 0.0, discharge_m3_s: 5000.0, z_m: 0.0 }]);
    run(&mut fed, fine());
    keep_the_rules(&fed);
    let most = fed.layer(Layer::Discharge).unwrap().data.iter().fold(0.0f32, |a, &b| a.max(b));
    assert!(most >= 5000.0 && most < 5000.0 + 10.0 * alone.max(100.0), "{most}");
}

#[test]
fn the_mask_leaves_the_ground_alone() {
    let mut world = rough(64, Edges::Open, 0.0);
    let before = world.height();
    let stay = AtomicBool::new(false);
    let mask = crate::world::Mask::Above(Layer::Height, 1e6);
    let mut process = fine().process(Placement { mask: Some(mask), ..Placement::default() });
    process.step(&mut world, &Context::new(1, "rivers", &stay)).unwrap();
    assert_eq!(world.height(), before);
    assert!(!lines(&world).is_empty());
}
