//! The books of every preset close: what is there is what was there, plus what came in, less what left.

use std::sync::atomic::AtomicBool;

use upthrust::{
    recipe::{Overrides, Plan, presets},
    timeline::Timeline,
    world::Matter,
};

/// DESIGN.md's third promise: the unexplained share of all that moved.
const MOST_UNEXPLAINED: f64 = 1e-6;

#[test]
fn the_ledger_of_every_preset_closes() {
    let stay = AtomicBool::new(false);
    for preset in presets() {
        // Lava takes as long at any size of the map: a beginning of it will do.
        let lava = preset.text.contains("kind = \"lava\"");
        let set = lava.then(|| "lava.duration_min=0.1".to_owned()).into_iter().collect();
        let overrides = Overrides { size: Some("80x64".into()), set, seed: None };
        let plan = Plan::new(&preset.source(), &overrides).unwrap();
        let world = Timeline::new(&plan, &stay).run(&mut [], &mut |_| ()).unwrap();
        let mut stages = Vec::new();
        for (stage, matter, account) in world.ledger.accounts() {
            let share = account.residual_share();
            assert!(share <= MOST_UNEXPLAINED, "{}, {stage}: {matter:?} {share:e} {account:?}", preset.name);
            if matter == Matter::Rock {
                stages.push(stage);
            }
        }
        for (_, stage) in plan.running() {
            assert!(stages.contains(&stage.key.as_str()), "{}: '{}' keeps no book of rock", preset.name, stage.key);
        }
    }
}
