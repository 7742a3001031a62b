//! Who looks on changes nothing.

use std::sync::atomic::AtomicBool;

use upthrust::{
    measure::layer_stats,
    recipe::presets,
    timeline::{Interest, Moment, Sink, Timeline},
    world::World,
};

use super::{grown, plan};

/// Takes everything there is after every step.
struct Everything(usize);

impl Sink for Everything {
    fn wants(&mut self, _: &Moment) -> Interest {
        Interest::Whole
    }

    fn take(&mut self, _: &World, _: &Moment) -> Result<(), String> {
        self.0 += 1;
        Ok(())
    }
}

#[test]
fn a_world_that_was_looked_at_after_every_step_is_the_same() {
    for preset in presets() {
        let unseen = grown(preset.name, "64", None);
        let (mut everything, stay) = (Everything(0), AtomicBool::new(false));
        let plan = plan(preset.name, "64", None);
        let seen = Timeline::new(&plan, &stay).run(&mut [&mut everything], &mut |_| ()).unwrap();
        assert!(everything.0 > 0);
        // Hashes first: they name the layer that differs.
        assert_eq!(layer_stats(&unseen), layer_stats(&seen), "{}", preset.name);
        assert!(unseen == seen, "{}: tables, books or the sea differ", preset.name);
    }
}
