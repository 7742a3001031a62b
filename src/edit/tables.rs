//! Tables that go along with a window: places move to its frame, rivers are cut at its rim.

use super::window::Window;
use crate::world::{Column, Table, Values, World};

/// Tables whose rows reach off any map: plates are larger than windows.
const UNCUT: [&str; 2] = ["plates", "plate_outlines"];
/// The columns that say where a row lies, and how many metres their unit has.
const PLACES: [([&str; 2], f64); 2] = [(["x_km", "y_km"], 1e3), (["x_m", "y_m"], 1.0)];
/// The column that says to which line a row belongs.
const RIVER: &str = "river";
/// The column that says to which ring, or group of them, a row belongs.
const LAKE: &str = "lake";
/// Numbers that name something: between two rows the upper one's holds.
const NAMES: [&str; 3] = [RIVER, "order", "into_id"];

/// Moves places in all tables to the window's frame. Points outside are left out, rivers end at the rim, and lakes stay whole
/// or go.
pub(super) fn carry(world: &mut World, window: &Window) {
    let tables: Vec<Table> = world.tables().cloned().collect();
    for mut table in tables {
        let Some((names, unit_m)) = axes(&table) else { continue };
        for (name, corner_m) in names.iter().zip(window.corner_m) {
            shift(&mut table, name, corner_m * (1.0 / unit_m));
        }
        let table = if UNCUT.contains(&table.name.as_str()) {
            table
        } else if table.numbers(RIVER).is_some() {
            cut(&table, window)
        } else {
            kept(table, window)
        };
        world.set_table(table);
    }
}

