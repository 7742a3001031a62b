//! What the window shows: the world, the view of it, and what is to be said. No painting.

use std::{path::Path, sync::Arc};

use crate::{
    job,
    relief::View,
    world::{Kind, Layer, World},
};

use super::camera::Camera;

/// A world that is open.
pub struct Opened {
    /// Its name.
    pub name: String,
    /// Shared with the thread that draws.
    pub world: Arc<World>,
    /// Which part of it is seen.
    pub camera: Camera,
    /// The layers, as the numbers under the pointer show them.
    layers: Vec<(Layer, crate::grid::Field<f32>)>,
}

/// What is to be drawn.
#[derive(Clone)]
pub struct Wanted {
    /// Of which world.
    pub world: Arc<World>,
    /// What of it.
    pub view: View,
    /// Whether plates are laid over it.
    pub overlay: bool,
}

/// The state of the window.
#[derive(Default)]
pub struct State {
    /// The world, once there is one.
    pub opened: Option<Opened>,
    /// What is shown of it.
    pub view: View,
    /// Whether plates are laid over it.
    pub overlay: bool,
    /// What could not be done, in a line.
    pub complaint: Option<String>,
}

impl State {
    /// Shows a world. The view stays where the new world has it too.
    pub fn show(&mut self, name: String, world: World) {
        let grid = world.grid;
        let layers: Vec<_> =
            world.viewable().into_iter().filter_map(|layer| Some((layer, world.view(layer)?))).collect();
        if let View::Layer(layer) = self.view
            && layers.iter().all(|(there, _)| *there != layer)
        {
            self.view = View::Relief;
        }
        let camera = Camera::new([grid.width, grid.height]);
        self.opened = Some(Opened { name, world: Arc::new(world), camera, layers });
        self.complaint = None;
    }

    /// Opens a world from disk; one that cannot be read leaves the old one in place.
    pub fn open(&mut self, path: &Path) {
        match job::open_world(path) {
            Ok((world, provenance)) => self.show(provenance.name, world),
            Err(error) => self.complaint = Some(error.to_string()),
        }
    }

    /// What can be looked at, in the order of the chooser.
    pub fn views(&self) -> Vec<(View, &'static str)> {
        let layers = self.opened.iter().flat_map(|opened| opened.layers.iter());
        let layers = layers.map(|(layer, _)| (View::Layer(*layer), layer.spec().title));
        std::iter::once((View::Relief, "Relief")).chain(layers).collect()
    }

    /// Whether plates can be laid over the map.
    pub fn has_plates(&self) -> bool {
        self.opened.as_ref().is_some_and(|opened| opened.world.layer(Layer::PlateId).is_some())
    }

    /// What is to be drawn now.
    pub fn wanted(&self) -> Option<Wanted> {
        let world = Arc::clone(&self.opened.as_ref()?.world);
        Some(Wanted { world, view: self.view, overlay: self.overlay })
    }
}

impl Opened {
    /// The numbers of a cell: what, and how much of it.
    pub fn readout(&self, [x, y]: [usize; 2]) -> Vec<(&'static str, String)> {
        let place = self.world.grid.center_m(x, y).map(|m| m / 1000.0);
        let mut lines =
            vec![("East", format!("{} km", number(place[0]))), ("South", format!("{} km", number(place[1])))];
        lines.extend(self.layers.iter().map(|(layer, field)| (layer.spec().title, value(*layer, field.at(x, y)))));
        lines
    }
}

impl Wanted {
    /// Whether a drawing of `other` serves as well.
    pub fn same(&self, other: &Wanted) -> bool {
        Arc::ptr_eq(&self.world, &other.world) && self.view == other.view && self.overlay == other.overlay
    }
}

fn value(layer: Layer, value: f32) -> String {
    let spec = layer.spec();
    match spec.kind {
        Kind::Class(names) => names.get(value as usize).map_or_else(|| value.to_string(), |name| (*name).to_owned()),
        Kind::Id => format!("{value:.0}"),
        Kind::Continuous if spec.unit == "1" => number(value.into()),
        Kind::Continuous => format!("{} {}", number(value.into()), spec.unit),
    }
}

/// About three figures that mean something.
fn number(value: f64) -> String {
    match value.abs() {
        size if size >= 100.0 => format!("{value:.0}"),
        size if size >= 10.0 => format!("{value:.1}"),
        size if size >= 0.0005 => format!("{value:.3}"),
        _ => "0".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Field, Grid};

    fn world(with_plates: bool) -> World {
        let grid = Grid::new(4, 2, 8000.0, Edges::Open);
        let mut world = World::new(grid, 0.0);
        world.set_layer(Layer::Bedrock, Field::from_fn(grid, |x, y| (100 * x + y) as f32));
        if with_plates {
            world.set_layer(Layer::PlateId, Field::filled(grid, 3.0));
            world.set_layer(Layer::BoundaryKind, Field::filled(grid, 2.0));
        }
        world
    }

    #[test]
    fn the_chooser_offers_what_there_is() {
        let mut state = State::default();
        assert!(state.wanted().is_none() && !state.has_plates());
        state.show("one".into(), world(true));
        let titles: Vec<&str> = state.views().into_iter().map(|(_, title)| title).collect();
        assert_eq!(titles, ["Relief", "Height", "Slope", "Bedrock", "Plate", "Boundary"]);
        assert!(state.has_plates());
        let before = state.wanted().unwrap();
        state.view = View::Layer(Layer::PlateId);
        assert!(!state.wanted().unwrap().same(&before));
        assert!(state.wanted().unwrap().same(&state.wanted().unwrap()));
        state.show("two".into(), world(false));
        assert_eq!(state.view, View::Relief, "a view that the new world lacks is left");
    }

    #[test]
    fn numbers_are_those_of_the_cell() {
        let mut state = State::default();
        state.show("one".into(), world(true));
        let lines = state.opened.as_ref().unwrap().readout([2, 1]);
        let of = |title: &str| lines.iter().find(|(t, _)| *t == title).unwrap().1.as_str();
        assert_eq!((of("East"), of("South")), ("5.000 km", "3.000 km"));
        assert_eq!((of("Height"), of("Bedrock")), ("201 m", "201 m"));
        assert_eq!((of("Plate"), of("Boundary")), ("3", "subduction"));
        assert_eq!((number(-0.0001), number(-12.34), number(0.25)), ("0".into(), "-12.3".into(), "0.250".into()));
    }

    #[test]
    fn what_cannot_be_opened_is_said_and_changes_nothing() {
        let mut state = State::default();
        state.show("one".into(), world(false));
        state.open(Path::new("no/such/world"));
        assert!(state.complaint.as_ref().unwrap().contains("no such world"));
        assert_eq!(state.opened.as_ref().unwrap().name, "one");
        state.show("two".into(), world(false));
        assert_eq!(state.complaint, None);
    }
}
