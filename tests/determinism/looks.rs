//! Who looks on changes nothing.

use upthrust::{
    measure::layer_stats,
    recipe::presets,
    timeline::{Interest, Moment, Sink},
    world::World,
};

use super::{run, small};

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
    // The first stages of that one are those of `collision`; what follows are steps alone.
    for preset in presets().iter().filter(|preset| preset.name != "continent-to-valley") {
        let plan = small(preset, "64");
        let (unseen, mut everything) = (run(&plan, &mut []), Everything(0));
        let seen = run(&plan, &mut [&mut everything]);
        assert!(everything.0 > 0);
        // Hashes first: they name the layer that differs.
        assert_eq!(layer_stats(&unseen), layer_stats(&seen), "{}", preset.name);
        assert!(unseen == seen, "{}: tables, books or the sea differ", preset.name);
    }
}
