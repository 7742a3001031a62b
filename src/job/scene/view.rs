//! What a picture or a film shows: a map, or a scene in space, plain or under a map's colours.

use crate::{
    job::JobError,
    recipe::nearest,
    relief,
    world::{Layer, World},
};

/// A view by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum View {
    /// A map.
    Map(relief::View),
    /// A scene, under the colours of a map if one is named.
    Scene(Option<relief::View>),
}

const SCENE: &str = "scene";

impl View {
    /// `relief`, a layer's name, `scene`, or `scene:` and one of the former.
    pub fn parse(name: &str) -> Result<Self, JobError> {
        if name == SCENE {
            return Ok(View::Scene(None));
        }
        let (map, layer) = match name.strip_prefix("scene:") {
            Some(draped) => (false, draped),
            None => (true, name),
        };
        let found = match layer {
            "relief" => Some(relief::View::Relief),
            layer => Layer::from_name(layer).map(relief::View::Layer),
        };
        let names = || {
            Layer::ALL.iter().map(|layer| layer.name()).chain(["relief", SCENE].into_iter().take(1 + usize::from(map)))
        };
        match found {
            Some(view) if map => Ok(View::Map(view)),
            Some(view) => Ok(View::Scene(Some(view))),
            None => {
                let hint = match nearest(layer, names()) {
                    Some(near) if map => format!("did you mean '{near}'?"),
                    Some(near) => format!("did you mean 'scene:{near}'?"),
                    None => format!("there are: {}", names().collect::<Vec<_>>().join(", ")),
                };
                let wanted =
                    if map { "neither 'relief', 'scene' nor a layer" } else { "'scene:' goes with relief or a layer" };
                Err(JobError::Refused(format!("--view {name}: {wanted} ({hint})")))
            }
        }
    }

    /// The map whose colours are seen.
    pub fn map(&self) -> Option<relief::View> {
        match self {
            View::Map(view) => Some(*view),
            View::Scene(draped) => *draped,
        }
    }

    /// The layer that is shown, if it is one.
    pub fn layer(&self) -> Option<Layer> {
        match self.map() {
            Some(relief::View::Layer(layer)) => Some(layer),
            _ => None,
        }
    }

    /// Refuses a layer that the world has not.
    pub fn check(&self, name: &str, world: &World) -> Result<(), JobError> {
        match self.layer() {
            Some(layer) if !world.viewable().contains(&layer) => {
                let there: Vec<_> = world.viewable().iter().map(|layer| layer.name()).collect();
                let what = format!("this world has no layer '{}' (it has: {})", layer.name(), there.join(", "));
                Err(JobError::Refused(format!("--view {name}: {what}")))
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_have_names() {
        assert_eq!(View::parse("relief").unwrap(), View::Map(relief::View::Relief));
        assert_eq!(View::parse("scene").unwrap(), View::Scene(None));
        assert_eq!(View::parse("scene:slope").unwrap(), View::Scene(Some(relief::View::Layer(Layer::Slope))));
        let said = |name: &str| View::parse(name).unwrap_err().to_string();
        assert_eq!(said("scen"), "--view scen: neither 'relief', 'scene' nor a layer (did you mean 'scene'?)");
        let line = "--view scene:slop: 'scene:' goes with relief or a layer (did you mean 'scene:slope'?)";
        assert_eq!(said("scene:slop"), line);
        assert!(said("scene:scene").contains("there are: "));
    }
}
