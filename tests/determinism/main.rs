//! The same recipe is the same world: for any number of threads to the bit, for any size in its shape.

mod looks;
mod sizes;
mod threads;

use std::sync::atomic::AtomicBool;

use upthrust::{
    recipe::{Overrides, Plan, Preset, Source},
    timeline::{Sink, Timeline},
    world::World,
};

/// A preset grown at a size, with a seed of its own if one is given.
fn grown(preset: &str, size: &str, seed: Option<u64>) -> World {
    let source = Source::find(preset).unwrap();
    let overrides = Overrides { size: Some(size.to_owned()), seed, set: sooner(&source.text) };
    run(&Plan::new(&source, &overrides).unwrap(), &mut [])
}

/// Lava takes as long at any size of the map: a beginning of it will do.
fn sooner(text: &str) -> Vec<String> {
    text.contains("kind = \"lava\"").then(|| "lava.duration_min=0.05".to_owned()).into_iter().collect()
}

/// A preset of a size whose plates, if it has any, are coarser and sooner done.
fn small(preset: &Preset, size: &str) -> Plan {
    let plates = preset.source().text.contains("kind = \"plates\"");
    let set = plates.then(|| "plates.cells=200".to_owned()).into_iter().chain(sooner(&preset.source().text)).collect();
    let overrides = Overrides { size: Some(size.to_owned()), set, ..Overrides::default() };
    Plan::new(&preset.source(), &overrides).unwrap()
}

fn run(plan: &Plan, sinks: &mut [&mut dyn Sink]) -> World {
    let stay = AtomicBool::new(false);
    Timeline::new(plan, &stay).run(sinks, &mut |_| ()).unwrap()
}