/// The columns of a table's places and their unit in metres, if it has places.
fn axes(table: &Table) -> Option<([&'static str; 2], f64)> {
    PLACES.into_iter().find(|(names, _)| names.iter().all(|name| table.numbers(name).is_some()))
}

/// Takes a corner off a column of places.
fn shift(table: &mut Table, name: &str, corner: f64) {
    let column = table.columns.iter_mut().find(|column| column.name == name);
    if let Some(Column { values: Values::Number(values), .. }) = column {
        values.iter_mut().for_each(|at| *at -= corner);
    }
}

/// The rows whose places lie within; of lakes all rows or none.
fn kept(table: Table, window: &Window) -> Table {
    let inside: Vec<bool> = places(&table).into_iter().map(|at_m| share_within([at_m; 2], window).is_some()).collect();
    let keep: Vec<bool> = match table.numbers(LAKE) {
        Some(ids) => {
            let mut there: Vec<u64> =
                ids.iter().zip(&inside).filter(|(_, is)| **is).map(|(id, _)| id.to_bits()).collect();
            there.sort_unstable();
            ids.iter().map(|id| there.binary_search(&id.to_bits()).is_ok()).collect()
        }
        None => inside,
    };
    let rows: Vec<usize> = (0..keep.len()).filter(|&i| keep[i]).collect();
    let columns = table.columns.iter().map(|column| Column {
        values: match &column.values {
            Values::Number(values) => Values::Number(rows.iter().map(|&i| values[i]).collect()),
            Values::Text(values) => Values::Text(rows.iter().map(|&i| values[i].clone()).collect()),
        },
        ..column.clone()
    });
    Table { columns: columns.collect(), name: table.name.clone() }
}

fn places(table: &Table) -> Vec<[f64; 2]> {
    let Some((names, unit_m)) = axes(table) else { return Vec::new() };
    let [x, y] = names.map(|name| table.numbers(name).unwrap_or(&[]));
    x.iter().zip(y).map(|(x, y)| [x * unit_m, y * unit_m]).collect()
}

/// The shares of a way, from and to, between which it lies within the window (Liang and Barsky).
fn share_within([from, to]: [[f64; 2]; 2], window: &Window) -> Option<[f64; 2]> {
    let extent_m = window.grid.extent_m();
    let mut within = [0.0f64, 1.0];
    for axis in 0..2 {
        let (a, way) = (from[axis], to[axis] - from[axis]);
        if way == 0.0 {
            if !(0.0..=extent_m[axis]).contains(&a) {
                return None;
            }
            continue;
        }
        let (t, u) = (-a / way, (extent_m[axis] - a) / way);
        within = [within[0].max(t.min(u)), within[1].min(t.max(u))];
    }
    (within[0] <= within[1]).then_some(within)
}

/// A place on a line: `share` of the way from a row to the next.
#[derive(Clone, Copy)]
struct Place {
    row: usize,
    share: f64,
}

/// A part of a line that lies within.
struct Piece {
    river: f64,
    places: Vec<Place>,
    /// Whether its last place is the line's own end.
    ends: bool,
}

/// Lines as far as they lie within. A line that comes back is another line; what leaves ends at the rim.
fn cut(table: &Table, window: &Window) -> Table {
    let (at_m, ids) = (places(table), table.numbers(RIVER).unwrap_or(&[]));
    let mut pieces: Vec<Piece> = Vec::new();
    let mut next_id = ids.iter().fold(0.0f64, |most, id| most.max(*id)) + 1.0;
    let mut open = false;
    for i in 0..at_m.len() {
        let goes_on = i + 1 < at_m.len() && ids[i + 1] == ids[i];
        if !goes_on {
            open = false;
            continue;
        }
        let Some([from, to]) = share_within([at_m[i], at_m[i + 1]], window) else {
            open = false;
            continue;
        };
        if !(open && from == 0.0) {
            let again = pieces.last().is_some_and(|piece| ids[piece.places[0].row] == ids[i]);
            let river = if again { next_id } else { ids[i] };
            next_id += f64::from(again);
            pieces.push(Piece { river, places: vec![Place { row: i, share: from }], ends: false });
        }
        open = to == 1.0;
        let last = open && !(i + 2 < at_m.len() && ids[i + 2] == ids[i]);
        if let Some(piece) = pieces.last_mut() {
            piece.places.push(if to == 1.0 { Place { row: i + 1, share: 0.0 } } else { Place { row: i, share: to } });
            piece.ends = last;
        }
    }
    // A line that only touches the rim has no length.
    pieces.retain(|piece| piece.places.len() > 2 || piece.places[0].share != piece.places[1].share || piece.ends);
    let columns = table.columns.iter().map(|column| Column { values: of_pieces(column, &pieces), ..column.clone() });
    Table { name: table.name.clone(), columns: columns.collect() }
}

/// A column's values along the pieces.
fn of_pieces(column: &Column, pieces: &[Piece]) -> Values {
    let places = || pieces.iter().flat_map(|piece| piece.places.iter().map(move |place| (piece, place)));
    match &column.values {
        Values::Number(values) => {
            let value = |(piece, place): (&Piece, &Place)| match column.name.as_str() {
                RIVER => piece.river,
                "into_id" if !piece.ends => 0.0,
                name if place.share == 0.0 || NAMES.contains(&name) => values[place.row],
                _ => values[place.row] + place.share * (values[place.row + 1] - values[place.row]),
            };
            Values::Number(places().map(value).collect())
        }
        Values::Text(values) => {
            let value = |(piece, place): (&Piece, &Place)| {
                if column.name == "into" && !piece.ends { "rim".to_owned() } else { values[place.row].clone() }
            };
            Values::Text(places().map(value).collect())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        grid::{Edges, Grid},
        world::Vent,
    };

    #[test]
    fn rivers_end_at_the_rim_and_come_back_as_others() {
        let mut world = World::new(Grid::new(100, 100, 100e3, Edges::Open), 0.0);
        // One that leaves the window of 20 to 60 km, comes back and ends in it; one that joins it; one far away.
        let rows = [
            (1.0, 10.0, 30.0),
            (1.0, 30.0, 30.0),
            (1.0, 70.0, 30.0),
            (1.0, 70.0, 50.0),
            (1.0, 50.0, 50.0),
            (2.0, 25.0, 55.0),
            (2.0, 50.0, 50.0),
            (3.0, 90.0, 90.0),
            (3.0, 95.0, 95.0),
        ];
        let table = Table::new("rivers")
            .number("river", "1", rows.iter().map(|row| row.0).collect())
            .number("x_km", "km", rows.iter().map(|row| row.1).collect())
            .number("y_km", "km", rows.iter().map(|row| row.2).collect())
            .number("z_m", "m", (0..9).map(|i| 900.0 - 100.0 * i as f64).collect())
            .text("into", rows.iter().map(|row| if row.0 == 2.0 { "river" } else { "lake" }.to_owned()).collect())
            .number("into_id", "1", rows.iter().map(|row| if row.0 == 2.0 { 1.0 } else { 7.0 }).collect());
        world.set_table(table);
        let window = Window { corner_m: [20e3, 20e3], grid: Grid::new(40, 40, 40e3, Edges::Open) };
        carry(&mut world, &window);
        let rivers = world.table("rivers").unwrap();
        let column = |name: &str| rivers.numbers(name).unwrap().to_vec();
        assert_eq!(column("river"), [1.0, 1.0, 1.0, 4.0, 4.0, 2.0, 2.0]);
        assert_eq!(column("x_km"), [0.0, 10.0, 40.0, 40.0, 30.0, 5.0, 30.0]);
        assert_eq!(column("y_km"), [10.0, 10.0, 10.0, 30.0, 30.0, 35.0, 30.0]);
        assert_eq!(column("z_m"), [850.0, 800.0, 725.0, 550.0, 500.0, 400.0, 300.0]);
        assert_eq!(rivers.words("into").unwrap(), ["rim", "rim", "rim", "lake", "lake", "river", "river"]);
        assert_eq!(column("into_id"), [0.0, 0.0, 0.0, 7.0, 7.0, 1.0, 1.0]);
    }

    #[test]
    fn rings_stay_whole_and_points_go() {
        let mut world = World::new(Grid::new(100, 100, 100e3, Edges::Open), 0.0);
        let points = |name: &str| {
            Table::new(name).number("x_km", "km", vec![10.0, 90.0, 130.0]).number("y_km", "km", vec![60.0; 3])
        };
        world.set_table(points("peaks").text("name", ["a", "b", "c"].map(str::to_owned).to_vec()));
        let vents = [10e3, 90e3].map(|x| Vent { at_m: [x, 60e3], radius_m: 300.0, age_yr: 0.0 });
        world.add_vents(&vents);
        world.set_table(points("plates"));
        world.set_table(points("lake_outlines").number("lake", "1", vec![1.0, 2.0, 2.0]));
        world.set_table(Table::new("sums").number("a", "1", vec![1.0]));
        carry(&mut world, &Window { corner_m: [80e3, 50e3], grid: Grid::new(40, 40, 40e3, Edges::Open) });
        let table = |name: &str| world.table(name).unwrap().numbers("x_km").unwrap().to_vec();
        assert_eq!((table("peaks"), table("plates")), (vec![10.0], vec![-70.0, 10.0, 50.0]));
        assert_eq!(table("lake_outlines"), [10.0, 50.0]);
        assert_eq!(world.table("peaks").unwrap().words("name").unwrap(), ["b"]);
        assert_eq!(world.table("peaks").unwrap().numbers("y_km").unwrap(), [10.0]);
        assert_eq!(world.vents(), [Vent { at_m: [10e3, 10e3], ..vents[1] }]);
        assert_eq!(world.table("sums").unwrap().rows(), 1);
    }
}
