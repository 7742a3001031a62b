//! What imported files say before a run: whether they can be read at all, which map they want, and what a person should
//! know of them. Headers only.

use crate::edit::{Header, ImportParams};

use super::{
    Size, Stage, WorldParams,
    error::{Problem, RecipeError},
    tree::{Node, Place, Table, Value},
    world::{LONGEST_KM, MAX_SIDE, MIN_SIDE, SHORTEST_KM},
};

/// The kind of the stage that imports.
pub(super) const KIND: &str = "import";

/// What the files of a recipe say.
#[derive(Default)]
pub(super) struct Imports {
    /// For people, a line each.
    pub notes: Vec<String>,
    /// The file that the first stage of all lays out, with the place of its path.
    first: Option<(Header, Place, String)>,
}

impl Imports {
    /// Looks at the file of every stage that imports and runs.
    pub fn find(root: &Table, stages: &[Stage], file: &str) -> Result<Self, RecipeError> {
        let mut found = Self::default();
        let Some(Node { value: Value::List(items), .. }) = root.get("stage") else { return Ok(found) };
        let running = stages.iter().zip(items).filter(|(stage, _)| stage.enabled);
        for (nth, (stage, item)) in running.enumerate().filter(|(_, (stage, _))| stage.kind.kind == KIND) {
            let place = match &item.value {
                Value::Table(table) => table.get("path").map_or(item.place.clone(), |node| node.place.clone()),
                _ => item.place.clone(),
            };
            let refuse = |what: String| {
                let what = format!("stage '{}': {what}", stage.label);
                RecipeError::new(file, &place, Problem::Unfit(what))
            };
            let params: ImportParams =
                serde_json::from_value::<ImportParams>(stage.params.clone()).map_err(|e| refuse(e.to_string()))?;
            let header = params.probe().map_err(|e| refuse(e.to_string()))?;
            found.notes.extend(params.remarks(&header));
            if nth == 0 {
                found.first = Some((header, place, params.path));
            }
        }
        Ok(found)
    }

    /// Gives the map the file's size and extent where the recipe leaves them open. A single number is the longer side of
    /// the file's own shape, so that another size shows the same land.
    pub fn lay_out(&mut self, world: &mut WorldParams, root: &Table, file: &str) -> Result<(), RecipeError> {
        let Some((header, place, path)) = self.first.take() else { return Ok(()) };
        let stated = |key: &str| match root.get("world").map(|node| &node.value) {
            Some(Value::Table(table)) => table.get(key).is_some(),
            _ => false,
        };
        let [cell_x, cell_y] = header.cell_m.unwrap_or([1.0, 1.0]);
        let extent = [header.width as f64 * cell_x, header.height as f64 * cell_y];
        match world.size {
            Size::Sides(_) => {}
            Size::Side(side) if stated("size") => world.size = Size::Sides(shaped(side, extent)),
            Size::Side(_) => world.size = Size::Sides(shaped(header.width.max(header.height), extent)),
        }
        if !stated("extent_km") {
            match header.cell_m {
                None => self.notes.push(format!(
                    "{path}: the file does not say how large its cells are; the map is {} km wide (extent_km in [world])",
                    world.extent_km
                )),
                Some(_) if (SHORTEST_KM..=LONGEST_KM).contains(&(extent[0] / 1e3)) => {
                    world.extent_km = extent[0] / 1e3;
                }
                Some(_) => {
                    let what = format!(
                        "{path}: by its own cells the map is {} km wide; state extent_km in [world], \
                         between {SHORTEST_KM} and {LONGEST_KM} km",
                        extent[0] / 1e3
                    );
                    return Err(RecipeError::new(file, &place, Problem::Unfit(what)));
                }
            }
        }
        let told_km = header.cell_m.map(|_| extent[0] / 1e3);
        if let Some(own_km) = told_km.filter(|km| !(0.98..1.02).contains(&(world.extent_km / km))) {
            self.notes.push(format!(
                "{path}: by its own cells the map is {own_km:.3} km wide; the recipe makes it {} km (extent_km in [world])",
                world.extent_km
            ));
        }
        let [w, h] = world.size.cells();
        let stretch = (w as f64 / h as f64) / (extent[0] / extent[1]);
        if !(0.98..1.02).contains(&stretch) {
            self.notes.push(format!("{path}: {w} x {h} cells are of another shape than the file; it is stretched"));
        }
        Ok(())
    }
}

/// Cells of a map whose longer side has `side` of them, in the shape of an extent; no side shorter than any map's.
fn shaped(side: usize, [x, y]: [f64; 2]) -> [usize; 2] {
    let [x, y] = [x / x.max(y), y / x.max(y)];
    let cells = |share: f64| ((side as f64 * share).round() as usize).clamp(1, MAX_SIDE);
    let [w, h] = [cells(x), cells(y)];
    // Small files are enlarged whole times until they are a map.
    let times = MIN_SIDE.div_ceil(w.min(h)).min(MAX_SIDE / w.max(h)).max(1);
    [w * times, h * times]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_keep_the_shape_of_their_file() {
        assert_eq!(shaped(1024, [300.0, 150.0]), [1024, 512]);
        assert_eq!(shaped(64, [288.0, 216.0]), [64, 48]);
        assert_eq!(shaped(4, [4.0, 2.0]), [32, 16]);
        assert_eq!(shaped(16384, [1.0, 3.0]), [5461, 16384]);
    }
}
