//! The recipes that come with the program.

use super::source::Source;

/// A built-in recipe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// Its name.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
}

macro_rules! presets {
    ($($name:literal)*) => {
        &[$(Preset { name: $name, text: include_str!(concat!("../../presets/", $name, ".toml")) }),*]
    };
}

/// Every preset, in the order in which a reader meets them.
const ALL: &[Preset] = presets! {
    "collision"
    "archipelago-arc"
    "rift"
    "supercontinent"
    "blocks"
    "my-continents"
    "thesis"
    "fbm-smooth"
    "fbm-rough"
    "multifractal-range"
    "warped-terraces"
    "diamond-square"
    "fault-blocks"
    "rmp-peak"
    "rmp-ridge"
    "rmp-graph"
    "erode-my-map"
    "rain-shadow"
    "steady-state"
    "knickpoint"
    "hard-band"
    "continent-to-valley"
    "alpine-valley"
    "alpine-screes"
    "canyon"
    "badlands"
    "river-source"
    "rainstorm"
    "volcanic-slope"
    "volcanic-island"
    "small-islands"
    "compact-island"
    "big-crater"
    "large-volcano"
    "close-up"
    "no-water"
    "spiky"
    "raymarched-archipelago"
    "hotspot-chain"
    "shield-flows"
    "eruption"
    "eruption-as-documented"
};

/// Every preset.
pub fn all() -> &'static [Preset] {
    ALL
}

/// The preset of that name.
pub fn find(name: &str) -> Option<&'static Preset> {
    ALL.iter().find(|preset| preset.name == name)
}

impl Preset {
    /// Its title and description: the values of the first two keys.
    pub fn summary(&self) -> (String, String) {
        let root = super::tree::parse(self.text, self.name).unwrap_or_default();
        let text = |key: &str| match root.get(key).map(|node| &node.value) {
            Some(super::tree::Value::Text(text)) => text.clone(),
            _ => String::new(),
        };
        (text("name"), text("description"))
    }

    /// The recipe.
    pub fn source(&self) -> Source {
        let name = self.name.to_owned();
        Source { file: name.clone(), name, folder: Default::default(), text: self.text.to_owned() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_listed_and_begins_with_its_name() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/presets");
        let mut there: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter_map(|name| name.strip_suffix(".toml").map(str::to_owned))
            .collect();
        let mut listed: Vec<String> = ALL.iter().map(|preset| preset.name.to_owned()).collect();
        there.sort();
        listed.sort();
        assert_eq!(there, listed);
        for preset in ALL {
            assert!(preset.text.starts_with("name = \""), "{}", preset.name);
            let (name, description) = preset.summary();
            assert!(!name.is_empty() && !description.is_empty() && !description.contains('\n'), "{}", preset.name);
        }
    }
}
