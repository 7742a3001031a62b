//! What was published stays: the hashes of every preset, what presets say of themselves, and painted plates' motions.

mod motions;
mod presets;

use std::sync::atomic::AtomicBool;

use upthrust::{
    recipe::{Overrides, Plan, Preset},
    timeline::Timeline,
    world::World,
};

/// A preset at a size, with changes; its plan and its world.
fn grown(preset: &Preset, size: &str, set: &[&str]) -> (Plan, World) {
    let set = set.iter().map(|&text| text.to_owned()).collect();
    let plan = Plan::new(&preset.source(), &Overrides { size: Some(size.into()), set, seed: None }).unwrap();
    let stay = AtomicBool::new(false);
    let world = Timeline::new(&plan, &stay).run(&mut [], &mut |_| ()).unwrap();
    (plan, world)
}
