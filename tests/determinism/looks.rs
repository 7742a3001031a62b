//! Who looks on changes nothing.

use upthrust::{
    measure::layer_stats,
    recipe::{Overrides, Plan, presets},
    timeline::{Interest, Moment, Sink},
    world::World,
};

use super::run;

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
        // Coarser plates are sooner done.
        let plates = preset.source().text.contains("kind = \"plates\"");
        let set = plates.then(|| "plates.cells=200".to_owned()).into_iter().collect();
        let overrides = Overrides { size: Some("64".to_owned()), set, ..Overrides::default() };
        let plan = Plan::new(&preset.source(), &overrides).unwrap();
        let (unseen, mut everything) = (run(&plan, &mut []), Everything(0));
        let seen = run(&plan, &mut [&mut everything]);
        assert!(everything.0 > 0);
        // Hashes first: they name the layer that differs.
        assert_eq!(layer_stats(&unseen), layer_stats(&seen), "{}", preset.name);
        assert!(unseen == seen, "{}: tables, books or the sea differ", preset.name);
    }
}
