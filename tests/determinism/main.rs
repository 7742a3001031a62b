//! The same recipe is the same world: for any number of threads to the bit, for any size in its shape.

mod sizes;
mod threads;

use std::sync::atomic::AtomicBool;

use upthrust::{
    recipe::{Overrides, Plan, Source},
    timeline::Timeline,
    world::World,
};

/// A preset grown at a size, with a seed of its own if one is given.
fn grown(preset: &str, size: &str, seed: Option<u64>) -> World {
    let overrides = Overrides { size: Some(size.to_owned()), seed, ..Overrides::default() };
    let plan = Plan::new(&Source::find(preset).unwrap(), &overrides).unwrap();
    let stay = AtomicBool::new(false);
    Timeline::new(&plan, &stay).run(&mut [], &mut |_| ()).unwrap()
}
